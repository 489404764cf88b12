//! Proofs as files that contain the bodies and the query.
//!
//! A file contains the bodies, exact in bits, then their placement, the query, and one statement with its
//! certificates.
//!
//! - [`file`](mod@file) is the format, [`body`] the bodies in it.
//! - [`statement`], [`scene`], [`motion`] and [`path`] are the statements, [`proven`] the results of their
//!   checks.
//! - [`verify`] joins a statement with its bodies and checks it. [`text`] renders statements as text.
//! - [`case`] stores a query about a motion.

mod body;
mod case;
mod error;
mod file;
mod motion;
mod path;
mod proven;
mod scene;
mod statement;
mod text;
mod verify;

use std::collections::HashMap;
use std::sync::OnceLock;

use serde::{Deserialize, Serialize};

use colltrans_convex::answer::{
    CertificateError, Clearance, ContactRange, Depth, Distance, FreeReason, Outcome, OverlapAhead,
    Separation, Steps, Within,
};
use colltrans_convex::cast::Cast;
use colltrans_convex::pair::Pair;
use colltrans_convex::setting::error::QueryError;
use colltrans_removal::directions::{FreeDirections, FreeError};
use colltrans_scene::{ClearanceProof, NearbyProof, NearestProof};
use colltrans_solid::body::Solid;
use colltrans_solid::kinds::AnyPlaced;
use colltrans_solid::pair::{DistanceCertificate, ProofInput};
use colltrans_solid::penetration::{
    CommonPartCertificate, DepthCertificate, SolidPenetration, VolumeOptions,
};
use colltrans_solid::{SolidCast, SolidPairSearch, SolidSteps};

use body::StoredBody;
pub use case::MotionCase;
pub use error::{ProofError, ProofFileError};
use file::{Along, Choices, Place, Placement, Query};
pub use motion::{MotionStatement, SolidMotionStatement};
pub use path::PathStatement;
pub use proven::{Proven, Verify};
use scene::PlacedScene;
pub use statement::{Contacts, DistanceStatement, FreeStatement, Slide, SolidStatement, Stop};
use statement::{common_part_with_file_facets, solid_options, with_file_facets};

/// Statement of a [`ProofFile`] about its bodies.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Statement {
    /// First contact of convex bodies, last contact, or both.
    Contacts(Contacts),
    /// Convex bodies never meet.
    Separation(Separation),
    /// Clearance of a solid.
    Clearance(SolidStatement),
    /// Distance of convex bodies in their given poses.
    Distance(DistanceStatement),
    /// Penetration depth of convex bodies in their given poses.
    Depth(Depth),
    /// Distance of solids in their given poses.
    SolidDistance(DistanceCertificate),
    /// Depth of solids in their given poses.
    SolidDepth(DepthCertificate),
    /// Common part of solids in their given poses.
    SolidCommonPart(CommonPartCertificate),
    /// Free directions of a solid.
    FreeDirections(FreeStatement),
    /// Nearest of several obstacles.
    Nearest(NearestProof),
    /// Obstacles that are closer than a length.
    Within(NearbyProof),
    /// Obstacle that blocks the moving body, and the position.
    SceneClearance(ClearanceProof),
    /// First contact of the bodies of each pair along their motions.
    Motions(Vec<MotionStatement>),
    /// First contact of bodies of a mechanism.
    Path(PathStatement),
}

/// Proof that owns its bodies. A reader of the file can check it without a search.
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
    /// Result of [`Self::inverted_facets`], computed when it is first requested.
    inverted: OnceLock<[usize; 2]>,
}

impl ProofFile {
    fn new(
        bodies: Vec<StoredBody>,
        placement: Placement,
        query: Query,
        statement: Statement,
    ) -> Self {
        Self { bodies, placement, query, statement, inverted: OnceLock::new() }
    }

    /// Builds the proof of an answer of [`Cast::first_contact`]. `cast` must be the cast of the query.
    pub fn of_outcome(cast: &Cast<'_>, outcome: &Outcome) -> Self {
        let statement = match outcome {
            Outcome::Contact(contact) => {
                Statement::Contacts(Contacts::from_contacts(Some(contact), None))
            }
            Outcome::Grazing(grazing) => {
                Statement::Contacts(Contacts::from_grazing(cast, grazing, None))
            }
            Outcome::Separated(separated) => Statement::Separation(separated.certificate),
        };
        Self::of_convex(cast, statement)
    }

