//! The rounds of a search: the recipe that they follow, and that a search may pause after any task.

use std::rc::Rc;

use sim3align::geometry::rotations::angle_between;
use sim3align::pauses::{Pauses, Task};
use sim3align::precise::drawn::mesh_pyramid::MeshPyramid;
use sim3align::precise::drawn::pose::{CropPose, MeshFrame};
use sim3align::precise::drawn::turns::TURNS;
use sim3align::precise::observed::clean::CleanObservation;
use sim3align::precise::searched::ranking::Found;
use sim3align::precise::searched::recipe::{FIRST_REFINEMENT, RANKING, SearchSettings, TURNING, Task as Kind};
use sim3align::precise::searched::rounds::Rounds;
use sim3align::precise::searched::search::Search;
use sim3align::report::Effort;
use wasm_bindgen_test::wasm_bindgen_test;

use crate::precise::{body, observe, truth};
use crate::support::{pause_points, pausing};

/// Few rotations and candidates, but two that are polished.
fn settings() -> SearchSettings {
    let mut settings = SearchSettings::from(Effort::Fast);
    settings.rounds[0].work = 60;
    for (round, keep) in settings.rounds.iter_mut().zip([30, 8, 5, 3, 2, 2]) {
        round.keep = keep;
    }
    settings
}

fn rounds(initial: bool, global: bool) -> Rounds {
    let (mesh, settings) = (body(), settings());
    let pyramid = Rc::new(MeshPyramid::new(&mesh, &settings.grids).unwrap());
    let pose = CropPose::of_similarity(&truth(), &MeshFrame::of(&mesh)).unwrap();
    let near = pose.moved(&[0.1, -0.05, 0.08, 0.04, 0.01, -0.02, 0.05]);
    let clean = Rc::new(CleanObservation::new(&observe(&mesh, &truth())));
    Rounds::new(Search::new(clean, pyramid, settings), initial.then_some(near), global)
}

fn assert_same(found: &[Found], expected: &[Found], what: &str) {
    assert_eq!(found.len(), expected.len(), "{what}");
    for (a, b) in found.iter().zip(expected) {
        assert_eq!((a.pose, a.score, a.converged, a.renders), (b.pose, b.score, b.converged, b.renders), "{what}");
    }
}

/// Runs a round with pauses, at one pause point of `one_in`. Returns the number of its tasks, and of its parts.
fn run_round(rounds: &mut Rounds, seed: u64, one_in: usize) -> (usize, usize) {
    let clock = pausing(seed, one_in);
    let mut round = Task::new(Pauses::new(clock, None), |pauses| async move {
        rounds.run(&pauses).await;
        Ok(())
    });
    let mut parts = 1;
    while round.step(0.0).unwrap().is_none() {
        parts += 1;
    }
    (pause_points(), parts)
}

/// Tasks of every round, and number of parts, of a search that pauses so.
fn run(rounds: &mut Rounds, seed: u64, one_in: usize) -> (Vec<usize>, usize) {
    let (mut tasks, mut all) = (Vec::new(), 0);
    while rounds.round().is_some() {
        let (count, parts) = run_round(rounds, seed + all as u64, one_in);
        tasks.push(count);
        all += parts;
    }
    (tasks, all)
}

