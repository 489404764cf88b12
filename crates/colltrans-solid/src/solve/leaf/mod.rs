//! Comparison of two facets: whether their pair counts, and its gap.
//!
//! - `f` is a front facet of the moving body: its shadow is counter-clockwise. `g` is a back facet of the fixed body.
//!   Its corners are listed in reverse, so that its shadow is counter-clockwise as well. A facet of an open shell is
//!   both a front and a back facet, unless it is [edge-on](super::edge_on).
//! - The interiors of the shadows overlap unless a side of one separates them. Over the common shadow the gap `h_g -
//!   h_f` is linear. Corners of the common shadow are corners of `f` under `g`, corners of `g` over `f`, and crossings
//!   of sides.
//! - The pair *counts* if the largest gap is positive, or the gap is zero over the whole common shadow.
//! - All decisions are exact. [`rounded`] gaps are used where their error bounds permit. Otherwise [`exact`] computes
//!   the sign of the gap at each corner of the common shadow, as the sign of a quotient of two determinants. [`facet`]
//!   defines facets and the orientations of their sides. [`min_gap`] computes the gaps of pairs with a minimum gap.

mod exact;
mod facet;
mod min_gap;
mod rounded;

use std::cmp::Ordering;

pub(crate) use exact::{Above, NO_GAP, over_facet, over_side};
pub(crate) use facet::{Facet, listed};
pub(crate) use min_gap::{FacetDifference, nearest_after};

use super::scene::PairFrame;
use exact::exact_range;
use facet::{Turns, may_cross, side_separates};
use rounded::{Rounded, crossing_gap, each_gap, rounded_range};

/// Maximum error, in noises, of rounded gaps that are used: `2e-10 S`.
pub(crate) const SHARP: f64 = 65_536.0;
/// Maximum error, in noises, of the rounded gap that decides. With a larger error the gap is computed exactly.
pub(crate) const FINE: f64 = 256.0;

/// The features that meet at a corner of the common shadow. Numbers are positions among the [`listed`] corners.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Meeting {
    /// A corner of the moving facet and the fixed facet.
    Corner(u8),
    /// The moving facet and a corner of the fixed one.
    Under(u8),
    /// Two sides, each given by its first corner.
    Sides(u8, u8),
    /// A corner of the moving facet and a side of the fixed one.
    OnSide(u8, u8),
    /// A side of the moving facet and a corner of the fixed one.
    UnderSide(u8, u8),
    /// Any two points whose distance equals the minimum gap.
    Near,
}

/// The range of the gap over the common shadow.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Gap {
    /// The least gap, as a length.
    pub(crate) least: f64,
    /// The largest gap, as a length.
    pub(crate) largest: f64,
    /// Signs of the least and the largest gap. They are exact, except in two cases. The sign of a rounded least gap
    /// that is not certainly positive is `Less` if it is not needed. With a minimum gap both signs are `Greater`.
    pub(crate) signs: [Ordering; 2],
    /// The features at which the gap is least.
    pub(crate) at: Meeting,
    /// Bound on the error of both values.
    pub(crate) error: f64,
}

impl Gap {
    /// Checks whether the largest gap is positive, or the gap is zero over the whole common shadow.
    pub(crate) fn counts(&self) -> bool {
        matches!(self.signs, [_, Ordering::Greater] | [Ordering::Equal, Ordering::Equal])
    }
}

/// The pairs of facets of interest.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum GapFilter {
    All,
    /// Pairs whose largest gap is not negative. The sign of the least gap is not needed.
    NotParting,
    /// Pairs whose largest and least gaps are not negative.
    NotCrossing,
}

