//! Triangulation of simple polygons by ear clipping.
//!
//! - A polygon is projected along the axis in which its area vector is largest. Orientations of projected corners are
//!   exact.
//! - An ear has a positive area, and no other corner in it or on its boundary. Therefore triangles have areas, and
//!   corners that lie on a side remain corners.
//! - A polygon with `k` corners has `k - 2` triangles.
//! - For many corners, a grid over the remaining corners finds those near an ear, about one per cell. It is rebuilt
//!   when half of them have been removed. An ear of a round or jagged polygon tests few corners, so that the
//!   triangulation takes about `k log k` steps.

use glam::{DVec2, DVec3, Vec3Swizzles};

use colltrans_kernel::predicates::orient2d as turn;

use colltrans_kernel::visit_counter;

/// Minimum number of corners for a grid.
const MIN_GRID_CORNERS: usize = 64;

/// Triangulates a polygon: triangles of positions in `corners`. Returns `None` if the polygon crosses itself.
pub(super) fn triangulate(corners: &[DVec3]) -> Option<Vec<[usize; 3]>> {
    let mut ring = Ring::new(projected_corners(corners));
    let mut triangles = Vec::with_capacity(corners.len().saturating_sub(2));
    let mut start = 0;
    while ring.count > 3 {
        let ear = ring.corners_from(start).find(|&k| ring.is_ear(k))?;
        triangles.push([ring.before[ear], ear, ring.after[ear]]);
        // The search continues after this ear, because fans would have the thinnest triangles.
        start = ring.after[ring.after[ear]];
        ring.remove_corner(ear);
    }
    let mut last = [start, ring.after[start], ring.before[start]];
    last.sort_unstable();
    if turn(ring.flat[last[0]], ring.flat[last[1]], ring.flat[last[2]]) <= 0.0 {
        return None;
    }
    triangles.push(last);
    Some(triangles)
}

/// The remaining corners, in a doubly linked ring.
struct Ring {
    flat: Vec<DVec2>,
    before: Vec<usize>,
    after: Vec<usize>,
    count: usize,
    /// Present for at least [`MIN_GRID_CORNERS`] corners.
    grid: Option<Grid>,
}

impl Ring {
    fn new(flat: Vec<DVec2>) -> Self {
        let n = flat.len();
        let before = (0..n).map(|k| (k + n - 1) % n).collect();
        let after = (0..n).map(|k| (k + 1) % n).collect();
        let grid = (n >= MIN_GRID_CORNERS).then(|| Grid::new(&flat, (0..n).collect()));
        Self { flat, before, after, count: n, grid }
    }

    /// Iterates over the remaining corners, from `start`.
    fn corners_from(&self, start: usize) -> impl Iterator<Item = usize> + '_ {
        std::iter::successors(Some(start), |&k| Some(self.after[k])).take(self.count)
    }

    /// Removes a corner, and rebuilds the grid if half of its corners are removed.
    fn remove_corner(&mut self, k: usize) {
        let (i, l) = (self.before[k], self.after[k]);
        (self.after[i], self.before[l]) = (l, i);
        // A removed corner is its own neighbour.
        (self.before[k], self.after[k]) = (k, k);
        self.count -= 1;
        if self.grid.as_ref().is_some_and(|grid| 2 * self.count < grid.corners.len()) {
            let left: Vec<usize> = self.corners_from(l).collect();
            self.grid = (left.len() >= MIN_GRID_CORNERS).then(|| Grid::new(&self.flat, left));
        }
    }

    /// Checks whether a corner and its neighbours form an ear.
    fn is_ear(&self, j: usize) -> bool {
        let (i, l) = (self.before[j], self.after[j]);
        let [a, b, c] = [i, j, l].map(|m| self.flat[m]);
        if turn(a, b, c) <= 0.0 {
            return false;
        }
        let inside =
            |p: DVec2| turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0;
        let leaves_free = |m: usize| {
            visit_counter::count_visits(1);
            let p = self.flat[m];
            // A corner that occurs twice (at a slit to a hole) touches the ear only in a corner of the ear.
            p == a || p == b || p == c || !inside(p)
        };
        match &self.grid {
            None => self.corners_from(l).skip(1).take(self.count - 3).all(leaves_free),
            Some(grid) => {
                let mut near = grid.corners_in_box(a.min(b).min(c), a.max(b).max(c));
                near.all(|m| self.after[m] == m || leaves_free(m))
            }
        }
    }
}

