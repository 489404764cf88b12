//! Threads, found from two parts of which one is screwed into the other.
//!
//! Notation: about an axis, `r` is a point's distance from it and `z` its place along it. The *hole* is as wide as the part
//! around it comes near the axis, over the length that both parts have in common; the *crest* is as far as the vertices of
//! the screw reach there, heads aside. They interlock: the hole is narrower than the crest. In a turn the crest climbs by
//! the *pitch* `P`, which is positive of a right-handed thread (module `helix`).
//!
//! The *core* of the screw is the same surface with all vertices from the hole to the crest moved inwards, to the hole: on a
//! thread `r` is a function of angle and `z`, so it stays a surface, and what of it is not thread stays where it is.

mod helix;
mod seat;
mod surface;

use colltrans::Solid;
use glam::{DVec2, DVec3};

use crate::boxes::span;
use crate::{cylinders, inertia};

pub use seat::Seat;
use surface::About;

/// A crest is no wider than this many holes: of M1.6 it is 1.31 times as wide, and a head wider.
const WIDEST: f64 = 1.35;
/// Nor less than this: a press fit is no thread.
const LEAST: f64 = 1.02;
/// The ends of the common length that are not looked at, as a share of it: chamfers, and bottoms of holes.
const ENDS: f64 = 0.05;
/// So many vertices make a crest.
const FEWEST: usize = 12;
/// What is moved to the hole stops short of it by this share.
const SHORT: f64 = 1e-6;
/// Rows in which a solid is seen to be round.
const ROUND_ROWS: usize = 24;
/// Beyond the crest, as it was measured about an axis that was found, by this share of it: heads begin farther out.
const OVER: f64 = 0.01;

/// A thread of two parts.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Thread {
    /// Which of the two is the screw.
    pub screw: usize,
    /// A point on the axis, and its direction, of length 1.
    pub axis: [DVec3; 2],
    /// The radius of the hole, and of the crest.
    pub radii: [f64; 2],
    /// How long both parts are together, along the axis.
    pub length: f64,
    /// How far the crest climbs in a turn; negative if it is left-handed. `None` if no helix is seen.
    pub pitch: Option<f64>,
}

impl Thread {
    /// The thread of two parts, if they look like one; of several axes one about which there is a helix.
    pub fn of(parts: [&Solid; 2]) -> Option<Self> {
        let mut all: Vec<Self> = rounds(parts).filter_map(|round| round.thread(parts)).collect();
        // About any other axis the hole is narrower and the crest wider.
        all.sort_by(|a, b| b.tightness().total_cmp(&a.tightness()));
        all.iter().find(|thread| thread.pitch.is_some()).or(all.first()).copied()
    }

    fn tightness(&self) -> f64 {
        self.radii[0] / self.radii[1]
    }

    /// Whether the other part is on all sides of the screw, as near as its crest; a wheel that a worm drives is not.
    pub(crate) fn is_surrounded(&self, other: &Solid) -> bool {
        let [point, axis] = self.axis;
        let flat = flattened(axis);
        let middle = flat(point);
        let mut sides = [false; 4];
        for t in other.triangles() {
            let corners = t.map(|v| flat(other.vertices()[v as usize]));
            if distance(middle, corners) <= self.radii[1] {
                for out in corners.map(|corner| corner - middle) {
                    sides[usize::from(out.x < 0.0) + 2 * usize::from(out.y < 0.0)] = true;
                }
            }
        }
        sides == [true; 4]
    }

    /// The screw with its thread moved inwards; `None` if that is no surface of a solid.
    pub fn core(&self, screw: &Solid) -> Option<Solid> {
        let [point, axis] = self.axis;
        let [hole, crest] = self.radii;
        let inwards = |p: &DVec3| {
            let along = (*p - point).dot(axis);
            let foot = point + axis * along;
            let out = *p - foot;
            let r = out.length();
            if r > hole * (1.0 - SHORT) && r <= crest * (1.0 + OVER) {
                foot + out * (hole * (1.0 - SHORT) / r)
            } else {
                *p
            }
        };
        let vertices: Vec<DVec3> = screw.vertices().iter().map(inwards).collect();
        let faces: Vec<Vec<u32>> = screw.triangles().iter().map(|t| t.to_vec()).collect();
        Solid::from_mesh(&vertices, &faces).ok()
    }
}

/// One part around another, all along their common length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Round {
    /// Which of the two is within the other.
    inner: usize,
    axis: [DVec3; 2],
    /// The hole's facets, its vertices, and the vertices of what is in it.
    radii: [f64; 3],
    length: f64,
}

