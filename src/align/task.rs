//! An alignment by search that runs in steps, so that a thread can do other work between them.
//!
//! A step ends as soon as possible after the caller requests a pause: in the search after any render or refinement of a
//! pose, elsewhere at the end of a stage. Results are bit-identical regardless of pauses.

use core::borrow::Borrow;
use core::mem::replace;
use std::rc::Rc;

use super::outcome::{Setup, report, score};
use super::warnings::{about_fit, about_search, retain_doubts};
use crate::error::{Error, ErrorCode, Result};
use crate::evidence::Normals;
use crate::evidence::clouds::Clouds;
use crate::evidence::observation::Observation;
use crate::evidence::photo::Photo;
use crate::precise;
use crate::precise::clean::CleanObservation;
use crate::precise::color::{ColorStage, agreement};
use crate::precise::conditioning::DROP;
use crate::precise::equivalence::DIFFERENT;
use crate::precise::options::AlignOptions;
use crate::precise::prepared_mesh::PreparedMesh;
use crate::precise::recipe::SURE;
use crate::precise::rounds::Rounds;
use crate::precise::surroundings::Neighbourhood;
use crate::precise::{Certainty, Found, Resume, SearchSettings, Told};
use crate::progress::{Host, Stopwatch};
use crate::report::{Alignment, Effort, PaperAlignment, PreciseDiagnostics, Solution};

/// An alignment in steps. It owns or borrows its observation and mesh.
pub struct AlignTask<'h, O, M> {
    observation: O,
    mesh: M,
    options: AlignOptions,
    efforts: Vec<SearchSettings>,
    /// What it is given, and the search that begins with it. A module that gives its tasks nothing does not contain the
    /// search.
    given: Option<(Given, Resume)>,
    /// Whether the searches end with the choice of the photo.
    chooses: bool,
    setup: Setup,
    stages: Option<Stopwatch<'h>>,
    state: State,
}

/// What another alignment of the same input has found, and what has become known of its surroundings since.
#[derive(Debug, Clone, Default)]
pub struct Given {
    /// The poses, best first.
    pub found: Vec<Found>,
    /// The effort of the search that found them.
    pub effort: Effort,
    /// Number of images that it drew.
    pub renders: usize,
    /// The probability that the best pose is right.
    pub confidence: f64,
    /// The surroundings.
    pub known: Neighbourhood,
}

/// Loss of confidence beyond which the surroundings do not choose another pose than the object alone.
const DOUBT: f64 = 0.05;
/// Share of the confidence below which the surroundings contradict what an object alone shows.
const CONTRADICTION: f64 = 0.75;
/// Loss of the score of the image, at about the same rotation, with the same meaning: two standard deviations.
const MOST_LOSS: f64 = 4.0 * DROP;

/// The progress of the task.
enum State {
    /// Nothing.
    Begun,
    /// The mesh is checked.
    Checked,
    /// Both clouds are sampled.
    Drawn(Box<Clouds>),
    /// Their normals are estimated, if the metrics need them.
    Ready(Box<Clouds>),
    /// The mesh of the first search is decimated.
    Decimated(Box<Clouds>),
    /// The search among given poses is running.
    Resumed(Box<Clouds>, Box<Rounds>),
    /// The search with the effort of this index is running.
    Searching(Box<Clouds>, Box<Rounds>, usize),
    /// The search with the effort of this index is sure of its pose, and rivals of it are looked for.
    Doubting(Box<Clouds>, Box<Rounds>, Box<(Solution, Certainty)>, Box<Rounds>, usize),
    /// The searches have ended.
    Searched(Box<Clouds>, Box<Rounds>, Box<(Solution, Certainty)>),
    /// The poses that the searches have left are compared with the photo.
    Comparing(Box<Clouds>, Box<Rounds>, Box<(Solution, Certainty)>, Box<ColorStage>),
    /// The photo has put its choice first, and the task ends with that.
    Chosen(Box<Rounds>, Box<(Solution, Certainty)>),
    /// The search has found a pose.
    Found(Box<Clouds>, Rc<CleanObservation>, Box<Solution>, Box<Certainty>),
    /// The result has been returned, or an error.
    Over,
}

