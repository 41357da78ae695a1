//! Meshes whose proportions are wrong by a known amount, and how far an alignment puts them right.

use crate::bench::statistics::cell;
use crate::monocular::picture::{Picture, Thing};
use crate::prelude::*;
use crate::sequences::{Sequence, SequenceFrame};
use sim3align::align::align;
use sim3align::geometry::surface::SurfaceMoments;
use sim3align::precise::drawn::equivalence::Equivalence;
use sim3align::precise::drawn::pose::{CropPose, MeshFrame};
use sim3align::precise::options;
use sim3align::precise::searched::proportions::{Proportions, Stretched};
use sim3align::report::{Sim3, Stretch};
use sim3align::views::align_views;
use sim3align::views::options::ViewsOptions;

/// The errors of the lengths of an object along its axes, relative.
#[derive(Debug, Clone)]
pub struct Record {
    /// Without proportions.
    pub before: [f64; 3],
    /// With them.
    pub after: [f64; 3],
    /// What the result says of them.
    pub uncertainty: [f64; 3],
}

/// Uncertainty up to which a side counts as seen.
const SEEN: f64 = 0.03;
/// Rotation beyond which a pose is wrong, degrees.
const WRONG_DEG: f64 = 20.0;

/// The records of the objects of an image, stretched by at most `most` (logarithm).
///
/// # Errors
/// Those of meshes and observations.
pub fn records(picture: &Picture, seed: u64, most: f64, options: &AlignOptions) -> Result<Vec<Record>> {
    let records = (0..picture.objects.len()).map(|k| record(picture, k, seed, most, options));
    Ok(records.collect::<Result<Vec<_>>>()?.into_iter().flatten().collect())
}

/// A table of the errors, in per cent.
pub fn table(records: &[Record]) -> String {
    let mut lines = vec![
        "| sides | number | median before | after | 90 % before | after | ≤ 2 % before | after | worse by > .5 % | 90 % of error / uncertainty |".to_owned(),
        "|---|---|---|---|---|---|---|---|---|---|".into(),
    ];
    for (name, from, to) in [("all", 0.0, f64::INFINITY), ("seen", 0.0, SEEN), ("not seen", SEEN, f64::INFINITY)] {
        let sides = || {
            let sides = records.iter().flat_map(|r| (0..3).map(|i| [r.before[i], r.after[i], r.uncertainty[i]]));
            sides.filter(|[.., uncertainty]| (from..to).contains(uncertainty))
        };
        let at = |share: f64, of: fn(&[f64; 3]) -> f64| {
            let mut values: Vec<f64> = sides().map(|side| of(&side)).collect();
            values.sort_by(f64::total_cmp);
            values.get((share * values.len() as f64) as usize).copied()
        };
        let count = |is: fn(&[f64; 3]) -> bool| {
            cell(Some(100.0 * sides().filter(is).count() as f64 / sides().count().max(1) as f64), 0)
        };
        let percent = |share, of| cell(at(share, of).map(|x| 100.0 * x), 2);
        let [before, after] = [|s: &[f64; 3]| s[0], |s: &[f64; 3]| s[1]];
        lines.push(format!(
            "| {name} | {} | {} | {} | {} | {} | {} | {} | {} | {} |",
            sides().count(),
            percent(0.5, before),
            percent(0.5, after),
            percent(0.9, before),
            percent(0.9, after),
            count(|s| s[0] <= 0.02),
            count(|s| s[1] <= 0.02),
            count(|s| s[1] > s[0] + 0.005),
            cell(at(0.9, |s| s[1] / s[2].max(1e-9)), 2),
        ));
    }
    lines.join("\n")
}

