//! Cells of directions: squares on the six sides of a cube, which are halved recursively.
//!
//! A direction on a side is `s e_k + u e_(k+1) + v e_(k+2)` with `s` = 1 or -1. The corners of cells have
//! dyadic `u` and `v`, so they are exact. A cell is the convex cone of its four corners, therefore a linear
//! function of the direction is extreme at a corner.

use std::cmp::Ordering;

use glam::DVec3;

use colltrans_kernel::integer::{Integer, SMALL_LIMBS};

/// Maximum number of halvings for which `u` and `v` are exact.
pub(super) const MAX_DEPTH: u32 = 50;

/// Side of the cube: an axis and its sign.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct CubeSide(u8);

impl CubeSide {
    pub(super) fn all() -> [Self; 6] {
        [0, 1, 2, 3, 4, 5].map(Self)
    }

    /// Returns the axis perpendicular to the side, and the two axes parallel to it.
    pub(super) fn axes(self) -> [usize; 3] {
        let main = usize::from(self.0 / 2);
        [main, (main + 1) % 3, (main + 2) % 3]
    }

    pub(super) fn sign(self) -> f64 {
        if self.0.is_multiple_of(2) { 1.0 } else { -1.0 }
    }

    pub(super) fn direction_at(self, [u, v]: [f64; 2]) -> DVec3 {
        let [k, i, j] = self.axes();
        let mut d = DVec3::ZERO;
        (d[k], d[i], d[j]) = (self.sign(), u, v);
        d
    }

    /// Returns the side that a direction passes through.
    fn containing(d: DVec3) -> Self {
        let main = d.abs().max_position() as u8;
        Self(2 * main + u8::from(d[usize::from(main)] < 0.0))
    }
}

/// Square cell on a side of the cube.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Cell {
    pub(super) side: CubeSide,
    pub(super) low: [f64; 2],
    pub(super) size: f64,
    pub(super) depth: u32,
}

impl Cell {
    pub(super) fn root_cells() -> [Self; 6] {
        CubeSide::all().map(|side| Self { side, low: [-1.0; 2], size: 2.0, depth: 0 })
    }

    pub(super) fn coordinate_range(&self, axis: usize) -> [f64; 2] {
        [self.low[axis], self.low[axis] + self.size]
    }

    /// Returns the corners on the side, in cyclic order.
    pub(super) fn corner_places(&self) -> [[f64; 2]; 4] {
        let ([a, b], [c, d]) = (self.coordinate_range(0), self.coordinate_range(1));
        [[a, c], [b, c], [b, d], [a, d]]
    }

    pub(super) fn corner_directions(&self) -> [DVec3; 4] {
        self.corner_places().map(|place| self.side.direction_at(place))
    }

    pub(super) fn center(&self) -> [f64; 2] {
        self.low.map(|low| low + self.size / 2.0)
    }

    /// Returns a quarter. Bit 0 of the number selects the upper half along `u`, bit 1 the upper half along
    /// `v`.
    pub(super) fn quarter(&self, number: usize) -> Self {
        let (half, upper) = (self.size / 2.0, [number & 1, number >> 1 & 1]);
        let low = [0, 1].map(|axis| self.low[axis] + half * upper[axis] as f64);
        Self { side: self.side, low, size: half, depth: self.depth + 1 }
    }

    /// Checks whether another cell is equal to this one or inside it.
    pub(super) fn contains(&self, other: &Self) -> bool {
        let within = |axis: usize| {
            let ([low, high], [least, most]) =
                (self.coordinate_range(axis), other.coordinate_range(axis));
            low <= least && most <= high
        };
        self.side == other.side && within(0) && within(1)
    }

    /// Returns the index of the side that contains a direction.
    pub(super) fn root_index(d: DVec3) -> usize {
        usize::from(CubeSide::containing(d).0)
    }

    /// Returns the number of the quarter that contains a direction of this cell. The comparison is exact.
    pub(super) fn quarter_of(&self, d: DVec3) -> usize {
        let [k, i, j] = self.side.axes();
        let middle = self.center();
        let upper = |axis: usize, component: f64| {
            let there = Integer::<SMALL_LIMBS>::exact_product(middle[axis], d[k].abs());
            let beyond = Integer::exact_number(component).subtract(&there).sign();
            usize::from(beyond == Some(Ordering::Greater))
        };
        upper(0, d[i]) + 2 * upper(1, d[j])
    }

    /// Returns the solid angle in steradians.
    pub(super) fn area(&self) -> f64 {
        solid_angle(&self.corner_places())
    }
}

/// Computes the solid angle of a convex polygon on a side.
pub(super) fn solid_angle(places: &[[f64; 2]]) -> f64 {
    let at = |[u, v]: [f64; 2]| DVec3::new(1.0, u, v);
    let vector = |[a, b]: [f64; 2], [c, d]: [f64; 2]| DVec3::new(0.0, c - a, d - b);
    let triangle = |k: usize| {
        let (a, b, c) = (at(places[0]), at(places[k - 1]), at(places[k]));
        let (p, q, r) = (a.length(), b.length(), c.length());
        // det[a, b, c] from the edge vectors, whose relative errors are smaller than those of the corners.
        let volume = a.dot(vector(places[0], places[k - 1]).cross(vector(places[0], places[k])));
        2.0 * volume.abs().atan2(p * q * r + a.dot(b) * r + b.dot(c) * p + c.dot(a) * q)
    };
    (2..places.len()).map(triangle).sum()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    #[test]
    fn areas_of_root_cells_add_to_sphere() {
        let whole: f64 = Cell::root_cells().iter().map(Cell::area).sum();
        assert!((whole - 4.0 * PI).abs() < 1e-14);
        let cell = Cell::root_cells()[3];
        let parts: f64 = (0..4).map(|k| cell.quarter(k).area()).sum();
        assert!((parts - cell.area()).abs() < 1e-15);
    }

    #[test]
    fn repeated_quarters_converge_to_direction() {
        let d = DVec3::new(0.3, -2.0, 0.1 + 0.2);
        let mut cell = Cell::root_cells()[Cell::root_index(d)];
        assert_eq!((cell.side.axes(), cell.side.sign()), ([1, 2, 0], -1.0));
        for _ in 0..MAX_DEPTH {
            cell = cell.quarter(cell.quarter_of(d));
        }
        let [u, v] = cell.center();
        assert!((u - d.z / 2.0).abs() < 1e-15 && (v - d.x / 2.0).abs() < 1e-15);
    }
}
