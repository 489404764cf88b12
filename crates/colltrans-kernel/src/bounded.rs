//! Numbers with proven lower and upper bounds.

/// An estimate with proven bounds: `lower <= value <= upper`, and the true number lies between the same
/// bounds. An infinite bound claims nothing.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct Bounded {
    /// The best estimate.
    pub value: f64,
    /// Proven lower bound of the true number; minus infinity claims nothing.
    #[cfg_attr(feature = "serde", serde(with = "crate::serialization::null_as_minus_infinity"))]
    pub lower: f64,
    /// Proven upper bound of the true number; infinity claims nothing.
    #[cfg_attr(feature = "serde", serde(with = "crate::serialization::null_as_infinity"))]
    pub upper: f64,
}

impl Bounded {
    /// Returns the bounds as `[lower, upper]`.
    pub const fn bounds(&self) -> [f64; 2] {
        [self.lower, self.upper]
    }

    /// Returns the bounds of the negated number.
    #[must_use]
    #[inline]
    pub fn negated(self) -> Self {
        // A subtraction from 0 avoids -0.
        Self { value: 0.0 - self.value, lower: 0.0 - self.upper, upper: 0.0 - self.lower }
    }

    /// Returns the bounds raised to at least 0, for a number that is not negative.
    #[must_use]
    #[inline]
    pub fn clamped_to_nonnegative(self) -> Self {
        let Self { value, lower, upper } = self;
        Self { value: value.max(0.0), lower: lower.max(0.0), upper: upper.max(0.0) }
    }
}

/// A contact at one end of a contact range, with proven bounds.
#[doc(hidden)]
pub trait RangeEnd {
    /// Returns the translation at the contact with its bounds, in multiples of the direction.
    fn bounded_translation(&self) -> Bounded;

    /// Returns the translation at which the bodies separate along the direction, where `self` is the first
    /// contact of the reversed cast.
    fn exit_translation(&self) -> Bounded {
        self.bounded_translation().negated()
    }
}
