//! Bodies of a scene, at poses that they keep.

use glam::DVec3;
use sim3align_geometry::mesh::Mesh;
use sim3align_geometry::similarity::Similarity;

use super::apart::{ASIDE_M, INSIDE_M, depth, steps_apart};
use super::body::{Body, Pose};
use super::columns::Columns;
use super::ground::{AGREE_M, agreed_height};
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

/// How bodies are made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Kilograms per cubic metre.
    pub density: f64,
    /// Most convex parts of a body.
    pub parts: usize,
    /// Largest angle by which a body is turned so that it rests, degrees.
    pub turn_deg: f64,
    /// Largest distance of its centre of mass from where it was found, metres.
    pub move_m: f64,
    /// Whether the ground was found, and not given: its height is then fitted to the bodies that stand on it.
    pub fits_ground: bool,
    /// Whether bodies are moved at all. Otherwise they keep their poses, and those that would come to rest nearby are free.
    pub rest: bool,
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
    /// How far its centre of mass is from where it was found, metres.
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

/// The bodies of a scene, and the height above the ground of the plane z = 0 of their poses: those of the bodies are above
/// the ground.
///
/// Bodies that rest on something are put at rest there, if that moves them little; the others are to be fixed where they are.
/// A ground that was found is first moved to the height that most of the bodies on it agree on: they are then moved the
/// least. A body that disagrees is fixed.
pub fn settle(objects: &[Object], settings: &Settings) -> (Vec<Settled>, f64) {
    let mut bodies: Vec<Settled> = objects
        .iter()
        .map(|Object { mesh, world_from_mesh, .. }| {
            let body = Body::new(mesh, world_from_mesh, settings.parts, settings.density);
            Settled { found: body.pose, body, is_free: false, moved_m: 0.0, turned_deg: 0.0, inside: Vec::new() }
        })
        .collect();
    let fits_ground = settings.fits_ground && settings.rest;
    let mut lift = 0.0;
    if fits_ground {
        let mut lowest = Vec::new();
        for (Settled { body, .. }, object) in bodies.iter().zip(objects) {
            if let (On::Ground, Some((pose, angle))) = (object.on, levelled(body)) {
                let height = body.pose.apply(body.mass.center).z - pose.apply(body.mass.center).z;
                if angle.to_degrees() <= settings.turn_deg && height.is_finite() {
                    lowest.push(height);
                }
            }
        }
        lift = -agreed_height(&lowest, settings.move_m).unwrap_or(0.0);
        for settled in &mut bodies {
            settled.found.translation.z += lift;
            settled.body.pose = settled.found;
        }
    }
    // How far a body may be moved.
    let most = |i: usize| {
        let is_fitted = fits_ground && objects[i].on == On::Ground;
        if is_fitted { AGREE_M.min(settings.move_m) } else { settings.move_m }
    };
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
        let (moved_m, turned_deg) = (distance(settled, pose), angle.to_degrees());
        settled.is_free = turned_deg <= settings.turn_deg && moved_m <= most(i);
        if settled.is_free && settings.rest {
            settled.body.pose = pose;
            settled.turned_deg = turned_deg;
        }
    }
    let mut columns: Vec<_> = bodies.iter().map(|b| b.body.columns(b.body.pose, cell)).collect();
    // What stands on another body, or carries one, keeps its place on it.
    let carries = |i: usize| objects.iter().any(|o| o.on == On::Object(i));
    let may_move = |i: usize| settings.rest && bodies[i].is_free && objects[i].on == On::Ground && !carries(i);
    // Rest moves bodies up and down only: what is left of the distance is the other leg of a right angle.
    let left = |i: usize| (most(i).powi(2) - distance(&bodies[i], bodies[i].body.pose).powi(2)).max(0.0).sqrt();
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
        bodies[i].moved_m = distance(&bodies[i], bodies[i].body.pose);
    }
    (bodies, lift)
}

/// How far the centre of mass is at a pose from where it was found, metres.
fn distance(Settled { body, found, .. }: &Settled, pose: Pose) -> f64 {
    (pose.apply(body.mass.center) - found.apply(body.mass.center)).length()
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
