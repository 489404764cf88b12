//! The command line.

use std::num::NonZeroUsize;
use std::path::PathBuf;

mod assembly;
mod directions;
mod groups;
mod help;
mod motion;
mod path;
mod placed;
mod values;

use clap::{Args, Parser, Subcommand};
use colltrans::glam::DVec3;
use colltrans::{Pose, Solver, cta};
use colltrans_mesh::body::BodyOptions;

use crate::failure::{Code, Failure};
use crate::inputs::is_list;
pub(crate) use assembly::{AssemblyArguments, ConstraintArguments, RoleArguments};
pub(crate) use directions::DirectionsArguments;
use help::{
    ASSEMBLY_FORMAT, BATCH_FORMAT, CAST_EXAMPLES, CLEARANCE_ANSWERS, DIRECTIONS_ANSWERS,
    DISTANCE_ANSWERS, EXIT_CODES, MOTION_ANSWERS, PATH_ANSWERS, SETUP_EXAMPLES, fitted, formats,
};
pub(crate) use motion::MotionArguments;
pub(crate) use path::PathArguments;
pub(crate) use placed::{PlacedArguments, WithinArguments};
pub(crate) use values::{Angles, Place, direction, normalised, normalised_poses};
use values::{angles, bytes, factor, length, picture, place, proof, solver, start, threads};

