//! Errors of layout: overlap of boxes, the rotation that ICP needs, ADD-S in both directions, and the rule of CAD alignment.

use sim3align::metrics::layout::LayoutErrors;
use sim3align::metrics::oriented_box::OrientedBox;
use sim3align::metrics::pose_error::PoseComparison;

use crate::prelude::*;

const UNIT: Bounds = Bounds { min: Vec3::splat(-0.5), max: Vec3::splat(0.5) };

fn moved(x: f64, y: f64, z: f64) -> Similarity {
    Similarity { translation: Vector3::new(x, y, z), ..Similarity::identity() }
}

fn random_pose(random: &mut Random, shift: f64) -> Similarity {
    let mut uniform = || 2.0 * random.uniform() - 1.0;
    Similarity {
        scale: 1.0 + 0.3 * uniform(),
        rotation: Rotation3::new(Vector3::from_fn(|_, _| 3.0 * uniform())),
        translation: Vector3::from_fn(|_, _| shift * uniform()),
    }
}

fn layout(mesh: &Mesh, estimate: &Similarity, truth: &Similarity, symmetry: &Symmetry) -> LayoutErrors {
    let comparison = PoseComparison::new(mesh, estimate, truth, symmetry).unwrap();
    LayoutErrors::of(&comparison, &comparison.errors().unwrap()).unwrap()
}

#[wasm_bindgen_test(unsupported = test)]
fn overlaps_that_are_known() {
    let still = OrientedBox::of(&UNIT, &Similarity::identity());
    let overlap = |pose: &Similarity| still.intersection(&OrientedBox::of(&UNIT, pose));
    let eighth =
        Similarity { rotation: Rotation3::new(Vector3::z() * core::f64::consts::FRAC_PI_4), ..Similarity::identity() };
    let quarter =
        Similarity { rotation: Rotation3::new(Vector3::y() * core::f64::consts::FRAC_PI_2), ..Similarity::identity() };
    for (pose, volume) in [
        (Similarity::identity(), 1.0),
        (quarter, 1.0),
        (moved(0.5, 0.0, 0.0), 0.5),
        (moved(0.5, -0.25, 0.1), 0.5 * 0.75 * 0.9),
        // They touch: a face, an edge, a corner.
        (moved(1.0, 0.0, 0.0), 0.0),
        (moved(1.0, 1.0, 0.0), 0.0),
        (moved(-1.0, 1.0, 1.0), 0.0),
        (moved(3.0, 0.0, 0.0), 0.0),
        // One inside the other, and one on a face of the other.
        (Similarity { scale: 0.5, ..moved(0.1, 0.0, 0.2) }, 0.125),
        (Similarity { scale: 0.5, ..moved(0.25, 0.0, 0.0) }, 0.125),
        (Similarity { scale: 2.0, ..moved(0.5, 0.5, 0.5) }, 1.0),
        // A regular octagon.
        (eighth, 2.0 * (2.0f64.sqrt() - 1.0)),
    ] {
        assert!((overlap(&pose) - volume).abs() < 1e-9, "{pose:?}: {} instead of {volume}", overlap(&pose));
    }
    assert!((still.iou(&still) - 1.0).abs() < 1e-9);
    assert!((still.iou(&OrientedBox::of(&UNIT, &moved(0.5, 0.0, 0.0))) - 1.0 / 3.0).abs() < 1e-9);
    let flat = OrientedBox::of(&Bounds { min: Vec3::ZERO, max: Vec3::new(1.0, 1.0, 0.0) }, &Similarity::identity());
    assert_eq!((flat.iou(&flat), flat.iou(&still)), (0.0, 0.0));
}

