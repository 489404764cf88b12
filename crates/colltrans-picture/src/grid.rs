//! A grid of samples over a page, and the samples that a triangle covers.
//!
//! Notation. A point of the page has coordinates (x, y) in pixels, and a depth that increases towards the
//! viewer. Planes of the scene are planes in these coordinates. A *sample* is the centre of a cell of `1 /
//! fine` pixels.

use glam::{DVec2, DVec3};

use crate::Frame;

/// The meaning of depths.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Depth {
    /// Lengths along the viewing direction, in an orthographic view.
    Length,
    /// Inverse distances along the viewing direction, in a perspective view.
    Inverse,
}

impl Depth {
    /// Returns the depth of a point that is nearer by the length `by`.
    pub(crate) fn moved_nearer(self, depth: f64, by: f64) -> f64 {
        match self {
            Self::Length => depth + by,
            // A point that would be behind the viewer has the largest depth.
            Self::Inverse if depth * by >= 1.0 => f64::INFINITY,
            Self::Inverse => depth / (1.0 - depth * by),
        }
    }

    /// Returns the length by which the first depth is farther from the viewer than the second.
    pub(crate) fn distance_between(self, far: f64, near: f64) -> f64 {
        match self {
            Self::Length => near - far,
            Self::Inverse => 1.0 / far - 1.0 / near,
        }
    }
}

/// The positions of the samples.
pub(crate) struct Grid {
    pub(crate) width: usize,
    pub(crate) height: usize,
    fine: usize,
}

impl Grid {
    /// Builds the grid over a window that begins at (0, 0).
    pub(crate) fn new(window: Frame, fine: usize) -> Self {
        let [width, height] = window.high.to_array().map(|side| side.ceil() as usize * fine);
        Self { width, height, fine }
    }

    /// Returns the number of cells.
    pub(crate) fn len(&self) -> usize {
        self.width * self.height
    }

    /// Checks whether a point is on the page.
    pub(crate) fn contains(&self, at: DVec2) -> bool {
        let at = at * self.fine as f64;
        at.cmpge(DVec2::ZERO).all() && at.x < self.width as f64 && at.y < self.height as f64
    }

    /// Returns the indices of the cell of a point and of its neighbours, without cells outside of the page.
    pub(crate) fn cells_around(&self, at: DVec2) -> impl Iterator<Item = usize> + use<'_> {
        let [x, y] = (at * self.fine as f64).to_array().map(|c| c.floor() as isize);
        let cell_range = |c: isize, count: usize| {
            let [from, to] = [c.saturating_sub(1), c.saturating_add(2)]
                .map(|c| c.clamp(0, count as isize) as usize);
            from..to
        };
        let columns = cell_range(x, self.width);
        cell_range(y, self.height)
            .flat_map(move |y| columns.clone().map(move |x| y * self.width + x))
    }

    /// Calls `visit` for each sample that a triangle covers, its boundary included, with the index of the cell
    /// and the depth. Triangles that are seen edge-on or have coordinates that are not finite cover no samples.
    pub(crate) fn visit_covered(&self, corners: [DVec3; 3], mut visit: impl FnMut(usize, f64)) {
        let [a, b, c] = corners.map(|p| (p.truncate() * self.fine as f64 - 0.5).extend(p.z));
        let (u, v) = (b - a, c - a);
        let twice = u.x * v.y - u.y * v.x;
        let slope_x = (u.z * v.y - v.z * u.y) / twice;
        let slope_y = (v.z * u.x - u.z * v.x) / twice;
        if ![twice, slope_x, slope_y].into_iter().all(f64::is_finite) {
            return;
        }
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        for y in cell_range(low.y, high.y, self.height) {
            let [left, right] = crossing_range([a, b, c], y as f64);
            for x in cell_range(left, right, self.width) {
                let depth = a.z + slope_x * (x as f64 - a.x) + slope_y * (y as f64 - a.y);
                // The plane of a triangle that is nearly edge-on is steep. Without the limits, rounding would
                // leave the triangle's depths.
                visit(y * self.width + x, depth.clamp(low.z, high.z));
            }
        }
    }
}

/// Returns the integers of a range that are below `count`.
fn cell_range(low: f64, high: f64, count: usize) -> std::ops::Range<usize> {
    let from = low.ceil().clamp(0.0, count as f64) as usize;
    from..((high.floor() + 1.0).clamp(0.0, count as f64) as usize).max(from)
}

/// Returns the range of x in which a triangle crosses a row.
fn crossing_range([a, b, c]: [DVec3; 3], row: f64) -> [f64; 2] {
    let (mut left, mut right) = (f64::INFINITY, f64::NEG_INFINITY);
    for [p, q] in [[a, b], [b, c], [c, a]] {
        if (p.y <= row) != (q.y <= row) || p.y == row {
            let share = if p.y == q.y { 0.0 } else { (row - p.y) / (q.y - p.y) };
            let x = p.x + share.clamp(0.0, 1.0) * (q.x - p.x);
            (left, right) = (left.min(x), right.max(x));
        }
    }
    [left, right]
}

