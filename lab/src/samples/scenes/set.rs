//! The set: how many objects each of its scenes has.

use super::COUNT_STREAM;
use super::scene::ClutteredScene;
use crate::samples::mixed;
use sim3align_geometry::error::{Error, ErrorCode, Result};
use sim3align_geometry::random::Random;

/// Of 100 scenes, how many have four objects, and how many three or more; the others have two. That makes 338 pairs.
const FOUR: usize = 52;
const THREE_OR_MORE: usize = 86;
/// So many scenes, each time, have them as evenly as can be, in an order of their own.
const BLOCK: usize = 10;

/// A set of cluttered scenes.
#[derive(Debug, Clone)]
pub struct SceneSet {
    seed: u64,
    /// Objects of each scene.
    objects: Vec<usize>,
}

impl SceneSet {
    /// The set of a seed and a number of scenes. A larger set begins with the scenes of a smaller one.
    pub fn new(seed: u64, scenes: usize) -> Self {
        let blocks = scenes.div_ceil(BLOCK);
        let objects = (0..blocks).flat_map(|block| objects_of_block(seed, block)).take(scenes).collect();
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

fn objects_of_block(seed: u64, block: usize) -> [usize; BLOCK] {
    let before = |block: usize, of_hundred: usize| (block * BLOCK * of_hundred + 50) / 100;
    let within = |of_hundred: usize| before(block + 1, of_hundred) - before(block, of_hundred);
    let (four, three_or_more) = (within(FOUR), within(THREE_OR_MORE));
    let mut objects = [2; BLOCK];
    objects.iter_mut().take(three_or_more).for_each(|n| *n = 3);
    objects.iter_mut().take(four).for_each(|n| *n = 4);
    // Fisher and Yates.
    let mut random = Random::new(mixed([seed, block as u64]), COUNT_STREAM);
    for last in (1..BLOCK).rev() {
        objects.swap(last, random.below(last + 1));
    }
    objects
}
