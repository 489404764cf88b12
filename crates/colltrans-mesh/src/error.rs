//! Errors of mesh files, with their place.

use std::fmt;
use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::Format;

/// Why no mesh could be read or written. Every message names the file.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum Error {
    /// The extension names no supported format.
    #[error(
        "{}: unknown mesh format; the extension must be one of {}",
        path.display(),
        Format::ALL.iter().map(|format| format.extension()).collect::<Vec<_>>().join(", ")
    )]
    UnknownFormat {
        /// The file.
        path: PathBuf,
    },
    /// The contents are of another kind than the extension says.
    #[error("{}: holds {found}, not {format} as its name says", path.display())]
    OtherContent {
        /// The file.
        path: PathBuf,
        /// The format that the extension names.
        format: Format,
        /// What the file holds, in words.
        found: &'static str,
    },
    /// Vertices cannot be merged within a distance like this.
    #[error("{}: the merge tolerance {tolerance} is negative or not finite", path.display())]
    MergeTolerance {
        /// The file that was to be read.
        path: PathBuf,
        /// The tolerance as given.
        tolerance: f64,
    },
    /// The file cannot be read.
    #[error("{}: cannot be read: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the operating system says.
        source: std::io::Error,
    },
    /// The file cannot be written.
    #[error("{}: cannot be written: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// What the operating system says.
        source: std::io::Error,
    },
    /// The contents are not what the format prescribes.
    #[error("{}: {place}: {what}", path.display())]
    Syntax {
        /// The file.
        path: PathBuf,
        /// Where in the file.
        place: Place,
        /// What is wrong there.
        what: String,
    },
    /// A mesh of this kind cannot be stored in this format.
    #[error("{}: {what}", path.display())]
    NotStorable {
        /// The file that was to be written.
        path: PathBuf,
        /// What the format lacks.
        what: String,
    },
}

impl Error {
    /// Checks whether the file does not exist.
    pub fn is_missing_file(&self) -> bool {
        matches!(self, Self::Read { source, .. } if source.kind() == std::io::ErrorKind::NotFound)
    }
}

/// A place in a mesh file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Place {
    /// A line, counted from 1.
    Line(usize),
    /// A face, counted from 0 in the order of the file.
    Face(usize),
    /// The header.
    Header,
    /// The binary part.
    Data,
    /// Past the last byte: something is missing.
    End,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(line) => write!(f, "line {line}"),
            Self::Face(face) => write!(f, "face {face}"),
            Self::Header => f.write_str("header"),
            Self::Data => f.write_str("binary data"),
            Self::End => f.write_str("end of file"),
        }
    }
}

/// An error of a reader, which does not know the name of its file.
#[derive(Debug)]
pub(crate) struct Fault {
    place: Place,
    what: String,
}

impl Fault {
    pub(crate) fn new(place: Place, what: impl Into<String>) -> Self {
        Self { place, what: what.into() }
    }

    pub(crate) fn in_file(self, path: &Path) -> Error {
        Error::Syntax { path: path.to_owned(), place: self.place, what: self.what }
    }
}
