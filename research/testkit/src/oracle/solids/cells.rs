//! Solids made of unit cubes, for whose motions the exact answers follow without facets.
//!
//! A body is a set of unit cubes of a grid. The grids of both bodies are mapped by one linear map `L` (a shear
//! and a rotation with nine rounded entries). In grid coordinates, the interiors of two cubes overlap for the
//! `t` of an open interval, given by three inequalities. All numbers are exact: vectors are multiplied by the
//! adjugate of `L`, and all values are multiples of its determinant.

use std::collections::{BTreeMap, BTreeSet};

use glam::{DMat3, DVec3};

use crate::oracle::exact::{Dyadic, Ratio, Vector};
use crate::random::Random;

/// A body of unit cubes, given by their lower corners.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Cells(pub BTreeSet<[i32; 3]>);

/// The exact result of a motion.
#[derive(Debug, Clone)]
pub struct Motion {
    /// Whether the interiors have a common point at the start.
    pub overlaps: bool,
    /// The smallest `t >= 0` from which on the interiors overlap; `None` if there is none.
    pub stop: Option<Ratio>,
    /// The largest `t` up to which the interiors overlap; `None` if there is none.
    pub exit: Option<Ratio>,
}

impl Cells {
    /// Draws a connected body of `count` cubes near the origin.
    pub fn random(count: usize, rng: &mut Random) -> Self {
        let mut cells = BTreeSet::from([[0; 3]]);
        while cells.len() < count {
            let all: Vec<[i32; 3]> = cells.iter().copied().collect();
            let mut next = all[rng.int(0, all.len() as i64 - 1) as usize];
            next[rng.int(0, 2) as usize] += if rng.one_in(2) { 1 } else { -1 };
            if next.iter().all(|c| c.abs() <= 2) {
                cells.insert(next);
            }
        }
        Self(cells)
    }

    /// Returns the cubes of a box that are not in this body, which form a mould of it.
    #[must_use]
    pub fn mould(&self, open: Option<usize>) -> Self {
        let mut cells = BTreeSet::new();
        let end = |k: usize, way: i32| self.0.iter().map(|c| c[k] * way).max().unwrap_or(0) * way;
        let (low, high) = ([0, 1, 2].map(|k| end(k, -1) - 1), [0, 1, 2].map(|k| end(k, 1) + 1));
        let size = [0, 1, 2].map(|k| high[k] - low[k] + 1);
        for i in 0..size[0] * size[1] * size[2] {
            let steps = [i % size[0], i / size[0] % size[1], i / (size[0] * size[1])];
            let cell = [0, 1, 2].map(|k| low[k] + steps[k]);
            let outside = open.is_some_and(|axis| {
                // The region that the body sweeps when it leaves along the axis is removed.
                self.0.iter().any(|c| {
                    (0..3).all(|k| if k == axis { cell[k] >= c[k] } else { cell[k] == c[k] })
                })
            });
            if !outside && !self.0.contains(&cell) {
                cells.insert(cell);
            }
        }
        Self(cells)
    }

    /// Returns the surface: vertices in the grid under a linear map, and triangles. The diagonals of squares,
    /// and additional vertices in squares, are random.
    pub fn surface(&self, map: DMat3, rng: &mut Random) -> (Vec<DVec3>, Vec<Vec<u32>>) {
        let mut vertices = Vec::new();
        let mut index: BTreeMap<[i32; 3], u32> = BTreeMap::new();
        let mut facets = Vec::new();
        for cell in &self.0 {
            for (axis, up) in [(0, 0), (0, 1), (1, 0), (1, 1), (2, 0), (2, 1)] {
                let mut beside = *cell;
                beside[axis] += 2 * up - 1;
                if self.0.contains(&beside) {
                    continue;
                }
                let mut square = square_corners(*cell, axis, up);
                if map.determinant() < 0.0 {
                    square.reverse();
                }
                let corners = square.map(|corner| {
                    *index.entry(corner).or_insert_with(|| {
                        vertices.push(map * DVec3::from_array(corner.map(f64::from)));
                        vertices.len() as u32 - 1
                    })
                });
                cut(&mut vertices, &mut facets, corners, rng);
            }
        }
        (vertices, facets)
    }

    /// Returns the cubes rotated by a rotation that permutes axes.
    #[must_use]
    pub fn turned(&self, quarter: DMat3) -> Self {
        let turn = |cell: &[i32; 3]| {
            let low = quarter * DVec3::from_array(cell.map(f64::from));
            let high = quarter * DVec3::from_array(cell.map(|c| f64::from(c + 1)));
            low.min(high).to_array().map(|c| c as i32)
        };
        Self(self.0.iter().map(turn).collect())
    }
}

