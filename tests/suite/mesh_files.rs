//! Mesh files: one mesh in every format, what the text formats allow, and what is refused.

use sim3align_formats::mesh::{MeshFormat, MeshReadOptions, read_mesh};
use sim3align_formats::splats::read_splats;

use crate::fixtures::{MESHES, area, corners, fixture, read};
use crate::prelude::*;

#[wasm_bindgen_test]
fn every_format_gives_the_mesh_that_trimesh_wrote() {
    let expected = corners(&read(fixture!("mesh.glb")).unwrap());
    for (i, (name, bytes)) in MESHES.into_iter().enumerate() {
        let format = MeshFormat::from_name(name).unwrap();
        assert_eq!(MeshFormat::sniff(bytes), Some(format), "fixture {i}");
        let mesh = read(bytes).unwrap_or_else(|error| panic!("fixture {i}, {name}: {error}"));
        // Counts, area, volume and bounds as trimesh has them; STL is a soup, welding restores the 42.
        assert_eq!((mesh.positions().len(), mesh.triangles().len()), (42, 80), "fixture {i}");
        let off = [area(&mesh) - 45.410_752_848_592_61, mesh.signed_volume6() / 6.0 - 21.952_271_316_049_703];
        assert!(off.iter().all(|off| off.abs() < 4e-5), "fixture {i}: {off:?}");
        let bounds = Bounds::of(mesh.positions()).unwrap();
        let corners_of_box = (bounds.min.to_array(), bounds.max.to_array());
        assert_eq!(corners_of_box, ([-0.75, -2.5, 7.0], [1.25, 1.5, 13.0]), "fixture {i}");
        // Text forms print eight decimals.
        let off = corners(&mesh).iter().zip(&expected).map(|(a, b)| (*a - *b).abs().max_element()).fold(0.0, f32::max);
        assert!(off < 2e-6, "fixture {i}: corners off by {off}");
    }
}

/// Instances, mirrors and nested transforms: the figures are those of trimesh's own flattening.
#[wasm_bindgen_test]
fn a_scene_of_gltf_is_what_trimesh_flattens_it_to() {
    let mesh = read(fixture!("scene.glb")).unwrap();
    assert_eq!((mesh.positions().len(), mesh.triangles().len()), (16, 24));
    // Positive: the mirrored box faces outward, too.
    assert!((mesh.signed_volume6() / 6.0 - 18.0).abs() < 1e-5, "{}", mesh.signed_volume6() / 6.0);
    let bounds = Bounds::of(mesh.positions()).unwrap();
    assert_eq!([bounds.min.to_array(), bounds.max.to_array()], [[4.0, -1.0, -1.5], [11.0, 1.0, 1.5]]);
}

#[wasm_bindgen_test]
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

#[wasm_bindgen_test]
fn ply_strips_and_both_zeros_of_stl_are_read() {
    let strips = "ply\nformat ascii 1.0\ncomment strips\nelement vertex 5\nproperty float x\nproperty float y\n\
        property float z\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n\
        0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n9 0 1 2 3 -1 0 1 2 -1\n";
    assert_eq!(read(strips).unwrap().triangles(), [[0, 1, 2], [1, 3, 2], [0, 1, 2]]);
    let quad = solid(&[["0 0 0", "1 0 0", "1 1 0"], ["-0 -0.0 0", "1 1 0", "0 1 0"]]);
    let mesh = read(quad).unwrap();
    assert_eq!((mesh.positions().len(), mesh.triangles()), (4, [[0, 1, 2], [0, 2, 3]].as_slice()));
    // Bytes after the last triangle harm nobody.
    let longer = [fixture!("mesh.stl"), b"trailing"].concat();
    let as_stl = MeshReadOptions { format: Some(MeshFormat::Stl), resources: None };
    assert_eq!(read_mesh(&longer, &as_stl).unwrap().triangles().len(), 80);
}

/// An ASCII STL file of these facets.
fn solid(facets: &[[&str; 3]]) -> String {
    let facet = |corners: &[&str; 3]| {
        let vertices: String = corners.iter().map(|xyz| format!("   vertex {xyz}\n")).collect();
        format!(" facet normal 0 0 0\n  outer loop\n{vertices}  endloop\n endfacet\n")
    };
    format!("solid x\n{}endsolid x\n", facets.iter().map(facet).collect::<String>())
}

