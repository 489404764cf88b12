//! A placed body as it is seen: which faces, which edges, in which look.
//!
//! A convex body hides its own parts exactly where a face looks away from the viewer, so no two of
//! its visible faces overlap on the page. An edge between a visible and a hidden face is
//! part of the silhouette.

use colltrans::glam::{DVec2, DVec3};
use colltrans::{Aabb, ConvexPolyhedron, Feature, Pose};
use colltrans_picture::{Page, Paint, SHADES, SMOOTH, Stroke, View};

/// A placed body, relative to a point of the scene.
#[derive(Debug, Clone)]
pub(super) struct Solid {
    pub(super) vertices: Vec<DVec3>,
    pub(super) faces: Vec<Vec<u32>>,
    /// Outward normals as long as the faces' areas.
    pub(super) areas: Vec<DVec3>,
    /// Vertices and the faces on both sides.
    edges: Vec<([u32; 2], [u32; 2])>,
}

/// Hidden edges are drawn for bodies with no more edges than this.
const FEW_EDGES: usize = 64;
/// On smooth surfaces, edges are drawn if they are longer than this on average, in pixels.
const DENSE: f64 = 7.0;

/// A feature by the numbers of the body that is drawn.
#[derive(Clone, Copy)]
pub(super) enum Mark {
    Vertex(u32),
    Edge([u32; 2]),
    Face(u32),
}

impl Mark {
    pub(super) fn of(feature: Feature, body: &ConvexPolyhedron) -> Self {
        match (feature, &feature.own_vertices(body)[..]) {
            (Feature::Face(face), _) => Self::Face(face.0),
            (Feature::Edge(_), &[a, b]) => Self::Edge([a.0, b.0]),
            (_, vertices) => Self::Vertex(vertices[0].0),
        }
    }
}

impl Solid {
    pub(super) fn new(body: &ConvexPolyhedron, pose: &Pose, origin: DVec3) -> Self {
        // The difference of the translations first: it is exact where the bodies are near.
        let offset = pose.translation() - origin;
        let vertices: Vec<DVec3> =
            body.vertices().iter().map(|&v| pose.matrix() * v + offset).collect();
        let faces: Vec<Vec<u32>> =
            (0..body.face_count() as u32).map(|f| body.face_vertices(f).collect()).collect();
        let areas = faces.iter().map(|face| area(&vertices, face)).collect();
        let edges = if faces.is_empty() { Vec::new() } else { edges(&faces) };
        Self { vertices, faces, areas, edges }
    }

    /// Triangles, relative to a point, with outward normals; edges are not looked at.
    pub(super) fn of_triangles(vertices: Vec<DVec3>, triangles: &[[u32; 3]]) -> Self {
        let faces: Vec<Vec<u32>> = triangles.iter().map(|t| t.to_vec()).collect();
        let areas = faces.iter().map(|face| area(&vertices, face)).collect();
        Self { vertices, faces, areas, edges: Vec::new() }
    }

    pub(super) fn moved(&self, by: DVec3) -> Self {
        let vertices = self.vertices.iter().map(|&v| v + by).collect();
        Self { vertices, ..self.clone() }
    }

    /// Centre of the box around the body, and half its diagonal.
    pub(super) fn ball(&self) -> (DVec3, f64) {
        let bounds = Aabb::of_points(self.vertices.iter().copied());
        (bounds.center(), 0.5 * bounds.size().length())
    }

    /// The vertices furthest along `n` (within a part of the body's size) and their mean.
    pub(super) fn support(&self, n: DVec3) -> DVec3 {
        let height = |v: &DVec3| v.dot(n);
        let top = self.vertices.iter().map(height).fold(f64::NEG_INFINITY, f64::max);
        let slack = 1e-9 * self.ball().1;
        let at_top: Vec<DVec3> =
            self.vertices.iter().copied().filter(|v| height(v) >= top - slack).collect();
        at_top.iter().sum::<DVec3>() / at_top.len() as f64
    }

