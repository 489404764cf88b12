//! The command line.

use std::path::PathBuf;

use clap::builder::{PossibleValue, PossibleValuesParser};
use clap::{Args, Parser, Subcommand};
use colltrans_lab::counting::KINDS;
use colltrans_lab::experiments;
use colltrans_lab::plan::{Plan, Scale};

/// Text after the help: results and exit codes.
const RESULTS: &str = "\
The paper is Mirolo, Carpin and Pagello, \"Incremental Convex Minimization for Computing Collision
Translations of Convex Polyhedra\", IEEE Transactions on Robotics 23(3), 2007, section V.

Results, in the folder given by --output (files of these names are replaced):
  report.html              every figure and table beside the claims it supports or refutes, and
                           where the numbers come from; one page that needs nothing else
  claims.json              every claim with its numbers, intervals and verdict, for programs
  figure-NN....csv         the data: series,x,y,low,high,count (section-3... are those of section III)
  figure-NN....svg, .png   the figure
  table-N....csv           the table

Progress and the remaining time are written to standard error. Times are those of this machine: do not use it
while it measures.

Exit codes:
  0  measured (claims may hold or not)
  2  the command line is wrong
  5  the results cannot be written";

/// The experiments of the paper, repeated on this machine
#[derive(Debug, Parser)]
#[command(name = "colltrans-lab", version, after_help = RESULTS)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Some of the figures
    #[command(after_help = RESULTS)]
    Figure {
        /// The figures' numbers in the paper
        #[arg(required = true, value_name = "NUMBER", value_parser = numbers_of("figure-"))]
        numbers: Vec<String>,
        #[command(flatten)]
        options: Options,
    },
    /// Some of the tables
    #[command(after_help = RESULTS)]
    Table {
        /// The tables' numbers in the paper
        #[arg(required = true, value_name = "NUMBER", value_parser = numbers_of("table-"))]
        numbers: Vec<String>,
        #[command(flatten)]
        options: Options,
    },
    /// Section III: what a step of the minimisation does
    #[command(after_help = RESULTS)]
    Section {
        /// The section's number in the paper
        #[arg(required = true, value_name = "NUMBER", value_parser = numbers_of("section-"))]
        numbers: Vec<String>,
        #[command(flatten)]
        options: Options,
    },
    /// Other shapes than the paper's, and real parts
    #[command(after_help = RESULTS)]
    Beyond {
        #[command(flatten)]
        options: Options,
    },
    /// Algorithms for neighbouring questions on the same bodies: overlap, growth distance, ray cast
    #[command(after_help = RESULTS)]
    Casts {
        #[command(flatten)]
        options: Options,
    },
    /// All figures and tables
    #[command(after_help = RESULTS)]
    All {
        #[command(flatten)]
        options: Options,
    },
    /// Queries without timing, for research/lab/instructions.py, which counts their instructions
    #[command(hide = true)]
    Count {
        /// The kind of the bodies
        #[arg(value_parser = KINDS)]
        kind: String,
        /// The number of vertices of each body
        #[arg(value_parser = clap::value_parser!(u32).range(50..=200_000))]
        vertices: u32,
        /// The number of queries of each contestant
        #[arg(value_parser = clap::value_parser!(u32).range(1..=1000))]
        queries: u32,
    },
    /// The paper's figures 1 to 10, reproduced: two cubes, and the steps of the algorithm
    ///
    /// Nothing is measured, so the pictures are equal on every machine. They are those of docs/paper.md.
    Pictures {
        /// The folder of the pictures, created if it does not exist
        #[arg(short, long, value_name = "DIR", default_value = "docs/figures")]
        output: PathBuf,
    },
}

#[derive(Debug, Args)]
pub(crate) struct Options {
    /// All sizes, few queries: everything in under three minutes (the default)
    #[arg(long)]
    quick: bool,
    /// All sizes, eight pairs of bodies of each, many queries: everything in under half an hour
    #[arg(long, conflicts_with = "quick")]
    full: bool,
    /// Small bodies, for tests
    #[arg(long, hide = true, conflicts_with_all = ["quick", "full"])]
    tiny: bool,
    /// Seed of all random numbers
    ///
    /// The same seed draws the same bodies, positions and directions. Times still differ.
    #[arg(long, value_name = "S", default_value_t = 2007)]
    seed: u64,
    /// Pairs of bodies of each size, measured in passes one after the other: more make intervals narrower
    ///
    /// Quick runs take 4, and 2 from 20,000 vertices, full ones 8.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100))]
    passes: Option<u32>,
    /// A folder with mesh files of real parts, which `beyond` measures in addition to other shapes
    #[arg(long, value_name = "DIR", value_parser = existing_folder)]
    parts: Option<PathBuf>,
    /// The folder of the results, created if it does not exist
    #[arg(short, long, value_name = "DIR", default_value = "lab-results")]
    pub(crate) output: PathBuf,
}

impl Options {
    /// Returns the plan for these options.
    pub(crate) fn plan(&self) -> Plan {
        let scale = match self {
            Self { full: true, .. } => Scale::Full,
            Self { tiny: true, .. } => Scale::Tiny,
            _ => Scale::Quick,
        };
        Plan { scale, seed: self.seed, passes: self.passes, parts: self.parts.clone() }
    }
}

/// Returns the path of an existing folder.
fn existing_folder(path: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(path);
    if path.is_dir() { Ok(path) } else { Err("no such folder; give an existing one".to_owned()) }
}

/// Returns the accepted numbers of experiments with an identifier prefix, for help and errors.
fn numbers_of(prefix: &'static str) -> PossibleValuesParser {
    let numbers = experiments().iter().filter_map(|experiment| {
        let number = experiment.id.strip_prefix(prefix)?;
        Some(PossibleValue::new(number).help(experiment.title))
    });
    numbers.collect::<Vec<_>>().into()
}
