//! The parts of the search, against brute force and against the exact rasteriser.

use glam::{DQuat, DVec2, DVec3, Vec3};
use sim3align::evidence::observation::Observation;
use sim3align::geometry::cloud::Bounds;
use sim3align::geometry::decimate::decimate;
use sim3align::geometry::image::{DepthMap, Mask};
use sim3align::geometry::normal_equations::NormalEquations;
use sim3align::geometry::pinhole::Pinhole;
use sim3align::geometry::random::Random;
use sim3align::geometry::rasteriser::Rasteriser;
use sim3align::geometry::rotations::{angle_between, exp, super_fibonacci};
use sim3align::geometry::triangle_tree::TriangleTree;
use sim3align::precise::drawn::pose::{CropPose, MeshFrame};
use sim3align::precise::drawn::render::{Canvas, Model};
use sim3align::precise::observed::clean::CleanObservation;
use sim3align::precise::observed::grid::CropGrid;
use wasm_bindgen_test::wasm_bindgen_test;

use crate::shapes::{ellipsoid, mapped, sphere};

const WIDTH: usize = 160;
const HEIGHT: usize = 120;

/// A disc of `radius` pixels, half a metre away and curved, before a wall.
fn disc(radius: f64, mask_radius: f64) -> Observation {
    with_edge(mask_radius, |_| radius)
}

/// The same with an edge of depth whose radius depends on the direction.
fn with_edge(mask_radius: f64, radius: impl Fn(f64) -> f64) -> Observation {
    let camera = Pinhole::new(200.0, 200.0, 79.5, 59.5).unwrap();
    let distance = |i: usize| {
        let (u, v) = ((i % WIDTH) as f64 - 79.5, (i / WIDTH) as f64 - 59.5);
        (u * u + v * v).sqrt()
    };
    let angle = |i: usize| libm::atan2((i / WIDTH) as f64 - 59.5, (i % WIDTH) as f64 - 79.5);
    let pixels = 0..WIDTH * HEIGHT;
    let depth =
        pixels.clone().map(|i| if distance(i) < radius(angle(i)) { 0.5 + 1e-6 * distance(i) as f32 } else { 0.9 });
    let mask = pixels.map(|i| u8::from(distance(i) < mask_radius)).collect();
    let depth = DepthMap::from_metres(WIDTH, HEIGHT, depth.collect()).unwrap();
    Observation::new(depth, Mask::new("mask", WIDTH, HEIGHT, mask).unwrap(), camera).unwrap()
}

#[wasm_bindgen_test(unsupported = test)]
fn the_rim_of_the_mask_is_weighed_against_that_of_the_depth() {
    // An exact edge of depth counts, but masks are mostly right within a pixel.
    for (mask_radius, offset) in [(30.0, 0.0), (32.0, -2.0), (28.0, 2.0), (33.5, -3.5)] {
        let clean = CleanObservation::new(&disc(30.0, mask_radius));
        let moved = clean.rim_offset;
        let is_part = if offset == 0.0 { moved.abs() < 0.3 } else { (0.25..1.2).contains(&(moved / offset)) };
        assert!(is_part, "radius {mask_radius}: {moved}");
    }
    // One that wanders hardly counts: the same mean offset, and a scatter of pixels.
    let ragged = with_edge(30.0, |angle| 33.0 + 3.5 * libm::sin(17.0 * angle));
    let moved = CleanObservation::new(&ragged).rim_offset;
    assert!(moved.abs() < 0.6, "{moved}");
    // Nor does one that is seen on one side only: it may be shifted.
    let half = with_edge(30.0, |angle| if angle.abs() < 1.2 { 32.0 } else { 500.0 });
    let [half, whole] = [half, disc(32.0, 30.0)].map(|seen| CleanObservation::new(&seen).rim_offset);
    assert!(half.abs() < 0.7 * whole.abs(), "{half} of {whole}");
    // Nothing behind the object to tell it from: the mask stands.
    let flat = disc(500.0, 30.0);
    assert_eq!(CleanObservation::new(&flat).rim_offset, 0.0);
}

