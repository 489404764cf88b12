//! What is said of bodies, with its certificates, and how each is checked.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::error::ProofError;
use super::file::Along;
use super::proven::{Proven, Verify};
use colltrans_convex::answer::{
    Bounded, Certificate, CertificateError, Clearance, Contact, Depth, Distance, Grazing,
    NearPoints, PlaneGap, Separation, Within,
};
use colltrans_convex::body::{InputFacet, Placed};
use colltrans_convex::cast::Cast;
use colltrans_convex::cast::sideways::{proven_overlap, verified_overlap};
use colltrans_convex::pair::Pair;
use colltrans_convex::setting::error::QueryError;
use colltrans_removal::free::{CellProof, FreeDirections, FreeError, FreeProof, InnerBox};
use colltrans_solid::SolidCast;
use colltrans_solid::body::Solid;
use colltrans_solid::cast::{SolidCertificate, SolidOptions, StartOverlap, StartProof};
use colltrans_solid::pair::DistanceCertificate;
use colltrans_solid::solve::contact::SolidContact;
use colltrans_solid::solve::nearest::SolidNear;

/// Along which directions a solid can leave another one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FreeStatement {
    /// Both bodies are shrunk by half of this length.
    pub tolerance: f64,
    /// Whether facets that cross now count.
    pub start_overlap: StartOverlap,
    /// With a tolerance: the vertices of the shrunk bodies, in the order of the file, pieces run through.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shrunk: Option<[Vec<DVec3>; 2]>,
    /// Boxes inside the moving and inside the fixed body, where cells name some.
    #[serde(default, skip_serializing_if = "are_none")]
    pub boxes: [Vec<InnerBox>; 2],
    /// What is said of each cell of the sphere, as in [`FreeProof`]; pairs are facets by their numbers in the file,
    /// of the moving and of the fixed body, those of pieces run through.
    pub cells: Vec<CellProof>,
}

/// How far two convex bodies are apart: at least, or at most, or both.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DistanceStatement {
    /// Why they are not nearer.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gap: Option<PlaneGap>,
    /// Why they are not farther.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub near: Option<NearPoints>,
}

impl From<&Distance> for DistanceStatement {
    fn from(of: &Distance) -> Self {
        Self { gap: of.gap, near: Some(of.near) }
    }
}

impl From<&Within> for DistanceStatement {
    fn from(of: &Within) -> Self {
        match of {
            Within::Closer(near) => Self { near: Some(*near), gap: None },
            Within::Farther(gap) => Self { gap: Some(*gap), near: None },
            Within::Undecided(distance) => distance.into(),
        }
    }
}

/// The ends of the translations at which two convex bodies meet; one of them may be missing.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Contacts {
    /// Where the bodies slide along each other: that they hardly overlap, seen along the direction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub slide: Option<Slide>,
    /// Of the first contact, along the direction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub first: Option<Certificate>,
    /// Of the last one: the first of the [reversed](Cast::reversed) cast.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub last: Option<Certificate>,
}

/// How much of two convex bodies is in each other's way.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Slide {
    /// Unit normal in the world, orthogonal to the direction, from the moving body to the fixed one:
    /// [`Grazing::separating_direction`].
    pub normal: DVec3,
    /// At least `max_P n.p - min_Q n.q`, a length, wherever on its way the moving body is near the
    /// fixed one, and the gap that they are to keep; negative if they miss each other.
    pub overlap: f64,
}

/// What is said of two solids.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SolidStatement {
    /// What an overlap at the start means.
    pub start_overlap: StartOverlap,
    /// The proof for the bodies shrunk by half of its tolerance.
    pub certificate: SolidCertificate,
    /// What stops the moving body.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stop: Option<Stop>,
    /// A plane between the shrunk bodies.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub separation: Option<Separation>,
}

/// Two facets, and where they meet as they are.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stop {
    /// Their numbers in the file, of the moving and of the fixed body; those of pieces run through.
    pub facets: [InputFacet; 2],
    /// Where they meet in their true place: [`SolidContact::translation`](colltrans_solid::SolidContact::translation).
    pub translation: Bounded,
}

impl Stop {
    const fn refused(&self) -> CertificateError {
        let [moving, fixed] = self.facets;
        CertificateError::OtherFacets { moving, fixed }
    }
}

