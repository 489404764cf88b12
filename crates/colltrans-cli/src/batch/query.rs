//! One line: a query read, its bodies found, its answer written.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use colltrans::glam::{DQuat, DVec3};
use colltrans::motion::Motion;
use colltrans::record::{PairQuestion, Question, Record};
use colltrans::{Cast, ConvexPolyhedron, Options, Pair, Pose, PoseError, Solver, cta};
use colltrans_assembly_io::read::plain;
use colltrans_mesh::body::{LoadError, Take};
use serde::Deserialize;
use serde_json::value::RawValue;

use super::cache::{Built, Cache, Key, Shape};
use super::fast_path;
use super::motion::{self, MotionSource};
use super::pipeline::Line;
use super::recent::Recent;
use super::source::{Asked, BodySource, PoseSource, Query, as_written};
use crate::args::{BodyArguments, normalised};
use crate::body::{self, Part};
use crate::case;
use crate::inputs::Watched;
use crate::record::Line as AnswerLine;
use crate::solid::{self, PartsMotion, PartsPair, PartsQuery};

/// What all lines of a batch have in common.
pub(crate) struct Batch {
    /// What mesh paths are relative to.
    pub(crate) folder: PathBuf,
    /// Whether the hull is taken of meshes that do not say.
    pub(crate) hull: bool,
    pub(crate) body: BodyArguments,
    pub(crate) cache: Cache,
    /// The file that the results will replace.
    pub(crate) watched: Watched,
}

/// Reads the id of a query that is otherwise wrong.
#[derive(Deserialize)]
struct IdOnly<'a> {
    #[serde(borrow, default, deserialize_with = "as_written")]
    id: Option<&'a RawValue>,
}

impl Batch {
    /// Appends the result of a line as JSON; whether it is an answer.
    pub(crate) fn answer(
        &self,
        number: u64,
        line: Line<'_>,
        recent: &mut Recent,
        results: &mut Vec<u8>,
    ) -> bool {
        let (id, answer) = match line {
            Line::Text(text) => self.answer_text(number, text, recent),
            Line::TooLong => (None, Err(format!("line {number}: longer than 64 MiB"))),
        };
        let line = answer.unwrap_or_else(AnswerLine::error);
        line.write_with(id, results);
        !line.is_error()
    }