#[wasm_bindgen_test(unsupported = test)]
fn overlaps_are_those_of_random_points() {
    const POINTS: usize = 40_000;
    for seed in 0..60 {
        let mut random = Random::new(seed, 31);
        let bounds = |random: &mut Random| {
            let half = Vec3::from_array(core::array::from_fn(|_| (0.2 + random.uniform()) as f32));
            Bounds { min: -half, max: half }
        };
        let (first, second) = (bounds(&mut random), bounds(&mut random));
        let poses = [random_pose(&mut random, 0.0), random_pose(&mut random, 0.8)];
        let boxes = [OrientedBox::of(&first, &poses[0]), OrientedBox::of(&second, &poses[1])];
        let (low, high) = (vector3(second.min), vector3(second.max));
        let mut inside = 0;
        for _ in 0..POINTS {
            let point = poses[0].apply(Vector3::from_fn(|i, _| {
                f64::from(first.min[i]) + f64::from(first.extent()[i]) * random.uniform()
            }));
            let point = poses[1].inverse().apply(point);
            inside += usize::from((0..3).all(|i| point[i] >= low[i] && point[i] <= high[i]));
        }
        let share = inside as f64 / POINTS as f64;
        let found = boxes[0].intersection(&boxes[1]) / boxes[0].volume();
        // Five standard deviations.
        let noise = 5.0 * (share * (1.0 - share) / POINTS as f64).sqrt() + 1e-4;
        assert!((found - share).abs() < noise, "seed {seed}: {found} instead of {share}");
        let back = boxes[1].intersection(&boxes[0]);
        assert!((back - boxes[0].intersection(&boxes[1])).abs() < 1e-9, "seed {seed}");
        // The same in any common frame.
        let frame = random_pose(&mut random, 2.0);
        let framed = [0, 1].map(|i| OrientedBox::of([&first, &second][i], &frame.compose(&poses[i])));
        assert!((framed[0].iou(&framed[1]) - boxes[0].iou(&boxes[1])).abs() < 1e-9, "seed {seed}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn the_truth_is_a_perfect_layout() {
    let mesh = mapped(&ellipsoid(Vec3::new(1.0, 0.6, 0.3), 30), |p| p + Vec3::new(3.0, 0.0, 1.0));
    let pose = Similarity { scale: 0.1, ..random_pose(&mut Random::new(1, 2), 1.0) };
    let found = layout(&mesh, &pose, &pose, &Symmetry::None);
    assert!((found.box_iou - 1.0).abs() < 1e-9 && found.is_cad_aligned, "{found:?}");
    assert!(found.icp_rotation_deg < 0.01 && found.add_s_relative < 1e-6, "{found:?}");
}

#[wasm_bindgen_test(unsupported = test)]
fn icp_finds_the_turn_that_the_shape_shows() {
    let turn = |axis: Vector3<f64>, degrees: f64| Similarity {
        rotation: Rotation3::new(axis * degrees.to_radians()),
        ..Similarity::identity()
    };
    let found =
        |mesh: &Mesh, pose: &Similarity| layout(mesh, pose, &Similarity::identity(), &Symmetry::None).icp_rotation_deg;
    let brick = cuboid(Vec3::new(1.0, 2.0, 3.0));
    for degrees in [5.0, 15.0, 25.0] {
        let turned = found(&brick, &turn(Vector3::new(1.0, 1.0, 0.5).normalize(), degrees));
        assert!((turned - degrees).abs() < 0.1, "{turned} instead of {degrees}");
    }
    // After half a turn, a brick looks the same; a ball does after any.
    assert!(found(&brick, &turn(Vector3::y(), 180.0)) < 0.01);
    let turned = found(&brick, &turn(Vector3::y(), 170.0));
    assert!((turned - 10.0).abs() < 0.1, "{turned}");
    assert!(found(&sphere(1.0, 24), &turn(Vector3::x(), 57.0)) < 0.5);
    // A shift is none, nor is a size, up to the unevenness of the samples.
    assert!(found(&brick, &moved(0.3, 0.0, 0.2)) < 0.2);
    let turned = found(&brick, &Similarity { scale: 1.1, ..Similarity::identity() });
    assert!(turned < 1.0, "{turned}");
}

/// ICP with the closed form of Umeyama in each iteration, over all samples, until it stands still.
fn icp_oracle(mesh: &Mesh, estimate: &Similarity, truth: &Similarity) -> f64 {
    let tree = TriangleTree::new(mesh);
    let points = sample_surface(mesh, 1000, 5).unwrap().points;
    let start = truth.inverse().compose(estimate);
    let mut total = Similarity::identity();
    for _ in 0..500 {
        let pairs: Vec<Pair> = points
            .iter()
            .map(|p| {
                let source = total.compose(&start).apply(vector3(*p));
                let target = vector3(tree.nearest(vec3(&source)).unwrap().point);
                Pair { source, target, weight: 1.0 }
            })
            .collect();
        let step = umeyama(pairs.into_iter(), ScaleMode::Fixed(1.0)).unwrap();
        total = step.compose(&total);
        if Similarity::identity().rotation_angle_to(&step) < 1e-6 && step.translation.norm() < 1e-6 {
            break;
        }
    }
    Similarity::identity().rotation_angle_to(&total).to_degrees()
}

#[wasm_bindgen_test(unsupported = test)]
fn icp_ends_where_its_closed_form_does() {
    let shapes = [cuboid(Vec3::new(1.0, 1.6, 0.4)), ellipsoid(Vec3::new(0.5, 0.8, 1.2), 16)];
    for seed in 0..8 {
        let mut random = Random::new(seed, 77);
        let mesh = &shapes[seed as usize % 2];
        let truth = random_pose(&mut random, 0.5);
        let mut uniform = |size: f64| size * (2.0 * random.uniform() - 1.0);
        let change = Similarity {
            scale: 1.0 + uniform(0.1),
            rotation: Rotation3::new(Vector3::from_fn(|_, _| uniform(0.3))),
            translation: Vector3::from_fn(|_, _| uniform(0.1)),
        };
        let estimate = truth.compose(&change);
        let found = layout(mesh, &estimate, &truth, &Symmetry::None).icp_rotation_deg;
        let expected = icp_oracle(mesh, &estimate, &truth);
        assert!((found - expected).abs() < 0.5, "seed {seed}: {found}, expected {expected}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn add_s_counts_both_directions_by_the_diameter() {
    // Of concentric balls, every point is as far from the other as the radii differ.
    let ball = sphere(1.0, 40);
    let truth = Similarity { scale: 0.5, ..moved(0.0, 0.0, 2.0) };
    let found = layout(&ball, &Similarity { scale: 0.4, ..truth }, &truth, &Symmetry::None);
    assert!((found.add_s_relative - 0.1).abs() < 2e-3, "{found:?}");
    let is_found = |scale| layout(&ball, &Similarity { scale, ..truth }, &truth, &Symmetry::None).is_found;
    // The radii differ by 9 and 11 % of the diameter.
    assert!(is_found(0.5 - 0.09) && !is_found(0.5 - 0.11) && is_found(0.5 + 0.09) && !is_found(0.5 + 0.11));
    assert!((found.box_iou - 0.8f64.powi(3)).abs() < 1e-9, "{found:?}");
}

#[wasm_bindgen_test(unsupported = test)]
fn the_rule_of_cad_alignment_has_three_bounds() {
    let brick = cuboid(Vec3::new(1.0, 2.0, 3.0));
    let truth = Similarity { scale: 0.5, ..moved(0.3, 0.0, 2.0) };
    let aligned = |estimate: &Similarity| layout(&brick, estimate, &truth, &Symmetry::Auto).is_cad_aligned;
    let turned =
        |degrees: f64| Similarity { rotation: Rotation3::new(Vector3::x() * f64::to_radians(degrees)), ..truth };
    assert!(aligned(&turned(19.9)) && !aligned(&turned(20.1)));
    assert!(aligned(&turned(180.0)), "a symmetry is excused");
    assert!(!aligned(&turned(90.0)));
    let scaled = |factor: f64| Similarity { scale: factor * truth.scale, ..truth };
    assert!(aligned(&scaled(1.19)) && !aligned(&scaled(1.21)) && aligned(&scaled(0.81)) && !aligned(&scaled(0.79)));
    let shifted = |x: f64| Similarity { translation: truth.translation + Vector3::new(x, 0.0, 0.0), ..truth };
    assert!(aligned(&shifted(0.199)) && !aligned(&shifted(0.201)));
}
