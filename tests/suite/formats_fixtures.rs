//! The fixtures that tests/fixtures/make_fixtures.py wrote, and what is common to the tests on them.

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

/// The lowest and highest coordinates.
pub fn bounds(mesh: &Mesh) -> [[f32; 3]; 2] {
    let low = mesh.positions().iter().copied().fold(Vec3::INFINITY, Vec3::min);
    let high = mesh.positions().iter().copied().fold(Vec3::NEG_INFINITY, Vec3::max);
    [low.to_array(), high.to_array()]
}

/// Panics unless the numbers agree to `tolerance` relative to the larger of 1 and themselves.
#[track_caller]
pub fn assert_near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance * expected.abs().max(1.0), "{found} instead of {expected}");
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
