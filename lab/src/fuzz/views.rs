//! Observations: images of every shape, masks of a pixel, a row, a line or everything, cameras of many decades.

use std::sync::Arc;

use super::choices::Choices;
use super::options::any_number;
use crate::prelude::*;

/// Sizes of the images.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Size {
    /// Up to 64 × 64.
    Small,
    /// VGA, and up to 100 000 pixels long.
    Large,
}

/// Most pixels of an image, so that the generator itself takes little time.
const MAX_PIXELS: usize = 1 << 24;

/// An observation, and a description of it.
pub fn view(c: &mut Choices, size: Size) -> (String, Result<Observation>) {
    let (words, parts) = parts(c, size);
    (words, parts.and_then(|(depth, mask, camera)| Observation::new(depth, mask, camera)))
}

type Parts = (DepthMap, Mask, Pinhole);

fn parts(c: &mut Choices, size: Size) -> (String, Result<Parts>) {
    let [width, height] = image_size(c, size);
    let (camera_words, camera) = camera(c, [width, height]);
    let (mask_words, mask) = mask(c, [width, height]);
    let (depth_words, depth) = depth(c, [width, height]);
    let words = format!("{width} × {height}, mask {mask_words}, depth {depth_words}, camera {camera_words}");
    let parts = camera.and_then(|camera| {
        Ok((DepthMap::from_metres(width, height, depth)?, Mask::new("mask", width, height, mask)?, camera))
    });
    (words, parts)
}

/// A frame of several, also one without a mask, with an empty one or one of another size, or with a photo of any size.
pub fn frame(c: &mut Choices, size: Size) -> (String, Result<Frame>) {
    let (mut words, parts) = parts(c, size);
    let masked = if c.once_in(4) { c.below(4) } else { 0 };
    let photo = photo(c);
    words += ["", ", without the mask", ", mask emptied", ", mask of another size"][masked];
    if let Some(photo) = &photo {
        words += &format!(", photo of {} × {}", photo.width(), photo.height());
    }
    let frame = parts.map(|(depth, mask, camera)| {
        let mask = match masked {
            0 => Some(mask),
            1 => None,
            2 => Some(Mask::filled(mask.width(), mask.height(), 0)),
            _ => Some(Mask::filled(mask.width() + 1, mask.height(), 1)),
        };
        // Half of the photos have the shape of the depth map.
        let photo = photo.map(|photo| match photo.width() {
            1 => Photo::filled(depth.width(), depth.height(), photo.data()[0]),
            _ => photo,
        });
        Frame { depth, camera, mask, photo: photo.map(Arc::new) }
    });
    (words, frame)
}

/// A photo of a colour or of noise; one of a single column stands for one of the size of the depth map.
fn photo(c: &mut Choices) -> Option<Photo> {
    if !c.once_in(3) {
        return None;
    }
    let (width, height) = if c.once_in(2) { (c.size(1, 2000), c.size(1, 200)) } else { (1, 1) };
    let mut random = c.noise();
    let mut channel = || (256.0 * random.uniform()) as u8;
    let data = (0..width * height).map(|_| [channel(), channel(), channel()]).collect();
    Photo::new("image", width, height, data).ok()
}

fn image_size(c: &mut Choices, size: Size) -> [usize; 2] {
    if size == Size::Small {
        return if c.once_in(8) { [c.size(1, 64), c.size(1, 64)] } else { [c.size(16, 64), c.size(16, 64)] };
    }
    let longest = if c.once_in(8) { 4096 } else { 1280 };
    let [width, height] = match c.below(6) {
        0 | 1 => [640, 480],
        2 => [c.size(64, longest), c.size(64, longest)],
        3 => [c.size(1, 64), c.size(64, 100_000)],
        4 => [c.size(64, 100_000), c.size(1, 64)],
        _ => [c.size(1, 100_000), c.size(1, 100_000)],
    };
    [width, height.min(MAX_PIXELS / width).max(1)]
}

fn camera(c: &mut Choices, [width, height]: [usize; 2]) -> (String, Result<Pinhole>) {
    let (w, h) = (width as f64, height as f64);
    let focal = w.max(h) * c.pick(&[1.0, 0.5, 2.0, 0.1, 10.0]);
    let [mut fx, mut fy, mut cx, mut cy] = [focal, focal, 0.5 * w - 0.5, 0.5 * h - 0.5];
    for _ in 0..c.below(8).saturating_sub(5) {
        match c.below(7) {
            0 => {}
            1 => fx *= c.power(12),
            2 => fy *= c.power(12),
            3 => [fx, fy] = [fx, fy].map(|f| f * if c.once_in(2) { 1e-3 } else { 1e3 }),
            4 => cx += w * c.pick(&[1.0, -1.0, 10.0, 1e3, 1e6, 1e12]),
            5 => cy += h * c.pick(&[1.0, -1.0, 10.0, 1e3, 1e6, 1e12]),
            _ => match c.below(4) {
                0 => fx = any_number(c),
                1 => fy = any_number(c),
                2 => cx = any_number(c),
                _ => cy = any_number(c),
            },
        }
    }
    (format!("{fx} {fy} {cx} {cy}"), Pinhole::new(fx, fy, cx, cy))
}

