//! Structural fuzzing: inputs that are valid by type and hostile by content. No call panics, every error is typed, and every
//! result is finite.
//!
//! An [`Entropy`] makes an input from random bytes; a seed gives the same inputs everywhere. `SIM3ALIGN_FUZZ_SEED` chooses another
//! one, as `npm run fuzz` does.

#![cfg(not(target_family = "wasm"))]
#![allow(clippy::unwrap_used, clippy::panic)]

mod calls;
mod entropy;
mod files;
mod images;
mod meshes;
mod options;

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind};

use entropy::Entropy;
use sim3align::geometry::random::Random;

/// Bytes of an input: large meshes and images are drawn from seeds, so that a few hundred suffice.
const BYTES: usize = 400;

thread_local! {
    /// Calls of this test that had a result: a fuzzer that only draws what is refused finds nothing.
    static RESULTS: Cell<u32> = const { Cell::new(0) };
}

type Call = fn(&mut Entropy<'_>);

/// Whether a call panics, or a check of its result does, on the input of these bytes.
fn fails(call: Call, bytes: &[u8]) -> bool {
    catch_unwind(AssertUnwindSafe(|| call(&mut Entropy::new(bytes)))).is_err()
}

fn fuzz(cases: u32, least_results: u32, call: Call) {
    let seed = std::env::var("SIM3ALIGN_FUZZ_SEED").ok().and_then(|seed| seed.parse().ok()).unwrap_or(0);
    let mut random = Random::new(seed, 1);
    for _ in 0..cases {
        let length = random.below(BYTES);
        let bytes: Vec<u8> = (0..length).map(|_| random.below(256) as u8).collect();
        if fails(call, &bytes) {
            // Choices are made from the last bytes on; those without bytes are the plainest.
            let shortest = (0..=length).rev().map(|start| &bytes[start..]).find(|few| fails(call, few));
            panic!("seed {seed}, bytes {:?}: the last fault above", shortest.unwrap_or(&bytes));
        }
    }
    let results = RESULTS.get();
    assert!(results >= least_results, "seed {seed}: {results} results of {cases} calls");
}

/// One test per call, with its number of cases and of results.
macro_rules! targets {
    ($($name:ident: $cases:literal, $least:literal;)+) => {
        $(#[test]
        fn $name() {
            fuzz($cases, $least, calls::$name);
        })+
    };
}

targets! {
    readers: 5000, 5000;
    align: 150, 20;
    align_large: 8, 1;
    views: 120, 3;
    track: 40, 4;
    evaluate: 100, 20;
    register: 30, 3;
    estimate_sim3: 200, 20;
}
