//! Every option changes the result in the way that its documentation says: an option that is ignored fails here.

use sim3align::align::{align, align_paper};
use sim3align::options::Options;
use sim3align::paper::options::{GuardMode, PaperOptions};
use sim3align::precise::options::{ExtentAxis, Proportions};
use sim3align::register::options::{EstimateSim3Options, Icp, RegisterOptions};
use sim3align::register::report::Registration;
use sim3align::register::{estimate_sim3, register};
use sim3align::report::{Counts, PaperAlignment, SearchCounts};

use crate::prelude::*;
use crate::{observations, shapes};

/// A call: what it finds with its usual options, and with others.
struct Trial<'a, O, R, C> {
    base: &'a O,
    solve: &'a dyn Fn(&O) -> R,
    counts: fn(&R) -> C,
    usual: R,
    usually: C,
}

impl<O: Options, R, C> Trial<'_, O, R, C> {
    fn with(&self, change: impl FnOnce(&mut O)) -> R {
        let mut options = self.base.clone();
        change(&mut options);
        (self.solve)(&options)
    }

    fn count(&self, change: impl FnOnce(&mut O)) -> C {
        (self.counts)(&self.with(change))
    }
}

/// An option, and what of the results tells that it has its effect.
type Effect<O, R, C> = (&'static str, fn(&Trial<'_, O, R, C>) -> bool);

fn assert_effects<O: Options, R, C>(
    effects: &[Effect<O, R, C>],
    base: &O,
    counts: fn(&R) -> C,
    solve: &dyn Fn(&O) -> R,
) {
    let mut names: Vec<&str> = effects.iter().map(|(name, _)| *name).collect();
    let mut options = O::names();
    names.sort_unstable();
    options.sort_unstable();
    assert_eq!(names, options, "every option has a test of its effect");
    let usual = solve(base);
    let trial = Trial { base, solve, counts, usually: counts(&usual), usual };
    let missing: Vec<&str> = effects.iter().filter(|(_, shows)| !shows(&trial)).map(|(name, _)| *name).collect();
    assert!(missing.is_empty(), "without their effect: {missing:?}");
}

fn scale(result: &Alignment) -> f64 {
    result.camera_from_mesh.scale
}

fn extent() -> Vec3 {
    Bounds::of(observations::body().positions()).unwrap().extent()
}

const PRECISE: &[Effect<AlignOptions, Alignment, SearchCounts>] = &[
    ("quality", |t| t.count(|o| o.quality = Quality::Balanced).renders > 2 * t.usually.renders),
    ("scale", |t| (scale(&t.with(|o| o.scale = ScaleOption::Fixed(0.15))) - 0.15).abs() < 1e-9),
    ("knownExtentM", |t| {
        let known = t.with(|o| o.known_extent_m = Some(0.12));
        (scale(&known) * f64::from(extent().max_element()) - 0.12).abs() < 1e-7
    }),
    ("knownExtentAxis", |t| {
        [(ExtentAxis::X, extent().x), (ExtentAxis::Y, extent().y), (ExtentAxis::Z, extent().z)].into_iter().all(
            |(axis, side)| {
                let known = t.with(|o| {
                    o.known_extent_m = Some(0.1);
                    o.known_extent_axis = axis;
                });
                (scale(&known) * f64::from(side) - 0.1).abs() < 1e-7
            },
        )
    }),
    ("cameraUp", |t| costs_a_lean(t, [1.0, 1.0], [-1.0, 1.0])),
    ("meshUp", |t| costs_a_lean(t, [-1.0, -1.0], [-1.0, 1.0])),
    ("symmetry", |t| {
        let brick = cuboid(Vec3::new(0.5, 0.8, 1.1));
        let observation = observations::observe(&brick, &observations::truth());
        let alternatives = |symmetry: Symmetry| {
            let options = AlignOptions { symmetry, ..t.base.clone() };
            align(&observation, &brick, &options, &mut Silent).unwrap().alternatives.len()
        };
        alternatives(Symmetry::None) > alternatives(Symmetry::Auto)
    }),
    ("initial", |t| {
        // One candidate more, which is the truth: more is drawn, and what is found is hardly worse.
        let given = t.with(|o| o.initial = Some(observations::truth()));
        given.diagnostics.counts.renders > t.usually.renders
            && given.diagnostics.score > t.usual.diagnostics.score - 0.01
    }),
    ("search", |t| {
        let renders = |search| {
            let counts = t.count(|o| {
                o.initial = Some(observations::truth());
                o.search = search;
            });
            counts.renders
        };
        2 * renders(SearchScope::Local) < renders(SearchScope::Global)
    }),
    ("workBudget", |t| t.count(|o| o.work_budget = Some(20.0)).renders < t.usually.renders),
    ("seed", |t| {
        // The search draws nothing at random; the clouds of the metrics are other ones.
        let other = t.with(|o| o.seed = 3);
        let chamfer = |found: &Alignment| found.metrics.as_ref().unwrap().chamfer_m;
        other.camera_from_mesh == t.usual.camera_from_mesh && chamfer(&other) != chamfer(&t.usual)
    }),
    ("maxObservedPoints", |t| t.count(|o| o.max_observed_points = 333).target_points == 333),
    ("surfaceSamples", |t| t.count(|o| o.surface_samples = 222).source_points == 222),
    ("proportions", |t| {
        // The mesh has the right proportions; what is free, the evidence determines less.
        let found = |proportions| t.with(|o| o.proportions = proportions).proportions.map(|found| found.uncertainty);
        t.usual.proportions.is_none() && found(Proportions::Axes) != found(Proportions::Full)
    }),
    ("metrics", |t| {
        let without = t.with(|o| o.metrics = false);
        t.usual.metrics.is_some() && without.metrics.is_none() && without.camera_from_mesh == t.usual.camera_from_mesh
    }),
];

