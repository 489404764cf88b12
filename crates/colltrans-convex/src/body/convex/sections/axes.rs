//! The four section axes of a body, and the selection of one axis for each of two bodies.
//!
//! Two axes `a`, `b` and the direction `d` are in general configuration if `a . d != 0`, `b . d != 0` and
//! `a x b != 0`. For any poses and direction, at least one pair of section axes is in general configuration, with a
//! margin of `1/3` (`docs/theory/sections.md`).

use glam::{DMat3, DVec3};

/// The section axes in the body frame. Their length is `sqrt 3`, so that a level is a sum of signed coordinates.
pub(crate) const AXES: [DVec3; 4] = [
    DVec3::new(1.0, 1.0, 1.0),
    DVec3::new(1.0, -1.0, -1.0),
    DVec3::new(-1.0, 1.0, -1.0),
    DVec3::new(-1.0, -1.0, 1.0),
];

/// Length of a section axis: the factor between a distance along it and the difference of levels.
pub(crate) const AXIS_LENGTH: f64 = 1.732_050_807_568_877_2;

/// One section axis of each body: its index in [`AXES`], and its direction in the frame of the setting.
#[derive(Debug, Clone, Copy)]
pub(crate) struct AxisPair {
    /// Axis of the moving body.
    pub(crate) moving: (usize, DVec3),
    /// Axis of the fixed body.
    pub(crate) fixed: (usize, DVec3),
}

impl AxisPair {
    /// Selects the pair that is farthest from a degenerate configuration with the unit direction `unit`. `moving`
    /// and `fixed` map the body frames to the frame of the setting.
    pub(crate) fn most_general(moving: &DMat3, fixed: &DMat3, unit: DVec3) -> Self {
        // The squares of the three quantities for unit vectors, times a common factor 9.
        let along = |matrix: &DMat3| levels_of(matrix.transpose() * unit).map(|l| 3.0 * (l * l));
        let (a_along, b_along) = (along(moving), along(fixed));
        let ((mut i, mut j), mut quality) = ((0, 0), -1.0);
        // Only axes that lie more along the direction than the best pair can improve it. Therefore the axis nearest
        // to the direction comes first. Of equal pairs, the first one counts.
        let nearest = (1..4).fold(0, |best, k| if a_along[k] > a_along[best] { k } else { best });
        for k in std::iter::once(nearest).chain((0..4).filter(|&k| k != nearest)) {
            if a_along[k] < quality {
                continue;
            }
            let cosines = levels_of(fixed.transpose() * (*moving * AXES[k]));
            for l in 0..4 {
                let q = a_along[k].min(b_along[l]).min(9.0 - cosines[l] * cosines[l]);
                if q > quality || (q == quality && (k, l) < (i, j)) {
                    ((i, j), quality) = ((k, l), q);
                }
            }
        }
        Self { moving: (i, *moving * AXES[i]), fixed: (j, *fixed * AXES[j]) }
    }
}

/// Returns the products of a vector with all [`AXES`].
#[inline]
fn levels_of(v: DVec3) -> [f64; 4] {
    let (sum, difference) = (v.y + v.z, v.y - v.z);
    [v.x + sum, v.x - sum, difference - v.x, -difference - v.x]
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DQuat;

    #[test]
    fn chosen_axis_pair_is_in_general_configuration() {
        let mut worst = f64::INFINITY;
        let mut check = |moving: DMat3, fixed: DMat3, d: DVec3| {
            let pair = AxisPair::most_general(&moving, &fixed, d);
            let (a, b) = (pair.moving.1.normalize(), pair.fixed.1.normalize());
            worst = worst.min(a.dot(d).abs().min(b.dot(d).abs()).min(a.cross(b).length()));
        };
        check(DMat3::IDENTITY, DMat3::IDENTITY, DVec3::Z);
        check(DMat3::IDENTITY, DMat3::from_quat(DQuat::from_rotation_x(1.0)), DVec3::X);
        let mut state = 1_u64;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        };
        for _ in 0..20_000 {
            let m = DMat3::from_quat(DQuat::from_xyzw(next(), next(), next(), next()).normalize());
            let f = DMat3::from_quat(DQuat::from_xyzw(next(), next(), next(), next()).normalize());
            check(m, f, DVec3::new(next(), next(), next()).normalize());
        }
        assert!(worst > 1.0 / 3.0 - 1e-12, "{worst}");
    }
}
