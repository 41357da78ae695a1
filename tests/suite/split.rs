//! An alignment shared by several: the bits of one that is not.

use sim3align::align::align;
use sim3align::align::options::{AlignOptions, Preset, Quality, SearchScope};
use sim3align::align::progress::Silent;
use sim3align::align::report::{Alignment, Sim3};
use sim3align::align::split::Share;
use sim3align::error::ErrorCode;
use sim3align::stages::search::Found;
use sim3align::stages::search::score::Score;
use wasm_bindgen_test::wasm_bindgen_test;

use crate::precise::{body, observe, truth};

/// What is told of a candidate: the terms of its score are not.
fn told(found: &Found) -> Found {
    Found { score: Score { total: found.score.total, ..Score::default() }, ..*found }
}

/// The alignment by `parts`, of whom the last says what was found.
fn shared(options: &AlignOptions, parts: usize) -> Alignment {
    let share = || Share::new(observe(&body(), &truth()), body(), options.clone()).unwrap();
    let mut shares: Vec<Share> = (0..parts).map(|_| share()).collect();
    let mut rounds = 0;
    loop {
        let tasks = shares[0].tasks();
        if tasks == 0 {
            break;
        }
        let mut all: Vec<Option<Vec<Found>>> = vec![None; tasks];
        let mut others = Vec::new();
        for (part, share) in shares.iter_mut().enumerate() {
            assert_eq!(share.tasks(), tasks);
            let (found, per_task) = share.run(part, parts);
            let own = (part..tasks).step_by(parts).len();
            for (i, task) in (part..tasks).step_by(parts).enumerate() {
                all[task] = Some(found[i * per_task..(i + 1) * per_task].iter().map(told).collect());
            }
            others.extend_from_slice(&found[own * per_task..]);
        }
        let all: Vec<Found> = all.into_iter().flat_map(Option::unwrap).chain(others).collect();
        shares.iter_mut().for_each(|share| share.advance(all.clone()));
        rounds += 1;
    }
    assert!((4..=6).contains(&rounds), "{rounds}");
    let told = shares.pop().unwrap();
    let (pose, score) = told.best().unwrap();
    let found = told.finish(&mut Silent).unwrap();
    assert_eq!((Sim3::from(&pose), Some(score)), (found.camera_from_mesh.clone(), found.score));
    found
}

fn fast() -> AlignOptions {
    AlignOptions { quality: Quality::Fast, budget_ms: Some(25.0), ..AlignOptions::default() }
}

#[wasm_bindgen_test(unsupported = test)]
fn the_bits_do_not_tell_who_did_what() {
    let pose = truth();
    let local = AlignOptions { initial: Some(pose), search: SearchScope::Local, ..fast() };
    let best = AlignOptions { quality: Quality::Best, ..fast() };
    let held = AlignOptions { initial: Some(pose), scale: Some([0.1, 0.1702]), ..fast() };
    for options in [fast(), local, best, held] {
        let whole = align(&observe(&body(), &pose), &body(), &options, &mut Silent).unwrap();
        for parts in [1, 2, 3, 7] {
            // The stages of the search are nobody's in particular.
            let found = Alignment { timings_ms: whole.timings_ms.clone(), ..shared(&options, parts) };
            assert_eq!(found, whole, "{parts} parts, {options:?}");
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn what_cannot_be_shared_has_no_tasks_and_what_is_wrong_is_said() {
    let share = |options: AlignOptions| Share::new(observe(&body(), &truth()), body(), options);
    let paper = AlignOptions { preset: Preset::Paper, ..AlignOptions::default() };
    assert_eq!(share(paper).unwrap().tasks(), 0);
    let local = AlignOptions { search: SearchScope::Local, ..fast() };
    assert_eq!(share(local).err().map(|e| e.code), Some(ErrorCode::InvalidOption));
}
