//! Frames that joints carry, and the values that the joints take.
//!
//! Notation. Frame `f` stands in its parent at `O J(q)`: its origin `O`, then what its joint does: nothing, a
//! rotation by `q` radians about an axis through the frame's origin, or a translation by `q` along one. The
//! numbers of `O`, the axis, and the values *define* where frames are, as real numbers; an axis counts as if its
//! length were exactly 1. Between two rows of values each joint goes evenly from one to the other.

use glam::DVec3;
use thiserror::Error;

use colltrans_convex::body::Pose;
use colltrans_convex::setting::error::QueryError;
use colltrans_kernel::angle;
use colltrans_kernel::error::PoseError;
use colltrans_kernel::noise;
use colltrans_kernel::range::{MAX_MAGNITUDE, is_in_exact_range, without_traces};

/// A place that a joint carries.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct Frame {
    /// The frame it stands in, one with a smaller number; none is the world.
    #[cfg_attr(feature = "serde", serde(deserialize_with = "colltrans_kernel::written::given"))]
    pub parent: Option<usize>,
    /// Where its joint is in that frame.
    pub origin: Pose,
    /// What moves it from there.
    pub joint: Joint,
}

/// What moves a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum Joint {
    /// Nothing.
    Fixed,
    /// A turn about an axis, by a value in radians.
    Turning(DVec3),
    /// A translation along an axis, by a value in world units.
    Sliding(DVec3),
}

impl Joint {
    /// Returns its axis, if it has one.
    #[doc(hidden)]
    pub fn axis(&self) -> Option<DVec3> {
        match self {
            Self::Fixed => None,
            Self::Turning(axis) | Self::Sliding(axis) => Some(*axis),
        }
    }
}

/// Frames in frames, in the order of their numbers.
///
/// ```
/// use colltrans::glam::DVec3;
/// use colltrans::motion::path::{Frame, Joint, Mechanism};
/// use colltrans::Pose;
///
/// // An arm of two links in a plane, each of length 1.
/// let elbow = Pose::from_translation(DVec3::X)?;
/// let arm = Mechanism::new(vec![
///     Frame { parent: None, origin: Pose::IDENTITY, joint: Joint::Turning(DVec3::Z) },
///     Frame { parent: Some(0), origin: elbow, joint: Joint::Turning(DVec3::Z) },
/// ])?;
/// assert_eq!(arm.joints(), 2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Mechanism {
    frames: Vec<Frame>,
}

impl Mechanism {
    /// Of frames, each after the one it stands in. Axes are divided by their lengths, unless that is 1 to rounding.
    ///
    /// # Errors
    /// A frame that stands in itself or in a later one, an axis that is zero.
    pub fn new(mut frames: Vec<Frame>) -> Result<Self, PathError> {
        for (k, frame) in frames.iter_mut().enumerate() {
            if frame.parent.is_some_and(|parent| parent >= k) {
                return Err(PathError::Parent { frame: k });
            }
            if let Joint::Turning(axis) | Joint::Sliding(axis) = &mut frame.joint {
                let length = axis.length();
                if !(is_in_exact_range(without_traces(*axis)) && length > 0.0) {
                    return Err(PathError::Axis { frame: k, axis: *axis });
                }
                if (length - 1.0).abs() > noise::UNIT_VECTOR {
                    *axis /= length;
                }
                *axis = without_traces(*axis);
            }
        }
        Ok(Self { frames })
    }

    /// The frames.
    pub fn frames(&self) -> &[Frame] {
        &self.frames
    }

    /// How many of them move: a row has a value for each, in the order of their numbers.
    pub fn joints(&self) -> usize {
        self.frames.iter().filter(|frame| frame.joint != Joint::Fixed).count()
    }

    /// The value of a row that moves each frame.
    pub(super) fn columns(&self) -> Vec<Option<usize>> {
        let mut next = 0..;
        let column = |frame: &Frame| match frame.joint {
            Joint::Fixed => None,
            _ => next.next(),
        };
        self.frames.iter().map(column).collect()
    }

