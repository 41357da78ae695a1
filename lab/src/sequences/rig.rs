//! Generated views: two to eight cameras around an object.

use super::stage::Stage;
use super::{Sequence, SequenceFrame, jittered};
use crate::cases::tier::Tier;
use crate::prelude::*;
use sim3align::views::View;

/// Random stream of a rig.
const STREAM: u64 = 31;
/// Draws of a case until one shows enough.
const DRAWS: u64 = 64;
/// Fewest visible pixels of the object in a view, and the smallest visible fraction.
const MIN_PX: usize = 1500;
const MIN_VISIBLE: f64 = 0.6;
/// The diagonal of small objects and the distance from which they are seen, metres, and the fewest pixels of them.
const SMALL: f64 = 0.05;
const SMALL_DISTANCE: f64 = 0.6;
const SMALL_PX: usize = 300;
/// Errors of noisy camera poses: degrees and metres.
const NOISE: [f64; 2] = [0.5, 0.003];

/// A generated set of views.
#[derive(Debug, Clone, Copy)]
pub struct RigSet {
    /// The seed.
    pub seed: u64,
    /// Number of views; `None` draws from two to eight.
    pub views: Option<usize>,
    /// Whether only the print of the objects tells how they are turned, and the frames have photos.
    pub is_printed: bool,
    /// Whether the objects are 5 cm large, 60 cm from the cameras.
    pub is_small: bool,
}

impl RigSet {
    /// Case `index`, which depends on the set and the index alone. A third of the cases has noisy camera poses, and a sixth
    /// (of those with three views and more) one wrong view.
    ///
    /// # Errors
    /// [`ErrorCode::Internal`] in case of a bug in the generator.
    pub fn case(&self, index: usize) -> Result<Sequence> {
        first_fit("a rig", DRAWS, |draw| self.draw(index, mixed([self.seed, index as u64, draw])))
    }

    fn draw(&self, index: usize, seed: u64) -> Result<Option<Sequence>> {
        let random = &mut Random::new(seed, STREAM);
        let tier = Tier::of(index);
        let mut stage = Stage::draw(tier, self.is_printed, self.is_small.then_some(SMALL), random)?;
        if self.is_small {
            stage.distance = SMALL_DISTANCE;
        }
        let least = if self.is_small { SMALL_PX } else { MIN_PX };
        let count = self.views.unwrap_or_else(|| 2 + random.below(7));
        // Between neighbouring cameras.
        let baseline = between(random, 5.0, 180.0);
        let noisy = index % 3 == 1;
        let wrong = (index % 6 == 5 && count > 2).then(|| random.below(count));
        let first = between(random, 0.0, 360.0);
        let turn = sign(random);
        let mut scenes = Vec::new();
        for k in 0..count {
            let heading = first + turn * baseline * k as f64 + between(random, -2.0, 2.0);
            let elevation = between(random, 15.0, 55.0);
            let distance = stage.distance * between(random, 0.85, 1.2);
            let mut off = || between(random, -0.3, 0.3) * stage.object.diagonal();
            let past = Vector3::new(off(), off(), off());
            let camera = stage.look([heading, elevation, between(random, -8.0, 8.0)], distance, past)?;
            let scene = stage.shot(&camera, None);
            if scene.visible_px() < least || 1.0 - scene.hidden < MIN_VISIBLE {
                return Ok(None);
            }
            scenes.push(scene);
        }
        if !scenes.iter().any(|scene| stage.tells(scene)) {
            return Ok(None);
        }
        let made = stage.made(&scenes[0], seed, random)?;
        let mut frames = Vec::new();
        for (k, scene) in scenes.iter().enumerate() {
            let (depth, mask) = stage.readings(scene, random)?;
            let is_wrong = wrong == Some(k);
            let mut given = scene.camera_from_world.inverse();
            if noisy {
                given = jittered(&given, NOISE, random);
            }
            if is_wrong {
                // The pose of a camera that was moved since.
                given = jittered(&given, [between(random, 25.0, 90.0), 0.5 * stage.distance], random);
            }
            frames.push(SequenceFrame {
                name: format!("frame_{k:02}"),
                camera_from_mesh: Some(scene.camera_from_world.compose(&made.world_from_mesh)),
                view: View {
                    frame: Frame { depth, camera: scene.camera, mask: Some(mask), photo: stage.photo(scene, random)? },
                    world_from_camera: Some(given),
                },
                visible: 1.0 - scene.hidden,
                is_wrong,
            });
        }
        let kind = if wrong.is_some() {
            "wrong view"
        } else if noisy {
            "noisy cameras"
        } else {
            "exact cameras"
        };
        Ok(Some(Sequence {
            name: format!("{index:04}-{}-{count}x{baseline:.0}-{}", tier.as_str(), stage.object.family),
            kind: kind.into(),
            mesh: made.mesh,
            colors: made.colors,
            symmetry: made.symmetry,
            frames,
        }))
    }
}
