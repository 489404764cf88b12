//! How large the scene is drawn, and which part of it.
//!
//! Bodies may differ in size by any factor and start at any distance: the smaller one
//! and the contact rule, the larger one may be cut by the window.

use colltrans::glam::DVec2;
use colltrans_picture::{Frame, View};

use super::size::working_size;
use super::subject::Subject;
use super::{Cast, Solid};

const PAGE_WIDTH: f64 = 720.0;
const WINDOW_HEIGHT: f64 = 520.0;
/// Room for arrows and labels around the bodies.
const MARGIN: DVec2 = DVec2::new(84.0, 62.0);
const CAPTION_HEIGHT: f64 = 44.0;
/// Height of a line of details in the caption.
pub(super) const LINE_HEIGHT: f64 = 17.0;
/// Bodies are shown whole unless one is larger than the other by this factor;
const WHOLE: f64 = 8.0;
/// then the larger one is shown up to this many working sizes from the contact.
const REACH: f64 = 1.4;

/// Scale and place of the scene on the page.
pub(super) struct Layout {
    scale: f64,
    centre_in_view: DVec2,
    centre_on_page: DVec2,
    pub(super) window: Frame,
    pub(super) size: DVec2,
}

impl Layout {
    pub(super) fn of(cast: &Cast, subject: &Subject, view: &View) -> Self {
        let radii = [cast.stop.ball().1, cast.fixed.ball().1];
        let size = working_size(radii[0], radii[1], cast.way.length());
        let is_whole = radii[0].max(radii[1]) <= WHOLE * size / 3.0;
        let reach = if is_whole { f64::INFINITY } else { REACH * size };
        // The origin is the contact; the moving body is near it where it stops.
        let mut frame = part_near(&cast.stop, DVec2::ZERO, reach, view);
        frame = union(frame, part_near(&cast.fixed, DVec2::ZERO, reach, view));
        if let Some(start) = &cast.start {
            frame = union(frame, part_near(start, -view.project(cast.way), reach, view));
        }
        for (_, ghost) in &cast.ghosts {
            frame = union(frame, part_near(ghost, DVec2::ZERO, reach, view));
        }
        for corner in subject.corners(cast).into_iter().map(|p| view.project(p)) {
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

    /// From the view's plane (y upwards) to the page (y downwards).
    pub(super) fn on_page(&self, p: DVec2) -> DVec2 {
        let q = (p - self.centre_in_view) * self.scale;
        self.centre_on_page + DVec2::new(q.x, -q.y)
    }
}

/// The box of what lies within `reach` of a point.
fn part_near(body: &Solid, point: DVec2, reach: f64, view: &View) -> Frame {
    let first = view.project(body.vertices[0]);
    let (low, high) = body
        .vertices
        .iter()
        .map(|&v| view.project(v))
        .fold((first, first), |(l, h), p| (l.min(p), h.max(p)));
    let near = |p: DVec2| p.clamp(point - reach, point + reach);
    Frame { low: near(low), high: near(high) }
}

fn union(a: Frame, b: Frame) -> Frame {
    Frame { low: a.low.min(b.low), high: a.high.max(b.high) }
}