    /// Builds the proof of an answer of [`Cast::contact_range`]. `cast` must be the cast of the query.
    pub fn of_range(cast: &Cast<'_>, range: &ContactRange) -> Self {
        let contacts = match range {
            ContactRange::Contact { first, last } => {
                Contacts::from_contacts(Some(first), Some(last))
            }
            ContactRange::Grazing { first, last } => {
                Contacts::from_grazing(cast, first, Some(last))
            }
            ContactRange::Separated(of) => return Self::of_outcome(cast, &Outcome::Separated(*of)),
        };
        Self::of_convex(cast, Statement::Contacts(contacts))
    }

    /// Builds the proof of an answer of [`Cast::clearance`]. `cast` must be the cast of the query.
    pub fn of_clearance(cast: &Cast<'_>, clearance: &Clearance) -> Self {
        let outcome = |of| Self::of_outcome(cast, &of);
        let ends = |first, last| {
            Self::of_convex(cast, Statement::Contacts(Contacts::from_contacts(first, last)))
        };
        match clearance {
            Clearance::Blocked { contact, .. } => outcome(Outcome::Contact(*contact)),
            Clearance::Free(FreeReason::Slides(grazing)) => outcome(Outcome::Grazing(*grazing)),
            Clearance::Free(FreeReason::Separated(of)) => outcome(Outcome::Separated(*of)),
            Clearance::Free(FreeReason::Behind(last)) => ends(None, Some(last)),
            Clearance::Overlapping(OverlapAhead { first, last }) => ends(Some(first), Some(last)),
        }
    }

    fn of_convex(cast: &Cast<'_>, statement: Statement) -> Self {
        let bodies =
            vec![StoredBody::from_convex(cast.moving()), StoredBody::from_convex(cast.fixed())];
        let along = Along { direction: cast.direction(), min_gap: cast.options().min_gap };
        let poses = [cast.moving_pose(), cast.fixed_pose()];
        Self::new(bodies, Placement::of_two(poses), Query::Cast(along), statement)
    }

    /// Builds the proof of an answer of [`Pair::distance`] or [`Pair::within`]. `pair` must be the pair of
    /// the query.
    pub fn of_distance(pair: &Pair<'_>, answer: impl Into<DistanceStatement>) -> Self {
        Self::of_pair(pair, Statement::Distance(answer.into()))
    }

    /// Builds the proof of an answer of [`Pair::depth`]. `pair` must be the pair of the query.
    pub fn of_depth(pair: &Pair<'_>, depth: &Depth) -> Self {
        let mut depth = depth.clone();
        depth.steps = Steps::default();
        Self::of_pair(pair, Statement::Depth(depth))
    }

    fn of_pair(pair: &Pair<'_>, statement: Statement) -> Self {
        let bodies =
            vec![StoredBody::from_convex(pair.moving()), StoredBody::from_convex(pair.fixed())];
        let placement = Placement::of_two([pair.moving_pose(), pair.fixed_pose()]);
        Self::new(bodies, placement, Query::Pair, statement)
    }

    /// Computes [`Cast::clearance`] of solids again, with its proof. Each body is the union of its `pieces`
    /// ([`Solid::from_pieces`]), or itself its only piece. Of the options, only the start overlap, the
    /// tolerance and the minimum gap are used.
    ///
    /// # Errors
    /// Returns an error for a body that cannot be rebuilt from its own facets.
    pub fn of_solids(
        cast: &Cast<'_, Solid>,
        pieces: [&[&Solid]; 2],
    ) -> Result<Self, ProofFileError> {
        let made = RebuiltSolids::rebuild(pieces, [cast.moving(), cast.fixed()])?;
        let [moving, fixed] = made.solids()?;
        let (poses, direction) = ([cast.moving_pose(), cast.fixed_pose()], cast.direction());
        let min_gap = cast.options().min_gap;
        let options = solid_options(cast.options().start_overlap, cast.tolerance(), min_gap);
        let again = Cast::new(moving.at(poses[0]), fixed.at(poses[1]), direction)?;
        let statement = Statement::Clearance(SolidStatement::of(&again.with_options(options)?)?);
        let (placement, query) =
            (Placement::of_two(poses), Query::Cast(Along { direction, min_gap }));
        Ok(Self::new(made.0.into(), placement, query, statement))
    }

    /// Computes the distance of solids with its proof: [`Pair::distance`], or [`Pair::within`] for a length,
    /// which may prove only one bound. `pieces` has the meaning that it has for [`Self::of_solids`].
    ///
    /// # Errors
    /// Returns an error for a body that cannot be rebuilt from its own facets, and for a length that is
    /// negative or not a number.
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

