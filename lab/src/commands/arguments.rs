//! The arguments of a command: each is asked for once, by its name, and what nobody asked for is an error.

use std::ffi::OsString;
use std::fmt::Display;
use std::str::FromStr;

use super::{Failure, usage};
use sim3align_lab::prelude::*;

/// A command that reads its arguments by itself.
pub struct Command {
    /// Its name.
    pub name: &'static str,
    /// What it does, in a line.
    pub about: &'static str,
    /// Its usage.
    pub usage: &'static str,
    /// Runs it.
    pub run: fn(&mut Arguments) -> Result<(), Failure>,
}

/// The arguments after the name of such a command.
#[derive(clap::Args)]
pub struct Rest {
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    words: Vec<OsString>,
}

impl Rest {
    /// Runs the command.
    pub fn run(self, command: Command) -> Result<(), Failure> {
        if self.words.iter().any(|word| word == "--help") {
            println!("{}: {}\n\n{}", command.name, command.about, command.usage);
            return Ok(());
        }
        (command.run)(&mut Arguments::new(self.words.into_iter()))
    }
}

/// The arguments that have not been asked for yet.
pub struct Arguments(Vec<OsString>);

impl Arguments {
    /// The arguments after the name of the command.
    pub fn new(arguments: impl Iterator<Item = OsString>) -> Self {
        Self(arguments.collect())
    }

    /// Whether an option without value is given.
    pub fn flag(&mut self, name: &str) -> bool {
        let before = self.0.len();
        self.0.retain(|argument| argument.to_str().is_none_or(|word| word.strip_prefix("--") != Some(name)));
        self.0.len() < before
    }

    /// The texts of an option that may be repeated.
    pub fn all(&mut self, name: &str) -> Result<Vec<String>, Failure> {
        let mut found = Vec::new();
        while let Some(at) = self.place(name) {
            let option = self.0.remove(at);
            let text = match option.to_str().and_then(|option| option.split_once('=')) {
                Some((_, text)) => text.into(),
                None if at < self.0.len() => self.0.remove(at),
                None => return Err(usage(format!("--{name} without a value"))),
            };
            found.push(text.into_string().map_err(|text| usage(format!("--{name} {text:?}: no text")))?);
        }
        Ok(found)
    }

    /// The value of an option; that given last counts.
    pub fn optional<T: FromStr<Err: Display>>(&mut self, name: &str) -> Result<Option<T>, Failure> {
        let text = self.all(name)?.pop();
        text.map(|text| text.parse().map_err(|error| usage(format!("--{name} {text:?}: {error}")))).transpose()
    }

    /// The value of an option, or its default.
    pub fn value<T: FromStr<Err: Display>>(&mut self, name: &str, default: T) -> Result<T, Failure> {
        Ok(self.optional(name)?.unwrap_or(default))
    }

    /// The values of an option with commas between them.
    pub fn list<T: FromStr<Err: Display>>(&mut self, name: &str) -> Result<Option<Vec<T>>, Failure> {
        let parse =
            |part: &str| part.trim().parse().map_err(|error| usage(format!("--{name} {:?}: {error}", part.trim())));
        self.optional::<String>(name)?.map(|text| text.split(',').map(parse).collect()).transpose()
    }

    /// Number of threads: by default, one for each processor.
    pub fn threads(&mut self, name: &str) -> Result<usize, Failure> {
        let all = std::thread::available_parallelism().map_or(1, usize::from);
        Ok(self.value(name, all)?.max(1))
    }

    /// The first argument, if it is a word and not an option.
    pub fn word(&mut self) -> Option<String> {
        let first = self.0.first()?.to_str().filter(|word| !word.starts_with('-'))?.to_owned();
        self.0.remove(0);
        Some(first)
    }

    /// What is not an option, once all options have been asked for.
    pub fn rest(&mut self) -> Result<Vec<String>, Failure> {
        let rest = core::mem::take(&mut self.0).into_iter().map(|word| match word.into_string() {
            Ok(word) if word.starts_with("--") => Err(usage(format!("invalid option {word:?}"))),
            Ok(word) => Ok(word),
            Err(word) => Err(usage(format!("{word:?}: no text"))),
        });
        rest.collect()
    }

    /// Nothing beside the options.
    pub fn end(&mut self) -> Result<(), Failure> {
        match self.rest()?.first() {
            Some(word) => Err(usage(format!("unexpected argument {word:?}"))),
            None => Ok(()),
        }
    }

    /// Where an option is: `--name`, or `--name=value`.
    fn place(&self, name: &str) -> Option<usize> {
        self.0.iter().position(|argument| {
            let option = argument.to_str().and_then(|word| word.strip_prefix("--")).unwrap_or_default();
            option.split('=').next() == Some(name)
        })
    }
}
