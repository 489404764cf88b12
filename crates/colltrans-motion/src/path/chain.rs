//! Joints one after the other, from a frame that two bodies share to one of them: where it is, how it moves, and
//! how far it can move.
//!
//! Notation. In the shared frame joint `j` has at some time an axis `k_j` through a point `c_j`, and its value grows
//! by `q_j'` from a row of the path to the next one, evenly: a unit of time here. `w_j = q_j' k_j` of a turning joint, `v_j = q_j' k_j` of a sliding one; the
//! other one is 0. What comes before a joint carries it: `O_j = w_1 + ... + w_{j-1}`.
//!
//! *Derivatives.* A joint moves a point `p` of the body by `L_j = w_j x (p - c_j) + v_j`, and whatever moves it
//! turns that, so
//!
//! `p' = sum L_j`, `p'' = sum B_j x L_j` with `B_j = 2 O_j + w_j`,
//!
//! as the derivative by the values of joints `i <= j` is `k_i x (k_j x (p - c_j))`, or `k_i x k_j`, or 0 if joint `i`
//! slides. Both are affine in the point ([`Rates`]). Of the `n`-th derivative each term is a product over `n` joints,
//! one after the other, of which the last one that turns or slides has the point's distance from its axis as a
//! factor, or nothing. With `W_j = |w_1| + ... + |w_j|` and `R_j` at least that distance,
//!
//! `|p^(n)| <= sum (W_j^n - W_{j-1}^n) R_j + n W_{j-1}^{n-1} |v_j|`.
//!
//! *Along a normal.* Such a term begins with `w_i x`, where `i` is its first joint, so along `n` it is at most `|n x k_i|`
//! times the rest. Two consecutive turning joints keep the angle between their axes, because one axis is fixed in the
//! frame that the other one turns. The sine of a sum of angles is at most the sum of sines, therefore `|n x k_i|` is at
//! most `|n x k_1|` and the sum of these sines up to joint `i`: nothing for a link that slides over a plane.
//!
//! *Distances.* `R_j` is at most what is across the axis of the way to the next frame, and then the sum of all ways
//! and of the farthest point of the body, wherever the joints are.
//!
//! *Rounding.* A rotation is made joint by joint: one product for the origin, one for the turn, each off by at most
//! [`PRODUCT`] as it moves a unit vector, and the turn by [`noise::POSE`] and by what its angle is off, which is a few
//! roundings of the largest value on the way. A translation is off by what the rotation makes of each way, and by the
//! roundings of its product and sum. Values at the ends of a row are those given, to the same error.

use glam::{DMat3, DVec3};

use super::mechanism::{Joint, JointPath, Mechanism};
use colltrans_convex::body::Pose;
use colltrans_kernel::angle::turn;
use colltrans_kernel::noise;
use colltrans_kernel::range::MIN_MAGNITUDE;

/// How far a product of two rotations may be off, as it moves a unit vector: nine entries, `3 u` each.
const PRODUCT: f64 = 9.0 * f64::EPSILON;

/// How far a value between two rows may be off, as a share of the largest: the difference, the share of time, the
/// product and the sum.
const VALUE: f64 = 8.0 * f64::EPSILON;

/// Bounds here are raised by such a share, for the roundings of their sums and for matrices that are rotations to
/// rounding only.
pub(super) const RAISED: f64 = 1.0 + 1e-9;

/// How far computed sines may be off.
const ROUNDED: f64 = 1e-14;

/// A joint on the way to a body, or an origin without one.
#[derive(Debug, Clone, Copy)]
struct Stage {
    origin: Pose,
    joint: Joint,
    column: usize,
    /// At least the distance of the body's points from its axis.
    lever: f64,
    /// Of a turning joint, at least the sine of the angle between its axis and that of the turning joint before.
    sine: f64,
}

/// All stages on the way to a body.
#[derive(Debug, Clone)]
pub(super) struct Chain {
    stages: Vec<Stage>,
    /// Where the body is in the last frame.
    last: Pose,
    /// At least how far computed points of the body are off.
    pub(super) error: f64,
    /// At least how far anything on the way, or of the body, is from where the chain begins.
    pub(super) size: f64,
    /// By how much a computed rotation may be off.
    tilt: f64,
    /// The axis of the first turning joint, where the chain begins.
    first_axis: DVec3,
}

