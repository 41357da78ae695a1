//! The generated sets: a case follows from set, seed and index alone.

mod images;
mod scenes;
mod single;
mod videos;

use crate::case::Case;
use crate::conditions::{COLORS, Class, Conditions, GENERAL, SENSORS, Tier};
use crate::prelude::*;

/// Maximum number of draws of a case.
const DRAWS: u64 = 400;

named! {
    /// A generated set.
    pub enum Set {
        /// One object: errors of segmentation models, depth models and generated meshes.
        General = "general",
        /// One object: effects of depth sensors and of the sources of masks.
        Sensors = "sensors",
        /// One coloured object, its photo and a coloured mesh.
        Colors = "colors",
        /// Two to four objects on a desk with clutter.
        Scenes = "scenes",
        /// Videos of an object on a table.
        Videos = "videos",
    }
}

impl Set {
    /// The rows of the benchmark, see [`crate::bench::row::Row`].
    pub fn rows(self) -> &'static [&'static str] {
        match self {
            Self::General | Self::Sensors => &["align:"],
            Self::Colors => &["align:", "shape alone: color=false"],
            Self::Scenes => &["alone:", "together: call=scene"],
            Self::Videos => &["all masks: call=track", "first mask: call=track masks=1"],
        }
    }

    /// A case. `frames` is the length of videos.
    ///
    /// # Errors
    /// [`ErrorCode::Internal`] in case of a bug in the generator.
    pub fn case(self, seed: u64, index: usize, frames: usize) -> Result<Case> {
        // Each set has random streams of its own.
        let stream = u64::from(crc32fast::hash(self.as_str().as_bytes()));
        let draw = |draw: u64| {
            let seed = mixed([seed, stream, index as u64, draw]);
            match self {
                Self::Scenes => scenes::draw(index, seed),
                Self::Videos => videos::draw(index, seed, frames),
                _ => single::draw(index, seed, Conditions { tier: Tier::of(index), class: self.class(index) }),
            }
        };
        let fit = (0..DRAWS).map(draw).find_map(Result::transpose);
        fit.unwrap_or_else(|| {
            let found = format!("no fitting draw of case {index} of {}", self.as_str());
            Err(Error::new(ErrorCode::Internal, "draw", found, "one in a few", "Please report the seed."))
        })
    }

    /// The class of a case with one object: tiers take turns, then the classes of the tier.
    fn class(self, index: usize) -> &'static Class {
        let classes = match self {
            Self::Sensors => SENSORS,
            Self::Colors => COLORS,
            _ => GENERAL[index % 3],
        };
        &classes[index / 3 % classes.len()]
    }
}
