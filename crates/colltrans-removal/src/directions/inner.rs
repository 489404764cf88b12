//! Boxes inside a body. A pair of them can block a whole cell where no single pair of facets does.
//!
//! With a box `K` inside `A` and a box `L` inside `B`, the interiors meet along every direction that has a
//! positive multiple in the open box `L - K`. Therefore two boxes can block at once what finely tessellated
//! surfaces block piece by piece.
//!
//! A box is inside if no facet intersects its interior and a ray from one of its points leaves the body more
//! often than it enters it. The box is compared with nodes of the body's tree, down to single facets. A plane
//! perpendicular to a coordinate axis, or to a unit vector near the normals of the node's facets, separates
//! it from a node. All decisions use rounded numbers with error bounds. A box whose position is uncertain is
//! rejected.

use glam::{DVec2, DVec3};

use super::bodies::{Bodies, NodeBounds};

/// Upper bound on the relative error of ratios and of coordinates along an axis.
const ROUNDING: f64 = 16.0 * f64::EPSILON;
/// Number of step lengths that are tried, each half of the previous one.
const STEP_HALVINGS: u32 = 10;
/// Number of attempts to move a side outwards after which no further round of attempts begins.
const MAX_MOVES: u32 = 64;

/// Box inside a body. Its axes are those of the world, its origin is the moving body's translation.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct InnerBox {
    /// Smallest coordinates.
    pub low: DVec3,
    /// Largest coordinates.
    pub high: DVec3,
}

impl InnerBox {
    /// Checks whether the box is finite, not empty, and inside a body.
    pub(super) fn is_inside(&self, bodies: &Bodies, moving: bool) -> bool {
        let (low, high) = (self.low, self.high);
        low.is_finite()
            && high.is_finite()
            && low.cmplt(high).all()
            && self.is_free_of_facets(bodies, moving)
            && RAY_STARTS
                .iter()
                .any(|&place| ray_leaves(bodies, moving, low + (high - low) * place))
    }

    /// Checks whether no facet intersects the interior of the box.
    fn is_free_of_facets(&self, bodies: &Bodies, moving: bool) -> bool {
        let nodes = &bodies.nodes[usize::from(!moving)];
        let mut stack = vec![0];
        while let Some(at) = stack.pop() {
            let node = &nodes[at as usize];
            if self.is_separated_from(node) {
                continue;
            }
            if node.is_facet() {
                return false;
            }
            stack.extend(node.children());
        }
        true
    }

    /// Checks whether a plane separates the box from all facets of a node.
    fn is_separated_from(&self, node: &NodeBounds) -> bool {
        if node.low.cmpge(self.high).any() || node.high.cmple(self.low).any() {
            return true;
        }
        let (middle, half) = ((self.low + self.high) * 0.5, (self.high - self.low) * 0.5);
        let (center, reach) = (node.axis.dot(middle), node.axis.abs().dot(half));
        let slack = ROUNDING * (node.axis.abs().dot(middle.abs()) + reach);
        let reach = reach + slack;
        center + reach < node.slab[0] || center - reach > node.slab[1]
    }

    /// Grows a box around a place. Each side moves outwards by `step`, then by half of it and so on, as long
    /// as no facet intersects the box and [`MAX_MOVES`] is not reached. Returns `None` if the initial box
    /// intersects a facet, or the result is not certainly inside the body.
    pub(super) fn grown_around(
        bodies: &Bodies,
        moving: bool,
        place: DVec3,
        step: f64,
    ) -> Option<Self> {
        let mut step = step;
        let mut grown = Self { low: place - step / 1024.0, high: place + step / 1024.0 };
        if !grown.is_free_of_facets(bodies, moving) {
            return None;
        }
        let mut moves = 0;
        for _ in 0..STEP_HALVINGS {
            let mut open = [true; 6];
            while open.contains(&true) && moves < MAX_MOVES {
                for (side, open) in open.iter_mut().enumerate().filter(|(_, open)| **open) {
                    let mut larger = grown;
                    if side < 3 {
                        larger.low[side] -= step;
                    } else {
                        larger.high[side - 3] += step;
                    }
                    *open = larger.is_free_of_facets(bodies, moving);
                    if *open {
                        grown = larger;
                    }
                    moves += 1;
                }
            }
            step /= 2.0;
        }
        grown.is_inside(bodies, moving).then_some(grown)
    }