/// Corners sorted into square cells, row by row.
struct Grid {
    low: DVec2,
    /// Cells per unit of length.
    scale: f64,
    /// Number of columns and of rows.
    size: [usize; 2],
    /// Position of the first corner of each cell.
    starts: Vec<u32>,
    corners: Vec<usize>,
}

impl Grid {
    fn new(flat: &[DVec2], members: Vec<usize>) -> Self {
        let low = members.iter().map(|&m| flat[m]).fold(DVec2::INFINITY, DVec2::min);
        let high = members.iter().map(|&m| flat[m]).fold(DVec2::NEG_INFINITY, DVec2::max);
        let (extent, count) = (high - low, members.len());
        let scale =
            (count as f64 / (extent.x * extent.y)).sqrt().min(count as f64 / extent.max_element());
        let size = (extent * scale).to_array().map(|side| side as usize + 1);
        let mut grid =
            Self { low, scale, size, starts: vec![0; size[0] * size[1] + 1], corners: members };
        let mut cells: Vec<(usize, usize)> =
            grid.corners.iter().map(|&m| (grid.cell_index(flat[m]), m)).collect();
        cells.sort_unstable();
        for &(cell, _) in &cells {
            grid.starts[cell + 1] += 1;
        }
        for cell in 0..grid.starts.len() - 1 {
            grid.starts[cell + 1] += grid.starts[cell];
        }
        grid.corners = cells.into_iter().map(|(_, m)| m).collect();
        grid
    }

    /// Returns the column and the row of a point. Both are monotonic in the coordinates.
    fn cell_coordinates(&self, p: DVec2) -> [usize; 2] {
        let at = (p - self.low) * self.scale;
        [(at.x as usize).min(self.size[0] - 1), (at.y as usize).min(self.size[1] - 1)]
    }

    fn cell_index(&self, p: DVec2) -> usize {
        let [column, row] = self.cell_coordinates(p);
        row * self.size[0] + column
    }

    /// Iterates over all corners in a box, and some corners around it.
    fn corners_in_box(&self, low: DVec2, high: DVec2) -> impl Iterator<Item = usize> + '_ {
        let ([left, bottom], [right, top]) =
            (self.cell_coordinates(low), self.cell_coordinates(high));
        let row = move |r: usize| {
            let first = self.starts[r * self.size[0] + left] as usize;
            &self.corners[first..self.starts[r * self.size[0] + right + 1] as usize]
        };
        (bottom..=top).flat_map(row).copied()
    }
}

