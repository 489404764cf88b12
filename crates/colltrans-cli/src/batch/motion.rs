//! Motions of a batch line, and their queries for convex bodies.

use std::borrow::Cow;
use std::fmt;

use colltrans::glam::DVec3;
use colltrans::motion::{Motion, MotionCast};
use colltrans::record::MotionRecord;
use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserialize, Deserializer, IgnoredAny, MapAccess, Visitor};

use super::source::{PoseSource, Query};
use crate::args::normalised_poses_note;
use crate::body::Part;
use crate::case;

/// A motion of a line.
#[derive(Debug)]
pub(super) struct MotionSource {
    kind: Kind,
    /// Name of a second kind, which is an error.
    other: Option<String>,
}

/// One kind of motion. Angles name their unit: `radians` or `degrees`, one of the two.
#[derive(Debug, serde::Deserialize)]
#[serde(rename_all = "snake_case", rename_all_fields = "snake_case", deny_unknown_fields)]
enum Kind {
    Still {},
    Slide { by: [f64; 3] },
    Turn { point: [f64; 3], axis: [f64; 3], radians: Option<f64>, degrees: Option<f64> },
    Screw { point: [f64; 3], axis: [f64; 3], radians: Option<f64>, degrees: Option<f64>, rise: f64 },
    Thrown { center: [f64; 3], velocity: [f64; 3], angular_velocity: [f64; 3] },
    Between { from: PoseSource, to: PoseSource },
    Through { poses: Vec<PoseSource> },
}

impl<'de> Deserialize<'de> for MotionSource {
    fn deserialize<D: Deserializer<'de>>(source: D) -> Result<Self, D::Error> {
        source.deserialize_map(KindVisitor)
    }
}

/// Visits an object with one kind of motion to its end.
struct KindVisitor;

impl<'de> Visitor<'de> for KindVisitor {
    type Value = MotionSource;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("an object with a motion")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<MotionSource, A::Error> {
        let kind = Kind::deserialize(MapAccessDeserializer::new(&mut map))?;
        let other = map.next_entry::<String, IgnoredAny>()?.map(|(name, _)| name);
        while map.next_entry::<IgnoredAny, IgnoredAny>()?.is_some() {}
        Ok(MotionSource { kind, other })
    }
}

impl MotionSource {
    /// Returns a note if quaternions of the motion's own poses were normalised.
    pub(super) fn pose_note(&self, place: &str) -> Option<String> {
        let lengths: Vec<_> = self.kind.poses().iter().map(PoseSource::original_length).collect();
        normalised_poses_note(place, &lengths)
    }

    /// Returns the motion. It starts at `pose`, or at the identity if `pose` is `None`. The kinds `between` and
    /// `through` have poses of their own instead.
    ///
    /// # Errors
    /// The motion has a second kind, a pose is given although the motion has its own, or a value is invalid.
    fn motion(&self, pose: Option<&PoseSource>) -> Result<Motion, String> {
        match &self.other {
            Some(name) => Err(format!("a motion has one kind; remove `{name}`")),
            None => self.kind.motion(pose),
        }
    }
}

