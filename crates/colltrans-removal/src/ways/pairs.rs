//! What two bodies do, by how one is displaced against the other: asked once for each displacement.

use std::collections::HashMap;

use glam::DVec3;

use super::openings::Question;
use super::options::Searched;
use crate::free::{Bodies, FreeError};
use colltrans_convex::answer::Clearance;
use colltrans_convex::body::{Aabb, Placed};
use colltrans_convex::cast::Cast;
use colltrans_convex::setting::error::QueryError;
use colltrans_solid::SolidSteps;
use colltrans_solid::body::Solid;
use colltrans_solid::cast::SolidOptions;
use colltrans_solid::solve::{Workspace, overlap};
use colltrans_solid::{SolidCast, SolidScene};

/// A displacement, by its bits: places lie on a grid, so equal ones are equal.
pub(super) fn bits(v: DVec3) -> [u64; 3] {
    // Both zeros are one.
    v.to_array().map(|x| (x + 0.0).to_bits())
}

type Key = ([u64; 3], usize);
type OpeningKey = ([u64; 3], [usize; 2], [u64; 2]);

/// Facets that were hit are kept, so many pairs at most.
const MOST_HIT: usize = 32;

/// Two bodies, as they are planned with.
pub(super) struct Pair<'a> {
    placed: [Placed<'a, Solid>; 2],
    /// In the world, a little larger than the bodies.
    boxes: [Aabb; 2],
    pub(super) tolerance: f64,
    /// Where they overlap as they are, if they do: then they move as one.
    pub(super) overlap: Option<overlap::Overlap>,
    /// Made when openings are first asked for.
    bodies: Option<Bodies<'a>>,
    /// A move is worth making from here on.
    step: f64,
    rooms: HashMap<Key, f64>,
    /// Facets that were hit, the last ones first.
    hit: Vec<[u32; 2]>,
    blocked: HashMap<OpeningKey, Vec<[f64; 2]>>,
    workspace: Workspace,
}

impl<'a> Pair<'a> {
    /// Of bodies with their [boxes](around).
    ///
    /// # Errors
    /// Bodies that cannot be asked about, or are open.
    pub(super) fn new(
        placed: [Placed<'a, Solid>; 2],
        boxes: [Aabb; 2],
        (tolerance, step): (f64, f64),
    ) -> Result<Self, FreeError> {
        for (which, body) in [("moving", &placed[0]), ("fixed", &placed[1])] {
            if !body.body.is_closed() {
                return Err(FreeError::Open { which });
            }
        }
        let cast = standing(placed, tolerance)?;
        let overlap = if boxes[0].meets(&boxes[1]) {
            overlap::find(&cast.asked_of_something()?, &mut SolidSteps::default())
        } else {
            None
        };
        Ok(Self {
            placed,
            boxes,
            tolerance,
            overlap,
            bodies: None,
            step,
            rooms: HashMap::new(),
            hit: Vec::new(),
            blocked: HashMap::new(),
            workspace: Workspace::default(),
        })
    }

    /// How far the first body, displaced by `by`, goes along a direction of length 1; of less than a step, no more than
    /// that it is less.
    pub(super) fn room(
        &mut self,
        by: DVec3,
        (number, d): (usize, DVec3),
        searched: &mut Searched,
    ) -> Result<f64, QueryError> {
        if self.overlap.is_some() {
            return Ok(0.0);
        }
        if !self.may_meet(by, d) {
            return Ok(f64::INFINITY);
        }
        let key = (bits(by), number);
        if let Some(&room) = self.rooms.get(&key) {
            return Ok(room);
        }
        let cast = self.cast(by, d)?;
        // What was hit last is often in the way again, and soon, along other directions too.
        let soon = |facets: &[u32; 2]| {
            cast.stop_by(*facets).is_some_and(|stop| stop.shrunk_distance.value < self.step)
        };
        let room = if let Some(k) = self.hit.iter().position(soon) {
            self.hit[..=k].rotate_right(1);
            0.0
        } else {
            searched.casts += 1;
            let clearance = cast.clearance_in(&mut self.workspace)?;
            if let Clearance::Blocked { contact, .. } = &clearance {
                self.hit.insert(0, contact.triangles);
                self.hit.truncate(MOST_HIT);
            }
            room_of(&clearance)
        };
        self.rooms.insert(key, room);
        Ok(room)
    }

    /// The same along any direction of length 1, asked anew.
    pub(super) fn room_along(
        &mut self,
        by: DVec3,
        d: DVec3,
        searched: &mut Searched,
    ) -> Result<f64, QueryError> {
        searched.casts += 1;
        Ok(room_of(&self.cast(by, d)?.clearance_in(&mut self.workspace)?))
    }

    fn cast(&self, by: DVec3, d: DVec3) -> Result<Cast<'a, Solid>, QueryError> {
        let options =
            SolidOptions::default().with_tolerance(self.tolerance).with_overlapping(false);
        displaced(self.placed, by, d)?.with_options(options)
    }

