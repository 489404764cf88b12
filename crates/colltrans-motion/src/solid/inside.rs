//! Finds a point interior to both solids.
//!
//! This proves overlap when no edge of one crosses a facet of the other, for example two prisms with the same
//! cross-section that overlap end to end. For a point or a segment, which is not closed, a point of it inside the solid
//! proves overlap.
//!
//! Two facets give a guess of such a point: halfway between facets that have passed each other, or slightly below both
//! if they lie in one plane and face the same way. The point is fixed in the frame of the fixed body. It counts if its
//! winding number is positive in both bodies, and all their closed facets are farther away than [`ERROR_FACTOR`] times
//! the error of computed places. The winding numbers are then those of the real bodies.

use glam::DVec3;

use super::super::proof::FacetContactProof;
use super::tree::SolidTree;
use colltrans_convex::body::VertexHull;
use colltrans_convex::setting::TwoBodies;
use colltrans_kernel::range::{is_in_exact_range, with_tiny_components_zeroed};
use colltrans_solid::body::{Solid, ray_crossing};
use colltrans_solid::solve::nearest::triangle::{self, Corners};

/// Minimum distance of facets from the point, as a multiple of the error of computed places: 2 for this error, 2 for
/// rounding here.
const ERROR_FACTOR: f64 = 4.0;

/// Depth of a guess below two facets in one plane, as a multiple of the minimum distance.
const DEPTH_FACTOR: f64 = 2.0;

/// A surface with closed parts, which can contain points.
pub(crate) trait ClosedSurface: VertexHull {
    /// Returns the facets of the closed parts, in the frame of the body.
    fn closed_facets(&self) -> impl Iterator<Item = Corners>;
}

impl ClosedSurface for Solid {
    fn closed_facets(&self) -> impl Iterator<Item = Corners> {
        let facets = self.triangles().iter().enumerate().filter(|(k, _)| !self.is_open(*k));
        facets.map(|(_, corners)| corners.map(|v| self.vertices()[v as usize]))
    }
}

impl ClosedSurface for SolidTree<'_> {
    fn closed_facets(&self) -> impl Iterator<Item = Corners> {
        let facets = (0..self.solid.triangles().len()).filter(|k| !self.solid.is_open(*k));
        facets.map(|k| self.facet(k as u32).corners)
    }
}

/// Guesses of points inside both solids: one from facets with the same orientation, one from facets that face each
/// other.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Guesses([Option<Guess>; 2]);

/// A guess from two facets whose projections overlap.
#[derive(Debug, Clone, Copy)]
struct Guess {
    area: f64,
    point: DVec3,
    triangles: [u32; 2],
}

impl Guesses {
    /// Considers two facets in the setting frame. For each kind of guess, the pair with the largest common area is
    /// stored.
    pub(crate) fn add_facets(&mut self, triangles: [u32; 2], [f, g]: [&Corners; 2], off: f64) {
        let [own, other] = [facet_normal(f), facet_normal(g)];
        let size = other.length();
        let common = clip_to_facet(f, g, other);
        let [first, .., last] = &common[..] else { return };
        let across = |pair: &[DVec3]| (pair[0] - *first).cross(pair[1] - *first);
        let area = common.windows(2).map(across).sum::<DVec3>().length() / size;
        let middle = common.iter().sum::<DVec3>() / common.len() as f64;
        let (up, faces) = (other / size, own.dot(other) < 0.0);
        // Height above the fixed facet.
        let height = up.dot(middle - g[0]);
        let down = if faces { 0.5 * height } else { DEPTH_FACTOR * ERROR_FACTOR * off };
        let fits = if faces { height < 0.0 } else { height.abs() < off };
        let best = &mut self.0[usize::from(faces)];
        if fits && first != last && best.is_none_or(|best| area > best.area) {
            *best = Some(Guess { area, point: middle - up * down, triangles });
        }
    }

    /// Returns a guess that is inside both solids, in the frame of the fixed body, and its facets. `off` is the error
    /// of computed places. Returns `None` if no guess is proven to be inside.
    pub(crate) fn interior_point<S: ClosedSurface>(
        &self,
        bodies: &TwoBodies<S>,
        off: f64,
    ) -> Option<([u32; 2], DVec3)> {
        self.0.into_iter().flatten().find_map(|Guess { point, triangles, .. }| {
            let point = bodies.fixed_matrix.transpose() * (point - bodies.offset);
            is_inside_both(bodies, off, point).then_some((triangles, point))
        })
    }
}

/// Weights of the tested points of a body without area: both ends and the middle between them.
const TEST_WEIGHTS: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.5, 0.5, 0.0]];

/// Position of a point or a segment relative to the other solid.
pub(super) enum Contained {
    /// No tested point is inside.
    None,
    /// A point is inside, but by less than the error of computed places.
    Barely,
    /// A point is proven to be inside.
    Met(FacetContactProof),
}

