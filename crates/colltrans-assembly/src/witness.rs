//! Memory of facet pairs that met, so that they are tested again first.
//!
//! If two facets collide along a direction, their bodies collide there too, at the same distance or earlier. A cast of
//! two facets costs about a hundredth of a cast of two bodies, and a pair that stops a part along one direction often
//! stops it along others. If only the existence of a blocker matters, known pairs are therefore tested first. They
//! never prove that a direction is free.

use std::collections::HashMap;

use colltrans::solid::{StartOverlap, Workspace};
use glam::DVec3;

use crate::bodies::{Bodies, FreeTravel, Stop};

/// A pair of facets that met along some direction.
struct Witness {
    triangles: [u32; 2],
    /// The contact normal.
    normal: DVec3,
}

/// Maximum number of facet pairs that are stored for an ordered pair of parts.
const MAX_WITNESSES: usize = 24;
/// Cosine between normal and direction below which a pair is not tested, because it hardly blocks there.
const MIN_COSINE: f64 = 0.02;

/// The facet pairs that met, for each ordered pair of parts.
#[derive(Default)]
pub(crate) struct Witnesses(HashMap<[usize; 2], Vec<Witness>>);

impl Witnesses {
    /// Stores the facets of a contact.
    pub(crate) fn store(&mut self, pair: [usize; 2], stop: &Stop) {
        let kept = self.0.entry(pair).or_default();
        if kept.len() >= MAX_WITNESSES || kept.iter().any(|w| w.triangles == stop.triangles) {
            return;
        }
        kept.push(Witness { triangles: stop.triangles, normal: stop.normal });
    }

    /// Returns a contact along `d` within a distance from the stored facets, or `None` if they give none.
    pub(crate) fn find_stop(
        &self,
        bodies: &Bodies,
        pair: [usize; 2],
        d: DVec3,
        within: f64,
        start: StartOverlap,
    ) -> Option<Stop> {
        let kept = self.0.get(&pair)?.iter().filter(|w| w.normal.dot(d) > MIN_COSINE);
        kept.filter_map(|w| bodies.stop_of_triangles(pair, w.triangles, d, start))
            .find(|stop| stop.shrunk_translation.value <= within)
    }
}

/// State that is reused between queries for the mere existence of a blocker.
#[derive(Default)]
pub(crate) struct Memory {
    workspace: Workspace,
    witnesses: Witnesses,
}

impl Memory {
    /// Checks whether a part ever meets another one along a direction of length 1.
    pub(crate) fn pair_meets(
        &mut self,
        bodies: &Bodies,
        pair: [usize; 2],
        d: DVec3,
        start: StartOverlap,
    ) -> bool {
        let Self { workspace, witnesses } = self;
        if witnesses.find_stop(bodies, pair, d, f64::INFINITY, start).is_some() {
            return true;
        }
        let room = bodies.free_travel(pair, d, None, start, workspace);
        if let FreeTravel::Blocked(stop) = &room {
            witnesses.store(pair, stop);
        }
        room != FreeTravel::Free
    }

    /// Checks whether a group never meets a present part outside of it.
    pub(crate) fn is_free(
        &mut self,
        bodies: &Bodies,
        group: &[usize],
        present: &[bool],
        d: DVec3,
        start: StartOverlap,
    ) -> bool {
        let ahead = bodies.pairs_ahead(group, d, present);
        !ahead.into_iter().any(|pair| self.pair_meets(bodies, pair, d, start))
    }
}
