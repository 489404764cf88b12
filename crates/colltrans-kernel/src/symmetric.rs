//! Symmetric 3 x 3 matrices.

use glam::{DMat3, DVec3};

/// A symmetric 3 x 3 matrix.
#[derive(Debug, Clone, Copy)]
pub struct Symmetric {
    pub xx: f64,
    pub xy: f64,
    pub xz: f64,
    pub yy: f64,
    pub yz: f64,
    pub zz: f64,
}

impl Symmetric {
    /// Computes the Gram matrix `w^T w`.
    #[inline]
    pub fn gram_matrix(w: &DMat3) -> Self {
        let (x, y, z) = (w.x_axis, w.y_axis, w.z_axis);
        Self { xx: x.dot(x), xy: x.dot(y), xz: x.dot(z), yy: y.dot(y), yz: y.dot(z), zz: z.dot(z) }
    }

    /// Computes `f self + g other`.
    #[inline]
    #[must_use]
    pub fn linear_combination(&self, f: f64, other: &Self, g: f64) -> Self {
        Self {
            xx: f * self.xx + g * other.xx,
            xy: f * self.xy + g * other.xy,
            xz: f * self.xz + g * other.xz,
            yy: f * self.yy + g * other.yy,
            yz: f * self.yz + g * other.yz,
            zz: f * self.zz + g * other.zz,
        }
    }

    /// Computes `self + t I`, with the identity `I`.
    #[inline]
    #[must_use]
    pub fn plus_diagonal(&self, t: f64) -> Self {
        Self { xx: self.xx + t, yy: self.yy + t, zz: self.zz + t, ..*self }
    }

    #[inline]
    pub fn times_vector(&self, v: DVec3) -> DVec3 {
        DVec3::new(
            self.xx * v.x + self.xy * v.y + self.xz * v.z,
            self.xy * v.x + self.yy * v.y + self.yz * v.z,
            self.xz * v.x + self.yz * v.y + self.zz * v.z,
        )
    }

    /// Computes the quadratic form `v^T self v`.
    #[inline]
    pub fn quadratic_form(&self, v: DVec3) -> f64 {
        v.dot(self.times_vector(v))
    }

    /// Computes the adjugate `J`, so that `self^-1 = J / det`, and the determinant `det`.
    #[inline]
    pub fn adjugate(&self) -> (Self, f64) {
        let xx = self.yy * self.zz - self.yz * self.yz;
        let xy = self.xz * self.yz - self.xy * self.zz;
        let xz = self.xy * self.yz - self.xz * self.yy;
        let adjugate = Self {
            xx,
            xy,
            xz,
            yy: self.xx * self.zz - self.xz * self.xz,
            yz: self.xy * self.xz - self.xx * self.yz,
            zz: self.xx * self.yy - self.xy * self.xy,
        };
        (adjugate, self.xx * xx + self.xy * xy + self.xz * xz)
    }
}
