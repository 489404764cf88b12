//! Validation: from a list of polygons to a checked surface.
//!
//! 1. Merge vertices with equal coordinates.
//! 2. Triangulate polygons, and drop polygons without area.
//! 3. Close slits, which these polygons or vertices on an edge leave, by exact subdivision.
//! 4. Join triangles across edges.
//!
//! Invariants of a [`Surface`]: each triangle has an area. In a closed surface each side has a neighbour, and
//! neighbours traverse their common edge in opposite directions.

use glam::DVec3;

use super::edges::{self, Edges};
use super::error::SolidError;
use super::exact::{are_collinear, is_strictly_between};
use super::faces::Faces;
use super::polygon::triangulate;
use super::report::{ShellKind, SolidReport};
use super::weld::first_equal_vertices;
use colltrans_convex::body::{InputFacet, InputVertex};
use colltrans_kernel::range::is_in_exact_range;

/// Maximum number of subdivision rounds. Each round joins at least one pair of edges in every slit that can be
/// closed.
const MAX_ROUNDS: usize = 64;

/// A validated triangle mesh.
pub(crate) struct Surface {
    /// Vertices in use.
    pub(crate) vertices: Vec<DVec3>,
    /// Input indices of the vertices.
    pub(crate) vertex_index: Vec<InputVertex>,
    pub(crate) triangles: Vec<[u32; 3]>,
    /// Input facet of each triangle.
    pub(crate) facet_index: Vec<InputFacet>,
    pub(crate) neighbours: Vec<[u32; 3]>,
    /// Number of vertices and of facets of the input.
    pub(crate) input_counts: [u32; 2],
    /// Polygonal faces, known only for an offset solid.
    pub(crate) faces: Option<Faces>,
    /// Kind of the shell of each triangle; `Closed` until shells are classified.
    pub(crate) kinds: Vec<ShellKind>,
}

impl Surface {
    /// Gives sheets their own copies of shared vertices, because an offset moves the vertices of other shells only.
    pub(super) fn separate_sheets(&mut self) {
        /// Marks a vertex of a shell that is not a sheet.
        const OTHER_SHELL: u32 = u32::MAX;
        let sheet = |k: &ShellKind| *k == ShellKind::Sheet;
        if self.kinds.iter().all(sheet) || !self.kinds.iter().any(sheet) {
            return;
        }
        let mut copies = vec![0; self.vertices.len()];
        for (t, kind) in self.triangles.iter().zip(&self.kinds) {
            if !sheet(kind) {
                for &v in t {
                    copies[v as usize] = OTHER_SHELL;
                }
            }
        }
        for (t, kind) in self.triangles.iter_mut().zip(&self.kinds) {
            for v in t.iter_mut().filter(|_| sheet(kind)) {
                let old = *v as usize;
                if copies[old] == 0 {
                    continue;
                }
                if copies[old] == OTHER_SHELL {
                    copies[old] = self.vertices.len() as u32;
                    self.vertices.push(self.vertices[old]);
                    self.vertex_index.push(self.vertex_index[old]);
                }
                *v = copies[old];
            }
        }
    }
}

/// Builds a checked surface from polygons. If `open` is set, slits are not closed, and edges may have a facet on one
/// side only.
pub(super) fn validated_surface<F: AsRef<[u32]>>(
    vertices: &[DVec3],
    facets: &[F],
    open: bool,
    report: &mut SolidReport,
) -> Result<Surface, SolidError> {
    check_input(vertices, facets)?;
    let first = first_equal_vertices(vertices);
    let mut soup = Soup { triangles: Vec::new(), facet_index: Vec::new() };
    for (facet, corners) in facets.iter().enumerate() {
        soup.push_facet(vertices, &first, facet, corners.as_ref(), report)?;
    }
    let mut edges = Edges::new(vertices, &soup.triangles);
    for _ in 0..MAX_ROUNDS {
        if open || !soup.close_slits(vertices, &edges.open, report) {
            break;
        }
        edges = Edges::new(vertices, &soup.triangles);
    }
    if soup.triangles.is_empty() {
        return Err(SolidError::Empty);
    }
    report.non_manifold_edges += edges.crowded;
    report.open_edges += edges.open.len();
    soup.check_edges(&edges, open)?;
    let input_counts = [vertices.len() as u32, facets.len() as u32];
    Ok(Surface { input_counts, ..soup.into_surface(vertices, &first, edges.neighbours, report) })
}

fn check_input<F: AsRef<[u32]>>(vertices: &[DVec3], facets: &[F]) -> Result<(), SolidError> {
    for (vertex, &point) in vertices.iter().enumerate() {
        if !is_in_exact_range(point) {
            return Err(SolidError::Coordinate { vertex, point });
        }
    }
    let count = facets.iter().map(|f| f.as_ref().len()).sum::<usize>();
    let count = count.max(vertices.len()).max(facets.len());
    let limit = u32::MAX as usize / 4;
    if count > limit {
        return Err(SolidError::TooMany { count, limit });
    }
    for (facet, corners) in facets.iter().enumerate() {
        if let Some(&v) = corners.as_ref().iter().find(|&&v| v as usize >= vertices.len()) {
            let vertex = v as usize;
            return Err(SolidError::UnknownVertex { facet, vertex, vertices: vertices.len() });
        }
    }
    Ok(())
}