    /// The id of a line, if it has one, and its answer.
    fn answer_text<'a>(
        &self,
        number: u64,
        text: &'a [u8],
        recent: &mut Recent,
    ) -> (Option<&'a RawValue>, Result<AnswerLine, String>) {
        // Some editors begin a file with a byte order mark.
        let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
        let usual = str::from_utf8(text).ok().and_then(fast_path::read);
        if let Some(query) = usual
            && let Some(answer) = self.answer_by_words(number, &query, recent)
        {
            return (query.id, answer);
        }
        match serde_json::from_slice::<Query<'_, BodySource>>(text) {
            Ok(query) => {
                let bodies = || [&query.moving, &query.fixed].map(|source| self.body(source));
                (query.id, guarded(number, || solve(&query, bodies())))
            }
            Err(error) => {
                let id = serde_json::from_slice::<IdOnly<'_>>(text).ok().and_then(|only| only.id);
                (id, Err(syntax_message(number, &error)))
            }
        }
    }

    /// Unless what is said of a body is not right: the whole line tells the place.
    fn answer_by_words(
        &self,
        number: u64,
        query: &Query<'_, &str>,
        recent: &mut Recent,
    ) -> Option<Result<AnswerLine, String>> {
        let answer = guarded(number, || {
            let moving = self.body_by_words(query.moving, recent);
            let fixed = self.body_by_words(query.fixed, recent);
            let (Some(moving), Some(fixed)) = (moving, fixed) else { return Ok(None) };
            solve(query, [moving, fixed]).map(Some)
        });
        answer.transpose()
    }

    fn body_by_words(&self, words: &str, recent: &mut Recent) -> Option<Built> {
        if let Some(shape) = recent.find(words) {
            return Some(Ok(shape));
        }
        let built = self.body(&serde_json::from_str(words).ok()?);
        if let Ok(shape) = &built {
            recent.keep(words, shape);
        }
        Some(built)
    }

    /// The body of a source; one that occurs again is made once.
    pub(crate) fn body(&self, source: &BodySource) -> Built {
        let &BodySource { ref points, ref mesh, ref solid, open, hull, scale } = source;
        if open.is_some() && solid.is_none() {
            return Err("`open` is for a `solid`".into());
        }
        match (points, mesh, solid) {
            (Some(points), None, None) if hull.is_none() && scale.is_none() => {
                let bits = points.iter().map(|p| p.map(f64::to_bits)).collect();
                self.cache.get(Key::Points(bits), |_| hull_of(points))
            }
            (Some(_), None, None) => Err("`hull` and `scale` are for meshes".into()),
            (None, Some(path), None) => {
                self.mesh(path, hull.unwrap_or(self.hull), positive(scale)?)
            }
            (None, None, Some(path)) if hull.is_none() => {
                self.solid(path, positive(scale)?, open.unwrap_or_default())
            }
            (None, None, Some(_)) => Err("`hull` is for a `mesh`".into()),
            _ => Err("a body has either `points` or `mesh` or `solid`".into()),
        }
    }

    fn solid(&self, path: &Path, scale: f64, open: bool) -> Built {
        let path = self.folder.join(path);
        let key = Key::Solid { path: path.clone(), scale: scale.to_bits(), open };
        self.cache.get(key, |_| {
            self.watched.note(&path);
            let options = self.body.options(scale).with_open(open);
            let body = solid::Body::load(&[path], &options, || ())?;
            Ok(Arc::new(Shape::Solid(body)))
        })
    }

    fn mesh(&self, path: &Path, hull: bool, scale: f64) -> Built {
        let path = self.folder.join(path);
        let key = Key::Mesh { path: path.clone(), hull, scale: scale.to_bits() };
        self.cache.get(key, |_| {
            self.watched.note(&path);
            let options = self.body.options(scale).with_hull(hull);
            let part = body::load(&path, &options).map_err(|error| refusal(&error))?;
            Ok(Arc::new(Shape::Convex(part)))
        })
    }
}

/// Why no body was made of a file, and which fields would help.
fn refusal(error: &LoadError) -> String {
    let LoadError::Body { source, .. } = error else { return error.to_string() };
    let fields = source.instead().iter().map(|take| match take {
        Take::Solid => r#"; "solid" in the place of "mesh" takes it as it is"#,
        Take::Open => r#"; "solid" with "open": true takes it as a surface without an inside"#,
        _ => r#"; "mesh" with "hull": true takes its convex hull"#,
    });
    format!("{error}{}", fields.collect::<String>())
}

fn positive(scale: Option<f64>) -> Result<f64, String> {
    match scale.unwrap_or(1.0) {
        scale if scale.is_finite() && scale > 0.0 => Ok(scale),
        scale => Err(format!("the scale {scale} is not finite and positive")),
    }
}

fn hull_of(points: &[[f64; 3]]) -> Built {
    let points: Vec<DVec3> = points.iter().copied().map(DVec3::from_array).collect();
    let body = ConvexPolyhedron::from_points(&points).map_err(|e| e.to_string())?;
    Ok(Arc::new(Shape::Convex(Part::of(body))))
}

/// A bug must not take the other lines with it.
fn guarded<T>(number: u64, answer: impl FnOnce() -> Result<T, String>) -> Result<T, String> {
    let what = match catch_unwind(AssertUnwindSafe(answer)) {
        Ok(Ok(answer)) => return Ok(answer),
        Ok(Err(message)) => message,
        Err(_) => "internal error; please report it".into(),
    };
    Err(format!("line {number}: {what}"))
}

/// Answers a query, with notes about quaternions that were normalised.
fn solve<B>(query: &Query<'_, B>, bodies: [Built; 2]) -> Result<AnswerLine, String> {
    let mut answer = answer(query, bodies)?;
    answer.notes.extend(query.pose_notes());
    Ok(answer)
}

