//! The command line: one type of arguments for each subcommand.
//!
//! The first sentence of a field is its help. [`layout`] arranges the help of a subcommand, [`help`] has the texts below
//! its options, [`groups`] the overview of all subcommands.

use std::num::NonZeroUsize;
use std::path::PathBuf;

mod assembly;
mod directions;
mod groups;
mod help;
mod layout;
mod motion;
mod path;
mod placed;
mod values;

use clap::{Args, Parser, Subcommand};
use colltrans::glam::DVec3;
use colltrans::{Pose, Solver, cta};
use colltrans_mesh::body::BodyOptions;

use crate::failure::{Code, Failure};
use crate::inputs::is_obstacle_list;
pub(crate) use assembly::{
    AssemblyArguments, AuditArguments, ConstraintArguments, InputArguments, RoleArguments,
};
pub(crate) use directions::DirectionsArguments;
use help::{
    ASSEMBLY_NOTES, AUDIT_NOTES, BATCH_FORMAT, CAST_NOTES, CLEARANCE_NOTES, DEPTH_NOTES,
    DIRECTIONS_NOTES, DISTANCE_NOTES, INFO_NOTES, MOTION_NOTES, PATH_NOTES, REPLAY_NOTES, SEE_ALL,
    SETUP_NOTES, VERIFY_NOTES, WITHIN_NOTES, fit_to_terminal,
};
pub(crate) use help::{files_topic, json_topic};
pub(crate) use layout::compact_command;
pub(crate) use motion::MotionArguments;
pub(crate) use path::PathArguments;
pub(crate) use placed::{DepthArguments, PlacedArguments, WithinArguments};
pub(crate) use values::{Angles, Place, direction, normalised_pose_note, normalised_poses_note};
use values::{
    angles, answer_field, bytes, cuts, factor, length, output_file, picture, place, solver, start,
    threads,
};

