//! Pairs of facets that met, kept to be asked again.
//!
//! What blocks is a pair of facets, whatever else the bodies have: if the pair blocks along another
//! direction, so do the bodies, there or earlier. A cast of two facets costs about a hundredth of one
//! of two bodies, and what stopped a part along one direction stops it along many. So where it is
//! enough to know that something is in the way, known pairs are asked first. They never say "free".

use std::collections::HashMap;

use colltrans::solid::{StartOverlap, Workspace};
use glam::DVec3;

use crate::bodies::{Bodies, Room, Stop};

/// Facets of two parts that met along some direction.
struct Witness {
    triangles: [u32; 2],
    /// The contact normal.
    normal: DVec3,
}

/// Kept for an ordered pair of parts, at most.
const MOST: usize = 24;
/// Cosine below which a contact is not asked again: along it, it hardly blocks.
const ASKEW: f64 = 0.02;

/// Facets that met, by ordered pairs of parts.
#[derive(Default)]
pub(crate) struct Witnesses(HashMap<[usize; 2], Vec<Witness>>);

impl Witnesses {
    /// Keeps the facets of a stop.
    pub(crate) fn keep(&mut self, pair: [usize; 2], stop: &Stop) {
        let kept = self.0.entry(pair).or_default();
        if kept.len() >= MOST || kept.iter().any(|w| w.triangles == stop.triangles) {
            return;
        }
        kept.push(Witness { triangles: stop.triangles, normal: stop.normal });
    }

    /// A stop along `d` not beyond a distance, if known facets show one.
    pub(crate) fn stop(
        &self,
        bodies: &Bodies,
        pair: [usize; 2],
        d: DVec3,
        within: f64,
        start: StartOverlap,
    ) -> Option<Stop> {
        let kept = self.0.get(&pair)?.iter().filter(|w| w.normal.dot(d) > ASKEW);
        kept.filter_map(|w| bodies.stop_by(pair, w.triangles, d, start))
            .find(|stop| stop.displaced.value <= within)
    }
}

/// What is kept from one question to the next, where it is asked only whether something is in the way.
#[derive(Default)]
pub(crate) struct Memory {
    workspace: Workspace,
    witnesses: Witnesses,
}

impl Memory {
    /// Whether a part ever meets another one along a unit direction.
    pub(crate) fn meets(
        &mut self,
        bodies: &Bodies,
        pair: [usize; 2],
        d: DVec3,
        start: StartOverlap,
    ) -> bool {
        let Self { workspace, witnesses } = self;
        if witnesses.stop(bodies, pair, d, f64::INFINITY, start).is_some() {
            return true;
        }
        let room = bodies.room(pair, d, None, start, workspace);
        if let Room::Blocked(stop) = &room {
            witnesses.keep(pair, stop);
        }
        room != Room::Free
    }

    /// Whether a group never meets any part that is there, and not of the group.
    pub(crate) fn is_free(
        &mut self,
        bodies: &Bodies,
        group: &[usize],
        there: &[bool],
        d: DVec3,
        start: StartOverlap,
    ) -> bool {
        let ahead = bodies.pairs_ahead(group, d, there);
        !ahead.into_iter().any(|pair| self.meets(bodies, pair, d, start))
    }
}
