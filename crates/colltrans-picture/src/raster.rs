//! A depth buffer over the page.
//!
//! Notation. A *sample* is the centre of a cell of `1 / SAMPLES_PER_PIXEL` pixels. Depths increase towards the viewer.
//!
//! Invariant: each sample has the depth and the tone of the nearest triangle drawn so far that covers it.

use glam::{DVec2, DVec3};

use crate::Frame;
use crate::grid::{Depth, Grid};

/// Number of samples per pixel, along each axis.
const SAMPLES_PER_PIXEL: usize = 2;
/// The tone of a sample without a triangle.
const EMPTY: u32 = u32::MAX;

/// Depths and tones over a window.
pub struct Raster {
    grid: Grid,
    depth: Depth,
    depths: Vec<f64>,
    tones: Vec<u32>,
    window: Frame,
}

impl Raster {
    /// Builds an empty raster over a window that begins at (0, 0). Depths are lengths.
    pub fn new(window: Frame) -> Self {
        let grid = Grid::new(window, SAMPLES_PER_PIXEL);
        let (depths, tones) = (vec![f64::NEG_INFINITY; grid.len()], vec![EMPTY; grid.len()]);
        Self { grid, depth: Depth::Length, depths, tones, window }
    }

    /// Sets the meaning of depths.
    #[must_use]
    pub fn with_depths(self, depth: Depth) -> Self {
        Self { depth, ..self }
    }

    /// Draws a triangle with a tone, any number except `u32::MAX`. Corners have x and y on the page, and the
    /// depth as z. At equal depths, the triangle drawn first remains.
    pub fn draw(&mut self, corners: [DVec3; 3], tone: u32) {
        self.grid.visit_covered(corners, |cell, depth| {
            if depth > self.depths[cell] {
                (self.depths[cell], self.tones[cell]) = (depth, tone);
            }
        });
    }

    /// Checks whether a point of the page at this depth is visible: a neighbouring sample is not nearer, or has
    /// one of the tones `own`.
    fn is_visible(&self, at: DVec2, depth: f64, own: &[u32]) -> bool {
        let is_visible =
            |cell: usize| self.depths[cell] <= depth || own.contains(&self.tones[cell]);
        self.grid.cells_around(at).any(is_visible)
    }

    /// Splits a segment into its visible and its hidden parts. The ends have x and y on the page, and the depth
    /// as z. A segment up to the length `slack` behind a surface is visible.
    pub fn split(&self, ends: [DVec3; 2], slack: f64) -> [Vec<[DVec2; 2]>; 2] {
        self.split_edge(ends, slack, &[])
    }

    /// Splits an edge of shapes with the tones `own` like [`Self::split`]. These shapes do not hide it,
    /// regardless of their slope.
    pub fn split_edge(&self, [a, b]: [DVec3; 2], slack: f64, own: &[u32]) -> [Vec<[DVec2; 2]>; 2] {
        let mut parts = [Vec::new(), Vec::new()];
        let (from, to) = (a.truncate(), b.truncate());
        let Some([first, last]) = self.window.clip_segment([from, to]) else { return parts };
        let whole = from.distance(to).max(f64::MIN_POSITIVE);
        let [s, t] = [first, last].map(|p| (p.distance(from) / whole).min(1.0));
        let steps = (first.distance(last) * SAMPLES_PER_PIXEL as f64).ceil().max(1.0) as usize;
        let at = |i: usize| s + (t - s) * i as f64 / steps as f64;
        let is_seen = |i: usize| {
            let p = a.lerp(b, 0.5 * (at(i) + at(i + 1)));
            self.is_visible(p.truncate(), self.depth.moved_nearer(p.z, slack), own)
        };
        let (mut start, mut was) = (0, is_seen(0));
        for i in 1..=steps {
            let is = i < steps && is_seen(i);
            if i == steps || is != was {
                let ends = [at(start), at(i)].map(|share| from.lerp(to, share));
                parts[usize::from(!was)].push(ends);
                (start, was) = (i, is);
            }
        }
        parts
    }

