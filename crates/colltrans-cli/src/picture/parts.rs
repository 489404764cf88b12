//! A picture of parts that need not be convex.
//!
//! Which faces are seen, and which pieces of which edges, is decided by a buffer of depths
//! ([`Raster`]), to half a pixel: for any surfaces, in any position, in time that grows with
//! faces and pixels. Drawn are outlines (edges between faces that look towards the viewer and away)
//! and creases (edges that bend by more than [`SMOOTH`]), and what of them is hidden as dashes where
//! there are few.

use std::borrow::Cow;
use std::path::Path;

use colltrans::glam::{DVec2, DVec3};
use colltrans::record::{Ending, FeaturesRecord, SolidClearanceRecord};
use colltrans_picture::{
    Edge, FIXED, MOVING, Page, Paint, Raster, SHADES, SMOOTH, Stroke, View, edges,
};

use super::layout::Layout;
use super::notes::Notes;
use super::size::working_size;
use super::solid::Solid;
use super::subject::{Subject, components, quantity, short};
use super::{Cast, viewpoint};
use crate::solid::{Answer, PartsQuery};

/// Hidden edges are drawn if no more edges than this are drawn at all.
const FEW_EDGES: usize = 600;
/// Depths may be off by this part of the size of what is shown.
const SLACK: f64 = 1e-4;
/// Shades of the moving part follow those of the fixed one.
const MOVING_TONES: usize = SHADES + 1;

/// The SVG file of an answer.
pub(crate) fn draw_solids(question: &PartsQuery<'_>, answer: &Answer) -> String {
    let direction = question.direction;
    let subject = subject(question, answer);
    let surface = |k: usize| question.bodies[k].surface(&question.poses[k], subject.origin);
    let (vertices, triangles) = surface(0);
    let moving = Solid::of_triangles(vertices, &triangles);
    let (vertices, fixed_triangles) = surface(1);
    let fixed = Solid::of_triangles(vertices, &fixed_triangles);
    let cast = Cast::placed(&moving, fixed, direction, &subject);
    draw_seen(&cast, &subject, direction.normalize(), [&triangles, &fixed_triangles], |_, _| ())
}

/// Draws bodies of any kind by their triangles, and `more` above them, as an SVG file.
pub(super) fn draw_seen(
    cast: &Cast,
    subject: &Subject,
    way: DVec3,
    triangles: [&[[u32; 3]]; 2],
    more: impl FnOnce(&mut Page, &Eye<'_>),
) -> String {
    let view = viewpoint::choose([&cast.stop, &cast.fixed], way, subject.normal);
    let layout = Layout::of(cast, subject, &view);
    let eye = Eye { view: &view, layout: &layout };
    let mut page = Page::new(layout.window);
    page.open_group(r#"clip-path="url(#window)""#);
    let [moving, fixed] = triangles.map(edges);
    eye.draw(&mut page, cast, [&moving, &fixed]);
    more(&mut page, &eye);
    page.close_group();
    Notes { cast, subject, layout: &layout, view: &view }.draw(&mut page, way);
    page.finish(layout.size, layout.window, &subject.headline)
}

/// What the picture has to tell.
fn subject(question: &PartsQuery<'_>, answer: &Answer) -> Subject {
    let length = question.direction.length();
    let record = &answer.record;
    let mut details = Vec::new();
    let place = record.translation.map(|t| if t.abs() <= answer.error { 0.0 } else { t });
    let headline = match (record.outcome, place) {
        (Ending::Blocked, Some(place)) => {
            details.extend(touching(record));
            format!("Blocked at {}", quantity(place, length))
        }
        (Ending::Overlapping, _) => {
            details.extend(record.start_overlaps.first().map(|overlap| {
                let least = overlap.least_tolerance.map_or("none".into(), short);
                format!("tolerance that would part them: {least}")
            }));
            "Overlapping: the parts overlap now".to_owned()
        }
        _ => "Free: nothing stops it along d".to_owned(),
    };
    let exit =
        record.exit.map_or(String::new(), |exit| format!("; exit at {}", quantity(exit, length)));
    details.push(format!("tolerance {}{exit}", short(record.tolerance.unwrap_or_default())));
    Subject {
        origin: record.point.map_or(question.poses[1].translation(), DVec3::from),
        stop: place.map_or(0.0, |place| place * length),
        normal: record.normal.map_or(DVec3::ZERO, DVec3::from),
        touches: record.point.is_some(),
        marks: None,
        margin: None,
        link: None,
        meets: false,
        is_still: false,
        way: place.map_or("d".into(), |place| quantity(place, length)),
        headline,
        details,
    }
}

/// What touches what.
fn touching(record: &SolidClearanceRecord) -> Option<String> {
    let FeaturesRecord { moving, fixed } = record.features.as_ref()?;
    let normal = components(record.normal?.into());
    let moving = format!("{} of {}", moving.kind, name(record.moving.as_deref()?));
    let fixed = format!("{} of {}", fixed.kind, name(record.fixed.as_deref()?));
    Some(format!("{moving} touches {fixed}; normal n = {normal}"))
}

/// A file without its folder.
fn name(file: &str) -> Cow<'_, str> {
    let path = Path::new(file);
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy()
}

/// From the scene to the page.
pub(super) struct Eye<'a> {
    pub(super) view: &'a View,
    pub(super) layout: &'a Layout,
}

