//! The layout of `-h` and `--help`: one compact table of options in both.
//!
//! clap prints each option of `--help` as a paragraph of its own, 200 lines for a command with 30 options. Here `-h` shows
//! the frequent options, `--help` all of them, both in the table that clap prints for `-h`. Man pages keep clap's layout.

use clap::{Command, CommandFactory};

use super::Arguments;
use super::help::MAX_WIDTH;

const TEMPLATE: &str = "{about-with-newline}\n{usage-heading} {usage}{after-help}";

/// Returns the program with compact help for each subcommand.
pub(crate) fn compact_command() -> Command {
    Arguments::command().mut_subcommands(with_compact_help)
}

/// Moves the table of options into the text after the help, which a template prints without clap's layout.
fn with_compact_help(command: Command) -> Command {
    let mut frequent = command.clone();
    let mut all = command.clone().mut_args(|argument| argument.hide_short_help(false));
    all.build();
    all = all.mut_arg("help", |help| help.help("Print help (frequent options only with '-h')"));
    let [frequent, all] = [&mut frequent, &mut all].map(option_table);
    let short = command.get_after_help().map(ToString::to_string).unwrap_or_default();
    let long = command.get_after_long_help().map(ToString::to_string).unwrap_or_default();
    command
        .help_template(TEMPLATE)
        .after_help(format!("{frequent}\n\n{short}"))
        .after_long_help(format!("{all}\n\n{long}"))
}

/// Returns the table of arguments and options that `-h` shows, with the escape codes of its style.
fn option_table(command: &mut Command) -> String {
    let table = command.clone().max_term_width(MAX_WIDTH).help_template("{all-args}").render_help();
    table.ansi().to_string().trim_end().to_owned()
}
