//! The proportions of a mesh that are fitted with its pose: their derivatives, the nearest similarity against the closed
//! form of Umeyama, and meshes that are too wide or too flat.

use sim3align::align::align;
use sim3align::geometry::surface::{SurfaceMoments, triangle_area};
use sim3align::precise::scored::conditioning::Conditioning;
use sim3align::precise::searched::proportions::{PROPORTIONS, Proportions, Stretched};
use sim3align::precise::searched::recipe::FINE;

use sim3align::precise::options::Proportions as Freedom;
use sim3align::report::Stretch;

use crate::precise::{body, observe, quick, truth};
use crate::precise_scene::pose;
use crate::prelude::*;

fn proportions(draw: &mut Draw, most: f64) -> Proportions {
    Proportions::new(core::array::from_fn(|_| draw.between(-most, most)))
}

#[wasm_bindgen_test(unsupported = test)]
fn proportions_keep_the_volume_and_turn_nothing() {
    for seed in 0..50 {
        let draw = &mut Draw::new(seed);
        let parameters: [f64; PROPORTIONS] = core::array::from_fn(|_| draw.between(-0.1, 0.1));
        let stretch = Proportions::new(parameters).matrix();
        let skew = stretch - stretch.transpose();
        assert!(skew.to_cols_array().iter().all(|x| x.abs() < 1e-15), "seed {seed}: {stretch}");
        assert!((stretch.determinant() - 1.0).abs() < 1e-4, "seed {seed}: {}", stretch.determinant());
        // To first order the squares of the entries of E add up to those of the parameters.
        let [small, large] = [1e-4, 1.0].map(|factor| {
            let e = Proportions::new(parameters.map(|x| factor * x)).matrix() - DMat3::IDENTITY;
            (e.to_cols_array().iter().map(|x| x * x).sum::<f64>() / (factor * factor)).sqrt()
        });
        let norm = parameters.iter().map(|x| x * x).sum::<f64>().sqrt();
        assert!((small / norm - 1.0).abs() < 1e-4, "seed {seed}: {small} for {norm}");
        assert!((large / norm - 1.0).abs() < 0.1, "seed {seed}: {large} for {norm}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn uncertainty_counts_the_proportions_that_are_fitted() {
    let body = body();
    let settings = SearchSettings::from(Effort::Fast);
    let clean = CleanObservation::new(&observe(&body, &truth()));
    let frame = MeshFrame::of(&body);
    let mesh = frame.normalized(&body).unwrap();
    let (model, grid) = (Model::new(&mesh), CropGrid::new(&clean, settings.grids[FINE].cells));
    let scoring = settings.scoring(&clean, FINE);
    let objective = objective(&model, &grid, scoring, Prior::default());
    let refiner = Refiner { objective, lock_scale: false };
    let pose = CropPose::of_similarity(&truth(), &frame).unwrap();
    let surface = SurfaceMoments::of(&mesh);
    let mut canvas = Canvas::default();
    let score = refiner.objective.score(&mut canvas, &pose);
    let mut held = |is_exact, free_axis| {
        let covariance = refiner.covariance(&mut canvas, &score, &pose, (&surface, is_exact), free_axis).unwrap();
        Conditioning::new(&covariance, &pose)
    };
    let [exact, stretched] = [held(true, None), held(false, None)];
    assert!(stretched.scale > 1.05 * exact.scale, "{stretched:?} for {exact:?}");
    assert!(stretched.rotation.0 > exact.rotation.0, "{stretched:?} for {exact:?}");
    // Without the turn about an axis, no other is less certain.
    let rolled = held(false, Some(stretched.rotation.1));
    assert!(rolled.rotation.0 < stretched.rotation.0 && rolled.scale <= stretched.scale, "{rolled:?}");
}

#[wasm_bindgen_test(unsupported = test)]
fn the_derivatives_by_the_proportions_are_differences() {
    const H: f64 = 1e-5;
    for seed in 0..50 {
        let draw = &mut Draw::new(seed);
        let [p, gradient] = core::array::from_fn(|_| DVec3::new(draw.normal(), draw.normal(), draw.normal()));
        let found = Proportions::jacobian(p.as_vec3(), gradient.as_vec3());
        for (k, found) in found.into_iter().enumerate() {
            let at = |x: f64| {
                let mut parameters = [0.0; PROPORTIONS];
                parameters[k] = x;
                gradient.dot(Proportions::new(parameters).matrix() * p)
            };
            let slope = (at(H) - at(-H)) / (2.0 * H);
            assert!((f64::from(found) - slope).abs() < 1e-5, "seed {seed}, {k}: {found} for {slope}");
        }
    }
}

/// The similarity that is nearest to a map of the mesh over its surface, by Umeyama's closed form. The means over a triangle
/// of a quadratic are those of the middles of its edges.
fn by_umeyama(mesh: &Mesh, map: impl Fn(DVec3) -> DVec3, scale: ScaleMode) -> CropPose {
    let middles = |triangle: usize| {
        let [a, b, c] = mesh.corners(mesh.triangles()[triangle]).map(|p| p.as_dvec3());
        [a + b, b + c, c + a].map(|sum| (sum * 0.5, triangle_area(mesh, triangle)))
    };
    let double = |p: DVec3| Vector3::from(p.to_array());
    let pairs = (0..mesh.triangles().len()).flat_map(middles);
    let pairs = pairs.map(|(p, weight)| Pair { source: double(p), target: double(map(p)), weight });
    CropPose::of_similarity(&umeyama(pairs, scale).unwrap(), &MeshFrame::NORMALIZED).unwrap()
}

fn normalized(mesh: &Mesh) -> Mesh {
    MeshFrame::of(mesh).normalized(mesh).unwrap()
}

#[wasm_bindgen_test(unsupported = test)]
fn the_nearest_similarity_is_that_of_umeyama() {
    let mesh = normalized(&body());
    let surface = SurfaceMoments::of(&mesh);
    for seed in 0..40 {
        let draw = &mut Draw::new(seed);
        let stretched = Stretched { pose: pose(draw, 3.0), proportions: proportions(draw, 0.15) };
        let (scale, translation) = stretched.pose.scale_translation();
        let linear = DMat3::from_quat(stretched.pose.rotation) * stretched.proportions.matrix() * scale;
        for (lock_scale, mode) in [(false, ScaleMode::Free), (true, ScaleMode::Fixed(scale))] {
            let expected = by_umeyama(&mesh, |p| linear * p + translation, mode);
            let found = stretched.nearest(&surface, lock_scale);
            let turn = angle_between(found.rotation, expected.rotation);
            let what = format!("seed {seed}, locked {lock_scale}: {found:?} for {expected:?}");
            assert!(turn < 1e-6, "{turn}: {what}");
            assert!((found.size - expected.size).abs() < 1e-7, "{what}");
            assert!((found.distance - expected.distance).abs() < 1e-7, "{what}");
            assert!((found.place - expected.place).length() < 1e-7, "{what}");
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn a_line_and_a_point_keep_a_finite_pose() {
    let draw = &mut Draw::new(3);
    let stretched = Stretched { pose: pose(draw, 3.0), proportions: proportions(draw, 0.15) };
    let line = DMat3::from_diagonal(DVec3::new(0.1, 0.0, 0.0));
    for covariance in [line, DMat3::ZERO] {
        let found = stretched.nearest(&SurfaceMoments { area: 1.0, centroid: DVec3::ZERO, covariance }, false);
        assert!(found.is_finite(), "{covariance}: {found:?}");
        assert!((found.size - stretched.pose.size).abs() < 0.2, "{covariance}: {found:?}");
    }
}

/// The body in other proportions, in its normalised frame, on the fine grid of an observation of the body as it is, and the
/// pose that is nearest to the truth over the whole surface.
fn disproportionate(by: &Proportions) -> (Mesh, CropGrid, Scoring, CropPose) {
    let mesh = body();
    let (matrix, clean) = (by.matrix(), CleanObservation::new(&observe(&mesh, &truth())));
    let wrong = mapped(&mesh, |p| (matrix * p.as_dvec3()).as_vec3());
    let (frame, back) = (MeshFrame::of(&wrong), matrix.inverse());
    let of_object = |p: DVec3| truth().apply(vector3((back * (p * frame.diagonal + frame.center)).as_vec3()));
    let wrong = normalized(&wrong);
    let nearest = by_umeyama(&wrong, |p| DVec3::from_slice(of_object(p).as_slice()), ScaleMode::Free);
    let grid = CropGrid::new(&clean, 3000);
    (wrong, grid, SearchSettings::from(Effort::Balanced).scoring(&clean, FINE), nearest)
}

#[wasm_bindgen_test(unsupported = test)]
fn a_mesh_in_other_proportions_is_put_where_it_is_nearest_as_a_whole() {
    let (mut better, mut errors) = (0, [[0.0; 3]; 2]);
    const SEEDS: u64 = 12;
    for seed in 0..SEEDS {
        let draw = &mut Draw::new(seed);
        let (mesh, grid, scoring, nearest) = disproportionate(&proportions(draw, 0.04));
        let model = Model::new(&mesh);
        let objective = objective(&model, &grid, scoring, Prior::default());
        let refiner = Refiner { objective, lock_scale: false };
        let mut canvas = Canvas::default();
        let start = nearest.moved(&core::array::from_fn(|_| draw.between(-0.02, 0.02)));
        let plain = refiner.refine(&mut canvas, start, 20);
        let fitted = refiner.refine_in_proportion(&mut canvas, start, 20, &SurfaceMoments::of(&mesh));
        assert!(fitted.renders <= 21 && fitted.converged, "seed {seed}: {fitted:?}");
        better += usize::from(fitted.score.total > plain.score.total);
        for (sum, found) in errors.iter_mut().zip([plain.pose, fitted.pose]) {
            let log_scale = |pose: &CropPose| pose.size + pose.distance;
            sum[0] += angle_between(found.rotation, nearest.rotation).to_degrees() / SEEDS as f64;
            sum[1] += (log_scale(&found) - log_scale(&nearest)).abs() / SEEDS as f64;
            sum[2] += (found.place - nearest.place).length() / SEEDS as f64;
        }
    }
    let [plain, fitted] = errors;
    let what = format!("degrees, log of scale, place: {fitted:?}, and {plain:?} as if the proportions were right");
    assert!(better as u64 > SEEDS * 3 / 4, "{better} of {SEEDS} explain the picture better");
    assert!((0..3).all(|k| fitted[k] < 0.7 * plain[k]), "{what}");
    assert!(fitted[0] < 1.5 && fitted[1] < 0.012, "{what}");
}

#[wasm_bindgen_test(unsupported = test)]
fn a_fit_in_proportion_keeps_a_locked_scale_and_the_bounds_of_a_free_one() {
    let draw = &mut Draw::new(5);
    let (mesh, grid, scoring, nearest) = disproportionate(&proportions(draw, 0.04));
    let (model, surface) = (Model::new(&mesh), SurfaceMoments::of(&mesh));
    let mut canvas = Canvas::default();
    let log_scale = |pose: &CropPose| pose.size + pose.distance;
    let free = objective(&model, &grid, scoring, Prior::default());
    let start = nearest.moved(&[0.02, -0.02, 0.01, 0.03, 0.01, 0.01, 0.0]);
    let locked = Refiner { objective: free, lock_scale: true }.refine_in_proportion(&mut canvas, start, 20, &surface);
    assert!((log_scale(&locked.pose) - log_scale(&start)).abs() < 1e-12, "{locked:?}");
    let bounds = [1.03, 1.1].map(|factor| factor * libm::exp(log_scale(&nearest)));
    let prior = Prior { scale: Some(bounds), ..Prior::default() };
    let objective = Objective { prior, ..free };
    let held = Refiner { objective, lock_scale: false }.refine_in_proportion(&mut canvas, start, 20, &surface);
    assert!(prior.is_at_bound(&held.pose), "the truth is below: {held:?}");
}

/// The lengths of the axes of a mesh, metres per unit.
fn lengths(scale: f64, stretch: &DMat3) -> [f64; 3] {
    [0, 1, 2].map(|axis| scale * stretch.col(axis).length())
}

#[wasm_bindgen_test(unsupported = test)]
fn a_mesh_is_put_into_its_proportions() {
    for seed in 0..4 {
        let draw = &mut Draw::new(seed);
        // The object, a mesh of it in other proportions, and the lengths that its axes have in truth.
        let object = body();
        let by = proportions(draw, 0.06).matrix();
        let mesh = mapped(&object, |p| (by.inverse() * p.as_dvec3()).as_vec3());
        let expected = lengths(truth().scale, &by);
        let seen = observe(&object, &truth());
        let options = AlignOptions { proportions: Freedom::Full, ..quick() };
        let found = align(&seen, &mesh, &options, &mut Silent).unwrap();
        let Stretch { camera_from_stretched, stretch, size_m, uncertainty } = found.proportions.clone().unwrap();
        let stretch = DMat3::from_cols_array_2d(&stretch);
        let extent = Bounds::of(mapped(&mesh, |p| (stretch * p.as_dvec3()).as_vec3()).positions()).unwrap().extent();
        for (size, extent) in size_m.into_iter().zip(extent.to_array()) {
            assert!((size / (camera_from_stretched.scale * f64::from(extent)) - 1.0).abs() < 1e-5, "seed {seed}");
        }
        assert!((stretch - stretch.transpose()).to_cols_array().iter().all(|x| x.abs() < 1e-12), "seed {seed}");
        assert!((stretch.determinant() - 1.0).abs() < 1e-3, "seed {seed}: {}", stretch.determinant());
        for (axis, length) in lengths(camera_from_stretched.scale, &stretch).into_iter().enumerate() {
            let error = libm::log(length / expected[axis]).abs();
            let most = 3.0 * uncertainty[axis] + 0.005;
            assert!(error < most, "seed {seed}, axis {axis}: {error}, of at most {most}");
            assert!(uncertainty[axis] < 0.06, "seed {seed}: {uncertainty:?}");
        }
        // The similarity is the same, to the bit, as without.
        let plain = align(&seen, &mesh, &quick(), &mut Silent).unwrap();
        assert_eq!(plain.camera_from_mesh, found.camera_from_mesh);
        assert_eq!(plain.proportions, None);
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn axes_are_stretched_alone_and_symmetry_is_kept() {
    let wide = mapped(&body(), |p| p * Vec3::new(1.06, 0.97, 0.97));
    let seen = observe(&body(), &truth());
    let fitted = |mesh: &Mesh, seen: &Observation, options: AlignOptions| {
        let found = align(seen, mesh, &options, &mut Silent).unwrap();
        found.proportions.map(|found| DMat3::from_cols_array_2d(&found.stretch))
    };
    let axes = AlignOptions { proportions: Freedom::Axes, ..quick() };
    let stretch = fitted(&wide, &seen, axes.clone()).unwrap();
    let off = [stretch.x_axis.y, stretch.x_axis.z, stretch.y_axis.z];
    assert!(off.iter().all(|x| x.abs() < 2e-3), "{stretch}");
    assert!(stretch.x_axis.x < stretch.y_axis.y, "{stretch}");
    // A surface of revolution stays one.
    let round = ellipsoid(Vec3::new(0.5, 0.5, 1.0), 24);
    let flat = mapped(&round, |p| p * Vec3::new(1.0, 1.0, 0.94));
    let full = AlignOptions { proportions: Freedom::Full, symmetry: Symmetry::Auto, ..quick() };
    let stretch = fitted(&flat, &observe(&round, &truth()), full).unwrap();
    assert!((stretch.x_axis.x - stretch.y_axis.y).abs() < 2e-3, "{stretch}");
    // Along its axis, too, if that is no axis of the mesh.
    let turn = exp(DVec3::new(0.5, -0.7, 0.4)).as_quat();
    let turned = |mesh: &Mesh| mapped(mesh, |p| turn * p);
    let tilted = AlignOptions { symmetry: Symmetry::Auto, ..axes.clone() };
    let stretch = fitted(&turned(&flat), &observe(&turned(&round), &truth()), tilted).unwrap();
    let lengths = Vec3::AXES.map(|axis| {
        let axis = (turn * axis).as_dvec3();
        axis.dot(stretch * axis)
    });
    assert!((lengths[0] - lengths[1]).abs() < 2e-3 && lengths[2] > 1.015, "{lengths:?}");
    // A mesh of known size is that of the object itself.
    let known = AlignOptions { scale: ScaleOption::Fixed(truth().scale), ..axes };
    assert_eq!(fitted(&wide, &seen, known), None);
}

#[wasm_bindgen_test(unsupported = test)]
fn right_proportions_are_kept() {
    let seen = observe(&body(), &truth());
    for freedom in [Freedom::Axes, Freedom::Full] {
        let found = align(&seen, &body(), &AlignOptions { proportions: freedom, ..quick() }, &mut Silent).unwrap();
        let Stretch { stretch, camera_from_stretched, uncertainty, .. } = found.proportions.unwrap();
        let change = DMat3::from_cols_array_2d(&stretch) - DMat3::IDENTITY;
        assert!(change.to_cols_array().iter().all(|x| x.abs() < 2e-3), "{change:?}");
        assert!((camera_from_stretched.scale / found.camera_from_mesh.scale - 1.0).abs() < 2e-3);
        assert!(uncertainty.iter().all(|sd| (0.015..0.06).contains(sd)), "{uncertainty:?}");
    }
}
