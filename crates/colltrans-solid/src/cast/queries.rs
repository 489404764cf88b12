//! The questions that only solids answer, as methods of [`Cast`](colltrans_convex::Cast).

use glam::DVec3;

use super::{SolidCertificate, SolidOverlap, StartOverlap, StartProof};
use crate::body::{AsSolid, Solid};
use crate::solve::contact::SolidContact;
use crate::solve::overlap::Overlap;
use crate::solve::scene::Scene;
use crate::solve::search::Workspace;
use crate::solve::steps::SolidSteps;
use colltrans_convex::answer::{Bounded, CertificateError, Clearance, Outcome};
use colltrans_convex::body::Placed;
use colltrans_convex::setting::error::QueryError;

/// Queries that only a [`Cast`](colltrans_convex::Cast) of two [`Solid`]s supports.
pub trait SolidCast<'a>: Sized {
    /// Between bodies of either kind, as solids: a solid against a convex polyhedron, say.
    ///
    /// # Errors
    /// A direction that is zero, not finite or out of range; a convex body whose facets [`Solid::from_mesh`] refuses.
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

    /// Returns the cast with both bodies shrunk by half of this length. Solids have no graze tolerance, since it would
    /// depend on how finely they are meshed:
    ///
    /// ```compile_fail
    /// # use colltrans::{Cast, Solid};
    /// fn graze(cast: Cast<Solid>) {
    ///     cast.with_graze_tolerance(0.5);
    /// }
    /// ```
    ///
    /// # Errors
    /// As [`Cast::with_options`](colltrans_convex::Cast::with_options).
    fn with_tolerance(self, tolerance: f64) -> Result<Self, QueryError>;

    /// Returns the cast with another meaning of an overlap at the start.
    #[must_use]
    fn with_start_overlap(self, start_overlap: StartOverlap) -> Self;

    /// The tolerance that is used, as a length.
    fn tolerance(&self) -> f64;

    /// Computes [`Cast::clearance`](colltrans_convex::Cast::clearance) and reuses the queue in `workspace`.
    ///
    /// # Errors
    /// As [`Cast::clearance`](colltrans_convex::Cast::clearance).
    fn clearance_in(&self, workspace: &mut Workspace) -> Result<Clearance<Solid>, QueryError>;

    /// How far the moving body can move from where it is, as [`Self::clearance_in`] says, and the proof of it. Allocates
    /// what the proof takes: a byte for each pair of nodes.
    ///
    /// Of convex bodies every answer carries its proof, which the search ends with anyway. Between solids
    /// it takes a pass over all that the search left out, and as much space: so it is asked for apart.
    ///
    /// # Errors
    /// As [`Cast::clearance`](colltrans_convex::Cast::clearance).
    fn certified_clearance(&self) -> Result<(Clearance<Solid>, SolidCertificate), QueryError>;

    /// Where the moving body would be stopped if these two triangles, by their positions in
    /// [`Solid::triangles`], were all that there is of the bodies; `None` if they do not stop it. What
    /// blocks along one direction often does so along others too: then the clearance is no larger. Bodies count as
    /// overlapping only where [`SolidOptions::overlapping`](super::SolidOptions::overlapping) says so.
    fn stop_by(&self, triangles: [u32; 2]) -> Option<SolidContact>;

    /// Where two triangles of these bodies, as they are, meet that stop them after
    /// [`Solid::shrunk`]: what [`SolidContact::translation`] is to
    /// [`SolidContact::shrunk_distance`]. `shrunk` is how far the shrunk bodies go, `normal` that of
    /// their contact, and `shift` how far the contact point of the moving body was moved by shrinking,
    /// less that of the fixed body. `None` if there are no such triangles.
    fn true_place(
        &self,
        triangles: [u32; 2],
        shrunk: Bounded,
        normal: DVec3,
        shift: DVec3,
    ) -> Option<Bounded>;

    /// Whether the interiors of the bodies, shrunk by half the tolerance, have a point in common, or open
    /// shells pass through what is there.
    fn overlaps(&self) -> bool;

    /// Where the bodies, shrunk by half the tolerance, overlap, and by how much; `None` if they do not:
    /// what [`Clearance::Overlapping`] tells, and what an answer with [`StartOverlap::Ignore`] has
    /// ignored. It costs several times as much as [`Self::overlaps`], for the least tolerance.
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

    /// The least tolerance with which the bodies do not overlap, from above: 0 if they do not, `None`
    /// if there is none that leaves something of both, as of one that lies deep inside the other. Nor is there one
    /// where they overlap and one of them has open
    /// shells: less of a solid does not free a sheet that passes through it. It is more than the least by
    /// `1e-12` of itself or 8 noises (`256 u S`) at most. How far convex bodies have to
    /// go back along a direction is another question:
    /// [`Cast::directional_depth`](colltrans_convex::Cast::directional_depth).
    fn least_tolerance(&self) -> Option<f64>;

    /// Computes [`Cast::first_contact`](colltrans_convex::Cast::first_contact) and reuses the queue in `workspace`.
    ///
    /// # Errors
    /// As [`Cast::first_contact`](colltrans_convex::Cast::first_contact).
    fn first_contact_in(&self, workspace: &mut Workspace) -> Result<Outcome<Solid>, QueryError>;

    /// The translation after which the bodies, as they are, never meet again, in multiples of the
    /// direction: the last contact of [`Cast::contact_range`](colltrans_convex::Cast::contact_range) alone, and 0 if it
    /// lies behind; `None` if they never meet. Beyond `upper` they are apart for certain.
    fn exit(&self) -> Option<Bounded>;

    /// Computes [`Self::exit`] and reuses the queue in `workspace`.
    fn exit_in(&self, workspace: &mut Workspace) -> Option<Bounded>;
}

/// The bodies of a query as its searches see them: for the crates that search beside this one.
#[doc(hidden)]
pub trait SolidScene<'a> {
    fn scene(&self, tolerance: f64) -> Scene<'a>;

    /// The bodies shrunk by half the tolerance.
    fn asked(&self) -> Scene<'a>;

    /// Returns the bodies shrunk by half the tolerance, or an error if nothing is left of one.
    fn asked_of_something(&self) -> Result<Scene<'a>, QueryError>;

    fn overlap_at(&self, place: Overlap, steps: SolidSteps) -> SolidOverlap;

    fn prove_start(&self, scene: &Scene, steps: &mut SolidSteps) -> StartProof;

    fn verify_start(&self, scene: &Scene, start: &StartProof) -> Result<(), CertificateError>;
}
