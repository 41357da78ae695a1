//! Mesh files: one mesh in every format, and what the text formats allow.

use sim3align_formats::mesh::{MeshFormat, MeshReadOptions, read_mesh};
use sim3align_lab::case_folder::write;

use crate::formats_fixtures::{MESHES, area, assert_near, bounds, corners, fixture};
use crate::prelude::*;

fn read(bytes: &[u8]) -> sim3align::error::Result<Mesh> {
    read_mesh(bytes, &MeshReadOptions::default())
}

fn code(bytes: &[u8]) -> ErrorCode {
    read(bytes).unwrap_err().code
}

#[wasm_bindgen_test(unsupported = test)]
fn every_format_gives_the_mesh_that_trimesh_wrote() {
    let expected = corners(&read(fixture!("mesh.glb")).unwrap());
    for (i, (name, bytes)) in MESHES.into_iter().enumerate() {
        let format = MeshFormat::from_name(name).unwrap();
        assert_eq!(MeshFormat::sniff(bytes), Some(format), "fixture {i}");
        let mesh = read(bytes).unwrap_or_else(|error| panic!("fixture {i}, {name}: {error}"));
        // Counts, area, volume and bounds as make_fixtures.py prints them; STL is a soup, welding restores the 42.
        assert_eq!((mesh.positions().len(), mesh.triangles().len()), (42, 80), "fixture {i}");
        assert_near(area(&mesh), 45.410_752_848_592_61, 1e-6);
        assert_near(mesh.signed_volume6() / 6.0, 21.952_271_316_049_703, 1e-6);
        let [low, high] = bounds(&mesh);
        assert_eq!((low, high), ([-0.75, -2.5, 7.0], [1.25, 1.5, 13.0]), "fixture {i}");
        // Text forms print eight decimals.
        let off = corners(&mesh).iter().zip(&expected).map(|(a, b)| (*a - *b).abs().max_element()).fold(0.0, f32::max);
        assert!(off < 2e-6, "fixture {i}: corners off by {off}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn a_format_given_wins_over_the_content_and_unknown_content_is_refused() {
    let as_obj = MeshReadOptions { format: Some(MeshFormat::Obj), resources: None };
    assert!(read_mesh(fixture!("mesh.stl"), &as_obj).is_err());
    assert_eq!(code(b""), ErrorCode::UnsupportedFormat);
    assert_eq!(code(b"hello, world\n"), ErrorCode::UnsupportedFormat);
    let error = read(fixture!("mask-grey.png")).unwrap_err();
    assert_eq!((error.code, &*error.found), (ErrorCode::UnsupportedFormat, "a PNG image"));
    assert_eq!(MeshFormat::from_name(".GLB"), Ok(MeshFormat::Gltf));
    assert_eq!(MeshFormat::from_name("fbx").unwrap_err().code, ErrorCode::InvalidOption);
}

#[wasm_bindgen_test(unsupported = test)]
fn obj_knows_references_polygons_continuations_and_comments() {
    let obj = b"# a house\r\nmtllib house.mtl\r\no house\r\nv 0 0 0 1 0 0 # red\r\nv 1 0 0\r\nv 1 1 0\r\nv 0 \\\r\n 1 0\r\n\
        vt 0 0\r\nvn 0 0 1\r\nv 0.5 2e0 0\r\nv 99 99 99\r\nf 1/1/1 2//1 \\\r\n3/1 4\r\nf -3 -4 -2\r\nl 1 2\r\ns off\r\n";
    let mesh = read(obj).unwrap();
    // The square as a fan, the roof by numbers that count back from the sixth vertex, which no face uses.
    assert_eq!(mesh.triangles(), [[0, 1, 2], [0, 2, 3], [3, 2, 4]]);
    assert_eq!(mesh.positions().len(), 5);
    assert_eq!(mesh.positions()[3], Vec3::new(0.0, 1.0, 0.0));
    assert_eq!(mesh.positions()[4], Vec3::new(0.5, 2.0, 0.0));
    // The same with the line ends of old Macs.
    let mac: Vec<u8> = b"v 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 2 3\r".to_vec();
    assert_eq!(read(&mac).unwrap().triangles(), [[0, 1, 2]]);
}

#[wasm_bindgen_test(unsupported = test)]
fn obj_names_what_is_wrong_and_where() {
    let triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    let with = |faces: &str| read(format!("{triangle}{faces}").as_bytes()).unwrap_err();
    assert_eq!(with("f 1 2 4\n").code, ErrorCode::IndexOutOfRange);
    assert_eq!(with("f 0 1 2\n").code, ErrorCode::IndexOutOfRange);
    assert_eq!(with("f -4 -2 -1\n").code, ErrorCode::IndexOutOfRange);
    assert_eq!(with("f 1 2 99999999999999999999\n").code, ErrorCode::CorruptFile);
    assert_eq!(with("f 1 2\n").code, ErrorCode::CorruptFile);
    assert_eq!(with("l 1 2\n").code, ErrorCode::EmptyMesh);
    assert_eq!(with("v nan 0 0\nf 1 2 4\n").code, ErrorCode::NonFinite);
    let error = with("f 1 2 3\nv 0 zero 0\n");
    assert_eq!((error.code, &*error.found), (ErrorCode::CorruptFile, "\"zero\" in line 5"));
}

#[wasm_bindgen_test(unsupported = test)]
fn ply_reads_strips_and_refuses_counts_that_the_file_cannot_hold() {
    let strips = b"ply\nformat ascii 1.0\ncomment strips\nelement vertex 5\nproperty float x\nproperty float y\n\
        property float z\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n\
        0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n9 0 1 2 3 -1 0 1 2 -1\n";
    assert_eq!(read(strips).unwrap().triangles(), [[0, 1, 2], [1, 3, 2], [0, 1, 2]]);
    let header = |format: &str, vertices: &str, faces: &str| {
        format!(
            "ply\nformat {format} 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\n\
             property float z\nelement face {faces}\nproperty list uint uint vertex_index\nend_header\n"
        )
    };
    for format in ["ascii", "binary_little_endian", "binary_big_endian"] {
        assert_eq!(code(header(format, "4000000000", "1").as_bytes()), ErrorCode::CorruptFile);
        assert_eq!(code(header(format, "18446744073709551615", "1").as_bytes()), ErrorCode::CorruptFile);
        assert_eq!(code(header(format, "0", "99999999").as_bytes()), ErrorCode::CorruptFile);
        assert_eq!(code(header(format, "0", "0").as_bytes()), ErrorCode::EmptyMesh);
    }
    let mut list = header("binary_little_endian", "0", "1").into_bytes();
    list.extend([0xff; 8]);
    assert_eq!(code(&list), ErrorCode::CorruptFile);
    assert_eq!(code(header("binary_middle_endian", "0", "0").as_bytes()), ErrorCode::UnsupportedFormat);
    let ascii = |face: &str| format!("{}0 0 0\n1 0 0\n0 1 0\n{face}\n", header("ascii", "3", "1"));
    assert_eq!(read(ascii("3 0 1 2").as_bytes()).unwrap().triangles(), [[0, 1, 2]]);
    assert_eq!(code(ascii("3 0 1 3").as_bytes()), ErrorCode::IndexOutOfRange);
    assert_eq!(code(ascii("3 0 1 -1").as_bytes()), ErrorCode::IndexOutOfRange);
    assert_eq!(code(ascii("3 0 1 0.5").as_bytes()), ErrorCode::IndexOutOfRange);
    assert_eq!(code(ascii("-3 0 1 2").as_bytes()), ErrorCode::CorruptFile);
}

#[wasm_bindgen_test(unsupported = test)]
fn ply_without_coordinates_or_faces_says_so() {
    let vertex = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nend_header\n0 0\n";
    let error = read(vertex.as_bytes()).unwrap_err();
    assert_eq!((error.code, &*error.found), (ErrorCode::CorruptFile, "vertices without z"));
    let cloud = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n\
        end_header\n0 0 0\n";
    assert_eq!(code(cloud.as_bytes()), ErrorCode::EmptyMesh);
}

#[wasm_bindgen_test(unsupported = test)]
fn stl_welds_both_zeros_and_refuses_counts_that_the_file_cannot_hold() {
    let facet = |corners: &str| {
        let vertices: String = corners.split(',').map(|xyz| format!("   vertex {xyz}\n")).collect();
        format!(" facet normal 0 0 0\n  outer loop\n{vertices}  endloop\n endfacet\n")
    };
    let solid = |facets: &str| format!("solid x\n{facets}endsolid x\n");
    let quad = solid(&(facet("0 0 0,1 0 0,1 1 0") + &facet("-0 -0.0 0,1 1 0,0 1 0")));
    let mesh = read(quad.as_bytes()).unwrap();
    assert_eq!((mesh.positions().len(), mesh.triangles()), (4, [[0, 1, 2], [0, 2, 3]].as_slice()));
    assert_eq!(code(solid(&facet("0 0 0,1 0 0")).as_bytes()), ErrorCode::CorruptFile);
    assert_eq!(code(solid(&facet("0 0 0,1 0 zero,0 1 0")).as_bytes()), ErrorCode::CorruptFile);
    assert_eq!(code(solid("").as_bytes()), ErrorCode::EmptyMesh);
    assert_eq!(code(solid(&facet("0 0 0,1 0 inf,0 1 0")).as_bytes()), ErrorCode::NonFinite);
    let mut hostile = fixture!("mesh.stl").to_vec();
    hostile[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
    let as_stl = MeshReadOptions { format: Some(MeshFormat::Stl), resources: None };
    assert_eq!(read_mesh(&hostile, &as_stl).unwrap_err().code, ErrorCode::CorruptFile);
    // Bytes after the last triangle harm nobody.
    let mut longer = fixture!("mesh.stl").to_vec();
    longer.extend(b"trailing");
    assert_eq!(read_mesh(&longer, &as_stl).unwrap().triangles().len(), 80);
}

#[wasm_bindgen_test(unsupported = test)]
fn a_written_glb_reads_back_to_the_last_bit() {
    let mesh = read(fixture!("mesh-ascii.stl")).unwrap();
    let bytes = write::glb(&mesh);
    assert_eq!(bytes.len() % 4, 0);
    assert_eq!(read(&bytes).unwrap(), mesh);
}
