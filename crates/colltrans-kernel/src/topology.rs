//! Topology of a polyhedron: a half-edge structure without coordinates.
//!
//! Notation. The half-edges of a face are consecutive, counter-clockwise as seen from outside. Half-edge `h`
//! runs from `origin(h)` to `origin(twin(h))`, with its face on its left. Invariants, checked for every
//! input:
//!
//! - Every half-edge has exactly one twin of the opposite direction. The faces around a vertex form one fan.
//! - The surface of a convex body is one sphere. A flat polygon has a front and a back face. A segment has
//!   two vertices that are neighbours of each other, a point one vertex, both without faces.
//!
//! [`Links`] use more than half of the memory (16 of about 26 bytes for each half-edge). A body that needs only
//! neighbours can drop them, and the next access rebuilds them.

use std::sync::OnceLock;

use crate::error::TopologyError;

/// A directed edge of a face of a polyhedron.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct HalfEdge {
    /// The vertex at the start of the half-edge.
    pub origin: u32,
    /// The half-edge of the opposite direction, in the neighbouring face. It starts at the end of this
    /// half-edge.
    pub twin: u32,
    /// The face on the left, as seen from outside.
    pub face: u32,
}

/// Vertices, half-edges and faces, by their numbers.
#[derive(Debug, Clone)]
pub struct Topology {
    /// The vertex at the start of each half-edge. These are the corners of all faces.
    origins: Vec<u32>,
    /// First half-edge of each face. The last entry is the number of half-edges.
    face_start: Vec<u32>,
    /// First entry of each vertex in `neighbours` and `outgoing`. The last entry is the length of `neighbours`.
    vertex_start: Vec<u32>,
    /// The neighbours of each vertex, clockwise as seen from outside.
    neighbours: Vec<u32>,
    links: OnceLock<Links>,
}

/// Connections of the half-edges, which can be rebuilt from the faces.
#[derive(Debug, Clone, Default)]
struct Links {
    half_edges: Vec<HalfEdge>,
    /// The half-edges to the neighbours of each vertex, in the order of the neighbours; empty without faces.
    outgoing: Vec<u32>,
}

/// Number of a missing half-edge or face.
const MISSING: u32 = u32::MAX;

impl Topology {
    /// Builds one closed surface of sphere topology. Parameters as in [`Self::from_faces`].
    ///
    /// # Errors
    /// The errors of [`Self::from_faces`], and [`TopologyError::NotASphere`].
    pub fn from_sphere_faces(
        vertex_count: usize,
        face_start: Vec<u32>,
        face_vertices: Vec<u32>,
    ) -> Result<Self, TopologyError> {
        let topology = Self::from_faces(vertex_count, face_start, face_vertices)?;
        topology.check_sphere()?;
        Ok(topology)
    }

    /// Builds any number of closed surfaces with any handles. Face `f` has the vertices
    /// `face_vertices[face_start[f]..face_start[f + 1]]`. Vertices that belong to no face have no neighbours.
    ///
    /// # Errors
    /// [`TopologyError::NoFaces`] if there are no faces. Otherwise the defect, if a face is invalid, an edge does
    /// not have two faces of opposite directions, or the faces around a vertex form several fans.
    pub fn from_faces(
        vertex_count: usize,
        mut face_start: Vec<u32>,
        mut face_vertices: Vec<u32>,
    ) -> Result<Self, TopologyError> {
        check_faces(vertex_count, &face_start, &face_vertices)?;
        face_start.shrink_to_fit();
        face_vertices.shrink_to_fit();
        let (links, vertex_start) = Links::new(vertex_count, &face_start, &face_vertices)?;
        let target = |&h: &u32| links.half_edges[links.half_edges[h as usize].twin as usize].origin;
        Ok(Self {
            neighbours: links.outgoing.iter().map(target).collect(),
            origins: face_vertices,
            face_start,
            vertex_start,
            links: links.into(),
        })
    }

