//! Metrics of a pose, on observations rendered from known ones, and the metrics of masks against their definition.

use sim3align::evidence::clouds::Sampling;
use sim3align::metrics::silhouette::{boundary_f, boundary_tolerance_px};
use sim3align::metrics::{Metrics, evaluate};

use crate::prelude::*;
use crate::shapes::{rendered, with_depth};

const WIDTH: usize = 160;
const HEIGHT: usize = 120;

fn pose() -> Similarity {
    similarity(0.15, [0.4, -0.7, 0.2], [0.02, -0.01, 0.8])
}

fn camera() -> Pinhole {
    Pinhole::new(200.0, 210.0, 80.0, 58.0).unwrap()
}

/// The image of the posed mesh, its depths moved by `offset` metres.
fn observe(mesh: &Mesh, offset: f32) -> Observation {
    rendered(mesh, &pose(), camera(), [WIDTH, HEIGHT], |z| if z > 0.0 { z + offset } else { 2.0 })
}

fn score(observation: &Observation, mesh: &Mesh, pose: &Similarity) -> Metrics {
    evaluate(observation, mesh, pose, &Sampling::default()).unwrap()
}

#[wasm_bindgen_test]
fn the_true_pose_is_perfect() {
    let egg = mapped(&ellipsoid(Vec3::new(0.5, 0.8, 1.0), 48), |p| p + Vec3::new(3.0, -2.0, 1.0) * 0.1);
    for (name, mesh, consistency) in [("egg", egg, 0.995), ("box", cuboid(Vec3::new(1.0, 0.7, 0.5)), 0.96)] {
        let m = score(&observe(&mesh, 0.0), &mesh, &pose());
        assert_eq!((m.iou, m.boundary_f, m.center_drift_px), (Some(1.0), Some(1.0), Some(0.0)), "{name}");
        assert_eq!((m.depth_mae_m, m.fitness), (Some(0.0), Some(1.0)), "{name}");
        assert!(m.uni_chamfer_m.unwrap() < 1e-6, "{name}: {m:?}");
        assert!(m.normal_consistency.unwrap() > consistency, "{name}: {m:?}");
        // The far side is not seen: the two-sided distance cannot vanish.
        assert!(m.chamfer_m.unwrap() > 0.005, "{name}: {m:?}");
    }
}

#[wasm_bindgen_test]
fn means_over_a_sample_are_those_over_all_points() {
    // A noisy sensor, a true and a wrong pose: outliers at the outline count as they do in the full means.
    let mesh = mapped(&ellipsoid(Vec3::new(0.5, 0.8, 1.0), 48), |p| p + Vec3::new(3.0, -2.0, 1.0) * 0.1);
    let camera = Pinhole::new(800.0, 840.0, 320.0, 232.0).unwrap();
    let clean = rendered(&mesh, &pose(), camera, [4 * WIDTH, 4 * HEIGHT], |z| if z > 0.0 { z } else { 2.0 });
    let random = core::cell::RefCell::new(Random::new(3, 77));
    let noisy = with_depth(&clean, |_, z| z + 0.004 * (random.borrow_mut().uniform() as f32 - 0.5)).unwrap();
    let wrong = Similarity { translation: pose().translation + Vector3::new(0.004, -0.003, 0.006), ..pose() };
    for (name, pose) in [("true", pose()), ("wrong", wrong)] {
        let of = |measured| evaluate(&noisy, &mesh, &pose, &Sampling { measured, ..Sampling::default() }).unwrap();
        let (some, all) = (of(Sampling::default().measured), of(usize::MAX));
        for (what, metric) in [
            ("chamfer", (|m: &Metrics| m.chamfer_m) as fn(&Metrics) -> Option<f64>),
            ("uni_chamfer", |m| m.uni_chamfer_m),
            ("fitness", |m| m.fitness),
            ("normals", |m| m.normal_consistency),
        ] {
            let ratio = metric(&some).unwrap() / metric(&all).unwrap();
            assert!((ratio - 1.0).abs() < 0.005, "{name}, {what}: {ratio}");
        }
    }
}

