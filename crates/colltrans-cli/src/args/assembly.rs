//! The command line of `assembly`.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::Args;
use colltrans::glam::DVec3;
use colltrans_assembly_io::read::Split;

use super::directions::WorkArguments;
use super::values::{direction, factor, legs, length, samples, threads};

#[derive(Debug, Args)]
#[expect(clippy::struct_excessive_bools, reason = "each is a flag of its own")]
pub(crate) struct AssemblyArguments {
    /// A folder of meshes, a manifest (.toml, .json), .urdf, .glb, .gltf, .3mf, .step, or one mesh
    pub(crate) source: PathBuf,
    /// How deep parts may overlap and still pass: chord errors of curved fits, press fits
    ///
    /// Every part is shrunk by half of it. In the unit of the files. [default: from the files'
    /// precision: 4.8e-7 of the assembly's extent and of the largest coordinate in single precision,
    /// 8 units of the last printed place of text, 1.4e-14 of the largest coordinate of doubles]
    #[arg(long, value_name = "L", allow_hyphen_values = true, value_parser = length)]
    pub(crate) tolerance: Option<f64>,
    /// Of a STEP file: how far facets may be from its surfaces, about, in millimetres
    ///
    /// How far they are is measured, part by part, and is the tolerance unless --tolerance is given.
    #[arg(long, value_name = "L", default_value_t = 0.05, allow_hyphen_values = true, value_parser = factor)]
    pub(crate) chord: f64,
    /// How far parts must stay apart when they pass, in all directions
    #[arg(long, alias = "margin", value_name = "L", allow_hyphen_values = true, value_parser = length, conflicts_with = "tolerance")]
    pub(crate) keep_apart: Option<f64>,
    /// A direction to ask first: three numbers or an axis (x, -x, ...); may be given several times
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = direction)]
    pub(crate) direction: Vec<DVec3>,
    /// Rooms in many directions: a file with one a line, `-` for standard input
    #[arg(long, value_name = "FILE")]
    pub(crate) directions: Option<PathBuf>,
    /// Rooms in so many directions or more, spread over the sphere; the plan tries them too
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = samples)]
    pub(crate) samples: Option<usize>,
    /// Ask only the directions that are given
    #[arg(long)]
    pub(crate) only: bool,
    /// Map the free travel of a part over the whole sphere; several names with commas between them, or a
    /// name that ends with `*`, are one group
    #[arg(long, value_name = "PART")]
    pub(crate) map: Vec<String>,
    /// Say along which directions a part can leave all others: all of them, proven; groups as of --map
    #[arg(long, value_name = "PART", conflicts_with_all = ["keep_apart", "ignore_overlaps"])]
    pub(crate) free: Vec<String>,
    #[command(flatten)]
    pub(crate) work: WorkArguments,
    /// Do not try to prove of what is stuck that no straight motion of a group as one, in any direction, takes it from
    /// the others; nor with --only
    #[arg(long)]
    pub(crate) no_proofs: bool,
    /// How many moves, one after another, may take out what no single one does; parts may make room and go back
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = legs)]
    pub(crate) legs: usize,
    /// Parts that overlap at the start do not block each other until contacts that begin later
    #[arg(long)]
    pub(crate) ignore_overlaps: bool,
    /// Two parts that overlap at the start, which lets them pass; contacts that begin later block
    #[arg(long, value_name = "A,B")]
    pub(crate) ignore: Vec<String>,
    /// Two parts that never block each other, whatever they run through
    #[arg(long, value_name = "A,B")]
    pub(crate) ignore_always: Vec<String>,
    /// The direction of gravity: parts are rather lifted, and not taken from under others [default: -y of glTF, else -z]
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = direction)]
    pub(crate) gravity: Option<DVec3>,
    #[command(flatten)]
    pub(crate) roles: RoleArguments,
    #[command(flatten)]
    pub(crate) asked: ConstraintArguments,
    /// Where `package://` of a URDF file is looked for
    #[arg(long, value_name = "DIR")]
    pub(crate) package: Vec<PathBuf>,
    /// Read files that SOURCE names and that lie outside of its folder and of every --package
    ///
    /// By an absolute path, by `..`, or behind a link. Only for a source that you trust.
    #[arg(long)]
    pub(crate) allow_outside: bool,
    /// Refuse parts whose surface has to be mended: facets that are doubled, hang on it or run against the
    /// others, vertices that are not quite one
    #[arg(long)]
    pub(crate) as_is: bool,
    /// Which parts are made of a file with several bodies: auto, never, names or bodies
    ///
    /// `names`: each object or group of OBJ, each solid of STL. `bodies`: each closed shell with the cavities in it, and
    /// each open shell. `never`: a file, a node of glTF or an item of a 3MF build is one part. `auto`: a source that
    /// would be a single part is taken apart, by names or else into bodies; files of a folder stay as they are, with a
    /// note.
    #[arg(long, value_name = "WHICH", default_value = "auto", hide_default_value = true)]
    pub(crate) split: Split,
    /// A part whose file is in another unit: so many times as large; PART* is all parts whose names begin so
    #[arg(long, value_name = "PART=FACTOR")]
    pub(crate) scale: Vec<String>,
    /// Leave out meshes that cannot be found, and what a manifest says of them, with a note
    #[arg(long)]
    pub(crate) skip_missing: bool,
    /// Read what URDF links show, not what they collide with
    #[arg(long)]
    pub(crate) visual: bool,
    /// The position of a joint, in radians or metres
    #[arg(long, value_name = "NAME=VALUE")]
    pub(crate) joint: Vec<String>,
    /// Print one JSON object
    #[arg(long)]
    pub(crate) json: bool,
    /// A folder for report.html, disassembly.glb, assembly.json, matrix.csv, precedence.csv and .json, maps, and proofs
    /// of --free
    #[arg(short, long, value_name = "DIR")]
    pub(crate) output: Option<PathBuf>,
    /// Handling times in seconds, as JSON: what to replace of the table, of grasp, move, direction, shape, group, hold,
    /// press, soft, snap, thread
    #[arg(long, value_name = "FILE.json")]
    pub(crate) times: Option<PathBuf>,
    /// Number of threads [default: all cores]; the answer is the same
    #[arg(long, value_name = "N", value_parser = threads)]
    pub(crate) threads: Option<NonZeroUsize>,
}

