//! The gap of two facets from rounded coordinates: values at the corners of the common shadow, bounds on their errors,
//! and the conclusions that these permit.

use std::cmp::Ordering;

use super::facet::{Facet, Turn, Turns, sides_cross};
use super::{Gap, Meeting};
use crate::solve::scene::PairFrame;

/// A gap from rounded coordinates.
pub(super) enum Rounded {
    /// The errors are small and the signs are certain. Only the sign of a least gap that is not certainly positive is
    /// `Less` without proof, if it is not needed.
    Known(Gap),
    /// The least gap is certainly not smaller than this value.
    Beyond(f64),
}

/// Collects gaps at the corners of the common shadow.
pub(super) struct Range {
    least: f64,
    largest: f64,
    at: Meeting,
    pub(super) negative: bool,
    positive: bool,
    /// Lower and upper bound of all gaps.
    pub(super) bound: [f64; 2],
    /// The largest error of a gap.
    worst: f64,
}

impl Range {
    fn add(&mut self, (value, error): (f64, f64), at: Meeting) {
        if value < self.least {
            (self.least, self.at) = (value, at);
        }
        self.largest = self.largest.max(value);
        self.worst = self.worst.max(error);
        self.bound = [self.bound[0].min(value - error), self.bound[1].max(value + error)];
        self.negative |= value < -error;
        self.positive |= value > error;
    }

    pub(super) fn conclude(self, sharp: f64, needed: bool) -> Rounded {
        let [low, high] = self.bound;
        let least = if low > 0.0 {
            Some(Ordering::Greater)
        } else {
            (self.negative || !needed).then_some(Ordering::Less)
        };
        let largest = if self.positive {
            Some(Ordering::Greater)
        } else {
            (high < 0.0).then_some(Ordering::Less)
        };
        match (least, largest) {
            (Some(a), Some(b)) if self.worst <= sharp => {
                let Self { least, largest, at, worst, .. } = self;
                Rounded::Known(Gap { least, largest, signs: [a, b], at, error: worst })
            }
            _ => Rounded::Beyond(low),
        }
    }
}

pub(super) fn rounded_range(
    scene: &PairFrame,
    f: &Facet,
    g: &Facet,
    of_f: &Turns,
    of_g: &Turns,
) -> Range {
    let mut range = Range {
        least: f64::INFINITY,
        largest: f64::NEG_INFINITY,
        at: Meeting::Corner(0),
        negative: false,
        positive: false,
        bound: [f64::INFINITY, f64::NEG_INFINITY],
        worst: 0.0,
    };
    each_gap(scene, f, g, of_f, of_g, |gap, at| range.add(gap, at));
    range
}

/// Calls `add` with the rounded gap at each corner of the common shadow, a bound on its error, and the features that
/// meet there.
pub(super) fn each_gap(
    scene: &PairFrame,
    f: &Facet,
    g: &Facet,
    of_f: &Turns,
    of_g: &Turns,
    mut add: impl FnMut((f64, f64), Meeting),
) {
    for k in 0..3 {
        if of_g.contains_corner(k) {
            add(g.height_above(f.corners[k].at), Meeting::Corner(k as u8));
        }
        if of_f.contains_corner(k) {
            let (height, error) = f.height_above(g.corners[k].at);
            add((-height, error), Meeting::Under(k as u8));
        }
    }
    for k in 0..3 {
        for j in 0..3 {
            if sides_cross(of_f, of_g, [k, j]) {
                let gap = crossing_gap(scene, [f, g], [k, j], of_f, of_g);
                add(gap, Meeting::Sides(k as u8, j as u8));
            }
        }
    }
}

/// Computes the gap where side `k` of `f` crosses side `j` of `g`, and a bound on its error.
pub(super) fn crossing_gap(
    scene: &PairFrame,
    [f, g]: [&Facet; 2],
    [k, j]: [usize; 2],
    of_f: &Turns,
    of_g: &Turns,
) -> (f64, f64) {
    let next = |k: usize| (k + 1) % 3;
    let (r, s) = (of_f.0[k][j], of_f.0[k][next(j)]);
    let (p, q) = (of_g.0[j][k], of_g.0[j][next(k)]);
    let ([a, b], [c, e]) = (f.side_ends(k).map(|c| c.at), g.side_ends(j).map(|c| c.at));
    let (across, back) = (p.value - q.value, r.value - s.value);
    let gap = c.z + (e.z - c.z) * (r.value / back) - a.z - (b.z - a.z) * (p.value / across);
    // Error of a height caused by the uncertain position of the crossing along a side.
    let slide = |width: f64, x: Turn, y: Turn, rise: f64| {
        let share = (x.error + y.error) / width.abs();
        if share < 0.25 { 2.0 * share * rise.abs() } else { f64::INFINITY }
    };
    let error = 8.0 * scene.noise + slide(across, p, q, b.z - a.z) + slide(back, r, s, e.z - c.z);
    if gap.is_finite() && error.is_finite() { (gap, error) } else { (0.0, f64::INFINITY) }
}
