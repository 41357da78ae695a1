//! The alignment of one object by search, as it runs: the parts from which [`align`](super::align), and the calls of a
//! scene, are composed.
//!
//! Each part awaits a yield point after any render or refinement of a pose, and elsewhere at the end of a stage. Results
//! are bit-identical whether or not it yields.

use core::ops::{ControlFlow, Range};

use glam::DQuat;

use super::outcome::{Outcome, Setup, outcome, score};
use super::warnings::{about_fit, about_mesh, about_search, retain_doubts};
use crate::error::Result;
use crate::evidence::Normals;
use crate::evidence::clouds::Clouds;
use crate::evidence::observation::Observation;
use crate::geometry::rotations::quaternion_of;
use crate::precise;
use crate::precise::drawing::equivalence::DISTINCT_MIN_ANGLE_RAD;
use crate::precise::drawing::pose::CropPose;
use crate::precise::drawing::prepared_mesh::PreparedMesh;
use crate::precise::options::AlignOptions;
use crate::precise::scoring::conditioning::DROP;
use crate::precise::scoring::scene_term::SceneContext;
use crate::precise::search::efforts;
use crate::precise::search::plate::without_invented_plate;
use crate::precise::search::problem::FACING_CAMERA;
use crate::precise::search::recipe::{SURE, SURE_UNCUT, SearchSettings};
use crate::precise::search::rounds::Rounds;
use crate::precise::search::start::{self, SearchState, WarmStart};
use crate::precise::verdict::color::{Judgment, agreement, judgment};
use crate::precise::verdict::conclusion;
use crate::precise::verdict::conclusion::Verdict;
use crate::precise::verdict::lookalikes::ROLLS;
use crate::precise::verdict::stretch::stretch;
use crate::progress::{Host, Stage, Stopwatch};
use crate::report::{Alignment, PreciseDiagnostics, SearchCounts, Solution};
use crate::scheduler::{Boxed, Scheduler};

/// The options, validated, and the settings that follow from them.
pub struct Request {
    options: AlignOptions,
    efforts: Vec<SearchSettings>,
    setup: Setup,
    /// The rotation near which the result is, of poses that are equal.
    reference: DQuat,
}

/// The alignment of one object.
pub struct Search<'a> {
    observation: &'a Observation,
    mesh: &'a PreparedMesh<'a>,
    request: &'a Request,
    stages: Stopwatch<'a>,
    scheduler: &'a Scheduler,
}

/// The result of a search, by shape.
pub struct SearchResult {
    /// The poses.
    pub rounds: Rounds,
    solution: Solution,
    verdict: Verdict,
}

/// Loss of confidence beyond which the scene does not choose another pose than the object alone.
const MAX_CONFIDENCE_LOSS: f64 = 0.05;
/// Share of the confidence below which the scene contradicts what an object alone shows.
const CONTRADICTION_RATIO: f64 = 0.75;
/// Loss of the score of the image, at about the same rotation, with the same meaning: two standard deviations.
const MAX_IMAGE_SCORE_LOSS: f64 = 4.0 * DROP;

impl Request {
    /// A request with these options.
    ///
    /// # Errors
    /// [`ErrorCode::InvalidOption`](crate::error::ErrorCode::InvalidOption).
    pub fn new(options: AlignOptions) -> Result<Self> {
        let (setup, efforts) = (Setup::of_precise(&options)?, efforts::of(&options));
        let reference = options.initial.as_ref().map_or(FACING_CAMERA, quaternion_of);
        Ok(Self { options, efforts, setup, reference })
    }

    /// The options.
    pub fn options(&self) -> &AlignOptions {
        &self.options
    }

    /// The settings of the searches, with increasing effort.
    pub fn efforts(&self) -> &[SearchSettings] {
        &self.efforts
    }
}

impl SearchResult {
    fn new(rounds: Rounds, reference: Option<DQuat>) -> Result<Self> {
        let (solution, verdict) = conclusion::conclude(&rounds, None, reference)?;
        Ok(Self { rounds, solution, verdict })
    }

    /// The probability that the best pose is right up to the symmetry of the shape.
    pub fn confidence(&self) -> f64 {
        self.verdict.confidence.up_to_symmetry()
    }
}

impl<'a> Search<'a> {
    /// Begins with a check of the mesh, and with the choice of its form.
    ///
    /// # Errors
    /// [`ErrorCode::DegenerateMesh`](crate::error::ErrorCode::DegenerateMesh).
    pub async fn begin(
        observation: &'a Observation,
        mesh: &'a PreparedMesh<'a>,
        request: &'a Request,
        host: &'a mut dyn Host,
        scheduler: &'a Scheduler,
    ) -> Result<Self> {
        let mut stages = Stopwatch::new(host, precise::PLAN);
        stages.enter(Stage::Inspect);
        mesh.check()?;
        let is_long = |settings: &&SearchSettings| settings.is_long(1);
        if let Some(settings) = request.efforts.first().filter(is_long)
            && mesh.has_one_form(&settings.grids)
        {
            scheduler.ask_for_help().await;
        }
        scheduler.yield_point().await;
        let mesh = match request.efforts.first() {
            Some(first) => {
                let views = core::iter::once(observation);
                without_invented_plate(views, mesh, &request.options, first, scheduler).await
            }
            None => mesh,
        };
        Ok(Self { observation, mesh, request, stages, scheduler })
    }

