//! Folded tables with details. Only open ones are printed.

use maud::{Markup, html};

use super::{Report, direction_name, graph, picture_markup};
use crate::blocking::BlockingGraph;
use crate::bodies::Fit;
use crate::fasteners::Fastener;
use crate::part::Part;
use crate::travel::PartTravel;

/// Maximum number of rows. The JSON file contains all.
const MAX_ROWS: usize = 200;
/// Maximum number of drawn blocking graphs.
const MAX_GRAPHS: usize = 6;

/// Returns all tables.
pub(super) fn all_tables(r: &Report) -> Markup {
    let contents = [
        ("All parts", parts_table(r)),
        ("Parts that overlap as drawn, or with this fit", overlaps_table(r)),
        ("Free travel of each part with all others in place", free_travel_table(r)),
        ("Blocking graphs, by direction", blocking_graphs(r)),
        ("Contacts", contacts_table(r)),
    ];
    html! {
        @for (title, content) in contents {
            details { summary { (title) } (content) }
        }
    }
}

/// Returns the table of overlapping pairs.
fn overlaps_table(r: &Report) -> Markup {
    let f = r.f;
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
                            td.n { (o.depth.map_or("more than their size".into(), |depth| r.words.fine_length_text(depth))) }
                            td { (match (o.remains_with_fit, f.bodies.fit()) { (false, _) => "do not", (_, Fit::MinGap(_)) => "too near", _ => "overlap" }) }
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
fn free_travel_table(r: &Report) -> Markup {
    let f = r.f;
    let size = f.bodies.assembly().largest_side();
    let name = |k: usize| f.bodies.assembly().parts()[k].name();
    let directions = f.matrix.directions();
    let cell = |room: &PartTravel| match room {
        PartTravel::Free => "free".into(),
        PartTravel::Overlapping { by, .. } => format!("overlaps {}", name(*by)),
        PartTravel::Blocked { by, stop, .. } => {
            format!(
                "{} {}",
                r.words.length_number(without_rounding(stop.distance(), size)),
                name(*by)
            )
        }
    };
    html! {
        div.wide {
            table {
                tr { th { "part" } @for d in directions { th { (direction_name(*d)) } } }
                @for part in 0..f.bodies.len().min(MAX_ROWS) {
                    tr {
                        th { (name(part)) }
                        @for room in (0..directions.len()).map(|k| f.matrix.travel_of_part(k, part)) {
                            td class=(room.outcome_name()) { (cell(&room)) }
                        }
                    }
                }
            }
        }
    }
}

/// Returns the blocking graphs of the first directions; empty for large assemblies.
fn blocking_graphs(r: &Report) -> Markup {
    let f = r.f;
    let most = 60;
    if f.bodies.is_empty() || f.bodies.len() > most {
        return Markup::default();
    }
    let all = vec![true; f.bodies.len()];
    let graph =
        |k: usize| graph::blocking_graph_svg(f.bodies, &BlockingGraph::new(&f.matrix, k, &all));
    let origin = |k: usize| f.candidates.main.get(k).map_or("", |c| c.source.name());
    html! {
        p {
            "Arrows point from a part to each part that it meets. Orange: can be removed, alone or with \
             its group. Red rings and arrows: parts that move as one."
        }
        div.graphs {
            @for (k, d) in f.matrix.directions().iter().enumerate().take(MAX_GRAPHS) {
                figure {
                    (picture_markup(graph(k)))
                    figcaption { (direction_name(*d)) " (" (origin(k)) ")" }
                }
            }
        }
    }
}

/// Returns the table of contacts with their areas and centres.
fn contacts_table(r: &Report) -> Markup {
    let f = r.f;
    let name = |k: usize| f.bodies.assembly().parts()[k].name();
    let size = f.bodies.assembly().coordinate_size();
    html! {
        @if f.liaisons.is_empty() {
            p { "None." }
        } @else {
            div.wide { table {
                tr { th { "parts" } th { "area" } th { "around" } }
                @for l in f.liaisons.iter().take(MAX_ROWS) {
                    tr {
                        td { (name(l.parts[0])) ", " (name(l.parts[1])) }
                        td.n { (r.words.area_text(l.area())) }
                        td { (l.centroid().to_array().map(|x| r.words.length_number(without_rounding(x, size))).join(", ")) }
                    }
                }
            } }
        }
    }
}

/// Returns the table of parts with their facets, volumes and remarks.
fn parts_table(r: &Report) -> Markup {
    let f = r.f;
    let remarks = |k: usize, p: &Part| {
        let fixed = p.is_fixed().then(|| "fixed".to_owned());
        let all: Vec<String> =
            p.defects().iter().cloned().chain(f.bodies.shrink_defects(k)).chain(fixed).collect();
        all.join("; ")
    };
    html! {
        div.wide { table {
            @let has_fasteners = !f.plan.fasteners.is_empty();
            tr {
                th { "part" }
                @if has_fasteners { th { "fastener" } th { "form" } }
                th { "facets" } th { "volume" } th { "remarks" }
            }
            @for (k, p) in f.bodies.assembly().parts().iter().enumerate().take(MAX_ROWS) {
                tr {
                    td { (p.name()) }
                    @if has_fasteners {
                        @let fastener = f.plan.fasteners.get(k);
                        td { (fastener.map_or_else(String::new, Fastener::title)) }
                        td { (fastener.map_or_else(String::new, Fastener::details)) }
                    }
                    td.n { (p.facet_count()) }
                    td.n { (r.words.volume_text(p.solid().volume())) }
                    td { (remarks(k, p)) }
                }
            }
        } }
    }
}
