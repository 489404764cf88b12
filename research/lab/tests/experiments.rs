//! All experiments on small bodies: every figure has data, every claim a verdict.

use colltrans_testkit::TemporaryFolder;
use std::collections::BTreeSet;

use colltrans_lab::claims::{CLAIMS, Claim, Verdict};
use colltrans_lab::experiments;
use colltrans_lab::finding::{Figure, Finding, Table};
use colltrans_lab::plan::{Plan, Progress, Scale};

const TINY: Plan = Plan { scale: Scale::Tiny, seed: 1, passes: None, parts: None };

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
    assert_eq!(claim.measured.len(), claim.paper.criteria.len(), "{claim:?}");
    for measured in &claim.measured {
        assert!(measured.value.is_finite(), "{claim:?}");
        assert!(measured.low <= measured.value && measured.value <= measured.high, "{claim:?}");
    }
    for text in [&claim.details, claim.why.as_ref().map_or(&claim.details, |why| &why.text)] {
        assert!(!text.contains("NaN") && !text.contains("inf "), "{claim:?}");
    }
    assert_eq!(claim.verdict, claim.paper.judge(&claim.measured));
    let is_open = matches!(claim.verdict, Verdict::Fails | Verdict::Undecided);
    assert_eq!(is_open, claim.why.is_some(), "{claim:?}");
}

#[test]
fn every_figure_has_data_and_every_claim_a_verdict() {
    let (mut files, mut judged) = (BTreeSet::new(), Vec::new());
    for experiment in experiments() {
        let Finding { figures, tables, claims } = (experiment.run)(&TINY, &mut Rising(0.0));
        assert!(!figures.is_empty() || !tables.is_empty(), "{}", experiment.id);
        let is_of_paper = !["beyond", "casts-2026"].contains(&experiment.id);
        assert_eq!(claims.is_empty(), !is_of_paper, "{}", experiment.id);
        figures.iter().for_each(check_figure);
        tables.iter().for_each(check_table);
        claims.iter().for_each(check_claim);
        judged.extend(claims.iter().map(|claim| claim.paper.id));
        let names = figures.iter().map(|f| &f.id).chain(tables.iter().map(|t| &t.id));
        for name in names {
            assert!(files.insert(name.clone()), "two files are called {name}");
        }
    }
    assert_eq!(judged, CLAIMS.iter().map(|claim| claim.id).collect::<Vec<_>>(), "each claim once");
}

/// Files that are not meshes or not solids, and nested folders.
#[test]
fn real_parts_are_measured_and_other_files_skipped() {
    let folder = TemporaryFolder::new();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    std::fs::create_dir(folder.path().join("deeper")).unwrap();
    let off = "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
    write("deeper/tetrahedron.off", off);
    write("flat.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    write("broken.stl", "solid nothing");
    write("notes.txt", "not a mesh");
    let beyond = experiments().iter().find(|e| e.id == "beyond").expect("other shapes");
    let plan = Plan { parts: Some(folder.path().into()), ..TINY };
    let tables = (beyond.run)(&plan, &mut Rising(0.0)).tables;
    let parts = tables.iter().find(|table| table.id == "beyond-parts").expect("the parts");
    assert_eq!(parts.rows.len(), 1);
    assert_eq!(parts.rows[0][0], "deeper/tetrahedron.off, 4");
    assert!(parts.title.contains("2 files hold no solid"), "{}", parts.title);
}

/// Figure 13 contains only steps, which are counted and not timed.
#[test]
fn equal_seeds_yield_equal_steps() {
    let experiment = experiments().iter().find(|e| e.id == "figure-13").expect("figure 13");
    let run = |seed| (experiment.run)(&Plan { seed, ..TINY }, &mut Rising(0.0));
    assert_eq!(run(1), run(1));
    assert_ne!(run(1), run(2));
}

#[test]
fn experiments_are_in_order_of_paper() {
    let ids: Vec<_> = experiments().iter().map(|e| e.id).collect();
    let mut expected: Vec<_> = (11..=19).map(|k| format!("figure-{k}")).collect();
    expected.insert(1, "table-1".into());
    expected.insert(0, "section-3".into());
    expected.extend(["beyond".into(), "casts-2026".into()]);
    assert_eq!(ids, expected);
}
