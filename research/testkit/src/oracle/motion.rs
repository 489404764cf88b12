//! Judges first contacts of rotating bodies, with the motion as a real function of its numbers.
//!
//! Numbers are integer multiples of `2^-480`. Sums are exact. Products, roots, sine and cosine have errors of a
//! few units, which are negligible compared with the accuracy of answers, `2^-60` of the size. Only the answers
//! and the vertices of the library are used.
//!
//! - *Planes.* Each plane has the claimed gap at its time.
//! - *Intervals.* At times between two planes, the bodies are separated by the plane `(1 - x) n_a + x n_b`, by
//!   the first plane rotated with the moving body, or by the plane that is marked as sufficient alone.
//! - *Meeting.* A depth is proven by a closed surface of triangles of `M` around the origin. The origin is below all of
//!   its triangles, also in the positions of the real motion. Because the surface encloses the origin in the computed
//!   positions, it does so there too.

use std::ops::{Add, Mul, Neg, Sub};
use std::sync::LazyLock;

use colltrans::motion::{ContactProof, MotionOutcome, ProvenContact, TimedPlane};
use colltrans::{ConvexPolyhedron, Pose};
use dashu_int::IBig;
use glam::DVec3;

use crate::oracle::check::Objection;
use crate::oracle::exact::{self, Dyadic};

/// Number of fractional bits.
const BITS: usize = 480;

/// Number of intervals between two planes at whose ends they are checked.
const BETWEEN: i64 = 6;

/// A multiple of `2^-480`.
#[derive(Debug, Clone, PartialEq, PartialOrd)]
pub struct Fixed(IBig);

impl Fixed {
    /// Converts an `f64`. A number with bits below `2^-480` becomes 0.
    fn new(x: f64) -> Self {
        let exact = Dyadic::new(x);
        let finest = -(BITS as i32);
        if exact.exponent() >= finest || exact.is_zero() {
            return Self(exact.in_units_of(finest));
        }
        Self(IBig::ZERO)
    }

    /// Converts an integer.
    fn whole(n: i64) -> Self {
        Self(IBig::from(n) << BITS)
    }

    /// Returns the nearest `f64`.
    fn to_f64(&self) -> f64 {
        self.0.to_f64().value() * 2.0_f64.powi(-(BITS as i32))
    }

    /// Returns zero.
    fn zero() -> Self {
        Self(IBig::ZERO)
    }

    /// Returns the quotient.
    fn over(&self, by: &Self) -> Self {
        Self((self.0.clone() << BITS) / by.0.clone())
    }

    /// Returns the square root, by Newton's method on integers, from above.
    fn sqrt(&self) -> Self {
        let target = self.0.clone() << BITS;
        if target <= IBig::ZERO {
            return Self::zero();
        }
        let mut root: IBig = IBig::ONE << (2 * BITS);
        loop {
            let next: IBig = (root.clone() + target.clone() / root.clone()) >> 1;
            if next >= root {
                return Self(root);
            }
            root = next;
        }
    }
}

impl Add for Fixed {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }
}

impl Sub for Fixed {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self(self.0 - other.0)
    }
}

