//! All metrics of a pose, on observations rendered from known ones.

use sim3align::evidence::clouds::Sampling;
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

/// What the camera sees of the posed mesh, its depths moved by `offset` metres.
fn observe(mesh: &Mesh, offset: f32) -> Observation {
    rendered(mesh, &pose(), camera(), [WIDTH, HEIGHT], |z| if z > 0.0 { z + offset } else { 2.0 })
}

fn score(observation: &Observation, mesh: &Mesh, pose: &Similarity) -> Metrics {
    evaluate(observation, mesh, pose, &Sampling::default()).unwrap()
}

#[wasm_bindgen_test(unsupported = test)]
fn the_true_pose_is_perfect() {
    let egg = mapped(&ellipsoid(Vec3::new(0.5, 0.8, 1.0), 48), |p| p + Vec3::new(3.0, -2.0, 1.0) * 0.1);
    for (name, mesh, consistency) in [("egg", egg, 0.995), ("box", cuboid(Vec3::new(1.0, 0.7, 0.5)), 0.96)] {
        let m = score(&observe(&mesh, 0.0), &mesh, &pose());
        assert_eq!((m.iou, m.boundary_f, m.center_drift_px), (Some(1.0), Some(1.0), Some(0.0)), "{name}");
        assert_eq!((m.depth_mae_mm, m.fitness), (Some(0.0), Some(1.0)), "{name}");
        assert!(m.uni_chamfer_mm.unwrap() < 1e-3, "{name}: {m:?}");
        assert!(m.normal_consistency.unwrap() > consistency, "{name}: {m:?}");
        // The far side is not seen: the two-sided distance cannot vanish.
        assert!(m.chamfer_mm.unwrap() > 5.0, "{name}: {m:?}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn depth_that_is_off_by_five_millimetres() {
    let mesh = sphere(0.5, 64);
    let m = score(&observe(&mesh, 0.005), &mesh, &pose());
    assert!((m.depth_mae_mm.unwrap() - 5.0).abs() < 1e-3, "{m:?}");
    assert_eq!(m.iou, Some(1.0));
    // Along the ray; the distance to a sphere is shorter where it is slanted, but not on average by half.
    assert!((2.5..5.0).contains(&m.uni_chamfer_mm.unwrap()), "{m:?}");
    // 5 % of the box diagonal of half a sphere of radius 75 mm are 11 mm.
    assert_eq!(m.fitness, Some(1.0));
}

#[wasm_bindgen_test(unsupported = test)]
fn a_pose_out_of_sight_gives_null_or_zero() {
    let mesh = sphere(0.5, 16);
    let observation = observe(&mesh, 0.0);
    let at = |x: f64, z: f64| Similarity { translation: Vector3::new(x, 0.0, z), ..pose() };
    let behind = score(&observation, &mesh, &at(0.0, -0.8));
    assert_eq!((behind.iou, behind.boundary_f), (Some(0.0), Some(0.0)));
    assert_eq!((behind.center_drift_px, behind.depth_mae_mm, behind.fitness), (None, None, Some(0.0)));
    assert!(behind.uni_chamfer_mm.unwrap() > 1000.0);
    let json = serde_json::to_value(behind).unwrap();
    assert!(json["centerDriftPx"].is_null() && json["depthMaeMm"].is_null(), "{json}");

    let beside = score(&observation, &mesh, &at(0.25, 0.8));
    assert_eq!((beside.iou, beside.boundary_f, beside.depth_mae_mm), (Some(0.0), Some(0.0), None));
    assert!(beside.center_drift_px.unwrap() > 40.0);
}

#[wasm_bindgen_test(unsupported = test)]
fn only_readings_inside_the_mask_count() {
    let mesh = sphere(0.5, 32);
    let full = observe(&mesh, 0.0);
    // A hole in the depth and a wrong reading outside the mask change nothing in the error.
    const MIDDLE: usize = (HEIGHT / 2) * WIDTH + WIDTH / 2;
    let holed = with_depth(&full, |i, z| match i {
        0 => 0.1,
        MIDDLE => 0.0,
        _ => z,
    });
    assert_eq!(score(&holed.unwrap(), &mesh, &pose()).depth_mae_mm, Some(0.0));
    // A mask with half of the object: what is rendered beyond it has no say.
    let mut mask = full.mask().clone();
    mask.data_mut().iter_mut().enumerate().for_each(|(i, m)| *m *= u8::from(i % WIDTH < WIDTH / 2));
    let half = score(&Observation::new(full.depth().clone(), mask, full.camera()).unwrap(), &mesh, &pose());
    assert_eq!((half.depth_mae_mm, half.fitness), (Some(0.0), Some(1.0)));
    assert!((0.3..0.6).contains(&half.iou.unwrap()), "{half:?}");
}

#[wasm_bindgen_test(unsupported = test)]
fn the_same_seed_gives_the_same_bits() {
    let mesh = ellipsoid(Vec3::new(0.5, 0.3, 0.4), 24);
    let observation = observe(&mesh, 0.003);
    let options = |seed| Sampling { max_points: 500, surface_samples: 400, seed };
    let run = |seed| evaluate(&observation, &mesh, &pose(), &options(seed)).unwrap();
    assert_eq!(run(1), run(1));
    assert_ne!(run(1).chamfer_mm, run(2).chamfer_mm);
    assert_eq!(run(1).iou, run(2).iou);
}

#[wasm_bindgen_test(unsupported = test)]
fn what_cannot_be_scored_is_refused() {
    let mesh = sphere(0.5, 16);
    let observation = observe(&mesh, 0.0);
    let flat = mapped(&mesh, |_| Vec3::ONE);
    let code =
        |mesh: &Mesh, pose: &Similarity| evaluate(&observation, mesh, pose, &Sampling::default()).unwrap_err().code;
    assert_eq!(code(&flat, &pose()), ErrorCode::DegenerateMesh);
    for scale in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(code(&mesh, &Similarity { scale, ..pose() }), ErrorCode::InvalidTransform, "scale {scale}");
    }
    let nowhere = Similarity { translation: Vector3::new(0.0, f64::NAN, 1.0), ..pose() };
    assert_eq!(code(&mesh, &nowhere), ErrorCode::InvalidTransform);
}

/// A mesh of more than 262 144 triangles is rendered as it is, but searched decimated. The object is .3 m in size.
#[wasm_bindgen_test(unsupported = test)]
fn the_surface_of_a_large_mesh_is_measured_as_exactly_as_matters() {
    let [fine, coarse] = [270, 180].map(|rings| ellipsoid(Vec3::new(0.5, 0.8, 1.0), rings));
    assert!(fine.triangles().len() > 1 << 18 && coarse.triangles().len() < 1 << 18);
    let observation = observe(&fine, 0.0);
    let m = score(&observation, &fine, &pose());
    assert_eq!((m.iou, m.fitness, m.depth_mae_mm), (Some(1.0), Some(1.0), Some(0.0)));
    // A thousandth of the size; as long as nothing is decimated, it is 0.
    let error_mm = m.uni_chamfer_mm.unwrap();
    assert!(error_mm > 0.0 && error_mm < 0.3, "{error_mm} mm");
    let moved = Similarity { translation: pose().translation + Vector3::new(0.004, 0.0, 0.006), ..pose() };
    let [a, b] = [&fine, &coarse].map(|mesh| score(&observation, mesh, &moved));
    for (name, a, b) in [
        ("chamfer", a.chamfer_mm, b.chamfer_mm),
        ("uni-chamfer", a.uni_chamfer_mm, b.uni_chamfer_mm),
        ("normals", a.normal_consistency, b.normal_consistency),
    ] {
        assert!((a.unwrap() / b.unwrap() - 1.0).abs() < 0.03, "{name}: {a:?} for {b:?}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn every_platform_gives_these_bits() {
    let mesh = ellipsoid(Vec3::new(0.5, 0.3, 0.4), 24);
    let mut rasteriser = Rasteriser::new();
    rasteriser.render(&mesh, &pose(), &camera(), WIDTH, HEIGHT);
    let pixels = rasteriser.depth().iter().zip(rasteriser.triangles());
    let image = fingerprint(pixels.map(|(z, t)| u64::from(z.to_bits()) << 32 | u64::from(*t)));

    let m = score(&observe(&mesh, 0.003), &mesh, &Similarity { scale: 0.152, ..pose() });
    let fields = [m.boundary_f, m.center_drift_px, m.iou, m.chamfer_mm, m.uni_chamfer_mm, m.fitness];
    let fields = fields.into_iter().chain([m.normal_consistency, m.depth_mae_mm]);
    let metrics = fingerprint(fields.map(|f| f.unwrap().to_bits()));
    assert_eq!(
        (image, metrics),
        (13_419_859_691_801_430_286, 2_454_295_624_806_816_696),
        "an intended change of the method changes these: {m:?}"
    );
}
