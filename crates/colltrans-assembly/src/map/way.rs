//! A way out for what is loose, where no sample of the sphere is one.
//!
//! The triangles of the sphere are cut where outcomes change: where other parts are in the way at
//! their corners, or at other distances. First those that are wide and reach far: a gap that leads out
//! is a place between two obstacles, and what goes there goes far before it is stopped.

use glam::DVec3;

use super::{MapOptions, Mapper};
use crate::bodies::Bodies;
use crate::error::AssemblyError;
use crate::rooms::PartRoom;
use crate::watch::Watch;

/// What goes less far than this share of its own size along all samples is held, not loose.
const FAR: f64 = 0.5;
/// Distances that differ by less than this share are no change.
const CHANGE: f64 = 0.1;
/// Triangles that are cut in one round, and rounds.
const CUTS: usize = 128;
const ROUNDS: usize = 8;
/// Triangles are cut down to this width, in radians.
const NARROWEST: f64 = 0.01;

/// A direction in which a group is free of `others`; `None` if there is none among those looked at,
/// some 2,000 at most, or if the group is held too closely for a look.
pub(crate) fn way_out(
    bodies: &Bodies,
    group: &[usize],
    others: &[bool],
    options: MapOptions,
    watch: Watch,
) -> Result<Option<DVec3>, AssemblyError> {
    let mut mapper = Mapper::new(bodies, group, others.to_vec(), options, watch);
    mapper.ask()?;
    let farthest = mapper.rooms.iter().map(PartRoom::distance).fold(0.0, f64::max);
    let bounds = group.iter().map(|&k| bodies.bounds(k)).reduce(|a, b| a.join(&b));
    if farthest < FAR * bounds.map_or(0.0, |b| (b.high - b.low).max_element()) {
        return Ok(None);
    }
    for _ in 0..ROUNDS {
        if let Some(k) = mapper.rooms.iter().position(PartRoom::is_free) {
            return Ok(Some(mapper.sphere.directions[k]));
        }
        let cuts = mapper.changes();
        if cuts.is_empty() {
            return Ok(None);
        }
        mapper.cut(cuts)?;
    }
    let free = mapper.rooms.iter().position(PartRoom::is_free);
    Ok(free.map(|k| mapper.sphere.directions[k]))
}

impl Mapper<'_> {
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
