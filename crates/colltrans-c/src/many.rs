//! Many poses of two bodies: tables in, columns out, on several threads.
//!
//! Each row is answered by itself, so the bits do not depend on the threads. A panic is the failure of its row. If all rows of convex bodies have the same
//! rotations and there are enough of them, [`FixedRotations`] answers the casts from the faces of the Minkowski
//! difference; for a single direction, its map.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread::{Builder, available_parallelism};

use colltrans::glam::DVec3;
use colltrans::{ByKind, FixedRotations, Solver};

use crate::answer::{CastAnswer, CastColumns, DistanceAnswer, DistanceColumns};
use crate::body::{Body, Placement, Pose, bodies};
use crate::cast::{CastOptions, CastQuery};
use crate::error::{Failure, Fallible, Status, array, caught, check_room, guard, reference};
use crate::pair::{distance_of, pair};

/// Number of rows that a thread takes at a time. They take some hundred microseconds.
const CHUNK: usize = 256;

/// Maximum number of threads.
const MOST_THREADS: usize = 1024;

/// Rows of a table of queries about two bodies.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct Rows {
    /// Number of rows.
    pub count: usize,
    /// Poses of the moving body.
    pub moving_poses: *const Pose,
    /// Number of these poses: `count`, 1 for all rows, or 0 for the identity.
    pub moving_pose_count: usize,
    /// Poses of the fixed body.
    pub fixed_poses: *const Pose,
    /// Number of these poses: `count`, 1 for all rows, or 0 for the identity.
    pub fixed_pose_count: usize,
    /// Directions of casts, three numbers each.
    pub directions: *const f64,
    /// Number of directions: `count`, or 1 for all rows. Distances have none; an empty table needs none.
    pub direction_count: usize,
    /// Number of threads, at most 1024; 0 takes one for each processor. If the system refuses a thread, fewer are used.
    pub threads: u32,
}

/// A table of `count` rows, of one row for all, or empty.
#[derive(Clone, Copy)]
struct Table<'a, T> {
    name: &'static str,
    rows: &'a [T],
}

impl<'a, T> Table<'a, T> {
    unsafe fn read(
        pointer: *const T,
        count: usize,
        rows: usize,
        name: &'static str,
    ) -> Fallible<Self> {
        if count > 1 && count != rows {
            let what = format_args!("{count} for {rows} rows; accepted: one for each row, or 1");
            return Err(Failure::invalid(name, what));
        }
        // SAFETY: the caller passes as many elements as the count states.
        Ok(Self { name, rows: unsafe { array(pointer, count, name) }? })
    }

    fn get(&self, row: usize) -> Option<&'a T> {
        self.rows.get(if self.rows.len() > 1 { row } else { 0 })
    }
}

impl Table<'_, Pose> {
    fn pose(&self, row: usize) -> Fallible<colltrans::Pose> {
        self.get(row).map_or(Ok(colltrans::Pose::IDENTITY), |pose| pose.checked(self.name))
    }

    /// Checks whether all rotations have the same bits.
    fn has_one_rotation(&self) -> bool {
        let bits = |pose: &Pose| pose.rotation.map(f64::to_bits);
        self.rows.iter().all(|pose| bits(pose) == bits(&self.rows[0]))
    }
}