    /// Builds a segment (2 vertices) or a point (1 vertex).
    pub fn without_faces(vertex_count: usize) -> Self {
        debug_assert!(
            vertex_count == 1 || vertex_count == 2,
            "a body without faces has one or two vertices"
        );
        let segment = vertex_count == 2;
        Self {
            origins: Vec::new(),
            face_start: vec![0],
            vertex_start: if segment { vec![0, 1, 2] } else { vec![0, 0] },
            neighbours: if segment { vec![1, 0] } else { Vec::new() },
            links: Links::default().into(),
        }
    }

    /// Drops the links, which the next access rebuilds.
    pub fn drop_links(&mut self) {
        self.links.take();
    }

    /// Returns the links, rebuilt if they were dropped.
    ///
    /// # Panics
    /// Never: the faces were linked when they were checked.
    #[inline]
    fn links(&self) -> &Links {
        self.links.get_or_init(|| {
            let again = Links::new(self.vertex_count(), &self.face_start, &self.origins);
            again.expect("these faces were linked before").0
        })
    }

    #[inline]
    pub fn vertex_count(&self) -> usize {
        self.vertex_start.len() - 1
    }

    #[inline]
    pub fn face_count(&self) -> usize {
        self.face_start.len() - 1
    }

    #[inline]
    pub fn edge_count(&self) -> usize {
        self.neighbours.len() / 2
    }

    #[inline]
    pub fn half_edge(&self, h: u32) -> HalfEdge {
        self.links().half_edges[h as usize]
    }

    /// Returns all half-edges, ordered by face.
    #[inline]
    pub fn half_edges(&self) -> &[HalfEdge] {
        &self.links().half_edges
    }

    /// Returns the start vertices of all half-edges.
    #[inline]
    pub fn origins(&self) -> &[u32] {
        &self.origins
    }

    /// Returns the start vertex of a half-edge.
    #[inline]
    pub fn origin(&self, h: u32) -> u32 {
        self.origins[h as usize]
    }

    /// Returns the range of the half-edges of a face, in order.
    #[inline]
    pub fn face_half_edges(&self, face: u32) -> std::ops::Range<u32> {
        self.face_start[face as usize]..self.face_start[face as usize + 1]
    }

    /// Returns the vertices of a face, in order.
    #[inline]
    pub fn face_vertices(&self, face: u32) -> impl ExactSizeIterator<Item = u32> + Clone + '_ {
        let range = self.face_half_edges(face);
        self.origins[range.start as usize..range.end as usize].iter().copied()
    }

    /// Returns the next half-edge of the same face.
    #[inline]
    pub fn next(&self, h: u32) -> u32 {
        let range = self.face_half_edges(self.half_edge(h).face);
        if h + 1 == range.end { range.start } else { h + 1 }
    }

    /// Returns the end vertex of a half-edge.
    #[inline]
    pub fn target(&self, h: u32) -> u32 {
        self.origin(self.half_edge(h).twin)
    }

    /// Returns the neighbours of a vertex, clockwise as seen from outside.
    #[inline]
    pub fn neighbours(&self, vertex: u32) -> &[u32] {
        let (start, end) = self.vertex_range(vertex);
        &self.neighbours[start..end]
    }

    /// Returns the half-edges that start at a vertex, in the order of [`Self::neighbours`].
    #[inline]
    pub fn outgoing_half_edges(&self, vertex: u32) -> &[u32] {
        let outgoing = &self.links().outgoing;
        if outgoing.is_empty() {
            return &[];
        }
        let (start, end) = self.vertex_range(vertex);
        &outgoing[start..end]
    }

    /// Returns the number of bytes on the heap.
    pub fn heap_bytes(&self) -> usize {
        4 * (self.origins.capacity()
            + self.face_start.capacity()
            + self.vertex_start.capacity()
            + self.neighbours.capacity())
            + self.links.get().map_or(0, Links::heap_bytes)
    }

    #[inline]
    fn vertex_range(&self, vertex: u32) -> (usize, usize) {
        let v = vertex as usize;
        (self.vertex_start[v] as usize, self.vertex_start[v + 1] as usize)
    }

    /// Checks that the surface is one sphere, by its Euler characteristic and its number of components.
    fn check_sphere(&self) -> Result<(), TopologyError> {
        let vertices = self.vertex_start.windows(2).filter(|w| w[0] != w[1]).count();
        let (edges, faces) = (self.edge_count(), self.face_count());
        let euler = vertices as i64 - edges as i64 + faces as i64;
        let shells = self.count_shells();
        if euler == 2 && shells == 1 {
            Ok(())
        } else {
            Err(TopologyError::NotASphere { vertices, edges, faces, euler, shells })
        }
    }

    /// Counts the connected surfaces.
    fn count_shells(&self) -> usize {
        let mut seen = vec![false; self.vertex_count()];
        let mut stack = Vec::new();
        let mut shells = 0;
        for start in self.origins.iter().copied() {
            if std::mem::replace(&mut seen[start as usize], true) {
                continue;
            }
            shells += 1;
            stack.push(start);
            while let Some(v) = stack.pop() {
                for &w in self.neighbours(v) {
                    if !std::mem::replace(&mut seen[w as usize], true) {
                        stack.push(w);
                    }
                }
            }
        }
        shells
    }
}

