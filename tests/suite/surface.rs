//! Points against surfaces at known distances.

use sim3align::evidence::{Evidence, Normals};
use sim3align::metrics::surface::{SurfaceAgreement, surface_agreement};

use crate::prelude::*;

/// The square of edge 2 about the origin, in z = 0.
fn square() -> Mesh {
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let positions = corners.iter().map(|&[x, y]| Vec3::new(x, y, 0.0)).collect();
    Mesh::new(positions, vec![[0, 1, 2], [0, 2, 3]]).unwrap()
}

/// 21 × 21 points on that square, `height` above it.
fn grid(height: f32) -> Vec<Vec3> {
    (0..441).map(|i| Vec3::new((i % 21 - 10) as f32 * 0.1, (i / 21 - 10) as f32 * 0.1, height)).collect()
}

fn close(found: Option<f64>, expected: f64) -> bool {
    found.is_some_and(|f| (f - expected).abs() < 1e-5 * (1.0 + expected))
}

fn agreement_of(points: &[Vec3], mesh: &Mesh, samples: &Cloud, camera_from_mesh: &Similarity) -> SurfaceAgreement {
    let evidence = Evidence::new(Cloud::from_points(points.to_vec()), samples.clone(), Normals::All);
    surface_agreement(&evidence, mesh, camera_from_mesh)
}

#[wasm_bindgen_test(unsupported = test)]
fn parallel_planes_are_as_far_apart_as_they_are() {
    let pose = similarity(0.2, [0.5, -1.0, 0.8], [0.1, -0.2, 1.5]);
    let posed = |points: Vec<Vec3>| -> Vec<Vec3> { points.iter().map(|p| vec3(&pose.apply(vector3(*p)))).collect() };
    let samples = Cloud::from_points(grid(0.0));
    for height in [0.0, 0.05, 0.3] {
        let agreement = agreement_of(&posed(grid(height)), &square(), &samples, &pose);
        let expected = 0.2 * f64::from(height);
        assert!(close(agreement.points_to_surface, expected), "{height}: {agreement:?}");
        assert!(close(agreement.surface_to_points, expected), "{height}: {agreement:?}");
        assert!(close(agreement.normal_consistency, 1.0), "{height}: {agreement:?}");
        // The points' box diagonal is 2√2, 5 % of it 0.141.
        assert!(close(agreement.fitness, if height < 0.1 { 1.0 } else { 0.0 }), "{height}: {agreement:?}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn half_the_points_off_the_surface() {
    // 441 points on the surface and as many 0.5 above it, which is beyond 5 % of the diagonal (2.87).
    let points = [grid(0.0), grid(0.5)].concat();
    let agreement = agreement_of(&points, &square(), &Cloud::from_points(grid(0.0)), &Similarity::identity());
    assert!(close(agreement.points_to_surface, 0.25), "{agreement:?}");
    assert!(close(agreement.surface_to_points, 0.0), "{agreement:?}");
    assert_eq!(agreement.fitness, Some(0.5));
}

#[wasm_bindgen_test(unsupported = test)]
fn normals_across_the_surface_do_not_agree() {
    // Points on the plane x = 0, perpendicular to the square and near it.
    let points: Vec<Vec3> = grid(0.0).iter().map(|p| Vec3::new(0.0, p.x, p.y)).collect();
    let agreement = agreement_of(&points, &square(), &Cloud::default(), &Similarity::identity());
    assert!(close(agreement.normal_consistency, 0.0), "{agreement:?}");
    assert_eq!(agreement.surface_to_points, None);
}

#[wasm_bindgen_test(unsupported = test)]
fn nothing_to_measure_is_none() {
    let samples = Cloud::from_points(grid(0.0));
    let none = agreement_of(&[], &square(), &samples, &Similarity::identity());
    assert_eq!(none.points_to_surface, None);
    assert_eq!(none.surface_to_points, None);
    assert_eq!(none.fitness, None);
    assert_eq!(none.normal_consistency, None);
    let line: Vec<Vec3> = (0..40).map(|i| Vec3::X * i as f32 * 0.01).collect();
    let agreement = agreement_of(&line, &square(), &samples, &Similarity::identity());
    assert_eq!((agreement.normal_consistency, agreement.fitness), (None, Some(1.0)));
}
