//! Lines as programs write them, read without `serde_json`.
//!
//! Reading is what a line costs beside its answer, and nearly all lines have one form: known names,
//! plain numbers, no escapes. What has it is read here in one go; of everything else nothing is said,
//! and `serde_json` reads it and tells what is wrong with it. Invariant: what is read here, `serde_json`
//! reads in the same way, to the last bit. What is said of a body is handed on as it is written.

use colltrans::Solver;
use serde::Deserialize;
use serde::de::value::{Error, StrDeserializer};
use serde_json::value::RawValue;

use super::source::{Asked, PoseSource, Query};

/// The query of a line, if it has the usual form.
pub(super) fn read(text: &str) -> Option<Query<'_, &str>> {
    let mut reader = Reader { text, at: 0 };
    let mut found = Found::default();
    reader.fields(|reader, name| found.take(reader, name))?;
    reader.space();
    if reader.at < text.len() {
        return None;
    }
    Some(Query {
        id: found.id,
        moving: found.moving?,
        fixed: found.fixed?,
        moving_pose: found.moving_pose,
        fixed_pose: found.fixed_pose,
        direction: found.direction,
        question: found.question,
        moving_motion: None,
        fixed_motion: None,
        length: found.length,
        graze_tolerance: found.graze_tolerance,
        solver: found.solver,
        start: None,
        until: None,
        tolerance: None,
        ignore_start_overlaps: None,
        keep: found.keep,
    })
}

/// The fields of a line that were met.
#[derive(Default)]
struct Found<'a> {
    id: Option<&'a RawValue>,
    moving: Option<&'a str>,
    fixed: Option<&'a str>,
    moving_pose: Option<PoseSource>,
    fixed_pose: Option<PoseSource>,
    direction: Option<[f64; 3]>,
    question: Option<Asked>,
    length: Option<f64>,
    graze_tolerance: Option<f64>,
    keep: Option<f64>,
    solver: Option<Solver>,
}

impl<'a> Found<'a> {
    fn take(&mut self, reader: &mut Reader<'a>, name: &str) -> Option<()> {
        match name {
            "id" => once(&mut self.id, reader.scalar()?),
            "moving" => once(&mut self.moving, reader.flat_object()?),
            "fixed" => once(&mut self.fixed, reader.flat_object()?),
            "moving_pose" => once(&mut self.moving_pose, reader.pose()?),
            "fixed_pose" => once(&mut self.fixed_pose, reader.pose()?),
            "direction" => once(&mut self.direction, reader.numbers()?),
            "graze_tolerance" => once(&mut self.graze_tolerance, reader.number()?),
            "keep" => once(&mut self.keep, reader.number()?),
            "query" => once(&mut self.question, reader.word()?),
            "length" => once(&mut self.length, reader.number()?),
            "solver" => once(&mut self.solver, reader.word()?),
            _ => None,
        }
    }
}

/// A name that comes twice is not usual.
fn once<T>(place: &mut Option<T>, value: T) -> Option<()> {
    place.replace(value).is_none().then_some(())
}

struct Reader<'a> {
    text: &'a str,
    at: usize,
}

impl<'a> Reader<'a> {
    fn peek(&self) -> Option<u8> {
        self.text.as_bytes().get(self.at).copied()
    }

    fn space(&mut self) {
        while matches!(self.peek(), Some(b' ' | b'\t' | b'\r' | b'\n')) {
            self.at += 1;
        }
    }

    /// Goes over this character, and the white space before it.
    fn pass(&mut self, expected: u8) -> Option<()> {
        self.space();
        (self.peek()? == expected).then(|| self.at += 1)
    }

    /// Whether there is another element; goes over the comma, or over the end.
    fn another(&mut self, end: u8) -> Option<bool> {
        self.space();
        let next = self.peek()?;
        self.at += 1;
        (next == b',' || next == end).then_some(next == b',')
    }

    /// An object of at least one field; `take` reads the value of a field by its name.
    fn fields(&mut self, mut take: impl FnMut(&mut Self, &str) -> Option<()>) -> Option<()> {
        self.pass(b'{')?;
        loop {
            let name = self.string()?;
            self.pass(b':')?;
            take(self, name)?;
            if !self.another(b'}')? {
                return Some(());
            }
        }
    }

