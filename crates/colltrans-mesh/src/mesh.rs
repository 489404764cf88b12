//! The mesh into which all formats are read.

use glam::DVec3;

use crate::digits::{NumberFormat, Printed, largest_magnitude};

/// Vertices and polygons, as a file lists them.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct Mesh {
    /// The vertices, in the unit of the file. Some may be unused.
    pub vertices: Vec<DVec3>,
    /// The faces, each a cycle of indices into `vertices`.
    pub faces: Vec<Vec<u32>>,
    /// The groups of faces that the file names; empty if there are fewer than two.
    pub groups: Groups,
    /// The unit of the file in metres, if the file has one.
    pub unit: Option<f64>,
    /// The upward axis, if the file has one.
    pub up: Option<DVec3>,
    /// The statistics of merging; zero for a mesh that was not read from a file.
    pub merged: Merged,
    /// The distance up to which vertices of the file may denote the same point because of its number format,
    /// and the default of [`ReadOptions::merge_tolerance`](crate::ReadOptions::merge_tolerance). It is 0 for a
    /// mesh that was not read from a file.
    pub precision: f64,
    /// The number format of the coordinates, from which [`Self::precision`] follows.
    pub format: NumberFormat,
    /// The printed forms of the coordinates of each vertex while a text is read; otherwise empty.
    pub(crate) printed: Vec<[Printed; 3]>,
}

/// The groups of a file: objects or groups of OBJ, solids of STL, nodes of COLLADA.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Groups {
    /// The names in the file. They may be empty or equal.
    pub names: Vec<String>,
    /// For each face the index of its group in `names`.
    pub of_face: Vec<u32>,
}

impl Groups {
    /// Adds a group with the faces up to `total` that have no group yet. Does nothing if there are none.
    pub(crate) fn end_group(&mut self, name: &str, total: usize) {
        if self.of_face.len() < total {
            self.of_face.resize(total, self.names.len() as u32);
            self.names.push(name.to_owned());
        }
    }

    /// Returns the groups, or no groups if there are fewer than two.
    pub(crate) fn unless_single(self) -> Self {
        if self.names.len() > 1 { self } else { Self::default() }
    }
}

/// Statistics of the vertices that were merged while a file was read.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Merged {
    /// The distance up to which vertices on open edges were merged, in the unit of the file; 0 if only equal
    /// vertices were merged.
    pub tolerance: f64,
    /// Number of vertices that were replaced by a vertex with different coordinates.
    pub vertices: usize,
    /// The largest distance between a vertex and its replacement.
    pub largest_distance: f64,
    /// Number of vertices with more than one candidate. If this is not 0, the tolerance is as large as details
    /// of the surface.
    pub ambiguous: usize,
    /// Number of faces that were removed because fewer than three different corners remained.
    pub dropped_faces: usize,
}

impl Mesh {
    /// Builds a mesh from vertices and faces.
    pub fn new(vertices: Vec<DVec3>, faces: Vec<Vec<u32>>) -> Self {
        Self { vertices, faces, ..Self::default() }
    }

    /// Sets the number format of the coordinates, and the precision that follows from it.
    #[must_use]
    pub fn with_format(mut self, format: NumberFormat) -> Self {
        self.precision = format.precision(largest_magnitude(self.vertices_in_use()));
        self.format = format;
        self
    }

    /// Returns the smallest and the largest coordinates of the [vertices in use](Self::vertices_in_use); `None`
    /// if there are no vertices.
    pub fn bounds(&self) -> Option<[DVec3; 2]> {
        let mut used = self.vertices_in_use();
        let first = used.next()?;
        Some(used.fold([first, first], |[low, high], v| [low.min(v), high.max(v)]))
    }

    /// Returns the longest edge of the bounding box of the [vertices in use](Self::vertices_in_use); 0 for a mesh
    /// without vertices.
    pub fn extent(&self) -> f64 {
        self.bounds().map_or(0.0, |[low, high]| (high - low).max_element())
    }

    /// Returns each vertex that a face uses, once; all vertices if the mesh has no faces.
    ///
    /// Default tolerances depend only on these vertices, because an unused vertex is not part of the body.
    pub fn vertices_in_use(&self) -> impl Iterator<Item = DVec3> + '_ {
        self.indices_in_use().map(|v| self.vertices[v])
    }

    /// Returns the index of each of the [vertices in use](Self::vertices_in_use).
    pub fn indices_in_use(&self) -> impl Iterator<Item = usize> + use<> {
        let all = self.faces.is_empty();
        let is_used = self.is_used().into_iter().enumerate();
        is_used.filter(move |(_, used)| all || *used).map(|(v, _)| v)
    }

    /// Returns the number of vertices that no face uses.
    pub fn unused_vertices(&self) -> usize {
        self.is_used().iter().filter(|used| !**used).count()
    }

    /// Returns the number of vertices that no face uses, without those that were merged into others; 0 if the
    /// mesh has no faces.
    pub fn stray_vertices(&self) -> usize {
        let unused = self.unused_vertices().saturating_sub(self.merged.vertices);
        if self.faces.is_empty() { 0 } else { unused }
    }

    /// Returns for each vertex whether a face uses it.
    fn is_used(&self) -> Vec<bool> {
        let mut is_used = vec![false; self.vertices.len()];
        for &v in self.faces.iter().flatten() {
            is_used[v as usize] = true;
        }
        is_used
    }

    /// Returns the signed volume of a closed surface. It is positive if the faces are counter-clockwise seen
    /// from outside. The result is meaningless for an open surface.
    pub fn signed_volume(&self) -> f64 {
        // The origin is a used vertex, because the coordinates of an unused one may be far away or NaN.
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
    fn volume_ignores_origin_and_unused_vertices() {
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
