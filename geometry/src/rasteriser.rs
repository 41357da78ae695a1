//! Depth and triangle images of a posed mesh: a small software rasteriser.
//!
//! The image is the same on every platform: vertices are snapped to 1/256 pixel and coverage is decided in integers,
//! by the top-left rule, so that two triangles that share an edge cover every pixel along it exactly once.
//! Snapping does not affect depth: 1/z is evaluated on the original plane of the triangle.
//! Both faces are drawn, because the orientation of generated meshes is unreliable.

use glam::{DMat3, DVec3};

use super::clip::{ClipVolume, GUARD_BAND_PX};
use super::image::Window;
use super::mesh::Mesh;
use super::pinhole::Pinhole;
use super::similarity::Similarity;
use sim3align_runtime::counts;

/// The triangle index of a pixel that no triangle covers.
pub const NO_TRIANGLE: u32 = u32::MAX;

/// Depth of the near plane, as a fraction of the depth of the farthest vertex. Geometry nearer or behind the camera is
/// clipped: for an object at 1 m, the near plane is at 0.1 mm.
pub const NEAR: f64 = 1e-4;

/// Maximum number of pixels that the triangles of a render visit, per pixel of the image: dozens of layers over all of
/// it. The triangles after that are left out.
const MAX_LAYERS: usize = 64;

/// Boxes of triangles at least this many pixels wide are filled from the first to the last pixel of each row.
const WIDE: i64 = 32;

/// Sub-pixel steps per pixel, 2⁸.
const SUBPIXEL: i64 = 256;

/// Limit on camera coordinates, above which products would overflow f64.
const MAX_COORDINATE: f64 = 1e60;

/// A rasteriser with reusable buffers: only the first render of a size allocates.
#[derive(Debug, Clone, Default)]
pub struct Rasteriser {
    window: Window,
    vertices: Vec<Vertex>,
    /// The vertices in camera space, apart, because most triangles do not reach the centre of a pixel.
    cameras: Vec<DVec3>,
    /// 1/z during rendering, z afterwards.
    depth: Vec<f32>,
    triangles: Vec<u32>,
    /// Pixels visited by the triangles of the render.
    visited: usize,
    /// Draws the farthest surfaces: 1/z is stored with the opposite sign, so that the largest still wins.
    is_farthest: bool,
}

/// A vertex on the sub-pixel grid, if it can be projected without clipping.
#[derive(Debug, Clone, Copy)]
struct Vertex {
    fixed: [i32; 2],
    placement: Placement,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Placement {
    /// Beyond the near plane and within the guard band.
    Inside,
    /// Triangles with this vertex need clipping.
    Outside,
    /// Not finite; triangles with this vertex are skipped.
    NotFinite,
}

/// 1/z as a linear function of the pixel, clamped to the range of the triangle's corners.
#[derive(Debug, Clone, Copy)]
struct InverseDepth {
    origin: f64,
    du: f64,
    dv: f64,
    low: f64,
    high: f64,
}

impl Rasteriser {
    /// A rasteriser without allocated buffers.
    pub fn new() -> Self {
        Self::default()
    }

    /// Renders `mesh`, posed by `camera_from_mesh`, into an image of `width` × `height` pixels: depth and triangle of
    /// the nearest surface at each pixel centre. If surfaces are equally near (same 1/z in f32), the first triangle of
    /// the mesh wins.
    ///
    /// The image must fit into memory; width and height are limited to 2²⁰.
    pub fn render(
        &mut self,
        mesh: &Mesh,
        camera_from_mesh: &Similarity,
        camera: &Pinhole,
        width: usize,
        height: usize,
    ) {
        let near = self.place(mesh, camera_from_mesh, camera);
        self.draw(mesh, camera, near, Window::whole(width, height));
    }

    /// Like [`Rasteriser::render`], for the smallest window of the image that contains `part`, the whole mesh, and one
    /// more pixel on each side. The pixels are those of the whole image.
    pub fn render_around(
        &mut self,
        mesh: &Mesh,
        camera_from_mesh: &Similarity,
        camera: &Pinhole,
        image: [usize; 2],
        part: Window,
    ) -> Window {
        let near = self.place(mesh, camera_from_mesh, camera);
        let window = self.covered(image).map_or(part, |covered| part.union(covered)).grown(1, image);
        self.draw(mesh, camera, near, window);
        window
    }

