//! Certificates: proofs of an answer that two support evaluations can check.
//!
//! Notation (section 1 of the paper). `P` moves along `d`, `Q` is fixed, both are placed in the world;
//! `M = {q - p : p in P, q in Q}`. The line `t d` meets `M` for `t` in `[coll, exit]`.
//!
//! - Lower bound: for any `n` with `n.d > 0`, `coll >= (min_Q n.q - max_P n.p) / n.d`.
//! - Upper bound: weights `w_i >= 0` with sum 1 over pairs of vertices `(p_i, q_i)` such that
//!   `sum w_i (q_i - p_i) = t d`; then `coll <= t`.
//! - Separation: `n` with `n.d = 0` and `min_Q n.q - max_P n.p > 0`.

use glam::DVec3;

/// One vertex of each body, by index.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct VertexPair {
    /// Index into the moving body's vertices.
    pub moving: u32,
    /// Index into the fixed body's vertices.
    pub fixed: u32,
}

/// Both bounds of a collision translation with their proofs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Certificate {
    /// Unit normal of the supporting plane that proves the lower bound, in the world; `normal . d > 0`.
    pub normal: DVec3,
    /// The lower bound it proves, in multiples of the direction.
    pub lower: f64,
    /// Three pairs of vertices whose differences `q - p` have the line `t d` pass through their triangle.
    pub pairs: [VertexPair; 3],
    /// The weights (barycentric coordinates) of the pairs where the line passes: not negative, sum 1.
    /// The witness points are `sum w_i p_i` and `sum w_i q_i`.
    pub weights: [f64; 3],
    /// The upper bound they prove, in multiples of the direction.
    pub upper: f64,
    /// What rounding alone can make of `upper - lower` at the size of this configuration.
    pub tolerance: f64,
}

/// The proof that two bodies never meet along the direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Separation {
    /// Unit normal in the world, orthogonal to the direction, from the moving body to the fixed one.
    pub normal: DVec3,
    /// `min_Q n.q - max_P n.p > 0`: how far the shadows stay apart along `normal`, in world units.
    pub margin: f64,
}
