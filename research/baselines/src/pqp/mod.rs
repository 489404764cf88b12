//! PQP: distance, tolerance and intersection queries between triangle soups.
//!
//! Larsen, Gottschalk, Lin, Manocha, "Fast Proximity Queries with Swept Sphere Volumes" (UNC
//! TR99-018, 1999; ICRA 2000). Each soup carries a tree of bounding volumes, built once: *rectangle
//! swept spheres* bound distances from below, *oriented boxes* decide that there is no contact. A
//! query descends both trees at once and compares triangles at the leaves.
//!
//! Data flow: `triangle` (two triangles) -> `frame` (principal axes) -> `rss` and `obb` (one
//! volume, two volumes) -> `tree` (all volumes of a soup) -> `soup` -> `query`.
//!
//! What is as published: both volumes, their axes from the covariance of the vertices, nodes split
//! at the mean, one triangle per leaf, the descent into the larger volume, depth first with the
//! nearer pair first, the last closest pair of triangles as the first guess, the meaning of the two
//! error allowances.
//!
//! What is not: nodes are split at the median where the mean is far off, so that depth is
//! logarithmic for every input; volumes are kept in the soup's frame instead of the parent's, so
//! that nothing accumulates on the way down; volume tests subtract their rounding error, and a
//! distance search does not look for gains of its order.

mod frame;
mod obb;
mod query;
mod rss;
mod soup;
mod tree;
mod triangle;

#[cfg(test)]
mod tests;

pub use query::{Pqp, Steps};
pub use soup::{Soup, SoupError};

/// The size of a configuration of two soups and what rounding does to lengths in it.
///
/// `S` is the reach of both soups, the largest distance of a vertex from its frame's origin, plus
/// the distance of the frames: no coordinate in either frame exceeds it. A coordinate after two
/// changes of frame is wrong by less than `16 u S` (three products, three sums and an entry of a
/// rotation that is itself wrong by a few `u`, twice), a projection on a computed direction by
/// thrice as much; the noise of `128 u S`, `u = 2^-53`, is twice that again and more.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Scale {
    size: f64,
}

impl Scale {
    pub(crate) fn new(size: f64) -> Self {
        Self { size }
    }

    /// Differences of lengths below this mean nothing.
    pub(crate) fn noise(self) -> f64 {
        64.0 * f64::EPSILON * self.size
    }

    /// Differences of products of two lengths below this mean nothing.
    pub(crate) fn area_noise(self) -> f64 {
        2.0 * self.noise() * self.size
    }
}