/// How far can one body move before it touches another?
///
/// `colltrans info MESH` describes a mesh. Distance of two bodies: `colltrans distance A B`. Free travel of a
/// part with holes: `colltrans clearance MOVING --from FIXED --direction -z`. First contact of convex
/// bodies: `colltrans cast MOVING FIXED --direction -z`. Bounds in answers are proven.
#[derive(Debug, Parser)]
#[command(name = "colltrans", version, max_term_width = help::MAX_WIDTH, help_template = groups::template(&Command::augment_subcommands(clap::Command::new("colltrans"))))]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Describe a mesh file: is it closed, convex, how large?
    #[command(after_help = fit_to_terminal(&[SEE_ALL]), after_long_help = fit_to_terminal(&[INFO_NOTES]))]
    Info(InfoArguments),
    /// Compute the distance of two meshes, and their nearest points
    ///
    /// The bounds are proven: the true distance lies between them. Two convex meshes are convex bodies, all
    /// others closed parts with their holes and cavities.
    #[command(visible_alias = "dist", after_help = fit_to_terminal(&[SEE_ALL]), after_long_help = fit_to_terminal(&[DISTANCE_NOTES]))]
    Distance(Box<PlacedArguments>),
    /// Check whether two meshes are closer than a length
    ///
    /// Faster than the distance, because the search ends as soon as the comparison is proven.
    #[command(after_help = fit_to_terminal(&[SEE_ALL]), after_long_help = fit_to_terminal(&[WITHIN_NOTES]))]
    Within(Box<WithinArguments>),
    /// Compute the shortest translation that separates two overlapping meshes
    ///
    /// The penetration depth over all directions, with proven bounds, for convex bodies. For parts that are not convex the answer is
    /// the least tolerance at which they would not overlap.
    #[command(after_help = fit_to_terminal(&[SEE_ALL]), after_long_help = fit_to_terminal(&[DEPTH_NOTES]))]
    Depth(Box<DepthArguments>),
    /// List the pairs of parts of an assembly that interfere or are too near
    ///
    /// Every pair that is neither ignored nor glued is examined. The bounds of distances, depths and volumes are
    /// proven. Exit code 1 if a pair interferes or is nearer than its clearance, 0 if none is.
    #[command(visible_alias = "clash", after_help = fit_to_terminal(&[SEE_ALL]), after_long_help = fit_to_terminal(&[AUDIT_NOTES]))]
    Audit(Box<AuditArguments>),
    /// Compute how far a mesh can move before another blocks it
    ///
    /// Two convex meshes are convex bodies. Meshes that are not convex, several meshes on one side, and
    /// everything with --from are parts: closed surfaces with their holes and cavities. Several files on one
    /// side are one body. Contacts behind the body do not block it.
    #[command(visible_alias = "clear", after_help = fit_to_terminal(&[SEE_ALL]), after_long_help = fit_to_terminal(&[CLEARANCE_NOTES]))]
    Clearance(Box<ClearanceArguments>),
    /// Compute the translation along a direction at which two convex meshes first touch
    ///
    /// The translation is negative if the bodies overlap now, or if the contact lies behind.
    #[command(after_help = fit_to_terminal(&[SEE_ALL]), after_long_help = fit_to_terminal(&[CAST_NOTES]))]
    Cast(Box<CastArguments>),
    /// Compute when a mesh that turns, unscrews, swings or is thrown first touches another
    ///
    /// The time is 0 at the start and 1 at the end of the motion. Its bounds are proven for the whole motion,
    /// not for samples. Both sides may move. If all meshes are convex, they are convex bodies, otherwise parts,
    /// as for `clearance`.
    #[command(after_help = fit_to_terminal(&[SEE_ALL]), after_long_help = fit_to_terminal(&[MOTION_NOTES]), mut_arg("hull", |hull| hull.hide_short_help(true)))]
    Motion(Box<MotionArguments>),
    /// Compute which links of a robot first touch each other or a scene on a path
    ///
    /// The bounds of the time are proven for the whole path, not for samples. The robot is a URDF, SDF or MJCF file. A row
    /// of the path has one value for each joint, in radians or metres.
    #[command(after_help = fit_to_terminal(&[SEE_ALL]), after_long_help = fit_to_terminal(&[PATH_NOTES]))]
    Path(Box<PathArguments>),
    /// Compute all directions along which a mesh can leave another, with a proof
    ///
    /// The answer is the whole set: regions of directions with their borders, arcs and isolated directions. All
    /// others are blocked, or undecided where the limits end the work. Meshes are parts, as for `clearance --from`.
    #[command(visible_alias = "free", after_help = fit_to_terminal(&[SEE_ALL]), after_long_help = fit_to_terminal(&[DIRECTIONS_NOTES]))]
    Directions(Box<DirectionsArguments>),
    /// Plan in which order and directions the parts of an assembly come out
    ///
    /// Parts are solids of any shape. The answer also names the parts that hold interlocked ones. Without --direction, candidate directions are computed: contact normals
    /// and directions orthogonal to them, cylinder axes, the world's axes.
    #[command(after_help = fit_to_terminal(&[SEE_ALL]), after_long_help = fit_to_terminal(&[ASSEMBLY_NOTES]))]
    Assembly(Box<AssemblyArguments>),
    /// Answer every query of a file with one JSON object per line
    #[command(after_help = fit_to_terminal(&[SEE_ALL]), after_long_help = fit_to_terminal(&[BATCH_FORMAT]))]
    Batch(BatchArguments),
    /// Check a proof that --save-proof has written, without a search
    ///
    /// Prints the proven statement about the bodies in the file in one line. Exit code 6 if the proof does not hold. Of
    /// several files, each line begins with the name of the file.
    #[command(after_help = fit_to_terminal(&[SEE_ALL]), after_long_help = fit_to_terminal(&[VERIFY_NOTES]))]
    Verify(VerifyArguments),
    /// Answer a saved query again
    ///
    /// A query that does not converge is saved as colltrans-case-1.json, with all bits of its numbers.
    #[command(after_help = fit_to_terminal(&[SEE_ALL]), after_long_help = fit_to_terminal(&[REPLAY_NOTES]))]
    Replay(ReplayArguments),
    /// Install shell completions and man pages
    ///
    /// Completions for bash, zsh and fish go to the folders below a prefix in which these shells search. zsh may
    /// need the folder in its path (`fpath+=~/.local/share/zsh/site-functions`). Prints the name of each file.
    #[command(after_help = fit_to_terminal(&[SEE_ALL]), after_long_help = fit_to_terminal(&[SETUP_NOTES]))]
    Setup(SetupArguments),
    /// Print the file formats, units, poses, body options and exit codes
    #[command(after_long_help = files_topic())]
    Files,
    /// Print the fields of answers in JSON
    #[command(after_long_help = json_topic())]
    Json,
}

