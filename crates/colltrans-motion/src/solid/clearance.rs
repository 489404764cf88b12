//! How far along its motion a solid can go, and what an overlap when it begins may mean.
//!
//! With [`StartOverlap::Ignore`] two facets that cross count from the first time on at which they are seen apart; then
//! as all others, but only for contacts at which they look at each other: what is inside may come out.

use super::super::answer::{MotionFree, MotionOutcome, MotionSteps};
use super::super::clearance::{MotionClearance, MotionOverlap, at, true_time};
use super::super::span::{Span, spans};
use super::super::{MotionCast, stalled};
use super::facets::{self, FacetLooker};
use super::search::Found;
use super::tree::{Facet, Tree};
use super::{Mode, searched};
use colltrans_convex::answer::Bounded;
use colltrans_convex::setting::error::QueryError;
use colltrans_solid::SolidSteps;
use colltrans_solid::body::Solid;
use colltrans_solid::solve::nearest::triangle;
use colltrans_solid::solve::overlap;
use colltrans_solid::{SolidCast, SolidOverlap, SolidScene, StartOverlap};

impl MotionCast<'_, Solid> {
    /// The same with another meaning of an overlap when the motion begins, for [`Self::clearance`].
    #[must_use]
    pub fn with_start_overlap(self, start_overlap: StartOverlap) -> Self {
        Self { start_overlap, ..self }
    }

    /// How far along its motion the body can go, in the meaning of [`Cast::clearance`](colltrans_convex::Cast::clearance): a slide
    /// has the same answer.
    ///
    /// The proof of its `shrunk` bounds is that of [`Self::certified_first_contact`]. With [`StartOverlap::Ignore`],
    /// where bodies overlap when the motion begins, there is none: proven is that no two facets meet before which were
    /// apart then; that those which crossed do not count is an agreement, and when they are apart is found by looks.
    ///
    /// # Errors
    /// As [`Self::first_contact`].
    ///
    /// ```
    /// use colltrans::glam::DVec3;
    /// use colltrans::motion::{Motion, MotionCast, MotionClearance};
    /// use colltrans::solid::StartOverlap;
    /// use colltrans::{ConvexPolyhedron, Pose};
    ///
    /// // A plate that is pressed 1/8 into a table is turned out of it about its edge.
    /// let table = ConvexPolyhedron::cuboid(DVec3::new(-4.0, -4.0, -1.0), DVec3::new(4.0, 4.0, 0.0))?;
    /// let plate = ConvexPolyhedron::cuboid(DVec3::new(0.0, 0.0, -0.125), DVec3::new(1.0, 2.0, 1.0))?;
    /// let out = Motion::turn(Pose::IDENTITY, DVec3::new(-1.0, 0.0, 0.0), DVec3::NEG_Y, 1.0)?;
    /// let rest = Motion::still(Pose::IDENTITY);
    /// let cast = MotionCast::between(plate.along(&out), table.along(&rest))?;
    /// let MotionClearance::Overlapping(found) = cast.clearance()? else { panic!() };
    /// assert!((found.least_tolerance.expect("there is one") - 0.125).abs() < 1e-9);
    /// assert!(cast.with_start_overlap(StartOverlap::Ignore).clearance()?.is_free());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn clearance(&self) -> Result<MotionClearance<()>, QueryError> {
        let start = self.start()?;
        let scene = start.asked_of_something()?;
        let place = overlap::find(&scene, &mut SolidSteps::default());
        if let Some(place) = place
            && self.start_overlap == StartOverlap::Refuse
        {
            let found = start.overlap_at(place, SolidSteps::default());
            return Ok(MotionClearance::Overlapping(of_solids(&found)));
        }
        let mode = if place.is_some() { Mode::Ignoring } else { Mode::Plain };
        let (tolerance, mut steps) = (self.tolerance(), MotionSteps::default());
        let trees = self.trees(tolerance);
        for span in spans(trees.each_ref(), self.motions(), self.keep) {
            let (found, _) = searched(&span, mode, &mut steps);
            let Some(mut found) = found else { continue };
            if mode == Mode::Plain {
                found = Self::confirmed(&span, found, &mut steps);
            }
            let time = self.true_time(&span, &found);
            return match self.contact(&span, &found, steps, |_| ()) {
                MotionOutcome::Contact(shrunk) | MotionOutcome::Grazing(shrunk) => {
                    Ok(MotionClearance::blocked(time, tolerance, shrunk))
                }
                MotionOutcome::Undecided(undecided) => Err(stalled(&undecided)),
                MotionOutcome::Free(_) | MotionOutcome::Overlapping(_) => continue,
            };
        }
        Ok(MotionClearance::Free(MotionFree { proof: (), steps }))
    }

    /// What overlaps when the motion begins, with the least tolerance: what [`MotionClearance::Overlapping`] tells, and
    /// what an answer with [`StartOverlap::Ignore`] has ignored.
    ///
    /// # Errors
    /// As [`Self::first_contact`].
    pub fn start_overlap(&self) -> Result<Option<MotionOverlap>, QueryError> {
        Ok(self.start()?.start_overlap().as_ref().map(of_solids))
    }

    /// When the two facets that stop the body meet as they are.
    fn true_time(&self, span: &Span<Tree>, found: &Found) -> Bounded {
        let upper = found.met.map_or(f64::INFINITY, |(time, ..)| time);
        let facets = [0, 1].map(|k| span.body(k).facet(found.triangles[k]));
        let part = span.part(facets.each_ref(), [span.from, span.to]);
        let instant = part.instant(found.lower);
        let [f, g] = facets::corners(&instant);
        let near = triangle::nearest(&f, &g, instant.bodies.noise().point());
        // How far shrinking has moved the two points that meet from each other.
        let bare = [0, 1].map(|k| {
            let solid = self.bodies()[k];
            let triangle = solid.triangles()[found.triangles[k] as usize];
            Facet::new(triangle.map(|v| solid.vertices()[v as usize]))
        });
        let moved = |k: usize| {
            let [a, b] = [&bare[k], &facets[k]];
            triangle::mean(&a.corners, near.weights[k])
                - triangle::mean(&b.corners, near.weights[k])
        };
        let [p, q] =
            [instant.bodies.moving_matrix * moved(0), instant.bodies.fixed_matrix * moved(1)];
        let much = near.normal.dot(p - q).max(0.0);
        let mut looker = FacetLooker::default();
        let all = spans(facets.each_ref(), self.motions(), self.keep);
        let rate = at(&all, found.lower, &mut looker).map_or(0.0, |look| look.rate);
        let bare = spans(bare.each_ref(), self.motions(), self.keep);
        true_time(&bare, &mut looker, [much, rate], [found.lower, upper])
    }
}

fn of_solids(SolidOverlap { place, least_tolerance, .. }: &SolidOverlap) -> MotionOverlap {
    MotionOverlap { least_tolerance: *least_tolerance, place: Some(*place) }
}
