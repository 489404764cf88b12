//! The commands in groups, each with an example, as `colltrans --help` shows them.

use clap::Command;

use super::help::fitted;

/// Commands that answer one kind of question, and how one of them is asked.
struct Group {
    question: &'static str,
    commands: &'static [&'static str],
    example: &'static str,
}

/// Every command is in one group.
const GROUPS: [Group; 4] = [
    Group {
        question: "How far, or when",
        commands: &["cast", "clearance", "motion", "path"],
        example: "colltrans clearance drawer.stl --from cabinet.stl --direction -y",
    },
    Group {
        question: "Where bodies are",
        commands: &["distance", "depth", "within"],
        example: "colltrans distance left.obj right.obj",
    },
    Group {
        question: "All ways out",
        commands: &["directions", "assembly"],
        example: "colltrans assembly parts/ -o plan",
    },
    Group {
        question: "Many queries, files, and this program",
        commands: &["batch", "info", "replay", "verify", "setup"],
        example: "colltrans batch queries.jsonl -o results.jsonl",
    },
];

/// What clap shows of the program before its options; `all` has its commands.
pub(super) fn template(all: &Command) -> String {
    let groups: Vec<_> = GROUPS.iter().map(|group| group.text(all)).collect();
    let groups = groups.join("\n\n");
    format!(
        "{{about-with-newline}}\n{{usage-heading}} {{usage}}\n\n{groups}\n\n\
        `colltrans COMMAND --help` says all about one.\n\nOptions:\n\
        {{options}}{{after-help}}"
    )
}

impl Group {
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
        format!("{}\n\n    {}", fitted(&[&text]), self.example)
    }
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn every_command_is_in_one_group() {
        let all = super::super::Arguments::command();
        let mut known: Vec<_> = all.get_subcommands().map(Command::get_name).collect();
        let mut shown: Vec<_> = GROUPS.iter().flat_map(|g| g.commands).copied().collect();
        known.sort_unstable();
        shown.sort_unstable();
        assert_eq!(known, shown);
    }

    #[test]
    fn examples_are_taken() {
        for Group { example, .. } in &GROUPS {
            let asked = super::super::Arguments::command().try_get_matches_from(example.split(' '));
            assert!(asked.is_ok(), "{example}");
        }
    }
}
