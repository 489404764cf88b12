//! Parses query lines of the usual form without `serde_json`: known names, plain numbers, no escapes.
//!
//! Parsing is the main cost of a line besides its answer. Other lines are left to `serde_json`, which also reports their
//! errors. The text of a body is returned without being parsed.
//!
//! Invariant: `serde_json` parses every line that is parsed here to the same values, bit by bit.

use colltrans::Solver;
use serde::Deserialize;
use serde::de::value::{Error, StrDeserializer};
use serde_json::value::RawValue;

use super::source::{PoseSource, Query, QueryName};

/// Returns the query of a line; `None` if the line does not have the usual form.
pub(super) fn parse_usual_line(text: &str) -> Option<Query<'_, &str>> {
    let mut reader = Reader { text, position: 0 };
    let mut fields = Fields::default();
    reader.object(|reader, name| fields.read_field(reader, name))?;
    reader.skip_space();
    if reader.position < text.len() {
        return None;
    }
    Some(Query {
        id: fields.id,
        moving: fields.moving?,
        fixed: fields.fixed?,
        moving_pose: fields.moving_pose,
        fixed_pose: fields.fixed_pose,
        direction: fields.direction,
        question: fields.question,
        moving_motion: None,
        fixed_motion: None,
        length: fields.length,
        graze_tolerance: fields.graze_tolerance,
        solver: fields.solver,
        start: None,
        until: None,
        cuts: None,
        across_cells: None,
        cold: None,
        tolerance: None,
        ignore_start_overlaps: None,
        min_gap: fields.min_gap,
    })
}

/// The fields of a line that have been read.
#[derive(Default)]
struct Fields<'a> {
    id: Option<&'a RawValue>,
    moving: Option<&'a str>,
    fixed: Option<&'a str>,
    moving_pose: Option<PoseSource>,
    fixed_pose: Option<PoseSource>,
    direction: Option<[f64; 3]>,
    question: Option<QueryName>,
    length: Option<f64>,
    graze_tolerance: Option<f64>,
    min_gap: Option<f64>,
    solver: Option<Solver>,
}

impl<'a> Fields<'a> {
    /// Reads the value of a field. Returns `None` if the name is unknown or repeated, or the value has another form.
    fn read_field(&mut self, reader: &mut Reader<'a>, name: &str) -> Option<()> {
        match name {
            "id" => set_once(&mut self.id, reader.scalar()?),
            "moving" => set_once(&mut self.moving, reader.flat_object()?),
            "fixed" => set_once(&mut self.fixed, reader.flat_object()?),
            "moving_pose" => set_once(&mut self.moving_pose, reader.pose()?),
            "fixed_pose" => set_once(&mut self.fixed_pose, reader.pose()?),
            "direction" => set_once(&mut self.direction, reader.numbers()?),
            "graze_tolerance" => set_once(&mut self.graze_tolerance, reader.number()?),
            "min_gap" => set_once(&mut self.min_gap, reader.number()?),
            "query" => set_once(&mut self.question, reader.name()?),
            "length" => set_once(&mut self.length, reader.number()?),
            "solver" => set_once(&mut self.solver, reader.name()?),
            _ => None,
        }
    }
}

/// Sets a value; returns `None` if it was set before.
fn set_once<T>(place: &mut Option<T>, value: T) -> Option<()> {
    place.replace(value).is_none().then_some(())
}

/// A position in a line. Methods return `None` if the text has another form.
struct Reader<'a> {
    text: &'a str,
    position: usize,
}

impl<'a> Reader<'a> {
    /// Returns the next byte.
    fn peek(&self) -> Option<u8> {
        self.text.as_bytes().get(self.position).copied()
    }

    /// Skips white space.
    fn skip_space(&mut self) {
        while matches!(self.peek(), Some(b' ' | b'\t' | b'\r' | b'\n')) {
            self.position += 1;
        }
    }

    /// Reads white space and this character.
    fn expect(&mut self, expected: u8) -> Option<()> {
        self.skip_space();
        (self.peek()? == expected).then(|| self.position += 1)
    }

    /// Reads a comma or the end of a list. Checks whether another element follows.
    fn has_next(&mut self, end: u8) -> Option<bool> {
        self.skip_space();
        let next = self.peek()?;
        self.position += 1;
        (next == b',' || next == end).then_some(next == b',')
    }

