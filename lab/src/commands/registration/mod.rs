//! `registration`: writes pairs of clouds with a known transform, and runs registration methods over them.

mod method;
mod run;
mod table;

use sim3align_lab::clouds::generated::write_pairs;
use sim3align_lab::prelude::*;

use super::Failure;

/// Writes pairs of clouds, and registers them.
#[derive(clap::Subcommand)]
pub enum Arguments {
    /// Writes pairs of decreasing overlap: rooms in 3DMatch's layout, drives in KITTI's
    Write {
        kind: Kind,
        folder: PathBuf,
        #[arg(long, default_value_t = 0)]
        seed: u64,
        /// Number of rooms or drives
        #[arg(long, default_value_t = 4)]
        scenes: u32,
    },
    /// Registers pairs and prints a Markdown table of recall and errors
    Run(run::Arguments),
}

/// A kind of generated pairs.
#[derive(Clone, Copy, PartialEq, clap::ValueEnum)]
pub enum Kind {
    Rooms,
    Lidar,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    match arguments {
        Arguments::Write { kind, folder, seed, scenes } => {
            Ok(write_pairs(folder, *kind == Kind::Lidar, *seed, *scenes)?)
        }
        Arguments::Run(arguments) => run::run(arguments),
    }
}
