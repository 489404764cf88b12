//! Paths of joints: the time at which two bodies of a mechanism first touch each other or a body of the scene.
//!
//! A [`Mechanism`] is a tree of frames, each moved by a joint. A [`JointPath`] has rows of joint values; between rows
//! each joint moves at a constant rate. A [`PathCast`] computes which two bodies first meet, with proven bounds of the
//! time, or proves that no two bodies meet on the whole path.
//!
//! ```
//! use colltrans::glam::DVec3;
//! use colltrans::motion::path::{Frame, Joint, JointPath, Mechanism, PathBody, PathCast, PathOutcome};
//! use colltrans::{ConvexPolyhedron, Pose};
//!
//! // A planar arm of two links of length 1; both joints rotate about z.
//! let link = ConvexPolyhedron::cuboid(DVec3::new(0.1, -0.05, -0.05), DVec3::new(1.0, 0.05, 0.05))?;
//! let joint = Joint::Turning(DVec3::Z);
//! let elbow = Pose::from_translation(DVec3::X)?;
//! let arm = Mechanism::new(vec![
//!     Frame { parent: None, origin: Pose::IDENTITY, joint },
//!     Frame { parent: Some(0), origin: elbow, joint },
//! ])?;
//! // A thin wall is in its way; the rows are far apart.
//! let wall = ConvexPolyhedron::cuboid(DVec3::new(-9.0, 1.5, -9.0), DVec3::new(9.0, 1.5001, 9.0))?;
//! let path = JointPath::at_unit_times(vec![vec![0.0, 0.0], vec![std::f64::consts::PI, 0.0]])?;
//! let bodies = vec![
//!     PathBody::carried_by(0, link.at(Pose::IDENTITY)),
//!     PathBody::carried_by(1, link.at(Pose::IDENTITY)),
//!     PathBody::at_rest(wall.at(Pose::IDENTITY)),
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
//! # Guarantee
//!
//! Answers hold for the path as the real function of its numbers, not for computed poses. No two bodies of a pair meet
//! before `lower`, and two bodies meet at `upper`. Two frames of one mechanism are compared in the last frame that
//! contains both, so only the joints between them matter.
//!
//! # Method
//!
//! Planes separate the bodies, as for other motions. Two bounds prove the time between two planes: from row to row a
//! curvature bound of a chain of joints, and over many rows the distance that the bodies move. Bodies that are not
//! convex are split into boxes and facets where they come near. Whether one closed body contains another at the start
//! is decided exactly; later their surfaces would meet first.
//!
//! The modules, each using only those before it: `mechanism`, `chain`, `shape`, `link_pair`, `proof`, `answer`,
//! `follow`, `search`, `verify`.

mod answer;
mod chain;
mod follow;
mod link_pair;
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
use self::link_pair::LinkPair;
pub use self::mechanism::{Frame, Joint, JointPath, Mechanism, PathError, PathPlace};
pub use self::proof::{
    CoverStep, PathContactProof, PathCover, PathProof, PathProvenContact, PlaneStretch,
};
use self::search::{PathSearch, Stop};
use self::shape::Shape;
pub use self::verify::PathProofError;
use super::answer::{MotionFree, MotionSteps};
use super::relative_motion::RelativeMotion;

/// A body that a mechanism carries, or that rests in the world.
#[derive(Debug, Clone, Copy)]
pub struct PathBody<'a> {
    /// Number of the frame that carries the body; `None` for the world.
    pub frame: Option<usize>,
    /// The body and its pose in that frame.
    pub placed: AnyPlaced<'a>,
}

impl<'a> PathBody<'a> {
    /// Returns a body carried by a frame, with its pose in the frame.
    pub fn carried_by(frame: usize, placed: impl Into<AnyPlaced<'a>>) -> Self {
        Self { frame: Some(frame), placed: placed.into() }
    }

    /// Returns a body that rests in the world.
    pub fn at_rest(placed: impl Into<AnyPlaced<'a>>) -> Self {
        Self { frame: None, placed: placed.into() }
    }
}

/// Bodies of a mechanism on a path, and the pairs of them that must not meet.
#[derive(Debug)]
pub struct PathCast<'a> {
    mechanism: &'a Mechanism,
    path: &'a JointPath,
    frames: Vec<Option<usize>>,
    shapes: Vec<Shape<'a>>,
    pairs: Vec<[usize; 2]>,
    min_gap: f64,
}

