//! The search's own rasteriser: f32, unclipped, for thousands of small images a second.
//!
//! Where the metrics' [`Rasteriser`](crate::geometry::rasteriser::Rasteriser) decides every pixel exactly, this one
//! may miss a cell between two triangles by rounding; it takes a tenth of the time.

use glam::{Mat3, Vec3};

use super::grid::CropGrid;
use super::pose::CropPose;
use crate::geometry::mesh::Mesh;

/// Depth before which a vertex is not drawn, as a share of the middle of the mesh's.
const NEAR: f32 = 0.05;
/// Triangles below this area, in cells, are edge-on.
const EDGE_ON: f32 = 1e-7;
/// How far outside a triangle, in barycentric units, a cell's centre is still in it.
const SLACK: f32 = 1e-5;

/// A mesh prepared for drawing.
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

/// What was drawn last, with buffers to be reused.
#[derive(Debug, Clone, Default)]
pub struct Canvas {
    /// 1/z per cell; 0 where nothing is.
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
    vertices: Vec<Vec3>,
}

impl Canvas {
    /// Draws the model on the grid's cells.
    pub fn draw(&mut self, model: &Model, pose: &CropPose, grid: &CropGrid) {
        let (scale, translation) = pose.scale_translation();
        self.rotation = glam::DMat3::from_quat(pose.rotation).as_mat3();
        (self.scale, self.translation) = (scale as f32, translation.as_vec3());
        self.inverse_depth.clear();
        self.inverse_depth.resize(grid.mask.len(), 0.0);
        self.triangle.resize(grid.mask.len(), 0);
        self.project(model, grid);
        for (id, triangle) in (0..).zip(&model.triangles) {
            self.fill(id, triangle.map(|i| self.vertices[i as usize]), grid.width, grid.height);
        }
    }

    /// Cell coordinates and 1/z; an infinite 1/z where the vertex can't be drawn.
    fn project(&mut self, model: &Model, grid: &CropGrid) {
        let linear = self.rotation * self.scale;
        let near = NEAR * self.translation.z;
        let focal = grid.focal as f32;
        let (cx, cy) = (grid.center[0] as f32, grid.center[1] as f32);
        let (right, bottom) = (grid.width as f32 - 0.5, grid.height as f32 - 0.5);
        let mut lost = 0u32;
        self.vertices.clear();
        self.vertices.extend(model.positions.iter().map(|p| {
            let p = linear * *p + self.translation;
            let w = 1.0 / p.z;
            let (u, v) = (focal * p.x * w + cx, focal * p.y * w + cy);
            let inside = u > -0.5 && u < right && v > -0.5 && v < bottom;
            lost += u32::from(!inside || p.z < near);
            Vec3::new(u, v, if p.z < near { f32::INFINITY } else { w })
        }));
        self.lost = lost as f32 / model.positions.len().max(1) as f32;
    }

    #[inline]
    fn fill(&mut self, id: u32, [a, b, c]: [Vec3; 3], width: usize, height: usize) {
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        // Also false where a number is not finite.
        let visible = high.x >= 0.0 && high.y >= 0.0 && low.x < width as f32 && low.y < height as f32;
        if !(visible && high.z < f32::INFINITY) {
            return;
        }
        // Casts saturate, so that ceil and floor need no bounds of their own.
        let first = |x: f32| x as usize + usize::from(x > 0.0 && x.fract() != 0.0);
        let (u0, u1) = (first(low.x), (high.x as usize).min(width - 1));
        let (v0, v1) = (first(low.y), (high.y as usize).min(height - 1));
        if u0 > u1 || v0 > v1 {
            return;
        }
        let area = (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);
        if area.abs() < EDGE_ON {
            return;
        }
        let inverse = 1.0 / area;
        // Barycentric coordinates of b and c: linear over the image.
        let (b_du, b_dv) = ((c.y - a.y) * inverse, (a.x - c.x) * inverse);
        let (c_du, c_dv) = ((a.y - b.y) * inverse, (b.x - a.x) * inverse);
        let (wb, wc) = (b.z - a.z, c.z - a.z);
        for v in v0..=v1 {
            let dv = v as f32 - a.y;
            let row = v * width;
            for u in u0..=u1 {
                let du = u as f32 - a.x;
                let (lb, lc) = (b_du * du + b_dv * dv, c_du * du + c_dv * dv);
                if lb >= -SLACK && lc >= -SLACK && lb + lc <= 1.0 + SLACK {
                    let w = a.z + lb * wb + lc * wc;
                    if w > self.inverse_depth[row + u] {
                        self.inverse_depth[row + u] = w;
                        self.triangle[row + u] = id;
                    }
                }
            }
        }
    }
}
