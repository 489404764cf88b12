//! Reads OBJ, text, with `tobj`.
//!
//! `tobj` renumbers the vertices of each group in the order of their first use, and its errors have no line.
//! [`CleanLines`] avoids both: it passes on only positions and faces, and after each position a face of that single
//! vertex. Thus the order of first use is the order in the file. Objects and groups are recorded at the same
//! time.
//!
//! Keywords without relevance for polygons are skipped. Keywords of curved surfaces and unknown keywords are
//! rejected, because an unrecognised vertex would change the numbering.

use std::collections::HashMap;
use std::io::{self, BufRead, Read};

use glam::DVec3;
use tobj::{LoadError, LoadOptions};

use crate::digits::Printed;
use crate::error::{Fault, Place};
use crate::mesh::{Groups, Mesh};
use crate::text::{self, quoted, without_mark};

/// Parses an OBJ file.
pub(crate) fn parse_obj(bytes: &[u8]) -> Result<Mesh, Fault> {
    let text = String::from_utf8_lossy(without_mark(bytes)?);
    let mut lines = CleanLines::new(&text);
    let loaded =
        tobj::load_obj_buf(&mut lines, &LoadOptions::default(), |_| Err(LoadError::OpenFileFailed));
    if let Some(fault) = lines.refused {
        return Err(fault);
    }
    let models = match loaded {
        Ok((models, _)) => models,
        Err(LoadError::FaceVertexOutOfBounds) => return Err(find_unknown_vertex(&text)),
        Err(error) => return Err(lines.error_at_line(error)),
    };
    let mut mesh = Mesh::default();
    // Because no groups are passed on, there is one model.
    for model in models {
        let tobj::Mesh { positions, indices, face_arities, .. } = model.mesh;
        mesh.vertices.extend(positions.chunks_exact(3).map(DVec3::from_slice));
        let mut rest = indices.as_slice();
        for arity in face_arities {
            let (corners, others) = rest.split_at(arity as usize);
            rest = others;
            if corners.len() > 1 {
                mesh.faces.push(corners.to_vec());
            }
        }
    }
    mesh.printed = lines.printed;
    mesh.groups = lines.names.into_groups(mesh.faces.len());
    Ok(mesh)
}

/// The objects and the groups of a file, each with the number of faces before it and its name.
#[derive(Default)]
struct NamedRanges {
    objects: Vec<(usize, String)>,
    groups: Vec<(usize, String)>,
}

impl NamedRanges {
    /// Returns the objects if there are several, otherwise the groups. Objects or groups with the same name are
    /// joined.
    fn into_groups(self, faces: usize) -> Groups {
        let all = [self.objects, self.groups].map(|begun| {
            let mut groups = Groups::default();
            let mut known: HashMap<String, u32> = HashMap::new();
            let mut name = String::new();
            for (before, next) in begun.into_iter().chain([(faces, String::new())]) {
                let before = before.min(faces);
                match known.get(&name) {
                    Some(&group) => groups.of_face.resize(before, group),
                    None if groups.of_face.len() < before => {
                        known.insert(name.clone(), groups.names.len() as u32);
                        groups.end_group(&name, before);
                    }
                    None => {}
                }
                name = next;
            }
            groups.unless_single()
        });
        let [objects, groups] = all;
        if objects.names.is_empty() { groups } else { objects }
    }
}

/// A reader for `tobj` that passes on the position and face lines of an OBJ file, cleaned, one at a time.
struct CleanLines<'a> {
    text: std::iter::Enumerate<text::Lines<'a>>,
    /// The number of the line that was read last.
    number: usize,
    /// The text to pass on, of which `read` bytes have been consumed.
    pending: Vec<u8>,
    read: usize,
    original: String,
    /// The error of a keyword that cannot be skipped. Reading ends there.
    refused: Option<Fault>,
    names: NamedRanges,
    /// The printed form of each position that was passed on.
    printed: Vec<[Printed; 3]>,
    /// Number of faces that were passed on.
    faces: usize,
}

/// Keywords without relevance for the polygons of a mesh.
const SKIPPED: [&str; 24] = [
    "vt",
    "vn",
    "vp",
    "p",
    "l",
    "s",
    "mg",
    "mtllib",
    "usemtl",
    "maplib",
    "usemap",
    "bevel",
    "c_interp",
    "d_interp",
    "lod",
    "shadow_obj",
    "trace_obj",
    "cstype",
    "deg",
    "bmat",
    "step",
    "parm",
    "end",
    "call",
];

/// Keywords of curved surfaces.
const CURVED: [&str; 8] = ["surf", "curv", "curv2", "trim", "hole", "scrv", "sp", "con"];

impl<'a> CleanLines<'a> {
    fn new(text: &'a str) -> Self {
        Self {
            text: text::lines(text).enumerate(),
            number: 0,
            pending: Vec::new(),
            read: 0,
            original: String::new(),
            refused: None,
            names: NamedRanges::default(),
            printed: Vec::new(),
            faces: 0,
        }
    }