impl<'a> PathCast<'a> {
    /// Builds the cast of bodies, with pairs of their numbers.
    ///
    /// # Errors
    /// Returns an error if
    /// - a row does not have one value in range for each joint,
    /// - a body refers to a frame that does not exist,
    /// - a pair does not refer to two different bodies that exist,
    /// - a body can move out of the accepted range,
    /// - a body of a pair with a solid is a point or a segment.
    pub fn new(
        mechanism: &'a Mechanism,
        path: &'a JointPath,
        bodies: Vec<PathBody<'a>>,
        pairs: Vec<[usize; 2]>,
    ) -> Result<Self, PathError> {
        path.check_rows(mechanism)?;
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
        let cast = Self { mechanism, path, frames, shapes, pairs, min_gap: 0.0 };
        for body in 0..count {
            let chain = cast.body_chain(body, &mechanism.frames_above(cast.frames[body]));
            if chain.size.is_nan() || chain.size > MAX_MAGNITUDE {
                return Err(PathError::OutOfRange { body });
            }
        }
        for (k, pair) in cast.pairs.iter().enumerate() {
            if let Err(reason) = is_nested_at_start(&cast, k) {
                return Err(PathError::Query { pair: *pair, reason: reason.into() });
            }
        }
        Ok(cast)
    }

    /// Returns the cast with a minimum gap, in world units. The query then finds when the distance of two bodies falls
    /// to the gap.
    ///
    /// # Errors
    /// Returns [`PathError::MinGap`] if the gap is negative, not finite or out of range.
    pub fn with_min_gap(self, gap: f64) -> Result<Self, PathError> {
        check_min_gap(gap).map_err(|_| PathError::MinGap { gap })?;
        Ok(Self { min_gap: gap, ..self })
    }

    /// Returns the pairs of the query.
    pub fn pairs(&self) -> &[[usize; 2]] {
        &self.pairs
    }

    /// Returns all pairs of bodies that joints move relative to each other and that are not part of the query. No
    /// answer covers them. Takes time quadratic in the number of bodies.
    pub fn unqueried_pairs(&self) -> Vec<[usize; 2]> {
        let moved_by = |frame: &Option<usize>| {
            let mut above = self.mechanism.frames_above(*frame);
            above.retain(|k| self.mechanism.frames()[*k].joint != Joint::Fixed);
            above
        };
        let moved_by: Vec<Vec<usize>> = self.frames.iter().map(moved_by).collect();
        let queried: HashSet<[usize; 2]> =
            self.pairs.iter().flat_map(|&[i, j]| [[i, j], [j, i]]).collect();
        let pairs = (0..self.frames.len()).flat_map(|j| (0..j).map(move |i| [i, j]));
        pairs
            .filter(|pair| moved_by[pair[0]] != moved_by[pair[1]] && !queried.contains(pair))
            .collect()
    }

    /// Returns the minimum gap, in world units; 0 if none was set.
    pub const fn min_gap(&self) -> f64 {
        self.min_gap
    }