fn mask(c: &mut Choices, [width, height]: [usize; 2]) -> (&'static str, Vec<u8>) {
    let (w, h) = (width as f64, height as f64);
    let [cu, cv] = [0.5 - 0.25 * c.share(), 0.5 - 0.25 * c.share()];
    let radius = 0.45 - 0.4 * c.share();
    let thickness = c.size(1, 8);
    let mut random = c.noise();
    let density = c.pick(&[0.5, 0.1, 0.01, 0.9]);
    let of = |set: &mut dyn FnMut(usize, usize) -> bool| {
        let pixels = (0..height).flat_map(|v| (0..width).map(move |u| (u, v)));
        pixels.map(|(u, v)| u8::from(set(u, v))).collect::<Vec<u8>>()
    };
    let blob = |u: usize, v: usize| {
        let (x, y) = (u as f64 / w - cu, v as f64 / h - cv);
        x * x + y * y < radius * radius
    };
    let [row, column] = [(cv * h) as usize, (cu * w) as usize];
    let kind = if c.once_in(2) { c.below(12) } else { 0 };
    match kind {
        0 | 1 => ("blob", of(&mut |u, v| blob(u, v))),
        2 => ("everything", of(&mut |_, _| true)),
        3 => ("pixel", of(&mut |u, v| u == column && v == row)),
        4 => ("row", of(&mut |_, v| v.abs_diff(row) < thickness)),
        5 => ("column", of(&mut |u, _| u.abs_diff(column) < thickness)),
        6 => {
            let slope = w / h;
            ("diagonal", of(&mut |u, v| u.abs_diff((slope * v as f64) as usize) < thickness))
        }
        7 => ("checkerboard", of(&mut |u, v| (u / thickness + v / thickness).is_multiple_of(2) && blob(u, v))),
        8 => ("scattered pixels", of(&mut |_, _| random.uniform() < density)),
        9 => ("border", of(&mut |u, v| u.min(width - 1 - u).min(v).min(height - 1 - v) < thickness)),
        10 => ("two pixels in opposite corners", of(&mut |u, v| u + v == 0 || (u + 1 == width && v + 1 == height))),
        _ => ("blob and its far corner", of(&mut |u, v| blob(u, v) || u + v < 2 * thickness)),
    }
}

fn depth(c: &mut Choices, [width, height]: [usize; 2]) -> (String, Vec<f32>) {
    let (w, h) = (width as f64, height as f64);
    let mut random = c.noise();
    let holes = c.pick(&[0.0, 0.0, 0.0, 0.05, 0.5, 0.97]);
    let kind = if c.once_in(2) { c.below(8) } else { 0 };
    let unit = c.power(30);
    let mut at = |i: usize| -> f64 {
        let (x, y) = ((i % width) as f64 / w - 0.5, (i / width) as f64 / h - 0.5);
        let r = x * x + y * y;
        match kind {
            0 | 1 => 1.0 + r - if r < 0.1 { 0.3 } else { 0.0 },
            2 => 0.5 + 1e-6 * i as f64,
            3 => 0.5 + random.uniform(),
            4 => 2.0,
            5 => 1.0 + 0.5 * x,
            6 => [0.3, 5.0][i % 2],
            _ => libm::pow(10.0, 8.0 * random.uniform() - 4.0),
        }
    };
    let mut depths: Vec<f32> = (0..width * height).map(|i| (unit * at(i)) as f32).collect();
    if holes > 0.0 {
        for z in &mut depths {
            if random.uniform() < holes {
                *z = 0.0;
            }
        }
    }
    if c.once_in(32) {
        let hostile = c.pick(&[f32::NAN, f32::INFINITY, -1.0, f32::MAX, f32::MIN_POSITIVE, 1e-45]);
        depths.iter_mut().step_by(3).for_each(|z| *z = hostile);
    }
    (
        format!("{} × {unit:e}", ["dome", "dome", "ramp", "noise", "constant", "plane", "stripes", "decades"][kind]),
        depths,
    )
}
