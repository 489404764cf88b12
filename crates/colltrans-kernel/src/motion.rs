//! Motions: where a body is at every time from 0 to 1.
//!
//! Notation. In a *piece*, from the time `s` on, the body's frame has the rotation `E(t) R` and the
//! translation `T + v (t - s) + (E(t) - 1) a`, where `R`, `T` is its pose at `s`, `E(t)` the rotation by `w
//! (t - s)` about the axis `k`, and `a`, the *arm*, the way from a point of the axis to `T`: so a point of
//! the axis, and each point that is fixed to the body, moves on a helix about an axis that itself moves along
//! `v`.
//!
//! The numbers `s, R, T, a, k, w, v` *define* a motion, as real numbers: `k` counts as if its length were
//! exactly 1. `Piece::error` bounds how far what is computed of it is off.
//!
//! A motion of several pieces begins each where the numbers of that piece say, which is where the one before
//! it ends, to rounding.

use glam::{DMat3, DQuat, DVec3};

use crate::angle::{self, Turn, turn};
use crate::error::MotionError;
use crate::error_free::{difference_error, product_error};
use crate::noise;
use crate::pose::Pose;
use crate::range::{MIN_MAGNITUDE, in_exact_range};

/// Less than this a rotation between poses is none: the angle is within rounding of 0.
const NO_TURN: f64 = 1e-15;

/// Where a body is at every time from 0 to 1.
///
/// ```
/// use colltrans::glam::DVec3;
/// use colltrans::motion::Motion;
/// use colltrans::Pose;
///
/// // A door swings by a quarter turn about the z axis.
/// let door = Motion::turn(Pose::IDENTITY, DVec3::ZERO, DVec3::Z, std::f64::consts::FRAC_PI_2)?;
/// let end = door.at(1.0)?;
/// assert!(end.transform_point(DVec3::X).distance(DVec3::Y) < 1e-15);
/// # Ok::<(), colltrans::motion::MotionError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(into = "Vec<PieceRecord>", try_from = "Vec<PieceRecord>")
)]
pub struct Motion {
    /// At least one, the first from time 0.
    pieces: Vec<Piece>,
}

/// A piece of a [`Motion`]: an even turn about an axis that moves evenly, from one time on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Piece {
    /// The time at which the piece begins.
    pub since: f64,
    /// The pose at that time.
    pub start: Pose,
    /// The vector from a point of the axis to the origin of the body's frame, in world units.
    pub arm: DVec3,
    /// The direction of the axis: a unit vector, to rounding.
    pub axis: DVec3,
    /// The angular velocity about the axis, in radians in a unit of time.
    pub rate: f64,
    /// The velocity of the axis, in world units in a unit of time.
    pub velocity: DVec3,
}

/// Where a piece has brought its body: the rotation, and how far the frame has moved.
#[derive(Debug, Clone, Copy)]
pub struct Moved {
    /// The rotation.
    pub rotation: DMat3,
    /// How far the frame has moved.
    pub by: DVec3,
    /// The arm, turned.
    pub arm: DVec3,
}

impl Motion {
    /// None: the body rests at a pose.
    #[inline]
    pub fn still(pose: Pose) -> Self {
        Self { pieces: vec![Piece::resting(pose)] }
    }

    /// A translation by a vector, in world units.
    ///
    /// # Errors
    /// A vector that is not finite or out of range.
    #[inline]
    pub fn slide(pose: Pose, by: DVec3) -> Result<Self, MotionError> {
        Self::of(Piece { velocity: by, ..Piece::resting(pose) })
    }

    /// By the numbers that define it: from a point of the axis to the origin of the body's frame leads `arm`; the body
    /// turns about the axis by `angle` in radians, and the axis moves by `way`, in world units.
    ///
    /// The axis counts as if its length were exactly 1, and is one divided by its length here, unless that is 1 to
    /// rounding.
    ///
    /// # Errors
    /// As [`Self::turn`].
    #[inline]
    pub fn about(
        pose: Pose,
        arm: DVec3,
        axis: DVec3,
        angle: f64,
        way: DVec3,
    ) -> Result<Self, MotionError> {
        let is_unit = (axis.length() - 1.0).abs() <= noise::UNIT_VECTOR;
        let axis = if is_unit { axis } else { unit("axis", axis)? };
        Self::of(Piece { arm, axis, rate: angle, velocity: way, ..Piece::resting(pose) })
    }

