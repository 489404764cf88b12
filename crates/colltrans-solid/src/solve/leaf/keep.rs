//! Facets that are to keep a gap.
//!
//! A body is grown by the gap, in all that a search sees of its nodes ([`Side::swell`]), and a pair of facets is the
//! cast of a point at the difference of two triangles grown by a ball ([`keep`](colltrans_convex::solve::keep)). What comes
//! nearer than the gap for the first time does so with a facet that looks along the direction, and one that looks
//! against it: at the nearest points `p`, `q` the normal `n` from one to the other has `n.d > 0`; if no facet at `p`
//! looked along `d`, `d` would lead into the body from there, and nothing of it lies beyond the plane across `n`.
//! Open shells have no side, and closed ones may have no thickness: of the first all facets are looked at, of the
//! second those on edge that others are folded back onto.
//!
//! *Grazing.* Whether facets pass each other at the gap or by rounding less, nobody can tell. Those that a plane along the
//! direction shows to stay so near to it, up to [`GRAZE`] noises less, do not block, nor do those that are so near at
//! the start and do not come nearer. A gap of no more noises is none.

use glam::DVec3;

use super::super::nearest::triangle::{self, Corners};
use super::super::scene::{Corner, Scene};
use super::{Facet, Gap, Meeting, Wanted};
use colltrans_convex::solve::keep::{Line, Look, Plane, Target, Travel, shadow, travel};
use colltrans_kernel::noise::UNIT_VECTOR;

/// How far below the gap, in noises, facets may pass each other.
const GRAZE: f64 = 8.0;

/// Looks for a point that is near enough where none was found on the way.
const MOST_DEEPER: usize = 8;

/// The difference of two triangles in the setting frame.
pub(crate) struct Facets {
    moving: Corners,
    fixed: Corners,
    noise: f64,
}

impl Facets {
    pub(crate) fn new(scene: &Scene, f: &[Corner; 3], g: &[Corner; 3]) -> Self {
        let placed = |corners: &[Corner; 3]| corners.each_ref().map(|c| scene.place(c));
        Self { moving: placed(f), fixed: placed(g), noise: scene.noise }
    }

    /// Along the direction of a scene, or against it.
    fn line(scene: &Scene, sign: f64) -> Line {
        let unit = scene.setting.direction / scene.setting.length * sign;
        Line::new(unit, scene.keep, scene.size() - scene.keep)
    }

    fn plane(&self, normal: DVec3) -> Plane<()> {
        let height = triangle::gap(&self.moving, &self.fixed, normal) - self.noise;
        Plane { normal, height, beyond: 0.0, support: () }
    }

    /// Whether they are nearer than a gap for certain, or as near with `touching`.
    pub(crate) fn are_within(&self, gap: f64, touching: bool) -> bool {
        let nearest = triangle::nearest(&self.moving, &self.fixed, self.noise);
        let length = nearest.length + triangle::LENGTH * self.noise;
        length < gap || touching && length == gap
    }

    /// Whether they stay as far apart as the gap from here on, but for what counts as grazing.
    fn part(&mut self, line: &Line) -> bool {
        let Some(plane) = self.look(DVec3::ZERO).plane else { return false };
        line.slope(plane.normal) <= UNIT_VECTOR && plane.height >= line.keep - GRAZE * self.noise
    }

    /// A point that the line is nearest to, to within some looks from where it begins to be near.
    fn deeper(&mut self, line: &Line, lower: f64) -> DVec3 {
        let mut point = self.look(line.unit * lower).point;
        for _ in 0..MOST_DEEPER {
            if line.upper(point).is_some() {
                break;
            }
            point = self.look(line.unit * point.dot(line.unit)).point;
        }
        point
    }

    /// Whether a plane along the line keeps them apart, but for what counts as grazing.
    fn pass(&mut self, line: &Line) -> bool {
        let toward = self.fixed[0] - self.moving[0];
        let found = shadow(self, line, toward);
        found.is_some_and(|found| found.plane.height >= line.keep - GRAZE * self.noise)
    }
}

impl Target for Facets {
    type Support = ();
    type Spot = [DVec3; 2];

