//! What the options of `align` say together.

use super::options::{AlignOptions, SearchScope};
use crate::error::{Error, ErrorCode, Result, Text};
use crate::number::{number, numbers};

/// How far, as a share of it, a scale may be from its bounds: a pose that went through 32-bit floats stays inside.
const ROUNDING: f64 = 1e-6;

/// Options that contradict each other, or that mean nothing without each other.
///
/// # Errors
/// [`ErrorCode::InvalidOption`].
pub(super) fn check(options: &AlignOptions) -> Result<()> {
    let AlignOptions { scale, known_extent_m, camera_up, mesh_up, initial, search, .. } = options;
    if *search == SearchScope::Local && initial.is_none() {
        let remedy = "Pass the pose to start from as `initial`, or leave `search` out to search everywhere.";
        return Err(invalid("options.search", "\"local\" without an initial pose", "\"local\" with `initial`", remedy));
    }
    if camera_up.is_some() != mesh_up.is_some() {
        let (argument, found, expected) = if camera_up.is_some() {
            ("options.meshUp", "`cameraUp` alone", "`meshUp` as well")
        } else {
            ("options.cameraUp", "`meshUp` alone", "`cameraUp` as well")
        };
        let remedy = "Pass the direction that is up in both frames, or in neither.";
        return Err(invalid(argument, found, expected, remedy));
    }
    let Some([min, max]) = *scale else { return Ok(()) };
    if let Some(extent_m) = *known_extent_m {
        let found = format!("a known extent of {} m beside a scale of {}", number(extent_m), range(min, max));
        let remedy = "A known extent fixes the scale: leave one of the two out.";
        return Err(invalid("options.knownExtentM", found, "`knownExtentM` or `scale`", remedy));
    }
    match initial {
        Some(pose) if pose.scale < min * (1.0 - ROUNDING) || pose.scale > max * (1.0 + ROUNDING) => {
            let found = format!("a scale of {}", number(pose.scale));
            let expected = format!("one within `scale`: {}", range(min, max));
            Err(invalid("options.initial", found, expected, "Widen `scale`, or pass a pose of a scale inside it."))
        }
        _ => Ok(()),
    }
}

fn range(min: f64, max: f64) -> String {
    if min == max { number(min) } else { numbers(&[min, max]) }
}

fn invalid(argument: &'static str, found: impl Into<Text>, expected: impl Into<Text>, remedy: &'static str) -> Error {
    Error::new(ErrorCode::InvalidOption, argument, found, expected, remedy)
}