impl<'h, 'm, O: Borrow<Observation>, M: Borrow<PreparedMesh<'m>>> AlignTask<'h, O, M> {
    /// Creates a task. Validates the options.
    ///
    /// # Errors
    /// [`ErrorCode::InvalidOption`].
    pub fn new(observation: O, mesh: M, options: AlignOptions, host: impl Host + 'h) -> Result<Self> {
        let (setup, efforts) = (Setup::of_precise(&options)?, precise::efforts(&options));
        let stages = Some(Stopwatch::new(host, precise::PLAN));
        Ok(Self {
            observation,
            mesh,
            options,
            efforts,
            given: None,
            chooses: false,
            setup,
            stages,
            state: State::Begun,
        })
    }

    /// Overrides the settings of the searches that follow from the options, for ablations.
    pub fn with_efforts(self, efforts: Vec<SearchSettings>) -> Self {
        Self { efforts, ..self }
    }

    /// Searches among these poses only.
    pub fn with_given(self, given: Given) -> Self {
        Self { given: Some((given, precise::resume)), ..self }
    }

    /// Ends the searches with the pose that the photo chooses, if there is one.
    pub fn with_choice(self) -> Self {
        Self { chooses: true, ..self }
    }

    /// Continues until the searches have ended, or until `pause` returns true. Returns whether they have ended.
    ///
    /// # Errors
    /// As [`AlignTask::step`].
    pub fn step_search(&mut self, pause: &mut dyn FnMut() -> bool) -> Result<bool> {
        let Some(mut stages) = self.stages.take() else { return Err(over()) };
        while !self.has_searched() {
            if matches!(self.state, State::Found(..)) {
                return Err(over());
            }
            let is_paused = !self.advance_by(pause, &mut stages)? || pause();
            if is_paused && !self.has_searched() {
                self.stages = Some(stages);
                return Ok(false);
            }
        }
        self.stages = Some(stages);
        Ok(true)
    }

    fn has_searched(&self) -> bool {
        match self.state {
            State::Searched(..) => !self.chooses || self.photo().is_none(),
            State::Chosen(..) => true,
            _ => false,
        }
    }

    /// The photo, if the colours of the mesh are known as well.
    fn photo(&self) -> Option<&Photo> {
        self.observation.borrow().photo().filter(|_| self.mesh.borrow().colors().is_some())
    }

    /// What the searches have found, and with which confidence of its shape, once they have ended.
    pub fn searched(&self) -> Option<(&Rounds, f64)> {
        match &self.state {
            State::Searched(_, rounds, concluded) | State::Chosen(rounds, concluded) => {
                Some((rounds, concluded.1.confidence))
            }
            _ => None,
        }
    }

    /// The observation.
    pub fn observation(&self) -> &Observation {
        self.observation.borrow()
    }

    /// Runs the task to its end.
    ///
    /// # Errors
    /// As [`AlignTask::step`].
    pub fn finish(mut self) -> Result<Alignment> {
        loop {
            if let Some(alignment) = self.step(&mut || false)? {
                return Ok(alignment);
            }
        }
    }

    /// Continues until the alignment is finished, and returns the result, or until `pause` returns true.
    ///
    /// # Errors
    /// [`ErrorCode::DegenerateMesh`], [`ErrorCode::NoConsensus`]; the task then ends.
    pub fn step(&mut self, pause: &mut dyn FnMut() -> bool) -> Result<Option<Alignment>> {
        let Some(mut stages) = self.stages.take() else { return Err(over()) };
        loop {
            if let State::Found(..) = self.state {
                let State::Found(mut clouds, clean, solution, certainty) = replace(&mut self.state, State::Over) else {
                    return Err(over());
                };
                let (observation, mesh) = (self.observation.borrow(), self.mesh.borrow().mesh());
                let mut metrics = score(observation, mesh, &self.setup, &mut clouds, &solution, &mut stages)?;
                if let Some(metrics) = &mut metrics {
                    let pose = &solution.camera_from_mesh;
                    metrics.color_agreement = agreement(observation, Some(clean), self.mesh.borrow(), pose);
                }
                let aligned = report(observation, &self.setup, &clouds, &solution, metrics, stages);
                return Ok(Some(with_certainty(aligned, *certainty)));
            }
            if !self.advance_by(pause, &mut stages)? || pause() {
                self.stages = Some(stages);
                return Ok(None);
            }
        }
    }

