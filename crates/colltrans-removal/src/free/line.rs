//! Great circles of directions: planes through the origin, as linear forms that are positive on one side.
//!
//! - The form of three points `a, b, c` is `det[b - a, c - a, d]`. Its sign is the side of the line through
//!   the shadows of `a` and `b` along `d` on which the shadow of `c` lies.
//! - Forms are stored rounded with an error bound. Signs are exact: they come from the rounded form if its
//!   error permits, and otherwise from exact integers. If the form was computed without rounding, integers of
//!   one or two limbs suffice.
//! - Lines that share two vertices intersect along the difference of these. A query about such an
//!   intersection uses this difference instead of cross products. A third line through both vertices contains
//!   the intersection.

use std::cmp::Ordering;

use glam::DVec3;

use super::bodies::Bodies;
use colltrans_kernel::error_free::{difference_error, product_error};
use colltrans_kernel::integer::{Integer, LARGE, SMALL, determinant, difference};
use colltrans_kernel::predicates::sign;

const U: f64 = f64::EPSILON / 2.0;

/// Vertex of one of two bodies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PlaneVertex {
    /// Whether the vertex belongs to the moving body.
    pub moving: bool,
    /// Index into [`Solid::vertices`](colltrans_solid::Solid::vertices).
    pub vertex: u32,
}

/// Direction in an exact representation.
#[derive(Debug, Clone, Copy)]
pub(super) enum Ray {
    Exactly(DVec3),
    /// From one vertex to another.
    Toward([PlaneVertex; 2]),
    /// The cross product of two forms.
    Crossing([Line; 2]),
}

/// Great circle, as a linear form on directions.
#[derive(Debug, Clone, Copy)]
pub(super) struct Line {
    /// Form, scaled by a power of two to components of at most 2.
    pub(super) form: DVec3,
    /// Upper bound on the error of each component. The form is exact if the bound is 0.
    pub(super) error: f64,
    /// Vertices that span the line, if any.
    spots: Option<[PlaneVertex; 3]>,
}

/// Computes the cross product of two differences. The flag states whether it is exact.
fn cross(x: DVec3, y: DVec3) -> (DVec3, bool) {
    let minor = |i: usize, j: usize| {
        let (p, q) = (x[i] * y[j], x[j] * y[i]);
        let exact = product_error(x[i], y[j], p) == 0.0
            && product_error(x[j], y[i], q) == 0.0
            && difference_error(p, q) == 0.0;
        (p - q, exact)
    };
    let [a, b, c] = [minor(1, 2), minor(2, 0), minor(0, 1)];
    (DVec3::new(a.0, b.0, c.0), a.1 && b.1 && c.1)
}

/// Returns the power of two that scales a number to the range from 1 to 2. Returns 1 for zero, subnormal numbers
/// and the largest exponents.
fn scale(x: f64) -> f64 {
    let exponent = (x.to_bits() >> 52 & 0x7ff) as i32;
    if (1..2046).contains(&exponent) {
        f64::from_bits(((2046 - exponent) as u64) << 52)
    } else {
        1.0
    }
}

impl Line {
    /// Builds the line through three vertices.
    pub(super) fn of(bodies: &Bodies, spots: [PlaneVertex; 3]) -> Self {
        let [a, b, c] = spots.map(|spot| bodies.corner(spot));
        let (x, y) = (b.at - a.at, c.at - a.at);
        let lost = |p: DVec3, q: DVec3| (0..3).any(|k| difference_error(p[k], q[k]) != 0.0);
        let rounded = !(a.exact && b.exact && c.exact) || lost(b.at, a.at) || lost(c.at, a.at);
        let (form, exact) = cross(x, y);
        let spots = Some(spots);
        if !rounded && exact {
            let factor = scale(form.abs().max_element());
            return Self { form: form * factor, error: 0.0, spots };
        }
        let (m, n) = (x.abs().max_element(), y.abs().max_element());
        let noise = |p: bool, q: bool| (f64::from(!p) + f64::from(!q)) * bodies.scene.noise;
        let (e, f) = (noise(a.exact, b.exact) + 2.0 * U * m, noise(a.exact, c.exact) + 2.0 * U * n);
        let error = 2.02 * (e * n + f * m + e * f) + 8.0 * U * m * n + f64::MIN_POSITIVE;
        let factor = scale(form.abs().max_element().max(error));
        Self { form: form * factor, error: error * factor, spots }
    }

    /// Builds a line with an exact form.
    pub(super) fn exactly(form: DVec3) -> Self {
        Self { form, error: 0.0, spots: None }
    }

    /// Returns the exact side on which a direction lies. Returns `Equal` if numbers are too large for exact
    /// arithmetic.
    pub(super) fn side(&self, bodies: &Bodies, d: DVec3) -> Ordering {
        let value = self.form.dot(d);
        let (size, terms) = (d.abs().element_sum(), (self.form * d).abs().element_sum());
        if value.abs() > self.error * size + 4.0 * U * terms + f64::MIN_POSITIVE {
            return sign(value);
        }
        self.wide_side::<SMALL>(bodies, d)
            .or_else(|| self.wide_side::<LARGE>(bodies, d))
            .unwrap_or(Ordering::Equal)
    }

    fn wide_side<const N: usize>(&self, bodies: &Bodies, d: DVec3) -> Option<Ordering> {
        let form = self.wide::<N>(bodies);
        let term = |k: usize| form[k].multiply(&Integer::number(d[k]));
        term(0).add(&term(1)).add(&term(2)).sign()
    }

