//! The tracker.

use crate::precise;
use crate::precise::no_candidate;
use crate::precise::search::recipe::SearchSettings;
use crate::precise::search::start;
use core::borrow::Borrow;
use glam::{DQuat, DVec3};

use super::TrackOptions;
use super::detection::{Detection, DetectionPrior, Lead};
use super::evidence::{Evidence, TrackedMesh, is_set};
use super::history::{History, MAX_FRAMES};
use super::local_search::{FramePose, agreement};
use super::motion::{MAX_TURN_RAD, Motion};
use super::report::{CorrectedFrame, TrackState, TrackedFrame};
use super::size::Size;
use crate::error::{Error, ErrorCode, Result};
use crate::evidence::clouds::Sampling;
use crate::evidence::frame::Frame;
use crate::evidence::observation::Observation;
use crate::evidence::photo::PhotoRegion;
use crate::geometry::rotations::angle_between;
use crate::geometry::similarity::Similarity;
use crate::metrics;
use crate::number::number;
use crate::options::Options;
use crate::precise::drawing::pose::CropPose;
use crate::precise::drawing::prepared_mesh::PreparedMesh;
use crate::precise::drawing::render::Canvas;
use crate::precise::scoring::objective::Objective;
use crate::precise::scoring::prior::Prior;
use crate::precise::scoring::score::{NOISE, Score};
use crate::precise::search::problem::Search;
use crate::precise::search::ranking::Candidate;
use crate::precise::search::recipe::FINE;
use crate::precise::search::refine::Refiner;
use crate::precise::verdict::choice::MIN_CORRELATION;
use crate::precise::verdict::color::{LOOSE_MIN_SD_RAD, agreement_at, loose_axis, roll};
use crate::precise::verdict::confidence::{Confidence, pose_probability};
use crate::progress::Host;
use crate::report::Effort;
use crate::scheduler::{Boxed, Scheduler, boxed, finished};
use crate::views::common_size::{PREDICTED_ERROR, SILHOUETTE_ERROR, SizeEvidence, refine_at};
use crate::views::world_pose::{PlacedCamera, WorldPose};

/// Steps of the refinement that shows the size, and after a change of the size. Both begin at a pose that is refined but for its
/// size.
const STEPS: [usize; 2] = [3, 2];
/// Fit relative to that of earlier frames, below which the neighbourhood is searched, a frame is uncertain, and the object
/// is lost.
const MIN_GOOD_FIT: f32 = 0.85;
const MIN_CERTAIN_FIT: f32 = 0.7;
const MIN_TRACKED_FIT: f32 = 0.45;
/// The ratio of the fits at which a pose found anew counts instead of one that continues what was tracked.
const REDETECTION_FIT_RATIO: f32 = 1.1;
/// Weight of a frame in the usual fit.
const USUAL_FIT_GAIN: f32 = 0.1;
/// Share of the silhouette that must be seen in a frame without a mask, for it to be certain, and not to be lost.
const MIN_VISIBLE_SHARES: [f32; 2] = [0.35, 0.12];
/// Share of the object that a frame must show for it to be searched for over all rotations, and for its rotation to count
/// as known.
const MIN_SHOWN_SHARE: f32 = 0.5;
/// The same for a rotation that differs from the last certain one by more than an object turns unseen.
const MIN_SHOWN_SHARE_TURNED: f32 = 0.8;
/// Distances from its last place, in diagonals, at which a lost object is looked for without a mask, and the directions.
const REAPPEARANCE_DIAGONALS: [f64; 2] = [0.25, 0.5];
const DIRECTIONS: [[f64; 2]; 8] =
    [[1.0, 0.0], [0.7, 0.7], [0.0, 1.0], [-0.7, 0.7], [-1.0, 0.0], [-0.7, -0.7], [0.0, -1.0], [0.7, -0.7]];
/// Standard deviation of the size of a correction, relative.
const CORRECTION_SD: f64 = 0.005;

/// A tracker of one object. It owns or borrows its mesh.
pub struct Tracker<M> {
    mesh: M,
    options: TrackOptions,
    tracked: TrackedMesh,
    prior: Prior,
    size: Size,
    /// The pose of the last frame, in its camera.
    last: Option<WorldPose>,
    motion: Motion,
    state: TrackState,
    /// The usual fit of a frame.
    usual: Option<f32>,
    /// The rotation in the last frame that was certain and showed enough.
    certain: Option<DQuat>,
    /// The lead over other poses, where the object was found.
    lead: Lead,
    history: History,
}

