//! Motions of solids: the time at which two of them first meet.
//!
//! Both solids are shrunk by half of a tolerance, as for casts, so that a part that fits into another one can rotate in
//! it. Of rounded solids the cores are shrunk. An overlap at the start, including containment, is decided exactly.
//! Afterwards the surfaces must meet before one solid can contain the other. The search finds the first contact of
//! facets in both bounding volume trees and in time.
//!
//! Each module uses only those before it: `tree` (a shrunk solid), `window` (one plane for two parts in an interval),
//! `facets` (two facets as convex bodies), `inside` (a point inside both solids). `search`, `hulls` (two convex
//! solids), `meeting` (proves contact at a time), `verify` and `clearance` use them.

mod clearance;
mod facets;
mod hulls;
pub(super) mod inside;
mod meeting;
mod search;
mod tree;
mod verify;
mod window;

use glam::DVec3;

use self::facets::FacetSampler;
use self::hulls::search_convex;
use self::meeting::contact_state_at;
use self::search::{EarliestContact, SearchMode, TreeSearch};
#[cfg(feature = "json")]
pub use self::tree::ProofFacets;
use self::tree::SolidTree;
use self::window::SpanFrame;
use super::answer::{MotionContact, MotionFree, MotionOutcome, MotionSteps};
use super::crossing_time::find_crossing_time;
use super::proof::{FacetContact, RecordedProof, SolidMotionProof, SpanProof};
use super::span::{Span, split_into_spans};
use super::verify::MotionProofError;
use super::{MotionCast, Moving, check_accuracy, default_tolerance};
use colltrans_convex::body::Features;
use colltrans_convex::cast::Cast;
use colltrans_convex::setting::error::QueryError;
use colltrans_convex::setting::{Setting, check_min_gap};
use colltrans_solid::body::{AsSolid, Solid};
use colltrans_solid::cast::{SolidOptions, StartProof};
use colltrans_solid::solve::nearest::{NearestPoints, triangle, weighted_points};
use colltrans_solid::solve::overlap;
use colltrans_solid::solve::scene::PairFrame;
use colltrans_solid::{SolidCast, SolidScene, SolidSteps};

/// Maximum number of attempts to prove the time up to a contact, each with a slightly earlier end.
const MAX_PROOF_ATTEMPTS: i32 = 40;

