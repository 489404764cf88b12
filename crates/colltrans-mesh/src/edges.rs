//! Which faces meet at which edges.
//!
//! An edge is a pair of vertices, told by one number, the lower vertex above the higher one; each face has a *side* for
//! each edge that it runs along, one way or the other.

use glam::DVec3;

/// The sides of all faces, those of one edge beside each other: the edge, its lower vertex above the
/// higher one, and the corner at which the side begins, counted through all faces, times two, plus one
/// where the side runs from the higher vertex to the lower.
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

/// A facet at an edge.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Use {
    pub(crate) edge: u64,
    pub(crate) face: usize,
    /// From the edge's higher vertex to the lower one.
    pub(crate) backward: bool,
}

impl Use {
    /// The ends of the edge, the lower vertex first.
    pub(crate) fn ends(&self) -> [u32; 2] {
        [(self.edge >> 32) as u32, self.edge as u32]
    }
}

/// The facets that count, by edges; each edge's are beside each other ([`by_edge`]).
pub(crate) fn uses(faces: &[Vec<u32>], counts: impl Fn(usize) -> bool) -> Vec<Use> {
    let counted: Vec<usize> = (0..faces.len()).filter(|&k| counts(k)).collect();
    let listed: Vec<&[u32]> = counted.iter().map(|&k| faces[k].as_slice()).collect();
    let owner: Vec<usize> = counted.iter().flat_map(|&k| faces[k].iter().map(move |_| k)).collect();
    let of = |(edge, side): (u64, u64)| Use {
        edge,
        face: owner[(side >> 1) as usize],
        backward: side & 1 == 1,
    };
    sides(&listed).into_iter().map(of).collect()
}

/// The facets at each edge.
pub(crate) fn by_edge(uses: &[Use]) -> impl Iterator<Item = &[Use]> {
    uses.chunk_by(|a, b| a.edge == b.edge)
}

/// Fewer than three different corners, so that no edge has a facet on either side.
pub(crate) fn is_flat(face: &[u32]) -> bool {
    face.iter().all(|v| *v == face[0] || Some(v) == face.iter().find(|w| **w != face[0]))
}

/// Twice the area of a facet along its normal.
pub(crate) fn normal(vertices: &[DVec3], face: &[u32]) -> DVec3 {
    let at = |v: u32| vertices[v as usize];
    let [first, rest @ ..] = face else { return DVec3::ZERO };
    rest.windows(2).map(|t| (at(t[0]) - at(*first)).cross(at(t[1]) - at(*first))).sum()
}
