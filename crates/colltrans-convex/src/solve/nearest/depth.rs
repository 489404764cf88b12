//! Penetration depth: the shortest translation that separates two bodies, over all directions (expanding polytope
//! algorithm, van den Bergen 2001). Derivations: `docs/theory/distance.md`.
//!
//! A polytope of points of `M` grows at its face nearest to the origin. The support point beyond this face joins the
//! polytope, with a fan of triangles to the horizon of the faces that have this point in front. The *height* of a
//! triangle for a unit vector `n` is the smallest `n.m` of its corners `m`. `n` is the triangle's own outward normal.
//! If the triangle cannot grow, `n` becomes the normal of a neighbour if this increases the height.
//!
//! Invariant: the returned bounds hold, regardless of the errors that rounding causes in the polytope.
//! - *Lower*: the smallest height, lowered by its rounding error. Proven by a closed surface around the origin.
//! - *Upper*: `max over m in M of n.m`, raised by one noise and the excess beyond support points.

use glam::DVec3;

use super::gjk::unit_vector;
use super::winding::winds_around_origin;
use super::{DescentResult, Difference};
use crate::answer::Enclosure;
use crate::setting::VertexPair;
use colltrans_kernel::plane::triangle_normal;

/// Maximum number of steps, above all that were observed.
const MAX_STEPS: usize = 2_000;

/// Difference of the bounds, in noises, above which another polytope is tried.
const MAX_GAP: f64 = 8.0;

/// Initial capacity for points; small, so that allocation is fast.
const INITIAL_CAPACITY: usize = 12;

/// Bounds of the penetration depth, with their proofs.
pub(crate) struct DepthBounds {
    /// Outward unit normal of `M` (setting frame). The moving body separates along it.
    pub(crate) outward: DVec3,
    /// Upper bound of the depth: the length of the translation along `outward`, rounded up.
    pub(crate) upper: f64,
    /// Proven lower bound of the depth.
    pub(crate) lower: f64,
    /// Surface that proves the lower bound; empty if the bound is 0.
    pub(crate) enclosure: Enclosure,
    /// Bound on the distance that the bodies reach beyond the support points along `outward`.
    pub(crate) excess: f64,
    /// Number of support points computed, including those of the distance.
    pub(crate) supports: u32,
}

/// Triangle of the polytope, counter-clockwise as seen from outside.
#[derive(Clone, Copy)]
struct Triangle {
    corners: [u32; 3],
    normal: DVec3,
    height: f64,
    /// Whether no point of `M` was found beyond the triangle, or none could be inserted there.
    is_final: bool,
    /// Whether the point to be inserted is in front of the triangle.
    is_visible: bool,
}

/// Vertex of `M` with its vertex pair.
#[derive(Clone, Copy)]
struct PolytopeVertex {
    at: DVec3,
    pair: VertexPair,
}

/// Polytope of points of `M`.
struct Polytope<'a> {
    difference: &'a Difference<'a>,
    points: Vec<DVec3>,
    pairs: Vec<VertexPair>,
    triangles: Vec<Triangle>,
    /// Buffer for the directed edges of the horizon.
    horizon: Vec<[u32; 2]>,
}

/// Computes bounds of the penetration depth, starting from the result of a distance search.
///
/// Stops as soon as the lower bound exceeds `enough`; the upper bound need not be tight then.
pub(crate) fn penetration_depth(
    difference: &Difference,
    found: &DescentResult,
    enough: f64,
) -> DepthBounds {
    let mut best = DepthBounds {
        outward: DVec3::X,
        upper: f64::INFINITY,
        lower: 0.0,
        enclosure: Enclosure::default(),
        excess: 0.0,
        supports: found.supports,
    };
    if let Some(plane) = found.gap_plane(difference) {
        best.record_plane(-plane.gap.normal, -plane.gap.gap, plane.excess);
    }
    let pairs: Vec<VertexPair> = found.weighted_pairs().collect();
    grow_from(difference, &pairs, &mut best, enough);
    if best.lower <= enough && best.upper - best.lower > MAX_GAP * difference.noise.point_error() {
        // Thin triangles may prevent growth. A polytope that starts elsewhere has other triangles.
        let first = difference.support_point(-best.outward, None).pair;
        best.supports += 1;
        grow_from(difference, &[first], &mut best, enough);
    }
    best
}

