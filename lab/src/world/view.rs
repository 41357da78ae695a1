//! Cameras, and what they see of a world.

use super::{Placed, World};
use crate::conditions::Tier;
use crate::objects::mesh::face;
use crate::objects::print::{Print, encoded};
use crate::prelude::*;
use sim3align::geometry::surface::SurfaceMoments;

/// Smallest mean difference of sRGB-encoded colours at which a turned surface is distinguishable.
const MIN_PRINT_DIFFERENCE: f64 = 0.06;
/// Number of turns about an axis of revolution that are compared.
const ROLLS: u32 = 12;

/// A camera at its place.
#[derive(Debug, Clone, Copy)]
pub struct View {
    pub width: usize,
    pub height: usize,
    pub camera: Pinhole,
    pub camera_from_world: Similarity,
}

/// The ideal image of one object among others.
#[derive(Debug, Clone)]
pub struct Rendering {
    pub view: View,
    /// The object alone: z-depth, 0 elsewhere.
    pub object_depth: Vec<f32>,
    /// The object alone: triangle index per pixel.
    pub object_triangles: Vec<u32>,
    /// The complete scene: z-depth, 0 where it is empty.
    pub depth: Vec<f32>,
    /// The visible pixels of the object.
    pub visible: Vec<bool>,
    /// Number of pixels of the object without occluders and image border.
    pub silhouette_px: usize,
    /// Fractions of these pixels that are outside the image, and that are occluded.
    pub cut: f64,
    pub hidden: f64,
}

impl View {
    /// A camera at `eye` that looks along `forward`, turned from level by `roll` radians.
    pub fn at([width, height]: [usize; 2], camera: Pinhole, eye: DVec3, forward: DVec3, roll: f64) -> Result<Self> {
        let [eye, forward] = [eye, forward.normalize()].map(|v| Vector3::from(v.to_array()));
        let right = forward.cross(&Vector3::z()).normalize();
        let level = Matrix3::from_rows(&[right.transpose(), forward.cross(&right).transpose(), forward.transpose()]);
        let rotation = Rotation3::from_axis_angle(&Vector3::z_axis(), roll).matrix() * level;
        let camera_from_world = Similarity::from_parts(1.0, rotation, -(rotation * eye))?;
        Ok(Self { width, height, camera, camera_from_world })
    }

    /// The same camera, turned about its centre so that what was in the middle appears at a pixel.
    pub fn aimed(self, [u, v]: [f64; 2]) -> Result<Self> {
        let ray = vector3(self.camera.back_project(u, v, 1.0));
        let aside = Rotation3::rotation_between(&Vector3::z(), &ray).unwrap_or_else(Rotation3::identity);
        let Similarity { rotation, translation, .. } = self.camera_from_world;
        let camera_from_world = Similarity::from_parts(1.0, *(aside * rotation).matrix(), aside * translation)?;
        Ok(Self { camera_from_world, ..self })
    }

    /// The position of the camera in the world frame.
    pub fn eye(&self) -> DVec3 {
        DVec3::from_array(self.camera_from_world.inverse().translation.into())
    }

    /// The width relative to 640 pixels.
    pub fn resolution(&self) -> f64 {
        self.width as f64 / 640.0
    }

    /// Number of pixels.
    pub fn pixels(&self) -> usize {
        self.width * self.height
    }

    /// Column and row of a pixel.
    pub fn place(&self, i: usize) -> [usize; 2] {
        [i % self.width, i / self.width]
    }

    /// The point that pixel `i` shows at z-depth `z`, in the world frame.
    pub fn world_point(&self, world_from_camera: &Similarity, i: usize, z: f32) -> DVec3 {
        let [u, v] = self.place(i).map(|x| x as f64);
        let point = world_from_camera.apply(vector3(self.camera.back_project(u, v, f64::from(z))));
        DVec3::from_array(point.into())
    }

    /// z-depth of a mesh alone, 0 beside it, and the index of its triangle per pixel.
    pub fn render(&self, mesh: &Mesh) -> (Vec<f32>, Vec<u32>) {
        let mut rasteriser = Rasteriser::new();
        rasteriser.render(mesh, &self.camera_from_world, &self.camera, self.width, self.height);
        (rasteriser.depth().to_vec(), rasteriser.triangles().to_vec())
    }

