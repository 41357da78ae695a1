//! Writes a generated case with a known truth.

use std::path::PathBuf;
use std::process::ExitCode;

use sim3align::samples::case::SampleCase;
use sim3align::samples::shape::Kind;

const USAGE: &str = "\
Usage: sim3align-samples OUT_DIR [--kind KIND] [--seed N]

Writes a generated case folder: depth.npy, mask.png, camera.json, mesh.glb and, with the true pose, gt.json.

  --kind KIND  what to show: mug (default)
  --seed N     0 to 18446744073709551615, default 0; the same seed gives the same bytes
  --help       this text";

struct Arguments {
    folder: PathBuf,
    kind: Kind,
    seed: u64,
}

/// `None` where help is asked for; an error says what is wrong with the arguments.
fn parse(arguments: impl IntoIterator<Item = String>) -> Result<Option<Arguments>, String> {
    let mut arguments = arguments.into_iter();
    let (mut folder, mut kind, mut seed) = (None, Kind::Mug, 0);
    while let Some(argument) = arguments.next() {
        let mut value = || arguments.next().ok_or_else(|| format!("{argument} without a value"));
        match argument.as_str() {
            "--help" | "-h" => return Ok(None),
            "--kind" => kind = Kind::from_name(&value()?).map_err(|error| error.to_string())?,
            "--seed" => {
                let text = value()?;
                seed = text.parse().map_err(|_| format!("--seed: found {text:?}, expected a whole number from 0"))?;
            }
            option if option.starts_with('-') => return Err(format!("unknown option {option}")),
            _ if folder.is_some() => return Err(format!("a second folder, {argument}")),
            _ => folder = Some(PathBuf::from(argument)),
        }
    }
    let folder = folder.ok_or("no folder to write to")?;
    Ok(Some(Arguments { folder, kind, seed }))
}

fn main() -> ExitCode {
    let arguments = match parse(std::env::args_os().skip(1).map(|a| a.to_string_lossy().into_owned())) {
        Ok(Some(arguments)) => arguments,
        Ok(None) => {
            println!("{USAGE}");
            return ExitCode::SUCCESS;
        }
        Err(message) => {
            eprintln!("sim3align-samples: {message}\n\n{USAGE}");
            return ExitCode::from(2);
        }
    };
    match SampleCase::new(arguments.kind, arguments.seed).and_then(|case| case.write(&arguments.folder)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("sim3align-samples: {error}");
            ExitCode::FAILURE
        }
    }
}
