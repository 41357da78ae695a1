//! Parts of meshes that are not of the object: which are left out, and which never.

use sim3align::align::align;
use sim3align::align::evaluate::{EvaluateOptions, evaluate};
use sim3align::geometry::mesh_parts::MeshParts;
use sim3align::geometry::surface::surface_area;
use sim3align::geometry::surface_colors::SurfaceColors;
use sim3align::precise::drawn::ground_plate::without_plate;
use sim3align::precise::drawn::surplus::Trimmed;

use crate::precise::{body, observe, quick, truth};
use crate::prelude::*;
use crate::shapes::{inverted, soup};

fn moved(mesh: &Mesh, by: [f32; 3]) -> Mesh {
    mapped(mesh, |p| p + Vec3::from_array(by))
}

/// A plate of these extents under the z axis, with its top at `top`.
fn plate(extent: [f32; 3], top: f32) -> Mesh {
    moved(&cuboid(Vec3::from_array(extent)), [0.0, 0.0, top - 0.5 * extent[2]])
}

/// Meshes without surplus, several of which are made of parts.
fn legitimate() -> Vec<(&'static str, Mesh)> {
    let leg = |x: f32, y: f32| moved(&cuboid(Vec3::new(0.05, 0.05, 0.5)), [x, y, -0.27]);
    let seat = cuboid(Vec3::new(0.5, 0.5, 0.04));
    let legs = [leg(0.2, 0.2), leg(-0.2, 0.2), leg(0.2, -0.2), leg(-0.2, -0.2)];
    let chair = legs.iter().fold(seat, |chair, leg| joined(&chair, leg));
    let jar = ellipsoid(Vec3::new(0.3, 0.3, 0.4), 24);
    let lid = moved(&cuboid(Vec3::new(0.35, 0.35, 0.05)), [0.0, 0.0, 0.435]);
    let handle = moved(&sphere(0.03, 8), [0.0, 0.0, 0.5]);
    let halves = joined(&cuboid(Vec3::splat(0.4)), &moved(&cuboid(Vec3::splat(0.4)), [1.0, 0.0, 0.0]));
    vec![
        ("body", body()),
        ("box", cuboid(Vec3::new(0.2, 0.3, 0.5))),
        ("chair", chair),
        ("jar with a lid and a knob, apart by a hundredth", joined(&joined(&jar, &lid), &handle)),
        ("two halves, apart", halves),
    ]
}

