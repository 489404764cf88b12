//! All experiments on small bodies: every figure has data, every claim a verdict.

use std::collections::BTreeSet;

use colltrans_lab::experiments;
use colltrans_lab::finding::{Claim, Figure, Finding, Table};
use colltrans_lab::plan::{Plan, Progress, Scale};

const TINY: Plan = Plan { scale: Scale::Tiny, seed: 1 };

/// Progress must rise and stay below the whole.
struct Rising(f64);

impl Progress for Rising {
    fn at(&mut self, done: f64, all: f64, doing: &str) {
        assert!(done >= self.0 && done < all, "{doing}: {done} of {all} after {}", self.0);
        assert!(!doing.is_empty());
        self.0 = done;
    }
}

fn check_figure(figure: &Figure) {
    assert!(!figure.series.is_empty(), "{}", figure.id);
    for series in &figure.series {
        let at = format!("{}, {}", figure.id, series.name);
        assert!(!series.points.is_empty(), "{at}");
        assert!(series.points.is_sorted_by(|a, b| a.x < b.x), "{at}");
        for point in &series.points {
            assert!(point.x.is_finite() && point.y.is_finite(), "{at}: {point:?}");
            assert!(point.low <= point.y && point.y <= point.high, "{at}: {point:?}");
            assert!(!figure.x.log || point.x > 0.0, "{at}: {point:?}");
            assert!(!figure.y.log || point.low > 0.0, "{at}: {point:?}");
        }
        assert!(series.points.iter().any(|p| p.count > 0), "{at}");
    }
    for curve in &figure.references {
        assert!(curve.points.iter().all(|p| p.y.is_finite()), "{}, {}", figure.id, curve.name);
    }
}

fn check_table(table: &Table) {
    assert!(!table.rows.is_empty(), "{}", table.id);
    assert!(table.rows.iter().all(|row| row.len() == table.columns.len()), "{}", table.id);
}

fn check_claim(claim: &Claim) {
    assert!(claim.statement.ends_with('.'), "{claim:?}");
    assert!(claim.measured.chars().any(|c| c.is_ascii_digit()), "{claim:?}");
    assert!(!claim.measured.contains("NaN") && !claim.measured.contains("inf"), "{claim:?}");
    assert_eq!(claim.holds, claim.why.is_none(), "{claim:?}");
}

#[test]
fn every_figure_has_data_and_every_claim_a_verdict() {
    let mut files = BTreeSet::new();
    for experiment in experiments() {
        let Finding { figures, tables, claims } = (experiment.run)(&TINY, &mut Rising(0.0));
        assert!(!figures.is_empty() || !tables.is_empty(), "{}", experiment.id);
        assert!(!claims.is_empty(), "{}", experiment.id);
        figures.iter().for_each(check_figure);
        tables.iter().for_each(check_table);
        claims.iter().for_each(check_claim);
        let names = figures.iter().map(|f| &f.id).chain(tables.iter().map(|t| &t.id));
        for name in names {
            assert!(files.insert(name.clone()), "two files are called {name}");
        }
    }
}

/// Steps are counted, not timed: figure 13 is made of nothing else.
#[test]
fn the_same_seed_gives_the_same_steps() {
    let experiment = experiments().iter().find(|e| e.id == "figure-13").expect("figure 13");
    let run = |seed| (experiment.run)(&Plan { seed, ..TINY }, &mut Rising(0.0));
    assert_eq!(run(1), run(1));
    assert_ne!(run(1), run(2));
}

#[test]
fn all_figures_of_the_paper_are_there_in_its_order() {
    let ids: Vec<_> = experiments().iter().map(|e| e.id).collect();
    let mut expected: Vec<_> = (11..=19).map(|k| format!("figure-{k}")).collect();
    expected.insert(1, "table-1".into());
    assert_eq!(ids, expected);
}