fn answer<B>(query: &Query<'_, B>, [moving, fixed]: [Built; 2]) -> Result<AnswerLine, String> {
    let moving = moving.map_err(|e| format!("moving: {e}"))?;
    let fixed = fixed.map_err(|e| format!("fixed: {e}"))?;
    let pose = |pose: Option<PoseSource>, name| {
        pose.unwrap_or_default().pose().map_err(|e| format!("{name}: {e}"))
    };
    let poses = [pose(query.moving_pose, "moving_pose")?, pose(query.fixed_pose, "fixed_pose")?];
    let shapes = [&*moving, &*fixed];
    match (query.asked()?, shapes) {
        (Ask::Pair(question), shapes) => of_pair(question, shapes, poses),
        (Ask::Motion(motions, clears), [Shape::Convex(moving), Shape::Convex(fixed)]) => {
            let parts = [moving, fixed];
            let record = motion::of_convex(query, parts, &motions, clears)?;
            Ok(of_parts(record.into(), parts))
        }
        (Ask::Motion(motions, clears), shapes) => {
            let [moving, fixed] = as_solids(shapes)?;
            let bodies = [moving.get(), fixed.get()];
            let (keep, motions) = (query.keep.unwrap_or_default(), &*motions);
            let ignore_start_overlaps = query.ignore_start_overlaps.unwrap_or_default();
            let tolerance = query.tolerance;
            let asked =
                PartsMotion { bodies, motions, tolerance, clears, ignore_start_overlaps, keep };
            Ok(of_bodies(asked.ask().map_err(|e| e.to_string())?.into(), bodies))
        }
        (Ask::Cast(direction), [Shape::Convex(moving), Shape::Convex(fixed)]) => {
            query.of_convex([moving, fixed], poses, direction)
        }
        (Ask::Cast(direction), shapes) => query.of_solids(shapes, poses, direction),
    }
}

