//! Images of every shape, masks of a pixel, a row or everything, cameras of many decades.

use std::sync::Arc;

use sim3align::error::Result;
use sim3align::evidence::frame::Frame;
use sim3align::evidence::observation::Observation;
use sim3align::evidence::photo::Photo;
use sim3align::geometry::image::{DepthMap, Mask};
use sim3align::geometry::pinhole::Pinhole;

use crate::entropy::Entropy;

/// Most pixels of an image, so that making it takes little time.
const MAX_PIXELS: usize = 1 << 22;

pub fn observation(e: &mut Entropy<'_>, is_large: bool) -> Result<Observation> {
    let [width, height] = size(e, is_large);
    let camera = camera(e, [width, height]);
    let mask = mask(e, [width, height]);
    let depth = DepthMap::from_metres(width, height, depth(e, [width, height]))?;
    Observation::new(depth, Mask::new("mask", width, height, mask)?, camera?)
}

/// A frame, also one without a mask, with an empty one or one of another size, or with a photo of any size.
pub fn frame(e: &mut Entropy<'_>) -> Result<Frame> {
    let [width, height] = size(e, false);
    let camera = camera(e, [width, height]);
    let mask = match e.below(24) {
        21 => None,
        22 => Some(Mask::filled(width, height, 0)),
        23 => Some(Mask::filled(width + 1, height, 1)),
        _ => Some(Mask::new("mask", width, height, mask(e, [width, height]))?),
    };
    let depth = DepthMap::from_metres(width, height, depth(e, [width, height]))?;
    let photo = match e.below(24) {
        0..16 => None,
        16..23 => Some(photo(e, [width, height])?),
        _ => {
            let any = [e.size(1, 2000), e.size(1, 200)];
            Some(photo(e, any)?)
        }
    };
    Ok(Frame { depth, camera: camera?, mask, photo: photo.map(Arc::new), relief_deviation: 0.0 })
}

fn photo(e: &mut Entropy<'_>, [width, height]: [usize; 2]) -> Result<Photo> {
    let mut random = e.noise();
    let mut channel = || (256.0 * random.uniform()) as u8;
    Photo::new("image", width, height, (0..width * height).map(|_| [channel(), channel(), channel()]).collect())
}

fn size(e: &mut Entropy<'_>, is_large: bool) -> [usize; 2] {
    let [width, height] = match (is_large, e.below(6)) {
        (false, 0) => [e.size(1, 64), e.size(1, 64)],
        (false, _) => [e.size(16, 64), e.size(16, 64)],
        (true, 0 | 1) => [640, 480],
        (true, 2) => [e.size(64, 4096), e.size(64, 4096)],
        (true, 3) => [e.size(1, 64), e.size(64, 100_000)],
        (true, _) => [e.size(64, 100_000), e.size(1, 64)],
    };
    [width, height.min(MAX_PIXELS / width).max(1)]
}

fn camera(e: &mut Entropy<'_>, [width, height]: [usize; 2]) -> Result<Pinhole> {
    let (w, h) = (width as f64, height as f64);
    let focal = w.max(h) * e.pick(&[1.0, 0.5, 2.0, 0.1, 10.0]);
    let mut numbers = [focal, focal, 0.5 * w - 0.5, 0.5 * h - 0.5];
    for _ in 0..e.below(8).saturating_sub(5) {
        let at = e.below(4);
        numbers[at] = match e.below(3) {
            0 => numbers[at] * e.power(12),
            1 => numbers[at] + w * e.pick(&[1.0, -1.0, 10.0, 1e3, 1e6, 1e12]),
            _ => e.number(),
        };
    }
    let [fx, fy, cx, cy] = numbers;
    Pinhole::new(fx, fy, cx, cy)
}

fn mask(e: &mut Entropy<'_>, [width, height]: [usize; 2]) -> Vec<u8> {
    let [cu, cv] = [0, 1].map(|_| 0.5 - 0.02 * e.below(12) as f64);
    let radius = 0.45 - 0.04 * e.below(10) as f64;
    let thickness = e.size(1, 8);
    let density = e.pick(&[0.5, 0.1, 0.01, 0.9]);
    let mut random = e.noise();
    let kind = if e.once_in(2) { e.below(10) } else { 0 };
    let [row, column] = [(cv * height as f64) as usize, (cu * width as f64) as usize];
    let mut is_set = |u: usize, v: usize| {
        let (x, y) = (u as f64 / width as f64 - cu, v as f64 / height as f64 - cv);
        let is_blob = x * x + y * y < radius * radius;
        match kind {
            0 | 1 => is_blob,
            2 => true,
            3 => u == column && v == row,
            4 => v.abs_diff(row) < thickness,
            5 => u.abs_diff(column) < thickness,
            6 => is_blob && (u / thickness + v / thickness).is_multiple_of(2),
            7 => random.uniform() < density,
            8 => u.min(width - 1 - u).min(v).min(height - 1 - v) < thickness,
            _ => u + v == 0 || (u + 1 == width && v + 1 == height),
        }
    };
    (0..width * height).map(|i| u8::from(is_set(i % width, i / width))).collect()
}

fn depth(e: &mut Entropy<'_>, [width, height]: [usize; 2]) -> Vec<f32> {
    let holes = e.pick(&[0.0, 0.0, 0.0, 0.05, 0.5, 0.97]);
    let kind = if e.once_in(2) { e.below(8) } else { 0 };
    let unit = e.power(30);
    let hostile = e.once_in(32).then(|| e.pick(&[f32::NAN, f32::INFINITY, -1.0, f32::MAX, f32::MIN_POSITIVE, 1e-45]));
    let mut random = e.noise();
    let mut at = |i: usize| {
        let (x, y) = ((i % width) as f64 / width as f64 - 0.5, (i / width) as f64 / height as f64 - 0.5);
        let r = x * x + y * y;
        match kind {
            0 | 1 => 1.0 + r - if r < 0.1 { 0.3 } else { 0.0 },
            2 => 0.5 + 1e-6 * i as f64,
            3 => 0.5 + random.uniform(),
            4 => 2.0,
            5 => 1.0 + 0.5 * x,
            6 => [0.3, 5.0][i % 2],
            _ => 10f64.powf(8.0 * random.uniform() - 4.0),
        }
    };
    let mut depths: Vec<f32> = (0..width * height).map(|i| (unit * at(i)) as f32).collect();
    depths.iter_mut().filter(|_| random.uniform() < holes).for_each(|z| *z = 0.0);
    if let Some(hostile) = hostile {
        depths.iter_mut().step_by(3).for_each(|z| *z = hostile);
    }
    depths
}
