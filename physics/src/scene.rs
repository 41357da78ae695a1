//! Bodies of a scene, at poses that they keep.

use glam::DVec3;
use sim3align_geometry::mesh::Mesh;
use sim3align_geometry::similarity::Similarity;

use super::body::{Body, Pose};
use super::columns::Columns;
use super::rest::levelled;

/// What an object rests on.
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
    /// What it rests on.
    pub on: On,
}

/// How bodies are made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Kilograms per cubic metre.
    pub density: f64,
    /// Most convex parts of a body.
    pub parts: usize,
    /// Largest angle by which a body is turned so that it rests, degrees.
    pub turn_deg: f64,
    /// Largest distance by which its centre of mass is moved for that, metres.
    pub move_m: f64,
}

/// A body of a scene.
#[derive(Debug, Clone)]
pub struct Settled {
    /// Its parts, mass and pose.
    pub body: Body,
    /// Whether it may move: it rests by itself.
    pub is_free: bool,
    /// How far its centre of mass has been moved, metres.
    pub moved_m: f64,
    /// How far it has been turned, degrees.
    pub turned_deg: f64,
    /// The other bodies that it is partly inside of.
    pub inside: Vec<usize>,
}

/// Side of a column, metres, and most columns along the largest body.
const CELL_M: f64 = 0.0015;
const MOST_CELLS: f64 = 220.0;
/// Distance up to which a surface counts as touched, metres.
const TOUCH_M: f64 = 1e-3;
/// Directions in which a body must not tip over what it stands on.
const DIRECTIONS: usize = 16;
/// Depth up to which bodies may be inside of each other, metres: physics parts them.
const INSIDE_M: f64 = 2e-3;
/// Rounds in which bodies that stand side by side are moved apart.
const ROUNDS: usize = 4;
/// What is left between bodies that were moved apart, metres.
const GAP_M: f64 = 5e-4;

/// The bodies of a scene. Those that rest on something are put at rest there, if that moves them little; the others are
/// to be fixed where they are.
pub fn settle(objects: &[Object], settings: &Settings) -> Vec<Settled> {
    let body = |object: &Object| Body::new(&object.mesh, &object.world_from_mesh, settings.parts, settings.density);
    let mut bodies: Vec<Settled> = objects
        .iter()
        .map(|object| Settled { body: body(object), is_free: false, moved_m: 0.0, turned_deg: 0.0, inside: Vec::new() })
        .collect();
    let reach = |settled: &Settled| {
        let points = || settled.body.points(settled.body.pose);
        let low = points().fold(DVec3::INFINITY, DVec3::min);
        let size = points().fold(DVec3::NEG_INFINITY, DVec3::max) - low;
        (low.z, size.x.max(size.y))
    };
    let widest = bodies.iter().map(|b| reach(b).1).filter(|x| x.is_finite()).fold(0.0, f64::max);
    let cell = CELL_M.max(widest / MOST_CELLS);
    // From below, so that what is on top finds what it stands on at its place.
    let mut order: Vec<usize> = (0..objects.len()).collect();
    order.sort_by(|a, b| reach(&bodies[*a]).0.total_cmp(&reach(&bodies[*b]).0));
    let mut done = vec![false; objects.len()];
    for &i in &order {
        done[i] = true;
        let below = match objects[i].on {
            On::Nothing => continue,
            On::Ground => None,
            On::Object(k) if k != i && done.get(k) == Some(&true) => Some(k),
            On::Object(_) => continue,
        };
        let surface = below.map(|k| bodies[k].body.columns(bodies[k].body.pose, cell));
        let Some((pose, angle)) = levelled(&bodies[i].body) else { continue };
        let Some(pose) = put_down(&bodies[i].body, pose, surface.as_deref(), cell) else { continue };
        let settled = &mut bodies[i];
        let center = settled.body.mass.center;
        let moved_m = (pose.apply(center) - settled.body.pose.apply(center)).length();
        let turned_deg = angle.to_degrees();
        if turned_deg <= settings.turn_deg && moved_m <= settings.move_m {
            *settled = Settled {
                body: Body { pose, ..settled.body.clone() },
                is_free: true,
                moved_m,
                turned_deg,
                ..settled.clone()
            };
        }
    }
    move_apart(&mut bodies, objects, settings, cell);
    let columns: Vec<_> = bodies.iter().map(|b| b.body.columns(b.body.pose, cell)).collect();
    for i in 0..bodies.len() {
        let is_inside = |k: &usize| *k != i && depth(&columns[i], &columns[*k]) > INSIDE_M;
        bodies[i].inside = (0..bodies.len()).filter(is_inside).collect();
    }
    bodies
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
    let holds = |k: usize| {
        let (sine, cosine) = libm::sincos(core::f64::consts::TAU * k as f64 / DIRECTIONS as f64);
        touched.iter().any(|p| p.x * cosine + p.y * sine > 2.0 * cell)
    };
    (0..DIRECTIONS).all(holds).then_some(pose)
}

/// The depth to which parts are inside of others.
fn depth(a: &[Columns], b: &[Columns]) -> f64 {
    a.iter().flat_map(|a| b.iter().map(|b| a.overlap(b))).fold(0.0, f64::max)
}

/// Moves free bodies on the ground that are partly inside of others aside: their sizes and places are not exact.
fn move_apart(bodies: &mut [Settled], objects: &[Object], settings: &Settings, cell: f64) {
    let carries = |i: usize| objects.iter().any(|o| o.on == On::Object(i));
    let may_move: Vec<bool> =
        (0..bodies.len()).map(|i| bodies[i].is_free && objects[i].on == On::Ground && !carries(i)).collect();
    for _ in 0..ROUNDS {
        let mut is_done = true;
        for i in 0..bodies.len() {
            for k in 0..i {
                let share = match (may_move[i], may_move[k]) {
                    (false, false) => continue,
                    (true, true) => [0.5, 0.5],
                    (true, false) => [1.0, 0.0],
                    (false, true) => [0.0, 1.0],
                };
                let columns = [i, k].map(|j| bodies[j].body.columns(bodies[j].body.pose, cell));
                let deep = depth(&columns[0], &columns[1]);
                let [a, b] = [i, k].map(|j| bodies[j].body.pose.apply(bodies[j].body.mass.center));
                let away = (a - b).with_z(0.0).normalize_or_zero();
                if deep <= 0.0 || away == DVec3::ZERO || deep > settings.move_m {
                    continue;
                }
                is_done = false;
                for (j, by) in [(i, share[0]), (k, -share[1])] {
                    let shift = away * (by * (deep + GAP_M));
                    bodies[j].body.pose.translation += shift;
                    bodies[j].moved_m += shift.length();
                }
            }
        }
        if is_done {
            break;
        }
    }
}
