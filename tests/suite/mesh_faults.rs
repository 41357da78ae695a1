//! Meshes that are not quite the object: in other proportions, and with parts that are not of it.

use sim3align::align::align;
use sim3align::align::evaluate::{EvaluateOptions, evaluate};
use sim3align::precise::drawing::ground_plate::without_plate;
use sim3align::precise::drawing::removed_parts::Trimmed;
use sim3align::precise::options::Proportions as Freedom;
use sim3align::precise::search::proportions::Proportions;
use sim3align::report::Stretch;
use sim3align::views::align_views;

use crate::observations::{body, observe, quick, truth, views};
use crate::prelude::*;
use crate::views::options;

fn proportions(draw: &mut Draw, most: f64) -> Proportions {
    Proportions::new(core::array::from_fn(|_| draw.between(-most, most)))
}

/// The lengths of the axes of a mesh, metres per unit.
fn lengths(scale: f64, stretch: &DMat3) -> [f64; 3] {
    [0, 1, 2].map(|axis| scale * stretch.col(axis).length())
}

#[wasm_bindgen_test]
fn a_mesh_is_put_into_its_proportions() {
    for seed in 0..2 {
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

fn moved(mesh: &Mesh, by: [f32; 3]) -> Mesh {
    mapped(mesh, |p| p + Vec3::from_array(by))
}

/// A plate of these extents under the z axis, with its top at `top`.
fn plate(extent: [f32; 3], top: f32) -> Mesh {
    moved(&cuboid(Vec3::from_array(extent)), [0.0, 0.0, top - 0.5 * extent[2]])
}

/// Meshes without surplus, several of which are made of parts.
fn legitimate() -> Vec<(&'static str, Mesh)> {
    let leg = |x: f32| moved(&cuboid(Vec3::new(0.05, 0.5, 0.5)), [x, 0.0, -0.27]);
    let bench = joined(&cuboid(Vec3::new(0.5, 0.5, 0.04)), &joined(&leg(0.2), &leg(-0.2)));
    let jar = ellipsoid(Vec3::new(0.3, 0.3, 0.4), 24);
    let lid = moved(&cuboid(Vec3::new(0.35, 0.35, 0.05)), [0.0, 0.0, 0.435]);
    let handle = moved(&sphere(0.03, 8), [0.0, 0.0, 0.5]);
    let halves = joined(&cuboid(Vec3::splat(0.4)), &moved(&cuboid(Vec3::splat(0.4)), [1.0, 0.0, 0.0]));
    vec![
        ("body", body()),
        ("box", cuboid(Vec3::new(0.2, 0.3, 0.5))),
        ("bench", bench),
        ("jar with a lid and a knob, apart by a hundredth", joined(&joined(&jar, &lid), &handle)),
        ("two halves, apart", halves),
    ]
}

#[wasm_bindgen_test]
fn meshes_of_several_parts_are_left_as_they_are() {
    for (name, mesh) in legitimate() {
        assert!(Trimmed::of(&mesh).is_none(), "{name}");
        assert!(without_plate(&mesh, &mesh).is_none(), "{name}");
        let prepared = PreparedMesh::borrowed(&mesh);
        assert!(core::ptr::eq(prepared.mesh(), &raw const mesh), "{name}");
    }
}

#[wasm_bindgen_test]
fn the_alignment_is_that_of_the_object_and_the_warning_says_what_is_left_out() {
    let object = body();
    let observation = observe(&object, &truth());
    let low = Bounds::of(object.positions()).unwrap().min.z;
    let ground = plate([1.6, 1.5, 0.02], low + 0.005);
    let alone = align(&observation, &object, &quick(), &mut Silent).unwrap();
    assert!(alone.warnings.is_empty(), "{:?}", alone.warnings);
    let floater = moved(&sphere(0.03, 6), [0.9, 0.2, 0.0]);
    // The floor of a scene, of which the object is a small part.
    let floor = plate([16.0, 15.0, 0.02], low - 0.02);
    for (surplus, word) in
        [(&floater, " 1 far from all others ("), (&ground, " 1 below, a plate ("), (&floor, " 1 below, a plate (99.")]
    {
        let mesh = joined(&object, surplus);
        let found = align(&observation, &mesh, &quick(), &mut Silent).unwrap();
        assert_eq!(found.camera_from_mesh, alone.camera_from_mesh, "{word}");
        assert_eq!(found.confidence, alone.confidence);
        let [warning] = found.warnings.as_slice() else { panic!("{:?}", found.warnings) };
        assert_eq!(warning.code, WarningCode::MeshPartsLeftOut);
        assert!(warning.message.contains(word), "{}", warning.message);
    }
    // Where the image shows the plate, it is a part of the object.
    let whole = joined(&object, &ground);
    let seen = align(&observe(&whole, &truth()), &whole, &quick(), &mut Silent).unwrap();
    assert!(seen.warnings.is_empty(), "{:?}", seen.warnings);
    let pose = pose_of(&seen.camera_from_mesh);
    assert!((pose.scale / truth().scale - 1.0).abs() < 0.02, "{}", pose.scale);
    // `evaluate` leaves out the floater, too.
    let floating = joined(&object, &floater);
    let of = |mesh: &Mesh| evaluate(&observation, mesh, &truth(), &EvaluateOptions::default()).unwrap();
    assert_eq!(of(&floating).metrics, of(&object).metrics);
    assert_eq!(of(&floating).warnings[0].code, WarningCode::MeshPartsLeftOut);
}

#[wasm_bindgen_test]
fn all_views_decide_on_a_plate() {
    let object = body();
    let low = Bounds::of(object.positions()).unwrap().min.z;
    let whole = joined(&object, &plate([1.6, 1.5, 0.02], low + 0.005));
    // The mask of the first view contains a mat; the others do not.
    let mut seen = views(&object, &[0.0, 1.3, 4.0]);
    seen[0].frame = views(&whole, &[0.0]).remove(0).frame;
    let found = align_views(seen, &PreparedMesh::borrowed(&whole), &options(), &mut Silent).unwrap();
    assert!(codes(&found.warnings).contains(&WarningCode::MeshPartsLeftOut), "{:?}", found.warnings);
}