#[wasm_bindgen_test(unsupported = test)]
fn meshes_of_several_parts_are_left_as_they_are() {
    for (name, mesh) in legitimate() {
        assert!(Trimmed::of(&mesh).is_none(), "{name}");
        assert!(without_plate(&mesh).is_none(), "{name}");
        let prepared = PreparedMesh::borrowed(&mesh);
        assert!(core::ptr::eq(prepared.mesh(), &raw const mesh), "{name}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn parts_are_those_of_a_flood_over_shared_positions() {
    // Seams: every triangle has vertices of its own, and one zero is negative.
    let of = |mesh: &Mesh| soup(mesh.triangles().iter().flat_map(|t| mesh.corners(*t)).collect());
    let one = of(&body());
    assert!(MeshParts::of(&one).is_none());
    let two = joined(&one, &of(&moved(&sphere(0.1, 6), [0.0, 0.0, 2.0])));
    let parts = MeshParts::of(&two).unwrap();
    assert_eq!(parts.parts.len(), 2);
    let first = one.triangles().len();
    assert!(parts.of_triangle.iter().enumerate().all(|(k, part)| (*part == 1) == (k >= first)));
    let areas = [surface_area(&one), surface_area(&two) - surface_area(&one)];
    for (part, area) in parts.parts.iter().zip(areas) {
        assert!((part.area - area).abs() < 1e-9 * area, "{} {area}", part.area);
    }
    assert_eq!(parts.parts[0].bounds, Bounds::of(one.positions()).unwrap());
}

#[wasm_bindgen_test(unsupported = test)]
fn floaters_and_inner_shells_are_left_out_exactly() {
    let object = body();
    let blob = sphere(0.03, 6);
    let near = joined(&joined(&object, &moved(&blob, [0.9, 0.2, 0.0])), &moved(&blob, [-0.4, 0.8, 0.5]));
    let far = joined(&near, &moved(&blob, [40.0, 0.0, 0.0]));
    for (count, mesh) in [(2, near), (3, far)] {
        let trimmed = Trimmed::of(&mesh).unwrap();
        assert_eq!(trimmed.mesh, object);
        assert_eq!(
            (trimmed.left_out.floating.0, trimmed.left_out.inside, trimmed.left_out.ground),
            (count, (0, 0.0), 0.0)
        );
        let share = surface_area(&trimmed.surplus) / surface_area(&mesh);
        assert!((trimmed.left_out.floating.1 - share).abs() < 1e-9);
    }
    let shell = inverted(&mapped(&object, |p| p * 0.8));
    let hollow = joined(&object, &shell);
    let trimmed = Trimmed::of(&hollow).unwrap();
    assert_eq!((trimmed.mesh, trimmed.left_out.inside.0), (object.clone(), 1));
    // A window of a few triangles shows it.
    let open = Mesh::new(hollow.positions().to_vec(), hollow.triangles()[60..].to_vec()).unwrap();
    assert!(Trimmed::of(&open).is_none());
    // A speck does no harm.
    assert!(Trimmed::of(&joined(&object, &moved(&sphere(0.004, 4), [0.02, 0.0, 0.0]))).is_none());
}

#[wasm_bindgen_test(unsupported = test)]
fn a_plate_below_is_found_whether_it_is_a_part_or_not() {
    let object = body();
    let low = Bounds::of(object.positions()).unwrap().min.z;
    let apart = joined(&object, &plate([1.6, 1.5, 0.02], low + 0.005));
    let found = without_plate(&apart).unwrap();
    assert_eq!(found.mesh, object);
    let count = object.positions().len() as u32;
    let height = |i: &u32| object.positions()[*i as usize].z;
    let lowest = (0..count).min_by(|a, b| height(a).total_cmp(&height(b))).unwrap();
    let sliver = [[lowest, count, count + 1]];
    let fused = Mesh::new(apart.positions().to_vec(), [apart.triangles(), &sliver].concat()).unwrap();
    let found = without_plate(&fused).unwrap();
    let left = surface_area(&found.mesh) / surface_area(&object);
    assert!((0.9..=1.1).contains(&left), "{left}");
    // As large as the object, thick, or with the object on both sides, it is no plate.
    for mesh in
        [plate([1.0, 0.8, 0.02], low + 0.005), plate([1.6, 1.5, 0.2], low + 0.005), plate([1.6, 1.5, 0.02], 0.0)]
    {
        assert!(without_plate(&joined(&object, &mesh)).is_none());
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn the_alignment_is_that_of_the_object_and_the_warning_says_what_is_left_out() {
    let object = body();
    let observation = observe(&object, &truth());
    let low = Bounds::of(object.positions()).unwrap().min.z;
    let ground = plate([1.6, 1.5, 0.02], low + 0.005);
    let alone = align(&observation, &object, &quick(), &mut Silent).unwrap();
    assert!(alone.warnings.is_empty(), "{:?}", alone.warnings);
    let floater = moved(&sphere(0.03, 6), [0.9, 0.2, 0.0]);
    for (surplus, word) in [(&floater, " 1 far from all others ("), (&ground, " 1 below, a plate (")] {
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
    let pose = Similarity::from_column_major(&seen.camera_from_mesh.matrix).unwrap();
    assert!((pose.scale / truth().scale - 1.0).abs() < 0.02, "{}", pose.scale);
    // `evaluate` leaves out the floater, too.
    let floating = joined(&object, &floater);
    let of = |mesh: &Mesh| evaluate(&observation, mesh, &truth(), &EvaluateOptions::default()).unwrap();
    assert_eq!(of(&floating).metrics, of(&object).metrics);
    assert_eq!(of(&floating).warnings[0].code, WarningCode::MeshPartsLeftOut);
}

#[wasm_bindgen_test(unsupported = test)]
fn colours_of_what_is_left_out_do_not_count() {
    let object = body();
    let mesh = joined(&object, &moved(&sphere(0.05, 8), [0.9, 0.2, 0.0]));
    let colors = SurfaceColors::of_vertices(&mesh, &vec![[10, 20, 30]; mesh.positions().len()]).unwrap();
    let all = colors.samples().points.len();
    let prepared = PreparedMesh::new(mesh.clone()).with_colors(colors);
    let kept = prepared.colors().unwrap();
    assert!(kept.samples().points.len() < all && kept.samples().points.iter().all(|p| p.x < 0.7));
    assert_eq!(kept.colors().len(), kept.samples().points.len());
    let own = sample_surface(&mesh, all, 0).unwrap().points.iter().filter(|p| p.x < 0.7).count();
    assert_eq!(kept.samples().points.len(), own);
}
