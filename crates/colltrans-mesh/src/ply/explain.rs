//! Explains errors in the header or a text row of a PLY file, with the line. The messages of the parser are
//! shorter and use the terms of its grammar.

use ply_rs_bw::ply::{ElementDef, PropertyType, ScalarType};

use crate::error::{Fault, Place};
use crate::text::{lines, quoted};

/// The names of the types of PLY.
const TYPES: [&str; 16] = [
    "char", "uchar", "short", "ushort", "int", "uint", "float", "double", "int8", "uint8", "int16",
    "uint16", "int32", "uint32", "float32", "float64",
];

/// Finds the error in a header; `None` if this module does not recognise it.
pub(super) fn header_error(bytes: &[u8]) -> Option<Fault> {
    if bytes.is_empty() {
        return None;
    }
    let text = String::from_utf8_lossy(bytes);
    let (mut last, mut has_format, mut has_element) = (0, false, false);
    for (k, line) in lines(&text).enumerate() {
        let fault = |what: String| Some(Fault::new(Place::Line(k + 1), what));
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        let refused = match words[..] {
            ["ply"] if k == 0 => None,
            _ if k == 0 => {
                Some(format!("the first line of a PLY file must be `ply`, found {}", quoted(line)))
            }
            ["end_header"] if has_format => return None,
            ["end_header"] => Some("the header has no line `format`".into()),
            ["format", ..] => {
                has_format = true;
                format_error(&words)
            }
            ["comment" | "obj_info", ..] => None,
            ["element", ..] => {
                has_element = true;
                element_error(&words)
            }
            ["property", ..] if !has_element => {
                Some("`property` before the first `element`".into())
            }
            ["property", ..] => property_error(&words),
            _ => Some(keyword_error(line)),
        };
        if let Some(what) = refused {
            return fault(what);
        }
        last = k + 1;
    }
    let what = "the file ends within the header, before `end_header`";
    Some(Fault::new(Place::Line(last + 1), what))
}

/// Checks a line `format`. Returns a message if it is invalid.
fn format_error(words: &[&str]) -> Option<String> {
    let known = ["ascii", "binary_little_endian", "binary_big_endian"];
    match words {
        [_, kind, _] if known.contains(kind) => None,
        [_, kind, _] => {
            Some(format!("unknown format {}; accepted: {}", quoted(kind), known.join(", ")))
        }
        _ => Some("expected the name of a format and its version, as in `format ascii 1.0`".into()),
    }
}

/// Checks a line `element`. Returns a message if it is invalid.
fn element_error(words: &[&str]) -> Option<String> {
    match words {
        [_, _, count] if count.parse::<usize>().is_ok() => None,
        [_, name, count] => {
            Some(format!("{} is not a valid number of elements {}", quoted(count), quoted(name)))
        }
        _ => Some("expected the name and the number of elements, as in `element vertex 8`".into()),
    }
}

/// Checks a line `property`. Returns a message if it is invalid.
fn property_error(words: &[&str]) -> Option<String> {
    let types = match words {
        [_, "list", count, value, _] => &[*count, *value][..],
        [_, kind, _] if *kind != "list" => &[*kind][..],
        _ => {
            let text = "expected the type and the name of a property, as in `property float x` or `property \
                        list uchar int vertex_indices`";
            return Some(text.into());
        }
    };
    let unknown = types.iter().find(|kind| !TYPES.contains(kind))?;
    Some(format!("unknown type {}; accepted: {}", quoted(unknown), TYPES[..8].join(", ")))
}

/// Builds the message for a line with an unknown keyword.
fn keyword_error(line: &str) -> String {
    let first = line.split_ascii_whitespace().next().unwrap_or_default();
    if first.parse::<f64>().is_ok() {
        return "a row of numbers in the header; `end_header` is missing before it".into();
    }
    let known = "format, comment, obj_info, element, property, end_header";
    format!("unknown keyword {}; accepted: {known}", quoted(first))
}

/// Finds the error in a row of an element; `None` if this module does not recognise it.
pub(super) fn row_error(line: &str, element: &ElementDef) -> Option<String> {
    let mut words = line.split_ascii_whitespace();
    for (name, property) in &element.properties {
        let mut next = |of: &str, kind: &ScalarType| {
            let missing = || format!("the line ends before {of} of {}", quoted(name));
            let word = words.next().ok_or_else(missing)?;
            if is_number(word, kind) { Ok(word) } else { Err(number_error(word, kind)) }
        };
        let outcome = match &property.data_type {
            PropertyType::Scalar(kind) => next("the number", kind).map(|_| ()),
            PropertyType::List(count, kind) => next("the length", count).and_then(|length| {
                let length = length.parse::<u64>().unwrap_or_default();
                (1..=length).try_for_each(|k| {
                    next(&format!("number {k} of the {length}"), kind).map(|_| ())
                })
            }),
        };
        if let Err(what) = outcome {
            return Some(what);
        }
    }
    None
}

/// Returns the smallest and the largest value of an integer type; `None` for other types.
fn integer_range(kind: &ScalarType) -> Option<[i64; 2]> {
    match kind {
        ScalarType::Char => Some([i8::MIN.into(), i8::MAX.into()]),
        ScalarType::UChar => Some([0, u8::MAX.into()]),
        ScalarType::Short => Some([i16::MIN.into(), i16::MAX.into()]),
        ScalarType::UShort => Some([0, u16::MAX.into()]),
        ScalarType::Int => Some([i32::MIN.into(), i32::MAX.into()]),
        ScalarType::UInt => Some([0, u32::MAX.into()]),
        ScalarType::Float | ScalarType::Double => None,
    }
}

/// Checks whether a word is a value of this type.
fn is_number(word: &str, kind: &ScalarType) -> bool {
    match integer_range(kind) {
        None => word.parse::<f64>().is_ok(),
        Some([low, high]) => word.parse::<i64>().is_ok_and(|x| (low..=high).contains(&x)),
    }
}

/// Builds the message for a word that is not a value of this type.
fn number_error(word: &str, kind: &ScalarType) -> String {
    match integer_range(kind) {
        None => format!("{} is not a number", quoted(word)),
        Some([low, high]) => format!("{} is not an integer from {low} to {high}", quoted(word)),
    }
}
