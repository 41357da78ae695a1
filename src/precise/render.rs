//! The rasteriser of the search: thousands of small images per second.
//!
//! Unlike the [`Rasteriser`](crate::geometry::rasteriser::Rasteriser) of the metrics, which clips and uses f64, this
//! one uses f32 and skips triangles close to the camera. Both decide coverage in integers.

use core::ops::Range;

use glam::{Mat3, Vec3};
use wide::bytemuck::cast;
use wide::{f32x4, i32x4, u32x4};

use super::grid::CropGrid;
use super::pose::CropPose;
use crate::geometry::mesh::Mesh;

/// Minimum depth of a rendered vertex, relative to the depth of the centre of the mesh.
const NEAR: f32 = 0.05;
/// Subpixel steps per cell to which vertices are snapped, 2⁶.
const STEPS: i32 = 64;
const SHIFT: u32 = 6;
/// Boxes of triangles at least this many cells wide are drawn row by row from where the triangle begins.
const WIDE: i32 = 32;
/// Cells of a row that are drawn at once.
const LANES: usize = 4;
/// Steps below which the box of a triangle is so small that the areas its cells span fit 32 bits.
const SMALL: i32 = 1 << 12;
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
}

impl Model {
    /// From a mesh in its frame.
    pub fn new(mesh: &Mesh) -> Self {
        let normal = |t: &[u32; 3]| {
            let [a, b, c] = mesh.corners(*t);
            (b - a).cross(c - a).normalize_or_zero()
        };
        Self {
            positions: mesh.positions().to_vec(),
            triangles: mesh.triangles().to_vec(),
            normals: mesh.triangles().iter().map(normal).collect(),
        }
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
    vertices: Vec<Vertex>,
}

/// A vertex on the grid, in steps, and its 1/z; 0 if it cannot be rendered.
#[derive(Debug, Clone, Copy)]
struct Vertex {
    u: i32,
    v: i32,
    w: f32,
}

/// A vertex for the coverage test.
#[derive(Clone, Copy)]
struct Corner {
    u: i64,
    v: i64,
    w: f32,
}

impl Canvas {
    /// Renders the model on the cells of the grid.
    pub fn draw(&mut self, model: &Model, pose: &CropPose, grid: &CropGrid) {
        let (scale, translation) = pose.scale_translation();
        self.rotation = glam::DMat3::from_quat(pose.rotation).as_mat3();
        (self.scale, self.translation) = (scale as f32, translation.as_vec3());
        self.inverse_depth.clear();
        self.inverse_depth.resize(grid.mask.len(), 0.0);
        self.triangle.resize(grid.mask.len(), 0);
        self.project(model, grid);
        let (inverse_depth, drawn) = (self.inverse_depth.as_mut_slice(), self.triangle.as_mut_slice());
        let most = MAX_LAYERS * inverse_depth.len();
        let mut visited = 0;
        for (id, triangle) in (0..).zip(&model.triangles) {
            let corners = triangle.map(|i| self.vertices[i as usize]);
            visited += fill(inverse_depth, drawn, [grid.width, grid.height], id, corners);
            if visited > most {
                break;
            }
        }
        self.work += (grid.mask.len() + visited + model.positions.len() + model.triangles.len()) as u64;
    }

    /// The rows in which cells may be drawn, and the indices of these cells.
    pub fn rows(&self, grid: &CropGrid) -> impl Iterator<Item = (usize, Range<usize>)> + use<> {
        let ([columns, rows], width) = (self.drawn.clone(), grid.width);
        rows.map(move |v| (v, v * width + columns.start..v * width + columns.end))
    }

