//! Triangle soups and their trees of bounding volumes.
//!
//! A node's triangles are parted at the mean of their centres along the longest axis of their
//! volume (Gottschalk, Lin and Manocha 1996), down to one triangle a leaf; where the mean parts
//! nothing, half of them go either way. Nodes lie in one array, children after their parents.

use std::fmt;

use colltrans::ConvexPolyhedron;
use glam::DVec3;

use super::triangle::Triangle;
use super::volume::Volume;

/// Triangles without any order, with a tree of bounding volumes over them.
#[derive(Debug, Clone)]
pub struct Soup {
    vertices: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    nodes: Vec<Node>,
    /// Largest distance of a vertex from the origin.
    reach: f64,
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Node {
    pub(super) volume: Volume,
    pub(super) content: Content,
}

#[derive(Debug, Clone, Copy)]
pub(super) enum Content {
    /// A triangle.
    Leaf(u32),
    /// Two nodes, the second right after the first.
    Inner(u32),
}

/// Why triangles are no soup.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SoupError {
    /// There are none.
    Empty,
    /// A triangle has a corner that does not exist.
    NoSuchVertex {
        /// The triangle.
        triangle: usize,
        /// The index of its corner.
        vertex: u32,
    },
    /// A vertex is not finite.
    NotFinite {
        /// The vertex.
        vertex: usize,
    },
}

impl fmt::Display for SoupError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => write!(f, "there are no triangles"),
            Self::NoSuchVertex { triangle, vertex } => {
                write!(f, "triangle {triangle} has vertex {vertex}, which does not exist")
            }
            Self::NotFinite { vertex } => write!(f, "vertex {vertex} is not finite"),
        }
    }
}

impl std::error::Error for SoupError {}

impl Soup {
    /// A soup of triangles, by the indices of their corners. Takes `O(n log n)`.
    ///
    /// # Errors
    /// No triangles; a corner that does not exist; coordinates that are not finite.
    pub fn new(vertices: &[DVec3], triangles: &[[u32; 3]]) -> Result<Self, SoupError> {
        if triangles.is_empty() {
            return Err(SoupError::Empty);
        }
        if let Some(vertex) = vertices.iter().position(|v| !v.is_finite()) {
            return Err(SoupError::NotFinite { vertex });
        }
        let unknown =
            |corners: &[u32; 3]| corners.iter().copied().find(|&v| v as usize >= vertices.len());
        for (triangle, corners) in triangles.iter().enumerate() {
            if let Some(vertex) = unknown(corners) {
                return Err(SoupError::NoSuchVertex { triangle, vertex });
            }
        }
        Ok(Self::build(vertices.to_vec(), triangles.to_vec()))
    }

    /// The surface of a body, its faces cut into fans of triangles; a segment or a point is one
    /// degenerate triangle.
    pub fn of_polyhedron(body: &ConvexPolyhedron) -> Self {
        let fan = |face: u32| {
            let corners: Vec<u32> = body.face_vertices(face).collect();
            let apex = corners[0];
            corners[1..].windows(2).map(|w| [apex, w[0], w[1]]).collect::<Vec<_>>()
        };
        let mut triangles: Vec<[u32; 3]> = (0..body.face_count() as u32).flat_map(fan).collect();
        if triangles.is_empty() {
            let last = body.vertices().len() as u32 - 1;
            triangles.push([0, last, last]);
        }
        Self::build(body.vertices().to_vec(), triangles)
    }

    fn build(vertices: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> Self {
        let reach = vertices.iter().map(|v| v.length()).fold(0.0, f64::max);
        let mut soup = Self { vertices, triangles, nodes: Vec::new(), reach };
        let mut order: Vec<u32> = (0..soup.triangles.len() as u32).collect();
        soup.nodes.reserve_exact(2 * order.len() - 1);
        soup.nodes.push(soup.leaf(0));
        // Nodes to be filled, with their part of the order.
        let mut open = vec![(0_usize, 0..order.len())];
        while let Some((node, range)) = open.pop() {
            let part = &mut order[range.clone()];
            let volume = soup.volume(part);
            let content = if part.len() == 1 {
                Content::Leaf(part[0])
            } else {
                let middle = range.start + soup.split(part, volume.axes.x_axis);
                let first = soup.nodes.len();
                let placeholder = soup.nodes[node];
                soup.nodes.extend([placeholder; 2]);
                open.push((first, range.start..middle));
                open.push((first + 1, middle..range.end));
                Content::Inner(first as u32)
            };
            soup.nodes[node] = Node { volume, content };
        }
        soup
    }

    fn leaf(&self, triangle: u32) -> Node {
        Node { volume: self.volume(&[triangle]), content: Content::Leaf(triangle) }
    }

    fn volume(&self, triangles: &[u32]) -> Volume {
        let corners = |&t: &u32| self.triangles[t as usize].map(|v| self.vertices[v as usize]);
        Volume::new(&triangles.iter().flat_map(corners))
    }

    /// Moves the triangles below the mean along an axis to the front, and says how many they are.
    fn split(&self, part: &mut [u32], axis: DVec3) -> usize {
        let place = |t: u32| self.triangle(t).iter().map(|x| axis.dot(*x)).sum::<f64>();
        let mean = part.iter().map(|&t| place(t)).sum::<f64>() / part.len() as f64;
        let mut front = 0;
        for i in 0..part.len() {
            if place(part[i]) < mean {
                part.swap(i, front);
                front += 1;
            }
        }
        if front == 0 || front == part.len() { part.len() / 2 } else { front }
    }

    /// Number of triangles.
    pub fn triangle_count(&self) -> usize {
        self.triangles.len()
    }

    /// Bytes of memory that the soup and its tree occupy, on the heap and in themselves.
    pub fn memory_bytes(&self) -> usize {
        size_of::<Self>()
            + self.vertices.capacity() * size_of::<DVec3>()
            + self.triangles.capacity() * size_of::<[u32; 3]>()
            + self.nodes.capacity() * size_of::<Node>()
    }

    pub(super) fn triangle(&self, index: u32) -> Triangle {
        self.triangles[index as usize].map(|v| self.vertices[v as usize])
    }

    pub(super) fn node(&self, index: u32) -> &Node {
        &self.nodes[index as usize]
    }

    pub(super) fn reach(&self) -> f64 {
        self.reach
    }
}
