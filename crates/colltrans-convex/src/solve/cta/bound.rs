//! The lower bound of `phi`: a linear programme over all pieces found so far, solved by the dual simplex
//! method.
//!
//! The programme minimises `t` over `(X, Y, t)` subject to `weight_i t >= value_i + gradient_i . (X, Y)`.
//!
//! - *Multipliers*: `lambda_i >= 0` with `sum lambda_i (weight_i, gradient_i) = (1, 0, 0)`.
//! - *Basis*: the three pieces whose planes meet in the optimum. The normal `sum lambda_i normal_i` proves the
//!   bound `t` for all section levels.
//! - *Pivot*: a new piece that cuts off the optimum enters the basis. If no piece can leave the basis, the
//!   pieces contradict each other, and the bodies are separated.

use glam::{DMat3, DVec2, DVec3};

use super::piece::{Affine, LinearPiece};
use colltrans_kernel::noise;

/// Maximum number of pieces: the floor, the four sides of the rectangle of levels, and one piece for each
/// planar problem.
const MAX_PIECES: usize = super::MAX_STEPS as usize + 5;

/// The linear programme and its optimum. Levels are relative to the middle of all levels.
#[derive(Debug, Clone)]
pub(super) struct LowerBound {
    constraints: [Constraint; MAX_PIECES],
    /// Normals of the pieces. They are read only at the end, therefore they are separate.
    normals: [DVec3; MAX_PIECES],
    count: usize,
    basis: [usize; 3],
    /// Inverse of the matrix with the columns `(weight_i, gradient_i)` of the basis.
    inverse: DMat3,
    /// Levels of the optimum.
    pub(super) optimum: DVec2,
    /// Least feasible `t`: the lower bound of `phi`, without the constant of the section pair.
    pub(super) least_t: f64,
}

/// Constraint `weight * t >= value + gradient . (X, Y)` of a piece.
#[derive(Debug, Clone, Copy, Default)]
struct Constraint {
    bound: Affine,
    weight: f64,
}

impl Constraint {
    /// Returns `(weight, gradient)`.
    fn column(&self) -> DVec3 {
        DVec3::new(self.weight, self.bound.gradient.x, self.bound.gradient.y)
    }
}

/// State of the programme after a piece was added.
#[derive(Debug, Clone, Copy)]
pub(super) enum BoundStatus {
    /// The programme has a finite optimum.
    Bounded,
    /// The constraints have no solution: a combination of pieces of weight 0 is positive at all levels. Its
    /// normal separates the bodies.
    Contradiction(DVec3),
}

impl LowerBound {
    /// Builds the programme over the rectangle from `low` to `high`, with the constant piece `floor`. Its first
    /// optimum is at `low`.
    pub(super) fn new([low, high]: [DVec2; 2], floor: LinearPiece) -> Self {
        let half_plane =
            |value, gradient| Constraint { bound: Affine { value, gradient }, weight: 0.0 };
        let mut constraints = [Constraint::default(); MAX_PIECES];
        constraints[..5].copy_from_slice(&[
            Constraint { bound: floor.bound, weight: floor.weight },
            half_plane(low.x, DVec2::NEG_X),
            half_plane(low.y, DVec2::NEG_Y),
            half_plane(-high.x, DVec2::X),
            half_plane(-high.y, DVec2::Y),
        ]);
        let mut normals = [DVec3::ZERO; MAX_PIECES];
        normals[0] = floor.normal;
        let mut bound = Self {
            constraints,
            normals,
            count: 5,
            basis: [0, 1, 2],
            inverse: DMat3::IDENTITY,
            optimum: low,
            least_t: floor.bound.value,
        };
        bound.inverse = bound.basis_matrix().inverse();
        bound
    }

    /// Adds a piece and pivots until no piece cuts off the optimum. The levels of the piece have the same
    /// origin as the rectangle.
    pub(super) fn add_piece(&mut self, piece: LinearPiece) -> BoundStatus {
        let LinearPiece { bound, weight, normal } = piece;
        self.constraints[self.count] = Constraint { bound, weight };
        self.normals[self.count] = normal;
        self.count += 1;
        // Each pivot raises `t` or, in a tie, leaves it. The limit ends a cycle of ties.
        for _ in 0..2 * self.count {
            let Some(entering) = self.most_violated_piece() else { break };
            if let Err(normal) = self.pivot_into_basis(entering) {
                return BoundStatus::Contradiction(normal);
            }
        }
        BoundStatus::Bounded
    }