impl Links {
    /// Links the half-edges of faces. Returns the links and the first entry of each vertex.
    fn new(
        vertex_count: usize,
        face_start: &[u32],
        origins: &[u32],
    ) -> Result<(Self, Vec<u32>), TopologyError> {
        let mut half_edges = Vec::with_capacity(origins.len());
        for (face, bounds) in face_start.windows(2).enumerate() {
            for &origin in &origins[bounds[0] as usize..bounds[1] as usize] {
                half_edges.push(HalfEdge { origin, twin: MISSING, face: face as u32 });
            }
        }
        let mut links = Self { half_edges, outgoing: Vec::new() };
        links.find_twins(vertex_count, face_start)?;
        let vertex_start = links.link_vertices(vertex_count, face_start)?;
        Ok((links, vertex_start))
    }

    /// Returns the next half-edge of the same face.
    #[inline]
    fn next(&self, face_start: &[u32], h: u32) -> u32 {
        let face = self.half_edges[h as usize].face as usize;
        if h + 1 == face_start[face + 1] { face_start[face] } else { h + 1 }
    }

    /// Finds the twins: groups edges by their smaller vertex, then sorts each group by the larger vertex.
    fn find_twins(&mut self, vertex_count: usize, face_start: &[u32]) -> Result<(), TopologyError> {
        let origin = |h: u32| self.half_edges[h as usize].origin;
        let ends: Vec<(u32, u32)> = (0..self.half_edges.len() as u32)
            .map(|h| {
                let (u, v) = (origin(h), origin(self.next(face_start, h)));
                (u.min(v), u.max(v))
            })
            .collect();
        let (start, mut order) = group_by_key(vertex_count, ends.iter().map(|e| e.0));
        for v in 0..vertex_count {
            let run = &mut order[start[v] as usize..start[v + 1] as usize];
            run.sort_unstable_by_key(|&h| ends[h as usize].1);
            for group in run.chunk_by(|&g, &h| ends[g as usize].1 == ends[h as usize].1) {
                self.set_twins(group, ends[group[0] as usize])?;
            }
        }
        Ok(())
    }

    /// Sets the twins of the half-edges of one edge, if there are two of opposite directions.
    fn set_twins(&mut self, group: &[u32], (from, to): (u32, u32)) -> Result<(), TopologyError> {
        let at = |h: u32| self.half_edges[h as usize];
        match *group {
            [g, h] if at(g).origin != at(h).origin => {
                self.half_edges[g as usize].twin = h;
                self.half_edges[h as usize].twin = g;
                Ok(())
            }
            [h] => {
                let HalfEdge { origin, face, .. } = at(h);
                let end = if origin == from { to } else { from };
                Err(TopologyError::OpenEdge {
                    from: origin as usize,
                    to: end as usize,
                    face: face as usize,
                })
            }
            _ => Err(TopologyError::NonManifoldEdge {
                from: from as usize,
                to: to as usize,
                count: group.len(),
            }),
        }
    }

