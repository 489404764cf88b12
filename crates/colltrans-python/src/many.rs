//! Queries in bulk: arrays in, columns out, on any number of threads, without the interpreter's lock.
//!
//! The rows are cut into chunks, each with its own part of every column; threads take chunks until
//! none is left. Threads live for one call: a pool that is kept would be lost in a forked process,
//! and starting a thread costs as much as some ten casts. Every row is answered by itself, or, where many
//! ask about the same bodies turned in the same way ([`repeats`](crate::repeats)), by what these share, so the
//! bits do not depend on the threads; and a row without an answer is one of outcome *error*, with a
//! message, even if it is a bug that ends it.
//!
//! The calling thread looks for signals ten times a second, so that Ctrl-C ends the call.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use colltrans::glam::DVec3;
use colltrans::motion::Motion;
use colltrans::record::{FeatureRecord, PairQuestion, Record};
use colltrans::{
    Cast, Clearance, Contact, ContactRange, Features, InputVertex, Options, Outcome, OverlapAhead,
    Pair, Placed, Pose, Solver, WhyFree,
};
use numpy::{
    IntoPyArray, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::coordinates;
use crate::body;
use crate::motion::{EITHER, convex_cast, solid_cast};
use crate::repeats::{Answerers, By, Repeats};
use crate::rows::{AnyBody, Bodies, Table};
use crate::solid::Solid;
use crate::solver::options_of;

/// Rows of a chunk: some hundred microseconds.
const CHUNK: usize = 256;
/// Rows between two looks at the clock.
const LOOK: usize = 16;
/// Time between two looks for signals.
const PATIENCE: Duration = Duration::from_millis(100);

/// The numbers of an answer; NaN where there is none.
#[derive(Clone, Copy)]
struct Row {
    /// An index into the question's outcomes.
    outcome: u8,
    numbers: [f64; NUMBERS.len()],
    vectors: [[f64; 3]; VECTORS.len()],
    /// The features of both bodies, if they are asked for.
    features: [Corners; 2],
}

/// The first vertices of a feature, by the numbers of the input: one of a vertex, two of an edge, three of a face;
/// -1 where there is none.
type Corners = [i64; 3];
const NO_CORNERS: Corners = [-1; 3];
/// The names of the columns of features.
const FEATURES: [&str; 2] = ["moving_feature", "fixed_feature"];

/// The names of [`Row::numbers`].
const NUMBERS: [&str; 15] = [
    "distance",
    "translation",
    "exit",
    "back",
    "on",
    "translation_lower",
    "translation_upper",
    "rounding",
    "margin",
    "exit_lower",
    "exit_upper",
    "overlap",
    "lower",
    "upper",
    "least_tolerance",
];
const DISTANCE: usize = 0;
const TRANSLATION: usize = 1;
const EXIT: usize = 2;
const BACK: usize = 3;
const ON: usize = 4;
const LOWER: usize = 5;
const UPPER: usize = 6;
const ROUNDING: usize = 7;
const MARGIN: usize = 8;
const EXIT_LOWER: usize = 9;
const EXIT_UPPER: usize = 10;
const OVERLAP: usize = 11;
const AT_LEAST: usize = 12;
const AT_MOST: usize = 13;
const LEAST_TOLERANCE: usize = 14;

/// The names of [`Row::vectors`].
const VECTORS: [&str; 5] = ["normal", "point", "on_moving", "on_fixed", "direction"];
const NORMAL: usize = 0;
const POINT: usize = 1;
const ON_MOVING: usize = 2;
const ON_FIXED: usize = 3;
const DIRECTION: usize = 4;

/// Which question is asked of every row.
#[derive(Clone, Copy)]
enum Question {
    Contact,
    Range,
    Clearance,
    Distance,
    Depth,
    Within,
    Motion,
    MotionClearance,
}

impl Question {
    fn called(name: &str) -> PyResult<Self> {
        match name {
            "contact" => Ok(Self::Contact),
            "range" => Ok(Self::Range),
            "clearance" => Ok(Self::Clearance),
            "distance" => Ok(Self::Distance),
            "depth" => Ok(Self::Depth),
            "within" => Ok(Self::Within),
            "motion" => Ok(Self::Motion),
            "motion_clearance" => Ok(Self::MotionClearance),
            _ => Err(PyValueError::new_err(format!("no question {name:?}"))),
        }
    }

    /// The columns that its answers fill.
    fn numbers(self) -> &'static [usize] {
        match self {
            Self::Contact => &[TRANSLATION, LOWER, UPPER, ROUNDING, MARGIN, OVERLAP],
            Self::Range => &[
                TRANSLATION,
                EXIT,
                LOWER,
                UPPER,
                ROUNDING,
                MARGIN,
                EXIT_LOWER,
                EXIT_UPPER,
                OVERLAP,
            ],
            Self::Clearance => &[
                DISTANCE,
                TRANSLATION,
                EXIT,
                BACK,
                ON,
                LOWER,
                UPPER,
                ROUNDING,
                MARGIN,
                EXIT_LOWER,
                EXIT_UPPER,
                OVERLAP,
            ],
            Self::Depth | Self::MotionClearance => &[AT_LEAST, AT_MOST, LEAST_TOLERANCE],
            Self::Distance | Self::Within | Self::Motion => &[AT_LEAST, AT_MOST],
        }
    }

    /// The columns of vectors that they fill.
    const fn vectors(self) -> &'static [usize] {
        match self {
            Self::Contact
            | Self::Range
            | Self::Clearance
            | Self::Motion
            | Self::MotionClearance => &[NORMAL, POINT],
            Self::Distance | Self::Within => &[NORMAL, ON_MOVING, ON_FIXED],
            Self::Depth => &[DIRECTION],
        }
    }

    /// The names of the outcomes, by their numbers; the last is *error*.
    fn outcomes(self) -> &'static [&'static str] {
        match self {
            Self::Contact | Self::Range => &["contact", "grazing", "separated", "error"],
            Self::Clearance => {
                &["blocked", "slides", "behind", "separated", "overlapping", "error"]
            }
            Self::Distance => &["apart", "meeting", "error"],
            Self::Depth => &["overlapping", "touching", "apart", "error"],
            Self::Within => &["closer", "farther", "undecided", "error"],
            Self::Motion => &["contact", "grazing", "free", "overlapping", "undecided", "error"],
            Self::MotionClearance => &["blocked", "free", "overlapping", "error"],
        }
    }

    /// `featured`: with the features that touch.
    fn ask<'a>(
        self,
        cast: &Cast<'a>,
        by: &By<'_, '_, 'a>,
        featured: bool,
    ) -> Result<Row, colltrans::QueryError> {
        let of = |outcome: u8, first: &Contact| Row::of(outcome, first, cast, featured);
        Ok(match self {
            Self::Contact => match by.first_contact(cast)? {
                Outcome::Contact(contact) => of(0, &contact),
                Outcome::Grazing(grazing) => of(1, &grazing.contact).with(OVERLAP, grazing.overlap),
                Outcome::Separated(separated) => Row::separated(2, &separated),
            },
            Self::Range => match by.contact_range(cast)? {
                ContactRange::Contact { first, last } => of(0, &first).with_exit(&last),
                ContactRange::Grazing { first, last } => {
                    of(1, &first.contact).with_exit(&last.contact).with(OVERLAP, first.overlap)
                }
                ContactRange::Separated(separated) => Row::separated(2, &separated),
            },
            // The others have no direction.
            _ => Row::clearance(&by.clearance(cast)?, cast, featured),
        })
    }
}

