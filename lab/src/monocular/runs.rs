//! Aligns the objects of an image with what a model gives for it.

use super::calibration::Calibration;
use super::filling::filled;
use super::picture::{Picture, Thing};
use super::prediction::{Prediction, guessed_range};
use super::reading::{Reading, Treatment};
use super::record::{Errors, Record};
use super::row::Row;
use crate::prelude::*;
use sim3align::align::align_prepared;
use sim3align::align::search::Request;
use sim3align::report::Alignment;
use sim3align::scene::support::SupportChoice;
use sim3align::scene::task::{Scene, SceneObject, align_scene};

named! {
    /// Whether the objects of an image know of each other.
    pub enum Way: "way" {
        /// Each alone.
        Alone = "alone",
        /// All of an image as a scene.
        Together = "together",
        /// The same with the length of the object that has the most pixels.
        OneLength = "one-length",
    }
}

/// How images are aligned.
#[derive(Debug, Clone)]
pub struct Settings {
    /// The rows.
    pub rows: Vec<Row>,
    /// The ways of images with several objects; others are aligned alone.
    pub ways: Vec<Way>,
    /// What is done about unknowns.
    pub treatment: Treatment,
    /// Options of every object.
    pub options: AlignOptions,
    /// Seed of the errors of the maps.
    pub seed: u64,
}

/// What was found of an object, and the reading of the map with which it was.
type Answer = (Alignment, Reading);

/// Aligns the objects of an image in all rows and ways.
///
/// # Errors
/// Those of [`filled`] and of [`Prediction::of_filled`]. Those of the aligner are in the records.
pub fn run(picture: &Picture, settings: &Settings) -> Result<Vec<Record>> {
    let masks: Vec<&Mask> = picture.objects.iter().map(|object| &object.mask).collect();
    let depth = filled(&picture.depth, &masks)?;
    let mut records = Vec::new();
    for &row in &settings.rows {
        let prediction = Prediction::of_filled(picture, depth.clone(), row, settings.seed)?;
        for &way in settings.ways.iter().filter(|way| **way == Way::Alone || picture.objects.len() > 1) {
            let told = if way == Way::OneLength { told(picture) } else { None };
            let answers = match way {
                Way::Alone => {
                    picture.objects.iter().map(|thing| alone(picture, thing, &prediction, settings)).collect()
                }
                Way::Together | Way::OneLength => together(picture, &prediction, settings, told),
            };
            for (k, (thing, answer)) in picture.objects.iter().zip(answers).enumerate() {
                let is_told = told.is_some_and(|(told, _)| told == k);
                let blank = Record {
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
                    is_metric: false,
                    deviations: None,
                    is_told,
                    error: None,
                };
                records.push(completed(blank, thing, answer));
            }
        }
    }
    Ok(records)
}

/// The object with the most pixels among those of known size, and its length, metres.
fn told(picture: &Picture) -> Option<(usize, f64)> {
    let known = picture.objects.iter().enumerate().filter_map(|(k, thing)| {
        let scale = thing.truth.as_ref()?.camera_from_mesh.scale;
        let bounds = Bounds::of(thing.mesh.positions())?;
        let pixels = thing.mask.data().iter().filter(|m| **m != 0).count();
        Some((pixels, k, scale * f64::from((bounds.max - bounds.min).max_element())))
    });
    known.max_by_key(|(pixels, ..)| *pixels).map(|(_, k, length)| (k, length))
}

fn alone(picture: &Picture, thing: &Thing, prediction: &Prediction, settings: &Settings) -> Result<Answer> {
    let options = &settings.options;
    let reading = Reading::new(prediction, settings.treatment, &[(thing, options)])?;
    let mut observation = Observation::new(reading.depth.clone(), thing.mask.clone(), reading.calibration.camera)?
        .with_relief_deviation(reading.deviations.relief());
    if let Some(photo) = &picture.photo {
        observation = observation.with_photo(photo.clone())?;
    }
    let mesh = PreparedMesh::borrowed(&thing.mesh).with_colors(thing.colors.clone());
    let alignment = align_prepared(&observation, &mesh, Request::new(options.clone())?, &mut Silent)?;
    Ok((alignment, reading))
}

fn together(
    picture: &Picture,
    prediction: &Prediction,
    settings: &Settings,
    told: Option<(usize, f64)>,
) -> Vec<Result<Answer>> {
    let options = |k: usize| {
        let known_extent_m = told.filter(|(told, _)| *told == k).map(|(_, length)| length);
        AlignOptions { known_extent_m, ..settings.options.clone() }
    };
    let options: Vec<AlignOptions> = (0..picture.objects.len()).map(options).collect();
    let objects: Vec<(&Thing, &AlignOptions)> = picture.objects.iter().zip(&options).collect();
    let aligned = Reading::new(prediction, settings.treatment, &objects).and_then(|reading| {
        let object = |(thing, options): &(&Thing, &AlignOptions)| SceneObject {
            mask: thing.mask.clone(),
            mesh: PreparedMesh::new(thing.mesh.clone()),
            options: (*options).clone(),
        };
        let scene = Scene {
            depth: reading.depth.clone(),
            camera: reading.calibration.camera,
            relief_deviation: reading.deviations.relief(),
            objects: objects.iter().map(object).collect(),
            occluders: Vec::new(),
            support: SupportChoice::Auto,
            snap: false,
        };
        Ok((align_scene(&scene, &mut Silent)?, reading))
    });
    match aligned {
        Ok((scene, reading)) => scene.objects.into_iter().map(|o| Ok((o?.alignment, reading.clone()))).collect(),
        Err(error) => picture.objects.iter().map(|_| Err(error.clone())).collect(),
    }
}

/// The record with its answer.
fn completed(blank: Record, thing: &Thing, answer: Result<Answer>) -> Record {
    match answer {
        Ok((alignment, reading)) => {
            let pose = alignment.camera_from_mesh;
            let errors = thing.truth.as_ref().and_then(|truth| {
                let found = Similarity::from_column_major(&pose.matrix).ok()?;
                Errors::of(thing, truth, &found, [&of_export(reading.calibration, &blank.truth), &blank.truth]).ok()
            });
            Record {
                errors,
                pose: Some(pose),
                confidence: alignment.confidence,
                calibration: Some(reading.calibration),
                is_metric: reading.is_metric,
                deviations: Some([reading.deviations.shift, reading.deviations.focal]),
                ..blank
            }
        }
        Err(error) => Record { error: Some(format!("{}: {error}", error.code.as_str())), ..blank },
    }
}

/// The calibration in terms of the map that the model gave, where somebody made depth of it by a guess of near and far.
fn of_export(calibration: Calibration, truth: &Calibration) -> Calibration {
    if truth.is_inverse && !calibration.is_inverse {
        guessed_range(&Calibration { camera: calibration.camera, ..*truth })
    } else {
        calibration
    }
}
