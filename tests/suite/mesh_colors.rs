//! Colours of meshes from files: textures, vertex colours and materials, compared with what they were made from.

use sim3align::error::Error;
use sim3align::geometry::surface_colors::{COLOR_SAMPLES, Rgb, SurfaceColors};
use sim3align_formats::colored_mesh::ColoredMesh;
use sim3align_formats::mesh::{ColorSpace, MeshReadOptions, read_colored_mesh, read_mesh};

use crate::fixtures::{MESHES, floats, glb, rgb_png};
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
    rgb_png(&pixels, [32, 32])
}

/// A GLB of the unit square of z = 0, facing +z, with `attributes` beside its positions, in the accessors from 2 on, whose
/// views are `chunks`.
#[derive(Default)]
struct Square<'a> {
    attributes: &'a str,
    accessors: &'a str,
    chunks: &'a [&'a [u8]],
    material: &'a str,
    generator: &'a str,
}

const CORNERS: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];

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
        let Self { attributes, accessors, material, generator, .. } = self;
        let material_index = if material.is_empty() { "" } else { r#","material":0"# };
        glb(
            &format!(
                r#"{{"asset":{{"version":"2.0","generator":"{generator}"}},"nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[
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

#[wasm_bindgen_test]
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

#[wasm_bindgen_test]
fn colours_with_the_textures_upside_down_are_read_too() {
    let read = read(&upright(&blocks_png(), TEXTURED));
    let flipped = SurfaceColors::new(read.colors.unwrap().samples().clone(), read.flipped).unwrap();
    check(&flipped, 1, |p| block_at([p.x, p.y].map(f64::from), [10_497; 2]));
}

/// A square with texture coordinates x, 1 − y: the image upright.
fn upright(png: &[u8], material: &str) -> Vec<u8> {
    let uv: Vec<f32> = CORNERS.iter().flat_map(|&[x, y, _]| [x, 1.0 - y]).collect();
    Square {
        attributes: r#","TEXCOORD_0":2"#,
        accessors: r#",{"bufferView":2,"componentType":5126,"count":4,"type":"VEC2"}"#,
        chunks: &[&floats(&uv), png],
        material,
        generator: "",
    }
    .glb()
}

const TEXTURED: &str = r#","materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}],
    "textures":[{"source":0}],"images":[{"bufferView":3}]"#;

#[wasm_bindgen_test]
fn texture_transforms_scale_then_turn_then_move() {
    // A quarter turn counter-clockwise, as the image is viewed: what was right, (1, 0), becomes what was up, (0, −1).
    let material = r#","materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0,"extensions":{
        "KHR_texture_transform":{"offset":[0.25,0.75],"rotation":1.5707963267948966,"scale":[0.5,2]}}}}}],
        "textures":[{"source":0}],"images":[{"bufferView":3}]"#;
    check(&colors(&upright(&blocks_png(), material)), 1, |p| {
        let (u, v) = (f64::from(p.x) * 0.5, (1.0 - f64::from(p.y)) * 2.0);
        block_at([v + 0.25, -u + 0.75], [10_497; 2])
    });
}