impl Row {
    const NONE: Self = Self {
        outcome: 0,
        numbers: [f64::NAN; NUMBERS.len()],
        vectors: [[f64::NAN; 3]; VECTORS.len()],
        features: [NO_CORNERS; 2],
    };

    fn with(mut self, which: usize, number: f64) -> Self {
        self.numbers[which] = number;
        self
    }

    fn along(mut self, which: usize, vector: [f64; 3]) -> Self {
        self.vectors[which] = vector;
        self
    }

    /// Of bodies where they are.
    fn of_record(question: Question, record: &Record) -> Self {
        let name = record.outcome.name();
        let outcome = question.outcomes().iter().position(|known| *known == name);
        let mut row = Self { outcome: outcome.unwrap_or_default() as u8, ..Self::NONE };
        let overlap = record.start_overlaps.first().and_then(|overlap| overlap.least_tolerance);
        let lower = record.lower.or(record.time.map(|time| time.lower));
        let upper = record.upper.or(record.time.and_then(|time| time.upper));
        let numbers = [(AT_LEAST, lower), (AT_MOST, upper), (LEAST_TOLERANCE, overlap)];
        for (which, number) in numbers {
            row = number.map_or(row, |number| row.with(which, number));
        }
        let [from, to] = [0, 1].map(|k| record.points.map(|points| points[k]));
        let vectors = [
            (NORMAL, record.normal),
            (POINT, record.point),
            (ON_MOVING, from),
            (ON_FIXED, to),
            (DIRECTION, record.direction),
        ];
        for (which, vector) in vectors {
            row = vector.map_or(row, |vector| row.along(which, vector));
        }
        if let Some(features) = &record.features {
            let of = |feature: &FeatureRecord| corners(feature.vertices.iter().copied());
            row.features = [of(&features.moving), of(&features.fixed)];
        }
        row
    }

