//! The arguments of a command: each is asked for once, by its name, and what nobody asked for is an error.

use std::ffi::OsString;
use std::fmt::Display;
use std::str::FromStr;

use super::{Failure, usage};
use sim3align_lab::prelude::*;

/// The arguments that have not been asked for yet.
pub struct Arguments(Vec<OsString>);

impl Arguments {
    /// The arguments after the name of the command.
    pub fn new(arguments: impl Iterator<Item = OsString>) -> Self {
        Self(arguments.collect())
    }

    /// Whether the usage is asked for.
    pub fn ask_for_help(&self) -> bool {
        self.0.iter().any(|argument| argument == "--help" || argument == "-h")
    }

    /// Whether an option without value is given.
    pub fn flag(&mut self, name: &str) -> bool {
        let before = self.0.len();
        self.0.retain(|argument| argument.to_str().is_none_or(|word| word.strip_prefix("--") != Some(name)));
        self.0.len() < before
    }

    /// Whether an option has a value; if so, it is taken out.
    pub fn take(&mut self, name: &str, value: &str) -> Result<bool, Failure> {
        let before = self.0.clone();
        let is_so = self.all(name)?.pop().is_some_and(|text| text == value);
        if !is_so {
            self.0 = before;
        }
        Ok(is_so)
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

    /// The paths that follow an option, up to the next option; it may be repeated.
    pub fn paths(&mut self, name: &str) -> Result<Vec<PathBuf>, Failure> {
        let mut paths = Vec::new();
        while let Some(at) = self.place(name) {
            self.0.remove(at);
            let is_path = |argument: &&OsString| !argument.to_string_lossy().starts_with("--");
            let count = self.0[at..].iter().take_while(is_path).count();
            if count == 0 {
                return Err(usage(format!("--{name} without a value")));
            }
            paths.extend(self.0.drain(at..at + count).map(PathBuf::from));
        }
        Ok(paths)
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

    /// Exactly one word beside the options: a folder.
    pub fn folder(&mut self) -> Result<PathBuf, Failure> {
        match self.rest()?.as_slice() {
            [folder] => Ok(folder.into()),
            [] => Err(usage("no folder to write to")),
            [_, second, ..] => Err(usage(format!("a second folder, {second}"))),
        }
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
