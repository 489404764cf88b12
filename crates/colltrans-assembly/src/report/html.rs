//! One HTML file to be printed and looked at: a first page, a page for each step, and what else is known. Offline, its
//! pictures drawn into it; without scripts only the viewer is missing.
//!
//! Written with `maud`, which escapes every text that is put in. Let through as they are, and marked
//! [`PreEscaped`], are only what this crate holds (style, script) or draws (pictures, see `picture`).

use std::ops::Range;

use maud::{DOCTYPE, Markup, PreEscaped, html};
use rayon::prelude::*;

use super::{Findings, Report, after, cover, sheet, tables, viewer};

const STYLE: &str = include_str!("../../assets/report.css");

/// The report.
pub fn page(f: &Findings, title: &str) -> String {
    let r = Report::new(f);
    let stages = f.plan.stages();
    let repeats = f.plan.repeats(&stages);
    let mut drawn: Vec<Vec<&Range<usize>>> = Vec::new();
    for (run, times) in &repeats {
        for k in run.clone() {
            drawn.push((0..*times).map(|time| &stages[k + time * run.len()]).collect());
        }
    }
    let sheets: Vec<Markup> = drawn.par_iter().map(|again| sheet::page(&r, again)).collect();
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width";
                title { (title) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                main {
                    (cover::page(&r, title))
                    (viewer::section(f))
                    @for sheet in sheets { (sheet) }
                    (after::section(&r))
                }
                (tables::all(f))
            }
        }
    };
    page.into_string()
}
