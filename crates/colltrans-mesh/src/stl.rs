//! Reads STL, binary (with `stl_io`) and text.
//!
//! - A binary file has a header of 80 bytes, a count `n`, and `50 n` bytes of triangles. A file with exactly
//!   this size is binary, even if it begins with `solid`.
//! - Another file is text if it begins with `solid`, possibly after comments (`;`, `#`, `//`), and either has
//!   no control characters or has a second line of text STL. Other text is rejected.
//! - NUL and Ctrl-Z at the start and at the end are padding.
//!
//! This module parses text itself, because a file may have several solids and more digits than single
//! precision, and because errors should have a line. In both cases equal vertices are merged.

use std::io::Cursor;

use glam::DVec3;

use crate::digits::Printed;
use crate::error::{Fault, Place};
use crate::merge::Precision;
use crate::mesh::Mesh;
use crate::text::{lines, number, quoted, without_mark};

/// Number of bytes of the header of a binary file, without the count.
const HEADER_BYTES: usize = 80;
/// Number of bytes of a triangle in a binary file.
const TRIANGLE_BYTES: usize = 50;

/// Parses an STL file. Returns the mesh and the precision of its coordinates.
pub(crate) fn parse_stl(bytes: Vec<u8>) -> Result<(Mesh, Precision), Fault> {
    if bytes.is_empty() {
        return Err(Fault::new(Place::End, "the file is empty"));
    }
    if !is_exactly_binary(&bytes) && is_text(&bytes) {
        let text = without_padding(without_mark(&bytes)?);
        check_end(text)?;
        let text = String::from_utf8_lossy(text);
        return Ok((parse_text(&text)?.weld(), Precision::TEXT));
    }
    if !is_exactly_binary(&bytes) {
        // UTF-16 text is checked first, because it explains the error better.
        reject_other_text(without_mark(&bytes)?)?;
        check_size(&bytes)?;
    }
    Ok((parse_binary(bytes)?.weld(), Precision::SINGLE))
}

/// Checks whether the size equals that given by the triangle count of a binary file.
pub(crate) fn is_exactly_binary(bytes: &[u8]) -> bool {
    implied_size(bytes).is_some_and(|implied| implied == bytes.len() as u64)
}

/// Checks whether the file is text and begins like text STL.
pub(crate) fn is_text(bytes: &[u8]) -> bool {
    let Ok(text) = without_mark(bytes).map(without_leading_padding) else { return false };
    let mut lines = text.split(|byte| matches!(byte, b'\n' | b'\r')).map(<[u8]>::trim_ascii);
    let mut lines = lines.by_ref().filter(|line| !line.is_empty() && !is_comment(line));
    let begins = |line: Option<&[u8]>, word: &[u8]| {
        line.and_then(|line| line.get(..word.len())).is_some_and(|s| s.eq_ignore_ascii_case(word))
    };
    if !begins(lines.next(), b"solid") {
        return false;
    }
    let second = lines.next();
    !has_control(text) || begins(second, b"facet") || begins(second, b"endsolid")
}

/// Checks whether a line is a comment.
fn is_comment(line: &[u8]) -> bool {
    line.starts_with(b";") || line.starts_with(b"#") || line.starts_with(b"//")
}

/// Checks whether a byte is padding, which some programs write before and after text: NUL or Ctrl-Z.
const fn is_padding(byte: u8) -> bool {
    matches!(byte, 0 | 0x1a)
}

/// Removes padding at the start.
fn without_leading_padding(text: &[u8]) -> &[u8] {
    let first = text.iter().position(|byte| !is_padding(*byte));
    &text[first.unwrap_or(0)..]
}

/// Removes padding and whitespace at the end, and padding at the start.
fn without_padding(text: &[u8]) -> &[u8] {
    let text = without_leading_padding(text);
    let is_text = |byte: &u8| !is_padding(*byte) && !byte.is_ascii_whitespace();
    &text[..text.iter().rposition(is_text).map_or(0, |last| last + 1)]
}

