//! The steps of a scene: each object alone, the support, each object with what the others have told.

use std::rc::Rc;

use super::contact::{Contact, contacts};
use super::local::View;
use super::placement::{Body, Placement};
use super::planes::union_of;
use super::support::{Ground, Support, SupportChoice, find_support};
use crate::align::search::{Given, Request, Search};
use crate::error::Result;
use crate::evidence::observation::Observation;
use crate::geometry::image::{DepthMap, Image, Mask};
use crate::geometry::pinhole::Pinhole;
use crate::geometry::similarity::Similarity;
use crate::pauses::{Boxed, Pauses, boxed, finished};
use crate::precise::drawn::prepared_mesh::PreparedMesh;
use crate::precise::options::AlignOptions;
use crate::precise::scored::surroundings::Neighbourhood;
use crate::progress::Host;
use crate::report::Alignment;

/// A scene: one depth map, and the objects in it.
pub struct Scene<'m> {
    /// Depth.
    pub depth: DepthMap,
    /// Its camera.
    pub camera: Pinhole,
    /// The objects.
    pub objects: Vec<SceneObject<'m>>,
    /// Masks of what else is known to stand there, without a mesh.
    pub occluders: Vec<Mask>,
    /// What they stand on.
    pub support: SupportChoice,
    /// Whether objects are put exactly onto what they touch.
    pub snap: bool,
}

/// An object of a scene.
pub struct SceneObject<'m> {
    /// Its pixels.
    pub mask: Mask,
    /// Its mesh.
    pub mesh: PreparedMesh<'m>,
    /// What is known of it.
    pub options: AlignOptions,
}

/// An object, aligned.
#[derive(Debug, Clone)]
pub struct PlacedObject {
    /// The alignment.
    pub alignment: Alignment,
    /// What it rests on.
    pub contact: Contact,
}

/// The result of a scene.
#[derive(Debug)]
pub struct SceneAlignment {
    /// Each object, or why it could not be aligned.
    pub objects: Vec<Result<PlacedObject>>,
    /// What they stand on.
    pub support: Option<Support>,
}

/// Aligns the objects of a scene, one after the other.
///
/// # Errors
/// [`ErrorCode::SizeMismatch`](crate::error::ErrorCode::SizeMismatch) for masks of another size than the depth map.
/// Errors of one object are in its place of the result.
pub fn align_scene(scene: &Scene<'_>, host: &mut dyn Host) -> Result<SceneAlignment> {
    let masks = masks_of(scene);
    let observation = |i: usize| observation_of(&scene.depth, &scene.camera, &masks, i);
    let objects = scene.objects.iter().enumerate();
    let found = objects.map(|(i, object)| align_alone(&observation(i)?, object, host)).collect();
    align_placed(scene, found, host)
}

/// [`alone`] without pauses.
///
/// # Errors
/// As there.
pub fn align_alone(observation: &Observation, object: &SceneObject<'_>, host: &mut dyn Host) -> Result<Placement> {
    finished(alone(observation, &object.mesh, object.options.clone(), host, &Pauses::none()))
}

/// Aligns the objects of a scene with what each has found alone.
///
/// # Errors
/// Those of [`align_scene`].
pub fn align_placed(scene: &Scene<'_>, found: Vec<Result<Placement>>, host: &mut dyn Host) -> Result<SceneAlignment> {
    let Scene { depth, camera, objects, .. } = scene;
    let masks = masks_of(scene);
    let observation = |i: usize| observation_of(depth, camera, &masks, i);
    let (placements, failures): (Vec<_>, Vec<_>) =
        found.into_iter().map(|f| f.map_or_else(|e| (None, Some(e)), |p| (Some(p), None))).unzip();
    let taken = union_of(depth.width(), depth.height(), masks.iter().copied());
    let seed = objects.first().map_or(0, |object| u64::from(object.options.seed));
    let view = View { depth, camera, taken: &taken, seed };
    let (support, grounds) = find_support(&view, &scene.support, &placements);

    let mut bodies: Vec<Option<Body>> = Vec::new();
    let mut aligned: Vec<Result<Alignment>> = Vec::new();
    for (i, failure) in failures.into_iter().enumerate() {
        let run = || {
            let Some(placement) = &placements[i] else { return Err(failure.unwrap_or_else(missing)) };
            let (observation, SceneObject { mesh, options, .. }) = (observation(i)?, &objects[i]);
            let given = placement.given(neighbourhood(i, &placements, &grounds));
            finished(together(&observation, mesh, options.clone(), &given, host, &Pauses::none()))
        };
        let (alignment, body) = match run() {
            Ok((alignment, placement)) => (Ok(alignment), Some(placement.body)),
            Err(error) => (Err(error), None),
        };
        aligned.push(alignment);
        bodies.push(body);
    }
    let plane = support.as_ref().map(|support| &support.plane);
    let contacts = contacts(&bodies, &grounds, plane, camera, scene.snap);
    let objects = aligned.into_iter().zip(contacts).zip(&grounds).map(|((alignment, contact), ground)| {
        let (mut alignment, contact) = (alignment?, contact.ok_or_else(missing)?);
        if let Some(ground) = ground.filter(|_| contact.snapped_m != 0.0) {
            let mut pose = Similarity::from_column_major(&alignment.camera_from_mesh.matrix)?;
            pose.translation += nalgebra::Vector3::from((ground.plane.normal * contact.snapped_m).to_array());
            alignment.camera_from_mesh = (&pose).into();
        }
        Ok(PlacedObject { alignment, contact })
    });
    Ok(SceneAlignment { objects: objects.collect(), support })
}

