//! A run and its folder of results.

use colltrans_testkit::TemporaryFolder;
use std::collections::BTreeSet;
use std::path::Path;

use colltrans_lab::plan::{Plan, Progress, Scale};
use colltrans_lab::{LabError, Summary, run};

use crate::made_up::experiments;

const PLAN: Plan = Plan { scale: Scale::Tiny, seed: 31, passes: None, parts: None };

#[derive(Default)]
struct Heard(Vec<(f64, f64, String)>);

impl Progress for Heard {
    fn at(&mut self, done: f64, all: f64, doing: &str) {
        self.0.push((done, all, doing.to_owned()));
    }
}

fn run_in(folder: &Path) -> Result<Summary, LabError> {
    run(&experiments(), &PLAN, &mut Heard::default(), folder)
}

#[test]
fn folder_contains_all_files() {
    let folder = TemporaryFolder::new();
    let results = folder.path().join("not/yet/there");
    let mut heard = Heard::default();
    let summary = run(&experiments(), &PLAN, &mut heard, &results).unwrap();
    let files: BTreeSet<String> = std::fs::read_dir(&results)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    let expected = [
        "claims.json",
        "figure-12-near.csv",
        "figure-12-near.png",
        "figure-12-near.svg",
        "figure-12-table.csv",
        "figure-12.csv",
        "figure-12.png",
        "figure-12.svg",
        "report.html",
        "table-1-table.csv",
    ];
    assert_eq!(files, expected.map(String::from).into());
    assert_eq!(summary.report, results.join("report.html"));
    let report = std::fs::read_to_string(&summary.report).unwrap();
    assert!(report.contains("Figure 12") && report.contains("Table 1"));
    assert!(!report.contains("were finished when"), "the last report is complete");
    let text = std::fs::read_to_string(results.join("claims.json")).unwrap();
    let read: serde_json::Value = serde_json::from_str(&text).unwrap();
    let claims = read["claims"].as_array().unwrap();
    assert_eq!((claims.len(), &read["scale"], &read["seed"]), (8, &"tiny".into(), &31.into()));
    let faster = claims.iter().find(|claim| claim["id"] == "12-faster").unwrap();
    let expected = serde_json::json!({
        "id": "12-faster", "statement": "It is faster than the others.", "paper": "half",
        "place": "V-A, figure 12", "theme": "queries from scratch", "is_about_cta": true,
        "verdict": "does not hold", "why": faster["why"],
        "reason": "today's machine",
        "measured": [{ "what": "ratio", "value": 2.0, "low": 1.5, "high": 2.5, "judged": true }],
    });
    assert_eq!(*faster, expected);
    assert!(faster["why"].is_string(), "{faster}");
    let table = std::fs::read_to_string(results.join("table-1-table.csv")).unwrap();
    assert!(table.ends_with("31,31,31\n"), "the plan reaches the experiments");
    let parts: Vec<_> = heard.0.iter().map(|(done, all, what)| (*done, *all, &**what)).collect();
    let expected = [
        (0.25, 2.0, "Figure 12, bodies"),
        (1.0, 2.0, "Figure 12, queries"),
        (1.25, 2.0, "Table 1, bodies"),
        (2.0, 2.0, "Table 1, queries"),
    ];
    assert_eq!(parts, expected);
}

#[test]
fn summary_lists_claims() {
    let folder = TemporaryFolder::new();
    let text = run_in(folder.path()).unwrap().to_string();
    assert!(
        text.starts_with("Figure 12: time against <size>\n  holds                  12-grows: Time"),
        "{text}"
    );
    assert!(
        text.contains("\n  does not hold          12-faster: It is faster than the others."),
        "{text}"
    );
    assert!(text.lines().last().unwrap().starts_with("4 of 8 claims about CTA hold, "), "{text}");
}

#[test]
fn data_and_pictures_are_reproducible() {
    let [one, two] = [(); 2].map(|()| TemporaryFolder::new());
    run_in(one.path()).unwrap();
    run_in(two.path()).unwrap();
    for name in ["figure-12.csv", "figure-12.svg", "figure-12.png", "figure-12-table.csv"] {
        let [a, b] = [&one, &two].map(|folder| std::fs::read(folder.path().join(name)).unwrap());
        assert!(a == b, "{name}");
    }
}

#[test]
fn folder_that_cannot_be_created_is_an_error() {
    let folder = TemporaryFolder::new();
    let file = folder.path().join("file");
    std::fs::write(&file, "").unwrap();
    let error = run_in(&file.join("results")).unwrap_err();
    assert!(matches!(&error, LabError::Folder { path, .. } if *path == file.join("results")));
    assert!(error.to_string().contains("file/results: cannot create the folder: "), "{error}");
}

#[test]
fn file_that_cannot_be_written_is_an_error() {
    let folder = TemporaryFolder::new();
    std::fs::create_dir(folder.path().join("figure-12.svg")).unwrap();
    let error = run_in(folder.path()).unwrap_err();
    let path = folder.path().join("figure-12.svg");
    assert!(matches!(&error, LabError::Write { path: at, .. } if *at == path), "{error}");
    let report = std::fs::read_to_string(folder.path().join("report.html")).unwrap();
    assert!(report.contains("0 of 2 experiments were finished"));
}

#[cfg(target_os = "linux")]
#[test]
fn full_disk_is_an_error() {
    let folder = TemporaryFolder::new();
    std::os::unix::fs::symlink("/dev/full", folder.path().join("report.html")).unwrap();
    let LabError::Write { path, source } = run_in(folder.path()).unwrap_err() else {
        panic!("not about writing")
    };
    assert!(path.ends_with("report.html"));
    assert_eq!(source.kind(), std::io::ErrorKind::StorageFull);
}
