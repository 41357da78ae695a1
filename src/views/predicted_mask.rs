//! The mask of a frame without one, from a predicted pose: where the mesh would be drawn, and a little around, if the
//! depth agrees.

use crate::evidence::frame::Frame;
use crate::geometry::image::Mask;
use crate::geometry::mesh::Mesh;
use crate::geometry::rasteriser::Rasteriser;
use crate::geometry::similarity::Similarity;

/// Growth of the silhouette, relative to the square root of its area, and its bounds in pixels.
const GROWTH: f32 = 0.1;
const GROWTH_PX: [f32; 2] = [2.0, 24.0];
/// Tolerance of a depth, relative to the diagonal of the object.
const TOLERANCE: f32 = 0.15;
/// Step between neighbouring readings of one surface, relative to the diagonal of the object and to the depth.
const SMOOTH: [f32; 2] = [0.01, 0.004];
/// Distance of a pixel next to the silhouette, and of a diagonal neighbour: a chamfer distance.
const NEXT: [f32; 2] = [1.0, 1.414];

/// The frame with the mask that a pose predicts. The mesh is normalised: the diagonal of its box is 1.
///
/// Readings of a surface that goes on beyond the grown silhouette, such as a table, may or may not be of the object where
/// they are near it: they are removed.
pub fn with_predicted_mask(mut frame: Frame, mesh: &Mesh, camera_from_mesh: &Similarity) -> Frame {
    let (width, height) = (frame.depth.width(), frame.depth.height());
    let mut rasteriser = Rasteriser::new();
    rasteriser.render(mesh, camera_from_mesh, &frame.camera, width, height);
    let area = rasteriser.depth().iter().filter(|z| **z > 0.0).count() as f32;
    let growth = (GROWTH * area.sqrt()).clamp(GROWTH_PX[0], GROWTH_PX[1]);
    let grown = Grown::new(rasteriser.depth(), width, height);
    let diagonal = camera_from_mesh.scale as f32;
    let tolerance = TOLERANCE * diagonal;
    let depth = frame.depth.data();
    let agrees = |i: usize| depth[i] > 0.0 && (depth[i] - grown.depth[i]).abs() < tolerance;
    let is_ring = |i: usize| grown.distance[i] > 0.0 && grown.distance[i] <= growth;
    let joined = |i: usize, j: usize| {
        let step = SMOOTH[0] * diagonal + SMOOTH[1] * depth[i];
        depth[i] > 0.0 && depth[j] > 0.0 && (depth[i] - depth[j]).abs() < step
    };
    // Flooded from beyond the ring.
    let mut open: Vec<usize> = Vec::new();
    let mut continues = vec![false; depth.len()];
    let visit = |from: usize, open: &mut Vec<usize>, continues: &mut [bool]| {
        let (u, v) = (from % width, from / width);
        let near = [(u > 0).then(|| from - 1), (u + 1 < width).then_some(from + 1)];
        let far = [(v > 0).then(|| from.wrapping_sub(width)), (v + 1 < height).then_some(from + width)];
        for next in near.into_iter().chain(far).flatten() {
            if is_ring(next) && !continues[next] && joined(from, next) {
                continues[next] = true;
                open.push(next);
            }
        }
    };
    for i in 0..depth.len() {
        if grown.distance[i] > growth && grown.distance[i] <= growth + NEXT[1] {
            visit(i, &mut open, &mut continues);
        }
    }
    while let Some(i) = open.pop() {
        visit(i, &mut open, &mut continues);
    }
    let mut mask = Mask::filled(width, height, 0);
    for (i, pixel) in mask.data_mut().iter_mut().enumerate() {
        let inside = grown.distance[i] == 0.0;
        *pixel = u8::from((inside || (is_ring(i) && !continues[i])) && agrees(i));
    }
    let unclear: Vec<usize> = (0..depth.len()).filter(|i| is_ring(*i) && continues[*i] && agrees(*i)).collect();
    unclear.into_iter().for_each(|i| frame.depth.data_mut()[i] = 0.0);
    Frame { mask: Some(mask), ..frame }
}

/// Distances to a silhouette, pixels, and the depth of its nearest pixel.
struct Grown {
    distance: Vec<f32>,
    depth: Vec<f32>,
}

impl Grown {
    /// Two passes over the image.
    fn new(drawn: &[f32], width: usize, height: usize) -> Self {
        let distance = drawn.iter().map(|z| if *z > 0.0 { 0.0 } else { f32::INFINITY }).collect();
        let mut grown = Self { distance, depth: drawn.to_vec() };
        for v in 0..height {
            for u in 0..width {
                let i = v * width + u;
                if u > 0 {
                    grown.relax(i, i - 1, NEXT[0]);
                }
                if v > 0 {
                    grown.relax(i, i - width, NEXT[0]);
                    if u > 0 {
                        grown.relax(i, i - width - 1, NEXT[1]);
                    }
                    if u + 1 < width {
                        grown.relax(i, i - width + 1, NEXT[1]);
                    }
                }
            }
        }
        for v in (0..height).rev() {
            for u in (0..width).rev() {
                let i = v * width + u;
                if u + 1 < width {
                    grown.relax(i, i + 1, NEXT[0]);
                }
                if v + 1 < height {
                    grown.relax(i, i + width, NEXT[0]);
                    if u > 0 {
                        grown.relax(i, i + width - 1, NEXT[1]);
                    }
                    if u + 1 < width {
                        grown.relax(i, i + width + 1, NEXT[1]);
                    }
                }
            }
        }
        grown
    }

    #[inline]
    fn relax(&mut self, i: usize, from: usize, step: f32) {
        let through = self.distance[from] + step;
        if through < self.distance[i] {
            (self.distance[i], self.depth[i]) = (through, self.depth[from]);
        }
    }
}
