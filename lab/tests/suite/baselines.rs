//! The baselines from clouds to pose: what each finds, what it does not depend on, and what it refuses.

use sim3align::geometry::surface::sample_surface;
use sim3align::register::options::Icp;
use sim3align::report::PaperAlignment;
use sim3align_lab::baselines::align::align_baseline;
use sim3align_lab::baselines::{Baseline, register_pair};

use crate::shapes::{body, observe};
use crate::support::{Draw, blob, fingerprint, of_pose, pose_error, rotation_defect, transformed};
use sim3align_lab::prelude::*;

/// A shape and what a scan from one side has of it, some way off: a turn about z for Quatro's sake, a small one for
/// those that only search nearby.
fn pair(draw: &mut Draw, baseline: Baseline) -> (Cloud, Cloud, Similarity) {
    let mesh = body();
    let mut sample = || sample_surface(&mesh, 6000, draw.below(1000) as u64).unwrap();
    let (target, scan) = (sample(), sample());
    let seen = scan.select((0..scan.len()).filter(|&i| scan.points[i].x + 0.5 * scan.points[i].y > -0.2));
    let rotation = match baseline {
        Baseline::Quatro => Rotation3::new(Vector3::z() * draw.between(-3.0, 3.0)),
        _ if baseline.is_local() => draw.rotation_by(0.1),
        _ => draw.rotation(),
    };
    let offset = if baseline.is_local() { 0.05 } else { 3.0 };
    let truth = Similarity { scale: 1.0, rotation, translation: draw.cube(offset) };
    (transformed(&seen, &truth.inverse()), target, truth)
}

/// Edge of a voxel of [`pair`].
const VOXEL: f64 = 0.04;

fn settings() -> PaperOptions {
    PaperOptions { icp: Icp::None, icp_iterations: 100, ..PaperOptions::default() }
}

#[test]
fn every_method_registers_a_partial_scan() {
    for &baseline in Baseline::ALL {
        for seed in 0..3 {
            let (source, target, truth) = pair(&mut Draw::new(seed), baseline);
            let found = register_pair(&source, &target, baseline, VOXEL, &settings()).unwrap();
            let off = pose_error(&found, &truth);
            // Two voxels for those that stand on matches of voxels, less for those that look at the surface.
            // Points of two samplings are never the same: point to point stops short.
            let is_exact = matches!(baseline, Baseline::Gicp | Baseline::IcpPointToPlane);
            let most: f64 = if is_exact { 0.01 } else { 0.09 };
            assert!(
                off < most.min(0.8 * pose_error(&Similarity::identity(), &truth)),
                "{}, seed {seed}: off by {off}",
                baseline.as_str()
            );
            assert!(found.scale == 1.0 && rotation_defect(found.rotation.matrix()) < 1e-9, "{found:?}");
        }
    }
}

#[test]
fn ransac_gains_by_icp() {
    let (source, target, truth) = pair(&mut Draw::new(4), Baseline::Ransac);
    let by = |icp| {
        let settings = PaperOptions { icp, ..settings() };
        pose_error(&register_pair(&source, &target, Baseline::Ransac, VOXEL, &settings).unwrap(), &truth)
    };
    let (plain, refined) = (by(Icp::None), by(Icp::PointToPlane));
    assert!(refined < plain && refined < 0.01, "{plain} to {refined}");
}

/// Kilometres from the origin, in another unit, in another order: the answer moves with the clouds.
#[test]
fn answers_move_with_the_clouds() {
    for &baseline in Baseline::ALL {
        let (source, target, truth) = pair(&mut Draw::new(11), baseline);
        let millimetres = Similarity {
            scale: 1000.0,
            rotation: Rotation3::identity(),
            translation: Vector3::new(8000.0, -3000.0, 2000.0),
        };
        let (source, target) = (transformed(&source, &millimetres), transformed(&target, &millimetres));
        let found = register_pair(&source, &target, baseline, 1000.0 * VOXEL, &settings()).unwrap();
        let back = millimetres.inverse().compose(&found).compose(&millimetres);
        let off = pose_error(&back, &truth);
        assert!(off < 0.06, "{}: off by {off}", baseline.as_str());
    }
}

#[test]
fn clouds_without_an_answer_are_errors() {
    let draw = &mut Draw::new(1);
    let good = blob(draw, 500);
    let code = |source: &Cloud, target: &Cloud, baseline, voxel_size: f64| {
        register_pair(source, target, baseline, voxel_size, &settings()).unwrap_err().code
    };
    let mut broken = good.clone();
    broken.points[7].x = f32::NAN;
    let few = good.select(0..10);
    let one_point = Cloud::from_points(vec![Vec3::ONE; 100]);
    let far = transformed(&good, &Similarity { translation: Vector3::x() * 100.0, ..Similarity::identity() });
    for &baseline in Baseline::ALL {
        for (source, target, voxel_size, expected) in [
            (&Cloud::default(), &good, VOXEL, ErrorCode::TooFewPoints),
            (&good, &few, VOXEL, ErrorCode::TooFewPoints),
            (&broken, &good, VOXEL, ErrorCode::NonFinite),
            (&good, &one_point, VOXEL, ErrorCode::DegeneratePoints),
            (&one_point, &good, VOXEL, ErrorCode::DegeneratePoints),
            // One voxel around everything.
            (&good, &good, 50.0, ErrorCode::TooFewPoints),
            (&good, &good, 0.0, ErrorCode::InvalidOption),
            (&good, &good, -1.0, ErrorCode::InvalidOption),
            (&good, &good, f64::NAN, ErrorCode::InvalidOption),
        ] {
            assert_eq!(code(source, target, baseline, voxel_size), expected, "{baseline:?}, {voxel_size}");
        }
        if baseline.is_local() {
            assert_eq!(code(&far, &good, baseline, VOXEL), ErrorCode::NoConsensus, "{baseline:?}");
        }
    }
    // Collinear points have neither normals nor matches of any shape; GICP needs none, and is there already.
    let line = Cloud::from_points((0..200).map(|i| Vec3::X * i as f32 * 0.05).collect());
    for &baseline in Baseline::ALL {
        if baseline == Baseline::Gicp {
            let found = register_pair(&line, &line, baseline, VOXEL, &settings()).unwrap();
            assert!(pose_error(&found, &Similarity::identity()) < 1e-9, "{found:?}");
        } else {
            assert_eq!(code(&line, &line, baseline, VOXEL), ErrorCode::NoConsensus, "{baseline:?}");
        }
    }
}

