//! Pictures of two sections: their contact, their gap, and the reduction to the plane of one of them.

use glam::{DVec2, DVec3};

use super::Scene;
use super::planar::{Instance, Placed, View};
use super::sheet::{Anchor, Map, Sheet};

/// Draws the edges of a body viewed along a direction; hidden edges are dashed.
fn draw_outline(
    sheet: &mut Sheet,
    body: &Placed,
    [class, fill]: [&str; 2],
    seen: DVec3,
    place: impl Fn(DVec3) -> DVec2,
) {
    let faces_us = |face: usize| body.faces[face].0.dot(seen) < 0.0;
    for (face, (.., corners)) in body.faces.iter().enumerate() {
        if faces_us(face) {
            let around: Vec<DVec2> = corners.iter().map(|&v| place(body.vertices[v])).collect();
            sheet.polygon(fill, &around);
        }
    }
    let (mut clear, mut hidden) = (Vec::new(), Vec::new());
    for (ends, faces) in &body.edges {
        let line = ends.map(|v| place(body.vertices[v]));
        if faces.iter().any(|&face| faces_us(face)) { clear.push(line) } else { hidden.push(line) }
    }
    sheet.lines(&format!("{class} hidden"), &hidden);
    sheet.lines(class, &clear);
}

const MOVING: [&str; 2] = ["moving-line", "moving-body"];
const FIXED: [&str; 2] = ["fixed-line", "fixed-body"];
/// Entries of legends, and where those of figures 3 to 5 are.
const P_SECTION: (&str, &str, f64) = ("moving", "section of P", 108.0);
const Q_SECTION: (&str, &str, f64) = ("fixed", "section of Q", 108.0);
const FOOT: DVec2 = DVec2::new(26.0, 452.0);

/// Draws figures 3, 4 and 5: two sections and both cubes, viewed along the direction.
pub(super) fn sections_figure(view: &View, instance: &Instance, title: &str) -> String {
    let mut sheet = Sheet::new(title, 480.0, 470.0);
    let all: Vec<DVec2> =
        view.bodies.iter().flat_map(|b| b.vertices.iter().map(|&v| view.shadow(v))).collect();
    let map = Map::fitting(&all, [DVec2::new(24.0, 24.0), DVec2::new(456.0, 410.0)]);
    let place = |w: DVec3| map.at(view.shadow(w));
    draw_outline(&mut sheet, &view.bodies[1], FIXED, view.direction, place);
    draw_outline(&mut sheet, &view.bodies[0], MOVING, view.direction, place);
    let flat = instance
        .sections
        .each_ref()
        .map(|s| s.corners.iter().map(|&w| place(w)).collect::<Vec<_>>());
    sheet.polygon("fixed", &flat[1]);
    sheet.polygon("moving", &flat[0]);
    if instance.touch.intersects() {
        draw_contact(&mut sheet, &flat, map.at(instance.points[0]));
    } else {
        let way = map.way(instance.line);
        draw_gap(&mut sheet, instance.points.map(|p| map.at(p)), way);
    }
    sheet.finish()
}

/// Draws the contact, its sides, and the intersection line of the section planes.
fn draw_contact(sheet: &mut Sheet, flat: &[Vec<DVec2>; 2], at: DVec2) {
    for (ring, class) in [(&flat[1], "fixed-mark"), (&flat[0], "moving-mark")] {
        for (k, &from) in ring.iter().enumerate() {
            let way = ring[(k + 1) % ring.len()] - from;
            let share = (at - from).dot(way) / way.length_squared();
            let off = way.perp_dot(at - from).abs() / way.length();
            if off < 1e-6 && (-1e-6..=1.0 + 1e-6).contains(&share) {
                sheet.line(class, from, from + way);
            }
        }
    }
    let left = DVec2::new(20.0, at.y);
    sheet.line("cut", left, DVec2::new(460.0, at.y));
    sheet.text("math", left + DVec2::new(-4.0, -6.0), Anchor::Start, "t");
    sheet.dot("dot", at, 5.5);
    let words = "t, where their planes meet";
    sheet.legend(FOOT, &[P_SECTION, Q_SECTION, ("cut", words, 176.0)]);
}

/// Draws the lines `r` and `s` through the corners that bound the gap.
fn draw_gap(sheet: &mut Sheet, points: [DVec2; 2], way: DVec2) {
    for (at, name) in points.into_iter().zip(["r", "s"]) {
        sheet.line("shifted", at - way * 190.0, at + way * 190.0);
        sheet.dot("dot", at, 4.5);
        let end = (at + way * 176.0).clamp(DVec2::splat(14.0), DVec2::new(466.0, 424.0));
        sheet.text("math", end + DVec2::new(8.0, -6.0), Anchor::Middle, name);
    }
    let words = "r and s, with planes along d";
    sheet.legend(FOOT, &[P_SECTION, Q_SECTION, ("shifted", words, 190.0)]);
}

/// A way to look at a scene from the side, with the direction downwards.
struct Oblique {
    seen: DVec3,
    right: DVec3,
    up: DVec3,
}

