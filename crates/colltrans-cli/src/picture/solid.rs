//! A placed body, and how a convex one is drawn.
//!
//! A face of a convex body is hidden exactly if it looks away from the viewer. Therefore no two visible faces overlap on
//! the page. An edge between a visible and a hidden face belongs to the silhouette.

use colltrans::glam::{DVec2, DVec3};
use colltrans::{Aabb, ConvexPolyhedron, Feature, Pose};
use colltrans_mesh::body::drawn_body;
use colltrans_picture::{
    EDGE_WIDTH, FINE_WIDTH, GUIDE_WIDTH, HAIR_WIDTH, MARK_WIDTH, OUTLINE_WIDTH, Page, Paint,
    SHADES, SMOOTH_COSINE, Stroke, View,
};

/// A placed body, relative to the origin of the picture.
#[derive(Debug, Clone)]
pub(super) struct Solid {
    pub(super) vertices: Vec<DVec3>,
    pub(super) faces: Vec<Vec<u32>>,
    /// Outward normals of the faces with their areas as lengths.
    pub(super) areas: Vec<DVec3>,
    /// The two vertices and the two faces of each edge; empty for triangle meshes.
    edges: Vec<([u32; 2], [u32; 2])>,
}

/// Maximum number of edges of a body whose hidden edges are drawn.
const MAX_HIDDEN_EDGES: usize = 64;
/// Mean length of edges in pixels above which the smooth edges of a body are drawn.
const MIN_EDGE_LENGTH: f64 = 7.0;

/// A feature of a drawn body, by the numbers of its vertices or of its face.
#[derive(Clone, Copy)]
pub(super) enum Mark {
    Vertex(u32),
    Edge([u32; 2]),
    Face(u32),
}

impl Mark {
    /// Returns the mark of a feature of a convex body.
    pub(super) fn from_feature(feature: Feature, body: &ConvexPolyhedron) -> Self {
        match (feature, &feature.vertex_positions(body)[..]) {
            (Feature::Face(face), _) => Self::Face(face.0),
            (Feature::Edge(_), &[a, b]) => Self::Edge([a.0, b.0]),
            (_, vertices) => Self::Vertex(vertices[0].0),
        }
    }
}

impl Solid {
    /// Returns a convex body at a pose, relative to `origin`.
    pub(super) fn new(body: &ConvexPolyhedron, pose: &Pose, origin: DVec3) -> Self {
        let body = &*drawn_body(body);
        // The translations are subtracted first, because their difference is exact for near bodies.
        let offset = pose.translation() - origin;
        let vertices: Vec<DVec3> =
            body.vertices().iter().map(|&v| pose.matrix() * v + offset).collect();
        let faces: Vec<Vec<u32>> =
            (0..body.face_count() as u32).map(|f| body.face_vertices(f).collect()).collect();
        let areas = faces.iter().map(|face| vector_area(&vertices, face)).collect();
        let edges = if faces.is_empty() { Vec::new() } else { edges_of_faces(&faces) };
        Self { vertices, faces, areas, edges }
    }

    /// Returns a body of triangles with outward normals, without edges.
    pub(super) fn from_triangles(vertices: Vec<DVec3>, triangles: &[[u32; 3]]) -> Self {
        let faces: Vec<Vec<u32>> = triangles.iter().map(|t| t.to_vec()).collect();
        let areas = faces.iter().map(|face| vector_area(&vertices, face)).collect();
        Self { vertices, faces, areas, edges: Vec::new() }
    }

    /// Returns the body translated by a vector.
    pub(super) fn translated(&self, by: DVec3) -> Self {
        let vertices = self.vertices.iter().map(|&v| v + by).collect();
        Self { vertices, ..self.clone() }
    }

    /// Returns the center of the bounding box, and half of its diagonal.
    pub(super) fn bounding_sphere(&self) -> (DVec3, f64) {
        let bounds = Aabb::from_points(self.vertices.iter().copied());
        (bounds.center(), 0.5 * bounds.side_lengths().length())
    }

    /// Returns the mean of the vertices that are farthest along `n`, to within a share of the body's size.
    pub(super) fn support_center(&self, n: DVec3) -> DVec3 {
        let height = |v: &DVec3| v.dot(n);
        let top = self.vertices.iter().map(height).fold(f64::NEG_INFINITY, f64::max);
        let slack = 1e-9 * self.bounding_sphere().1;
        let at_top: Vec<DVec3> =
            self.vertices.iter().copied().filter(|v| height(v) >= top - slack).collect();
        at_top.iter().sum::<DVec3>() / at_top.len() as f64
    }

