//! Serialises an answer as a line of JSON: the record of the library, and fields about the files.
//!
//! `colltrans help json` documents the fields.

use colltrans::record::{Dents, Ending, ErrorRecord, Fields, Record};
use colltrans_mesh::body::Excess;
use serde::Serialize;
use serde_json::value::RawValue;

use crate::body::Part;
use crate::numbers::{rounded_to_error, six_digits};
use crate::terminal::escape_json;

/// One answer.
#[derive(Debug, Serialize)]
pub(crate) struct Line<R = Record> {
    #[serde(flatten)]
    pub(crate) record: R,
    /// Depths of the dents of meshes that are convex only to within the tolerance.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) dents: Option<Dents>,
    /// Error message, or the direction of a grazing overlap.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) message: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) hull: Option<Hulls>,
    /// Notes about repaired meshes in a batch. Other commands print them on standard error.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(crate) notes: Vec<String>,
}

/// By how much hulls exceed their meshes.
#[derive(Debug, Clone, Copy, Serialize)]
pub(crate) struct Hulls {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) moving: Option<Excess>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) fixed: Option<Excess>,
    /// Upper bound of the distance of mesh points from their hulls: the hull algorithm drops points that are this near.
    #[serde(skip)]
    pub(crate) dropped: f64,
}

impl Hulls {
    /// Returns the excesses of the moving and the fixed hull; `None` if both equal their meshes.
    pub(crate) fn from_parts(parts: [&Part; 2]) -> Option<Self> {
        let [moving, fixed] = parts.map(|part| part.excess);
        let dropped = parts.map(|part| part.body.hull_error()).into_iter().sum();
        (moving.is_some() || fixed.is_some()).then_some(Self { moving, fixed, dropped })
    }

    /// Returns the excesses with their names.
    pub(crate) fn named_excesses(&self) -> impl Iterator<Item = (&'static str, Excess)> + use<> {
        let both = [("moving hull", self.moving), ("fixed hull", self.fixed)];
        both.into_iter().filter_map(|(name, excess)| Some((name, excess?)))
    }
}

impl From<Record> for Line {
    /// Builds the line of a record. A grazing contact has a message with its overlap.
    fn from(record: Record) -> Self {
        let message = record.contact().and_then(|contact| {
            let (overlap, along) = (six_digits(contact.overlap?), contact.sideways?);
            let along = along.map(|c| rounded_to_error(c, 1e-14)).join(",");
            Some(format!("the projections overlap by {overlap} along [{along}]"))
        });
        Self { message, ..Self::from_record(record) }
    }
}

impl<R> Line<R> {
    /// Builds the line of a record without other fields.
    pub(crate) const fn from_record(record: R) -> Self {
        Self { record, dents: None, message: None, hull: None, notes: Vec::new() }
    }

    /// Adds the dents and the hulls of two convex bodies.
    pub(crate) fn with_parts(self, parts: [&Part; 2]) -> Self {
        let dents = Dents::from_depths(parts.map(|part| part.dent));
        Self { dents, hull: Hulls::from_parts(parts), ..self }
    }
}

impl Line {
    /// Builds the line of an error.
    pub(crate) fn from_error(message: String) -> Self {
        Self { message: Some(message), ..Self::from_record(ErrorRecord::default().into()) }
    }

    /// Removes the fields that are not requested, except for the message of an error.
    pub(crate) fn keep_fields(&mut self, requested: &Fields) {
        self.record.keep_fields(requested);
        if !self.is_error() && !requested.includes("message") {
            self.message = None;
        }
        self.dents = self.dents.filter(|_| requested.includes("dents"));
        self.hull = self.hull.filter(|_| requested.includes("hull"));
        if !requested.includes("notes") {
            self.notes.clear();
        }
    }

    /// Returns the names of all fields of lines, each once.
    pub(crate) fn fields() -> Vec<&'static str> {
        [&["id", "dents", "message", "hull", "notes"], &Record::fields()[..]].concat()
    }

    /// Checks whether the line has no answer.
    pub(crate) fn is_error(&self) -> bool {
        self.record.outcome() == Ending::Error
    }

    /// Appends the line with an id as its first field, and a line feed.
    pub(crate) fn write_with_id(&self, id: Option<&RawValue>, text: &mut Vec<u8>) {
        text.extend_from_slice(b"{\"id\":");
        text.extend_from_slice(id.map_or("null", RawValue::get).as_bytes());
        let start = text.len();
        write_json_line(self, text);
        // Replaces the opening brace, because the object has begun.
        text[start] = b',';
    }
}

/// Returns a record as a line of JSON with a line feed.
pub(crate) fn json_line(record: &impl Serialize) -> String {
    let mut text = Vec::new();
    write_json_line(record, &mut text);
    String::from_utf8(text).unwrap_or_default()
}

/// Appends a record as a line of JSON. Control characters are escaped.
fn write_json_line(record: &impl Serialize, text: &mut Vec<u8>) {
    let start = text.len();
    // No field of a line can fail to serialise.
    let written = serde_json::to_writer(&mut *text, record);
    debug_assert!(written.is_ok(), "{written:?}");
    // JSON escapes the control characters of ASCII except for DEL. Others are beyond ASCII.
    let line = &text[start..];
    // The maximum of all bytes is computed in SIMD lanes, which a search that ends early would prevent.
    if line.iter().fold(0, |highest, &byte| byte.max(highest)) >= 0x7f {
        let safe = escape_json(&String::from_utf8_lossy(line)).into_owned();
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
    fn absent_fields_are_omitted() {
        let line = Line::<Record>::from_record(ErrorRecord::default().into());
        assert_eq!(json_line(&line), "{\"outcome\":\"error\"}\n");
        let mut text = b"before\n".to_vec();
        line.write_with_id(None, &mut text);
        assert_eq!(text, b"before\n{\"id\":null,\"outcome\":\"error\"}\n");
    }

    #[test]
    fn ids_are_unchanged_and_control_characters_are_escaped() {
        let line = Line::from_error("\u{1b}[31m\u{7f}\u{9b}\u{202e}".into());
        let mut text = Vec::new();
        let id: Box<RawValue> = serde_json::from_str("[1.0, \"x\"]").unwrap();
        line.write_with_id(Some(&id), &mut text);
        let text = String::from_utf8(text).unwrap();
        assert!(text.starts_with("{\"id\":[1.0, \"x\"],\"outcome\""), "{text}");
        assert!(text.trim_end().chars().all(|c| c.is_ascii() && !c.is_control()), "{text}");
        let read: serde_json::Value = serde_json::from_str(&text).unwrap();
        assert_eq!(read["message"], "\u{1b}[31m\u{7f}\u{9b}\u{202e}");
    }

    #[test]
    fn hull_excess_follows_the_record() {
        let excess =
            Excess { hull_volume: 0.1, part_volume: None, is_closed: false, depth: Some(2.0) };
        let hull = Some(Hulls { moving: None, fixed: Some(excess), dropped: 0.0 });
        let text = json_line(&Line {
            hull,
            notes: vec!["a".into()],
            ..Line::from_record(ErrorRecord::default())
        });
        let hull = r#""hull":{"fixed":{"hull_volume":0.1,"depth":2.0}},"notes":["a"]"#;
        assert_eq!(text, format!("{{\"outcome\":\"error\",{hull}}}\n"));
    }

    #[test]
    fn schema_has_exactly_the_fields_of_each_record() {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/answers.schema.json");
        let schema = std::fs::read_to_string(file).unwrap();
        let schema: serde_json::Value = serde_json::from_str(&schema).unwrap();
        // Fields of lines, and of the parts of an assembly.
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
