//! A proof with all that it is about, as one file.
//!
//! Bodies are written as they are, exact in bits, with their poses and the direction of a cast; then what
//! is claimed of them, with its certificates. A certificate between solids tells facets by their place
//! in a tree, so it is made for the bodies as they are read back from the file.

use std::fmt;

use glam::DVec3;
use serde::{Deserialize, Serialize};

use crate::answer::{
    Bounded, Certificate, CertificateError, Clearance, Contact, ContactRange, Depth, Distance,
    Grazing, NearPoints, Outcome, OverlapAhead, PlaneGap, Separation, WhyFree, Within,
};
use crate::body::pose::PoseRecord;
use crate::body::solid::{Solid, SolidError};
use crate::body::{ConvexPolyhedron, InputFacet, Placed, Pose};
use crate::cast::replay::BodyRecord;
use crate::cast::sideways::{proven_overlap, verified_overlap};
use crate::cast::solid::{SolidCertificate, SolidOptions, StartOverlap, StartProof};
use crate::cast::{CaseError, Cast};
use crate::pair::Pair;
use crate::pair::solid::DistanceCertificate;
use crate::setting::error::QueryError;
use crate::setting::{check_direction, check_keep};

/// What a file of this version calls itself.
const FORMAT: &str = "colltrans proof 1";

/// What a cast asks, besides bodies: the direction, and the gap that is kept.
#[derive(Debug, Clone, Copy)]
struct Along {
    direction: DVec3,
    keep: f64,
}

/// A proof that owns its bodies: whoever has the file can check what it says, without a search.
///
/// ```
/// use colltrans::glam::DVec3;
/// use colltrans::{Cast, ConvexPolyhedron, Pose, ProofFile};
///
/// let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE)?;
/// let start = Pose::from_translation(DVec3::new(-3.0, 0.5, 0.0))?;
/// let cast = Cast::new(cube.at(start), cube.at(Pose::IDENTITY), DVec3::X)?;
///
/// let saved = ProofFile::of_range(&cast, &cast.contact_range()?).to_json();
/// let proof = ProofFile::from_json(&saved)?;
/// proof.check()?;
/// assert!(proof.statement().to_string().starts_with("the bodies meet from a translation"));
/// assert!(ProofFile::from_json(&saved.replace("[-3.0,", "[-3.1,"))?.check().is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct ProofFile {
    bodies: Bodies,
    poses: [Pose; 2],
    along: Option<Along>,
    statement: Statement,
}

#[derive(Debug, Clone)]
enum Bodies {
    Convex(Box<[ConvexPolyhedron; 2]>),
    Solids { made: Box<[Solid; 2]>, of: Pieces },
}

/// What the moving and the fixed body are made of.
type Pieces = [Vec<PieceRecord>; 2];

