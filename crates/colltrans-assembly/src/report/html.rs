//! One HTML file: offline, its pictures drawn into it; without scripts only the viewer is missing.

use std::fmt::Write;

use glam::DVec3;

use super::scene::{self, Arrow, Shown};
use super::{Findings, arrow, escaped, graph, short, viewer};
use crate::blocking::Blocking;
use crate::map;
use crate::plan::Step;
use crate::rooms::PartRoom;

const STYLE: &str = "body{font:15px/1.5 system-ui,sans-serif;margin:2em auto;max-width:70em;\
padding:0 1em;color:#222}h1,h2{font-weight:600}h2{margin-top:2em;border-bottom:1px solid #ccc}\
table{border-collapse:collapse;font-size:13px}td,th{border:1px solid #ddd;padding:.2em .5em;\
text-align:left;vertical-align:top}th{background:#f3f5f8}td.n{text-align:right}\
td.free{background:#fde3c4}td.overlapping{background:#eac8c8}.wide{overflow-x:auto}\
.steps{display:grid;grid-template-columns:repeat(auto-fill,minmax(20em,1fr));gap:1em}\
.graphs{grid-template-columns:repeat(auto-fill,minmax(min(30em,100%),1fr))}.steps figure{margin:0;border:1px solid #ddd;padding:.5em}figure svg{width:100%;height:auto}\
figcaption{font-size:13px}.warn{background:#fff3e0;border-left:4px solid #f6963a;padding:.5em 1em}";

/// Tables of rooms and pictures of graphs are cut off here; the JSON has all.
const MOST_ROWS: usize = 200;
const MOST_STEPS: usize = 60;
const MOST_GRAPHS: usize = 6;

/// The report.
pub fn page(f: &Findings, title: &str) -> String {
    let mut text = format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" \
         content=\"width=device-width\"><title>{0}</title><style>{STYLE}</style></head><body>\n\
         <h1>{0}</h1>\n",
        escaped(title)
    );
    overview(&mut text, f);
    text.push_str(&viewer::section(f));
    overlaps(&mut text, f);
    steps(&mut text, f);
    stuck(&mut text, f);
    for (name, map) in f.maps {
        let title = format!("Room of {name} in all directions");
        let _ = writeln!(text, "<h2>{}</h2>", escaped(&title));
        map_section(&mut text, map, &title);
    }
    rooms(&mut text, f);
    graphs(&mut text, f);
    contacts(&mut text, f);
    parts(&mut text, f);
    text.push_str("</body></html>\n");
    text
}

fn overview(text: &mut String, f: &Findings) {
    let assembly = f.bodies.assembly();
    let [low, high] = assembly.bounds();
    let size = high - low;
    let unit = assembly.unit().map_or(String::new(), |unit| format!(" {unit}"));
    let (tolerance, word) = match f.bodies.fit() {
        crate::Fit::Tolerance(length) => (length, "tolerance"),
        crate::Fit::Apart(length) => (length, "length to keep"),
    };
    let _ = writeln!(
        text,
        "<p>{} parts, {} × {} × {}{unit}; {word} {}{unit}; {} directions asked of all parts. Plan: \
         {} steps, {} parts left, {} groups that none of the directions asked takes apart.</p>",
        assembly.parts().len(),
        short(size.x),
        short(size.y),
        short(size.z),
        short(tolerance),
        f.matrix.directions().len(),
        f.plan.steps.len(),
        f.plan.left.len(),
        f.plan.stuck.len()
    );
    for note in assembly.notes() {
        let _ = writeln!(text, "<p class=\"warn\">{}</p>", escaped(note));
    }
    if !assembly.parts().is_empty() {
        let _ = writeln!(
            text,
            "<figure style=\"max-width:45em\">{}</figure>",
            scene::svg(&whole(f, &[]), &[])
        );
    }
}

/// All parts, those that are listed moved away.
fn whole<'a>(f: &Findings<'a>, moved: &[(usize, DVec3)]) -> Vec<Shown<'a>> {
    let parts = f.bodies.assembly().parts().iter().enumerate();
    let by = |k: usize| moved.iter().find(|m| m.0 == k).map_or(DVec3::ZERO, |m| m.1);
    parts.map(|(k, part)| Shown { part, color: k, by: by(k), pale: false }).collect()
}