/// How far can one body move along a direction before it touches another?
///
/// Start with `colltrans info MESH` to see what a mesh is. Convex bodies: `colltrans cast MOVING FIXED
/// --direction -z`, with proven bounds. Parts that have holes and hollows: `colltrans clearance MOVING
/// --from FIXED --direction -z`. How far apart two bodies are: `colltrans distance A B`.
#[derive(Debug, Parser)]
#[command(name = "colltrans", version, max_term_width = help::WIDEST, help_template = groups::template(&Command::augment_subcommands(clap::Command::new("colltrans"))), after_help = fitted(&[EXIT_CODES]), after_long_help = fitted(&[CAST_EXAMPLES, &formats(), EXIT_CODES]))]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Move one mesh along a direction until it touches another
    ///
    /// The answer is the translation at which they first meet, wherever the moving mesh is now:
    /// negative if they overlap, or if the contact lies behind.
    #[command(after_help = fitted(&[EXIT_CODES]), after_long_help = fitted(&[CAST_EXAMPLES, &formats(), EXIT_CODES]))]
    Cast(Box<CastArguments>),
    /// Say how far a mesh can move from where it is before another blocks it
    ///
    /// Two convex meshes are asked as convex bodies, as `cast` asks them. Meshes that are not, several on
    /// a side, and whatever stands after --from are parts: closed surfaces with their holes and
    /// hollows, several files on a side being one body, in place. Contacts behind do not block.
    #[command(visible_alias = "clear", after_help = fitted(&[EXIT_CODES]), after_long_help = fitted(&[CLEARANCE_ANSWERS, &formats(), EXIT_CODES]))]
    Clearance(Box<ClearanceArguments>),
    /// Say along which directions a mesh can leave another one: all of them, proven
    ///
    /// The whole set: regions of directions with their borders, arcs and single directions, and that all
    /// others are blocked. Meshes are parts, closed surfaces with their holes and hollows, as those of
    /// `clearance --from`.
    #[command(visible_alias = "free", after_help = fitted(&[EXIT_CODES]), after_long_help = fitted(&[DIRECTIONS_ANSWERS, &formats(), EXIT_CODES]))]
    Directions(Box<DirectionsArguments>),
    /// Say how far apart two meshes are where they are, and where they are nearest
    ///
    /// With proven bounds, however near they are: the true distance lies between them. Meshes are taken as
    /// `clearance` takes them: two convex ones as convex bodies, all others as closed parts with their holes
    /// and hollows.
    #[command(visible_alias = "dist", after_help = fitted(&[EXIT_CODES]), after_long_help = fitted(&[DISTANCE_ANSWERS, &formats(), EXIT_CODES]))]
    Distance(Box<PlacedArguments>),
    /// Say how deep two meshes overlap where they are: which shortest translation parts them
    ///
    /// Over all directions, with proven bounds, of convex bodies. Parts that are not convex have another
    /// measure: the least tolerance with which they would not overlap, as `clearance` has it.
    #[command(after_help = fitted(&[EXIT_CODES]), after_long_help = fitted(&[DISTANCE_ANSWERS, &formats(), EXIT_CODES]))]
    Depth(Box<PlacedArguments>),
    /// Say whether two meshes are closer than a length where they are
    ///
    /// Ended as soon as that is known, which is sooner than the distance is. Meshes are taken as `distance`
    /// takes them.
    #[command(after_help = fitted(&[EXIT_CODES]), after_long_help = fitted(&[DISTANCE_ANSWERS, &formats(), EXIT_CODES]))]
    Within(Box<WithinArguments>),
    /// Say when a mesh that turns, unscrews, swings or is thrown first touches another
    ///
    /// With proven bounds on the time, from 0 at the start to 1 at the end of the motion; or that it never
    /// does, proven of the whole motion and not of samples. Both sides may move. Convex meshes are asked as
    /// convex bodies, with a proof; all others as parts with their holes and hollows, as `clearance` takes
    /// them.
    #[command(after_help = fitted(&[EXIT_CODES]), after_long_help = fitted(&[MOTION_ANSWERS, &formats(), EXIT_CODES]))]
    Motion(Box<MotionArguments>),
    /// Say which links of a robot first meet on a path of joint values, each other or a scene
    ///
    /// With proven bounds on the time; or that none do, proven of the whole path and not of samples. The robot is a
    /// URDF file, the path has rows of joint values, in radians and metres as URDF has them.
    #[command(after_help = fitted(&[EXIT_CODES]), after_long_help = fitted(&[PATH_ANSWERS, &formats(), EXIT_CODES]))]
    Path(Box<PathArguments>),
    /// Answer every query of a file with one JSON object a line
    #[command(after_help = fitted(&[EXIT_CODES]), after_long_help = fitted(&[BATCH_FORMAT, EXIT_CODES]))]
    Batch(BatchArguments),
    /// Say which parts of an assembly come out, along which directions, in which order, and what
    /// holds the rest
    ///
    /// Parts are solids of any shape, not only convex ones. Without --direction, directions are
    /// found: contact normals and what is orthogonal to them, cylinder axes, the world's axes.
    #[command(after_help = fitted(&[EXIT_CODES]), after_long_help = fitted(&[ASSEMBLY_FORMAT, EXIT_CODES]))]
    Assembly(Box<AssemblyArguments>),
    /// Say what a mesh file holds, and whether it is convex
    #[command(after_help = fitted(&[EXIT_CODES]), after_long_help = fitted(&[&formats(), EXIT_CODES]))]
    Info(InfoArguments),
    /// Answer a saved query once more
    ///
    /// A query that ends without an answer is saved as colltrans-case-1.json, exact in bits.
    #[command(after_help = fitted(&[EXIT_CODES]))]
    Replay(ReplayArguments),
    /// Check a proof that --save-proof has written, without a search
    ///
    /// Says in one line what is proven of the bodies in the file; exit code 6 if it does not hold.
    #[command(after_help = fitted(&[EXIT_CODES]))]
    Verify(VerifyArguments),
    /// Install completions for shells, and man pages
    ///
    /// For bash, zsh and fish, where they look for them under a prefix; zsh may have to be told of the folder
    /// (`fpath+=~/.local/share/zsh/site-functions`). What is written is said, file by file.
    #[command(after_help = fitted(&[SETUP_EXAMPLES, EXIT_CODES]))]
    Setup(SetupArguments),
}

#[derive(Debug, Args)]
pub(crate) struct CastArguments {
    /// The mesh that moves
    pub(crate) moving: PathBuf,
    /// The mesh that stays
    pub(crate) fixed: PathBuf,
    #[command(flatten)]
    pub(crate) pair: PairArguments,
}

