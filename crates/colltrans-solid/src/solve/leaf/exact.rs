//! The gap of two facets with exact signs; its values are exact except for their last roundings.
//!
//! Each gap ([`Above`]) is a quotient of two determinants, in multiples of the direction. The numerator is six times
//! the volume of a tetrahedron of corners. In the denominator the direction replaces one of its edges. Double-double
//! numbers are tried first, then small integers, then large ones, whose size suffices for all inputs.

use std::cmp::Ordering;

use super::facet::{Facet, Turns, sides_cross};
use super::{Gap, Meeting};
use crate::solve::scene::{ExactPoint, PairFrame, PlacedVertex};
use colltrans_kernel::extended::{self, ExtendedDisplacement, ExtendedPoint};
use colltrans_kernel::integer::{Integer, LARGE_LIMBS, SMALL_LIMBS, determinant, difference};

/// Maximum error, in noises, of a gap that counts as exact except for its last roundings.
const UNSEEN: f64 = f64::EPSILON / 4.0;

/// Computes the gap from exact signs at those corners of the common shadow for which `keep` returns true.
pub(super) fn exact_range(
    scene: &PairFrame,
    f: &Facet,
    g: &Facet,
    of_f: &Turns,
    of_g: &Turns,
    keep: impl Fn(Meeting) -> bool,
) -> Gap {
    let mut gap = NO_GAP;
    let corners = shadow_corners(of_f, of_g).filter(|&at| keep(at));
    if f.is_level_with(g) {
        corners.for_each(|at| gap.add_corner(scene, Above::LEVEL, at));
        return gap;
    }
    let fine = FinePair::new(scene, f, g);
    for at in corners {
        let above = fine
            .height_at(at)
            .or_else(|| above_at::<SMALL_LIMBS>(scene, f, g, at))
            .or_else(|| above_at::<LARGE_LIMBS>(scene, f, g, at));
        // Large integers never overflow, so the alternative is not used.
        gap.add_corner(scene, above.unwrap_or(Above::LEVEL), at);
    }
    gap
}

/// Returns the corners of the common shadow.
fn shadow_corners<'t>(of_f: &'t Turns, of_g: &'t Turns) -> impl Iterator<Item = Meeting> + 't {
    let ends = (0..3_u8).flat_map(|k| [Meeting::Corner(k), Meeting::Under(k)]);
    let sides = (0..3_u8).flat_map(|k| (0..3_u8).map(move |j| Meeting::Sides(k, j)));
    ends.chain(sides).filter(|at| match *at {
        Meeting::Corner(k) => of_g.contains_corner(k.into()),
        Meeting::Under(k) => of_f.contains_corner(k.into()),
        Meeting::Sides(k, j) => sides_cross(of_f, of_g, [k.into(), j.into()]),
        _ => false,
    })
}

/// The gap before any corner is added.
pub(crate) const NO_GAP: Gap = Gap {
    least: f64::INFINITY,
    largest: f64::NEG_INFINITY,
    signs: [Ordering::Greater, Ordering::Less],
    at: Meeting::Corner(0),
    error: 0.0,
};

/// Computes the height of the second facet above the first at a corner of the common shadow; `None` if a number does
/// not fit.
fn above_at<const N: usize>(scene: &PairFrame, f: &Facet, g: &Facet, at: Meeting) -> Option<Above> {
    let direction = scene.setting.direction.to_array().map(Integer::<N>::exact_number);
    match at {
        Meeting::Corner(k) => {
            Some(above_facet(scene, &direction, g, &f.corners[usize::from(k)])?.reversed())
        }
        Meeting::Under(k) => above_facet(scene, &direction, f, &g.corners[usize::from(k)]),
        Meeting::Sides(k, j) => {
            above_side(scene, &direction, f.side_ends(k.into()), g.side_ends(j.into()))
        }
        _ => None,
    }
}

/// Two facets in double-double precision.
struct FinePair<'s, 'a> {
    scene: &'s PairFrame<'a>,
    /// Corners of both facets.
    points: [[ExtendedPoint; 3]; 2],
    direction: ExtendedPoint,
}

impl<'s, 'a> FinePair<'s, 'a> {
    fn new(scene: &'s PairFrame<'a>, f: &Facet, g: &Facet) -> Self {
        let points = [f, g].map(|facet| facet.corners.map(|c| c.double_double_position(scene)));
        let direction = ExtendedPoint::from_exact(scene.setting.direction);
        Self { scene, points, direction }
    }

    /// Computes the height of [`above_at`]; `None` if the precision does not suffice.
    fn height_at(&self, at: Meeting) -> Option<Above> {
        match at {
            Meeting::Corner(k) => Some(self.above_facet(1, k.into())?.reversed()),
            Meeting::Under(k) => self.above_facet(0, k.into()),
            Meeting::Sides(k, j) => self.above_side(k.into(), j.into()),
            _ => None,
        }
    }