    /// Computes [`Pair::distance`] of solids and its proof. `pieces` has the meaning that it has for
    /// [`Self::of_solids`].
    ///
    /// The given bodies are searched for the answer. If the tree of a body that is rebuilt from the file
    /// differs, the bodies of the file are searched as well, for the proof. Trees of more than 4,096 facets
    /// may differ.
    ///
    /// # Errors
    /// Returns an error for a body that cannot be rebuilt from its own facets.
    pub fn with_solid_distance(
        pair: &Pair<'_, Solid>,
        pieces: [&[&Solid]; 2],
    ) -> Result<(Distance<Solid>, Self), ProofFileError> {
        Self::with_search(pair, pieces, |pair| pair.distance_with_proof_input(true))
    }

    /// Computes [`Pair::within`] of solids for a length, and its proof. See [`Self::with_solid_distance`].
    ///
    /// # Errors
    /// Returns the errors of [`Self::with_solid_distance`], and an error for a length that is negative or not
    /// a number.
    pub fn with_solid_within(
        pair: &Pair<'_, Solid>,
        pieces: [&[&Solid]; 2],
        length: f64,
    ) -> Result<((Within<Solid>, SolidSteps), Self), ProofFileError> {
        Self::with_search(pair, pieces, |pair| pair.within_with_proof_input(length, true))
    }

    /// Computes [`SolidPenetration::certified_depth`] for bodies that are rebuilt from the file. `pieces` has
    /// the meaning that it has for [`Self::of_solids`].
    ///
    /// # Errors
    /// Returns the errors of the query, and an error for a body that cannot be rebuilt from its own facets.
    pub fn of_solid_depth(
        pair: &Pair<'_, Solid>,
        pieces: [&[&Solid]; 2],
    ) -> Result<Self, ProofFileError> {
        let made = RebuiltSolids::rebuild(pieces, [pair.moving(), pair.fixed()])?;
        let [moving, fixed] = made.solids()?;
        let poses = [pair.moving_pose(), pair.fixed_pose()];
        let mut proof = Pair::new(moving.at(poses[0]), fixed.at(poses[1]))?.certified_depth()?;
        proof.apart = with_file_facets(proof.apart, [moving, fixed]);
        let (placement, query) = (Placement::of_two(poses), Query::Pair);
        Ok(Self::new(made.0.into(), placement, query, Statement::SolidDepth(proof)))
    }

    /// Computes [`SolidPenetration::certified_common_part`] for bodies that are rebuilt from the file. `pieces`
    /// has the meaning that it has for [`Self::of_solids`].
    ///
    /// # Errors
    /// Returns the errors of the query, and an error for a body that cannot be rebuilt from its own facets. One that is so
    /// flat that rounding decides the sign of its volume may be reversed.
    pub fn of_solid_common_part(
        pair: &Pair<'_, Solid>,
        pieces: [&[&Solid]; 2],
        options: VolumeOptions,
    ) -> Result<Self, ProofFileError> {
        let made = RebuiltSolids::rebuild(pieces, [pair.moving(), pair.fixed()])?;
        let [moving, fixed] = made.solids()?;
        let poses = [pair.moving_pose(), pair.fixed_pose()];
        if let Some(body) = [moving, fixed].iter().position(|made| made.report().turned() > 0) {
            return Err(ProofFileError::Changed { body });
        }
        let again = Pair::new(moving.at(poses[0]), fixed.at(poses[1]))?;
        let proof = again.certified_common_part(options)?;
        let statement =
            Statement::SolidCommonPart(common_part_with_file_facets(proof, [moving, fixed]));
        let (placement, query) = (Placement::of_two(poses), Query::Pair);
        Ok(Self::new(made.0.into(), placement, query, statement))
    }

