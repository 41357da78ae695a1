//! The pose errors of BOP against slow ones, written from their definitions.

use sim3align::metrics::bop::{
    BopErrors, BopModel, ModelSymmetry, RevolutionAxis, bop_errors, symmetry_transformations,
};

use crate::prelude::*;

const WIDTH: usize = 48;
const HEIGHT: usize = 36;
/// Metres per unit of the models.
const MILLIMETRES: f64 = 0.001;

fn camera() -> Pinhole {
    Pinhole::new(60.0, 61.0, 23.5, 17.0).unwrap()
}

fn pose(random: &mut Random) -> Similarity {
    let mut uniform = || 2.0 * random.uniform() - 1.0;
    Similarity {
        scale: MILLIMETRES,
        rotation: Rotation3::new(Vector3::from_fn(|_, _| 2.0 * uniform())),
        translation: Vector3::new(0.03 * uniform(), 0.03 * uniform(), 0.4 + 0.03 * uniform()),
    }
}

/// A pose a little off another.
fn beside(pose: &Similarity, random: &mut Random) -> Similarity {
    let mut uniform = |size: f64| size * (2.0 * random.uniform() - 1.0);
    Similarity {
        rotation: pose.rotation * Rotation3::new(Vector3::from_fn(|_, _| uniform(0.2))),
        translation: pose.translation + Vector3::new(uniform(0.01), uniform(0.01), uniform(0.02)),
        ..*pose
    }
}

