//! Camera and scene: an object on a table in front of a wall, with occluders and background objects.

use super::draft::{Axis, Object};
use super::solid::Solid;
use super::split;
use super::tier::{Class, Tier};
use crate::cases::distortion::random_rotation;
use crate::prelude::*;

/// Maximum number of occluders tried for the required occlusion.
const OCCLUDERS: usize = 12;

/// A camera and where it stands.
#[derive(Debug, Clone, Copy)]
pub struct View {
    /// Width, in pixels.
    pub width: usize,
    /// Height, in pixels.
    pub height: usize,
    /// Intrinsics.
    pub camera: Pinhole,
    /// World (metres, z up, the table at z = 0) to camera.
    pub camera_from_world: Similarity,
}

/// The scene as seen by an ideal camera.
#[derive(Debug, Clone)]
pub struct Scene {
    /// Width, in pixels.
    pub width: usize,
    /// Height, in pixels.
    pub height: usize,
    /// Intrinsics.
    pub camera: Pinhole,
    /// World (metres, z up, the table at z = 0) to camera.
    pub camera_from_world: Similarity,
    /// The object alone: z-depth, 0 elsewhere.
    pub object_depth: Vec<f32>,
    /// The object alone: triangle index per pixel.
    pub object_triangles: Vec<u32>,
    /// The complete scene: z-depth, 0 where it is empty.
    pub depth: Vec<f32>,
    /// Mask of the visible pixels of the object.
    pub visible: Vec<bool>,
    /// Number of pixels of the object without occluders and image border.
    pub silhouette_px: usize,
    /// Fractions of these pixels that are outside the image, and that are occluded.
    pub cut: f64,
    /// See `cut`.
    pub hidden: f64,
}

/// Places the object: returns its mesh and its symmetry axes in the world frame.
pub fn put_down(object: &Object, tier: Tier, random: &mut Random) -> Result<(Mesh, Vec<Axis>)> {
    let quarter =
        |random: &mut Random| Rotation3::from_axis_angle(&Vector3::x_axis(), 0.25 * TAU * random.below(4) as f64);
    let upright = random.uniform() < tier.pick(0.9, 0.75, 0.6);
    let (drawn, lain) = (*random_rotation(random).to_rotation_matrix().matrix(), quarter(random));
    let turn = Rotation3::from_axis_angle(&Vector3::y_axis(), 0.25 * TAU * random.below(4) as f64);
    let heading = Rotation3::from_axis_angle(&Vector3::z_axis(), TAU * random.uniform());
    let rotation = if object.any_side_up {
        *(heading * turn * lain).matrix()
    } else if upright {
        *heading.matrix()
    } else if chance(random, 0.6) {
        *(heading * lain).matrix()
    } else {
        drawn
    };
    put_down_turned(object, &rotation)
}

/// Rotates the object and places it above the origin, with its lowest point at z = 0.
pub fn put_down_turned(object: &Object, rotation: &Matrix3<f64>) -> Result<(Mesh, Vec<Axis>)> {
    let turned: Vec<_> = object.mesh.positions().iter().map(|p| rotation * vector3(*p)).collect();
    let low = turned.iter().fold(f64::INFINITY, |low, p| low.min(p.z));
    let middle = [0, 1].map(|axis| {
        let (least, most) =
            turned.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), p| (a.min(p[axis]), b.max(p[axis])));
        0.5 * (least + most)
    });
    let down = Vector3::new(middle[0], middle[1], low);
    let positions = turned.iter().map(|p| vec3(&(p - down))).collect();
    let symmetry = object.symmetry.iter().map(|&(axis, fold)| (turned_axis(rotation, axis), fold)).collect();
    Ok((Mesh::new(positions, object.mesh.triangles().to_vec())?, symmetry))
}

/// Rotates an axis.
pub fn turned_axis(rotation: &Matrix3<f64>, axis: DVec3) -> DVec3 {
    DVec3::from_array((rotation * Vector3::from(axis.to_array())).into())
}

/// Properties of a scene that are drawn before rendering.
struct Plan {
    width: usize,
    height: usize,
    camera: Pinhole,
    centre: Vector3<f64>,
    diagonal: f64,
    azimuth: f64,
    towards: Vector3<f64>,
    roll: f64,
    /// Target pixel of the centre of the object.
    aim: [f64; 2],
}

