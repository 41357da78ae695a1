//! The generated sets: a case follows from set, seed and index alone.

mod images;
mod scenes;
mod sequences;
mod single;

use crate::case::{Case, CaseObject, MISFIT};
use crate::conditions::{COLORS, Class, Conditions, GENERAL, MONOCULAR, SENSORS, SURPLUS, Tier};
use crate::effects::generator::Prior;
use crate::prelude::*;

/// Maximum number of draws of a case.
const DRAWS: u64 = 400;

named! {
    /// A generated set.
    pub enum Set: "set" {
        /// One object: errors of segmentation models, depth models and generated meshes.
        General = "general",
        /// One object: effects of depth sensors and of the sources of masks.
        Sensors = "sensors",
        /// One coloured object, its photo and a coloured mesh.
        Colors = "colors",
        /// One object, whose mesh has parts that are not of the object.
        Surplus = "surplus",
        /// Cases of the general set with the mesh of another object: no pose is right.
        Misfits = "misfits",
        /// One object in depth as depth models give it.
        Monocular = "monocular",
        /// Two to four objects on a desk with clutter.
        Scenes = "scenes",
        /// Two to twelve objects that also lean, hang, stand on each other and on boards, and lie in piles.
        Arranged = "arranged",
        /// The objects of [`Set::Scenes`], each alone: 338 of 100 scenes.
        Clutter = "clutter",
        /// [`Set::Clutter`] with meshes of the smooth prior.
        ClutterSmooth = "clutter-smooth",
        /// Scenes whose meshes a generator has placed.
        Placements = "placements",
        /// Two to eight cameras around an object.
        Views = "views",
        /// Videos of an object on a table.
        Videos = "videos",
    }
}

impl Set {
    /// The rows of the benchmark, see [`crate::bench::options::Row`].
    pub fn rows(self) -> &'static [&'static str] {
        match self {
            Self::Colors => &["align:", "shape alone: color=false"],
            Self::Monocular => &[
                "filled: model=filled",
                "scaled: model=scaled",
                "scale-invariant: model=scale-invariant",
                "shifted: model=shifted",
                "disparity: model=disparity",
                "disparity-8: model=disparity-8",
                "bent: model=bent",
                "blurred: model=blurred",
                "blurred-disparity: model=blurred-disparity",
                "mild: model=mild",
                "focal-wrong: model=focal-wrong",
                "focal-unknown: model=focal-unknown",
                "disparity-focal-unknown: model=disparity-focal-unknown",
            ],
            Self::Scenes | Self::Arranged => &["alone:", "together: call=scene"],
            Self::Placements => &[
                "the generator's own: call=placement",
                "align:",
                "align, initial: initial=true",
                "align, up: up=true",
                "alignScene: call=scene",
                "alignScene, initial: call=scene initial=true",
            ],
            Self::Views => &[
                "one view: call=views views=1",
                "known cameras: call=views",
                "unknown cameras: call=views cameras=false",
            ],
            Self::Videos => &["all masks: call=track", "first mask: call=track masks=1"],
            _ => &["align:"],
        }
    }

    /// Whether the objects of a case are written to case folders of their own.
    pub fn is_of_objects(self) -> bool {
        matches!(self, Self::Clutter | Self::ClutterSmooth)
    }

    /// A case. `frames` is the length of videos.
    ///
    /// # Errors
    /// [`ErrorCode::Internal`] in case of a bug in the generator.
    pub fn case(self, seed: u64, index: usize, frames: usize) -> Result<Case> {
        if self == Self::Misfits {
            let other = Self::General.case(seed, index + 1, frames)?.objects.remove(0);
            let mut case = Self::General.case(seed, index, frames)?;
            case.name = format!("{MISFIT}-{}", case.name);
            case.objects[0] = CaseObject { class: MISFIT.into(), ..other };
            return Ok(case);
        }
        let drawn_as = if self.is_of_objects() { Self::Scenes } else { self };
        let tier = Tier::of(index);
        // Each set has random streams of its own.
        let stream = u64::from(crc32fast::hash(drawn_as.as_str().as_bytes()));
        first_fit(&format!("case {index} of {}", self.as_str()), |draw| {
            let seed = mixed([seed, stream, index as u64, draw]);
            match self {
                Self::Scenes | Self::Clutter => scenes::draw(index, seed, false, Prior::Detailed),
                Self::Arranged => scenes::draw(index, seed, true, Prior::Detailed),
                Self::ClutterSmooth => scenes::draw(index, seed, false, Prior::Smooth),
                Self::Placements => scenes::placed(index, seed),
                Self::Views => sequences::views(index, seed),
                Self::Videos => sequences::video(index, seed, frames),
                _ => single::draw(index, seed, Conditions { tier, class: self.class(index) }),
            }
        })
    }

    /// The class of a case with one object: tiers take turns, then the classes of the tier.
    fn class(self, index: usize) -> &'static Class {
        let classes = match self {
            Self::Sensors => SENSORS,
            Self::Colors => COLORS,
            Self::Surplus => SURPLUS,
            Self::Monocular => MONOCULAR,
            _ => GENERAL[index % 3],
        };
        &classes[index / 3 % classes.len()]
    }
}

/// The first draw that fits. `what` is drawn, for the error.
fn first_fit<T>(what: &str, draw: impl FnMut(u64) -> Result<Option<T>>) -> Result<T> {
    let fit = (0..DRAWS).map(draw).find_map(Result::transpose);
    fit.unwrap_or_else(|| {
        let found = format!("no fitting draw of {what}");
        Err(Error::new(ErrorCode::Internal, "draw", found, "one in a few", "Please report the seed."))
    })
}
