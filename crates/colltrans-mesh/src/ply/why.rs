//! Explains why the parser has refused a header or a row of text: in words, with the line. It tells less
//! itself, and in terms of its grammar.

use ply_rs_bw::ply::{ElementDef, PropertyType, ScalarType};

use crate::error::{Fault, Place};
use crate::text::{lines, quoted};

const TYPES: [&str; 16] = [
    "char", "uchar", "short", "ushort", "int", "uint", "float", "double", "int8", "uint8", "int16",
    "uint16", "int32", "uint32", "float32", "float64",
];

/// What is wrong with a header; `None` if nothing that is known here.
pub(super) fn header(bytes: &[u8]) -> Option<Fault> {
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
                Some(format!("the first line of a PLY file is `ply`, not {}", quoted(line)))
            }
            ["end_header"] if has_format => return None,
            ["end_header"] => Some("the header ends without a line `format`".into()),
            ["format", ..] => {
                has_format = true;
                format(&words)
            }
            ["comment" | "obj_info", ..] => None,
            ["element", ..] => {
                has_element = true;
                element(&words)
            }
            ["property", ..] if !has_element => {
                Some("a property before the first `element`".into())
            }
            ["property", ..] => property(&words),
            _ => Some(no_keyword(line)),
        };
        if let Some(what) = refused {
            return fault(what);
        }
        last = k + 1;
    }
    let what = "the file ends within the header, before `end_header`";
    Some(Fault::new(Place::Line(last + 1), what))
}

fn format(words: &[&str]) -> Option<String> {
    let known = ["ascii", "binary_little_endian", "binary_big_endian"];
    match words {
        [_, kind, _] if known.contains(kind) => None,
        [_, kind, _] => {
            Some(format!("the format {} is none of {}", quoted(kind), known.join(", ")))
        }
        _ => Some("not the name of a format and its version, as in `format ascii 1.0`".into()),
    }
}

fn element(words: &[&str]) -> Option<String> {
    match words {
        [_, _, count] if count.parse::<usize>().is_ok() => None,
        [_, name, count] => {
            Some(format!("{} is not a number of elements {}", quoted(count), quoted(name)))
        }
        _ => Some("not the name of an element and their number, as in `element vertex 8`".into()),
    }
}

fn property(words: &[&str]) -> Option<String> {
    let types = match words {
        [_, "list", count, value, _] => &[*count, *value][..],
        [_, kind, _] if *kind != "list" => &[*kind][..],
        _ => {
            let text = "not the type of a property and its name, as in `property float x` or `property \
                        list uchar int vertex_indices`";
            return Some(text.into());
        }
    };
    let unknown = types.iter().find(|kind| !TYPES.contains(kind))?;
    Some(format!("the type {} is none of {}", quoted(unknown), TYPES[..8].join(", ")))
}

fn no_keyword(line: &str) -> String {
    let first = line.split_ascii_whitespace().next().unwrap_or_default();
    if first.parse::<f64>().is_ok() {
        return "a row of numbers within the header: `end_header` is missing before it".into();
    }
    let known = "format, comment, obj_info, element, property, end_header";
    format!("{} is not a word that a header's line begins with: {known}", quoted(first))
}

/// What is wrong with a row of an element; `None` if nothing that is known here.
pub(super) fn row(line: &str, element: &ElementDef) -> Option<String> {
    let mut words = line.split_ascii_whitespace();
    for (name, property) in &element.properties {
        let mut next = |of: &str, kind: &ScalarType| {
            let missing = || format!("the line ends before {of} of {}", quoted(name));
            let word = words.next().ok_or_else(missing)?;
            if is_number(word, kind) { Ok(word) } else { Err(no_number(word, kind)) }
        };
        let told = match &property.data_type {
            PropertyType::Scalar(kind) => next("the number", kind).map(|_| ()),
            PropertyType::List(count, kind) => next("the length", count).and_then(|length| {
                let length = length.parse::<u64>().unwrap_or_default();
                (1..=length).try_for_each(|k| {
                    next(&format!("number {k} of the {length}"), kind).map(|_| ())
                })
            }),
        };
        if let Err(what) = told {
            return Some(what);
        }
    }
    None
}

/// The least and the largest whole number of a type; `None` of numbers with fractions.
fn range(kind: &ScalarType) -> Option<[i64; 2]> {
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

fn is_number(word: &str, kind: &ScalarType) -> bool {
    match range(kind) {
        None => word.parse::<f64>().is_ok(),
        Some([low, high]) => word.parse::<i64>().is_ok_and(|x| (low..=high).contains(&x)),
    }
}

fn no_number(word: &str, kind: &ScalarType) -> String {
    match range(kind) {
        None => format!("{} is not a number", quoted(word)),
        Some([low, high]) => format!("{} is not a whole number from {low} to {high}", quoted(word)),
    }
}
