//! Reads OFF (Geomview's object file format), text.
//!
//! The first word is `OFF`, with a prefix for the data that follow the coordinates of each vertex (`ST`
//! texture, `C` colour, `N` normal). Then come the numbers of vertices, faces and edges, one line for each
//! vertex, and one for each face (`n i_1 ... i_n [colour]`). `#` begins a comment, and blank lines are ignored.
//! The counts may follow `OFF` without a space. Text after the last face is rejected, because it shows that the
//! counts are wrong.

use glam::DVec3;

use crate::digits::Printed;
use crate::error::{Fault, Place};
use crate::mesh::Mesh;
use crate::text::{lines, number, quoted, without_mark};

/// Parses an OFF file.
pub(crate) fn parse_off(bytes: &[u8]) -> Result<Mesh, Fault> {
    let text = String::from_utf8_lossy(without_mark(bytes)?);
    let mut lines = lines(&text).enumerate().filter_map(|(number, line)| {
        let content = line.split('#').next().unwrap_or_default().trim();
        (!content.is_empty()).then_some(NumberedLine { number: number + 1, content })
    });
    let mut next = |what: &str| {
        lines.next().ok_or_else(|| Fault::new(Place::End, format!("{what} is missing")))
    };

    let header = next("the word `OFF`")?;
    let rest = text_after_magic(&header)?;
    let counts = if rest.content.is_empty() {
        next("the line with the numbers of vertices and faces")?
    } else {
        rest
    };
    let (vertex_count, face_count) = parse_counts(&counts)?;
    // A vertex needs three digits, two spaces and a line end, a face one digit and a line end. The last line
    // may have no end.
    if vertex_count * 6 + face_count * 2 > bytes.len() + 1 {
        return Err(counts.error_at_line(format!(
            "{vertex_count} vertices and {face_count} faces cannot fit in {} bytes",
            bytes.len()
        )));
    }

    let mut mesh = Mesh::default();
    for index in 0..vertex_count {
        let line = next(&format!("vertex {index} of {vertex_count}"))?;
        let (vertex, printed) = parse_vertex(&line)?;
        mesh.vertices.push(vertex);
        mesh.printed.push(printed);
    }
    for index in 0..face_count {
        let line = next(&format!("face {index} of {face_count}"))?;
        mesh.faces.push(parse_face(&line, vertex_count)?);
    }
    match next("") {
        Ok(line) => Err(line.error_at_line(format!(
            "unexpected text after the {vertex_count} vertices and {face_count} faces of the header"
        ))),
        Err(_) => Ok(mesh),
    }
}

/// A line that is neither blank nor a comment, with its number from 1.
struct NumberedLine<'a> {
    number: usize,
    content: &'a str,
}

impl NumberedLine<'_> {
    /// Builds an error at this line.
    fn error_at_line(&self, what: impl Into<String>) -> Fault {
        Fault::new(Place::Line(self.number), what)
    }
}

/// Returns the text after the word `OFF` on its line.
fn text_after_magic<'a>(line: &NumberedLine<'a>) -> Result<NumberedLine<'a>, Fault> {
    let Some((prefix, rest)) = line.content.split_once("OFF") else {
        return Err(line.error_at_line(format!("expected `OFF`, found {}", quoted(line.content))));
    };
    if !matches!(prefix, "" | "ST" | "C" | "N" | "CN" | "STC" | "STN" | "STCN") {
        return Err(line.error_at_line(format!(
            "the variant {} is not supported; accepted: OFF with the prefix ST, C or N, three-dimensional",
            quoted(&format!("{prefix}OFF"))
        )));
    }
    let rest = rest.trim();
    if rest.to_ascii_uppercase().starts_with("BINARY") {
        return Err(line.error_at_line("binary OFF files are not supported; save the file as text"));
    }
    Ok(NumberedLine { number: line.number, content: rest })
}

/// Parses the numbers of vertices and faces.
fn parse_counts(line: &NumberedLine<'_>) -> Result<(usize, usize), Fault> {
    let mut words = line.content.split_whitespace();
    let mut count = |what: &str| {
        let word = words
            .next()
            .ok_or_else(|| line.error_at_line(format!("the number of {what} is missing")))?;
        word.parse::<u32>()
            .map(|count| count as usize)
            .map_err(|_| line.error_at_line(format!("{} is not a number of {what}", quoted(word))))
    };
    Ok((count("vertices")?, count("faces")?))
}

/// Parses the coordinates of a vertex.
fn parse_vertex(line: &NumberedLine<'_>) -> Result<(DVec3, [Printed; 3]), Fault> {
    let mut xyz = [0.0; 3];
    let mut printed = [Printed::default(); 3];
    let mut words = line.content.split_whitespace();
    for (c, form) in xyz.iter_mut().zip(&mut printed) {
        let word = words
            .next()
            .ok_or_else(|| line.error_at_line("a vertex needs 3 coordinates; fewer found"))?;
        let refused = || line.error_at_line(format!("{} is not a number", quoted(word)));
        (*c, *form) = number(word).ok_or_else(refused)?;
    }
    Ok((DVec3::from_array(xyz), printed))
}

/// Parses the vertex indices of a face.
fn parse_face(line: &NumberedLine<'_>, vertex_count: usize) -> Result<Vec<u32>, Fault> {
    let mut words = line.content.split_whitespace();
    let word = words.next().unwrap_or_default();
    let corners: usize = word
        .parse()
        .map_err(|_| line.error_at_line(format!("{} is not a number of corners", quoted(word))))?;
    let face = words
        .take(corners)
        .map(|word| match word.parse::<u32>() {
            Ok(index) if (index as usize) < vertex_count => Ok(index),
            Ok(index) => Err(line.error_at_line(format!(
                "vertex index {index} is out of range; accepted: 0 to {}",
                vertex_count.saturating_sub(1)
            ))),
            Err(_) => Err(line.error_at_line(format!("{} is not a vertex index", quoted(word)))),
        })
        .collect::<Result<Vec<u32>, Fault>>()?;
    if face.len() < corners {
        return Err(line
            .error_at_line(format!("{} of {corners} corners are missing", corners - face.len())));
    }
    Ok(face)
}