/// Checks that nothing follows Ctrl-Z, which ends a text on some systems.
fn check_end(text: &[u8]) -> Result<(), Fault> {
    let Some(end) = text.iter().position(|byte| *byte == 0x1a) else { return Ok(()) };
    let (before, rest) = text.split_at(end);
    let line = lines(&String::from_utf8_lossy(before)).count();
    let what = format!("{} bytes follow Ctrl-Z, which ends the text; delete them", rest.len() - 1);
    Err(Fault::new(Place::Line(line), what))
}

/// Checks that bytes without the beginning of text STL are not text.
fn reject_other_text(bytes: &[u8]) -> Result<(), Fault> {
    let bytes = bytes.strip_suffix(b"\x1a").unwrap_or(bytes);
    if has_control(bytes) {
        return Ok(());
    }
    let text = String::from_utf8_lossy(bytes);
    let is_blank = |line: &str| line.trim().is_empty() || is_comment(line.trim().as_bytes());
    let Some((number, line)) = lines(&text).enumerate().find(|(_, line)| !is_blank(line)) else {
        return Err(Fault::new(Place::End, "text without the line `solid`, with which STL begins"));
    };
    let what = format!("text STL must begin with `solid`, found {}", quoted(line.trim()));
    Err(Fault::new(Place::Line(number + 1), what))
}

/// Checks for control characters, which occur in binary numbers but not in text.
pub(crate) fn has_control(bytes: &[u8]) -> bool {
    bytes.iter().any(|b| *b < b' ' && !(0x09..=0x0d).contains(b))
}

/// Returns the size given by the triangle count of a binary file; `None` if the file is shorter than the
/// header.
fn implied_size(bytes: &[u8]) -> Option<u64> {
    let count = bytes.get(HEADER_BYTES..HEADER_BYTES + 4)?;
    let count = u32::from_le_bytes([count[0], count[1], count[2], count[3]]);
    Some(u64::from(count) * TRIANGLE_BYTES as u64 + HEADER_BYTES as u64 + 4)
}

/// Checks that a binary file has the triangles of its count, followed by zeros or less than one triangle.
fn check_size(bytes: &[u8]) -> Result<(), Fault> {
    let fault = |what: String| Err(Fault::new(Place::End, what));
    let Some(implied) = implied_size(bytes) else {
        return fault(format!(
            "neither text (no `solid` at the start) nor binary ({} bytes; the header has {})",
            bytes.len(),
            HEADER_BYTES + 4
        ));
    };
    let triangles = (implied - HEADER_BYTES as u64 - 4) / TRIANGLE_BYTES as u64;
    if (bytes.len() as u64) < implied {
        return fault(format!(
            "the file is truncated: {triangles} triangles in its header need {implied} bytes, \
             found {}",
            bytes.len()
        ));
    }
    let rest = &bytes[implied as usize..];
    if rest.len() >= TRIANGLE_BYTES && rest.iter().any(|&b| b != 0) {
        return fault(format!(
            "{} unexpected bytes after the {triangles} triangles of the header",
            rest.len()
        ));
    }
    Ok(())
}

/// Parses a binary file.
fn parse_binary(mut bytes: Vec<u8>) -> Result<Mesh, Fault> {
    // `stl_io` would take a file whose header begins with `solid` for text.
    bytes[..HEADER_BYTES].fill(0);
    let fault = |e: std::io::Error| Fault::new(Place::End, e.to_string());
    let mut cursor = Cursor::new(bytes);
    let triangles = stl_io::create_stl_reader(&mut cursor).map_err(fault)?;
    let mut mesh = Mesh::default();
    for triangle in triangles {
        let corners = triangle.map_err(fault)?.vertices;
        push_face(&mut mesh, &corners.map(|c| DVec3::from_array(c.0.map(f64::from))))?;
    }
    Ok(mesh)
}

/// Adds a face with new vertices.
fn push_face(mesh: &mut Mesh, corners: &[DVec3]) -> Result<(), Fault> {
    let first = u32::try_from(mesh.vertices.len()).ok().filter(|f| *f < u32::MAX - 1024);
    let Some(first) = first.filter(|_| corners.len() <= 1024) else {
        return Err(Fault::new(
            Place::Face(mesh.faces.len()),
            "too many corners; accepted: 1024 in a face, less than 2^32 in total",
        ));
    };
    mesh.vertices.extend_from_slice(corners);
    mesh.faces.push((first..first + corners.len() as u32).collect());
    Ok(())
}

