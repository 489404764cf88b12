//! Detects threads of two parts of which one is screwed into the other.
//!
//! About an axis, `r` is the distance of a point from it and `z` its coordinate along it. Both radii are
//! measured over the range of `z` that both parts share.
//! - *Hole*: the least `r` of the facets of the outer part.
//! - *Crest*: the largest `r` of the vertices of the screw, without heads. A thread has a crest wider than
//!   the hole.
//! - *Pitch* `P`: the rise of the crest in a turn, positive for a right-handed thread (module `helix`).
//! - *Core*: the surface of the screw with all vertices between hole and crest moved inward to the hole. It
//!   remains a surface, because on a thread `r` is a function of the angle and `z`.

mod helix;
mod seat;
mod surface;

use colltrans::Solid;
use glam::{DVec2, DVec3};
use rayon::prelude::*;

use crate::boxes::value_range;
use crate::{cylinders, inertia};

pub use seat::Seat;
use surface::AxisFrame;

/// Maximum ratio of crest and hole. M1.6 has 1.31, and heads are wider.
const MAX_CREST_RATIO: f64 = 1.35;
/// Minimum ratio of crest and hole, which excludes press fits.
const MIN_CREST_RATIO: f64 = 1.02;
/// Share of the common length that is left out at each end, because of chamfers and bottoms of holes.
const END_SHARE: f64 = 0.05;
/// Minimum number of vertices of a crest.
const MIN_CREST_VERTICES: usize = 12;
/// Relative distance from the hole to which the core is moved.
const CORE_MARGIN: f64 = 1e-6;
/// Number of rows in which a solid is checked for rotational symmetry.
const ROUND_ROWS: usize = 24;
/// Relative margin beyond the measured crest. Heads begin farther out.
const CREST_MARGIN: f64 = 0.01;

/// The thread of two parts.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Thread {
    /// Which of the two parts is the screw: 0 or 1.
    pub screw: usize,
    /// A point on the axis, and the unit direction of the axis.
    pub axis: [DVec3; 2],
    /// Radii of the hole and of the crest.
    pub radii: [f64; 2],
    /// Length of the range along the axis that both parts share.
    pub length: f64,
    /// Rise of the crest in a turn, negative for a left-handed thread; `None` if no helix is detected.
    pub pitch: Option<f64>,
}

/// Sine up to which two directions are searched as one.
const SAME_DIRECTION: f64 = 1e-3;
/// Sine up to which a refined axis is the same.
const SAME_AXIS: f64 = 1e-6;

impl Thread {
    /// Detects the thread of two parts; `None` if they do not form one. Of several axes, prefers one with a
    /// helix, then the one with the largest ratio of hole and crest.
    pub fn detect(parts: [&Solid; 2]) -> Option<Self> {
        RoundContacts::find(parts, &parts.map(round_axes).concat()).thread()
    }

    /// Returns the best of some threads.
    fn best(mut all: Vec<Self>) -> Option<Self> {
        // About any other axis, the hole is narrower and the crest wider.
        all.sort_by(|a, b| b.radius_ratio().total_cmp(&a.radius_ratio()));
        all.iter().find(|thread| thread.pitch.is_some()).or(all.first()).copied()
    }

    /// Returns the ratio of hole and crest.
    fn radius_ratio(&self) -> f64 {
        self.radii[0] / self.radii[1]
    }

    /// Checks whether the other part surrounds the screw.
    pub(crate) fn is_surrounded(&self, other: &Solid) -> bool {
        surrounds(other, self.axis, self.radii[1])
    }

    /// Returns the screw with its thread moved inward to the hole; `None` if the result is not the surface of
    /// a solid.
    pub fn thread_core(&self, screw: &Solid) -> Option<Solid> {
        let [point, axis] = self.axis;
        let [hole, crest] = self.radii;
        let inwards = |p: &DVec3| {
            let along = (*p - point).dot(axis);
            let foot = point + axis * along;
            let out = *p - foot;
            let r = out.length();
            if r > hole * (1.0 - CORE_MARGIN) && r <= crest * (1.0 + CREST_MARGIN) {
                foot + out * (hole * (1.0 - CORE_MARGIN) / r)
            } else {
                *p
            }
        };
        let vertices: Vec<DVec3> = screw.vertices().iter().map(inwards).collect();
        let faces: Vec<Vec<u32>> = screw.triangles().iter().map(|t| t.to_vec()).collect();
        Solid::from_mesh(&vertices, &faces).ok()
    }
}

