//! The command line of `colltrans directions`.

use std::path::PathBuf;

use clap::Args;
use colltrans::removal::directions::FreeOptions;
use colltrans_mesh::body::BodyOptions;

use super::{BodyArguments, BodyMode, InputPair, PlaceArguments, length, output_file};
use crate::failure::Failure;

#[derive(Debug, Args)]
pub(crate) struct DirectionsArguments {
    /// The moving mesh and the fixed one; with --from all moving ones, as one body
    #[arg(required = true, value_name = "MESH")]
    meshes: Vec<PathBuf>,
    /// The fixed meshes, as one body
    #[arg(long, num_args = 1.., value_name = "FIXED")]
    from: Vec<PathBuf>,
    /// Permitted overlap, in the unit of the meshes [default: from the precision of the files]
    #[arg(long, value_name = "L", allow_hyphen_values = true, value_parser = length)]
    pub(crate) tolerance: Option<f64>,
    /// Ignore overlaps at the start: faces that cross now do not block
    #[arg(long)]
    pub(crate) ignore_start_overlaps: bool,
    /// Print the answer as one JSON object
    #[arg(long)]
    pub(crate) json: bool,
    /// Write the proof and the bodies as a file for `colltrans verify`
    #[arg(long, value_name = "OUT.json", value_parser = output_file)]
    pub(crate) save_proof: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) work: WorkArguments,
    #[command(flatten)]
    pub(crate) places: PlaceArguments,
    #[command(flatten)]
    body: BodyArguments,
}

/// Limits of the work, beyond which directions stay undecided.
#[derive(Debug, Clone, Copy, Args)]
pub(crate) struct WorkArguments {
    /// Maximum number of subdivisions of the sides of a cube of directions
    #[arg(long, value_name = "N", default_value_t = FreeOptions::DEFAULT.depth, value_parser = clap::value_parser!(u32).range(..=50))]
    depth: u32,
    /// Maximum number of pairs of boxes to visit; the remaining directions stay undecided
    #[arg(long, value_name = "N", default_value_t = FreeOptions::DEFAULT.looks)]
    looks: u64,
}

impl WorkArguments {
    /// Returns the options of the library with these limits.
    pub(crate) fn options(self) -> FreeOptions {
        FreeOptions::DEFAULT.with_depth(self.depth).with_looks(self.looks)
    }
}

impl DirectionsArguments {
    /// Returns the files of both bodies, which are parts.
    pub(crate) fn input_pair(&self) -> Result<InputPair<'_>, Failure> {
        InputPair::from_arguments(&self.meshes, &self.from, BodyMode::Parts, false)
    }

    /// Returns how the moving and the fixed files are read.
    pub(crate) fn part_options(&self) -> [BodyOptions; 2] {
        self.body.part_options(&self.places, false)
    }
}
