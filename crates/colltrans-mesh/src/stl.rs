//! STL: binary (through `stl_io`) and text.
//!
//! A binary file is 80 bytes of header, a count `n` and `50 n` bytes of triangles; many begin with
//! the word `solid` as text files do, so the first word does not decide. A file of exactly
//! the size that its count implies is binary; of the others those are text that begin with `solid`, perhaps
//! after comments (`;`, `#`, `//`), and that hold no control characters, as binary numbers do, or whose second
//! line is one of text STL. Other text is refused. NUL and Ctrl-Z at the start and the end are padding. Text is read here, because it may hold
//! several solids and more digits than single precision, and because its errors should name a
//! line. Either way equal vertices are merged.

use std::io::Cursor;

use glam::DVec3;

use crate::digits::Printed;
use crate::error::{Fault, Place};
use crate::merge::Precision;
use crate::mesh::Mesh;
use crate::text::{lines, number, quoted, without_mark};

const HEADER: usize = 80;
const TRIANGLE: usize = 50;

/// The mesh, and the precision of its coordinates.
pub(crate) fn parse(bytes: Vec<u8>) -> Result<(Mesh, Precision), Fault> {
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
        // A mark of UTF-16 is the likelier reason.
        check_is_no_text(without_mark(&bytes)?)?;
        check_size(&bytes)?;
    }
    Ok((parse_binary(bytes)?.weld(), Precision::SINGLE))
}

/// Whether the size is the one that the triangle count of a binary file implies.
pub(crate) fn is_exactly_binary(bytes: &[u8]) -> bool {
    promised_size(bytes).is_some_and(|promised| promised == bytes.len() as u64)
}

/// Whether the file begins as a text STL does and is text.
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

/// Checks whether a byte is one that some programs put before the start and behind the end of text: NUL or Ctrl-Z.
const fn is_padding(byte: u8) -> bool {
    matches!(byte, 0 | 0x1a)
}

/// Returns text without padding before its start.
fn without_leading_padding(text: &[u8]) -> &[u8] {
    let first = text.iter().position(|byte| !is_padding(*byte));
    &text[first.unwrap_or(0)..]
}

/// Returns text without padding.
fn without_padding(text: &[u8]) -> &[u8] {
    let text = without_leading_padding(text);
    let is_text = |byte: &u8| !is_padding(*byte) && !byte.is_ascii_whitespace();
    &text[..text.iter().rposition(is_text).map_or(0, |last| last + 1)]
}

/// Checks that nothing follows the character that ends a text on some systems.
fn check_end(text: &[u8]) -> Result<(), Fault> {
    let Some(end) = text.iter().position(|byte| *byte == 0x1a) else { return Ok(()) };
    let (before, rest) = text.split_at(end);
    let line = lines(&String::from_utf8_lossy(before)).count();
    let what = format!("Ctrl-Z ends the text, but {} bytes follow it; delete them", rest.len() - 1);
    Err(Fault::new(Place::Line(line), what))
}

/// Checks that the bytes, which do not begin as text STL, are no text at all.
fn check_is_no_text(bytes: &[u8]) -> Result<(), Fault> {
    let bytes = bytes.strip_suffix(b"\x1a").unwrap_or(bytes);
    if has_control(bytes) {
        return Ok(());
    }
    let text = String::from_utf8_lossy(bytes);
    let is_blank = |line: &str| line.trim().is_empty() || is_comment(line.trim().as_bytes());
    let Some((number, line)) = lines(&text).enumerate().find(|(_, line)| !is_blank(line)) else {
        return Err(Fault::new(Place::End, "a text without the line `solid`, where STL begins"));
    };
    let what = format!("text STL begins with `solid`, not with {}", quoted(line.trim()));
    Err(Fault::new(Place::Line(number + 1), what))
}

/// Characters that no text holds, but numbers in binary do.
pub(crate) fn has_control(bytes: &[u8]) -> bool {
    bytes.iter().any(|b| *b < b' ' && !(0x09..=0x0d).contains(b))
}

