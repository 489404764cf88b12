//! One question for rows of poses and directions.
//!
//! A table has one row for all questions, or one for each. An answer of rows has a table of doubles, one row for
//! each question: the number of the answer (NaN for an error), then value, lower and upper bound, normal and
//! point. The text has `ROW ERROR` entries of the rows without an answer, separated by a null byte.

use colltrans::Pose;
use colltrans::glam::DVec3;

use super::answers::{COLUMNS, Found};
use super::error::{Failure, Fallible};
use super::question::{Numbers, PoseForm};
use crate::answer::Answer;

/// A table of poses or of directions.
struct Table<'a> {
    numbers: Numbers<'a>,
    width: usize,
    /// Number of numbers from one row to the next: 0 if there is one row for all questions.
    stride: usize,
}

impl<'a> Table<'a> {
    fn read(head: &mut Numbers<'_>, data: &mut Numbers<'a>) -> Fallible<Self> {
        let (width, rows) = (head.count()?, head.count()?);
        let numbers = data.split(width.saturating_mul(rows))?;
        Ok(Self { numbers, width, stride: if rows > 1 { width } else { 0 } })
    }

    fn row(&self, row: usize) -> Numbers<'a> {
        self.numbers.skip(row.saturating_mul(self.stride))
    }

    fn pose(&self, row: usize, argument: &'static str) -> Fallible<Pose> {
        let form = PoseForm::from_width(self.width)?;
        self.row(row).pose_in(form).map_err(|error| error.of(argument))
    }
}

/// The tables of poses of both bodies, and of directions.
pub(crate) struct Rows<'a> {
    count: usize,
    moving: Table<'a>,
    fixed: Table<'a>,
    directions: Table<'a>,
}

/// The poses and the direction of a row.
pub(crate) struct Row {
    pub(crate) moving_pose: Pose,
    pub(crate) fixed_pose: Pose,
    pub(crate) direction: DVec3,
}

impl<'a> Rows<'a> {
    /// Reads the number of rows, then width and rows of each table.
    pub(crate) fn read(head: &mut Numbers<'_>, bytes: &'a [u8]) -> Fallible<Self> {
        let (count, mut data) = (head.count()?, Numbers::new(bytes));
        let mut table = || Table::read(head, &mut data);
        Ok(Self { count, moving: table()?, fixed: table()?, directions: table()? })
    }

    fn row(&self, row: usize) -> Fallible<Row> {
        let direction = if self.directions.width == 0 {
            DVec3::Z
        } else {
            self.directions.row(row).vector()?
        };
        Ok(Row {
            moving_pose: self.moving.pose(row, "movingPoses")?,
            fixed_pose: self.fixed.pose(row, "fixedPoses")?,
            direction,
        })
    }

    /// Answers a question for all rows.
    pub(crate) fn answer(&self, ask: impl Fn(Row) -> Fallible<Found>) -> Answer {
        let mut answer = Answer::default();
        for row in 0..self.count {
            let found = self.row(row).and_then(&ask).map(|found| found.columns());
            let numbers = found.unwrap_or_else(|error: Failure| {
                answer.text.extend(format!("{row}\n{}\0", error.text()).into_bytes());
                [f64::NAN; COLUMNS]
            });
            answer.numbers.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
        }
        answer
    }
}
