//! Numbers and vectors for people.

use colltrans::glam::DVec3;
pub(crate) use colltrans_mesh::words::{about, counted, decade, known, number, six_digits};

/// The error of the components of a unit vector that is worth showing.
const UNIT_ERROR: f64 = 1e-14;

/// A unit vector.
pub(crate) fn unit_vector(v: DVec3) -> String {
    known_vector(v, UNIT_ERROR)
}

pub(crate) fn vector(v: DVec3) -> String {
    v.to_array().map(number).join(",")
}

pub(crate) fn known_vector(v: DVec3, error: f64) -> String {
    v.to_array().map(|c| known(c, error)).join(",")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zero_is_zero() {
        assert_eq!(vector(DVec3::new(-0.0, 1.0, -2.5)), "0,1,-2.5");
        assert_eq!(unit_vector(DVec3::new(1e-17, -1e-16, -1.0)), "0,0,-1");
    }
}
