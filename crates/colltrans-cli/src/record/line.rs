//! A result as a line of JSON.
//!
//! Lines are written straight behind each other, by hand: names of fields need no escapes, and what
//! a batch writes is most of what it does. Numbers are written by the crates that `serde_json` writes
//! them with: the shortest that read back to the same bits. What is rare or holds any text is left to
//! `serde_json`.

use colltrans::Bounded;
use colltrans_mesh::body::Excess;
use serde::Serialize;

use super::{FeatureRecord, Features, Hulls, Record, StepCounts};

impl Record {
    /// A line of its own, with its end.
    pub(crate) fn json(&self) -> String {
        let mut text = Vec::new();
        self.write_line(None, &mut text);
        String::from_utf8(text).unwrap_or_default()
    }

    /// Appends the line with its end; `id` is JSON, and comes first.
    pub(crate) fn write_line(&self, id: Option<&str>, text: &mut Vec<u8>) {
        text.push(b'{');
        if let Some(id) = id {
            text.extend_from_slice(b"\"id\":");
            text.extend_from_slice(id.as_bytes());
            text.push(b',');
        }
        text.extend_from_slice(b"\"outcome\":");
        quoted(text, self.outcome.text());
        self.write_fields(text);
        text.extend_from_slice(b"}\n");
    }

