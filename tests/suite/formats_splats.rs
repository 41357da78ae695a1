//! 3D Gaussian splats as meshes: the surface from which they were made, its colours, and damaged files.

use sim3align::align::align;
use sim3align_formats::splats::read_splats;
use sim3align_lab::samples::case::SampleCase;
use sim3align_lab::samples::shape::Kind;

use crate::formats_fixtures::fixture;
use crate::prelude::*;
use crate::shapes::body;
use crate::splat_files::{Gaussian, gaussians, splat_ply, splat_records};

fn read(bytes: &[u8]) -> sim3align::error::Result<Mesh> {
    read_splats(bytes, false).map(|read| read.mesh)
}

/// Sorted distances of points on `mesh` to the surface of `to`, as shares of its diagonal.
fn distances(mesh: &Mesh, to: &Mesh) -> Vec<f64> {
    let tree = TriangleTree::new(to);
    let points = sample_surface(mesh, 4000, 3).unwrap().points;
    let distance = |p: &Vec3| f64::from(tree.nearest(*p).unwrap().distance_squared).sqrt() / to.diagonal();
    let mut distances: Vec<f64> = points.iter().map(distance).collect();
    distances.sort_by(f64::total_cmp);
    distances
}

/// Whether each edge of the triangles has as many triangles on one side as on the other.
fn is_closed(mesh: &Mesh) -> bool {
    let edges = mesh.triangles().iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    let mut balance = std::collections::BTreeMap::new();
    for [from, to] in edges {
        *balance.entry([from.min(to), from.max(to)]).or_insert(0) += if from < to { 1 } else { -1 };
    }
    balance.values().all(|sum| *sum == 0)
}

