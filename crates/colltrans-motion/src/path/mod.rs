//! Paths of joints: when do two bodies that a mechanism carries first touch, each other or what stands around?
//!
//! A [`Mechanism`] is frames in frames, each moved by a joint; a [`JointPath`] has rows of joint values, and each
//! joint goes evenly from row to row. A [`PathCast`] answers which two of its bodies first meet, with bounds on the
//! time that are bounds, or proves that none do on the whole path.
//!
//! ```
//! use colltrans::glam::DVec3;
//! use colltrans::motion::path::{Frame, Joint, JointPath, Mechanism, PathBody, PathCast, PathOutcome};
//! use colltrans::{ConvexPolyhedron, Pose};
//!
//! // An arm of two links in a plane, each of length 1: both joints turn about z.
//! let link = ConvexPolyhedron::cuboid(DVec3::new(0.1, -0.05, -0.05), DVec3::new(1.0, 0.05, 0.05))?;
//! let joint = Joint::Turning(DVec3::Z);
//! let elbow = Pose::from_translation(DVec3::X)?;
//! let arm = Mechanism::new(vec![
//!     Frame { parent: None, origin: Pose::IDENTITY, joint },
//!     Frame { parent: Some(0), origin: elbow, joint },
//! ])?;
//! // A thin wall stands in its way; the rows are far apart.
//! let wall = ConvexPolyhedron::cuboid(DVec3::new(-9.0, 1.5, -9.0), DVec3::new(9.0, 1.5001, 9.0))?;
//! let path = JointPath::evenly(vec![vec![0.0, 0.0], vec![std::f64::consts::PI, 0.0]])?;
//! let bodies = vec![
//!     PathBody::carried(0, link.at(Pose::IDENTITY)),
//!     PathBody::carried(1, link.at(Pose::IDENTITY)),
//!     PathBody::standing(wall.at(Pose::IDENTITY)),
//! ];
//! let cast = PathCast::new(&arm, &path, bodies, vec![[0, 2], [1, 2]])?;
//! let PathOutcome::Contact(contact) = cast.first_contact()? else { panic!("no contact") };
//! // The corner (2, 1/20) is at the height 2 sin a + cos a / 20 = 3/2.
//! let angle = (1.5 / 4.0025_f64.sqrt()).asin() - (0.05_f64 / 2.0).atan();
//! let time = angle / std::f64::consts::PI;
//! assert_eq!(contact.pair, [1, 2]);
//! assert!(contact.lower <= time && time <= contact.upper && contact.upper - contact.lower < 1e-11);
//! assert_eq!(cast.verify(&contact.proof)?, [contact.lower, contact.upper]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # What is promised
//!
//! As of other motions: answers hold of the path as the real function of its numbers, not of places computed from it.
//! Before `lower` no two bodies of a pair meet, and at `upper` two do. Two frames of one mechanism are looked at from
//! the frame that both stand in: only the joints between them count.
//!
//! # Method
//!
//! Planes between the bodies, as of other motions, and two ways to prove the time between two of them: from row to
//! row by how far supporting planes may bend, which a chain of joints bounds; over many rows by how far the
//! bodies move. Bodies that are not convex are taken apart into boxes and facets, where they come near. That closed
//! bodies do not begin one inside the other is decided exactly; later their surfaces would have met.
//!
//! The modules, each using only those before it: `mechanism`, `chain`, `shape`, `couple`, `proof`, `answer`, `follow`,
//! `search`, `verify`.

mod answer;
mod chain;
mod couple;
mod follow;
mod mechanism;
mod proof;
mod search;
mod shape;
mod verify;

use std::collections::HashSet;

use colltrans_convex::body::{Placed, Pose};
use colltrans_convex::pair::Pair;
use colltrans_convex::setting::check_min_gap;
use colltrans_convex::setting::error::QueryError;
use colltrans_kernel::range::MAX_MAGNITUDE;
use colltrans_solid::Solid;
use colltrans_solid::kinds::{AnyPlaced, ByKind};
use colltrans_solid::{AsSolid, SolidPairSearch};

pub use self::answer::{PathContact, PathOutcome};
use self::chain::Chain;
use self::couple::Couple;
pub use self::mechanism::{Frame, Joint, JointPath, Mechanism, PathError, Place};
pub use self::proof::{Cover, How, PathMeeting, PathProof, Step, Stretch};
use self::search::{Search, Stop};
use self::shape::Shape;
pub use self::verify::PathProofError;
use super::answer::{MotionFree, MotionSteps};
use super::course::Course;

