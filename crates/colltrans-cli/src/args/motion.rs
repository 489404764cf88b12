//! The command line of `colltrans motion`.

use std::path::{Path, PathBuf};

use clap::Args;
use colltrans::Pose;
use colltrans::glam::DVec3;
use colltrans::motion::{Motion, MotionError};
use colltrans_mesh::body::BodyOptions;

use super::values::{Place, normalised_poses_note, picture, place, vector};
use super::{
    BODY_HEADING, BodyArguments, BodyMode, HullArguments, InputPair, PlaceArguments, direction,
    length, output_file,
};
use crate::failure::{Code, Failure};

#[derive(Debug, Args)]
#[expect(clippy::struct_excessive_bools, reason = "each is a flag of its own")]
pub(crate) struct MotionArguments {
    /// The moving mesh and the fixed one; with --from all moving ones, together
    #[arg(required = true, value_name = "MESH")]
    meshes: Vec<PathBuf>,
    /// The fixed meshes; the answer is the first contact of any pair
    #[arg(long, num_args = 1.., value_name = "FIXED")]
    from: Vec<PathBuf>,
    #[command(flatten)]
    motion: MovingMotionArguments,
    #[command(flatten)]
    fixed_motion: FixedMotionArguments,
    /// Compute how far the mesh can go; contacts may slide and separate
    #[arg(long, conflicts_with = "save_proof", help_heading = OPTIONS)]
    pub(crate) clearance: bool,
    /// The minimum gap, at which bodies count as touching
    #[arg(long, value_name = "GAP", allow_hyphen_values = true, value_parser = length, default_value = "0", help_heading = OPTIONS)]
    pub(crate) min_gap: f64,
    /// Permitted overlap [default: 0; parts: precision of the files]
    #[arg(long, value_name = "L", allow_hyphen_values = true, value_parser = length, help_heading = OPTIONS)]
    pub(crate) tolerance: Option<f64>,
    /// Take meshes as parts, ignore overlaps at the start, and list them
    #[arg(long, hide_short_help = true, help_heading = OPTIONS)]
    pub(crate) ignore_start_overlaps: bool,
    /// Print the answer as one JSON object
    #[arg(long, help_heading = OPTIONS)]
    pub(crate) json: bool,
    /// Draw the mesh at the start, the contact and the end, as SVG
    #[arg(long, value_name = "OUT.svg", value_parser = picture, help_heading = OPTIONS)]
    pub(crate) picture: Option<PathBuf>,
    /// Write the proof and the bodies as a file for `colltrans verify`
    #[arg(long, value_name = "OUT.json", value_parser = output_file, help_heading = OPTIONS)]
    pub(crate) save_proof: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) places: PlaceArguments,
    /// Accept surfaces that are not closed, without an interior
    #[arg(long, help_heading = BODY_HEADING, hide_short_help = true)]
    open: bool,
    #[command(flatten)]
    hulls: HullArguments,
    #[command(flatten)]
    body: BodyArguments,
}

const OPTIONS: &str = "Query and outputs";

/// The motion of the moving mesh. Angles are in degrees.
#[derive(Debug, Args)]
#[group(required = false, multiple = false)]
#[command(next_help_heading = "Motion of the moving mesh, one of these (angles in degrees)")]
struct MovingMotionArguments {
    /// Turn about the axis through the point, counter-clockwise as seen against the axis
    #[arg(long, num_args = 3, action = clap::ArgAction::Set, value_names = ["POINT", "AXIS", "ANGLE"], allow_hyphen_values = true)]
    turn: Option<Vec<String>>,
    /// Turn, and move along the axis by RISE
    #[arg(long, num_args = 4, action = clap::ArgAction::Set, value_names = ["POINT", "AXIS", "ANGLE", "RISE"], allow_hyphen_values = true)]
    screw: Option<Vec<String>>,
    /// Translate
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = vector)]
    slide: Option<DVec3>,
    /// Move the point CENTER of the mesh by WAY, and turn about it by the rotation vector SPIN
    #[arg(long, num_args = 3, action = clap::ArgAction::Set, value_names = ["CENTER", "WAY", "SPIN"], allow_hyphen_values = true)]
    thrown: Option<Vec<String>>,
    /// The screw to this pose, by the shorter turn
    #[arg(long, value_name = "POSE", allow_hyphen_values = true, value_parser = place)]
    to: Option<Place>,
    /// Screws from pose to pose in equal times: JSON, [[x,y,z,qx,qy,qz,qw], ...]
    #[arg(long, value_name = "POSES.json", conflicts_with_all = ["moving_pose", "moving_rpy"])]
    through: Option<PathBuf>,
}

