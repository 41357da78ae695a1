//! Prints: the colour of an object's surface, as a function of the position on it.

use super::Axis;
use super::mesh::bounds;
use crate::prelude::*;
use sim3align::geometry::surface::SurfaceMoments;
use sim3align_geometry::surface_colors::Rgb;

/// Sides of a label: those of a box, or one that goes round.
const SIDES: usize = 6;

/// Kinds of print.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PrintKind {
    /// Patches of colour on every side, as on packages.
    Label,
    /// The same patches on opposite sides, one of which has another patch.
    Repeated,
    Uniform,
}

/// The linear albedo of a surface, 0 to 1 in red, green and blue.
#[derive(Debug, Clone)]
pub struct Print {
    /// The axes of the object, as rows.
    axes: DMat3,
    center: DVec3,
    /// Half the extent along each axis.
    half: DVec3,
    /// Whether the label goes round the third axis.
    is_round: bool,
    base: DVec3,
    /// Patches of each side; those of later ones are on top.
    sides: Vec<Vec<Patch>>,
}

/// A rectangle or an ellipse on a side; all sides are -1 to 1 wide and high.
#[derive(Debug, Clone)]
struct Patch {
    center: [f64; 2],
    half: [f64; 2],
    is_ellipse: bool,
    color: DVec3,
}

impl Patch {
    fn draw(random: &mut Random, is_round: bool, base: DVec3) -> Self {
        let is_band = is_round && chance(random, 0.2);
        let half = if is_band {
            [2.0, between(random, 0.05, 0.3)]
        } else {
            [between(random, 0.1, 0.6), between(random, 0.05, 0.45)]
        };
        let color = contrasting(random, base);
        let center = [between(random, -0.8, 0.8), between(random, -0.8, 0.8)];
        Self { center, half, is_ellipse: !is_band && chance(random, 0.35), color }
    }

    fn contains(&self, at: [f64; 2], is_round: bool) -> bool {
        let mut d = [0, 1].map(|k| (at[k] - self.center[k]).abs());
        if is_round {
            d[0] = d[0].min((2.0 - d[0]).abs());
        }
        let d = [d[0] / self.half[0], d[1] / self.half[1]];
        if self.is_ellipse { d[0] * d[0] + d[1] * d[1] <= 1.0 } else { d[0] <= 1.0 && d[1] <= 1.0 }
    }
}

impl Print {
    /// Draws the print of an object with these symmetries.
    pub fn draw(mesh: &Mesh, symmetry: &[Axis], kind: PrintKind, random: &mut Random) -> Self {
        let (axes, is_round) = axes_of(mesh, symmetry);
        let (low, high) = bounds(mesh.positions().iter().map(|p| axes * p.as_dvec3()));
        let half = (0.5 * (high - low)).max(DVec3::splat(1e-9));
        let base = color(random);
        let count = if kind == PrintKind::Uniform {
            0
        } else if is_round {
            1
        } else {
            SIDES
        };
        let patches = |_| {
            let least = if is_round { 4 } else { usize::from(chance(random, 0.85)) };
            let count = if least == 0 { 0 } else { least + random.below(6) };
            (0..count).map(|_| Patch::draw(random, is_round, base)).collect()
        };
        let mut sides: Vec<Vec<Patch>> = (0..count).map(patches).collect();
        if kind == PrintKind::Repeated {
            repeat(&mut sides, random);
        }
        Self { axes, center: 0.5 * (low + high), half, is_round, base, sides }
    }

    /// The albedo at a point with this outward normal.
    pub fn at(&self, point: DVec3, normal: DVec3) -> DVec3 {
        let p = (self.axes * point - self.center) / self.half;
        let (side, at) = self.side(p, self.axes * normal);
        let patch =
            self.sides.get(side).and_then(|side| side.iter().rev().find(|patch| patch.contains(at, self.is_round)));
        patch.map_or(self.base, |patch| patch.color)
    }

    fn side(&self, p: DVec3, normal: DVec3) -> (usize, [f64; 2]) {
        if self.is_round {
            return (0, [2.0 * libm::atan2(p.y, p.x) / TAU, p.z]);
        }
        let axis = (0..3).max_by(|&a, &b| normal[a].abs().total_cmp(&normal[b].abs())).unwrap_or(0);
        (2 * axis + usize::from(normal[axis] > 0.0), [p[(axis + 1) % 3], p[(axis + 2) % 3]])
    }
}

/// Repeats the patches of one side on the opposite one. Those of the other side are gone but for one, on top.
fn repeat(sides: &mut [Vec<Patch>], random: &mut Random) {
    for pair in sides.chunks_mut(2) {
        match pair {
            [one, other] => {
                let last = other.pop();
                other.clone_from(one);
                other.extend(last);
            }
            // Half a turn round the object.
            [round] => {
                let opposite =
                    |patch: &Patch| Patch { center: [patch.center[0] - 1.0, patch.center[1]], ..patch.clone() };
                let own = random.below(round.len().max(1));
                let copies: Vec<Patch> =
                    round.iter().enumerate().filter(|(k, _)| *k != own).map(|(_, p)| opposite(p)).collect();
                round.extend(copies);
            }
            _ => {}
        }
    }
}

/// The axes of an object as rows, and whether it goes round the third one.
fn axes_of(mesh: &Mesh, symmetry: &[Axis]) -> (DMat3, bool) {
    let principal = SurfaceMoments::of(mesh).principal_axes().vectors;
    let round = symmetry.iter().find(|(_, fold)| fold.is_none()).map(|(axis, _)| *axis);
    let declared: Vec<DVec3> = symmetry.iter().map(|(axis, _)| *axis).collect();
    let third = round.or(declared.first().copied()).unwrap_or(principal[2]).normalize_or(DVec3::Z);
    let candidates = declared.iter().chain(&principal).map(|axis| *axis - third * axis.dot(third));
    let first = candidates.into_iter().find(|axis| axis.length() > 0.5).unwrap_or(third.any_orthogonal_vector());
    let first = first.normalize_or(DVec3::X);
    (DMat3::from_cols(first, third.cross(first), third).transpose(), round.is_some())
}

/// A colour that surfaces have: no black, no white.
pub fn color(random: &mut Random) -> DVec3 {
    let grey = between(random, 0.04, 0.75);
    let tint = DVec3::new(random.uniform(), random.uniform(), random.uniform()) * 0.8 + 0.03;
    let saturation = random.uniform();
    DVec3::splat(grey) * (1.0 - saturation) + tint * saturation
}

/// A colour that differs from another.
fn contrasting(random: &mut Random, other: DVec3) -> DVec3 {
    for _ in 0..20 {
        let candidate = color(random);
        if encoded(candidate).distance(encoded(other)) > 0.25 {
            return candidate;
        }
    }
    DVec3::splat(if other.element_sum() > 0.6 { 0.03 } else { 0.8 })
}

/// sRGB encoding of linear values, clipped to 0 to 1.
pub fn encoded(linear: DVec3) -> DVec3 {
    let encode = |x: f64| {
        let x = x.clamp(0.0, 1.0);
        if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * libm::pow(x, 1.0 / 2.4) - 0.055 }
    };
    DVec3::new(encode(linear.x), encode(linear.y), encode(linear.z))
}

/// sRGB-encoded bytes of linear values.
pub fn srgb(linear: DVec3) -> Rgb {
    (encoded(linear) * 255.0).round().to_array().map(|x| x as u8)
}
