//! Guesses the face where a line enters `M0`, the Minkowski difference without translations, for the start of a walk.
//!
//! The inertia ellipsoid of `M0` is transformed to the unit ball around its centre. The direction from the centre to
//! the point where the line enters the ball is looked up in a table over the sides of a cube. The table has the face
//! through which the ray in this direction leaves. A line that misses the ball, or nearly does, is moved to nine tenths
//! of its radius. If the guessed face is not an entered one, the search climbs from it to one that is.

use glam::{DMat3, DVec3};

use super::faces::Plane;
use colltrans_convex::body::ConvexPolyhedron;

/// Maximum distance from the centre, relative to the radius, at which a line passes the ball.
const MAX_PASS_RADIUS: f64 = 0.9;

/// Square of the step back along the line to the ball at that distance, divided by the square of the distance.
const STEP_BACK_SQUARE: f64 =
    (1.0 - MAX_PASS_RADIUS * MAX_PASS_RADIUS) / (MAX_PASS_RADIUS * MAX_PASS_RADIUS);

/// Table of the faces through which rays from the centre leave.
#[derive(Debug)]
pub(super) struct EntryGuessTable {
    center: DVec3,
    /// Transformation from `M0` to the unit ball.
    to_ball: DMat3,
    /// Number of cells along a side of the cube.
    side: usize,
    /// Index of the face of each cell.
    cells: Vec<u32>,
}

impl EntryGuessTable {
    /// Builds the table.
    pub(super) fn new(hull: &ConvexPolyhedron, planes: &[Plane]) -> Self {
        let inertia = hull.inertia();
        let side = ((planes.len() / 6).isqrt() + 1).clamp(2, 12);
        let at = |i: usize| (2 * i + 1) as f64 / side as f64 - 1.0;
        let ray = |cell: usize| {
            let (which, u, v) = (cell / (side * side), at(cell % side), at(cell / side % side));
            let sign = if which % 2 == 0 { 1.0 } else { -1.0 };
            match which / 2 {
                0 => DVec3::new(sign, u, v),
                1 => DVec3::new(u, sign, v),
                _ => DVec3::new(u, v, sign),
            }
        };
        // The ray leaves through the face whose plane it meets first.
        let left = |ray: DVec3| {
            let reciprocal = |plane: &Plane| {
                let depth = plane.normal.dot(inertia.center) - plane.min_coordinate;
                -plane.normal.dot(ray) / depth
            };
            let first = planes.iter().map(reciprocal).enumerate();
            first.fold((0, f64::NEG_INFINITY), |a, b| if b.1 > a.1 { b } else { a }).0 as u32
        };
        let cells = (0..6 * side * side).map(|cell| left(inertia.factor * ray(cell))).collect();
        Self { center: inertia.center, to_ball: inertia.factor.inverse(), side, cells }
    }

    /// Returns the guess for the line `t d - offset`.
    #[inline]
    pub(super) fn guessed_face(&self, offset: DVec3, direction: DVec3) -> u32 {
        let along = self.to_ball * direction;
        let from = self.to_ball * -(offset + self.center);
        let per = 1.0 / along.length_squared();
        let across = from - along * (from.dot(along) * per);
        let square = across.length_squared();
        // Step back to the ball, in multiples of the direction.
        let toward = if square > MAX_PASS_RADIUS * MAX_PASS_RADIUS {
            across - along * (square * (STEP_BACK_SQUARE * per)).sqrt()
        } else {
            across - along * ((1.0 - square) * per).sqrt()
        };
        self.cells[self.cell_of(toward)]
    }

    /// Returns the cell of a direction from the centre.
    #[inline]
    fn cell_of(&self, toward: DVec3) -> usize {
        let [x, y, z] = toward.abs().to_array();
        let (axis, along, u, v) = if x >= y && x >= z {
            (0, toward.x, toward.y, toward.z)
        } else if y >= z {
            (1, toward.y, toward.x, toward.z)
        } else {
            (2, toward.z, toward.x, toward.y)
        };
        let half = 0.5 * self.side as f64;
        let per = half / along.abs();
        // NaN converts to 0.
        let place = |c: f64| ((half + c * per) as usize).min(self.side - 1);
        let which = 2 * axis + usize::from(along < 0.0);
        (which * self.side + place(v)) * self.side + place(u)
    }
}
