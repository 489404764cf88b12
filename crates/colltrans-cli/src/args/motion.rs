//! `colltrans motion`: when bodies that turn first meet.

use std::path::{Path, PathBuf};

use clap::Args;
use colltrans::Pose;
use colltrans::glam::DVec3;
use colltrans::motion::{Motion, MotionError};
use colltrans_mesh::body::BodyOptions;

use super::values::{Place, normalised_poses, picture, place, vector};
use super::{
    BodyArguments, HullArguments, PlaceArguments, Sides, Taken, UNCLEAN, direction, length, proof,
};
use crate::failure::{Code, Failure};

#[derive(Debug, Args)]
#[expect(clippy::struct_excessive_bools, reason = "each is a flag of its own")]
pub(crate) struct MotionArguments {
    /// The mesh that moves and the one that it may meet; with --from all that move, together
    #[arg(required = true, value_name = "MESH")]
    meshes: Vec<PathBuf>,
    /// The meshes that it may meet: the answer is of the first one met
    #[arg(long, num_args = 1.., value_name = "FIXED")]
    from: Vec<PathBuf>,
    /// A gap to be kept: ask when the meshes are first as near as that, not when they touch
    #[arg(long, value_name = "GAP", allow_hyphen_values = true, value_parser = length, default_value = "0")]
    pub(crate) keep: f64,
    /// Ask how far the mesh can go, not when it first touches: what touches may slide, turn and leave
    ///
    /// It is stopped where it is pushed in, by more than the tolerance: of convex meshes without --tolerance what
    /// rounding can do to a fit.
    #[arg(long, conflicts_with = "save_proof")]
    pub(crate) clearance: bool,
    /// How deep the meshes may overlap: ask when they first do by more [default: 0; of parts, what the
    /// files' precision asks for]
    ///
    /// In the unit of the meshes. Of convex meshes, in the place of --keep: what rests on something and
    /// turns there needs a little, as rounding cannot tell a touch from an overlap. Parts are shrunk by
    /// half of it; a curved fit needs the chord errors of both together.
    #[arg(long, value_name = "L", allow_hyphen_values = true, value_parser = length)]
    pub(crate) tolerance: Option<f64>,
    /// Of parts: let what overlaps when the motion begins pass, and say what that is
    ///
    /// Faces that cross then do not count until they are apart; contacts that begin later do, of faces that look at
    /// each other. Meshes that are convex are taken as parts.
    #[arg(long)]
    pub(crate) ignore_start_overlaps: bool,
    /// Print the answer as one JSON object
    #[arg(long)]
    pub(crate) json: bool,
    /// Draw the moving mesh at the start, where it touches and at the end as an SVG picture
    #[arg(long, value_name = "OUT.svg", value_parser = picture)]
    pub(crate) picture: Option<PathBuf>,
    /// Write the proof of the answer, with the bodies and their motions, as one file that `colltrans verify`
    /// checks; of several convex meshes one of each pair
    #[arg(long, value_name = "OUT.json", value_parser = proof)]
    pub(crate) save_proof: Option<PathBuf>,
    #[command(flatten)]
    motion: KindArguments,
    #[command(flatten)]
    fixed_motion: FixedArguments,
    #[command(flatten)]
    pub(crate) places: PlaceArguments,
    /// Take surfaces that are not closed, as sheets and scans are: without an inside
    #[arg(long, help_heading = UNCLEAN)]
    open: bool,
    #[command(flatten)]
    hulls: HullArguments,
    #[command(flatten)]
    body: BodyArguments,
}

/// What the moving mesh does; angles are in degrees.
#[derive(Debug, Args)]
#[group(required = false, multiple = false)]
#[command(next_help_heading = "What the moving mesh does (angles in degrees)")]
struct KindArguments {
    /// A turn about an axis through a point of the world: counter-clockwise as seen against the axis
    #[arg(long, num_args = 3, action = clap::ArgAction::Set, value_names = ["POINT", "AXIS", "ANGLE"], allow_hyphen_values = true)]
    turn: Option<Vec<String>>,
    /// The same, and a way along the axis meanwhile
    #[arg(long, num_args = 4, action = clap::ArgAction::Set, value_names = ["POINT", "AXIS", "ANGLE", "RISE"], allow_hyphen_values = true)]
    screw: Option<Vec<String>>,
    /// A translation
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = vector)]
    slide: Option<DVec3>,
    /// A point of the mesh, given in the world, goes straight so far, and the mesh turns about it by the
    /// length of SPIN, about its direction
    #[arg(long, num_args = 3, action = clap::ArgAction::Set, value_names = ["CENTER", "WAY", "SPIN"], allow_hyphen_values = true)]
    thrown: Option<Vec<String>>,
    /// The screw from where the mesh is to another pose, written like --moving-pose, by the shorter turn
    #[arg(long, value_name = "POSE", allow_hyphen_values = true, value_parser = place)]
    to: Option<Place>,
    /// Screws from pose to pose in equal times: a JSON file of poses, [[x,y,z,qx,qy,qz,qw], ...], instead
    /// of --moving-pose
    #[arg(long, value_name = "POSES.json", conflicts_with_all = ["moving_pose", "moving_rpy"])]
    through: Option<PathBuf>,
}

