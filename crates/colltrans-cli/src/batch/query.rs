//! One line: a query read, its bodies found, its answer written.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use colltrans::glam::{DQuat, DVec3};
use colltrans::{ConvexPolyhedron, Options, Pose};
use serde::Deserialize;
use serde_json::value::RawValue;

use super::cache::{Built, Cache, Key};
use super::pipeline::Line;
use crate::args::{BodyArguments, SolverName};
use crate::body::{self, Part};
use crate::inputs::FilesRead;
use crate::query;
use crate::record::{Hulls, Name, Record};

/// Where lines are answered.
pub(crate) struct Desk {
    /// What mesh paths are relative to.
    pub(crate) folder: PathBuf,
    /// Whether the hull is taken of meshes that do not say.
    pub(crate) hull: bool,
    pub(crate) body: BodyArguments,
    pub(crate) cache: Cache,
    /// The mesh files.
    pub(crate) read: FilesRead,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Query {
    id: Option<Box<RawValue>>,
    moving: BodySource,
    fixed: BodySource,
    #[serde(default)]
    moving_pose: PoseSource,
    #[serde(default)]
    fixed_pose: PoseSource,
    direction: [f64; 3],
    #[serde(default)]
    graze_tolerance: f64,
    #[serde(default)]
    solver: SolverName,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BodySource {
    points: Option<Vec<[f64; 3]>>,
    mesh: Option<PathBuf>,
    hull: Option<bool>,
    scale: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, default)]
struct PoseSource {
    translation: [f64; 3],
    rotation: [f64; 4],
}

impl Default for PoseSource {
    fn default() -> Self {
        Self { translation: [0.0; 3], rotation: [0.0, 0.0, 0.0, 1.0] }
    }
}

/// Reads the id of a query that is otherwise wrong.
#[derive(Deserialize)]
struct IdOnly {
    id: Option<Box<RawValue>>,
}

impl Desk {
    /// The result of a line as JSON, and whether it is an answer.
    pub(crate) fn answer(&self, number: u64, line: Line) -> (String, bool) {
        let (id, record) = match line {
            Line::Text(text) => self.answer_text(number, &text),
            Line::TooLong => (None, Record::of_error(format!("line {number}: longer than 64 MiB"))),
        };
        let good = record.outcome != Name::Error;
        let record = Record { id: id.or_else(null), ..record };
        let text = serde_json::to_string(&record).unwrap_or_else(|error| {
            // Nothing in a record can fail to be written; if it does, the line is not lost.
            format!(r#"{{"id":null,"outcome":"error","message":"line {number}: {error}"}}"#)
        });
        (text, good)
    }

    fn answer_text(&self, number: u64, text: &[u8]) -> (Option<Box<RawValue>>, Record) {
        // Some editors begin a file with a byte order mark.
        let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
        let query: Query = match serde_json::from_slice(text) {
            Ok(query) => query,
            Err(error) => {
                let id = serde_json::from_slice::<IdOnly>(text).ok().and_then(|only| only.id);
                return (id, Record::of_error(syntax_message(number, &error)));
            }
        };
        let Query { id, .. } = &query;
        let id = id.clone();
        // A bug must not take the other lines with it.
        let solved = catch_unwind(AssertUnwindSafe(|| self.solve(query)));
        let record = match solved {
            Ok(Ok(record)) => record,
            Ok(Err(message)) => Record::of_error(format!("line {number}: {message}")),
            Err(_) => Record::of_error(format!("line {number}: internal error; please report it")),
        };
        (id, record)
    }

    fn solve(&self, query: Query) -> Result<Record, String> {
        let moving = self.body(query.moving).map_err(|e| format!("moving: {e}"))?;
        let fixed = self.body(query.fixed).map_err(|e| format!("fixed: {e}"))?;
        let moving_pose = query.moving_pose.pose().map_err(|e| format!("moving_pose: {e}"))?;
        let fixed_pose = query.fixed_pose.pose().map_err(|e| format!("fixed_pose: {e}"))?;
        let direction = DVec3::from_array(query.direction);
        let options = Options {
            solver: query.solver.into(),
            graze_tolerance: query.graze_tolerance,
            ..Options::default()
        };
        let (moving_body, fixed_body) = (&moving.body, &fixed.body);
        let query = query::Query {
            moving: moving_body,
            moving_pose,
            fixed: fixed_body,
            fixed_pose,
            direction,
            options,
        };
        let cast = query.cast().map_err(|e| e.to_string())?;
        let answer = cast.contact_range().map_err(|e| e.to_string())?;
        let hull = Hulls::of(moving.excess, fixed.excess);
        Ok(Record { hull, ..Record::of_answer(&answer, &cast) })
    }

    fn body(&self, source: BodySource) -> Built {
        match source {
            BodySource { points: Some(points), mesh: None, hull: None, scale: None } => {
                let bits = points.iter().map(|p| p.map(f64::to_bits)).collect();
                self.cache.get(Key::Points(bits), |_| hull(&points))
            }
            BodySource { points: None, mesh: Some(path), hull, scale } => {
                self.mesh(&path, hull.unwrap_or(self.hull), scale.unwrap_or(1.0))
            }
            BodySource { points: Some(_), mesh: None, .. } => {
                Err("`hull` and `scale` are for meshes".into())
            }
            _ => Err("a body has either `points` or `mesh`".into()),
        }
    }

    fn mesh(&self, path: &Path, hull: bool, scale: f64) -> Built {
        if !scale.is_finite() || scale <= 0.0 {
            return Err(format!("the scale {scale} is not finite and positive"));
        }
        let path = self.folder.join(path);
        let key = Key::Mesh { path: path.clone(), hull, scale: scale.to_bits() };
        self.cache.get(key, |_| {
            self.read.note(&path);
            body::load(&path, self.body.recipe(hull, scale)).map(Arc::new)
        })
    }
}

fn hull(points: &[[f64; 3]]) -> Built {
    let points: Vec<DVec3> = points.iter().copied().map(DVec3::from_array).collect();
    let body = ConvexPolyhedron::from_points(&points).map_err(|e| e.to_string())?;
    Ok(Arc::new(Part { body, excess: None, note: None }))
}

impl PoseSource {
    fn pose(&self) -> Result<Pose, String> {
        let [x, y, z, w] = self.rotation;
        Pose::new(DQuat::from_xyzw(x, y, z, w), DVec3::from_array(self.translation))
            .map_err(|e| e.to_string())
    }
}

fn null() -> Option<Box<RawValue>> {
    RawValue::from_string("null".into()).ok()
}

/// The parser sees one line and calls it line 1.
fn syntax_message(number: u64, error: &serde_json::Error) -> String {
    let message = error.to_string();
    let place = format!(" at line {} column {}", error.line(), error.column());
    let what = message.strip_suffix(&place).unwrap_or(&message);
    format!("line {number}, column {}: {what}", error.column())
}