    fn with_exit(self, last: &Contact) -> Self {
        let exit = last.exit();
        self.with(EXIT, exit.value).with(EXIT_LOWER, exit.lower).with(EXIT_UPPER, exit.upper)
    }

    fn of(outcome: u8, first: &Contact, cast: &Cast<'_>, featured: bool) -> Self {
        let mut row = Self { outcome, ..Self::NONE }
            .along(NORMAL, coordinates(first.normal))
            .along(POINT, coordinates(first.points(cast).on_fixed));
        if featured {
            let Features { moving, fixed } = first.features(cast);
            row.features =
                [corners(moving.vertices(cast.moving())), corners(fixed.vertices(cast.fixed()))];
        }
        let proof = &first.certificate;
        row.with(TRANSLATION, first.translation)
            .with(LOWER, proof.lower)
            .with(UPPER, proof.upper)
            .with(ROUNDING, proof.rounding)
    }

    fn separated(outcome: u8, separated: &colltrans::Separated) -> Self {
        let normal = coordinates(separated.certificate.normal);
        let row = Self { outcome, ..Self::NONE }.along(NORMAL, normal);
        row.with(MARGIN, separated.certificate.margin)
    }

    fn clearance(answer: &Clearance, cast: &Cast<'_>, featured: bool) -> Self {
        let of = |outcome: u8, first: &Contact| Self::of(outcome, first, cast, featured);
        let row = match answer {
            Clearance::Blocked { contact, .. } => of(0, contact),
            Clearance::Free(WhyFree::Slides(grazing)) => {
                of(1, &grazing.contact).with(OVERLAP, grazing.overlap)
            }
            // The last contact is the first one of the way back, whose bounds are not this way's.
            Clearance::Free(WhyFree::Behind(last)) => Self {
                numbers: Self::NONE.with(ROUNDING, last.certificate.rounding).numbers,
                ..Self::of(2, last, &cast.reversed(), featured)
            }
            .with_exit(last),
            Clearance::Free(WhyFree::Separated(separated)) => Self::separated(3, separated),
            Clearance::Overlapping(OverlapAhead { first, last }) => of(4, first)
                .with_exit(last)
                .with(BACK, -first.certificate.lower)
                .with(ON, -last.certificate.lower),
        };
        row.with(DISTANCE, answer.distance().unwrap_or(f64::NAN))
    }
}