#[wasm_bindgen_test(unsupported = test)]
fn rounds_done_in_parts_are_rounds_done_whole() {
    for (initial, global) in [(false, true), (true, true), (true, false)] {
        let mut whole = rounds(initial, global);
        let (tasks, parts) = run(&mut whole, 0, 0);
        assert!(!whole.found.is_empty() && parts == tasks.len(), "{parts} parts, tasks {tasks:?}");
        for seed in 0..4 {
            let what = format!("initial {initial}, global {global}, seed {seed}");
            // After every task, and after some.
            let mut divided = rounds(initial, global);
            let (divided_tasks, parts) = run(&mut divided, seed, if seed == 0 { 1 } else { 3 });
            assert!(
                parts > tasks.len() && (seed != 0 || parts == tasks.iter().map(|tasks| tasks + 1).sum::<usize>()),
                "{what}: {parts} parts"
            );
            assert_eq!(divided_tasks, tasks, "{what}");
            assert_same(&divided.found, &whole.found, &what);
            assert_eq!(divided.search.renders, whole.search.renders, "{what}");
            assert_eq!(divided.best(), whole.best(), "{what}");
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn every_round_takes_what_the_one_before_it_keeps() {
    let recipe = settings().rounds;
    for (initial, global) in [(false, true), (true, true), (true, false)] {
        let mut rounds = rounds(initial, global);
        let (tasks, _) = run(&mut rounds, 0, 0);
        let what = format!("initial {initial}, global {global}: {tasks:?}");
        let first = if global { 0 } else { FIRST_REFINEMENT };
        assert_eq!(tasks.len(), recipe.len() - first, "{what}");
        if global {
            assert_eq!(tasks[..2], [recipe[0].work, recipe[0].keep], "{what}");
        }
        // The given pose and seven around it join those of the grid.
        let around = if initial { 8 } else { 0 };
        for (index, &count) in (first..).zip(&tasks).skip(if global { 2 } else { 0 }) {
            let most = if index > first { recipe[index - 1].keep } else { 0 };
            let joining = if index == FIRST_REFINEMENT { around } else { 0 };
            if index == TURNING {
                assert_eq!(count, TURNS, "{what}");
                continue;
            }
            // Turns join the poses that the round before them has kept.
            let most = most + if index == RANKING { recipe[TURNING - 1].keep } else { 0 };
            assert!(count > 0 && count <= most + joining, "{what}: round {index}");
            assert!(index != FIRST_REFINEMENT || count > joining || !global, "{what}: round {index}");
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn every_image_that_is_drawn_counts() {
    for (initial, global) in [(false, true), (true, true), (true, false)] {
        let mut rounds = rounds(initial, global);
        // The given pose and its turns about every axis were drawn before the first round.
        let mut before = if initial { 18 } else { 0 };
        assert_eq!(rounds.search.renders, before);
        while let Some(round) = rounds.round() {
            let (tasks, _) = run_round(&mut rounds, 0, 0);
            let drawn = rounds.search.renders - before;
            let what = format!("initial {initial}, global {global}, {round:?}: {drawn} images of {tasks} tasks");
            match round.task {
                // As it is, and somewhat larger: nothing cuts this mask.
                Kind::Rotate => assert_eq!(drawn, 2 * tasks, "{what}"),
                Kind::Place => assert_eq!(drawn, tasks, "{what}"),
                Kind::Refine | Kind::Fit => assert!(drawn > tasks && drawn <= tasks * (1 + round.work), "{what}"),
                Kind::Turn => assert!(drawn >= 2 * tasks && drawn <= tasks * (2 + round.work), "{what}"),
            }
            before = rounds.search.renders;
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn what_a_search_has_found_is_refined_with_the_poses_of_the_next_one() {
    let mut first = rounds(false, true);
    run(&mut first, 0, 0);
    let count = |resumes: usize| {
        let mut rounds = rounds(false, true);
        rounds.resume(&first.found[..resumes]);
        let tasks = run(&mut rounds, 0, 0).0;
        (tasks, rounds.found[0].score.total)
    };
    let ((without, low), (with, high)) = (count(0), count(2));
    assert_eq!(with[..2], without[..2]);
    assert_eq!(with[FIRST_REFINEMENT], without[FIRST_REFINEMENT] + 2);
    assert!(high >= low - 1e-3, "resumed: {high}, and {low} without");
}

#[wasm_bindgen_test(unsupported = test)]
fn what_was_found_is_ranked_by_the_fine_grid_and_distinct() {
    let mut rounds = rounds(false, true);
    let mut ranked = Vec::new();
    while let Some(round) = rounds.round() {
        run_round(&mut rounds, 0, 0);
        if round == settings().rounds[RANKING] {
            ranked = rounds.found.clone();
        }
    }
    assert!(ranked.len() > 1, "{ranked:?}");
    for (k, found) in ranked.iter().enumerate() {
        // In its best proportions the mesh explains the image at least as well, and the best pose needs no others.
        let gain = found.score.total - rounds.search.score(&found.pose).total;
        assert!(gain > -0.01 && (k > 0 || gain < 0.01), "{k}: {gain}");
        let apart = |other: &Found| angle_between(other.pose.rotation, found.pose.rotation) > 0.105;
        assert!(ranked[..k].iter().all(|other| other.score.total >= found.score.total && apart(other)), "{k}");
    }
    // The finest grid moves the best alone, and no score: scores of different grids do not compare.
    let polished = settings().rounds[RANKING].keep;
    for (k, (found, ranked)) in rounds.found.iter().zip(&ranked).enumerate() {
        assert_eq!(found.score, ranked.score, "{k}");
        assert_eq!(found.pose != ranked.pose, k < polished, "{k}: {found:?}");
    }
}

/// The cost of a search in units of the budget: about milliseconds of WebAssembly on a laptop of 2020.
fn cost(settings: &SearchSettings) -> f64 {
    let [rotate, place, first, second, turn, fine, _] = settings.rounds;
    0.06 * rotate.work as f64
        + 0.12 * (place.keep * first.work + first.keep * second.work + TURNS * turn.work) as f64
        + 0.4 * ((second.keep + turn.keep) * fine.work) as f64
}

#[wasm_bindgen_test(unsupported = test)]
fn a_search_within_a_budget_costs_as_much() {
    for settings in
        [SearchSettings::from(Effort::Fast), SearchSettings::from(Effort::Balanced), SearchSettings::from(Effort::Best)]
    {
        for budget in [150.0, 500.0, 1500.0] {
            let within = settings.within(budget);
            // Counts are rounded down, and grow twentyfold at most.
            // Turns are always tried, but only a few of them.
            let mut limited = settings;
            let turn = &mut limited.rounds[TURNING];
            (turn.work, turn.keep) = (turn.work.min(6), turn.keep.min(6));
            let turns = 0.12 * (TURNS * turn.work) as f64 + 0.4 * (turn.keep * limited.rounds[RANKING].work) as f64;
            let most = 20.0 * (cost(&limited) - turns) + turns;
            let share = cost(&within) / f64::min(budget, most);
            assert!((0.85..=1.0001).contains(&share), "{budget}: {within:?} costs {}", cost(&within));
            let SearchSettings { rounds, max_load, turned, .. } = settings;
            let unchanged = SearchSettings { rounds, max_load, turned, ..within };
            assert_eq!(
                unchanged, settings,
                "{budget}: nothing but the rounds, the bound on their work, and the turned poses"
            );
            assert_eq!(within.turned, 1, "{budget}: further poses are turned beyond any budget only");
            assert!(within.max_load < settings.max_load);
            assert!(within.rounds.iter().skip(1).zip(&limited.rounds[1..]).all(|(a, b)| a.work == b.work), "{budget}");
        }
        let least = settings.within(1e-9).rounds;
        assert!(least[0].work >= 60 && least[..4].iter().zip([30, 6, 3, 2]).all(|(round, keep)| round.keep >= keep));
    }
}
