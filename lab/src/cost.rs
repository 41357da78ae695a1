//! The cost of a call: the CPU time of its thread, which on a busy machine is much less than the elapsed time, and counts of
//! its work, which are the same on every machine.

use std::fs::File;
use std::time::Instant;

use sim3align::counts::{self, Counts};

thread_local! {
    /// The CPU time of this thread, on Linux. It stays open: a call of a reader takes less time than opening it.
    static SCHEDSTAT: Option<File> = File::open("/proc/thread-self/schedstat").ok();
}

/// Measures the cost of what this thread does from now on.
pub struct Meter {
    before: Counts,
    began: Option<f64>,
    wall: Instant,
}

impl Meter {
    /// A meter at zero.
    pub fn start() -> Self {
        Self { before: counts::so_far(), began: cpu_seconds(), wall: Instant::now() }
    }

    /// CPU time since the start, milliseconds, and the counts of the work.
    pub fn cost(&self) -> (Option<f64>, Option<Counts>) {
        (Some(self.milliseconds()), Some(counts::so_far().since(&self.before)))
    }

    /// CPU time since the start, or elapsed time if the system does not count CPU time.
    pub fn milliseconds(&self) -> f64 {
        let seconds = match self.began.zip(cpu_seconds()) {
            Some((began, now)) => now - began,
            None => self.wall.elapsed().as_secs_f64(),
        };
        1000.0 * seconds
    }
}

/// CPU seconds of this thread, on Linux.
#[cfg(unix)]
fn cpu_seconds() -> Option<f64> {
    use std::os::unix::fs::FileExt;

    let mut text = [0; 64];
    let length = SCHEDSTAT.with(|file| file.as_ref()?.read_at(&mut text, 0).ok())?;
    let nanoseconds = text[..length].split(|byte| *byte == b' ').next()?;
    let nanoseconds: f64 = core::str::from_utf8(nanoseconds).ok()?.parse().ok()?;
    Some(nanoseconds * 1e-9)
}

#[cfg(not(unix))]
fn cpu_seconds() -> Option<f64> {
    None
}
