//! Proves that two solids meet at one time: two facets cross, or a point is inside both. With a minimum gap or a radius,
//! the cores of two facets must have points that are not farther apart than the gap plus both radii.
//!
//! All pairs of facets that no plane separates at this time are tested, not only the pair that ended the search. This
//! is necessary because two facets that have passed each other are separated again, for example those of a face that
//! has sunk into another one. A point or a segment that is entirely inside a solid crosses no facet either, so whether
//! it is inside is tested as well.

use super::super::crossing_time::ContactState;
use super::super::proof::{FacetContactProof, PlaneName};
use super::super::sample::Sampler;
use super::facets::{FacetSampler, placed_corners};
use super::inside::{Contained, Guesses, find_contained_point};
use super::search::{find_separating_plane, split_larger_node};
use super::tree::NodeContent;
use super::window::{SpanFrame, TreePart};

/// Searches both trees for a proof that the solids meet at a time.
pub(super) fn contact_state_at(
    frame: &SpanFrame,
    time: f64,
    sampler: &mut FacetSampler,
) -> ContactState<([u32; 2], FacetContactProof)> {
    let trees = [frame.span.body(0), frame.span.body(1)];
    let snap = frame.snapshot_at(time);
    let mut state = ContactState::Apart;
    let (mut stack, mut guesses) = (vec![[0, 0]], Guesses::default());
    let bodies = frame.span.instant_at(time).bodies;
    let off = bodies.noise().point_error() + frame.span.error;
    while let Some(at) = stack.pop() {
        let parts = [0, 1].map(|k| TreePart::at_node(trees[k], at[k]));
        let window = frame.window([&snap, &snap], parts.each_ref());
        let facets = parts.each_ref().map(TreePart::facet);
        let is_separated =
            find_separating_plane(&window, facets.map(|facet| facet.is_some()), PlaneName::Middles)
                .is_some();
        let nodes = [0, 1].map(|k| trees[k].node(at[k]));
        if let ([Some(f), Some(g)], [NodeContent::Facet(s), NodeContent::Facet(t)]) =
            (facets, nodes.map(|node| node.content))
        {
            let span = frame.span.part_span([f, g], [frame.span.from, frame.span.to]);
            let [own, other] = placed_corners(&span.instant_at(time).bodies);
            guesses.add_facets([s, t], [&own, &other], off);
            if is_separated {
                continue;
            }
            if let Some(met) = sampler.prove_contact(&span, time) {
                return ContactState::Met(([s, t], met));
            }
            if !sampler.sample(&span, time).is_apart() {
                state = ContactState::Undecided;
            }
        } else if let Some((_, pairs)) =
            split_larger_node(at, nodes.each_ref()).filter(|_| !is_separated)
        {
            stack.extend(pairs);
        }
    }
    if frame.core_gap > 0.0 {
        return state;
    }
    match find_contained_point(&bodies, off) {
        Contained::Met(met) => return ContactState::Met(([0, 0], met)),
        Contained::Barely => return ContactState::Undecided,
        Contained::None => {}
    }
    if let ContactState::Undecided = state
        && let Some((pair, point)) = guesses.interior_point(&bodies, off)
    {
        return ContactState::Met((pair, FacetContactProof::Inside { point: point.to_array() }));
    }
    state
}
