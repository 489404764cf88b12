//! A picture of parts that need not be convex.
//!
//! A depth buffer ([`Raster`]) decides which faces and which pieces of edges are visible, to half a pixel. This works
//! for all surfaces in all positions, in time linear in faces and pixels. The drawn edges are outlines (between
//! a face towards the viewer and a face away from the viewer) and creases (the cosine of the angle between their faces
//! is below [`SMOOTH_COSINE`]). If there are few edges, their hidden pieces are dashed.

use std::borrow::Cow;
use std::path::Path;

use colltrans::glam::{DVec2, DVec3};
use colltrans::record::{Ending, FeaturesRecord, SolidClearanceRecord};
use colltrans_picture::{
    EDGE_WIDTH, Edge, FINE_WIDTH, FIXED, MOVING, OUTLINE_WIDTH, Page, Paint, Raster, SHADES,
    SMOOTH_COSINE, Stroke, View, edges,
};

use super::layout::Layout;
use super::notes::Notes;
use super::size::working_size;
use super::solid::Solid;
use super::subject::{Subject, short, translation_text, vector_text};
use super::{PictureBodies, viewpoint};
use crate::solid::{Answer, PartsQuery};

/// Maximum number of edges for which hidden pieces are drawn.
const MAX_HIDDEN_EDGES: usize = 600;
/// Tolerance of depths, relative to the working size.
const DEPTH_SLACK: f64 = 1e-4;
/// Number of the first shade of the moving part; those of the fixed part precede it.
const MOVING_TONES: usize = SHADES + 1;

/// Returns the picture of a clearance of parts as SVG.
pub(crate) fn draw_solids(query: &PartsQuery<'_>, answer: &Answer) -> String {
    let direction = query.direction;
    let subject = clearance_subject(query, answer);
    let surface = |k: usize| query.bodies[k].surface(&query.poses[k], subject.origin);
    let (vertices, triangles) = surface(0);
    let moving = Solid::from_triangles(vertices, &triangles);
    let (vertices, fixed_triangles) = surface(1);
    let fixed = Solid::from_triangles(vertices, &fixed_triangles);
    let bodies = PictureBodies::place(&moving, fixed, direction, &subject);
    draw_with_depths(
        &bodies,
        &subject,
        direction.normalize(),
        [&triangles, &fixed_triangles],
        |_, _| (),
    )
}

/// Returns a picture of bodies of any kind as SVG. `draw_more` draws above the bodies, below the annotations.
pub(super) fn draw_with_depths(
    bodies: &PictureBodies,
    subject: &Subject,
    way: DVec3,
    triangles: [&[[u32; 3]]; 2],
    draw_more: impl FnOnce(&mut Page, &DepthView<'_>),
) -> String {
    let view = viewpoint::best_view([&bodies.stop, &bodies.fixed], way, subject.normal);
    let layout = Layout::compute(bodies, subject, &view);
    let depth_view = DepthView { view: &view, layout: &layout };
    let mut page = Page::new(layout.window);
    page.open_group(r#"clip-path="url(#window)""#);
    let [moving, fixed] = triangles.map(edges);
    depth_view.draw(&mut page, bodies, [&moving, &fixed]);
    draw_more(&mut page, &depth_view);
    page.close_group();
    Notes { bodies, subject, layout: &layout, view: &view }.draw(&mut page, way);
    page.finish(layout.size, layout.window, &subject.headline)
}

/// Returns the content of the picture of a clearance.
fn clearance_subject(query: &PartsQuery<'_>, answer: &Answer) -> Subject {
    let length = query.direction.length();
    let record = &answer.record;
    let mut details = Vec::new();
    let translation = record.translation.map(|t| if t.abs() <= answer.error { 0.0 } else { t });
    let headline = match (record.outcome, translation) {
        (Ending::Blocked, Some(translation)) => {
            details.extend(contact_line(record));
            format!("Blocked at {}", translation_text(translation, length))
        }
        (Ending::Overlapping, _) => {
            details.extend(record.start_overlaps.first().map(|overlap| {
                let least = overlap.least_tolerance.map_or("none".into(), short);
                format!("tolerance that would separate them: {least}")
            }));
            "Overlapping: the parts overlap now".to_owned()
        }
        _ => "Free: nothing stops the body along d".to_owned(),
    };
    let exit = record
        .exit
        .map_or(String::new(), |exit| format!("; exit at {}", translation_text(exit, length)));
    details.push(format!("tolerance {}{exit}", short(record.tolerance.unwrap_or_default())));
    Subject {
        origin: record.point.map_or(query.poses[1].translation(), DVec3::from),
        stop: translation.map_or(0.0, |translation| translation * length),
        normal: record.normal.map_or(DVec3::ZERO, DVec3::from),
        touches: record.point.is_some(),
        marks: None,
        margin: None,
        link: None,
        meets: false,
        is_still: false,
        way: translation.map_or("d".into(), |translation| translation_text(translation, length)),
        headline,
        details,
    }
}

/// Returns a line about the features in contact; `None` without a contact.
fn contact_line(record: &SolidClearanceRecord) -> Option<String> {
    let FeaturesRecord { moving, fixed } = record.features.as_ref()?;
    let normal = vector_text(record.normal?.into());
    let moving = format!("{} of {}", moving.kind, file_name(record.moving.as_deref()?));
    let fixed = format!("{} of {}", fixed.kind, file_name(record.fixed.as_deref()?));
    Some(format!("{moving} touches {fixed}; normal n = {normal}"))
}

/// Returns the name of a file without its folder.
fn file_name(file: &str) -> Cow<'_, str> {
    let path = Path::new(file);
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy()
}

/// The view and the layout of a picture that is drawn with a depth buffer.
pub(super) struct DepthView<'a> {
    pub(super) view: &'a View,
    pub(super) layout: &'a Layout,
}

