//! `colltrans path`: which links of a robot first meet on a path.

use std::path::PathBuf;

use clap::Args;

use super::{factor, length, proof};

#[derive(Debug, Args)]
#[expect(clippy::struct_excessive_bools, reason = "they are flags of the command line")]
pub(crate) struct PathArguments {
    /// The robot: a URDF file (.urdf)
    pub(crate) robot: PathBuf,
    /// The path: rows of joint values, CSV or JSON; - reads standard input
    ///
    /// Angles are in radians, of prismatic joints there are metres, as URDF has them. From row to row each joint goes
    /// evenly. The formats are told below.
    #[arg(value_name = "PATH")]
    pub(crate) rows: PathBuf,
    /// Meshes that stand in the world, in place and in metres: convex bodies, or parts with holes and hollows
    pub(crate) scene: Vec<PathBuf>,
    /// Which links are not held against each other: `disable_collisions` of an SRDF file
    ///
    /// Without it these are links with one moving joint between them.
    #[arg(long, value_name = "ROBOT.srdf")]
    pub(crate) srdf: Option<PathBuf>,
    /// Two links, or a link and a mesh of the scene, that are not held against each other
    ///
    /// A mesh is named by its file, without folder and extension.
    #[arg(long, value_name = "A,B")]
    pub(crate) ignore: Vec<String>,
    /// A link whose meshes are taken as their convex hulls, whatever their faces are; * is all links
    ///
    /// For meshes that are no surface of a body. By how much a hull exceeds its mesh is said; `free` holds for the mesh
    /// too, a contact of a hull is only a bound. Meshes that are open are taken as they are.
    #[arg(long, value_name = "LINK")]
    pub(crate) hull: Vec<String>,
    /// Fail with exit code 7 where the answer is about less than the input: velocities that are not used
    #[arg(long)]
    pub(crate) strict: bool,
    /// The value of a joint that rests, in radians or metres, instead of a column
    #[arg(long, value_name = "NAME=VALUE", allow_hyphen_values = true)]
    pub(crate) joint: Vec<String>,
    /// A gap to be kept: ask when two are first as near as that, not when they touch
    #[arg(long, value_name = "GAP", allow_hyphen_values = true, value_parser = length, default_value = "0")]
    pub(crate) keep: f64,
    /// Multiply the lengths of the scene's meshes by this: 0.001 for millimetres
    #[arg(long, value_name = "FACTOR", value_parser = factor, default_value = "1")]
    pub(crate) scene_scale: f64,
    /// Print the answer as one JSON object
    #[arg(long)]
    pub(crate) json: bool,
    /// Write the proof of the answer, with the robot, its path and the scene, as one file that `colltrans verify`
    /// checks
    #[arg(long, value_name = "OUT.json", value_parser = proof)]
    pub(crate) save_proof: Option<PathBuf>,
    /// Where `package://` of the robot's file is looked for
    #[arg(long, value_name = "DIR")]
    pub(crate) package: Vec<PathBuf>,
    /// Read files that the robot's file names and that lie outside of its folder and of every --package
    ///
    /// By an absolute path, by `..`, or behind a link. Only for a file that you trust.
    #[arg(long)]
    pub(crate) allow_outside: bool,
    /// Leave out meshes that cannot be found, with a note
    #[arg(long)]
    pub(crate) skip_missing: bool,
}