    /// Computes the height of a corner of the other facet above the plane of `facet`; `None` if the precision does not
    /// suffice.
    fn above_facet(&self, facet: usize, corner: usize) -> Option<Above> {
        let [a, b, c] = &self.points[facet];
        let [x, y, z] = [b, c, &self.points[1 - facet][corner]].map(|q| a.displacement_to(q));
        self.volume_over_area([x, y, z], [x, y])
    }

    /// Computes the height of side `j` of the second facet above side `k` of the first where their shadows cross;
    /// `None` if the precision does not suffice.
    fn above_side(&self, k: usize, j: usize) -> Option<Above> {
        let [p, q] = &self.points;
        let (c, e) = (&q[j], &q[(j + 1) % 3]);
        let [x, y, z] = [&p[(k + 1) % 3], c, e].map(|r| p[k].displacement_to(r));
        Some(self.volume_over_area([x, y, z], [x, c.displacement_to(e)])?.reversed())
    }

    /// Returns a volume over an area; `None` if the precision does not suffice.
    fn volume_over_area(
        &self,
        volume: [ExtendedDisplacement; 3],
        [x, y]: [ExtendedDisplacement; 2],
    ) -> Option<Above> {
        let over = extended::determinant(volume);
        let Some(sign) = over.sign() else {
            return extended::tracked_determinant_sign(volume)?.is_eq().then_some(Above::LEVEL);
        };
        let under =
            extended::determinant([x, y, ExtendedPoint::ORIGIN.displacement_to(&self.direction)]);
        let sign = if under.sign()?.is_lt() { sign.reverse() } else { sign };
        let slack = UNSEEN * self.scene.noise / self.scene.setting.length;
        let value = over.ratio(&under, slack)?;
        Some(Above { sign, value })
    }
}

/// Computes the height of a corner above the plane of a facet of either orientation, as a multiple of the direction;
/// `None` if a number does not fit.
fn above_facet<const N: usize>(
    scene: &PairFrame,
    direction: &[Integer<N>; 3],
    facet: &Facet,
    corner: &PlacedVertex,
) -> Option<Above> {
    let [a, b, c] = facet.corners.each_ref();
    let [x, y, z] = scene.spans_wide(a, [b, c, corner]);
    Above::new(&determinant(&x, &y, &z), &determinant(&x, &y, direction))
}

/// Computes the height of side `c e` above side `a b` where their shadows cross; `None` if a number does not fit.
fn above_side<const N: usize>(
    scene: &PairFrame,
    direction: &[Integer<N>; 3],
    [a, b]: [&PlacedVertex; 2],
    [c, e]: [&PlacedVertex; 2],
) -> Option<Above> {
    let [x, y, z] = scene.spans_wide(a, [b, c, e]);
    let plane = determinant(&x, &difference(&z, &y), direction);
    Some(Above::new(&determinant(&x, &y, &z), &plane)?.reversed())
}

/// Computes the height of a corner above a facet whose shadow contains that of the corner.
pub(crate) fn over_facet(scene: &PairFrame, facet: &Facet, corner: &PlacedVertex) -> Above {
    let d = scene.setting.direction.to_array();
    let small = above_facet::<SMALL_LIMBS>(scene, &d.map(Integer::exact_number), facet, corner);
    let large = || above_facet::<LARGE_LIMBS>(scene, &d.map(Integer::exact_number), facet, corner);
    small.or_else(large).unwrap_or(Above::LEVEL)
}

/// Computes the height of the side `above` over `side` where their shadows cross.
pub(crate) fn over_side(
    scene: &PairFrame,
    side: [&PlacedVertex; 2],
    above: [&PlacedVertex; 2],
) -> Above {
    let d = scene.setting.direction.to_array();
    let small = above_side::<SMALL_LIMBS>(scene, &d.map(Integer::exact_number), side, above);
    let large = || above_side::<LARGE_LIMBS>(scene, &d.map(Integer::exact_number), side, above);
    small.or_else(large).unwrap_or(Above::LEVEL)
}

/// A quotient of two numbers: its exact sign, and its value within a few roundings.
#[derive(Clone, Copy)]
pub(crate) struct Above {
    sign: Ordering,
    value: f64,
}

impl Above {
    /// Height 0, also the replacement for numbers that do not fit, which do not occur.
    pub(crate) const LEVEL: Self = Self { sign: Ordering::Equal, value: 0.0 };

    /// Builds the quotient; `None` if a number does not fit.
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
    /// Adds a corner of the common shadow. `above` is a multiple of the direction.
    pub(crate) fn add_corner(&mut self, scene: &PairFrame, above: Above, at: Meeting) {
        let Above { sign, value } = above;
        let value = if sign == Ordering::Equal { 0.0 } else { value * scene.setting.length };
        if value < self.least {
            (self.least, self.at) = (value, at);
        }
        self.largest = self.largest.max(value);
        self.signs = [self.signs[0].min(sign), self.signs[1].max(sign)];
    }
}