/// Searches for a point of a body without area inside the other body. `off` is the error of computed places.
pub(super) fn find_contained_point(bodies: &TwoBodies<SolidTree>, off: f64) -> Contained {
    let is_thin = |tree: &SolidTree| tree.solid.is_without_area(0);
    let moving = match [bodies.moving, bodies.fixed].map(is_thin) {
        [true, false] => true,
        [false, true] => false,
        _ => return Contained::None,
    };
    let facet = if moving { bodies.moving } else { bodies.fixed }.facet(0).corners;
    let count = if facet[0] == facet[1] { 1 } else { TEST_WEIGHTS.len() };
    let mut found = Contained::None;
    for weights in &TEST_WEIGHTS[..count] {
        let point = triangle::weighted_point(&facet, DVec3::from_array(*weights));
        if contains_point(bodies, moving, point, ERROR_FACTOR * off) {
            return Contained::Met(FacetContactProof::Contained { moving, weights: *weights });
        }
        if contains_point(bodies, moving, point, 0.0) {
            found = Contained::Barely;
        }
    }
    found
}

/// Checks whether a point of a facet is proven to be inside the other body. The facet is of the moving body if `moving`
/// is true. `off` is the error of computed places.
pub(super) fn is_point_inside(
    bodies: &TwoBodies<SolidTree>,
    off: f64,
    moving: bool,
    facet: &Corners,
    weights: [f64; 3],
) -> bool {
    let point = triangle::weighted_point(facet, DVec3::from_array(weights));
    contains_point(bodies, moving, point, ERROR_FACTOR * off)
}

/// Checks whether a point is inside the other body by more than `off`. The point is in the frame of the moving body if
/// `moving` is true, else in that of the fixed body.
fn contains_point(bodies: &TwoBodies<SolidTree>, moving: bool, point: DVec3, off: f64) -> bool {
    let of_moving = |v: DVec3| bodies.moving_matrix * v;
    let of_fixed = |v: DVec3| bodies.fixed_matrix * v + bodies.offset;
    let there = if moving { of_moving(point) } else { of_fixed(point) };
    is_in_exact_range(with_tiny_components_zeroed(there))
        && if moving {
            surface_contains(bodies.fixed, there, off, of_fixed)
        } else {
            surface_contains(bodies.moving, there, off, of_moving)
        }
}

/// Returns the normal of a facet, twice its area long.
fn facet_normal([a, b, c]: &Corners) -> DVec3 {
    (*b - *a).cross(*c - *a)
}

/// Returns the part of a facet that lies above or below another facet, along the normal of the latter.
fn clip_to_facet(f: &Corners, g: &Corners, normal: DVec3) -> Vec<DVec3> {
    (0..3).fold(f.to_vec(), |part, k| {
        let (from, side) = (g[k], normal.cross(g[(k + 1) % 3] - g[k]));
        let height = |p: DVec3| side.dot(p - from);
        let mut clipped = Vec::with_capacity(part.len() + 1);
        for (i, &p) in part.iter().enumerate() {
            let q = part[(i + 1) % part.len()];
            let [a, b] = [height(p), height(q)];
            if a >= 0.0 {
                clipped.push(p);
            }
            if (a > 0.0 && b < 0.0) || (a < 0.0 && b > 0.0) {
                clipped.push(p + (q - p) * (a / (a - b)));
            }
        }
        clipped
    })
}

/// Checks whether a point in the frame of the fixed body is proven to be inside both bodies. `off` is the error of
/// computed places of one body relative to the other.
pub(crate) fn is_inside_both<S: ClosedSurface>(
    bodies: &TwoBodies<S>,
    off: f64,
    point: DVec3,
) -> bool {
    let off = ERROR_FACTOR * off;
    let there = bodies.fixed_matrix * point + bodies.offset;
    is_in_exact_range(with_tiny_components_zeroed(point))
        && is_in_exact_range(with_tiny_components_zeroed(there))
        && surface_contains(bodies.moving, there, off, |v| bodies.moving_matrix * v)
        && surface_contains(bodies.fixed, point, off, |v| v)
}

/// Checks whether a closed surface has a positive winding number around a point, and all its facets are farther away
/// than `off`.
fn surface_contains(
    surface: &impl ClosedSurface,
    point: DVec3,
    off: f64,
    place: impl Fn(DVec3) -> DVec3,
) -> bool {
    let (point, mut winding) = (with_tiny_components_zeroed(point), 0);
    for facet in surface.closed_facets() {
        let corners = facet.map(|v| with_tiny_components_zeroed(place(v)));
        if !is_facet_beyond(corners.map(|v| v - point), off) {
            return false;
        }
        winding += ray_crossing(point, corners);
    }
    winding > 0
}

/// Checks whether a plane proves that a facet is farther from the origin than `off`. Normals of the tried planes are
/// those of the facet, and the vectors from the origin to its corners and to the nearest points of the lines through
/// its edges.
fn is_facet_beyond(corners: Corners, off: f64) -> bool {
    let [a, b, c] = corners;
    let edge = |u: DVec3, v: DVec3| u - (v - u) * (u.dot(v - u) / (v - u).length_squared());
    let across = facet_normal(&corners);
    let directions = [across, -across, a, b, c, edge(a, b), edge(b, c), edge(c, a)];
    directions.into_iter().any(|direction| {
        let n = direction.normalize_or_zero();
        corners.iter().all(|v| n.dot(*v) > off)
    })
}
