//! Cluttered scenes: as many pairs as said, nothing within another, true to their truth.

use std::collections::BTreeSet;
use std::fs;
use std::sync::OnceLock;

use sim3align::align::evaluate::Evaluation;
use sim3align::evidence::clouds::Sampling;
use sim3align::geometry::surface::SurfaceMoments;
use sim3align::metrics::{Metrics, evaluate};
use sim3align_geometry::order::median;
use sim3align_geometry::triangle_tree::TriangleTree;
use sim3align_lab::bench::benchmark::BenchCase;
use sim3align_lab::bench::generators::{PlacedScene, ROWS, Record, table};
use sim3align_lab::cases::tier::Tier;
use sim3align_lab::files::listed;
use sim3align_lab::prelude::*;

use crate::common::{assert_canonical, assert_read_back, depth_of, fresh, mask_px};
use sim3align_lab::scenes::{
    Below, ClutteredScene, LEAST_VISIBLE, MIN_MASK_PX, Prior, ScenePair, SceneSet, Sight, difficulty, tier,
};

const SEED: u64 = 7;
const LOOKED_AT: usize = 5;

/// A few scenes, drawn once for all tests.
fn scenes() -> &'static [ClutteredScene] {
    static SCENES: OnceLock<Vec<ClutteredScene>> = OnceLock::new();
    SCENES.get_or_init(|| {
        let set = SceneSet::new(SEED, LOOKED_AT);
        (0..LOOKED_AT).map(|index| set.scene(index).unwrap()).collect()
    })
}

fn pairs() -> impl Iterator<Item = &'static ScenePair> {
    scenes().iter().flat_map(|scene| &scene.pairs)
}

fn truth_metrics(case: &BenchCase) -> Metrics {
    let truth = case.truth.as_ref().unwrap();
    evaluate(&case.observation, &case.mesh, &truth.camera_from_mesh, &Sampling::default()).unwrap()
}

/// The magnitude of a simulated error.
fn parameter(case: &BenchCase, name: &str) -> f64 {
    case.parameters[name].as_f64().unwrap()
}

#[test]
fn a_hundred_scenes_hold_338_pairs() {
    for seed in 0..20 {
        let set = SceneSet::new(seed, 100);
        let with = |n| (0..100).filter(|&scene| set.pairs_of(scene) == n).count();
        assert_eq!((set.scenes(), set.pairs(), with(4), with(3), with(2)), (100, 338, 52, 34, 14), "seed {seed}");
        // The same shares in every ten, and a smaller set is the beginning of a larger one.
        let first = SceneSet::new(seed, 10);
        assert!((33..=35).contains(&first.pairs()), "seed {seed}: {}", first.pairs());
        assert!((0..10).all(|scene| first.pairs_of(scene) == set.pairs_of(scene)), "seed {seed}");
    }
    let order = |seed| (0..100).map(|scene| SceneSet::new(seed, 100).pairs_of(scene)).collect::<Vec<_>>();
    assert_ne!(order(0), order(1));
    assert_eq!((SceneSet::new(0, 0).pairs(), SceneSet::new(0, 5).pairs_of(5)), (0, 0));
    assert_eq!(SceneSet::new(0, 5).scene(5).unwrap_err().code, ErrorCode::InvalidArgument);
}

#[test]
fn every_scene_has_as_many_pairs_as_its_set_says() {
    let set = SceneSet::new(SEED, 100);
    for scene in scenes() {
        assert_eq!(scene.pairs.len(), set.pairs_of(scene.index));
        assert!((2..=4).contains(&scene.pairs.len()));
        assert!(scene.pairs.iter().enumerate().all(|(k, pair)| (pair.scene, pair.index) == (scene.index, k)));
    }
}

#[test]
fn a_pair_follows_from_the_sets_seed_its_place_and_the_prior_alone() {
    let files = |seed, scenes, prior| {
        let scene = SceneSet::new(seed, scenes).scene(1).unwrap();
        scene.pairs.last().unwrap().files(prior).unwrap()
    };
    for prior in Prior::ALL {
        assert_eq!(files(1, 2, *prior), files(1, 100, *prior), "{prior:?}");
        assert_ne!(files(1, 2, *prior), files(2, 2, *prior), "{prior:?}");
    }
}

