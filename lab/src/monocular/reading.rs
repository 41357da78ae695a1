//! How a map is taken for depth: as it is, the baseline, or with an estimate of what is unknown.

use super::calibration::Calibration;
use super::picture::Thing;
use super::prediction::{GivenCamera, Prediction, guessed_range};
use crate::prelude::*;
use sim3align::calibrate::calibration::{CalibrationUncertainty, DepthCalibration};
use sim3align::calibrate::raw_view::{Focal, RawView};
use sim3align::calibrate::{Calibrated, Object, calibrate};
use sim3align::pauses::{Pauses, finished};
use sim3align_geometry::depth_kind::DepthKind;

/// The horizontal field of view of an unknown camera, and the standard deviation of the logarithm of its focal length.
const GUESSED_VIEW: (f64, f64) = (60.0, 0.25);

named! {
    /// How what is unknown is treated.
    #[derive(Default)]
    pub enum Treatment: "treatment" {
        /// It is estimated.
        #[default]
        Estimated = "estimated",
        /// It is assumed: depth as it is, without shift, inverse depth between a guessed near and far, and the camera as
        /// it is given.
        Naive = "naive",
    }
}

/// Depth and camera as far as anybody can tell.
#[derive(Debug, Clone)]
pub struct Reading {
    /// Depth.
    pub depth: DepthMap,
    /// What was assumed or estimated of the map.
    pub calibration: Calibration,
    /// Whether the unit is said to be metres.
    pub is_metric: bool,
    /// Standard deviations of what was estimated.
    pub deviations: CalibrationUncertainty,
}

impl Reading {
    /// Reads a map with some of its objects, whose options may have known lengths.
    ///
    /// # Errors
    /// Those of [`Pinhole::new`], [`DepthMap::from_metres`] and [`calibrate`].
    pub fn new(prediction: &Prediction, treatment: Treatment, objects: &[(&Thing, &AlignOptions)]) -> Result<Self> {
        match treatment {
            Treatment::Naive => Self::naive(prediction),
            Treatment::Estimated => Self::estimated(prediction, objects),
        }
    }

    fn naive(prediction: &Prediction) -> Result<Self> {
        let (camera, _) = camera(prediction)?;
        let as_is = Calibration::of_metres(camera);
        let calibration = match prediction.kind {
            DepthKind::AffineInvariantDisparity => guessed_range(&Calibration { is_inverse: true, ..as_is }),
            _ => as_is,
        };
        let (width, height) = (prediction.map.width(), prediction.map.height());
        let metres = prediction.map.data().iter().map(|value| calibration.depth(f64::from(*value)) as f32).collect();
        let depth = DepthMap::from_metres(width, height, metres)?;
        Ok(Self { depth, calibration, is_metric: true, deviations: CalibrationUncertainty::default() })
    }

    fn estimated(prediction: &Prediction, objects: &[(&Thing, &AlignOptions)]) -> Result<Self> {
        let (camera, focal) = camera(prediction)?;
        let view = RawView { values: prediction.map.clone(), kind: prediction.kind, camera, focal };
        let meshes: Vec<PreparedMesh<'_>> = objects
            .iter()
            .map(|(thing, _)| PreparedMesh::borrowed(&thing.mesh).with_colors(thing.colors.clone()))
            .collect();
        let object = |(k, mesh)| -> Result<Object<'_>> {
            let (thing, options): (&Thing, &AlignOptions) = objects[k];
            Ok(Object { mask: &thing.mask, others: others(objects, k)?, mesh, options })
        };
        let objects: Vec<Object<'_>> = meshes.iter().enumerate().map(object).collect::<Result<_>>()?;
        let Calibrated { depth, calibration, .. } = finished(calibrate(&view, &objects, &mut Silent, &Pauses::none()))?;
        let DepthCalibration { scale, shift, camera, uncertainty, is_metric, .. } = calibration;
        let is_inverse = prediction.kind == DepthKind::AffineInvariantDisparity;
        let scale = if is_inverse { 1.0 / scale } else { scale };
        let calibration = Calibration { is_inverse, scale, shift, camera };
        Ok(Self { depth, calibration, is_metric, deviations: uncertainty })
    }
}

/// The camera as it is given or, without one, of the guessed field of view, and what is known of its focal length.
fn camera(prediction: &Prediction) -> Result<(Pinhole, Focal)> {
    Ok(match prediction.camera {
        GivenCamera::Known(camera) => (camera, Focal::Known),
        GivenCamera::Doubted(camera, deviation) => (camera, Focal::Guessed(deviation)),
        GivenCamera::Unknown => {
            let (width, height) = (prediction.map.width() as f64, prediction.map.height() as f64);
            let (degrees, deviation) = GUESSED_VIEW;
            let focal = 0.5 * width / libm::tan(0.5 * degrees.to_radians());
            (Pinhole::new(focal, focal, 0.5 * (width - 1.0), 0.5 * (height - 1.0))?, Focal::Guessed(deviation))
        }
    })
}

/// The pixels of all objects but one; `None` if there are no others.
fn others(objects: &[(&Thing, &AlignOptions)], k: usize) -> Result<Option<Mask>> {
    let masks: Vec<&Mask> =
        objects.iter().enumerate().filter(|(j, _)| *j != k).map(|(_, (thing, _))| &thing.mask).collect();
    let Some(first) = masks.first() else { return Ok(None) };
    let is_other = |i: usize| u8::from(masks.iter().any(|mask| mask.data()[i] != 0));
    Image::new("mask", first.width(), first.height(), (0..first.data().len()).map(is_other).collect()).map(Some)
}