/// What is asked of the plan.
#[derive(Debug, Args)]
#[command(next_help_heading = "What is asked of the plan; PART* is all parts whose names begin so")]
pub(crate) struct ConstraintArguments {
    /// A part that is never moved
    #[arg(long, value_name = "PART")]
    pub(crate) fixed: Vec<String>,
    /// Take out this part, or these, and only what has to go for that: the fewest others, if that can be said
    #[arg(long, value_name = "PART,...", value_delimiter = ',')]
    pub(crate) remove: Vec<String>,
    /// B does not leave while A stays
    #[arg(long, value_name = "A,B")]
    pub(crate) before: Vec<String>,
    /// A does not leave while B stays
    #[arg(long, value_name = "A,B")]
    pub(crate) after: Vec<String>,
    /// Parts that leave as one and are not taken apart
    #[arg(long, value_name = "A,B,...")]
    pub(crate) together: Vec<String>,
    /// Parts that leave as one and are taken apart by themselves
    #[arg(long, value_name = "NAME=A,B,...")]
    pub(crate) subassembly: Vec<String>,
    /// A part never goes along a direction, nor within 45 degrees of it, or so many as are given
    #[arg(long, value_name = "PART=X,Y,Z[@DEGREES]")]
    pub(crate) never: Vec<String>,
}

/// What pairs are to each other.
#[derive(Debug, Args)]
#[command(
    next_help_heading = "Contacts that are not like the others; PART* is all parts whose names begin so"
)]
pub(crate) struct RoleArguments {
    /// A press fit: both are shrunk, against each other only, by half of L each [default: from how deep they overlap]
    #[arg(long, value_name = "A,B[=L]")]
    pub(crate) press: Vec<String>,
    /// One part is soft, as a seal or a belt: as --press
    #[arg(long, value_name = "A,B[=L]")]
    pub(crate) soft: Vec<String>,
    /// One part is screwed into the other, with a tolerance of the thread: it is unscrewed, which is certified where it can be
    #[arg(long, value_name = "A,B[=L]")]
    pub(crate) thread: Vec<String>,
    /// One part snaps over the other: contacts that begin within L of the start let it pass
    #[arg(long, value_name = "A,B=L")]
    pub(crate) snap: Vec<String>,
    /// Two parts that leave as one and are not taken apart
    #[arg(long, value_name = "A,B")]
    pub(crate) glued: Vec<String>,
    /// A tolerance of a pair's own, whatever --tolerance is
    #[arg(long, value_name = "A,B=L")]
    pub(crate) pair: Vec<String>,
    /// If parts do not come apart: once more, with what their overlaps and threads suggest; it is said
    #[arg(long, conflicts_with = "keep_apart")]
    pub(crate) auto: bool,
}
