//! Which parts touch which, and where (*liaisons*).
//!
//! Two facets are in contact if their normals are nearly opposite, and somewhere over the common
//! shadow, seen along the first one's normal, they lie within `reach` of each other. Curved fits are
//! tessellated differently on either side: hence "nearly", and a reach of the tolerance.
//!
//! An area is the sum of what has been clipped, and its rounding is bounded (`shadow_rounding`). Which
//! facets are in contact, at 25 degrees and at `reach`, is decided as it is computed.
//! Notation: `n` is the unit normal of the first part's facet, outwards: from the first part to the
//! second.

use colltrans::Solid;
use glam::{DVec2, DVec3};
use rayon::prelude::*;

use crate::bodies::Bodies;
use crate::boxes::BoxTree;
use crate::error::AssemblyError;
use crate::watch::{Stage, Watch};
use colltrans::Aabb;

/// Normals farther from opposite than this are no contact: the cosine of 25 degrees, a step of a
/// round of 14 sides.
const OPPOSITE: f64 = 0.906;

/// Two facets in contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Patch {
    /// Unit normal of the first part's facet, from the first part to the second.
    pub normal: DVec3,
    /// Unit normal of the second part's facet, turned round: from the first part to the second.
    pub other: DVec3,
    /// Area of the common shadow, seen along the normal.
    pub area: f64,
    /// The area is off by no more than this.
    pub area_error: f64,
    /// Its centre, in the world, rounded.
    pub center: DVec3,
}

/// Two parts that touch.
#[derive(Debug, Clone, PartialEq)]
pub struct Liaison {
    /// Positions of the parts, the smaller first.
    pub parts: [usize; 2],
    /// Where.
    pub patches: Vec<Patch>,
}

impl Liaison {
    /// The area of contact.
    pub fn area(&self) -> f64 {
        self.patches.iter().map(|p| p.area).sum()
    }

    /// At least and at most the area of contact, exactly, of these patches.
    pub fn area_bounds(&self) -> [f64; 2] {
        let (area, most) = (self.area(), self.patches.len() as f64);
        let error: f64 = self.patches.iter().map(|p| p.area_error).sum();
        let error = 1.01 * (error + most * f64::EPSILON * area);
        [(area - error).next_down().max(0.0), (area + error).next_up()]
    }

    /// The middle of the contact, weighted by area.
    pub fn center(&self) -> DVec3 {
        let sum: DVec3 = self.patches.iter().map(|p| p.center * p.area).sum();
        sum / self.area()
    }
}

/// How far apart surfaces may be that touch: the tolerance, or the default one if that is larger.
pub fn reach(bodies: &Bodies) -> f64 {
    bodies.fit().tolerance().max(crate::Fit::digits(bodies.assembly()))
}

/// All pairs that touch, as the files have them.
///
/// # Errors
/// Cancelled; too many parts lie within each other's boxes.
pub fn liaisons(bodies: &Bodies, watch: Watch) -> Result<Vec<Liaison>, AssemblyError> {
    let reach = reach(bodies);
    let pairs = bodies.neighbours(reach)?;
    let tally = watch.stage(Stage::Liaisons, pairs.len());
    let parts = bodies.assembly().parts();
    let look = |&[a, b]: &[usize; 2]| {
        let patches = contacts(parts[a].solid(), parts[b].solid(), reach);
        let found = (!patches.is_empty()).then_some(Liaison { parts: [a, b], patches });
        tally.step().map(|()| found)
    };
    let found: Result<Vec<Option<Liaison>>, AssemblyError> = pairs.par_iter().map(look).collect();
    Ok(found?.into_iter().flatten().collect())
}

type Triangle = [DVec3; 3];

fn triangles_in(solid: &Solid, region: &Aabb) -> Vec<Triangle> {
    let corner = |v: u32| solid.vertices()[v as usize];
    let all = solid.triangles().iter().map(|t| t.map(corner));
    all.filter(|t| Aabb::of_points(*t).meets(region)).collect()
}

fn contacts(a: &Solid, b: &Solid, reach: f64) -> Vec<Patch> {
    touching(a, b, reach).map(|(first, second, t)| t.patch(&first, &second)).collect()
}

/// Corners of where a part touches another one with facets that look along `down`, within [`OPPOSITE`].
pub(crate) fn footprint(a: &Solid, b: &Solid, reach: f64, down: DVec3) -> Vec<DVec3> {
    let below = touching(a, b, reach).filter(|(_, _, t)| t.normal.dot(down) >= OPPOSITE);
    below.flat_map(|(_, _, t)| t.outline()).collect()
}