/// Edges that are drawn.
#[derive(Default)]
struct Drawn {
    outline: Vec<[DVec3; 2]>,
    creases: Vec<[DVec3; 2]>,
}

impl Eye<'_> {
    /// A point on the page, and how near it is.
    fn see(&self, p: DVec3) -> DVec3 {
        self.layout.on_page(self.view.project(p)).extend(p.dot(self.view.toward))
    }

    fn draw(&self, page: &mut Page, cast: &Cast, [moving, fixed]: [&[Edge]; 2]) {
        let mut raster = Raster::new(self.layout.window);
        self.rasterise(&mut raster, &cast.fixed, 0);
        self.rasterise(&mut raster, &cast.stop, MOVING_TONES);
        for (tone, tiles) in raster.tiles().into_iter().enumerate() {
            let paint = if tone < MOVING_TONES { &FIXED } else { &MOVING };
            let colour = paint.shade(tone % MOVING_TONES);
            // The thin rim closes the seams that anti-aliasing leaves.
            let look = format!(r#"fill="{colour}" stroke="{colour}" stroke-width="0.7""#);
            page.tiles(&look, &tiles);
        }
        let size = working_size(cast.stop.ball().1, cast.fixed.ball().1, cast.way.length());
        let slack = SLACK * size;
        self.lines(page, &raster, (&cast.fixed, fixed), &FIXED, slack);
        self.lines(page, &raster, (&cast.stop, moving), &MOVING, slack);
        for start in cast.start.iter().chain(cast.ghosts.iter().map(|(_, ghost)| ghost)) {
            self.ghost(page, &raster, (start, moving), slack);
        }
    }

    /// Faces that look towards the viewer, and those of surfaces that are seen from behind.
    fn rasterise(&self, raster: &mut Raster, body: &Solid, first_tone: usize) {
        let seen: Vec<DVec3> = body.vertices.iter().map(|&v| self.see(v)).collect();
        for (face, &area) in body.faces.iter().zip(&body.areas) {
            let normal = area.normalize_or_zero();
            let facing = normal * normal.dot(self.view.toward).signum();
            let lit = self.view.brightness(facing);
            let tone = first_tone + (lit * SHADES as f64).round() as usize;
            raster.draw([0, 1, 2].map(|k| seen[face[k] as usize]), tone as u32);
        }
    }

    fn lines(
        &self,
        page: &mut Page,
        raster: &Raster,
        (body, edges): (&Solid, &[Edge]),
        paint: &Paint,
        slack: f64,
    ) {
        let drawn = self.drawn(body, edges);
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
        if drawn.outline.len() + drawn.creases.len() <= FEW_EDGES {
            let dashes = Stroke::dashed(paint.fine, 0.6, "2.5 3");
            page.segments(dashes, hidden.into_iter().chain(behind));
        }
        page.segments(Stroke::solid(paint.line, 0.9), creases);
        page.segments(Stroke::solid(paint.line, 1.5), outline);
    }

    /// Where the moving part starts: light, and hidden by what is before it.
    fn ghost(
        &self,
        page: &mut Page,
        scene: &Raster,
        (start, edges): (&Solid, &[Edge]),
        slack: f64,
    ) {
        let mut own = Raster::new(self.layout.window);
        self.rasterise(&mut own, start, 0);
        own.keep_before(scene);
        let drawn = self.drawn(start, edges);
        let mut lines = Vec::new();
        for edge in drawn.outline.iter().chain(&drawn.creases) {
            lines.extend(own.split(*edge, slack)[0].iter().copied());
        }
        page.open_group(r#"opacity="0.75""#);
        let tiles: Vec<[usize; 4]> = own.tiles().concat();
        page.tiles(r##"fill="#dce7f5" fill-opacity="0.55" stroke="none""##, &tiles);
        page.segments(Stroke::solid(MOVING.fine, 0.7), lines);
        page.close_group();
    }

    fn drawn(&self, body: &Solid, edges: &[Edge]) -> Drawn {
        let mut drawn = Drawn::default();
        if let ([from, .., to], true) = (&body.vertices[..], body.faces.is_empty()) {
            // A segment.
            drawn.outline.push([*from, *to].map(|p| self.see(p)));
        }
        let normal = |f: u32| body.areas[f as usize].normalize_or_zero();
        let is_front = |f: u32| body.areas[f as usize].dot(self.view.toward) > 0.0;
        for (ends, faces) in edges {
            let is_outline = match faces[..] {
                [f, g] if is_front(f) != is_front(g) => true,
                [f, g] if normal(f).dot(normal(g)) >= SMOOTH => continue,
                _ => false,
            };
            let line = ends.map(|v| self.see(body.vertices[v as usize]));
            if is_outline { &mut drawn.outline } else { &mut drawn.creases }.push(line);
        }
        drawn
    }
}
