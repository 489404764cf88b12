//! Search for a removal direction of a movable group that no sample of the sphere separates.
//!
//! For closed parts without exceptions, all free directions are computed. The result is the free direction farthest
//! from the border of its region. Otherwise, and if the computation finds no free region but leaves directions
//! undecided, samples are refined.
//!
//! Triangles of the sphere are subdivided where outcomes change: where different parts block their corners, or at
//! different distances. Wide triangles with long travel come first, because an exit lies between two obstacles and a
//! motion near it travels far before it is blocked.
//!
//! Closely held groups are rejected without computing their travel: one close contact along each sample is enough.
//! Mostly this contact is between facets that met before ([`Witnesses`]).

use std::sync::atomic::AtomicBool;

use colltrans::removal::directions::FreeOptions;
use colltrans::solid::Workspace;
use glam::DVec3;
use rayon::prelude::*;

use super::{MapOptions, Mapper};
use crate::bodies::{Bodies, FreeTravel};
use crate::error::AssemblyError;
use crate::free::RemovalPair;
use crate::travel::PartTravel;
use crate::watch::Watch;
use crate::witness::Witnesses;

/// A group counts as held if its travel along all samples is below this fraction of its size.
const MIN_TRAVEL: f64 = 0.5;
/// Increase of this fraction after each round. A part that moves a little further in its groove does not continue the
/// search.
const MIN_TRAVEL_STEP: f64 = 0.125;
/// Relative difference below which two distances are equal.
const MIN_CHANGE: f64 = 0.1;
/// Maximum number of triangles that are subdivided in a round, and number of rounds.
const MAX_CUTS: usize = 128;
const ROUNDS: usize = 8;
/// Minimum width of a triangle that is subdivided, in radians.
const MIN_WIDTH: f64 = 0.01;

/// Maximum number of box pairs that are visited for the exact free directions.
const MAX_LOOKS: u64 = 2_000_000;

/// Returns a direction along which a group is free of `others`.
///
/// If the free directions are decided exactly, `None` means that no region of free directions exists. Otherwise it
/// means that none of the tested directions is free, or that the group is held too closely. The tested directions are
/// the samples of the options and at most 3,072 midpoints.
pub(crate) fn find_removal_direction(
    bodies: &Bodies,
    group: &[usize],
    others: &[bool],
    options: MapOptions,
    watch: Watch,
) -> Result<Option<DVec3>, AssemblyError> {
    if let Some(exact) = exact_way_out(bodies, group, others, options, watch)? {
        return Ok(exact);
    }
    let mut mapper = Mapper::new(bodies, group, others.to_vec(), options, watch);
    let bounds = group.iter().map(|&k| bodies.bounds(k)).reduce(|a, b| a.union(&b));
    let size = bounds.map_or(0.0, |b| (b.high - b.low).max_element());
    if !mapper.reaches_any(MIN_TRAVEL * size)? {
        return Ok(None);
    }
    mapper.sample_pending()?;
    for round in 0..ROUNDS {
        if let Some(k) = mapper.rooms.iter().position(PartTravel::is_free) {
            return Ok(Some(mapper.sphere.directions[k]));
        }
        let farthest = mapper.rooms.iter().map(PartTravel::safe_distance).fold(0.0, f64::max);
        let cuts = mapper.triangles_to_cut();
        if farthest < (MIN_TRAVEL + MIN_TRAVEL_STEP * round as f64) * size {
            return Ok(None);
        }
        if cuts.is_empty() {
            return Ok(None);
        }
        mapper.cut_triangles(cuts)?;
    }
    let free = mapper.rooms.iter().position(PartTravel::is_free);
    Ok(free.map(|k| mapper.sphere.directions[k]))
}

