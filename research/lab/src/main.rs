//! `colltrans-lab`: repeats the experiments of the paper.

mod args;

use std::fmt::Display;
use std::io::{self, IsTerminal, Write};
use std::path::Path;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use clap::Parser;
use colltrans_lab::plan::{Plan, Progress};
use colltrans_lab::{Experiment, LabError, experiments};
use colltrans_testkit::provenance::readable_duration;
use indicatif::{ProgressBar, ProgressStyle};

use args::{Arguments, Command};

/// Exit code if results cannot be written, as documented in `--help`.
const CANNOT_WRITE: u8 = 5;

fn main() -> ExitCode {
    let (chosen, options) = match Arguments::parse().command {
        Command::Figure { numbers, options } => {
            (selected_experiments("figure-", &numbers), options)
        }
        Command::Table { numbers, options } => (selected_experiments("table-", &numbers), options),
        Command::Section { numbers, options } => {
            (selected_experiments("section-", &numbers), options)
        }
        Command::Beyond { options } => (selected_experiments("", &["beyond".into()]), options),
        Command::Casts { options } => (selected_experiments("casts-", &["2026".into()]), options),
        Command::All { options } => (experiments().to_vec(), options),
        Command::Count { kind, vertices, queries } => {
            let counted =
                colltrans_lab::counting::count_queries(&kind, vertices as usize, queries as usize);
            return print_result(&Ok(counted));
        }
        Command::Pictures { output } => {
            return print_result(&colltrans_lab::figures::write(&output));
        }
    };
    let plan = options.plan();
    announce(&chosen, &plan, &options.output);
    let mut bar = Bar::new();
    let result = colltrans_lab::run(&chosen, &plan, &mut bar, &options.output);
    bar.drawn.finish_and_clear();
    print_result(&result)
}

/// Prints the summary or the error, and returns the exit code.
fn print_result(result: &Result<impl Display, LabError>) -> ExitCode {
    let printed = match result {
        Ok(summary) => io::stdout().write_all(summary.to_string().as_bytes()),
        // `eprintln!` would panic if standard error is closed.
        Err(error) => io::stderr().write_all(format!("error: {error}\n").as_bytes()),
    };
    // A closed pipe is not a failure, because the results are in their folder.
    let is_lost = printed.is_err_and(|error| error.kind() != io::ErrorKind::BrokenPipe);
    if result.is_err() || is_lost { ExitCode::from(CANNOT_WRITE) } else { ExitCode::SUCCESS }
}

/// Returns the experiments with these numbers, in the paper's order.
fn selected_experiments(prefix: &str, numbers: &[String]) -> Vec<Experiment> {
    let is_chosen = |experiment: &&Experiment| {
        let number = experiment.id.strip_prefix(prefix);
        number.is_some_and(|number| numbers.iter().any(|chosen| chosen == number))
    };
    experiments().iter().filter(is_chosen).copied().collect()
}

/// Prints what is measured and the estimated duration.
fn announce(chosen: &[Experiment], plan: &Plan, output: &Path) {
    let seconds: f64 = chosen.iter().map(|experiment| experiment.expected(plan)).sum();
    let names: Vec<_> = chosen.iter().map(Experiment::name).collect();
    let text = format!(
        "Measuring {} ({}), which takes about {}. Results go to {}.\n",
        names.join(", "),
        plan.scale.name(),
        readable_duration(Duration::from_secs_f64(seconds)),
        output.display()
    );
    // Nobody may be listening.
    let _ = io::stderr().write_all(text.as_bytes());
}

/// Progress of the run: a bar on a terminal, otherwise lines at intervals. It is updated only by reports,
/// because a thread of its own would disturb the measurements.
struct Bar {
    drawn: ProgressBar,
    start: Instant,
    /// Time of the last line.
    last_line: Option<Instant>,
}

impl Bar {
    /// Number of steps of the bar.
    const FINENESS: f64 = 1000.0;
    /// Minimum time between two lines.
    const PAUSE: Duration = Duration::from_secs(10);

    fn new() -> Self {
        let drawn = if io::stderr().is_terminal() {
            let style = ProgressStyle::with_template("{bar:30} {percent:>3} %, {wide_msg}");
            let bar = ProgressBar::new(Self::FINENESS as u64);
            bar.with_style(style.unwrap_or(ProgressStyle::default_bar()))
        } else {
            ProgressBar::hidden()
        };
        Self { drawn, start: Instant::now(), last_line: None }
    }
}

impl Progress for Bar {
    fn at(&mut self, done: f64, all: f64, doing: &str) {
        let (share, spent) = ((done / all).clamp(0.0, 1.0), self.start.elapsed());
        // At the beginning, the progress does not permit an estimate.
        let left = if share < 0.01 {
            String::new()
        } else {
            let left = spent.mul_f64((1.0 - share) / share);
            format!(
                "about {} left: ",
                readable_duration(Duration::from_secs(left.as_secs().max(1)))
            )
        };
        self.drawn.set_position((Self::FINENESS * share) as u64);
        self.drawn.set_message(format!("{left}{doing}"));
        let is_due = self.last_line.is_none_or(|last| last.elapsed() >= Self::PAUSE);
        if self.drawn.is_hidden() && is_due {
            let text = format!("{:3.0} %, {left}{doing}\n", 100.0 * share);
            let _ = io::stderr().write_all(text.as_bytes());
            self.last_line = Some(Instant::now());
        }
    }
}