/// A body that a mechanism carries, or that stands in the world.
#[derive(Debug, Clone, Copy)]
pub struct PathBody<'a> {
    /// The frame that carries it; none is the world.
    pub frame: Option<usize>,
    /// The body, and where it is in that frame.
    pub placed: AnyPlaced<'a>,
}

impl<'a> PathBody<'a> {
    /// Carried by a frame, in which it has a pose.
    pub fn carried(frame: usize, placed: impl Into<AnyPlaced<'a>>) -> Self {
        Self { frame: Some(frame), placed: placed.into() }
    }

    /// In the world.
    pub fn standing(placed: impl Into<AnyPlaced<'a>>) -> Self {
        Self { frame: None, placed: placed.into() }
    }
}

/// Bodies of a mechanism on a path, and which pairs of them are not to meet.
#[derive(Debug)]
pub struct PathCast<'a> {
    mechanism: &'a Mechanism,
    path: &'a JointPath,
    frames: Vec<Option<usize>>,
    shapes: Vec<Shape<'a>>,
    pairs: Vec<[usize; 2]>,
    keep: f64,
}

impl<'a> PathCast<'a> {
    /// Of bodies, and pairs of their numbers.
    ///
    /// # Errors
    /// Rows that are not of the mechanism's joints; a frame or a body that does not exist; a place out of range; a
    /// point or a segment where a solid may enclose it.
    pub fn new(
        mechanism: &'a Mechanism,
        path: &'a JointPath,
        bodies: Vec<PathBody<'a>>,
        pairs: Vec<[usize; 2]>,
    ) -> Result<Self, PathError> {
        path.check(mechanism)?;
        for (body, PathBody { frame, .. }) in bodies.iter().enumerate() {
            if let Some(frame) = frame.filter(|frame| *frame >= mechanism.frames().len()) {
                return Err(PathError::Frame { body, frame });
            }
        }
        let count = bodies.len();
        if let Some(pair) = pairs.iter().find(|[a, b]| a == b || *a >= count || *b >= count) {
            return Err(PathError::Pair { pair: *pair });
        }
        let frames = bodies.iter().map(|body| body.frame).collect();
        let shapes = bodies.into_iter().map(|body| Shape::new(body.placed)).collect();
        let cast = Self { mechanism, path, frames, shapes, pairs, keep: 0.0 };
        for body in 0..count {
            let chain = cast.chain(body, &mechanism.above(cast.frames[body]));
            if chain.size.is_nan() || chain.size > MAX_MAGNITUDE {
                return Err(PathError::Far { body });
            }
        }
        for (k, pair) in cast.pairs.iter().enumerate() {
            if let Err(reason) = nested(&cast, k) {
                return Err(PathError::Query { pair: *pair, reason: reason.into() });
            }
        }
        Ok(cast)
    }

    /// The same with a gap to be kept, in world units: what counts is when two bodies are no farther apart.
    ///
    /// # Errors
    /// A gap that is negative, not finite or out of range.
    pub fn keeping(self, gap: f64) -> Result<Self, PathError> {
        check_min_gap(gap).map_err(|_| PathError::Keep { gap })?;
        Ok(Self { keep: gap, ..self })
    }

    /// The pairs that are asked about.
    pub fn pairs(&self) -> &[[usize; 2]] {
        &self.pairs
    }

    /// Two bodies each that are not asked about, though joints may move one against the other: nothing is said of them.
    pub fn left_out(&self) -> Vec<[usize; 2]> {
        let moved_by = |frame: &Option<usize>| {
            let mut above = self.mechanism.above(*frame);
            above.retain(|k| self.mechanism.frames()[*k].joint != Joint::Fixed);
            above
        };
        let moved_by: Vec<Vec<usize>> = self.frames.iter().map(moved_by).collect();
        let asked: HashSet<[usize; 2]> =
            self.pairs.iter().flat_map(|&[i, j]| [[i, j], [j, i]]).collect();
        let pairs = (0..self.frames.len()).flat_map(|j| (0..j).map(move |i| [i, j]));
        pairs
            .filter(|pair| moved_by[pair[0]] != moved_by[pair[1]] && !asked.contains(pair))
            .collect()
    }

    /// The gap to be kept, 0 for none.
    pub const fn keep(&self) -> f64 {
        self.keep
    }

