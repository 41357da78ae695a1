//! Start: a search from the rotation grid, from the poses of another search, or for rivals of its best pose.

use core::ops::Range;
use std::rc::Rc;

use serde::{Deserialize, Serialize};

use super::problem::Search;
use super::ranking::Found;
use super::recipe::{SURE, SearchSettings};
use super::rounds::{ELSEWHERE, Rounds};
use crate::error::{Error, ErrorCode, Result};
use crate::evidence::observation::{Observation, degenerate_mask};
use crate::geometry::rotations::super_fibonacci;
use crate::geometry::similarity::Similarity;
use crate::metrics::symmetry::Symmetry;
use crate::precise::drawing::equivalence::DIFFERENT;
use crate::precise::drawing::mesh_pyramid::MeshPyramid;
use crate::precise::drawing::pose::{CropPose, MeshFrame};
use crate::precise::drawing::prepared_mesh::PreparedMesh;
use crate::precise::no_candidate;
use crate::precise::observation::clean::CleanObservation;
use crate::precise::options::{AlignOptions, Quality, SearchScope};
use crate::precise::scoring::prior::Prior;
use crate::precise::scoring::surroundings::{Neighbourhood, Surroundings};
use crate::progress::{Stage, Stopwatch};
use crate::report::Effort;
use crate::scheduler::Scheduler;

/// Score below that of the best pose down to which a pose is its rival.
const RIVAL: f32 = 0.05;

/// Number of poses that are put down on the ground.
const PUT_DOWN: usize = 4;

/// A search before its first round. The poses that a `previous` search has found are added to the candidates of the grid.
///
/// # Errors
/// [`ErrorCode::NoConsensus`] if decimation leaves no triangle, [`ErrorCode::InvalidOption`] for an initial pose
/// behind the camera, [`ErrorCode::DegenerateMask`] for a mask thinner than the cells of the search.
pub fn begin(
    observation: &Observation,
    mesh: &PreparedMesh<'_>,
    previous: Option<&Rounds>,
    options: &AlignOptions,
    settings: &SearchSettings,
    stages: &mut Stopwatch<'_>,
) -> Result<Rounds> {
    let clean = previous.map(|rounds| rounds.search.observation.clone());
    let search = prepared(observation, clean, mesh, options, settings, stages)?;
    let initial = options.initial.map(|pose| seen_from(&pose, &search.mesh.frame, INITIAL)).transpose()?;
    let mut rounds = Rounds::new(search, initial, options.search == SearchScope::Global);
    if !rounds.shows_mask() {
        return Err(degenerate_mask(format!("{} pixels in a line, or apart", rounds.search.observation.pixels)));
    }
    if let Some(previous) = previous {
        if options.search == SearchScope::Global {
            rounds.follow(previous);
        }
        rounds.search.renders += previous.search.renders;
        rounds.resume(&previous.found);
    }
    stages.enter(Stage::Search);
    Ok(rounds)
}

/// A search for rivals of the best pose of another search, if that is contested: from rotations between those of its grid,
/// far from the pose.
pub fn rival_search(rounds: &Rounds) -> Option<Rounds> {
    let best = rounds.found.first().filter(|_| rounds.is_contested())?;
    let search = &rounds.search;
    let again = search.for_rivals();
    let count = again.settings.rotations();
    let rotations = (0..count).map(|i| super_fibonacci(i, count));
    let rotations =
        rotations.filter(|rotation| search.equivalence.angle(best.pose.rotation, *rotation) > ELSEWHERE).collect();
    let mut look = Rounds::among(again, rotations);
    look.propose([best.pose]);
    Some(look)
}

/// Whether a search for rivals has found a pose that explains the image about as well as the best one of a search. It is then added to
/// those of the search.
pub fn has_rival(rounds: &mut Rounds, look: &Rounds) -> bool {
    rounds.search.renders += look.search.renders;
    let Some(best) = rounds.found.first().copied() else { return false };
    let angle = |found: &Found| look.search.equivalence.angle(best.pose.rotation, found.pose.rotation);
    let Some(own) = look.found.iter().find(|found| angle(found) <= DIFFERENT) else { return true };
    let is_rival = |found: &&Found| angle(found) > DIFFERENT && found.score.total > own.score.total - RIVAL;
    let rivals: Vec<Found> = look.found.iter().filter(is_rival).copied().collect();
    rounds.found.extend(&rivals);
    !rivals.is_empty()
}

/// The results of a search, for a later one of the same object.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct Findings {
    /// The poses, best first.
    pub found: Vec<Found>,
    /// Its effort.
    pub effort: Effort,
    /// Number of images that it drew.
    pub renders: usize,
    /// The probability that the best pose is right.
    pub confidence: f64,
}

impl Findings {
    /// Whether the search was sure of its best pose.
    pub fn is_sure(&self) -> bool {
        self.confidence >= SURE
    }
}

/// The start of a later search of the same object.
pub struct WarmStart<'a> {
    /// The results of the earlier one.
    pub findings: &'a Findings,
    /// The surroundings of the object, where they have become known since.
    pub surroundings: Neighbourhood,
}

/// A search among the poses that another one has found, with the surroundings of the object. Without
/// surroundings, the result is that of the other search. If that was not sure, the rotations in which the mesh stands on
/// the ground are searched as well. `clean` is the observation, where it has been cleaned already.
///
/// # Errors
/// As [`begin`].
pub fn resume(
    observation: &Observation,
    mesh: &PreparedMesh<'_>,
    clean: Option<Rc<CleanObservation>>,
    WarmStart { findings, surroundings: known }: WarmStart<'_>,
    options: &AlignOptions,
    settings: &SearchSettings,
    stages: &mut Stopwatch<'_>,
) -> Result<Rounds> {
    let mut search = prepared(observation, clean, mesh, options, settings, stages)?;
    let Findings { found, renders, .. } = findings;
    search.renders = *renders;
    if known.is_empty() {
        return Ok(Rounds::ended(search, found.clone()));
    }
    let surroundings = Surroundings::new(known, &search.mesh, &search.observation);
    let put_down: Vec<CropPose> = found.iter().take(PUT_DOWN).flat_map(|f| surroundings.put_down(&f.pose)).collect();
    // Where the search was unsure, the ground leaves few rotations.
    let standing =
        if findings.is_sure() || options.search == SearchScope::Local { Vec::new() } else { surroundings.standing() };
    search.surround(surroundings);
    let mut rounds =
        if standing.is_empty() { Rounds::new(search, None, false) } else { Rounds::among(search, standing) };
    rounds.resume(found);
    rounds.propose(put_down);
    stages.enter(Stage::Search);
    Ok(rounds)
}

/// A search with its prior, prepared.
pub fn prepared(
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
pub fn prepare(mesh: &PreparedMesh<'_>) -> Result<()> {
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
pub async fn run(rounds: &mut Rounds, share: &Range<f64>, scheduler: &Scheduler, stages: &mut Stopwatch<'_>) {
    while let Some(round) = rounds.round() {
        if !round.task.is_on_rotation_grid() && stages.running() != Some(Stage::Refine) {
            stages.enter(Stage::Refine);
        }
        rounds.run(scheduler).await;
        stages.reach(share.start + (share.end - share.start) * round.done, rounds.best());
    }
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
