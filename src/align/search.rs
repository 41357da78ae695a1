//! The alignment of one object by search, as it runs: the parts from which [`align`](super::align), and the calls of a
//! scene, are composed.
//!
//! Each part awaits a yield point after any render or refinement of a pose, and elsewhere at the end of a stage. Results
//! are bit-identical whether or not it yields.

use super::outcome::{Outcome, Setup, outcome, score};
use super::warnings::{about_fit, about_mesh, about_search, retain_doubts};
use crate::error::Result;
use crate::evidence::Normals;
use crate::evidence::clouds::Clouds;
use crate::evidence::observation::Observation;
use crate::precise;
use crate::precise::drawing::equivalence::DIFFERENT;
use crate::precise::drawing::pose::CropPose;
use crate::precise::drawing::prepared_mesh::PreparedMesh;
use crate::precise::options::AlignOptions;
use crate::precise::scoring::conditioning::DROP;
use crate::precise::scoring::surroundings::Neighbourhood;
use crate::precise::search::efforts;
use crate::precise::search::plate::without_invented_plate;
use crate::precise::search::recipe::{SURE, SearchSettings};
use crate::precise::search::rounds::Rounds;
use crate::precise::search::start::{self, Findings, WarmStart};
use crate::precise::verdict::color::{Judgment, agreement, judgment};
use crate::precise::verdict::conclusion;
use crate::precise::verdict::conclusion::Certainty;
use crate::precise::verdict::confidence::certainty_of_relief;
use crate::precise::verdict::stretch::stretch;
use crate::progress::{Host, Stage, Stopwatch};
use crate::report::{Alignment, PreciseDiagnostics, SearchCounts, Solution};
use crate::scheduler::Scheduler;

