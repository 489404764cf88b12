//! The solver of one cast: from two placed bodies and a direction to an [`Outcome`].
//!
//! 1. *Features*: starts from the portal or the separating direction of the previous cast.
//! 2. *Narrowing*: otherwise, tests a pair of large opposed faces, or guesses the contact normal. The guess comes from
//!    inertia ellipsoids, or from [`cta`], which may be confined to a *region* around the previous solution.
//! 3. *Enclosure*: finds a first portal or a separating line, unless an earlier stage has found one.
//! 4. *Refinement*: exchanges corners of the portal until it is in the lowest face of `M` ([`portal`]).
//!
//! Stages 1 and 2 only save work. Their results are proven, or refined like any other portal, so a wrong one costs
//! time but never correctness. [`Plane::if_supported_at`] checks a plane through known vertices, which is also its
//! proof. A support point is searched only if this check fails.

pub(crate) mod cta;
pub mod min_gap;
pub mod nearest;
pub mod observe;
pub mod options;
pub(crate) mod portal;
mod proof;
mod solution_guess;
mod warm_start;
mod warm_start_policy;

use glam::DVec2;

use crate::answer::{Outcome, Separated, Separation, Solver, StartedFrom};
use crate::setting::error::{QueryError, Stalled};
use crate::setting::minkowski::MinkowskiDifference;
use crate::setting::{Setting, VertexPair};
use cta::options::Region;
use cta::{ContactGuess, LastSolution, MinimisationOptions, MinimisationStart};
use observe::{Observer, Phase, ShadowFrame, Support, Watch};
use options::{Focus, Options};
use portal::{
    Context, Enclosure, Face, NormalGuess, Overlap, Plane, Portal, PortalStatus, Refined,
    SeparatingLine, WalkResult,
};
use proof::ProvenFace;
pub(crate) use warm_start::{TrackerUpdate, WarmStart};
pub(crate) use warm_start_policy::WarmStartPolicy;

/// Casts the moving body and returns the outcome. Ignores `options.min_gap`.
///
/// The cast starts from the result of the previous one, `last`, as far as `focus` allows. If it
/// succeeds, `next` holds the start of the following cast and the work counts.
///
/// # Errors
/// [`QueryError::NotConverged`] if rounding prevents a proof in all frames.
#[inline]
pub(crate) fn search<O: Observer>(
    setting: &Setting,
    options: &Options,
    focus: &Focus,
    last: &WarmStart,
    next: &mut TrackerUpdate,
    observer: &mut O,
) -> Result<Outcome, QueryError> {
    let solver = match options.solver {
        Solver::Auto => Solver::Portal,
        solver => solver,
    };
    *next = TrackerUpdate::default();
    let mut cast = CastState {
        context: Context {
            difference: MinkowskiDifference::new(setting),
            watch: Watch::new(observer),
        },
        graze_tolerance: options.graze_tolerance,
        solver,
        narrowing: options.narrowing,
        rotation: 0,
        next,
    };
    cast.run_stages(focus, last)
}

/// Rotations of the lateral axes by 0, 0.7 and 2.1 radians, as cosine and sine.
///
/// Exchanges that cycle through tied vertices in one frame do not cycle in another. The values are
/// stored because the sine and cosine of different libraries round differently.
const LATERAL_ROTATIONS: [DVec2; 3] = [
    DVec2::X,
    DVec2::new(0.764_842_187_284_488_5, 0.644_217_687_237_691),
    DVec2::new(-0.504_846_104_599_857_6, 0.863_209_366_648_873_7),
];

/// Maximum number of exchanges after a start from features. A cast that needs more began at an
/// unsuitable portal, or cycles through tied vertices. It is then repeated from scratch.
const MAX_EXCHANGES_AFTER_WALK: usize = 30;

/// Start of portal refinement that narrowing has found.
enum NarrowedStart {
    /// A guess of the contact normal.
    Normal(NormalGuess),
    /// A portal or a separating line.
    Enclosed(Enclosure),
}

