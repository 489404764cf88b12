//! Edges of a part that a picture may show, found once for all of its pictures.

use colltrans::Solid;
use colltrans_picture::{SMOOTH_COSINE, edges};
use glam::DVec3;

/// Minimum cosine of the normals of coplanar facets, whose common edge no view shows.
const MIN_COPLANAR_COSINE: f64 = 1.0 - 1e-9;

/// Edges of a solid that are not within a plane.
pub(super) struct Lines(Vec<Line>);

/// An edge.
struct Line {
    /// Vertices of the edge.
    ends: [u32; 2],
    /// The facets on both sides; `None` on a boundary.
    faces: Option<[u32; 2]>,
}

impl Lines {
    /// Finds the edges of a solid.
    pub(super) fn new(solid: &Solid) -> Self {
        let mut all = Vec::new();
        for (ends, faces) in edges(solid.triangles()) {
            // At an edge with more than two facets, these are ordered in pairs.
            for pair in faces.chunks(2) {
                match *pair {
                    [f, g]
                        if facet_normal(solid, f).dot(facet_normal(solid, g))
                            > MIN_COPLANAR_COSINE => {}
                    [f, g] => all.push(Line { ends, faces: Some([f, g]) }),
                    _ => all.push(Line { ends, faces: None }),
                }
            }
        }
        Self(all)
    }

    /// Returns the edges to draw for a view direction: sharp edges, silhouettes and boundaries.
    pub(super) fn visible_lines(&self, solid: &Solid, toward: DVec3) -> Vec<[DVec3; 2]> {
        let drawn = |line: &&Line| {
            let Some(faces) = line.faces else { return true };
            let [m, n] = faces.map(|face| facet_normal(solid, face));
            let [x, y] = [m, n].map(|n| n.dot(toward) > 0.0);
            (x || y) && (n.dot(m) < SMOOTH_COSINE || x != y)
        };
        let corner = |v: u32| solid.vertices()[v as usize];
        self.0.iter().filter(drawn).map(|line| line.ends.map(corner)).collect()
    }
}

/// Returns the unit normal of a triangle; zero for a triangle without area.
fn facet_normal(solid: &Solid, face: u32) -> DVec3 {
    let [a, b, c] = solid.triangles()[face as usize].map(|v| solid.vertices()[v as usize]);
    (b - a).cross(c - a).normalize_or_zero()
}