impl Scene {
    /// Draws a scene, without checking how much of the object is visible.
    pub fn draw(object: &Mesh, tier: Tier, class: Class, random: &mut Random) -> Result<Self> {
        let wide = random.uniform();
        let (width, height) = match wide {
            w if w < 0.82 => (640, 480),
            w if w < 0.94 => (1280, 720),
            _ => (1920, 1080),
        };
        let focal = between(random, 0.7, 1.3) * width as f64;
        let (cx, cy) = (0.5 * width as f64 - 0.5, 0.5 * height as f64 - 0.5);
        let off = 0.01 * width as f64;
        let camera = Pinhole::new(focal, focal, cx + between(random, -off, off), cy + between(random, -off, off))?;
        let bounds = Bounds::of(object.positions()).map(|b| (b.center(), f64::from(b.diagonal())));
        let (centre, diagonal) = bounds.map_or((Vector3::zeros(), 1.0), |(c, d)| (vector3(c), d));

        let (low, high) = tier.pick((180.0, 380.0), (130.0, 340.0), (90.0, 340.0));
        let low = if class == Class::Thin { 1.4 * low } else { low };
        let magnification = libm::pow(width as f64 / 640.0, 0.8);
        let mut span = if class == Class::Tiny { 50.0 } else { between(random, low, high) * magnification };
        let azimuth = TAU * random.uniform();
        let elevation = tier.pick((15.0, 50.0), (8.0, 65.0), (5.0, 80.0));
        let elevation = between(random, elevation.0, elevation.1).to_radians();
        let (rise, level) = libm::sincos(elevation);
        let (sine, cosine) = libm::sincos(azimuth);
        let towards = Vector3::new(cosine * level, sine * level, rise);
        let roll = between(random, -1.0, 1.0) * tier.pick(3.0f64, 8.0, 20.0).to_radians();
        let aim = aim(random, class, span, width as f64, height as f64);
        let plan = Plan { width, height, camera, centre, diagonal, azimuth, towards, roll, aim };
        if class == Class::Tiny {
            // As many pixels as wanted, from how many there are at another distance.
            let wanted = between(random, 430.0, 1400.0);
            span *= (wanted / count(&plan.view(span)?.depth_of(object)).max(1) as f64).sqrt();
        }
        let view = plan.view(span)?;
        let pose = view.camera_from_world;
        let (object_depth, object_triangles) = view.render(object);
        let inside = count(&object_depth);
        let silhouette_px = if class == Class::BorderCut {
            count(&view.enlarged((1.2 * span) as usize).depth_of(object))
        } else {
            inside
        };

        let reach = object.positions().iter().fold(0.0f32, |far, p| far.max(p.truncate().length()));
        let solid = plan.neighbours(f64::from(reach), tier, random);
        let wall = (Vector3::new(cosine, sine, 0.0), f64::from(reach) + diagonal * between(random, 0.1, 4.0));
        let mut others = rendered(&solid, &view)?;
        let wanted = match (tier, class) {
            (Tier::Medium, Class::Occluded) => Some([0.06, 0.22]),
            (Tier::Hard, Class::Occluded) => Some([0.1, 0.4]),
            (_, Class::SplitMask) => None,
            (Tier::Medium, _) if chance(random, 0.15) => Some([0.0, 0.1]),
            (Tier::Hard, _) if chance(random, 0.25) => Some([0.0, 0.15]),
            _ => None,
        };
        if wanted.is_some() || class == Class::SplitMask {
            for _ in 0..OCCLUDERS {
                let mut candidate = solid.clone();
                match wanted {
                    Some(_) => plan.occluder(&object_depth, &pose, span, random, &mut candidate),
                    None => split::bar(&object_depth, width, (&camera, &pose), random, &mut candidate),
                }
                let with = rendered(&candidate, &view)?;
                let fits = match wanted {
                    Some([least, most]) => {
                        (least..=most).contains(&(hidden(&object_depth, &with) as f64 / inside.max(1) as f64))
                    }
                    None => split::in_two(&shown(&object_depth, &with), width),
                };
                if fits {
                    others = with;
                    break;
                }
            }
        }
        let mut depth = view.background(wall);
        put_before(&mut depth, &object_depth);
        put_before(&mut depth, &others);
        Ok(view.scene((object_depth, object_triangles), &others, depth, silhouette_px))
    }

    /// The point that pixel `i` shows at z-depth `z`, in the world frame.
    pub fn world_point(&self, world_from_camera: &Similarity, i: usize, z: f32) -> Vector3<f64> {
        let (u, v) = ((i % self.width) as f64, (i / self.width) as f64);
        world_from_camera.apply(vector3(self.camera.back_project(u, v, f64::from(z))))
    }

    /// Number of pixels that show the object.
    pub fn visible_px(&self) -> usize {
        self.visible.iter().filter(|v| **v).count()
    }

    /// Number of pixels that show one of these parts.
    pub fn part_px(&self, parts: &[usize], of: &[usize]) -> usize {
        let shown =
            self.object_triangles.iter().zip(&self.visible).filter(|(t, visible)| **visible && **t != NO_TRIANGLE);
        shown.filter(|(t, _)| of.get(**t as usize).is_some_and(|part| parts.contains(part))).count()
    }
}

