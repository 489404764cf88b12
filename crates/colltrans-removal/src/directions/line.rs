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
use colltrans_kernel::integer::{Integer, LARGE_LIMBS, SMALL_LIMBS, determinant, difference};
use colltrans_kernel::predicates::sign_of;

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
    vertices: Option<[PlaneVertex; 3]>,
}

/// Computes the cross product of two differences. The flag states whether it was computed without rounding.
fn rounded_cross(x: DVec3, y: DVec3) -> (DVec3, bool) {
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
fn unit_scale(x: f64) -> f64 {
    let exponent = (x.to_bits() >> 52 & 0x7ff) as i32;
    if (1..2046).contains(&exponent) {
        f64::from_bits(((2046 - exponent) as u64) << 52)
    } else {
        1.0
    }
}

impl Line {
    /// Builds the line through three vertices.
    pub(super) fn through(bodies: &Bodies, vertices: [PlaneVertex; 3]) -> Self {
        let [a, b, c] = vertices.map(|vertex| bodies.placed_vertex(vertex));
        let (x, y) = (b.at - a.at, c.at - a.at);
        let lost = |p: DVec3, q: DVec3| (0..3).any(|k| difference_error(p[k], q[k]) != 0.0);
        let rounded = !(a.exact && b.exact && c.exact) || lost(b.at, a.at) || lost(c.at, a.at);
        let (form, exact) = rounded_cross(x, y);
        let vertices = Some(vertices);
        if !rounded && exact {
            let factor = unit_scale(form.abs().max_element());
            return Self { form: form * factor, error: 0.0, vertices };
        }
        let (m, n) = (x.abs().max_element(), y.abs().max_element());
        let noise = |p: bool, q: bool| (f64::from(!p) + f64::from(!q)) * bodies.scene.noise;
        let (e, f) = (noise(a.exact, b.exact) + 2.0 * U * m, noise(a.exact, c.exact) + 2.0 * U * n);
        let error = 2.02 * (e * n + f * m + e * f) + 8.0 * U * m * n + f64::MIN_POSITIVE;
        let factor = unit_scale(form.abs().max_element().max(error));
        Self { form: form * factor, error: error * factor, vertices }
    }

    /// Builds a line with an exact form.
    pub(super) fn from_exact_form(form: DVec3) -> Self {
        Self { form, error: 0.0, vertices: None }
    }

    /// Returns the exact side on which a direction lies. Returns `Equal` if numbers are too large for exact
    /// arithmetic.
    pub(super) fn side_of_direction(&self, bodies: &Bodies, d: DVec3) -> Ordering {
        let value = self.form.dot(d);
        let (size, terms) = (d.abs().element_sum(), (self.form * d).abs().element_sum());
        if value.abs() > self.error * size + 4.0 * U * terms + f64::MIN_POSITIVE {
            return sign_of(value);
        }
        self.exact_side::<SMALL_LIMBS>(bodies, d)
            .or_else(|| self.exact_side::<LARGE_LIMBS>(bodies, d))
            .unwrap_or(Ordering::Equal)
    }

    fn exact_side<const N: usize>(&self, bodies: &Bodies, d: DVec3) -> Option<Ordering> {
        let form = self.exact_form::<N>(bodies);
        let term = |k: usize| form[k].multiply(&Integer::exact_number(d[k]));
        term(0).add(&term(1)).add(&term(2)).sign()
    }

    /// Returns the form in exact integers, up to a positive factor.
    pub(super) fn exact_form<const N: usize>(&self, bodies: &Bodies) -> [Integer<N>; 3] {
        let Some(vertices) = self.vertices.filter(|_| self.error > 0.0) else {
            return self.form.to_array().map(Integer::exact_number);
        };
        let [a, b, c] = vertices.map(|vertex| bodies.exact_position::<N>(vertex));
        let (x, y) = (difference(&b, &a), difference(&c, &a));
        exact_cross(&x, &y)
    }

    /// Returns the vertices that span the line; `None` for a line with an exact form.
    pub(super) fn spanning_vertices(&self) -> Option<[PlaneVertex; 3]> {
        self.vertices
    }

    /// Returns the line with both sides exchanged.
    pub(super) fn reversed(&self) -> Self {
        let vertices = self.vertices.map(|[a, b, c]| [a, c, b]);
        Self { form: -self.form, error: self.error, vertices }
    }

    /// Returns the exact side on which a direction lies. Returns `Equal` if numbers are too large for exact
    /// arithmetic.
    pub(super) fn side_of_ray(&self, bodies: &Bodies, ray: &Ray) -> Ordering {
        match ray {
            Ray::Exactly(d) => self.side_of_direction(bodies, *d),
            Ray::Toward(ends) => self.side_of_displacement(bodies, *ends),
            Ray::Crossing([a, b]) => orientation(bodies, [a, b, self]).unwrap_or(Ordering::Equal),
        }
    }

    /// Checks exactly whether another line is the same great circle, in either orientation. Returns `true` if
    /// numbers are too large for exact arithmetic.
    pub(super) fn is_same_circle(&self, bodies: &Bodies, other: &Self) -> bool {
        let vector = self.form.cross(other.form).abs().max_element();
        // Components are at most 2.
        if vector > 4.04 * (self.error + other.error + self.error * other.error) + 32.0 * U {
            return false;
        }
        self.is_same_circle_exactly::<SMALL_LIMBS>(bodies, other)
            .or_else(|| self.is_same_circle_exactly::<LARGE_LIMBS>(bodies, other))
            .unwrap_or(true)
    }

    fn is_same_circle_exactly<const N: usize>(
        &self,
        bodies: &Bodies,
        other: &Self,
    ) -> Option<bool> {
        let vector = exact_cross(&self.exact_form::<N>(bodies), &other.exact_form::<N>(bodies));
        let signs = vector.map(|component| component.sign());
        signs.iter().all(Option::is_some).then(|| signs == [Some(Ordering::Equal); 3])
    }

    /// Returns two vertices that two lines share, in whose difference they intersect. Returns `None` if they
    /// do not share exactly two.
    pub(super) fn shared_vertices(&self, other: &Self) -> Option<[PlaneVertex; 2]> {
        let (own, others) = (self.vertices?, other.vertices?);
        let mut both = own.into_iter().filter(|vertex| others.contains(vertex));
        let found = [both.next()?, both.next()?];
        both.next().is_none().then_some(found)
    }

    /// Returns the side of this line on which the direction from one vertex to another lies, exactly. Returns
    /// `Equal` if numbers are too large for exact arithmetic.
    pub(super) fn side_of_displacement(
        &self,
        bodies: &Bodies,
        [from, to]: [PlaneVertex; 2],
    ) -> Ordering {
        if self.vertices.is_some_and(|own| own.contains(&from) && own.contains(&to)) {
            return Ordering::Equal;
        }
        let (vector, doubt) = bodies.displacement([from, to]);
        let value = self.form.dot(vector);
        let (size, terms) = (vector.abs().element_sum(), (self.form * vector).abs().element_sum());
        let form = self.form.abs().element_sum();
        let error = self.error * (size + 3.0 * doubt) + form * doubt;
        if value.abs() > 1.01 * error + 4.0 * U * terms + f64::MIN_POSITIVE {
            return sign_of(value);
        }
        self.exact_side_of_displacement::<SMALL_LIMBS>(bodies, [from, to])
            .or_else(|| self.exact_side_of_displacement::<LARGE_LIMBS>(bodies, [from, to]))
            .unwrap_or(Ordering::Equal)
    }

    fn exact_side_of_displacement<const N: usize>(
        &self,
        bodies: &Bodies,
        ends: [PlaneVertex; 2],
    ) -> Option<Ordering> {
        let (form, vector) = (self.exact_form::<N>(bodies), bodies.exact_displacement::<N>(ends));
        let term = |k: usize| form[k].multiply(&vector[k]);
        term(0).add(&term(1)).add(&term(2)).sign()
    }
}

/// Returns the cross product in exact integers.
pub(super) fn exact_cross<const N: usize>(
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
        return Some(sign_of(value));
    }
    exact_orientation::<SMALL_LIMBS>(bodies, lines)
        .or_else(|| exact_orientation::<LARGE_LIMBS>(bodies, lines))
}

fn exact_orientation<const N: usize>(bodies: &Bodies, lines: [&Line; 3]) -> Option<Ordering> {
    let [a, b, c] = lines.map(|line| line.exact_form::<N>(bodies));
    determinant(&a, &b, &c).sign()
}
