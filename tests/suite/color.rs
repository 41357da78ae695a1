//! Colour: it decides between the turns that shape cannot tell, and leaves everything else as it is.

use sim3align::align::align_prepared;
use sim3align::align::search::Request;
use sim3align::evidence::photo::Photo;
use sim3align::geometry::rasteriser::NO_TRIANGLE;
use sim3align::geometry::surface_colors::{COLOR_SAMPLES, Rgb, SurfaceColors};
use sim3align::report::ColorVerdict;

use crate::observations::{errors, observe, quick};
use crate::prelude::*;

/// Colours as a function of position and outward normal, mesh frame.
type Paint = fn(Vec3, Vec3) -> Vec3;

const EXTENT: Vec3 = Vec3::new(0.5, 0.9, 0.35);

pub fn carton() -> Mesh {
    cuboid(EXTENT)
}

/// Patches that differ from side to side.
pub fn label(p: Vec3, n: Vec3) -> Vec3 {
    let at = p / EXTENT;
    let patch = |u: f32, v: f32, half: f32| (at.y - u).abs() < half && (at.x + at.z - v).abs() < half;
    if n.z > 0.5 && patch(0.2, 0.1, 0.18) {
        Vec3::new(0.8, 0.15, 0.1)
    } else if n.x.abs() > 0.5 && patch(0.1 * n.x, 0.2 * n.x, 0.2) {
        Vec3::new(0.1, 0.2, 0.7)
    } else if patch(-0.3, 0.0, 0.1) {
        Vec3::new(0.05, 0.05, 0.05)
    } else {
        Vec3::new(0.75, 0.7, 0.4)
    }
}

fn uniform(_: Vec3, _: Vec3) -> Vec3 {
    Vec3::new(0.3, 0.6, 0.5)
}

/// Another object's print.
fn other(p: Vec3, _: Vec3) -> Vec3 {
    if libm::sinf(23.0 * p.x + 9.0 * p.y) * libm::sinf(17.0 * p.z - 11.0 * p.y) > 0.0 {
        Vec3::new(0.7, 0.2, 0.6)
    } else {
        Vec3::new(0.2, 0.6, 0.3)
    }
}

fn rgb(color: Vec3) -> Rgb {
    (color * 255.0).to_array().map(|x| x.round().clamp(0.0, 255.0) as u8)
}

pub fn painted(mesh: &Mesh, paint: Paint) -> SurfaceColors {
    let samples = sample_surface(mesh, COLOR_SAMPLES, 0).unwrap();
    let colors = samples.points.iter().zip(&samples.normals).map(|(p, n)| rgb(paint(*p, *n))).collect();
    SurfaceColors::new(samples, colors).unwrap()
}

/// The carton with its print.
pub fn printed_mesh() -> PreparedMesh<'static> {
    PreparedMesh::new(carton()).with_colors(painted(&carton(), label))
}

/// The photo that the camera of [`observe`] takes, with these gains, `light` on what faces the camera, and an offset.
pub fn photo(mesh: &Mesh, pose: &Similarity, paint: Paint, (gain, light): (Vec3, f32), shift: usize) -> Photo {
    let observation = observe(mesh, pose);
    let (width, height) = (observation.depth().width(), observation.depth().height());
    let mut rasteriser = Rasteriser::new();
    rasteriser.render(mesh, pose, &observation.camera(), width, height);
    let inverse = pose.inverse();
    let color = |i: usize| {
        let (triangle, z) = (rasteriser.triangles()[i], f64::from(rasteriser.depth()[i]));
        if triangle == NO_TRIANGLE {
            return [90, 80, 70];
        }
        let point = observation.camera().back_project((i % width) as f64, (i / width) as f64, z);
        let [a, b, c] = mesh.corners(mesh.triangles()[triangle as usize]);
        let normal = (b - a).cross(c - a).normalize();
        let facing = -(pose.rotation * vector3(normal)).z as f32;
        rgb(paint(vec3(&inverse.apply(vector3(point))), normal) * gain * (1.0 - light + light * facing))
    };
    let pixels = (0..width * height).map(|i| if i % width >= shift { color(i - shift) } else { [90, 80, 70] });
    Image::new("image", width, height, pixels.collect()).unwrap()
}