    /// The mesh that is aligned: the one given, or that without a ground plate.
    pub fn mesh(&self) -> &'a PreparedMesh<'a> {
        self.mesh
    }

    /// Samples both clouds, and estimates their normals, if the metrics need them.
    ///
    /// # Errors
    /// Those of [`Clouds::new`].
    pub async fn clouds(&mut self) -> Result<Clouds> {
        let setup = &self.request.setup;
        let mut clouds = Clouds::new(self.observation, self.mesh.mesh(), &setup.sampling, &mut self.stages)?;
        self.scheduler.yield_point().await;
        if setup.metrics {
            clouds.evidence(Normals::Measured, &mut self.stages);
            self.scheduler.yield_point().await;
        }
        Ok(clouds)
    }

    /// Searches with increasing effort, until the confidence is high and the best pose has no rival.
    ///
    /// # Errors
    /// [`ErrorCode::NoConsensus`](crate::error::ErrorCode::NoConsensus), and those of [`start::start_search`].
    pub async fn search(&mut self) -> Result<SearchResult> {
        let efforts = self.request.efforts();
        if let Some(first) = efforts.first() {
            start::decimate(self.mesh, first, &mut self.stages)?;
            self.scheduler.yield_point().await;
        }

        let mut previous: Option<Rounds> = None;
        for (index, settings) in efforts.iter().enumerate() {
            if settings.is_long(1) && self.mesh.has_one_form(&settings.grids) {
                self.scheduler.ask_for_help().await;
            }
            let mut rounds = self.start(previous.as_ref(), settings)?;
            self.scheduler.yield_point().await;

            let is_last = index + 1 == efforts.len();
            let mut share = efforts::share(index, efforts.len());
            let is_first = index == 0 && !is_last && self.request.options.initial.is_none();
            if is_first && rounds.assume_uncut() {
                let [uncut, rest] = efforts::split(share);
                match self.attempt(rounds, uncut, Some(SURE_UNCUT)).await? {
                    ControlFlow::Break(result) => return Ok(result),
                    ControlFlow::Continue(unsure) => rounds = unsure.with_cuts(),
                }
                share = rest;
            }
            match self.attempt(rounds, share, (!is_last).then_some(SURE)).await? {
                ControlFlow::Break(result) => return Ok(result),
                ControlFlow::Continue(unsure) => previous = Some(unsure),
            }
        }
        Err(precise::no_candidate())
    }

    /// Runs a search to its end. Breaks with its result if the confidence is `sure` or more and the best pose has no rival, or if
    /// there is no such limit, because no search follows.
    async fn attempt(
        &mut self,
        mut rounds: Rounds,
        share: Range<f64>,
        sure: Option<f64>,
    ) -> Result<ControlFlow<SearchResult, Rounds>> {
        let end = share.end;
        self.run(&mut rounds, share).await;

        let conclusion = conclusion::conclude(&rounds, None, self.reference());
        let is_sure = sure.is_some_and(
            |least| matches!(&conclusion, Ok((_, verdict)) if verdict.confidence.up_to_symmetry() >= least),
        );
        let mut rivals = if is_sure { start::rival_search(&rounds) } else { None };
        if let Some(rivals) = &mut rivals {
            self.run(rivals, end..end).await;
        }
        let has_rival = rivals.is_some_and(|rivals| start::take_rivals(&mut rounds, &rivals));
        if sure.is_some() && (!is_sure || has_rival) {
            return Ok(ControlFlow::Continue(rounds));
        }
        let (solution, verdict) = conclusion?;
        Ok(ControlFlow::Break(SearchResult { rounds, solution, verdict }))
    }

    /// The rotation near which the result is, of poses that are equal by shape; `None` where colours choose among these.
    fn reference(&self) -> Option<DQuat> {
        let is_colored = self.observation.photo().is_some() && self.mesh.colors().is_some();
        (!is_colored).then_some(self.request.reference)
    }

    /// The search with these settings, before its first round.
    fn start(&mut self, previous: Option<&Rounds>, settings: &SearchSettings) -> Result<Rounds> {
        let Self { observation, mesh, request, stages, .. } = self;
        start::start_search(observation, mesh, previous, &request.options, settings, stages)
    }

    /// Runs a search to its end. `share` is the progress at its start and end.
    fn run<'b>(&'b mut self, rounds: &'b mut Rounds, share: Range<f64>) -> Boxed<'b, ()> {
        start::run_rounds(rounds, share, self.scheduler, &mut self.stages)
    }