    /// A turn about an axis through a point of the world, by an angle in radians, counter-clockwise as seen
    /// against the axis.
    ///
    /// # Errors
    /// An axis that is zero, numbers that are not finite or out of range, an angle beyond 1e5.
    #[inline]
    pub fn turn(pose: Pose, point: DVec3, axis: DVec3, angle: f64) -> Result<Self, MotionError> {
        Self::screw(pose, point, axis, angle, 0.0)
    }

    /// A turn about an axis, which itself moves along its own direction by `rise`, in world units.
    ///
    /// # Errors
    /// As [`Self::turn`].
    #[inline]
    pub fn screw(
        pose: Pose,
        point: DVec3,
        axis: DVec3,
        angle: f64,
        rise: f64,
    ) -> Result<Self, MotionError> {
        let axis = unit("axis", axis)?;
        check("point", point)?;
        let arm = pose.translation() - point;
        Self::of(Piece { arm, axis, rate: angle, velocity: axis * rise, ..Piece::resting(pose) })
    }

    /// A point of the body, given in the world, moves along a straight line by `velocity`, and the body turns
    /// about it by the angular velocity's length in radians, about its direction: as what is thrown does
    /// without gravity, in a unit of time.
    ///
    /// # Errors
    /// As [`Self::turn`]; an angular velocity of zero is none.
    #[inline]
    pub fn thrown(
        pose: Pose,
        center: DVec3,
        velocity: DVec3,
        angular_velocity: DVec3,
    ) -> Result<Self, MotionError> {
        if angular_velocity == DVec3::ZERO {
            return Self::slide(pose, velocity);
        }
        check("center", center)?;
        let axis = unit("angular velocity", angular_velocity)?;
        let rate = angular_velocity.length();
        let arm = pose.translation() - center;
        Self::of(Piece { arm, axis, rate, velocity, ..Piece::resting(pose) })
    }

    /// The screw from one pose to another, by the shorter turn; it ends there to rounding.
    ///
    /// # Errors
    /// Poses between which the axis is out of range.
    #[inline]
    pub fn between(from: Pose, to: Pose) -> Result<Self, MotionError> {
        Self::through(&[from, to])
    }

    /// Screws from each pose to the next one, in equal times.
    ///
    /// # Errors
    /// No poses; as [`Self::between`].
    #[inline]
    pub fn through(poses: &[Pose]) -> Result<Self, MotionError> {
        let [first, ..] = poses else { return Err(MotionError::NoPoses) };
        let count = poses.len() - 1;
        if count == 0 {
            return Ok(Self::still(*first));
        }
        let time = |k: usize| k as f64 / count as f64;
        let pieces = poses.windows(2).enumerate().map(|(k, pair)| {
            let span = time(k + 1) - time(k);
            let whole = screw_between(&pair[0], &pair[1]);
            let [rate, velocity] = [DVec3::splat(whole.rate / span), whole.velocity / span];
            Piece { since: time(k), rate: rate.x, velocity, ..whole }.checked()
        });
        Ok(Self { pieces: pieces.collect::<Result<_, _>>()? })
    }

    #[inline]
    fn of(piece: Piece) -> Result<Self, MotionError> {
        Ok(Self { pieces: vec![piece.checked()?] })
    }

    /// Where the body is at a time from 0 to 1, to rounding; the same bits on every platform.
    ///
    /// # Errors
    /// A time beyond, a place out of range.
    #[inline]
    pub fn at(&self, time: f64) -> Result<Pose, MotionError> {
        if !(0.0..=1.0).contains(&time) {
            return Err(MotionError::Time { time });
        }
        let piece = &self.pieces[self.pieces.partition_point(|p| p.since <= time).max(1) - 1];
        let Moved { rotation, by, .. } = piece.at(time);
        Ok(Pose::from_matrix(rotation, piece.start.translation() + by)?)
    }

    /// Where the body is at time 0.
    #[inline]
    pub fn start(&self) -> Pose {
        self.pieces[0].start
    }

    /// Returns the pieces that define the motion, in the order of time; the first begins at time 0.
    #[inline]
    pub fn pieces(&self) -> &[Piece] {
        &self.pieces
    }
}

impl Piece {
    #[inline]
    fn resting(start: Pose) -> Self {
        let [arm, velocity] = [DVec3::ZERO; 2];
        Self { since: 0.0, start, arm, axis: DVec3::Z, rate: 0.0, velocity }
    }

    #[inline]
    fn checked(self) -> Result<Self, MotionError> {
        check("arm", self.arm)?;
        check("displacement", self.velocity)?;
        if self.rate.is_nan() || self.rate.abs() > angle::MOST {
            return Err(MotionError::Angle { angle: self.rate });
        }
        Ok(self)
    }

