//! The colours that a generative model gives its mesh: those of the photo where it saw the object, invented elsewhere.

use crate::conditions::Conditions;
use crate::objects::print::{Print, PrintKind, color, srgb};
use crate::prelude::*;
use crate::world::Placed;
use sim3align::geometry::surface::sample_surface;
use sim3align_geometry::surface_colors::Rgb;

/// Number of points over which a colour is blurred.
const BLUR_SAMPLES: usize = 3;
/// Number of points whose mean colour is that of an unseen side.
const MEAN_SAMPLES: usize = 2000;

/// Colours of a model for the unseen side.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Back {
    True,
    /// The mean of the side that it saw.
    Mean,
    Other,
}

/// The colours of a generated mesh, with the errors of a model.
struct Painter<'a> {
    print: &'a Print,
    other: &'a Print,
    back: Back,
    /// The colour of the unseen side for [`Back::Mean`].
    mean: DVec3,
    /// Reach of the blur, metres.
    blur: f64,
    /// Change of the hue and of the balance of the channels.
    mix: DMat3,
    gamma: f64,
    /// Share of the light of the photo that stays in the colours, and where it comes from.
    baked: (f64, DVec3),
    eye: DVec3,
}

impl Painter<'_> {
    /// The linear albedo, and how much of it was seen, 0 to 1.
    fn albedo(&self, point: DVec3, normal: DVec3, random: &mut Random) -> (DVec3, f64) {
        // Smoothly from seen to unseen.
        let facing = normal.dot((self.eye - point).normalize_or_zero());
        let seen = ((facing + 0.1) / 0.25).clamp(0.0, 1.0);
        let mut blurred = |print: &Print| {
            let mut offset = || between(random, -self.blur, self.blur);
            let sum = (0..BLUR_SAMPLES).map(|_| {
                let aside = DVec3::new(offset(), offset(), offset());
                print.at(point + aside - normal * aside.dot(normal), normal)
            });
            sum.sum::<DVec3>() / BLUR_SAMPLES as f64
        };
        let albedo = blurred(self.print);
        let invented = match self.back {
            Back::True => albedo,
            Back::Mean => self.mean,
            Back::Other => blurred(self.other),
        };
        (albedo * seen + invented * (1.0 - seen), seen)
    }

    fn color(&self, point: DVec3, normal: DVec3, random: &mut Random) -> Rgb {
        let albedo = (self.mix * self.albedo(point, normal, random).0).max(DVec3::ZERO);
        let (share, light) = self.baked;
        let shaded = albedo * (1.0 - share * (0.5 - 0.5 * normal.dot(light)));
        srgb(DVec3::from_array(shaded.to_array().map(|x| libm::pow(x, self.gamma))))
    }
}

/// The colours of a mesh whose pose in the world is `world_from_mesh`, made from what a camera at `eye` saw.
pub fn paint(
    mesh: &Mesh,
    world_from_mesh: &Similarity,
    (placed, print): (&Placed, &Print),
    eye: DVec3,
    conditions: Conditions,
    random: &mut Random,
) -> Result<SurfaceColors> {
    let Conditions { tier, class } = conditions;
    let kind = class.print.unwrap_or(PrintKind::Label);
    let other = Print::draw(&placed.mesh, &[], kind, random);
    let diagonal = world_from_mesh.scale * mesh.diagonal();
    let mut painter = Painter {
        print: if class.has_wrong_colors { &other } else { print },
        other: &other,
        back: [Back::True, Back::Mean, Back::Other][random.below(3)],
        mean: color(random),
        // The variance of a uniform number from −a to a is a²/3.
        blur: 3f64.sqrt() * diagonal * between(random, 0.2, 1.0) * tier.pick(0.004, 0.012, 0.025),
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
    let in_world = |p: Vec3| vec3(&world_from_mesh.apply(vector3(p))).as_dvec3();
    let turned = |n: Vec3| vec3(&(world_from_mesh.rotation * vector3(n))).as_dvec3();
    let samples = sample_surface(mesh, MEAN_SAMPLES, 0)?;
    let (mut sum, mut count) = (DVec3::ZERO, 0.0);
    for (p, n) in samples.points.iter().zip(&samples.normals) {
        let (albedo, seen) = painter.albedo(in_world(*p), turned(*n), random);
        (sum, count) = (sum + albedo * seen, count + seen);
    }
    if count > 0.0 {
        painter.mean = sum / count;
    }
    SurfaceColors::sample(mesh, &mut |sample| painter.color(in_world(sample.point), turned(sample.normal), random))
}
