//! The targets of the fuzzer, and the ceilings of their calls.

use super::call::{Answer, Call};
use super::choices::Choices;
use super::memory::{peak_bytes, reset_peak};
use super::targets::{align, evaluate, joint, readers, register};
use crate::cpu_time::CpuTimer;

/// Time and memory that a call with default options may take.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ceilings {
    /// Seconds of computing.
    pub seconds: f64,
    /// Bytes allocated at once, with the input.
    pub bytes: usize,
}

impl Default for Ceilings {
    fn default() -> Self {
        // WebAssembly takes about half as long again as native code.
        Self { seconds: 6.0, bytes: 512 << 20 }
    }
}

/// A call that has returned.
#[derive(Debug, Clone, PartialEq)]
pub struct Execution {
    /// A short description of the arguments.
    pub description: String,
    /// The answer, or the fault.
    pub outcome: Result<Answer, String>,
    /// Seconds of computing.
    pub seconds: f64,
    /// Bytes allocated at once.
    pub bytes: usize,
}

/// A target of the fuzzer.
#[derive(Debug, Clone, Copy)]
pub struct Target {
    /// Its name on the command line, and of its folder of regression cases.
    pub name: &'static str,
    /// Share of the time, relative to the others.
    pub weight: usize,
    /// Number of executions per process.
    pub batch: u64,
    generate: fn(&mut Choices) -> Call,
}

/// All targets.
pub const TARGETS: [Target; 8] = [
    Target { name: "readers", weight: 2, batch: 200_000, generate: readers::call },
    Target { name: "align", weight: 4, batch: 200, generate: align::small },
    Target { name: "align-large", weight: 2, batch: 5, generate: align::large },
    Target { name: "views", weight: 2, batch: 100, generate: joint::views },
    Target { name: "track", weight: 2, batch: 100, generate: joint::track },
    Target { name: "evaluate", weight: 1, batch: 300, generate: evaluate::call },
    Target { name: "register", weight: 1, batch: 50, generate: register::call },
    Target { name: "estimate-sim3", weight: 1, batch: 2_000, generate: register::estimate },
];

impl Target {
    /// Makes the call with the arguments that the choices produce.
    pub fn execute(&self, choices: &mut Choices, ceilings: &Ceilings) -> Execution {
        let Call { run, description, is_bounded } = (self.generate)(choices);
        reset_peak();
        let timer = CpuTimer::start();
        let outcome = run();
        let (seconds, bytes) = (timer.seconds(), peak_bytes());
        let outcome = outcome.and_then(|answer| {
            if is_bounded && seconds > ceilings.seconds {
                return Err(format!("slow: {seconds:.1} s"));
            }
            if is_bounded && bytes > ceilings.bytes {
                return Err(format!("memory: {} MB", bytes >> 20));
            }
            Ok(answer)
        });
        Execution { description, outcome, seconds, bytes }
    }

    /// A short description of the arguments that the choices produce.
    pub fn describe(&self, choices: &mut Choices) -> String {
        (self.generate)(choices).description
    }
}

impl core::str::FromStr for Target {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        TARGETS.into_iter().find(|target| target.name == name).ok_or_else(|| format!("no target {name}"))
    }
}
