//! Builds parts from the meshes that a source places, whole or split into bodies.

use std::path::PathBuf;
use std::str::FromStr;
use std::sync::Arc;

use colltrans::solid::ShellKind;
use colltrans_mesh::Mesh;
use colltrans_mesh::body::{self, SplitBodies};
use colltrans_mesh::words::first_named;
use glam::{DAffine3, DVec3};

use super::files::Source;
use super::{MAX_PLACED, Names, assembly_error, contents_error};
use crate::error::ReadError;
use colltrans_assembly::AssemblyError;
use colltrans_assembly::{Assembly, Part, Piece};

/// Maximum number of names that a note lists.
pub(super) const MOST_NAMED: usize = 4;

/// The rule by which placed meshes are split into parts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
pub enum Split {
    /// Splits only a source with a single mesh that the source does not declare to be one part. It is split into the
    /// named objects of its file, or into its bodies if the file names none. Other sources are read as with
    /// [`Never`](Self::Never), except that each 3MF object with a mesh is a part.
    #[default]
    Auto,
    /// Each mesh file, glTF node, URDF link or item of a 3MF build is one part.
    Never,
    /// Each object, group or solid that a mesh file names is a part.
    Names,
    /// Each body is a part: a closed shell with its cavities, or an open shell.
    Bodies,
}

impl Split {
    /// All rules.
    pub const ALL: [Self; 4] = [Self::Auto, Self::Never, Self::Names, Self::Bodies];

    /// Returns the name of the rule: `auto`, `never`, `names` or `bodies`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Never => "never",
            Self::Names => "names",
            Self::Bodies => "bodies",
        }
    }
}

impl FromStr for Split {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let known = Self::ALL.into_iter().find(|split| split.name() == text);
        known.ok_or_else(|| {
            format!("unknown split {text}; accepted: {}", Self::ALL.map(Self::name).join(", "))
        })
    }
}

/// A part before its solid is built.
pub(super) struct Draft {
    pub(super) name: String,
    pub(super) pieces: Vec<Placed>,
    pub(super) fixed: bool,
    /// The chord error, in the unit of the assembly.
    pub(super) chord_error: Option<f64>,
    /// The colour, as red, green and blue in sRGB.
    pub(super) colour: Option<[f64; 3]>,
    /// The name of the material.
    pub(super) material: Option<String>,
    /// The density in kilograms per cubic metre.
    pub(super) density: Option<f64>,
    /// Whether the source declares this to be one part.
    pub(super) is_one_part: bool,
    /// The rule of the source for this part, which overrides the option.
    pub(super) split: Option<Split>,
    /// The file of the part, if it is not the source.
    pub(super) file: Option<PathBuf>,
    /// The place in the source, for messages.
    pub(super) place: Option<String>,
}

/// A mesh and its transformation to the world.
#[derive(Clone)]
pub(super) struct Placed {
    pub(super) mesh: Arc<Mesh>,
    pub(super) world: DAffine3,
}

impl From<Piece> for Placed {
    fn from(Piece { mesh, world_from_piece: world }: Piece) -> Self {
        Self { mesh: Arc::new(mesh), world }
    }
}

impl Draft {
    pub(super) fn new(name: impl Into<String>, pieces: Vec<Placed>) -> Self {
        Self {
            name: name.into(),
            pieces,
            fixed: false,
            chord_error: None,
            colour: None,
            material: None,
            density: None,
            is_one_part: false,
            split: None,
            file: None,
            place: None,
        }
    }

    /// Marks the draft as one part by declaration of the source.
    pub(super) fn marked_as_one_part(self) -> Self {
        Self { is_one_part: true, ..self }
    }

    /// Adds the file and the place of the draft to an error.
    fn located_error(&self, source: &Source, error: AssemblyError) -> ReadError {
        let path = self.file.as_deref().unwrap_or(source.path);
        match &self.place {
            Some(place) => contents_error(path, place, error),
            None => assembly_error(path)(error),
        }
    }
}

/// Builds the assembly of a source. `holds` describes the source for the error if there are no drafts.
pub(super) fn assemble(
    source: Source,
    drafts: Vec<Draft>,
    holds: &str,
) -> Result<Assembly, ReadError> {
    let path = source.path;
    if drafts.is_empty() {
        return Err(ReadError::NoParts { path: path.into(), holds: holds.into() });
    }
    let drafts = apply_scales(&source, drafts)?;
    let alone = drafts.len() == 1;
    let mut builder = PartBuilder::default();
    builder.names.reserve(drafts.iter().map(|draft| &draft.name));
    for draft in drafts {
        builder.add_draft(&source, &draft, alone)?;
        if builder.parts.len() > MAX_PLACED {
            let reason = format!(
                "more than {MAX_PLACED} bodies are placed; split the source into smaller ones"
            );
            return Err(contents_error(path, "bodies", reason));
        }
    }
    let kept_note = builder.several_bodies_note();
    let assembly = Assembly::new(builder.parts).map_err(assembly_error(path))?;
    let notes = builder.notes.into_iter().chain(kept_note);
    Ok(notes.fold(assembly, Assembly::with_note).with_files(source.into_files()))
}

/// Applies the scale factors of the options. Rejects invalid factors and names without a draft.
fn apply_scales(source: &Source, mut drafts: Vec<Draft>) -> Result<Vec<Draft>, ReadError> {
    for (name, &factor) in &source.options.scales {
        let refused = |error| assembly_error(source.path)(error);
        if !(factor.is_finite() && factor > 0.0) {
            return Err(refused(AssemblyError::InvalidValue { what: "scale", value: factor }));
        }
        let is_meant = |draft: &Draft| match name.strip_suffix('*') {
            Some(prefix) => draft.name.starts_with(prefix),
            None => draft.name == *name,
        };
        let mut count = 0;
        for draft in drafts.iter_mut().filter(|draft| is_meant(draft)) {
            for piece in &mut draft.pieces {
                piece.world = DAffine3::from_scale(DVec3::splat(factor)) * piece.world;
            }
            draft.chord_error = draft.chord_error.map(|error| error * factor);
            count += 1;
        }
        if count == 0 {
            return Err(refused(AssemblyError::UnknownPart { name: name.clone(), near: None }));
        }
    }
    Ok(drafts)
}