    /// Draws the opaque body: faces, visible edges, silhouette, and hidden edges if there are few.
    pub(super) fn draw(
        &self,
        page: &mut Page,
        view: &View,
        paint: &Paint,
        on_page: impl Fn(DVec3) -> DVec2,
    ) {
        let points: Vec<DVec2> = self.vertices.iter().map(|&v| on_page(v)).collect();
        if Self::draw_point_or_segment(page, paint, &points) {
            return;
        }
        let front: Vec<bool> = self.areas.iter().map(|a| a.dot(view.toward) > 0.0).collect();
        self.fill_faces(page, view, paint, &points, &front);
        self.draw_edges(page, paint, &points, &front);
    }

    /// Draws a point or a segment. Returns `false` for other bodies.
    fn draw_point_or_segment(page: &mut Page, paint: &Paint, points: &[DVec2]) -> bool {
        match *points {
            [point] => page.dot(point, 4.0, paint.line, "#ffffff"),
            [a, b] => page.haloed(Stroke::solid(paint.line, 3.0), [a, b]),
            _ => return false,
        }
        true
    }

    /// Fills the visible faces by their shades.
    fn fill_faces(
        &self,
        page: &mut Page,
        view: &View,
        paint: &Paint,
        points: &[DVec2],
        front: &[bool],
    ) {
        let mut by_shade: Vec<Vec<Vec<DVec2>>> = vec![Vec::new(); SHADES + 1];
        for (face, corners) in self.faces.iter().enumerate().filter(|(f, _)| front[*f]) {
            let lit = view.brightness(self.areas[face].normalize_or_zero());
            let shade = (lit * SHADES as f64).round() as usize;
            by_shade[shade].push(corners.iter().map(|&v| points[v as usize]).collect());
        }
        for (shade, polygons) in by_shade.into_iter().enumerate() {
            let colour = paint.shade(shade);
            // The thin stroke closes the seams of anti-aliasing between faces.
            let style = format!(r#"fill="{colour}" stroke="{colour}" stroke-width="0.7""#);
            page.polygons(&style, polygons);
        }
    }

    /// Draws the edges of an opaque body.
    fn draw_edges(&self, page: &mut Page, paint: &Paint, points: &[DVec2], front: &[bool]) {
        let ends = |[a, b]: [u32; 2]| [points[a as usize], points[b as usize]];
        let is_visible = |f: u32| front[f as usize];
        let length = |edge: [u32; 2]| ends(edge)[0].distance(ends(edge)[1]);
        let mean = self.edges.iter().map(|e| length(e.0)).sum::<f64>() / self.edges.len() as f64;
        let (mut outline, mut sharp, mut smooth, mut hidden) = (vec![], vec![], vec![], vec![]);
        for &(edge, [f, g]) in &self.edges {
            let list = match (is_visible(f), is_visible(g)) {
                (true, true) if self.is_sharp(f, g) => &mut sharp,
                (true, true) => &mut smooth,
                (false, false) => &mut hidden,
                _ => &mut outline,
            };
            list.push(ends(edge));
        }
        if self.edges.len() <= MAX_HIDDEN_EDGES {
            page.segments(Stroke::dashed(paint.fine, FINE_WIDTH, "2.5 3"), hidden);
        }
        if mean > MIN_EDGE_LENGTH {
            page.segments(Stroke::solid(paint.fine, HAIR_WIDTH), smooth);
        }
        if mean > 0.5 * MIN_EDGE_LENGTH {
            page.segments(Stroke::solid(paint.line, EDGE_WIDTH), sharp);
        }
        page.segments(Stroke::solid(paint.line, OUTLINE_WIDTH), outline);
    }

    /// Checks whether the normals of two faces differ by more than a smooth edge permits.
    fn is_sharp(&self, f: u32, g: u32) -> bool {
        let normal = |f: u32| self.areas[f as usize].normalize_or_zero();
        normal(f).dot(normal(g)) < SMOOTH_COSINE
    }

    /// Draws the body as a ghost: a translucent outline that hides nothing.
    pub(super) fn draw_ghost(
        &self,
        page: &mut Page,
        view: &View,
        paint: &Paint,
        on_page: impl Fn(DVec3) -> DVec2,
    ) {
        page.open_group(r#"opacity="0.75""#);
        let points: Vec<DVec2> = self.vertices.iter().map(|&v| on_page(v)).collect();
        if !Self::draw_point_or_segment(page, paint, &points) {
            let front: Vec<bool> = self.areas.iter().map(|a| a.dot(view.toward) > 0.0).collect();
            let (outline, inner): (Vec<_>, Vec<_>) = self
                .edges
                .iter()
                .filter(|(_, [f, g])| front[*f as usize] || front[*g as usize])
                .filter(|(_, [f, g])| {
                    front[*f as usize] != front[*g as usize] || self.is_sharp(*f, *g)
                })
                .partition(|(_, [f, g])| front[*f as usize] != front[*g as usize]);
            let shape = convex_outline(&points);
            page.polygons(r##"fill="#dce7f5" fill-opacity="0.55" stroke="none""##, [shape]);
            let ends = |&([a, b], _): &([u32; 2], _)| [points[a as usize], points[b as usize]];
            if self.edges.len() <= 10 * MAX_HIDDEN_EDGES {
                page.segments(Stroke::solid(paint.fine, FINE_WIDTH), inner.iter().map(ends));
            }
            page.segments(Stroke::solid(paint.line, EDGE_WIDTH), outline.iter().map(ends));
        }
        page.close_group();
    }

    /// Marks a feature if it is visible: a vertex, an edge or the boundary of a face. Bodies that are drawn later cover it.
    pub(super) fn mark_visible(
        &self,
        page: &mut Page,
        view: &View,
        feature: Mark,
        colour: &'static str,
        on_page: impl Fn(DVec3) -> DVec2,
    ) {
        if !self.is_in_front(view, feature) {
            return;
        }
        match self.feature_edges(feature, &on_page) {
            lines if lines.is_empty() => {
                page.dot(on_page(self.first_vertex(feature)), 3.4, colour, "#ffffff");
            }
            lines => page.segments(Stroke::solid(colour, MARK_WIDTH), lines),
        }
    }

    /// Marks a feature by dashes, also if it is covered.
    pub(super) fn mark_hidden(
        &self,
        page: &mut Page,
        feature: Mark,
        colour: &'static str,
        on_page: impl Fn(DVec3) -> DVec2,
    ) {
        match self.feature_edges(feature, &on_page) {
            lines if lines.is_empty() => {
                page.dot(on_page(self.first_vertex(feature)), 3.0, "none", colour);
            }
            lines => page.segments(Stroke::dashed(colour, GUIDE_WIDTH, "4 3"), lines),
        }
    }

    /// Returns a vertex of a feature.
    fn first_vertex(&self, feature: Mark) -> DVec3 {
        let vertex = match feature {
            Mark::Vertex(v) | Mark::Edge([v, _]) => v,
            Mark::Face(face) => self.faces[face as usize][0],
        };
        self.vertices[vertex as usize]
    }

    /// Returns the edges of a feature on the page; none for a vertex.
    fn feature_edges(&self, feature: Mark, on_page: impl Fn(DVec3) -> DVec2) -> Vec<[DVec2; 2]> {
        let line = |a: u32, b: u32| [a, b].map(|v| on_page(self.vertices[v as usize]));
        match feature {
            Mark::Vertex(_) => Vec::new(),
            Mark::Edge([a, b]) => vec![line(a, b)],
            Mark::Face(face) => {
                let corners = &self.faces[face as usize];
                corners
                    .iter()
                    .zip(corners.iter().cycle().skip(1))
                    .map(|(&a, &b)| line(a, b))
                    .collect()
            }
        }
    }

    /// Checks whether a face of the feature looks towards the viewer.
    fn is_in_front(&self, view: &View, feature: Mark) -> bool {
        let has = |face: &Vec<u32>| match feature {
            Mark::Vertex(v) => face.contains(&v),
            Mark::Edge(ends) => ends.iter().all(|v| face.contains(v)),
            Mark::Face(_) => false,
        };
        let faces_viewer = |area: &DVec3| area.dot(view.toward) > 0.0;
        match feature {
            Mark::Face(face) => faces_viewer(&self.areas[face as usize]),
            _ if self.faces.is_empty() => true,
            _ => self
                .faces
                .iter()
                .zip(&self.areas)
                .any(|(face, area)| faces_viewer(area) && has(face)),
        }
    }
}

/// Returns the vector area of a face: half of the sum of the cross products along its boundary.
fn vector_area(vertices: &[DVec3], face: &[u32]) -> DVec3 {
    let corner = |i: usize| vertices[face[i] as usize] - vertices[face[0] as usize];
    (1..face.len() - 1).map(|i| 0.5 * corner(i).cross(corner(i + 1))).sum()
}

/// Returns the edges of a closed surface, each with its two vertices and its two faces.
fn edges_of_faces(faces: &[Vec<u32>]) -> Vec<([u32; 2], [u32; 2])> {
    let mut sides = Vec::new();
    for (index, face) in faces.iter().enumerate() {
        for (i, &from) in face.iter().enumerate() {
            let to = face[(i + 1) % face.len()];
            sides.push(([from.min(to), from.max(to)], index as u32));
        }
    }
    sides.sort_unstable();
    // A closed surface has every edge in two faces.
    sides.chunks_exact(2).map(|pair| (pair[0].0, [pair[0].1, pair[1].1])).collect()
}

/// Returns the convex hull of points on the page (monotone chain).
pub(super) fn convex_outline(points: &[DVec2]) -> Vec<DVec2> {
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let chain = |points: &mut dyn Iterator<Item = DVec2>| {
        let mut chain: Vec<DVec2> = Vec::new();
        for p in points {
            while let [.., a, b] = chain[..]
                && (b - a).perp_dot(p - b) <= 0.0
            {
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    let mut outline = chain(&mut sorted.iter().copied());
    outline.extend(chain(&mut sorted.iter().rev().copied()));
    outline
}
