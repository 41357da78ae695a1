//! The verdict: how far the best pose of a search can be trusted.
//!
//! In: the poses that a search has found and, where they are known, the colours of photo and mesh. Out: the best pose, the
//! probability that it is right, other poses that explain the image as well, and standard deviations. The coefficients of
//! the [`confidence`] are fitted to generated cases by `npm run fit`; a change of the score needs a new fit.

pub mod alternatives;
pub mod choice;
pub mod color;
pub mod conclusion;
pub mod confidence;
pub mod lookalikes;
pub mod stretch;
