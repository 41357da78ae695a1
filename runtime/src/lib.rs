//! What every crate runs on: the error type, the scheduler of long calls, the threads that help with them, counts of work,
//! the text of numbers, and the allocator of the WebAssembly modules.

pub mod counts;
pub mod error;
#[cfg(target_arch = "wasm32")]
mod heap;
pub mod helpers;
pub mod number;
pub mod scheduler;

/// The allocator of all modules.
#[cfg(target_arch = "wasm32")]
#[global_allocator]
static ALLOCATOR: heap::Heap = heap::Heap::new();
