//! A setting in exact coordinates: both bodies in the world, and the direction.
//!
//! Notation. `P` moves along `d`, `Q` is fixed, `M = {q - p}`. The position of a body is defined by the nine
//! entries of its rotation matrix and by its translation, all taken as exact numbers. The *shadow* of a point
//! is its residue modulo `d`. Let `k` be an axis with `d_k != 0`, and `i, j` the others. The coordinates of a
//! shadow are `s_i = m_i d_k - m_k d_i`, and `s_j` analogously. They are exact, zero along `d`, and an affine
//! image of the orthogonal projection.

use colltrans::{Cast, Pose};
use dashu_int::IBig;
use glam::DVec3;

use crate::oracle::exact::{Dyadic, Vector, place};
use crate::shapes::reach;

/// Two bodies in the world and a direction.
#[derive(Debug, Clone)]
pub struct Scene {
    /// The vertices of the moving body in the world.
    pub moving: Vec<Vector>,
    /// The vertices of the fixed body in the world.
    pub fixed: Vec<Vector>,
    /// The direction.
    pub direction: Vector,
    /// The size `S` of the configuration. The distance of two vertices is at most `S`.
    pub size: f64,
    /// The noise of the library: `32 u S` with `u = 2^-53`.
    pub noise: f64,
    /// The touching distance, 8 noises: the lateral overlap up to which a contact is grazing by default.
    pub touching: f64,
    /// The axis `k` along which `d` has the largest component.
    pub(crate) main_axis: usize,
}

impl Scene {
    /// Places two bodies, given by their vertices.
    pub fn new(
        (moving, moving_pose): (&[DVec3], &Pose),
        (fixed, fixed_pose): (&[DVec3], &Pose),
        direction: DVec3,
    ) -> Self {
        let size = size([moving, fixed], [moving_pose, fixed_pose]);
        let sizes = direction.abs().to_array();
        let main_axis = (0..3).fold(0, |k, i| if sizes[i] > sizes[k] { i } else { k });
        let noise = 16.0 * f64::EPSILON * size.max(colltrans::MIN_MAGNITUDE);
        Self {
            moving: place(moving_pose.matrix(), moving_pose.translation(), moving),
            fixed: place(fixed_pose.matrix(), fixed_pose.translation(), fixed),
            direction: Vector::new(direction),
            size,
            noise,
            touching: 8.0 * noise,
            main_axis,
        }
    }

    /// Builds the scene of a cast from the vertices of its bodies.
    pub fn from_cast(cast: &Cast) -> Self {
        let (moving, fixed) = (cast.moving().vertices(), cast.fixed().vertices());
        let (moving_pose, fixed_pose) = (cast.moving_pose(), cast.fixed_pose());
        Self::new((moving, &moving_pose), (fixed, &fixed_pose), cast.direction())
    }

    /// Returns the differences `q - p` of all pairs of vertices `p, q`.
    pub fn differences(&self) -> Vec<Vector> {
        self.fixed.iter().flat_map(|q| self.moving.iter().map(move |p| q.minus(p))).collect()
    }

    /// Returns the shadow coordinates of a point.
    pub fn shadow(&self, point: &Vector) -> [Dyadic; 2] {
        let (k, d) = (self.main_axis, &self.direction.0);
        [(k + 1) % 3, (k + 2) % 3].map(|i| &(&point.0[i] * &d[k]) - &(&point.0[k] * &d[i]))
    }

    /// Returns `t |d_k|` of a point on the line `t d`.
    pub(crate) fn height(&self, point: &Vector) -> Dyadic {
        let k = self.main_axis;
        if self.direction.0[k].is_negative() { -point.0[k].clone() } else { point.0[k].clone() }
    }

    /// Returns `|d_k|`.
    pub(crate) fn height_unit(&self) -> Dyadic {
        self.direction.0[self.main_axis].clone().abs()
    }
}

/// Returns the size `S` of two placed bodies: the sum of their largest vertex distances from their origins and
/// of the distance of the origins.
pub fn size(vertices: [&[DVec3]; 2], poses: [&Pose; 2]) -> f64 {
    let offset = poses[1].translation() - poses[0].translation();
    reach(vertices[0]) + reach(vertices[1]) + offset.length()
}

/// Returns the numbers as integers in a common unit `2^exponent`, and the exponent.
pub(crate) fn in_common_unit(numbers: &[Dyadic]) -> (Vec<IBig>, i32) {
    let exponent = numbers.iter().filter(|x| !x.is_zero()).map(Dyadic::exponent).min().unwrap_or(0);
    (numbers.iter().map(|x| x.in_units_of(exponent)).collect(), exponent)
}