/// State of one cast.
struct CastState<'a, 'o, 'n, O> {
    context: Context<'a, 'o, O>,
    graze_tolerance: f64,
    solver: Solver,
    narrowing: cta::options::Options,
    /// Index in `LATERAL_ROTATIONS` of the frame for attempts from scratch.
    rotation: usize,
    /// Start of the next cast, written together with the answer.
    next: &'n mut TrackerUpdate,
}

/// Attempt to enclose the line. The second one follows if the line seemed to miss `M` but does not.
#[derive(Clone, Copy, PartialEq)]
enum Attempt {
    First,
    Second,
}

/// Each code path constructs the [`Outcome`] in its tail call, so that it is written directly into the
/// caller's return slot. An intermediate copy stalls on store-to-load forwarding.
impl<O: Observer> CastState<'_, '_, '_, O> {
    /// Runs all stages of an attempt.
    fn run_stages(&mut self, focus: &Focus, last: &WarmStart) -> Result<Outcome, QueryError> {
        self.context.watch.search_started(|| ShadowFrame {
            world_from_shadow: self.context.difference.setting_from_shadow,
            noise: self.context.difference.noise.point_error(),
        });
        if focus.features
            && let Some(certificate) = self.separation_from_last(last)
        {
            return Ok(Outcome::Separated(self.separated_outcome(certificate)));
        }
        let from_features = if focus.features { self.enclosure_from_features(last) } else { None };
        let enclosure = if from_features.is_some() {
            self.context.watch.steps.started_from = StartedFrom::Features;
            from_features
        } else {
            self.enclosure_from_scratch(focus.region, last)
        };
        self.context.watch.phase_ended(Phase::Finish);
        self.outcome_of(enclosure, Attempt::First)
    }

    /// Computes the outcome from a portal or a separating line. Retries from scratch if there is neither.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "a portal copied through memory stalls")]
    fn outcome_of(
        &mut self,
        enclosure: Option<Enclosure>,
        attempt: Attempt,
    ) -> Result<Outcome, QueryError> {
        match enclosure {
            None => self.retry_from_scratch(Stalled::NoPortal),
            Some(Enclosure::Portal(mut portal, status)) => {
                self.contact_or_grazing(&mut portal, status, attempt)
            }
            Some(Enclosure::Separated(found)) => self.separated_or_grazing(found, attempt),
        }
    }

    /// Repeats a failed cast from scratch, with the next rotation of the lateral axes if the failed
    /// attempt was itself from scratch.
    ///
    /// Returns [`QueryError::NotConverged`] with the last `reason` if no rotation is left.
    #[cold]
    fn retry_from_scratch(&mut self, reason: Stalled) -> Result<Outcome, QueryError> {
        self.context.watch.phase_ended(Phase::Finish);
        let steps = &mut self.context.watch.steps;
        self.rotation += usize::from(steps.started_from == StartedFrom::Scratch);
        steps.started_from = StartedFrom::Scratch;
        let Some(&rotation) = LATERAL_ROTATIONS.get(self.rotation) else {
            self.context.watch.phase_ended(Phase::Answer);
            return Err(QueryError::NotConverged { reason });
        };
        let setting = self.context.difference.setting;
        self.context.difference = MinkowskiDifference::with_rotated_axes(setting, rotation);
        self.run_stages(&Focus::NONE, &WarmStart::Nothing)
    }

    /// Decides between separation and grazing for a line that seems to miss `M` or to touch its
    /// silhouette.
    fn separated_or_grazing(
        &mut self,
        found: SeparatingLine,
        attempt: Attempt,
    ) -> Result<Outcome, QueryError> {
        if let Some(certificate) = self.proven_separation(&found) {
            return Ok(Outcome::Separated(self.separated_outcome(certificate)));
        }
        let widest = portal::widest_margin(&mut self.context, found);
        if widest.margin < -self.context.difference.touching_distance() {
            return match attempt {
                Attempt::First => self.enclose_again(&widest),
                Attempt::Second => self.retry_from_scratch(Stalled::NoPortal),
            };
        }
        if let Some(certificate) = self.proven_separation(&widest) {
            return Ok(Outcome::Separated(self.separated_outcome(certificate)));
        }
        self.grazing_by_widening(&widest)
    }

    /// Records the work counts of an answer that is found.
    #[inline]
    fn record_steps(&mut self) {
        self.next.steps = Some(self.context.watch.steps);
        self.context.watch.phase_ended(Phase::Answer);
    }

    /// Returns the outcome of a separation, and records the work counts.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "built in the return slot")]
    fn separated_outcome(&mut self, certificate: Separation) -> Separated {
        self.record_steps();
        Separated { certificate, solver: self.solver, steps: self.context.watch.steps }
    }

    /// Encloses the line again after a separating line was refuted, and computes the outcome.
    #[cold]
    fn enclose_again(&mut self, refuted: &SeparatingLine) -> Result<Outcome, QueryError> {
        let enclosure = self.enclosure_from_refuted(refuted);
        self.outcome_of(enclosure, Attempt::Second)
    }

    /// Computes a portal or a separating line after a separating line was refuted, starting at its verified
    /// support point.
    ///
    /// Such a line was found because a hill climb had stopped short of the support point.
    #[cold]
    fn enclosure_from_refuted(&mut self, refuted: &SeparatingLine) -> Option<Enclosure> {
        let start =
            NormalGuess { normal: refuted.normal.extend(0.0), near: Some(refuted.point.pair) };
        portal::enclose(&mut self.context, &start)
    }

    /// Computes a portal or a separating line from the features of the previous answer. `None` if they
    /// yield neither.
    fn enclosure_from_features(&mut self, last: &WarmStart) -> Option<Enclosure> {
        match last {
            WarmStart::Nothing | WarmStart::Opposite { .. } | WarmStart::WithMinGap { .. } => None,
            WarmStart::Contact(portal) => {
                let walk = portal::walk_from_last(&mut self.context, portal);
                self.enclosure_of_walk(walk)
            }
            WarmStart::Apart { normals, pair } => {
                let [p, q] = self.context.difference.body_normals_to_shadow(*normals)?;
                self.confirmed_separation((p + q).truncate(), [*pair; 2])
            }
        }
    }

    /// Computes a portal or a separating line from scratch, or, with [`Solver::Cta`], from the region of
    /// the previous solution.
    fn enclosure_from_scratch(&mut self, region: Region, last: &WarmStart) -> Option<Enclosure> {
        let setting = self.context.difference.setting;
        let solid = setting.moving.dimension() == 3 && setting.fixed.dimension() == 3;
        if self.solver == Solver::Cta && solid {
            return self.enclosure_by_cta(region, last);
        }
        let walk = portal::opposed_face_contact(&mut self.context);
        let found = self.enclosure_of_walk(walk);
        if found.is_some() {
            return found;
        }
        self.enclosure_from_guess(NormalGuess::new(&self.context.difference))
    }

    /// Computes a portal or a separating line with the collision translation algorithm.
    #[inline(never)]
    fn enclosure_by_cta(&mut self, region: Region, last: &WarmStart) -> Option<Enclosure> {
        match self.narrowed_start(region, last) {
            NarrowedStart::Enclosed(found) => Some(found),
            NarrowedStart::Normal(start) => self.enclosure_from_guess(start),
        }
    }

    /// Computes a portal or a separating line from a guess of the contact normal.
    ///
    /// Walks over the faces of `M` if the guess is not lateral. Calls [`portal::enclose`] if it is lateral or the walk
    /// fails.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "a guess copied through memory stalls")]
    fn enclosure_from_guess(&mut self, start: NormalGuess) -> Option<Enclosure> {
        self.context.watch.phase_ended(Phase::Setup);
        if self.has_rims() {
            return self.enclosure_by_outlines(&start);
        }
        let mut nearest = start;
        if start.normal.z > 0.0 {
            let (walk, reached) =
                portal::walk_from_guess(&mut self.context, &start, &portal::ELLIPSOID_LIMITS);
            nearest = reached;
            let found = self.enclosure_of_walk(walk);
            if found.is_some() {
                return found;
            }
        }
        portal::enclose(&mut self.context, &nearest)
    }

    /// Computes a portal or a separating line for bodies with rims, from the maximum over their
    /// outlines. Walks from the guess `start` if the outlines give no result.
    #[inline(never)]
    fn enclosure_by_outlines(&mut self, start: &NormalGuess) -> Option<Enclosure> {
        let upward;
        let start = if start.normal.z > 0.0 {
            start
        } else {
            upward = match portal::upward_guess(&mut self.context, start) {
                Ok(upward) => upward,
                Err(line) => return Some(Enclosure::Separated(line)),
            };
            &upward
        };
        let by_outlines = portal::walk_from_outlines(&mut self.context, start);
        let (walk, reached) = by_outlines.unwrap_or_else(|| {
            portal::walk_from_guess(&mut self.context, start, &portal::ELLIPSOID_LIMITS)
        });
        let found = self.enclosure_of_walk(walk);
        found.or_else(|| portal::enclose(&mut self.context, &reached))
    }

    /// Converts the result of a face walk. A silhouette edge becomes a separating line if it is
    /// confirmed to be one.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "a portal copied through memory stalls")]
    fn enclosure_of_walk(&mut self, walk: WalkResult) -> Option<Enclosure> {
        match walk {
            WalkResult::Portal(portal, status) => Some(Enclosure::Portal(portal, status)),
            WalkResult::Silhouette { outward, edge } => self.confirmed_separation(-outward, edge),
            WalkResult::Lost => None,
        }
    }

    /// Checks whether one of the bodies has rims.
    #[inline]
    fn has_rims(&self) -> bool {
        let setting = self.context.difference.setting;
        setting.moving.may_have_rims() || setting.fixed.may_have_rims()
    }

    /// Returns a separating line along `lateral` if all of `M` lies on its positive side, up to the
    /// touching distance.
    ///
    /// `edge` holds the ends of the silhouette edge that suggests this line, or one vertex pair twice.
    /// `None` if a point of `M` lies on the other side, or `lateral` is too short to be normalised.
    fn confirmed_separation(&mut self, lateral: DVec2, edge: [VertexPair; 2]) -> Option<Enclosure> {
        let [near, other] = edge;
        // Normalising a shorter vector loses digits.
        if lateral.length_squared() <= f64::MIN_POSITIVE {
            return None;
        }
        let normal = lateral.try_normalize()?;
        let least = -self.context.difference.touching_distance();
        if normal.dot(self.context.difference.vertex_point(near).shadow()) < least {
            return None;
        }
        let point = self.context.difference.support_point_from(normal.extend(0.0), near);
        self.context.watch.support(|| Support::from_point(normal.extend(0.0), &point));
        let margin = normal.dot(point.shadow());
        let end = if point.pair == other { near } else { other };
        let line = SeparatingLine { normal, margin, point, end };
        (margin >= least).then_some(Enclosure::Separated(line))
    }

    /// Computes the start of portal refinement, from the region of the previous solution or from the opposite contact
    /// if possible.
    fn narrowed_start(&mut self, region: Region, last: &WarmStart) -> NarrowedStart {
        if let Some(focus) = self.region_focus(region, last) {
            self.context.watch.steps.started_from = StartedFrom::Region;
            return self.start_by_cta(MinimisationStart::Region(focus));
        }
        if let WarmStart::Opposite { normal } = last
            && self.narrowing.start != cta::options::Start::Ellipsoids
            && let Some(guess) = solution_guess::opposite_solution(&mut self.context, *normal)
        {
            return self.start_by_cta(MinimisationStart::Region(guess));
        }
        match self.narrowing.start {
            cta::options::Start::Center => self.start_by_cta(MinimisationStart::Center),
            cta::options::Start::Ellipsoids => self.start_from_ellipsoids(),
            cta::options::Start::Guess => {
                let guess = solution_guess::guessed_solution(&mut self.context);
                let start = guess.map_or(MinimisationStart::Center, MinimisationStart::Region);
                self.start_by_cta(start)
            }
        }
    }

    /// Computes the start from the inertia ellipsoids.
    ///
    /// If the line enters their difference, the normal there is the guess. Solving a planar problem
    /// would cost more than it saves (measured). If the line misses their difference, the lateral normal
    /// is the guess only if its support point separates the bodies. Otherwise runs [`cta`].
    fn start_from_ellipsoids(&mut self) -> NarrowedStart {
        let ellipsoids = NormalGuess::from_ellipsoids(&self.context.difference);
        let normal = ellipsoids.normal;
        if normal.z > 0.0 {
            return NarrowedStart::Normal(ellipsoids);
        }
        let support = self.context.difference.support_point(normal);
        self.context.watch.support(|| Support::from_point(normal, &support));
        if normal.dot(support.coordinates) > 0.0 {
            return NarrowedStart::Normal(NormalGuess::from_solver(normal, support.pair));
        }
        self.start_by_cta(MinimisationStart::Center)
    }

    /// Runs the collision translation algorithm and converts its result into a start.
    fn start_by_cta(&mut self, origin: MinimisationStart) -> NarrowedStart {
        self.context.watch.phase_ended(Phase::Setup);
        let cta::options::Options { until, keeps_to_cell, cuts, starts_cold, .. } = self.narrowing;
        let gap = until.gap();
        let options = MinimisationOptions { start: origin, gap, keeps_to_cell, cuts, starts_cold };
        let narrowed =
            cta::minimise(self.context.difference.setting, &options, &mut self.context.watch);
        let corners = narrowed.corners.as_ref();
        if let Some(portal) =
            corners.and_then(|c| portal::pierced_triangle(&self.context.difference, c))
        {
            return NarrowedStart::Enclosed(Enclosure::Portal(portal, PortalStatus::ReachedByWalk));
        }
        let [moving, fixed] = narrowed.vertices;
        let near = VertexPair::from_indices(moving[0], fixed[0]);
        let in_shadow = |normal| self.context.difference.setting_from_shadow.transpose() * normal;
        NarrowedStart::Normal(match narrowed.guess {
            ContactGuess::Contact { normal } => NormalGuess::from_solver(in_shadow(normal), near),
            ContactGuess::Separation { direction } => {
                NormalGuess::from_solver(in_shadow(direction).with_z(0.0), near)
            }
            ContactGuess::Nothing => NormalGuess::from_ellipsoids(&self.context.difference),
        })
    }

    /// Returns the region for [`cta`]: the last contact points and the half-side of the square around
    /// them.
    ///
    /// `None` for [`Region::Everywhere`], and if the previous cast left no contact or separation. For
    /// [`Region::Automatic`] also if the bodies have moved or rotated too far.
    fn region_focus(&self, region: Region, last: &WarmStart) -> Option<LastSolution> {
        let setting = self.context.difference.setting;
        let (touching, normals, pair) = match last {
            WarmStart::Nothing | WarmStart::Opposite { .. } | WarmStart::WithMinGap { .. } => {
                return None;
            }
            WarmStart::Contact(portal) => {
                let touching = setting.weighted_points(&portal.pairs, &portal.weights);
                (touching, portal.normals, portal.pairs[0])
            }
            WarmStart::Apart { pair, normals } => (setting.vertices(*pair), *normals, *pair),
        };
        let half_side = match region {
            Region::Everywhere => return None,
            Region::Fixed(delta) => delta,
            Region::Automatic => {
                self.context.difference.body_normals_to_shadow(normals)?;
                setting.lateral_displacement(touching)
            }
        };
        let worth = region != Region::Automatic || self.context.difference.is_near(half_side);
        worth.then_some(LastSolution { touching, half_side, pair: Some(pair), normal: normals[0] })
    }

    /// Refines the portal, and returns a contact, or grazing if the overlap is within the tolerance. If the
    /// line touches the silhouette, decides between separation and grazing.
    fn contact_or_grazing(
        &mut self,
        portal: &mut Portal,
        status: PortalStatus,
        attempt: Attempt,
    ) -> Result<Outcome, QueryError> {
        let Face { plane, weights } = if let Some(face) = self.proven_face(portal, status) {
            face
        } else {
            match self.refine_portal(portal) {
                Some(Refined::Lowest(face)) => face,
                Some(Refined::Silhouette(line)) => return self.separated_or_grazing(line, attempt),
                None => return self.retry_from_scratch(Stalled::Cycle),
            }
        };
        let tolerance = self.graze_tolerance.max(self.context.difference.touching_distance());
        let overlap = portal::overlap(&mut self.context, portal, tolerance);
        self.context.watch.phase_ended(Phase::Finish);
        let proven = match ProvenFace::new(&self.context.difference, portal, &plane, weights) {
            Ok(proven) => proven,
            Err(reason) => return self.retry_from_scratch(reason),
        };
        self.next.start = WarmStart::Contact(proven.contact_portal());
        self.record_steps();
        match overlap {
            Overlap::Ample => {
                Ok(Outcome::Contact(proven.contact(self.solver, self.context.watch.steps)))
            }
            Overlap::Slight { inward, depth, .. } => {
                let contact = proven.contact(self.solver, self.context.watch.steps);
                let grazing =
                    proof::grazing_contact(&self.context.difference, inward, depth, contact);
                Ok(Outcome::Grazing(grazing))
            }
        }
    }

    /// Returns the lowest face, if an earlier stage has proven it or the plane of a portal that a walk
    /// has reached supports `M`.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "a copy through memory stalls its reader")]
    fn proven_face(&mut self, portal: &Portal, status: PortalStatus) -> Option<Face> {
        match status {
            PortalStatus::Lowest(face) => Some(face),
            PortalStatus::ReachedByWalk => portal::supported_face(&mut self.context, portal),
            PortalStatus::EnclosesLine => None,
        }
    }

    /// Refines `portal` in place and returns the lowest face, or the silhouette if the line touches it.
    /// `None` if refinement stalls.
    #[inline(never)]
    fn refine_portal(&mut self, portal: &mut Portal) -> Option<Refined> {
        let most = match self.context.watch.steps.started_from {
            StartedFrom::Features => MAX_EXCHANGES_AFTER_WALK,
            _ => portal::MAX_PORTALS,
        };
        portal::refine(&mut self.context, portal, most)
    }

    /// Returns the grazing outcome of a line that touches the silhouette of `M`, or misses it by less
    /// than rounding can resolve.
    ///
    /// Its contact is that of the bodies widened laterally by slightly more than the rounding error.
    #[cold]
    fn grazing_by_widening(&mut self, silhouette: &SeparatingLine) -> Result<Outcome, QueryError> {
        self.context.difference = self.context.difference.widened_by(silhouette.margin);
        let (portal, Face { plane, weights }) = match self.widened_face() {
            Ok(found) => found,
            Err(reason) => return self.retry_from_scratch(reason),
        };
        let proven = match ProvenFace::new(&self.context.difference, &portal, &plane, weights) {
            Ok(proven) => proven,
            Err(reason) => return self.retry_from_scratch(reason),
        };
        let plane = Plane::at_support(
            &self.context.difference,
            silhouette.normal.extend(0.0),
            silhouette.point.pair,
        );
        self.next.start =
            proof::plane_separation(&self.context.difference, &plane, silhouette.margin).1;
        self.record_steps();
        let contact = proven.contact(self.solver, self.context.watch.steps);
        let grazing = proof::grazing_contact(
            &self.context.difference,
            silhouette.normal,
            -silhouette.margin,
            contact,
        );
        Ok(Outcome::Grazing(grazing))
    }

    /// Computes a portal and the lowest face of the widened bodies on the line. Returns the reason as the
    /// error if none is found.
    fn widened_face(&mut self) -> Result<(Portal, Face), Stalled> {
        if let WalkResult::Portal(portal, PortalStatus::Lowest(face)) =
            portal::opposed_face_contact(&mut self.context)
        {
            return Ok((portal, face));
        }
        let start = NormalGuess::from_ellipsoids(&self.context.difference);
        let mut enclosure = portal::enclose(&mut self.context, &start);
        // The line is inside the widened bodies. Therefore a separating line is refuted.
        if let Some(Enclosure::Separated(found)) = enclosure {
            let refuted = portal::widest_margin(&mut self.context, found);
            enclosure = self.enclosure_from_refuted(&refuted);
        }
        let Some(Enclosure::Portal(mut portal, _)) = enclosure else {
            return Err(Stalled::NoPortal);
        };
        match portal::refine(&mut self.context, &mut portal, portal::MAX_PORTALS) {
            Some(Refined::Lowest(face)) => Ok((portal, face)),
            _ => Err(Stalled::Cycle),
        }
    }

    /// Returns the separation that a separating line proves. `None` if its margin may be due to rounding.
    #[inline]
    fn proven_separation(&mut self, found: &SeparatingLine) -> Option<Separation> {
        if found.margin <= self.context.difference.noise.lower_bound_margin() {
            return None;
        }
        let plane =
            Plane::at_support(&self.context.difference, found.normal.extend(0.0), found.point.pair);
        let settled = found.normal.dot(self.context.difference.vertex_point(plane.lowest).shadow());
        self.separation_by_plane(&plane, found.margin.min(settled))
    }

    /// Returns the separation that a plane parallel to the direction proves. `None` if its certified
    /// margin is not positive or would not pass verification.
    #[inline]
    fn separation_by_plane(&mut self, plane: &Plane, margin: f64) -> Option<Separation> {
        let (certificate, start) = proof::plane_separation(&self.context.difference, plane, margin);
        if certificate.margin <= 0.0 || !self.passes_verification(&certificate) {
            return None;
        }
        self.next.start = start;
        Some(certificate)
    }

    /// Returns the separation proven by the separating plane of the previous answer, rotated with the
    /// bodies. `None` if it proves nothing now, for example because its vertex pair is not a support pair.
    #[inline]
    fn separation_from_last(&mut self, last: &WarmStart) -> Option<Separation> {
        let WarmStart::Apart { normals, pair } = last else { return None };
        let [p, q] = self.context.difference.body_normals_to_shadow(*normals)?;
        let lateral = (p + q).truncate();
        // The square of a shorter vector underflows.
        if lateral.length_squared() <= f64::MIN_POSITIVE {
            return None;
        }
        let normal = lateral.extend(0.0);
        let plane = Plane::if_supported_at(&self.context.difference, normal, *pair)?;
        let point = self.context.difference.vertex_point(plane.lowest);
        self.context.watch.support(|| Support::from_point(normal, &point));
        self.context.watch.steps.started_from = StartedFrom::Features;
        let found =
            self.separation_by_plane(&plane, normal.dot(point.coordinates) / lateral.length());
        if found.is_none() {
            self.context.watch.steps.started_from = StartedFrom::Scratch;
        }
        found
    }

    /// Checks that a separation of the cores passes verification. That of the rounded bodies is proven by the caller.
    ///
    /// A verifier rounds differently and may find other support points. Both together lower the margin
    /// by less than twice the touching distance. A smaller margin is verified here.
    #[inline]
    fn passes_verification(&self, certificate: &Separation) -> bool {
        certificate.margin > 2.0 * self.context.difference.noise.touching_distance()
            || certificate.verify_of_cores(self.context.difference.setting).is_ok()
    }
}