/// Where the ray through a place in the image meets the mesh first: z, or 0.
fn cast(mesh: &Mesh, pose: &Similarity, u: f64, v: f64) -> f64 {
    let camera = camera();
    let ray = DVec3::new((u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, 1.0);
    let mut nearest = f64::INFINITY;
    for triangle in mesh.triangles() {
        let [a, b, c] = mesh.corners(*triangle).map(|p| DVec3::from_array(pose.apply(vector3(p)).into()));
        let normal = (b - a).cross(c - a);
        let z = normal.dot(a) / normal.dot(ray);
        let p = ray * z;
        let inside = [(a, b), (b, c), (c, a)].iter().all(|(s, e)| (*e - *s).cross(p - *s).dot(normal) >= 0.0);
        if z > 0.0 && inside {
            nearest = nearest.min(z);
        }
    }
    if nearest.is_finite() { nearest } else { 0.0 }
}

fn oracle(
    mesh: &Mesh,
    diameter: f64,
    symmetries: &[ModelSymmetry],
    depth: &DepthMap,
    estimate: &Similarity,
    truth: &Similarity,
) -> BopErrors {
    let points: Vec<_> = mesh.positions().iter().map(|p| vector3(*p)).collect();
    let camera = camera();
    let distance = |p: Vector3<f64>, q: Vector3<f64>| (p - q).norm();
    let pixel = |p: Vector3<f64>| Vector3::new(camera.fx * p.x / p.z, camera.fy * p.y / p.z, 0.0);
    let largest = |symmetry: &ModelSymmetry, of: &dyn Fn(Vector3<f64>, Vector3<f64>) -> f64| {
        let each = points.iter().map(|p| {
            let truth = truth.apply(symmetry.rotation * p + symmetry.translation);
            of(estimate.apply(*p), truth)
        });
        each.fold(0.0, f64::max)
    };
    let least = |of: &dyn Fn(Vector3<f64>, Vector3<f64>) -> f64| {
        symmetries.iter().map(|symmetry| largest(symmetry, of)).fold(f64::INFINITY, f64::min)
    };
    let mean = |of: &dyn Fn(&Vector3<f64>) -> f64| points.iter().map(of).sum::<f64>() / points.len() as f64;

    let mut counts = (0, [0; 10]);
    for v in 0..HEIGHT {
        for u in 0..WIDTH {
            let (x, y) = (u as f64, v as f64);
            let length =
                |z: f64| z * Vector3::new((x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy, 1.0).norm();
            let [g, e] = [truth, estimate].map(|pose| length(cast(mesh, pose, x + 0.5, y + 0.5)));
            let scene = length(f64::from(depth.data()[v * WIDTH + u]));
            let visible = |d: f64| d > 0.0 && (scene == 0.0 || d - scene <= 0.015);
            let (in_truth, in_estimate) = (visible(g), visible(e) || (visible(g) && e > 0.0));
            counts.0 += usize::from(in_truth || in_estimate);
            for (i, cost) in counts.1.iter_mut().enumerate() {
                let matched = in_truth && in_estimate && (g - e).abs() / diameter < 0.05 * (i + 1) as f64;
                *cost += usize::from((in_truth || in_estimate) && !matched);
            }
        }
    }
    BopErrors {
        vsd: counts.1.map(|cost| cost as f64 / counts.0 as f64),
        mssd_mm: 1000.0 * least(&distance),
        mspd_px: Some(least(&|p, q| distance(pixel(p), pixel(q)))),
        add_mm: 1000.0 * mean(&|p| distance(estimate.apply(*p), truth.apply(*p))),
        add_s_mm: 1000.0
            * mean(&|p| {
                points.iter().map(|q| distance(estimate.apply(*q), truth.apply(*p))).fold(f64::INFINITY, f64::min)
            }),
    }
}

fn half_turn_about_z() -> ModelSymmetry {
    ModelSymmetry {
        rotation: *Rotation3::new(Vector3::z() * core::f64::consts::PI).matrix(),
        translation: Vector3::zeros(),
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn errors_are_those_of_the_definitions() {
    let lemon = RevolutionAxis { axis: Vector3::new(0.0, 0.0, 2.0), offset: Vector3::new(1.0, 0.0, 7.0) };
    for seed in 0..12 {
        let mut random = Random::new(seed, 19);
        let (mesh, symmetries) = match seed % 3 {
            0 => (cuboid(Vec3::new(60.0, 90.0, 120.0)), symmetry_transformations(&[], &[])),
            1 => (cuboid(Vec3::new(60.0, 90.0, 120.0)), symmetry_transformations(&[half_turn_about_z()], &[])),
            _ => {
                (ellipsoid(Vec3::new(40.0, 40.0, 60.0), 8), symmetry_transformations(&[half_turn_about_z()], &[lemon]))
            }
        };
        let symmetries = symmetries.unwrap();
        let truth = pose(&mut random);
        let estimates = [truth, beside(&truth, &mut random), beside(&truth, &mut random)];
        // The object, a wall in front of a part of it, and pixels without reading.
        let mut depth = DepthMap::from_metres(WIDTH, HEIGHT, vec![0.9; WIDTH * HEIGHT]).unwrap();
        for (i, z) in depth.data_mut().iter_mut().enumerate() {
            let (u, v) = (i % WIDTH, i / WIDTH);
            let seen = cast(&mesh, &truth, u as f64, v as f64);
            if seen > 0.0 {
                *z = seen as f32;
            }
            if u > 30 {
                *z = 0.3;
            } else if v % 7 == 0 {
                *z = 0.0;
            }
        }
        let model = BopModel { mesh: &mesh, diameter_m: 0.16, symmetries: &symmetries };
        let found = bop_errors(&model, &depth, &camera(), &estimates, &[truth]).unwrap();
        for (found, estimate) in found.iter().zip(&estimates) {
            let expected = oracle(&mesh, 0.16, &symmetries, &depth, estimate, &truth);
            let near = |a: f64, b: f64, by: f64| assert!((a - b).abs() <= by, "seed {seed}: {found:?}, {expected:?}");
            near(found.mssd_mm, expected.mssd_mm, 1e-6);
            near(found.mspd_px.unwrap(), expected.mspd_px.unwrap(), 1e-6);
            near(found.add_mm, expected.add_mm, 1e-6);
            near(found.add_s_mm, expected.add_s_mm, 1e-3);
            // The rasteriser snaps to 1/256 pixel, and the union has some 150 pixels.
            for (a, b) in found.vsd.iter().zip(&expected.vsd) {
                near(*a, *b, 0.02);
            }
        }
        // Behind the wall, the outline at the pixels' own places differs from that half a pixel beside.
        assert!(found[0].mssd_mm < 1e-9 && found[0].add_s_mm < 1e-3 && found[0].vsd[0] < 1e-9, "seed {seed}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn symmetries_are_discretised_as_in_bop() {
    let axis = RevolutionAxis { axis: Vector3::x(), offset: Vector3::new(0.0, 5.0, 0.0) };
    assert_eq!(symmetry_transformations(&[], &[]).unwrap().len(), 1);
    assert_eq!(symmetry_transformations(&[half_turn_about_z()], &[]).unwrap().len(), 2);
    assert_eq!(symmetry_transformations(&[], &[axis]).unwrap().len(), 315);
    let all = symmetry_transformations(&[half_turn_about_z()], &[axis]).unwrap();
    assert_eq!(all.len(), 630);
    for ModelSymmetry { rotation, translation } in &all[..315] {
        // The axis stays where it is.
        let on_axis = Vector3::new(3.0, 5.0, 0.0);
        assert!((rotation * on_axis + translation - on_axis).norm() < 1e-9);
    }
    let nowhere = RevolutionAxis { axis: Vector3::zeros(), offset: Vector3::zeros() };
    let error = symmetry_transformations(&[], &[nowhere]).unwrap_err();
    assert_eq!(error.code, ErrorCode::InvalidArgument);
    assert!(symmetry_transformations(&vec![half_turn_about_z(); 1000], &[axis; 9]).is_err());
}

#[wasm_bindgen_test(unsupported = test)]
fn what_is_out_of_sight_has_the_worst_errors() {
    let mesh = cuboid(Vec3::splat(80.0));
    let identity = symmetry_transformations(&[], &[]).unwrap();
    let truth = pose(&mut Random::new(3, 3));
    let behind = Similarity { translation: -truth.translation, ..truth };
    let aside = Similarity { translation: truth.translation + Vector3::new(0.4, 0.0, 0.0), ..truth };
    let depth = DepthMap::from_metres(WIDTH, HEIGHT, vec![0.0; WIDTH * HEIGHT]).unwrap();
    let model = BopModel { mesh: &mesh, diameter_m: 0.14, symmetries: &identity };
    let found = bop_errors(&model, &depth, &camera(), &[behind, aside], &[truth]).unwrap();
    assert_eq!((found[0].vsd, found[0].mspd_px), ([1.0; 10], None));
    assert_eq!(found[1].vsd, [1.0; 10]);
    assert!((found[1].add_mm - 400.0).abs() < 1e-6 && (found[1].mssd_mm - 400.0).abs() < 1e-6);
    // A wall in front of both poses: there is nothing to compare.
    let wall = DepthMap::from_metres(WIDTH, HEIGHT, vec![0.1; WIDTH * HEIGHT]).unwrap();
    assert_eq!(bop_errors(&model, &wall, &camera(), &[truth], &[truth]).unwrap()[0].vsd, [1.0; 10]);
    for diameter_m in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let model = BopModel { diameter_m, ..model };
        let error = bop_errors(&model, &depth, &camera(), &[truth], &[truth]).unwrap_err();
        assert_eq!((error.code, &*error.argument), (ErrorCode::InvalidArgument, "diameterM"));
    }
}