    /// Reads an object of at least one field. `read_value` reads the value of the field with a name.
    fn object(&mut self, mut read_value: impl FnMut(&mut Self, &str) -> Option<()>) -> Option<()> {
        self.expect(b'{')?;
        loop {
            let name = self.string()?;
            self.expect(b':')?;
            read_value(self, name)?;
            if !self.has_next(b'}')? {
                return Some(());
            }
        }
    }

    /// Reads a string without escapes.
    fn string(&mut self) -> Option<&'a str> {
        self.expect(b'"')?;
        let start = self.position;
        self.skip_string()?;
        self.text.get(start..self.position - 1)
    }

    /// Reads a string that is the name of a variant.
    fn name<T: Deserialize<'a>>(&mut self) -> Option<T> {
        T::deserialize(StrDeserializer::<Error>::new(self.string()?)).ok()
    }

    /// Skips the rest of a string and its closing quote.
    fn skip_string(&mut self) -> Option<()> {
        loop {
            let byte = self.peek()?;
            self.position += 1;
            match byte {
                b'"' => return Some(()),
                b'\\' | 0..0x20 => return None,
                _ => {}
            }
        }
    }

    /// Reads an object without nested objects. Returns its text.
    fn flat_object(&mut self) -> Option<&'a str> {
        self.expect(b'{')?;
        let start = self.position - 1;
        loop {
            let byte = self.peek()?;
            self.position += 1;
            match byte {
                b'"' => self.skip_string()?,
                b'{' => return None,
                b'}' => return self.text.get(start..self.position),
                _ => {}
            }
        }
    }

    /// Reads a string, a number or a literal. Returns its text.
    fn scalar(&mut self) -> Option<&'a RawValue> {
        self.skip_space();
        let start = self.position;
        if self.peek()? == b'"' {
            self.string()?;
        } else {
            while !matches!(self.peek()?, b',' | b'}' | b'{' | b'[') {
                self.position += 1;
            }
        }
        serde_json::from_str(self.text.get(start..self.position)?).ok()
    }

    /// Reads a pose. An absent translation or rotation is the identity.
    fn pose(&mut self) -> Option<PoseSource> {
        let (mut translation, mut rotation) = (None, None);
        self.object(|reader, name| match name {
            "translation" => set_once(&mut translation, reader.numbers()?),
            "rotation" => set_once(&mut rotation, reader.numbers()?),
            _ => None,
        })?;
        let identity = PoseSource::default();
        let translation = translation.unwrap_or(identity.translation);
        Some(PoseSource { translation, rotation: rotation.unwrap_or(identity.rotation) })
    }

    /// Reads an array of exactly `N` numbers.
    fn numbers<const N: usize>(&mut self) -> Option<[f64; N]> {
        self.expect(b'[')?;
        let mut numbers = [0.0; N];
        for (i, number) in numbers.iter_mut().enumerate() {
            *number = self.number()?;
            if self.has_next(b']')? != (i + 1 < N) {
                return None;
            }
        }
        Some(numbers)
    }

    /// Reads a finite number in the syntax of JSON: no plus sign, digits before and after the point, no leading zeros.
    fn number(&mut self) -> Option<f64> {
        self.skip_space();
        let start = self.position;
        self.skip(|byte| byte == b'-');
        match self.peek()? {
            b'0' => self.position += 1,
            _ => self.skip_digits()?,
        }
        if self.skip(|byte| byte == b'.') {
            self.skip_digits()?;
        }
        if self.skip(|byte| matches!(byte, b'e' | b'E')) {
            self.skip(|byte| matches!(byte, b'-' | b'+'));
            self.skip_digits()?;
        }
        let number: f64 = self.text.get(start..self.position)?.parse().ok()?;
        Some(number).filter(|number| number.is_finite())
    }

    /// Skips the next byte if `accepts` returns true for it. Returns whether it did.
    fn skip(&mut self, accepts: impl FnOnce(u8) -> bool) -> bool {
        let found = self.peek().is_some_and(accepts);
        self.position += usize::from(found);
        found
    }

    /// Skips one digit or more.
    fn skip_digits(&mut self) -> Option<()> {
        let rest = self.text.as_bytes().get(self.position..)?;
        let count = rest.iter().take_while(|byte| byte.is_ascii_digit()).count();
        self.position += count;
        (count > 0).then_some(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::source::BodySource;
    use super::*;

    const LINES: [&str; 5] = [
        r#"{"id": "q0", "moving": {"mesh": "a.off"}, "fixed": {"mesh": "b.off"}, "moving_pose": {"translation": [0.25942905256569254, -1.5e-3, 6], "rotation": [0.5, 0.5, -0.5, 0.5]}, "direction": [0.034274851448885826, -0, -1]}"#,
        r#"{"direction":[1E5,0.10,1e+2],"query":"clearance","solver":"cta","graze_tolerance":0.5,"fixed_pose":{"rotation":[0,0,0,1]},"fixed":{"points":[[0,0,0],[1,1,1]]},"moving":{"solid":"\u00fc}"},"id":17}"#,
        r#" { "id" : null , "moving" : { "mesh" : "}{é" , "scale" : 2 } , "fixed" : { } , "direction" : [ 1 , 2 , 123456789012345678901234567890 ] } "#,
        r#"{"moving":{"mesh":"a"},"fixed":{"mesh":"b"},"direction":[0.1,2.2250738585072011e-308,5e-324],"solver":"portal","min_gap":2.5e-1,"query":"contact"}"#,
        r#"{"moving":{"mesh":"a"},"fixed":{"mesh":"b"},"query":"within","length":0.125}"#,
    ];

    fn bits(query: &Query<'_, impl Sized>) -> String {
        let Query { moving_pose, fixed_pose, direction, graze_tolerance, length, min_gap, .. } =
            query;
        let numbers = [moving_pose, fixed_pose]
            .into_iter()
            .flatten()
            .flat_map(|pose| pose.translation.into_iter().chain(pose.rotation))
            .chain(direction.iter().flatten().copied())
            .chain(*graze_tolerance)
            .chain(*length)
            .chain(*min_gap);
        let bits: Vec<u64> = numbers.map(f64::to_bits).collect();
        let id = query.id.map(RawValue::get);
        format!("{id:?} {bits:?} {:?} {:?}", query.question, query.solver)
    }

    /// Checks whether the line has the usual form, and then asserts that `serde_json` parses the same values.
    fn agrees_with_serde(line: &str) -> bool {
        let Some(query) = parse_usual_line(line) else { return false };
        let bodies = [query.moving, query.fixed].map(serde_json::from_str::<BodySource>);
        let known = serde_json::from_str::<Query<'_, BodySource>>(line);
        let [Ok(moving), Ok(fixed)] = bodies else {
            assert!(known.is_err(), "{line}");
            return true;
        };
        let known = known.unwrap_or_else(|error| panic!("{error}: {line}"));
        assert_eq!(bits(&query), bits(&known), "{line}");
        assert_eq!(
            format!("{moving:?} {fixed:?}"),
            format!("{:?} {:?}", known.moving, known.fixed)
        );
        assert_eq!((known.tolerance, known.ignore_start_overlaps), (None, None));
        true
    }

    #[test]
    fn usual_lines_match_serde() {
        assert_eq!(LINES.map(agrees_with_serde), [true, false, true, true, true]);
        assert!(agrees_with_serde(&LINES[1].replace("\\u00fc", "ü")));
    }

    #[test]
    fn mutated_line_is_rejected_or_matches_serde() {
        let parts = ["", " ", "\"", ",", "{", "}", "[", "]", ":", "0", "1", "-", "+", ".", "e9"];
        let more = ["\\", "1e999", "null", "true", "\t", "\u{1}", "é", "01", "NaN", "\"id\":1,"];
        let mut usual = 0;
        for line in LINES {
            for at in (0..=line.len()).filter(|&at| line.is_char_boundary(at)) {
                for part in parts.into_iter().chain(more) {
                    let (before, after) = line.split_at(at);
                    usual += usize::from(agrees_with_serde(&format!("{before}{part}{after}")));
                    let mut rest = after.chars();
                    rest.next();
                    usual +=
                        usize::from(agrees_with_serde(&format!("{before}{part}{}", rest.as_str())));
                }
                assert!(
                    !agrees_with_serde(&line[..at]) || line[at..].trim().is_empty(),
                    "{line} {at}"
                );
            }
        }
        assert!(usual > 3000, "{usual}");
    }
}
