//! Arrows, labels, legend and caption: all that is written over the scene.

use colltrans::glam::{DVec2, DVec3};
use colltrans_picture::{FIXED, FIXED_MARK, Frame, MOVING, MOVING_MARK, Page, Stroke, View};

use super::Cast;
use super::layout::{LINE_HEIGHT, Layout};
use super::solid::convex_outline;
use super::subject::{Subject, short};

const WAY: &str = "#b3261e";
const NORMAL: &str = "#14733f";
const INK: &str = "#222222";
const LABEL: &str = r##"font-size="14" font-style="italic" fill="#222222""##;

/// Distance of the dimension line from the moving body, in pixels.
const ASIDE: f64 = 20.0;
/// Shorter ways are shown by a direction arrow alone.
const SHORT_WAY: f64 = 26.0;

/// Half the length of the arrow that shows no more than the direction.
const DIRECTION_ARROW: f64 = 22.0;
/// Points of a dimension line that are looked at.
const SAMPLES: u32 = 21;
/// So many of them, or of the label's far ends, outside the window: the line cannot be seen.
const MOSTLY_OUTSIDE: u32 = 34;

pub(super) struct Notes<'a> {
    pub(super) cast: &'a Cast,
    pub(super) subject: &'a Subject,
    pub(super) layout: &'a Layout,
    pub(super) view: &'a View,
}

