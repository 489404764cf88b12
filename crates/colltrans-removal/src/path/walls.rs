//! Axes of moves that the search derives from the walls it meets: normals of the facets that stop bodies, and cross
//! products of two of them, along which a body slides on both walls.

use glam::DVec3;

/// Length of the cross product of two axes below which they are identified.
const SAME_AXIS: f64 = 1e-4;
/// Maximum number of distinct normals.
const MAX_NORMALS: usize = 64;
/// Number of most frequent normals whose cross products are candidates.
const MAX_CROSSED: usize = 8;

/// Normals of the facets that stopped bodies, each with its number of stops.
#[derive(Debug, Default)]
pub(super) struct MetWalls(Vec<(DVec3, usize)>);

impl MetWalls {
    /// Adds the normal of a facet that stopped a body.
    pub(super) fn add(&mut self, normal: DVec3) {
        let is_known = |(known, _): &(DVec3, usize)| known.cross(normal).length() < SAME_AXIS;
        match self.0.iter().position(is_known) {
            Some(k) => self.0[k].1 += 1,
            None if self.0.len() < MAX_NORMALS => self.0.push((normal, 1)),
            None => (),
        }
    }

    /// Returns at most `most` new axes of length 1 that are not parallel to known directions: cross products of
    /// frequent normals first, then normals.
    pub(super) fn new_axes(&self, known: &[DVec3], most: usize) -> Vec<DVec3> {
        let mut normals = self.0.clone();
        normals.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
        let frequent = &normals[..normals.len().min(MAX_CROSSED)];
        let pairs = (1..frequent.len()).flat_map(|j| (0..j).map(move |i| (i, j)));
        let crossed = pairs.map(|(i, j)| frequent[i].0.cross(frequent[j].0));
        let mut found: Vec<DVec3> = Vec::new();
        for axis in crossed.chain(frequent.iter().map(|(normal, _)| *normal)) {
            let Some(axis) = (axis.length() > SAME_AXIS).then(|| axis.normalize()) else {
                continue;
            };
            let axis = axis.map(|x| if x.abs() < 1e-12 { 0.0 } else { x });
            let is_known = |d: &DVec3| d.cross(axis).length() < SAME_AXIS;
            if found.len() < most && !known.iter().chain(&found).any(is_known) {
                found.push(axis);
            }
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slides_along_two_walls_come_before_normals() {
        let mut walls = MetWalls::default();
        let slanted = DVec3::new(0.5, 0.75_f64.sqrt(), 0.0);
        for normal in [DVec3::Z, slanted, slanted, DVec3::NEG_Z] {
            walls.add(normal);
        }
        let axes = walls.new_axes(&[DVec3::Z], 4);
        assert_eq!(axes.len(), 2, "{axes:?}");
        assert!(axes[0].cross(slanted.cross(DVec3::Z)).length() < 1e-12, "{axes:?}");
        assert!(axes[1].cross(slanted).length() < 1e-12, "{axes:?}");
        assert!(walls.new_axes(&axes, 4).iter().all(|axis| axis.cross(DVec3::Z).length() < 1e-12));
    }
}
