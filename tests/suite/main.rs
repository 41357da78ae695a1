//! All Rust tests in one binary: natively under `cargo test`, in Node under wasm-bindgen-test.