/// The first of a feature's vertices.
fn corners(vertices: impl IntoIterator<Item = InputVertex>) -> Corners {
    let mut corners = NO_CORNERS;
    for (corner, vertex) in corners.iter_mut().zip(vertices) {
        *corner = u32::from(vertex).into();
    }
    corners
}

/// What is asked.
struct Work<'a> {
    question: Question,
    bodies: [Bodies<'a>; 2],
    poses: [Table<'a>; 2],
    with: With<'a>,
    /// Whether features are columns, too.
    featured: bool,
}

/// What a question needs besides the bodies.
enum With<'a> {
    Direction {
        directions: Table<'a>,
        graze_tolerances: Table<'a>,
        keeps: Table<'a>,
        options: Options,
    },
    Length(Table<'a>),
    Motion {
        motions: [Motions<'a>; 2],
        keeps: Table<'a>,
        /// NaN stands for none.
        tolerances: Table<'a>,
    },
}

/// What a body does in each row.
enum Motions<'a> {
    /// One for all, or one for each.
    Listed(Vec<&'a Motion>),
    /// By three numbers a slide; by eight a screw: point, axis, angle, rise; by nine what is thrown: center,
    /// velocity and angular velocity; from the pose on.
    Numbers(Table<'a>),
}

impl Motions<'_> {
    fn get(&self, row: usize, start: &Table<'_>) -> Result<Motion, String> {
        let table = match self {
            Self::Listed(all) => return Ok(all[if all.len() == 1 { 0 } else { row }].clone()),
            Self::Numbers(table) => table,
        };
        let (pose, of) = (start.pose(row)?, table.row(row));
        let three = |k: usize| DVec3::from_slice(&of[3 * k..]);
        match of {
            [_, _, _] => Motion::slide(pose, three(0)),
            [.., angle, rise] if of.len() == 8 => {
                Motion::screw(pose, three(0), three(1), *angle, *rise)
            }
            _ => Motion::thrown(pose, three(0), three(1), three(2)),
        }
        .map_err(|what| format!("{}: {what}", table.name))
    }
}

impl<'a> Work<'a> {
    /// The rows of which many have the same bodies and rotations, if that can be of use.
    fn repeats(&self, n: usize) -> Option<Repeats<'a>> {
        match &self.with {
            With::Direction { directions, keeps, options, .. } if options.solver != Solver::Cta => {
                let touches = |row: usize| keeps.row(row)[0] == 0.0;
                Some(Repeats::find(n, &self.bodies, &self.poses, directions, touches))
            }
            _ => None,
        }
    }

    fn answer(&self, row: usize, by: &By<'_, '_, 'a>) -> Result<Row, String> {
        let (moving, fixed) = (self.bodies[0].get(row)?, self.bodies[1].get(row)?);
        if let With::Motion { motions, keeps, tolerances } = &self.with {
            let of = |k: usize| motions[k].get(row, &self.poses[k]);
            let (motions, tolerance) = ([of(0)?, of(1)?], tolerances.row(row)[0]);
            let tolerance = Some(tolerance).filter(|tolerance| !tolerance.is_nan());
            let motions = motions.each_ref();
            return moved(self.question, [moving, fixed], motions, keeps.row(row)[0], tolerance);
        }
        let (at, to) = (self.poses[0].pose(row)?, self.poses[1].pose(row)?);
        let With::Direction { directions, graze_tolerances, keeps, options } = &self.with else {
            return self.answer_placed([moving, fixed], [at, to], row);
        };
        let (moving, fixed) = (moving.convex()?, fixed.convex()?);
        let options =
            options.with_graze_tolerance(graze_tolerances.row(row)[0]).with_keep(keeps.row(row)[0]);
        Cast::new(moving.at(at), fixed.at(to), directions.vector(row))
            .and_then(|cast| cast.with_options(options))
            .and_then(|cast| self.question.ask(&cast, by, self.featured))
            .map_err(|what| what.to_string())
    }

    /// Of bodies where they are.
    fn answer_placed(
        &self,
        bodies: [AnyBody<'_>; 2],
        poses: [Pose; 2],
        row: usize,
    ) -> Result<Row, String> {
        let question = match (self.question, &self.with) {
            (Question::Within, With::Length(lengths)) => PairQuestion::Within(lengths.row(row)[0]),
            (Question::Depth, _) => PairQuestion::Depth,
            _ => PairQuestion::Distance,
        };
        let record = if let [AnyBody::Convex(p), AnyBody::Convex(q)] = bodies {
            Pair::new(p.at(poses[0]), q.at(poses[1]))
                .and_then(|pair| Ok(question.ask(&pair)?.record(&pair)))
        } else {
            let placed = |k: usize| -> Result<Placed<'_, _>, String> {
                Ok(Placed { body: bodies[k].solid()?, pose: poses[k] })
            };
            Pair::new(placed(0)?, placed(1)?)
                .and_then(|pair| question.ask_solids(&pair)?.record(&pair))
        };
        let record = record.map_err(|what| what.to_string())?;
        Ok(Row::of_record(self.question, &record))
    }

    /// The answer, or what went wrong, whatever it was.
    fn answer_or_error(&self, row: usize, by: Option<&Answerers<'_, 'a>>) -> Result<Row, String> {
        let answer = || self.answer(row, &by.map_or(By::Cast, |by| by.of_row(row)));
        catch_unwind(AssertUnwindSafe(answer))
            .unwrap_or_else(|_| Err("internal error; please report it".into()))
    }
}

/// When bodies that move first meet, or how far they can go.
fn moved(
    question: Question,
    bodies: [AnyBody<'_>; 2],
    motions: [&Motion; 2],
    keep: f64,
    tolerance: Option<f64>,
) -> Result<Row, String> {
    let clears = matches!(question, Question::MotionClearance);
    let record = if let [AnyBody::Convex(p), AnyBody::Convex(q)] = bodies {
        if tolerance.is_some() && keep != 0.0 {
            return Err(EITHER.into());
        }
        convex_cast([p, q], motions, keep, tolerance).and_then(|cast| {
            Ok(if clears {
                Record::of_motion_clearance(&cast.clearance()?, &cast)
            } else {
                Record::of_motion(&cast.first_contact()?, &cast)
            })
        })
    } else {
        let solids = [bodies[0].solid()?, bodies[1].solid()?];
        let precisions = bodies.map(AnyBody::precision);
        solid_cast(solids, motions, precisions, keep, tolerance).and_then(|cast| {
            Ok(if clears {
                Record::of_solid_motion_clearance(&cast.clearance()?, &cast)
            } else {
                Record::of_solid_motion(&cast.first_contact()?, &cast)
            })
        })
    };
    record.map(|record| Row::of_record(question, &record)).map_err(|what| what.to_string())
}

/// A chunk's part of every column.
struct Part<'a> {
    first: usize,
    outcome: &'a mut [u8],
    numbers: Vec<&'a mut [f64]>,
    vectors: Vec<&'a mut [[f64; 3]]>,
    /// None, or of both bodies.
    features: Vec<&'a mut [Corners]>,
}

/// All columns.
struct Columns {
    outcome: Vec<u8>,
    numbers: Vec<Vec<f64>>,
    vectors: Vec<Vec<[f64; 3]>>,
    features: Vec<Vec<Corners>>,
}

impl Columns {
    fn new(n: usize, question: Question, featured: bool) -> Self {
        let numbers = vec![vec![0.0; n]; question.numbers().len()];
        let vectors = vec![vec![[0.0; 3]; n]; question.vectors().len()];
        let corners = vec![vec![NO_CORNERS; n]; if featured { FEATURES.len() } else { 0 }];
        Self { outcome: vec![0; n], numbers, vectors, features: corners }
    }

    fn parts(&mut self) -> Vec<Part<'_>> {
        let mut numbers: Vec<_> = self.numbers.iter_mut().map(|c| c.chunks_mut(CHUNK)).collect();
        let mut vectors: Vec<_> = self.vectors.iter_mut().map(|c| c.chunks_mut(CHUNK)).collect();
        let mut features: Vec<_> = self.features.iter_mut().map(|c| c.chunks_mut(CHUNK)).collect();
        let part = |(chunk, outcome)| Part {
            first: chunk * CHUNK,
            outcome,
            numbers: numbers.iter_mut().filter_map(Iterator::next).collect(),
            vectors: vectors.iter_mut().filter_map(Iterator::next).collect(),
            features: features.iter_mut().filter_map(Iterator::next).collect(),
        };
        self.outcome.chunks_mut(CHUNK).enumerate().map(part).collect()
    }
}

