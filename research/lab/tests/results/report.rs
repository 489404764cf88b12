//! The report is one well-formed, self-contained page with all results.

use std::time::Duration;

use colltrans_lab::Done;
use colltrans_lab::draw::draw;
use colltrans_lab::plan::{Plan, Scale};
use colltrans_lab::report::{Report, html};
use colltrans_testkit::provenance::Provenance;

use crate::made_up::{experiments, finding};
use crate::xml::elements;

fn page(done: &[Done], all: usize, is_optimised: bool) -> String {
    let provenance = Provenance {
        processor: "Abacus <1>".into(),
        cores: "2".into(),
        system: "none".into(),
        versions: "colltrans 0".into(),
        build: "stone".into(),
        date: "2007-06-01 12:00 UTC".into(),
        command: "colltrans-lab all -o 'a & b'".into(),
        is_optimised,
    };
    let plan = Plan { scale: Scale::Full, seed: 42, passes: None, parts: None };
    let wall = Duration::from_secs(200);
    html(&Report { provenance: &provenance, plan: &plan, done, all, wall })
}

fn done() -> Vec<Done> {
    let finding = finding("figure-12");
    let pictures = finding.figures.iter().map(|figure| draw(figure).unwrap()).collect();
    let experiment = experiments()[0];
    vec![Done { experiment, finding, pictures, wall: Duration::from_secs(3) }]
}

#[test]
fn report_contains_all_results() {
    let page = page(&done(), 1, true);
    let found = elements(&page, &["meta", "br"]);
    let count = |name: &str| found.iter().filter(|element| *element == name).count();
    assert_eq!(count("svg"), 2, "the figures are in the page");
    assert_eq!(count("section"), 1);
    for text in [
        "Abacus &lt;1&gt;",
        "2007-06-01 12:00 UTC",
        "colltrans-lab all -o 'a &amp; b'",
        "<dt>Seed</dt><dd>42</dd>",
        "<dt>Scale</dt><dd>full</dd>",
        "3 min 20 s",
        "Figure 12: time against &lt;size&gt;",
        "2 of 4 claims about CTA hold, 1 of them better than the paper states; 1 do not hold, 1 are undecided. \
         0 of 0 claims about other algorithms hold",
        "queries from scratch: 2 of 4 hold; 12-faster does not hold (today's machine), 12-faster undecided",
        "Time grows like log n &amp; not faster",
        "The paper: &lt;log n&gt; (V-A, figure 12).",
        "Measured: <strong>0.12 (0.10 to 0.14)</strong>: exponent; holds from 0.00 to 0.20.",
        "More &lt;about&gt; it.",
        "Why (today's machine): caches hold &lt;64 vertices. Nothing else.",
        "12-faster</a>, today's machine: caches hold &lt;64 vertices.</li>",
        "12-faster</a>, today's machine: too few queries</li>",
        "<span class=\"verdict\">holds</span>",
        "<span class=\"verdict\">does not hold</span>",
        "<span class=\"verdict\">undecided</span>",
        "<span class=\"verdict\">better than the paper</span>",
        "Times, &lt;all&gt; of them",
        "<td class=\"number\">1,000</td>",
        "figure-12-near.csv",
    ] {
        assert!(page.contains(text), "{text:?}");
    }
    assert!(!page.contains("class=\"warning\""));
}

#[test]
fn report_is_self_contained() {
    let page = page(&done(), 1, true);
    for loading in ["<script", "<link", "<img", "src=", "@import", "url(http", "@font-face"] {
        assert!(!page.contains(loading), "{loading}");
    }
    // What remains are the names of namespaces.
    let rest = page.replace("xmlns=\"http://www.w3.org/2000/svg\"", "");
    assert!(!rest.contains("http"));
    for reference in page.split("url(#").skip(1) {
        let id = reference.split(')').next().unwrap();
        assert_eq!(page.matches(&format!("id=\"{id}\"")).count(), 1, "{id} is in it once");
    }
}

#[test]
fn unfinished_and_unoptimised_runs_are_noted() {
    let unfinished = page(&done(), 10, false);
    assert!(unfinished.contains("1 of 10 experiments were finished"));
    assert!(unfinished.contains("unoptimised build"));
    let empty = page(&[], 3, true);
    elements(&empty, &["meta", "br"]);
    assert!(empty.contains("No claim was put to the test"));
}