/// The bodies and the tables of a bulk query.
struct Work<'a> {
    bodies: [&'a Body; 2],
    poses: [Table<'a, Pose>; 2],
    directions: Table<'a, [f64; 3]>,
    count: usize,
    threads: usize,
}

impl<'a> Work<'a> {
    unsafe fn read(
        moving: *const Body,
        fixed: *const Body,
        rows: *const Rows,
        has_direction: bool,
    ) -> Fallible<Self> {
        // SAFETY: the caller keeps the invariants of the crate.
        unsafe {
            let bodies = bodies(moving, fixed)?;
            let rows = reference(rows, "rows")?;
            let count = rows.count;
            let poses = [
                Table::read(rows.moving_poses, rows.moving_pose_count, count, "rows.moving_poses")?,
                Table::read(rows.fixed_poses, rows.fixed_pose_count, count, "rows.fixed_poses")?,
            ];
            let (pointer, given) = (rows.directions.cast(), rows.direction_count);
            let directions = Table::read(pointer, given, count, "rows.directions")?;
            let fits = if has_direction { given > 0 || count == 0 } else { given == 0 };
            if !fits {
                let accepted = if has_direction { "one for each row, or 1" } else { "0" };
                let what = format_args!("{given} directions; accepted: {accepted}");
                return Err(Failure::invalid("rows.directions", what));
            }
            let all = || available_parallelism().map_or(1, usize::from);
            let threads = if rows.threads == 0 { all() } else { rows.threads as usize };
            Ok(Self { bodies, poses, directions, count, threads })
        }
    }

    fn placed(&self, row: usize) -> Fallible<Placement<'a>> {
        let [moving, fixed] = self.bodies;
        Ok(Placement {
            moving: &moving.body,
            moving_pose: self.poses[0].pose(row)?,
            fixed: &fixed.body,
            fixed_pose: self.poses[1].pose(row)?,
        })
    }

    fn direction(&self, row: usize) -> DVec3 {
        DVec3::from_array(self.directions.get(row).copied().unwrap_or_default())
    }

    /// Returns the data that all rows share, if they have the same rotations and there are enough of them.
    fn rotations(&self, options: &CastOptions) -> Fallible<Option<FixedRotations<'a>>> {
        let shares = options.min_gap == 0.0
            && options.convex()?.solver != Solver::Cta
            && self.poses.iter().all(Table::has_one_rotation);
        if self.count == 0 || !shares {
            return Ok(None);
        }
        // `run` reports a row that is invalid.
        let placed = self.placed(0).ok().and_then(|placed| placed.convex());
        let Some([moving, fixed]) = placed else { return Ok(None) };
        let pays = FixedRotations::break_even_casts(moving.body, fixed.body)
            .is_some_and(|least| self.count >= least);
        Ok(pays.then(|| FixedRotations::new(moving, fixed)))
    }

    /// Answers all rows, and writes their answers to the columns. Returns the failure of the first row that has one.
    unsafe fn run<C: Columns>(
        &self,
        columns: *const C,
        answer: impl Fn(usize) -> Fallible<C::Answer> + Sync,
    ) -> Fallible<()> {
        // SAFETY: the caller keeps the invariants of the crate.
        let columns = Shared(unsafe { reference(columns, "columns") }?);
        columns.get().check(self.count)?;
        let failed: Mutex<Option<(usize, Failure)>> = Mutex::default();
        let next = AtomicUsize::new(0);
        let work = || {
            loop {
                let first = next.fetch_add(CHUNK, Ordering::Relaxed);
                if first >= self.count {
                    return;
                }
                for row in first..self.count.min(first + CHUNK) {
                    let (status, found) = match caught(|| answer(row)) {
                        Ok(found) => (Status::Ok, found),
                        Err(failure) => {
                            let status = failure.status();
                            let mut failed = failed.lock().unwrap_or_else(PoisonError::into_inner);
                            if failed.as_ref().is_none_or(|(earlier, _)| row < *earlier) {
                                *failed = Some((row, failure));
                            }
                            (status, C::WITHOUT_ANSWER)
                        }
                    };
                    // SAFETY: the columns have room for all rows, and no other thread has this row.
                    unsafe { columns.get().write(row, status, &found) };
                }
            }
        };
        let threads = self.threads.min(self.count.div_ceil(CHUNK)).min(MOST_THREADS);
        std::thread::scope(|scope| {
            // Without another thread, those that run answer its rows.
            let _all = (1..threads).all(|_| Builder::new().spawn_scoped(scope, work).is_ok());
            work();
        });
        match failed.into_inner().unwrap_or_else(PoisonError::into_inner) {
            Some((row, failure)) => Err(failure.within(format_args!("row {row}"))),
            None => Ok(()),
        }
    }
}

