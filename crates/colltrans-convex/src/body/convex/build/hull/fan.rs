//! Which triangle around an apex a point sees, found without a look at each of them.
//!
//! The triangles from a rim to an apex bound a convex cone. Seen from the apex along an axis inside the cone its
//! sides are sectors, in the order of the angles of the rim. A half-plane from the axis through a point
//! passes one of them, and of the half-circle of directions that it holds, from the axis on, those beyond that
//! side are outside of it: a point that sees a triangle sees the one of its sector.
//!
//! Rounded, so only a guess: who asks checks that the point sees it, and looks at all triangles if not.

use glam::DVec3;

/// A cone of triangles by the angles at which they begin.
pub(super) struct ConeSectors {
    apex: DVec3,
    /// Two axes across the one inside.
    across: [DVec3; 2],
    /// Ascending: an angle, and the triangle whose rim edge starts there.
    starts: Vec<(f64, u32)>,
}

impl ConeSectors {
    /// From where each rim edge starts, with its triangle.
    pub(super) fn new(apex: DVec3, rim: impl Iterator<Item = (DVec3, u32)> + Clone) -> Self {
        let inside: DVec3 = rim.clone().map(|(p, _)| (p - apex).normalize_or_zero()).sum();
        let axis = inside.try_normalize().unwrap_or(DVec3::Z);
        let x = axis.any_orthonormal_vector();
        let mut sectors = Self { apex, across: [x, axis.cross(x)], starts: Vec::new() };
        sectors.starts = rim.map(|(p, triangle)| (sectors.pseudo_angle(p), triangle)).collect();
        sectors.starts.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        sectors
    }

    /// The triangle of a point's sector, and the two beside it.
    pub(super) fn candidates(&self, p: DVec3) -> [u32; 3] {
        let count = self.starts.len();
        let angle = self.pseudo_angle(p);
        let after = self.starts.partition_point(|start| start.0 <= angle);
        [count - 1, 0, count - 2].map(|k| self.starts[(after + k) % count].1)
    }

    /// What grows with the angle around the axis, from -1 to 3.
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

    /// Cones of all widths around an apex, points on all sides, those behind it too: what lies outside of a
    /// triangle lies outside of one that is named.
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
