//! Features of a body (vertices, edges and faces), and the feature that lies in a supporting plane.

use glam::DVec3;

use super::{ConvexPolyhedron, FaceId, InputVertex};

/// A vertex, an edge or a face of a body in an answer. Vertices are given **by input numbers**: the numbers of the
/// points or mesh vertices from which the body was made. This holds for convex bodies and for solids.
///
/// Among vertices with the same coordinates, the first one counts. An edge of a `Solid` runs from corner to corner,
/// even if its mesh subdivides the edge. A face is the whole polygon that its coplanar facets form.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum Feature {
    /// A vertex.
    Vertex(InputVertex),
    /// An edge, given by its two ends.
    Edge([InputVertex; 2]),
    /// A face. For a `Solid` this is the smallest number of an input facet that belongs to the face. For a
    /// [`ConvexPolyhedron`] it is the face of the hull in the numbering of [`ConvexPolyhedron::face_vertices`].
    Face(FaceId),
}

impl Feature {
    /// Returns `"vertex"`, `"edge"` or `"face"`.
    pub fn kind(self) -> &'static str {
        match self {
            Self::Vertex(_) => "vertex",
            Self::Edge(_) => "edge",
            Self::Face(_) => "face",
        }
    }
}

/// The vertex, edge or face of each body that lies in the contact plane, up to rounding error.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Features {
    /// Feature of the moving body.
    pub moving: Feature,
    /// Feature of the fixed body.
    pub fixed: Feature,
}

/// A feature of a convex body, given by the body's own numbers.
#[derive(Debug, Clone, Copy)]
pub(crate) enum OwnFeature {
    Vertex(u32),
    Edge([u32; 2]),
    Face(u32),
}

impl OwnFeature {
    /// Returns the feature with input numbers in place of the body's own vertex numbers.
    pub(crate) fn with_input_numbers(self, body: &ConvexPolyhedron) -> Feature {
        let input = |v: u32| body.input_indices()[v as usize];
        match self {
            Self::Vertex(v) => Feature::Vertex(input(v)),
            Self::Edge(ends) => Feature::Edge(ends.map(input)),
            Self::Face(face) => Feature::Face(FaceId(face)),
        }
    }
}

/// Finds the vertex, edge or face of a body in its supporting plane along `outward`.
///
/// - `outward`: a unit vector in the body frame.
/// - `vertex`: a support point along `outward`.
/// - `noise`: the distance up to which a vertex counts as in the plane, in addition to the hull error.
#[inline]
pub(crate) fn feature_in_plane(
    body: &ConvexPolyhedron,
    outward: DVec3,
    vertex: u32,
    noise: f64,
) -> OwnFeature {
    let (vertices, topology) = (body.vertices(), body.topology());
    let neighbours = topology.neighbours(vertex);
    if neighbours.is_empty() {
        return OwnFeature::Vertex(vertex);
    }
    let height = outward.dot(vertices[vertex as usize]);
    let slack = noise + body.hull_error();
    let in_plane = |w: u32| outward.dot(vertices[w as usize]) >= height - slack;
    let (first, count) = body.plane_candidates(vertex, outward);
    let wrapped = |i: usize| if i >= neighbours.len() { i - neighbours.len() } else { i };
    // Bit `k` is set if candidate `k` is in the plane. The loop is written without branches because the outcomes are
    // unpredictable.
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
    let outgoing = topology.outgoing_half_edges(vertex);
    let is_closed = count == neighbours.len() && count > 1;
    let paired = in_plane_mask
        & ((in_plane_mask >> 1) | ((u32::from(is_closed) * (in_plane_mask & 1)) << (count - 1)));
    let mut paired_left = if outgoing.is_empty() { 0 } else { paired };
    while paired_left != 0 {
        // The face between a neighbour and the next one is to the left of the half-edge to the next one.
        let next = wrapped(wrapped(first + paired_left.trailing_zeros() as usize) + 1);
        let face = topology.half_edge(outgoing[next]).face;
        // Of the two faces of a flat polygon, take the one that faces `outward`.
        let is_facing = body.dimension() == 3 || body.face_normal(face).dot(outward) >= 0.0;
        // A face that is only approximately flat may also have corners above the plane.
        let near_plane = |w: u32| (outward.dot(vertices[w as usize]) - height).abs() <= slack;
        if is_facing && holds_for_samples(topology.face_vertices(face), near_plane) {
            return OwnFeature::Face(face);
        }
        paired_left &= paired_left - 1;
    }
    OwnFeature::Edge([vertex, neighbours[wrapped(first + in_plane_mask.trailing_zeros() as usize)]])
}

/// Checks whether a predicate holds for all tested vertices of a face. At most [`MAX_SAMPLES`] vertices are tested.
/// They are spread over the face, because consecutive vertices may lie in a plane that does not contain the others.
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

/// Maximum number of vertices of a face that are tested for lying in the contact plane.
const MAX_SAMPLES: usize = 16;
