//! Inputs that are valid by type and hostile by content: each gets a typed error about itself or an answer, at a cost
//! that the answer needs. Cost is counted in cells, triangles and renders.

use glam::Vec3;
use nalgebra::{Rotation3, Vector3};
use sim3align::align::evaluate::{EvaluateOptions, evaluate};
use sim3align::align::search::Request;
use sim3align::align::warnings::about_observation;
use sim3align::align::{align, align_prepared};
use sim3align::error::{ErrorCode, Result};
use sim3align::evidence::observation::{MAX_PIXELS, Observation};
use sim3align::geometry::decimate::decimate;
use sim3align::geometry::image::{DepthMap, Mask};
use sim3align::geometry::mesh::Mesh;
use sim3align::geometry::pinhole::Pinhole;
use sim3align::geometry::similarity::Similarity;
use sim3align::precise::drawn::pose::CropPose;
use sim3align::precise::drawn::prepared_mesh::PreparedMesh;
use sim3align::precise::drawn::render::{Canvas, Model};
use sim3align::precise::observed::clean::CleanObservation;
use sim3align::precise::observed::grid::CropGrid;
use sim3align::precise::options::{AlignOptions, Quality};
use sim3align::precise::searched::recipe::SearchSettings;
use sim3align::progress::Silent;
use sim3align::report::{Effort, WarningCode};
use wasm_bindgen_test::wasm_bindgen_test;

use crate::precise::{body, observe, truth};
use crate::support::Draw;

const VGA: [usize; 2] = [640, 480];

/// An image whose mask is the pixels that `set` selects, with noisy depth.
fn view([width, height]: [usize; 2], focal: [f64; 2], set: impl Fn(usize, usize) -> bool) -> Result<Observation> {
    let mut draw = Draw::new(1);
    let depth = (0..width * height).map(|_| draw.between(0.5, 1.5) as f32).collect();
    let mask = (0..height).flat_map(|v| (0..width).map(move |u| (u, v))).map(|(u, v)| u8::from(set(u, v))).collect();
    let camera = Pinhole::new(focal[0], focal[1], 0.5 * width as f64, 0.5 * height as f64)?;
    Observation::new(DepthMap::from_metres(width, height, depth)?, Mask::new("mask", width, height, mask)?, camera)
}

fn blob(u: usize, v: usize) -> bool {
    let (x, y) = (u as f64 - 320.0, v as f64 - 240.0);
    x * x + 2.0 * y * y < 10_000.0
}

