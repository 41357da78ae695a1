//! Preset `precise`: search by rendering for the pose whose image best explains mask, free space and depth.
//!
//! The search runs coarse to fine on a crop around the mask: a grid of rotations, each with size, position and distance
//! in closed form; refinement of the best distinct ones over all seven parameters; and another refinement of the best
//! of these at full resolution.

pub(crate) mod alternatives;
pub mod anchors;
pub mod appearance;
pub mod ascent;
pub mod choice;
pub mod clean;
pub mod coarse;
pub mod color;
pub mod conditioning;
pub(crate) mod confidence;
pub mod equivalence;
mod fill;
pub mod grid;
mod lanes;
pub mod lookalikes;
pub mod mesh_pyramid;
pub mod objective;
pub mod options;
pub mod pose;
pub mod prepared_mesh;
pub mod prior;
pub mod proportions;
pub mod ranking;
pub mod recipe;
pub mod refine;
pub mod render;
pub mod rests;
pub mod rim;
pub mod rounds;
pub mod score;
pub mod search;
pub mod surroundings;
pub mod thinning;
pub mod turns;

use core::ops::Range;
use std::borrow::Cow;
use std::rc::Rc;

use glam::DVec3;

use crate::error::{Error, ErrorCode, Result};
use crate::evidence::observation::{Observation, degenerate_mask};
use crate::geometry::cloud::Bounds;
use crate::geometry::mesh::Mesh;
use crate::geometry::rotations::super_fibonacci;
use crate::geometry::similarity::Similarity;
use crate::pauses::Pauses;
use crate::precise::options::{AlignOptions, ExtentAxis, SearchScope};
use crate::progress::{Stage, Stopwatch};
use crate::report::{Alternative, ColorReport, Counts, Effort, ScoreTerms, Solution, Uncertainty};
use alternatives::{UNSURE, add_rivals, alternatives};
use clean::CleanObservation;
use color::Judgment;
use confidence::confidence;
use mesh_pyramid::MeshPyramid;
use pose::{CropPose, MeshFrame};
use prepared_mesh::PreparedMesh;
use prior::Prior;
pub use recipe::SearchSettings;
use recipe::{SURE, Task};
use rounds::Rounds;
use score::NOISE;
pub use search::{Found, Search};
use surroundings::{Neighbourhood, Surroundings};

/// Progress at the start of each stage, 0 to 1; from profiles of real cases.
pub const PLAN: &[(Stage, f64)] = &[
    (Stage::Observe, 0.0),
    (Stage::Sample, 0.01),
    (Stage::Normals, 0.02),
    (Stage::Prepare, 0.15),
    (Stage::Search, 0.2),
    (Stage::Metrics, 0.85),
];

/// Rotation from the best pose from which on rivals are looked for, radians.
const ELSEWHERE: f64 = 0.5;
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
    if rounds.shows_no_mask() {
        return Err(degenerate_mask(format!("{} pixels in a line, or apart", rounds.search.observation.pixels)));
    }
    if let Some(previous) = previous {
        rounds.search.renders += previous.search.renders;
        rounds.resume(&previous.found);
    }
    stages.enter(Stage::Search);
    Ok(rounds)
}

/// A look for rivals of the best pose that a search has found: from rotations between those of its grid, far from the pose.
pub fn look(rounds: &Rounds) -> Option<Rounds> {
    let best = rounds.found.first()?;
    let search = &rounds.search;
    let again = search.again(search.settings.look());
    let count = again.settings.rotations();
    let rotations = (0..count).map(|i| super_fibonacci(i, count));
    let rotations =
        rotations.filter(|rotation| search.equivalence.angle(best.pose.rotation, *rotation) > ELSEWHERE).collect();
    let mut look = Rounds::among(again, rotations);
    look.propose([best.pose]);
    Some(look)
}

/// Whether a look has found a pose that explains the image about as well as the best one of a search. It is then added to
/// those of the search.
pub fn has_rival(rounds: &mut Rounds, look: &Rounds) -> bool {
    rounds.search.renders += look.search.renders;
    let Some(best) = rounds.found.first().copied() else { return false };
    let angle = |found: &Found| look.search.equivalence.angle(best.pose.rotation, found.pose.rotation);
    let Some(own) = look.found.iter().find(|found| angle(found) <= equivalence::DIFFERENT) else { return true };
    let is_rival =
        |found: &&Found| angle(found) > equivalence::DIFFERENT && found.score.total > own.score.total - RIVAL;
    let rivals: Vec<Found> = look.found.iter().filter(is_rival).copied().collect();
    rounds.found.extend(&rivals);
    !rivals.is_empty()
}