#[derive(Debug, Args)]
pub(crate) struct ClearanceArguments {
    /// The mesh that moves and the one that stays; with --from all that move, as one body
    #[arg(required = true, value_name = "MESH")]
    meshes: Vec<PathBuf>,
    /// The meshes that stay, as one body: parts, that need not be convex
    #[arg(long, num_args = 1.., value_name = "FIXED")]
    from: Vec<PathBuf>,
    /// The bodies that stay, of which the first one met is looked for: meshes, each in place, and files of
    /// obstacles (.jsonl)
    ///
    /// A line of such a file is {"body": BODY, "pose": POSE, "name": "..."}, with a BODY and a POSE as in
    /// `batch --help`; a body that occurs many times is kept once.
    #[arg(long, num_args = 1.., value_name = "SCENE", conflicts_with_all = ["from", "picture", "fixed_pose", "fixed_rpy", "fixed_scale"])]
    pub(crate) among: Vec<PathBuf>,
    /// Of parts: how deep bodies may enter each other [default: from the files' precision]
    ///
    /// In the unit of the meshes. Both bodies are shrunk by half of it. A curved fit of tessellated
    /// parts needs the chord errors of both together. The default is twice what rounding may have
    /// made of the coordinates of both files together (2.4e-7 of the largest coordinate for binary
    /// STL and PLY with float coordinates, else 3.6e-15 of it), and no less than what turned poses
    /// need. The answer states it.
    #[arg(long, value_name = "L", allow_hyphen_values = true, value_parser = length)]
    pub(crate) tolerance: Option<f64>,
    /// Of parts: let what overlaps at the start pass, and say what that is
    ///
    /// Faces that cross now do not block; contacts that begin later do.
    #[arg(long)]
    pub(crate) ignore_start_overlaps: bool,
    /// Take surfaces that are not closed, as sheets and scans are: they block from both sides and with
    /// their rims, without an inside
    #[arg(long, help_heading = UNCLEAN)]
    open: bool,
    #[command(flatten)]
    pub(crate) pair: PairArguments,
}

/// From where, and how far, planar sections narrow the search.
#[derive(Debug, Args)]
pub(crate) struct NarrowingArguments {
    /// Of --solver cta: where the minimisation starts [default: center]
    #[arg(long, value_name = "WHERE", value_parser = start())]
    start: Option<cta::Start>,
    /// Of --solver cta: where it ends, at the `exit` test of the paper, or where its bounds are as near as this share
    /// of the bodies' extent [default: exit]
    #[arg(long, value_name = "exit|SHARE")]
    until: Option<cta::Until>,
}

/// What is asked of two bodies, and what becomes of the answer.
#[derive(Debug, Args)]
pub(crate) struct PairArguments {
    #[command(flatten)]
    pub(crate) directions: DirectionArguments,
    /// Of convex bodies: how the search is narrowed; the answer is the same
    #[arg(long, value_parser = solver(), default_value_t = Solver::Auto)]
    pub(crate) solver: Solver,
    #[command(flatten)]
    narrowing: NarrowingArguments,
    /// Of convex bodies: sideways overlap up to which they slide along each other (grazing) instead of
    /// colliding
    ///
    /// In the unit of the meshes. 0 stands for the rounding error of the configuration.
    #[arg(long, value_name = "L", allow_hyphen_values = true, value_parser = length, default_value = "0")]
    pub(crate) graze_tolerance: f64,
    /// A gap to be kept: ask where the meshes are first as near as that, not where they touch
    ///
    /// In the unit of the meshes. Meshes that are nearer at the start overlap; who slides along at the
    /// gap is free.
    #[arg(long, value_name = "GAP", allow_hyphen_values = true, value_parser = length, default_value = "0")]
    pub(crate) keep: f64,
    /// Print the answer as one JSON object, as `batch` does (see `batch --help` for its fields)
    #[arg(long)]
    pub(crate) json: bool,
    /// Draw both bodies and the contact as an SVG picture
    #[arg(long, value_name = "OUT.svg", value_parser = picture)]
    pub(crate) picture: Option<PathBuf>,
    /// Write the proof of the answer, with the bodies and where they are, as one file that `colltrans
    /// verify` checks
    #[arg(long, value_name = "OUT.json", value_parser = proof, conflicts_with = "directions")]
    pub(crate) save_proof: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) places: PlaceArguments,
    #[command(flatten)]
    pub(crate) hulls: HullArguments,
    #[command(flatten)]
    pub(crate) body: BodyArguments,
}

const UNCLEAN: &str = "Meshes that are not convex, closed or clean";

/// The files of the moving and of the fixed body, and as what they are asked.
pub(crate) struct Sides<'a> {
    pub(crate) files: [&'a [PathBuf]; 2],
    pub(crate) taken: Taken,
}

/// As what files are asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Taken {
    /// One convex body on each side.
    Convex,
    /// The same if they are convex, else parts.
    AsTheyAre,
    Parts,
}

