//! Several frames of an object: `alignViews`, and trackers.

use sim3align::track::options::TrackOptions;
use sim3align::track::report::TrackedFrame;
use sim3align::track::tracker::Tracker;
use sim3align::views::options::ViewsOptions;
use sim3align::views::report::ViewsAlignment;
use sim3align::views::{View, align_views};

use super::align::{check_pose, check_probability};
use crate::fuzz::call::{Answer, Call, Checked, finite, typed};
use crate::fuzz::choices::Choices;
use crate::fuzz::meshes::mesh;
use crate::fuzz::options::{options, transform};
use crate::fuzz::views::{Size, frame};
use crate::prelude::*;

/// Most triangles of a mesh, so that a call takes little time.
const MOST_TRIANGLES: usize = 300;

/// Hostile numbers of views, camera poses, masks and photos.
pub fn views(c: &mut Choices) -> Call {
    let changed = if c.once_in(2) { 1 + c.below(3) } else { 0 };
    let mut given: ViewsOptions = options(c, changed, 5000);
    given.quality = if c.once_in(8) { Quality::Auto } else { Quality::Fast };
    let (mesh_words, object) = coloured(c);
    let count = if c.once_in(32) { c.pick(&[0, 16, 64, 65]) } else { c.pick(&[2, 1, 3, 5]) };
    let known = c.pick(&["unknown", "at rest", "any", "some"]);
    // Many views are the same few, so that a call takes little time.
    let few: Vec<(String, Result<Frame>)> = (0..count.min(5)).map(|_| frame(c, Size::Small)).collect();
    let mut words = format!("{count} views, camera poses {known}");
    let mut views = Vec::new();
    for k in 0..count {
        let (frame_words, frame) = &few[k % few.len()];
        if k < few.len() {
            words += &format!("; {frame_words}");
        }
        let pose = match known {
            "unknown" => None,
            "at rest" => Some(Similarity::identity()),
            "some" if c.once_in(2) => None,
            _ => Some(transform(c)),
        };
        views.push(frame.clone().map(|frame| View { frame, world_from_camera: pose }));
    }
    let description = format!("{words}; {mesh_words}; {given:?}");
    // Each view takes as long as one `align`.
    let is_bounded = count <= if given.quality == Quality::Fast { 16 } else { 2 };
    let aligned = move || {
        let views = views.into_iter().collect::<Result<Vec<View>>>()?;
        let (mesh, colors) = object?;
        align_views(views, &PreparedMesh::new(mesh).with_colors(colors), &given, &mut Silent)
    };
    Call::new(description, is_bounded, false, aligned, check_views)
}

/// A mesh, and the colours of its vertices, if it has some.
fn coloured(c: &mut Choices) -> (String, Result<(Mesh, Option<SurfaceColors>)>) {
    let (words, mesh) = mesh(c, MOST_TRIANGLES);
    if c.once_in(2) {
        return (words, mesh.map(|mesh| (mesh, None)));
    }
    let mut random = c.noise();
    let mut channel = || (256.0 * random.uniform()) as u8;
    let object = mesh.and_then(|mesh| {
        let colors: Vec<_> = mesh.positions().iter().map(|_| [channel(), channel(), channel()]).collect();
        let colors = SurfaceColors::of_vertices(&mesh, &colors)?;
        Ok((mesh, Some(colors)))
    });
    (format!("coloured {words}"), object)
}

fn check_views(found: &ViewsAlignment) -> Checked {
    check_pose(&found.world_from_mesh)?;
    check_probability(found.confidence)?;
    found.alternatives.iter().try_for_each(|other| check_pose(&other.camera_from_mesh))?;
    if let Some(u) = &found.uncertainty {
        finite("uncertainty", &[u.scale, u.rotation_deg, u.position_m])?;
        finite("rotationAxis", &u.rotation_axis)?;
    }
    finite("diagnostics.score", &[found.diagnostics.score])?;
    for view in &found.views {
        check_pose(&view.camera_from_mesh)?;
        check_pose(&view.camera.world_from_camera)?;
        check_probability(view.confidence)?;
        finite("score", &[view.score])?;
        let certainty = [view.camera.rotation_sd_deg, view.camera.position_sd_m];
        finite("camera", &certainty.map(Option::unwrap_or_default))?;
    }
    Ok(())
}

