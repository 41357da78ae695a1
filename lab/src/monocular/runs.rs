//! Aligns the objects of an image with what a model gives for it.

use super::calibration::Calibration;
use super::filling::filled;
use super::picture::{Picture, Thing};
use super::prediction::Prediction;
use super::reading::Reading;
use super::record::{Errors, Record};
use super::row::Row;
use crate::prelude::*;
use sim3align::align::align_prepared;
use sim3align::align::search::Request;
use sim3align::report::{Alignment, Sim3};
use sim3align::scene::support::SupportChoice;
use sim3align::scene::task::{Scene, SceneObject, align_scene};

named! {
    /// Whether the objects of an image know of each other.
    pub enum Way: "way" {
        /// Each alone.
        Alone = "alone",
        /// All of an image as a scene.
        Together = "together",
    }
}

/// The pose of an object in the metric of a calibration, and its confidence.
type Answer = (Sim3, f64, Calibration);

/// Aligns the objects of an image in several rows and ways.
///
/// # Errors
/// Those of [`filled`] and of [`Prediction::of_filled`]. Those of the aligner are in the records.
pub fn run(picture: &Picture, rows: &[Row], ways: &[Way], options: &AlignOptions, seed: u64) -> Result<Vec<Record>> {
    let masks: Vec<&Mask> = picture.objects.iter().map(|object| &object.mask).collect();
    let depth = filled(&picture.depth, &masks)?;
    let mut records = Vec::new();
    for &row in rows {
        let prediction = Prediction::of_filled(picture, depth.clone(), row, seed)?;
        for &way in ways {
            let answers = match way {
                Way::Alone => picture.objects.iter().map(|thing| alone(picture, thing, &prediction, options)).collect(),
                Way::Together => together(picture, &prediction, options),
            };
            for (thing, answer) in picture.objects.iter().zip(answers) {
                records.push(record(picture, thing, row, way, &prediction, answer));
            }
        }
    }
    Ok(records)
}

fn alone(picture: &Picture, thing: &Thing, prediction: &Prediction, options: &AlignOptions) -> Result<Answer> {
    let reading = Reading::naive(prediction)?;
    let mut observation = Observation::new(reading.depth, thing.mask.clone(), reading.assumed.camera)?;
    if let Some(photo) = &picture.photo {
        observation = observation.with_photo(photo.clone())?;
    }
    let mesh = PreparedMesh::borrowed(&thing.mesh).with_colors(thing.colors.clone());
    let alignment = align_prepared(&observation, &mesh, Request::new(options.clone())?, &mut Silent)?;
    Ok(answer(&alignment, reading.assumed))
}

fn together(picture: &Picture, prediction: &Prediction, options: &AlignOptions) -> Vec<Result<Answer>> {
    let aligned = Reading::naive(prediction).and_then(|reading| {
        let object = |thing: &Thing| SceneObject {
            mask: thing.mask.clone(),
            mesh: PreparedMesh::new(thing.mesh.clone()),
            options: options.clone(),
        };
        let scene = Scene {
            depth: reading.depth,
            camera: reading.assumed.camera,
            objects: picture.objects.iter().map(object).collect(),
            occluders: Vec::new(),
            support: SupportChoice::Auto,
            snap: false,
        };
        Ok((align_scene(&scene, &mut Silent)?, reading.assumed))
    });
    match aligned {
        Ok((scene, assumed)) => scene.objects.into_iter().map(|o| Ok(answer(&o?.alignment, assumed))).collect(),
        Err(error) => picture.objects.iter().map(|_| Err(error.clone())).collect(),
    }
}

fn answer(alignment: &Alignment, calibration: Calibration) -> Answer {
    (alignment.camera_from_mesh.clone(), alignment.confidence, calibration)
}

fn record(
    picture: &Picture,
    thing: &Thing,
    row: Row,
    way: Way,
    prediction: &Prediction,
    answer: Result<Answer>,
) -> Record {
    let mut record = Record {
        row: row.as_str(),
        way: way.as_str(),
        picture: picture.name.clone(),
        object: thing.name.clone(),
        pose: None,
        confidence: 0.0,
        calibration: None,
        truth: prediction.truth,
        errors: None,
        has_truth: thing.truth.is_some(),
        error: None,
    };
    match answer {
        Ok((pose, confidence, calibration)) => {
            record.errors = thing.truth.as_ref().and_then(|truth| {
                let found = Similarity::from_column_major(&pose.matrix).ok()?;
                Errors::of(thing, truth, &found, [&calibration, &prediction.truth]).ok()
            });
            (record.pose, record.confidence, record.calibration) = (Some(pose), confidence, Some(calibration));
        }
        Err(error) => record.error = Some(format!("{}: {error}", error.code.as_str())),
    }
    record
}
