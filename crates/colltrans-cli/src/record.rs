//! A result as a line of JSON, in the fields that `batch --help` documents: the library's record, and
//! what only files have.

use colltrans::record::{Dents, Ending, ErrorRecord, Record};
use colltrans_mesh::body::Excess;
use serde::Serialize;
use serde_json::value::RawValue;

use crate::body::Part;
use crate::numbers::{six_digits, unit_vector};
use crate::terminal::plain_json;

/// One result.
#[derive(Debug, Serialize)]
pub(crate) struct Line<R = Record> {
    #[serde(flatten)]
    pub(crate) record: R,
    /// Depths of the dents of meshes that are convex only to within the tolerance.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) dents: Option<Dents>,
    /// For people: what is wrong.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) message: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) hull: Option<Hulls>,
    /// What was done to the meshes, in a batch; other commands say it on standard error.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(crate) notes: Vec<String>,
}

/// What the hulls have that their parts have not.
#[derive(Debug, Clone, Copy, Serialize)]
pub(crate) struct Hulls {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) moving: Option<Excess>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) fixed: Option<Excess>,
    /// How far points of the parts may be beyond their hulls, as those that are so near to one are dropped.
    #[serde(skip)]
    pub(crate) dropped: f64,
}

impl Hulls {
    /// Of the moving and the fixed body; `None` where they are what they were made of.
    pub(crate) fn of(parts: [&Part; 2]) -> Option<Self> {
        let [moving, fixed] = parts.map(|part| part.excess);
        let dropped = parts.map(|part| part.body.hull_error()).into_iter().sum();
        (moving.is_some() || fixed.is_some()).then_some(Self { moving, fixed, dropped })
    }

    /// Those that there are, by name.
    pub(crate) fn named(&self) -> impl Iterator<Item = (&'static str, Excess)> + use<> {
        let both = [("moving hull", self.moving), ("fixed hull", self.fixed)];
        both.into_iter().filter_map(|(name, excess)| Some((name, excess?)))
    }
}

impl From<Record> for Line {
    /// A contact that is none for certain says so.
    fn from(record: Record) -> Self {
        let message = record.contact().and_then(|contact| {
            let (overlap, along) = (six_digits(contact.overlap?), contact.sideways?);
            let along = unit_vector(along.into());
            Some(format!("the shadows overlap by {overlap} along [{along}]"))
        });
        Self { message, ..Self::of(record) }
    }
}

impl<R> Line<R> {
    /// Returns the line of a record and nothing else.
    pub(crate) const fn of(record: R) -> Self {
        Self { record, dents: None, message: None, hull: None, notes: Vec::new() }
    }

    /// Adds the dents and the hulls of two convex bodies.
    pub(crate) fn with_parts(self, parts: [&Part; 2]) -> Self {
        let dents = Dents::of(parts.map(|part| part.dent));
        Self { dents, hull: Hulls::of(parts), ..self }
    }
}

impl Line {
    /// That there is no answer, and why.
    pub(crate) fn error(message: String) -> Self {
        Self { message: Some(message), ..Self::of(ErrorRecord::default().into()) }
    }

    pub(crate) fn is_error(&self) -> bool {
        self.record.outcome() == Ending::Error
    }

    /// Appends the line of a batch, with its end; the id comes first.
    pub(crate) fn write_with(&self, id: Option<&RawValue>, text: &mut Vec<u8>) {
        text.extend_from_slice(b"{\"id\":");
        text.extend_from_slice(id.map_or("null", RawValue::get).as_bytes());
        let start = text.len();
        write(self, text);
        // The fields go on.
        text[start] = b',';
    }
}

/// Returns a record as a line of JSON with its line feed.
pub(crate) fn json(record: &impl Serialize) -> String {
    let mut text = Vec::new();
    write(record, &mut text);
    String::from_utf8(text).unwrap_or_default()
}

