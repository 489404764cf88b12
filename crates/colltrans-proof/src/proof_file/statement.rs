//! Statements about two bodies with their certificates, and their checks.

use std::collections::HashMap;

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
use colltrans_convex::cast::shadow_overlap::{proven_overlap, verified_overlap};
use colltrans_convex::pair::Pair;
use colltrans_convex::setting::error::QueryError;
use colltrans_removal::directions::{CellProof, FreeDirections, FreeError, FreeProof, InnerBox};
use colltrans_solid::SolidCast;
use colltrans_solid::body::Solid;
use colltrans_solid::cast::{SolidCertificate, SolidOptions, StartOverlap, StartProof};
use colltrans_solid::pair::DistanceCertificate;
use colltrans_solid::penetration::{
    CommonNode, CommonPartCertificate, DepthCertificate, SolidPenetration,
};
use colltrans_solid::solve::contact::SolidContact;
use colltrans_solid::solve::nearest::SolidNear;
use colltrans_solid::solve::overlap::Overlap;

/// Statement about the free directions of a solid.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FreeStatement {
    /// Tolerance: both bodies are offset inwards by half of this length.
    pub tolerance: f64,
    /// Whether facets that cross at the start count as an overlap.
    pub start_overlap: StartOverlap,
    /// With a tolerance, the vertices of the offset bodies, in the order of the file, numbered across pieces.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shrunk: Option<[Vec<DVec3>; 2]>,
    /// Boxes inside the moving and inside the fixed body to which cells refer.
    #[serde(default, skip_serializing_if = "are_none")]
    pub boxes: [Vec<InnerBox>; 2],
    /// Claims about the cells of the sphere, as in [`FreeProof`]. Pairs are indices of facets in the file, of
    /// the moving and of the fixed body, numbered across pieces.
    pub cells: Vec<CellProof>,
}

/// Statement about the distance of two convex bodies: a lower bound, an upper bound, or both.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DistanceStatement {
    /// Proof of the lower bound.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gap: Option<PlaneGap>,
    /// Proof of the upper bound.
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

/// Statement about the first and the last contact of two convex bodies. One of them may be missing.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Contacts {
    /// For bodies that slide along each other, the bound on the overlap of their shadows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub slide: Option<Slide>,
    /// Certificate of the first contact.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub first: Option<Certificate>,
    /// Certificate of the last contact, which is the first one of the [reversed](Cast::reversed) cast.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub last: Option<Certificate>,
}

/// Lateral overlap of two convex bodies.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Slide {
    /// Unit normal in the world frame, orthogonal to the direction, from the moving body to the fixed one:
    /// [`Grazing::separating_direction`].
    pub normal: DVec3,
    /// Upper bound of the overlap of the bodies' shadows along `normal`, increased by the minimum gap, a
    /// length. If it is negative, the shadows are farther apart than the minimum gap.
    pub overlap: f64,
}

/// Statement about the clearance of two solids.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SolidStatement {
    /// Treatment of an overlap at the start.
    pub start_overlap: StartOverlap,
    /// Proof for the bodies, each offset by half of the tolerance.
    pub certificate: SolidCertificate,
    /// Facets that block the moving body.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stop: Option<Stop>,
    /// Plane that separates the offset bodies.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub separation: Option<Separation>,
}

/// Two facets, and their contact in nominal position.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stop {
    /// Indices of the facets in the file, of the moving and of the fixed body, numbered across pieces.
    pub facets: [InputFacet; 2],
    /// Contact in nominal position:
    /// [`SolidContact::translation`](colltrans_solid::SolidContact::translation). The bounds also enclose
    /// those that a check of the two facets proves.
    pub translation: Bounded,
}

impl Stop {
    const fn other_facets_error(&self) -> CertificateError {
        let [moving, fixed] = self.facets;
        CertificateError::OtherFacets { moving, fixed }
    }
}

