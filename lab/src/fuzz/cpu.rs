//! The CPU time of a thread, which on a busy machine is much less than the elapsed time.

use std::time::Instant;

/// A stopwatch of this thread.
pub struct CpuTimer {
    began: Option<f64>,
    wall: Instant,
}

impl CpuTimer {
    /// Starts the stopwatch.
    pub fn start() -> Self {
        Self { began: cpu_seconds(), wall: Instant::now() }
    }

    /// CPU seconds since the start, or elapsed seconds if the system does not count CPU time.
    pub fn seconds(&self) -> f64 {
        match self.began.zip(cpu_seconds()) {
            Some((began, now)) => now - began,
            None => self.wall.elapsed().as_secs_f64(),
        }
    }
}

/// CPU seconds of this thread, on Linux.
fn cpu_seconds() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    let nanoseconds: f64 = text.split_whitespace().next()?.parse().ok()?;
    Some(nanoseconds * 1e-9)
}
