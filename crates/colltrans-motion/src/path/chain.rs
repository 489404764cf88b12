//! A chain of joints, from a frame that two bodies share to one of the bodies: pose, derivatives and bounds.
//!
//! Joint `j` has the axis `k_j` through the point `c_j`. Its value changes by `q_j'` per row. `w_j = q_j' k_j` for a
//! revolute joint, `v_j = q_j' k_j` for a prismatic one. Derivations: `docs/theory/motion-bounds.md`, "Chains of
//! joints".
//!
//! - Derivatives: `p' = sum L_j`, `p'' = sum B_j x L_j`, with `L_j = w_j x (p - c_j) + v_j`, `B_j = 2 O_j + w_j`, `O_j
//!   = w_1 + ... + w_{j-1}`. Both are affine in the point.
//! - Bounds: `|p^(m)| <= sum (W_j^m - W_{j-1}^m) R_j + m W_{j-1}^{m-1} |v_j|`, with `W_j = |w_1| + ... + |w_j|` and
//!   `R_j` a bound of the distance of the body from the axis.
//! - Along a normal `n`, a term that starts with joint `i` has the factor `|n x k_i|`, at most `|n x k_1|` plus the
//!   sines of the angles between the axes up to joint `i`.

use glam::{DMat3, DVec3};

use super::mechanism::{Joint, JointPath, Mechanism};
use colltrans_convex::body::Pose;
use colltrans_kernel::angle::sine_and_cosine;
use colltrans_kernel::noise;
use colltrans_kernel::range::MIN_MAGNITUDE;

/// Error of a product of two rotations, as the displacement of a unit vector. Nine entries with an error of `3 u` each
/// have the Frobenius norm `9 u`. The constant is twice this number.
const PRODUCT_ERROR: f64 = 9.0 * f64::EPSILON;

/// Relative error of a value between two rows, from the difference, the share of time, the product and the sum.
const VALUE_ERROR: f64 = 8.0 * f64::EPSILON;

/// Factor of all bounds in this module. It covers the rounding errors of their sums, and rotation matrices that are
/// orthogonal only up to rounding.
pub(super) const BOUND_FACTOR: f64 = 1.0 + 1e-9;

/// Error bound of computed sines.
const SINE_ERROR: f64 = 1e-14;

/// A joint of the chain. A fixed frame has an origin only.
#[derive(Debug, Clone, Copy)]
struct ChainJoint {
    origin: Pose,
    joint: Joint,
    column: usize,
    /// Upper bound of the distance of points of the body from the axis.
    lever: f64,
    /// For a revolute joint, an upper bound of the sine of the angle between its axis and that of the previous revolute
    /// joint.
    sine: f64,
}

/// All joints of a chain.
#[derive(Debug, Clone)]
pub(super) struct Chain {
    joints: Vec<ChainJoint>,
    /// Pose of the body in the last frame.
    last: Pose,
    /// Error bound of computed points of the body, in world units.
    pub(super) error: f64,
    /// Upper bound of the distance of all origins and body points from the start of the chain, in world units.
    pub(super) size: f64,
    /// Error bound of a computed rotation, in radians.
    rotation_error: f64,
    /// Axis of the first revolute joint, in the frame in which the chain starts.
    first_axis: DVec3,
}

/// Velocity and acceleration of the points of a body at one time: `p' = v + w x p`, `p'' = a + A p`.
#[derive(Debug, Clone, Copy)]
pub(super) struct PointRates {
    pub(super) v: DVec3,
    pub(super) w: DVec3,
    pub(super) a: DVec3,
    pub(super) matrix: DMat3,
}

impl PointRates {
    const NONE: Self = Self { v: DVec3::ZERO, w: DVec3::ZERO, a: DVec3::ZERO, matrix: DMat3::ZERO };
}

/// Bounds of the derivatives of the points of a body between two rows.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct DerivativeBounds {
    /// Bounds of `|p'|`, `|p''|`, `|p'''|`.
    pub(super) derivatives: [f64; 3],
    /// Error bounds of computed `p'` and `p''`.
    pub(super) off: [f64; 2],
}

