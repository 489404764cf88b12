//! Formats numbers and vectors for text output.

use colltrans::glam::DVec3;
pub(crate) use colltrans_mesh::words::{
    count_text, decade, number, rounded_to_error, rounded_up, six_digits,
};

/// Rounding error of the components of unit vectors.
const UNIT_ERROR: f64 = 1e-14;

/// Returns a unit vector with the digits that its rounding error leaves.
pub(crate) fn unit_vector(v: DVec3) -> String {
    known_vector(v, UNIT_ERROR)
}

/// Returns a vector with all digits.
pub(crate) fn vector(v: DVec3) -> String {
    v.to_array().map(number).join(",")
}

/// Returns a vector whose components are known to within `error`.
pub(crate) fn known_vector(v: DVec3, error: f64) -> String {
    v.to_array().map(|c| rounded_to_error(c, error)).join(",")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signed_zeros_print_as_zero() {
        assert_eq!(vector(DVec3::new(-0.0, 1.0, -2.5)), "0,1,-2.5");
        assert_eq!(unit_vector(DVec3::new(1e-17, -1e-16, -1.0)), "0,0,-1");
    }
}
