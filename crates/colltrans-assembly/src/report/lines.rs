//! Edges of a part that a drawing may show, found once for all of its pictures.

use colltrans::Solid;
use colltrans_picture::{SMOOTH, edges};
use glam::DVec3;

/// Facets whose normals have a larger cosine lie in one plane: no view shows an edge between them.
const FLAT: f64 = 1.0 - 1e-9;

/// Edges that are not within a plane.
pub(super) struct Lines(Vec<Line>);

struct Line {
    ends: [u32; 2],
    /// The facets at both sides; of a rim none.
    faces: Option<[u32; 2]>,
}

impl Lines {
    pub(super) fn new(solid: &Solid) -> Self {
        let mut all = Vec::new();
        for (ends, faces) in edges(solid.triangles()) {
            // Pairs of facets, in their order, as they meet at an edge that several share.
            for pair in faces.chunks(2) {
                match *pair {
                    [f, g] if normal(solid, f).dot(normal(solid, g)) > FLAT => (),
                    [f, g] => all.push(Line { ends, faces: Some([f, g]) }),
                    _ => all.push(Line { ends, faces: None }),
                }
            }
        }
        Self(all)
    }

    /// Sharp edges, silhouettes and rims.
    pub(super) fn seen(&self, solid: &Solid, toward: DVec3) -> Vec<[DVec3; 2]> {
        let drawn = |line: &&Line| {
            let Some(faces) = line.faces else { return true };
            let [m, n] = faces.map(|face| normal(solid, face));
            let [x, y] = [m, n].map(|n| n.dot(toward) > 0.0);
            (x || y) && (n.dot(m) < SMOOTH || x != y)
        };
        let corner = |v: u32| solid.vertices()[v as usize];
        self.0.iter().filter(drawn).map(|line| line.ends.map(corner)).collect()
    }
}

fn normal(solid: &Solid, face: u32) -> DVec3 {
    let [a, b, c] = solid.triangles()[face as usize].map(|v| solid.vertices()[v as usize]);
    (b - a).cross(c - a).normalize_or_zero()
}