/// Whether directions of up that contradict what is seen cost score, and those that agree with it none.
fn costs_a_lean(t: &Trial<'_, AlignOptions, Alignment, SearchCounts>, agree: [f64; 2], contradict: [f64; 2]) -> bool {
    let gain = |[camera, mesh]: [f64; 2]| {
        let up = observations::truth().rotation * Vector3::y() * camera;
        let found = t.with(|o| {
            o.camera_up = Some(up.into());
            o.mesh_up = Some([0.0, mesh, 0.0]);
        });
        found.diagnostics.score - t.usual.diagnostics.score
    };
    gain(agree).abs() < 0.01 && gain(contradict) < -0.2
}

const PAPER: &[Effect<PaperOptions, PaperAlignment, Counts>] = &[
    ("seed", |t| t.with(|o| o.seed = 1).camera_from_mesh != t.usual.camera_from_mesh),
    ("maxObservedPoints", |t| t.count(|o| o.max_observed_points = 2000).target_points == 2000),
    ("surfaceSamples", |t| t.count(|o| o.surface_samples = 3000).source_points == 3000),
    ("metrics", |t| {
        let without = t.with(|o| o.metrics = false);
        t.usual.metrics.is_some() && without.metrics.is_none() && without.camera_from_mesh == t.usual.camera_from_mesh
    }),
    ("voxelDivisions", |t| {
        let coarse = t.count(|o| o.voxel_divisions = 20.0);
        // Surfaces: voxels are as many as the square of the divisions.
        let share = |few: usize, many: usize| (0.3..0.65).contains(&(few as f64 / many as f64));
        share(coarse.source_voxels, t.usually.source_voxels) && share(coarse.target_voxels, t.usually.target_voxels)
    }),
    ("fpfhRadiusVoxels", |t| {
        let near = t.count(|o| o.fpfh_radius_voxels = 2.5);
        near.matches != t.usually.matches && near.source_voxels == t.usually.source_voxels
    }),
    ("guard", |t| {
        let free = t.count(|o| o.guard = None);
        let tight = t.with(|o| o.guard = Some([0.99, 1.01])).diagnostics;
        t.usually.rejected > 0
            && free.rejected == 0
            && tight.counts.rejected * t.usually.iterations > t.usually.rejected * tight.counts.iterations
            && (0.99..=1.01).contains(&tight.common.scale_ratio)
    }),
    ("guardMode", |t| {
        let clamped = t.with(|o| {
            o.guard = Some([1.0, 1.0]);
            o.guard_mode = GuardMode::Clamp;
        });
        let Counts { clamped: some, rejected, .. } = clamped.diagnostics.counts;
        some > 0 && rejected == 0 && (clamped.diagnostics.common.scale_ratio - 1.0).abs() < 1e-9
    }),
    ("ransacIterations", |t| t.count(|o| o.ransac_iterations = 700).iterations == 700 && t.usually.iterations > 700),
    ("ransacConfidence", |t| t.count(|o| o.ransac_confidence = 0.5).iterations < t.usually.iterations),
    ("inlierDistanceVoxels", |t| t.count(|o| o.inlier_distance_voxels = 0.6).inliers < t.usually.inliers),
    ("edgeSimilarity", |t| t.count(|o| o.edge_similarity = 0.0).inconsistent == 0 && t.usually.inconsistent > 0),
    ("hallucinationFilter", |t| t.count(|o| o.hallucination_filter = false).supported > t.usually.supported),
    ("supportDistanceVoxels", |t| t.count(|o| o.support_distance_voxels = 0.5).supported < t.usually.supported),
    ("supportAngleDeg", |t| t.count(|o| o.support_angle_deg = 5.0).supported < t.usually.supported),
    ("icp", |t| {
        let [points, none] = [Icp::PointToPoint, Icp::None].map(|icp| t.with(|o| o.icp = icp));
        let moves = [&points, &none].iter().all(|found| found.camera_from_mesh != t.usual.camera_from_mesh);
        moves && none.diagnostics.counts.icp_iterations == 0
    }),
    ("lockScale", |t| {
        let locked = t.usual.camera_from_mesh.scale;
        let unrefined = t.with(|o| o.icp = Icp::None).camera_from_mesh.scale;
        let free = t.with(|o| o.lock_scale = false).camera_from_mesh.scale;
        (unrefined / locked - 1.0).abs() < 1e-12 && (free / locked - 1.0).abs() > 1e-4
    }),
    ("icpIterations", |t| {
        let one = t.with(|o| o.icp_iterations = 1).diagnostics;
        // On voxels, then on the points themselves.
        one.counts.icp_iterations == 2 && t.usually.icp_iterations > 2 && !one.common.converged
    }),
];

