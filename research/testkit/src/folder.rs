//! Folders for the files that a test writes.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::{env, fs, process};

/// An empty folder for temporary files. It is removed with its contents when this value is dropped.
///
/// It replaces the crate `tempfile`, which enables features of dependencies of the program. `cargo test` and
/// `cargo run` would then compile the same libraries twice.
#[derive(Debug)]
pub struct TemporaryFolder(PathBuf);

impl TemporaryFolder {
    /// Creates a folder that differs from those of other values, processes and earlier runs.
    ///
    /// # Panics
    ///
    /// If the folder for temporary files of the system is not writable.
    #[expect(clippy::new_without_default, reason = "a default value would write to the disk")]
    pub fn new() -> Self {
        static CREATED: AtomicU64 = AtomicU64::new(0);
        loop {
            let number = CREATED.fetch_add(1, Ordering::Relaxed);
            let name = format!("colltrans-test-{}-{number}", process::id());
            let folder = env::temp_dir().join(name);
            match fs::create_dir(&folder) {
                Ok(()) => return Self(folder),
                // An earlier process with the same id was killed before it removed the folder.
                Err(error) if error.kind() == std::io::ErrorKind::AlreadyExists => {}
                Err(error) => panic!("cannot create {}: {error}", folder.display()),
            }
        }
    }

    /// Returns the path of the folder.
    pub fn path(&self) -> &Path {
        &self.0
    }
}

impl Drop for TemporaryFolder {
    fn drop(&mut self) {
        // An error in removing the folder does not fail the test.
        let _ = fs::remove_dir_all(&self.0);
    }
}

#[cfg(test)]
mod tests {
    use super::TemporaryFolder;
    use std::fs;

    #[test]
    fn folders_are_new_and_removed_with_their_files() {
        let [one, two] = [TemporaryFolder::new(), TemporaryFolder::new()];
        assert_ne!(one.path(), two.path());
        fs::create_dir(one.path().join("inner")).unwrap();
        fs::write(one.path().join("inner/file"), "content").unwrap();
        let path = one.path().to_owned();
        drop(one);
        assert!(!path.exists() && two.path().is_dir());
    }
}
