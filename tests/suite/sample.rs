//! Surface samples and the check for degenerate shapes.

use glam::Mat3;
use sim3align::geometry::surface::{SurfaceMoments, check_shape};

use crate::prelude::*;
use crate::shapes::inverted;

/// Triangles side by side in the plane z = 0, the k-th between x = 2k and 2k + 1.
fn row_of_triangles(heights: &[f32]) -> Mesh {
    let positions = (heights.iter().enumerate())
        .flat_map(|(k, &h)| {
            let x = 2.0 * k as f32;
            [Vec3::new(x, 0.0, 0.0), Vec3::new(x + 1.0, 0.0, 0.0), Vec3::new(x, h, 0.0)]
        })
        .collect();
    Mesh::new(positions, (0..heights.len() as u32).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect()).unwrap()
}

#[wasm_bindgen_test(unsupported = test)]
fn counts_follow_the_areas() {
    for seed in 0..20 {
        let mut random = Random::new(seed, 901);
        let heights: Vec<f32> = (0..50).map(|k| if k % 7 == 6 { 0.0 } else { random.uniform() as f32 }).collect();
        let count = 1000;
        let cloud = sample_surface(&row_of_triangles(&heights), count, seed).unwrap();
        assert_eq!((cloud.points.len(), cloud.normals.len()), (count, count));
        let total: f32 = heights.iter().sum();
        for (k, h) in heights.iter().enumerate() {
            let low = 2.0 * k as f32;
            let inside = cloud.points.iter().filter(|p| (low..=low + 1.0).contains(&p.x));
            let (found, expected) = (inside.clone().count() as f32, h / total * count as f32);
            assert!((found - expected).abs() <= 2.0, "seed {seed}, triangle {k}: {found} of {expected}");
            assert!(*h > 0.0 || found == 0.0, "seed {seed}: a point on triangle {k}, which has no area");
            for p in inside {
                let on_triangle = p.y >= 0.0 && p.y <= h * (1.0 - (p.x - low)) + 1e-5 && p.z == 0.0;
                assert!(on_triangle, "seed {seed}, triangle {k}: {p} lies beside it");
            }
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn points_are_uniform_within_a_triangle() {
    // A quarter of the area lies beyond half of each corner's height.
    let cloud = sample_surface(&row_of_triangles(&[1.0]), 20_000, 3).unwrap();
    let near_a = cloud.points.iter().filter(|p| p.x + p.y < 0.5).count();
    let near_b = cloud.points.iter().filter(|p| p.x > 0.5).count();
    let near_c = cloud.points.iter().filter(|p| p.y > 0.5).count();
    for near in [near_a, near_b, near_c] {
        // Five standard deviations of a binomial count are 306.
        assert!((near as i32 - 5000).abs() < 306, "{near_a} {near_b} {near_c}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn normals_point_out_even_of_an_inverted_mesh() {
    let mesh = cuboid(Vec3::new(1.0, 2.0, 3.0));
    for mesh in [&mesh, &inverted(&mesh)] {
        let cloud = sample_surface(mesh, 500, 1).unwrap();
        for (p, n) in cloud.points.iter().zip(&cloud.normals) {
            assert_eq!(n.length(), 1.0);
            assert_eq!(n.abs().max_element(), 1.0);
            // On the face that the normal names, 0.5·extent from the middle.
            assert!((p.dot(*n) - (Vec3::new(0.5, 1.0, 1.5) * n.abs()).length()).abs() < 1e-6, "{p} {n}");
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn the_seed_decides() {
    let mesh = sphere(1.0, 8);
    assert_eq!(sample_surface(&mesh, 100, 7).unwrap(), sample_surface(&mesh, 100, 7).unwrap());
    assert_ne!(sample_surface(&mesh, 100, 7).unwrap(), sample_surface(&mesh, 100, 8).unwrap());
    assert!(sample_surface(&mesh, 0, 7).unwrap().is_empty());
}

#[wasm_bindgen_test(unsupported = test)]
fn moments_of_a_box_are_those_of_the_formula() {
    let moments = SurfaceMoments::of(&mapped(&cuboid(Vec3::new(2.0, 4.0, 6.0)), |p| p + Vec3::new(100.0, -50.0, 8.0)));
    assert!((moments.area - 2.0 * (2.0 * 4.0 + 2.0 * 6.0 + 4.0 * 6.0)).abs() < 1e-9);
    assert!((moments.centroid - DVec3::new(100.0, -50.0, 8.0)).length() < 1e-9);
    // Faces of x²: the two x faces (24 each) lie at 1; the other four (8 and 12) are spread, variance 1/3.
    let expected = (48.0 + 40.0 / 3.0) / 88.0;
    assert!((moments.covariance.x_axis.x - expected).abs() < 1e-9, "{:?}", moments.covariance);
    assert!(moments.covariance.x_axis.y.abs() < 1e-9);
}

#[wasm_bindgen_test(unsupported = test)]
fn shapes_without_volume_are_refused() {
    let turned = Mat3::from_cols_array(&[0.36, 0.48, -0.8, -0.8, 0.6, 0.0, 0.48, 0.64, 0.6]);
    let flat = |extent: Vec3| mapped(&cuboid(extent), |p| turned * p + Vec3::new(3.0, -2.0, 1.0));
    let point = mapped(&cuboid(Vec3::ONE), |_| Vec3::ONE);
    let cases = [
        ("point", point, "area"),
        ("plane", flat(Vec3::new(1.0, 1.0, 0.0)), "plane"),
        ("almost a plane", flat(Vec3::new(1.0, 2.0, 1e-4)), "plane"),
        ("needle", flat(Vec3::new(1e-5, 1e-5, 1.0)), "needle"),
        ("one triangle", row_of_triangles(&[1.0]), "plane"),
    ];
    for (name, mesh, found) in cases {
        let error = check_shape(&mesh).unwrap_err();
        assert_eq!(error.code, ErrorCode::DegenerateMesh, "{name}");
        assert!(error.found.contains(found), "{name}: {error}");
    }
    assert_eq!(
        sample_surface(&mapped(&cuboid(Vec3::ONE), |_| Vec3::ONE), 10, 0).unwrap_err().code,
        ErrorCode::DegenerateMesh
    );
}

#[wasm_bindgen_test(unsupported = test)]
fn thin_far_tiny_and_huge_shapes_are_accepted() {
    let far = mapped(&cuboid(Vec3::ONE), |p| p + Vec3::splat(1e4));
    let shapes = [cuboid(Vec3::new(85.6, 54.0, 0.76)), cuboid(Vec3::splat(1e-6)), cuboid(Vec3::splat(1e12)), far];
    for (i, mesh) in shapes.iter().enumerate() {
        assert_eq!(check_shape(mesh), Ok(()), "shape {i}");
    }
}
