//! Points of a surface about an axis.

use std::f64::consts::TAU;

use colltrans::Solid;
use glam::{DVec2, DVec3};

use super::{distance, flattened};

/// A facet is looked at in so many places a side at most.
const MOST_LOOKS: usize = 48;

/// How often a middle is corrected, and by how many rows along the axis.
const ROUNDS: usize = 4;
const ROWS: usize = 32;

/// An axis, the point of it that is seen along it, and where along it.
#[derive(Debug, Clone, Copy)]
pub(super) struct About {
    pub(super) axis: DVec3,
    pub(super) middle: DVec2,
    pub(super) range: [f64; 2],
}

/// A point of a surface: its place along the axis, its angle about it, and its distance from it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Seen {
    pub(super) z: f64,
    pub(super) angle: f64,
    pub(super) radius: f64,
}

impl About {
    /// Looks at points of all facets within the range and a distance of the axis, no farther from each other than a length,
    /// if facets are not too large for that.
    pub(super) fn look(&self, solid: &Solid, within: f64, apart: f64, mut look: impl FnMut(Seen)) {
        let Self { axis, middle, range: [low, high] } = *self;
        let flat = flattened(axis);
        for t in solid.triangles() {
            let corners = t.map(|v| solid.vertices()[v as usize]);
            let z = corners.map(|p| p.dot(axis));
            let is_along = z.iter().any(|z| *z >= low) && z.iter().any(|z| *z <= high);
            if !is_along || distance(middle, corners.map(flat)) > within {
                continue;
            }
            sampled(corners, apart, &mut |p| {
                let (z, out) = (p.dot(axis), flat(p) - middle);
                let radius = out.length();
                if z >= low && z <= high && radius <= within {
                    look(Seen { z, angle: out.to_angle(), radius });
                }
            });
        }
    }
}

/// Places around.
pub(super) const AROUND: usize = 48;

impl About {
    /// By rows along the axis and places around it, the distance of what is `outermost` there; `None` where nothing is.
    pub(super) fn envelope(
        &self,
        solid: &Solid,
        within: f64,
        rows: usize,
        outermost: impl Fn(f64, f64) -> f64,
    ) -> Vec<[Option<f64>; AROUND]> {
        let [low, high] = self.range;
        let mut all = vec![[None; AROUND]; rows];
        let apart = ((high - low) / rows as f64).min(TAU * within / AROUND as f64);
        self.look(solid, within, apart, |seen| {
            let row = ((seen.z - low) / (high - low) * rows as f64) as usize;
            let turn = (seen.angle / TAU).rem_euclid(1.0);
            let column = ((turn * AROUND as f64) as usize).min(AROUND - 1);
            let cell = &mut all[row.min(rows - 1)][column];
            *cell = Some(cell.map_or(seen.radius, |known| outermost(known, seen.radius)));
        });
        all
    }
}

impl About {
    /// As much of its range as are whole turns of a pitch, in the middle, if there is one.
    pub(super) fn whole(&self, pitch: f64) -> Self {
        let [low, high] = self.range;
        let turns = ((high - low) / pitch.abs()).floor();
        let less = if turns > 0.0 { (high - low - turns * pitch.abs()) / 2.0 } else { 0.0 };
        Self { range: [low + less, high - less], ..*self }
    }

    /// The middle of a screw or a hole in whole turns: about it what is `outermost` is as far on all sides. From a middle
    /// that is off by `e`, it seems farther by `e . u` in the direction `u`.
    pub(super) fn centered(
        mut self,
        solid: &Solid,
        within: f64,
        outermost: impl Fn(f64, f64) -> f64 + Copy,
    ) -> DVec2 {
        for _ in 0..ROUNDS {
            let (mut off, mut count) = (DVec2::ZERO, 0.0);
            for row in self.envelope(solid, within, ROWS, outermost) {
                if row.iter().all(Option::is_some) {
                    let out = |(k, r): (usize, &Option<f64>)| around(k) * r.unwrap_or(0.0);
                    off += row.iter().enumerate().map(out).sum::<DVec2>();
                    count += AROUND as f64;
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

/// The direction of a place around.
pub(super) fn around(column: usize) -> DVec2 {
    DVec2::from_angle(TAU * (column as f64 + 0.5) / AROUND as f64)
}

fn sampled([a, b, c]: [DVec3; 3], apart: f64, look: &mut impl FnMut(DVec3)) {
    let longest = (b - a).length().max((c - b).length()).max((a - c).length());
    let count = ((longest / apart).ceil() as usize).clamp(1, MOST_LOOKS);
    for i in 0..=count {
        for j in 0..=count - i {
            let [u, v] = [i, j].map(|k| k as f64 / count as f64);
            look(a + (b - a) * u + (c - a) * v);
        }
    }
}