    /// Grows boxes inside the moving and the fixed body behind the points where two facets meet along a
    /// direction, in order of increasing depth.
    pub(super) fn grown_behind(bodies: &Bodies, pair: [u32; 2], d: DVec3) -> [Vec<Self>; 2] {
        let facets = [true, false].map(|moving| {
            let triangle = pair[usize::from(!moving)];
            bodies.triangle_vertices(moving, triangle).map(|vertex| bodies.placed_vertex(vertex).at)
        });
        let places = common_places(&facets, d.normalize());
        [true, false].map(|moving| {
            let k = usize::from(!moving);
            let nodes = &bodies.nodes[k];
            let whole = (nodes[0].high - nodes[0].low).max_element();
            let [a, b, c] = facets[k];
            let normal = (b - a).cross(c - a).normalize_or_zero();
            let mut found: Vec<Self> = Vec::new();
            for part in BOX_DEPTHS {
                let depth = whole * part;
                let new = Self::grown_around(bodies, moving, places[k] - normal * depth, depth);
                found.extend(new.filter(|new| !found.contains(new)));
            }
            found
        })
    }
}

/// Returns a point on a facet of the moving body and one on a facet of the fixed body whose shadows along the
/// unit vector `d` coincide, near the center of the overlap of both shadows. If the shadows do not overlap,
/// returns the centroids.
fn common_places(facets: &[[DVec3; 3]; 2], d: DVec3) -> [DVec3; 2] {
    let x = d.any_orthonormal_vector();
    let y = d.cross(x);
    let shadow = |p: DVec3| DVec2::new(x.dot(p), y.dot(p));
    let mut common: Vec<DVec2> = facets[0].map(shadow).to_vec();
    let other = facets[1].map(shadow);
    let turn = (other[1] - other[0]).perp_dot(other[2] - other[0]);
    for k in 0..3 {
        let (from, to) = (other[k], other[(k + 1) % 3]);
        let inner = |p: DVec2| (to - from).perp_dot(p - from) * turn;
        let mut kept = Vec::new();
        for (at, &p) in common.iter().enumerate() {
            let q = common[(at + 1) % common.len()];
            let (here, there) = (inner(p), inner(q));
            if here >= 0.0 {
                kept.push(p);
            }
            if here * there < 0.0 {
                kept.push(p + (q - p) * (here / (here - there)));
            }
        }
        common = kept;
    }
    let middle = common.iter().sum::<DVec2>() / common.len() as f64;
    facets.map(|[a, b, c]| {
        let (normal, mean) = ((b - a).cross(c - a), (a + b + c) / 3.0);
        let start = x * middle.x + y * middle.y;
        let along = normal.dot(a - start) / normal.dot(d);
        if along.is_finite() { start + d * along } else { mean }
    })
}

/// Starting points of rays inside a box, as fractions of its sides.
const RAY_STARTS: [DVec3; 3] =
    [DVec3::splat(0.5), DVec3::new(0.375, 0.4375, 0.5625), DVec3::new(0.625, 0.28125, 0.40625)];
/// Depths below facets at which boxes start, as fractions of the size of the body.
const BOX_DEPTHS: [f64; 4] = [1.0 / 512.0, 1.0 / 128.0, 1.0 / 32.0, 1.0 / 8.0];

/// Checks whether boxes inside the moving and the fixed body block all directions of a cell, given by its
/// corners.
pub(super) fn boxes_block([moving, fixed]: [&InnerBox; 2], corners: &[DVec3; 4]) -> bool {
    let (low, high) = (fixed.low - moving.high, fixed.high - moving.low);
    // Round the difference inwards.
    let (low, high) = (low + low.abs() * ROUNDING, high - high.abs() * ROUNDING);
    corners.iter().all(|&d| {
        let mut range = [0.0, f64::INFINITY];
        (0..3).all(|k| {
            let [near, far] = if d[k] < 0.0 { [-high[k], -low[k]] } else { [low[k], high[k]] };
            if d[k] == 0.0 {
                return near < 0.0 && far > 0.0;
            }
            let ends = [near, far].map(|end| end / d[k].abs());
            range[0] = f64::max(range[0], ends[0] + ends[0].abs() * ROUNDING);
            range[1] = f64::min(range[1], ends[1] - ends[1].abs() * ROUNDING);
            true
        }) && range[0] < range[1]
    })
}

