//! Triangle soups: triangles without connectivity.

use std::fmt;

use colltrans::{ConvexPolyhedron, MAX_MAGNITUDE, MIN_MAGNITUDE};
use glam::DVec3;

use super::tree::Tree;
use super::triangle::Triangle;

/// Maximum number of triangles: node indices have 32 bits, and a tree has twice as many nodes as triangles.
const MAX_TRIANGLES: usize = 1 << 31;

/// Reason why a [`Soup`] cannot be built.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum SoupError {
    /// There are no triangles.
    Empty,
    /// There are more than 2^31 triangles.
    TooMany {
        /// Number of triangles.
        triangles: usize,
    },
    /// A triangle refers to a vertex that does not exist.
    UnknownVertex {
        /// Index of the triangle.
        triangle: usize,
        /// Index of the vertex.
        vertex: u32,
        /// Number of vertices.
        vertices: usize,
    },
    /// A coordinate is infinite or not a number.
    NotFinite {
        /// Index of the vertex.
        vertex: usize,
    },
    /// A coordinate is nonzero and its magnitude is not between [`MIN_MAGNITUDE`] and [`MAX_MAGNITUDE`].
    OutOfRange {
        /// Index of the vertex.
        vertex: usize,
    },
}

impl fmt::Display for SoupError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => write!(f, "there are no triangles; give at least one"),
            Self::TooMany { triangles } => {
                write!(f, "{triangles} triangles; accepted: at most {MAX_TRIANGLES}")
            }
            Self::UnknownVertex { triangle, vertex, vertices } => {
                write!(
                    f,
                    "triangle {triangle} refers to vertex {vertex}; accepted: below {vertices}"
                )
            }
            Self::NotFinite { vertex } => {
                write!(f, "vertex {vertex} has a coordinate that is not finite")
            }
            Self::OutOfRange { vertex } => write!(
                f,
                "vertex {vertex} has a coordinate out of range; accepted magnitudes: 0, and 2^-200 to 2^200"
            ),
        }
    }
}

impl std::error::Error for SoupError {}

/// Triangles in their own frame with a tree of bounding volumes, for queries by [`Pqp`](super::Pqp).
///
/// Triangles may be degenerate, share vertices or intersect each other. A soup is a *surface* without an
/// interior.
#[derive(Debug, Clone)]
pub struct Soup {
    vertices: Vec<DVec3>,
    /// Triangles in the order of the tree's leaves.
    triangles: Vec<[u32; 3]>,
    tree: Tree,
    reach: f64,
}

impl Soup {
    /// Builds a soup from triples of indices into `vertices` (own frame, any unit), in either orientation, in
    /// `O(n log n)` time.
    ///
    /// # Errors
    /// - [`SoupError::Empty`], [`SoupError::TooMany`]: the number of triangles is out of range.
    /// - [`SoupError::UnknownVertex`]: an index is out of range.
    /// - [`SoupError::NotFinite`], [`SoupError::OutOfRange`]: a coordinate is not accepted by `colltrans`.
    ///
    /// ```
    /// use colltrans::glam::DVec3;
    /// use colltrans_baselines::pqp::{Soup, SoupError};
    ///
    /// let vertices = [DVec3::ZERO, DVec3::X, DVec3::Y];
    /// assert_eq!(Soup::new(&vertices, &[[0, 1, 2]]).map(|soup| soup.triangle_count()), Ok(1));
    /// let wrong = SoupError::UnknownVertex { triangle: 1, vertex: 3, vertices: 3 };
    /// assert_eq!(Soup::new(&vertices, &[[0, 1, 2], [1, 2, 3]]).err(), Some(wrong));
    /// ```
    pub fn new(vertices: &[DVec3], triangles: &[[u32; 3]]) -> Result<Self, SoupError> {
        if triangles.is_empty() {
            return Err(SoupError::Empty);
        }
        if triangles.len() > MAX_TRIANGLES {
            return Err(SoupError::TooMany { triangles: triangles.len() });
        }
        let known = vertices.len();
        for (triangle, corners) in triangles.iter().enumerate() {
            if let Some(&vertex) = corners.iter().find(|v| **v as usize >= known) {
                return Err(SoupError::UnknownVertex { triangle, vertex, vertices: known });
            }
        }
        let in_range = |c: f64| c == 0.0 || (MIN_MAGNITUDE..=MAX_MAGNITUDE).contains(&c.abs());
        for (vertex, v) in vertices.iter().enumerate() {
            if !v.is_finite() {
                return Err(SoupError::NotFinite { vertex });
            }
            if !v.to_array().into_iter().all(in_range) {
                return Err(SoupError::OutOfRange { vertex });
            }
        }
        Ok(Self::build(vertices.to_vec(), triangles))
    }

    /// Triangulates the surface of a convex polyhedron, in its body frame. A flat polygon has one side; a
    /// segment and a point become one degenerate triangle. The polyhedron must have at most 2^30 vertices.
    pub fn of_polyhedron(body: &ConvexPolyhedron) -> Self {
        let last = body.vertices().len() as u32 - 1;
        let faces = match body.dimension() {
            0 | 1 => return Self::build(body.vertices().to_vec(), &[[0, last, last]]),
            2 => 1,
            _ => body.face_count() as u32,
        };
        let mut triangles = Vec::with_capacity(2 * body.vertices().len());
        for face in 0..faces {
            let corners: Vec<u32> = body.face_vertices(face).collect();
            triangulate_by_halving(&corners, &mut triangles);
        }
        Self::build(body.vertices().to_vec(), &triangles)
    }

    /// Builds the tree, and sorts the triangles in its order.
    fn build(vertices: Vec<DVec3>, triangles: &[[u32; 3]]) -> Self {
        let corners = |i: u32| triangles[i as usize].map(|v| vertices[v as usize]);
        let (tree, order) = Tree::build(triangles.len(), corners);
        let squares = (0..triangles.len() as u32).flat_map(corners).map(DVec3::length_squared);
        let reach = squares.fold(0.0, f64::max).sqrt();
        let triangles = order.iter().map(|&i| triangles[i as usize]).collect();
        Self { vertices, triangles, tree, reach }
    }

    /// Returns the number of triangles.
    pub fn triangle_count(&self) -> usize {
        self.triangles.len()
    }

    /// Returns the number of bytes that the soup and its tree occupy.
    pub fn memory_bytes(&self) -> usize {
        size_of::<Self>()
            + self.vertices.capacity() * size_of::<DVec3>()
            + self.triangles.capacity() * size_of::<[u32; 3]>()
            + self.tree.heap_bytes()
    }

    /// Returns a triangle by its index in the tree's order.
    pub(crate) fn triangle(&self, number: u32) -> Triangle {
        self.triangles[number as usize].map(|v| self.vertices[v as usize])
    }

    /// Returns the tree.
    pub(crate) fn tree(&self) -> &Tree {
        &self.tree
    }

    /// Returns the largest distance of a triangle's corner from the origin.
    pub(crate) fn reach(&self) -> f64 {
        self.reach
    }
}

/// Triangulates a convex polygon by halving. In contrast, each triangle of a fan would reach across the
/// polygon, so that volumes of some triangles would not be smaller than that of all.
fn triangulate_by_halving(corners: &[u32], triangles: &mut Vec<[u32; 3]>) {
    if let [first, .., last] = *corners
        && corners.len() > 2
    {
        let middle = corners.len() / 2;
        triangulate_by_halving(&corners[..=middle], triangles);
        triangles.push([first, corners[middle], last]);
        triangulate_by_halving(&corners[middle..], triangles);
    }
}
