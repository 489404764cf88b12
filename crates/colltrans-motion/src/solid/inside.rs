//! A point inside both of two solids: that they overlap where no edge passes through a facet, as of a block that has
//! come down on a column of its own outline.
//!
//! A point or a segment is not closed. It overlaps a solid if a point of it is inside the solid.
//!
//! A point inside both is guessed by two facets: halfway between those that have passed each other, or a little
//! beneath both where they lie in one plane and look the same way. It is given in the frame of the fixed body, and
//! counts if no facet of either body is nearer to it than places may be off: then the surface of each goes round it as
//! often as the real one does.

use glam::DVec3;

use super::proof::FacetsMet;
use super::tree::Tree;
use colltrans_convex::body::Hull;
use colltrans_convex::setting::TwoBodies;
use colltrans_kernel::range::{is_in_exact_range, without_traces};
use colltrans_solid::body::{Solid, crossing};
use colltrans_solid::solve::nearest::triangle::{self, Corners};

/// How far facets are from it at least, in what places may be off: twice for what is off, twice for what is rounded here.
const OFF: f64 = 4.0;

/// How far beneath two facets in one plane a point is guessed, in what is asked for.
const BENEATH: f64 = 2.0;

/// A surface that goes round what is inside it, but for its open parts.
pub(crate) trait Surface: Hull {
    /// The facets of its closed parts, in the body's frame.
    fn closed(&self) -> impl Iterator<Item = Corners>;
}

impl Surface for Solid {
    fn closed(&self) -> impl Iterator<Item = Corners> {
        let facets = self.triangles().iter().enumerate().filter(|(k, _)| !self.is_open(*k));
        facets.map(|(_, corners)| corners.map(|v| self.vertices()[v as usize]))
    }
}

impl Surface for Tree<'_> {
    fn closed(&self) -> impl Iterator<Item = Corners> {
        let facets = (0..self.solid.triangles().len()).filter(|k| !self.solid.is_open(*k));
        facets.map(|k| self.facet(k as u32).corners)
    }
}

/// Points that may be inside both, by two facets each: of such as face each other, and such as look the same way.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Guesses([Option<Guess>; 2]);

/// Where two facets lie above each other.
#[derive(Debug, Clone, Copy)]
struct Guess {
    area: f64,
    point: DVec3,
    triangles: [u32; 2],
}

impl Guesses {
    /// Takes two facets in the setting frame into account: what has the largest area in common is kept.
    pub(crate) fn take(&mut self, triangles: [u32; 2], [f, g]: [&Corners; 2], off: f64) {
        let [own, other] = [normal(f), normal(g)];
        let size = other.length();
        let common = clipped(f, g, other);
        let [first, .., last] = &common[..] else { return };
        let across = |pair: &[DVec3]| (pair[0] - *first).cross(pair[1] - *first);
        let area = common.windows(2).map(across).sum::<DVec3>().length() / size;
        let middle = common.iter().sum::<DVec3>() / common.len() as f64;
        let (up, faces) = (other / size, own.dot(other) < 0.0);
        // How far it is above the fixed facet.
        let height = up.dot(middle - g[0]);
        let down = if faces { 0.5 * height } else { BENEATH * OFF * off };
        let fits = if faces { height < 0.0 } else { height.abs() < off };
        let kept = &mut self.0[usize::from(faces)];
        if fits && first != last && kept.is_none_or(|kept| area > kept.area) {
            *kept = Some(Guess { area, point: middle - up * down, triangles });
        }
    }

    /// One that is inside both, in the frame of the fixed body, and its facets; computed places may be off by so much.
    pub(crate) fn holding<S: Surface>(
        &self,
        bodies: &TwoBodies<S>,
        off: f64,
    ) -> Option<([u32; 2], DVec3)> {
        self.0.into_iter().flatten().find_map(|Guess { point, triangles, .. }| {
            let point = bodies.fixed_matrix.transpose() * (point - bodies.offset);
            holds(bodies, off, point).then_some((triangles, point))
        })
    }
}

/// The points of a body without area that are looked at: its ends and the middle between them.
const POINTS: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.5, 0.5, 0.0]];

/// What the points of a point or a segment are to the other solid.
pub(super) enum Contained {
    /// None is seen to be inside.
    None,
    /// One is inside, but not by more than places may be off.
    Barely,
    /// One is inside for certain.
    Met(FacetsMet),
}

