//! Boxes, the scale between them, and the way into the normalised frames and back.

use sim3align::evidence::extents::{Extents, initial_scale, target_from_source};

use crate::prelude::*;

#[wasm_bindgen_test(unsupported = test)]
fn normalised_clouds_fill_a_centred_box_of_diagonal_1() {
    for seed in 0..50 {
        let mut draw = Draw::new(seed);
        let cloud = transformed(&blob(&mut draw, 200), &draw.similarity([0.01, 100.0], 100.0));
        let unit = Extents::of("depth", &cloud.points).unwrap().normalized(&cloud);
        let bounds = Bounds::of(&unit.points).unwrap();
        assert!((bounds.diagonal() - 1.0).abs() < 1e-6 && bounds.center().length() < 1e-6, "seed {seed}: {bounds:?}");
        assert_eq!(unit.normals, cloud.normals, "seed {seed}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn the_initial_scale_is_the_ratio_of_the_diagonals() {
    // 3-4-12 has diagonal 13.
    let source = [Vec3::ZERO, Vec3::new(3.0, 4.0, 12.0)];
    let target = [Vec3::splat(5.0), Vec3::new(5.0, 5.0, 31.0), Vec3::new(5.0, 6.0, 6.0)];
    let (source, target) = (Extents::of("mesh", &source).unwrap(), Extents::of("depth", &target).unwrap());
    assert_eq!(source.diagonal(), 13.0);
    assert_eq!(initial_scale(&target, &source), f64::sqrt(26.0 * 26.0 + 1.0) / 13.0);
    assert_eq!(initial_scale(&target.with_diagonal(26.0), &source), 2.0);
}

#[wasm_bindgen_test(unsupported = test)]
fn identity_between_the_frames_is_the_initial_scale_between_the_clouds() {
    for seed in 0..50 {
        let mut draw = Draw::new(seed);
        let (a, b) = (draw.points(20, 3.0), draw.points(30, 0.2));
        let (source, target) = (Extents::of("mesh", &a).unwrap(), Extents::of("depth", &b).unwrap());
        let whole = target_from_source(&target, &Similarity::identity(), &source);
        assert!((whole.scale / initial_scale(&target, &source) - 1.0).abs() < 1e-15, "seed {seed}");
        assert_eq!(whole.rotation, Rotation3::identity());
        let middle = |points: &[Vec3]| vector3(Bounds::of(points).unwrap().center());
        assert!((whole.apply(middle(&a)) - middle(&b)).norm() < 1e-6, "seed {seed}");

        // Any transform between the frames: into the source's, across, out of the target's.
        let unit = draw.similarity([0.5, 1.5], 0.3);
        let x = draw.cube(3.0);
        let by_hand = target.unit_from_own().inverse().apply(unit.apply(source.unit_from_own().apply(x)));
        assert!((target_from_source(&target, &unit, &source).apply(x) - by_hand).norm() < 1e-12, "seed {seed}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn far_coordinates_keep_their_digits() {
    // A metre-sized cloud in a map frame, to a tenth of a millimetre.
    let mut draw = Draw::new(1);
    let (origin, cloud) = (Vector3::new(4.5e5, 5.4e6, 210.0), draw.points(100, 1.0));
    let flat: Vec<f64> = cloud.iter().flat_map(|&p| (vector3(p) + origin).data.0[0]).collect();
    let extents = Extents::of_flat("source", &flat).unwrap();
    let near = Extents::of("source", &cloud).unwrap();
    assert!((extents.diagonal() - near.diagonal()).abs() < 1e-8);
    let unit = near.normalized(&Cloud::from_points(cloud));
    for (p, q) in extents.normalized_flat(&flat).points.iter().zip(unit.points) {
        assert!(p.distance(q) < 1e-6, "{p} {q}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn boxes_without_size_are_refused() {
    let code = |points: &[Vec3]| {
        let flat: Vec<f64> = points.iter().flat_map(|p| p.to_array()).map(f64::from).collect();
        let error = Extents::of("depth", points).unwrap_err();
        assert_eq!(error.argument, "depth");
        assert_eq!(Extents::of_flat("depth", &flat).unwrap_err().code, error.code);
        error.code
    };
    assert_eq!(code(&[]), ErrorCode::TooFewPoints);
    assert_eq!(code(&[Vec3::ONE]), ErrorCode::DegeneratePoints);
    assert_eq!(code(&[Vec3::ONE; 5]), ErrorCode::DegeneratePoints);
    assert_eq!(code(&[Vec3::ONE, Vec3::INFINITY]), ErrorCode::DegeneratePoints);
    assert_eq!(code(&[Vec3::INFINITY, Vec3::INFINITY]), ErrorCode::DegeneratePoints);
    // The widest box of f32 and the narrowest are boxes.
    assert!(Extents::of("depth", &[Vec3::splat(f32::MIN), Vec3::splat(f32::MAX)]).is_ok());
    let tiny = Extents::of("depth", &[Vec3::ZERO, Vec3::splat(f32::from_bits(1))]).unwrap();
    assert!(tiny.unit_from_own().scale.is_finite());
    assert_eq!(
        Extents::of_flat("source", &[0.0, 0.0, 0.0, 1e-200, 0.0, 0.0]).unwrap_err().code,
        ErrorCode::DegeneratePoints
    );
    assert_eq!(
        Extents::of_flat("source", &[0.0, 0.0, 0.0, 1e200, 0.0, 0.0]).unwrap_err().code,
        ErrorCode::DegeneratePoints
    );
}
