//! A facet, its plane as heights over its shadow, and on which sides of its own sides the corners of another
//! lie.
//!
//! The signs of [`Turns`] are rounded ones with their errors until they are resolved; then they are exact.

use std::cmp::Ordering;

use glam::DVec3;

use super::super::scene::{Corner, Remembered, Scene, Side};
use super::super::sign::rough_turn;
use crate::body::Solid;
use crate::body::edges::NONE;
use colltrans_convex::body::Aabb;

/// Cosine of the angle from which on a facet is folded back onto the next one.
const FOLDED: f64 = -0.999;

/// A facet, its shadow running counter-clockwise.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Facet {
    pub(crate) triangle: u32,
    pub(crate) corners: [Corner; 3],
    pub(crate) bounds: Aabb,
    /// Its plane.
    slope: Slope,
}

impl Facet {
    /// The facet if it is a front (`Greater`) or back (`Less`) facet of its body; without a side, it is
    /// both.
    pub(crate) fn facing(
        scene: &Scene,
        moving: bool,
        triangle: usize,
        wanted: Ordering,
    ) -> Option<Self> {
        let side = scene.side(moving);
        let (corners, turn) = listed(scene, side, triangle);
        let counts = match turn {
            // What is on edge has no gap; it can be near, as the rim of what has no thickness is.
            Ordering::Equal => scene.keeps() && is_thin(side.solid, triangle),
            turn => turn == wanted || side.solid.is_open(triangle),
        };
        if !counts {
            return None;
        }
        let places = corners.map(|c| c.at);
        let (bounds, slope) = (Aabb::of_triangle(places), Slope::new(scene, places));
        Some(Self { triangle: triangle as u32, corners, bounds, slope })
    }

    /// At least so far all corners of another facet lie below the plane, for a `sign` of 1, or above it,
    /// for -1.
    pub(super) fn least_off(&self, other: &Self, sign: f64) -> f64 {
        let off = |c: &Corner| self.height_above(c.at);
        other
            .corners
            .iter()
            .map(off)
            .map(|(h, error)| sign * h - error)
            .fold(f64::INFINITY, f64::min)
    }

    /// How far its plane lies above a point, and a bound of the error.
    pub(super) fn height_above(&self, p: DVec3) -> (f64, f64) {
        self.slope.height_above(p)
    }

    /// Whether both lie in one plane across the direction, for certain.
    pub(super) fn is_level_with(&self, other: &Self) -> bool {
        let height = self.corners[0].at.z;
        let mut corners = self.corners.iter().chain(&other.corners);
        corners.all(|corner| corner.exact && corner.at.z == height)
    }

    pub(crate) fn side(&self, k: usize) -> [&Corner; 2] {
        [&self.corners[k], &self.corners[(k + 1) % 3]]
    }
}

/// Whether a triangle is of an open shell, or one next to it is folded back onto it, to within a little.
fn is_thin(solid: &Solid, triangle: usize) -> bool {
    let normal = |t: usize| {
        let [a, b, c] = solid.triangles()[t].map(|v| solid.vertices()[v as usize]);
        (b - a).cross(c - a).normalize_or_zero()
    };
    let own = normal(triangle);
    let folded = |n: &u32| *n != NONE && normal(*n as usize).dot(own) < FOLDED;
    solid.is_open(triangle) || solid.neighbours()[triangle].iter().any(folded)
}

/// The corners of a triangle, listed so that its shadow runs counter-clockwise if it has an area, and
/// which way it runs as it is.
pub(crate) fn listed(scene: &Scene, side: &Side, triangle: usize) -> ([Corner; 3], Ordering) {
    let mut corners = side.corners(triangle);
    let turn = scene.turn(&corners[0], &corners[1], &corners[2]);
    if turn == Ordering::Less {
        corners.swap(1, 2);
    }
    (corners, turn)
}

/// The plane of a facet as heights over the shadow.
#[derive(Debug, Clone, Copy)]
struct Slope {
    origin: DVec3,
    normal: DVec3,
    /// Error of a height over a point at distance 1, and at the origin.
    tilt: f64,
    level: f64,
}

impl Slope {
    fn new(scene: &Scene, [a, b, c]: [DVec3; 3]) -> Self {
        // From the two shorter sides, which determine the plane best.
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
            // A turned normal: its error over its upward part, and what that makes of the rest.
            tilt: if upright { 6.0 * noise / normal.z * steep } else { f64::INFINITY },
            level: if upright { 8.0 * scene.noise * steep } else { f64::INFINITY },
        }
    }

    /// How far the plane lies above a point.
    fn height_above(&self, p: DVec3) -> (f64, f64) {
        let to = self.origin - p;
        let error = self.level + self.tilt * to.abs().max_element();
        let height = self.normal.dot(to) / self.normal.z;
        // A facet on edge has no heights to speak of.
        if height.is_finite() && !error.is_nan() { (height, error) } else { (0.0, f64::INFINITY) }
    }
}

