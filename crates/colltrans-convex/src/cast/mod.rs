//! A cast: two placed bodies and a direction, checked once and queried many times.
//!
//! - [`Cast`] holds the setting and the options.
//! - `multi_cast` derives the answers that need more than one cast.
//! - `contact` computes details of a contact on request.
//! - `shadow_overlap` bounds overlaps of shadows.
//! - `case_file` saves a query as a file (feature `json`).

#[cfg(feature = "json")]
pub mod case_file;
mod contact;
mod multi_cast;
pub mod shadow_overlap;

use derive_where::derive_where;
use std::fmt;

use glam::DVec3;

use crate::answer::{
    CertificateError, Clearance, ContactRange, DirectionalDepth, Intersection, Outcome, Proof,
    Solver,
};
use crate::body::{Body, ConvexPolyhedron, Placed, Pose};
use crate::setting::Setting;
use crate::setting::error::QueryError;
use crate::solve::observe::{NoObserver, Observer};
use crate::solve::options::{Focus, Options};
use crate::solve::{TrackerUpdate, WarmStart, min_gap, search};
#[cfg(feature = "json")]
pub use case_file::{Case, CaseError};
pub use contact::WitnessPoints;
pub use multi_cast::{
    clearance_by_casts, common_translation, contact_range_by_casts, directional_depth_by_casts,
    intersection_by_casts,
};
pub use shadow_overlap::verified_overlap;

/// A kind of body for which a [`Cast`] can be answered.
///
/// This crate implements it for convex polyhedra, `colltrans-solid` for solids. It is not meant to be
/// implemented elsewhere.
pub trait CastBody: Body {
    /// The proofs that a cast can check.
    type CastProof<'p>;

