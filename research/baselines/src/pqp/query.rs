//! Distance, tolerance and intersection queries for two placed soups.
//!
//! All queries descend both trees at once (Larsen et al. 1999). A pair of nodes is rejected if its volumes
//! are too far apart. Otherwise the larger node is replaced by its children or, at two leaves, the triangles
//! are compared. Pairs are kept on a stack, at most one for each level of both trees; of two new pairs the
//! nearer one is processed first.
//!
//! Invariant of a distance search: no rejected pair of triangles is nearer than the best pair less the
//! allowance. The bound of a volume has the noise subtracted, so that it holds in spite of rounding. The
//! allowance is at least two noises. Without it, a search between parallel faces, where many pairs of
//! triangles are equally far apart, would visit all of them. Therefore a distance exceeds that of the nearest
//! pair by at most two noises.

use colltrans::Pose;
use glam::DMat3;

use super::Scale;
use super::rss::{Rectangle, Rss};
use super::soup::Soup;
use super::tree::{Content, Tree};
use super::triangle::{self, Nearest};
use crate::placed::Relative;
use crate::proximity::Proximity;

/// Work of a query.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Steps {
    /// Number of compared pairs of bounding volumes.
    pub volume_tests: u64,
    /// Number of compared pairs of triangles.
    pub triangle_tests: u64,
}

/// Solver for queries between two soups. It remembers the closest pair of triangles, with which the next
/// search starts. Queries allocate no memory.
///
/// Soups are surfaces, as published. For a closed surface inside another one, the distance is that of the
/// surfaces, and they do not intersect.
///
/// ```
/// use colltrans::Pose;
/// use colltrans::glam::DVec3;
/// use colltrans_baselines::pqp::{Pqp, Soup};
///
/// let soup = Soup::new(&[DVec3::ZERO, DVec3::X, DVec3::Y], &[[0, 1, 2]])?;
/// let mut pqp = Pqp::new(&soup, &soup);
/// let above = Pose::from_translation(DVec3::new(0.2, 0.2, 3.0))?;
/// assert_eq!(pqp.distance(&above, &Pose::IDENTITY).distance, 3.0);
/// assert!(pqp.is_within(&above, &Pose::IDENTITY, 3.0).0);
/// assert!(!pqp.intersects(&above, &Pose::IDENTITY).0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Pqp<'a> {
    moving: &'a Soup,
    fixed: &'a Soup,
    /// The last closest triangles, of the fixed and the moving soup.
    last: (u32, u32),
    pending: Vec<Pair>,
}

/// Two pending nodes, and a lower bound of their distance.
#[derive(Debug, Clone, Copy)]
struct Pair {
    bound: f64,
    fixed: u32,
    moving: u32,
}

/// Errors within which a distance search rejects pairs of nodes.
#[derive(Debug, Clone, Copy)]
struct Allowance {
    relative: f64,
    absolute: f64,
    /// Gain up to which a nearer pair is ignored.
    noise: f64,
}

impl Allowance {
    /// Checks whether a pair is rejected. As published, both errors must permit that.
    fn rejects(&self, bound: f64, best: f64) -> bool {
        bound >= best - self.noise
            || (bound >= best - self.absolute && bound * (1.0 + self.relative) >= best)
    }
}

impl<'a> Pqp<'a> {
    /// Creates a solver for two soups.
    pub fn new(moving: &'a Soup, fixed: &'a Soup) -> Self {
        let levels = moving.tree().levels + fixed.tree().levels;
        Self { moving, fixed, last: (0, 0), pending: Vec::with_capacity(levels + 1) }
    }

    /// Discards the closest pair.
    pub fn reset(&mut self) {
        self.last = (0, 0);
    }

    /// Computes the distance and nearest points of the surfaces, with an error of at most `2^-44 S`. `S` is
    /// the sum of the largest distances of vertices from their frames' origins, plus the distance of the
    /// frames.
    pub fn distance(&mut self, moving_pose: &Pose, fixed_pose: &Pose) -> Proximity<Steps> {
        self.distance_within(moving_pose, fixed_pose, 0.0, 0.0)
    }

