//! Casts between bodies of which at least one need not be convex.

use colltrans::record::SolidClearanceRecord;
use colltrans::solid::{SolidCast, StartOverlap};
use colltrans::{Cast, Clearance, Solid};
use colltrans_mesh::body::between;
use glam::DVec3;

use super::body::{Facets, Part};
use super::question::Pair;
use super::record::{CastAnswer, Proof};
use crate::answer::{Answer, Refusal};
use crate::lit::{Lit, Touching};
use crate::pose::pose;

pub(crate) fn cast([moving, fixed]: [&Part; 2], pair: &Pair) -> Result<Answer, Refusal> {
    let (moving, fixed) = (moving.facets()?, fixed.facets()?);
    let cast = query([moving, fixed], pair)?;
    let clearance = cast.clearance().map_err(|error| error.to_string())?;
    let (mut lit, mut proof) = (None, None);
    match &clearance {
        Clearance::Free(free) => proof = free.separation.map(Proof::Separation),
        Clearance::Overlapping(_) => {}
        Clearance::Blocked { contact, .. } => {
            lit = Some(Touching {
                moving: Lit::of(contact.moving_feature, cast.moving()),
                fixed: Lit::of(contact.fixed_feature, cast.fixed()),
            });
        }
    }
    Ok(Answer::of(&CastAnswer {
        kind: "solid",
        record: SolidClearanceRecord::of(&clearance, cast.exit(), &cast).into(),
        clearance: None,
        lit,
        proof,
        precision: Some(moving.precision + fixed.precision),
    }))
}

/// The query that a question asks.
pub(crate) fn query<'a>(
    [moving, fixed]: [&'a Facets; 2],
    pair: &Pair,
) -> Result<Cast<'a, Solid>, Refusal> {
    let [moving_pose, fixed_pose] =
        [pose(pair.moving_pose, "moving")?, pose(pair.fixed_pose, "fixed")?];
    let direction = DVec3::from_array(pair.direction);
    let precisions = [moving.precision, fixed.precision];
    let start = if pair.ignore_overlaps { StartOverlap::Ignore } else { StartOverlap::Refuse };
    let (moving, fixed) = (moving.body.at(moving_pose), fixed.body.at(fixed_pose));
    let cast = between(moving, fixed, direction, precisions, pair.tolerance, start);
    Ok(cast.map_err(|error| error.to_string())?)
}