/// Rows without an answer, and why.
type Failures = Mutex<Vec<(usize, String)>>;

/// Fills a chunk, unless `stop` says not to.
fn fill<'a>(
    work: &Work<'a>,
    by: Option<&Answerers<'_, 'a>>,
    part: Part<'_>,
    failures: &Failures,
    mut stop: impl FnMut() -> bool,
) {
    let Part { first, outcome, mut numbers, mut vectors, mut features } = part;
    let error = work.question.outcomes().len() as u8 - 1;
    for i in 0..outcome.len() {
        if i % LOOK == 0 && stop() {
            return;
        }
        let row = work.answer_or_error(first + i, by).unwrap_or_else(|message| {
            let mut failures = failures.lock().unwrap_or_else(PoisonError::into_inner);
            failures.push((first + i, message));
            Row { outcome: error, ..Row::NONE }
        });
        outcome[i] = row.outcome;
        for (column, which) in numbers.iter_mut().zip(work.question.numbers()) {
            column[i] = row.numbers[*which];
        }
        for (column, which) in vectors.iter_mut().zip(work.question.vectors()) {
            column[i] = row.vectors[*which];
        }
        for (column, corners) in features.iter_mut().zip(row.features) {
            column[i] = corners;
        }
    }
}

/// Fills all chunks on some threads; what a signal raised is returned.
fn fill_all<'a>(
    work: &Work<'a>,
    by: Option<&Answerers<'_, 'a>>,
    parts: Vec<Part<'_>>,
    threads: usize,
    failures: &Failures,
) -> PyResult<()> {
    let threads = threads.clamp(1, parts.len().max(1));
    let parts = Mutex::new(parts.into_iter());
    let next = || parts.lock().unwrap_or_else(PoisonError::into_inner).next();
    let stopped = AtomicBool::new(false);
    let mut raised = Ok(());
    let mut looked = Instant::now();
    let mut look = || {
        if looked.elapsed() > PATIENCE {
            looked = Instant::now();
            raised = Python::attach(|py| py.check_signals());
            stopped.store(raised.is_err(), Ordering::Relaxed);
        }
        stopped.load(Ordering::Relaxed)
    };
    std::thread::scope(|scope| {
        for _ in 1..threads {
            scope.spawn(|| {
                while let Some(part) = next() {
                    fill(work, by, part, failures, || stopped.load(Ordering::Relaxed));
                }
            });
        }
        while let Some(part) = next() {
            fill(work, by, part, failures, &mut look);
        }
    });
    raised
}

