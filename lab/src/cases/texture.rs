//! The colours that a generative model gives its mesh: those of the photo where it saw the object, invented elsewhere.

use glam::{DMat3, DVec3};

use super::print::{Print, PrintKind, color, encoded};
use super::tier::{Class, Tier};
use crate::draws::{between, normal};
use sim3align::evidence::sample::sample_surface;
use sim3align_geometry::error::Result;
use sim3align_geometry::mesh::Mesh;
use sim3align_geometry::random::Random;
use sim3align_geometry::similarity::{Similarity, vec3, vector3};
use sim3align_geometry::surface_colors::{COLOR_SAMPLES, SurfaceColors};

/// Number of points over which a texture is blurred.
const BLUR_SAMPLES: usize = 6;

/// How a model colours the side it did not see.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Back {
    /// The truth.
    True,
    /// The mean of what it saw.
    Mean,
    /// Another print.
    Other,
}

/// The colours of a generated mesh. `world_from_mesh` is its pose on the table, `eye` the camera there.
///
/// # Errors
/// Only in case of a bug in the generator.
pub fn paint(
    mesh: &Mesh,
    world_from_mesh: &Similarity,
    (print, placed): (&Print, &Mesh),
    eye: DVec3,
    (tier, class): (Tier, Class),
    random: &mut Random,
) -> Result<SurfaceColors> {
    let back = match random.below(3) {
        0 => Back::True,
        1 => Back::Mean,
        _ => Back::Other,
    };
    // An object of one colour gets no print on its back.
    let kinds = [PrintKind::Label, PrintKind::Speckled, PrintKind::TwoTone];
    let kind = if class == Class::OneColor { PrintKind::Uniform } else { kinds[random.below(3)] };
    let other = Print::draw(placed, &[], kind, random);
    let print = if class == Class::WrongColors { &other } else { print };
    let diagonal = world_from_mesh.scale * mesh.diagonal();
    let blur = diagonal * between(random, 0.2, 1.0) * tier.pick(0.004, 0.012, 0.025);
    let mix = DMat3::from_cols_array(&core::array::from_fn(|k| {
        let share = tier.pick(0.02, 0.06, 0.12) * normal(random);
        if k % 4 == 0 { 1.0 + share } else { 0.5 * share }
    }));
    let gamma = libm::exp(between(random, -1.0, 1.0) * tier.pick(0.05, 0.2, 0.35));
    let baked = between(random, 0.0, tier.pick(0.1, 0.25, 0.4));
    let light = DVec3::new(normal(random), normal(random), 1.0).normalize_or(DVec3::Z);
    let mean = color(random);
    let samples = sample_surface(mesh, COLOR_SAMPLES, 0)?;
    let mut seen_sum = (DVec3::ZERO, 0.0);
    let mut albedos: Vec<(DVec3, f64, DVec3)> = Vec::with_capacity(samples.points.len());
    for (p, n) in samples.points.iter().zip(&samples.normals) {
        let point = vec3(&world_from_mesh.apply(vector3(*p))).as_dvec3();
        let normal_of = vec3(&(world_from_mesh.rotation * vector3(*n))).as_dvec3();
        // Smoothly from seen to unseen.
        let facing = normal_of.dot((eye - point).normalize_or_zero());
        let seen = ((facing + 0.1) / 0.25).clamp(0.0, 1.0);
        let albedo = blurred(print, point, normal_of, blur, random);
        let invented = match back {
            Back::Other => blurred(&other, point, normal_of, blur, random),
            _ => albedo,
        };
        seen_sum = (seen_sum.0 + albedo * seen, seen_sum.1 + seen);
        albedos.push((albedo * seen + invented * (1.0 - seen), seen, normal_of));
    }
    let mean = if seen_sum.1 > 0.0 { seen_sum.0 / seen_sum.1 } else { mean };
    let colors = albedos.into_iter().map(|(albedo, seen, normal_of)| {
        let albedo = if back == Back::Mean { albedo * seen + mean * (1.0 - seen) } else { albedo };
        let albedo = (mix * albedo).max(DVec3::splat(0.0));
        let shaded = albedo * (1.0 - baked * (0.5 - 0.5 * normal_of.dot(light)));
        let shaded = DVec3::new(libm::pow(shaded.x, gamma), libm::pow(shaded.y, gamma), libm::pow(shaded.z, gamma));
        (encoded(shaded) * 255.0).round().to_array().map(|x| x as u8)
    });
    let colors = colors.collect();
    SurfaceColors::new(samples, colors)
}

fn blurred(print: &Print, point: DVec3, normal_of: DVec3, radius: f64, random: &mut Random) -> DVec3 {
    let sum: DVec3 = (0..BLUR_SAMPLES)
        .map(|_| {
            let aside = DVec3::new(normal(random), normal(random), normal(random)) * radius;
            print.at(point + aside - normal_of * aside.dot(normal_of), normal_of)
        })
        .sum();
    sum / BLUR_SAMPLES as f64
}
