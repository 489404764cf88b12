//! Answers one line of a batch: parses the query, finds its bodies, writes the result.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use colltrans::glam::{DQuat, DVec3};
use colltrans::motion::Motion;
use colltrans::record::{Fields, PairQuestion, Question, Record};
use colltrans::{Cast, ConvexPolyhedron, Options, Pair, Pose, PoseError, Solver, cta};
use colltrans_assembly_io::read::json_error_reason;
use colltrans_mesh::body::{BodyKind, LoadError};
use serde::Deserialize;
use serde_json::value::RawValue;

use super::cache::{BuildResult, Cache, Key, Shape};
use super::fast_path;
use super::motion::{self, MotionSource};
use super::pipeline::Line;
use super::recent::Recent;
use super::source::{BodySource, PoseSource, Query, QueryName, raw_value};
use crate::args::{BodyArguments, normalised_pose_note};
use crate::body::{self, Part};
use crate::case;
use crate::inputs::ReplacedFile;
use crate::record::Line as AnswerLine;
use crate::solid::{self, PartsMotion, PartsPair, PartsQuery};

/// The state that all lines of a batch share.
pub(crate) struct Batch {
    /// The folder to which paths of meshes are relative.
    pub(crate) folder: PathBuf,
    /// Whether meshes are replaced by their hulls, unless the query specifies it.
    pub(crate) hull: bool,
    pub(crate) body: BodyArguments,
    /// The fields of results that are written.
    pub(crate) written: Fields,
    /// The fields of records that are computed.
    pub(crate) computed: Fields,
    pub(crate) cache: Cache,
    /// The file that the results will replace.
    pub(crate) replaced_file: ReplacedFile,
}

/// Parses only the id of an invalid query.
#[derive(Deserialize)]
struct IdOnly<'a> {
    #[serde(borrow, default, deserialize_with = "raw_value")]
    id: Option<&'a RawValue>,
}

impl Batch {
    /// Appends the result of a line as JSON. Returns whether it is an answer.
    pub(crate) fn answer(
        &self,
        number: u64,
        line: Line<'_>,
        recent: &mut Recent,
        results: &mut Vec<u8>,
    ) -> bool {
        let (id, answer) = match line {
            Line::Text(text) => self.answer_line(number, text, recent),
            Line::TooLong => {
                (None, Err(format!("line {number}: is longer than the accepted 64 MiB")))
            }
        };
        let mut line = answer.unwrap_or_else(AnswerLine::from_error);
        line.keep_fields(&self.written);
        line.write_with_id(id, results);
        !line.is_error()
    }