    /// Renders the depths of the nearest and of the farthest surface at each pixel, 0 where there is none, in the window of the
    /// image that contains the mesh.
    pub fn render_spans(
        &mut self,
        mesh: &Mesh,
        camera_from_mesh: &Similarity,
        camera: &Pinhole,
        image: [usize; 2],
    ) -> (Window, Vec<[f32; 2]>) {
        let near = self.place(mesh, camera_from_mesh, camera);
        let window = self.covered(image).unwrap_or_default();
        self.is_farthest = true;
        self.draw(mesh, camera, near, window);
        self.is_farthest = false;
        let farthest = self.depth.clone();
        self.draw(mesh, camera, near, window);
        (window, self.depth.iter().zip(farthest).map(|(nearest, farthest)| [*nearest, farthest]).collect())
    }

    /// The window that may contain the projected mesh; `None` if it is outside the image.
    fn covered(&self, image: [usize; 2]) -> Option<Window> {
        if self.vertices.iter().any(|v| v.placement == Placement::Outside) {
            return Some(Window::whole(image[0], image[1]));
        }
        let inside = || self.vertices.iter().filter(|v| v.placement == Placement::Inside);
        let mut bounds = [[0; 2]; 2];
        for (axis, bounds) in bounds.iter_mut().enumerate() {
            let low = inside().map(|v| v.fixed[axis]).min()?;
            let high = inside().map(|v| v.fixed[axis]).max()?;
            let last = i64::from(high).div_euclid(SUBPIXEL).min(image[axis] as i64 - 1);
            let first = i64::from(low).div_euclid(SUBPIXEL).max(0);
            if first > last {
                return None;
            }
            *bounds = [first as usize, last as usize];
        }
        Some(Window::of_bounds(bounds))
    }

    /// z-depth per pixel, row-major, in the unit of the camera frame (metres); 0 for uncovered pixels.
    pub fn depth(&self) -> &[f32] {
        &self.depth
    }

    /// Triangle index per pixel, row-major; [`NO_TRIANGLE`] for uncovered pixels.
    pub fn triangles(&self) -> &[u32] {
        &self.triangles
    }

    /// Whether the last render drew all triangles: too many layers of them are left out.
    pub fn is_complete(&self) -> bool {
        self.visited <= MAX_LAYERS * self.depth.len()
    }

    /// Width of the last render, in pixels.
    pub fn width(&self) -> usize {
        self.window.size[0]
    }

    /// Height of the last render, in pixels.
    pub fn height(&self) -> usize {
        self.window.size[1]
    }

    /// Places the vertices in the image, and returns the depth of the near plane.
    fn place(&mut self, mesh: &Mesh, camera_from_mesh: &Similarity, camera: &Pinhole) -> f64 {
        let near = self.transform(mesh, camera_from_mesh);
        self.project(camera, near);
        near
    }

    /// Draws the placed mesh: its nearest surfaces.
    fn draw(&mut self, mesh: &Mesh, camera: &Pinhole, near: f64, window: Window) {
        self.window = window;
        let pixels = window.size[0] * window.size[1];
        let (order, nothing) = if self.is_farthest { (-1.0, f32::NEG_INFINITY) } else { (1.0, 0.0) };
        self.depth.clear();
        self.depth.resize(pixels, nothing);
        self.triangles.clear();
        self.triangles.resize(pixels, NO_TRIANGLE);
        let volume = ClipVolume::new(camera, near);
        self.visited = 0;
        let cameras = core::mem::take(&mut self.cameras);
        for (id, triangle) in (0..).zip(mesh.triangles()) {
            if self.visited > MAX_LAYERS * self.depth.len() {
                break;
            }
            let corners = triangle.map(|i| self.vertices[i as usize]);
            let points = || triangle.map(|i| cameras[i as usize]);
            if corners.iter().all(|v| v.placement == Placement::Inside) {
                let plane = || {
                    let points = points();
                    InverseDepth::of(points, &points, camera)
                };
                self.fill(id, corners.map(|v| v.fixed), plane);
            } else if corners.iter().all(|v| v.placement != Placement::NotFinite) {
                let (polygon, count) = volume.clip(points());
                let polygon = &polygon[..count];
                let plane = || InverseDepth::of(points(), polygon, camera);
                for i in 2..count {
                    let fan = [polygon[0], polygon[i - 1], polygon[i]];
                    self.fill(id, fan.map(|p| fixed(project(p, camera))), plane);
                }
            }
        }
        self.cameras = cameras;
        counts::add(|| counts::Counts {
            vertices: self.vertices.len() as u64,
            triangles: mesh.triangles().len() as u64,
            visited: self.visited as u64,
            ..Default::default()
        });
        for z in &mut self.depth {
            *z = if *z == nothing { 0.0 } else { 1.0 / (order * *z) };
        }
    }

