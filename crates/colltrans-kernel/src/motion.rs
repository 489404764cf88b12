//! Rigid motions: the pose of a body at every time from 0 to 1.
//!
//! A motion is a sequence of *pieces*. Notation for a piece that starts at the time `s`:
//!
//! - `R`, `T` are the rotation and the translation of the pose at `s`.
//! - `k` is the direction of an axis, `v` the velocity of this axis, and `w` the angular velocity about it.
//! - `E(t)` is the rotation by `w (t - s)` about `k`. The *arm* `a` leads from a point of the axis to `T`.
//! - The body frame has the rotation `E(t) R` and the translation `T + v (t - s) + (E(t) - 1) a`.
//!
//! The numbers `s, R, T, a, k, w, v` define a motion in exact arithmetic, as if the length of `k` were 1.
//! `Piece::error_bound` bounds the rounding error of computed points. A piece starts where the previous one ends, up to
//! rounding and the defects of the matrices. Deserialising checks this, because a search of solids relies on it.

use glam::{DMat3, DQuat, DVec3};

use crate::angle::{self, SineCosine, sine_and_cosine};
use crate::error::MotionError;
use crate::error_free::{difference_error, product_error};
use crate::noise;
use crate::pose::Pose;
#[cfg(feature = "serde")]
use crate::pose::rotation_defect;
use crate::range::{MIN_MAGNITUDE, is_in_exact_range};

/// Maximum sine of half the angle of a rotation between two poses that counts as rounding error of 0.
const NO_ROTATION: f64 = 1e-15;

/// Maximum difference of the end of a piece and the start of the next one that counts as rounding. It applies to the
/// entries of the rotation, and to the translation as a share of the lengths that it is computed from.
#[cfg(feature = "serde")]
const MAX_JUMP: f64 = 1e-12;

/// Factor from the defects of two matrices to the difference of rotations that they may cause.
#[cfg(feature = "serde")]
const MAX_DEFECT_FACTOR: f64 = 4.0;

/// The pose of a body at every time from 0 to 1.
///
/// ```
/// use colltrans::glam::DVec3;
/// use colltrans::motion::Motion;
/// use colltrans::Pose;
///
/// // A door swings by a quarter turn about the z axis.
/// let door = Motion::rotation_about(Pose::IDENTITY, DVec3::ZERO, DVec3::Z, std::f64::consts::FRAC_PI_2)?;
/// let end = door.pose_at(1.0)?;
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
    /// The pieces, at least one, in the order of time. The first starts at time 0.
    pieces: Vec<Piece>,
}

/// A piece of a [`Motion`]: a rotation at a constant rate about an axis that moves at a constant velocity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Piece {
    /// Time at which the piece starts.
    pub start_time: f64,
    /// Pose at the start.
    pub start_pose: Pose,
    /// Vector from a point of the axis to the origin of the body frame at the start, in world units.
    pub arm: DVec3,
    /// Direction of the axis: a unit vector, up to rounding.
    pub axis: DVec3,
    /// Angular velocity about the axis, in radians per unit of time.
    pub rate: f64,
    /// Velocity of the axis, in world units per unit of time.
    pub velocity: DVec3,
}

/// The placement of a body at one time of a piece, relative to the start of the piece.
#[derive(Debug, Clone, Copy)]
pub struct PiecePlacement {
    /// Rotation of the body frame.
    pub rotation: DMat3,
    /// Displacement of the origin of the body frame since the start of the piece, in world units.
    pub displacement: DVec3,
    /// The rotated arm: the vector from a point of the axis to the origin of the body frame.
    pub arm: DVec3,
}

impl Motion {
    /// Returns the motion of a body that rests at a pose.
    #[inline]
    pub fn at_rest(pose: Pose) -> Self {
        Self { pieces: vec![Piece::at_rest(pose)] }
    }

    /// Returns a translation by a vector, in world units.
    ///
    /// # Errors
    /// [`MotionError::Number`] if the vector is not finite or out of range.
    #[inline]
    pub fn translation(pose: Pose, displacement: DVec3) -> Result<Self, MotionError> {
        Self::from_piece(Piece { velocity: displacement, ..Piece::at_rest(pose) })
    }

