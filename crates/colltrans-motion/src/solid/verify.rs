//! Checks proofs about solids in motion without a search.
//!
//! Each entry of a cover is checked on its own: the plane that it names, or its list, which is checked like one of
//! convex bodies. An overlap at the start is checked as for a cast, a contact at its time.

use glam::DVec3;

use super::super::proof::{
    Entry, FacetContact, FacetContactProof, SolidMotionProof, SpanProof, interval_middle,
};
use super::super::span::{Span, split_into_spans};
use super::super::verify::{MotionProofError, check_planes};
use super::facets;
use super::inside;
use super::tree::{NodeContent, PartHull, SolidTree};
use super::window::{Snapshot, SpanFrame, TreePart};
use crate::MotionCast;
use colltrans_convex::answer::are_weights;
use colltrans_solid::SolidScene;
use colltrans_solid::body::Solid;
use colltrans_solid::cast::StartProof;

/// Checks a proof about solids. Returns the time up to which they do not meet, and the time at which they do, or
/// infinity.
pub(super) fn verify(
    cast: &MotionCast<Solid>,
    proof: &SolidMotionProof,
) -> Result<[f64; 2], MotionProofError> {
    let (claimed, asked) = (proof.tolerance, cast.tolerance());
    if claimed != asked {
        return Err(MotionProofError::Tolerance { claimed, requested: asked });
    }
    let start = cast.start_cast().ok();
    let scene = start.as_ref().and_then(|start| Some((start, start.checked_query_scene().ok()?)));
    let Some((start, scene)) = scene else { return Err(MotionProofError::Start) };
    if matches!(proof.start, StartProof::Assumed)
        || start.verify_start(&scene, &proof.start).is_err()
    {
        return Err(MotionProofError::Start);
    }
    if matches!(proof.start, StartProof::Overlapping(_)) {
        let plain = proof.spans.is_empty() && proof.meeting.is_none();
        return if plain { Ok([0.0; 2]) } else { Err(MotionProofError::Start) };
    }
    let trees = cast.shrunk_trees(claimed);
    let all = split_into_spans(trees.each_ref(), cast.motions(), cast.min_gap);
    if proof.spans.len() > all.len() {
        return Err(MotionProofError::Cover { span: all.len(), entry: 0 });
    }
    let mut reached = 0.0;
    for (which, (span, part)) in all.iter().zip(&proof.spans).enumerate() {
        let is_within = reached == span.from && (span.from..=span.to).contains(&part.until);
        let covered = if is_within { check_cover(span, part) } else { Err(0) };
        covered.map_err(|entry| MotionProofError::Cover { span: which, entry })?;
        reached = part.until;
    }
    let Some(meeting) = &proof.meeting else { return Ok([reached, f64::INFINITY]) };
    let FacetContact { time, .. } = *meeting;
    let span = all.get(proof.spans.len().wrapping_sub(1));
    let meets = span.is_some_and(|span| time >= reached && is_contact_proven(span, meeting));
    if meets { Ok([reached, time]) } else { Err(MotionProofError::Meeting { time, reason: None }) }
}

/// Traverses both trees and the time as the entries direct, and checks each entry.
///
/// # Errors
/// Returns the index of the entry that does not hold, or at which the cover does not fit the trees.
fn check_cover(
    span: &Span<SolidTree>,
    SpanProof { until, cover, lists }: &SpanProof,
) -> Result<(), usize> {
    if *until == span.from {
        return if cover.is_empty() && lists.is_empty() { Ok(()) } else { Err(0) };
    }
    let span = span.ending_at(*until);
    let frame = SpanFrame::new(&span);
    let trees = [span.body(0), span.body(1)];
    let mut lists = lists.iter();
    let mut stack = vec![([0, 0], [frame.snapshot_at(span.from), frame.snapshot_at(*until)])];
    for (number, entry) in cover.0.iter().enumerate() {
        let Some((at, ends)) = stack.pop() else { return Err(number) };
        match *entry {
            Entry::Halved => {
                let half = frame.snapshot_at(interval_middle(ends[0].time, ends[1].time));
                stack.extend([(at, [half, ends[1]]), (at, [ends[0], half])]);
            }
            Entry::Split(which) => {
                let which = usize::from(which);
                let NodeContent::Children([first, second]) = trees[which].node(at[which]).content
                else {
                    return Err(number);
                };
                let part = |k: u32| if which == 0 { [k, at[1]] } else { [at[0], k] };
                stack.extend([(part(second), ends), (part(first), ends)]);
            }
            Entry::Separated(plane) => {
                let parts = [0, 1].map(|k| TreePart::at_node(trees[k], at[k]));
                let ends = [&ends[0], &ends[1]];
                let window = frame.window(ends, parts.each_ref());
                if !window.is_separated_by(plane) {
                    return Err(number);
                }
            }
            Entry::PlaneList => {
                let parts = [0, 1].map(|k| trees[k].part_hull(at[k]));
                let holds = is_separated_by_list(&span, parts.each_ref(), &ends, lists.next());
                if !holds {
                    return Err(number);
                }
            }
        }
    }
    if stack.is_empty() && lists.next().is_none() { Ok(()) } else { Err(cover.len()) }
}

/// Checks whether a list of planes separates all facets of two parts throughout an interval.
fn is_separated_by_list(
    span: &Span<SolidTree>,
    parts: [&PartHull; 2],
    ends: &[Snapshot; 2],
    planes: Option<&Vec<super::super::TimedPlane>>,
) -> bool {
    let Some(planes) = planes else { return false };
    let [from, to] = [ends[0].time, ends[1].time];
    let reaches = planes.first().is_some_and(|plane| plane.time == from)
        && planes.last().is_some_and(|plane| plane.time == to);
    reaches && check_planes(&span.part_span(parts, [from, to]), planes).is_ok()
}

/// Checks whether the facets or the solids meet at the claimed time.
fn is_contact_proven(
    span: &Span<SolidTree>,
    FacetContact { time, triangles, met }: &FacetContact,
) -> bool {
    let is_facet = |k: usize| (triangles[k] as usize) < span.body(k).solid.triangles().len();
    if !(is_facet(0) && is_facet(1) && (span.from..=span.to).contains(time)) {
        return false;
    }
    let bodies = span.instant_at(*time).bodies;
    let off = bodies.noise().point_error() + span.error;
    let is_without_gap = bodies.core_gap_bounds(span.min_gap) == [0.0; 2];
    match *met {
        FacetContactProof::Inside { point } => {
            return is_without_gap
                && inside::is_inside_both(&bodies, off, DVec3::from_array(point));
        }
        FacetContactProof::Contained { moving, weights } => {
            let k = usize::from(!moving);
            let facet = span.body(k).facet(triangles[k]).corners;
            return is_without_gap
                && are_weights(&weights)
                && inside::is_point_inside(&bodies, off, moving, &facet, weights);
        }
        FacetContactProof::Crossing { .. } | FacetContactProof::Near { .. } => {}
    }
    let [f, g] = [0, 1].map(|k| span.body(k).facet(triangles[k]));
    let part = span.part_span([&f, &g], [span.from, span.to]);
    facets::is_contact_proven(&part.instant_at(*time).bodies, [part.min_gap, part.error], *met)
}