    /// Where the body is at a time that is not before the piece.
    #[inline]
    #[doc(hidden)]
    pub fn at(&self, time: f64) -> Moved {
        let span = time - self.since;
        let way = self.velocity * span;
        if self.rate == 0.0 {
            return Moved { rotation: self.start.matrix(), by: flushed(way), arm: self.arm };
        }
        let angle = self.rate * span;
        let low =
            product_error(self.rate, span, angle) + self.rate * difference_error(time, self.since);
        let turn = turn(angle, if low.is_finite() { low } else { 0.0 });
        let swung = self.swing(&turn, self.arm);
        let start = self.start.matrix();
        let turned = |column: DVec3| flushed(column + self.swing(&turn, column));
        Moved {
            rotation: DMat3::from_cols(
                turned(start.x_axis),
                turned(start.y_axis),
                turned(start.z_axis),
            ),
            by: flushed(way + swung),
            arm: self.arm + swung,
        }
    }

    /// `(E - 1) z`.
    #[inline]
    fn swing(&self, turn: &Turn, z: DVec3) -> DVec3 {
        let across = self.axis.cross(z);
        across * turn.sin + self.axis.cross(across) * turn.versine
    }

    /// The velocity of a point of the body, from where the axis is.
    #[inline]
    #[doc(hidden)]
    pub fn velocity_of(&self, from_axis: DVec3) -> DVec3 {
        self.velocity + self.axis.cross(from_axis) * self.rate
    }

    /// How far points of a body, at most `reach` from the origin of its frame, may be from where the motion's
    /// numbers have them, as computed up to some time after the piece began.
    #[doc(hidden)]
    #[inline]
    pub fn error(&self, reach: f64, span: f64) -> f64 {
        let turned = if self.rate == 0.0 { 0.0 } else { reach };
        let swung = self.arm.length() * (self.rate.abs() * span).min(1.0);
        noise::POSE * (turned + swung) + noise::WAY * self.velocity.length() * span
    }
}

/// The screw from one pose to the other in a unit of time, from time 0; a slide, if they hardly turn.
#[inline]
fn screw_between(from: &Pose, to: &Pose) -> Piece {
    let resting = Piece::resting(*from);
    let way = to.translation() - from.translation();
    let mut turn = DQuat::from_mat3(&(to.matrix() * from.matrix().transpose())).normalize();
    if turn.w < 0.0 {
        turn = -turn;
    }
    let imaginary = turn.xyz();
    let sine = imaginary.length();
    if sine <= NO_TURN {
        return Piece { velocity: way, ..resting };
    }
    let axis = imaginary / sine;
    let half = arc_tangent(sine, turn.w);
    // (E - 1) a is the part of the way across the axis.
    let rise = axis * axis.dot(way);
    let across = way - rise;
    let arm = (axis.cross(across) * (-turn.w / sine) - across) * 0.5;
    Piece { arm, axis, rate: 2.0 * half, velocity: rise, ..resting }
}

/// The angle in the first quadrant with this sine and cosine, by Newton's steps on our own sine.
#[inline]
fn arc_tangent(sine: f64, cosine: f64) -> f64 {
    // Off by less than 0.05 to begin with.
    let mut angle = if sine < cosine { sine / cosine.max(0.5) } else { 1.57 - cosine / sine };
    for _ in 0..8 {
        let t = turn(angle, 0.0);
        angle += (sine * t.cos - cosine * t.sin) / (sine * sine + cosine * cosine).sqrt();
    }
    angle
}

/// The direction of a vector.
#[inline]
fn unit(what: &'static str, vector: DVec3) -> Result<DVec3, MotionError> {
    check(what, vector)?;
    if flushed(vector) == DVec3::ZERO {
        return Err(MotionError::Number { what, vector });
    }
    Ok(vector / vector.length())
}

#[inline]
fn check(what: &'static str, vector: DVec3) -> Result<(), MotionError> {
    if in_exact_range(flushed(vector)) { Ok(()) } else { Err(MotionError::Number { what, vector }) }
}

/// Components that are nothing beside others become zero.
#[inline]
fn flushed(v: DVec3) -> DVec3 {
    let flush = |x: f64| if x.abs() < MIN_MAGNITUDE { 0.0 } else { x };
    DVec3::new(flush(v.x), flush(v.y), flush(v.z))
}

/// A piece as it is written; read, it is checked like any other.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct PieceRecord {
    since: f64,
    start: Pose,
    arm: [f64; 3],
    axis: [f64; 3],
    rate: f64,
    velocity: [f64; 3],
}

