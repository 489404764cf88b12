//! Arithmetic: the range of numbers, the bounds of their rounding errors, and decisions that
//! rounding cannot make.

pub mod angle;
pub mod determinant;
mod double;
pub mod error_free;
pub(crate) mod extent;
pub mod fine;
pub mod integer;
pub mod noise;
pub(crate) mod orientation;
pub mod plane;
pub mod predicates;
pub mod range;
pub mod real;
pub(crate) mod symmetric;
pub(crate) mod volume;

#[cfg(test)]
mod tests {
    //! Numbers for the tests of this room.

    use dashu_ratio::RBig;
    use glam::DVec3;
    use proptest::prelude::*;

    pub(super) fn rational(x: f64) -> RBig {
        RBig::try_from(x).unwrap()
    }

    /// Numbers of very different size, zero and ties among them.
    pub(super) fn number() -> impl Strategy<Value = f64> {
        prop_oneof![
            Just(0.0),
            (-4_i32..=4).prop_map(f64::from),
            -1.0..1.0_f64,
            (-1.0..1.0_f64, -180_i32..180).prop_map(|(x, e)| x * 2.0_f64.powi(e)),
        ]
    }

    pub(super) fn vector() -> impl Strategy<Value = DVec3> {
        [number(), number(), number()].prop_map(DVec3::from_array)
    }
}