/// What is done with a tracker.
enum Step {
    Next(Box<Result<Frame>>),
    /// A pose relative to that of the frame.
    Correct(Similarity, Option<usize>),
    /// The pose that a frame has.
    Confirm(usize),
}

/// Frames of all sizes, and corrections in between; what fails leaves the tracker usable.
pub fn track(c: &mut Choices) -> Call {
    let changed = if c.once_in(2) { 1 + c.below(3) } else { 0 };
    let mut given: TrackOptions = options(c, changed, 5000);
    given.quality = if c.once_in(8) { Quality::Auto } else { Quality::Fast };
    let (mesh_words, object) = coloured(c);
    let count = if c.once_in(16) { c.size(1, 30) } else { c.size(1, 6) };
    let mut words = format!("{count} steps");
    let mut last: Option<Frame> = None;
    let mut steps = Vec::new();
    for k in 0..count {
        match c.below(8) {
            // As a video goes on: the frame before, mostly without its mask.
            0..=2 if last.is_some() => {
                let mut again = last.clone();
                if let (Some(frame), false) = (&mut again, c.once_in(3)) {
                    frame.mask = None;
                }
                words += "; the same again";
                steps.extend(again.map(|frame| Step::Next(Box::new(Ok(frame)))));
            }
            6 => {
                words += "; a correction";
                let frame = if c.once_in(2) { Some(c.pick(&[0, k, 1000, usize::MAX])) } else { None };
                steps.push(Step::Correct(transform(c), frame));
            }
            7 => {
                words += "; a confirmation";
                steps.push(Step::Confirm(c.below(k + 1)));
            }
            _ => {
                let (frame_words, frame) = frame(c, Size::Small);
                words += &format!("; {frame_words}");
                last = frame.as_ref().ok().cloned().or(last);
                steps.push(Step::Next(Box::new(frame)));
            }
        }
    }
    Call {
        description: format!("{words}; {mesh_words}; {given:?}"),
        // Each frame may be searched anew, which takes as long as one `align`.
        is_bounded: count <= if given.quality == Quality::Fast { 8 } else { 2 },
        run: Box::new(move || run(object, &given, steps)),
    }
}

fn run(
    object: Result<(Mesh, Option<SurfaceColors>)>,
    given: &TrackOptions,
    steps: Vec<Step>,
) -> Result<Answer, String> {
    let takes_transform = given.initial.is_some();
    let tracker =
        object.and_then(|(mesh, colors)| Tracker::new(PreparedMesh::new(mesh).with_colors(colors), given.clone()));
    let mut tracker = match tracker {
        Ok(tracker) => tracker,
        Err(error) => return typed(&error, takes_transform),
    };
    let mut answer = Answer::Result;
    let mut poses: Vec<Option<Similarity>> = Vec::new();
    for step in steps {
        let outcome = match step {
            Step::Next(frame) => {
                let found = frame.and_then(|frame| tracker.next(&frame, &mut Silent));
                found.map(|found| {
                    check_frame(&found, poses.len())?;
                    // Squares of the smallest scales leave the range of f64.
                    poses.push(Similarity::from_column_major(&found.camera_from_mesh.matrix).ok());
                    Ok(())
                })
            }
            Step::Correct(pose, frame) => correct(&mut tracker, &pose, frame),
            Step::Confirm(frame) => match poses.get(frame).copied().flatten() {
                Some(pose) => correct(&mut tracker, &pose, Some(frame)),
                None => continue,
            },
        };
        match outcome {
            Ok(checked) => checked?,
            // Corrections are transforms.
            Err(error) => answer = typed(&error, true)?,
        }
    }
    Ok(answer)
}

fn correct(tracker: &mut Tracker<PreparedMesh<'_>>, pose: &Similarity, frame: Option<usize>) -> Result<Checked> {
    let changed = tracker.correct(pose, frame)?;
    Ok(changed.iter().try_for_each(|frame| check_pose(&frame.camera_from_mesh)))
}

fn check_frame(found: &TrackedFrame, number: usize) -> Checked {
    check_pose(&found.camera_from_mesh)?;
    check_probability(found.confidence)?;
    finite("scaleSd, score", &[found.scale_sd, found.score])?;
    if found.frame != number {
        return Err(format!("result: frame {} instead of {number}", found.frame));
    }
    Ok(())
}
