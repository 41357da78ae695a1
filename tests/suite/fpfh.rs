//! FPFH: what it does not depend on, what it tells apart, and an independent slow implementation.

use sim3align::register::at_once::fpfh;
use sim3align::register::fpfh::{DIMENSION, Descriptor};

use crate::prelude::*;

fn descriptors(cloud: &Cloud, radius: f32) -> Vec<Descriptor> {
    fpfh(cloud, &KdTree::new(&cloud.points), radius)
}

/// Σ |a − b|, 6 at most.
fn difference(a: &Descriptor, b: &Descriptor) -> f32 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).sum()
}

/// Largest and mean difference.
fn differences(a: &[Descriptor], b: &[Descriptor]) -> (f32, f32) {
    assert_eq!(a.len(), b.len());
    let each: Vec<f32> = a.iter().zip(b).map(|(a, b)| difference(a, b)).collect();
    (each.iter().copied().fold(0.0, f32::max), each.iter().sum::<f32>() / each.len() as f32)
}

/// The definition (Rusu 2009, §III), point by point in f64, no tree and no cap on the neighbours.
fn slow(cloud: &Cloud, radius: f64) -> Vec<[f64; DIMENSION]> {
    let points: Vec<Vector3<f64>> = cloud.points.iter().map(|&p| vector3(p)).collect();
    let normals: Vec<Vector3<f64>> = cloud.normals.iter().map(|&n| vector3(n)).collect();
    let normalized = |histogram: [f64; DIMENSION]| {
        let mut out = histogram;
        for third in out.chunks_exact_mut(11) {
            let sum: f64 = third.iter().sum();
            third.iter_mut().for_each(|x| *x /= if sum > 0.0 { sum } else { 1.0 });
        }
        out
    };
    let near = |i: usize| {
        let points = &points;
        (0..points.len()).filter(move |&j| j != i && (points[j] - points[i]).norm() <= radius)
    };
    let spfh = |i: usize| {
        let mut histogram = [0.0; DIMENSION];
        for j in near(i) {
            let line = (points[j] - points[i]).normalize();
            // The frame stands where the normal makes the smaller angle with the line.
            let cosines = [normals[i].dot(&line).abs(), normals[j].dot(&line).abs()];
            let (u, n, d) =
                if cosines[0] >= cosines[1] { (normals[i], normals[j], line) } else { (normals[j], normals[i], -line) };
            let v = d.cross(&u).normalize();
            let w = u.cross(&v);
            let angles = [(v.dot(&n), 1.0), (u.dot(&d), 1.0), (w.dot(&n).atan2(u.dot(&n)), core::f64::consts::PI)];
            for (k, (value, most)) in angles.into_iter().enumerate() {
                let bin = ((value / most + 1.0) / 2.0 * 11.0).floor().clamp(0.0, 10.0) as usize;
                histogram[11 * k + bin] += 1.0;
            }
        }
        normalized(histogram)
    };
    let simple: Vec<_> = (0..points.len()).map(spfh).collect();
    (0..points.len())
        .map(|i| {
            let mut sum = [0.0; DIMENSION];
            for j in near(i) {
                let weight = 1.0 / (points[j] - points[i]).norm();
                sum.iter_mut().zip(&simple[j]).for_each(|(x, y)| *x += weight * y);
            }
            let mut both = normalized(sum);
            both.iter_mut().zip(&simple[i]).for_each(|(x, y)| *x += y);
            normalized(both)
        })
        .collect()
}