impl<'m, M: Borrow<PreparedMesh<'m>>> Tracker<M> {
    /// A tracker before its first frame.
    ///
    /// # Errors
    /// [`ErrorCode::InvalidOption`], [`ErrorCode::DegenerateMesh`].
    pub fn new(mesh: M, options: TrackOptions) -> Result<Self> {
        options.validate()?;
        let prepared = mesh.borrow();
        prepared.check()?;
        let settings = SearchSettings { lock_scale: true, ..SearchSettings::from(Effort::Fast) };
        let pyramid = prepared.pyramid(&settings.grids).ok_or_else(no_candidate)?;
        let detection = options.of_detection();
        let prior = Prior::of(&detection, prepared.mesh(), &pyramid.frame);
        let known = prior.fixed_scale().map(libm::log);
        Ok(Self {
            mesh,
            options,
            tracked: TrackedMesh { equivalence: pyramid.equivalence(&detection.symmetry)?, pyramid, settings },
            prior,
            size: Size::new(known),
            last: None,
            motion: Motion::REST,
            state: TrackState::Lost,
            usual: None,
            certain: None,
            lead: Lead { margin: 0.0, color_probability: 1.0, turn: None },
            history: History::default(),
        })
    }

    /// Its options.
    pub fn options(&self) -> &TrackOptions {
        &self.options
    }

    /// The pose in the next frame. A frame without a mask, or with an empty one, is looked at where the object should be.
    ///
    /// # Errors
    /// [`ErrorCode::InvalidArgument`] for a first frame without a mask and without `initial`; [`ErrorCode::NoConsensus`] if
    /// the object is not found in the first frame, and those of [`Observation::new`] there; those of
    /// [`Frame::check`] in all frames. The tracker remains usable.
    pub fn next(&mut self, frame: &Frame, host: &mut dyn Host) -> Result<TrackedFrame> {
        finished(self.next_in_steps(frame, host, &Scheduler::unbounded()))
    }

