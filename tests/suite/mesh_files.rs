//! Mesh files: one mesh in every format, what the text formats allow, and what is refused.

use sim3align_formats::mesh::{MeshFormat, MeshReadOptions, read_colored_mesh, read_mesh};
use sim3align_formats::splats::read_splats;

use crate::fixtures::{MESHES, area, corners, fixture, floats, glb, read};
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

/// A letter that is wound around two notches, in any plane: its triangles have its area, and none is turned over.
#[wasm_bindgen_test]
fn polygons_with_notches_are_cut_within_their_outline() {
    let outline = [[0, 0], [5, 0], [5, 3], [4, 3], [4, 1], [3, 1], [3, 3], [2, 3], [2, 1], [1, 1], [1, 3], [0, 3]];
    let area = 5.0 * 3.0 - 2.0 * 2.0;
    for start in 0..outline.len() {
        let ring: Vec<[i32; 2]> = (0..outline.len()).map(|i| outline[(start + i) % outline.len()]).collect();
        let vertex = |[x, y]: [i32; 2]| format!("v {x} {} {y}\n", y - x);
        let vertices: String = ring.iter().map(|p| vertex(*p)).collect();
        let obj = format!("{vertices}f 1 2 3 4 5 6 7 8 9 10 11 12\n");
        let ply_vertices = vertices.replace("v ", "");
        let ply = header("ascii", "12", "1") + &ply_vertices + "12 0 1 2 3 4 5 6 7 8 9 10 11\n";
        for file in [obj, ply] {
            let mesh = read(&file).unwrap();
            let signed = |[a, b, c]: [u32; 3]| {
                let [a, b, c] = [a, b, c].map(|i| mesh.positions()[i as usize]);
                0.5 * f64::from((b - a).cross(c - a).dot(-Vec3::Y))
            };
            let areas: Vec<f64> = mesh.triangles().iter().map(|t| signed(*t)).collect();
            assert_eq!(areas.len(), 10, "{file}");
            assert!(areas.iter().all(|own| *own >= 0.0) && areas.iter().sum::<f64>() == area, "{areas:?}\n{file}");
        }
    }
}

#[wasm_bindgen_test]
fn a_byte_order_mark_is_no_part_of_the_first_statement() {
    for file in ["v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n".to_owned(), solid(&[["0 0 0", "1 0 0", "0 1 0"]])] {
        assert_eq!(read(format!("\u{feff}{file}")).unwrap(), read(&file).unwrap());
    }
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
    let as_stl = MeshReadOptions { format: Some(MeshFormat::Stl), ..MeshReadOptions::default() };
    assert_eq!(read_mesh(&longer, &as_stl).unwrap().triangles().len(), 80);
}

