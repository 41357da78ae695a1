//! Support by hand: distance, angle, unknown normals.

use sim3align::register::support::{Support, SupportSettings, supported};

use crate::prelude::*;

fn support(source: &Cloud, target: &Cloud, pose: &Similarity, max_distance: f32, min_cosine: f32) -> Vec<Support> {
    supported(source, target, &KdTree::new(&target.points), pose, &SupportSettings { max_distance, min_cosine })
}

fn sources(found: &[Support]) -> Vec<u32> {
    found.iter().map(|s| s.source).collect()
}

/// One target point at the origin that looks along z.
fn one_target() -> Cloud {
    Cloud { points: vec![Vec3::ZERO], normals: vec![Vec3::Z] }
}

#[wasm_bindgen_test(unsupported = test)]
fn points_need_a_target_within_the_distance() {
    let points = [0.0, 0.5, 0.99, 1.0, 1.01, 5.0].map(|x| Vec3::new(x, 0.0, 0.0)).to_vec();
    let source = Cloud { normals: vec![Vec3::Z; points.len()], points };
    let identity = Similarity::identity();
    assert_eq!(sources(&support(&source, &one_target(), &identity, 1.0, 0.5)), [0, 1, 2, 3]);
    assert_eq!(sources(&support(&source, &one_target(), &identity, 0.0, 0.5)), [0]);
    assert_eq!(sources(&support(&source, &one_target(), &identity, f32::INFINITY, 0.5)), [0, 1, 2, 3, 4, 5]);
    // The distance is in the target's frame.
    let doubled = Similarity { scale: 2.0, ..identity };
    assert_eq!(sources(&support(&source, &one_target(), &doubled, 1.0, 0.5)), [0, 1]);
}

#[wasm_bindgen_test(unsupported = test)]
fn normals_need_to_agree() {
    let degrees = [0.0, 59.0, 61.0, 90.0, 119.0, 121.0, 180.0];
    let normals: Vec<Vec3> =
        degrees.map(|d: f64| vec3(&(Rotation3::new(Vector3::x() * d.to_radians()) * Vector3::z()))).to_vec();
    let source = Cloud { points: vec![Vec3::ZERO; normals.len()], normals };
    let identity = Similarity::identity();
    let within = |cosine: f32| sources(&support(&source, &one_target(), &identity, 1.0, cosine));
    assert_eq!(within(0.5), [0, 1]);
    assert_eq!(within(-0.5), [0, 1, 2, 3, 4]);
    assert_eq!(within(-1.0), [0, 1, 2, 3, 4, 5, 6]);
    // Normals turn with the pose: a quarter turn about x brings the fourth to the front, whatever the scale.
    let turned =
        Similarity { rotation: Rotation3::new(-Vector3::x() * core::f64::consts::FRAC_PI_2), scale: 7.0, ..identity };
    assert_eq!(sources(&support(&source, &one_target(), &turned, 1.0, 0.8)), [1, 2, 3, 4, 5]);
}

#[wasm_bindgen_test(unsupported = test)]
fn asking_for_no_angle_asks_for_none() {
    // Opposite normals whose product rounds to less than −1.
    let mut draw = Draw::new(5);
    let normals: Vec<Vec3> = (0..500).map(|_| vec3(&draw.direction()) * (1.0 + 2e-7)).collect();
    assert!(normals.iter().any(|n| -n.dot(*n) < -1.0));
    let points = draw.points(500, 1.0);
    let target = Cloud { points: points.clone(), normals: normals.iter().map(|&n| -n).collect() };
    let source = Cloud { points, normals };
    let tree = KdTree::new(&target.points);
    let found = supported(&source, &target, &tree, &Similarity::identity(), &SupportSettings::EVERYTHING);
    assert_eq!(found.len(), 500);
}

#[wasm_bindgen_test(unsupported = test)]
fn unknown_normals_are_not_held_against_a_point() {
    let known = Cloud { points: vec![Vec3::ZERO; 2], normals: vec![-Vec3::Z, Vec3::Z] };
    let unknown = Cloud { normals: vec![Vec3::ZERO; 2], ..known.clone() };
    let without = Cloud { normals: Vec::new(), ..known.clone() };
    let identity = Similarity::identity();
    let blind = Cloud { points: vec![Vec3::ZERO], normals: vec![Vec3::ZERO] };
    assert_eq!(sources(&support(&known, &one_target(), &identity, 1.0, 0.5)), [1]);
    assert_eq!(sources(&support(&unknown, &one_target(), &identity, 1.0, 0.5)), [0, 1]);
    assert_eq!(sources(&support(&without, &one_target(), &identity, 1.0, 0.5)), [0, 1]);
    assert_eq!(sources(&support(&known, &blind, &identity, 1.0, 0.5)), [0, 1]);
    assert!(support(&known, &Cloud::default(), &identity, 1.0, 0.5).is_empty());
    assert!(support(&Cloud::default(), &known, &identity, 1.0, 0.5).is_empty());
}

#[wasm_bindgen_test(unsupported = test)]
fn support_is_the_nearest_target_under_the_pose() {
    for seed in 0..10 {
        let mut draw = Draw::new(seed);
        let (source, target) = (blob(&mut draw, 200), blob(&mut draw, 300));
        let pose = Similarity { scale: 1.1, rotation: draw.rotation_by(0.3), translation: draw.cube(0.1) };
        let (distance, cosine) = (0.15, 0.7);
        let found = support(&source, &target, &pose, distance, cosine);
        let mut expected = Vec::new();
        for (i, p) in source.points.iter().enumerate() {
            let landed = pose.to_f32().apply(*p);
            let nearest = (0..300).min_by(|&a, &b| {
                target.points[a].distance_squared(landed).total_cmp(&target.points[b].distance_squared(landed))
            });
            let j = nearest.unwrap();
            let near = target.points[j].distance_squared(landed) <= distance * distance;
            if near && pose.to_f32().rotate(source.normals[i]).dot(target.normals[j]) >= cosine {
                expected.push(Support { source: i as u32, target: j as u32, landed });
            }
        }
        assert_eq!(found, expected, "seed {seed}");
        assert!(found.len() > 50 && found.len() < 200, "seed {seed}: {}", found.len());
    }
}