    /// The frames that a frame stands in, itself last.
    pub(super) fn above(&self, frame: Option<usize>) -> Vec<usize> {
        let mut found: Vec<usize> =
            std::iter::successors(frame, |k| self.frames[*k].parent).collect();
        found.reverse();
        found
    }
}

/// Values of all joints at several times, in between evenly from row to row.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "PathRecord")
)]
pub struct JointPath {
    times: Vec<f64>,
    rows: Vec<Vec<f64>>,
}

impl JointPath {
    /// At times that grow, in any unit.
    ///
    /// # Errors
    /// No rows, rows of different lengths, times that are not as many or do not grow, numbers that are not finite.
    pub fn new(times: Vec<f64>, rows: Vec<Vec<f64>>) -> Result<Self, PathError> {
        if times.len() != rows.len() || rows.is_empty() {
            return Err(PathError::Rows { times: times.len(), rows: rows.len() });
        }
        for (row, time) in times.iter().enumerate() {
            let grows = row == 0 || times[row - 1] < *time;
            if !grows || time.abs().is_nan() || time.abs() > MAX_MAGNITUDE {
                return Err(PathError::Time { row, time: *time });
            }
        }
        for (row, values) in rows.iter().enumerate() {
            if values.len() != rows[0].len() {
                return Err(PathError::Row { row, values: values.len(), joints: rows[0].len() });
            }
        }
        Ok(Self { times, rows })
    }

    /// At the times 0, 1, 2 and so on.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn evenly(rows: Vec<Vec<f64>>) -> Result<Self, PathError> {
        Self::new((0..rows.len()).map(|k| k as f64).collect(), rows)
    }

    /// The times of the rows.
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// The values of all joints at each of them.
    pub fn rows(&self) -> &[Vec<f64>] {
        &self.rows
    }

    /// The first and the last time.
    pub fn ends(&self) -> [f64; 2] {
        [self.times[0], self.times[self.times.len() - 1]]
    }

    /// Whether a place is on it.
    pub(super) fn has(&self, Place { row, share }: Place) -> bool {
        row < self.last() && (0.0..=1.0).contains(&share) || row == self.last() && share == 0.0
    }

    /// The last row, or how many rows have a way to the next one.
    pub(super) fn last(&self) -> usize {
        self.times.len() - 1
    }

    /// Bounds of the time of a place between two rows.
    pub(super) fn time(&self, place: Place) -> [f64; 2] {
        let here = self.times[place.row];
        if place.share == 0.0 {
            return [here; 2];
        }
        let next = self.times[place.row + 1];
        if place.share == 1.0 {
            return [next; 2];
        }
        let time = here + place.share * (next - here);
        // Off by two roundings of the way, and one of the sum.
        let off = f64::EPSILON * (time.abs() + 2.0 * (next - here));
        [(time - off).max(here), (time + off).min(next)]
    }

    /// The value of a joint at a row and by how much it grows to the next one.
    pub(super) fn value(&self, row: usize, column: usize) -> [f64; 2] {
        let value = self.rows[row][column];
        [value, self.rows.get(row + 1).map_or(0.0, |next| next[column] - value)]
    }

    /// The largest value of a joint, by magnitude.
    pub(super) fn most(&self, column: usize) -> f64 {
        self.rows.iter().map(|row| row[column].abs()).fold(0.0, f64::max)
    }

    /// Whether the values are those of a mechanism's joints.
    pub(super) fn check(&self, mechanism: &Mechanism) -> Result<(), PathError> {
        let joints = mechanism.joints();
        let columns = mechanism.columns();
        for (row, values) in self.rows.iter().enumerate() {
            if values.len() != joints {
                return Err(PathError::Row { row, values: values.len(), joints });
            }
            for (frame, column) in columns.iter().enumerate() {
                let Some(column) = *column else { continue };
                let value = values[column];
                let most = match mechanism.frames[frame].joint {
                    Joint::Turning(_) => angle::MOST,
                    _ => MAX_MAGNITUDE,
                };
                if value.is_nan() || value.abs() > most {
                    return Err(PathError::Value { row, frame, value });
                }
            }
        }
        Ok(())
    }
}

