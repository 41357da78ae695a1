//! The lower and the upper surface of a convex part over a grid of the ground.

use glam::{DVec2, DVec3};

use super::part::ConvexPart;

/// For each cell of the grid, the heights at which a vertical line through its middle enters and leaves a part.
#[derive(Debug, Clone)]
pub struct Columns {
    /// Index of the first cell.
    from: [i64; 2],
    size: [usize; 2],
    cell: f64,
    /// Empty where the first number is larger.
    spans: Vec<[f64; 2]>,
}

impl Columns {
    /// Of a part in the frame of the world. All columns that are compared have the same cells.
    pub fn of(part: &ConvexPart, cell: f64) -> Self {
        let low = part.positions.iter().fold(DVec3::INFINITY, |a, b| a.min(*b));
        let high = part.positions.iter().fold(DVec3::NEG_INFINITY, |a, b| a.max(*b));
        let from = [low.x, low.y].map(|x| (x / cell).floor() as i64);
        let size = [0, 1].map(|i| ([high.x, high.y][i] / cell).floor() as i64 - from[i] + 1).map(|n| n.max(1) as usize);
        let mut spans = vec![[f64::INFINITY, f64::NEG_INFINITY]; size[0] * size[1]];
        for [a, b, c] in part.corners() {
            let (u, v) = (b - a, c - a);
            let normal = u.cross(v);
            if normal.z.abs() < 1e-18 {
                continue;
            }
            let range = |i: usize| {
                let at = |p: DVec3| (p.to_array()[i] / cell).floor() as i64 - from[i];
                at(a).min(at(b)).min(at(c)).max(0)..=at(a).max(at(b)).max(at(c)).min(size[i] as i64 - 1)
            };
            for y in range(1) {
                for x in range(0) {
                    let middle = DVec2::new((from[0] + x) as f64 + 0.5, (from[1] + y) as f64 + 0.5) * cell;
                    let p = middle - a.truncate();
                    let second = p.perp_dot(v.truncate()) / normal.z;
                    let third = u.truncate().perp_dot(p) / normal.z;
                    if second < 0.0 || third < 0.0 || second + third > 1.0 {
                        continue;
                    }
                    let z = a.z + second * u.z + third * v.z;
                    let span = &mut spans[y as usize * size[0] + x as usize];
                    *span = [span[0].min(z), span[1].max(z)];
                }
            }
        }
        Self { from, size, cell, spans }
    }

    /// The cells that are not empty: index, and span.
    pub fn cells(&self) -> impl Iterator<Item = ([i64; 2], [f64; 2])> + '_ {
        let place = |k: usize| [self.from[0] + (k % self.size[0]) as i64, self.from[1] + (k / self.size[0]) as i64];
        self.spans.iter().enumerate().filter(|(_, span)| span[0] <= span[1]).map(move |(k, span)| (place(k), *span))
    }

    /// The span of a cell.
    pub fn at(&self, cell: [i64; 2]) -> Option<[f64; 2]> {
        let [x, y] = [0, 1].map(|i| cell[i] - self.from[i]);
        if x < 0 || y < 0 || x as usize >= self.size[0] || y as usize >= self.size[1] {
            return None;
        }
        Some(self.spans[y as usize * self.size[0] + x as usize]).filter(|span| span[0] <= span[1])
    }

    /// How deep it is in another one once it is moved by some cells, metres: the least side of the box of what both share.
    pub fn overlap(&self, other: &Self, by: [i64; 2]) -> f64 {
        let is_beside = |i: usize| {
            let from = self.from[i] + by[i];
            from + self.size[i] as i64 <= other.from[i] || other.from[i] + other.size[i] as i64 <= from
        };
        if is_beside(0) || is_beside(1) {
            return 0.0;
        }
        let (mut low, mut high, mut depth) = ([i64::MAX; 2], [i64::MIN; 2], 0.0f64);
        for (cell, [a, b]) in self.cells() {
            let Some([c, d]) = other.at([0, 1].map(|i| cell[i] + by[i])) else { continue };
            let shared = b.min(d) - a.max(c);
            if shared <= 0.0 {
                continue;
            }
            depth = depth.max(shared);
            low = [0, 1].map(|i| low[i].min(cell[i]));
            high = [0, 1].map(|i| high[i].max(cell[i]));
        }
        let side = |i: usize| if low[i] > high[i] { 0.0 } else { (high[i] - low[i] + 1) as f64 * self.cell };
        depth.min(side(0)).min(side(1))
    }
}