    /// A string without escapes.
    fn string(&mut self) -> Option<&'a str> {
        self.pass(b'"')?;
        let start = self.at;
        self.skip_string()?;
        self.text.get(start..self.at - 1)
    }

    /// A string that is the name of something.
    fn word<T: Deserialize<'a>>(&mut self) -> Option<T> {
        T::deserialize(StrDeserializer::<Error>::new(self.string()?)).ok()
    }

    /// From within a string to behind it.
    fn skip_string(&mut self) -> Option<()> {
        loop {
            let byte = self.peek()?;
            self.at += 1;
            match byte {
                b'"' => return Some(()),
                b'\\' | 0..0x20 => return None,
                _ => {}
            }
        }
    }

    /// An object that holds no other, as it is written.
    fn flat_object(&mut self) -> Option<&'a str> {
        self.pass(b'{')?;
        let start = self.at - 1;
        loop {
            let byte = self.peek()?;
            self.at += 1;
            match byte {
                b'"' => self.skip_string()?,
                b'{' => return None,
                b'}' => return self.text.get(start..self.at),
                _ => {}
            }
        }
    }

    /// A string or a word, as it is written.
    fn scalar(&mut self) -> Option<&'a RawValue> {
        self.space();
        let start = self.at;
        if self.peek()? == b'"' {
            self.string()?;
        } else {
            while !matches!(self.peek()?, b',' | b'}' | b'{' | b'[') {
                self.at += 1;
            }
        }
        serde_json::from_str(self.text.get(start..self.at)?).ok()
    }

    fn pose(&mut self) -> Option<PoseSource> {
        let (mut translation, mut rotation) = (None, None);
        self.fields(|reader, name| match name {
            "translation" => once(&mut translation, reader.numbers()?),
            "rotation" => once(&mut rotation, reader.numbers()?),
            _ => None,
        })?;
        let still = PoseSource::default();
        let translation = translation.unwrap_or(still.translation);
        Some(PoseSource { translation, rotation: rotation.unwrap_or(still.rotation) })
    }

    /// An array of exactly so many numbers.
    fn numbers<const N: usize>(&mut self) -> Option<[f64; N]> {
        self.pass(b'[')?;
        let mut numbers = [0.0; N];
        for (i, number) in numbers.iter_mut().enumerate() {
            *number = self.number()?;
            if self.another(b']')? != (i + 1 < N) {
                return None;
            }
        }
        Some(numbers)
    }

    /// A finite number, as JSON writes it: without a plus, with digits before and after the point, and no zero
    /// before others.
    fn number(&mut self) -> Option<f64> {
        self.space();
        let start = self.at;
        self.skip(|byte| byte == b'-');
        match self.peek()? {
            b'0' => self.at += 1,
            _ => self.digits()?,
        }
        if self.skip(|byte| byte == b'.') {
            self.digits()?;
        }
        if self.skip(|byte| matches!(byte, b'e' | b'E')) {
            self.skip(|byte| matches!(byte, b'-' | b'+'));
            self.digits()?;
        }
        let number: f64 = self.text.get(start..self.at)?.parse().ok()?;
        Some(number).filter(|number| number.is_finite())
    }

    /// Goes over a character, if it is such a one.
    fn skip(&mut self, is_one: impl FnOnce(u8) -> bool) -> bool {
        let found = self.peek().is_some_and(is_one);
        self.at += usize::from(found);
        found
    }

    /// One digit or more.
    fn digits(&mut self) -> Option<()> {
        let rest = self.text.as_bytes().get(self.at..)?;
        let count = rest.iter().take_while(|byte| byte.is_ascii_digit()).count();
        self.at += count;
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
        r#"{"moving":{"mesh":"a"},"fixed":{"mesh":"b"},"direction":[0.1,2.2250738585072011e-308,5e-324],"solver":"portal","keep":2.5e-1,"query":"contact"}"#,
        r#"{"moving":{"mesh":"a"},"fixed":{"mesh":"b"},"query":"within","length":0.125}"#,
    ];

    fn bits(query: &Query<'_, impl Sized>) -> String {
        let Query { moving_pose, fixed_pose, direction, graze_tolerance, length, keep, .. } = query;
        let numbers = [moving_pose, fixed_pose]
            .into_iter()
            .flatten()
            .flat_map(|pose| pose.translation.into_iter().chain(pose.rotation))
            .chain(direction.iter().flatten().copied())
            .chain(*graze_tolerance)
            .chain(*length)
            .chain(*keep);
        let bits: Vec<u64> = numbers.map(f64::to_bits).collect();
        let id = query.id.map(RawValue::get);
        format!("{id:?} {bits:?} {:?} {:?}", query.question, query.solver)
    }

    /// Whether the line has the usual form; if so, that `serde_json` reads the same.
    fn agrees(line: &str) -> bool {
        let Some(query) = read(line) else { return false };
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
    fn usual_lines_are_read_as_serde_reads_them() {
        assert_eq!(LINES.map(agrees), [true, false, true, true, true]);
        assert!(agrees(&LINES[1].replace("\\u00fc", "ü")));
    }

    #[test]
    fn a_line_that_was_changed_is_refused_or_read_as_serde_reads_it() {
        let parts = ["", " ", "\"", ",", "{", "}", "[", "]", ":", "0", "1", "-", "+", ".", "e9"];
        let more = ["\\", "1e999", "null", "true", "\t", "\u{1}", "é", "01", "NaN", "\"id\":1,"];
        let mut usual = 0;
        for line in LINES {
            for at in (0..=line.len()).filter(|&at| line.is_char_boundary(at)) {
                for part in parts.into_iter().chain(more) {
                    let (before, after) = line.split_at(at);
                    usual += usize::from(agrees(&format!("{before}{part}{after}")));
                    let mut rest = after.chars();
                    rest.next();
                    usual += usize::from(agrees(&format!("{before}{part}{}", rest.as_str())));
                }
                assert!(!agrees(&line[..at]) || line[at..].trim().is_empty(), "{line} {at}");
            }
        }
        assert!(usual > 3000, "{usual}");
    }
}