#[cfg(test)]
pub(crate) mod tests {
    use std::collections::HashMap;

    use colltrans_testkit::random::Random;

    use super::*;

    pub(crate) const WINDOW: Frame = Frame { low: DVec2::ZERO, high: DVec2::new(60.0, 40.0) };

    /// Returns the corners of a random triangle, partly outside of the page.
    pub(crate) fn random_corners(random: &mut Random) -> [DVec3; 3] {
        std::array::from_fn(|_| {
            let (x, y) = (random.range(-10.0, 70.0), random.range(-10.0, 50.0));
            DVec3::new(x, y, random.range(0.5, 1.5))
        })
    }

    /// Returns the depth of a triangle at a point; `None` if it does not cover the point.
    pub(crate) fn depth_at(at: DVec2, [a, b, c]: [DVec3; 3]) -> Option<f64> {
        let area = |p: DVec2, q: DVec2, r: DVec2| (q - p).perp_dot(r - p);
        let [p, q, r] = [a, b, c].map(DVec3::truncate);
        let shares = [area(q, r, at), area(r, p, at), area(p, q, at)].map(|w| w / area(p, q, r));
        let depth = shares[0] * a.z + shares[1] * b.z + shares[2] * c.z;
        shares.iter().all(|&w| w >= 0.0).then_some(depth)
    }

    /// Returns the centre of a cell.
    pub(crate) fn cell_centre(cell: usize, grid: &Grid) -> DVec2 {
        let (x, y) = (cell % grid.width, cell / grid.width);
        DVec2::new(x as f64 + 0.5, y as f64 + 0.5) / grid.fine as f64
    }

    #[test]
    fn triangle_covers_the_samples_inside_it() {
        let mut random = Random::new(3);
        let grid = Grid::new(WINDOW, 2);
        for _ in 0..200 {
            let corners = random_corners(&mut random);
            let mut covered = HashMap::new();
            grid.visit_covered(corners, |cell, depth| {
                assert_eq!(covered.insert(cell, depth), None, "a sample is visited once");
            });
            for cell in 0..grid.len() {
                let wanted = depth_at(cell_centre(cell, &grid), corners);
                let got = covered.get(&cell);
                assert_eq!(got.is_some(), wanted.is_some(), "{cell} of {corners:?}");
                assert!(got.zip(wanted).is_none_or(|(a, b)| (a - b).abs() < 1e-9));
            }
        }
    }

    #[test]
    fn edge_on_or_non_finite_triangles_cover_nothing() {
        let grid = Grid::new(WINDOW, 2);
        let v = DVec3::new;
        let on_edge = [v(5.0, 5.0, 1.0), v(10.0, 10.0, 2.0), v(20.0, 20.0, 1.0)];
        let point = [v(5.25, 5.25, 1.0); 3];
        let mut hostile = vec![on_edge, point];
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX] {
            for k in 0..3 {
                let mut corner = v(30.0, 5.0, 1.0);
                corner[k] = bad;
                hostile.push([v(5.0, 5.0, 1.0), corner, v(5.0, 30.0, 1.0)]);
                hostile.push([corner, v(5.0, 5.0, 1.0), v(5.0, 30.0, 1.0)]);
            }
        }
        for corners in hostile {
            grid.visit_covered(corners, |cell, depth| {
                assert!(depth.is_finite(), "{cell} of {corners:?}");
            });
        }
        for corners in
            [on_edge, point, [v(f64::NAN, 0.0, 1.0), v(60.0, 0.0, 1.0), v(0.0, 40.0, 1.0)]]
        {
            grid.visit_covered(corners, |cell, _| panic!("{cell} of {corners:?}"));
        }
    }

    /// The depths of a steep triangle are between those of its corners.
    #[test]
    fn depths_of_steep_triangle_stay_between_its_corners() {
        let grid = Grid::new(WINDOW, 2);
        let v = DVec3::new;
        let steep = [v(0.25, 20.25, 1.0), v(59.75, 20.25, 1.0), v(30.0, 20.25 + 1e-13, 50.0)];
        let mut covered = 0;
        grid.visit_covered(steep, |_, depth| {
            assert!((1.0..=50.0).contains(&depth), "{depth}");
            covered += 1;
        });
        assert!(covered > 100, "{covered}");
    }

    #[test]
    fn depth_conversions_preserve_lengths() {
        for (depth, value) in [(Depth::Length, 3.0), (Depth::Inverse, 0.25)] {
            let nearer = depth.moved_nearer(value, 0.5);
            assert!((depth.distance_between(value, nearer) - 0.5).abs() < 1e-12, "{depth:?}");
            assert_eq!(depth.moved_nearer(value, 0.0), value);
        }
        assert_eq!(Depth::Inverse.moved_nearer(1.0, 2.0), f64::INFINITY);
    }
}
