//! The gap of two facets from whole numbers: exact signs, values exact but for their last roundings.
//!
//! Each gap is a quotient, [`Above`]: six times the volume of a tetrahedron over that of one whose last edge
//! is the direction. Small numbers are tried first; large ones have room for all there are.

use std::cmp::Ordering;

use super::facet::{Facet, Turns, cross};
use super::{Gap, Meeting};
use crate::number::integer::{Integer, LARGE, SMALL, determinant, difference};
use crate::solve::solid::scene::{Corner, Scene};

/// The gap from exact signs at those corners of the common shadow that are to be kept, its values
/// exact but for their last roundings.
pub(super) fn exact(
    scene: &Scene,
    f: &Facet,
    g: &Facet,
    of_f: &Turns,
    of_g: &Turns,
    keep: impl Fn(Meeting) -> bool,
) -> Gap {
    let small = exact_in::<SMALL>(scene, f, g, of_f, of_g, &keep);
    let gap = small.or_else(|| exact_in::<LARGE>(scene, f, g, of_f, of_g, &keep));
    // Large numbers have room for all there are.
    gap.unwrap_or(NO_GAP)
}

/// Before any corner is looked at.
pub(crate) const NO_GAP: Gap = Gap {
    least: f64::INFINITY,
    largest: f64::NEG_INFINITY,
    signs: [Ordering::Greater, Ordering::Less],
    at: Meeting::Corner(0),
    error: 0.0,
};

/// The same in numbers of a size; `None` if one does not fit.
fn exact_in<const N: usize>(
    scene: &Scene,
    f: &Facet,
    g: &Facet,
    of_f: &Turns,
    of_g: &Turns,
    keep: &impl Fn(Meeting) -> bool,
) -> Option<Gap> {
    let direction = scene.setting.direction.to_array().map(Integer::<N>::number);
    let above = |facet: &Facet, corner: &Corner| above_facet(scene, &direction, facet, corner);
    let mut gap = NO_GAP;
    for k in 0..3 {
        if of_g.contain(k) && keep(Meeting::Corner(k as u8)) {
            gap.add(scene, above(g, &f.corners[k])?.reversed(), Meeting::Corner(k as u8));
        }
        if of_f.contain(k) && keep(Meeting::Under(k as u8)) {
            gap.add(scene, above(f, &g.corners[k])?, Meeting::Under(k as u8));
        }
    }
    for k in 0..3 {
        for j in 0..3 {
            if cross(of_f, of_g, [k, j]) && keep(Meeting::Sides(k as u8, j as u8)) {
                let above = above_side(scene, &direction, f.side(k), g.side(j))?;
                gap.add(scene, above, Meeting::Sides(k as u8, j as u8));
            }
        }
    }
    Some(gap)
}

/// How far a corner is above the plane through a facet, which turns counter-clockwise from below; `None`
/// if a number does not fit.
fn above_facet<const N: usize>(
    scene: &Scene,
    direction: &[Integer<N>; 3],
    facet: &Facet,
    corner: &Corner,
) -> Option<Above> {
    let [a, b, c] = facet.corners.each_ref();
    let [x, y, z] = scene.spans_wide(a, [b, c, corner]);
    Above::new(&determinant(&x, &y, &z), &determinant(&x, &y, direction))
}

/// How far side `c e` is above side `a b` where their shadows cross; `None` if a number does not fit.
fn above_side<const N: usize>(
    scene: &Scene,
    direction: &[Integer<N>; 3],
    [a, b]: [&Corner; 2],
    [c, e]: [&Corner; 2],
) -> Option<Above> {
    let [x, y, z] = scene.spans_wide(a, [b, c, e]);
    let plane = determinant(&x, &difference(&z, &y), direction);
    Some(Above::new(&determinant(&x, &y, &z), &plane)?.reversed())
}

/// How far a corner is above a facet whose shadow holds its own.
pub(crate) fn over_facet(scene: &Scene, facet: &Facet, corner: &Corner) -> Above {
    let d = scene.setting.direction.to_array();
    let small = above_facet::<SMALL>(scene, &d.map(Integer::number), facet, corner);
    let large = || above_facet::<LARGE>(scene, &d.map(Integer::number), facet, corner);
    small.or_else(large).unwrap_or(Above::LEVEL)
}

/// How far a side is above another one where their shadows cross.
pub(crate) fn over_side(scene: &Scene, side: [&Corner; 2], above: [&Corner; 2]) -> Above {
    let d = scene.setting.direction.to_array();
    let small = above_side::<SMALL>(scene, &d.map(Integer::number), side, above);
    let large = || above_side::<LARGE>(scene, &d.map(Integer::number), side, above);
    small.or_else(large).unwrap_or(Above::LEVEL)
}

/// A quotient of two numbers: its sign, and its value to within a few roundings.
#[derive(Clone, Copy)]
pub(crate) struct Above {
    sign: Ordering,
    value: f64,
}

impl Above {
    /// For numbers that do not fit, of which there are none.
    pub(crate) const LEVEL: Self = Self { sign: Ordering::Equal, value: 0.0 };

    /// `None` if one of them did not fit.
    pub(crate) fn new<const N: usize>(volume: &Integer<N>, plane: &Integer<N>) -> Option<Self> {
        let sign = match plane.sign()? {
            Ordering::Less => volume.sign()?.reverse(),
            _ => volume.sign()?,
        };
        Some(Self { sign, value: volume.ratio(plane)? })
    }

    pub(crate) fn reversed(self) -> Self {
        Self { sign: self.sign.reverse(), value: -self.value }
    }
}

impl Gap {
    /// With one more corner of the common shadow, in multiples of the direction.
    pub(crate) fn add(&mut self, scene: &Scene, above: Above, at: Meeting) {
        let Above { sign, value } = above;
        let value = if sign == Ordering::Equal { 0.0 } else { value * scene.setting.length };
        if value < self.least {
            (self.least, self.at) = (value, at);
        }
        self.largest = self.largest.max(value);
        self.signs = [self.signs[0].min(sign), self.signs[1].max(sign)];
    }
}
