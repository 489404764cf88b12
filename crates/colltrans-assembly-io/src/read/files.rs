//! Opens the files that a source refers to, inside the permitted folders only.
//!
//! A source is untrusted. References are resolved inside its own folder and the folders of packages. Symbolic
//! links must not lead out of these folders. For example, `/etc/passwd` is rejected, unless the caller allows
//! all files. Network addresses, devices and pipes are always rejected.
//!
//! Invariant of `Folders`, unless all files are allowed: a file is opened only after its canonical path was
//! found to be inside. The source itself (`SourceAndFiles`) is read from any location.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};

use super::ReadOptions;
use crate::error::ReadError;

/// The reason why a file was not read.
#[derive(Debug)]
pub enum FileError {
    /// The file lies outside of the permitted folders.
    Outside,
    /// The file cannot be read.
    Io(std::io::Error),
}

/// A provider of the files of a source.
pub trait Files {
    /// Returns the contents of a file; `None` if it does not exist.
    ///
    /// # Errors
    /// [`FileError`] if the file cannot be read or lies outside of the permitted folders.
    fn bytes(&self, path: &Path) -> Result<Option<Vec<u8>>, FileError>;
}

/// Files in memory, by path.
impl Files for BTreeMap<PathBuf, Vec<u8>> {
    fn bytes(&self, path: &Path) -> Result<Option<Vec<u8>>, FileError> {
        Ok(self.get(path).cloned())
    }
}

/// A provider without files.
pub(super) struct NoFiles;

impl Files for NoFiles {
    fn bytes(&self, _: &Path) -> Result<Option<Vec<u8>>, FileError> {
        Ok(None)
    }
}

/// The files in a list of folders.
#[cfg(feature = "files")]
pub(super) struct Folders {
    /// The canonical paths of the folders; `None` if all files may be read.
    inside: Option<Vec<PathBuf>>,
}

#[cfg(feature = "files")]
impl Folders {
    /// Permits the folder of the source (the source itself if it is a folder) and the folders of packages.
    pub(super) fn for_source(source: &Path, options: &ReadOptions) -> Self {
        let own = if source.is_dir() { source } else { folder_of(source) };
        let own = if own.as_os_str().is_empty() { Path::new(".") } else { own };
        let all = std::iter::once(own).chain(options.packages.iter().map(PathBuf::as_path));
        // A missing folder contains no files.
        let inside = all.filter_map(|folder| folder.canonicalize().ok()).collect();
        Self { inside: (!options.allow_outside).then_some(inside) }
    }
}

#[cfg(feature = "files")]
impl Files for Folders {
    fn bytes(&self, path: &Path) -> Result<Option<Vec<u8>>, FileError> {
        use std::io::ErrorKind::{NotADirectory, NotFound};
        let real = match path.canonicalize() {
            Ok(real) => real,
            Err(e) if matches!(e.kind(), NotFound | NotADirectory) => return Ok(None),
            Err(e) => return Err(FileError::Io(e)),
        };
        if self.inside.as_ref().is_some_and(|all| !all.iter().any(|root| real.starts_with(root))) {
            return Err(FileError::Outside);
        }
        colltrans_mesh::file::bytes(&real).map(Some).map_err(FileError::Io)
    }
}

/// The source itself, which is read from any location, and the files that it refers to.
#[cfg(feature = "files")]
pub(super) struct SourceAndFiles<'a> {
    pub(super) path: &'a Path,
    pub(super) files: &'a dyn Files,
}

#[cfg(feature = "files")]
impl Files for SourceAndFiles<'_> {
    fn bytes(&self, path: &Path) -> Result<Option<Vec<u8>>, FileError> {
        if path == self.path {
            return colltrans_mesh::file::bytes(path).map(Some).map_err(FileError::Io);
        }
        self.files.bytes(path)
    }
}

/// Returns the folder that contains a file.
pub(super) fn folder_of(path: &Path) -> &Path {
    path.parent().unwrap_or(Path::new(""))
}

/// A source with its options and a record of the files that were read.
pub(super) struct Source<'a> {
    pub(super) path: &'a Path,
    pub(super) options: &'a ReadOptions,
    pub(super) files: &'a dyn Files,
    read: RefCell<Vec<PathBuf>>,
}

impl<'a> Source<'a> {
    pub(super) fn new(path: &'a Path, options: &'a ReadOptions, files: &'a dyn Files) -> Self {
        Self { path, options, files, read: RefCell::default() }
    }

    /// Returns the contents of the source itself.
    #[cfg(feature = "files")]
    pub(super) fn own_bytes(&self) -> Result<Vec<u8>, ReadError> {
        self.required_bytes(self.path)
    }