/// Queries of solids in motion. Their answers are those of convex bodies, for both solids shrunk by half of the
/// tolerance.
impl<'a> MotionCast<'a, Solid> {
    /// Builds the cast of two bodies as solids. Each of them is a solid or a convex polyhedron.
    ///
    /// A point or a segment is accepted. Its contact with a closed solid has an upper bound: a time at which one of its
    /// points is inside (`FacetContactProof::Contained`), or at which a segment passes through a facet. The contact of
    /// a point that passes through an open shell has no upper bound, and is [`MotionOutcome::Grazing`].
    ///
    /// # Errors
    /// Returns an error for a convex body whose facets [`Solid::from_mesh`] rejects.
    ///
    /// ```
    /// use colltrans::glam::DVec3;
    /// use colltrans::motion::{Motion, MotionCast, MotionOutcome};
    /// use colltrans::{ConvexPolyhedron, Pose, Solid};
    ///
    /// let bar = ConvexPolyhedron::cuboid(DVec3::new(0.0, -0.1, 0.0), DVec3::new(2.0, 0.1, 0.2))?;
    /// let post = ConvexPolyhedron::cuboid(DVec3::splat(-0.1), DVec3::splat(0.3))?;
    /// let far = ConvexPolyhedron::cuboid(DVec3::splat(5.0), DVec3::splat(6.0))?;
    /// let scene = Solid::from_pieces([&post, &far])?;
    /// let swing = Motion::rotation_about(Pose::IDENTITY, DVec3::ZERO, DVec3::Z, std::f64::consts::PI)?;
    /// let there = Motion::at_rest(Pose::from_translation(DVec3::Y * 1.5)?);
    /// let cast = MotionCast::between_any(bar.with_motion(&swing), scene.with_motion(&there))?;
    /// let MotionOutcome::Contact(contact) = cast.first_contact()? else { panic!("no contact") };
    /// assert!(contact.lower < 0.5 && contact.upper - contact.lower < 1e-11);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn between_any<A: AsSolid, B: AsSolid>(
        moving: Moving<'a, A>,
        fixed: Moving<'a, B>,
    ) -> Result<Self, QueryError> {
        let (p, q) = (moving.body.as_surface()?, fixed.body.as_surface()?);
        Self::new(
            Moving { body: p, motion: moving.motion },
            Moving { body: q, motion: fixed.motion },
        )
    }

    /// Returns the cast with a minimum gap, in world units. The queries then find when the distance of the shrunk
    /// solids falls to the gap.
    ///
    /// # Errors
    /// Returns [`QueryError::MinGap`] if the gap is negative, not finite or out of range.
    pub fn with_min_gap(self, gap: f64) -> Result<Self, QueryError> {
        check_min_gap(gap)?;
        Ok(Self { min_gap: gap, ..self })
    }

    /// Returns the cast with a tolerance: both solids are shrunk by half of this length. The default tolerance covers
    /// the rounding errors of a fit. With it, solids in contact may separate, slide and rotate, and are stopped where
    /// they would be pushed together.
    ///
    /// # Errors
    /// Returns an error if the length is negative or not finite, or if it leaves nothing of a closed solid.
    pub fn with_tolerance(self, tolerance: f64) -> Result<Self, QueryError> {
        let cast = Self { tolerance: Some(tolerance), ..self };
        cast.start_cast().map(|_| cast)
    }

    /// Returns the tolerance in use, as a length in world units.
    pub fn tolerance(&self) -> f64 {
        self.tolerance.unwrap_or_else(|| default_tolerance(self.bodies(), self.motions()))
    }

    /// Finds the first time at which the solids meet, without a proof. For a proof, see
    /// [`Self::certified_first_contact`].
    ///
    /// # Errors
    /// Returns an error if no tolerance was set, and the default leaves nothing of a thin solid or exceeds the size of
    /// the bodies ([`QueryError::PositionError`]).
    pub fn first_contact(&self) -> Result<MotionOutcome<()>, QueryError> {
        let (start, mut steps) = (self.start_cast()?, MotionSteps::default());
        let tolerance = start.tolerance();
        if overlap::find_overlap(&start.checked_query_scene()?, &mut SolidSteps::default())
            .is_some()
        {
            return Ok(MotionOutcome::Overlapping(self.overlap_contact((), steps)));
        }
        let trees = self.shrunk_trees(tolerance);
        for span in split_into_spans(trees.each_ref(), self.motions(), self.min_gap) {
            let (found, _) = search_span(&span, SearchMode::FirstContact, &mut steps);
            if let Some(found) = found {
                let found = Self::with_proven_contact(&span, found, &mut steps);
                return Ok(self.contact_outcome(&span, &found, steps, |_| ()));
            }
        }
        Ok(MotionOutcome::Free(MotionFree { proof: (), steps }))
    }

    /// Finds the first time at which the solids meet, with a proof that [`Self::verify`] checks without a search. A
    /// contact takes an additional search, from the start of its span to the contact.
    ///
    /// # Errors
    /// Returns the errors of [`Self::first_contact`].
    pub fn certified_first_contact(&self) -> Result<MotionOutcome<SolidMotionProof>, QueryError> {
        let cast = self.start_cast()?;
        let tolerance = cast.tolerance();
        let start = cast.prove_start(&cast.checked_query_scene()?, &mut SolidSteps::default());
        let mut proof = SolidMotionProof { tolerance, start, spans: Vec::new(), meeting: None };
        let mut steps = MotionSteps::default();
        if matches!(proof.start, StartProof::Overlapping(_)) {
            return Ok(MotionOutcome::Overlapping(self.overlap_contact(proof, steps)));
        }
        let trees = self.shrunk_trees(tolerance);
        for span in split_into_spans(trees.each_ref(), self.motions(), self.min_gap) {
            let (found, recorded) = search_span(&span, SearchMode::Recording, &mut steps);
            let Some(found) = found else {
                proof.spans.push(SpanProof::new(span.to, recorded));
                continue;
            };
            let mut found = Self::with_proven_contact(&span, found, &mut steps);
            let recorded = if recorded.is_list_until(found.lower) {
                recorded
            } else {
                let (lower, recorded) = prove_until(&span, found.lower, &mut steps);
                found.lower = lower;
                recorded
            };
            let lower = found.lower;
            proof.spans.push(SpanProof::new(lower, recorded));
            return Ok(self.contact_outcome(&span, &found, steps, |meeting| SolidMotionProof {
                meeting,
                ..proof
            }));
        }
        Ok(MotionOutcome::Free(MotionFree { proof, steps }))
    }

    /// Checks a proof without a search. Returns the time up to which the shrunk solids are proven not to meet, and the
    /// time at which they are proven to meet. The latter is infinite if the proof claims no contact.
    ///
    /// # Errors
    /// Returns the first entry of the proof that does not hold.
    pub fn verify(&self, proof: &SolidMotionProof) -> Result<[f64; 2], MotionProofError> {
        verify::verify(self, proof)
    }

    /// Returns a cast of the solids at their start poses, with an arbitrary direction.
    fn start_cast(&self) -> Result<Cast<'a, Solid>, QueryError> {
        let (bodies, tolerance) = (self.bodies(), self.tolerance());
        if self.tolerance.is_none() {
            check_accuracy(bodies, tolerance)?;
        }
        let [p, q] = self.motions().map(|motion| motion.pieces()[0].start_pose);
        let options = SolidOptions::default().with_tolerance(tolerance).with_min_gap(self.min_gap);
        Cast::new(bodies[0].at(p), bodies[1].at(q), DVec3::Z)?.with_options(options)
    }

    /// Returns the facets and the trees that the entries of a proof refer to.
    #[cfg(feature = "json")]
    #[doc(hidden)]
    pub fn proof_facets(&self) -> [ProofFacets; 2] {
        self.shrunk_trees(self.tolerance()).map(|tree| ProofFacets::from_tree(&tree))
    }

    /// Returns the tolerance that was set; `None` for the default.
    #[cfg(feature = "json")]
    #[doc(hidden)]
    pub const fn given_tolerance(&self) -> Option<f64> {
        self.tolerance
    }

    /// Builds the trees of both solids, shrunk by half of the tolerance.
    fn shrunk_trees(&self, tolerance: f64) -> [SolidTree<'a>; 2] {
        self.bodies().map(|solid| SolidTree::new(solid, 0.5 * tolerance))
    }

    /// Replaces the contact of a search result by an earlier proven contact, if there is one.
    fn with_proven_contact(
        span: &Span<SolidTree>,
        mut found: EarliestContact,
        steps: &mut MotionSteps,
    ) -> EarliestContact {
        if found.is_refined {
            return found;
        }
        let known_contact = found.met.map(|(time, ..)| time);
        let (frame, mut sampler) = (SpanFrame::new(span), FacetSampler::default());
        let state = |time| contact_state_at(&frame, time, &mut sampler);
        let earlier = find_crossing_time(found.lower, known_contact, span.to.next_up(), state);
        if let Some((time, (pair, how))) = earlier {
            found.met = Some((time, pair, how));
        }
        *steps += sampler.steps;
        found
    }

    /// Returns the frame of the nominal solids at a time. Returns `None` if it is out of range.
    fn nominal_frame(&self, span: &Span<SolidTree>, time: f64) -> Option<PairFrame<'a>> {
        let bodies = span.instant_at(time).bodies.with_bodies(self.bodies());
        let setting = Setting::from_bodies(bodies, DVec3::Z).ok()?;
        Some(PairFrame::new(&setting, [0.0; 2], self.min_gap))
    }

    /// Builds the outcome for solids that meet, or may meet.
    fn contact_outcome<P>(
        &self,
        span: &Span<SolidTree>,
        found: &EarliestContact,
        steps: MotionSteps,
        proof: impl FnOnce(Option<FacetContact>) -> P,
    ) -> MotionOutcome<P> {
        let meeting = found.met.map(|(time, triangles, met)| FacetContact { time, triangles, met });
        let (lower, upper) = (found.lower, meeting.map_or(f64::INFINITY, |meeting| meeting.time));
        let bodies = span.instant_at(lower).bodies;
        let [p, q] = [bodies.moving_matrix, bodies.fixed_matrix];
        let poses = [0, 1].map(|k| {
            colltrans_convex::Pose::from_checked_entries([p, q][k], bodies.translations[k])
        });
        // The bounds do not depend on the rest. The facets are those of the shrunk solids, and so is the normal.
        let [f, g] = [0, 1].map(|k| span.body(k).facet(found.triangles[k]));
        let at = span.part_span([&f, &g], [span.from, span.to]).instant_at(lower);
        let [f, g] = facets::placed_corners(&at.bodies);
        let nearest = triangle::nearest_points(&f, &g, at.bodies.noise().point_error());
        let (spot, scene) = (
            NearestPoints { triangles: found.triangles, nearest },
            self.nominal_frame(span, lower),
        );
        let is_apart = nearest.gap > 0.0;
        let points = scene.as_ref().map(|scene| {
            let cores = weighted_points(scene, spot.triangles, nearest.weights);
            let points =
                if is_apart { bodies.surface_points_along(cores, nearest.normal) } else { cores };
            points.map(|point| point + bodies.translations[0])
        });
        let normal = is_apart.then_some(nearest.normal);
        let features = scene.filter(|_| is_apart).map(|scene| {
            let [moving, fixed] = spot.features(&scene);
            Features { moving, fixed }
        });
        let proof = proof(meeting);
        let contact = MotionContact { lower, upper, poses, points, normal, features, proof, steps };
        if upper.is_finite() {
            MotionOutcome::Contact(contact)
        } else if found.is_open {
            MotionOutcome::Undecided(contact)
        } else {
            MotionOutcome::Grazing(contact)
        }
    }

    /// Builds the report of solids that overlap at the start.
    fn overlap_contact<P>(&self, proof: P, steps: MotionSteps) -> MotionContact<P> {
        let poses = self.motions().map(|motion| motion.pieces()[0].start_pose);
        let (points, normal, features) = (None, None, None);
        MotionContact { lower: 0.0, upper: 0.0, poses, points, normal, features, proof, steps }
    }
}

