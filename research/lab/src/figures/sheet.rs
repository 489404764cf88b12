//! A sheet of lines, areas and texts, written as SVG for light and dark backgrounds. Coordinates are pixels
//! with `y` downwards.

use std::fmt::Write as _;

use glam::DVec2;

/// Styles of the classes.
const STYLE: &str = include_str!("sheet.css");

/// An SVG document under construction.
#[derive(Debug)]
pub(super) struct Sheet {
    size: DVec2,
    body: String,
}

/// Alignment of a text at its position.
#[derive(Debug, Clone, Copy)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

impl Sheet {
    /// Creates a sheet with a title and a background.
    pub(super) fn new(title: &str, wide: f64, high: f64) -> Self {
        let mut sheet = Self { size: DVec2::new(wide, high), body: String::new() };
        sheet.put(&format!("<title>{title}</title>\n<style>{STYLE}</style>\n"));
        sheet.put(&format!("<rect class=\"ground\" width=\"{wide}\" height=\"{high}\"/>\n"));
        sheet
    }

    /// Appends SVG source.
    fn put(&mut self, text: &str) {
        self.body.push_str(text);
    }

    /// Appends a path through points.
    fn path(&mut self, class: &str, points: &[DVec2], end: &str) {
        let mut d = String::new();
        for (k, at) in points.iter().enumerate() {
            // Writing to a string does not fail.
            let _ = write!(d, "{}{}", if k == 0 { "M" } else { "L" }, point_text(*at));
        }
        self.put(&format!("<path class=\"{class}\" d=\"{d}{end}\"/>\n"));
    }

    /// Draws a polygon with at least three points.
    pub(super) fn polygon(&mut self, class: &str, points: &[DVec2]) {
        if points.len() > 2 {
            self.path(class, points, "Z");
        }
    }

    /// Draws a line.
    pub(super) fn line(&mut self, class: &str, from: DVec2, to: DVec2) {
        self.path(class, &[from, to], "");
    }

    /// Draws many lines of one class.
    pub(super) fn lines(&mut self, class: &str, lines: &[[DVec2; 2]]) {
        let all: Vec<String> =
            lines.iter().map(|[a, b]| format!("M{}L{}", point_text(*a), point_text(*b))).collect();
        if !all.is_empty() {
            self.put(&format!("<path class=\"{class}\" d=\"{}\"/>\n", all.concat()));
        }
    }

    /// Draws a dot.
    pub(super) fn dot(&mut self, class: &str, at: DVec2, radius: f64) {
        let (x, y) = (rounded(at.x), rounded(at.y));
        self.put(&format!("<circle class=\"{class}\" cx=\"{x}\" cy=\"{y}\" r=\"{radius}\"/>\n"));
    }

    /// Draws a line with an arrow head at its end.
    pub(super) fn arrow(&mut self, [class, head]: [&str; 2], from: DVec2, to: DVec2) {
        let way = (to - from).normalize_or_zero();
        let neck = to - way * 8.0;
        self.line(class, from, neck);
        self.polygon(head, &[to, neck + way.perp() * 3.6, neck - way.perp() * 3.6]);
    }

    /// Draws a text.
    pub(super) fn text(&mut self, class: &str, at: DVec2, anchor: Anchor, words: &str) {
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let (x, y) = (rounded(at.x), rounded(at.y));
        let attributes = format!("x=\"{x}\" y=\"{y}\" text-anchor=\"{anchor}\"");
        self.put(&format!("<text class=\"{class}\" {attributes}>{words}</text>\n"));
    }

    /// Draws legend entries side by side: a symbol for each class, and its meaning.
    pub(super) fn legend(&mut self, mut at: DVec2, entries: &[(&str, &str, f64)]) {
        for &(class, words, room) in entries {
            let middle = at + DVec2::new(9.0, -4.0);
            match class {
                "dot" | "start" | "least" => self.dot(class, middle, 4.5),
                "cut" | "shifted" | "moving-mark" | "fixed-mark" | "way" | "border" | "arrow"
                | "leader" => {
                    self.line(class, middle - DVec2::X * 11.0, middle + DVec2::X * 11.0);
                }
                _ => self.polygon(
                    class,
                    &rectangle(middle - DVec2::new(10.0, 6.0), middle + DVec2::new(10.0, 6.0)),
                ),
            }
            self.text("small", at + DVec2::X * 26.0, Anchor::Start, words);
            at.x += room;
        }
    }

    /// Returns the document.
    pub(super) fn finish(self) -> String {
        let Self { size: DVec2 { x, y }, body } = self;
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {x} {y}\" width=\"{x}\" height=\"{y}\" \
             stroke-linejoin=\"round\" stroke-linecap=\"round\">\n{body}</svg>\n"
        )
    }
}

/// Returns the corners of a rectangle.
pub(super) fn rectangle(low: DVec2, high: DVec2) -> [DVec2; 4] {
    [low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)]
}

/// Rounds to a tenth of a pixel, without negative zeros.
fn rounded(x: f64) -> f64 {
    (x * 10.0).round() / 10.0 + 0.0
}

/// Formats a point.
fn point_text(at: DVec2) -> String {
    format!("{} {}", rounded(at.x), rounded(at.y))
}

/// A map from an area with `y` upwards to a rectangle of the sheet.
#[derive(Debug, Clone, Copy)]
pub(super) struct Map {
    from: DVec2,
    scale: DVec2,
    to: DVec2,
}

impl Map {
    /// Fits an area into the middle of a rectangle, with the same scale for both axes.
    pub(super) fn fitting(points: &[DVec2], [left, right]: [DVec2; 2]) -> Self {
        let low = points.iter().fold(DVec2::INFINITY, |low, &p| low.min(p));
        let high = points.iter().fold(DVec2::NEG_INFINITY, |high, &p| high.max(p));
        let scale = ((right - left) / (high - low)).min_element();
        Self {
            from: 0.5 * (low + high),
            scale: DVec2::new(scale, -scale),
            to: 0.5 * (left + right),
        }
    }

    /// Maps a point.
    pub(super) fn at(&self, p: DVec2) -> DVec2 {
        self.to + (p - self.from) * self.scale
    }

    /// Maps points.
    pub(super) fn all(&self, points: &[DVec2]) -> Vec<DVec2> {
        points.iter().map(|&p| self.at(p)).collect()
    }

    /// Maps a direction to a direction of length 1 on the sheet.
    pub(super) fn way(&self, v: DVec2) -> DVec2 {
        (v * self.scale).normalize_or_zero()
    }
}