    /// Reads up to the next position or face. Returns `false` at the end.
    fn advance(&mut self) -> bool {
        self.pending.clear();
        self.read = 0;
        while let Some(line) = self.next_logical_line() {
            let mut words = line.split_whitespace();
            match words.next() {
                Some("v") => self.pass_position(&words.collect::<Vec<_>>()),
                Some("f") => {
                    self.pending.push(b'f');
                    self.faces += usize::from(words.clone().nth(1).is_some());
                    for corner in words {
                        // `tobj` would only check texture and normal indices and drop them.
                        let vertex = corner.split('/').next().unwrap_or_default();
                        self.pending.push(b' ');
                        self.pending.extend_from_slice(vertex.as_bytes());
                    }
                    self.pending.push(b'\n');
                }
                None => continue,
                Some(keyword @ ("o" | "g")) => {
                    let name = line.trim_start()[1..].trim().to_owned();
                    let names = &mut self.names;
                    let list = if keyword == "o" { &mut names.objects } else { &mut names.groups };
                    list.push((self.faces, name));
                    continue;
                }
                Some(keyword) if SKIPPED.contains(&keyword) => continue,
                Some(keyword) => {
                    let what = if CURVED.contains(&keyword) {
                        format!(
                            "curved surfaces ({}) are not supported; export polygons",
                            quoted(keyword)
                        )
                    } else {
                        format!("unknown keyword {}", quoted(keyword))
                    };
                    self.refused = Some(Fault::new(Place::Line(self.number), what));
                    return false;
                }
            }
            self.original = line;
            return true;
        }
        false
    }

    /// Passes on a position with its weight, without its colour.
    fn pass_position(&mut self, words: &[&str]) {
        let kept = if words.len() == 4 { 4 } else { words.len().min(3) };
        let form = |k: usize| words.get(k).map(|word| Printed::from_text(word)).unwrap_or_default();
        self.printed.push([form(0), form(1), form(2)]);
        self.pending.push(b'v');
        for word in &words[..kept] {
            self.pending.push(b' ');
            self.pending.extend_from_slice(word.as_bytes());
        }
        self.pending.extend_from_slice(b"\nf -1\n");
    }

    /// Returns the next line without its comment, joined with the lines that continue it after a final
    /// backslash.
    fn next_logical_line(&mut self) -> Option<String> {
        let mut line = String::new();
        loop {
            let Some((index, text)) = self.text.next() else {
                return (!line.is_empty()).then_some(line);
            };
            self.number = index + 1;
            let content = text.split('#').next().unwrap_or_default().trim_end();
            let Some(start) = content.strip_suffix('\\') else {
                line.push_str(content);
                return Some(line);
            };
            line.push_str(start);
            line.push(' ');
        }
    }

    /// Converts an error of `tobj`, with line and text.
    fn error_at_line(&self, error: LoadError) -> Fault {
        let what = match error {
            LoadError::PositionParseError => "a vertex needs 3 numbers, and may have a weight",
            LoadError::FaceParseError => "a face needs valid vertex indices",
            LoadError::ScalingByZeroError => "a vertex has the weight 0",
            _ => "invalid line",
        };
        Fault::new(Place::Line(self.number), format!("{what}: {}", quoted(self.original.trim())))
    }
}

impl BufRead for CleanLines<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        if self.read == self.pending.len() {
            self.advance();
        }
        Ok(&self.pending[self.read..])
    }

    fn consume(&mut self, amount: usize) {
        self.read += amount;
    }
}

impl Read for CleanLines<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let available = self.fill_buf()?;
        let count = available.len().min(buffer.len());
        buffer[..count].copy_from_slice(&available[..count]);
        self.consume(count);
        Ok(count)
    }
}

/// Finds the first face with a vertex index that is out of range.
fn find_unknown_vertex(text: &str) -> Fault {
    let mut lines = CleanLines::new(text);
    let mut total = 0;
    while let Some(line) = lines.next_logical_line() {
        total += i64::from(line.split_whitespace().next() == Some("v"));
    }
    let mut lines = CleanLines::new(text);
    let mut vertices_before = 0;
    while let Some(line) = lines.next_logical_line() {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => vertices_before += 1,
            Some("f") => {
                for corner in words {
                    let index = corner.split('/').next().unwrap_or_default();
                    let known = index.parse().is_ok_and(|i: i64| {
                        (1..=total).contains(&i) || (-vertices_before..0).contains(&i)
                    });
                    if !known {
                        let what = format!(
                            "vertex index {} is out of range; there are {total} vertices",
                            quoted(index)
                        );
                        return Fault::new(Place::Line(lines.number), what);
                    }
                }
            }
            _ => {}
        }
    }
    Fault::new(Place::End, "a face has a vertex index that is out of range")
}
