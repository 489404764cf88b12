//! Arrows, labels, legend and caption: all that is written over the scene.

use colltrans::glam::{DVec2, DVec3};

use super::layout::{LINE_HEIGHT, Layout};
use super::solid::convex_outline;
use super::story::{Story, short};
use super::svg::{Frame, Page, Stroke};
use super::view::View;
use super::{Cast, FIXED, FIXED_MARK, MOVING, MOVING_MARK};

const WAY: &str = "#b3261e";
const NORMAL: &str = "#14733f";
const INK: &str = "#222222";
const LABEL: &str = r##"font-size="14" font-style="italic" fill="#222222""##;

/// Distance of the dimension line from the moving body, in pixels.
const ASIDE: f64 = 20.0;
/// Shorter ways are shown by a direction arrow alone.
const SHORT_WAY: f64 = 26.0;

pub(super) struct Notes<'a> {
    pub(super) cast: &'a Cast,
    pub(super) story: &'a Story<'a>,
    pub(super) layout: &'a Layout,
    pub(super) view: &'a View,
}

impl Notes<'_> {
    pub(super) fn draw(&self, page: &mut Page, unit: DVec3) {
        self.draw_way(page, unit);
        self.draw_gap(page);
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
        let towards = self.on_page(unit) - self.on_page(DVec3::ZERO);
        let along = towards.normalize_or(DVec2::X);
        let way = self.on_page(self.cast.way) - self.on_page(DVec3::ZERO);
        let is_short = way.length() < SHORT_WAY || self.cast.start.is_none();
        let way = if is_short { along * 44.0 } else { way };
        let shape: Vec<DVec2> = self.cast.stop.vertices.iter().map(|&v| self.on_page(v)).collect();
        let (side, corner) = self.better_side(&shape, along.perp(), way);
        let stop = if is_short { corner + way * 0.5 } else { corner };
        let start = stop - way;
        let line = [start + side * ASIDE, stop + side * ASIDE];
        if !is_short {
            let thin = Stroke::solid("#777777", 0.6);
            for end in [start, stop] {
                page.segments(thin, [[end + side * 4.0, end + side * (ASIDE + 5.0)]]);
            }
        }
        page.arrow(WAY, 2.0, line);
        let middle = line[0].midpoint(line[1]);
        if self.cast.is_broken {
            break_line(page, middle, along);
        }
        let label = if is_short { "d" } else { &self.story.way };
        let look = LABEL.replace(INK, WAY);
        self.place_label(page, middle, side, &look, label);
    }

    /// The side of the moving body on which the dimension line crosses less, and the body's
    /// outermost corner there.
    fn better_side(&self, shape: &[DVec2], across: DVec2, way: DVec2) -> (DVec2, DVec2) {
        let other: Vec<DVec2> = self.cast.fixed.vertices.iter().map(|&v| self.on_page(v)).collect();
        let outline = convex_outline(&other);
        let window = self.layout.window;
        let label = half_size(&self.story.way);
        let candidates = [across, -across].map(|side| {
            let corner = shape.iter().copied().fold(shape[0], |best, p| {
                if p.dot(side) > best.dot(side) + 1e-6 { p } else { best }
            });
            let crossed = (0..=20)
                .map(|i| corner - way * (f64::from(i) / 20.0) + side * (ASIDE + 8.0))
                .map(|p| {
                    let label_end = p + side * (2.0 * label.dot(side.abs()));
                    let outside = [p, label_end]
                        .map(|q| u32::from((q.cmplt(window.low) | q.cmpgt(window.high)).any()));
                    u32::from(contains(&outline, p)) + outside[0] + outside[1]
                })
                .sum::<u32>();
            (crossed, side, corner)
        });
        let [a, b] = candidates;
        // Among equals, above or to the left.
        let prefers_b = b.0 < a.0 || (b.0 == a.0 && b.1.y + 0.1 * b.1.x < a.1.y + 0.1 * a.1.x);
        if prefers_b { (b.1, b.2) } else { (a.1, a.2) }
    }

    /// Between separated bodies, how far apart they stay.
    fn draw_gap(&self, page: &mut Page) {
        let Some(gap) = self.story.gap(self.cast) else { return };
        let [from, to] = gap.map(|p| self.on_page(p));
        let across = (to - from).normalize_or(DVec2::Y).perp();
        page.haloed(Stroke::solid(NORMAL, 1.8), [from, to]);
        for end in [from, to] {
            page.haloed(Stroke::solid(NORMAL, 1.4), [end - across * 5.0, end + across * 5.0]);
        }
        let label = format!("margin {}", short(self.story.margin.unwrap_or_default()));
        let look = LABEL.replace(INK, NORMAL);
        self.place_label(page, from.midpoint(to), across, &look, &label);
    }

    fn draw_contact(&self, page: &mut Page) {
        if self.story.contact.is_none() {
            return;
        }
        // The contact is the origin.
        let at = self.on_page(DVec3::ZERO);
        let seen = self.view.project(self.story.normal);
        let seen = DVec2::new(seen.x, -seen.y);
        let tip = at + seen.normalize_or(DVec2::NEG_Y) * (64.0 * seen.length()).max(24.0);
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
        page.text(DVec2::new(left, y), "start", fixed_width, &self.story.headline);
        let small = r##"font-size="12" fill="#222222""##;
        for detail in &self.story.details {
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
        let contact = self.story.contact.is_some();
        let stop = if contact { "moving, at contact" } else { "moving, beside the fixed one" };
        let mut entries = Vec::new();
        if self.cast.start.is_some() {
            entries.push(("#dce7f5", MOVING.fine, "moving, at the start"));
        }
        entries.push(("#9db8de", MOVING.line, stop));
        entries.push(("#d9cfbe", FIXED.line, "fixed"));
        if contact {
            entries.push(("#ffffff", MOVING_MARK, "contact feature, moving"));
            entries.push(("#ffffff", FIXED_MARK, "contact feature, fixed"));
        } else {
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
