//! `colltrans-lab`: the experiments of the paper, run anew.

mod args;

use std::fmt::Display;
use std::io::{self, IsTerminal, Write};
use std::process::ExitCode;

use clap::Parser;
use colltrans_lab::plan::Progress;
use colltrans_lab::{Experiment, LabError, experiments};
use indicatif::{ProgressBar, ProgressStyle};

use args::{Arguments, Command};

/// The exit code where results cannot be written, as `--help` documents it.
const CANNOT_WRITE: u8 = 5;

fn main() -> ExitCode {
    let (chosen, options) = match Arguments::parse().command {
        Command::Figure { numbers, options } => (choose("figure-", &numbers), options),
        Command::Table { numbers, options } => (choose("table-", &numbers), options),
        Command::Beyond { options } => (choose("", &["beyond".into()]), options),
        Command::All { options } => (experiments().to_vec(), options),
        Command::Pictures { output } => return said(&colltrans_lab::figures::write(&output)),
    };
    let mut bar = Bar::new();
    let result = colltrans_lab::run(&chosen, &options.plan(), &mut bar, &options.output);
    bar.0.finish_and_clear();
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

/// The progress of the run. It is drawn when something is reported and by no thread of its own, which
/// would disturb what is measured; nothing where nobody looks at it.
struct Bar(ProgressBar);

impl Bar {
    /// Parts in which an experiment is counted.
    const FINENESS: f64 = 1000.0;

    fn new() -> Self {
        if !io::stderr().is_terminal() {
            return Self(ProgressBar::hidden());
        }
        let template = "{bar:30} {percent:>3} %, {eta} left: {wide_msg}";
        let style = ProgressStyle::with_template(template);
        Self(ProgressBar::new(0).with_style(style.unwrap_or(ProgressStyle::default_bar())))
    }
}

impl Progress for Bar {
    fn at(&mut self, done: f64, all: f64, doing: &str) {
        self.0.set_length((Self::FINENESS * all) as u64);
        self.0.set_position((Self::FINENESS * done) as u64);
        self.0.set_message(doing.to_owned());
    }
}