/// The size that the triangle count of a binary file implies.
fn promised_size(bytes: &[u8]) -> Option<u64> {
    let count = bytes.get(HEADER..HEADER + 4)?;
    let count = u32::from_le_bytes([count[0], count[1], count[2], count[3]]);
    Some(u64::from(count) * TRIANGLE as u64 + HEADER as u64 + 4)
}

/// A binary file must hold what its header promises, and no more than a little padding.
fn check_size(bytes: &[u8]) -> Result<(), Fault> {
    let fault = |what: String| Err(Fault::new(Place::End, what));
    let Some(promised) = promised_size(bytes) else {
        return fault(format!(
            "neither text (no leading `solid`) nor binary ({} bytes; the header alone has {})",
            bytes.len(),
            HEADER + 4
        ));
    };
    let triangles = (promised - HEADER as u64 - 4) / TRIANGLE as u64;
    if (bytes.len() as u64) < promised {
        return fault(format!(
            "the file is cut short: its header promises {triangles} triangles in {promised} bytes, \
             it has {}",
            bytes.len()
        ));
    }
    let rest = &bytes[promised as usize..];
    if rest.len() >= TRIANGLE && rest.iter().any(|&b| b != 0) {
        return fault(format!(
            "{} bytes follow the {triangles} triangles that the header promises",
            rest.len()
        ));
    }
    Ok(())
}

fn parse_binary(mut bytes: Vec<u8>) -> Result<Mesh, Fault> {
    // A header that begins with `solid` would make the reader take the file for text.
    bytes[..HEADER].fill(0);
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

fn push_face(mesh: &mut Mesh, corners: &[DVec3]) -> Result<(), Fault> {
    let first = u32::try_from(mesh.vertices.len()).ok().filter(|f| *f < u32::MAX - 1024);
    let Some(first) = first.filter(|_| corners.len() <= 1024) else {
        return Err(Fault::new(Place::Face(mesh.faces.len()), "too many corners"));
    };
    mesh.vertices.extend_from_slice(corners);
    mesh.faces.push((first..first + corners.len() as u32).collect());
    Ok(())
}

/// What has been begun and not yet ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Inside {
    Nothing,
    Solid,
    Facet,
    Loop,
}

impl Inside {
    const fn name(self) -> &'static str {
        match self {
            Self::Nothing => "file",
            Self::Solid => "solid",
            Self::Facet => "facet",
            Self::Loop => "loop",
        }
    }

    /// What is inside what after a keyword; `None` where it has no place.
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

const KEYWORDS: [&str; 7] =
    ["solid", "facet", "outer", "vertex", "endloop", "endfacet", "endsolid"];

fn parse_text(text: &str) -> Result<Mesh, Fault> {
    let mut mesh = Mesh::default();
    let mut inside = Inside::Nothing;
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
                Inside::Nothing => format!("`{keyword}` outside a solid"),
                _ => format!("`{keyword}` inside a {} that was not ended", inside.name()),
            };
            return Err(at(what));
        };
        match keyword.as_str() {
            "outer" => {
                corners.clear();
                printed.clear();
            }
            "vertex" => {
                let (corner, form) = vertex(words).map_err(at)?;
                corners.push(corner);
                printed.push(form);
            }
            "endloop" if corners.len() < 3 => {
                return Err(at(format!("a loop of {} vertices; 3 are needed", corners.len())));
            }
            "endloop" => {
                push_face(&mut mesh, &corners)?;
                mesh.printed.extend_from_slice(&printed);
            }
            "solid" => line.trim_start()[keyword.len()..].trim().clone_into(&mut name),
            "endsolid" => mesh.groups.end(&name, mesh.faces.len()),
            _ => {}
        }
        inside = next;
    }
    if inside != Inside::Nothing {
        let what = format!("the last {} is not ended; the file is cut short", inside.name());
        return Err(Fault::new(Place::End, what));
    }
    mesh.groups = std::mem::take(&mut mesh.groups).several();
    Ok(mesh)
}

fn vertex<'a>(words: impl Iterator<Item = &'a str>) -> Result<(DVec3, [Printed; 3]), String> {
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
        return Err(format!("{found} coordinates, not 3"));
    }
    Ok((DVec3::from_array(xyz), printed))
}