    /// Returns a rotation about a moving axis, by the numbers that define it.
    ///
    /// - `arm` is the vector from a point of the axis to the origin of the body frame, in world units.
    /// - `axis` is the direction of the axis. It is divided by its length, unless the length is 1 up to
    ///   rounding. The motion is defined as if the length were exactly 1.
    /// - `angle` is the angle of rotation in radians, and `displacement` that of the axis in world units.
    ///
    /// # Errors
    /// [`MotionError::Number`] if the axis is zero, or a vector is not finite or out of range.
    /// [`MotionError::Angle`] if the angle is not a number or exceeds 1e5 by magnitude.
    #[inline]
    pub fn from_arm_and_axis(
        pose: Pose,
        arm: DVec3,
        axis: DVec3,
        angle: f64,
        displacement: DVec3,
    ) -> Result<Self, MotionError> {
        let is_unit = (axis.length() - 1.0).abs() <= noise::UNIT_VECTOR;
        let axis = if is_unit { axis } else { unit_vector("axis", axis)? };
        Self::from_piece(Piece {
            arm,
            axis,
            rate: angle,
            velocity: displacement,
            ..Piece::at_rest(pose)
        })
    }

    /// Returns a rotation about an axis through a point of the world. The angle is in radians. A positive angle
    /// is counter-clockwise for a viewer towards whom the axis points.
    ///
    /// # Errors
    /// [`MotionError::Number`] if the axis is zero, or a vector is not finite or out of range.
    /// [`MotionError::Angle`] if the angle is not a number or exceeds 1e5 by magnitude.
    #[inline]
    pub fn rotation_about(
        pose: Pose,
        point: DVec3,
        axis: DVec3,
        angle: f64,
    ) -> Result<Self, MotionError> {
        Self::screw(pose, point, axis, angle, 0.0)
    }

    /// Returns a screw motion from time 0 to 1: a rotation by `angle` (radians) about an axis through a point of
    /// the world, and a translation along the axis by `rise` (world units).
    ///
    /// # Errors
    /// [`MotionError::Number`] if the axis is zero, or a vector is not finite or out of range.
    /// [`MotionError::Angle`] if the angle is not a number or exceeds 1e5 by magnitude.
    #[inline]
    pub fn screw(
        pose: Pose,
        point: DVec3,
        axis: DVec3,
        angle: f64,
        rise: f64,
    ) -> Result<Self, MotionError> {
        let axis = unit_vector("axis", axis)?;
        check_vector("point", point)?;
        let arm = pose.translation() - point;
        Self::from_piece(Piece {
            arm,
            axis,
            rate: angle,
            velocity: axis * rise,
            ..Piece::at_rest(pose)
        })
    }

    /// Returns the motion of a thrown body without gravity, in a unit of time. `center` is a point of the
    /// body in the world, and moves along a straight line with `velocity`. The body rotates about it with
    /// `angular_velocity`, in radians per unit of time.
    ///
    /// # Errors
    /// [`MotionError::Number`] if a vector is not finite or out of range, or if the angular velocity is not zero
    /// but all its components are below the exact range. [`MotionError::Angle`] if the angular velocity exceeds
    /// 1e5. An angular velocity of zero is accepted: the motion is then a translation.
    #[inline]
    pub fn free_flight(
        pose: Pose,
        center: DVec3,
        velocity: DVec3,
        angular_velocity: DVec3,
    ) -> Result<Self, MotionError> {
        if angular_velocity == DVec3::ZERO {
            return Self::translation(pose, velocity);
        }
        check_vector("center", center)?;
        let axis = unit_vector("angular velocity", angular_velocity)?;
        let rate = angular_velocity.length();
        let arm = pose.translation() - center;
        Self::from_piece(Piece { arm, axis, rate, velocity, ..Piece::at_rest(pose) })
    }

    /// Returns the screw motion from one pose to another by the smaller angle. It ends at `to` up to
    /// rounding and the defects of the two matrices (1e-6).
    ///
    /// # Errors
    /// [`MotionError::Number`] if the arm of the axis or the displacement along the axis is out of range.
    #[inline]
    pub fn between_poses(from: Pose, to: Pose) -> Result<Self, MotionError> {
        Self::through_poses(&[from, to])
    }