#[derive(Debug, Args)]
pub(crate) struct CastArguments {
    /// The moving mesh
    pub(crate) moving: PathBuf,
    /// The fixed mesh
    pub(crate) fixed: PathBuf,
    #[command(flatten)]
    pub(crate) pair: PairArguments,
}

#[derive(Debug, Args)]
pub(crate) struct ClearanceArguments {
    /// The moving mesh and the fixed one; with --from all moving ones, as one body
    #[arg(required = true, value_name = "MESH")]
    meshes: Vec<PathBuf>,
    /// The fixed meshes, as one body: parts that need not be convex
    #[arg(long, num_args = 1.., value_name = "FIXED")]
    from: Vec<PathBuf>,
    /// The scene: meshes and files of obstacles (.jsonl); finds the first obstacle in the way
    #[arg(long, num_args = 1.., value_name = "SCENE", conflicts_with_all = ["from", "picture", "fixed_pose", "fixed_rpy", "fixed_scale"])]
    pub(crate) scene: Vec<PathBuf>,
    /// Parts: permitted overlap, in the unit of the meshes [default: from the precision of the files]
    #[arg(long, value_name = "L", allow_hyphen_values = true, value_parser = length)]
    pub(crate) tolerance: Option<f64>,
    /// Parts: ignore overlaps at the start, and list them; later contacts still block
    #[arg(long)]
    pub(crate) ignore_start_overlaps: bool,
    /// Accept surfaces that are not closed: they block from both sides and have no interior
    #[arg(long, help_heading = BODY_HEADING, hide_short_help = true)]
    open: bool,
    #[command(flatten)]
    pub(crate) pair: PairArguments,
}

/// Options of the solver `cta`.
#[derive(Debug, Args)]
pub(crate) struct NarrowingArguments {
    /// With --solver cta: where the minimisation starts [default: center]
    #[arg(long, value_name = "WHERE", value_parser = start(), hide_short_help = true)]
    start: Option<cta::Start>,
    /// With --solver cta: ends at the paper's `exit` test, or when the bounds differ by at most this share of
    /// the bodies' extent [default: exit]
    #[arg(long, value_name = "exit|SHARE", hide_short_help = true)]
    until: Option<cta::Until>,
    /// With --solver cta: the value of `phi` at which the region of levels is cut [default: shifted]
    #[arg(long, value_name = "WHERE", value_parser = cuts(), hide_short_help = true)]
    cuts: Option<cta::Cuts>,
    /// With --solver cta: shifts continue into neighbouring cells, which takes fewer planar problems
    #[arg(long, hide_short_help = true)]
    across_cells: bool,
    /// With --solver cta: each planar problem is searched without a hint, as in the paper
    #[arg(long, hide_short_help = true)]
    cold: bool,
}

