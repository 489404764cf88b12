//! `colltrans motion`: when bodies that turn first meet.

use std::path::{Path, PathBuf};

use clap::Args;
use colltrans::Pose;
use colltrans::glam::DVec3;
use colltrans::motion::{Motion, MotionError};
use colltrans_mesh::body::BodyOptions;

use super::values::{place, vector};
use super::{BodyArguments, HullArguments, PlaceArguments, direction, length, proof};
use crate::failure::{Code, Failure};

#[derive(Debug, Args)]
pub(crate) struct MotionArguments {
    /// The mesh that moves
    pub(crate) moving: PathBuf,
    /// The mesh that stays
    pub(crate) fixed: PathBuf,
    #[command(flatten)]
    motion: KindArguments,
    /// A gap to be kept: ask when the meshes are first as near as that, not when they touch
    #[arg(long, value_name = "GAP", allow_hyphen_values = true, value_parser = length, default_value = "0")]
    pub(crate) keep: f64,
    /// How deep the meshes may overlap: ask when they first do by more
    ///
    /// In the unit of the meshes. What rests on something and turns there needs a little, as rounding
    /// cannot tell a touch from an overlap.
    #[arg(long, value_name = "L", allow_hyphen_values = true, value_parser = length, conflicts_with = "keep", default_value = "0")]
    pub(crate) tolerance: f64,
    /// Print the answer as one JSON object
    #[arg(long)]
    pub(crate) json: bool,
    /// Write the proof of the answer, with the bodies and their motion, as one file that `colltrans
    /// verify` checks
    #[arg(long, value_name = "OUT.json", value_parser = proof)]
    pub(crate) save_proof: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) places: PlaceArguments,
    #[command(flatten)]
    hulls: HullArguments,
    #[command(flatten)]
    body: BodyArguments,
}

/// What the moving mesh does; angles are in degrees.
#[derive(Debug, Args)]
#[group(required = true, multiple = false)]
#[command(next_help_heading = "What the moving mesh does (angles in degrees)")]
struct KindArguments {
    /// A turn about an axis through a point of the world: counter-clockwise as seen against the axis
    #[arg(long, num_args = 3, value_names = ["POINT", "AXIS", "ANGLE"], allow_hyphen_values = true)]
    turn: Option<Vec<String>>,
    /// The same, and a way along the axis meanwhile
    #[arg(long, num_args = 4, value_names = ["POINT", "AXIS", "ANGLE", "RISE"], allow_hyphen_values = true)]
    screw: Option<Vec<String>>,
    /// A translation
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = vector)]
    slide: Option<DVec3>,
    /// A point of the mesh, given in the world, goes straight so far, and the mesh turns about it by the
    /// length of SPIN, about its direction
    #[arg(long, num_args = 3, value_names = ["CENTER", "WAY", "SPIN"], allow_hyphen_values = true)]
    thrown: Option<Vec<String>>,
    /// Screws from pose to pose in equal times: a JSON file of poses, [[x,y,z,qx,qy,qz,qw], ...], instead
    /// of --moving-pose
    #[arg(long, value_name = "POSES.json", conflicts_with_all = ["moving_pose", "moving_rpy"])]
    through: Option<PathBuf>,
}

impl MotionArguments {
    /// How both files become convex bodies.
    pub(crate) fn body_options(&self) -> [BodyOptions; 2] {
        self.hulls.body_options(self.body, &self.places)
    }

    /// What the moving mesh does from a pose on.
    pub(crate) fn motion(&self, pose: Pose) -> Result<Motion, Failure> {
        let KindArguments { turn, screw, slide, thrown, through } = &self.motion;
        if let Some(path) = through {
            return Ok(Motion::through(&poses(path)?)?);
        }
        let made = if let Some([point, axis, angle]) = turn.as_deref() {
            let (point, axis) = (at("--turn", vector(point))?, at("--turn", direction(axis))?);
            Motion::turn(pose, point, axis, radians("--turn", angle)?)
        } else if let Some([point, axis, angle, rise]) = screw.as_deref() {
            let (point, axis) = (at("--screw", vector(point))?, at("--screw", direction(axis))?);
            let rise = at("--screw", number(rise))?;
            Motion::screw(pose, point, axis, radians("--screw", angle)?, rise)
        } else if let Some([center, way, spin]) = thrown.as_deref() {
            let [center, way, spin] = [center, way, spin].map(|text| at("--thrown", vector(text)));
            Motion::thrown(pose, center?, way?, spin?.map(f64::to_radians))
        } else {
            Motion::slide(pose, slide.unwrap_or_default())
        };
        Ok(made?)
    }
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
    Ok(at(option, number(text))?.to_radians())
}

/// The poses of a file.
fn poses(path: &Path) -> Result<Vec<Pose>, Failure> {
    let input = |what: String| Failure::new(Code::Input, format!("{}: {what}", path.display()));
    let text =
        colltrans_mesh::file::text(path).map_err(|e| input(format!("cannot be read: {e}")))?;
    let rows: Vec<Vec<f64>> = serde_json::from_str(&text)
        .map_err(|e| input(format!("no poses [[x,y,z,qx,qy,qz,qw], ...]: {e}")))?;
    let pose = |(k, row): (usize, &Vec<f64>)| {
        let written: Vec<String> = row.iter().map(f64::to_string).collect();
        let pose = place(&written.join(",")).and_then(|place| place.pose(None, "--through"));
        pose.map_err(|what| input(format!("pose {k}: {what}")))
    };
    rows.iter().enumerate().map(pose).collect()
}
