//! The set: how many objects each of its scenes has.

use super::COUNT_STREAM;
use super::scene::ClutteredScene;
use crate::error::{Error, ErrorCode, Result};
use crate::geometry::random::Random;

/// Of 100 scenes, how many have four objects, and how many three; the others have two. That makes 338 pairs.
const FOUR: usize = 52;
const THREE: usize = 34;

/// A set of cluttered scenes.
#[derive(Debug, Clone)]
pub struct SceneSet {
    seed: u64,
    /// Objects of each scene.
    objects: Vec<usize>,
}

impl SceneSet {
    /// The set of a seed and a number of scenes: of any number, the same shares have four, three and two objects.
    pub fn new(seed: u64, scenes: usize) -> Self {
        let share = |of_hundred: usize| (scenes.saturating_mul(of_hundred) + 50) / 100;
        let four = share(FOUR).min(scenes);
        let three = share(THREE).min(scenes - four);
        let count = |i: usize| if i < four { 4 } else { 2 + usize::from(i < four + three) };
        let mut objects: Vec<usize> = (0..scenes).map(count).collect();
        // Fisher and Yates.
        let mut random = Random::new(seed, COUNT_STREAM);
        for last in (1..scenes).rev() {
            objects.swap(last, random.below(last + 1));
        }
        Self { seed, objects }
    }

    /// How many scenes it has.
    pub fn scenes(&self) -> usize {
        self.objects.len()
    }

    /// How many pairs of an object and its generated mesh all scenes have together.
    pub fn pairs(&self) -> usize {
        self.objects.iter().sum()
    }

    /// How many pairs a scene has; 0 where there is no such scene.
    pub fn pairs_of(&self, scene: usize) -> usize {
        self.objects.get(scene).copied().unwrap_or_default()
    }

    /// The seed.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// Scene `index`.
    ///
    /// # Errors
    /// [`ErrorCode::InvalidArgument`] where there is no such scene.
    pub fn scene(&self, index: usize) -> Result<ClutteredScene> {
        let Some(&objects) = self.objects.get(index) else {
            return Err(Error::new(
                ErrorCode::InvalidArgument,
                "index",
                index.to_string(),
                format!("a number below {}", self.objects.len()),
                "Make a set of more scenes.",
            ));
        };
        ClutteredScene::draw(self.seed, index, objects)
    }
}