    /// Returns the screw motions from each pose to the next one. All of them have the same duration.
    ///
    /// # Errors
    /// [`MotionError::NoPoses`] if there are no poses. [`MotionError::Number`] if the arm of an axis or a
    /// velocity is out of range. [`MotionError::Angle`] if a rotation exceeds 1e5 radians per unit of time.
    #[inline]
    pub fn through_poses(poses: &[Pose]) -> Result<Self, MotionError> {
        let [first, ..] = poses else { return Err(MotionError::NoPoses) };
        let count = poses.len() - 1;
        if count == 0 {
            return Ok(Self::at_rest(*first));
        }
        let time = |k: usize| k as f64 / count as f64;
        let pieces = poses.windows(2).enumerate().map(|(k, pair)| {
            let span = time(k + 1) - time(k);
            let whole = screw_between(&pair[0], &pair[1]);
            let [rate, velocity] = [DVec3::splat(whole.rate / span), whole.velocity / span];
            Piece { start_time: time(k), rate: rate.x, velocity, ..whole }.validated()
        });
        Ok(Self { pieces: pieces.collect::<Result<_, _>>()? })
    }

    /// Returns the motion of one piece, or the error of [`Piece::validated`].
    #[inline]
    fn from_piece(piece: Piece) -> Result<Self, MotionError> {
        Ok(Self { pieces: vec![piece.validated()?] })
    }

    /// Computes the pose at a time from 0 to 1, up to rounding, with equal bits on every platform.
    ///
    /// # Errors
    /// [`MotionError::Time`] if the time is not from 0 to 1. [`MotionError::Pose`] if the translation is out
    /// of range, or the computed matrix differs from a rotation by more than 1e-6.
    #[inline]
    pub fn pose_at(&self, time: f64) -> Result<Pose, MotionError> {
        if !(0.0..=1.0).contains(&time) {
            return Err(MotionError::Time { time });
        }
        let piece = &self.pieces[self.pieces.partition_point(|p| p.start_time <= time).max(1) - 1];
        let PiecePlacement { rotation, displacement: by, .. } = piece.placement_at(time);
        Ok(Pose::from_matrix(rotation, piece.start_pose.translation() + by)?)
    }

    /// Returns the pose at time 0.
    #[inline]
    pub fn start_pose(&self) -> Pose {
        self.pieces[0].start_pose
    }

    /// Returns the pieces that define the motion, in the order of time; the first begins at time 0.
    #[inline]
    pub fn pieces(&self) -> &[Piece] {
        &self.pieces
    }
}

impl Piece {
    /// Returns the piece of a body that rests at a pose from time 0 on.
    #[inline]
    fn at_rest(start: Pose) -> Self {
        let [arm, velocity] = [DVec3::ZERO; 2];
        Self { start_time: 0.0, start_pose: start, arm, axis: DVec3::Z, rate: 0.0, velocity }
    }

    /// Checks that arm, velocity and rate are in range.
    #[inline]
    fn validated(self) -> Result<Self, MotionError> {
        check_vector("arm", self.arm)?;
        check_vector("displacement", self.velocity)?;
        if self.rate.is_nan() || self.rate.abs() > angle::MAX_ANGLE {
            return Err(MotionError::Angle { angle: self.rate });
        }
        Ok(self)
    }

    /// Checks whether this piece ends where the next one starts, up to rounding and the defects of the matrices.
    #[cfg(feature = "serde")]
    fn ends_at_start_of(&self, next: &Self) -> bool {
        let span = next.start_time - self.start_time;
        let PiecePlacement { rotation, displacement, .. } = self.placement_at(next.start_time);
        let [from, to] = [self, next].map(|piece| piece.start_pose);
        let defects = rotation_defect(from.matrix()) + rotation_defect(to.matrix());
        let turned = (rotation - to.matrix()).to_cols_array();
        let turned = turned.into_iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let lengths =
            [from.translation(), to.translation(), self.velocity * span].map(DVec3::length);
        let turning_length = self.arm.length() * (self.rate * span).abs().min(2.0);
        let off = (from.translation() + displacement).distance(to.translation());
        turned <= MAX_JUMP + MAX_DEFECT_FACTOR * defects
            && off <= MAX_JUMP * (lengths.into_iter().sum::<f64>() + turning_length)
    }

