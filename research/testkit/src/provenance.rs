//! Describes the origin of numbers: machine, build, date and command.

use std::path::Path;
use std::thread::available_parallelism;
use std::time::{Duration, SystemTime};

use chrono::{DateTime, Utc};
use serde_json::{Value, json};

/// The circumstances of a run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Provenance {
    /// The model of the processor.
    pub processor: String,
    /// Number of cores that this process may use.
    pub cores: String,
    /// The operating system and the architecture.
    pub system: String,
    /// Versions of the library, the compiler and other dependencies of the numbers.
    pub versions: String,
    /// The build settings.
    pub build: String,
    /// Date and minute of the start, UTC.
    pub date: String,
    /// The command line.
    pub command: String,
    /// Whether the build is optimised, so that its times are meaningful.
    pub is_optimised: bool,
}

impl Provenance {
    /// Describes this process. `other` is the version of another dependency of the numbers.
    pub fn of_this_process(other: &str) -> Self {
        let version = env!("CARGO_PKG_VERSION");
        let compiler = env!("COLLTRANS_TESTKIT_COMPILER");
        Self {
            processor: processor_model().unwrap_or_else(unknown_text),
            cores: available_parallelism()
                .map_or_else(|_| unknown_text(), |count| count.to_string()),
            system: operating_system(),
            versions: format!("colltrans {version}; {compiler}; {other}"),
            build: env!("COLLTRANS_TESTKIT_BUILD").into(),
            date: DateTime::<Utc>::from(SystemTime::now()).format("%Y-%m-%d %H:%M UTC").to_string(),
            command: command_line(std::env::args()),
            is_optimised: !cfg!(debug_assertions),
        }
    }

    /// Returns the object with which the report of a run begins: `date`, `command_line`, `machine` (`cpu`, `cores`,
    /// `operating_system`), `versions`, `build`.
    pub fn to_json(&self) -> Value {
        json!({
            "date": self.date,
            "command": self.command,
            "machine": { "cpu": self.processor, "cores": self.cores, "system": self.system },
            "versions": self.versions,
            "build": self.build,
        })
    }
}

/// Returns the text for an unknown value.
fn unknown_text() -> String {
    "unknown".into()
}

/// Returns the model of the processor; `None` if it is unknown.
fn processor_model() -> Option<String> {
    let from_file = || {
        let text = std::fs::read_to_string("/proc/cpuinfo").ok()?;
        let line = text.lines().find(|line| line.starts_with("model name"))?;
        Some(line.split_once(':')?.1.trim().to_owned())
    };
    let from_program = || {
        let mut program = std::process::Command::new("sysctl");
        let output = program.args(["-n", "machdep.cpu.brand_string"]).output().ok()?;
        let name = String::from_utf8(output.stdout).ok()?.trim().to_owned();
        (!name.is_empty()).then_some(name)
    };
    let from_environment = || std::env::var("PROCESSOR_IDENTIFIER").ok();
    match std::env::consts::OS {
        "linux" => from_file(),
        "macos" => from_program(),
        _ => from_environment(),
    }
}

/// Returns the operating system with its release, and the architecture.
fn operating_system() -> String {
    use std::env::consts::{ARCH, OS};
    let release = std::fs::read_to_string("/proc/sys/kernel/osrelease").unwrap_or_default();
    match release.trim() {
        "" => format!("{OS}, {ARCH}"),
        release => format!("{OS} {release}, {ARCH}"),
    }
}

/// Returns the command line with shell quoting. Absolute paths are reduced to their last component, because
/// folders are specific to the machine.
fn command_line(mut arguments: impl Iterator<Item = String>) -> String {
    let named = |path: &str| path.rsplit(['/', '\\']).next().unwrap_or_default().to_owned();
    let name = named(&arguments.next().unwrap_or_default());
    let quoted = arguments.map(|argument| {
        let (option, value) = argument.split_once('=').unwrap_or(("", &argument));
        let argument = match (Path::new(value).has_root(), option) {
            (false, _) => argument,
            (true, "") => named(value),
            (true, option) => format!("{option}={}", named(value)),
        };
        let is_plain = |c: char| c.is_alphanumeric() || "-_./=,:".contains(c);
        if !argument.is_empty() && argument.chars().all(is_plain) {
            argument
        } else {
            format!("'{}'", argument.replace('\'', r"'\''"))
        }
    });
    std::iter::once(name).chain(quoted).collect::<Vec<_>>().join(" ")
}

/// Formats a duration for readers: `0.4 s`, `12 s`, `3 min 20 s`, `1 h 2 min`.
pub fn readable_duration(duration: Duration) -> String {
    let seconds = duration.as_secs();
    match seconds {
        0..10 => format!("{:.1} s", duration.as_secs_f64()),
        10..60 => format!("{seconds} s"),
        60..3600 => format!("{} min {} s", seconds / 60, seconds % 60),
        _ => format!("{} h {} min", seconds / 3600, seconds / 60 % 60),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_are_printed_for_reuse() {
        let typed = |arguments: &[&str]| command_line(arguments.iter().map(|a| (*a).to_owned()));
        assert_eq!(
            typed(&["/a b/colltrans-lab", "all", "-o", "my dir"]),
            "colltrans-lab all -o 'my dir'"
        );
        assert_eq!(typed(&["colltrans", "it's", ""]), r"colltrans 'it'\''s' ''");
        let absolute =
            ["solids", "--data", "/a/data", "--json=/tmp/b/c.json", "-o", "e/f", "g=h/i"];
        assert_eq!(typed(&absolute), "solids --data data --json=c.json -o e/f g=h/i");
        assert_eq!(typed(&[]), "");
    }

    #[test]
    fn durations() {
        for (seconds, expected) in
            [(0.44, "0.4 s"), (12.9, "12 s"), (200.0, "3 min 20 s"), (3725.0, "1 h 2 min")]
        {
            assert_eq!(readable_duration(Duration::from_secs_f64(seconds)), expected);
        }
    }

    #[test]
    fn provenance_has_no_empty_fields() {
        let here = Provenance::of_this_process("-");
        let facts = [&here.processor, &here.cores, &here.system, &here.versions, &here.build];
        assert!(facts.into_iter().chain([&here.date, &here.command]).all(|f| !f.is_empty()));
    }
}