impl Chain {
    /// Builds the chain to a body with the given corners, at the pose `last` in the last of the frames. The chain
    /// starts in the frame that contains the first of them.
    pub(super) fn new(
        mechanism: &Mechanism,
        frames: &[usize],
        path: &JointPath,
        last: Pose,
        corners: &[DVec3],
    ) -> Self {
        let columns = mechanism.joint_columns();
        let joint = |k: &usize| {
            let frame = &mechanism.frames()[*k];
            let column = columns[*k].unwrap_or(0);
            ChainJoint { origin: frame.origin, joint: frame.joint, column, lever: 0.0, sine: 0.0 }
        };
        let mut chain = Self {
            joints: frames.iter().map(joint).collect(),
            last,
            error: 0.0,
            size: 0.0,
            rotation_error: 0.0,
            first_axis: DVec3::ZERO,
        };
        chain.set_sines();
        chain.set_levers(path, corners);
        chain.set_error(path, corners);
        chain
    }

    /// Computes bounds of the sines of the angles between the axes of consecutive revolute joints.
    fn set_sines(&mut self) {
        let (mut turned, mut last) = (DMat3::IDENTITY, None);
        for joint in &mut self.joints {
            turned *= joint.origin.matrix();
            let Joint::Turning(axis) = joint.joint else { continue };
            let axis_there = turned * axis;
            match last {
                None => self.first_axis = axis_there,
                Some(before) => joint.sine = axis_there.cross(before).length() + SINE_ERROR,
            }
            (turned, last) = (DMat3::IDENTITY, Some(axis));
        }
    }

    /// Computes the bounds of the distances from the axes, and the size of the chain.
    fn set_levers(&mut self, path: &JointPath, corners: &[DVec3]) {
        let placed: Vec<DVec3> = corners.iter().map(|v| self.last.transform_point(*v)).collect();
        let far = |f: &dyn Fn(&DVec3) -> f64| placed.iter().map(f).fold(0.0, f64::max);
        // Upper bounds of the distance of the points from the origin of the frame, and from an axis through it.
        let mut whole = far(&|p| p.length());
        let mut beyond: Option<(DVec3, f64)> = None;
        for joint in self.joints.iter_mut().rev() {
            if let Joint::Turning(axis) = joint.joint {
                let across = |v: DVec3| v.cross(axis).length();
                let lever = match beyond {
                    None => far(&|p| across(*p)),
                    Some((offset, rest)) => across(offset) + rest,
                };
                joint.lever = lever * BOUND_FACTOR;
            }
            let slides = match joint.joint {
                Joint::Sliding(_) => path.max_value(joint.column),
                _ => 0.0,
            };
            beyond = Some((joint.origin.translation(), slides + whole));
            whole = (whole + slides + joint.origin.translation().length()) * BOUND_FACTOR;
        }
        self.size = whole;
    }

    /// Computes the error bounds of rotations and points.
    fn set_error(&mut self, path: &JointPath, corners: &[DVec3]) {
        if self.joints.is_empty() {
            return;
        }
        let (mut rotation_error, mut off, mut extent) = (0.0, 0.0, 0.0);
        let mut add_vector = |length: f64, rotation_error: f64| {
            extent += length;
            off += rotation_error * length + noise::DISPLACEMENT * extent;
        };
        for joint in &self.joints {
            add_vector(joint.origin.translation().length(), rotation_error);
            rotation_error += PRODUCT_ERROR;
            match joint.joint {
                Joint::Fixed => {}
                Joint::Turning(_) => {
                    rotation_error += PRODUCT_ERROR
                        + noise::ROTATED_POINT
                        + VALUE_ERROR * path.max_value(joint.column);
                }
                Joint::Sliding(_) => add_vector(
                    path.max_value(joint.column) * (1.0 + VALUE_ERROR),
                    rotation_error + VALUE_ERROR,
                ),
            }
        }
        add_vector(self.last.translation().length(), rotation_error);
        rotation_error += PRODUCT_ERROR;
        let reach = corners.iter().map(|v| v.length()).fold(0.0, f64::max);
        self.rotation_error = rotation_error;
        self.error = (off + rotation_error * reach) * BOUND_FACTOR;
    }

