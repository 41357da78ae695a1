//! Exports to JavaScript: conversion and validation, no logic. Only this module uses `wasm_bindgen`.

pub mod aligner;
pub mod error;
mod host;
mod input;
pub mod mesh;
mod object;
mod options;
pub mod task;
mod transform;
