//! Counts allocated memory, and refuses to exhaust the machine's.
#![allow(unsafe_code)]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

/// Bytes beyond which allocations fail: WebAssembly's own limit.
const LIMIT: i64 = 1 << 32;

// Per thread: a call runs on one, and others may run beside it. Signed, for a thread may free what another one allocated.
thread_local! {
    static CURRENT: Cell<i64> = const { Cell::new(0) };
    static PEAK: Cell<i64> = const { Cell::new(0) };
}

/// The system's allocator, counted. To be declared as the `#[global_allocator]` of a program that measures memory.
pub struct CountingAllocator;

// SAFETY: every call is passed on to the system's allocator unchanged; a null pointer reports failure.
unsafe impl GlobalAlloc for CountingAllocator {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        if !has_room(layout.size()) {
            return core::ptr::null_mut();
        }
        // SAFETY: the caller's layout.
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        if !has_room(layout.size()) {
            return core::ptr::null_mut();
        }
        // SAFETY: the caller's layout.
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        count_freed(layout.size());
        // SAFETY: the caller's pointer, which the system's allocator returned.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, new_size: usize) -> *mut u8 {
        if !has_room(new_size) {
            return core::ptr::null_mut();
        }
        count_freed(layout.size());
        // SAFETY: the caller's pointer, which the system's allocator returned.
        unsafe { System.realloc(pointer, layout, new_size) }
    }
}

/// Counts an allocation, unless it would exceed the limit.
fn has_room(bytes: usize) -> bool {
    let current = CURRENT.get().saturating_add(i64::try_from(bytes).unwrap_or(i64::MAX));
    if current > LIMIT {
        return false;
    }
    CURRENT.set(current);
    PEAK.set(PEAK.get().max(current));
    true
}

fn count_freed(bytes: usize) {
    CURRENT.set(CURRENT.get() - bytes as i64);
}

/// Forgets the peak of this thread so far.
pub fn reset_peak() {
    PEAK.set(CURRENT.get());
}

/// The most bytes that this thread had allocated at once since [`reset_peak`]; 0 where the program does not count.
pub fn peak_bytes() -> usize {
    usize::try_from(PEAK.get()).unwrap_or(0)
}