impl Slide {
    fn of(grazing: &Grazing, cast: &Cast<'_>) -> Self {
        let normal = grazing.separating_direction;
        Self { normal, overlap: proven_overlap(normal, cast) }
    }

    fn check(&self, cast: &Cast<'_>) -> Result<(), CertificateError> {
        let Self { normal, overlap: claimed } = *self;
        let proven = verified_overlap(normal, cast)?;
        if claimed >= proven { Ok(()) } else { Err(CertificateError::Bound { proven, claimed }) }
    }
}

impl Contacts {
    /// The contacts at the ends, those that there are.
    pub(super) fn between(first: Option<&Contact>, last: Option<&Contact>) -> Self {
        let [first, last] = [first, last].map(|end| end.map(|contact| contact.certificate));
        Self { slide: None, first, last }
    }

    /// Of bodies that slide along each other.
    pub(super) fn sliding(cast: &Cast<'_>, first: &Grazing, last: Option<&Grazing>) -> Self {
        let ends = Self::between(Some(&first.contact), last.map(|last| &last.contact));
        Self { slide: Some(Slide::of(first, cast)), ..ends }
    }

    /// The translation at which the bodies first meet, and the one at which they last do: at least,
    /// and at most.
    pub fn bounds(&self) -> [Option<[f64; 2]>; 2] {
        let first = self.first.map(|first| [first.lower, first.upper]);
        // Not -0.
        [first, self.last.map(|last| [0.0 - last.upper, 0.0 - last.lower])]
    }
}

/// The choices that count in a proof.
pub(super) fn options(start_overlap: StartOverlap, tolerance: f64, keep: f64) -> SolidOptions {
    let options = SolidOptions::default().with_start_overlap(start_overlap);
    options.with_tolerance(tolerance).with_keep(keep)
}

