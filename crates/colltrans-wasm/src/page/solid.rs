//! Casts between two bodies, at least one of them a solid.

use colltrans::record::SolidClearanceRecord;
use colltrans::solid::{SolidCast, StartOverlap};
use colltrans::{Cast, Clearance, Solid};
use colltrans_mesh::body::cast_between;
use glam::DVec3;

use super::body::{Facets, Part};
use super::question::Pair;
use super::record::{CastAnswer, Proof};
use crate::answer::{Answer, Refusal};
use crate::highlight::{ContactHighlight, FeatureHighlight};
use crate::pose::pose;

/// Answers the question `cast` for solids.
pub(crate) fn cast_answer([moving, fixed]: [&Part; 2], pair: &Pair) -> Result<Answer, Refusal> {
    let (moving, fixed) = (moving.facets()?, fixed.facets()?);
    let cast = cast_of([moving, fixed], pair)?;
    let clearance = cast.clearance().map_err(|error| error.to_string())?;
    let (mut lit, mut proof) = (None, None);
    match &clearance {
        Clearance::Free(free) => proof = free.separation.map(Proof::Separation),
        Clearance::Overlapping(_) => {}
        Clearance::Blocked { contact, .. } => {
            lit = Some(ContactHighlight {
                moving: FeatureHighlight::from_feature(contact.moving_feature, cast.moving()),
                fixed: FeatureHighlight::from_feature(contact.fixed_feature, cast.fixed()),
            });
        }
    }
    Ok(Answer::from_facts(&CastAnswer {
        kind: "solid",
        record: SolidClearanceRecord::from_clearance(&clearance, cast.exit(), &cast),
        clearance: None,
        lit,
        proof,
        precision: Some(moving.precision + fixed.precision),
    }))
}

/// Builds the cast of a question.
pub(crate) fn cast_of<'a>(
    [moving, fixed]: [&'a Facets; 2],
    pair: &Pair,
) -> Result<Cast<'a, Solid>, Refusal> {
    let [moving_pose, fixed_pose] =
        [pose(pair.moving_pose, "moving")?, pose(pair.fixed_pose, "fixed")?];
    let direction = DVec3::from_array(pair.direction);
    let precisions = [moving.precision, fixed.precision];
    let start = if pair.ignore_overlaps { StartOverlap::Ignore } else { StartOverlap::Refuse };
    let (moving, fixed) = (moving.body.at(moving_pose), fixed.body.at(fixed_pose));
    let cast = cast_between(moving, fixed, direction, precisions, pair.tolerance, start);
    Ok(cast.map_err(|error| error.to_string())?)
}
