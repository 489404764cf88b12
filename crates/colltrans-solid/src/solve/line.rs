//! Exact test where a line enters the material of a body, also along facets and through edges and vertices.
//!
//! - A point is *inside* a solid if it is inside one of its bodies. A body is a shell with its cavities; its interior
//!   is open.
//! - A body counts by its winding number if the point does not lie on it, otherwise it counts 0. The point is inside if
//!   the sum is positive.
//! - `p + t u`: the line. *Place*: a parameter `t`, as a fraction. A point *past* a place lies infinitesimally beyond
//!   it.
//! - The winding number is the number of facets ahead of the point through which the line leaves, minus the number
//!   through which it enters.
//! - The line is displaced laterally by an infinitesimal amount along two axes of the world, so that it passes no edge.
//!   Facets that the undisplaced line meets at the place are not ahead of a point past it.

use std::cmp::Ordering;
use std::cmp::Ordering::{Equal, Greater, Less};

use glam::DVec3;

use super::fan::Fan;
use super::projected::Projected;
use super::scene::{ExactPoint, PairFrame, PlacedBody, PlacedVertex};
use super::triangle::Triangle;
use crate::body::Solid;
use crate::body::edges::NO_NEIGHBOUR;
use colltrans_convex::body::Aabb;
use colltrans_kernel::integer::{Integer, PRODUCT_LIMBS, SMALL_LIMBS, determinant, difference};

/// A line with a direction `u`.
#[derive(Clone, Copy)]
pub(super) struct Line<'c> {
    /// A point `p` of the line.
    pub(super) from: &'c PlacedVertex,
    pub(super) way: LineDirection<'c>,
}

/// The direction of a line.
#[derive(Clone, Copy)]
pub(super) enum LineDirection<'c> {
    /// The direction of the query, or its opposite.
    Query { forward: bool },
    /// The direction to another point.
    To(&'c PlacedVertex),
}

impl Line<'_> {
    /// Returns the sign of `det[u, a - p, b - p]`: the side of the line on which the edge passes.
    pub(super) fn turn(
        &self,
        scene: &PairFrame,
        a: &impl ExactPoint,
        b: &impl ExactPoint,
    ) -> Ordering {
        match self.way {
            LineDirection::Query { forward: true } => scene.turn(self.from, a, b),
            LineDirection::Query { forward: false } => scene.turn(self.from, a, b).reverse(),
            LineDirection::To(q) => scene.side_of_plane(self.from, q, a, b),
        }
    }

    /// Returns the sign of `det[u, a - p, e]` for the unit vector `e` of an axis of the world.
    pub(super) fn turn_about(&self, scene: &PairFrame, axis: usize, a: &PlacedVertex) -> Ordering {
        match self.way {
            LineDirection::Query { forward: true } => scene.drift_sign(axis, self.from, a),
            LineDirection::Query { forward: false } => {
                scene.drift_sign(axis, self.from, a).reverse()
            }
            LineDirection::To(q) => scene.projected_orientation(axis, self.from, q, a),
        }
    }

    /// Checks whether the line may meet a box in the query frame.
    fn may_meet(&self, scene: &PairFrame, bounds: &Aabb) -> bool {
        let (way, is_exact) = match self.way {
            LineDirection::Query { .. } => (DVec3::Z, true),
            LineDirection::To(q) => (q.at - self.from.at, false),
        };
        let noise = 4.0 * scene.noise;
        let (middle, half) = (bounds.center() - self.from.at, bounds.side_lengths() * 0.5 + noise);
        (0..3).all(|k| {
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            let off = (middle[i] * way[j] - middle[j] * way[i]).abs();
            let tilt = middle[i].abs() + middle[j].abs() + half[i] + half[j];
            let error = if is_exact { 0.0 } else { noise * tilt };
            off <= half[i] * way[j].abs() + half[j] * way[i].abs() + error
        })
    }
}