    /// Computes the placement at a time that is not before the start of the piece.
    #[inline]
    #[doc(hidden)]
    pub fn placement_at(&self, time: f64) -> PiecePlacement {
        let span = time - self.start_time;
        let displacement = self.velocity * span;
        if self.rate == 0.0 {
            return PiecePlacement {
                rotation: self.start_pose.matrix(),
                displacement: flush_tiny(displacement),
                arm: self.arm,
            };
        }
        let angle = self.rate * span;
        let low = product_error(self.rate, span, angle)
            + self.rate * difference_error(time, self.start_time);
        let turn = sine_and_cosine(angle, if low.is_finite() { low } else { 0.0 });
        let arm_displacement = self.rotation_displacement(&turn, self.arm);
        let start = self.start_pose.matrix();
        let turned = |column: DVec3| flush_tiny(column + self.rotation_displacement(&turn, column));
        PiecePlacement {
            rotation: DMat3::from_cols(
                turned(start.x_axis),
                turned(start.y_axis),
                turned(start.z_axis),
            ),
            displacement: flush_tiny(displacement + arm_displacement),
            arm: self.arm + arm_displacement,
        }
    }

    /// Returns the displacement `(E - 1) z` of a vector by the rotation `E`.
    #[inline]
    fn rotation_displacement(&self, turn: &SineCosine, z: DVec3) -> DVec3 {
        let across = self.axis.cross(z);
        across * turn.sin + self.axis.cross(across) * turn.versine
    }

    /// Returns the velocity of a point of the body. `from_axis` is the vector from a point of the axis to
    /// this point.
    #[inline]
    #[doc(hidden)]
    pub fn point_velocity(&self, from_axis: DVec3) -> DVec3 {
        self.velocity + self.axis.cross(from_axis) * self.rate
    }

    /// Bounds the rounding error of computed points of a body, up to `span` units of time after the start of
    /// the piece. `reach` is the largest distance of a point from the origin of the body frame.
    #[doc(hidden)]
    #[inline]
    pub fn error_bound(&self, reach: f64, span: f64) -> f64 {
        let turned = if self.rate == 0.0 { 0.0 } else { reach };
        let arm_displacement = self.arm.length() * (self.rate.abs() * span).min(1.0);
        noise::ROTATED_POINT * (turned + arm_displacement)
            + noise::DISPLACEMENT * self.velocity.length() * span
    }
}

/// Returns the screw motion from one pose to the other in a unit of time, from time 0 on. Returns a
/// translation if the angle of rotation is within rounding of 0.
#[inline]
fn screw_between(from: &Pose, to: &Pose) -> Piece {
    let at_rest = Piece::at_rest(*from);
    let displacement = to.translation() - from.translation();
    let mut turn = DQuat::from_mat3(&(to.matrix() * from.matrix().transpose())).normalize();
    if turn.w < 0.0 {
        turn = -turn;
    }
    let imaginary = turn.xyz();
    let sine = imaginary.length();
    if sine <= NO_ROTATION {
        return Piece { velocity: displacement, ..at_rest };
    }
    let axis = imaginary / sine;
    let half = arc_tangent(sine, turn.w);
    // `(E - 1) a` is the part of the displacement perpendicular to the axis.
    let rise = axis * axis.dot(displacement);
    let across = displacement - rise;
    let arm = (axis.cross(across) * (-turn.w / sine) - across) * 0.5;
    Piece { arm, axis, rate: 2.0 * half, velocity: rise, ..at_rest }
}

/// Computes the angle in the first quadrant whose sine and cosine have the ratio `sine : cosine`, by Newton's
/// method with the sine and cosine of [`sine_and_cosine`](crate::angle::sine_and_cosine).
#[inline]
fn arc_tangent(sine: f64, cosine: f64) -> f64 {
    // The initial error is below 0.05.
    let mut angle = if sine < cosine { sine / cosine.max(0.5) } else { 1.57 - cosine / sine };
    for _ in 0..8 {
        let t = sine_and_cosine(angle, 0.0);
        angle += (sine * t.cos - cosine * t.sin) / (sine * sine + cosine * cosine).sqrt();
    }
    angle
}

/// Returns the unit vector in the direction of `vector`, or an error that names `what`.
#[inline]
fn unit_vector(what: &'static str, vector: DVec3) -> Result<DVec3, MotionError> {
    check_vector(what, vector)?;
    if flush_tiny(vector) == DVec3::ZERO {
        return Err(MotionError::Number { what, vector });
    }
    Ok(vector / vector.length())
}

/// Checks that a vector is finite and in the exact range. Components below the range count as 0.
#[inline]
fn check_vector(what: &'static str, vector: DVec3) -> Result<(), MotionError> {
    if is_in_exact_range(flush_tiny(vector)) {
        Ok(())
    } else {
        Err(MotionError::Number { what, vector })
    }
}