    /// Checks the options of a cast.
    #[doc(hidden)]
    fn check_options(cast: &Cast<'_, Self>) -> Result<(), QueryError>;
    /// Returns the options with a minimum gap.
    #[doc(hidden)]
    fn with_min_gap(options: Self::Options, gap: f64) -> Self::Options;
    #[doc(hidden)]
    fn first_contact(cast: &Cast<'_, Self>) -> Result<Outcome<Self>, QueryError>;
    #[doc(hidden)]
    fn contact_range(cast: &Cast<'_, Self>) -> Result<ContactRange<Self>, QueryError>;
    #[doc(hidden)]
    fn clearance(cast: &Cast<'_, Self>) -> Result<Clearance<Self>, QueryError>;
    #[doc(hidden)]
    fn intersects(cast: &Cast<'_, Self>) -> Result<Intersection<Self>, QueryError>;
    #[doc(hidden)]
    fn verify_cast(
        cast: &Cast<'_, Self>,
        proof: Self::CastProof<'_>,
    ) -> Result<f64, CertificateError>;
}

/// A moving body, a fixed body, and the direction in which the moving body is translated.
///
/// The poses place both bodies in the world. The direction is a vector of the world of any length, and
/// translations are multiples of it. A cast is cheap to build, because a search runs only when a query method
/// is called. For sequences of similar queries, see [`Tracker`](crate::Tracker).
///
/// ```
/// use colltrans::glam::DVec3;
/// use colltrans::{Cast, Clearance, ConvexPolyhedron, Outcome, Pose, FreeReason};
///
/// let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE)?;
/// let start = Pose::from_translation(DVec3::new(-3.0, 0.5, 0.0))?;
/// let cast = Cast::new(cube.at(start), cube.at(Pose::IDENTITY), DVec3::X)?;
///
/// let Outcome::Contact(contact) = cast.first_contact()? else {
///     unreachable!("half of the cube is in the way")
/// };
/// assert_eq!(contact.translation, 2.0);
/// assert_eq!(contact.normal, DVec3::X);
/// let features = contact.features(&cast);
/// assert_eq!((features.moving.kind(), features.fixed.kind()), ("face", "face"));
/// // The proof: checked against the two bodies alone.
/// let gap = cast.verify(&contact.certificate)?;
/// assert!(gap <= contact.certificate.rounding);
///
/// assert!(cast.contact_range()?.interval() == Some([2.0, 4.0]));
/// assert!(matches!(cast.reversed().clearance()?, Clearance::Free(FreeReason::Behind(_))));
/// assert!(!cast.intersects()?.meets);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
#[derive_where(Clone, Copy)]
pub struct Cast<'a, B: Body = ConvexPolyhedron> {
    #[doc(hidden)]
    pub setting: Setting<'a, B>,
    #[doc(hidden)]
    pub options: B::Options,
}

impl<'a, B: Body> Cast<'a, B> {
    /// Builds a cast with default options.
    ///
    /// # Errors
    /// Returns [`QueryError::Direction`] if the direction is zero, not finite or out of range.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "a copy through memory stalls its reader")]
    pub fn new(
        moving: Placed<'a, B>,
        fixed: Placed<'a, B>,
        direction: DVec3,
    ) -> Result<Self, QueryError> {
        Ok(Self {
            setting: Setting::new(moving, fixed, direction)?,
            options: B::Options::default(),
        })
    }

    /// Returns the cast of the same placed bodies along the opposite direction. Its first contact is the last
    /// one along this direction.
    #[inline]
    #[must_use]
    pub fn reversed(&self) -> Self {
        Self { setting: self.setting.reversed(), ..*self }
    }

    /// Returns the cast of the same placed bodies along another direction.
    ///
    /// # Errors
    /// Returns [`QueryError::Direction`] if the direction is zero, not finite or out of range.
    pub fn along(&self, direction: DVec3) -> Result<Self, QueryError> {
        Ok(Self { setting: Setting::from_bodies(self.setting.bodies, direction)?, ..*self })
    }

    /// Returns the moving body.
    pub fn moving(&self) -> &'a B {
        self.setting.moving
    }

    /// Returns the fixed body.
    pub fn fixed(&self) -> &'a B {
        self.setting.fixed
    }

    /// Returns the pose of the moving body.
    pub fn moving_pose(&self) -> Pose {
        self.setting.moving_placed().pose
    }

    /// Returns the pose of the fixed body.
    pub fn fixed_pose(&self) -> Pose {
        self.setting.fixed_placed().pose
    }

    /// Returns the direction, as given.
    pub fn direction(&self) -> DVec3 {
        self.setting.direction
    }

    /// Returns the options.
    pub fn options(&self) -> B::Options {
        self.options
    }
}

impl<B: CastBody> Cast<'_, B> {
    /// Returns the cast with other options.
    ///
    /// # Errors
    /// Returns an error if an option is invalid:
    ///
    /// - The graze tolerance is negative or not finite.
    /// - The minimum gap is negative, not finite or larger than [`MAX_MAGNITUDE`](crate::MAX_MAGNITUDE).
    /// - The narrowing gap is negative or not a number.
    /// - The tolerance of solids is negative or not finite, or leaves nothing of a closed body
    ///   ([`QueryError::NothingLeft`]).
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "a copy through memory stalls its reader")]
    pub fn with_options(self, options: B::Options) -> Result<Self, QueryError> {
        let cast = Self { options, ..self };
        B::check_options(&cast)?;
        Ok(cast)
    }

    /// Returns the cast with a minimum gap, in world units.
    ///
    /// The queries then use the translation at which the distance of the bodies falls to the gap, instead of
    /// their contact (a shape cast with a target distance, or with a skin):
    ///
    /// - [`Self::first_contact`] finds the first translation at which the distance of the bodies is the gap.
    /// - [`Self::clearance`] is the translation up to that point. Bodies that are nearer at the start are
    ///   [`Clearance::Overlapping`].
    /// - [`Self::intersects`] checks whether the distance is at most the gap now.
    ///
    /// A gap of 0 is the cast without a gap. The answers have certificates:
    ///
    /// - Contact: up to `lower`, the plane keeps the gap from the fixed body. At `upper`, the distance of the
    ///   witness points is at most the gap.
    /// - [`Separated`](crate::Separated): the margin exceeds the gap.
    /// - [`Outcome::Grazing`]: the distance of the shadows is the gap, to within the graze tolerance.
    ///
    /// The bounds are wider if the bodies pass each other at about the gap. They then differ by the
    /// translation after which a face nearly parallel to the direction is nearer by more than the rounding
    /// error.
    ///
    /// The solver of the options has no effect, except that convex bodies are also cast without the gap in two cases:
    /// if the gap is at most eight noises, and to decide whether the bodies graze without the gap. Observers receive
    /// one plane for each computed distance. They receive portals only for a gap of at most eight noises.
    ///
    /// For solids, shrunk by half of the tolerance where a query uses it, no two facets come nearer than the
    /// gap up to `lower`. Facets that pass each other, or start, at the gap to within eight noises
    /// (`256 u S`, where the size includes the gap) are an exception; they do not block. A gap of at most
    /// eight noises counts as 0.
    ///
    /// # Errors
    /// Returns [`QueryError::MinGap`] if the gap is negative, not finite or larger than
    /// [`MAX_MAGNITUDE`](crate::MAX_MAGNITUDE).
    ///
    /// ```
    /// # use colltrans::glam::DVec3;
    /// # use colltrans::{Cast, Clearance, ConvexPolyhedron, Outcome, Pose, FreeReason};
    /// let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE)?;
    /// let start = Pose::from_translation(DVec3::new(-3.0, 0.5, 0.0))?;
    /// let cast = Cast::new(cube.at(start), cube.at(Pose::IDENTITY), DVec3::X)?.with_min_gap(0.25)?;
    /// let Outcome::Contact(contact) = cast.first_contact()? else {
    ///     unreachable!("half of the cube is in the way")
    /// };
    /// assert!((contact.translation - 1.75).abs() < 1e-15);
    /// let proof = contact.certificate;
    /// assert!(proof.lower <= 1.75 && 1.75 <= proof.upper && cast.verify(&proof)? < 1e-13);
    /// // At a lateral distance of 0.5, a gap of 0.6 is reached, but one of 0.4 is not.
    /// let aside = Pose::from_translation(DVec3::new(-3.0, 1.5, 0.0))?;
    /// let aside = Cast::new(cube.at(aside), cube.at(Pose::IDENTITY), DVec3::X)?;
    /// let near = aside.with_min_gap(0.6)?.clearance()?.distance().expect("they are apart");
    /// assert!((near - (2.0 - 0.11_f64.sqrt())).abs() < 1e-13);
    /// assert!(matches!(aside.with_min_gap(0.4)?.clearance()?, Clearance::Free(FreeReason::Separated(_))));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[inline]
    pub fn with_min_gap(self, gap: f64) -> Result<Self, QueryError> {
        self.with_options(B::with_min_gap(self.options, gap))
    }

    /// Finds the first translation at which the bodies meet, if any.
    ///
    /// [`Contact::translation`](crate::Contact::translation) explains negative answers. For motion that
    /// starts at the current pose, see [`Self::clearance`]. For convex bodies the search takes `O(log n)`
    /// steps in practice, and allocates nothing except for data that [`Solver::Cta`] builds once for each
    /// body. For solids the tolerance has no effect.
    ///
    /// # Errors
    /// Returns [`QueryError::NotConverged`] if a search of convex bodies ends without an answer.
    #[inline]
    pub fn first_contact(&self) -> Result<Outcome<B>, QueryError> {
        B::first_contact(self)
    }

    /// Finds the first and the last contact, both certified.
    ///
    /// This takes two casts, along the direction and against it. Solids may separate and meet again in
    /// between; their tolerance has no effect.
    ///
    /// # Errors
    /// Returns [`QueryError::NotConverged`] if a search of convex bodies ends without an answer.
    ///
    /// ```
    /// # use colltrans::glam::DVec3;
    /// # use colltrans::{Cast, ConvexPolyhedron, Pose};
    /// let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE)?;
    /// let start = Pose::from_translation(DVec3::new(-3.0, 0.5, 0.0))?;
    /// let cast = Cast::new(cube.at(start), cube.at(Pose::IDENTITY), DVec3::X * 0.5)?;
    /// // In multiples of the direction.
    /// assert_eq!(cast.contact_range()?.interval(), Some([4.0, 8.0]));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[inline]
    pub fn contact_range(&self) -> Result<ContactRange<B>, QueryError> {
        B::contact_range(self)
    }

    /// Finds how far the moving body can move from its current pose.
    ///
    /// [`Clearance`] has three cases: the body is blocked, it is free, or the bodies overlap now. Contacts behind
    /// and grazing slides do not block. Bodies that touch now, to within rounding, block each other if the motion
    /// would make them overlap, but not if it separates them. A free solid may slide along the other body, move
    /// away from it or never meet it: the answer does not distinguish these. It has a separating plane if one was
    /// found.
    ///
    /// # Errors
    /// Returns [`QueryError::NotConverged`] if a search of convex bodies ends without an answer, and
    /// [`QueryError::NothingLeft`] if the default tolerance leaves nothing of a thin solid.
    ///
    /// ```
    /// # use colltrans::glam::DVec3;
    /// # use colltrans::{Cast, Clearance, ConvexPolyhedron, Pose, FreeReason};
    /// let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE)?;
    /// // One cube on top of another: it can move up and sideways, but not down.
    /// let (above, world) = (Pose::from_translation(DVec3::Z)?, Pose::IDENTITY);
    /// let toward = |direction| Cast::new(cube.at(above), cube.at(world), direction)?.clearance();
    /// assert!(matches!(toward(DVec3::Z)?, Clearance::Free(FreeReason::Behind(_))));
    /// assert!(matches!(toward(DVec3::X)?, Clearance::Free(FreeReason::Slides(_))));
    /// assert_eq!(toward(DVec3::NEG_Z)?.distance(), Some(0.0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[inline]
    pub fn clearance(&self) -> Result<Clearance<B>, QueryError> {
        B::clearance(self)
    }

    /// Checks whether the bodies, as closed sets, have a common point in their current poses.
    ///
    /// With a minimum gap in the options, checks whether their distance is at most the gap. The answer of solids
    /// is exact without a minimum gap. With one, it is true only if two facets are certainly within the gap, or a
    /// shell is inside the other body. The answer of convex bodies holds to within rounding error. The answer does
    /// not depend on the direction or a tolerance. Convex bodies are cast along the line through both centres,
    /// which passes through the centre of the Minkowski difference.
    ///
    /// # Errors
    /// Returns [`QueryError::NotConverged`] if a search of convex bodies ends without an answer.
    ///
    /// ```
    /// # use colltrans::glam::DVec3;
    /// # use colltrans::{Cast, ConvexPolyhedron, Pose};
    /// let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE)?;
    /// let meets = |x| {
    ///     let pose = Pose::from_translation(DVec3::new(x, 0.0, 0.0))?;
    ///     let cast = Cast::new(cube.at(pose), cube.at(Pose::IDENTITY), DVec3::X)?;
    ///     Ok::<_, Box<dyn std::error::Error>>(cast.intersects()?.meets)
    /// };
    /// assert!(meets(0.5)?);
    /// assert!(meets(1.0)?); // they touch
    /// assert!(!meets(1.001)?);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[inline]
    pub fn intersects(&self) -> Result<Intersection<B>, QueryError> {
        B::intersects(self)
    }

    /// Checks a proof against the two bodies: a [`Certificate`](crate::Certificate), a
    /// [`Separation`](crate::Separation), or for solids a `SolidCertificate`.
    ///
    /// Returns the proven difference of the bounds, in multiples of the direction, or for a separation the
    /// proven margin, in world units. The check is independent of the search. It examines all vertices for a
    /// lower bound or a margin, and three pairs of vertices for an upper bound, so it takes `O(n)` steps.
    ///
    /// The cast must be the one that was answered. For the `last` contact of a [`ContactRange`] it is the
    /// [reversed](Self::reversed) one.
    ///
    /// - A lower bound or a margin is rejected if it exceeds what the plane proves, however slightly.
    /// - An upper bound is rejected unless it exceeds the bound of the pairs by the rounding error of their
    ///   weights. An infinite one claims nothing.
    /// - Each entry of a solid's cover is checked by the boxes, slabs and normals of its two nodes, or by its
    ///   facets.
    ///
    /// # Errors
    /// Returns the reason if a claim is not proven, if the bounds are in the wrong order, or if the claimed
    /// rounding is negative or larger than rounding explains.
    ///
    /// ```
    /// # use colltrans::glam::DVec3;
    /// # use colltrans::{Cast, ConvexPolyhedron, Outcome, Pose};
    /// let triangle = ConvexPolyhedron::from_points(&[DVec3::X, DVec3::Y, DVec3::Z])?;
    /// let start = Pose::from_translation(DVec3::new(-5.0, 0.0, 0.0))?;
    /// let cast = Cast::new(triangle.at(start), triangle.at(Pose::IDENTITY), DVec3::X)?;
    /// let Outcome::Contact(contact) = cast.first_contact()? else {
    ///     unreachable!("the same triangle, five units further")
    /// };
    /// let proof = contact.certificate;
    /// assert!(cast.verify(&proof)? <= proof.rounding);
    ///
    /// let mut lie = proof;
    /// lie.lower += 1.0;
    /// assert!(cast.verify(&lie).is_err());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[inline]
    pub fn verify<'p>(&self, proof: impl Into<B::CastProof<'p>>) -> Result<f64, CertificateError> {
        B::verify_cast(self, proof.into())
    }
}

