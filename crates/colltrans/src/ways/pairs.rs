//! What two bodies do, by how one is displaced against the other: asked once for each displacement.

use std::collections::HashMap;

use glam::DVec3;

use super::openings::Question;
use super::options::Searched;
use crate::answer::{Clearance, SolidSteps};
use crate::body::Placed;
use crate::body::solid::Solid;
use crate::cast::Cast;
use crate::cast::solid::SolidOptions;
use crate::free::{Bodies, FreeError};
use crate::setting::error::QueryError;
use crate::solve::solid::{Workspace, overlap};

/// A displacement, by its bits: places lie on a grid, so equal ones are equal.
pub(super) fn bits(v: DVec3) -> [u64; 3] {
    // Both zeros are one.
    v.to_array().map(|x| (x + 0.0).to_bits())
}

type Key = ([u64; 3], usize);
type OpeningKey = ([u64; 3], [usize; 2], [u64; 2]);

/// Two bodies, as they are planned with.
pub(super) struct Pair<'a> {
    placed: [Placed<'a, Solid>; 2],
    tolerance: f64,
    bodies: Bodies<'a>,
    rooms: HashMap<Key, f64>,
    blocked: HashMap<OpeningKey, Vec<[f64; 2]>>,
    workspace: Workspace,
}

impl<'a> Pair<'a> {
    /// # Errors
    /// Bodies that cannot be asked about, are open or overlap.
    pub(super) fn new(placed: [Placed<'a, Solid>; 2], tolerance: f64) -> Result<Self, FreeError> {
        let options = SolidOptions::default().with_tolerance(tolerance);
        let cast = Cast::new(placed[0], placed[1], DVec3::Z)?.with_options(options)?;
        for (which, body) in [("moving", &placed[0]), ("fixed", &placed[1])] {
            if !body.body.is_closed() {
                return Err(FreeError::Open { which });
            }
        }
        let scene = cast.asked_of_something()?;
        if let Some(place) = overlap::find(&scene, &mut SolidSteps::default()) {
            return Err(FreeError::Overlapping { place });
        }
        let bodies = Bodies::new(scene);
        let (rooms, blocked) = (HashMap::new(), HashMap::new());
        Ok(Self { placed, tolerance, bodies, rooms, blocked, workspace: Workspace::default() })
    }

    /// How far the first body, displaced by `by`, goes along a direction of length 1.
    pub(super) fn room(
        &mut self,
        by: DVec3,
        (number, d): (usize, DVec3),
        searched: &mut Searched,
    ) -> Result<f64, QueryError> {
        let key = (bits(by), number);
        if let Some(&room) = self.rooms.get(&key) {
            return Ok(room);
        }
        searched.casts += 1;
        let options =
            SolidOptions::default().with_tolerance(self.tolerance).with_overlapping(false);
        let cast = displaced(self.placed, by, d)?.with_options(options)?;
        let room = match cast.clearance_in(&mut self.workspace)? {
            Clearance::Blocked { contact, .. } => contact.shrunk_distance.value.max(0.0),
            Clearance::Free(_) => f64::INFINITY,
            Clearance::Overlapping(_) => 0.0,
        };
        self.rooms.insert(key, room);
        Ok(room)
    }

    /// Where along the first of two directions the first body cannot go `far` along the second.
    pub(super) fn blocked(
        &mut self,
        by: DVec3,
        numbers: [usize; 2],
        along: [DVec3; 2],
        [end, far]: [f64; 2],
        searched: &mut Searched,
    ) -> &[[f64; 2]] {
        let bodies = &self.bodies;
        let ask = || {
            searched.openings += 1;
            Question { from: by, along, end, far }.blocked(bodies, &mut searched.looks)
        };
        let key = (bits(by), numbers, [end.to_bits(), far.to_bits()]);
        self.blocked.entry(key).or_insert_with(ask)
    }
}

/// The cast of one body against another, displaced by a vector.
pub(super) fn displaced(
    [a, b]: [Placed<'_, Solid>; 2],
    by: DVec3,
    d: DVec3,
) -> Result<Cast<'_, Solid>, QueryError> {
    let pose = a.pose.translated(by).map_err(|_| QueryError::Direction { direction: by })?;
    Cast::new(a.body.at(pose), b, d)
}