    /// Returns the id of a line, if it has one, and its answer.
    fn answer_line<'a>(
        &self,
        number: u64,
        text: &'a [u8],
        recent: &mut Recent,
    ) -> (Option<&'a RawValue>, Result<AnswerLine, String>) {
        // Some editors write a byte order mark at the start of a file.
        let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
        let usual = str::from_utf8(text).ok().and_then(fast_path::parse_usual_line);
        if let Some(query) = usual
            && let Some(answer) = self.answer_usual(number, &query, recent)
        {
            return (query.id, answer);
        }
        match serde_json::from_slice::<Query<'_, BodySource>>(text) {
            Ok(query) => {
                let bodies = || [&query.moving, &query.fixed].map(|source| self.build_body(source));
                (query.id, catch_panic(number, || self.answer_with_notes(&query, bodies())))
            }
            Err(error) => {
                let id = serde_json::from_slice::<IdOnly<'_>>(text).ok().and_then(|only| only.id);
                (id, Err(syntax_error_message(number, &error)))
            }
        }
    }

    /// Answers a query of the usual form. Returns `None` if the text of a body is invalid: `serde_json` then parses the whole
    /// line, so that the error has the right position.
    fn answer_usual(
        &self,
        number: u64,
        query: &Query<'_, &str>,
        recent: &mut Recent,
    ) -> Option<Result<AnswerLine, String>> {
        let answer = catch_panic(number, || {
            let moving = self.cached_body(query.moving, recent);
            let fixed = self.cached_body(query.fixed, recent);
            let (Some(moving), Some(fixed)) = (moving, fixed) else { return Ok(None) };
            self.answer_with_notes(query, [moving, fixed]).map(Some)
        });
        answer.transpose()
    }

    /// Answers a query. Appends notes about quaternions that were normalised.
    fn answer_with_notes<B>(
        &self,
        query: &Query<'_, B>,
        bodies: [BuildResult; 2],
    ) -> Result<AnswerLine, String> {
        let mut answer = answer_query(query, bodies, &self.computed)?;
        answer.notes.extend(query.pose_notes());
        Ok(answer)
    }

    /// Returns the body with this text; `None` if the text is invalid.
    fn cached_body(&self, text: &str, recent: &mut Recent) -> Option<BuildResult> {
        if let Some(shape) = recent.find(text) {
            return Some(Ok(shape));
        }
        let built = self.build_body(&serde_json::from_str(text).ok()?);
        if let Ok(shape) = &built {
            recent.insert(text, shape);
        }
        Some(built)
    }

    /// Returns the body of a source, from the cache if possible.
    ///
    /// # Errors
    /// The fields contradict each other, the file cannot be read, or no body of this kind can be built.
    pub(crate) fn build_body(&self, source: &BodySource) -> BuildResult {
        let &BodySource { ref points, ref mesh, ref solid, open, hull, scale, .. } = source;
        let round = source.round_shape()?;
        let (points, radius) = match &round {
            Some((points, radius)) => (Some(&points[..]), *radius),
            None => (points.as_deref(), source.radius.unwrap_or(0.0)),
        };
        if open.is_some() && solid.is_none() {
            return Err("`open` requires a `solid`".into());
        }
        match (points, mesh, solid) {
            (Some(points), None, None) if hull.is_none() && scale.is_none() => {
                let bits = points.iter().map(|p| p.map(f64::to_bits)).collect();
                let key = Key::Points { points: bits, radius: radius.to_bits() };
                self.cache.get_or_build(key, |_| hull_of_points(points, radius))
            }
            (Some(_), None, None) => Err("`hull` and `scale` require a `mesh`".into()),
            (None, Some(path), None) => {
                self.build_mesh(path, hull.unwrap_or(self.hull), checked_scale(scale)?, radius)
            }
            (None, None, Some(path)) if hull.is_none() => {
                self.build_solid(path, checked_scale(scale)?, open.unwrap_or_default(), radius)
            }
            (None, None, Some(_)) => Err("`hull` requires a `mesh`".into()),
            _ => {
                Err("a body needs exactly one of `points`, `sphere`, `capsule`, `mesh` and `solid`"
                    .into())
            }
        }
    }

    /// Returns the solid of a mesh file.
    fn build_solid(&self, path: &Path, scale: f64, open: bool, radius: f64) -> BuildResult {
        let path = self.folder.join(path);
        let [scale_bits, radius_bits] = [scale, radius].map(f64::to_bits);
        let key = Key::Solid { path: path.clone(), scale: scale_bits, open, radius: radius_bits };
        self.cache.get_or_build(key, |_| {
            self.replaced_file.record_read(&path);
            let options = self.body.options(scale).with_open(open);
            let body = solid::Body::load(&[path], &options, || ())?;
            Ok(Arc::new(Shape::Solid(body.rounded(radius)?)))
        })
    }

    /// Returns the convex body of a mesh file.
    fn build_mesh(&self, path: &Path, hull: bool, scale: f64, radius: f64) -> BuildResult {
        let path = self.folder.join(path);
        let [scale_bits, radius_bits] = [scale, radius].map(f64::to_bits);
        let key = Key::Mesh { path: path.clone(), hull, scale: scale_bits, radius: radius_bits };
        self.cache.get_or_build(key, |_| {
            self.replaced_file.record_read(&path);
            let options = self.body.options(scale).with_hull(hull);
            let part = body::load(&path, &options).map_err(|error| mesh_error_message(&error))?;
            let body = part.body.rounded(radius).map_err(|error| error.to_string())?;
            Ok(Arc::new(Shape::Convex(Part { body, ..part })))
        })
    }
}

