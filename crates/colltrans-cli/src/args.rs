//! The command line.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use colltrans::glam::{DQuat, DVec3};
use colltrans::{Pose, Solver};

const EXIT_CODES: &str = "\
Exit codes:
  0  answered (contact, grazing and separated are all answers)
  1  batch: some lines have no answer; the results say which and why
  2  the command line is wrong
  3  an input file cannot be read, or a body is not what it should be
  4  the query has no certified answer (please report the case)
  5  the output cannot be written";

const FORMATS: &str = "\
Mesh files: STL (binary or text), OBJ, PLY and OFF, told by their extension. Vertex indices in
answers count from 0 in the order of the file; the corners of STL triangles are merged where they
are equal, in the order of their first appearance.";

/// How far can one convex body translate before it touches another? Certified.
#[derive(Debug, Parser)]
#[command(version, about, after_help = EXIT_CODES, after_long_help = format!("{FORMATS}\n\n{EXIT_CODES}"))]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Move one mesh along a direction until it touches another
    #[command(after_help = EXIT_CODES, after_long_help = format!("{FORMATS}\n\n{EXIT_CODES}"))]
    Cast(Box<CastArguments>),
    /// Answer every query of a file with one JSON object a line
    #[command(after_help = EXIT_CODES, after_long_help = format!("{BATCH_FORMAT}\n\n{EXIT_CODES}"))]
    Batch(BatchArguments),
    /// Say what a mesh file holds, and whether it is convex
    #[command(after_help = EXIT_CODES, after_long_help = format!("{FORMATS}\n\n{EXIT_CODES}"))]
    Info(InfoArguments),
}

#[derive(Debug, Args)]
pub(crate) struct CastArguments {
    /// The mesh that moves
    pub(crate) moving: PathBuf,
    /// The mesh that stays
    pub(crate) fixed: PathBuf,
    /// Where to: three numbers, not all zero
    ///
    /// The answer is in multiples of this vector: a length if it has length 1.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = direction)]
    pub(crate) direction: DVec3,
    /// Where the moving mesh starts: x,y,z or x,y,z,qx,qy,qz,qw
    ///
    /// A translation, and a rotation before it, as a quaternion of length 1 (to within 1e-6). A
    /// quarter turn about z, then one unit up: 0,0,1,0,0,0.7071067811865476,0.7071067811865476
    #[arg(long, value_name = "POSE", allow_hyphen_values = true, value_parser = pose, default_value = "0,0,0")]
    pub(crate) moving_pose: Pose,
    /// Where the fixed mesh is, written like --moving-pose
    #[arg(long, value_name = "POSE", allow_hyphen_values = true, value_parser = pose, default_value = "0,0,0")]
    pub(crate) fixed_pose: Pose,
    /// How the search is narrowed; the answer is the same
    #[arg(long, value_enum, default_value_t = SolverName::Auto)]
    pub(crate) solver: SolverName,
    /// Sideways overlap up to which bodies slide along each other (grazing) instead of colliding
    ///
    /// In the unit of the meshes. 0 stands for the rounding error of the configuration.
    #[arg(long, value_name = "L", allow_hyphen_values = true, value_parser = length, default_value = "0")]
    pub(crate) graze_tolerance: f64,
    #[command(flatten)]
    pub(crate) body: BodyArguments,
    /// Print the answer as one JSON object, as `batch` does
    #[arg(long)]
    pub(crate) json: bool,
    /// Draw both bodies and the contact as an SVG picture
    #[arg(long, value_name = "OUT.svg")]
    pub(crate) picture: Option<PathBuf>,
}

/// What to do with meshes that are not convex.
#[derive(Debug, Clone, Copy, Args)]
pub(crate) struct BodyArguments {
    /// Take the convex hull of all vertices of a mesh, whatever its faces are
    #[arg(long)]
    pub(crate) hull: bool,
    /// How deep a face may lie below the convex hull, in the unit of the mesh [default: 1e-5 of
    /// the mesh's extent]
    ///
    /// Files round coordinates: STL to single precision (about 6e-8 of the largest coordinate), OBJ
    /// often to six digits. That alone makes faces of convex parts slightly concave. Whatever
    /// is tolerated, the body is the convex hull.
    #[arg(long, value_name = "L", allow_hyphen_values = true, value_parser = length)]
    pub(crate) convex_tolerance: Option<f64>,
}

#[derive(Debug, Args)]
pub(crate) struct BatchArguments {
    /// The queries, one JSON object a line; `-` for standard input
    pub(crate) queries: PathBuf,
    /// Where the results go; standard output if `-` or not given
    #[arg(short, long, value_name = "RESULTS.jsonl")]
    pub(crate) output: Option<PathBuf>,
    /// Number of threads [default: all cores]
    ///
    /// The results are the same, byte for byte and in the order of the queries.
    #[arg(long, value_name = "N", value_parser = threads)]
    pub(crate) threads: Option<NonZeroUsize>,
    #[command(flatten)]
    pub(crate) body: BodyArguments,
}

