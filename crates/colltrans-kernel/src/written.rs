//! How values are written wherever they are: names of choices, and numbers that may be infinite.

use thiserror::Error;

/// A text that names none of the choices.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("there is no {what} {name:?}; there are {}", .known.join(", "))]
pub struct UnknownName {
    /// What it should name.
    pub what: &'static str,
    /// The text.
    pub name: String,
    /// The names that there are.
    pub known: &'static [&'static str],
}

/// A choice and its names: those that serde writes, as `Display`, and back.
#[doc(hidden)]
#[macro_export]
macro_rules! named {
    ($what:literal, $choice:ident { $($variant:ident: $name:literal),+ }) => {
        impl $choice {
            /// As it is written.
            #[inline]
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $name),+
                }
            }
        }

        impl std::fmt::Display for $choice {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.pad(self.name())
            }
        }

        impl std::str::FromStr for $choice {
            type Err = $crate::written::UnknownName;

            fn from_str(name: &str) -> Result<Self, $crate::written::UnknownName> {
                match name {
                    $($name => Ok(Self::$variant),)+
                    _ => Err($crate::written::UnknownName { what: $what, name: name.into(), known: &[$($name),+] }),
                }
            }
        }
    };
}

#[doc(hidden)]
pub use named;

/// A number that is infinite where nothing is known or nothing stops: JSON has no such number, so it
/// is written as nothing (`null`), in every format.
#[cfg(feature = "serde")]
pub mod or_infinite {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub fn serialize<S: Serializer>(value: &f64, to: S) -> Result<S::Ok, S::Error> {
        Some(value).filter(|value| value.is_finite()).serialize(to)
    }

    #[inline]
    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
        Ok(Option::deserialize(from)?.unwrap_or(f64::INFINITY))
    }
}

/// Whether a number is 0, so that it need not be written.
#[cfg(feature = "serde")]
#[inline]
pub fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

/// The same of a count.
#[cfg(feature = "serde")]
#[inline]
pub fn is_none(count: &u64) -> bool {
    *count == 0
}

/// A value that may be `null`, but has to be there: a field that is missing counts as `null` otherwise.
#[cfg(feature = "serde")]
#[inline]
pub fn given<'de, T, D>(from: D) -> Result<Option<T>, D::Error>
where
    T: serde::Deserialize<'de>,
    D: serde::Deserializer<'de>,
{
    serde::Deserialize::deserialize(from)
}

/// The same of a lower bound.
#[cfg(feature = "serde")]
pub mod or_minus_infinite {
    use serde::{Deserialize, Deserializer};

    pub use super::or_infinite::serialize;

    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
        Ok(Option::deserialize(from)?.unwrap_or(f64::NEG_INFINITY))
    }
}