#[cfg(feature = "serde")]
impl From<Motion> for Vec<PieceRecord> {
    #[inline]
    fn from(motion: Motion) -> Self {
        let record = |piece: &Piece| PieceRecord {
            since: piece.since,
            start: piece.start,
            arm: piece.arm.to_array(),
            axis: piece.axis.to_array(),
            rate: piece.rate,
            velocity: piece.velocity.to_array(),
        };
        motion.pieces.iter().map(record).collect()
    }
}

#[cfg(feature = "serde")]
impl TryFrom<Vec<PieceRecord>> for Motion {
    type Error = MotionError;

    #[inline]
    fn try_from(records: Vec<PieceRecord>) -> Result<Self, MotionError> {
        let mut pieces: Vec<Piece> = Vec::with_capacity(records.len());
        for record in records {
            let axis = DVec3::from_array(record.axis);
            if (axis.length() - 1.0).abs() > noise::UNIT_VECTOR {
                return Err(MotionError::Number { what: "axis", vector: axis });
            }
            let after = pieces.last().map_or(0.0, |last| last.since);
            let follows =
                if pieces.is_empty() { record.since == 0.0 } else { record.since > after };
            // A piece from the time 1 on would be one of no time that places the body elsewhere then.
            if !follows || record.since >= 1.0 {
                return Err(MotionError::Time { time: record.since });
            }
            let piece = Piece {
                since: record.since,
                start: record.start,
                arm: DVec3::from_array(record.arm),
                axis,
                rate: record.rate,
                velocity: DVec3::from_array(record.velocity),
            };
            pieces.push(piece.checked()?);
        }
        if pieces.is_empty() { Err(MotionError::NoPoses) } else { Ok(Self { pieces }) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_too_short_to_have_a_direction_are_refused() {
        let short = DVec3::new(0.0, 1e-170, 0.0);
        assert!(Motion::turn(Pose::IDENTITY, DVec3::ZERO, short, 1.0).is_err());
        assert!(Motion::thrown(Pose::IDENTITY, DVec3::ZERO, DVec3::X, short).is_err());
        let long = DVec3::new(0.0, 1e-60, 0.0);
        assert!(Motion::turn(Pose::IDENTITY, DVec3::ZERO, long, 1.0).is_ok());
    }

    #[test]
    fn screws_between_poses_end_there() {
        for k in 0..200 {
            let x = f64::from(k);
            let pose = |x: f64| {
                let turn = DQuat::from_euler(glam::EulerRot::ZYX, x, 2.0 * x, 3.0 * x);
                Pose::new(turn, DVec3::new(x.sin(), 2.0 * x.cos(), (3.0 * x).sin())).unwrap()
            };
            let (a, b) =
                (pose(0.37 * x), pose(0.37 * x + [1.0, 1e-3, 1e-7, 1e-12][k as usize % 4]));
            let motion = Motion::between(a, b).unwrap();
            let [start, end] = [0.0, 1.0].map(|t| motion.at(t).unwrap());
            assert_eq!(start, a);
            for y in [DVec3::X, DVec3::Y, DVec3::ZERO] {
                let off = end.transform_point(y).distance(b.transform_point(y));
                assert!(off < 1e-14, "{off:e} at {k}");
            }
        }
    }

    #[test]
    fn points_of_the_axis_stay_on_it() {
        let pose = Pose::new(DQuat::from_rotation_x(0.3), DVec3::new(3.0, 4.0, 5.0)).unwrap();
        let point = DVec3::new(1.0, -1.0, 2.0);
        let motion = Motion::screw(pose, point, DVec3::new(1.0, 2.0, 2.0), 40.0, 6.0).unwrap();
        let own = pose.inverse().unwrap().transform_point(point);
        for t in [0.0, 0.25, 0.5, 1.0] {
            let expected = point + DVec3::new(2.0, 4.0, 4.0) * t;
            assert!(motion.at(t).unwrap().transform_point(own).distance(expected) < 1e-14);
        }
    }

    #[test]
    fn numbers_that_are_none_are_refused() {
        let pose = Pose::IDENTITY;
        assert!(Motion::turn(pose, DVec3::ZERO, DVec3::ZERO, 1.0).is_err());
        assert!(Motion::turn(pose, DVec3::ZERO, DVec3::Z, f64::NAN).is_err());
        assert!(Motion::turn(pose, DVec3::ZERO, DVec3::Z, 2e5).is_err());
        assert!(Motion::slide(pose, DVec3::new(f64::INFINITY, 0.0, 0.0)).is_err());
        assert!(Motion::through(&[]).is_err());
        assert!(Motion::still(pose).at(1.5).is_err());
    }
}