impl Neg for Fixed {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl Mul for &Fixed {
    type Output = Fixed;
    fn mul(self, other: Self) -> Fixed {
        Fixed((&self.0 * &other.0) >> BITS)
    }
}

type Vector = [Fixed; 3];

/// Converts a vector.
fn vector(v: DVec3) -> Vector {
    v.to_array().map(Fixed::new)
}

/// Returns the sum.
fn plus(a: &Vector, b: &Vector) -> Vector {
    std::array::from_fn(|k| a[k].clone() + b[k].clone())
}

/// Returns the difference.
fn minus(a: &Vector, b: &Vector) -> Vector {
    std::array::from_fn(|k| a[k].clone() - b[k].clone())
}

/// Returns the multiple by a factor.
fn times(a: &Vector, by: &Fixed) -> Vector {
    a.each_ref().map(|x| x * by)
}

/// Returns the scalar product.
fn dot(a: &Vector, b: &Vector) -> Fixed {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}

/// Returns the cross product.
fn cross(a: &Vector, b: &Vector) -> Vector {
    let part = |i: usize, j: usize| &a[i] * &b[j] - &a[j] * &b[i];
    [part(1, 2), part(2, 0), part(0, 1)]
}

/// `pi`, by Machin's formula.
static PI: LazyLock<Fixed> = LazyLock::new(|| {
    let arctan = |n: i64| {
        let (mut sum, mut power) = (Fixed::zero(), Fixed::whole(1).over(&Fixed::whole(n)));
        for k in 0..240_i64 {
            let term = power.over(&Fixed::whole(2 * k + 1));
            sum = if k % 2 == 0 { sum + term } else { sum - term };
            power = power.over(&Fixed::whole(n * n));
        }
        sum
    };
    &Fixed::whole(16) * &arctan(5) - &Fixed::whole(4) * &arctan(239)
});

/// Returns sine and cosine, by their Taylor series after removing full turns.
fn sin_cos(angle: &Fixed) -> [Fixed; 2] {
    let turn = &Fixed::whole(2) * &PI;
    let turns: IBig = angle.0.clone() / turn.0.clone();
    let r = angle.clone() - Fixed(turns * turn.0);
    let (mut sums, mut term) = ([Fixed::zero(), Fixed::zero()], Fixed::whole(1));
    for k in 0..160_i64 {
        let which = (1 - k % 2) as usize;
        let signed = if k % 4 < 2 { term.clone() } else { -term.clone() };
        sums[which] = sums[which].clone() + signed;
        term = (&term * &r).over(&Fixed::whole(k + 1));
    }
    sums
}

/// The motion of a body, by the numbers that define it. From `start` the body rotates by `angle` about an axis,
/// and translates by `way`, in a unit of time. The vector `arm` leads from a point of the axis to the origin of
/// the body's frame.
#[derive(Debug, Clone)]
pub struct Spin {
    /// The pose at time 0.
    pub start: Pose,
    /// The vector from a point of the axis to the origin of the body's frame.
    pub arm: DVec3,
    /// The axis, with a length near 1.
    pub axis: DVec3,
    /// The angle in radians.
    pub angle: f64,
    /// The translation of the axis.
    pub way: DVec3,
}

/// Returns the rotation of a body in a time span.
fn turned_by(spin: &Spin, span: &Fixed) -> impl Fn(&Vector) -> Vector + use<> {
    turn_about(spin.axis, &(&Fixed::new(spin.angle) * span))
}

/// Returns the rotation about an axis of a length near 1 by an angle.
fn turn_about(axis: DVec3, angle: &Fixed) -> impl Fn(&Vector) -> Vector + use<> {
    let axis = vector(axis);
    let length = dot(&axis, &axis).sqrt();
    let axis = axis.map(|x| x.over(&length));
    let [sin, cos] = sin_cos(angle);
    move |z| {
        let side = cross(&axis, z);
        let along = times(&axis, &(&dot(&axis, z) * &(Fixed::whole(1) - cos.clone())));
        plus(&plus(&times(z, &cos), &times(&side, &sin)), &along)
    }
}

/// Returns the vertices of a body at a time of the real motion.
fn vertices_at(body: &ConvexPolyhedron, spin: &Spin, time: f64) -> Vec<Vector> {
    points_at_time(body.vertices(), spin, &Fixed::new(time))
}

/// Returns points of a body at the time `t` after the start of the real motion.
fn points_at_time(points: &[DVec3], spin: &Spin, t: &Fixed) -> Vec<Vector> {
    let turned = turned_by(spin, t);
    let arm = vector(spin.arm);
    let base = minus(&plus(&vector(spin.start.translation()), &times(&vector(spin.way), t)), &arm);
    let columns = [0, 1, 2].map(|k| vector(spin.start.matrix().col(k)));
    let place = |y: &DVec3| {
        let y = vector(*y);
        let z = (0..3).fold(arm.clone(), |z, k| plus(&z, &times(&columns[k], &y[k])));
        plus(&base, &turned(&z))
    };
    points.iter().map(place).collect()
}

/// Number of fractional bits of returned points.
const CUT: usize = 200;

/// Rounds numbers to fewer bits, which shortens later exact arithmetic.
fn cut_bits(points: Vec<Vector>) -> Vec<exact::Vector> {
    let short = |x: Fixed| Dyadic::from_units(x.0 >> (BITS - CUT), -(CUT as i32));
    points.into_iter().map(|p| exact::Vector(p.map(short))).collect()
}

/// Returns points of a body at a time of the real motion, which starts at `since`, to `2^-200`.
pub fn points_at(points: &[DVec3], spin: &Spin, since: f64, time: f64) -> Vec<exact::Vector> {
    cut_bits(points_at_time(points, spin, &(Fixed::new(time) - Fixed::new(since))))
}

/// A joint in the chain that moves a body.
#[derive(Debug, Clone)]
pub struct Stage {
    /// The pose of the joint in its parent.
    pub origin: Pose,
    /// The axis, and whether the joint rotates; `None` if it is fixed.
    pub axis: Option<(DVec3, bool)>,
    /// The values of the joint at a row and at the next one.
    pub values: [f64; 2],
}

/// Returns points of a body moved by joints, at a fraction of the way from a row to the next one, to `2^-200`.
/// The body has `pose` in the frame of the last joint.
pub fn points_carried(
    points: &[DVec3],
    pose: &Pose,
    stages: &[Stage],
    share: f64,
) -> Vec<exact::Vector> {
    let put = |pose: &Pose, points: Vec<Vector>| -> Vec<Vector> {
        let columns = [0, 1, 2].map(|k| vector(pose.matrix().col(k)));
        let place = |p: Vector| {
            (0..3).fold(vector(pose.translation()), |z, k| plus(&z, &times(&columns[k], &p[k])))
        };
        points.into_iter().map(place).collect()
    };
    let mut all = put(pose, points.iter().map(|p| vector(*p)).collect());
    for Stage { origin, axis, values } in stages.iter().rev() {
        if let Some((axis, turns)) = axis {
            let [from, to] = values.map(Fixed::new);
            let value = from.clone() + &Fixed::new(share) * &(to - from);
            if *turns {
                let turned = turn_about(*axis, &value);
                all = all.iter().map(turned).collect();
            } else {
                let unit = vector(*axis);
                let length = dot(&unit, &unit).sqrt();
                let way = times(&unit.map(|x| x.over(&length)), &value);
                all = all.iter().map(|p| plus(p, &way)).collect();
            }
        }
        all = put(origin, all);
    }
    cut_bits(all)
}

/// Two bodies and their motions.
#[derive(Debug)]
pub struct MotionJudge<'a> {
    /// The moving and the fixed body.
    pub bodies: [&'a ConvexPolyhedron; 2],
    /// Their motions.
    pub spins: [Spin; 2],
    /// The minimum gap; if negative, the tolerated depth.
    pub min_gap: f64,
}

impl MotionJudge<'_> {
    /// Returns the vertices of both bodies at a time.
    fn places(&self, time: f64) -> [Vec<Vector>; 2] {
        [0, 1].map(|k| vertices_at(self.bodies[k], &self.spins[k], time))
    }

