//! How far a solid can move along its motion, and the meaning of an overlap at the start.
//!
//! With [`StartOverlap::Ignore`], an overlap at the start changes which contacts count:
//! - Two facets that cross at the start count only from the first sampled time on at which they are separated.
//! - Any two facets count only for contacts at which they face each other. A part inside another one can thus leave it.

use super::super::answer::{MotionFree, MotionOutcome, MotionSteps};
use super::super::clearance::{
    MotionClearance, MotionOverlap, nominal_contact_time, sample_in_spans,
};
use super::super::span::{Span, split_into_spans};
use super::super::{MotionCast, step_limit_error};
use super::facets::{self, FacetSampler};
use super::search::EarliestContact;
use super::tree::{Facet, SolidTree};
use super::{SearchMode, search_span};
use colltrans_convex::answer::Bounded;
use colltrans_convex::setting::error::QueryError;
use colltrans_solid::SolidSteps;
use colltrans_solid::body::Solid;
use colltrans_solid::solve::nearest::triangle;
use colltrans_solid::solve::overlap;
use colltrans_solid::{SolidCast, SolidOverlap, SolidScene, StartOverlap};

impl MotionCast<'_, Solid> {
    /// Returns the cast with another meaning of an overlap at the start, for [`Self::clearance`].
    #[must_use]
    pub fn with_start_overlap(self, start_overlap: StartOverlap) -> Self {
        Self { start_overlap, ..self }
    }

    /// Computes how far the body can move along its motion, with the meaning of
    /// [`Cast::clearance`](colltrans_convex::Cast::clearance). A translation has the same answer as there.
    ///
    /// The proof of its `shrunk` bounds is that of [`Self::certified_first_contact`]. Solids that overlap at the start
    /// have no such proof with [`StartOverlap::Ignore`]. Two facets that are separated at the start are then proven not
    /// to meet before the answer, except in contacts at which they do not face each other. Such contacts, and facets
    /// that cross at the start, are ignored by convention. The time at which ignored facets are separated again is
    /// found by samples, and up to a thousandth of the searched interval after an ignored contact is skipped.
    ///
    /// # Errors
    /// Returns the errors of [`Self::first_contact`], and [`QueryError::NotConverged`] if the search took its maximum
    /// number of steps.
    ///
    /// ```
    /// use colltrans::glam::DVec3;
    /// use colltrans::motion::{Motion, MotionCast, MotionClearance};
    /// use colltrans::solid::StartOverlap;
    /// use colltrans::{ConvexPolyhedron, Pose};
    ///
    /// // A plate that is pressed 1/8 into a table is rotated out of it about an axis parallel to its edge.
    /// let table = ConvexPolyhedron::cuboid(DVec3::new(-4.0, -4.0, -1.0), DVec3::new(4.0, 4.0, 0.0))?;
    /// let plate = ConvexPolyhedron::cuboid(DVec3::new(0.0, 0.0, -0.125), DVec3::new(1.0, 2.0, 1.0))?;
    /// let out = Motion::rotation_about(Pose::IDENTITY, DVec3::new(-1.0, 0.0, 0.0), DVec3::NEG_Y, 1.0)?;
    /// let rest = Motion::at_rest(Pose::IDENTITY);
    /// let cast = MotionCast::between_any(plate.with_motion(&out), table.with_motion(&rest))?;
    /// let MotionClearance::Overlapping(found) = cast.clearance()? else { panic!() };
    /// assert!((found.least_tolerance.expect("there is one") - 0.125).abs() < 1e-9);
    /// assert!(cast.with_start_overlap(StartOverlap::Ignore).clearance()?.is_free());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn clearance(&self) -> Result<MotionClearance<()>, QueryError> {
        let start = self.start_cast()?;
        let scene = start.checked_query_scene()?;
        let place = overlap::find_overlap(&scene, &mut SolidSteps::default());
        if let Some(place) = place
            && self.start_overlap == StartOverlap::Refuse
        {
            let found = start.start_overlap_at(place, SolidSteps::default());
            return Ok(MotionClearance::Overlapping(convert_overlap(&found)));
        }
        let mode = if place.is_some() {
            SearchMode::IgnoringStartOverlaps
        } else {
            SearchMode::FirstContact
        };
        let (tolerance, mut steps) = (self.tolerance(), MotionSteps::default());
        let trees = self.shrunk_trees(tolerance);
        for span in split_into_spans(trees.each_ref(), self.motions(), self.min_gap) {
            let (found, _) = search_span(&span, mode, &mut steps);
            let Some(mut found) = found else { continue };
            if mode == SearchMode::FirstContact {
                found = Self::with_proven_contact(&span, found, &mut steps);
            }
            let time = self.blocking_time(&span, &found);
            return match self.contact_outcome(&span, &found, steps, |_| ()) {
                MotionOutcome::Contact(shrunk) | MotionOutcome::Grazing(shrunk) => {
                    Ok(MotionClearance::blocked(time, tolerance, shrunk))
                }
                MotionOutcome::Undecided(undecided) => Err(step_limit_error(&undecided)),
                MotionOutcome::Free(_) | MotionOutcome::Overlapping(_) => continue,
            };
        }
        Ok(MotionClearance::Free(MotionFree { proof: (), steps }))
    }

    /// Returns the overlap at the start and the least tolerance that removes it. [`MotionClearance::Overlapping`]
    /// reports it, and [`StartOverlap::Ignore`] ignores it. Returns `None` if the solids do not overlap at the start.
    ///
    /// # Errors
    /// Returns the errors of [`Self::first_contact`].
    pub fn start_overlap(&self) -> Result<Option<MotionOverlap>, QueryError> {
        Ok(self.start_cast()?.start_overlap().as_ref().map(convert_overlap))
    }

    /// Computes when the two blocking facets meet in their nominal position.
    fn blocking_time(&self, span: &Span<SolidTree>, found: &EarliestContact) -> Bounded {
        let upper = found.met.map_or(f64::INFINITY, |(time, ..)| time);
        let facets = [0, 1].map(|k| span.body(k).facet(found.triangles[k]));
        let part = span.part_span(facets.each_ref(), [span.from, span.to]);
        let instant = part.instant_at(found.lower);
        let [f, g] = facets::placed_corners(&instant.bodies);
        let near = triangle::nearest_points(&f, &g, instant.bodies.noise().point_error());
        // Change of the distance of the two points of contact due to the offset.
        let nominal = [0, 1].map(|k| {
            let solid = self.bodies()[k];
            let triangle = solid.triangles()[found.triangles[k] as usize];
            Facet::new(triangle.map(|v| solid.vertices()[v as usize]), solid.radius())
        });
        let moved = |k: usize| {
            let [a, b] = [&nominal[k], &facets[k]];
            triangle::weighted_point(&a.corners, near.weights[k])
                - triangle::weighted_point(&b.corners, near.weights[k])
        };
        let [p, q] =
            [instant.bodies.moving_matrix * moved(0), instant.bodies.fixed_matrix * moved(1)];
        let added_gap = near.normal.dot(p - q).max(0.0);
        let mut sampler = FacetSampler::default();
        let all = split_into_spans(facets.each_ref(), self.motions(), self.min_gap);
        let rate =
            sample_in_spans(&all, found.lower, &mut sampler).map_or(0.0, |sample| sample.rate);
        let nominal = split_into_spans(nominal.each_ref(), self.motions(), self.min_gap);
        nominal_contact_time(&nominal, &mut sampler, [added_gap, rate], [found.lower, upper])
    }
}

/// Converts an overlap of solids.
fn convert_overlap(SolidOverlap { place, least_tolerance, .. }: &SolidOverlap) -> MotionOverlap {
    MotionOverlap { least_tolerance: *least_tolerance, place: Some(*place) }
}
