//! Builds an answer with its certificate from a face of `M0`, the Minkowski difference without translations, or from
//! two faces that meet at its silhouette.
//!
//! `docs/theory/rounding.md` derives the error bounds, under *Polygon* and *Rim*.

use glam::{DVec2, DVec3};

use super::faces::{Faces, Plane};
use super::search::{LineView, MIN_ENTRY_COMPONENT};
use colltrans_convex::answer::{Certificate, Contact, Separated, Separation, Solver, Steps};
use colltrans_convex::cast::Cast;
use colltrans_convex::setting::Setting;
use colltrans_kernel::determinant::accurate_det;
use colltrans_kernel::noise::{Noise, UNIT_VECTOR};

/// Maximum deviation of the corners of a face from its plane, in noises.
const MAX_THICKNESS_NOISES: f64 = 0.5;

/// Additional distance of a line from the sides of a face, in noises, for which every measurement confirms the overlap.
const CONFIRMATION_NOISES: f64 = 2.0;

/// Minimum square of the length of a mean of two normals, which bounds its rounding error.
const MIN_MEAN_SQUARE: f64 = 0.25;

/// A cast, as a line relative to the faces.
pub(super) struct Line<'c> {
    pub(super) setting: &'c Setting<'c>,
    noise: Noise,
    pub(super) margins: LineMargins,
}

/// Distances that a line must keep from the sides of a face.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct LineMargins {
    noise: f64,
    /// Square of the distance from which an overlap certainly exceeds grazing.
    ample_square: f64,
}

impl LineMargins {
    /// Checks whether the line passes a side certainly on its inner side, with a sufficient margin. `area` is twice the
    /// area of the triangle of the side and the line.
    #[inline]
    pub(super) fn is_clearly_inside(&self, area: f64, from: DVec2, to: DVec2) -> bool {
        let size = from.x.abs() + from.y.abs() + to.x.abs() + to.y.abs();
        let certain = area > 2.0 * self.noise * (size + self.noise);
        certain & (area * area > self.ample_square * (to - from).length_squared())
    }
}

impl<'c> Line<'c> {
    /// Computes the margins of a cast.
    #[inline]
    pub(super) fn from_cast(cast: &'c Cast) -> Self {
        let noise = cast.setting.noise();
        let tolerance = cast.options.graze_tolerance.max(noise.touching_distance());
        let ample = tolerance + CONFIRMATION_NOISES * noise.point_error();
        let margins = LineMargins { noise: noise.point_error(), ample_square: ample * ample };
        Self { setting: &cast.setting, noise, margins }
    }

    /// Returns two axes perpendicular to the direction, and the direction.
    #[inline]
    pub(super) fn direction_axes(&self) -> [DVec3; 3] {
        direction_axes(self.setting.unit)
    }
}

/// Returns the axes of the shadow frame of a unit direction.
#[inline]
pub(super) fn direction_axes(unit: DVec3) -> [DVec3; 3] {
    let e1 = unit.any_orthonormal_vector();
    [e1, unit.cross(e1), unit]
}

/// Builds the contact in a face that the line certainly enters. `of` is the index of the face, `view` and `face` are
/// its view relative to the line. Returns `None` if the face is too uneven or too steep, or if the bounds are too far
/// apart.
#[inline(always)]
#[expect(clippy::inline_always, reason = "moved about, an outcome goes through memory")]
pub(super) fn build_contact<S: LineView>(
    faces: &Faces,
    of: u32,
    (view, face): (&S, u32),
    line: &Line,
    steps: Steps,
) -> Option<Contact> {
    let Line { setting, noise, .. } = *line;
    let &Plane { normal, min_coordinate, thickness, lowest } = faces.plane(of);
    let steepness = normal.dot(setting.direction);
    if !(thickness <= MAX_THICKNESS_NOISES * noise.point_error()
        && steepness > UNIT_VECTOR * setting.length)
    {
        return None;
    }
    let (corners, weights, height) = entered_triangle(view, view.sides(face));
    let estimate = height / setting.length;
    let distance = min_coordinate + normal.dot(setting.offset);
    let per = 1.0 / steepness;
    let gap = noise.max_bound_gap(0.0, 0.0) * per;
    // This comparison fails for NaN.
    let is_tight = estimate - distance / steepness <= gap;
    if !is_tight {
        return None;
    }
    let lowered = noise.lower_bound_margin() + faces.input_excess;
    let lower = ((distance - lowered) / steepness).next_down();
    let upper = (estimate + noise.upper_bound_margin() / steepness).next_up();
    let certificate = Certificate {
        normal,
        lower,
        pairs: corners.map(|side| faces.pair_at_side(of, side)),
        weights,
        upper,
        rounding: gap + (noise.upper_bound_margin() + lowered) * per,
    };
    let translation = estimate.max(lower);
    Some(Contact::new(translation, normal, lowest, certificate, Solver::Portal, steps))
}