/// On which side of a side a corner lies: rounded, the error of that, and exactly once resolved.
#[derive(Clone, Copy)]
pub(super) struct Turn {
    pub(super) value: f64,
    pub(super) error: f64,
    pub(super) sign: Ordering,
}

/// The turns of each side of one facet with each corner of the other.
pub(super) struct Turns(pub(super) [[Turn; 3]; 3]);

impl Turns {
    /// With exact signs.
    pub(super) fn exact(scene: &Scene, sides: &Facet, corners: &Facet) -> Self {
        let mut turns = Self([0, 1, 2].map(|k| Self::about(scene, sides, k, corners)));
        turns.resolve(scene, sides, corners);
        turns
    }

    /// `None` if a side certainly has all corners on its outer side.
    pub(super) fn unless_apart(scene: &Scene, sides: &Facet, corners: &Facet) -> Option<Self> {
        let mut turns = [[Turn { value: 0.0, error: 0.0, sign: Ordering::Equal }; 3]; 3];
        for (k, row) in turns.iter_mut().enumerate() {
            *row = Self::about(scene, sides, k, corners);
            if row.iter().all(|t| t.value < -t.error) {
                return None;
            }
        }
        Some(Self(turns))
    }

    /// Those of side `k`.
    fn about(scene: &Scene, sides: &Facet, k: usize, corners: &Facet) -> [Turn; 3] {
        let (a, b) = (sides.corners[k].at, sides.corners[(k + 1) % 3].at);
        corners.corners.each_ref().map(|corner| {
            let (value, error) = rough_turn(scene, a, b, corner.at);
            let sign = if value > 0.0 { Ordering::Greater } else { Ordering::Less };
            Turn { value, error, sign }
        })
    }

    /// Makes all signs exact.
    pub(super) fn resolve(&mut self, scene: &Scene, sides: &Facet, corners: &Facet) {
        if self.are_certain() {
            return;
        }
        let of_sides = sides.corners.each_ref().map(Remembered::new);
        let of_corners = corners.corners.each_ref().map(Remembered::new);
        for k in 0..3 {
            let [a, b] = [&of_sides[k], &of_sides[(k + 1) % 3]];
            for (turn, corner) in self.0[k].iter_mut().zip(&of_corners) {
                if turn.value.abs() <= turn.error {
                    turn.sign = scene.turn(a, b, corner);
                }
            }
        }
    }

    /// Whether rounding leaves no sign in doubt.
    pub(super) fn are_certain(&self) -> bool {
        self.0.iter().flatten().all(|turn| turn.value.abs() > turn.error)
    }

    /// Whether side `k` certainly has a corner on its inner side.
    pub(super) fn admits(&self, k: usize) -> bool {
        self.0[k].iter().any(|t| t.value > t.error)
    }

    /// Whether rounding cannot tell that corner `j` lies outside the shadow of the facet of the sides.
    pub(super) fn may_contain(&self, j: usize) -> bool {
        self.0.iter().all(|side| side[j].value >= -side[j].error)
    }

    /// Whether corner `j` lies in the shadow of the facet of the sides, or on its rim.
    pub(super) fn contain(&self, j: usize) -> bool {
        self.0.iter().all(|side| side[j].sign != Ordering::Less)
    }
}

/// Whether side `k` of `f` and side `j` of `g` may cross.
pub(super) fn may_cross(of_f: &Turns, of_g: &Turns, [k, j]: [usize; 2]) -> bool {
    let next = |k: usize| (k + 1) % 3;
    let one_side = |x: Turn, y: Turn| {
        (x.value > x.error && y.value > y.error) || (x.value < -x.error && y.value < -y.error)
    };
    !one_side(of_f.0[k][j], of_f.0[k][next(j)]) && !one_side(of_g.0[j][k], of_g.0[j][next(k)])
}

/// Whether side `k` of `f` and side `j` of `g` cross in points that are no ends of them.
pub(super) fn cross(of_f: &Turns, of_g: &Turns, [k, j]: [usize; 2]) -> bool {
    let next = |k: usize| (k + 1) % 3;
    let strictly = |x: Turn, y: Turn| x.sign != Ordering::Equal && x.sign == y.sign.reverse();
    strictly(of_f.0[k][j], of_f.0[k][next(j)]) && strictly(of_g.0[j][k], of_g.0[j][next(k)])
}

/// Whether side `k` of a facet has no corner of the other on its inner side, exactly.
pub(super) fn separates(scene: &Scene, facet: &Facet, k: usize, other: &Facet) -> bool {
    let [a, b] = facet.side(k);
    other.corners.iter().all(|c| scene.turn(a, b, c) != Ordering::Greater)
}
