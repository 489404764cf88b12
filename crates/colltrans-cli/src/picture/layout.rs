//! Scale and position of the bodies on the page.
//!
//! Bodies may differ in size by any factor and start at any distance. The smaller body and the contact determine the
//! scale; the window may cut the larger one.

use colltrans::glam::DVec2;
use colltrans_picture::{Frame, View};

use super::size::working_size;
use super::subject::Subject;
use super::{PictureBodies, Solid};

/// Width of the page in pixels.
const PAGE_WIDTH: f64 = 720.0;
/// Maximum height of the window in pixels.
const WINDOW_HEIGHT: f64 = 520.0;
/// Space for arrows and labels around the bodies, in pixels.
const MARGIN: DVec2 = DVec2::new(84.0, 62.0);
/// Height of the headline and the legend, in pixels.
const CAPTION_HEIGHT: f64 = 44.0;
/// Height of a line of details in the caption, in pixels.
pub(super) const LINE_HEIGHT: f64 = 17.0;
/// Maximum ratio of a body's radius to a third of the working size at which both bodies are shown completely.
const MAX_SIZE_RATIO: f64 = 8.0;
/// Distance from the contact, in working sizes, up to which a larger body is shown.
const CUT_DISTANCE: f64 = 1.4;

/// Scale and position of the bodies on the page.
pub(super) struct Layout {
    scale: f64,
    centre_in_view: DVec2,
    centre_on_page: DVec2,
    pub(super) window: Frame,
    pub(super) size: DVec2,
}

impl Layout {
    /// Computes the layout that shows all bodies, ghosts and marks of a picture.
    pub(super) fn compute(bodies: &PictureBodies, subject: &Subject, view: &View) -> Self {
        let radii = [bodies.stop.bounding_sphere().1, bodies.fixed.bounding_sphere().1];
        let size = working_size(radii[0], radii[1], bodies.way.length());
        let shows_all = radii[0].max(radii[1]) <= MAX_SIZE_RATIO * size / 3.0;
        let cut = if shows_all { f64::INFINITY } else { CUT_DISTANCE * size };
        // The origin is the contact. Both bodies and all ghosts are near it.
        let mut frame = visible_frame(&bodies.stop, DVec2::ZERO, cut, view);
        frame = union(frame, visible_frame(&bodies.fixed, DVec2::ZERO, cut, view));
        if let Some(start) = &bodies.start {
            frame = union(frame, visible_frame(start, -view.project(bodies.way), cut, view));
        }
        for (_, ghost) in &bodies.ghosts {
            frame = union(frame, visible_frame(ghost, DVec2::ZERO, cut, view));
        }
        for corner in subject.extra_points(bodies).into_iter().map(|p| view.project(p)) {
            frame = union(frame, Frame { low: corner, high: corner });
        }
        let extent = (frame.high - frame.low).max(DVec2::splat(1e-3 * size));
        let room = DVec2::new(PAGE_WIDTH, WINDOW_HEIGHT) - 2.0 * MARGIN;
        let scale = (room / extent).min_element();
        let height = (extent.y * scale).max(140.0) + 2.0 * MARGIN.y;
        let caption = CAPTION_HEIGHT + LINE_HEIGHT * subject.details.len() as f64;
        let window = Frame { low: DVec2::ZERO, high: DVec2::new(PAGE_WIDTH, height) };
        Self {
            scale,
            centre_in_view: 0.5 * (frame.low + frame.high),
            centre_on_page: 0.5 * window.high,
            window,
            size: DVec2::new(PAGE_WIDTH, height + caption),
        }
    }

    /// Maps a point of the view plane (y upwards) to the page (y downwards).
    pub(super) fn on_page(&self, p: DVec2) -> DVec2 {
        let q = (p - self.centre_in_view) * self.scale;
        self.centre_on_page + DVec2::new(q.x, -q.y)
    }
}

/// Returns the frame of the body's projection, cut at the distance `cut` from a point.
fn visible_frame(body: &Solid, point: DVec2, cut: f64, view: &View) -> Frame {
    let first = view.project(body.vertices[0]);
    let (low, high) = body
        .vertices
        .iter()
        .map(|&v| view.project(v))
        .fold((first, first), |(l, h), p| (l.min(p), h.max(p)));
    let clamp = |p: DVec2| p.clamp(point - cut, point + cut);
    Frame { low: clamp(low), high: clamp(high) }
}

/// Returns the smallest frame that contains both.
fn union(a: Frame, b: Frame) -> Frame {
    Frame { low: a.low.min(b.low), high: a.high.max(b.high) }
}