/// Columns that several threads write, each in rows of its own.
struct Shared<'a, C>(&'a C);

// SAFETY: `Work::run` gives each row to one thread, and rows do not overlap in a column.
unsafe impl<C> Sync for Shared<'_, C> {}

impl<'a, C> Shared<'a, C> {
    fn get(&self) -> &'a C {
        self.0
    }
}

/// Columns for one kind of answers.
trait Columns: Copy {
    type Answer;
    const WITHOUT_ANSWER: Self::Answer;

    /// Checks the pointers.
    fn check(&self, rows: usize) -> Fallible<()>;
    /// Writes a row to the columns that are not null.
    unsafe fn write(&self, row: usize, status: Status, answer: &Self::Answer);
}

/// Writes an element of a column that is not null.
unsafe fn put<T>(column: *mut T, row: usize, value: T) {
    if !column.is_null() {
        // SAFETY: the column has room for this row.
        unsafe { column.add(row).write(value) }
    }
}

fn check_column<T>(column: *mut T, rows: usize, name: &str) -> Fallible<()> {
    if column.is_null() || rows == 0 { Ok(()) } else { check_room(column, rows, name) }
}

macro_rules! columns {
    ($columns:ident, $answer:ident: $($number:ident)*; $($vector:ident)*) => {
        impl Columns for $columns {
            type Answer = $answer;
            const WITHOUT_ANSWER: $answer = $answer::NONE;

            fn check(&self, rows: usize) -> Fallible<()> {
                check_column(self.status, rows, "columns.status")?;
                $(check_column(self.$number, rows, concat!("columns.", stringify!($number)))?;)*
                $(
                    let vectors: *mut [f64; 3] = self.$vector.cast();
                    check_column(vectors, rows, concat!("columns.", stringify!($vector)))?;
                )*
                Ok(())
            }

            unsafe fn write(&self, row: usize, status: Status, answer: &$answer) {
                // SAFETY: the caller has checked the columns.
                unsafe {
                    put(self.status, row, status);
                    $(put(self.$number, row, answer.$number);)*
                    $(put::<[f64; 3]>(self.$vector.cast(), row, answer.$vector);)*
                }
            }
        }
    };
}
columns! { CastColumns, CastAnswer:
    outcome distance translation translation_lower translation_upper exit exit_lower exit_upper back on overlap margin
    rounding tolerance least_tolerance moving_feature fixed_feature;
    normal point_on_moving point_on_fixed
}
columns! { DistanceColumns, DistanceAnswer:
    outcome lower upper moving_feature fixed_feature;
    normal point_on_moving point_on_fixed
}

/// Answers a query by data that rows share, [`FixedRotations`] or a map for one direction.
macro_rules! answer_by {
    ($data:expr, $query:expr, $cast:expr, $featured:expr, $to:expr) => {
        match $query {
            CastQuery::FirstContact => {
                $to.set_outcome(&$data.first_contact($cast)?, $cast, $featured);
            }
            CastQuery::ContactRange => {
                $to.set_range(&$data.contact_range($cast)?, $cast, $featured);
            }
            CastQuery::Clearance => {
                $to.set_clearance(&$data.clearance($cast)?, $cast, $featured);
            }
        }
    };
}

/// Answers a table of casts.
unsafe fn cast_many(
    query: CastQuery,
    moving: *const Body,
    fixed: *const Body,
    rows: *const Rows,
    options: *const CastOptions,
    columns: *const CastColumns,
) -> Status {
    guard(|| unsafe {
        let work = Work::read(moving, fixed, rows, true)?;
        let options = CastOptions::read(options)?;
        let rotations = work.rotations(options)?;
        let one_direction = work.directions.rows.len() == 1;
        let map = rotations.as_ref().filter(|_| one_direction);
        let map = map.and_then(|rotations| rotations.for_direction(work.direction(0)).ok());
        work.run(columns, |row| {
            let cast = options.cast(&work.placed(row)?, work.direction(row))?;
            let featured = options.features != 0;
            let mut to = CastAnswer::NONE;
            match (&cast, &map, &rotations) {
                (ByKind::Convex(cast), Some(map), _) => {
                    answer_by!(map, query, cast, featured, to);
                }
                (ByKind::Convex(cast), None, Some(rotations)) => {
                    answer_by!(rotations, query, cast, featured, to);
                }
                _ => query.answer(&cast, featured, (&mut to).into())?,
            }
            Ok(to)
        })
    })
}

