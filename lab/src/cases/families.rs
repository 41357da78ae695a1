//! The families of procedural objects, and random draws of objects from them.

use super::draft::{Draft, Object};
use super::scans::Scan;
use super::tier::{Class, Tier};
use super::{figures, kitchen, tools};
use crate::prelude::*;

/// A family: its name, its maker, and whether it is thin, or almost the same turned half round.
struct Family(&'static str, fn(&mut Draft, &mut Random), Kind);

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Common,
    Thin,
    Ambiguous,
}

const FAMILIES: &[Family] = &[
    Family("mug", kitchen::mug, Kind::Common),
    Family("bottle", kitchen::bottle, Kind::Common),
    Family("bowl", kitchen::bowl, Kind::Common),
    Family("teapot", kitchen::teapot, Kind::Common),
    Family("pitcher", kitchen::pitcher, Kind::Common),
    Family("spoon", kitchen::spoon, Kind::Thin),
    Family("hammer", tools::hammer, Kind::Common),
    Family("drill", tools::drill, Kind::Common),
    Family("scissors", tools::scissors, Kind::Thin),
    Family("wrench", tools::wrench, Kind::Thin),
    Family("box", tools::carton, Kind::Common),
    Family("phone", tools::phone, Kind::Ambiguous),
    Family("camera", tools::camera, Kind::Common),
    Family("lamp", tools::lamp, Kind::Common),
    Family("chair", figures::chair, Kind::Common),
    Family("shoe", figures::shoe, Kind::Common),
    Family("animal", figures::animal, Kind::Common),
    Family("car", figures::car, Kind::Ambiguous),
    Family("banana", figures::banana, Kind::Ambiguous),
    Family("sofa", figures::sofa, Kind::Common),
];

/// Families whose shape does not tell how an object is turned. The box stands here twice, to be drawn twice as often.
const SYMMETRIC: &[Family] = &[
    Family("box", tools::carton, Kind::Common),
    Family("block", tools::block, Kind::Common),
    Family("book", tools::book, Kind::Common),
    Family("can", kitchen::can, Kind::Common),
    Family("bottle", kitchen::bottle, Kind::Common),
    Family("box", tools::carton, Kind::Common),
];

/// Families that stand on the floor.
const FURNITURE: &[&str] = &["chair", "sofa"];

/// Fraction of the eligible cases that show a scan, if scans are available.
const SCANS: f64 = 0.35;

impl Family {
    fn draft(&self, random: &mut Random) -> Draft {
        let mut draft = Draft::default();
        (self.1)(&mut draft, random);
        draft
    }

    fn object(&self, random: &mut Random) -> Result<Object> {
        let Draft { solid, symmetry, keys, losable } = self.draft(random);
        let (mesh, parts) = solid.finish()?;
        Ok(Object { family: self.0.into(), mesh, parts, symmetry, keys, losable, any_side_up: false })
    }
}

/// Draws an object for a case.
pub(crate) fn draw(random: &mut Random, tier: Tier, class: Class, scans: &[Scan]) -> Result<Object> {
    if class.is_symmetric() {
        return draw_symmetric(random);
    }
    let free = !matches!(class, Class::Thin | Class::Ambiguous | Class::MissingPart);
    if free && !scans.is_empty() && chance(random, SCANS) {
        return scans[random.below(scans.len())].object(random);
    }
    let fits = |family: &&Family| match class {
        Class::Thin => family.2 == Kind::Thin,
        Class::Ambiguous => family.2 == Kind::Ambiguous,
        // A part that can be lost without losing what tells how the object is turned.
        Class::MissingPart => !family.draft(&mut Random::new(0, 0)).losable.is_empty(),
        // What is almost the same turned half round is no easy case.
        _ => family.2 == Kind::Common || (family.2 == Kind::Thin && tier != Tier::Easy) || tier == Tier::Hard,
    };
    let families: Vec<&Family> = FAMILIES.iter().filter(fits).collect();
    families[random.below(families.len())].object(random)
}

/// Draws an object whose shape does not tell how it is turned.
pub(crate) fn draw_symmetric(random: &mut Random) -> Result<Object> {
    SYMMETRIC[random.below(SYMMETRIC.len())].object(random)
}

/// Draws an object of any family that fits on a desk with others.
pub(crate) fn draw_for_desk(random: &mut Random) -> Result<Object> {
    let families: Vec<&Family> = FAMILIES.iter().filter(|Family(name, ..)| !FURNITURE.contains(name)).collect();
    families[random.below(families.len())].object(random)
}

/// Draws an object of a family by name.
///
/// # Errors
/// Only in case of a bug in the generator, such as an unknown name.
pub(crate) fn draw_from(name: &str, random: &mut Random) -> Result<Object> {
    let family = FAMILIES.iter().find(|Family(family, ..)| *family == name).ok_or_else(|| {
        Error::new(ErrorCode::Internal, "family", "none", format!("one named {name}"), "Please report it.")
    })?;
    family.object(random)
}
