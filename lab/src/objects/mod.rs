//! Procedural objects: metres, z up, standing on the plane z = 0.

mod families;
pub mod mesh;
pub mod print;
pub mod solid;

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
    /// Objects that look almost the same after a half turn.
    Ambiguous,
    /// Objects that can lose a part without losing their orientation.
    Losable,
    /// Shapes that do not determine the orientation.
    Symmetric,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Common,
    Thin,
    Ambiguous,
    Symmetric,
}

/// A family: its name, its maker, and its kind.
struct Family(&'static str, fn(&mut Draft, &mut Random), Kind);

/// The box, which is the most common symmetric shape, is drawn twice as often.
const FAMILIES: &[Family] = &[
    Family("mug", families::mug, Kind::Common),
    Family("bottle", families::bottle, Kind::Common),
    Family("bowl", families::bowl, Kind::Common),
    Family("box", families::carton, Kind::Common),
    Family("drill", families::drill, Kind::Common),
    Family("shoe", families::shoe, Kind::Common),
    Family("animal", families::animal, Kind::Common),
    Family("spoon", families::spoon, Kind::Thin),
    Family("hammer", families::hammer, Kind::Thin),
    Family("phone", families::phone, Kind::Ambiguous),
    Family("car", families::car, Kind::Ambiguous),
    Family("banana", families::banana, Kind::Ambiguous),
    Family("box", families::carton, Kind::Symmetric),
    Family("block", families::block, Kind::Symmetric),
    Family("book", families::book, Kind::Symmetric),
    Family("can", families::can, Kind::Symmetric),
    Family("bottle", families::bottle, Kind::Symmetric),
    Family("box", families::carton, Kind::Symmetric),
];

impl Family {
    fn draft(&self, random: &mut Random) -> Draft {
        let mut draft = Draft::default();
        (self.1)(&mut draft, random);
        draft
    }

    fn is_in(&self, pool: Pool) -> bool {
        match pool {
            Pool::Common => self.2 == Kind::Common,
            Pool::Detailed => matches!(self.2, Kind::Common | Kind::Thin),
            Pool::All => self.2 != Kind::Symmetric,
            Pool::Thin => self.2 == Kind::Thin,
            Pool::Ambiguous => self.2 == Kind::Ambiguous,
            Pool::Losable => !self.draft(&mut Random::new(0, 0)).losable.is_empty(),
            Pool::Symmetric => self.2 == Kind::Symmetric,
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
