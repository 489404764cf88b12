//! A plane through the place where two parts meet, with their outlines in it as SVG. `snapshot` draws what is
//! behind it.
//!
//! Notation. `n` is the unit normal of the plane, towards the viewer. The height of a vertex `v` is `n · (v − at)`.
//! - Each vertex is above the plane (height at least 0) or below, decided once. Both facets at an edge therefore cross
//!   the plane in the same point of the edge, and the outlines of closed shells are closed.
//! - Boxes of facets that the plane misses are skipped. The work is then proportional to the facets near the plane.
//! - Outlines run counter-clockwise around material in the picture. The winding number is positive inside a body, also in
//!   a union of pieces that overlap, and 0 in cavities.

#[cfg(feature = "bcf")]
pub(super) mod snapshot;

use std::collections::HashMap;
use std::ops::Range;

use colltrans::{Aabb, Solid};
use colltrans_picture::{
    ARROW_WIDTH, CONTACT, EDGE_WIDTH, FIXED, Frame, GUIDE_WIDTH, INK, MOVING, Page, Paint, SHADES,
    Stroke,
};
use glam::{DVec2, DVec3};

use super::short_number;

/// Size of pictures in pixels.
const SIZE: DVec2 = DVec2::new(640.0, 400.0);
/// Colours of the first and of the second part.
const PAINTS: [&Paint; 2] = [&MOVING, &FIXED];
/// Shades of the material of both parts in the plane.
const CUT_SHADES: [usize; 2] = [SHADES / 3, SHADES / 2];
/// Shortest arrow in pixels. Shorter displacements are drawn with this length.
const SHORTEST_ARROW: f64 = 26.0;
/// Maximum length of the scale bar in pixels.
const LONGEST_BAR: f64 = 120.0;
/// A line that a picture shows, relative to the place.
pub(super) struct Measure {
    /// Ends of the line. An arrow begins at the first one.
    pub(super) ends: [DVec3; 2],
    /// Whether the line is the displacement of the first part.
    pub(super) is_arrow: bool,
    /// Length as text; empty for a point.
    pub(super) label: String,
}

/// A plane through the place where two parts meet, and the window of its pictures.
pub(super) struct Cut {
    /// The place, in the world.
    pub(super) at: DVec3,
    /// Half the height of the window, in world units.
    pub(super) radius: f64,
    right: DVec3,
    upward: DVec3,
    /// Unit normal of the plane, towards the viewer.
    pub(super) normal: DVec3,
    measure: Option<Measure>,
}

impl Cut {
    /// Chooses the plane and the window. The plane contains the measured line and, if possible, the longest side of the
    /// common part, whose box is `common`, or of the common part of the boxes of both parts. `up` is the upward
    /// direction of the assembly.
    pub(super) fn new(
        boxes: [Aabb; 2],
        at: DVec3,
        common: Option<Aabb>,
        measure: Option<Measure>,
        up: DVec3,
    ) -> Self {
        let of_boxes = boxes[0].high.min(boxes[1].high) - boxes[0].low.max(boxes[1].low);
        let sides = common.map_or(of_boxes.max(DVec3::ZERO), |within| within.high - within.low);
        let line =
            measure.as_ref().map_or(DVec3::ZERO, |measure| measure.ends[1] - measure.ends[0]);
        let along = line.try_normalize().unwrap_or(up);
        let mut axes = [0, 1, 2];
        axes.sort_by(|i, j| sides[*j].total_cmp(&sides[*i]));
        let across =
            axes.map(|k| DVec3::AXES[k]).into_iter().find(|axis| axis.dot(along).abs() < 0.8);
        let normal = along.cross(across.unwrap_or(DVec3::X)).normalize();
        // The default view is from above, in front, on the right.
        let from = up + 1.5 * up.any_orthonormal_vector();
        let normal = if normal.dot(from) < 0.0 { -normal } else { normal };
        let up = if up.dot(normal).abs() < 0.9 { up } else { along };
        let right = up.cross(normal).normalize();
        let whole = |within: Aabb| (within.high - within.low).length();
        let smaller = whole(boxes[0]).min(whole(boxes[1]));
        let most = 0.55 * whole(boxes[0].union(&boxes[1]));
        let of_common = common.map_or(0.0, |_| 0.7 * sides.length());
        let wanted = of_common.max(3.0 * line.length()).max(0.1 * smaller);
        let radius = wanted.min(most).max(f64::MIN_POSITIVE);
        Self { at, radius, right, upward: normal.cross(right), normal, measure }
    }