impl<'a> Sides<'a> {
    /// Of the files of a command line; `among`: which may ask about one body among many as well.
    fn of(
        meshes: &'a [PathBuf],
        from: &'a [PathBuf],
        taken: Taken,
        among: bool,
    ) -> Result<Self, Failure> {
        if let Some(list) = meshes.iter().chain(from).find(|file| is_list(file)) {
            let list = list.display();
            let obstacles =
                if among { "obstacles in such a file stand behind --among, " } else { "" };
            let message = format!("{list}: no mesh; {obstacles}`colltrans batch` takes queries");
            return Err(Failure::new(Code::Usage, message));
        }
        let files = match (meshes, from) {
            ([_, _], []) => [&meshes[..1], &meshes[1..]],
            (_, []) => return Err(Failure::new(Code::Usage, not_two(meshes, among))),
            (moving, fixed) => [moving, fixed],
        };
        Ok(Self { files, taken })
    }
}

/// What to do with fewer or more meshes than two.
fn not_two(meshes: &[PathBuf], among: bool) -> String {
    if meshes.len() < 2 {
        let or_among = if among { ", or --among" } else { "" };
        return format!("give the mesh that moves and the one that stays, or --from{or_among}");
    }
    let [first, rest] = [&meshes[..1], &meshes[1..]].map(|files| {
        files.iter().map(|file| file.display().to_string()).collect::<Vec<_>>().join(" ")
    });
    let count = meshes.len();
    let as_one = format!("`{first} --from {rest}` asks about all of the others as one body");
    if among {
        let one = format!("`{first} --among {rest}` asks about one body among many");
        return format!("{count} meshes, not two: {one}, {as_one}");
    }
    format!("{count} meshes, not two: {as_one}")
}

/// The one mesh before --among.
fn one(meshes: &[PathBuf]) -> Result<&PathBuf, Failure> {
    match meshes {
        [one] => Ok(one),
        _ => Err(Failure::new(Code::Usage, "give one mesh before --among, the scene behind it")),
    }
}

impl Taken {
    /// Of a command line that asks something that only convex bodies have, or only parts; what to say of
    /// one that asks both.
    fn of(asks: [bool; 2], clash: &str) -> Result<Self, Failure> {
        Ok(match asks {
            [false, false] => Self::AsTheyAre,
            [false, true] => Self::Parts,
            [true, false] => Self::Convex,
            [true, true] => return Err(Failure::new(Code::Usage, clash)),
        })
    }
}

impl ClearanceArguments {
    /// Who moves, who stays, and as what.
    pub(crate) fn sides(&self) -> Result<Sides<'_>, Failure> {
        Sides::of(&self.meshes, &self.from, self.taken()?, true)
    }

    /// As what meshes are taken.
    pub(crate) fn taken(&self) -> Result<Taken, Failure> {
        let asks_parts = self.tolerance.is_some()
            || self.ignore_start_overlaps
            || self.open
            || !self.from.is_empty();
        let clash = "--solver, --graze-tolerance, --convex-tolerance and --hull are for two convex \
             meshes; --from, --tolerance, --ignore-start-overlaps and --open for parts";
        Taken::of([self.pair.asks_convex(), asks_parts], clash)
    }

    /// The one mesh before --among.
    pub(crate) fn one(&self) -> Result<&PathBuf, Failure> {
        one(&self.meshes)
    }

    /// How the files of the moving and of the fixed body are read as parts.
    pub(crate) fn part_options(&self) -> [BodyOptions; 2] {
        self.pair.body.part_options(&self.pair.places, self.open)
    }
}

/// Along which direction, or which ones.
#[derive(Debug, Args)]
pub(crate) struct DirectionArguments {
    /// Where to: three numbers, not all zero, or an axis: x, -x, y, -y, z, -z
    ///
    /// The answer is in multiples of this vector: a length, in the unit of the meshes, if it has
    /// length 1, as the axes have.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = direction, required_unless_present = "directions")]
    pub(crate) direction: Option<DVec3>,
    /// Many directions: a file with one a line, `-` for standard input; one answer a line
    ///
    /// Written as for --direction; blank lines and what follows a `#` mean nothing. All answers are
    /// given even if some directions have none (exit code 1).
    #[arg(long, value_name = "FILE", conflicts_with_all = ["direction", "picture"])]
    pub(crate) directions: Option<PathBuf>,
}

