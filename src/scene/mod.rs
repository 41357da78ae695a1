//! Scenes: several objects in one view, and what they stand on.
//!
//! Each object is first aligned alone, by the search of `align`. What it leaves (its candidates, and the space that the
//! best one takes) then tells the others: who hides whom, what they stand on, and whose volume is taken. With that, each
//! object searches again among its own candidates. Every step is a function of one object and of what the others have
//! handed over, so that objects can go side by side, and the result does not depend on how many do.

pub mod contact;
pub mod layers;
pub mod local;
pub mod placement;
pub mod plan;
pub mod plane;
pub mod planes;
pub mod support;
pub mod task;