#[wasm_bindgen_test]
fn a_mesh_whose_colors_are_broken_is_read_without_them() {
    use ErrorCode::{CorruptFile, FileTooLarge, InvalidArgument, UnsupportedFormat};
    let png = blocks_png();
    let material = |texture: &str, image: &str| {
        format!(
            r#","materials":[{{"pbrMetallicRoughness":{{"baseColorTexture":{{"index":0}}}}}}],
            "textures":[{texture}],"images":[{image}]"#
        )
    };
    let with = |texture: &str, image: &str| upright(&png, &material(texture, image));
    let mut huge = png.clone();
    huge[16..24].copy_from_slice(&[0, 1, 0x86, 0xa0, 0, 1, 0x86, 0xa0]);
    let short = Square {
        attributes: r#","COLOR_0":2"#,
        accessors: r#",{"bufferView":2,"componentType":5126,"count":3,"type":"VEC3"}"#,
        chunks: &[&floats(&[0.5; 9])],
        ..Square::default()
    };
    let basis = r#"{"extensions":{"KHR_texture_basisu":{"source":0}}}"#;
    for (what, bytes, code) in [
        ("half a PNG", upright(&png[..png.len() / 2], TEXTURED), CorruptFile),
        ("WebP", upright(b"RIFF\0\0\0\0WEBPVP8 ", TEXTURED), UnsupportedFormat),
        ("a huge PNG", upright(&huge, TEXTURED), FileTooLarge),
        ("KTX2", upright(b"\xabKTX 20\xbb\r\n\x1a\n", &material(basis, r#"{"bufferView":3}"#)), UnsupportedFormat),
        ("no such view", with(r#"{"source":0}"#, r#"{"bufferView":9}"#), CorruptFile),
        ("no such image", with(r#"{"source":7}"#, r#"{"bufferView":3}"#), CorruptFile),
        ("a file beside", with(r#"{"source":0}"#, r#"{"uri":"a.png"}"#), InvalidArgument),
        ("materials of text", upright(&png, r#","materials":"none""#), CorruptFile),
        ("too few colours", short.glb(), CorruptFile),
        ("no coordinates", Square { material: TEXTURED, chunks: &[&[], &png], ..Square::default() }.glb(), CorruptFile),
    ] {
        assert_eq!(problem(&bytes).code, code, "{what}");
    }
    // A broken texture that no triangle shows is nobody's concern, and most meshes have no colour.
    let unused = r#","materials":[{},{"pbrMetallicRoughness":{"baseColorTexture":{"index":4}}}]"#;
    let unused = Square { material: unused, ..Square::default() }.glb();
    for bytes in MESHES.map(|(_, bytes)| bytes).into_iter().chain([unused.as_slice()]) {
        let read = read(bytes);
        assert_eq!((read.colors, read.problem), (None, None));
    }
}

#[wasm_bindgen_test]
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
        let row = |[x, y]: [u32; 2]| {
            let [r, g, b] = [40 + 160 * x, 90, 30 + 200 * y].map(|c| f64::from(c) / scale);
            format!("{x} {r} {y} {g} {b} 0 0\n")
        };
        [[0, 0], [1, 0], [0, 1], [1, 1]].map(row).concat()
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

/// The colour of an OBJ of three triangles at x = 0, 4 and 8, with the materials "part #1", "part #2" and none, and the library
/// `#m.mtl`.
fn obj_colors(library: &str, vertex_color: &str) -> SurfaceColors {
    let triangle = |k: usize| {
        let x = 4 * k;
        let vertices =
            [[x, 0], [x + 1, 0], [x, 1]].map(|[x, y]| format!("v {x} {y} 0{vertex_color}\nvt 0.5 0.5\n")).concat();
        let [material, a, b, c] = [k + 1, 3 * k + 1, 3 * k + 2, 3 * k + 3];
        let part = if k < 2 { format!("usemtl part #{material}\n") } else { "usemtl other\n".into() };
        format!("{vertices}{part}f {a}/{a} {b}/{b} {c}/{c}\n")
    };
    let obj = "\u{feff}mtllib #m.mtl\nmtllib #m.mtl\n".to_owned() + &[0, 1, 2].map(triangle).concat();
    let resources = |name: &str| match name {
        "#m.mtl" => Some(library.as_bytes().to_vec()),
        "a #.png" => Some(rgb_png(&[[10, 200, 30]], [1, 1])),
        _ => None,
    };
    let options = MeshReadOptions { resources: Some(&resources), ..MeshReadOptions::default() };
    let read = read_colored_mesh(obj.as_bytes(), &options).unwrap();
    assert_eq!(read.problem, None);
    read.colors.unwrap()
}

#[wasm_bindgen_test]
fn an_obj_has_the_colors_of_textures_or_of_vertices_or_of_materials() {
    let white = [255; 3];
    let by_part = |parts: [Rgb; 3]| move |p: Vec3| Some(parts[(p.x / 4.0) as usize]);
    let materials = "\u{feff}newmtl part #1\nKd 0.2 0.4 0.6 # dark\nnewmtl part #2\nKd 0.8 0.2 0\n";
    check(&obj_colors(materials, ""), 1, by_part([[51, 102, 153], [204, 51, 0], white]));
    // Not their product: exporters write some Kd.
    check(&obj_colors(materials, " 0.4 0.2 0.8"), 1, by_part([[102, 51, 204]; 3]));
    let textured = format!("{materials}map_Kd a #.png\n");
    for vertex_color in ["", " 0.4 0.2 0.8"] {
        check(&obj_colors(&textured, vertex_color), 1, by_part([[51, 102, 153], [10, 200, 30], white]));
    }
    // Where a texture is missing, vertices have their colours.
    check(&obj_colors(&format!("{materials}map_Kd b.png\n"), " 0.4 0.2 0.8"), 1, by_part([[102, 51, 204]; 3]));
}

#[wasm_bindgen_test]
fn factors_and_vertex_colors_of_gltf_are_linear() {
    // Linear .25 is 137 in sRGB; 0 and 1 stay.
    let factor = r#","materials":[{"pbrMetallicRoughness":{"baseColorFactor":[1,0.25,0,1]}}]"#;
    check(&colors(&Square { material: factor, ..Square::default() }.glb()), 0, |_| Some([255, 137, 0]));
    let vertices = Square {
        attributes: r#","COLOR_0":2"#,
        accessors: r#",{"bufferView":2,"componentType":5126,"count":4,"type":"VEC3"}"#,
        chunks: &[&floats(&[0.25, 0.5, 1.0].repeat(4))],
        material: factor,
        generator: "",
    };
    check(&colors(&vertices.glb()), 0, |_| Some([137, 99, 0]));
}

/// The colours of a PLY of the square whose upper left triangle, (0, 1), has the first texture or colour.
fn ply_of(header: &str, vertices: [&str; 4], faces: [&str; 2]) -> ColoredMesh {
    let points = ["0 0 0", "1 0 0", "0 1 0", "1 1 0"];
    let rows: String = points.iter().zip(vertices).map(|(point, more)| format!("{point} {more}\n")).collect();
    let [vertex, face] = header.split_once('|').map(|(vertex, face)| [vertex, face]).unwrap();
    let [comments, vertex] = vertex.split_once('!').map_or(["", vertex], |(comments, vertex)| [comments, vertex]);
    let text = format!(
        "ply\nformat ascii 1.0\n{comments}element vertex 4\nproperty float x\nproperty float y\nproperty float z\n{vertex}\
        element face 2\nproperty list uchar int vertex_indices\n{face}end_header\n{rows}3 0 3 2 {}\n3 0 1 3 {}\n",
        faces[0], faces[1]
    );
    let resources = |name: &str| match name {
        "blocks.png" => Some(blocks_png()),
        "one colour.png" => Some(rgb_png(&[[10, 200, 30]], [1, 1])),
        _ => None,
    };
    let options = MeshReadOptions { resources: Some(&resources), ..MeshReadOptions::default() };
    read_colored_mesh(text.as_bytes(), &options).unwrap()
}

#[wasm_bindgen_test]
fn a_ply_has_the_colors_of_textures_or_of_vertices_or_of_faces() {
    let image = |p: Vec3| block_at([f64::from(p.x), 1.0 - f64::from(p.y)], [10_497; 2]);
    let colors = |read: ColoredMesh| {
        assert_eq!((read.problem, read.unread), (None, Vec::new()));
        read.colors.unwrap()
    };
    let corners = ["0 0", "1 0", "0 1", "1 1"];
    for names in ["texture_u texture_v", "u v", "s t", "texture_s texture_t"] {
        let properties: String = names.split(' ').map(|name| format!("property float {name}\n")).collect();
        let header = format!("comment TextureFile blocks.png\n!{properties}|");
        check(&colors(ply_of(&header, corners, [""; 2])), 1, image);
    }
    // MeshLab's: a texture of each face, and coordinates of its corners; -1 is none.
    let both = "comment TextureFile blocks.png\ncomment texture_file one colour.png\n!|\
        property list uchar float texcoord\nproperty int texnumber\n";
    let mapped = |number: &str| [format!("6 0 0 1 1 0 1 {number}"), "6 0 0 1 0 1 1 0".into()];
    for (number, above) in [("1", Some([10, 200, 30])), ("-1", Some([255; 3])), ("0", None)] {
        let faces = mapped(number);
        let is_above = |p: Vec3| above.filter(|_| p.y > p.x + 0.05);
        let read = ply_of(both, [""; 4], [&faces[0], &faces[1]]);
        check(&colors(read), 1, |p| if (p.y - p.x).abs() < 0.05 { None } else { is_above(p).or_else(|| image(p)) });
    }
    let rgb = "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n";
    let by_face = |p: Vec3| Some(if p.y > p.x { [200, 30, 60] } else { [0, 90, 255] });
    let faces = ["200 30 60 255", "0 90 255 255"];
    check(&colors(ply_of(&format!("|{rgb}"), [""; 4], faces)), 0, by_face);
    // Vertices that all have one colour are not finer; others are.
    let vertex =
        rgb.replace("uchar red", "float diffuse_red").replace("uchar", "float").replace("float b", "float diffuse_b");
    let vertex = vertex.replace("float green", "float diffuse_green");
    check(&colors(ply_of(&format!("{vertex}|{rgb}"), ["255 255 255 255"; 4], faces)), 0, by_face);
    let red = ["0 0 0 1", "255 0 0 1", "0 0 0 1", "255 0 0 1"];
    check(&colors(ply_of(&format!("{vertex}|{rgb}"), red, faces)), 1, |p| Some([(255.0 * p.x).round() as u8, 0, 0]));
    for (header, vertices, found) in [
        ("property float u\nproperty float v\n|", corners, "texture coordinates without a texture"),
        ("comment TextureFile a.png\n!|", [""; 4], "a texture without texture coordinates"),
        ("comment TextureFile a.png\n!property float u\nproperty float v\n|", corners, "no bytes for \"a.png\""),
        (
            "comment TextureFile blocks.png\ncomment TextureFile b.png\n!property float u\nproperty float v\n|",
            corners,
            "several textures, and faces without texnumber",
        ),
    ] {
        let read = ply_of(header, vertices, [""; 2]);
        assert_eq!((read.colors, read.problem.map(|problem| problem.found.to_string())), (None, Some(found.into())));
    }
    let by_material = ply_of("|property int material_index\n", [""; 4], ["0", "1"]);
    assert_eq!((by_material.problem.is_some(), by_material.unread.len()), (true, 1));
}

#[wasm_bindgen_test]
fn colors_that_others_write_otherwise_are_read() {
    // OBJ: 0 to 255; what is emitted over black, and what is ambient alone.
    let materials = "newmtl part #1\nKd 0 0 0\nKe 0.2 0.4 0.6\nKa 1 1 1\nnewmtl part #2\nKa 0.8 0.2 0\n";
    let by_part = |parts: [Rgb; 3]| move |p: Vec3| Some(parts[(p.x / 4.0) as usize]);
    check(&obj_colors(materials, ""), 1, by_part([[51, 102, 153], [204, 51, 0], [255; 3]]));
    check(&obj_colors(materials, " 102 51 204"), 0, by_part([[102, 51, 204]; 3]));
    let textured = materials.replace("Ka 0.8", "map_Ka a #.png\nKa 0.8").replace("Ke", "map_Ke -clamp on a #.png\nKe");
    check(&obj_colors(&textured, ""), 1, by_part([[10, 200, 30], [10, 200, 30], [255; 3]]));

    // glTF: a texture that is emitted over a black base.
    let emitted = TEXTURED.replace("\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0}}", "\"pbrMetallicRoughness\":{\"baseColorFactor\":[0,0,0,1]},\"emissiveFactor\":[1,1,1],\"emissiveTexture\":{\"index\":0}");
    assert_ne!(emitted, TEXTURED);
    check(&colors(&upright(&blocks_png(), &emitted)), 1, |p| {
        block_at([f64::from(p.x), 1.0 - f64::from(p.y)], [10_497; 2])
    });

    // STL: five bits a channel, blue lowest; with a colour of the object in the header, red lowest.
    let stl = |header: &[u8], attribute: u16| {
        let mut bytes = header.to_vec();
        bytes.resize(80, b' ');
        bytes.extend(1_u32.to_le_bytes());
        bytes.extend(floats(&[0.0; 3]));
        bytes.extend(floats(CORNERS[..3].as_flattened()));
        bytes.extend(attribute.to_le_bytes());
        bytes
    };
    check(&colors(&stl(b"", 0x8000 | 31 << 10 | 3)), 1, |_| Some([255, 0, 25]));
    check(&colors(&stl(b"x COLOR=\x0a\xc8\x1e\xff", 31 | 3 << 10)), 1, |_| Some([255, 0, 25]));
    check(&colors(&stl(b"x COLOR=\x0a\xc8\x1e\xff", 0x8000)), 0, |_| Some([10, 200, 30]));
    assert_eq!(read(&stl(b"", 77)).colors, None);
}

#[wasm_bindgen_test]
fn vertex_colors_of_gltf_are_codes_if_their_writer_or_the_caller_says_so() {
    let square = |kind: u32, chunk: &[u8], generator: &'static str| {
        let accessors =
            format!(r#",{{"bufferView":2,"componentType":{kind},"normalized":true,"count":4,"type":"VEC3"}}"#);
        let chunks = [chunk];
        let square = Square {
            attributes: r#","COLOR_0":2"#,
            accessors: &accessors,
            chunks: &chunks,
            generator,
            ..Square::default()
        };
        square.glb()
    };
    let float = floats(&[0.25, 0.5, 1.0].repeat(4));
    let bytes = [64, 128, 255].repeat(4);
    let (linear, codes) = ([137, 188, 255], [64, 128, 255]);
    for (kind, chunk, generator, space, expected) in [
        (5126, &float, "Khronos glTF Blender I/O v5.2", None, linear),
        (5126, &float, "", Some(ColorSpace::Srgb), codes),
        (5126, &float, "Open3D", None, codes),
        (5126, &float, "Open Asset Import Library (assimp v6.0)", None, codes),
        (5126, &float, "Open3D", Some(ColorSpace::Linear), linear),
        (5121, &bytes, "", None, codes),
        (5121, &bytes, "gltfpack 1.3", Some(ColorSpace::Linear), linear),
    ] {
        let options = MeshReadOptions { color_space: space, ..MeshReadOptions::default() };
        let read = read_colored_mesh(&square(kind, chunk, generator), &options).unwrap();
        check(&read.colors.unwrap(), 1, |_| Some(expected));
    }
}
