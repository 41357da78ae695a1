//! A generated photo scene for the page: a teapot, a mug and a carton on a table, with a photo, a depth map, masks, and the
//! coloured meshes that a generator would make of them.

mod light;
mod paint;
mod surface;

use serde_json::json;

use self::light::Light;
use self::paint::Paint;
use self::surface::Surface;
use crate::case_folder::contents::{mask_file, truth_file, view_files};
use crate::case_folder::write::{glb_colored, rgb_png};
use crate::cases::distortion::{corners_of, hallucinate, mapped};
use crate::cases::families::draw_from;
use crate::cases::photo::resized;
use crate::cases::scene::{View, camera_at, put_before, put_down_turned};
use crate::files::write;
use crate::prelude::*;
use crate::scenes::DEPTH_SCALE;

const WIDTH: usize = 640;
const HEIGHT: usize = 480;
/// Rays per pixel and direction of the photo.
const RAYS: usize = 2;
/// Triangles are split until no edge is longer: the colours of vertices then show the print.
const MAX_EDGE_M: f32 = 0.008;
/// The same, for edges of generated meshes at which the paint changes.
const MAX_PAINT_EDGE_M: f32 = 0.002;
/// Where the wall is, behind the origin.
const WALL_M: f64 = 0.42;
/// Half the range of the noise of the depth map, as a share of depth.
const NOISE: f64 = 0.0006;
const SHAPE_STREAM: u64 = 0x7461_626c;
const NOISE_STREAM: u64 = 0x6e6f_6973;

