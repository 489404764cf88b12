//! What can go wrong in a run.

use std::io;
use std::path::PathBuf;

/// Why the results of a run are not where they should be.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LabError {
    /// The folder of the results does not exist and cannot be made.
    #[error("{}: the folder cannot be made: {source}", path.display())]
    Folder {
        /// The folder.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// A file cannot be written.
    #[error("{}: cannot be written: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// A picture cannot be encoded.
    #[error("{figure}: cannot be drawn as PNG: {reason}")]
    Picture {
        /// The figure's id.
        figure: String,
        /// What the encoder says.
        reason: String,
    },
    /// A figure of the paper cannot be drawn anew.
    #[error("the paper's figures: {0}")]
    Figures(#[from] crate::figures::Error),
}
