//! Numbers with proven bounds.

/// A number and what is proven of it: `lower <= value <= upper`, and the true one lies between the
/// same bounds. An infinite bound claims nothing.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct Bounded {
    /// The best estimate.
    pub value: f64,
    /// Not more than the true number.
    #[cfg_attr(feature = "serde", serde(with = "crate::written::or_minus_infinite"))]
    pub lower: f64,
    /// Not less than the true number.
    #[cfg_attr(feature = "serde", serde(with = "crate::written::or_infinite"))]
    pub upper: f64,
}

impl Bounded {
    /// `[lower, upper]`.
    pub const fn bounds(&self) -> [f64; 2] {
        [self.lower, self.upper]
    }

    /// Of the number with the other sign.
    #[must_use]
    #[inline]
    pub fn negated(self) -> Self {
        // Not -0.
        Self { value: 0.0 - self.value, lower: 0.0 - self.upper, upper: 0.0 - self.lower }
    }

    /// Of a number that is not negative whatever was computed.
    #[must_use]
    #[inline]
    pub fn clamped(self) -> Self {
        let Self { value, lower, upper } = self;
        Self { value: value.max(0.0), lower: lower.max(0.0), upper: upper.max(0.0) }
    }
}

/// A contact at an end of a range: where it is, between proven bounds.
#[doc(hidden)]
pub trait RangeEnd {
    /// Returns where the bodies meet, in multiples of the direction.
    fn bounded(&self) -> Bounded;

    /// Returns where they part along the direction, of the first contact of the reversed cast.
    fn exit(&self) -> Bounded {
        self.bounded().negated()
    }
}