fn align_by(baseline: Baseline, paper: &PaperOptions, lock_scale: bool) -> Result<PaperAlignment> {
    let mesh = body();
    align_baseline(&observe(&mesh, 1.0), &mesh, baseline, paper, lock_scale, &mut Silent)
}

/// All but Quatro, which needs to know which way is up.
fn aligned() -> impl Iterator<Item = Baseline> {
    Baseline::ALL.iter().copied().filter(|baseline| *baseline != Baseline::Quatro)
}

#[test]
fn meshes_keep_their_initial_scale_but_for_teaser() {
    let usual = PaperOptions::default();
    for baseline in aligned() {
        let found = align_by(baseline, &usual, false).unwrap().diagnostics;
        let is_initial = (found.common.scale_ratio - 1.0).abs() < 1e-9;
        assert_eq!(is_initial, baseline != Baseline::Teaser, "{baseline:?}: {}", found.common.scale_ratio);
        let counts = &found.counts;
        assert!(counts.source_voxels > 0 && counts.target_voxels > 0, "{baseline:?}: {counts:?}");
        assert_eq!(counts.matches > 0, !baseline.is_local(), "{baseline:?}: {counts:?}");
        let refines = baseline.is_local() || baseline == Baseline::Ransac;
        assert_eq!(counts.icp_iterations > 0, refines, "{baseline:?}: {counts:?}");
        assert_eq!(found.common.residual_m > 0.0, refines, "{baseline:?}: {}", found.common.residual_m);
    }
    let locked = align_by(Baseline::Teaser, &usual, true).unwrap();
    assert!((locked.diagnostics.common.scale_ratio - 1.0).abs() < 1e-9, "{}", locked.diagnostics.common.scale_ratio);
    let plain = align_by(Baseline::Ransac, &PaperOptions { icp: Icp::None, ..usual.clone() }, false).unwrap();
    assert_eq!(plain.diagnostics.counts.icp_iterations, 0);
    let error = align_by(Baseline::Quatro, &usual, false).unwrap_err();
    assert_eq!((error.code, &*error.argument), (ErrorCode::InvalidOption, "options.cameraUp"));
}

/// Local methods begin at the centred, unrotated pose: one iteration does not lead far from it.
#[test]
fn local_methods_begin_unrotated() {
    for baseline in [Baseline::Gicp, Baseline::IcpPointToPlane, Baseline::IcpPointToPoint] {
        let found = align_by(baseline, &PaperOptions { icp_iterations: 1, ..PaperOptions::default() }, false).unwrap();
        let pose = Similarity::from_column_major(&found.camera_from_mesh.matrix).unwrap();
        assert!(pose.rotation.angle() < 0.5, "{baseline:?}: {}", pose.rotation.angle());
        assert!((pose.translation.z - 0.55).abs() < 0.1, "{baseline:?}: {}", pose.translation);
        assert_eq!(found.diagnostics.counts.icp_iterations, 1);
    }
}

#[test]
fn baselines_give_the_same_bits_everywhere() {
    let registered = Baseline::ALL.iter().map(|&baseline| {
        let (source, target, _) = pair(&mut Draw::new(2024), baseline);
        of_pose(&register_pair(&source, &target, baseline, VOXEL, &settings()).unwrap())
    });
    let aligned = aligned().map(|baseline| {
        let found = align_by(baseline, &PaperOptions::default(), false).unwrap();
        fingerprint(found.camera_from_mesh.matrix.map(f64::to_bits))
    });
    let found: Vec<u64> = registered.chain(aligned).collect();
    assert_eq!(found, EXPECTED, "now {found:#018x?}");
}

/// Of `register_pair`, and of `align_baseline`, in the order of [`Baseline::ALL`].
const EXPECTED: [u64; 13] = [
    0x3952640fabad74a3,
    0xf9658e5afd72ae65,
    0x6dd540f42086a34c,
    0xd1af9289b66aa3e4,
    0x9d24cc4ac2554b13,
    0x67a3f0a2676e5b00,
    0x2bb1b421da983c0c,
    0xa96d6f8d318013f2,
    0x2365325d1f4cd716,
    0xd0c313250b23b925,
    0x37cadae2a8157abc,
    0x056bc42e6a4cff38,
    0xd27e26b8eacb7599,
];
