//! Colours of meshes from files: textures, vertex colours and materials, compared with what they were made from.

use sim3align::error::Error;
use sim3align::geometry::surface_colors::{COLOR_SAMPLES, Rgb, SurfaceColors};
use sim3align_formats::colored_mesh::ColoredMesh;
use sim3align_formats::mesh::{MeshReadOptions, read_colored_mesh, read_mesh};
use sim3align_lab::case_folder::write;

use crate::formats_fixtures::{MESHES, glb};
use crate::prelude::*;

fn read(bytes: &[u8]) -> ColoredMesh {
    let read = read_colored_mesh(bytes, &MeshReadOptions::default()).unwrap();
    assert_eq!(read.mesh, read_mesh(bytes, &MeshReadOptions::default()).unwrap());
    read
}

fn colors(bytes: &[u8]) -> SurfaceColors {
    let read = read(bytes);
    assert_eq!(read.problem, None);
    let colors = read.colors.unwrap();
    assert_eq!(colors.colors().len(), COLOR_SAMPLES);
    colors
}

fn problem(bytes: &[u8]) -> Error {
    let read = read(bytes);
    assert_eq!(read.colors, None);
    read.problem.unwrap()
}

/// A texture of 32 × 32 texels in 8 × 8 blocks of one colour each.
fn block(column: i64, row: i64) -> Rgb {
    [20 + 28 * column as u8, 20 + 28 * row as u8, if (column + row) % 2 == 0 { 30 } else { 220 }]
}

fn blocks_png() -> Vec<u8> {
    let pixels: Vec<Rgb> = (0..32 * 32).map(|i| block(i % 32 / 4, i / 32 / 4)).collect();
    write::rgb_png(&pixels, 32, 32).unwrap()
}

/// A GLB of the unit square of z = 0, facing +z, with `attributes` beside its positions, in the accessors from 2 on; `more`
/// is what follows the buffers, and the views from 2 on are `chunks`.
struct Square<'a> {
    attributes: &'a str,
    accessors: &'a str,
    chunks: &'a [&'a [u8]],
    material: &'a str,
    node: &'a str,
}

impl Default for Square<'_> {
    fn default() -> Self {
        Self { attributes: "", accessors: "", chunks: &[], material: "", node: r#"{"mesh":0}"# }
    }
}

const CORNERS: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];

fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|x| x.to_le_bytes()).collect()
}

impl Square<'_> {
    fn glb(&self) -> Vec<u8> {
        let mut binary = floats(CORNERS.as_flattened());
        binary.extend([0_u8, 1, 2, 2, 1, 3, 0, 0]);
        let mut views = r#"{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":6}"#.to_owned();
        for chunk in self.chunks {
            views += &format!(r#",{{"buffer":0,"byteOffset":{},"byteLength":{}}}"#, binary.len(), chunk.len());
            binary.extend(*chunk);
            binary.resize(binary.len().next_multiple_of(4), 0);
        }
        let Self { attributes, accessors, material, node, .. } = self;
        let material_index = if material.is_empty() { "" } else { r#","material":0"# };
        glb(
            &format!(
                r#"{{"asset":{{"version":"2.0"}},"nodes":[{node}],"meshes":[{{"primitives":[
                {{"attributes":{{"POSITION":0{attributes}}},"indices":1{material_index}}}]}}],"accessors":[
                {{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"}},
                {{"bufferView":1,"componentType":5121,"count":6,"type":"SCALAR"}}{accessors}],
                "bufferViews":[{views}],"buffers":[{{"byteLength":{}}}]{material}}}"#,
                binary.len()
            ),
            &binary,
        )
    }
}

/// Checks colours against an oracle: where `expected` is none, any colour is right.
fn check(colors: &SurfaceColors, tolerance: u8, expected: impl Fn(Vec3) -> Option<Rgb>) {
    let mut checked = 0;
    for (&point, &color) in colors.samples().points.iter().zip(colors.colors()) {
        let Some(expected) = expected(point) else { continue };
        let is_near = color.iter().zip(expected).all(|(a, b)| a.abs_diff(b) <= tolerance);
        assert!(is_near, "{color:?} at {point}, not {expected:?}");
        checked += 1;
    }
    assert!(checked > COLOR_SAMPLES / 10, "{checked} points");
}

