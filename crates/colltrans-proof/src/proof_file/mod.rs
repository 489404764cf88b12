//! A proof with all that it is about, as one file.
//!
//! Bodies are written as they are, exact in bits; then where they are, what was asked of them, and one statement with
//! its certificates.
//!
//! [`file`] is the format, [`body`] the bodies in it; [`statement`], [`scene`], [`motion`] and [`path`] are what can be
//! said of them, and what [`proven`] is of it; [`verify`] joins them and checks; [`words`] tell them. [`case`] is a question about a motion.

mod body;
mod case;
mod error;
mod file;
mod motion;
mod path;
mod proven;
mod scene;
mod statement;
mod verify;
mod words;

use std::collections::HashMap;

use serde::{Deserialize, Serialize};

use colltrans_convex::answer::{
    CertificateError, Clearance, ContactRange, Depth, Distance, Outcome, OverlapAhead, Separation,
    Steps, WhyFree, Within,
};
use colltrans_convex::cast::Cast;
use colltrans_convex::pair::Pair;
use colltrans_convex::setting::error::QueryError;
use colltrans_removal::free::{FreeDirections, FreeError};
use colltrans_scene::{ClearanceProof, NearbyProof, NearestProof};
use colltrans_solid::body::Solid;
use colltrans_solid::kinds::AnyPlaced;
use colltrans_solid::pair::{DistanceCertificate, Unproven};
use colltrans_solid::{SolidCast, SolidPairSearch, SolidSteps};

use body::StoredBody;
pub use case::MotionCase;
pub use error::{ProofError, ProofFileError};
use file::{Along, Place, Placement, Query};
pub use motion::{MotionStatement, SolidMotionStatement};
pub use path::PathStatement;
pub use proven::{Proven, Verify};
pub use statement::{Contacts, DistanceStatement, FreeStatement, Slide, SolidStatement, Stop};
use statement::{in_file, options};

