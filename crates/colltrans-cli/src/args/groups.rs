//! The overview of all subcommands in `colltrans --help`: groups in the order in which a user needs them, each with an
//! example.

use clap::Command;

use super::help::fit_to_terminal;

/// Subcommands that answer one kind of question, with an example of one of them.
struct Group {
    question: &'static str,
    commands: &'static [&'static str],
    example: &'static str,
}

/// All groups. Each subcommand is in exactly one.
const GROUPS: [Group; 4] = [
    Group {
        question: "Where bodies are",
        commands: &["info", "distance", "within", "depth", "audit"],
        example: "colltrans distance left.obj right.obj",
    },
    Group {
        question: "How far a body can move, or when it touches",
        commands: &["clearance", "cast", "motion", "path"],
        example: "colltrans clearance drawer.stl --from cabinet.stl --direction -y",
    },
    Group {
        question: "All ways out",
        commands: &["directions", "assembly"],
        example: "colltrans assembly parts/ -o plan",
    },
    Group {
        question: "Many queries, proofs, formats and this program",
        commands: &["batch", "verify", "replay", "setup", "files", "json"],
        example: "colltrans batch queries.jsonl -o results.jsonl",
    },
];

/// Returns the template of the program's help, with all groups. `all` has the subcommands.
pub(super) fn template(all: &Command) -> String {
    let groups: Vec<_> = GROUPS.iter().map(|group| group.text(all)).collect();
    let groups = groups.join("\n\n");
    format!(
        "{{about-with-newline}}\n{{usage-heading}} {{usage}}\n\n{groups}\n\n\
        `colltrans COMMAND --help` describes a command.\n\nOptions:\n\
        {{options}}{{after-help}}"
    )
}

impl Group {
    /// Returns the lines of the group. `all` has the subcommands.
    fn text(&self, all: &Command) -> String {
        let width = GROUPS.iter().flat_map(|g| g.commands).map(|c| c.len()).max().unwrap_or(0);
        let line = |name: &&str| {
            let command = all.find_subcommand(name);
            let about = command.and_then(Command::get_about).map(ToString::to_string);
            let mut line = format!("  {name:width$}  {}", about.unwrap_or_default());
            for alias in command.into_iter().flat_map(Command::get_visible_aliases) {
                line.extend([" (or `", alias, "`)"]);
            }
            line
        };
        let lines: Vec<_> = self.commands.iter().map(line).collect();
        let text = format!("{}:\n{}", self.question, lines.join("\n"));
        format!("{}\n    {}", fit_to_terminal(&[&text]), self.example)
    }
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn each_command_is_in_exactly_one_group() {
        let all = super::super::Arguments::command();
        let mut known: Vec<_> = all.get_subcommands().map(Command::get_name).collect();
        let mut shown: Vec<_> = GROUPS.iter().flat_map(|g| g.commands).copied().collect();
        known.sort_unstable();
        shown.sort_unstable();
        assert_eq!(known, shown);
    }

    #[test]
    fn group_examples_parse() {
        for Group { example, .. } in &GROUPS {
            let parsed =
                super::super::Arguments::command().try_get_matches_from(example.split(' '));
            assert!(parsed.is_ok(), "{example}");
        }
    }
}
