//! Folded tables with details. Only open ones are printed.

use maud::{Markup, html};

use super::{Findings, arrow, graph, picture_markup, short};
use crate::blocking::Blocking;
use crate::bodies::Fit;
use crate::part::Part;
use crate::rooms::PartRoom;

/// Maximum number of rows. The JSON file contains all.
const MAX_ROWS: usize = 200;
/// Maximum number of drawn blocking graphs.
const MAX_GRAPHS: usize = 6;

/// Returns all tables.
pub(super) fn all_tables(f: &Findings) -> Markup {
    let contents = [
        ("All parts", parts_table(f)),
        ("Parts that overlap as drawn, or with this fit", overlaps_table(f)),
        ("Free travel of each part with all others in place", free_travel_table(f)),
        ("Blocking graphs, by direction", blocking_graphs(f)),
        ("Contacts", contacts_table(f)),
    ];
    html! {
        @for (title, content) in contents {
            details { summary { (title) } (content) }
        }
    }
}

/// Returns the table of overlapping pairs.
fn overlaps_table(f: &Findings) -> Markup {
    let name = |k: usize| f.bodies.assembly().parts()[k].name();
    html! {
        @if f.start.overlaps.is_empty() {
            p { "None." }
        } @else {
            div.wide {
                table {
                    tr { th { "parts" } th { "depth" } th { "with this fit" } }
                    @for o in f.start.overlaps.iter().take(MAX_ROWS) {
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

/// Returns 0 for values that are only rounding errors at the size of the assembly.
fn without_rounding(x: f64, size: f64) -> f64 {
    if x.abs() < 1e-9 * size { 0.0 } else { x }
}

/// Returns the table of free travels by part and direction.
fn free_travel_table(f: &Findings) -> Markup {
    let size = f.bodies.assembly().extent();
    let name = |k: usize| f.bodies.assembly().parts()[k].name();
    let directions = f.matrix.directions();
    let cell = |room: &PartRoom| match room {
        PartRoom::Free => "free".into(),
        PartRoom::Overlapping { by, .. } => format!("overlaps {}", name(*by)),
        PartRoom::Blocked { by, stop, .. } => {
            format!("{} {}", short(without_rounding(stop.distance(), size)), name(*by))
        }
    };
    html! {
        div.wide {
            table {
                tr { th { "part" } @for d in directions { th { (arrow(*d)) } } }
                @for part in 0..f.bodies.len().min(MAX_ROWS) {
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

/// Returns the blocking graphs of the first directions; empty for large assemblies.
fn blocking_graphs(f: &Findings) -> Markup {
    let most = 60;
    if f.bodies.is_empty() || f.bodies.len() > most {
        return Markup::default();
    }
    let all = vec![true; f.bodies.len()];
    let graph = |k: usize| graph::svg(f.bodies, &Blocking::new(&f.matrix, k, &all));
    let origin = |k: usize| f.candidates.main.get(k).map_or("", |c| c.origin.name());
    html! {
        p {
            "Arrows point from a part to each part that it meets. Orange: can be removed, alone or with \
             its group. Red rings and arrows: parts that move as one."
        }
        div.graphs {
            @for (k, d) in f.matrix.directions().iter().enumerate().take(MAX_GRAPHS) {
                figure {
                    (picture_markup(graph(k)))
                    figcaption { (arrow(*d)) " (" (origin(k)) ")" }
                }
            }
        }
    }
}

/// Returns the table of contacts with their areas and centres.
fn contacts_table(f: &Findings) -> Markup {
    let name = |k: usize| f.bodies.assembly().parts()[k].name();
    let size = f.bodies.assembly().size();
    html! {
        @if f.liaisons.is_empty() {
            p { "None." }
        } @else {
            div.wide { table {
                tr { th { "parts" } th { "area" } th { "around" } }
                @for l in f.liaisons.iter().take(MAX_ROWS) {
                    tr {
                        td { (name(l.parts[0])) ", " (name(l.parts[1])) }
                        td.n { (short(l.area())) }
                        td { (l.center().to_array().map(|x| short(without_rounding(x, size))).join(", ")) }
                    }
                }
            } }
        }
    }
}

/// Returns the table of parts with their facets, volumes and remarks.
fn parts_table(f: &Findings) -> Markup {
    let remarks = |k: usize, p: &Part| {
        let fixed = p.fixed().then(|| "fixed".to_owned());
        let all: Vec<String> =
            p.defects().iter().cloned().chain(f.bodies.remark(k)).chain(fixed).collect();
        all.join("; ")
    };
    html! {
        div.wide { table {
            tr { th { "part" } th { "facets" } th { "volume" } th { "remarks" } }
            @for (k, p) in f.bodies.assembly().parts().iter().enumerate().take(MAX_ROWS) {
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
