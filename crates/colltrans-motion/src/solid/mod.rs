//! Solids that turn: when do two of them first touch?
//!
//! Both are shrunk by half a tolerance, as for casts, so that what fits may turn in what holds it. Whether they
//! overlap when the motion begins is decided exactly, insides and all; from then on surfaces have to meet before
//! insides do. Which facets meet first is asked of both trees of boxes and of time.
//!
//! The modules, each using only those before it: `tree` (a shrunk solid), `window` (two parts in an interval, and
//! one plane), `facets` (two facets, as convex bodies), `inside` (a point inside both), `proof` (entries of a cover),
//! `search`, `meeting` (what meets at a time), `verify`, `clearance`.

mod clearance;
mod facets;
pub(super) mod inside;
mod meeting;
mod proof;
mod search;
mod tree;
mod verify;
mod window;

use glam::DVec3;

use self::facets::FacetLooker;
use self::meeting::seen;
use self::proof::Written;
pub use self::proof::{FacetsMeeting, FacetsMet, MotionCover, SolidMotionProof, SpanProof};
use self::search::{Found, Mode, Search};
#[cfg(feature = "json")]
pub use self::tree::Parts;
use self::tree::Tree;
use self::window::Frame;
use super::answer::{MotionContact, MotionFree, MotionOutcome, MotionSteps};
use super::soon::soon;
use super::span::{Span, spans};
use super::verify::MotionProofError;
use super::{MotionCast, Moving, check_fine, usual_tolerance};
use colltrans_convex::body::Features;
use colltrans_convex::cast::Cast;
use colltrans_convex::setting::error::QueryError;
use colltrans_convex::setting::{Setting, check_min_gap};
use colltrans_solid::SolidScene;
use colltrans_solid::SolidSteps;
use colltrans_solid::body::{AsSolid, Solid};
use colltrans_solid::cast::{SolidOptions, StartProof};
use colltrans_solid::solve::nearest::{Spot, points_of, triangle};
use colltrans_solid::solve::overlap;
use colltrans_solid::solve::scene::Scene;

/// How often a proof up to a contact is tried, each time a little shorter.
const MOST_CUTS: i32 = 40;