impl Slide {
    fn of_grazing(grazing: &Grazing, cast: &Cast<'_>) -> Self {
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
    /// Builds the statement from the given contacts.
    pub(super) fn from_contacts(first: Option<&Contact>, last: Option<&Contact>) -> Self {
        let [first, last] = [first, last].map(|end| end.map(|contact| contact.certificate));
        Self { slide: None, first, last }
    }

    /// Builds the statement of bodies that slide along each other.
    pub(super) fn from_grazing(cast: &Cast<'_>, first: &Grazing, last: Option<&Grazing>) -> Self {
        let ends = Self::from_contacts(Some(&first.contact), last.map(|last| &last.contact));
        Self { slide: Some(Slide::of_grazing(first, cast)), ..ends }
    }

    /// Returns bounds of the translation of the first contact, and of the last one.
    pub fn bounds(&self) -> [Option<[f64; 2]>; 2] {
        let first = self.first.map(|first| [first.lower, first.upper]);
        // Avoid -0.
        [first, self.last.map(|last| [0.0 - last.upper, 0.0 - last.lower])]
    }
}

/// Returns the options on which a proof depends.
pub(super) fn solid_options(
    start_overlap: StartOverlap,
    tolerance: f64,
    min_gap: f64,
) -> SolidOptions {
    let options = SolidOptions::default().with_start_overlap(start_overlap);
    options.with_tolerance(tolerance).with_min_gap(min_gap)
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

/// The certificate of a file identifies triangles by the facets of the file.
impl Verify<'_, Pair<'_, Solid>> for DistanceCertificate {
    fn verify(&self, pair: &Pair<'_, Solid>) -> Result<Proven<'static>, ProofError> {
        pair.verify(&with_triangles(self, pair)?)?;
        Ok(Proven::Statement)
    }
}

/// The certificate of a file identifies triangles by the facets of the file.
impl Verify<'_, Pair<'_, Solid>> for DepthCertificate {
    fn verify(&self, pair: &Pair<'_, Solid>) -> Result<Proven<'static>, ProofError> {
        let apart = with_triangles(&self.apart, pair)?;
        pair.verify_depth(&Self { apart, ..self.clone() })?;
        Ok(Proven::Statement)
    }
}

/// The certificate of a file identifies triangles by the facets of the file. Its claims are about these facets, so that
/// none of them may have been reversed.
impl Verify<'_, Pair<'_, Solid>> for CommonPartCertificate {
    fn verify(&self, pair: &Pair<'_, Solid>) -> Result<Proven<'static>, ProofError> {
        let bodies = [pair.moving(), pair.fixed()];
        if let Some(body) = bodies.iter().position(|body| body.report().turned() > 0) {
            return Err(ProofError::InsideOut { is_moving: body == 0 });
        }
        let places = bodies.map(|body| {
            let mut places = HashMap::new();
            for (at, facet) in body.facet_indices().iter().enumerate() {
                places.entry(facet.0).or_insert(at as u32);
            }
            places
        });
        let unknown = |facet| ProofError::UnknownFacet { facet };
        let name = |k: usize, facet| places[k].get(&facet).copied().ok_or_else(|| unknown(facet));
        pair.verify_common_part(&rename_cuts(self, name)?)?;
        Ok(Proven::Statement)
    }
}

/// Returns a proof that identifies triangles by the facets of the file.
pub(super) fn common_part_with_file_facets(
    of: CommonPartCertificate,
    bodies: [&Solid; 2],
) -> CommonPartCertificate {
    rename_cuts(&of, |k, at| facet_of_triangle(bodies[k], at).ok_or(())).unwrap_or(of)
}

/// Replaces the triangles of cuts.
fn rename_cuts<E>(
    of: &CommonPartCertificate,
    name: impl Fn(usize, u32) -> Result<u32, E>,
) -> Result<CommonPartCertificate, E> {
    let rename = |node: &CommonNode| {
        Ok(match *node {
            CommonNode::Moving(triangle) => CommonNode::Moving(name(0, triangle)?),
            CommonNode::Fixed(triangle) => CommonNode::Fixed(name(1, triangle)?),
            other => other,
        })
    };
    let nodes = of.nodes.iter().map(rename).collect::<Result<_, E>>()?;
    Ok(CommonPartCertificate { nodes, ..of.clone() })
}

/// Returns a proof of a file that identifies triangles by their positions in the solids.
fn with_triangles(
    of: &DistanceCertificate,
    pair: &Pair<'_, Solid>,
) -> Result<DistanceCertificate, CertificateError> {
    let place = |k: usize, facet| triangle_of_facet([pair.moving(), pair.fixed()][k], facet);
    let near = rename_triangles(of.near, place).ok_or(CertificateError::StartClaim)?;
    Ok(DistanceCertificate { near, ..of.clone() })
}

/// Returns a proof that identifies triangles by the facets of the file.
pub(super) fn with_file_facets(
    of: DistanceCertificate,
    bodies: [&Solid; 2],
) -> DistanceCertificate {
    let number = |k: usize, at| facet_of_triangle(bodies[k], at);
    let near = rename_triangles(of.near, number).unwrap_or(of.near);
    DistanceCertificate { near, ..of }
}

/// Returns the facet of the file to which a triangle of a solid belongs. Returns `None` if the triangle does not exist.
pub(super) fn facet_of_triangle(solid: &Solid, triangle: u32) -> Option<u32> {
    Some(solid.facet_indices().get(triangle as usize)?.0)
}

/// Returns the triangle of a solid to which a facet of the file belongs. Returns `None` if the facet does not exist.
pub(super) fn triangle_of_facet(solid: &Solid, facet: u32) -> Option<u32> {
    let found = solid.facet_indices().iter().position(|known| known.0 == facet);
    found.map(|triangle| triangle as u32)
}

/// Replaces the indices of triangles. Returns `None` if an index has no replacement.
pub(super) fn rename_triangles(
    near: SolidNear,
    name: impl Fn(usize, u32) -> Option<u32>,
) -> Option<SolidNear> {
    Some(match near {
        SolidNear::Points { triangles: [p, q], weights, distance } => {
            SolidNear::Points { triangles: [name(0, p)?, name(1, q)?], weights, distance }
        }
        SolidNear::Meeting(Overlap::Facets(p, q)) => {
            SolidNear::Meeting(Overlap::Facets(name(0, p)?, name(1, q)?))
        }
        SolidNear::Meeting(Overlap::MovingInside(p)) => {
            SolidNear::Meeting(Overlap::MovingInside(name(0, p)?))
        }
        SolidNear::Meeting(Overlap::FixedInside(q)) => {
            SolidNear::Meeting(Overlap::FixedInside(name(1, q)?))
        }
    })
}

/// Two solids, and the query along a direction.
pub(super) type SolidsAlong<'a> = ([Placed<'a, Solid>; 2], Along);

impl Verify<'_, SolidsAlong<'_>> for SolidStatement {
    fn verify(&self, about: &SolidsAlong<'_>) -> Result<Proven<'static>, ProofError> {
        let ([moving, fixed], Along { direction, min_gap }) = *about;
        let options = solid_options(self.start_overlap, self.certificate.tolerance, min_gap);
        self.check(&Cast::new(moving, fixed, direction)?.with_options(options)?)?;
        Ok(Proven::Statement)
    }
}

impl<'a> Verify<'a, [Placed<'a, Solid>; 2]> for FreeStatement {
    fn verify(&self, about: &[Placed<'a, Solid>; 2]) -> Result<Proven<'a>, ProofError> {
        Ok(Proven::Directions(Box::new(self.verified_directions(*about)?)))
    }
}

impl FreeStatement {
    /// Builds the statement of an answer about bodies that are read from a file.
    pub(super) fn of(
        free: &FreeDirections<'_>,
        made: [&Solid; 2],
    ) -> Result<Self, CertificateError> {
        let FreeProof { tolerance, start_overlap, boxes, cells } = free.proof();
        let number = |k: usize, triangle: u32| made[k].facet_indices()[triangle as usize].0;
        let to_file = |pair: [u32; 2]| Some([number(0, pair[0]), number(1, pair[1])]);
        let cells = rename_facets(&cells, to_file).ok_or(CertificateError::StartClaim)?;
        let shrunk = offset_vertices(made, tolerance)?;
        Ok(Self { tolerance, start_overlap, shrunk, boxes, cells })
    }

    /// Checks the statement against two bodies, and returns their free directions.
    fn verified_directions<'a>(
        &self,
        [moving, fixed]: [Placed<'a, Solid>; 2],
    ) -> Result<FreeDirections<'a>, CertificateError> {
        let bodies = [moving.body, fixed.body];
        if self.shrunk != offset_vertices(bodies, self.tolerance)? {
            return Err(CertificateError::StartClaim);
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
        let cells = rename_facets(&self.cells, to_place).ok_or(CertificateError::StartClaim)?;
        let Self { tolerance, start_overlap, .. } = *self;
        let proof = FreeProof { tolerance, start_overlap, boxes: self.boxes.clone(), cells };
        FreeDirections::from_proof(&moving, &fixed, &proof).map_err(|error| match error {
            FreeError::Query(error) => error.into(),
            FreeError::NotProven(error) => error,
            _ => CertificateError::StartClaim,
        })
    }
}

/// Checks whether both lists of boxes are empty.
fn are_none(boxes: &[Vec<InnerBox>; 2]) -> bool {
    boxes.iter().all(Vec::is_empty)
}

/// Replaces the indices of facets in cells. Returns `None` if an index has no replacement.
fn rename_facets(
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

/// Returns the vertices of the bodies, each offset by half the tolerance. Returns `None` for a tolerance of
/// 0.
fn offset_vertices(
    bodies: [&Solid; 2],
    tolerance: f64,
) -> Result<Option<[Vec<DVec3>; 2]>, CertificateError> {
    if tolerance == 0.0 {
        return Ok(None);
    }
    // Vertices that are read from a file have the indices of the file.
    let vertices = |body: &Solid| body.shrunk(tolerance / 2.0).map(|of| of.0.vertices().to_vec());
    match bodies.map(vertices) {
        [Ok(moving), Ok(fixed)] => Ok(Some([moving, fixed])),
        _ => Err(CertificateError::StartClaim),
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
                (input_facets(cast, contact.triangles).map(stop), None)
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
            (Some(stop), None) => return Err(stop.other_facets_error()),
            (None, Some(proof)) => {
                return Err(CertificateError::blocking_triangles(proof.triangles));
            }
        };
        if input_facets(cast, triangles) != Some(stop.facets) {
            return Err(stop.other_facets_error());
        }
        let refused = CertificateError::blocking_triangles(triangles);
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

/// Returns the first contact of two triangles as a check computes it, and `None` if they do not block the
/// moving body.
fn proven_translation(
    cast: &Cast<'_, Solid>,
    certificate: &SolidCertificate,
    triangles: [u32; 2],
) -> Option<Bounded> {
    let overlapping = Some(!matches!(certificate.start, StartProof::Apart(_)));
    let of_pair = Cast { options: cast.options.with_overlapping(overlapping), ..*cast };
    of_pair.contact_of_triangles(triangles).map(|found| found.translation)
}

/// Returns the translation of a contact for the statement. Its bounds enclose the bounds of the answer, and those
/// that a check of the two triangles proves.
///
/// The bounds of the answer may be tighter than those of the check, because they may come from the hulls of the
/// bodies.
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

/// Returns the facets of the input that contain two triangles.
fn input_facets(cast: &Cast<'_, Solid>, [s, t]: [u32; 2]) -> Option<[InputFacet; 2]> {
    let of = |body: &Solid, at: u32| body.facet_indices().get(at as usize).copied();
    Some([of(cast.moving(), s)?, of(cast.fixed(), t)?])
}