/// One part around another one, over their common length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RoundContact {
    /// Which of the two parts is the inner one: 0 or 1.
    inner: usize,
    /// A point on the axis, and the unit direction of the axis.
    axis: [DVec3; 2],
    /// Least radius of the outer part's facets, least radius of its vertices, and largest radius of the inner
    /// part's vertices.
    radii: [f64; 3],
    /// Length of the range along the axis that both parts share.
    length: f64,
}

impl RoundContact {
    /// Returns the radius of the inner part.
    pub const fn radius(&self) -> f64 {
        self.radii[2]
    }

    /// Returns how far vertices of the inner part are outside those of the outer part.
    pub fn interference(&self) -> f64 {
        self.radii[2] - self.radii[1]
    }

    /// Measures one part around another about an axis direction through the middle of the inner part; `None`
    /// if the outer part does not surround the inner one there, or does not overlap it.
    fn about_direction(parts: [&Solid; 2], inner: usize, axis: DVec3) -> Option<Self> {
        let own = parts[inner];
        let [low, high] = common_range(own, parts[1 - inner], axis)?;
        let projections = axial_projections(own, axis, [low, high]);
        let few = projections.iter().copied().reduce(DVec2::min)?;
        let most = projections.into_iter().reduce(DVec2::max)?;
        Self::about_axis(
            parts,
            inner,
            [axis * low + lateral_vector(axis, (few + most) * 0.5), axis],
        )
    }

    /// Measures one part around another about a given axis; `None` as in [`Self::about_direction`].
    fn about_axis(parts: [&Solid; 2], inner: usize, [point, axis]: [DVec3; 2]) -> Option<Self> {
        let (own, other) = (parts[inner], parts[1 - inner]);
        let [low, high] = common_range(own, other, axis)?;
        let flat = axial_projection(axis);
        let (middle, projections) = (flat(point), axial_projections(own, axis, [low, high]));
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
        let near =
            facets(other).into_iter().map(|corners| triangle_distance(middle, corners.map(flat)));
        let hole = near.fold(f64::INFINITY, f64::min);
        let width = |p: &DVec2| p.distance(middle);
        let crest = projections
            .iter()
            .map(width)
            .filter(|r| *r <= MAX_CREST_RATIO * hole)
            .fold(0.0, f64::max);
        // The inner part's facets must face away from the axis.
        let outwards = facets(own).into_iter().map(|[a, b, c]| {
            let (normal, out) = ((b - a).cross(c - a), flat((a + b + c) / 3.0) - middle);
            let near = out.length() <= MAX_CREST_RATIO * hole;
            if near { flat(normal).dot(out.normalize_or_zero()) } else { 0.0 }
        });
        let outwards = outwards.sum::<f64>() > 0.0;
        let inner_rim = other.vertices().iter().map(|p| flat(*p).distance(middle));
        let inner_rim =
            inner_rim.filter(|r| *r >= hole * (1.0 - CORE_MARGIN)).fold(f64::INFINITY, f64::min);
        (hole > 0.0 && crest > hole && outwards).then_some(Self {
            inner,
            axis: [point, axis],
            radii: [hole, inner_rim, crest],
            length: (high - low) / (1.0 - 2.0 * END_SHARE),
        })
    }

