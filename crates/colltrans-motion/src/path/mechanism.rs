//! Frames that joints carry, and the values of the joints over time.
//!
//! Frame `f` has the pose `O J(q)` in its parent. `O` is its origin. `J` is the motion of its joint: the identity, a
//! rotation by `q` radians about an axis through the origin of the frame, or a translation by `q` along an axis. The
//! numbers of `O`, the axis, and the values *define* the poses as real numbers, as if the length of the axis were
//! exactly 1. Between two rows of values, each joint moves at a constant rate.

use glam::DVec3;
use thiserror::Error;

use colltrans_convex::body::Pose;
use colltrans_convex::setting::error::QueryError;
use colltrans_kernel::angle;
use colltrans_kernel::error::PoseError;
use colltrans_kernel::noise;
use colltrans_kernel::range::{MAX_MAGNITUDE, is_in_exact_range, with_tiny_components_zeroed};

/// A frame that a joint carries.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct Frame {
    /// Number of the parent frame, which is smaller than that of this frame; `None` for the world.
    #[cfg_attr(
        feature = "serde",
        serde(deserialize_with = "colltrans_kernel::serialization::required_option")
    )]
    pub parent: Option<usize>,
    /// Pose of the joint in the parent frame.
    pub origin: Pose,
    /// The joint that moves the frame.
    pub joint: Joint,
}

/// The motion of a frame relative to its origin.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum Joint {
    /// A fixed frame.
    Fixed,
    /// A revolute joint: rotation about an axis, by a value in radians.
    Turning(DVec3),
    /// A prismatic joint: translation along an axis, by a value in world units.
    Sliding(DVec3),
}

impl Joint {
    /// Returns the axis of the joint; `None` for a fixed frame.
    #[doc(hidden)]
    pub fn axis(&self) -> Option<DVec3> {
        match self {
            Self::Fixed => None,
            Self::Turning(axis) | Self::Sliding(axis) => Some(*axis),
        }
    }
}

/// A tree of frames. The number of a frame is its index in the list; a parent has a smaller number than its children.
///
/// ```
/// use colltrans::glam::DVec3;
/// use colltrans::motion::path::{Frame, Joint, Mechanism};
/// use colltrans::Pose;
///
/// // A planar arm of two links of length 1.
/// let elbow = Pose::from_translation(DVec3::X)?;
/// let arm = Mechanism::new(vec![
///     Frame { parent: None, origin: Pose::IDENTITY, joint: Joint::Turning(DVec3::Z) },
///     Frame { parent: Some(0), origin: elbow, joint: Joint::Turning(DVec3::Z) },
/// ])?;
/// assert_eq!(arm.joint_count(), 2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Mechanism {
    frames: Vec<Frame>,
}

impl Mechanism {
    /// Builds a mechanism from frames, each after its parent. Axes are divided by their lengths, unless the length is 1
    /// up to rounding.
    ///
    /// # Errors
    /// [`PathError::Parent`] if the parent of a frame is the frame itself or a later one. [`PathError::Axis`] if an
    /// axis is zero, not finite or out of range.
    pub fn new(mut frames: Vec<Frame>) -> Result<Self, PathError> {
        for (k, frame) in frames.iter_mut().enumerate() {
            if frame.parent.is_some_and(|parent| parent >= k) {
                return Err(PathError::Parent { frame: k });
            }
            if let Joint::Turning(axis) | Joint::Sliding(axis) = &mut frame.joint {
                let length = axis.length();
                if !(is_in_exact_range(with_tiny_components_zeroed(*axis)) && length > 0.0) {
                    return Err(PathError::Axis { frame: k, axis: *axis });
                }
                if (length - 1.0).abs() > noise::UNIT_VECTOR {
                    *axis /= length;
                }
                *axis = with_tiny_components_zeroed(*axis);
            }
        }
        Ok(Self { frames })
    }

    /// Returns the frames.
    pub fn frames(&self) -> &[Frame] {
        &self.frames
    }