/// The texel block at texture coordinates under a wrap mode; none near the edges of blocks, where colours mix.
fn block_at(coordinates: [f64; 2], modes: [u32; 2]) -> Option<Rgb> {
    let mut place = [0; 2];
    for axis in 0..2 {
        let x = coordinates[axis];
        let tile = x.floor();
        let inside = match modes[axis] {
            33_071 => x.clamp(0.0, 1.0),
            33_648 if tile as i64 % 2 != 0 => 1.0 - (x - tile),
            _ => x - tile,
        };
        let blocks = inside * 8.0;
        let is_clamped = modes[axis] == 33_071 && !(0.0..=1.0).contains(&x);
        if !is_clamped && (blocks - blocks.round()).abs() < 0.3 {
            return None;
        }
        place[axis] = (blocks.floor() as i64).min(7);
    }
    Some(block(place[0], place[1]))
}

#[wasm_bindgen_test(unsupported = test)]
fn a_texture_is_seen_where_its_coordinates_say() {
    let png = blocks_png();
    // u from −1.3 to 1.9, v from −0.7 to 2.1: all wrap modes matter.
    let of_point = |p: Vec3| [-1.3 + 3.2 * f64::from(p.x), -0.7 + 2.8 * f64::from(p.y)];
    let uv: Vec<f32> = CORNERS.iter().flat_map(|&c| of_point(Vec3::from(c)).map(|x| x as f32)).collect();
    let uv = floats(&uv);
    for modes in [[10_497, 10_497], [33_071, 33_648], [33_648, 33_071]] {
        let material = format!(
            r#","materials":[{{"pbrMetallicRoughness":{{"baseColorTexture":{{"index":0,"texCoord":3}}}}}}],
            "textures":[{{"source":0,"sampler":0}}],"images":[{{"bufferView":3,"mimeType":"image/png"}}],
            "samplers":[{{"wrapS":{},"wrapT":{}}}]"#,
            modes[0], modes[1]
        );
        let square = Square {
            attributes: r#","TEXCOORD_3":2"#,
            accessors: r#",{"bufferView":2,"componentType":5126,"count":4,"type":"VEC2"}"#,
            chunks: &[&uv, &png],
            material: &material,
            ..Square::default()
        };
        check(&colors(&square.glb()), 1, |p| block_at(of_point(p), modes));
    }
}

/// A square with texture coordinates x, 1 − y: the image upright.
fn upright(png: &[u8], material: &str, node: &str) -> Vec<u8> {
    let uv: Vec<f32> = CORNERS.iter().flat_map(|&[x, y, _]| [x, 1.0 - y]).collect();
    Square {
        attributes: r#","TEXCOORD_0":2"#,
        accessors: r#",{"bufferView":2,"componentType":5126,"count":4,"type":"VEC2"}"#,
        chunks: &[&floats(&uv), png],
        material,
        node,
    }
    .glb()
}

const TEXTURED: &str = r#","materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}],
    "textures":[{"source":0}],"images":[{"bufferView":3}]"#;

#[wasm_bindgen_test(unsupported = test)]
fn texture_transforms_scale_then_turn_then_move() {
    // A quarter turn counter-clockwise, as the image is viewed: what was right, (1, 0), becomes what was up, (0, −1).
    let material = r#","materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0,"extensions":{
        "KHR_texture_transform":{"offset":[0.25,0.75],"rotation":1.5707963267948966,"scale":[0.5,2]}}}}}],
        "textures":[{"source":0}],"images":[{"bufferView":3}]"#;
    let glb = upright(&blocks_png(), material, r#"{"mesh":0}"#);
    check(&colors(&glb), 1, |p| {
        let (u, v) = (f64::from(p.x) * 0.5, (1.0 - f64::from(p.y)) * 2.0);
        block_at([v + 0.25, -u + 0.75], [10_497; 2])
    });
}

