//! A query as a value: two placed bodies and a direction, checked once.
//!
//! The way: [`Cast`] holds the setting and the choices, `derive` makes the answers
//! that take more than one cast, `contact` computes what is not needed for an answer but asked of
//! it; `replay` saves a query as a file (feature `json`).

mod contact;
mod multi_cast;
#[cfg(feature = "json")]
pub mod replay;
pub mod sideways;

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
use crate::solve::{Left, WarmStart, keep, search};
pub use contact::WitnessPoints;
pub use multi_cast::{clearance_of, common_end, depth_of, intersection_by_casts, range_of};
#[cfg(feature = "json")]
pub use replay::{Case, CaseError};
pub use sideways::verified_overlap;

/// A kind of body that a [`Cast`] is answered for: this crate implements it for convex
/// polyhedra, `colltrans-solid` for solids. It is not meant to be implemented elsewhere.
pub trait CastBody: Body {
    /// What a cast can be checked against.
    type CastProof<'p>;

    /// Refuses choices that a cast does not accept.
    #[doc(hidden)]
    fn check_options(cast: &Cast<'_, Self>) -> Result<(), QueryError>;
    /// The choices with a gap that is to be kept.
    #[doc(hidden)]
    fn keeping(options: Self::Options, gap: f64) -> Self::Options;
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

/// A moving body, a fixed one, and the direction in which the first is translated: what all queries
/// are asked of.
///
/// The poses place both bodies in the world; the direction is a vector of the world of any length,
/// and translations count in multiples of it. Made once, asked as often as one likes: nothing is
/// searched before a question is asked. See [`Tracker`](crate::Tracker) for questions that follow
/// each other closely.
///
/// ```
/// use colltrans::glam::DVec3;
/// use colltrans::{Cast, Clearance, ConvexPolyhedron, Outcome, Pose, WhyFree};
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
/// assert!(matches!(cast.reversed().clearance()?, Clearance::Free(WhyFree::Behind(_))));
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
    /// With the default choices.
    ///
    /// # Errors
    /// A direction that is zero, not finite or out of range.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "passed through memory it stalls its reader")]
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

    /// The same bodies where they are, and the direction turned round: its first contact is the last
    /// one along this direction.
    #[inline]
    #[must_use]
    pub fn reversed(&self) -> Self {
        Self { setting: self.setting.reversed(), ..*self }
    }

    /// The same bodies where they are, along another direction.
    ///
    /// # Errors
    /// A direction that is zero, not finite or out of range.
    pub fn along(&self, direction: DVec3) -> Result<Self, QueryError> {
        Ok(Self { setting: Setting::of(self.setting.bodies, direction)?, ..*self })
    }

    /// The moving body.
    pub fn moving(&self) -> &'a B {
        self.setting.moving
    }

    /// The fixed body.
    pub fn fixed(&self) -> &'a B {
        self.setting.fixed
    }

    /// Where the moving body is.
    pub fn moving_pose(&self) -> Pose {
        self.setting.moving_placed().pose
    }

    /// Where the fixed body is.
    pub fn fixed_pose(&self) -> Pose {
        self.setting.fixed_placed().pose
    }

    /// The direction, as given.
    pub fn direction(&self) -> DVec3 {
        self.setting.direction
    }

    /// The choices.
    pub fn options(&self) -> B::Options {
        self.options
    }
}