    /// z-depth of a mesh alone, 0 beside it.
    pub fn depth_of(&self, mesh: &Mesh) -> Vec<f32> {
        self.render(mesh).0
    }

    /// The images of each object, and of all objects as one.
    pub fn see(&self, world: &World) -> (Vec<Rendering>, Rendering) {
        let mut others = vec![0.0; self.pixels()];
        world.others.iter().for_each(|mesh| put_before(&mut others, &self.depth_of(mesh)));
        let alone: Vec<_> = world.objects.iter().map(|placed| self.render(&placed.mesh)).collect();
        let mut together = vec![0.0; self.pixels()];
        alone.iter().for_each(|(object, _)| put_before(&mut together, object));
        let mut depth = self.background(world);
        put_before(&mut depth, &others);
        put_before(&mut depth, &together);
        let renderings = (0..alone.len()).map(|i| {
            let mut before = others.clone();
            alone.iter().enumerate().filter(|(k, _)| *k != i).for_each(|(_, (z, _))| put_before(&mut before, z));
            let silhouette_px = self.silhouette_px(&world.objects[i].mesh, &alone[i].0);
            self.rendering(alone[i].clone(), &before, depth.clone(), silhouette_px)
        });
        let renderings = renderings.collect();
        let silhouettes = count(&together);
        (renderings, self.rendering((together, Vec::new()), &others, depth.clone(), silhouettes))
    }

    fn rendering(
        &self,
        (object_depth, object_triangles): (Vec<f32>, Vec<u32>),
        others: &[f32],
        depth: Vec<f32>,
        silhouette_px: usize,
    ) -> Rendering {
        let share = |px: usize| px as f64 / silhouette_px.max(1) as f64;
        let visible = shown(&object_depth, others);
        let px = count(&object_depth);
        let hidden = share(px - visible.iter().filter(|visible| **visible).count());
        let cut = 1.0 - share(px);
        Rendering { view: *self, depth, visible, silhouette_px, cut, hidden, object_depth, object_triangles }
    }

    /// Number of pixels that the object would have in an unbounded image.
    fn silhouette_px(&self, mesh: &Mesh, depth: &[f32]) -> usize {
        let is_rim = |i: usize| {
            let [u, v] = self.place(i);
            u == 0 || v == 0 || u + 1 == self.width || v + 1 == self.height
        };
        if !depth.iter().enumerate().any(|(i, z)| *z > 0.0 && is_rim(i)) {
            return count(depth);
        }
        let margin = self.width / 2;
        let [cx, cy] = [self.camera.cx, self.camera.cy].map(|c| c + margin as f64);
        let [width, height] = [self.width, self.height].map(|side| side + 2 * margin);
        count(&Self { width, height, camera: Pinhole { cx, cy, ..self.camera }, ..*self }.depth_of(mesh))
    }

    /// z-depth of the table, and of the wall behind it.
    fn background(&self, world: &World) -> Vec<f32> {
        let Pinhole { fx, fy, cx, cy } = self.camera;
        let pose = &self.camera_from_world;
        // n·p = d in the world's frame, as 1/z = (n·ray)/d in the camera's.
        let inverse_depth = |normal: Vector3<f64>, distance: f64| {
            let normal = pose.rotation * normal;
            normal / (distance + normal.dot(&pose.translation))
        };
        let planes = [inverse_depth(Vector3::z(), 0.0), inverse_depth(world.wall.0, -world.wall.1)];
        let depth = |i: usize| {
            let [u, v] = self.place(i).map(|x| x as f64);
            let (x, y) = ((u - cx) / fx, (v - cy) / fy);
            let nearest = planes.iter().fold(0.0f64, |w, plane| w.max(plane.x * x + plane.y * y + plane.z));
            if nearest > 0.0 { (1.0 / nearest) as f32 } else { 0.0 }
        };
        (0..self.pixels()).map(depth).collect()
    }
}

impl Rendering {
    /// Number of pixels that show the object.
    pub fn visible_px(&self) -> usize {
        self.visible.iter().filter(|v| **v).count()
    }

