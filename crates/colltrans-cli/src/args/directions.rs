//! `colltrans directions`: all directions along which a body leaves.

use std::path::PathBuf;

use clap::Args;
use colltrans::free::FreeOptions;
use colltrans_mesh::body::BodyOptions;

use super::{BodyArguments, PlaceArguments, Sides, Taken, length, proof};
use crate::failure::Failure;

#[derive(Debug, Args)]
pub(crate) struct DirectionsArguments {
    /// The mesh that moves and the one that stays; with --from all that move, as one body
    #[arg(required = true, value_name = "MESH")]
    meshes: Vec<PathBuf>,
    /// The meshes that stay, as one body
    #[arg(long, num_args = 1.., value_name = "FIXED")]
    from: Vec<PathBuf>,
    /// How deep bodies may enter each other [default: from the files' precision]
    ///
    /// As of `clearance`: both bodies are shrunk by half of it.
    #[arg(long, value_name = "L", allow_hyphen_values = true, value_parser = length)]
    pub(crate) tolerance: Option<f64>,
    /// Let what overlaps at the start pass: faces that cross now do not block
    #[arg(long)]
    pub(crate) ignore_start_overlaps: bool,
    #[command(flatten)]
    pub(crate) work: WorkArguments,
    /// Print the answer as one JSON object
    #[arg(long)]
    pub(crate) json: bool,
    /// Write the proof of the answer, with the bodies and where they are, as one file that `colltrans
    /// verify` checks
    #[arg(long, value_name = "OUT.json", value_parser = proof)]
    pub(crate) save_proof: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) places: PlaceArguments,
    #[command(flatten)]
    body: BodyArguments,
}

/// How much is done before something stays undecided.
#[derive(Debug, Clone, Copy, Args)]
pub(crate) struct WorkArguments {
    /// How often the sides of a cube of directions are halved, at most
    #[arg(long, value_name = "N", default_value_t = FreeOptions::DEFAULT.depth, value_parser = clap::value_parser!(u32).range(..=50))]
    depth: u32,
    /// How many pairs of boxes are looked at, at most; what is not decided by then stays undecided
    #[arg(long, value_name = "N", default_value_t = FreeOptions::DEFAULT.looks)]
    looks: u64,
}

impl WorkArguments {
    pub(crate) fn options(self) -> FreeOptions {
        FreeOptions::DEFAULT.with_depth(self.depth).with_looks(self.looks)
    }

    pub(crate) fn looks(self) -> u64 {
        self.looks
    }
}

impl DirectionsArguments {
    /// The files of the moving and of the fixed body, as parts.
    pub(crate) fn sides(&self) -> Result<Sides<'_>, Failure> {
        Sides::of(&self.meshes, &self.from, Taken::Parts, false)
    }

    /// How the files of both bodies are read.
    pub(crate) fn part_options(&self) -> [BodyOptions; 2] {
        self.body.part_options(&self.places, false)
    }
}
