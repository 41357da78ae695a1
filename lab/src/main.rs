//! `sim3align-lab`: writes generated cases, and runs methods over cases and over pairs of clouds.

mod commands;

use std::process::ExitCode;

use commands::{Failure, bench, cases, fuzz, outlines, profile, registration, scenes, together, track, views};
use sim3align_lab::fuzz::memory::CountingAllocator;

/// For the memory of `fuzz`.
#[global_allocator]
static ALLOCATOR: CountingAllocator = CountingAllocator;

const USAGE: &str = "\
Usage: sim3align-lab COMMAND [arguments]

  case          writes one generated case folder
  scenes        writes cluttered scenes as case folders
  bench         aligns cases with a known truth, and prints tables
  together      aligns the objects of scenes alone and together, and prints tables
  registration  writes pairs of clouds, and registers them
  views         aligns one object in several views, and prints tables
  track         tracks one object through videos, and prints tables
  outlines      compares the outlines of mask, depth and photo with the true ones, and prints tables
  profile       aligns case folders natively, and prints times as JSON
  fuzz          searches for inputs on which the package fails

`sim3align-lab COMMAND --help` lists the command's arguments.";

/// Name and entry point of a command.
type Command = (&'static str, fn(lexopt::Parser) -> Result<(), Failure>);

const COMMANDS: [Command; 10] = [
    ("case", cases::main),
    ("scenes", scenes::main),
    ("bench", bench::main),
    ("together", together::main),
    ("registration", registration::main),
    ("views", views::main),
    ("track", track::main),
    ("outlines", outlines::main),
    ("profile", profile::main),
    ("fuzz", fuzz::main),
];

fn main() -> ExitCode {
    let mut arguments = std::env::args_os().skip(1);
    let name = arguments.next().unwrap_or_default();
    if name == "--help" || name == "-h" {
        println!("{USAGE}");
        return ExitCode::SUCCESS;
    }
    let Some((name, main)) = COMMANDS.into_iter().find(|(known, _)| name == **known) else {
        eprintln!("sim3align-lab: no such command: {:?}\n\n{USAGE}", name);
        return ExitCode::from(2);
    };
    match main(lexopt::Parser::from_args(arguments)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(Failure::Help(usage)) => {
            println!("{usage}");
            ExitCode::SUCCESS
        }
        Err(Failure::Usage(error, usage)) => {
            eprintln!("sim3align-lab {name}: {error}\n\n{usage}");
            ExitCode::from(2)
        }
        Err(Failure::Failed(message)) => {
            eprintln!("sim3align-lab {name}: {message}");
            ExitCode::FAILURE
        }
    }
}
