//! PQP: distance, tolerance and intersection of triangle soups by trees of bounding volumes.
//!
//! E. Larsen, S. Gottschalk, M. C. Lin, D. Manocha, "Fast proximity queries with swept sphere
//! volumes", UNC TR99-018, 1999 (ICRA 2000); for intersection S. Gottschalk, M. C. Lin, D. Manocha,
//! "`OBBTree`: a hierarchical structure for rapid interference detection", SIGGRAPH 1996.
//!
//! Soups are surfaces, as published: of two bodies, one inside the other, the distance of the
//! surfaces is found, which is not 0.
//!
//! The data's way: `triangle` and `volume` -> `tree` -> the queries here, each a walk
//! over pairs of nodes, the nearer pair of children first, cutting off what the bound of a pair
//! excludes. A distance query starts from the nearest triangles of the last one.

mod tree;
mod triangle;
mod volume;

use colltrans::Pose;
use glam::DVec3;

pub use tree::{Soup, SoupError};

use crate::placed::Relative;
use crate::proximity::Proximity;
use tree::Content;
use triangle::{Nearest, nearest_of_triangles};
use volume::{boxes_are_apart, distance_of_swept};

/// The work of a query.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Steps {
    /// Pairs of bounding volumes tested.
    pub volume_tests: u32,
    /// Pairs of triangles tested.
    pub triangle_tests: u32,
}

/// Queries on two soups that move.
///
/// ```
/// use colltrans::Pose;
/// use colltrans::glam::DVec3;
/// use colltrans_yardsticks::pqp::{Pqp, Soup};
///
/// let triangle = Soup::new(&[DVec3::ZERO, DVec3::X, DVec3::Y], &[[0, 1, 2]])?;
/// let mut solver = Pqp::new(&triangle, &triangle);
/// let above = Pose::from_translation(DVec3::new(0.0, 0.0, 2.0))?;
/// assert_eq!(solver.distance(&Pose::IDENTITY, &above).distance, 2.0);
/// assert!(solver.is_within(&Pose::IDENTITY, &above, 2.5).0);
/// assert!(!solver.intersects(&Pose::IDENTITY, &above).0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Pqp<'a> {
    moving: &'a Soup,
    fixed: &'a Soup,
    /// The nearest triangles of the last distance query.
    last: [u32; 2],
    /// Pairs of nodes still to be looked at, with their bounds; kept for its memory.
    open: Vec<(f64, [u32; 2])>,
}

/// Rounding of a bound in units of the size: centres, axes and products of them cost a few units in
/// the last place each.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

impl<'a> Pqp<'a> {
    /// For two soups; the first distance query starts from their first triangles.
    pub fn new(moving: &'a Soup, fixed: &'a Soup) -> Self {
        Self { moving, fixed, last: [0; 2], open: Vec::new() }
    }

    /// Forgets the nearest triangles of the last query.
    pub fn reset(&mut self) {
        self.last = [0; 2];
    }

    /// The distance of the soups, exact up to rounding.
    pub fn distance(&mut self, moving_pose: &Pose, fixed_pose: &Pose) -> Proximity<Steps> {
        self.distance_within(moving_pose, fixed_pose, 0.0, 0.0)
    }

    /// A distance of two points of the soups that is larger than the least one by at most a share
    /// of it, or by at most an absolute error in world units: whichever allows more.
    pub fn distance_within(
        &mut self,
        moving_pose: &Pose,
        fixed_pose: &Pose,
        relative_error: f64,
        absolute_error: f64,
    ) -> Proximity<Steps> {
        let mut search = self.search(moving_pose, fixed_pose);
        let mut best = search.triangles(self.last);
        let mut distance = best.square.sqrt();
        let enough = |distance: f64| {
            (distance - absolute_error).min(distance / (1.0 + relative_error)).max(0.0)
        };
        let mut limit = enough(distance);
        search.start(&mut self.open, limit);
        while let Some((bound, nodes)) = self.open.pop() {
            if bound >= limit {
                continue;
            }
            let Some(leaves) = search.descend(nodes, limit, &mut self.open) else { continue };
            let near = search.triangles(leaves);
            if near.square < best.square {
                (best, self.last) = (near, leaves);
                distance = best.square.sqrt();
                limit = enough(distance);
            }
        }
        Proximity {
            distance,
            on_moving: fixed_pose.transform_point(best.first),
            on_fixed: fixed_pose.transform_point(best.second),
            steps: search.steps,
        }
    }