/// What the other mesh does, if it moves as well.
#[derive(Debug, Args)]
#[group(required = false, multiple = false)]
#[command(next_help_heading = "What the fixed mesh does in the same time, if it moves as well")]
struct FixedArguments {
    /// Written like --turn
    #[arg(id = "fixed_turn", long = "fixed-turn", num_args = 3, action = clap::ArgAction::Set, value_names = ["POINT", "AXIS", "ANGLE"], allow_hyphen_values = true)]
    turn: Option<Vec<String>>,
    /// Written like --screw
    #[arg(id = "fixed_screw", long = "fixed-screw", num_args = 4, action = clap::ArgAction::Set, value_names = ["POINT", "AXIS", "ANGLE", "RISE"], allow_hyphen_values = true)]
    screw: Option<Vec<String>>,
    /// Written like --slide
    #[arg(id = "fixed_slide", long = "fixed-slide", value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = vector)]
    slide: Option<DVec3>,
    /// Written like --thrown
    #[arg(id = "fixed_thrown", long = "fixed-thrown", num_args = 3, action = clap::ArgAction::Set, value_names = ["CENTER", "WAY", "SPIN"], allow_hyphen_values = true)]
    thrown: Option<Vec<String>>,
    /// Written like --to
    #[arg(id = "fixed_to", long = "fixed-to", value_name = "POSE", allow_hyphen_values = true, value_parser = place)]
    to: Option<Place>,
    /// Written like --through
    #[arg(id = "fixed_through", long = "fixed-through", value_name = "POSES.json", conflicts_with_all = ["fixed_pose", "fixed_rpy"])]
    through: Option<PathBuf>,
}

