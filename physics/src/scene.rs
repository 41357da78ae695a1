//! Bodies of a scene, at poses that they keep.

use glam::DVec3;
use sim3align_geometry::mesh::Mesh;
use sim3align_geometry::similarity::Similarity;

use super::apart::{ASIDE_M, INSIDE_M, depth, steps_apart};
use super::body::{Body, Pose};
use super::columns::Columns;
use super::ground::agreed_height;
use super::rest::levelled;

/// The thing on which an object rests.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum On {
    /// The ground.
    Ground,
    /// Another object.
    Object(usize),
    /// Neither: it hangs, or stands on what is no object.
    Nothing,
}

/// An object of a scene.
#[derive(Debug, Clone)]
pub struct Object {
    /// Its mesh.
    pub mesh: Mesh,
    /// World from mesh.
    pub world_from_mesh: Similarity,
    /// The thing on which it rests.
    pub on: On,
}

/// Options of the bodies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Kilograms per cubic metre.
    pub density: f64,
    /// Most convex parts of a body.
    pub parts: usize,
    /// Largest angle by which a body is turned so that it rests, degrees.
    pub turn_deg: f64,
    /// Largest distance of any point of its surface from where it was found, metres.
    pub move_m: f64,
    /// Whether the ground was found, and not given: its height is then fitted to the bodies that stand on it.
    pub fits_ground: bool,
    /// Whether bodies are moved at all. Otherwise they keep their poses, and those that would come to rest nearby are free.
    pub rest: bool,
}

/// A change of a pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    /// The largest motion of a point of the surface, metres.
    pub move_m: f64,
    /// Degrees.
    pub turn_deg: f64,
}

/// A body of a scene.
#[derive(Debug, Clone)]
pub struct Settled {
    /// Its parts, mass and pose.
    pub body: Body,
    /// The pose at which it was found.
    pub found: Pose,
    /// Whether it may move: it rests by itself.
    pub is_free: bool,
    /// From where it was found to its pose.
    pub motion: Motion,
    /// From where it was found to the pose at which the whole body would rest; `None` if there is no such pose.
    pub rest: Option<Motion>,
    /// By how much its parts are cut from below, so that it rests as it was found, metres.
    pub cut_m: f64,
    /// The other bodies that it is partly inside of.
    pub inside: Vec<usize>,
}

/// Side of a column, metres, and most columns along the largest body.
const CELL_M: f64 = 0.0015;
const MOST_CELLS: f64 = 220.0;
/// Distance up to which a surface counts as touched, metres.
const TOUCH_M: f64 = 1e-3;
/// Distance up to which corners of a body that is cut are in the plane of the cut, metres.
const LEVEL_M: f64 = 1e-5;
/// Directions in which a body must not tip over what it stands on.
const DIRECTIONS: usize = 16;
/// Largest angle by which a body that stands on the ground leans, degrees: others do not decide its height.
const LEAN_DEG: f64 = 12.0;
/// Most that is cut off the underside of a body, metres, and its step. Undersides are seen by no camera: scans and generated
/// meshes are often wrong there by as much.
const CUT_M: f64 = 4e-3;
const CUT_STEP_M: f64 = 2.5e-4;
/// How far what a body that is cut stands on reaches beyond its centre of mass: this share of its height, and as many metres.
const REACH: [f64; 2] = [0.05, 2e-3];

