//! Pictures in the plane of the levels: the mark, and minimisations on it.

use colltrans::observe::SectionContact;
use glam::DVec2;

use super::Scene;
use super::mark::Mark;
use super::planar::Instance;
use super::setting::{Run, Step, below, middle};
use super::sheet::{Anchor, Map, Sheet, rectangle};

/// Draws the cells and the names of the axes.
fn draw_mark(sheet: &mut Sheet, map: &Map, mark: &Mark, [low, high]: [DVec2; 2]) {
    for cell in &mark.cells {
        let class = if cell.touch == SectionContact::Edges { "domain" } else { "vertex-cell" };
        sheet.polygon(class, &map.all(&cell.corners));
    }
    sheet.lines(
        "border",
        &mark.lines.iter().map(|line| line.map(|p| map.at(p))).collect::<Vec<_>>(),
    );
    sheet.polygon("frame", &map.all(&rectangle(low, high)));
    let [a, b] = [map.at(low), map.at(high)];
    let along = DVec2::new(0.5 * (a.x + b.x), a.y + 17.0);
    sheet.text("small", along, Anchor::Middle, "level x of the moving cube →");
    sheet.text("small", DVec2::new(a.x, b.y - 7.0), Anchor::Start, "↑ level y of the fixed cube");
}

/// Returns an interior point of each cell, and the planar problem there.
fn cell_samples(scene: &Scene) -> Vec<(DVec2, Instance)> {
    let inside = scene.mark.cells.iter().map(|cell| middle(&cell.corners));
    let all = inside.chain(scene.mark.outside.iter().copied());
    all.filter_map(|at| Some((at, scene.view.instance(at)?))).collect()
}

/// Draws figure 2: the orientation of the cut line in each cell.
pub(super) fn orientation_figure(scene: &Scene) -> String {
    let mut sheet = Sheet::new("The mark of φ, with the cut line of each cell", 560.0, 600.0);
    let levels = scene.run.rectangle();
    let map = Map::fitting(&levels, [DVec2::new(30.0, 34.0), DVec2::new(530.0, 534.0)]);
    draw_mark(&mut sheet, &map, &scene.mark, levels);
    for (at, instance) in cell_samples(scene) {
        let (at, downhill) = (map.at(at), map.way(-instance.gradient));
        let along = downhill.perp() * 17.0;
        sheet.line("shifted", at - along, at + along);
        sheet.arrow(["arrow", "head"], at, at + downhill * 27.0);
    }
    let entries = [
        ("domain", "edge contact", 110.0),
        ("vertex-cell", "vertex contact", 120.0),
        ("shifted", "cut line", 90.0),
        ("arrow", "towards what is kept", 150.0),
    ];
    sheet.legend(DVec2::new(38.0, 584.0), &entries);
    sheet.finish()
}

/// Returns a number from 0 to 4 that increases with the angle of a direction.
fn turn_number(v: DVec2) -> f64 {
    let part = v.x / (v.x.abs() + v.y.abs());
    if v.y >= 0.0 { 1.0 - part } else { 3.0 + part }
}

