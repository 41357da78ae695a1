//! The process that makes the calls: it ends at the first fault.

use std::io::{Write, stdout};
use std::ops::Range;
use std::panic;
use std::process::exit;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use sim3align_lab::cpu_time::{CpuTimer, of_main_thread};
use sim3align_lab::fuzz::call::Answer;
use sim3align_lab::fuzz::choices::Choices;
use sim3align_lab::fuzz::target::{Ceilings, Execution, TARGETS, Target};

use super::super::Failure;
use super::settings::Settings;
use sim3align_lab::prelude::*;

/// Exit status after a fault that was printed.
const FAULT: i32 = 3;
/// Times the ceiling after which a call is given up: of computing, and of waiting.
const PATIENCE: [f64; 2] = [4.0, 40.0];
/// Milliseconds between looks at the current call.
const LOOK_MS: u64 = 100;

/// The number of the current call, for the watchdog and for panics.
static CURRENT: AtomicU64 = AtomicU64::new(0);

/// Makes the calls of a range of seeds, and prints `at N` now and then, `fault N words` for a fault, and `done` with
/// sums in the end.
pub fn run(target: Target, range: Range<u64>, settings: &Settings) -> Result<(), Failure> {
    CURRENT.store(range.start, Ordering::Relaxed);
    watch(settings.ceilings);
    let (mut results, mut slowest, mut largest) = (0_u64, (0.0_f64, range.start), (0_usize, range.start));
    let timer = CpuTimer::start();
    let count = range.end.saturating_sub(range.start);
    for number in range {
        CURRENT.store(number, Ordering::Relaxed);
        if settings.trace {
            println!("at {number}");
        }
        let mut choices = Choices::random(seed_of(settings.seed, number));
        let Execution { outcome, seconds, bytes, .. } = target.execute(&mut choices, &settings.ceilings);
        match outcome {
            Ok(Answer::Result) => results += 1,
            Ok(Answer::Error(_)) => {}
            Err(words) => fault(&words),
        }
        if seconds > slowest.0 {
            slowest = (seconds, number);
        }
        if bytes > largest.0 {
            largest = (bytes, number);
        }
    }
    println!(
        "done {count} {results} {} {} {} {} {}",
        timer.seconds(),
        slowest.0,
        slowest.1,
        largest.0 as f64 / 1e6,
        largest.1
    );
    Ok(())
}

/// The seed of a call.
pub fn seed_of(seed: u32, number: u64) -> u64 {
    u64::from(seed) << 32 ^ number
}

/// Replays a file of choices under the same watch; prints the arguments and the outcome.
pub fn replay(path: &Path, ceilings: &Ceilings) -> Result<(), Failure> {
    let failed = |words: String| Failure::Failed(format!("{}: {words}", path.display()));
    let target = target_of(path).ok_or_else(|| failed("neither file nor folder names a target".into()))?;
    let text = std::fs::read_to_string(path).map_err(|error| failed(error.to_string()))?;
    let choices = Choices::read(&text).map_err(|word| failed(format!("{word} is no number")))?;
    println!("{}", target.describe(&mut choices.clone()));
    watch(*ceilings);
    let Execution { outcome, seconds, bytes, .. } = target.execute(&mut choices.clone(), ceilings);
    println!("{seconds:.2} s, {} MB", bytes >> 20);
    match outcome {
        Ok(Answer::Result) => println!("a result"),
        Ok(Answer::Error(code)) => println!("the error {}", code.as_str()),
        Err(words) => fault(&words),
    }
    Ok(())
}

/// The target that the file's folder or the start of its name says; the longest such name.
fn target_of(path: &Path) -> Option<Target> {
    let name = path.file_name()?.to_str()?;
    let folder = path.parent().and_then(Path::file_name).and_then(|folder| folder.to_str());
    let fits = |target: &Target| folder == Some(target.name) || name.starts_with(&format!("{}-", target.name));
    TARGETS.into_iter().filter(fits).max_by_key(|target| target.name.len())
}

/// Reports panics and calls that do not end, and ends the process.
fn watch(ceilings: Ceilings) {
    panic::set_hook(Box::new(|info| {
        let place = info.location().map(|l| format!("{}:{}", l.file(), l.line())).unwrap_or_default();
        let words = info.payload().downcast_ref::<&str>().map(|s| (*s).to_owned());
        let words = words.or_else(|| info.payload().downcast_ref::<String>().cloned()).unwrap_or_default();
        fault(&format!("panic at {place}: {words}"));
    }));
    std::thread::spawn(move || {
        let (mut last, mut began) = (u64::MAX, (0.0, Instant::now()));
        loop {
            let current = CURRENT.load(Ordering::Relaxed);
            // Calls are made by the main thread. On a busy machine it computes for a part of the time only.
            let computing = of_main_thread();
            if current != last {
                (last, began) = (current, (computing.unwrap_or_default(), Instant::now()));
            }
            let waiting = began.1.elapsed().as_secs_f64();
            let computing = computing.map_or(waiting, |seconds| seconds - began.0);
            if computing > PATIENCE[0] * ceilings.seconds || waiting > PATIENCE[1] * ceilings.seconds {
                fault("hang: no end in sight");
            }
            println!("at {current}");
            std::thread::sleep(Duration::from_millis(LOOK_MS));
        }
    });
}

fn fault(words: &str) -> ! {
    println!("fault {} {}", CURRENT.load(Ordering::Relaxed), words.replace('\n', " "));
    // Nothing is left to do where standard output is gone.
    let _ = stdout().flush();
    exit(FAULT)
}
