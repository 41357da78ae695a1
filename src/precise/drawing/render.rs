//! The rasteriser of the search: thousands of small images per second.
//!
//! Unlike the [`Rasteriser`](crate::geometry::rasteriser::Rasteriser) of the metrics, which clips and uses f64, this
//! one uses f32 and skips triangles close to the camera. Both decide coverage in integers.

use core::ops::Range;

use glam::{Mat3, Vec3};
use wide::bytemuck::cast;
use wide::{f32x4, i32x4};

use super::fill::{Corners, STEPS, Vertex, fill};
use super::lanes::LANES;
use super::pose::CropPose;
use crate::counts;
use crate::geometry::mesh::Mesh;
use crate::precise::observation::grid::CropGrid;

/// Minimum depth of a rendered vertex, relative to the depth of the centre of the mesh.
const NEAR: f32 = 0.05;
/// Maximum number of cells that the triangles of a render visit, per cell of the grid: dozens of layers of the object,
/// whose image is a quarter of the grid. The triangles after that are left out.
const MAX_LAYERS: usize = 32;
/// Maximum coordinate of a vertex, in steps; larger ones are clamped.
const FARTHEST: f32 = 1_000_000.0;

/// A mesh prepared for rendering.
#[derive(Debug, Clone)]
pub struct Model {
    /// In the mesh frame.
    pub positions: Vec<Vec3>,
    /// Vertex indices.
    pub triangles: Vec<[u32; 3]>,
    /// Unit normals of the triangles.
    pub normals: Vec<Vec3>,
    /// The positions, four at a time, by axis. The last one fills the places of those that are missing.
    lanes: Vec<[f32x4; 3]>,
    /// The normals, with a fourth number.
    pub(in crate::precise) facets: Vec<f32x4>,
    /// The planes of the triangles, n·x > d on the side from which they are drawn, four at a time: n by axis, and d. Empty if both
    /// sides are drawn.
    planes: Vec<[f32x4; 4]>,
}

impl Model {
    /// From a mesh in its frame.
    pub fn new(mesh: &Mesh) -> Self {
        let normal = |t: &[u32; 3]| {
            let [a, b, c] = mesh.corners(*t);
            (b - a).cross(c - a).normalize_or_zero()
        };
        let in_lanes = |four: &[Vec3]| {
            let at = |lane: usize| four.get(lane).or(four.last()).copied().unwrap_or_default();
            [0, 1, 2].map(|axis| f32x4::new([0, 1, 2, 3].map(|lane| at(lane)[axis])))
        };
        let normals: Vec<Vec3> = mesh.triangles().iter().map(normal).collect();
        Self {
            positions: mesh.positions().to_vec(),
            triangles: mesh.triangles().to_vec(),
            facets: normals.iter().map(|n| f32x4::new([n.x, n.y, n.z, 0.0])).collect(),
            planes: Vec::new(),
            normals,
            lanes: mesh.positions().chunks(LANES).map(in_lanes).collect(),
        }
    }

    /// Draws triangles from now on from both sides.
    pub fn draw_both_sides(&mut self) {
        self.planes.clear();
    }

    /// Draws triangles from now on only from where their corners run counterclockwise, or with −1 as `sign` clockwise.
    pub fn draw_one_side(&mut self, sign: f32) {
        let plane = |i: usize| {
            let normal = *self.normals.get(i)? * sign;
            let corner = self.positions[self.triangles[i][0] as usize];
            Some([normal.x, normal.y, normal.z, normal.dot(corner)])
        };
        // Those that fill the last lanes are seen from nowhere.
        let four = |k: usize| {
            let four = [0, 1, 2, 3].map(|lane| f32x4::new(plane(k + lane).unwrap_or([0.0, 0.0, 0.0, 1.0])));
            f32x4::transpose(four)
        };
        self.planes = (0..self.triangles.len()).step_by(LANES).map(four).collect();
    }
}

