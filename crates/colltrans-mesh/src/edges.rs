//! Finds the faces that meet at each edge.
//!
//! An edge is a pair of vertices, encoded as one number with the lower vertex in the upper half. A face has one
//! *side* for each edge of its boundary, in one of two directions.

use glam::DVec3;

/// Returns the sides of all faces, sorted by edge. The first number of a side is its edge. The second one is
/// twice the index of the corner at which the side begins, counted over all faces, plus 1 if the side runs from
/// the higher vertex to the lower one.
pub fn sides<F: AsRef<[u32]>>(faces: &[F]) -> Vec<(u64, u64)> {
    let mut sides = Vec::with_capacity(faces.iter().map(|face| face.as_ref().len()).sum());
    let mut corner = 0;
    for face in faces.iter().map(AsRef::as_ref) {
        for (&a, &b) in face.iter().zip(face.iter().cycle().skip(1)) {
            let (low, high) = (a.min(b), a.max(b));
            if a != b {
                let edge = u64::from(low) << 32 | u64::from(high);
                sides.push((edge, corner << 1 | u64::from(a > b)));
            }
            corner += 1;
        }
    }
    sides.sort_unstable();
    sides
}

/// The side of a facet at an edge.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FacetSide {
    pub(crate) edge: u64,
    pub(crate) face: usize,
    /// Whether the side runs from the higher vertex of the edge to the lower one.
    pub(crate) backward: bool,
}

impl FacetSide {
    /// Returns the vertices of the edge, the lower one first.
    pub(crate) fn ends(&self) -> [u32; 2] {
        [(self.edge >> 32) as u32, self.edge as u32]
    }
}

/// Returns the sides of the facets that `counts` selects, sorted by edge ([`sides_by_edge`]).
pub(crate) fn facet_sides(faces: &[Vec<u32>], counts: impl Fn(usize) -> bool) -> Vec<FacetSide> {
    let counted: Vec<usize> = (0..faces.len()).filter(|&k| counts(k)).collect();
    let listed: Vec<&[u32]> = counted.iter().map(|&k| faces[k].as_slice()).collect();
    let owner: Vec<usize> = counted.iter().flat_map(|&k| faces[k].iter().map(move |_| k)).collect();
    let of = |(edge, side): (u64, u64)| FacetSide {
        edge,
        face: owner[(side >> 1) as usize],
        backward: side & 1 == 1,
    };
    sides(&listed).into_iter().map(of).collect()
}

/// Groups sides by their edges.
pub(crate) fn sides_by_edge(facet_sides: &[FacetSide]) -> impl Iterator<Item = &[FacetSide]> {
    facet_sides.chunk_by(|a, b| a.edge == b.edge)
}

/// Checks whether a face has fewer than three different corners, so that it has no area.
pub(crate) fn has_no_area(face: &[u32]) -> bool {
    face.iter().all(|v| *v == face[0] || Some(v) == face.iter().find(|w| **w != face[0]))
}

/// Returns the normal of a facet, with twice its area as length.
pub(crate) fn area_normal(vertices: &[DVec3], face: &[u32]) -> DVec3 {
    let at = |v: u32| vertices[v as usize];
    let [first, rest @ ..] = face else { return DVec3::ZERO };
    rest.windows(2).map(|t| (at(t[0]) - at(*first)).cross(at(t[1]) - at(*first))).sum()
}
