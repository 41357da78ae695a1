//! Starts the processes that make the calls, and keeps what they find.

use std::collections::BTreeMap;
use std::io::{BufRead, BufReader};
use std::ops::Range;
use std::process::{Child, Command, Stdio};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use sim3align_lab::fuzz::choices::Choices;
use sim3align_lab::fuzz::minimise::minimise;
use sim3align_lab::fuzz::target::Target;

use super::super::Failure;
use super::child::seed_of;
use super::settings::Settings;
use sim3align_lab::prelude::*;

/// Trials of the minimisation of one fault, and of one that takes long.
const TRIALS: [usize; 2] = [300, 20];
/// Factor on `--executions` for readers.
const READER_CALLS: u64 = 1000;
/// Faults after which a target is left alone.
const MAX_FAULTS: usize = 20;

/// Sums of a target.
#[derive(Debug, Clone, Default)]
struct Sums {
    next: u64,
    executions: u64,
    results: u64,
    seconds: f64,
    slowest: (f64, u64),
    largest: (f64, u64),
    faults: usize,
}

/// The last report of a process.
enum End {
    /// All calls returned: the sums.
    Done(Sums),
    /// A fault of the call of this number.
    Fault(u64, String),
}

/// Searches until the time is over, and prints a table.
pub fn search(settings: &Settings) -> Result<(), Failure> {
    let end = Instant::now() + Duration::from_secs_f64(60.0 * settings.minutes.clamp(0.0, 1e6));
    let sums: Mutex<BTreeMap<&str, Sums>> = Mutex::default();
    let failures: Mutex<Vec<Failure>> = Mutex::default();
    std::thread::scope(|scope| {
        for _ in 0..settings.jobs {
            scope.spawn(|| {
                while let Some((target, range)) = next_batch(settings, &sums, end) {
                    if let Err(failure) = run_batch(target, range, settings, &sums) {
                        failures.lock().unwrap_or_else(PoisonError::into_inner).push(failure);
                        break;
                    }
                }
            });
        }
    });
    if let Some(failure) = failures.into_inner().unwrap_or_else(PoisonError::into_inner).pop() {
        return Err(failure);
    }
    let sums = sums.into_inner().unwrap_or_else(PoisonError::into_inner);
    print_table(&sums);
    let faults: usize = sums.values().map(|s| s.faults).sum();
    if faults == 0 {
        return Ok(());
    }
    Err(Failure::Failed(format!("{faults} faults; their choices are in {}", settings.out.display())))
}

/// The target with the smallest share of the time so far, and its next calls; `None` at the end.
fn next_batch<'a>(
    settings: &'a Settings,
    sums: &Mutex<BTreeMap<&'a str, Sums>>,
    end: Instant,
) -> Option<(Target, Range<u64>)> {
    let mut sums = sums.lock().unwrap_or_else(PoisonError::into_inner);
    let most = |target: &Target| match settings.executions {
        Some(count) => count * if target.name == "readers" { READER_CALLS } else { 1 },
        None => u64::MAX,
    };
    if settings.executions.is_none() && Instant::now() >= end {
        return None;
    }
    let open = settings.targets.iter().filter(|target| {
        let known = sums.get(target.name).cloned().unwrap_or_default();
        known.next < most(target) && known.faults < MAX_FAULTS
    });
    let target = *open.min_by(|a, b| {
        let had = |t: &Target| sums.get(t.name).map_or(0.0, |s| s.seconds) / t.weight as f64;
        had(a).total_cmp(&had(b))
    })?;
    let known = sums.entry(target.name).or_default();
    let from = known.next;
    known.next = (from + target.batch).min(most(&target));
    // Running batches count a little, so that the targets take turns.
    known.seconds += 0.1;
    Some((target, from..known.next))
}

fn run_batch<'a>(
    target: Target,
    mut range: Range<u64>,
    settings: &'a Settings,
    sums: &Mutex<BTreeMap<&'a str, Sums>>,
) -> Result<(), Failure> {
    while !range.is_empty() {
        let (at, end) = calls(target, range.clone(), settings, &[])?;
        let (number, words) = match end {
            Some(End::Done(new)) => {
                let mut sums = sums.lock().unwrap_or_else(PoisonError::into_inner);
                add(sums.entry(target.name).or_default(), &new);
                return Ok(());
            }
            Some(End::Fault(number, words)) => (number, words),
            // It died without a report: the calls are repeated one at a time.
            None => crash(target, at..range.end, settings)?,
        };
        keep(target, number, &words, settings)?;
        let mut sums = sums.lock().unwrap_or_else(PoisonError::into_inner);
        let known = sums.entry(target.name).or_default();
        known.faults += 1;
        known.executions += number + 1 - range.start;
        if known.faults >= MAX_FAULTS {
            return Ok(());
        }
        drop(sums);
        range.start = number + 1;
    }
    Ok(())
}

/// Makes a range of calls in a process; the number it was at, and how it ended.
fn calls(
    target: Target,
    range: Range<u64>,
    settings: &Settings,
    flags: &[&str],
) -> Result<(u64, Option<End>), Failure> {
    let mut command = program(settings)?;
    command.args(["--target", target.name, "--range", &format!("{}..{}", range.start, range.end)]);
    command.args(flags);
    let mut at = range.start;
    let mut end = None;
    let mut child = start(&mut command)?;
    for line in lines(&mut child) {
        let mut words = line.split(' ');
        match words.next() {
            Some("at") => at = words.next().and_then(|word| word.parse().ok()).unwrap_or(at),
            Some("fault") => {
                let number = words.next().and_then(|word| word.parse().ok()).unwrap_or(at);
                end = Some(End::Fault(number, words.collect::<Vec<_>>().join(" ")));
            }
            Some("done") => end = sums_of(&words.filter_map(|word| word.parse().ok()).collect::<Vec<_>>()),
            _ => {}
        }
    }
    // The last line printed tells more than the exit status.
    let _ = child.wait();
    Ok((at, end))
}

