//! A way out for what is loose, where no sample of the sphere is one.
//!
//! Of closed parts that meet by rule all directions are known: the way out is the direction of the free regions that is
//! farthest from a border. Of others, and where not all is decided, samples are refined.
//!
//! The triangles of the sphere are cut where outcomes change: where other parts are in the way at
//! their corners, or at other distances. First those that are wide and reach far: a gap that leads out
//! is a place between two obstacles, and what goes there goes far before it is stopped.
//!
//! What is held closely is found to be so without its rooms: along each sample one contact that is
//! near enough will do, and mostly it is of facets that met before ([`Witnesses`]).

use std::sync::atomic::AtomicBool;

use colltrans::free::FreeOptions;
use colltrans::solid::Workspace;
use glam::DVec3;
use rayon::prelude::*;

use super::{MapOptions, Mapper};
use crate::bodies::{Bodies, Room};
use crate::error::AssemblyError;
use crate::free::Removal;
use crate::rooms::PartRoom;
use crate::watch::Watch;
use crate::witness::Witnesses;

/// What goes less far than this share of its own size along all samples is held, not loose.
const FAR: f64 = 0.5;
/// And after each round some sample has to go farther by this share: a ball that rolls a little in its
/// groove is no way out.
const FARTHER: f64 = 0.125;
/// Distances that differ by less than this share are no change.
const CHANGE: f64 = 0.1;
/// Triangles that are cut in one round, and rounds.
const CUTS: usize = 128;
const ROUNDS: usize = 8;
/// Triangles are cut down to this width, in radians.
const NARROWEST: f64 = 0.01;

/// Pairs of boxes that are looked at for all directions, at most.
const LOOKS: u64 = 2_000_000;

/// A direction in which a group is free of `others`. `None` if there is none that can be seen; of what is not decided
/// exactly, if there is none among those looked at, some 2,000 at most, or if the group is held too closely for a
/// look, or for one more.
pub(crate) fn way_out(
    bodies: &Bodies,
    group: &[usize],
    others: &[bool],
    options: MapOptions,
    watch: Watch,
) -> Result<Option<DVec3>, AssemblyError> {
    if let Some(exact) = exactly(bodies, group, others, options, watch)? {
        return Ok(exact);
    }
    let mut mapper = Mapper::new(bodies, group, others.to_vec(), options, watch);
    let bounds = group.iter().map(|&k| bodies.bounds(k)).reduce(|a, b| a.join(&b));
    let size = bounds.map_or(0.0, |b| (b.high - b.low).max_element());
    if !mapper.reaches(FAR * size)? {
        return Ok(None);
    }
    mapper.ask()?;
    for round in 0..ROUNDS {
        if let Some(k) = mapper.rooms.iter().position(PartRoom::is_free) {
            return Ok(Some(mapper.sphere.directions[k]));
        }
        let farthest = mapper.rooms.iter().map(PartRoom::distance).fold(0.0, f64::max);
        let cuts = mapper.changes();
        if farthest < (FAR + FARTHER * round as f64) * size {
            return Ok(None);
        }
        if cuts.is_empty() {
            return Ok(None);
        }
        mapper.cut(cuts)?;
    }
    let free = mapper.rooms.iter().position(PartRoom::is_free);
    Ok(free.map(|k| mapper.sphere.directions[k]))
}

/// The direction farthest from the borders of what is free, or that none is; nothing of what is not decided.
#[expect(clippy::option_option, reason = "none at all, or not known")]
fn exactly(
    bodies: &Bodies,
    group: &[usize],
    others: &[bool],
    options: MapOptions,
    watch: Watch,
) -> Result<Option<Option<DVec3>>, AssemblyError> {
    let others: Vec<usize> =
        (0..bodies.len()).filter(|k| others[*k] && !group.contains(k)).collect();
    let Ok(removal) = Removal::among(bodies, group, &others) else { return Ok(None) };
    let never = AtomicBool::new(false);
    let asked = FreeOptions::DEFAULT.with_looks(LOOKS).with_start_overlap(options.start);
    let free = match removal.directions(asked, watch.flag().unwrap_or(&never)) {
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
    /// Whether the group goes so far along any of the samples.
    fn reaches(&self, far: f64) -> Result<bool, AssemblyError> {
        let look = |(workspace, witnesses): &mut (Workspace, Witnesses), d: &DVec3| {
            self.watch.check().map(|()| !self.is_held(*d, far, workspace, witnesses))
        };
        let reached = self.sphere.directions.par_iter().map_init(Default::default, look);
        // What ends the look: a direction that reaches, or a call to stop.
        reached.find_any(|r| !matches!(r, Ok(false))).unwrap_or(Ok(false))
    }

    /// Whether something stops the group before it has gone so far.
    fn is_held(
        &self,
        d: DVec3,
        far: f64,
        workspace: &mut Workspace,
        witnesses: &mut Witnesses,
    ) -> bool {
        let start = self.options.start;
        let mut pairs = Vec::new();
        for &part in self.group {
            let ahead = self.bodies.ahead(part, d).into_iter().take_while(|x| x.0 < far);
            let ahead = ahead.filter(|&(_, by)| self.others[by] && !self.group.contains(&by));
            pairs.extend(ahead.map(|(_, by)| [part, by]));
        }
        let within = far.next_down();
        let mut known = pairs.iter();
        if known.any(|&p| witnesses.stop(self.bodies, p, d, within, start).is_some()) {
            return true;
        }
        pairs.into_iter().any(|pair| {
            let room = self.bodies.room(pair, d, Some(far), start, workspace);
            if let Room::Blocked(stop) = &room {
                witnesses.keep(pair, stop);
            }
            room != Room::Free
        })
    }

    /// The triangles to be cut next.
    fn changes(&self) -> Vec<usize> {
        let score = |t: usize| {
            let rooms = self.sphere.triangles[t].corners.map(|k| &self.rooms[k as usize]);
            let distances = rooms.map(PartRoom::distance);
            let far = distances.into_iter().fold(0.0, f64::max);
            let near = distances.into_iter().fold(f64::INFINITY, f64::min);
            let same = rooms.iter().all(|r| r.by() == rooms[0].by());
            let width = self.sphere.widest(t);
            let wanted = width > NARROWEST && far > 0.0 && (!same || far - near > CHANGE * far);
            wanted.then_some((far * width, t))
        };
        let mut found: Vec<(f64, usize)> = self.sphere.leaves().filter_map(score).collect();
        found.sort_by(|x, y| y.0.total_cmp(&x.0).then(x.1.cmp(&y.1)));
        found.truncate(CUTS);
        found.into_iter().map(|x| x.1).collect()
    }
}