fn truth() -> Similarity {
    similarity(0.17, [0.7, -0.5, 1.1], [0.01, -0.01, 0.6])
}

fn solve(observation: Observation, mesh: &PreparedMesh<'_>) -> Alignment {
    align_prepared(&observation, mesh, Request::new(quick()).unwrap(), &mut Silent).unwrap()
}

#[wasm_bindgen_test]
fn the_print_decides_which_side_of_a_box_faces_the_camera() {
    let mesh = carton();
    let prepared = printed_mesh();
    let turns = [Vector3::zeros(), Vector3::x(), Vector3::y(), Vector3::z()].map(|axis| axis * core::f64::consts::PI);
    let mut decided = 0;
    for (i, turn) in turns.into_iter().enumerate() {
        let pose = Similarity { rotation: truth().rotation * Rotation3::new(turn), ..truth() };
        // Darker, bluer, lit from the camera, and two pixels off.
        let look = (Vec3::new(0.6, 0.7, 0.9), 0.5);
        let seen = observe(&mesh, &pose).with_photo(photo(&mesh, &pose, label, look, 2)).unwrap();
        let found = solve(seen, &prepared);
        let color = found.diagnostics.color.unwrap();
        let error = errors(&mesh, &pose_of(&found.camera_from_mesh), &pose).rotation_error_deg;
        assert!(error < 2.0 && color.agreement > 0.6 && color.margin.unwrap() > 0.2, "turn {i}: {error}°, {color:?}");
        assert!(found.confidence > 0.5, "turn {i}: {}", found.confidence);
        decided += usize::from(color.verdict == ColorVerdict::Decided);
    }
    // Shape takes one of the four.
    assert_eq!(decided, 3);
}

#[wasm_bindgen_test]
fn without_photo_or_colours_the_answer_is_that_of_shape_to_the_bit() {
    let mesh = carton();
    let plain = PreparedMesh::borrowed(&mesh);
    let seen = observe(&mesh, &truth());
    let with_photo = seen.clone().with_photo(photo(&mesh, &truth(), label, (Vec3::ONE, 0.0), 0)).unwrap();
    let expected = solve(seen.clone(), &plain);
    assert_eq!(solve(seen, &printed_mesh()), expected);
    assert_eq!(solve(with_photo.clone(), &plain), expected);
    // Colours that could not be read would tell its four turns apart.
    let lacking = PreparedMesh::borrowed(&mesh).lacking_colors(true);
    let options = AlignOptions { symmetry: Symmetry::Auto, ..quick() };
    let turn_of = |seen: Observation, mesh: &PreparedMesh<'_>| {
        let found = align_prepared(&seen, mesh, Request::new(options.clone()).unwrap(), &mut Silent).unwrap();
        found.turn_confidence
    };
    assert_eq!(turn_of(with_photo.clone(), &lacking), Some(0.25));
    assert_eq!(turn_of(with_photo, &plain), None);
    assert_eq!(turn_of(observe(&mesh, &truth()), &lacking), None);
}

#[wasm_bindgen_test]
fn one_colour_and_wrong_colours_leave_the_pose_of_shape() {
    let mesh = carton();
    let seen = observe(&mesh, &truth());
    let shape = solve(seen.clone(), &PreparedMesh::borrowed(&mesh));
    let cases: [(Paint, Paint, ColorVerdict); 2] =
        [(uniform, uniform, ColorVerdict::Uniform), (label, other, ColorVerdict::Unmatched)];
    for (object, generated, verdict) in cases {
        let seen = seen.clone().with_photo(photo(&mesh, &truth(), object, (Vec3::ONE, 0.4), 1)).unwrap();
        let found = solve(seen, &PreparedMesh::borrowed(&mesh).with_colors(painted(&mesh, generated)));
        assert_eq!(found.camera_from_mesh, shape.camera_from_mesh, "{verdict:?}");
        let color = found.diagnostics.color.unwrap();
        assert_eq!(color.verdict, verdict, "{color:?}");
        match verdict {
            ColorVerdict::Uniform => assert_eq!(found.confidence, shape.confidence),
            // The colours of the mesh tell its sides apart, and the photo does not say which is seen.
            _ => assert!(found.confidence < 0.9 * shape.confidence && !found.alternatives.is_empty()),
        }
    }
}