/// Names in capitals, and the content where the name of the file says another format.
#[wasm_bindgen_test]
fn capitals_and_the_content_of_a_file_count() {
    let stl = solid(&[["0 0 0", "1 0 0", "1 1 0"]]).to_ascii_uppercase();
    assert_eq!(read(&stl).unwrap().triangles().len(), 1);
    let ply = header("ascii", "3", "1").replace("float x", "float X").replace("vertex_index", "Vertex_Index");
    assert_eq!(read(ply + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n").unwrap().triangles().len(), 1);
    for format in ["glb", "obj", "ply", "stl"] {
        let named = MeshReadOptions { format: MeshFormat::from_name(format).ok(), ..MeshReadOptions::default() };
        for (name, bytes) in MESHES {
            assert_eq!(read_mesh(bytes, &named).unwrap().triangles().len(), 80, "{name} as {format}");
        }
    }
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
    let as_stl = MeshReadOptions { format: Some(MeshFormat::Stl), ..MeshReadOptions::default() };
    for count in [u32::MAX, 0, 79] {
        claims[80..84].copy_from_slice(&count.to_le_bytes());
        let error = read_mesh(&claims, &as_stl).unwrap_err();
        assert!(error.code == CorruptFile && error.found.contains("before the data of 80"), "{count}: {error}");
    }
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
    assert_eq!(
        read_splats(fixture!("mesh-little.ply"), false).map(drop).unwrap_err().code,
        ErrorCode::UnsupportedFormat
    );
}

#[wasm_bindgen_test]
fn polygons_of_very_many_corners_take_bounded_work() {
    // The square of their number exceeds 32 bits.
    let count = 70_000_u32;
    let corner = |i: u32| {
        let (sin, cos) = libm::sincos(core::f64::consts::TAU * f64::from(i) / f64::from(count));
        let radius = if i.is_multiple_of(2) { 1.0 } else { 0.5 };
        format!("v {:.6} {:.6} 0\n", radius * cos, radius * sin)
    };
    let corners: String = (0..count).map(corner).collect();
    let face: String = (1..=count).map(|i| format!(" {i}")).collect();
    let star = read(format!("{corners}f{face}\n").as_bytes()).unwrap();
    assert_eq!(star.triangles().len(), count as usize - 2);
}

#[wasm_bindgen_test]
fn coordinates_of_maps_keep_their_shape() {
    let near = read(fixture!("mesh.obj")).unwrap();
    let east = [500_123.25, 5_200_456.5, 312.125];
    let moved: String = near.positions().iter().fold(String::new(), |text, p| {
        let [x, y, z] = core::array::from_fn(|axis| f64::from(p[axis]) + east[axis]);
        format!("{text}v {x} {y} {z}\n")
    });
    let faces: String =
        near.triangles().iter().map(|t| format!("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1)).collect();
    let far = read_colored_mesh(format!("{moved}{faces}").as_bytes(), &MeshReadOptions::default()).unwrap();
    let bounds = Bounds::of(near.positions()).unwrap();
    let centre = (0.5 * (bounds.min + bounds.max)).as_dvec3();
    let expected = [0, 1, 2].map(|axis| centre[axis] + east[axis]);
    assert!((0..3).all(|axis| (far.origin[axis] - expected[axis]).abs() < 1e-6), "{} {expected:?}", far.origin);
    for (found, original) in far.mesh.positions().iter().zip(near.positions()) {
        assert!((found.as_dvec3() + centre - original.as_dvec3()).abs().max_element() < 1e-6, "{found} {original}");
    }
    // Closer to zero, the coordinates are those of the file.
    assert_eq!(read_colored_mesh(fixture!("mesh.obj"), &MeshReadOptions::default()).unwrap().origin, DVec3::ZERO);
}

/// Gaussians on a sphere of radius 1, as the properties that 3D Gaussian Splatting writes.
fn sphere_of_gaussians() -> Vec<[f32; 14]> {
    let count = 1500;
    (0..count)
        .map(|i| {
            // A spiral from pole to pole.
            let z = 1.0 - (2 * i + 1) as f32 / count as f32;
            let (angle, radius) = (2.399_963 * i as f32, (1.0 - z * z).sqrt());
            let normal = Vec3::new(radius * angle.cos(), radius * angle.sin(), z);
            let rotation = glam::Quat::from_rotation_arc(Vec3::Z, normal);
            let [x, y, z] = normal.to_array();
            let [qx, qy, qz, qw] = rotation.to_array();
            [x, y, z, 1.0, 0.0, -1.0, 6.0, -2.9, -2.9, -7.0, qw, qx, qy, qz]
        })
        .collect()
}

#[wasm_bindgen_test]
fn splats_of_two_dimensions_and_packed_ones_are_those_of_three() {
    let gaussians = sphere_of_gaussians();
    let ply = |element: &str, names: &[&str], kind: &str, body: Vec<u8>| {
        let list: String = names.iter().map(|name| format!("property {kind} {name}\n")).collect();
        ([format!("element {element} \n{list}").into_bytes()].concat(), body)
    };
    let file = |elements: &[(Vec<u8>, Vec<u8>)]| {
        let head = elements.iter().flat_map(|(head, _)| head.clone());
        let body = elements.iter().flat_map(|(_, body)| body.clone());
        let start = b"ply\nformat binary_little_endian 1.0\n".iter().copied();
        start.chain(head).chain(b"end_header\n".iter().copied()).chain(body).collect::<Vec<u8>>()
    };
    let names = [
        "x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2", "opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1",
        "rot_2", "rot_3",
    ];
    let count = gaussians.len();
    let full = file(&[ply(&format!("vertex {count}"), &names, "float", floats(gaussians.as_flattened()))]);
    let flat: Vec<f32> = gaussians.iter().flat_map(|g| [&g[..9], &g[10..]].concat()).collect();
    let flat_names = [&names[..9], &names[10..]].concat();
    let flat = file(&[ply(&format!("vertex {count}"), &flat_names, "float", floats(&flat))]);
    // One range for all: positions from −1 to 1, scales from −8 to 0.
    let ranges: Vec<f32> = [[-1.0; 3], [1.0; 3], [-8.0; 3], [0.0; 3]].concat().repeat(count.div_ceil(256));
    let fraction = |x: f32, low: f32, high: f32, bits: u32| {
        let most = ((1_u32 << bits) - 1) as f32;
        ((x - low) / (high - low) * most).round() as u32
    };
    let vector = |xyz: &[f32], low: f32, high: f32| {
        fraction(xyz[0], low, high, 11) << 21 | fraction(xyz[1], low, high, 10) << 11 | fraction(xyz[2], low, high, 11)
    };
    let words = |g: &[f32; 14]| {
        let rotation = &g[10..];
        let place = (0..4).max_by(|a, b| rotation[*a].abs().total_cmp(&rotation[*b].abs())).unwrap();
        let sign = rotation[place].signum();
        let half = core::f32::consts::FRAC_1_SQRT_2;
        let others = (0..4).filter(|i| *i != place).map(|i| fraction(sign * rotation[i], -half, half, 10));
        let packed = others.fold(place as u32, |word, other| word << 10 | other);
        let bytes = [0.5 + 0.282_094_8 * g[3], 0.5, 0.5 + 0.282_094_8 * g[5], 1.0 / (1.0 + (-g[6]).exp())];
        let color = bytes.iter().fold(0, |word, x| word << 8 | (x * 255.0).round() as u32);
        [vector(&g[..3], -1.0, 1.0), packed, vector(&g[7..10], -8.0, 0.0), color]
    };
    let vector_names = |name: &str| ["x", "y", "z"].map(|axis| format!("{name}_{axis}"));
    let range_names = ["min", "max", "min_scale", "max_scale"].map(vector_names).concat();
    let range_names: Vec<&str> = range_names.iter().map(String::as_str).collect();
    let word_names = ["packed_position", "packed_rotation", "packed_scale", "packed_color"];
    let packed: Vec<u8> = gaussians.iter().flat_map(words).flat_map(u32::to_le_bytes).collect();
    let packed = file(&[
        ply(&format!("chunk {}", count.div_ceil(256)), &range_names, "float", floats(&ranges)),
        ply(&format!("vertex {count}"), &word_names, "uint", packed),
    ]);
    let expected = read_splats(&full, true).unwrap();
    let radius = |mesh: &Mesh| mesh.positions().iter().map(|p| (p.length() - 1.0).abs()).fold(0.0, f32::max);
    assert!(radius(&expected.mesh) < 0.1, "{}", radius(&expected.mesh));
    for (name, bytes) in [("flat", flat), ("packed", packed)] {
        let read = read_splats(&bytes, true).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert!(radius(&read.mesh) < 0.1, "{name}: {}", radius(&read.mesh));
        let [found, all] = [&read, &expected].map(|read| f64::from(area(&read.mesh) as f32));
        assert!((found / all - 1.0).abs() < 0.05, "{name}: an area of {found}, not {all}");
        let mean = |read: &sim3align_formats::colored_mesh::ColoredMesh| {
            let colors = read.colors.as_ref().unwrap().colors();
            colors.iter().map(|rgb| f64::from(rgb[0])).sum::<f64>() / colors.len() as f64
        };
        assert!((mean(&read) - mean(&expected)).abs() < 2.0, "{name}: {} {}", mean(&read), mean(&expected));
    }
}

#[wasm_bindgen_test]
fn what_a_reader_does_not_know_is_named_and_what_does_not_matter_is_not() {
    let ply = |vertex: &str, face: &str, element: &str| {
        format!(
            "ply\nformat ascii 1.0\nobj_info x\ncomment x\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
            property float {vertex}\nelement face 1\nproperty list uchar int vertex_indices\nproperty int {face}\n\
            element {element} 1\nproperty float weight\nend_header\n0 0 0 1\n1 0 0 1\n0 1 0 1\n3 0 1 2 1\n1\n"
        )
    };
    let obj =
        |statement: &str| format!("o a\ng b\ns 1\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\n{statement} 1 2\nf 1 2 3\n");
    let gltf = |extension: &str| {
        let data = floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
        let json = r#"{"asset":{"version":"2.0"},"extensionsUsed":["EXTENSION"],"nodes":[{"mesh":0}],"meshes":[{"primitives":[
            {"attributes":{"POSITION":0}}]}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],
            "bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36}]}"#;
        glb(&json.replace("EXTENSION", extension), &data)
    };
    let known = [
        ply("nx", "flags", "edge").into_bytes(),
        ply("scalar_Curvature", "scalar_x", "camera").into_bytes(),
        ply("confidence", "quality", "camera").into_bytes(),
        obj("l").into_bytes(),
        obj("p").into_bytes(),
        gltf("KHR_materials_unlit"),
        gltf("KHR_texture_transform"),
        gltf("EXT_structural_metadata"),
    ];
    let unread = |bytes: &[u8]| read_colored_mesh(bytes, &MeshReadOptions::default()).unwrap().unread;
    for bytes in &known {
        assert_eq!(unread(bytes), Vec::<String>::new(), "{}", String::from_utf8_lossy(bytes));
    }
    for (bytes, name) in [
        (ply("bend", "flags", "edge").into_bytes(), "\"vertex.bend\""),
        (ply("nx", "material_index", "edge").into_bytes(), "\"face.material_index\""),
        (ply("nx", "flags", "patch").into_bytes(), "\"patch.weight\""),
        (obj("curv2").into_bytes(), "\"curv2\""),
        (gltf("ACME_bent"), "\"ACME_bent\""),
        (gltf("KHR_materials_new"), "\"KHR_materials_new\""),
    ] {
        let unread = unread(&bytes);
        assert!(unread.len() == 1 && unread[0].contains(name), "{unread:?} without {name}");
    }
    let library = |_: &str| Some(b"newmtl a\nNs 3\nillum 2\nmap_Bump x.png\nwarp 1\n".to_vec());
    let options = MeshReadOptions { resources: Some(&library), ..MeshReadOptions::default() };
    let with_library = format!("mtllib a.mtl\n{}", obj("l"));
    let unread = read_colored_mesh(with_library.as_bytes(), &options).unwrap().unread;
    assert!(unread.len() == 1 && unread[0].contains("statements \"warp\""), "{unread:?}");
}
