//! `trace`: what each stage of one search draws and scores, from which `npm run picture` draws `docs/how-it-works.md`.

use serde_json::{Value as Json, json};
use sim3align::geometry::rotations::super_fibonacci;
use sim3align::pauses::{Pauses, finished};
use sim3align::precise;
use sim3align::precise::drawn::pose::CropPose;
use sim3align::precise::drawn::render::Canvas;
use sim3align::precise::judged::alternatives::lead;
use sim3align::precise::judged::color::{agreement_at, cells};
use sim3align::precise::judged::stretch::stretch;
use sim3align::precise::judged::verdict::conclude;
use sim3align::precise::options::Proportions;
use sim3align::precise::scored::score::{NOISE, Scoring};
use sim3align::precise::searched::coarse::Coarse;
use sim3align::precise::searched::ranking::Found;
use sim3align::precise::searched::recipe::{FINE, MIDDLE, SIEVE, SearchSettings};
use sim3align::precise::searched::refine::Refiner;
use sim3align::precise::searched::rounds::Rounds;
use sim3align::precise::searched::search::Search;
use sim3align::precise::searched::start;
use sim3align::progress::Stopwatch;
use sim3align::report::{Effort, Sim3, Stretch};
use sim3align_lab::case_folder::case::{Case, read_case};
use sim3align_lab::prelude::*;

use super::{Arguments, Command, Failure, usage};

pub const COMMAND: Command = Command {
    name: "trace",
    about: "prints what each stage of one search draws and scores, as JSON",
    usage: "\
Usage: sim3align-lab trace [--widen FACTOR] CASE

Searches the case with the effort `fast`, and prints one JSON object: the evidence on its grids, the score of every rotation
of the grid, the poses of every round, the steps of one refinement, the poses in the result, the rolls of the best pose, and
the proportions that were fitted. Angles are degrees from the best pose, up to the symmetry of the mesh. --widen FACTOR
stretches the mesh along its x axis first.",
    run,
};

/// Parts of the ranking of the rotation grid from which one image is printed each.
const SHOWN: [f64; 5] = [0.0, 0.05, 0.25, 0.5, 0.95];
/// Steps of the refinement after which an image is printed, and the angles from the best pose between which it starts.
const STEPS: [usize; 5] = [0, 1, 2, 4, 12];
const START_DEG: [f64; 2] = [12.0, 40.0];
/// Rolls about an axis.
const ROLLS: usize = 72;

/// A search that has ended, and how its images are printed.
struct Trace {
    search: Search,
    best: CropPose,
}

impl Trace {
    fn angle_deg(&self, pose: &CropPose) -> f64 {
        self.search.equivalence.angle(self.best.rotation, pose.rotation).to_degrees()
    }

    fn point(&self, found: &Found) -> Json {
        json!([self.angle_deg(&found.pose), found.score.total])
    }

    /// The evidence on a grid.
    fn evidence(&self, index: usize) -> Json {
        let grid = self.search.grid(index);
        let Scoring { depth_m, occluder_m, .. } = self.search.objective(index).scoring;
        json!({ "width": grid.width, "height": grid.height, "mask": grid.mask, "depth": grid.depth, "scene": grid.scene,
            "cells": grid.mask_cells, "depthM": depth_m, "occluderM": occluder_m })
    }

    /// The image of a pose on a grid.
    fn image(&self, index: usize, pose: &CropPose) -> Json {
        let objective = self.search.objective(index);
        let mut canvas = Canvas::default();
        let score = objective.score(&mut canvas, pose);
        json!({ "z": depths(&canvas), "score": score, "angle": self.angle_deg(pose) })
    }

    /// The mesh refined as it is and in the proportions that were fitted, and these.
    fn proportions(&self, fitted: &Stretch) -> Json {
        let objective = self.search.objective(FINE);
        let refiner = Refiner { objective, lock_scale: false };
        let similar = refiner.refine(&mut Canvas::default(), self.best, STEPS[4]);
        let Stretch { camera_from_stretched: Sim3 { scale, rotation, translation, .. }, stretch, .. } = fitted;
        let (turn, frame) = (DQuat::from_array(*rotation), &self.search.mesh.frame);
        let stretch = DMat3::from_cols_array_2d(stretch).transpose();
        let center = turn * (stretch * frame.center) * *scale + DVec3::from_array(*translation);
        let pose = CropPose::new(turn, scale * frame.diagonal, center);
        let mut canvas = Canvas::default();
        let score = objective.score_stretched(&mut canvas, &pose, &stretch.as_mat3());
        json!({ "similar": self.image(FINE, &similar.pose), "stretched": { "z": depths(&canvas), "score": score }, "fitted": fitted })
    }

    /// The best pose of every rotation of the grid, best first.
    fn sieve(&self, rotations: usize) -> Vec<Found> {
        let search = &self.search;
        let coarse = Coarse { objective: search.objective(SIEVE), median_m: search.observation.median_m };
        let (anchors, mut canvas) = (search.anchors(), Canvas::default());
        let mut best: Vec<Found> = (0..rotations)
            .filter_map(|i| {
                let mut tried = Vec::new();
                let rotation = super_fibonacci(i, rotations);
                coarse.try_anchors(&mut canvas, &search.mesh.outermost, rotation, &anchors, &mut tried);
                tried.into_iter().max_by(|a, b| a.score.total.total_cmp(&b.score.total))
            })
            .collect();
        best.sort_by(|a, b| b.score.total.total_cmp(&a.score.total));
        best
    }

