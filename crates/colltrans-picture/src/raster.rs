//! How near surfaces are to the viewer, sampled over the page.
//!
//! Notation. A *sample* is the centre of a cell of `1 / FINE` pixels; depths grow towards the viewer.
//!
//! Invariant: each sample holds the nearest of all triangles drawn so far that cover it, and the
//! tone of that one.

use glam::{DVec2, DVec3};

use crate::Frame;

/// Samples to a pixel, along each axis.
const FINE: usize = 2;
/// Nothing is there.
const EMPTY: u32 = u32::MAX;

/// Depths and tones over a window.
pub struct Raster {
    width: usize,
    height: usize,
    depths: Vec<f64>,
    tones: Vec<u32>,
    window: Frame,
}

impl Raster {
    /// Over a window that begins at (0, 0).
    pub fn new(window: Frame) -> Self {
        let [width, height] = window.high.to_array().map(|side| side.ceil() as usize * FINE);
        let count = width * height;
        let (depths, tones) = (vec![f64::NEG_INFINITY; count], vec![EMPTY; count]);
        Self { width, height, depths, tones, window }
    }

    /// Draws a triangle of a tone, a small number: x and y on the page, z the depth.
    pub fn draw(&mut self, corners: [DVec3; 3], tone: u32) {
        let [a, b, c] = corners.map(|p| (p.truncate() * FINE as f64 - 0.5).extend(p.z));
        let (u, v) = (b - a, c - a);
        let twice = u.x * v.y - u.y * v.x;
        if twice == 0.0 || !twice.is_finite() {
            return;
        }
        // The plane of the depths.
        let slope_x = (u.z * v.y - v.z * u.y) / twice;
        let slope_y = (v.z * u.x - u.z * v.x) / twice;
        let cells = |low: f64, high: f64, count: usize| {
            let from = low.ceil().clamp(0.0, count as f64) as usize;
            from..((high.floor() + 1.0).clamp(0.0, count as f64) as usize).max(from)
        };
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        for y in cells(low.y, high.y, self.height) {
            let (mut left, mut right) = (f64::INFINITY, f64::NEG_INFINITY);
            for [p, q] in [[a, b], [b, c], [c, a]] {
                let row = y as f64;
                if (p.y <= row) != (q.y <= row) || p.y == row {
                    let share = if p.y == q.y { 0.0 } else { (row - p.y) / (q.y - p.y) };
                    let x = p.x + share.clamp(0.0, 1.0) * (q.x - p.x);
                    (left, right) = (left.min(x), right.max(x));
                }
            }
            for x in cells(left, right, self.width) {
                let depth = a.z + slope_x * (x as f64 - a.x) + slope_y * (y as f64 - a.y);
                let cell = y * self.width + x;
                if depth > self.depths[cell] {
                    (self.depths[cell], self.tones[cell]) = (depth, tone);
                }
            }
        }
    }

    /// Whether a point of the page at this depth is in front of all around it, or level with it.
    pub fn sees(&self, at: DVec2, depth: f64) -> bool {
        let [x, y] = (at * FINE as f64).to_array().map(|c| c.floor() as isize);
        let around = |x: isize, y: isize| {
            let inside = x >= 0 && y >= 0 && x < self.width as isize && y < self.height as isize;
            inside.then(|| self.depths[y as usize * self.width + x as usize])
        };
        let cells = (-1..=1).flat_map(|i| (-1..=1).map(move |j| (i, j)));
        let farthest = cells
            .filter_map(|(i, j)| around(x + i, y + j))
            .reduce(f64::min)
            .unwrap_or(f64::NEG_INFINITY);
        depth >= farthest
    }

    /// The parts of a segment that are seen, and those that are hidden; x and y on the page, z the
    /// depth, which may be less by `slack`.
    pub fn split(&self, [a, b]: [DVec3; 2], slack: f64) -> [Vec<[DVec2; 2]>; 2] {
        let mut parts = [Vec::new(), Vec::new()];
        let (from, to) = (a.truncate(), b.truncate());
        let Some([first, last]) = self.window.clip_segment([from, to]) else { return parts };
        let whole = from.distance(to).max(f64::MIN_POSITIVE);
        let [s, t] = [first, last].map(|p| (p.distance(from) / whole).min(1.0));
        let steps = (first.distance(last) * FINE as f64).ceil().max(1.0) as usize;
        let at = |i: usize| s + (t - s) * i as f64 / steps as f64;
        let is_seen = |i: usize| {
            let p = a.lerp(b, 0.5 * (at(i) + at(i + 1)));
            self.sees(p.truncate(), p.z + slack)
        };
        let mut start = 0;
        for i in 1..=steps {
            let seen = is_seen(start);
            if i == steps || is_seen(i) != seen {
                let ends = [at(start), at(i)].map(|share| from.lerp(to, share));
                parts[usize::from(!seen)].push(ends);
                start = i;
            }
        }
        parts
    }

