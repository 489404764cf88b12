//! STEP files, by way of a converter: `colltrans.step` of the Python package, or what `COLLTRANS_STEP` names.
//!
//! The converter is called with the file, `-o -` and `--chord L`. It writes GLB to standard output, in which each part
//! has its chord error, and what it does to standard error, a line each.

use std::io::{self, BufRead, BufReader, ErrorKind, Read};
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::Duration;

use crate::failure::{Code, Failure};
use crate::progress;
use crate::terminal::shown;

/// The variable that names another converter, with its first arguments.
const VARIABLE: &str = "COLLTRANS_STEP";
const INSTALL: &str = "STEP files need a converter: pip install 'colltrans[step]' for the Python that `python3` is, or \
                       name another one in COLLTRANS_STEP; or tessellate each part to a mesh file in its place, and give \
                       the folder";

/// Whether a source is a STEP file, by its name.
pub(super) fn is_step(path: &Path) -> bool {
    let extension = path.extension().unwrap_or_default();
    ["step", "stp"].iter().any(|known| extension.eq_ignore_ascii_case(known))
}

/// The GLB file that a STEP file is converted to; facets are `chord` from its surfaces, about.
pub(super) fn converted(path: &Path, chord: f64) -> Result<Vec<u8>, Failure> {
    let failed = |text: String| Failure::new(Code::Input, format!("{}: {text}", path.display()));
    let unreadable = |e: io::Error| failed(format!("cannot be read: {e}"));
    if !path.metadata().map_err(unreadable)?.is_file() {
        return Err(failed("is no file".into()));
    }
    let (mut command, name) = command();
    command.arg(path).args(["-o", "-", "--chord", &chord.to_string()]);
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let child = command.spawn().map_err(|e| match e.kind() {
        ErrorKind::NotFound => failed(INSTALL.into()),
        _ => failed(format!("{name} cannot be run: {e}")),
    })?;
    let (glb, said, status) = output(child).map_err(|e| failed(format!("{name}: {e}")))?;
    if status.success() {
        return Ok(glb);
    }
    let last = said.last().map_or("it says nothing", String::as_str);
    Err(if last.contains("No module named") || last.contains("colltrans[step]") {
        failed(INSTALL.into())
    } else {
        failed(format!("{name} failed ({status}): {}", shown(last)))
    })
}

/// The converter, and its name.
fn command() -> (Command, String) {
    let named = std::env::var(VARIABLE).unwrap_or_default();
    let mut words = named.split_whitespace();
    let Some(program) = words.next() else {
        let mut command = Command::new("python3");
        command.args(["-m", "colltrans.step"]);
        return (command, "colltrans.step".into());
    };
    let mut command = Command::new(program);
    command.args(words);
    (command, program.into())
}

/// What it writes, the lines that it says, which are shown while it works, and how it ends.
fn output(mut child: Child) -> io::Result<(Vec<u8>, Vec<String>, ExitStatus)> {
    let bar = progress::bar(None, "{spinner} {msg} {elapsed}");
    bar.enable_steady_tick(Duration::from_millis(120));
    let said = child.stderr.take();
    let (mut bytes, mut lines) = (Vec::new(), Vec::new());
    std::thread::scope(|scope| {
        scope.spawn(|| {
            for line in said.into_iter().flat_map(|said| BufReader::new(said).split(b'\n')) {
                let Ok(line) = line else { break };
                let line = String::from_utf8_lossy(&line).trim_end().to_owned();
                if !line.is_empty() {
                    bar.set_message(shown(&line));
                    lines.push(line);
                }
            }
        });
        child.stdout.take().map_or(Ok(0), |mut made| made.read_to_end(&mut bytes))
    })?;
    bar.finish_and_clear();
    Ok((bytes, lines, child.wait()?))
}
