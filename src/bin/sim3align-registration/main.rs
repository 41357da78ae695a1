//! Writes pairs of clouds with a known transform, and runs registration methods over such pairs.

mod arguments;
mod method;
mod record;
mod run;
mod table;

use std::process::ExitCode;

use arguments::{Command, USAGE};

fn main() -> ExitCode {
    let command = match Command::parse(lexopt::Parser::from_env()) {
        Ok(Some(command)) => command,
        Ok(None) => {
            println!("{USAGE}");
            return ExitCode::SUCCESS;
        }
        Err(error) => {
            eprintln!("sim3align-registration: {error}\n\n{USAGE}");
            return ExitCode::from(2);
        }
    };
    match run::run(&command) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("sim3align-registration: {message}");
            ExitCode::FAILURE
        }
    }
}