/// Where the bodies are.
#[derive(Debug, Args)]
#[command(next_help_heading = "Where the meshes are")]
pub(crate) struct PlaceArguments {
    /// Where the moving mesh starts: x,y,z or x,y,z,qx,qy,qz,qw
    ///
    /// A translation, in the unit of the meshes, and a rotation before it, as a quaternion of
    /// length 1; one of few digits is normalised, which is said. A quarter turn about z, then
    /// one unit up: 0,0,1,0,0,0.7071067811865476,0.7071067811865476
    #[arg(long, value_name = "POSE", allow_hyphen_values = true, value_parser = place, default_value = "0,0,0")]
    pub(crate) moving_pose: Place,
    /// Where the fixed mesh is, written like --moving-pose
    #[arg(long, value_name = "POSE", allow_hyphen_values = true, value_parser = place, default_value = "0,0,0")]
    pub(crate) fixed_pose: Place,
    /// The rotation of the moving mesh as angles in degrees, instead of a quaternion
    ///
    /// About the world's x axis, then about y, then about z (as in URDF files), about the mesh's
    /// own origin, before the translation. Multiples of 90 are exact.
    #[arg(long, value_name = "ROLL,PITCH,YAW", allow_hyphen_values = true, value_parser = angles)]
    pub(crate) moving_rpy: Option<Angles>,
    /// The rotation of the fixed mesh, written like --moving-rpy
    #[arg(long, value_name = "ROLL,PITCH,YAW", allow_hyphen_values = true, value_parser = angles)]
    pub(crate) fixed_rpy: Option<Angles>,
    /// Multiply the moving mesh by this before it is placed: 0.001 makes metres of millimetres
    #[arg(long, value_name = "FACTOR", allow_hyphen_values = true, value_parser = factor, default_value = "1")]
    pub(crate) moving_scale: f64,
    /// Multiply the fixed mesh by this before it is placed
    #[arg(long, value_name = "FACTOR", allow_hyphen_values = true, value_parser = factor, default_value = "1")]
    pub(crate) fixed_scale: f64,
}

impl PlaceArguments {
    /// The poses of the moving and of the fixed mesh.
    pub(crate) fn poses(&self) -> Result<[Pose; 2], Failure> {
        let usage = |message| Failure::new(Code::Usage, message);
        let moving = self.moving_pose.pose(self.moving_rpy, "--moving").map_err(usage)?;
        let fixed = self.fixed_pose.pose(self.fixed_rpy, "--fixed").map_err(usage)?;
        Ok([moving, fixed])
    }

    /// What was changed about them.
    pub(crate) fn notes(&self) -> [Option<String>; 2] {
        [self.moving_pose.note("--moving-pose"), self.fixed_pose.note("--fixed-pose")]
    }
}

/// Whose convex hull is to be taken.
#[derive(Debug, Clone, Copy, Args)]
#[command(next_help_heading = UNCLEAN)]
pub(crate) struct HullArguments {
    /// Take the convex hull of the vertices that faces use, of both meshes
    ///
    /// By how much a hull exceeds its part is said with the answer. `separated` is then a proof for
    /// the parts too; a contact of hulls is only a bound: the parts meet no earlier.
    #[arg(long)]
    hull: bool,
    /// Take the convex hull of the moving mesh only
    #[arg(long)]
    hull_moving: bool,
    /// Take the convex hull of the fixed mesh only
    #[arg(long)]
    hull_fixed: bool,
}

/// What is tolerated of meshes.
#[derive(Debug, Clone, Copy, Args)]
#[command(next_help_heading = UNCLEAN)]
pub(crate) struct BodyArguments {
    /// How deep a face may lie below the convex hull, in the unit of the file [default: 1e-5 of
    /// the mesh's extent]
    ///
    /// Files round coordinates: STL to single precision (about 6e-8 of the largest coordinate), OBJ
    /// often to six digits. That alone makes faces of convex parts slightly concave. Whatever
    /// is tolerated, the body is the convex hull.
    #[arg(long, value_name = "L", allow_hyphen_values = true, value_parser = length)]
    convex_tolerance: Option<f64>,
    /// How far apart vertices on open edges may be to be merged, in the unit of the file [default:
    /// a few roundings of the largest coordinate]
    ///
    /// The default is 2.4e-7 of the largest coordinate for binary STL and PLY with float
    /// coordinates, else 3.6e-15 of it. 0 merges equal ones only. What was merged is said. A closed
    /// surface is left as it is.
    #[arg(long, value_name = "L", allow_hyphen_values = true, value_parser = length)]
    merge_tolerance: Option<f64>,
}

impl BodyArguments {
    /// How a mesh becomes a body, but for whether its hull is taken.
    pub(crate) fn options(self, scale: f64) -> BodyOptions {
        let Self { convex_tolerance, merge_tolerance } = self;
        BodyOptions::default()
            .with_scale(scale)
            .with_convex_tolerance(convex_tolerance)
            .with_merge_tolerance(merge_tolerance)
    }