    /// Returns the bodies, with their poses in the frames that carry them.
    pub fn bodies(&self) -> impl Iterator<Item = AnyPlaced<'a>> {
        self.shapes.iter().map(|shape| shape.placed)
    }

    /// Returns the bodies with the frames that carry them.
    pub fn bodies_with_frames(&self) -> impl Iterator<Item = PathBody<'a>> {
        let of = |(shape, frame): (&Shape<'a>, &Option<usize>)| PathBody {
            frame: *frame,
            placed: shape.placed,
        };
        self.shapes.iter().zip(&self.frames).map(of)
    }

    /// Returns the mechanism that carries the bodies.
    pub const fn mechanism(&self) -> &'a Mechanism {
        self.mechanism
    }

    /// Returns the path of the joints.
    pub const fn path(&self) -> &'a JointPath {
        self.path
    }

    /// Returns the pose of a body in the world, rounded.
    pub fn world_pose(&self, body: usize, place: PathPlace) -> Pose {
        let chain = self.body_chain(body, &self.mechanism.frames_above(self.frames[body]));
        chain.pose_and_rates(self.path, place.row, place.share).0
    }

    /// Finds the two bodies of a pair that meet first, and when.
    ///
    /// If the search between two bodies takes its maximum number of steps, the convex ones of them are converted to
    /// solids, and all pairs are searched again. If the new search does not decide the pair either, the other pairs are
    /// still searched. The answer is then [`PathOutcome::Undecided`], unless another pair meets, or may meet, earlier.
    ///
    /// # Errors
    /// Returns an error if a body cannot be converted to a solid where a solid may contain it.
    pub fn first_contact(&self) -> Result<PathOutcome, PathError> {
        let (mut solids, mut before) = (Vec::new(), MotionSteps::default());
        let mut with_solids: Option<Self> = None;
        loop {
            let cast = with_solids.as_ref().unwrap_or(self);
            let Searched { mut outcome, stalled } = cast.search_all_pairs()?;
            let more: Vec<usize> = stalled.into_iter().filter(|k| cast.can_be_solid(*k)).collect();
            if more.is_empty() {
                let (proof, steps) = outcome.proof_and_steps_mut();
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

    /// Finds all pairs of bodies that overlap at the start of the path, or whose distance is at most the minimum gap.
    /// Pairs for which rounding errors hide this are not included.
    ///
    /// # Errors
    /// Returns an error if a body cannot be converted to a solid where a solid may contain it.
    pub fn start_overlaps(&self) -> Result<Vec<[usize; 2]>, PathError> {
        let mut found = Vec::new();
        for (k, pair) in self.pairs.iter().enumerate() {
            let query =
                |reason: QueryError| PathError::Query { pair: *pair, reason: reason.into() };
            let link_pair = self.link_pair(k);
            let mut search = PathSearch::new(&link_pair, self.shapes_of(k), PathPlace::START);
            search.cover_pieces([0, 0], PathPlace::START, PathPlace::START);
            let meets = matches!(search.stop, Some((_, Stop::Met(..))));
            if meets || is_nested_at_start(self, k).map_err(query)? {
                found.push(*pair);
            }
        }
        Ok(found)
    }

    /// Returns the cast with these convex bodies converted to solids. The pieces of all bodies are built again.
    #[doc(hidden)]
    #[must_use]
    pub fn with_solids(&self, solids: &[usize]) -> Self {
        let shape = |(k, shape): (usize, &Shape<'a>)| {
            let placed = shape.placed;
            Shape::new(if solids.contains(&k) {
                convert_to_solid(placed).unwrap_or(placed)
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

    /// Checks whether a body is convex and can be converted to a solid.
    fn can_be_solid(&self, body: usize) -> bool {
        let placed = self.shapes[body].placed;
        matches!(placed, ByKind::Convex(_)) && convert_to_solid(placed).is_some()
    }

    /// Searches all pairs once, without conversions to solids.
    fn search_all_pairs(&self) -> Result<Searched, PathError> {
        let (mut proof, mut steps) = (PathProof::default(), MotionSteps::default());
        let mut until = PathPlace::at_row(self.path.last_row());
        let mut reached = until;
        let mut stopped: Option<(usize, Stop)> = None;
        // Pairs whose search took its maximum number of steps, and the place up to which each is separated.
        let mut open: Vec<(usize, PathPlace)> = Vec::new();
        for (k, pair) in self.pairs.iter().enumerate() {
            let link_pair = self.link_pair(k);
            let query =
                |reason: QueryError| PathError::Query { pair: *pair, reason: reason.into() };
            if is_nested_at_start(self, k).map_err(query)? {
                let meeting = PathProvenContact {
                    pair: k,
                    place: PathPlace::START,
                    how: PathContactProof::Inside,
                };
                let outcome = self.overlap_outcome(meeting, proof, steps);
                return Ok(Searched { outcome, stalled: Vec::new() });
            }
            let mut search = PathSearch::new(&link_pair, self.shapes_of(k), until);
            proof.covers.push(search.cover_pieces([0, 0], PathPlace::START, until));
            let is_open = matches!(search.stop, Some((_, Stop::Stalled)));
            if is_open {
                open.push((k, search.reached));
            } else if search.stop.is_some() {
                reached = reached.earlier_of(search.reached);
            }
            let found = search.with_proven_contact();
            steps += search.sampler.steps;
            if let Some((place, stop)) = found.filter(|_| !is_open) {
                until = place;
                if stopped.as_ref().is_none_or(|(_, before)| stop.replaces(before)) {
                    stopped = Some((k, stop));
                }
            }
        }
        // Undecided pairs do not matter if two bodies meet before.
        open.retain(|(_, place)| stopped.is_none() || *place < reached);
        let stalled = open.iter().flat_map(|(k, _)| self.pairs[*k]).collect();
        let first = open.into_iter().reduce(|a, b| if b.1 < a.1 { b } else { a });
        let outcome = match first {
            None => self.build_outcome(stopped, reached, proof, steps),
            Some((pair, place)) => self.undecided_outcome(pair, place, stopped, proof, steps),
        };
        Ok(Searched { outcome, stalled })
    }

    /// Checks a proof without a search, over all vertices. Returns the time up to which all pairs are proven not to
    /// meet, and the time at which two bodies are proven to meet. The latter is infinite if the proof claims no
    /// contact.
    ///
    /// # Errors
    /// Returns the first entry of the proof that does not hold.
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

    /// Returns the chain of a body through the given frames.
    fn body_chain(&self, body: usize, frames: &[usize]) -> Chain {
        let shape = &self.shapes[body];
        Chain::new(self.mechanism, frames, self.path, shape.pose(), shape.corners())
    }

    /// Returns the frames that contain both bodies of a pair, and the remaining frames of each body.
    fn split_at_shared_frame(&self, pair: usize) -> (Vec<usize>, [Vec<usize>; 2]) {
        let above = self.pairs[pair].map(|body| self.mechanism.frames_above(self.frames[body]));
        let shared = above[0].iter().zip(&above[1]).take_while(|(a, b)| a == b).count();
        let rest = above.each_ref().map(|frames| frames[shared..].to_vec());
        (above[0][..shared].to_vec(), rest)
    }

    /// Builds the pair of chains of a pair.
    fn link_pair(&self, pair: usize) -> LinkPair<'_> {
        let (_, frames) = self.split_at_shared_frame(pair);
        let chains = [0, 1].map(|k| self.body_chain(self.pairs[pair][k], &frames[k]));
        LinkPair::new(self.path, chains, self.min_gap)
    }

    /// Returns the shapes of the bodies of a pair.
    fn shapes_of(&self, pair: usize) -> [&Shape<'_>; 2] {
        self.pairs[pair].map(|body| &self.shapes[body])
    }

    /// Builds the outcome for the first stop of the search.
    fn build_outcome(
        &self,
        stopped: Option<(usize, Stop)>,
        reached: PathPlace,
        mut proof: PathProof,
        steps: MotionSteps,
    ) -> PathOutcome {
        match stopped {
            None => PathOutcome::Free(MotionFree { proof, steps }),
            Some((pair, Stop::Met(place, how))) => {
                let meeting = PathProvenContact { pair, place, how };
                if place == PathPlace::START {
                    return self.overlap_outcome(meeting, proof, steps);
                }
                proof.meeting = Some(meeting);
                let upper = self.path.time_bounds(place)[1];
                PathOutcome::Contact(self.build_contact(pair, reached, upper, proof, steps))
            }
            Some((pair, _)) => {
                PathOutcome::Grazing(self.build_contact(pair, reached, f64::INFINITY, proof, steps))
            }
        }
    }

    /// Builds the outcome for a pair that is undecided from a place on. Two other bodies may meet later.
    fn undecided_outcome(
        &self,
        pair: usize,
        place: PathPlace,
        stopped: Option<(usize, Stop)>,
        mut proof: PathProof,
        steps: MotionSteps,
    ) -> PathOutcome {
        let mut upper = f64::INFINITY;
        if let Some((pair, Stop::Met(place, how))) = stopped {
            upper = self.path.time_bounds(place)[1];
            proof.meeting = Some(PathProvenContact { pair, place, how });
        }
        PathOutcome::Undecided(self.build_contact(pair, place, upper, proof, steps))
    }

    /// Builds the outcome for two bodies that overlap at the start. It states nothing about the other pairs.
    fn overlap_outcome(
        &self,
        meeting: PathProvenContact,
        mut proof: PathProof,
        steps: MotionSteps,
    ) -> PathOutcome {
        let pair = meeting.pair;
        proof.covers = vec![PathCover::default(); self.pairs.len()];
        proof.meeting = Some(meeting);
        let upper = self.path.time_range()[0];
        PathOutcome::Overlapping(self.build_contact(pair, PathPlace::START, upper, proof, steps))
    }

    /// Builds the report of a contact of a pair at a place.
    fn build_contact(
        &self,
        pair: usize,
        place: PathPlace,
        upper: f64,
        proof: PathProof,
        steps: MotionSteps,
    ) -> PathContact {
        let (shared, _) = self.split_at_shared_frame(pair);
        let bodies = self.pairs[pair];
        let chain = Chain::new(self.mechanism, &shared, self.path, Pose::IDENTITY, &[]);
        let (world, _) = chain.pose_and_rates(self.path, place.row, place.share);
        let meeting = proof.meeting.as_ref().filter(|meeting| meeting.pair == pair);
        let near = self.nearest_points(pair, place, meeting);
        let lower = self.path.time_bounds(place)[0];
        let poses = bodies.map(|body| self.world_pose(body, place));
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

    /// Computes the nearest points of a pair at a place, in the frame that contains both bodies. Returns `None` for a
    /// solid without pieces in contact, or if no distance is computed.
    fn nearest_points(
        &self,
        pair: usize,
        place: PathPlace,
        meeting: Option<&PathProvenContact>,
    ) -> Option<NearestPoints> {
        let link_pair = self.link_pair(pair);
        let shapes = self.shapes_of(pair);
        let pieces = match meeting.map(|meeting| &meeting.how) {
            Some(
                PathContactProof::Pieces { pieces, .. } | PathContactProof::Point { pieces, .. },
            ) => *pieces,
            _ if shapes.iter().all(|shape| shape.piece_count() == 1) => [0, 0],
            _ => return None,
        };
        let bodies = [shapes[0].piece(pieces[0]), shapes[1].piece(pieces[1])];
        let motion = link_pair.segment_motion(bodies, place.row, [place.share; 2]);
        let near = Pair { bodies: motion.instant_at(place.share).bodies }.distance().ok()?;
        let convex = shapes.iter().all(|shape| shape.piece_count() == 1);
        let features = near.features.filter(|_| convex);
        Some(([near.on_moving, near.on_fixed], near.normal, features))
    }
}

/// The result of a search over all pairs.
struct Searched {
    outcome: PathOutcome,
    /// Bodies of the pairs whose search took its maximum number of steps.
    stalled: Vec<usize>,
}

/// Converts a convex body to a solid. Returns `None` for a point, a segment or a rounded body.
fn convert_to_solid(placed: AnyPlaced<'_>) -> Option<AnyPlaced<'_>> {
    match placed {
        ByKind::Convex(Placed { body, pose }) => {
            Some(AsSolid::as_solid(body).ok()?.at(pose).into())
        }
        ByKind::Solid(_) => Some(placed),
    }
}

/// Nearest points, normal and features.
type NearestPoints =
    ([glam::DVec3; 2], Option<glam::DVec3>, Option<colltrans_convex::body::Features>);

/// Checks whether one body of a pair contains the other one, or a part of it, at the start of the path. The surfaces of
/// the bodies are assumed to be separated. Returns `false` for two convex bodies.
fn is_nested_at_start(cast: &PathCast, pair: usize) -> Result<bool, QueryError> {
    let shapes = cast.shapes_of(pair);
    if shapes.iter().all(|shape| matches!(shape.placed, ByKind::Convex(_))) {
        return Ok(false);
    }
    let link_pair = cast.link_pair(pair);
    let placed = |k: usize| -> Result<Placed<'_, Solid>, QueryError> {
        let (pose, _) = link_pair.chains[k].pose_and_rates(cast.path, 0, 0.0);
        Ok(match shapes[k].placed {
            // The core of a sphere or a capsule has no area.
            ByKind::Convex(Placed { body, .. }) if body.radius() > 0.0 => {
                body.as_surface()?.at(pose)
            }
            ByKind::Convex(Placed { body, .. }) => AsSolid::as_solid(body)?.at(pose),
            ByKind::Solid(placed) => placed.body.at(pose),
        })
    };
    Pair::new(placed(0)?, placed(1)?)?.is_nested()
}