    /// The bodies, where they are in the frames that carry them.
    pub fn bodies(&self) -> impl Iterator<Item = AnyPlaced<'a>> {
        self.shapes.iter().map(|shape| shape.placed)
    }

    /// The bodies, with the frames that carry them.
    pub fn carried_bodies(&self) -> impl Iterator<Item = PathBody<'a>> {
        let of = |(shape, frame): (&Shape<'a>, &Option<usize>)| PathBody {
            frame: *frame,
            placed: shape.placed,
        };
        self.shapes.iter().zip(&self.frames).map(of)
    }

    /// The frames that carry them.
    pub const fn mechanism(&self) -> &'a Mechanism {
        self.mechanism
    }

    /// What the joints do.
    pub const fn path(&self) -> &'a JointPath {
        self.path
    }

    /// Where a body is in the world, to rounding.
    pub fn pose(&self, body: usize, place: Place) -> Pose {
        let chain = self.chain(body, &self.mechanism.above(self.frames[body]));
        chain.at(self.path, place.row, place.share).0
    }

    /// Which two bodies of a pair first meet, and when?
    ///
    /// If the search between two bodies takes its maximum number of steps, those of them that are convex are taken as
    /// solids, and the question is asked again. If that has no answer for the pair either, the others are still asked,
    /// and the answer is [`PathOutcome::Undecided`] unless another pair meets before.
    ///
    /// # Errors
    /// A body that is no solid where a solid may enclose it.
    pub fn first_contact(&self) -> Result<PathOutcome, PathError> {
        let (mut solids, mut before) = (Vec::new(), MotionSteps::default());
        let mut with_solids: Option<Self> = None;
        loop {
            let cast = with_solids.as_ref().unwrap_or(self);
            let Searched { mut outcome, stalled } = cast.searched()?;
            let more: Vec<usize> = stalled.into_iter().filter(|k| cast.can_be_solid(*k)).collect();
            if more.is_empty() {
                let (proof, steps) = outcome.parts_mut();
                proof.solids = solids;
                *steps += before;
                return Ok(outcome);
            }
            before += outcome.steps();
            solids.extend(more);
            solids.sort_unstable();
            solids.dedup();
            with_solids = Some(self.with_solids(&solids));
        }
    }

    /// All pairs of bodies that overlap where the path begins, or are no farther apart than the gap to be kept.
    ///
    /// # Errors
    /// A body that is no solid where a solid may enclose it.
    pub fn start_overlaps(&self) -> Result<Vec<[usize; 2]>, PathError> {
        let mut found = Vec::new();
        for (k, pair) in self.pairs.iter().enumerate() {
            let query =
                |reason: QueryError| PathError::Query { pair: *pair, reason: reason.into() };
            let couple = self.couple(k);
            let mut search = Search::new(&couple, self.shapes_of(k), Place::START);
            search.cover([0, 0], Place::START, Place::START);
            let meets = matches!(search.stop, Some((_, Stop::Met(..))));
            if meets || nested(self, k).map_err(query)? {
                found.push(*pair);
            }
        }
        Ok(found)
    }

    /// Returns the same question with these convex bodies taken as solids. Pieces of shapes that this cast has made are
    /// made anew.
    #[doc(hidden)]
    #[must_use]
    pub fn with_solids(&self, solids: &[usize]) -> Self {
        let shape = |(k, shape): (usize, &Shape<'a>)| {
            let placed = shape.placed;
            Shape::new(if solids.contains(&k) {
                as_solid(placed).unwrap_or(placed)
            } else {
                placed
            })
        };
        Self {
            shapes: self.shapes.iter().enumerate().map(shape).collect(),
            frames: self.frames.clone(),
            pairs: self.pairs.clone(),
            ..*self
        }
    }

    /// Checks whether a body is convex and has a surface.
    fn can_be_solid(&self, body: usize) -> bool {
        let placed = self.shapes[body].placed;
        matches!(placed, ByKind::Convex(_)) && as_solid(placed).is_some()
    }

    fn searched(&self) -> Result<Searched, PathError> {
        let (mut proof, mut steps) = (PathProof::default(), MotionSteps::default());
        let mut until = Place::at_row(self.path.last());
        let mut reached = until;
        let mut stopped: Option<(usize, Stop)> = None;
        // Pairs whose search took its maximum number of steps, and up to where each is apart.
        let mut open: Vec<(usize, Place)> = Vec::new();
        for (k, pair) in self.pairs.iter().enumerate() {
            let couple = self.couple(k);
            let query =
                |reason: QueryError| PathError::Query { pair: *pair, reason: reason.into() };
            if nested(self, k).map_err(query)? {
                let meeting = PathMeeting { pair: k, place: Place::START, how: How::Inside };
                let outcome = self.overlapping(meeting, proof, steps);
                return Ok(Searched { outcome, stalled: Vec::new() });
            }
            let mut search = Search::new(&couple, self.shapes_of(k), until);
            proof.covers.push(search.cover([0, 0], Place::START, until));
            let is_open = matches!(search.stop, Some((_, Stop::Stalled)));
            if is_open {
                open.push((k, search.reached));
            } else if search.stop.is_some() {
                reached = reached.min_of(search.reached);
            }
            let found = search.confirmed();
            steps += search.looker.steps;
            if let Some((place, stop)) = found.filter(|_| !is_open) {
                until = place;
                if stopped.as_ref().is_none_or(|(_, before)| stop.tells_more(before)) {
                    stopped = Some((k, stop));
                }
            }
        }
        // What is open later than two bodies meet does not matter.
        open.retain(|(_, place)| stopped.is_none() || *place < reached);
        let stalled = open.iter().flat_map(|(k, _)| self.pairs[*k]).collect();
        let first = open.into_iter().reduce(|a, b| if b.1 < a.1 { b } else { a });
        let outcome = match first {
            None => self.outcome(stopped, reached, proof, steps),
            Some((pair, place)) => self.undecided(pair, place, stopped, proof, steps),
        };
        Ok(Searched { outcome, stalled })
    }

    /// Checks a proof without a search: all vertices are looked at. Returns up to which time no two bodies are proven
    /// to meet, and when two are proven to, infinity if that is not claimed.
    ///
    /// # Errors
    /// What is not proven.
    pub fn verify(&self, proof: &PathProof) -> Result<[f64; 2], PathProofError> {
        let is_body = |k: &usize| *k < self.shapes.len();
        if !proof.solids.iter().all(is_body) {
            return Err(PathProofError::Solids);
        }
        if proof.solids.is_empty() {
            return verify::verify(self, proof);
        }
        verify::verify(&self.with_solids(&proof.solids), proof)
    }

    fn chain(&self, body: usize, frames: &[usize]) -> Chain {
        let shape = &self.shapes[body];
        Chain::new(self.mechanism, frames, self.path, shape.pose(), shape.corners())
    }

    /// The frames that both bodies of a pair stand in, and those that each does beyond.
    fn beyond(&self, pair: usize) -> (Vec<usize>, [Vec<usize>; 2]) {
        let above = self.pairs[pair].map(|body| self.mechanism.above(self.frames[body]));
        let shared = above[0].iter().zip(&above[1]).take_while(|(a, b)| a == b).count();
        let rest = above.each_ref().map(|frames| frames[shared..].to_vec());
        (above[0][..shared].to_vec(), rest)
    }

    fn couple(&self, pair: usize) -> Couple<'_> {
        let (_, frames) = self.beyond(pair);
        let chains = [0, 1].map(|k| self.chain(self.pairs[pair][k], &frames[k]));
        Couple::new(self.path, chains, self.keep)
    }

    fn shapes_of(&self, pair: usize) -> [&Shape<'_>; 2] {
        self.pairs[pair].map(|body| &self.shapes[body])
    }

    /// What is to be said of the first stop.
    fn outcome(
        &self,
        stopped: Option<(usize, Stop)>,
        reached: Place,
        mut proof: PathProof,
        steps: MotionSteps,
    ) -> PathOutcome {
        match stopped {
            None => PathOutcome::Free(MotionFree { proof, steps }),
            Some((pair, Stop::Met(place, how))) => {
                let meeting = PathMeeting { pair, place, how };
                if place == Place::START {
                    return self.overlapping(meeting, proof, steps);
                }
                proof.meeting = Some(meeting);
                let upper = self.path.time(place)[1];
                PathOutcome::Contact(self.contact(pair, reached, upper, proof, steps))
            }
            Some((pair, _)) => {
                PathOutcome::Grazing(self.contact(pair, reached, f64::INFINITY, proof, steps))
            }
        }
    }

    /// What is reported of a pair that is open from a place on; two other bodies may meet later.
    fn undecided(
        &self,
        pair: usize,
        place: Place,
        stopped: Option<(usize, Stop)>,
        mut proof: PathProof,
        steps: MotionSteps,
    ) -> PathOutcome {
        let mut upper = f64::INFINITY;
        if let Some((pair, Stop::Met(place, how))) = stopped {
            upper = self.path.time(place)[1];
            proof.meeting = Some(PathMeeting { pair, place, how });
        }
        PathOutcome::Undecided(self.contact(pair, place, upper, proof, steps))
    }

    /// Where the path begins with two bodies that overlap: nothing is said of the others.
    fn overlapping(
        &self,
        meeting: PathMeeting,
        mut proof: PathProof,
        steps: MotionSteps,
    ) -> PathOutcome {
        let pair = meeting.pair;
        proof.covers = vec![Cover::default(); self.pairs.len()];
        proof.meeting = Some(meeting);
        let upper = self.path.ends()[0];
        PathOutcome::Overlapping(self.contact(pair, Place::START, upper, proof, steps))
    }

    fn contact(
        &self,
        pair: usize,
        place: Place,
        upper: f64,
        proof: PathProof,
        steps: MotionSteps,
    ) -> PathContact {
        let (shared, _) = self.beyond(pair);
        let bodies = self.pairs[pair];
        let chain = Chain::new(self.mechanism, &shared, self.path, Pose::IDENTITY, &[]);
        let (world, _) = chain.at(self.path, place.row, place.share);
        let meeting = proof.meeting.as_ref().filter(|meeting| meeting.pair == pair);
        let near = self.near(pair, place, meeting);
        let lower = self.path.time(place)[0];
        let poses = bodies.map(|body| self.pose(body, place));
        let points = near.map(|near| near.0.map(|point| world.transform_point(point)));
        let normal = near.and_then(|near| near.1).map(|normal| world.transform_vector(normal));
        let features = near.and_then(|near| near.2);
        PathContact {
            lower,
            upper,
            place,
            pair: bodies,
            poses,
            points,
            normal,
            features,
            proof,
            steps,
        }
    }

    /// The points of a pair that are nearest to each other at a place, in the frame that both share.
    fn near(&self, pair: usize, place: Place, meeting: Option<&PathMeeting>) -> Option<Near> {
        let couple = self.couple(pair);
        let shapes = self.shapes_of(pair);
        let pieces = match meeting.map(|meeting| &meeting.how) {
            Some(How::Pieces { pieces, .. } | How::Point { pieces, .. }) => *pieces,
            _ if shapes.iter().all(|shape| shape.count() == 1) => [0, 0],
            _ => return None,
        };
        let bodies = [shapes[0].piece(pieces[0]), shapes[1].piece(pieces[1])];
        let course = couple.course(bodies, place.row, [place.share; 2]);
        let near = Pair { bodies: course.instant(place.share).bodies }.distance().ok()?;
        let convex = shapes.iter().all(|shape| shape.count() == 1);
        let features = near.features.filter(|_| convex);
        Some(([near.on_moving, near.on_fixed], near.normal, features))
    }
}

