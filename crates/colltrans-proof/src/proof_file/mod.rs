//! A proof with all that it is about, as one file.
//!
//! Bodies are written as they are, exact in bits, with their poses and the direction of a cast; then what
//! is claimed of them, with its certificates. A certificate between solids tells facets by their place
//! in a tree, so it is made for the bodies as they are read back from the file.
//!
//! [`statement`] is what is said of bodies, and how it is checked; [`file`] writes and reads it; [`words`] tell it.
//! [`scene`] is all of that of one body among many, [`motion`] and [`solid_motion`] of bodies that turn, [`path`] of a
//! path of joints.

mod file;
mod motion;
mod path;
mod scene;
mod solid_motion;
mod statement;
mod words;

use glam::DVec3;

use colltrans_convex::answer::{
    CertificateError, Clearance, ContactRange, Depth, Distance, Outcome, OverlapAhead, Steps,
    WhyFree, Within,
};
use colltrans_convex::body::{ConvexPolyhedron, Pose};
use colltrans_convex::cast::{CaseError, Cast};
use colltrans_convex::pair::Pair;
use colltrans_convex::setting::error::QueryError;
use colltrans_removal::free::{FreeDirections, FreeError};
use colltrans_solid::SolidSteps;
use colltrans_solid::body::Solid;
use colltrans_solid::pair::Unproven;
use colltrans_solid::{SolidCast, SolidPairSearch};
use file::{Pieces, again};
pub use motion::{MotionCase, MotionProofFile, MotionProofFiles};
pub use path::{PathCheckError, PathFileError, PathProofFile, PathStatement};
pub use scene::{SceneProof, SceneStatement};
pub use solid_motion::SolidMotionProofFile;
use statement::options;
pub use statement::{
    Contacts, DistanceStatement, FreeStatement, Slide, SolidStatement, Statement, Stop,
};

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
        let mut depth = depth.clone();
        depth.steps = Steps::default();
        Self::of_pair(pair, Statement::Depth(depth))
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

    /// Of the distance of solids, asked with its proof: of [`Pair::distance`], or of
    /// [`Pair::within`] a length, which may prove one bound alone. `pieces` as in [`Self::of_solids`].
    ///
    /// # Errors
    /// A body that its own facets do not make once more; a length that is negative or not a number.
    pub fn of_solid_distance(
        pair: &Pair<'_, Solid>,
        pieces: [&[&Solid]; 2],
        within: Option<f64>,
    ) -> Result<Self, CaseError> {
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
    ) -> Result<(Distance<Solid>, Self), CaseError> {
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
    ) -> Result<((Within<Solid>, SolidSteps), Self), CaseError> {
        Self::of_search(pair, pieces, |pair| pair.decide(length, true))
    }

    /// An answer about bodies, and its proof about those that the file has.
    fn of_search<T>(
        pair: &Pair<'_, Solid>,
        pieces: [&[&Solid]; 2],
        ask: impl Fn(&Pair<'_, Solid>) -> Result<(T, Unproven), QueryError>,
    ) -> Result<(T, Self), CaseError> {
        let bodies = [pair.moving(), pair.fixed()];
        let (made, of) = again(pieces, bodies)?;
        let poses = [pair.moving_pose(), pair.fixed_pose()];
        let again = Pair::new(made[0].at(poses[0]), made[1].at(poses[1]))?;
        let (answer, mut found) = ask(pair)?;
        if !(bodies[0].has_tree_of(&made[0]) && bodies[1].has_tree_of(&made[1])) {
            found = ask(&again)?.1;
        }
        let proof = again.prove(found)?;
        let (bodies, statement) = (Bodies::Solids { made, of }, Statement::SolidDistance(proof));
        Ok((answer, Self { bodies, poses, along: None, statement }))
    }

    /// Of all free directions, asked once more of the bodies as a file has them. `pieces` as in [`Self::of_solids`].
    ///
    /// # Errors
    /// A body that its own facets do not make once more.
    pub fn of_free_directions(
        free: &FreeDirections<'_>,
        pieces: [&[&Solid]; 2],
    ) -> Result<Self, CaseError> {
        let cast = free.cast();
        let (made, of) = again(pieces, [cast.moving(), cast.fixed()])?;
        let poses = [cast.moving_pose(), cast.fixed_pose()];
        let options = free.options().with_tolerance(free.tolerance());
        let again = FreeDirections::of(&made[0].at(poses[0]), &made[1].at(poses[1]), options);
        let statement = match again {
            Ok(again) => FreeStatement::of(&again, &made),
            Err(FreeError::Query(error)) => return Err(error.into()),
            Err(_) => Err(CertificateError::Start),
        };
        let statement = statement.map_err(|_| CaseError::Changed { which: "moving" })?;
        let bodies = Bodies::Solids { made, of };
        Ok(Self { bodies, poses, along: None, statement: Statement::FreeDirections(statement) })
    }

    /// What it says of all directions, if that is what it is about: checked, as by [`Self::check`].
    ///
    /// # Errors
    /// The first thing that is not proven.
    pub fn free_directions(&self) -> Option<Result<FreeDirections<'_>, CertificateError>> {
        match (&self.bodies, &self.statement) {
            (Bodies::Solids { made, .. }, Statement::FreeDirections(of)) => {
                Some(of.checked([made[0].at(self.poses[0]), made[1].at(self.poses[1])]))
            }
            _ => None,
        }
    }

    /// What it says; true if [`Self::check`] does not object.
    pub const fn statement(&self) -> &Statement {
        &self.statement
    }

    /// How many facets of the moving and of the fixed body turn inside out, or pass through others, where
    /// they are shrunk by half the tolerance each ([`ShrinkReport::inverted`](colltrans_solid::ShrinkReport::inverted)):
    /// what is said of shrunk bodies says little there.
    pub fn inverted(&self) -> [usize; 2] {
        let tolerance = match &self.statement {
            Statement::Clearance(of) => of.certificate.tolerance,
            Statement::FreeDirections(of) => of.tolerance,
            _ => 0.0,
        };
        match &self.bodies {
            Bodies::Solids { made, .. } if tolerance > 0.0 => {
                made.each_ref().map(|body| body.shrink_report(tolerance / 2.0).inverted.len())
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

    /// The gap that the bodies are to keep, in world units; 0 if they may touch.
    pub fn keep(&self) -> f64 {
        self.along.map_or(0.0, |along| along.keep)
    }
}
