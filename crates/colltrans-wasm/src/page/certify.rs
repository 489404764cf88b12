//! Proofs of answers between solids: made, told, and checked as they were told.

use colltrans::solid::{Cover, Reason, SolidCast, SolidCertificate, StartProof};
use colltrans::{Cast, Solid};
use serde::Serialize;

use super::body::{Facets, Part};
use super::convex::judged;
use super::question::Pair;
use super::record::Proof;
use super::solid::query;
use crate::answer::{Answer, Refusal};

const REASONS: [(Reason, &str); 8] = [
    (Reason::MovingFacesAway, "facets of the moving body look away"),
    (Reason::FixedFacesAway, "facets of the fixed body look away"),
    (Reason::ShadowsApart, "their shadows are apart"),
    (Reason::Parting, "they part"),
    (Reason::NotBefore, "they meet no earlier"),
    (Reason::Examined, "looked at facet by facet"),
    (Reason::Disjoint, "apart where they are"),
    (Reason::FaceToFace, "face to face in one plane"),
];

/// An answer to `certify`.
#[derive(Serialize)]
struct Certified<'a> {
    proof: Proof,
    /// Why nothing stops the body before.
    claims: Vec<Claims<'a>>,
    /// Why the bodies do not overlap where they are, if they do not.
    start_claims: Option<Vec<Claims<'a>>>,
}

/// One reason: how often it is given, about how many pairs of facets.
#[derive(Serialize)]
struct Claims<'a> {
    because: &'a str,
    given: usize,
    pairs: f64,
}

fn facets([moving, fixed]: [&Part; 2]) -> Result<[&Facets; 2], Refusal> {
    Ok([moving.facets()?, fixed.facets()?])
}

pub(crate) fn certify(bodies: [&Part; 2], pair: &Pair) -> Result<Answer, Refusal> {
    let cast = query(facets(bodies)?, pair)?;
    let (_, certificate) = cast.certified_clearance().map_err(|error| error.to_string())?;
    let SolidCertificate { start, cover, .. } = &certificate;
    let apart = if let StartProof::Apart(cover) = start { Some(cover) } else { None };
    Ok(Answer::of(&Certified {
        claims: counted(cover, &cast),
        start_claims: apart.map(|cover| counted(cover, &cast)),
        proof: Proof::Clearance(certificate),
    }))
}

fn counted(cover: &Cover, cast: &Cast<'_, Solid>) -> Vec<Claims<'static>> {
    let all = cover.claims(cast).unwrap_or_default();
    let row = |&(reason, because): &(Reason, &'static str)| {
        let given = all.iter().filter(|claim| claim.reason == reason);
        let (given, pairs) = given.fold((0, 0.0), |(count, pairs), claim| {
            (count + 1, pairs + claim.moving.len() as f64 * claim.fixed.len() as f64)
        });
        (given > 0).then_some(Claims { because, given, pairs })
    };
    REASONS.iter().filter_map(row).collect()
}

/// Checks a proof as it was written, against the two solids alone.
pub(crate) fn verify(bodies: [&Part; 2], pair: &Pair, proof: &Proof) -> Result<Answer, Refusal> {
    let cast = query(facets(bodies)?, pair)?;
    Ok(judged(match proof {
        Proof::Separation(separation) => cast.verify(separation),
        Proof::Clearance(certificate) => cast.verify(certificate),
        Proof::Contact(_) => return Err("that is a proof between convex bodies".to_owned().into()),
    }))
}
