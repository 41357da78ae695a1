//! Every option changes the result in the way that its documentation says: an option that is ignored fails here.

use sim3align::align::{align, align_paper};
use sim3align::geometry::cloud::Bounds;
use sim3align::geometry::similarity::vector3;
use sim3align::metrics::symmetry::Symmetry;
use sim3align::options::Options;
use sim3align::options::scale::ScaleOption;
use sim3align::paper::options::{GuardMode, PaperOptions};
use sim3align::precise::options::{AlignOptions, ExtentAxis, Quality, SearchScope};
use sim3align::progress::Silent;
use sim3align::register::options::Icp;
use sim3align::register::options::{EstimateSim3Options, RegisterOptions};
use sim3align::register::report::Registration;
use sim3align::register::{estimate_sim3, register};
use sim3align::report::{Alignment, PaperAlignment};
use wasm_bindgen_test::wasm_bindgen_test;

use crate::support::{Draw, blob};
use crate::{precise, shapes};

/// An option, and what of the results tells that it has its effect: of the preset's defaults, and of other options.
type Effect<O, R> = (&'static str, fn(&O, &R, &dyn Fn(&O) -> R) -> bool);

fn assert_effects<O: Options, R>(effects: &[Effect<O, R>], base: &O, solve: &dyn Fn(&O) -> R) {
    let mut names: Vec<&str> = effects.iter().map(|(name, _)| *name).collect();
    let mut options = O::names();
    names.sort_unstable();
    options.sort_unstable();
    assert_eq!(names, options, "every option has a test of its effect");
    let usual = solve(base);
    let missing: Vec<&str> =
        effects.iter().filter(|(_, shows)| !shows(base, &usual, solve)).map(|(name, _)| *name).collect();
    assert!(missing.is_empty(), "without their effect: {missing:?}");
}

fn scale(result: &Alignment) -> f64 {
    result.camera_from_mesh.scale
}

const PRECISE: &[Effect<AlignOptions, Alignment>] = &[
    ("quality", |base, usual, solve| {
        let balanced = solve(&AlignOptions { quality: Quality::Balanced, ..base.clone() });
        balanced.diagnostics.counts.renders > 2 * usual.diagnostics.counts.renders
    }),
    ("scale", |base, _, solve| {
        (scale(&solve(&AlignOptions { scale: ScaleOption::Fixed(0.15), ..base.clone() })) - 0.15).abs() < 1e-9
    }),
    ("knownExtentM", |base, _, solve| {
        let extent = Bounds::of(precise::body().positions()).unwrap().extent();
        let known = solve(&AlignOptions { known_extent_m: Some(0.12), ..base.clone() });
        (scale(&known) * f64::from(extent.max_element()) - 0.12).abs() < 1e-7
    }),
    ("knownExtentAxis", |base, _, solve| {
        let extent = Bounds::of(precise::body().positions()).unwrap().extent();
        [(ExtentAxis::X, extent.x), (ExtentAxis::Y, extent.y), (ExtentAxis::Z, extent.z)].into_iter().all(
            |(axis, side)| {
                let known = AlignOptions { known_extent_m: Some(0.1), known_extent_axis: axis, ..base.clone() };
                (scale(&solve(&known)) * f64::from(side) - 0.1).abs() < 1e-7
            },
        )
    }),
    ("cameraUp", |base, usual, solve| costs_a_lean(base, usual, solve, [1.0, 1.0], [-1.0, 1.0])),
    ("meshUp", |base, usual, solve| costs_a_lean(base, usual, solve, [-1.0, -1.0], [-1.0, 1.0])),
    ("symmetry", |base, _, _| {
        let brick = shapes::cuboid(glam::Vec3::new(0.5, 0.8, 1.1));
        let observation = precise::observe(&brick, &precise::truth());
        let alternatives = |symmetry: Symmetry| {
            let options = AlignOptions { symmetry, ..base.clone() };
            align(&observation, &brick, &options, &mut Silent).unwrap().alternatives.len()
        };
        alternatives(Symmetry::None) > alternatives(Symmetry::Auto)
    }),
    ("initial", |base, usual, solve| {
        // One candidate more, which is the truth: more is drawn, and what is found is hardly worse.
        let given = solve(&AlignOptions { initial: Some(precise::truth()), ..base.clone() });
        given.diagnostics.counts.renders > usual.diagnostics.counts.renders
            && given.diagnostics.score > usual.diagnostics.score - 0.01
    }),
    ("search", |base, _, solve| {
        let given = AlignOptions { initial: Some(precise::truth()), ..base.clone() };
        let local = AlignOptions { search: SearchScope::Local, ..given.clone() };
        2 * solve(&local).diagnostics.counts.renders < solve(&given).diagnostics.counts.renders
    }),
    ("workBudget", |base, usual, solve| {
        solve(&AlignOptions { work_budget: Some(20.0), ..base.clone() }).diagnostics.counts.renders
            < usual.diagnostics.counts.renders
    }),
    ("seed", |base, usual, solve| {
        // The search draws nothing at random; the clouds of the metrics are other ones.
        let other = solve(&AlignOptions { seed: 3, ..base.clone() });
        other.camera_from_mesh == usual.camera_from_mesh
            && other.metrics.unwrap().chamfer_mm != usual.metrics.unwrap().chamfer_mm
    }),
    ("maxObservedPoints", |base, _, solve| {
        solve(&AlignOptions { max_observed_points: 333, ..base.clone() }).diagnostics.counts.target_points == 333
    }),
    ("surfaceSamples", |base, _, solve| {
        solve(&AlignOptions { surface_samples: 222, ..base.clone() }).diagnostics.counts.source_points == 222
    }),
    ("metrics", |base, usual, solve| {
        let without = solve(&AlignOptions { metrics: false, ..base.clone() });
        usual.metrics.is_some() && without.metrics.is_none() && without.camera_from_mesh == usual.camera_from_mesh
    }),
];

/// Whether directions of up that contradict what is seen cost score, and those that agree with it none.
fn costs_a_lean(
    base: &AlignOptions,
    usual: &Alignment,
    solve: &dyn Fn(&AlignOptions) -> Alignment,
    agree: [f64; 2],
    contradict: [f64; 2],
) -> bool {
    let score = |[camera, mesh]: [f64; 2]| {
        let up = precise::truth().rotation * nalgebra::Vector3::y() * camera;
        let options = AlignOptions { camera_up: Some(up.into()), mesh_up: Some([0.0, mesh, 0.0]), ..base.clone() };
        solve(&options).diagnostics.score
    };
    (score(agree) - usual.diagnostics.score).abs() < 0.01 && score(contradict) < usual.diagnostics.score - 0.2
}

const PAPER: &[Effect<PaperOptions, PaperAlignment>] = &[
    ("seed", |base, usual, solve| {
        solve(&PaperOptions { seed: 1, ..base.clone() }).camera_from_mesh != usual.camera_from_mesh
    }),
    ("maxObservedPoints", |base, _, solve| {
        solve(&PaperOptions { max_observed_points: 2000, ..base.clone() }).diagnostics.counts.target_points == 2000
    }),
    ("surfaceSamples", |base, _, solve| {
        solve(&PaperOptions { surface_samples: 3000, ..base.clone() }).diagnostics.counts.source_points == 3000
    }),
    ("metrics", |base, usual, solve| {
        let without = solve(&PaperOptions { metrics: false, ..base.clone() });
        usual.metrics.is_some() && without.metrics.is_none() && without.camera_from_mesh == usual.camera_from_mesh
    }),
    ("voxelDivisions", |base, usual, solve| {
        let coarse = solve(&PaperOptions { voxel_divisions: 20.0, ..base.clone() }).diagnostics.counts;
        // Surfaces: voxels are as many as the square of the divisions.
        let share = |few: usize, many: usize| (0.3..0.65).contains(&(few as f64 / many as f64));
        share(coarse.source_voxels, usual.diagnostics.counts.source_voxels)
            && share(coarse.target_voxels, usual.diagnostics.counts.target_voxels)
    }),
    ("fpfhRadiusVoxels", |base, usual, solve| {
        let near = solve(&PaperOptions { fpfh_radius_voxels: 2.5, ..base.clone() }).diagnostics.counts;
        near.matches != usual.diagnostics.counts.matches && near.source_voxels == usual.diagnostics.counts.source_voxels
    }),
    ("guard", |base, usual, solve| {
        let free = solve(&PaperOptions { guard: None, ..base.clone() }).diagnostics.counts;
        let tight = solve(&PaperOptions { guard: Some([0.99, 1.01]), ..base.clone() });
        usual.diagnostics.counts.rejected > 0
            && free.rejected == 0
            && tight.diagnostics.counts.rejected * usual.diagnostics.counts.iterations
                > usual.diagnostics.counts.rejected * tight.diagnostics.counts.iterations
            && (0.99..=1.01).contains(&tight.diagnostics.common.scale_ratio)
    }),
    ("guardMode", |base, _, solve| {
        let clamping = PaperOptions { guard: Some([1.0, 1.0]), guard_mode: GuardMode::Clamp, ..base.clone() };
        let clamped = solve(&clamping);
        clamped.diagnostics.counts.clamped > 0
            && clamped.diagnostics.counts.rejected == 0
            && (clamped.diagnostics.common.scale_ratio - 1.0).abs() < 1e-9
    }),
    ("ransacIterations", |base, usual, solve| {
        let iterations = solve(&PaperOptions { ransac_iterations: 700, ..base.clone() }).diagnostics.counts.iterations;
        iterations == 700 && usual.diagnostics.counts.iterations > 700
    }),
    ("ransacConfidence", |base, usual, solve| {
        let unsure = solve(&PaperOptions { ransac_confidence: 0.5, ..base.clone() }).diagnostics.counts.iterations;
        unsure < usual.diagnostics.counts.iterations
    }),
    ("inlierDistanceVoxels", |base, usual, solve| {
        solve(&PaperOptions { inlier_distance_voxels: 0.6, ..base.clone() }).diagnostics.counts.inliers
            < usual.diagnostics.counts.inliers
    }),
    ("edgeSimilarity", |base, usual, solve| {
        let lenient = solve(&PaperOptions { edge_similarity: 0.0, ..base.clone() }).diagnostics.counts;
        lenient.inconsistent == 0 && usual.diagnostics.counts.inconsistent > 0
    }),
    ("hallucinationFilter", |base, usual, solve| {
        let all = solve(&PaperOptions { hallucination_filter: false, ..base.clone() }).diagnostics.counts;
        all.supported > usual.diagnostics.counts.supported
    }),
    ("supportDistanceVoxels", |base, usual, solve| {
        let near = solve(&PaperOptions { support_distance_voxels: 0.5, ..base.clone() }).diagnostics.counts;
        near.supported < usual.diagnostics.counts.supported
    }),
    ("supportAngleDeg", |base, usual, solve| {
        solve(&PaperOptions { support_angle_deg: 5.0, ..base.clone() }).diagnostics.counts.supported
            < usual.diagnostics.counts.supported
    }),
    ("icp", |base, usual, solve| {
        let [points, none] = [Icp::PointToPoint, Icp::None].map(|icp| solve(&PaperOptions { icp, ..base.clone() }));
        points.camera_from_mesh != usual.camera_from_mesh && none.diagnostics.counts.icp_iterations == 0
    }),
    ("lockScale", |base, usual, solve| {
        let [unrefined, free] =
            [PaperOptions { icp: Icp::None, ..base.clone() }, PaperOptions { lock_scale: false, ..base.clone() }]
                .map(|options| solve(&options).camera_from_mesh.scale);
        let locked = usual.camera_from_mesh.scale;
        (unrefined / locked - 1.0).abs() < 1e-12 && (free / locked - 1.0).abs() > 1e-4
    }),
    ("icpIterations", |base, usual, solve| {
        let one = solve(&PaperOptions { icp_iterations: 1, ..base.clone() });
        // On voxels, then on the points themselves.
        one.diagnostics.counts.icp_iterations == 2
            && usual.diagnostics.counts.icp_iterations > 2
            && !one.diagnostics.common.converged
    }),
];

#[wasm_bindgen_test(unsupported = test)]
fn every_option_of_precise_has_its_effect() {
    let mesh = precise::body();
    let observation = precise::observe(&mesh, &precise::truth());
    let solve = |options: &AlignOptions| align(&observation, &mesh, options, &mut Silent).unwrap();
    assert_effects(PRECISE, &precise::quick(), &solve);
}

#[wasm_bindgen_test(unsupported = test)]
fn every_option_of_the_paper_preset_has_its_effect() {
    let mesh = shapes::body();
    let observation = shapes::observe(&mesh, 1.0);
    let solve = |options: &PaperOptions| align_paper(&observation, &mesh, options, &mut Silent).unwrap();
    assert_effects(PAPER, &PaperOptions::default(), &solve);
}

const REGISTER: &[Effect<RegisterOptions, Registration>] = &[
    ("scale", |base, _, solve| {
        let scale = ScaleOption::Fixed(1.4);
        (solve(&RegisterOptions { scale, ..base.clone() }).target_from_source.scale - 1.4).abs() < 1e-9
    }),
    ("workBudget", |base, _, _| {
        // Clouds with half of their surface in common, which one search after the other is tried on.
        let mut points = blob(&mut Draw::new(23), 3000).points;
        points.sort_by(|a, b| a.x.total_cmp(&b.x));
        let part = |points: &[glam::Vec3]| flat(&points.iter().copied().map(vector3).collect::<Vec<_>>());
        let (source, target) = (part(&points[..2000]), part(&points[1000..]));
        let counts = |work_budget| {
            let options = RegisterOptions { work_budget, ..base.clone() };
            let found = register(&source, &target, &options, &mut Silent);
            found.map(|found| found.diagnostics.counts).ok()
        };
        counts(Some(1e-6)) != counts(None)
    }),
    ("seed", |base, usual, solve| {
        solve(&RegisterOptions { seed: 1, ..base.clone() }).target_from_source != usual.target_from_source
    }),
    ("maxPoints", |base, _, solve| {
        let counts = solve(&RegisterOptions { max_points: 900, ..base.clone() }).diagnostics.counts;
        // Sparse points, which may be clutter, go from what was drawn.
        [counts.source_points, counts.target_points].iter().all(|points| (450..=900).contains(points))
    }),
    ("voxelSize", |base, usual, solve| {
        let counts = solve(&RegisterOptions { voxel_size: Some(0.4), ..base.clone() }).diagnostics.counts;
        2 * counts.target_voxels < usual.diagnostics.counts.target_voxels
    }),
    ("voxelDivisions", |base, usual, solve| {
        let counts = solve(&RegisterOptions { voxel_divisions: Some(15.0), ..base.clone() }).diagnostics.counts;
        2 * counts.target_voxels < usual.diagnostics.counts.target_voxels
    }),
    ("fpfhRadiusVoxels", |base, usual, solve| {
        let counts = solve(&RegisterOptions { fpfh_radius_voxels: 2.5, ..base.clone() }).diagnostics.counts;
        counts.matches != usual.diagnostics.counts.matches
            && counts.source_voxels == usual.diagnostics.counts.source_voxels
    }),
    ("ransacIterations", |base, usual, solve| {
        let half = usual.diagnostics.counts.iterations / 2;
        let most = u32::try_from(half).unwrap();
        half > 0
            && solve(&RegisterOptions { ransac_iterations: most, ..base.clone() }).diagnostics.counts.iterations == half
    }),
    ("ransacConfidence", |base, usual, solve| {
        let sure = RegisterOptions { ransac_confidence: 0.999_999, ..base.clone() };
        solve(&sure).diagnostics.counts.iterations > usual.diagnostics.counts.iterations
    }),
    ("inlierDistanceVoxels", |base, usual, solve| {
        let near = RegisterOptions { inlier_distance_voxels: 0.3, ..base.clone() };
        solve(&near).diagnostics.counts.inliers < usual.diagnostics.counts.inliers
    }),
    ("edgeSimilarity", |base, usual, solve| {
        let lenient = RegisterOptions { edge_similarity: 0.0, ..base.clone() };
        inconsistent_share(&solve(&lenient)) < 0.1 * inconsistent_share(usual)
    }),
    ("icp", |base, usual, solve| {
        let [points, none] = [Icp::PointToPoint, Icp::None].map(|icp| solve(&RegisterOptions { icp, ..base.clone() }));
        points.target_from_source != usual.target_from_source && none.diagnostics.counts.icp_iterations == 0
    }),
    ("icpIterations", |base, usual, solve| {
        let one = solve(&RegisterOptions { icp_iterations: 1, ..base.clone() });
        one.diagnostics.counts.icp_iterations == 2 && usual.diagnostics.counts.icp_iterations > 2
    }),
];

/// Share of the minimal sets that were dropped for their edges.
fn inconsistent_share(result: &Registration) -> f64 {
    result.diagnostics.counts.inconsistent as f64 / result.diagnostics.counts.iterations as f64
}

fn flat(points: &[nalgebra::Vector3<f64>]) -> Vec<f64> {
    points.iter().flat_map(|p| [p.x, p.y, p.z]).collect()
}

#[wasm_bindgen_test(unsupported = test)]
fn every_option_of_register_has_its_effect() {
    let draw = &mut Draw::new(21);
    let truth = draw.similarity([1.0, 2.0], 3.0);
    let [source, target] = [0, 1].map(|_| {
        let points = blob(draw, 2500).points;
        draw.noisy(&points, 0.01).into_iter().map(vector3).collect::<Vec<_>>()
    });
    let (source, target) = (flat(&source), flat(&target.iter().map(|&p| truth.apply(p)).collect::<Vec<_>>()));
    let solve = |options: &RegisterOptions| register(&source, &target, options, &mut Silent).unwrap();
    assert_effects(REGISTER, &RegisterOptions::default(), &solve);
}

const ESTIMATE: &[Effect<EstimateSim3Options, Registration>] = &[
    ("scale", |base, _, solve| {
        let scale = ScaleOption::Fixed(1.4);
        (solve(&EstimateSim3Options { scale, ..base.clone() }).target_from_source.scale - 1.4).abs() < 1e-9
    }),
    ("workBudget", |base, _, solve| {
        let strict = EstimateSim3Options { inlier_distance: Some(0.003), ..base.clone() };
        let bounded = solve(&EstimateSim3Options { work_budget: Some(1e-6), ..strict.clone() });
        bounded.diagnostics.counts.iterations < solve(&strict).diagnostics.counts.iterations
    }),
    ("seed", |base, usual, solve| {
        let other = solve(&EstimateSim3Options { seed: 1, ..base.clone() });
        other.diagnostics.counts != usual.diagnostics.counts || other.target_from_source != usual.target_from_source
    }),
    ("inlierDistance", |base, usual, solve| {
        let near = EstimateSim3Options { inlier_distance: Some(0.01), ..base.clone() };
        solve(&near).diagnostics.counts.inliers < usual.diagnostics.counts.inliers
    }),
    ("ransacIterations", |base, usual, solve| {
        let few = solve(&EstimateSim3Options { ransac_iterations: 40, ..base.clone() }).diagnostics.counts.iterations;
        few == 40 && usual.diagnostics.counts.iterations > 40
    }),
    ("ransacConfidence", |base, usual, solve| {
        let unsure = EstimateSim3Options { ransac_confidence: 0.5, ..base.clone() };
        solve(&unsure).diagnostics.counts.iterations < usual.diagnostics.counts.iterations
    }),
    ("edgeSimilarity", |base, usual, solve| {
        let lenient = EstimateSim3Options { edge_similarity: 0.0, ..base.clone() };
        inconsistent_share(&solve(&lenient)) < 0.1 * inconsistent_share(usual)
    }),
];

#[wasm_bindgen_test(unsupported = test)]
fn every_option_of_estimate_sim3_has_its_effect() {
    let draw = &mut Draw::new(22);
    let truth = draw.similarity([1.0, 2.0], 3.0);
    let source: Vec<_> = (0..300).map(|_| draw.cube(1.0)).collect();
    let target: Vec<_> = source.iter().map(|&p| truth.apply(p + draw.cube(0.02))).collect();
    // Two of three are wrong.
    let pairs: Vec<u32> = (0..300).flat_map(|i| [i, if i % 3 == 0 { i } else { draw.below(300) as u32 }]).collect();
    let (source, target) = (flat(&source), flat(&target));
    let solve = |options: &EstimateSim3Options| estimate_sim3(&source, &target, &pairs, options, &mut Silent).unwrap();
    assert_effects(ESTIMATE, &EstimateSim3Options::default(), &solve);
}
