//! Stages of the pipeline, their timings, and progress reports.

use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

use crate::geometry::similarity::Similarity;

/// A stage of the pipeline.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "camelCase")]
pub enum Stage {
    /// Back-projection of the masked depth (§3.1).
    Observe,
    /// Sampling of the mesh surface.
    Sample,
    /// Normals of the observed cloud, and voxel grids of both clouds.
    Normals,
    /// FPFH descriptors.
    Features,
    /// Mutual nearest descriptors.
    Matching,
    /// Guarded Sim(3) RANSAC (§3.2).
    Ransac,
    /// Hallucination filtering of the consensus.
    Filter,
    /// Scale-locked ICP (§3.3).
    Icp,
    /// The look for parts of the mesh that a generator added (`precise`).
    Inspect,
    /// Cleaning of mask and depth, and coarser meshes (`precise`).
    Prepare,
    /// Search over a grid of rotations (`precise`).
    Search,
    /// Refinement of all seven parameters, and selection (`precise`).
    Refine,
    /// Metrics of the result.
    Metrics,
}

impl Stage {
    /// The name of the stage in JavaScript.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Observe => "observe",
            Self::Sample => "sample",
            Self::Normals => "normals",
            Self::Features => "features",
            Self::Matching => "matching",
            Self::Ransac => "ransac",
            Self::Filter => "filter",
            Self::Icp => "icp",
            Self::Inspect => "inspect",
            Self::Prepare => "prepare",
            Self::Search => "search",
            Self::Refine => "refine",
            Self::Metrics => "metrics",
        }
    }
}

/// Host interface: a clock and a progress listener. Results depend on neither.
pub trait Host {
    /// Milliseconds since a fixed point in time.
    fn now_ms(&mut self) -> f64;

    /// Reports that a stage begins or continues; `fraction` of the total work, 0 to 1 and monotonic, is done.
    fn progress(&mut self, stage: Stage, fraction: f64);

    /// Reports the best pose so far and its score, before the progress of the same round.
    fn best(&mut self, _camera_from_mesh: &Similarity, _score: f64) {}
}

impl<H: Host + ?Sized> Host for &mut H {
    fn now_ms(&mut self) -> f64 {
        (**self).now_ms()
    }

    fn progress(&mut self, stage: Stage, fraction: f64) {
        (**self).progress(stage, fraction);
    }

    fn best(&mut self, camera_from_mesh: &Similarity, score: f64) {
        (**self).best(camera_from_mesh, score);
    }
}

/// A host without clock and listener; all times are 0.
#[derive(Debug, Clone, Copy, Default)]
pub struct Silent;

impl Host for Silent {
    fn now_ms(&mut self) -> f64 {
        0.0
    }

    fn progress(&mut self, _stage: Stage, _fraction: f64) {}
}

/// Milliseconds per stage, in the order of their first run. Serialises as an object with a `total`.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Timings(Vec<(Stage, f64)>);

impl Timings {
    /// The stages and their times.
    pub fn stages(&self) -> &[(Stage, f64)] {
        &self.0
    }

    /// The sum over all stages.
    pub fn total_ms(&self) -> f64 {
        self.0.iter().map(|(_, ms)| ms).sum()
    }
}

impl Serialize for Timings {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len() + 1))?;
        for (stage, ms) in &self.0 {
            map.serialize_entry(stage.as_str(), ms)?;
        }
        map.serialize_entry("total", &self.total_ms())?;
        map.end()
    }
}

/// Times the stages of one run and reports them to the host.
pub struct Stopwatch<'a> {
    host: Box<dyn Host + 'a>,
    plan: &'static [(Stage, f64)],
    timings: Timings,
    running: Option<Stage>,
    fraction: f64,
    begun_ms: f64,
}

impl<'a> Stopwatch<'a> {
    /// A stopwatch; `plan` holds the progress at the start of each stage, 0 to 1.
    pub fn new(host: impl Host + 'a, plan: &'static [(Stage, f64)]) -> Self {
        Self { host: Box::new(host), plan, timings: Timings::default(), running: None, fraction: 0.0, begun_ms: 0.0 }
    }

    /// Ends the current stage, if any, and begins another. The times of repeated stages add up.
    pub fn enter(&mut self, stage: Stage) {
        self.end_stage();
        let planned = self.plan.iter().find(|(s, _)| *s == stage).map_or(0.0, |(_, fraction)| *fraction);
        self.fraction = self.fraction.max(planned);
        self.host.progress(stage, self.fraction);
        self.running = Some(stage);
    }

    /// Reports progress within the current stage, and optionally the best pose and its score.
    pub fn reach(&mut self, fraction: f64, best: Option<(Similarity, f64)>) {
        best.inspect(|(camera_from_mesh, score)| self.host.best(camera_from_mesh, *score));
        self.fraction = fraction;
        self.running.into_iter().for_each(|stage| self.host.progress(stage, fraction));
    }

    /// The current stage.
    pub fn running(&self) -> Option<Stage> {
        self.running
    }

    /// Ends the last stage and returns the timings.
    pub fn finish(mut self) -> Timings {
        self.end_stage();
        if let Some((stage, _)) = self.timings.0.last() {
            self.host.progress(*stage, 1.0);
        }
        self.timings
    }

    fn end_stage(&mut self) {
        let now_ms = self.host.now_ms();
        if let Some(stage) = self.running.take() {
            let ms = now_ms - self.begun_ms;
            match self.timings.0.iter_mut().find(|(s, _)| *s == stage) {
                Some((_, sum)) => *sum += ms,
                None => self.timings.0.push((stage, ms)),
            }
        }
        self.begun_ms = now_ms;
    }
}
