//! Enumerations whose values have names: on command lines, in files and in tables.

/// Declares an enumeration and the names of its values, by which `str::parse` finds them.
macro_rules! named {
    ($(#[$about:meta])* pub enum $name:ident { $($(#[$doc:meta])* $value:ident = $text:literal,)+ }) => {
        $(#[$about])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum $name {
            $($(#[$doc])* $value,)+
        }

        impl $name {
            /// All values.
            pub const ALL: &'static [Self] = &[$(Self::$value),+];

            /// The name.
            pub fn as_str(self) -> &'static str {
                match self {
                    $(Self::$value => $text,)+
                }
            }
        }

        impl core::str::FromStr for $name {
            type Err = String;

            fn from_str(name: &str) -> core::result::Result<Self, String> {
                let found = Self::ALL.iter().copied().find(|value| value.as_str() == name);
                found.ok_or_else(|| format!("found {name:?}, expected {}", [$($text),+].join(" or ")))
            }
        }
    };
}

pub(crate) use named;
