//! One HTML file for print and screen: a first page, a page for each step, and further sections. The file is
//! self-contained, with pictures as inline SVG. Without scripts only the viewer is missing.
//!
//! `maud` escapes every inserted text. Only content of this crate (style, script) and pictures drawn by it
//! are inserted unescaped, marked by [`PreEscaped`] (see `picture_markup`).

use std::ops::Range;

use maud::{DOCTYPE, Markup, PreEscaped, html};
use rayon::prelude::*;

use super::{Analysis, Report, after, cover, sheet, tables, viewer};

/// Style sheet of the report.
const STYLE: &str = include_str!("../../assets/report.css");

/// Returns the report as an HTML document.
pub fn report_page(f: &Analysis, title: &str) -> String {
    let r = Report::new(f);
    let stages = f.plan.stages();
    let repeats = f.plan.repeated_stages(&stages);
    let mut drawn: Vec<Vec<&Range<usize>>> = Vec::new();
    for (run, times) in &repeats {
        for k in run.clone() {
            drawn.push((0..*times).map(|time| &stages[k + time * run.len()]).collect());
        }
    }
    let sheets: Vec<Markup> = drawn.par_iter().map(|again| sheet::step_page(&r, again)).collect();
    let body = html! {
        main {
            (cover::cover_page(&r, title))
            (viewer::viewer_section(f))
            @for sheet in sheets { (sheet) }
            (after::after_section(&r))
        }
        (tables::all_tables(f))
    };
    document(title, "", &body)
}

/// Returns a document with the style sheet of all reports, a style sheet of its own, and a body.
pub(super) fn document(title: &str, style: &'static str, body: &Markup) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width";
                title { (title) }
                style { (PreEscaped(STYLE)) (PreEscaped(style)) }
            }
            body { (body) }
        }
    };
    page.into_string()
}
