//! The scale option of `align`, `register` and `estimateSim3`.

use crate::error::{Error, ErrorCode, Result};
use crate::number::{number, numbers};

/// The values that a scale option takes, for error messages.
pub const EXPECTED: &str = "\"free\", a number above 0, or [min, max] with 0 < min ≤ max";

/// The knowledge of a scale, in target units per source unit.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub enum ScaleOption {
    /// Nothing: the scale is estimated.
    #[default]
    Free,
    /// The scale itself.
    Fixed(f64),
    /// Bounds: the scale is estimated within them.
    Between([f64; 2]),
}

impl ScaleOption {
    /// The bounds: equal for a fixed scale, `None` for a free one.
    pub fn bounds(&self) -> Option<[f64; 2]> {
        match *self {
            Self::Free => None,
            Self::Fixed(scale) => Some([scale; 2]),
            Self::Between(bounds) => Some(bounds),
        }
    }

    /// Checks that the numbers are finite, above 0 and in order; `argument` names the option in the error.
    ///
    /// # Errors
    /// [`ErrorCode::InvalidOption`].
    pub fn check(&self, argument: &str) -> Result<()> {
        match self.bounds() {
            Some([min, max]) if !(min > 0.0 && min <= max && max.is_finite()) => {
                let remedy = "The scale is in target units per source unit; leave it out to have it estimated.";
                Err(Error::new(ErrorCode::InvalidOption, argument.to_owned(), self.describe(), EXPECTED, remedy))
            }
            _ => Ok(()),
        }
    }

    /// The option as a caller writes it.
    pub fn describe(&self) -> String {
        match *self {
            Self::Free => "\"free\"".into(),
            Self::Fixed(scale) => number(scale),
            Self::Between([min, max]) if min == max => number(min),
            Self::Between(bounds) => numbers(&bounds),
        }
    }
}