/// Returns the corners of a square of a cube, counter-clockwise from outside.
fn square_corners(cell: [i32; 3], axis: usize, up: i32) -> [[i32; 3]; 4] {
    let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut corners = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(a, b)| {
        let mut corner = cell;
        corner[axis] += up;
        corner[i] += a;
        corner[j] += b;
        corner
    });
    if up == 0 {
        corners.reverse();
    }
    corners
}

pub(super) fn cut(
    vertices: &mut Vec<DVec3>,
    facets: &mut Vec<Vec<u32>>,
    [a, b, c, d]: [u32; 4],
    rng: &mut Random,
) {
    match rng.int(0, 3) {
        0 => facets.push(vec![a, b, c, d]),
        1 => facets.extend([vec![a, b, c], vec![a, c, d]]),
        2 => facets.extend([vec![b, c, d], vec![b, d, a]]),
        _ => {
            let at = |v: u32| vertices[v as usize];
            let middle = at(a) * 0.5 + at(b) * 0.125 + at(c) * 0.125 + at(d) * 0.25;
            let m = vertices.len() as u32;
            vertices.push(middle);
            facets.extend([vec![a, b, m], vec![b, c, m], vec![c, d, m], vec![d, a, m]]);
        }
    }
}

/// A motion in grid coordinates, in multiples of the determinant of the map.
pub(super) struct InGrid {
    /// The offset of the fixed body.
    pub(super) shift: [Dyadic; 3],
    /// The direction.
    pub(super) way: [Dyadic; 3],
    /// The determinant.
    pub(super) unit: Dyadic,
}

impl InGrid {
    pub(super) fn new([rotation, shear]: [DMat3; 2], offset: &Vector, direction: DVec3) -> Self {
        let columns = |m: DMat3| [m.x_axis, m.y_axis, m.z_axis].map(Vector::new);
        let (r, s) = (columns(rotation), columns(shear));
        let map = s.map(|c| {
            let [x, y, z] = [0, 1, 2].map(|k| r[k].times(&c.0[k]));
            x.plus(&y).plus(&z)
        });
        let [a, b, c] = &map;
        // The rows of the adjugate, and the determinant, with a positive sign.
        let mut rows = [b.cross(c), c.cross(a), a.cross(b)];
        let mut unit = rows[0].dot(a);
        if unit.is_negative() {
            rows = rows.map(|row| row.times(&Dyadic::new(-1.0)));
            unit = -unit;
        }
        let grid = |v: &Vector| [0, 1, 2].map(|k| rows[k].dot(v));
        Self { shift: grid(offset), way: grid(&Vector::new(direction)), unit }
    }
}

/// Computes the exact result of a motion of `moving` along `direction`, with `fixed` displaced by `offset`.
/// Both are in the world, and the cubes are mapped by `rotation shear`.
pub fn motion(
    (moving, fixed): (&Cells, &Cells),
    [rotation, shear]: [DMat3; 2],
    offset: &Vector,
    direction: DVec3,
) -> Motion {
    let InGrid { shift, way, unit } = InGrid::new([rotation, shear], offset, direction);
    let mut result = Motion { overlaps: false, stop: None, exit: None };
    let zero = Ratio::from_f64(0.0);
    for p in &moving.0 {
        for q in &fixed.0 {
            let apart = |k: usize| &(&Dyadic::new(f64::from(p[k] - q[k])) * &unit) - &shift[k];
            let Some([first, last]) = overlap_interval([apart(0), apart(1), apart(2)], &way, &unit)
            else {
                continue;
            };
            result.overlaps |= first < zero && zero < last;
            if zero < last {
                let from = if first < zero { zero.clone() } else { first };
                if result.stop.as_ref().is_none_or(|s| from < *s) {
                    result.stop = Some(from);
                }
            }
            if result.exit.as_ref().is_none_or(|e| *e < last) {
                result.exit = Some(last);
            }
        }
    }
    result
}

/// Returns the open interval of `t` with `-unit < apart + t way < unit` in all three coordinates; `None` if it
/// is empty. The direction is not zero.
fn overlap_interval(apart: [Dyadic; 3], way: &[Dyadic; 3], unit: &Dyadic) -> Option<[Ratio; 2]> {
    let mut range: Option<[Ratio; 2]> = None;
    for (c, d) in apart.into_iter().zip(way) {
        if d.is_zero() {
            if c.abs() >= *unit {
                return None;
            }
            continue;
        }
        let ends = [&-unit.clone() - &c, unit - &c].map(|n| Ratio::new(n, d.clone()));
        let [x, y] = ends;
        let [low, high] = if x < y { [x, y] } else { [y, x] };
        range = Some(match range {
            None => [low, high],
            Some([a, b]) => [if a < low { low } else { a }, if b < high { b } else { high }],
        });
    }
    range.filter(|[low, high]| low < high)
}