impl View {
    /// z-depth of a mesh alone, 0 beside it, and the index of its triangle per pixel.
    pub fn render(&self, mesh: &Mesh) -> (Vec<f32>, Vec<u32>) {
        let mut rasteriser = Rasteriser::new();
        rasteriser.render(mesh, &self.camera_from_world, &self.camera, self.width, self.height);
        (rasteriser.depth().to_vec(), rasteriser.triangles().to_vec())
    }

    /// z-depth of a mesh alone, 0 beside it.
    pub fn depth_of(&self, mesh: &Mesh) -> Vec<f32> {
        let mut rasteriser = Rasteriser::new();
        rasteriser.render_depth(mesh, &self.camera_from_world, &self.camera, self.width, self.height);
        rasteriser.depth().to_vec()
    }

    /// The same view with a number of pixels more on each side.
    pub fn enlarged(&self, margin: usize) -> Self {
        let [cx, cy] = [self.camera.cx, self.camera.cy].map(|c| c + margin as f64);
        let [width, height] = [self.width, self.height].map(|side| side + 2 * margin);
        Self { width, height, camera: Pinhole { cx, cy, ..self.camera }, ..*self }
    }

    /// z-depth of the table and of the wall behind it: what it faces, and how far it is behind the origin.
    pub fn background(&self, wall: (Vector3<f64>, f64)) -> Vec<f32> {
        let Pinhole { fx, fy, cx, cy } = self.camera;
        self.background_along(wall, |u, v| [(u - cx) / fx, (v - cy) / fy])
    }

    /// [`View::background`] along the rays (x, y, 1) of the pixels.
    pub fn background_along(&self, wall: (Vector3<f64>, f64), ray: impl Fn(f64, f64) -> [f64; 2]) -> Vec<f32> {
        let pose = &self.camera_from_world;
        // n·p = d in the world's frame, as 1/z = (n·ray)/d in the camera's.
        let inverse_depth = |normal: Vector3<f64>, distance: f64| {
            let normal = pose.rotation * normal;
            normal / (distance + normal.dot(&pose.translation))
        };
        let planes = [inverse_depth(Vector3::z(), 0.0), inverse_depth(wall.0, -wall.1)];
        let pixels = (0..self.height).flat_map(|v| (0..self.width).map(move |u| (u as f64, v as f64)));
        let depth = pixels.map(|(u, v)| {
            let [x, y] = ray(u, v);
            let nearest = planes.iter().fold(0.0f64, |w, plane| w.max(plane.x * x + plane.y * y + plane.z));
            if nearest > 0.0 { (1.0 / nearest) as f32 } else { 0.0 }
        });
        depth.collect()
    }

    /// The scene of a rendered object, before and behind others. `depth` is that of everything, and `silhouette_px` the
    /// number of pixels of the object without the image border.
    pub fn scene(
        &self,
        (object_depth, object_triangles): (Vec<f32>, Vec<u32>),
        others: &[f32],
        depth: Vec<f32>,
        silhouette_px: usize,
    ) -> Scene {
        let share = |px: usize| px as f64 / silhouette_px.max(1) as f64;
        Scene {
            width: self.width,
            height: self.height,
            camera: self.camera,
            camera_from_world: self.camera_from_world,
            depth,
            visible: shown(&object_depth, others),
            silhouette_px,
            cut: 1.0 - share(count(&object_depth)),
            hidden: share(hidden(&object_depth, others)),
            object_depth,
            object_triangles,
        }
    }
}

impl Plan {
    /// The view from the distance at which the object's box diagonal spans `span` pixels.
    fn view(&self, span: f64) -> Result<View> {
        let distance = self.camera.fx * self.diagonal / span;
        let eye = self.centre + self.towards * distance;
        let forward = -self.towards;
        let look = looking(&forward);
        let ray = vector3(self.camera.back_project(self.aim[0], self.aim[1], 1.0));
        let aside = Rotation3::rotation_between(&Vector3::z(), &ray).unwrap_or_else(Rotation3::identity);
        let roll = Rotation3::from_axis_angle(&Vector3::z_axis(), self.roll);
        let rotation = aside.matrix() * roll.matrix() * look;
        let camera_from_world = Similarity::from_parts(1.0, rotation, -(rotation * eye))?;
        Ok(View { width: self.width, height: self.height, camera: self.camera, camera_from_world })
    }

    /// Boxes, cylinders and balls next to and behind the object.
    fn neighbours(&self, reach: f64, tier: Tier, random: &mut Random) -> Solid {
        let mut solid = Solid::default();
        for _ in 0..random.below(tier.pick(2, 3, 5)) {
            let size = self.diagonal * between(random, 0.12, 0.4);
            let angle = self.azimuth + sign(random) * between(random, 75.0, 180.0).to_radians();
            let distance = reach + 1.5 * size + self.diagonal * between(random, 0.0, 0.6);
            let (sine, cosine) = libm::sincos(angle);
            let spot = DVec3::new(distance * cosine, distance * sine, 0.0);
            thing(&mut solid, spot, 0.0, size, self.diagonal * between(random, 0.2, 0.9), random);
        }
        solid
    }

