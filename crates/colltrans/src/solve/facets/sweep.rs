//! Boxes of two bodies with the same axes, swept along the direction.
//!
//! A box that is turned into the query frame grows. Where both bodies have the same axes, their boxes
//! can be compared as they are: points `p` and `q` with `q - p = t d` have
//! `low_B - high_A <= t d <= high_B - low_A` on each axis, which bounds the gap `t`.
//!
//! Rounding. Along an axis `|d_k| >= 2^-10`; `d_k` is off by a few `u`, and so `t` by less than
//! `2^-40 |t|`. Boxes and the offset are off by less than a blur.

use glam::DVec3;

use super::scene::Side;

/// Axes steeper than this to the direction say nothing.
const LEVEL: f64 = 1.0 / 1024.0;
/// What a quotient may be off, as a share of it.
const SHARE: f64 = 1.0 / (1_u64 << 40) as f64;

/// The axes that both bodies have.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sweep {
    /// From the fixed body's frame to the moving one's.
    shift: DVec3,
    /// What to divide by on each axis, inverted; 0 for axes that say nothing.
    inverse: DVec3,
}

impl Sweep {
    /// `None` if the bodies have different axes, or all but one say nothing: then boxes in the query
    /// frame are as good.
    pub(super) fn new(moving: &Side, fixed: &Side) -> Option<Self> {
        if moving.matrix != fixed.matrix {
            return None;
        }
        let invert = |d: f64| if d.abs() < LEVEL { 0.0 } else { d.recip() };
        let inverse = DVec3::from_array(moving.along.to_array().map(invert));
        let useful = inverse.to_array().into_iter().filter(|i| *i != 0.0).count();
        let shift = moving.matrix.transpose() * fixed.offset[0];
        (useful > 1).then_some(Self { shift, inverse })
    }

    /// The range of gaps between two boxes in their bodies' frames; empty (the first larger than the
    /// second) if their shadows are apart.
    pub(super) fn gaps(&self, a: &[DVec3; 2], b: &[DVec3; 2], blur: f64) -> [f64; 2] {
        let low = (b[0] - a[1] + self.shift - blur) * self.inverse;
        let high = (b[1] - a[0] + self.shift + blur) * self.inverse;
        let (mut enter, mut exit) = (f64::NEG_INFINITY, f64::INFINITY);
        for k in 0..3 {
            if self.inverse[k] != 0.0 {
                enter = enter.max(low[k].min(high[k]));
                exit = exit.min(low[k].max(high[k]));
            }
        }
        [enter - SHARE * enter.abs(), exit + SHARE * exit.abs()]
    }
}