    /// Transforms the vertices into the camera frame and returns the depth of the near plane.
    fn transform(&mut self, mesh: &Mesh, camera_from_mesh: &Similarity) -> f64 {
        let linear = camera_from_mesh.rotation.matrix() * camera_from_mesh.scale;
        let linear = DMat3::from_cols_slice(linear.as_slice());
        let translation = DVec3::from_slice(camera_from_mesh.translation.as_slice());
        let mut farthest = 0.0f64;
        self.cameras.clear();
        self.cameras.extend(mesh.positions().iter().map(|p| linear * p.as_dvec3() + translation));
        self.vertices.clear();
        self.vertices.extend(self.cameras.iter().map(|camera| {
            let finite = camera.abs().max_element() <= MAX_COORDINATE && !camera.is_nan();
            if finite {
                farthest = farthest.max(camera.z);
            }
            let placement = if finite { Placement::Outside } else { Placement::NotFinite };
            Vertex { fixed: [0; 2], placement }
        }));
        // 1/z must fit into f32.
        (NEAR * farthest).max(1e-30)
    }

    fn project(&mut self, camera: &Pinhole, near: f64) {
        let vertices = self.vertices.iter_mut().zip(&self.cameras);
        for (vertex, place) in vertices.filter(|(v, p)| v.placement == Placement::Outside && p.z >= near) {
            let [u, v] = project(*place, camera);
            if u.abs() <= GUARD_BAND_PX && v.abs() <= GUARD_BAND_PX {
                vertex.fixed = fixed([u, v]);
                vertex.placement = Placement::Inside;
            }
        }
    }

    /// Fills one triangle on the sub-pixel grid.
    fn fill(&mut self, id: u32, corners: [[i32; 2]; 3], plane: impl Fn() -> InverseDepth) {
        let order = if self.is_farthest { -1.0 } else { 1.0 };
        let [a, mut b, mut c] = corners.map(|p| p.map(i64::from));
        // Pixels whose centres are inside the bounding box of the triangle.
        let Window { first, size } = self.window;
        let range = |i: usize| {
            let (low, high) = (a[i].min(b[i]).min(c[i]), a[i].max(b[i]).max(c[i]));
            let from = (low + SUBPIXEL - 1).div_euclid(SUBPIXEL).max(first[i] as i64);
            (from, high.div_euclid(SUBPIXEL).min((first[i] + size[i]) as i64 - 1))
        };
        let ((u0, u1), (v0, v1)) = (range(0), range(1));
        if u0 > u1 || v0 > v1 {
            return;
        }
        let area = Edge::new(a, b).at(c);
        if area == 0 {
            return;
        }
        if area < 0 {
            core::mem::swap(&mut b, &mut c);
        }
        let edges = [Edge::new(a, b), Edge::new(b, c), Edge::new(c, a)];
        let corner = [u0 * SUBPIXEL, v0 * SUBPIXEL];
        let mut row = edges.map(|e| e.at(corner) - e.exclusive());
        let mut known = None;
        for v in v0..=v1 {
            let start = (v as usize - first[1]) * size[0];
            let (mut e, mut range) = (row, (u0, u1));
            if u1 - u0 >= WIDE {
                // A long thin triangle fills little of its box.
                range = span(range, &row, &edges);
                for k in 0..3 {
                    e[k] -= edges[k].dy * SUBPIXEL * (range.0 - u0);
                }
            }
            self.visited += 1 + (range.1 - range.0 + 1).max(0) as usize;
            for u in range.0..=range.1 {
                // All three are ≥ 0 if no sign bit is set.
                if (e[0] | e[1] | e[2]) >= 0 {
                    let i = start + (u as usize - first[0]);
                    // In this order, NaN (from a plane seen edge-on) becomes the lower bound.
                    let plane = known.get_or_insert_with(&plane);
                    let w_row = plane.origin + plane.dv * v as f64;
                    let w = order * (w_row + plane.du * u as f64).max(plane.low).min(plane.high) as f32;
                    if w > self.depth[i] {
                        self.depth[i] = w;
                        self.triangles[i] = id;
                    }
                }
                for k in 0..3 {
                    e[k] -= edges[k].dy * SUBPIXEL;
                }
            }
            for k in 0..3 {
                row[k] += edges[k].dx * SUBPIXEL;
            }
        }
    }
}

/// The part of a row, first to last pixel, in which all edges are ≥ 0; `values` are theirs at the first one.
fn span((first, last): (i64, i64), values: &[i64; 3], edges: &[Edge; 3]) -> (i64, i64) {
    let (mut low, mut high) = (0, last - first);
    for (value, edge) in values.iter().zip(edges) {
        let growth = -edge.dy * SUBPIXEL;
        if growth > 0 {
            low = low.max((growth - 1 - value).div_euclid(growth));
        } else if growth < 0 {
            high = high.min(value.div_euclid(-growth));
        } else if *value < 0 {
            high = -1;
        }
    }
    // Empty ranges are kept near the row, so that nothing overflows.
    (first + low.min(last - first + 1), first + high.max(-1))
}

/// A directed edge; [`Edge::at`] is positive inside a triangle of positive area.
#[derive(Debug, Clone, Copy)]
struct Edge {
    from: [i64; 2],
    dx: i64,
    dy: i64,
}

impl Edge {
    fn new(from: [i64; 2], to: [i64; 2]) -> Self {
        Self { from, dx: to[0] - from[0], dy: to[1] - from[1] }
    }

