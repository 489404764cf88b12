//! Textual forms of values: names of choices, and numbers that may be infinite.

use thiserror::Error;

/// A text that is not the name of any choice.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("there is no {what} {name:?}; there are {}", .known.join(", "))]
pub struct UnknownName {
    /// What the text should name, for example "solver".
    pub what: &'static str,
    /// The text as given.
    pub name: String,
    /// The accepted names.
    pub known: &'static [&'static str],
}

/// Implements name, `Display` and `FromStr` for an enum, with the names that serde uses.
#[doc(hidden)]
#[macro_export]
macro_rules! named {
    ($what:literal, $choice:ident { $($variant:ident: $name:literal),+ }) => {
        impl $choice {
            /// Returns the name of the choice.
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
            type Err = $crate::serialization::UnknownName;

            fn from_str(name: &str) -> Result<Self, $crate::serialization::UnknownName> {
                match name {
                    $($name => Ok(Self::$variant),)+
                    _ => Err($crate::serialization::UnknownName { what: $what, name: name.into(), known: &[$($name),+] }),
                }
            }
        }
    };
}

#[doc(hidden)]
pub use named;

/// Serde functions for a number that may be plus infinity. Every format stores an infinite number as `null`,
/// because JSON has no infinity.
#[cfg(feature = "serde")]
#[doc(hidden)]
pub mod null_as_infinity {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    /// Writes a finite number, or `null`.
    pub fn serialize<S: Serializer>(value: &f64, to: S) -> Result<S::Ok, S::Error> {
        Some(value).filter(|value| value.is_finite()).serialize(to)
    }

    /// Reads a number, or infinity for `null`.
    #[inline]
    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
        Ok(Option::deserialize(from)?.unwrap_or(f64::INFINITY))
    }
}

/// Checks whether a number is 0, so that serde can skip it.
#[cfg(feature = "serde")]
#[inline]
#[doc(hidden)]
pub fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

/// Checks whether a count is 0, so that serde can skip it.
#[cfg(feature = "serde")]
#[inline]
#[doc(hidden)]
pub fn is_zero_count(count: &u64) -> bool {
    *count == 0
}

/// Reads a value that may be `null` but must be present. Without this function, serde reads a missing field
/// as `null`.
#[cfg(feature = "serde")]
#[inline]
#[doc(hidden)]
pub fn required_option<'de, T, D>(from: D) -> Result<Option<T>, D::Error>
where
    T: serde::Deserialize<'de>,
    D: serde::Deserializer<'de>,
{
    serde::Deserialize::deserialize(from)
}

/// Serde functions for a number that may be minus infinity, which every format stores as `null`.
#[cfg(feature = "serde")]
#[doc(hidden)]
pub mod null_as_minus_infinity {
    use serde::{Deserialize, Deserializer};

    pub use super::null_as_infinity::serialize;

    /// Reads a number, or minus infinity for `null`.
    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
        Ok(Option::deserialize(from)?.unwrap_or(f64::NEG_INFINITY))
    }
}