/// Grows a polytope from the given pairs, and records the bounds that it proves.
fn grow_from(difference: &Difference, pairs: &[VertexPair], best: &mut DepthBounds, enough: f64) {
    if let Some(mut polytope) = Polytope::from_pairs(difference, pairs, best) {
        polytope.grow_at_nearest(best, enough);
        polytope.prove_lower_bound(best);
    }
}

impl DepthBounds {
    /// Records a supporting plane: its outward normal, and the extent of `M` along it, rounded up.
    fn record_plane(&mut self, outward: DVec3, extent: f64, excess: f64) {
        if extent < self.upper {
            self.upper = extent.max(0.0);
            self.outward = outward;
            self.excess = excess;
        }
    }
}

impl<'a> Polytope<'a> {
    /// Builds a tetrahedron from four given pairs, or, if these are too flat, from the first pair and points far from
    /// it.
    ///
    /// `None` if `M` is flat up to rounding. The planes found are recorded in `best`.
    fn from_pairs(
        difference: &'a Difference,
        pairs: &[VertexPair],
        best: &mut DepthBounds,
    ) -> Option<Self> {
        let mut new = Self {
            difference,
            points: Vec::with_capacity(INITIAL_CAPACITY),
            pairs: Vec::with_capacity(INITIAL_CAPACITY),
            triangles: Vec::with_capacity(INITIAL_CAPACITY),
            horizon: Vec::with_capacity(INITIAL_CAPACITY),
        };
        for pair in pairs {
            new.add_point(PolytopeVertex { at: difference.point(*pair), pair: *pair });
        }
        if new.points.len() < 4 || new.fourth_point_height() <= 8.0 * difference.noise.point_error()
        {
            new.points.truncate(1);
            new.pairs.truncate(1);
            new.add_distant_points(best)?;
        }
        let volume = (new.points[1] - new.points[0])
            .cross(new.points[2] - new.points[0])
            .dot(new.points[3] - new.points[0]);
        if volume > 0.0 {
            new.points.swap(0, 1);
            new.pairs.swap(0, 1);
        }
        for corners in [[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]] {
            new.push_triangle(corners);
        }
        Some(new)
    }

    /// Adds a point, without triangles.
    fn add_point(&mut self, corner: PolytopeVertex) {
        self.points.push(corner.at);
        self.pairs.push(corner.pair);
    }

    /// Returns the distance of the fourth point from the plane of the first three.
    fn fourth_point_height(&self) -> f64 {
        let [a, b, c, d] = [0, 1, 2, 3].map(|k| self.points[k]);
        let normal = triangle_normal([a, b, c]).normalize_or_zero();
        normal.dot(d - a).abs()
    }

    /// Adds points far from the first point, from the line and from the plane of the points, until there are four.
    /// `None` if `M` has no such point farther than eight noises.
    fn add_distant_points(&mut self, best: &mut DepthBounds) -> Option<()> {
        for count in 1..4 {
            let first = self.points[0];
            let offset = |k: usize| self.points[k] - first;
            let axes = match count {
                1 => vec![DVec3::X, DVec3::Y, DVec3::Z],
                2 => {
                    let line = unit_vector(offset(1))?;
                    let perpendicular = line.any_orthonormal_vector();
                    vec![perpendicular, line.cross(perpendicular)]
                }
                _ => vec![unit_vector(triangle_normal([first, self.points[1], self.points[2]]))?],
            };
            let (mut farthest, mut largest) = (None, 8.0 * self.difference.noise.point_error());
            for outward in axes.into_iter().flat_map(|axis| [axis, -axis]) {
                let point = self.support_point(outward, self.pairs[0], best);
                let away = outward.dot(point.at - first);
                if away > largest {
                    (farthest, largest) = (Some(point), away);
                }
            }
            self.add_point(farthest?);
        }
        Some(())
    }

