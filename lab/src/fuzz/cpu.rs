//! The time that a thread has computed: on a busy machine, much less than the time that has passed.

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

    /// Seconds of computing since the start; where the system does not count them, seconds since the start.
    pub fn seconds(&self) -> f64 {
        match self.began.zip(cpu_seconds()) {
            Some((began, now)) => now - began,
            None => self.wall.elapsed().as_secs_f64(),
        }
    }
}

/// Seconds that this thread has computed, on Linux.
fn cpu_seconds() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    let nanoseconds: f64 = text.split_whitespace().next()?.parse().ok()?;
    Some(nanoseconds * 1e-9)
}
