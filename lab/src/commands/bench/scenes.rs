//! Pairs of cluttered scenes, generated when their turn comes.

use std::sync::{Arc, Mutex, PoisonError};

use sim3align_geometry::error::Result;
use sim3align_lab::samples::benchmark::BenchCase;
use sim3align_lab::samples::scenes::{ClutteredScene, Prior, SceneSet};

use super::run::Source;

/// A set, and the scene that was asked for last: its pairs follow each other.
pub struct Scenes {
    set: SceneSet,
    last: Mutex<Option<Arc<ClutteredScene>>>,
}

impl Scenes {
    pub fn new(set: SceneSet) -> Self {
        Self { set, last: Mutex::new(None) }
    }

    /// All pairs, scene by scene.
    pub fn sources(&self, priors: &[Prior]) -> Vec<Source> {
        let mut sources = Vec::new();
        for scene in 0..self.set.scenes() {
            for pair in 0..self.set.pairs_of(scene) {
                sources.extend(priors.iter().map(|&prior| Source::Scene { scene, pair, prior }));
            }
        }
        sources
    }

    pub fn case(&self, scene: usize, pair: usize, prior: Prior) -> Result<BenchCase> {
        self.scene(scene)?.pairs[pair].case(prior).map(BenchCase::from)
    }

    /// Drawn by one thread while others wait for it: they want the same one.
    fn scene(&self, index: usize) -> Result<Arc<ClutteredScene>> {
        let mut last = self.last.lock().unwrap_or_else(PoisonError::into_inner);
        match last.as_ref().filter(|scene| scene.index == index) {
            Some(scene) => Ok(scene.clone()),
            None => Ok(last.insert(Arc::new(self.set.scene(index)?)).clone()),
        }
    }
}
