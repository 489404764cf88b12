//! A folder of mesh files, each a part in its place, named as the file.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use colltrans_mesh::Format;
use glam::DAffine3;

use super::files::Source;
use super::{assembled, in_file, io, piece, stem};
use crate::error::ReadError;
use crate::part::{Assembly, Part};

pub(super) fn read(source: Source) -> Result<Assembly, ReadError> {
    let (mut files, mut others) = (Vec::new(), Others::default());
    for entry in std::fs::read_dir(source.path).map_err(io(source.path))? {
        let file = entry.map_err(io(source.path))?.path();
        // A link that leads nowhere and a pipe are refused when they are read, not left out.
        if !file.is_dir() && Format::of_path(&file).is_ok() {
            files.push(file);
        } else {
            others.count(&file);
        }
    }
    // Folders list their files in any order.
    files.sort_by_key(|file| natural(&stem(file)));
    read_files(source, &files, &others.told())
}

pub(super) fn read_file(source: Source) -> Result<Assembly, ReadError> {
    let file = source.path.to_owned();
    read_files(source, &[file], "")
}

fn read_files(source: Source, files: &[PathBuf], holds: &str) -> Result<Assembly, ReadError> {
    let mut parts = Vec::with_capacity(files.len());
    for file in files {
        let bytes = source.at(file)?;
        let piece = piece(file, bytes, DAffine3::IDENTITY)?;
        parts.push(
            Part::with_options(stem(file), &[piece], &source.options.body())
                .map_err(in_file(file))?,
        );
    }
    assembled(source, parts, holds)
}

/// What is in a folder that is no mesh.
#[derive(Default)]
struct Others {
    folders: usize,
    by_kind: BTreeMap<String, usize>,
}

impl Others {
    fn count(&mut self, file: &Path) {
        if file.is_dir() {
            self.folders += 1;
            return;
        }
        let kind = file.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
        *self.by_kind.entry(kind.unwrap_or_default()).or_default() += 1;
    }

    /// What was found, and what to do.
    fn told(&self) -> String {
        let none = format!("no {} file is in this folder", Format::names("or"));
        let counted = |count: usize, what: &str| {
            if count == 1 { format!("1 {what}") } else { format!("{count} {what}s") }
        };
        let mut found: Vec<String> = Vec::new();
        if self.folders > 0 {
            found.push(counted(self.folders, "folder"));
        }
        for (kind, count) in &self.by_kind {
            let what = if kind.is_empty() { "other file".into() } else { format!(".{kind} file") };
            found.push(counted(*count, &what));
        }
        if found.is_empty() {
            return format!("{none}; it is empty");
        }
        let has = |kinds: &[&str]| kinds.iter().any(|kind| self.by_kind.contains_key(*kind));
        let advice = if has(&["step", "stp"]) {
            "; STEP files are not read: tessellate each part to a mesh file in its place first"
        } else if has(&["toml", "json", "urdf", "glb", "gltf", "3mf"]) {
            "; give the manifest, URDF, glTF or 3MF file itself"
        } else if self.folders > 0 {
            "; give the folder that holds the meshes"
        } else {
            ""
        };
        found.truncate(6);
        format!("{none}, but {}{advice}", found.join(", "))
    }
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