/// The motion of the fixed mesh, if it moves as well.
#[derive(Debug, Args)]
#[group(required = false, multiple = false)]
#[command(next_help_heading = "Motion of the fixed mesh in the same time, if it moves as well")]
struct FixedMotionArguments {
    /// As --turn
    #[arg(id = "fixed_turn", long = "fixed-turn", num_args = 3, action = clap::ArgAction::Set, value_names = ["POINT", "AXIS", "ANGLE"], allow_hyphen_values = true, hide_short_help = true)]
    turn: Option<Vec<String>>,
    /// As --screw
    #[arg(id = "fixed_screw", long = "fixed-screw", num_args = 4, action = clap::ArgAction::Set, value_names = ["POINT", "AXIS", "ANGLE", "RISE"], allow_hyphen_values = true, hide_short_help = true)]
    screw: Option<Vec<String>>,
    /// As --slide
    #[arg(id = "fixed_slide", long = "fixed-slide", value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = vector, hide_short_help = true)]
    slide: Option<DVec3>,
    /// As --thrown
    #[arg(id = "fixed_thrown", long = "fixed-thrown", num_args = 3, action = clap::ArgAction::Set, value_names = ["CENTER", "WAY", "SPIN"], allow_hyphen_values = true, hide_short_help = true)]
    thrown: Option<Vec<String>>,
    /// As --to
    #[arg(id = "fixed_to", long = "fixed-to", value_name = "POSE", allow_hyphen_values = true, value_parser = place, hide_short_help = true)]
    to: Option<Place>,
    /// As --through
    #[arg(id = "fixed_through", long = "fixed-through", value_name = "POSES.json", conflicts_with_all = ["fixed_pose", "fixed_rpy"], hide_short_help = true)]
    through: Option<PathBuf>,
}

