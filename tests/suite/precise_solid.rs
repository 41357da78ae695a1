//! Back faces of closed meshes: when they are left out, and that nothing is lost without them.

use std::collections::BTreeMap;

use sim3align::geometry::decimate::decimate;
use sim3align::precise::drawn::mesh_pyramid::MeshPyramid;
use sim3align::precise::drawn::solid::{faces_outward, is_closed};

use crate::precise_scene::{HEIGHT, WIDTH, empty_grid, pose};
use crate::prelude::*;
use crate::shapes::inverted;

/// Whether every edge is used as often in one direction as in the other, by a table of all edges.
fn is_balanced(mesh: &Mesh) -> bool {
    let mut uses: BTreeMap<[u32; 2], i32> = BTreeMap::new();
    for &[a, b, c] in mesh.triangles() {
        for [from, to] in [[a, b], [b, c], [c, a]] {
            *uses.entry([from.min(to), from.max(to)]).or_default() += if from < to { 1 } else { -1 };
        }
    }
    uses.values().all(|uses| *uses == 0)
}

fn bumpy(rings: u32) -> Mesh {
    mapped(&ellipsoid(Vec3::new(0.5, 0.36, 0.28), rings), |p| {
        p * (1.0 + 0.4 * libm::sinf(5.0 * p.x + 1.0) * libm::sinf(6.0 * p.y + 0.4))
    })
}

fn with_triangles(mesh: &Mesh, change: impl FnOnce(&mut Vec<[u32; 3]>)) -> Mesh {
    let mut triangles = mesh.triangles().to_vec();
    change(&mut triangles);
    Mesh::new(mesh.positions().to_vec(), triangles).unwrap()
}

#[wasm_bindgen_test(unsupported = test)]
fn a_mesh_is_closed_if_its_edges_are_used_both_ways() {
    let solid = bumpy(9);
    let apart = mapped(&cuboid(Vec3::ONE), |p| p + Vec3::X * 3.0);
    let closed = [solid.clone(), inverted(&solid), decimate(&solid, 60), joined(&solid, &apart)];
    for (k, mesh) in closed.iter().enumerate() {
        assert!(is_closed(mesh) && is_balanced(mesh), "closed mesh {k}");
    }
    let mut draw = Draw::new(11);
    for k in 0..200 {
        let [i, j] = [0; 2].map(|_| draw.below(solid.triangles().len()));
        let changed = with_triangles(&solid, |triangles| match k % 4 {
            0 => drop(triangles.swap_remove(i)),
            1 => triangles[i].swap(0, 1),
            2 => triangles.push(triangles[j]),
            _ => triangles[i][0] = triangles[j][1],
        });
        assert_eq!(is_closed(&changed), is_balanced(&changed), "seed 11, mesh {k}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn every_part_must_face_outward() {
    let (one, other) = (bumpy(8), mapped(&sphere(0.2, 6), |p| p + Vec3::X));
    assert!(faces_outward(&one) && faces_outward(&joined(&one, &other)));
    assert!(!faces_outward(&inverted(&one)) && !faces_outward(&joined(&one, &inverted(&other))));
}

#[wasm_bindgen_test(unsupported = test)]
fn only_closed_meshes_are_culled_on_every_grid() {
    let grids = SearchSettings::from(Effort::Fast).grids;
    let are_culled = |mesh: &Mesh| MeshPyramid::new(mesh, &grids).unwrap().models.map(|model| model.is_culled);
    let solid = bumpy(60);
    assert_eq!(are_culled(&solid), [true; 5]);
    assert_eq!(are_culled(&inverted(&solid)), [false; 5]);
    // Half of it is an open bowl.
    let bowl = with_triangles(&solid, |triangles| triangles.retain(|t| solid.corners(*t).iter().all(|p| p.z < 0.02)));
    assert_eq!(are_culled(&bowl.without_unused_vertices().unwrap()), [false; 5]);
}

/// Both images of a pose: with back faces, and without.
fn images(model: &Model, pose: &CropPose) -> [Canvas; 2] {
    let grid = empty_grid(WIDTH, HEIGHT);
    [false, true].map(|is_culled| {
        let mut model = model.clone();
        model.is_culled = is_culled;
        let mut canvas = Canvas::default();
        canvas.draw(&model, pose, &grid);
        canvas
    })
}

#[wasm_bindgen_test(unsupported = test)]
fn silhouettes_are_the_same_without_back_faces_and_depths_but_at_their_rims() {
    let fine = bumpy(24);
    // Thin walls and coarse meshes intersect themselves.
    let shell = mapped(&inverted(&fine), |p| p * 0.97 + Vec3::Z * 1e-3);
    let models = [fine.clone(), decimate(&fine, 150), decimate(&joined(&fine, &shell), 200)];
    let mut draw = Draw::new(5);
    for (k, mesh) in models.iter().enumerate() {
        assert!(is_closed(mesh));
        let model = Model::new(mesh);
        let (mut cells, mut others, mut least) = (0, 0, u64::MAX);
        for n in 0..60 {
            let pose = pose(&mut draw, 18.0);
            let [all, front] = images(&model, &pose);
            least = least.min(all.work - front.work);
            for (i, (a, b)) in all.inverse_depth.iter().zip(&front.inverse_depth).enumerate() {
                assert_eq!(*a > 0.0, *b > 0.0, "seed 5, mesh {k}, pose {n}, cell {i}");
                cells += usize::from(*a > 0.0);
                // What is left out was nearer: by rounding, or where a coarse mesh intersects itself.
                assert!(b <= a, "seed 5, mesh {k}, pose {n}, cell {i}: {a} {b}");
                others += usize::from((a - b).abs() > 1e-5 * a);
            }
        }
        let most = [0.0, 0.01, 0.25][k];
        assert!(others as f64 <= most * cells as f64, "mesh {k}: {others} of {cells} cells");
        assert!(least > 0, "mesh {k}: nothing was left out");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn back_faces_are_drawn_where_the_mesh_is_cut_by_the_near_plane() {
    let model = Model::new(&bumpy(12));
    let mut draw = Draw::new(7);
    let mut cut = 0;
    for n in 0..40 {
        // So large that some vertices are behind the camera.
        let pose = CropPose { size: libm::log(draw.between(2.5, 6.0)), ..pose(&mut draw, 4.0) };
        let [all, front] = images(&model, &pose);
        let (scale, translation) = pose.scale_translation();
        let is_behind = |p: &Vec3| (pose.rotation * p.as_dvec3() * scale + translation).z < 0.0;
        if model.positions.iter().any(is_behind) {
            cut += 1;
            assert_eq!(all.inverse_depth, front.inverse_depth, "seed 7, pose {n}");
            assert_eq!(all.work, front.work, "seed 7, pose {n}");
        }
    }
    assert!(cut > 10, "{cut} poses are cut");
}
