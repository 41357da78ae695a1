//! Counts allocated memory, and refuses to exhaust the machine's.
#![allow(unsafe_code)]

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Bytes beyond which allocations fail: WebAssembly's own limit.
const LIMIT: u64 = 1 << 32;

static CURRENT: AtomicUsize = AtomicUsize::new(0);
static PEAK: AtomicUsize = AtomicUsize::new(0);

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
        CURRENT.fetch_sub(layout.size(), Ordering::Relaxed);
        // SAFETY: the caller's pointer, which the system's allocator returned.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, new_size: usize) -> *mut u8 {
        if !has_room(new_size) {
            return core::ptr::null_mut();
        }
        CURRENT.fetch_sub(layout.size(), Ordering::Relaxed);
        // SAFETY: the caller's pointer, which the system's allocator returned.
        unsafe { System.realloc(pointer, layout, new_size) }
    }
}

/// Counts an allocation, unless it would exceed the limit.
fn has_room(bytes: usize) -> bool {
    let current = CURRENT.fetch_add(bytes, Ordering::Relaxed).saturating_add(bytes);
    if current as u64 > LIMIT {
        CURRENT.fetch_sub(bytes, Ordering::Relaxed);
        return false;
    }
    PEAK.fetch_max(current, Ordering::Relaxed);
    true
}

/// Forgets the peak so far.
pub fn reset_peak() {
    PEAK.store(CURRENT.load(Ordering::Relaxed), Ordering::Relaxed);
}

/// The most bytes that were allocated at once since [`reset_peak`]; 0 where the program does not count.
pub fn peak_bytes() -> usize {
    PEAK.load(Ordering::Relaxed)
}
