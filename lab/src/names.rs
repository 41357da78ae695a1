//! Enumerations whose values have names: on command lines, in files and in tables.

use sim3align_runtime::error::{Error, ErrorCode, Result};

/// A value of an enumeration with names.
pub trait Named: Copy + PartialEq + 'static {
    /// The name of such a value in errors.
    const ARGUMENT: &'static str;
    /// All values.
    const ALL: &'static [Self];

    /// The name.
    fn as_str(self) -> &'static str;

    /// All names.
    fn names() -> Vec<&'static str> {
        Self::ALL.iter().map(|value| value.as_str()).collect()
    }

    /// The value of a name, which [`str::parse`] gives as well.
    ///
    /// # Errors
    /// [`ErrorCode::InvalidOption`] for any other.
    fn from_name(name: &str) -> Result<Self> {
        Self::ALL.iter().copied().find(|value| value.as_str() == name).ok_or_else(|| {
            let remedy = "Pass one of these, or several with commas between them.";
            let (found, expected) = (format!("{name:?}"), Self::names().join(" or "));
            Error::new(ErrorCode::InvalidOption, Self::ARGUMENT, found, expected, remedy)
        })
    }
}

/// Declares an enumeration and the names of its values.
macro_rules! named {
    ($(#[$about:meta])* pub enum $name:ident: $argument:literal {
        $($(#[$doc:meta])* $value:ident = $text:literal,)+
    }) => {
        $(#[$about])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum $name {
            $($(#[$doc])* $value,)+
        }

        impl $crate::names::Named for $name {
            const ARGUMENT: &'static str = $argument;
            const ALL: &'static [Self] = &[$(Self::$value),+];

            fn as_str(self) -> &'static str {
                match self {
                    $(Self::$value => $text,)+
                }
            }
        }

        impl core::str::FromStr for $name {
            type Err = sim3align_runtime::error::Error;

            fn from_str(name: &str) -> sim3align_runtime::error::Result<Self> {
                $crate::names::Named::from_name(name)
            }
        }
    };
}

pub(crate) use named;
