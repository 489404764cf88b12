//! Reads a manifest: files, their placement, fixed parts, pairs with a fit, and constraints on plans.
//!
//! TOML and JSON have the same fields, which `docs/reference/assemblies.md` and `colltrans help files` list.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use colltrans::Pose;
use glam::{DAffine3, DMat3, DQuat, DVec3};
use serde::de::Error;
use serde::{Deserialize, Deserializer};

use super::files::Source;
use super::{
    Budget, Draft, Placed, Split, assemble, assembly_error, contents_error, file_stem,
    json_error_reason, parse_mesh, reword_parser_message,
};
use crate::error::ReadError;
use colltrans_assembly::AssemblyError;
use colltrans_assembly::constraints::DEFAULT_FORBIDDEN_DEGREES;
use colltrans_assembly::roles::{PairFit, Role};
use colltrans_assembly::units;
use colltrans_assembly::{Assembly, Ignored, Part};

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "an object (manifest)")]
struct Manifest {
    unit: Option<String>,
    /// Densities of materials in kilograms per cubic metre.
    #[serde(default)]
    densities: BTreeMap<String, f64>,
    #[serde(default, alias = "part")]
    parts: Vec<PartEntry>,
    #[serde(default)]
    ignore: Vec<Exactly<String, 2>>,
    #[serde(default)]
    ignore_always: Vec<Exactly<String, 2>>,
    #[serde(default, alias = "pair")]
    pairs: Vec<Contact>,
    #[serde(default)]
    before: Vec<Exactly<String, 2>>,
    #[serde(default)]
    after: Vec<Exactly<String, 2>>,
    #[serde(default)]
    together: Vec<Vec<String>>,
    #[serde(default, alias = "subassembly")]
    subassemblies: Vec<Subassembly>,
    #[serde(default)]
    never: Vec<NeverTaken>,
}

/// The fit of two parts.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "an object with two parts and their role or tolerance")]
struct Contact {
    parts: Exactly<String, 2>,
    role: Option<Role>,
    tolerance: Option<f64>,
}

/// Parts that are removed as one and are disassembled separately.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "an object with the name and the parts of a subassembly")]
struct Subassembly {
    name: String,
    parts: Vec<String>,
}

/// A direction that parts never take.
#[derive(Deserialize)]
#[serde(
    deny_unknown_fields,
    expecting = "an object with parts and the direction that they never take"
)]
struct NeverTaken {
    parts: Vec<String>,
    along: Exactly<f64, 3>,
    #[serde(default = "default_within_degrees")]
    within_degrees: f64,
}

/// Returns the default of the field `within_degrees`.
const fn default_within_degrees() -> f64 {
    DEFAULT_FORBIDDEN_DEGREES
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "an object (part)")]
struct PartEntry {
    file: OneOrMany,
    name: Option<String>,
    translation: Option<Exactly<f64, 3>>,
    rotation: Option<Rotation>,
    scale: Option<Scale>,
    #[serde(default)]
    fixed: bool,
    split: Option<String>,
    material: Option<String>,
    /// The density in kilograms per cubic metre.
    density: Option<f64>,
}

#[derive(Deserialize)]
#[serde(untagged, expecting = "a file must be a name or a list of names")]
enum OneOrMany {
    One(String),
    Many(Vec<String>),
}

#[derive(Deserialize)]
#[serde(untagged, expecting = "a scale must be a number or three numbers")]
enum Scale {
    Same(f64),
    Each([f64; 3]),
}

/// A quaternion `x, y, z, w`; or roll, pitch and yaw in degrees; or the rows of a matrix.
#[derive(Deserialize)]
#[serde(
    untagged,
    expecting = "a rotation must be { quaternion = [x, y, z, w] }, { rpy_degrees = [roll, pitch, yaw] } or \
                 { matrix = three rows of three numbers }"
)]
enum Rotation {
    Quaternion([f64; 4]),
    Named(NamedRotation),
    Matrix([[f64; 3]; 3]),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
enum NamedRotation {
    Quaternion([f64; 4]),
    RpyDegrees([f64; 3]),
    Matrix([[f64; 3]; 3]),
}

/// A list of exactly `N` elements. The TOML parser silently drops elements beyond the length of an array.
#[derive(Clone)]
struct Exactly<T, const N: usize>([T; N]);

impl<'de, T: Deserialize<'de>, const N: usize> Deserialize<'de> for Exactly<T, N> {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let all = Vec::deserialize(from)?;
        let count = all.len();
        let refused = |_| D::Error::invalid_length(count, &&*format!("a list of {N}"));
        all.try_into().map(Self).map_err(refused)
    }
}

