//! `colltrans`: how far can one body translate before it touches another.
//!
//! Data flow:
//! - [`args`] parses the command line.
//! - [`load`] reads mesh files as convex bodies ([`body`]) or as parts ([`solid`]).
//! - A question calls the library: [`cast`], [`clearance`], [`distance`], [`directions`], [`motion`],
//!   [`path`], and [`scene`] for one body and a scene.
//! - [`driver`] prints the answer as JSON ([`record`]) or as text ([`report`], [`numbers`]), then writes its
//!   proof and its [`picture`]. [`case`] saves a query that does not converge.
//!
//! Other commands: [`batch`] answers every line of a file, [`assembly`] plans for many parts, [`audit`] finds those that
//! are too near, [`info`]
//! describes a mesh, [`replay`] answers a saved query, [`verify`] checks saved proofs, and [`setup`] installs man pages and completions.
//!
//! Files and streams: [`inputs`] reads text and rejects outputs that would overwrite an input. [`outputs`]
//! writes a file completely or not at all. [`terminal`] escapes control characters in names. [`progress`]
//! draws bars.

mod args;
mod assembly;
mod audit;
mod batch;
mod body;
mod case;
mod cast;
mod clearance;
mod directions;
mod distance;
mod driver;
mod failure;
mod info;
mod inputs;
mod load;
mod motion;
mod numbers;
mod outputs;
mod path;
mod picture;
mod progress;
mod record;
mod replay;
mod report;
mod scene;
mod setup;
mod solid;
mod streams;
mod terminal;
mod verify;

use std::io::{self, Write};
use std::path::Path;
use std::process::ExitCode;

use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{CommandFactory, Parser};
use colltrans::record::PairQuestion;

use args::{Arguments, Command, PlacedArguments};
use failure::{Failure, print};

fn main() -> ExitCode {
    std::panic::set_hook(Box::new(|bug| {
        let _ = writeln!(io::stderr(), "error: this is a bug, please report it: {bug}");
    }));
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => return report_parser_result(error),
    };
    let result = match arguments.command {
        Command::Cast(arguments) => cast::run(&arguments),
        Command::Clearance(arguments) if arguments.scene.is_empty() => clearance::run(&arguments),
        Command::Clearance(arguments) => scene::answer_clearance(&arguments),
        Command::Directions(arguments) => directions::run(&arguments),
        Command::Distance(arguments) => answer_pair(&arguments, PairQuestion::Distance),
        Command::Depth(arguments) => answer_pair(&arguments.into_placed(), PairQuestion::Depth),
        Command::Within(arguments) => {
            answer_pair(&arguments.placed, PairQuestion::Within(arguments.length))
        }
        Command::Motion(arguments) => motion::run(&arguments),
        Command::Path(arguments) => path::run(&arguments),
        Command::Batch(arguments) => batch::run(&arguments),
        Command::Assembly(arguments) => assembly::run(&arguments),
        Command::Audit(arguments) => audit::run(&arguments),
        Command::Info(arguments) => info::run(&arguments),
        Command::Replay(arguments) => replay::run(&arguments),
        Command::Verify(arguments) => verify::run(&arguments),
        Command::Setup(arguments) => setup::run(&arguments),
        Command::Files => print(&format!("{}\n", args::files_topic())),
        Command::Json => print(&format!("{}\n", args::json_topic())),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}

/// Answers a question about two bodies without a direction, or about a body and a scene if there is one.
fn answer_pair(arguments: &PlacedArguments, question: PairQuestion) -> Result<(), Failure> {
    if arguments.scene.is_empty() {
        distance::run(arguments, question)
    } else {
        scene::answer_placed(arguments, question)
    }
}

/// Prints the help, the version, or the error of the arguments. Returns the exit code.
///
/// Errors repeat arguments, which may contain control characters; these are escaped.
fn report_parser_result(mut error: clap::Error) -> ExitCode {
    if error.kind() == ErrorKind::DisplayHelp {
        // The layout of help is computed only here, because it renders the help of every subcommand.
        error = args::compact_command().try_get_matches().err().unwrap_or(error);
    }
    if !error.use_stderr() {
        let printed = streams::standard_output().and_then(|mut out| {
            error.print()?;
            out.flush()
        });
        return printed.map_or(ExitCode::FAILURE, |()| ExitCode::SUCCESS);
    }
    if let Some(tip) = usage_tip(&error) {
        error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip.into()]));
    }
    let text = error.render().to_string();
    let _ = io::stderr().write_all(terminal::escape_lines(&text).as_bytes());
    ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2))
}

/// Returns a tip for an unknown argument: the commands that have this option, or how to pass several meshes; `None` for
/// other errors.
fn usage_tip(error: &clap::Error) -> Option<String> {
    let Some(ContextValue::String(unknown)) = error.get(ContextKind::InvalidArg) else {
        return None;
    };
    if error.kind() != ErrorKind::UnknownArgument {
        return None;
    }
    let Some(long) = unknown.strip_prefix("--") else {
        let is_mesh = colltrans_mesh::Format::from_path(Path::new(unknown)).is_ok();
        let tip = "`colltrans clearance MOVING --scene MESH...` takes several meshes as a scene";
        return is_mesh.then(|| tip.to_owned());
    };
    let has_option =
        |command: &&clap::Command| command.get_arguments().any(|a| a.get_long() == Some(long));
    let program = Arguments::command();
    let known = program.get_subcommands().filter(has_option);
    let names: Vec<_> =
        known.map(|command| format!("`colltrans {}`", command.get_name())).collect();
    (!names.is_empty()).then(|| format!("--{long} belongs to {}", names.join(", ")))
}