/// Options of queries along a direction, and their outputs.
#[derive(Debug, Args)]
pub(crate) struct PairArguments {
    #[command(flatten)]
    pub(crate) directions: DirectionArguments,
    /// The minimum gap: the bodies count as touching at this distance, in the unit of the meshes
    #[arg(long, value_name = "GAP", allow_hyphen_values = true, value_parser = length, default_value = "0")]
    pub(crate) min_gap: f64,
    /// Print the answer as one JSON object
    #[arg(long)]
    pub(crate) json: bool,
    /// Draw both bodies and the contact as an SVG picture
    #[arg(long, value_name = "OUT.svg", value_parser = picture)]
    pub(crate) picture: Option<PathBuf>,
    /// Write the proof and the bodies as a file for `colltrans verify`
    #[arg(long, value_name = "OUT.json", value_parser = output_file, conflicts_with = "directions")]
    pub(crate) save_proof: Option<PathBuf>,
    /// Convex bodies: a sideways overlap up to this length counts as sliding, not as contact; 0 stands
    /// for the rounding error
    #[arg(long, value_name = "L", allow_hyphen_values = true, value_parser = length, default_value = "0", hide_short_help = true)]
    pub(crate) graze_tolerance: f64,
    /// Convex bodies: the algorithm; same answer (cta: Mirolo, Carpin, Pagello 2007)
    #[arg(long, value_parser = solver(), default_value_t = Solver::Auto, hide_short_help = true)]
    pub(crate) solver: Solver,
    #[command(flatten)]
    narrowing: NarrowingArguments,
    #[command(flatten)]
    pub(crate) places: PlaceArguments,
    #[command(flatten)]
    pub(crate) hulls: HullArguments,
    #[command(flatten)]
    pub(crate) body: BodyArguments,
}

const BODY_HEADING: &str = "How meshes become bodies (`colltrans help files`)";

/// The files of the moving and of the fixed body, and the kind of bodies that they become.
pub(crate) struct InputPair<'a> {
    pub(crate) files: [&'a [PathBuf]; 2],
    pub(crate) mode: BodyMode,
}

/// The kind of bodies that mesh files become.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum BodyMode {
    /// One convex body on each side. Other meshes are rejected.
    Convex,
    /// Convex bodies if all meshes are convex, otherwise parts.
    Automatic,
    /// Parts, even if they are convex.
    Parts,
}

impl<'a> InputPair<'a> {
    /// Returns the files of a command line. `has_scene` states whether the command also has `--scene`, which the
    /// messages then suggest.
    ///
    /// # Errors
    /// A file of obstacles is given in place of a mesh, or there is no `--from` and another number of meshes than two.
    fn from_arguments(
        meshes: &'a [PathBuf],
        from: &'a [PathBuf],
        mode: BodyMode,
        has_scene: bool,
    ) -> Result<Self, Failure> {
        if let Some(list) = meshes.iter().chain(from).find(|file| is_obstacle_list(file)) {
            let list = list.display();
            let obstacles = if has_scene { "give files of obstacles to --scene, " } else { "" };
            let message = format!(
                "{list} is not a mesh; {obstacles}run `colltrans batch` for files of queries"
            );
            return Err(Failure::new(Code::Usage, message));
        }
        let files = match (meshes, from) {
            ([_, _], []) => [&meshes[..1], &meshes[1..]],
            (_, []) => {
                return Err(Failure::new(Code::Usage, mesh_count_message(meshes, has_scene)));
            }
            (moving, fixed) => [moving, fixed],
        };
        Ok(Self { files, mode })
    }
}

/// Returns the error message for a number of meshes other than two.
fn mesh_count_message(meshes: &[PathBuf], has_scene: bool) -> String {
    if meshes.len() < 2 {
        let or_scene = if has_scene { " or a scene with --scene" } else { "" };
        return format!("one mesh given; add the fixed mesh, fixed meshes with --from{or_scene}");
    }
    let [first, others] = [&meshes[..1], &meshes[1..]].map(|files| {
        files.iter().map(|file| file.display().to_string()).collect::<Vec<_>>().join(" ")
    });
    let count = meshes.len();
    let as_one_body = format!("`{first} --from {others}` takes the others as one body");
    if has_scene {
        let as_scene = format!("`{first} --scene {others}` takes them as a scene");
        return format!("{count} meshes given, expected two; {as_scene}, {as_one_body}");
    }
    format!("{count} meshes given, expected two; {as_one_body}")
}

