//! `colltrans-lab`: the experiments of the paper, run anew.

mod args;

use std::fmt::Display;
use std::io::{self, IsTerminal, Write};
use std::path::Path;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use clap::Parser;
use colltrans_lab::plan::{Plan, Progress};
use colltrans_lab::{Experiment, LabError, experiments};
use colltrans_testkit::provenance::for_people;
use indicatif::{ProgressBar, ProgressStyle};

use args::{Arguments, Command};

/// The exit code where results cannot be written, as `--help` documents it.
const CANNOT_WRITE: u8 = 5;

fn main() -> ExitCode {
    let (chosen, options) = match Arguments::parse().command {
        Command::Figure { numbers, options } => (choose("figure-", &numbers), options),
        Command::Table { numbers, options } => (choose("table-", &numbers), options),
        Command::Section { numbers, options } => (choose("section-", &numbers), options),
        Command::Beyond { options } => (choose("", &["beyond".into()]), options),
        Command::All { options } => (experiments().to_vec(), options),
        Command::Pictures { output } => return said(&colltrans_lab::figures::write(&output)),
    };
    let plan = options.plan();
    announce(&chosen, &plan, &options.output);
    let mut bar = Bar::new();
    let result = colltrans_lab::run(&chosen, &plan, &mut bar, &options.output);
    bar.drawn.finish_and_clear();
    said(&result)
}

/// Says what was written, or why it could not be.
fn said(result: &Result<impl Display, LabError>) -> ExitCode {
    let said = match result {
        Ok(summary) => io::stdout().write_all(summary.to_string().as_bytes()),
        // Not `eprintln!`, which panics when standard error is closed.
        Err(error) => io::stderr().write_all(format!("error: {error}\n").as_bytes()),
    };
    // A pipe whose reader has gone is no failure: the results are in their folder.
    let is_lost = said.is_err_and(|error| error.kind() != io::ErrorKind::BrokenPipe);
    if result.is_err() || is_lost { ExitCode::from(CANNOT_WRITE) } else { ExitCode::SUCCESS }
}

/// The experiments with these numbers, in the paper's order.
fn choose(prefix: &str, numbers: &[String]) -> Vec<Experiment> {
    let is_chosen = |experiment: &&Experiment| {
        let number = experiment.id.strip_prefix(prefix);
        number.is_some_and(|number| numbers.iter().any(|chosen| chosen == number))
    };
    experiments().iter().filter(is_chosen).copied().collect()
}

/// Says at once what is to be done and about how long it takes.
fn announce(chosen: &[Experiment], plan: &Plan, output: &Path) {
    let seconds: f64 = chosen.iter().map(|experiment| experiment.expected(plan)).sum();
    let names: Vec<_> = chosen.iter().map(Experiment::name).collect();
    let text = format!(
        "Measuring {} ({}), which takes about {}. Results go to {}.\n",
        names.join(", "),
        plan.scale.name(),
        for_people(Duration::from_secs_f64(seconds)),
        output.display()
    );
    // Nobody may be listening.
    let _ = io::stderr().write_all(text.as_bytes());
}

/// The progress of the run, drawn on a terminal, and as lines from time to time where there is none. It
/// is said when something is reported and by no thread of its own, which would disturb what is measured.
struct Bar {
    drawn: ProgressBar,
    start: Instant,
    /// When the last line was written.
    said: Option<Instant>,
}

impl Bar {
    /// Parts in which the run is counted.
    const FINENESS: f64 = 1000.0;
    /// Between two lines.
    const PAUSE: Duration = Duration::from_secs(10);

    fn new() -> Self {
        let drawn = if io::stderr().is_terminal() {
            let style = ProgressStyle::with_template("{bar:30} {percent:>3} %, {wide_msg}");
            let bar = ProgressBar::new(Self::FINENESS as u64);
            bar.with_style(style.unwrap_or(ProgressStyle::default_bar()))
        } else {
            ProgressBar::hidden()
        };
        Self { drawn, start: Instant::now(), said: None }
    }
}

impl Progress for Bar {
    fn at(&mut self, done: f64, all: f64, doing: &str) {
        let (share, spent) = ((done / all).clamp(0.0, 1.0), self.start.elapsed());
        // Too early to tell from what is done.
        let left = if share < 0.01 {
            String::new()
        } else {
            let left = spent.mul_f64((1.0 - share) / share);
            format!("about {} left: ", for_people(Duration::from_secs(left.as_secs().max(1))))
        };
        self.drawn.set_position((Self::FINENESS * share) as u64);
        self.drawn.set_message(format!("{left}{doing}"));
        let is_due = self.said.is_none_or(|said| said.elapsed() >= Self::PAUSE);
        if self.drawn.is_hidden() && is_due {
            let text = format!("{:3.0} %, {left}{doing}\n", 100.0 * share);
            let _ = io::stderr().write_all(text.as_bytes());
            self.said = Some(Instant::now());
        }
    }
}