/// Computes the gap of two facets; `None` if the interiors of their shadows are disjoint, the pair is not of interest,
/// or bounds show that the gap is not below `limit`.
pub(crate) fn facet_gap(
    scene: &PairFrame,
    f: &Facet,
    g: &Facet,
    limit: f64,
    wanted: GapFilter,
) -> Option<Gap> {
    if scene.has_min_gap() {
        return min_gap::min_gap_crossing(scene, f, g, limit, wanted);
    }
    let noise = 4.0 * scene.noise;
    let apart = |axis: usize| f.bounds.is_separated_along(&g.bounds, axis, noise);
    if apart(0) || apart(1) || g.bounds.low.z - f.bounds.high.z - noise >= limit {
        return None;
    }
    // The gap of the planes is linear. Therefore it is nowhere over the common shadow less than its least value at the
    // corners of `f`, nor than that at the corners of `g`.
    if f.least_off(g, -1.0).max(g.least_off(f, 1.0)) >= limit {
        return None;
    }
    let mut of_f = Turns::unless_apart(scene, f, g)?;
    let mut of_g = Turns::unless_apart(scene, g, f)?;
    let separated = (0..3).any(|k| !of_f.has_inner_corner(k) && side_separates(scene, f, k, g))
        || (0..3).any(|k| !of_g.has_inner_corner(k) && side_separates(scene, g, k, f));
    if separated {
        return None;
    }
    of_f.resolve_signs(scene, f, g);
    of_g.resolve_signs(scene, g, f);
    let range = rounded_range(scene, f, g, &of_f, &of_g);
    // The upper bound covers the gaps at all corners of the common shadow. If it is negative, no exact gap is needed.
    let parting = wanted != GapFilter::All && range.bound[1] < 0.0;
    if parting || wanted == GapFilter::NotCrossing && range.negative {
        return None;
    }
    match range.conclude(SHARP * scene.noise, wanted == GapFilter::NotCrossing) {
        Rounded::Known(gap) => Some(gap),
        Rounded::Beyond(least) if least >= limit => None,
        Rounded::Beyond(_) => Some(exact_range(scene, f, g, &of_f, &of_g, |_| true)),
    }
}

/// Computes the least gap of two facets whose shadows overlap, exact except for its last roundings, and its position.
/// Corners of the common shadow that rounded gaps exclude are skipped.
pub(crate) fn least_exactly(scene: &PairFrame, f: &Facet, g: &Facet) -> (f64, Meeting) {
    let (of_f, of_g) = (Turns::with_exact_signs(scene, f, g), Turns::with_exact_signs(scene, g, f));
    let mut least = f64::INFINITY;
    each_gap(scene, f, g, &of_f, &of_g, |(value, error), _| least = least.min(value + error));
    let low = |(value, error): (f64, f64)| value - error <= least;
    let mut near = [None; 15];
    let mut count = 0;
    each_gap(scene, f, g, &of_f, &of_g, |gap, at| {
        if low(gap) {
            near[count] = Some(at);
            count += 1;
        }
    });
    let is_listed = |at: Meeting| near[..count].contains(&Some(at));
    let gap = exact_range(scene, f, g, &of_f, &of_g, is_listed);
    (gap.least, gap.at)
}

/// Computes the gap of two facets whose shadows overlap, exact except for its last roundings.
pub(crate) fn exact_facet_gap(scene: &PairFrame, f: &Facet, g: &Facet) -> Gap {
    let (of_f, of_g) = (Turns::with_exact_signs(scene, f, g), Turns::with_exact_signs(scene, g, f));
    exact_range(scene, f, g, &of_f, &of_g, |_| true)
}

/// A facet of the moving body that faces along the direction, and a facet of the fixed body that faces against it.
pub(crate) struct Opposed {
    f: Facet,
    g: Facet,
}

impl Opposed {
    /// Builds the pair of two triangles; `None` if they do not face each other.
    pub(crate) fn new(scene: &PairFrame, [moving, fixed]: [u32; 2]) -> Option<Self> {
        let f = Facet::facing(scene, true, moving as usize, Ordering::Greater)?;
        let g = Facet::facing(scene, false, fixed as usize, Ordering::Less)?;
        Some(Self { f, g })
    }

    /// Computes the least gap and its error if the facets certainly block each other. Returns `None` also if only large
    /// integers could decide this, because they would take longer than a search.
    pub(crate) fn least_gap(&self, scene: &PairFrame) -> Option<(f64, f64)> {
        let Self { f, g } = self;
        if scene.has_min_gap() {
            let gap = min_gap::min_gap_crossing(scene, f, g, f64::INFINITY, GapFilter::All)?;
            return Some((gap.least, gap.error));
        }
        let mut of_f = Turns::unless_apart(scene, f, g)?;
        let mut of_g = Turns::unless_apart(scene, g, f)?;
        if scene.is_aligned() {
            // Exact coordinates give exact signs without extra cost.
            of_f.resolve_signs(scene, f, g);
            of_g.resolve_signs(scene, g, f);
            let separated =
                (0..3).any(|k| side_separates(scene, f, k, g) || side_separates(scene, g, k, f));
            if separated {
                return None;
            }
        } else if !of_f.are_certain() || !of_g.are_certain() {
            return None;
        }
        match rounded_range(scene, f, g, &of_f, &of_g).conclude(SHARP * scene.noise, false) {
            Rounded::Known(gap) if !gap.counts() => None,
            Rounded::Known(gap) if gap.error <= FINE * scene.noise => Some((gap.least, gap.error)),
            // For slivers.
            Rounded::Known(_) => Some((least_exactly(scene, f, g).0, 0.0)),
            Rounded::Beyond(_) => None,
        }
    }