impl Cast<'_> {
    /// Returns the cast with a graze tolerance, in world units. Lateral overlaps up to this tolerance are
    /// [`Outcome::Grazing`].
    ///
    /// # Errors
    /// Returns [`QueryError::GrazeTolerance`] if the tolerance is negative or not finite.
    ///
    /// ```
    /// # use colltrans::glam::DVec3;
    /// # use colltrans::{Cast, ConvexPolyhedron, Outcome, Pose};
    /// let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE)?;
    /// // The overlap is 0.001: contact by default, grazing with a tolerance of 0.01.
    /// let start = Pose::from_translation(DVec3::new(-3.0, 0.999, 0.0))?;
    /// let cast = Cast::new(cube.at(start), cube.at(Pose::IDENTITY), DVec3::X)?;
    /// assert!(matches!(cast.first_contact()?, Outcome::Contact(_)));
    /// let Outcome::Grazing(grazing) = cast.with_graze_tolerance(0.01)?.first_contact()? else {
    ///     unreachable!("they overlap by less than tolerated")
    /// };
    /// assert!((grazing.overlap - 0.001).abs() < 1e-12);
    /// assert_eq!(grazing.contact.translation, 2.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn with_graze_tolerance(self, tolerance: f64) -> Result<Self, QueryError> {
        self.with_options(self.options.with_graze_tolerance(tolerance))
    }

    /// Returns the cast with another solver. The answer, its certificate and its accuracy do not depend on
    /// it.
    #[must_use]
    pub fn with_solver(self, solver: Solver) -> Self {
        Self { options: self.options.with_solver(solver), ..self }
    }

    /// Computes [`Self::first_contact`] and reports each step to an observer, for example a
    /// [`Clock`](crate::observe::Clock) or a [`Recording`](crate::observe::Recording).
    ///
    /// # Errors
    /// Returns the errors of [`Self::first_contact`].
    #[inline]
    pub fn first_contact_observed<O: Observer>(
        &self,
        observer: &mut O,
    ) -> Result<Outcome, QueryError> {
        let (last, mut next) = (WarmStart::Nothing, TrackerUpdate::default());
        self.search_first_contact(&Focus::NONE, &last, &mut next, observer)
    }

    /// Searches the first contact or, if the options have a minimum gap or a body is rounded, the first
    /// translation at which the distance of the cores is the sum of the gap and both radii.
    ///
    /// The search starts from the result `last` of an earlier cast, as far as `focus` allows. `next` receives
    /// the start of a later cast.
    #[inline]
    pub(crate) fn search_first_contact<O: Observer>(
        &self,
        focus: &Focus,
        last: &WarmStart,
        next: &mut TrackerUpdate,
        observer: &mut O,
    ) -> Result<Outcome, QueryError> {
        let Self { setting, options } = self;
        if cfg!(feature = "min-gap") && (options.min_gap != 0.0 || setting.is_rounded()) {
            return min_gap::convex::cast_with_min_gap(
                setting, options, focus, last, next, observer,
            );
        }
        search(setting, options, focus, last, next, observer)
    }

    /// Computes [`Self::contact_range`] and reports each step to an observer.
    ///
    /// # Errors
    /// Returns the errors of [`Self::contact_range`].
    pub fn contact_range_observed<O: Observer>(
        &self,
        observer: &mut O,
    ) -> Result<ContactRange, QueryError> {
        contact_range_by_casts(self, first_and_last(observer))
    }

    /// Computes [`Self::clearance`] and reports each step to an observer.
    ///
    /// # Errors
    /// Returns the errors of [`Self::clearance`].
    pub fn clearance_observed<O: Observer>(
        &self,
        observer: &mut O,
    ) -> Result<Clearance, QueryError> {
        clearance_by_casts(self, first_and_last(observer))
    }

    /// Computes how far the moving body must move back, against the direction, until it no longer overlaps
    /// the fixed one.
    ///
    /// # Errors
    /// Returns [`QueryError::NotConverged`] if the search ends without an answer.
    ///
    /// ```
    /// # use colltrans::glam::DVec3;
    /// # use colltrans::{Cast, ConvexPolyhedron, Pose};
    /// let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE)?;
    /// let inside = Pose::from_translation(DVec3::new(-0.75, 0.0, 0.0))?;
    /// let cast = Cast::new(cube.at(inside), cube.at(Pose::IDENTITY), DVec3::X)?;
    /// assert!((cast.directional_depth()?.depth - 0.25).abs() < 1e-13);
    /// assert!((cast.reversed().directional_depth()?.depth - 1.75).abs() < 1e-13);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn directional_depth(&self) -> Result<DirectionalDepth, QueryError> {
        directional_depth_by_casts(self, first_and_last(&mut NoObserver))
    }
}

