//! The start of a search: from the rotation grid, from the candidates of an earlier search, or for rivals of its best pose.

use core::ops::Range;
use std::rc::Rc;

use serde::{Deserialize, Serialize};

use super::problem::Search;
use super::ranking::Candidate;
use super::recipe::{SURE, SearchSettings};
use super::rounds::{RIVAL_MIN_ANGLE_RAD, Rounds};
use crate::error::{Error, ErrorCode, Result};
use crate::evidence::observation::{Observation, degenerate_mask};
use crate::geometry::rotations::super_fibonacci;
use crate::geometry::similarity::Similarity;
use crate::metrics::symmetry::Symmetry;
use crate::precise::drawing::equivalence::DISTINCT_MIN_ANGLE_RAD;
use crate::precise::drawing::mesh_pyramid::MeshPyramid;
use crate::precise::drawing::pose::{CropPose, MeshFrame};
use crate::precise::drawing::prepared_mesh::PreparedMesh;
use crate::precise::no_candidate;
use crate::precise::observation::clean::CleanObservation;
use crate::precise::options::{AlignOptions, Quality, SearchScope};
use crate::precise::scoring::prior::Prior;
use crate::precise::scoring::scene_term::{SceneContext, SceneTerm};
use crate::progress::{Stage, Stopwatch};
use crate::report::Effort;
use crate::scheduler::{Boxed, Scheduler, boxed};

/// Score below that of the best pose down to which a pose is its rival.
const RIVAL_MAX_SCORE_LOSS: f32 = 0.05;

/// Number of poses that are put down on the ground.
const MAX_GROUNDED_CANDIDATES: usize = 4;

/// A search before its first round. The poses that a `previous` search has found are added to the candidates of the grid.
///
/// # Errors
/// [`ErrorCode::NoConsensus`] if decimation leaves no triangle, [`ErrorCode::InvalidOption`] for an initial pose
/// behind the camera, [`ErrorCode::DegenerateMask`] for a mask thinner than the cells of the search.
pub fn start_search(
    observation: &Observation,
    mesh: &PreparedMesh<'_>,
    previous: Option<&Rounds>,
    options: &AlignOptions,
    settings: &SearchSettings,
    stages: &mut Stopwatch<'_>,
) -> Result<Rounds> {
    let clean = previous.map(|rounds| rounds.search.observation.clone());
    let search = prepare_search(observation, clean, mesh, options, settings, stages)?;
    let initial = options.initial.map(|pose| seen_from(&pose, &search.mesh.frame, INITIAL)).transpose()?;
    let mut rounds = Rounds::new(search, initial, options.search == SearchScope::Global);
    if !rounds.shows_mask() {
        return Err(degenerate_mask(format!("{} pixels in a line, or apart", rounds.search.observation.pixels)));
    }
    if let Some(previous) = previous {
        if options.search == SearchScope::Global {
            rounds.keep_promising_rotations(previous);
        }
        rounds.search.renders += previous.search.renders;
        rounds.add_candidates(&previous.candidates);
    }
    stages.enter(Stage::Search);
    Ok(rounds)
}

/// A search for rivals of the best pose of another search, if that is contested: from rotations between those of its grid,
/// far from the pose.
pub fn rival_search(rounds: &Rounds) -> Option<Rounds> {
    let best = rounds.candidates.first().filter(|_| rounds.is_contested())?;
    let search = &rounds.search;
    let again = search.for_rivals();
    let count = again.settings.rotations();
    let rotations = (0..count).map(|i| super_fibonacci(i, count));
    let rotations = rotations
        .filter(|rotation| search.equivalence.angle(best.pose.rotation, *rotation) > RIVAL_MIN_ANGLE_RAD)
        .collect();
    let mut rival_rounds = Rounds::from_rotations(again, rotations);
    rival_rounds.add_poses([best.pose]);
    Some(rival_rounds)
}

/// Adds the rivals that a search for them has found to the candidates: poses that explain the image about as well as the
/// best one. Returns whether there are any, or the best pose was not found again.
pub fn take_rivals(rounds: &mut Rounds, rival_rounds: &Rounds) -> bool {
    rounds.search.renders += rival_rounds.search.renders;
    let Some(best) = rounds.candidates.first().copied() else { return false };
    let angle =
        |candidate: &Candidate| rival_rounds.search.equivalence.angle(best.pose.rotation, candidate.pose.rotation);
    let Some(own) = rival_rounds.candidates.iter().find(|candidate| angle(candidate) <= DISTINCT_MIN_ANGLE_RAD) else {
        return true;
    };
    let is_rival = |candidate: &&Candidate| {
        angle(candidate) > DISTINCT_MIN_ANGLE_RAD && candidate.score.total > own.score.total - RIVAL_MAX_SCORE_LOSS
    };
    let rivals: Vec<Candidate> = rival_rounds.candidates.iter().filter(is_rival).copied().collect();
    rounds.candidates.extend(&rivals);
    !rivals.is_empty()
}

/// The state in which a search of an object ended, from which a later one starts.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct SearchState {
    /// The poses, best first.
    pub candidates: Vec<Candidate>,
    /// Its effort.
    pub effort: Effort,
    /// Number of images that it drew.
    pub renders: usize,
    /// The probability that the best pose is right.
    pub confidence: f64,
}

impl SearchState {
    /// Whether the search was sure of its best pose.
    pub fn is_sure(&self) -> bool {
        self.confidence >= SURE
    }
}