#[wasm_bindgen_test]
fn a_pose_out_of_sight_gives_null_or_zero() {
    let mesh = sphere(0.5, 16);
    let observation = observe(&mesh, 0.0);
    let at = |x: f64, z: f64| Similarity { translation: Vector3::new(x, 0.0, z), ..pose() };
    let behind = score(&observation, &mesh, &at(0.0, -0.8));
    assert_eq!((behind.iou, behind.boundary_f), (Some(0.0), Some(0.0)));
    assert_eq!((behind.center_drift_px, behind.depth_mae_m, behind.fitness), (None, None, Some(0.0)));
    assert!(behind.uni_chamfer_m.unwrap() > 1.0);
    let json = serde_json::to_value(behind).unwrap();
    assert!(json["centerDriftPx"].is_null() && json["depthMaeM"].is_null(), "{json}");
    assert!(score(&observation, &mesh, &at(0.25, 0.8)).center_drift_px.unwrap() > 40.0);
}

#[wasm_bindgen_test]
fn only_readings_inside_the_mask_count() {
    let mesh = sphere(0.5, 32);
    let full = observe(&mesh, 0.0);
    // A hole in the depth and a wrong reading outside the mask change nothing in the error.
    let middle = (HEIGHT / 2) * WIDTH + WIDTH / 2;
    let holed = with_depth(&full, |i, z| if i == 0 { 0.1 } else { z * f32::from(u8::from(i != middle)) });
    assert_eq!(score(&holed.unwrap(), &mesh, &pose()).depth_mae_m, Some(0.0));
    // A mask with half of the object: what is rendered beyond it has no say.
    let mut mask = full.mask().clone();
    mask.data_mut().iter_mut().enumerate().for_each(|(i, m)| *m *= u8::from(i % WIDTH < WIDTH / 2));
    let half = score(&Observation::new(full.depth().clone(), mask, full.camera()).unwrap(), &mesh, &pose());
    assert_eq!((half.depth_mae_m, half.fitness), (Some(0.0), Some(1.0)));
    assert!((0.3..0.6).contains(&half.iou.unwrap()), "{half:?}");
}

/// From the definition: outlines by comparing shifted copies, matches by walking the disk.
fn boundary_f_slowly(a: &Mask, b: &Mask) -> f64 {
    let (w, h) = (a.width() as i64, a.height() as i64);
    let outline = |m: &Mask| {
        let at = |u: i64, v: i64| m.get(u.min(w - 1) as usize, v.min(h - 1) as usize).unwrap() != 0;
        // Where there is no diagonal neighbour, the copy of the border stands in: it is one of the others.
        let differs = |&(u, v): &(i64, i64)| [(1, 0), (0, 1), (1, 1)].iter().any(|(x, y)| at(u, v) != at(u + x, v + y));
        (0..w * h).map(|i| (i % w, i / w)).filter(differs).collect::<Vec<_>>()
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

#[wasm_bindgen_test]
fn boundary_f_equals_its_definition() {
    let mut partly = 0;
    for seed in 0..30 {
        let mut random = Random::new(seed, 916);
        let size = [60 + random.below(200), 60 + random.below(100)];
        let mut blob = || {
            let mut mask = Mask::filled(size[0], size[1], 0);
            for _ in 0..3 {
                // Disks, some beyond the border.
                let [cu, cv, r] =
                    [random.below(size[0]), random.below(size[1]), 5 + random.below(30)].map(|x| x as i64);
                for (i, pixel) in mask.data_mut().iter_mut().enumerate() {
                    let (u, v) = ((i % size[0]) as i64, (i / size[0]) as i64);
                    *pixel |= u8::from((u - cu).pow(2) + (v - cv).pow(2) <= r * r);
                }
            }
            mask
        };
        let (a, b) = (blob(), blob());
        let f = boundary_f(&a, &b, boundary_tolerance_px(size[0], size[1]));
        assert_eq!(f, boundary_f_slowly(&a, &b), "seed {seed}");
        partly += usize::from(f > 0.0 && f < 1.0);
    }
    assert!(partly > 15, "only {partly} pairs were worth comparing");
}
