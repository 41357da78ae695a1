//! Renders an object on a table as depth map, with the errors of monocular depth models.

use crate::cases::distortion::{corners_of, mapped};
use crate::cases::readings::disc;
use crate::cases::scene::{View, camera_at, count, hidden, put_before, shown};
use crate::prelude::*;

/// Random stream of the viewpoint.
const VIEW_STREAM: u64 = 0x7669_6577;

/// Random stream of the errors of the depth map.
const DEPTH_STREAM: u64 = 0x6465_7074;

const WIDTH: usize = 640;
const HEIGHT: usize = 480;

/// The largest share of an object that is hidden, and how many half centimetres aside a thing moves at most to hide
/// less.
const MOST_HIDDEN: f64 = 0.35;
const STEPS_ASIDE: u8 = 40;
/// How far apart they stand, metres.
const GAP_M: f32 = 0.008;
/// Largest sum of the amplitudes of the low-frequency warp, as a share of depth.
const WARP: f64 = 0.01;
/// Waves that the warp is made of.
const WAVES: usize = 4;
/// Half the range of the noise per pixel, as a share of depth; its density is a triangle.
const NOISE: f64 = 0.001;
/// Share of the silhouette's outermost pixels that fly, and how far towards the background at most; then the same
/// for the second row of pixels.
const FLYING: [[f64; 2]; 2] = [[0.5, 0.4], [0.25, 0.2]];

/// Where the camera stands, what it is, and the room about the object.
#[derive(Debug, Clone, Copy)]
pub struct RoomView {
    /// The world is the frame of the object.
    pub view: View,
    /// The wall's unit normal, towards the camera, and its distance behind the object's axis, object frame, metres.
    wall: (Vector3<f64>, f64),
}

/// An object as a depth model sees it.
#[derive(Debug, Clone)]
pub struct Seen {
    /// Depth in metres; 0 is "no reading".
    pub depth: DepthMap,
    /// Mask of the object.
    pub mask: Mask,
    /// For each vertex of the mesh, whether a triangle of it is visible.
    pub vertices: Vec<bool>,
}

impl RoomView {
    /// A view from one side and somewhat above, with what is towards +x (a handle) at the side.
    ///
    /// # Errors
    /// Those of [`Pinhole::new`] and [`Similarity::from_parts`], which only a bug in the generator could cause.
    pub fn new(mesh: &Mesh, seed: u64) -> Result<Self> {
        let random = &mut Random::new(seed, VIEW_STREAM);
        let side = if random.below(2) == 0 { -1.0 } else { 1.0 };
        let azimuth = side * between(random, 60.0, 95.0).to_radians();
        let elevation = between(random, 25.0, 35.0).to_radians();
        let distance_m = between(random, 0.5, 0.7);
        let height_m = mesh.positions().iter().fold(0.0f32, |top, p| top.max(p.z));
        let (sine, cosine) = libm::sincos(azimuth);
        let towards = Vector3::new(cosine, sine, 0.0);
        let (rise, level) = libm::sincos(elevation);
        let middle = Vector3::new(0.0, 0.0, 0.5 * f64::from(height_m));
        let eye = middle + (towards * level + Vector3::z() * rise) * distance_m;
        let aim =
            Vector3::new(between(random, -0.02, 0.02), between(random, -0.02, 0.02), between(random, -0.01, 0.01));
        let forward = (middle + aim - eye).normalize();
        let focal = between(random, 590.0, 610.0);
        let (cx, cy) = (between(random, 316.0, 323.0), between(random, 236.0, 243.0));
        let (camera, camera_from_world) = (Pinhole::new(focal, focal, cx, cy)?, camera_at(&eye, &forward, 0.0)?);
        let view = View { width: WIDTH, height: HEIGHT, camera, camera_from_world };
        Ok(Self { view, wall: (towards, between(random, 0.25, 0.45)) })
    }

    /// The thing moved to where it hides a good part of the object, if it is of a fitting size: on the table, right
    /// before the object, and aside as far as it has to be.
    ///
    /// # Errors
    /// Those of [`Mesh::new`], which only a bug in the generator could cause.
    pub fn before(&self, object: &Mesh, thing: &Mesh) -> Result<Mesh> {
        let alone = self.view.depth_of(object);
        let towards = vec3(&self.wall.0);
        let reach = |mesh: &Mesh, way: Vec3| mesh.positions().iter().fold(0.0f32, |far, p| far.max(p.dot(way)));
        let before = towards * (GAP_M + reach(object, towards) + reach(thing, -towards));
        let aside = Vec3::Z.cross(towards);
        let at = |step: u8| {
            let place = before + aside * (0.005 * f32::from(step));
            mapped(thing, |p| *p + place)
        };
        for step in 0..STEPS_ASIDE {
            let placed = at(step)?;
            if hidden(&alone, &self.view.depth_of(&placed)) as f64 <= MOST_HIDDEN * count(&alone) as f64 {
                return Ok(placed);
            }
        }
        at(STEPS_ASIDE)
    }

