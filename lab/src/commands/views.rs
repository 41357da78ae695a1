//! `views`: aligns one object in several views, generated or from case folders, and prints a table.

use std::time::Instant;

use sim3align::metrics::pose_error::{PoseErrors, pose_errors};
use sim3align::report::Sim3;
use sim3align::views::options::ViewsOptions;
use sim3align::views::report::{ViewRole, ViewsAlignment};
use sim3align::views::{View, align_views};
use sim3align_lab::bench::benchmark::STRICT;
use sim3align_lab::bench::case_line::CaseLine;
use sim3align_lab::bench::statistics::{cell, median};
use sim3align_lab::prelude::*;
use sim3align_lab::sequences::Sequence;
use sim3align_lab::sequences::faulty_mask::{grown, holed};
use sim3align_lab::sequences::rig::RigSet;

use super::sequence_rows::{Sources, each_row};
use super::{Arguments, Command, Failure, write_lines};

pub const COMMAND: Command = Command {
    name: "views",
    about: "aligns one object in several views, and prints tables",
    usage: "\
Usage: sim3align-lab views [--generated N] [--from I] [--seed S] [--views V] [--threads T] [--printed] [--small]
       [--no-color] [--mask-px N] [--holes] [--verbose] [--json FILE] [FOLDER...]

Aligns each case with one view, with all views and known camera poses, and with all views and unknown ones, and prints the
fraction of strictly correct poses and the errors of the size. FOLDER holds a mesh and folders frame_*.
--from: index of the first generated case. --printed: objects whose print alone tells how they are turned;
--no-color: without their photos. --small: objects of 5 cm, 60 cm from the cameras.
--mask-px: makes all masks wider by N pixels, narrower if negative. --holes: with holes in the mask of the second view.
--json: keeps the errors of every view.",
    run,
};

/// What is taken from the frames, or done to them.
#[derive(Clone, Copy)]
struct Fault {
    with_color: bool,
    mask_px: i32,
    holes: bool,
}

impl Fault {
    /// A view as it is given to the call.
    fn of(self, index: usize, view: &View) -> View {
        let mut view = view.clone();
        view.frame.photo = view.frame.photo.filter(|_| self.with_color);
        if let Some(mask) = &mut view.frame.mask {
            *mask = grown(mask, self.mask_px);
            if self.holes && index == 1 {
                *mask = holed(mask);
            }
        }
        view
    }
}

/// The result of one row for one case.
struct Outcome {
    row: usize,
    kind: String,
    strict: bool,
    scale: f64,
    /// The error of the size with its sign, in the first view.
    bias: f64,
    confidence: f64,
    /// Wrong views found, wrong views, and right views left out.
    left_out: [usize; 3],
    ms: f64,
    lines: Vec<CaseLine>,
}

const ROWS: [&str; 3] = ["one view", "known cameras", "unknown cameras"];

fn similarity(pose: &Sim3) -> Result<Similarity> {
    Similarity::from_column_major(&pose.matrix)
}

fn errors_of(sequence: &Sequence, k: usize, pose: &Sim3) -> Result<Option<PoseErrors>> {
    let Some(truth) = &sequence.frames[k].camera_from_mesh else { return Ok(None) };
    pose_errors(&sequence.mesh, &similarity(pose)?, truth, &sequence.symmetry).map(Some)
}

