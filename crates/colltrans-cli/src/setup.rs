//! `colltrans setup`: writes man pages and completions, generated from the arguments, to the folders in which `man` and
//! shells search.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use clap::{Command, CommandFactory};
use clap_complete::Shell;

use crate::args::{Arguments, SetupArguments};
use crate::failure::{Code, Failure, print};
use crate::outputs::Output;

/// Paths of the completions below a prefix, for the shells that search there.
const COMPLETION_PATHS: [(Shell, &str); 3] = [
    (Shell::Bash, "share/bash-completion/completions/colltrans"),
    (Shell::Zsh, "share/zsh/site-functions/_colltrans"),
    (Shell::Fish, "share/fish/vendor_completions.d/colltrans.fish"),
];

/// Folder of the man pages below a prefix.
const MAN_FOLDER: &str = "share/man/man1";

/// Answers the command: prints the completions of one shell, or writes all files and prints their paths.
pub(crate) fn run(arguments: &SetupArguments) -> Result<(), Failure> {
    if let Some(shell) = arguments.print {
        return print(&completion_script(shell)?);
    }
    let prefix = match &arguments.prefix {
        Some(prefix) => prefix.clone(),
        None => home_folder()?.join(".local"),
    };
    for (place, text) in generated_files()? {
        let path = prefix.join(place);
        write_file(&path, &text).map_err(|error| Failure::write_error(path.display(), &error))?;
        print(&format!("{}\n", path.display()))?;
    }
    Ok(())
}

/// Returns the home folder.
///
/// # Errors
/// The home folder is unknown.
fn home_folder() -> Result<PathBuf, Failure> {
    let why = "the home folder is unknown; give the folder to write to with --prefix";
    std::env::home_dir()
        .filter(|home| !home.as_os_str().is_empty())
        .ok_or_else(|| Failure::new(Code::Usage, why))
}

/// Returns all files with their paths below a prefix.
fn generated_files() -> Result<Vec<(PathBuf, Vec<u8>)>, Failure> {
    let mut files = Vec::new();
    for (shell, place) in COMPLETION_PATHS {
        files.push((place.into(), completion_script(shell)?.into_bytes()));
    }
    for command in with_subcommands(program_command()) {
        let name = command.get_display_name().unwrap_or(command.get_name()).to_owned();
        let mut page = Vec::new();
        let rendered = clap_mangen::Man::new(command).render(&mut page);
        rendered.map_err(|error| Failure::write_error(&name, &error))?;
        files.push((Path::new(MAN_FOLDER).join(format!("{name}.1")), page));
    }
    Ok(files)
}

/// Returns the program's arguments without the `help` subcommand.
fn program_command() -> Command {
    let mut program = Arguments::command().disable_help_subcommand(true);
    program.build();
    program
}

/// Returns a command and its subcommands. Each has a man page.
fn with_subcommands(program: Command) -> Vec<Command> {
    let subcommands: Vec<_> = program.get_subcommands().cloned().collect();
    std::iter::once(program).chain(subcommands).collect()
}

/// Returns the completions for a shell.
fn completion_script(shell: Shell) -> Result<String, Failure> {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Arguments::command(), "colltrans", &mut script);
    String::from_utf8(script).map_err(|error| Failure::new(Code::Output, error.to_string()))
}

/// Writes a file, and creates its folder.
fn write_file(path: &Path, text: &[u8]) -> io::Result<()> {
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder)?;
    }
    let output = Output::create(path)?;
    io::Write::write_all(&mut output.file()?, text)?;
    output.finish()
}