/// The kind of a motion with its values as text.
enum MotionKind<'a> {
    Still,
    Turn([&'a str; 3]),
    Screw([&'a str; 4]),
    Slide(DVec3),
    Thrown([&'a str; 3]),
    To(Place),
    Through(&'a Path),
}

impl MotionArguments {
    /// Returns the files of both sides.
    pub(crate) fn input_pair(&self) -> Result<InputPair<'_>, Failure> {
        let clash = "--convex-tolerance and --hull require convex meshes; --open and --ignore-start-overlaps require \
             parts; drop one of the two groups";
        let requires_parts = self.open || self.ignore_start_overlaps;
        let requires_convex = self.hulls.requires_convex(self.body);
        let mode = BodyMode::from_requirements([requires_convex, requires_parts], clash)?;
        InputPair::from_arguments(&self.meshes, &self.from, mode, false)
    }

    /// Returns how the moving and the fixed files are read as parts.
    pub(crate) fn part_options(&self) -> [BodyOptions; 2] {
        self.body.part_options(&self.places, self.open)
    }

    /// Returns how the moving and the fixed files are read as convex bodies.
    pub(crate) fn body_options(&self) -> [BodyOptions; 2] {
        self.hulls.body_options(self.body, &self.places)
    }

    /// Returns the motions of both sides, and notes about quaternions of `--to` and `--through` that were normalised.
    ///
    /// # Errors
    /// Neither side moves, or a value is invalid.
    pub(crate) fn motions(&self) -> Result<([Motion; 2], Vec<String>), Failure> {
        let [moving_pose, fixed_pose] = self.places.poses()?;
        let kinds = [self.motion.kind(), self.fixed_motion.kind()];
        if let [MotionKind::Still, MotionKind::Still] = kinds {
            let why = "nothing moves; give one of --turn, --screw, --slide, --thrown, --to, --through, or one of the \
                       motions of the fixed mesh";
            return Err(Failure::new(Code::Usage, why));
        }
        let mut notes = Vec::new();
        let moving = kinds[0].motion("--", moving_pose, &mut notes)?;
        let fixed = kinds[1].motion("--fixed-", fixed_pose, &mut notes)?;
        Ok(([moving, fixed], notes))
    }
}

impl MovingMotionArguments {
    fn kind(&self) -> MotionKind<'_> {
        let Self { turn, screw, slide, thrown, to, through } = self;
        MotionKind::from_options(
            [turn, screw, thrown].map(Option::as_deref),
            *slide,
            *to,
            through.as_deref(),
        )
    }
}

impl FixedMotionArguments {
    fn kind(&self) -> MotionKind<'_> {
        let Self { turn, screw, slide, thrown, to, through } = self;
        MotionKind::from_options(
            [turn, screw, thrown].map(Option::as_deref),
            *slide,
            *to,
            through.as_deref(),
        )
    }
}

impl<'a> MotionKind<'a> {
    /// Returns the kind that is given; [`MotionKind::Still`] if none is.
    fn from_options(
        [turn, screw, thrown]: [Option<&'a [String]>; 3],
        slide: Option<DVec3>,
        to: Option<Place>,
        through: Option<&'a Path>,
    ) -> Self {
        let turn = option_words(turn).map(Self::Turn);
        let screw = option_words(screw).map(Self::Screw);
        let thrown = option_words(thrown).map(Self::Thrown);
        let others = slide.map(Self::Slide).or(to.map(Self::To)).or(through.map(Self::Through));
        turn.or(screw).or(thrown).or(others).unwrap_or(Self::Still)
    }

    /// Returns the motion from a pose. `option` is the beginning of the options' names, for messages.
    fn motion(&self, option: &str, pose: Pose, notes: &mut Vec<String>) -> Result<Motion, Failure> {
        let named = |name: &str| format!("{option}{name}");
        Ok(match *self {
            Self::Still => Motion::at_rest(pose),
            Self::Turn([point, axis, angle]) => {
                let name = named("turn");
                let (point, axis) =
                    (for_option(&name, vector(point))?, for_option(&name, direction(axis))?);
                Motion::rotation_about(pose, point, axis, parse_degrees(&name, angle)?)?
            }
            Self::Screw([point, axis, angle, rise]) => {
                let name = named("screw");
                let (point, axis) =
                    (for_option(&name, vector(point))?, for_option(&name, direction(axis))?);
                let rise = for_option(&name, parse_number(rise))?;
                Motion::screw(pose, point, axis, parse_degrees(&name, angle)?, rise)?
            }
            Self::Slide(by) => Motion::translation(pose, by)?,
            Self::Thrown(words) => {
                let [center, way, spin] =
                    words.map(|text| for_option(&named("thrown"), vector(text)));
                Motion::free_flight(pose, center?, way?, spin?.map(f64::to_radians))?
            }
            Self::To(place) => {
                notes.extend(place.note(&named("to")));
                Motion::between_poses(pose, for_option(&named("to"), place.pose(None, "--to"))?)?
            }
            Self::Through(path) => Motion::through_poses(&read_poses(path, notes)?)?,
        })
    }
}

/// Returns the `N` words of an option; `None` if it is not given.
fn option_words<const N: usize>(words: Option<&[String]>) -> Option<[&str; N]> {
    let words: Vec<&str> = words?.iter().map(String::as_str).collect();
    words.try_into().ok()
}

impl From<MotionError> for Failure {
    fn from(error: MotionError) -> Self {
        Self::new(Code::Usage, error.to_string())
    }
}

/// Converts an error about an option into a failure that names it.
fn for_option<T>(option: &str, value: Result<T, String>) -> Result<T, Failure> {
    value.map_err(|what| Failure::new(Code::Usage, format!("{option}: {what}")))
}

/// Parses a number.
fn parse_number(text: &str) -> Result<f64, String> {
    text.trim().parse().map_err(|_| format!("`{}` is not a number", text.trim()))
}

/// Parses an angle in degrees; returns radians.
fn parse_degrees(option: &str, text: &str) -> Result<f64, Failure> {
    let degrees = parse_number(text).map_err(|what| format!("{what} of degrees"));
    Ok(for_option(option, degrees)?.to_radians())
}

/// Reads the poses of a JSON file. Appends a note if quaternions were normalised.
fn read_poses(path: &Path, notes: &mut Vec<String>) -> Result<Vec<Pose>, Failure> {
    let input = |what: String| Failure::new(Code::Input, format!("{}: {what}", path.display()));
    let text =
        colltrans_mesh::file::text(path).map_err(|e| input(format!("cannot be read: {e}")))?;
    let rows: Vec<Vec<f64>> = serde_json::from_str(&text)
        .map_err(|e| input(format!("expected poses [[x,y,z,qx,qy,qz,qw], ...]: {e}")))?;
    let read = |(k, row): (usize, &Vec<f64>)| {
        let written: Vec<String> = row.iter().map(f64::to_string).collect();
        place(&written.join(",")).map_err(|what| input(format!("pose {k}: {what}")))
    };
    let places = rows.iter().enumerate().map(read).collect::<Result<Vec<Place>, Failure>>()?;
    let lengths: Vec<_> = places.iter().map(Place::original_length).collect();
    notes.extend(normalised_poses_note(&path.display().to_string(), &lengths));
    let pose = |place: &Place| place.pose(None, "--through").map_err(input);
    places.iter().map(pose).collect()
}
