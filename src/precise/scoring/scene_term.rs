//! Scene term: the support plane of an object and its neighbours, as evidence for its pose.
//!
//! Both are weighed, never enforced. Contact is credit that a pose loses as it leaves the ground, so that objects that
//! hang or lean are not pulled down; it hardly grows where the pose is far from standing.

use std::rc::Rc;

use glam::{DQuat, DVec3, Vec3};
use serde::{Deserialize, Serialize};

use crate::geometry::normal_equations::NormalEquations;
use crate::geometry::rotations::exp;
use crate::precise::drawing::mesh_pyramid::MeshPyramid;
use crate::precise::drawing::pose::CropPose;
use crate::precise::drawing::render::Canvas;
use crate::precise::drawing::stable_poses::{StablePose, stable_poses};
use crate::precise::observation::clean::CleanObservation;
use crate::precise::observation::grid::CropGrid;

/// The plane that an object may stand on.
#[derive(Debug, Clone)]
pub struct ContactPrior {
    /// Unit normal, camera frame, towards the objects.
    pub normal: DVec3,
    /// Height of the camera above the plane, metres: n·x + offset is the height of a point.
    pub offset_m: f64,
    /// Gap that halves the credit of the contact, metres.
    pub gap_m: f64,
    /// The attitudes of the mesh.
    pub stable_poses: Rc<[StablePose]>,
    /// The extreme vertices of the mesh.
    pub points: Rc<[Vec3]>,
    /// Weight of the contact, relative to the terms of the image.
    pub weight: f64,
}

/// Another object: for every pixel of a part of the image, where the line of sight enters and leaves it, metres; 0 and 0
/// where it does not meet the object.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Layer {
    /// First column and row.
    pub origin: [usize; 2],
    /// Columns.
    pub width: usize,
    /// Entry and exit, row by row.
    pub spans: Vec<[f32; 2]>,
}

/// The plane that an object may stand on, as far as it does not depend on the mesh.
#[derive(Debug, Clone, Copy)]
pub struct SupportPlane {
    /// See [`ContactPrior`].
    pub normal: DVec3,
    /// See [`ContactPrior`].
    pub offset_m: f64,
    /// See [`ContactPrior`].
    pub gap_m: f64,
}

/// The scene around an object, as known before its search.
#[derive(Debug, Clone, Default)]
pub struct SceneContext {
    /// The plane on which it may stand.
    pub plane: Option<SupportPlane>,
    /// The other objects, at the size of the whole image.
    pub layers: Vec<Rc<Layer>>,
}

impl SceneContext {
    /// Whether it is empty.
    pub fn is_empty(&self) -> bool {
        self.plane.is_none() && self.layers.is_empty()
    }
}

/// The evidence of the scene around an object, for one mesh.
#[derive(Debug, Clone, Default)]
pub struct SceneTerm {
    /// The plane on which it may stand.
    pub ground: Option<ContactPrior>,
    /// The other objects.
    pub layers: Vec<Rc<Layer>>,
    /// Depth inside another object from which on the two share volume, metres.
    pub margin_m: f32,
}

/// Tilt that halves the credit of an attitude, as a difference of unit vectors: 4°.
const TILT: f64 = 0.07;
/// Tilt beyond which an attitude is another one.
const MAX_TILT: f64 = 0.5;
/// Gap, in units of the one that halves the credit, at which the attitude counts half: what leans or hangs need not be
/// level.
const NEAR_GROUND: f64 = 3.0;
/// Depth in the ground, in units of the gap that halves the credit, from which on a pose loses no more: √(1 + 3²).
const DEEPEST: f64 = 3.162_277_660_168_379_5;
/// Stability of the attitudes in which a mesh is put on the ground, their number, and the headings of each.
const MIN_STABILITY: f64 = 0.3;
const MAX_STABLE_POSES: usize = 10;
const HEADINGS: usize = 30;
/// Shares of the gap and of the attitude in the credit of the contact.
const SHARES: [f64; 2] = [0.5, 0.5];
/// Weight of the contact, relative to the terms of the image.
const CONTACT: f64 = 0.2;
/// Depth inside another object from which on two objects share volume, relative to the observed diagonal: undersides
/// and backs are invented.
const MARGIN: f64 = 0.04;
/// Maximum change of the logarithm of the distance to touch the ground.
const MAX_STRETCH: f64 = 0.15;
/// Weight of the share of a silhouette that is inside other objects.
const SHARED_VOLUME: f32 = 0.6;

/// A pose relative to the ground.
struct Stand<'a> {
    /// The attitude; `None` if the pose is far from all of them.
    stable: Option<&'a StablePose>,
    /// The points that touch the ground, in the normalised frame of the mesh.
    base: DVec3,
    /// Height of the base over the plane, in units of the gap that halves the credit.
    gap: f64,
    /// Tilt about the axes of the stable.
    tilt: [f64; 2],
}

