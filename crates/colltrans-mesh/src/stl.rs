//! STL: binary (through `stl_io`) and text.
//!
//! A binary file is 80 bytes of header, a count `n` and `50 n` bytes of triangles; many begin with
//! the word `solid` as text files do, so the size decides, not the first word. Text is read
//! here, because it may hold several solids and more digits than single precision, and because
//! its errors should name a line. Either way the vertices are welded.

use std::io::Cursor;

use glam::DVec3;

use crate::error::{Fault, Place};
use crate::mesh::Mesh;

const HEADER: usize = 80;
const TRIANGLE: usize = 50;

pub(crate) fn parse(bytes: Vec<u8>) -> Result<Mesh, Fault> {
    if bytes.is_empty() {
        return Err(Fault::new(Place::End, "the file is empty"));
    }
    let promised = promised_size(&bytes);
    if promised != Some(bytes.len()) && is_text(&bytes) {
        return parse_text(&String::from_utf8_lossy(&bytes)).map(|mesh| mesh.weld());
    }
    let Some(promised) = promised else {
        return Err(Fault::new(
            Place::End,
            format!(
                "neither text (no leading `solid`) nor binary ({} bytes; the header alone has {})",
                bytes.len(),
                HEADER + 4
            ),
        ));
    };
    if bytes.len() < promised {
        return Err(Fault::new(
            Place::End,
            format!("the header promises {promised} bytes, the file has {}", bytes.len()),
        ));
    }
    parse_binary(bytes).map(|mesh| mesh.weld())
}

/// The size that the triangle count of a binary file implies.
fn promised_size(bytes: &[u8]) -> Option<usize> {
    let count = bytes.get(HEADER..HEADER + 4)?;
    let count = u32::from_le_bytes([count[0], count[1], count[2], count[3]]);
    (count as usize).checked_mul(TRIANGLE)?.checked_add(HEADER + 4)
}

fn is_text(bytes: &[u8]) -> bool {
    let start = bytes.trim_ascii_start();
    start.len() >= 5 && start[..5].eq_ignore_ascii_case(b"solid")
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

fn parse_text(text: &str) -> Result<Mesh, Fault> {
    let mut mesh = Mesh::default();
    let mut corners: Option<Vec<DVec3>> = None;
    for (number, line) in text.lines().enumerate() {
        let at = |what: String| Fault::new(Place::Line(number + 1), what);
        let mut words = line.split_whitespace();
        let Some(keyword) = words.next() else { continue };
        match (keyword.to_ascii_lowercase().as_str(), &mut corners) {
            ("solid" | "facet" | "endfacet" | "endsolid", None) => {}
            ("outer", None) => corners = Some(Vec::with_capacity(3)),
            ("vertex", Some(corners)) => corners.push(vertex(words).map_err(at)?),
            ("endloop", Some(found)) => {
                if found.len() < 3 {
                    return Err(at(format!("a loop of {} vertices; 3 are needed", found.len())));
                }
                push_face(&mut mesh, found)?;
                corners = None;
            }
            ("solid" | "facet" | "endfacet" | "endsolid" | "outer", Some(_)) => {
                return Err(at(format!("`{keyword}` inside a loop that was not ended")));
            }
            ("vertex" | "endloop", None) => return Err(at(format!("`{keyword}` outside a loop"))),
            _ => return Err(at(format!("unknown keyword {}", quoted(keyword)))),
        }
    }
    if corners.is_some() {
        return Err(Fault::new(Place::End, "the last loop is not ended"));
    }
    Ok(mesh)
}

fn vertex<'a>(words: impl Iterator<Item = &'a str>) -> Result<DVec3, String> {
    let mut coordinates = Vec::with_capacity(3);
    for word in words {
        coordinates.push(word.parse().map_err(|_| format!("{} is no number", quoted(word)))?);
    }
    let found = coordinates.len();
    let xyz: [f64; 3] =
        coordinates.try_into().map_err(|_| format!("{found} coordinates, not 3"))?;
    Ok(DVec3::from_array(xyz))
}

/// A word of the file, cut to a length that fits a message.
pub(crate) fn quoted(word: &str) -> String {
    let mut shown: String = word.chars().take(40).flat_map(char::escape_debug).collect();
    if word.chars().nth(40).is_some() {
        shown.push_str("...");
    }
    format!("`{shown}`")
}