/// What a [`ProofFile`] says of its bodies.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Statement {
    /// Where convex bodies meet first, or last, or both.
    Contacts(Contacts),
    /// That convex bodies never meet.
    Separation(Separation),
    /// How far a solid can move from where it is.
    Clearance(SolidStatement),
    /// How far convex bodies are apart where they are.
    Distance(DistanceStatement),
    /// How deep convex bodies overlap where they are.
    Depth(Depth),
    /// How far solids are apart where they are.
    SolidDistance(DistanceCertificate),
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
    /// Where they meet in their true place: [`SolidContact::translation`](crate::solid::SolidContact::translation).
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
    fn between(first: Option<&Contact>, last: Option<&Contact>) -> Self {
        let [first, last] = [first, last].map(|end| end.map(|contact| contact.certificate));
        Self { slide: None, first, last }
    }

    /// Of bodies that slide along each other.
    fn sliding(cast: &Cast<'_>, first: &Grazing, last: Option<&Grazing>) -> Self {
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

impl ProofFile {
    /// Of an answer of [`Cast::first_contact`]; `cast` is the one that was asked.
    pub fn of_outcome(cast: &Cast<'_>, outcome: &Outcome) -> Self {
        let statement = match outcome {
            Outcome::Contact(contact) => {
                Statement::Contacts(Contacts::between(Some(contact), None))
            }
            Outcome::Grazing(grazing) => {
                Statement::Contacts(Contacts::sliding(cast, grazing, None))
            }
            Outcome::Separated(separated) => Statement::Separation(separated.certificate),
        };
        Self::of_convex(cast, statement)
    }

    /// Of an answer of [`Cast::contact_range`]; `cast` is the one that was asked.
    pub fn of_range(cast: &Cast<'_>, range: &ContactRange) -> Self {
        let contacts = match range {
            ContactRange::Contact { first, last } => Contacts::between(Some(first), Some(last)),
            ContactRange::Grazing { first, last } => Contacts::sliding(cast, first, Some(last)),
            ContactRange::Separated(of) => return Self::of_outcome(cast, &Outcome::Separated(*of)),
        };
        Self::of_convex(cast, Statement::Contacts(contacts))
    }

    /// Of an answer of [`Cast::clearance`]; `cast` is the one that was asked.
    pub fn of_clearance(cast: &Cast<'_>, clearance: &Clearance) -> Self {
        let outcome = |of| Self::of_outcome(cast, &of);
        let ends = |first, last| {
            Self::of_convex(cast, Statement::Contacts(Contacts::between(first, last)))
        };
        match clearance {
            Clearance::Blocked { contact, .. } => outcome(Outcome::Contact(*contact)),
            Clearance::Free(WhyFree::Slides(grazing)) => outcome(Outcome::Grazing(*grazing)),
            Clearance::Free(WhyFree::Separated(of)) => outcome(Outcome::Separated(*of)),
            Clearance::Free(WhyFree::Behind(last)) => ends(None, Some(last)),
            Clearance::Overlapping(OverlapAhead { first, last }) => ends(Some(first), Some(last)),
        }
    }

    fn of_convex(cast: &Cast<'_>, statement: Statement) -> Self {
        Self {
            bodies: Bodies::Convex(Box::new([cast.moving().clone(), cast.fixed().clone()])),
            poses: [cast.moving_pose(), cast.fixed_pose()],
            along: Some(Along { direction: cast.direction(), keep: cast.options().keep }),
            statement,
        }
    }

    /// Of an answer of [`Pair::distance`] or [`Pair::within`]; `pair` is the one that was asked.
    pub fn of_distance(pair: &Pair<'_>, answer: impl Into<DistanceStatement>) -> Self {
        Self::of_pair(pair, Statement::Distance(answer.into()))
    }

    /// Of an answer of [`Pair::depth`]; `pair` is the one that was asked.
    pub fn of_depth(pair: &Pair<'_>, depth: &Depth) -> Self {
        Self::of_pair(pair, Statement::Depth(depth.clone()))
    }

    fn of_pair(pair: &Pair<'_>, statement: Statement) -> Self {
        let bodies = Bodies::Convex(Box::new([pair.moving().clone(), pair.fixed().clone()]));
        let poses = [pair.moving_pose(), pair.fixed_pose()];
        Self { bodies, poses, along: None, statement }
    }

    /// Of [`Cast::clearance`] between solids, asked once more with its proof. `pieces` are those that
    /// each body is the union of ([`Solid::from_pieces`]), or the body itself. Of the choices, the
    /// tolerance and what an overlap means count.
    ///
    /// # Errors
    /// A body that its own facets do not make once more.
    pub fn of_solids(cast: &Cast<'_, Solid>, pieces: [&[&Solid]; 2]) -> Result<Self, CaseError> {
        let (made, of) = again(pieces, [cast.moving(), cast.fixed()])?;
        let (poses, direction) = ([cast.moving_pose(), cast.fixed_pose()], cast.direction());
        let keep = cast.options().keep;
        let options = options(cast.options().start_overlap, cast.tolerance(), keep);
        let again = Cast::new(made[0].at(poses[0]), made[1].at(poses[1]), direction)?;
        let statement = Statement::Clearance(SolidStatement::of(&again.with_options(options)?)?);
        let bodies = Bodies::Solids { made, of };
        Ok(Self { bodies, poses, along: Some(Along { direction, keep }), statement })
    }

    /// Of the distance of solids, asked once more with its proof: of [`Pair::distance`], or of
    /// [`Pair::within`] a length, which may prove one bound alone. `pieces` as in [`Self::of_solids`].
    ///
    /// # Errors
    /// A body that its own facets do not make once more; a length that is negative or not a number.
    pub fn of_solid_distance(
        pair: &Pair<'_, Solid>,
        pieces: [&[&Solid]; 2],
        within: Option<f64>,
    ) -> Result<Self, CaseError> {
        let (made, of) = again(pieces, [pair.moving(), pair.fixed()])?;
        let poses = [pair.moving_pose(), pair.fixed_pose()];
        let again = Pair::new(made[0].at(poses[0]), made[1].at(poses[1]))?;
        let proof = match within {
            None => again.certified_distance()?.1,
            Some(length) => match again.certified_within(length)? {
                (_, Some(proof)) => proof,
                (Within::Closer(near), None) => DistanceCertificate::of_near(near),
                (_, None) => again.certified_distance()?.1,
            },
        };
        let (bodies, statement) = (Bodies::Solids { made, of }, Statement::SolidDistance(proof));
        Ok(Self { bodies, poses, along: None, statement })
    }

    /// What it says; true if [`Self::check`] does not object.
    pub const fn statement(&self) -> &Statement {
        &self.statement
    }

    /// How many facets of the moving and of the fixed body turn inside out, or pass through others, where
    /// they are shrunk by half the tolerance each ([`ShrinkReport::inverted`](crate::solid::ShrinkReport::inverted)):
    /// what is said of shrunk bodies says little there.
    pub fn inverted(&self) -> [usize; 2] {
        match (&self.bodies, &self.statement) {
            (Bodies::Solids { made, .. }, Statement::Clearance(of))
                if of.certificate.tolerance > 0.0 =>
            {
                let amount = of.certificate.tolerance / 2.0;
                made.each_ref().map(|body| body.shrink_report(amount).inverted.len())
            }
            _ => [0; 2],
        }
    }

    /// Checks it as [`Cast::verify`] and [`Pair::verify`] do, without a search.
    ///
    /// # Errors
    /// The first thing that is not proven.
    pub fn check(&self) -> Result<(), CertificateError> {
        let [moving, fixed] = self.poses;
        match (&self.bodies, self.along) {
            (Bodies::Convex(bodies), along) => {
                let placed = [bodies[0].at(moving), bodies[1].at(fixed)];
                match along {
                    Some(Along { direction, keep }) => {
                        let cast = Cast::new(placed[0], placed[1], direction)?.keeping(keep)?;
                        self.statement.check(&cast)
                    }
                    None => self.statement.check_pair(&Pair::new(placed[0], placed[1])?),
                }
            }
            (Bodies::Solids { made, .. }, along) => {
                let placed = [made[0].at(moving), made[1].at(fixed)];
                self.statement.check_solids(placed, along)
            }
        }
    }

    /// As a file: numbers that read back as the same bits.
    ///
    /// # Panics
    /// Never: all numbers can be written.
    pub fn to_json(&self) -> String {
        let [moving, fixed] = match &self.bodies {
            Bodies::Convex(bodies) => {
                bodies.each_ref().map(|body| BodyFile::Convex(BodyRecord::of(body)))
            }
            Bodies::Solids { of, .. } => of.each_ref().map(|of| BodyFile::Pieces(of.clone())),
        };
        let [moving_pose, fixed_pose] = self.poses.map(PoseRecord::from);
        let file = File {
            format: FORMAT.into(),
            moving,
            moving_pose,
            fixed,
            fixed_pose,
            direction: self.along.map(|along| along.direction.to_array()),
            keep: self.along.map_or(0.0, |along| along.keep),
            statement: self.statement.clone(),
        };
        serde_json::to_string(&file).expect("numbers and names")
    }

    /// From what [`Self::to_json`] has written. It is read, not believed: see [`Self::check`].
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn from_json(text: &str) -> Result<Self, CaseError> {
        #[derive(Deserialize)]
        struct Named {
            format: String,
        }
        // Some editors begin a file with a byte-order mark.
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let Named { format } = serde_json::from_str(text).map_err(CaseError::Proof)?;
        if format != FORMAT {
            return Err(CaseError::Format { found: format, known: FORMAT });
        }
        let file: File<StatementRecord> = serde_json::from_str(text).map_err(CaseError::Proof)?;
        let bodies = match (file.moving, file.fixed) {
            (BodyFile::Convex(moving), BodyFile::Convex(fixed)) => {
                let body = |record: BodyRecord, which| {
                    record.body().map_err(|error| CaseError::Body { which, error })
                };
                Bodies::Convex(Box::new([body(moving, "moving")?, body(fixed, "fixed")?]))
            }
            (BodyFile::Pieces(moving), BodyFile::Pieces(fixed)) => Bodies::Solids {
                made: Box::new([union(&moving, "moving")?, union(&fixed, "fixed")?]),
                of: [moving, fixed],
            },
            _ => return Err(CaseError::Mixed),
        };
        let statement = file.statement.of(matches!(bodies, Bodies::Solids { .. }))?;
        let is_of_pair = statement.is_of_pair();
        if is_of_pair == file.direction.is_some() || is_of_pair && file.keep != 0.0 {
            return Err(CaseError::Statement);
        }
        let poses = [file.moving_pose.try_into()?, file.fixed_pose.try_into()?];
        let direction = file.direction.map(DVec3::from_array);
        direction.map_or(Ok(()), check_direction)?;
        check_keep(file.keep)?;
        if direction.is_none() && file.keep != 0.0 {
            return Err(CaseError::Statement);
        }
        let along = direction.map(|direction| Along { direction, keep: file.keep });
        Ok(Self { bodies, poses, along, statement })
    }

    /// The gap that the bodies are to keep, in world units; 0 if they may touch.
    pub fn keep(&self) -> f64 {
        self.along.map_or(0.0, |along| along.keep)
    }
}

fn options(start_overlap: StartOverlap, tolerance: f64, keep: f64) -> SolidOptions {
    let options = SolidOptions::default().with_start_overlap(start_overlap);
    options.with_tolerance(tolerance).with_keep(keep)
}

impl Statement {
    /// Of convex bodies.
    fn check(&self, cast: &Cast<'_>) -> Result<(), CertificateError> {
        match self {
            Self::Contacts(Contacts { slide, first, last }) if first.or(*last).is_some() => {
                slide.map_or(Ok(()), |slide| slide.check(cast))?;
                first.map_or(Ok(0.0), |first| cast.verify(&first))?;
                last.map_or(Ok(0.0), |last| cast.reversed().verify(&last))?;
                Ok(())
            }
            Self::Separation(separation) => cast.verify(separation).map(|_| ()),
            _ => Err(CertificateError::Start),
        }
    }

    /// Of convex bodies and no direction.
    fn check_pair(&self, pair: &Pair<'_>) -> Result<(), CertificateError> {
        match self {
            Self::Distance(DistanceStatement { gap, near }) if gap.is_some() || near.is_some() => {
                gap.map_or(Ok(0.0), |gap| pair.verify(&gap))?;
                near.map_or(Ok(0.0), |near| pair.verify(&near))?;
                Ok(())
            }
            Self::Depth(depth) => pair.verify(depth).map(|_| ()),
            _ => Err(CertificateError::Start),
        }
    }

    fn check_solids(
        &self,
        [moving, fixed]: [Placed<'_, Solid>; 2],
        along: Option<Along>,
    ) -> Result<(), CertificateError> {
        match (self, along) {
            (Self::Clearance(of), Some(Along { direction, keep })) => {
                let options = options(of.start_overlap, of.certificate.tolerance, keep);
                of.check(&Cast::new(moving, fixed, direction)?.with_options(options)?)
            }
            (Self::SolidDistance(of), None) => Pair::new(moving, fixed)?.verify(of).map(|_| ()),
            _ => Err(CertificateError::Start),
        }
    }

    /// Whether it is of bodies where they are, without a direction.
    const fn is_of_pair(&self) -> bool {
        matches!(self, Self::Distance(_) | Self::Depth(_) | Self::SolidDistance(_))
    }
}

impl SolidStatement {
    fn of(cast: &Cast<'_, Solid>) -> Result<Self, QueryError> {
        let (clearance, certificate) = cast.certified_clearance()?;
        let (stop, separation) = match clearance {
            Clearance::Blocked { contact, .. } => {
                let facets = facets(cast, contact.triangles);
                (facets.map(|facets| Stop { facets, translation: contact.translation }), None)
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
        let overlapping = Some(!matches!(self.certificate.start, StartProof::Apart(_)));
        let of_pair = Cast { options: cast.options.with_overlapping(overlapping), ..*cast };
        let refused = CertificateError::triangles(triangles);
        let found = of_pair.stop_by(triangles).ok_or(refused)?;
        let (claimed, proven) = (stop.translation, found.translation);
        let Bounded { value, lower, upper } = claimed;
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

/// The facets of the input that two triangles are parts of.
fn facets(cast: &Cast<'_, Solid>, [s, t]: [u32; 2]) -> Option<[InputFacet; 2]> {
    let of = |body: &Solid, at: u32| body.facet_indices().get(at as usize).copied();
    Some([of(cast.moving(), s)?, of(cast.fixed(), t)?])
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct File<S> {
    format: String,
    moving: BodyFile,
    moving_pose: PoseRecord,
    fixed: BodyFile,
    fixed_pose: PoseRecord,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    direction: Option<[f64; 3]>,
    #[serde(default, skip_serializing_if = "crate::written::is_zero")]
    keep: f64,
    statement: S,
}

/// A [`Statement`] as it is read.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct StatementRecord {
    contacts: Option<Contacts>,
    separation: Option<Separation>,
    clearance: Option<SolidStatement>,
    distance: Option<DistanceStatement>,
    depth: Option<Depth>,
    solid_distance: Option<DistanceCertificate>,
}

impl StatementRecord {
    /// The one thing that is said of such bodies.
    fn of(self, solids: bool) -> Result<Statement, CaseError> {
        let Self { contacts, separation, clearance, distance, depth, solid_distance } = self;
        let contacts =
            contacts.map(|of| (of.first.is_some() || of.last.is_some(), Statement::Contacts(of)));
        let distance =
            distance.map(|of| (of.gap.is_some() || of.near.is_some(), Statement::Distance(of)));
        let said = [
            contacts.map(|(something, of)| (something && !solids, of)),
            distance.map(|(something, of)| (something && !solids, of)),
            separation.map(|of| (!solids, Statement::Separation(of))),
            depth.map(|of| (!solids, Statement::Depth(of))),
            clearance.map(|of| (solids, Statement::Clearance(of))),
            solid_distance.map(|of| (solids, Statement::SolidDistance(of))),
        ];
        let mut said = said.into_iter().flatten();
        match (said.next(), said.next()) {
            (Some((true, statement)), None) => Ok(statement),
            _ => Err(CaseError::Statement),
        }
    }
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum BodyFile {
    Convex(BodyRecord),
    Pieces(Vec<PieceRecord>),
}

/// A mesh that a solid is made of.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct PieceRecord {
    vertices: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    open: bool,
}

impl PieceRecord {
    fn of(solid: &Solid) -> Self {
        Self {
            vertices: solid.vertices().iter().map(DVec3::to_array).collect(),
            triangles: solid.triangles().to_vec(),
            open: !solid.is_closed(),
        }
    }

    fn solid(&self) -> Result<Solid, SolidError> {
        let vertices: Vec<DVec3> = self.vertices.iter().copied().map(DVec3::from_array).collect();
        if self.open {
            Solid::from_open_mesh(&vertices, &self.triangles)
        } else {
            Solid::from_mesh(&vertices, &self.triangles)
        }
    }
}

fn union(pieces: &[PieceRecord], which: &'static str) -> Result<Solid, CaseError> {
    let refused = |error| CaseError::Solid { which, error };
    let solids: Result<Vec<Solid>, SolidError> = pieces.iter().map(PieceRecord::solid).collect();
    let mut solids = solids.map_err(refused)?;
    if solids.len() == 1 {
        return Ok(solids.remove(0));
    }
    Solid::from_pieces(&solids).map_err(refused)
}

/// Both bodies made once more of their pieces, as they are read back from a file.
fn again(
    pieces: [&[&Solid]; 2],
    asked: [&Solid; 2],
) -> Result<(Box<[Solid; 2]>, Pieces), CaseError> {
    let of: Pieces =
        pieces.map(|pieces| pieces.iter().map(|piece| PieceRecord::of(piece)).collect());
    let made = Box::new([union(&of[0], "moving")?, union(&of[1], "fixed")?]);
    for (k, which) in ["moving", "fixed"].into_iter().enumerate() {
        if !is_same(&made[k], asked[k]) {
            return Err(CaseError::Changed { which });
        }
    }
    Ok((made, of))
}

/// Whether two solids have the same facets, in whatever order.
fn is_same(a: &Solid, b: &Solid) -> bool {
    let facets = |solid: &Solid| {
        // Without -0.
        let corner = |v: u32| (solid.vertices()[v as usize] + 0.0).to_array().map(f64::to_bits);
        let turned = |t: &[u32; 3]| {
            let [a, b, c] = t.map(corner);
            [[a, b, c], [b, c, a], [c, a, b]].into_iter().min()
        };
        let mut all: Vec<_> = solid.triangles().iter().map(turned).collect();
        all.sort_unstable();
        all
    };
    a.is_closed() == b.is_closed() && facets(a) == facets(b)
}

impl fmt::Display for ProofFile {
    /// Its statement, and what shrinking has done to the bodies, in words, in one line.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [moving, fixed] = self.inverted();
        if self.keep() > 0.0 {
            let keep = self.keep();
            write!(f, "counted as meeting where they are {keep:?} apart or nearer, ")?;
            // Facets that are less than eight noises nearer may pass.
            if matches!(self.bodies, Bodies::Solids { .. }) {
                f.write_str("to within rounding, ")?;
            }
        }
        self.statement.fmt(f)?;
        if [moving, fixed] == [0; 2] {
            return Ok(());
        }
        write!(
            f,
            "; shrunk so far, {moving} facets of the moving body and {fixed} of the fixed one are inside out: \
             where a body is thinner than the tolerance, nothing is said of it as it is"
        )
    }
}

impl fmt::Display for Statement {
    /// In words, in one line; translations in multiples of the direction.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Contacts(contacts) => contacts.fmt(f),
            Self::Separation(Separation { margin, .. }) => {
                write!(
                    f,
                    "the bodies never meet along the direction: seen along it, a gap of {margin:?} lies between them"
                )
            }
            Self::Clearance(statement) => statement.fmt(f),
            Self::Distance(DistanceStatement { gap, near }) => {
                let near = near.as_ref().map(|near| near.distance);
                f.write_str(&apart(gap.map(|gap| gap.gap), near))
            }
            Self::Depth(Depth { upper: 0.0, .. }) => write!(f, "the bodies do not overlap"),
            Self::Depth(Depth { lower, upper, direction, .. }) => write!(
                f,
                "a translation of the moving body by {upper:?} along {:?} parts the bodies, none below \
                 {lower:?} does",
                direction.to_array()
            ),
            Self::SolidDistance(DistanceCertificate { lower, near, .. }) => {
                let lower = Some(*lower).filter(|lower| *lower > 0.0);
                f.write_str(&apart(lower, Some(near.distance())))
            }
        }
    }
}

/// How far bodies are apart: at least, at most.
fn apart(lower: Option<f64>, upper: Option<f64>) -> String {
    match (lower, upper) {
        (_, Some(0.0)) => "the bodies have a point in common".into(),
        (Some(a), Some(b)) => format!("the bodies are between {a:?} and {b:?} apart"),
        (Some(a), None) => format!("the bodies are at least {a:?} apart"),
        (None, Some(b)) => format!("the bodies are at most {b:?} apart"),
        (None, None) => "nothing".into(),
    }
}

impl fmt::Display for Contacts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(Slide { overlap, .. }) = self.slide {
            write!(
                f,
                "the bodies slide along each other, seen along the direction they overlap by at most {overlap:?}; "
            )?;
        }
        match self.bounds() {
            [Some([a, b]), Some([c, d])] if b.is_finite() && c.is_finite() => {
                write!(
                    f,
                    "the bodies meet from a translation between {a:?} and {b:?} to one between {c:?} and {d:?}"
                )
            }
            [Some([a, _]), Some([_, d])] => {
                write!(f, "the bodies meet at no translation below {a:?} or above {d:?}")
            }
            [Some([a, b]), None] if b.is_finite() => {
                write!(f, "the bodies first meet at a translation between {a:?} and {b:?}")
            }
            [Some([a, _]), None] => write!(f, "the bodies meet at no translation below {a:?}"),
            [None, Some([c, d])] if c.is_finite() => {
                write!(f, "the bodies last meet at a translation between {c:?} and {d:?}")
            }
            [None, Some([_, d])] => write!(f, "the bodies meet at no translation above {d:?}"),
            [None, None] => write!(f, "nothing"),
        }
    }
}

impl fmt::Display for SolidStatement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let SolidCertificate { tolerance, start, lower, .. } = &self.certificate;
        if *tolerance > 0.0 {
            write!(f, "shrunk by {:?} each, ", tolerance / 2.0)?;
        }
        let overlapping = matches!(start, StartProof::Overlapping(_));
        f.write_str(if overlapping {
            "the bodies overlap where they are"
        } else {
            "the bodies do not overlap where they are"
        })?;
        if overlapping && self.start_overlap == StartOverlap::Refuse {
            return Ok(());
        }
        let later = if overlapping { " that touches later" } else { "" };
        match self.stop {
            None => write!(f, ", and nothing{later} ever stops the moving one"),
            Some(Stop { translation, .. }) => write!(
                f,
                ", and nothing{later} stops the moving one before a translation of {lower:?}; {}",
                meeting(translation)
            ),
        }
    }
}

/// Of the facets that stop a body.
fn meeting(Bounded { lower, upper, .. }: Bounded) -> String {
    match [lower.is_finite(), upper.is_finite()] {
        [true, true] => {
            format!("the facets that do meet, as they are, between {lower:?} and {upper:?}")
        }
        [true, false] => format!("the facets that do meet, as they are, not before {lower:?}"),
        [false, true] => format!("the facets that do meet, as they are, by {upper:?}"),
        [false, false] => "it is not said where the facets that do meet, as they are".into(),
    }
}
