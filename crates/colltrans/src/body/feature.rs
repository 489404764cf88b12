//! Vertices, edges and faces, and which of them lies in a supporting plane.

use glam::DVec3;

use super::ConvexPolyhedron;

/// A vertex, an edge or a face of a [`ConvexPolyhedron`], by its own indices.
///
/// [`ConvexPolyhedron::input_indices`] leads from there to the points or mesh vertices it was made
/// from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Feature {
    /// A vertex.
    Vertex(u32),
    /// An edge, by its two vertices.
    Edge([u32; 2]),
    /// A face; its vertices are [`ConvexPolyhedron::face_vertices`].
    Face(u32),
}

impl Feature {
    /// `"vertex"`, `"edge"` or `"face"`.
    pub fn kind(self) -> &'static str {
        match self {
            Self::Vertex(_) => "vertex",
            Self::Edge(_) => "edge",
            Self::Face(_) => "face",
        }
    }

    /// The vertices of the feature, as indices into [`ConvexPolyhedron::vertices`] of `body`.
    ///
    /// # Panics
    /// If the feature is not one of `body`.
    pub fn vertices(self, body: &ConvexPolyhedron) -> Vec<u32> {
        match self {
            Self::Vertex(v) => vec![v],
            Self::Edge(ends) => ends.to_vec(),
            Self::Face(face) => body.face_vertices(face).collect(),
        }
    }
}

/// The vertex, edge or face of a body in its supporting plane along the unit vector `outward` (body
/// frame).
#[inline]
pub(crate) fn feature(body: &ConvexPolyhedron, outward: DVec3, vertex: u32, noise: f64) -> Feature {
    let vertices = body.vertices();
    let height = outward.dot(vertices[vertex as usize]);
    let slack = noise + body.hull_error();
    let in_plane = |w: u32| outward.dot(vertices[w as usize]) >= height - slack;
    let topology = body.topology();
    let neighbours = topology.neighbours(vertex);
    let (first, count) = body.plane_candidates(vertex, outward);
    let wrapped = |i: usize| if i >= neighbours.len() { i - neighbours.len() } else { i };
    // Bit `k`: whether the candidate `k` is in the plane. Without branches: none is predictable.
    let mut hits = 0_u32;
    for k in 0..count {
        hits |= u32::from(in_plane(neighbours[wrapped(first + k)])) << k;
    }
    if hits == 0 {
        return Feature::Vertex(vertex);
    }
    let outgoing = topology.outgoing(vertex);
    let all_round = count == neighbours.len() && count > 1;
    let followed = hits & ((hits >> 1) | ((u32::from(all_round) * (hits & 1)) << (count - 1)));
    let mut corners = if outgoing.is_empty() { 0 } else { followed };
    while corners != 0 {
        // The face between a neighbour and the next one is on the left of the half-edge to the next.
        let next = wrapped(wrapped(first + corners.trailing_zeros() as usize) + 1);
        let face = topology.half_edge(outgoing[next]).face;
        // Of the two faces of a flat polygon, the one that looks there.
        let looks = body.dimension() == 3 || body.face_normal(face).dot(outward) >= 0.0;
        // A face that is flat only nearly may have corners above the plane, too.
        let near_plane = |w: u32| (outward.dot(vertices[w as usize]) - height).abs() <= slack;
        if looks && spread(topology.face_vertices(face), near_plane) {
            return Feature::Face(face);
        }
        corners &= corners - 1;
    }
    Feature::Edge([vertex, neighbours[wrapped(first + hits.trailing_zeros() as usize)]])
}

/// Whether something holds for up to [`SAMPLES`] vertices, spread over a face: those near a vertex
/// may lie in a plane that the others do not.
fn spread(
    mut vertices: impl ExactSizeIterator<Item = u32>,
    holds: impl FnMut(u32) -> bool,
) -> bool {
    if vertices.len() <= SAMPLES {
        return vertices.all(holds);
    }
    let stride = vertices.len().div_ceil(SAMPLES);
    vertices.step_by(stride).all(holds)
}

/// How many vertices of a face must lie in the contact plane for the face to do.
const SAMPLES: usize = 16;