    /// Whether the box of the first, displaced by `by`, meets that of the second along a direction.
    fn may_meet(&self, by: DVec3, d: DVec3) -> bool {
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

    /// Where along the first of two directions the first body cannot go `far` along the second.
    pub(super) fn blocked(
        &mut self,
        by: DVec3,
        numbers: [usize; 2],
        along: [DVec3; 2],
        [end, far]: [f64; 2],
        searched: &mut Searched,
    ) -> Result<&[[f64; 2]], QueryError> {
        let question = Question { from: by, along, end, far };
        let [a, b] = &self.boxes;
        if question.of_boxes([a, b]).is_none() {
            return Ok(&[]);
        }
        let bodies = match &mut self.bodies {
            Some(bodies) => bodies,
            none => {
                let scene = standing(self.placed, self.tolerance)?.asked_of_something()?;
                none.insert(Bodies::new(scene))
            }
        };
        let ask = || {
            searched.openings += 1;
            question.blocked(bodies, &mut searched.looks)
        };
        let key = (bits(by), numbers, [end.to_bits(), far.to_bits()]);
        Ok(self.blocked.entry(key).or_insert_with(ask))
    }

    /// Of directions from a number on nothing is kept.
    pub(super) fn forget_rooms(&mut self, from: usize) {
        self.rooms.retain(|key, _| key.1 < from);
    }

    /// The first one displaced by `by`, and the second.
    pub(super) fn placed(&self, by: DVec3) -> Result<[Placed<'a, Solid>; 2], QueryError> {
        let [a, b] = self.placed;
        Ok([a.body.at(moved(a, by)?), b])
    }
}

fn room_of(clearance: &Clearance<Solid>) -> f64 {
    match clearance {
        Clearance::Blocked { contact, .. } => contact.shrunk_distance.value.max(0.0),
        Clearance::Free(_) => f64::INFINITY,
        Clearance::Overlapping(_) => 0.0,
    }
}

/// The box of a placed body, in the world, larger by more than rounding.
pub(super) fn around(body: &Placed<'_, Solid>) -> Aabb {
    let pose = &body.pose;
    let points = body.body.vertices().iter().map(|v| pose.transform_point(*v));
    let tight = Aabb::of_points(points);
    tight.grown(1e-12 * tight.low.abs().max(tight.high.abs()).max_element())
}

/// Both where they are.
pub(super) fn standing(
    [a, b]: [Placed<'_, Solid>; 2],
    tolerance: f64,
) -> Result<Cast<'_, Solid>, QueryError> {
    Cast::new(a, b, DVec3::Z)?.with_options(SolidOptions::default().with_tolerance(tolerance))
}

fn moved(a: Placed<'_, Solid>, by: DVec3) -> Result<colltrans_convex::Pose, QueryError> {
    a.pose.translated(by).map_err(|_| QueryError::Direction { direction: by })
}

/// The cast of one body against another, displaced by a vector.
pub(super) fn displaced(
    [a, b]: [Placed<'_, Solid>; 2],
    by: DVec3,
    d: DVec3,
) -> Result<Cast<'_, Solid>, QueryError> {
    Cast::new(a.body.at(moved(a, by)?), b, d)
}