/// Returns the moving mesh of a query with a scene.
///
/// # Errors
/// There are several meshes before `--scene`.
fn single_mesh(meshes: &[PathBuf]) -> Result<&PathBuf, Failure> {
    match meshes {
        [mesh] => Ok(mesh),
        _ => Err(Failure::new(
            Code::Usage,
            "give one mesh before --scene, and the files of the scene after it",
        )),
    }
}

impl BodyMode {
    /// Returns the mode for options that require convex bodies (0) or parts (1). `clash` is the message if both do.
    fn from_requirements(requires: [bool; 2], clash: &str) -> Result<Self, Failure> {
        Ok(match requires {
            [false, false] => Self::Automatic,
            [false, true] => Self::Parts,
            [true, false] => Self::Convex,
            [true, true] => return Err(Failure::new(Code::Usage, clash)),
        })
    }
}

impl ClearanceArguments {
    /// Returns the files of both bodies.
    pub(crate) fn input_pair(&self) -> Result<InputPair<'_>, Failure> {
        InputPair::from_arguments(&self.meshes, &self.from, self.body_mode()?, true)
    }

    /// Returns the kind of bodies that the options require.
    pub(crate) fn body_mode(&self) -> Result<BodyMode, Failure> {
        let requires_parts = self.tolerance.is_some()
            || self.ignore_start_overlaps
            || self.open
            || !self.from.is_empty();
        let clash = "--solver, --graze-tolerance, --convex-tolerance and --hull require two convex meshes; --from, \
             --tolerance, --ignore-start-overlaps and --open require parts; drop one of the two groups";
        BodyMode::from_requirements([self.pair.requires_convex(), requires_parts], clash)
    }

    /// Returns the moving mesh of a query with a scene.
    pub(crate) fn moving_mesh(&self) -> Result<&PathBuf, Failure> {
        single_mesh(&self.meshes)
    }

    /// Returns how the moving and the fixed files are read as parts.
    pub(crate) fn part_options(&self) -> [BodyOptions; 2] {
        self.pair.body.part_options(&self.pair.places, self.open)
    }
}

/// One direction, or a file of directions.
#[derive(Debug, Args)]
pub(crate) struct DirectionArguments {
    /// The direction: three numbers, or an axis x, -x, y, -y, z, -z; answers are multiples of it
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = direction, required_unless_present = "directions")]
    pub(crate) direction: Option<DVec3>,
    /// A file with one direction per line, `-` for standard input; prints one answer per line
    #[arg(long, value_name = "FILE", conflicts_with_all = ["direction", "picture"])]
    pub(crate) directions: Option<PathBuf>,
}

/// Poses and scales of the two meshes.
#[derive(Debug, Args)]
#[command(next_help_heading = "Poses and scales")]
pub(crate) struct PlaceArguments {
    /// Start of the moving mesh: x,y,z or x,y,z,qx,qy,qz,qw
    #[arg(long, value_name = "POSE", allow_hyphen_values = true, value_parser = place, default_value = "0,0,0", hide_default_value = true)]
    pub(crate) moving_pose: Place,
    /// Pose of the fixed mesh
    #[arg(long, value_name = "POSE", allow_hyphen_values = true, value_parser = place, default_value = "0,0,0", hide_default_value = true)]
    pub(crate) fixed_pose: Place,
    /// Rotation of the moving mesh in degrees, instead of a quaternion
    #[arg(long, value_name = "ROLL,PITCH,YAW", allow_hyphen_values = true, value_parser = angles)]
    pub(crate) moving_rpy: Option<Angles>,
    /// Rotation of the fixed mesh in degrees
    #[arg(long, value_name = "ROLL,PITCH,YAW", allow_hyphen_values = true, value_parser = angles, hide_short_help = true)]
    pub(crate) fixed_rpy: Option<Angles>,
    /// Factor of the moving mesh, 0.001 for mm to m
    #[arg(long, value_name = "FACTOR", allow_hyphen_values = true, value_parser = factor, default_value = "1", hide_short_help = true)]
    pub(crate) moving_scale: f64,
    /// Factor of the fixed mesh
    #[arg(long, value_name = "FACTOR", allow_hyphen_values = true, value_parser = factor, default_value = "1", hide_short_help = true)]
    pub(crate) fixed_scale: f64,
}

