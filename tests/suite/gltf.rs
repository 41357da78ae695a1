//! glTF: hierarchies, every kind of accessor, and files that mean harm.

use sim3align::error::Result;
use sim3align_formats::mesh::{MeshReadOptions, external_resources, read_colored_mesh, read_mesh};

use crate::fixtures::{corners, fixture, floats, glb, read};
use crate::prelude::*;

/// A quad's four vertices, 48 bytes, then the indices 0 1 2 3 as u16, 8 bytes, then 2 1 3 0 as u8, 4 bytes.
fn quad_bytes() -> Vec<u8> {
    let mut bytes = floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0]);
    bytes.extend([0, 0, 1, 0, 2, 0, 3, 0, 2, 1, 3, 0]);
    bytes
}

/// A scene of these nodes, primitives (of mesh 0), accessors and views on [`quad_bytes`].
fn scene_of(nodes: &str, primitives: &str, accessors: &str, views: &str, more: &str) -> Vec<u8> {
    // Properties of the mesh may follow its primitives.
    let (primitives, weights) = primitives.split_once(';').unwrap_or((primitives, ""));
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"nodes":[{nodes}],"meshes":[{{"primitives":[{primitives}]{weights}}}],
        "accessors":[{accessors}],"bufferViews":[{views}],"buffers":[{{"byteLength":60}}]{more}}}"#
    );
    glb(&json, &quad_bytes())
}

const VIEWS: &str = r#"{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":12}"#;
const ACCESSORS: &str = r#"{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},
    {"bufferView":1,"componentType":5123,"count":4,"type":"SCALAR"},
    {"bufferView":1,"byteOffset":8,"componentType":5121,"count":3,"type":"SCALAR"}"#;