/// Velocity and acceleration of a body's points at a time: `p' = v + w x p`, `p'' = a + A p`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rates {
    pub(super) v: DVec3,
    pub(super) w: DVec3,
    pub(super) a: DVec3,
    pub(super) matrix: DMat3,
}

impl Rates {
    const NONE: Self = Self { v: DVec3::ZERO, w: DVec3::ZERO, a: DVec3::ZERO, matrix: DMat3::ZERO };
}

/// How large derivatives of a body's points may be from a row to the next one.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Most {
    /// `|p'|`, `|p''|`, `|p'''|`.
    pub(super) derivatives: [f64; 3],
    /// By how much a computed `p'` and `p''` may be off.
    pub(super) off: [f64; 2],
}

impl Chain {
    /// To a body with these corners at a pose in the last of some frames, the first of which stands in the frame
    /// that the chain begins in.
    pub(super) fn new(
        mechanism: &Mechanism,
        frames: &[usize],
        path: &JointPath,
        last: Pose,
        corners: &[DVec3],
    ) -> Self {
        let columns = mechanism.columns();
        let stage = |k: &usize| {
            let frame = &mechanism.frames()[*k];
            let column = columns[*k].unwrap_or(0);
            Stage { origin: frame.origin, joint: frame.joint, column, lever: 0.0, sine: 0.0 }
        };
        let mut chain = Self {
            stages: frames.iter().map(stage).collect(),
            last,
            error: 0.0,
            size: 0.0,
            tilt: 0.0,
            first_axis: DVec3::ZERO,
        };
        chain.set_sines();
        chain.set_levers(path, corners);
        chain.set_error(path, corners);
        chain
    }

    fn set_sines(&mut self) {
        let (mut turned, mut last) = (DMat3::IDENTITY, None);
        for stage in &mut self.stages {
            turned *= stage.origin.matrix();
            let Joint::Turning(axis) = stage.joint else { continue };
            let axis_there = turned * axis;
            match last {
                None => self.first_axis = axis_there,
                Some(before) => stage.sine = axis_there.cross(before).length() + ROUNDED,
            }
            (turned, last) = (DMat3::IDENTITY, Some(axis));
        }
    }

    fn set_levers(&mut self, path: &JointPath, corners: &[DVec3]) {
        let placed: Vec<DVec3> = corners.iter().map(|v| self.last.transform_point(*v)).collect();
        let far = |f: &dyn Fn(&DVec3) -> f64| placed.iter().map(f).fold(0.0, f64::max);
        // At least the distance of the points from the frame's origin, and across an axis of it.
        let mut whole = far(&|p| p.length());
        let mut beyond: Option<(DVec3, f64)> = None;
        for stage in self.stages.iter_mut().rev() {
            if let Joint::Turning(axis) = stage.joint {
                let across = |v: DVec3| v.cross(axis).length();
                let lever = match beyond {
                    None => far(&|p| across(*p)),
                    Some((way, rest)) => across(way) + rest,
                };
                stage.lever = lever * RAISED;
            }
            let slides = match stage.joint {
                Joint::Sliding(_) => path.most(stage.column),
                _ => 0.0,
            };
            beyond = Some((stage.origin.translation(), slides + whole));
            whole = (whole + slides + stage.origin.translation().length()) * RAISED;
        }
        self.size = whole;
    }

    fn set_error(&mut self, path: &JointPath, corners: &[DVec3]) {
        if self.stages.is_empty() {
            return;
        }
        let (mut tilt, mut off, mut extent) = (0.0, 0.0, 0.0);
        let mut way = |length: f64, tilt: f64| {
            extent += length;
            off += tilt * length + noise::WAY * extent;
        };
        for stage in &self.stages {
            way(stage.origin.translation().length(), tilt);
            tilt += PRODUCT;
            match stage.joint {
                Joint::Fixed => {}
                Joint::Turning(_) => {
                    tilt += PRODUCT + noise::POSE + VALUE * path.most(stage.column);
                }
                Joint::Sliding(_) => way(path.most(stage.column) * (1.0 + VALUE), tilt + VALUE),
            }
        }
        way(self.last.translation().length(), tilt);
        tilt += PRODUCT;
        let reach = corners.iter().map(|v| v.length()).fold(0.0, f64::max);
        self.tilt = tilt;
        self.error = (off + tilt * reach) * RAISED;
    }