/// The header of a PLY file.
fn header(format: &str, vertices: &str, faces: &str) -> String {
    format!(
        "ply\nformat {format} 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\n\
         property float z\nelement face {faces}\nproperty list uint uint vertex_index\nend_header\n"
    )
}

#[wasm_bindgen_test]
fn faults_of_text_are_named() {
    use ErrorCode::{CorruptFile, EmptyMesh, IndexOutOfRange, NonFinite, UnsupportedFormat};
    let obj = |faces: &str| format!("v 0 0 0\nv 1 0 0\nv 0 1 0\n{faces}\n");
    let ply = |face: &str| format!("{}0 0 0\n1 0 0\n0 1 0\n{face}\n", header("ascii", "3", "1"));
    let mut cases = vec![
        (String::new(), UnsupportedFormat),
        ("hello, world\n".into(), UnsupportedFormat),
        (obj("f 1 2 4"), IndexOutOfRange),
        (obj("f 0 1 2"), IndexOutOfRange),
        (obj("f -4 -2 -1"), IndexOutOfRange),
        (obj("f 1 2 99999999999999999999"), CorruptFile),
        (obj("f 1 2"), CorruptFile),
        (obj("l 1 2"), EmptyMesh),
        (obj("v nan 0 0\nf 1 2 4"), NonFinite),
        (ply("3 0 1 3"), IndexOutOfRange),
        (ply("3 0 1 -1"), IndexOutOfRange),
        (ply("3 0 1 0.5"), IndexOutOfRange),
        (ply("-3 0 1 2"), CorruptFile),
        (header("binary_middle_endian", "0", "0"), UnsupportedFormat),
        (header("binary_little_endian", "0", "1") + "\u{7f}\u{7f}\u{7f}\u{7f}", CorruptFile),
        ("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n0\n".into(), CorruptFile),
        (solid(&[["0 0 0", "1 0 zero", "0 1 0"]]), CorruptFile),
        (solid(&[["0 0 0", "1 0 inf", "0 1 0"]]), NonFinite),
        (solid(&[]), EmptyMesh),
    ];
    for format in ["ascii", "binary_little_endian", "binary_big_endian"] {
        for (vertices, faces) in [("4000000000", "1"), ("18446744073709551615", "1"), ("0", "99999999")] {
            cases.push((header(format, vertices, faces), CorruptFile));
        }
        cases.push((header(format, "0", "0"), EmptyMesh));
    }
    for (text, code) in cases {
        assert_eq!(read(&text).unwrap_err().code, code, "{text}");
    }
    let error = read(obj("f 1 2 3\nv 0 zero 0")).unwrap_err();
    assert_eq!((error.code, &*error.found), (CorruptFile, "\"zero\" in line 5"));
    assert_eq!(read(fixture!("mask-grey.png")).unwrap_err().found, "a PNG image");
    let mut claims = fixture!("mesh.stl").to_vec();
    claims[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
    let as_stl = MeshReadOptions { format: Some(MeshFormat::Stl), resources: None };
    assert_eq!(read_mesh(&claims, &as_stl).unwrap_err().code, CorruptFile);
}

#[wasm_bindgen_test]
fn splats_have_the_surface_that_their_gaussians_cover() {
    // Of one ellipsoid, with semi-axes 1, 2 and 3 about (0.25, −0.5, 10).
    for file in [fixture!("splat.ply"), fixture!("mesh.splat")] {
        let read = read_splats(file, true).unwrap();
        let found = Bounds::of(read.mesh.positions()).unwrap();
        assert!((found.center() - Vec3::new(0.25, -0.5, 10.0)).length() < 0.1, "{found:?}");
        assert!((found.extent() - Vec3::new(2.0, 4.0, 6.0)).abs().max_element() < 0.3, "{found:?}");
        assert!(read.mesh.signed_volume6() > 0.0 && read.colors.is_some());
        let off = |p: &Vec3| (((p - found.center()) / Vec3::new(1.0, 2.0, 3.0)).length() - 1.0).abs();
        assert!(read.mesh.positions().iter().all(|p| off(p) < 0.2), "floaters");
    }
    // A PLY file without rotations.
    assert_eq!(read_splats(fixture!("mesh-little.ply"), false).map(drop).unwrap_err().code, ErrorCode::CorruptFile);
}
