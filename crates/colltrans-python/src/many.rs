//! Bulk queries: arrays in, columns out.
//!
//! Each row is answered by itself, or by shared data if many rows have the same bodies and rotations
//! ([`repeats`](crate::repeats)). Therefore the bits of the answers do not depend on the number of threads.

use std::collections::HashMap;

use colltrans::glam::DVec3;
use colltrans::motion::Motion;
use colltrans::record::{Fields, MotionRecord, PairQuestion, Record};
use colltrans::{Cast, Options, Pair, Placed, Pose, Solver};
use numpy::{PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::body;
use crate::bulk::{Answered, Plan, thread_count};
use crate::columns::{ON_MOVING, Question, Row, VECTORS};
use crate::motion::{EITHER, convex_cast, solid_cast};
use crate::repeats::{Repeats, RowAnswerer, RowAnswerers};
use crate::rows::{AnyBody, Bodies, Poses, Table};
use crate::solid::Solid;
use crate::solver::options_of;

/// Number of rows in a chunk, which takes some hundred microseconds.
const CHUNK: usize = 256;

/// A bulk query with its arguments.
struct Work<'a> {
    question: Question,
    bodies: [Bodies<'a>; 2],
    poses: [Poses<'a>; 2],
    with: RowQuery<'a>,
    /// Fields of records that become columns.
    fields: Fields,
}

/// The arguments of a question besides the bodies.
enum RowQuery<'a> {
    Direction {
        directions: Table<'a>,
        graze_tolerances: Table<'a>,
        min_gaps: Table<'a>,
        options: Options,
    },
    Length(Table<'a>),
    Nothing,
    Motion {
        motions: [Motions<'a>; 2],
        min_gaps: Table<'a>,
        /// NaN stands for no tolerance.
        tolerances: Table<'a>,
    },
}

/// The motions of a body, one for each row.
enum Motions<'a> {
    /// One motion for all rows, or one for each row.
    Listed(Vec<&'a Motion>),
    /// Numbers of a motion from the pose on: three for a slide, eight for a screw (point, axis, angle, rise),
    /// nine for a throw (center, velocity, angular velocity).
    Numbers(Table<'a>),
}

impl Motions<'_> {
    fn get(&self, row: usize, start: &Poses<'_>) -> Result<Motion, String> {
        let table = match self {
            Self::Listed(all) => return Ok(all[if all.len() == 1 { 0 } else { row }].clone()),
            Self::Numbers(table) => table,
        };
        let (pose, of) = (start.get(row)?, table.row(row));
        let three = |k: usize| DVec3::from_slice(&of[3 * k..]);
        match of {
            [_, _, _] => Motion::translation(pose, three(0)),
            [.., angle, rise] if of.len() == 8 => {
                Motion::screw(pose, three(0), three(1), *angle, *rise)
            }
            _ => Motion::free_flight(pose, three(0), three(1), three(2)),
        }
        .map_err(|what| format!("{}: {what}", table.name))
    }
}

impl<'a> Work<'a> {
    /// Finds rows with the same bodies and rotations; `None` if they cannot share data.
    fn repeats(&self, n: usize, threads: usize) -> Option<Repeats<'a>> {
        match &self.with {
            RowQuery::Direction { directions, min_gaps, options, .. }
                if options.solver != Solver::Cta =>
            {
                let touches = |row: usize| min_gaps.row(row)[0] == 0.0;
                Some(Repeats::find(n, &self.bodies, &self.poses, directions, threads, touches))
            }
            _ => None,
        }
    }

    /// Answers a row and writes the answer to `to`.
    fn answer(
        &self,
        row: usize,
        by: &RowAnswerer<'_, '_, 'a>,
        to: &mut Row<'_>,
    ) -> Result<(), String> {
        let (moving, fixed) = (self.bodies[0].get(row)?, self.bodies[1].get(row)?);
        if let RowQuery::Motion { motions, min_gaps, tolerances } = &self.with {
            let of = |k: usize| motions[k].get(row, &self.poses[k]);
            let (motions, tolerance) = ([of(0)?, of(1)?], tolerances.row(row)[0]);
            let tolerance = Some(tolerance).filter(|tolerance| !tolerance.is_nan());
            let (bodies, min_gap) = ([moving, fixed], min_gaps.row(row)[0]);
            let record =
                answer_moving(self.question, bodies, motions.each_ref(), min_gap, tolerance)?;
            to.set_motion(self.question, &record);
            return Ok(());
        }
        let poses = [self.poses[0].get(row)?, self.poses[1].get(row)?];
        if matches!(self.question, Question::Intersects) {
            let meets = do_intersect([moving, fixed], poses)?;
            to.set_outcome(u8::from(!meets));
            return Ok(());
        }
        let RowQuery::Direction { directions, graze_tolerances, min_gaps, options } = &self.with
        else {
            let record = self.answer_placed([moving, fixed], poses, row)?;
            to.set_record(self.question, &record);
            return Ok(());
        };
        let (moving, fixed) = (moving.convex()?, fixed.convex()?);
        let options = options
            .with_graze_tolerance(graze_tolerances.row(row)[0])
            .with_min_gap(min_gaps.row(row)[0]);
        Cast::new(moving.at(poses[0]), fixed.at(poses[1]), directions.vector(row))
            .and_then(|cast| cast.with_options(options))
            .and_then(|cast| self.question.answer_row(&cast, by, to))
            .map_err(|what| what.to_string())
    }

    /// Answers a question about two bodies at fixed poses.
    fn answer_placed(
        &self,
        bodies: [AnyBody<'_>; 2],
        poses: [Pose; 2],
        row: usize,
    ) -> Result<Record, String> {
        let question = match (self.question, &self.with) {
            (Question::Within, RowQuery::Length(lengths)) => {
                PairQuestion::Within(lengths.row(row)[0])
            }
            (Question::Depth, _) => PairQuestion::Depth,
            _ => PairQuestion::Distance,
        };
        let record = if let [AnyBody::Convex(p), AnyBody::Convex(q)] = bodies {
            Pair::new(p.at(poses[0]), q.at(poses[1]))
                .and_then(|pair| question.record(&pair, &self.fields))
        } else {
            let placed = |k: usize| -> Result<Placed<'_, _>, String> {
                Ok(Placed { body: bodies[k].solid()?, pose: poses[k] })
            };
            Pair::new(placed(0)?, placed(1)?)
                .and_then(|pair| question.answer_solids(&pair)?.record(&pair))
        };
        record.map_err(|what| what.to_string())
    }
}

/// Checks whether two bodies meet. The answer does not depend on the direction of the cast.
fn do_intersect(bodies: [AnyBody<'_>; 2], poses: [Pose; 2]) -> Result<bool, String> {
    let meets = if let [AnyBody::Convex(p), AnyBody::Convex(q)] = bodies {
        Cast::new(p.at(poses[0]), q.at(poses[1]), DVec3::X)
            .and_then(|cast| Ok(cast.intersects()?.meets))
    } else {
        let solids = [bodies[0].solid()?, bodies[1].solid()?];
        Cast::new(solids[0].at(poses[0]), solids[1].at(poses[1]), DVec3::X)
            .and_then(|cast| Ok(cast.intersects()?.meets))
    };
    meets.map_err(|what| what.to_string())
}

/// Computes the first contact of two moving bodies, or the clearance of their motion.
fn answer_moving(
    question: Question,
    bodies: [AnyBody<'_>; 2],
    motions: [&Motion; 2],
    min_gap: f64,
    tolerance: Option<f64>,
) -> Result<MotionRecord, String> {
    let clears = matches!(question, Question::MotionClearance);
    let record = if let [AnyBody::Convex(p), AnyBody::Convex(q)] = bodies {
        if tolerance.is_some() && min_gap != 0.0 {
            return Err(EITHER.into());
        }
        convex_cast([p, q], motions, min_gap, tolerance).and_then(|cast| {
            Ok(if clears {
                MotionRecord::of_clearance(&cast.clearance()?, &cast)
            } else {
                MotionRecord::from_outcome(&cast.first_contact()?, &cast)
            })
        })
    } else {
        let solids = [bodies[0].solid()?, bodies[1].solid()?];
        let precisions = bodies.map(AnyBody::precision);
        solid_cast(solids, motions, precisions, min_gap, tolerance).and_then(|cast| {
            Ok(if clears {
                MotionRecord::of_solid_clearance(&cast.clearance()?, &cast)
            } else {
                MotionRecord::of_solids(&cast.first_contact()?, &cast)
            })
        })
    };
    record.map_err(|what| what.to_string())
}

/// Returns the bodies of a list. An exception in the list stands for a body that could not be built.
fn read_bodies<'a>(of: &'a [Bound<'_, PyAny>]) -> PyResult<Vec<Result<AnyBody<'a>, String>>> {
    let body = |item: &'a Bound<'_, PyAny>| {
        if item.is_instance_of::<pyo3::exceptions::PyException>() {
            return Ok(Err(item.to_string()));
        }
        if let Ok(solid) = item.cast::<Solid>() {
            let solid = solid.get();
            return Ok(Ok(AnyBody::Solid(&solid.solid, solid.precision)));
        }
        Ok(Ok(AnyBody::Convex(&item.cast::<body::ConvexPolyhedron>()?.get().0)))
    };
    of.iter().map(body).collect()
}

/// The bodies of one side, and the index of the body of each row.
type Side<'py> = (Vec<Bound<'py, PyAny>>, Option<PyReadonlyArray1<'py, i64>>);

/// An argument of a bulk query: a table of numbers, or motions.
#[derive(FromPyObject)]
pub(crate) enum Argument<'py> {
    // First, because an empty array also converts to an empty list of motions.
    Numbers(PyReadonlyArray2<'py, f64>),
    Motions(Vec<Bound<'py, crate::motion::Motion>>),
}

/// Answers `n` queries, whose arguments are tables of one row or `n` (`colltrans.queries` makes them).
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "the Python caller passes each part of a query")]
pub(crate) fn ask_many<'py>(
    py: Python<'py>,
    question: &str,
    n: usize,
    moving: Side<'py>,
    fixed: Side<'py>,
    tables: HashMap<String, Argument<'py>>,
    solver: &Bound<'py, PyAny>,
    columns: Vec<String>,
    featured: bool,
    threads: Option<usize>,
) -> PyResult<Answered<'py>> {
    let question = Question::from_name(question)?;
    let table = |name: &'static str| read_numbers(name, &tables, n);
    let with = match question {
        Question::Contact | Question::Range | Question::Clearance => RowQuery::Direction {
            directions: table("direction")?,
            graze_tolerances: table("graze_tolerance")?,
            min_gaps: table("min_gap")?,
            options: options_of(Some(solver))?,
        },
        Question::Within => RowQuery::Length(table("length")?),
        Question::Distance | Question::Depth | Question::Intersects => RowQuery::Nothing,
        Question::Motion | Question::MotionClearance => RowQuery::Motion {
            motions: [
                read_motions("moving_motion", &tables, n)?,
                read_motions("fixed_motion", &tables, n)?,
            ],
            min_gaps: table("min_gap")?,
            tolerances: table("tolerance")?,
        },
    };
    let all = [read_bodies(&moving.0)?, read_bodies(&fixed.0)?];
    let index = [read_index(moving.1.as_ref(), n)?, self::read_index(fixed.1.as_ref(), n)?];
    let work = Work {
        question,
        bodies: [
            Bodies { name: "moving", all: &all[0], index: index[0] },
            Bodies { name: "fixed", all: &all[1], index: index[1] },
        ],
        poses: [Poses::new(table("moving_pose")?), Poses::new(table("fixed_pose")?)],
        with,
        fields: record_fields(&columns, featured),
    };
    let repeats = py.detach(|| work.repeats(n, thread_count(threads)));
    let by = repeats.as_ref().map(RowAnswerers::new);
    let outcomes = question.outcomes();
    let plan = Plan { rows: n, chunk: CHUNK, columns: &columns, featured, outcomes, threads };
    plan.run(py, |row, to| {
        let by = by.as_ref().map_or(RowAnswerer::Cast, |by| by.for_row(row));
        work.answer(row, &by, to)
    })
}

/// Returns the fields of records that become these columns.
fn record_fields(columns: &[String], featured: bool) -> Fields {
    let points = columns.iter().any(|name| name == VECTORS[ON_MOVING]).then(|| "points".into());
    let vertices = featured.then(|| "features".into());
    // The overlaps of solids become the column of their least tolerance.
    let more = [points, vertices, Some("start_overlaps".into())].into_iter().flatten();
    Fields::from_names(columns.iter().cloned().chain(more))
}

/// The arguments by name.
type Arguments<'py> = HashMap<String, Argument<'py>>;

fn find_argument<'a, 'py>(name: &str, of: &'a Arguments<'py>) -> PyResult<&'a Argument<'py>> {
    of.get(name).ok_or_else(|| PyValueError::new_err(format!("{name} is missing")))
}

/// Returns one motion for all rows, one for each row, or the numbers of the motions.
fn read_motions<'a>(name: &'static str, of: &'a Arguments<'_>, n: usize) -> PyResult<Motions<'a>> {
    match find_argument(name, of)? {
        Argument::Motions(all) if all.len() == n || all.len() == 1 => {
            Ok(Motions::Listed(all.iter().map(|motion| &motion.get().0).collect()))
        }
        Argument::Motions(all) => {
            Err(PyValueError::new_err(format!("{name}: {} motions", all.len())))
        }
        Argument::Numbers(_) => read_numbers(name, of, n).map(Motions::Numbers),
    }
}

