//! Appearance: how well the colours of a posed mesh agree with the photo.
//!
//! Light, exposure, white balance and the gamma of generated textures are unknown, so that colours are compared by
//! correlation. Luminance is compared after the part that is linear in the normal has been subtracted from both images:
//! the shading of a matt surface under distant light. Chroma hardly depends on shading.

use glam::{DMat4, DVec4, Vec2, Vec3};

use crate::evidence::photo::{Photo, PhotoRegion};
use crate::geometry::surface_colors::SurfaceColors;
use crate::precise::drawing::pose::MeshFrame;
use crate::precise::drawing::render::Canvas;
use crate::precise::observation::grid::CropGrid;

/// Maximum number of pixels along a side of a cell whose mean is its colour.
const MAX_SAMPLES: usize = 6;
/// Minimum cosine between the normal of a point and the direction to the camera for the point to colour a cell.
const MIN_FACING: f32 = 0.15;
/// Maximum distance of a point behind the rendered surface, relative to the diagonal of the mesh: it is decimated.
const BEHIND: f32 = 0.03;
/// Distance to the outline of the mask, in cells, from which on a cell is compared: the photo may be shifted.
const INSIDE: f32 = -1.5;
/// Minimum number of cells for a correlation.
const MIN_CELLS: usize = 30;
/// Mean square of the noise of a cell, which keeps surfaces without contrast from correlating.
const NOISE: f64 = 1e-3;
/// Mean absolute chroma below which a photo is grey.
const GREY: f32 = 0.01;
/// Regularisation of the fit of the shading, relative to the number of cells: a flat surface has one normal.
const RIDGE: f64 = 1e-3;

/// A pixel with no channel above the first value is black, one with none below the second is blown out: neither has a colour that
/// compares.
const CLIPPED: [u8; 2] = [5, 250];
/// Largest offset of a photo from the depth map, relative to the width of the image, and in cells.
const MAX_SHIFT: f64 = 0.016;
const MAX_SHIFT_CELLS: i32 = 6;
/// Distance of a cell from the outline, in cells, up to which it is on it.
const ON_OUTLINE: f32 = 0.75;
/// Difference of colour that halves the credit of an edge.
const EDGE: f32 = 0.1;
/// The cost of the largest offset, and the least gain of one, in credits of edges.
const SHIFT_COST: f64 = 0.03;
const MIN_SHIFT_GAIN: f64 = 0.03;

/// The photo on the cells of a grid: luminance and two opponent colours, sRGB-encoded.
#[derive(Debug, Clone)]
pub struct PhotoCells {
    colors: Vec<Vec3>,
    is_grey: bool,
}

/// The contrast of the colours of a posed mesh on the cells where it is compared, and its agreement with the photo.
#[derive(Debug, Clone)]
pub struct Appearance {
    /// Correlation with the photo, −1 to 1; 0 without contrast.
    pub agreement: f64,
    /// Index of each cell, and its contrast.
    contrasts: Vec<(u32, Vec3)>,
}

impl PhotoCells {
    /// The means of the photo on the cells of a grid. `image` is the size in pixels of the depth map, which shows this
    /// region of the photo.
    pub fn new(photo: &Photo, region: &PhotoRegion, image: [f64; 2], grid: &CropGrid) -> Self {
        Self::shifted(photo, region, image, grid, [0.0; 2])
    }

    /// The same, of a whole photo that is registered to the outline of the mask.
    pub fn registered(photo: &Photo, image: [f64; 2], grid: &CropGrid) -> Self {
        let as_it_is = Self::new(photo, &PhotoRegion::WHOLE, image, grid);
        match as_it_is.offset(image, grid) {
            Some(offset) => Self::shifted(photo, &PhotoRegion::WHOLE, image, grid, offset),
            None => as_it_is,
        }
    }

