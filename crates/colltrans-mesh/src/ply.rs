//! Reads PLY, text and binary, with `ply-rs-bw`.
//!
//! The reader uses `x`, `y`, `z` of the element `vertex`, and the list `vertex_indices` (or `vertex_index`) of
//! the element `face`. Other elements are skipped, except triangle strips, which are rejected because their
//! faces would be lost. Before reading, the counts of the header are compared with the available bytes.
//! Remaining bytes other than whitespace and zeros are rejected.

mod explain;

use std::borrow::Cow;
use std::io::ErrorKind;

use glam::DVec3;
use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{
    Encoding, Header, Property, PropertyAccess, PropertyAccessResult, PropertyType, ScalarType,
};

use crate::digits::Printed;
use crate::error::{Fault, Place};
use crate::merge::Precision;
use crate::mesh::Mesh;
use crate::text::{lines, number, quoted, without_mark};

/// Parses a PLY file. Returns the mesh and the precision of its coordinates.
pub(crate) fn parse_ply(bytes: &[u8]) -> Result<(Mesh, Precision), Fault> {
    let bytes = with_line_feeds(without_mark(bytes)?);
    let bytes = with_readable_comments(bytes);
    let mut reader = Reader::new(&*bytes);
    let header = Parser::<Row>::new().read_header(&mut reader);
    let header = header
        .map_err(|e| explain::header_error(&bytes).unwrap_or_else(|| parser_error(&e, true)))?;
    let text = header.encoding == Encoding::Ascii;
    check_counts(&header, reader.get_ref().len())?;
    let precision = check_properties(&header, text)?;
    let rows = *reader.get_ref();
    let mut mesh = Mesh::default();
    let mut faces = Vec::new();
    for (name, element) in &header.elements {
        let rows = Parser::<Row>::new().read_payload_for_element(&mut reader, element, &header);
        let rows = rows.map_err(|e| {
            let line = e.line().filter(|_| text);
            let told = line.and_then(|line| {
                let row = bytes.split(|b| *b == b'\n').nth(line - 1)?;
                let what = explain::row_error(std::str::from_utf8(row).ok()?, element)?;
                Some(Fault::new(Place::Line(line), what))
            });
            told.unwrap_or_else(|| parser_error(&e, text))
        })?;
        match name.as_str() {
            "vertex" => mesh.vertices = rows.into_iter().map(|row| row.point).collect(),
            "face" => faces = rows,
            _ => {}
        }
    }
    for (index, face) in faces.into_iter().enumerate() {
        mesh.faces.push(face.checked_corners(index, mesh.vertices.len())?);
    }
    if text {
        mesh.printed = printed_coordinates(rows, &header, &mesh.vertices).unwrap_or_default();
    }
    let rest = reader.get_ref();
    if rest.iter().all(|b| *b == 0 || b.is_ascii_whitespace()) {
        Ok((mesh, precision))
    } else {
        let what = format!("{} unexpected bytes after the elements of the header", rest.len());
        Err(Fault::new(Place::End, what))
    }
}

/// Returns the printed forms of the coordinates of each vertex of a text. `None` if the words of the rows are
/// not the coordinates that the parser found, for example because a list precedes them.
fn printed_coordinates(
    rows: &[u8],
    header: &Header,
    vertices: &[DVec3],
) -> Option<Vec<[Printed; 3]>> {
    let rows = std::str::from_utf8(rows).ok()?;
    let before = header.elements.iter().take_while(|(name, _)| name.as_str() != "vertex");
    let skipped = before.map(|(_, element)| element.count).sum();
    let (_, vertex) = header.elements.iter().find(|(name, _)| name.as_str() == "vertex")?;
    let column = |name: &str| vertex.properties.iter().position(|(key, _)| key.as_str() == name);
    let columns = [column("x")?, column("y")?, column("z")?];
    let mut lines = lines(rows).skip(skipped);
    let form = |vertex: &DVec3| {
        let words: Vec<&str> = lines.next()?.split_whitespace().collect();
        let mut forms = [Printed::default(); 3];
        for ((form, column), coordinate) in forms.iter_mut().zip(columns).zip(vertex.to_array()) {
            let (value, printed) = number(words.get(column)?)?;
            let is_same = value == coordinate || value as f32 == coordinate as f32;
            *form = is_same.then_some(printed)?;
        }
        Some(forms)
    };
    vertices.iter().map(form).collect()
}