/// Returns a function that runs the casts of a query along a direction and then against it. With [`Solver::Cta`], the
/// second one starts from the contact of the first one.
fn first_and_last<'a, O: Observer>(
    observer: &mut O,
) -> impl FnMut(&Cast<'a>) -> Result<Outcome, QueryError> {
    let mut last = WarmStart::Nothing;
    move |cast| {
        if cast.options.solver != Solver::Cta {
            return cast.first_contact_observed(observer);
        }
        let mut next = TrackerUpdate::default();
        let outcome = cast.search_first_contact(&Focus::NONE, &last, &mut next, observer);
        last = next.start.opposite();
        outcome
    }
}

impl CastBody for ConvexPolyhedron {
    type CastProof<'p> = Proof<'p>;

    #[inline(always)]
    #[expect(clippy::inline_always, reason = "a copy through memory stalls its reader")]
    fn check_options(cast: &Cast<'_>) -> Result<(), QueryError> {
        cast.options.check_lengths()
    }

    #[inline]
    fn with_min_gap(options: Options, gap: f64) -> Options {
        options.with_min_gap(gap)
    }

    fn first_contact(cast: &Cast<'_>) -> Result<Outcome, QueryError> {
        cast.first_contact_observed(&mut NoObserver)
    }

    fn contact_range(cast: &Cast<'_>) -> Result<ContactRange, QueryError> {
        contact_range_by_casts(cast, first_and_last(&mut NoObserver))
    }

