//! Queries about two bodies by their relative displacement, each computed once.

use std::collections::HashMap;

use glam::DVec3;

use super::openings::OpeningQuery;
use super::options::SearchWork;
use super::scene::PairRelation;
use crate::directions::{Bodies, FreeError};
use colltrans_convex::answer::Clearance;
use colltrans_convex::body::{Aabb, Placed};
use colltrans_convex::cast::Cast;
use colltrans_convex::setting::error::QueryError;
use colltrans_solid::SolidSteps;
use colltrans_solid::body::Solid;
use colltrans_solid::cast::SolidOptions;
use colltrans_solid::solve::{Workspace, overlap};
use colltrans_solid::{SolidCast, SolidScene};

/// Returns a displacement as bits, for use as a key. Displacements lie on a grid, so equal ones have equal
/// bits.
pub(super) fn bit_key(v: DVec3) -> [u64; 3] {
    // Adding 0 turns -0 into 0.
    v.to_array().map(|x| (x + 0.0).to_bits())
}

type TravelKey = ([u64; 3], usize);
type OpeningKey = ([u64; 3], [usize; 2], [u64; 2]);

/// Maximum number of stored pairs of facets that were hit.
const MAX_HIT: usize = 32;
/// Number of node visits for which a test of two facets that were hit counts, and building a cast.
const HIT_WORK: u64 = 8;
/// Number of node visits for which a query of openings counts, even if its result is known.
const OPENING_WORK: u64 = 4;

/// Two bodies of the search, with cached results.
pub(super) struct BodyPair<'a> {
    placed: [Placed<'a, Solid>; 2],
    /// Bounding boxes in the world frame, slightly enlarged.
    boxes: [Aabb; 2],
    pub(super) tolerance: f64,
    /// Overlap in the initial poses, if any. Such bodies move together.
    pub(super) overlap: Option<overlap::Overlap>,
    /// The free travel in any direction, if the bodies move together (0) or never block each other.
    constant_travel: Option<f64>,
    /// Built when openings are requested for the first time.
    bodies: Option<Bodies<'a>>,
    /// Minimum length of a move.
    step: f64,
    free_travels: HashMap<TravelKey, f64>,
    /// Facets that were hit, the most recent first.
    hit: Vec<[u32; 2]>,
    /// Normals of the facets that were hit, in the world frame, until the search takes them.
    pub(super) hit_normals: Vec<DVec3>,
    blocked: HashMap<OpeningKey, Vec<[f64; 2]>>,
    workspace: Workspace,
}

impl<'a> BodyPair<'a> {
    /// Builds the pair of two bodies with a relation, and with [boxes](bounding_box) that contain them.
    ///
    /// # Errors
    /// Returns an error for bodies that a cast rejects.
    pub(super) fn new(
        relation: &PairRelation<'a>,
        placed: [Placed<'a, Solid>; 2],
        boxes: [Aabb; 2],
        step: f64,
    ) -> Result<Self, FreeError> {
        let (placed, tolerance, constant_travel) = match relation {
            PairRelation::Ignored => (placed, 0.0, Some(f64::INFINITY)),
            PairRelation::Joined => (placed, 0.0, Some(0.0)),
            PairRelation::Blocking(pair) => (pair.searched, pair.search_tolerance, None),
        };
        let overlap = if constant_travel.is_none() && boxes[0].intersects(&boxes[1]) {
            let cast = initial_cast(placed, tolerance)?;
            overlap::find_overlap(&cast.checked_query_scene()?, &mut SolidSteps::default())
        } else {
            None
        };
        let constant_travel = constant_travel.or(overlap.map(|_| 0.0));
        Ok(Self {
            placed,
            boxes,
            tolerance,
            overlap,
            constant_travel,
            bodies: None,
            step,
            free_travels: HashMap::new(),
            hit: Vec::new(),
            hit_normals: Vec::new(),
            blocked: HashMap::new(),
            workspace: Workspace::default(),
        })
    }

    /// Returns the free travel of the first body, displaced by `by`, along a direction of length 1. A free
    /// travel below the minimum length of a move may be returned as 0.
    pub(super) fn free_travel(
        &mut self,
        by: DVec3,
        (number, d): (usize, DVec3),
        searched: &mut SearchWork,
    ) -> Result<f64, QueryError> {
        if let Some(travel) = self.constant_travel {
            return Ok(travel);
        }
        if !self.boxes_may_meet(by, d) {
            return Ok(f64::INFINITY);
        }
        let key = (bit_key(by), number);
        if let Some(&room) = self.free_travels.get(&key) {
            return Ok(room);
        }
        searched.looks += (self.hit.len() as u64 + 1) * HIT_WORK;
        let cast = self.cast_along(by, d)?;
        // Facets that were hit last often block again after a short distance, also along other directions.
        let soon = |facets: &[u32; 2]| {
            cast.contact_of_triangles(*facets)
                .is_some_and(|stop| stop.offset_distance.value < self.step)
        };
        let room = if let Some(k) = self.hit.iter().position(soon) {
            self.hit[..=k].rotate_right(1);
            0.0
        } else {
            searched.casts += 1;
            let clearance = cast.clearance_in(&mut self.workspace)?;
            if let Clearance::Blocked { contact, .. } = &clearance {
                self.hit.insert(0, contact.triangles);
                self.hit.truncate(MAX_HIT);
                let normal = facet_normal(&self.placed, contact.triangles, contact.normal);
                self.hit_normals.extend(normal);
            }
            travel_of_clearance(&clearance)
        };
        self.free_travels.insert(key, room);
        Ok(room)
    }

    /// Computes the free travel of the first body, displaced by `by`, along a direction of length 1. The
    /// result is not cached.
    pub(super) fn uncached_free_travel(
        &mut self,
        by: DVec3,
        d: DVec3,
        searched: &mut SearchWork,
    ) -> Result<f64, QueryError> {
        searched.casts += 1;
        Ok(travel_of_clearance(&self.cast_along(by, d)?.clearance_in(&mut self.workspace)?))
    }

    fn cast_along(&self, by: DVec3, d: DVec3) -> Result<Cast<'a, Solid>, QueryError> {
        let options =
            SolidOptions::default().with_tolerance(self.tolerance).with_overlapping(false);
        displaced_cast(self.placed, by, d)?.with_options(options)
    }