    /// Orders the half-edges around each vertex and checks that they form one fan. Returns the first entry of
    /// each vertex.
    fn link_vertices(
        &mut self,
        vertex_count: usize,
        face_start: &[u32],
    ) -> Result<Vec<u32>, TopologyError> {
        let origins = self.half_edges.iter().map(|h| h.origin);
        let (start, mut outgoing) = group_by_key(vertex_count, origins);
        let after = |h: u32| self.next(face_start, self.half_edges[h as usize].twin);
        for v in 0..vertex_count {
            let (begin, end) = (start[v] as usize, start[v + 1] as usize);
            if begin == end {
                continue;
            }
            let first = outgoing[begin];
            let mut h = first;
            for slot in &mut outgoing[begin..end] {
                *slot = h;
                h = after(h);
                if h == first {
                    break;
                }
            }
            if after(outgoing[end - 1]) != first {
                return Err(TopologyError::NonManifoldVertex { vertex: v });
            }
        }
        self.outgoing = outgoing;
        Ok(start)
    }

    /// Returns the number of bytes on the heap.
    fn heap_bytes(&self) -> usize {
        self.half_edges.capacity() * size_of::<HalfEdge>() + 4 * self.outgoing.capacity()
    }
}

/// Groups the indices of `keys` by key (counting sort). Returns the first position of each group, and the
/// grouped indices.
pub fn group_by_key(
    key_count: usize,
    keys: impl Iterator<Item = u32> + Clone,
) -> (Vec<u32>, Vec<u32>) {
    let mut start = vec![0_u32; key_count + 1];
    for key in keys.clone() {
        start[key as usize + 1] += 1;
    }
    for k in 0..key_count {
        start[k + 1] += start[k];
    }
    let mut cursor = start.clone();
    let mut order = vec![0_u32; start[key_count] as usize];
    for (index, key) in keys.enumerate() {
        order[cursor[key as usize] as usize] = index as u32;
        cursor[key as usize] += 1;
    }
    (start, order)
}

