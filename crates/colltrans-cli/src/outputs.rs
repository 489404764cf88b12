//! Writes files so that they appear whole or not at all.
//!
//! A file is written under another name beside its place (`NAME.PROCESS-N.partial`), and renamed when
//! all of it is on the disk. So a run that is killed, or a full disk, leaves what was there before, and
//! at most a file that nobody takes for a result. Devices and pipes are written as they are.

use std::fs::{self, File, OpenOptions};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

use crate::failure::Failure;
use crate::inputs::Identity;

/// A file in the making.
pub(crate) struct Output {
    file: File,
    partial: Option<Partial>,
}

/// Where a file is written, and where it belongs.
struct Partial {
    written: PathBuf,
    target: PathBuf,
    /// Of the file whose place it takes.
    replaced: Option<Identity>,
}

impl Output {
    pub(crate) fn create(path: &Path) -> io::Result<Self> {
        let replaced = Identity::of(path);
        let is_there = path.metadata().is_ok();
        if is_there && replaced.is_none() {
            // A device or a pipe; of a folder the system says so.
            let file = OpenOptions::new().write(true).open(path)?;
            return Ok(Self { file, partial: None });
        }
        // Behind a symbolic link, which stays; a file that must not be written is refused.
        let target = if is_there { path.canonicalize()? } else { path.to_owned() };
        if is_there {
            OpenOptions::new().append(true).open(&target)?;
        }
        let (file, written) = create_beside(&target)?;
        Ok(Self { file, partial: Some(Partial { written, target, replaced }) })
    }

    /// To write into.
    pub(crate) fn file(&self) -> io::Result<File> {
        self.file.try_clone()
    }

    /// The file whose place this one takes.
    pub(crate) fn replaced(&self) -> Option<&Identity> {
        self.partial.as_ref().and_then(|partial| partial.replaced.as_ref())
    }

    /// Puts the file, all of which is written, in its place.
    pub(crate) fn finish(mut self) -> io::Result<()> {
        let Some(partial) = &self.partial else { return self.file.flush() };
        // Disks that are full, or far away, may say so only now.
        self.file.sync_all()?;
        if partial.replaced.is_some() {
            let permissions = partial.target.metadata()?.permissions();
            fs::set_permissions(&partial.written, permissions)?;
        }
        fs::rename(&partial.written, &partial.target)?;
        self.partial = None;
        Ok(())
    }

    /// The same if there is no such file yet: a second name for it, of which there can be one only, then
    /// the first is given up.
    fn finish_new(self) -> io::Result<()> {
        let Some(partial) = &self.partial else { return Err(ErrorKind::AlreadyExists.into()) };
        self.file.sync_all()?;
        if let Err(error) = fs::hard_link(&partial.written, &partial.target) {
            // Some file systems have one name for each file.
            if error.kind() == ErrorKind::AlreadyExists || partial.target.symlink_metadata().is_ok()
            {
                return Err(ErrorKind::AlreadyExists.into());
            }
            return self.finish();
        }
        Ok(())
    }

    /// Leaves the file under its other name, which is returned.
    pub(crate) fn leave(mut self) -> Option<PathBuf> {
        self.partial.take().map(|partial| partial.written)
    }
}

/// What is not finished is no file.
impl Drop for Output {
    fn drop(&mut self) {
        if let Some(partial) = &self.partial {
            let _ = fs::remove_file(&partial.written);
        }
    }
}

/// Bytes of a name that are kept in that of the partial file: names have a limit.
const KEPT: usize = 100;

/// A new file in the same folder.
fn create_beside(target: &Path) -> io::Result<(File, PathBuf)> {
    let name = target.file_name().unwrap_or_default().to_string_lossy();
    let name = &name[..name.floor_char_boundary(KEPT)];
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

/// Files that belong together: all are written before the first is put in its place.
#[derive(Default)]
pub(crate) struct Outputs(Vec<(PathBuf, Output)>);

impl Outputs {
    pub(crate) fn write(&mut self, path: PathBuf, bytes: &[u8]) -> Result<(), Failure> {
        let failed = |error| Failure::output(path.display(), &error);
        let mut output = Output::create(&path).map_err(failed)?;
        output.file.write_all(bytes).map_err(failed)?;
        self.0.push((path, output));
        Ok(())
    }

    pub(crate) fn finish(self) -> Result<(), Failure> {
        for (path, output) in self.0 {
            output.finish().map_err(|error| Failure::output(path.display(), &error))?;
        }
        Ok(())
    }
}

/// Writes a file.
pub(crate) fn write(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    let mut one = Outputs::default();
    one.write(path.to_owned(), bytes)?;
    one.finish()
}

/// Writes a proof.
pub(crate) fn write_proof(path: &Path, proof: &str) -> Result<(), Failure> {
    write(path, format!("{proof}\n").as_bytes())
}

/// Writes a file that is not there yet; what is there, also by then, is left as it is.
pub(crate) fn write_new(path: &Path, bytes: &[u8]) -> io::Result<()> {
    // Nothing is written where it would be in vain.
    if path.symlink_metadata().is_ok() {
        return Err(ErrorKind::AlreadyExists.into());
    }
    let mut output = Output::create(path)?;
    output.file.write_all(bytes)?;
    output.finish_new()
}

/// Names of files for names of anything: letters, digits and `-_.` stay; two names that would be one
/// file, also where large and small letters are the same, get two.
#[derive(Default)]
pub(crate) struct FileNames(std::collections::HashSet<String>);

impl FileNames {
    pub(crate) fn of(&mut self, name: &str) -> String {
        let safe = |c: char| if c.is_alphanumeric() || "-_.".contains(c) { c } else { '_' };
        let plain: String = name.chars().map(safe).collect();
        let plain = &plain[..plain.floor_char_boundary(KEPT)];
        let mut chosen = plain.to_owned();
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
    fn what_is_not_finished_is_not_there() {
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
        assert_eq!(fs::read(&path).unwrap(), b"whole", "until the other is whole");
        output.finish().unwrap();
        assert_eq!((fs::read(&path).unwrap(), names()), (b"other".to_vec(), 1));
        // As long as names may be.
        write(&folder.path().join("ä".repeat(127)), b"").unwrap();
    }

    #[test]
    fn what_is_there_is_not_written_over_by_what_is_new() {
        let folder = TemporaryFolder::new();
        let path = folder.path().join("case.json");
        let names = || fs::read_dir(folder.path()).unwrap().count();
        let mut late = Output::create(&path).unwrap();
        late.file.write_all(b"late").unwrap();
        write_new(&path, b"first").unwrap();
        assert_eq!(names(), 2, "the one, and what is being written");
        assert_eq!(write_new(&path, b"second").unwrap_err().kind(), ErrorKind::AlreadyExists);
        assert_eq!(late.finish_new().unwrap_err().kind(), ErrorKind::AlreadyExists);
        assert_eq!((fs::read(&path).unwrap(), names()), (b"first".to_vec(), 1));
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_disk_is_said() {
        assert!(write(Path::new("/dev/full"), b"all of it").is_err());
        write(Path::new("/dev/null"), b"all of it").unwrap();
    }

    #[test]
    fn two_names_are_two_files() {
        let mut names = FileNames::default();
        let found = ["a/b", "a_b", "A_B", "../x", "a_b_2"].map(|name| names.of(name));
        assert_eq!(found, ["a_b", "a_b_2", "A_B_3", ".._x", "a_b_2_2"]);
        assert_eq!(names.of(&"x".repeat(500)).len(), KEPT);
    }
}