    /// All fields but the outcome that there are, in their order.
    fn write_fields(&self, text: &mut Vec<u8>) {
        // By name, so that none is forgotten.
        let Self {
            outcome: _,
            direction,
            distance,
            back,
            on,
            translation,
            shrunk_distance,
            exit,
            moving,
            fixed,
            normal,
            point,
            rounding,
            tolerance,
            start_overlaps,
            surfaces,
            features,
            margin,
            overlap,
            hull,
            solver,
            steps,
            message,
            notes,
        } = self;
        field(text, r#","direction":"#, *direction, vector);
        field(text, r#","distance":"#, *distance, number);
        field(text, r#","back":"#, *back, number);
        field(text, r#","on":"#, *on, number);
        bounded(text, "translation", *translation);
        bounded(text, "shrunk_distance", *shrunk_distance);
        bounded(text, "exit", *exit);
        field(text, r#","moving":"#, moving.as_ref(), any);
        field(text, r#","fixed":"#, fixed.as_ref(), any);
        field(text, r#","normal":"#, *normal, vector);
        field(text, r#","point":"#, *point, vector);
        field(text, r#","rounding":"#, *rounding, number);
        field(text, r#","tolerance":"#, *tolerance, number);
        field(text, r#","start_overlaps":"#, some(start_overlaps), any);
        field(text, r#","surfaces":"#, some(surfaces), any);
        field(text, r#","features":"#, features.as_ref(), touching);
        field(text, r#","margin":"#, *margin, number);
        field(text, r#","overlap":"#, *overlap, number);
        field(text, r#","hull":"#, *hull, hulls);
        field(text, r#","solver":"#, *solver, quoted);
        field(text, r#","steps":"#, steps.as_ref(), counts);
        field(text, r#","message":"#, message.as_ref(), any);
        field(text, r#","notes":"#, some(notes), any);
    }
}

/// A list, if there is anything in it.
fn some<T>(list: &Vec<T>) -> Option<&Vec<T>> {
    Some(list).filter(|list| !list.is_empty())
}

#[inline]
fn field<T>(text: &mut Vec<u8>, name: &str, value: Option<T>, write: impl Fn(&mut Vec<u8>, T)) {
    if let Some(value) = value {
        text.extend_from_slice(name.as_bytes());
        write(text, value);
    }
}

fn key(text: &mut Vec<u8>, name: &str, end: &[u8]) {
    text.extend_from_slice(b",\"");
    text.extend_from_slice(name.as_bytes());
    text.extend_from_slice(end);
}

/// A number, and its bounds; `null` where nothing is known.
fn bounded(text: &mut Vec<u8>, name: &str, value: Option<Bounded>) {
    let Some(Bounded { value, lower, upper }) = value else { return };
    key(text, name, b"\":");
    number(text, value);
    key(text, name, b"_bounds\":[");
    number(text, lower);
    text.push(b',');
    number(text, upper);
    text.push(b']');
}

/// Whatever serde can write.
fn any<T: Serialize>(text: &mut Vec<u8>, value: &T) {
    // Nothing in a record can fail to be written; if it does, the line is still one.
    let written = serde_json::to_string(value);
    let written = written.as_deref().unwrap_or("null");
    text.extend_from_slice(crate::terminal::plain_json(written).as_bytes());
}

/// A word of the program's own.
fn quoted(text: &mut Vec<u8>, word: &str) {
    text.push(b'"');
    text.extend_from_slice(word.as_bytes());
    text.push(b'"');
}

fn number(text: &mut Vec<u8>, value: f64) {
    if value.is_finite() {
        text.extend_from_slice(zmij::Buffer::new().format_finite(value).as_bytes());
    } else {
        text.extend_from_slice(b"null");
    }
}

fn vector(text: &mut Vec<u8>, [x, y, z]: [f64; 3]) {
    text.push(b'[');
    number(text, x);
    text.push(b',');
    number(text, y);
    text.push(b',');
    number(text, z);
    text.push(b']');
}

fn count(text: &mut Vec<u8>, count: u32) {
    text.extend_from_slice(itoa::Buffer::new().format(count).as_bytes());
}

fn touching(text: &mut Vec<u8>, Features { moving, fixed }: &Features) {
    text.extend_from_slice(br#"{"moving":"#);
    feature(text, moving);
    text.extend_from_slice(br#","fixed":"#);
    feature(text, fixed);
    text.push(b'}');
}

fn feature(text: &mut Vec<u8>, FeatureRecord { kind, vertices }: &FeatureRecord) {
    text.extend_from_slice(br#"{"kind":"#);
    quoted(text, kind);
    text.extend_from_slice(br#","vertices":["#);
    for (i, vertex) in vertices.iter().enumerate() {
        if i > 0 {
            text.push(b',');
        }
        count(text, *vertex);
    }
    text.extend_from_slice(b"]}");
}

fn hulls(text: &mut Vec<u8>, Hulls { moving, fixed }: Hulls) {
    let hulls = [(r#""moving":"#, moving), (r#""fixed":"#, fixed)];
    let mut before = b'{';
    for (name, excess) in hulls {
        if let Some(Excess { hull_volume, part_volume, is_closed: _, depth }) = excess {
            text.push(before);
            text.extend_from_slice(name.as_bytes());
            field(text, r#"{"hull_volume":"#, Some(hull_volume), number);
            field(text, r#","part_volume":"#, part_volume, number);
            field(text, r#","depth":"#, depth, number);
            text.push(b'}');
            before = b',';
        }
    }
    text.push(b'}');
}

fn counts(text: &mut Vec<u8>, StepCounts { planar_problems, supports, pivots }: &StepCounts) {
    text.extend_from_slice(br#"{"planar_problems":"#);
    count(text, *planar_problems);
    text.extend_from_slice(br#","supports":"#);
    count(text, *supports);
    text.extend_from_slice(br#","pivots":"#);
    count(text, *pivots);
    text.push(b'}');
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use super::super::{Name, StartOverlap};
    use super::*;

    fn full() -> Record {
        let excess =
            Excess { hull_volume: 0.1, part_volume: None, is_closed: false, depth: Some(2.0) };
        let overlap = StartOverlap { moving: Some("a\"b".into()), fixed: None, depth: Some(0.5) };
        let bounded = |value| Bounded { value, lower: 2.0, upper: f64::INFINITY };
        let feature = |vertices| FeatureRecord { kind: "edge", vertices };
        Record {
            outcome: Name::Blocked,
            direction: Some([1.0, -2.5, 1e-7]),
            distance: Some(1e300),
            back: Some(1.0 / 3.0),
            on: Some(123_456_789.0),
            translation: Some(bounded(-0.0)),
            shrunk_distance: Some(bounded(f64::from_bits(1))),
            exit: Some(bounded(f64::NAN)),
            moving: Some("μ\n".into()),
            fixed: Some("b\\c".into()),
            normal: Some([0.0, 0.6, 0.8]),
            point: Some([1e16, 1e15, 123_456.789]),
            rounding: Some(4.3e-13),
            tolerance: Some(0.1),
            start_overlaps: vec![overlap],
            surfaces: vec!["moving", "fixed"],
            features: Some(Features { moving: feature(vec![7, 12]), fixed: feature(vec![]) }),
            margin: Some(5.0),
            overlap: Some(-0.25),
            hull: Hulls::of(Some(excess), Some(Excess { part_volume: Some(3.0), ..excess })),
            solver: Some("portal"),
            steps: Some(StepCounts { planar_problems: 1, supports: 2, pivots: u32::MAX }),
            message: Some("say \"no\"\t\u{1}".into()),
            notes: vec!["one".into(), "two".into()],
        }
    }

    /// The same record, as `serde_json` writes it.
    fn known() -> Value {
        json!({
            "id": [1, "x"],
            "outcome": "blocked",
            "direction": [1.0, -2.5, 1e-7],
            "distance": 1e300,
            "back": 1.0 / 3.0,
            "on": 123_456_789.0,
            "translation": -0.0,
            "translation_bounds": [2.0, null],
            "shrunk_distance": f64::from_bits(1),
            "shrunk_distance_bounds": [2.0, null],
            "exit": null,
            "exit_bounds": [2.0, null],
            "moving": "μ\n",
            "fixed": "b\\c",
            "normal": [0.0, 0.6, 0.8],
            "point": [1e16, 1e15, 123_456.789],
            "rounding": 4.3e-13,
            "tolerance": 0.1,
            "start_overlaps": [{"moving": "a\"b", "depth": 0.5}],
            "surfaces": ["moving", "fixed"],
            "features": {
                "moving": {"kind": "edge", "vertices": [7, 12]},
                "fixed": {"kind": "edge", "vertices": []},
            },
            "margin": 5.0,
            "overlap": -0.25,
            "hull": {
                "moving": {"hull_volume": 0.1, "depth": 2.0},
                "fixed": {"hull_volume": 0.1, "part_volume": 3.0, "depth": 2.0},
            },
            "solver": "portal",
            "steps": {"planar_problems": 1, "supports": 2, "pivots": u32::MAX},
            "message": "say \"no\"\t\u{1}",
            "notes": ["one", "two"],
        })
    }

    /// `name` and its value as `serde_json` writes them.
    fn pieces(value: &Value) -> Vec<String> {
        let fields = value.as_object().unwrap();
        fields.iter().map(|(name, value)| format!("\"{name}\":{value}")).collect()
    }

    #[test]
    fn every_field_is_written_as_serde_writes_it() {
        let mut text = Vec::new();
        full().write_line(Some(r#"[1,"x"]"#), &mut text);
        let line = String::from_utf8(text).unwrap();
        assert!(line.ends_with("}\n"));
        let read: Value = serde_json::from_str(&line).unwrap();
        assert_eq!(read, known());
        for piece in pieces(&known()).iter().filter(|p| !p.contains('{')) {
            assert!(line.contains(piece), "{piece}");
        }
    }

    #[test]
    fn what_is_not_there_is_not_written() {
        assert_eq!(Record::default().json(), "{\"outcome\":\"error\"}\n");
        let mut text = b"before\n".to_vec();
        Record::default().write_line(Some("null"), &mut text);
        assert_eq!(text, b"before\n{\"id\":null,\"outcome\":\"error\"}\n");
    }
}
