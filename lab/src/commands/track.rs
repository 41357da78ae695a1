//! `track`: tracks one object through videos, generated or from case folders, and prints a table.

use sim3align::metrics::pose_error::pose_errors;
use sim3align::track::options::TrackOptions;
use sim3align::track::report::TrackState;
use sim3align::track::tracker::Tracker;
use sim3align_lab::bench::benchmark::STRICT;
use sim3align_lab::bench::case_line::CaseLine;
use sim3align_lab::bench::proportions::with_wrong_mesh;
use sim3align_lab::bench::statistics::{cell, median};
use sim3align_lab::cpu_time::CpuTimer;
use sim3align_lab::prelude::*;
use sim3align_lab::sequences::Sequence;
use sim3align_lab::sequences::video::VideoSet;

use super::sequence_rows::{Sources, each_row};
use super::{Arguments, Command, Failure, write_lines};

pub const COMMAND: Command = Command {
    name: "track",
    about: "tracks one object through videos, and prints tables",
    usage: "\
Usage: sim3align-lab track [--generated N] [--from I] [--frames F] [--seed S] [--threads T] [--printed]
       [--no-color] [--stretch E] [--verbose] [--json FILE] [FOLDER...]

Tracks each video with the masks of all frames, and with that of the first frame alone, and prints errors, flips,
losses, and the time of a frame. FOLDER holds a mesh and folders frame_*.
--from: index of the first generated video. --printed: objects whose print alone tells how they are turned;
--no-color: without their photos. --stretch: meshes of wrong proportions, with E the largest logarithm of a stretch.
--json: keeps the errors of every frame that shows the object.",
    run,
};

/// Rotation error from which on a pose is a flip, degrees.
const FLIP_DEG: f64 = 45.0;
/// Fraction of the object that a frame must show for it to count.
const SHOWN: f64 = 0.4;

/// The result of one video.
#[derive(Default)]
struct Outcome {
    row: usize,
    kind: String,
    /// Rotation and size errors of the frames that show the object, degrees and relative.
    rotations: Vec<f64>,
    sizes: Vec<f64>,
    strict: usize,
    flips: usize,
    /// Frames that show the object and are said to be uncertain, or lost.
    unsure: [usize; 2],
    /// Wrong frames said to be tracked.
    silent: usize,
    /// Longest time to find the object again, frames.
    found_after: usize,
    times: Vec<f64>,
    lines: Vec<CaseLine>,
}

const ROWS: [&str; 2] = ["all masks", "first mask"];

fn run_video(sequence: &Sequence, with_color: bool, verbose: bool) -> Result<Vec<Outcome>> {
    let mut outcomes = Vec::new();
    for (row, name) in ROWS.into_iter().enumerate() {
        let mesh = sequence.prepared();
        let mut tracker = Tracker::new(&mesh, TrackOptions::default())?;
        let mut outcome = Outcome { row, kind: sequence.kind.clone(), ..Outcome::default() };
        let mut missed = 0;
        for (k, frame) in sequence.frames.iter().enumerate() {
            let mut seen = frame.view.frame.clone();
            if row == 1 && k > 0 {
                seen.mask = None;
            }
            if !with_color {
                seen.photo = None;
            }
            let began = CpuTimer::start();
            let found = match tracker.next(&seen, &mut Silent) {
                Ok(found) => found,
                Err(error) => {
                    println!("{} {name} {}: {} {error}", sequence.name, frame.name, error.code.as_str());
                    break;
                }
            };
            if k > 0 {
                outcome.times.push(1000.0 * began.seconds());
            }
            let Some(truth) = &frame.camera_from_mesh else { continue };
            let pose = Similarity::from_column_major(&found.camera_from_mesh.matrix)?;
            let errors = pose_errors(&sequence.mesh, &pose, truth, &sequence.symmetry)?;
            if verbose {
                println!(
                    "{} {name} {}: {:?} scale {:+.2} % rotation {:.2}° translation {:.2} % confidence {:.3} sd {:.2} % {:.0} ms{}",
                    sequence.name,
                    frame.name,
                    found.state,
                    100.0 * (pose.scale / truth.scale - 1.0),
                    errors.rotation_error_deg,
                    100.0 * errors.translation_error_relative,
                    found.confidence,
                    100.0 * found.scale_sd,
                    outcome.times.last().copied().unwrap_or_default(),
                    if found.is_detected { " detected" } else { "" },
                );
            }
            let strict = STRICT.holds(&errors);
            outcome.silent += usize::from(found.state == TrackState::Tracking && !strict);
            if frame.visible < SHOWN {
                continue;
            }
            outcome.unsure[0] += usize::from(found.state == TrackState::Uncertain);
            outcome.unsure[1] += usize::from(found.state == TrackState::Lost);
            outcome.strict += usize::from(strict);
            let case = format!("{}/{}", sequence.name, frame.name);
            let ms = outcome.times.last().copied();
            outcome.lines.push(CaseLine::new(name, case, Some(&errors), Some(found.confidence), ms));
            missed = if strict { 0 } else { missed + 1 };
            outcome.found_after = outcome.found_after.max(missed);
            outcome.flips += usize::from(found.state != TrackState::Lost && errors.rotation_error_deg > FLIP_DEG);
            outcome.rotations.push(errors.rotation_error_deg);
            outcome.sizes.push(errors.scale_error);
        }
        outcomes.push(outcome);
    }
    Ok(outcomes)
}

