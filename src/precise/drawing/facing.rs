//! Which sides of its triangles a mesh shows. Of a closed one it is the outer sides alone: half of the triangles, those that face
//! away from the camera, need not be drawn.

use glam::DVec2;

use super::pose::CropPose;
use super::render::{Canvas, Model};
use crate::geometry::mesh::Mesh;
use crate::geometry::random::mixed;
use crate::geometry::rotations::super_fibonacci;
use crate::precise::observation::grid::CropGrid;
use crate::precise::observation::{GRIDS, SIEVE};

/// Images from around the mesh, their width in cells, and the distance of their camera in diagonals.
const VIEWS: usize = 16;
const WIDTH: usize = 48;
const DISTANCE: f64 = 4.0;
/// Difference of depth, in diagonals, from which on a cell shows another part of the mesh; and the largest share of such cells, where
/// decimation has folded a closed surface.
const OTHER: f32 = 0.01;
const FOLDED: f64 = 0.005;

/// Lets the models of a mesh draw one side of its triangles, if no other is seen: not of a sheet or a bowl without thickness.
pub fn draw_one_side(mesh: &Mesh, models: &mut [Model; GRIDS]) {
    // The image of the fronts of a closed surface covers the same cells. Clusters of vertices keep it closed.
    let edge = |from: u32, to: u32| mixed(u64::from(from) << 32 | u64::from(to));
    if !mesh.is_closed(|vertex| vertex, edge) {
        return;
    }
    let sign = if mesh.signed_volume6() < 0.0 { -1.0 } else { 1.0 };
    let both = images(&models[SIEVE]);
    models.iter_mut().for_each(|model| model.draw_one_side(sign));
    let one = images(&models[SIEVE]);
    let (mut others, mut drawn) = (0_usize, 0_usize);
    for (a, b) in both.iter().zip(&one).filter(|(a, _)| **a > 0.0) {
        others += usize::from((a - b).abs() > OTHER / DISTANCE as f32);
        drawn += 1;
    }
    if others as f64 > FOLDED * drawn as f64 {
        models.iter_mut().for_each(Model::draw_both_sides);
    }
}

/// The inverse depths of a mesh seen from around it.
fn images(model: &Model) -> Vec<f32> {
    let mut canvas = Canvas::default();
    let grid = CropGrid::blank(WIDTH, 0.9 * WIDTH as f64 * DISTANCE);
    let view = |k| {
        let rotation = super_fibonacci(k, VIEWS);
        let pose = CropPose { rotation, size: -libm::log(DISTANCE), place: DVec2::ZERO, distance: 0.0 };
        canvas.draw(model, &pose, &grid);
        canvas.inverse_depth.clone()
    };
    (0..VIEWS).flat_map(view).collect()
}
