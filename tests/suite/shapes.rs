//! Meshes that the tests share, and observations of them.

use glam::Vec3;
use sim3align::error::Result;
use sim3align::evidence::observation::Observation;
use sim3align::geometry::image::{DepthMap, Mask};
use sim3align::geometry::mesh::Mesh;
use sim3align::geometry::pinhole::Pinhole;
use sim3align::geometry::rasteriser::Rasteriser;
use sim3align::geometry::similarity::Similarity;

use crate::support::similarity;

/// A box with outward faces, centred on the origin.
pub fn cuboid(extent: Vec3) -> Mesh {
    let positions = (0..8).map(|i| {
        let sign = |bit: u32| if i >> bit & 1 == 1 { 0.5 } else { -0.5 };
        Vec3::new(sign(0), sign(1), sign(2)) * extent
    });
    let quads: [[u32; 4]; 6] = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Mesh::new(positions.collect(), triangles).unwrap()
}

/// A sphere of `rings` × `2·rings` faces with its poles on the z axis; outward faces.
pub fn sphere(radius: f32, rings: u32) -> Mesh {
    ellipsoid(Vec3::splat(radius), rings)
}

/// A sphere stretched to three semi-axes; outward faces.
pub fn ellipsoid(semi_axes: Vec3, rings: u32) -> Mesh {
    let around = 2 * rings;
    let mut positions = vec![Vec3::Z * semi_axes];
    for i in 1..rings {
        let theta = core::f64::consts::PI * f64::from(i) / f64::from(rings);
        for j in 0..around {
            let phi = 2.0 * core::f64::consts::PI * f64::from(j) / f64::from(around);
            let (s, z) = (libm::sin(theta), libm::cos(theta));
            let direction = Vec3::new((s * libm::cos(phi)) as f32, (s * libm::sin(phi)) as f32, z as f32);
            positions.push(direction * semi_axes);
        }
    }
    positions.push(-Vec3::Z * semi_axes);
    let last = positions.len() as u32 - 1;
    let at = |ring: u32, j: u32| 1 + (ring - 1) * around + j % around;
    let mut triangles = Vec::new();
    for j in 0..around {
        triangles.push([0, at(1, j), at(1, j + 1)]);
        triangles.push([last, at(rings - 1, j + 1), at(rings - 1, j)]);
        for ring in 1..rings - 1 {
            let [a, b, c, d] = [at(ring, j), at(ring + 1, j), at(ring + 1, j + 1), at(ring, j + 1)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    Mesh::new(positions, triangles).unwrap()
}

/// Both meshes as one.
pub fn joined(first: &Mesh, second: &Mesh) -> Mesh {
    let count = first.positions().len() as u32;
    let more = second.triangles().iter().map(|t| t.map(|i| i + count));
    let triangles = first.triangles().iter().copied().chain(more).collect();
    Mesh::new([first.positions(), second.positions()].concat(), triangles).unwrap()
}

/// A mesh of triangles without common vertices, of which `positions` holds the corners.
pub fn soup(positions: Vec<Vec3>) -> Mesh {
    let triangles = (0..positions.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    Mesh::new(positions, triangles).unwrap()
}

/// The mesh with its vertices passed through `f`.
pub fn mapped(mesh: &Mesh, f: impl Fn(Vec3) -> Vec3) -> Mesh {
    Mesh::new(mesh.positions().iter().map(|&p| f(p)).collect(), mesh.triangles().to_vec()).unwrap()
}

/// A body with bumps and dents at many places, so that no turn maps it onto itself.
pub fn body() -> Mesh {
    let wave = |x: f32| libm::sinf(x);
    mapped(&ellipsoid(Vec3::new(0.5, 0.38, 0.3), 40), |p| {
        p * (1.0
            + 0.5 * wave(4.0 * p.x + 1.0) * wave(5.0 * p.y + 0.5)
            + 0.35 * wave(9.0 * p.z + 5.0 * p.x - 1.0) * wave(6.0 * p.y))
    })
}

pub fn truth() -> Similarity {
    similarity(0.17, [0.9, -0.5, 2.1], [0.015, -0.01, 0.55])
}

/// The image of the body in front of a wall.
pub fn observe(mesh: &Mesh) -> Observation {
    let camera = Pinhole::new(420.0, 420.0, 119.5, 89.5).unwrap();
    rendered(mesh, &truth(), camera, [240, 180], |z| if z > 0.0 { z } else { 1.0 })
}

/// An observation of a posed mesh: its silhouette, and the depths that `depth` gives for rendered ones, 0 beside the mesh.
pub fn rendered(
    mesh: &Mesh,
    pose: &Similarity,
    camera: Pinhole,
    [width, height]: [usize; 2],
    depth: impl Fn(f32) -> f32,
) -> Observation {
    let mut rasteriser = Rasteriser::new();
    rasteriser.render(mesh, pose, &camera, width, height);
    let drawn = |u: usize, v: usize| rasteriser.depth()[v * width + u];
    view(camera, [width, height], |u, v| drawn(u, v) > 0.0, |u, v| depth(drawn(u, v))).unwrap()
}

/// An observation of the pixels that `mask` selects, with these depths.
pub fn view(
    camera: Pinhole,
    [width, height]: [usize; 2],
    mask: impl Fn(usize, usize) -> bool,
    depth: impl Fn(usize, usize) -> f32,
) -> Result<Observation> {
    let pixels = || (0..height).flat_map(|v| (0..width).map(move |u| (u, v)));
    let mask = pixels().map(|(u, v)| u8::from(mask(u, v))).collect();
    let depth = DepthMap::from_metres(width, height, pixels().map(|(u, v)| depth(u, v)).collect())?;
    Observation::new(depth, Mask::new("mask", width, height, mask)?, camera)
}

/// The observation with its depths passed through `change`, which also gets the index of the pixel.
pub fn with_depth(seen: &Observation, change: impl Fn(usize, f32) -> f32) -> Result<Observation> {
    let mut depth = seen.depth().clone();
    depth.data_mut().iter_mut().enumerate().for_each(|(i, z)| *z = change(i, *z));
    Observation::new(depth, seen.mask().clone(), seen.camera())
}