/// Finds the first contact of each row, as `colltrans_first_contact`.
///
/// From some hundred rows with equal rotations on, convex bodies share data between rows. The last digits, and the plane
/// of separated bodies, may then differ from those of single calls.
///
/// A row without an answer has its status in the column `status`, and the outcome `COLLTRANS_ERROR`. The call then
/// returns the status of the first such row, and all other rows have their answers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_first_contact_many(
    moving: *const Body,
    fixed: *const Body,
    rows: *const Rows,
    options: *const CastOptions,
    columns: *const CastColumns,
) -> Status {
    unsafe { cast_many(CastQuery::FirstContact, moving, fixed, rows, options, columns) }
}

/// Finds the first and the last contact of each row. Rows without an answer are those of
/// `colltrans_first_contact_many`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_contact_range_many(
    moving: *const Body,
    fixed: *const Body,
    rows: *const Rows,
    options: *const CastOptions,
    columns: *const CastColumns,
) -> Status {
    unsafe { cast_many(CastQuery::ContactRange, moving, fixed, rows, options, columns) }
}

/// Finds the clearance of each row. Rows without an answer are those of `colltrans_first_contact_many`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_clearance_many(
    moving: *const Body,
    fixed: *const Body,
    rows: *const Rows,
    options: *const CastOptions,
    columns: *const CastColumns,
) -> Status {
    unsafe { cast_many(CastQuery::Clearance, moving, fixed, rows, options, columns) }
}

/// Computes the distance of each row. Rows without an answer are those of `colltrans_first_contact_many`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_distance_many(
    moving: *const Body,
    fixed: *const Body,
    rows: *const Rows,
    columns: *const DistanceColumns,
) -> Status {
    guard(|| unsafe {
        let work = Work::read(moving, fixed, rows, false)?;
        work.run(columns, |row| distance_of(&pair(&work.placed(row)?)?))
    })
}

#[cfg(test)]
mod tests {
    use std::ptr::null_mut;

    use super::*;
    use crate::body::colltrans_convex_cuboid;

    #[test]
    fn a_panic_is_the_failure_of_its_row() {
        let (low, high, mut body) = ([0.0; 3], [1.0; 3], null_mut());
        // SAFETY: the pointers are to numbers and to a handle that lives until the end.
        let body = unsafe {
            let status = colltrans_convex_cuboid(low.as_ptr(), high.as_ptr(), &raw mut body);
            assert_eq!(status, Status::Ok);
            Box::from_raw(body)
        };
        let poses = [Table { name: "poses", rows: &[] }; 2];
        let directions = Table { name: "directions", rows: &[] };
        let count = 2 * CHUNK;
        let work = Work { bodies: [&body; 2], poses, directions, count, threads: usize::MAX };
        let mut status = vec![Status::NullArgument; count];
        let mut columns: DistanceColumns = unsafe { std::mem::zeroed() };
        columns.status = status.as_mut_ptr();
        let failed = unsafe {
            work.run(&raw const columns, |row| {
                assert!(row != 3 && row != CHUNK, "row of the test");
                Ok(DistanceAnswer::NONE)
            })
        };
        let failed = failed.expect_err("two rows have no answer");
        assert_eq!(failed.status(), Status::InternalError);
        for (row, status) in status.into_iter().enumerate() {
            let panics = row == 3 || row == CHUNK;
            assert_eq!(status, if panics { Status::InternalError } else { Status::Ok }, "{row}");
        }
    }
}
