//! Photos: a scene under unknown light, through a camera with its own white balance, focus, noise and number of pixels,
//! most of them saved as JPEG.

use crate::case_folder::write::rgb_jpeg;
use crate::conditions::{Conditions, Tier};
use crate::objects::mesh::face;
use crate::objects::print::{Print, color, encoded};
use crate::prelude::*;
use crate::world::unit;
use crate::world::view::Rendering;
use sim3align_formats::photo::read_photo;

/// Of a harsh photo: the share of the object that is blown out or black, at most, the reflections, and the offset in pixels.
const HARSH_SHARE: f64 = 0.5;
const HARSH_HIGHLIGHT: [f64; 2] = [0.3, 1.2];
const HARSH_SHIFT: f64 = 8.0;
/// Linear values from which on a pixel is blown out, and below which it is black.
const RANGE: [f64; 2] = [0.004, 1.0];

/// Sizes of photos relative to the depth map; the field of view is the same.
const SIZES: [f64; 3] = [0.5, 1.5, 2.0];

/// The light of a scene, and the response of the camera.
struct PhotoStyle {
    /// Towards the light, world frame.
    light: DVec3,
    ambient: f64,
    highlight: f64,
    gain: DVec3,
    /// A shadow over a part of the image: direction, start and depth.
    shadow: (DVec3, f64, f64),
    noise: f64,
    blur: usize,
    /// Offset from the depth map, in its pixels.
    shift: [f64; 2],
    /// Size relative to the depth map.
    size: f64,
    /// Quality of the JPEG, and whether chroma has half the resolution; `None` for an image without loss.
    jpeg: Option<(u8, bool)>,
}

impl PhotoStyle {
    fn draw(random: &mut Random, tier: Tier, resolution: f64, is_harsh: bool) -> Self {
        let light = unit(TAU * random.uniform()).extend(between(random, 0.3, 2.0)).normalize();
        let warmth = between(random, -1.0, 1.0) * tier.pick(0.08, 0.2, 0.35);
        let exposure = libm::exp(between(random, -1.0, 1.0) * tier.pick(0.2, 0.4, 0.7));
        let tint = between(random, -1.0, 1.0) * tier.pick(0.03, 0.06, 0.1);
        let angle = TAU * random.uniform();
        let depth = if chance(random, tier.pick(0.0, 0.3, 0.5)) { between(random, 0.3, 0.8) } else { 1.0 };
        let shift = if is_harsh { HARSH_SHIFT } else { tier.pick(1.0, 3.0, 6.0) * resolution };
        let [dull, bright] = if is_harsh { HARSH_HIGHLIGHT } else { [0.0, tier.pick(0.05, 0.2, 0.4)] };
        Self {
            light,
            ambient: between(random, 0.35, 0.8),
            highlight: between(random, dull, bright),
            gain: exposure * DVec3::new(1.0 + warmth, 1.0 + tint, 1.0 - warmth),
            shadow: (unit(angle).extend(0.0), between(random, -0.5, 0.5), depth),
            noise: between(random, 0.2, 1.0) * tier.pick(0.01, 0.02, 0.035),
            blur: random.below(tier.pick(1, 2, 3) + 1),
            shift: [between(random, -shift, shift), between(random, -shift, shift)],
            size: if chance(random, 0.6) { SIZES[random.below(SIZES.len())] } else { 1.0 },
            jpeg: chance(random, 0.75)
                .then(|| (between(random, tier.pick(80.0, 60.0, 40.0), 96.0) as u8, chance(random, 0.7))),
        }
    }
}

