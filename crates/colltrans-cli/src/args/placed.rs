//! `colltrans distance`, `depth` and `within`: two bodies where they are.

use std::path::PathBuf;

use clap::Args;
use colltrans::record::PairQuestion;
use colltrans_mesh::body::BodyOptions;

use super::{BodyArguments, HullArguments, PlaceArguments, Sides, Taken, UNCLEAN, one};
use super::{length, picture, proof};
use crate::failure::Failure;

#[derive(Debug, Args)]
pub(crate) struct PlacedArguments {
    /// Both meshes; with --from all of the first body. They are called the moving and the fixed one
    #[arg(required = true, value_name = "MESH")]
    meshes: Vec<PathBuf>,
    /// The meshes of the other body, in place: parts, that need not be convex
    #[arg(long, num_args = 1.., value_name = "FIXED")]
    from: Vec<PathBuf>,
    /// Of distance and within: the other bodies, of which the nearest is looked for, or all that are closer than
    /// a length: meshes, each in place, and files of obstacles (.jsonl)
    ///
    /// A line of such a file is {"body": BODY, "pose": POSE, "name": "..."}, with a BODY and a POSE as in
    /// `batch --help`; a body that occurs many times is kept once.
    #[arg(long, num_args = 1.., value_name = "SCENE", conflicts_with_all = ["from", "picture", "fixed_pose", "fixed_rpy", "fixed_scale"])]
    pub(crate) among: Vec<PathBuf>,
    /// Print the answer as one JSON object, as `batch` does (see `batch --help` for its fields)
    #[arg(long)]
    pub(crate) json: bool,
    /// Draw both bodies, and the shortest way between them or out of each other, as an SVG picture
    #[arg(long, value_name = "OUT.svg", value_parser = picture)]
    pub(crate) picture: Option<PathBuf>,
    /// Write the proof of the answer, with the bodies and where they are, as one file that `colltrans
    /// verify` checks
    #[arg(long, value_name = "OUT.json", value_parser = proof)]
    pub(crate) save_proof: Option<PathBuf>,
    /// Take surfaces that are not closed, as sheets and scans are: without an inside
    #[arg(long, help_heading = UNCLEAN)]
    open: bool,
    #[command(flatten)]
    pub(crate) places: PlaceArguments,
    #[command(flatten)]
    hulls: HullArguments,
    #[command(flatten)]
    pub(crate) body: BodyArguments,
}

#[derive(Debug, Args)]
pub(crate) struct WithinArguments {
    /// The length that the distance is compared with, in the unit of the meshes
    #[arg(long, value_name = "L", allow_hyphen_values = true, value_parser = length)]
    pub(crate) length: f64,
    #[command(flatten)]
    pub(crate) placed: PlacedArguments,
}

impl PlacedArguments {
    /// Who is called moving, who fixed, and as what they are taken, for a question.
    pub(crate) fn sides(&self, question: PairQuestion) -> Result<Sides<'_>, Failure> {
        Sides::of(&self.meshes, &self.from, self.taken()?, question != PairQuestion::Depth)
    }

    /// The one mesh before --among.
    pub(crate) fn one(&self) -> Result<&PathBuf, Failure> {
        one(&self.meshes)
    }

    /// As what meshes are taken.
    pub(crate) fn taken(&self) -> Result<Taken, Failure> {
        let asks_parts = self.open || !self.from.is_empty();
        let clash =
            "--convex-tolerance and --hull are for two convex meshes; --from and --open for parts";
        Taken::of([self.hulls.asks_convex(self.body), asks_parts], clash)
    }

    /// How both files become convex bodies.
    pub(crate) fn body_options(&self) -> [BodyOptions; 2] {
        self.hulls.body_options(self.body, &self.places)
    }

    /// How the files of both bodies are read as parts.
    pub(crate) fn part_options(&self) -> [BodyOptions; 2] {
        self.body.part_options(&self.places, self.open)
    }
}
