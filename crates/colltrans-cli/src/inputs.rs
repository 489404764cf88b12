//! Reads text, and refuses outputs that would overwrite an input. Files are compared by identity, not by
//! name.

use std::fs::Metadata;
use std::io::{self, Read as _};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

use crate::failure::{Code, Failure};

/// A file by its identity: another name, a symbolic or a hard link leads to the same.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(crate) enum Identity {
    /// Device and inode.
    #[cfg(unix)]
    Inode(u64, u64),
    /// The canonical path, where there are no inodes: hard links are not seen through.
    #[cfg(not(unix))]
    Path(std::path::PathBuf),
}

impl Identity {
    /// The identity of an ordinary file; `None` of one that is not there, or a folder, a device, a
    /// pipe, which are not overwritten.
    pub(crate) fn of(path: &Path) -> Option<Self> {
        let metadata = path.metadata().ok()?;
        if metadata.is_file() { Self::of_file(path, &metadata).ok() } else { None }
    }

    #[cfg(unix)]
    #[expect(clippy::unnecessary_wraps, reason = "elsewhere it can fail")]
    fn of_file(_: &Path, metadata: &Metadata) -> io::Result<Self> {
        use std::os::unix::fs::MetadataExt;
        Ok(Self::Inode(metadata.dev(), metadata.ino()))
    }

    #[cfg(not(unix))]
    fn of_file(path: &Path, _: &Metadata) -> io::Result<Self> {
        path.canonicalize().map(Self::Path)
    }
}

/// The one of the inputs that an output would overwrite.
pub(crate) fn overwritten<'a>(output: &Path, inputs: &[&'a Path]) -> Option<&'a Path> {
    let output = Identity::of(output)?;
    inputs.iter().copied().find(|input| Identity::of(input).as_ref() == Some(&output))
}

/// A picture must not take the place of what is read.
pub(crate) fn refuse_picture(picture: Option<&Path>, inputs: &[&Path]) -> Result<(), Failure> {
    picture.map_or(Ok(()), |picture| {
        refuse_overwriting(picture, inputs, "give the picture another name")
    })
}

/// A proof must not take the place of what is read, nor of the picture.
pub(crate) fn refuse_proof(
    proof: Option<&Path>,
    picture: Option<&Path>,
    inputs: &[&Path],
) -> Result<(), Failure> {
    let Some(proof) = proof else { return Ok(()) };
    if picture == Some(proof) {
        return Err(Failure::new(Code::Usage, "--save-proof and --picture name one file"));
    }
    refuse_overwriting(proof, inputs, "give the proof another name")
}

/// An output must not take the place of what is read; says what to do instead.
pub(crate) fn refuse_overwriting(
    output: &Path,
    inputs: &[&Path],
    instead: &str,
) -> Result<(), Failure> {
    match overwritten(output, inputs) {
        Some(input) => Err(Failure::new(
            Code::Input,
            format!(
                "{}: is the same file as {}, which would be lost; {instead}",
                output.display(),
                input.display()
            ),
        )),
        None => Ok(()),
    }
}

/// Reads a text file.
pub(crate) fn read_text(file: &Path) -> Result<String, Failure> {
    or_unreadable(file, colltrans_mesh::file::text(file))
}

/// Reads a text file, or standard input if the name is `-`.
pub(crate) fn read_text_or_stdin(file: &Path) -> Result<String, Failure> {
    if file != Path::new("-") {
        return read_text(file);
    }
    let mut text = String::new();
    let result = io::stdin().read_to_string(&mut text).map(|_| text);
    or_unreadable(file, result)
}

fn or_unreadable(file: &Path, text: io::Result<String>) -> Result<String, Failure> {
    let why = |error| format!("{}: cannot be read: {error}", file.display());
    text.map_err(|error| Failure::new(Code::Input, why(error)))
}

/// Whether a file is one of obstacles, by its name.
pub(crate) fn is_list(file: &Path) -> bool {
    file.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("jsonl"))
}

/// A file that must not be read, because something else will take its place; by any thread.
#[derive(Debug)]
pub(crate) struct Watched {
    identity: Option<Identity>,
    was_read: AtomicBool,
}

impl Watched {
    pub(crate) const fn new(identity: Option<Identity>) -> Self {
        Self { identity, was_read: AtomicBool::new(false) }
    }

    /// To be called before a file is read.
    pub(crate) fn note(&self, path: &Path) {
        if self.identity.is_some() && Identity::of(path) == self.identity {
            self.was_read.store(true, Relaxed);
        }
    }

    pub(crate) fn was_read(&self) -> bool {
        self.was_read.load(Relaxed)
    }
}
