//! A folder of mesh files, each a part in its place, named as the file.

use std::path::{Path, PathBuf};

use colltrans_mesh::Format;
use glam::DAffine3;

use super::{assembled, in_file, io, piece, stem};
use crate::error::ReadError;
use crate::part::{Assembly, Part};

pub(super) fn read(path: &Path) -> Result<Assembly, ReadError> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(path).map_err(io(path))? {
        let file = entry.map_err(io(path))?.path();
        if file.is_file() && Format::of_path(&file).is_ok() {
            files.push(file);
        }
    }
    // Folders list their files in any order.
    files.sort_by_key(|file| natural(&stem(file)));
    let assembly = read_files(path, &files)?;
    if files.is_empty() {
        let note = format!("{}: no STL, OBJ, PLY or OFF file is in this folder", path.display());
        return Ok(assembly.with_note(note));
    }
    Ok(assembly)
}

pub(super) fn read_files(path: &Path, files: &[PathBuf]) -> Result<Assembly, ReadError> {
    let mut parts = Vec::with_capacity(files.len());
    for file in files {
        let piece = piece(file, DAffine3::IDENTITY)?;
        parts.push(Part::new(stem(file), &[piece]).map_err(in_file(file))?);
    }
    assembled(path, parts, files.to_vec())
}

/// A key by which `bolt_2` comes before `bolt_10`.
fn natural(name: &str) -> (Vec<(String, u64)>, String) {
    let mut key = Vec::new();
    let mut rest = name;
    while !rest.is_empty() {
        let digits = rest.find(|c: char| c.is_ascii_digit()).unwrap_or(rest.len());
        let (text, tail) = rest.split_at(digits);
        let end = tail.find(|c: char| !c.is_ascii_digit()).unwrap_or(tail.len());
        let (number, tail) = tail.split_at(end);
        key.push((text.to_lowercase(), number.parse().unwrap_or(u64::MAX)));
        rest = tail;
    }
    (key, name.to_owned())
}

#[cfg(test)]
mod tests {
    use super::natural;

    #[test]
    fn numbers_sort_as_numbers() {
        let mut names = ["car_10", "b2", "car_9", "car", "B1", "car_99999999999999999999999"];
        names.sort_by_key(|n| natural(n));
        assert_eq!(names, ["B1", "b2", "car", "car_9", "car_10", "car_99999999999999999999999"]);
    }
}