    /// Runs one stage, or a part of it until `pause` returns true. Returns whether the stage has ended.
    fn advance_by(&mut self, pause: &mut dyn FnMut() -> bool, stages: &mut Stopwatch<'h>) -> Result<bool> {
        let mut state = replace(&mut self.state, State::Over);
        let running = match &mut state {
            State::Searching(_, rounds, effort) => Some((rounds, precise::share(*effort, self.efforts.len()))),
            State::Resumed(_, rounds) => Some((rounds, precise::share(0, 1))),
            State::Doubting(.., rounds, effort) => Some((rounds, precise::share(*effort + 1, self.efforts.len() + 1))),
            _ => None,
        };
        if let Some((rounds, share)) = running
            && !precise::run(rounds, &share, pause, stages)
        {
            self.state = state;
            return Ok(false);
        }
        if let State::Comparing(_, rounds, _, stage) = &mut state
            && let Some(colors) = self.mesh.borrow().colors()
            && !stage.run(rounds, colors, pause)
        {
            self.state = state;
            return Ok(false);
        }
        self.state = self.advance(state, stages)?;
        Ok(true)
    }

    /// Runs one stage.
    fn advance(&self, state: State, stages: &mut Stopwatch<'h>) -> Result<State> {
        let (observation, mesh) = (self.observation.borrow(), self.mesh.borrow());
        Ok(match state {
            State::Begun => {
                mesh.check()?;
                State::Checked
            }
            State::Checked => {
                State::Drawn(Box::new(Clouds::new(observation, mesh.mesh(), &self.setup.sampling, stages)?))
            }
            State::Drawn(mut clouds) => {
                if self.setup.metrics {
                    clouds.evidence(Normals::Some, stages);
                }
                State::Ready(clouds)
            }
            State::Ready(clouds) => match &self.given {
                Some((given, resume)) => self.resume(clouds, given, *resume, None, stages)?,
                None => {
                    precise::decimate(mesh, self.efforts.first().ok_or_else(over)?, stages)?;
                    State::Decimated(clouds)
                }
            },
            State::Decimated(clouds) => self.search(clouds, 0, None, stages)?,
            State::Searching(clouds, rounds, effort) => {
                let concluded = precise::conclude(&rounds, None);
                let is_sure = matches!(&concluded, Ok((_, certainty)) if certainty.confidence >= SURE);
                let is_last = effort + 1 == self.efforts.len();
                if !is_sure && !is_last {
                    return self.search(clouds, effort + 1, Some(&rounds), stages);
                }
                let concluded = Box::new(concluded?);
                match precise::look(&rounds).filter(|_| !is_last) {
                    Some(look) => State::Doubting(clouds, rounds, concluded, Box::new(look), effort),
                    None => State::Searched(clouds, rounds, concluded),
                }
            }
            State::Doubting(clouds, mut rounds, concluded, look, effort) => {
                if precise::has_rival(&mut rounds, &look) {
                    return self.search(clouds, effort + 1, Some(&rounds), stages);
                }
                State::Searched(clouds, rounds, concluded)
            }
            State::Resumed(clouds, mut rounds) => {
                let mut concluded = precise::conclude(&rounds, None)?;
                if let Some((given, _)) = &self.given
                    && concluded.1.confidence < given.confidence - DOUBT
                    && rounds.prefer(&given.found)
                {
                    concluded = precise::conclude(&rounds, None)?;
                }
                if let Some((given, resume)) = &self.given
                    && (concluded.1.confidence < CONTRADICTION * given.confidence || leaves_image(given, &rounds))
                {
                    // Tables, undersides and neighbours are as inaccurate as the object: what its image shows, wins.
                    let alone = Given { known: Neighbourhood::default(), ..given.clone() };
                    let clean = rounds.search.observation.clone();
                    let State::Resumed(clouds, rounds) = self.resume(clouds, &alone, *resume, Some(clean), stages)?
                    else {
                        return Err(over());
                    };
                    let concluded = precise::conclude(&rounds, None)?;
                    return Ok(State::Searched(clouds, rounds, Box::new(concluded)));
                }
                State::Searched(clouds, rounds, Box::new(concluded))
            }
            State::Searched(clouds, rounds, concluded) => match self.photo() {
                Some(photo) => {
                    let stage = ColorStage::new(&rounds, photo);
                    State::Comparing(clouds, rounds, concluded, Box::new(stage))
                }
                None => {
                    let (solution, certainty) = *concluded;
                    State::Found(clouds, rounds.search.observation.clone(), Box::new(solution), Box::new(certainty))
                }
            },
            State::Comparing(clouds, mut rounds, concluded, stage) => {
                let judgment = mesh.colors().map(|colors| stage.judge(&rounds, colors));
                if self.chooses {
                    let chosen = judgment.and_then(|judgment| judgment.chosen);
                    chosen.into_iter().for_each(|chosen| rounds.found.insert(0, chosen));
                    return Ok(State::Chosen(rounds, concluded));
                }
                let (solution, certainty) = precise::conclude(&rounds, judgment.as_ref())?;
                State::Found(clouds, rounds.search.observation.clone(), Box::new(solution), Box::new(certainty))
            }
            State::Chosen(..) | State::Found(..) | State::Over => return Err(over()),
        })
    }

