//! The command line of `colltrans distance`, `depth` and `within`.

use std::path::PathBuf;

use clap::Args;
use colltrans::record::PairQuestion;
use colltrans_mesh::body::BodyOptions;

use super::{BODY_HEADING, BodyArguments, BodyMode, HullArguments, InputPair, PlaceArguments};
use super::{length, output_file, picture, single_mesh};
use crate::failure::Failure;

#[derive(Debug, Args)]
pub(crate) struct PlacedArguments {
    /// Both meshes, called moving and fixed; with --from all of the first body
    #[arg(required = true, value_name = "MESH")]
    meshes: Vec<PathBuf>,
    /// The meshes of the other body, in place: parts that need not be convex
    #[arg(long, num_args = 1.., value_name = "FIXED")]
    from: Vec<PathBuf>,
    /// The scene, for distance and within: meshes and files of obstacles (.jsonl)
    #[arg(long, num_args = 1.., value_name = "SCENE", conflicts_with_all = ["from", "picture", "fixed_pose", "fixed_rpy", "fixed_scale"])]
    pub(crate) scene: Vec<PathBuf>,
    /// Print the answer as one JSON object
    #[arg(long)]
    pub(crate) json: bool,
    /// Draw both bodies, and the shortest way between them or out of each other, as an SVG picture
    #[arg(long, value_name = "OUT.svg", value_parser = picture)]
    pub(crate) picture: Option<PathBuf>,
    /// Write the proof and the bodies as a file for `colltrans verify`
    #[arg(long, value_name = "OUT.json", value_parser = output_file)]
    pub(crate) save_proof: Option<PathBuf>,
    /// Whether the proof is about the common part, for which all bodies are parts.
    #[arg(skip)]
    pub(crate) common_part: bool,
    #[command(flatten)]
    pub(crate) places: PlaceArguments,
    /// Accept surfaces that are not closed, without an interior
    #[arg(long, help_heading = BODY_HEADING, hide_short_help = true)]
    open: bool,
    #[command(flatten)]
    hulls: HullArguments,
    #[command(flatten)]
    pub(crate) body: BodyArguments,
}

#[derive(Debug, Args)]
pub(crate) struct WithinArguments {
    /// The length to compare the distance with, in the unit of the meshes
    #[arg(long, value_name = "L", allow_hyphen_values = true, value_parser = length)]
    pub(crate) length: f64,
    #[command(flatten)]
    pub(crate) placed: PlacedArguments,
}

#[derive(Debug, Args)]
pub(crate) struct DepthArguments {
    /// Prove how much of the parts overlaps: the volume of their common part, its box, and whether one contains the other
    #[arg(long, requires = "save_proof")]
    pub(crate) common_part: bool,
    #[command(flatten)]
    pub(crate) placed: PlacedArguments,
}

impl DepthArguments {
    /// Returns the arguments of a query of two placed bodies.
    pub(crate) fn into_placed(self) -> PlacedArguments {
        PlacedArguments { common_part: self.common_part, ..self.placed }
    }
}

impl PlacedArguments {
    /// Returns the files of both bodies. The question decides whether error messages suggest a scene.
    pub(crate) fn input_pair(&self, question: PairQuestion) -> Result<InputPair<'_>, Failure> {
        let has_scene = question != PairQuestion::Depth;
        InputPair::from_arguments(&self.meshes, &self.from, self.body_mode()?, has_scene)
    }

    /// Returns the moving mesh of a query with a scene.
    pub(crate) fn moving_mesh(&self) -> Result<&PathBuf, Failure> {
        single_mesh(&self.meshes)
    }

    /// Returns the kind of bodies that the options require.
    pub(crate) fn body_mode(&self) -> Result<BodyMode, Failure> {
        let requires_parts = self.open || self.common_part || !self.from.is_empty();
        let clash = "--convex-tolerance and --hull require two convex meshes; --from, --open and --common-part require parts; \
             drop one of the two groups";
        BodyMode::from_requirements([self.hulls.requires_convex(self.body), requires_parts], clash)
    }

    /// Returns how the moving and the fixed file are read as convex bodies.
    pub(crate) fn body_options(&self) -> [BodyOptions; 2] {
        self.hulls.body_options(self.body, &self.places)
    }

    /// Returns how the moving and the fixed files are read as parts.
    pub(crate) fn part_options(&self) -> [BodyOptions; 2] {
        self.body.part_options(&self.places, self.open)
    }
}
