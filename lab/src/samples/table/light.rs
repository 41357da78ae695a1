//! The light of the scene: a lamp with soft shadows, and the sky.

use crate::cases::print;
use crate::cases::scene::{camera_at, put_before};
use crate::prelude::*;

/// Where the lamp is, metres.
const LAMP: [f64; 3] = [-0.9, -0.75, 1.5];
/// Pixels of the shadow map, its focal length, and how many of its pixels the penumbra is wide, on each side.
const MAP: usize = 1024;
const FOCAL: f64 = 2600.0;
const PENUMBRA: i64 = 6;
/// Surfaces this much behind the nearest one, in metres, are still lit.
const BIAS_M: f32 = 0.004;
/// The lamp's light and that of the sky.
const LAMP_LIGHT: f64 = 1.55;
const SKY_LIGHT: f64 = 0.42;
const SHARPNESS: f64 = 60.0;

/// The light.
pub struct Light {
    shadow: Vec<f32>,
    lamp_from_world: Similarity,
    lens: Pinhole,
    lamp: Vector3<f64>,
}

impl Light {
    /// The light on these meshes.
    pub fn new<'a>(meshes: impl Iterator<Item = &'a Mesh>) -> Result<Self> {
        let lamp = Vector3::from(LAMP);
        let lens = Pinhole::new(FOCAL, FOCAL, 0.5 * MAP as f64, 0.5 * MAP as f64)?;
        let lamp_from_world = camera_at(&lamp, &(Vector3::new(0.03, 0.03, 0.05) - lamp).normalize(), 0.0)?;
        let mut shadow = vec![0.0f32; MAP * MAP];
        let mut rasteriser = Rasteriser::new();
        for mesh in meshes {
            rasteriser.render_depth(mesh, &lamp_from_world, &lens, MAP, MAP);
            put_before(&mut shadow, rasteriser.depth());
        }
        Ok(Self { shadow, lamp_from_world, lens, lamp })
    }

    /// The share of the lamp that lights a point.
    fn lit(&self, point: &Vector3<f64>) -> f64 {
        let seen = self.lamp_from_world.apply(*point);
        let [u, v] = self.lens.project(vec3(&seen)).map(|x| x.round() as i64);
        let (mut free, mut all) = (0, 0);
        for dv in (-PENUMBRA..=PENUMBRA).step_by(2) {
            for du in (-PENUMBRA..=PENUMBRA).step_by(2) {
                let (u, v) = (u + du, v + dv);
                all += 1;
                let inside = u >= 0 && v >= 0 && u < MAP as i64 && v < MAP as i64;
                let nearest = if inside { self.shadow[v as usize * MAP + u as usize] } else { 0.0 };
                free += i32::from(nearest == 0.0 || seen.z as f32 <= nearest + BIAS_M);
            }
        }
        f64::from(free) / f64::from(all)
    }

    /// The linear light that a surface sends to the eye.
    pub fn shade(
        &self,
        albedo: Vector3<f64>,
        gloss: f64,
        point: &Vector3<f64>,
        normal: &Vector3<f64>,
        to_eye: &Vector3<f64>,
    ) -> Vector3<f64> {
        let normal = if normal.dot(to_eye) < 0.0 { -normal } else { *normal };
        let to_lamp = (self.lamp - point).normalize();
        let lamp = self.lit(point) * LAMP_LIGHT;
        // What is near the table sees less of the sky.
        let open = 0.62 + 0.38 * (point.z / 0.06).clamp(0.0, 1.0);
        let open = if normal.z > 0.98 && point.z < 0.002 { 1.0 } else { open };
        let sky = SKY_LIGHT * open * (0.75 + 0.25 * normal.z);
        let half = (to_lamp + to_eye).normalize();
        let highlight = gloss * lamp * libm::pow(normal.dot(&half).max(0.0), SHARPNESS);
        let warm = Vector3::new(1.0, 0.95, 0.86) * (lamp * normal.dot(&to_lamp).max(0.0));
        albedo.component_mul(&(warm + Vector3::new(0.88, 0.95, 1.08) * sky)) + Vector3::repeat(highlight)
    }
}

/// sRGB-encoded bytes of a linear colour.
pub fn encoded(linear: Vector3<f64>) -> [u8; 3] {
    print::srgb(DVec3::from_array(linear.into()))
}

/// Bytes of a linear colour, as the vertices of a glTF mesh have them.
pub fn bytes(linear: Vector3<f64>) -> [u8; 3] {
    linear.map(|x| (255.0 * x.clamp(0.0, 1.0)).round() as u8).into()
}