    /// Returns the number of joints that move. A row has a value for each of them, in the order of the frames.
    pub fn joint_count(&self) -> usize {
        self.frames.iter().filter(|frame| frame.joint != Joint::Fixed).count()
    }

    /// Returns for each frame the column of its joint in a row; `None` for a fixed frame.
    pub(super) fn joint_columns(&self) -> Vec<Option<usize>> {
        let mut next = 0..;
        let column = |frame: &Frame| match frame.joint {
            Joint::Fixed => None,
            _ => next.next(),
        };
        self.frames.iter().map(column).collect()
    }

    /// Returns the frames from the world down to a frame, including the frame.
    pub(super) fn frames_above(&self, frame: Option<usize>) -> Vec<usize> {
        let mut found: Vec<usize> =
            std::iter::successors(frame, |k| self.frames[*k].parent).collect();
        found.reverse();
        found
    }
}

/// Values of all joints at several times. Between two rows each joint moves at a constant rate.
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
    /// Builds a path from rows of joint values at increasing times, in any unit.
    ///
    /// # Errors
    /// [`PathError::Rows`] if there are no rows, or another number of times. [`PathError::Time`] if the times do not
    /// increase or are out of range. [`PathError::Row`] if the rows have different lengths.
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

    /// Builds a path from rows at the times 0, 1, 2, and so on.
    ///
    /// # Errors
    /// Returns the errors of [`Self::new`].
    pub fn at_unit_times(rows: Vec<Vec<f64>>) -> Result<Self, PathError> {
        Self::new((0..rows.len()).map(|k| k as f64).collect(), rows)
    }

    /// Returns the times of the rows.
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// Returns the rows of joint values, one for each time.
    pub fn rows(&self) -> &[Vec<f64>] {
        &self.rows
    }

    /// Returns the first and the last time.
    pub fn time_range(&self) -> [f64; 2] {
        [self.times[0], self.times[self.times.len() - 1]]
    }

    /// Checks whether a place is on the path.
    pub(super) fn contains(&self, PathPlace { row, share }: PathPlace) -> bool {
        row < self.last_row() && (0.0..=1.0).contains(&share)
            || row == self.last_row() && share == 0.0
    }

    /// Returns the index of the last row, which is the number of intervals between rows.
    pub(super) fn last_row(&self) -> usize {
        self.times.len() - 1
    }

    /// Returns bounds of the time of a place.
    pub(super) fn time_bounds(&self, place: PathPlace) -> [f64; 2] {
        let current = self.times[place.row];
        if place.share == 0.0 {
            return [current; 2];
        }
        let next = self.times[place.row + 1];
        if place.share == 1.0 {
            return [next; 2];
        }
        let time = current + place.share * (next - current);
        // Error: two roundings of the product, one of the sum.
        let off = f64::EPSILON * (time.abs() + 2.0 * (next - current));
        [(time - off).max(current), (time + off).min(next)]
    }

    /// Returns the value of a joint at a row, and its change up to the next row.
    pub(super) fn value_and_change(&self, row: usize, column: usize) -> [f64; 2] {
        let value = self.rows[row][column];
        [value, self.rows.get(row + 1).map_or(0.0, |next| next[column] - value)]
    }

    /// Returns the maximum absolute value of a joint.
    pub(super) fn max_value(&self, column: usize) -> f64 {
        self.rows.iter().map(|row| row[column].abs()).fold(0.0, f64::max)
    }

    /// Checks that the rows have one value in range for each joint of a mechanism.
    pub(super) fn check_rows(&self, mechanism: &Mechanism) -> Result<(), PathError> {
        let joints = mechanism.joint_count();
        let columns = mechanism.joint_columns();
        for (row, values) in self.rows.iter().enumerate() {
            if values.len() != joints {
                return Err(PathError::Row { row, values: values.len(), joints });
            }
            for (frame, column) in columns.iter().enumerate() {
                let Some(column) = *column else { continue };
                let value = values[column];
                let most = match mechanism.frames[frame].joint {
                    Joint::Turning(_) => angle::MAX_ANGLE,
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

/// A place on a path: a row, and the share of the interval to the next row.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct PathPlace {
    /// Index of the row, from 0.
    pub row: usize,
    /// Share of the interval to the next row, from 0 to 1.
    pub share: f64,
}

impl PathPlace {
    /// The start of a path.
    pub(super) const START: Self = Self { row: 0, share: 0.0 };

    /// Returns the place of a row.
    pub(super) fn at_row(row: usize) -> Self {
        Self { row, share: 0.0 }
    }

    /// Returns the earlier of two places.
    pub(super) fn earlier_of(self, other: Self) -> Self {
        if other < self { other } else { self }
    }

    /// Returns the same place, with the end of an interval expressed as the start of the next one.
    pub(super) fn normalised(self) -> Self {
        if self.share >= 1.0 { Self::at_row(self.row + 1) } else { self }
    }
}

/// The serialised form of a path, which is checked when it is read.
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

/// The reason why a mechanism, a path or a query about it is rejected.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum PathError {
    /// The parent of a frame is not an earlier frame.
    #[error(
        "frame {frame} has itself or a later frame as its parent; parents must come before \
         their children"
    )]
    Parent {
        /// Number of the frame.
        frame: usize,
    },
    /// An axis is zero, not finite or out of range.
    #[error("axis {:?} of frame {frame} is zero, not finite or out of range", .axis.to_array())]
    Axis {
        /// Number of the frame.
        frame: usize,
        /// The axis, as given.
        axis: DVec3,
    },
    /// There are no rows, or the number of times differs from that of rows.
    #[error(
        "the path has {rows} rows and {times} times; give at least one row, and one time for \
         each row"
    )]
    Rows {
        /// Number of times.
        times: usize,
        /// Number of rows.
        rows: usize,
    },
    /// A time does not increase from the previous row, or is out of range.
    #[error("invalid time {time} of row {row}; times must be finite and increase from row to row")]
    Time {
        /// Index of the row, from 0.
        row: usize,
        /// The time, as given.
        time: f64,
    },
    /// A row does not have one value for each joint.
    #[error("row {row} has {values} values, expected {joints}, one for each joint")]
    Row {
        /// Index of the row, from 0.
        row: usize,
        /// Number of values of the row.
        values: usize,
        /// Number of joints.
        joints: usize,
    },
    /// A joint value is invalid.
    #[error(
        "invalid value {value} of frame {frame} in row {row}; accepted: finite, at most 1e5 for \
         angles in radians"
    )]
    Value {
        /// Index of the row, from 0.
        row: usize,
        /// Number of the frame that the value moves.
        frame: usize,
        /// The value, as given.
        value: f64,
    },
    /// A body refers to a frame that does not exist.
    #[error("body {body} refers to frame {frame}, which does not exist")]
    Frame {
        /// Number of the body.
        body: usize,
        /// Number of the frame.
        frame: usize,
    },
    /// A pair does not refer to two different bodies that exist.
    #[error(
        "invalid pair of bodies {} and {}; a pair needs the numbers of two different bodies",
        .pair[0],
        .pair[1]
    )]
    Pair {
        /// The pair, as given.
        pair: [usize; 2],
    },
    /// The minimum gap is invalid.
    #[error("invalid minimum gap {gap}; accepted: finite, from 0 to 2^200")]
    MinGap {
        /// The gap, as given.
        gap: f64,
    },
    /// A body can move out of range.
    #[error("body {body} can be farther than 2^200 from the start of its chain of frames")]
    OutOfRange {
        /// Number of the body.
        body: usize,
    },
    /// A pose is invalid.
    #[error("invalid pose: {0}")]
    Pose(#[from] PoseError),
    /// The query about two bodies failed.
    #[error("body {} and body {}: {reason}", .pair[0], .pair[1])]
    Query {
        /// Numbers of the bodies.
        pair: [usize; 2],
        /// Reason of the failure.
        #[source]
        reason: Box<QueryError>,
    },
}
