//! Converts STEP files with an external program: `colltrans.step` of the Python package, or the one that
//! `COLLTRANS_STEP` names.
//!
//! The arguments are the file, `-o -` and `--chord L`. The program writes GLB to standard output, with the chord error of
//! each part, and its progress to standard error, one line per step.

use std::io::{self, BufRead, BufReader, ErrorKind, Read};
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::Duration;

use crate::failure::{Code, Failure};
use crate::inputs::has_extension;
use crate::progress;
use crate::terminal::escape_line;

/// Environment variable with another converter and its first arguments.
const VARIABLE: &str = "COLLTRANS_STEP";
/// Error message without a converter.
const INSTALL_HINT: &str = "STEP files need a converter: run pip install 'colltrans[step]' (in a checkout: \
                       pip install './python[step]') for the Python of `python3`, or set COLLTRANS_STEP to the \
                       command of another Python, such as '/path/to/python -m colltrans.step'; or tessellate each part to a mesh file in its place, and give the folder";

/// Checks whether a source is a STEP file, by its extension.
pub(super) fn is_step(path: &Path) -> bool {
    has_extension(path, &["step", "stp"])
}

/// Converts a STEP file to GLB. `chord` is the requested distance of facets from the surfaces, in millimetres.
///
/// # Errors
/// The file cannot be read, there is no converter, or it fails.
pub(super) fn convert_to_glb(path: &Path, chord: f64) -> Result<Vec<u8>, Failure> {
    let failed = |text: String| Failure::new(Code::Input, format!("{}: {text}", path.display()));
    let unreadable = |e: io::Error| failed(format!("cannot be read: {e}"));
    if !path.metadata().map_err(unreadable)?.is_file() {
        return Err(failed("is not a regular file; give a STEP file".into()));
    }
    let (mut command, name) = converter()?;
    command.arg(path).args(["-o", "-", "--chord", &chord.to_string()]);
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let child = command.spawn().map_err(|e| match e.kind() {
        ErrorKind::NotFound => failed(INSTALL_HINT.into()),
        _ => failed(format!("{name} cannot be run: {e}")),
    })?;
    let (glb, messages, status) = run_converter(child)
        .map_err(|e| failed(format!("the output of {name} cannot be read: {e}")))?;
    if status.success() {
        return Ok(glb);
    }
    let last = messages.last().map_or("no message", String::as_str);
    Err(if last.contains("No module named") || last.contains("cadquery-ocp-novtk") {
        failed(INSTALL_HINT.into())
    } else {
        failed(format!("{name} failed ({status}): {}", escape_line(last)))
    })
}

/// Returns the converter and its name.
///
/// # Errors
/// [`VARIABLE`] names a Python interpreter alone, which would run the STEP file as its program.
fn converter() -> Result<(Command, String), Failure> {
    let named = std::env::var(VARIABLE).unwrap_or_default();
    let mut words = named.split_whitespace();
    let Some(program) = words.next() else {
        let mut command = Command::new("python3");
        command.args(["-m", "colltrans.step"]);
        return Ok((command, "colltrans.step".into()));
    };
    let mut words = words.peekable();
    if words.peek().is_none() && is_python(program) {
        let text = format!(
            "{VARIABLE}={}: names an interpreter alone; give the command of a converter, such as '{} -m colltrans.step'",
            escape_line(program),
            escape_line(program)
        );
        return Err(Failure::new(Code::Usage, text));
    }
    let mut command = Command::new(program);
    command.args(words);
    Ok((command, program.into()))
}

/// Checks whether a program has the name of a Python interpreter, such as `python3.12` or `pypy3`.
fn is_python(program: &str) -> bool {
    let name = Path::new(program).file_name().unwrap_or_default().to_string_lossy();
    let name = name.strip_suffix(".exe").unwrap_or(&name);
    let is_version = |rest: &str| rest.chars().all(|c| c.is_ascii_digit() || c == '.');
    ["pythonw", "python", "pypy"]
        .iter()
        .any(|known| name.strip_prefix(known).is_some_and(is_version))
}

/// Runs the converter, and shows its messages as progress. Returns its output, its messages and its status.
fn run_converter(mut child: Child) -> io::Result<(Vec<u8>, Vec<String>, ExitStatus)> {
    let bar = progress::bar_with_template(None, "{spinner} {msg} {elapsed}");
    bar.enable_steady_tick(Duration::from_millis(120));
    let stderr = child.stderr.take();
    let (mut bytes, mut messages) = (Vec::new(), Vec::new());
    std::thread::scope(|scope| {
        scope.spawn(|| {
            for line in stderr.into_iter().flat_map(|stderr| BufReader::new(stderr).split(b'\n')) {
                let Ok(line) = line else { break };
                let line = String::from_utf8_lossy(&line).trim_end().to_owned();
                if !line.is_empty() {
                    bar.set_message(escape_line(&line));
                    messages.push(line);
                }
            }
        });
        child.stdout.take().map_or(Ok(0), |mut stdout| stdout.read_to_end(&mut bytes))
    })?;
    bar.finish_and_clear();
    Ok((bytes, messages, child.wait()?))
}