fn primitive_of(primitive: &str) -> Result<Mesh> {
    read(scene_of(r#"{"mesh":0}"#, primitive, ACCESSORS, VIEWS, ""))
}

fn nodes_of(nodes: &str, more: &str) -> Result<Mesh> {
    read(scene_of(nodes, r#"{"attributes":{"POSITION":0},"indices":2}"#, ACCESSORS, VIEWS, more))
}

fn accessors_of(accessors: &str, views: &str) -> Result<Mesh> {
    let primitive = r#"{"attributes":{"POSITION":0},"indices":1,"mode":5}"#;
    read(scene_of(r#"{"mesh":0}"#, primitive, accessors, views, ""))
}

#[wasm_bindgen_test]
fn external_buffers_come_from_the_caller() {
    let gltf = fixture!("mesh-external.gltf");
    assert_eq!(external_resources(gltf).unwrap().shape, ["gltf_buffer_0.bin", "gltf_buffer_1.bin"]);
    let files = |uri: &str| match uri {
        "gltf_buffer_0.bin" => Some(fixture!("mesh-external-gltf_buffer_0.bin").to_vec()),
        "gltf_buffer_1.bin" => Some(fixture!("mesh-external-gltf_buffer_1.bin").to_vec()),
        _ => None,
    };
    let options = MeshReadOptions { format: None, resources: Some(&files), ..MeshReadOptions::default() };
    let mesh = read_mesh(gltf, &options).unwrap();
    assert_eq!(corners(&mesh), corners(&read(fixture!("mesh.glb")).unwrap()));
    let error = read(gltf).unwrap_err();
    assert_eq!((error.code, &*error.argument), (ErrorCode::InvalidArgument, "options.resources"));
    // Names with blanks are asked for as written, then decoded.
    let spaced = String::from_utf8(gltf.to_vec()).unwrap().replace("gltf_buffer_0.bin", "gltf%5Fbuffer_0.bin");
    assert_eq!(read_mesh(spaced.as_bytes(), &options).unwrap(), mesh);
}

#[wasm_bindgen_test]
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

#[wasm_bindgen_test]
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
    let highest = |more: &str| Bounds::of(nodes_of(two, more).unwrap().positions()).unwrap().max.x;
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

#[wasm_bindgen_test]
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
        read(glb(&json, &bytes)).map(|mesh| mesh.positions().iter().map(|p| p.to_array()).collect::<Vec<_>>())
    };
    let quarter = 64.0 / 127.0;
    let expected = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [-1.0, 1.0, quarter]];
    assert_eq!(read_positions(positions).unwrap(), expected);
    let unsigned = positions.replace(r#""normalized":true,"#, "").replace("5120", "5121");
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

#[wasm_bindgen_test]
fn hierarchies_and_counts_that_mean_harm_are_refused() {
    use ErrorCode::{CorruptFile, EmptyMesh, FileTooLarge, UnsupportedFormat};
    let scene = r#","scenes":[{"nodes":[0]}]"#;
    let million = vec![r#"{"mesh":0}"#; (1 << 20) + 1].join(",");
    for (nodes, more, code) in [
        (r#"{"children":[1]},{"children":[0],"mesh":0}"#, scene, CorruptFile),
        (r#"{"children":[1,1]},{"mesh":0}"#, scene, CorruptFile),
        (r#"{"children":[7]}"#, scene, CorruptFile),
        (r#"{"mesh":7}"#, scene, CorruptFile),
        // A cycle without scene has no root, thus no mesh.
        (r#"{"children":[1]},{"children":[0],"mesh":0}"#, "", EmptyMesh),
        (&million, "", FileTooLarge),
    ] {
        assert_eq!(nodes_of(nodes, more).unwrap_err().code, code, "{:.60} {more}", nodes);
    }
    // Depth is no danger: nothing recurses.
    let mut chain: Vec<String> = (1..100_000).map(|i| format!(r#"{{"children":[{i}]}}"#)).collect();
    chain.push(r#"{"mesh":0}"#.into());
    assert_eq!(nodes_of(&chain.join(","), scene).unwrap().triangles().len(), 1);
    // A hundred thousand instances of a thousand triangles are more than a mesh may have.
    let zeros =
        r#"{"componentType":5126,"count":600,"type":"VEC3"},{"componentType":5121,"count":1000,"type":"SCALAR"}"#;
    let many = vec![r#"{"mesh":0}"#; 100_000].join(",");
    let instances = scene_of(&many, r#"{"attributes":{"POSITION":0}}"#, zeros, VIEWS, "");
    assert_eq!(read(&instances).unwrap_err().code, FileTooLarge);
    for (place, value, code) in [(4, 1, UnsupportedFormat), (8, u32::MAX, FileTooLarge), (8, 200, CorruptFile)] {
        let mut bytes = glb("{}", &[0; 60]);
        bytes[place..place + 4].copy_from_slice(&u32::to_le_bytes(value));
        assert_eq!(read(&bytes).unwrap_err().code, code, "{place}: {value}");
    }
}

#[wasm_bindgen_test]
fn accessors_beyond_their_bytes_are_refused() {
    use ErrorCode::{CorruptFile, FileTooLarge, IndexOutOfRange};
    let good = r#"{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"}"#;
    let view = r#"{"buffer":0,"byteLength":48}"#;
    let read = |position: &str, view: &str| {
        let indices = r#"{"bufferView":1,"componentType":5123,"count":4,"type":"SCALAR"}"#;
        let views = format!(r#"{view},{{"buffer":0,"byteOffset":48,"byteLength":12}}"#);
        accessors_of(&format!("{position},{indices}"), &views).map(|mesh| mesh.triangles().len())
    };
    assert_eq!(read(good, view), Ok(2));
    for (from, to, code) in [
        (r#""count":4"#, r#""count":5"#, CorruptFile),
        (r#""count":4"#, r#""count":4,"byteOffset":4"#, CorruptFile),
        (r#""count":4"#, r#""count":4000000000"#, FileTooLarge),
        (r#""count":4"#, r#""count":18446744073709551615"#, FileTooLarge),
        // One index of four has no vertex.
        (r#""count":4"#, r#""count":3"#, IndexOutOfRange),
        (r#""bufferView":0"#, r#""bufferView":9"#, CorruptFile),
        ("VEC3", "VEC2", CorruptFile),
        ("5126", "1", CorruptFile),
        // Zeros that no bytes vouch for.
        (
            r#""bufferView":0,"componentType":5126,"count":4"#,
            r#""componentType":5126,"count":4000000000"#,
            FileTooLarge,
        ),
    ] {
        assert_eq!(read(&good.replace(from, to), view).unwrap_err().code, code, "{to}");
    }
    for view in [
        r#"{"buffer":0,"byteLength":47}"#,
        r#"{"buffer":0,"byteOffset":18446744073709551600,"byteLength":48}"#,
        r#"{"buffer":0,"byteLength":18446744073709551615}"#,
        r#"{"buffer":0,"byteLength":48,"byteStride":16}"#,
        r#"{"buffer":0,"byteLength":48,"byteStride":0}"#,
        r#"{"buffer":5,"byteLength":48}"#,
    ] {
        assert_eq!(read(good, view).unwrap_err().code, CorruptFile, "{view}");
    }
}

#[wasm_bindgen_test]
fn extensions_that_are_needed_name_themselves_and_the_remedy() {
    // As gltfpack and glTF-Transform write them: the accessors' bytes are not in any buffer of the plain format.
    let draco = scene_of(
        r#"{"mesh":0}"#,
        r#"{"attributes":{"POSITION":0},"indices":1,"extensions":{"KHR_draco_mesh_compression":{"bufferView":0}}}"#,
        r#"{"componentType":5126,"count":4,"type":"VEC3"},{"componentType":5123,"count":6,"type":"SCALAR"}"#,
        VIEWS,
        r#","extensionsRequired":["KHR_draco_mesh_compression"]"#,
    );
    let meshopt = |name: &str| {
        let view = format!(r#"{{"buffer":1,"byteLength":48,"extensions":{{"{name}":{{"buffer":0}}}}}}"#);
        let more = format!(r#","extensionsRequired":["{name}","KHR_mesh_quantization"]"#);
        scene_of(r#"{"mesh":0}"#, r#"{"attributes":{"POSITION":0}}"#, ACCESSORS, &view, &more)
    };
    for (bytes, name) in [
        (draco, "KHR_draco_mesh_compression"),
        (meshopt("EXT_meshopt_compression"), "EXT_meshopt_compression"),
        (meshopt("KHR_meshopt_compression"), "KHR_meshopt_compression"),
    ] {
        let error = read(&bytes).unwrap_err();
        assert_eq!(error.code, ErrorCode::CompressedMesh, "{error}");
        assert!(error.found.contains(name) && error.remedy.contains("npx "), "{error}");
    }
    let required = |name: &str| nodes_of(r#"{"mesh":0}"#, &format!(r#","extensionsRequired":["{name}"]"#));
    let error = required("EXT_of_the_future").unwrap_err();
    assert!(error.code == ErrorCode::UnsupportedFormat && error.found.contains("EXT_of_the_future"), "{error}");
    for harmless in ["KHR_materials_unlit", "KHR_texture_basisu", "EXT_texture_webp", "KHR_mesh_quantization"] {
        assert!(required(harmless).is_ok(), "{harmless}");
    }
    // What is not needed is not parsed: a fallback, textures without source, materials of the future.
    let odd = r#","extensionsUsed":["KHR_draco_mesh_compression"],"materials":[{"alphaMode":5}],"animations":{},
        "textures":[{"extensions":{"EXT_texture_webp":{"source":0}}}]"#;
    assert!(nodes_of(r#"{"mesh":0}"#, odd).is_ok());
}

#[wasm_bindgen_test]
fn instances_are_copies_with_transforms_of_their_own() {
    // Two instances: as it is, and moved by (0, 0, 5), turned by half a turn about z, three times as large.
    let mut bytes = quad_bytes();
    bytes.extend(floats(&[
        0.0, 0.0, 0.0, 0.0, 0.0, 5.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 1.0, 3.0, 3.0, 3.0,
    ]));
    let instances = r#"{"mesh":0,"translation":[10,0,0],"extensions":{"EXT_mesh_gpu_instancing":{"attributes":
        {"TRANSLATION":3,"ROTATION":4,"SCALE":5}}}}"#;
    let part = |offset: u32, kind: &str| {
        format!(r#",{{"bufferView":2,"byteOffset":{offset},"componentType":5126,"count":2,"type":"{kind}"}}"#)
    };
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"extensionsRequired":["EXT_mesh_gpu_instancing"],"nodes":[{instances}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":2}}]}}],
        "accessors":[{ACCESSORS}{}{}{}],"bufferViews":[{VIEWS},{{"buffer":0,"byteOffset":60,"byteLength":80}}],
        "buffers":[{{"byteLength":140}}]}}"#,
        part(0, "VEC3"),
        part(24, "VEC4"),
        part(56, "VEC3")
    );
    let file = glb(&json, &bytes);
    assert_eq!(read_colored_mesh(&file, &MeshReadOptions::default()).unwrap().copies, 2);
    let mesh = read(file).unwrap();
    let bounds = Bounds::of(mesh.positions()).unwrap();
    assert_eq!(mesh.triangles().len(), 2);
    assert_eq!([bounds.min.to_array(), bounds.max.to_array()], [[7.0, -3.0, 0.0], [11.0, 1.0, 5.0]]);
}

#[wasm_bindgen_test]
fn skins_have_the_pose_of_their_joints() {
    // Each vertex follows joint 0, the last one both to equal parts. Joint 0 is 100 times smaller than its bind pose and
    // moved by (1, 0, 0); joint 1 as well, but moved by (3, 0, 0).
    let mut bytes = quad_bytes();
    bytes.extend([0_u8, 1, 0, 0].repeat(4));
    bytes.extend(floats(&[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.5, 0.5, 0.0, 0.0]));
    let bind = [[1.0_f32, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];
    bytes.extend(floats(&[bind, bind].concat().concat()));
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"scenes":[{{"nodes":[0,1,2]}}],
        "nodes":[{{"mesh":0,"skin":0,"translation":[50,0,0]}},{{"translation":[1,0,0],"scale":[0.01,0.01,0.01]}},
        {{"translation":[3,0,0],"scale":[0.01,0.01,0.01]}}],
        "skins":[{{"joints":[1,2],"inverseBindMatrices":5}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"JOINTS_0":3,"WEIGHTS_0":4}},"indices":1,"mode":5}}]}}],
        "accessors":[{ACCESSORS},{{"bufferView":2,"componentType":5121,"count":4,"type":"VEC4"}},
        {{"bufferView":3,"componentType":5126,"count":4,"type":"VEC4"}},
        {{"bufferView":4,"componentType":5126,"count":2,"type":"MAT4"}}],
        "bufferViews":[{VIEWS},{{"buffer":0,"byteOffset":60,"byteLength":16}},{{"buffer":0,"byteOffset":76,"byteLength":64}},
        {{"buffer":0,"byteOffset":140,"byteLength":128}}],"buffers":[{{"byteLength":268}}]}}"#
    );
    let mesh = read(glb(&json, &bytes)).unwrap();
    let expected = [[1.0, 0.0, 0.0], [1.01, 0.0, 0.0], [1.0, 0.01, 0.0], [2.01, 0.01, 0.0]];
    for (found, expected) in mesh.positions().iter().zip(expected) {
        assert!((*found - Vec3::from_array(expected)).abs().max_element() < 1e-6, "{found} is not {expected:?}");
    }
    let outside = json.replace(r#""nodes":[0,1,2]"#, r#""nodes":[0,1]"#);
    assert_eq!(read(glb(&outside, &bytes)).unwrap_err().code, ErrorCode::CorruptFile);
}

#[wasm_bindgen_test]
fn morph_targets_have_their_default_weights_and_hidden_nodes_are_left_out() {
    let primitive = r#"{"attributes":{"POSITION":0},"indices":2,"targets":[{"NORMAL":0},{"POSITION":0}]}"#;
    // Vertices 2, 1 and 3 of the quad; the target adds their positions once more.
    let largest = |nodes: &str, weights: &str| {
        let mesh = read(scene_of(nodes, &format!("{primitive};{weights}"), ACCESSORS, VIEWS, "")).unwrap();
        let largest = mesh.positions().iter().fold(0.0, |most: f32, p| most.max(p.max_element()));
        (largest, mesh.triangles().len())
    };
    let of_mesh = r#","weights":[1,0.5]"#;
    assert_eq!(largest(r#"{"mesh":0}"#, ""), (1.0, 1));
    assert_eq!(largest(r#"{"mesh":0}"#, of_mesh), (1.5, 1));
    // A node has weights of its own; the same mesh elsewhere keeps its own.
    assert_eq!(largest(r#"{"mesh":0,"weights":[0,2]},{"mesh":0}"#, of_mesh), (3.0, 2));
    let hidden = r#""extensions":{"KHR_node_visibility":{"visible":false}}"#;
    assert_eq!(largest(&format!(r#"{{"mesh":0}},{{"children":[2],{hidden}}},{{"mesh":0}}"#), of_mesh), (1.5, 1));
    let short = primitive.replace(r#""POSITION":0}]"#, r#""POSITION":2}]"#);
    let refused = read(scene_of(r#"{"mesh":0}"#, &format!("{short};{of_mesh}"), ACCESSORS, VIEWS, ""));
    assert_eq!(refused.unwrap_err().code, ErrorCode::CorruptFile);
}
