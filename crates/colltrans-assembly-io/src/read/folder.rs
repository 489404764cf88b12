//! A folder of mesh files, each a part in its place, named as the file.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use colltrans_mesh::{Format, Mesh};
use glam::{DAffine3, DVec3};

use super::files::Source;
use super::{Draft, Placed, assembled, io, mesh, stem};
use crate::error::ReadError;
use colltrans_assembly::Assembly;
use colltrans_assembly::units;

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
    let notes = others.unread();
    let assembly = read_files(source, &files, &others.told())?;
    Ok(notes.into_iter().fold(assembly, Assembly::with_note))
}

pub(super) fn read_file(source: Source) -> Result<Assembly, ReadError> {
    let file = source.path.to_owned();
    read_files(source, &[file], "")
}

fn read_files(source: Source, files: &[PathBuf], holds: &str) -> Result<Assembly, ReadError> {
    let mut drafts = Vec::with_capacity(files.len());
    let mut units = Units::default();
    let mut up = None;
    for file in files {
        let mesh = mesh(file, source.at(file)?)?;
        let world = units.world_from(&mesh);
        up = up.or(mesh.up);
        let placed = Placed { mesh: Arc::new(mesh), world };
        drafts.push(Draft { file: Some(file.clone()), ..Draft::new(stem(file), vec![placed]) });
    }
    let assembly = assembled(source, drafts, holds)?;
    let assembly = up.into_iter().fold(assembly, Assembly::with_up);
    Ok(units.name.into_iter().fold(assembly, Assembly::with_unit))
}

/// The unit of an assembly: that of the first file that says one.
#[derive(Default)]
struct Units {
    name: Option<&'static str>,
    metres: Option<f64>,
}

impl Units {
    /// The scale of a mesh. What does not say its unit is in that of the others; a unit without a name becomes metres.
    fn world_from(&mut self, mesh: &Mesh) -> DAffine3 {
        let Some(own) = mesh.unit else { return DAffine3::IDENTITY };
        let metres = *self.metres.get_or_insert_with(|| {
            self.name = Some(units::name(own).unwrap_or("m"));
            if units::name(own).is_some() { own } else { 1.0 }
        });
        if own == metres {
            DAffine3::IDENTITY
        } else {
            DAffine3::from_scale(DVec3::splat(own / metres))
        }
    }
}

/// What is in a folder that is no mesh.
#[derive(Default)]
struct Others {
    folders: usize,
    by_kind: BTreeMap<String, usize>,
    /// Names of what may say where parts are: not JSON, which is anything, answers of this crate among it.
    manifests: Vec<String>,
}

impl Others {
    fn count(&mut self, file: &Path) {
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

    /// What is not read though there are meshes.
    fn unread(&self) -> Option<String> {
        let mut names = self.manifests.clone();
        names.sort();
        (!names.is_empty()).then(|| {
            format!(
                "not read: {}; parts are where their files have them, unless it is given itself",
                names.join(", ")
            )
        })
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
            "; give a STEP file itself"
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