/// Checks whether a line enters a solid at the point where it meets a facet, edges and corners included. The facet
/// belongs to a closed shell and faces the line.
///
/// The line enters if the point just past this place is inside the solid. With `through`, the line passes from one side
/// of the facet's plane to the other. Then it also enters within a face if no facet of another plane contains the
/// point, because faces block however thin the wall behind them is.
pub(super) fn enters_body(
    scene: &PairFrame,
    line: &Line,
    side: &PlacedBody,
    triangle: u32,
    through: bool,
) -> bool {
    let facet = Triangle::new(side, triangle as usize);
    if through && is_within_a_face(scene, line, &facet) {
        let is_touched = is_touched::<SMALL_LIMBS>(scene, line, &facet)
            .or_else(|| is_touched::<PRODUCT_LIMBS>(scene, line, &facet));
        if is_touched == Some(false) {
            return true;
        }
    }
    is_inside_past::<SMALL_LIMBS>(scene, line, &facet)
        .or_else(|| is_inside_past::<PRODUCT_LIMBS>(scene, line, &facet))
        .unwrap_or_default()
}

/// Checks whether a facet of another plane contains the point in which a line meets a facet; `None` if a number does
/// not fit.
fn is_touched<const N: usize>(scene: &PairFrame, line: &Line, facet: &Triangle) -> Option<bool> {
    let past = PointOnLine::<N>::past_facet(scene, line, facet.side, &facet.corners)?;
    let ray = PointOnLine { is_past: false, ..past };
    let bounds = facet.bounds.expanded(4.0 * scene.noise);
    let [a, b, c] = &facet.corners;
    let mut found = false;
    ray.each_facet(
        |node| node.intersects(&bounds),
        |t, corners| {
            let is_in_plane = || corners.iter().all(|v| scene.side_of_plane(a, b, c, v) == Equal);
            found |= t != facet.index
                && matches!(ray.facet_relation(corners)?, Relation::Holds)
                && !is_in_plane();
            Some(())
        },
    )?;
    Some(found)
}

/// Checks whether the point past the place where a line meets the plane of a facet is inside the body; `None` if a
/// number does not fit.
fn is_inside_past<const N: usize>(
    scene: &PairFrame,
    line: &Line,
    facet: &Triangle,
) -> Option<bool> {
    PointOnLine::<N>::past_facet(scene, line, facet.side, &facet.corners)?.is_inside()
}

/// Checks whether a line meets a facet within its face, where the face neither bends nor ends.
fn is_within_a_face(scene: &PairFrame, line: &Line, facet: &Triangle) -> bool {
    let [a, b, c] = &facet.corners;
    let is_on =
        |k: &usize| line.turn(scene, &facet.corners[*k], &facet.corners[(k + 1) % 3]) == Equal;
    let on: Vec<usize> = (0..3).filter(is_on).collect();
    let (axis, facing) = facet.open_axis(scene);
    let continues = |[x, y, z]: [&PlacedVertex; 3]| {
        [x, y, z].into_iter().all(|v| scene.side_of_plane(a, b, c, v) == Equal)
            && scene.projected_orientation(axis, x, y, z) == facing
    };
    match on[..] {
        [] => true,
        [k] => {
            let n = facet.side.solid.neighbours()[facet.index][k];
            n != NO_NEIGHBOUR && continues(facet.side.corners(n as usize).each_ref())
        }
        [j, k, ..] => {
            let shared = if k == j + 1 { k } else { j };
            let fan = Fan::new(scene, facet.side, facet.index as u32, &facet.corners[shared]);
            fan.is_some_and(|fan| fan.facet_corners().all(continues))
        }
    }
}

/// A parameter along a line. The denominator `under` is positive.
#[derive(Clone, Copy)]
struct Fraction<const N: usize> {
    over: Integer<N>,
    under: Integer<N>,
}

impl<const N: usize> Fraction<N> {
    /// Builds a fraction; `None` if a number does not fit.
    fn new(over: Integer<N>, under: Integer<N>) -> Option<Self> {
        let is_negative = under.sign()? == Less;
        let (over, under) = if is_negative {
            (Integer::ZERO.subtract(&over), Integer::ZERO.subtract(&under))
        } else {
            (over, under)
        };
        Some(Self { over, under })
    }

    fn compare(&self, other: &Self) -> Option<Ordering> {
        self.over.multiply(&other.under).subtract(&other.over.multiply(&self.under)).sign()
    }
}

/// The relation of a facet to a point on a line.
enum Relation {
    /// The point lies on the facet.
    Holds,
    /// The displaced line passes the facet ahead of the point: 1 if it leaves through it, -1 if it enters.
    Ahead(i32),
    Neither,
}