    /// Checks whether a plane with this normal leaves at least the minimum gap plus `more`.
    fn parts(&self, places: &[Vec<Vector>; 2], normal: &Vector, more: f64) -> bool {
        self.left(places, normal, more).is_some_and(|left| left >= Fixed::zero())
    }

    /// Returns the remaining distance along a normal beyond the minimum gap plus `more`, times the length of
    /// the normal.
    fn left(&self, [p, q]: &[Vec<Vector>; 2], normal: &Vector, more: f64) -> Option<Fixed> {
        let low = q.iter().map(|x| dot(normal, x)).reduce(|a, b| if b < a { b } else { a });
        let high = p.iter().map(|x| dot(normal, x)).reduce(|a, b| if b > a { b } else { a });
        let (low, high) = (low?, high?);
        let asked = &(Fixed::new(self.min_gap) + Fixed::new(more)) * &dot(normal, normal).sqrt();
        Some(low - high - asked)
    }

    /// Checks an answer by its proof.
    ///
    /// # Errors
    /// [`Objection`] with the first statement that is false.
    pub fn check(&self, outcome: &MotionOutcome) -> Result<(), Objection> {
        let proof = outcome.proof();
        let object = |what: String| Err(Objection(what));
        for planes in &proof.spans {
            for plane in planes {
                let left = self.left(&self.places(plane.time), &vector(plane.normal), plane.gap);
                let left = left.map_or(f64::NEG_INFINITY, |left| left.to_f64());
                if left < 0.0 {
                    return object(format!(
                        "the plane at {} does not have a gap of {:e}: {left:e} remains",
                        plane.time, plane.gap
                    ));
                }
            }
            for pair in planes.windows(2) {
                self.between(&pair[0], &pair[1])?;
            }
        }
        let reached = proof.spans.iter().flatten().last().map(|plane| plane.time);
        let claimed = match outcome {
            MotionOutcome::Contact(of)
            | MotionOutcome::Grazing(of)
            | MotionOutcome::Undecided(of) => of.lower,
            MotionOutcome::Overlapping(_) => return self.meets(proof.meeting.as_ref()),
            _ => 1.0,
        };
        if reached.unwrap_or(0.0) != claimed {
            return object(format!("proven up to {reached:?}, claimed up to {claimed}"));
        }
        match (outcome, &proof.meeting) {
            (MotionOutcome::Contact(of), Some(meeting)) if of.upper == meeting.time => {
                self.meets(Some(meeting))
            }
            (MotionOutcome::Contact(_), _) => object("a contact that is not proven".into()),
            _ => Ok(()),
        }
    }