impl ContactPrior {
    /// The nearest attitude of a pose.
    fn stand(&self, pose: &CropPose) -> Stand<'_> {
        let (scale, translation) = pose.scale_translation();
        let height = |p: DVec3| self.normal.dot(pose.rotation * p * scale + translation) + self.offset_m;
        let mut best: Option<(f64, &StablePose)> = None;
        for stable in self.stable_poses.iter() {
            let error = (pose.rotation * stable.down + self.normal).length_squared();
            if error < best.map_or(MAX_TILT * MAX_TILT, |(least, _)| least) {
                best = Some((error, stable));
            }
        }
        let Some((_, stable)) = best else {
            let points = self.points.iter().map(|p| p.as_dvec3());
            let lowest =
                points.map(|p| (height(p), p)).fold((f64::INFINITY, DVec3::ZERO), |a, b| if b.0 < a.0 { b } else { a });
            return Stand { stable: None, base: lowest.1, gap: lowest.0 / self.gap_m, tilt: [0.0; 2] };
        };
        let error = pose.rotation * stable.down + self.normal;
        // The tilt about an axis moves `down` along the other one.
        let [a, b] = stable.axes.map(|axis| (pose.rotation * axis).dot(error));
        let tilt = [b * stable.stability[0].sqrt(), a * stable.stability[1].sqrt()];
        Stand { stable: Some(stable), base: stable.base, gap: height(stable.base) / self.gap_m, tilt }
    }

    /// The credit of the contact, at most the weight; negative for a pose that is sunk in.
    fn score(&self, pose: &CropPose) -> f64 {
        let Stand { stable, gap, tilt, .. } = self.stand(pose);
        let level = stable.map_or(0.0, |stable| near_ground(gap) * stability(stable) * level(tilt));
        self.weight * (SHARES[0] * touch(gap).0 + SHARES[1] * level)
    }

    /// Adds the quadratic of the credit at a pose.
    fn add_to(&self, equations: &mut NormalEquations, pose: &CropPose, lock_scale: bool) {
        let Stand { stable, base, gap, tilt } = self.stand(pose);
        let (scale, translation) = pose.scale_translation();
        let arm = pose.rotation * base * scale;
        let point = arm + translation;
        let gradient = self.normal / self.gap_m;
        let turn = arm.cross(gradient);
        let place = gradient * scale;
        let (size, distance) = if lock_scale {
            (arm.dot(gradient) - point.dot(gradient), 0.0)
        } else {
            (arm.dot(gradient), point.dot(gradient) * libm::exp(pose.size))
        };
        let jacobian = [turn.x, turn.y, turn.z, size, place.x, place.y, distance];
        equations.add(&jacobian, gap, self.weight * SHARES[0] * touch(gap).1);

        let Some(stable) = stable else { return };
        let credit = level(tilt);
        let weight =
            2.0 * self.weight * SHARES[1] * near_ground(gap) * stability(stable) * credit * credit / (TILT * TILT);
        for (k, error) in tilt.into_iter().enumerate() {
            let axis = pose.rotation * stable.axes[1 - k] * stable.stability[k].sqrt();
            // The tilt is axis·n, because the axis is perpendicular to `down`, and δ(axis) = ω × axis.
            let turn = axis.cross(self.normal);
            equations.add(&[turn.x, turn.y, turn.z, 0.0, 0.0, 0.0, 0.0], error, weight);
        }
    }

    /// The rotations in which the mesh stands on the ground: its steadiest attitudes, turned about the normal.
    fn standing(&self) -> Vec<DQuat> {
        let mut steady: Vec<&StablePose> =
            self.stable_poses.iter().filter(|stable| stability(stable) > MIN_STABILITY).collect();
        let total = |stable: &StablePose| stable.stability[0] + stable.stability[1];
        while steady.len() > MAX_STABLE_POSES {
            let least = steady.iter().map(|stable| total(stable)).fold(f64::INFINITY, f64::min);
            let Some(loosest) = steady.iter().rposition(|stable| total(stable) == least) else { break };
            steady.remove(loosest);
        }
        let turned = |stable: &StablePose| {
            let upright = DQuat::from_rotation_arc(stable.down, -self.normal);
            let turn = core::f64::consts::TAU / HEADINGS as f64;
            (0..HEADINGS).map(move |k| (exp(self.normal * (turn * k as f64)) * upright).normalize()).collect::<Vec<_>>()
        };
        steady.into_iter().flat_map(turned).collect()
    }
}

/// The credit of a gap, and the curvature of the quadratic that bounds it. What hangs keeps a little credit, however high
/// it is; what is sunk in loses ever more.
fn touch(gap: f64) -> (f64, f64) {
    if gap >= 0.0 {
        let credit = 1.0 / (1.0 + gap * gap);
        return (credit, 2.0 * credit * credit);
    }
    let root = (1.0 + gap * gap).sqrt();
    // As steep as the other branch where they meet.
    if root > DEEPEST { (3.0 - 2.0 * DEEPEST, 0.0) } else { (3.0 - 2.0 * root, 2.0 / root) }
}

