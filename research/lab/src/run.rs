//! Runs experiments and writes their results to a folder.
//!
//! For each figure the folder contains `ID.csv`, `ID.svg` and `ID.png`, for each table `ID.csv`, the claims
//! with verdicts in `claims.json`, and `report.html`. Files are written as soon as their content is known.
//! Therefore an interrupted run leaves a report about the finished experiments, and a folder that is not
//! writable is detected before anything is measured.

use std::fmt;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crate::claims::PaperClaim;
use crate::draw::{Picture, draw};
use crate::error::LabError;
use crate::finding::Finding;
use crate::plan::{Plan, Progress};
use crate::report::{self, Done, Report};
use crate::{Experiment, claims_json, csv, shapes};
use colltrans_testkit::provenance::{Provenance, readable_duration};

/// Results of a run; the [`Display`](fmt::Display) form is a text for people.
#[derive(Debug, Clone)]
pub struct Summary {
    /// Experiments in the order of execution.
    pub done: Vec<Done>,
    /// Origin of the numbers.
    pub provenance: Provenance,
    /// Path of the report.
    pub report: PathBuf,
    /// Total duration.
    pub wall: Duration,
}

/// Runs the experiments one after the other, and writes their results to `directory`, which is created if
/// necessary. Files of the same names are replaced.
///
/// `progress` receives reports about the whole run, in which each experiment counts with its expected
/// duration.
///
/// # Errors
/// [`LabError`] for the first file that cannot be written, which ends the run.
pub fn run(
    experiments: &[Experiment],
    plan: &Plan,
    progress: &mut dyn Progress,
    directory: &Path,
) -> Result<Summary, LabError> {
    let start = Instant::now();
    let provenance = Provenance::of_this_process(&format!("kuva {} (plots)", kuva::VERSION));
    let path = directory.join("report.html");
    let write_report = |done: &[Done]| {
        let (all, wall) = (experiments.len(), start.elapsed());
        let report = Report { provenance: &provenance, plan, done, all, wall };
        let claims = format!("{:#}\n", claims_json::claims(&report));
        write_file(&directory.join("claims.json"), claims.as_bytes())?;
        write_file(&path, report::html(&report).as_bytes())
    };
    std::fs::create_dir_all(directory)
        .map_err(|source| LabError::Folder { path: directory.into(), source })?;
    let mut done = Vec::new();
    write_report(&done)?;
    for &experiment in experiments {
        let began = Instant::now();
        let mut part = Part {
            name: experiment.name(),
            before: experiments[..done.len()].iter().map(|e| e.expected(plan)).sum(),
            own: experiment.expected(plan),
            all: experiments.iter().map(|e| e.expected(plan)).sum(),
            whole: &mut *progress,
        };
        let finding = (experiment.run)(plan, &mut part);
        shapes::forget_large();
        let wall = began.elapsed();
        let pictures = write_finding(&finding, directory)?;
        done.push(Done { experiment, finding, pictures, wall });
        write_report(&done)?;
    }
    Ok(Summary { done, wall: start.elapsed(), report: path, provenance })
}

/// Writes the tables and figures of an experiment, and returns the pictures.
fn write_finding(finding: &Finding, directory: &Path) -> Result<Vec<Picture>, LabError> {
    for table in &finding.tables {
        write_file(&directory.join(format!("{}.csv", table.id)), csv::table(table).as_bytes())?;
    }
    let mut pictures = Vec::new();
    for figure in &finding.figures {
        let file = |ending: &str| directory.join(format!("{}.{ending}", figure.id));
        write_file(&file("csv"), csv::figure(figure).as_bytes())?;
        let picture = draw(figure)
            .map_err(|reason| LabError::Picture { figure: figure.id.clone(), reason })?;
        write_file(&file("svg"), picture.svg.as_bytes())?;
        write_file(&file("png"), &picture.png)?;
        pictures.push(picture);
    }
    Ok(pictures)
}

/// Writes a file.
fn write_file(path: &Path, bytes: &[u8]) -> Result<(), LabError> {
    std::fs::write(path, bytes).map_err(|source| LabError::Write { path: path.into(), source })
}

/// The progress of one experiment as a part of the whole run.
struct Part<'p> {
    name: String,
    /// Expected durations in seconds of the earlier experiments, of this one, and of all.
    before: f64,
    own: f64,
    all: f64,
    whole: &'p mut dyn Progress,
}

impl Progress for Part<'_> {
    fn at(&mut self, done: f64, all: f64, doing: &str) {
        let share = done / all;
        let share = if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.0 };
        let doing = format!("{}, {doing}", self.name);
        self.whole.at(self.before + self.own * share, self.all, &doing);
    }
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for done in &self.done {
            writeln!(f, "{}: {}", done.experiment.name(), done.experiment.title)?;
            for claim in &done.finding.claims {
                let PaperClaim { id, statement, paper, criteria, .. } = claim.paper;
                writeln!(f, "  {:21}  {id}: {statement} (The paper: {paper}.)", claim.verdict)?;
                for (criterion, measured) in criteria.iter().zip(&claim.measured) {
                    writeln!(f, "  {:21}  {measured}: {}", "", criterion.what)?;
                }
            }
        }
        for line in report::theme_lines(&self.done) {
            writeln!(f, "{line}")?;
        }
        if !self.provenance.is_optimised {
            writeln!(f, "{}", report::UNOPTIMISED)?;
        }
        let verdicts = report::verdict_counts(&self.done);
        writeln!(
            f,
            "{verdicts}, {}. Report: {}",
            readable_duration(self.wall),
            self.report.display()
        )
    }
}
