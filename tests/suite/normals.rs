//! Normals against surfaces whose normals are known.

use sim3align::evidence::normals::{Neighborhood, Orientation, estimate_normals};

use crate::prelude::*;

fn normals(points: &[Vec3], neighborhood: Neighborhood, orientation: Orientation) -> Vec<Vec3> {
    estimate_normals(points, &KdTree::new(points), neighborhood, orientation)
}

#[wasm_bindgen_test(unsupported = test)]
fn a_plane_has_one_normal() {
    for seed in 0..20 {
        let mut random = Random::new(seed, 902);
        let mut vector = || Vec3::from_array([0; 3].map(|_| random.uniform() as f32 * 2.0 - 1.0));
        let normal = vector().normalize();
        let (u, v) = normal.any_orthonormal_pair();
        let offset = Vec3::new(0.0, 0.0, 5.0);
        let points: Vec<Vec3> = (0..300).map(|_| vector()).map(|p| offset + u * p.x + v * p.y).collect();
        for found in normals(&points, Neighborhood::nearest(12), Orientation::TowardsCamera) {
            assert!(found.dot(normal).abs() > 1.0 - 1e-6, "seed {seed}: {found} for {normal}");
            assert!(found.dot(offset) <= 0.0, "seed {seed}: {found} looks away from the camera");
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn a_sphere_has_radial_normals() {
    let center = Vec3::new(0.3, -0.2, 4.0);
    let points: Vec<Vec3> =
        sample_surface(&sphere(1.0, 40), 4000, 5).unwrap().points.iter().map(|p| p + center).collect();
    let found = normals(&points, Neighborhood { max_neighbors: 20, radius: 0.2 }, Orientation::AwayFrom(center));
    for (p, n) in points.iter().zip(&found) {
        assert!(n.dot((p - center).normalize()) > 0.99, "{n} at {p}");
    }
    // Seen from the origin, the near side's normals are the same and the far side's are turned about.
    let seen = normals(&points, Neighborhood { max_neighbors: 20, radius: 0.2 }, Orientation::TowardsCamera);
    for ((p, out), toward) in points.iter().zip(&found).zip(&seen) {
        assert_eq!(*toward, if out.dot(*p) > 0.0 { -*out } else { *out });
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn no_plane_no_normal() {
    let line: Vec<Vec3> = (0..20).map(|i| Vec3::new(1.0, 2.0, 3.0) * i as f32 + Vec3::Z).collect();
    let same = vec![Vec3::new(1.0, 2.0, 3.0); 20];
    let two = vec![Vec3::X, Vec3::Y];
    for points in [line, same, two, Vec::new()] {
        for n in normals(&points, Neighborhood::nearest(8), Orientation::TowardsCamera) {
            assert_eq!(n, Vec3::ZERO);
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn the_radius_bounds_the_neighbourhood() {
    // A floor and, 0.5 above it, a wall: within 0.2 the floor alone decides.
    let mut points: Vec<Vec3> =
        (0..100).map(|i| Vec3::new(0.1 * (i % 10) as f32, 0.1 * (i / 10) as f32, 0.0)).collect();
    points.extend((0..100).map(|i| Vec3::new(0.45, 0.1 * (i / 10) as f32, 0.5 + 0.1 * (i % 10) as f32)));
    let bounded = Neighborhood { max_neighbors: 100, radius: 0.2 };
    for n in &normals(&points, bounded, Orientation::AwayFrom(-Vec3::Z))[..100] {
        assert!(n.distance(Vec3::Z) < 1e-6, "{n}");
    }
    let free = normals(&points, Neighborhood::nearest(100), Orientation::AwayFrom(-Vec3::Z));
    assert!(free[..100].iter().any(|n| n.distance(Vec3::Z) > 0.01));
}