#[wasm_bindgen_test]
fn every_option_of_precise_has_its_effect() {
    let mesh = observations::body();
    let observation = observations::observe(&mesh, &observations::truth());
    assert_effects(PRECISE, &observations::quick(), |found| found.diagnostics.counts, &|options| {
        align(&observation, &mesh, options, &mut Silent).unwrap()
    });
}

#[wasm_bindgen_test]
fn every_option_of_the_paper_preset_has_its_effect() {
    let mesh = shapes::body();
    let observation = shapes::observe(&mesh);
    assert_effects(PAPER, &PaperOptions::default(), |found| found.diagnostics.counts, &|options| {
        align_paper(&observation, &mesh, options, &mut Silent).unwrap()
    });
}

const REGISTER: &[Effect<RegisterOptions, Registration, Counts>] = &[
    ("scale", |t| (t.with(|o| o.scale = ScaleOption::Fixed(1.4)).target_from_source.scale - 1.4).abs() < 1e-9),
    ("workBudget", |t| {
        // Clouds with half of their surface in common, which one search after the other is tried on.
        let mut points = blob(&mut Draw::new(23), 1500).points;
        points.sort_by(|a, b| a.x.total_cmp(&b.x));
        let part = |points: &[Vec3]| flat(&points.iter().copied().map(vector3).collect::<Vec<_>>());
        let (source, target) = (part(&points[..1000]), part(&points[500..]));
        let counts = |work_budget| {
            let options = RegisterOptions { work_budget, ..t.base.clone() };
            let found = register(&source, &target, &options, &mut Silent);
            found.map(|found| found.diagnostics.counts).ok()
        };
        counts(Some(1e-6)) != counts(None)
    }),
    ("seed", |t| t.with(|o| o.seed = 1).target_from_source != t.usual.target_from_source),
    ("maxPoints", |t| {
        let counts = t.count(|o| o.max_points = 600);
        // Sparse points, which may be clutter, go from what was drawn.
        [counts.source_points, counts.target_points].iter().all(|points| (300..=600).contains(points))
    }),
    ("voxelSize", |t| 2 * t.count(|o| o.voxel_size = Some(0.4)).target_voxels < t.usually.target_voxels),
    ("voxelDivisions", |t| 2 * t.count(|o| o.voxel_divisions = Some(15.0)).target_voxels < t.usually.target_voxels),
    ("fpfhRadiusVoxels", |t| {
        let near = t.count(|o| o.fpfh_radius_voxels = 2.5);
        near.matches != t.usually.matches && near.source_voxels == t.usually.source_voxels
    }),
    ("ransacIterations", |t| {
        let half = t.usually.iterations / 2;
        half > 0 && t.count(|o| o.ransac_iterations = u32::try_from(half).unwrap()).iterations == half
    }),
    ("ransacConfidence", |t| t.count(|o| o.ransac_confidence = 0.999_999).iterations > t.usually.iterations),
    ("inlierDistanceVoxels", |t| t.count(|o| o.inlier_distance_voxels = 0.3).inliers < t.usually.inliers),
    ("edgeSimilarity", |t| inconsistent(t.count(|o| o.edge_similarity = 0.0)) < 0.1 * inconsistent(t.usually)),
    ("icp", |t| {
        t.with(|o| o.icp = Icp::PointToPoint).target_from_source != t.usual.target_from_source
            && t.count(|o| o.icp = Icp::None).icp_iterations == 0
    }),
    ("icpIterations", |t| t.count(|o| o.icp_iterations = 1).icp_iterations == 2 && t.usually.icp_iterations > 2),
];

