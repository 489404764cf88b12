//! Arrows, labels, legend and caption, drawn over the bodies.

use colltrans::glam::{DVec2, DVec3};
use colltrans_picture::{
    ARROW_WIDTH, CONTACT, FINE_WIDTH, FIXED, FIXED_MARK, Frame, INK, MARK_WIDTH, MOVING,
    MOVING_MARK, OUTLINE_WIDTH, PLANE, Page, QUIET, Stroke, View,
};

use super::PictureBodies;
use super::layout::{LINE_HEIGHT, Layout};
use super::solid::convex_outline;
use super::subject::{Subject, short};

/// Returns the style of labels of a colour.
fn label_style(colour: &str) -> String {
    format!(r#"font-size="14" font-style="italic" fill="{colour}""#)
}

/// Distance of the dimension line from the moving body, in pixels.
const LINE_DISTANCE: f64 = 20.0;
/// Length of a translation in pixels below which only an arrow of the direction is drawn.
const MIN_WAY: f64 = 26.0;

/// Half of the length of an arrow of the direction, in pixels.
const DIRECTION_ARROW: f64 = 22.0;
/// Number of samples of a dimension line that are tested for overlaps.
const LINE_SAMPLES: u32 = 21;
/// Number of overlaps of samples and label ends from which a dimension line counts as invisible.
const MAX_OVERLAPS: u32 = 34;

/// The annotations of a picture.
pub(super) struct Notes<'a> {
    pub(super) bodies: &'a PictureBodies,
    pub(super) subject: &'a Subject,
    pub(super) layout: &'a Layout,
    pub(super) view: &'a View,
}