fn near_ground(gap: f64) -> f64 {
    1.0 / (1.0 + (gap / NEAR_GROUND) * (gap / NEAR_GROUND))
}

fn level([a, b]: [f64; 2]) -> f64 {
    1.0 / (1.0 + (a * a + b * b) / (TILT * TILT))
}

fn stability(stable: &StablePose) -> f64 {
    stable.stability[0].max(stable.stability[1])
}

impl SceneTerm {
    /// The scene term of a mesh and its observation.
    pub fn new(context: SceneContext, mesh: &MeshPyramid, observation: &CleanObservation) -> Self {
        let ground = context.plane.map(|SupportPlane { normal, offset_m, gap_m }| ContactPrior {
            normal,
            offset_m,
            gap_m,
            stable_poses: stable_poses(&mesh.fine).into(),
            points: mesh.outermost.as_slice().into(),
            weight: CONTACT,
        });
        Self { ground, layers: context.layers, margin_m: (MARGIN * observation.diagonal_m) as f32 }
    }

    /// A pose, put down on the ground in the attitude that it almost has: level, at the distance at which it touches the
    /// ground, and both. The silhouette hardly changes.
    pub fn put_down(&self, pose: &CropPose) -> Vec<CropPose> {
        let Some(ground) = &self.ground else { return Vec::new() };
        let Some(stable) = ground.stand(pose).stable else { return Vec::new() };
        let down = pose.rotation * stable.down;
        let level = DQuat::from_rotation_arc(down, -ground.normal);
        let leveled = CropPose { rotation: (level * pose.rotation).normalize(), ..*pose };
        let touching = |pose: &CropPose| {
            let (scale, translation) = pose.scale_translation();
            let base = pose.rotation * stable.base * scale + translation;
            let stretch = libm::log(-ground.offset_m / ground.normal.dot(base));
            (stretch.abs() < MAX_STRETCH).then_some(CropPose { distance: pose.distance + stretch, ..*pose })
        };
        let is_tilted = stability(stable) > 0.2;
        let mut poses: Vec<CropPose> = touching(pose).into_iter().collect();
        if is_tilted {
            poses.push(leveled);
            poses.extend(touching(&leveled));
        }
        poses
    }

    /// The rotations in which the mesh stands on the ground; none without ground.
    pub fn standing(&self) -> Vec<DQuat> {
        self.ground.as_ref().map_or_else(Vec::new, ContactPrior::standing)
    }

    /// The credit of the contact of a pose with the ground; 0 without ground.
    pub fn contact(&self, pose: &CropPose) -> f64 {
        self.ground.as_ref().map_or(0.0, |ground| ground.score(pose))
    }

    /// The scene term in the score of the last render.
    pub fn score(&self, canvas: &Canvas, grid: &CropGrid, pose: &CropPose) -> f32 {
        self.contact(pose) as f32 - SHARED_VOLUME * self.shared(canvas, grid)
    }

    /// Adds the quadratic of the contact at a pose.
    pub fn add_to(&self, equations: &mut NormalEquations, pose: &CropPose, lock_scale: bool) {
        self.ground.iter().for_each(|ground| ground.add_to(equations, pose, lock_scale));
    }

    /// The share of the drawn cells, outside the mask, whose surface is inside another object.
    fn shared(&self, canvas: &Canvas, grid: &CropGrid) -> f32 {
        if self.layers.is_empty() {
            return 0.0;
        }
        let (mut drawn, mut inside) = (0u32, 0u32);
        for (i, w) in canvas.inverse_depth.iter().enumerate().filter(|(_, w)| **w > 0.0) {
            drawn += 1;
            if grid.mask[i] {
                continue;
            }
            let z = 1.0 / w;
            let at = [i % grid.width, i / grid.width];
            let pixel = [0, 1].map(|axis| grid.corner[axis] - 0.5 + (at[axis] as f64 + 0.5) * grid.cell[axis] + 0.5);
            let is_inside = |layer: &Rc<Layer>| {
                let [near, far] = layer.span(pixel);
                near + self.margin_m < z && z + self.margin_m < far
            };
            inside += u32::from(self.layers.iter().any(is_inside));
        }
        inside as f32 / drawn.max(1) as f32
    }
}

impl Layer {
    /// Entry and exit at a position in the image, pixels from the image's corner; 0 and 0 outside.
    pub fn span(&self, at: [f64; 2]) -> [f32; 2] {
        let [u, v] = [at[0] - self.origin[0] as f64, at[1] - self.origin[1] as f64];
        if !(u >= 0.0 && v >= 0.0 && u < self.width as f64) {
            return [0.0; 2];
        }
        self.spans.get(v as usize * self.width + u as usize).copied().unwrap_or_default()
    }
}