/// What a search over all pairs has found.
struct Searched {
    outcome: PathOutcome,
    /// The bodies of pairs whose search took its maximum number of steps.
    stalled: Vec<usize>,
}

/// A convex body as a solid; `None` for a point or a segment.
fn as_solid(placed: AnyPlaced<'_>) -> Option<AnyPlaced<'_>> {
    match placed {
        ByKind::Convex(Placed { body, pose }) => {
            Some(AsSolid::as_solid(body).ok()?.at(pose).into())
        }
        ByKind::Solid(_) => Some(placed),
    }
}

/// Points, normal and features.
type Near = ([glam::DVec3; 2], Option<glam::DVec3>, Option<colltrans_convex::body::Features>);

/// Whether one body of a pair is inside the other one where the path begins, or a part of it is; of bodies whose
/// surfaces are apart.
fn nested(cast: &PathCast, pair: usize) -> Result<bool, QueryError> {
    let shapes = cast.shapes_of(pair);
    if shapes.iter().all(|shape| matches!(shape.placed, ByKind::Convex(_))) {
        return Ok(false);
    }
    let couple = cast.couple(pair);
    let placed = |k: usize| -> Result<Placed<'_, Solid>, QueryError> {
        let (pose, _) = couple.chains[k].at(cast.path, 0, 0.0);
        Ok(match shapes[k].placed {
            ByKind::Convex(placed) => AsSolid::as_solid(placed.body)?.at(pose),
            ByKind::Solid(placed) => placed.body.at(pose),
        })
    };
    Pair::new(placed(0)?, placed(1)?)?.is_nested()
}