    /// Visible share of the silhouette.
    pub fn visible_share(&self) -> f64 {
        self.visible_px() as f64 / self.silhouette_px.max(1) as f64
    }

    /// The pixels that show the object and their triangles.
    pub fn object_pixels(&self) -> impl Iterator<Item = (usize, usize)> {
        let all = self.object_triangles.iter().enumerate();
        all.filter(|(i, t)| self.visible[*i] && **t != NO_TRIANGLE).map(|(i, t)| (i, *t as usize))
    }

    /// Whether enough of a part shows that determines the orientation.
    pub fn shows_key(&self, placed: &Placed) -> bool {
        let object = &placed.object;
        let key_px = self.object_pixels().filter(|(_, t)| object.keys.contains(&object.parts[*t])).count();
        object.keys.is_empty() || key_px >= (self.visible_px() / 50).max(25)
    }

    /// Whether the visible part of the print distinguishes the turns of a symmetric shape.
    pub fn shows_turn(&self, placed: &Placed, print: &Print) -> bool {
        let world_from_camera = self.view.camera_from_world.inverse();
        let center = SurfaceMoments::of(&placed.mesh).centroid;
        let shown: Vec<(DVec3, DVec3)> = self
            .object_pixels()
            .step_by(7)
            .map(|(i, triangle)| {
                let point = self.view.world_point(&world_from_camera, i, self.object_depth[i]);
                (point, face(&placed.mesh, triangle).normalize_or_zero())
            })
            .collect();
        let differs = |turn: DMat3| {
            let difference = |(p, n): &(DVec3, DVec3)| {
                let other = print.at(turn * (*p - center) + center, turn * *n);
                (encoded(print.at(*p, *n)) - encoded(other)).abs().max_element()
            };
            shown.iter().map(difference).sum::<f64>() / shown.len().max(1) as f64 > MIN_PRINT_DIFFERENCE
        };
        let axis_turns = placed.symmetry.iter().flat_map(|&(axis, fold)| {
            let steps = fold.unwrap_or(ROLLS);
            (1..steps).map(move |k| DMat3::from_axis_angle(axis.normalize(), TAU * f64::from(k) / f64::from(steps)))
        });
        let turns: Vec<DMat3> = axis_turns.collect();
        let pairs = turns.iter().flat_map(|a| turns.iter().map(|b| *a * *b));
        let is_turn = |turn: &DMat3| (0.5 * (turn.col(0).x + turn.col(1).y + turn.col(2).z - 1.0)) < 0.95;
        turns.iter().copied().chain(pairs).filter(is_turn).all(differs)
    }

    /// Whether a flat object is not seen on edge, nor a long one from its end: such photos are not taken to be measured.
    pub fn shows_shape(&self, placed: &Placed, tier: Tier) -> bool {
        let moments = SurfaceMoments::of(&placed.mesh);
        let axes = moments.principal_axes();
        let [thin, middle, long] = axes.values.map(|variance| variance.max(0.0).sqrt());
        let along = (self.view.eye() - moments.centroid).normalize_or_zero();
        let across = tier.pick(0.5, 0.4, 0.3);
        let on_edge = thin < 0.35 * middle && axes.vectors[0].dot(along).abs() < across;
        let from_its_end = middle < 0.5 * long && axes.vectors[2].cross(along).length() < across;
        !on_edge && !from_its_end
    }
}

/// Pixelwise minimum of two z-depth images, where 0 is empty.
pub fn put_before(depth: &mut [f32], other: &[f32]) {
    for (z, &other) in depth.iter_mut().zip(other) {
        if other > 0.0 && (*z == 0.0 || other < *z) {
            *z = other;
        }
    }
}

/// Number of pixels above 0.
pub fn count(depth: &[f32]) -> usize {
    depth.iter().filter(|z| **z > 0.0).count()
}

/// For each pixel, whether it shows the object rather than the others.
pub fn shown(object: &[f32], others: &[f32]) -> Vec<bool> {
    object.iter().zip(others).map(|(&z, &other)| z > 0.0 && (other == 0.0 || z <= other)).collect()
}
