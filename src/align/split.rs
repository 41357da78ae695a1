//! An alignment whose search is done in parts, by several who each hold the whole input.

use core::ops::Range;

use super::field::Options;
use super::options::{AlignOptions, Preset};
use super::progress::{Host, Silent};
use super::report::Alignment;
use super::{align_by, precise};
use crate::error::{Error, ErrorCode, Result};
use crate::geometry::mesh::Mesh;
use crate::stages::observe::Observation;
use crate::stages::sample::check_shape;
use crate::stages::search::Found;
use crate::stages::search::pose::CropPose;
use crate::stages::search::rounds::Rounds;

/// One's share of an alignment by `precise`. All go through the same rounds: each does some of a round's tasks and is
/// told what came of all; any of them can then say what was found, to the same bits as [`align`](super::align).
pub struct Share {
    observation: Observation,
    mesh: Mesh,
    options: AlignOptions,
    rounds: Rounds,
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
        Ok(Self { observation, mesh, options, rounds })
    }

    /// How many tasks the present round has; 0 when there is nothing left to do.
    pub fn tasks(&self) -> usize {
        // Only `precise` searches.
        if self.options.preset == Preset::Precise { self.rounds.tasks() } else { 0 }
    }

    /// Does some of the round's tasks.
    pub fn run(&self, tasks: Range<usize>) -> Vec<Found> {
        self.rounds.run(tasks)
    }

    /// Takes what came of all the round's tasks, in their order.
    pub fn advance(&mut self, found: Vec<Found>) {
        self.rounds.advance(found);
    }

    /// The pose that `quality: "best"` takes from descriptors: work for one, before the first round is over.
    pub fn hypothesis(&self) -> Option<CropPose> {
        let mut found = None;
        let Self { observation, mesh, options, .. } = self;
        // Nothing but the evidence is wanted of the pipeline.
        let _ = align_by(observation, mesh, options, precise::PLAN, &mut Silent, |evidence, extents, stages| {
            found = precise::hypothesis(evidence, extents, options, stages);
            Err(Error::new(ErrorCode::Internal, "", "", "", ""))
        });
        CropPose::of_similarity(&found?, &self.rounds.search.frame)
    }

    /// Makes the hypothesis a candidate.
    pub fn join(&mut self, hypothesis: CropPose) {
        self.rounds.join(hypothesis);
    }

    /// The alignment, once no task is left.
    ///
    /// # Errors
    /// As [`align`](super::align).
    pub fn finish(self, host: &mut dyn Host) -> Result<Alignment> {
        let Self { observation, mesh, options, rounds } = self;
        align_by(&observation, &mesh, &options, precise::PLAN, host, |_, _, _| {
            precise::conclude(rounds, &mesh, &options)
        })
    }
}