/// A place on a path: which share of the way from a row to the next one is done.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct Place {
    /// The row, from 0.
    pub row: usize,
    /// From 0 to 1.
    pub share: f64,
}

impl Place {
    /// Where a path begins.
    pub(super) const START: Self = Self { row: 0, share: 0.0 };

    /// At a row.
    pub(super) fn at_row(row: usize) -> Self {
        Self { row, share: 0.0 }
    }

    /// The earlier one.
    pub(super) fn min_of(self, other: Self) -> Self {
        if other < self { other } else { self }
    }

    /// The same place, told by the row that begins there.
    pub(super) fn settled(self) -> Self {
        if self.share >= 1.0 { Self::at_row(self.row + 1) } else { self }
    }
}

/// A path as it is written; read, it is checked like any other.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct PathRecord {
    times: Vec<f64>,
    rows: Vec<Vec<f64>>,
}

#[cfg(feature = "serde")]
impl TryFrom<PathRecord> for JointPath {
    type Error = PathError;

    fn try_from(record: PathRecord) -> Result<Self, PathError> {
        Self::new(record.times, record.rows)
    }
}

/// Why there is no answer about a path.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum PathError {
    /// A frame does not stand in an earlier one.
    #[error("frame {frame} stands in itself, or in a frame that comes after it")]
    Parent {
        /// Which one.
        frame: usize,
    },
    /// An axis is none.
    #[error("the axis {:?} of frame {frame} is zero, not finite or out of range", .axis.to_array())]
    Axis {
        /// Which one.
        frame: usize,
        /// As given.
        axis: DVec3,
    },
    /// There are no rows, or not as many as times.
    #[error("a path needs a row, and a time for each: there are {times} times for {rows} rows")]
    Rows {
        /// How many times.
        times: usize,
        /// How many rows.
        rows: usize,
    },
    /// A time is not after the one before.
    #[error("the time {time} of row {row} is not finite, or not after the one before it")]
    Time {
        /// Which row, from 0.
        row: usize,
        /// As given.
        time: f64,
    },
    /// A row has not a value for each joint.
    #[error("row {row} has {values} values for {joints} joints")]
    Row {
        /// Which one, from 0.
        row: usize,
        /// How many it has.
        values: usize,
        /// How many it should have.
        joints: usize,
    },
    /// A value is none.
    #[error(
        "the value {value} of frame {frame} in row {row} is not finite, or too large (1e5 radians)"
    )]
    Value {
        /// Which row, from 0.
        row: usize,
        /// Which frame it is to move.
        frame: usize,
        /// As given.
        value: f64,
    },
    /// A body stands in a frame that does not exist.
    #[error("body {body} stands in frame {frame}, which does not exist")]
    Frame {
        /// Which body.
        body: usize,
        /// The frame.
        frame: usize,
    },
    /// A pair is not of two bodies.
    #[error("the pair of body {} and body {} is not one of two bodies that there are", .pair[0], .pair[1])]
    Pair {
        /// As given.
        pair: [usize; 2],
    },
    /// The gap to be kept is none.
    #[error("the gap {gap} to be kept is negative, not finite or larger than 2^200")]
    Keep {
        /// As given.
        gap: f64,
    },
    /// All that stands in frames is too far out.
    #[error("body {body} can be farther than 2^200 from where its frames begin")]
    Far {
        /// Which body.
        body: usize,
    },
    /// A pose is none.
    #[error("a pose is none: {0}")]
    Pose(#[from] PoseError),
    /// Two bodies have no answer.
    #[error("body {} and body {}: {reason}", .pair[0], .pair[1])]
    Query {
        /// Which ones.
        pair: [usize; 2],
        /// Why.
        #[source]
        reason: Box<QueryError>,
    },
}
