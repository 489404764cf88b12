//! Where a line probably enters `M0`: a guess, from which faces are walked.
//!
//! The inertia ellipsoid of `M0`, as a ball around its centre, is met by the line at a point, whose direction from the
//! centre is looked up in a table over the sides of a cube: the face through which a ray from the centre along it
//! leaves. A line that passes the ball, or nearly does, is taken to pass it at nine tenths of its radius, so that the walk
//! to the rim begins on a face that is entered.

use glam::{DMat3, DVec3};

use super::faces::Plane;
use colltrans_convex::body::ConvexPolyhedron;

/// How far from its centre lines pass the ball at most.
const INNER: f64 = 0.9;

/// The square of how far back the ball is there, over that of the distance.
const PAST: f64 = (1.0 - INNER * INNER) / (INNER * INNER);

#[derive(Debug)]
pub(super) struct Star {
    center: DVec3,
    /// From `M0` to the ball.
    to_ball: DMat3,
    /// Cells along a side of the cube.
    side: usize,
    /// The faces.
    cells: Vec<u32>,
}

impl Star {
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
        // Through the face whose plane it meets first.
        let left = |ray: DVec3| {
            let reciprocal = |plane: &Plane| {
                let depth = plane.normal.dot(inertia.center) - plane.least;
                -plane.normal.dot(ray) / depth
            };
            let first = planes.iter().map(reciprocal).enumerate();
            first.fold((0, f64::NEG_INFINITY), |a, b| if b.1 > a.1 { b } else { a }).0 as u32
        };
        let cells = (0..6 * side * side).map(|cell| left(inertia.factor * ray(cell))).collect();
        Self { center: inertia.center, to_ball: inertia.factor.inverse(), side, cells }
    }

    /// For the line `t d - offset`.
    #[inline]
    pub(super) fn guess(&self, offset: DVec3, direction: DVec3) -> u32 {
        let along = self.to_ball * direction;
        let from = self.to_ball * -(offset + self.center);
        let per = 1.0 / along.length_squared();
        let across = from - along * (from.dot(along) * per);
        let square = across.length_squared();
        // The way back to the ball, in multiples of the line's.
        let toward = if square > INNER * INNER {
            across - along * (square * (PAST * per)).sqrt()
        } else {
            across - along * ((1.0 - square) * per).sqrt()
        };
        self.cells[self.cell(toward)]
    }

    #[inline]
    fn cell(&self, toward: DVec3) -> usize {
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
        // What is not a number is 0 as a whole one.
        let place = |c: f64| ((half + c * per) as usize).min(self.side - 1);
        let which = 2 * axis + usize::from(along < 0.0);
        (which * self.side + place(v)) * self.side + place(u)
    }
}