/// A point on a line, in integers with `N` limbs. Results that do not fit are `None`.
struct PointOnLine<'r, 'a, const N: usize> {
    scene: &'r PairFrame<'a>,
    line: &'r Line<'r>,
    side: &'r PlacedBody<'a>,
    from: [Integer<N>; 3],
    way: [Integer<N>; 3],
    /// The axis of the world with the largest component of the direction.
    main: usize,
    place: Fraction<N>,
    /// Whether the point lies past the place instead of at it.
    is_past: bool,
}

impl<'r, 'a, const N: usize> PointOnLine<'r, 'a, N> {
    /// Builds the point at the start `p` of a line.
    fn from_start(scene: &'r PairFrame<'a>, line: &'r Line<'r>, side: &'r PlacedBody<'a>) -> Self {
        let from = line.from.integer_position(scene);
        let direction = scene.setting.direction;
        let (way, rough) = match line.way {
            LineDirection::Query { forward } => {
                let direction = if forward { direction } else { -direction };
                (direction.to_array().map(Integer::exact_number), direction)
            }
            LineDirection::To(q) => {
                let rough = scene.frame.transpose() * (q.at - line.from.at);
                (difference(&q.integer_position(scene), &from), rough)
            }
        };
        let place = Fraction { over: Integer::ZERO, under: Integer::exact_number(1.0) };
        let is_none = |k: usize| way[k].sign() == Some(Equal);
        let longest = rough.abs().max_position();
        let main =
            if is_none(longest) { (0..3).find(|&k| !is_none(k)).unwrap_or(0) } else { longest };
        Self { scene, line, side, from, way, main, place, is_past: false }
    }

    /// Builds the point past the place where a line meets the plane of a facet; `None` if a number does not fit.
    fn past_facet(
        scene: &'r PairFrame<'a>,
        line: &'r Line<'r>,
        side: &'r PlacedBody<'a>,
        facet: &[PlacedVertex; 3],
    ) -> Option<Self> {
        let mut ray = Self::from_start(scene, line, side);
        let place = ray.place_on(&ray.relative_corners(facet))?;
        (ray.place, ray.is_past) = (place, true);
        Some(ray)
    }

    /// Returns the corners of a facet relative to the start of the line.
    fn relative_corners(&self, corners: &[PlacedVertex; 3]) -> [[Integer<N>; 3]; 3] {
        corners.each_ref().map(|c| difference(&c.integer_position(self.scene), &self.from))
    }

    /// Returns the place where the line meets the plane of a facet that is not parallel to it; `None` if a number does
    /// not fit.
    fn place_on(&self, [a, b, c]: &[[Integer<N>; 3]; 3]) -> Option<Fraction<N>> {
        let (x, y) = (difference(b, a), difference(c, a));
        Fraction::new(determinant(&x, &y, a), determinant(&x, &y, &self.way))
    }

    /// Returns the component of `u x v` along an axis: its sign is that of `det[u, v, e]`.
    fn cross_component(&self, axis: usize, v: &[Integer<N>; 3]) -> Integer<N> {
        let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
        self.way[i].multiply(&v[j]).subtract(&self.way[j].multiply(&v[i]))
    }

    /// Returns the axes along which the line is displaced.
    fn lateral_axes(&self) -> [usize; 2] {
        [(self.main + 1) % 3, (self.main + 2) % 3]
    }

    fn facet_relation(&self, corners: &[PlacedVertex; 3]) -> Option<Relation> {
        let turn = |k: usize| self.line.turn(self.scene, &corners[k], &corners[(k + 1) % 3]);
        let turns = [turn(0), turn(1), turn(2)];
        if turns.contains(&Greater) && turns.contains(&Less) {
            return Some(Relation::Neither);
        }
        let r = self.relative_corners(corners);
        let (x, y) = (difference(&r[1], &r[0]), difference(&r[2], &r[0]));
        let facing = determinant(&x, &y, &self.way).sign()?;
        if facing == Equal {
            let is_met = turns == [Equal; 3] && self.is_along(&r)?;
            return Some(if is_met { Relation::Holds } else { Relation::Neither });
        }
        let ahead = self.place_on(&r)?.compare(&self.place)?;
        if ahead == Equal && !self.is_past {
            return Some(Relation::Holds);
        }
        for (k, turn) in turns.into_iter().enumerate() {
            if turn == Equal {
                let edge = difference(&r[(k + 1) % 3], &r[k]);
                let [first, second] =
                    self.lateral_axes().map(|axis| self.cross_component(axis, &edge).sign());
                if first?.then(second?) != facing {
                    return Some(Relation::Neither);
                }
            }
        }
        Some(match (ahead, facing) {
            (Greater, Greater) => Relation::Ahead(1),
            (Greater, _) => Relation::Ahead(-1),
            _ => Relation::Neither,
        })
    }