/// Checks whether a ray along `x` certainly leaves a body more often than it enters it.
fn ray_leaves(bodies: &Bodies, moving: bool, place: DVec3) -> bool {
    let nodes = &bodies.nodes[usize::from(!moving)];
    let (mut stack, mut count) = (vec![0], 0);
    while let Some(at) = stack.pop() {
        let node = &nodes[at as usize];
        let (low, high) = (node.low, node.high);
        let within = (1..3).all(|k| low[k] <= place[k] && place[k] <= high[k]);
        if !within || high.x < place.x {
            continue;
        }
        if !node.is_facet() {
            stack.extend(node.children());
            continue;
        }
        match ray_crossing(bodies, moving, bodies.leaf_triangle(moving, at), place) {
            Some(turn) => count += turn,
            None => return false,
        }
    }
    count > 0
}

/// Returns 1 if the ray from a place along `x` leaves through a facet, -1 if it enters, and 0 if it misses
/// the facet. Returns `None` if this is uncertain.
fn ray_crossing(bodies: &Bodies, moving: bool, triangle: u32, place: DVec3) -> Option<i32> {
    let corners =
        bodies.triangle_vertices(moving, triangle).map(|vertex| bodies.placed_vertex(vertex));
    let exact = corners.iter().all(|corner| corner.exact);
    let noise = if exact { 0.0 } else { bodies.scene.noise };
    let vectors = corners.map(|corner| corner.at - place);
    // Add a bound on the rounding errors of the differences.
    let noise =
        noise + f64::EPSILON * vectors.iter().map(|vector| vector.abs().max_element()).sum::<f64>();
    let flat = vectors.map(|vector| DVec2::new(vector.y, vector.z));
    let mut turns = [0; 3];
    for k in 0..3 {
        let (p, q) = (flat[k], flat[(k + 1) % 3]);
        let value = p.perp_dot(q);
        let sizes = p.abs().element_sum() + q.abs().element_sum();
        let terms = (p.x * q.y).abs() + (p.y * q.x).abs();
        if value.abs() <= 2.0 * noise * (sizes + noise) + ROUNDING * terms {
            return None;
        }
        turns[k] = if value > 0.0 { 1 } else { -1 };
    }
    if turns != [turns[0]; 3] {
        return Some(0);
    }
    // The ray meets the plane of the facet at the distance `value / normal.x` from `place`, where `value` is
    // the product of the normal and the vector from `place` to a corner. Therefore the facet is ahead if
    // `value` has the sign of `normal.x`, which is the sign of the turns.
    let [a, b, c] = vectors;
    let (x, y) = (b - a, c - a);
    let [l, m, n] = [x, y, a].map(|vector| vector.abs().max_element() + 2.0 * noise);
    let value = x.cross(y).dot(a);
    if value.abs() <= 48.0 * noise * (l * m + m * n + n * l) + 4.0 * ROUNDING * l * m * n {
        return None;
    }
    Some(if (value > 0.0) == (turns[0] > 0) { turns[0] } else { 0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube(low: f64, high: f64) -> InnerBox {
        InnerBox { low: DVec3::splat(low), high: DVec3::splat(high) }
    }

    #[test]
    fn boxes_block_cells_inside_cone_of_difference() {
        let (near, far) = (
            cube(-1.0, 1.0),
            InnerBox { low: DVec3::new(3.0, -1.0, -1.0), high: DVec3::new(5.0, 1.0, 1.0) },
        );
        // The difference extends from 2 to 6 along x, and from -2 to 2 along the other axes.
        let square = |reach: f64| {
            [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
                .map(|[u, v]| DVec3::new(1.0, u * reach, v * reach))
        };
        assert!(boxes_block([&near, &far], &square(0.999)));
        assert!(!boxes_block([&near, &far], &square(1.0)));
        assert!(!boxes_block([&far, &near], &square(0.5)));
    }
}