/// The start of a later search of the same object.
pub struct WarmStart<'a> {
    /// The results of the earlier one.
    pub earlier: &'a SearchState,
    /// The scene around the object, where it has become known since.
    pub context: SceneContext,
}

/// A search among the poses that another one has found, with the scene around the object. Without
/// a scene, the result is that of the other search. If that was not sure, the rotations in which the mesh stands on
/// the ground are searched as well. `clean` is the observation, where it has been cleaned already.
///
/// # Errors
/// As [`start_search`].
pub fn restart_search(
    observation: &Observation,
    mesh: &PreparedMesh<'_>,
    clean: Option<Rc<CleanObservation>>,
    WarmStart { earlier, context }: WarmStart<'_>,
    options: &AlignOptions,
    settings: &SearchSettings,
    stages: &mut Stopwatch<'_>,
) -> Result<Rounds> {
    let mut search = prepare_search(observation, clean, mesh, options, settings, stages)?;
    let SearchState { candidates, renders, .. } = earlier;
    search.renders = *renders;
    if context.is_empty() {
        return Ok(Rounds::finished(search, candidates.clone()));
    }
    let scene = SceneTerm::new(context, &search.mesh, &search.observation);
    let put_down: Vec<CropPose> =
        candidates.iter().take(MAX_GROUNDED_CANDIDATES).flat_map(|candidate| scene.put_down(&candidate.pose)).collect();
    // Where the search was unsure, the ground leaves few rotations.
    let standing =
        if earlier.is_sure() || options.search == SearchScope::Local { Vec::new() } else { scene.standing() };
    search.set_scene_term(scene);
    let mut rounds =
        if standing.is_empty() { Rounds::new(search, None, false) } else { Rounds::from_rotations(search, standing) };
    rounds.add_candidates(candidates);
    rounds.add_poses(put_down);
    stages.enter(Stage::Search);
    Ok(rounds)
}

/// A search with its prior, prepared.
pub fn prepare_search(
    observation: &Observation,
    clean: Option<Rc<CleanObservation>>,
    mesh: &PreparedMesh<'_>,
    options: &AlignOptions,
    settings: &SearchSettings,
    stages: &mut Stopwatch<'_>,
) -> Result<Search> {
    let pyramid = decimate(mesh, settings, stages)?;
    let clean = clean.unwrap_or_else(|| Rc::new(CleanObservation::new(observation)));
    let mut search = Search::new(clean, pyramid, *settings);
    search.assume(Prior::of(options, mesh.mesh(), &search.mesh.frame));
    search.equivalence = search.mesh.equivalence(&options.symmetry)?;
    Ok(search)
}

/// Validates a mesh, and prepares it for the first search of the default quality: its forms, its decimations, and its
/// symmetry.
///
/// # Errors
/// [`DegenerateMesh`](ErrorCode::DegenerateMesh).
pub fn prepare_mesh(mesh: &PreparedMesh<'_>) -> Result<()> {
    mesh.check()?;
    if let Some(&first) = Quality::default().efforts().first() {
        let SearchSettings { grids, .. } = first.into();
        for mesh in core::iter::once(mesh).chain(mesh.without_plate(&grids)) {
            mesh.pyramid(&grids).map(|pyramid| pyramid.equivalence(&Symmetry::Auto)).transpose()?;
        }
    }
    Ok(())
}

/// Decimates the mesh for a search, if it is not yet.
///
/// # Errors
/// [`ErrorCode::NoConsensus`] if decimation leaves no triangle.
pub fn decimate(
    mesh: &PreparedMesh<'_>,
    settings: &SearchSettings,
    stages: &mut Stopwatch<'_>,
) -> Result<Rc<MeshPyramid>> {
    if stages.running() != Some(Stage::Prepare) {
        stages.enter(Stage::Prepare);
    }
    mesh.pyramid(&settings.grids).ok_or_else(no_candidate)
}

/// Runs a search to its end. `share` is the progress at its start and end, 0 to 1.
pub fn run_rounds<'a>(
    rounds: &'a mut Rounds,
    share: Range<f64>,
    scheduler: &'a Scheduler,
    stages: &'a mut Stopwatch<'_>,
) -> Boxed<'a, ()> {
    boxed(async move {
        while let Some(round) = rounds.round() {
            if !round.task.is_on_rotation_grid() && stages.running() != Some(Stage::Refine) {
                stages.enter(Stage::Refine);
            }
            rounds.run(scheduler).await;
            stages.reach(share.start + (share.end - share.start) * round.done, rounds.best());
        }
    })
}

/// The error of an initial pose, which callers may have in another camera frame.
const INITIAL: (ErrorCode, &str) = (ErrorCode::InvalidOption, "options.initial");

/// A pose of the caller. `code` and `argument` are those of its error.
///
/// # Errors
/// For a pose with the centre of the mesh behind the camera.
pub fn seen_from(
    pose: &Similarity,
    frame: &MeshFrame,
    (code, argument): (ErrorCode, &'static str),
) -> Result<CropPose> {
    CropPose::of_similarity(pose, frame).ok_or_else(|| {
        Error::new(
            code,
            argument,
            "a pose with the centre of the mesh behind the camera",
            "a pose in front of the camera: z forward",
            "Convert the pose from its own camera frame (OpenGL: negate y and z; PyTorch3D: negate x and y).",
        )
    })
}