    /// Returns for each tone its rectangles in whole pixels: left, top, right, bottom.
    pub fn tiles(&self) -> Vec<Vec<[usize; 4]>> {
        let tones = self.tones.iter().filter(|tone| **tone != EMPTY).max();
        let mut done = vec![Vec::new(); tones.map_or(0, |last| *last as usize + 1)];
        let mut open: Vec<(u32, [usize; 4])> = Vec::new();
        for y in 0..self.grid.height / SAMPLES_PER_PIXEL {
            let mut runs: Vec<(u32, [usize; 4])> = Vec::new();
            for x in 0..self.grid.width / SAMPLES_PER_PIXEL {
                let tone =
                    self.tones[y * SAMPLES_PER_PIXEL * self.grid.width + x * SAMPLES_PER_PIXEL];
                match runs.last_mut() {
                    Some((last, [_, _, right, _])) if *last == tone && *right == x => *right += 1,
                    _ if tone == EMPTY => {}
                    _ => runs.push((tone, [x, y, x + 1, y + 1])),
                }
            }
            // A run equal to the one above extends its rectangle.
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

    /// Returns for each sample, row by row, its position on the page and its tone. The tone is `None` if the
    /// sample is not covered.
    pub fn samples(&self) -> impl Iterator<Item = (DVec2, Option<u32>)> {
        let place = |cell: usize| {
            DVec2::new((cell % self.grid.width) as f64, (cell / self.grid.width) as f64)
        };
        let sample = move |(cell, &tone): (usize, &u32)| {
            ((place(cell) + 0.5) / SAMPLES_PER_PIXEL as f64, (tone != EMPTY).then_some(tone))
        };
        self.tones.iter().enumerate().map(sample)
    }

    /// Removes the samples that are behind another raster of the same window. Its surfaces hide later shapes as
    /// well.
    pub fn keep_in_front_of(&mut self, other: &Self) {
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
    use crate::grid::tests::{WINDOW, cell_centre, depth_at, random_corners};

    /// Compares with each triangle at each sample.
    #[test]
    fn nearest_triangle_is_visible() {
        let mut random = Random::new(7);
        for _ in 0..20 {
            let triangles: Vec<[DVec3; 3]> = (0..12).map(|_| random_corners(&mut random)).collect();
            let mut raster = Raster::new(WINDOW);
            for (k, &triangle) in triangles.iter().enumerate() {
                raster.draw(triangle, k as u32);
            }
            for cell in 0..raster.grid.len() {
                let at = cell_centre(cell, &raster.grid);
                let depths = triangles.iter().enumerate();
                let depths = depths.filter_map(|(k, t)| Some((depth_at(at, *t)?, k as u32)));
                let best = depths.max_by(|a, b| a.0.total_cmp(&b.0));
                assert_eq!(raster.tones[cell], best.map_or(EMPTY, |(_, tone)| tone));
            }
        }
    }

    #[test]
    fn tiles_cover_drawn_triangles() {
        let mut raster = Raster::new(WINDOW);
        let corner = |x: f64, y: f64| DVec3::new(x, y, 0.0);
        raster.draw([corner(2.0, 3.0), corner(12.0, 3.0), corner(12.0, 9.0)], 4);
        raster.draw([corner(2.0, 3.0), corner(12.0, 9.0), corner(2.0, 9.0)], 4);
        let tiles = raster.tiles();
        assert_eq!(tiles[4], [[2, 3, 12, 9]]);
        assert_eq!(tiles.iter().map(Vec::len).sum::<usize>(), 1);
        let seen = |(at, tone): (DVec2, Option<u32>)| {
            let inside = at.x > 2.0 && at.x < 12.0 && at.y > 3.0 && at.y < 9.0;
            assert_eq!(tone, inside.then_some(4), "{at}");
            usize::from(inside)
        };
        assert_eq!(
            raster.samples().map(seen).sum::<usize>(),
            60 * SAMPLES_PER_PIXEL * SAMPLES_PER_PIXEL
        );
    }

    #[test]
    fn segment_is_hidden_only_behind_a_surface() {
        let mut raster = Raster::new(WINDOW);
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

    fn lengths(raster: &Raster, ends: [DVec3; 2], slack: f64, own: &[u32]) -> [f64; 2] {
        let length = |parts: Vec<[DVec2; 2]>| parts.iter().map(|[a, b]| a.distance(*b)).sum();
        raster.split_edge(ends, slack, own).map(length)
    }

    /// Also in a steep valley, whose edge is farther than its surroundings.
    #[test]
    fn edge_is_not_hidden_by_its_own_facets() {
        let v = DVec3::new;
        let mut raster = Raster::new(WINDOW).with_depths(Depth::Inverse);
        raster.draw([v(20.0, -10.0, 1.0), v(40.0, -10.0, 1.0), v(40.0, 60.0, 1.0)], 0);
        raster.draw([v(20.0, -10.0, 1.0), v(40.0, 60.0, 1.0), v(20.0, 60.0, 1.0)], 1);
        let across = |depth: f64| [v(0.0, 20.0, depth), v(60.0, 20.0, depth)];
        let [seen, hidden] = lengths(&raster, across(0.5), 1e-6, &[]);
        assert!((seen - 40.0).abs() <= 2.0 && (seen + hidden - 60.0).abs() < 1e-9, "{seen}");
        assert_eq!(lengths(&raster, across(2.0), 1e-6, &[]), [60.0, 0.0]);
        assert_eq!(lengths(&raster, across(0.5), 1e-6, &[0, 1]), [60.0, 0.0]);
        let mut valley = Raster::new(WINDOW).with_depths(Depth::Inverse);
        valley.draw([v(0.0, 20.0, 1.0), v(60.0, 20.0, 1.0), v(30.0, 19.0, 50.0)], 3);
        valley.draw([v(0.0, 20.0, 1.0), v(60.0, 20.0, 1.0), v(30.0, 21.0, 50.0)], 4);
        assert_eq!(lengths(&valley, across(1.0), 1e-6, &[3, 4]), [60.0, 0.0]);
        assert!(lengths(&valley, across(1.0), 1e-6, &[])[1] > 0.0);
    }

    /// The slack is a length of the scene: a point 1 behind a surface at distance 4 is at distance 5.
    #[test]
    fn slack_is_a_length_for_both_kinds_of_depth() {
        let v = DVec3::new;
        for kind in [Depth::Length, Depth::Inverse] {
            let depth = |away: f64| if kind == Depth::Length { -away } else { 1.0 / away };
            let mut raster = Raster::new(WINDOW).with_depths(kind);
            let z = depth(4.0);
            raster.draw([v(-99.0, -99.0, z), v(299.0, -99.0, z), v(-99.0, 299.0, z)], 0);
            let line = [5.0, 55.0].map(|x| v(x, 20.0, depth(5.0)));
            assert_eq!(raster.split(line, 0.99).map(|parts| parts.len()), [0, 1], "{kind:?}");
            assert_eq!(raster.split(line, 1.01).map(|parts| parts.len()), [1, 0], "{kind:?}");
        }
    }

    #[test]
    fn non_finite_triangles_are_not_drawn_and_segments_hidden_once() {
        let v = DVec3::new;
        let mut raster = Raster::new(WINDOW);
        raster.draw([v(f64::NAN, 0.0, 1.0), v(60.0, 0.0, 1.0), v(0.0, 40.0, 1.0)], 0);
        raster.draw([v(0.0, 0.0, f64::NAN), v(60.0, 0.0, 1.0), v(0.0, 40.0, 1.0)], 1);
        assert!(raster.tiles().is_empty());
        raster.draw([v(0.0, 0.0, 1.0), v(60.0, 0.0, 1.0), v(0.0, 40.0, 1.0)], 2);
        let line = [v(5.0, 5.0, f64::NAN), v(10.0, 5.0, 1.0)];
        assert_eq!(raster.split(line, 0.0).map(|parts| parts.len()), [0, 1]);
    }
}