fn overlaps(text: &mut String, f: &Findings) {
    text.push_str("<h2>Overlaps at the start</h2>\n");
    if f.start.overlaps.is_empty() {
        text.push_str("<p>None.</p>\n");
        return;
    }
    let remaining = f.start.remaining().count();
    if remaining > 0 {
        let advice = f.start.suggested.map_or(String::new(), |t| {
            format!(
                " Try a tolerance of {} or, for curved fits, the chord errors of both parts \
                     together.",
                short(t)
            )
        });
        let _ = writeln!(
            text,
            "<p class=\"warn\">{remaining} pairs overlap with this tolerance, and count as one body \
             where they meet.{advice}</p>"
        );
    }
    text.push_str("<table><tr><th>parts</th><th>depth</th><th>with this tolerance</th></tr>\n");
    for o in f.start.overlaps.iter().take(MOST_ROWS) {
        let [a, b] = o.parts.map(|k| escaped(f.bodies.assembly().parts()[k].name()));
        let depth = o.depth.map_or("more than their size".into(), short);
        let remains = if o.remains { "overlap" } else { "do not" };
        let _ = writeln!(
            text,
            "<tr><td>{a}, {b}</td><td class=\"n\">{depth}</td><td>{remains}</td></tr>"
        );
    }
    text.push_str("</table>\n");
}

fn steps(text: &mut String, f: &Findings) {
    text.push_str("<h2>Plan</h2>\n");
    if f.plan.steps.is_empty() {
        text.push_str("<p>Nothing can be taken out.</p>\n");
        return;
    }
    text.push_str("<div class=\"steps\">\n");
    let mut gone = vec![false; f.bodies.len()];
    for (k, step) in f.plan.steps.iter().enumerate().take(MOST_STEPS) {
        let picture = step_picture(f, k, &gone);
        let within =
            step.within.map_or(String::new(), |w| format!(" (of the group of step {})", w + 1));
        let ignored = step.ignores(f.bodies.assembly()).map_or(String::new(), |text| {
            format!("<br><span class=\"warn\">{}</span>", escaped(&text))
        });
        let travel =
            if step.travel > 0.0 { format!(", {}", short(step.travel)) } else { String::new() };
        let names: Vec<String> =
            f.bodies.assembly().names(&step.parts).into_iter().map(escaped).collect();
        let _ = writeln!(
            text,
            "<figure>{picture}<figcaption><b>{}.</b> {}{within}: {}{travel}{ignored}{}</figcaption></figure>",
            k + 1,
            names.join(", "),
            arrow(step.direction),
            resting(f, step)
        );
        if step.within.is_none() {
            step.parts.iter().for_each(|&p| gone[p] = true);
        }
    }
    text.push_str("</div>\n");
    if f.plan.steps.len() > MOST_STEPS {
        let _ = writeln!(
            text,
            "<p>{} more steps are in the JSON.</p>",
            f.plan.steps.len() - MOST_STEPS
        );
    }
}

/// The open surfaces that a step rests on.
fn resting(f: &Findings, step: &Step) -> String {
    if step.surfaces.is_empty() {
        return String::new();
    }
    let names: Vec<String> =
        f.bodies.assembly().names(&step.surfaces).into_iter().map(escaped).collect();
    format!("; rests on an open surface: {}", names.join(", "))
}

/// What is left, pale, and what moves, on its way out.
fn step_picture(f: &Findings, k: usize, gone: &[bool]) -> String {
    let step = &f.plan.steps[k];
    let parts = f.bodies.assembly().parts();
    let [low, high] = f.bodies.assembly().bounds();
    let by = step.direction
        * (step.travel * 0.5).clamp(0.12 * (high - low).length(), 0.5 * (high - low).length());
    let last = step.travel == 0.0 && step.within.is_none() && k + 1 == f.plan.steps.len();
    let by = if last { DVec3::ZERO } else { by };
    let group = step.within.map(|w| &f.plan.steps[w].parts);
    let there = |p: usize| match group {
        Some(group) => {
            group.contains(&p)
                && !f.plan.steps[..k]
                    .iter()
                    .any(|s| s.within == step.within && s.parts.contains(&p))
        }
        None => !gone[p],
    };
    let shown: Vec<Shown> = (0..parts.len())
        .filter(|&p| there(p))
        .map(|p| {
            let moves = step.parts.contains(&p);
            Shown {
                part: &parts[p],
                color: p,
                by: if moves { by } else { DVec3::ZERO },
                pale: !moves,
            }
        })
        .collect();
    let middle = step.parts.iter().map(|&p| f.bodies.bounds(p)).reduce(|a, b| a.join(&b));
    let arrows: Vec<Arrow> = middle
        .filter(|_| !last)
        .map(|b| Arrow {
            from: b.center(),
            to: b.center() + by + step.direction * 0.1 * (high - low).length(),
        })
        .into_iter()
        .collect();
    scene::svg(&shown, &arrows)
}

fn stuck(text: &mut String, f: &Findings) {
    if f.plan.stuck.is_empty() {
        return;
    }
    text.push_str("<h2>What none of the directions asked takes apart</h2>\n<ul>\n");
    for s in &f.plan.stuck {
        let names: Vec<String> =
            f.bodies.assembly().names(&s.parts).into_iter().map(escaped).collect();
        let because = escaped(&s.because(f.bodies));
        let _ = writeln!(text, "<li><b>{}</b>: {because}.</li>", names.join(", "));
    }
    text.push_str("</ul>\n");
}

