//! No output overwrites an input: files by what they are, not by what they are called.

use std::collections::HashSet;
use std::fs::Metadata;
use std::io;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

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

/// The files that have been read, by any thread.
#[derive(Debug, Default)]
pub(crate) struct FilesRead(Mutex<HashSet<Identity>>);

impl FilesRead {
    /// To be called before a file is read.
    pub(crate) fn note(&self, path: &Path) {
        if let Some(identity) = Identity::of(path) {
            self.0.lock().unwrap_or_else(PoisonError::into_inner).insert(identity);
        }
    }

    pub(crate) fn contains(&self, identity: &Identity) -> bool {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).contains(identity)
    }
}