    /// Checks the interval between two planes.
    fn between(&self, a: &TimedPlane, b: &TimedPlane) -> Result<(), Objection> {
        for k in 1..BETWEEN {
            let share = k as f64 / BETWEEN as f64;
            let time = a.time + share * (b.time - a.time);
            if time <= a.time || time >= b.time {
                continue;
            }
            let x = (Fixed::new(time) - Fixed::new(a.time))
                .over(&(Fixed::new(b.time) - Fixed::new(a.time)));
            let [n, m] = [a, b].map(|plane| vector(plane.normal));
            let mixed = plus(&n, &times(&minus(&m, &n), &x));
            let places = self.places(time);
            let carried =
                || turned_by(&self.spins[0], &(Fixed::new(time) - Fixed::new(a.time)))(&n);
            let parts = if a.alone {
                self.parts(&places, &n, 0.0)
            } else {
                self.parts(&places, &mixed, 0.0) || self.parts(&places, &carried(), 0.0)
            };
            if !parts {
                return Err(Objection(format!("no plane separates the bodies at {time}")));
            }
        }
        Ok(())
    }

    /// Checks the proof of a meeting.
    fn meets(&self, meeting: Option<&ProvenContact>) -> Result<(), Objection> {
        let Some(ProvenContact { time, met }) = meeting else {
            return Err(Objection("the proof of the meeting is missing".into()));
        };
        let places = self.places(*time);
        let difference = |pair: &colltrans::VertexPair| {
            minus(&places[1][pair.fixed.index()], &places[0][pair.moving.index()])
        };
        let holds = match met {
            ContactProof::Deep(depth) => {
                let surface = &depth.enclosure;
                let least = Fixed::new((-self.min_gap).max(0.0));
                surface.triangles.iter().zip(&surface.normals).all(|(corners, normal)| {
                    let normal = vector(*normal);
                    let asked = &least * &dot(&normal, &normal).sqrt();
                    corners
                        .iter()
                        .all(|k| dot(&normal, &difference(&surface.pairs[*k as usize])) > asked)
                })
            }
            ContactProof::Near(near) => {
                let total: f64 = near.weights.iter().sum();
                let weight = |w: f64| Fixed::new(w).over(&Fixed::new(total));
                let apart = near
                    .pairs
                    .iter()
                    .zip(near.weights)
                    .fold([0; 3].map(|_| Fixed::zero()), |sum, (pair, w)| {
                        plus(&sum, &times(&difference(pair), &weight(w)))
                    });
                dot(&apart, &apart).sqrt() <= Fixed::new(self.min_gap)
            }
        };
        if holds { Ok(()) } else { Err(Objection(format!("the bodies do not meet at {time}"))) }
    }
}