    /// Computes a pair of points whose distance exceeds that of the surfaces by at most `absolute_error`
    /// *and* by at most `relative_error` times that distance, or by two noises if these are more. As published, the
    /// smaller of both errors counts; pass infinity for one to use the other. Negative errors and NaN count as 0.
    pub fn distance_within(
        &mut self,
        moving_pose: &Pose,
        fixed_pose: &Pose,
        relative_error: f64,
        absolute_error: f64,
    ) -> Proximity<Steps> {
        let view = View::new(self.moving, self.fixed, moving_pose, fixed_pose);
        let allowance = Allowance {
            relative: relative_error.max(0.0),
            absolute: absolute_error.max(0.0),
            noise: 2.0 * view.scale.noise(),
        };
        let mut steps = Steps { triangle_tests: 1, ..Steps::default() };
        let mut nearest = view.nearest_of_triangles(self.last.0, self.last.1);
        let mut best = nearest.squared.sqrt();
        self.pending.clear();
        self.pending.push(view.root(&mut steps));
        while let Some(pair) = self.pending.pop() {
            if allowance.rejects(pair.bound, best) {
                continue;
            }
            let Some((fixed, moving)) = view.descend(pair, &mut self.pending, &mut steps) else {
                continue;
            };
            let found = view.nearest_of_triangles(fixed, moving);
            if found.squared < nearest.squared {
                (nearest, best) = (found, found.squared.sqrt());
                self.last = (fixed, moving);
            }
        }
        Proximity {
            distance: best,
            on_moving: fixed_pose.transform_point(nearest.on_b),
            on_fixed: fixed_pose.transform_point(nearest.on_a),
            steps,
        }
    }

    /// Checks whether the distance of the surfaces is at most `tolerance`.
    pub fn is_within(
        &mut self,
        moving_pose: &Pose,
        fixed_pose: &Pose,
        tolerance: f64,
    ) -> (bool, Steps) {
        let view = View::new(self.moving, self.fixed, moving_pose, fixed_pose);
        let mut steps = Steps { triangle_tests: 1, ..Steps::default() };
        if view.nearest_of_triangles(self.last.0, self.last.1).squared.sqrt() <= tolerance {
            return (true, steps);
        }
        self.pending.clear();
        self.pending.push(view.root(&mut steps));
        while let Some(pair) = self.pending.pop() {
            if pair.bound > tolerance {
                continue;
            }
            let Some((fixed, moving)) = view.descend(pair, &mut self.pending, &mut steps) else {
                continue;
            };
            if view.nearest_of_triangles(fixed, moving).squared.sqrt() <= tolerance {
                self.last = (fixed, moving);
                return (true, steps);
            }
        }
        (false, steps)
    }

    /// Checks whether the surfaces have a common point, up to rounding. Ends at the first such pair of
    /// triangles.
    pub fn intersects(&mut self, moving_pose: &Pose, fixed_pose: &Pose) -> (bool, Steps) {
        let (count, steps) = self.count_contacts(moving_pose, fixed_pose, 1);
        (count > 0, steps)
    }

    /// Returns the number of pairs of triangles with a common point, up to rounding.
    pub fn contact_count(&mut self, moving_pose: &Pose, fixed_pose: &Pose) -> (u64, Steps) {
        self.count_contacts(moving_pose, fixed_pose, u64::MAX)
    }

    /// Counts pairs of triangles with a common point, up to `enough`.
    fn count_contacts(
        &mut self,
        moving_pose: &Pose,
        fixed_pose: &Pose,
        enough: u64,
    ) -> (u64, Steps) {
        let view = View::new(self.moving, self.fixed, moving_pose, fixed_pose);
        let (mut count, mut steps) = (0, Steps::default());
        self.pending.clear();
        self.pending.push(Pair { bound: 0.0, fixed: 0, moving: 0 });
        while let Some(pair) = self.pending.pop() {
            steps.volume_tests += 1;
            if view.boxes_are_clear(pair) {
                continue;
            }
            match view.children(pair) {
                Children::None(fixed, moving) => {
                    steps.triangle_tests += 1;
                    count += u64::from(view.triangles_intersect(fixed, moving));
                    if count >= enough {
                        break;
                    }
                }
                Children::OfFixed(two) => {
                    self.pending.extend(two.map(|fixed| Pair { fixed, ..pair }));
                }
                Children::OfMoving(two) => {
                    self.pending.extend(two.map(|moving| Pair { moving, ..pair }));
                }
            }
        }
        (count, steps)
    }
}

/// Next nodes of a pair: the children of the larger node, or the triangles of two leaves (of the fixed and
/// the moving soup).
enum Children {
    OfFixed([u32; 2]),
    OfMoving([u32; 2]),
    None(u32, u32),
}

/// Two placed soups, in the frame of the fixed one.
struct View<'a> {
    moving: &'a Soup,
    fixed: &'a Soup,
    /// Transformation from the moving soup's frame to the fixed one's.
    relative: Relative,
    scale: Scale,
}

impl<'a> View<'a> {
    /// Places two soups.
    fn new(moving: &'a Soup, fixed: &'a Soup, moving_pose: &Pose, fixed_pose: &Pose) -> Self {
        let relative = Relative::new(moving_pose, fixed_pose);
        let scale = Scale::new(moving.reach() + fixed.reach() + relative.translation.length());
        Self { moving, fixed, relative, scale }
    }

    /// Returns the trees of the fixed and the moving soup.
    fn trees(&self) -> (&'a Tree, &'a Tree) {
        (self.fixed.tree(), self.moving.tree())
    }

