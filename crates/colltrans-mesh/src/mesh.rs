//! The mesh all formats are read into.

use glam::DVec3;

use crate::digits::{NumberFormat, Printed, largest_magnitude};

/// Vertices and polygons over them, as a file lists them.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct Mesh {
    /// The vertices, in the file's unit. Some may be used by no face.
    pub vertices: Vec<DVec3>,
    /// The faces, each a cycle of indices into `vertices`.
    pub faces: Vec<Vec<u32>>,
    /// What the file tells apart among the faces; empty where it tells nothing apart.
    pub groups: Groups,
    /// How many metres a unit of its lengths is, if the file says it.
    pub unit: Option<f64>,
    /// The axis that points upwards, if the file says it.
    pub up: Option<DVec3>,
    /// What was merged when the file was read; nothing for a mesh that comes from elsewhere.
    pub merged: Merged,
    /// How far apart vertices of the file may be written that were meant to be one: what is merged by
    /// default ([`ReadOptions::merge_tolerance`](crate::ReadOptions::merge_tolerance)); 0 for a mesh that
    /// comes from elsewhere.
    pub precision: f64,
    /// How the file writes its coordinates, which [`Self::precision`] follows from.
    pub format: NumberFormat,
    /// The printed forms of the coordinates of each vertex, while a text is read; else nothing.
    pub(crate) printed: Vec<[Printed; 3]>,
}

/// What a file tells apart: objects or groups of OBJ, solids of STL, nodes of DAE.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Groups {
    /// Their names, as the file has them; several may have one name, and some none (an empty one).
    pub names: Vec<String>,
    /// For each face the group that it is in, an index into `names`.
    pub of_face: Vec<u32>,
}

impl Groups {
    /// A group for the faces up to the last of `total` that have none yet; nothing if there are none.
    pub(crate) fn end(&mut self, name: &str, total: usize) {
        if self.of_face.len() < total {
            self.of_face.resize(total, self.names.len() as u32);
            self.names.push(name.to_owned());
        }
    }

    /// Nothing, unless there are several.
    pub(crate) fn several(self) -> Self {
        if self.names.len() > 1 { self } else { Self::default() }
    }
}

/// What was merged when a file was read.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Merged {
    /// The distance up to which vertices on open edges were merged, in the file's unit; 0 if only
    /// equal ones were.
    pub tolerance: f64,
    /// How many vertices were replaced by another with different coordinates.
    pub vertices: usize,
    /// The largest distance between a vertex and the one that took its place.
    pub largest_distance: f64,
    /// How many vertices had more than one other to choose from: where there are any, the
    /// tolerance is as large as details of the surface.
    pub ambiguous: usize,
    /// How many faces were left without area, as less than three different corners, and dropped.
    pub dropped_faces: usize,
}

impl Mesh {
    /// A mesh of these vertices and faces.
    pub fn new(vertices: Vec<DVec3>, faces: Vec<Vec<u32>>) -> Self {
        Self { vertices, faces, ..Self::default() }
    }

    /// Returns the same mesh as of a file that writes its coordinates in a format, with the precision that follows.
    #[must_use]
    pub fn with_format(mut self, format: NumberFormat) -> Self {
        self.precision = format.precision(largest_magnitude(self.vertices_in_use()));
        self.format = format;
        self
    }

    /// The smallest and the largest coordinates of the [vertices in use](Self::vertices_in_use); `None`
    /// without vertices.
    pub fn bounds(&self) -> Option<[DVec3; 2]> {
        let mut used = self.vertices_in_use();
        let first = used.next()?;
        Some(used.fold([first, first], |[low, high], v| [low.min(v), high.max(v)]))
    }

    /// The largest side of the box that the [vertices in use](Self::vertices_in_use) span; 0 without vertices.
    pub fn extent(&self) -> f64 {
        self.bounds().map_or(0.0, |[low, high]| (high - low).max_element())
    }

    /// Returns each vertex that a face uses, once; all vertices of a mesh without faces.
    ///
    /// Default tolerances depend on these alone, because a vertex that no face uses is no part of the body.
    pub fn vertices_in_use(&self) -> impl Iterator<Item = DVec3> + '_ {
        self.indices_in_use().map(|v| self.vertices[v])
    }

    /// Returns the index of each of the [vertices in use](Self::vertices_in_use).
    pub fn indices_in_use(&self) -> impl Iterator<Item = usize> + use<> {
        let all = self.faces.is_empty();
        let is_used = self.is_used().into_iter().enumerate();
        is_used.filter(move |(_, used)| all || *used).map(|(v, _)| v)
    }

    /// How many vertices no face uses.
    pub fn unused_vertices(&self) -> usize {
        self.is_used().iter().filter(|used| !**used).count()
    }

    /// Returns the number of vertices that no face uses, without those that were merged into others; 0 for a mesh
    /// without faces.
    pub fn stray_vertices(&self) -> usize {
        let unused = self.unused_vertices().saturating_sub(self.merged.vertices);
        if self.faces.is_empty() { 0 } else { unused }
    }

    /// For each vertex, whether a face uses it.
    fn is_used(&self) -> Vec<bool> {
        let mut is_used = vec![false; self.vertices.len()];
        for &v in self.faces.iter().flatten() {
            is_used[v as usize] = true;
        }
        is_used
    }

    /// The signed volume that a closed surface encloses: positive if the faces run
    /// counter-clockwise as seen from outside. Meaningless for an open one.
    pub fn signed_volume(&self) -> f64 {
        // One that is used: another one may be anywhere, or nowhere.
        let Some(&first) = self.faces.iter().flatten().next() else { return 0.0 };
        let origin = self.vertices[first as usize];
        let corner = |v: u32| self.vertices[v as usize] - origin;
        let six_volumes = self.faces.iter().filter(|face| face.len() >= 3).flat_map(|face| {
            face[1..]
                .windows(2)
                .map(|edge| corner(face[0]).dot(corner(edge[0]).cross(corner(edge[1]))))
        });
        six_volumes.sum::<f64>() / 6.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn volume_of_a_tetrahedron_away_from_the_origin() {
        let at = DVec3::splat(10.0);
        let mesh = Mesh::new(
            vec![at, at + DVec3::X, at + DVec3::Y, at + DVec3::Z],
            vec![vec![0, 2, 1], vec![0, 1, 3], vec![1, 2, 3], vec![0, 3, 2]],
        );
        assert!((mesh.signed_volume() - 1.0 / 6.0).abs() < 1e-15);
        assert_eq!(mesh.extent(), 1.0);
        let mut more = mesh.clone();
        more.vertices.push(DVec3::NAN);
        assert_eq!((more.signed_volume(), more.unused_vertices()), (mesh.signed_volume(), 1));
        assert_eq!(more.bounds(), mesh.bounds());
        assert_eq!(Mesh::default().bounds(), None);
    }
}