impl PlaceArguments {
    /// Returns the poses of the moving and of the fixed mesh.
    ///
    /// # Errors
    /// A pose has a rotation both as a quaternion and as angles.
    pub(crate) fn poses(&self) -> Result<[Pose; 2], Failure> {
        let usage = |message| Failure::new(Code::Usage, message);
        let moving = self.moving_pose.pose(self.moving_rpy, "--moving").map_err(usage)?;
        let fixed = self.fixed_pose.pose(self.fixed_rpy, "--fixed").map_err(usage)?;
        Ok([moving, fixed])
    }

    /// Returns a note for each of the two quaternions that was normalised.
    pub(crate) fn notes(&self) -> [Option<String>; 2] {
        [self.moving_pose.note("--moving-pose"), self.fixed_pose.note("--fixed-pose")]
    }
}

/// Meshes that are replaced by their convex hulls.
#[derive(Debug, Clone, Copy, Args)]
#[command(next_help_heading = BODY_HEADING)]
pub(crate) struct HullArguments {
    /// Replace both meshes by convex hulls; the answer states the difference
    #[arg(long)]
    hull: bool,
    /// Replace the moving mesh by its convex hull
    #[arg(long, hide_short_help = true)]
    hull_moving: bool,
    /// Replace the fixed mesh by its convex hull
    #[arg(long, hide_short_help = true)]
    hull_fixed: bool,
}

/// Tolerances with which meshes are read.
#[derive(Debug, Clone, Copy, Args)]
#[command(next_help_heading = BODY_HEADING)]
pub(crate) struct BodyArguments {
    /// Depth of a dent that counts as convex [default: 1e-5 of the extent]
    #[arg(long, value_name = "L", allow_hyphen_values = true, value_parser = length, hide_short_help = true)]
    convex_tolerance: Option<f64>,
    /// Distance of vertices at open edges to merge [default: rounding]
    #[arg(long, value_name = "L", allow_hyphen_values = true, value_parser = length, hide_short_help = true)]
    merge_tolerance: Option<f64>,
}

impl BodyArguments {
    /// Returns the options with which a mesh becomes a body. They do not replace it by its hull.
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

impl NarrowingArguments {
    /// Checks whether an option is given.
    fn is_given(&self) -> bool {
        self.start.is_some()
            || self.until.is_some()
            || self.cuts.is_some()
            || self.across_cells
            || self.cold
    }
}

impl PairArguments {
    /// Returns the options of the solver `cta`.
    ///
    /// # Errors
    /// One of them is given, and the solver is not `cta`.
    pub(crate) fn narrowing(&self) -> Result<cta::Options, Failure> {
        if self.solver != Solver::Cta && self.narrowing.is_given() {
            let flags = "--start, --until, --cuts, --across-cells and --cold";
            return Err(Failure::new(Code::Usage, format!("{flags} require --solver cta")));
        }
        let NarrowingArguments { start, until, cuts, across_cells, cold } = self.narrowing;
        Ok(cta::Options::new(start.unwrap_or_default(), until.unwrap_or_default())
            .with_cuts(cuts.unwrap_or_default())
            .with_keeps_to_cell(!across_cells)
            .with_starts_cold(cold))
    }

    /// Checks whether an option requires convex bodies.
    fn requires_convex(&self) -> bool {
        self.hulls.requires_convex(self.body)
            || self.solver != Solver::Auto
            || self.narrowing.is_given()
            || self.graze_tolerance != 0.0
    }

    /// Returns how the moving and the fixed file are read as convex bodies.
    pub(crate) fn body_options(&self) -> [BodyOptions; 2] {
        self.hulls.body_options(self.body, &self.places)
    }
}

impl HullArguments {
    /// Checks whether an option requires convex bodies.
    const fn requires_convex(self, body: BodyArguments) -> bool {
        self.hull || self.hull_moving || self.hull_fixed || body.convex_tolerance.is_some()
    }

