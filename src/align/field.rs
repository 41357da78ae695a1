//! Options as a table of named fields: what bindings set, what validation checks, and what an unknown name is
//! held against, all from one place.

use crate::error::{Error, ErrorCode, Result};
use crate::geometry::similarity::Similarity;
use crate::metrics::symmetry::Symmetry;
use crate::number::{number, numbers};

/// The forms of a symmetry, in words.
pub const SYMMETRY: &str = "\"none\", \"auto\", \"auto-revolution\" or [{ axis: [x, y, z], fold? }]";

/// An option by its type and range.
pub enum Field<'a> {
    /// A whole number.
    Count {
        /// The option.
        value: &'a mut u32,
        /// Smallest value.
        min: u32,
        /// Largest value.
        max: u32,
    },
    /// A number.
    Number {
        /// The option.
        value: &'a mut f64,
        /// Smallest value.
        min: f64,
        /// Largest value.
        max: f64,
    },
    /// A finite number above 0, or nothing.
    Positive(&'a mut Option<f64>),
    /// Yes or no.
    Flag(&'a mut bool),
    /// Yes, no, or whatever suits the method.
    Switch(&'a mut Option<bool>),
    /// [min, max] above 0, a number for both, or nothing.
    Bounds(&'a mut Option<[f64; 2]>),
    /// A direction of any length above 0, or nothing.
    Direction(&'a mut Option<[f64; 3]>),
    /// The turns under which an object looks the same.
    Symmetry(&'a mut Symmetry),
    /// A transform, or nothing.
    Transform(&'a mut Option<Similarity>),
    /// [min, max] around 1, or nothing.
    Guard(&'a mut Option<[f64; 2]>),
    /// One of several names.
    Choice(&'a mut dyn Choice),
}

/// An option that is one of several names.
pub trait Choice {
    /// All names.
    fn names(&self) -> &'static [&'static str];

    /// The present one.
    fn name(&self) -> &'static str;

    /// Sets the option by its name; `false` where there is none of that name.
    fn set(&mut self, name: &str) -> bool;
}

/// Implements [`Choice`] for a plain enum.
macro_rules! choice {
    ($type:ident { $($variant:ident: $name:literal),+ }) => {
        impl $crate::align::field::Choice for $type {
            fn names(&self) -> &'static [&'static str] {
                &[$($name),+]
            }

            fn name(&self) -> &'static str {
                match self {
                    $(Self::$variant => $name,)+
                }
            }

            fn set(&mut self, name: &str) -> bool {
                match name {
                    $($name => *self = Self::$variant,)+
                    _ => return false,
                }
                true
            }
        }
    };
}
pub(crate) use choice;

/// A struct of options.
pub trait Options: Default + Clone {
    /// Every option, by its name in JavaScript.
    fn fields(&mut self) -> Vec<(&'static str, Field<'_>)>;

    /// Checks what options say together, once each is in its range.
    ///
    /// # Errors
    /// [`ErrorCode::InvalidOption`].
    fn check_combination(&self) -> Result<()> {
        Ok(())
    }

    /// Checks every range, and what the options say together.
    ///
    /// # Errors
    /// [`ErrorCode::InvalidOption`].
    fn validate(&self) -> Result<()> {
        let mut copy = self.clone();
        copy.fields().iter().try_for_each(|(name, field)| field.check(name))?;
        self.check_combination()
    }
}

impl<'a> Field<'a> {
    /// A whole number from `min` to `max`.
    pub fn count(value: &'a mut u32, min: u32, max: u32) -> Self {
        Self::Count { value, min, max }
    }

    /// A number from `min` to `max`.
    pub fn number(value: &'a mut f64, min: f64, max: f64) -> Self {
        Self::Number { value, min, max }
    }

    /// What the option may be, in words.
    pub fn expected(&self) -> String {
        match self {
            Self::Count { min, max, .. } => format!("a whole number from {min} to {max}"),
            Self::Number { min, max, .. } => format!("a number from {} to {}", number(*min), number(*max)),
            Self::Positive(_) => "a finite number above 0, or null".into(),
            Self::Flag(_) => "true or false".into(),
            Self::Switch(_) => "true, false or null".into(),
            Self::Bounds(_) => "a number above 0, [min, max] or { min, max } with 0 < min ≤ max, or null".into(),
            Self::Direction(_) => "three finite numbers, not all 0, or null".into(),
            Self::Symmetry(_) => SYMMETRY.into(),
            Self::Transform(_) => "a transform, or null".into(),
            Self::Guard(_) => "[min, max] with 0 < min ≤ 1 ≤ max, or null".into(),
            Self::Choice(choice) => format!("one of \"{}\"", choice.names().join("\", \"")),
        }
    }

    /// Whether the option's value is in its range; `name` is for the error.
    ///
    /// # Errors
    /// [`ErrorCode::InvalidOption`].
    pub fn check(&self, name: &str) -> Result<()> {
        let (fits, found) = match self {
            Self::Count { value, min, max } => ((*min..=*max).contains(value), number(f64::from(**value))),
            Self::Number { value, min, max } => ((*min..=*max).contains(value), number(**value)),
            Self::Positive(Some(value)) => (value.is_finite() && *value > 0.0, number(*value)),
            Self::Guard(Some([min, max])) => {
                (*min > 0.0 && *min <= 1.0 && *max >= 1.0 && max.is_finite(), numbers(&[*min, *max]))
            }
            Self::Bounds(Some([min, max])) => (*min > 0.0 && *min <= *max && max.is_finite(), numbers(&[*min, *max])),
            Self::Direction(Some(direction)) => {
                let squared: f64 = direction.iter().map(|x| x * x).sum();
                (squared.is_finite() && squared > 0.0, numbers(direction.as_slice()))
            }
            // Checked where they are made: symmetries and transforms come with errors of their own.
            _ => return Ok(()),
        };
        if fits { Ok(()) } else { Err(self.error(name, found)) }
    }

    /// The error of a value that does not fit.
    pub fn error(&self, name: &str, found: String) -> Error {
        let remedy = "Leave the option out to take its default.";
        Error::new(ErrorCode::InvalidOption, format!("options.{name}"), found, self.expected(), remedy)
    }
}