/// The bodies of a list; exceptions in it stand for bodies that could not be built.
fn bodies<'a>(of: &'a [Bound<'_, PyAny>]) -> PyResult<Vec<Result<AnyBody<'a>, String>>> {
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

/// The columns by their names, the names of the outcomes, and the messages by their rows.
type Answered<'py> = (Bound<'py, PyDict>, &'static [&'static str], Bound<'py, PyDict>);

/// Bodies, and which one for each row.
type Side<'py> = (Vec<Bound<'py, PyAny>>, Option<PyReadonlyArray1<'py, i64>>);

/// Answers `n` queries: what `colltrans.many` calls when it has made all arguments what they have to
/// be, tables with one row or `n`.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "they are columns")]
pub(crate) fn ask_many<'py>(
    py: Python<'py>,
    n: usize,
    question: &str,
    moving: Side<'py>,
    fixed: Side<'py>,
    direction: PyReadonlyArray2<'py, f64>,
    moving_pose: PyReadonlyArray2<'py, f64>,
    fixed_pose: PyReadonlyArray2<'py, f64>,
    graze_tolerance: PyReadonlyArray2<'py, f64>,
    keep: PyReadonlyArray2<'py, f64>,
    solver: &Bound<'py, PyAny>,
    featured: bool,
    threads: Option<usize>,
) -> PyResult<Answered<'py>> {
    let with = With::Direction {
        directions: table("direction", &direction, n)?,
        graze_tolerances: table("graze_tolerance", &graze_tolerance, n)?,
        keeps: table("keep", &keep, n)?,
        options: options_of(Some(solver))?,
    };
    let question = Question::called(question)?;
    let (sides, poses) = ([&moving, &fixed], [&moving_pose, &fixed_pose]);
    answered(py, n, question, sides, poses, with, featured, threads)
}