impl Kind {
    /// Returns the poses of the motion itself.
    fn poses(&self) -> Cow<'_, [PoseSource]> {
        match self {
            Self::Between { from, to } => vec![*from, *to].into(),
            Self::Through { poses } => poses.into(),
            _ => Cow::default(),
        }
    }

    /// Returns the motion from a pose, or from its own poses.
    fn motion(&self, pose: Option<&PoseSource>) -> Result<Motion, String> {
        let v = DVec3::from_array;
        let has_own = matches!(self, Self::Between { .. } | Self::Through { .. });
        if has_own && pose.is_some() {
            return Err(
                "`between` and `through` have their own poses; remove the pose of the body".into(),
            );
        }
        let start = pose.copied().unwrap_or_default().pose()?;
        let motion = match self {
            Self::Still {} => Ok(Motion::at_rest(start)),
            Self::Slide { by } => Motion::translation(start, v(*by)),
            Self::Turn { point, axis, radians, degrees } => Motion::rotation_about(
                start,
                v(*point),
                v(*axis),
                angle_in_radians(*radians, *degrees)?,
            ),
            Self::Screw { point, axis, radians, degrees, rise } => {
                let angle = angle_in_radians(*radians, *degrees)?;
                Motion::screw(start, v(*point), v(*axis), angle, *rise)
            }
            Self::Thrown { center, velocity, angular_velocity } => {
                Motion::free_flight(start, v(*center), v(*velocity), v(*angular_velocity))
            }
            Self::Between { from, to } => Motion::between_poses(from.pose()?, to.pose()?),
            Self::Through { poses } => {
                let pose = |(k, pose): (usize, &PoseSource)| {
                    pose.pose().map_err(|what| format!("pose {k}: {what}"))
                };
                let poses: Vec<_> = poses.iter().enumerate().map(pose).collect::<Result<_, _>>()?;
                Motion::through_poses(&poses)
            }
        };
        motion.map_err(|error| error.to_string())
    }
}

/// Returns an angle in radians from one of two fields.
///
/// # Errors
/// Both fields are given, or none.
fn angle_in_radians(radians: Option<f64>, degrees: Option<f64>) -> Result<f64, String> {
    match (radians, degrees) {
        (Some(radians), None) => Ok(radians),
        (None, Some(degrees)) => Ok(degrees.to_radians()),
        _ => Err("an angle needs exactly one of the fields `radians` and `degrees`".into()),
    }
}

/// Returns the motions of both bodies. A body without a motion rests at its pose.
///
/// # Errors
/// Neither body has a motion, or a value is invalid.
pub(super) fn motions_of<B>(query: &Query<'_, B>) -> Result<[Motion; 2], String> {
    if query.moving_motion.is_none() && query.fixed_motion.is_none() {
        return Err(r#""motion" needs a `moving_motion` or a `fixed_motion`"#.into());
    }
    let motion_of = |motion: Option<&MotionSource>, pose, name: &str| {
        let motion = motion.map_or_else(|| Kind::Still {}.motion(pose), |m| m.motion(pose));
        motion.map_err(|what| format!("{name}: {what}"))
    };
    Ok([
        motion_of(query.moving_motion.as_ref(), query.moving_pose.as_ref(), "moving_motion")?,
        motion_of(query.fixed_motion.as_ref(), query.fixed_pose.as_ref(), "fixed_motion")?,
    ])
}

/// Answers when convex bodies first meet, or, if `clears` is set, how far they can move.
pub(super) fn convex_record<B>(
    query: &Query<'_, B>,
    [moving, fixed]: [&Part; 2],
    motions: &[Motion; 2],
    clears: bool,
) -> Result<MotionRecord, String> {
    if query.ignore_start_overlaps.is_some() {
        return Err("`ignore_start_overlaps` requires solids".into());
    }
    let cast =
        MotionCast::new(moving.body.with_motion(&motions[0]), fixed.body.with_motion(&motions[1]));
    let cast = match (query.min_gap, query.tolerance) {
        (Some(_), Some(_)) => {
            return Err(
                "a motion accepts either `min_gap` or `tolerance`; remove one of them".into()
            );
        }
        (None, Some(depth)) => cast.and_then(|cast| cast.with_tolerance(depth)),
        (min_gap, None) => cast.and_then(|cast| cast.with_min_gap(min_gap.unwrap_or_default())),
    };
    let cast = cast.map_err(|error| error.to_string())?;
    let failed = |error| case::motion_failure(error, &cast).into_message();
    Ok(if clears {
        MotionRecord::of_clearance(&cast.clearance().map_err(failed)?, &cast)
    } else {
        MotionRecord::from_outcome(&cast.first_contact().map_err(failed)?, &cast)
    })
}
