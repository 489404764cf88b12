//! The search region: a convex polygon in the plane of levels that each step cuts (the paper, section III-A).

use glam::DVec2;

/// Maximum number of corners. Each of [`MAX_STEPS`](super::MAX_STEPS) cuts adds at most one side. During a cut,
/// the old and the new corners are stored.
const CAPACITY: usize = 2 * (super::MAX_STEPS as usize + 5);

/// A convex polygon in counter-clockwise order; empty once a cut leaves nothing.
#[derive(Debug, Clone, Copy)]
pub(super) struct LevelRegion {
    corners: [DVec2; CAPACITY],
    count: usize,
}

impl LevelRegion {
    /// Builds a rectangle from its lowest and highest levels.
    pub(super) fn from_rectangle(low: DVec2, high: DVec2) -> Self {
        let mut corners = [DVec2::ZERO; CAPACITY];
        corners[..4].copy_from_slice(&[
            low,
            DVec2::new(high.x, low.y),
            high,
            DVec2::new(low.x, high.y),
        ]);
        Self { corners, count: 4 }
    }

    /// Keeps the part where `gradient . v <= limit`.
    pub(super) fn cut_by(&mut self, gradient: DVec2, limit: f64) {
        let Some(&last) = self.corners[..self.count].last() else { return };
        let old = self.count;
        let mut from = last;
        let mut excess = gradient.dot(from) - limit;
        // The new corners are appended to the old ones, then moved to the front.
        for i in 0..old {
            let to = self.corners[i];
            let next_excess = gradient.dot(to) - limit;
            if (excess < 0.0 && next_excess > 0.0) || (excess > 0.0 && next_excess < 0.0) {
                self.push_corner(from + (to - from) * (excess / (excess - next_excess)));
            }
            if next_excess <= 0.0 {
                self.push_corner(to);
            }
            (from, excess) = (to, next_excess);
        }
        self.corners.copy_within(old..self.count, 0);
        self.count -= old;
    }

    pub(super) fn corners(&self) -> &[DVec2] {
        &self.corners[..self.count]
    }

    /// Returns the number of sides.
    pub(super) fn side_count(&self) -> u32 {
        self.count as u32
    }

    fn push_corner(&mut self, corner: DVec2) {
        self.corners[self.count] = corner;
        self.count += 1;
    }

    /// Returns the extent in both levels.
    pub(super) fn level_extent(&self) -> DVec2 {
        let corners = &self.corners[..self.count];
        let low = corners.iter().fold(DVec2::INFINITY, |low, corner| low.min(*corner));
        let high = corners.iter().fold(DVec2::NEG_INFINITY, |high, corner| high.max(*corner));
        high - low
    }

    /// Checks whether a point is inside or on the boundary.
    pub(super) fn contains(&self, point: DVec2) -> bool {
        let corners = &self.corners[..self.count];
        let next = corners.iter().cycle().skip(1);
        self.count > 2
            && corners.iter().zip(next).all(|(&a, &b)| (b - a).perp_dot(point - a) >= 0.0)
    }

    /// Returns the centroid. `None` if no area is left.
    pub(super) fn centroid(&self) -> Option<DVec2> {
        let corners = &self.corners[..self.count];
        let (&first, rest) = corners.split_first()?;
        let mut area = 0.0;
        let mut moment = DVec2::ZERO;
        for pair in rest.windows(2) {
            let (p, q) = (pair[0] - first, pair[1] - first);
            let doubled = p.perp_dot(q);
            area += doubled;
            moment += (p + q) * doubled;
        }
        let centroid = first + moment / (3.0 * area);
        (area > 0.0 && centroid.is_finite()).then_some(centroid)
    }
}

/// The paper's neighbourhood `N(p)` of a solution `p`: a square. Levels are relative to the middle of all
/// levels.
#[derive(Debug, Clone, Copy)]
pub(super) struct Neighbourhood {
    /// The solution `p`.
    pub(super) center: DVec2,
    /// Half-side `delta`.
    pub(super) half: f64,
}

impl Neighbourhood {
    /// Returns the point `c*` where the way from `c` to the centre enters the square, or `c` if `c` is inside.
    pub(super) fn entry_point(&self, c: DVec2) -> DVec2 {
        let way = c - self.center;
        let farther = way.abs().max_element();
        if farther <= self.half { c } else { self.center + way * (self.half / farther) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cuts_halve_then_empty_rectangle() {
        let mut region = LevelRegion::from_rectangle(DVec2::ZERO, DVec2::splat(2.0));
        assert_eq!(region.centroid(), Some(DVec2::ONE));
        assert!(region.contains(DVec2::new(2.0, 0.5)) && !region.contains(DVec2::new(2.1, 0.5)));
        region.cut_by(DVec2::X, 1.0);
        assert_eq!(region.centroid(), Some(DVec2::new(0.5, 1.0)));
        region.cut_by(DVec2::ONE, 1.0);
        let third = 1.0 / 3.0;
        assert!((region.centroid().unwrap() - DVec2::splat(third)).length() < 1e-15);
        region.cut_by(-DVec2::X, -1.0);
        assert_eq!(region.centroid(), None);
        region.cut_by(-DVec2::X, -2.0);
        assert_eq!(region.centroid(), None);
    }

    #[test]
    fn region_holds_one_cut_for_each_step() {
        let mut region = LevelRegion::from_rectangle(DVec2::splat(-1.0), DVec2::ONE);
        for i in 0..super::super::MAX_STEPS {
            region.cut_by(DVec2::from_angle(f64::from(i)), 1.0);
        }
        assert!(region.centroid().unwrap().length() < 0.1);
    }
}