/// Projects corners along the axis in which the area vector is largest, such that they run counter-clockwise.
fn projected_corners(corners: &[DVec3]) -> Vec<DVec2> {
    let first = corners[0];
    let area: DVec3 = corners.windows(2).map(|pair| (pair[0] - first).cross(pair[1] - first)).sum();
    let flat = |p: &DVec3| match area.abs().max_position() {
        0 => p.yz(),
        1 => p.zx(),
        _ => p.xy(),
    };
    let upwards = area[area.abs().max_position()] >= 0.0;
    let turned = |p: DVec2| if upwards { p } else { DVec2::new(-p.x, p.y) };
    corners.iter().map(|p| turned(flat(p))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn total_area(corners: &[DVec3], triangles: &[[usize; 3]]) -> f64 {
        let double = |t: &[usize; 3]| {
            let [a, b, c] = t.map(|k| corners[k]);
            (b - a).cross(c - a).z
        };
        triangles.iter().map(double).sum::<f64>() / 2.0
    }

    #[test]
    fn nonconvex_polygons_keep_their_area() {
        let l: Vec<DVec3> = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2), (0, 1)]
            .map(|(x, y)| DVec3::new(f64::from(x), f64::from(y), 1.0))
            .to_vec();
        let triangles = triangulate(&l).unwrap();
        assert_eq!(triangles.len(), 5);
        assert_eq!(total_area(&l, &triangles), 3.0);
        let reversed: Vec<DVec3> = l.iter().rev().copied().collect();
        assert_eq!(total_area(&reversed, &triangulate(&reversed).unwrap()), -3.0);
    }

    /// Returns corners at equal angles, and at the distances `radius` from the origin.
    fn polygon_at_radii(sides: usize, radius: impl Fn(usize) -> f64) -> Vec<DVec3> {
        let corner = |k: usize| {
            let (sine, cosine) = (std::f64::consts::TAU * k as f64 / sides as f64).sin_cos();
            DVec3::new(cosine, sine, 0.0) * radius(k)
        };
        (0..sides).map(corner).collect()
    }

    /// Asserts that all triangles have a positive area, and that these sum to the area of the polygon. Each side of a
    /// triangle must be a side of the polygon or, reversed, of another triangle.
    fn assert_triangulated(corners: &[DVec3]) {
        let triangles = triangulate(corners).expect("the polygon is simple");
        assert_eq!(triangles.len(), corners.len() - 2);
        let mut sides = std::collections::BTreeSet::new();
        for t in &triangles {
            let [a, b, c] = t.map(|k| corners[k].truncate());
            assert!(turn(a, b, c) > 0.0);
            for k in 0..3 {
                assert!(sides.insert((t[k], t[(k + 1) % 3])), "side of two triangles");
            }
        }
        let own = |&(a, b): &(usize, usize)| (a + 1) % corners.len() == b;
        assert!(sides.iter().all(|&(a, b)| own(&(a, b)) || sides.contains(&(b, a))));
        assert_eq!(sides.iter().filter(|s| own(s)).count(), corners.len());
        let polygon: f64 = corners.windows(2).map(|w| w[0].cross(w[1]).z).sum::<f64>()
            + corners[corners.len() - 1].cross(corners[0]).z;
        assert!((total_area(corners, &triangles) / (0.5 * polygon) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn large_round_jagged_and_spiral_polygons_are_triangulated() {
        for sides in [63, 64, 65, 200, 20_000] {
            assert_triangulated(&polygon_at_radii(sides, |_| 1.0));
            assert_triangulated(&polygon_at_radii(sides, |k| [1.0, 0.5][k % 2]));
            assert_triangulated(&polygon_at_radii(sides, |k| 1.0 + 0.3 * (k as f64 * 0.7).sin()));
        }
        // A band with three turns around the origin.
        let turns = |k: usize, r: f64| {
            let angle = std::f64::consts::TAU * 3.0 * k as f64 / 1_000.0;
            DVec3::new(angle.cos(), angle.sin(), 0.0) * (r + 0.001 * k as f64)
        };
        let band: Vec<DVec3> = (0..=1_000)
            .map(|k| turns(k, 1.1))
            .chain((0..=1_000).rev().map(|k| turns(k, 1.0)))
            .collect();
        assert_triangulated(&band);
    }

    #[test]
    fn grid_finds_the_ears_of_a_full_scan() {
        for sides in [64, 150, 1_001] {
            for corners in [
                polygon_at_radii(sides, |_| 1.0),
                polygon_at_radii(sides, |k| 1.0 + 0.4 * (k as f64).sin()),
            ] {
                let mut plain = Ring::new(projected_corners(&corners));
                plain.grid = None;
                let plain_ears: Vec<bool> = (0..sides).map(|k| plain.is_ear(k)).collect();
                let ring = Ring::new(projected_corners(&corners));
                assert!(ring.grid.is_some());
                assert_eq!((0..sides).map(|k| ring.is_ear(k)).collect::<Vec<_>>(), plain_ears);
            }
        }
    }

    #[test]
    fn bow_tie_has_no_triangulation() {
        let tie = [DVec3::ZERO, DVec3::X + DVec3::Y, DVec3::X, DVec3::Y * 2.0];
        assert!(triangulate(&tie).is_none());
    }

    #[test]
    fn hole_connected_by_slit_is_left_out() {
        let corners: Vec<DVec3> =
            [(0, 0), (4, 0), (4, 4), (0, 4), (0, 0), (1, 1), (1, 2), (2, 2), (2, 1), (1, 1)]
                .map(|(x, y)| DVec3::new(f64::from(x), f64::from(y), 0.0))
                .to_vec();
        let triangles = triangulate(&corners).unwrap();
        assert_eq!(total_area(&corners, &triangles), 15.0);
    }
}
