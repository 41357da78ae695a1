//! A heap: the tops of everything that stands somewhere, as heights over a plane, onto which objects are dropped.

use glam::{DVec2, DVec3};

use crate::draws::between;
use sim3align_geometry::random::Random;
use sim3align_geometry::rotations::exp;

/// Side of a cell and of the whole, metres.
const CELL: f64 = 0.004;
const SIDE: f64 = 2.4;
const CELLS: usize = (SIDE / CELL) as usize;
/// Distance between an object and what it is dropped on: cells are not points.
const CLEARANCE: f64 = 0.0003;
/// Tries of the descent, and the largest turn and shift of the first one, radians and metres.
const TRIES: usize = 60;
const TURN: f64 = 0.35;
const SHIFT: f64 = 0.02;

/// What an object rests on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Below {
    /// The table, the desk or the floor.
    Table,
    /// A board over it.
    Board,
    /// The object with this index.
    Object(usize),
    /// Nothing.
    Air,
}

/// The highest point over each cell of the plane z = 0.
#[derive(Debug)]
pub struct Heap {
    tops: Vec<(f64, Below)>,
}

/// The triangles of an object, and its points relative to its centre.
#[derive(Debug, Clone, Copy)]
pub struct Shape<'a> {
    /// The points.
    pub points: &'a [DVec3],
    /// The triangles.
    pub triangles: &'a [[u32; 3]],
}

impl Default for Heap {
    fn default() -> Self {
        Self { tops: vec![(0.0, Below::Table); CELLS * CELLS] }
    }
}

impl Heap {
    /// Puts an object where it is.
    pub fn put(&mut self, shape: Shape<'_>, below: Below) {
        cover(shape, |cell, z| {
            if let Some(top) = self.tops.get_mut(cell)
                && z > top.0
            {
                *top = (z, below);
            }
        });
    }

    /// How far an object must be moved up to touch what is below it, and what that is.
    pub fn drop(&self, shape: Shape<'_>) -> (f64, Below) {
        let mut best = (f64::NEG_INFINITY, Below::Table);
        cover(shape, |cell, z| {
            if let Some((top, below)) = self.tops.get(cell) {
                let clearance = if *below == Below::Table { 0.0 } else { CLEARANCE };
                if top + clearance - z > best.0 {
                    best = (top + clearance - z, *below);
                }
            }
        });
        best
    }

    /// Drops an object, and lets it tumble to where its centre is lower. Returns its points and what it rests on.
    pub fn settle(&self, shape: Shape<'_>, random: &mut Random) -> (Vec<DVec3>, glam::DQuat, Below) {
        let lifted = |points: &[DVec3]| {
            let (lift, below) = self.drop(Shape { points, ..shape });
            (lift, below, points.iter().map(|p| *p + DVec3::Z * lift).collect::<Vec<_>>())
        };
        let (mut lift, mut below, mut best) = lifted(shape.points);
        let mut turned = glam::DQuat::IDENTITY;
        for k in 0..TRIES {
            let size = 1.0 - k as f64 / TRIES as f64;
            let mut draw = |most: f64| between(random, -most, most) * size;
            let turn = exp(DVec3::new(draw(TURN), draw(TURN), draw(TURN)));
            let shift = DVec2::new(draw(SHIFT), draw(SHIFT)).extend(0.0);
            let center = mean(&best);
            let tried: Vec<DVec3> = best.iter().map(|p| turn * (*p - center) + center + shift).collect();
            let next = lifted(&tried);
            if mean(&next.2).z < mean(&best).z {
                (lift, below, best) = next;
                turned = (turn * turned).normalize();
            }
        }
        debug_assert!(lift.is_finite());
        (best, turned, below)
    }
}

fn mean(points: &[DVec3]) -> DVec3 {
    points.iter().sum::<DVec3>() / points.len().max(1) as f64
}

/// Visits the cells that the triangles and the vertices of an object cover, with the height there.
fn cover(shape: Shape<'_>, mut visit: impl FnMut(usize, f64)) {
    let at = |p: DVec3| (p.truncate() + DVec2::splat(0.5 * SIDE)) / CELL;
    let cell = |x: f64, y: f64| {
        let is_inside = |v: f64| v >= 0.0 && v < CELLS as f64;
        (is_inside(x) && is_inside(y)).then_some(y as usize * CELLS + x as usize)
    };
    for p in shape.points {
        let q = at(*p);
        if let Some(cell) = cell(q.x, q.y) {
            visit(cell, p.z);
        }
    }
    for triangle in shape.triangles {
        let [a, b, c] = triangle.map(|i| shape.points[i as usize]);
        let [p, q, r] = [at(a), at(b), at(c)];
        let area = (q - p).perp_dot(r - p);
        if area == 0.0 {
            continue;
        }
        let (low, high) = (p.min(q).min(r).floor(), p.max(q).max(r));
        let mut y = low.y + 0.5;
        while y <= high.y {
            let mut x = low.x + 0.5;
            while x <= high.x {
                let s = DVec2::new(x, y);
                let weights = [(r - q).perp_dot(s - q), (p - r).perp_dot(s - r), (q - p).perp_dot(s - p)];
                let weights = weights.map(|w| w / area);
                if weights.iter().all(|w| *w >= 0.0)
                    && let Some(cell) = cell(x, y)
                {
                    visit(cell, weights[0] * a.z + weights[1] * b.z + weights[2] * c.z);
                }
                x += 1.0;
            }
            y += 1.0;
        }
    }
}