    /// Returns a direction of the axis through the middles of both halves of the inner part; `None` if a half
    /// has no vertices.
    fn refined_direction(&self, parts: [&Solid; 2]) -> Option<DVec3> {
        let (own, mut axis) = (parts[self.inner], self.axis[1]);
        for _ in 0..4 {
            let [low, high] = common_range(own, parts[1 - self.inner], axis)?;
            let (flat, half) = (axial_projection(axis), low.midpoint(high));
            let middle = flat(self.axis[0]);
            let center = |from: f64, to: f64| {
                let seen = own.vertices().iter().filter(|p| (from..to).contains(&p.dot(axis)));
                let near = seen.map(|p| flat(*p));
                let near: Vec<DVec2> = near
                    .filter(|p| p.distance(middle) <= MAX_CREST_RATIO * self.radii[2])
                    .collect();
                let few = near.iter().copied().reduce(DVec2::min)?;
                Some((few + near.into_iter().reduce(DVec2::max)?) * 0.5)
            };
            let shift = center(half, high)? - center(low, half)?;
            axis = (axis + lateral_vector(axis, shift) / (high - half)).normalize();
        }
        Some(axis)
    }

    /// Returns the thread; `None` if the crest is too narrow or has too few vertices.
    fn to_thread(self, parts: [&Solid; 2]) -> Option<Thread> {
        let Self { inner: screw, axis: [point, axis], radii: [hole, _, crest], length } = self;
        let (own, flat) = (parts[screw], axial_projection(axis));
        let [low, high] = common_range(own, parts[1 - screw], axis)?;
        let middle = flat(point);
        let radius = |p: DVec3| flat(p).distance(middle);
        let top = crest - 0.1 * (crest - hole);
        let is_top = |p: DVec3| {
            let z = p.dot(axis);
            z > low && z < high && radius(p) >= top && radius(p) <= MAX_CREST_RATIO * hole
        };
        let count = own.vertices().iter().filter(|p| is_top(**p)).count();
        if crest < MIN_CREST_RATIO * hole || count < MIN_CREST_VERTICES {
            return None;
        }
        let about = AxisFrame { axis, middle, range: [low, high] };
        let outer = crest * (1.0 + CREST_MARGIN);
        let pitch = helix::pitch(own, &about, [hole, outer]);
        let known = Thread { screw, axis: [point, axis], radii: [hole, crest], length, pitch };
        let better = pitch.and_then(|pitch| {
            let [point, axis] = helix::refined_axis(own, &about, pitch, outer);
            let round = Self::about_axis(parts, screw, [point, axis])?;
            let [hole, _, crest] = round.radii;
            let about = AxisFrame {
                axis,
                middle: axial_projection(axis)(point),
                range: common_range(own, parts[1 - screw], axis)?,
            };
            let pitch = Some(helix::pitch(own, &about, [hole, crest * (1.0 + CREST_MARGIN)])?);
            let (axis, length) = (round.axis, round.length);
            Some(Thread { screw, axis, radii: [hole, crest], length, pitch })
        });
        // An axis with a narrower hole or a wider crest is not better.
        let better = better.filter(|better| better.radius_ratio() > known.radius_ratio());
        Some(better.unwrap_or(known))
    }
}

/// Returns the directions of the axes about which a solid may be round: those of its cylinders and its principal axes.
pub(crate) fn round_axes(solid: &Solid) -> Vec<DVec3> {
    let cylinders = cylinders::cylinder_axes(solid).into_iter().map(|(_, axis)| axis);
    cylinders.chain(inertia::principal_axes(solid)).collect()
}

/// Checks whether a solid surrounds an axis: within a radius, it has facets with vertices in all four quadrants. This
/// excludes a wheel driven by a worm.
fn surrounds(solid: &Solid, [point, axis]: [DVec3; 2], radius: f64) -> bool {
    let flat = axial_projection(axis);
    let middle = flat(point);
    let mut sides = [false; 4];
    for t in solid.triangles() {
        let corners = t.map(|v| flat(solid.vertices()[v as usize]));
        if triangle_distance(middle, corners) <= radius {
            for out in corners.map(|corner| corner - middle) {
                sides[usize::from(out.x < 0.0) + 2 * usize::from(out.y < 0.0)] = true;
            }
        }
    }
    sides == [true; 4]
}

/// The contacts of two parts of which one surrounds the other.
pub(crate) struct RoundContacts<'a> {
    parts: [&'a Solid; 2],
    contacts: Vec<RoundContact>,
}