    /// Returns the greatest value of the pieces of positive weight at the levels `at`: a lower bound of `phi`
    /// there.
    pub(super) fn lower_bound_at(&self, at: DVec2) -> f64 {
        let pieces = self.constraints[..self.count].iter().filter(|piece| piece.weight > 0.0);
        pieces
            .map(|piece| piece.bound.value + piece.bound.gradient.dot(at))
            .fold(f64::NEG_INFINITY, f64::max)
    }

    /// Returns the normal that proves the bound. It is meaningless while the floor, whose normal is zero, is in
    /// the basis.
    pub(super) fn proven_normal(&self) -> DVec3 {
        let multipliers = self.inverse * DVec3::X;
        self.weighted_normal(multipliers)
    }

    /// Returns the sum of the basis' normals with these multipliers.
    fn weighted_normal(&self, multipliers: DVec3) -> DVec3 {
        let terms = self.basis.iter().zip(multipliers.to_array());
        terms.map(|(&i, m)| self.normals[i] * m).sum()
    }

    /// Returns the matrix with the columns `(weight_i, gradient_i)` of the basis.
    fn basis_matrix(&self) -> DMat3 {
        let [i, j, k] = self.basis.map(|i| self.constraints[i].column());
        DMat3::from_cols(i, j, k)
    }

    /// Returns the difference of a piece and the optimum; positive if the piece cuts it off.
    fn piece_violation(&self, piece: &Constraint) -> f64 {
        piece.bound.value + piece.bound.gradient.dot(self.optimum) - piece.weight * self.least_t
    }

    /// Finds the piece outside the basis that cuts off the most. `None` if no piece does so by more than
    /// rounding.
    fn most_violated_piece(&self) -> Option<usize> {
        let mut worst = None;
        let mut most = 0.0;
        for (index, piece) in self.constraints[..self.count].iter().enumerate() {
            let violation = self.piece_violation(piece);
            if violation > most && !self.basis.contains(&index) {
                let size = piece.bound.value.abs()
                    + piece.bound.gradient.abs().dot(self.optimum.abs())
                    + (piece.weight * self.least_t).abs();
                if violation > noise::SECTION * size {
                    (worst, most) = (Some(index), violation);
                }
            }
        }
        worst
    }

    /// Exchanges a piece of the basis for `entering`.
    ///
    /// # Errors
    ///
    /// Returns the normal of the contradiction if no piece can leave the basis.
    fn pivot_into_basis(&mut self, entering: usize) -> Result<(), DVec3> {
        let multipliers = self.inverse * DVec3::X;
        let entering_column = self.constraints[entering].column();
        let rates = self.inverse * entering_column;
        // Bound on the rounding error of a rate.
        let noise = |slot| noise::SECTION * self.inverse.row(slot).abs().dot(entering_column.abs());
        let mut leaving = None;
        let mut least = f64::INFINITY;
        for slot in 0..3 {
            if rates[slot] > noise(slot) {
                let ratio = multipliers[slot].max(0.0) / rates[slot];
                if ratio < least {
                    (leaving, least) = (Some(slot), ratio);
                }
            }
        }
        let Some(slot) = leaving else {
            return Err(self.normals[entering] - self.weighted_normal(rates));
        };
        self.basis[slot] = entering;
        self.replace_inverse_column(slot, rates);
        let values = DVec3::from_array(self.basis.map(|i| self.constraints[i].bound.value));
        let dual_values = self.inverse.transpose() * values;
        self.least_t = dual_values.x;
        self.optimum = -DVec2::new(dual_values.y, dual_values.z);
        Ok(())
    }

    /// Updates the inverse by a Gauss-Jordan step: the column with the coordinates `rates` replaces the column
    /// of `slot`.
    fn replace_inverse_column(&mut self, slot: usize, rates: DVec3) {
        let pivot_row = self.inverse.row(slot) / rates[slot];
        let mut others = rates;
        others[slot] = 0.0;
        let mut kept = DVec3::ONE;
        kept[slot] = 0.0;
        let mut unit = DVec3::ZERO;
        unit[slot] = 1.0;
        let column =
            |c: usize| (self.inverse.col(c) * kept) - others * pivot_row[c] + unit * pivot_row[c];
        self.inverse = DMat3::from_cols(column(0), column(1), column(2));
    }
}