    /// For each tone its rectangles, in whole pixels: left, top, right, bottom.
    pub fn tiles(&self) -> Vec<Vec<[usize; 4]>> {
        let tones = self.tones.iter().filter(|tone| **tone != EMPTY).max();
        let mut done = vec![Vec::new(); tones.map_or(0, |last| *last as usize + 1)];
        let mut open: Vec<(u32, [usize; 4])> = Vec::new();
        for y in 0..self.height / FINE {
            let mut runs: Vec<(u32, [usize; 4])> = Vec::new();
            for x in 0..self.width / FINE {
                let tone = self.tones[y * FINE * self.width + x * FINE];
                match runs.last_mut() {
                    Some((last, [_, _, right, _])) if *last == tone && *right == x => *right += 1,
                    _ if tone == EMPTY => {}
                    _ => runs.push((tone, [x, y, x + 1, y + 1])),
                }
            }
            // A run just like the one above makes that one longer.
            let mut above = std::mem::take(&mut open).into_iter().peekable();
            for (tone, [left, top, right, bottom]) in runs {
                let mut first = top;
                while let Some(&(other, rect)) = above.peek().filter(|(_, r)| r[0] <= left) {
                    above.next();
                    if (other, rect[0], rect[2]) == (tone, left, right) {
                        first = rect[1];
                    } else {
                        done[other as usize].push(rect);
                    }
                }
                open.push((tone, [left, first, right, bottom]));
            }
            for (tone, rect) in above {
                done[tone as usize].push(rect);
            }
        }
        for (tone, rect) in open {
            done[tone as usize].push(rect);
        }
        done
    }

    /// Leaves only what is nearer than another raster of the same window, which then hides as well.
    pub fn keep_before(&mut self, other: &Self) {
        for (cell, &covered) in other.depths.iter().enumerate() {
            if self.depths[cell] < covered {
                (self.depths[cell], self.tones[cell]) = (covered, EMPTY);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use colltrans_testkit::random::Random;

    use super::*;

    fn window() -> Frame {
        Frame { low: DVec2::ZERO, high: DVec2::new(40.0, 30.0) }
    }

    /// Against each triangle at each sample.
    #[test]
    fn the_nearest_triangle_is_seen() {
        let mut random = Random::new(7);
        for _ in 0..20 {
            let mut point =
                || DVec3::new(random.range(-5.0, 45.0), random.range(-5.0, 35.0), random.unit());
            let triangles: Vec<[DVec3; 3]> = (0..12).map(|_| [point(), point(), point()]).collect();
            let mut raster = Raster::new(window());
            for (k, &triangle) in triangles.iter().enumerate() {
                raster.draw(triangle, k as u32);
            }
            for cell in 0..raster.width * raster.height {
                let at = DVec2::new(
                    (cell % raster.width) as f64 + 0.5,
                    (cell / raster.width) as f64 + 0.5,
                ) / FINE as f64;
                let mut best = (f64::NEG_INFINITY, EMPTY);
                for (k, [a, b, c]) in triangles.iter().enumerate() {
                    let area = |p: DVec2, q: DVec2, r: DVec2| (q - p).perp_dot(r - p);
                    let [p, q, r] = [a, b, c].map(|v| v.truncate());
                    let w =
                        [area(q, r, at), area(r, p, at), area(p, q, at)].map(|w| w / area(p, q, r));
                    let depth = w[0] * a.z + w[1] * b.z + w[2] * c.z;
                    if w.iter().all(|&w| w >= 0.0) && depth > best.0 {
                        best = (depth, k as u32);
                    }
                }
                assert_eq!(raster.tones[cell], best.1);
            }
        }
    }

    #[test]
    fn tiles_cover_what_was_drawn() {
        let mut raster = Raster::new(window());
        let corner = |x: f64, y: f64| DVec3::new(x, y, 0.0);
        raster.draw([corner(2.0, 3.0), corner(12.0, 3.0), corner(12.0, 9.0)], 4);
        raster.draw([corner(2.0, 3.0), corner(12.0, 9.0), corner(2.0, 9.0)], 4);
        let tiles = raster.tiles();
        assert_eq!(tiles[4], [[2, 3, 12, 9]]);
        assert_eq!(tiles.iter().map(Vec::len).sum::<usize>(), 1);
    }

    #[test]
    fn a_segment_is_seen_beside_what_hides_it() {
        let mut raster = Raster::new(window());
        let corner = |x: f64, y: f64| DVec3::new(x, y, 1.0);
        raster.draw([corner(10.0, -50.0), corner(20.0, -50.0), corner(20.0, 90.0)], 0);
        raster.draw([corner(10.0, -50.0), corner(20.0, 90.0), corner(10.0, 90.0)], 0);
        let ends = [DVec3::new(-100.0, 15.0, 0.0), DVec3::new(30.0, 15.0, 0.0)];
        let [seen, hidden] = raster.split(ends, 0.0);
        let near = |p: DVec2, x: f64| assert!(p.distance(DVec2::new(x, 15.0)) < 1.5, "{p} at {x}");
        assert_eq!([seen.len(), hidden.len()], [2, 1]);
        for (point, x) in
            [(seen[0][0], 0.0), (seen[0][1], 10.0), (hidden[0][1], 20.0), (seen[1][1], 30.0)]
        {
            near(point, x);
        }
        let nearer = ends.map(|p| p.with_z(2.0));
        assert_eq!(raster.split(nearer, 0.0).map(|parts| parts.len()), [1, 0]);
    }
}
