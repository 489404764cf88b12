//! Errors of mesh files, with their place.

use std::fmt;
use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::Format;

/// An error in reading or writing a mesh. Every message names the file.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum Error {
    /// The extension is not that of a supported format.
    #[error(
        "{}: unknown mesh format; the extension must be one of {}",
        path.display(),
        Format::ALL.iter().map(|format| format.extension()).collect::<Vec<_>>().join(", ")
    )]
    UnknownFormat {
        /// The file.
        path: PathBuf,
    },
    /// The contents have another format than the extension.
    #[error("{}: contains {found}, but its extension stands for {format}; rename or convert the file", path.display())]
    OtherContent {
        /// The file.
        path: PathBuf,
        /// The format of the extension.
        format: Format,
        /// The kind of the contents, with its article.
        found: &'static str,
    },
    /// The merge tolerance is invalid.
    #[error("{}: invalid merge tolerance {tolerance}; accepted: finite and not negative", path.display())]
    MergeTolerance {
        /// The file that was to be read.
        path: PathBuf,
        /// The tolerance that was given.
        tolerance: f64,
    },
    /// The file cannot be read.
    #[error("{}: cannot be read: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The error of the operating system.
        source: std::io::Error,
    },
    /// The file cannot be written.
    #[error("{}: cannot be written: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// The error of the operating system.
        source: std::io::Error,
    },
    /// The contents violate the format.
    #[error("{}: {place}: {what}", path.display())]
    Syntax {
        /// The file.
        path: PathBuf,
        /// The place in the file.
        place: Place,
        /// The reason.
        what: String,
    },
    /// The format cannot represent the mesh.
    #[error("{}: {what}", path.display())]
    NotStorable {
        /// The file that was to be written.
        path: PathBuf,
        /// The reason.
        what: String,
    },
}

impl Error {
    /// Checks whether the error means that the file does not exist.
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
    /// After the last byte: something is missing.
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

/// An error of a reader, without the name of the file.
#[derive(Debug)]
pub(crate) struct Fault {
    place: Place,
    what: String,
}

impl Fault {
    /// Builds an error from a place and a reason.
    pub(crate) fn new(place: Place, what: impl Into<String>) -> Self {
        Self { place, what: what.into() }
    }

    /// Adds the name of the file.
    pub(crate) fn in_file(self, path: &Path) -> Error {
        Error::Syntax { path: path.to_owned(), place: self.place, what: self.what }
    }
}
