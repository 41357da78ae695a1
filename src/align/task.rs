//! An alignment by search that runs in steps, so that a thread can do other work between them.
//!
//! A step ends as soon as possible after the caller requests a pause: in the search after any render or refinement of a
//! pose, elsewhere at the end of a stage. Results are bit-identical regardless of pauses.

use core::borrow::Borrow;
use core::mem::replace;

use super::outcome::{Setup, report, score};
use super::warnings::about_fit;
use crate::error::{Error, ErrorCode, Result};
use crate::evidence::Normals;
use crate::evidence::clouds::Clouds;
use crate::evidence::observation::Observation;
use crate::precise;
use crate::precise::color::{ColorStage, agreement};
use crate::precise::options::AlignOptions;
use crate::precise::prepared_mesh::PreparedMesh;
use crate::precise::recipe::SURE;
use crate::precise::rounds::Rounds;
use crate::precise::{Certainty, SearchSettings};
use crate::progress::{Host, Stopwatch};
use crate::report::{Alignment, PaperAlignment, PreciseDiagnostics, Solution};

/// An alignment in steps. It owns or borrows its observation and mesh.
pub struct AlignTask<'h, O, M> {
    observation: O,
    mesh: M,
    options: AlignOptions,
    efforts: Vec<SearchSettings>,
    setup: Setup,
    stages: Option<Stopwatch<'h>>,
    state: State,
}

/// The progress of the task.
enum State {
    /// Nothing.
    Begun,
    /// Both clouds are sampled.
    Drawn(Box<Clouds>),
    /// Their normals are estimated, if the metrics need them.
    Ready(Box<Clouds>),
    /// The search with the effort of this index is running.
    Searching(Box<Clouds>, Box<Rounds>, usize),
    /// The poses that the last search has left are compared with the photo.
    Comparing(Box<Clouds>, Box<Rounds>, Box<ColorStage>),
    /// The search has found a pose.
    Found(Box<Clouds>, Box<Solution>, Box<Certainty>),
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
        Ok(Self { observation, mesh, options, efforts, setup, stages, state: State::Begun })
    }

    /// Overrides the settings of the searches that follow from the options, for ablations.
    pub fn with_efforts(self, efforts: Vec<SearchSettings>) -> Self {
        Self { efforts, ..self }
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
            self.state = match replace(&mut self.state, State::Over) {
                State::Searching(clouds, mut rounds, effort) => {
                    let share = precise::share(effort, self.efforts.len());
                    if !precise::run(&mut rounds, &share, pause, &mut stages) {
                        self.state = State::Searching(clouds, rounds, effort);
                        self.stages = Some(stages);
                        return Ok(None);
                    }
                    self.advance(State::Searching(clouds, rounds, effort), &mut stages)?
                }
                State::Comparing(clouds, rounds, mut stage) => {
                    let colors = self.mesh.borrow().colors();
                    if colors.is_some_and(|colors| !stage.run(&rounds, colors, pause)) {
                        self.state = State::Comparing(clouds, rounds, stage);
                        self.stages = Some(stages);
                        return Ok(None);
                    }
                    self.advance(State::Comparing(clouds, rounds, stage), &mut stages)?
                }
                State::Found(mut clouds, solution, certainty) => {
                    let (observation, mesh) = (self.observation.borrow(), self.mesh.borrow().mesh());
                    let mut metrics = score(observation, mesh, &self.setup, &mut clouds, &solution, &mut stages)?;
                    if let Some(metrics) = &mut metrics {
                        let pose = &solution.camera_from_mesh;
                        metrics.color_agreement = agreement(observation, self.mesh.borrow(), pose);
                    }
                    let aligned = report(observation, &self.setup, &clouds, &solution, metrics, stages);
                    return Ok(Some(with_certainty(aligned, *certainty)));
                }
                state => self.advance(state, &mut stages)?,
            };
            if pause() {
                self.stages = Some(stages);
                return Ok(None);
            }
        }
    }

    /// Runs one stage.
    fn advance(&self, state: State, stages: &mut Stopwatch<'h>) -> Result<State> {
        let (observation, mesh) = (self.observation.borrow(), self.mesh.borrow());
        Ok(match state {
            State::Begun => {
                mesh.check()?;
                State::Drawn(Box::new(Clouds::new(observation, mesh.mesh(), &self.setup.sampling, stages)?))
            }
            State::Drawn(mut clouds) => {
                if self.setup.metrics {
                    clouds.evidence(Normals::Some, stages);
                }
                State::Ready(clouds)
            }
            State::Ready(clouds) => self.search(clouds, 0, None, stages)?,
            State::Searching(clouds, rounds, effort) => {
                let concluded = precise::conclude(&rounds, mesh.mesh(), &self.options, None);
                let is_sure = matches!(&concluded, Ok((_, certainty)) if certainty.confidence >= SURE);
                if !is_sure && effort + 1 < self.efforts.len() {
                    return self.search(clouds, effort + 1, Some(&rounds), stages);
                }
                let (solution, certainty) = concluded?;
                match observation.photo().filter(|_| mesh.colors().is_some()) {
                    Some(photo) => {
                        let stage = ColorStage::new(&rounds, photo);
                        State::Comparing(clouds, rounds, Box::new(stage))
                    }
                    None => State::Found(clouds, Box::new(solution), Box::new(certainty)),
                }
            }
            State::Comparing(clouds, rounds, stage) => {
                let judgment = mesh.colors().map(|colors| stage.judge(&rounds, colors));
                let (solution, certainty) = precise::conclude(&rounds, mesh.mesh(), &self.options, judgment.as_ref())?;
                State::Found(clouds, Box::new(solution), Box::new(certainty))
            }
            State::Found(..) | State::Over => return Err(over()),
        })
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

fn with_certainty(aligned: PaperAlignment, certainty: Certainty) -> Alignment {
    let Certainty { confidence, alternatives, uncertainty, score, terms, effort, color } = certainty;
    let PaperAlignment { camera_from_mesh, metrics, mut warnings, diagnostics } = aligned;
    warnings.extend(about_fit(&terms));
    let diagnostics = PreciseDiagnostics { common: diagnostics, effort, score, terms, color };
    Alignment { camera_from_mesh, confidence, alternatives, uncertainty, metrics, warnings, diagnostics }
}

fn over() -> Error {
    Error::new(ErrorCode::Internal, "task", "a finished task", "a running task", "Create another task.")
}
