//! One pair of bodies asked many times while neither turns.
//!
//! Notation. `M0` is `M` for frames in one place: `M = M0 + offset`, `offset = t_Q - t_P`. While the rotations stay,
//! `M0` stays, so its faces are made once ([`faces`]) and a cast is a line through a polytope that is known:
//! [`search`] goes from a guess ([`star`]) over the faces that the line may enter to the one that it does enter, or
//! over the rim of its shadow; [`approach`] has a map of the shadow for one direction. [`proof`] makes the answer.
//!
//! Invariant. The faces only propose: a plane's bound was computed from all vertices of both bodies, the pairs of a
//! contact are around the line for certain, and what is not certain (ties, touching, grazing) is left to the ordinary
//! cast. The certificate is that of any cast.

mod approach;
mod faces;
mod proof;
mod search;
mod star;

use glam::DVec3;

pub use approach::Approach;
use colltrans_convex::answer::{Clearance, ContactRange, Outcome, Solver};
use colltrans_convex::body::{ConvexPolyhedron, Placed, Pose};
use colltrans_convex::cast::{Cast, clearance_of, contact_range_by_casts};
use colltrans_convex::setting::TwoBodies;
use colltrans_convex::setting::error::QueryError;
use faces::Faces;
use proof::Line;
use search::Sight;

/// More pairs of vertices than this are no bulk: making the faces of `M` takes as long as thousands of casts.
const MOST_PAIRS: usize = 1 << 14;

/// After how many casts making the faces has paid: so many, and one for each pair of vertices (measured by `bulk` of
/// the benchmarks).
const PAYS_AFTER: usize = 500;

/// Two bodies and their rotations, for casts from many places and along many directions.
///
/// The faces of the Minkowski difference are made once, in about the time of some hundred casts
/// ([`Self::pays_after`]); then a cast of bodies of up to 64 vertices takes a third of the time or less, and one along a
/// direction that is asked again and again ([`Self::along`]) a sixth. Answers are proven as those of any cast, for what
/// [`Cast::verify`] checks; a cast that is not one of these bodies with these rotations is answered all the same, by the
/// ordinary way, as is one whose answer the faces do not make certain: bodies that only touch or graze, a line
/// through an edge of the difference. So are all casts of flat bodies, of more than 16,384 pairs of vertices,
/// with [`Solver::Cta`], and such that keep a gap.
///
/// Kinds of outcomes are those of the [`Cast`], and both are between the same true bounds, but the last digits may
/// differ: they are computed from another triangle of the same face. Of separated bodies the plane, and so the margin
/// along it, is another of many, as with a [`Tracker`](colltrans_convex::Tracker). The bits depend on nothing but the bodies,
/// the rotations and the cast: not on other casts, their order, threads or the platform.
///
/// ```
/// use colltrans::glam::{DQuat, DVec3};
/// use colltrans::{Cast, ConvexPolyhedron, FixedRotations, Outcome, Pose};
///
/// let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE)?;
/// let turn = DQuat::from_xyzw(0.1, 0.2, 0.3, 0.9).normalize();
/// let [start, world] = [Pose::new(turn, DVec3::ZERO)?, Pose::IDENTITY];
/// let rotations = FixedRotations::new(cube.at(start), cube.at(world));
/// let down = rotations.along(DVec3::NEG_Z)?;
/// for k in 0..100 {
///     let place = Pose::new(turn, DVec3::new(0.01 * f64::from(k), 0.2, 4.0))?;
///     let cast = Cast::new(cube.at(place), cube.at(world), DVec3::NEG_Z)?;
///     let Outcome::Contact(contact) = down.first_contact(&cast)? else {
///         unreachable!("it stays above")
///     };
///     assert!(cast.verify(&contact.certificate)? < 1e-13);
///     let Outcome::Contact(ordinary) = cast.first_contact()? else { unreachable!() };
///     assert!((contact.translation - ordinary.translation).abs() < 1e-14);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct FixedRotations<'a> {
    /// With their frames in one place.
    bodies: TwoBodies<'a>,
    faces: Option<Faces>,
}

impl<'a> FixedRotations<'a> {
    /// Makes the faces. Of where the bodies are only the rotations matter.
    pub fn new(moving: Placed<'a>, fixed: Placed<'a>) -> Self {
        let still =
            |of: Placed<'a>| Placed { pose: Pose::checked(of.pose.matrix(), DVec3::ZERO), ..of };
        let bodies = TwoBodies::new(still(moving), still(fixed));
        let faces = Self::pays_after(moving.body, fixed.body).and_then(|_| Faces::new(&bodies));
        Self { bodies, faces }
    }

    /// After how many casts making the faces has paid, about; `None` of bodies whose faces are not made.
    pub fn pays_after(moving: &ConvexPolyhedron, fixed: &ConvexPolyhedron) -> Option<usize> {
        let pairs = moving.vertices().len() * fixed.vertices().len();
        let flat = moving.dimension().max(fixed.dimension()) < 3;
        (pairs <= MOST_PAIRS && !flat).then_some(PAYS_AFTER + pairs)
    }

    /// With a map for one direction, made in less than a tenth of the time of the faces.
    ///
    /// # Errors
    /// A direction that is zero, not finite or out of range.
    pub fn along(&self, direction: DVec3) -> Result<Approach<'_, 'a>, QueryError> {
        Approach::new(self, direction)
    }

    /// [`Cast::first_contact`].
    ///
    /// # Errors
    /// As [`Cast::first_contact`].
    pub fn first_contact(&self, cast: &Cast<'a>) -> Result<Outcome, QueryError> {
        match self.found(cast) {
            Some(outcome) => Ok(outcome),
            None => cast.first_contact(),
        }
    }

    /// [`Cast::contact_range`].
    ///
    /// # Errors
    /// As [`Cast::first_contact`].
    pub fn contact_range(&self, cast: &Cast<'a>) -> Result<ContactRange, QueryError> {
        contact_range_by_casts(cast, |cast| self.first_contact(cast))
    }

    /// [`Cast::clearance`].
    ///
    /// # Errors
    /// As [`Cast::first_contact`].
    pub fn clearance(&self, cast: &Cast<'a>) -> Result<Clearance, QueryError> {
        clearance_of(cast, |cast| self.first_contact(cast))
    }

    /// The answer of the faces, if they have one.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "moved about, an outcome goes through memory")]
    fn found(&self, cast: &Cast<'a>) -> Option<Outcome> {
        let faces = self.faces_for(cast)?;
        let line = Line::of(cast);
        Sight::new(faces, &line).found(&line)
    }

    /// The faces, if the cast is one of these bodies so turned that faces can answer.
    #[inline]
    fn faces_for(&self, cast: &Cast<'a>) -> Option<&Faces> {
        let (asked, known) = (&cast.setting.bodies, &self.bodies);
        let same = std::ptr::eq(asked.moving, known.moving)
            && std::ptr::eq(asked.fixed, known.fixed)
            && asked.moving_matrix == known.moving_matrix
            && asked.fixed_matrix == known.fixed_matrix;
        let plain = cast.options.keep == 0.0 && cast.options.solver != Solver::Cta;
        self.faces.as_ref().filter(|_| same && plain)
    }
}