fn map_section(text: &mut String, map: &map::RemovalMap, title: &str) {
    let _ = writeln!(text, "<figure style=\"max-width:52em\">{}</figure>", map::svg(map, title));
    let _ = writeln!(text, "<p>{:.2} % of all directions are free.</p>", 100.0 * map.free_share());
    for region in map.regions.iter().take(8) {
        let _ = writeln!(
            text,
            "<p>A free region of {} steradians around {}.</p>",
            short(region.solid_angle),
            arrow(region.center)
        );
    }
    for d in &map.isolated {
        let _ = writeln!(text, "<p>An isolated free direction: {}.</p>", arrow(*d));
    }
}

/// Zero instead of what rounding has left of it.
fn tidy(x: f64, size: f64) -> f64 {
    if x.abs() < 1e-9 * size { 0.0 } else { x }
}

fn rooms(text: &mut String, f: &Findings) {
    text.push_str(
        "<h2>Rooms</h2>\n<p>How far each part can move before another stops it, with all \
                   parts in place.</p>\n<div class=\"wide\"><table><tr><th>part</th>",
    );
    for d in f.matrix.directions() {
        let _ = write!(text, "<th>{}</th>", arrow(*d));
    }
    text.push_str("</tr>\n");
    let size = f.bodies.assembly().size();
    for part in 0..f.bodies.len().min(MOST_ROWS) {
        let name = |k: usize| escaped(f.bodies.assembly().parts()[k].name());
        let _ = write!(text, "<tr><th>{}</th>", name(part));
        for k in 0..f.matrix.directions().len() {
            let room = f.matrix.room(k, part);
            let cell = match room {
                PartRoom::Free => "free".into(),
                PartRoom::Overlapping { by, .. } => format!("overlaps {}", name(by)),
                PartRoom::Blocked { by, stop, .. } => {
                    format!("{} {}", short(tidy(stop.distance, size)), name(by))
                }
            };
            let _ = write!(text, "<td class=\"{}\">{cell}</td>", room.outcome());
        }
        text.push_str("</tr>\n");
    }
    text.push_str("</table></div>\n");
}

fn graphs(text: &mut String, f: &Findings) {
    let most = 60;
    if f.bodies.is_empty() || f.bodies.len() > most {
        return;
    }
    text.push_str("<h2>Blocking graphs</h2>\n<p>An arrow from a part to each one that it meets. \
                   Orange: comes out as it is, alone or with its group; red rings and arrows: moves \
                   as one.</p>\n<div class=\"steps graphs\">\n");
    let all = vec![true; f.bodies.len()];
    for (k, d) in f.matrix.directions().iter().enumerate().take(MOST_GRAPHS) {
        let picture = graph::svg(f.bodies, &Blocking::new(f.matrix, k, &all));
        let origin = f.candidates.get(k).map_or("", |c| c.origin.name());
        let _ = writeln!(
            text,
            "<figure>{picture}<figcaption>{} ({origin})</figcaption></figure>",
            arrow(*d)
        );
    }
    text.push_str("</div>\n");
}

fn contacts(text: &mut String, f: &Findings) {
    text.push_str("<h2>Contacts</h2>\n");
    if f.liaisons.is_empty() {
        text.push_str("<p>None.</p>\n");
        return;
    }
    text.push_str("<table><tr><th>parts</th><th>area</th><th>around</th></tr>\n");
    for l in f.liaisons.iter().take(MOST_ROWS) {
        let [a, b] = l.parts.map(|k| escaped(f.bodies.assembly().parts()[k].name()));
        let c = l.center().to_array().map(|x| short(tidy(x, f.bodies.assembly().size())));
        let _ = writeln!(
            text,
            "<tr><td>{a}, {b}</td><td class=\"n\">{}</td><td>{}</td></tr>",
            short(l.area()),
            c.join(", ")
        );
    }
    text.push_str("</table>\n");
}

fn parts(text: &mut String, f: &Findings) {
    text.push_str(
        "<h2>Parts</h2>\n<table><tr><th>part</th><th>facets</th><th>volume</th>\
                   <th>remarks</th></tr>\n",
    );
    for (k, p) in f.bodies.assembly().parts().iter().enumerate().take(MOST_ROWS) {
        let remark = f.bodies.remark(k);
        let mut remarks: Vec<String> =
            p.defects().iter().chain(&remark).map(|d| escaped(d)).collect();
        if p.fixed() {
            remarks.push("fixed".into());
        }
        let _ = writeln!(
            text,
            "<tr><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td>{}</td></tr>",
            escaped(p.name()),
            p.facets(),
            short(p.solid().volume()),
            remarks.join("; ")
        );
    }
    text.push_str("</table>\n");
}
