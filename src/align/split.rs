//! An alignment whose search is done in parts, by several who each hold the whole input.

use super::field::Options;
use super::options::{AlignOptions, Preset};
use super::progress::{Host, Silent, Stopwatch};
use super::report::Alignment;
use super::{Clouds, precise};
use crate::error::Result;
use crate::geometry::mesh::Mesh;
use crate::geometry::similarity::Similarity;
use crate::stages::observe::Observation;
use crate::stages::sample::check_shape;
use crate::stages::search::Found;
use crate::stages::search::pose::CropPose;
use crate::stages::search::rounds::Rounds;
use crate::stages::search::score::Score;

/// One's share of an alignment by `precise`. All go through the same rounds: each does some of a round's tasks and is
/// told what came of all; any of them can then say what was found, to the same bits as [`align`](super::align).
pub struct Share {
    observation: Observation,
    mesh: Mesh,
    options: AlignOptions,
    rounds: Rounds,
    has_begun: bool,
}

impl Share {
    /// Prepares the search.
    ///
    /// # Errors
    /// As [`align`](super::align); which one it is, where there are several, may differ.
    pub fn new(observation: Observation, mesh: Mesh, options: AlignOptions) -> Result<Self> {
        options.validate()?;
        check_shape(&mesh)?;
        let rounds = precise::prepare(&observation, &mesh, &options, &precise::search_settings(&options))?;
        Ok(Self { observation, mesh, options, rounds, has_begun: false })
    }

    /// How many tasks the present round has; 0 when there is nothing left to do.
    pub fn tasks(&self) -> usize {
        // Only `precise` searches.
        if self.options.preset == Preset::Precise { self.rounds.tasks() } else { 0 }
    }

    /// Whether all that is left is refinement.
    pub fn is_refinement(&self) -> bool {
        self.rounds.is_refinement()
    }

    /// Does a part of the round's tasks: every `parts`-th, the first of them being `part`. Also says how many candidates
    /// come of each; one more, drawn by nobody, is what the first part adds to the first round: the pose that
    /// `quality: "best"` takes from descriptors.
    pub fn run(&mut self, part: usize, parts: usize) -> (Vec<Found>, usize) {
        let mut found = self.rounds.run(part, parts);
        let per_task = found.len() / (part..self.tasks()).step_by(parts.max(1)).len().max(1);
        if part == 0 && !core::mem::replace(&mut self.has_begun, true) {
            let pose = self.hypothesis();
            found.extend(pose.map(|pose| Found { pose, score: Score::default(), converged: false, renders: 0 }));
        }
        (found, per_task)
    }

    /// The best pose so far, and its score.
    pub fn best(&self) -> Option<(Similarity, f64)> {
        self.rounds.best()
    }

    /// Takes what came of all the round's tasks, in their order.
    pub fn advance(&mut self, mut found: Vec<Found>) {
        if let Some(hypothesis) = found.pop_if(|f| f.renders == 0) {
            self.rounds.join(hypothesis.pose);
        }
        self.rounds.advance(found);
        // Of the scores, only the totals were told.
        self.rounds.complete_scores();
    }

    /// The alignment, once no task is left.
    ///
    /// # Errors
    /// As [`align`](super::align).
    pub fn finish(self, host: &mut dyn Host) -> Result<Alignment> {
        let Self { observation, mesh, options, .. } = &self;
        let mut stages = Stopwatch::new(host, precise::PLAN);
        let clouds = Clouds::new(observation, mesh, options, &mut stages)?;
        let estimated = precise::conclude(&self.rounds, mesh, options)?;
        clouds.report(observation, mesh, options, estimated, stages)
    }

    fn hypothesis(&self) -> Option<CropPose> {
        let Self { observation, mesh, options, .. } = self;
        let mut silent = Silent;
        let mut stages = Stopwatch::new(&mut silent, precise::PLAN);
        let clouds = Clouds::new(observation, mesh, options, &mut stages).ok()?;
        let found = precise::hypothesis(&clouds.evidence, clouds.extents(), options, &mut stages);
        CropPose::of_similarity(&found?, &self.rounds.search.frame)
    }
}
