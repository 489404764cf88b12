//! A facet, the heights of its plane over its shadow, and the orientations of its sides with the corners of another
//! facet.
//!
//! The signs in [`Turns`] are rounded, with error bounds, until they are resolved. Then they are exact.

use std::cmp::Ordering;

use glam::DVec3;

use super::super::scene::{CachedCorner, PairFrame, PlacedBody, PlacedVertex};
use super::super::sign::rough_turn;
use crate::body::Solid;
use crate::body::edges::NO_NEIGHBOUR;
use colltrans_convex::body::Aabb;

/// Cosine between two normals below which a facet is folded back onto its neighbour.
const FOLDED: f64 = -0.999;

/// A facet whose shadow is counter-clockwise.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Facet {
    pub(crate) triangle: u32,
    pub(crate) corners: [PlacedVertex; 3],
    pub(crate) bounds: Aabb,
    /// The plane of the facet.
    slope: Slope,
}

impl Facet {
    /// Builds a facet if it is a front (`Greater`) or back (`Less`) facet of its body; `None` otherwise. A facet of an
    /// open shell is both.
    pub(crate) fn facing(
        scene: &PairFrame,
        moving: bool,
        triangle: usize,
        wanted: Ordering,
    ) -> Option<Self> {
        let side = scene.side(moving);
        let (corners, turn) = listed(scene, side, triangle);
        let counts = match turn {
            // An edge-on facet has no gap, but it can be near. An example is the boundary of a body without thickness.
            Ordering::Equal => scene.has_min_gap() && is_thin(side.solid, triangle),
            turn => turn == wanted || side.solid.is_open(triangle),
        };
        if !counts {
            return None;
        }
        let places = corners.map(|c| c.at);
        let (bounds, slope) = (Aabb::from_triangle(places), Slope::new(scene, places));
        Some(Self { triangle: triangle as u32, corners, bounds, slope })
    }

    /// Returns a lower bound on the distance, along the direction, of all corners of another facet below the plane
    /// (`sign` 1) or above it (-1).
    pub(super) fn least_off(&self, other: &Self, sign: f64) -> f64 {
        let off = |c: &PlacedVertex| self.height_above(c.at);
        other
            .corners
            .iter()
            .map(off)
            .map(|(h, error)| sign * h - error)
            .fold(f64::INFINITY, f64::min)
    }

    /// Returns the height of the plane above a point, and a bound on its error.
    pub(super) fn height_above(&self, p: DVec3) -> (f64, f64) {
        self.slope.height_above(p)
    }

    /// Checks whether both facets certainly lie in one plane orthogonal to the direction.
    pub(super) fn is_level_with(&self, other: &Self) -> bool {
        let height = self.corners[0].at.z;
        let mut corners = self.corners.iter().chain(&other.corners);
        corners.all(|corner| corner.exact && corner.at.z == height)
    }

    pub(crate) fn side_ends(&self, k: usize) -> [&PlacedVertex; 2] {
        [&self.corners[k], &self.corners[(k + 1) % 3]]
    }
}

/// Checks whether a triangle belongs to an open shell, or a neighbour is nearly folded back onto it.
fn is_thin(solid: &Solid, triangle: usize) -> bool {
    let normal = |t: usize| {
        let [a, b, c] = solid.triangles()[t].map(|v| solid.vertices()[v as usize]);
        (b - a).cross(c - a).normalize_or_zero()
    };
    let own = normal(triangle);
    let folded = |n: &u32| *n != NO_NEIGHBOUR && normal(*n as usize).dot(own) < FOLDED;
    solid.is_open(triangle) || solid.neighbours()[triangle].iter().any(folded)
}

/// Returns the corners of a triangle, in the order in which its shadow is counter-clockwise if it has an area, and the
/// orientation of the original order.
pub(crate) fn listed(
    scene: &PairFrame,
    side: &PlacedBody,
    triangle: usize,
) -> ([PlacedVertex; 3], Ordering) {
    let mut corners = side.corners(triangle);
    let turn = scene.turn(&corners[0], &corners[1], &corners[2]);
    if turn == Ordering::Less {
        corners.swap(1, 2);
    }
    (corners, turn)
}

/// The plane of a facet, as heights over the shadow.
#[derive(Debug, Clone, Copy)]
struct Slope {
    origin: DVec3,
    normal: DVec3,
    /// Error of a height per unit of lateral distance from the origin.
    tilt: f64,
    /// Error of a height at the origin.
    level: f64,
}

impl Slope {
    fn new(scene: &PairFrame, [a, b, c]: [DVec3; 3]) -> Self {
        // The two shorter sides determine the plane best.
        let sides = [b - a, c - b, a - c];
        let lengths = sides.map(DVec3::length_squared);
        let longest = if lengths[0] >= lengths[1].max(lengths[2]) {
            0
        } else if lengths[1] >= lengths[2] {
            1
        } else {
            2
        };
        let (i, j) = ((longest + 1) % 3, (longest + 2) % 3);
        let normal = sides[i].cross(sides[j]);
        let size = sides[i].abs().max_element() + sides[j].abs().max_element();
        let noise = 8.0 * scene.noise * (size + scene.noise) + 4.0 * f64::EPSILON * size * size;
        let steep = normal.length() / normal.z;
        let upright = normal.z > 8.0 * noise;
        Self {
            origin: [a, b, c][j],
            normal,
            // Error of the normal over its vertical component, and its effect on the lateral components.
            tilt: if upright { 6.0 * noise / normal.z * steep } else { f64::INFINITY },
            level: if upright { 8.0 * scene.noise * steep } else { f64::INFINITY },
        }
    }

