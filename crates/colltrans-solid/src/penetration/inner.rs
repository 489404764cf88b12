//! Convex bodies inside two overlapping solids, which prove a lower bound of their depth.
//!
//! - If `C` lies in the moving body and `D` in the fixed one, the bodies overlap wherever `C` and `D` do. Therefore
//!   their depth is at least that of `C` and `D`.
//! - Balls around one point: the depth is the sum of their radii. The sum of the depths of a point below both surfaces
//!   has the Lipschitz constant 2, so a cube of half diagonal `d` contains no point with a sum larger than that of its
//!   centre plus `2 d`. The search divides cubes, best first. Cubes that are outside one body, or that cannot contain
//!   deeper balls than those known, are dropped.
//! - A thin common part, as of a press fit, has too many such cubes. There the search takes points of the facets of one
//!   body that are inside the other one, and moves each half its depth inwards: balls that fill a layer.
//! - Boxes parallel to the axes of the world: the depth is the smallest overlap along an axis, in either direction. The
//!   boxes grow from cubes in these balls. The side that limits the depth moves to the next facet.
//! - The grown box, less [`MARGIN`] noises, meets no facet, and contains the centre of the balls, which is inside.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use glam::DVec3;

use super::cells::{clipped, common_box, near_facets};
use super::surface::core_distances;
use super::{ROUNDING, placed_solids};
use crate::body::Solid;
use crate::solve::nearest::triangle::Corners;
use crate::solve::scene::PairFrame;
use colltrans_convex::body::{Aabb, Placed};
use colltrans_convex::pair::Pair;

/// Maximum number of centres of cubes at which the depth below both surfaces is computed.
const MAX_CENTERS: u32 = 1 << 10;
/// Relative difference from the upper bound at which the search for balls ends.
const BALL_ACCURACY: f64 = 0.01;
/// Relative difference from the upper bound up to which balls need no boxes.
const EXACT: f64 = 1e-9;
/// Maximum number of facets near the common part up to which boxes grow.
const MAX_FACETS: usize = 1 << 12;
/// Maximum number of facets of a body below which centres are tried.
const MAX_LAYER_FACETS: usize = 1 << 7;
/// Number of centres from which boxes grow.
const MAX_BOXES: usize = 12;
/// Maximum number of sides that are moved.
const MAX_MOVES: u32 = 32;
/// Distance of the sides of a box from facets, in noises. It exceeds the errors of corners and clipping, below 7 noises.
const MARGIN: f64 = 64.0;

/// A convex body inside the moving solid and one inside the fixed solid. The solids are at least as deep as these.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
#[non_exhaustive]
pub enum InnerPair {
    /// Balls around one point, which is inside both solids.
    Balls {
        /// Centre in the world.
        center: DVec3,
        /// Radii of the balls in the moving and in the fixed body, in world units, rounded down. They include the radii
        /// of rounded bodies.
        radii: [f64; 2],
    },
    /// Boxes parallel to the axes of the world, with a common point.
    Boxes {
        /// Box in the moving body, in the world.
        moving: Aabb,
        /// Box in the fixed body, in the world.
        fixed: Aabb,
    },
}

impl InnerPair {
    /// Returns the depth of the convex bodies, rounded down: the sum of the radii, or the smallest overlap of the boxes
    /// along an axis, in either direction.
    pub fn depth(&self) -> f64 {
        let depth = match self {
            Self::Balls { radii: [r, s], .. } => r + s,
            Self::Boxes { moving, fixed } => {
                let up = (fixed.high - moving.low).min_element();
                up.min((moving.high - fixed.low).min_element())
            }
        };
        depth * (1.0 - ROUNDING)
    }
}

/// Balls inside both bodies around one point.
#[derive(Clone, Copy)]
struct Balls {
    center: DVec3,
    radii: [f64; 2],
}

impl Balls {
    fn depth(&self) -> f64 {
        self.radii[0] + self.radii[1]
    }

    /// Compares by depth, the deepest first.
    fn cmp_depth(&self, other: &Self) -> Ordering {
        other.depth().total_cmp(&self.depth())
    }
}

/// A cube, by its centre and half a side.
struct Cube {
    center: DVec3,
    half: f64,
    /// Upper bounds of the depths of its points below the surfaces of the moving and of the fixed body.
    depths: [f64; 2],
    /// The sum of both depths.
    bound: f64,
}

