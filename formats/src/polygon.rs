//! The triangles of a polygon.

use glam::DVec3;

/// Comparisons of corners after which the polygons of a file are fans: their number may grow with the cube of that of the corners.
const MAX_COMPARISONS: usize = 1 << 24;

/// Relative to its area, by how much a polygon may be dented and still be a fan: corners on a line are off by rounding.
const FLAT: f64 = 1e-6;

/// Cuts polygons into triangles.
#[derive(Debug, Default)]
pub(crate) struct Polygon {
    /// The corners of the triangles of the last polygon, as places in it.
    pub triangles: Vec<[usize; 3]>,
    comparisons: usize,
}

impl Polygon {
    /// Cuts a polygon of `count` corners: a fan around the first one if all turn the same way, or if there are no `points`; else its
    /// ears, triangles with no corner inside, one by one.
    pub fn cut(&mut self, points: &[DVec3], count: usize) {
        self.triangles.clear();
        let mut ring: Vec<usize> = (0..count).collect();
        // Newell's normal, twice as long as the area.
        let next = |i: usize| points[(i + 1) % points.len()];
        let first = points.first().copied().unwrap_or_default();
        let normal: DVec3 = (0..points.len()).map(|i| (points[i] - first).cross(next(i) - first)).sum();
        let turn = |corners: [usize; 3]| turn(corners.map(|i| points[i]), normal);
        let corner = |ring: &[usize], i: usize| [i + ring.len() - 1, i, i + 1].map(|k| ring[k % ring.len()]);
        if !points.is_empty() && (0..count).any(|i| turn(corner(&ring, i)) < -FLAT) {
            while ring.len() > 3 {
                let ear = (0..ring.len()).find(|&i| {
                    let ear @ [a, b, c] = corner(&ring, i);
                    self.comparisons = self.comparisons.saturating_add(ring.len());
                    // On an edge, too, but for a corner that stands twice, as where a hole is joined to the outline.
                    let is_at = |p: usize| [a, b, c].iter().any(|own| points[*own] == points[p]);
                    let is_inside = |p: &usize| {
                        [[a, b, *p], [b, c, *p], [c, a, *p]].iter().all(|side| turn(*side) >= 0.0) && !is_at(*p)
                    };
                    self.comparisons < MAX_COMPARISONS && turn(ear) > 0.0 && !ring.iter().any(is_inside)
                });
                let Some(ear) = ear else { break };
                self.triangles.push(corner(&ring, ear));
                ring.remove(ear);
            }
        }
        if let Some((&first, rest)) = ring.split_first() {
            self.triangles.extend(rest.windows(2).map(|pair| [first, pair[0], pair[1]]));
        }
    }
}

/// By how much three corners turn to the left, seen along a normal, relative to its square.
#[inline(never)]
fn turn([a, b, c]: [DVec3; 3], normal: DVec3) -> f64 {
    (b - a).cross(c - b).dot(normal) / normal.length_squared().max(f64::MIN_POSITIVE)
}