/// Solids that turn. Answers are as of convex bodies, of both bodies shrunk by half the tolerance.
impl<'a> MotionCast<'a, Solid> {
    /// Between bodies of either kind, as solids: a solid and a convex polyhedron, say.
    ///
    /// A point or a segment is accepted. Its contact with a closed solid has an upper bound: a time at which a point of it
    /// is inside ([`FacetsMet::Contained`]), or at which a segment passes through a facet. A point that passes
    /// through an open shell has none, and its contact is [`MotionOutcome::Grazing`].
    ///
    /// # Errors
    /// A convex body whose facets [`Solid::from_mesh`] refuses.
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
    /// let swing = Motion::turn(Pose::IDENTITY, DVec3::ZERO, DVec3::Z, std::f64::consts::PI)?;
    /// let there = Motion::still(Pose::from_translation(DVec3::Y * 1.5)?);
    /// let cast = MotionCast::between(bar.along(&swing), scene.along(&there))?;
    /// let MotionOutcome::Contact(contact) = cast.first_contact()? else { panic!("no contact") };
    /// assert!(contact.lower < 0.5 && contact.upper - contact.lower < 1e-11);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn between<A: AsSolid, B: AsSolid>(
        moving: Moving<'a, A>,
        fixed: Moving<'a, B>,
    ) -> Result<Self, QueryError> {
        let (p, q) = (moving.body.as_surface()?, fixed.body.as_surface()?);
        Self::new(
            Moving { body: p, motion: moving.motion },
            Moving { body: q, motion: fixed.motion },
        )
    }

    /// The same with a gap to be kept, in world units: what counts is when the bodies, shrunk, are no farther apart.
    ///
    /// # Errors
    /// A gap that is negative, not finite or out of range.
    pub fn keeping(self, gap: f64) -> Result<Self, QueryError> {
        check_min_gap(gap)?;
        Ok(Self { keep: gap, ..self })
    }

    /// The same with both bodies shrunk by half of this length. Without it they are by what rounding can do to a fit:
    /// what touches may part, slide and turn, and is stopped where it is pushed.
    ///
    /// # Errors
    /// A length that is negative or not finite, or that leaves nothing of a closed body.
    pub fn tolerating(self, tolerance: f64) -> Result<Self, QueryError> {
        let cast = Self { tolerance: Some(tolerance), ..self };
        cast.start().map(|_| cast)
    }

    /// The tolerance that is used, as a length.
    pub fn tolerance(&self) -> f64 {
        self.tolerance.unwrap_or_else(|| usual_tolerance(self.bodies(), self.motions()))
    }

    /// When do the bodies first meet? No proof is made: see [`Self::certified_first_contact`].
    ///
    /// # Errors
    /// A body so thin that the default tolerance leaves nothing of it.
    pub fn first_contact(&self) -> Result<MotionOutcome<()>, QueryError> {
        let tolerance = self.tolerance();
        let (start, mut steps) = (self.start()?, MotionSteps::default());
        if overlap::find(&start.asked_of_something()?, &mut SolidSteps::default()).is_some() {
            return Ok(MotionOutcome::Overlapping(self.overlapping((), steps)));
        }
        let trees = self.trees(tolerance);
        for span in spans(trees.each_ref(), self.motions(), self.keep) {
            let (found, _) = searched(&span, Mode::Plain, &mut steps);
            if let Some(found) = found {
                let found = Self::confirmed(&span, found, &mut steps);
                return Ok(self.contact(&span, &found, steps, |_| ()));
            }
        }
        Ok(MotionOutcome::Free(MotionFree { proof: (), steps }))
    }

    /// The same with its proof, which [`Self::verify`] checks without a search. A contact takes a search more: from
    /// the start to it.
    ///
    /// # Errors
    /// As [`Self::first_contact`].
    pub fn certified_first_contact(&self) -> Result<MotionOutcome<SolidMotionProof>, QueryError> {
        let tolerance = self.tolerance();
        let cast = self.start()?;
        let start = cast.prove_start(&cast.asked_of_something()?, &mut SolidSteps::default());
        let mut proof = SolidMotionProof { tolerance, start, spans: Vec::new(), meeting: None };
        let mut steps = MotionSteps::default();
        if matches!(proof.start, StartProof::Overlapping(_)) {
            return Ok(MotionOutcome::Overlapping(self.overlapping(proof, steps)));
        }
        let trees = self.trees(tolerance);
        for span in spans(trees.each_ref(), self.motions(), self.keep) {
            let (found, written) = searched(&span, Mode::Writing, &mut steps);
            let Some(found) = found else {
                proof.spans.push(SpanProof::new(span.to, written));
                continue;
            };
            let mut found = Self::confirmed(&span, found, &mut steps);
            let (lower, written) = up_to(&span, found.lower, &mut steps);
            found.lower = lower;
            proof.spans.push(SpanProof::new(lower, written));
            return Ok(
                self.contact(&span, &found, steps, |meeting| SolidMotionProof { meeting, ..proof })
            );
        }
        Ok(MotionOutcome::Free(MotionFree { proof, steps }))
    }

    /// Checks a proof without a search. Returns up to which time the bodies, shrunk, are proven not to meet, and when
    /// they are proven to, infinity if that is not claimed.
    ///
    /// # Errors
    /// What is not proven.
    pub fn verify(&self, proof: &SolidMotionProof) -> Result<[f64; 2], MotionProofError> {
        verify::verify(self, proof)
    }

    /// The bodies where they start; of no direction.
    fn start(&self) -> Result<Cast<'a, Solid>, QueryError> {
        let bodies = self.bodies();
        if self.tolerance.is_none() {
            check_fine(bodies, self.tolerance())?;
        }
        let [p, q] = self.motions().map(|motion| motion.pieces()[0].start);
        let options = SolidOptions::default().with_tolerance(self.tolerance()).with_keep(self.keep);
        Cast::new(bodies[0].at(p), bodies[1].at(q), DVec3::Z)?.with_options(options)
    }

    /// The facets and trees that a proof is about.
    #[cfg(feature = "json")]
    #[doc(hidden)]
    pub fn parts(&self) -> [Parts; 2] {
        self.trees(self.tolerance()).map(|tree| Parts::of(&tree))
    }

    /// The tolerance, if one was given.
    #[cfg(feature = "json")]
    #[doc(hidden)]
    pub const fn given_tolerance(&self) -> Option<f64> {
        self.tolerance
    }

    fn trees(&self, tolerance: f64) -> [Tree<'a>; 2] {
        self.bodies().map(|solid| Tree::new(solid, 0.5 * tolerance))
    }

    /// The same with two facets that meet for certain, if there are some earlier than those found.
    fn confirmed(span: &Span<Tree>, mut found: Found, steps: &mut MotionSteps) -> Found {
        let known = found.met.map(|(time, ..)| time);
        let (frame, mut looker) = (Frame::new(span), FacetLooker::default());
        let seen = |time| seen(&frame, time, &mut looker);
        let earlier = soon(found.lower, known, span.to.next_up(), seen);
        if let Some((time, (pair, how))) = earlier {
            found.met = Some((time, pair, how));
        }
        *steps += looker.steps;
        found
    }

    /// The bodies at a time, as they are.
    fn scene(&self, span: &Span<Tree>, time: f64) -> Option<Scene<'a>> {
        let bodies = span.instant(time).bodies.holding(self.bodies());
        let setting = Setting::of(bodies, DVec3::Z).ok()?;
        Some(Scene::new(&setting, [0.0; 2], self.keep))
    }

    /// What is to be said where the bodies meet, or may.
    fn contact<P>(
        &self,
        span: &Span<Tree>,
        found: &Found,
        steps: MotionSteps,
        proof: impl FnOnce(Option<FacetsMeeting>) -> P,
    ) -> MotionOutcome<P> {
        let meeting =
            found.met.map(|(time, triangles, met)| FacetsMeeting { time, triangles, met });
        let (lower, upper) = (found.lower, meeting.map_or(f64::INFINITY, |meeting| meeting.time));
        let bodies = span.instant(lower).bodies;
        let [p, q] = [bodies.moving_matrix, bodies.fixed_matrix];
        let poses =
            [0, 1].map(|k| colltrans_convex::Pose::checked([p, q][k], bodies.translations[k]));
        // What is proven does not hang on it. The facets are those of the shrunk bodies, and so is the normal.
        let [f, g] = [0, 1].map(|k| span.body(k).facet(found.triangles[k]));
        let at = span.part([&f, &g], [span.from, span.to]).instant(lower);
        let [f, g] = facets::corners(&at);
        let nearest = triangle::nearest(&f, &g, at.bodies.noise().point());
        let (spot, scene) = (Spot { triangles: found.triangles, nearest }, self.scene(span, lower));
        let points = scene.as_ref().map(|scene| {
            points_of(scene, spot.triangles, nearest.weights)
                .map(|point| point + bodies.translations[0])
        });
        let is_apart = nearest.gap > 0.0;
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

    /// What is said of bodies that overlap when the motion begins.
    fn overlapping<P>(&self, proof: P, steps: MotionSteps) -> MotionContact<P> {
        let poses = self.motions().map(|motion| motion.pieces()[0].start);
        let (points, normal, features) = (None, None, None);
        MotionContact { lower: 0.0, upper: 0.0, poses, points, normal, features, proof, steps }
    }
}

/// Searches a span.
fn searched(span: &Span<Tree>, mode: Mode, steps: &mut MotionSteps) -> (Option<Found>, Written) {
    let mut search = Search::new(Frame::new(span), mode);
    search.run();
    *steps += search.steps;
    (search.found, search.written.unwrap_or_default())
}

/// What proves a span up to a time, or to a little before where that cannot be written down.
fn up_to(span: &Span<Tree>, mut until: f64, steps: &mut MotionSteps) -> (f64, Written) {
    for k in 0..MOST_CUTS {
        if until <= span.from {
            break;
        }
        let (found, written) = searched(&span.until(until), Mode::Writing, steps);
        let Some(found) = found else { return (until, written) };
        let less = if found.lower < until { 0.0 } else { f64::EPSILON * 2.0_f64.powi(k) };
        until = (found.lower - less).max(span.from);
    }
    (span.from, Written::default())
}