/// Triangles with area, with positions in the input vertices as corners.
struct Soup {
    triangles: Vec<[u32; 3]>,
    facet_index: Vec<InputFacet>,
}

impl Soup {
    /// Adds the triangles of a polygon with merged vertices, or counts the polygon if it has no area.
    fn push_facet(
        &mut self,
        vertices: &[DVec3],
        first: &[u32],
        facet: usize,
        corners: &[u32],
        report: &mut SolidReport,
    ) -> Result<(), SolidError> {
        let mut ring: Vec<u32> = corners.iter().map(|&v| first[v as usize]).collect();
        ring.dedup();
        while ring.len() > 1 && ring.first() == ring.last() {
            ring.pop();
        }
        if !has_area(vertices, &ring) {
            report.facets_without_area += 1;
            return Ok(());
        }
        self.push_ring(vertices, InputFacet(facet as u32), &ring)
    }

    fn push_ring(
        &mut self,
        vertices: &[DVec3],
        facet: InputFacet,
        ring: &[u32],
    ) -> Result<(), SolidError> {
        if let &[a, b, c] = ring {
            self.triangles.push([a, b, c]);
            self.facet_index.push(facet);
            return Ok(());
        }
        let points: Vec<DVec3> = ring.iter().map(|&v| vertices[v as usize]).collect();
        let cut = triangulate(&points).ok_or(SolidError::Polygon { facet: facet.index() })?;
        for corners in cut {
            self.triangles.push(corners.map(|k| ring[k]));
            self.facet_index.push(facet);
        }
        Ok(())
    }

    /// Subdivides triangles at ends of open edges that lie exactly on their own open sides. Returns whether any
    /// triangle was subdivided.
    fn close_slits(&mut self, vertices: &[DVec3], open: &[u32], report: &mut SolidReport) -> bool {
        let mut leaving: Vec<(u32, u32)> = Vec::with_capacity(open.len());
        let mut arriving = leaving.clone();
        for &h in open {
            let [from, to] = edges::half_edge_ends(&self.triangles, h);
            leaving.push((from, to));
            arriving.push((to, from));
        }
        leaving.sort_unstable();
        arriving.sort_unstable();
        let mut cuts: Vec<(u32, Vec<u32>)> = Vec::new();
        for &h in open {
            let [p, q] = edges::half_edge_ends(&self.triangles, h);
            let mut points = vertices_inside_edge(vertices, &leaving, q, [p, q]);
            points.extend(vertices_inside_edge(vertices, &arriving, p, [p, q]));
            let along = |v: &u32| (vertices[*v as usize] - vertices[p as usize]).length_squared();
            points.sort_by(|a, b| along(a).total_cmp(&along(b)));
            points.dedup();
            if !points.is_empty() {
                cuts.push((h, points));
            }
        }
        report.slits_closed += cuts.len();
        self.subdivide_triangles(vertices, &cuts);
        !cuts.is_empty()
    }

    /// Inserts vertices into sides of triangles, and triangulates these again. `cuts` lists half-edges with their
    /// vertices.
    fn subdivide_triangles(&mut self, vertices: &[DVec3], cuts: &[(u32, Vec<u32>)]) {
        let mut cuts = cuts.to_vec();
        cuts.sort_by_key(|c| c.0);
        for group in cuts.chunk_by(|a, b| a.0 / 3 == b.0 / 3) {
            let t = group[0].0 as usize / 3;
            let mut ring = Vec::new();
            for k in 0..3 {
                ring.push(self.triangles[t][k]);
                let cut = group.iter().find(|c| c.0 as usize % 3 == k);
                ring.extend(cut.map_or(&[][..], |c| &c.1));
            }
            let points: Vec<DVec3> = ring.iter().map(|&v| vertices[v as usize]).collect();
            // Points on the sides of a triangle always have a triangulation.
            let Some(pieces) = triangulate(&points) else { continue };
            let facet = self.facet_index[t];
            for (n, corners) in pieces.into_iter().enumerate() {
                let corners = corners.map(|k| ring[k]);
                if n == 0 {
                    self.triangles[t] = corners;
                } else {
                    self.triangles.push(corners);
                    self.facet_index.push(facet);
                }
            }
        }
    }

    /// Returns an error for edges with inconsistent orientations, and for open edges unless `open` is set.
    fn check_edges(&self, edges: &Edges, open: bool) -> Result<(), SolidError> {
        let name = |h: u32| {
            let [from, to] = edges::half_edge_ends(&self.triangles, h).map(|v| v as usize);
            (from, to, self.facet_index[h as usize / 3].index())
        };
        if let Some(&h) = edges.inconsistent.first() {
            let (from, to, facet) = name(h);
            return Err(SolidError::Inconsistent {
                count: edges.inconsistent.len().div_ceil(2),
                from,
                to,
                facet,
            });
        }
        if let (Some(&h), false) = (edges.open.first(), open) {
            let (from, to, facet) = name(h);
            return Err(SolidError::Open { count: edges.open.len(), from, to, facet });
        }
        Ok(())
    }