/// Returns the body index of every row.
fn read_index<'a>(
    of: Option<&'a PyReadonlyArray1<'_, i64>>,
    n: usize,
) -> PyResult<Option<&'a [i64]>> {
    let index = of.map(PyReadonlyArray1::as_slice).transpose()?;
    if index.is_some_and(|index| index.len() != n) {
        return Err(PyValueError::new_err("not an index for every row"));
    }
    Ok(index)
}

/// Returns a table with one row or `n` rows.
fn read_numbers<'a>(name: &'static str, of: &'a Arguments<'_>, n: usize) -> PyResult<Table<'a>> {
    let Argument::Numbers(numbers) = find_argument(name, of)? else {
        return Err(PyValueError::new_err(format!("{name} is not a table of numbers")));
    };
    let (rows, width) = (numbers.shape()[0], numbers.shape()[1]);
    let widths: &[usize] = match name {
        "direction" => &[3],
        "graze_tolerance" | "min_gap" | "length" | "tolerance" => &[1],
        "moving_motion" | "fixed_motion" => &[3, 8, 9],
        _ => &[3, 7, 12, 16],
    };
    if (rows != n && rows != 1) || !widths.contains(&width) {
        return Err(PyValueError::new_err(format!("{name}: {rows} rows of {width}")));
    }
    Ok(Table { name, numbers: numbers.as_slice()?, width })
}
