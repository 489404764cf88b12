//! Runs experiments and leaves what they find in a folder.
//!
//! The folder gets, for each figure, `ID.csv`, `ID.svg` and `ID.png`, for each table `ID.csv`, the
//! claims with their verdicts in `claims.json`, and one `report.html`. Everything is written as soon
//! as it is known: a long run that is interrupted leaves a report about what was finished, and a
//! folder that cannot be written to is found out before anything is measured.

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
use colltrans_testkit::provenance::{Provenance, for_people};

/// What a run found, in short: its [`Display`](fmt::Display) is for people.
#[derive(Debug, Clone)]
pub struct Summary {
    /// The experiments, in the order in which they were run.
    pub done: Vec<Done>,
    /// Where the numbers come from.
    pub provenance: Provenance,
    /// The report.
    pub report: PathBuf,
    /// How long everything took.
    pub wall: Duration,
}

/// Runs the experiments, one after the other, and writes what they find to `directory`, which is
/// made if it does not exist. Files of the same names are replaced, others left alone.
///
/// `progress` is told about the whole run, each experiment counting as the seconds that it is expected to take.
///
/// # Errors
///
/// The first file that cannot be written ends the run.
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
        write(&directory.join("claims.json"), claims.as_bytes())?;
        write(&path, report::html(&report).as_bytes())
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

fn write_finding(finding: &Finding, directory: &Path) -> Result<Vec<Picture>, LabError> {
    for table in &finding.tables {
        write(&directory.join(format!("{}.csv", table.id)), csv::table(table).as_bytes())?;
    }
    let mut pictures = Vec::new();
    for figure in &finding.figures {
        let file = |ending: &str| directory.join(format!("{}.{ending}", figure.id));
        write(&file("csv"), csv::figure(figure).as_bytes())?;
        let picture = draw(figure)
            .map_err(|reason| LabError::Picture { figure: figure.id.clone(), reason })?;
        write(&file("svg"), picture.svg.as_bytes())?;
        write(&file("png"), &picture.png)?;
        pictures.push(picture);
    }
    Ok(pictures)
}

fn write(path: &Path, bytes: &[u8]) -> Result<(), LabError> {
    std::fs::write(path, bytes).map_err(|source| LabError::Write { path: path.into(), source })
}

/// The progress of one experiment as a part of the whole run.
struct Part<'p> {
    name: String,
    /// Expected seconds: of those before, of this one, and of all.
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
        if let Some(readings) = report::readings(&self.done) {
            writeln!(f, "{readings}")?;
        }
        if !self.provenance.is_optimised {
            writeln!(f, "{}", report::UNOPTIMISED)?;
        }
        let verdicts = report::count(&self.done);
        writeln!(f, "{verdicts}, {}. Report: {}", for_people(self.wall), self.report.display())
    }
}
