//! Draws a scene as SVG.
//!
//! The order from bottom to top is: lines on the ground, areas, lines, areas above, words.

use std::collections::HashSet;

use colltrans_picture::{Depth, Facet, Frame, Page, Raster, escape_xml, sort_back_to_front};
use glam::{DVec2, DVec3};

use super::scene::{Area, Line, Scene, Segment, Styles};

/// Width of the stroke around an opaque area, in pixels, so that no gaps show between neighbouring areas.
const RIM: f64 = 0.7;
const WORDS: &str = r#"font-size="14" font-style="italic""#;

/// Draws a scene and returns the text of the SVG file.
pub(crate) fn draw_scene(scene: &Scene) -> String {
    let Styles { size, ground, text, words, .. } = &scene.styles;
    let size = DVec2::from_array(*size);
    let window = Frame { low: DVec2::ZERO, high: size };
    let mut page = Page::new(window);
    let lines = Lines::new(scene, window);
    lines.draw(&mut page, |style| style.below);
    draw_areas(&mut page, scene, window, |area| !area.above);
    lines.draw(&mut page, |style| !style.below);
    draw_areas(&mut page, scene, window, |area| area.above);
    for word in words {
        let look = format!(r#"{WORDS} fill="{}""#, escape_xml(text));
        page.text(DVec2::from_array(word.at), "middle", &look, &word.text);
    }
    page.standalone(size, ground)
}

/// Draws areas. Neighbours in depth order with the same style become one path.
fn draw_areas(page: &mut Page, scene: &Scene, window: Frame, some: impl Fn(&Area) -> bool) {
    let style = |facet: &Facet| &scene.styles.areas[facet.style as usize];
    let facets = scene.triangles.iter().map(|(facet, _)| *facet).filter(|f| some(style(f)));
    let painted = sort_back_to_front(facets.collect(), window, Depth::Inverse, scene.styles.slack);
    for same in painted.chunk_by(|a, b| a.style == b.style) {
        let Area { fill, opacity, .. } = style(&same[0]);
        let fill = escape_xml(fill);
        let look = if same[0].opaque {
            format!(r#"fill="{fill}" stroke="{fill}" stroke-width="{RIM}""#)
        } else {
            format!(r#"fill="{fill}" fill-opacity="{opacity}""#)
        };
        page.polygons(&look, same.iter().map(oriented_corners));
    }
}

/// Returns a triangle with a fixed orientation, so that overlapping triangles in a path add up and make no
/// holes.
fn oriented_corners(facet: &Facet) -> Vec<DVec2> {
    let [a, b, c] = facet.corners.map(DVec3::truncate);
    if (b - a).perp_dot(c - a) > 0.0 { vec![a, b, c] } else { vec![a, c, b] }
}

/// The lines of a scene, and the depth buffer that hides parts of them.
struct Lines<'a> {
    scene: &'a Scene,
    raster: Raster,
    /// The numbers of the opaque triangles in the depth buffer.
    drawn: HashSet<u32>,
}

impl<'a> Lines<'a> {
    fn new(scene: &'a Scene, window: Frame) -> Self {
        let mut raster = Raster::new(window).with_depths(Depth::Inverse);
        let mut drawn = HashSet::new();
        for (facet, number) in &scene.triangles {
            if facet.opaque && !scene.styles.areas[facet.style as usize].above {
                raster.draw(facet.corners, *number);
                drawn.insert(*number);
            }
        }
        Self { scene, raster, drawn }
    }

    fn draw(&self, page: &mut Page, some: impl Fn(&Line) -> bool) {
        let styles = &self.scene.styles.lines;
        for same in self.scene.segments.chunk_by(|a, b| a.style == b.style) {
            let Line { colour, opacity, dash, .. } = match &styles[same[0].style as usize] {
                style if some(style) => style,
                _ => continue,
            };
            let ends = match dash {
                Some(dash) => format!(r#"stroke-linecap="butt" stroke-dasharray="{dash:.2}""#),
                None => r#"stroke-linecap="round""#.to_owned(),
            };
            let look =
                format!(r#"stroke="{}" stroke-opacity="{opacity}" {ends}"#, escape_xml(colour));
            page.lines(&look, same.iter().flat_map(|segment| self.visible_parts(segment)));
        }
    }

    /// Returns the visible parts of a segment. An edge is hidden if none of its triangles is drawn.
    fn visible_parts(&self, Segment { ends, adjacent, .. }: &Segment) -> Vec<[DVec2; 2]> {
        if !adjacent.is_empty() && !adjacent.iter().any(|number| self.drawn.contains(number)) {
            return Vec::new();
        }
        let [seen, _] = self.raster.split_edge(*ends, self.scene.styles.slack, adjacent);
        seen
    }
}