/// The number of a mesh's vertices within another one.
fn vertices_within(inner: &Mesh, outer: &Mesh) -> usize {
    points_within(inner, outer).len()
}

/// A mesh's vertices within another one, by parity along rays upwards; the meshes' parts are closed.
fn points_within(inner: &Mesh, outer: &Mesh) -> Vec<Vec3> {
    let triangles: Vec<_> = outer.triangles().iter().map(|t| outer.corners(*t).map(|p| p.as_dvec3())).collect();
    let bounds = Bounds::of(outer.positions()).unwrap();
    let is_within = |p: &Vec3| {
        if p.cmplt(bounds.min).any() || p.cmpgt(bounds.max).any() {
            return false;
        }
        // Off the lattice that meshes of revolution are made of.
        let p = p.as_dvec3() + DVec3::new(1.234e-6, 2.345e-6, 0.0);
        let depth: i32 = triangles
            .iter()
            .map(|[a, b, c]| {
                let side = |a: &DVec3, b: &DVec3| (*b - *a).truncate().perp_dot((p - *a).truncate());
                let sides = [side(a, b), side(b, c), side(c, a)];
                let way = if sides.iter().all(|s| *s > 0.0) { 1 } else { -i32::from(sides.iter().all(|s| *s < 0.0)) };
                let normal = (*b - *a).cross(*c - *a);
                let height = a.z - ((p - *a).truncate().dot(normal.truncate())) / normal.z;
                if way != 0 && height > p.z { way } else { 0 }
            })
            .sum();
        depth > 0
    };
    inner.positions().iter().copied().filter(|p| is_within(p)).collect()
}

#[test]
fn nothing_is_within_another() {
    for scene in scenes() {
        let meshes: Vec<&Mesh> = scene.pairs.iter().map(|pair| &pair.object).chain([&scene.clutter]).collect();
        let trees: Vec<TriangleTree> = meshes.iter().map(|mesh| TriangleTree::new(mesh)).collect();
        for (i, mesh) in meshes.iter().enumerate() {
            for (k, other) in meshes.iter().enumerate().filter(|(k, _)| *k != i) {
                assert_eq!(vertices_within(mesh, other), 0, "scene {}: {i} in {k}", scene.index);
                let distance = |p: &Vec3| trees[k].nearest(*p).unwrap().distance_squared.sqrt();
                let nearest = mesh.positions().iter().map(distance).fold(f32::INFINITY, f32::min);
                assert!(nearest >= 0.002, "scene {}: {i} and {k} are {nearest} m apart", scene.index);
            }
        }
    }
    // The count finds what is within: a thing half as large, about the same middle.
    let mesh = &scenes()[0].pairs[0].object;
    let centre = SurfaceMoments::of(mesh).centroid.as_vec3();
    let shrunk = mesh.positions().iter().map(|p| centre + (*p - centre) * 0.5).collect();
    assert!(vertices_within(&Mesh::new(shrunk, mesh.triangles().to_vec()).unwrap(), mesh) > 0);
}

#[test]
fn everything_rests_on_the_plane() {
    for pair in pairs() {
        let lowest = pair.object.positions().iter().fold(f32::INFINITY, |low, p| low.min(p.z));
        assert!(lowest.abs() < 1e-6, "{}: {lowest}", pair.name());
        // What stands on a point would fall: it touches the plane, or nearly, on either side of its middle.
        let size = Bounds::of(pair.object.positions()).unwrap().diagonal();
        let centre = SurfaceMoments::of(&pair.object).centroid.truncate().as_vec2();
        let touching = pair.object.positions().iter().filter(|p| p.z < 0.012 * size).map(|p| p.truncate() - centre);
        let touching: Vec<glam::Vec2> = touching.collect();
        let away = |d: glam::Vec2| touching.iter().map(|p| p.dot(d)).fold(f32::NEG_INFINITY, f32::max);
        let least = (0..16)
            .map(|k| away(glam::Vec2::from_angle(k as f32 * std::f32::consts::FRAC_PI_8)))
            .fold(f32::INFINITY, f32::min);
        println!("{}: {least}", pair.name());
        assert!(least > -0.02 * size || pair.family == "lamp", "{}: {least} of {size}", pair.name());
    }
    for scene in scenes() {
        assert!(scene.clutter.positions().iter().all(|p| p.z > -1e-6));
    }
}

