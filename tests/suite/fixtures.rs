//! Files that other programs wrote, and the common parts of the tests of readers.

use sim3align::error::Result;
use sim3align_formats::mesh::{MeshReadOptions, read_mesh};

use crate::prelude::*;

macro_rules! fixture {
    ($name:literal) => {
        include_bytes!(concat!("../fixtures/", $name)).as_slice()
    };
}
pub(crate) use fixture;

/// The format of a mesh fixture, its name and bytes. One mesh, in all formats.
pub const MESHES: [(&str, &[u8]); 9] = [
    ("glb", fixture!("mesh.glb")),
    ("gltf", fixture!("mesh-data-uri.gltf")),
    ("obj", fixture!("mesh.obj")),
    ("ply", fixture!("mesh-ascii.ply")),
    ("ply", fixture!("mesh-little.ply")),
    ("ply", fixture!("mesh-big.ply")),
    ("stl", fixture!("mesh-ascii.stl")),
    ("stl", fixture!("mesh.stl")),
    ("stl", fixture!("mesh-solid-header.stl")),
];

/// A mesh from a file of any format.
pub fn read(bytes: impl AsRef<[u8]>) -> Result<Mesh> {
    read_mesh(bytes.as_ref(), &MeshReadOptions::default())
}

/// Corners in the order of the triangles, which no reader may change.
pub fn corners(mesh: &Mesh) -> Vec<Vec3> {
    mesh.triangles().iter().flat_map(|&t| mesh.corners(t)).collect()
}

/// Surface area, in f64.
pub fn area(mesh: &Mesh) -> f64 {
    let triangle = |t: &[u32; 3]| {
        let [a, b, c]: [DVec3; 3] = mesh.corners(*t).map(Vec3::as_dvec3);
        0.5 * (b - a).cross(c - a).length()
    };
    mesh.triangles().iter().map(triangle).sum()
}

/// A GLB of this JSON and binary chunk.
pub fn glb(json: &str, binary: &[u8]) -> Vec<u8> {
    let mut json = json.as_bytes().to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut binary = binary.to_vec();
    binary.resize(binary.len().next_multiple_of(4), 0);
    let mut bytes = b"glTF".to_vec();
    for word in [2, 28 + json.len() + binary.len(), json.len()] {
        bytes.extend((word as u32).to_le_bytes());
    }
    bytes.extend(b"JSON");
    bytes.extend(&json);
    bytes.extend((binary.len() as u32).to_le_bytes());
    bytes.extend(b"BIN\0");
    bytes.extend(&binary);
    bytes
}

pub fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|x| x.to_le_bytes()).collect()
}

/// A PNG of these samples.
pub fn png_of(size: [u32; 2], color: png::ColorType, depth: png::BitDepth, samples: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, size[0], size[1]);
    encoder.set_color(color);
    encoder.set_depth(depth);
    encoder.write_header().unwrap().write_image_data(samples).unwrap();
    bytes
}

/// A PNG of these colours.
pub fn rgb_png(pixels: &[[u8; 3]], size: [u32; 2]) -> Vec<u8> {
    png_of(size, png::ColorType::Rgb, png::BitDepth::Eight, pixels.as_flattened())
}
