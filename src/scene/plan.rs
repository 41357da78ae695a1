//! The plan of a scene: rounds in which every object is aligned by itself, and what each round tells the next.

use std::rc::Rc;

use serde::{Deserialize, Serialize};

use super::contact::{Contact, contacts};
use super::local::View;
use super::placement::{Body, Placement};
use super::plane::Plane;
use super::support::{Ground, Support, find_support};
use crate::error::{Error, ErrorCode, Result};
use crate::geometry::pinhole::Pinhole;
use crate::precise::scored::surroundings::Neighbourhood;
use crate::precise::searched::start::Told;
use crate::report::Sim3;

/// Confidence from which on an object takes space.
const SOLID: f64 = 0.5;

/// What is known before a round. Its objects can be aligned in any order, side by side, and in other threads: none needs
/// more than the plan and its own input.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub enum Plan {
    /// Nothing: each object is aligned alone.
    #[default]
    Alone,
    /// Each object is aligned with what the others have told.
    Together(Known),
}

/// What the objects have told.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Known {
    camera: Pinhole,
    placements: Vec<Option<Placement>>,
    support: Option<Plane>,
    /// Of the support.
    confidence: f64,
    grounds: Vec<Option<Ground>>,
}

/// What follows from a round.
pub enum Next {
    /// Another one.
    Round(Plan),
    /// The end.
    Done(Arrangement),
}

/// The poses of the objects of a scene, and what they stand on.
#[derive(Debug, Serialize)]
pub struct Arrangement {
    /// Each object; `None` for one that could not be aligned.
    pub objects: Vec<Option<Arranged>>,
    /// What they stand on.
    pub support: Option<Support>,
}

/// An object in its final pose.
#[derive(Debug, Serialize)]
pub struct Arranged {
    /// The pose.
    #[serde(flatten)]
    pub camera_from_mesh: Sim3,
    /// What the object rests on.
    pub contact: Contact,
}

impl Plan {
    /// What an object is told in this round: what it has found itself, and what surrounds it. `None` if it is aligned alone.
    ///
    /// # Errors
    /// [`missing`] for an object that could not be aligned.
    pub fn told(&self, object: usize) -> Result<Option<Told<'_>>> {
        let Self::Together(Known { placements, grounds, .. }) = self else { return Ok(None) };
        let own = placements.get(object).and_then(Option::as_ref).ok_or_else(missing)?;
        let ground = grounds.get(object).copied().flatten().map(|ground| ground.known());
        let others = placements.iter().enumerate().filter(|(k, _)| *k != object).filter_map(|(_, p)| p.as_ref());
        // A body that is probably elsewhere takes no space.
        let layers = others.filter(|p| p.findings.confidence > SOLID).map(|p| Rc::clone(&p.body.layer)).collect();
        Ok(Some(Told { findings: &own.findings, known: Neighbourhood { ground, layers } }))
    }

    /// What follows from the placements of a round, one per object: `None` for an object that could not be aligned, which
    /// stays out of the rounds that follow. With `snap`, objects are put exactly onto what they touch.
    ///
    /// # Errors
    /// Those of `view`, which is only called if it is needed.
    pub fn next(
        &self,
        placements: Vec<Option<Placement>>,
        snap: bool,
        view: impl FnOnce() -> Result<View>,
    ) -> Result<Next> {
        Ok(match self {
            Self::Alone => Next::Round(Self::Together(Known::of(placements, &view()?))),
            Self::Together(known) => Next::Done(known.arrangement(placements, snap)),
        })
    }
}

impl Known {
    fn of(placements: Vec<Option<Placement>>, view: &View) -> Self {
        let (support, grounds) = find_support(view, &placements);
        let confidence = support.map_or(0.0, |support| support.confidence);
        Self { camera: view.camera, placements, support: support.map(|support| support.plane), confidence, grounds }
    }

    fn arrangement(&self, placements: Vec<Option<Placement>>, snap: bool) -> Arrangement {
        let Self { camera, support, confidence, grounds, .. } = self;
        let split = |placement: Option<Placement>| placement.map(|p| (p.camera_from_mesh, p.body)).unzip();
        let (poses, bodies): (Vec<Option<Sim3>>, Vec<Option<Body>>) = placements.into_iter().map(split).unzip();
        let contacts = contacts(&bodies, grounds, support.as_ref(), camera, snap);
        let objects = poses.into_iter().zip(contacts).zip(grounds).map(|((pose, contact), ground)| {
            let (mut camera_from_mesh, contact) = pose.zip(contact)?;
            if let Some(ground) = ground {
                move_by(&mut camera_from_mesh, (ground.plane.normal * contact.snapped_m).to_array());
            }
            Some(Arranged { camera_from_mesh, contact })
        });
        let support = support.map(|plane| Support { plane, confidence: *confidence });
        Arrangement { objects: objects.collect(), support }
    }
}

/// Moves a pose, metres. Its rotation and its scale stay the same to the bit.
fn move_by(camera_from_mesh: &mut Sim3, shift: [f64; 3]) {
    let Sim3 { translation, matrix, .. } = camera_from_mesh;
    for (axis, shift) in shift.into_iter().enumerate().filter(|(_, shift)| *shift != 0.0) {
        translation[axis] += shift;
        matrix[12 + axis] += shift;
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
