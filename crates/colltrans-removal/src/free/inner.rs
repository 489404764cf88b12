//! Boxes inside a body: a pair of them may block a whole cell where no single pair of facets does.
//!
//! With a box `K` inside `A` and a box `L` inside `B`, the interiors meet along every direction that has a positive
//! multiple in the open box `L - K`. So what finely tessellated surfaces block piece by piece, two boxes block at
//! once. That a box is inside is shown once: no facet meets it, as a plane along the facet or across an axis parts
//! them, and a ray from a point of it leaves the body once more often than it enters.
//!
//! All is decided in rounded numbers with bounds of their errors: what is not certain is no box.

use glam::{DVec2, DVec3};

use super::bodies::{Bodies, View};

/// Ratios and heights are off by less.
const ROUNDING: f64 = 16.0 * f64::EPSILON;
/// How often a side is moved outwards by so much, or by half as much from then on.
const HALVINGS: u32 = 10;
const MOVES: u32 = 64;

/// A box inside a body, along the axes of the world, from the moving body's translation.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct InnerBox {
    /// Its least coordinates.
    pub low: DVec3,
    /// Its greatest ones.
    pub high: DVec3,
}

impl InnerBox {
    /// Whether it is a box inside a body.
    pub(super) fn is_inside(&self, bodies: &Bodies, moving: bool) -> bool {
        let (low, high) = (self.low, self.high);
        low.is_finite()
            && high.is_finite()
            && low.cmplt(high).all()
            && self.is_clear(bodies, moving)
            && PLACES.iter().any(|&place| winds(bodies, moving, low + (high - low) * place))
    }

    /// Whether no facet meets its inside.
    fn is_clear(&self, bodies: &Bodies, moving: bool) -> bool {
        let views = &bodies.views[usize::from(!moving)];
        let mut stack = vec![0];
        while let Some(at) = stack.pop() {
            let view = &views[at as usize];
            if self.is_beside(view) {
                continue;
            }
            if view.is_facet() {
                return false;
            }
            stack.extend(view.parts());
        }
        true
    }

    /// Whether a plane parts it from all facets of a view.
    fn is_beside(&self, view: &View) -> bool {
        if view.low.cmpge(self.high).any() || view.high.cmple(self.low).any() {
            return true;
        }
        let (middle, half) = ((self.low + self.high) * 0.5, (self.high - self.low) * 0.5);
        let (center, reach) = (view.axis.dot(middle), view.axis.abs().dot(half));
        let slack = ROUNDING * (view.axis.abs().dot(middle.abs()) + reach);
        let reach = reach + slack;
        center + reach < view.slab[0] || center - reach > view.slab[1]
    }