/// What another search has told.
pub struct Told<'a> {
    /// The poses that it has found, best first.
    pub found: &'a [Found],
    /// The number of its renders.
    pub renders: usize,
    /// Whether it was sure of its best pose.
    pub is_sure: bool,
    /// What is known of the surroundings of the object.
    pub known: Neighbourhood,
}

/// A search among the poses that another one has found, with what is known of the surroundings of the object. Without
/// surroundings, the result is that of the other search. If that was not sure, the rotations in which the mesh stands on
/// the ground are searched as well. `clean` is the observation, where it has been cleaned already.
///
/// # Errors
/// As [`begin`].
pub fn resume(
    observation: &Observation,
    mesh: &PreparedMesh<'_>,
    clean: Option<Rc<CleanObservation>>,
    Told { found, renders, is_sure, known }: Told<'_>,
    options: &AlignOptions,
    settings: &SearchSettings,
    stages: &mut Stopwatch<'_>,
) -> Result<Rounds> {
    let mut search = prepared(observation, clean, mesh, options, settings, stages)?;
    search.renders = renders;
    if known.is_empty() {
        return Ok(Rounds::ended(search, found.to_vec()));
    }
    let surroundings = Surroundings::new(known, &search.mesh, &search.observation);
    let put_down: Vec<CropPose> = found.iter().take(PUT_DOWN).flat_map(|f| surroundings.put_down(&f.pose)).collect();
    // Where the search was unsure, the ground leaves few rotations.
    let standing = if is_sure || options.search == SearchScope::Local { Vec::new() } else { surroundings.standing() };
    search.surround(surroundings);
    let mut rounds =
        if standing.is_empty() { Rounds::new(search, None, false) } else { Rounds::among(search, standing) };
    rounds.resume(found);
    rounds.propose(put_down);
    stages.enter(Stage::Search);
    Ok(rounds)
}