#[test]
fn every_object_shows_enough() {
    let mut hidden = 0;
    for pair in pairs() {
        let mask_px = mask_px(&pair.observation);
        assert!(mask_px >= MIN_MASK_PX, "{}: {mask_px} pixels", pair.name());
        assert!(pair.visible() >= LEAST_VISIBLE, "{}: {}", pair.name(), pair.visible());
        hidden += usize::from(pair.visible() < 0.95);
    }
    // They stand close enough to hide each other.
    assert!(hidden >= 3, "{hidden} hidden");
    let families: BTreeSet<&str> = pairs().map(|pair| pair.family.as_str()).collect();
    assert!(families.len() >= 6, "{families:?}");
}

#[test]
fn the_object_is_where_the_depth_says() {
    for pair in pairs() {
        let (depth, mask) = (pair.observation.depth(), pair.observation.mask());
        let drawn = depth_of(&pair.object, &pair.camera_from_object, &pair.observation);
        let shown = drawn.iter().zip(depth.data()).zip(mask.data());
        let both = shown.filter(|((drawn, read), masked)| **masked != 0 && **drawn > 0.0 && **read > 0.0);
        let off: Vec<f32> = both.map(|((drawn, read), _)| read - drawn).collect();
        // Medians: along its rim, and where the mask is wrong, it shows something else.
        let [signed, absolute] =
            [median(off.iter().copied()), median(off.iter().map(|x| x.abs()))].map(|x| 1000.0 * x.unwrap());
        let diagonal_mm = 1000.0 * Bounds::of(pair.object.positions()).unwrap().diagonal();
        println!("{}: {signed} mm, {absolute} mm of {diagonal_mm} mm", pair.name());
        assert!(signed.abs() < 0.008 * diagonal_mm, "{}: {signed} mm of {diagonal_mm} mm", pair.name());
        assert!(absolute < 0.02 * diagonal_mm, "{}: {absolute} mm of {diagonal_mm} mm", pair.name());
        let inside = mask.data().iter().zip(&drawn).filter(|(m, z)| **m != 0 && **z > 0.0).count();
        let masked = mask_px(&pair.observation);
        // Of a thin thing, a pixel more or less is much.
        assert!(inside as f64 > 0.6 * masked as f64, "{}: {inside} of {masked} pixels", pair.name());
    }
}

#[test]
fn the_truth_fits_what_the_priors_make_as_well_as_they_let_it() {
    let mut overlap = [0.0; 2];
    for pair in pairs() {
        let cases = Prior::ALL.iter().map(|prior| pair.case(*prior).unwrap());
        for ((case, least), sum) in cases.zip([0.65, 0.5]).zip(&mut overlap) {
            let metrics = truth_metrics(&case);
            println!("{} {}: {metrics:?}", case.name, case.parameters["prior"]);
            assert_canonical(&case.mesh, &case.name);
            assert!(metrics.iou.unwrap() >= least * pair.visible(), "{}: {metrics:?}", case.name);
            assert!(metrics.fitness.unwrap() >= 0.6, "{}: {metrics:?}", case.name);
            let diagonal_mm = 1000.0 * parameter(&case, "diagonalM");
            assert!(metrics.depth_mae_mm.unwrap() < 0.12 * diagonal_mm, "{}: {metrics:?}", case.name);
            *sum += metrics.iou.unwrap();
        }
    }
    // The smooth prior is the worse one.
    assert!(overlap[1] < overlap[0], "{overlap:?}");
}

#[test]
fn priors_share_all_but_the_mesh() {
    for scene in scenes() {
        let pair = &scene.pairs[0];
        let [detailed, smooth] = [Prior::Detailed, Prior::Smooth].map(|prior| pair.case(prior).unwrap());
        assert_eq!(detailed.observation.depth(), smooth.observation.depth());
        assert_eq!(detailed.observation.mask(), smooth.observation.mask());
        assert_eq!(detailed.observation.camera(), smooth.observation.camera());
        assert_ne!(detailed.mesh, smooth.mesh);
        for other in &scene.pairs {
            assert_eq!(other.observation.depth(), pair.observation.depth());
        }
        assert!((0.6..=0.85).contains(&parameter(&smooth, "flattened")));
        assert_eq!((detailed.tier, detailed.name), (smooth.tier, smooth.name));
    }
}