    /// Returns the point of `M` farthest along a unit vector, searched from the pair `near`, and records its plane.
    ///
    /// If the point at which the climb stopped is at least as far as the best upper bound, it is returned unverified,
    /// and no plane is recorded.
    fn support_point(
        &self,
        outward: DVec3,
        near: VertexPair,
        best: &mut DepthBounds,
    ) -> PolytopeVertex {
        let noise = self.difference.noise;
        let bodies = self.difference.bodies;
        let normals = [bodies.moving_normal(-outward), bodies.fixed_normal(-outward)];
        let found = self.difference.climbed_pair(&normals, Some(near));
        best.supports += 1;
        let at = self.difference.point(found);
        if outward.dot(at) >= best.upper {
            return PolytopeVertex { at, pair: found };
        }
        let (pair, excess) = bodies.support_with_excess(&normals, found);
        let at = if pair == found { at } else { self.difference.point(pair) };
        let raised = (outward.dot(at) + noise.lower_bound_margin() + excess).next_up();
        best.record_plane(outward, raised, excess);
        PolytopeVertex { at, pair }
    }

    /// Adds a triangle with its own normal and height.
    fn push_triangle(&mut self, corners: [u32; 3]) {
        let at = corners.map(|k| self.points[k as usize]);
        let normal = unit_vector(triangle_normal(at)).unwrap_or(DVec3::ZERO);
        let height = self.triangle_height(corners, normal);
        self.triangles.push(Triangle {
            corners,
            normal,
            height,
            is_final: false,
            is_visible: false,
        });
    }

    /// Returns the height of a triangle for a normal.
    fn triangle_height(&self, corners: [u32; 3], normal: DVec3) -> f64 {
        corners.map(|k| normal.dot(self.points[k as usize])).into_iter().fold(f64::MAX, f64::min)
    }

    /// Grows the polytope at its nearest triangle, until the bounds meet, the height exceeds `enough`, or no triangle
    /// can grow.
    fn grow_at_nearest(&mut self, best: &mut DepthBounds, enough: f64) {
        let noise = self.difference.noise.point_error();
        let enough = enough + 2.0 * self.difference.noise.height_margin();
        for _ in 0..MAX_STEPS {
            let nearest = self.nearest_triangle();
            let Triangle { corners, normal, height, is_final, .. } = self.triangles[nearest];
            if best.upper - height <= 2.5 * noise || best.upper == 0.0 || height > enough {
                return;
            }
            if is_final {
                if !self.borrow_normal(nearest) {
                    return;
                }
                continue;
            }
            let point = self.support_point(normal, self.pairs[corners[0] as usize], best);
            let beyond = normal.dot(point.at) - height;
            if beyond <= noise
                || self.pairs.contains(&point.pair)
                || !self.insert_point(nearest, point)
            {
                self.triangles[nearest].is_final = true;
            }
        }
    }

    /// Returns the index of the triangle with the smallest height, the first one of equal heights.
    fn nearest_triangle(&self) -> usize {
        let (mut nearest, mut least) = (0, f64::INFINITY);
        for (which, triangle) in self.triangles.iter().enumerate() {
            if triangle.height < least {
                (nearest, least) = (which, triangle.height);
            }
        }
        nearest
    }

    /// Gives a triangle the normal of a neighbour, if that increases its height. Returns whether this is so.
    fn borrow_normal(&mut self, which: usize) -> bool {
        let Triangle { corners, height, .. } = self.triangles[which];
        let shares = |other: &Triangle| {
            other.corners.iter().filter(|corner| corners.contains(corner)).count() >= 2
        };
        let normals = self.triangles.iter().filter(|other| shares(other)).map(|other| other.normal);
        let higher = normals
            .map(|normal| (self.triangle_height(corners, normal), normal))
            .max_by(|a, b| a.0.total_cmp(&b.0));
        match higher {
            Some((other, normal)) if other > height => {
                let triangle = &mut self.triangles[which];
                (triangle.height, triangle.normal) = (other, normal);
                true
            }
            _ => false,
        }
    }