/// Takes the photo of a scene whose object, `placed` in the world, has a print.
pub fn take(
    rendering: &Rendering,
    (placed, print): (&Mesh, &Print),
    conditions: Conditions,
    random: &mut Random,
) -> Result<Photo> {
    let (tier, is_grey) = (conditions.tier, conditions.class.is_grey);
    let is_harsh = conditions.class.is_harsh;
    let style = PhotoStyle::draw(random, tier, rendering.view.resolution(), is_harsh);
    let [width, height] =
        [rendering.view.width, rendering.view.height].map(|side| (style.size * side as f64).round() as usize);
    let camera = resized(&rendering.view.camera, style.size);
    let mut rasteriser = Rasteriser::new();
    rasteriser.render(placed, &rendering.view.camera_from_world, &camera, width, height);
    let world_from_camera = rendering.view.camera_from_world.inverse();
    let eye = rendering.view.eye();
    let (ground, other) = (color(random), color(random));
    let lit = |albedo: DVec3, point: DVec3, normal: DVec3, at: DVec3| {
        let diffuse = normal.dot(style.light).max(0.0);
        let half = (style.light + (eye - point).normalize_or_zero()).normalize_or_zero();
        let highlight = style.highlight * libm::pow(normal.dot(half).max(0.0), 30.0);
        let (across, start, depth) = style.shadow;
        let shade = 1.0 - (1.0 - depth) * ((across.dot(at) - start) * 8.0).clamp(0.0, 1.0);
        (albedo * (style.ambient + (1.0 - style.ambient) * diffuse) + highlight) * shade * style.gain
    };
    let mut linear = Vec::with_capacity(width * height);
    let mut of_object = Vec::new();
    for v in 0..height {
        for u in 0..width {
            let i = v * width + u;
            // The pixel of the depth map in which the centre of this one lies.
            let [column, row] = [(u, rendering.view.width), (v, rendering.view.height)]
                .map(|(x, size)| (((x as f64 + 0.5) / style.size) as usize).min(size - 1));
            let place = row * rendering.view.width + column;
            let is_hidden = rendering.object_depth[place] > 0.0 && !rendering.visible[place];
            let triangle = rasteriser.triangles()[i];
            let is_object = triangle != NO_TRIANGLE && !is_hidden;
            let z = if is_object { rasteriser.depth()[i] } else { rendering.depth[place] };
            let point = world_from_camera.apply(vector3(camera.back_project(u as f64, v as f64, f64::from(z))));
            let point = vec3(&point).as_dvec3();
            let at = DVec3::new(2.0 * u as f64 / width as f64 - 1.0, 2.0 * v as f64 / height as f64 - 1.0, 0.0);
            linear.push(if is_object {
                let normal = face(placed, triangle as usize).normalize_or_zero();
                let normal = if normal.dot(eye - point) < 0.0 { -normal } else { normal };
                of_object.push(i);
                lit(print.at(point, normal), point, normal, at)
            } else {
                let albedo = if point.z < 0.002 { ground } else { other };
                lit(albedo, point, DVec3::Z, at)
            });
        }
    }
    if is_harsh {
        let gain = harsh_gain(of_object.iter().map(|&i| linear[i].max_element()), random);
        linear.iter_mut().for_each(|value| *value *= gain);
    }
    let blurred = blurred(linear, width, height, style.blur);
    let mut pixels = Vec::with_capacity(width * height);
    for v in 0..height {
        for u in 0..width {
            let from = |x: usize, by: f64, size: usize| {
                (x as f64 + style.size * by).round().clamp(0.0, size as f64 - 1.0) as usize
            };
            let (u, v) = (from(u, style.shift[0], width), from(v, style.shift[1], height));
            let mut shown = encoded(blurred[v * width + u]);
            if is_grey {
                shown = DVec3::splat(shown.dot(DVec3::new(0.299, 0.587, 0.114)));
            }
            let noisy = |x: f64, noise: f64| (255.0 * (x + noise)).round().clamp(0.0, 255.0) as u8;
            let common = style.noise * normal(random);
            let own = if is_grey { [0.0; 3] } else { [0, 1, 2].map(|_| style.noise * normal(random)) };
            pixels.push([0, 1, 2].map(|k| noisy(shown[k], common + own[k])));
        }
    }
    match style.jpeg {
        Some((quality, is_halved)) => read_photo(&rgb_jpeg(&pixels, width, height, quality, is_halved)?),
        None => Image::new("photo", width, height, pixels),
    }
}

/// The exposure with which a share of the pixels with these values is blown out, or black.
fn harsh_gain(values: impl Iterator<Item = f64>, random: &mut Random) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    let share = between(random, 0.1, HARSH_SHARE);
    let is_bright = chance(random, 0.7);
    let place = (if is_bright { 1.0 - share } else { share }) * values.len() as f64;
    let limit = values.get(place as usize).copied().unwrap_or(1.0).max(1e-3);
    RANGE[usize::from(is_bright)] / limit
}

/// The camera of the same field of view with another number of pixels.
fn resized(camera: &Pinhole, by: f64) -> Pinhole {
    let centre = |c: f64| by * (c + 0.5) - 0.5;
    Pinhole { fx: by * camera.fx, fy: by * camera.fy, cx: centre(camera.cx), cy: centre(camera.cy) }
}

/// Means over squares of 2·`radius` + 1 pixels.
fn blurred(pixels: Vec<DVec3>, width: usize, height: usize, radius: usize) -> Vec<DVec3> {
    if radius == 0 {
        return pixels;
    }
    let pass = |from: &[DVec3], stride: usize, size: usize| -> Vec<DVec3> {
        let mean = |i: usize| {
            let at = i / stride % size;
            let (first, last) = (at.saturating_sub(radius), (at + radius).min(size - 1));
            (first..=last).map(|k| from[i - at * stride + k * stride]).sum::<DVec3>() / (last - first + 1) as f64
        };
        (0..from.len()).map(mean).collect()
    };
    pass(&pass(&pixels, 1, width), width, height)
}
