//! Man pages and completions of this program, made of its own arguments, where shells and `man` look for them.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use clap::{Command, CommandFactory};
use clap_complete::Shell;

use crate::args::{Arguments, SetupArguments};
use crate::failure::{Code, Failure, print};
use crate::outputs::Output;

/// Where under a prefix a shell looks for completions, and which shells that is so of.
const PLACES: [(Shell, &str); 3] = [
    (Shell::Bash, "share/bash-completion/completions/colltrans"),
    (Shell::Zsh, "share/zsh/site-functions/_colltrans"),
    (Shell::Fish, "share/fish/vendor_completions.d/colltrans.fish"),
];

const PAGES: &str = "share/man/man1";

pub(crate) fn run(arguments: &SetupArguments) -> Result<(), Failure> {
    if let Some(shell) = arguments.print {
        return print(&completions(shell)?);
    }
    let prefix = match &arguments.prefix {
        Some(prefix) => prefix.clone(),
        None => home()?.join(".local"),
    };
    for (place, text) in files()? {
        let path = prefix.join(place);
        write(&path, &text).map_err(|error| Failure::output(path.display(), &error))?;
        print(&format!("{}\n", path.display()))?;
    }
    Ok(())
}

fn home() -> Result<PathBuf, Failure> {
    let why = "no home folder is known: --prefix says where to write";
    std::env::home_dir()
        .filter(|home| !home.as_os_str().is_empty())
        .ok_or_else(|| Failure::new(Code::Usage, why))
}

/// All files, by their places under a prefix.
fn files() -> Result<Vec<(PathBuf, Vec<u8>)>, Failure> {
    let mut files = Vec::new();
    for (shell, place) in PLACES {
        files.push((place.into(), completions(shell)?.into_bytes()));
    }
    for command in with_parts(program()) {
        let name = command.get_display_name().unwrap_or(command.get_name()).to_owned();
        let mut page = Vec::new();
        let made = clap_mangen::Man::new(command).render(&mut page);
        made.map_err(|error| Failure::output(&name, &error))?;
        files.push((Path::new(PAGES).join(format!("{name}.1")), page));
    }
    Ok(files)
}

/// The program's arguments, with the groups of `--help` left to the terminal.
fn program() -> Command {
    let mut program = Arguments::command().disable_help_subcommand(true);
    program.build();
    program
}

/// A command and its subcommands, each of which has a page.
fn with_parts(program: Command) -> Vec<Command> {
    let parts: Vec<_> = program.get_subcommands().cloned().collect();
    std::iter::once(program).chain(parts).collect()
}

fn completions(shell: Shell) -> Result<String, Failure> {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Arguments::command(), "colltrans", &mut script);
    String::from_utf8(script).map_err(|error| Failure::new(Code::Output, error.to_string()))
}

fn write(path: &Path, text: &[u8]) -> io::Result<()> {
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder)?;
    }
    let output = Output::create(path)?;
    io::Write::write_all(&mut output.file()?, text)?;
    output.finish()
}