impl PartialEq for Cube {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Cube {}

impl PartialOrd for Cube {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Cube {
    fn cmp(&self, other: &Self) -> Ordering {
        self.bound.total_cmp(&other.bound)
    }
}

/// Finds convex bodies inside the cores of two solids whose depth is large; `None` if no centre is inside both. `most` is
/// an upper bound of the depth.
pub(super) fn find_inner_pair(
    pair: &Pair<'_, Solid>,
    scene: &PairFrame,
    most: f64,
) -> Option<InnerPair> {
    let swept = [pair.moving().radius(), pair.fixed().radius()];
    let mut found = Vec::new();
    let is_complete = find_balls(pair, scene, most - swept[0] - swept[1], MAX_CENTERS, &mut found);
    if !is_complete {
        find_balls_in_layers(pair, scene, &mut found);
        found.sort_by(Balls::cmp_depth);
    }
    let balls = found.first()?;
    let radii = [0, 1].map(|k| balls.radii[k] + swept[k]);
    let balls = InnerPair::Balls { center: balls.center, radii };
    if swept != [0.0; 2] || balls.depth() >= most * (1.0 - EXACT) {
        return Some(balls);
    }
    let boxes = boxes_from(pair, scene, &found[..found.len().min(MAX_BOXES)], most);
    let deepest = |f: &InnerPair, g: &InnerPair| f.depth().total_cmp(&g.depth());
    std::iter::once(balls).chain(boxes).max_by(deepest)
}

/// Finds boxes inside both cores of two solids that are about `most` deep, from balls around at most `max_centers`
/// points.
pub(super) fn find_boxes(
    pair: &Pair<'_, Solid>,
    scene: &PairFrame,
    most: f64,
    max_centers: u32,
) -> Vec<InnerPair> {
    let mut found = Vec::new();
    find_balls(pair, scene, most, max_centers, &mut found);
    boxes_from(pair, scene, &found[..found.len().min(2)], most)
}

/// Grows boxes inside both bodies from balls.
fn boxes_from(
    pair: &Pair<'_, Solid>,
    scene: &PairFrame,
    balls: &[Balls],
    most: f64,
) -> Vec<InnerPair> {
    let Some(growth) = Growth::new(pair, scene, most) else { return Vec::new() };
    balls.iter().filter_map(|balls| growth.boxes_around(balls, most)).collect()
}

/// Returns a lower and an upper bound of the depth of a point below the surface of a body.
fn depth_below(solid: Placed<'_, Solid>, point: DVec3) -> [f64; 2] {
    match core_distances(solid, &[point]).as_deref() {
        Ok([found]) => [-found.upper, -found.lower],
        _ => [f64::NEG_INFINITY; 2],
    }
}

/// Finds balls inside both cores around points halfway between a facet of one body and the surface of the other one.
fn find_balls_in_layers(pair: &Pair<'_, Solid>, scene: &PairFrame, found: &mut Vec<Balls>) {
    let origin = pair.bodies.translations[0];
    let solids = placed_solids(pair);
    let room = common_box(scene);
    for (body, is_moving) in [(0, true), (1, false)] {
        let facets = near_facets(scene, scene.side(is_moving), &room);
        let step = facets.len().div_ceil(MAX_LAYER_FACETS).max(1);
        for facet in facets.iter().step_by(step) {
            let polygon = clipped(*facet, &room);
            let [a, b, c] = *facet;
            let Some(outwards) = (b - a).cross(c - a).try_normalize() else { continue };
            let on_facet = polygon.iter().sum::<DVec3>() / polygon.len() as f64 + origin;
            let [depth, _] = depth_below(solids[1 - body], on_facet);
            let center = on_facet - outwards * (0.5 * depth);
            if !(depth > 0.0 && center.is_finite()) {
                continue;
            }
            let radii = solids.map(|solid| depth_below(solid, center)[0]);
            if radii[0] > 0.0 && radii[1] > 0.0 {
                found.push(Balls { center, radii });
            }
        }
    }
}

/// Finds balls inside both cores, the deepest first. The search ends early when their depth is nearly `most`. Returns
/// whether no deeper balls exist, but for the accuracy.
fn find_balls(
    pair: &Pair<'_, Solid>,
    scene: &PairFrame,
    most: f64,
    max_centers: u32,
    found: &mut Vec<Balls>,
) -> bool {
    let origin = pair.bodies.translations[0];
    let solids = placed_solids(pair);
    let room = common_box(scene);
    let sides = room.side_lengths();
    let half = 0.5 * sides.min_element();
    if half.is_nan() || half <= 0.0 {
        return true;
    }
    let (mut best, mut centers) = (0.0_f64, 0);
    let mut open = BinaryHeap::new();
    // Bounds the depths in a cube, whose points are at most `depths` deep. `None` if no deeper balls are in it.
    let mut add = |center: DVec3, half: f64, mut depths: [f64; 2], best: &mut f64| {
        let (diagonal, mut radii) = (half * 3.0_f64.sqrt(), [0.0; 2]);
        for body in 0..2 {
            let [lower, upper] = depth_below(solids[body], center);
            (radii[body], depths[body]) = (lower, depths[body].min(upper + diagonal));
            if depths[body] <= 0.0 || depths[0] + depths[1] <= *best {
                return None;
            }
        }
        if radii[0] > 0.0 && radii[1] > 0.0 {
            found.push(Balls { center, radii });
            *best = best.max(radii[0] + radii[1]);
        }
        Some(Cube { center, half, depths, bound: depths[0] + depths[1] })
    };
    let counts = (sides / (2.0 * half)).ceil().min(DVec3::splat(8.0));
    let halves = sides / counts * 0.5;
    let largest = halves.max_element();
    for k in 0..counts.element_product() as u32 {
        let (x, y) = (k % counts.x as u32, k / counts.x as u32);
        let at = DVec3::new(x.into(), (y % counts.y as u32).into(), (y / counts.y as u32).into());
        let center = origin + room.low + (2.0 * at + 1.0) * halves;
        open.extend(add(center, largest, [f64::INFINITY; 2], &mut best));
        centers += 1;
    }
    let mut is_complete = true;
    while let Some(cube) = open.pop() {
        let goal = cube.bound.min(most);
        if best >= goal * (1.0 - BALL_ACCURACY) {
            break;
        }
        if centers >= max_centers {
            is_complete = false;
            break;
        }
        let half = 0.5 * cube.half;
        for k in 0..8 {
            let side =
                DVec3::from_array([0, 1, 2].map(|a| if k >> a & 1 == 1 { half } else { -half }));
            open.extend(add(cube.center + side, half, cube.depths, &mut best));
            centers += 1;
        }
    }
    found.sort_by(Balls::cmp_depth);
    is_complete
}

/// Growth of boxes between the facets of both bodies, in the setting frame.
struct Growth {
    /// Facets of the moving and of the fixed body in [`Self::room`].
    facets: [Vec<Corners>; 2],
    room: Aabb,
    /// Origin of the setting frame in the world.
    origin: DVec3,
    /// Distance of the sides of a box from facets.
    margin: f64,
}

impl Growth {
    /// Collects the facets near the common part of two bodies that are at most `most` deep; `None` if there are more than
    /// [`MAX_FACETS`].
    fn new(pair: &Pair<'_, Solid>, scene: &PairFrame, most: f64) -> Option<Self> {
        let room = common_box(scene).expanded(most);
        let facets = [true, false].map(|moving| near_facets(scene, scene.side(moving), &room));
        (facets[0].len() + facets[1].len() <= MAX_FACETS).then(|| Self {
            facets,
            room,
            origin: pair.bodies.translations[0],
            margin: MARGIN * scene.noise,
        })
    }

