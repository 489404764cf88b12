//! Identifies the contents of a file from its bytes, regardless of its name.
//!
//! A result is returned only if it is beyond doubt. It follows from the exact size of a binary STL file, or from a
//! signature or a first word that no other format has.

use crate::Format;
use crate::stl;
use crate::text::{lines, without_mark};

/// The contents of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Content {
    /// A supported mesh format.
    Mesh(Format),
    /// Another known format, named with its article.
    Other(&'static str),
}

impl Content {
    /// Returns the name for messages, with its article.
    pub(crate) fn description(self, bytes: &[u8]) -> &'static str {
        match self {
            Self::Mesh(Format::Stl) if stl::is_text(bytes) => "a text STL file",
            Self::Mesh(Format::Stl) => "a binary STL file",
            Self::Mesh(format) => format.file(),
            Self::Other(name) => name,
        }
    }
}

/// Signatures of files that are mistaken for meshes.
const SIGNATURES: [(&[u8], &str); 18] = [
    (b"PK\x03\x04", "a ZIP archive (for example a 3MF file or packed meshes)"),
    (b"\x1f\x8b", "a gzip archive"),
    (b"7z\xbc\xaf\x27\x1c", "a 7z archive"),
    (b"glTF", "a binary glTF file"),
    (b"Kaydara FBX Binary", "an FBX file"),
    (b"ISO-10303-21", "a STEP file"),
    (b"# vtk DataFile", "a VTK file"),
    (b"$MeshFormat", "a Gmsh file"),
    (b"MeshVersionFormatted", "a Medit file"),
    (b"BLENDER", "a Blender file"),
    (b"\x89PNG", "a PNG picture"),
    (b"\x89HDF", "an HDF5 file"),
    (b"%PDF", "a PDF file"),
    (b"version https://git-lfs", "a Git LFS pointer; fetch the file itself (git lfs pull)"),
    (b"<!DOCTYPE html", "an HTML page"),
    (b"<html", "an HTML page"),
    (b"<?xml", "an XML file"),
    (b"{", "a JSON file"),
];

/// First words that occur only in OBJ files.
const OBJ_WORDS: [&str; 11] = ["v", "vt", "vn", "vp", "f", "o", "g", "s", "mtllib", "usemtl", "mg"];

/// Number of bytes at the start that are searched.
const SEARCHED_BYTES: usize = 1 << 16;

/// Identifies the contents; `None` if there is doubt.
pub(crate) fn identify(bytes: &[u8]) -> Option<Content> {
    if stl::is_exactly_binary(bytes) {
        return Some(Content::Mesh(Format::Stl));
    }
    let start = without_mark(bytes).ok()?.trim_ascii_start();
    let is = |signature: &[u8]| {
        start.get(..signature.len()).is_some_and(|s| s.eq_ignore_ascii_case(signature))
    };
    #[cfg(feature = "dae")]
    if is(b"<?xml") || is(b"<COLLADA") {
        let start = &start[..start.len().min(SEARCHED_BYTES)];
        if start.windows(8).any(|word| word == b"<COLLADA") {
            return Some(Content::Mesh(Format::Dae));
        }
    }
    if let Some((_, name)) = SIGNATURES.iter().find(|(signature, _)| is(signature)) {
        return Some(Content::Other(name));
    }
    // `solid` does not occur as a word of the other formats, nor do the others.
    let first = first_content_line(start)?;
    let mut words = first.split_whitespace();
    let (word, next) = (words.next()?, words.next());
    let format = match word {
        "ply" if next.is_none() => Format::Ply,
        _ if is_off(word) => Format::Off,
        _ if word.eq_ignore_ascii_case("solid") => Format::Stl,
        _ if OBJ_WORDS.contains(&word) && !stl::has_control(bytes) => Format::Obj,
        _ => return None,
    };
    Some(Content::Mesh(format))
}

/// Checks for `OFF` with a prefix, optionally followed directly by digits of a count.
fn is_off(word: &str) -> bool {
    let Some((prefix, rest)) = word.split_once("OFF") else { return false };
    matches!(prefix, "" | "ST" | "C" | "N" | "CN" | "STC" | "STN" | "STCN" | "4" | "n")
        && rest.bytes().all(|b| b.is_ascii_digit())
}

/// Returns the first line of the searched bytes that is neither blank nor a comment.
fn first_content_line(start: &[u8]) -> Option<String> {
    let text = String::from_utf8_lossy(&start[..start.len().min(SEARCHED_BYTES)]);
    let mut contents = lines(&text).map(|line| line.split('#').next().unwrap_or_default().trim());
    contents.find(|content| !content.is_empty()).map(str::to_owned)
}