/// The innermost element that is open.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum OpenElement {
    Nothing,
    Solid,
    Facet,
    Loop,
}

impl OpenElement {
    /// Returns the name of the element for messages.
    const fn element_name(self) -> &'static str {
        match self {
            Self::Nothing => "file",
            Self::Solid => "solid",
            Self::Facet => "facet",
            Self::Loop => "loop",
        }
    }

    /// Returns the innermost open element after a keyword; `None` if the keyword is not allowed here.
    fn after(self, keyword: &str) -> Option<Self> {
        Some(match (self, keyword) {
            (Self::Nothing, "solid") | (Self::Facet, "endfacet") => Self::Solid,
            (Self::Solid, "facet") | (Self::Loop, "endloop") => Self::Facet,
            (Self::Facet, "outer") | (Self::Loop, "vertex") => Self::Loop,
            (Self::Solid, "endsolid") => Self::Nothing,
            _ => return None,
        })
    }
}

/// The keywords of text STL.
const KEYWORDS: [&str; 7] =
    ["solid", "facet", "outer", "vertex", "endloop", "endfacet", "endsolid"];

/// Parses a text file, without merging vertices.
fn parse_text(text: &str) -> Result<Mesh, Fault> {
    let mut mesh = Mesh::default();
    let mut inside = OpenElement::Nothing;
    let mut corners: Vec<DVec3> = Vec::new();
    let mut printed: Vec<[Printed; 3]> = Vec::new();
    let mut name = String::new();
    for (number, line) in lines(text).enumerate() {
        let at = |what: String| Fault::new(Place::Line(number + 1), what);
        if is_comment(line.trim_start().as_bytes()) {
            continue;
        }
        let mut words = line.split_whitespace();
        let Some(word) = words.next() else { continue };
        let keyword = word.to_ascii_lowercase();
        if !KEYWORDS.contains(&keyword.as_str()) {
            return Err(at(format!("unknown keyword {}", quoted(word))));
        }
        let Some(next) = inside.after(&keyword) else {
            let what = match inside {
                OpenElement::Nothing => format!("`{keyword}` outside a solid"),
                _ => format!("`{keyword}` inside a {} that is not closed", inside.element_name()),
            };
            return Err(at(what));
        };
        match keyword.as_str() {
            "outer" => {
                corners.clear();
                printed.clear();
            }
            "vertex" => {
                let (corner, form) = parse_vertex(words).map_err(at)?;
                corners.push(corner);
                printed.push(form);
            }
            "endloop" if corners.len() < 3 => {
                return Err(at(format!(
                    "a loop has {} vertices; at least 3 are required",
                    corners.len()
                )));
            }
            "endloop" => {
                push_face(&mut mesh, &corners)?;
                mesh.printed.extend_from_slice(&printed);
            }
            "solid" => line.trim_start()[keyword.len()..].trim().clone_into(&mut name),
            "endsolid" => mesh.groups.end_group(&name, mesh.faces.len()),
            _ => {}
        }
        inside = next;
    }
    if inside != OpenElement::Nothing {
        let what =
            format!("the last {} is not closed; the file is truncated", inside.element_name());
        return Err(Fault::new(Place::End, what));
    }
    mesh.groups = std::mem::take(&mut mesh.groups).unless_single();
    Ok(mesh)
}

/// Parses the coordinates of a vertex, with their printed forms.
fn parse_vertex<'a>(words: impl Iterator<Item = &'a str>) -> Result<(DVec3, [Printed; 3]), String> {
    let mut xyz = [0.0; 3];
    let mut printed = [Printed::default(); 3];
    let mut found = 0;
    for word in words.take_while(|word| !is_comment(word.as_bytes())) {
        let value = number(word).ok_or_else(|| format!("{} is not a number", quoted(word)))?;
        if found < 3 {
            (xyz[found], printed[found]) = value;
        }
        found += 1;
    }
    if found != 3 {
        return Err(format!("{found} coordinates, expected 3"));
    }
    Ok((DVec3::from_array(xyz), printed))
}
