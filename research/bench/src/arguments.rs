//! The command line of the measuring programs.

use std::path::PathBuf;

use clap::Args;

/// What all of them take.
#[derive(Debug, Clone, Args)]
pub struct Arguments {
    /// Vertices per body, instead of the usual sizes
    #[arg(long, value_name = "N,...", value_delimiter = ',')]
    pub sizes: Option<Vec<usize>>,
    /// Fewer settings
    #[arg(long)]
    pub quick: bool,
    /// A file for the figures
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// What bodies and settings are drawn from
    #[arg(long, value_name = "S", default_value_t = 1)]
    pub seed: u64,
}
