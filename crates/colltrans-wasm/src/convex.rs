//! Casts between convex bodies, and the check of their proofs.

use colltrans::observe::Recording;
use colltrans::{
    Cast, CertificateError, Clearance, Contact, ContactRange, Options, Solver, Steps, WhyFree,
};
use glam::DVec3;
use serde_json::{Value, json};

use crate::answer::{Answer, Refusal};
use crate::body::{Hull, Lit};
use crate::pose::pose;
use crate::question::{Pair, Proof};

/// The query that a question asks.
pub(crate) fn query<'a>([moving, fixed]: [&'a Hull; 2], pair: &Pair) -> Result<Cast<'a>, Refusal> {
    let moving = moving.body.at(pose(pair.moving_pose, "moving")?);
    let fixed = fixed.body.at(pose(pair.fixed_pose, "fixed")?);
    let options = Options::default().with_solver(pair.solver).with_graze_tolerance(pair.graze);
    let cast = Cast::new(moving, fixed, DVec3::from_array(pair.direction));
    Ok(cast.and_then(|cast| cast.with_options(options)).map_err(|error| error.to_string())?)
}

pub(crate) fn work(solver: Solver, steps: &Steps) -> Value {
    json!({
        "solver": solver.name(),
        "planar_problems": steps.planar_problems,
        "supports": steps.supports,
        "pivots": steps.pivots,
        "iterations": steps.iterations,
    })
}

/// A contact, with its proof.
fn touch(contact: &Contact, cast: &Cast) -> Value {
    let (points, features) = (contact.points(cast), contact.features(cast));
    let proof = &contact.certificate;
    json!({
        "t": contact.translation,
        "normal": contact.normal.to_array(),
        "on_moving": points.on_moving.to_array(),
        "on_fixed": points.on_fixed.to_array(),
        "moving": Lit::of(features.moving, cast.moving()).told(),
        "fixed": Lit::of(features.fixed, cast.fixed()).told(),
        "proof": {
            "normal": proof.normal.to_array(),
            "lower": proof.lower,
            // Infinite where there is none, which JSON writes as null.
            "upper": proof.upper,
            "pairs": proof.pairs.map(|pair| [pair.moving, pair.fixed]),
            "weights": proof.weights,
            "rounding": proof.rounding,
        },
    })
}

pub(crate) fn cast(bodies: [&Hull; 2], pair: &Pair) -> Result<Answer, Refusal> {
    let cast = query(bodies, pair)?;
    // Everything here is asked with a recording, so that each solver is in the page once.
    let seen = &mut Recording::default();
    let range = cast.contact_range_observed(seen).map_err(|error| error.to_string())?;
    seen.clear();
    let clearance = cast.clearance_observed(seen).map_err(|error| error.to_string())?;
    let exit = match &range {
        ContactRange::Contact { last, .. } => Some(last.exit()),
        ContactRange::Grazing { last, .. } => Some(last.contact.exit()),
        ContactRange::Separated(_) => None,
    };
    let exit_bounds = exit.map(|exit| exit.bounds());
    let exit = exit.map(|exit| exit.value);
    let free = free(&clearance);
    let told = match range {
        ContactRange::Contact { first, .. } => json!({
            "kind": "convex",
            "outcome": "contact",
            "first": touch(&first, &cast),
            "exit": exit,
            "exit_bounds": exit_bounds,
            "clearance": free,
            "steps": work(first.solver, &first.steps),
        }),
        ContactRange::Grazing { first, .. } => json!({
            "kind": "convex",
            "outcome": "grazing",
            "first": touch(&first.contact, &cast),
            "exit": exit,
            "exit_bounds": exit_bounds,
            "overlap": first.overlap,
            "sideways": first.separating_direction.to_array(),
            "clearance": free,
            "steps": work(first.contact.solver, &first.contact.steps),
        }),
        ContactRange::Separated(separated) => json!({
            "kind": "convex",
            "outcome": "separated",
            "sideways": separated.certificate.normal.to_array(),
            "margin": separated.certificate.margin,
            "clearance": free,
            "steps": work(separated.solver, &separated.steps),
        }),
    };
    Ok(Answer::of(&told))
}

/// How far the moving body can go from where it is; no distance where nothing stops it.
fn free(clearance: &Clearance) -> Value {
    let kind = match clearance {
        Clearance::Blocked { .. } => "blocked",
        Clearance::Free(WhyFree::Slides(_)) => "slides",
        Clearance::Free(WhyFree::Behind(_)) => "behind",
        Clearance::Free(WhyFree::Separated(_)) => "separated",
        Clearance::Overlapping(_) => "overlapping",
    };
    json!({ "kind": kind, "distance": clearance.distance().filter(|d| d.is_finite()) })
}

/// Checks a proof as it was written, against the two bodies alone.
pub(crate) fn verify(bodies: [&Hull; 2], pair: &Pair, proof: &Proof) -> Result<Answer, Refusal> {
    let cast = query(bodies, pair)?;
    let checked = match proof {
        Proof::Contact(certificate) => cast.verify(certificate),
        Proof::Separation(separation) => cast.verify(separation),
        Proof::Clearance(_) => return Err("that is a proof between solids".to_owned().into()),
    };
    Ok(judged(checked))
}

/// What came of a check.
pub(crate) fn judged(checked: Result<f64, CertificateError>) -> Answer {
    Answer::of(&match checked {
        Ok(proven) => json!({ "holds": true, "proven": proven }),
        Err(error) => json!({ "holds": false, "because": error.to_string() }),
    })
}