    /// Returns the pose and the derivatives of the body, at a share of the interval from a row to the next one.
    pub(super) fn pose_and_rates(
        &self,
        path: &JointPath,
        row: usize,
        share: f64,
    ) -> (Pose, PointRates) {
        if self.joints.is_empty() {
            return (self.last, PointRates::NONE);
        }
        let (mut m, mut t) = (DMat3::IDENTITY, DVec3::ZERO);
        let mut rates = PointRates::NONE;
        for joint in &self.joints {
            t += m * joint.origin.translation();
            m *= joint.origin.matrix();
            let Some(axis) = joint.joint.axis() else { continue };
            let [value, grows] = path.value_and_change(row, joint.column);
            let value = value + grows * share;
            let along = m * axis;
            let rate = along * grows;
            if let Joint::Turning(_) = joint.joint {
                let b = rates.w * 2.0 + rate;
                rates.v -= rate.cross(t);
                rates.a -= b.cross(rate.cross(t));
                // B x (w x p) = w (B.p) - p (B.w).
                let outer = DMat3::from_cols(rate * b.x, rate * b.y, rate * b.z);
                rates.matrix += outer - DMat3::from_diagonal(DVec3::splat(b.dot(rate)));
                rates.w += rate;
                m *= rotation_about(axis, value);
            } else {
                rates.v += rate;
                rates.a += (rates.w * 2.0).cross(rate);
                t += along * value;
            }
        }
        t += m * self.last.translation();
        m *= self.last.matrix();
        let columns = [m.x_axis, m.y_axis, m.z_axis].map(flush_tiny);
        let m = DMat3::from_cols(columns[0], columns[1], columns[2]);
        (Pose::from_checked_entries(m, flush_tiny(t)), rates)
    }

    /// Returns bounds of the derivatives of the points of the body between a row and the next one.
    pub(super) fn derivative_bounds(&self, path: &JointPath, row: usize) -> DerivativeBounds {
        let (mut sum, mut derivatives) = (0.0_f64, [0.0; 3]);
        for joint in &self.joints {
            let rate = match joint.joint {
                Joint::Fixed => continue,
                _ => path.value_and_change(row, joint.column)[1].abs(),
            };
            if let Joint::Turning(_) = joint.joint {
                let next = sum + rate;
                derivatives[0] += rate * joint.lever;
                derivatives[1] += rate * (sum + next) * joint.lever;
                derivatives[2] += rate * (sum * sum + sum * next + next * next) * joint.lever;
                sum = next;
            } else {
                derivatives[0] += rate;
                derivatives[1] += 2.0 * sum * rate;
                derivatives[2] += 3.0 * sum * sum * rate;
            }
        }
        let count = self.joints.len() as f64;
        // Each term is of points within the size of the chain, rotated by the error.
        let share = 4.0 * self.rotation_error + 16.0 * count * f64::EPSILON;
        let slides = derivatives[0];
        let first = 2.0 * sum * self.size + slides;
        let off = [share * first, share * 2.0 * sum * first];
        DerivativeBounds { derivatives: derivatives.map(|x| x * BOUND_FACTOR), off }
    }

    /// Returns an upper bound of the component of the third derivative of the points of the body along any normal
    /// between two given ones, from a row to the next one.
    pub(super) fn third_along(&self, path: &JointPath, row: usize, normals: [DVec3; 2]) -> f64 {
        let longest = normals[0].length().max(normals[1].length());
        let aside = normals.map(|n| n.cross(self.first_axis).length());
        let mut along = aside[0].max(aside[1]) + SINE_ERROR * longest;
        // For each revolute joint, its rate and the bound of the component along the normals.
        let mut turning: Vec<[f64; 2]> = Vec::with_capacity(self.joints.len());
        let mut third = 0.0;
        for joint in &self.joints {
            let rate = match joint.joint {
                Joint::Fixed => continue,
                _ => path.value_and_change(row, joint.column)[1].abs(),
            };
            // Sum of the rates of the revolute joints between the two.
            let mut between = 0.0;
            let slides = matches!(joint.joint, Joint::Sliding(_));
            for [first, share] in turning.iter().rev() {
                third += if slides {
                    3.0 * share * rate * first * (2.0 * between + first)
                } else {
                    3.0 * share * first * rate * (2.0 * between + first + rate) * joint.lever
                };
                between += first;
            }
            if !slides {
                along += joint.sine * longest;
                let share = along.min(longest);
                third += share * rate * rate * rate * joint.lever;
                turning.push([rate, share]);
            }
        }
        third * BOUND_FACTOR
    }

    /// Returns an upper bound of the distance that points of the body move from a row to the next one.
    pub(super) fn travel_bound(&self, path: &JointPath, row: usize) -> f64 {
        self.derivative_bounds(path, row).derivatives[0]
    }
}

/// Returns the rotation about a unit vector by an angle.
fn rotation_about(axis: DVec3, angle: f64) -> DMat3 {
    let turn = sine_and_cosine(angle, 0.0);
    let turned = |z: DVec3| {
        let across = axis.cross(z);
        z + across * turn.sin + axis.cross(across) * turn.versine
    };
    DMat3::from_cols(turned(DVec3::X), turned(DVec3::Y), turned(DVec3::Z))
}

