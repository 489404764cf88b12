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
    /// A facet at the edge, and the one on the other side; `None` on a boundary.
    faces: (u32, Option<u32>),
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
                    _ => all.push(Line { ends, faces: (pair[0], pair.get(1).copied()) }),
                }
            }
        }
        Self(all)
    }

    /// Returns the edges to draw for a view direction: sharp edges, silhouettes and boundaries.
    pub(super) fn visible_lines(&self, solid: &Solid, toward: DVec3) -> Vec<[DVec3; 2]> {
        self.0.iter().filter_map(|line| line.visible_ends(solid, toward)).collect()
    }
}

/// Edges in the order of their first facets.
#[cfg(feature = "bcf")]
pub(super) struct SortedLines(Vec<Line>);

#[cfg(feature = "bcf")]
impl SortedLines {
    /// Finds the edges of a solid.
    pub(super) fn new(solid: &Solid) -> Self {
        let Lines(mut all) = Lines::new(solid);
        all.sort_by_key(|line| line.faces.0);
        Self(all)
    }

    /// Returns those [visible lines](Lines::visible_lines) whose first facet is in a range.
    pub(super) fn visible_lines_of(
        &self,
        solid: &Solid,
        toward: DVec3,
        facets: &std::ops::Range<usize>,
    ) -> impl Iterator<Item = [DVec3; 2]> {
        let place = |facet: usize| self.0.partition_point(|line| (line.faces.0 as usize) < facet);
        let lines = &self.0[place(facets.start)..place(facets.end)];
        lines.iter().filter_map(move |line| line.visible_ends(solid, toward))
    }
}

impl Line {
    /// Returns the ends of the edge; `None` if it is not drawn for a view direction.
    fn visible_ends(&self, solid: &Solid, toward: DVec3) -> Option<[DVec3; 2]> {
        let (face, other) = self.faces;
        let is_drawn = other.is_none_or(|other| {
            let [m, n] = [face, other].map(|face| facet_normal(solid, face));
            let [x, y] = [m, n].map(|n| n.dot(toward) > 0.0);
            (x || y) && (n.dot(m) < SMOOTH_COSINE || x != y)
        });
        is_drawn.then(|| self.ends.map(|v| solid.vertices()[v as usize]))
    }
}

/// Returns the unit normal of a triangle; zero for a triangle without area.
fn facet_normal(solid: &Solid, face: u32) -> DVec3 {
    let [a, b, c] = solid.triangles()[face as usize].map(|v| solid.vertices()[v as usize]);
    (b - a).cross(c - a).normalize_or_zero()
}
