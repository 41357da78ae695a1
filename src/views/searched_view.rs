//! The search in one view, whose poses are hypotheses for all.

use super::view_set::Part;
use super::world_pose::{PlacedCamera, WorldPose};
use crate::error::Result;
use crate::evidence::observation::Observation;
use crate::evidence::photo::Photo;
use crate::geometry::surface_colors::SurfaceColors;
use crate::precise::drawing::pose::CropPose;
use crate::precise::drawing::prepared_mesh::PreparedMesh;
use crate::precise::options::AlignOptions;
use crate::precise::search::recipe::{SearchSettings, Task};
use crate::precise::search::rounds::Rounds;
use crate::precise::search::start;
use crate::precise::verdict::color::{Judgment, judgment};
use crate::progress::Stopwatch;
use crate::scheduler::Scheduler;

/// A view with a mask, and its search.
pub struct SearchedView {
    /// Index of the view in the input.
    pub index: usize,
    /// Its camera in the world.
    pub camera: PlacedCamera,
    /// The finished or running search.
    pub rounds: Rounds,
    /// Distinct poses after the first refinement: more than the ranking keeps.
    pub candidates: Vec<CropPose>,
    /// The verdict of colour on its poses, after [`Self::judge_colors`].
    pub color: Option<Judgment>,
}

impl SearchedView {
    /// A view before its search; `previous` is the same view after a search with less effort.
    ///
    /// # Errors
    /// As [`start::start_search`].
    pub fn begin(
        (index, camera): (usize, PlacedCamera),
        observation: &Observation,
        mesh: &PreparedMesh<'_>,
        (options, settings): (&AlignOptions, &SearchSettings),
        previous: Option<&Self>,
        stages: &mut Stopwatch<'_>,
    ) -> Result<Self> {
        let before = previous.map(|view| &view.rounds);
        let mut rounds = start::start_search(observation, mesh, before, options, settings, stages)?;
        rounds.search.view = index;
        Ok(Self { index, camera, rounds, candidates: Vec::new(), color: None })
    }

    /// Runs the search to its end.
    pub async fn run(&mut self, scheduler: &Scheduler) {
        while let Some(round) = self.rounds.round() {
            self.rounds.run(scheduler).await;
            if self.candidates.is_empty() && round.task == Task::Refine {
                self.candidates = self.rounds.poses().to_vec();
            }
        }
    }

    /// Compares the poses of the search, which has ended, with the photo. The pose that colour chooses becomes the first.
    pub async fn judge_colors(&mut self, photo: Option<&Photo>, colors: Option<&SurfaceColors>, scheduler: &Scheduler) {
        let (Some(photo), Some(colors)) = (photo, colors) else { return };
        let judgment = judgment(&self.rounds, photo, colors, scheduler).await;
        if let Some(chosen) = judgment.chosen {
            self.rounds.candidates.insert(0, chosen);
        }
        self.color = Some(judgment);
    }

    /// The view as one of several.
    pub fn part(&self) -> Part<'_> {
        let own = self.rounds.candidates.first().map(|candidate| candidate.pose);
        Part { index: self.index, search: &self.rounds.search, camera: self.camera, own }
    }

    /// The poses in the world that the search has found or refined once.
    pub fn hypotheses(&self) -> impl Iterator<Item = WorldPose> {
        let poses =
            self.rounds.candidates.iter().map(|candidate| candidate.pose).chain(self.candidates.iter().copied());
        poses.map(|pose| self.camera.place(&pose))
    }
}