    /// Transforms the vertices to the camera frame and projects them onto the grid.
    fn project(&mut self, model: &Model, grid: &CropGrid) {
        let linear = self.rotation * self.scale;
        let near = NEAR * self.translation.z;
        let focal = grid.focal as f32;
        let (cx, cy) = (grid.center[0] as f32, grid.center[1] as f32);
        let (right, bottom) = (grid.width as f32 - 0.5, grid.height as f32 - 0.5);
        let mut lost = 0u32;
        let (mut low, mut high) = ([i32::MAX; 2], [i32::MIN; 2]);
        self.vertices.clear();
        self.vertices.extend(model.positions.iter().map(|p| {
            let p = linear * *p + self.translation;
            let w = 1.0 / p.z;
            let (u, v) = (focal * p.x * w + cx, focal * p.y * w + cy);
            let inside = u > -0.5 && u < right && v > -0.5 && v < bottom;
            lost += u32::from(!inside || p.z < near);
            // The comparison is written so that NaN fails.
            let w = if p.z >= near { w } else { 0.0 };
            let (u, v) = (snap(u), snap(v));
            (low, high) = ([low[0].min(u), low[1].min(v)], [high[0].max(u), high[1].max(v)]);
            Vertex { u, v, w }
        }));
        self.drawn = [0, 1].map(|axis| {
            let size = [grid.width, grid.height][axis];
            let end = ((high[axis].max(-STEPS) >> SHIFT) + 1) as usize;
            (first_cell(low[axis]) as usize).min(size)..end.min(size)
        });
        self.lost = lost as f32 / model.positions.len().max(1) as f32;
    }
}

/// The first cell whose centre is at least this many steps from the first one's.
#[inline]
fn first_cell(low: i32) -> i32 {
    (low.max(0).min(FARTHEST as i32) + STEPS - 1) >> SHIFT
}

/// Renders a triangle and returns about the number of cells that it visits. Takes slices instead of the canvas, so that
/// their addresses stay in registers.
#[inline]
fn fill(
    inverse_depth: &mut [f32],
    drawn: &mut [u32],
    [width, height]: [usize; 2],
    id: u32,
    [a, b, c]: [Vertex; 3],
) -> usize {
    // The first and last cell whose centre is in the box of the triangle.
    let last = |high: i32, size: usize| (high >> SHIFT).min(size as i32 - 1);
    let (u0, u1) = (first_cell(a.u.min(b.u).min(c.u)), last(a.u.max(b.u).max(c.u), width));
    let (v0, v1) = (first_cell(a.v.min(b.v).min(c.v)), last(a.v.max(b.v).max(c.v), height));
    if u0 > u1 || v0 > v1 || a.w * b.w * c.w == 0.0 {
        return 0;
    }
    let span = |[a, b, c]: [i32; 3]| a.max(b).max(c) - a.min(b).min(c);
    if span([a.u, b.u, c.u]).max(span([a.v, b.v, c.v])) < SMALL && u1 - u0 + 1 < WIDE && width >= LANES {
        return fill_small(inverse_depth, drawn, width, id, [a, b, c], [u0, u1], [v0, v1]);
    }
    let [a, mut b, mut c] = [a, b, c].map(|p| Corner { u: p.u.into(), v: p.v.into(), w: p.w });
    let mut area = (b.u - a.u) * (c.v - a.v) - (c.u - a.u) * (b.v - a.v);
    if area == 0 {
        return 0;
    }
    if area < 0 {
        area = -area;
        core::mem::swap(&mut b, &mut c);
    }
    // Twice the areas that a cell centre spans with two edges; the third follows from the total.
    let (b_du, b_dv) = (c.v - a.v, a.u - c.u);
    let (c_du, c_dv) = (a.v - b.v, b.u - a.u);
    let steps = i64::from(STEPS);
    let (du, dv) = (i64::from(u0) * steps - a.u, i64::from(v0) * steps - a.v);
    let (mut b_row, mut c_row) = (b_du * du + b_dv * dv, c_du * du + c_dv * dv);
    let (b_du, b_dv, c_du, c_dv) = (b_du * steps, b_dv * steps, c_du * steps, c_dv * steps);
    let inverse = 1.0 / area as f32;
    let (wb, wc) = ((b.w - a.w) * inverse, (c.w - a.w) * inverse);
    let cells = (u1 - u0) as usize + 1;
    let is_wide = u1 - u0 + 1 >= WIDE;
    let rows = (v1 - v0) as usize + 1;
    // Twice the area in steps² is 2¹³ times that in cells.
    let visited = if is_wide { (cells * rows).min((area >> 13) as usize + 2 * rows) } else { cells * rows };
    for v in v0..=v1 {
        let start = v as usize * width + u0 as usize;
        let (mut eb, mut ec, mut entered) = (b_row, c_row, false);
        // A long thin triangle fills little of its box.
        let skipped = if is_wide { first_inside([(eb, b_du), (ec, c_du), (area - eb - ec, -b_du - c_du)]) } else { 0 };
        let skipped = skipped.min(cells as i64);
        (eb, ec) = (eb + b_du * skipped, ec + c_du * skipped);
        let (from, to) = (start + skipped as usize, start + cells);
        let row = inverse_depth[from..to].iter_mut().zip(&mut drawn[from..to]);
        for (cell, drawn) in row {
            if (eb | ec | (area - eb - ec)) >= 0 {
                entered = true;
                let w = a.w + eb as f32 * wb + ec as f32 * wc;
                if w > *cell {
                    *cell = w;
                    *drawn = id;
                }
            } else if entered {
                break;
            }
            eb += b_du;
            ec += c_du;
        }
        b_row += b_dv;
        c_row += c_dv;
    }
    visited
}

/// Like [`fill`], with the same result, for a triangle whose box is small: in 32 bits, four cells of a row at
/// once, and without a branch per cell. A lane computes what [`fill`] does, so that the bits are the same where there are no
/// vector instructions.
#[inline]
fn fill_small(
    inverse_depth: &mut [f32],
    drawn: &mut [u32],
    width: usize,
    id: u32,
    [a, mut b, mut c]: [Vertex; 3],
    [u0, u1]: [i32; 2],
    [v0, v1]: [i32; 2],
) -> usize {
    let mut area = (b.u - a.u) * (c.v - a.v) - (c.u - a.u) * (b.v - a.v);
    if area == 0 {
        return 0;
    }
    if area < 0 {
        area = -area;
        core::mem::swap(&mut b, &mut c);
    }
    let (b_du, b_row) = (c.v - a.v, a.u - c.u);
    let (c_du, c_row) = (a.v - b.v, b.u - a.u);
    let inverse = 1.0 / area as f32;
    let (wb, wc) = ((b.w - a.w) * inverse, (c.w - a.w) * inverse);
    let lanes = |edge: i32, growth: i32| i32x4::new([0, 1, 2, 3].map(|lane| edge + lane * (growth * STEPS)));
    let ([b_dv, c_dv], total) = ([b_row, c_row].map(|growth| i32x4::splat(growth * STEPS)), i32x4::splat(area));
    let [w_a, wb, wc] = [a.w, wb, wc].map(f32x4::splat);
    // Cells beside the box are outside the triangle or, where the grid ends, begin before it.
    let last = (width - LANES) as i32;
    let mut from = u0;
    while from <= u1 {
        let first = from.min(last);
        let (du, dv) = (first * STEPS - a.u, v0 * STEPS - a.v);
        let mut b = lanes(b_du * du + b_row * dv, b_du);
        let mut c = lanes(c_du * du + c_row * dv, c_du);
        let mut at = v0 as usize * width + first as usize;
        for _ in v0..=v1 {
            let cells = inverse_depth.get_mut(at..).and_then(|cells| cells.first_chunk_mut::<LANES>());
            let drawn = drawn.get_mut(at..).and_then(|drawn| drawn.first_chunk_mut::<LANES>());
            let Some((cells, drawn)) = cells.zip(drawn) else { break };
            let w = w_a + f32x4::from_i32x4(b) * wb + f32x4::from_i32x4(c) * wc;
            let (far, other) = (f32x4::new(*cells), u32x4::new(*drawn));
            let is_inside: i32x4 = (b | c | (total - b - c)).simd_gt(i32x4::splat(-1));
            let is_drawn = is_inside & cast::<f32x4, i32x4>(w.simd_gt(far));
            *cells = cast::<i32x4, f32x4>(is_drawn).bitselect(w, far).to_array();
            *drawn = cast::<i32x4, u32x4>(is_drawn).bitselect(u32x4::splat(id), other).to_array();
            (b, c, at) = (b + b_dv, c + c_dv, at + width);
        }
        from += LANES as i32;
    }
    ((u1 - u0 + 1) * (v1 - v0 + 1)) as usize
}

/// The first cell of a row in which no edge is negative, `i64::MAX` if there is none: each edge is its value at the first
/// cell and its growth per cell.
#[inline]
fn first_inside(edges: [(i64, i64); 3]) -> i64 {
    edges.into_iter().fold(0, |first, (value, growth)| {
        if value >= 0 {
            first
        } else if growth <= 0 {
            i64::MAX
        } else {
            first.max((growth - 1 - value) / growth)
        }
    })
}

/// Converts cells to steps, rounded to nearest; NaN becomes 0.
#[inline]
fn snap(cells: f32) -> i32 {
    // Shifted to positive values, so that the cast rounds down.
    const OFFSET: i32 = 1 << 20;
    let steps = (cells * STEPS as f32).clamp(-FARTHEST, FARTHEST);
    (steps + (OFFSET as f32 + 0.5)) as i32 - OFFSET
}
