//! From a face of `M0`, or two that meet at the rim of its shadow, to an answer with its proof.
//!
//! `docs/theory/rounding.md` derives the bounds on rounding, under *Polygon* and *Rim*.

use glam::{DVec2, DVec3};

use super::faces::{Faces, Plane};
use super::search::{ENTERED, Seen};
use colltrans_convex::answer::{Certificate, Contact, Separated, Separation, Solver, Steps};
use colltrans_convex::cast::Cast;
use colltrans_convex::setting::Setting;
use colltrans_kernel::determinant::accurate_det;
use colltrans_kernel::noise::{Noise, UNIT_VECTOR};

/// Share of a noise by which the corners of a face may be off its plane.
const THICK: f64 = 0.5;

/// By how many noises a line has to be farther from the sides than whoever measures the overlap may find it.
const CLEARLY: f64 = 2.0;

/// Least square of the length of the mean of two normals that bounds its rounding.
const BLUNT: f64 = 0.25;

/// A cast, as the faces see it.
pub(super) struct Line<'c> {
    pub(super) setting: &'c Setting<'c>,
    noise: Noise,
    pub(super) clear: Clear,
}

/// What a line has to keep clear of sides by.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Clear {
    noise: f64,
    /// The square of the distance from which on an overlap is not grazing, for certain.
    ample: f64,
}

impl Clear {
    /// Whether the line passes on the inner side of one, twice the area of whose triangle with the line is given, for
    /// certain and amply so.
    #[inline]
    pub(super) fn is_inside(&self, area: f64, from: DVec2, to: DVec2) -> bool {
        let size = from.x.abs() + from.y.abs() + to.x.abs() + to.y.abs();
        let certain = area > 2.0 * self.noise * (size + self.noise);
        certain & (area * area > self.ample * (to - from).length_squared())
    }
}

impl<'c> Line<'c> {
    #[inline]
    pub(super) fn of(cast: &'c Cast) -> Self {
        let noise = cast.setting.noise();
        let tolerance = cast.options.graze_tolerance.max(noise.touching());
        let ample = tolerance + CLEARLY * noise.point();
        let clear = Clear { noise: noise.point(), ample: ample * ample };
        Self { setting: &cast.setting, noise, clear }
    }

    /// Two across the direction, and the direction.
    #[inline]
    pub(super) fn axes(&self) -> [DVec3; 3] {
        axes(self.setting.unit)
    }
}

/// The axes of a shadow.
#[inline]
pub(super) fn axes(unit: DVec3) -> [DVec3; 3] {
    let e1 = unit.any_orthonormal_vector();
    [e1, unit.cross(e1), unit]
}

/// The contact in a face inside of whose sides the line passes for certain, unless the face is too uneven or too steep; the
/// face by its number, and as it is seen.
#[inline(always)]
#[expect(clippy::inline_always, reason = "moved about, an outcome goes through memory")]
pub(super) fn contact<S: Seen>(
    faces: &Faces,
    of: u32,
    (seen, face): (&S, u32),
    line: &Line,
    steps: Steps,
) -> Option<Contact> {
    let Line { setting, noise, .. } = *line;
    let &Plane { normal, least, thick, lowest } = faces.plane(of);
    let steepness = normal.dot(setting.direction);
    if !(thick <= THICK * noise.point() && steepness > UNIT_VECTOR * setting.length) {
        return None;
    }
    let (corners, weights, height) = pierced(seen, seen.sides(face));
    let estimate = height / setting.length;
    let distance = least + normal.dot(setting.offset);
    let per = 1.0 / steepness;
    let gap = noise.gap(0.0, 0.0) * per;
    // Not of what is not a number.
    let is_tight = estimate - distance / steepness <= gap;
    if !is_tight {
        return None;
    }
    let lowered = noise.lowered() + faces.input_excess;
    let lower = ((distance - lowered) / steepness).next_down();
    let upper = (estimate + noise.raised() / steepness).next_up();
    let certificate = Certificate {
        normal,
        lower,
        pairs: corners.map(|side| faces.pair(of, side)),
        weights,
        upper,
        rounding: gap + (noise.raised() + lowered) * per,
    };
    let translation = estimate.max(lower);
    Some(Contact::new(translation, normal, lowest, certificate, Solver::Portal, steps))
}

/// Of the triangles at a face's first corner the one that the line enters: its corners, their weights and the height.
#[inline(always)]
#[expect(clippy::inline_always, reason = "passed through memory they stall their reader")]
fn pierced<S: Seen>(seen: &S, sides: &[S::Side]) -> ([usize; 3], [f64; 3], f64) {
    let corner = |side: usize| seen.corner(&sides[side]);
    let (a, mut b, mut c) = (corner(0), corner(1), corner(2));
    let mut last = 2;
    let mut beside = accurate_det(c.truncate(), a.truncate());
    while beside < 0.0 && last + 1 < sides.len() {
        last += 1;
        (b, c) = (c, corner(last));
        beside = accurate_det(c.truncate(), a.truncate());
    }
    let parts = [
        accurate_det(b.truncate(), c.truncate()),
        beside,
        accurate_det(a.truncate(), b.truncate()),
    ];
    let per = 1.0 / (parts[0] + parts[1] + parts[2]);
    let weights = parts.map(|part| part * per);
    let [_, v, w] = weights;
    ([0, last - 1, last], weights, a.z + (b.z - a.z) * v + (c.z - a.z) * w)
}

/// A plane along a direction that touches `M0` where two faces meet.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rim {
    /// Its unit normal, inwards.
    normal: DVec3,
    /// At most `min n.m` over `M0`, up to rounding.
    least: f64,
}

impl Rim {
    /// Of a face that is entered and one that is not, which are not nearly each other's back.
    #[inline]
    pub(super) fn new(entered: &Plane, other: &Plane, unit: DVec3) -> Option<Self> {
        let along = [entered, other].map(|plane| plane.normal.dot(unit));
        let [a, b] = [(-along[1]).max(0.0), along[0]];
        let [a, b] = [a / (a + b), b / (a + b)];
        let normal = entered.normal * a + other.normal * b;
        let square = normal.length_squared();
        let blunt = square >= BLUNT && along[0] > ENTERED;
        let length = square.sqrt();
        let least = (a * entered.least + b * other.least) / length;
        blunt.then(|| Self { normal: normal / length, least })
    }
}

/// The separation that the plane at a rim proves, if others will find it proven, too.
#[inline]
pub(super) fn separated(rim: &Rim, line: &Line, steps: Steps) -> Option<Separated> {
    let noise = line.noise;
    let lowered = noise.lowered() + line.setting.input_excess();
    let margin = (rim.least + rim.normal.dot(line.setting.offset)) - lowered;
    let certificate = Separation { normal: rim.normal, margin };
    let certain = margin > 2.0 * noise.touching();
    certain.then_some(Separated::new(certificate, Solver::Portal, steps))
}