    /// Computes an answer about the given bodies, and its proof about the bodies of the file.
    fn with_search<T>(
        pair: &Pair<'_, Solid>,
        pieces: [&[&Solid]; 2],
        ask: impl Fn(&Pair<'_, Solid>) -> Result<(T, ProofInput), QueryError>,
    ) -> Result<(T, Self), ProofFileError> {
        let bodies = [pair.moving(), pair.fixed()];
        let made = RebuiltSolids::rebuild(pieces, bodies)?;
        let [moving, fixed] = made.solids()?;
        let poses = [pair.moving_pose(), pair.fixed_pose()];
        let again = Pair::new(moving.at(poses[0]), fixed.at(poses[1]))?;
        let (answer, mut found) = ask(pair)?;
        if !(bodies[0].has_same_tree(moving) && bodies[1].has_same_tree(fixed)) {
            found = ask(&again)?.1;
        }
        let statement = Statement::SolidDistance(with_file_facets(
            again.prove_lower_bound(found)?,
            [moving, fixed],
        ));
        let (placement, query) = (Placement::of_two(poses), Query::Pair);
        Ok((answer, Self::new(made.0.into(), placement, query, statement)))
    }

    /// Computes the free directions again, for bodies that are rebuilt from the file, and their proof.
    /// `pieces` has the meaning that it has for [`Self::of_solids`].
    ///
    /// # Errors
    /// Returns an error for a body that cannot be rebuilt from its own facets, or if the free directions of
    /// the rebuilt bodies cannot be computed.
    pub fn of_free_directions(
        free: &FreeDirections<'_>,
        pieces: [&[&Solid]; 2],
    ) -> Result<Self, ProofFileError> {
        let cast = free.cast();
        let made = RebuiltSolids::rebuild(pieces, [cast.moving(), cast.fixed()])?;
        let [moving, fixed] = made.solids()?;
        let poses = [cast.moving_pose(), cast.fixed_pose()];
        let options = free.options().with_tolerance(free.tolerance());
        let again = FreeDirections::compute(&moving.at(poses[0]), &fixed.at(poses[1]), options);
        let statement = match again {
            Ok(again) => FreeStatement::of(&again, [moving, fixed]),
            Err(FreeError::Query(error)) => return Err(error.into()),
            Err(_) => Err(CertificateError::StartClaim),
        };
        let statement = statement.map_err(|_| ProofFileError::Changed { body: 0 })?;
        let statement = Statement::FreeDirections(statement);
        let (placement, query) = (Placement::of_two(poses), Query::Pair);
        Ok(Self::new(made.0.into(), placement, query, statement))
    }

    /// Returns the statement. It is true if [`Self::check`] succeeds.
    pub const fn statement(&self) -> &Statement {
        &self.statement
    }

    /// Returns the number of facets, of the moving bodies and of the fixed ones, that turn inside out or pass
    /// through others when the solids are offset inwards by half the tolerance each
    /// ([`ShrinkReport::inverted`](colltrans_solid::ShrinkReport::inverted)). At these facets the statement
    /// about the offset solids does not describe the original ones. A body that several pairs or places share
    /// counts once on each side. The result is 0 if the statement has no tolerance. The default tolerance of a
    /// scene query is not in the file, and is computed from its bodies.
    pub fn inverted_facets(&self) -> [usize; 2] {
        *self.inverted.get_or_init(|| self.count_inverted_facets())
    }

    fn count_inverted_facets(&self) -> [usize; 2] {
        // The largest tolerance of each body on each side.
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
            (
                Query::Scene(choices @ Choices { tolerance: None, .. }),
                Placement::Poses(places),
                Statement::SceneClearance(of),
            ) => {
                // Each pair has its own default tolerance.
                let scene = PlacedScene::new(&self.bodies, places, *choices);
                let tolerances = scene.and_then(|scene| scene.tolerances(of.direction));
                let obstacles = places.iter().skip(1);
                for (place, tolerance) in obstacles.zip(tolerances.unwrap_or_default()) {
                    add(0, places[0].body, tolerance);
                    add(1, place.body, tolerance);
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

    /// Returns the minimum gap of a query of two bodies along a direction, in world units. It is 0 if the query
    /// has no minimum gap, and for all other kinds of queries.
    pub const fn min_gap(&self) -> f64 {
        if let Query::Cast(along) = &self.query { along.min_gap } else { 0.0 }
    }

    /// Returns the number of obstacles of a scene, and `None` for other queries.
    pub fn obstacle_count(&self) -> Option<usize> {
        match (&self.query, &self.placement) {
            (Query::Scene(_), Placement::Poses(places)) => places.len().checked_sub(1),
            _ => None,
        }
    }

    /// Returns the moving and the fixed body. Returns an error unless there are exactly two places.
    fn two_placed(&self, places: &[Place]) -> Result<[AnyPlaced<'_>; 2], ProofFileError> {
        let [moving, fixed] = places else { return Err(ProofFileError::Statement) };
        let body = |of: &Place| StoredBody::at_index(&self.bodies, of.body);
        Ok([body(moving)?.body.at(moving.pose), body(fixed)?.body.at(fixed.pose)])
    }
}

/// Two solids that are rebuilt from their pieces, as if read from a file.
struct RebuiltSolids([StoredBody; 2]);

impl RebuiltSolids {
    fn rebuild(pieces: [&[&Solid]; 2], expected: [&Solid; 2]) -> Result<Self, ProofFileError> {
        let made = |k: usize| StoredBody::from_pieces(pieces[k], expected[k], k);
        Ok(Self([made(0)?, made(1)?]))
    }

    fn solids(&self) -> Result<[&Solid; 2], ProofFileError> {
        let body = |k: usize| self.0[k].as_solid().ok_or(ProofFileError::Changed { body: k });
        Ok([&**body(0)?, &**body(1)?])
    }
}
