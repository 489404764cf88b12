//! That two solids meet at one time, for certain: two facets do, of all that no plane parts then, or a point is inside both.
//!
//! Facets that have passed each other are apart again, as those of a face that has sunk into another: it is all pairs
//! that tell. So are those of a solid and a point or a segment that has gone in as a whole.

use super::super::look::Looker;
use super::super::soon::Seen;
use super::facets::{FacetLooker, corners};
use super::inside::{Contained, Guesses, contained};
use super::proof::FacetsMet;
use super::search::{parted, split};
use super::tree::Below;
use super::window::{Frame, Part, Plane};

/// Looks through both trees.
pub(super) fn seen(
    frame: &Frame,
    time: f64,
    looker: &mut FacetLooker,
) -> Seen<([u32; 2], FacetsMet)> {
    let trees = [frame.span.body(0), frame.span.body(1)];
    let snap = frame.snap(time);
    let mut all = Seen::Apart;
    let (mut stack, mut guesses) = (vec![[0, 0]], Guesses::default());
    let bodies = frame.span.instant(time).bodies;
    let off = bodies.noise().point() + frame.span.error;
    while let Some(at) = stack.pop() {
        let parts = [0, 1].map(|k| Part::of(trees[k], at[k]));
        let window = frame.window([&snap, &snap], parts.each_ref());
        let facets = parts.each_ref().map(Part::facet);
        let is_parted =
            parted(&window, facets.map(|facet| facet.is_some()), Plane::Middles).is_some();
        let nodes = [0, 1].map(|k| trees[k].node(at[k]));
        if let ([Some(f), Some(g)], [Below::Facet(s), Below::Facet(t)]) =
            (facets, nodes.map(|node| node.below))
        {
            let span = frame.span.part([f, g], [frame.span.from, frame.span.to]);
            let [own, other] = corners(&span.instant(time));
            guesses.take([s, t], [&own, &other], off);
            if is_parted {
                continue;
            }
            if let Some(met) = looker.met(&span, time) {
                return Seen::Met(([s, t], met));
            }
            if !looker.look(&span, time).is_apart() {
                all = Seen::Open;
            }
        } else if let Some((_, pairs)) = split(at, nodes).filter(|_| !is_parted) {
            stack.extend(pairs);
        }
    }
    if frame.span.keep > 0.0 {
        return all;
    }
    match contained(&bodies, off) {
        Contained::Met(met) => return Seen::Met(([0, 0], met)),
        Contained::Barely => return Seen::Open,
        Contained::None => {}
    }
    if let Seen::Open = all
        && let Some((pair, point)) = guesses.holding(&bodies, off)
    {
        return Seen::Met((pair, FacetsMet::Inside { point: point.to_array() }));
    }
    all
}