/// Splits a face into triangles with its first corner in common, and finds the triangle that the line enters. Returns
/// its corners, their weights and the height.
#[inline(always)]
#[expect(clippy::inline_always, reason = "passed through memory they stall their reader")]
fn entered_triangle<S: LineView>(view: &S, sides: &[S::Side]) -> ([usize; 3], [f64; 3], f64) {
    let corner = |side: usize| view.corner_coordinates(&sides[side]);
    let (a, mut b, mut c) = (corner(0), corner(1), corner(2));
    let mut last = 2;
    let mut last_determinant = accurate_det(c.truncate(), a.truncate());
    while last_determinant < 0.0 && last + 1 < sides.len() {
        last += 1;
        (b, c) = (c, corner(last));
        last_determinant = accurate_det(c.truncate(), a.truncate());
    }
    let parts = [
        accurate_det(b.truncate(), c.truncate()),
        last_determinant,
        accurate_det(a.truncate(), b.truncate()),
    ];
    let per = 1.0 / (parts[0] + parts[1] + parts[2]);
    let weights = parts.map(|part| part * per);
    let [_, v, w] = weights;
    ([0, last - 1, last], weights, a.z + (b.z - a.z) * v + (c.z - a.z) * w)
}

/// A plane parallel to a direction that touches `M0` where two faces meet.
#[derive(Debug, Clone, Copy)]
pub(super) struct SilhouettePlane {
    /// Inward unit normal.
    normal: DVec3,
    /// Lower bound of `min n.m` over `M0`, up to rounding.
    min_coordinate: f64,
}

impl SilhouettePlane {
    /// Builds the plane at the common edge of an entered face and a face that is not entered. Returns `None` if their
    /// normals are nearly opposite.
    #[inline]
    pub(super) fn new(entered: &Plane, other: &Plane, unit: DVec3) -> Option<Self> {
        let along = [entered, other].map(|plane| plane.normal.dot(unit));
        let [a, b] = [(-along[1]).max(0.0), along[0]];
        let [a, b] = [a / (a + b), b / (a + b)];
        let normal = entered.normal * a + other.normal * b;
        let square = normal.length_squared();
        let blunt = square >= MIN_MEAN_SQUARE && along[0] > MIN_ENTRY_COMPONENT;
        let length = square.sqrt();
        let min_coordinate = (a * entered.min_coordinate + b * other.min_coordinate) / length;
        blunt.then(|| Self { normal: normal / length, min_coordinate })
    }
}

/// Builds the separation by the plane at the silhouette. Returns `None` if the margin is too small for a certain
/// answer.
#[inline]
pub(super) fn build_separation(
    silhouette: &SilhouettePlane,
    line: &Line,
    steps: Steps,
) -> Option<Separated> {
    let noise = line.noise;
    let lowered = noise.lower_bound_margin() + line.setting.input_excess();
    let margin = (silhouette.min_coordinate + silhouette.normal.dot(line.setting.offset)) - lowered;
    let certificate = Separation { normal: silhouette.normal, margin };
    let certain = margin > 2.0 * noise.touching_distance();
    certain.then_some(Separated::new(certificate, Solver::Portal, steps))
}