impl Verify<'_, Cast<'_>> for Contacts {
    fn verify(&self, cast: &Cast<'_>) -> Result<Proven<'static>, ProofError> {
        let Self { slide, first, last } = self;
        slide.map_or(Ok(()), |slide| slide.check(cast))?;
        first.map_or(Ok(0.0), |first| cast.verify(&first))?;
        last.map_or(Ok(0.0), |last| cast.reversed().verify(&last))?;
        Ok(Proven::Statement)
    }
}

impl Verify<'_, Cast<'_>> for Separation {
    fn verify(&self, cast: &Cast<'_>) -> Result<Proven<'static>, ProofError> {
        cast.verify(self)?;
        Ok(Proven::Statement)
    }
}

impl Verify<'_, Pair<'_>> for DistanceStatement {
    fn verify(&self, pair: &Pair<'_>) -> Result<Proven<'static>, ProofError> {
        self.gap.map_or(Ok(0.0), |gap| pair.verify(&gap))?;
        self.near.map_or(Ok(0.0), |near| pair.verify(&near))?;
        Ok(Proven::Statement)
    }
}

impl Verify<'_, Pair<'_>> for Depth {
    fn verify(&self, pair: &Pair<'_>) -> Result<Proven<'static>, ProofError> {
        pair.verify(self)?;
        Ok(Proven::Statement)
    }
}

/// The triangles are named by the facets of the file.
impl Verify<'_, Pair<'_, Solid>> for DistanceCertificate {
    fn verify(&self, pair: &Pair<'_, Solid>) -> Result<Proven<'static>, ProofError> {
        let place = |k: usize, facet: u32| {
            let facets = [pair.moving(), pair.fixed()][k].facet_indices();
            facets.iter().position(|known| known.0 == facet).map(|at| at as u32)
        };
        let near = named(self.near, place).ok_or(CertificateError::Start)?;
        pair.verify(&Self { near, ..self.clone() })?;
        Ok(Proven::Statement)
    }
}

/// Returns a proof whose triangles are named by the facets of the file.
pub(super) fn in_file(of: DistanceCertificate, bodies: [&Solid; 2]) -> DistanceCertificate {
    let number = |k: usize, at: u32| Some(bodies[k].facet_indices().get(at as usize)?.0);
    let near = named(of.near, number).unwrap_or(of.near);
    DistanceCertificate { near, ..of }
}

/// Returns the same with other names of triangles; `None` if one has none.
fn named(near: SolidNear, name: impl Fn(usize, u32) -> Option<u32>) -> Option<SolidNear> {
    let SolidNear::Points { triangles: [p, q], weights, distance } = near else {
        return Some(near);
    };
    Some(SolidNear::Points { triangles: [name(0, p)?, name(1, q)?], weights, distance })
}

/// Two solids, and what is asked along a direction.
pub(super) type SolidsAlong<'a> = ([Placed<'a, Solid>; 2], Along);

impl Verify<'_, SolidsAlong<'_>> for SolidStatement {
    fn verify(&self, about: &SolidsAlong<'_>) -> Result<Proven<'static>, ProofError> {
        let ([moving, fixed], Along { direction, keep }) = *about;
        let options = options(self.start_overlap, self.certificate.tolerance, keep);
        self.check(&Cast::new(moving, fixed, direction)?.with_options(options)?)?;
        Ok(Proven::Statement)
    }
}

impl<'a> Verify<'a, [Placed<'a, Solid>; 2]> for FreeStatement {
    fn verify(&self, about: &[Placed<'a, Solid>; 2]) -> Result<Proven<'a>, ProofError> {
        Ok(Proven::Directions(Box::new(self.checked(*about)?)))
    }
}

impl FreeStatement {
    /// Of an answer about these bodies, which are those of a file.
    pub(super) fn of(
        free: &FreeDirections<'_>,
        made: [&Solid; 2],
    ) -> Result<Self, CertificateError> {
        let FreeProof { tolerance, start_overlap, boxes, cells } = free.proof();
        let number = |k: usize, triangle: u32| made[k].facet_indices()[triangle as usize].0;
        let in_file = |pair: [u32; 2]| Some([number(0, pair[0]), number(1, pair[1])]);
        let cells = renamed(&cells, in_file).ok_or(CertificateError::Start)?;
        let shrunk = shrunk(made, tolerance)?;
        Ok(Self { tolerance, start_overlap, shrunk, boxes, cells })
    }

    /// What it says of two bodies, if it holds.
    fn checked<'a>(
        &self,
        [moving, fixed]: [Placed<'a, Solid>; 2],
    ) -> Result<FreeDirections<'a>, CertificateError> {
        let bodies = [moving.body, fixed.body];
        if self.shrunk != shrunk(bodies, self.tolerance)? {
            return Err(CertificateError::Start);
        }
        let places = bodies.map(|body| {
            let mut places = vec![None; body.input_counts()[1] as usize];
            for (at, facet) in body.facet_indices().iter().enumerate() {
                places[facet.index()] = Some(at as u32);
            }
            places
        });
        let place = |k: usize, facet: u32| *places[k].get(facet as usize)?;
        let to_place = |pair: [u32; 2]| Some([place(0, pair[0])?, place(1, pair[1])?]);
        let cells = renamed(&self.cells, to_place).ok_or(CertificateError::Start)?;
        let Self { tolerance, start_overlap, .. } = *self;
        let proof = FreeProof { tolerance, start_overlap, boxes: self.boxes.clone(), cells };
        FreeDirections::from_proof(&moving, &fixed, &proof).map_err(|error| match error {
            FreeError::Query(error) => error.into(),
            FreeError::NotProven(error) => error,
            _ => CertificateError::Start,
        })
    }
}

/// Whether there are no boxes.
fn are_none(boxes: &[Vec<InnerBox>; 2]) -> bool {
    boxes.iter().all(Vec::is_empty)
}

/// Cells with other names of facets; `None` if one has none.
fn renamed(
    cells: &[CellProof],
    name: impl Fn([u32; 2]) -> Option<[u32; 2]>,
) -> Option<Vec<CellProof>> {
    let all = |pairs: &[[u32; 2]]| -> Option<Vec<[u32; 2]>> {
        pairs.iter().map(|pair| name(*pair)).collect()
    };
    let of = |cell: &CellProof| {
        Some(match cell {
            CellProof::Cut => CellProof::Cut,
            CellProof::Blocked(pair) => CellProof::Blocked(name(*pair)?),
            CellProof::Inner(pair) => CellProof::Inner(*pair),
            CellProof::Open(pairs) => CellProof::Open(all(pairs)?),
            CellProof::Undecided(pairs) => CellProof::Undecided(all(pairs)?),
        })
    };
    cells.iter().map(of).collect()
}

/// The vertices of bodies shrunk by half a tolerance, if there is one.
fn shrunk(
    bodies: [&Solid; 2],
    tolerance: f64,
) -> Result<Option<[Vec<DVec3>; 2]>, CertificateError> {
    if tolerance == 0.0 {
        return Ok(None);
    }
    // The vertices of what is read from a file have the numbers of the file.
    let vertices = |body: &Solid| body.shrunk(tolerance / 2.0).map(|of| of.0.vertices().to_vec());
    match bodies.map(vertices) {
        [Ok(moving), Ok(fixed)] => Ok(Some([moving, fixed])),
        _ => Err(CertificateError::Start),
    }
}

impl SolidStatement {
    pub(super) fn of(cast: &Cast<'_, Solid>) -> Result<Self, QueryError> {
        let (clearance, certificate) = cast.certified_clearance()?;
        let (stop, separation) = match clearance {
            Clearance::Blocked { contact, .. } => {
                let stop = |facets| Stop {
                    facets,
                    translation: claimed_translation(cast, &certificate, &contact),
                };
                (facets(cast, contact.triangles).map(stop), None)
            }
            Clearance::Free(free) => (None, free.separation),
            Clearance::Overlapping(_) => (None, None),
        };
        let start_overlap = cast.options().start_overlap;
        Ok(Self { start_overlap, certificate, stop, separation })
    }

    fn check(&self, cast: &Cast<'_, Solid>) -> Result<(), CertificateError> {
        cast.verify(&self.certificate)?;
        if let Some(separation) = &self.separation {
            cast.verify(separation)?;
        }
        let (stop, triangles) = match (self.stop, self.certificate.stop) {
            (None, None) => return Ok(()),
            (Some(stop), Some(proof)) => (stop, proof.triangles),
            (Some(stop), None) => return Err(stop.refused()),
            (None, Some(proof)) => return Err(CertificateError::triangles(proof.triangles)),
        };
        if facets(cast, triangles) != Some(stop.facets) {
            return Err(stop.refused());
        }
        let refused = CertificateError::triangles(triangles);
        let proven = proven_translation(cast, &self.certificate, triangles).ok_or(refused)?;
        let Bounded { value, lower, upper } = stop.translation;
        if !(lower <= value && value <= upper) {
            return Err(CertificateError::Value { value, lower, upper });
        }
        if lower > proven.lower {
            return Err(CertificateError::Bound { proven: proven.lower, claimed: lower });
        }
        if upper < proven.upper {
            return Err(CertificateError::Bound { proven: proven.upper, claimed: upper });
        }
        Ok(())
    }
}

/// Returns where two triangles first meet, as a check finds it, if they stop the moving body.
fn proven_translation(
    cast: &Cast<'_, Solid>,
    certificate: &SolidCertificate,
    triangles: [u32; 2],
) -> Option<Bounded> {
    let overlapping = Some(!matches!(certificate.start, StartProof::Apart(_)));
    let of_pair = Cast { options: cast.options.with_overlapping(overlapping), ..*cast };
    of_pair.stop_by(triangles).map(|found| found.translation)
}

/// Returns the translation of a contact, with the bounds that a check of its two triangles proves.
///
/// The bounds of an answer may be nearer to each other, because it may know them from the hulls of the bodies.
fn claimed_translation(
    cast: &Cast<'_, Solid>,
    certificate: &SolidCertificate,
    contact: &SolidContact,
) -> Bounded {
    let Bounded { value, lower, upper } = contact.translation;
    match proven_translation(cast, certificate, contact.triangles) {
        Some(proven) => {
            Bounded { value, lower: lower.min(proven.lower), upper: upper.max(proven.upper) }
        }
        None => contact.translation,
    }
}

/// The facets of the input that two triangles are parts of.
fn facets(cast: &Cast<'_, Solid>, [s, t]: [u32; 2]) -> Option<[InputFacet; 2]> {
    let of = |body: &Solid, at: u32| body.facet_indices().get(at as usize).copied();
    Some([of(cast.moving(), s)?, of(cast.fixed(), t)?])
}
