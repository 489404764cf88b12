//! Proofs of clearances between solids: built, sent to the page, and checked as received.

use colltrans::solid::{Cover, Reason, SolidCast, SolidCertificate, StartProof};
use colltrans::{Cast, Solid};
use serde::Serialize;

use super::body::{Facets, Part};
use super::convex::check_answer;
use super::question::Pair;
use super::record::Proof;
use super::solid::cast_of;
use crate::answer::{Answer, Refusal};

const REASONS: [(Reason, &str); 8] = [
    (Reason::MovingFacesAway, "facets of the moving body face away"),
    (Reason::FixedFacesAway, "facets of the fixed body face away"),
    (Reason::ShadowsApart, "their shadows are disjoint"),
    (Reason::Parting, "they move apart"),
    (Reason::NotBefore, "they meet no earlier"),
    (Reason::Examined, "examined facet by facet"),
    (Reason::Disjoint, "disjoint at the start"),
    (Reason::FaceToFace, "face to face in one plane"),
];

/// An answer to `certify`.
#[derive(Serialize)]
struct Certified<'a> {
    proof: Proof,
    /// The reasons why nothing stops the body earlier.
    claims: Vec<Claims<'a>>,
    /// The reasons why the bodies do not overlap at the start, if they do not.
    start_claims: Option<Vec<Claims<'a>>>,
}

/// A reason, the number of its uses, and the number of pairs of facets for which it is used.
#[derive(Serialize)]
struct Claims<'a> {
    because: &'a str,
    given: usize,
    pairs: f64,
}

/// Returns both bodies as solids.
fn facet_bodies([moving, fixed]: [&Part; 2]) -> Result<[&Facets; 2], Refusal> {
    Ok([moving.facets()?, fixed.facets()?])
}

/// Answers the question `certify`.
pub(crate) fn certify_clearance(bodies: [&Part; 2], pair: &Pair) -> Result<Answer, Refusal> {
    let cast = cast_of(facet_bodies(bodies)?, pair)?;
    let (_, certificate) = cast.certified_clearance().map_err(|error| error.to_string())?;
    let SolidCertificate { start, cover, .. } = &certificate;
    let apart = if let StartProof::Apart(cover) = start { Some(cover) } else { None };
    Ok(Answer::from_facts(&Certified {
        claims: count_claims(cover, &cast),
        start_claims: apart.map(|cover| count_claims(cover, &cast)),
        proof: Proof::Clearance(certificate),
    }))
}

/// Counts the claims of a cover by reason.
fn count_claims(cover: &Cover, cast: &Cast<'_, Solid>) -> Vec<Claims<'static>> {
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

/// Checks a proof, as received, with the two solids alone.
pub(crate) fn verify(bodies: [&Part; 2], pair: &Pair, proof: &Proof) -> Result<Answer, Refusal> {
    let cast = cast_of(facet_bodies(bodies)?, pair)?;
    Ok(check_answer(match proof {
        Proof::Separation(separation) => cast.verify(separation),
        Proof::Clearance(certificate) => cast.verify(certificate),
        Proof::Contact(_) => return Err("the proof is about convex bodies".to_owned().into()),
    }))
}
