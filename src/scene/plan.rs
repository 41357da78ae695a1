//! The plan of a scene: rounds in which every object is aligned by itself, and the results of a round for the next.

use core::ops::ControlFlow;
use std::rc::Rc;

use serde::{Deserialize, Serialize};

use super::contact::{Contact, contacts};
use super::local::View;
use super::placement::Placement;
use super::plane::Plane;
use super::support::{Ground, Support, find_support};
use crate::error::{Error, ErrorCode, Result};
use crate::geometry::pinhole::Pinhole;
use crate::precise::scoring::scene_term::{SceneContext, SupportPlane};
use crate::precise::search::start::WarmStart;

/// Confidence from which on an object takes space.
const SOLID: f64 = 0.5;

/// The knowledge before a round. Its objects can be aligned in any order, side by side, and in other threads: none needs
/// more than the plan and its own input.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct Plan {
    /// `None` before the first round: each object is aligned alone.
    state: Option<SceneState>,
}

/// The placements of the objects, and their support.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct SceneState {
    camera: Pinhole,
    placements: Vec<Option<Placement>>,
    support: Option<Plane>,
    /// Of the support.
    confidence: Option<f64>,
    grounds: Vec<Option<Ground>>,
}

/// The poses of the objects of a scene, and their support.
#[derive(Debug, Serialize)]
pub struct Arrangement {
    /// Each object; `None` for one that could not be aligned.
    pub objects: Vec<Option<Arranged>>,
    /// Their support.
    pub support: Option<Support>,
}

/// An object in its final pose: contacts move it, and do not turn it.
#[derive(Debug, Serialize)]
pub struct Arranged {
    /// The translation of its pose, metres.
    pub translation: [f64; 3],
    /// The matrix of its pose.
    pub matrix: [f64; 16],
    /// Its contact.
    pub contact: Contact,
}

impl Plan {
    /// The start of an object in this round: the state of its own search and the scene around it. `None` if it is aligned alone.
    ///
    /// # Errors
    /// [`missing`] for an object that could not be aligned.
    pub fn warm_start(&self, object: usize) -> Result<Option<WarmStart<'_>>> {
        let Some(SceneState { placements, grounds, .. }) = &self.state else { return Ok(None) };
        let own = placements.get(object).and_then(Option::as_ref).ok_or_else(missing)?;
        let ground = grounds.get(object).copied().flatten();
        let support_plane =
            |Ground { plane, gap_m, .. }| SupportPlane { normal: plane.normal, offset_m: plane.d, gap_m };
        let others = placements.iter().enumerate().filter(|(k, _)| *k != object).filter_map(|(_, p)| p.as_ref());
        // A body that is probably elsewhere takes no space.
        let layers = others.filter(|p| p.search_state.confidence > SOLID).map(|p| Rc::clone(&p.body.layer)).collect();
        Ok(Some(WarmStart {
            earlier: &own.search_state,
            context: SceneContext { plane: ground.map(support_plane), layers },
        }))
    }

    /// Another round or the end, from the placements of a round, one per object: `None` for an object that could not be
    /// aligned, which stays out of the rounds that follow. With `snap`, objects are put exactly onto what they touch.
    ///
    /// # Errors
    /// Those of `view`, which is only called if it is needed.
    pub fn next(
        &self,
        placements: Vec<Option<Placement>>,
        snap: bool,
        view: impl FnOnce() -> Result<View>,
    ) -> Result<ControlFlow<Arrangement, Self>> {
        let Some(SceneState { camera, support, confidence, grounds, .. }) = &self.state else {
            let view = view()?;
            let (found, grounds) = find_support(&view, &placements);
            let (support, confidence) = found.map(|found| (found.plane, found.confidence)).unzip();
            let state = SceneState { camera: view.camera, placements, support, confidence, grounds };
            return Ok(ControlFlow::Continue(Self { state: Some(state) }));
        };
        let split = |placement: Option<Placement>| placement.map(|p| (p.camera_from_mesh, p.body)).unzip();
        let (poses, bodies): (Vec<_>, Vec<_>) = placements.into_iter().map(split).unzip();
        let contacts = contacts(&bodies, grounds, support.as_ref(), camera, snap);
        let mut objects = Vec::with_capacity(grounds.len());
        for ((pose, contact), ground) in poses.into_iter().zip(contacts).zip(grounds) {
            objects.push(pose.zip(contact).map(|(pose, contact)| Arranged::new(pose, contact, ground.as_ref())));
        }
        let support = support.zip(*confidence).map(|(plane, confidence)| Support { plane, confidence });
        Ok(ControlFlow::Break(Arrangement { objects, support }))
    }
}

impl Arranged {
    /// An object with this pose, moved along the normal of its ground onto what it touches.
    fn new(mut matrix: [f64; 16], contact: Contact, ground: Option<&Ground>) -> Self {
        if let Some(ground) = ground.filter(|_| contact.snapped_m != 0.0) {
            let shift = ground.plane.normal * contact.snapped_m;
            matrix[12..].iter_mut().zip(shift.to_array()).for_each(|(x, shift)| *x += shift);
        }
        Self { translation: [matrix[12], matrix[13], matrix[14]], matrix, contact }
    }
}

/// The error for a step without what the one before should have left.
pub fn missing() -> Error {
    Error::new(
        ErrorCode::Internal,
        "scene",
        "an object without a pose",
        "a pose of every object",
        "Please report this.",
    )
}