    /// Something between the camera and a point of the object.
    fn occluder(&self, object: &[f32], pose: &Similarity, span: f64, random: &mut Random, solid: &mut Solid) {
        let pixels: Vec<usize> = (0..object.len()).filter(|&i| object[i] > 0.0).collect();
        let Some(&pixel) = pixels.get(random.below(pixels.len())) else { return };
        let (u, v) = ((pixel % self.width) as f64, (pixel / self.width) as f64);
        let z = f64::from(object[pixel]) * between(random, 0.6, 0.88);
        let spot = pose.inverse().apply(vector3(self.camera.back_project(u, v, z)));
        let spot = DVec3::from_array(spot.into());
        let size = between(random, 0.06, 0.24) * span * z / self.camera.fx;
        if chance(random, 0.6) && spot.z > 0.3 * size {
            thing(solid, DVec3::new(spot.x, spot.y, 0.0), 0.0, size, spot.z + between(random, 0.0, 1.0) * size, random);
        } else {
            // A hand, a branch, the arm of a robot.
            thing(solid, spot, between(random, 0.2, 1.5), size, size * between(random, 2.0, 6.0), random);
        }
    }
}

/// A thing of a half width and a height, standing on a spot or leaning about it.
fn thing(solid: &mut Solid, spot: DVec3, lean: f64, half_width: f64, height: f64, random: &mut Random) {
    let heading = DAffine3::from_rotation_z(TAU * random.uniform());
    let frame = DAffine3::from_translation(spot) * heading * DAffine3::from_rotation_x(lean);
    match random.below(3) {
        0 => solid.at(frame).cylinder([half_width, half_width * between(random, 0.6, 1.0)], height),
        1 => {
            let half = DVec3::new(half_width, half_width * between(random, 0.4, 1.0), 0.5 * height);
            solid.at(frame * DAffine3::from_translation(DVec3::Z * half.z)).cuboid(half, 0.05 * half_width);
        }
        _ => {
            let radii = DVec3::new(half_width, half_width * between(random, 0.7, 1.0), 0.5 * height);
            solid.at(frame * DAffine3::from_translation(DVec3::Z * radii.z)).ellipsoid(radii);
        }
    }
}

/// The target pixel of the centre: inside the image, or such that the border cuts the object.
fn aim(random: &mut Random, class: Class, span: f64, width: f64, height: f64) -> [f64; 2] {
    let within = |random: &mut Random, size: f64| {
        let margin = (0.5 * span + 4.0).min(0.5 * size);
        between(random, margin, size - margin)
    };
    let [u, v] = [within(random, width), within(random, height)];
    if class != Class::BorderCut {
        return [u, v];
    }
    let beside = between(random, 0.02, 0.34) * span;
    match random.below(4) {
        0 => [beside, v],
        1 => [width - beside, v],
        2 => [u, beside],
        _ => [u, height - beside],
    }
}

/// The axes of a camera that looks along `forward`, level: world to camera.
fn looking(forward: &Vector3<f64>) -> Matrix3<f64> {
    let right = forward.cross(&Vector3::z()).normalize();
    Matrix3::from_rows(&[right.transpose(), forward.cross(&right).transpose(), forward.transpose()])
}

/// Camera from world for a camera at `eye` that looks along `forward`, turned from level by `roll` radians.
pub fn camera_at(eye: &Vector3<f64>, forward: &Vector3<f64>, roll: f64) -> Result<Similarity> {
    let roll = Rotation3::from_axis_angle(&Vector3::z_axis(), roll);
    let rotation = roll.matrix() * looking(forward);
    Similarity::from_parts(1.0, rotation, -(rotation * eye))
}

fn rendered(solid: &Solid, view: &View) -> Result<Vec<f32>> {
    if solid.is_empty() {
        return Ok(vec![0.0; view.width * view.height]);
    }
    Ok(view.depth_of(&solid.clone().finish()?.0))
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

/// Whether depth `z` is in front of the other; 0 is empty.
pub fn in_front(z: f32, other: f32) -> bool {
    z > 0.0 && (other == 0.0 || z <= other)
}

/// Pixels that show the object, before and behind the others.
pub fn shown(object: &[f32], others: &[f32]) -> Vec<bool> {
    object.iter().zip(others).map(|(&z, &other)| in_front(z, other)).collect()
}

/// Number of occluded pixels of the object.
pub fn hidden(object: &[f32], others: &[f32]) -> usize {
    object.iter().zip(others).filter(|(z, other)| **z > 0.0 && !in_front(**z, **other)).count()
}
