//! Vertices, edges and faces, and which of them lies in a supporting plane.

use glam::DVec3;

use super::{ConvexPolyhedron, FaceId, InputVertex};

/// A vertex, an edge or a face of a body, as an answer names it: **by the numbers of the input**, that
/// is, of the points or mesh vertices that the body was made from, for bodies of either kind.
///
/// Of vertices with the same coordinates the first one counts. An edge of a
/// `Solid` runs from corner to corner, however finely its mesh divides it, and a face
/// is the whole polygon that its coplanar facets make up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum Feature {
    /// A vertex.
    Vertex(InputVertex),
    /// An edge, by its two ends.
    Edge([InputVertex; 2]),
    /// A face: of a `Solid` the least number of the input's facets that it is made of,
    /// of a [`ConvexPolyhedron`], whose faces are those of a hull, that of
    /// [`ConvexPolyhedron::face_vertices`].
    Face(FaceId),
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
}

/// The vertex, edge or face of each body that lies in the contact plane, to within rounding error.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Features {
    /// Of the moving body.
    pub moving: Feature,
    /// Of the fixed body.
    pub fixed: Feature,
}

/// A feature of a convex body by its own numbers.
#[derive(Debug, Clone, Copy)]
pub(crate) enum OwnFeature {
    Vertex(u32),
    Edge([u32; 2]),
    Face(u32),
}

impl OwnFeature {
    /// By the numbers of the input.
    pub(crate) fn named(self, body: &ConvexPolyhedron) -> Feature {
        let input = |v: u32| body.input_indices()[v as usize];
        match self {
            Self::Vertex(v) => Feature::Vertex(input(v)),
            Self::Edge(ends) => Feature::Edge(ends.map(input)),
            Self::Face(face) => Feature::Face(FaceId(face)),
        }
    }
}

/// The vertex, edge or face of a body in its supporting plane along the unit vector `outward` (body
/// frame).
#[inline]
pub(crate) fn feature(
    body: &ConvexPolyhedron,
    outward: DVec3,
    vertex: u32,
    noise: f64,
) -> OwnFeature {
    let vertices = body.vertices();
    let height = outward.dot(vertices[vertex as usize]);
    let slack = noise + body.hull_error();
    let in_plane = |w: u32| outward.dot(vertices[w as usize]) >= height - slack;
    let topology = body.topology();
    let neighbours = topology.neighbours(vertex);
    let (first, count) = body.plane_candidates(vertex, outward);
    let wrapped = |i: usize| if i >= neighbours.len() { i - neighbours.len() } else { i };
    // Bit `k`: whether the candidate `k` is in the plane. Without branches: none is predictable.
    let (mut in_plane_mask, mut bit) = (0_u32, 0);
    let (before, from_first) = neighbours.split_at(first);
    for part in [from_first, before] {
        for &w in part.iter().take(count - bit) {
            in_plane_mask |= u32::from(in_plane(w)) << bit;
            bit += 1;
        }
    }
    if in_plane_mask == 0 {
        return OwnFeature::Vertex(vertex);
    }
    let outgoing = topology.outgoing(vertex);
    let is_closed = count == neighbours.len() && count > 1;
    let paired = in_plane_mask
        & ((in_plane_mask >> 1) | ((u32::from(is_closed) * (in_plane_mask & 1)) << (count - 1)));
    let mut paired_left = if outgoing.is_empty() { 0 } else { paired };
    while paired_left != 0 {
        // The face between a neighbour and the next one is on the left of the half-edge to the next.
        let next = wrapped(wrapped(first + paired_left.trailing_zeros() as usize) + 1);
        let face = topology.half_edge(outgoing[next]).face;
        // Of the two faces of a flat polygon, the one that looks there.
        let is_facing = body.dimension() == 3 || body.face_normal(face).dot(outward) >= 0.0;
        // A face that is flat only nearly may have corners above the plane, too.
        let near_plane = |w: u32| (outward.dot(vertices[w as usize]) - height).abs() <= slack;
        if is_facing && holds_for_samples(topology.face_vertices(face), near_plane) {
            return OwnFeature::Face(face);
        }
        paired_left &= paired_left - 1;
    }
    OwnFeature::Edge([vertex, neighbours[wrapped(first + in_plane_mask.trailing_zeros() as usize)]])
}

/// Whether something holds for up to [`SAMPLES`] vertices, spread over a face: those near a vertex
/// may lie in a plane that the others do not.
fn holds_for_samples(
    mut vertices: impl ExactSizeIterator<Item = u32>,
    holds: impl FnMut(u32) -> bool,
) -> bool {
    if vertices.len() <= MAX_SAMPLES {
        return vertices.all(holds);
    }
    let stride = vertices.len().div_ceil(MAX_SAMPLES);
    vertices.step_by(stride).all(holds)
}

/// How many vertices of a face must lie in the contact plane for the face to do.
const MAX_SAMPLES: usize = 16;