    /// A box that is grown around a place until facets are in its way on all sides.
    pub(super) fn around(bodies: &Bodies, moving: bool, place: DVec3, step: f64) -> Option<Self> {
        let mut step = step;
        let mut grown = Self { low: place - step / 1024.0, high: place + step / 1024.0 };
        if !grown.is_clear(bodies, moving) {
            return None;
        }
        let mut moves = 0;
        for _ in 0..HALVINGS {
            let mut open = [true; 6];
            while open.contains(&true) && moves < MOVES {
                for (side, open) in open.iter_mut().enumerate().filter(|(_, open)| **open) {
                    let mut larger = grown;
                    if side < 3 {
                        larger.low[side] -= step;
                    } else {
                        larger.high[side - 3] += step;
                    }
                    *open = larger.is_clear(bodies, moving);
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

    /// Boxes inside the moving and the fixed body behind the places where two facets meet along a direction, from
    /// shallow to deep ones.
    pub(super) fn behind(bodies: &Bodies, pair: [u32; 2], d: DVec3) -> [Vec<Self>; 2] {
        let facets = [true, false].map(|moving| {
            let triangle = pair[usize::from(!moving)];
            bodies.spots(moving, triangle).map(|spot| bodies.corner(spot).at)
        });
        let places = meeting(&facets, d.normalize());
        [true, false].map(|moving| {
            let k = usize::from(!moving);
            let views = &bodies.views[k];
            let whole = (views[0].high - views[0].low).max_element();
            let [a, b, c] = facets[k];
            let normal = (b - a).cross(c - a).normalize_or_zero();
            let mut found: Vec<Self> = Vec::new();
            for part in DEPTHS {
                let depth = whole * part;
                let new = Self::around(bodies, moving, places[k] - normal * depth, depth);
                found.extend(new.filter(|new| !found.contains(new)));
            }
            found
        })
    }
}

/// Where on a facet of the moving and one of the fixed body their shadows along a unit vector overlap, nearly in the
/// middle; the middles of facets whose shadows do not.
fn meeting(facets: &[[DVec3; 3]; 2], d: DVec3) -> [DVec3; 2] {
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

/// Places within a box from which rays are sent, as shares of its sides.
const PLACES: [DVec3; 3] =
    [DVec3::splat(0.5), DVec3::new(0.375, 0.4375, 0.5625), DVec3::new(0.625, 0.28125, 0.40625)];
/// How deep under facets boxes begin, as shares of the size of the body.
const DEPTHS: [f64; 4] = [1.0 / 512.0, 1.0 / 128.0, 1.0 / 32.0, 1.0 / 8.0];

/// Whether boxes inside the moving and the fixed body block all of a cell, by its corners.
pub(super) fn cover([moving, fixed]: [&InnerBox; 2], corners: &[DVec3; 4]) -> bool {
    let (low, high) = (fixed.low - moving.high, fixed.high - moving.low);
    // Rounded inwards.
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

/// Whether a ray along `x` from a place leaves a body more often than it enters it, for certain.
fn winds(bodies: &Bodies, moving: bool, place: DVec3) -> bool {
    let views = &bodies.views[usize::from(!moving)];
    let (mut stack, mut count) = (vec![0], 0);
    while let Some(at) = stack.pop() {
        let view = &views[at as usize];
        let (low, high) = (view.low, view.high);
        let within = (1..3).all(|k| low[k] <= place[k] && place[k] <= high[k]);
        if !within || high.x < place.x {
            continue;
        }
        if !view.is_facet() {
            stack.extend(view.parts());
            continue;
        }
        match crossing(bodies, moving, bodies.triangle(moving, at), place) {
            Some(turn) => count += turn,
            None => return false,
        }
    }
    count > 0
}

/// 1 if the ray from a place along `x` leaves through a facet, -1 if it enters, 0 if it misses it; `None` if that is
/// not certain.
fn crossing(bodies: &Bodies, moving: bool, triangle: u32, place: DVec3) -> Option<i32> {
    let corners = bodies.spots(moving, triangle).map(|spot| bodies.corner(spot));
    let exact = corners.iter().all(|corner| corner.exact);
    let noise = if exact { 0.0 } else { bodies.scene.noise };
    let ways = corners.map(|corner| corner.at - place);
    // What the difference rounds off is less than this.
    let noise = noise + f64::EPSILON * ways.iter().map(|way| way.abs().max_element()).sum::<f64>();
    let flat = ways.map(|way| DVec2::new(way.y, way.z));
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
    // Whether the facet is ahead: along its normal, whose part along `x` has the sign of the turns.
    let [a, b, c] = ways;
    let (x, y) = (b - a, c - a);
    let [l, m, n] = [x, y, a].map(|way| way.abs().max_element() + 2.0 * noise);
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
    fn boxes_cover_what_their_difference_is_seen_in() {
        let (near, far) = (
            cube(-1.0, 1.0),
            InnerBox { low: DVec3::new(3.0, -1.0, -1.0), high: DVec3::new(5.0, 1.0, 1.0) },
        );
        // The difference is from 2 to 6 along x, and 2 aside.
        let square = |reach: f64| {
            [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
                .map(|[u, v]| DVec3::new(1.0, u * reach, v * reach))
        };
        assert!(cover([&near, &far], &square(0.999)));
        assert!(!cover([&near, &far], &square(1.0)));
        assert!(!cover([&far, &near], &square(0.5)));
    }
}
