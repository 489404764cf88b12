//! Connected sets of sampled free directions.
//!
//! Free corners that share an edge of an uncut triangle are connected. Each free corner contributes a third of the
//! area of its triangles.

use glam::DVec3;

use crate::sphere::Sphere;
use crate::travel::PartTravel;

/// A connected set of free directions.
#[derive(Debug, Clone, PartialEq)]
pub struct Region {
    /// Solid angle in steradians.
    pub solid_angle: f64,
    /// Mean direction, of length 1, or one of the samples if the mean is zero. For a region of a cover, the free
    /// direction farthest from the border.
    pub center: DVec3,
    /// Directions halfway between free and blocked samples, sorted by angle around the centre. For a region of a
    /// cover, its corners.
    pub border: Vec<DVec3>,
}

pub(super) fn connected_regions(sphere: &Sphere, rooms: &[PartTravel]) -> Vec<Region> {
    let free = |k: u32| rooms[k as usize].is_free();
    let mut set = DisjointSets::new(rooms.len());
    for t in sphere.leaf_triangles() {
        let [a, b, c] = sphere.triangles[t].corners;
        for (a, b) in [(a, b), (b, c), (c, a)] {
            if free(a) && free(b) {
                set.merge_sets(a, b);
            }
        }
    }
    let mut found: Vec<(u32, RegionSums)> = Vec::new();
    for t in sphere.leaf_triangles() {
        let corners = sphere.triangles[t].corners;
        let share = sphere.solid_angle(t) / 3.0;
        for k in corners.into_iter().filter(|&k| free(k)) {
            let root = set.find_root(k);
            let place = found.iter().position(|f| f.0 == root).unwrap_or_else(|| {
                let first = sphere.directions[k as usize];
                found.push((root, RegionSums { first, ..RegionSums::default() }));
                found.len() - 1
            });
            let region = &mut found[place].1;
            region.area += share;
            region.sum += sphere.directions[k as usize] * share;
            for other in corners.into_iter().filter(|&o| !free(o)) {
                let sum = sphere.directions[k as usize] + sphere.directions[other as usize];
                region.border.push(sum.normalize());
            }
        }
    }
    let mut regions: Vec<Region> =
        found.into_iter().map(|(_, region)| region.into_region()).collect();
    regions.sort_by(|x, y| y.solid_angle.total_cmp(&x.solid_angle));
    regions
}

#[derive(Default)]
struct RegionSums {
    area: f64,
    sum: DVec3,
    first: DVec3,
    border: Vec<DVec3>,
}

impl RegionSums {
    fn into_region(mut self) -> Region {
        let center = self.sum.try_normalize().unwrap_or(self.first);
        let (u, v) = center.any_orthonormal_pair();
        let around = |d: &DVec3| d.dot(v).atan2(d.dot(u));
        self.border.sort_by(|x, y| around(x).total_cmp(&around(y)));
        self.border.dedup();
        Region { solid_angle: self.area, center, border: self.border }
    }
}

/// Disjoint sets of indices (union-find).
struct DisjointSets(Vec<u32>);

impl DisjointSets {
    fn new(count: usize) -> Self {
        Self((0..count as u32).collect())
    }

    fn find_root(&mut self, mut k: u32) -> u32 {
        while self.0[k as usize] != k {
            let above = self.0[self.0[k as usize] as usize];
            self.0[k as usize] = above;
            k = above;
        }
        k
    }

    fn merge_sets(&mut self, a: u32, b: u32) {
        let (a, b) = (self.find_root(a), self.find_root(b));
        self.0[a.max(b) as usize] = a.min(b);
    }
}
