//! Queries that only solids answer, as methods of [`Cast`](colltrans_convex::Cast).

use glam::DVec3;

use super::{SolidCertificate, SolidOverlap, StartOverlap, StartProof};
use crate::body::{AsSolid, Solid};
use crate::solve::contact::SolidContact;
use crate::solve::overlap::Overlap;
use crate::solve::scene::PairFrame;
use crate::solve::search::Workspace;
use crate::solve::steps::SolidSteps;
use colltrans_convex::answer::{Bounded, CertificateError, Clearance, Outcome};
use colltrans_convex::body::Placed;
use colltrans_convex::setting::error::QueryError;

/// Queries that only a [`Cast`](colltrans_convex::Cast) of two [`Solid`]s supports.
pub trait SolidCast<'a>: Sized {
    /// Builds a cast of two bodies of either kind as solids, for example of a solid and a convex polyhedron.
    ///
    /// # Errors
    /// The direction is zero, not finite or out of range, or [`Solid::from_mesh`] rejects the facets of a convex
    /// body.
    ///
    /// ```
    /// use colltrans::glam::DVec3;
    /// use colltrans::solid::SolidCast;
    /// use colltrans::{Cast, ConvexPolyhedron, Pose, Solid};
    ///
    /// let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE)?;
    /// let post = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::new(1.0, 1.0, 4.0))?;
    /// let step = Solid::from_pieces([&cube, &post])?;
    /// let above = Pose::from_translation(DVec3::new(0.5, 0.5, 6.0))?;
    /// let down = Cast::between(cube.at(above), step.at(Pose::IDENTITY), DVec3::NEG_Z)?;
    /// let distance = down.clearance()?.distance().expect("the step is below");
    /// assert!(distance <= 2.0 && distance > 2.0 - 1e-11);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    fn between<A: AsSolid, B: AsSolid>(
        moving: Placed<'a, A>,
        fixed: Placed<'a, B>,
        direction: DVec3,
    ) -> Result<Self, QueryError>;

    /// Returns the cast with both bodies offset inwards by half of `tolerance` (world units). Solids have no graze
    /// tolerance, since it would depend on how finely they are meshed:
    ///
    /// ```compile_fail
    /// # use colltrans::{Cast, Solid};
    /// fn graze(cast: Cast<Solid>) {
    ///     cast.with_graze_tolerance(0.5);
    /// }
    /// ```
    ///
    /// # Errors
    /// Those of [`Cast::with_options`](colltrans_convex::Cast::with_options).
    fn with_tolerance(self, tolerance: f64) -> Result<Self, QueryError>;

    /// Returns the cast with another treatment of an overlap at the start.
    #[must_use]
    fn with_start_overlap(self, start_overlap: StartOverlap) -> Self;

    /// Returns the tolerance in effect, given or default, as a length in world units.
    fn tolerance(&self) -> f64;

    /// Computes [`Cast::clearance`](colltrans_convex::Cast::clearance) and reuses the queue in `workspace`.
    ///
    /// # Errors
    /// Those of [`Cast::clearance`](colltrans_convex::Cast::clearance).
    fn clearance_in(&self, workspace: &mut Workspace) -> Result<Clearance<Solid>, QueryError>;

    /// Computes the clearance, as [`Self::clearance_in`] does, and its certificate, which takes one byte for each
    /// pair of nodes.
    ///
    /// Answers for convex bodies always contain their certificate, because the search ends with it. For solids a
    /// certificate requires a search even if boxes or hulls decide the clearance. It also takes another pass over all
    /// that the search dismissed, and as much memory. Therefore it is computed on request only.
    ///
    /// # Errors
    /// Those of [`Cast::clearance`](colltrans_convex::Cast::clearance).
    fn certified_clearance(&self) -> Result<(Clearance<Solid>, SolidCertificate), QueryError>;

    /// Computes the contact that blocks the moving body if both bodies consist only of these triangles, given by
    /// their positions in [`Solid::triangles`]. `None` if they do not block, or if a position is out of range.
    ///
    /// Triangles that block along one direction often block along others too. There the clearance is at most that
    /// of their contact. Triangles that cross at the start are ignored only if
    /// [`SolidOptions::overlapping`](super::SolidOptions::overlapping) is `Some(true)` and overlaps are to be
    /// ignored.
    fn contact_of_triangles(&self, triangles: [u32; 2]) -> Option<SolidContact>;

    /// Computes the translation at which two triangles meet in nominal position if they block the bodies after
    /// [`Solid::shrunk`]. The result relates to `shrunk` as [`SolidContact::translation`] to
    /// [`SolidContact::offset_distance`]. `None` if a position is out of range.
    ///
    /// - `triangles`: positions in [`Solid::triangles`] of the moving and the fixed body.
    /// - `shrunk`: distance of the offset bodies, in multiples of the direction.
    /// - `normal`: normal of their contact, in the world.
    /// - `shift`: displacement of the contact point on the moving body by the offset, less that of the fixed body.
    fn nominal_translation(
        &self,
        triangles: [u32; 2],
        shrunk: Bounded,
        normal: DVec3,
        shift: DVec3,
    ) -> Option<Bounded>;

    /// Checks whether the interiors of the offset bodies have a common point, or an open shell passes through the
    /// other body. With a minimum gap, also checks whether two facets are certainly nearer than the gap.
    fn overlaps(&self) -> bool;

    /// Finds an overlap of the offset bodies and computes its least tolerance; `None` if they do not overlap. The
    /// result is that of [`Clearance::Overlapping`], or the overlap that [`StartOverlap::Ignore`] ignores. The
    /// least tolerance takes several times as long as [`Self::overlaps`].
    ///
    /// ```
    /// use colltrans::glam::DVec3;
    /// use colltrans::solid::{Overlap, SolidCast, StartOverlap};
    /// use colltrans::{Cast, ConvexPolyhedron, Pose};
    ///
    /// let table = ConvexPolyhedron::cuboid(DVec3::new(-4.0, -4.0, -1.0), DVec3::new(4.0, 4.0, 0.0))?;
    /// let plate = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::new(1.0, 2.0, 1.0))?;
    /// let sunk = Pose::from_translation(DVec3::Z * -0.125)?;
    /// let aside = Cast::between(plate.at(sunk), table.at(Pose::IDENTITY), DVec3::X)?
    ///     .with_start_overlap(StartOverlap::Ignore);
    /// assert!(aside.clearance()?.is_free());
    /// let ignored = aside.start_overlap().expect("the plate is pressed into the table");
    /// assert!(matches!(ignored.place, Overlap::Facets(_, _)));
    /// assert!((ignored.least_tolerance.expect("there is one") - 0.125).abs() < 1e-9);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    fn start_overlap(&self) -> Option<SolidOverlap>;

    /// Computes an upper bound of the least tolerance at which the bodies do not overlap, 0 if the nominal bodies
    /// do not overlap.
    ///
    /// `None` if no such tolerance leaves something of both bodies, for example if one lies deep inside the other.
    /// Also `None` if they overlap and one has an open shell, because a smaller solid does not free a sheet that
    /// passes through it.
    ///
    /// The bound exceeds the least tolerance by at most 4 noises and the larger of 4 noises and `1e-12` of itself.
    /// For convex bodies, [`Cast::directional_depth`](colltrans_convex::Cast::directional_depth) is the depth along
    /// a direction.
    fn least_tolerance(&self) -> Option<f64>;

    /// Computes [`Cast::first_contact`](colltrans_convex::Cast::first_contact) and reuses the queue in `workspace`.
    ///
    /// # Errors
    /// Those of [`Cast::first_contact`](colltrans_convex::Cast::first_contact).
    fn first_contact_in(&self, workspace: &mut Workspace) -> Result<Outcome<Solid>, QueryError>;

    /// Computes the translation after which the nominal bodies never meet again, in multiples of the direction.
    /// This is the last contact of [`Cast::contact_range`](colltrans_convex::Cast::contact_range), or 0 if that is
    /// behind. `None` if the bodies never meet. Beyond `upper` they are certainly apart.
    fn exit(&self) -> Option<Bounded>;

    /// Computes [`Self::exit`] and reuses the queue in `workspace`.
    fn exit_in(&self, workspace: &mut Workspace) -> Option<Bounded>;
}

/// Scenes (frames and offset bodies) and overlaps of a query, for crates with searches of their own.
#[doc(hidden)]
pub trait SolidScene<'a> {
    /// Builds the scene with both bodies offset inwards by half of `tolerance` (world units).
    fn scene_with_tolerance(&self, tolerance: f64) -> PairFrame<'a>;

    /// Builds the scene at the tolerance of the query.
    fn query_scene(&self) -> PairFrame<'a>;

    /// Builds the scene at the tolerance of the query. Returns an error if the default tolerance leaves nothing of
    /// a body.
    fn checked_query_scene(&self) -> Result<PairFrame<'a>, QueryError>;

    /// Computes the least tolerance of an overlap at a place; the result contains `steps` with this work added.
    fn start_overlap_at(&self, place: Overlap, steps: SolidSteps) -> SolidOverlap;

    /// Proves whether the bodies of a scene overlap, unless the options state it. Adds the work to `steps`.
    fn prove_start(&self, scene: &PairFrame, steps: &mut SolidSteps) -> StartProof;

    /// Verifies a proof of [`Self::prove_start`].
    fn verify_start(&self, scene: &PairFrame, start: &StartProof) -> Result<(), CertificateError>;
}