    /// Returns the contents of a file, or an error if it does not exist.
    #[cfg(feature = "files")]
    pub(super) fn required_bytes(&self, path: &Path) -> Result<Vec<u8>, ReadError> {
        let none = || super::io_error(path)(std::io::Error::from(std::io::ErrorKind::NotFound));
        self.open_file(path)?.ok_or_else(none)
    }

    /// Returns the text of the source itself.
    #[cfg(feature = "files")]
    pub(super) fn text(&self) -> Result<String, ReadError> {
        colltrans_mesh::file::decode_text(self.own_bytes()?).map_err(super::io_error(self.path))
    }

    /// Opens a file by a reference relative to the folder of the source. Returns its path and contents; `None`
    /// if it does not exist.
    pub(super) fn open_reference(
        &self,
        name: &str,
    ) -> Result<Option<(PathBuf, Vec<u8>)>, ReadError> {
        self.open_relative(folder_of(self.path), name)
    }

    /// Opens a file by a reference relative to `folder`. Returns its path and contents; `None` if it does not
    /// exist.
    pub(super) fn open_relative(
        &self,
        folder: &Path,
        name: &str,
    ) -> Result<Option<(PathBuf, Vec<u8>)>, ReadError> {
        if let Some((scheme, _)) = name.split_once("://") {
            let reason =
                format!("{name} is a network address ({scheme}); accepted: paths of files");
            return Err(super::contents_error(self.path, "file references", reason));
        }
        let outside = || ReadError::OutsideFolder { path: self.path.into(), name: name.into() };
        if Path::new(name).has_root() && !self.options.allow_outside {
            return Err(outside());
        }
        let path = folder.join(name);
        match self.open_file(&path)? {
            Some(bytes) => Ok(Some((path, bytes))),
            None if leads_outside(name) && !self.options.allow_outside => Err(outside()),
            None => Ok(None),
        }
    }

    /// Returns the contents of a file and records its path; `None` if it does not exist.
    fn open_file(&self, path: &Path) -> Result<Option<Vec<u8>>, ReadError> {
        let refused = |fault| match fault {
            FileError::Outside => ReadError::OutsideFolder {
                path: self.path.into(),
                name: path.display().to_string(),
            },
            FileError::Io(source) => ReadError::Io { path: path.into(), source },
        };
        let bytes = self.files.bytes(path).map_err(refused)?;
        if bytes.is_some() {
            self.read.borrow_mut().push(path.into());
        }
        Ok(bytes)
    }

    /// Returns the files that were read.
    pub(super) fn into_files(self) -> Vec<PathBuf> {
        self.read.into_inner()
    }
}

/// Checks whether a path, as written, leads out of the folder to which it is relative.
fn leads_outside(name: &str) -> bool {
    let mut depth = 0_usize;
    for part in Path::new(name).components() {
        match part {
            Component::Normal(_) => depth += 1,
            Component::CurDir => (),
            Component::ParentDir if depth > 0 => depth -= 1,
            Component::ParentDir | Component::RootDir | Component::Prefix(_) => return true,
        }
    }
    false
}

/// Decodes the escapes of a URI, for example `%20` to a space.
pub(super) fn decode_uri(uri: &str) -> Result<String, String> {
    let name = String::from_utf8(decode_percent(uri)?);
    name.map_err(|_| format!("invalid URI {uri}: not UTF-8"))
}

/// Decodes the escapes of a URI to bytes.
pub(super) fn decode_percent(text: &str) -> Result<Vec<u8>, String> {
    let mut rest = text.as_bytes();
    let mut bytes = Vec::with_capacity(rest.len());
    while let [first, tail @ ..] = rest {
        rest = tail;
        if *first != b'%' {
            bytes.push(*first);
            continue;
        }
        let digit = |b: &u8| char::from(*b).to_digit(16);
        let [high, low, tail @ ..] = rest else {
            return Err(format!(
                "invalid URI {text}: % at the end, expected % and two hexadecimal digits"
            ));
        };
        let (Some(high), Some(low)) = (digit(high), digit(low)) else {
            return Err(format!("invalid URI {text}: expected two hexadecimal digits after %"));
        };
        bytes.push((high * 16 + low) as u8);
        rest = tail;
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::leads_outside;

    #[test]
    fn leads_outside_judges_the_path_as_written() {
        let inside = ["a.stl", "a/b.stl", "./a", "a/../b", "a/b/../../c", "..a", "a..b", ""];
        let outside = ["/a", "..", "../a", "a/../../b", "./../a"];
        assert!(inside.iter().all(|name| !leads_outside(name)));
        assert!(outside.iter().all(|name| leads_outside(name)));
    }
}
