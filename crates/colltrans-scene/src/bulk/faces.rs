//! The faces of `M0`, with what each proves wherever the frames are.
//!
//! The hull of all rounded differences of vertices only proposes. Of each face's plane it is computed from all
//! vertices of both bodies, nearly without rounding, how low `M0` reaches along its normal.

use glam::DVec3;

use super::star::Star;
use colltrans_convex::body::ConvexPolyhedron;
use colltrans_convex::setting::{TwoBodies, VertexPair};

/// The plane of a face.
#[derive(Debug, Clone, Copy)]
pub(super) struct Plane {
    /// Its unit normal, inwards, in the world.
    pub(super) normal: DVec3,
    /// At most `min n.m` over `M0`, for this very normal.
    pub(super) least: f64,
    /// How far above that the highest corner of the face is, up to rounding.
    pub(super) thick: f64,
    /// The lowest corner.
    pub(super) lowest: VertexPair,
}

/// A side of a face: where it begins, and the face beyond.
#[derive(Debug, Clone, Copy)]
pub(super) struct Side {
    pub(super) corner: u32,
    pub(super) beyond: u32,
}

/// Planes, sides and corners.
#[derive(Debug)]
pub(super) struct Faces {
    pub(super) planes: Vec<Plane>,
    /// First side of each face, and one entry past the end.
    starts: Vec<u32>,
    /// Face by face, clockwise from outside: counter-clockwise to who looks along a direction that enters it.
    sides: Vec<Side>,
    pub(super) points: Vec<DVec3>,
    /// How much nearer to each other points of both inputs may be than the bodies are.
    pub(super) input_excess: f64,
    pairs: Vec<VertexPair>,
    /// Where to begin.
    pub(super) star: Star,
}

impl Faces {
    /// `None` if `M0` is flat, or beyond the range of coordinates.
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
        let pair =
            |input: usize| VertexPair::of((input % p.len()) as u32, (input / p.len()) as u32);
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
            let least = bodies.distance_along(normal);
            let thick = heights.fold(f64::NEG_INFINITY, f64::max) - least;
            planes.push(Plane { normal, least, thick, lowest: pairs[lowest as usize] });
        }
        let star = Star::new(&hull, &planes);
        let (points, input_excess) = (hull.vertices().to_vec(), bodies.input_excess());
        Some(Self { planes, starts, sides, points, input_excess, pairs, star })
    }

    #[inline]
    pub(super) fn sides(&self, face: u32) -> &[Side] {
        let [start, end] = [face, face + 1].map(|face| self.starts[face as usize] as usize);
        &self.sides[start..end]
    }

    #[inline]
    pub(super) fn plane(&self, face: u32) -> &Plane {
        &self.planes[face as usize]
    }

    #[inline]
    pub(super) fn pair(&self, face: u32, side: usize) -> VertexPair {
        self.pairs[self.sides(face)[side].corner as usize]
    }
}
