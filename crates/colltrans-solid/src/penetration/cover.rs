//! Lower bound of the depth from several pairs of boxes inside both bodies.
//!
//! - After a translation in the open *difference box* of boxes `C` and `D`, the bodies overlap, because `C` and `D` do.
//!   Therefore the depth is at least the distance of the nearest point that no known difference box contains.
//! - At this point either the bodies are separated, and the depth is known. Or boxes inside both bodies are found after
//!   this translation, and their difference box contains the point.
//! - The planes of all boxes divide space into open boxes, rectangles, segments and points, each of which is within or
//!   outside of each difference box. The points outside of all are a closed set, so the nearest one lies in the closure
//!   of the nearest part.

use glam::DVec3;

use super::ROUNDING;
use super::depth::Shortest;
use super::inner::{InnerPair, find_boxes};
use crate::pair::pair_scene;
use colltrans_convex::body::Aabb;

/// Maximum number of difference boxes.
const MAX_BOXES: usize = 24;
/// Maximum number of points at which balls are computed for a box.
const MAX_CENTERS: u32 = 96;
/// Relative difference from the upper bound at which the search ends.
const ACCURACY: f64 = 1e-9;
/// Distance by which a difference box is smaller than computed, in noises.
const MARGIN: f64 = 4.0;

/// A box in the moving body and one in the fixed body, both in the world.
pub(super) type BoxPair = [Aabb; 2];

/// Computes a lower bound of the depth from boxes inside both bodies, and returns these boxes. Shortens the upper bound
/// where the bodies turn out to be separated.
pub(super) fn cover_bound(shortest: &mut Shortest, first: &InnerPair) -> (f64, Vec<BoxPair>) {
    let (mut pairs, mut boxes, noise) = (Vec::new(), Vec::new(), shortest.noise);
    let mut add = |pair: Option<BoxPair>, beyond: Option<DVec3>, boxes: &mut Vec<Aabb>| {
        let Some(pair) = pair else { return };
        let Some(bounds) = difference_box(&pair, noise) else { return };
        if boxes.len() < MAX_BOXES && beyond.is_none_or(|point| contains(&bounds, point)) {
            boxes.push(bounds);
            pairs.push(pair);
        }
    };
    add(boxes_before(first, DVec3::ZERO), None, &mut boxes);
    let mut lower = 0.0_f64;
    while boxes.len() < MAX_BOXES {
        let nearest = nearest_outside(&boxes);
        let distance = nearest.length() * (1.0 - ROUNDING);
        lower = lower.max(distance);
        if distance >= shortest.length * (1.0 - ACCURACY)
            || shortest.accept_near(nearest, nearest.normalize_or_zero())
        {
            break;
        }
        let Some(displaced) = shortest.displaced(nearest) else { break };
        let Ok(scene) = pair_scene(&displaced) else { break };
        let by = displaced.bodies.translations[0] - shortest.pair.bodies.translations[0];
        let before = boxes.len();
        for inner in find_boxes(&displaced, &scene, shortest.length, MAX_CENTERS) {
            add(boxes_before(&inner, by), Some(nearest), &mut boxes);
        }
        if boxes.len() == before {
            break;
        }
    }
    (lower, pairs)
}

/// Returns boxes that are inside both bodies after a translation of the moving one, at their places before it.
fn boxes_before(inner: &InnerPair, by: DVec3) -> Option<BoxPair> {
    let InnerPair::Boxes { moving, fixed } = *inner else { return None };
    Some([Aabb { low: moving.low - by, high: moving.high - by }, fixed])
}

/// Returns the open box of translations after which two boxes overlap.
fn difference_box([moving, fixed]: &BoxPair, noise: f64) -> Option<Aabb> {
    let bounds = Aabb { low: fixed.low - moving.high, high: fixed.high - moving.low };
    let bounds = bounds.expanded(-MARGIN * noise);
    bounds.low.cmplt(bounds.high).all().then_some(bounds)
}

/// Checks whether an open box contains a point.
fn contains(bounds: &Aabb, point: DVec3) -> bool {
    bounds.low.cmplt(point).all() && point.cmplt(bounds.high).all()
}

/// Returns the point that is nearest to the origin among those that none of some open boxes contains.
pub(super) fn nearest_outside(boxes: &[Aabb]) -> DVec3 {
    if boxes.is_empty() {
        return DVec3::ZERO;
    }
    // The parts of an axis, with the coordinate nearest to 0 of their closures, the nearest first.
    let parts = [0, 1, 2].map(|axis| {
        let mut planes: Vec<f64> =
            boxes.iter().flat_map(|bounds| [bounds.low[axis], bounds.high[axis]]).collect();
        planes.sort_by(f64::total_cmp);
        planes.dedup();
        let ends = [[f64::NEG_INFINITY, planes[0]], [planes[planes.len() - 1], f64::INFINITY]];
        let points = planes.iter().map(|plane| [*plane; 2]);
        let between = planes.windows(2).map(|pair| [pair[0], pair[1]]);
        let all = points.chain(between).chain(ends);
        let mut parts: Vec<(f64, [f64; 2])> =
            all.map(|[low, high]| (0.0_f64.clamp(low, high), [low, high])).collect();
        parts.sort_by(|f, g| f.0.abs().total_cmp(&g.0.abs()));
        parts
    });
    let is_outside = |part: [[f64; 2]; 3]| {
        !boxes.iter().any(|bounds| {
            (0..3).all(|k| {
                let ([low, high], [from, to]) = (part[k], [bounds.low[k], bounds.high[k]]);
                if low == high { from < low && low < to } else { from <= low && high <= to }
            })
        })
    };
    let mut best = (f64::INFINITY, DVec3::ZERO);
    for &(x, first) in &parts[0] {
        for &(y, second) in &parts[1] {
            for &(z, third) in &parts[2] {
                let point = DVec3::new(x, y, z);
                let square = point.length_squared();
                if square >= best.0 {
                    break;
                }
                if is_outside([first, second, third]) {
                    best = (square, point);
                }
            }
        }
    }
    best.1
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube(low: [f64; 3], high: [f64; 3]) -> Aabb {
        Aabb { low: DVec3::from_array(low), high: DVec3::from_array(high) }
    }

    #[test]
    fn nearest_point_outside_of_boxes_is_in_no_box() {
        let one = cube([-1.0, -2.0, -3.0], [4.0, 2.0, 3.0]);
        assert_eq!(nearest_outside(&[one]), DVec3::new(-1.0, 0.0, 0.0));
        // Open boxes with a common side leave it.
        let beside = cube([-5.0, -2.0, -3.0], [-1.0, 2.0, 3.0]);
        assert_eq!(nearest_outside(&[one, beside]), DVec3::new(-1.0, 0.0, 0.0));
        let across = cube([-5.0, -1.5, -0.5], [0.0, 1.0, 3.0]);
        assert_eq!(nearest_outside(&[one, across]), DVec3::new(-1.0, 0.0, -0.5));
        assert_eq!(nearest_outside(&[across]), DVec3::ZERO);
        assert_eq!(nearest_outside(&[]), DVec3::ZERO);
    }
}