    /// How far the photo is off the outline of the mask, in cells: the offset at which its edges along the outline are strongest.
    /// `None` if they are hardly stronger than in place. The offset is the same for all poses, so that it favours none.
    fn offset(&self, image: [f64; 2], grid: &CropGrid) -> Option<[f64; 2]> {
        let reach = ((MAX_SHIFT * image[0] / grid.cell[0]).ceil() as i32).clamp(1, MAX_SHIFT_CELLS);
        let outline = outline(grid);
        let strength = |[i, j]: [i32; 2]| {
            let (mut sum, mut count) = (0.0, 0.0);
            for (cell, normal) in &outline {
                if let Some(edge) = self.edge([cell[0] + i, cell[1] + j], *normal, grid) {
                    sum += f64::from(edge);
                    count += 1.0;
                }
            }
            let far = f64::from(i * i + j * j) / f64::from(reach * reach);
            sum / f64::max(count, 1.0) - SHIFT_COST * far
        };

        let here = strength([0, 0]);
        let (mut best, mut most) = ([0, 0], here + MIN_SHIFT_GAIN);
        for j in -reach..=reach {
            for i in -reach..=reach {
                let there = strength([i, j]);
                if there > most {
                    (best, most) = ([i, j], there);
                }
            }
        }
        // The peak of a parabola through the neighbours.
        let peak = |axis: usize| {
            let beside =
                [-1, 1].map(|step| strength([best[0] + step * (1 - axis as i32), best[1] + step * axis as i32]));
            let bend = beside[0] - 2.0 * most + beside[1];
            let part = if bend < 0.0 { (0.5 * (beside[0] - beside[1]) / bend).clamp(-0.5, 0.5) } else { 0.0 };
            f64::from(best[axis]) + part
        };
        (best != [0, 0]).then(|| [peak(0), peak(1)])
    }

    /// The credit of the edge at a cell across the direction `normal`, 0 to 1; `None` where the photo has no colour.
    fn edge(&self, [u, v]: [i32; 2], normal: Vec2, grid: &CropGrid) -> Option<f32> {
        let (width, height) = (grid.width as i32, grid.height as i32);
        if u < 1 || v < 1 || u >= width - 1 || v >= height - 1 {
            return None;
        }
        let at = |x: i32, y: i32| self.colors[((v + y) * width + u + x) as usize];
        let across = (at(1, 0) - at(-1, 0)) * normal.x + (at(0, 1) - at(0, -1)) * normal.y;
        let strength = across.length();
        (!strength.is_nan()).then(|| strength / (strength + EDGE))
    }

    /// The means on cells that are moved by `offset`, in cells. A cell has no colour if most of it is clipped.
    fn shifted(photo: &Photo, region: &PhotoRegion, image: [f64; 2], grid: &CropGrid, offset: [f64; 2]) -> Self {
        let sizes = [photo.width(), photo.height()];
        let ratio: [f64; 2] = core::array::from_fn(|k| sizes[k] as f64 * region.size[k] / image[k]);
        let corner: [f64; 2] = core::array::from_fn(|k| sizes[k] as f64 * region.corner[k]);
        let samples: [usize; 2] =
            core::array::from_fn(|k| ((grid.cell[k] * ratio[k]).ceil() as usize).clamp(1, MAX_SAMPLES));
        // The pixel at a sample of a cell.
        let at = |i: usize, k: usize, axis: usize| {
            let within = (k as f64 + 0.5) / samples[axis] as f64;
            let x =
                (grid.corner[axis] + (i as f64 + within + offset[axis]) * grid.cell[axis]) * ratio[axis] + corner[axis];
            (x >= 0.0 && x < sizes[axis] as f64).then_some(x as usize)
        };
        let mut colors = Vec::with_capacity(grid.width * grid.height);
        let (mut chroma, mut known) = (0.0f32, 0.0f32);
        for v in 0..grid.height {
            for u in 0..grid.width {
                let (mut mean, mut clipped) = (Mean::default(), 0.0);
                for y in (0..samples[1]).filter_map(|k| at(v, k, 1)) {
                    for x in (0..samples[0]).filter_map(|k| at(u, k, 0)) {
                        let pixel = photo.data()[y * photo.width() + x];
                        if is_clipped(pixel) {
                            clipped += 1.0;
                        } else {
                            mean.add(pixel);
                        }
                    }
                }
                let color = if clipped > mean.count { Vec3::NAN } else { mean.color() };
                if !color.is_nan() {
                    known += 2.0;
                    chroma += color.y.abs() + color.z.abs();
                }
                colors.push(color);
            }
        }
        Self { colors, is_grey: chroma < GREY * known }
    }

