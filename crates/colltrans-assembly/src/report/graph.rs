//! Directional blocking graphs as SVG. Parts are on a ring, clockwise from the top. An arrow leads from each part to
//! the parts that it meets. Groups of several parts that move as one are marked in red. Removable parts are filled in
//! orange.

use std::fmt::Write;

use colltrans_picture::{CONTACT, FINE_WIDTH, FONT, INK, QUIET};
use glam::DVec2;

use super::escape_xml;
use crate::blocking::BlockingGraph;
use crate::bodies::Bodies;

/// Radius of the ring in pixels.
const RADIUS: f64 = 175.0;
/// Centre of the ring in pixels.
const MIDDLE: DVec2 = DVec2::new(280.0, 200.0);

/// Draws the blocking graph of all parts along one direction.
pub fn blocking_graph_svg(bodies: &Bodies, graph: &BlockingGraph) -> String {
    let n = bodies.len();
    // Equal vertical distances keep the names apart.
    let at = |k: usize| {
        let (round, side) = if 2 * k < n { (k, 1.0) } else { (n - 1 - k, -1.0) };
        let height = (4 * round + 2) as f64 / n.max(1) as f64 - 1.0;
        let height = height.clamp(-1.0, 1.0);
        MIDDLE + DVec2::new(side * (1.0 - height * height).sqrt().max(0.3), height) * RADIUS
    };
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 560 400\" \
         font-family=\"{FONT}\" fill=\"{INK}\" font-size=\"12\">\n<rect width=\"560\" height=\"400\" \
         fill=\"#fff\"/>\n",
    );
    let groups = graph.strong_components();
    let mut group_of = vec![usize::MAX; n];
    for (k, group) in groups.iter().enumerate().filter(|(_, g)| g.len() > 1) {
        for &part in group {
            group_of[part] = k;
        }
    }
    let free: Vec<usize> = graph.removable_groups().concat();
    for a in 0..n {
        for b in graph.direct_blockers(a) {
            let (p, q) = (at(a), at(b));
            let along = (q - p).normalize_or_zero();
            let (p, q) = (p + along * 6.0, q - along * 7.0);
            let bend = (p + q) * 0.5 + (MIDDLE - (p + q) * 0.5) * 0.25;
            let inside = group_of[a] != usize::MAX && group_of[a] == group_of[b];
            let color = if inside { CONTACT } else { QUIET };
            let tip = (q - bend).normalize_or_zero();
            let (l, r) = (q - tip * 6.0 + tip.perp() * 2.2, q - tip * 6.0 - tip.perp() * 2.2);
            let _ = writeln!(
                text,
                "<path d=\"M{:.1} {:.1}Q{:.1} {:.1} {:.1} {:.1}\" fill=\"none\" stroke=\"{color}\" \
                 stroke-width=\"{FINE_WIDTH}\" stroke-opacity=\"0.7\"/><path d=\"M{:.1} {:.1}L{:.1} \
                 {:.1}L{:.1} {:.1}z\" fill=\"{color}\"/>",
                p.x, p.y, bend.x, bend.y, q.x, q.y, q.x, q.y, l.x, l.y, r.x, r.y
            );
        }
    }
    for (k, &group) in group_of.iter().enumerate() {
        draw_node(&mut text, at(k), bodies.assembly().parts()[k].name(), free.contains(&k), group);
    }
    text.push_str("</svg>\n");
    text
}

/// Draws a part with its name.
fn draw_node(text: &mut String, at: DVec2, name: &str, free: bool, group: usize) {
    let fill = if free { "#f6963a" } else { "#dde6f0" };
    let stroke = if group == usize::MAX { INK } else { CONTACT };
    let right = at.x >= MIDDLE.x;
    let (anchor, x) = if right { ("start", at.x + 9.0) } else { ("end", at.x - 9.0) };
    let _ = writeln!(
        text,
        "<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"5\" fill=\"{fill}\" stroke=\"{stroke}\"/>\
         <text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"{anchor}\">{}</text>",
        at.x,
        at.y,
        at.y + 4.0,
        escape_xml(name)
    );
}