/// The bodies of a scene, and the height above the ground of the plane z = 0 of their poses: those of the bodies are above
/// the ground.
///
/// An image places most bodies better than rest would: the facet that a body comes to lie on is that of a mesh whose underside
/// nobody saw. A body is therefore put at rest where that moves and turns it less than a bound. Otherwise it keeps its rotation,
/// and a little is cut off the underside of its parts, so that it stands there; where that does not suffice, it is to be fixed
/// where it was found.
/// A ground that was found is first moved to the height that most of the bodies on it agree on: they are then moved the
/// least.
pub fn settle(objects: &[Object], settings: &Settings) -> (Vec<Settled>, f64) {
    let mut bodies: Vec<Settled> = objects
        .iter()
        .map(|Object { mesh, world_from_mesh, .. }| {
            let body = Body::new(mesh, world_from_mesh, settings.parts, settings.density);
            let motion = Motion { move_m: 0.0, turn_deg: 0.0 };
            Settled { found: body.pose, body, is_free: false, motion, rest: None, cut_m: 0.0, inside: Vec::new() }
        })
        .collect();
    let mut lift = 0.0;
    if settings.fits_ground && settings.rest {
        let mut lowest = Vec::new();
        for (Settled { body, .. }, object) in bodies.iter().zip(objects) {
            if let (On::Ground, Some((pose, angle))) = (object.on, levelled(body)) {
                let height = body.pose.apply(body.mass.center).z - pose.apply(body.mass.center).z;
                if angle.to_degrees() <= LEAN_DEG && height.is_finite() {
                    lowest.push(height);
                }
            }
        }
        lift = -agreed_height(&lowest).unwrap_or(0.0);
        for settled in &mut bodies {
            settled.found.translation.z += lift;
            settled.body.pose = settled.found;
        }
    }
    let reach = |settled: &Settled| {
        let points = || settled.body.points(settled.body.pose);
        let low = points().fold(DVec3::INFINITY, DVec3::min);
        let size = points().fold(DVec3::NEG_INFINITY, DVec3::max) - low;
        (low.z, size.max_element())
    };
    // Of any side: what stands may come to lie.
    let longest = bodies.iter().map(|b| reach(b).1).filter(|x| x.is_finite()).fold(0.0, f64::max);
    let cell = CELL_M.max(longest / MOST_CELLS);
    // From below, and what carries before what it carries, which then finds it at its place.
    let mut order: Vec<usize> = (0..objects.len()).collect();
    order.sort_by(|a, b| reach(&bodies[*a]).0.total_cmp(&reach(&bodies[*b]).0));
    let mut done = vec![false; objects.len()];
    let waits =
        |i: &usize, done: &[bool]| matches!(objects[*i].on, On::Object(k) if k != *i && done.get(k) == Some(&false));
    while let Some(next) = order.iter().position(|i| !waits(i, &done)) {
        let i = order.remove(next);
        done[i] = true;
        let below = match objects[i].on {
            On::Nothing => continue,
            On::Ground => None,
            On::Object(k) if k != i && done.get(k) == Some(&true) => Some(k),
            On::Object(_) => continue,
        };
        let surface = below.map(|k| bodies[k].body.columns(bodies[k].body.pose, cell));
        let settled = &mut bodies[i];
        settled.rest = levelled(&settled.body).and_then(|(pose, angle)| {
            let pose = put_down(&settled.body, pose, surface.as_deref(), cell)?;
            let motion = Motion { move_m: distance(settled, pose), turn_deg: angle.to_degrees() };
            settled.is_free = motion.turn_deg <= settings.turn_deg && motion.move_m <= settings.move_m;
            if settled.is_free && settings.rest {
                settled.body.pose = pose;
                settled.motion = motion;
            }
            Some(motion)
        });
        if settled.is_free {
            continue;
        }
        if let Some((body, cut_m)) = cut_to_rest(settled, surface.as_deref(), cell, settings.move_m) {
            settled.is_free = true;
            if settings.rest {
                (settled.body, settled.cut_m) = (body, cut_m);
            }
        }
    }
    let mut columns: Vec<_> = bodies.iter().map(|b| b.body.columns(b.body.pose, cell)).collect();
    // What stands on another body, or carries one, keeps its place on it.
    let carries = |i: usize| objects.iter().any(|o| o.on == On::Object(i));
    let may_move = |i: usize| settings.rest && bodies[i].is_free && objects[i].on == On::Ground && !carries(i);
    // What is left of the bound, whatever the direction.
    let left = |i: usize| (settings.move_m - distance(&bodies[i], bodies[i].body.pose)).max(0.0);
    let reach_m: Vec<f64> = (0..bodies.len()).map(|i| if may_move(i) { left(i).min(ASIDE_M) } else { 0.0 }).collect();
    for (i, step) in steps_apart(&columns, &reach_m, cell).into_iter().enumerate() {
        if step != [0, 0] {
            bodies[i].body.pose.translation += DVec3::new(step[0] as f64, step[1] as f64, 0.0) * cell;
            columns[i] = bodies[i].body.columns(bodies[i].body.pose, cell);
        }
    }
    for i in 0..bodies.len() {
        let is_inside = |k: &usize| *k != i && depth(&columns[i], &columns[*k]) > INSIDE_M;
        bodies[i].inside = (0..bodies.len()).filter(is_inside).collect();
        bodies[i].motion.move_m = distance(&bodies[i], bodies[i].body.pose);
    }
    (bodies, lift)
}