/// The parts that were built.
#[derive(Default)]
struct PartBuilder {
    parts: Vec<Part>,
    names: Names,
    notes: Vec<String>,
    /// The names of the parts that consist of several closed bodies, with the number of bodies.
    several_bodies: Vec<(String, usize)>,
}

impl PartBuilder {
    /// Builds the part of a draft, or several if it is split. `alone` means that the source has no other
    /// drafts.
    fn add_draft(&mut self, source: &Source, draft: &Draft, alone: bool) -> Result<(), ReadError> {
        let split = draft.split.unwrap_or(source.options.split);
        let is_single = alone && !draft.is_one_part && draft.pieces.len() == 1;
        let apart = match split {
            Split::Auto if is_single => {
                let named = named_objects(draft);
                if named.is_empty() { self.split_bodies(source, draft, named)? } else { named }
            }
            Split::Auto | Split::Never => Vec::new(),
            Split::Names => named_objects(draft),
            Split::Bodies => self.split_bodies(source, draft, named_objects(draft))?,
        };
        if apart.is_empty() {
            let part = build_part(source, draft, &draft.name, &draft.pieces)?;
            let of_body = |kind, volume: f64| kind == ShellKind::Closed && volume > 0.0;
            let shells = &part.solid().report().shells;
            let bodies = shells.iter().filter(|s| of_body(s.kind, s.volume)).count();
            if split == Split::Auto && !draft.is_one_part && bodies > 1 {
                self.several_bodies.push((draft.name.clone(), bodies));
            }
            self.parts.push(part);
            return Ok(());
        }
        if split == Split::Auto {
            self.notes.push(format!(
                "{}: {} bodies in one mesh, each read as a part; use `split never` to read them as one part",
                draft.name,
                apart.len()
            ));
        }
        for (name, placed) in apart {
            let name = if alone { name } else { format!("{}/{name}", draft.name) };
            let name = self.names.unique_name(&name);
            self.parts.push(build_part(source, draft, &name, &[placed])?);
        }
        Ok(())
    }

    /// Splits the named objects of a draft, or the draft itself, into bodies. Returns an empty list if there is
    /// only one.
    fn split_bodies(
        &mut self,
        source: &Source,
        draft: &Draft,
        named: Vec<(String, Placed)>,
    ) -> Result<Vec<(String, Placed)>, ReadError> {
        let whole = || draft.pieces.iter().map(|placed| (draft.name.clone(), placed.clone()));
        let all = if named.is_empty() { whole().collect() } else { named };
        let mut apart = Vec::new();
        for (name, placed) in all {
            let refused = |source| AssemblyError::Part { part: name.clone(), source };
            let found = body::split_bodies(&placed.mesh, &source.options.body_options())
                .map_err(|e| draft.located_error(source, refused(e)))?;
            let Some(SplitBodies { meshes, notes }) = found else {
                apart.push((name, placed));
                continue;
            };
            self.notes.extend(notes.iter().map(|note| format!("{name}: {note}")));
            apart.extend(meshes.into_iter().zip(1..).map(|(mesh, k)| {
                let mesh = Arc::new(mesh);
                (format!("{name}_{k}"), Placed { mesh, world: placed.world })
            }));
        }
        if apart.len() < 2 {
            apart.clear();
        }
        Ok(apart)
    }

    /// Returns a note on the parts that consist of several bodies; `None` if there are none.
    fn several_bodies_note(&self) -> Option<String> {
        let told = |(name, bodies): &(String, usize)| format!("{name} ({bodies})");
        let named: Vec<String> = self.several_bodies.iter().map(told).collect();
        (!named.is_empty()).then(|| {
            format!(
                "parts with several bodies: {}; use `split bodies` to read each body as a part",
                first_named(&named, MOST_NAMED)
            )
        })
    }
}

/// Returns the objects that the files of a draft name, or an empty list if no file names several.
fn named_objects(draft: &Draft) -> Vec<(String, Placed)> {
    let mut all = Vec::new();
    let mut several = false;
    for placed in &draft.pieces {
        let named = placed.mesh.named_parts();
        several |= !named.is_empty();
        if named.is_empty() {
            all.push((draft.name.clone(), placed.clone()));
        }
        all.extend(named.into_iter().map(|(name, mesh)| {
            let name = if name.trim().is_empty() { draft.name.clone() } else { name };
            (name, Placed { mesh: Arc::new(mesh), world: placed.world })
        }));
    }
    if several { all } else { Vec::new() }
}

/// Builds a part from placed meshes.
fn build_part(
    source: &Source,
    draft: &Draft,
    name: &str,
    placed: &[Placed],
) -> Result<Part, ReadError> {
    let piece =
        |placed: &Placed| Piece { mesh: Mesh::clone(&placed.mesh), world_from_piece: placed.world };
    let pieces: Vec<Piece> = placed.iter().map(piece).collect();
    let part = Part::with_options(name, &pieces, &source.options.body_options());
    let part = part.map_err(|e| draft.located_error(source, e))?;
    let part = part.with_fixed(draft.fixed).with_colour(draft.colour);
    let part = part.with_material(draft.material.clone()).with_density(draft.density);
    Ok(part.with_chord_error(draft.chord_error))
}
