//! The rows of a bulk call: bodies, poses and numbers.

use colltrans::glam::{DMat3, DQuat, DVec3};
use colltrans::solid::AsSolid;
use colltrans::{ConvexPolyhedron, Pose};

/// A body of either kind.
#[derive(Clone, Copy)]
pub(crate) enum AnyBody<'a> {
    Convex(&'a ConvexPolyhedron),
    /// A solid, and the rounding of the coordinates in its file.
    Solid(&'a colltrans::Solid, f64),
}

impl<'a> AnyBody<'a> {
    pub(crate) fn convex(self) -> Result<&'a ConvexPolyhedron, String> {
        match self {
            Self::Convex(body) => Ok(body),
            Self::Solid(..) => Err("a solid has no cast; query its clearance or distance".into()),
        }
    }

    pub(crate) fn solid(self) -> Result<&'a colltrans::Solid, String> {
        match self {
            Self::Convex(body) => body.as_surface().map_err(|what| what.to_string()),
            Self::Solid(solid, _) => Ok(solid),
        }
    }

    /// Returns the rounding of the coordinates in the body's file, a length.
    pub(crate) fn precision(self) -> f64 {
        match self {
            Self::Convex(_) => 0.0,
            Self::Solid(_, precision) => precision,
        }
    }
}

/// The body of every row, or the reason for its absence.
pub(crate) struct Bodies<'a> {
    pub(crate) name: &'static str,
    pub(crate) all: &'a [Result<AnyBody<'a>, String>],
    /// The index of the body of each row; `None` if all rows have the same body.
    pub(crate) index: Option<&'a [i64]>,
}

impl<'a> Bodies<'a> {
    pub(crate) fn get(&self, row: usize) -> Result<AnyBody<'a>, String> {
        let index = self.index.map_or(0, |index| index[row]);
        let found = usize::try_from(index).ok().and_then(|index| self.all.get(index));
        match found {
            Some(Ok(body)) => Ok(*body),
            Some(Err(why)) => Err(format!("{}: {why}", self.name)),
            None => Err(format!("{}: no body {index} among {}", self.name, self.all.len())),
        }
    }
}

/// A table with one row for each query, or one row for all.
pub(crate) struct Table<'a> {
    pub(crate) name: &'static str,
    pub(crate) numbers: &'a [f64],
    pub(crate) width: usize,
}

impl<'a> Table<'a> {
    /// Checks whether the table has one row for all queries.
    pub(crate) fn is_single(&self) -> bool {
        self.numbers.len() == self.width
    }

    pub(crate) fn row(&self, row: usize) -> &'a [f64] {
        let row = if self.is_single() { 0 } else { row };
        &self.numbers[row * self.width..(row + 1) * self.width]
    }

    /// Returns a row of three numbers.
    pub(crate) fn vector(&self, row: usize) -> DVec3 {
        DVec3::from_slice(self.row(row))
    }

    /// Iterates over the numbers of a pose that define its rotation.
    pub(crate) fn rotation(&self, row: usize) -> impl Iterator<Item = f64> + use<'a> {
        let row = self.row(row);
        // A quaternion follows a translation; in a matrix the translation is the fourth column.
        let (quaternion, matrix) =
            if row.len() > 7 { (&row[..0], &row[..12]) } else { (&row[3..], &row[..0]) };
        let columns = matrix.as_chunks::<4>().0.iter().flat_map(|[x, y, z, _]| [*x, *y, *z]);
        quaternion.iter().copied().chain(columns)
    }

    /// Reads a pose: a translation, a translation with a quaternion, or a matrix of three or four rows.
    pub(crate) fn pose(&self, row: usize) -> Result<Pose, String> {
        let of_matrix = |r: &[f64]| {
            let column = |j: usize| DVec3::new(r[j], r[4 + j], r[8 + j]);
            Pose::from_matrix(DMat3::from_cols(column(0), column(1), column(2)), column(3))
        };
        let pose = match self.row(row) {
            r @ [_, _, _] => Pose::from_translation(DVec3::from_slice(r)),
            r @ [_, _, _, x, y, z, w] => {
                Pose::new(DQuat::from_xyzw(*x, *y, *z, *w), DVec3::from_slice(r))
            }
            r if r.len() == 16 && r[12..] != [0.0, 0.0, 0.0, 1.0] => {
                let name = self.name;
                return Err(format!("{name}: the last row is {:?}, not 0, 0, 0, 1", &r[12..]));
            }
            r => of_matrix(r),
        };
        pose.map_err(|what| format!("{}: {what}", self.name))
    }
}

/// The poses of a body, one for all rows or one for each. A single pose is read once.
pub(crate) struct Poses<'a> {
    pub(crate) table: Table<'a>,
    single: Option<Result<Pose, String>>,
}

impl<'a> Poses<'a> {
    pub(crate) fn new(table: Table<'a>) -> Self {
        let single = table.is_single().then(|| table.pose(0));
        Self { table, single }
    }

    /// Returns the pose of a row.
    pub(crate) fn get(&self, row: usize) -> Result<Pose, String> {
        match &self.single {
            Some(Ok(pose)) => Ok(*pose),
            Some(Err(why)) => Err(why.clone()),
            None => self.table.pose(row),
        }
    }
}