fn run_case(sequence: &Sequence, fault: Fault, verbose: bool) -> Result<Vec<Outcome>> {
    let mut outcomes = Vec::new();
    for (row, name) in ROWS.into_iter().enumerate() {
        let views: Vec<View> = sequence
            .frames
            .iter()
            .take(if row == 0 { 1 } else { usize::MAX })
            .enumerate()
            .map(|(k, frame)| {
                let mut view = fault.of(k, &frame.view);
                view.world_from_camera = view.world_from_camera.filter(|_| row == 1);
                view
            })
            .collect();
        if row == 1 && views.iter().any(|view| view.world_from_camera.is_none()) {
            continue;
        }
        let options = ViewsOptions { metrics: false, symmetry: sequence.symmetry.clone(), ..ViewsOptions::default() };
        let began = Instant::now();
        let found = align_views(views, &sequence.prepared(), &options, &mut Silent);
        let ms = began.elapsed().as_secs_f64() * 1000.0;
        let found: ViewsAlignment = match found {
            Ok(found) => found,
            Err(error) => {
                println!("{} {name}: {} {error}", sequence.name, error.code.as_str());
                continue;
            }
        };
        let mut strict = true;
        let mut scale: f64 = 0.0;
        let mut bias = None;
        let mut left_out = [0; 3];
        let mut lines = Vec::new();
        for (k, (view, frame)) in found.views.iter().zip(&sequence.frames).enumerate() {
            let is_out = view.role == ViewRole::Contradicting;
            left_out[0] += usize::from(is_out && frame.is_wrong);
            left_out[1] += usize::from(frame.is_wrong);
            left_out[2] += usize::from(is_out && !frame.is_wrong);
            // With known cameras, the pose in a wrong view follows from that view's wrong camera pose, so it is not
            // scored.
            let skipped = frame.is_wrong && row == 1;
            let Some(errors) = errors_of(sequence, k, &view.camera_from_mesh)?.filter(|_| !skipped) else { continue };
            let case = format!("{}/{}", sequence.name, frame.name);
            lines.push(CaseLine::new(name, case, Some(&errors), Some(view.confidence), Some(ms)));
            strict &= STRICT.holds(&errors);
            scale = scale.max(errors.scale_error);
            let ratio = view.camera_from_mesh.scale / frame.camera_from_mesh.map_or(1.0, |t| t.scale);
            bias.get_or_insert(ratio - 1.0);
            if verbose {
                println!(
                    "{} {name} {}: scale {:+.2} % rotation {:.2}° translation {:.2} % confidence {:.3} score {:.3} {:?}",
                    sequence.name,
                    frame.name,
                    100.0 * (ratio - 1.0),
                    errors.rotation_error_deg,
                    100.0 * errors.translation_error_relative,
                    view.confidence,
                    view.score,
                    view.role,
                );
            }
        }
        if verbose {
            let sd = found.uncertainty.map_or(f64::NAN, |u| u.scale);
            println!(
                "{} {name}: confidence {:.3} size sd {:.2} % {ms:.0} ms",
                sequence.name,
                found.confidence,
                100.0 * sd
            );
        }
        let kind = sequence.kind.clone();
        outcomes.push(Outcome {
            row,
            kind,
            strict,
            scale,
            bias: bias.unwrap_or_default(),
            confidence: found.confidence,
            left_out,
            ms,
            lines,
        });
    }
    Ok(outcomes)
}

fn run(arguments: &mut Arguments) -> Result<(), Failure> {
    let set = RigSet {
        seed: arguments.value("seed", 1)?,
        views: arguments.optional("views")?,
        is_printed: arguments.flag("printed"),
        is_small: arguments.flag("small"),
    };
    let fault = Fault {
        with_color: !arguments.flag("no-color"),
        mask_px: arguments.value("mask-px", 0)?,
        holes: arguments.flag("holes"),
    };
    let verbose = arguments.flag("verbose");
    let json: Option<PathBuf> = arguments.optional("json")?;
    let sources = Sources::parse(arguments)?;
    let outcomes = sources.outcomes(|index| set.case(index), |sequence| run_case(sequence, fault, verbose))?;
    write_lines(json, outcomes.iter().flat_map(|outcome| &outcome.lines))?;
    println!(
        "| row | cases | n | strict % | size error median % | bias % | ≤ .5 % | ≤ 2 % | confidence ≥ .9 and wrong | wrong views found | right views left out | ms |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|");
    each_row(
        &ROWS,
        &outcomes,
        |outcome| (outcome.row, outcome.kind.as_str()),
        |name, kind, of| {
            let share = |count: usize| 100.0 * count as f64 / of.len() as f64;
            let within = |limit: f64| share(of.iter().filter(|o| o.scale <= limit).count());
            let sum = |i: usize| of.iter().map(|o| o.left_out[i]).sum::<usize>();
            println!(
                "| {name} | {kind} | {} | {:.1} | {} | {} | {:.1} | {:.1} | {} | {} of {} | {} | {} |",
                of.len(),
                share(of.iter().filter(|o| o.strict).count()),
                cell(median(of.iter().map(|o| 100.0 * o.scale).collect()), 2),
                cell(median(of.iter().map(|o| 100.0 * o.bias).collect()), 2),
                within(0.005),
                within(0.02),
                of.iter().filter(|o| o.confidence >= 0.9 && !o.strict).count(),
                sum(0),
                sum(1),
                sum(2),
                cell(median(of.iter().map(|o| o.ms).collect()), 0),
            );
        },
    );
    Ok(())
}
