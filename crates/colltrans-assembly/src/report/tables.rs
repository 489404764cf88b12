//! Tables for who wants to know more, folded: only those that are open are printed.

use maud::{Markup, html};

use super::{Findings, arrow, graph, picture, short};
use crate::blocking::Blocking;
use crate::bodies::Fit;
use crate::part::Part;
use crate::rooms::PartRoom;

/// Rows are cut off here; the JSON has all.
const MOST_ROWS: usize = 200;
const MOST_GRAPHS: usize = 6;

pub(super) fn all(f: &Findings) -> Markup {
    let contents = [
        ("All parts", parts(f)),
        ("Parts that run into each other as they are drawn, or with this fit", overlaps(f)),
        ("How far each part goes with all others in place", rooms(f)),
        ("Who meets whom, by direction", graphs(f)),
        ("Contacts", contacts(f)),
    ];
    html! {
        @for (title, content) in contents {
            details { summary { (title) } (content) }
        }
    }
}

fn overlaps(f: &Findings) -> Markup {
    let name = |k: usize| f.bodies.assembly().parts()[k].name();
    html! {
        @if f.start.overlaps.is_empty() {
            p { "None." }
        } @else {
            div.wide {
                table {
                    tr { th { "parts" } th { "depth" } th { "with this fit" } }
                    @for o in f.start.overlaps.iter().take(MOST_ROWS) {
                        tr {
                            td { (name(o.parts[0])) ", " (name(o.parts[1])) }
                            td.n { (o.depth.map_or("more than their size".into(), short)) }
                            td { (match (o.remains, f.bodies.fit()) { (false, _) => "do not", (_, Fit::Apart(_)) => "too near", _ => "overlap" }) }
                        }
                    }
                }
            }
        }
    }
}

/// Zero instead of what rounding has left of it.
fn tidy(x: f64, size: f64) -> f64 {
    if x.abs() < 1e-9 * size { 0.0 } else { x }
}

fn rooms(f: &Findings) -> Markup {
    let size = f.bodies.assembly().extent();
    let name = |k: usize| f.bodies.assembly().parts()[k].name();
    let directions = f.matrix.directions();
    let cell = |room: &PartRoom| match room {
        PartRoom::Free => "free".into(),
        PartRoom::Overlapping { by, .. } => format!("overlaps {}", name(*by)),
        PartRoom::Blocked { by, stop, .. } => {
            format!("{} {}", short(tidy(stop.distance(), size)), name(*by))
        }
    };
    html! {
        div.wide {
            table {
                tr { th { "part" } @for d in directions { th { (arrow(*d)) } } }
                @for part in 0..f.bodies.len().min(MOST_ROWS) {
                    tr {
                        th { (name(part)) }
                        @for room in (0..directions.len()).map(|k| f.matrix.room(k, part)) {
                            td class=(room.outcome()) { (cell(&room)) }
                        }
                    }
                }
            }
        }
    }
}

fn graphs(f: &Findings) -> Markup {
    let most = 60;
    if f.bodies.is_empty() || f.bodies.len() > most {
        return Markup::default();
    }
    let all = vec![true; f.bodies.len()];
    let graph = |k: usize| graph::svg(f.bodies, &Blocking::new(&f.matrix, k, &all));
    let origin = |k: usize| f.candidates.main.get(k).map_or("", |c| c.origin.name());
    html! {
        p {
            "An arrow from a part to each one that it meets. Orange: comes out as it is, alone or with \
             its group; red rings and arrows: moves as one."
        }
        div.graphs {
            @for (k, d) in f.matrix.directions().iter().enumerate().take(MOST_GRAPHS) {
                figure {
                    (picture(graph(k)))
                    figcaption { (arrow(*d)) " (" (origin(k)) ")" }
                }
            }
        }
    }
}

fn contacts(f: &Findings) -> Markup {
    let name = |k: usize| f.bodies.assembly().parts()[k].name();
    let size = f.bodies.assembly().size();
    html! {
        @if f.liaisons.is_empty() {
            p { "None." }
        } @else {
            div.wide { table {
                tr { th { "parts" } th { "area" } th { "around" } }
                @for l in f.liaisons.iter().take(MOST_ROWS) {
                    tr {
                        td { (name(l.parts[0])) ", " (name(l.parts[1])) }
                        td.n { (short(l.area())) }
                        td { (l.center().to_array().map(|x| short(tidy(x, size))).join(", ")) }
                    }
                }
            } }
        }
    }
}

fn parts(f: &Findings) -> Markup {
    let remarks = |k: usize, p: &Part| {
        let fixed = p.fixed().then(|| "fixed".to_owned());
        let all: Vec<String> =
            p.defects().iter().cloned().chain(f.bodies.remark(k)).chain(fixed).collect();
        all.join("; ")
    };
    html! {
        div.wide { table {
            tr { th { "part" } th { "facets" } th { "volume" } th { "remarks" } }
            @for (k, p) in f.bodies.assembly().parts().iter().enumerate().take(MOST_ROWS) {
                tr {
                    td { (p.name()) }
                    td.n { (p.facets()) }
                    td.n { (short(p.solid().volume())) }
                    td { (remarks(k, p)) }
                }
            }
        } }
    }
}