/// Draws figure 6: the mark, and the sections in its cells.
pub(super) fn contact_figure(scene: &Scene) -> String {
    const ROOM: f64 = 128.0;
    let mut sheet =
        Sheet::new("The mark of φ, with sections of its cells seen along d", 720.0, 760.0);
    let (levels, center) = (scene.run.rectangle(), DVec2::new(360.0, 352.0));
    let half = DVec2::splat(165.0);
    let map = Map::fitting(&levels, [center - half, center + half]);
    draw_mark(&mut sheet, &map, &scene.mark, levels);
    // Rooms once around the mark, and samples in the same order.
    let mut rooms = Vec::new();
    for (x, y) in [
        (2, 0),
        (1, 0),
        (0, 0),
        (0, 1),
        (0, 2),
        (0, 3),
        (1, 3),
        (2, 3),
        (3, 3),
        (3, 2),
        (3, 1),
        (3, 0),
    ] {
        let side = |k: i32, wide: f64| 12.0 + 64.0 + f64::from(k) * (wide - 24.0 - ROOM) / 3.0;
        rooms.push(DVec2::new(side(x, 720.0), side(y, 704.0)));
    }
    let from_middle = |at: DVec2| {
        let v = at - center;
        turn_number(DVec2::new(v.x, -v.y))
    };
    rooms.sort_by(|a, b| from_middle(*a).total_cmp(&from_middle(*b)));
    let mut all = cell_samples(scene);
    all.truncate(rooms.len());
    all.sort_by(|a, b| from_middle(map.at(a.0)).total_cmp(&from_middle(map.at(b.0))));
    // Each has a room of its own; two change theirs while that makes their leaders shorter.
    let mut of: Vec<usize> = (0..all.len()).map(|k| k * rooms.len() / all.len()).collect();
    of.extend((0..rooms.len()).filter(|room| !of.contains(room)).collect::<Vec<_>>());
    let long = |k: usize, room: usize| {
        all.get(k).map_or(0.0, |(at, _)| (map.at(*at) - rooms[room]).length_squared())
    };
    for _ in 0..rooms.len() {
        for k in 0..of.len() {
            for m in 0..k {
                if long(k, of[m]) + long(m, of[k]) < long(k, of[k]) + long(m, of[m]) {
                    of.swap(k, m);
                }
            }
        }
    }
    for (k, (at, instance)) in all.iter().enumerate() {
        let room = rooms[of[k]];
        let at = map.at(*at);
        let way = room - at;
        let edge = way * (1.0 - 0.5 * ROOM / way.abs().max_element());
        sheet.line("leader", at, at + edge);
        sheet.dot("start", at, 3.5);
        draw_sections(
            &mut sheet,
            scene,
            instance,
            [room - DVec2::splat(0.5 * ROOM - 8.0), room + DVec2::splat(0.5 * ROOM - 8.0)],
        );
    }
    let entries = [
        ("domain", "edge contact", 105.0),
        ("vertex-cell", "vertex contact", 115.0),
        ("moving", "section of the moving cube", 185.0),
        ("fixed", "of the fixed one", 125.0),
        ("dot", "where they touch", 120.0),
    ];
    sheet.legend(DVec2::new(30.0, 744.0), &entries);
    sheet.finish()
}

/// Draws two sections, viewed along the direction, in a small area.
fn draw_sections(sheet: &mut Sheet, scene: &Scene, instance: &Instance, area: [DVec2; 2]) {
    let flat = instance
        .sections
        .each_ref()
        .map(|s| s.corners.iter().map(|&w| scene.view.shadow(w)).collect::<Vec<_>>());
    let map = Map::fitting(&flat.concat(), area);
    sheet.polygon("fixed", &map.all(&flat[1]));
    sheet.polygon("moving", &map.all(&flat[0]));
    if instance.touch.intersects() {
        sheet.dot("dot", map.at(instance.points[0]), 4.5);
    } else {
        sheet.line("cut", map.at(instance.points[0]), map.at(instance.points[1]));
    }
}

/// Returns the part of the line `gradient . p = value` in a convex polygon.
fn polygon_chord(polygon: &[DVec2], gradient: DVec2, value: f64) -> Option<[DVec2; 2]> {
    let mut ends = Vec::new();
    for (k, &from) in polygon.iter().enumerate() {
        let to = polygon[(k + 1) % polygon.len()];
        let [u, v] = [from, to].map(|p| gradient.dot(p) - value);
        if (u <= 0.0) != (v <= 0.0) {
            ends.push(from.lerp(to, u / (u - v)));
        }
    }
    match ends[..] {
        [a, b] => Some([a, b]),
        _ => None,
    }
}

/// Draws one step: the region, the cut line at `c`, the shift to `q`, and the removed part.
fn draw_step(sheet: &mut Sheet, map: &Map, Step { problem, cell, region, cut }: &Step) {
    let [c, q] = [problem.levels, problem.best].map(DVec2::from_array);
    let gradient = problem.gradient;
    if let Some(cut) = cut {
        let value = cut.gradient.dot(cut.origin) + cut.limit;
        sheet.polygon("lost", &map.all(&below(region, -cut.gradient, -value)));
    }
    sheet.polygon("cell", &map.all(cell));
    sheet.polygon("left", &map.all(region));
    let mut line = |class: &str, at: DVec2| {
        if let Some([a, b]) = polygon_chord(region, gradient, gradient.dot(at)) {
            sheet.line(class, map.at(a), map.at(b));
        }
    };
    line("cut", c);
    if problem.touch.intersects() {
        line("shifted", q);
    }
    if c.distance(q) > 1e-9 {
        sheet.arrow(["shifted", "cut-head"], map.at(c), map.at(q));
    }
    sheet.dot("start", map.at(c), 4.5);
}

/// Draws the letter of a point on the side opposite to `beside`.
fn draw_letter(sheet: &mut Sheet, at: DVec2, beside: DVec2, text: &str) {
    sheet.text("math", at + beside + DVec2::Y * 4.0, Anchor::Middle, text);
}

