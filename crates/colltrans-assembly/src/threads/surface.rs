//! Samples of a surface in cylindrical coordinates about an axis.

use std::f64::consts::TAU;

use colltrans::Solid;
use glam::{DVec2, DVec3};

use super::{axial_projection, triangle_distance};

/// Maximum number of sample intervals along a side of a facet.
const MAX_INTERVALS: usize = 48;

/// Number of corrections of a centre.
const ROUNDS: usize = 4;
/// Number of rows along the axis for a correction.
const ROWS: usize = 32;

/// An axis with a range along it.
#[derive(Debug, Clone, Copy)]
pub(super) struct AxisFrame {
    /// Unit direction of the axis.
    pub(super) axis: DVec3,
    /// Projection of the axis along its direction.
    pub(super) middle: DVec2,
    /// Range of coordinates along the axis.
    pub(super) range: [f64; 2],
}

/// A sample of a surface.
#[derive(Debug, Clone, Copy)]
pub(super) struct SurfaceSample {
    /// Coordinate along the axis.
    pub(super) z: f64,
    /// Angle about the axis.
    pub(super) angle: f64,
    /// Distance from the axis.
    pub(super) radius: f64,
}

impl AxisFrame {
    /// Calls `visit` with samples of all facets that are within the range and within a distance of the axis.
    /// Neighbouring samples are at most `apart` from each other, unless [`MAX_INTERVALS`] limits their
    /// number.
    pub(super) fn visit_samples(
        &self,
        solid: &Solid,
        within: f64,
        apart: f64,
        mut visit: impl FnMut(SurfaceSample),
    ) {
        let Self { axis, middle, range: [low, high] } = *self;
        let flat = axial_projection(axis);
        for t in solid.triangles() {
            let corners = t.map(|v| solid.vertices()[v as usize]);
            let z = corners.map(|p| p.dot(axis));
            let is_along = z.iter().any(|z| *z >= low) && z.iter().any(|z| *z <= high);
            if !is_along || triangle_distance(middle, corners.map(flat)) > within {
                continue;
            }
            visit_triangle_samples(corners, apart, &mut |p| {
                let (z, out) = (p.dot(axis), flat(p) - middle);
                let radius = out.length();
                if z >= low && z <= high && radius <= within {
                    visit(SurfaceSample { z, angle: out.to_angle(), radius });
                }
            });
        }
    }
}

/// Number of columns about the axis.
pub(super) const COLUMNS: usize = 48;

impl AxisFrame {
    /// Returns for each row along the axis and each column about it the radius that `outermost` selects
    /// there; `None` where the surface has no samples.
    pub(super) fn envelope(
        &self,
        solid: &Solid,
        within: f64,
        rows: usize,
        outermost: impl Fn(f64, f64) -> f64,
    ) -> Vec<[Option<f64>; COLUMNS]> {
        let [low, high] = self.range;
        let mut all = vec![[None; COLUMNS]; rows];
        let apart = ((high - low) / rows as f64).min(TAU * within / COLUMNS as f64);
        self.visit_samples(solid, within, apart, |sample| {
            let row = ((sample.z - low) / (high - low) * rows as f64) as usize;
            let turn = (sample.angle / TAU).rem_euclid(1.0);
            let column = ((turn * COLUMNS as f64) as usize).min(COLUMNS - 1);
            let cell = &mut all[row.min(rows - 1)][column];
            *cell = Some(cell.map_or(sample.radius, |known| outermost(known, sample.radius)));
        });
        all
    }
}

impl AxisFrame {
    /// Returns the axis with its range reduced, about its middle, to whole turns of a pitch. A range shorter
    /// than a turn is kept.
    pub(super) fn whole_turns(&self, pitch: f64) -> Self {
        let [low, high] = self.range;
        let turns = ((high - low) / pitch.abs()).floor();
        let less = if turns > 0.0 { (high - low - turns * pitch.abs()) / 2.0 } else { 0.0 };
        Self { range: [low + less, high - less], ..*self }
    }

    /// Returns the projected centre of a screw or a hole: the point about which the radii that `outermost`
    /// selects are equal on all sides. The range should span whole turns. If the centre is at `e` from a point, the
    /// radius about that point in direction `u` is larger by about `e . u`. The centre is corrected [`ROUNDS`] times.
    pub(super) fn fitted_center(
        mut self,
        solid: &Solid,
        within: f64,
        outermost: impl Fn(f64, f64) -> f64 + Copy,
    ) -> DVec2 {
        for _ in 0..ROUNDS {
            let (mut off, mut count) = (DVec2::ZERO, 0.0);
            for row in self.envelope(solid, within, ROWS, outermost) {
                if row.iter().all(Option::is_some) {
                    let out =
                        |(k, r): (usize, &Option<f64>)| column_direction(k) * r.unwrap_or(0.0);
                    off += row.iter().enumerate().map(out).sum::<DVec2>();
                    count += COLUMNS as f64;
                }
            }
            if count == 0.0 {
                break;
            }
            self.middle += off * 2.0 / count;
        }
        self.middle
    }
}

/// Returns the direction of the middle of a column.
pub(super) fn column_direction(column: usize) -> DVec2 {
    DVec2::from_angle(TAU * (column as f64 + 0.5) / COLUMNS as f64)
}

/// Calls `visit` with points of a triangle at distances of at most `apart`, unless [`MAX_INTERVALS`] limits
/// their number.
fn visit_triangle_samples([a, b, c]: [DVec3; 3], apart: f64, visit: &mut impl FnMut(DVec3)) {
    let longest = (b - a).length().max((c - b).length()).max((a - c).length());
    let count = ((longest / apart).ceil() as usize).clamp(1, MAX_INTERVALS);
    for i in 0..=count {
        for j in 0..=count - i {
            let [u, v] = [i, j].map(|k| k as f64 / count as f64);
            visit(a + (b - a) * u + (c - a) * v);
        }
    }
}
