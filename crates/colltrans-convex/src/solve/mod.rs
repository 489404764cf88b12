//! One cast: from a setting, and what is left of the one before, to an outcome.
//!
//! The way: *features* (the portal or the separating direction of the last answer, if there is one)
//! -> *narrowing* (large faces that face each other, or a guess of the normal, from ellipsoids or by
//! the collision translation algorithm, which may confine itself to the *region* of the last solution)
//! -> a first portal -> the lowest face. The first two only save work: whatever they propose has to be
//! proven, or passes through the same enclosure and refinement, so a wrong proposal costs time and
//! nothing else.
//!
//! A proposal is a plane through vertices of `M`. Whether it supports `M` is asked first where it is
//! ([`Plane::at`], which is also the proof), and a support point is searched only if it does not.

pub(crate) mod cta;
pub mod keep;
pub mod nearest;
pub mod observe;
pub mod options;
pub(crate) mod portal;
mod proof;
mod warm_start;
mod warm_start_policy;

use glam::DVec2;

use crate::answer::{Outcome, Separated, Separation, Solver, StartedFrom};
use crate::setting::error::{QueryError, Stalled};
use crate::setting::minkowski::MinkowskiDifference;
use crate::setting::{Setting, VertexPair};
use cta::options::Region;
use cta::{CtaOptions, Guess, Origin, RegionFocus};
use observe::{Observer, Phase, ShadowFrame, Support, Watch};
use options::{Focus, Options};
use portal::{
    Context, Enclosure, Face, FirstNormal, Followed, Known, Overlap, Plane, Portal, Refined,
    SeparatingLine,
};
use proof::Proven;
pub(crate) use warm_start::{Left, WarmStart};
pub(crate) use warm_start_policy::Pace;

/// Casts, starting from the `last` cast as far as `focus` allows, and leaves in `next` where the next one may start
/// and the work that was done, if there is an answer. No gap is kept.
#[inline]
pub(crate) fn search<O: Observer>(
    setting: &Setting,
    options: &Options,
    focus: &Focus,
    last: &WarmStart,
    next: &mut Left,
    observer: &mut O,
) -> Result<Outcome, QueryError> {
    let solver = match options.solver {
        Solver::Auto => Solver::Portal,
        solver => solver,
    };
    *next = Left::default();
    let mut run = Run {
        context: Context {
            difference: MinkowskiDifference::new(setting),
            watch: Watch::new(observer),
        },
        graze_tolerance: options.graze_tolerance,
        solver,
        narrowing: options.narrowing,
        turn: 0,
        next,
    };
    run.run(focus, last)
}

/// Turns of the lateral axes, by 0, 0.7 and 2.1: ties that follow each other in a circle in one
/// frame do not in another. Cosines and sines are stored, because libraries round them differently.
const TURNS: [DVec2; 3] = [
    DVec2::X,
    DVec2::new(0.764_842_187_284_488_5, 0.644_217_687_237_691),
    DVec2::new(-0.504_846_104_599_857_6, 0.863_209_366_648_873_7),
];

/// A followed portal that is this many exchanges from the lowest face was a bad place to start, or
/// one where ties follow each other.
const MOST_AFTER_FOLLOWING: usize = 30;

/// What narrowing leaves to portal refinement.
enum Start {
    /// A guess of the contact normal.
    Normal(FirstNormal),
    /// A portal, or a separating direction.
    Enclosed(Enclosure),
}

/// One cast under way.
struct Run<'a, 'o, 'n, O> {
    context: Context<'a, 'o, O>,
    graze_tolerance: f64,
    solver: Solver,
    narrowing: cta::options::Options,
    /// Which of the `TURNS` an attempt from scratch has.
    turn: usize,
    /// Written with the answer.
    next: &'n mut Left,
}

/// Whether a line that seemed to pass `M` was found not to, after which its portal is looked for once more.
#[derive(Clone, Copy, PartialEq)]
enum Attempt {
    First,
    Second,
}

