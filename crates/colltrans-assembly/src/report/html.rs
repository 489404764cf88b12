//! HTML files for print and screen. The report has a first page, the bill of materials, a page for each step and further
//! sections; like steps share a sheet of paper. The instructions have the steps of assembly. A file is self-contained, with pictures as inline SVG. Without scripts only the viewer is missing.
//!
//! `maud` escapes every inserted text. Only content of this crate (style, script) and pictures drawn by it
//! are inserted unescaped, marked by [`PreEscaped`] (see `picture_markup`).

use std::ops::Range;

use maud::{DOCTYPE, Markup, PreEscaped, html};
use rayon::prelude::*;

use super::{Analysis, Order, Report, after, bill, cover, sheet, tables, viewer};

/// Style sheet of the report.
const STYLE: &str = include_str!("../../assets/report.css");

/// Returns the report as an HTML document: the bill of materials, the steps in the order of the plan, and all findings.
pub fn report_page(f: &Analysis, title: &str) -> String {
    let r = Report::new(f, Order::Disassembly);
    let body = html! {
        main {
            (cover::cover_page(&r, title))
            (viewer::viewer_section(f))
            (bill::bill_section(&r))
            (step_pages(&r))
            (after::after_section(&r))
        }
        (tables::all_tables(&r))
    };
    document(title, "", &body)
}

/// Returns instructions that put the assembly together, as an HTML document for print: the bill of materials, the
/// first parts, and the steps of the plan in reverse order with reversed moves.
pub fn instructions_page(f: &Analysis, title: &str) -> String {
    let r = Report::new(f, Order::Assembly);
    let title = format!("Assembly of {title}");
    let body = html! {
        main {
            (cover::cover_page(&r, &title))
            (bill::bill_section(&r))
            (sheet::first_parts_page(&r))
            (step_pages(&r))
        }
    };
    document(&title, "", &body)
}

/// Returns the pages of all steps in the order of the document.
fn step_pages(r: &Report) -> Markup {
    let stages = r.f.plan.stages();
    let mut pages: Vec<Vec<&Range<usize>>> = Vec::new();
    for (run, times) in &r.f.plan.repeated_stages(&stages) {
        for k in run.clone() {
            pages.push((0..*times).map(|time| &stages[k + time * run.len()]).collect());
        }
    }
    if r.is_assembly() {
        pages.reverse();
        for repeats in &mut pages {
            repeats.reverse();
        }
    }
    let sheets: Vec<Vec<Markup>> = sheet::like_pages(r, &pages)
        .into_par_iter()
        .map(|run| run.iter().map(|repeats| sheet::step_page(r, repeats)).collect())
        .collect();
    html! {
        @for run in &sheets {
            @match &run[..] {
                [one] => (one),
                several => div class=(format!("like of-{}", several.len())) { @for sheet in several { (sheet) } },
            }
        }
    }
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