/// What a [`ProofFile`](crate::ProofFile) says of its bodies.
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
    /// Along which directions a solid can leave.
    FreeDirections(FreeStatement),
    /// Which of many obstacles is nearest.
    Nearest(NearestProof),
    /// Which of many obstacles are closer than a length.
    Within(NearbyProof),
    /// Which of many obstacles stops the moving body, and where.
    SceneClearance(ClearanceProof),
    /// When the bodies of each pair first meet.
    Motions(Vec<MotionStatement>),
    /// When bodies of a mechanism first meet.
    Path(PathStatement),
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
/// assert!(proof.to_string().starts_with("the bodies meet from a translation"));
/// assert!(ProofFile::from_json(&saved.replace("[-3.0,", "[-3.1,"))?.check().is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct ProofFile {
    bodies: Vec<StoredBody>,
    placement: Placement,
    query: Query,
    statement: Statement,
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
        let bodies = vec![StoredBody::convex(cast.moving()), StoredBody::convex(cast.fixed())];
        let along = Along { direction: cast.direction(), keep: cast.options().keep };
        let poses = [cast.moving_pose(), cast.fixed_pose()];
        Self { bodies, placement: Placement::of_two(poses), query: Query::Cast(along), statement }
    }

    /// Of an answer of [`Pair::distance`] or [`Pair::within`]; `pair` is the one that was asked.
    pub fn of_distance(pair: &Pair<'_>, answer: impl Into<DistanceStatement>) -> Self {
        Self::of_pair(pair, Statement::Distance(answer.into()))
    }

    /// Of an answer of [`Pair::depth`]; `pair` is the one that was asked.
    pub fn of_depth(pair: &Pair<'_>, depth: &Depth) -> Self {
        let mut depth = depth.clone();
        depth.steps = Steps::default();
        Self::of_pair(pair, Statement::Depth(depth))
    }

    fn of_pair(pair: &Pair<'_>, statement: Statement) -> Self {
        let bodies = vec![StoredBody::convex(pair.moving()), StoredBody::convex(pair.fixed())];
        let placement = Placement::of_two([pair.moving_pose(), pair.fixed_pose()]);
        Self { bodies, placement, query: Query::Pair, statement }
    }

    /// Of [`Cast::clearance`] between solids, asked once more with its proof. `pieces` are those that
    /// each body is the union of ([`Solid::from_pieces`]), or the body itself. Of the choices, the
    /// tolerance and what an overlap means count.
    ///
    /// # Errors
    /// A body that its own facets do not make once more.
    pub fn of_solids(
        cast: &Cast<'_, Solid>,
        pieces: [&[&Solid]; 2],
    ) -> Result<Self, ProofFileError> {
        let made = MadeSolids::of(pieces, [cast.moving(), cast.fixed()])?;
        let [moving, fixed] = made.bodies()?;
        let (poses, direction) = ([cast.moving_pose(), cast.fixed_pose()], cast.direction());
        let keep = cast.options().keep;
        let options = options(cast.options().start_overlap, cast.tolerance(), keep);
        let again = Cast::new(moving.at(poses[0]), fixed.at(poses[1]), direction)?;
        let statement = Statement::Clearance(SolidStatement::of(&again.with_options(options)?)?);
        let (placement, query) = (Placement::of_two(poses), Query::Cast(Along { direction, keep }));
        Ok(Self { bodies: made.0.into(), placement, query, statement })
    }

    /// Of the distance of solids, asked with its proof: of [`Pair::distance`], or of
    /// [`Pair::within`] a length, which may prove one bound alone. `pieces` as in [`Self::of_solids`].
    ///
    /// # Errors
    /// A body that its own facets do not make once more; a length that is negative or not a number.
    pub fn of_solid_distance(
        pair: &Pair<'_, Solid>,
        pieces: [&[&Solid]; 2],
        within: Option<f64>,
    ) -> Result<Self, ProofFileError> {
        Ok(match within {
            None => Self::with_solid_distance(pair, pieces)?.1,
            Some(length) => Self::with_solid_within(pair, pieces, length)?.1,
        })
    }

    /// [`Pair::distance`] of solids, and its proof: of one search, unless a body's tree comes out otherwise from the
    /// file, as it may of more than 4,096 facets; then the bodies of the file are asked as well. `pieces` as in
    /// [`Self::of_solids`].
    ///
    /// # Errors
    /// A body that its own facets do not make once more.
    pub fn with_solid_distance(
        pair: &Pair<'_, Solid>,
        pieces: [&[&Solid]; 2],
    ) -> Result<(Distance<Solid>, Self), ProofFileError> {
        Self::of_search(pair, pieces, |pair| pair.ask(true))
    }

    /// The same of [`Pair::within`] a length.
    ///
    /// # Errors
    /// As [`Self::with_solid_distance`]; a length that is negative or not a number.
    pub fn with_solid_within(
        pair: &Pair<'_, Solid>,
        pieces: [&[&Solid]; 2],
        length: f64,
    ) -> Result<((Within<Solid>, SolidSteps), Self), ProofFileError> {
        Self::of_search(pair, pieces, |pair| pair.decide(length, true))
    }

    /// An answer about bodies, and its proof about those that the file has.
    fn of_search<T>(
        pair: &Pair<'_, Solid>,
        pieces: [&[&Solid]; 2],
        ask: impl Fn(&Pair<'_, Solid>) -> Result<(T, Unproven), QueryError>,
    ) -> Result<(T, Self), ProofFileError> {
        let bodies = [pair.moving(), pair.fixed()];
        let made = MadeSolids::of(pieces, bodies)?;
        let [moving, fixed] = made.bodies()?;
        let poses = [pair.moving_pose(), pair.fixed_pose()];
        let again = Pair::new(moving.at(poses[0]), fixed.at(poses[1]))?;
        let (answer, mut found) = ask(pair)?;
        if !(bodies[0].has_same_tree(moving) && bodies[1].has_same_tree(fixed)) {
            found = ask(&again)?.1;
        }
        let statement = Statement::SolidDistance(in_file(again.prove(found)?, [moving, fixed]));
        let (placement, query) = (Placement::of_two(poses), Query::Pair);
        Ok((answer, Self { bodies: made.0.into(), placement, query, statement }))
    }

    /// Of all free directions, asked once more of the bodies as a file has them. `pieces` as in [`Self::of_solids`].
    ///
    /// # Errors
    /// A body that its own facets do not make once more.
    pub fn of_free_directions(
        free: &FreeDirections<'_>,
        pieces: [&[&Solid]; 2],
    ) -> Result<Self, ProofFileError> {
        let cast = free.cast();
        let made = MadeSolids::of(pieces, [cast.moving(), cast.fixed()])?;
        let [moving, fixed] = made.bodies()?;
        let poses = [cast.moving_pose(), cast.fixed_pose()];
        let options = free.options().with_tolerance(free.tolerance());
        let again = FreeDirections::of(&moving.at(poses[0]), &fixed.at(poses[1]), options);
        let statement = match again {
            Ok(again) => FreeStatement::of(&again, [moving, fixed]),
            Err(FreeError::Query(error)) => return Err(error.into()),
            Err(_) => Err(CertificateError::Start),
        };
        let statement = statement.map_err(|_| ProofFileError::Changed { body: 0 })?;
        let statement = Statement::FreeDirections(statement);
        let (placement, query) = (Placement::of_two(poses), Query::Pair);
        Ok(Self { bodies: made.0.into(), placement, query, statement })
    }

    /// What it says; true if [`Self::check`] does not object.
    pub const fn statement(&self) -> &Statement {
        &self.statement
    }

    /// Returns the number of facets, of the moving bodies and of the fixed ones, that turn inside out or pass through
    /// others when the solids are offset inwards by half the tolerance each
    /// ([`ShrinkReport::inverted`](colltrans_solid::ShrinkReport::inverted)). There the statement about the offset solids
    /// says little about the solids themselves. A body that several pairs or places share counts once on each side.
    pub fn inverted(&self) -> [usize; 2] {
        // The tolerance of each body on each side.
        let mut offset: [HashMap<usize, f64>; 2] = Default::default();
        let mut add = |side: usize, body: usize, tolerance: f64| {
            let known = offset[side].entry(body).or_default();
            *known = known.max(tolerance);
        };
        match (&self.query, &self.placement, &self.statement) {
            (Query::Motions(_), Placement::Motions(movers), Statement::Motions(of)) => {
                for (pair, statement) in movers.iter().zip(of) {
                    let tolerance = statement.tolerance();
                    (0..2).for_each(|side| add(side, pair[side].body, tolerance));
                }
            }
            (query, Placement::Poses(places), statement) => {
                let tolerance = match (query, statement) {
                    (_, Statement::Clearance(of)) => of.certificate.tolerance,
                    (_, Statement::FreeDirections(of)) => of.tolerance,
                    (Query::Scene(of), Statement::SceneClearance(_)) => of.tolerance.unwrap_or(0.0),
                    _ => 0.0,
                };
                for (number, place) in places.iter().enumerate() {
                    add(usize::from(number > 0), place.body, tolerance);
                }
            }
            _ => {}
        }
        let inverted = |(body, tolerance): (&usize, &f64)| match self.bodies.get(*body)?.as_solid()
        {
            Some(solid) if *tolerance > 0.0 => {
                Some(solid.shrink_report(tolerance / 2.0).inverted.len())
            }
            _ => None,
        };
        offset.map(|side| side.iter().filter_map(inverted).sum())
    }

    /// The gap that the bodies of a cast are to keep, in world units; 0 if they may touch.
    pub const fn keep(&self) -> f64 {
        if let Query::Cast(along) = &self.query { along.keep } else { 0.0 }
    }

    /// Returns how many obstacles there are in a scene. `None` if it is not about one.
    pub fn obstacles(&self) -> Option<usize> {
        match (&self.query, &self.placement) {
            (Query::Scene(_), Placement::Poses(places)) => places.len().checked_sub(1),
            _ => None,
        }
    }

    /// Returns the moving and the fixed body, if there are just these two.
    fn two(&self, places: &[Place]) -> Result<[AnyPlaced<'_>; 2], ProofFileError> {
        let [moving, fixed] = places else { return Err(ProofFileError::Statement) };
        let body = |of: &Place| StoredBody::of(&self.bodies, of.body);
        Ok([body(moving)?.body.at(moving.pose), body(fixed)?.body.at(fixed.pose)])
    }
}

/// Two solids made once more of their pieces, as they are read back from a file.
struct MadeSolids([StoredBody; 2]);

impl MadeSolids {
    fn of(pieces: [&[&Solid]; 2], asked: [&Solid; 2]) -> Result<Self, ProofFileError> {
        let made = |k: usize| StoredBody::union(pieces[k], asked[k], k);
        Ok(Self([made(0)?, made(1)?]))
    }

    fn bodies(&self) -> Result<[&Solid; 2], ProofFileError> {
        let body = |k: usize| self.0[k].as_solid().ok_or(ProofFileError::Changed { body: k });
        Ok([&**body(0)?, &**body(1)?])
    }
}