/// Replaces components below [`MIN_MAGNITUDE`] by zero.
fn flush_tiny(v: DVec3) -> DVec3 {
    let flush = |x: f64| if x.abs() < MIN_MAGNITUDE { 0.0 } else { x };
    DVec3::new(flush(v.x), flush(v.y), flush(v.z))
}

#[cfg(test)]
mod tests {
    use super::super::mechanism::Frame;
    use super::*;

    /// Builds a chain of joints with various axes, and its path.
    fn chain() -> (Mechanism, JointPath, Vec<DVec3>) {
        let frame = |k: usize| {
            let x = k as f64;
            let axis = DVec3::new((1.3 * x).sin(), (2.1 * x).cos(), 0.7);
            let turn = glam::DQuat::from_euler(glam::EulerRot::ZYX, x, 2.0 * x, 0.5);
            let origin = Pose::new(turn, DVec3::new(0.4, 0.3 * x.cos(), 0.6)).unwrap();
            let joint = match k {
                2 => Joint::Sliding(axis),
                3 => Joint::Fixed,
                _ => Joint::Turning(axis),
            };
            Frame { parent: k.checked_sub(1), origin, joint }
        };
        let mechanism = Mechanism::new((0..6).map(frame).collect()).unwrap();
        let rows = vec![vec![0.1, -0.4, 0.3, 1.0, 0.2], vec![0.5, 0.1, 0.6, 0.2, -0.7]];
        let corners = vec![DVec3::new(0.3, -0.2, 0.1), DVec3::new(-0.1, 0.4, 0.5)];
        (mechanism, JointPath::at_unit_times(rows).unwrap(), corners)
    }

    #[test]
    fn derivatives_match_finite_differences_and_bounds() {
        let (mechanism, path, corners) = chain();
        let last = Pose::from_translation(DVec3::X).unwrap();
        let chain = Chain::new(&mechanism, &[0, 1, 2, 3, 4, 5], &path, last, &corners);
        let most = chain.derivative_bounds(&path, 0);
        let h = 1e-3;
        for corner in &corners {
            for k in 1..20 {
                let share = f64::from(k) / 20.0;
                let place =
                    |share: f64| chain.pose_and_rates(&path, 0, share).0.transform_point(*corner);
                let (pose, rates) = chain.pose_and_rates(&path, 0, share);
                let p = pose.transform_point(*corner);
                let near = [-2.0, -1.0, 1.0, 2.0].map(|x| place(share + h * x));
                let first = (near[2] - near[1]) / (2.0 * h);
                let second = (near[2] - 2.0 * p + near[1]) / (h * h);
                let third = (near[3] - 2.0 * near[2] + 2.0 * near[1] - near[0]) / (2.0 * h * h * h);
                let computed = [rates.v + rates.w.cross(p), rates.a + rates.matrix * p];
                assert!(first.distance(computed[0]) < 1e-6, "{first} {}", computed[0]);
                assert!(second.distance(computed[1]) < 1e-6, "{second} {}", computed[1]);
                // The bounds hold for all joint values; the actual third derivative is far below its bound.
                for (found, most) in [first, second, third].iter().zip(most.derivatives) {
                    assert!(found.length() <= most && most < 30.0, "{} {most}", found.length());
                }
            }
        }
    }

    #[test]
    fn travel_bound_of_straight_arm_is_tight() {
        // Two links of length 1 along x, joints about z, a body of radius 0.5: the first lever is 1.5, the last 0.5.
        let joint = Joint::Turning(DVec3::Z);
        let elbow = Pose::from_translation(DVec3::new(1.0, 0.0, 7.0)).unwrap();
        let frames = vec![
            Frame { parent: None, origin: Pose::IDENTITY, joint },
            Frame { parent: Some(0), origin: elbow, joint },
        ];
        let path = JointPath::at_unit_times(vec![vec![0.0, 0.0], vec![1.0, 0.0]]).unwrap();
        let mechanism = Mechanism::new(frames).unwrap();
        let corners = [DVec3::new(0.5, 0.0, 0.0)];
        let chain = Chain::new(&mechanism, &[0, 1], &path, Pose::IDENTITY, &corners);
        let travel = chain.travel_bound(&path, 0);
        assert!((1.5..1.5 + 1e-6).contains(&travel), "{travel}");
        assert!(chain.error > 0.0 && chain.error < 1e-12, "{}", chain.error);
    }
}