    /// The appearance of the mesh of the last render on the cells of `grid`; `None` if too little of it is in the mask.
    pub fn compare(
        &self,
        canvas: &Canvas,
        colors: &SurfaceColors,
        frame: &MeshFrame,
        grid: &CropGrid,
    ) -> Option<Appearance> {
        let cells: Vec<Cell> = drawn_colors(canvas, colors, frame, grid)
            .into_iter()
            .zip(&self.colors)
            .enumerate()
            .filter(|(i, ((mean, _), photo))| {
                grid.mask[*i] && grid.outline[*i] < INSIDE && mean.count > 0.0 && !photo.is_nan()
            })
            .map(|(i, ((mean, normal), photo))| Cell {
                index: i as u32,
                photo: self.seen(*photo),
                mesh: self.seen(mean.color()),
                normal: normal.normalize_or_zero(),
            })
            .collect();
        (cells.len() >= MIN_CELLS).then(|| Appearance::new(cells))
    }

    /// The channels that the photo has.
    fn seen(&self, color: Vec3) -> Vec3 {
        if self.is_grey { Vec3::new(color.x, 0.0, 0.0) } else { color }
    }
}

impl Appearance {
    fn new(mut cells: Vec<Cell>) -> Self {
        Shading::fit(&cells, |cell| cell.photo).subtract(&mut cells, |cell| &mut cell.photo);
        Shading::fit(&cells, |cell| cell.mesh).subtract(&mut cells, |cell| &mut cell.mesh);
        let noise = NOISE * cells.len() as f64;
        let sum = |of: fn(&Cell) -> f32| cells.iter().map(|cell| f64::from(of(cell))).sum::<f64>();
        let common = sum(|cell| cell.photo.dot(cell.mesh));
        let [photo, mesh] = [sum(|cell| cell.photo.length_squared()), sum(|cell| cell.mesh.length_squared())];
        Self {
            agreement: common / ((photo + noise) * (mesh + noise)).sqrt(),
            contrasts: cells.iter().map(|cell| (cell.index, cell.mesh)).collect(),
        }
    }

    /// Number of cells that were compared.
    pub fn cells(&self) -> usize {
        self.contrasts.len()
    }

    /// The mean squared difference of the contrasts of two poses, on their common cells, relative to the noise.
    pub fn difference(&self, other: &Self) -> f64 {
        let mut others = other.contrasts.iter().peekable();
        let (mut sum, mut count) = (0.0, 0.0f64);
        for (index, contrast) in &self.contrasts {
            while others.next_if(|(other, _)| other < index).is_some() {}
            if let Some((_, other)) = others.next_if(|(other, _)| other == index) {
                sum += f64::from((*contrast - *other).length_squared());
                count += 1.0;
            }
        }
        sum / (count.max(1.0) * NOISE)
    }
}

/// The cells on the outline of the mask, inside the border of the grid, and the direction across it.
fn outline(grid: &CropGrid) -> Vec<([i32; 2], Vec2)> {
    let mut cells = Vec::new();
    for v in 1..grid.height.saturating_sub(1) {
        for u in 1..grid.width.saturating_sub(1) {
            let i = v * grid.width + u;
            if grid.outline[i].abs() < ON_OUTLINE {
                let across = grid.outline[i + 1] - grid.outline[i - 1];
                let down = grid.outline[i + grid.width] - grid.outline[i - grid.width];
                cells.push(([u as i32, v as i32], Vec2::new(across, down).normalize_or_zero()));
            }
        }
    }
    cells
}