    /// Draws the body opaque: faces, visible edges, silhouette, and hidden edges of simple bodies.
    pub(super) fn draw(
        &self,
        page: &mut Page,
        view: &View,
        paint: &Paint,
        on_page: impl Fn(DVec3) -> DVec2,
    ) {
        let flat: Vec<DVec2> = self.vertices.iter().map(|&v| on_page(v)).collect();
        if Self::draw_low(page, paint, &flat) {
            return;
        }
        let front: Vec<bool> = self.areas.iter().map(|a| a.dot(view.toward) > 0.0).collect();
        self.fill(page, view, paint, &flat, &front);
        self.draw_edges(page, paint, &flat, &front);
    }

    /// A point or a segment; `false` for anything else.
    fn draw_low(page: &mut Page, paint: &Paint, flat: &[DVec2]) -> bool {
        match *flat {
            [point] => page.dot(point, 4.0, paint.line, "#ffffff"),
            [a, b] => page.haloed(Stroke::solid(paint.line, 3.0), [a, b]),
            _ => return false,
        }
        true
    }

    fn fill(&self, page: &mut Page, view: &View, paint: &Paint, flat: &[DVec2], front: &[bool]) {
        let mut by_shade: Vec<Vec<Vec<DVec2>>> = vec![Vec::new(); SHADES + 1];
        for (face, corners) in self.faces.iter().enumerate().filter(|(f, _)| front[*f]) {
            let lit = view.brightness(self.areas[face].normalize_or_zero());
            let shade = (lit * SHADES as f64).round() as usize;
            by_shade[shade].push(corners.iter().map(|&v| flat[v as usize]).collect());
        }
        for (shade, polygons) in by_shade.into_iter().enumerate() {
            let colour = paint.shade(shade);
            // The thin rim closes the seams that anti-aliasing leaves between faces.
            let look = format!(r#"fill="{colour}" stroke="{colour}" stroke-width="0.7""#);
            page.polygons(&look, polygons);
        }
    }

    fn draw_edges(&self, page: &mut Page, paint: &Paint, flat: &[DVec2], front: &[bool]) {
        let ends = |[a, b]: [u32; 2]| [flat[a as usize], flat[b as usize]];
        let is_seen = |f: u32| front[f as usize];
        let length = |edge: [u32; 2]| ends(edge)[0].distance(ends(edge)[1]);
        let mean = self.edges.iter().map(|e| length(e.0)).sum::<f64>() / self.edges.len() as f64;
        let (mut outline, mut sharp, mut smooth, mut hidden) = (vec![], vec![], vec![], vec![]);
        for &(edge, [f, g]) in &self.edges {
            let list = match (is_seen(f), is_seen(g)) {
                (true, true) if self.is_sharp(f, g) => &mut sharp,
                (true, true) => &mut smooth,
                (false, false) => &mut hidden,
                _ => &mut outline,
            };
            list.push(ends(edge));
        }
        if self.edges.len() <= FEW_EDGES {
            page.segments(Stroke::dashed(paint.fine, 0.7, "2.5 3"), hidden);
        }
        if mean > DENSE {
            page.segments(Stroke::solid(paint.fine, 0.45), smooth);
        }
        if mean > 0.5 * DENSE {
            page.segments(Stroke::solid(paint.line, 0.9), sharp);
        }
        page.segments(Stroke::solid(paint.line, 1.6), outline);
    }

    fn is_sharp(&self, f: u32, g: u32) -> bool {
        let normal = |f: u32| self.areas[f as usize].normalize_or_zero();
        normal(f).dot(normal(g)) < SMOOTH
    }

    /// Draws the body as a light outline that hides nothing.
    pub(super) fn draw_ghost(
        &self,
        page: &mut Page,
        view: &View,
        paint: &Paint,
        on_page: impl Fn(DVec3) -> DVec2,
    ) {
        page.open_group(r#"opacity="0.75""#);
        let flat: Vec<DVec2> = self.vertices.iter().map(|&v| on_page(v)).collect();
        if !Self::draw_low(page, paint, &flat) {
            let front: Vec<bool> = self.areas.iter().map(|a| a.dot(view.toward) > 0.0).collect();
            let (outline, inner): (Vec<_>, Vec<_>) = self
                .edges
                .iter()
                .filter(|(_, [f, g])| front[*f as usize] || front[*g as usize])
                .filter(|(_, [f, g])| {
                    front[*f as usize] != front[*g as usize] || self.is_sharp(*f, *g)
                })
                .partition(|(_, [f, g])| front[*f as usize] != front[*g as usize]);
            let shape = convex_outline(&flat);
            page.polygons(r##"fill="#dce7f5" fill-opacity="0.55" stroke="none""##, [shape]);
            let ends = |&([a, b], _): &([u32; 2], _)| [flat[a as usize], flat[b as usize]];
            if self.edges.len() <= 10 * FEW_EDGES {
                page.segments(Stroke::solid(paint.fine, 0.6), inner.iter().map(ends));
            }
            page.segments(Stroke::solid(paint.line, 0.9), outline.iter().map(ends));
        }
        page.close_group();
    }

    /// Marks the visible part of a feature: a vertex, an edge or the rim of a face. Bodies that
    /// are drawn later cover it.
    pub(super) fn mark(
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
        match self.lines(feature, &on_page) {
            lines if lines.is_empty() => {
                page.dot(on_page(self.first_vertex(feature)), 3.4, colour, "#ffffff");
            }
            lines => page.segments(Stroke::solid(colour, 2.2), lines),
        }
    }

    /// Marks all of a feature through whatever covers it.
    pub(super) fn mark_hidden(
        &self,
        page: &mut Page,
        feature: Mark,
        colour: &'static str,
        on_page: impl Fn(DVec3) -> DVec2,
    ) {
        match self.lines(feature, &on_page) {
            lines if lines.is_empty() => {
                page.dot(on_page(self.first_vertex(feature)), 3.0, "none", colour);
            }
            lines => page.segments(Stroke::dashed(colour, 1.1, "4 3"), lines),
        }
    }

    fn first_vertex(&self, feature: Mark) -> DVec3 {
        let vertex = match feature {
            Mark::Vertex(v) | Mark::Edge([v, _]) => v,
            Mark::Face(face) => self.faces[face as usize][0],
        };
        self.vertices[vertex as usize]
    }

    /// The edges of a feature; none of a vertex.
    fn lines(&self, feature: Mark, on_page: impl Fn(DVec3) -> DVec2) -> Vec<[DVec2; 2]> {
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

    /// Whether a face that the feature belongs to looks towards the viewer.
    fn is_in_front(&self, view: &View, feature: Mark) -> bool {
        let has = |face: &Vec<u32>| match feature {
            Mark::Vertex(v) => face.contains(&v),
            Mark::Edge(ends) => ends.iter().all(|v| face.contains(v)),
            Mark::Face(_) => false,
        };
        let looks = |area: &DVec3| area.dot(view.toward) > 0.0;
        match feature {
            Mark::Face(face) => looks(&self.areas[face as usize]),
            _ if self.faces.is_empty() => true,
            _ => self.faces.iter().zip(&self.areas).any(|(face, area)| looks(area) && has(face)),
        }
    }
}

/// The vector area of a face: half the sum of the cross products along its rim.
fn area(vertices: &[DVec3], face: &[u32]) -> DVec3 {
    let corner = |i: usize| vertices[face[i] as usize] - vertices[face[0] as usize];
    (1..face.len() - 1).map(|i| 0.5 * corner(i).cross(corner(i + 1))).sum()
}

fn edges(faces: &[Vec<u32>]) -> Vec<([u32; 2], [u32; 2])> {
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

/// The convex outline of points on the page (monotone chain).
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