/// Reads the assembly of a manifest.
pub(super) fn read_manifest(source: Source) -> Result<Assembly, ReadError> {
    let path = source.path;
    let text = source.text()?;
    let toml = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("toml"));
    let manifest: Manifest = if toml {
        toml::from_str(&text).map_err(|e| {
            contents_error(path, toml_place(&text, &e), reword_parser_message(e.message()))
        })?
    } else {
        let place = |e: &serde_json::Error| format!("line {}, column {}", e.line(), e.column());
        serde_json::from_str(&text)
            .map_err(|e| contents_error(path, place(&e), json_error_reason(&e)))?
    };
    let metres = manifest.unit.as_deref().and_then(units::unit_in_metres);
    let mut gathered = PartGatherer {
        budget: Budget::with_bytes(text.len()),
        metres,
        densities: manifest.densities.clone(),
        ..PartGatherer::default()
    };
    for (k, entry) in manifest.parts.iter().enumerate() {
        gathered.add_part(&source, k, entry)?;
    }
    let PartGatherer { drafts, missing, left_out, notes, .. } = gathered;
    if !missing.is_empty() && !source.options.skip_missing {
        return Err(ReadError::MissingMeshes { path: path.into(), missing });
    }
    let holds = match missing.len() {
        0 => "it lists no parts".to_owned(),
        missing => format!("none of its parts has all of its files; {missing} files not found"),
    };
    let mut assembly = assemble(source, drafts, &holds)?;
    let (manifest, dropped) = manifest.without_parts(&left_out, &assembly);
    let Manifest { ignore, ignore_always: always, .. } = &manifest;
    for (pairs, ignored) in [(ignore, Ignored::Overlap), (always, Ignored::Always)] {
        let pairs: Vec<[&String; 2]> = pairs.iter().map(|pair| pair.0.each_ref()).collect();
        assembly = assembly.with_ignored(&pairs, ignored).map_err(assembly_error(path))?;
    }
    assembly = manifest.add_constraints(assembly).map_err(assembly_error(path))?;
    for note in notes {
        assembly = assembly.with_note(note);
    }
    for said in dropped {
        assembly = assembly.with_note(format!("{said}, because some of its parts are left out"));
    }
    for file in missing {
        assembly = assembly.with_note(format!("{file} not found; left out"));
    }
    Ok(if let Some(unit) = manifest.unit { assembly.with_unit(unit) } else { assembly })
}

impl Manifest {
    /// Removes the parts that are left out from pairs and constraints. Returns the manifest with a note on each
    /// changed entry. Entries with too few remaining parts are dropped, others apply to the remaining parts.
    fn without_parts(mut self, left_out: &[String], assembly: &Assembly) -> (Self, Vec<String>) {
        let like = |name: &str, part: &String| match name.trim().strip_suffix('*') {
            Some(prefix) => part.starts_with(prefix),
            None => part == name.trim(),
        };
        let is_there = |name: &String| {
            !left_out.iter().any(|part| like(name, part)) || assembly.parts_named(&[name]).is_ok()
        };
        let mut dropped = Vec::new();
        let mut keep = |what: &str, names: &mut Vec<String>, fewest: usize| {
            let before = names.join(", ");
            let count = names.len();
            names.retain(is_there);
            let kept = names.len() >= fewest.min(count);
            if !kept {
                dropped.push(format!("{what} of {before} is dropped"));
            } else if names.len() < count {
                dropped.push(format!("{what} of {before} applies to {} only", names.join(", ")));
            }
            kept
        };
        let mut pairs = |what: &str, all: &mut Vec<Exactly<String, 2>>| {
            all.retain(|pair| keep(what, &mut pair.0.to_vec(), 2));
        };
        pairs("ignore", &mut self.ignore);
        pairs("ignore_always", &mut self.ignore_always);
        pairs("before", &mut self.before);
        pairs("after", &mut self.after);
        self.pairs.retain(|contact| keep("pair", &mut contact.parts.0.to_vec(), 2));
        self.together.retain_mut(|parts| keep("together", parts, 2));
        self.subassemblies
            .retain_mut(|of| keep(&format!("subassembly {}", of.name), &mut of.parts, 2));
        self.never.retain_mut(|of| keep("never", &mut of.parts, 1));
        (self, dropped)
    }