impl Oblique {
    fn new(direction: DVec3) -> Self {
        let seen = DVec3::new(-0.62, 0.7, -0.36).normalize();
        let right = direction.cross(seen).normalize();
        Self { seen, right, up: right.cross(seen) }
    }

    fn flat(&self, w: DVec3) -> DVec2 {
        DVec2::new(self.right.dot(w), self.up.dot(w))
    }
}

/// Draws both cubes from the side, with the section of the moving one at its start and in contact.
fn draw_side_view(sheet: &mut Sheet, scene: &Scene, instance: &Instance, area: [DVec2; 2]) {
    let view = &scene.view;
    let look = Oblique::new(view.direction);
    let moved = view.direction * instance.value;
    let mut all: Vec<DVec2> =
        view.bodies.iter().flat_map(|b| b.vertices.iter().map(|&v| look.flat(v))).collect();
    all.extend(instance.sections[0].corners.iter().map(|&w| look.flat(w + moved)));
    let map = Map::fitting(&all, area);
    let place = |w: DVec3| map.at(look.flat(w));
    let [p, q] = instance.sections.each_ref().map(|s| &s.corners);
    let at = |by: DVec3| p.iter().map(|&w| place(w + by)).collect::<Vec<_>>();
    draw_outline(sheet, &view.bodies[1], FIXED, look.seen, place);
    sheet.polygon("fixed", &q.iter().map(|&w| place(w)).collect::<Vec<_>>());
    sheet.lines("way", &p.iter().map(|&w| [place(w), place(w + moved)]).collect::<Vec<_>>());
    sheet.polygon("moving", &at(moved));
    draw_outline(sheet, &view.bodies[0], MOVING, look.seen, place);
    sheet.polygon("moving", &at(DVec3::ZERO));
    let lift = contact_point(view, instance);
    sheet.dot("dot", place(lift), 5.0);
    let from = area[0] + DVec2::new(16.0, 30.0);
    sheet.arrow(["arrow", "head"], from, from + map.way(look.flat(view.direction)) * 52.0);
    sheet.text("math", from + DVec2::new(12.0, 30.0), Anchor::Start, "d");
}

/// Returns the contact on the section of the fixed body.
fn contact_point(view: &View, instance: &Instance) -> DVec3 {
    let ring = &instance.sections[1].corners;
    let (a, b, c) = (ring[0], ring[1], ring[2]);
    let [u, v, w] = [a, b, c].map(|p| view.shadow(p));
    let (r, s, to) = (v - u, w - u, instance.points[0] - u);
    let cross = r.perp_dot(s);
    a + (b - a) * (to.perp_dot(s) / cross) + (c - a) * (r.perp_dot(to) / cross)
}

/// Draws figure 8: the section `R` sweeps `R'` in the plane of `S`, which reduces the problem to polygons.
pub(super) fn reduction_figure(scene: &Scene, instance: &Instance) -> String {
    let mut sheet =
        Sheet::new("From two sections in space to two polygons in a plane", 760.0, 470.0);
    sheet.text("bold", DVec2::new(24.0, 22.0), Anchor::Start, "In space");
    draw_side_view(&mut sheet, scene, instance, [DVec2::new(24.0, 34.0), DVec2::new(380.0, 424.0)]);
    sheet.text("bold", DVec2::new(424.0, 22.0), Anchor::Start, "On the plane of the fixed section");
    // The plane of `S` in true size: its own axes.
    let view = &scene.view;
    let ring = &instance.sections[1].corners;
    let normal = (ring[1] - ring[0]).cross(ring[2] - ring[0]).normalize();
    let d = view.direction;
    let onto = |w: DVec3| w + d * ((ring[0] - w).dot(normal) / d.dot(normal));
    // Where the planes of both sections meet is a line across which the contact is lowest.
    let p = &instance.sections[0].corners;
    let other = (p[1] - p[0]).cross(p[2] - p[0]).normalize();
    let along = normal.cross(other).normalize();
    let along = if view.shadow(along).x < 0.0 { -along } else { along };
    let across = normal.cross(along);
    let across = if view.shadow(across).y < 0.0 { -across } else { across };
    let flat = |w: DVec3| DVec2::new(along.dot(w), across.dot(w));
    let (s, swept): (Vec<DVec2>, Vec<DVec2>) =
        (ring.iter().map(|&w| flat(w)).collect(), p.iter().map(|&w| flat(onto(w))).collect());
    let map = Map::fitting(
        &[s.clone(), swept.clone()].concat(),
        [DVec2::new(430.0, 60.0), DVec2::new(736.0, 400.0)],
    );
    sheet.polygon("fixed", &map.all(&s));
    sheet.polygon("moving", &map.all(&swept));
    let at = map.at(flat(contact_point(view, instance)));
    let [left, right] = [DVec2::new(424.0, at.y), DVec2::new(744.0, at.y)];
    sheet.line("cut", left, right);
    sheet.text("math", right + DVec2::new(-2.0, -6.0), Anchor::End, "t");
    sheet.dot("dot", at, 5.5);
    let top = |ring: &[DVec2]| {
        ring.iter().copied().fold(DVec2::NEG_INFINITY, |a, b| if b.y > a.y { b } else { a })
    };
    let (at_s, at_r) = (map.at(top(&s)), map.at(top(&swept)));
    let inwards = |at: DVec2, ring: &[DVec2]| {
        at + (map.at(super::setting::middle(ring)) - at).normalize_or_zero() * 30.0
    };
    sheet.text("math", inwards(at_s, &s), Anchor::Middle, "S");
    sheet.text("math", inwards(at_r, &swept), Anchor::Middle, "R′");
    let entries = [
        ("moving", "R, where it starts and touches; R′, swept", 265.0),
        ("fixed", "S", 60.0),
        ("cut", "t, where the planes meet", 170.0),
        ("dot", "first common point", 140.0),
    ];
    sheet.legend(DVec2::new(30.0, 454.0), &entries);
    sheet.finish()
}