#[wasm_bindgen_test(unsupported = test)]
fn islands_and_pin_holes_go_and_parts_stay() {
    let observation = disc(30.0, 30.0);
    let paint = |points: &[(usize, usize, u8)]| {
        let mut mask = observation.mask().data().to_vec();
        points.iter().for_each(|&(u, v, value)| mask[v * WIDTH + u] = value);
        let mask = Mask::new("mask", WIDTH, HEIGHT, mask).unwrap();
        CleanObservation::new(&Observation::new(observation.depth().clone(), mask, observation.camera()).unwrap())
    };
    let plain = paint(&[]);
    let holes = paint(&[(80, 60, 0), (81, 60, 0), (70, 50, 0)]);
    assert_eq!(holes.pixels, plain.pixels, "pin-holes are filled");
    let island = paint(&[(3, 3, 1), (4, 3, 1), (3, 4, 1)]);
    assert_eq!(island.bounds, plain.bounds, "far islands are dropped");
}

/// Depth images of the quick rasteriser and of the exact one, on the same grid.
#[wasm_bindgen_test(unsupported = test)]
fn the_quick_rasteriser_draws_what_the_exact_one_does() {
    let body = mapped(&ellipsoid(Vec3::new(0.5, 0.35, 0.25), 16), |p| {
        p * (1.0 + 0.4 * libm::sinf(5.0 * p.x + 1.0) * libm::sinf(6.0 * p.y))
    });
    let frame = MeshFrame::of(&body);
    let model = Model::new(&frame.normalized(&body).unwrap());
    let clean = CleanObservation::new(&disc(30.0, 30.0));
    let (mut canvas, mut rasteriser) = (Canvas::default(), Rasteriser::new());
    for seed in 0..24 {
        let mut random = Random::new(seed, 77);
        let mut draw = |low: f64, high: f64| low + (high - low) * random.uniform();
        let grid = CropGrid::new(&clean, 200 + 100 * (seed as usize % 8));
        let pose = CropPose {
            rotation: super_fibonacci(seed as usize, 24),
            size: libm::log(draw(0.15, 0.7)),
            place: DVec2::new(draw(-0.1, 0.1), draw(-0.1, 0.1)),
            distance: draw(-1.0, 1.0),
        };
        canvas.draw(&model, &pose, &grid);
        let camera = Pinhole::new(grid.focal, grid.focal, grid.center[0], grid.center[1]).unwrap();
        rasteriser.render(&body, &pose.similarity(&frame), &camera, grid.width, grid.height);
        let (mut drawn, mut differing) = (0, 0);
        for (quick, exact) in canvas.inverse_depth.iter().zip(rasteriser.depth()) {
            drawn += usize::from(*exact > 0.0);
            let close = *quick > 0.0 && (quick * exact - 1.0).abs() < 0.02;
            differing += usize::from((*quick > 0.0 || *exact > 0.0) && !close);
        }
        assert!(drawn > 20, "seed {seed}: {drawn} cells");
        // Outlines fall on either side of a cell's centre.
        assert!(differing * 50 <= drawn + 50, "seed {seed}: {differing} of {drawn}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn poses_come_back_from_similarities() {
    let frame = MeshFrame { center: DVec3::new(3.0, -2.0, 7.0), diagonal: 2.5 };
    for i in 0..20 {
        let pose = CropPose {
            rotation: super_fibonacci(i, 20),
            size: -1.0 + 0.1 * i as f64,
            place: DVec2::new(0.2, -0.1),
            distance: 0.3 - 0.1 * i as f64,
        };
        let back = CropPose::of_similarity(&pose.similarity(&frame), &frame).unwrap();
        assert!(angle_between(pose.rotation, back.rotation) < 1e-7, "rotation {i}");
        assert!((pose.size - back.size).abs() < 1e-9 && (pose.distance - back.distance).abs() < 1e-9);
        assert!((pose.place - back.place).length() < 1e-9);
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn distance_leaves_the_silhouette_as_it_is() {
    let frame = MeshFrame { center: DVec3::ZERO, diagonal: 1.0 };
    let pose = CropPose { rotation: DQuat::IDENTITY, size: -1.0, place: DVec2::new(0.1, 0.2), distance: 0.0 };
    let farther = pose.moved(&[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.3]);
    let project = |pose: &CropPose, p: nalgebra::Vector3<f64>| {
        let x = pose.similarity(&frame).apply(p);
        (x.x / x.z, x.y / x.z)
    };
    for p in [[0.3, 0.1, -0.2], [-0.4, 0.2, 0.1]] {
        let (a, b) = (project(&pose, p.into()), project(&farther, p.into()));
        assert!((a.0 - b.0).abs() < 1e-12 && (a.1 - b.1).abs() < 1e-12);
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn rotations_cover_the_whole_of_so3() {
    let count = 1500;
    let grid: Vec<DQuat> = (0..count).map(|i| super_fibonacci(i, count)).collect();
    let mut random = Random::new(5, 78);
    let mut draw = || random.uniform() * 2.0 - 1.0;
    let mut worst = 0.0f64;
    for _ in 0..300 {
        let any = DQuat::from_xyzw(draw(), draw(), draw(), draw()).normalize();
        let nearest = grid.iter().map(|q| angle_between(*q, any)).fold(f64::INFINITY, f64::min);
        worst = worst.max(nearest.to_degrees());
    }
    assert!(worst < 19.0, "{worst}°");
}

#[wasm_bindgen_test(unsupported = test)]
fn exp_turns_by_the_length_of_its_vector() {
    for (angle, axis) in [(1e-12, DVec3::X), (0.3, DVec3::Y), (3.0, DVec3::new(0.6, 0.0, 0.8))] {
        assert!((angle_between(exp(axis * angle), DQuat::IDENTITY) - angle).abs() < 1e-12, "{angle}");
    }
    assert_eq!(exp(DVec3::ZERO), DQuat::IDENTITY);
}

#[wasm_bindgen_test(unsupported = test)]
fn decimated_meshes_keep_the_surface() {
    let ball = sphere(1.0, 120);
    for target in [200, 1000, 5000] {
        let coarse = decimate(&ball, target);
        let count = coarse.triangles().len();
        assert!(count * 4 <= target * 5 && count * 3 >= target, "{count} triangles of {target}");
        let tree = TriangleTree::new(&coarse);
        let far = ball.positions().iter().step_by(37).map(|p| tree.nearest(*p).unwrap().distance_squared.sqrt());
        let worst = far.fold(0.0, f32::max);
        // Twice the sagitta over the diagonal of a square of two triangles, for corners that are cut.
        let edge = (4.0 * core::f32::consts::PI / count as f32 * 2.3).sqrt();
        assert!(worst < edge * edge, "{target}: {worst} with edges of {edge}");
    }
    assert_eq!(decimate(&ball, 1_000_000), ball);
    // A plate of no thickness, and one vertex far away.
    let plate = mapped(&ball, |p| Vec3::new(p.x, p.y, 0.0));
    assert!(decimate(&plate, 300).triangles().len() <= 375);
    assert!(Bounds::of(decimate(&plate, 300).positions()).unwrap().extent().z == 0.0);
}

#[wasm_bindgen_test(unsupported = test)]
fn the_inverse_of_normal_equations_is_one() {
    let mut random = Random::new(9, 79);
    let mut equations = NormalEquations::new();
    let mut matrix = [[0.0; 7]; 7];
    for _ in 0..40 {
        let jacobian: [f64; 7] = core::array::from_fn(|_| random.uniform() - 0.5);
        equations.add(&jacobian, 0.0, 2.0);
        for (row, a) in matrix.iter_mut().zip(jacobian) {
            row.iter_mut().zip(jacobian).for_each(|(entry, b): (&mut f64, f64)| *entry += 2.0 * a * b);
        }
    }
    let inverse = equations.inverse(0.0).unwrap();
    for (i, row) in matrix.iter().enumerate() {
        for (j, column) in inverse.iter().enumerate() {
            let entry: f64 = row.iter().zip(column).map(|(a, b)| a * b).sum();
            assert!((entry - f64::from(u8::from(i == j))).abs() < 1e-9, "({i}, {j}): {entry}");
        }
    }
    assert!(NormalEquations::new().inverse(1e-9).is_none());
}
