//! Writes files so that they appear completely or not at all.
//!
//! A file is written under a temporary name in the same folder (`NAME.PROCESS-N.partial`), and renamed when
//! all of it is on the disk. Therefore a killed run or a full disk leaves the previous file unchanged. Devices and pipes
//! are written directly.

use std::fs::{self, File, OpenOptions};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

use colltrans_mesh::plain::file_name_part;

use crate::failure::Failure;
use crate::inputs::Identity;

/// A file that is being written. If it is dropped before it is finished or kept, its temporary file is removed.
pub(crate) struct Output {
    file: File,
    partial: Option<Partial>,
}

/// The temporary and the final path of a file.
struct Partial {
    temporary: PathBuf,
    target: PathBuf,
    /// Identity of the file that it replaces.
    replaced: Option<Identity>,
}

impl Output {
    /// Creates the temporary file, or opens `path` itself if it is a device or a pipe.
    ///
    /// # Errors
    /// The folder or the existing file cannot be written, or `path` is a folder.
    pub(crate) fn create(path: &Path) -> io::Result<Self> {
        let replaced = Identity::of_path(path);
        let exists = path.metadata().is_ok();
        if exists && replaced.is_none() {
            // A device or a pipe. Opening a folder fails.
            let file = OpenOptions::new().write(true).open(path)?;
            return Ok(Self { file, partial: None });
        }
        // Replaces the file behind a symbolic link. Opening it fails if it is read-only.
        let target = if exists { path.canonicalize()? } else { path.to_owned() };
        if exists {
            OpenOptions::new().append(true).open(&target)?;
        }
        let (file, temporary) = create_temporary(&target)?;
        Ok(Self { file, partial: Some(Partial { temporary, target, replaced }) })
    }

    /// Returns the file to write to.
    pub(crate) fn file(&self) -> io::Result<File> {
        self.file.try_clone()
    }

    /// Returns the file that this one replaces; `None` if there is none.
    pub(crate) fn replaced_file(&self) -> Option<&Identity> {
        self.partial.as_ref().and_then(|partial| partial.replaced.as_ref())
    }

    /// Moves the complete file to its final path.
    pub(crate) fn finish(mut self) -> io::Result<()> {
        let Some(partial) = &self.partial else { return self.file.flush() };
        // Full or remote disks may report their error only now.
        self.file.sync_all()?;
        if partial.replaced.is_some() {
            let permissions = partial.target.metadata()?.permissions();
            fs::set_permissions(&partial.temporary, permissions)?;
        }
        fs::rename(&partial.temporary, &partial.target)?;
        self.partial = None;
        Ok(())
    }

    /// Gives the complete file its final path if no file exists there. A hard link decides atomically; the temporary name
    /// is then removed.
    fn finish_new(self) -> io::Result<()> {
        let Some(partial) = &self.partial else { return Err(ErrorKind::AlreadyExists.into()) };
        self.file.sync_all()?;
        if let Err(error) = fs::hard_link(&partial.temporary, &partial.target) {
            // Some file systems have no hard links.
            if error.kind() == ErrorKind::AlreadyExists || partial.target.symlink_metadata().is_ok()
            {
                return Err(ErrorKind::AlreadyExists.into());
            }
            return self.finish();
        }
        Ok(())
    }

    /// Keeps the file under its temporary name, which is returned; `None` for devices and pipes.
    pub(crate) fn keep_temporary(mut self) -> Option<PathBuf> {
        self.partial.take().map(|partial| partial.temporary)
    }
}

/// Removes a file that was not finished.
impl Drop for Output {
    fn drop(&mut self) {
        if let Some(partial) = &self.partial {
            let _ = fs::remove_file(&partial.temporary);
        }
    }
}

/// Maximum number of bytes of a name that a longer name repeats, because names have a limit.
const MAX_NAME_BYTES: usize = 100;

/// Creates a new file in the folder of `target`.
fn create_temporary(target: &Path) -> io::Result<(File, PathBuf)> {
    let name = target.file_name().unwrap_or_default().to_string_lossy();
    let name = &name[..name.floor_char_boundary(MAX_NAME_BYTES)];
    let process = std::process::id();
    let mut attempt = 0;
    loop {
        let path = target.with_file_name(format!("{name}.{process}-{attempt}.partial"));
        match OpenOptions::new().write(true).create_new(true).open(&path) {
            Ok(file) => return Ok((file, path)),
            Err(error) if error.kind() == ErrorKind::AlreadyExists && attempt < 100 => attempt += 1,
            Err(error) => return Err(error),
        }
    }
}

/// A file that is created before its content is known. If it is dropped, nothing remains of it.
pub(crate) struct PendingFile {
    path: PathBuf,
    output: Output,
}

impl PendingFile {
    /// Creates the file under its temporary name.
    pub(crate) fn create(path: &Path) -> Result<Self, Failure> {
        let failed = |error| Failure::write_error(path.display(), &error);
        let output = Output::create(path).map_err(failed)?;
        Ok(Self { path: path.to_owned(), output })
    }

    /// Returns the final path.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Writes the content and moves the file to its final path.
    pub(crate) fn write(mut self, bytes: &[u8]) -> Result<(), Failure> {
        self.fill(bytes)?;
        self.finish()
    }

