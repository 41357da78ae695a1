//! Declares options: one line per option gives the struct's field, its default, its JavaScript name, its range and its
//! documentation, which the bindings, the TypeScript declarations and the command line all read.

pub mod scale;

use core::ops::RangeInclusive;

use crate::error::{Error, ErrorCode, Result};
use crate::geometry::similarity::Similarity;
use crate::metrics::symmetry::Symmetry;
use crate::number::{number, numbers};
use scale::ScaleOption;

/// The values that a symmetry option takes, for error messages.
pub const SYMMETRY: &str = "\"none\", \"auto\" or [{ axis: [x, y, z], fold? }]";

/// An option: its value, by type, and its range.
pub enum Field<'a> {
    /// A whole number in a range.
    Count(&'a mut u32, RangeInclusive<u32>),
    /// A number in a range.
    Number(&'a mut f64, RangeInclusive<f64>),
    /// A number in a range, or nothing.
    OptionalNumber(&'a mut Option<f64>, RangeInclusive<f64>),
    /// A finite number above 0, or nothing.
    Positive(&'a mut Option<f64>),
    /// True or false.
    Flag(&'a mut bool),
    /// A scale: free, fixed or bounded.
    Scale(&'a mut ScaleOption),
    /// A direction of any length above 0, or nothing.
    Direction(&'a mut Option<[f64; 3]>),
    /// The object's symmetry.
    Symmetry(&'a mut Symmetry),
    /// A transform, or nothing.
    Transform(&'a mut Option<Similarity>),
    /// Bounds [min, max] around 1, or nothing.
    Guard(&'a mut Option<[f64; 2]>),
    /// One of several names.
    Choice(&'a mut dyn Choice),
}

/// An option whose value is one of several names.
pub trait Choice {
    /// The type's name.
    fn type_name(&self) -> &'static str;

    /// All names.
    fn names(&self) -> &'static [&'static str];

    /// The name of the present value.
    fn name(&self) -> &'static str;

    /// Sets the value by its name; `false` where there is none of that name.
    fn set(&mut self, name: &str) -> bool;
}

/// Declares an enum whose variants have names in JavaScript.
macro_rules! choices {
    (
        $(#[doc = $type_doc:literal])*
        pub enum $type:ident {
            $($(#[doc = $doc:literal])* $(#[default $($default:tt)?])? $variant:ident = $name:literal,)+
        }
    ) => {
        $(#[doc = $type_doc])*
        #[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
        #[cfg_attr(feature = "types", derive(ts_rs::TS))]
        pub enum $type {
            $(
                $(#[doc = $doc])*
                $(#[default $($default)?])?
                #[cfg_attr(feature = "types", ts(rename = $name))]
                #[serde(rename = $name)]
                $variant,
            )+
        }

        impl $crate::options::Choice for $type {
            fn type_name(&self) -> &'static str {
                stringify!($type)
            }

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
pub(crate) use choices;

/// Declares a struct of options, one per line: `name: Type = default, Kind(range);` with [`Field`]'s kinds. An option's
/// JavaScript name is its own in camel case. The first sentence of its documentation describes it on one line; ranges
/// and defaults are added to the documentation by whoever prints it.
macro_rules! options {
    (
        $(#[doc = $type_doc:literal])*
        pub struct $type:ident {
            $($(#[doc = $doc:literal])+ $name:ident: $value:ty = $default:expr, $kind:ident $(($range:expr))?;)+
        }
        $(check $check:path;)?
    ) => {
        $(#[doc = $type_doc])*
        #[derive(Debug, Clone, PartialEq)]
        pub struct $type {
            $($(#[doc = $doc])+ pub $name: $value,)+
        }

        impl Default for $type {
            fn default() -> Self {
                Self { $($name: $default,)+ }
            }
        }

        impl $crate::options::Options for $type {
            const DOC: &'static str = concat!($($type_doc, "\n"),*);
            const NAMES: &'static [&'static str] = &[$(stringify!($name)),+];
            const DOCS: &'static [&'static str] = &[$(concat!($($doc, "\n"),+)),+];

            fn fields(&mut self) -> Vec<$crate::options::Field<'_>> {
                vec![$($crate::options::Field::$kind(&mut self.$name $(, $range)?)),+]
            }

            $(fn check_combination(&self) -> $crate::error::Result<()> {
                $check(self)
            })?
        }
    };
}
pub(crate) use options;

/// A struct of options.
pub trait Options: Default + Clone {
    /// Its documentation.
    const DOC: &'static str;

    /// The Rust name of every option.
    const NAMES: &'static [&'static str];

    /// The documentation of every option. Apart from the names, so that modules, which need only these, do not hold it.
    const DOCS: &'static [&'static str];

    /// Every option's value, in the order of [`Options::NAMES`].
    fn fields(&mut self) -> Vec<Field<'_>>;

    /// Every option, by its JavaScript name.
    fn named_fields(&mut self) -> Vec<(String, Field<'_>)> {
        Self::names().into_iter().zip(self.fields()).collect()
    }

    /// The JavaScript names of all options.
    fn names() -> Vec<String> {
        Self::NAMES.iter().map(|name| camel_case(name)).collect()
    }

    /// Checks options that depend on each other, once each is in its range.
    ///
    /// # Errors
    /// [`ErrorCode::InvalidOption`].
    fn check_combination(&self) -> Result<()> {
        Ok(())
    }

    /// Checks every option's range, then the options that depend on each other.
    ///
    /// # Errors
    /// [`ErrorCode::InvalidOption`].
    fn validate(&self) -> Result<()> {
        let mut copy = self.clone();
        copy.named_fields().iter().try_for_each(|(name, field)| field.check(name))?;
        self.check_combination()
    }
}

/// `known_extent_m` as `knownExtentM`.
fn camel_case(name: &str) -> String {
    let mut words = name.split('_');
    let mut camel = words.next().unwrap_or_default().to_owned();
    for word in words {
        let (first, rest) = word.split_at(word.len().min(1));
        camel.push_str(&first.to_ascii_uppercase());
        camel.push_str(rest);
    }
    camel
}

impl Field<'_> {
    /// The values that the option takes, in words.
    pub fn expected(&self) -> String {
        let between = |range: &RangeInclusive<f64>| {
            format!("a number from {} to {}", number(*range.start()), number(*range.end()))
        };
        match self {
            Self::Count(_, range) => format!("a whole number from {} to {}", range.start(), range.end()),
            Self::Number(_, range) => between(range),
            Self::OptionalNumber(_, range) => format!("{}, or null", between(range)),
            Self::Positive(_) => "a finite number above 0, or null".into(),
            Self::Flag(_) => "true or false".into(),
            Self::Scale(_) => scale::EXPECTED.into(),
            Self::Direction(_) => "three finite numbers, not all 0, or null".into(),
            Self::Symmetry(_) => SYMMETRY.into(),
            Self::Transform(_) => "a transform, or null".into(),
            Self::Guard(_) => "[min, max] with 0 < min ≤ 1 ≤ max, or null".into(),
            Self::Choice(choice) => format!("one of \"{}\"", choice.names().join("\", \"")),
        }
    }

    /// Checks that the value is in its range; `name` is the option's JavaScript name.
    ///
    /// # Errors
    /// [`ErrorCode::InvalidOption`].
    pub fn check(&self, name: &str) -> Result<()> {
        let (fits, found) = match self {
            Self::Count(value, range) => (range.contains(value), number(f64::from(**value))),
            Self::Number(value, range) => (range.contains(value), number(**value)),
            Self::OptionalNumber(Some(value), range) => (range.contains(value), number(*value)),
            Self::Positive(Some(value)) => (value.is_finite() && *value > 0.0, number(*value)),
            Self::Guard(Some([min, max])) => {
                (*min > 0.0 && *min <= 1.0 && *max >= 1.0 && max.is_finite(), numbers(&[*min, *max]))
            }
            Self::Scale(scale) => return scale.check(&format!("options.{name}")),
            Self::Direction(Some(direction)) => {
                let squared: f64 = direction.iter().map(|x| x * x).sum();
                (squared.is_finite() && squared > 0.0, numbers(direction.as_slice()))
            }
            // Symmetries and transforms are checked where they are made.
            _ => return Ok(()),
        };
        if fits { Ok(()) } else { Err(self.error(name, found)) }
    }

    /// The error for a value that the option does not take.
    pub fn error(&self, name: &str, found: String) -> Error {
        let remedy = "Leave the option out to take its default.";
        Error::new(ErrorCode::InvalidOption, format!("options.{name}"), found, self.expected(), remedy)
    }
}
