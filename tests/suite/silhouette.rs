//! Mask metrics: hand-computed squares, and a boundary F written from its definition.

use sim3align::geometry::image::{Window, bounds_of};
use sim3align::metrics::silhouette::{self, boundary, boundary_tolerance_px, center_drift_px, iou};

use crate::prelude::*;

fn rectangle(size: [usize; 2], [u0, v0]: [usize; 2], [w, h]: [usize; 2]) -> Mask {
    let inside = |i: usize| (u0..u0 + w).contains(&(i % size[0])) && (v0..v0 + h).contains(&(i / size[0]));
    Mask::new("mask", size[0], size[1], (0..size[0] * size[1]).map(|i| if inside(i) { 255 } else { 0 }).collect())
        .unwrap()
}

const SIZE: [usize; 2] = [100, 100];

fn boundary_f(a: &Mask, b: &Mask) -> f64 {
    silhouette::boundary_f(a, b, boundary_tolerance_px(a.width(), a.height()))
}

#[wasm_bindgen_test(unsupported = test)]
fn equal_masks_agree_fully() {
    let mask = rectangle(SIZE, [20, 30], [20, 20]);
    assert_eq!((iou(&mask, &mask), boundary_f(&mask, &mask), center_drift_px(&mask, &mask)), (1.0, 1.0, Some(0.0)));
}

#[wasm_bindgen_test(unsupported = test)]
fn a_square_moved_by_a_quarter() {
    let (a, b) = (rectangle(SIZE, [20, 30], [20, 20]), rectangle(SIZE, [25, 30], [20, 20]));
    assert_eq!(iou(&a, &b), 300.0 / 500.0);
    assert_eq!(center_drift_px(&a, &b), Some(5.0));
    // The outline is a ring of 21 × 21 and 80 pixels, the tolerance ⌈0.008 · 141.4⌉ = 2. Of the top and of the
    // bottom side 18 pixels lie within 2 of the other ring's, of the far side its two outermost at each end.
    assert_eq!(boundary(&a).iter().filter(|set| **set).count(), 80);
    assert_eq!(boundary_f(&a, &b), 0.5);
    let diagonal = rectangle(SIZE, [23, 34], [20, 20]);
    assert_eq!((iou(&a, &diagonal), center_drift_px(&a, &diagonal)), (272.0 / 528.0, Some(5.0)));
    // Within the tolerance nothing is lost.
    assert_eq!(boundary_f(&a, &rectangle(SIZE, [22, 30], [20, 20])), 1.0);
}

#[wasm_bindgen_test(unsupported = test)]
fn the_tolerance_is_a_disk_not_a_square() {
    // A single pixel's outline is the 2 × 2 block up and left of it; moved by (3, 3), the blocks' nearest corners
    // are (2, 2) apart: beyond a disk of radius 2, within a square of that half width.
    let (a, b) = (rectangle(SIZE, [50, 50], [1, 1]), rectangle(SIZE, [53, 53], [1, 1]));
    assert_eq!(boundary_f(&a, &b), 0.0);
    // Moved by (3, 0) they are 2 apart, half of each block.
    assert_eq!(boundary_f(&a, &rectangle(SIZE, [53, 50], [1, 1])), 0.5);
}

#[wasm_bindgen_test(unsupported = test)]
fn without_overlap_nothing_flatters() {
    let a = rectangle(SIZE, [10, 10], [20, 20]);
    let (far, empty, full) =
        (rectangle(SIZE, [60, 10], [20, 20]), rectangle(SIZE, [0, 0], [0, 0]), rectangle(SIZE, [0, 0], SIZE));
    assert_eq!((iou(&a, &far), boundary_f(&a, &far), center_drift_px(&a, &far)), (0.0, 0.0, Some(50.0)));
    for other in [&a, &full, &empty] {
        for (x, y) in [(other, &empty), (&empty, other)] {
            assert_eq!((iou(x, y), boundary_f(x, y), center_drift_px(x, y)), (0.0, 0.0, None));
        }
    }
    // A mask that fills the image has no outline: nothing matches one, only its equal does.
    assert_eq!((boundary_f(&full, &a), boundary_f(&a, &full), boundary_f(&full, &full)), (0.0, 0.0, 1.0));
    assert_eq!(iou(&full, &a), 0.04);
}

/// From the definition: outlines by comparing shifted copies, matches by walking the disk.
fn boundary_f_slowly(a: &Mask, b: &Mask) -> f64 {
    let (w, h) = (a.width() as i64, a.height() as i64);
    let outline = |m: &Mask| {
        let at = |u: i64, v: i64| m.get(u.min(w - 1) as usize, v.min(h - 1) as usize).unwrap() != 0;
        let mut pixels = Vec::new();
        for v in 0..h {
            for u in 0..w {
                // Where there is no diagonal neighbour, the copy of the border stands in: it is one of the others.
                if at(u, v) != at(u + 1, v) || at(u, v) != at(u, v + 1) || at(u, v) != at(u + 1, v + 1) {
                    pixels.push((u, v));
                }
            }
        }
        pixels
    };
    let radius = (0.008 * f64::from((w * w + h * h) as u32).sqrt()).ceil() as i64;
    let (oa, ob) = (outline(a), outline(b));
    let share = |of: &[(i64, i64)], other: &[(i64, i64)]| {
        let near = |p: &(i64, i64), q: &(i64, i64)| (p.0 - q.0).pow(2) + (p.1 - q.1).pow(2) <= radius * radius;
        of.iter().filter(|p| other.iter().any(|q| near(p, q))).count() as f64 / of.len() as f64
    };
    let (precision, recall) = (share(&ob, &oa), share(&oa, &ob));
    if precision + recall == 0.0 { 0.0 } else { 2.0 * precision * recall / (precision + recall) }
}

#[wasm_bindgen_test(unsupported = test)]
fn boundary_f_equals_its_definition() {
    let mut partly = 0;
    for seed in 0..60 {
        let mut random = Random::new(seed, 916);
        let size = [60 + random.below(200), 60 + random.below(100)];
        let mut blob = || {
            let mut mask = Mask::filled(size[0], size[1], 0);
            for _ in 0..3 {
                // Disks, some beyond the border.
                let (cu, cv, r) =
                    (random.below(size[0]) as i64, random.below(size[1]) as i64, 5 + random.below(30) as i64);
                for (i, pixel) in mask.data_mut().iter_mut().enumerate() {
                    let (u, v) = ((i % size[0]) as i64, (i / size[0]) as i64);
                    *pixel |= u8::from((u - cu).pow(2) + (v - cv).pow(2) <= r * r);
                }
            }
            mask
        };
        let (a, b) = (blob(), blob());
        let f = boundary_f(&a, &b);
        assert_eq!(f, boundary_f_slowly(&a, &b), "seed {seed}");
        let parts = [&a, &b].map(|mask| Window::of_bounds(bounds_of(mask.data(), mask.width(), |m| *m != 0)));
        let window = parts[0].union(parts[1]).grown(1, [a.width(), a.height()]);
        let tolerance = boundary_tolerance_px(a.width(), a.height());
        let cropped = silhouette::boundary_f(&a.window(&window), &b.window(&window), tolerance);
        assert_eq!(f, cropped, "seed {seed}: in {window:?}");
        partly += usize::from(f > 0.0 && f < 1.0);
    }
    assert!(partly > 30, "only {partly} pairs were worth comparing");
}