    /// Replaces the triangles that have the new point in front by a fan. The triangle `nearest` is always replaced.
    ///
    /// Returns `false`, without a change of the triangles, if the result would not be a surface.
    fn insert_point(&mut self, nearest: usize, point: PolytopeVertex) -> bool {
        let noise = self.difference.noise.point_error();
        for triangle in &mut self.triangles {
            triangle.is_visible = triangle.normal.dot(point.at) - triangle.height > noise;
        }
        self.triangles[nearest].is_visible = true;
        let mut horizon = std::mem::take(&mut self.horizon);
        let is_surface = self.find_horizon(point.at, &mut horizon);
        if is_surface {
            self.triangles.retain(|triangle| !triangle.is_visible);
            let new = self.points.len() as u32;
            self.add_point(point);
            for &[x, y] in &horizon {
                self.push_triangle([x, y, new]);
            }
        }
        self.horizon = horizon;
        is_surface
    }

    /// Computes the horizon of the visible triangles. If the fan would have a triangle without area, marks the triangle
    /// beyond that edge as visible, too.
    ///
    /// Returns `false` if the horizon is not a single polygon.
    fn find_horizon(&mut self, at: DVec3, horizon: &mut Vec<[u32; 2]>) -> bool {
        loop {
            self.collect_horizon(horizon);
            let collinear = horizon.iter().find(|[x, y]| self.is_on_line(*x, *y, at));
            let Some(&[x, y]) = collinear else { break };
            let beyond =
                |t: &Triangle| (0..3).any(|k| [t.corners[k], t.corners[(k + 1) % 3]] == [y, x]);
            match self.triangles.iter_mut().find(|t| beyond(t)) {
                Some(other) if !other.is_visible => other.is_visible = true,
                _ => return false,
            }
        }
        let starts_before = |k: usize| horizon[..k].iter().any(|edge| edge[0] == horizon[k][0]);
        horizon.len() >= 3 && !(0..horizon.len()).any(starts_before)
    }

    /// Collects the directed edges of visible triangles whose opposite edge belongs to no visible triangle.
    fn collect_horizon(&self, horizon: &mut Vec<[u32; 2]>) {
        horizon.clear();
        for triangle in self.triangles.iter().filter(|triangle| triangle.is_visible) {
            let [a, b, c] = triangle.corners;
            for [x, y] in [[a, b], [b, c], [c, a]] {
                match horizon.iter().position(|edge| *edge == [y, x]) {
                    Some(opposite) => drop(horizon.swap_remove(opposite)),
                    None => horizon.push([x, y]),
                }
            }
        }
    }

    /// Checks whether a point is on the line through two points, up to rounding.
    fn is_on_line(&self, x: u32, y: u32, at: DVec3) -> bool {
        let [x, y] = [x, y].map(|k| self.points[k as usize]);
        let edge = y - x;
        let noise = self.difference.noise.point_error();
        edge.cross(at - x).length_squared() <= noise * noise * edge.length_squared()
    }

    /// Records the smallest height as the lower bound, if the surface is proven to wind around the origin.
    fn prove_lower_bound(self, best: &mut DepthBounds) {
        let noise = self.difference.noise;
        let least = self.triangles.iter().map(|t| t.height).fold(f64::MAX, f64::min);
        let lower = (least - noise.height_margin()).next_down();
        if lower <= best.lower {
            return;
        }
        let enclosure = Enclosure {
            pairs: self.pairs,
            triangles: self.triangles.iter().map(|t| t.corners).collect(),
            normals: self.triangles.iter().map(|t| t.normal).collect(),
        };
        // The surface is closed, because each fan has the same boundary as the triangles that it replaced.
        if winds_around_origin(self.difference.bodies, &self.points, &enclosure) {
            best.lower = lower;
            best.enclosure = enclosure;
        }
    }
}