/// Replaces line ends of a lone CR by LF in the header, and in the data if they are text.
///
/// The first line end shows how the last line of the header ends. In a binary file the byte after a lone CR may
/// be a number that equals LF.
fn with_line_feeds(bytes: &[u8]) -> Cow<'_, [u8]> {
    const END: &[u8] = b"\rend_header\r";
    if !bytes.starts_with(b"ply\r") || bytes.starts_with(b"ply\r\n") {
        return Cow::Borrowed(bytes);
    }
    let mut bytes = bytes.to_vec();
    let header = bytes.windows(END.len()).position(|w| w == END);
    let header_end = header.map_or(bytes.len(), |start| start + END.len());
    let is_text = bytes[..header_end].windows(13).any(|w| w == b"\rformat ascii");
    let text_end = if is_text { bytes.len() } else { header_end };
    for byte in bytes[..text_end].iter_mut().filter(|b| **b == b'\r') {
        *byte = b'\n';
    }
    Cow::Owned(bytes)
}

/// Replaces non-ASCII bytes in the comments of a header that is not UTF-8, because the parser would reject it.
/// Many programs write the names of files and people in the code page of the system.
fn with_readable_comments(bytes: Cow<'_, [u8]>) -> Cow<'_, [u8]> {
    const END: &[u8] = b"end_header";
    let end = bytes.windows(END.len()).position(|window| window == END);
    let end = end.unwrap_or(bytes.len());
    if std::str::from_utf8(&bytes[..end]).is_ok() {
        return bytes;
    }
    let mut bytes = bytes.into_owned();
    for line in bytes[..end].split_mut(|byte| *byte == b'\n') {
        if line.starts_with(b"comment") || line.starts_with(b"obj_info") {
            for byte in line.iter_mut().filter(|byte| !byte.is_ascii()) {
                *byte = b'?';
            }
        }
    }
    Cow::Owned(bytes)
}

/// Converts an error of the parser to one line. For binary files, line numbers are omitted.
fn parser_error(error: &ParseError, text: bool) -> Fault {
    let place = match error.line() {
        Some(line) if text => Place::Line(line),
        _ if error.kind() == ErrorKind::UnexpectedEof => Place::End,
        _ => Place::Data,
    };
    let message = error.to_string();
    let message = match message.split_once(": ") {
        Some((_, rest)) if error.line().is_some() => rest,
        _ => &message,
    };
    let first = message.lines().next().unwrap_or_default().trim();
    let reason = message.lines().last().unwrap_or_default().trim();
    // The parser generator's internal state is omitted.
    if first == reason || reason.starts_with("Error: ParseError") {
        Fault::new(place, first)
    } else {
        Fault::new(place, format!("{first} {reason}"))
    }
}

/// Rejects a header that declares more elements than the remaining bytes can contain.
fn check_counts(header: &Header, bytes_left: usize) -> Result<(), Fault> {
    let mut needed = 0_usize;
    for (name, element) in &header.elements {
        let smallest = match header.encoding {
            // A line of text has its end and at least one digit for each property.
            Encoding::Ascii => 1 + element.properties.len(),
            _ => element.properties.iter().map(|(_, p)| smallest_size(&p.data_type)).sum(),
        };
        if smallest == 0 && element.count > 0 {
            let what =
                format!("the element {} has no properties, but a count above 0", quoted(name));
            return Err(Fault::new(Place::Header, what));
        }
        // The last line may have no end.
        needed = needed.saturating_add(smallest.saturating_mul(element.count));
        if needed > bytes_left.saturating_add(1) {
            return Err(Fault::new(
                Place::Header,
                format!(
                    "{} elements {} cannot fit in the {bytes_left} bytes that follow",
                    element.count,
                    quoted(name)
                ),
            ));
        }
    }
    Ok(())
}

/// Returns the smallest size of a property in bytes.
fn smallest_size(property: &PropertyType) -> usize {
    let (PropertyType::Scalar(scalar) | PropertyType::List(scalar, _)) = property;
    match scalar {
        ScalarType::Char | ScalarType::UChar => 1,
        ScalarType::Short | ScalarType::UShort => 2,
        ScalarType::Int | ScalarType::UInt | ScalarType::Float => 4,
        ScalarType::Double => 8,
    }
}

/// Checks that the required properties exist. Returns the precision of the coordinates.
fn check_properties(header: &Header, text: bool) -> Result<Precision, Fault> {
    let fault = |what: String| Fault::new(Place::Header, what);
    let element = |name: &str| header.elements.iter().find(|(n, _)| n.as_str() == name);
    let (_, vertex) =
        element("vertex").ok_or_else(|| fault("the element `vertex` is missing".into()))?;
    let mut single = false;
    for coordinate in ["x", "y", "z"] {
        let property = vertex.properties.get(coordinate);
        let property = property
            .ok_or_else(|| fault(format!("the element `vertex` has no property `{coordinate}`")))?;
        match property.data_type {
            PropertyType::Scalar(ScalarType::Float) => single = true,
            PropertyType::Scalar(_) => {}
            PropertyType::List(..) => {
                return Err(fault(format!(
                    "the property `{coordinate}` of `vertex` is a list; expected a number"
                )));
            }
        }
    }
    if let Some((_, face)) = element("face") {
        let mut lists =
            CORNER_PROPERTIES.iter().filter_map(|name| face.properties.get(*name)).peekable();
        if face.count > 0 && lists.peek().is_none() {
            return Err(fault("the element `face` has no list `vertex_indices`".into()));
        }
        if !lists.all(|list| is_list_of_integers(&list.data_type)) {
            return Err(fault(
                "the vertex indices of `face` must be a list of integers, with an integer length"
                    .into(),
            ));
        }
    }
    if element("tristrips").is_some() {
        return Err(fault("triangle strips are not supported; export the mesh as faces".into()));
    }
    Ok(Precision { single, text })
}

/// Checks whether a property is a list of integers with an integer length.
fn is_list_of_integers(property: &PropertyType) -> bool {
    let PropertyType::List(count, scalar) = property else { return false };
    [count, scalar].into_iter().all(|kind| !matches!(kind, ScalarType::Float | ScalarType::Double))
}

/// The names of the property with the vertex indices of a face.
const CORNER_PROPERTIES: [&str; 2] = ["vertex_indices", "vertex_index"];

/// A row of any element. One type for all elements, because the large parser is compiled once for each type.
struct Row {
    point: DVec3,
    /// The vertex indices of a face; `None` if one is negative.
    corners: Option<Vec<u32>>,
}

impl Row {
    /// Returns the vertex indices of face `index`, or an error if one is out of range.
    fn checked_corners(self, index: usize, vertex_count: usize) -> Result<Vec<u32>, Fault> {
        let Some(corners) = self.corners else {
            let accepted = vertex_count.saturating_sub(1);
            let what = format!("a vertex index is negative; accepted: 0 to {accepted}");
            return Err(Fault::new(Place::Face(index), what));
        };
        match corners.iter().find(|&&v| v as usize >= vertex_count) {
            Some(vertex) => Err(Fault::new(
                Place::Face(index),
                format!("vertex index {vertex} is out of range; there are {vertex_count} vertices"),
            )),
            None => Ok(corners),
        }
    }
}

impl PropertyAccess for Row {
    fn new() -> Self {
        Self { point: DVec3::ZERO, corners: Some(Vec::new()) }
    }

    fn set_property(&mut self, name: &str, value: Property) -> PropertyAccessResult {
        let coordinate = match name {
            "x" => &mut self.point.x,
            "y" => &mut self.point.y,
            "z" => &mut self.point.z,
            _ if CORNER_PROPERTIES.contains(&name) => {
                self.corners = value.to_u32_list();
                return PropertyAccessResult::Set;
            }
            _ => return PropertyAccessResult::Ignored,
        };
        *coordinate = match value {
            Property::Char(v) => f64::from(v),
            Property::UChar(v) => f64::from(v),
            Property::Short(v) => f64::from(v),
            Property::UShort(v) => f64::from(v),
            Property::Int(v) => f64::from(v),
            Property::UInt(v) => f64::from(v),
            Property::Float(v) => f64::from(v),
            Property::Double(v) => v,
            // A list of another element. The coordinates of `vertex` are numbers.
            _ => return PropertyAccessResult::Ignored,
        };
        PropertyAccessResult::Set
    }
}
