//! A sheet of lines, areas and words, written as SVG: legible on a light ground and, where the reader's
//! system is dark, on a dark one. Coordinates are pixels, `y` downwards.

use std::fmt::Write as _;

use glam::DVec2;

/// What classes look like: fills, lines, words.
const STYLE: &str = include_str!("sheet.css");

/// An SVG document that grows.
#[derive(Debug)]
pub(super) struct Sheet {
    size: DVec2,
    body: String,
}

/// Where a word stands beside its place.
#[derive(Debug, Clone, Copy)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

impl Sheet {
    pub(super) fn new(title: &str, wide: f64, high: f64) -> Self {
        let mut sheet = Self { size: DVec2::new(wide, high), body: String::new() };
        sheet.put(&format!("<title>{title}</title>\n<style>{STYLE}</style>\n"));
        sheet.put(&format!("<rect class=\"ground\" width=\"{wide}\" height=\"{high}\"/>\n"));
        sheet
    }

    fn put(&mut self, text: &str) {
        self.body.push_str(text);
    }

    fn path(&mut self, class: &str, points: &[DVec2], end: &str) {
        let mut d = String::new();
        for (k, at) in points.iter().enumerate() {
            // Writing to a string does not fail.
            let _ = write!(d, "{}{}", if k == 0 { "M" } else { "L" }, place(*at));
        }
        self.put(&format!("<path class=\"{class}\" d=\"{d}{end}\"/>\n"));
    }

    pub(super) fn polygon(&mut self, class: &str, points: &[DVec2]) {
        if points.len() > 2 {
            self.path(class, points, "Z");
        }
    }

    pub(super) fn line(&mut self, class: &str, from: DVec2, to: DVec2) {
        self.path(class, &[from, to], "");
    }

    /// Many lines of one kind.
    pub(super) fn lines(&mut self, class: &str, lines: &[[DVec2; 2]]) {
        let all: Vec<String> =
            lines.iter().map(|[a, b]| format!("M{}L{}", place(*a), place(*b))).collect();
        if !all.is_empty() {
            self.put(&format!("<path class=\"{class}\" d=\"{}\"/>\n", all.concat()));
        }
    }

    pub(super) fn dot(&mut self, class: &str, at: DVec2, radius: f64) {
        let (x, y) = (number(at.x), number(at.y));
        self.put(&format!("<circle class=\"{class}\" cx=\"{x}\" cy=\"{y}\" r=\"{radius}\"/>\n"));
    }

    /// A line with a head at its end.
    pub(super) fn arrow(&mut self, [class, head]: [&str; 2], from: DVec2, to: DVec2) {
        let way = (to - from).normalize_or_zero();
        let neck = to - way * 8.0;
        self.line(class, from, neck);
        self.polygon(head, &[to, neck + way.perp() * 3.6, neck - way.perp() * 3.6]);
    }

    pub(super) fn text(&mut self, class: &str, at: DVec2, anchor: Anchor, words: &str) {
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let (x, y) = (number(at.x), number(at.y));
        let attributes = format!("x=\"{x}\" y=\"{y}\" text-anchor=\"{anchor}\"");
        self.put(&format!("<text class=\"{class}\" {attributes}>{words}</text>\n"));
    }

    /// Entries side by side: a sign for each class, and what it means.
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

    pub(super) fn finish(self) -> String {
        let Self { size: DVec2 { x, y }, body } = self;
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {x} {y}\" width=\"{x}\" height=\"{y}\" \
             stroke-linejoin=\"round\" stroke-linecap=\"round\">\n{body}</svg>\n"
        )
    }
}

pub(super) fn rectangle(low: DVec2, high: DVec2) -> [DVec2; 4] {
    [low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)]
}

/// A tenth of a pixel is as fine as it gets; no negative zero.
fn number(x: f64) -> f64 {
    (x * 10.0).round() / 10.0 + 0.0
}

fn place(at: DVec2) -> String {
    format!("{} {}", number(at.x), number(at.y))
}

/// Maps an area, `y` upwards, into a rectangle of the sheet.
#[derive(Debug, Clone, Copy)]
pub(super) struct Map {
    from: DVec2,
    scale: DVec2,
    to: DVec2,
}

impl Map {
    /// As large as fits, in the middle, the same scale for both axes.
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

    pub(super) fn at(&self, p: DVec2) -> DVec2 {
        self.to + (p - self.from) * self.scale
    }

    pub(super) fn all(&self, points: &[DVec2]) -> Vec<DVec2> {
        points.iter().map(|&p| self.at(p)).collect()
    }

    /// A direction of the area on the sheet, of length 1.
    pub(super) fn way(&self, v: DVec2) -> DVec2 {
        (v * self.scale).normalize_or_zero()
    }
}
