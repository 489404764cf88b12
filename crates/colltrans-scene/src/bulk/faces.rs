//! The faces of `M0`, the Minkowski difference without translations, with bounds that hold for all translations.
//!
//! The hull of all rounded vertex differences only proposes planes. The least coordinate of `M0` along the normal of
//! each plane is computed from all vertices of both bodies, nearly without rounding.

use glam::DVec3;

use super::entry_guess::EntryGuessTable;
use colltrans_convex::body::ConvexPolyhedron;
use colltrans_convex::setting::{TwoBodies, VertexPair};

/// The plane of a face.
#[derive(Debug, Clone, Copy)]
pub(super) struct Plane {
    /// Inward unit normal, in the world.
    pub(super) normal: DVec3,
    /// Lower bound of `min n.m` over `M0` for this normal.
    pub(super) min_coordinate: f64,
    /// Height of the highest corner of the face above `min_coordinate`, rounded.
    pub(super) thickness: f64,
    /// The lowest corner.
    pub(super) lowest: VertexPair,
}

/// A side of a face: its first corner, and the face beyond it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Side {
    pub(super) corner: u32,
    pub(super) beyond: u32,
}

/// Planes, sides and corners of all faces.
#[derive(Debug)]
pub(super) struct Faces {
    pub(super) planes: Vec<Plane>,
    /// Index of the first side of each face, with one entry past the end.
    starts: Vec<u32>,
    /// Sides of all faces. They are clockwise as seen from outside. Therefore they are counter-clockwise in lateral
    /// coordinates of a right-handed frame whose third axis is a direction that enters the face.
    sides: Vec<Side>,
    pub(super) points: Vec<DVec3>,
    /// Maximum reduction of the distance of the bodies by input points outside their faces.
    pub(super) input_excess: f64,
    pairs: Vec<VertexPair>,
    /// Table of guesses for the start of a walk.
    pub(super) entry_guess: EntryGuessTable,
}

impl Faces {
    /// Computes the faces. Returns `None` if `M0` is flat or out of range.
    pub(super) fn new(bodies: &TwoBodies) -> Option<Self> {
        let turned = |body: &ConvexPolyhedron, by| -> Vec<DVec3> {
            body.vertices().iter().map(|v| by * *v).collect()
        };
        let p = turned(bodies.moving, bodies.moving_matrix);
        let q = turned(bodies.fixed, bodies.fixed_matrix);
        let differences: Vec<DVec3> =
            q.iter().flat_map(|q| p.iter().map(move |p| *q - *p)).collect();
        let hull =
            ConvexPolyhedron::from_points(&differences).ok().filter(|h| h.dimension() == 3)?;
        let pair = |input: usize| {
            VertexPair::from_indices((input % p.len()) as u32, (input / p.len()) as u32)
        };
        let pairs: Vec<_> = hull.input_indices().iter().map(|i| pair(i.index())).collect();
        let half_edges = hull.half_edges();
        let (mut planes, mut starts, mut sides) = (Vec::new(), vec![0], Vec::new());
        for face in 0..hull.face_count() as u32 {
            let backwards = hull.face_half_edges(face).rev().map(|h| half_edges[h as usize].twin);
            sides.extend(backwards.map(|twin| {
                let twin = half_edges[twin as usize];
                Side { corner: twin.origin, beyond: twin.face }
            }));
            starts.push(sides.len() as u32);
            let normal = -hull.face_normal(face);
            let height = |corner: &u32| normal.dot(hull.vertices()[*corner as usize]);
            let lowest = hull.face_vertices(face).min_by(|a, b| height(a).total_cmp(&height(b)))?;
            let heights = hull.face_vertices(face).map(|corner| height(&corner));
            let min_coordinate = bodies.distance_along(normal);
            let thickness = heights.fold(f64::NEG_INFINITY, f64::max) - min_coordinate;
            planes.push(Plane {
                normal,
                min_coordinate,
                thickness,
                lowest: pairs[lowest as usize],
            });
        }
        let entry_guess = EntryGuessTable::new(&hull, &planes);
        let (points, input_excess) = (hull.vertices().to_vec(), bodies.input_excess());
        Some(Self { planes, starts, sides, points, input_excess, pairs, entry_guess })
    }

    /// Returns the sides of a face.
    #[inline]
    pub(super) fn sides(&self, face: u32) -> &[Side] {
        let [start, end] = [face, face + 1].map(|face| self.starts[face as usize] as usize);
        &self.sides[start..end]
    }

    /// Returns the plane of a face.
    #[inline]
    pub(super) fn plane(&self, face: u32) -> &Plane {
        &self.planes[face as usize]
    }

    /// Returns the vertex pair at the start of a side.
    #[inline]
    pub(super) fn pair_at_side(&self, face: u32, side: usize) -> VertexPair {
        self.pairs[self.sides(face)[side].corner as usize]
    }
}
