//! Structural fuzzing: inputs that are valid by type and hostile by content. No call panics, every error is typed, and every
//! result is finite.
//!
//! proptest draws and shrinks the bytes from which an [`Entropy`] makes an input; a seed gives the same inputs everywhere.
//! `SIM3ALIGN_FUZZ_SEED` chooses another one, as `npm run fuzz` does.

#![cfg(not(target_family = "wasm"))]
#![allow(clippy::unwrap_used, clippy::panic)]

mod calls;
mod entropy;
mod files;
mod images;
mod meshes;
mod options;

use std::cell::Cell;

use entropy::Entropy;
use proptest::prelude::*;
use proptest::test_runner::{Config, RngSeed, TestRunner};

/// Bytes of an input: large meshes and images are drawn from seeds, so that a few hundred suffice.
const BYTES: usize = 400;

thread_local! {
    /// Calls of this test that had a result: a fuzzer that only draws what is refused finds nothing.
    static RESULTS: Cell<u32> = const { Cell::new(0) };
}

fn fuzz(cases: u32, least_results: u32, call: fn(&mut Entropy<'_>) -> Result<(), String>) {
    let seed = std::env::var("SIM3ALIGN_FUZZ_SEED").ok().and_then(|seed| seed.parse().ok()).unwrap_or(0);
    let config = Config { cases, rng_seed: RngSeed::Fixed(seed), failure_persistence: None, ..Config::default() };
    let bytes = prop::collection::vec(any::<u8>(), 0..BYTES);
    let outcome =
        TestRunner::new(config).run(&bytes, |bytes| call(&mut Entropy::new(&bytes)).map_err(TestCaseError::fail));
    if let Err(failure) = outcome {
        panic!("seed {seed}: {failure}");
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
