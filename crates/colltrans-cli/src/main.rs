//! `colltrans`: how far can one convex body translate before it touches another.
//!
//! The data's way: [`args`] -> [`body`] (mesh file to polyhedron; [`excess`]: what a hull has more)
//! -> [`query`] (the library's part) -> [`record`] (what is said about the answer) -> [`report`]
//! (for people, in [`numbers`] of known digits), JSON, or [`picture`]. [`cast`] drives it for two
//! files, [`batch`] for every line of a file; [`inputs`] keeps outputs off what is read.
//! [`info`] looks at one mesh.

mod args;
mod batch;
mod body;
mod cast;
mod excess;
mod failure;
mod info;
mod inputs;
mod numbers;
mod picture;
mod query;
mod record;
mod replay;
mod report;

use std::io::{self, Write};
use std::process::ExitCode;

use clap::Parser;

use args::{Arguments, Command};
use cast::Asked;

fn main() -> ExitCode {
    std::panic::set_hook(Box::new(|bug| {
        let _ = writeln!(io::stderr(), "error: this is a bug, please report it: {bug}");
    }));
    let result = match Arguments::parse().command {
        Command::Cast(arguments) => cast::run(&arguments, Asked::Contact),
        Command::Clearance(arguments) => cast::run(&arguments, Asked::Clearance),
        Command::Batch(arguments) => batch::run(&arguments),
        Command::Info(arguments) => info::run(&arguments),
        Command::Replay(arguments) => replay::run(&arguments),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}