fn run(arguments: &mut Arguments) -> Result<(), Failure> {
    let set = VideoSet {
        seed: arguments.value("seed", 1)?,
        frames: arguments.value("frames", 150)?,
        is_printed: arguments.flag("printed"),
    };
    let (with_color, verbose) = (!arguments.flag("no-color"), arguments.flag("verbose"));
    let stretch: f64 = arguments.value("stretch", 0.0)?;
    let json: Option<PathBuf> = arguments.optional("json")?;
    let sources = Sources::parse(arguments)?;
    let run = |sequence: &Sequence| match stretch {
        0.0 => run_video(sequence, with_color, verbose),
        _ => run_video(&with_wrong_mesh(sequence, set.seed, stretch)?, with_color, verbose),
    };
    let outcomes = sources.outcomes(|index| set.video(index), run)?;
    write_lines(json, outcomes.iter().flat_map(|outcome| &outcome.lines))?;
    println!(
        "| row | videos | frames | strict % | rotation median, worst ° | size median, last worst % | flips | uncertain, lost | wrong and tracking | longest until right, frames | ms |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|");
    each_row(
        &ROWS,
        &outcomes,
        |outcome| (outcome.row, outcome.kind.as_str()),
        |name, kind, of| {
            let frames: usize = of.iter().map(|o| o.rotations.len()).sum();
            let sum = |count: fn(&Outcome) -> usize| of.iter().map(|o| count(o)).sum::<usize>();
            let all =
                |list: fn(&Outcome) -> &Vec<f64>| of.iter().flat_map(|o| list(o).iter().copied()).collect::<Vec<_>>();
            let rotations = all(|o| &o.rotations);
            let worst = rotations.iter().copied().fold(0.0, f64::max);
            let last = of.iter().filter_map(|o| o.sizes.last()).copied().fold(0.0, f64::max);
            println!(
                "| {name} | {kind} | {frames} | {:.1} | {}, {worst:.1} | {}, {:.2} | {} | {}, {} | {} | {} | {} |",
                100.0 * sum(|o| o.strict) as f64 / frames.max(1) as f64,
                cell(median(rotations), 2),
                cell(median(all(|o| &o.sizes)).map(|size| 100.0 * size), 2),
                100.0 * last,
                sum(|o| o.flips),
                sum(|o| o.unsure[0]),
                sum(|o| o.unsure[1]),
                sum(|o| o.silent),
                of.iter().map(|o| o.found_after).max().unwrap_or_default(),
                cell(median(all(|o| &o.times)), 1),
            );
        },
    );
    Ok(())
}