impl<'a> RoundContacts<'a> {
    /// Finds the contacts of two parts about some directions, the [round axes](round_axes) of both.
    pub(crate) fn find(parts: [&'a Solid; 2], axes: &[DVec3]) -> Self {
        let mut distinct: Vec<DVec3> = Vec::new();
        for axis in axes {
            if !distinct.iter().any(|known| known.cross(*axis).length() < SAME_DIRECTION) {
                distinct.push(*axis);
            }
        }
        let about = |(axis, inner): (DVec3, usize)| {
            let first = RoundContact::about_direction(parts, inner, axis);
            // The principal axes of a threaded part differ slightly from the axis of the thread.
            let better = first.as_ref().and_then(|round| round.refined_direction(parts));
            let better = better.filter(|better| better.cross(axis).length() > SAME_AXIS);
            let better = better.and_then(|axis| RoundContact::about_direction(parts, inner, axis));
            first.into_iter().chain(better)
        };
        let pairs = distinct.into_iter().flat_map(|axis| [(axis, 0), (axis, 1)]);
        Self { parts, contacts: pairs.flat_map(about).collect() }
    }

    /// Returns the thread of the parts; `None` if they do not form one.
    fn thread(&self) -> Option<Thread> {
        let to_thread = |round: &RoundContact| round.to_thread(self.parts);
        Thread::best(self.contacts.par_iter().filter_map(to_thread).collect())
    }

    /// Returns the thread of a screw that the other part surrounds, and its pitch; `None` if there is none.
    pub(crate) fn surrounded_thread(&self) -> Option<(Thread, f64)> {
        let other = |screw: usize| self.parts[1 - screw];
        let to_thread = |round: &RoundContact| {
            let crest = round.radii[2] * (1.0 + CREST_MARGIN);
            let may_be = round.radii[2] >= MIN_CREST_RATIO * round.radii[0]
                && surrounds(other(round.inner), round.axis, crest);
            let thread = may_be.then(|| round.to_thread(self.parts)).flatten()?;
            (thread.pitch.is_some() && thread.is_surrounded(other(thread.screw))).then_some(thread)
        };
        let best = Thread::best(self.contacts.par_iter().filter_map(to_thread).collect())?;
        Some((best, best.pitch?))
    }

    /// Returns one part around the other one with an overlap smaller than that of a thread; `None` if there is none. Of
    /// several axes, returns the one with the longest contact relative to the radius.
    pub(crate) fn longest(&self) -> Option<RoundContact> {
        let all = self.contacts.iter();
        let is_smaller = |round: &&RoundContact| round.radii[2] < MIN_CREST_RATIO * round.radii[0];
        let share = |round: &RoundContact| round.length / round.radii[0];
        all.filter(is_smaller).max_by(|a, b| share(a).total_cmp(&share(b))).copied()
    }
}

/// Checks whether a solid is rotationally symmetric about an axis, apart from its tessellation. The range along the
/// axis is divided into rows. In each row that has samples, the outer radius varies by at most `share` of the solid's
/// radius.
pub(crate) fn is_rotationally_symmetric(
    solid: &Solid,
    [point, axis]: [DVec3; 2],
    share: f64,
) -> bool {
    let Some([low, high]) = common_range(solid, solid, axis) else { return false };
    let flat = axial_projection(axis);
    let middle = flat(point);
    let far = solid.vertices().iter().map(|p| flat(*p).distance(middle)).fold(0.0, f64::max);
    let about = AxisFrame { axis, middle, range: [low, high] };
    let rows = about.envelope(solid, far, ROUND_ROWS, f64::max);
    rows.iter().all(|row| {
        let radii = || row.iter().flatten();
        let [few, most] =
            radii().fold([f64::INFINITY, 0.0_f64], |[few, most], r| [few.min(*r), most.max(*r)]);
        radii().count() == 0 || radii().count() == row.len() && most - few <= share * far
    })
}

/// Returns the vertices of a solid in a range along an axis, projected along it. Returns all vertices if none
/// are in the range, for example for a cylinder with vertices at its ends only.
fn axial_projections(solid: &Solid, axis: DVec3, [low, high]: [f64; 2]) -> Vec<DVec2> {
    let flat = axial_projection(axis);
    let within = |p: &DVec3| p.dot(axis) > low && p.dot(axis) < high;
    let project = |p: &DVec3| flat(*p);
    let all: Vec<DVec2> = solid.vertices().iter().filter(|p| within(p)).map(project).collect();
    if all.is_empty() { solid.vertices().iter().map(project).collect() } else { all }
}

/// Returns the range along an axis that both parts share, without its ends; `None` if there is no common
/// range.
fn common_range(own: &Solid, other: &Solid, axis: DVec3) -> Option<[f64; 2]> {
    let along = |solid: &Solid| value_range(solid.vertices().iter().map(|p| p.dot(axis)));
    let ([a, b], [c, d]) = (along(own), along(other));
    let (low, high) = (a.max(c), b.min(d));
    let end = END_SHARE * (high - low);
    (high > low).then_some([low + end, high - end])
}

/// Returns the projection along an axis.
fn axial_projection(axis: DVec3) -> impl Fn(DVec3) -> DVec2 + Copy {
    let (u, v) = axis.any_orthonormal_pair();
    move |p: DVec3| DVec2::new(p.dot(u), p.dot(v))
}

/// Returns the vector perpendicular to the axis that has this projection.
fn lateral_vector(axis: DVec3, seen: DVec2) -> DVec3 {
    let (u, v) = axis.any_orthonormal_pair();
    u * seen.x + v * seen.y
}

/// Returns the distance of a point from a triangle in the plane; 0 inside the triangle.
pub(crate) fn triangle_distance(point: DVec2, corners: [DVec2; 3]) -> f64 {
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

    /// Returns a triangle wave from 0 to 1 and back.
    fn wave(phase: f64) -> f64 {
        1.0 - (2.0 * phase - 1.0).abs()
    }

    #[test]
    fn thread_of_screw_and_nut_has_axis_pitch_hand_and_core() {
        for pitch in [1.0, -1.25] {
            let screw = helical(None, |phase| 5.0 + 0.6 * wave(phase), pitch, 6);
            let nut = helical(Some(9.0), |phase| 5.1 + 0.6 * wave(phase), pitch, 3);
            for (order, k) in [([&screw, &nut], 0), ([&nut, &screw], 1)] {
                let thread = Thread::detect(order).unwrap();
                assert_eq!(thread.screw, k);
                assert!(thread.axis[1].cross(DVec3::Z).length() < 2e-3, "{thread:?}");
                let found = thread.pitch.unwrap();
                // The hand does not depend on the end from which a thread is viewed.
                assert!((found - pitch).abs() < 0.03, "{found}");
                assert!((thread.radii[0] - 5.1).abs() < 0.06 && thread.radii[1] < 5.62);
                let core = thread.thread_core(&screw).unwrap();
                let [point, axis] = thread.axis;
                let radius = |p: &DVec3| (*p - point).reject_from(axis).length();
                let widest = core.vertices().iter().map(radius).fold(0.0, f64::max);
                assert!(widest < thread.radii[0] && core.is_closed(), "{widest} {thread:?}");
            }
        }
    }

    #[test]
    fn helix_steeper_than_45_degrees_has_no_pitch() {
        let around = std::f64::consts::TAU * 5.6;
        for (pitch, found) in [(0.5 * around, true), (1.5 * around, false)] {
            let screw = helical(None, |phase| 5.0 + 0.6 * wave(phase), pitch, 2);
            let nut = helical(Some(9.0), |phase| 5.1 + 0.6 * wave(phase), pitch, 2);
            assert_eq!(Thread::detect([&screw, &nut]).unwrap().pitch.is_some(), found, "{pitch}");
        }
    }

    #[test]
    fn pins_in_rings_are_not_threads() {
        let pin = helical(None, |_| 5.0, 1.0, 3);
        let ring = helical(Some(9.0), |_| 4.95, 1.0, 2);
        assert!(Thread::detect([&pin, &ring]).is_none(), "a press fit");
        let far = helical(None, |_| 2.0, 1.0, 3);
        assert!(Thread::detect([&far, &ring]).is_none());
    }
}
