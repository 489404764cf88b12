//! Proofs of answers between solids: made, told entry by entry, and checked as they were told.
//!
//! Numbers of an answer: a byte for each entry of the proof that the bodies do not overlap at the
//! start, then for each of the proof that nothing stops the body before: 0 where a pair of nodes was
//! split, else the reason's number in [`REASONS`], from 1 on.

use colltrans::solid::{Cover, Overlap, Reason, SolidCertificate, StartProof};
use colltrans::{Cast, Solid};
use serde_json::{Value, json};

use crate::answer::{Answer, Refusal};
use crate::body::{Facets, Part};
use crate::convex::judged;
use crate::question::{Claimed, Pair, Proof};
use crate::solid::query;

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

fn facets([moving, fixed]: [&Part; 2]) -> Result<[&Facets; 2], Refusal> {
    Ok([moving.facets()?, fixed.facets()?])
}

pub(crate) fn certify(bodies: [&Part; 2], pair: &Pair) -> Result<Answer, Refusal> {
    let cast = query(facets(bodies)?, pair)?;
    let (_, certificate) = cast.certified_clearance().map_err(|error| error.to_string())?;
    let (overlap, start): (Value, Option<&Cover>) = match &certificate.start {
        StartProof::Assumed => (Value::Null, None),
        StartProof::Apart(cover) => (Value::Null, Some(cover)),
        StartProof::Overlapping(overlap) => (told(*overlap), None),
    };
    let claims = |cover: Option<&Cover>| cover.map(|cover| counted(cover, &cast));
    let mut answer = Answer::of(&json!({
        "tolerance": certificate.tolerance,
        // Infinite where nothing ever stops the body, which JSON writes as null.
        "lower": certificate.lower,
        "stop": certificate.stop.map(|s| json!({ "shrunk_distance": s.shrunk_distance, "triangles": s.triangles })),
        "overlap": overlap,
        "start_entries": start.map_or(0, Cover::len),
        "start_claims": claims(start),
        "claims": claims(Some(&certificate.cover)),
    }));
    for cover in start.into_iter().chain([&certificate.cover]) {
        answer.numbers.extend(cover.entries().iter().map(|entry| byte(*entry)));
    }
    Ok(answer)
}

fn byte(entry: Option<Reason>) -> u8 {
    let number = |reason| REASONS.iter().position(|(r, _)| *r == reason);
    entry.and_then(number).map_or(0, |k| k as u8 + 1)
}

/// For each reason how often it is given, and about how many pairs of facets.
fn counted(cover: &Cover, cast: &Cast<'_, Solid>) -> Value {
    let claims = cover.claims(cast).unwrap_or_default();
    let row = |(reason, words): &(Reason, &str)| {
        let given = claims.iter().filter(|claim| claim.reason == *reason);
        let (count, pairs) = given.fold((0_usize, 0.0), |(count, pairs), claim| {
            (count + 1, pairs + claim.moving.len() as f64 * claim.fixed.len() as f64)
        });
        (count > 0).then(|| json!({ "because": words, "claims": count, "pairs": pairs }))
    };
    REASONS.iter().filter_map(row).collect()
}

fn told(overlap: Overlap) -> Value {
    let (kind, triangles) = match overlap {
        Overlap::Facets(f, g) => ("facets", vec![f, g]),
        Overlap::MovingInside(f) => ("moving inside", vec![f]),
        Overlap::FixedInside(g) => ("fixed inside", vec![g]),
    };
    json!({ "kind": kind, "triangles": triangles })
}

/// Checks a proof as it was written, against the two solids alone.
pub(crate) fn verify(
    bodies: [&Part; 2],
    pair: &Pair,
    proof: &Proof,
    entries: &[u8],
) -> Result<Answer, Refusal> {
    let cast = query(facets(bodies)?, pair)?;
    Ok(judged(match proof {
        Proof::Separation(separation) => cast.verify(separation),
        Proof::Clearance(claimed) => cast.verify(&certificate(claimed, entries)?),
        Proof::Contact(_) => return Err("that is a proof between convex bodies".to_owned().into()),
    }))
}

fn certificate(claimed: &Claimed, entries: &[u8]) -> Result<SolidCertificate, Refusal> {
    let start = claimed.start_entries;
    if start > entries.len() {
        return Err(format!("of {start} entries only {} are there", entries.len()).into());
    }
    let (before, after) = entries.split_at(start);
    let start = match &claimed.overlap {
        Some((kind, triangles)) => StartProof::Overlapping(overlap(kind, triangles)?),
        None if before.is_empty() => StartProof::Assumed,
        None => StartProof::Apart(cover(before)?),
    };
    Ok(SolidCertificate {
        tolerance: claimed.tolerance,
        start,
        lower: claimed.lower,
        stop: claimed.stop,
        cover: cover(after)?,
    })
}

fn cover(bytes: &[u8]) -> Result<Cover, Refusal> {
    let entry = |byte: &u8| match *byte {
        0 => Ok(None),
        k => REASONS.get(usize::from(k) - 1).map(|(reason, _)| Some(*reason)).ok_or(k),
    };
    let entries: Result<Vec<Option<Reason>>, u8> = bytes.iter().map(entry).collect();
    Ok(entries.map_err(|k| format!("there is no reason {k}"))?.into())
}

fn overlap(kind: &str, triangles: &[u32]) -> Result<Overlap, Refusal> {
    match (kind, triangles) {
        ("facets", [f, g]) => Ok(Overlap::Facets(*f, *g)),
        ("moving inside", [f]) => Ok(Overlap::MovingInside(*f)),
        ("fixed inside", [g]) => Ok(Overlap::FixedInside(*g)),
        _ => Err(format!("there is no overlap {kind} of {} triangles", triangles.len()).into()),
    }
}
