//! An object on a table that cameras look at from all sides.

use std::sync::Arc;

use crate::cases::case::declared;
use crate::cases::distortion::{canonicalise, mapped};
use crate::cases::draft::{Axis, Object};
use crate::cases::families;
use crate::cases::generator::generate;
use crate::cases::mask::Segmented;
use crate::cases::photo::take;
use crate::cases::print::{Print, PrintKind};
use crate::cases::readings::Readings;
use crate::cases::scene::{Scene, View, camera_at, count, put_before, put_down};
use crate::cases::solid::Solid;
use crate::cases::texture::paint;
use crate::cases::tier::{Class, OutlineErrors, Tier};
use crate::prelude::*;

/// Image size of all frames.
pub const SIZE: [usize; 2] = [640, 480];
/// Distance of the wall: too far for a reading.
const WALL_M: f64 = 50.0;

/// The scene without cameras. The world is in metres, z up, and the table is at z = 0.
pub struct Stage {
    /// The object.
    pub object: Object,
    placed: Mesh,
    symmetry: Vec<Axis>,
    neighbours: Option<Mesh>,
    print: Option<Print>,
    /// The intrinsics of all frames.
    pub camera: Pinhole,
    /// Centre of the object, and the distance at which it spans 150 to 280 pixels.
    pub center: Vector3<f64>,
    /// See `center`.
    pub distance: f64,
    tier: Tier,
}

/// The object as a generator makes it.
pub struct Made {
    /// The mesh.
    pub mesh: Mesh,
    /// Its true pose.
    pub world_from_mesh: Similarity,
    /// Its symmetry.
    pub symmetry: Symmetry,
    /// Its colours, if the object has some.
    pub colors: Option<SurfaceColors>,
}

impl Stage {
    /// A stage with an object of any family that fits on a desk; `is_printed`: with one whose shape does not tell how it is
    /// turned, but for its print. `diagonal_m`: the size that it is brought to.
    pub fn draw(tier: Tier, is_printed: bool, diagonal_m: Option<f64>, random: &mut Random) -> Result<Self> {
        let mut object = if is_printed { families::draw_symmetric(random)? } else { families::draw_for_desk(random)? };
        if let Some(diagonal) = diagonal_m {
            let factor = (diagonal / object.diagonal()) as f32;
            object.mesh = mapped(&object.mesh, |p| *p * factor)?;
        }
        let (placed, symmetry) = put_down(&object, tier, random)?;
        let print = is_printed.then(|| Print::draw(&placed, &symmetry, PrintKind::Label, random));
        let (width, height) = (SIZE[0] as f64, SIZE[1] as f64);
        let focal = between(random, 0.8, 1.1) * width;
        let camera = Pinhole::new(focal, focal, 0.5 * width - 0.5, 0.5 * height - 0.5)?;
        let diagonal = object.diagonal();
        let center = Bounds::of(placed.positions()).map_or_else(Vector3::zeros, |b| vector3(b.center()));
        let distance = focal * diagonal / between(random, 150.0, 280.0);
        let mut solid = Solid::default();
        for _ in 0..random.below(3) {
            let heading = TAU * random.uniform();
            let far = diagonal * between(random, 1.1, 2.0);
            let half = diagonal * between(random, 0.1, 0.3);
            let spot = DVec3::new(far * libm::cos(heading), far * libm::sin(heading), half);
            solid.at(DAffine3::from_translation(spot)).cuboid(DVec3::splat(half), 0.05 * half);
        }
        let neighbours = if solid.is_empty() { None } else { Some(solid.finish()?.0) };
        Ok(Self { object, placed, symmetry, neighbours, print, camera, center, distance, tier })
    }

    /// Camera from world for a camera at this heading and elevation, degrees, and this distance, that looks past the
    /// centre by an offset.
    pub fn look(&self, [heading, elevation, roll]: [f64; 3], distance: f64, past: Vector3<f64>) -> Result<Similarity> {
        let (rise, level) = libm::sincos(elevation.to_radians());
        let (sine, cosine) = libm::sincos(heading.to_radians());
        let towards = Vector3::new(cosine * level, sine * level, rise);
        let eye = self.center + towards * distance;
        let forward = (self.center + past - eye).normalize();
        camera_at(&eye, &forward, roll.to_radians())
    }

    /// The scene as a camera sees it, with something in front.
    pub fn shot(&self, camera_from_world: &Similarity, occluder: Option<&Mesh>) -> Scene {
        let [width, height] = SIZE;
        let view = View { width, height, camera: self.camera, camera_from_world: *camera_from_world };
        let object = view.render(&self.placed);
        let mut others = vec![0.0; width * height];
        for mesh in self.neighbours.iter().chain(occluder) {
            put_before(&mut others, &view.depth_of(mesh));
        }
        let mut depth = view.background((Vector3::x(), WALL_M));
        put_before(&mut depth, &object.0);
        put_before(&mut depth, &others);
        let silhouette_px = count(&object.0);
        view.scene(object, &others, depth, silhouette_px)
    }

    /// The mesh that a generator makes of the object as one camera sees it.
    pub fn made(&self, scene: &Scene, seed: u64, random: &mut Random) -> Result<Made> {
        let cell = (self.tier, Class::Plain);
        let generated = generate(&self.object, &self.placed, &self.symmetry, scene, cell, random)?;
        let (mut mesh, world_from_mesh) = canonicalise(&generated.mesh, seed)?;
        let (mut colors, mut symmetry) = (None, declared(&generated.symmetry, &world_from_mesh));
        if let Some(print) = &self.print {
            let eye = DVec3::from_array(scene.camera_from_world.inverse().translation.into());
            let cell = (self.tier, Class::Printed);
            let painted = paint(&mesh, &world_from_mesh, (print, &self.placed), eye, cell, random)?.mesh;
            (mesh, colors) = (painted.mesh, painted.colors);
            symmetry = Symmetry::None;
        }
        Ok(Made { mesh, world_from_mesh, symmetry, colors })
    }

    /// Whether the print shows in a scene which of the turns that the shape allows is right.
    pub fn tells(&self, scene: &Scene) -> bool {
        self.print.as_ref().is_none_or(|print| print.tells(&self.placed, &self.symmetry, scene))
    }

    /// The photo of a scene, if the object has a print.
    pub fn photo(&self, scene: &Scene, random: &mut Random) -> Result<Option<Arc<Photo>>> {
        let Some(print) = &self.print else { return Ok(None) };
        take(scene, (&self.placed, print), Class::Printed, self.tier, random).map(|taken| Some(Arc::new(taken.photo)))
    }

    /// Depth of a sensor and the mask of a segmentation model.
    pub fn readings(&self, scene: &Scene, random: &mut Random) -> Result<(DepthMap, Mask)> {
        let cell = (self.tier, Class::SparseSensor);
        let readings = Readings::draw(scene, self.object.diagonal(), cell, random, None)?;
        if scene.visible_px() == 0 {
            return Ok((readings.depth, Mask::filled(scene.width, scene.height, 0)));
        }
        let mask = Segmented::draw(scene, (self.tier, Class::Plain), OutlineErrors::Uniform, random)?.mask;
        Ok((readings.depth, mask))
    }
}