/// The options, validated, and the settings that follow from them.
pub struct Request {
    options: AlignOptions,
    efforts: Vec<SearchSettings>,
    setup: Setup,
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
pub struct Searched {
    /// The poses.
    pub rounds: Rounds,
    solution: Solution,
    certainty: Certainty,
}

/// Loss of confidence beyond which the surroundings do not choose another pose than the object alone.
const DOUBT: f64 = 0.05;
/// Share of the confidence below which the surroundings contradict what an object alone shows.
const CONTRADICTION: f64 = 0.75;
/// Loss of the score of the image, at about the same rotation, with the same meaning: two standard deviations.
const MOST_LOSS: f64 = 4.0 * DROP;

impl Request {
    /// A request with these options.
    ///
    /// # Errors
    /// [`ErrorCode::InvalidOption`](crate::error::ErrorCode::InvalidOption).
    pub fn new(options: AlignOptions) -> Result<Self> {
        let (setup, efforts) = (Setup::of_precise(&options)?, efforts::of(&options));
        Ok(Self { options, efforts, setup })
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

impl Searched {
    fn new(rounds: Rounds) -> Result<Self> {
        let (solution, certainty) = conclusion::conclude(&rounds, None)?;
        Ok(Self { rounds, solution, certainty })
    }

    /// The probability that the best pose is right.
    pub fn confidence(&self) -> f64 {
        self.certainty.confidence
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

    /// Searches with increasing effort, until the confidence is high and no rival of the pose is found.
    ///
    /// # Errors
    /// [`ErrorCode::NoConsensus`](crate::error::ErrorCode::NoConsensus), and those of [`start::begin`].
    pub async fn search(&mut self) -> Result<Searched> {
        let Self { observation, mesh, request: Request { options, efforts, .. }, scheduler, .. } = *self;
        let stages = &mut self.stages;
        if let Some(first) = efforts.first() {
            start::decimate(mesh, first, stages)?;
            scheduler.yield_point().await;
        }
        let mut before: Option<Rounds> = None;
        for (index, settings) in efforts.iter().enumerate() {
            if settings.is_long(1) && mesh.has_one_form(&settings.grids) {
                scheduler.ask_for_help().await;
            }
            let mut rounds = start::begin(observation, mesh, before.as_ref(), options, settings, stages)?;
            scheduler.yield_point().await;
            start::run(&mut rounds, &efforts::share(index, efforts.len()), scheduler, stages).await;
            let concluded = conclusion::conclude(&rounds, None);
            let is_last = index + 1 == efforts.len();
            let is_sure = matches!(&concluded, Ok((_, certainty)) if certainty.confidence >= SURE);
            if is_last || is_sure {
                let (solution, certainty) = concluded?;
                let look = start::rival_search(&rounds).filter(|_| !is_last);
                let mut has_rival = false;
                if let Some(mut look) = look {
                    let share = efforts::share(index + 1, efforts.len() + 1);
                    start::run(&mut look, &share, scheduler, stages).await;
                    has_rival = start::has_rival(&mut rounds, &look);
                }
                if !has_rival {
                    return Ok(Searched { rounds, solution, certainty });
                }
            }
            before = Some(rounds);
        }
        Err(precise::no_candidate())
    }

    /// Searches among the poses that another search of the object has found, with its
    /// surroundings since.
    ///
    /// # Errors
    /// As [`Search::search`].
    pub async fn search_among(&mut self, start: WarmStart<'_>) -> Result<Searched> {
        let given = start.findings;
        let mut rounds = self.among(start, None)?;
        self.scheduler.yield_point().await;
        start::run(&mut rounds, &efforts::share(0, 1), self.scheduler, &mut self.stages).await;
        let mut searched = Searched::new(rounds)?;
        if searched.confidence() < given.confidence - DOUBT && searched.rounds.prefer(&given.found) {
            searched = Searched::new(searched.rounds)?;
        }
        let is_contradicted = searched.confidence() < CONTRADICTION * given.confidence;
        if is_contradicted || leaves_image(given, &searched.rounds) {
            // Tables, undersides and neighbours are as inaccurate as the object: what its image shows, wins.
            let alone = WarmStart { findings: given, surroundings: Neighbourhood::default() };
            searched = Searched::new(self.among(alone, Some(&searched.rounds))?)?;
        }
        Ok(searched)
    }

    /// The search among given poses, before its first round; `before` is an earlier one of the same object.
    fn among(&mut self, start: WarmStart<'_>, before: Option<&Rounds>) -> Result<Rounds> {
        let Request { options, efforts, .. } = self.request;
        let settings = efforts.iter().find(|settings| settings.effort == start.findings.effort);
        let settings = settings.ok_or_else(precise::no_candidate)?.again(start.findings.is_sure());
        let clean = before.map(|rounds| rounds.search.observation.clone());
        start::resume(self.observation, self.mesh, clean, start, options, &settings, &mut self.stages)
    }

    /// The verdict of the photo on the poses; `None` without a photo, or without colours of the mesh.
    pub async fn colors(&self, searched: &Searched) -> Option<Judgment> {
        let (photo, colors) = (self.observation.photo()?, self.mesh.colors()?);
        Some(judgment(&searched.rounds, photo, colors, self.scheduler).await)
    }

    /// The result, with its metrics.
    ///
    /// # Errors
    /// [`ErrorCode::NoConsensus`](crate::error::ErrorCode::NoConsensus).
    pub fn finish(mut self, mut clouds: Clouds, searched: Searched, colors: Option<&Judgment>) -> Result<Alignment> {
        let Searched { rounds, solution, certainty } = searched;
        let (solution, mut certainty) = match colors {
            Some(judgment) => conclusion::conclude(&rounds, Some(judgment))?,
            None => (solution, certainty),
        };
        let Self { observation, mesh, request: Request { setup, options, .. }, .. } = self;
        certainty.confidence *= certainty_of_relief(observation.relief_deviation());
        let mut metrics = score(observation, mesh.mesh(), setup, &mut clouds, &solution, &mut self.stages)?;
        if let Some(metrics) = &mut metrics {
            let (clean, pose) = (rounds.search.observation.clone(), &solution.camera_from_mesh);
            metrics.color_agreement = agreement(observation, Some(clean), mesh, pose);
        }
        let search = &rounds.search;
        let pose = CropPose::of_similarity(&solution.camera_from_mesh, &search.mesh.frame);
        let proportions = pose.and_then(|pose| stretch(search, mesh.mesh(), &pose, options.proportions));
        let mut outcome = outcome(observation, setup, &clouds, &solution, metrics, self.stages);
        outcome.warnings.extend(about_mesh(&mesh.left_out()));
        Ok(Alignment { proportions, ..with_certainty(outcome, certainty, search.renders) })
    }
}

/// Whether the surroundings have moved the pose that the object has alone farther than its image allows.
fn leaves_image(given: &Findings, rounds: &Rounds) -> bool {
    let (Some(alone), Some(now)) = (given.found.first(), rounds.found.first()) else { return false };
    let search = &rounds.search;
    let loss = search.by_image(&alone.score) - search.by_image(&now.score);
    let turn = search.equivalence.angle(alone.pose.rotation, now.pose.rotation);
    turn < DIFFERENT && f64::from(loss) > MOST_LOSS
}

fn with_certainty(outcome: Outcome, certainty: Certainty, renders: usize) -> Alignment {
    let Certainty { confidence, turn_confidence, alternatives, uncertainty, score, terms, effort, color } = certainty;
    let Outcome { camera_from_mesh, metrics, mut warnings, diagnostics: common, points } = outcome;
    let [target_points, source_points] = points;
    let counts = SearchCounts { source_points, target_points, renders };
    warnings.extend(about_search(common.converged));
    warnings.extend(about_fit(&terms));
    retain_doubts(&mut warnings, confidence);
    let diagnostics = PreciseDiagnostics { common, counts, effort, score, terms, color };
    Alignment {
        camera_from_mesh,
        confidence,
        turn_confidence,
        alternatives,
        uncertainty,
        proportions: None,
        metrics,
        warnings,
        diagnostics,
    }
}
