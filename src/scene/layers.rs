//! Layers: a posed mesh as the span of each line of sight inside it.

use glam::{DVec3, Vec3};

use crate::geometry::mesh::Mesh;
use crate::geometry::pinhole::Pinhole;
use crate::geometry::similarity::{Similarity, vec3, vector3};
use crate::precise::scoring::surroundings::Layer;

/// The layer of a mesh: entry and exit of the line of sight of each pixel. A mesh is taken as solid between them, which
/// holds for meshes that are not closed as well. Triangles behind the camera are left out.
pub fn layer(mesh: &Mesh, camera_from_mesh: &Similarity, camera: &Pinhole, [width, height]: [usize; 2]) -> Layer {
    let points: Vec<Vec3> = mesh.positions().iter().map(|p| vec3(&camera_from_mesh.apply(vector3(*p)))).collect();
    let seen: Vec<Option<[f64; 2]>> = points.iter().map(|p| (p.z > 1e-6).then(|| camera.project(*p))).collect();
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for at in seen.iter().flatten() {
        for axis in 0..2 {
            low[axis] = low[axis].min(at[axis]);
            high[axis] = high[axis].max(at[axis]);
        }
    }
    let size = [width, height];
    let first = [0, 1].map(|axis| (low[axis].max(0.0) as usize).min(size[axis]));
    let last = [0, 1].map(|axis| (high[axis].max(-1.0) + 2.0).min(size[axis] as f64) as usize);
    let sides = [0, 1].map(|axis| last[axis].saturating_sub(first[axis]));
    let mut layer = Layer { origin: first, width: sides[0], spans: vec![[0.0; 2]; sides[0] * sides[1]] };
    for triangle in mesh.triangles() {
        let [a, b, c] = triangle.map(|i| i as usize);
        let (Some(pa), Some(pb), Some(pc)) = (seen[a], seen[b], seen[c]) else { continue };
        fill(&mut layer, [pa, pb, pc], [points[a].z, points[b].z, points[c].z]);
    }
    layer
}

fn fill(layer: &mut Layer, corners: [[f64; 2]; 3], z: [f32; 3]) {
    let rows = layer.spans.len() / layer.width.max(1);
    let [a, b, c] = corners.map(|[u, v]| [u - layer.origin[0] as f64, v - layer.origin[1] as f64]);
    let bounds = |axis: usize, count: usize| {
        let low = a[axis].min(b[axis]).min(c[axis]).max(0.0).ceil() as usize;
        let high = a[axis].max(b[axis]).max(c[axis]);
        low..if high < 0.0 { 0 } else { (high as usize + 1).min(count) }
    };
    let area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
    if area == 0.0 {
        return;
    }
    let edge = |p: [f64; 2], q: [f64; 2], at: [f64; 2]| (q[0] - p[0]) * (at[1] - p[1]) - (q[1] - p[1]) * (at[0] - p[0]);
    let inverse = z.map(|z| 1.0 / f64::from(z));
    for v in bounds(1, rows) {
        for u in bounds(0, layer.width) {
            let at = [u as f64, v as f64];
            let weights = [edge(b, c, at) / area, edge(c, a, at) / area, edge(a, b, at) / area];
            if weights.iter().any(|w| *w < 0.0) {
                continue;
            }
            let depth = (1.0 / weights.iter().zip(inverse).map(|(w, i)| w * i).sum::<f64>()) as f32;
            let span = &mut layer.spans[v * layer.width + u];
            *span = if span[1] == 0.0 { [depth; 2] } else { [span[0].min(depth), span[1].max(depth)] };
        }
    }
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