/// The last render, with reusable buffers.
#[derive(Debug, Clone, Default)]
pub struct Canvas {
    /// 1/z per cell; 0 if empty.
    pub inverse_depth: Vec<f32>,
    /// Triangle per cell.
    pub triangle: Vec<u32>,
    /// R, and the scale and translation, metres.
    pub rotation: Mat3,
    /// t, metres.
    pub translation: Vec3,
    /// s, metres per unit of the mesh frame.
    pub scale: f32,
    /// Share of the vertices outside the grid, 0 to 1.
    pub lost: f32,
    /// Cells, vertices and triangles visited by all renders so far: what they cost.
    pub work: u64,
    /// Columns and rows of the box around the projected vertices: all other cells are empty.
    pub drawn: [Range<usize>; 2],
    /// A buffer for ratios of observed and rendered depths.
    pub(in crate::precise) ratios: Vec<f32x4>,
    vertices: Vec<Vertex>,
    /// The triangles that are seen from the side from which they are drawn.
    seen: Vec<u32>,
}

impl Canvas {
    /// Renders the model on the cells of the grid.
    pub fn draw(&mut self, model: &Model, pose: &CropPose, grid: &CropGrid) {
        self.draw_stretched(model, pose, &Mat3::IDENTITY, grid);
    }

    /// Renders the model in other proportions, by a linear map in its frame that is nearly the identity. Normals keep the
    /// directions that they have without it: a proportion that is off by its standard deviation turns them by up to 1.2°, the
    /// largest one allowed by up to 10° (plane at 45°; see [`Proportions`](crate::precise::search::proportions)).
    pub fn draw_stretched(&mut self, model: &Model, pose: &CropPose, stretch: &Mat3, grid: &CropGrid) {
        let (scale, translation) = pose.scale_translation();
        self.rotation = glam::DMat3::from_quat(pose.rotation).as_mat3();
        (self.scale, self.translation) = (scale as f32, translation.as_vec3());
        self.inverse_depth.clear();
        self.inverse_depth.resize(grid.mask.len(), 0.0);
        self.triangle.resize(grid.mask.len(), 0);
        self.project(model, stretch, grid);
        self.see(model, stretch);
        let most = MAX_LAYERS * self.inverse_depth.len();
        let (mut visited, mut filled) = (0, 0);
        let (inverse_depth, size) = (self.inverse_depth.as_mut_slice(), [grid.width, grid.height]);
        let drawn = &mut self.triangle[..inverse_depth.len()];
        for ids in self.seen.chunks(LANES) {
            let ids: [u32; LANES] = core::array::from_fn(|lane| ids.get(lane).copied().unwrap_or(u32::MAX));
            // Triangles without area are not drawn.
            let triangles = ids.map(|id| model.triangles.get(id as usize).copied().unwrap_or_default());
            let of_four = fill(inverse_depth, drawn, size, ids, &self.vertices, triangles, most - visited);
            (visited, filled) = (visited + of_four.0, filled + of_four.1);
            if visited > most {
                break;
            }
        }
        counts::add(|| counts::Counts {
            renders: 1,
            vertices: model.positions.len() as u64,
            triangles: self.seen.len() as u64,
            filled: filled.into(),
            visited: visited as u64,
            cells: grid.mask.len() as u64,
            ..Default::default()
        });
        self.work += (grid.mask.len() + visited + model.positions.len() + self.seen.len()) as u64;
    }

    /// The rows in which cells may be drawn, and the indices of these cells.
    pub fn rows(&self, grid: &CropGrid) -> impl Iterator<Item = (usize, Range<usize>)> + use<> {
        let ([columns, rows], width) = (self.drawn.clone(), grid.width);
        rows.map(move |v| (v, v * width + columns.start..v * width + columns.end))
    }

    /// Finds the triangles that are seen from the side from which they are drawn.
    fn see(&mut self, model: &Model, stretch: &Mat3) {
        self.seen.clear();
        if model.planes.is_empty() {
            self.seen.extend(0..model.triangles.len() as u32);
            return;
        }
        let camera = stretch.inverse() * (self.rotation.transpose() * -self.translation / self.scale);
        let [x, y, z] = camera.to_array().map(f32x4::splat);
        self.seen.resize(LANES * model.planes.len(), 0);
        let mut count = 0;
        for (id, plane) in (0..).step_by(LANES).zip(&model.planes) {
            let is_seen = (plane[0] * x + plane[1] * y + plane[2] * z).simd_gt(plane[3]).to_bitmask();
            for lane in 0..LANES as u32 {
                self.seen[count] = id + lane;
                count += (is_seen >> lane & 1) as usize;
            }
        }
        self.seen.truncate(count);
    }