    /// Returns the height of the plane above a point, and a bound on its error.
    fn height_above(&self, p: DVec3) -> (f64, f64) {
        let to = self.origin - p;
        let error = self.level + self.tilt * to.abs().max_element();
        let height = self.normal.dot(to) / self.normal.z;
        // A plane that is nearly edge-on has no usable heights.
        if height.is_finite() && !error.is_nan() { (height, error) } else { (0.0, f64::INFINITY) }
    }
}

/// The orientation of a side and a corner: rounded, with its error, and exact once it is resolved.
#[derive(Clone, Copy)]
pub(super) struct Turn {
    pub(super) value: f64,
    pub(super) error: f64,
    pub(super) sign: Ordering,
}

/// The orientations of each side of one facet with each corner of the other.
pub(super) struct Turns(pub(super) [[Turn; 3]; 3]);

impl Turns {
    /// Computes all orientations with exact signs.
    pub(super) fn with_exact_signs(scene: &PairFrame, sides: &Facet, corners: &Facet) -> Self {
        let mut turns = Self([0, 1, 2].map(|k| Self::turns_of_side(scene, sides, k, corners)));
        turns.resolve_signs(scene, sides, corners);
        turns
    }

    /// Computes all rounded orientations; `None` if all corners are certainly on the outer side of a side.
    pub(super) fn unless_apart(scene: &PairFrame, sides: &Facet, corners: &Facet) -> Option<Self> {
        let mut turns = [[Turn { value: 0.0, error: 0.0, sign: Ordering::Equal }; 3]; 3];
        for (k, row) in turns.iter_mut().enumerate() {
            *row = Self::turns_of_side(scene, sides, k, corners);
            if row.iter().all(|t| t.value < -t.error) {
                return None;
            }
        }
        Some(Self(turns))
    }

    /// Computes the rounded orientations of side `k`.
    fn turns_of_side(scene: &PairFrame, sides: &Facet, k: usize, corners: &Facet) -> [Turn; 3] {
        let (a, b) = (sides.corners[k].at, sides.corners[(k + 1) % 3].at);
        corners.corners.each_ref().map(|corner| {
            let (value, error) = rough_turn(scene, a, b, corner.at);
            let sign = if value > 0.0 { Ordering::Greater } else { Ordering::Less };
            Turn { value, error, sign }
        })
    }

    /// Makes all signs exact.
    pub(super) fn resolve_signs(&mut self, scene: &PairFrame, sides: &Facet, corners: &Facet) {
        if self.are_certain() {
            return;
        }
        let of_sides = sides.corners.each_ref().map(CachedCorner::new);
        let of_corners = corners.corners.each_ref().map(CachedCorner::new);
        for k in 0..3 {
            let [a, b] = [&of_sides[k], &of_sides[(k + 1) % 3]];
            for (turn, corner) in self.0[k].iter_mut().zip(&of_corners) {
                if turn.value.abs() <= turn.error {
                    turn.sign = scene.turn(a, b, corner);
                }
            }
        }
    }

    /// Checks whether all signs are certain in spite of rounding.
    pub(super) fn are_certain(&self) -> bool {
        self.0.iter().flatten().all(|turn| turn.value.abs() > turn.error)
    }

    /// Checks whether a corner is certainly on the inner side of side `k`.
    pub(super) fn has_inner_corner(&self, k: usize) -> bool {
        self.0[k].iter().any(|t| t.value > t.error)
    }

    /// Checks whether rounding leaves open that corner `j` lies in the shadow of the facet with the sides.
    pub(super) fn may_contain_corner(&self, j: usize) -> bool {
        self.0.iter().all(|side| side[j].value >= -side[j].error)
    }

    /// Checks whether corner `j` lies in the shadow of the facet with the sides, boundary included.
    pub(super) fn contains_corner(&self, j: usize) -> bool {
        self.0.iter().all(|side| side[j].sign != Ordering::Less)
    }
}

/// Checks whether side `k` of `f` and side `j` of `g` may cross.
pub(super) fn may_cross(of_f: &Turns, of_g: &Turns, [k, j]: [usize; 2]) -> bool {
    let next = |k: usize| (k + 1) % 3;
    let one_side = |x: Turn, y: Turn| {
        (x.value > x.error && y.value > y.error) || (x.value < -x.error && y.value < -y.error)
    };
    !one_side(of_f.0[k][j], of_f.0[k][next(j)]) && !one_side(of_g.0[j][k], of_g.0[j][next(k)])
}

/// Checks whether side `k` of `f` and side `j` of `g` cross in points other than their ends.
pub(super) fn sides_cross(of_f: &Turns, of_g: &Turns, [k, j]: [usize; 2]) -> bool {
    let next = |k: usize| (k + 1) % 3;
    let strictly = |x: Turn, y: Turn| x.sign != Ordering::Equal && x.sign == y.sign.reverse();
    strictly(of_f.0[k][j], of_f.0[k][next(j)]) && strictly(of_g.0[j][k], of_g.0[j][next(k)])
}

/// Checks exactly whether no corner of the other facet is on the inner side of side `k`.
pub(super) fn side_separates(scene: &PairFrame, facet: &Facet, k: usize, other: &Facet) -> bool {
    let [a, b] = facet.side_ends(k);
    other.corners.iter().all(|c| scene.turn(a, b, c) != Ordering::Greater)
}