    /// Where the body is, and how it moves, at a share of the way from a row to the next one.
    pub(super) fn at(&self, path: &JointPath, row: usize, share: f64) -> (Pose, Rates) {
        if self.stages.is_empty() {
            return (self.last, Rates::NONE);
        }
        let (mut m, mut t) = (DMat3::IDENTITY, DVec3::ZERO);
        let mut rates = Rates::NONE;
        for stage in &self.stages {
            t += m * stage.origin.translation();
            m *= stage.origin.matrix();
            let Some(axis) = stage.joint.axis() else { continue };
            let [value, grows] = path.value(row, stage.column);
            let value = value + grows * share;
            let along = m * axis;
            let rate = along * grows;
            if let Joint::Turning(_) = stage.joint {
                let b = rates.w * 2.0 + rate;
                rates.v -= rate.cross(t);
                rates.a -= b.cross(rate.cross(t));
                // B x (w x p) = w (B.p) - p (B.w).
                let outer = DMat3::from_cols(rate * b.x, rate * b.y, rate * b.z);
                rates.matrix += outer - DMat3::from_diagonal(DVec3::splat(b.dot(rate)));
                rates.w += rate;
                m *= rotation(axis, value);
            } else {
                rates.v += rate;
                rates.a += (rates.w * 2.0).cross(rate);
                t += along * value;
            }
        }
        t += m * self.last.translation();
        m *= self.last.matrix();
        let columns = [m.x_axis, m.y_axis, m.z_axis].map(flushed);
        let m = DMat3::from_cols(columns[0], columns[1], columns[2]);
        (Pose::checked(m, flushed(t)), rates)
    }

    /// How fast a body's points can be from a row to the next one.
    pub(super) fn most(&self, path: &JointPath, row: usize) -> Most {
        let (mut sum, mut derivatives) = (0.0_f64, [0.0; 3]);
        for stage in &self.stages {
            let rate = match stage.joint {
                Joint::Fixed => continue,
                _ => path.value(row, stage.column)[1].abs(),
            };
            if let Joint::Turning(_) = stage.joint {
                let next = sum + rate;
                derivatives[0] += rate * stage.lever;
                derivatives[1] += rate * (sum + next) * stage.lever;
                derivatives[2] += rate * (sum * sum + sum * next + next * next) * stage.lever;
                sum = next;
            } else {
                derivatives[0] += rate;
                derivatives[1] += 2.0 * sum * rate;
                derivatives[2] += 3.0 * sum * sum * rate;
            }
        }
        let count = self.stages.len() as f64;
        // Each term is of points at most the size away, turned by what is off.
        let share = 4.0 * self.tilt + 16.0 * count * f64::EPSILON;
        let slides = derivatives[0];
        let first = 2.0 * sum * self.size + slides;
        let off = [share * first, share * 2.0 * sum * first];
        Most { derivatives: derivatives.map(|x| x * RAISED), off }
    }

    /// Returns at least the third derivative of the body's points along normals between two, from a row to the next one.
    pub(super) fn third_along(&self, path: &JointPath, row: usize, normals: [DVec3; 2]) -> f64 {
        let longest = normals[0].length().max(normals[1].length());
        let aside = normals.map(|n| n.cross(self.first_axis).length());
        let mut along = aside[0].max(aside[1]) + ROUNDED * longest;
        // Of each turning joint its rate, and how much of what it moves is along the normals.
        let mut turning: Vec<[f64; 2]> = Vec::with_capacity(self.stages.len());
        let mut third = 0.0;
        for stage in &self.stages {
            let rate = match stage.joint {
                Joint::Fixed => continue,
                _ => path.value(row, stage.column)[1].abs(),
            };
            // The sum of the rates of the turning joints after one, and before this one.
            let mut between = 0.0;
            let slides = matches!(stage.joint, Joint::Sliding(_));
            for [first, share] in turning.iter().rev() {
                third += if slides {
                    3.0 * share * rate * first * (2.0 * between + first)
                } else {
                    3.0 * share * first * rate * (2.0 * between + first + rate) * stage.lever
                };
                between += first;
            }
            if !slides {
                along += stage.sine * longest;
                let share = along.min(longest);
                third += share * rate * rate * rate * stage.lever;
                turning.push([rate, share]);
            }
        }
        third * RAISED
    }