/// All pairs of facets in contact.
fn touching(
    a: &Solid,
    b: &Solid,
    reach: f64,
) -> impl Iterator<Item = (Triangle, Triangle, Touching)> {
    let (p, q) = (a.bounds().grown(reach), b.bounds().grown(reach));
    let region = Aabb { low: p.low.max(q.low), high: p.high.min(q.high) };
    let (first, second) = (triangles_in(a, &region), triangles_in(b, &region));
    let tree = BoxTree::new(second.iter().map(|t| Aabb::of_points(*t)));
    first.into_iter().flat_map(move |t| {
        let near = tree.meeting(&Aabb::of_points(t).grown(reach)).into_iter();
        let found = near.filter_map(|k| Some((t, second[k], Touching::of(&t, &second[k], reach)?)));
        found.collect::<Vec<_>>()
    })
}

/// Two facets in contact: the common shadow, seen along the first one's normal.
struct Touching {
    normal: DVec3,
    other: DVec3,
    origin: DVec3,
    axes: [DVec3; 2],
    shadow: Vec<DVec2>,
    area: f64,
    middle: DVec2,
}

impl Touching {
    fn of(first: &Triangle, second: &Triangle, reach: f64) -> Option<Self> {
        let normal = |t: &Triangle| (t[1] - t[0]).cross(t[2] - t[0]).try_normalize();
        let (n, m) = (normal(first)?, normal(second)?);
        if -n.dot(m) < OPPOSITE {
            return None;
        }
        let u = (first[1] - first[0]).try_normalize()?;
        let v = n.cross(u);
        let flat = |p: DVec3| DVec2::new((p - first[0]).dot(u), (p - first[0]).dot(v));
        // The second runs clockwise, as seen along the first one's normal.
        let mut shadow: Vec<DVec2> = [second[0], second[2], second[1]].map(flat).to_vec();
        let corners = first.map(flat);
        for k in 0..3 {
            shadow = clipped(&shadow, corners[k], corners[(k + 1) % 3]);
        }
        let (area, middle) = centroid(&shadow)?;
        let largest = (corners[1] - corners[0]).perp_dot(corners[2] - corners[0]).abs();
        if area <= largest * 1e-9 {
            return None;
        }
        // Height of the second facet's plane over the first one's.
        let height = |s: DVec2| {
            let foot = first[0] + u * s.x + v * s.y;
            (second[0] - foot).dot(m) / n.dot(m)
        };
        let heights = shadow.iter().map(|s| height(*s));
        let (low, high) =
            heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
        let (origin, axes) = (first[0], [u, v]);
        (low <= reach && high >= -reach).then_some(Self {
            normal: n,
            other: -m,
            origin,
            axes,
            shadow,
            area,
            middle,
        })
    }

    fn place(&self, seen: DVec2) -> DVec3 {
        self.origin + self.axes[0] * seen.x + self.axes[1] * seen.y
    }

    fn outline(&self) -> Vec<DVec3> {
        self.shadow.iter().map(|seen| self.place(*seen)).collect()
    }

    fn patch(&self, first: &Triangle, second: &Triangle) -> Patch {
        let area_error = shadow_rounding(first, second);
        let center = self.place(self.middle);
        let Self { normal, other, area, .. } = *self;
        Patch { normal, other, area, area_error, center }
    }
}

/// How far the area of the common shadow of two triangles may be off.
///
/// Let `D` be how far a corner is from the first one, `s` the inverse sine of the first triangle's angle
/// there, and `P` both perimeters. The normal is off by `8 u s` and the other two axes by that and `4 u`, so
/// flat coordinates by `32 u D (1 + s)`: that far off are the corners of both shadows, and, by the rounding
/// of `side` over the length of the line, each of the three cuts. A convex shape all of whose boundary
/// lies within `h` of another's has an area that differs by no more than `h` times the perimeter, to first
/// order. Five such displacements; the sum over the corners takes less than as much again.
fn shadow_rounding(first: &Triangle, second: &Triangle) -> f64 {
    const U: f64 = f64::EPSILON / 2.0;
    let perimeter = |t: &Triangle| (0..3).map(|k| t[k].distance(t[(k + 1) % 3])).sum::<f64>();
    let farthest = first.iter().chain(second).map(|p| p.distance(first[0])).fold(0.0, f64::max);
    let (e, f) = (first[1] - first[0], first[2] - first[0]);
    let inverse_sine = e.length() * f.length() / e.cross(f).length();
    let off = 32.0 * U * farthest * (1.0 + inverse_sine);
    10.0 * off * (perimeter(first) + perimeter(second))
}