/// Returns the vector with components below [`MIN_MAGNITUDE`] replaced by zero.
#[inline]
fn flush_tiny(v: DVec3) -> DVec3 {
    let flush = |x: f64| if x.abs() < MIN_MAGNITUDE { 0.0 } else { x };
    DVec3::new(flush(v.x), flush(v.y), flush(v.z))
}

/// Serialised form of a piece. A deserialised piece is checked like any other.
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
            since: piece.start_time,
            start: piece.start_pose,
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
            let after = pieces.last().map_or(0.0, |last| last.start_time);
            let follows =
                if pieces.is_empty() { record.since == 0.0 } else { record.since > after };
            // A piece from the time 1 on would have no duration and change the pose at the time 1.
            if !follows || record.since >= 1.0 {
                return Err(MotionError::Time { time: record.since });
            }
            let piece = Piece {
                start_time: record.since,
                start_pose: record.start,
                arm: DVec3::from_array(record.arm),
                axis,
                rate: record.rate,
                velocity: DVec3::from_array(record.velocity),
            };
            let piece = piece.validated()?;
            if pieces.last().is_some_and(|last| !last.ends_at_start_of(&piece)) {
                return Err(MotionError::Jump { time: record.since });
            }
            pieces.push(piece);
        }
        if pieces.is_empty() { Err(MotionError::NoPoses) } else { Ok(Self { pieces }) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axis_below_exact_range_is_rejected() {
        let short = DVec3::new(0.0, 1e-170, 0.0);
        assert!(Motion::rotation_about(Pose::IDENTITY, DVec3::ZERO, short, 1.0).is_err());
        assert!(Motion::free_flight(Pose::IDENTITY, DVec3::ZERO, DVec3::X, short).is_err());
        let long = DVec3::new(0.0, 1e-60, 0.0);
        assert!(Motion::rotation_about(Pose::IDENTITY, DVec3::ZERO, long, 1.0).is_ok());
    }

    #[test]
    fn screw_between_poses_ends_at_second_pose() {
        for k in 0..200 {
            let x = f64::from(k);
            let pose = |x: f64| {
                let turn = DQuat::from_euler(glam::EulerRot::ZYX, x, 2.0 * x, 3.0 * x);
                Pose::new(turn, DVec3::new(x.sin(), 2.0 * x.cos(), (3.0 * x).sin())).unwrap()
            };
            let (a, b) =
                (pose(0.37 * x), pose(0.37 * x + [1.0, 1e-3, 1e-7, 1e-12][k as usize % 4]));
            let motion = Motion::between_poses(a, b).unwrap();
            let [start, end] = [0.0, 1.0].map(|t| motion.pose_at(t).unwrap());
            assert_eq!(start, a);
            for y in [DVec3::X, DVec3::Y, DVec3::ZERO] {
                let off = end.transform_point(y).distance(b.transform_point(y));
                assert!(off < 1e-14, "{off:e} at {k}");
            }
        }
    }

    #[test]
    fn axis_point_moves_only_along_axis() {
        let pose = Pose::new(DQuat::from_rotation_x(0.3), DVec3::new(3.0, 4.0, 5.0)).unwrap();
        let point = DVec3::new(1.0, -1.0, 2.0);
        let motion = Motion::screw(pose, point, DVec3::new(1.0, 2.0, 2.0), 40.0, 6.0).unwrap();
        let own = pose.inverse().unwrap().transform_point(point);
        for t in [0.0, 0.25, 0.5, 1.0] {
            let expected = point + DVec3::new(2.0, 4.0, 4.0) * t;
            assert!(motion.pose_at(t).unwrap().transform_point(own).distance(expected) < 1e-14);
        }
    }

    #[test]
    fn invalid_motions_and_times_are_rejected() {
        let pose = Pose::IDENTITY;
        assert!(Motion::rotation_about(pose, DVec3::ZERO, DVec3::ZERO, 1.0).is_err());
        assert!(Motion::rotation_about(pose, DVec3::ZERO, DVec3::Z, f64::NAN).is_err());
        assert!(Motion::rotation_about(pose, DVec3::ZERO, DVec3::Z, 2e5).is_err());
        assert!(Motion::translation(pose, DVec3::new(f64::INFINITY, 0.0, 0.0)).is_err());
        assert!(Motion::through_poses(&[]).is_err());
        assert!(Motion::at_rest(pose).pose_at(1.5).is_err());
    }
}