/// Draws figure 1: the cubes, a pair of sections, and `phi` over all pairs.
pub(super) fn function_figure(scene: &Scene, instance: &Instance) -> String {
    let mut sheet =
        Sheet::new("Two cubes, a pair of sections, and the convex function φ", 800.0, 480.0);
    sheet.text(
        "bold",
        DVec2::new(24.0, 22.0),
        Anchor::Start,
        "A pair of sections, and how far until they touch",
    );
    draw_side_view(&mut sheet, scene, instance, [DVec2::new(24.0, 34.0), DVec2::new(370.0, 430.0)]);
    sheet.text("bold", DVec2::new(420.0, 22.0), Anchor::Start, "φ(x, y) over all pairs of levels");
    let [low, high] = scene.run.rectangle();
    // Each cell is a facet.
    let mut facets = Vec::new();
    for cell in &scene.mark.cells {
        let Some(contact) = scene.view.contact(cell.faces) else { continue };
        let heights: Vec<(DVec2, f64)> =
            cell.corners.iter().map(|&c| (c, contact.at(c).w)).collect();
        facets.push(heights);
    }
    let every = || facets.iter().flatten().map(|(_, t)| *t);
    let (least, most) =
        (every().fold(f64::INFINITY, f64::min), every().fold(f64::NEG_INFINITY, f64::max));
    let share = |c: DVec2| (c - low) / (high - low);
    // From above, with x to the right and back, y to the left and back.
    let flat = |c: DVec2, t: f64| {
        let DVec2 { x, y } = share(c);
        let lift = if t.is_nan() { 0.0 } else { 0.32 + 0.62 * (t - least) / (most - least) };
        DVec2::new(0.866 * (x - y), 0.42 * (x + y) + lift)
    };
    let ground = rectangle_of(low, high).map(|c| flat(c, f64::NAN));
    let mut all = ground.to_vec();
    all.extend(facets.iter().flatten().map(|(c, t)| flat(*c, *t)));
    let map = Map::fitting(&all, [DVec2::new(420.0, 40.0), DVec2::new(780.0, 424.0)]);
    sheet.polygon("plane", &map.all(&ground));
    for facet in &facets {
        sheet.polygon(
            "domain",
            &map.all(&facet.iter().map(|(c, _)| flat(*c, f64::NAN)).collect::<Vec<_>>()),
        );
    }
    // What is farther back first.
    let depth = |facet: &Vec<(DVec2, f64)>| {
        facet.iter().map(|(c, _)| share(*c).element_sum()).sum::<f64>() / facet.len().max(1) as f64
    };
    facets.sort_by(|a, b| depth(b).total_cmp(&depth(a)));
    for facet in &facets {
        sheet.polygon(
            "facet",
            &map.all(&facet.iter().map(|(c, t)| flat(*c, *t)).collect::<Vec<_>>()),
        );
    }
    if let (Some(best), Some(t)) = (scene.run.best(), scene.run.translation) {
        let [on, under] = [flat(best, t), flat(best, f64::NAN)].map(|p| map.at(p));
        sheet.line("cut", on, under);
        sheet.dot("least", on, 5.0);
        sheet.dot("least", under, 3.5);
    }
    let [front, right, _, left] = ground.map(|p| map.at(p));
    sheet.text("math", 0.5 * (front + right) + DVec2::new(12.0, 16.0), Anchor::Middle, "x");
    sheet.text("math", 0.5 * (front + left) + DVec2::new(-12.0, 16.0), Anchor::Middle, "y");
    let entries = [
        ("moving", "section of the moving cube", 190.0),
        ("fixed", "of the fixed one", 130.0),
        ("facet", "φ, a facet for each cell", 170.0),
        ("domain", "where sections meet", 150.0),
        ("least", "least value", 90.0),
    ];
    sheet.legend(DVec2::new(30.0, 464.0), &entries);
    sheet.finish()
}

/// Returns the corners of a rectangle.
fn rectangle_of(low: DVec2, high: DVec2) -> [DVec2; 4] {
    super::sheet::rectangle(low, high)
}
