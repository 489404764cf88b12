//! Finds the triangle of a cone around an apex that is visible from a point, without a test of each triangle.
//!
//! The triangles from a rim to an apex bound a convex cone. Seen from the apex along an axis inside the cone, its
//! sides are sectors, ordered by the angles of the rim. A half-plane from the axis through a point passes one of
//! them. In this half-plane, the directions beyond that side are outside the cone. Therefore, if any triangle is
//! visible from a point, the one of its sector is.
//!
//! The result is rounded, so it is a guess. The caller tests its visibility, and tests all triangles if it fails.

use glam::DVec3;

/// The triangles of a cone, ordered by the angles at which they begin.
pub(super) struct ConeSectors {
    apex: DVec3,
    /// Two axes orthogonal to the one inside.
    across: [DVec3; 2],
    /// Ascending pairs of an angle and the triangle whose rim edge starts there.
    starts: Vec<(f64, u32)>,
}

impl ConeSectors {
    /// Builds the sectors from the start of each rim edge, with its triangle.
    pub(super) fn new(apex: DVec3, rim: impl Iterator<Item = (DVec3, u32)> + Clone) -> Self {
        let inside: DVec3 = rim.clone().map(|(p, _)| (p - apex).normalize_or_zero()).sum();
        let axis = inside.try_normalize().unwrap_or(DVec3::Z);
        let x = axis.any_orthonormal_vector();
        let mut sectors = Self { apex, across: [x, axis.cross(x)], starts: Vec::new() };
        sectors.starts = rim.map(|(p, triangle)| (sectors.pseudo_angle(p), triangle)).collect();
        sectors.starts.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        sectors
    }

    /// Returns the triangle of a point's sector and the two next to it.
    pub(super) fn candidates(&self, p: DVec3) -> [u32; 3] {
        let count = self.starts.len();
        let angle = self.pseudo_angle(p);
        let after = self.starts.partition_point(|start| start.0 <= angle);
        [count - 1, 0, count - 2].map(|k| self.starts[(after + k) % count].1)
    }

    /// Returns a pseudo-angle around the axis, from -1 to 3, which increases with the angle.
    fn pseudo_angle(&self, p: DVec3) -> f64 {
        let [x, y] = self.across.map(|axis| axis.dot(p - self.apex));
        let slope = y / (x.abs() + y.abs());
        if x >= 0.0 { slope } else { 2.0 - slope }
    }
}

#[cfg(test)]
mod tests {
    use colltrans_testkit::random::Random;
    use colltrans_testkit::shapes::ring;

    use super::*;
    use colltrans_kernel::predicates::orient3d;

    /// Cones of all widths, and points on all sides, also behind the cone: if a point is outside a triangle, it is
    /// outside a candidate.
    #[test]
    fn candidates_contain_a_visible_triangle() {
        let mut random = Random::new(11);
        let (mut outside, mut inside) = (0, 0);
        for round in 0..200 {
            let (apex, sides) = (random.direction(), 8 + round % 90);
            let narrow = if round % 2 == 0 { 1.0 } else { random.range(0.01, 1.0) };
            let depth = random.range(1e-6, 3.0);
            let rotation = random.rotation();
            let rim: Vec<DVec3> = ring(sides, 1.0, -depth)
                .map(|p| apex + rotation * (p * DVec3::new(narrow, 1.0, 1.0)))
                .collect();
            let sectors = ConeSectors::new(apex, rim.iter().copied().zip(0..));
            for _ in 0..100 {
                let p = apex + random.direction();
                let sees = |k: u32| {
                    let next = rim[(k as usize + 1) % sides];
                    orient3d(rim[k as usize], next, apex, p) > 0.0
                };
                let is_outside = (0..sides as u32).any(sees);
                assert_eq!(sectors.candidates(p).into_iter().any(sees), is_outside, "{round}");
                *(if is_outside { &mut outside } else { &mut inside }) += 1;
            }
        }
        assert!(outside > 2_000 && inside > 2_000, "{outside} outside, {inside} inside");
    }
}