#[test]
fn difficulty_rises_with_what_makes_a_pair_hard() {
    let sight = Sight { visible: 0.8, mask_px: 5000, mask_offset_px: 0.5, distance_m: 0.8 };
    let base = difficulty(&sight);
    for harder in [
        Sight { visible: 0.6, ..sight },
        Sight { mask_px: 1000, ..sight },
        Sight { mask_offset_px: -1.5, ..sight },
        Sight { distance_m: 1.2, ..sight },
    ] {
        assert!(difficulty(&harder) > base, "{harder:?}");
    }
    let best = Sight { visible: 1.0, mask_px: 30_000, mask_offset_px: 0.0, distance_m: 0.4 };
    let worst = Sight { visible: 0.3, mask_px: 300, mask_offset_px: 3.0, distance_m: 2.0 };
    assert_eq!(difficulty(&best), 0.0);
    assert!((difficulty(&worst) - 1.0).abs() < 1e-12);
    assert_eq!([0.0, 0.25, 1.0].map(tier), [Tier::Easy, Tier::Medium, Tier::Hard]);
}

#[test]
fn a_written_set_reads_back_and_is_not_written_again() {
    let folder = fresh("scenes");
    let set = SceneSet::new(SEED, 1);
    set.write(&folder, Prior::ALL, 2, |_| {}).unwrap();
    let pair = &scenes()[0].pairs[0];
    for prior in Prior::ALL {
        let parent = folder.join(prior.as_str());
        let names: BTreeSet<String> =
            fs::read_dir(&parent).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        assert_eq!(names, scenes()[0].pairs.iter().map(ScenePair::name).collect());
        let (read, made) = (BenchCase::read(&parent.join(pair.name())).unwrap(), pair.case(*prior).unwrap());
        // The depth is in whole units already: nothing is lost.
        assert_read_back(&read, &made);
        assert_eq!((&read.name, read.class.as_str()), (&made.name, "scene"));
        assert_eq!(read.parameters["prior"], prior.as_str());
        for name in ["difficulty", "visible", "maskPx", "hidden", "cut", "maskOffsetPx", "depthBias", "objects"] {
            parameter(&read, name);
        }
    }

    // A second run leaves what is there, makes what is missing, and another set does not go into the same folder.
    let gone = folder.join("smooth").join(pair.name());
    let kept = folder.join("detailed").join(pair.name()).join("depth.png");
    fs::remove_dir_all(&gone).unwrap();
    fs::write(&kept, b"kept").unwrap();
    set.write(&folder, Prior::ALL, 1, |_| {}).unwrap();
    let mixed = SceneSet::new(SEED + 1, 1).write(&folder, Prior::ALL, 1, |_| {}).unwrap_err();
    let (again, kept) = (gone.join("mesh.glb").is_file(), fs::read(&kept).unwrap());
    fs::remove_dir_all(&folder).unwrap();
    assert!(again);
    assert_eq!(kept, b"kept");
    assert_eq!(mixed.code, ErrorCode::InvalidArgument);
}

#[test]
fn priors_have_names() {
    assert_eq!(Prior::several("smooth"), Ok(vec![Prior::Smooth]));
    assert_eq!(Prior::several("both").unwrap(), Prior::ALL);
    assert_eq!(Prior::several("sharp").unwrap_err().code, ErrorCode::InvalidOption);
}

/// Distance of the vertices of a mesh from the nearest point of another one, metres.
fn distance(mesh: &Mesh, other: &Mesh) -> f32 {
    let tree = TriangleTree::new(other);
    let squared = mesh.positions().iter().map(|p| tree.nearest(*p).unwrap().distance_squared);
    squared.fold(f32::INFINITY, f32::min).sqrt()
}

