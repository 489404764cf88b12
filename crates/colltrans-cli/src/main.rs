//! `colltrans`: how far can one convex body translate before it touches another.
//!
//! The data's way: [`args`] -> [`body`] (mesh file to polyhedron) -> the library's query ->
//! [`record`] (what is said about the answer) -> [`report`] (for people), JSON, or [`picture`].
//! [`batch`] does the same for every line of a file, [`info`] looks at one mesh.

mod args;
mod batch;
mod body;
mod cast;
mod failure;
mod info;
mod picture;
mod record;
mod report;

use std::io::{self, Write};
use std::process::ExitCode;

use clap::Parser;

use args::{Arguments, Command};

fn main() -> ExitCode {
    std::panic::set_hook(Box::new(|bug| {
        let _ = writeln!(io::stderr(), "error: this is a bug, please report it: {bug}");
    }));
    let result = match Arguments::parse().command {
        Command::Cast(arguments) => cast::run(&arguments),
        Command::Batch(arguments) => batch::run(&arguments),
        Command::Info(arguments) => info::run(&arguments),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}
