//! Point maps, x, y, z per pixel, in the frame of their camera: its depth and its intrinsics.

use crate::depth_image::{DepthImage, DepthReadOptions, Stored};
use crate::guard::unsupported;
use sim3align_geometry::depth_kind::DepthKind;
use sim3align_geometry::pinhole::Pinhole;
use sim3align_runtime::error::Result;

/// Points from which the axes are found.
const SAMPLES: usize = 4096;

/// The share of the variance of the columns and of the rows that a camera explains. Of point maps of networks, which are no
/// exact projections, it is above 0.999; of normals, colours and points of another frame below 0.9.
const EXPLAINED: f64 = 0.98;

/// The coordinates that are right, down and forward, in order of preference: most programs have z forward or backward.
const AXES: [[usize; 3]; 6] = [[0, 1, 2], [1, 2, 0], [2, 1, 0], [0, 2, 1], [1, 0, 2], [2, 0, 1]];

/// Which coordinates are right, down and forward, and whether the last is negative.
#[derive(Debug, Clone, Copy)]
struct Axes {
    order: [usize; 3],
    sign: f64,
}

/// A coordinate of the pixels as a linear function of one of the rays.
#[derive(Debug, Clone, Copy)]
struct Line {
    focal: f64,
    center: f64,
    /// The share of the variance.
    explained: f64,
}

/// Reads the depth and the camera of the points by their index, row-major. Depth is the coordinate that the others grow with, so
/// that the axes may be those of OpenCV (x right, y down, z forward), OpenGL (y up, z backward), PyTorch3D (x left, y up), or ROS
/// (x forward, y left, z up). The intrinsics are a least-squares fit.
pub(crate) fn read(
    stored: &Stored,
    options: &DepthReadOptions,
    kind: DepthKind,
    point: &dyn Fn(usize) -> [f64; 3],
) -> Result<DepthImage> {
    // Some programs repeat the depth in three channels.
    let is_one = |i| matches!(point(i).map(f64::to_bits), [x, y, z] if x == y && y == z);
    if (0..stored.width * stored.height).all(is_one) {
        return stored.read(options, kind, &|i| point(i)[2]);
    }
    let Some((axes, camera)) = fitted(stored, point) else {
        return Err(unsupported(
            "depth",
            format!(
                "three values per pixel, {} × {}, that are no points in front of a camera",
                stored.width, stored.height
            ),
            "one value per pixel, or points x, y, z in the frame of their camera",
            "Pass the depth alone. Colours and normals are no depth; transform points of a world frame to that of the camera.",
        ));
    };
    let mut image = stored.read(options, kind, &|i| axes.depth(point(i)).unwrap_or(f64::NAN))?;
    image.camera = Some(camera.0);
    if camera.1 != "x right, y down, z forward" {
        image.unit.source += &format!(", a point map with {}", camera.1);
    }
    Ok(image)
}

/// The axes, with the camera and the names of the axes; `None` if no pinhole camera sees these points.
fn fitted(stored: &Stored, point: &dyn Fn(usize) -> [f64; 3]) -> Option<(Axes, (Pinhole, String))> {
    let step = (stored.width * stored.height / SAMPLES).max(1);
    let axes = AXES.iter().flat_map(|&order| [1.0, -1.0].map(|sign| Axes { order, sign })).find(|axes| {
        // An odd step, so that the samples are not all in a few columns.
        let lines = axes.lines(stored, step | 1, point);
        lines.iter().all(|line| line.explained > EXPLAINED)
    })?;
    let [u, v] = axes.lines(stored, 1, point);
    let camera = Pinhole::new(u.focal.abs(), v.focal.abs(), u.center, v.center).ok()?;
    let [right, down, forward] = axes.order;
    let side = |positive: bool, words: [&'static str; 2]| words[usize::from(!positive)];
    let mut names = [
        (right, side(u.focal > 0.0, ["right", "left"])),
        (down, side(v.focal > 0.0, ["down", "up"])),
        (forward, side(axes.sign > 0.0, ["forward", "backward"])),
    ];
    names.sort_unstable();
    let names = names.map(|(axis, side)| format!("{} {side}", ["x", "y", "z"][axis]));
    Some((axes, (camera, names.join(", "))))
}

impl Axes {
    /// The distance along the optical axis; `None` without a reading.
    fn depth(self, point: [f64; 3]) -> Option<f64> {
        let depth = self.sign * point[self.order[2]];
        (depth > 0.0 && point.iter().all(|x| x.is_finite())).then_some(depth)
    }

    /// Columns and rows as functions of the rays, over every `step`th pixel.
    fn lines(self, stored: &Stored, step: usize, point: &dyn Fn(usize) -> [f64; 3]) -> [Line; 2] {
        let mut sums = [[0.0_f64; 6]; 2];
        for i in (0..stored.width * stored.height).step_by(step) {
            let at = point(i);
            let Some(depth) = self.depth(at) else { continue };
            for (axis, (sum, pixel)) in sums.iter_mut().zip([i % stored.width, i / stored.width]).enumerate() {
                let (x, y) = (at[self.order[axis]] / depth, pixel as f64);
                for (slot, value) in sum.iter_mut().zip([1.0, x, y, x * x, x * y, y * y]) {
                    *slot += value;
                }
            }
        }
        sums.map(|[n, x, y, xx, xy, yy]| {
            let (covariance, of_x, of_y) = (n * xy - x * y, n * xx - x * x, n * yy - y * y);
            let focal = covariance / of_x;
            // NaN, without points or variance, is compared as false.
            Line { focal, center: (y - focal * x) / n, explained: focal * covariance / of_y }
        })
    }
}
