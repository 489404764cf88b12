//! The mesh all formats are read into.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use glam::DVec3;

use crate::merge::Merged;

/// Vertices and polygons over them, as a file lists them.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct Mesh {
    /// The vertices, in the file's unit. Some may be used by no face.
    pub vertices: Vec<DVec3>,
    /// The faces, each a cycle of indices into `vertices`.
    pub faces: Vec<Vec<u32>>,
    /// What was merged when the file was read; nothing for a mesh that comes from elsewhere.
    pub merged: Merged,
}

impl Mesh {
    /// A mesh of these vertices and faces.
    pub fn new(vertices: Vec<DVec3>, faces: Vec<Vec<u32>>) -> Self {
        Self { vertices, faces, merged: Merged::default() }
    }

    /// Merges vertices with equal coordinates (bit for bit, except that `-0` equals `0`).
    ///
    /// Vertices keep the order of their first appearance. Steps that a face then makes to and
    /// fro are taken out of it, and so are faces with fewer than three corners left: such a
    /// face has no area, and the edges it joined become neighbours.
    #[must_use]
    pub fn weld(&self) -> Self {
        let mut index_of = HashMap::with_capacity(self.vertices.len() / 4);
        let mut vertices = Vec::new();
        let welded: Vec<u32> = self
            .vertices
            .iter()
            .map(|&vertex| match index_of.entry(key(vertex)) {
                Entry::Occupied(known) => *known.get(),
                Entry::Vacant(new) => {
                    let index = vertices.len() as u32;
                    vertices.push(vertex);
                    *new.insert(index)
                }
            })
            .collect();
        let renamed = |face: &Vec<u32>| face.iter().map(|&v| welded[v as usize]).collect();
        let faces = self.faces.iter().map(renamed).collect();
        let mut mesh = Self { vertices, faces, merged: self.merged };
        mesh.drop_flat_faces();
        mesh
    }

    /// The smallest and the largest coordinates of all vertices; `None` without vertices.
    pub fn bounds(&self) -> Option<[DVec3; 2]> {
        let first = *self.vertices.first()?;
        Some(self.vertices.iter().fold([first, first], |[low, high], &v| [low.min(v), high.max(v)]))
    }

    /// The largest side of the box that the vertices span; 0 without vertices.
    pub fn extent(&self) -> f64 {
        self.bounds().map_or(0.0, |[low, high]| (high - low).max_element())
    }

    /// The signed volume that a closed surface encloses: positive if the faces run
    /// counter-clockwise as seen from outside. Meaningless for an open one.
    pub fn signed_volume(&self) -> f64 {
        let Some(&origin) = self.vertices.first() else { return 0.0 };
        let corner = |v: u32| self.vertices[v as usize] - origin;
        let six_volumes = self.faces.iter().filter(|face| face.len() >= 3).flat_map(|face| {
            face[1..]
                .windows(2)
                .map(|edge| corner(face[0]).dot(corner(edge[0]).cross(corner(edge[1]))))
        });
        six_volumes.sum::<f64>() / 6.0
    }
}

/// Equal exactly for equal coordinates.
fn key(vertex: DVec3) -> [u64; 3] {
    // Adding 0 turns -0 into 0 and changes nothing else.
    vertex.to_array().map(|c| (c + 0.0).to_bits())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn welding_merges_signed_zeros_and_drops_faces_without_area() {
        let mesh = Mesh::new(
            vec![
                DVec3::new(0.0, 0.0, 0.0),
                DVec3::new(1.0, 0.0, 0.0),
                DVec3::new(0.0, 1.0, 0.0),
                DVec3::new(-0.0, 0.0, 0.0),
                DVec3::new(1.0, 0.0, 1e-300),
            ],
            vec![vec![0, 1, 2], vec![0, 3, 1], vec![3, 1, 4, 2], vec![2, 0, 3, 1]],
        );
        let welded = mesh.weld();
        assert_eq!(welded.vertices.len(), 4, "only the two zeros are equal");
        assert_eq!(welded.faces, [vec![0, 1, 2], vec![0, 1, 3, 2], vec![2, 0, 1]]);
        assert_eq!(welded.merged.dropped_faces, 1);
        assert_eq!(welded.weld(), welded);
    }

    #[test]
    fn volume_of_a_tetrahedron_away_from_the_origin() {
        let at = DVec3::splat(10.0);
        let mesh = Mesh::new(
            vec![at, at + DVec3::X, at + DVec3::Y, at + DVec3::Z],
            vec![vec![0, 2, 1], vec![0, 1, 3], vec![1, 2, 3], vec![0, 3, 2]],
        );
        assert!((mesh.signed_volume() - 1.0 / 6.0).abs() < 1e-15);
        assert_eq!(mesh.extent(), 1.0);
        assert_eq!(Mesh::default().bounds(), None);
    }
}