impl Notes<'_> {
    pub(super) fn draw(&self, page: &mut Page, unit: DVec3) {
        if !self.subject.is_still {
            self.draw_way(page, unit);
        }
        self.draw_gap(page);
        self.draw_link(page);
        self.draw_contact(page);
        self.draw_caption(page);
    }

    fn on_page(&self, p: DVec3) -> DVec2 {
        self.layout.on_page(self.view.project(p))
    }

    /// Text beside a line through a point, on the side that `aside` points to.
    fn place_label(&self, page: &mut Page, at: DVec2, aside: DVec2, look: &str, text: &str) {
        let half = half_size(text);
        let centre = at + aside * (half.dot(aside.abs()) + 6.0);
        let window = self.layout.window;
        page.label(centre.clamp(window.low + half, window.high - half), look, text);
    }

    /// The way beside the moving body, as a dimension line from the start to the stop.
    fn draw_way(&self, page: &mut Page, unit: DVec3) {
        let seen = |v: DVec3| self.on_page(v) - self.on_page(DVec3::ZERO);
        let along = seen(unit).normalize_or(DVec2::X);
        let way = seen(self.cast.way);
        let is_short = way.length() < SHORT_WAY || self.cast.start.is_none();
        let label = if is_short { "d" } else { &self.subject.way };
        let shape: Vec<DVec2> = self.cast.stop.vertices.iter().map(|&v| self.on_page(v)).collect();
        let other: Vec<DVec2> = self.cast.fixed.vertices.iter().map(|&v| self.on_page(v)).collect();
        let other = convex_outline(&other);
        let mut best: Option<(u32, DimensionLine)> = None;
        // Among equals the first, which is above or to the left.
        let across = if along.x < 0.0 { along.perp() } else { -along.perp() };
        for side in [across, -across] {
            let corner = outermost(&shape, side);
            let feet = if is_short {
                [corner - along * DIRECTION_ARROW, corner + along * DIRECTION_ARROW]
            } else {
                [corner - way, corner]
            };
            let line = DimensionLine { feet, side };
            let crossed = self.crossed(&line, &other, label);
            if best.as_ref().is_none_or(|(least, _)| crossed < *least) {
                best = Some((crossed, line));
            }
        }
        let Some((crossed, mut line)) = best else { return };
        let is_lost = crossed >= MOSTLY_OUTSIDE;
        if is_lost {
            // The body is larger than the window: beside the contact, then.
            let at = self.on_page(DVec3::ZERO) - 2.0 * DIRECTION_ARROW * along;
            line.feet = [at - DIRECTION_ARROW * along, at + DIRECTION_ARROW * along];
        }
        if !is_short && !is_lost {
            let thin = Stroke::solid("#777777", 0.6);
            page.segments(thin, line.feet.map(|f| [f + line.side * 4.0, f + line.side * 25.0]));
        }
        let ends = line.ends();
        page.arrow(WAY, 2.0, ends);
        let middle = ends[0].midpoint(ends[1]);
        if self.cast.is_broken && !is_lost {
            break_line(page, middle, along);
        }
        self.place_label(page, middle, line.side, &LABEL.replace(INK, WAY), label);
    }

    /// How much of a dimension line and its label lies over the other body or outside the window.
    fn crossed(&self, line: &DimensionLine, other: &[DVec2], label: &str) -> u32 {
        let window = self.layout.window;
        let [from, to] = line.ends();
        let reach = 2.0 * half_size(label).dot(line.side.abs());
        (0..SAMPLES)
            .map(|i| {
                let p = from.lerp(to, f64::from(i) / f64::from(SAMPLES - 1)) + line.side * 8.0;
                let outside = [p, p + line.side * reach]
                    .map(|q| u32::from((q.cmplt(window.low) | q.cmpgt(window.high)).any()));
                u32::from(contains(other, p)) + outside[0] + outside[1]
            })
            .sum()
    }

    /// Between separated bodies, how far apart they stay.
    fn draw_gap(&self, page: &mut Page) {
        let Some(gap) = self.subject.gap(self.cast) else { return };
        let [from, to] = gap.map(|p| self.on_page(p));
        let across = (to - from).normalize_or(DVec2::Y).perp();
        page.haloed(Stroke::solid(NORMAL, 1.8), [from, to]);
        for end in [from, to] {
            page.haloed(Stroke::solid(NORMAL, 1.4), [end - across * 5.0, end + across * 5.0]);
        }
        let label = format!("margin {}", short(self.subject.margin.unwrap_or_default()));
        let look = LABEL.replace(INK, NORMAL);
        self.place_label(page, from.midpoint(to), across, &look, &label);
    }

    /// The shortest way between the bodies, or a point that both have.
    fn draw_link(&self, page: &mut Page) {
        if self.subject.meets {
            page.dot(self.on_page(DVec3::ZERO), 4.0, WAY, "#ffffff");
        }
        let Some((ends, label)) = &self.subject.link else { return };
        let [from, to] = ends.map(|p| self.on_page(p));
        page.haloed(Stroke::solid(WAY, 2.0), [from, to]);
        for end in [from, to] {
            page.dot(end, 3.5, WAY, "#ffffff");
        }
        let aside = (to - from).normalize_or(DVec2::X).perp();
        let aside = if aside.y > 0.0 { -aside } else { aside };
        self.place_label(page, from.midpoint(to), aside, &LABEL.replace(INK, WAY), label);
    }

    fn draw_contact(&self, page: &mut Page) {
        if !self.subject.touches {
            return;
        }
        // The contact is the origin.
        let at = self.on_page(DVec3::ZERO);
        let seen = self.view.project(self.subject.normal);
        let seen = DVec2::new(seen.x, -seen.y);
        let tip = at + seen.normalize_or(DVec2::NEG_Y) * (56.0 * seen.length()).max(24.0);
        page.arrow(NORMAL, 2.2, [at, tip]);
        page.dot(at, 4.0, WAY, "#ffffff");
        let aside = (tip - at).normalize_or(DVec2::NEG_Y);
        let look = format!(r#"{} font-weight="bold""#, LABEL.replace(INK, NORMAL));
        self.place_label(page, tip, aside, &look, "n");
    }

    fn draw_caption(&self, page: &mut Page) {
        let left = 16.0;
        let mut y = self.layout.window.high.y + 16.0;
        let fixed_width = r##"font-size="15" font-weight="bold" fill="#222222""##;
        page.text(DVec2::new(left, y), "start", fixed_width, &self.subject.headline);
        let small = r##"font-size="12" fill="#222222""##;
        for detail in &self.subject.details {
            y += LINE_HEIGHT;
            page.text(DVec2::new(left, y), "start", small, detail);
        }
        self.draw_legend(page, DVec2::new(left, y + 20.0), small);
        if self.cast.is_broken {
            let right = DVec2::new(self.layout.size.x - left, self.layout.window.high.y + 16.0);
            page.text(right, "end", small, "the way is drawn shortened");
        }
    }

    fn draw_legend(&self, page: &mut Page, at: DVec2, look: &str) {
        let Subject { touches, margin, marks, .. } = self.subject;
        let stop = match (touches, margin) {
            (true, _) => "moving, at contact",
            (false, Some(_)) => "moving, beside the fixed one",
            (false, None)
                if !self.subject.is_still
                    && self.subject.link.is_none()
                    && self.cast.start.is_some() =>
            {
                "moving, parted"
            }
            (false, None) => "moving",
        };
        let mut entries = Vec::new();
        if self.cast.start.is_some() {
            entries.push(("#dce7f5", MOVING.fine, "moving, at the start"));
        }
        let names: Vec<&str> = self.cast.ghosts.iter().map(|(name, _)| *name).collect();
        let ghosts = format!("moving, at {}", names.join(" and "));
        if !names.is_empty() {
            entries.push(("#dce7f5", MOVING.fine, ghosts.as_str()));
        }
        entries.push(("#9db8de", MOVING.line, stop));
        entries.push(("#d9cfbe", FIXED.line, "fixed"));
        if marks.is_some() {
            entries.push(("#ffffff", MOVING_MARK, "contact feature, moving"));
            entries.push(("#ffffff", FIXED_MARK, "contact feature, fixed"));
        }
        if margin.is_some() {
            entries.push(("#fbe7bb", "#a87600", "separating plane"));
        }
        let mut x = at.x;
        for (fill, rim, text) in entries {
            let low = DVec2::new(x, at.y - 9.0);
            let frame = Frame { low, high: low + DVec2::new(14.0, 10.0) };
            page.rectangle(&format!(r#"fill="{fill}" stroke="{rim}" stroke-width="1.2""#), frame);
            page.text(DVec2::new(x + 19.0, at.y), "start", look, text);
            x += 36.0 + 6.1 * text.len() as f64;
        }
    }
}

/// A line beside a body, parallel to one between two points of it.
struct DimensionLine {
    feet: [DVec2; 2],
    side: DVec2,
}

impl DimensionLine {
    fn ends(&self) -> [DVec2; 2] {
        self.feet.map(|foot| foot + self.side * ASIDE)
    }
}

fn outermost(points: &[DVec2], side: DVec2) -> DVec2 {
    let further =
        |best: DVec2, p: DVec2| if p.dot(side) > best.dot(side) + 1e-6 { p } else { best };
    points.iter().copied().reduce(further).unwrap_or_default()
}

/// Half the width and height of a label.
fn half_size(text: &str) -> DVec2 {
    DVec2::new(3.7 * text.chars().count() as f64, 8.0)
}

/// Two slanted strokes: the line is longer than it is drawn.
fn break_line(page: &mut Page, at: DVec2, along: DVec2) {
    let slant = (along.perp() + 0.5 * along) * 6.0;
    page.segments(Stroke::solid("#ffffff", 5.0), [[at - along * 2.5, at + along * 2.5]]);
    for offset in [-3.5, 3.5] {
        let middle = at + along * offset;
        page.segments(Stroke::solid(WAY, 1.4), [[middle - slant, middle + slant]]);
    }
}

/// Whether a convex outline contains a point.
fn contains(outline: &[DVec2], p: DVec2) -> bool {
    let next = outline.iter().cycle().skip(1);
    outline.len() > 2 && outline.iter().zip(next).all(|(&a, &b)| (b - a).perp_dot(p - a) >= 0.0)
}
