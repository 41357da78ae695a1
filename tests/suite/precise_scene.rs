//! What the tests of the parts of `precise` share: a body, random poses, and grids of random evidence around it.

use glam::{DQuat, DVec2, DVec3, Vec3};
use sim3align::geometry::mesh::Mesh;
use sim3align::geometry::rotations::exp;
use sim3align::precise::drawn::pose::{CropPose, MeshFrame};
use sim3align::precise::drawn::render::{Canvas, Model};
use sim3align::precise::observed::grid::CropGrid;
use sim3align::precise::scored::score::{Scoring, Weights};

use crate::shapes::{ellipsoid, mapped};
use crate::support::Draw;

pub const WIDTH: usize = 56;
pub const HEIGHT: usize = 44;

/// A body without symmetry in its own frame, with some of its faces turned over.
pub fn model() -> Model {
    let body = mapped(&ellipsoid(Vec3::new(0.5, 0.36, 0.28), 10), |p| {
        p * (1.0 + 0.4 * libm::sinf(5.0 * p.x + 1.0) * libm::sinf(6.0 * p.y + 0.4))
    });
    let triangles = (0..).zip(body.triangles()).map(|(i, &[a, b, c])| if i % 3 == 0 { [a, c, b] } else { [a, b, c] });
    let body = Mesh::new(body.positions().to_vec(), triangles.collect()).unwrap();
    Model::new(&MeshFrame::of(&body).normalized(&body).unwrap())
}

pub fn rotation(draw: &mut Draw) -> DQuat {
    DQuat::from_xyzw(draw.normal(), draw.normal(), draw.normal(), draw.normal()).normalize()
}

/// A pose whose picture fills about half of the grid; `off` moves its middle away from the grid's, in cells.
pub fn pose(draw: &mut Draw, off: f64) -> CropPose {
    let mut place = || draw.between(-off, off) / FOCAL;
    let place = DVec2::new(place(), place());
    CropPose {
        rotation: rotation(draw),
        size: libm::log(draw.between(0.45, 0.65)),
        place,
        distance: draw.between(-0.9, 0.3),
    }
}

pub const FOCAL: f64 = 60.0;

/// A grid that holds no evidence.
pub fn empty_grid(width: usize, height: usize) -> CropGrid {
    let cells = width * height;
    CropGrid {
        width,
        height,
        focal: FOCAL,
        center: [0.5 * width as f64 - 0.5, 0.5 * height as f64 - 0.5],
        cell: [1.0; 2],
        corner: [0.0; 2],
        mask: vec![false; cells],
        mask_cells: 0,
        depth_cells: 0,
        depth: vec![0.0; cells],
        normals: vec![Vec3::ZERO; cells],
        scene: vec![0.0; cells],
        known: 0.0,
        outline: vec![0.0; cells],
        bounds: [[0.0, width as f64], [0.0, height as f64]],
    }
}

/// Evidence that is the picture of `pose` with faults: the mask differs at its rim, depths and normals are off or
/// missing, something nearer stands before one side, and some cells have no reading at all. The outline is a quadratic
/// over the grid, of which central differences are exact.
pub fn noisy_grid(draw: &mut Draw, model: &Model, pose: &CropPose, scoring: &Scoring) -> CropGrid {
    let mut grid = empty_grid(WIDTH, HEIGHT);
    let mut canvas = Canvas::default();
    canvas.draw(model, pose, &grid);
    let coefficients: [f64; 6] = core::array::from_fn(|_| draw.between(-1.0, 1.0));
    let occluder = draw.below(WIDTH);
    let z_m = libm::exp(pose.distance);
    for v in 0..HEIGHT {
        for u in 0..WIDTH {
            let i = v * WIDTH + u;
            let w = canvas.inverse_depth[i];
            grid.mask[i] = (w > 0.0) != (draw.below(12) == 0);
            if grid.mask[i] && draw.below(5) > 0 {
                let z = if w > 0.0 { f64::from(1.0 / w) } else { z_m };
                // From hardly off to far off.
                let off = f64::from(scoring.depth_m) * draw.normal() * [0.05, 0.6, 4.0][draw.below(3)];
                grid.depth[i] = (z + off) as f32;
                if w > 0.0 && draw.below(5) > 0 {
                    let normal = facing(&canvas, model, &grid, u, v);
                    let turn = exp(DVec3::from(<[f64; 3]>::from(draw.direction())) * draw.between(0.0, 0.7));
                    grid.normals[i] = (turn * normal.as_dvec3()).as_vec3();
                }
            }
            grid.scene[i] = match draw.below(6) {
                0 => 0.0,
                1..4 if u < occluder => (z_m * draw.between(0.3, 0.6)) as f32,
                _ => (z_m * draw.between(0.9, 1.6)) as f32,
            };
            let (x, y) = (u as f64 / 20.0 - 1.4, v as f64 / 20.0 - 1.1);
            let terms = [1.0, x, y, x * x, x * y, y * y];
            grid.outline[i] = (3.0 * terms.iter().zip(coefficients).map(|(t, c)| t * c).sum::<f64>()) as f32;
        }
    }
    // Between a depth map without background and a complete one.
    grid.known = draw.between(0.0, 0.5) as f32;
    grid.mask_cells = grid.mask.iter().filter(|set| **set).count();
    grid
}

/// The normal of what is drawn in a cell, towards the camera.
pub fn facing(canvas: &Canvas, model: &Model, grid: &CropGrid, u: usize, v: usize) -> Vec3 {
    let normal = canvas.rotation * model.normals[canvas.triangle[v * grid.width + u] as usize];
    if normal.dot(grid.ray(u as f32, v as f32)) > 0.0 { -normal } else { normal }
}

pub fn scoring() -> Scoring {
    let weights =
        Weights { overlap: 0.3, depth: 1.1, normals: 0.4, outline: 0.7, occluded: 0.2, unknown: 0.1, silhouette: 1.0 };
    Scoring { weights, depth_m: 0.03, occluder_m: 0.04, outline_cells: 1.7 }
}
