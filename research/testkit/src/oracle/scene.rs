//! A setting in exact coordinates: both bodies in the world, and the direction.
//!
//! Notation. `P` moves along `d`, `Q` is fixed; `M = {q - p}`. A body stands where the nine entries
//! of its pose's matrix and its translation, all taken as exact numbers, put it. A *shadow* is what
//! is left of a point modulo `d`. With `k` an axis where `d_k != 0` and `i, j` the other two, its
//! coordinates here are `s_i = m_i d_k - m_k d_i` and `s_j` alike: exact, zero along `d`, an affine
//! image of the orthogonal projection.

use colltrans::{Cast, Pose};
use dashu_int::IBig;
use glam::DVec3;

use crate::oracle::exact::{Dyadic, Vector, place};
use crate::shapes::reach;

/// Two bodies in the world and a direction.
#[derive(Debug, Clone)]
pub struct Scene {
    /// Vertices of the moving body in the world.
    pub moving: Vec<Vector>,
    /// Vertices of the fixed body in the world.
    pub fixed: Vec<Vector>,
    /// The direction.
    pub direction: Vector,
    /// Size `S` of the configuration: no vertices of the two bodies are farther apart.
    pub size: f64,
    /// What the library states as its rounding error: `32 u S`, with `u = 2^-53`.
    pub noise: f64,
    /// The sideways overlap up to which the library calls a contact grazing by itself: `8` times
    /// that.
    pub touching: f64,
    /// The axis `k` along which `d` is largest.
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

    /// The scene of a query: its bodies' vertices are what counts.
    pub fn of(cast: &Cast) -> Self {
        let (moving, fixed) = (cast.moving().vertices(), cast.fixed().vertices());
        let (moving_pose, fixed_pose) = (cast.moving_pose(), cast.fixed_pose());
        Self::new((moving, &moving_pose), (fixed, &fixed_pose), cast.direction())
    }

    /// All points `q - p` for vertices `p, q`.
    pub fn differences(&self) -> Vec<Vector> {
        self.fixed.iter().flat_map(|q| self.moving.iter().map(move |p| q.minus(p))).collect()
    }

    /// The shadow coordinates of a point.
    pub fn shadow(&self, point: &Vector) -> [Dyadic; 2] {
        let (k, d) = (self.main_axis, &self.direction.0);
        [(k + 1) % 3, (k + 2) % 3].map(|i| &(&point.0[i] * &d[k]) - &(&point.0[k] * &d[i]))
    }

    /// `t |d_k|` of a point on the line `t d`.
    pub(crate) fn height(&self, point: &Vector) -> Dyadic {
        let k = self.main_axis;
        if self.direction.0[k].is_negative() { -point.0[k].clone() } else { point.0[k].clone() }
    }

    /// `|d_k|`.
    pub(crate) fn height_unit(&self) -> Dyadic {
        self.direction.0[self.main_axis].clone().abs()
    }
}

/// Returns the size `S` of two placed bodies by their vertices: the sum of how far they reach and how far they are apart.
pub fn size(vertices: [&[DVec3]; 2], poses: [&Pose; 2]) -> f64 {
    let offset = poses[1].translation() - poses[0].translation();
    reach(vertices[0]) + reach(vertices[1]) + offset.length()
}

/// The numbers as integers in one common unit `2^exponent`.
pub(crate) fn in_common_unit(numbers: &[Dyadic]) -> (Vec<IBig>, i32) {
    let exponent = numbers.iter().filter(|x| !x.is_zero()).map(Dyadic::exponent).min().unwrap_or(0);
    (numbers.iter().map(|x| x.in_units_of(exponent)).collect(), exponent)
}
