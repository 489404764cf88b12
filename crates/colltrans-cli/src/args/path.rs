//! The command line of `colltrans path`.

use std::path::PathBuf;

use clap::Args;

use super::{factor, length, output_file};

#[derive(Debug, Args)]
#[expect(clippy::struct_excessive_bools, reason = "they are flags of the command line")]
pub(crate) struct PathArguments {
    /// The robot: a URDF (.urdf), SDF (.sdf) or MJCF file (.xml)
    pub(crate) robot: PathBuf,
    /// The path: rows of joint values in radians and metres, CSV or JSON; `-` for standard input
    #[arg(value_name = "PATH")]
    pub(crate) rows: PathBuf,
    /// Meshes of the scene, in place and in metres: convex bodies, or parts with holes and cavities
    pub(crate) scene: Vec<PathBuf>,
    /// Pairs of links to leave out: `disable_collisions` of an SRDF file [default: links with one moving
    /// joint between them]
    #[arg(long, value_name = "ROBOT.srdf")]
    pub(crate) srdf: Option<PathBuf>,
    /// A pair to leave out: two links, or a link and a mesh of the scene (its file's name without extension)
    #[arg(long, value_name = "A,B")]
    pub(crate) ignore: Vec<String>,
    /// The value of a fixed joint, in radians or metres, instead of a column
    #[arg(long, value_name = "NAME=VALUE", allow_hyphen_values = true)]
    pub(crate) joint: Vec<String>,
    /// The minimum gap: bodies count as touching at this distance, in metres
    #[arg(long, value_name = "GAP", allow_hyphen_values = true, value_parser = length, default_value = "0")]
    pub(crate) min_gap: f64,
    /// A link whose meshes are replaced by their convex hulls; * stands for all links. Open meshes are not
    /// replaced
    #[arg(long, value_name = "LINK")]
    pub(crate) hull: Vec<String>,
    /// Fail with exit code 7 if the answer covers less than the input: unused velocities
    #[arg(long)]
    pub(crate) strict: bool,
    /// Print the answer as one JSON object
    #[arg(long)]
    pub(crate) json: bool,
    /// Write the proof, the robot, its path and the scene as a file for `colltrans verify`
    #[arg(long, value_name = "OUT.json", value_parser = output_file)]
    pub(crate) save_proof: Option<PathBuf>,
    /// Factor of the scene's meshes: 0.001 for millimetres
    #[arg(long, value_name = "FACTOR", value_parser = factor, default_value = "1")]
    pub(crate) scene_scale: f64,
    /// A folder in which `package://` references of the robot's file are searched
    #[arg(long, value_name = "DIR")]
    pub(crate) package: Vec<PathBuf>,
    /// Read referenced files outside of the robot's folder and of every --package; only for trusted files
    #[arg(long)]
    pub(crate) allow_outside: bool,
    /// Skip referenced meshes that do not exist, with a note
    #[arg(long)]
    pub(crate) skip_missing: bool,
}
