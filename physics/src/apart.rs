//! Bodies that stand side by side are moved out of each other: their sizes and places are not exact.

use super::columns::Columns;

/// Depth up to which bodies may be inside of each other, metres: physics parts them.
pub const INSIDE_M: f64 = 2e-3;
/// Largest distance by which a body is moved aside, metres. An overlap that takes more is an error of a shape or of a pose,
/// which a move of right poses would only spread.
pub const ASIDE_M: f64 = 3e-3;
/// Rounds over all pairs: a move can make room for another one.
const ROUNDS: usize = 4;

/// A step or a place on the grid of the columns, in cells.
type Cells = [i64; 2];

/// Penetration depth of bodies, metres.
pub fn depth(a: &[Columns], b: &[Columns]) -> f64 {
    depth_by(a, b, [0, 0])
}

/// The same once the first is moved by some cells.
fn depth_by(a: &[Columns], b: &[Columns], by: Cells) -> f64 {
    let mut most: f64 = 0.0;
    for a in a {
        for b in b {
            most = most.max(a.overlap(b, by));
        }
    }
    most
}

/// Bodies on the grid, each at a place.
struct Grid<'a> {
    bodies: &'a [Vec<Columns>],
    /// The largest shift of each body, in cells.
    reach: Vec<f64>,
    places: Vec<Cells>,
}

/// For each body, by how many cells to move it so that fewer of them are inside of each other. A body moves by at most its
/// reach, in metres. Only moves that part a pair, and bring no other pair deeper into each other, are made.
pub fn steps_apart(bodies: &[Vec<Columns>], reach_m: &[f64], cell: f64) -> Vec<Cells> {
    let reach: Vec<f64> = reach_m.iter().map(|reach| reach / cell).collect();
    let mut grid = Grid { bodies, places: vec![[0, 0]; bodies.len()], reach };
    for _ in 0..ROUNDS {
        let mut has_moved = false;
        for i in 0..bodies.len() {
            for k in 0..i {
                has_moved |= grid.part(i, k);
            }
        }
        if !has_moved {
            break;
        }
    }
    grid.places
}

impl Grid<'_> {
    /// Penetration depth of two bodies at these places.
    fn depth(&self, (i, at): (usize, Cells), (k, other): (usize, Cells)) -> f64 {
        depth_by(&self.bodies[i], &self.bodies[k], [at[0] - other[0], at[1] - other[1]])
    }

    /// Moves two bodies apart by the shortest step that does: apart if that is possible, otherwise as close as physics takes
    /// them. Returns whether they were moved.
    fn part(&mut self, i: usize, k: usize) -> bool {
        let far = (self.reach[i] + self.reach[k]) as i64;
        let deep = self.depth((i, self.places[i]), (k, self.places[k]));
        for enough in [0.0, INSIDE_M] {
            if far == 0 || deep <= enough {
                return false;
            }
            for square in 1..=far * far {
                for x in -far..=far {
                    for y in -far..=far {
                        if x * x + y * y == square && self.step_apart(i, k, [x, y], enough) {
                            return true;
                        }
                    }
                }
            }
        }
        false
    }

    /// Moves two bodies apart by a step if that parts them: half of it each, or all of it where only one may move.
    fn step_apart(&mut self, i: usize, k: usize, step: Cells, enough: f64) -> bool {
        let (mut a, mut b) = (self.places[i], self.places[k]);
        for n in [0, 1] {
            let first = match (self.reach[i] > 0.0, self.reach[k] > 0.0) {
                (true, true) => step[n] - step[n] / 2,
                (true, false) => step[n],
                _ => 0,
            };
            a[n] += first;
            b[n] -= step[n] - first;
        }
        let is_within = |[x, y]: Cells, reach: f64| (x * x + y * y) as f64 <= reach * reach;
        if !is_within(a, self.reach[i]) || !is_within(b, self.reach[k]) || self.depth((i, a), (k, b)) > enough {
            return false;
        }
        for (moved, to) in [(i, a), (k, b)] {
            for j in 0..self.bodies.len() {
                let other = (j, self.places[j]);
                let now = if j == i || j == k { 0.0 } else { self.depth((moved, to), other) };
                if now > 0.0 && now > self.depth((moved, self.places[moved]), other) {
                    return false;
                }
            }
        }
        (self.places[i], self.places[k]) = (a, b);
        true
    }
}