/// A kind of motion, as it is written.
enum Kind<'a> {
    Still,
    Turn([&'a str; 3]),
    Screw([&'a str; 4]),
    Slide(DVec3),
    Thrown([&'a str; 3]),
    To(Place),
    Through(&'a Path),
}

impl MotionArguments {
    /// Who moves, and whom it may meet.
    pub(crate) fn sides(&self) -> Result<Sides<'_>, Failure> {
        let clash = "--convex-tolerance and --hull are for convex meshes, --open and --ignore-start-overlaps for parts";
        let asks_parts = self.open || self.ignore_start_overlaps;
        let taken = Taken::of([self.hulls.asks_convex(self.body), asks_parts], clash)?;
        Sides::of(&self.meshes, &self.from, taken, false)
    }

    /// How the files of both sides are read as parts.
    pub(crate) fn part_options(&self) -> [BodyOptions; 2] {
        self.body.part_options(&self.places, self.open)
    }

    /// How the files of both sides become convex bodies.
    pub(crate) fn body_options(&self) -> [BodyOptions; 2] {
        self.hulls.body_options(self.body, &self.places)
    }

    /// Returns what both sides do, and notes about quaternions of `--to` and `--through` that were normalised.
    pub(crate) fn motions(&self) -> Result<([Motion; 2], Vec<String>), Failure> {
        let [start, there] = self.places.poses()?;
        let kinds = [self.motion.kind(), self.fixed_motion.kind()];
        if let [Kind::Still, Kind::Still] = kinds {
            let why = "nothing moves: give one of --turn, --screw, --slide, --thrown, --to and --through, or of what \
                       the fixed mesh does";
            return Err(Failure::new(Code::Usage, why));
        }
        let mut notes = Vec::new();
        let moving = kinds[0].motion("--", start, &mut notes)?;
        let fixed = kinds[1].motion("--fixed-", there, &mut notes)?;
        Ok(([moving, fixed], notes))
    }
}

impl KindArguments {
    fn kind(&self) -> Kind<'_> {
        let Self { turn, screw, slide, thrown, to, through } = self;
        Kind::of([turn, screw, thrown].map(Option::as_deref), *slide, *to, through.as_deref())
    }
}

impl FixedArguments {
    fn kind(&self) -> Kind<'_> {
        let Self { turn, screw, slide, thrown, to, through } = self;
        Kind::of([turn, screw, thrown].map(Option::as_deref), *slide, *to, through.as_deref())
    }
}

impl<'a> Kind<'a> {
    /// The one that is there.
    fn of(
        [turn, screw, thrown]: [Option<&'a [String]>; 3],
        slide: Option<DVec3>,
        to: Option<Place>,
        through: Option<&'a Path>,
    ) -> Self {
        let turn = of_words(turn).map(Self::Turn);
        let screw = of_words(screw).map(Self::Screw);
        let thrown = of_words(thrown).map(Self::Thrown);
        let others = slide.map(Self::Slide).or(to.map(Self::To)).or(through.map(Self::Through));
        turn.or(screw).or(thrown).or(others).unwrap_or(Self::Still)
    }

    /// The motion from a pose on, of options that begin in this way.
    fn motion(&self, option: &str, pose: Pose, notes: &mut Vec<String>) -> Result<Motion, Failure> {
        let named = |name: &str| format!("{option}{name}");
        Ok(match *self {
            Self::Still => Motion::still(pose),
            Self::Turn([point, axis, angle]) => {
                let name = named("turn");
                let (point, axis) = (at(&name, vector(point))?, at(&name, direction(axis))?);
                Motion::turn(pose, point, axis, radians(&name, angle)?)?
            }
            Self::Screw([point, axis, angle, rise]) => {
                let name = named("screw");
                let (point, axis) = (at(&name, vector(point))?, at(&name, direction(axis))?);
                let rise = at(&name, number(rise))?;
                Motion::screw(pose, point, axis, radians(&name, angle)?, rise)?
            }
            Self::Slide(by) => Motion::slide(pose, by)?,
            Self::Thrown(words) => {
                let [center, way, spin] = words.map(|text| at(&named("thrown"), vector(text)));
                Motion::thrown(pose, center?, way?, spin?.map(f64::to_radians))?
            }
            Self::To(place) => {
                notes.extend(place.note(&named("to")));
                Motion::between(pose, at(&named("to"), place.pose(None, "--to"))?)?
            }
            Self::Through(path) => Motion::through(&poses(path, notes)?)?,
        })
    }
}

/// As many words as an option has.
fn of_words<const N: usize>(words: Option<&[String]>) -> Option<[&str; N]> {
    let words: Vec<&str> = words?.iter().map(String::as_str).collect();
    words.try_into().ok()
}

impl From<MotionError> for Failure {
    fn from(error: MotionError) -> Self {
        Self::new(Code::Usage, error.to_string())
    }
}

fn at<T>(option: &str, value: Result<T, String>) -> Result<T, Failure> {
    value.map_err(|what| Failure::new(Code::Usage, format!("{option}: {what}")))
}

fn number(text: &str) -> Result<f64, String> {
    text.trim().parse().map_err(|_| format!("`{}` is not a number", text.trim()))
}

/// Of degrees.
fn radians(option: &str, text: &str) -> Result<f64, Failure> {
    let degrees = number(text).map_err(|what| format!("{what} of degrees"));
    Ok(at(option, degrees)?.to_radians())
}

/// Reads the poses of a file.
fn poses(path: &Path, notes: &mut Vec<String>) -> Result<Vec<Pose>, Failure> {
    let input = |what: String| Failure::new(Code::Input, format!("{}: {what}", path.display()));
    let text =
        colltrans_mesh::file::text(path).map_err(|e| input(format!("cannot be read: {e}")))?;
    let rows: Vec<Vec<f64>> = serde_json::from_str(&text)
        .map_err(|e| input(format!("no poses [[x,y,z,qx,qy,qz,qw], ...]: {e}")))?;
    let read = |(k, row): (usize, &Vec<f64>)| {
        let written: Vec<String> = row.iter().map(f64::to_string).collect();
        place(&written.join(",")).map_err(|what| input(format!("pose {k}: {what}")))
    };
    let places = rows.iter().enumerate().map(read).collect::<Result<Vec<Place>, Failure>>()?;
    let lengths: Vec<_> = places.iter().map(Place::rounded).collect();
    notes.extend(normalised_poses(&path.display().to_string(), &lengths));
    let pose = |place: &Place| place.pose(None, "--through").map_err(input);
    places.iter().map(pose).collect()
}