impl<B: CastBody> Cast<'_, B> {
    /// With other choices.
    ///
    /// # Errors
    /// A graze tolerance or a gap that is negative or not finite, a narrowing gap that is negative or not a number. Of
    /// solids a tolerance that is negative, not finite or so large that it leaves nothing of a closed body
    /// ([`QueryError::NothingLeft`]).
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "passed through memory it stalls its reader")]
    pub fn with_options(self, options: B::Options) -> Result<Self, QueryError> {
        let cast = Self { options, ..self };
        B::check_options(&cast)?;
        Ok(cast)
    }

    /// With a gap to be kept, in world units: all questions are about how far the bodies are then *as near as the
    /// gap*, not about when they touch (a shape cast with a target distance, or a skin).
    ///
    /// [`Self::first_contact`] is the first translation at which the distance of the bodies is the gap,
    /// [`Self::clearance`] how far one may move before it is, [`Self::intersects`] whether it is no more than the gap now,
    /// and bodies that are nearer at the start are [`Clearance::Overlapping`]. Answers are certified as ever: a
    /// contact's plane stays the gap away from the fixed body up to `lower`, its points are as near as the gap at `upper`;
    /// of [`Separated`](crate::Separated) bodies the margin is more than the gap; bodies whose shadows come as
    /// near as the gap to within the graze tolerance are [`Outcome::Grazing`]. Witness points are those that are
    /// the gap apart. Where bodies glide over each other at about the gap, bounds are as far apart as a face that is all
    /// but along the direction needs to come nearer by more than rounding. A gap of 0 is none. The
    /// solver makes no difference; observers hear of the planes that are laid, one for each look at how near the bodies are,
    /// and of no portals.
    ///
    /// Of solids, shrunk by half the tolerance where that counts, no two facets come nearer than the gap up to `lower`, but
    /// for those that pass each other, or start, at the gap to within eight noises of the size with the gap (`256 u S`),
    /// which do not block. A gap of no more than eight noises is none.
    ///
    /// # Errors
    /// A gap that is negative, not finite or more than [`MAX_MAGNITUDE`](crate::MAX_MAGNITUDE).
    ///
    /// ```
    /// # use colltrans::glam::DVec3;
    /// # use colltrans::{Cast, Clearance, ConvexPolyhedron, Outcome, Pose, WhyFree};
    /// let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE)?;
    /// let start = Pose::from_translation(DVec3::new(-3.0, 0.5, 0.0))?;
    /// let cast = Cast::new(cube.at(start), cube.at(Pose::IDENTITY), DVec3::X)?.keeping(0.25)?;
    /// let Outcome::Contact(contact) = cast.first_contact()? else {
    ///     unreachable!("half of the cube is in the way")
    /// };
    /// assert!((contact.translation - 1.75).abs() < 1e-15);
    /// let proof = contact.certificate;
    /// assert!(proof.lower <= 1.75 && 1.75 <= proof.upper && cast.verify(&proof)? < 1e-13);
    /// // Half a unit aside is near enough for a gap of 0.6, not for one of 0.4.
    /// let aside = Pose::from_translation(DVec3::new(-3.0, 1.5, 0.0))?;
    /// let aside = Cast::new(cube.at(aside), cube.at(Pose::IDENTITY), DVec3::X)?;
    /// let near = aside.keeping(0.6)?.clearance()?.distance().expect("they are apart");
    /// assert!((near - (2.0 - 0.11_f64.sqrt())).abs() < 1e-13);
    /// assert!(matches!(aside.keeping(0.4)?.clearance()?, Clearance::Free(WhyFree::Separated(_))));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[inline]
    pub fn keeping(self, gap: f64) -> Result<Self, QueryError> {
        self.with_options(B::keeping(self.options, gap))
    }

    /// At which translation do the bodies first meet, if they do?
    ///
    /// See [`Contact::translation`](crate::Contact::translation) for negative answers, and
    /// [`Self::clearance`] for "from here on". Of convex bodies it takes `O(log n)` steps in practice and allocates
    /// nothing, but for what [`Solver::Cta`] makes of a body once. Of solids the tolerance plays no part.
    ///
    /// # Errors
    /// Only a search of convex bodies that ends without an answer: see [`QueryError::NotConverged`].
    #[inline]
    pub fn first_contact(&self) -> Result<Outcome<B>, QueryError> {
        B::first_contact(self)
    }

    /// All translations at which the bodies meet, both ends certified. Two casts, along the
    /// direction and against it. Solids may part and meet again in between; their tolerance plays no part.
    ///
    /// # Errors
    /// As [`Self::first_contact`].
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

    /// How far the moving body can move from where it is.
    ///
    /// Contacts behind and grazing slides do not block. Bodies that touch now, to within rounding,
    /// block each other if the motion would make them overlap, and do not if it takes them apart. The answer for solids
    /// does not tell sliding along the other body from moving away from it or never meeting it; where a plane lies between
    /// the two, it comes with it.
    ///
    /// # Errors
    /// As [`Self::first_contact`]; a solid so thin that the default tolerance leaves nothing of it,
    /// [`QueryError::NothingLeft`].
    ///
    /// ```
    /// # use colltrans::glam::DVec3;
    /// # use colltrans::{Cast, Clearance, ConvexPolyhedron, Pose, WhyFree};
    /// let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE)?;
    /// // One cube upon another: it can go up, and aside, but not down.
    /// let (above, world) = (Pose::from_translation(DVec3::Z)?, Pose::IDENTITY);
    /// let toward = |direction| Cast::new(cube.at(above), cube.at(world), direction)?.clearance();
    /// assert!(matches!(toward(DVec3::Z)?, Clearance::Free(WhyFree::Behind(_))));
    /// assert!(matches!(toward(DVec3::X)?, Clearance::Free(WhyFree::Slides(_))));
    /// assert_eq!(toward(DVec3::NEG_Z)?.distance(), Some(0.0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[inline]
    pub fn clearance(&self) -> Result<Clearance<B>, QueryError> {
        B::clearance(self)
    }

    /// Whether the bodies, as closed sets, have a point in common where they are: of convex ones to within rounding error,
    /// of solids exactly. The direction plays no part, nor does a tolerance.
    ///
    /// A convex body is cast along the line through both centres, which passes the deepest
    /// part of the Minkowski difference, so the answer is as well conditioned as the question.
    ///
    /// # Errors
    /// As [`Self::first_contact`].
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

    /// Checks a [`Certificate`](crate::Certificate) or a [`Separation`](crate::Separation), or of solids a
    /// `SolidCertificate`, against the two bodies, and returns the gap, in multiples of
    /// the direction, or the margin, in world units, that is really proven.
    ///
    /// Nothing of the search is used: all vertices are looked at for the lower bound or the margin,
    /// three pairs of them for the upper bound, so a check takes `O(n)` steps. The cast must be the one
    /// that was answered; for the `last` contact of a [`ContactRange`] it is the
    /// [reversed](Self::reversed) one. A lower bound or a margin is refused if it is above what the
    /// plane proves, by however little; an upper bound if it is not above what the pairs prove by what
    /// the rounding of their weights explains. An infinite one claims nothing. Of a solid's cover every entry is checked
    /// by the boxes, slabs and normals of its two nodes, or by its facets.
    ///
    /// # Errors
    /// What is not proven, bounds in the wrong order, and a tolerance that is negative or more than
    /// rounding explains.
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
    /// With a graze tolerance, in world units: sideways overlaps up to it are
    /// [`Outcome::Grazing`].
    ///
    /// # Errors
    /// A tolerance that is negative or not finite.
    ///
    /// ```
    /// # use colltrans::glam::DVec3;
    /// # use colltrans::{Cast, ConvexPolyhedron, Outcome, Pose};
    /// let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE)?;
    /// // A slide with a thousandth of overlap: contact, or grazing for those who tolerate as much.
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

    /// With a solver. The answer, its certificate and its accuracy are the same.
    #[must_use]
    pub fn with_solver(self, solver: Solver) -> Self {
        Self { options: self.options.with_solver(solver), ..self }
    }

    /// Computes [`Self::first_contact`] with an observer: a [`Clock`](crate::observe::Clock), a
    /// [`Recording`](crate::observe::Recording).
    ///
    /// # Errors
    /// As [`Self::first_contact`].
    #[inline]
    pub fn first_contact_observed<O: Observer>(
        &self,
        observer: &mut O,
    ) -> Result<Outcome, QueryError> {
        let (last, mut next) = (WarmStart::Nothing, Left::default());
        self.search(&Focus::NONE, &last, &mut next, observer)
    }

    /// Searches where the bodies first meet or, if the options ask for a gap, where they are first as near as that.
    #[inline]
    pub(crate) fn search<O: Observer>(
        &self,
        focus: &Focus,
        last: &WarmStart,
        next: &mut Left,
        observer: &mut O,
    ) -> Result<Outcome, QueryError> {
        let Self { setting, options } = self;
        if cfg!(feature = "keep") && options.keep != 0.0 {
            return keep::convex::search(setting, options, focus, last, next, observer);
        }
        search(setting, options, focus, last, next, observer)
    }

    /// Computes [`Self::contact_range`] with an observer, as for [`Self::first_contact_observed`].
    ///
    /// # Errors
    /// As [`Self::first_contact`].
    pub fn contact_range_observed<O: Observer>(
        &self,
        observer: &mut O,
    ) -> Result<ContactRange, QueryError> {
        range_of(self, |cast| cast.first_contact_observed(observer))
    }

    /// Computes [`Self::clearance`] with an observer, as for [`Self::first_contact_observed`].
    ///
    /// # Errors
    /// As [`Self::first_contact`].
    pub fn clearance_observed<O: Observer>(
        &self,
        observer: &mut O,
    ) -> Result<Clearance, QueryError> {
        clearance_of(self, |cast| cast.first_contact_observed(observer))
    }

    /// How far the moving body, where it overlaps the fixed one, has to go back against the
    /// direction until they do not.
    ///
    /// # Errors
    /// As [`Self::first_contact`].
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
        depth_of(self, Self::first_contact)
    }
}