impl Notes<'_> {
    /// Draws all annotations. `unit` is the direction.
    pub(super) fn draw(&self, page: &mut Page, unit: DVec3) {
        if !self.subject.is_still {
            self.draw_translation(page, unit);
        }
        self.draw_margin(page);
        self.draw_shortest_way(page);
        self.draw_contact(page);
        self.draw_caption(page);
    }

    /// Maps a point relative to the origin of the picture to the page.
    fn on_page(&self, p: DVec3) -> DVec2 {
        self.layout.on_page(self.view.project(p))
    }

    /// Draws a label next to a line through a point, on the side of the unit vector `aside`, inside the window.
    fn draw_label(&self, page: &mut Page, at: DVec2, aside: DVec2, style: &str, text: &str) {
        let half = label_half_size(text);
        let centre = at + aside * (half.dot(aside.abs()) + 6.0);
        let window = self.layout.window;
        page.label(centre.clamp(window.low + half, window.high - half), style, text);
    }

    /// Draws the translation as a dimension line next to the moving body.
    fn draw_translation(&self, page: &mut Page, unit: DVec3) {
        let projected = |v: DVec3| self.on_page(v) - self.on_page(DVec3::ZERO);
        let along = projected(unit).normalize_or(DVec2::X);
        let way = projected(self.bodies.way);
        let is_short = way.length() < MIN_WAY || self.bodies.start.is_none();
        let label = if is_short { "d" } else { &self.subject.way };
        let shape: Vec<DVec2> =
            self.bodies.stop.vertices.iter().map(|&v| self.on_page(v)).collect();
        let other: Vec<DVec2> =
            self.bodies.fixed.vertices.iter().map(|&v| self.on_page(v)).collect();
        let other = convex_outline(&other);
        let mut best: Option<(u32, DimensionLine)> = None;
        // The first of equal sides is above or to the left.
        let across = if along.x < 0.0 { along.perp() } else { -along.perp() };
        for side in [across, -across] {
            let corner = farthest_point(&shape, side);
            let feet = if is_short {
                [corner - along * DIRECTION_ARROW, corner + along * DIRECTION_ARROW]
            } else {
                [corner - way, corner]
            };
            let line = DimensionLine { feet, side };
            let overlaps = self.count_overlaps(&line, &other, label);
            if best.as_ref().is_none_or(|(least, _)| overlaps < *least) {
                best = Some((overlaps, line));
            }
        }
        let Some((overlaps, mut line)) = best else { return };
        let is_hidden = overlaps >= MAX_OVERLAPS;
        if is_hidden {
            // The body is larger than the window, so the arrow is drawn next to the contact.
            let at = self.on_page(DVec3::ZERO) - 2.0 * DIRECTION_ARROW * along;
            line.feet = [at - DIRECTION_ARROW * along, at + DIRECTION_ARROW * along];
        }
        if !is_short && !is_hidden {
            let thin = Stroke::solid(QUIET, FINE_WIDTH);
            page.segments(thin, line.feet.map(|f| [f + line.side * 4.0, f + line.side * 25.0]));
        }
        let ends = line.ends();
        page.arrow(INK, ARROW_WIDTH, ends);
        let middle = ends[0].midpoint(ends[1]);
        if self.bodies.is_broken && !is_hidden {
            draw_break(page, middle, along);
        }
        self.draw_label(page, middle, line.side, &label_style(INK), label);
    }

    /// Counts samples of a dimension line over the other body, and of the line and its label outside the window.
    fn count_overlaps(&self, line: &DimensionLine, other: &[DVec2], label: &str) -> u32 {
        let window = self.layout.window;
        let [from, to] = line.ends();
        let label_width = 2.0 * label_half_size(label).dot(line.side.abs());
        (0..LINE_SAMPLES)
            .map(|i| {
                let p = from.lerp(to, f64::from(i) / f64::from(LINE_SAMPLES - 1)) + line.side * 8.0;
                let outside = [p, p + line.side * label_width]
                    .map(|q| u32::from((q.cmplt(window.low) | q.cmpgt(window.high)).any()));
                u32::from(contains(other, p)) + outside[0] + outside[1]
            })
            .sum()
    }

    /// Draws the margin between separated bodies.
    fn draw_margin(&self, page: &mut Page) {
        let Some(gap) = self.subject.margin_ends(self.bodies) else { return };
        let [from, to] = gap.map(|p| self.on_page(p));
        let across = (to - from).normalize_or(DVec2::Y).perp();
        page.haloed(Stroke::solid(PLANE, ARROW_WIDTH), [from, to]);
        for end in [from, to] {
            page.haloed(
                Stroke::solid(PLANE, OUTLINE_WIDTH),
                [end - across * 5.0, end + across * 5.0],
            );
        }
        let label = format!("margin {}", short(self.subject.margin.unwrap_or_default()));
        let look = label_style(PLANE);
        self.draw_label(page, from.midpoint(to), across, &look, &label);
    }

    /// Draws the shortest way between the bodies, or a common point.
    fn draw_shortest_way(&self, page: &mut Page) {
        if self.subject.meets {
            page.dot(self.on_page(DVec3::ZERO), 4.0, CONTACT, "#ffffff");
        }
        let Some((ends, label)) = &self.subject.link else { return };
        let [from, to] = ends.map(|p| self.on_page(p));
        page.haloed(Stroke::solid(CONTACT, ARROW_WIDTH), [from, to]);
        for end in [from, to] {
            page.dot(end, 3.5, CONTACT, "#ffffff");
        }
        let aside = (to - from).normalize_or(DVec2::X).perp();
        let aside = if aside.y > 0.0 { -aside } else { aside };
        self.draw_label(page, from.midpoint(to), aside, &label_style(CONTACT), label);
    }

    /// Draws the contact point and the normal.
    fn draw_contact(&self, page: &mut Page) {
        if !self.subject.touches {
            return;
        }
        // The contact point is the origin.
        let at = self.on_page(DVec3::ZERO);
        let seen = self.view.project(self.subject.normal);
        let seen = DVec2::new(seen.x, -seen.y);
        let tip = at + seen.normalize_or(DVec2::NEG_Y) * (56.0 * seen.length()).max(24.0);
        page.arrow(CONTACT, MARK_WIDTH, [at, tip]);
        page.dot(at, 4.0, CONTACT, "#ffffff");
        let aside = (tip - at).normalize_or(DVec2::NEG_Y);
        let look = format!(r#"{} font-weight="bold""#, label_style(CONTACT));
        self.draw_label(page, tip, aside, &look, "n");
    }

    /// Draws the headline, the details and the legend.
    fn draw_caption(&self, page: &mut Page) {
        let left = 16.0;
        let mut y = self.layout.window.high.y + 16.0;
        let headline = format!(r#"font-size="15" font-weight="bold" fill="{INK}""#);
        page.text(DVec2::new(left, y), "start", &headline, &self.subject.headline);
        let small = format!(r#"font-size="12" fill="{INK}""#);
        for detail in &self.subject.details {
            y += LINE_HEIGHT;
            page.text(DVec2::new(left, y), "start", &small, detail);
        }
        self.draw_legend(page, DVec2::new(left, y + 20.0), &small);
        if self.bodies.is_broken {
            let right = DVec2::new(self.layout.size.x - left, self.layout.window.high.y + 16.0);
            page.text(right, "end", &small, "the translation is drawn shortened");
        }
    }

    /// Draws the legend of the bodies and marks.
    fn draw_legend(&self, page: &mut Page, at: DVec2, style: &str) {
        let Subject { touches, margin, marks, .. } = self.subject;
        let has_start = self.bodies.start.is_some();
        let stop = match (touches, margin) {
            (true, _) => "moving, at contact",
            (false, Some(_)) => "moving, next to the fixed one",
            (false, None) if !has_start || self.subject.link.is_some() => "moving",
            (false, None) if !self.subject.is_still => "moving, separated",
            (false, None) if self.bodies.ghosts.is_empty() => "moving, at the end",
            (false, None) => "moving, at that time",
        };
        let (solid, ghost) = (("#9db8de", MOVING.line), ("#dce7f5", MOVING.fine));
        let mut entries = Vec::new();
        if has_start {
            entries.push((solid.0, solid.1, "moving, at the start"));
        }
        let (fill, rim) = if has_start { ghost } else { solid };
        entries.push((fill, rim, stop));
        for (name, _) in &self.bodies.ghosts {
            entries.push((ghost.0, ghost.1, *name));
        }
        entries.push(("#d9cfbe", FIXED.line, "fixed"));
        if marks.is_some() {
            entries.push(("#ffffff", MOVING_MARK, "contact feature, moving"));
            entries.push(("#ffffff", FIXED_MARK, "contact feature, fixed"));
        }
        if margin.is_some() {
            entries.push(("#bfdfd6", PLANE, "separating plane"));
        }
        let mut x = at.x;
        for (fill, rim, text) in entries {
            let low = DVec2::new(x, at.y - 9.0);
            let frame = Frame { low, high: low + DVec2::new(14.0, 10.0) };
            page.rectangle(&format!(r#"fill="{fill}" stroke="{rim}" stroke-width="1.2""#), frame);
            page.text(DVec2::new(x + 19.0, at.y), "start", style, text);
            x += 36.0 + 6.1 * text.len() as f64;
        }
    }
}

/// A line next to a body, parallel to the line between two points of it.
struct DimensionLine {
    feet: [DVec2; 2],
    side: DVec2,
}

impl DimensionLine {
    /// Returns the ends of the line on the page.
    fn ends(&self) -> [DVec2; 2] {
        self.feet.map(|foot| foot + self.side * LINE_DISTANCE)
    }
}

/// Returns the point farthest in a direction, the first of nearly equal ones.
fn farthest_point(points: &[DVec2], side: DVec2) -> DVec2 {
    let further =
        |best: DVec2, p: DVec2| if p.dot(side) > best.dot(side) + 1e-6 { p } else { best };
    points.iter().copied().reduce(further).unwrap_or_default()
}

/// Returns half of the width and of the height of a label, in pixels.
fn label_half_size(text: &str) -> DVec2 {
    DVec2::new(3.7 * text.chars().count() as f64, 8.0)
}

/// Draws two slanted strokes, which mark a line that is drawn shortened.
fn draw_break(page: &mut Page, at: DVec2, along: DVec2) {
    let slant = (along.perp() + 0.5 * along) * 6.0;
    page.segments(Stroke::solid("#ffffff", 5.0), [[at - along * 2.5, at + along * 2.5]]);
    for offset in [-3.5, 3.5] {
        let middle = at + along * offset;
        page.segments(Stroke::solid(INK, OUTLINE_WIDTH), [[middle - slant, middle + slant]]);
    }
}

/// Checks whether a convex outline contains a point.
fn contains(outline: &[DVec2], p: DVec2) -> bool {
    let next = outline.iter().cycle().skip(1);
    outline.len() > 2 && outline.iter().zip(next).all(|(&a, &b)| (b - a).perp_dot(p - a) >= 0.0)
}
