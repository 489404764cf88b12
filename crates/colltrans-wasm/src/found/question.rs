//! The questions as the page writes them.

use colltrans::{Cast, ConvexPolyhedron, Options, Solver, cta};
use glam::DVec3;
use serde::Deserialize;

use crate::pose::pose;

/// A question.
#[derive(Deserialize)]
#[serde(tag = "do", rename_all = "snake_case")]
pub(crate) enum Question {
    /// Builds a body from the attached file, or the one that the name describes.
    Place { slot: Slot, name: String, take: String },
    /// Records a search.
    Search(Search),
    /// Computes the collision translations of pairs of sections.
    Levels(Levels),
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Slot {
    Moving,
    Fixed,
}

/// Two placed bodies and a direction. Poses are `x,y,z,qx,qy,qz,qw`.
#[derive(Deserialize)]
pub(crate) struct Pair {
    moving_pose: [f64; 7],
    fixed_pose: [f64; 7],
    direction: [f64; 3],
    #[serde(default)]
    graze: f64,
    #[serde(default)]
    solver: Solver,
    /// For the solver `cta`: `start` is `center`, `ellipsoids` or `guess`, `until` is `exit` or a gap.
    #[serde(default)]
    start: cta::Start,
    #[serde(default)]
    until: cta::Until,
}

/// A search to record.
#[derive(Deserialize)]
pub(crate) struct Search {
    #[serde(flatten)]
    pub(crate) pair: Pair,
    /// A previous query, from whose answer a tracker starts.
    #[serde(default)]
    pub(crate) after: Option<Pair>,
}

/// A grid of pairs of levels.
#[derive(Deserialize)]
pub(crate) struct Levels {
    #[serde(flatten)]
    pub(crate) pair: Pair,
    /// Section axes in the world.
    pub(crate) moving_axis: [f64; 3],
    pub(crate) fixed_axis: [f64; 3],
    /// Levels of the sections, each in its body frame.
    #[serde(rename = "moving_levels")]
    pub(crate) moving: Vec<f64>,
    #[serde(rename = "fixed_levels")]
    pub(crate) fixed: Vec<f64>,
}

impl Pair {
    /// Builds the cast of this pair.
    pub(crate) fn query<'a>(
        &self,
        [moving, fixed]: [&'a ConvexPolyhedron; 2],
    ) -> Result<Cast<'a>, String> {
        let moving = moving.at(pose(self.moving_pose, "moving")?);
        let fixed = fixed.at(pose(self.fixed_pose, "fixed")?);
        let options = Options::default()
            .with_solver(self.solver)
            .with_narrowing(cta::Options::new(self.start, self.until))
            .with_graze_tolerance(self.graze);
        let cast = Cast::new(moving, fixed, DVec3::from_array(self.direction));
        cast.and_then(|cast| cast.with_options(options)).map_err(|error| error.to_string())
    }
}