/// The same of bodies where they are: what `colltrans.pairs` calls.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "they are columns")]
pub(crate) fn ask_pairs<'py>(
    py: Python<'py>,
    n: usize,
    question: &str,
    moving: Side<'py>,
    fixed: Side<'py>,
    moving_pose: PyReadonlyArray2<'py, f64>,
    fixed_pose: PyReadonlyArray2<'py, f64>,
    length: PyReadonlyArray2<'py, f64>,
    featured: bool,
    threads: Option<usize>,
) -> PyResult<Answered<'py>> {
    let with = With::Length(table("length", &length, n)?);
    let question = Question::called(question)?;
    let (sides, poses) = ([&moving, &fixed], [&moving_pose, &fixed_pose]);
    answered(py, n, question, sides, poses, with, featured, threads)
}

/// What bodies do: motions, or a table of numbers.
#[derive(FromPyObject)]
pub(crate) enum MotionSide<'py> {
    Listed(Vec<Bound<'py, crate::motion::Motion>>),
    Numbers(PyReadonlyArray2<'py, f64>),
}

/// The same of bodies that move: what `colltrans.motions` calls.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "they are columns")]
pub(crate) fn ask_motions<'py>(
    py: Python<'py>,
    n: usize,
    question: &str,
    moving: Side<'py>,
    fixed: Side<'py>,
    moving_motion: MotionSide<'py>,
    fixed_motion: MotionSide<'py>,
    moving_pose: PyReadonlyArray2<'py, f64>,
    fixed_pose: PyReadonlyArray2<'py, f64>,
    keep: PyReadonlyArray2<'py, f64>,
    tolerance: PyReadonlyArray2<'py, f64>,
    featured: bool,
    threads: Option<usize>,
) -> PyResult<Answered<'py>> {
    let with = With::Motion {
        motions: [
            motions("moving_motion", &moving_motion, n)?,
            motions("fixed_motion", &fixed_motion, n)?,
        ],
        keeps: table("keep", &keep, n)?,
        tolerances: table("tolerance", &tolerance, n)?,
    };
    let (sides, poses) = ([&moving, &fixed], [&moving_pose, &fixed_pose]);
    answered(py, n, Question::called(question)?, sides, poses, with, featured, threads)
}

