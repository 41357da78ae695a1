//! Rows over sequences, generated or from case folders: what `views` and `track` share.

use core::ops::Range;

use sim3align_lab::parallel::parallel_map;
use sim3align_lab::prelude::*;
use sim3align_lab::sequences::Sequence;
use sim3align_lab::sequences::folder::read_sequence;

use super::{Arguments, Failure};

/// The source of a sequence.
enum Source {
    Folder(String),
    Index(usize),
}

/// The sequences of folders, and the generated ones of some indices.
pub struct Sources {
    folders: Vec<String>,
    generated: Range<usize>,
    threads: usize,
}

impl Sources {
    /// `--generated N`, `--from I`, `--threads T` and, as the last of the arguments that are asked for, the folders.
    pub fn parse(arguments: &mut Arguments) -> Result<Self, Failure> {
        let (count, from): (usize, usize) = (arguments.value("generated", 0)?, arguments.value("from", 0)?);
        let threads = arguments.value("threads", 1)?;
        Ok(Self { folders: arguments.rest()?, generated: from..from + count, threads })
    }

    /// The outcomes of `run` for the sequences of the folders, then for those that `generate` makes.
    pub fn outcomes<T: Send>(
        self,
        generate: impl Fn(usize) -> Result<Sequence> + Sync,
        run: impl Fn(&Sequence) -> Result<Vec<T>> + Sync,
    ) -> Result<Vec<T>, Failure> {
        let folders = self.folders.into_iter().map(Source::Folder);
        let sources: Vec<Source> = folders.chain(self.generated.map(Source::Index)).collect();
        let work = |source: &Source| {
            run(&match source {
                Source::Folder(folder) => read_sequence(folder.as_ref())?,
                Source::Index(index) => generate(*index)?,
            })
        };
        let outcomes = parallel_map(self.threads, &sources, work, |_| {})
            .map_err(|error| Failure::Failed(format!("{} {error}", error.code.as_str())))?;
        Ok(outcomes.into_iter().flatten().collect())
    }
}

/// Calls `print` with the name of each row, a kind of sequences, and the outcomes of both: kind by kind, then `"all"`.
/// Rows and kinds without outcomes are left out. `cell_of` returns the index of an outcome's row, and its kind.
pub fn each_row<T>(
    rows: &[&str],
    outcomes: &[T],
    cell_of: impl Fn(&T) -> (usize, &str),
    print: impl Fn(&str, &str, &[&T]),
) {
    let mut kinds: Vec<&str> = outcomes.iter().map(|outcome| cell_of(outcome).1).collect();
    kinds.sort_unstable();
    kinds.dedup();
    for (row, name) in rows.iter().enumerate() {
        for kind in kinds.iter().copied().map(Some).chain([None]) {
            let is_of = |(own_row, own_kind): (usize, &str)| own_row == row && kind.is_none_or(|kind| kind == own_kind);
            let of: Vec<&T> = outcomes.iter().filter(|outcome| is_of(cell_of(outcome))).collect();
            if !of.is_empty() {
                print(name, kind.unwrap_or("all"), &of);
            }
        }
    }
}