    /// Checks whether the point lies on a facet whose plane contains the line.
    fn is_along(&self, r: &[[Integer<N>; 3]; 3]) -> Option<bool> {
        let offsets = |axis: usize| r.each_ref().map(|v| self.cross_component(axis, v));
        let [first, second] = self.lateral_axes().map(offsets);
        let is_flat = first.iter().all(|s| s.sign() == Some(Equal));
        let offset = if is_flat { second } else { first };
        let mut range: Option<[Fraction<N>; 2]> = None;
        for k in 0..3 {
            let next = (k + 1) % 3;
            let met = match [offset[k].sign()?, offset[next].sign()?] {
                [Equal, _] => Some(Fraction::new(r[k][self.main], self.way[self.main])?),
                [_, Equal] => None,
                [s, t] if s == t => None,
                _ => {
                    let over = offset[next].multiply(&r[k][self.main]);
                    let over = over.subtract(&offset[k].multiply(&r[next][self.main]));
                    let under = offset[next].subtract(&offset[k]).multiply(&self.way[self.main]);
                    Some(Fraction::new(over, under)?)
                }
            };
            let Some(met) = met else { continue };
            let [low, high] = range.unwrap_or([met; 2]);
            range = Some(match (met.compare(&low)?, met.compare(&high)?) {
                (Less, _) => [met, high],
                (_, Greater) => [low, met],
                _ => [low, high],
            });
        }
        let Some([low, high]) = range else { return Some(false) };
        let [from, to] = [low.compare(&self.place)?, high.compare(&self.place)?];
        Some(from != Greater && (to == Greater || to == Equal && !self.is_past))
    }

    fn is_inside(&self) -> Option<bool> {
        let (mut ahead, mut on) = (Vec::new(), Vec::new());
        self.each_facet(
            |_| true,
            |t, corners| {
                match self.facet_relation(corners)? {
                    Relation::Holds => on.push(t),
                    Relation::Ahead(count) => ahead.push((t, count)),
                    Relation::Neither => {}
                }
                Some(())
            },
        )?;
        Some(is_around(self.side.solid, &ahead, &on))
    }

    /// Calls `take` for the facets of closed shells that the line may meet, in nodes whose boxes are admitted, until it
    /// returns `None`.
    fn each_facet(
        &self,
        admits: impl Fn(&Aabb) -> bool,
        mut take: impl FnMut(usize, &[PlacedVertex; 3]) -> Option<()>,
    ) -> Option<()> {
        let solid = self.side.solid;
        let mut open = vec![0];
        while let Some(at) = open.pop() {
            let node = &solid.nodes()[at as usize];
            let bounds = Projected::new(self.scene, self.side, at as usize).bounds;
            if !self.line.may_meet(self.scene, &bounds) || !admits(&bounds) {
                continue;
            }
            if !node.is_leaf() {
                open.extend(node.child_positions(at));
                continue;
            }
            for t in node.facets().filter(|&t| !solid.is_open(t)) {
                take(t, &self.side.corners(t))?;
            }
        }
        Some(())
    }
}

/// Checks whether a point is inside a body, from the facets ahead of the point with their signs, and the facets that
/// contain it.
pub(super) fn is_around(solid: &Solid, ahead: &[(usize, i32)], on: &[usize]) -> bool {
    if on.is_empty() {
        return ahead.iter().map(|(_, count)| count).sum::<i32>() > 0;
    }
    if solid.shell_bounds().len() == 1 {
        return false;
    }
    let bodies = solid.body_numbers();
    let on: Vec<u32> = on.iter().map(|&t| bodies[t]).collect();
    let others = ahead.iter().filter(|(t, _)| !on.contains(&bodies[*t]));
    others.map(|(_, count)| count).sum::<i32>() > 0
}