    /// Searches from the candidates of an earlier search of the object, with the scene around it.
    ///
    /// # Errors
    /// As [`Search::search`].
    pub async fn search_again(&mut self, start: WarmStart<'_>) -> Result<SearchResult> {
        let earlier = start.earlier;
        let mut rounds = self.restart(start, None)?;
        self.scheduler.yield_point().await;
        self.run(&mut rounds, efforts::share(0, 1)).await;

        let reference = self.reference();
        let mut result = SearchResult::new(rounds, reference)?;
        if result.confidence() < earlier.confidence - MAX_CONFIDENCE_LOSS
            && result.rounds.move_to_front(&earlier.candidates)
        {
            result = SearchResult::new(result.rounds, reference)?;
        }

        let is_contradicted = result.confidence() < CONTRADICTION_RATIO * earlier.confidence;
        if is_contradicted || leaves_image(earlier, &result.rounds) {
            // Tables, undersides and neighbours are as inaccurate as the object: what its image shows, wins.
            let alone = WarmStart { earlier, context: SceneContext::default() };
            result = SearchResult::new(self.restart(alone, Some(&result.rounds))?, reference)?;
        }
        Ok(result)
    }

    /// The search from earlier candidates, before its first round; `previous` has the observation, if it has been cleaned.
    fn restart(&mut self, start: WarmStart<'_>, previous: Option<&Rounds>) -> Result<Rounds> {
        let Request { options, efforts, .. } = self.request;
        let settings = efforts.iter().find(|settings| settings.effort == start.earlier.effort);
        let settings = settings.ok_or_else(precise::no_candidate)?.again(start.earlier.is_sure());
        let clean = previous.map(|rounds| rounds.search.observation.clone());
        start::restart_search(self.observation, self.mesh, clean, start, options, &settings, &mut self.stages)
    }

    /// The verdict of the photo on the poses; `None` without a photo, or without colours of the mesh.
    pub async fn colors(&self, searched: &SearchResult) -> Option<Judgment> {
        let (photo, colors) = (self.observation.photo()?, self.mesh.colors()?);
        Some(judgment(&searched.rounds, photo, colors, self.scheduler).await)
    }

    /// The result, with its metrics.
    ///
    /// # Errors
    /// [`ErrorCode::NoConsensus`](crate::error::ErrorCode::NoConsensus).
    pub fn finish(mut self, mut clouds: Clouds, result: SearchResult, colors: Option<&Judgment>) -> Result<Alignment> {
        let SearchResult { rounds, mut solution, mut verdict } = result;
        if colors.is_some() {
            let reference = Some(self.request.reference);
            (solution, verdict) = conclusion::conclude(&rounds, colors, reference)?;
        }
        let Self { observation, mesh, request: Request { setup, options, .. }, .. } = self;
        verdict.confidence.relief_deviation = observation.relief_deviation();
        if mesh.lacks_colors() && observation.photo().is_some() {
            verdict.confidence.turn = rounds.search.equivalence.chance(ROLLS);
        }

        let mut metrics = score(observation, mesh.mesh(), setup, &mut clouds, &solution, &mut self.stages)?;
        if let Some(metrics) = &mut metrics {
            let (clean, pose) = (rounds.search.observation.clone(), &solution.camera_from_mesh);
            metrics.color_agreement = agreement(observation, Some(clean), mesh, pose);
        }

        let search = &rounds.search;
        let pose = CropPose::of_similarity(&solution.camera_from_mesh, &search.mesh.frame);
        let proportions = pose.and_then(|pose| stretch(search, mesh.mesh(), &pose, options.proportions));

        let Outcome { camera_from_mesh, metrics, mut warnings, diagnostics: common, points } =
            outcome(observation, setup, &clouds, &solution, metrics, self.stages);
        let confidence = verdict.confidence;
        warnings.extend(about_mesh(&mesh.removed_parts()));
        warnings.extend(about_search(common.converged));
        warnings.extend(about_fit(&verdict.terms));
        retain_doubts(&mut warnings, confidence.up_to_symmetry());

        let [target_points, source_points] = points;
        let counts = SearchCounts { source_points, target_points, renders: search.renders };
        let Verdict { alternatives, uncertainty, effort, score, terms, color, .. } = verdict;
        Ok(Alignment {
            camera_from_mesh,
            confidence: confidence.overall(),
            shape_confidence: confidence.up_to_symmetry(),
            turn_confidence: confidence.turn,
            symmetry: search.equivalence.axes(),
            alternatives,
            uncertainty,
            proportions,
            metrics,
            warnings,
            diagnostics: PreciseDiagnostics { common, counts, effort, score, terms, color },
        })
    }
}

/// Whether the scene has moved the pose that the object has alone farther than its image allows.
fn leaves_image(earlier: &SearchState, rounds: &Rounds) -> bool {
    let (Some(alone), Some(now)) = (earlier.candidates.first(), rounds.candidates.first()) else { return false };
    let search = &rounds.search;
    let loss = search.by_image(&alone.score) - search.by_image(&now.score);
    let turn = search.equivalence.angle(alone.pose.rotation, now.pose.rotation);
    turn < DISTINCT_MIN_ANGLE_RAD && f64::from(loss) > MAX_IMAGE_SCORE_LOSS
}