/// Returns the free direction farthest from the borders of its region. The inner `None` means that there is no free
/// region, the outer one that the exact computation does not decide it or is not possible.
#[expect(
    clippy::option_option,
    reason = "the outer option is whether it is decided, the inner one the direction"
)]
fn exact_way_out(
    bodies: &Bodies,
    group: &[usize],
    others: &[bool],
    options: MapOptions,
    watch: Watch,
) -> Result<Option<Option<DVec3>>, AssemblyError> {
    let others: Vec<usize> =
        (0..bodies.len()).filter(|k| others[*k] && !group.contains(k)).collect();
    let Ok(removal) = RemovalPair::between(bodies, group, &others) else { return Ok(None) };
    let never = AtomicBool::new(false);
    let free_options = FreeOptions::DEFAULT.with_looks(MAX_LOOKS).with_start_overlap(options.start);
    let free = match removal.free_directions(free_options, watch.cancel_flag().unwrap_or(&never)) {
        Err(AssemblyError::Cancelled) => return Err(AssemblyError::Cancelled),
        Err(_) => return Ok(None),
        Ok(free) => free,
    };
    let widest = free.regions().into_iter().max_by(|a, b| a.margin.total_cmp(&b.margin));
    match widest {
        Some(region) => Ok(Some(Some(region.center))),
        None => Ok(free.is_complete().then_some(None)),
    }
}

impl Mapper<'_> {
    /// Checks whether the group travels at least `far` along any of the samples.
    fn reaches_any(&self, far: f64) -> Result<bool, AssemblyError> {
        let examine = |(workspace, witnesses): &mut (Workspace, Witnesses), d: &DVec3| {
            self.watch
                .check_cancelled()
                .map(|()| !self.is_stopped_within(*d, far, workspace, witnesses))
        };
        let reached = self.sphere.directions.par_iter().map_init(Default::default, examine);
        // The search ends with a direction that reaches `far` or with a cancelled run.
        reached.find_any(|r| !matches!(r, Ok(false))).unwrap_or(Ok(false))
    }

    /// Checks whether a contact stops the group before it has travelled `far`.
    fn is_stopped_within(
        &self,
        d: DVec3,
        far: f64,
        workspace: &mut Workspace,
        witnesses: &mut Witnesses,
    ) -> bool {
        let start = self.options.start;
        let mut pairs = Vec::new();
        for &part in self.group {
            let ahead = self.bodies.parts_ahead(part, d).into_iter().take_while(|x| x.0 < far);
            let ahead = ahead.filter(|&(_, by)| self.others[by] && !self.group.contains(&by));
            pairs.extend(ahead.map(|(_, by)| [part, by]));
        }
        let within = far.next_down();
        let mut known = pairs.iter();
        if known.any(|&p| witnesses.find_stop(self.bodies, p, d, within, start).is_some()) {
            return true;
        }
        pairs.into_iter().any(|pair| {
            let room = self.bodies.free_travel(pair, d, Some(far), start, workspace);
            if let FreeTravel::Blocked(stop) = &room {
                witnesses.store(pair, stop);
            }
            room != FreeTravel::Free
        })
    }

    /// Returns the triangles to subdivide next.
    fn triangles_to_cut(&self) -> Vec<usize> {
        let score = |t: usize| {
            let rooms = self.sphere.triangles[t].corners.map(|k| &self.rooms[k as usize]);
            let distances = rooms.map(PartTravel::safe_distance);
            let far = distances.into_iter().fold(0.0, f64::max);
            let near = distances.into_iter().fold(f64::INFINITY, f64::min);
            let same = rooms.iter().all(|r| r.blocker() == rooms[0].blocker());
            let width = self.sphere.longest_side(t);
            let wanted = width > MIN_WIDTH && far > 0.0 && (!same || far - near > MIN_CHANGE * far);
            wanted.then_some((far * width, t))
        };
        let mut found: Vec<(f64, usize)> = self.sphere.leaf_triangles().filter_map(score).collect();
        found.sort_by(|x, y| y.0.total_cmp(&x.0).then(x.1.cmp(&y.1)));
        found.truncate(MAX_CUTS);
        found.into_iter().map(|x| x.1).collect()
    }
}
