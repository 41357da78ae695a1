//! `sim3align-lab`: benchmarks over generated cases and case folders.

mod commands;

use std::process::ExitCode;

use clap::{Parser, Subcommand};
use commands::{Failure, bench, profile, registration};

/// Benchmarks of sim3align over generated cases and case folders.
#[derive(Parser)]
#[command(name = "sim3align-lab")]
struct Program {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Aligns cases with a known truth, and prints tables
    Bench(bench::Arguments),
    /// Aligns case folders, and prints CPU times and counts of work as JSON
    Profile(profile::Arguments),
    /// Writes pairs of clouds, and registers them
    #[command(subcommand)]
    Registration(registration::Arguments),
}

fn main() -> ExitCode {
    let outcome = match Program::parse().command {
        Command::Bench(arguments) => bench::run(&arguments),
        Command::Profile(arguments) => profile::run(&arguments),
        Command::Registration(arguments) => registration::run(&arguments),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(Failure::Usage(error)) => {
            eprintln!("sim3align-lab: {error}");
            ExitCode::from(2)
        }
        Err(Failure::Failed(message)) => {
            eprintln!("sim3align-lab: {message}");
            ExitCode::FAILURE
        }
    }
}
