//! The score: how well the image of a pose explains the evidence.
//!
//! In: a pose, drawn on a grid. Out: a [`Score`](score::Score), 0 to about 2, and its terms; the priors and the scene term
//! that add to it; how sharply it determines the pose ([`conditioning`]); and the agreement of colours. Scores of
//! different grids and inputs are not comparable.

pub mod appearance;
pub mod conditioning;
pub mod objective;
pub mod prior;
pub mod scene_term;
pub mod score;