    /// Checks whether the box of the first body, displaced by `by`, meets that of the second one along a
    /// direction.
    fn boxes_may_meet(&self, by: DVec3, d: DVec3) -> bool {
        let [a, b] = &self.boxes;
        let (mut enter, mut exit) = (0.0_f64, f64::INFINITY);
        for k in 0..3 {
            let (low, high) = (b.low[k] - a.high[k] - by[k], b.high[k] - a.low[k] - by[k]);
            if d[k] == 0.0 {
                if low > 0.0 || high < 0.0 {
                    return false;
                }
                continue;
            }
            let (x, y) = (low / d[k], high / d[k]);
            enter = enter.max(x.min(y));
            exit = exit.min(x.max(y));
        }
        enter <= exit
    }

    /// Returns the positions along the first of two directions from which the first body cannot move `far`
    /// along the second one, as open intervals.
    pub(super) fn blocked_intervals(
        &mut self,
        by: DVec3,
        numbers: [usize; 2],
        along: [DVec3; 2],
        [end, far]: [f64; 2],
        searched: &mut SearchWork,
    ) -> Result<&[[f64; 2]], QueryError> {
        if self.constant_travel.is_some() {
            return Ok(&[]);
        }
        searched.looks += OPENING_WORK;
        let two_sided = self.placed.map(|placed| !placed.body.is_closed());
        let query = OpeningQuery { from: by, along, end, far, two_sided };
        let [a, b] = &self.boxes;
        if query.box_interval([a, b]).is_none() {
            return Ok(&[]);
        }
        let bodies = match &mut self.bodies {
            Some(bodies) => bodies,
            none => {
                let scene = initial_cast(self.placed, self.tolerance)?.checked_query_scene()?;
                none.insert(Bodies::new(scene))
            }
        };
        let ask = || {
            searched.openings += 1;
            query.blocked_intervals(bodies, &mut searched.looks)
        };
        let key = (bit_key(by), numbers, [end.to_bits(), far.to_bits()]);
        Ok(self.blocked.entry(key).or_insert_with(ask))
    }

    /// Removes the cached free travels of all directions from an index on.
    pub(super) fn forget_travels(&mut self, from: usize) {
        self.free_travels.retain(|key, _| key.1 < from);
    }

    /// Returns the first body displaced by `by`, and the second one.
    pub(super) fn placed_bodies(&self, by: DVec3) -> Result<[Placed<'a, Solid>; 2], QueryError> {
        let [a, b] = self.placed;
        Ok([a.body.at(displaced_pose(a, by)?), b])
    }
}

/// Returns the normal, in the world frame, of the facet in contact that is nearest to the normal of the contact.
/// Returns `None` for facets without area.
fn facet_normal(
    placed: &[Placed<'_, Solid>; 2],
    triangles: [u32; 2],
    contact: DVec3,
) -> Option<DVec3> {
    let normals = [0, 1].map(|k| {
        let body = placed[k].body;
        let [a, b, c] =
            body.triangles()[triangles[k] as usize].map(|v| body.vertices()[v as usize]);
        placed[k].pose.transform_vector((b - a).cross(c - a)).try_normalize()
    });
    let near = |normal: &DVec3| normal.dot(contact).abs();
    normals.into_iter().flatten().max_by(|a, b| near(a).total_cmp(&near(b)))
}

fn travel_of_clearance(clearance: &Clearance<Solid>) -> f64 {
    match clearance {
        Clearance::Blocked { contact, .. } => contact.offset_distance.value.max(0.0),
        Clearance::Free(_) => f64::INFINITY,
        Clearance::Overlapping(_) => 0.0,
    }
}

/// Returns the bounding box of a placed body in the world frame, enlarged by more than the rounding error.
pub(super) fn bounding_box(body: &Placed<'_, Solid>) -> Aabb {
    let pose = &body.pose;
    let points = body.body.vertices().iter().map(|v| pose.transform_point(*v));
    let tight = Aabb::from_points(points);
    tight.expanded(1e-12 * tight.low.abs().max(tight.high.abs()).max_element())
}

/// Builds the cast of both bodies in their initial poses.
pub(super) fn initial_cast(
    [a, b]: [Placed<'_, Solid>; 2],
    tolerance: f64,
) -> Result<Cast<'_, Solid>, QueryError> {
    Cast::new(a, b, DVec3::Z)?.with_options(SolidOptions::default().with_tolerance(tolerance))
}

fn displaced_pose(a: Placed<'_, Solid>, by: DVec3) -> Result<colltrans_convex::Pose, QueryError> {
    a.pose.translated_by(by).map_err(|_| QueryError::Direction { direction: by })
}

/// Builds the cast of one body, displaced by a vector, against another one.
pub(super) fn displaced_cast(
    [a, b]: [Placed<'_, Solid>; 2],
    by: DVec3,
    d: DVec3,
) -> Result<Cast<'_, Solid>, QueryError> {
    Cast::new(a.body.at(displaced_pose(a, by)?), b, d)
}