/// Triangles between random points of a unit cube, or of smaller cubes in it.
fn soup(count: usize, size: f64) -> Mesh {
    let mut draw = Draw::new(2);
    let mut positions = Vec::new();
    for _ in 0..count {
        let at = draw.cube(0.5);
        positions.extend((0..3).map(|_| {
            let p = at * (1.0 - size) + draw.cube(0.5) * size;
            Vec3::new(p.x as f32, p.y as f32, p.z as f32)
        }));
    }
    Mesh::new(positions, (0..count as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect()).unwrap()
}

fn quick() -> AlignOptions {
    AlignOptions { quality: Quality::Fast, metrics: false, ..AlignOptions::default() }
}

#[wasm_bindgen_test(unsupported = test)]
fn cameras_that_are_no_pinhole_are_refused() {
    for focal in [[1e9, 500.0], [500.0, 1e-3], [0.5, 0.5], [1e8, 1e8], [2.0, 2.0]] {
        let error = view(VGA, focal, blob).unwrap_err();
        assert_eq!(error.code, ErrorCode::InvalidCamera, "{focal:?}: {error}");
        assert_eq!(error.argument, "camera");
    }
    for focal in [[500.0, 500.0], [500.0, 30.0], [3.0, 3.0], [1e6, 1e6]] {
        assert!(view(VGA, focal, blob).is_ok(), "{focal:?}");
    }
    let beside = |cx: f64, cy: f64| Pinhole::new(500.0, 500.0, cx, cy).unwrap().check_field_of_view(640, 480);
    // The principal point of a crop is outside it.
    assert!(beside(-5000.0, 3000.0).is_ok());
    for (cx, cy) in [(1e12, 240.0), (320.0, -1e6)] {
        assert!(beside(cx, cy).is_err_and(|error| error.code == ErrorCode::InvalidCamera), "{cx} {cy}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn masks_without_shape_are_refused() {
    let focal = [500.0; 2];
    let lines: [Result<Observation>; 6] = [
        view(VGA, focal, |_, v| v == 240),
        view(VGA, focal, |_, v| v == 240 || v == 241),
        view(VGA, focal, |u, _| u == 240),
        view([1000, 1], focal, |_, _| true),
        view([1, 1000], focal, |_, _| true),
        view([2, 5000], focal, |_, _| true),
    ];
    for (i, line) in lines.into_iter().enumerate() {
        let error = line.unwrap_err();
        assert_eq!((error.code, &*error.argument), (ErrorCode::DegenerateMask, "mask"), "{i}: {error}");
    }
    // A diagonal line is as wide as high, but no cell of a grid is inside it.
    let diagonal = view(VGA, focal, |u, v| u == v).unwrap();
    let error = align(&diagonal, &body(), &quick(), &mut Silent).unwrap_err();
    assert_eq!((error.code, &*error.argument), (ErrorCode::DegenerateMask, "mask"), "{error}");
}

#[wasm_bindgen_test(unsupported = test)]
fn images_beyond_the_limit_are_refused() {
    let (width, height) = (MAX_PIXELS / 4, 5);
    let depth = DepthMap::from_metres(width, height, vec![1.0; width * height]).unwrap();
    let mask = Mask::filled(width, height, 1);
    let camera = Pinhole::new(1e6, 1e6, 0.0, 0.0).unwrap();
    let error = Observation::new(depth, mask, camera).unwrap_err();
    assert_eq!(error.code, ErrorCode::FileTooLarge, "{error}");
}

#[wasm_bindgen_test(unsupported = test)]
fn meshes_beyond_the_numbers_are_refused() {
    let observation = observe(&body(), &truth());
    let scaled = |unit: f32| {
        let mesh = body();
        Mesh::new(mesh.positions().iter().map(|p| *p * unit).collect(), mesh.triangles().to_vec()).unwrap()
    };
    for unit in [1e20, 1e30, 1e-20, 1e-30] {
        let mesh = scaled(unit);
        let aligned = align(&observation, &mesh, &quick(), &mut Silent).unwrap_err();
        let pose = Similarity { scale: 1.0 / f64::from(unit), ..truth() };
        let evaluated = evaluate(&observation, &mesh, &pose, &EvaluateOptions::default()).unwrap_err();
        for error in [aligned, evaluated] {
            assert_eq!((error.code, &*error.argument), (ErrorCode::DegenerateMesh, "mesh"), "{unit}: {error}");
        }
    }
    // Nanometres and kilometres.
    for unit in [1e9, 1e-3] {
        let alignment = align(&observation, &scaled(unit), &quick(), &mut Silent).unwrap();
        assert!((alignment.camera_from_mesh.scale * f64::from(unit) / truth().scale - 1.0).abs() < 0.05, "{unit}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn grids_are_bounded() {
    let focal = [500.0; 2];
    let views = [
        ("blob", view(VGA, focal, blob)),
        ("diagonal line", view(VGA, focal, |u, v| u == v)),
        ("thick diagonal", view(VGA, focal, |u, v| u.abs_diff(v) < 3)),
        ("rod", view(VGA, focal, |u, v| v.abs_diff(240) < 2 && u > 20 && u < 620)),
        ("long image", view([10, 10_000], [1e4; 2], |_, _| true)),
        ("wide pixels", view(VGA, [500.0, 30.0], blob)),
        ("high pixels", view(VGA, [30.0, 500.0], blob)),
        ("pixels apart", view(VGA, focal, |u, v| (7919 * u + 104_729 * v).is_multiple_of(997))),
    ];
    for (name, view) in views {
        let clean = CleanObservation::new(&view.unwrap());
        for cells in [120, 500, 3000, 7000] {
            let grid = CropGrid::new(&clean, cells);
            let size = grid.width * grid.height;
            // Rows and columns are rounded up.
            assert!(size <= 193 * cells + 4 * (grid.width + grid.height), "{name}: {size} cells for {cells}");
            assert!(name != "blob" || size < 12 * cells, "an ordinary grid has {size} cells for {cells}");
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn unconnected_triangles_are_decimated() {
    for size in [1.0, 1e-4] {
        let mesh = soup(20_000, size);
        let coarse = decimate(&mesh, 500);
        assert!(coarse.triangles().len() <= 2000, "{size}: {} triangles", coarse.triangles().len());
        assert!(coarse.positions().len() <= 6000, "{size}: {} vertices", coarse.positions().len());
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn vertices_without_triangles_are_removed() {
    let mesh = body();
    let mut positions = vec![Vec3::splat(1e6); 1000];
    positions.extend_from_slice(mesh.positions());
    let shifted = mesh.triangles().iter().map(|t| t.map(|i| i + 1000)).collect();
    let padded = Mesh::new(positions, shifted).unwrap();
    assert_eq!(PreparedMesh::new(padded.clone()).mesh(), &mesh);
    assert!(mesh.without_unused_vertices().is_none());
    let observation = observe(&mesh, &truth());
    let [found, expected] = [&padded, &mesh].map(|mesh| align(&observation, mesh, &quick(), &mut Silent).unwrap());
    assert_eq!(found.camera_from_mesh, expected.camera_from_mesh);
}

#[wasm_bindgen_test(unsupported = test)]
fn a_render_visits_a_bounded_number_of_cells() {
    let clean = CleanObservation::new(&view(VGA, [500.0; 2], blob).unwrap());
    let grid = CropGrid::new(&clean, 3000);
    let pose = CropPose {
        rotation: glam::DQuat::IDENTITY,
        // Three times as large as the mask.
        size: 0.2,
        place: glam::DVec2::ZERO,
        distance: 0.0,
    };
    let mut canvas = Canvas::default();
    let mut cost = |mesh: &Mesh| {
        canvas.work = 0;
        canvas.draw(&Model::new(mesh), &pose, &grid);
        canvas.work as usize
    };
    let cells = grid.width * grid.height;
    let large = soup(20_000, 1.0);
    let work = cost(&large);
    assert!(work > 20 * cells, "the triangles overlap: {work}");
    assert!(work < 40 * cells + 80_000, "{work} for {cells} cells");
    assert!(cost(&body()) < 10 * cells + 20_000);
}

/// Number of images that a search with these settings draws.
fn renders_of(observation: &Observation, mesh: &Mesh, settings: SearchSettings) -> usize {
    let request = Request::new(quick()).unwrap().with_efforts(vec![settings]);
    let alignment = align_prepared(observation, &PreparedMesh::borrowed(mesh), request, &mut Silent).unwrap();
    alignment.diagnostics.counts.renders
}

#[wasm_bindgen_test(unsupported = test)]
fn a_bound_on_work_bounds_renders_of_costly_inputs() {
    let observation = view(VGA, [500.0; 2], blob).unwrap();
    let mesh = soup(3000, 1.0);
    let renders = |max_load: u64| {
        let settings = SearchSettings { max_load, ..SearchSettings::from(Effort::Fast) };
        renders_of(&observation, &mesh, settings)
    };
    let [unbounded, bounded] = [u64::from(u32::MAX), 4].map(renders);
    assert!(4 * bounded < unbounded, "{bounded} renders instead of {unbounded}");
    let ordinary = observe(&body(), &truth());
    let of_body = |max_load: u64| {
        let settings = SearchSettings { max_load, ..SearchSettings::from(Effort::Fast) };
        renders_of(&ordinary, &body(), settings)
    };
    assert_eq!(of_body(12), of_body(u64::from(u32::MAX)), "an ordinary input is within every bound");
}

#[wasm_bindgen_test(unsupported = test)]
fn depths_beyond_the_numbers_are_refused() {
    let ordinary = observe(&body(), &truth());
    let (width, height) = (ordinary.depth().width(), ordinary.depth().height());
    let scaled = |unit: f32| {
        let depths = ordinary.depth().data().iter().map(|z| z * unit).collect();
        Observation::new(
            DepthMap::from_metres(width, height, depths).unwrap(),
            ordinary.mask().clone(),
            ordinary.camera(),
        )
    };
    for unit in [1e-40, 1e-20, 1e20, 1e37] {
        let error = scaled(unit).unwrap_err();
        assert_eq!((error.code, &*error.argument), (ErrorCode::NoDepthInMask, "depth"), "{unit}: {error}");
    }
    // Some of the readings: they count as none.
    let mixed = ordinary.depth().data().iter().enumerate();
    let mixed = mixed.map(|(i, z)| if i % 3 == 0 { f32::MIN_POSITIVE } else { *z }).collect();
    let mixed = DepthMap::from_metres(width, height, mixed).unwrap();
    let mixed = Observation::new(mixed, ordinary.mask().clone(), ordinary.camera()).unwrap();
    let alignment = align(&mixed, &body(), &quick(), &mut Silent).unwrap();
    assert!(alignment.diagnostics.score.is_finite() && alignment.confidence > 0.0);
    for unit in [1e-9, 1e9] {
        let alignment = align(&scaled(unit).unwrap(), &body(), &quick(), &mut Silent).unwrap();
        assert!((alignment.camera_from_mesh.scale / f64::from(unit) / truth().scale - 1.0).abs() < 0.05, "{unit}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn suspicious_inputs_are_warned_of() {
    let codes = |observation: &Observation| {
        about_observation(observation).into_iter().map(|warning| warning.code).collect::<Vec<WarningCode>>()
    };
    let white = view([64, 48], [60.0; 2], |_, _| true).unwrap();
    assert!(codes(&white).contains(&WarningCode::MaskCoversImage));
    let ordinary = observe(&body(), &truth());
    assert!(codes(&ordinary).is_empty());
    let (width, height) = (ordinary.depth().width(), ordinary.depth().height());
    let metres = ordinary.depth().data().iter().map(|z| 0.001 * z).collect();
    let depth = DepthMap::from_metres(width, height, metres).unwrap();
    let twice = Observation::new(depth, ordinary.mask().clone(), ordinary.camera()).unwrap();
    assert_eq!(codes(&twice), [WarningCode::DepthLooksTooSmall]);
}

#[wasm_bindgen_test(unsupported = test)]
fn poses_of_every_size_are_evaluated() {
    let observation = observe(&body(), &truth());
    for exponent in -12..=12 {
        let scale = libm::pow(10.0, f64::from(exponent));
        let translation = Vector3::new(0.0, 0.0, scale);
        let pose = Similarity { scale, rotation: Rotation3::identity(), translation };
        let metrics = evaluate(&observation, &body(), &pose, &EvaluateOptions::default()).unwrap().metrics;
        let values = [metrics.iou, metrics.boundary_f, metrics.fitness, metrics.normal_consistency];
        assert!(values.iter().flatten().all(|share| (0.0..=1.0).contains(share)), "1e{exponent}: {metrics:?}");
    }
}
