//! Splats of meshes, as 3D Gaussian Splatting makes them of photos: flat discs on the surface, moved and tilted by noise,
//! with Gaussians inside, transparent ones around, and a few opaque ones far away.

use glam::Quat;
use sim3align::geometry::surface::{each_surface_sample, surface_area};

use crate::prelude::*;

/// A Gaussian of a test.
pub struct Gaussian {
    pub center: Vec3,
    pub scales: Vec3,
    pub rotation: Quat,
    pub opacity: f64,
    pub color: [u8; 3],
}

/// Of a mesh around its own middle, `count` discs, with noise of `noise` of the diagonal along the normal, and others.
/// `color` is that of a point of the surface.
pub fn gaussians(mesh: &Mesh, count: usize, noise: f64, seed: u64, color: impl Fn(Vec3) -> [u8; 3]) -> Vec<Gaussian> {
    let mut draw = Draw::new(seed);
    let diagonal = mesh.diagonal();
    let spacing = (surface_area(mesh) / count as f64).sqrt();
    let mut gaussians = Vec::new();
    each_surface_sample(mesh, count, seed, &mut |sample| {
        let tilted = sample.normal + vec3(&(draw.direction() * 0.15));
        let axes = [draw.between(0.5, 1.5), draw.between(0.5, 1.5), 0.1].map(|axis| (axis * spacing) as f32);
        gaussians.push(Gaussian {
            center: sample.point + sample.normal * (draw.normal() * noise * diagonal) as f32,
            scales: Vec3::from_array(axes),
            rotation: Quat::from_rotation_arc(Vec3::Z, tilted.normalize()),
            opacity: draw.between(0.5, 0.99),
            color: color(sample.point),
        });
    })
    .unwrap();
    let middle = Bounds::of(mesh.positions()).unwrap().center();
    let mut add = |center: Vec3, opacity: f64| {
        let (scales, rotation, color) = (Vec3::splat(spacing as f32), Quat::IDENTITY, [255, 0, 255]);
        gaussians.push(Gaussian { center, scales, rotation, opacity, color });
    };
    let anchors: Vec<Vec3> = sample_surface(mesh, count / 20, seed + 1).unwrap().points;
    // Of a body that is seen from its middle, these are inside.
    anchors.iter().for_each(|anchor| add(middle.lerp(*anchor, draw.between(0.0, 0.9) as f32), draw.between(0.0, 0.99)));
    (0..count / 10).for_each(|_| add(middle + vec3(&draw.cube(0.8 * diagonal)), draw.between(0.0, 0.25)));
    (0..count / 1000).for_each(|_| add(middle + vec3(&(draw.direction() * diagonal * draw.between(0.8, 5.0))), 0.95));
    gaussians
}

/// A PLY file as 3D Gaussian Splatting writes it, with harmonics of degree 1.
pub fn splat_ply(gaussians: &[Gaussian]) -> Vec<u8> {
    let mut header = format!("ply\nformat binary_little_endian 1.0\nelement vertex {}\n", gaussians.len());
    let rest = (0..9).map(|i| format!("f_rest_{i}"));
    let names =
        ["x", "y", "z", "nx", "ny", "nz", "f_dc_0", "f_dc_1", "f_dc_2"].map(String::from).into_iter().chain(rest);
    let last = ["opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"].map(String::from);
    names.chain(last).for_each(|name| header += &format!("property float {name}\n"));
    let mut file = (header + "end_header\n").into_bytes();
    for Gaussian { center, scales, rotation, opacity, color } in gaussians {
        let harmonic = |code: u8| ((f64::from(code) / 255.0 - 0.5) / 0.282_094_791_773_878_14) as f32;
        // Not of unit length, as optimisers leave them.
        let [x, y, z, w] = (*rotation * 1.7).to_array();
        let logit = libm::log(opacity / (1.0 - opacity)) as f32;
        let numbers = (center.to_array().into_iter().chain([0.0; 3])).chain(color.map(harmonic)).chain([0.1; 9]);
        let numbers = numbers.chain([logit]).chain(scales.to_array().map(libm::logf)).chain([w, x, y, z]);
        numbers.for_each(|number| file.extend(number.to_le_bytes()));
    }
    file
}

/// A `.splat` file.
pub fn splat_records(gaussians: &[Gaussian]) -> Vec<u8> {
    let mut file = Vec::new();
    for Gaussian { center, scales, rotation, opacity, color } in gaussians {
        [center, scales].iter().flat_map(|v| v.to_array()).for_each(|number| file.extend(number.to_le_bytes()));
        file.extend(color);
        file.push((opacity * 255.0).round() as u8);
        let [x, y, z, w] = rotation.to_array();
        file.extend([w, x, y, z].map(|q| (128.0 * q + 128.0).clamp(0.0, 255.0) as u8));
    }
    file
}