    /// How far points of the body can move from a row to the next one.
    pub(super) fn way(&self, path: &JointPath, row: usize) -> f64 {
        self.most(path, row).derivatives[0]
    }
}

/// The rotation about a unit vector by an angle.
fn rotation(axis: DVec3, angle: f64) -> DMat3 {
    let turn = turn(angle, 0.0);
    let turned = |z: DVec3| {
        let across = axis.cross(z);
        z + across * turn.sin + axis.cross(across) * turn.versine
    };
    DMat3::from_cols(turned(DVec3::X), turned(DVec3::Y), turned(DVec3::Z))
}

/// Components that are nothing beside others become zero.
fn flushed(v: DVec3) -> DVec3 {
    let flush = |x: f64| if x.abs() < MIN_MAGNITUDE { 0.0 } else { x };
    DVec3::new(flush(v.x), flush(v.y), flush(v.z))
}

#[cfg(test)]
mod tests {
    use super::super::mechanism::Frame;
    use super::*;

    /// A chain of joints in all directions, and its path.
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
        (mechanism, JointPath::evenly(rows).unwrap(), corners)
    }

    #[test]
    fn derivatives_are_those_of_the_places() {
        let (mechanism, path, corners) = chain();
        let last = Pose::from_translation(DVec3::X).unwrap();
        let chain = Chain::new(&mechanism, &[0, 1, 2, 3, 4, 5], &path, last, &corners);
        let most = chain.most(&path, 0);
        let h = 1e-3;
        for corner in &corners {
            for k in 1..20 {
                let share = f64::from(k) / 20.0;
                let place = |share: f64| chain.at(&path, 0, share).0.transform_point(*corner);
                let (pose, rates) = chain.at(&path, 0, share);
                let p = pose.transform_point(*corner);
                let near = [-2.0, -1.0, 1.0, 2.0].map(|x| place(share + h * x));
                let first = (near[2] - near[1]) / (2.0 * h);
                let second = (near[2] - 2.0 * p + near[1]) / (h * h);
                let third = (near[3] - 2.0 * near[2] + 2.0 * near[1] - near[0]) / (2.0 * h * h * h);
                let said = [rates.v + rates.w.cross(p), rates.a + rates.matrix * p];
                assert!(first.distance(said[0]) < 1e-6, "{first} {}", said[0]);
                assert!(second.distance(said[1]) < 1e-6, "{second} {}", said[1]);
                // Bounds are of all places of the joints, which the third derivative is far from here.
                for (found, most) in [first, second, third].iter().zip(most.derivatives) {
                    assert!(found.length() <= most && most < 30.0, "{} {most}", found.length());
                }
            }
        }
    }

    #[test]
    fn levers_are_near_what_they_bound() {
        // Two links of length 1 along x, joints about z, a body of reach 0.5: the first lever is 1.5 and the last 0.5.
        let joint = Joint::Turning(DVec3::Z);
        let elbow = Pose::from_translation(DVec3::new(1.0, 0.0, 7.0)).unwrap();
        let frames = vec![
            Frame { parent: None, origin: Pose::IDENTITY, joint },
            Frame { parent: Some(0), origin: elbow, joint },
        ];
        let path = JointPath::evenly(vec![vec![0.0, 0.0], vec![1.0, 0.0]]).unwrap();
        let mechanism = Mechanism::new(frames).unwrap();
        let corners = [DVec3::new(0.5, 0.0, 0.0)];
        let chain = Chain::new(&mechanism, &[0, 1], &path, Pose::IDENTITY, &corners);
        let way = chain.way(&path, 0);
        assert!((1.5..1.5 + 1e-6).contains(&way), "{way}");
        assert!(chain.error > 0.0 && chain.error < 1e-12, "{}", chain.error);
    }
}