fn is_clipped([r, g, b]: [u8; 3]) -> bool {
    r.max(g).max(b) <= CLIPPED[0] || r.min(g).min(b) >= CLIPPED[1]
}

struct Cell {
    index: u32,
    photo: Vec3,
    mesh: Vec3,
    normal: Vec3,
}

/// Mean of 8-bit colours.
#[derive(Debug, Clone, Copy, Default)]
struct Mean {
    sum: Vec3,
    count: f32,
}

impl Mean {
    fn add(&mut self, [r, g, b]: [u8; 3]) {
        self.sum += Vec3::new(r.into(), g.into(), b.into());
        self.count += 1.0;
    }

    /// Luminance, red to green, yellow to blue; NaN without any colour.
    fn color(&self) -> Vec3 {
        let Vec3 { x: r, y: g, z: b } = self.sum / (255.0 * self.count);
        Vec3::new(0.3 * r + 0.6 * g + 0.1 * b, r - g, 0.5 * (r + g) - b)
    }
}

/// The mean of the chroma of an image, and its luminance as a linear function of the normal.
struct Shading {
    luminance: DVec4,
    chroma: Vec3,
}

impl Shading {
    fn fit(cells: &[Cell], of: fn(&Cell) -> Vec3) -> Self {
        let (mut squares, mut products, mut chroma) = (DMat4::ZERO, DVec4::ZERO, Vec3::ZERO);
        for cell in cells {
            let (basis, color) = (cell.normal.extend(1.0).as_dvec4(), of(cell));
            squares += DMat4::from_cols(basis * basis.x, basis * basis.y, basis * basis.z, basis * basis.w);
            products += basis * f64::from(color.x);
            chroma += color;
        }
        let ridge = RIDGE * cells.len() as f64;
        squares += DMat4::from_diagonal(DVec4::new(ridge, ridge, ridge, 1e-9 * ridge));
        Self { luminance: squares.inverse() * products, chroma: chroma / cells.len() as f32 }
    }

    fn subtract(&self, cells: &mut [Cell], of: fn(&mut Cell) -> &mut Vec3) {
        for cell in cells {
            let lit = self.luminance.dot(cell.normal.extend(1.0).as_dvec4()) as f32;
            *of(cell) -= Vec3::new(lit, self.chroma.y, self.chroma.z);
        }
    }
}

/// The colours of the visible points of the mesh per cell, and the sums of their normals, camera frame.
fn drawn_colors(canvas: &Canvas, colors: &SurfaceColors, frame: &MeshFrame, grid: &CropGrid) -> Vec<(Mean, Vec3)> {
    let mut cells = vec![(Mean::default(), Vec3::ZERO); grid.mask.len()];
    let (center, per_unit) = (frame.center.as_vec3(), 1.0 / frame.diagonal as f32);
    let linear = canvas.rotation * canvas.scale;
    let (focal, [cx, cy]) = (grid.focal as f32, grid.center.map(|c| c as f32));
    let (right, bottom) = (grid.width as f32, grid.height as f32);
    let behind = BEHIND * canvas.scale;
    let samples = colors.samples();
    for ((p, n), rgb) in samples.points.iter().zip(&samples.normals).zip(colors.colors()) {
        let point = linear * ((*p - center) * per_unit) + canvas.translation;
        let normal = canvas.rotation * *n;
        if point.z <= 0.0 || -normal.dot(point) < MIN_FACING * point.length() {
            continue;
        }
        let (u, v) = (focal * point.x / point.z + cx + 0.5, focal * point.y / point.z + cy + 0.5);
        if !(u >= 0.0 && v >= 0.0 && u < right && v < bottom) {
            continue;
        }
        let i = v as usize * grid.width + u as usize;
        let drawn = canvas.inverse_depth[i];
        if drawn > 0.0 && point.z < 1.0 / drawn + behind {
            cells[i].0.add(*rgb);
            cells[i].1 += normal;
        }
    }
    cells
}