    /// Adds pairs and constraints to the assembly.
    fn add_constraints(&self, mut assembly: Assembly) -> Result<Assembly, AssemblyError> {
        for Contact { parts: Exactly([a, b]), role, tolerance } in &self.pairs {
            let fit = PairFit { role: *role, tolerance: *tolerance };
            assembly = assembly.with_pair([&[a], &[b]], fit)?;
        }
        let turned = self.after.iter().map(|Exactly([later, first])| [first, later]);
        for [first, later] in self.before.iter().map(|Exactly([a, b])| [a, b]).chain(turned) {
            assembly = assembly.with_before(&[first], &[later])?;
        }
        for parts in &self.together {
            assembly = assembly.with_together(parts)?;
        }
        for Subassembly { name, parts } in &self.subassemblies {
            assembly = assembly.with_subassembly(name, parts)?;
        }
        for NeverTaken { parts, along, within_degrees } in &self.never {
            assembly = assembly.with_never(parts, DVec3::from_array(along.0), *within_degrees)?;
        }
        Ok(assembly)
    }
}

/// The parts while they are gathered.
#[derive(Default)]
struct PartGatherer {
    budget: Budget,
    /// The unit of the manifest in metres, if it names a known unit.
    metres: Option<f64>,
    /// The densities of materials in kilograms per cubic metre.
    densities: BTreeMap<String, f64>,
    drafts: Vec<Draft>,
    missing: Vec<String>,
    /// Names of parts with missing files.
    left_out: Vec<String>,
    notes: Vec<String>,
}

impl PartGatherer {
    /// Reads the files of part `k` and adds its draft.
    fn add_part(&mut self, source: &Source, k: usize, entry: &PartEntry) -> Result<(), ReadError> {
        let files = match &entry.file {
            OneOrMany::One(file) => std::slice::from_ref(file),
            OneOrMany::Many(files) => files,
        };
        let refused = |reason: String| contents_error(source.path, part_place(k), reason);
        let first = files
            .first()
            .ok_or_else(|| refused("the list of files is empty; give at least one file".into()))?;
        let name = entry.name.clone().unwrap_or_else(|| file_stem(Path::new(first)));
        let (world, normalised) = entry.world_from_mesh().map_err(|reason| {
            contents_error(source.path, format!("{} ({name})", part_place(k)), reason)
        })?;
        if let Some(off) = normalised {
            self.notes.push(format!(
                "the rotation of {name} deviates from a rotation by {off:.0e} and was normalised; directions may \
                 deviate by that much"
            ));
        }
        let (mut pieces, missing) = (Vec::new(), self.missing.len());
        for file in files {
            let Some((path, bytes)) = source.open_reference(file)? else {
                self.missing.push(file.clone());
                continue;
            };
            self.budget.count_file(&path, bytes.len());
            let mesh = parse_mesh(&path, bytes)?;
            self.budget.count_facets(mesh.faces.len().max(mesh.vertices.len())).map_err(refused)?;
            // A mesh file with a unit is converted to the unit of the manifest.
            let world = match (mesh.unit, self.metres) {
                (Some(own), Some(metres)) if own != metres => {
                    world * DAffine3::from_scale(DVec3::splat(own / metres))
                }
                _ => world,
            };
            pieces.push(Placed { mesh: Arc::new(mesh), world });
        }
        if self.missing.len() == missing {
            self.budget.count_placed().map_err(refused)?;
            let split = entry.split.as_ref().map(|word| word.parse::<Split>());
            let split = split.transpose().map_err(|e| {
                contents_error(
                    source.path,
                    format!("{} ({name})", part_place(k)),
                    format!("split: {e}"),
                )
            })?;
            let of_material =
                entry.material.as_ref().and_then(|name| self.densities.get(name).copied());
            let density = entry.density.or(of_material);
            if let Some(value) = density.filter(|value| !Part::is_density(*value)) {
                return Err(refused(format!(
                    "invalid density {value:?} of {name}; accepted: kilograms per cubic metre, from 0 to below 1e9"
                )));
            }
            let material = entry.material.clone();
            let draft =
                Draft { fixed: entry.fixed, split, material, density, ..Draft::new(name, pieces) };
            self.drafts.push(draft.marked_as_one_part());
        } else {
            self.left_out.push(name);
        }
        Ok(())
    }
}

/// Returns the place of part `k` for messages.
fn part_place(k: usize) -> String {
    format!("part {}", k + 1)
}