    /// Returns how the moving and the fixed file are read as convex bodies.
    fn body_options(self, body: BodyArguments, places: &PlaceArguments) -> [BodyOptions; 2] {
        let Self { hull, hull_moving, hull_fixed } = self;
        let options = |hull, scale| body.options(scale).with_hull(hull);
        [
            options(hull || hull_moving, places.moving_scale),
            options(hull || hull_fixed, places.fixed_scale),
        ]
    }
}

#[derive(Debug, Args)]
pub(crate) struct BatchArguments {
    /// The queries, one JSON object per line; `-` for standard input
    pub(crate) queries: PathBuf,
    /// The file of the results [default: standard output, as for `-`]
    #[arg(short, long, value_name = "RESULTS.jsonl")]
    pub(crate) output: Option<PathBuf>,
    /// Number of threads [default: all cores]; the results are the same, byte for byte
    #[arg(long, value_name = "N", value_parser = threads)]
    pub(crate) threads: Option<NonZeroUsize>,
    /// Write only these fields of results (`colltrans help json`), besides id, outcome, and message of errors. Features
    /// and points are computed only if they are named, and the last contact only for the fields of the exit
    #[arg(long, value_name = "NAME,...", value_delimiter = ',', value_parser = answer_field(), hide_possible_values = true)]
    pub(crate) fields: Option<Vec<String>>,
    /// Replace every mesh by the convex hull of its vertices
    #[arg(long)]
    pub(crate) hull: bool,
    /// Memory for bodies that occur again, in bytes or kB, MB, GB, KiB, MiB, GiB; the two last ones are
    /// always stored. A body of n vertices takes about 250 n bytes
    #[arg(long, value_name = "BYTES", value_parser = bytes, default_value = "256MiB")]
    pub(crate) cache_bytes: usize,
    #[command(flatten)]
    pub(crate) body: BodyArguments,
}

#[derive(Debug, Args)]
pub(crate) struct ReplayArguments {
    /// The saved query
    #[arg(value_name = "CASE.json")]
    pub(crate) case: PathBuf,
    /// Print the answer as one JSON object
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct VerifyArguments {
    /// The saved proofs
    #[arg(value_name = "PROOF.json", required = true)]
    pub(crate) proofs: Vec<PathBuf>,
    /// Print the answer as one JSON object, a line for each proof
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct SetupArguments {
    /// The folder above share/man/man1 and the folders of completions [default: ~/.local]
    #[arg(long, value_name = "FOLDER")]
    pub(crate) prefix: Option<PathBuf>,
    /// Print the completions for one shell, and write no file
    #[arg(long, value_name = "SHELL", conflicts_with = "prefix")]
    pub(crate) print: Option<clap_complete::Shell>,
}

#[derive(Debug, Args)]
pub(crate) struct InfoArguments {
    /// The mesh files
    #[arg(required = true, value_name = "MESH")]
    pub(crate) meshes: Vec<PathBuf>,
    /// Depth of a dent that still counts as convex [default: 1e-5 of the mesh's extent]
    #[arg(long, value_name = "L", allow_hyphen_values = true, value_parser = length)]
    pub(crate) convex_tolerance: Option<f64>,
    /// Distance of vertices on open edges that are merged [default: rounding of the file]
    #[arg(long, value_name = "L", allow_hyphen_values = true, value_parser = length)]
    pub(crate) merge_tolerance: Option<f64>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn command_line_passes_the_checks_of_clap() {
        <Arguments as clap::CommandFactory>::command().debug_assert();
    }

    #[test]
    fn default_of_cache_bytes_is_256_mebibytes() {
        let command = Arguments::parse_from(["colltrans", "batch", "-"]).command;
        let Command::Batch(batch) = command else { panic!("batch") };
        assert_eq!(batch.cache_bytes, 256 << 20);
    }
}
