//! Tells what a file holds by its first bytes, whatever its name says.
//!
//! Only what is certain is told: signatures, and first words that no other format begins with.
//! A reader that were given the wrong format might find nothing wrong: an OBJ file, for one, is a
//! list of keywords of which most do not matter.

use crate::Format;
use crate::stl;
use crate::text::{lines, without_mark};

/// What is in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Content {
    /// A format that can be read.
    Mesh(Format),
    /// Something else that is known by name.
    Other(&'static str),
}

impl Content {
    /// In words, for messages.
    pub(crate) fn name(self, bytes: &[u8]) -> &'static str {
        match self {
            Self::Mesh(Format::Stl) if stl::is_text(bytes) => "a text STL file",
            Self::Mesh(Format::Stl) => "a binary STL file",
            Self::Mesh(format) => format.file(),
            Self::Other(name) => name,
        }
    }
}

/// Signatures of files that people take for meshes, or that take the place of one.
const SIGNATURES: [(&[u8], &str); 18] = [
    (b"PK\x03\x04", "a ZIP archive (3MF files and packed meshes are such)"),
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

/// First words that only OBJ files begin with.
const OBJ_WORDS: [&str; 11] = ["v", "vt", "vn", "vp", "f", "o", "g", "s", "mtllib", "usemtl", "mg"];

/// So many bytes from the start are looked at, where that is not in the first ones.
const LOOKED_AT: usize = 1 << 16;

/// What the bytes are, where that is certain.
pub(crate) fn sniff(bytes: &[u8]) -> Option<Content> {
    if stl::is_exactly_binary(bytes) {
        return Some(Content::Mesh(Format::Stl));
    }
    let start = without_mark(bytes).ok()?.trim_ascii_start();
    let is = |signature: &[u8]| {
        start.get(..signature.len()).is_some_and(|s| s.eq_ignore_ascii_case(signature))
    };
    #[cfg(feature = "dae")]
    if is(b"<?xml") || is(b"<COLLADA") {
        let start = &start[..start.len().min(LOOKED_AT)];
        if start.windows(8).any(|word| word == b"<COLLADA") {
            return Some(Content::Mesh(Format::Dae));
        }
    }
    if let Some((_, name)) = SIGNATURES.iter().find(|(signature, _)| is(signature)) {
        return Some(Content::Other(name));
    }
    // `solid` alone is no word of the other formats, and neither are the rest.
    let first = first_words(start)?;
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

/// `OFF` with a prefix of capitals, and perhaps a count right behind it.
fn is_off(word: &str) -> bool {
    let Some((prefix, rest)) = word.split_once("OFF") else { return false };
    matches!(prefix, "" | "ST" | "C" | "N" | "CN" | "STC" | "STN" | "STCN" | "4" | "n")
        && rest.bytes().all(|b| b.is_ascii_digit())
}

/// The first line that is neither blank nor a comment, among the first ones.
fn first_words(start: &[u8]) -> Option<String> {
    let text = String::from_utf8_lossy(&start[..start.len().min(LOOKED_AT)]);
    let mut contents = lines(&text).map(|line| line.split('#').next().unwrap_or_default().trim());
    contents.find(|content| !content.is_empty()).map(str::to_owned)
}