impl Round {
    /// One part around another one that overlaps it by less than a thread would; of several axes the one with the longest
    /// contact.
    pub fn of(parts: [&Solid; 2]) -> Option<Self> {
        let all = rounds(parts).filter(|round| round.radii[2] < LEAST * round.radii[0]);
        all.max_by(|a, b| (a.length / a.radii[0]).total_cmp(&(b.length / b.radii[0])))
    }

    /// The radius of what is within.
    pub const fn radius(&self) -> f64 {
        self.radii[2]
    }

    /// By how much vertices of the inner part lie farther out than those of the outer one.
    pub fn interference(&self) -> f64 {
        self.radii[2] - self.radii[1]
    }

    /// About one direction, through the middle of what is within, if the one part lies around the other there and overlaps it.
    fn about(parts: [&Solid; 2], inner: usize, axis: DVec3) -> Option<Self> {
        let own = parts[inner];
        let [low, high] = common(own, parts[1 - inner], axis)?;
        let seen = seen(own, axis, [low, high]);
        let few = seen.iter().copied().reduce(DVec2::min)?;
        let most = seen.into_iter().reduce(DVec2::max)?;
        Self::around(parts, inner, [axis * low + inverse(axis, (few + most) * 0.5), axis])
    }

    /// The same about an axis through a point.
    fn around(parts: [&Solid; 2], inner: usize, [point, axis]: [DVec3; 2]) -> Option<Self> {
        let (own, other) = (parts[inner], parts[1 - inner]);
        let [low, high] = common(own, other, axis)?;
        let flat = flattened(axis);
        let (middle, seen) = (flat(point), seen(own, axis, [low, high]));
        let height = |p: DVec3| p.dot(axis);
        let meets = |corners: [DVec3; 3]| {
            let z = corners.map(height);
            z[0].max(z[1]).max(z[2]) > low && z[0].min(z[1]).min(z[2]) < high
        };
        let facets = |solid: &Solid| {
            let corners = |t: &[u32; 3]| t.map(|k| solid.vertices()[k as usize]);
            let all = solid.triangles().iter().map(corners);
            all.filter(|corners| meets(*corners)).collect::<Vec<[DVec3; 3]>>()
        };
        let near = facets(other).into_iter().map(|corners| distance(middle, corners.map(flat)));
        let hole = near.fold(f64::INFINITY, f64::min);
        let width = |p: &DVec2| p.distance(middle);
        let crest = seen.iter().map(width).filter(|r| *r <= WIDEST * hole).fold(0.0, f64::max);
        // Of what is around it the side faces the axis.
        let outwards = facets(own).into_iter().map(|[a, b, c]| {
            let (normal, out) = ((b - a).cross(c - a), flat((a + b + c) / 3.0) - middle);
            let near = out.length() <= WIDEST * hole;
            if near { flat(normal).dot(out.normalize_or_zero()) } else { 0.0 }
        });
        let outwards = outwards.sum::<f64>() > 0.0;
        let rim = other.vertices().iter().map(|p| flat(*p).distance(middle));
        let rim = rim.filter(|r| *r >= hole * (1.0 - SHORT)).fold(f64::INFINITY, f64::min);
        (hole > 0.0 && crest > hole && outwards).then_some(Self {
            inner,
            axis: [point, axis],
            radii: [hole, rim, crest],
            length: (high - low) / (1.0 - 2.0 * ENDS),
        })
    }

    /// The axis through the middles of both halves of what is within.
    fn straightened(&self, parts: [&Solid; 2]) -> Option<DVec3> {
        let (own, mut axis) = (parts[self.inner], self.axis[1]);
        for _ in 0..4 {
            let [low, high] = common(own, parts[1 - self.inner], axis)?;
            let (flat, half) = (flattened(axis), low.midpoint(high));
            let middle = flat(self.axis[0]);
            let center = |from: f64, to: f64| {
                let seen = own.vertices().iter().filter(|p| (from..to).contains(&p.dot(axis)));
                let near = seen.map(|p| flat(*p));
                let near: Vec<DVec2> =
                    near.filter(|p| p.distance(middle) <= WIDEST * self.radii[2]).collect();
                let few = near.iter().copied().reduce(DVec2::min)?;
                Some((few + near.into_iter().reduce(DVec2::max)?) * 0.5)
            };
            let shift = center(half, high)? - center(low, half)?;
            axis = (axis + inverse(axis, shift) / (high - half)).normalize();
        }
        Some(axis)
    }