/// What of a convex polygon lies to the left of a line.
fn clipped(polygon: &[DVec2], from: DVec2, to: DVec2) -> Vec<DVec2> {
    let side = |p: DVec2| (to - from).perp_dot(p - from);
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (k, &p) in polygon.iter().enumerate() {
        let q = polygon[(k + 1) % polygon.len()];
        let (x, y) = (side(p), side(q));
        if x >= 0.0 {
            kept.push(p);
        }
        if (x > 0.0 && y < 0.0) || (x < 0.0 && y > 0.0) {
            kept.push(p + (q - p) * (x / (x - y)));
        }
    }
    kept
}

/// Area and centre of a convex polygon that has an area.
fn centroid(polygon: &[DVec2]) -> Option<(f64, DVec2)> {
    let first = *polygon.first()?;
    let (mut twice, mut sum) = (0.0, DVec2::ZERO);
    for pair in polygon[1..].windows(2) {
        let area = (pair[0] - first).perp_dot(pair[1] - first);
        twice += area;
        sum += (first + pair[0] + pair[1]) * (area / 3.0);
    }
    (twice > 0.0).then(|| (twice / 2.0, sum / twice))
}

#[cfg(test)]
mod tests {
    use colltrans_testkit::oracle::exact::{Dyadic, Vector};
    use colltrans_testkit::random::Random;

    use super::*;

    fn contact(first: &Triangle, second: &Triangle, reach: f64) -> Option<Patch> {
        Touching::of(first, second, reach).map(|touching| touching.patch(first, second))
    }

    /// Triangles in parallel planes that have a vector for a normal which is not a number of this kind, the
    /// second's shadow all of the first's, a part of it, or around it: areas are known in fractions.
    #[test]
    fn areas_lie_within_their_bounds() {
        let mut random = Random::new(5);
        let mut seen = [0; 3];
        for round in 0..3_000 {
            let mut vector =
                || DVec3::from_array([0; 3].map(|_| (random.unit() * 64.0).floor() - 32.0));
            let (e, mut f, far) = (vector(), vector(), vector() * 64.0);
            if round % 3 == 0 {
                // Slivers.
                f = e * 512.0 + f;
            }
            let (scale, shift, share) = match round % 4 {
                0 => (0.5, e * 0.25 + f * 0.25, 0.25),
                1 => (1.0, e * 0.5, 0.25),
                _ => (4.0, -(e + f), 1.0),
            };
            let first = [far, far + e, far + f];
            let second = [far, far + f, far + e].map(|p| far + (p - far) * scale + shift);
            let Some(patch) = contact(&first, &second, 1.0) else { continue };
            let both = Liaison { parts: [0, 1], patches: vec![patch] };
            let [low, high] = both.area_bounds().map(Dyadic::new);
            let normal = Vector::new(e).cross(&Vector::new(f));
            let share = Dyadic::new(share / 2.0);
            let squared = &normal.dot(&normal) * &(&share * &share);
            assert!(&low * &low <= squared && squared <= &high * &high, "{patch:?}");
            assert!(round % 3 == 0 || patch.area_error < 1e-8 * patch.area, "{patch:?}");
            seen[round % 3] += 1;
        }
        assert!(seen.iter().all(|&n| n > 700), "{seen:?}");
    }

    #[test]
    fn stacked_triangles_touch_where_they_overlap() {
        let low = [DVec3::ZERO, DVec3::new(4.0, 0.0, 0.0), DVec3::new(0.0, 4.0, 0.0)];
        let up =
            |z: f64| [DVec3::new(0.0, 0.0, z), DVec3::new(0.0, 2.0, z), DVec3::new(2.0, 0.0, z)];
        let patch = contact(&low, &up(0.01), 0.02).expect("they touch");
        assert_eq!(patch.normal, DVec3::Z);
        assert!((patch.area - 2.0).abs() < 1e-12);
        assert!((patch.center - DVec3::new(2.0 / 3.0, 2.0 / 3.0, 0.0)).length() < 1e-12);
        assert!(contact(&low, &up(0.03), 0.02).is_none());
        let beside = up(0.0).map(|p| p + DVec3::new(5.0, 0.0, 0.0));
        assert!(contact(&low, &beside, 0.02).is_none());
        let facing_away = [low[0], low[1], low[2]];
        assert!(contact(&low, &facing_away, 0.02).is_none());
    }
}