fn masks_of<'s>(scene: &'s Scene<'_>) -> Vec<&'s Mask> {
    scene.objects.iter().map(|object| &object.mask).chain(&scene.occluders).collect()
}

/// The observation of an object, with the pixels of all others.
///
/// # Errors
/// Those of [`Observation::new`].
pub fn observation_of(depth: &DepthMap, camera: &Pinhole, masks: &[&Mask], object: usize) -> Result<Observation> {
    let Some(mask) = masks.get(object) else { return Err(missing()) };
    let observation = Observation::new(depth.clone(), (*mask).clone(), *camera)?;
    if masks.len() < 2 {
        return Ok(observation);
    }
    let mut others = Image::filled(depth.width(), depth.height(), 0u8);
    for (_, mask) in masks.iter().enumerate().filter(|(k, _)| *k != object) {
        for (other, pixel) in others.data_mut().iter_mut().zip(mask.data()) {
            *other |= u8::from(*pixel != 0);
        }
    }
    observation.with_others(others)
}

/// Aligns an object alone, and returns what the others need to know: the poses that shape leaves, with that first which
/// the photo chooses.
///
/// # Errors
/// As [`align`](crate::align::align).
pub fn alone<'a>(
    observation: &'a Observation,
    mesh: &'a PreparedMesh<'_>,
    options: AlignOptions,
    host: &'a mut dyn Host,
    pauses: &'a Pauses,
) -> Boxed<'a, Result<Placement>> {
    boxed(async move {
        let request = Request::new(options)?;
        let mut search = Search::begin(observation, mesh, &request, host, pauses).await?;
        let mut searched = search.search().await?;
        let colors = search.colors(&searched).await;
        if let Some(chosen) = colors.and_then(|colors| colors.chosen) {
            searched.rounds.found.insert(0, chosen);
        }
        Placement::new(&searched, observation).ok_or_else(missing)
    })
}

/// What an object is told about the others.
pub fn neighbourhood(object: usize, placements: &[Option<Placement>], grounds: &[Option<Ground>]) -> Neighbourhood {
    let ground = grounds.get(object).copied().flatten().map(|ground| ground.known());
    let others = placements.iter().enumerate().filter(|(k, _)| *k != object).filter_map(|(_, p)| p.as_ref());
    // A body that is probably elsewhere takes no space.
    let layers = others.filter(|p| p.confidence > SOLID).map(|p| Rc::clone(&p.body.layer)).collect();
    Neighbourhood { ground, layers }
}

/// Confidence from which on an object takes space.
const SOLID: f64 = 0.5;

/// Aligns an object with what the others have told. Returns what they need to know of it now, too.
///
/// # Errors
/// As [`align`](crate::align::align).
pub fn together<'a>(
    observation: &'a Observation,
    mesh: &'a PreparedMesh<'_>,
    options: AlignOptions,
    given: &'a Given,
    host: &'a mut dyn Host,
    pauses: &'a Pauses,
) -> Boxed<'a, Result<(Alignment, Placement)>> {
    boxed(async move {
        let request = Request::new(options)?;
        let mut search = Search::begin(observation, mesh, &request, host, pauses).await?;
        let clouds = search.clouds().await?;
        let searched = search.search_among(given).await?;
        let placement = Placement::new(&searched, observation).ok_or_else(missing)?;
        let colors = search.colors(&searched).await;
        let alignment = search.finish(clouds, searched, colors.as_ref())?;
        let normal = given.known.ground.map(|(normal, ..)| normal);
        let placement = placement.in_pose_of(&alignment, mesh, observation, normal)?;
        Ok((alignment, placement))
    })
}

/// The error for a step without what the one before should have left.
pub fn missing() -> crate::error::Error {
    crate::error::Error::new(
        crate::error::ErrorCode::Internal,
        "scene",
        "an object without a pose",
        "a pose of every object",
        "Please report this.",
    )
}