/// One motion for all rows, or one for each.
fn motions<'a>(name: &'static str, of: &'a MotionSide<'_>, n: usize) -> PyResult<Motions<'a>> {
    match of {
        MotionSide::Numbers(numbers) => table(name, numbers, n).map(Motions::Numbers),
        MotionSide::Listed(all) if all.len() == n || all.len() == 1 => {
            Ok(Motions::Listed(all.iter().map(|motion| &motion.get().0).collect()))
        }
        MotionSide::Listed(all) => {
            Err(PyValueError::new_err(format!("{name}: {} motions", all.len())))
        }
    }
}

#[expect(clippy::too_many_arguments, reason = "they are columns")]
fn answered<'py>(
    py: Python<'py>,
    n: usize,
    question: Question,
    sides: [&Side<'py>; 2],
    poses: [&PyReadonlyArray2<'py, f64>; 2],
    with: With<'_>,
    featured: bool,
    threads: Option<usize>,
) -> PyResult<Answered<'py>> {
    let threads = threads
        .unwrap_or_else(|| std::thread::available_parallelism().map_or(1, std::num::NonZero::get));
    let all = [bodies(&sides[0].0)?, bodies(&sides[1].0)?];
    let index = [index(sides[0].1.as_ref(), n)?, self::index(sides[1].1.as_ref(), n)?];
    let work = Work {
        question,
        bodies: [
            Bodies { name: "moving", all: &all[0], index: index[0] },
            Bodies { name: "fixed", all: &all[1], index: index[1] },
        ],
        poses: [table("moving_pose", poses[0], n)?, table("fixed_pose", poses[1], n)?],
        with,
        featured,
    };
    let mut columns = Columns::new(n, question, featured);
    let failures = Failures::default();
    py.detach(|| {
        let repeats = work.repeats(n);
        let by = repeats.as_ref().map(Answerers::of);
        fill_all(&work, by.as_ref(), columns.parts(), threads, &failures)
    })?;
    let found = PyDict::new(py);
    found.set_item("outcome", columns.outcome.into_pyarray(py))?;
    for (which, column) in question.numbers().iter().zip(columns.numbers) {
        found.set_item(NUMBERS[*which], column.into_pyarray(py))?;
    }
    for (which, column) in question.vectors().iter().zip(columns.vectors) {
        let flat = column.into_flattened().into_pyarray(py);
        found.set_item(VECTORS[*which], flat.reshape([n, 3])?)?;
    }
    for (name, column) in FEATURES.iter().zip(columns.features) {
        let flat = column.into_flattened().into_pyarray(py);
        found.set_item(name, flat.reshape([n, 3])?)?;
    }
    let mut failures = failures.into_inner().unwrap_or_else(PoisonError::into_inner);
    failures.sort_unstable();
    let messages = PyDict::new(py);
    failures.into_iter().try_for_each(|(row, message)| messages.set_item(row, message))?;
    Ok((found, question.outcomes(), messages))
}

/// An index for every row.
fn index<'a>(of: Option<&'a PyReadonlyArray1<'_, i64>>, n: usize) -> PyResult<Option<&'a [i64]>> {
    let index = of.map(PyReadonlyArray1::as_slice).transpose()?;
    if index.is_some_and(|index| index.len() != n) {
        return Err(PyValueError::new_err("not an index for every row"));
    }
    Ok(index)
}

/// A table of one row or `n`.
fn table<'a>(
    name: &'static str,
    of: &'a PyReadonlyArray2<'_, f64>,
    n: usize,
) -> PyResult<Table<'a>> {
    let (rows, width) = (of.shape()[0], of.shape()[1]);
    let widths: &[usize] = match name {
        "direction" => &[3],
        "graze_tolerance" | "keep" | "length" | "tolerance" => &[1],
        "moving_motion" | "fixed_motion" => &[3, 8, 9],
        _ => &[3, 7, 12, 16],
    };
    if (rows != n && rows != 1) || !widths.contains(&width) {
        return Err(PyValueError::new_err(format!("{name}: {rows} rows of {width}")));
    }
    Ok(Table { name, numbers: of.as_slice()?, width })
}
