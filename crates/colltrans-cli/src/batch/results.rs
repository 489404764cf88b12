//! Where the results go, without harm to a file that the queries read.
//!
//! Which meshes the queries read is known only when all of them are. So a file that is there
//! already is not touched before the end: the results go to a new file beside it, which takes
//! its place unless it turned out to be one of the inputs. A file that was not there is
//! written as the results come, as are pipes and devices.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use crate::failure::{Code, Failure};
use crate::inputs::{FilesRead, Identity};

pub(crate) type Writer = BufWriter<Box<dyn Write + Send>>;

/// What is left to be done when all results are written.
pub(crate) struct Results {
    /// For messages.
    pub(crate) name: String,
    replacing: Option<Replacing>,
}

/// A file that the results will replace.
struct Replacing {
    identity: Identity,
    target: PathBuf,
    written: PathBuf,
}

pub(crate) fn open(path: Option<&Path>) -> Result<(Writer, Results), Failure> {
    let Some(path) = path.filter(|path| *path != Path::new("-")) else {
        let name = "standard output".into();
        return Ok((BufWriter::new(Box::new(io::stdout())), Results { name, replacing: None }));
    };
    let name = path.display().to_string();
    let unwritable = |error| Failure::output(path.display(), &error);
    let (file, replacing) = match Identity::of(path) {
        None => (File::create(path).map_err(unwritable)?, None),
        Some(identity) => {
            // Behind a symbolic link, which stays.
            let target = path.canonicalize().map_err(unwritable)?;
            OpenOptions::new().append(true).open(&target).map_err(unwritable)?;
            let (file, written) = create_beside(&target).map_err(unwritable)?;
            (file, Some(Replacing { identity, target, written }))
        }
    };
    Ok((BufWriter::new(Box::new(file)), Results { name, replacing }))
}

/// A new file in the same folder.
fn create_beside(target: &Path) -> io::Result<(File, PathBuf)> {
    let name = target.file_name().unwrap_or_default().to_string_lossy();
    let process = std::process::id();
    let mut attempt = 0;
    loop {
        let path = target.with_file_name(format!("{name}.{process}-{attempt}.partial"));
        match OpenOptions::new().write(true).create_new(true).open(&path) {
            Ok(file) => return Ok((file, path)),
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists && attempt < 100 => {
                attempt += 1;
            }
            Err(error) => return Err(error),
        }
    }
}

impl Results {
    /// Puts the results, which are written, in their place.
    pub(crate) fn finish(self, read: &FilesRead) -> Result<(), Failure> {
        let Some(Replacing { identity, target, written }) = self.replacing else { return Ok(()) };
        if read.contains(&identity) {
            return Err(Failure::new(
                Code::Input,
                format!(
                    "{}: is a file that the queries read, and was left as it is; the results are \
                     in {}",
                    self.name,
                    written.display()
                ),
            ));
        }
        let permissions = target.metadata().map(|m| m.permissions());
        permissions
            .and_then(|permissions| fs::set_permissions(&written, permissions))
            .and_then(|()| fs::rename(&written, &target))
            .map_err(|error| Failure::output(&self.name, &error))
    }

    /// Takes back what was written, where it could not be written to the end.
    pub(crate) fn discard(self) {
        if let Some(replacing) = self.replacing {
            let _ = fs::remove_file(replacing.written);
        }
    }
}
