//! Layers: a posed mesh as the span of each line of sight inside it.

use glam::{DVec3, Vec3};

use crate::geometry::mesh::Mesh;
use crate::geometry::pinhole::Pinhole;
use crate::geometry::rasteriser::Rasteriser;
use crate::geometry::similarity::Similarity;
use crate::precise::scoring::scene_term::Layer;

/// The layer of a mesh: entry and exit of the line of sight of each pixel. A mesh is taken as solid between them, which
/// holds for meshes that are not closed as well.
pub fn layer(mesh: &Mesh, camera_from_mesh: &Similarity, camera: &Pinhole, image: [usize; 2]) -> Layer {
    let (window, spans) = Rasteriser::new().render_spans(mesh, camera_from_mesh, camera, image);
    Layer { origin: window.first, width: window.size[0], spans }
}

/// The volume of the spans of a layer, and the volume that it shares with another one, cubic metres.
pub fn volumes(layer: &Layer, other: &Layer, camera: &Pinhole) -> [f64; 2] {
    // The part of a pixel's pyramid between two depths.
    let cone = |near: f32, far: f32| {
        let cube = |z: f32| f64::from(z) * f64::from(z) * f64::from(z);
        (cube(far) - cube(near)).max(0.0) / (3.0 * camera.fx * camera.fy)
    };
    let (mut own, mut shared) = (0.0, 0.0);
    for (i, [near, far]) in layer.spans.iter().enumerate().filter(|(_, span)| span[1] > 0.0) {
        own += cone(*near, *far);
        let pixel = [i % layer.width + layer.origin[0], i / layer.width + layer.origin[1]].map(|x| x as f64 + 0.5);
        let [other_near, other_far] = other.span(pixel);
        if other_far > 0.0 {
            shared += cone(near.max(other_near), far.min(other_far));
        }
    }
    [own, shared]
}

/// The lowest and the highest of some points along a direction, camera frame.
pub fn extremes_along(points: &[Vec3], normal: DVec3) -> [f64; 2] {
    extremes(points.iter().map(|p| normal.dot(p.as_dvec3())))
}

/// The least and the largest of some numbers.
pub fn extremes(numbers: impl Iterator<Item = f64>) -> [f64; 2] {
    numbers.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
}