/// A search with its prior, prepared.
fn prepared(
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
    search.assume(prior(options, mesh.mesh(), &search.mesh.frame));
    search.equivalence = search.mesh.equivalence(&options.symmetry)?;
    Ok(search)
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
pub async fn run(rounds: &mut Rounds, share: &Range<f64>, pauses: &Pauses, stages: &mut Stopwatch<'_>) {
    while let Some(round) = rounds.round() {
        let is_refinement = matches!(round.task, Task::Refine | Task::Turn | Task::Fit);
        if is_refinement && stages.running() != Some(Stage::Refine) {
            stages.enter(Stage::Refine);
        }
        rounds.run(pauses).await;
        stages.reach(share.start + (share.end - share.start) * round.done, rounds.best());
    }
}

/// The reliability of the pose.
pub struct Certainty {
    /// See [`Alignment::confidence`](crate::report::Alignment::confidence).
    pub confidence: f64,
    /// See [`Alignment::turn_confidence`](crate::report::Alignment::turn_confidence).
    pub turn_confidence: Option<f64>,
    /// Alternative poses.
    pub alternatives: Vec<Alternative>,
    /// How well each part of the pose is determined.
    pub uncertainty: Option<Uncertainty>,
    /// The score of the pose.
    pub score: f64,
    /// The terms of the score.
    pub terms: ScoreTerms,
    /// The effort of the search that found the pose.
    pub effort: Effort,
    /// What colour contributed, if it was known.
    pub color: Option<ColorReport>,
}

/// The best pose of the search, or the one that colour chose, and its reliability.
///
/// # Errors
/// [`ErrorCode::NoConsensus`] if no pose overlaps the mask.
pub fn conclude(rounds: &Rounds, color: Option<&Judgment>) -> Result<(Solution, Certainty)> {
    let search = &rounds.search;
    let mut found = Cow::Borrowed(&rounds.found);
    if let Some(chosen) = color.and_then(|color| color.chosen) {
        found.to_mut().insert(0, chosen);
    }
    let best = found.first().filter(|best| best.pose.is_finite()).ok_or_else(no_candidate)?;
    let listed = |margin: f32, with_turns: bool| {
        let mut list = alternatives(&found, search, margin);
        let rivals = color.iter().flat_map(|color| &color.rivals).filter(|rival| with_turns || !rival.is_turn);
        add_rivals(&mut list, best, rivals, search);
        list
    };
    // Turns that the symmetry of the shape makes equivalent are alternatives only if colour tells them apart.
    let shows_turns = color.is_some_and(|color| color.is_used);
    let (conditioning, residual_m) = search.conditioning(&best.pose);
    let solution = Solution {
        camera_from_mesh: best.pose.similarity(&search.mesh.frame),
        clamped: search.is_held(&best.pose),
        converged: best.converged,
        residual_m,
        counts: Counts { renders: search.renders, ..Counts::default() },
    };
    // The confidence is fitted to how sharply the image determines a pose. The ground makes every pose sharp, right or
    // wrong; what it tells is which of several poses is the better one.
    let by_image = if search.is_surrounded() { search.conditioning_by_image(&best.pose) } else { conditioning };
    let confidence = confidence(best, &listed(NOISE, false), by_image.as_ref());
    let confidence = confidence * color.map_or(1.0, |color| color.certainty);
    let others = listed(if confidence < SURE { UNSURE } else { NOISE }, shows_turns);
    let certainty = Certainty {
        confidence,
        turn_confidence: color.and_then(|color| color.turn),
        alternatives: others,
        uncertainty: conditioning.map(|c| Uncertainty {
            scale: c.scale,
            rotation_deg: c.rotation.0.to_degrees(),
            rotation_axis: c.rotation.1.to_array(),
            free_axis: search.equivalence.free_axis(best.pose.rotation).map(|axis| axis.to_array()),
            lateral_m: c.lateral_m,
            distance_m: c.distance_m,
        }),
        score: f64::from(best.score.total),
        terms: (&best.score).into(),
        effort: search.settings.effort,
        color: color.map(|color| color.report),
    };
    Ok((solution, certainty))
}

/// The searches for these options, with increasing effort.
pub fn efforts(options: &AlignOptions) -> Vec<SearchSettings> {
    let is_fixed = options.scale.bounds().is_some_and(|[min, max]| min == max) || options.known_extent_m.is_some();
    let efforts = options.quality.efforts().iter();
    let efforts = efforts.map(|&effort| SearchSettings { lock_scale: is_fixed, ..effort.into() });
    match options.work_budget {
        Some(budget) => within(efforts, budget),
        None => efforts.collect(),
    }
}

/// Progress of an alignment at the start and the end of one of `efforts` searches, 0 to 1. The last one, if it is reached,
/// takes most of the time.
pub fn share(effort: usize, efforts: usize) -> Range<f64> {
    const SEARCH: [f64; 2] = [0.2, 0.85];
    const BEFORE: f64 = 0.15;
    let start = SEARCH[0] + BEFORE * effort as f64;
    start..if effort + 1 < efforts { start + BEFORE } else { SEARCH[1] }
}

/// Searches that together stay within a budget: the last one is scaled to what the others leave.
fn within(efforts: impl Iterator<Item = SearchSettings>, budget: f64) -> Vec<SearchSettings> {
    let mut left = budget;
    let mut list: Vec<SearchSettings> = Vec::new();
    for settings in efforts {
        // A remainder that is small relative to the work before it is not worth another search.
        if list.last().is_some_and(|before| left < before.cost()) {
            break;
        }
        list.push(settings);
        left -= settings.cost();
    }
    if let Some(last) = list.last_mut() {
        *last = last.within(left + last.cost());
    }
    list
}

/// The prior on scale and orientation.
pub(crate) fn prior(options: &AlignOptions, mesh: &Mesh, frame: &MeshFrame) -> Prior {
    let extent = Bounds::of(mesh.positions()).map_or(glam::Vec3::ONE, |b| b.extent());
    let side = f64::from(match options.known_extent_axis {
        ExtentAxis::Longest => extent.max_element(),
        ExtentAxis::X => extent.x,
        ExtentAxis::Y => extent.y,
        ExtentAxis::Z => extent.z,
    });
    let known = options.known_extent_m.map(|length| [length / side; 2]);
    let bounds = options.scale.bounds().or(known);
    let direction = |v: [f64; 3]| DVec3::from(v).normalize_or_zero();
    Prior {
        scale: bounds.map(|b| b.map(|s| s * frame.diagonal)),
        up: options.camera_up.zip(options.mesh_up).map(|(camera, mesh)| [direction(camera), direction(mesh)]),
    }
}

/// Where a pose that callers may have in another camera frame was given.
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

pub(crate) fn no_candidate() -> Error {
    Error::new(
        ErrorCode::NoConsensus,
        "mesh",
        "no pose whose silhouette overlaps the mask",
        "a mesh and a mask of the same object",
        "Check that mesh and mask show the same object, and that the camera belongs to the depth map.",
    )
}