fn write(record: &impl Serialize, text: &mut Vec<u8>) {
    let start = text.len();
    // Nothing in a line can fail to be written.
    let written = serde_json::to_writer(&mut *text, record);
    debug_assert!(written.is_ok(), "{written:?}");
    // What could steer a terminal is none of ASCII, whose control characters JSON has escaped, but one.
    let line = &text[start..];
    // All bytes, in lanes: looking for one costs more than a search that could end early saves.
    if line.iter().fold(0, |highest, &byte| byte.max(highest)) >= 0x7f {
        let safe = plain_json(&String::from_utf8_lossy(line)).into_owned();
        text.truncate(start);
        text.extend_from_slice(safe.as_bytes());
    }
    text.push(b'\n');
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use colltrans::record::{
        CastRecord, ClearanceRecord, DepthRecord, DistanceRecord, FreeRecord, MotionRecord,
        NearbyRecord, NearestRecord, PathRecord, SceneClearanceRecord, SceneWithinRecord,
        SolidClearanceRecord, TimeRecord,
    };

    use super::*;

    #[test]
    fn what_is_not_there_is_not_written() {
        let line = Line::<Record>::of(ErrorRecord::default().into());
        assert_eq!(json(&line), "{\"outcome\":\"error\"}\n");
        let mut text = b"before\n".to_vec();
        line.write_with(None, &mut text);
        assert_eq!(text, b"before\n{\"id\":null,\"outcome\":\"error\"}\n");
    }

    #[test]
    fn ids_are_written_as_they_came_and_nothing_steers_a_terminal() {
        let line = Line::error("\u{1b}[31m\u{7f}\u{9b}\u{202e}".into());
        let mut text = Vec::new();
        let id: Box<RawValue> = serde_json::from_str("[1.0, \"x\"]").unwrap();
        line.write_with(Some(&id), &mut text);
        let text = String::from_utf8(text).unwrap();
        assert!(text.starts_with("{\"id\":[1.0, \"x\"],\"outcome\""), "{text}");
        assert!(text.trim_end().chars().all(|c| c.is_ascii() && !c.is_control()), "{text}");
        let read: serde_json::Value = serde_json::from_str(&text).unwrap();
        assert_eq!(read["message"], "\u{1b}[31m\u{7f}\u{9b}\u{202e}");
    }

    #[test]
    fn a_hull_is_told_beside_the_record() {
        let excess =
            Excess { hull_volume: 0.1, part_volume: None, is_closed: false, depth: Some(2.0) };
        let hull = Some(Hulls { moving: None, fixed: Some(excess), dropped: 0.0 });
        let text =
            json(&Line { hull, notes: vec!["a".into()], ..Line::of(ErrorRecord::default()) });
        let hull = r#""hull":{"fixed":{"hull_volume":0.1,"depth":2.0}},"notes":["a"]"#;
        assert_eq!(text, format!("{{\"outcome\":\"error\",{hull}}}\n"));
    }

    #[test]
    fn the_schema_has_the_fields_of_each_record() {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/answers.schema.json");
        let schema = std::fs::read_to_string(file).unwrap();
        let schema: serde_json::Value = serde_json::from_str(&schema).unwrap();
        // Those of lines, and of the parts of an assembly.
        let others = ["id", "dents", "message", "hull", "notes", "parts"];
        for (name, fields) in [
            ("cast_answer", CastRecord::fields()),
            ("clearance_answer", ClearanceRecord::fields()),
            ("solid_clearance_answer", SolidClearanceRecord::fields()),
            ("distance_answer", DistanceRecord::fields()),
            ("depth_answer", DepthRecord::fields()),
            ("error_answer", ErrorRecord::fields()),
            ("nearest_answer", NearestRecord::fields()),
            ("scene_within_answer", SceneWithinRecord::fields()),
            ("scene_clearance_answer", SceneClearanceRecord::fields()),
            ("near_obstacle", NearbyRecord::fields()),
            ("motion", MotionRecord::fields()),
            ("time", TimeRecord::fields()),
            ("path", PathRecord::fields()),
            ("directions", FreeRecord::fields()),
        ] {
            let known = schema["$defs"][name]["properties"].as_object().unwrap().keys();
            let known: BTreeSet<_> = known
                .map(String::as_str)
                .filter(|field| fields.contains(field) || !others.contains(field))
                .collect();
            assert_eq!(known, fields.iter().copied().collect(), "{name}");
        }
    }
}