/// An object of the scene: its family, its paint, its place on the table in metres, and its heading in degrees.
struct Place(&'static str, Paint, [f64; 2], f64);

const PLACES: [Place; 3] = [
    Place("teapot", Paint::Glazed, [-0.075, 0.035], 205.0),
    Place("mug", Paint::Striped, [0.105, -0.06], 35.0),
    Place("box", Paint::Carton, [0.125, 0.1], -24.0),
];

/// An object at its place.
struct Placed {
    family: &'static str,
    paint: Paint,
    /// In the world frame: metres, z up, the table at z = 0.
    surface: Surface,
    world_from_object: Similarity,
}

/// The scene.
pub struct TableScene {
    seed: u64,
    view: View,
    objects: Vec<Placed>,
}

impl TableScene {
    /// The scene of a seed, which varies the shapes; the same seed gives the same bits.
    ///
    /// # Errors
    /// Only in case of a bug in the generator.
    pub fn new(seed: u64) -> Result<Self> {
        let mut objects = Vec::new();
        for (index, Place(family, paint, at, heading)) in PLACES.into_iter().enumerate() {
            let random = &mut Random::new(mixed([seed, index as u64]), SHAPE_STREAM);
            let object = draw_from(family, random)?;
            let (mesh, _) = put_down_turned(&object, &Matrix3::identity())?;
            let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), f64::to_radians(heading)).into_inner();
            let world_from_object = Similarity::from_parts(1.0, turn, Vector3::new(at[0], at[1], 0.0))?;
            let corners = mesh.positions().iter().map(|&p| [p]).collect();
            let is_long = |[p]: &[Vec3; 1], [q]: &[Vec3; 1]| p.distance(*q) > MAX_EDGE_M;
            let (corners, triangles) = surface::split(corners, mesh.triangles().to_vec(), is_long);
            let mesh = Mesh::new(corners.into_iter().flatten().collect(), triangles)?;
            let surface = Surface::new(&mesh, &world_from_object)?;
            objects.push(Placed { family, paint, surface, world_from_object });
        }
        let eye = Vector3::new(-0.05, -0.62, 0.36);
        let forward = (Vector3::new(0.02, 0.02, 0.06) - eye).normalize();
        let camera = Pinhole::new(700.0, 700.0, 0.5 * WIDTH as f64 - 0.5, 0.5 * HEIGHT as f64 - 0.5)?;
        let view = View { width: WIDTH, height: HEIGHT, camera, camera_from_world: camera_at(&eye, &forward, 0.0)? };
        Ok(Self { seed, view, objects })
    }

    /// The photo, 8-bit sRGB.
    fn photo(&self) -> Result<Vec<[u8; 3]>> {
        let (width, height) = (RAYS * WIDTH, RAYS * HEIGHT);
        let camera = resized(&self.view.camera, RAYS as f64);
        let view = View { width, height, camera, ..self.view };
        let light = Light::new(self.objects.iter().map(|object| object.surface.mesh()))?;
        let world_from_camera = view.camera_from_world.inverse();
        let mut nearest = view.background((-Vector3::y(), WALL_M));
        let mut hit: Vec<Option<(usize, u32)>> = vec![None; width * height];
        for (index, object) in self.objects.iter().enumerate() {
            let (depth, triangles) = view.render(object.surface.mesh());
            for (i, (z, triangle)) in depth.into_iter().zip(triangles).enumerate() {
                if z > 0.0 && (nearest[i] == 0.0 || z < nearest[i]) {
                    (nearest[i], hit[i]) = (z, Some((index, triangle)));
                }
            }
        }
        let eye = world_from_camera.translation;
        let shade = |i: usize| {
            let (u, v) = ((i % width) as f64, (i / width) as f64);
            let z = f64::from(nearest[i]);
            let seen = Vector3::new((u - camera.cx) / camera.fx * z, (v - camera.cy) / camera.fy * z, z);
            let point = world_from_camera.apply(seen);
            let (albedo, normal, gloss) = match hit[i] {
                Some((index, triangle)) => {
                    let object = &self.objects[index];
                    let (place, normal) = object.surface.at(triangle, &point);
                    (object.paint.at(&place, &object.surface.size()), normal, object.paint.gloss())
                }
                None if point.z < 0.002 => (paint::table(&point), Vector3::z(), 0.06),
                None => (paint::wall(&point), -Vector3::y(), 0.0),
            };
            light.shade(albedo, gloss, &point, &normal, &(eye - point).normalize())
        };
        let mean = |u: usize, v: usize| {
            let rays = (0..RAYS * RAYS).map(|k| (RAYS * v + k / RAYS) * width + RAYS * u + k % RAYS);
            rays.map(shade).sum::<Vector3<f64>>() / (RAYS * RAYS) as f64
        };
        let pixels = (0..WIDTH * HEIGHT).map(|i| light::encoded(mean(i % WIDTH, i / WIDTH)));
        Ok(pixels.collect())
    }

    /// The files of the scene: `depth.png`, `camera.json` and `rgb.png`, and `objects/NAME/` with `mask.png`, `mesh.glb` and
    /// `gt.json`; paths and contents.
    ///
    /// # Errors
    /// Only in case of a bug in the generator.
    pub fn files(&self) -> Result<Vec<(String, Vec<u8>)>> {
        let alone: Vec<_> = self.objects.iter().map(|object| self.view.render(object.surface.mesh())).collect();
        let mut depth = self.view.background((-Vector3::y(), WALL_M));
        alone.iter().for_each(|(object, _)| put_before(&mut depth, object));
        let is_seen = |k: usize, i: usize| alone[k].0[i] > 0.0 && alone[k].0[i] <= depth[i];
        let random = &mut Random::new(self.seed, NOISE_STREAM);
        let noisy = depth.iter().map(|z| z * (1.0 + NOISE * (random.uniform() + random.uniform() - 1.0)) as f32);
        let readings = DepthMap::from_metres(WIDTH, HEIGHT, noisy.collect())?;
        let mut files = vec![("rgb.png".to_owned(), rgb_png(&self.photo()?, WIDTH, HEIGHT)?)];
        let files_of_view = view_files(&readings, self.view.camera, Some(DEPTH_SCALE))?;
        files.extend(files_of_view.map(|(name, bytes)| (name.to_owned(), bytes)));
        for (k, object) in self.objects.iter().enumerate() {
            let mask = (0..WIDTH * HEIGHT).map(|i| u8::from(is_seen(k, i))).collect();
            let mask = Mask::new("mask", WIDTH, HEIGHT, mask)?;
            let (mesh, colors, world_from_mesh) = self.generated(k, &alone[k].1, |i| is_seen(k, i))?;
            let note = format!("generated: {} on a table, seed {}", object.family, self.seed);
            let truth = json!({ "symmetry": "none", "note": note });
            let pose = self.view.camera_from_world.compose(&world_from_mesh);
            let own = [mask_file(&mask)?, ("mesh.glb", glb_colored(&mesh, &colors)), truth_file(&pose, truth)];
            files.extend(own.map(|(name, bytes)| (format!("objects/{}/{name}", object.family), bytes)));
        }
        Ok(files)
    }

    /// What a generator makes of an object: its mesh in a frame of its own, the linear colours of its vertices, and its
    /// true pose in the world.
    fn generated(
        &self,
        k: usize,
        triangles: &[u32],
        is_seen: impl Fn(usize) -> bool,
    ) -> Result<(Mesh, Vec<[u8; 3]>, Similarity)> {
        let Placed { paint, surface, world_from_object, .. } = &self.objects[k];
        let seen = triangles.iter().enumerate().filter(|(i, _)| is_seen(*i));
        let seen = corners_of(surface.mesh(), seen.map(|(_, &triangle)| triangle));
        let object = surface.in_object()?;
        let invented = hallucinate(&object, &seen, 0.012, mixed([self.seed, k as u64]))?;
        // Where the paint changes, small triangles make for smooth edges.
        let size = surface.size();
        let is_long = |from: &[Vec3; 2], to: &[Vec3; 2]| {
            let [p, q] = [from[0], to[0]].map(vector3);
            let [first, middle, last] = [p, 0.5 * (p + q), q].map(|place| paint.at(&place, &size));
            from[0].distance(to[0]) > MAX_PAINT_EDGE_M && (first != middle || middle != last)
        };
        let pairs = object.positions().iter().zip(invented.positions()).map(|(&own, &other)| [own, other]).collect();
        let (pairs, triangles) = surface::split(pairs, object.triangles().to_vec(), is_long);
        let [object, invented] = [0, 1].map(|k| pairs.iter().map(|pair| pair[k]).collect());
        let [object, invented] = [Mesh::new(object, triangles.clone())?, Mesh::new(invented, triangles)?];
        let (mesh, object_from_mesh) = upright(&invented)?;
        let colors = paint.of_vertices(&object, &size).into_iter().map(light::bytes).collect();
        Ok((mesh, colors, world_from_object.compose(&object_from_mesh)))
    }

    /// Writes the files to a folder.
    ///
    /// # Errors
    /// [`ErrorCode::InvalidArgument`] if a file cannot be written, and those of [`TableScene::files`].
    pub fn write(&self, folder: &Path) -> Result<()> {
        for (path, bytes) in self.files()? {
            write(&folder.join(path), &bytes)?;
        }
        Ok(())
    }
}

/// The mesh as most generators deliver it, centred, its box's longest side 1, with y up; and the way back,
/// `object_from_mesh`.
fn upright(mesh: &Mesh) -> Result<(Mesh, Similarity)> {
    let low = mesh.positions().iter().copied().fold(Vec3::INFINITY, Vec3::min);
    let high = mesh.positions().iter().copied().fold(Vec3::NEG_INFINITY, Vec3::max);
    let scale = f64::from((high - low).max_element());
    let turn = Matrix3::new(1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0);
    let object_from_mesh = Similarity::from_parts(scale, turn, vector3(0.5 * (low + high)))?;
    let back = object_from_mesh.inverse();
    Ok((mapped(mesh, |p| vec3(&back.apply(vector3(*p))))?, object_from_mesh))
}