    /// Returns the form in exact integers, up to a positive factor.
    pub(super) fn wide<const N: usize>(&self, bodies: &Bodies) -> [Integer<N>; 3] {
        let Some(spots) = self.spots.filter(|_| self.error > 0.0) else {
            return self.form.to_array().map(Integer::number);
        };
        let [a, b, c] = spots.map(|spot| bodies.wide::<N>(spot));
        let (x, y) = (difference(&b, &a), difference(&c, &a));
        wide_cross(&x, &y)
    }

    /// Returns the vertices that span the line; `None` for a line with an exact form.
    pub(super) fn vertices(&self) -> Option<[PlaneVertex; 3]> {
        self.spots
    }

    /// Returns the line with both sides exchanged.
    pub(super) fn reversed(&self) -> Self {
        let spots = self.spots.map(|[a, b, c]| [a, c, b]);
        Self { form: -self.form, error: self.error, spots }
    }

    /// Returns the exact side on which a direction lies. Returns `Equal` if numbers are too large for exact
    /// arithmetic.
    pub(super) fn side_of_ray(&self, bodies: &Bodies, ray: &Ray) -> Ordering {
        match ray {
            Ray::Exactly(d) => self.side(bodies, *d),
            Ray::Toward(ends) => self.side_of(bodies, *ends),
            Ray::Crossing([a, b]) => orientation(bodies, [a, b, self]).unwrap_or(Ordering::Equal),
        }
    }

    /// Checks exactly whether another line is the same great circle, in either orientation.
    pub(super) fn is_along(&self, bodies: &Bodies, other: &Self) -> bool {
        let way = self.form.cross(other.form).abs().max_element();
        // Components are at most 2.
        if way > 4.04 * (self.error + other.error + self.error * other.error) + 32.0 * U {
            return false;
        }
        self.is_along_exactly::<SMALL>(bodies, other)
            .or_else(|| self.is_along_exactly::<LARGE>(bodies, other))
            .unwrap_or(true)
    }

    fn is_along_exactly<const N: usize>(&self, bodies: &Bodies, other: &Self) -> Option<bool> {
        let way = wide_cross(&self.wide::<N>(bodies), &other.wide::<N>(bodies));
        let signs = way.map(|component| component.sign());
        signs.iter().all(Option::is_some).then(|| signs == [Some(Ordering::Equal); 3])
    }

    /// Returns two vertices that two lines share, in whose difference they intersect. Returns `None` if they
    /// do not share exactly two.
    pub(super) fn shared(&self, other: &Self) -> Option<[PlaneVertex; 2]> {
        let (own, others) = (self.spots?, other.spots?);
        let mut both = own.into_iter().filter(|spot| others.contains(spot));
        let found = [both.next()?, both.next()?];
        both.next().is_none().then_some(found)
    }

    /// Returns the exact side on which the direction from one vertex to another lies.
    pub(super) fn side_of(&self, bodies: &Bodies, [from, to]: [PlaneVertex; 2]) -> Ordering {
        if self.spots.is_some_and(|own| own.contains(&from) && own.contains(&to)) {
            return Ordering::Equal;
        }
        let (way, doubt) = bodies.way([from, to]);
        let value = self.form.dot(way);
        let (size, terms) = (way.abs().element_sum(), (self.form * way).abs().element_sum());
        let form = self.form.abs().element_sum();
        let error = self.error * (size + 3.0 * doubt) + form * doubt;
        if value.abs() > 1.01 * error + 4.0 * U * terms + f64::MIN_POSITIVE {
            return sign(value);
        }
        self.wide_side_of::<SMALL>(bodies, [from, to])
            .or_else(|| self.wide_side_of::<LARGE>(bodies, [from, to]))
            .unwrap_or(Ordering::Equal)
    }

    fn wide_side_of<const N: usize>(
        &self,
        bodies: &Bodies,
        ends: [PlaneVertex; 2],
    ) -> Option<Ordering> {
        let (form, way) = (self.wide::<N>(bodies), bodies.wide_way::<N>(ends));
        let term = |k: usize| form[k].multiply(&way[k]);
        term(0).add(&term(1)).add(&term(2)).sign()
    }
}

/// Returns the cross product in exact integers.
pub(super) fn wide_cross<const N: usize>(
    x: &[Integer<N>; 3],
    y: &[Integer<N>; 3],
) -> [Integer<N>; 3] {
    [[1, 2], [2, 0], [0, 1]].map(|[i, j]| x[i].multiply(&y[j]).subtract(&x[j].multiply(&y[i])))
}

/// Returns the sign of the determinant of three forms. Returns `None` if numbers are too large for exact
/// arithmetic.
pub(super) fn orientation(bodies: &Bodies, lines: [&Line; 3]) -> Option<Ordering> {
    let [a, b, c] = lines.map(|line| line.form);
    let value = a.cross(b).dot(c);
    let sizes = lines.map(|line| line.form.abs().max_element());
    let product = |errors: [f64; 3]| (0..3).map(|k| sizes[k] + errors[k]).product::<f64>();
    let (least, most) = (product([0.0; 3]), product(lines.map(|line| line.error)));
    if value.abs() > 6.06 * (most - least) + 64.0 * U * most + f64::MIN_POSITIVE {
        return Some(sign(value));
    }
    wide_orientation::<SMALL>(bodies, lines).or_else(|| wide_orientation::<LARGE>(bodies, lines))
}

fn wide_orientation<const N: usize>(bodies: &Bodies, lines: [&Line; 3]) -> Option<Ordering> {
    let [a, b, c] = lines.map(|line| line.wide::<N>(bodies));
    determinant(&a, &b, &c).sign()
}