/// Draws figure 9: a minimisation of two steps.
pub(super) fn two_steps(scene: &Scene) -> String {
    let mut sheet = Sheet::new("Two minimisation steps", 760.0, 450.0);
    let levels = scene.run.rectangle();
    for (k, one) in scene.run.steps.iter().enumerate().take(2) {
        let left = 28.0 + 372.0 * k as f64;
        let map = Map::fitting(&levels, [DVec2::new(left, 52.0), DVec2::new(left + 335.0, 387.0)]);
        sheet.text("bold", DVec2::new(left, 20.0), Anchor::Start, &format!("Step {}", k + 1));
        draw_mark(&mut sheet, &map, &scene.mark, levels);
        draw_step(&mut sheet, &map, one);
        let [c, q] = [one.problem.levels, one.problem.best].map(|p| map.at(DVec2::from_array(p)));
        let is_last = one.cut.is_none();
        sheet.dot(if is_last { "least" } else { "dot" }, q, 5.0);
        let aside = (c - q).normalize_or(DVec2::Y) * 15.0;
        draw_letter(&mut sheet, c, aside, "c");
        draw_letter(&mut sheet, q, -aside, "q");
    }
    let entries = [
        ("left", "M", 58.0),
        ("cell", "cell of c", 90.0),
        ("cut", "cut line at c", 115.0),
        ("shifted", "shifted to q", 110.0),
        ("lost", "cut off", 85.0),
        ("least", "q solves the problem", 150.0),
    ];
    sheet.legend(DVec2::new(36.0, 434.0), &entries);
    sheet.finish()
}

/// Draws figure 10: steps that start at the last solution, in its neighbourhood.
pub(super) fn focus_figure(scene: &Scene, run: &Run, half: f64) -> String {
    let shown = run.steps.len().min(3);
    let wide = 344.0 + 328.0 * (shown as f64 - 1.0);
    let mut sheet = Sheet::new("Minimisation steps from the last solution p", wide, 452.0);
    let levels = run.rectangle();
    let p = DVec2::from_array(run.steps[0].problem.levels);
    let around = half * scene.run.sections.axes[0].length();
    for (k, one) in run.steps.iter().enumerate().take(shown) {
        let left = 22.0 + 328.0 * k as f64;
        let map = Map::fitting(&levels, [DVec2::new(left, 52.0), DVec2::new(left + 300.0, 352.0)]);
        sheet.text("bold", DVec2::new(left, 20.0), Anchor::Start, &format!("Step {}", k + 1));
        draw_mark(&mut sheet, &map, &scene.mark, levels);
        draw_step(&mut sheet, &map, one);
        sheet.polygon("square", &map.all(&rectangle(p - around, p + around)));
        let centroid = centroid(&one.region);
        let [at_p, c, q, mid] = [
            p,
            DVec2::from_array(one.problem.levels),
            DVec2::from_array(one.problem.best),
            centroid,
        ]
        .map(|v| map.at(v));
        if k > 0 {
            sheet.line("leader", mid, at_p);
            sheet.dot("start", mid, 3.0);
            draw_letter(
                &mut sheet,
                mid,
                (mid - at_p).normalize_or(DVec2::Y) * 15.0,
                &format!("c{}", "′".repeat(k)),
            );
        }
        sheet.dot("start", c, 4.5);
        sheet.dot(if one.cut.is_none() { "least" } else { "dot" }, q, 4.5);
        if k == 0 {
            draw_letter(&mut sheet, at_p, DVec2::new(0.0, 16.0), "p");
        } else if c.distance(mid) > 6.0 {
            draw_letter(&mut sheet, c, DVec2::new(-15.0, -8.0), &format!("c{}*", "′".repeat(k)));
        }
        let corner = map.at(p + DVec2::new(-around, around));
        draw_letter(&mut sheet, corner, DVec2::new(20.0, -11.0), "N(p)");
    }
    let entries = [
        ("square", "N(p)", 75.0),
        ("left", "M", 58.0),
        ("cell", "cell", 66.0),
        ("cut", "cut line", 90.0),
        ("shifted", "shifted to q", 115.0),
    ];
    sheet.legend(DVec2::new(30.0, 412.0), &entries);
    let entries = [
        ("lost", "cut off", 88.0),
        ("least", "solves the problem", 145.0),
        ("leader", "from the centroid to p", 160.0),
    ];
    sheet.legend(DVec2::new(30.0, 436.0), &entries);
    sheet.finish()
}

/// Returns the centroid of a polygon.
pub(super) fn centroid(polygon: &[DVec2]) -> DVec2 {
    let (first, mut area, mut moment) = (polygon[0], 0.0, DVec2::ZERO);
    for pair in polygon[1..].windows(2) {
        let (u, v) = (pair[0] - first, pair[1] - first);
        area += u.perp_dot(v);
        moment += (u + v) * u.perp_dot(v);
    }
    first + moment / (3.0 * area)
}