    /// Returns the options with which both bodies are read as parts.
    fn part_options(self, places: &PlaceArguments, open: bool) -> [BodyOptions; 2] {
        [places.moving_scale, places.fixed_scale].map(|scale| self.options(scale).with_open(open))
    }
}

impl PairArguments {
    /// How the solver narrows the search.
    pub(crate) fn narrowing(&self) -> Result<cta::Options, Failure> {
        let NarrowingArguments { start, until } = self.narrowing;
        if self.solver != Solver::Cta && (start.is_some() || until.is_some()) {
            return Err(Failure::new(Code::Usage, "--start and --until are of --solver cta"));
        }
        Ok(cta::Options::new(start.unwrap_or_default(), until.unwrap_or_default()))
    }

    /// Whether something is asked that only convex bodies have.
    fn asks_convex(&self) -> bool {
        self.hulls.asks_convex(self.body)
            || self.solver != Solver::Auto
            || self.narrowing.start.is_some()
            || self.narrowing.until.is_some()
            || self.graze_tolerance != 0.0
    }

    /// How the mesh files become convex bodies.
    pub(crate) fn body_options(&self) -> [BodyOptions; 2] {
        self.hulls.body_options(self.body, &self.places)
    }
}

impl HullArguments {
    /// Whether something is said that only convex bodies have.
    const fn asks_convex(self, body: BodyArguments) -> bool {
        self.hull || self.hull_moving || self.hull_fixed || body.convex_tolerance.is_some()
    }

    /// How the mesh files become convex bodies.
    fn body_options(self, body: BodyArguments, places: &PlaceArguments) -> [BodyOptions; 2] {
        let Self { hull, hull_moving, hull_fixed } = self;
        let one = |hull, scale| body.options(scale).with_hull(hull);
        [one(hull || hull_moving, places.moving_scale), one(hull || hull_fixed, places.fixed_scale)]
    }
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
    /// How much memory bodies may take that are kept for when they occur again
    ///
    /// Those used last are kept, and never fewer than two. A body of n vertices takes about 250 n
    /// bytes. Units: kB, MB, GB, KiB, MiB, GiB; 0 keeps the last two. Lines and results that wait for
    /// each other take up to 64 MiB more.
    #[arg(long, value_name = "BYTES", value_parser = bytes, default_value = "256MiB")]
    pub(crate) cache_bytes: usize,
    /// Take the convex hull of the vertices that faces use, of every mesh
    #[arg(long)]
    pub(crate) hull: bool,
    #[command(flatten)]
    pub(crate) body: BodyArguments,
}

#[derive(Debug, Args)]
pub(crate) struct ReplayArguments {
    /// The saved query
    #[arg(value_name = "CASE.json")]
    pub(crate) case: PathBuf,
    /// Answer as JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct VerifyArguments {
    /// The saved proof
    #[arg(value_name = "PROOF.json")]
    pub(crate) proof: PathBuf,
    /// Answer as JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct SetupArguments {
    /// Where to: files go to share/man/man1 and the like below [default: ~/.local]
    #[arg(long, value_name = "FOLDER")]
    pub(crate) prefix: Option<PathBuf>,
    /// Write nothing, print the completions for one shell
    #[arg(long, value_name = "SHELL", conflicts_with = "prefix")]
    pub(crate) print: Option<clap_complete::Shell>,
}

#[derive(Debug, Args)]
pub(crate) struct InfoArguments {
    /// The mesh files
    #[arg(required = true, value_name = "MESH")]
    pub(crate) meshes: Vec<PathBuf>,
    /// How deep a face may lie below the convex hull [default: 1e-5 of the mesh's extent]
    #[arg(long, value_name = "L", allow_hyphen_values = true, value_parser = length)]
    pub(crate) convex_tolerance: Option<f64>,
    /// How far apart vertices on open edges may be to be merged [default: a few roundings of the
    /// largest coordinate]
    #[arg(long, value_name = "L", allow_hyphen_values = true, value_parser = length)]
    pub(crate) merge_tolerance: Option<f64>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_is_consistent() {
        <Arguments as clap::CommandFactory>::command().debug_assert();
    }

    #[test]
    fn bodies_that_are_kept_have_a_bound() {
        let asked = Arguments::parse_from(["colltrans", "batch", "-"]).command;
        let Command::Batch(batch) = asked else { panic!("batch") };
        assert_eq!(batch.cache_bytes, 256 << 20);
    }
}
