//! Reads a folder of mesh files: each file is a part, named after the file, at the position of its coordinates.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use colltrans_mesh::{Format, Mesh};
use glam::{DAffine3, DVec3};

use super::files::Source;
use super::{Draft, Placed, assemble, file_stem, io_error, parse_mesh};
use crate::error::ReadError;
use colltrans_assembly::Assembly;
use colltrans_assembly::units;

/// Reads all mesh files of a folder.
pub(super) fn read_folder(source: Source) -> Result<Assembly, ReadError> {
    let (mut files, mut others) = (Vec::new(), OtherEntries::default());
    for entry in std::fs::read_dir(source.path).map_err(io_error(source.path))? {
        let file = entry.map_err(io_error(source.path))?.path();
        // A dangling link and a pipe are rejected when they are read, not skipped.
        if !file.is_dir() && Format::from_path(&file).is_ok() {
            files.push(file);
        } else {
            others.count_entry(&file);
        }
    }
    // The order of directory entries depends on the file system.
    files.sort_by_key(|file| natural_sort_key(&file_stem(file)));
    let notes = others.unread_note();
    let assembly = read_files(source, &files, &others.contents_text())?;
    Ok(notes.into_iter().fold(assembly, Assembly::with_note))
}

/// Reads a single mesh file.
pub(super) fn read_file(source: Source) -> Result<Assembly, ReadError> {
    let file = source.path.to_owned();
    read_files(source, &[file], "")
}

/// Reads mesh files as parts of one assembly. `holds` describes the source for the error if there are none.
fn read_files(source: Source, files: &[PathBuf], holds: &str) -> Result<Assembly, ReadError> {
    let mut drafts = Vec::with_capacity(files.len());
    let mut units = UnitOfFirst::default();
    let mut up = None;
    for file in files {
        let mesh = parse_mesh(file, source.required_bytes(file)?)?;
        let world = units.world_from_mesh(&mesh);
        up = up.or(mesh.up);
        let placed = Placed { mesh: Arc::new(mesh), world };
        drafts
            .push(Draft { file: Some(file.clone()), ..Draft::new(file_stem(file), vec![placed]) });
    }
    let assembly = assemble(source, drafts, holds)?;
    let assembly = up.into_iter().fold(assembly, Assembly::with_up);
    Ok(units.name.into_iter().fold(assembly, Assembly::with_unit))
}

/// The unit of an assembly: that of the first file that has one.
#[derive(Default)]
struct UnitOfFirst {
    name: Option<&'static str>,
    metres: Option<f64>,
}

impl UnitOfFirst {
    /// Returns the scale of a mesh to the unit of the assembly. A mesh without a unit is not scaled. If the
    /// first unit has no name, the assembly is in metres.
    fn world_from_mesh(&mut self, mesh: &Mesh) -> DAffine3 {
        let Some(own) = mesh.unit else { return DAffine3::IDENTITY };
        let metres = *self.metres.get_or_insert_with(|| {
            self.name = Some(units::unit_name(own).unwrap_or("m"));
            if units::unit_name(own).is_some() { own } else { 1.0 }
        });
        if own == metres {
            DAffine3::IDENTITY
        } else {
            DAffine3::from_scale(DVec3::splat(own / metres))
        }
    }
}

/// The entries of a folder that are not mesh files.
#[derive(Default)]
struct OtherEntries {
    folders: usize,
    by_kind: BTreeMap<String, usize>,
    /// Names of files that may place the parts (`.toml`, `.urdf`). JSON is left out, because it may be
    /// anything, for example an answer of this crate.
    manifests: Vec<String>,
}

impl OtherEntries {
    /// Counts an entry of the folder.
    fn count_entry(&mut self, file: &Path) {
        if file.is_dir() {
            self.folders += 1;
            return;
        }
        let kind = file.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
        let kind = kind.unwrap_or_default();
        if ["toml", "urdf"].contains(&&*kind) {
            self.manifests.extend(file.file_name().map(|name| name.to_string_lossy().into()));
        }
        *self.by_kind.entry(kind).or_default() += 1;
    }

    /// Returns a note on the files that may place the parts and are not read; `None` if there are none.
    fn unread_note(&self) -> Option<String> {
        let mut names = self.manifests.clone();
        names.sort();
        (!names.is_empty()).then(|| {
            format!(
                "not read: {}; the parts keep the coordinates of their mesh files; to place them, give this file as the source",
                names.join(", ")
            )
        })
    }

    /// Describes the folder's contents for the error that it has no mesh, with advice.
    fn contents_text(&self) -> String {
        let none = format!("the folder has no {} file", Format::list_names("or"));
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
            return format!("{none}; the folder is empty");
        }
        let has = |kinds: &[&str]| kinds.iter().any(|kind| self.by_kind.contains_key(*kind));
        let advice = if has(&["step", "stp"]) {
            "; give the path of the STEP file"
        } else if has(&["toml", "json", "urdf", "glb", "gltf", "3mf"]) {
            "; give the path of the manifest, URDF, glTF or 3MF file"
        } else if self.folders > 0 {
            "; give the folder that contains the meshes"
        } else {
            ""
        };
        found.truncate(6);
        format!("{none}, but {}{advice}", found.join(", "))
    }
}

/// Returns a sort key that orders numbers in names by value, for example `bolt_2` before `bolt_10`.
fn natural_sort_key(name: &str) -> (Vec<(String, u64)>, String) {
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
    use super::natural_sort_key;

    #[test]
    fn file_names_sort_by_numeric_value() {
        let mut names = ["car_10", "b2", "car_9", "car", "B1", "car_99999999999999999999999"];
        names.sort_by_key(|n| natural_sort_key(n));
        assert_eq!(names, ["B1", "b2", "car", "car_9", "car_10", "car_99999999999999999999999"]);
    }
}