    /// Returns a triangle of the moving soup in the fixed soup's frame.
    fn moving_triangle(&self, number: u32) -> triangle::Triangle {
        self.moving.triangle(number).map(|p| self.relative.point(p))
    }

    /// Returns nearest points of two triangles in the fixed soup's frame, that of the fixed soup first.
    fn nearest_of_triangles(&self, fixed: u32, moving: u32) -> Nearest {
        triangle::nearest_of_triangles(
            &self.fixed.triangle(fixed),
            &self.moving_triangle(moving),
            self.scale,
        )
    }

    /// Checks whether two triangles have a common point, up to rounding.
    fn triangles_intersect(&self, fixed: u32, moving: u32) -> bool {
        triangle::triangles_intersect(
            &self.fixed.triangle(fixed),
            &self.moving_triangle(moving),
            self.scale,
        )
    }

    /// Returns the next nodes of a pair.
    fn children(&self, pair: Pair) -> Children {
        let (fixed, moving) = self.trees();
        let (f, m) = (&fixed.nodes[pair.fixed as usize], &moving.nodes[pair.moving as usize]);
        match (f.content, m.content) {
            (Content::Leaf(i), Content::Leaf(j)) => Children::None(i, j),
            (Content::Inner(right), Content::Inner(_)) if f.rss.extent() >= m.rss.extent() => {
                Children::OfFixed([pair.fixed + 1, right])
            }
            (Content::Inner(right), Content::Leaf(_)) => Children::OfFixed([pair.fixed + 1, right]),
            (_, Content::Inner(right)) => Children::OfMoving([pair.moving + 1, right]),
        }
    }

    /// Returns the pair of both roots.
    fn root(&self, steps: &mut Steps) -> Pair {
        steps.volume_tests += 1;
        let (fixed, moving) = self.trees();
        let rss = &moving.nodes[0].rss;
        let bound = self.distance_bound(&fixed.nodes[0].rss, &self.in_fixed(rss), rss.radius);
        Pair { bound, fixed: 0, moving: 0 }
    }

    /// Pushes the pairs below a pair on the stack, the nearer one on top. For two leaves, returns their
    /// triangles instead.
    fn descend(
        &self,
        pair: Pair,
        pending: &mut Vec<Pair>,
        steps: &mut Steps,
    ) -> Option<(u32, u32)> {
        let (fixed, moving) = self.trees();
        let two = match self.children(pair) {
            Children::None(fixed, moving) => {
                steps.triangle_tests += 1;
                return Some((fixed, moving));
            }
            Children::OfFixed(two) => {
                let rss = &moving.nodes[pair.moving as usize].rss;
                let other = self.in_fixed(rss);
                two.map(|child| {
                    let bound =
                        self.distance_bound(&fixed.nodes[child as usize].rss, &other, rss.radius);
                    Pair { bound, fixed: child, ..pair }
                })
            }
            Children::OfMoving(two) => {
                let rss = &fixed.nodes[pair.fixed as usize].rss;
                let other = self.in_moving(rss);
                two.map(|child| {
                    let bound =
                        self.distance_bound(&moving.nodes[child as usize].rss, &other, rss.radius);
                    Pair { bound, moving: child, ..pair }
                })
            }
        };
        steps.volume_tests += 2;
        let [first, second] = two;
        pending.extend(if first.bound < second.bound { [second, first] } else { [first, second] });
        None
    }

    /// Returns a lower bound of the distance of the contents of two volumes.
    fn distance_bound(&self, rss: &Rss, other: &Rectangle, other_radius: f64) -> f64 {
        rss.gap(other, other_radius) - self.scale.noise()
    }

    /// Returns the rectangle of a moving volume in the fixed soup's frame.
    fn in_fixed(&self, rss: &Rss) -> Rectangle {
        let turn = |side| self.relative.rotation * side;
        Rectangle {
            sides: [turn(rss.axes.x_axis), turn(rss.axes.y_axis)],
            center: self.relative.point(rss.center),
            half: rss.half,
        }
    }

    /// Returns the rectangle of a fixed volume in the moving soup's frame.
    fn in_moving(&self, rss: &Rss) -> Rectangle {
        let turn = |side| self.relative.to_moving(side);
        Rectangle {
            sides: [turn(rss.axes.x_axis), turn(rss.axes.y_axis)],
            center: self.relative.to_moving(rss.center - self.relative.translation),
            half: rss.half,
        }
    }

    /// Checks whether the oriented boxes of a pair are disjoint.
    fn boxes_are_clear(&self, pair: Pair) -> bool {
        let (fixed, moving) = self.trees();
        let (f, m) = (pair.fixed as usize, pair.moving as usize);
        let (a, b) = (&fixed.boxes[f], &moving.boxes[m]);
        let center = self.relative.point(b.center);
        let axes: DMat3 = self.relative.rotation * moving.nodes[m].rss.axes;
        a.is_clear_of(&fixed.nodes[f].rss.axes, b, center, axes, self.scale.noise())
    }
}
