//! The lower bound: the linear programme over all pieces found so far.
//!
//! Notation. Minimise `t` over `(X, Y, t)` subject to `weight_i t >= value_i + gradient_i . (X,
//! Y)`. The dual multipliers `lambda_i >= 0` satisfy `sum lambda_i (weight_i, gradient_i) = (1, 0,
//! 0)`. Three pieces are the *basis*: their planes meet in the optimum, and `sum lambda_i normal_i`
//! is the normal of a supporting plane of the bodies that proves the bound `t`, whatever the
//! section levels are. A new piece that cuts off the optimum enters the basis in a pivot of the
//! dual simplex method; if none can leave, the pieces contradict each other: the bodies are
//! separated.

use glam::{DMat3, DVec2, DVec3};

use super::piece::{Affine, Piece};
use colltrans_kernel::noise;

/// The sides of the rectangle of levels, the artificial bound, and one piece per step.
const CAPACITY: usize = super::MAX_STEPS as usize + 5;

#[derive(Debug, Clone)]
pub(super) struct LowerBound {
    pieces: [Piece; CAPACITY],
    count: usize,
    basis: [usize; 3],
    /// Inverse of the matrix with the columns `(weight_i, gradient_i)` of the basis.
    inverse: DMat3,
    /// The optimum.
    pub(super) at: DVec2,
    pub(super) t: f64,
}

/// What adding a piece showed.
#[derive(Debug, Clone, Copy)]
pub(super) enum Progress {
    Bounded,
    /// A combination of pieces of weight 0 is positive everywhere: its normal separates the bodies.
    Contradiction(DVec3),
}

impl LowerBound {
    /// Over the rectangle from `low` to `high`, with a constant piece to begin with.
    pub(super) fn new([low, high]: [DVec2; 2], floor: Piece) -> Self {
        let side = |value, gradient| Piece {
            bound: Affine { value, gradient },
            weight: 0.0,
            normal: DVec3::ZERO,
        };
        let mut pieces = [Piece::default(); CAPACITY];
        pieces[0] = floor;
        pieces[1] = side(low.x, DVec2::NEG_X);
        pieces[2] = side(low.y, DVec2::NEG_Y);
        pieces[3] = side(-high.x, DVec2::X);
        pieces[4] = side(-high.y, DVec2::Y);
        let mut bound = Self {
            pieces,
            count: 5,
            basis: [0, 1, 2],
            inverse: DMat3::IDENTITY,
            at: low,
            t: floor.bound.value,
        };
        bound.inverse = bound.basis_matrix().inverse();
        bound
    }

    /// Adds a piece, relative to the same origin as the rectangle.
    pub(super) fn add(&mut self, piece: Piece) -> Progress {
        self.pieces[self.count] = piece;
        self.count += 1;
        // Each pivot raises `t` or, in a tie, leaves it: the limit ends a cycle of ties.
        for _ in 0..2 * self.count {
            let Some(entering) = self.most_violated() else { break };
            if let Err(normal) = self.pivot(entering) {
                return Progress::Contradiction(normal);
            }
        }
        Progress::Bounded
    }

    /// The greatest lower bound of `phi` at a point that a piece gives.
    pub(super) fn below(&self, at: DVec2) -> f64 {
        let pieces = self.pieces[..self.count].iter().filter(|piece| piece.weight > 0.0);
        pieces
            .map(|piece| piece.bound.value + piece.bound.gradient.dot(at))
            .fold(f64::NEG_INFINITY, f64::max)
    }

    /// The normal that proves the bound; of no use while the floor is in the basis.
    pub(super) fn normal(&self) -> DVec3 {
        let multipliers = self.inverse * DVec3::X;
        self.combine(multipliers)
    }

    fn combine(&self, multipliers: DVec3) -> DVec3 {
        let terms = self.basis.iter().zip(multipliers.to_array());
        terms.map(|(&i, m)| self.pieces[i].normal * m).sum()
    }

    fn basis_matrix(&self) -> DMat3 {
        let [i, j, k] = self.basis.map(|i| column(&self.pieces[i]));
        DMat3::from_cols(i, j, k)
    }

    fn violation(&self, piece: &Piece) -> f64 {
        piece.bound.value + piece.bound.gradient.dot(self.at) - piece.weight * self.t
    }

    /// The piece that cuts off the optimum by most, if any does by more than rounding.
    fn most_violated(&self) -> Option<usize> {
        let mut worst = None;
        let mut most = 0.0;
        for (index, piece) in self.pieces[..self.count].iter().enumerate() {
            let violation = self.violation(piece);
            if violation > most && !self.basis.contains(&index) {
                let size = piece.bound.value.abs()
                    + piece.bound.gradient.abs().dot(self.at.abs())
                    + (piece.weight * self.t).abs();
                if violation > noise::SECTION * size {
                    (worst, most) = (Some(index), violation);
                }
            }
        }
        worst
    }

    /// Exchanges a piece of the basis for `entering`. An error if none can leave: the normal of the
    /// contradiction.
    fn pivot(&mut self, entering: usize) -> Result<(), DVec3> {
        let multipliers = self.inverse * DVec3::X;
        let entering_column = column(&self.pieces[entering]);
        let rates = self.inverse * entering_column;
        // What the terms of a rate could have been rounded by.
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
            return Err(self.pieces[entering].normal - self.combine(rates));
        };
        self.basis[slot] = entering;
        self.exchange(slot, rates);
        let values = DVec3::from_array(self.basis.map(|i| self.pieces[i].bound.value));
        let optimum = self.inverse.transpose() * values;
        self.t = optimum.x;
        self.at = -DVec2::new(optimum.y, optimum.z);
        Ok(())
    }

    /// Gauss-Jordan: the inverse after the column with the coordinates `rates` has replaced that of
    /// `slot`.
    fn exchange(&mut self, slot: usize, rates: DVec3) {
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

fn column(piece: &Piece) -> DVec3 {
    DVec3::new(piece.weight, piece.bound.gradient.x, piece.bound.gradient.y)
}