impl CastBody for ConvexPolyhedron {
    type CastProof<'p> = Proof<'p>;

    #[inline(always)]
    #[expect(clippy::inline_always, reason = "passed through memory it stalls its reader")]
    fn check_options(cast: &Cast<'_>) -> Result<(), QueryError> {
        cast.options.check()
    }

    #[inline]
    fn keeping(options: Options, gap: f64) -> Options {
        options.with_keep(gap)
    }

    fn first_contact(cast: &Cast<'_>) -> Result<Outcome, QueryError> {
        cast.first_contact_observed(&mut NoObserver)
    }

    fn contact_range(cast: &Cast<'_>) -> Result<ContactRange, QueryError> {
        range_of(cast, Cast::first_contact)
    }

    fn clearance(cast: &Cast<'_>) -> Result<Clearance, QueryError> {
        clearance_of(cast, Cast::first_contact)
    }

    fn intersects(cast: &Cast<'_>) -> Result<Intersection, QueryError> {
        intersection_by_casts(cast, Cast::first_contact)
    }

    fn verify_cast(cast: &Cast<'_>, proof: Proof<'_>) -> Result<f64, CertificateError> {
        match proof {
            Proof::Contact(certificate) => certificate.verify(&cast.setting, cast.options.keep),
            Proof::Separation(separation) => separation.verify(&cast.setting, cast.options.keep),
        }
    }
}

impl fmt::Display for Cast<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [p, q] = [self.moving(), self.fixed()].map(|body| body.vertices().len());
        write!(f, "{p} vertices cast at {q} along {:?}", self.direction().to_array())
    }
}

/// How far `moving` can translate along `direction` before it touches `fixed`: short for
/// [`Cast::new`] and [`Cast::first_contact`].
///
/// # Errors
/// A direction that is zero, not finite or out of range.
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
