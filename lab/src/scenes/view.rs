//! The camera, and what it sees of every object.

use super::layout::Layout;
use crate::cases::scene::{Scene, View, camera_at, count, in_front, put_before};
use crate::prelude::*;

/// Pixels in a row, and rows.
pub const WIDTH: usize = 640;
/// See [`WIDTH`].
pub const HEIGHT: usize = 480;
/// How far away, metres, the middle of the objects is.
const DISTANCE_M: [f64; 2] = [0.5, 1.6];
/// How much larger the image is made, on each side, to measure what its border cuts off.
const MARGIN_PX: usize = 320;

/// A camera at a desk.
#[derive(Debug)]
pub struct DeskView {
    view: View,
    /// Where the wall is: what it faces, and how far behind the origin it is.
    wall: (Vector3<f64>, f64),
}

/// What a camera sees.
#[derive(Debug)]
pub struct Seen {
    /// Each object for itself, before and behind the rest.
    pub objects: Vec<Scene>,
    /// All objects taken for one.
    pub together: Scene,
}

impl DeskView {
    /// A camera at a desk, that has the objects about in the middle of its picture, or so near that the border may cut
    /// them.
    pub fn draw(layout: &Layout, too_near: bool, random: &mut Random) -> Result<Self> {
        let fov = between(random, 38.0, 60.0);
        let mut camera = Pinhole::from_vertical_fov(fov, WIDTH, HEIGHT)?;
        camera.cx += between(random, -6.0, 6.0);
        camera.cy += between(random, -6.0, 6.0);
        // The share of the picture's height that the objects would take, were they a ball.
        let fill = between(random, 0.6, 1.15) * if too_near { 1.4 } else { 1.0 };
        let distance = 2.0 * layout.reach * camera.fy / (fill * HEIGHT as f64);
        let distance = distance.clamp(DISTANCE_M[0], DISTANCE_M[1]);
        let (rise, level) = libm::sincos(between(random, 9.0, 42.0).to_radians());
        let (sine, cosine) = libm::sincos(layout.front + between(random, -0.5, 0.5));
        let towards = Vector3::new(cosine * level, sine * level, rise);
        let mut aside = || between(random, -0.12, 0.12) * layout.reach;
        let target = vector3(layout.centre) + Vector3::new(aside(), aside(), aside());
        let eye = vector3(layout.centre) + towards * distance;
        let forward = (target - eye).normalize();
        let camera_from_world = camera_at(&eye, &forward, between(random, -4.0, 4.0).to_radians())?;
        let (sine, cosine) = libm::sincos(layout.front);
        let faces = Vector3::new(cosine, sine, 0.0);
        let wall = (faces, layout.wall - faces.dot(&vector3(layout.centre)));
        Ok(Self { view: View { width: WIDTH, height: HEIGHT, camera, camera_from_world }, wall })
    }

    /// What it sees.
    pub fn see(&self, layout: &Layout) -> Seen {
        let Self { view, wall } = self;
        let clutter = view.depth_of(&layout.clutter);
        let alone: Vec<_> = layout.objects.iter().map(|placed| view.render(&placed.mesh)).collect();
        let mut depth = layout.table.map_or_else(
            || vec![0.0; WIDTH * HEIGHT],
            |height| {
                let raised = Similarity { translation: Vector3::new(0.0, 0.0, height), ..Similarity::identity() };
                let camera_from_world = view.camera_from_world.compose(&raised);
                View { camera_from_world, ..*view }.background(*wall)
            },
        );
        put_before(&mut depth, &clutter);
        let mut together = vec![0.0; WIDTH * HEIGHT];
        for (object, _) in &alone {
            put_before(&mut depth, object);
            put_before(&mut together, object);
        }
        if layout.table.is_some_and(|height| height > 0.0) {
            // The table that the depth map shows too high does not hide what stands on it.
            for ((depth, clutter), object) in depth.iter_mut().zip(&clutter).zip(&together) {
                if in_front(*object, *clutter) {
                    *depth = *object;
                }
            }
        }
        let objects = (0..alone.len())
            .map(|i| {
                let mut others = clutter.clone();
                alone.iter().enumerate().filter(|(k, _)| *k != i).for_each(|(_, (z, _))| put_before(&mut others, z));
                let silhouette_px = self.silhouette_px(&layout.objects[i].mesh, &alone[i].0);
                view.scene(alone[i].clone(), &others, depth.clone(), silhouette_px)
            })
            .collect();
        let silhouettes = count(&together);
        Seen { objects, together: view.scene((together, Vec::new()), &clutter, depth, silhouettes) }
    }

    /// Pixels of an object, were the image larger.
    fn silhouette_px(&self, mesh: &Mesh, depth: &[f32]) -> usize {
        let is_rim = |i: usize| {
            let (u, v) = (i % WIDTH, i / WIDTH);
            u == 0 || v == 0 || u + 1 == WIDTH || v + 1 == HEIGHT
        };
        if !depth.iter().enumerate().any(|(i, z)| *z > 0.0 && is_rim(i)) {
            return count(depth);
        }
        count(&self.view.enlarged(MARGIN_PX).depth_of(mesh))
    }
}