/// Looks for a point of a body without area inside the other body; computed places may be off by so much.
pub(super) fn contained(bodies: &TwoBodies<Tree>, off: f64) -> Contained {
    let is_thin = |tree: &Tree| tree.solid.is_without_area(0);
    let moving = match [bodies.moving, bodies.fixed].map(is_thin) {
        [true, false] => true,
        [false, true] => false,
        _ => return Contained::None,
    };
    let facet = if moving { bodies.moving } else { bodies.fixed }.facet(0).corners;
    let count = if facet[0] == facet[1] { 1 } else { POINTS.len() };
    let mut found = Contained::None;
    for weights in &POINTS[..count] {
        let point = triangle::mean(&facet, DVec3::from_array(*weights));
        if contains(bodies, moving, point, OFF * off) {
            return Contained::Met(FacetsMet::Contained { moving, weights: *weights });
        }
        if contains(bodies, moving, point, 0.0) {
            found = Contained::Barely;
        }
    }
    found
}

/// Checks whether a point of a facet of the body that is `moving` or not is inside the other one, for certain, if
/// computed places of both may be off by so much.
pub(super) fn holds_point(
    bodies: &TwoBodies<Tree>,
    off: f64,
    moving: bool,
    facet: &Corners,
    weights: [f64; 3],
) -> bool {
    let point = triangle::mean(facet, DVec3::from_array(weights));
    contains(bodies, moving, point, OFF * off)
}

/// Checks whether a point of the body that is `moving` or not, in its frame, is inside the other one by more than `off`.
fn contains(bodies: &TwoBodies<Tree>, moving: bool, point: DVec3, off: f64) -> bool {
    let of_moving = |v: DVec3| bodies.moving_matrix * v;
    let of_fixed = |v: DVec3| bodies.fixed_matrix * v + bodies.offset;
    let there = if moving { of_moving(point) } else { of_fixed(point) };
    is_in_exact_range(without_traces(there))
        && if moving {
            is_inside(bodies.fixed, there, off, of_fixed)
        } else {
            is_inside(bodies.moving, there, off, of_moving)
        }
}

fn normal([a, b, c]: &Corners) -> DVec3 {
    (*b - *a).cross(*c - *a)
}

/// The part of a facet that lies above or below another one, along that one's normal.
fn clipped(f: &Corners, g: &Corners, normal: DVec3) -> Vec<DVec3> {
    (0..3).fold(f.to_vec(), |part, k| {
        let (from, side) = (g[k], normal.cross(g[(k + 1) % 3] - g[k]));
        let height = |p: DVec3| side.dot(p - from);
        let mut kept = Vec::with_capacity(part.len() + 1);
        for (i, &p) in part.iter().enumerate() {
            let q = part[(i + 1) % part.len()];
            let [a, b] = [height(p), height(q)];
            if a >= 0.0 {
                kept.push(p);
            }
            if (a > 0.0 && b < 0.0) || (a < 0.0 && b > 0.0) {
                kept.push(p + (q - p) * (a / (a - b)));
            }
        }
        kept
    })
}

/// Whether a point that is fixed to the fixed body is inside both, for certain, if computed places of both may be off
/// each other by so much.
pub(crate) fn holds<S: Surface>(bodies: &TwoBodies<S>, off: f64, point: DVec3) -> bool {
    let off = OFF * off;
    let there = bodies.fixed_matrix * point + bodies.offset;
    is_in_exact_range(without_traces(point))
        && is_in_exact_range(without_traces(there))
        && is_inside(bodies.moving, there, off, |v| bodies.moving_matrix * v)
        && is_inside(bodies.fixed, point, off, |v| v)
}

/// Whether a closed surface goes round a point, and all of it is farther away.
fn is_inside(
    surface: &impl Surface,
    point: DVec3,
    off: f64,
    place: impl Fn(DVec3) -> DVec3,
) -> bool {
    let (point, mut winding) = (without_traces(point), 0);
    for facet in surface.closed() {
        let corners = facet.map(|v| without_traces(place(v)));
        if !is_away(corners.map(|v| v - point), off) {
            return false;
        }
        winding += crossing(point, corners);
    }
    winding > 0
}

/// Whether a plane shows that a facet is farther from the origin: across the way to its nearest point.
fn is_away(corners: Corners, off: f64) -> bool {
    let [a, b, c] = corners;
    let edge = |u: DVec3, v: DVec3| u - (v - u) * (u.dot(v - u) / (v - u).length_squared());
    let across = normal(&corners);
    let ways = [across, -across, a, b, c, edge(a, b), edge(b, c), edge(c, a)];
    ways.into_iter().any(|way| {
        let n = way.normalize_or_zero();
        corners.iter().all(|v| n.dot(*v) > off)
    })
}
