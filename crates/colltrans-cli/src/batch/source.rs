//! The format of a line of a batch.

use std::path::{Path, PathBuf};

use colltrans::{Solver, cta};
use serde::{Deserialize, Deserializer};
use serde_json::value::RawValue;

use super::motion::MotionSource;

/// A query. `Body` is a parsed body, or its text.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "an object with a query")]
pub(super) struct Query<'a, Body> {
    #[serde(borrow, default, deserialize_with = "raw_value")]
    pub(super) id: Option<&'a RawValue>,
    pub(super) moving: Body,
    pub(super) fixed: Body,
    pub(super) moving_pose: Option<PoseSource>,
    pub(super) fixed_pose: Option<PoseSource>,
    pub(super) direction: Option<[f64; 3]>,
    #[serde(rename = "query")]
    pub(super) question: Option<QueryName>,
    /// For [`QueryName::Motion`] and [`QueryName::MotionClearance`].
    pub(super) moving_motion: Option<MotionSource>,
    pub(super) fixed_motion: Option<MotionSource>,
    /// For [`QueryName::Within`].
    pub(super) length: Option<f64>,
    pub(super) graze_tolerance: Option<f64>,
    pub(super) solver: Option<Solver>,
    /// For [`Solver::Cta`].
    pub(super) start: Option<cta::Start>,
    pub(super) until: Option<cta::Until>,
    pub(super) cuts: Option<cta::Cuts>,
    pub(super) across_cells: Option<bool>,
    pub(super) cold: Option<bool>,
    pub(super) tolerance: Option<f64>,
    pub(super) ignore_start_overlaps: Option<bool>,
    pub(super) min_gap: Option<f64>,
}

/// Returns the text of a value. `null` is a value, too, which a result repeats.
pub(super) fn raw_value<'de, D: Deserializer<'de>>(
    from: D,
) -> Result<Option<&'de RawValue>, D::Error> {
    <&RawValue>::deserialize(from).map(Some)
}

/// The name of a question.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum QueryName {
    Contact,
    Clearance,
    Distance,
    Depth,
    Within,
    Motion,
    MotionClearance,
}

/// The points of the core of a round body, and its radius.
pub(super) type RoundShape = (Vec<[f64; 3]>, f64);

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, expecting = "an object with a body")]
pub(crate) struct BodySource {
    pub(super) points: Option<Vec<[f64; 3]>>,
    /// Radius of a sphere about the origin.
    pub(super) sphere: Option<f64>,
    /// Ends of the axis of a capsule.
    pub(super) capsule: Option<[[f64; 3]; 2]>,
    /// Radius of a capsule, or by which points, a mesh or a solid are rounded.
    pub(super) radius: Option<f64>,
    pub(super) mesh: Option<PathBuf>,
    pub(super) solid: Option<PathBuf>,
    pub(super) open: Option<bool>,
    pub(super) hull: Option<bool>,
    pub(super) scale: Option<f64>,
}

#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields, default, expecting = "an object with a pose")]
pub(crate) struct PoseSource {
    pub(super) translation: [f64; 3],
    pub(super) rotation: [f64; 4],
}

impl BodySource {
    /// Returns the points and the radius of a sphere or a capsule, `None` for another body.
    ///
    /// # Errors
    /// The body is a sphere or a capsule, and another body as well, or its radius is missing or given twice.
    pub(super) fn round_shape(&self) -> Result<Option<RoundShape>, String> {
        let is_other = self.points.is_some() || self.mesh.is_some() || self.solid.is_some();
        let found = match (self.sphere, self.capsule, self.radius) {
            (None, None, _) => return Ok(None),
            (Some(radius), None, None) => (vec![[0.0; 3]], radius),
            (None, Some(ends), Some(radius)) => (ends.to_vec(), radius),
            (None, Some(_), None) => return Err("a `capsule` requires a `radius`".into()),
            (Some(_), None, Some(_)) => return Err("`sphere` is the radius: omit `radius`".into()),
            (Some(_), Some(_), _) => {
                return Err("a body is a `sphere` or a `capsule`, not both".into());
            }
        };
        if is_other {
            return Err("a `sphere` or a `capsule` excludes `points`, `mesh` and `solid`".into());
        }
        Ok(Some(found))
    }

    /// Returns the file of the body; `None` for points.
    pub(crate) fn file(&self) -> Option<&Path> {
        self.mesh.as_deref().or(self.solid.as_deref())
    }
}

impl Default for PoseSource {
    fn default() -> Self {
        Self { translation: [0.0; 3], rotation: [0.0, 0.0, 0.0, 1.0] }
    }
}
