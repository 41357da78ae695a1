//! The rounds of a search: done in parts, in any order, they give the bits of rounds done whole.

use sim3align::precise::pose::{CropPose, MeshFrame};
use sim3align::precise::rounds::Rounds;
use sim3align::precise::search::Found;
use sim3align::precise::{Search, SearchSettings};
use wasm_bindgen_test::wasm_bindgen_test;

use crate::precise::{body, observe, truth};

fn settings() -> SearchSettings {
    SearchSettings { rotations: 60, keep: [30, 8, 5, 3, 2], ..SearchSettings::fast() }
}

fn rounds(initial: bool, global: bool) -> Rounds {
    let mesh = body();
    let search = Search::new(&observe(&mesh, &truth()), &mesh, settings()).unwrap();
    let pose = CropPose::of_similarity(&truth(), &MeshFrame::of(&mesh)).unwrap();
    let near = pose.moved(&[0.1, -0.05, 0.08, 0.04, 0.01, -0.02, 0.05]);
    Rounds::new(search, initial.then_some(near), global)
}

fn assert_same(found: &[Found], expected: &[Found], what: &str) {
    assert_eq!(found.len(), expected.len(), "{what}");
    for (a, b) in found.iter().zip(expected) {
        assert_eq!((a.pose, a.score, a.converged, a.renders), (b.pose, b.score, b.converged, b.renders), "{what}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn rounds_done_in_parts_are_rounds_done_whole() {
    for (initial, global) in [(false, true), (true, true), (true, false)] {
        let mut whole = rounds(initial, global);
        let mut divided = rounds(initial, global);
        let mut stepped = rounds(initial, global);
        while whole.tasks() > 0 {
            let (round, tasks) = (whole.round, whole.tasks());
            let what = format!("initial {initial}, global {global}, round {round}");
            let expected = whole.run(0, 1);
            // A task of the first round gives several candidates, all others one.
            let each = expected.len() / tasks;
            assert!(each > 0 && expected.len() == each * tasks, "{what}: {} of {tasks} tasks", expected.len());
            for parts in [2, 3, 7] {
                // The last part first.
                let mut tasks: Vec<(usize, Vec<Found>)> = Vec::new();
                for part in (0..parts).rev() {
                    let found = divided.run(part, parts);
                    tasks.extend(found.chunks(each).enumerate().map(|(k, task)| (part + k * parts, task.to_vec())));
                }
                tasks.sort_by_key(|(task, _)| *task);
                let joined: Vec<Found> = tasks.into_iter().flat_map(|(_, found)| found).collect();
                assert_same(&joined, &expected, &format!("{what}, {parts} parts"));
                if parts == 7 {
                    divided.advance(joined);
                }
            }
            whole.advance(expected);
            stepped.step();
            assert_eq!((whole.best(), stepped.best()), (divided.best(), divided.best()), "{what}");
            assert_eq!([divided.search.renders, stepped.search.renders], [whole.search.renders; 2], "{what}");
        }
        assert!(!whole.found.is_empty() && divided.tasks() == 0 && stepped.tasks() == 0);
        assert_same(&divided.found, &whole.found, "divided");
        assert_same(&stepped.found, &whole.found, "stepped");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn what_was_found_is_ranked_by_the_fine_grid_and_distinct() {
    let mut rounds = rounds(false, true);
    let mut tasks = Vec::new();
    while rounds.tasks() > 0 {
        tasks.push(rounds.tasks());
        rounds.step();
    }
    let SearchSettings { rotations, keep, .. } = settings();
    assert_eq!(tasks[..2], [rotations, keep[0]]);
    assert!(tasks.len() == 6 && tasks[2..].iter().zip(&keep[1..]).all(|(tasks, keep)| tasks <= keep), "{tasks:?}");
    let found = &rounds.found;
    assert!(found.windows(2).all(|pair| pair[0].score.total >= pair[1].score.total), "{found:?}");
    // The finest grid moves the best ones; the scores stay those of the fine grid, and of the poses compared there.
    for (k, other) in found.iter().enumerate().skip(keep[4]) {
        assert_eq!(other.score, rounds.search.score(&other.pose), "{k}");
    }
}