    /// Builds the surface, without unused vertices.
    fn into_surface(
        self,
        vertices: &[DVec3],
        first: &[u32],
        neighbours: Vec<[u32; 3]>,
        report: &mut SolidReport,
    ) -> Surface {
        let mut used = vec![false; vertices.len()];
        for v in self.triangles.iter().flatten() {
            used[*v as usize] = true;
        }
        let repeated = first.iter().enumerate().filter(|&(v, &f)| v as u32 != f).count();
        report.vertices_merged += repeated;
        let vertex_index: Vec<InputVertex> =
            (0..vertices.len() as u32).map(InputVertex).filter(|v| used[v.index()]).collect();
        let mut position = vec![0; vertices.len()];
        for (k, &v) in vertex_index.iter().enumerate() {
            position[v.index()] = k as u32;
        }
        Surface {
            // Adding 0 replaces -0 by 0 and changes no other number.
            vertices: vertex_index.iter().map(|v| vertices[v.index()] + 0.0).collect(),
            triangles: self.triangles.iter().map(|t| t.map(|v| position[v as usize])).collect(),
            vertex_index,
            kinds: vec![ShellKind::Closed; self.facet_index.len()],
            facet_index: self.facet_index,
            neighbours,
            input_counts: [0; 2],
            faces: None,
        }
    }
}

/// Checks whether the corners are not all on one line.
fn has_area(vertices: &[DVec3], ring: &[u32]) -> bool {
    let at = |k: usize| vertices[ring[k] as usize];
    ring.len() >= 3 && (2..ring.len()).any(|k| !are_collinear(at(0), at(1), at(k)))
}

/// Returns the vertices strictly inside the edge from `p` to `q` that a chain of open edges from `start` visits.
fn vertices_inside_edge(
    vertices: &[DVec3],
    next: &[(u32, u32)],
    start: u32,
    [p, q]: [u32; 2],
) -> Vec<u32> {
    let [a, b] = [p, q].map(|v| vertices[v as usize]);
    let inside = |v: u32| {
        let m = vertices[v as usize];
        is_strictly_between(a, b, m) && are_collinear(a, b, m)
    };
    let mut found = Vec::new();
    let mut at = start;
    while let Some(m) = {
        let from = next.partition_point(|e| e.0 < at);
        next[from..].iter().take_while(|e| e.0 == at).map(|e| e.1).find(|&m| inside(m))
    } {
        if found.contains(&m) {
            break;
        }
        found.push(m);
        at = m;
    }
    found
}

#[cfg(test)]
mod tests {
    use colltrans_testkit::shapes::{Mesh, block};

    use super::*;

    /// Returns a cube whose top edge from (0, 0, 1) to (1, 0, 1) has vertices on one side only. If `degenerate` is
    /// set, facets without area fill the slit.
    fn cube_with_a_slit(degenerate: bool) -> (Vec<DVec3>, Vec<Vec<u32>>) {
        let Mesh { mut vertices, faces: mut facets } = block(DVec3::ZERO, DVec3::ONE);
        vertices.push(DVec3::new(0.25, 0.0, 1.0));
        vertices.push(DVec3::new(0.75, 0.0, 1.0));
        facets[1] = vec![4, 8, 9, 5, 7, 6];
        if degenerate {
            facets.extend([vec![4, 5, 9], vec![4, 9, 8]]);
        }
        (vertices, facets)
    }

    #[test]
    fn slits_with_and_without_facets_are_closed() {
        for degenerate in [false, true] {
            let (vertices, facets) = cube_with_a_slit(degenerate);
            let mut report = SolidReport::default();
            let surface = validated_surface(&vertices, &facets, false, &mut report).unwrap();
            assert_eq!(report.slits_closed, 1);
            assert_eq!(report.facets_without_area, if degenerate { 2 } else { 0 });
            assert!(surface.neighbours.iter().flatten().all(|&n| n != edges::NO_NEIGHBOUR));
            assert_eq!(surface.triangles.len(), 16, "a sphere with 10 vertices has 16 triangles");
        }
    }

    #[test]
    fn invalid_surfaces_are_rejected_with_count_and_place() {
        let (vertices, mut facets) = cube_with_a_slit(false);
        facets.pop();
        let refused = |facets: &[Vec<u32>]| {
            validated_surface(&vertices, facets, false, &mut SolidReport::default()).err().unwrap()
        };
        assert!(matches!(refused(&facets), SolidError::Open { count: 4, .. }));
        facets.push(vec![5, 7, 3, 1]);
        let error = refused(&facets);
        assert!(matches!(error, SolidError::Inconsistent { count: 4, .. }), "{error}");
        facets.pop();
        facets.push(vec![1, 3, 70, 5]);
        let named = SolidError::UnknownVertex { facet: 5, vertex: 70, vertices: 10 };
        assert_eq!(refused(&facets), named);
        assert_eq!(refused(&[]), SolidError::Empty);
    }
}
