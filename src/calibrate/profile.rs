//! Profiles: how well an object can be explained with each calibration of its view.

use std::rc::Rc;

use glam::DVec3;

use super::calibration::Calibration;
use super::raw_view::RawView;
use crate::error::{Error, Result};
use crate::evidence::observation::Observation;
use crate::geometry::image::{DepthMap, Mask};
use crate::precise::drawing::pose::CropPose;
use crate::precise::drawing::prepared_mesh::PreparedMesh;
use crate::precise::drawing::render::Canvas;
use crate::precise::observation::clean::CleanObservation;
use crate::precise::options::AlignOptions;
use crate::precise::search::problem::Search;
use crate::precise::search::ranking::Candidate;
use crate::precise::search::recipe::{FINE, SearchSettings};
use crate::precise::search::refine::Refiner;
use crate::precise::search::start;
use crate::progress::Stopwatch;
use crate::report::Effort;
use crate::scheduler::Scheduler;

/// Maximum number of steps of a refinement.
const STEPS: usize = 8;

/// An object of a view.
pub struct CalibrationObject<'a> {
    /// Its pixels.
    pub mask: &'a Mask,
    /// The pixels of the others, if there are any.
    pub others: Option<Mask>,
    /// Its mesh.
    pub mesh: &'a PreparedMesh<'a>,
    /// Its options; in depth that is not metric without any length.
    pub options: AlignOptions,
    /// Whether a length of it is known.
    pub has_length: bool,
}

/// A pose that does not depend on the distance of the object nor on the focal length: size and place are in pixels, and the
/// distance is relative to the median depth.
#[derive(Debug, Clone, Copy)]
pub struct RefinedPose {
    pose: CropPose,
    focal: f64,
    median: f64,
}

impl CalibrationObject<'_> {
    /// The error of the readings of this object, whatever the calibration.
    pub fn unusable(&self, view: &RawView) -> Option<Error> {
        let reading = |d: &f32| if d.is_finite() { d.abs().max(f32::MIN_POSITIVE.sqrt()) } else { 0.0 };
        let (width, height) = (view.values.width(), view.values.height());
        let depth = DepthMap::from_metres(width, height, view.values.data().iter().map(reading).collect());
        depth.and_then(|depth| Observation::new(depth, self.mask.clone(), view.camera)).err()
    }

    fn observation(&self, view: &RawView, calibration: &Calibration) -> Result<Observation> {
        let observation = Observation::new(view.depth(calibration)?, self.mask.clone(), view.camera(calibration))?;
        match &self.others {
            Some(others) => observation.with_others(others.clone()),
            None => Ok(observation),
        }
    }

    fn settings(&self) -> SearchSettings {
        SearchSettings::from(Effort::Fast)
    }

    /// The poses that a search finds with a calibration, best first, and their scores.
    pub async fn search(
        &self,
        view: &RawView,
        calibration: &Calibration,
        scheduler: &Scheduler,
        stages: &mut Stopwatch<'_>,
    ) -> Result<Vec<(f64, RefinedPose)>> {
        let observation = self.observation(view, calibration)?;
        let mut rounds = start::start_search(&observation, self.mesh, None, &self.options, &self.settings(), stages)?;
        start::run_rounds(&mut rounds, 0.0..1.0, scheduler, stages).await;
        let median = rounds.search.observation.median_m;
        let pictured = |candidate: &Candidate| {
            (f64::from(candidate.score.total), RefinedPose { pose: candidate.pose, focal: calibration.focal, median })
        };
        Ok(rounds.candidates.iter().map(pictured).collect())
    }

    /// The best of these poses, refined with a calibration, and its score; `None` without poses.
    pub fn refined(
        &self,
        view: &RawView,
        calibration: &Calibration,
        poses: &[RefinedPose],
        tolerance: f64,
        stages: &mut Stopwatch<'_>,
    ) -> Result<Option<(f64, RefinedPose)>> {
        let observation = self.observation(view, calibration)?;
        let clean = Rc::new(CleanObservation::new(&observation));
        let search: Search =
            start::prepare_search(&observation, Some(clean), self.mesh, &self.options, &self.settings(), stages)?;
        let mut objective = search.objective(FINE);
        objective.scoring.depth_m *= tolerance as f32;
        let refiner = Refiner { objective, lock_scale: search.settings.lock_scale };
        let mut canvas = Canvas::default();
        let median = search.observation.median_m;
        let refined = poses.iter().map(|pose| {
            let pose = pose.seen(calibration.focal, median);
            let candidate = refiner.refine_in_proportion(&mut canvas, pose, STEPS, &search.mesh.surface);
            (f64::from(candidate.score.total), RefinedPose { pose: candidate.pose, focal: calibration.focal, median })
        });
        Ok(refined.reduce(|best, next| if next.0 > best.0 { next } else { best }))
    }
}

impl RefinedPose {
    /// The scale, in units of depth with the calibration of the pose per unit of the mesh in its normalised frame.
    pub fn scale(&self) -> f64 {
        self.pose.scale_translation().0
    }

    /// The centre of the mesh, in units of depth with the calibration of the pose.
    pub fn center(&self) -> DVec3 {
        self.pose.scale_translation().1
    }

    /// The same pose, for a view whose guess of the focal length is this many times that of its own.
    pub fn rebased(self, focal: f64) -> Self {
        Self { focal: self.focal / focal, ..self }
    }

    /// The pose with another focal length.
    pub fn at_focal(self, focal: f64) -> Self {
        Self { pose: self.seen(focal, self.median), focal, ..self }
    }

    /// The pose with another calibration.
    fn seen(&self, focal: f64, median: f64) -> CropPose {
        let by = self.focal / focal;
        let Self { pose, .. } = *self;
        CropPose {
            size: pose.size + libm::log(by),
            place: pose.place * by,
            distance: pose.distance + libm::log(median / self.median),
            ..pose
        }
    }
}