/// Returns the error of a mesh file with a hint at fields that avoid it.
fn mesh_error_message(error: &LoadError) -> String {
    let LoadError::Body { source, .. } = error else { return error.to_string() };
    let fields = source.alternatives().iter().map(|take| match take {
        BodyKind::Solid => r#"; "solid" instead of "mesh" accepts it"#,
        BodyKind::Open => {
            r#"; "solid" with "open": true accepts it as a surface without an interior"#
        }
        _ => r#"; "mesh" with "hull": true takes its convex hull"#,
    });
    format!("{error}{}", fields.collect::<String>())
}

/// Returns the scale, 1 by default.
///
/// # Errors
/// It is not finite and positive.
fn checked_scale(scale: Option<f64>) -> Result<f64, String> {
    match scale.unwrap_or(1.0) {
        scale if scale.is_finite() && scale > 0.0 => Ok(scale),
        scale => Err(format!("invalid scale {scale}; expected a finite positive number")),
    }
}

/// Returns the convex hull of points.
fn hull_of_points(points: &[[f64; 3]], radius: f64) -> BuildResult {
    let points: Vec<DVec3> = points.iter().copied().map(DVec3::from_array).collect();
    let hull = ConvexPolyhedron::from_points(&points);
    let body = hull.and_then(|hull| hull.rounded(radius)).map_err(|e| e.to_string())?;
    Ok(Arc::new(Shape::Convex(Part::from_body(body))))
}

/// Calls `answer`. Returns its error, or a panic as an error, with the number of the line, so that other lines are still
/// answered.
fn catch_panic<T>(number: u64, answer: impl FnOnce() -> Result<T, String>) -> Result<T, String> {
    let what = match catch_unwind(AssertUnwindSafe(answer)) {
        Ok(Ok(answer)) => return Ok(answer),
        Ok(Err(message)) => message,
        Err(_) => "internal error; please report it".into(),
    };
    Err(format!("line {number}: {what}"))
}

/// Answers a query of built bodies.
fn answer_query<B>(
    query: &Query<'_, B>,
    [moving, fixed]: [BuildResult; 2],
    fields: &Fields,
) -> Result<AnswerLine, String> {
    let moving = moving.map_err(|e| format!("moving: {e}"))?;
    let fixed = fixed.map_err(|e| format!("fixed: {e}"))?;
    let pose = |pose: Option<PoseSource>, name| {
        pose.unwrap_or_default().pose().map_err(|e| format!("{name}: {e}"))
    };
    let poses = [pose(query.moving_pose, "moving_pose")?, pose(query.fixed_pose, "fixed_pose")?];
    let shapes = [&*moving, &*fixed];
    match (query.task()?, shapes) {
        (Task::Pair(question), shapes) => pair_line(question, shapes, poses, fields),
        (Task::Motion(motions, clears), [Shape::Convex(moving), Shape::Convex(fixed)]) => {
            let parts = [moving, fixed];
            let record = motion::convex_record(query, parts, &motions, clears)?;
            Ok(convex_line(record.into(), parts))
        }
        (Task::Motion(motions, clears), shapes) => {
            let [moving, fixed] = as_solids(shapes)?;
            let bodies = [moving.get(), fixed.get()];
            let (min_gap, motions) = (query.min_gap.unwrap_or_default(), &*motions);
            let ignore_start_overlaps = query.ignore_start_overlaps.unwrap_or_default();
            let tolerance = query.tolerance;
            let motion_query =
                PartsMotion { bodies, motions, tolerance, clears, ignore_start_overlaps, min_gap };
            Ok(solid_line(motion_query.answer().map_err(|e| e.to_string())?.into(), bodies))
        }
        (Task::Cast(direction), [Shape::Convex(moving), Shape::Convex(fixed)]) => {
            query.convex_cast_line([moving, fixed], poses, direction, fields)
        }
        (Task::Cast(direction), shapes) => query.solid_cast_line(shapes, poses, direction),
    }
}