/// Searches a span: two convex solids by their hulls, others by their trees. Returns the earliest contact, if any, and
/// the entries of its proof in [`SearchMode::Recording`].
fn search_span<'a>(
    span: &Span<'a, SolidTree<'a>>,
    mode: SearchMode,
    steps: &mut MotionSteps,
) -> (Option<EarliestContact>, RecordedProof) {
    if let Some(result) = search_convex(span, mode, steps) {
        return result;
    }
    let mut search = TreeSearch::new(SpanFrame::new(span), mode);
    search.process_entries();
    *steps += search.steps;
    (search.found, search.recorded.unwrap_or_default())
}

/// Proves that nothing meets in a span up to a time. Returns the proof with the time that it reaches, which may be
/// slightly earlier.
fn prove_until(
    span: &Span<SolidTree>,
    mut until: f64,
    steps: &mut MotionSteps,
) -> (f64, RecordedProof) {
    for k in 0..MAX_PROOF_ATTEMPTS {
        if until <= span.from {
            break;
        }
        let (found, recorded) = search_span(&span.ending_at(until), SearchMode::Recording, steps);
        let Some(found) = found else { return (until, recorded) };
        let less = if found.lower < until { 0.0 } else { f64::EPSILON * 2.0_f64.powi(k) };
        until = (found.lower - less).max(span.from);
    }
    (span.from, RecordedProof::default())
}
