//! The baselines from clouds to pose: what each finds, what it does not depend on, and what it refuses.

use glam::Vec3;
use nalgebra::{Rotation3, Vector3};
use sim3align::geometry::surface::sample_surface;
use sim3align::paper::options::PaperOptions;
use sim3align::progress::Silent;
use sim3align::register::icp::IcpMetric;
use sim3align::register::options::Icp;
use sim3align::report::PaperAlignment;
use sim3align_geometry::cloud::Cloud;
use sim3align_geometry::error::{ErrorCode, Result};
use sim3align_geometry::similarity::Similarity;
use sim3align_lab::baselines::align::{BaselineOptions, align_baseline};
use sim3align_lab::baselines::{Baseline, PairSettings, register_pair};

use crate::shapes::{body, observe};
use crate::support::{Draw, blob, fingerprint, of_pose, pose_error, rotation_defect, transformed};

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

fn settings() -> PairSettings {
    PairSettings { icp_iterations: 100, ..PairSettings::new(0.04) }
}

#[test]
fn names_are_those_of_the_methods() {
    for baseline in Baseline::ALL {
        assert_eq!(Baseline::from_name(baseline.as_str()), Some(baseline));
    }
    let names = ["fgr", "gicp", "icp-point-to-plane", "icp-point-to-point", "ransac", "teaser", "quatro"];
    assert_eq!(Baseline::ALL.map(Baseline::as_str), names);
    assert_eq!(Baseline::from_name("FGR"), None);
}

