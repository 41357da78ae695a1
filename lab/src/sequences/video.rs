//! Generated videos: a camera that moves around an object on a table.

use super::stage::{SIZE, Stage};
use super::{Sequence, SequenceFrame};
use crate::cases::readings::disc;
use crate::cases::solid::Solid;
use crate::cases::tier::Tier;
use crate::prelude::*;
use sim3align::views::View;

/// Random stream of a video.
const STREAM: u64 = 32;
/// Draws of a video until its first frame shows enough.
const DRAWS: u64 = 64;
const MIN_PX: usize = 2500;

named! {
    /// Kinds of video.
    pub enum Motion: "motion" {
        /// A camera in a hand, which moves to and fro.
        HandHeld = "hand-held",
        /// An object on a turntable.
        Turntable = "turntable",
        /// Hand-held, with things that pass between camera and object.
        Occluders = "occluders",
        /// Hand-held, with the object leaving the image and coming back.
        Leaving = "leaving",
        /// Hand-held and fast: frames in which most of the depth is missing.
        Blur = "motion blur",
        /// Hand-held, with frames dropped.
        Dropped = "dropped frames",
    }
}

/// A generated set of videos at 30 frames a second.
#[derive(Debug, Clone, Copy)]
pub struct VideoSet {
    /// The seed.
    pub seed: u64,
    /// Number of frames of each.
    pub frames: usize,
    /// Whether only the print of the objects tells how they are turned, and the frames have photos.
    pub is_printed: bool,
}

/// A smooth path: a sum of three waves per coordinate, from −1 to 1.
struct Path([[f64; 2]; 3]);

impl Path {
    fn draw(random: &mut Random, seconds: [f64; 2]) -> Self {
        Self([0; 3].map(|_| [1.0 / between(random, seconds[0], seconds[1]), TAU * random.uniform()]))
    }

    fn at(&self, time: f64) -> f64 {
        self.0.iter().map(|[frequency, phase]| libm::sin(TAU * frequency * time + phase)).sum::<f64>() / 3.0
    }
}

impl VideoSet {
    /// Video `index`, whose kind is `index` modulo their number.
    ///
    /// # Errors
    /// [`ErrorCode::Internal`] in case of a bug in the generator.
    pub fn video(&self, index: usize) -> Result<Sequence> {
        first_fit("a video", DRAWS, |draw| self.draw(index, mixed([self.seed, index as u64, draw])))
    }

    fn draw(&self, index: usize, seed: u64) -> Result<Option<Sequence>> {
        let random = &mut Random::new(seed, STREAM);
        let motion = Motion::ALL[index % Motion::ALL.len()];
        let tier = if (index / Motion::ALL.len()).is_multiple_of(2) { Tier::Easy } else { Tier::Medium };
        let stage = Stage::draw(tier, self.is_printed, None, random)?;
        let diagonal = stage.object.diagonal();
        let (heading, elevation) = (between(random, 0.0, 360.0), between(random, 25.0, 45.0));
        let turn = sign(random) * between(random, 20.0, 60.0);
        let seconds = if motion == Motion::Blur { [1.0, 2.5] } else { [2.0, 6.0] };
        let paths: Vec<Path> = (0..7).map(|_| Path::draw(random, seconds)).collect();
        let drift = between(random, -20.0, 20.0);
        let mut frames = Vec::new();
        let mut made = None;
        let mut first = (0, 1.0);
        let mut time = 0.0;
        for k in 0..self.frames {
            time += 1.0 / 30.0;
            if motion == Motion::Dropped && k > 0 && chance(random, 0.15) {
                time += (1 + random.below(3)) as f64 / 30.0;
            }
            let hand = |path: usize, by: f64| by * paths[path].at(time);
            let (angles, distance, past) = if motion == Motion::Turntable {
                ([heading + turn * time, elevation, 0.0], stage.distance, Vector3::zeros())
            } else {
                let angles = [heading + drift * time + hand(0, 25.0), elevation + hand(1, 14.0), hand(2, 8.0)];
                let past = Vector3::new(hand(3, 0.2), hand(4, 0.2), hand(5, 0.15)) * diagonal;
                (angles, stage.distance * (1.0 + hand(6, 0.15)), past)
            };
            // Out of the image and back within two seconds of every four.
            let cycle = time % 4.0;
            let away =
                if motion == Motion::Leaving && cycle > 2.0 { libm::sin(0.5 * TAU * (cycle - 2.0) / 2.0) } else { 0.0 };
            let past = past + Vector3::z() * (away * 0.9 * stage.distance);
            let camera = stage.look(angles, distance, past)?;
            let occluder = if motion == Motion::Occluders { passing(&stage, &camera, time)? } else { None };
            let scene = stage.shot(&camera, occluder.as_ref());
            if k == 0 {
                if scene.visible_px() < MIN_PX || scene.hidden > 0.1 || !stage.tells(&scene) {
                    return Ok(None);
                }
                made = Some(stage.made(&scene, seed, random)?);
                first = (scene.visible_px(), distance);
            }
            let Some(made) = &made else { return Ok(None) };
            let (mut depth, mask) = stage.readings(&scene, random)?;
            if motion == Motion::Blur && k > 0 && chance(random, 0.2) {
                let radius = 0.12 * stage.camera.fx * diagonal / stage.distance;
                for _ in 0..30 {
                    let at = random.below(SIZE[0] * SIZE[1]);
                    disc(SIZE[0], SIZE[1], at, radius * between(random, 0.5, 3.0), |i| depth.data_mut()[i] = 0.0);
                }
            }
            // Compared with the first frame, at the same distance.
            let near = (distance / first.1).powi(2);
            let shown = scene.visible_px() as f64 * near / first.0.max(1) as f64;
            frames.push(SequenceFrame {
                name: format!("frame_{k:04}"),
                view: View {
                    frame: Frame { depth, camera: scene.camera, mask: Some(mask), photo: stage.photo(&scene, random)? },
                    world_from_camera: Some(camera.inverse()),
                },
                camera_from_mesh: Some(camera.compose(&made.world_from_mesh)),
                visible: (1.0 - scene.hidden).min(shown),
                is_wrong: false,
            });
        }
        Ok(made.map(|made| Sequence {
            name: format!("{index:04}-{}-{}", motion.as_str(), stage.object.family),
            kind: motion.as_str().into(),
            mesh: made.mesh,
            colors: made.colors,
            symmetry: made.symmetry,
            frames,
        }))
    }
}

/// Something that passes between camera and object, for a second of every three.
fn passing(stage: &Stage, camera: &Similarity, time: f64) -> Result<Option<Mesh>> {
    let cycle = time % 3.0 - 1.5;
    if cycle.abs() > 0.5 {
        return Ok(None);
    }
    let diagonal = stage.object.diagonal();
    let center = camera.apply(stage.center);
    let place = Vector3::new(center.x * 0.7 + 2.4 * cycle * diagonal, center.y * 0.7, 0.7 * center.z);
    let spot = DVec3::from_array(camera.inverse().apply(place).into());
    let mut solid = Solid::default();
    let half = DVec3::new(0.16, 0.16, 0.6) * diagonal;
    solid.at(DAffine3::from_translation(spot)).cuboid(half, 0.02 * diagonal);
    Ok(Some(solid.finish()?.0))
}
