//! Writes a page of shapes in page coordinates (pixels, y downwards) as SVG.
//!
//! Shapes that may extend far beyond the page are clipped to a frame around it, because renderers store
//! coordinates in few bits.

use std::fmt::Write as _;

use glam::DVec2;

use crate::style::FONT;

/// Colour, width and dashes of a line.
#[derive(Debug, Clone, Copy)]
pub struct Stroke {
    /// The colour in SVG notation.
    pub colour: &'static str,
    /// The width in pixels.
    pub width: f64,
    /// The lengths of dashes and gaps, in SVG notation.
    pub dashes: Option<&'static str>,
}

impl Stroke {
    /// Returns a solid line.
    pub const fn solid(colour: &'static str, width: f64) -> Self {
        Self { colour, width, dashes: None }
    }

    /// Returns a dashed line.
    pub const fn dashed(colour: &'static str, width: f64, dashes: &'static str) -> Self {
        Self { colour, width, dashes: Some(dashes) }
    }

    /// Returns the attributes of SVG.
    fn svg_attributes(self) -> String {
        let Self { colour, width, dashes } = self;
        let dashes = dashes.map(|d| format!(r#" stroke-dasharray="{d}""#)).unwrap_or_default();
        format!(r#"stroke="{colour}" stroke-width="{width}"{dashes}"#)
    }
}

/// An axis-aligned rectangle.
#[derive(Debug, Clone, Copy)]
pub struct Frame {
    /// The smallest coordinates.
    pub low: DVec2,
    /// The largest coordinates.
    pub high: DVec2,
}

impl Frame {
    /// Returns the part of a convex polygon inside the frame.
    fn clip_polygon(&self, polygon: &[DVec2]) -> Vec<DVec2> {
        let mut kept = polygon.to_vec();
        for side in self.side_distances() {
            let inside = std::mem::take(&mut kept);
            for (i, &to) in inside.iter().enumerate() {
                let from = inside[(i + inside.len() - 1) % inside.len()];
                let (at_from, at_to) = (side(from), side(to));
                if (at_from < 0.0) != (at_to < 0.0) {
                    kept.push(from.lerp(to, at_from / (at_from - at_to)));
                }
                if at_to >= 0.0 {
                    kept.push(to);
                }
            }
        }
        kept
    }

    /// Returns the part of a segment inside the frame; `None` if it is empty, or an end is not finite.
    pub fn clip_segment(&self, [mut a, mut b]: [DVec2; 2]) -> Option<[DVec2; 2]> {
        if !(a.is_finite() && b.is_finite()) {
            return None;
        }
        for side in self.side_distances() {
            let (at_a, at_b) = (side(a), side(b));
            if at_a < 0.0 && at_b < 0.0 {
                return None;
            }
            let cut = a.lerp(b, at_a / (at_a - at_b));
            if at_a < 0.0 {
                a = cut;
            } else if at_b < 0.0 {
                b = cut;
            }
        }
        Some([a, b])
    }

    /// Returns for each side a function for the distance of a point, positive inside.
    fn side_distances(&self) -> [impl Fn(DVec2) -> f64; 4] {
        let Self { low, high } = *self;
        let side = |normal: DVec2, offset: f64| move |p: DVec2| p.dot(normal) - offset;
        [
            side(DVec2::X, low.x),
            side(DVec2::NEG_X, -high.x),
            side(DVec2::Y, low.y),
            side(DVec2::NEG_Y, -high.y),
        ]
    }
}

/// The body of an SVG file while it is written.
pub struct Page {
    body: String,
    frame: Frame,
}

impl Page {
    /// Builds a page whose shapes are clipped to `frame` and a margin around it.
    pub fn new(frame: Frame) -> Self {
        let margin = DVec2::splat(20.0);
        let frame = Frame { low: frame.low - margin, high: frame.high + margin };
        Self { body: String::new(), frame }
    }

    /// Opens a group with these attributes. It ends with [`Self::close_group`].
    pub fn open_group(&mut self, attributes: &str) {
        let _ = writeln!(self.body, "<g {attributes}>");
    }

    /// Closes the group of [`Self::open_group`].
    pub fn close_group(&mut self) {
        self.body.push_str("</g>\n");
    }

    /// Writes axis-aligned rectangles with the same attributes, given as left, top, right and bottom in whole
    /// pixels. They must be inside the frame.
    pub fn tiles(&mut self, look: &str, all: &[[usize; 4]]) {
        let mut data = String::new();
        for [x, y, right, bottom] in all {
            let (width, height) = (right - x, bottom - y);
            let _ = write!(data, "M{x} {y}h{width}v{height}h-{width}z");
        }
        self.write_path(look, &data);
    }

    /// Writes polygons with the same attributes as one path. Of a polygon that is not convex, the parts inside the
    /// frame may be joined along its margin, outside of the picture.
    pub fn polygons<I: IntoIterator<Item = Vec<DVec2>>>(&mut self, look: &str, all: I) {
        let mut data = String::new();
        for polygon in all {
            push_path(&mut data, &self.frame.clip_polygon(&polygon), true);
        }
        self.write_path(look, &data);
    }

    /// Writes a clip path of polygons for groups with the attribute `clip-path="url(#NAME)"`. The name must be unique
    /// in a document.
    pub fn clip_path<I: IntoIterator<Item = Vec<DVec2>>>(&mut self, name: &str, all: I) {
        let name = escape_xml(name);
        let _ = write!(self.body, r#"<clipPath id="{name}">"#);
        self.polygons("", all);
        self.body.push_str("</clipPath>\n");
    }

    /// Writes segments with the same stroke.
    pub fn segments<I: IntoIterator<Item = [DVec2; 2]>>(&mut self, stroke: Stroke, all: I) {
        self.lines(&stroke.svg_attributes(), all);
    }

    /// Writes segments with the same attributes.
    pub fn lines<I: IntoIterator<Item = [DVec2; 2]>>(&mut self, look: &str, all: I) {
        let mut data = String::new();
        for segment in all {
            if let Some(kept) = self.frame.clip_segment(segment) {
                push_path(&mut data, &kept, false);
            }
        }
        self.write_path(&format!(r#"fill="none" {look}"#), &data);
    }

    /// Writes a line through points as one path, so that dashes continue at its bends.
    pub fn polyline(&mut self, stroke: Stroke, points: &[DVec2]) {
        let mut pieces: Vec<Vec<DVec2>> = Vec::new();
        for ends in points.windows(2) {
            let Some([from, to]) = self.frame.clip_segment([ends[0], ends[1]]) else { continue };
            match pieces.last_mut() {
                Some(piece) if piece.last() == Some(&from) => piece.push(to),
                _ => pieces.push(vec![from, to]),
            }
        }
        let mut data = String::new();
        for piece in &pieces {
            push_path(&mut data, piece, false);
        }
        self.write_path(&format!(r#"fill="none" {}"#, stroke.svg_attributes()), &data);
    }

    /// Writes a path, unless it is empty.
    fn write_path(&mut self, look: &str, data: &str) {
        if !data.is_empty() {
            let _ = writeln!(self.body, r#"<path {look} d="{data}"/>"#);
        }
    }

    /// Writes a line with a white halo that separates it from shapes behind it.
    pub fn haloed(&mut self, stroke: Stroke, segment: [DVec2; 2]) {
        self.segments(Stroke::solid("#ffffff", stroke.width + 2.4), [segment]);
        self.segments(stroke, [segment]);
    }

    /// Writes an arrow with its head at the second end.
    pub fn arrow(&mut self, colour: &'static str, width: f64, [tail, tip]: [DVec2; 2]) {
        let along = (tip - tail).normalize_or_zero();
        let across = along.perp();
        let length = (4.5 * width + 3.0).min((tip - tail).length());
        let base = tip - along * length;
        self.haloed(Stroke::solid(colour, width), [tail, base + along * (0.3 * length)]);
        let look = format!(r##"fill="{colour}" stroke="#ffffff" stroke-width="0.8""##);
        let half = across * (0.36 * length);
        self.polygons(&look, [vec![tip, base + half, base + along * (0.2 * length), base - half]]);
    }

    /// Writes a filled circle with an outline.
    pub fn dot(&mut self, at: DVec2, radius: f64, fill: &str, rim: &str) {
        let (x, y) = (format_coordinate(at.x), format_coordinate(at.y));
        let _ = writeln!(
            self.body,
            r#"<circle cx="{x}" cy="{y}" r="{radius}" fill="{fill}" stroke="{rim}" stroke-width="1.2"/>"#
        );
    }

    /// Writes text with a white halo, centred at a point.
    pub fn label(&mut self, centre: DVec2, look: &str, text: &str) {
        // The baseline is a third of a letter's height below the centre.
        let at = centre + DVec2::new(0.0, 5.0);
        let rim = r##"stroke="#ffffff" stroke-width="3.5" stroke-linejoin="round""##;
        // The text is written twice, because some programs do not support `paint-order`.
        self.text(at, "middle", &format!("{look} {rim}"), text);
        self.text(at, "middle", look, text);
    }

    /// Writes text at a baseline. The `anchor` is `start`, `middle` or `end`.
    pub fn text(&mut self, at: DVec2, anchor: &str, look: &str, text: &str) {
        let (x, y) = (format_coordinate(at.x), format_coordinate(at.y));
        let text = escape_xml(text);
        let _ = writeln!(
            self.body,
            r#"<text x="{x}" y="{y}" text-anchor="{anchor}" {look}>{text}</text>"#
        );
    }

    /// Writes a rectangle with these attributes.
    pub fn rectangle(&mut self, look: &str, frame: Frame) {
        let size = frame.high - frame.low;
        let _ = writeln!(
            self.body,
            r#"<rect x="{}" y="{}" width="{}" height="{}" {look}/>"#,
            format_coordinate(frame.low.x),
            format_coordinate(frame.low.y),
            format_coordinate(size.x),
            format_coordinate(size.y)
        );
    }

    /// Returns a picture to embed in a web page, as wide as its container. The `label` is its alternative text.
    pub fn inline(self, size: DVec2, label: &str) -> String {
        let told = format!(r#" role="img" aria-label="{}""#, escape_xml(label));
        self.with_background(&told, size, "#ffffff")
    }

    /// Returns a separate picture with a background of this colour.
    pub fn standalone(self, size: DVec2, ground: &str) -> String {
        let DVec2 { x: width, y: height } = size;
        self.with_background(
            &format!(r#" width="{width}" height="{height}""#),
            size,
            &escape_xml(ground),
        )
    }

    /// Returns the SVG element with a background.
    fn with_background(
        self,
        extent: &str,
        DVec2 { x: width, y: height }: DVec2,
        ground: &str,
    ) -> String {
        let ground = format!(r#"<rect width="100%" height="100%" fill="{ground}"/>"#);
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\"{extent} viewBox=\"0 0 {width} {height}\" \
             font-family=\"{FONT}\" stroke-linecap=\"round\" stroke-linejoin=\"round\">\n{ground}\n{}</svg>\n",
            self.body
        )
    }

    /// Returns the SVG file. The window is the clip path `window`.
    pub fn finish(self, size: DVec2, window: Frame, title: &str) -> String {
        let DVec2 { x: width, y: height } = size;
        let mut text = String::new();
        let _ = writeln!(
            text,
            r#"<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" viewBox="0 0 {width} {height}" font-family="{FONT}" stroke-linecap="round" stroke-linejoin="round">"#
        );
        let _ = writeln!(text, "<title>{}</title>", escape_xml(title));
        let mut clip = Self::new(window);
        clip.rectangle("", window);
        let _ = writeln!(text, "<defs><clipPath id=\"window\">{}</clipPath></defs>", clip.body);
        let _ = writeln!(text, r##"<rect width="{width}" height="{height}" fill="#ffffff"/>"##);
        text.push_str(&self.body);
        text.push_str("</svg>\n");
        text
    }
}

/// Escapes a text for elements and attributes of HTML and XML. Characters that XML cannot represent (XML 1.0,
/// 2.2, *Char*), for example control codes, are replaced by U+FFFD.
pub fn escape_xml(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            '\0'..='\u{8}' | '\u{b}' | '\u{c}' | '\u{e}'..='\u{1f}' | '\u{fffe}' | '\u{ffff}' => {
                safe.push('\u{fffd}');
            }
            c => safe.push(c),
        }
    }
    safe
}

/// Appends a path to the data.
fn push_path(data: &mut String, points: &[DVec2], closed: bool) {
    let Some((first, rest)) = points.split_first() else { return };
    let _ = write!(data, "M{} {}", format_coordinate(first.x), format_coordinate(first.y));
    for point in rest {
        let _ = write!(data, "L{} {}", format_coordinate(point.x), format_coordinate(point.y));
    }
    if closed {
        data.push('Z');
    }
}

/// Formats a coordinate with a tenth of a pixel, which is finer than any line.
fn format_coordinate(value: f64) -> String {
    let text = format!("{value:.1}");
    let text = text.strip_suffix(".0").unwrap_or(&text);
    if text == "-0" { "0".into() } else { text.into() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hostile_text_is_escaped() {
        let hostile = "</text><script>\"'&\u{1b}[31m\0";
        let text = escape_xml(hostile);
        assert_eq!(text, "&lt;/text&gt;&lt;script&gt;&quot;'&amp;\u{fffd}[31m\u{fffd}");
    }

    #[test]
    fn clipping_keeps_the_inside() {
        let frame = Frame { low: DVec2::ZERO, high: DVec2::ONE };
        let inside = [DVec2::new(0.2, 0.2), DVec2::new(0.8, 0.2), DVec2::new(0.5, 0.9)];
        assert_eq!(frame.clip_polygon(&inside), inside);
        let around = [DVec2::new(-1e9, -1e9), DVec2::new(3e9, -1e9), DVec2::new(-1e9, 3e9)];
        let cut = frame.clip_polygon(&around);
        assert!(cut.iter().all(|p| p.min_element() >= -1e-6 && p.max_element() <= 1.0 + 1e-6));
        let area: f64 =
            cut.iter().zip(cut.iter().cycle().skip(1)).map(|(a, b)| a.perp_dot(*b)).sum::<f64>();
        assert!((area / 2.0 - 1.0).abs() < 1e-6, "the whole frame: {area}");
        assert!(frame.clip_polygon(&inside.map(|p| p + 5.0)).is_empty());
        assert_eq!(
            frame.clip_segment([DVec2::new(-1.0, 0.5), DVec2::new(3.0, 0.5)]),
            Some([DVec2::new(0.0, 0.5), DVec2::new(1.0, 0.5)])
        );
        assert_eq!(frame.clip_segment([DVec2::new(-1.0, 0.5), DVec2::new(0.5, 3.0)]), None);
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert_eq!(frame.clip_segment([DVec2::new(bad, 0.5), DVec2::new(0.5, 0.5)]), None);
        }
    }

    #[test]
    fn polyline_is_one_path_unless_clipped() {
        let frame = Frame { low: DVec2::ZERO, high: DVec2::splat(100.0) };
        let drawn = |points: &[DVec2]| {
            let mut page = Page::new(frame);
            page.polyline(Stroke::dashed("red", 1.0, "5 4"), points);
            page.body
        };
        // Leaves the frame at the right, 20 beyond it, and enters it again.
        let bend = [[10.0, 21.0], [90.0, 29.0], [150.0, 35.0], [95.0, 60.0]].map(DVec2::from_array);
        let inside = drawn(&bend[..2]);
        assert!(inside.contains(r#"stroke-dasharray="5 4""#) && inside.matches('M').count() == 1);
        let cut = drawn(&bend);
        assert_eq!((cut.matches('M').count(), cut.matches("<path").count()), (2, 1), "{cut}");
        assert_eq!(drawn(&[DVec2::splat(300.0), DVec2::splat(400.0)]), "");
        assert_eq!(drawn(&bend[..1]), "");
    }
}
