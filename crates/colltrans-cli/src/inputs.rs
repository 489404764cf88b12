//! Reads text, and rejects outputs that would overwrite an input.
//!
//! Files are compared by identity, because links give one file several names.

use std::fs::Metadata;
use std::io::{self, Read as _};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

use crate::failure::{Code, Failure};

/// The identity of a file, which all its names, symbolic links and hard links share.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(crate) enum Identity {
    /// Device and inode.
    #[cfg(unix)]
    Inode(u64, u64),
    /// The canonical path on systems without inodes. Hard links have different ones.
    #[cfg(not(unix))]
    Path(std::path::PathBuf),
}

impl Identity {
    /// Returns the identity of a regular file; `None` if there is no regular file with this name. Folders, devices and
    /// pipes have no identity, because an output does not overwrite them.
    pub(crate) fn of_path(path: &Path) -> Option<Self> {
        let metadata = path.metadata().ok()?;
        if metadata.is_file() { Self::of_regular_file(path, &metadata).ok() } else { None }
    }

    #[cfg(unix)]
    #[expect(clippy::unnecessary_wraps, reason = "it can fail on systems without inodes")]
    fn of_regular_file(_: &Path, metadata: &Metadata) -> io::Result<Self> {
        use std::os::unix::fs::MetadataExt;
        Ok(Self::Inode(metadata.dev(), metadata.ino()))
    }

    #[cfg(not(unix))]
    fn of_regular_file(path: &Path, _: &Metadata) -> io::Result<Self> {
        path.canonicalize().map(Self::Path)
    }
}

/// Checks whether the extension of a path is one of these, in any case.
pub(crate) fn has_extension(path: &Path, extensions: &[&str]) -> bool {
    let extension = path.extension().unwrap_or_default();
    extensions.iter().any(|known| extension.eq_ignore_ascii_case(known))
}

/// Returns the input that an output would overwrite; `None` if there is none.
pub(crate) fn overwritten_input<'a>(output: &Path, inputs: &[&'a Path]) -> Option<&'a Path> {
    let output = Identity::of_path(output)?;
    inputs.iter().copied().find(|input| Identity::of_path(input).as_ref() == Some(&output))
}

/// Checks that a picture does not overwrite an input.
///
/// # Errors
/// The picture would overwrite an input.
pub(crate) fn check_picture_path(picture: Option<&Path>, inputs: &[&Path]) -> Result<(), Failure> {
    picture.map_or(Ok(()), |picture| {
        check_output_path(picture, inputs, "give the picture another name")
    })
}

/// Checks that a proof overwrites neither an input nor the picture.
///
/// # Errors
/// The proof would overwrite an input, or has the path of the picture.
pub(crate) fn check_proof_path(
    proof: Option<&Path>,
    picture: Option<&Path>,
    inputs: &[&Path],
) -> Result<(), Failure> {
    let Some(proof) = proof else { return Ok(()) };
    if picture == Some(proof) {
        return Err(Failure::new(
            Code::Usage,
            "--save-proof and --picture name the same file; give them two names",
        ));
    }
    check_output_path(proof, inputs, "give the proof another name")
}

/// Checks that an output does not overwrite an input. `advice` ends the error message.
///
/// # Errors
/// It would overwrite an input.
pub(crate) fn check_output_path(
    output: &Path,
    inputs: &[&Path],
    advice: &str,
) -> Result<(), Failure> {
    match overwritten_input(output, inputs) {
        Some(input) => Err(Failure::new(
            Code::Input,
            format!(
                "{}: is the same file as the input {}, which would be lost; {advice}",
                output.display(),
                input.display()
            ),
        )),
        None => Ok(()),
    }
}

/// Checks that outputs are different files.
///
/// # Errors
/// Two of them are the same file.
pub(crate) fn check_distinct_outputs(outputs: &[&Path]) -> Result<(), Failure> {
    let folder = |path: &Path| {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
        folder.unwrap_or(Path::new(".")).canonicalize().ok()
    };
    let is_same = |a: &Path, b: &Path| match [a, b].map(Identity::of_path) {
        [Some(a), Some(b)] => a == b,
        // Several outputs may go to one device.
        [None, None] if a.exists() => false,
        [None, None] => a == b || a.file_name() == b.file_name() && folder(a) == folder(b),
        _ => false,
    };
    for (k, output) in outputs.iter().enumerate() {
        if let Some(other) = outputs[..k].iter().find(|other| is_same(other, output)) {
            let [a, b] = [other, output].map(|path| path.display());
            let message = format!("{a} and {b} are one output file; give them two names");
            return Err(Failure::new(Code::Usage, message));
        }
    }
    Ok(())
}

/// Reads a text file.
pub(crate) fn read_text(file: &Path) -> Result<String, Failure> {
    with_file_name(file, colltrans_mesh::file::text(file))
}

/// Reads a text file, or standard input if the name is `-`.
pub(crate) fn read_text_or_stdin(file: &Path) -> Result<String, Failure> {
    if file != Path::new("-") {
        return read_text(file);
    }
    let mut text = String::new();
    let result = io::stdin().read_to_string(&mut text).map(|_| text);
    with_file_name(file, result)
}

/// Converts the error of reading a file into a failure that names it.
fn with_file_name(file: &Path, text: io::Result<String>) -> Result<String, Failure> {
    let message = |error| format!("{}: cannot be read: {error}", file.display());
    text.map_err(|error| Failure::new(Code::Input, message(error)))
}

/// Checks whether a file is one of obstacles, by its extension.
pub(crate) fn is_obstacle_list(file: &Path) -> bool {
    file.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("jsonl"))
}

/// A file that an output will replace. Threads record whether any of them reads it.
#[derive(Debug)]
pub(crate) struct ReplacedFile {
    identity: Option<Identity>,
    was_read: AtomicBool,
}

impl ReplacedFile {
    /// Returns the record of a file; `None` stands for an output that replaces no file.
    pub(crate) const fn new(identity: Option<Identity>) -> Self {
        Self { identity, was_read: AtomicBool::new(false) }
    }

    /// Records that a file will be read. To be called before each file is read.
    pub(crate) fn record_read(&self, path: &Path) {
        if self.identity.is_some() && Identity::of_path(path) == self.identity {
            self.was_read.store(true, Relaxed);
        }
    }

    /// Checks whether the file was read.
    pub(crate) fn was_read(&self) -> bool {
        self.was_read.load(Relaxed)
    }
}