#[wasm_bindgen_test(unsupported = test)]
fn the_surface_from_which_gaussians_were_made_comes_back() {
    let dumbbell = joined(
        &cuboid(Vec3::new(2.0, 0.3, 0.3)),
        &mapped(&cuboid(Vec3::new(0.5, 1.0, 1.0)), |p| p + Vec3::new(1.0, 0.0, 0.0)),
    );
    let shapes = [
        ("body", body(), 0.003),
        ("box", cuboid(Vec3::new(1.0, 2.0, 0.6)), 0.002),
        ("dumbbell", dumbbell, 0.002),
        // Far from the origin, in another unit.
        ("ball", mapped(&sphere(300.0, 40), |p| p + Vec3::new(4000.0, -900.0, 20.0)), 0.003),
        ("flat", ellipsoid(Vec3::new(1.0, 0.8, 0.06), 40), 0.001),
    ];
    for (seed, (name, mesh, noise)) in shapes.into_iter().enumerate() {
        for count in [6_000, 60_000] {
            let splat = gaussians(&mesh, count, noise, seed as u64, |_| [0; 3]);
            for bytes in [splat_ply(&splat), splat_records(&splat)] {
                let found = read(&bytes).unwrap();
                assert!(is_closed(&found) && found.signed_volume6() > 0.0, "{name}, {count}");
                let there = distances(&found, &mesh);
                let back = distances(&mesh, &found);
                // What is inside the dumbbell is no part of its surface.
                let medians = [there[2000], if name == "dumbbell" { 0.0 } else { back[2000] }];
                assert!(medians.iter().all(|median| *median < 0.005), "{name}, {count}: {medians:?}");
                assert!(there[3990] < 0.03, "{name}, {count}: floaters at {}", there[3990]);
                let [a, b] = [&found, &mesh].map(|mesh| Bounds::of(mesh.positions()).unwrap());
                let off = (a.extent() - b.extent()).abs().max_element() / b.diagonal();
                assert!(off < 0.01, "{name}, {count}: the box {:?} instead of {:?}", a.extent(), b.extent());
                let off = f64::from((a.center() - b.center()).length()) / mesh.diagonal();
                assert!(off < 0.005, "{name}, {count}: the centre is off by {off}");
            }
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn gaussians_give_the_surface_their_colours() {
    let mesh = cuboid(Vec3::new(1.0, 2.0, 0.6));
    let color = |p: Vec3| [(128.0 + 100.0 * p.x) as u8, (128.0 + 60.0 * p.y) as u8, 20];
    let splat = gaussians(&mesh, 20_000, 0.001, 5, color);
    for bytes in [splat_ply(&splat), splat_records(&splat)] {
        let colors = read_splats(&bytes, true).unwrap().colors.unwrap();
        let mut off: Vec<u8> = (colors.samples().points.iter().zip(colors.colors()))
            .map(|(point, found)| found.iter().zip(color(*point)).map(|(a, b)| a.abs_diff(b)).max().unwrap())
            .collect();
        off.sort_unstable();
        // Few Gaussians inside, of another colour, are near the surface.
        assert!(
            off[off.len() / 2] <= 3 && off[off.len() * 9 / 10] <= 16,
            "{} {}",
            off[off.len() / 2],
            off[off.len() * 9 / 10]
        );
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn a_sheet_of_gaussians_without_an_inside_has_two_sides() {
    let disc = |i: usize| Gaussian {
        center: Vec3::new((i % 60) as f32, (i / 60) as f32, 0.0),
        scales: Vec3::new(0.6, 0.6, 0.01),
        rotation: glam::Quat::IDENTITY,
        opacity: 0.9,
        color: [9, 8, 7],
    };
    let sheet: Vec<Gaussian> = (0..3600).map(disc).collect();
    let found = read(&splat_ply(&sheet)).unwrap();
    let [low, high] = [Bounds::of(found.positions()).unwrap()].map(|b| [b.min, b.max])[0];
    assert!(low.x > -2.0 && high.x < 61.0 && low.x < 1.0 && high.x > 58.0, "{low} {high}");
    assert!(is_closed(&found) && high.z - low.z < 0.6, "{low} {high}");
}

#[wasm_bindgen_test(unsupported = test)]
fn files_that_other_programs_wrote_have_the_same_surface() {
    // Of one ellipsoid, with semi-axes 1, 2 and 3 about (0.25, −0.5, 10).
    let [ply, records] = [fixture!("splat.ply"), fixture!("mesh.splat")]
        .map(|file| Bounds::of(read(file).unwrap().positions()).unwrap());
    for found in [ply, records] {
        assert!((found.center() - Vec3::new(0.25, -0.5, 10.0)).length() < 0.1, "{found:?}");
        assert!((found.extent() - Vec3::new(2.0, 4.0, 6.0)).abs().max_element() < 0.3, "{found:?}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn files_of_gaussians_say_what_is_wrong() {
    let whole = gaussians(&body(), 500, 0.001, 1, |_| [0; 3]);
    let code = |bytes: &[u8]| read(bytes).unwrap_err().code;
    let (ply, records) = (splat_ply(&whole), splat_records(&whole));
    assert_eq!(code(&ply[..ply.len() - 1]), ErrorCode::CorruptFile);
    assert_eq!([code(&records[..records.len() - 1]), code(&[])], [ErrorCode::CorruptFile; 2]);
    // A PLY file without rotations.
    assert_eq!(code(fixture!("mesh-little.ply")), ErrorCode::CorruptFile);
    let changed = |change: &dyn Fn(&mut Gaussian)| {
        let mut gaussians = gaussians(&body(), 500, 0.001, 1, |_| [0; 3]);
        gaussians.iter_mut().for_each(change);
        splat_ply(&gaussians)
    };
    assert_eq!(code(&changed(&|g| g.center.y = f32::NAN)), ErrorCode::NonFinite);
    assert_eq!(code(&changed(&|g| g.scales.x = f32::NAN)), ErrorCode::CorruptFile);
    assert_eq!(code(&changed(&|g| g.rotation.x = f32::INFINITY)), ErrorCode::CorruptFile);
    assert_eq!(code(&changed(&|g| g.opacity = 0.01)), ErrorCode::EmptyMesh);
    assert_eq!(code(&changed(&|g| (g.center, g.scales) = (Vec3::ONE, Vec3::ZERO))), ErrorCode::DegenerateMesh);
    assert_eq!(code(&changed(&|g| g.center *= 1e38)), ErrorCode::DegenerateMesh);
    assert_eq!(code(&splat_ply(&[])), ErrorCode::EmptyMesh);
    // Enormous Gaussians are cut to the size of the object.
    assert!(read(&changed(&|g| g.scales *= 1e30)).is_ok_and(|mesh| mesh.positions().iter().all(|p| p.is_finite())));
}

#[wasm_bindgen_test(unsupported = test)]
fn a_splat_is_aligned_where_its_mesh_is() {
    for (seed, kind) in [(1, Kind::Mug), (2, Kind::Hammer), (3, Kind::Occluded), (4, Kind::Mug), (5, Kind::Occluded)] {
        let case = SampleCase::new(kind, seed).unwrap();
        let splat = read(&splat_ply(&gaussians(&case.mesh, 40_000, 0.002, seed, |_| [0; 3]))).unwrap();
        let place = |mesh: &Mesh| {
            align(&case.observation, mesh, &AlignOptions::default(), &mut Silent).unwrap().camera_from_mesh
        };
        let [expected, found] = [place(&case.mesh), place(&splat)];
        let ratio = found.scale / expected.scale;
        assert!((ratio - 1.0).abs() < 0.01, "{kind:?} {seed}: scale {ratio}");
        let rotations = [&expected, &found].map(|sim3| {
            Rotation3::from_matrix_unchecked(nalgebra::Matrix3::from_fn(|i, j| sim3.rotation_matrix[i][j]))
        });
        let angle = rotations[0].angle_to(&rotations[1]).to_degrees();
        assert!(angle < 2.0, "{kind:?} {seed}: turned by {angle}°");
        let middle = Bounds::of(case.mesh.positions()).unwrap().center();
        let middle = Vector3::new(f64::from(middle.x), f64::from(middle.y), f64::from(middle.z));
        let [a, b] = [0, 1].map(|i| {
            let sim3 = [&expected, &found][i];
            rotations[i] * middle * sim3.scale + Vector3::from(sim3.translation)
        });
        let off = (a - b).norm() / (case.mesh.diagonal() * expected.scale);
        assert!(off < 0.01, "{kind:?} {seed}: moved by {off} of the diameter");
    }
}
