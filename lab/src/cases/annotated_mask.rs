//! Masks of annotators: polygons whose corners are right within about a pixel.

use std::collections::BTreeMap;

use super::mask::Outline;
use super::scene::Scene;
use super::tier::Tier;
use crate::prelude::*;

/// Least area of an outline that is drawn at all, pixels of an image 640 wide.
const LEAST_AREA: f64 = 12.0;

/// The outline of an annotator; `resolution` is the size of the pixels that they see, 1 for an image 640 wide.
pub fn annotated(scene: &Scene, tier: Tier, resolution: f64, random: &mut Random) -> Outline {
    // Corners are as dense as the shape needs for the annotator's patience.
    let tolerance = resolution * between(random, 0.6, 1.0) * tier.pick(0.8, 1.3, 1.8);
    let error = resolution * between(random, 0.6, 1.0) * tier.pick(0.6, 1.0, 1.4);
    let bias = resolution * tier.pick(0.2, 0.3, 0.4) * normal(random).clamp(-2.0, 2.0);
    let mut polygons = Vec::new();
    for contour in contours(&scene.visible, scene.width) {
        if area(&contour).abs() < LEAST_AREA * resolution * resolution {
            continue;
        }
        let corners = simplified(&contour, tolerance);
        let count = corners.len();
        let moved = (0..count).map(|i| {
            let along = (corners[(i + 1) % count] - corners[(i + count - 1) % count]).normalize_or_zero();
            // Contours have the inside on their right, where y is down.
            let outwards = DVec2::new(along.y, -along.x);
            let drawn = corners[i] + outwards * bias + error * DVec2::new(normal(random), normal(random));
            // What the image's border cuts is drawn beyond it.
            let beyond = |from: f64, to: f64, last: f64| match from {
                x if x < 0.0 => x - 2.0,
                x if x > last => x + 2.0,
                _ => to,
            };
            let last = [scene.width, scene.height].map(|side| side as f64 - 1.0);
            DVec2::new(beyond(corners[i].x, drawn.x, last[0]), beyond(corners[i].y, drawn.y, last[1]))
        });
        polygons.push(moved.collect());
    }
    Outline { inside: filled(&polygons, scene.width, scene.height), offset_px: bias, kind: "annotated-mask" }
}

/// Closed contours between set pixels and others: the middles of the pixels' edges, in pixels. Islands and holes.
fn contours(set: &[bool], width: usize) -> Vec<Vec<DVec2>> {
    let height = set.len() / width;
    let is_set = |x: isize, y: isize| {
        x >= 0 && y >= 0 && x < width as isize && y < height as isize && set[y as usize * width + x as usize]
    };
    // Edges by their first corner, with set pixels on their right.
    let mut edges: BTreeMap<[isize; 2], Vec<[isize; 2]>> = BTreeMap::new();
    for (i, _) in set.iter().enumerate().filter(|(_, set)| **set) {
        let [x, y] = [(i % width) as isize, (i / width) as isize];
        let sides = [
            ([x, y - 1], [x, y], [x + 1, y]),
            ([x + 1, y], [x + 1, y], [x + 1, y + 1]),
            ([x, y + 1], [x + 1, y + 1], [x, y + 1]),
            ([x - 1, y], [x, y + 1], [x, y]),
        ];
        for ([u, v], from, to) in sides {
            if !is_set(u, v) {
                edges.entry(from).or_default().push(to);
            }
        }
    }
    let mut contours = Vec::new();
    while let Some(start) = edges.keys().next().copied() {
        let (mut contour, mut at) = (Vec::new(), start);
        while let Some(ends) = edges.get_mut(&at) {
            let Some(next) = ends.pop() else { break };
            if ends.is_empty() {
                edges.remove(&at);
            }
            let middle = |axis: usize| 0.5 * (at[axis] + next[axis]) as f64 - 0.5;
            contour.push(DVec2::new(middle(0), middle(1)));
            at = next;
        }
        contours.push(contour);
    }
    contours
}

/// Signed area of a closed polygon.
fn area(polygon: &[DVec2]) -> f64 {
    let next = polygon.iter().cycle().skip(1);
    0.5 * polygon.iter().zip(next).map(|(a, b)| a.perp_dot(*b)).sum::<f64>()
}

/// A closed polygon with as few of its points as stay within a distance (Ramer-Douglas-Peucker).
fn simplified(polygon: &[DVec2], tolerance: f64) -> Vec<DVec2> {
    let count = polygon.len();
    let apart = |i: &usize| polygon[*i].distance_squared(polygon[0]);
    let farthest = (0..count).max_by(|a, b| apart(a).total_cmp(&apart(b))).unwrap_or_default();
    let mut kept = vec![false; count];
    (kept[0], kept[farthest]) = (true, true);
    let mut open = vec![[0, farthest], [farthest, count]];
    while let Some([from, to]) = open.pop() {
        let (a, b) = (polygon[from], polygon[to % count]);
        let along = (b - a).normalize_or_zero();
        let off = |i: &usize| {
            let beside = polygon[*i] - a;
            if along == DVec2::ZERO { beside.length() } else { beside.perp_dot(along).abs() }
        };
        let Some(worst) = (from + 1..to).max_by(|a, b| off(a).total_cmp(&off(b))) else { continue };
        if off(&worst) > tolerance {
            kept[worst] = true;
            open.extend([[from, worst], [worst, to]]);
        }
    }
    polygon.iter().zip(kept).filter(|(_, kept)| *kept).map(|(point, _)| *point).collect()
}

/// The pixels whose centres are inside an odd number of polygons.
fn filled(polygons: &[Vec<DVec2>], width: usize, height: usize) -> Vec<bool> {
    let mut crossings: Vec<Vec<f64>> = vec![Vec::new(); height];
    for polygon in polygons {
        for (a, b) in polygon.iter().zip(polygon.iter().cycle().skip(1)) {
            let (low, high) = if a.y <= b.y { (a, b) } else { (b, a) };
            // Rows from low.y on, below high.y.
            let [first, end] = [low.y, high.y].map(|y| y.ceil().clamp(0.0, height as f64) as usize);
            for (y, row) in crossings.iter_mut().enumerate().take(end).skip(first) {
                let share = (y as f64 - low.y) / (high.y - low.y);
                row.push(low.x + share * (high.x - low.x));
            }
        }
    }
    let mut inside = vec![false; width * height];
    for (row, crossings) in inside.chunks_mut(width).zip(&mut crossings) {
        crossings.sort_unstable_by(f64::total_cmp);
        for pair in crossings.chunks_exact(2) {
            let [first, end] = [pair[0], pair[1]].map(|x| x.ceil().clamp(0.0, width as f64) as usize);
            row[first..end.max(first)].fill(true);
        }
    }
    inside
}