    /// Whether the soups are no farther apart than `tolerance`, in world units.
    pub fn is_within(
        &mut self,
        moving_pose: &Pose,
        fixed_pose: &Pose,
        tolerance: f64,
    ) -> (bool, Steps) {
        let mut search = self.search(moving_pose, fixed_pose);
        search.start(&mut self.open, tolerance);
        while let Some((bound, nodes)) = self.open.pop() {
            if bound > tolerance {
                continue;
            }
            let Some(leaves) = search.descend(nodes, tolerance, &mut self.open) else { continue };
            if search.triangles(leaves).square.sqrt() <= tolerance {
                return (true, search.steps);
            }
        }
        (false, search.steps)
    }

    /// Whether the soups have a point in common, up to rounding: by oriented boxes.
    pub fn intersects(&mut self, moving_pose: &Pose, fixed_pose: &Pose) -> (bool, Steps) {
        let mut search = self.search(moving_pose, fixed_pose);
        self.open.clear();
        self.open.push((0.0, [0; 2]));
        while let Some((_, nodes)) = self.open.pop() {
            if search.boxes_are_apart(nodes) {
                continue;
            }
            match search.children(nodes) {
                Ok(children) => self.open.extend(children.map(|nodes| (0.0, nodes))),
                Err(leaves) => {
                    if search.triangles(leaves).square.sqrt() <= search.slack {
                        return (true, search.steps);
                    }
                }
            }
        }
        (false, search.steps)
    }

    fn search(&self, moving_pose: &Pose, fixed_pose: &Pose) -> Search<'a> {
        let relative = Relative::new(moving_pose, fixed_pose);
        let size = self.moving.reach() + self.fixed.reach() + relative.translation.length();
        Search {
            soups: [self.moving, self.fixed],
            relative,
            slack: ROUNDING * size,
            steps: Steps::default(),
        }
    }
}

/// A query under way, in the fixed soup's frame.
struct Search<'a> {
    soups: [&'a Soup; 2],
    relative: Relative,
    /// What rounding can add to a bound.
    slack: f64,
    steps: Steps,
}

impl Search<'_> {
    fn start(&mut self, open: &mut Vec<(f64, [u32; 2])>, limit: f64) {
        open.clear();
        open.push((self.bound([0; 2], limit), [0; 2]));
    }

    /// The pair's triangles, if both are leaves; else its children's pairs go on the stack, the
    /// nearer one on top.
    fn descend(
        &mut self,
        nodes: [u32; 2],
        limit: f64,
        open: &mut Vec<(f64, [u32; 2])>,
    ) -> Option<[u32; 2]> {
        let children = match self.children(nodes) {
            Ok(children) => children,
            Err(leaves) => return Some(leaves),
        };
        let [a, b] = children.map(|nodes| (self.bound(nodes, limit), nodes));
        open.extend(if a.0 <= b.0 { [b, a] } else { [a, b] });
        None
    }

    /// The pairs after the longer volume of a pair is opened; an error, the triangles, if both are
    /// leaves.
    fn children(&self, [p, q]: [u32; 2]) -> Result<[[u32; 2]; 2], [u32; 2]> {
        let (moving, fixed) = (self.soups[0].node(p), self.soups[1].node(q));
        match (moving.content, fixed.content) {
            (Content::Leaf(s), Content::Leaf(t)) => Err([s, t]),
            (Content::Inner(_), Content::Inner(first))
                if moving.volume.size() <= fixed.volume.size() =>
            {
                Ok([[p, first], [p, first + 1]])
            }
            (Content::Inner(first), _) => Ok([[first, q], [first + 1, q]]),
            (Content::Leaf(_), Content::Inner(first)) => Ok([[p, first], [p, first + 1]]),
        }
    }

    /// No points of the two nodes' triangles are nearer, up to nothing.
    fn bound(&mut self, [p, q]: [u32; 2], limit: f64) -> f64 {
        self.steps.volume_tests += 1;
        let moving = self.soups[0].node(p).volume.seen(&self.relative);
        let fixed = &self.soups[1].node(q).volume;
        (distance_of_swept(&moving, fixed, limit) - self.slack).max(0.0)
    }

    fn boxes_are_apart(&mut self, [p, q]: [u32; 2]) -> bool {
        self.steps.volume_tests += 1;
        let moving = self.soups[0].node(p).volume.seen(&self.relative);
        boxes_are_apart(&moving, &self.soups[1].node(q).volume, self.slack)
    }

    fn triangles(&mut self, [s, t]: [u32; 2]) -> Nearest {
        self.steps.triangle_tests += 1;
        let seen = |x: DVec3| self.relative.point(x);
        nearest_of_triangles(&self.soups[0].triangle(s).map(seen), &self.soups[1].triangle(t))
    }
}