    /// Renders the object on its table, with what stands before it, and degrades the depth as a monocular model would.
    /// The warp has no part that scales the object as a whole: the truth is that of the depth map's own metric.
    ///
    /// # Errors
    /// Those of [`Image::new`], which only a bug in the generator could cause.
    pub fn see(&self, mesh: &Mesh, occluder: Option<&Mesh>, seed: u64) -> Result<Seen> {
        let mut others = occluder.map_or_else(|| vec![0.0; WIDTH * HEIGHT], |occluder| self.view.depth_of(occluder));
        let (object, triangles) = self.view.render(mesh);
        let visible = shown(&object, &others);
        let mask = Image::new("mask", WIDTH, HEIGHT, visible.iter().map(|&visible| u8::from(visible)).collect())?;
        let seen = triangles.into_iter().zip(visible).filter(|(_, visible)| *visible);
        let vertices = corners_of(mesh, seen.map(|(triangle, _)| triangle));
        let mut random = Random::new(seed, DEPTH_STREAM);
        put_before(&mut others, &object);
        let mut depth = self.with_flying_pixels(&others, &mut random);
        let warp = warp(&mask, &mut random);
        for (z, warp) in depth.iter_mut().zip(warp) {
            let noise = NOISE * (random.uniform() + random.uniform() - 1.0);
            *z *= (warp * (1.0 + noise)) as f32;
        }
        punch_holes(&mut depth, &mask, &mut random);
        Ok(Seen { depth: DepthMap::from_metres(WIDTH, HEIGHT, depth)?, mask, vertices })
    }

    /// What stands on the table and the background, mixed along the silhouette: inside up to two pixels, outside one.
    fn with_flying_pixels(&self, object: &[f32], random: &mut Random) -> Vec<f32> {
        let mut depth = self.view.background_along(self.wall, |u, v| {
            let ray = vector3(self.view.camera.back_project(u, v, 1.0));
            [ray.x, ray.y]
        });
        let inside = |u: usize, v: usize| object[v * WIDTH + u] > 0.0;
        for v in 0..HEIGHT {
            for u in 0..WIDTH {
                let (i, row) = (v * WIDTH + u, ring(object, u, v));
                // Drawn for every pixel, so that the noise does not depend on the silhouette.
                let (chance, share) = (random.uniform(), random.uniform());
                let background = depth[i];
                if inside(u, v) {
                    depth[i] = object[i];
                }
                let Some((row, across)) = row else { continue };
                let [flying, most] = FLYING[row];
                if chance < flying {
                    let other = across.unwrap_or(background);
                    depth[i] += (most * share) as f32 * (other - depth[i]);
                }
            }
        }
        depth
    }
}

/// Which row of pixels along the silhouette a pixel is in, and, outside, the object's depth beside it.
fn ring(object: &[f32], u: usize, v: usize) -> Option<(usize, Option<f32>)> {
    let around = |reach: usize| {
        let rows = v.saturating_sub(reach)..=(v + reach).min(HEIGHT - 1);
        rows.flat_map(move |y| {
            (u.saturating_sub(reach)..=(u + reach).min(WIDTH - 1)).map(move |x| object[y * WIDTH + x])
        })
    };
    if object[v * WIDTH + u] > 0.0 {
        (1..=2).find(|&reach| around(reach).any(|z| z == 0.0)).map(|reach| (reach - 1, None))
    } else {
        around(1).find(|&z| z > 0.0).map(|z| (0, Some(z)))
    }
}

/// Waves as long as the image or half of it, with a mean of 1 over the mask.
fn warp(mask: &Mask, random: &mut Random) -> Vec<f64> {
    let waves: Vec<[f64; 3]> = (0..WAVES)
        .map(|_| {
            let (sine, cosine) = libm::sincos(TAU * random.uniform());
            let frequency = TAU * between(random, 0.7, 2.0) / WIDTH as f64;
            [frequency * cosine, frequency * sine, TAU * random.uniform()]
        })
        .collect();
    let pixels = (0..HEIGHT).flat_map(|v| (0..WIDTH).map(move |u| (u as f64, v as f64)));
    let mut warp: Vec<f64> = pixels
        .map(|(u, v)| {
            let sum: f64 = waves.iter().map(|[du, dv, phase]| libm::cos(du * u + dv * v + phase)).sum();
            1.0 + WARP / WAVES as f64 * sum
        })
        .collect();
    let over_mask = || warp.iter().zip(mask.data()).filter(|(_, m)| **m != 0).map(|(w, _)| *w);
    let mean = over_mask().sum::<f64>() / over_mask().count().max(1) as f64;
    warp.iter_mut().for_each(|w| *w /= mean);
    warp
}

/// Small discs without reading: a few on the object, more in the room.
fn punch_holes(depth: &mut [f32], mask: &Mask, random: &mut Random) {
    let on_object: Vec<usize> = (0..depth.len()).filter(|&i| mask.data()[i] != 0).collect();
    for hole in 0..16 {
        let (object, anywhere) = (random.below(on_object.len()), random.below(depth.len()));
        let radius = between(random, 1.0, 4.0);
        let centre = if hole < 4 { on_object.get(object).copied().unwrap_or(anywhere) } else { anywhere };
        disc(WIDTH, HEIGHT, centre, radius, |i| depth[i] = 0.0);
    }
}
