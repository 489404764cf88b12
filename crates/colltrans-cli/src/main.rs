//! `colltrans`: how far can one body translate before it touches another.
//!
//! Data flow: [`args`] -> [`body`] (mesh file to polyhedron)
//! -> the library's `Cast` -> [`record`] (what is said about the answer) -> [`report`]
//! (for people, in [`numbers`] of known digits), JSON, or [`picture`]. [`cast`] drives it for two
//! files, [`batch`] for every line of a file; [`inputs`] keeps outputs off what is read, [`outputs`]
//! writes files whole or not at all, [`terminal`] keeps names from steering it.
//! [`directions`] asks for all directions at once, [`distance`] two bodies where they are, in the same ways, [`among`] one
//! body among many. [`info`] looks at one mesh, [`assembly`] at many parts. [`clearance`] asks two convex meshes by way of [`cast`], all
//! others as parts, which [`solid`] makes of files; [`progress`] shows how far work is. [`verify`]
//! checks saved proofs. [`setup`] installs man pages and completions.

mod among;
mod args;
mod assembly;
mod batch;
mod body;
mod case;
mod cast;
mod clearance;
mod directions;
mod distance;
mod failure;
mod info;
mod inputs;
mod motion;
mod numbers;
mod outputs;
mod path;
mod picture;
mod progress;
mod record;
mod replay;
mod report;
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
use colltrans::record::{PairQuestion, Question};

use args::{Arguments, Command};

fn main() -> ExitCode {
    std::panic::set_hook(Box::new(|bug| {
        let _ = writeln!(io::stderr(), "error: this is a bug, please report it: {bug}");
    }));
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(told) => return told_by_the_parser(told),
    };
    let result = match arguments.command {
        Command::Cast(arguments) => cast::run(&arguments, Question::Contact),
        Command::Clearance(arguments) => clearance::run(&arguments),
        Command::Directions(arguments) => directions::run(&arguments),
        Command::Distance(arguments) => distance::run(&arguments, PairQuestion::Distance),
        Command::Depth(arguments) => distance::run(&arguments, PairQuestion::Depth),
        Command::Within(arguments) => {
            distance::run(&arguments.placed, PairQuestion::Within(arguments.length))
        }
        Command::Motion(arguments) => motion::run(&arguments),
        Command::Path(arguments) => path::run(&arguments),
        Command::Batch(arguments) => batch::run(&arguments),
        Command::Assembly(arguments) => assembly::run(&arguments),
        Command::Info(arguments) => info::run(&arguments),
        Command::Replay(arguments) => replay::run(&arguments),
        Command::Verify(arguments) => verify::run(&arguments),
        Command::Setup(arguments) => setup::run(&arguments),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}

/// Help, the version, or what is wrong with the arguments: these may be names of files, so they are
/// written out where they would steer a terminal.
fn told_by_the_parser(mut told: clap::Error) -> ExitCode {
    if !told.use_stderr() {
        let printed = streams::standard_output().and_then(|mut out| {
            told.print()?;
            out.flush()
        });
        return printed.map_or(ExitCode::FAILURE, |()| ExitCode::SUCCESS);
    }
    if let Some(tip) = tip(&told) {
        told.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip.into()]));
    }
    let text = told.render().to_string();
    let _ = io::stderr().write_all(terminal::plain(&text).as_bytes());
    ExitCode::from(u8::try_from(told.exit_code()).unwrap_or(2))
}

/// Where what a command does not know belongs: an option of other commands, or one mesh more.
fn tip(told: &clap::Error) -> Option<String> {
    let Some(ContextValue::String(unknown)) = told.get(ContextKind::InvalidArg) else {
        return None;
    };
    if told.kind() != ErrorKind::UnknownArgument {
        return None;
    }
    let Some(long) = unknown.strip_prefix("--") else {
        let is_mesh = colltrans_mesh::Format::of_path(Path::new(unknown)).is_ok();
        let tip = "`colltrans clearance MOVING --among MESH...` asks about one body among many";
        return is_mesh.then(|| tip.to_owned());
    };
    let has_it =
        |command: &&clap::Command| command.get_arguments().any(|a| a.get_long() == Some(long));
    let all = Arguments::command();
    let known = all.get_subcommands().filter(has_it);
    let names: Vec<_> =
        known.map(|command| format!("`colltrans {}`", command.get_name())).collect();
    (!names.is_empty()).then(|| format!("--{long} belongs to {}", names.join(", ")))
}