/// A number of a text, the same everywhere.
fn hash(text: &str) -> u64 {
    text.bytes().fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

/// A mesh of wrong proportions: those of the object are these times the ones it has.
struct WrongMesh {
    proportions: Proportions,
    mesh: Mesh,
}

impl WrongMesh {
    /// A mesh that is shrunk along its axes, so that the logarithm of the largest stretch that it needs is `most`. What has a
    /// symmetry keeps it. `name` and `seed` determine the directions.
    fn of(mesh: &Mesh, name: &str, seed: u64, most: f64) -> Result<Self> {
        let random = &mut Random::new(mixed([seed, hash(name)]), 0);
        let drawn = [0; 3].map(|_| between(random, -1.0, 1.0));
        let mean = drawn.iter().sum::<f64>() / 3.0;
        let largest = drawn.iter().fold(1e-9f64, |largest, x| largest.max((x - mean).abs()));
        let straight = DMat3::from_diagonal(DVec3::from_array(drawn.map(|x| (x - mean) * most / largest)));
        let wrong = Equivalence::new(Symmetry::Auto.group(mesh)?).mean(&straight);
        let proportions = Proportions::of_matrix(&wrong);
        let shrink = proportions.matrix().inverse();
        let shrunk = mesh.positions().iter().map(|p| (shrink * p.as_dvec3()).as_vec3());
        Ok(Self { proportions, mesh: Mesh::new(shrunk.collect(), mesh.triangles().to_vec())? })
    }

    /// The true pose of the mesh: the similarity that is nearest to where the object is, over its surface.
    fn pose(&self, camera_from_object: &Similarity) -> Option<Similarity> {
        let frame = MeshFrame::of(&self.mesh);
        let center = self.proportions.matrix() * frame.center;
        let center = camera_from_object.apply(Vector3::from(center.to_array()));
        let [x, y, z, w] = camera_from_object.quaternion_xyzw();
        let scale = camera_from_object.scale * frame.diagonal;
        let pose = CropPose::new(DQuat::from_xyzw(x, y, z, w), scale, DVec3::from_array(center.into()));
        let surface = SurfaceMoments::of(&frame.normalized(&self.mesh)?);
        let nearest = Stretched { pose, proportions: self.proportions }.nearest(&surface, false);
        Some(nearest.similarity(&frame))
    }

    /// The record of a result; `None` if the pose is wrong, or no proportions were fitted.
    fn record(&self, found: &Sim3, fitted: Option<&Stretch>, truth: &Similarity) -> Option<Record> {
        let turn = truth.rotation.inverse() * Rotation3::from(quaternion(found.rotation));
        let fitted = fitted.filter(|_| turn.angle().to_degrees() <= WRONG_DEG)?;
        let [s, stretch] = [DMat3::from_cols_array_2d(&fitted.stretch), self.proportions.matrix()];
        let error = |length: f64, axis: usize| libm::log(length / (truth.scale * stretch.col(axis).length())).abs();
        Some(Record {
            before: [0, 1, 2].map(|i| error(found.scale, i)),
            after: [0, 1, 2].map(|i| error(fitted.camera_from_stretched.scale * s.col(i).length(), i)),
            uncertainty: fitted.uncertainty,
        })
    }
}

/// The record of an object of known pose; `None` if it has none, if its size is given, or if it was not found.
fn record(picture: &Picture, k: usize, seed: u64, most: f64, options: &AlignOptions) -> Result<Option<Record>> {
    let Thing { name, mask, mesh, truth: Some(truth), .. } = &picture.objects[k] else { return Ok(None) };
    let wrong = WrongMesh::of(mesh, name, seed, most)?;
    let mut observation = Observation::new(picture.depth.clone(), mask.clone(), picture.camera)?;
    if let Some(others) = others(picture, k)? {
        observation = observation.with_others(others)?;
    }
    let Ok(found) = align(&observation, &wrong.mesh, options, &mut Silent) else { return Ok(None) };
    Ok(wrong.record(&found.camera_from_mesh, found.proportions.as_ref(), &truth.camera_from_mesh))
}

/// The record of an object in several views; `None` if the cameras are unknown, or it was not found.
///
/// # Errors
/// Those of meshes.
pub fn record_of_views(
    sequence: &Sequence,
    seed: u64,
    most: f64,
    proportions: options::Proportions,
) -> Result<Option<Record>> {
    let Some((frame, truth)) = sequence.frames.iter().find_map(|frame| Some((frame, frame.camera_from_mesh?))) else {
        return Ok(None);
    };
    let Some(world_from_camera) = &frame.view.world_from_camera else { return Ok(None) };
    let truth = world_from_camera.compose(&truth);
    let wrong = WrongMesh::of(&sequence.mesh, &sequence.name, seed, most)?;
    let options = ViewsOptions { proportions, metrics: false, ..ViewsOptions::default() };
    let views = sequence.frames.iter().map(|frame| frame.view.clone()).collect();
    let Ok(found) = align_views(views, &PreparedMesh::borrowed(&wrong.mesh), &options, &mut Silent) else {
        return Ok(None);
    };
    Ok(wrong.record(&found.world_from_mesh, found.proportions.as_ref(), &truth))
}

/// The sequence with a mesh of wrong proportions, and its true poses.
///
/// # Errors
/// Those of meshes.
pub fn with_wrong_mesh(sequence: &Sequence, seed: u64, most: f64) -> Result<Sequence> {
    let wrong = WrongMesh::of(&sequence.mesh, &sequence.name, seed, most)?;
    let pose = |truth: &Similarity| wrong.pose(truth);
    let frames = sequence.frames.iter().cloned();
    let frames =
        frames.map(|frame| SequenceFrame { camera_from_mesh: frame.camera_from_mesh.as_ref().and_then(pose), ..frame });
    Ok(Sequence { frames: frames.collect(), colors: None, mesh: wrong.mesh.clone(), ..sequence.clone() })
}

fn quaternion([x, y, z, w]: [f64; 4]) -> UnitQuaternion<f64> {
    UnitQuaternion::new_normalize(nalgebra::Quaternion::new(w, x, y, z))
}

/// The pixels of all objects but one; `None` if there are no others.
fn others(picture: &Picture, k: usize) -> Result<Option<Mask>> {
    let masks: Vec<&Mask> =
        picture.objects.iter().enumerate().filter(|(j, _)| *j != k).map(|(_, thing)| &thing.mask).collect();
    let Some(first) = masks.first() else { return Ok(None) };
    let is_other = |i: usize| u8::from(masks.iter().any(|mask| mask.data()[i] != 0));
    Image::new("mask", first.width(), first.height(), (0..first.data().len()).map(is_other).collect()).map(Some)
}