#[test]
fn every_method_registers_a_partial_scan() {
    for baseline in Baseline::ALL {
        for seed in 0..3 {
            let (source, target, truth) = pair(&mut Draw::new(seed), baseline);
            let found = register_pair(&source, &target, baseline, &settings()).unwrap();
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
        let found = register_pair(&source, &target, Baseline::Ransac, &PairSettings { icp, ..settings() }).unwrap();
        pose_error(&found, &truth)
    };
    let (plain, refined) = (by(None), by(Some(IcpMetric::PointToPlane)));
    assert!(refined < plain && refined < 0.01, "{plain} to {refined}");
}

/// Kilometres from the origin, in another unit, in another order: the answer moves with the clouds.
#[test]
fn answers_move_with_the_clouds() {
    for baseline in Baseline::ALL {
        let (source, target, truth) = pair(&mut Draw::new(11), baseline);
        let millimetres = Similarity {
            scale: 1000.0,
            rotation: Rotation3::identity(),
            translation: Vector3::new(8000.0, -3000.0, 2000.0),
        };
        let (source, target) = (transformed(&source, &millimetres), transformed(&target, &millimetres));
        let settings = PairSettings { voxel_size: 40.0, ..settings() };
        let found = register_pair(&source, &target, baseline, &settings).unwrap();
        let back = millimetres.inverse().compose(&found).compose(&millimetres);
        let off = pose_error(&back, &truth);
        assert!(off < 0.06, "{}: off by {off}", baseline.as_str());
    }
}

#[test]
fn clouds_without_an_answer_are_errors() {
    let draw = &mut Draw::new(1);
    let good = blob(draw, 500);
    let code = |source: &Cloud, target: &Cloud, baseline, settings: &PairSettings| {
        register_pair(source, target, baseline, settings).unwrap_err().code
    };
    let mut broken = good.clone();
    broken.points[7].x = f32::NAN;
    let one_point = Cloud::from_points(vec![Vec3::ONE; 100]);
    let far = transformed(&good, &Similarity { translation: Vector3::x() * 100.0, ..Similarity::identity() });
    for baseline in Baseline::ALL {
        let usual = settings();
        assert_eq!(code(&Cloud::default(), &good, baseline, &usual), ErrorCode::TooFewPoints, "{baseline:?}");
        assert_eq!(code(&good, &good.select(0..10), baseline, &usual), ErrorCode::TooFewPoints, "{baseline:?}");
        assert_eq!(code(&broken, &good, baseline, &usual), ErrorCode::NonFinite, "{baseline:?}");
        assert_eq!(code(&good, &one_point, baseline, &usual), ErrorCode::DegeneratePoints, "{baseline:?}");
        assert_eq!(code(&one_point, &good, baseline, &usual), ErrorCode::DegeneratePoints, "{baseline:?}");
        // One voxel around everything.
        assert_eq!(code(&good, &good, baseline, &PairSettings::new(50.0)), ErrorCode::TooFewPoints, "{baseline:?}");
        for voxel_size in [0.0, -1.0, f64::NAN] {
            let settings = PairSettings { voxel_size, ..usual };
            assert_eq!(code(&good, &good, baseline, &settings), ErrorCode::InvalidOption, "{baseline:?}");
        }
        if baseline.is_local() {
            assert_eq!(code(&far, &good, baseline, &usual), ErrorCode::NoConsensus, "{baseline:?}");
        }
    }
    // Collinear points have neither normals nor matches of any shape; GICP needs none, and is there already.
    let line = Cloud::from_points((0..200).map(|i| Vec3::X * i as f32 * 0.05).collect());
    for baseline in Baseline::ALL {
        if baseline == Baseline::Gicp {
            let found = register_pair(&line, &line, baseline, &settings()).unwrap();
            assert!(pose_error(&found, &Similarity::identity()) < 1e-9, "{found:?}");
        } else {
            assert_eq!(code(&line, &line, baseline, &settings()), ErrorCode::NoConsensus, "{baseline:?}");
        }
    }
}

fn align_by(baseline: Baseline, options: &BaselineOptions) -> Result<PaperAlignment> {
    let mesh = body();
    align_baseline(&observe(&mesh, 1.0), &mesh, baseline, options, &mut Silent)
}

fn upright() -> BaselineOptions {
    BaselineOptions { up: Some([[0.0, 1.0, 0.0], [0.0, -1.0, 0.0]]), ..BaselineOptions::default() }
}

fn with_paper(paper: PaperOptions) -> BaselineOptions {
    BaselineOptions { paper, ..BaselineOptions::default() }
}

#[test]
fn meshes_keep_their_initial_scale_but_for_teaser() {
    for baseline in Baseline::ALL {
        let found = align_by(baseline, &upright()).unwrap();
        let is_initial = (found.diagnostics.common.scale_ratio - 1.0).abs() < 1e-9;
        assert_eq!(is_initial, baseline != Baseline::Teaser, "{baseline:?}: {}", found.diagnostics.common.scale_ratio);
        assert!(
            found.diagnostics.counts.source_voxels > 0 && found.diagnostics.counts.target_voxels > 0,
            "{:?}",
            found.diagnostics.counts
        );
        assert_eq!(
            found.diagnostics.counts.matches > 0,
            !baseline.is_local(),
            "{baseline:?}: {:?}",
            found.diagnostics.counts
        );
        let refines = baseline.is_local() || baseline == Baseline::Ransac;
        assert_eq!(
            found.diagnostics.counts.icp_iterations > 0,
            refines,
            "{baseline:?}: {:?}",
            found.diagnostics.counts
        );
        assert_eq!(
            found.diagnostics.common.residual_m > 0.0,
            refines,
            "{baseline:?}: {}",
            found.diagnostics.common.residual_m
        );
    }
    let locked =
        align_by(Baseline::Teaser, &BaselineOptions { lock_scale: true, ..BaselineOptions::default() }).unwrap();
    assert!((locked.diagnostics.common.scale_ratio - 1.0).abs() < 1e-9, "{}", locked.diagnostics.common.scale_ratio);
    let plain =
        align_by(Baseline::Ransac, &with_paper(PaperOptions { icp: Icp::None, ..PaperOptions::default() })).unwrap();
    assert_eq!(plain.diagnostics.counts.icp_iterations, 0);
    let error = align_by(Baseline::Quatro, &BaselineOptions::default()).unwrap_err();
    assert_eq!((error.code, &*error.argument), (ErrorCode::InvalidOption, "options.cameraUp"));
}

/// Local methods begin at the centred, unrotated pose: one iteration does not lead far from it.
#[test]
fn local_methods_begin_unrotated() {
    for baseline in [Baseline::Gicp, Baseline::IcpPointToPlane, Baseline::IcpPointToPoint] {
        let found =
            align_by(baseline, &with_paper(PaperOptions { icp_iterations: 1, ..PaperOptions::default() })).unwrap();
        let pose = Similarity::from_column_major(&found.camera_from_mesh.matrix).unwrap();
        assert!(pose.rotation.angle() < 0.5, "{baseline:?}: {}", pose.rotation.angle());
        assert!((pose.translation.z - 0.55).abs() < 0.1, "{baseline:?}: {}", pose.translation);
        assert_eq!(found.diagnostics.counts.icp_iterations, 1);
    }
}

#[test]
fn baselines_give_the_same_bits_everywhere() {
    let poses = Baseline::ALL.map(|baseline| {
        let (source, target, _) = pair(&mut Draw::new(2024), baseline);
        of_pose(&register_pair(&source, &target, baseline, &settings()).unwrap())
    });
    let aligned = Baseline::ALL.map(|baseline| {
        let found = align_by(baseline, &upright()).unwrap();
        fingerprint(found.camera_from_mesh.matrix.map(f64::to_bits))
    });
    assert_eq!((poses, aligned), EXPECTED, "now {:#018x?}", (poses, aligned));
}

/// Of `register_pair`, and of `align_baseline`, in the order of [`Baseline::ALL`].
const EXPECTED: ([u64; 7], [u64; 7]) = (
    [
        0x3952640fabad74a3,
        0xf9658e5afd72ae65,
        0x6dd540f42086a34c,
        0xd1af9289b66aa3e4,
        0x9d24cc4ac2554b13,
        0x67a3f0a2676e5b00,
        0x2bb1b421da983c0c,
    ],
    [
        0xa96d6f8d318013f2,
        0x2365325d1f4cd716,
        0xd0c313250b23b925,
        0x37cadae2a8157abc,
        0x056bc42e6a4cff38,
        0xd27e26b8eacb7599,
        0x90e026a8ac58a244,
    ],
);