/// The largest distance of a point of a body, at a pose, from where it was found, metres.
fn distance(Settled { body, found, .. }: &Settled, pose: Pose) -> f64 {
    body.points(pose).zip(body.points(*found)).map(|(to, from)| (to - from).length()).fold(0.0, f64::max)
}

/// The body at the rotation at which it was found, its parts cut level from below so that it stands; and by how much. Among the
/// cuts that suffice, that which moves it least. The mass is that of the whole body.
fn cut_to_rest(settled: &Settled, below: Option<&[Columns]>, cell: f64, most_m: f64) -> Option<(Body, f64)> {
    let Settled { body, found, .. } = settled;
    let lowest = |body: &Body| body.points(*found).map(|p| p.z).fold(f64::INFINITY, f64::min);
    let (low, up) = (lowest(body), found.rotation.inverse() * DVec3::Z);
    // On the ground, what has sunk into it is cut first: the body then does not move at all.
    let sunk = if below.is_none() { (-low).clamp(0.0, CUT_M) } else { 0.0 };
    let steps = ((CUT_M - sunk) / CUT_STEP_M) as usize;
    let mut best: Option<(Body, f64, f64)> = None;
    for cut_m in (0..=steps).map(|k| sunk + k as f64 * CUT_STEP_M).filter(|cut_m| *cut_m > 0.0) {
        let height = low + cut_m - found.translation.z;
        let parts = body.parts.iter().filter_map(|part| part.above(up, height)).collect();
        let mut cut = Body { parts, walls_joined: body.walls_joined, mass: body.mass, pose: *found };
        let mut pose = *found;
        pose.translation.z -= lowest(&cut);
        let center = pose.apply(body.mass.center);
        let level: Vec<DVec3> = cut.points(pose).filter(|p| p.z < LEVEL_M).map(|p| p - center).collect();
        if !holds(&level, REACH[0] * center.z + REACH[1]) {
            continue;
        }
        let Some(pose) = put_down(&cut, pose, below, cell) else { continue };
        let move_m = (pose.translation - found.translation).length();
        if move_m <= most_m && best.as_ref().is_none_or(|(.., least)| move_m < *least) {
            cut.pose = pose;
            best = Some((cut, cut_m, move_m));
        }
    }
    best.map(|(body, cut_m, _)| (body, cut_m))
}

/// The pose, raised onto what is below; `None` if the body would tip over there.
fn put_down(body: &Body, mut pose: Pose, below: Option<&[Columns]>, cell: f64) -> Option<Pose> {
    let Some(below) = below else { return Some(pose) };
    let columns = body.columns(pose, cell);
    let top = |at: [i64; 2]| below.iter().filter_map(|c| c.at(at)).map(|s| s[1]).fold(0.0, f64::max);
    let lower = || columns.iter().flat_map(Columns::cells).map(|(at, [low, _])| (at, top(at) - low));
    let lift = lower().map(|(_, gap)| gap).fold(f64::NEG_INFINITY, f64::max);
    if !lift.is_finite() {
        return None;
    }
    pose.translation.z += lift;
    let center = pose.apply(body.mass.center);
    let middle = |at: [i64; 2]| DVec3::new((at[0] as f64 + 0.5) * cell, (at[1] as f64 + 0.5) * cell, center.z) - center;
    let touched: Vec<DVec3> = lower().filter(|(_, gap)| gap + TOUCH_M > lift).map(|(at, _)| middle(at)).collect();
    holds(&touched, 2.0 * cell).then_some(pose)
}

/// Whether the hull of points, relative to the centre of mass, contains it with a margin on all sides.
fn holds(points: &[DVec3], margin: f64) -> bool {
    (0..DIRECTIONS).all(|k| {
        let (sine, cosine) = libm::sincos(core::f64::consts::TAU * k as f64 / DIRECTIONS as f64);
        points.iter().any(|p| p.x * cosine + p.y * sine > margin)
    })
}
