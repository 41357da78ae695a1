//! The tests that run natively: the bits of native code are those of WebAssembly.
#![cfg(not(target_arch = "wasm32"))]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
// The modules are those of the tests that run as WebAssembly.
#![allow(dead_code, unused_imports)]

#[path = "../suite/calibrate.rs"]
mod calibrate;
#[path = "../suite/color.rs"]
mod color;
#[path = "../suite/fingerprints.rs"]
mod fingerprints;
#[path = "../suite/fixtures.rs"]
mod fixtures;
#[path = "../suite/observations.rs"]
mod observations;
#[path = "../suite/prelude.rs"]
mod prelude;
#[path = "../suite/scene.rs"]
mod scene;
#[path = "../suite/shapes.rs"]
mod shapes;
#[path = "../suite/support.rs"]
mod support;
#[path = "../suite/track.rs"]
mod track;
#[path = "../suite/views.rs"]
mod views;