    /// Twice the signed area of the triangle of edge and `point`. Cannot overflow: the guard band bounds both factors.
    fn at(&self, point: [i64; 2]) -> i64 {
        self.dx * (point[1] - self.from[1]) - self.dy * (point[0] - self.from[0])
    }

    /// The top-left rule: a pixel centre on a left edge (which runs up) or a top edge (which runs right) is
    /// inside. For other edges, 1 is subtracted, which makes it outside.
    fn exclusive(&self) -> i64 {
        i64::from(!(self.dy < 0 || (self.dy == 0 && self.dx > 0)))
    }
}

impl InverseDepth {
    /// 1/z on the plane through `triangle`: n·p = n·a for p = z·((u − cx)/fx, (v − cy)/fy, 1), so 1/z is linear in
    /// (u, v). `drawn` is the part of the triangle that is drawn. Snapping moves its outline by up to 1/512 pixel; in
    /// these slivers, the depth is clamped to that of the corners.
    fn of(triangle: [DVec3; 3], drawn: &[DVec3], camera: &Pinhole) -> Self {
        let [a, b, c] = triangle;
        let normal = (b - a).cross(c - a);
        let m = normal / normal.dot(a);
        let (du, dv) = (m.x / camera.fx, m.y / camera.fy);
        let (near, far) = drawn.iter().fold((f64::INFINITY, 0.0f64), |(n, f), p| (n.min(p.z), f.max(p.z)));
        Self { origin: m.z - du * camera.cx - dv * camera.cy, du, dv, low: 1.0 / far, high: 1.0 / near }
    }
}

fn project(p: DVec3, camera: &Pinhole) -> [f64; 2] {
    [camera.fx * p.x / p.z + camera.cx, camera.fy * p.y / p.z + camera.cy]
}

/// Converts pixels to sub-pixel steps, rounded to nearest; valid within the guard band.
fn fixed(pixel: [f64; 2]) -> [i32; 2] {
    // Shifted to be positive, so that the truncating cast is a floor.
    const SHIFT: f64 = (1u64 << 30) as f64;
    pixel.map(|x| {
        let x = x.clamp(-GUARD_BAND_PX, GUARD_BAND_PX);
        ((x * SUBPIXEL as f64 + (SHIFT + 0.5)) as i64 - (1 << 30)) as i32
    })
}
