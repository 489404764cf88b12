//! The two checkers of saved proofs: the library, and `check.py` in a process of its own.

use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use colltrans::ProofFile;

/// The verdict of a checker about a proof.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Verdict {
    /// The proof is valid.
    Holds,
    /// The checked part is valid (`check.py`, exit code 7 or 1).
    HoldsPartly,
    /// The proof is invalid, or the file is not a proof.
    Refused(String),
    /// The checker itself failed.
    Failed(String),
}

impl Verdict {
    /// Whether all completed checks accepted the proof.
    pub fn accepts(&self) -> bool {
        matches!(self, Self::Holds | Self::HoldsPartly)
    }

    /// Checks whether the library rejects what `check.py` does not use, by its specification: the order or the tree
    /// of a body's facets, of which it accepts only its own, a cover, or the orientation of facets of an open piece.
    pub fn is_about_unused_data(&self) -> bool {
        const REASONS: [&str; 3] = [
            "differ from those that are rebuilt from its facets",
            "of the cover does not hold",
            "edges have facets with inconsistent orientations",
        ];
        matches!(self, Self::Refused(why) if REASONS.iter().any(|reason| why.contains(reason)))
    }
}

/// Returns the verdict of the library about a proof.
pub fn verify(text: &str) -> Verdict {
    let checked = ProofFile::from_json(text).map_err(|error| error.to_string());
    let checked = checked.and_then(|proof| proof.check().map(drop).map_err(|e| e.to_string()));
    checked.map_or_else(Verdict::Refused, |()| Verdict::Holds)
}

/// `check.py` as a process that checks one proof after another.
#[derive(Debug)]
pub struct RationalChecker {
    child: Child,
    to: ChildStdin,
    from: BufReader<ChildStdout>,
}

impl RationalChecker {
    /// Starts the checker of this repository with `COLLTRANS_PYTHON`, or `python3`.
    ///
    /// # Errors
    /// The error of the operating system if the program does not exist.
    pub fn start() -> std::io::Result<Self> {
        let here = Path::new(env!("CARGO_MANIFEST_DIR"));
        let check: PathBuf = here.join("../../python/src/colltrans/check.py");
        let python = std::env::var_os("COLLTRANS_PYTHON").unwrap_or_else(|| "python3".into());
        let mut child = Command::new(python)
            .arg(here.join("check_lines.py"))
            .arg(check)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()?;
        let (to, from) = (child.stdin.take(), child.stdout.take());
        let missing = || std::io::Error::other("a pipe is missing");
        let (to, from) = (to.ok_or_else(missing)?, from.ok_or_else(missing)?);
        Ok(Self { child, to, from: BufReader::new(from) })
    }

    /// Returns the verdict about a proof, which must be one line.
    pub fn check(&mut self, text: &str) -> Verdict {
        let mut answer = String::new();
        let asked = writeln!(self.to, "{text}").and_then(|()| self.to.flush());
        match asked.and_then(|()| self.from.read_line(&mut answer)) {
            Ok(0) => return Verdict::Failed("check.py has ended".into()),
            Err(error) => return Verdict::Failed(error.to_string()),
            Ok(_) => {}
        }
        let (code, why) = answer.trim_end().split_once('\t').unwrap_or((answer.trim_end(), ""));
        match code {
            "0" => Verdict::Holds,
            "7" | "1" => Verdict::HoldsPartly,
            "3" | "6" => Verdict::Refused(why.to_owned()),
            _ => Verdict::Failed(why.to_owned()),
        }
    }
}

impl Drop for RationalChecker {
    fn drop(&mut self) {
        // An error means that the process has already ended.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