/// The edges of a body to be drawn, on the page with their depths.
#[derive(Default)]
struct VisibleEdges {
    outline: Vec<[DVec3; 2]>,
    creases: Vec<[DVec3; 2]>,
}

impl DepthView<'_> {
    /// Returns a point on the page, and its depth towards the viewer.
    fn project(&self, p: DVec3) -> DVec3 {
        self.layout.on_page(self.view.project(p)).extend(p.dot(self.view.toward))
    }

    /// Draws the faces, then the edges, then the ghosts.
    fn draw(&self, page: &mut Page, bodies: &PictureBodies, [moving, fixed]: [&[Edge]; 2]) {
        let mut raster = Raster::new(self.layout.window);
        self.rasterise(&mut raster, &bodies.fixed, 0);
        self.rasterise(&mut raster, bodies.solid(), MOVING_TONES);
        for (tone, tiles) in raster.tiles().into_iter().enumerate() {
            let paint = if tone < MOVING_TONES { &FIXED } else { &MOVING };
            let colour = paint.shade(tone % MOVING_TONES);
            // The thin stroke closes the seams of anti-aliasing.
            let style = format!(r#"fill="{colour}" stroke="{colour}" stroke-width="0.7""#);
            page.tiles(&style, &tiles);
        }
        let size = working_size(
            bodies.stop.bounding_sphere().1,
            bodies.fixed.bounding_sphere().1,
            bodies.way.length(),
        );
        let slack = DEPTH_SLACK * size;
        self.draw_edges(page, &raster, (&bodies.fixed, fixed), &FIXED, slack);
        self.draw_edges(page, &raster, (bodies.solid(), moving), &MOVING, slack);
        for ghost in bodies.ghosts() {
            self.draw_ghost(page, &raster, (ghost, moving), slack);
        }
    }

    /// Draws all faces into the depth buffer, with the shade of the side that is visible.
    fn rasterise(&self, raster: &mut Raster, body: &Solid, first_tone: usize) {
        let corners: Vec<DVec3> = body.vertices.iter().map(|&v| self.project(v)).collect();
        for (face, &area) in body.faces.iter().zip(&body.areas) {
            let normal = area.normalize_or_zero();
            let facing = normal * normal.dot(self.view.toward).signum();
            let lit = self.view.brightness(facing);
            let tone = first_tone + (lit * SHADES as f64).round() as usize;
            raster.draw([0, 1, 2].map(|k| corners[face[k] as usize]), tone as u32);
        }
    }

    /// Draws the visible edges of a body, and hidden ones as dashes if there are few.
    fn draw_edges(
        &self,
        page: &mut Page,
        raster: &Raster,
        (body, edges): (&Solid, &[Edge]),
        paint: &Paint,
        slack: f64,
    ) {
        let drawn = self.edges_of(body, edges);
        let split = |edges: &[[DVec3; 2]]| -> [Vec<[DVec2; 2]>; 2] {
            let mut parts = [Vec::new(), Vec::new()];
            for &edge in edges {
                for (all, some) in parts.iter_mut().zip(raster.split(edge, slack)) {
                    all.extend(some);
                }
            }
            parts
        };
        let [creases, hidden] = split(&drawn.creases);
        let [outline, behind] = split(&drawn.outline);
        if drawn.outline.len() + drawn.creases.len() <= MAX_HIDDEN_EDGES {
            let dashes = Stroke::dashed(paint.fine, FINE_WIDTH, "2.5 3");
            page.segments(dashes, hidden.into_iter().chain(behind));
        }
        page.segments(Stroke::solid(paint.line, EDGE_WIDTH), creases);
        page.segments(Stroke::solid(paint.line, OUTLINE_WIDTH), outline);
    }

    /// Draws the moving part at another pose: translucent, and hidden by nearer bodies.
    fn draw_ghost(
        &self,
        page: &mut Page,
        bodies: &Raster,
        (ghost, edges): (&Solid, &[Edge]),
        slack: f64,
    ) {
        let mut own = Raster::new(self.layout.window);
        self.rasterise(&mut own, ghost, 0);
        own.keep_in_front_of(bodies);
        let drawn = self.edges_of(ghost, edges);
        let mut lines = Vec::new();
        for edge in drawn.outline.iter().chain(&drawn.creases) {
            lines.extend(own.split(*edge, slack)[0].iter().copied());
        }
        page.open_group(r#"opacity="0.75""#);
        let tiles: Vec<[usize; 4]> = own.tiles().concat();
        page.tiles(r##"fill="#dce7f5" fill-opacity="0.55" stroke="none""##, &tiles);
        page.segments(Stroke::solid(MOVING.fine, FINE_WIDTH), lines);
        page.close_group();
    }

    /// Returns the outlines and creases of a body.
    fn edges_of(&self, body: &Solid, edges: &[Edge]) -> VisibleEdges {
        let mut drawn = VisibleEdges::default();
        if let ([from, .., to], true) = (&body.vertices[..], body.faces.is_empty()) {
            // The body is a segment.
            drawn.outline.push([*from, *to].map(|p| self.project(p)));
        }
        let normal = |f: u32| body.areas[f as usize].normalize_or_zero();
        let is_front = |f: u32| body.areas[f as usize].dot(self.view.toward) > 0.0;
        for (ends, faces) in edges {
            let is_outline = match faces[..] {
                [f, g] if is_front(f) != is_front(g) => true,
                [f, g] if normal(f).dot(normal(g)) >= SMOOTH_COSINE => continue,
                _ => false,
            };
            let line = ends.map(|v| self.project(body.vertices[v as usize]));
            if is_outline { &mut drawn.outline } else { &mut drawn.creases }.push(line);
        }
        drawn
    }
}