/// Checks that faces have at least three vertices, all valid and distinct.
fn check_faces(
    vertex_count: usize,
    face_start: &[u32],
    face_vertices: &[u32],
) -> Result<(), TopologyError> {
    if face_start.len() < 2 {
        return Err(TopologyError::NoFaces);
    }
    // The last face that contained each vertex.
    let mut last_face = vec![MISSING; vertex_count];
    for (face, bounds) in face_start.windows(2).enumerate() {
        let vertices = &face_vertices[bounds[0] as usize..bounds[1] as usize];
        if vertices.len() < 3 {
            return Err(TopologyError::DegenerateFace { face, count: vertices.len() });
        }
        for &v in vertices {
            let vertex = v as usize;
            let Some(seen) = last_face.get_mut(vertex) else {
                return Err(TopologyError::UnknownVertex { face, vertex, vertices: vertex_count });
            };
            if std::mem::replace(seen, face as u32) == face as u32 {
                return Err(TopologyError::RepeatedVertex { face, vertex });
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn build_sphere(vertex_count: usize, faces: &[&[u32]]) -> Result<Topology, TopologyError> {
        let mut start = vec![0];
        let mut vertices = Vec::new();
        for face in faces {
            vertices.extend_from_slice(face);
            start.push(vertices.len() as u32);
        }
        Topology::from_sphere_faces(vertex_count, start, vertices)
    }

    const TETRAHEDRON: [&[u32]; 4] = [&[0, 2, 1], &[0, 1, 3], &[1, 2, 3], &[2, 0, 3]];

    #[test]
    fn tetrahedron_is_a_sphere_with_consistent_links() {
        let t = build_sphere(4, &TETRAHEDRON).unwrap();
        assert_eq!((t.vertex_count(), t.edge_count(), t.face_count()), (4, 6, 4));
        for h in 0..12 {
            let twin = t.half_edge(h).twin;
            assert_eq!(t.half_edge(twin).twin, h);
            assert_eq!(t.half_edge(t.next(h)).origin, t.target(h));
        }
        for v in 0..4 {
            assert_eq!(t.neighbours(v).len(), 3);
            for (&w, &h) in t.neighbours(v).iter().zip(t.outgoing_half_edges(v)) {
                assert_eq!((t.half_edge(h).origin, t.target(h)), (v, w));
            }
        }
    }

    #[test]
    fn flat_polygon_has_two_faces() {
        let t = build_sphere(3, &[&[0, 1, 2], &[0, 2, 1]]).unwrap();
        assert_eq!((t.vertex_count(), t.edge_count(), t.face_count()), (3, 3, 2));
    }

    #[test]
    fn invalid_faces_report_their_defect() {
        assert_eq!(build_sphere(4, &[]).unwrap_err(), TopologyError::NoFaces);
        assert_eq!(
            build_sphere(4, &TETRAHEDRON[..3]).unwrap_err(),
            TopologyError::OpenEdge { from: 0, to: 2, face: 0 }
        );
        let mut flipped = TETRAHEDRON;
        flipped[0] = &[0, 1, 2];
        assert!(matches!(
            build_sphere(4, &flipped),
            Err(TopologyError::NonManifoldEdge { count: 2, .. })
        ));
        let mut repeated = TETRAHEDRON;
        repeated[0] = &[0, 2, 2];
        assert_eq!(
            build_sphere(4, &repeated).unwrap_err(),
            TopologyError::RepeatedVertex { face: 0, vertex: 2 }
        );
        let mut unknown = TETRAHEDRON;
        unknown[0] = &[0, 2, 9];
        assert_eq!(
            build_sphere(4, &unknown).unwrap_err(),
            TopologyError::UnknownVertex { face: 0, vertex: 9, vertices: 4 }
        );
        let twice: Vec<Vec<u32>> = TETRAHEDRON
            .iter()
            .map(|f| f.to_vec())
            .chain(TETRAHEDRON.iter().map(|f| f.iter().map(|v| v + 4).collect()))
            .collect();
        let twice: Vec<&[u32]> = twice.iter().map(Vec::as_slice).collect();
        let two = build_sphere(8, &twice).unwrap_err();
        assert!(matches!(two, TopologyError::NotASphere { euler: 4, shells: 2, .. }));
        assert!(two.to_string().contains("is 2 separate shells, not one sphere"), "{two}");
        // A torus of three by three squares: a surface with one hole.
        let ring = |shift: u32| {
            let vertex = move |i: u32, j: u32| shift + 3 * (i % 3) + j % 3;
            (0..9).map(move |k| {
                let (i, j) = (k / 3, k % 3);
                [vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)]
            })
        };
        let rings: Vec<[u32; 4]> = ring(0).chain(ring(9)).collect();
        let faces: Vec<&[u32]> = rings.iter().map(<[u32; 4]>::as_slice).collect();
        let one = build_sphere(9, &faces[..9]).unwrap_err().to_string();
        assert!(one.contains("is one body with a hole through it, not one sphere"), "{one}");
        let both = build_sphere(18, &faces).unwrap_err().to_string();
        assert!(both.contains("is 2 separate shells with 2 holes in all, not"), "{both}");
        // Two tetrahedra that share one vertex.
        let pinched: Vec<Vec<u32>> = TETRAHEDRON
            .iter()
            .map(|f| f.to_vec())
            .chain(TETRAHEDRON.iter().map(|f| f.iter().map(|v| v + 3).collect()))
            .collect();
        let pinched: Vec<&[u32]> = pinched.iter().map(Vec::as_slice).collect();
        assert_eq!(
            build_sphere(7, &pinched).unwrap_err(),
            TopologyError::NonManifoldVertex { vertex: 3 }
        );
    }
}
