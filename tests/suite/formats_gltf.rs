//! glTF: hierarchies, every kind of accessor, and files that mean harm.

use sim3align::error::{Error, Result};
use sim3align_formats::mesh::{MeshReadOptions, external_resources, read_mesh};

use crate::formats_fixtures::{area, assert_near, bounds, corners, fixture, glb};
use crate::prelude::*;

fn read(bytes: &[u8]) -> Result<Mesh> {
    read_mesh(bytes, &MeshReadOptions::default())
}

fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|x| x.to_le_bytes()).collect()
}

/// A quad's four vertices, 48 bytes, then the indices 0 1 2 3 as u16, 8 bytes, then 2 1 3 0 as u8, 4 bytes.
fn quad_bytes() -> Vec<u8> {
    let mut bytes = floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0]);
    bytes.extend([0, 0, 1, 0, 2, 0, 3, 0, 2, 1, 3, 0]);
    bytes
}

/// A scene of these nodes, primitives (of mesh 0), accessors and views on [`quad_bytes`].
fn scene_of(nodes: &str, primitives: &str, accessors: &str, views: &str, more: &str) -> Vec<u8> {
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"nodes":[{nodes}],"meshes":[{{"primitives":[{primitives}]}}],
        "accessors":[{accessors}],"bufferViews":[{views}],"buffers":[{{"byteLength":60}}]{more}}}"#
    );
    glb(&json, &quad_bytes())
}

const VIEWS: &str = r#"{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":12}"#;
const ACCESSORS: &str = r#"{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},
    {"bufferView":1,"componentType":5123,"count":4,"type":"SCALAR"},
    {"bufferView":1,"byteOffset":8,"componentType":5121,"count":3,"type":"SCALAR"}"#;