    fn fill(&mut self, bytes: &[u8]) -> Result<(), Failure> {
        let written = self.output.file.write_all(bytes);
        written.map_err(|error| Failure::write_error(self.path.display(), &error))
    }

    fn finish(self) -> Result<(), Failure> {
        let Self { path, output } = self;
        output.finish().map_err(|error| Failure::write_error(path.display(), &error))
    }
}

/// Files that belong together. All are written before the first is moved to its final path.
#[derive(Default)]
pub(crate) struct Outputs(Vec<PendingFile>);

impl Outputs {
    /// Writes a file under its temporary name.
    pub(crate) fn write(&mut self, path: &Path, bytes: &[u8]) -> Result<(), Failure> {
        let mut file = PendingFile::create(path)?;
        file.fill(bytes)?;
        self.0.push(file);
        Ok(())
    }

    /// Moves all files to their final paths.
    pub(crate) fn finish(self) -> Result<(), Failure> {
        self.0.into_iter().try_for_each(PendingFile::finish)
    }
}

/// Writes a file.
pub(crate) fn write(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    PendingFile::create(path)?.write(bytes)
}

/// Writes a proof with a final line feed.
pub(crate) fn write_proof(path: &Path, proof: &str) -> Result<(), Failure> {
    write(path, format!("{proof}\n").as_bytes())
}

/// Writes a new file. Never changes an existing one, even if it appears in the meantime.
///
/// # Errors
/// The file exists, or it cannot be written.
pub(crate) fn write_new(path: &Path, bytes: &[u8]) -> io::Result<()> {
    // Checked first to write nothing in vain.
    if path.symlink_metadata().is_ok() {
        return Err(ErrorKind::AlreadyExists.into());
    }
    let mut output = Output::create(path)?;
    output.file.write_all(bytes)?;
    output.finish_new()
}

/// Makes distinct file names of arbitrary names. Letters, digits and `-_.` stay, other characters become `_`, and long
/// names are cut at [`MAX_NAME_BYTES`]. Names that would be the same file, also on systems that ignore the case of
/// letters, get different numbers.
#[derive(Default)]
pub(crate) struct FileNames(std::collections::HashSet<String>);

impl FileNames {
    /// Returns the file name for a name.
    pub(crate) fn unique_name(&mut self, name: &str) -> String {
        let plain = file_name_part(name, MAX_NAME_BYTES);
        let mut chosen = plain.clone();
        let mut number = 2;
        while !self.0.insert(chosen.to_lowercase()) {
            chosen = format!("{plain}_{number}");
            number += 1;
        }
        chosen
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use colltrans_testkit::TemporaryFolder;

    #[test]
    fn unfinished_output_leaves_no_file() {
        let folder = TemporaryFolder::new();
        let path = folder.path().join("a.txt");
        let names = || fs::read_dir(folder.path()).unwrap().count();
        let mut output = Output::create(&path).unwrap();
        output.file.write_all(b"half").unwrap();
        assert!(!path.exists() && names() == 1);
        drop(output);
        assert_eq!(names(), 0);
        write(&path, b"whole").unwrap();
        assert_eq!((fs::read(&path).unwrap(), names()), (b"whole".to_vec(), 1));
        let mut output = Output::create(&path).unwrap();
        output.file.write_all(b"other").unwrap();
        assert_eq!(
            fs::read(&path).unwrap(),
            b"whole",
            "the old file stays until the new one is complete"
        );
        output.finish().unwrap();
        assert_eq!((fs::read(&path).unwrap(), names()), (b"other".to_vec(), 1));
        // The longest permitted name.
        write(&folder.path().join("ä".repeat(127)), b"").unwrap();
    }

    #[test]
    fn write_new_keeps_existing_files() {
        let folder = TemporaryFolder::new();
        let path = folder.path().join("case.json");
        let names = || fs::read_dir(folder.path()).unwrap().count();
        let mut late = Output::create(&path).unwrap();
        late.file.write_all(b"late").unwrap();
        write_new(&path, b"first").unwrap();
        assert_eq!(names(), 2, "the new file and the temporary one");
        assert_eq!(write_new(&path, b"second").unwrap_err().kind(), ErrorKind::AlreadyExists);
        assert_eq!(late.finish_new().unwrap_err().kind(), ErrorKind::AlreadyExists);
        assert_eq!((fs::read(&path).unwrap(), names()), (b"first".to_vec(), 1));
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn write_to_full_device_returns_error() {
        assert!(write(Path::new("/dev/full"), b"all of it").is_err());
        write(Path::new("/dev/null"), b"all of it").unwrap();
    }

    #[test]
    fn different_names_become_different_files() {
        let mut names = FileNames::default();
        let found = ["a/b", "a_b", "A_B", "../x", "a_b_2"].map(|name| names.unique_name(name));
        assert_eq!(found, ["a_b", "a_b_2", "A_B_3", ".._x", "a_b_2_2"]);
        assert_eq!(names.unique_name(&"x".repeat(500)).len(), MAX_NAME_BYTES);
    }
}