    fn clearance(cast: &Cast<'_>) -> Result<Clearance, QueryError> {
        clearance_by_casts(cast, first_and_last(&mut NoObserver))
    }

    fn intersects(cast: &Cast<'_>) -> Result<Intersection, QueryError> {
        intersection_by_casts(cast, Cast::first_contact)
    }

    fn verify_cast(cast: &Cast<'_>, proof: Proof<'_>) -> Result<f64, CertificateError> {
        match proof {
            Proof::Contact(certificate) => {
                certificate.verify_with_gap(&cast.setting, cast.options.min_gap)
            }
            Proof::Separation(separation) => {
                separation.verify_with_gap(&cast.setting, cast.options.min_gap)
            }
        }
    }
}

impl fmt::Display for Cast<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [p, q] = [self.moving(), self.fixed()].map(|body| body.vertices().len());
        write!(f, "{p} vertices cast at {q} along {:?}", self.direction().to_array())
    }
}

/// Finds how far `moving` can translate along `direction` before it touches `fixed`: [`Cast::new`] and
/// [`Cast::first_contact`] in one call.
///
/// # Errors
/// Returns an error if the direction is zero, not finite or out of range, or if the search ends without an
/// answer.
///
/// ```
/// # use colltrans::glam::DVec3;
/// # use colltrans::{ConvexPolyhedron, Outcome, Pose, cast};
/// let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE)?;
/// let start = Pose::from_translation(DVec3::new(-3.0, 0.5, 0.0))?;
/// let Outcome::Contact(contact) = cast(&cube, &start, &cube, &Pose::IDENTITY, DVec3::X)? else {
///     unreachable!("half of the cube is in the way")
/// };
/// assert_eq!(contact.translation, 2.0);
///
/// let beside = Pose::from_translation(DVec3::new(-3.0, 1.5, 0.0))?;
/// let outcome = cast(&cube, &beside, &cube, &Pose::IDENTITY, DVec3::X)?;
/// assert!(matches!(outcome, Outcome::Separated(_)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn cast(
    moving: &ConvexPolyhedron,
    moving_pose: &Pose,
    fixed: &ConvexPolyhedron,
    fixed_pose: &Pose,
    direction: DVec3,
) -> Result<Outcome, QueryError> {
    Cast::new(moving.at(*moving_pose), fixed.at(*fixed_pose), direction)?.first_contact()
}
