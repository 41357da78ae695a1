//! The alignment of a scene: the rounds of its [`Plan`], one object after the other, and the alignment of one object.

use core::ops::ControlFlow;
use std::rc::Rc;

use super::contact::Contact;
use super::local::View;
use super::placement::Placement;
use super::plan::{Arranged, Arrangement, Plan, missing};
use super::plane::SupportChoice;
use super::planes::union_of;
use super::support::Support;
use crate::align::helper::Helper;
use crate::align::search::{Request, Search};
use crate::error::Result;
use crate::evidence::observation::Observation;
use crate::geometry::image::{DepthMap, Image, Mask};
use crate::geometry::pinhole::Pinhole;
use crate::precise::drawing::prepared_mesh::PreparedMesh;
use crate::precise::options::AlignOptions;
use crate::precise::scoring::scene_term::SceneTerm;
use crate::precise::search::start::WarmStart;
use crate::progress::Host;
use crate::report::{Alignment, Sim3};
use crate::scheduler::{Boxed, Scheduler, boxed, finished};

/// A scene: one depth map, and the objects in it.
pub struct Scene<'m> {
    /// Depth.
    pub depth: DepthMap,
    /// Its camera.
    pub camera: Pinhole,
    /// See [`Observation::relief_deviation`].
    pub relief_deviation: f64,
    /// The objects.
    pub objects: Vec<SceneObject<'m>>,
    /// Masks of objects without a mesh.
    pub occluders: Vec<Mask>,
    /// Their support.
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
    /// Its options.
    pub options: AlignOptions,
}

/// An object, aligned.
#[derive(Debug, Clone)]
pub struct PlacedObject {
    /// The alignment.
    pub alignment: Alignment,
    /// Its contact.
    pub contact: Contact,
}

/// The result of a scene.
#[derive(Debug)]
pub struct SceneAlignment {
    /// Each object, or why it could not be aligned.
    pub objects: Vec<Result<PlacedObject>>,
    /// Their support.
    pub support: Option<Support>,
}

/// Aligns the objects of a scene, one after the other. Errors of one object are in its place of the result.
///
/// # Errors
/// Those of [`Plan::next`].
pub fn align_scene(scene: &Scene<'_>, host: &mut dyn Host) -> Result<SceneAlignment> {
    let Scene { depth, camera, relief_deviation, objects, occluders, support, snap } = scene;
    let masks: Vec<&Mask> = objects.iter().map(|object| &object.mask).chain(occluders).collect();
    let view = || {
        let taken = union_of(depth.width(), depth.height(), masks.iter().copied());
        let seed = objects.first().map_or(0, |object| u64::from(object.options.seed));
        Ok(View { depth: depth.clone(), camera: *camera, taken, choice: *support, seed })
    };
    let mut plan = Plan::default();
    let mut aligned: Vec<Result<Option<Alignment>>> = vec![Ok(None); objects.len()];
    let arrangement = loop {
        let mut round = Vec::new();
        for (k, SceneObject { mesh, options, .. }) in objects.iter().enumerate() {
            let mut place = || {
                aligned[k].clone()?;
                let observation = observation_of(depth, camera, &masks, k)?.with_relief_deviation(*relief_deviation);
                finished(place(&observation, mesh, options.clone(), plan.warm_start(k)?, host, &Scheduler::unbounded()))
            };
            let (placement, alignment) = place().map_or_else(|error| (None, Err(error)), |(p, a)| (Some(p), Ok(a)));
            aligned[k] = alignment;
            round.push(placement);
        }
        match plan.next(round, *snap, view)? {
            ControlFlow::Continue(next) => plan = next,
            ControlFlow::Break(arrangement) => break arrangement,
        }
    };
    let Arrangement { objects, support } = arrangement;
    let objects = aligned.into_iter().zip(objects).map(|(alignment, arranged)| {
        let (alignment, Arranged { translation, matrix, contact }) = alignment?.zip(arranged).ok_or_else(missing)?;
        let before = alignment.camera_from_mesh.translation;
        let shift = [0, 1, 2].map(|k| translation[k] - before[k]);
        let proportions = alignment.proportions.map(|stretch| stretch.shifted(shift));
        let camera_from_mesh = Sim3 { translation, matrix, ..alignment.camera_from_mesh };
        Ok(PlacedObject { alignment: Alignment { camera_from_mesh, proportions, ..alignment }, contact })
    });
    Ok(SceneAlignment { objects: objects.collect(), support })
}

/// The observation of an object, with the pixels of all others.
///
/// # Errors
/// Those of [`Observation::new`].
fn observation_of(depth: &DepthMap, camera: &Pinhole, masks: &[&Mask], object: usize) -> Result<Observation> {
    let Some(mask) = masks.get(object) else { return Err(missing()) };
    let observation = Observation::new(depth.clone(), (*mask).clone(), *camera)?;
    if masks.len() < 2 {
        return Ok(observation);
    }
    let others = || masks.iter().enumerate().filter(|(k, _)| *k != object).map(|(_, mask)| mask.data());
    let is_other = |i| others().any(|mask| mask.get(i).is_some_and(|pixel| *pixel != 0));
    let pixels = (0..mask.data().len()).map(|i| u8::from(is_other(i))).collect();
    observation.with_others(Image::new("mask", depth.width(), depth.height(), pixels)?)
}

/// Aligns an object alone or from a warm start. Returns its placement for the others and, from a warm start, its alignment.
///
/// # Errors
/// As [`align`](crate::align::align).
pub fn place<'a>(
    observation: &'a Observation,
    mesh: &'a PreparedMesh<'_>,
    options: AlignOptions,
    start: Option<WarmStart<'a>>,
    host: &'a mut dyn Host,
    scheduler: &'a Scheduler,
) -> Boxed<'a, Result<(Placement, Option<Alignment>)>> {
    boxed(async move {
        let request = Request::new(options)?;
        let mut search = Search::begin(observation, mesh, &request, host, scheduler).await?;
        let mesh = search.mesh();
        let Some(start) = start else {
            let mut searched = search.search().await?;
            let colors = search.colors(&searched).await;
            // Of the poses that shape leaves, that first which the photo chooses.
            if let Some(chosen) = colors.and_then(|colors| colors.chosen) {
                searched.rounds.candidates.insert(0, chosen);
            }
            return Ok((Placement::new(&searched, observation).ok_or_else(missing)?, None));
        };
        let clouds = search.clouds().await?;
        let normal = start.context.plane.map(|plane| plane.normal);
        let searched = search.search_again(start).await?;
        let placement = Placement::new(&searched, observation).ok_or_else(missing)?;
        let colors = search.colors(&searched).await;
        let alignment = search.finish(clouds, searched, colors.as_ref())?;
        let placement = placement.in_pose_of(&alignment, mesh, observation, normal)?;
        Ok((placement, Some(alignment)))
    })
}

/// A helper of [`place`] with the same arguments.
///
/// # Errors
/// [`ErrorCode::InvalidOption`](crate::error::ErrorCode::InvalidOption).
pub fn helper(
    observation: Observation,
    mesh: Rc<PreparedMesh<'static>>,
    options: AlignOptions,
    start: Option<WarmStart<'_>>,
) -> Result<Helper> {
    let known = start.map(|start| start.context).unwrap_or_default();
    Ok(Helper::new(vec![Some(observation)], mesh, Request::new(options)?, move |search| {
        search.set_scene_term(SceneTerm::new(known.clone(), &search.mesh, &search.observation));
    }))
}
