//! The gap of two facets with exact signs, its values exact but for their last roundings.
//!
//! Each gap is a quotient, [`Above`]: six times the volume of a tetrahedron over that of one whose last edge
//! is the direction. Numbers of twice the usual precision are tried first, then whole numbers of ordinary
//! size; large ones have room for all there are.

use std::cmp::Ordering;

use super::facet::{Facet, Turns, cross};
use super::{Gap, Meeting};
use crate::solve::scene::{Corner, ExactPoint, Scene};
use colltrans_kernel::fine::{self, Fine, Way};
use colltrans_kernel::integer::{Integer, LARGE, SMALL, determinant, difference};

/// A gap may be off by so much of the noise of coordinates and is still exact but for its last roundings.
const UNSEEN: f64 = f64::EPSILON / 4.0;

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
    let mut gap = NO_GAP;
    let corners = corners(of_f, of_g).filter(|&at| keep(at));
    if f.is_level_with(g) {
        corners.for_each(|at| gap.add(scene, Above::LEVEL, at));
        return gap;
    }
    let fine = FinePair::new(scene, f, g);
    for at in corners {
        let above = fine
            .above(at)
            .or_else(|| above_at::<SMALL>(scene, f, g, at))
            .or_else(|| above_at::<LARGE>(scene, f, g, at));
        // Large numbers have room for all there are.
        gap.add(scene, above.unwrap_or(Above::LEVEL), at);
    }
    gap
}

/// The corners of the common shadow.
fn corners<'t>(of_f: &'t Turns, of_g: &'t Turns) -> impl Iterator<Item = Meeting> + 't {
    let ends = (0..3_u8).flat_map(|k| [Meeting::Corner(k), Meeting::Under(k)]);
    let sides = (0..3_u8).flat_map(|k| (0..3_u8).map(move |j| Meeting::Sides(k, j)));
    ends.chain(sides).filter(|at| match *at {
        Meeting::Corner(k) => of_g.contain(k.into()),
        Meeting::Under(k) => of_f.contain(k.into()),
        Meeting::Sides(k, j) => cross(of_f, of_g, [k.into(), j.into()]),
        _ => false,
    })
}

/// Before any corner is looked at.
pub(crate) const NO_GAP: Gap = Gap {
    least: f64::INFINITY,
    largest: f64::NEG_INFINITY,
    signs: [Ordering::Greater, Ordering::Less],
    at: Meeting::Corner(0),
    error: 0.0,
};

/// How far the second facet is above the first at a corner of the common shadow; `None` if a number does
/// not fit.
fn above_at<const N: usize>(scene: &Scene, f: &Facet, g: &Facet, at: Meeting) -> Option<Above> {
    let direction = scene.setting.direction.to_array().map(Integer::<N>::number);
    match at {
        Meeting::Corner(k) => {
            Some(above_facet(scene, &direction, g, &f.corners[usize::from(k)])?.reversed())
        }
        Meeting::Under(k) => above_facet(scene, &direction, f, &g.corners[usize::from(k)]),
        Meeting::Sides(k, j) => above_side(scene, &direction, f.side(k.into()), g.side(j.into())),
        _ => None,
    }
}

/// Two facets in twice the usual precision.
struct FinePair<'s, 'a> {
    scene: &'s Scene<'a>,
    /// Their corners.
    points: [[Fine; 3]; 2],
    direction: Fine,
}

impl<'s, 'a> FinePair<'s, 'a> {
    fn new(scene: &'s Scene<'a>, f: &Facet, g: &Facet) -> Self {
        let points = [f, g].map(|facet| facet.corners.map(|c| c.fine(scene)));
        let direction = Fine::exactly(scene.setting.direction);
        Self { scene, points, direction }
    }

    /// As [`above_at`]; `None` where that is not known well enough.
    fn above(&self, at: Meeting) -> Option<Above> {
        match at {
            Meeting::Corner(k) => Some(self.above_facet(1, k.into())?.reversed()),
            Meeting::Under(k) => self.above_facet(0, k.into()),
            Meeting::Sides(k, j) => self.above_side(k.into(), j.into()),
            _ => None,
        }
    }

    /// How far a corner of the other facet is above the plane of one.
    fn above_facet(&self, facet: usize, corner: usize) -> Option<Above> {
        let [a, b, c] = &self.points[facet];
        let [x, y, z] = [b, c, &self.points[1 - facet][corner]].map(|q| a.to(q));
        self.quotient([x, y, z], [x, y])
    }

    /// How far side `j` of the second facet is above side `k` of the first where their shadows cross.
    fn above_side(&self, k: usize, j: usize) -> Option<Above> {
        let [p, q] = &self.points;
        let (c, e) = (&q[j], &q[(j + 1) % 3]);
        let [x, y, z] = [&p[(k + 1) % 3], c, e].map(|r| p[k].to(r));
        Some(self.quotient([x, y, z], [x, c.to(e)])?.reversed())
    }

    /// A volume over an area.
    fn quotient(&self, volume: [Way; 3], [x, y]: [Way; 2]) -> Option<Above> {
        let over = fine::determinant(volume);
        let Some(sign) = over.sign() else {
            return fine::tracked_sign(volume)?.is_eq().then_some(Above::LEVEL);
        };
        let under = fine::determinant([x, y, Fine::ORIGIN.to(&self.direction)]);
        let sign = if under.sign()?.is_lt() { sign.reverse() } else { sign };
        let slack = UNSEEN * self.scene.noise / self.scene.setting.length;
        let value = over.ratio(&under, slack)?;
        Some(Above { sign, value })
    }
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