/// Returns line and column of a TOML error.
fn toml_place(text: &str, error: &toml::de::Error) -> String {
    let offset = error.span().map_or(0, |span| span.start.min(text.len()));
    let before = text.get(..offset).unwrap_or_default();
    let line = before.matches('\n').count() + 1;
    let column = before.chars().rev().take_while(|c| *c != '\n').count() + 1;
    format!("line {line}, column {column}")
}

impl PartEntry {
    /// Returns the transformation of the part, and the defect of its rotation if it was normalised.
    fn world_from_mesh(&self) -> Result<(DAffine3, Option<f64>), String> {
        let exact = Ok((DMat3::IDENTITY, None));
        let (rotation, normalised) = self.rotation.as_ref().map_or(exact, Rotation::to_matrix)?;
        let scale = match self.scale {
            None => DVec3::ONE,
            Some(Scale::Same(s)) => DVec3::splat(s),
            Some(Scale::Each(s)) => DVec3::from_array(s),
        };
        let translation = self.translation.as_ref().map_or(DVec3::ZERO, |by| by.0.into());
        if !scale.is_finite() || scale.element_product() == 0.0 {
            return Err(format!(
                "invalid scale {:?}; accepted: finite and not zero",
                scale.to_array()
            ));
        }
        if !translation.is_finite() {
            return Err(format!(
                "invalid translation {:?}; accepted: finite numbers",
                translation.to_array()
            ));
        }
        let matrix = rotation * DMat3::from_diagonal(scale);
        Ok((DAffine3::from_mat3_translation(matrix, translation), normalised))
    }
}

impl Rotation {
    /// Returns the rotation, and its defect if it was normalised.
    fn to_matrix(&self) -> Result<(DMat3, Option<f64>), String> {
        match self {
            Self::Quaternion(q) | Self::Named(NamedRotation::Quaternion(q)) => {
                rotation_from_quaternion(*q)
            }
            Self::Named(NamedRotation::RpyDegrees(rpy)) if rpy.iter().any(|a| !a.is_finite()) => {
                Err(format!("invalid rpy_degrees {rpy:?}; accepted: finite numbers"))
            }
            Self::Named(NamedRotation::RpyDegrees(rpy)) => {
                Ok((rotation_from_rpy(rpy.map(f64::to_radians)), None))
            }
            Self::Matrix(rows) | Self::Named(NamedRotation::Matrix(rows)) => {
                rotation_from_matrix(rows)
            }
        }
    }
}

/// Returns the rotation, and its defect if it was normalised, by the rule of [`Pose::from_rounded`].
fn rotation_from_quaternion(q: [f64; 4]) -> Result<(DMat3, Option<f64>), String> {
    let rotation = DQuat::from_array(q);
    let (_, defect) = Pose::from_rounded(rotation, DVec3::ZERO).map_err(|_| {
        format!("quaternion {q:?} (x, y, z, w) has length {}, expected 1", rotation.length())
    })?;
    Ok((DMat3::from_quat(rotation.normalize()), defect))
}

/// Returns the rotation, and its defect if it was normalised, by the rule of [`Pose::from_rounded_matrix`].
fn rotation_from_matrix(rows: &[[f64; 3]; 3]) -> Result<(DMat3, Option<f64>), String> {
    let matrix = DMat3::from_cols_array_2d(rows).transpose();
    let (pose, defect) = Pose::from_rounded_matrix(matrix, DVec3::ZERO).map_err(|_| {
        format!("matrix {rows:?} is not a rotation; give scale factors in the field scale")
    })?;
    // An exact rotation keeps its bits.
    Ok((defect.map_or(matrix, |_| pose.matrix()), defect))
}

/// Returns the rotation by roll about x, then pitch about y, then yaw about z, in radians. Quarter turns are
/// exact.
pub(super) fn rotation_from_rpy([roll, pitch, yaw]: [f64; 3]) -> DMat3 {
    let turn = |angle: f64| {
        let (s, c) = angle.sin_cos();
        let tidy = |x: f64| if x.abs() < 1e-15 { 0.0 } else { x };
        (tidy(s), tidy(c))
    };
    let ((sr, cr), (sp, cp), (sy, cy)) = (turn(roll), turn(pitch), turn(yaw));
    let x = DMat3::from_cols(DVec3::X, DVec3::new(0.0, cr, sr), DVec3::new(0.0, -sr, cr));
    let y = DMat3::from_cols(DVec3::new(cp, 0.0, -sp), DVec3::Y, DVec3::new(sp, 0.0, cp));
    let z = DMat3::from_cols(DVec3::new(cy, sy, 0.0), DVec3::new(-sy, cy, 0.0), DVec3::Z);
    z * y * x
}