impl<B> Query<'_, B> {
    /// What is asked, with all that it needs and nothing else.
    fn asked(&self) -> Result<Ask, String> {
        let question = match self.question {
            None | Some(Asked::Contact | Asked::Clearance) => {
                self.refuse(&["length", "moving_motion", "fixed_motion"])?;
                let direction = self.direction.ok_or("missing field `direction`")?;
                return Ok(Ask::Cast(DVec3::from_array(direction)));
            }
            Some(asked @ (Asked::Motion | Asked::MotionClearance)) => {
                self.refuse(&[&OF_CASTS[..5], &["length"]].concat())?;
                let clears = asked == Asked::MotionClearance;
                return Ok(Ask::Motion(Box::new(motion::motions(self)?), clears));
            }
            Some(Asked::Distance) => PairQuestion::Distance,
            Some(Asked::Depth) => PairQuestion::Depth,
            Some(Asked::Within) => {
                PairQuestion::Within(self.length.ok_or(r#""within" needs a `length`"#)?)
            }
        };
        self.refuse(&OF_CASTS)?;
        self.refuse(&["keep", "tolerance", "moving_motion", "fixed_motion"])?;
        if !matches!(question, PairQuestion::Within(_)) {
            self.refuse(&["length"])?;
        }
        Ok(Ask::Pair(question))
    }

    /// Returns notes about quaternions that were normalised, at most one for each field.
    fn pose_notes(&self) -> impl Iterator<Item = String> {
        let pose = |pose: &Option<PoseSource>, place| pose.as_ref().and_then(|p| p.note(place));
        let motion =
            |motion: &Option<MotionSource>, place| motion.as_ref().and_then(|m| m.note(place));
        [
            pose(&self.moving_pose, "moving_pose"),
            pose(&self.fixed_pose, "fixed_pose"),
            motion(&self.moving_motion, "moving_motion"),
            motion(&self.fixed_motion, "fixed_motion"),
        ]
        .into_iter()
        .flatten()
    }

    /// An error for the first of these fields that is there.
    fn refuse(&self, fields: &[&str]) -> Result<(), String> {
        let is_there = |field: &&&str| match **field {
            "direction" => self.direction.is_some(),
            "graze_tolerance" => self.graze_tolerance.is_some(),
            "solver" => self.solver.is_some(),
            "start" => self.start.is_some(),
            "until" => self.until.is_some(),
            "keep" => self.keep.is_some(),
            "tolerance" => self.tolerance.is_some(),
            "ignore_start_overlaps" => self.ignore_start_overlaps.is_some(),
            "length" => self.length.is_some(),
            "moving_motion" => self.moving_motion.is_some(),
            "fixed_motion" => self.fixed_motion.is_some(),
            _ => false,
        };
        match fields.iter().find(is_there) {
            Some(field @ &"length") => Err(format!(r#"`{field}` is for "query": "within""#)),
            Some(field @ (&"moving_motion" | &"fixed_motion")) => {
                Err(format!(r#"`{field}` is for "query": "motion""#))
            }
            Some(field) => Err(format!("`{field}` is not for this query")),
            None => Ok(()),
        }
    }

    /// How the solver narrows the search.
    fn narrowing(&self) -> Result<cta::Options, String> {
        if self.solver != Some(Solver::Cta) && (self.start.is_some() || self.until.is_some()) {
            return Err(r#"`start` and `until` are for "solver": "cta""#.into());
        }
        Ok(cta::Options::new(self.start.unwrap_or_default(), self.until.unwrap_or_default()))
    }

    fn of_convex(
        &self,
        [moving, fixed]: [&Part; 2],
        poses: [Pose; 2],
        direction: DVec3,
    ) -> Result<AnswerLine, String> {
        if self.tolerance.is_some() || self.ignore_start_overlaps.is_some() {
            let fields = "`tolerance` and `ignore_start_overlaps`";
            return Err(format!("{fields} are for solids; convex bodies have `graze_tolerance`"));
        }
        let options = Options::default()
            .with_solver(self.solver.unwrap_or_default())
            .with_narrowing(self.narrowing()?)
            .with_graze_tolerance(self.graze_tolerance.unwrap_or_default())
            .with_keep(self.keep.unwrap_or_default());
        let (moving_at, fixed_at) = (moving.body.at(poses[0]), fixed.body.at(poses[1]));
        let cast = Cast::new(moving_at, fixed_at, direction)
            .and_then(|cast| cast.with_options(options))
            .map_err(|error| error.to_string())?;
        let question = match self.question {
            Some(Asked::Clearance) => Question::Clearance,
            _ => Question::Contact,
        };
        let answered = question.ask(&cast);
        let answer = answered.map_err(|error| case::failure(error, &cast).into_message())?;
        Ok(of_parts(answer.record(&cast), [moving, fixed]))
    }

    /// At least one of the bodies is a solid.
    fn of_solids(
        &self,
        shapes: [&Shape; 2],
        poses: [Pose; 2],
        direction: DVec3,
    ) -> Result<AnswerLine, String> {
        if self.question == Some(Asked::Contact) {
            return Err(r#"solids are asked for their clearance: "query": "clearance""#.into());
        }
        if self.graze_tolerance.is_some() {
            return Err("`graze_tolerance` is for convex bodies; solids have `tolerance`".into());
        }
        if self.solver.is_some() || self.start.is_some() || self.until.is_some() {
            return Err("`solver`, `start` and `until` are for convex bodies".into());
        }
        let [moving, fixed] = as_solids(shapes)?;
        let question = PartsQuery {
            bodies: [moving.get(), fixed.get()],
            poses,
            direction,
            tolerance: self.tolerance,
            ignore_start_overlaps: self.ignore_start_overlaps.unwrap_or_default(),
            keep: self.keep.unwrap_or_default(),
        };
        let answer = question.ask(|| ()).map_err(|e| e.to_string())?;
        let notes = question.bodies.into_iter().flat_map(|body| &body.notes).chain(&answer.notes);
        let notes = notes.cloned().collect();
        Ok(AnswerLine { notes, ..AnswerLine::of(without_names(answer.record.into())) })
    }
}

/// What is asked of two bodies: where they are, along a direction, or along motions.
enum Ask {
    Pair(PairQuestion),
    Cast(DVec3),
    /// When they first meet, or how far they can go.
    Motion(Box<[Motion; 2]>, bool),
}

/// Fields that only queries with a direction have; the last one motions have too.
const OF_CASTS: [&str; 6] =
    ["direction", "graze_tolerance", "solver", "start", "until", "ignore_start_overlaps"];

/// Of bodies where they are.
fn of_pair(
    question: PairQuestion,
    shapes: [&Shape; 2],
    poses: [Pose; 2],
) -> Result<AnswerLine, String> {
    if let [Shape::Convex(moving), Shape::Convex(fixed)] = shapes {
        let placed = [moving.body.at(poses[0]), fixed.body.at(poses[1])];
        let pair = Pair::new(placed[0], placed[1]).map_err(|error| error.to_string())?;
        let answer = question.ask(&pair).map_err(|error| error.to_string())?;
        return Ok(of_parts(answer.record(&pair), [moving, fixed]));
    }
    let [moving, fixed] = as_solids(shapes)?;
    let bodies = [moving.get(), fixed.get()];
    let record = PartsPair { bodies, poses }.ask(question).map_err(|e| e.to_string())?;
    Ok(of_bodies(record, bodies))
}

/// The line of an answer about solids.
fn of_bodies(record: Record, bodies: [&solid::Body; 2]) -> AnswerLine {
    let notes = bodies.into_iter().flat_map(|body| body.notes.clone()).collect();
    AnswerLine { notes, ..AnswerLine::of(without_names(record)) }
}

/// The line of an answer about convex bodies.
fn of_parts(record: Record, parts: [&Part; 2]) -> AnswerLine {
    let notes = parts.into_iter().flat_map(|part| part.notes.clone()).collect();
    AnswerLine { notes, ..AnswerLine::from(record).with_parts(parts) }
}

/// Without the names of files: a body is one.
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

/// A solid, or one made of a convex body.
enum AsSolid<'a> {
    Is(&'a solid::Body),
    Made(Box<solid::Body>),
}

fn as_solid(shape: &Shape) -> Result<AsSolid<'_>, String> {
    match shape {
        Shape::Solid(body) => Ok(AsSolid::Is(body)),
        Shape::Convex(part) => Ok(AsSolid::Made(Box::new(solid::Body::of_convex(&part.body)?))),
    }
}

fn as_solids(shapes: [&Shape; 2]) -> Result<[AsSolid<'_>; 2], String> {
    let [moving, fixed] = shapes.map(as_solid);
    Ok([moving.map_err(|e| format!("moving: {e}"))?, fixed.map_err(|e| format!("fixed: {e}"))?])
}

impl AsSolid<'_> {
    fn get(&self) -> &solid::Body {
        match self {
            Self::Is(body) => body,
            Self::Made(body) => body,
        }
    }
}

impl PoseSource {
    /// Returns the pose. A quaternion of few digits is normalised, which [`Self::note`] says.
    pub(crate) fn pose(&self) -> Result<Pose, String> {
        self.rounded().map(|(pose, _)| pose).map_err(|e| e.to_string())
    }

    /// Returns the length of the quaternion as it was written, if it was normalised.
    pub(super) fn rounded_length(&self) -> Option<f64> {
        self.rounded().ok()?.1.map(|_| self.quaternion().length())
    }

    /// Returns a note about the quaternion if it was normalised.
    pub(crate) fn note(&self, place: &str) -> Option<String> {
        self.rounded_length().map(|length| normalised(place, length))
    }

    fn rounded(&self) -> Result<(Pose, Option<f64>), PoseError> {
        Pose::from_rounded(self.quaternion(), DVec3::from_array(self.translation))
    }

    fn quaternion(&self) -> DQuat {
        DQuat::from_array(self.rotation)
    }
}

/// The parser sees one line and calls it line 1.
pub(crate) fn syntax_message(number: u64, error: &serde_json::Error) -> String {
    let what = plain(error)
        .replace("the file ends inside", "the line ends inside")
        .replace("expected path string", "expected a path");
    format!("line {number}, column {}: {what}", error.column())
}
