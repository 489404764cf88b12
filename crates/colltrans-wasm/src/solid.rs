//! Casts between bodies of which at least one need not be convex.

use colltrans::solid::StartOverlap;
use colltrans::{Cast, Clearance, Solid};
use colltrans_mesh::body::between;
use glam::DVec3;
use serde_json::{Value, json};

use crate::answer::{Answer, Refusal};
use crate::body::{Facets, Lit, Part};
use crate::pose::pose;
use crate::question::Pair;

pub(crate) fn cast([moving, fixed]: [&Part; 2], pair: &Pair) -> Result<Answer, Refusal> {
    let (moving, fixed) = (moving.facets()?, fixed.facets()?);
    let cast = query([moving, fixed], pair)?;
    let clearance = cast.clearance().map_err(|error| error.to_string())?;
    let exit = cast.exit();
    // Which bodies are open, at least in part.
    let named = [("moving", moving), ("fixed", fixed)].into_iter();
    let surfaces: Vec<&str> =
        named.filter_map(|(name, f)| (!f.body.is_closed()).then_some(name)).collect();
    let mut told = json!({
        "kind": "solid",
        "exit": exit.map(|exit| exit.value),
        "exit_bounds": exit.map(|exit| exit.bounds()),
        "tolerance": cast.options().tolerance,
        "precision": moving.precision + fixed.precision,
        "surfaces": surfaces,
    });
    let more: Value = match clearance {
        Clearance::Free(free) => json!({
            "outcome": "free",
            "sideways": free.separation.map(|plane| plane.normal.to_array()),
            "margin": free.separation.map(|plane| plane.margin),
        }),
        Clearance::Overlapping(overlap) => {
            json!({ "outcome": "overlapping", "depth": overlap.least_tolerance })
        }
        Clearance::Blocked { distance, contact } => {
            json!({
                "outcome": "blocked",
                "distance": distance,
                "bounds": contact.translation.bounds(),
                "shrunk_distance": contact.shrunk_distance.value,
                "shrunk_distance_bounds": contact.shrunk_distance.bounds(),
                "first": {
                    "t": contact.translation.value,
                    "normal": contact.normal.to_array(),
                    "on_moving": contact.point_on_moving.to_array(),
                    "on_fixed": contact.point_on_fixed.to_array(),
                    "moving": Lit::of(contact.moving_feature, &moving.body).told(),
                    "fixed": Lit::of(contact.fixed_feature, &fixed.body).told(),
                },
            })
        }
    };
    if let (Value::Object(told), Value::Object(more)) = (&mut told, more) {
        told.extend(more);
    }
    Ok(Answer::of(&told))
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