const BATCH_FORMAT: &str = r#"Each line of the queries is one JSON object:
  {"id": any, "moving": BODY, "fixed": BODY, "moving_pose": POSE, "fixed_pose": POSE,
   "direction": [x,y,z], "graze_tolerance": L, "solver": "auto"|"cta"|"portal"}
  BODY = {"points": [[x,y,z],...]} (their convex hull) or {"mesh": "path"}
  POSE = {"translation": [x,y,z], "rotation": [qx,qy,qz,qw]}, either may be missing
moving, fixed and direction are required. Paths are relative to the folder of the query file, or to
the current folder for standard input. Blank lines are skipped, unknown fields are errors.

Each result is one JSON object with those of these fields that apply:
  id           as in the query (null if it cannot be read)
  outcome      "contact", "grazing", "separated" or "error"
  translation  first contact, in multiples of the direction; negative: behind, or overlapping
  exit         last contact
  normal       unit normal from moving to fixed: of the contact plane, or of the separating plane
  point        the contact point on the fixed body, in the world
  lower upper  the proven bounds of translation
  features     {"moving": {"kind": "vertex"|"edge"|"face", "vertices": [...]}, "fixed": ...} by the
               indices of the points or mesh vertices in the input
  margin       gap between the shadows along the direction; grazing: minus their overlap
  solver steps what narrowed the search, and how much work it was
  message      what is wrong; grazing: along which direction the shadows overlap

Bodies that occur again are built once, as long as the last ones together have no more than 500,000
input vertices (about 250 MB). A line may have up to 64 MiB."#;

#[derive(Debug, Args)]
pub(crate) struct InfoArguments {
    /// The mesh files
    #[arg(required = true, value_name = "MESH")]
    pub(crate) meshes: Vec<PathBuf>,
    /// How deep a face may lie below the convex hull [default: 1e-5 of the mesh's extent]
    #[arg(long, value_name = "L", allow_hyphen_values = true, value_parser = length)]
    pub(crate) convex_tolerance: Option<f64>,
}

/// The name of a solver, on the command line and in queries.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, serde::Deserialize, Default)]
#[serde(rename_all = "lowercase")]
pub(crate) enum SolverName {
    /// Whichever was measured to be fastest for bodies of these sizes
    #[default]
    Auto,
    /// The collision translation algorithm
    Cta,
    /// Portal refinement
    Portal,
}

impl From<SolverName> for Solver {
    fn from(name: SolverName) -> Self {
        match name {
            SolverName::Auto => Self::Auto,
            SolverName::Cta => Self::Cta,
            SolverName::Portal => Self::Portal,
        }
    }
}

fn direction(text: &str) -> Result<DVec3, String> {
    match numbers(text)?.as_slice() {
        &[x, y, z] => Ok(DVec3::new(x, y, z)),
        other => Err(format!("{} numbers, not 3 (x,y,z)", other.len())),
    }
}

fn pose(text: &str) -> Result<Pose, String> {
    let (translation, rotation) = match numbers(text)?.as_slice() {
        &[x, y, z] => (DVec3::new(x, y, z), DQuat::IDENTITY),
        &[x, y, z, qx, qy, qz, qw] => (DVec3::new(x, y, z), DQuat::from_xyzw(qx, qy, qz, qw)),
        other => {
            let count = other.len();
            return Err(format!("{count} numbers, not 3 (x,y,z) or 7 (x,y,z,qx,qy,qz,qw)"));
        }
    };
    Pose::new(rotation, translation).map_err(|e| e.to_string())
}

fn length(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(length) if length.is_finite() && length >= 0.0 => Ok(length),
        Ok(_) => Err("must be finite and not negative".into()),
        Err(_) => Err("is no number".into()),
    }
}

fn numbers(text: &str) -> Result<Vec<f64>, String> {
    text.split(',')
        .map(|word| word.trim().parse().map_err(|_| format!("`{}` is no number", word.trim())))
        .collect()
}

/// Most threads that make sense to ask for.
const MOST_THREADS: usize = 1024;

fn threads(text: &str) -> Result<NonZeroUsize, String> {
    match text.parse::<NonZeroUsize>() {
        Ok(count) if count.get() <= MOST_THREADS => Ok(count),
        _ => Err(format!("a number from 1 to {MOST_THREADS} is needed")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_is_consistent() {
        <Arguments as clap::CommandFactory>::command().debug_assert();
    }

    #[test]
    fn poses() {
        assert_eq!(pose("1, -2,3e0").unwrap().translation(), DVec3::new(1.0, -2.0, 3.0));
        assert_eq!(pose("0,0,0,0,0,1,0").unwrap().matrix().x_axis, -DVec3::X);
        for bad in ["", "1,2", "1,2,3,4", "1,2,x", "0,0,0,0,0,0,2", "nan,0,0", "1e300,0,0"] {
            assert!(pose(bad).is_err(), "{bad}");
        }
    }
}