    /// Refinements of a pose in 0, 1, 2 … steps.
    fn refinement(&self, start: &CropPose) -> Vec<Found> {
        let refiner = Refiner { objective: self.search.objective(MIDDLE), lock_scale: false };
        (0..=STEPS[4]).map(|steps| refiner.refine(&mut Canvas::default(), *start, steps)).collect()
    }

    /// The shape score and the colour correlation of rolls about the axis whose half turn fits best.
    fn rolls(&self, case: &Case, mesh: &PreparedMesh<'_>) -> Json {
        let search = &self.search;
        let (Some(photo), Some(colors)) = (case.observation.photo(), mesh.colors()) else { return Json::Null };
        let photo = cells(photo, search);
        let poses = search.mesh.turns.about_axes(&self.best, ROLLS);
        let half = |rolls: &&[CropPose]| search.score(&rolls[ROLLS / 2]).total;
        let axes = poses.chunks(2 * ROLLS).map(|chunk| &chunk[..ROLLS]);
        let Some(rolls) = axes.max_by(|a, b| half(a).total_cmp(&half(b))) else { return Json::Null };
        let point = |pose: &CropPose| json!([search.score(pose).total, agreement_at(search, &photo, colors, pose)]);
        json!(rolls.iter().map(point).collect::<Vec<Json>>())
    }
}

/// The depths of an image, 0 where nothing is drawn.
fn depths(canvas: &Canvas) -> Vec<f32> {
    canvas.inverse_depth.iter().map(|w| if *w > 0.0 { 1.0 / w } else { 0.0 }).collect()
}

/// Runs a search, and returns the poses with which each of its rounds began, with their scores there.
fn rounds_of(rounds: &mut Rounds) -> Vec<(&'static str, Vec<Found>)> {
    let mut list = Vec::new();
    while let Some(round) = rounds.round() {
        let objective = rounds.search.objective(round.grid);
        let mut canvas = Canvas::default();
        let scored = |pose: &CropPose| Found::of(*pose, objective.score(&mut canvas, pose));
        list.push((name_of(rounds.index()), rounds.poses().iter().map(scored).collect()));
        finished(rounds.run(&Pauses::none()));
    }
    list
}

fn name_of(index: usize) -> &'static str {
    ["rotate", "place", "refine", "refine again", "turn", "rank", "polish"].get(index).copied().unwrap_or("")
}

fn traced(case: &Case, mesh: &PreparedMesh<'_>) -> Result<Json> {
    let settings = SearchSettings::from(Effort::Fast);
    let (options, mut host) = (AlignOptions::default(), Silent);
    let mut stages = Stopwatch::new(&mut host, precise::PLAN);
    let mut rounds = start::begin(&case.observation, mesh, None, &options, &settings, &mut stages)?;
    let by_round = rounds_of(&mut rounds);
    let (_, certainty) = conclude(&rounds, None)?;
    let Rounds { search, found, .. } = rounds;
    let best = found.first().map_or(CropPose::new(DQuat::IDENTITY, 1.0, DVec3::Z), |best| best.pose);
    let trace = Trace { search, best };
    let sieve = trace.sieve(settings.rotations());
    let shown = SHOWN.map(|share| (share * (sieve.len() - 1) as f64) as usize);
    let is_near = |f: &&Found| (START_DEG[0]..START_DEG[1]).contains(&trace.angle_deg(&f.pose));
    let steps = sieve.iter().find(is_near).map_or_else(Vec::new, |start| trace.refinement(&start.pose));
    let points = |list: &[Found]| list.iter().map(|found| trace.point(found)).collect::<Vec<Json>>();
    let lead =
        found.split_first().map(|(best, others)| lead(&trace.search.equivalence, best, others, |f| f.score.total));
    let fitted = stretch(&trace.search, mesh.mesh(), &best, Proportions::Axes);
    Ok(json!({
        "name": case.name,
        "grids": { "sieve": trace.evidence(SIEVE), "fine": trace.evidence(FINE) },
        "sieve": {
            "points": points(&sieve),
            "images": shown.map(|rank| json!({ "rank": rank + 1, "image": trace.image(SIEVE, &sieve[rank].pose) })),
        },
        "rounds": by_round.iter().map(|(name, list)| json!({ "name": name, "points": points(list) })).collect::<Vec<_>>(),
        "refinement": {
            "points": points(&steps),
            "images": STEPS.iter().filter_map(|&k| Some(trace.image(FINE, &steps.get(k)?.pose))).collect::<Vec<_>>(),
        },
        "best": trace.image(FINE, &best),
        "found": points(&found),
        "confidence": certainty.confidence,
        "uncertainty": certainty.uncertainty,
        "lead": lead.map(|lead| lead / f64::from(NOISE)),
        "rolls": trace.rolls(case, mesh),
        "proportions": fitted.map(|fitted| trace.proportions(&fitted)),
    }))
}

fn run(arguments: &mut Arguments) -> Result<(), Failure> {
    let widen: f32 = arguments.value("widen", 1.0)?;
    let words = arguments.rest()?;
    let [folder] = words.as_slice() else { return Err(usage("one case folder is expected")) };
    let case = read_case(folder.as_ref())?;
    let positions = case.mesh.positions().iter().map(|p| Vec3::new(p.x * widen, p.y, p.z)).collect();
    let mesh = Mesh::new(positions, case.mesh.triangles().to_vec())?;
    let mesh = PreparedMesh::borrowed(&mesh).with_colors(case.colors.clone());
    println!("{}", traced(&case, &mesh)?);
    Ok(())
}