    /// Grows boxes from cubes in balls until no side that limits their depth can move, or they are `most` deep. `None` if
    /// rounding prevents the proof.
    fn boxes_around(&self, balls: &Balls, most: f64) -> Option<InnerPair> {
        let center = balls.center - self.origin;
        let mut boxes = balls.radii.map(|radius| {
            let half = DVec3::splat(radius / 3.0_f64.sqrt());
            let Aabb { low, high } = self.room;
            Aabb { low: (center - half).max(low), high: (center + half).min(high) }
        });
        for _ in 0..MAX_MOVES {
            let [moving, fixed] = &boxes;
            let overlaps = [moving.high - fixed.low, fixed.high - moving.low];
            let sides = [0, 1].map(|body| (overlaps[body].min_element(), body));
            let (depth, body) = if sides[0].0 <= sides[1].0 { sides[0] } else { sides[1] };
            if depth >= most {
                break;
            }
            // The body's upper side along the axis, or the lower side of the other body.
            let axis = overlaps[body].min_position();
            let is_moved = [(body, true), (1 - body, false)]
                .map(|(body, upwards)| self.move_side(&mut boxes[body], body, axis, upwards));
            if is_moved == [false; 2] {
                break;
            }
        }
        let placed = [0, 1].map(|body| {
            let inner = boxes[body].expanded(-self.margin);
            let near = inner.expanded(0.5 * self.margin);
            let is_clear = self.facets[body].iter().all(|f| clipped(*f, &near).is_empty());
            let has_center = inner.low.cmple(center).all() && center.cmple(inner.high).all();
            let placed = Aabb {
                low: (inner.low + self.origin).map(f64::next_up),
                high: (inner.high + self.origin).map(f64::next_down),
            };
            // Far from the origin of the world, rounding may leave nothing of a thin box.
            let has_points = placed.low.cmplt(placed.high).all();
            (is_clear && has_center && has_points).then_some(placed)
        });
        let [moving, fixed] = placed;
        Some(InnerPair::Boxes { moving: moving?, fixed: fixed? })
    }

    /// Moves a side of a box outwards to the next facet. Returns whether it moved.
    fn move_side(&self, bounds: &mut Aabb, body: usize, axis: usize, upwards: bool) -> bool {
        let side = |bounds: &Aabb| if upwards { bounds.high[axis] } else { bounds.low[axis] };
        let from = side(bounds);
        let mut beyond = bounds.expanded(-0.5 * self.margin);
        let sign = if upwards { 1.0 } else { -1.0 };
        let (near, far) = (from - sign * self.margin, side(&self.room));
        (beyond.low[axis], beyond.high[axis]) = (near.min(far), near.max(far));
        let heights = self.facets[body]
            .iter()
            .flat_map(|facet| clipped(*facet, &beyond))
            .map(|point| point[axis] * sign);
        let to = heights.fold(far * sign, f64::min) * sign;
        let is_moved = (to - from) * sign > self.margin;
        if is_moved {
            (if upwards { &mut bounds.high } else { &mut bounds.low })[axis] = to;
        }
        is_moved
    }
}
