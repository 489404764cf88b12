//! Triangle soups: triangles without structure.

use std::fmt;

use colltrans::{ConvexPolyhedron, MAX_MAGNITUDE, MIN_MAGNITUDE};
use glam::DVec3;

use super::tree::Tree;
use super::triangle::Triangle;

/// Node numbers are 32 bits: a tree has twice as many nodes as triangles.
const MAX_TRIANGLES: usize = 1 << 31;

/// Why no [`Soup`] could be built.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum SoupError {
    /// There is no triangle.
    Empty,
    /// There are more than 2^31 triangles.
    TooMany {
        /// How many.
        triangles: usize,
    },
    /// A triangle names a vertex that does not exist.
    UnknownVertex {
        /// The triangle.
        triangle: usize,
        /// What it names.
        vertex: u32,
        /// How many vertices there are.
        vertices: usize,
    },
    /// A coordinate is infinite or not a number.
    NotFinite {
        /// The vertex.
        vertex: usize,
    },
    /// A coordinate is not 0 and its magnitude is not between [`MIN_MAGNITUDE`] and
    /// [`MAX_MAGNITUDE`].
    OutOfRange {
        /// The vertex.
        vertex: usize,
    },
}

impl fmt::Display for SoupError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => write!(f, "there is no triangle"),
            Self::TooMany { triangles } => {
                write!(f, "{triangles} triangles, more than {MAX_TRIANGLES}")
            }
            Self::UnknownVertex { triangle, vertex, vertices } => {
                write!(f, "triangle {triangle} names vertex {vertex} of {vertices}")
            }
            Self::NotFinite { vertex } => write!(f, "vertex {vertex} is not finite"),
            Self::OutOfRange { vertex } => write!(
                f,
                "a coordinate of vertex {vertex} is not 0 and not between 2^-200 and 2^200"
            ),
        }
    }
}

impl std::error::Error for SoupError {}

/// Triangles in their own frame, with a tree of bounding volumes; built once, queried by
/// [`Pqp`](super::Pqp).
///
/// Triangles may be degenerate, share vertices or intersect each other. A soup is a *surface*: it
/// has no inside.
#[derive(Debug, Clone)]
pub struct Soup {
    vertices: Vec<DVec3>,
    /// In the order of the tree's leaves.
    triangles: Vec<[u32; 3]>,
    tree: Tree,
    reach: f64,
}

impl Soup {
    /// Triangles as triples of indices into `vertices` (own frame, any unit), in either
    /// orientation. Takes `O(n log n)` time.
    ///
    /// # Errors
    /// No triangles or more than 2^31, an index that is out of range, a coordinate that is not
    /// finite or out of the range of `colltrans`.
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

    /// The surface of a convex polyhedron, in its body frame: its faces cut into triangles. A flat
    /// polygon is taken once; a segment and a point are one degenerate triangle.
    ///
    /// The polyhedron must have at most 2^30 vertices.
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
            cut(&corners, &mut triangles);
        }
        Self::build(body.vertices().to_vec(), &triangles)
    }

    fn build(vertices: Vec<DVec3>, triangles: &[[u32; 3]]) -> Self {
        let corners = |i: u32| triangles[i as usize].map(|v| vertices[v as usize]);
        let (tree, order) = Tree::build(triangles.len(), corners);
        let squares = (0..triangles.len() as u32).flat_map(corners).map(DVec3::length_squared);
        let reach = squares.fold(0.0, f64::max).sqrt();
        let triangles = order.iter().map(|&i| triangles[i as usize]).collect();
        Self { vertices, triangles, tree, reach }
    }

    /// Number of triangles.
    pub fn triangle_count(&self) -> usize {
        self.triangles.len()
    }

    /// Bytes of memory that the soup and its tree occupy.
    pub fn memory_bytes(&self) -> usize {
        size_of::<Self>()
            + self.vertices.capacity() * size_of::<DVec3>()
            + self.triangles.capacity() * size_of::<[u32; 3]>()
            + self.tree.heap_bytes()
    }

    /// A triangle by the number that the tree gives it.
    pub(crate) fn triangle(&self, number: u32) -> Triangle {
        self.triangles[number as usize].map(|v| self.vertices[v as usize])
    }

    pub(crate) fn tree(&self) -> &Tree {
        &self.tree
    }

    /// The largest distance of a triangle's corner from the origin.
    pub(crate) fn reach(&self) -> f64 {
        self.reach
    }
}

/// Cuts a convex polygon into triangles by halving it: in a fan every triangle reaches across the
/// polygon, so that no volume around some of them is smaller than that around all.
fn cut(corners: &[u32], triangles: &mut Vec<[u32; 3]>) {
    if let [first, .., last] = *corners
        && corners.len() > 2
    {
        let middle = corners.len() / 2;
        cut(&corners[..=middle], triangles);
        triangles.push([first, corners[middle], last]);
        cut(&corners[middle..], triangles);
    }
}