    /// The thread, if the crest is wide enough for one.
    fn thread(self, parts: [&Solid; 2]) -> Option<Thread> {
        let Self { inner: screw, axis: [point, axis], radii: [hole, _, crest], length } = self;
        let (own, flat) = (parts[screw], flattened(axis));
        let [low, high] = common(own, parts[1 - screw], axis)?;
        let middle = flat(point);
        let radius = |p: DVec3| flat(p).distance(middle);
        let top = crest - 0.1 * (crest - hole);
        let is_top = |p: DVec3| {
            let z = p.dot(axis);
            z > low && z < high && radius(p) >= top && radius(p) <= WIDEST * hole
        };
        let count = own.vertices().iter().filter(|p| is_top(**p)).count();
        if crest < LEAST * hole || count < FEWEST {
            return None;
        }
        let about = About { axis, middle, range: [low, high] };
        let outer = crest * (1.0 + OVER);
        let pitch = helix::pitch(own, &about, [hole, outer]);
        let known = Thread { screw, axis: [point, axis], radii: [hole, crest], length, pitch };
        let better = pitch.and_then(|pitch| {
            let [point, axis] = helix::straightened(own, &about, pitch, outer);
            let round = Self::around(parts, screw, [point, axis])?;
            let [hole, _, crest] = round.radii;
            let about = About {
                axis,
                middle: flattened(axis)(point),
                range: common(own, parts[1 - screw], axis)?,
            };
            let pitch = Some(helix::pitch(own, &about, [hole, crest * (1.0 + OVER)])?);
            let (axis, length) = (round.axis, round.length);
            Some(Thread { screw, axis, radii: [hole, crest], length, pitch })
        });
        // Nor is an axis better about which the hole is narrower, or the crest wider.
        let better = better.filter(|better| better.tightness() > known.tightness());
        Some(better.unwrap_or(known))
    }
}

/// About all axes of two parts, either within the other.
fn rounds(parts: [&Solid; 2]) -> impl Iterator<Item = Round> {
    let found = parts.into_iter().flat_map(|part| {
        let cylinders = cylinders::axes(part).into_iter().map(|(_, axis)| axis);
        cylinders.chain(inertia::axes(part)).collect::<Vec<_>>()
    });
    let mut axes: Vec<DVec3> = Vec::new();
    for axis in found {
        if !axes.iter().any(|known| known.cross(axis).length() < 1e-3) {
            axes.push(axis);
        }
    }
    axes.into_iter().flat_map(move |axis| {
        let of = |inner| {
            let about = Round::about(parts, inner, axis);
            // Principal axes of what is threaded are a little off.
            let better = about.as_ref().and_then(|round| round.straightened(parts));
            about.into_iter().chain(better.and_then(|axis| Round::about(parts, inner, axis)))
        };
        of(0).chain(of(1)).collect::<Vec<_>>()
    })
}

/// Whether a solid looks the same however it is turned about an axis through a point, to its facets: not by more than a
/// share of its radius.
pub(crate) fn is_round(solid: &Solid, [point, axis]: [DVec3; 2], share: f64) -> bool {
    let Some([low, high]) = common(solid, solid, axis) else { return false };
    let flat = flattened(axis);
    let middle = flat(point);
    let far = solid.vertices().iter().map(|p| flat(*p).distance(middle)).fold(0.0, f64::max);
    let about = About { axis, middle, range: [low, high] };
    let rows = about.envelope(solid, far, ROUND_ROWS, f64::max);
    rows.iter().all(|row| {
        let seen = || row.iter().flatten();
        let [few, most] =
            seen().fold([f64::INFINITY, 0.0_f64], |[few, most], r| [few.min(*r), most.max(*r)]);
        seen().count() == 0 || seen().count() == row.len() && most - few <= share * far
    })
}

/// The vertices of a solid in a range along an axis, as seen along it; of a cylinder, which has vertices at its ends only, all.
fn seen(solid: &Solid, axis: DVec3, [low, high]: [f64; 2]) -> Vec<DVec2> {
    let flat = flattened(axis);
    let within = |p: &DVec3| p.dot(axis) > low && p.dot(axis) < high;
    let seen = |p: &DVec3| flat(*p);
    let all: Vec<DVec2> = solid.vertices().iter().filter(|p| within(p)).map(seen).collect();
    if all.is_empty() { solid.vertices().iter().map(seen).collect() } else { all }
}

