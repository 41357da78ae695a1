//! Planes of depth maps: made ones are found, with noise, on several levels, and where there is none.

use sim3align::scene::plane::Plane;
use sim3align::scene::planes::{find_planes, union_of};

use crate::prelude::*;

const WIDTH: usize = 160;
const HEIGHT: usize = 120;

fn camera() -> Pinhole {
    Pinhole::new(150.0, 150.0, 79.5, 59.5).unwrap()
}

/// The depth at which each pixel meets the nearest of these planes, with noise relative to the depth.
fn depth_of(planes: &[Plane], noise: f64, random: &mut Random) -> DepthMap {
    let depth = (0..WIDTH * HEIGHT).map(|i| {
        let ray = camera().back_project((i % WIDTH) as f64, (i / WIDTH) as f64, 1.0).as_dvec3();
        let met = planes.iter().map(|plane| -plane.d / plane.normal.dot(ray)).filter(|z| *z > 0.0 && *z < 4.0);
        let z = met.fold(f64::INFINITY, f64::min);
        let error = (random.uniform() + random.uniform() + random.uniform() - 1.5) * noise;
        if z.is_finite() { (z * (1.0 + error)) as f32 } else { 0.0 }
    });
    DepthMap::from_metres(WIDTH, HEIGHT, depth.collect()).unwrap()
}

fn nothing_taken() -> Mask {
    Image::filled(WIDTH, HEIGHT, 0)
}

fn errors(found: &Plane, truth: &Plane) -> [f64; 2] {
    let angle = found.normal.cross(truth.normal).length().asin().to_degrees();
    // Where the camera looks.
    let at = DVec3::new(0.0, 0.0, -truth.d / truth.normal.z);
    [angle, (found.height(at) - truth.height(at)).abs()]
}

#[wasm_bindgen_test(unsupported = test)]
fn slanted_planes_are_found_in_noise() {
    for seed in 0..12u64 {
        let mut random = Random::new(seed, 900);
        let mut between = |low: f64, high: f64| low + (high - low) * random.uniform();
        let normal = DVec3::new(between(-0.5, 0.5), between(-1.0, -0.4), between(-1.0, -0.4));
        let truth = Plane::new(normal, between(0.4, 1.2) * normal.length()).unwrap();
        let depth = depth_of(&[truth], 0.004, &mut random);
        let planes = find_planes(&depth, &camera(), &nothing_taken(), seed);
        let [angle, offset] = errors(&planes[0].plane, &truth);
        assert!(angle < 0.3 && offset < 0.002, "seed {seed}: {angle}°, {offset} m");
        assert!(planes[0].share > 0.9, "seed {seed}: {}", planes[0].share);
        assert_eq!(planes, find_planes(&depth, &camera(), &nothing_taken(), seed), "seed {seed}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn a_table_over_a_floor_and_a_wall_are_three_planes() {
    let up = DVec3::new(0.05, -0.8, -0.6).normalize();
    let floor = Plane { normal: up, d: 1.3 };
    let table = Plane { normal: up, d: 0.6 };
    let wall = Plane { normal: DVec3::new(0.0, 0.6, -0.8).normalize(), d: 1.8 };
    let mut random = Random::new(5, 901);
    let mut depth = depth_of(&[floor, wall], 0.002, &mut random);
    let over = depth_of(&[table], 0.002, &mut random);
    // The table fills the left third of the image.
    for (i, z) in depth.data_mut().iter_mut().enumerate().filter(|(i, _)| i % WIDTH < WIDTH / 3) {
        *z = over.data()[i];
    }
    let planes = find_planes(&depth, &camera(), &nothing_taken(), 0);
    for (name, truth) in [("floor", floor), ("table", table), ("wall", wall)] {
        let is_found = planes.iter().any(|found| {
            let [angle, offset] = errors(&found.plane, &truth);
            angle < 1.0 && offset < 0.005
        });
        assert!(is_found, "{name}: {planes:?}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn a_ball_has_no_plane_and_objects_are_left_out() {
    // A ball that fills the image.
    let depth = (0..WIDTH * HEIGHT).map(|i| {
        let [u, v] = [(i % WIDTH) as f32 - 79.5, (i / WIDTH) as f32 - 59.5];
        let squared = (u * u + v * v) / 12_000.0;
        1.2 - 0.7 * (1.0 - squared).max(0.0).sqrt()
    });
    let depth = DepthMap::from_metres(WIDTH, HEIGHT, depth.collect()).unwrap();
    let planes = find_planes(&depth, &camera(), &nothing_taken(), 0);
    assert!(planes.iter().all(|found| found.share < 0.5), "{planes:?}");

    let truth = Plane { normal: DVec3::NEG_Z, d: 1.0 };
    let mut random = Random::new(1, 902);
    let flat = depth_of(&[truth], 0.0, &mut random);
    let mut mask = nothing_taken();
    mask.data_mut()[30 * WIDTH + 40] = 1;
    let taken = union_of(WIDTH, HEIGHT, [&mask].into_iter());
    // The pixel, and two on each side.
    assert_eq!(taken.data().iter().map(|t| usize::from(*t)).sum::<usize>(), 25);
    let everything: Mask = Image::filled(WIDTH, HEIGHT, 1);
    assert!(find_planes(&flat, &camera(), &everything, 0).is_empty());
}

#[wasm_bindgen_test(unsupported = test)]
fn planes_face_the_camera() {
    let plane = Plane::through(
        [Vec3::new(0.0, 0.5, 1.0), Vec3::new(1.0, 0.5, 1.0), Vec3::new(0.0, 0.5, 2.0)].map(Vec3::as_dvec3),
    );
    let plane = plane.unwrap();
    assert!((plane.normal - DVec3::NEG_Y).length() < 1e-12 && (plane.d - 0.5).abs() < 1e-12, "{plane:?}");
    assert!((plane.height(DVec3::new(3.0, 0.1, 5.0)) - 0.4).abs() < 1e-12);
    assert!(Plane::through([DVec3::ZERO, DVec3::X, DVec3::X * 2.0]).is_none());
}
