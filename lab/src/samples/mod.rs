//! Generated sample cases: a mug, a hammer, a spoon and a partly hidden teapot, for the page and the tests.
//!
//! Each part has its own random stream, so that a change to one part leaves the others unchanged.

pub mod case;
pub mod depth;
pub mod shape;
pub mod table;
