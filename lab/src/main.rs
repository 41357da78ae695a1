//! `sim3align-lab`: writes generated cases, and runs methods over cases and over pairs of clouds.

mod commands;

use std::process::ExitCode;

use commands::{Arguments, COMMANDS, Failure};

fn usage() -> String {
    let commands = COMMANDS.iter().map(|command| format!("  {:14}{}\n", command.name, command.about));
    format!(
        "Usage: sim3align-lab COMMAND [arguments]\n\n{}\n`sim3align-lab COMMAND --help` lists the command's arguments.",
        commands.collect::<String>()
    )
}

fn main() -> ExitCode {
    let mut arguments = std::env::args_os().skip(1);
    let name = arguments.next().unwrap_or_default();
    if name == "--help" || name == "-h" {
        println!("{}", usage());
        return ExitCode::SUCCESS;
    }
    let Some(command) = COMMANDS.iter().find(|command| name == *command.name) else {
        eprintln!("sim3align-lab: no such command: {name:?}\n\n{}", usage());
        return ExitCode::from(2);
    };
    let mut arguments = Arguments::new(arguments);
    let outcome = if arguments.ask_for_help() { Err(Failure::Help) } else { (command.run)(&mut arguments) };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(Failure::Help) => {
            println!("{}", command.usage);
            ExitCode::SUCCESS
        }
        Err(Failure::Usage(error)) => {
            eprintln!("sim3align-lab {}: {error}\n\n{}", command.name, command.usage);
            ExitCode::from(2)
        }
        Err(Failure::Failed(message)) => {
            eprintln!("sim3align-lab {}: {message}", command.name);
            ExitCode::FAILURE
        }
    }
}
