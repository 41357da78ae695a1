//! A fixed part of the fuzzing, and every input that it has found so far.

use sim3align_lab::fuzz::call::Answer;
use sim3align_lab::fuzz::choices::Choices;
use sim3align_lab::fuzz::memory::{CountingAllocator, peak_bytes, reset_peak};
use sim3align_lab::fuzz::minimise::minimise;
use sim3align_lab::fuzz::target::{Ceilings, Execution, TARGETS, Target};
use sim3align_lab::prelude::*;

/// For the memory of the calls.
#[global_allocator]
static ALLOCATOR: CountingAllocator = CountingAllocator;

/// No test depends on time.
const CEILINGS: Ceilings = Ceilings { seconds: f64::INFINITY, bytes: usize::MAX };

/// Prints which call it was when the code under test panics.
struct NamedInPanics(String);

impl Drop for NamedInPanics {
    fn drop(&mut self) {
        if std::thread::panicking() {
            eprintln!("panicked in {}", self.0);
        }
    }
}

fn execute(target: Target, choices: &mut Choices, name: String) -> Answer {
    let named = NamedInPanics(name);
    let Execution { description, outcome, .. } = target.execute(choices, &CEILINGS);
    outcome.unwrap_or_else(|fault| panic!("{}: {fault}: {description}", named.0))
}

fn no_fault(name: &str, executions: u64, least_results: usize) {
    let target: Target = name.parse().unwrap();
    let answers = (0..executions).map(|seed| execute(target, &mut Choices::random(seed), format!("{name} {seed}")));
    let results = answers.filter(|answer| *answer == Answer::Result).count();
    assert!(results >= least_results, "{results} of {executions} calls of {name} had a result");
}

/// A test of a number of calls of a target, of which some have a result.
macro_rules! no_fault {
    ($($test:ident: $target:literal, $executions:literal, $least_results:literal;)+) => {
        $(#[test]
        fn $test() {
            no_fault($target, $executions, $least_results);
        })+
    };
}

no_fault! {
    readers_have_no_fault: "readers", 30_000, 1000;
    align_has_no_fault: "align", 400, 60;
    align_of_large_inputs_has_no_fault: "align-large", 6, 1;
    views_have_no_fault: "views", 300, 15;
    trackers_have_no_fault: "track", 100, 10;
    evaluate_has_no_fault: "evaluate", 200, 50;
    register_has_no_fault: "register", 60, 5;
    estimate_sim3_has_no_fault: "estimate-sim3", 1000, 100;
}

#[test]
fn inputs_that_were_found_have_no_fault_any_more() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("regressions");
    let mut replayed = 0;
    for target in TARGETS {
        let Ok(files) = std::fs::read_dir(folder.join(target.name)) else { continue };
        for file in files.map(|file| file.unwrap().path()) {
            let mut choices = Choices::read(&std::fs::read_to_string(&file).unwrap()).unwrap();
            execute(target, &mut choices, file.display().to_string());
            replayed += 1;
        }
    }
    assert!(replayed > 0, "no file in {}", folder.display());
}

#[test]
fn the_same_choices_describe_the_same_input() {
    for target in TARGETS {
        let mut drawn = Choices::random(7);
        let description = target.describe(&mut drawn);
        let text = drawn.taken().iter().map(u32::to_string).collect::<Vec<_>>().join(" ");
        let mut read = Choices::read(&format!("# a comment\n{text}\n")).unwrap();
        assert_eq!(target.describe(&mut read), description);
        assert_eq!(read.taken(), drawn.taken());
    }
    assert_eq!(Choices::read("1 two").unwrap_err(), "two");
}

#[test]
fn the_plainest_input_has_a_result() {
    for name in ["align", "align-large", "views", "track", "evaluate"] {
        let target: Target = name.parse().unwrap();
        assert_eq!(execute(target, &mut Choices::of(Vec::new()), name.into()), Answer::Result, "{name}");
    }
}

#[test]
fn minimising_keeps_what_matters() {
    // Two numbers matter: one above 40 somewhere after one that is odd.
    let fails = |list: &[u32]| list.iter().skip_while(|x| **x % 2 == 0).skip(1).any(|x| *x > 40);
    let list: Vec<u32> = (0..30).map(|i| i * 7 % 60).collect();
    let smallest = minimise(&list, 10_000, fails);
    assert!(matches!(smallest[..], [odd, 41] if odd % 2 == 1), "{smallest:?}");
    // Trials are limited.
    let mut trials = 0;
    minimise(&list, 5, |_| {
        trials += 1;
        false
    });
    assert_eq!(trials, 5);
}

#[test]
fn memory_is_counted() {
    reset_peak();
    // The optimiser removes an allocation that nothing sees.
    drop(std::hint::black_box(vec![1_u8; 300 << 20]));
    let peak = peak_bytes() >> 20;
    // What the thread was given by others, and has freed, is not its own.
    assert!((299..310).contains(&peak), "{peak} MB");
    reset_peak();
    assert!(peak_bytes() >> 20 < 10, "{} MB", peak_bytes() >> 20);
}