    /// Returns a lower bound of the gap in all cases that rounding errors leave open; infinity if the interiors of the
    /// shadows certainly do not overlap.
    pub(crate) fn least_in_doubt(&self, scene: &PairFrame) -> f64 {
        let Self { f, g } = self;
        let of_f = Turns::unless_apart(scene, f, g);
        let of_g = Turns::unless_apart(scene, g, f);
        let (Some(of_f), Some(of_g)) = (of_f, of_g) else { return f64::INFINITY };
        // The gap of the planes is linear. Therefore it is nowhere over the common shadow less than its least value at
        // the corners of `f`, nor than that at the corners of `g`. It is least at a corner of the common shadow, which
        // is one of the possible corners.
        let anywhere = f.least_off(g, -1.0).max(g.least_off(f, 1.0));
        let mut least = f64::INFINITY;
        let mut add = |(value, error): (f64, f64)| least = least.min(value - error);
        for k in 0..3 {
            if of_g.may_contain_corner(k) {
                add(g.height_above(f.corners[k].at));
            }
            if of_f.may_contain_corner(k) {
                let (height, error) = f.height_above(g.corners[k].at);
                add((-height, error));
            }
            for j in (0..3).filter(|&j| may_cross(&of_f, &of_g, [k, j])) {
                add(crossing_gap(scene, [f, g], [k, j], &of_f, &of_g));
            }
        }
        least.max(anywhere)
    }

    /// Computes the gap, exact except for its last roundings; `None` if the pair is not wanted.
    pub(crate) fn exact_gap(&self, scene: &PairFrame, wanted: GapFilter) -> Option<Gap> {
        let found = facet_gap(scene, &self.f, &self.g, f64::INFINITY, wanted)?;
        // Errors of 0 are exact already. Gaps of pairs with a minimum gap are sharp.
        let sharp = found.error == 0.0 || found.at == Meeting::Near;
        Some(if sharp { found } else { exact_facet_gap(scene, &self.f, &self.g) })
    }
}

#[cfg(test)]
mod tests {
    use glam::{DQuat, DVec3};
    use proptest::prelude::*;

    use super::super::search::{Aim, exact_gap};
    use super::*;
    use crate::body::Solid;
    use crate::{SolidCast, SolidScene};
    use colltrans_convex::body::Pose;
    use colltrans_convex::cast::Cast;

    fn any_point() -> impl Strategy<Value = DVec3> {
        (-2_i8..=2, -2_i8..=2, -2_i8..=2)
            .prop_map(|(x, y, z)| DVec3::from([x, y, z].map(f64::from)))
    }

    fn any_triangle() -> impl Strategy<Value = Solid> {
        [any_point(), any_point(), any_point()].prop_filter_map("no area", |corners| {
            Solid::from_open_mesh(&corners, &[[0, 1, 2]]).ok()
        })
    }

    fn any_rotation() -> impl Strategy<Value = DQuat> {
        let turned = [-1.0..1.0_f64, -1.0..1.0, -1.0..1.0, 0.25..1.0];
        let turned = turned.prop_map(|q| DQuat::from_array(q).normalize());
        prop_oneof![Just(DQuat::IDENTITY), turned]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(4_000))]

        /// Corners over corners and sides over sides: in rotated poses rounding hides their order.
        #[test]
        fn no_gap_is_less_than_the_least_possible_one(
            a in any_triangle(), b in any_triangle(), q in any_rotation(), d in any_point(), t in any_point(),
        ) {
            prop_assume!(d != DVec3::ZERO);
            let turned = |t| Pose::new(q, q * t).expect("a rotation");
            let cast = Cast::new(a.at(turned(DVec3::ZERO)), b.at(turned(t)), q * d).expect("a query");
            let cast = cast.with_tolerance(0.0).expect("a tolerance");
            let scene = cast.query_scene();
            let f = Facet::facing(&scene, true, 0, Ordering::Greater);
            let g = Facet::facing(&scene, false, 0, Ordering::Less);
            if let (Some(f), Some(g)) = (f, g)
                && facet_gap(&scene, &f, &g, f64::INFINITY, GapFilter::All).is_some()
            {
                let least = exact_facet_gap(&scene, &f, &g).least;
                let opposed = Opposed::new(&scene, [0, 0]).expect("the facets face each other");
                let possible = opposed.least_in_doubt(&scene);
                prop_assert!(possible <= least + scene.noise, "{possible}, but {least}");
                if let Some((exact, _)) = exact_gap(&scene, Aim::Stop, [0, 0]) {
                    prop_assert_eq!(exact, least);
                }
            }
        }
    }
}
