//! The texture that a generative model gives its mesh: the colours of the photo where it saw the object, invented
//! elsewhere.

use super::atlas::Atlas;
use super::print::{Print, PrintKind, color, srgb};
use super::tier::{Class, Tier};
use crate::case_folder::write::{JpegSettings, rgb_jpeg, rgb_png, textured_obj};
use crate::files::NamedFile;
use crate::prelude::*;
use sim3align::geometry::surface::sample_surface;
use sim3align_formats::colored_mesh::ColoredMesh;
use sim3align_formats::mesh::{MeshFormat, MeshReadOptions, read_colored_mesh};
use sim3align_geometry::surface_colors::Rgb;

/// Number of points over which a texel is blurred.
const BLUR_SAMPLES: usize = 3;
/// Number of points whose mean colour is that of an unseen side.
const MEAN_SAMPLES: usize = 2000;
/// Lowest quality of textures saved as JPEG.
const LOWEST_QUALITY: u8 = 75;

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

/// What a model makes of the colours of an object.
struct Painter<'a> {
    print: &'a Print,
    /// The invented print.
    other: &'a Print,
    back: Back,
    /// The colour of the unseen side for [`Back::Mean`].
    mean: DVec3,
    /// Standard deviation of the blur, metres.
    blur: f64,
    /// Change of the hue and of the balance of the channels.
    mix: DMat3,
    gamma: f64,
    /// Share of the light of the photo that stays in the texture, and where it comes from.
    baked: (f64, DVec3),
    eye: DVec3,
}

impl Painter<'_> {
    /// The linear albedo, and how much of it was seen, 0 to 1.
    fn albedo(&self, point: DVec3, normal: DVec3, random: &mut Random) -> (DVec3, f64) {
        // Smoothly from seen to unseen.
        let facing = normal.dot((self.eye - point).normalize_or_zero());
        let seen = ((facing + 0.1) / 0.25).clamp(0.0, 1.0);
        let blurred = |print: &Print, random: &mut Random| {
            // The variance of a uniform number from −a to a is a²/3.
            let reach = 3.0f64.sqrt() * self.blur;
            let mut offset = || between(random, -reach, reach);
            let sum = (0..BLUR_SAMPLES).map(|_| {
                let aside = DVec3::new(offset(), offset(), offset());
                print.at(point + aside - normal * aside.dot(normal), normal)
            });
            sum.sum::<DVec3>() / BLUR_SAMPLES as f64
        };
        let invented = match self.back {
            Back::True => return (blurred(self.print, random), seen),
            _ if seen >= 1.0 => DVec3::ZERO,
            Back::Mean => self.mean,
            Back::Other => blurred(self.other, random),
        };
        let albedo = if seen > 0.0 { blurred(self.print, random) } else { DVec3::ZERO };
        (albedo * seen + invented * (1.0 - seen), seen)
    }

    /// The colour of a texel.
    fn color(&self, point: DVec3, normal: DVec3, random: &mut Random) -> Rgb {
        let albedo = (self.mix * self.albedo(point, normal, random).0).max(DVec3::ZERO);
        let (share, light) = self.baked;
        let shaded = albedo * (1.0 - share * (0.5 - 0.5 * normal.dot(light)));
        srgb(DVec3::from_array(shaded.to_array().map(|x| libm::pow(x, self.gamma))))
    }
}

/// A textured mesh.
pub struct Painted {
    /// The mesh, and its colours as they are read from the files.
    pub mesh: ColoredMesh,
    /// `mesh.obj`, `mesh.mtl` and the texture.
    pub files: Vec<NamedFile>,
}

/// Paints a mesh. `world_from_mesh` is its pose on the table, `eye` the camera there.
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
) -> Result<Painted> {
    let back = match random.below(3) {
        0 => Back::True,
        1 => Back::Mean,
        _ => Back::Other,
    };
    // An object of one colour gets no print on its back.
    let kinds = [PrintKind::Label, PrintKind::Speckled, PrintKind::TwoTone];
    let kind = if class == Class::OneColor { PrintKind::Uniform } else { kinds[random.below(3)] };
    let other = Print::draw(placed, &[], kind, random);
    let diagonal = world_from_mesh.scale * mesh.diagonal();
    let mut painter = Painter {
        print: if class == Class::WrongColors { &other } else { print },
        other: &other,
        back,
        mean: color(random),
        blur: diagonal * between(random, 0.2, 1.0) * tier.pick(0.004, 0.012, 0.025),
        mix: DMat3::from_cols_array(&core::array::from_fn(|k| {
            let share = tier.pick(0.02, 0.06, 0.12) * normal(random);
            if k % 4 == 0 { 1.0 + share } else { 0.5 * share }
        })),
        gamma: libm::exp(between(random, -1.0, 1.0) * tier.pick(0.05, 0.2, 0.35)),
        baked: (
            between(random, 0.0, tier.pick(0.1, 0.25, 0.4)),
            DVec3::new(normal(random), normal(random), 1.0).normalize_or(DVec3::Z),
        ),
        eye,
    };
    let in_world = |p: DVec3| vec3(&world_from_mesh.apply(vector3(p.as_vec3()))).as_dvec3();
    let turned = |n: DVec3| vec3(&(world_from_mesh.rotation * vector3(n.as_vec3()))).as_dvec3();
    let samples = sample_surface(mesh, MEAN_SAMPLES, 0)?;
    let (mut sum, mut count) = (DVec3::ZERO, 0.0);
    for (p, n) in samples.points.iter().zip(&samples.normals) {
        let (albedo, seen) = painter.albedo(in_world(p.as_dvec3()), turned(n.as_dvec3()), random);
        (sum, count) = (sum + albedo * seen, count + seen);
    }
    if count > 0.0 {
        painter.mean = sum / count;
    }
    let atlas = Atlas::new(mesh.triangles().len());
    let facing = if mesh.signed_volume6() < 0.0 { -1.0 } else { 1.0 };
    let texels = atlas.paint(&mut |triangle, [second, third]| {
        let [a, b, c] = mesh.corners(mesh.triangles()[triangle]).map(|p| p.as_dvec3());
        let normal = (b - a).cross(c - a).normalize_or_zero() * facing;
        painter.color(in_world(a + (b - a) * second + (c - a) * third), turned(normal), random)
    });
    let texture = if chance(random, 0.5) {
        ("texture.jpg", rgb_jpeg(&texels, atlas.size, atlas.size, JpegSettings::draw(random, LOWEST_QUALITY))?)
    } else {
        ("texture.png", rgb_png(&texels, atlas.size, atlas.size)?)
    };
    let library = format!("newmtl print\nmap_Kd {}\n", texture.0);
    let mesh_file = ("mesh.obj", textured_obj(mesh, &atlas.coordinates(), "mesh.mtl"));
    let files = vec![mesh_file, ("mesh.mtl", library.into_bytes()), texture];
    let resources = |wanted: &str| files.iter().find(|(name, _)| *name == wanted).map(|(_, bytes)| bytes.clone());
    let options = MeshReadOptions { format: Some(MeshFormat::Obj), resources: Some(&resources) };
    Ok(Painted { mesh: read_colored_mesh(&files[0].1, &options)?, files })
}
