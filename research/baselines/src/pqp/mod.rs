//! PQP: distance, tolerance and intersection queries between triangle soups. Larsen, Gottschalk, Lin, Manocha, "Fast
//! proximity queries with swept sphere volumes", UNC TR99-018, 1999 (ICRA 2000: "Fast distance queries with rectangular
//! swept sphere volumes").
//!
//! Each soup has a tree of bounding volumes. *Rectangle swept spheres* yield lower bounds of distances, *oriented
//! boxes* exclude contacts. A query descends both trees at once and compares triangles at the leaves. Modules:
//! `triangle` (two triangles), `frame` (principal axes), `rss` and `obb` (volumes), `tree`, `soup`, `query`.
//!
//! Differences from the publication: nodes are split at the median if the mean is far off, so that the depth is
//! logarithmic. Volumes are stored in the soup's frame instead of the parent's, so that errors do not accumulate.
//! Volume tests subtract their rounding error, and a distance search ignores gains of that order.

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

/// The size of a configuration of two soups, and the rounding errors of lengths in it.
///
/// `S` is the sum of the largest distances of vertices from their frames' origins, plus the distance of the
/// frames. No coordinate in either frame exceeds it. After two changes of frame a coordinate has an error
/// below `16 u S`, `u = 2^-53`: three products, three sums and an entry of a rotation with an error of a few
/// `u`, twice. A projection on a computed direction has three times this error. The noise of `128 u S` is
/// more than twice that.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Scale {
    size: f64,
}

impl Scale {
    /// Creates the scale of a size.
    pub(crate) fn new(size: f64) -> Self {
        Self { size }
    }

    /// Returns the length below which differences of lengths are rounding errors.
    pub(crate) fn noise(self) -> f64 {
        64.0 * f64::EPSILON * self.size
    }

    /// Returns the area below which differences of products of two lengths are rounding errors.
    pub(crate) fn area_noise(self) -> f64 {
        2.0 * self.noise() * self.size
    }
}