/// An answer is made where it is to stay, by the last call of each way there: one that is kept and handed on is
/// moved through memory, and who moves it waits for what was just written.
impl<O: Observer> Run<'_, '_, '_, O> {
    fn run(&mut self, focus: &Focus, last: &WarmStart) -> Result<Outcome, QueryError> {
        self.context.watch.begun(|| ShadowFrame {
            world_from_shadow: self.context.difference.setting_from_shadow,
            noise: self.context.difference.noise.point(),
        });
        if focus.features
            && let Some(certificate) = self.still_apart(last)
        {
            return Ok(Outcome::Separated(self.apart(certificate)));
        }
        let followed = if focus.features { self.follow(last) } else { None };
        let enclosure = if followed.is_some() {
            self.context.watch.steps.started_from = StartedFrom::Features;
            followed
        } else {
            self.enclosure(focus.region, last)
        };
        self.context.watch.ended(Phase::Finish);
        self.concluded(enclosure, Attempt::First)
    }

    /// What follows from a portal, or from a separating direction.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "passed through memory a portal stalls its reader")]
    fn concluded(
        &mut self,
        enclosure: Option<Enclosure>,
        attempt: Attempt,
    ) -> Result<Outcome, QueryError> {
        match enclosure {
            None => self.again(Stalled::NoPortal),
            Some(Enclosure::Portal(mut portal, known)) => {
                self.contact_or_grazing(&mut portal, known, attempt)
            }
            Some(Enclosure::Beside(found)) => self.passed(found, attempt),
        }
    }

    /// No answer could be proven: tries from scratch, by one turn of the lateral axes after another, until one is, or
    /// tells why the last was none.
    #[cold]
    fn again(&mut self, reason: Stalled) -> Result<Outcome, QueryError> {
        self.context.watch.ended(Phase::Finish);
        let steps = &mut self.context.watch.steps;
        self.turn += usize::from(steps.started_from == StartedFrom::Scratch);
        steps.started_from = StartedFrom::Scratch;
        let Some(&turn) = TURNS.get(self.turn) else {
            self.context.watch.ended(Phase::Answer);
            return Err(QueryError::NotConverged { reason });
        };
        let setting = self.context.difference.setting;
        self.context.difference = MinkowskiDifference::with_rotated_axes(setting, turn);
        self.run(&Focus::NONE, &WarmStart::Nothing)
    }

    /// The line passes `M`, or its rim: separated if that can be told, else grazing.
    fn passed(&mut self, found: SeparatingLine, attempt: Attempt) -> Result<Outcome, QueryError> {
        if let Some(certificate) = self.separated(&found) {
            return Ok(Outcome::Separated(self.apart(certificate)));
        }
        let widest = portal::widest_margin(&mut self.context, found);
        if widest.margin < -self.context.difference.touching() {
            return match attempt {
                Attempt::First => self.enclosed_after_all(&widest),
                Attempt::Second => self.again(Stalled::NoPortal),
            };
        }
        if let Some(certificate) = self.separated(&widest) {
            return Ok(Outcome::Separated(self.apart(certificate)));
        }
        self.touching(&widest)
    }

    /// There is an answer, which is only to be written.
    #[inline]
    fn answered(&mut self) {
        self.next.steps = Some(self.context.watch.steps);
        self.context.watch.ended(Phase::Answer);
    }

    #[inline(always)]
    #[expect(clippy::inline_always, reason = "built where it is to stay")]
    fn apart(&mut self, certificate: Separation) -> Separated {
        self.answered();
        Separated { certificate, solver: self.solver, steps: self.context.watch.steps }
    }

    /// The line does not pass `M`: a climb had stuck. Begins again where it should have ended.
    #[cold]
    fn enclosed_after_all(&mut self, refuted: &SeparatingLine) -> Result<Outcome, QueryError> {
        let start =
            FirstNormal { normal: refuted.normal.extend(0.0), near: Some(refuted.point.pair) };
        let enclosure = portal::enclose(&mut self.context, &start);
        self.concluded(enclosure, Attempt::Second)
    }

    /// Feature focus: a portal, or a separating direction, from those of the last answer.
    fn follow(&mut self, last: &WarmStart) -> Option<Enclosure> {
        match last {
            WarmStart::Nothing | WarmStart::Kept { .. } => None,
            WarmStart::Contact(portal) => {
                let followed = portal::follow(&mut self.context, portal);
                self.followed_to(followed)
            }
            WarmStart::Apart { normals, pair } => {
                let [p, q] = self.context.difference.shadow_from_bodies(*normals)?;
                self.beside((p + q).truncate(), [*pair; 2])
            }
        }
    }

    /// A portal, or a separating direction, from scratch or from the region of the last solution.
    fn enclosure(&mut self, region: Region, last: &WarmStart) -> Option<Enclosure> {
        let setting = self.context.difference.setting;
        let solid = setting.moving.dimension() == 3 && setting.fixed.dimension() == 3;
        if self.solver == Solver::Cta && solid {
            return self.narrowed(region, last);
        }
        let facing = portal::facing(&mut self.context);
        let found = self.followed_to(facing);
        if found.is_some() {
            return found;
        }
        self.approach(FirstNormal::new(&self.context.difference))
    }

    /// The same by the collision translation algorithm.
    #[inline(never)]
    fn narrowed(&mut self, region: Region, last: &WarmStart) -> Option<Enclosure> {
        match self.start(region, last) {
            Start::Enclosed(found) => Some(found),
            Start::Normal(start) => self.approach(start),
        }
    }

    /// A portal, or a separating direction, from a guess: face by face if it is not lateral, or by wide
    /// portals.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "passed through memory the guess stalls its reader")]
    fn approach(&mut self, start: FirstNormal) -> Option<Enclosure> {
        self.context.watch.ended(Phase::Setup);
        if self.has_rims() {
            return self.by_outlines(&start);
        }
        let mut nearest = start;
        if start.normal.z > 0.0 {
            let (followed, reached) =
                portal::approach(&mut self.context, &start, &portal::OF_ELLIPSOIDS);
            nearest = reached;
            let found = self.followed_to(followed);
            if found.is_some() {
                return found;
            }
        }
        portal::enclose(&mut self.context, &nearest)
    }

    /// The same of bodies with rims: from where their outlines meet, if they are seen to, whatever the guess says.
    #[inline(never)]
    fn by_outlines(&mut self, start: &FirstNormal) -> Option<Enclosure> {
        let upward;
        let start = if start.normal.z > 0.0 {
            start
        } else {
            upward = match portal::upward(&mut self.context, start) {
                Ok(upward) => upward,
                Err(line) => return Some(Enclosure::Beside(line)),
            };
            &upward
        };
        let by_outlines = portal::between_outlines(&mut self.context, start);
        let (followed, reached) = by_outlines
            .unwrap_or_else(|| portal::approach(&mut self.context, start, &portal::OF_ELLIPSOIDS));
        let found = self.followed_to(followed);
        found.or_else(|| portal::enclose(&mut self.context, &reached))
    }

    /// What became of a portal that was followed.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "passed through memory a portal stalls its reader")]
    fn followed_to(&mut self, followed: Followed) -> Option<Enclosure> {
        match followed {
            Followed::Portal(portal, known) => Some(Enclosure::Portal(portal, known)),
            Followed::Rim { outward, edge } => self.beside(-outward, edge),
            Followed::Lost => None,
        }
    }

    #[inline]
    fn has_rims(&self) -> bool {
        let setting = self.context.difference.setting;
        setting.moving.has_rims() || setting.fixed.has_rims()
    }

    /// Whether all of `M` lies beyond a lateral direction, as an edge of it seems to say.
    fn beside(&mut self, lateral: DVec2, edge: [VertexPair; 2]) -> Option<Enclosure> {
        let [near, other] = edge;
        // Of a length fit to be normalised: shorter ones lose digits.
        if lateral.length_squared() <= f64::MIN_POSITIVE {
            return None;
        }
        let normal = lateral.try_normalize()?;
        let least = -self.context.difference.touching();
        if normal.dot(self.context.difference.vertex(near).shadow()) < least {
            return None;
        }
        let point = self.context.difference.support_from(normal.extend(0.0), near);
        self.context.watch.support(|| Support::of(normal.extend(0.0), &point));
        let margin = normal.dot(point.shadow());
        let end = if point.pair == other { near } else { other };
        let line = SeparatingLine { normal, margin, point, end };
        (margin >= least).then_some(Enclosure::Beside(line))
    }

    /// The first guess of the contact normal, or more than a guess.
    fn start(&mut self, region: Region, last: &WarmStart) -> Start {
        if let Some(focus) = self.region(region, last) {
            self.context.watch.steps.started_from = StartedFrom::Region;
            return self.narrow(Origin::Region(focus));
        }
        match self.narrowing.start {
            cta::options::Start::Center => self.narrow(Origin::Center),
            cta::options::Start::Ellipsoids => self.start_at_ellipsoids(),
        }
    }

    /// Where the ellipsoids meet, their normal is the start of portal refinement: a planar problem
    /// costs more than it saves there (measured). Where they pass each other and the bodies are
    /// not seen to do so, it is solved.
    fn start_at_ellipsoids(&mut self) -> Start {
        let ellipsoids = FirstNormal::from_ellipsoids(&self.context.difference);
        let normal = ellipsoids.normal;
        if normal.z > 0.0 {
            return Start::Normal(ellipsoids);
        }
        let support = self.context.difference.support(normal);
        self.context.watch.support(|| Support::of(normal, &support));
        if normal.dot(support.at) > 0.0 {
            return Start::Normal(FirstNormal::guided(normal, support.pair));
        }
        self.narrow(Origin::Center)
    }

    /// By the collision translation algorithm.
    fn narrow(&mut self, origin: Origin) -> Start {
        self.context.watch.ended(Phase::Setup);
        let cta::options::Options { until, keeps_to_cell, cuts, starts_cold, .. } = self.narrowing;
        let gap = until.gap();
        let options = CtaOptions { start: origin, gap, keeps_to_cell, cuts, starts_cold };
        let narrowed =
            cta::minimise(self.context.difference.setting, &options, &mut self.context.watch);
        let corners = narrowed.corners.as_ref();
        if let Some(portal) = corners.and_then(|c| portal::around(&self.context.difference, c)) {
            return Start::Enclosed(Enclosure::Portal(portal, Known::Around));
        }
        let [moving, fixed] = narrowed.vertices;
        let near = VertexPair::of(moving[0], fixed[0]);
        let in_shadow = |normal| self.context.difference.setting_from_shadow.transpose() * normal;
        Start::Normal(match narrowed.guess {
            Guess::Contact { normal } => FirstNormal::guided(in_shadow(normal), near),
            Guess::Separation { direction } => {
                FirstNormal::guided(in_shadow(direction).with_z(0.0), near)
            }
            Guess::Nothing => FirstNormal::from_ellipsoids(&self.context.difference),
        })
    }

    /// Region focus: the last contact points, and the half-side of the square around them.
    fn region(&self, region: Region, last: &WarmStart) -> Option<RegionFocus> {
        let setting = self.context.difference.setting;
        let (touching, normals, pair) = match last {
            WarmStart::Nothing | WarmStart::Kept { .. } => return None,
            WarmStart::Contact(portal) => {
                let touching = setting.weighted(&portal.pairs, &portal.weights);
                (touching, portal.normals, portal.pairs[0])
            }
            WarmStart::Apart { pair, normals } => (setting.vertices(*pair), *normals, *pair),
        };
        let half_side = match region {
            Region::Everywhere => return None,
            Region::Fixed(delta) => delta,
            Region::Automatic => {
                self.context.difference.shadow_from_bodies(normals)?;
                setting.lateral_displacement(touching)
            }
        };
        let worth = region != Region::Automatic || self.context.difference.is_near(half_side);
        worth.then_some(RegionFocus { touching, half_side, pair, normal: normals[0] })
    }

    fn contact_or_grazing(
        &mut self,
        portal: &mut Portal,
        known: Known,
        attempt: Attempt,
    ) -> Result<Outcome, QueryError> {
        let Face { plane, weights } = if let Some(face) = self.known_face(portal, known) {
            face
        } else {
            match self.refine(portal) {
                Some(Refined::Lowest(face)) => face,
                Some(Refined::Rim(rim)) => return self.passed(rim, attempt),
                None => return self.again(Stalled::Cycle),
            }
        };
        let tolerance = self.graze_tolerance.max(self.context.difference.touching());
        let overlap = portal::overlap(&mut self.context, portal, tolerance);
        self.context.watch.ended(Phase::Finish);
        let proven = match Proven::new(&self.context.difference, portal, &plane, weights) {
            Ok(proven) => proven,
            Err(reason) => return self.again(reason),
        };
        self.next.start = WarmStart::Contact(proven.contact_portal());
        self.answered();
        match overlap {
            Overlap::Ample => {
                Ok(Outcome::Contact(proven.contact(self.solver, self.context.watch.steps)))
            }
            Overlap::Slight { inward, depth, .. } => {
                let contact = proven.contact(self.solver, self.context.watch.steps);
                let grazing = proof::grazing(&self.context.difference, inward, depth, contact);
                Ok(Outcome::Grazing(grazing))
            }
        }
    }

    /// The lowest face, if the start has found it, or it is the portal's own.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "passed through memory it stalls its reader")]
    fn known_face(&mut self, portal: &Portal, known: Known) -> Option<Face> {
        match known {
            Known::Lowest(face) => Some(face),
            Known::FaceByFace => portal::face(&mut self.context, portal),
            Known::Around => None,
        }
    }

    /// The lowest face, and its portal in place of the one that leads there.
    #[inline(never)]
    fn refine(&mut self, portal: &mut Portal) -> Option<Refined> {
        let most = match self.context.watch.steps.started_from {
            StartedFrom::Features => MOST_AFTER_FOLLOWING,
            _ => portal::MAX_PORTALS,
        };
        portal::refine(&mut self.context, portal, most)
    }

    /// The shadow of `M` ends at the line, or misses it by less than rounding can tell: the contact
    /// of the bodies widened sideways by a little more than that.
    #[cold]
    fn touching(&mut self, rim: &SeparatingLine) -> Result<Outcome, QueryError> {
        self.context.difference = self.context.difference.widened_by(rim.margin);
        let (portal, Face { plane, weights }) = match self.widened_face() {
            Ok(found) => found,
            Err(reason) => return self.again(reason),
        };
        let proven = match Proven::new(&self.context.difference, &portal, &plane, weights) {
            Ok(proven) => proven,
            Err(reason) => return self.again(reason),
        };
        let plane = Plane::of(&self.context.difference, rim.normal.extend(0.0), rim.point.pair);
        self.next.start = proof::separation(&self.context.difference, &plane, rim.margin).1;
        self.answered();
        let contact = proven.contact(self.solver, self.context.watch.steps);
        let grazing = proof::grazing(&self.context.difference, rim.normal, -rim.margin, contact);
        Ok(Outcome::Grazing(grazing))
    }

    /// The lowest face of the widened bodies on the line.
    fn widened_face(&mut self) -> Result<(Portal, Face), Stalled> {
        if let Followed::Portal(portal, Known::Lowest(face)) = portal::facing(&mut self.context) {
            return Ok((portal, face));
        }
        let start = FirstNormal::from_ellipsoids(&self.context.difference);
        let Some(Enclosure::Portal(mut portal, _)) = portal::enclose(&mut self.context, &start)
        else {
            return Err(Stalled::NoPortal);
        };
        match portal::refine(&mut self.context, &mut portal, portal::MAX_PORTALS) {
            Some(Refined::Lowest(face)) => Ok((portal, face)),
            _ => Err(Stalled::Cycle),
        }
    }

    /// The separation that a line proves; `None` if rounding may have made it.
    #[inline]
    fn separated(&mut self, found: &SeparatingLine) -> Option<Separation> {
        if found.margin <= self.context.difference.noise.lowered() {
            return None;
        }
        let plane = Plane::of(&self.context.difference, found.normal.extend(0.0), found.point.pair);
        let settled = found.normal.dot(self.context.difference.vertex(plane.lowest).shadow());
        self.separated_by(&plane, found.margin.min(settled))
    }

    /// The separation that a plane parallel to the direction proves.
    #[inline]
    fn separated_by(&mut self, plane: &Plane, margin: f64) -> Option<Separation> {
        let (certificate, start) = proof::separation(&self.context.difference, plane, margin);
        if certificate.margin <= 0.0 || !self.others_agree(&certificate) {
            return None;
        }
        self.next.start = start;
        Some(certificate)
    }

    /// The separation that the plane between the bodies of the last answer proves, turned with them,
    /// if its pair is still the nearest.
    #[inline]
    fn still_apart(&mut self, last: &WarmStart) -> Option<Separation> {
        let WarmStart::Apart { normals, pair } = last else { return None };
        let [p, q] = self.context.difference.shadow_from_bodies(*normals)?;
        let lateral = (p + q).truncate();
        // Of a length fit to be squared.
        if lateral.length_squared() <= f64::MIN_POSITIVE {
            return None;
        }
        let normal = lateral.extend(0.0);
        let plane = Plane::at(&self.context.difference, normal, *pair)?;
        let point = self.context.difference.vertex(plane.lowest);
        self.context.watch.support(|| Support::of(normal, &point));
        self.context.watch.steps.started_from = StartedFrom::Features;
        let found = self.separated_by(&plane, normal.dot(point.at) / lateral.length());
        if found.is_none() {
            self.context.watch.steps.started_from = StartedFrom::Scratch;
        }
        found
    }

    /// Whether who checks a separation will find it proven, too.
    ///
    /// They round in their own way and may find other support points: together that takes less than
    /// twice what counts as touching from a margin. A smaller one is checked here, as they will.
    #[inline]
    fn others_agree(&self, certificate: &Separation) -> bool {
        certificate.margin > 2.0 * self.context.difference.noise.touching()
            || certificate.verify_with_gap(self.context.difference.setting, 0.0).is_ok()
    }
}