    /// Draws the outlines of both parts, their common part, and the measured line. `name` identifies the picture in its
    /// page, and `label` is its alternative text.
    pub(super) fn section(
        &self,
        solids: [&Solid; 2],
        unit: &str,
        name: &str,
        label: &str,
    ) -> String {
        let scale = 0.5 * SIZE.y / self.radius;
        let on_page = |flat: DVec2| 0.5 * SIZE + flat * DVec2::new(1.0, -1.0) * scale;
        let outlines = solids.map(|solid| {
            let mut all = self.outlines(solid);
            for outline in &mut all {
                outline.points.iter_mut().for_each(|point| *point = on_page(*point));
                // Points less than a tenth of a pixel apart are drawn as one.
                let mut last = DVec2::INFINITY;
                outline.points.retain(|point| {
                    let is_apart = last.distance_squared(*point) > 0.01;
                    last = if is_apart { *point } else { last };
                    is_apart
                });
            }
            all
        });
        let closed = |k: usize| {
            let all = outlines[k].iter().filter(|outline| outline.is_closed);
            all.map(|outline| outline.points.clone())
        };
        let window = Frame { low: DVec2::ZERO, high: SIZE };
        let mut page = Page::new(window);
        for k in 0..2 {
            let look = format!(r#"fill="{}""#, PAINTS[k].shade(CUT_SHADES[k]));
            page.polygons(&look, closed(k));
        }
        page.clip_path(name, closed(0));
        page.open_group(&format!(r#"clip-path="url(#{name})""#));
        page.polygons(&format!(r#"fill="{CONTACT}" fill-opacity="0.72""#), closed(1));
        page.close_group();
        for (all, paint) in outlines.iter().zip(PAINTS) {
            for Outline { points, is_closed } in all {
                let mut points = points.clone();
                points.extend(points.first().copied().filter(|_| *is_closed));
                page.polyline(Stroke::solid(paint.line, 1.2 * EDGE_WIDTH), &points);
            }
        }
        if let Some(measure) = &self.measure {
            let ends = measure
                .ends
                .map(|end| on_page(DVec2::new(self.right.dot(end), self.upward.dot(end))));
            draw_measure(&mut page, measure, ends);
        }
        draw_scale(&mut page, scale, unit);
        page.inline(SIZE, label)
    }

    /// Returns ranges of facets with all facets that cross the plane.
    fn crossed_facets(&self, solid: &Solid) -> Vec<Range<usize>> {
        let Aabb { low, high } = solid.bounds();
        let size = (low.abs().max(high.abs()) + self.at.abs()).element_sum();
        // Covers the rounding of heights: all vertices in a box that is skipped are on one side of the plane.
        let slack = 32.0 * f64::EPSILON * size;
        facets_in(solid, |within| {
            let [low, high] = height_range(within, self.at, self.normal);
            low <= slack && high >= -slack
        })
    }

    /// Returns the outlines of a body in the plane, in coordinates of the plane.
    fn outlines(&self, solid: &Solid) -> Vec<Outline> {
        let place = |v: u32| {
            let by = solid.vertices()[v as usize] - self.at;
            DVec3::new(self.right.dot(by), self.upward.dot(by), self.normal.dot(by))
        };
        let is_above = |v: u32| place(v).z >= 0.0;
        // Segments between crossed edges, which are ordered pairs of vertices.
        let mut segments: Vec<[[u32; 2]; 2]> = Vec::new();
        for t in self.crossed_facets(solid).into_iter().flatten() {
            let t = solid.triangles()[t];
            let (mut from, mut to) = (None, None);
            for (v, w) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
                match (is_above(v), is_above(w)) {
                    (true, false) => from = Some([v.min(w), v.max(w)]),
                    (false, true) => to = Some([v.min(w), v.max(w)]),
                    _ => {}
                }
            }
            segments.extend(from.zip(to).map(|(from, to)| [from, to]));
        }
        let mut leaving = HashMap::<[u32; 2], Vec<usize>>::new();
        for (k, [from, _]) in segments.iter().enumerate().rev() {
            leaving.entry(*from).or_default().push(k);
        }
        let crossing = |[v, w]: [u32; 2]| {
            let (p, q) = (place(v), place(w));
            p.truncate().lerp(q.truncate(), p.z / (p.z - q.z))
        };
        let mut is_used = vec![false; segments.len()];
        let mut all = Vec::new();
        for first in 0..segments.len() {
            if is_used[first] {
                continue;
            }
            let start = segments[first][0];
            let mut points = vec![crossing(start)];
            let mut next = Some(first);
            let mut end = start;
            while let Some(k) = next {
                is_used[k] = true;
                end = segments[k][1];
                if end == start {
                    break;
                }
                points.push(crossing(end));
                let others = leaving.get_mut(&end);
                next = others.and_then(|all| {
                    while all.last().is_some_and(|k| is_used[*k]) {
                        all.pop();
                    }
                    all.last().copied()
                });
            }
            all.push(Outline { points, is_closed: end == start });
        }
        all
    }
}

/// Returns the ranges of facets below the nodes of the tree whose boxes are all accepted, in ascending order.
fn facets_in(solid: &Solid, accepts: impl Fn(&Aabb) -> bool) -> Vec<Range<usize>> {
    let nodes = solid.nodes();
    let (mut found, mut stack) = (Vec::new(), vec![0]);
    while let Some(at) = stack.pop() {
        let Some(node) = nodes.get(at).filter(|node| accepts(&node.bounds)) else { continue };
        if node.is_leaf() {
            found.push(node.facets());
        } else {
            let child = at + node.child_offset as usize;
            stack.extend([child + 1, child]);
        }
    }
    found.sort_by_key(|facets| facets.start);
    found
}

/// Returns the range of `n · (x − at)` over the points `x` of a box.
fn height_range(within: &Aabb, at: DVec3, n: DVec3) -> [f64; 2] {
    let middle = n.dot(within.center() - at);
    let half = n.abs().dot(0.5 * (within.high - within.low));
    [middle - half, middle + half]
}

/// A line in which a body crosses the plane.
struct Outline {
    points: Vec<DVec2>,
    /// Whether the last point is joined to the first one. Only outlines of open surfaces are not.
    is_closed: bool,
}

/// Returns the ends of an arrow of at least [`SHORTEST_ARROW`] in its direction.
fn visible_arrow([from, to]: [DVec2; 2]) -> [DVec2; 2] {
    let along = (to - from).try_normalize().unwrap_or(DVec2::NEG_Y);
    [from, from + along * from.distance(to).max(SHORTEST_ARROW)]
}

/// Draws a measured line with its label.
fn draw_measure(page: &mut Page, measure: &Measure, ends: [DVec2; 2]) {
    let ends = if measure.is_arrow { visible_arrow(ends) } else { ends };
    if measure.is_arrow {
        page.arrow(CONTACT, ARROW_WIDTH, ends);
    } else {
        page.haloed(Stroke::solid(CONTACT, ARROW_WIDTH), ends);
        for end in ends {
            page.dot(end, 2.5, CONTACT, "#ffffff");
        }
    }
    if measure.label.is_empty() {
        return;
    }
    let along = (ends[1] - ends[0]).try_normalize().unwrap_or(DVec2::NEG_Y);
    let room = DVec2::new(4.6 * measure.label.chars().count() as f64 + 8.0, 12.0);
    let beyond = ends[1] + along * (8.0 + (along * room).abs().element_sum());
    let at = beyond.clamp(room, SIZE - room);
    page.label(
        at,
        &format!(r#"font-size="15" font-weight="600" fill="{CONTACT}""#),
        &measure.label,
    );
}

/// Draws a scale bar whose length is 1, 2 or 5 times a power of ten.
fn draw_scale(page: &mut Page, scale: f64, unit: &str) {
    let longest = LONGEST_BAR / scale;
    let power = 10_f64.powf(longest.log10().floor());
    let length = [5.0, 2.0, 1.0].map(|k| k * power).into_iter().find(|x| *x <= longest);
    let length = length.unwrap_or(power);
    let from = DVec2::new(16.0, SIZE.y - 16.0);
    let to = from + DVec2::new(length * scale, 0.0);
    let tick = DVec2::new(0.0, 4.0);
    let stroke = Stroke::solid(INK, GUIDE_WIDTH);
    for segment in [[from, to], [from - tick, from + tick], [to - tick, to + tick]] {
        page.haloed(stroke, segment);
    }
    let text = format!("{} {unit}", short_number(length));
    let at = from.lerp(to, 0.5) - DVec2::new(0.0, 13.0);
    page.label(at, &format!(r#"font-size="12" fill="{INK}""#), text.trim());
}

#[cfg(test)]
mod tests {
    use colltrans_mesh::Mesh;
    use colltrans_testkit::random::Random;
    use colltrans_testkit::shapes::{block, ring_sphere};
    use glam::{DAffine3, DQuat};

    use super::*;
    use crate::part::{Part, Piece};

    /// Builds a part of boxes, turned and moved.
    fn part_of(boxes: &[[[f64; 3]; 2]], pose: DAffine3) -> Part {
        let piece = |[low, high]: &[[f64; 3]; 2]| {
            let mesh = block(*low, *high);
            Piece { mesh: Mesh::new(mesh.vertices, mesh.faces), world_from_piece: pose }
        };
        Part::new("part", &boxes.iter().map(piece).collect::<Vec<_>>()).unwrap()
    }

    /// Returns a cut through a point with a normal.
    fn cut_at(at: DVec3, normal: DVec3) -> Cut {
        let right = normal.any_orthonormal_vector();
        Cut { at, radius: 4.0, right, upward: normal.cross(right), normal, measure: None }
    }

    /// Displacement that separates the boxes.
    const WAY: DVec3 = DVec3::new(-0.5, 0.0, 0.0);

    /// Returns two boxes that overlap by 0.5 along x, and the cut through the middle of their common part.
    pub(super) fn overlapping_boxes() -> ([Part; 2], Cut) {
        let parts = [[[0.0; 3], [2.0; 3]], [[1.5, 0.0, 0.0], [4.0, 2.0, 2.0]]];
        let parts = parts.map(|corners| part_of(&[corners], DAffine3::IDENTITY));
        let boxes = parts.each_ref().map(Part::bounds);
        let common = Aabb { low: DVec3::new(1.5, 0.0, 0.0), high: DVec3::splat(2.0) };
        let label = "0.5 mm".to_owned();
        let measure = Some(Measure { ends: [DVec3::ZERO, WAY], is_arrow: true, label });
        let cut = Cut::new(boxes, common.center(), Some(common), measure, DVec3::Z);
        (parts, cut)
    }

    fn signed_area(outlines: &[Outline]) -> f64 {
        let area = |points: &[DVec2]| {
            let next = points.iter().cycle().skip(1);
            points.iter().zip(next).map(|(p, q)| 0.5 * p.perp_dot(*q)).sum::<f64>()
        };
        outlines.iter().map(|outline| area(&outline.points)).sum()
    }

    #[test]
    fn outlines_of_turned_boxes_have_the_area_of_the_section() {
        let mut random = Random::new(11);
        for _ in 0..200 {
            let turn = DQuat::from_xyzw(
                random.unit() - 0.5,
                random.unit() - 0.5,
                random.unit() - 0.5,
                random.unit() - 0.5,
            );
            let pose = DAffine3::from_rotation_translation(turn.normalize(), DVec3::splat(7.0));
            let part = part_of(&[[[0.0; 3], [2.0, 3.0, 5.0]]], pose);
            // Planes parallel to a side of the box, at several heights.
            let height = 5.0 * random.unit();
            let at = pose.transform_point3(DVec3::new(1.0, 1.0, height));
            let all = cut_at(at, pose.transform_vector3(DVec3::Z)).outlines(part.solid());
            assert!(all.len() == 1 && all[0].is_closed);
            assert!((signed_area(&all) - 6.0).abs() < 1e-12, "{}", signed_area(&all));
            // Any other plane: the outline is closed, and runs counter-clockwise.
            let normal =
                (turn.normalize() * DVec3::new(random.unit(), 1.0, random.unit())).normalize();
            let all = cut_at(at, normal).outlines(part.solid());
            assert!(all.iter().all(|outline| outline.is_closed) && signed_area(&all) > 0.0);
        }
    }

    #[test]
    fn plane_through_vertices_and_facets_has_closed_outlines() {
        // A ring of four boxes that overlap at its corners.
        let ring = [
            [[0.0, 0.0, 0.0], [4.0, 1.0, 1.0]],
            [[0.0, 3.0, 0.0], [4.0, 4.0, 1.0]],
            [[0.0, 0.0, 0.0], [1.0, 4.0, 1.0]],
            [[3.0, 0.0, 0.0], [4.0, 4.0, 1.0]],
        ];
        let part = part_of(&ring, DAffine3::IDENTITY);
        for height in [0.0, 0.25, 1.0, 1.5] {
            let all = cut_at(DVec3::new(2.0, 2.0, height), DVec3::Z).outlines(part.solid());
            assert!(all.iter().all(|outline| outline.is_closed), "{height}");
            let inside = height > 0.0 && height <= 1.0;
            assert_eq!(signed_area(&all), if inside { 16.0 } else { 0.0 }, "{height}");
        }
    }

    #[test]
    fn few_facets_are_examined_and_all_that_cross_the_plane() {
        let mesh = ring_sphere(64, 64);
        let mesh = Mesh::new(mesh.vertices, mesh.faces);
        let piece = Piece { mesh, world_from_piece: DAffine3::from_translation(DVec3::splat(1e3)) };
        let part = Part::new("ball", &[piece]).unwrap();
        let (solid, mut random) = (part.solid(), Random::new(20));
        for _ in 0..100 {
            let normal = DVec3::from_array([0; 3].map(|_| random.unit() - 0.5)).normalize();
            // Some planes pass through a vertex.
            let vertex = solid.vertices()[(random.unit() * 100.0) as usize];
            let at = if random.unit() < 0.5 { vertex } else { solid.bounds().center() };
            let cut = cut_at(at, normal);
            let ranges = cut.crossed_facets(solid);
            let is_above = |v: u32| normal.dot(solid.vertices()[v as usize] - at) >= 0.0;
            for (t, corners) in solid.triangles().iter().enumerate() {
                let above = corners.iter().filter(|v| is_above(**v)).count();
                let is_found = ranges.iter().any(|facets| facets.contains(&t));
                assert!(is_found || above == 0 || above == 3, "{t}");
            }
            let examined: usize = ranges.iter().map(ExactSizeIterator::len).sum();
            assert!(5 * examined < solid.triangles().len(), "{examined}");
            assert!(cut.outlines(solid).iter().all(|outline| outline.is_closed));
        }
    }

    #[test]
    fn section_has_both_parts_and_an_arrow() {
        let (parts, cut) = overlapping_boxes();
        assert!(cut.normal.dot(WAY).abs() < 1e-12);
        let solids = parts.each_ref().map(Part::solid);
        let svg = cut.section(solids, "mm", "cut-0", "a < b");
        assert!(svg.contains("a &lt; b") && svg.contains("url(#cut-0)") && svg.contains("0.5 mm"));
        assert!(svg.len() < 4_000, "{}", svg.len());
    }
}