#[wasm_bindgen_test(unsupported = test)]
fn textures_follow_mirrored_and_instanced_nodes() {
    let node = r#"{"children":[1,2]},{"mesh":0,"scale":[-2,1,1]},{"mesh":0,"translation":[0,5,0]}"#;
    let colors = colors(&upright(&blocks_png(), TEXTURED, node));
    check(&colors, 1, |p| {
        let (x, y) = if p.y > 2.0 { (p.x, p.y - 5.0) } else { (-p.x / 2.0, p.y) };
        block_at([f64::from(x), 1.0 - f64::from(y)], [10_497; 2])
    });
    // Both faces of the flat mesh have the same side.
    let first = colors.samples().normals[0];
    assert!(colors.samples().normals.iter().all(|&normal| normal == first && normal.z.abs() == 1.0));
    // Two thirds of the area are the mirrored square, spread evenly.
    let lower = colors.samples().points.iter().filter(|p| p.y < 2.0).count();
    assert!((lower as f64 / COLOR_SAMPLES as f64 - 2.0 / 3.0).abs() < 1e-3);
}

#[wasm_bindgen_test(unsupported = test)]
fn fine_textures_are_averaged() {
    // Black and white texels alternate, 16 of them between neighbouring points.
    let pixels: Vec<Rgb> =
        (0..2048 * 2048).map(|i| [if (i % 2048 + i / 2048) % 2 == 0 { 0 } else { 255 }; 3]).collect();
    let png = write::rgb_png(&pixels, 2048, 2048).unwrap();
    check(&colors(&upright(&png, TEXTURED, r#"{"mesh":0}"#)), 1, |_| Some([128; 3]));
    // Repeated 64 times, a texture of 32 × 32 texels is as fine.
    let material = r#","materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0,"extensions":{
        "KHR_texture_transform":{"scale":[1024,1024]}}}}}],"textures":[{"source":0}],"images":[{"bufferView":3}]"#;
    let mean: [f64; 3] =
        core::array::from_fn(|c| (0..64).map(|i| f64::from(block(i % 8, i / 8)[c])).sum::<f64>() / 64.0);
    let mean = mean.map(|x| x.round() as u8);
    check(&colors(&upright(&blocks_png(), material, r#"{"mesh":0}"#)), 2, |_| Some(mean));
}

#[wasm_bindgen_test(unsupported = test)]
fn vertex_colors_of_gltf_are_linear_but_for_bytes() {
    // Linear .25 is 137 in sRGB; 0 and 1 stay. Bytes are sRGB: see the reader.
    let rgba: [[f32; 4]; 4] = [[0.25, 0.0, 1.0, 0.0]; 4];
    let of_type = |kind: u32, shape: &str, bytes: &[u8]| {
        let accessors = format!(r#",{{"bufferView":2,"componentType":{kind},"count":4,"type":"{shape}"}}"#);
        let square =
            Square { attributes: r#","COLOR_0":2"#, accessors: &accessors, chunks: &[bytes], ..Square::default() };
        check(&colors(&square.glb()), 0, |_| Some([137, 0, 255]));
    };
    of_type(5126, "VEC4", &floats(rgba.as_flattened()));
    of_type(5126, "VEC3", &floats(&[0.25, 0.0, 1.0].repeat(4)));
    of_type(5121, "VEC4", &[137, 0, 255, 9].repeat(4));
    let words: Vec<u8> = [16384_u16, 0, 65535, 9].repeat(4).into_iter().flat_map(u16::to_le_bytes).collect();
    of_type(5123, "VEC4", &words);
}

#[wasm_bindgen_test(unsupported = test)]
fn vertex_colors_factor_and_texture_multiply() {
    let uv = floats(&[0.5; 8]);
    let png = write::rgb_png(&[[188, 255, 188]; 4], 2, 2).unwrap();
    let material = r#","materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0},
        "baseColorFactor":[0.5,0.5,1,0.3]}}],"textures":[{"source":0}],"images":[{"bufferView":4}]"#;
    let square = Square {
        attributes: r#","COLOR_0":2,"TEXCOORD_0":3"#,
        accessors: r#",{"bufferView":2,"componentType":5126,"count":4,"type":"VEC3"},
            {"bufferView":3,"componentType":5126,"count":4,"type":"VEC2"}"#,
        chunks: &[&floats(&[1.0, 0.5, 0.5].repeat(4)), &uv, &png],
        material,
        ..Square::default()
    };
    // sRGB 188 is linear .5: red .5 · .5, green .5 · .5 · 1, blue .5 · .5.
    check(&colors(&square.glb()), 1, |_| Some([137, 137, 137]));
    let factor = r#","materials":[{"pbrMetallicRoughness":{"baseColorFactor":[1,0.25,0,1]}}]"#;
    let only_factor = Square { material: factor, ..Square::default() };
    check(&colors(&only_factor.glb()), 0, |_| Some([255, 137, 0]));
}

#[wasm_bindgen_test(unsupported = test)]
fn meshes_without_color_have_none() {
    for (format, bytes) in MESHES {
        let read = read(bytes);
        assert_eq!((read.colors, read.problem), (None, None), "{format}");
    }
    let white = r#","materials":[{"pbrMetallicRoughness":{"baseColorFactor":[1,1,1,0.5],"roughnessFactor":0.2}}]"#;
    let read = read(&Square { material: white, ..Square::default() }.glb());
    assert_eq!((read.colors, read.problem), (None, None));
}

#[wasm_bindgen_test(unsupported = test)]
fn a_mesh_whose_colors_are_broken_is_read_without_them() {
    let png = blocks_png();
    let node = r#"{"mesh":0}"#;
    let material = |texture: &str, image: &str| {
        format!(
            r#","materials":[{{"pbrMetallicRoughness":{{"baseColorTexture":{{"index":0}}}}}}],
            "textures":[{texture}],"images":[{image}]"#
        )
    };
    let code = |bytes: &[u8]| problem(bytes).code;
    assert_eq!(code(&upright(&png[..png.len() / 2], TEXTURED, node)), ErrorCode::CorruptFile);
    let webp = problem(&upright(b"RIFF\0\0\0\0WEBPVP8 ", TEXTURED, node));
    assert_eq!(webp.code, ErrorCode::UnsupportedFormat);
    assert!(webp.found.contains("WebP") && webp.remedy.contains("gltf-transform"), "{webp}");
    let mut huge = png.clone();
    huge[16..24].copy_from_slice(&[0, 1, 0x86, 0xa0, 0, 1, 0x86, 0xa0]);
    assert_eq!(code(&upright(&huge, TEXTURED, node)), ErrorCode::FileTooLarge);
    let basis = material(r#"{"extensions":{"KHR_texture_basisu":{"source":0}}}"#, r#"{"bufferView":3}"#);
    assert_eq!(code(&upright(&png, &basis, node)), ErrorCode::UnsupportedFormat);
    let outside = material(r#"{"source":0}"#, r#"{"bufferView":9}"#);
    assert_eq!(code(&upright(&png, &outside, node)), ErrorCode::CorruptFile);
    let nothing = material(r#"{"source":7}"#, r#"{"bufferView":3}"#);
    assert_eq!(code(&upright(&png, &nothing, node)), ErrorCode::CorruptFile);
    let beside = problem(&upright(&png, &material(r#"{"source":0}"#, r#"{"uri":"a.png"}"#), node));
    assert_eq!((beside.code, &*beside.argument), (ErrorCode::InvalidArgument, "options.resources"));
    let no_json = r#","materials":"none""#;
    assert_eq!(code(&upright(&png, no_json, node)), ErrorCode::CorruptFile);
    let short = Square {
        attributes: r#","COLOR_0":2"#,
        accessors: r#",{"bufferView":2,"componentType":5126,"count":3,"type":"VEC3"}"#,
        chunks: &[&floats(&[0.5; 9])],
        ..Square::default()
    };
    assert_eq!(code(&short.glb()), ErrorCode::CorruptFile);
    let unmapped = Square { material: TEXTURED, chunks: &[&[], &png], ..Square::default() };
    assert_eq!(code(&unmapped.glb()), ErrorCode::CorruptFile);
    // A broken texture that no triangle shows is nobody's concern.
    let unused = r#","materials":[{},{"pbrMetallicRoughness":{"baseColorTexture":{"index":4}}}]"#;
    let read = read(&Square { material: unused, ..Square::default() }.glb());
    assert_eq!((read.colors, read.problem), (None, None));
}

#[wasm_bindgen_test(unsupported = test)]
fn vertex_colors_of_ply_and_obj_are_srgb() {
    let ply = |kind: &str, rows: &str| {
        format!(
            "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty {kind} red\nproperty float y\n\
            property {kind} green\nproperty {kind} blue\nproperty {kind} alpha\nproperty float z\nelement face 2\n\
            property list uchar int vertex_indices\nend_header\n{rows}3 0 1 2\n3 2 1 3\n"
        )
    };
    // x, red, y, green, blue, alpha, z: the colour of each vertex differs.
    let rows = |scale: f64| -> String {
        let row = |x: u8, y: u8| {
            let [r, g, b] = [40 + 160 * u32::from(x), 90, 30 + 200 * u32::from(y)].map(|c| f64::from(c) / scale);
            format!("{x} {r} {y} {g} {b} 0 0\n")
        };
        [row(0, 0), row(1, 0), row(0, 1), row(1, 1)].concat()
    };
    let expected = |p: Vec3| Some([(40.0 + 160.0 * p.x).round() as u8, 90, (30.0 + 200.0 * p.y).round() as u8]);
    for (kind, scale) in [("uchar", 1.0), ("float", 255.0), ("double", 255.0), ("ushort", 1.0 / 257.0)] {
        check(&colors(ply(kind, &rows(scale)).as_bytes()), 1, expected);
    }
    let obj = "v 0 0 0 0.156863 0.352941 0.117647\nv 1 0 0 0.784314 0.352941 0.117647\n\
        v 0 1 0 0.156863 0.352941 0.901961\nv 1 1 0 0.784314 0.352941 0.901961\nf 1 2 3\nf 3 2 4\n";
    check(&colors(obj.as_bytes()), 1, expected);
    // A fourth number is a weight.
    let weighted = read(b"v 0 0 0 1\nv 1 0 0 1\nv 0 1 0 1\nf 1 2 3\n");
    assert_eq!((weighted.colors, weighted.problem), (None, None));
}

#[wasm_bindgen_test(unsupported = test)]
fn an_obj_takes_its_colors_from_its_library() {
    let obj =
        b"mtllib my lib.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 2 0 0\nv 2 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nvt 1 1\n\
        usemtl print\nf 1/1 2/2 4/4 3/-2\nusemtl plain\nf 2 5 6 4\n";
    let mtl =
        b"newmtl plain\nKd 0.2 0.4 1 # blue\nnewmtl print\nKd 0 0 0\nmap_Kd -s 1 1 1 -bm 2 -clamp on maps\\a b.png\n";
    let png = blocks_png();
    let beside = |uri: &str| match uri {
        "my lib.mtl" => Some(mtl.to_vec()),
        "maps/a b.png" => Some(png.clone()),
        _ => None,
    };
    let options = MeshReadOptions { format: None, resources: Some(&beside) };
    let read = read_colored_mesh(obj, &options).unwrap();
    assert_eq!(read.problem, None);
    check(&read.colors.unwrap(), 1, |p| {
        let (x, y) = (f64::from(p.x), f64::from(p.y));
        if x > 1.0 { Some([51, 102, 255]) } else { block_at([x, 1.0 - y], [10_497; 2]) }
    });
    let missing = problem(obj);
    assert_eq!((missing.code, &*missing.argument), (ErrorCode::InvalidArgument, "options.resources"));
    let only_library = |uri: &str| (uri == "my lib.mtl").then(|| mtl.to_vec());
    let read = read_colored_mesh(obj, &MeshReadOptions { format: None, resources: Some(&only_library) }).unwrap();
    assert_eq!(read.problem.map(|error| error.code), Some(ErrorCode::InvalidArgument));
}