    fn lowest(&mut self, normal: DVec3) -> (Plane<()>, DVec3) {
        let least = |corners: &Corners, n: DVec3| {
            let [a, b, c] = *corners;
            let nearer = if n.dot(b) < n.dot(a) { b } else { a };
            if n.dot(c) < n.dot(nearer) { c } else { nearer }
        };
        let point = least(&self.fixed, normal) - least(&self.moving, -normal);
        (self.plane(normal), point)
    }

    fn look(&mut self, from: DVec3) -> Look<(), [DVec3; 2]> {
        let there = self.moving.map(|p| p + from);
        let nearest = triangle::nearest(&there, &self.fixed, self.noise);
        let weights = nearest.weights;
        let plane = (nearest.gap > self.noise).then(|| self.plane(nearest.normal));
        let mean =
            triangle::mean(&self.fixed, weights[1]) - triangle::mean(&self.moving, weights[0]);
        let of = |k: usize| (0..3).filter(move |&i| weights[k][i] > 0.0);
        let (mut corners, mut count) = ([mean; 3], 0);
        for (i, j) in of(0).flat_map(|i| of(1).map(move |j| (i, j))) {
            if count < 3 {
                corners[count] = self.fixed[j] - self.moving[i];
            }
            count += 1;
        }
        Look { plane, point: mean, spot: weights, corners, count }
    }
}

/// When two facets are first as near as the gap, if they come nearer than that by more than rounding; `limit` is what
/// it has to stay below.
pub(crate) fn gap(scene: &Scene, f: &Facet, g: &Facet, limit: f64, wanted: Wanted) -> Option<Gap> {
    let reach = scene.keep + 4.0 * scene.noise;
    let apart = |axis: usize| f.bounds.is_apart(&g.bounds, axis, reach);
    if apart(0) || apart(1) || g.bounds.low.z - f.bounds.high.z - reach >= limit {
        return None;
    }
    if wanted != Wanted::All && g.bounds.high.z - f.bounds.low.z < -reach {
        return None;
    }
    let facets = &mut Facets::new(scene, &f.corners, &g.corners);
    let line = &Facets::line(scene, 1.0);
    if wanted == Wanted::NotCrossing && facets.are_within(scene.keep, false) {
        return None;
    }
    let start = facets.plane(line.unit);
    let found = travel(facets, line, start, limit);
    if found.lower >= limit
        || wanted != Wanted::All && found.lower <= 4.0 * scene.noise && facets.part(line)
        || is_shallow(&found, line) && facets.pass(line)
    {
        return None;
    }
    Some(measured(facets, &found, line))
}

/// Whether the line may only graze.
fn is_shallow(found: &Travel<Facets>, line: &Line) -> bool {
    let Some(near) = found.near else { return true };
    let aside = near.point.reject_from_normalized(line.unit).length();
    line.keep - aside <= 2.0 * GRAZE * line.noise.point()
}

/// The gap of facets that are found to come nearer than it.
fn measured(facets: &mut Facets, found: &Travel<Facets>, line: &Line) -> Gap {
    use std::cmp::Ordering::Greater;
    let near = found.near.map(|near| near.point);
    let point = near.unwrap_or_else(|| facets.deeper(line, found.lower));
    let upper = line.upper(point).unwrap_or_else(|| point.dot(line.unit)).max(found.lower);
    let least = line.estimate(point).unwrap_or(upper).clamp(found.lower, upper);
    let error = (least - found.lower).max(upper - least);
    // Those that cross are not asked for where that matters.
    Gap { least, largest: f64::INFINITY, signs: [Greater; 2], at: Meeting::Near, error }
}

/// The weights of the points of two facets that are nearest after a way along the direction, and the normal
/// from one to the other.
pub(crate) fn nearest_after(
    scene: &Scene,
    f: &[Corner; 3],
    g: &[Corner; 3],
    way: f64,
) -> ([DVec3; 2], DVec3) {
    let Facets { moving, fixed, noise } = Facets::new(scene, f, g);
    let by = scene.setting.direction / scene.setting.length * way;
    let nearest = triangle::nearest(&moving.map(|p| p + by), &fixed, noise);
    (nearest.weights, nearest.normal)
}