impl<B> Query<'_, B> {
    /// Returns the task of the query.
    ///
    /// # Errors
    /// A field is missing, or does not belong to this query.
    fn task(&self) -> Result<Task, String> {
        let question = match self.question {
            None | Some(QueryName::Contact | QueryName::Clearance) => {
                self.reject_fields(&["length", "moving_motion", "fixed_motion"])?;
                let direction = self.direction.ok_or("missing field `direction`")?;
                return Ok(Task::Cast(DVec3::from_array(direction)));
            }
            Some(name @ (QueryName::Motion | QueryName::MotionClearance)) => {
                self.reject_fields(&[&CAST_FIELDS[..5], &["length"]].concat())?;
                let clears = name == QueryName::MotionClearance;
                return Ok(Task::Motion(Box::new(motion::motions_of(self)?), clears));
            }
            Some(QueryName::Distance) => PairQuestion::Distance,
            Some(QueryName::Depth) => PairQuestion::Depth,
            Some(QueryName::Within) => {
                PairQuestion::Within(self.length.ok_or(r#""within" needs a `length`"#)?)
            }
        };
        self.reject_fields(&CAST_FIELDS)?;
        self.reject_fields(&["min_gap", "tolerance", "moving_motion", "fixed_motion"])?;
        if !matches!(question, PairQuestion::Within(_)) {
            self.reject_fields(&["length"])?;
        }
        Ok(Task::Pair(question))
    }

    /// Returns notes about quaternions that were normalised, at most one for each field.
    fn pose_notes(&self) -> impl Iterator<Item = String> {
        let pose = |pose: &Option<PoseSource>, place| pose.as_ref().and_then(|p| p.note(place));
        let motion =
            |motion: &Option<MotionSource>, place| motion.as_ref().and_then(|m| m.pose_note(place));
        [
            pose(&self.moving_pose, "moving_pose"),
            pose(&self.fixed_pose, "fixed_pose"),
            motion(&self.moving_motion, "moving_motion"),
            motion(&self.fixed_motion, "fixed_motion"),
        ]
        .into_iter()
        .flatten()
    }

    /// Checks that none of these fields is given.
    ///
    /// # Errors
    /// At least one of the fields is given. The message names the first of them.
    fn reject_fields(&self, fields: &[&str]) -> Result<(), String> {
        let is_given = |field: &&&str| match **field {
            "direction" => self.direction.is_some(),
            "graze_tolerance" => self.graze_tolerance.is_some(),
            "solver" => self.solver.is_some(),
            "start" => self.start.is_some(),
            "until" => self.until.is_some(),
            "cuts" => self.cuts.is_some(),
            "across_cells" => self.across_cells.is_some(),
            "cold" => self.cold.is_some(),
            "min_gap" => self.min_gap.is_some(),
            "tolerance" => self.tolerance.is_some(),
            "ignore_start_overlaps" => self.ignore_start_overlaps.is_some(),
            "length" => self.length.is_some(),
            "moving_motion" => self.moving_motion.is_some(),
            "fixed_motion" => self.fixed_motion.is_some(),
            _ => false,
        };
        match fields.iter().find(is_given) {
            Some(field @ &"length") => Err(format!(r#"`{field}` requires "query": "within""#)),
            Some(field @ (&"moving_motion" | &"fixed_motion")) => {
                Err(format!(r#"`{field}` requires "query": "motion""#))
            }
            Some(field) => Err(format!("`{field}` does not belong to this query")),
            None => Ok(()),
        }
    }

    /// Returns the options of the solver `cta`.
    ///
    /// # Errors
    /// The query has one of them, and its solver is not `cta`.
    fn narrowing(&self) -> Result<cta::Options, String> {
        if self.solver != Some(Solver::Cta) && self.reject_fields(&NARROWING_FIELDS).is_err() {
            return Err(format!(r#"{NARROWING_NAMES} require "solver": "cta""#));
        }
        Ok(cta::Options::new(self.start.unwrap_or_default(), self.until.unwrap_or_default())
            .with_cuts(self.cuts.unwrap_or_default())
            .with_keeps_to_cell(!self.across_cells.unwrap_or_default())
            .with_starts_cold(self.cold.unwrap_or_default()))
    }

    /// Answers a cast of convex bodies.
    fn convex_cast_line(
        &self,
        [moving, fixed]: [&Part; 2],
        poses: [Pose; 2],
        direction: DVec3,
        fields: &Fields,
    ) -> Result<AnswerLine, String> {
        if self.tolerance.is_some() || self.ignore_start_overlaps.is_some() {
            let fields = "`tolerance` and `ignore_start_overlaps`";
            return Err(format!("{fields} require solids; convex bodies accept `graze_tolerance`"));
        }
        let options = Options::default()
            .with_solver(self.solver.unwrap_or_default())
            .with_narrowing(self.narrowing()?)
            .with_graze_tolerance(self.graze_tolerance.unwrap_or_default())
            .with_min_gap(self.min_gap.unwrap_or_default());
        let (moving_at, fixed_at) = (moving.body.at(poses[0]), fixed.body.at(poses[1]));
        let cast = Cast::new(moving_at, fixed_at, direction)
            .and_then(|cast| cast.with_options(options))
            .map_err(|error| error.to_string())?;
        let question = match self.question {
            Some(QueryName::Clearance) => Question::Clearance,
            _ => Question::Contact,
        };
        let record = question.record(&cast, fields);
        let record = record.map_err(|error| case::cast_failure(error, &cast).into_message())?;
        Ok(convex_line(record, [moving, fixed]))
    }

    /// Answers a clearance of bodies at least one of which is a solid.
    fn solid_cast_line(
        &self,
        shapes: [&Shape; 2],
        poses: [Pose; 2],
        direction: DVec3,
    ) -> Result<AnswerLine, String> {
        if self.question == Some(QueryName::Contact) {
            return Err(r#"solids have no "contact"; use "query": "clearance""#.into());
        }
        if self.graze_tolerance.is_some() {
            return Err(
                "`graze_tolerance` requires convex bodies; solids accept `tolerance`".into()
            );
        }
        if self.solver.is_some() || self.reject_fields(&NARROWING_FIELDS).is_err() {
            return Err(format!("`solver`, {NARROWING_NAMES} require convex bodies"));
        }
        let [moving, fixed] = as_solids(shapes)?;
        let query = PartsQuery {
            bodies: [moving.get(), fixed.get()],
            poses,
            direction,
            tolerance: self.tolerance,
            ignore_start_overlaps: self.ignore_start_overlaps.unwrap_or_default(),
            min_gap: self.min_gap.unwrap_or_default(),
        };
        let answer = query.answer(|| ()).map_err(|e| e.to_string())?;
        let notes = query.bodies.into_iter().flat_map(|body| &body.notes).chain(&answer.notes);
        let notes = notes.cloned().collect();
        Ok(AnswerLine { notes, ..AnswerLine::from_record(without_names(answer.record.into())) })
    }
}

/// The question of a line: about placed bodies, along a direction, or along motions.
enum Task {
    Pair(PairQuestion),
    Cast(DVec3),
    /// The first contact, or with `true` how far the bodies can move.
    Motion(Box<[Motion; 2]>, bool),
}

/// Fields of queries with a direction. Motions have the last one, too.
const CAST_FIELDS: [&str; 9] = [
    "direction",
    "graze_tolerance",
    "solver",
    "start",
    "until",
    "cuts",
    "across_cells",
    "cold",
    "ignore_start_overlaps",
];

/// Fields of the solver `cta`.
const NARROWING_FIELDS: [&str; 5] = ["start", "until", "cuts", "across_cells", "cold"];
/// Their names in errors.
const NARROWING_NAMES: &str = "`start`, `until`, `cuts`, `across_cells` and `cold`";

/// Answers a question about placed bodies.
fn pair_line(
    question: PairQuestion,
    shapes: [&Shape; 2],
    poses: [Pose; 2],
    fields: &Fields,
) -> Result<AnswerLine, String> {
    if let [Shape::Convex(moving), Shape::Convex(fixed)] = shapes {
        let placed = [moving.body.at(poses[0]), fixed.body.at(poses[1])];
        let pair = Pair::new(placed[0], placed[1]).map_err(|error| error.to_string())?;
        let record = question.record(&pair, fields).map_err(|error| error.to_string())?;
        return Ok(convex_line(record, [moving, fixed]));
    }
    let [moving, fixed] = as_solids(shapes)?;
    let bodies = [moving.get(), fixed.get()];
    let record = PartsPair { bodies, poses }.answer(question).map_err(|e| e.to_string())?;
    Ok(solid_line(record, bodies))
}

/// Returns the line of an answer about solids, with the notes of their files.
fn solid_line(record: Record, bodies: [&solid::Body; 2]) -> AnswerLine {
    let notes = bodies.into_iter().flat_map(|body| body.notes.clone()).collect();
    AnswerLine { notes, ..AnswerLine::from_record(without_names(record)) }
}

/// Returns the line of an answer about convex bodies, with the notes of their files.
fn convex_line(record: Record, parts: [&Part; 2]) -> AnswerLine {
    let notes = parts.into_iter().flat_map(|part| part.notes.clone()).collect();
    AnswerLine { notes, ..AnswerLine::from(record).with_parts(parts) }
}

/// Returns a record without names of files, because each body of a batch has one file.
fn without_names(mut record: Record) -> Record {
    let (moving, fixed, overlaps) = match &mut record {
        Record::SolidClearance(of) => (&mut of.moving, &mut of.fixed, &mut of.start_overlaps),
        Record::Depth(of) => (&mut of.moving, &mut of.fixed, &mut of.start_overlaps),
        Record::Motion(of) => (&mut of.moving, &mut of.fixed, &mut of.start_overlaps),
        Record::Distance(of) => (&mut of.moving, &mut of.fixed, &mut Vec::new()),
        Record::Cast(_) | Record::Clearance(_) | Record::Error(_) => return record,
    };
    (*moving, *fixed) = (None, None);
    for overlap in overlaps {
        (overlap.moving, overlap.fixed) = (None, None);
    }
    record
}

/// A solid of the cache, or one that is made of a convex body.
enum SolidOf<'a> {
    Cached(&'a solid::Body),
    Made(Box<solid::Body>),
}

/// Returns a shape as a solid.
fn as_solid(shape: &Shape) -> Result<SolidOf<'_>, String> {
    match shape {
        Shape::Solid(body) => Ok(SolidOf::Cached(body)),
        Shape::Convex(part) => Ok(SolidOf::Made(Box::new(solid::Body::from_convex(&part.body)?))),
    }
}

/// Returns both shapes as solids.
fn as_solids(shapes: [&Shape; 2]) -> Result<[SolidOf<'_>; 2], String> {
    let [moving, fixed] = shapes.map(as_solid);
    Ok([moving.map_err(|e| format!("moving: {e}"))?, fixed.map_err(|e| format!("fixed: {e}"))?])
}

impl SolidOf<'_> {
    /// Returns the solid.
    fn get(&self) -> &solid::Body {
        match self {
            Self::Cached(body) => body,
            Self::Made(body) => body,
        }
    }
}

impl PoseSource {
    /// Returns the pose. A quaternion with few digits is normalised; [`Self::note`] reports it.
    ///
    /// # Errors
    /// The quaternion is not near length 1, or a number is not finite.
    pub(crate) fn pose(&self) -> Result<Pose, String> {
        self.normalised_pose().map(|(pose, _)| pose).map_err(|e| e.to_string())
    }

    /// Returns the length of the given quaternion; `None` if it was not normalised.
    pub(super) fn original_length(&self) -> Option<f64> {
        self.normalised_pose().ok()?.1.map(|_| self.quaternion().length())
    }

    /// Returns a note about the quaternion if it was normalised.
    pub(crate) fn note(&self, place: &str) -> Option<String> {
        self.original_length().map(|length| normalised_pose_note(place, length))
    }

    /// Returns the pose, and the deviation of the quaternion's length from 1 if it was normalised.
    fn normalised_pose(&self) -> Result<(Pose, Option<f64>), PoseError> {
        Pose::from_rounded(self.quaternion(), DVec3::from_array(self.translation))
    }

    /// Returns the given quaternion.
    fn quaternion(&self) -> DQuat {
        DQuat::from_array(self.rotation)
    }
}

/// Returns the message of a syntax error with the number of its line in the file; the parser gets single lines.
pub(crate) fn syntax_error_message(number: u64, error: &serde_json::Error) -> String {
    let what = json_error_reason(error)
        .replace("the file ends inside", "the line ends inside")
        .replace("expected path string", "expected a path");
    format!("line {number}, column {}: {what}", error.column())
}
