//! Procedural objects: metres, z up, standing on the plane z = 0.

mod figures;
mod kitchen;
pub mod mesh;
pub mod print;
pub mod solid;
mod tools;

use solid::Solid;

use crate::prelude::*;

/// An axis of symmetry in the object's frame: direction, and how many times it looks the same in a full turn.
pub type Axis = (DVec3, Option<u32>);

/// An object under construction by a family.
#[derive(Debug, Default)]
pub struct Draft {
    pub solid: Solid,
    /// The symmetry of the object.
    pub symmetry: Vec<Axis>,
    /// Parts of which at least one must be visible to determine the orientation.
    pub keys: Vec<usize>,
    /// Parts that a generator may omit.
    pub losable: Vec<usize>,
}

/// An object.
#[derive(Debug, Clone)]
pub struct Object {
    pub family: &'static str,
    pub mesh: Mesh,
    /// The part of each triangle.
    pub parts: Vec<usize>,
    pub symmetry: Vec<Axis>,
    pub keys: Vec<usize>,
    pub losable: Vec<usize>,
}

/// Families from which objects are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pool {
    /// Those whose shape determines the orientation.
    Common,
    Detailed,
    All,
    Thin,
    /// Objects that look almost the same after a half turn: phone, toy car, banana.
    Ambiguous,
    /// Objects that can lose a part without losing their orientation.
    Losable,
    /// Shapes that do not determine the orientation.
    Symmetric,
    /// All that fit on a desk.
    Desk,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Common,
    Thin,
    Ambiguous,
    Furniture,
    Symmetric,
}

/// A family: its name, its maker, and its kind.
struct Family(&'static str, fn(&mut Draft, &mut Random), Kind);

/// The box, which is the most common symmetric shape, is drawn twice as often.
const FAMILIES: &[Family] = &[
    Family("mug", kitchen::mug, Kind::Common),
    Family("bottle", kitchen::bottle, Kind::Common),
    Family("bowl", kitchen::bowl, Kind::Common),
    Family("teapot", kitchen::teapot, Kind::Common),
    Family("spoon", kitchen::spoon, Kind::Thin),
    Family("hammer", tools::hammer, Kind::Common),
    Family("drill", tools::drill, Kind::Common),
    Family("scissors", tools::scissors, Kind::Thin),
    Family("box", tools::carton, Kind::Common),
    Family("phone", tools::phone, Kind::Ambiguous),
    Family("chair", figures::chair, Kind::Furniture),
    Family("shoe", figures::shoe, Kind::Common),
    Family("animal", figures::animal, Kind::Common),
    Family("car", figures::car, Kind::Ambiguous),
    Family("banana", figures::banana, Kind::Ambiguous),
    Family("box", tools::carton, Kind::Symmetric),
    Family("block", tools::block, Kind::Symmetric),
    Family("book", tools::book, Kind::Symmetric),
    Family("can", kitchen::can, Kind::Symmetric),
    Family("bottle", kitchen::bottle, Kind::Symmetric),
    Family("box", tools::carton, Kind::Symmetric),
];

impl Family {
    fn draft(&self, random: &mut Random) -> Draft {
        let mut draft = Draft::default();
        (self.1)(&mut draft, random);
        draft
    }

    fn is_in(&self, pool: Pool) -> bool {
        let is_common = matches!(self.2, Kind::Common | Kind::Furniture);
        match pool {
            Pool::Common => is_common,
            Pool::Detailed => is_common || self.2 == Kind::Thin,
            Pool::All => self.2 != Kind::Symmetric,
            Pool::Thin => self.2 == Kind::Thin,
            Pool::Ambiguous => self.2 == Kind::Ambiguous,
            Pool::Losable => self.2 != Kind::Symmetric && !self.draft(&mut Random::new(0, 0)).losable.is_empty(),
            Pool::Symmetric => self.2 == Kind::Symmetric,
            Pool::Desk => !matches!(self.2, Kind::Symmetric | Kind::Furniture),
        }
    }
}

impl Object {
    /// Draws an object.
    pub fn draw(pool: Pool, random: &mut Random) -> Result<Self> {
        let families: Vec<&Family> = FAMILIES.iter().filter(|family| family.is_in(pool)).collect();
        let family = families[random.below(families.len())];
        let Draft { solid, symmetry, keys, losable } = family.draft(random);
        let (mesh, parts) = solid.finish()?;
        Ok(Self { family: family.0, mesh, parts, symmetry, keys, losable })
    }

    /// The diagonal of its bounding box, metres.
    pub fn diagonal(&self) -> f64 {
        self.mesh.diagonal()
    }
}