    /// Transforms the vertices to the camera frame and projects them onto the grid.
    fn project(&mut self, model: &Model, stretch: &Mat3, grid: &CropGrid) {
        let linear = self.rotation * self.scale * *stretch;
        let near = NEAR * self.translation.z;
        let focal = grid.focal as f32;
        let (cx, cy) = (grid.center[0] as f32, grid.center[1] as f32);
        let (right, bottom) = (grid.width as f32 - 0.5, grid.height as f32 - 0.5);
        let lanes = f32x4::splat;
        let in_lanes = |v: Vec3| [lanes(v.x), lanes(v.y), lanes(v.z)];
        let (of_x, of_y, of_z) = (in_lanes(linear.x_axis), in_lanes(linear.y_axis), in_lanes(linear.z_axis));
        let shift = in_lanes(self.translation);
        let mut lost = i32x4::ZERO;
        let (mut low, mut high) = ([i32x4::MAX; 2], [i32x4::MIN; 2]);
        let mut last_is_lost = 0;
        self.vertices.clear();
        for position in &model.lanes {
            let moved = |axis: usize| {
                of_x[axis] * position[0] + of_y[axis] * position[1] + of_z[axis] * position[2] + shift[axis]
            };
            let (x, y, z) = (moved(0), moved(1), moved(2));
            let w = f32x4::ONE / z;
            let (u, v) = (lanes(focal) * x * w + lanes(cx), lanes(focal) * y * w + lanes(cy));
            let is_inside =
                u.simd_gt(lanes(-0.5)) & u.simd_lt(lanes(right)) & v.simd_gt(lanes(-0.5)) & v.simd_lt(lanes(bottom));
            // The comparison is written so that NaN fails.
            let is_far = z.simd_ge(lanes(near));
            let is_lost: i32x4 = cast(!(is_inside & !z.simd_lt(lanes(near))));
            last_is_lost = is_lost.to_array()[LANES - 1];
            lost += is_lost;
            let corners = Corners { u: snap(u), v: snap(v), w: w & is_far };
            (low, high) =
                ([low[0].min(corners.u), low[1].min(corners.v)], [high[0].max(corners.u), high[1].max(corners.v)]);
            self.vertices.extend(corners.vertices());
        }
        // Each lost vertex counts −1, those that fill the last lanes as well.
        let missing = (model.lanes.len() * LANES - model.positions.len()) as i32;
        let lost = missing * last_is_lost - lost.to_array().iter().sum::<i32>();
        let (low, high) = (low.map(i32x4::reduce_min), high.map(i32x4::reduce_max));
        self.drawn = [0, 1].map(|axis| {
            let size = [grid.width, grid.height][axis];
            let end = (high[axis].max(-STEPS).div_euclid(STEPS) + 1) as usize;
            first_cell(low[axis]).min(size)..end.min(size)
        });
        self.lost = lost as f32 / model.positions.len().max(1) as f32;
    }
}

/// The first cell whose centre is at least this many steps from the first one's.
fn first_cell(low: i32) -> usize {
    (low.max(0).min(FARTHEST as i32) as usize).div_ceil(STEPS as usize)
}

/// Converts cells to steps, rounded to nearest; NaN becomes the smallest.
#[inline(always)]
fn snap(cells: f32x4) -> i32x4 {
    // Shifted to positive values, so that the conversion rounds down.
    const OFFSET: i32 = 1 << 20;
    let steps = (cells * f32x4::splat(STEPS as f32)).fast_clamp(f32x4::splat(-FARTHEST), f32x4::splat(FARTHEST));
    (steps + f32x4::splat(OFFSET as f32 + 0.5)).trunc_int() - i32x4::splat(OFFSET)
}
