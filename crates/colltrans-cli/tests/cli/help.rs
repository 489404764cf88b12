//! The size of the help of each subcommand.

use crate::support::{answered, folder};

/// Subcommands in the order of `colltrans --help`.
const COMMANDS: [&str; 18] = [
    "info",
    "distance",
    "within",
    "depth",
    "audit",
    "clearance",
    "cast",
    "motion",
    "path",
    "directions",
    "assembly",
    "batch",
    "verify",
    "replay",
    "setup",
    "files",
    "json",
    "",
];

#[test]
fn help_has_at_most_90_lines_and_short_help_at_most_40() {
    let folder = folder();
    let mut too_long = Vec::new();
    for command in COMMANDS {
        for (flag, most) in [("--help", 90), ("-h", 40)] {
            let words: Vec<&str> = [command, flag].into_iter().filter(|w| !w.is_empty()).collect();
            let text = answered(folder.path(), &words);
            let lines = text.lines().count();
            if lines > most {
                too_long.push(format!("{command} {flag}: {lines} lines, at most {most}"));
            }
            assert!(
                text.lines().all(|line| line.chars().count() <= 100),
                "{command} {flag}: {text}"
            );
        }
    }
    assert!(too_long.is_empty(), "{too_long:#?}");
}

#[test]
fn overview_lists_each_command_in_order() {
    let overview = answered(folder().path(), &["--help"]);
    let place = |command: &str| overview.find(&format!("\n  {command} "));
    let places: Vec<_> = COMMANDS[..17].iter().map(|command| place(command)).collect();
    assert!(places.iter().all(Option::is_some) && places.is_sorted(), "{overview}");
}