/// Share of the minimal sets that were dropped for their edges.
fn inconsistent(counts: Counts) -> f64 {
    counts.inconsistent as f64 / counts.iterations as f64
}

#[wasm_bindgen_test]
fn every_option_of_register_has_its_effect() {
    let draw = &mut Draw::new(21);
    let truth = draw.similarity([1.0, 2.0], 3.0);
    let [source, target] = [0, 1].map(|_| {
        let points = blob(draw, 1200).points;
        draw.noisy(&points, 0.01).into_iter().map(vector3).collect::<Vec<_>>()
    });
    let (source, target) = (flat(&source), flat(&target.iter().map(|&p| truth.apply(p)).collect::<Vec<_>>()));
    assert_effects(REGISTER, &RegisterOptions::default(), |found| found.diagnostics.counts, &|options| {
        register(&source, &target, options, &mut Silent).unwrap()
    });
}

const ESTIMATE: &[Effect<EstimateSim3Options, Registration, Counts>] = &[
    ("scale", |t| (t.with(|o| o.scale = ScaleOption::Fixed(1.4)).target_from_source.scale - 1.4).abs() < 1e-9),
    ("workBudget", |t| {
        let iterations = |work_budget| {
            let counts = t.count(|o| {
                o.inlier_distance = Some(0.003);
                o.work_budget = work_budget;
            });
            counts.iterations
        };
        iterations(Some(1e-6)) < iterations(t.base.work_budget)
    }),
    ("seed", |t| {
        let other = t.with(|o| o.seed = 1);
        other.diagnostics.counts != t.usually || other.target_from_source != t.usual.target_from_source
    }),
    ("inlierDistance", |t| t.count(|o| o.inlier_distance = Some(0.01)).inliers < t.usually.inliers),
    ("ransacIterations", |t| t.count(|o| o.ransac_iterations = 40).iterations == 40 && t.usually.iterations > 40),
    ("ransacConfidence", |t| t.count(|o| o.ransac_confidence = 0.5).iterations < t.usually.iterations),
    ("edgeSimilarity", |t| inconsistent(t.count(|o| o.edge_similarity = 0.0)) < 0.1 * inconsistent(t.usually)),
];

#[wasm_bindgen_test]
fn every_option_of_estimate_sim3_has_its_effect() {
    let draw = &mut Draw::new(22);
    let truth = draw.similarity([1.0, 2.0], 3.0);
    let source: Vec<_> = (0..300).map(|_| draw.cube(1.0)).collect();
    let target: Vec<_> = source.iter().map(|&p| truth.apply(p + draw.cube(0.02))).collect();
    // Two of three are wrong.
    let pairs: Vec<u32> = (0..300).flat_map(|i| [i, if i % 3 == 0 { i } else { draw.below(300) as u32 }]).collect();
    let (source, target) = (flat(&source), flat(&target));
    assert_effects(ESTIMATE, &EstimateSim3Options::default(), |found| found.diagnostics.counts, &|options| {
        estimate_sim3(&source, &target, &pairs, options, &mut Silent).unwrap()
    });
}