fn sums_of(numbers: &[f64]) -> Option<End> {
    let &[executions, results, seconds, slowest, slowest_at, largest, largest_at] = numbers else { return None };
    Some(End::Done(Sums {
        executions: executions as u64,
        results: results as u64,
        seconds,
        slowest: (slowest, slowest_at as u64),
        largest: (largest, largest_at as u64),
        ..Sums::default()
    }))
}

fn add(sums: &mut Sums, new: &Sums) {
    sums.executions += new.executions;
    sums.results += new.results;
    sums.seconds += new.seconds;
    if new.slowest.0 > sums.slowest.0 {
        sums.slowest = new.slowest;
    }
    if new.largest.0 > sums.largest.0 {
        sums.largest = new.largest;
    }
}

/// Finds the call that ends its process without a report: makes the calls again, and each is announced.
fn crash(target: Target, range: Range<u64>, settings: &Settings) -> Result<(u64, String), Failure> {
    let start = range.start;
    match calls(target, range, settings, &["--trace"])? {
        (_, Some(End::Fault(number, words))) => Ok((number, words)),
        (_, Some(End::Done(_))) => Ok((start, "the process died once, and not again".into())),
        (number, None) => Ok((number, "the process died: out of memory, or of stack".into())),
    }
}

/// Minimises the choices of a fault, and writes them to a file.
fn keep(target: Target, number: u64, words: &str, settings: &Settings) -> Result<(), Failure> {
    let failed = |error: std::io::Error| Failure::Failed(format!("{}: {error}", settings.out.display()));
    println!("{} {number}: {words}", target.name);
    std::fs::create_dir_all(&settings.out).map_err(failed)?;
    let mut choices = Choices::random(seed_of(settings.seed, number));
    println!("  {}", target.describe(&mut choices));
    let path = settings.out.join(format!("{}-{}-{number}.txt", target.name, settings.seed));
    let trial = path.with_extension("trial.txt");
    let kind = kind_of(words);
    let mut failure = None;
    let smallest = minimise(choices.taken(), TRIALS[usize::from(kind == "slow")], |list| {
        let same = write(&trial, list, words).map_err(failed).and_then(|()| replayed(&trial, settings));
        match same {
            Ok(found) => kind_of(&found) == kind,
            Err(error) => {
                failure = Some(error);
                false
            }
        }
    });
    if let Some(failure) = failure {
        return Err(failure);
    }
    // Without trials there is none.
    let _ = std::fs::remove_file(&trial);
    println!("  smallest: {}", target.describe(&mut Choices::of(smallest.clone())));
    write(&path, &smallest, words).map_err(failed)
}

fn write(path: &Path, list: &[u32], words: &str) -> std::io::Result<()> {
    let numbers: Vec<String> = list.iter().map(u32::to_string).collect();
    std::fs::write(path, format!("# {words}\n{}\n", numbers.join(" ")))
}

/// The key by which faults are considered equal: the place of a panic, otherwise the first word.
fn kind_of(words: &str) -> String {
    if words.starts_with("slow") || words.starts_with("hang") {
        return "slow".into();
    }
    let count = if words.starts_with("panic") { 3 } else { 1 };
    words.split(' ').take(count).collect::<Vec<_>>().join(" ")
}

/// The fault of a file of choices; empty without one.
fn replayed(path: &Path, settings: &Settings) -> Result<String, Failure> {
    let mut command = program(settings)?;
    command.arg("--replay").arg(path);
    let mut child = start(&mut command)?;
    let fault = lines(&mut child).find_map(|line| line.strip_prefix("fault 0 ").map(str::to_owned));
    let status = child.wait().map_err(|error| Failure::Failed(error.to_string()))?;
    let died = status.code().is_none();
    Ok(fault.unwrap_or_else(|| if died { "the process died".into() } else { String::new() }))
}

fn program(settings: &Settings) -> Result<Command, Failure> {
    let path = std::env::current_exe().map_err(|error| Failure::Failed(error.to_string()))?;
    let mut command = Command::new(path);
    command.args(["fuzz", "--seed", &settings.seed.to_string()]);
    command.args(["--seconds", &settings.ceilings.seconds.to_string()]);
    command.args(["--megabytes", &(settings.ceilings.bytes >> 20).to_string()]);
    Ok(command)
}

fn start(command: &mut Command) -> Result<Child, Failure> {
    let piped = command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::null());
    piped.spawn().map_err(|error| Failure::Failed(error.to_string()))
}

fn lines(child: &mut Child) -> impl Iterator<Item = String> {
    child.stdout.take().into_iter().flat_map(|output| BufReader::new(output).lines().map_while(Result::ok))
}

fn print_table(sums: &BTreeMap<&str, Sums>) {
    println!("\n| target | calls | with a result | computing | slowest | most memory | faults |");
    println!("|---|---|---|---|---|---|---|");
    for (name, s) in sums {
        println!(
            "| {name} | {} | {} | {:.0} s | {:.2} s (call {}) | {:.0} MB (call {}) | {} |",
            s.executions, s.results, s.seconds, s.slowest.0, s.slowest.1, s.largest.0, s.largest.1, s.faults
        );
    }
}