#[test]
fn arranged_objects_are_held_as_their_scenes_say() {
    let set = SceneSet::arranged(3, 7);
    let mut stances = BTreeSet::new();
    let mut invented = 0;
    for index in 0..7 {
        let scene = set.scene(index).unwrap();
        assert!(scene.pairs.len() >= 2 && scene.pairs.len() <= set.pairs_of(index), "{index}");
        let lowest = |mesh: &Mesh| mesh.positions().iter().fold(f32::INFINITY, |low, p| low.min(p.z));
        for pair in &scene.pairs {
            let (name, low) = (pair.name(), lowest(&pair.object));
            stances.insert(pair.stance().as_str());
            match pair.below() {
                Below::Table => assert!(low.abs() < 1e-4, "{name}: {low}"),
                Below::Air => assert!(low > 0.04, "{name}: {low}"),
                Below::Board => {
                    assert!(low > -1e-4, "{name}: {low}");
                    assert!(distance(&pair.object, &scene.clutter) < 0.006, "{name}");
                }
                Below::Object(k) => {
                    assert!(low > -1e-4, "{name}: {low}");
                    if let Some(below) = scene.pairs.iter().find(|other| other.index == k) {
                        assert!(distance(&pair.object, &below.object) < 0.01, "{name} on {}", below.name());
                    }
                }
            }
            let case = pair.case(Prior::Detailed).unwrap();
            invented += usize::from(case.tags.contains(&"invented-underside".to_owned()));
        }
        for (i, pair) in scene.pairs.iter().enumerate() {
            for other in scene.pairs.iter().skip(i + 1) {
                // What is dropped touches cells, not points.
                let tree = TriangleTree::new(&other.object);
                let depth = |p: Vec3| tree.nearest(p).unwrap().distance_squared.sqrt();
                let within = points_within(&pair.object, &other.object);
                let deepest = within.into_iter().map(depth).fold(0.0, f32::max);
                assert!(deepest < 0.005, "{index}: {} is {deepest} m in {}", pair.name(), other.name());
            }
        }
        let again = set.scene(index).unwrap();
        assert_eq!(again.pairs[0].observation.depth().data(), scene.pairs[0].observation.depth().data());
    }
    assert!(stances.len() >= 5, "{stances:?}");
    assert!(invented > 0);
}

#[test]
fn the_placement_of_a_generator_is_compared_with_ours() {
    let folder = fresh("generators");
    let set = SceneSet::new(SEED, 1);
    let scene = set.scene(0).unwrap();
    scene.write(Prior::Smooth, &folder).unwrap();
    // The first object where it is, 8 % too large; the others without a placement.
    let first = listed(&folder.join("objects")).unwrap().into_iter().next().unwrap();
    let mut placement: serde_json::Value = serde_json::from_slice(&fs::read(first.join("gt.json")).unwrap()).unwrap();
    placement["scale"] = (1.08 * placement["scale"].as_f64().unwrap()).into();
    fs::write(first.join("initial.json"), placement.to_string()).unwrap();
    placement["scale"] = 1.0.into();
    fs::write(first.join("sam3d.json"), placement.to_string()).unwrap();
    let options = AlignOptions { quality: Quality::Fast, ..AlignOptions::default() };
    let records = PlacedScene::read(&folder).unwrap().records(&options).unwrap();
    assert_eq!(records.len(), scene.pairs.len());
    let [own, icp, aligned, told, _, together, together_told, stretched] = &records[0].1;
    let errors = |evaluation: &Option<Evaluation>| evaluation.as_ref().unwrap().errors.unwrap();
    assert!((errors(own).scale_error - 0.08).abs() < 1e-9 && errors(own).rotation_error_deg < 1e-6);
    // Rigid ICP keeps the scale.
    assert!((errors(icp).scale_error - 0.08).abs() < 1e-9);
    assert!([aligned, told, together, together_told, stretched].into_iter().all(Option::is_some));
    let untold = |(_, [own, icp, _, told, ..]): &(String, Record)| [own, icp, told].into_iter().all(Option::is_none);
    assert!(records[1..].iter().all(untold));
    let table = table(&records);
    assert_eq!(table.lines().count(), 2 + ROWS.len());
    assert!(table.contains("| the generator's own | 1 |"), "{table}");
    fs::remove_dir_all(&folder).unwrap();
}