    /// Begins the search among given poses.
    fn resume(
        &self,
        clouds: Box<Clouds>,
        given: &Given,
        resume: Resume,
        clean: Option<Rc<CleanObservation>>,
        stages: &mut Stopwatch<'h>,
    ) -> Result<State> {
        let is_sure = given.confidence >= SURE;
        let settings = self.efforts.iter().find(|settings| settings.effort == given.effort).ok_or_else(over)?;
        let settings = settings.again(is_sure);
        let (observation, mesh) = (self.observation.borrow(), self.mesh.borrow());
        let told = Told { found: &given.found, renders: given.renders, is_sure, known: given.known.clone() };
        let rounds = resume(observation, mesh, clean, told, &self.options, &settings, stages)?;
        Ok(State::Resumed(clouds, Box::new(rounds)))
    }

    /// Begins the search with the effort of this index, after the `previous` one, if any.
    fn search(
        &self,
        clouds: Box<Clouds>,
        effort: usize,
        previous: Option<&Rounds>,
        stages: &mut Stopwatch<'h>,
    ) -> Result<State> {
        let settings = self.efforts.get(effort).ok_or_else(over)?;
        let (observation, mesh) = (self.observation.borrow(), self.mesh.borrow());
        let rounds = precise::begin(observation, mesh, previous, &self.options, settings, stages)?;
        Ok(State::Searching(clouds, Box::new(rounds), effort))
    }
}

/// Whether the surroundings have moved the pose that the object has alone farther than its image allows.
fn leaves_image(given: &Given, rounds: &Rounds) -> bool {
    let (Some(alone), Some(now)) = (given.found.first(), rounds.found.first()) else { return false };
    let search = &rounds.search;
    let loss = search.by_image(&alone.score) - search.by_image(&now.score);
    let turn = search.equivalence.angle(alone.pose.rotation, now.pose.rotation);
    turn < DIFFERENT && f64::from(loss) > MOST_LOSS
}

fn with_certainty(aligned: PaperAlignment, certainty: Certainty) -> Alignment {
    let Certainty { confidence, turn_confidence, alternatives, uncertainty, score, terms, effort, color } = certainty;
    let PaperAlignment { camera_from_mesh, metrics, mut warnings, diagnostics } = aligned;
    warnings.extend(about_search(diagnostics.converged));
    warnings.extend(about_fit(&terms));
    retain_doubts(&mut warnings, confidence);
    let diagnostics = PreciseDiagnostics { common: diagnostics, effort, score, terms, color };
    Alignment {
        camera_from_mesh,
        confidence,
        turn_confidence,
        alternatives,
        uncertainty,
        metrics,
        warnings,
        diagnostics,
    }
}

fn over() -> Error {
    Error::new(ErrorCode::Internal, "task", "a finished task", "a running task", "Create another task.")
}
