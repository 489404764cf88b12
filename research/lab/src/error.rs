//! Errors of a run.

use std::io;
use std::path::PathBuf;

/// Reason why results cannot be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LabError {
    /// The folder of the results cannot be created.
    #[error("{}: cannot create the folder: {source}", path.display())]
    Folder {
        /// The folder.
        path: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
    /// A file cannot be written.
    #[error("{}: cannot be written: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
    /// A picture cannot be encoded.
    #[error("{figure}: cannot be drawn as PNG: {reason}")]
    Picture {
        /// Identifier of the figure.
        figure: String,
        /// Message of the encoder.
        reason: String,
    },
    /// A figure of the paper cannot be reproduced.
    #[error("the paper's figures: {0}")]
    Figures(#[from] crate::figures::Error),
}