#[wasm_bindgen_test(unsupported = test)]
fn descriptors_are_those_of_the_definition() {
    for seed in 0..4 {
        let mut draw = Draw::new(seed);
        for (cloud, radius) in [(blob(&mut draw, 300), 0.4), (mug(&mut draw, 300), 0.35), (torus(&mut draw, 400), 0.3)]
        {
            let found = descriptors(&cloud, radius);
            let expected: Vec<Descriptor> =
                slow(&cloud, f64::from(radius)).iter().map(|d| d.map(|x| x as f32)).collect();
            // A pair on the edge between two bins may fall on either side in f32; such pairs are few.
            let (most, mean) = differences(&found, &expected);
            assert!(mean < 2e-3 && most < 0.3, "seed {seed}: mean {mean}, most {most}");
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn pose_and_scale_change_nothing() {
    for seed in 0..5 {
        let mut draw = Draw::new(seed);
        let cloud = blob(&mut draw, 500);
        let here = descriptors(&cloud, 0.3);
        let pose = draw.similarity([0.01, 100.0], 1.0);
        let there = descriptors(&transformed(&cloud, &pose), (0.3 * pose.scale) as f32);
        let (most, mean) = differences(&here, &there);
        assert!(mean < 5e-3 && most < 0.4, "seed {seed}: mean {mean}, most {most}");
        // Another radius, unscaled, would change a lot.
        let (_, mean) = differences(&here, &descriptors(&cloud, 0.6));
        assert!(mean > 0.1, "seed {seed}: mean {mean}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn the_order_of_the_points_does_not_matter() {
    for seed in 0..5 {
        let mut draw = Draw::new(seed);
        let cloud = mug(&mut draw, 400);
        let order = draw.permutation(cloud.len());
        let shuffled = cloud.select(order.iter().copied());
        let here = descriptors(&cloud, 0.25);
        let expected: Vec<Descriptor> = order.iter().map(|&i| here[i]).collect();
        let (most, _) = differences(&expected, &descriptors(&shuffled, 0.25));
        assert!(most < 1e-5, "seed {seed}: {most}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn shapes_differ() {
    let mut draw = Draw::new(2);
    // A point in the middle of a face, one on an edge, one in a corner of a box; one on a sphere, one on a torus' inside.
    let boxed = box_surface(&mut draw, [2.0, 2.0, 2.0], 6000);
    let sphere = sphere_surface(&mut draw, 2000);
    let torus = torus(&mut draw, 3000);
    let at = |cloud: &Cloud, place: Vec3| {
        let nearest = KdTree::new(&cloud.points).nearest(place).unwrap().index as usize;
        descriptors(cloud, 0.3)[nearest]
    };
    let places = [
        ("face", at(&boxed, Vec3::X)),
        ("edge", at(&boxed, Vec3::new(1.0, 1.0, 0.0))),
        ("corner", at(&boxed, Vec3::ONE)),
        ("sphere", at(&sphere, Vec3::X)),
        ("saddle", at(&torus, Vec3::X * 0.65)),
    ];
    for (i, (name, a)) in places.iter().enumerate() {
        for (other, b) in &places[..i] {
            assert!(difference(a, b) > 0.4, "{name} and {other}: {}", difference(a, b));
        }
    }
    // On a plane every angle is 0: one bin of each third, the middle one, holds all.
    let mut plane = [0.0; DIMENSION];
    [5, 16, 27].into_iter().for_each(|bin| plane[bin] = 1.0);
    assert!(difference(&places[0].1, &plane) < 1e-5, "{:?}", places[0].1);
    // The same place on another sampling of the same shape is alike.
    let again = at(&sphere_surface(&mut draw, 2000), Vec3::Y);
    assert!(difference(&places[3].1, &again) < 0.4);
}

#[wasm_bindgen_test(unsupported = test)]
fn each_third_sums_to_1() {
    let mut draw = Draw::new(3);
    let mut cloud = mug(&mut draw, 500);
    // One point apart, one pair apart, one point twice.
    cloud.points.extend([
        Vec3::splat(50.0),
        Vec3::splat(60.0),
        Vec3::splat(60.01),
        Vec3::splat(70.0),
        Vec3::splat(70.0),
    ]);
    cloud.normals.extend([Vec3::X, Vec3::X, Vec3::Y, Vec3::Z, Vec3::Z]);
    let found = descriptors(&cloud, 0.3);
    assert_eq!(found.len(), cloud.len());
    for (i, d) in found.iter().enumerate() {
        let alone = [500, 503, 504].contains(&i);
        for third in d.chunks_exact(11) {
            let sum: f32 = third.iter().sum();
            assert!((sum - if alone { 0.0 } else { 1.0 }).abs() < 1e-5, "point {i}: {d:?}");
            assert!(third.iter().all(|&x| x >= 0.0), "point {i}: {d:?}");
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn normals_that_are_unknown_say_nothing() {
    let mut draw = Draw::new(4);
    let cloud = mug(&mut draw, 200);
    let blind = Cloud { normals: vec![Vec3::ZERO; cloud.len()], ..cloud.clone() };
    let without = Cloud::from_points(cloud.points.clone());
    for cloud in [blind, without] {
        assert!(descriptors(&cloud, 0.3).iter().all(|d| *d == [0.0; DIMENSION]));
    }
    assert!(descriptors(&Cloud::default(), 0.3).is_empty());
    for radius in [0.0, f32::NAN] {
        assert!(descriptors(&cloud, radius).iter().all(|d| *d == [0.0; DIMENSION]), "{radius}");
    }
    // Points one above the other along their normals have no frame, in any pose.
    for seed in 0..50 {
        let n = Draw::new(seed).direction();
        let n = Vec3::new(n.x as f32, n.y as f32, n.z as f32);
        let stack = Cloud { points: vec![n * 0.1, n * 0.2], normals: vec![n, n] };
        assert_eq!(descriptors(&stack, 0.3), [[0.0; DIMENSION]; 2], "seed {seed}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn crowded_neighbourhoods_count_the_nearest() {
    // 1000 points within the radius: the far ones, of a wall, are not among the nearest 128.
    let mut draw = Draw::new(6);
    let mut cloud = Cloud::default();
    for i in 0..1000 {
        let p = draw.cube(0.1);
        let wall = i % 2 == 0;
        cloud.points.push(Vec3::new(p.x as f32, p.y as f32, 0.0) + if wall { Vec3::Z } else { Vec3::ZERO });
        cloud.normals.push(if wall { Vec3::X } else { Vec3::Z });
    }
    let crowded = descriptors(&cloud, 10.0);
    let floor = cloud.select((0..1000).filter(|i| i % 2 == 1));
    for (a, b) in crowded.iter().skip(1).step_by(2).zip(descriptors(&floor, 0.5)) {
        assert!(difference(a, &b) < 1e-4, "{a:?} {b:?}");
    }
}
