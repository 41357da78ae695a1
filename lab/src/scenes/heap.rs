//! A heap: the tops of everything that stands somewhere, as heights over a plane, onto which objects are dropped.

use crate::cases::distortion::with_vertices;
use crate::prelude::*;
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

impl Default for Heap {
    fn default() -> Self {
        Self { tops: vec![(0.0, Below::Table); CELLS * CELLS] }
    }
}

impl Heap {
    /// Puts an object where it is.
    pub fn put(&mut self, mesh: &Mesh, below: Below) {
        cover(&points_of(mesh), mesh.triangles(), |cell, z| {
            if let Some(top) = self.tops.get_mut(cell)
                && z > top.0
            {
                *top = (z, below);
            }
        });
    }

    /// How far an object must be moved up to touch what is below it, and what that is.
    pub fn drop(&self, mesh: &Mesh) -> (f64, Below) {
        self.lift_of(&points_of(mesh), mesh.triangles())
    }

    fn lift_of(&self, points: &[DVec3], triangles: &[[u32; 3]]) -> (f64, Below) {
        let mut best = (f64::NEG_INFINITY, Below::Table);
        cover(points, triangles, |cell, z| {
            if let Some((top, below)) = self.tops.get(cell) {
                let clearance = if *below == Below::Table { 0.0 } else { CLEARANCE };
                if top + clearance - z > best.0 {
                    best = (top + clearance - z, *below);
                }
            }
        });
        best
    }

    /// Drops an object, and lets it tumble to where its centre is lower. Also returns how it has turned, and what it
    /// rests on.
    pub fn settle(&self, mesh: &Mesh, random: &mut Random) -> Result<(Mesh, DQuat, Below)> {
        let dropped = |points: Vec<DVec3>| {
            let (lift, below) = self.lift_of(&points, mesh.triangles());
            let points: Vec<DVec3> = points.iter().map(|p| *p + DVec3::Z * lift).collect();
            (below, mean(&points), points)
        };
        let (mut below, mut center, mut best) = dropped(points_of(mesh));
        let mut turned = DQuat::IDENTITY;
        for k in 0..TRIES {
            let size = 1.0 - k as f64 / TRIES as f64;
            let mut draw = |most: f64| between(random, -most, most) * size;
            let turn = exp(DVec3::new(draw(TURN), draw(TURN), draw(TURN)));
            let shift = DVec2::new(draw(SHIFT), draw(SHIFT)).extend(0.0);
            let next = dropped(best.iter().map(|p| turn * (*p - center) + center + shift).collect());
            if next.1.z < center.z {
                (below, center, best) = next;
                turned = (turn * turned).normalize();
            }
        }
        Ok((with_vertices(mesh, best.iter().map(|p| p.as_vec3()))?, turned, below))
    }
}

fn points_of(mesh: &Mesh) -> Vec<DVec3> {
    mesh.positions().iter().map(|p| p.as_dvec3()).collect()
}

fn mean(points: &[DVec3]) -> DVec3 {
    points.iter().sum::<DVec3>() / points.len().max(1) as f64
}

/// Visits the cells that the vertices and the triangles of an object cover, with the height there.
fn cover(points: &[DVec3], triangles: &[[u32; 3]], mut visit: impl FnMut(usize, f64)) {
    let at = |p: DVec3| (p.truncate() + DVec2::splat(0.5 * SIDE)) / CELL;
    let cell = |x: f64, y: f64| {
        let is_inside = |v: f64| v >= 0.0 && v < CELLS as f64;
        (is_inside(x) && is_inside(y)).then_some(y as usize * CELLS + x as usize)
    };
    for p in points {
        let q = at(*p);
        if let Some(cell) = cell(q.x, q.y) {
            visit(cell, p.z);
        }
    }
    for triangle in triangles {
        let [a, b, c] = triangle.map(|i| points[i as usize]);
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