    /// [`Tracker::next`] in steps. A frame that is given up before its end does not count.
    ///
    /// # Errors
    /// As [`Tracker::next`].
    pub fn next_in_steps<'a>(
        &'a mut self,
        frame: &'a Frame,
        host: &'a mut dyn Host,
        scheduler: &'a Scheduler,
    ) -> Boxed<'a, Result<TrackedFrame>>
    where
        M: 'a,
        'm: 'a,
    {
        boxed(async move {
            frame.check()?;
            let seen = match self.last {
                Some(last) => self.follow(frame, last, host, scheduler).await,
                None => Some(self.first(frame, host, scheduler).await?),
            };
            self.conclude(frame, seen)
        })
    }

    /// Sets the pose of a frame, by default of the last one, and carries it on to all frames of the same stretch: forwards
    /// to the next frames, and backwards with the motion that was tracked. Returns the frames whose poses change.
    ///
    /// # Errors
    /// [`ErrorCode::InvalidArgument`] for a frame that has not been tracked, or before the newest 100 000,
    /// [`ErrorCode::InvalidTransform`] for a pose behind the camera.
    pub fn correct(&mut self, pose: &Similarity, frame: Option<usize>) -> Result<Vec<CorrectedFrame>> {
        let frames = self.history.frames();
        let unknown = || {
            Error::new(
                ErrorCode::InvalidArgument,
                "frame",
                frame.map_or("no frame".into(), |frame| format!("frame {} of {frames}", number(frame as f64))),
                format!("the number of a frame that was tracked, one of the last {}", number(MAX_FRAMES as f64)),
                "Call next() with the frame first.",
            )
        };
        let index = frame.or(frames.checked_sub(1)).ok_or_else(unknown)?;
        let fixed = start::seen_from(pose, &self.tracked.pyramid.frame, (ErrorCode::InvalidTransform, "pose"))?;
        let fixed = PlacedCamera::AT_ORIGIN.place(&fixed);
        let (changed, is_present) =
            self.history.correct(index, fixed, &self.tracked.pyramid.frame).ok_or_else(unknown)?;
        if is_present {
            self.last = self.history.last();
            self.state = TrackState::Tracking;
            self.usual = None;
            self.lead = Lead { margin: f64::from(NOISE), color_probability: 1.0, turn: None };
            self.certain = self.last.map(|pose| pose.rotation);
            let evidence =
                SizeEvidence { log_scale: fixed.log_scale, sd: CORRECTION_SD, score: 0.0, depth_agreement: 1.0 };
            self.size.correct(fixed.rotation, evidence);
        }
        Ok(changed)
    }

    /// The pose in the first frame.
    async fn first(&self, frame: &Frame, host: &mut dyn Host, scheduler: &Scheduler) -> Result<FramePose> {
        let has_mask = frame.mask.as_ref().is_some_and(is_set);
        if let (Some(initial), false) = (&self.options.initial, has_mask) {
            let pose = CropPose::of_similarity(initial, &self.tracked.pyramid.frame).ok_or_else(no_candidate)?;
            let evidence = self.tracked.evidence(frame, &pose).ok_or_else(no_candidate)?;
            return self.tracked.around(frame, &evidence, &[pose], false).ok_or_else(no_candidate);
        }
        let observation = frame.observation()?.ok_or_else(|| {
            Error::new(
                ErrorCode::InvalidArgument,
                "mask",
                "nothing",
                "the mask of the object in the first frame",
                "Pass the mask, or the pose in the first frame as options.initial.",
            )
        })?;
        self.detect(&observation, None, host, scheduler).await
    }

    /// The pose in a frame after the first; `None` if the object is lost.
    async fn follow(
        &self,
        frame: &Frame,
        last: WorldPose,
        host: &mut dyn Host,
        scheduler: &Scheduler,
    ) -> Option<FramePose> {
        let size = self.size.value();
        let sized = |pose: WorldPose| size.map_or(pose, |(log_scale, _)| WorldPose { log_scale, ..pose });
        let expected = [self.motion.carried(&last), last].map(sized);
        let seen: Vec<CropPose> = expected.iter().filter_map(|pose| PlacedCamera::AT_ORIGIN.see(pose)).collect();
        let evidence = seen.first().and_then(|first| self.tracked.evidence(frame, first));
        let look = |wide| self.tracked.around(frame, evidence.as_ref()?, &seen, wide);
        let near = look(false);
        let fit = |seen: &Option<FramePose>, tracker: &Self| seen.as_ref().map_or(0.0, |seen| tracker.fit(seen));
        if fit(&near, self) >= MIN_GOOD_FIT && self.state != TrackState::Lost {
            return near;
        }
        scheduler.yield_point().await;
        let wide = look(true);
        let near = if fit(&wide, self) > fit(&near, self) { wide } else { near };
        if fit(&near, self) >= MIN_CERTAIN_FIT && self.state != TrackState::Lost {
            return near;
        }
        // An object that leaves the image, or passes behind another, is not where all rotations should be searched: little
        // of it may look like anything.
        let is_leaving = |seen: &FramePose| seen.shown_share(frame) < MIN_SHOWN_SHARE;
        if self.state != TrackState::Lost && near.as_ref().is_some_and(is_leaving) {
            return near.filter(|seen| self.fit(seen) >= MIN_TRACKED_FIT && seen.visible >= MIN_VISIBLE_SHARES[1]);
        }
        // Candidate anew, where a mask shows the object.
        let before = self.certain.unwrap_or(last.rotation);
        let anew = match frame.observation().ok().flatten() {
            Some(observation) => self.detect(&observation, Some(before), host, scheduler).await.ok(),
            None => None,
        };
        let shows_enough_anew = |seen: &FramePose| {
            let has_turned = angle_between(seen.candidate.pose.rotation, before) > MAX_TURN_RAD;
            seen.shown_share(frame) >= if has_turned { MIN_SHOWN_SHARE_TURNED } else { MIN_SHOWN_SHARE }
        };
        let anew = anew.filter(shows_enough_anew).map(|seen| self.unturned(frame, seen, before));
        let best = if fit(&anew, self) > REDETECTION_FIT_RATIO * fit(&near, self) { anew } else { near };
        if self.state == TrackState::Lost && frame.mask.is_none() && fit(&best, self) < MIN_CERTAIN_FIT {
            return self.beside(frame, &sized(last));
        }
        let least = if self.state == TrackState::Lost { MIN_CERTAIN_FIT } else { MIN_TRACKED_FIT };
        best.filter(|seen| self.fit(seen) >= least && seen.visible >= MIN_VISIBLE_SHARES[1])
    }

    /// The pose of a lost object that has come back beside the place where it was last.
    fn beside(&self, frame: &Frame, last: &WorldPose) -> Option<FramePose> {
        let diagonal = libm::exp(last.log_scale);
        let offsets = REAPPEARANCE_DIAGONALS
            .iter()
            .flat_map(|&apart| DIRECTIONS.map(|[x, y]| DVec3::new(x, y, 0.0) * (apart * diagonal)));
        let seen = offsets.filter_map(|offset| {
            let pose = PlacedCamera::AT_ORIGIN.see(&WorldPose { center: last.center + offset, ..*last })?;
            self.tracked.around(frame, &self.tracked.evidence(frame, &pose)?, &[pose], false)
        });
        let fits = seen.filter(|seen| self.fit(seen) >= MIN_GOOD_FIT && seen.visible >= MIN_VISIBLE_SHARES[0]);
        fits.max_by(|a, b| self.fit(a).total_cmp(&self.fit(b)))
    }

    /// The pose found, in the rotation of before where that fits nearly as well: an object rarely turns over unseen, and a
    /// part of it that comes out behind another may look like its other end.
    fn unturned(&self, frame: &Frame, seen: FramePose, before: DQuat) -> FramePose {
        if angle_between(seen.candidate.pose.rotation, before) <= MAX_TURN_RAD {
            return seen;
        }
        let expected = CropPose { rotation: before, ..seen.candidate.pose };
        // The more of it is hidden, the less its fit counts.
        let is_near = |other: &FramePose| {
            (REDETECTION_FIT_RATIO + other.candidate.score.hidden) * self.fit(other) >= self.fit(&seen)
        };
        let near = self.tracked.evidence(frame, &expected);
        match near.and_then(|near| self.tracked.around(frame, &near, &[expected], true)) {
            Some(other) if is_near(&other) => FramePose { lead: seen.lead, ..other },
            _ => seen,
        }
    }

    /// Searches all rotations, with the prior of a track if the object was seen before in this rotation.
    async fn detect(
        &self,
        observation: &Observation,
        before: Option<DQuat>,
        host: &mut dyn Host,
        scheduler: &Scheduler,
    ) -> Result<FramePose> {
        let log_scale = self.size.value().map(|(log_scale, _)| log_scale);
        let known = DetectionPrior { prior: self.prior, before: before.map(|before| (log_scale, before)) };
        // The object turns after the first frame.
        let options = if before.is_some() { self.options.of_detection() } else { self.options.of_first_frame() };
        let detection = Detection::search(observation, self.mesh.borrow(), &options, &known, host, scheduler).await?;
        // With the settings of the frames after it, so that scores compare.
        let search = self.tracked.search(detection.observation);
        let candidate = Candidate { score: search.score(&detection.candidate.pose), ..detection.candidate };
        let evidence = Evidence { search, region: PhotoRegion::WHOLE };
        Ok(FramePose { candidate, evidence, lead: Some(detection.lead), visible: 1.0, is_predicted: false })
    }

    /// The agreement of a pose relative to that of earlier frames, about 1 for one as good.
    fn fit(&self, seen: &FramePose) -> f32 {
        let fit = agreement(&seen.candidate.score);
        self.usual.map_or(1.0, |usual| fit / usual.max(1e-3))
    }

    /// Updates size, motion and state, and reports.
    fn conclude(&mut self, frame: &Frame, seen: Option<FramePose>) -> Result<TrackedFrame> {
        let Some(seen) = seen else { return Ok(self.lost()) };
        let is_certain = self.fit(&seen) >= MIN_CERTAIN_FIT && seen.visible >= MIN_VISIBLE_SHARES[0];
        let shows_enough = is_certain && seen.shown_share(frame) >= MIN_SHOWN_SHARE;
        let FramePose { mut candidate, evidence, lead, is_predicted, .. } = seen;
        let is_detected = lead.is_some();
        let search = &evidence.search;
        self.state = if is_certain { TrackState::Tracking } else { TrackState::Uncertain };
        let before = self.last;
        if let Some(lead) = lead {
            self.lead = lead;
            self.motion = Motion::REST;
        }
        if is_certain {
            let usual = self.usual.unwrap_or_else(|| agreement(&candidate.score));
            self.usual = Some(usual + USUAL_FIT_GAIN * (agreement(&candidate.score) - usual));
            if shows_enough {
                self.certain = Some(candidate.pose.rotation);
            }
            self.roll(frame, &evidence, &mut candidate);
            self.size.advance();
            self.weigh_size(search, &mut candidate, if is_predicted { PREDICTED_ERROR } else { SILHOUETTE_ERROR });
        }
        let pose = PlacedCamera::AT_ORIGIN.place(&candidate.pose);
        if let (Some(before), false) = (before, is_detected) {
            self.motion = Motion::between(&before, &pose);
        }
        let confidence = {
            let (conditioning, _) = search.conditioning(&candidate.pose);
            let scale_sd = self.size.value().map_or(1.0, |(_, sd)| sd);
            let conditioning = conditioning
                .map(|own| precise::scoring::conditioning::Conditioning { scale: scale_sd.min(own.scale), ..own });
            let shape = pose_probability(&candidate, self.lead.margin, conditioning.as_ref());
            let Lead { color_probability: color, turn, .. } = self.lead;
            Confidence { shape, color, relief_deviation: frame.relief_deviation, turn }
        };
        let camera_from_mesh = pose.similarity(&self.tracked.pyramid.frame);
        let observed = if self.options.metrics { frame.observation().ok().flatten() } else { None };
        let measured = match observed {
            Some(observation) => {
                let sampling = Sampling { seed: u64::from(self.options.seed), ..Sampling::default() };
                Some(metrics::evaluate(&observation, self.mesh.borrow().mesh(), &camera_from_mesh, &sampling)?)
            }
            None => None,
        };
        self.remember(pose, is_detected);
        Ok(TrackedFrame {
            camera_from_mesh: (&camera_from_mesh).into(),
            frame: self.history.frames() - 1,
            state: self.state,
            confidence: confidence.overall(),
            shape_confidence: confidence.up_to_symmetry(),
            turn_confidence: confidence.turn,
            symmetry: self.tracked.equivalence.axes(),
            scale_sd: self.size.deviation(),
            is_scale_settled: self.size.is_settled(),
            is_detected,
            score: f64::from(candidate.score.total),
            terms: (&candidate.score).into(),
            metrics: measured,
        })
    }

    /// Rolls the pose about the axis that shape leaves open, to where its colours agree with the photo.
    fn roll(&self, frame: &Frame, evidence: &Evidence, candidate: &mut Candidate) {
        let Evidence { search, .. } = evidence;
        let (Some(colors), true) = (self.mesh.borrow().colors(), frame.photo.is_some()) else { return };
        if let Some(axis) = loose_axis(search, &candidate.pose, LOOSE_MIN_SD_RAD)
            && let Some(photo) = evidence.photo(frame)
            && let Some((pose, _)) = roll(search, &photo, colors, candidate.pose, axis)
            && agreement_at(search, &photo, colors, &pose).is_some_and(|agreement| agreement >= MIN_CORRELATION)
        {
            *candidate = Candidate { pose, score: search.score(&pose), ..*candidate };
        }
    }

    /// Adds the evidence of a frame to the size, and moves its pose to the size that follows.
    fn weigh_size(&mut self, search: &Search, candidate: &mut Candidate, silhouette_error: f64) {
        if !self.size.wants(candidate.pose.rotation) {
            return;
        }
        let objective = search.objective(FINE);
        let objective = Objective { prior: self.prior, ..objective };
        let free = Refiner { objective, lock_scale: false }.refine(&mut Canvas::default(), candidate.pose, STEPS[0]);
        if let Some(evidence) = SizeEvidence::at(objective, &free.pose, silhouette_error) {
            self.size.add(candidate.pose.rotation, evidence);
        }
        if let Some((log_scale, _)) = self.size.value() {
            *candidate = refine_at(objective, candidate.pose, log_scale, STEPS[1]);
        }
    }

    /// The frame in which the object was not found: its motion is carried on.
    fn lost(&mut self) -> TrackedFrame {
        let expected = self.last.map(|last| self.motion.carried(&last));
        self.state = TrackState::Lost;
        self.motion = Motion::REST;
        let pose = expected.unwrap_or(WorldPose { rotation: DQuat::IDENTITY, log_scale: 0.0, center: DVec3::Z });
        self.remember(pose, false);
        TrackedFrame {
            camera_from_mesh: (&pose.similarity(&self.tracked.pyramid.frame)).into(),
            frame: self.history.frames() - 1,
            state: self.state,
            confidence: 0.0,
            shape_confidence: 0.0,
            turn_confidence: None,
            symmetry: self.tracked.equivalence.axes(),
            scale_sd: self.size.deviation(),
            is_scale_settled: self.size.is_settled(),
            is_detected: false,
            score: 0.0,
            terms: (&Score::default()).into(),
            metrics: None,
        }
    }

    fn remember(&mut self, pose: WorldPose, is_anew: bool) {
        self.last = Some(pose);
        self.history.add(pose, is_anew);
    }
}
