//! Many casts of one pair of bodies that do not rotate.
//!
//! - `M0` is the Minkowski difference `M` without translations: `M = M0 + offset` with `offset = t_Q - t_P`. It is
//!   constant while the rotations are.
//! - The faces of `M0` are computed once (`faces`). A cast then intersects a line with this polytope.
//! - `search` walks from a guess (`entry_guess`) to the face that the line enters, or to the silhouette. `approach` has
//!   a map for one direction. `proof` builds the answer.
//! - Invariant: the faces are only proposals. The bound of a plane is computed from all vertices of both bodies, and
//!   the vertex pairs of a contact certainly enclose the line. Uncertain cases (ties, touching, grazing) are left to
//!   the ordinary cast. The certificate is that of an ordinary cast.

mod approach;
mod entry_guess;
mod faces;
mod proof;
mod search;

use glam::DVec3;

pub use approach::DirectionMap;
use colltrans_convex::answer::{Clearance, ContactRange, Outcome, Solver};
use colltrans_convex::body::{ConvexPolyhedron, Placed, Pose};
use colltrans_convex::cast::{Cast, clearance_by_casts, contact_range_by_casts};
use colltrans_convex::setting::TwoBodies;
use colltrans_convex::setting::error::QueryError;
use faces::Faces;
use proof::Line;
use search::FaceView;

/// Maximum number of vertex pairs for which the faces are computed. Beyond, computing them takes as long as thousands
/// of casts.
const MAX_VERTEX_PAIRS: usize = 1 << 14;

/// Number of casts, besides one for each vertex pair, after which computing the faces pays off (measured by `bulk` of
/// the benchmarks).
const MIN_CASTS: usize = 500;

/// Two bodies with fixed rotations, for casts from many positions and along many directions.
///
/// The faces of the Minkowski difference are computed once. This pays off after about 500 casts plus one for each
/// vertex pair ([`Self::break_even_casts`]). A cast of bodies with up to 64 vertices then takes at most a third of the
/// time. A cast along a direction that is used repeatedly ([`Self::for_direction`]) takes a sixth. Answers have the
/// certificates of ordinary casts, and [`Cast::verify`] checks them.
///
/// These casts are answered by the ordinary search instead:
/// - casts of other bodies or other rotations,
/// - casts that the faces do not decide with certainty, because the bodies only touch or graze, or because the line
///   passes through an edge of the difference,
/// - casts of two flat bodies (polygons, segments or points), and of bodies with more than 16,384 vertex pairs,
/// - casts with [`Solver::Cta`] or a minimum gap.
///
/// The outcome is of the same kind as that of the [`Cast`], and its bounds are proven as well. The last digits may
/// differ, because they are computed from another triangle of the same face. For separated bodies the plane and its
/// margin are different, as with a [`Tracker`](colltrans_convex::Tracker). The bits depend only on the bodies, the
/// rotations and the cast. They do not depend on other casts, their order, threads or the platform.
///
/// ```
/// use colltrans::glam::{DQuat, DVec3};
/// use colltrans::{Cast, ConvexPolyhedron, FixedRotations, Outcome, Pose};
///
/// let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE)?;
/// let turn = DQuat::from_xyzw(0.1, 0.2, 0.3, 0.9).normalize();
/// let [start, world] = [Pose::new(turn, DVec3::ZERO)?, Pose::IDENTITY];
/// let rotations = FixedRotations::new(cube.at(start), cube.at(world));
/// let down = rotations.for_direction(DVec3::NEG_Z)?;
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
    /// The bodies with their rotations, both at the origin.
    bodies: TwoBodies<'a>,
    faces: Option<Faces>,
}

impl<'a> FixedRotations<'a> {
    /// Computes the faces. Only the rotations of the poses matter.
    pub fn new(moving: Placed<'a>, fixed: Placed<'a>) -> Self {
        let still = |of: Placed<'a>| Placed {
            pose: Pose::from_checked_entries(of.pose.matrix(), DVec3::ZERO),
            ..of
        };
        let bodies = TwoBodies::new(still(moving), still(fixed));
        let faces =
            Self::break_even_casts(moving.body, fixed.body).and_then(|_| Faces::new(&bodies));
        Self { bodies, faces }
    }

    /// Returns the approximate number of casts after which computing the faces pays off. Returns `None` for bodies
    /// whose faces are not computed: two flat bodies, a rounded one, or more than 16,384 vertex pairs.
    pub fn break_even_casts(moving: &ConvexPolyhedron, fixed: &ConvexPolyhedron) -> Option<usize> {
        let pairs = moving.vertices().len() * fixed.vertices().len();
        let flat = moving.dimension().max(fixed.dimension()) < 3;
        let rounded = moving.radius() + fixed.radius() > 0.0;
        (pairs <= MAX_VERTEX_PAIRS && !flat && !rounded).then_some(MIN_CASTS + pairs)
    }

    /// Builds a map for casts along one direction. It takes less than a tenth of the time of the faces.
    ///
    /// # Errors
    /// Returns [`QueryError::Direction`] if the direction is zero, not finite or out of range.
    pub fn for_direction(&self, direction: DVec3) -> Result<DirectionMap<'_, 'a>, QueryError> {
        DirectionMap::new(self, direction)
    }

    /// Computes the answer of [`Cast::first_contact`].
    ///
    /// # Errors
    /// Returns the errors of [`Cast::first_contact`].
    pub fn first_contact(&self, cast: &Cast<'a>) -> Result<Outcome, QueryError> {
        match self.outcome_by_faces(cast) {
            Some(outcome) => Ok(outcome),
            None => cast.first_contact(),
        }
    }

    /// Computes the answer of [`Cast::contact_range`].
    ///
    /// # Errors
    /// Returns the errors of [`Cast::first_contact`].
    pub fn contact_range(&self, cast: &Cast<'a>) -> Result<ContactRange, QueryError> {
        contact_range_by_casts(cast, |cast| self.first_contact(cast))
    }

    /// Computes the answer of [`Cast::clearance`].
    ///
    /// # Errors
    /// Returns the errors of [`Cast::first_contact`].
    pub fn clearance(&self, cast: &Cast<'a>) -> Result<Clearance, QueryError> {
        clearance_by_casts(cast, |cast| self.first_contact(cast))
    }

    /// Returns the answer by the faces, or `None` if they do not make it certain.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "moved about, an outcome goes through memory")]
    fn outcome_by_faces(&self, cast: &Cast<'a>) -> Option<Outcome> {
        let faces = self.faces_for(cast)?;
        let line = Line::from_cast(cast);
        FaceView::new(faces, &line).outcome_by_faces(&line)
    }

    /// Returns the faces if the cast is one of these bodies and rotations, with options that the faces support.
    #[inline]
    fn faces_for(&self, cast: &Cast<'a>) -> Option<&Faces> {
        let (requested, stored) = (&cast.setting.bodies, &self.bodies);
        let same = std::ptr::eq(requested.moving, stored.moving)
            && std::ptr::eq(requested.fixed, stored.fixed)
            && requested.moving_matrix == stored.moving_matrix
            && requested.fixed_matrix == stored.fixed_matrix;
        let plain = cast.options.min_gap == 0.0
            && !cast.setting.is_rounded()
            && cast.options.solver != Solver::Cta;
        self.faces.as_ref().filter(|_| same && plain)
    }
}