/// Where along an axis both parts are, but for its ends.
fn common(own: &Solid, other: &Solid, axis: DVec3) -> Option<[f64; 2]> {
    let along = |solid: &Solid| span(solid.vertices().iter().map(|p| p.dot(axis)));
    let ([a, b], [c, d]) = (along(own), along(other));
    let (low, high) = (a.max(c), b.min(d));
    let end = ENDS * (high - low);
    (high > low).then_some([low + end, high - end])
}

/// A point as seen along an axis.
fn flattened(axis: DVec3) -> impl Fn(DVec3) -> DVec2 + Copy {
    let (u, v) = axis.any_orthonormal_pair();
    move |p: DVec3| DVec2::new(p.dot(u), p.dot(v))
}

/// The point across the axis that is seen there.
fn inverse(axis: DVec3, seen: DVec2) -> DVec3 {
    let (u, v) = axis.any_orthonormal_pair();
    u * seen.x + v * seen.y
}

/// How near a triangle in the plane comes to a point; 0 if the point is in it.
fn distance(point: DVec2, corners: [DVec2; 3]) -> f64 {
    let mut least = f64::INFINITY;
    let mut sides = [0.0; 3];
    for k in 0..3 {
        let (a, b) = (corners[k], corners[(k + 1) % 3]);
        let (edge, to) = (b - a, point - a);
        sides[k] = edge.perp_dot(to);
        let t = (to.dot(edge) / edge.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        least = least.min((to - edge * t).length());
    }
    let flat = (corners[1] - corners[0]).perp_dot(corners[2] - corners[0]).abs();
    let inside = sides.iter().all(|s| *s >= 0.0) || sides.iter().all(|s| *s <= 0.0);
    if inside && flat > 0.0 { 0.0 } else { least }
}

#[cfg(test)]
mod tests {
    use colltrans_testkit::shapes;

    use super::*;

    fn helical(inner: Option<f64>, outer: impl Fn(f64) -> f64, pitch: f64, turns: usize) -> Solid {
        let mesh = shapes::helical(inner, outer, pitch, turns);
        Solid::from_mesh(&mesh.vertices, &mesh.faces).unwrap()
    }

    /// A triangle of a wave, from 0 to 1 and back.
    fn wave(phase: f64) -> f64 {
        1.0 - (2.0 * phase - 1.0).abs()
    }

    #[test]
    fn screws_and_nuts_have_axis_pitch_and_hand_and_a_core_in_the_hole() {
        for pitch in [1.0, -1.25] {
            let screw = helical(None, |phase| 5.0 + 0.6 * wave(phase), pitch, 6);
            let nut = helical(Some(9.0), |phase| 5.1 + 0.6 * wave(phase), pitch, 3);
            for (order, k) in [([&screw, &nut], 0), ([&nut, &screw], 1)] {
                let thread = Thread::of(order).unwrap();
                assert_eq!(thread.screw, k);
                assert!(thread.axis[1].cross(DVec3::Z).length() < 2e-3, "{thread:?}");
                let found = thread.pitch.unwrap();
                // The hand is that seen from either end.
                assert!((found - pitch).abs() < 0.03, "{found}");
                assert!((thread.radii[0] - 5.1).abs() < 0.06 && thread.radii[1] < 5.62);
                let core = thread.core(&screw).unwrap();
                let [point, axis] = thread.axis;
                let radius = |p: &DVec3| (*p - point).reject_from(axis).length();
                let widest = core.vertices().iter().map(radius).fold(0.0, f64::max);
                assert!(widest < thread.radii[0] && core.is_closed(), "{widest} {thread:?}");
            }
        }
    }

    #[test]
    fn what_climbs_more_than_it_goes_around_is_no_thread() {
        let around = std::f64::consts::TAU * 5.6;
        for (pitch, found) in [(0.5 * around, true), (1.5 * around, false)] {
            let screw = helical(None, |phase| 5.0 + 0.6 * wave(phase), pitch, 2);
            let nut = helical(Some(9.0), |phase| 5.1 + 0.6 * wave(phase), pitch, 2);
            assert_eq!(Thread::of([&screw, &nut]).unwrap().pitch.is_some(), found, "{pitch}");
        }
    }

    #[test]
    fn pins_and_boxes_are_no_threads() {
        let pin = helical(None, |_| 5.0, 1.0, 3);
        let ring = helical(Some(9.0), |_| 4.95, 1.0, 2);
        assert!(Thread::of([&pin, &ring]).is_none(), "a press fit");
        let far = helical(None, |_| 2.0, 1.0, 3);
        assert!(Thread::of([&far, &ring]).is_none());
    }
}