fn primitive_of(primitive: &str) -> Result<Mesh> {
    read(&scene_of(r#"{"mesh":0}"#, primitive, ACCESSORS, VIEWS, ""))
}

fn nodes_of(nodes: &str, more: &str) -> Result<Mesh> {
    read(&scene_of(nodes, r#"{"attributes":{"POSITION":0},"indices":2}"#, ACCESSORS, VIEWS, more))
}

fn accessors_of(accessors: &str, views: &str) -> Result<Mesh> {
    let primitive = r#"{"attributes":{"POSITION":0},"indices":1,"mode":5}"#;
    read(&scene_of(r#"{"mesh":0}"#, primitive, accessors, views, ""))
}

#[wasm_bindgen_test(unsupported = test)]
fn a_nested_mirrored_instanced_scene_is_what_trimesh_flattens_it_to() {
    // The figures are those that make_fixtures.py prints of trimesh's own flattening. The volume is positive:
    // the mirrored box faces outward, too.
    let mesh = read(fixture!("scene.glb")).unwrap();
    assert_eq!((mesh.positions().len(), mesh.triangles().len()), (16, 24));
    assert_near(area(&mesh), 54.0, 1e-6);
    assert_near(mesh.signed_volume6() / 6.0, 18.0, 1e-6);
    let [low, high] = bounds(&mesh);
    for (found, expected) in low.iter().chain(&high).zip([4.0, -1.0, -1.5, 11.0, 1.0, 1.5]) {
        assert_near(f64::from(*found), expected, 1e-6);
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn external_buffers_come_from_the_caller() {
    let gltf = fixture!("mesh-external.gltf");
    let names = external_resources(gltf).unwrap();
    assert_eq!(names.shape, ["gltf_buffer_0.bin", "gltf_buffer_1.bin"]);
    assert_eq!((names.colors.len(), external_resources(fixture!("mesh.glb")).unwrap().shape.len()), (0, 0));
    let files = |uri: &str| match uri {
        "gltf_buffer_0.bin" => Some(fixture!("mesh-external-gltf_buffer_0.bin").to_vec()),
        "gltf_buffer_1.bin" => Some(fixture!("mesh-external-gltf_buffer_1.bin").to_vec()),
        _ => None,
    };
    let mesh = read_mesh(gltf, &MeshReadOptions { format: None, resources: Some(&files) }).unwrap();
    assert_eq!(corners(&mesh), corners(&read(fixture!("mesh.glb")).unwrap()));
    let error = read(gltf).unwrap_err();
    assert_eq!((error.code, &*error.argument), (ErrorCode::InvalidArgument, "options.resources"));
    assert!(error.found.contains("gltf_buffer_"), "{error}");
    let short = |uri: &str| files(uri).map(|bytes| bytes[..20].to_vec());
    let error = read_mesh(gltf, &MeshReadOptions { format: None, resources: Some(&short) }).unwrap_err();
    assert_eq!(error.code, ErrorCode::CorruptFile);
    // Names with blanks are asked for as written, then decoded.
    let spaced = String::from_utf8(gltf.to_vec()).unwrap().replace("gltf_buffer_0.bin", "gltf%5Fbuffer_0.bin");
    let options = MeshReadOptions { format: None, resources: Some(&files) };
    assert_eq!(read_mesh(spaced.as_bytes(), &options).unwrap(), mesh);
}

#[wasm_bindgen_test(unsupported = test)]
fn lists_strips_and_fans_wind_as_the_format_says() {
    let triangles = |mode: &str| {
        let mesh = primitive_of(&format!(r#"{{"attributes":{{"POSITION":0}},"indices":1{mode}}}"#)).unwrap();
        (mesh.triangles().to_vec(), mesh.positions().len())
    };
    assert_eq!(triangles(r#","mode":5"#), (vec![[0, 1, 2], [1, 3, 2]], 4));
    assert_eq!(triangles(r#","mode":6"#), (vec![[0, 1, 2], [0, 2, 3]], 4));
    // Without indices; four corners are no triangle list.
    assert_eq!(primitive_of(r#"{"attributes":{"POSITION":0},"mode":5}"#).unwrap().triangles(), [[0, 1, 2], [1, 3, 2]]);
    assert_eq!(primitive_of(r#"{"attributes":{"POSITION":0}}"#).unwrap_err().code, ErrorCode::CorruptFile);
    // Bytes as indices, 2 1 3: vertex 0 is not used and left out.
    let mesh = primitive_of(r#"{"attributes":{"POSITION":0},"indices":2}"#).unwrap();
    assert_eq!((mesh.triangles(), mesh.positions().len()), ([[1, 0, 2]].as_slice(), 3));
    assert_eq!(mesh.positions()[0].to_array(), [1.0, 0.0, 0.0]);
    // Points and lines beside triangles are passed over; alone they are no mesh.
    let points = r#"{"attributes":{"POSITION":0},"mode":0},{"attributes":{"POSITION":0},"mode":1}"#;
    let both = format!(r#"{points},{{"attributes":{{"POSITION":0}},"indices":2}}"#);
    assert_eq!(primitive_of(&both).unwrap().triangles().len(), 1);
    assert_eq!(primitive_of(points).unwrap_err().code, ErrorCode::EmptyMesh);
    assert_eq!(primitive_of(r#"{"attributes":{"POSITION":0},"mode":7}"#).unwrap_err().code, ErrorCode::CorruptFile);
    assert_eq!(primitive_of(r#"{"attributes":{"NORMAL":0}}"#).unwrap_err().code, ErrorCode::EmptyMesh);
}

#[wasm_bindgen_test(unsupported = test)]
fn node_transforms_compose_and_scenes_choose() {
    // Vertex 2 1 3 of the quad: (0,1,0), (1,0,0), (1,1,0); a child of a translation below a quarter turn about z.
    let nested = r#"{"rotation":[0,0,0.7071067811865476,0.7071067811865476],"children":[1]},
        {"translation":[10,0,0],"scale":[2,2,2],"mesh":0}"#;
    let mesh = nodes_of(nested, "").unwrap();
    for (found, expected) in mesh.positions().iter().zip([[0.0, 12.0, 0.0], [-2.0, 10.0, 0.0], [-2.0, 12.0, 0.0]]) {
        assert!((*found - Vec3::from_array(expected)).length() < 1e-5, "{found} instead of {expected:?}");
    }
    // The same as one matrix, column by column.
    let matrix = r#"{"mesh":0,"matrix":[0,2,0,0,-2,0,0,0,0,0,2,0,0,10,0,1]}"#;
    for (a, b) in nodes_of(matrix, "").unwrap().positions().iter().zip(mesh.positions()) {
        assert!((*a - *b).length() < 1e-5);
    }
    let two = r#"{"mesh":0},{"mesh":0,"translation":[5,0,0]}"#;
    let highest = |more: &str| bounds(&nodes_of(two, more).unwrap())[1][0];
    assert_eq!(nodes_of(two, "").unwrap().triangles().len(), 2);
    assert_eq!(highest(r#","scenes":[{"nodes":[0]},{"nodes":[1]}],"scene":1"#), 6.0);
    assert_eq!(highest(r#","scenes":[{"nodes":[0]},{"nodes":[1]}]"#), 1.0);
    let error = nodes_of(two, r#","scenes":[{"nodes":[0]}],"scene":3"#).unwrap_err();
    assert_eq!(error.code, ErrorCode::CorruptFile);
    assert_eq!(nodes_of(two, r#","scenes":[{}]"#).unwrap_err().code, ErrorCode::EmptyMesh);
    // A mirror turns triangles round.
    let mirrored = nodes_of(r#"{"mesh":0,"scale":[-1,1,1]}"#, "").unwrap();
    assert_eq!(mirrored.triangles(), [[1, 2, 0]]);
}

#[wasm_bindgen_test(unsupported = test)]
fn cycles_shared_children_and_missing_nodes_are_refused() {
    let code = |nodes: &str, more: &str| nodes_of(nodes, more).unwrap_err().code;
    let scene = r#","scenes":[{"nodes":[0]}]"#;
    assert_eq!(code(r#"{"children":[0],"mesh":0}"#, scene), ErrorCode::CorruptFile);
    assert_eq!(code(r#"{"children":[1]},{"children":[0],"mesh":0}"#, scene), ErrorCode::CorruptFile);
    assert_eq!(code(r#"{"children":[1,1]},{"mesh":0}"#, scene), ErrorCode::CorruptFile);
    assert_eq!(code(r#"{"children":[7]}"#, scene), ErrorCode::CorruptFile);
    assert_eq!(code(r#"{"mesh":7}"#, scene), ErrorCode::CorruptFile);
    // A cycle without scene has no root, thus no mesh.
    assert_eq!(code(r#"{"children":[1]},{"children":[0],"mesh":0}"#, ""), ErrorCode::EmptyMesh);
    // Depth is no danger: nothing recurses.
    let mut chain: Vec<String> = (1..100_000).map(|i| format!(r#"{{"children":[{i}]}}"#)).collect();
    chain.push(r#"{"mesh":0}"#.into());
    assert_eq!(nodes_of(&chain.join(","), scene).unwrap().triangles().len(), 1);
}

#[wasm_bindgen_test(unsupported = test)]
fn quantised_interleaved_and_sparse_positions_are_decoded() {
    // Normalised bytes: 127 is 1, and −128 is −1 like −127 (KHR_mesh_quantization); 4 bytes apart.
    let positions = r#"{"bufferView":0,"componentType":5120,"normalized":true,"count":4,"type":"VEC3"}"#;
    let indices = r#"{"componentType":5121,"count":0,"type":"SCALAR"}"#;
    let mut bytes: Vec<u8> = vec![0, 0, 0, 99, 127, 0, 0, 99, 0, 129, 0, 99, 128, 127, 64, 99];
    bytes.extend(0xffff_u16.to_le_bytes().repeat(12));
    let read_positions = |positions: &str| {
        let json = format!(
            r#"{{"asset":{{"version":"2.0"}},"nodes":[{{"mesh":0}}],
            "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"mode":5}}]}}],
            "accessors":[{positions},{indices}],"buffers":[{{"byteLength":40}}],
            "bufferViews":[{{"buffer":0,"byteLength":16,"byteStride":4}},{{"buffer":0,"byteOffset":16,"byteLength":24}}],
            "extensionsRequired":["KHR_mesh_quantization"]}}"#
        );
        read(&glb(&json, &bytes)).map(|mesh| mesh.positions().iter().map(|p| p.to_array()).collect::<Vec<_>>())
    };
    let quarter = 64.0 / 127.0;
    let expected = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [-1.0, 1.0, quarter]];
    assert_eq!(read_positions(positions).unwrap(), expected);
    let plain = positions.replace(r#""normalized":true,"#, "");
    assert_eq!(read_positions(&plain).unwrap()[3], [-128.0, 127.0, 64.0]);
    let unsigned = plain.replace("5120", "5121");
    assert_eq!(read_positions(&unsigned).unwrap()[3], [128.0, 127.0, 64.0]);
    let short =
        |kind: &str| format!(r#"{{"bufferView":1,"componentType":{kind},"normalized":true,"count":4,"type":"VEC3"}}"#);
    assert_eq!(read_positions(&short("5123")).unwrap()[0], [1.0; 3]);
    assert_eq!(read_positions(&short("5122")).unwrap()[0], [-1.0 / 32767.0; 3]);
    // Zeros where a sparse accessor has no view of its own; two of three elements replaced.
    let sparse = r#"{"componentType":5126,"count":3,"type":"VEC3","sparse":{"count":2,
        "indices":{"bufferView":1,"byteOffset":2,"componentType":5123},"values":{"bufferView":0,"byteOffset":12}}}"#;
    let sparse_indices = r#"{"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}"#;
    let mesh = accessors_of(&format!("{sparse},{sparse_indices}"), VIEWS).unwrap();
    let positions: Vec<_> = mesh.positions().iter().map(|p| p.to_array()).collect();
    assert_eq!(positions, [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
}

#[wasm_bindgen_test(unsupported = test)]
fn accessors_beyond_their_bytes_are_refused() {
    let indices = r#"{"bufferView":1,"componentType":5123,"count":4,"type":"SCALAR"}"#;
    let position = |fields: &str| {
        let accessors = format!(r#"{{"componentType":5126,"type":"VEC3",{fields}}},{indices}"#);
        accessors_of(&accessors, VIEWS).map(|mesh| mesh.triangles().len())
    };
    let view = |view: &str| {
        let position = r#"{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"}"#;
        let views = format!(r#"{view},{{"buffer":0,"byteOffset":48,"byteLength":12}}"#);
        accessors_of(&format!("{position},{indices}"), &views).map(|mesh| mesh.triangles().len())
    };
    let code = |result: Result<usize>| result.map_err(|error: Error| error.code);
    assert_eq!(code(position(r#""bufferView":0,"count":4"#)), Ok(2));
    for (fields, expected) in [
        (r#""bufferView":0,"count":5"#, ErrorCode::CorruptFile),
        (r#""bufferView":0,"count":4,"byteOffset":4"#, ErrorCode::CorruptFile),
        (r#""bufferView":0,"count":4,"byteOffset":18446744073709551615"#, ErrorCode::CorruptFile),
        (r#""bufferView":9,"count":4"#, ErrorCode::CorruptFile),
        (r#""bufferView":0,"count":4000000000"#, ErrorCode::FileTooLarge),
        (r#""bufferView":0,"count":18446744073709551615"#, ErrorCode::FileTooLarge),
        // Zeros that no bytes vouch for.
        (r#""count":4000000000"#, ErrorCode::FileTooLarge),
        // One index of four has no vertex.
        (r#""bufferView":0,"count":3"#, ErrorCode::IndexOutOfRange),
        (r#""bufferView":0,"count":0"#, ErrorCode::IndexOutOfRange),
    ] {
        assert_eq!(code(position(fields)), Err(expected), "{fields}");
    }
    // An accessor without view is zeros: legal, if pointless without sparse values.
    assert_eq!(code(position(r#""count":4"#)), Ok(2));
    for fields in [
        r#"{"buffer":0,"byteLength":47}"#,
        r#"{"buffer":0,"byteOffset":50,"byteLength":48}"#,
        r#"{"buffer":0,"byteOffset":18446744073709551600,"byteLength":48}"#,
        r#"{"buffer":0,"byteLength":18446744073709551615}"#,
        r#"{"buffer":0,"byteLength":48,"byteStride":16}"#,
        r#"{"buffer":0,"byteLength":48,"byteStride":0}"#,
        r#"{"buffer":5,"byteLength":48}"#,
    ] {
        assert_eq!(code(view(fields)), Err(ErrorCode::CorruptFile), "{fields}");
    }
    let wrong_type = format!(r#"{{"bufferView":0,"componentType":5126,"count":4,"type":"VEC2"}},{indices}"#);
    assert_eq!(accessors_of(&wrong_type, VIEWS).unwrap_err().code, ErrorCode::CorruptFile);
    let no_type = format!(r#"{{"bufferView":0,"componentType":1,"count":4,"type":"VEC3"}},{indices}"#);
    assert_eq!(accessors_of(&no_type, VIEWS).unwrap_err().code, ErrorCode::CorruptFile);
}

#[wasm_bindgen_test(unsupported = test)]
fn a_small_file_that_claims_much_is_refused() {
    let mut claims_4_gb = glb("{}", &[]);
    claims_4_gb.resize(100, 0);
    claims_4_gb[8..12].copy_from_slice(&u32::MAX.to_le_bytes());
    assert_eq!(read(&claims_4_gb).unwrap_err().code, ErrorCode::FileTooLarge);
    claims_4_gb[8..12].copy_from_slice(&200_u32.to_le_bytes());
    assert_eq!(read(&claims_4_gb).unwrap_err().code, ErrorCode::CorruptFile);
    let mut version_1 = glb("{}", &[]);
    version_1[4] = 1;
    assert_eq!(read(&version_1).unwrap_err().code, ErrorCode::UnsupportedFormat);
    // A million nodes, each of them a triangle, are more objects than are parsed.
    let nodes = vec![r#"{"mesh":0}"#; (1 << 20) + 1].join(",");
    assert_eq!(nodes_of(&nodes, "").unwrap_err().code, ErrorCode::FileTooLarge);
    // A hundred thousand instances of a thousand triangles are more than a mesh may have.
    let zeros =
        r#"{"componentType":5126,"count":600,"type":"VEC3"},{"componentType":5121,"count":1000,"type":"SCALAR"}"#;
    let many = vec![r#"{"mesh":0}"#; 100_000].join(",");
    let instances = scene_of(&many, r#"{"attributes":{"POSITION":0}}"#, zeros, VIEWS, "");
    assert_eq!(read(&instances).unwrap_err().code, ErrorCode::FileTooLarge);
}

#[wasm_bindgen_test(unsupported = test)]
fn compressed_and_unknown_extensions_name_themselves_and_the_remedy() {
    // As gltfpack and glTF-Transform write them: the accessors' bytes are not in any buffer of the plain format.
    let draco = scene_of(
        r#"{"mesh":0}"#,
        r#"{"attributes":{"POSITION":0},"indices":1,"extensions":{"KHR_draco_mesh_compression":{"bufferView":0}}}"#,
        r#"{"componentType":5126,"count":4,"type":"VEC3"},{"componentType":5123,"count":6,"type":"SCALAR"}"#,
        VIEWS,
        r#","extensionsUsed":["KHR_draco_mesh_compression"],"extensionsRequired":["KHR_draco_mesh_compression"]"#,
    );
    let meshopt = |name: &str| {
        glb(
            &format!(
                r#"{{"asset":{{"version":"2.0"}},"nodes":[{{"mesh":0}}],
                "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],"accessors":[{ACCESSORS}],
                "bufferViews":[{{"buffer":1,"byteLength":48,"extensions":{{"{name}":{{"buffer":0}}}}}}],
                "buffers":[{{"byteLength":60}},{{"byteLength":48,"extensions":{{"{name}":{{"fallback":true}}}}}}],
                "extensionsUsed":["{name}"],"extensionsRequired":["{name}","KHR_mesh_quantization"]}}"#
            ),
            &quad_bytes(),
        )
    };
    for (bytes, name) in [
        (draco, "KHR_draco_mesh_compression"),
        (meshopt("EXT_meshopt_compression"), "EXT_meshopt_compression"),
        (meshopt("KHR_meshopt_compression"), "KHR_meshopt_compression"),
    ] {
        let error = read(&bytes).unwrap_err();
        assert_eq!(error.code, ErrorCode::CompressedMesh);
        assert!(error.found.contains(name) && error.remedy.contains("npx @gltf-transform/cli copy"), "{error}");
    }
    // An uncompressed fallback is read.
    let fallback = nodes_of(r#"{"mesh":0}"#, r#","extensionsUsed":["KHR_draco_mesh_compression"]"#);
    assert_eq!(fallback.unwrap().triangles().len(), 1);
    let required = |name: &str| nodes_of(r#"{"mesh":0}"#, &format!(r#","extensionsRequired":["{name}"]"#));
    let error = required("EXT_mesh_gpu_instancing").unwrap_err();
    assert_eq!(error.code, ErrorCode::UnsupportedFormat);
    assert!(error.found.contains("EXT_mesh_gpu_instancing") && error.expected.contains("KHR_mesh_quantization"));
    for harmless in ["KHR_materials_unlit", "KHR_texture_basisu", "EXT_texture_webp", "KHR_mesh_quantization"] {
        assert!(required(harmless).is_ok(), "{harmless}");
    }
    // What is not needed is not parsed: textures without source, materials of the future.
    let odd = r#","textures":[{"extensions":{"EXT_texture_webp":{"source":0}}}],"materials":[{"alphaMode":5}],"animations":{}"#;
    assert!(nodes_of(r#"{"mesh":0}"#, odd).is_ok());
}

#[wasm_bindgen_test(unsupported = test)]
fn data_uris_may_be_of_any_flavour() {
    let text = String::from_utf8(fixture!("mesh-data-uri.gltf").to_vec()).unwrap();
    let expected = read(text.as_bytes()).unwrap();
    assert!(text.contains("data:application/octet-stream;base64,"));
    assert_eq!(read(text.replace("application/octet-stream", "").as_bytes()).unwrap(), expected);
    assert_eq!(read(text.replace('/', "%2F").replace("%2Foctet", "/octet").as_bytes()).unwrap(), expected);
    let with_mark = [b"\xef\xbb\xbf".as_slice(), text.as_bytes()].concat();
    assert_eq!(read(&with_mark).unwrap(), expected);
    let code = |text: String| read(text.as_bytes()).unwrap_err().code;
    assert_eq!(code(text.replace("base64,", "base64,!")), ErrorCode::CorruptFile);
    assert_eq!(code(text.replace("base64,", "base64;")), ErrorCode::CorruptFile);
    assert_eq!(code(text.replace(";base64,", ",")), ErrorCode::IndexOutOfRange);
}
