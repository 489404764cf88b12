//! Casts between convex bodies, and the check of their proofs.

use colltrans::record::{CastRecord, ClearanceRecord};
use colltrans::{Cast, CertificateError, ContactRange, Features, Options};
use glam::DVec3;
use serde_json::json;

use super::body::Hull;
use super::question::Pair;
use super::record::{CastAnswer, Proof};
use crate::answer::{Answer, Refusal};
use crate::highlight::{ContactHighlight, FeatureHighlight};
use crate::pose::pose;

/// Builds the cast of a question.
pub(crate) fn cast_of<'a>(
    [moving, fixed]: [&'a Hull; 2],
    pair: &Pair,
) -> Result<Cast<'a>, Refusal> {
    let moving = moving.body.at(pose(pair.moving_pose, "moving")?);
    let fixed = fixed.body.at(pose(pair.fixed_pose, "fixed")?);
    let options = Options::default()
        .with_solver(pair.solver)
        .with_narrowing(pair.narrowing)
        .with_graze_tolerance(pair.graze);
    let cast = Cast::new(moving, fixed, DVec3::from_array(pair.direction));
    Ok(cast.and_then(|cast| cast.with_options(options)).map_err(|error| error.to_string())?)
}

/// Answers the question `cast` for convex bodies.
pub(crate) fn cast_answer(bodies: [&Hull; 2], pair: &Pair) -> Result<Answer, Refusal> {
    let cast = cast_of(bodies, pair)?;
    let range = cast.contact_range().map_err(|error| error.to_string())?;
    let clearance = cast.clearance().map_err(|error| error.to_string())?;
    let first = match &range {
        ContactRange::Contact { first, .. } => Ok(first),
        ContactRange::Grazing { first, .. } => Ok(&first.contact),
        ContactRange::Separated(separated) => Err(separated.certificate),
    };
    Ok(Answer::from_facts(&CastAnswer {
        kind: "convex",
        record: CastRecord::of_range(&range, &cast),
        clearance: Some(ClearanceRecord::from_clearance(&clearance, &cast)),
        lit: first.ok().map(|contact| {
            let Features { moving, fixed } = contact.features(&cast);
            ContactHighlight {
                moving: FeatureHighlight::from_feature(moving, cast.moving()),
                fixed: FeatureHighlight::from_feature(fixed, cast.fixed()),
            }
        }),
        proof: Some(
            first.map_or_else(Proof::Separation, |contact| Proof::Contact(contact.certificate)),
        ),
        precision: None,
    }))
}

/// Checks a proof, as received, with the two bodies alone.
pub(crate) fn verify(bodies: [&Hull; 2], pair: &Pair, proof: &Proof) -> Result<Answer, Refusal> {
    let cast = cast_of(bodies, pair)?;
    let checked = match proof {
        Proof::Contact(certificate) => cast.verify(certificate),
        Proof::Separation(separation) => cast.verify(separation),
        #[cfg(feature = "min-gap")]
        Proof::Clearance(_) => return Err("the proof is about solids".to_owned().into()),
    };
    Ok(check_answer(checked))
}

/// Returns the result of a check.
pub(crate) fn check_answer(checked: Result<f64, CertificateError>) -> Answer {
    Answer::from_facts(&match checked {
        Ok(proven) => json!({ "holds": true, "proven": proven }),
        Err(error) => json!({ "holds": false, "because": error.to_string() }),
    })
}
