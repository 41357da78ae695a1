//! Bodies for physics simulators, of meshes at their poses: convex parts for collisions, mass and inertia, and poses at which
//! they rest.
//!
//! The world is in metres with z up; the ground is z = 0.

pub mod apart;
pub mod body;
pub mod columns;
pub mod ground;
pub mod mass;
pub mod part;
pub mod rest;
pub mod scene;
pub mod solid;
pub mod walls;
