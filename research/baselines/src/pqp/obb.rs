//! Oriented boxes.
//!
//! Two boxes are disjoint exactly if one of 15 axes separates them: three axes of each box and their nine
//! cross products (Gottschalk, Lin, Manocha, "`OBBTree`: a hierarchical structure for rapid interference detection",
//! SIGGRAPH 1996). `A` has half sides `a_i` along the axes of its frame. In that frame, `B` has centre `t`, half sides
//! `b_j` and axes `r_j`.

use glam::{DMat3, DVec3};

/// A box: its centre in the soup's frame, and half sides along the axes of the [`Rss`](super::rss::Rss) of
/// the same node.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Obb {
    pub(crate) center: DVec3,
    pub(crate) half: DVec3,
}

impl Obb {
    /// Returns the box of points, given by their coordinates along `axes`.
    pub(crate) fn fit(axes: DMat3, points: &[DVec3]) -> Self {
        let low = points.iter().copied().reduce(DVec3::min).unwrap_or_default();
        let high = points.iter().copied().reduce(DVec3::max).unwrap_or_default();
        Self { center: axes * ((low + high) * 0.5), half: (high - low) * 0.5 }
    }

    /// Checks whether the boxes are farther apart than `noise` along one of the 15 axes. `axes` belong to
    /// this box; `center` and `other_axes` place the other one in the same frame.
    #[inline]
    pub(crate) fn is_clear_of(
        &self,
        axes: &DMat3,
        other: &Self,
        center: DVec3,
        other_axes: DMat3,
        noise: f64,
    ) -> bool {
        let to_own = axes.transpose();
        let t = (to_own * (center - self.center)).to_array();
        let r = (to_own * other_axes).to_cols_array_2d();
        let size = r.map(|column| column.map(f64::abs));
        let (a, b) = (self.half.to_array(), other.half.to_array());
        let clear = |along: f64, reach: f64| along.abs() > reach + noise;
        let reach_b = |i: usize| b[0] * size[0][i] + b[1] * size[1][i] + b[2] * size[2][i];
        let reach_a = |j: usize| a[0] * size[j][0] + a[1] * size[j][1] + a[2] * size[j][2];
        let along = |j: usize| t[0] * r[j][0] + t[1] * r[j][1] + t[2] * r[j][2];
        (0..3).any(|i| clear(t[i], a[i] + reach_b(i)))
            || (0..3).any(|j| clear(along(j), b[j] + reach_a(j)))
            || (0..3).any(|i| {
                let (k, l) = ((i + 1) % 3, (i + 2) % 3);
                (0..3).any(|j| {
                    // Along e_i x r_j.
                    let (m, n) = ((j + 1) % 3, (j + 2) % 3);
                    let reach_a = a[k] * size[j][l] + a[l] * size[j][k];
                    let reach_b = b[m] * size[n][i] + b[n] * size[m][i];
                    clear(t[l] * r[j][k] - t[k] * r[j][l], reach_a + reach_b)
                })
            })
    }
}
