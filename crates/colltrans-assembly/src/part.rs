//! Parts in one world frame, and the assembly that they form.

use std::collections::{BTreeMap, HashMap};
use std::path::PathBuf;

use colltrans::solid::SolidError;
use colltrans::{Aabb, MAX_MAGNITUDE, Solid};
use colltrans_mesh::body::{self, BodyError, BodyOptions, Loaded};
use colltrans_mesh::{Mesh, NumberFormat};
use glam::{DAffine3, DVec3};

use crate::constraints::{Constraints, RigidUnit};
use crate::error::AssemblyError;
use crate::roles::{PairFit, Role};

/// A mesh and its pose. A part consists of one or several pieces, which may overlap.
#[derive(Debug, Clone)]
pub struct Piece {
    /// Mesh in the piece's own frame; faces run counter-clockwise as seen from outside.
    pub mesh: Mesh,
    /// Transformation from the piece's frame to the world; may scale and mirror.
    pub world_from_piece: DAffine3,
}

/// A rigid part at its place in the assembly.
#[derive(Debug, Clone)]
pub struct Part {
    name: String,
    solid: Solid,
    facets: usize,
    fixed: bool,
    defects: Vec<String>,
    chord_error: Option<f64>,
    colour: Option<[f64; 3]>,
    material: Option<String>,
    density: Option<f64>,
    last_digits: f64,
    is_coarse: bool,
}

impl Part {
    /// Creates a part from pieces. Open shells become surfaces that block from both sides, and are listed in
    /// [`Self::defects`].
    ///
    /// # Errors
    /// [`AssemblyError::EmptyName`], or [`AssemblyError::Part`] if there are no pieces or their surface is not
    /// that of a solid.
    pub fn new(name: impl Into<String>, pieces: &[Piece]) -> Result<Self, AssemblyError> {
        Self::with_options(name, pieces, &BodyOptions::default())
    }

    /// Creates a part from pieces with options for solids. Open shells are always accepted.
    ///
    /// # Errors
    /// Those of [`Self::new`], and [`AssemblyError::Part`] if a surface needs repair and [`BodyOptions::as_is`]
    /// disables it.
    pub fn with_options(
        name: impl Into<String>,
        pieces: &[Piece],
        options: &BodyOptions,
    ) -> Result<Self, AssemblyError> {
        let name = name.into();
        if name.trim().is_empty() {
            return Err(AssemblyError::EmptyName);
        }
        let refused = |source| AssemblyError::Part { part: name.clone(), source };
        let mut defects = Vec::new();
        let mut solids = Vec::with_capacity(pieces.len());
        for (k, piece) in pieces.iter().enumerate() {
            let Loaded { body, notes, .. } = solid_of_piece(piece, options).map_err(refused)?;
            solids.push(body);
            let several = pieces.len() > 1;
            defects.extend(notes.iter().map(|note| {
                if several { format!("piece {}: {note}", k + 1) } else { note.to_string() }
            }));
        }
        let facets = pieces.iter().map(|p| p.mesh.faces.len()).sum();
        let solid = match &solids[..] {
            [] => return Err(refused(SolidError::Empty.into())),
            [_] => solids.remove(0),
            _ => Solid::from_pieces(&solids).map_err(|e| refused(e.into()))?,
        };
        Ok(Self {
            name,
            solid,
            facets,
            fixed: false,
            defects,
            chord_error: None,
            colour: None,
            material: None,
            density: None,
            last_digits: pieces.iter().map(Piece::last_digits).fold(0.0, f64::max),
            is_coarse: pieces.iter().any(Piece::is_coarse),
        })
    }

    /// Returns the part marked as fixed or not. A plan never moves a fixed part.
    #[must_use]
    pub fn with_fixed(self, fixed: bool) -> Self {
        Self { fixed, ..self }
    }

    /// Returns the part with the maximum distance of its facets from the true surface; `None` if that is
    /// unknown.
    #[must_use]
    pub fn with_chord_error(self, chord_error: Option<f64>) -> Self {
        Self { chord_error, ..self }
    }

    /// Returns the part with an sRGB colour, channels from 0 to 1; `None` if that is unknown.
    #[must_use]
    pub fn with_colour(self, colour: Option<[f64; 3]>) -> Self {
        Self { colour, ..self }
    }

    /// Returns the part with the name of its material; `None` if that is unknown.
    #[must_use]
    pub fn with_material(self, material: Option<String>) -> Self {
        Self { material, ..self }
    }

    /// Returns the part with a density in kilograms per cubic metre; `None` if that is unknown.
    #[must_use]
    pub fn with_density(self, density: Option<f64>) -> Self {
        Self { density, ..self }
    }

    /// Returns the name, which is unique in an assembly.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the surface, in the world.
    pub const fn solid(&self) -> &Solid {
        &self.solid
    }

    /// Returns the number of facets in the file.
    pub const fn facet_count(&self) -> usize {
        self.facets
    }

    /// Checks whether a plan must not move the part.
    pub const fn is_fixed(&self) -> bool {
        self.fixed
    }

    /// Returns the maximum distance of the facets from the true surface, as stated by the source; `None` if
    /// that is unknown.
    pub const fn chord_error(&self) -> Option<f64> {
        self.chord_error
    }

    /// Returns the tolerance between two parts of these files that accounts for the last digits of the
    /// numbers in them.
    pub(crate) const fn last_digits(&self) -> f64 {
        self.last_digits
    }

    /// Checks whether rounding of the vertices is bounded only by the last digits of single precision of the
    /// assembly's extent.
    pub(crate) const fn is_coarse(&self) -> bool {
        self.is_coarse
    }

    /// Returns the sRGB colour; `None` if the source states none.
    pub const fn colour(&self) -> Option<[f64; 3]> {
        self.colour
    }

    /// Returns the name of the material; `None` if the source states none.
    pub fn material(&self) -> Option<&str> {
        self.material.as_deref()
    }

    /// Returns the density in kilograms per cubic metre; `None` if it is unknown.
    pub const fn density(&self) -> Option<f64> {
        self.density
    }

    /// Checks whether a density in kilograms per cubic metre is valid: from 0 to below 1e9.
    pub fn is_density(value: f64) -> bool {
        (0.0..1e9).contains(&value)
    }

    /// Returns descriptions of repairs and of remaining defects of the surface.
    pub fn defects(&self) -> &[String] {
        &self.defects
    }

    /// Checks whether some shell of the part is open.
    pub fn is_surface(&self) -> bool {
        !self.solid.is_closed()
    }

    /// Returns the axis-aligned box of the part in the world.
    pub(crate) fn bounds(&self) -> Aabb {
        self.solid.bounds()
    }
}

/// Factor of [`Mesh::precision`] for the tolerance between two files of text or doubles, as in
/// [`cast_between`](body::cast_between).
const PRECISIONS: f64 = 4.0;
/// Factor of [`Mesh::precision`] for the tolerance between two files in single precision.
const SINGLE_PRECISIONS: f64 = 2.0;

impl Piece {
    /// Returns the tolerance between two such pieces for the last digits of the numbers in their files, in
    /// the world.
    fn last_digits(&self) -> f64 {
        let stretch = self.pose_columns().map(DVec3::length).into_iter().fold(0.0, f64::max);
        let precisions = match self.mesh.format {
            NumberFormat::Single => SINGLE_PRECISIONS,
            _ => PRECISIONS,
        };
        precisions * self.mesh.precision * stretch
    }

    /// Checks whether rounding of the vertices may exceed the precision of the file. This holds for meshes
    /// without a file, for files in single precision, and for poses that are not aligned with the axes,
    /// because the digits of such poses are unknown.
    fn is_coarse(&self) -> bool {
        let has_known_digits =
            self.mesh.precision > 0.0 && self.mesh.format != NumberFormat::Single;
        let is_along_axis =
            |column: DVec3| column.to_array().iter().filter(|x| **x != 0.0).count() == 1;
        !(has_known_digits && self.pose_columns().into_iter().all(is_along_axis))
    }

    /// Returns the columns of the linear part of the pose.
    fn pose_columns(&self) -> [DVec3; 3] {
        self.world_from_piece.matrix3.to_cols_array_2d().map(DVec3::from_array)
    }
}

/// Builds the solid of a piece in the world. Faces are reversed if the pose mirrors.
fn solid_of_piece(piece: &Piece, options: &BodyOptions) -> Result<Loaded<Solid>, BodyError> {
    let mut mesh = piece.mesh.clone();
    for vertex in &mut mesh.vertices {
        *vertex = piece.world_from_piece.transform_point3(*vertex);
    }
    if piece.world_from_piece.matrix3.determinant() < 0.0 {
        mesh.faces.iter_mut().for_each(|face| face.reverse());
    }
    body::solid(&mesh, &options.with_open(true))
}

/// Contacts of a pair that are ignored.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Ignored {
    /// The overlap at the start. Contacts that begin later block, as with
    /// [`StartOverlap::Ignore`](colltrans::solid::StartOverlap::Ignore). Motions that deepen the overlap
    /// block too, if some tolerance removes the overlap.
    Overlap,
    /// All contacts: the pair is never tested.
    Always,
}

/// Parts with different names in one world frame, and the pairs whose contacts are ignored.
#[derive(Debug, Clone, Default)]
pub struct Assembly {
    parts: Vec<Part>,
    ignored: BTreeMap<[usize; 2], Ignored>,
    constraints: Constraints,
    pairs: BTreeMap<[usize; 2], PairFit>,
    unit: Option<String>,
    up: Option<DVec3>,
    notes: Vec<String>,
    files: Vec<PathBuf>,
}

impl Assembly {
    /// Creates an assembly of these parts, in this order.
    ///
    /// # Errors
    /// [`AssemblyError::DuplicateName`] if two parts have the same name.
    pub fn new(parts: Vec<Part>) -> Result<Self, AssemblyError> {
        let mut seen = HashMap::new();
        for (k, part) in parts.iter().enumerate() {
            if seen.insert(part.name.as_str(), k).is_some() {
                return Err(AssemblyError::DuplicateName { name: part.name.clone() });
            }
        }
        Ok(Self { parts, ..Self::default() })
    }

    /// Returns the assembly with pairs whose contacts are ignored: each pair of a part of the first group and one
    /// of the second. A pair that is given twice keeps the more permissive value. Names are patterns of
    /// [`parts_named`](Self::parts_named).
    ///
    /// # Errors
    /// [`AssemblyError::UnknownPart`], and [`AssemblyError::SamePart`] if both groups consist of the same single part.
    pub fn with_ignored<S: AsRef<str>>(
        mut self,
        pairs: &[[S; 2]],
        ignored: Ignored,
    ) -> Result<Self, AssemblyError> {
        for [a, b] in pairs {
            let groups = self.pair_groups([&[a], &[b]])?;
            for pair in pairs_between(&groups) {
                let stored = self.ignored.entry(pair).or_insert(ignored);
                *stored = ignored.max(*stored);
            }
        }
        Ok(self)
    }

    /// Returns the assembly with a role, a tolerance or both for each pair of a part of the first group and
    /// one of the second. A later entry for a pair replaces an earlier one, unless it has another role. Names are
    /// patterns of [`parts_named`](Self::parts_named).
    ///
    /// # Errors
    /// - [`AssemblyError::ContradictingRoles`] if a pair has another role already
    /// - [`AssemblyError::UnknownPart`]
    /// - [`AssemblyError::SamePart`] if both groups consist of the same single part
    /// - [`AssemblyError::InvalidValue`] if the tolerance is negative, not finite or too large
    /// - [`AssemblyError::NoFit`] without role and tolerance
    /// - [`AssemblyError::NoTolerance`] for a snap fit without tolerance
    /// - [`AssemblyError::CyclicOrder`] or [`AssemblyError::OverlappingSubassemblies`] if glued parts conflict with
    ///   other constraints
    pub fn with_pair<S: AsRef<str>>(
        mut self,
        names: [&[S]; 2],
        fit: PairFit,
    ) -> Result<Self, AssemblyError> {
        let groups = self.pair_groups(names)?;
        if let Some(value) = fit.tolerance.filter(|x| !(0.0..=MAX_MAGNITUDE).contains(x)) {
            return Err(AssemblyError::InvalidValue { what: "tolerance", value });
        }
        let names = || groups.each_ref().map(|group| self.parts[group[0]].name.clone());
        if fit == PairFit::default() {
            return Err(AssemblyError::NoFit { names: names() });
        }
        if fit.role == Some(Role::Snap) && fit.tolerance.is_none() {
            return Err(AssemblyError::NoTolerance { names: names() });
        }
        for pair in pairs_between(&groups) {
            let known = self.pairs.get(&pair).and_then(|known| known.role);
            if let (Some(a), Some(b)) = (known, fit.role)
                && a != b
            {
                let names = pair.map(|part| self.parts[part].name.clone());
                let roles = [a, b].map(Role::name);
                return Err(AssemblyError::ContradictingRoles { names, roles });
            }
            self.pairs.insert(pair, fit);
            if fit.role == Some(Role::Glued) {
                let unit = RigidUnit { name: None, parts: pair.to_vec(), is_subassembly: false };
                let name = |part: usize| self.parts[part].name();
                self.constraints.add_unit(unit, name)?;
            }
        }
        Ok(self)
    }

    /// Returns the indices of the parts of two groups, whose pairs get a property.
    ///
    /// # Errors
    /// [`AssemblyError::UnknownPart`], and [`AssemblyError::SamePart`] if both groups consist of the same single part.
    fn pair_groups<S: AsRef<str>>(
        &self,
        names: [&[S]; 2],
    ) -> Result<[Vec<usize>; 2], AssemblyError> {
        let groups = [self.parts_named(names[0])?, self.parts_named(names[1])?];
        match (&groups[0][..], &groups[1][..]) {
            ([a], [b]) if a == b => {
                Err(AssemblyError::SamePart { name: self.parts[*a].name.clone() })
            }
            _ => Ok(groups),
        }
    }

    /// Returns the assembly with fixed parts, which a plan never moves. Names are patterns of
    /// [`parts_named`](Self::parts_named).
    ///
    /// # Errors
    /// [`AssemblyError::UnknownPart`].
    pub fn with_fixed<S: AsRef<str>>(mut self, names: &[S]) -> Result<Self, AssemblyError> {
        for part in self.parts_named(names)? {
            self.parts[part].fixed = true;
        }
        Ok(self)
    }

    /// Returns the assembly with a density, in kilograms per cubic metre, of all parts of a material, or of parts
    /// with a name. A material of this name wins over a part of this name. The name of a part is a pattern of
    /// [`parts_named`](Self::parts_named).
    ///
    /// # Errors
    /// [`AssemblyError::InvalidValue`] if the density is negative or not finite, and
    /// [`AssemblyError::UnknownPart`] if no material and no part has the name.
    pub fn with_density(mut self, name: &str, density: f64) -> Result<Self, AssemblyError> {
        if !Part::is_density(density) {
            return Err(AssemblyError::InvalidValue { what: "density", value: density });
        }
        let is_meant = |part: &Part| part.material() == Some(name.trim());
        let of_material: Vec<usize> =
            (0..self.parts.len()).filter(|&k| is_meant(&self.parts[k])).collect();
        let meant = if of_material.is_empty() { self.parts_named(&[name])? } else { of_material };
        for part in meant {
            self.parts[part].density = Some(density);
        }
        Ok(self)
    }

    /// Returns the assembly with an order constraint: none of the second parts leaves while one of the first
    /// parts is still in place. Names are patterns of [`parts_named`](Self::parts_named).
    ///
    /// # Errors
    /// [`AssemblyError::UnknownPart`], and [`AssemblyError::CyclicOrder`] if the constraints become cyclic.
    pub fn with_before<S: AsRef<str>>(
        mut self,
        first: &[S],
        second: &[S],
    ) -> Result<Self, AssemblyError> {
        let (first, second) = (self.parts_named(first)?, self.parts_named(second)?);
        let name = |part: usize| self.parts[part].name();
        self.constraints.add_before([&first, &second], name)?;
        Ok(self)
    }

    /// Returns the assembly with parts that leave as one and are not separated afterwards. Names are patterns
    /// of [`parts_named`](Self::parts_named).
    ///
    /// # Errors
    /// [`AssemblyError::UnknownPart`], [`AssemblyError::TooFew`] for fewer than two parts,
    /// [`AssemblyError::OverlappingSubassemblies`], and [`AssemblyError::CyclicOrder`] if the constraints become
    /// cyclic.
    pub fn with_together<S: AsRef<str>>(self, names: &[S]) -> Result<Self, AssemblyError> {
        self.with_unit_of(None, names, false)
    }

    /// Returns the assembly with a subassembly: its parts leave as one, and are then taken apart separately.
    /// Names are patterns of [`parts_named`](Self::parts_named).
    ///
    /// # Errors
    /// Those of [`Self::with_together`], and [`AssemblyError::EmptyName`] for an empty name.
    pub fn with_subassembly<S: AsRef<str>>(
        self,
        name: impl Into<String>,
        parts: &[S],
    ) -> Result<Self, AssemblyError> {
        let name = name.into();
        if name.trim().is_empty() {
            return Err(AssemblyError::EmptyName);
        }
        self.with_unit_of(Some(name), parts, true)
    }

    /// Returns the assembly with a group that leaves as one; `apart` states whether it is taken apart
    /// afterwards.
    fn with_unit_of<S: AsRef<str>>(
        mut self,
        name: Option<String>,
        parts: &[S],
        apart: bool,
    ) -> Result<Self, AssemblyError> {
        let parts = self.parts_named(parts)?;
        if parts.len() < 2 {
            let what = if apart { "a subassembly" } else { "a group that stays together" };
            return Err(AssemblyError::TooFew { what, count: parts.len() });
        }
        let named = |part: usize| self.parts[part].name();
        self.constraints.add_unit(RigidUnit { name, parts, is_subassembly: apart }, named)?;
        Ok(self)
    }

    /// Returns the assembly with directions along which parts must not move: `direction`, of any length, and
    /// all directions within an angle of `within` degrees of it.
    ///
    /// # Errors
    /// [`AssemblyError::UnknownPart`], [`AssemblyError::InvalidDirection`] for a direction without length, and
    /// [`AssemblyError::InvalidAngle`] unless the angle is at least 0 and less than 180 degrees.
    pub fn with_never<S: AsRef<str>>(
        mut self,
        names: &[S],
        direction: DVec3,
        within: f64,
    ) -> Result<Self, AssemblyError> {
        for part in self.parts_named(names)? {
            self.constraints.add_forbidden_direction(part, direction, within)?;
        }
        Ok(self)
    }

    /// Returns the assembly with the name of its unit of length, as stated by the file.
    #[must_use]
    pub fn with_unit(self, unit: impl Into<String>) -> Self {
        Self { unit: Some(unit.into()), ..self }
    }

    /// Returns the assembly with the upward direction of its frame.
    #[must_use]
    pub fn with_up(self, up: DVec3) -> Self {
        Self { up: Some(up), ..self }
    }

    /// Returns the assembly with another note of its reader.
    #[must_use]
    pub fn with_note(mut self, note: impl Into<String>) -> Self {
        self.notes.push(note.into());
        self
    }

    /// Returns the assembly with the list of files that it was read from.
    #[must_use]
    pub fn with_files(self, files: Vec<PathBuf>) -> Self {
        Self { files, ..self }
    }

    /// Returns the parts.
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// Returns the name of the unit of length; `None` if the file states none.
    pub fn unit(&self) -> Option<&str> {
        self.unit.as_deref()
    }

    /// Returns the upward direction; z unless [`Self::with_up`] set another one.
    pub fn up(&self) -> DVec3 {
        self.up.unwrap_or(DVec3::Z)
    }

    /// Returns the notes of the reader, for example about skipped meshes.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Returns the files that the assembly was read from. Programs must not overwrite them.
    pub fn files(&self) -> &[PathBuf] {
        &self.files
    }

    /// Returns which contacts of two parts are ignored; `None` if all of them count.
    pub fn ignored_contacts(&self, a: usize, b: usize) -> Option<Ignored> {
        self.ignored.get(&[a.min(b), a.max(b)]).copied()
    }

    /// Iterates over the pairs with ignored contacts, the smaller index first.
    pub(crate) fn ignored_pairs(&self) -> impl Iterator<Item = [usize; 2]> {
        self.ignored.keys().copied()
    }

    /// Returns the constraints of plans: order, subassemblies and forbidden directions.
    pub const fn constraints(&self) -> &Constraints {
        &self.constraints
    }

    /// Returns the indices of the parts with these names, in increasing order. `bolt*` stands for all parts
    /// whose names begin with `bolt`, unless a part has exactly that name.
    ///
    /// # Errors
    /// [`AssemblyError::UnknownPart`] if a name or pattern matches no part.
    pub fn parts_named<S: AsRef<str>>(&self, names: &[S]) -> Result<Vec<usize>, AssemblyError> {
        let mut group = Vec::new();
        for name in names.iter().map(|name| name.as_ref().trim()) {
            let matching = match name.strip_suffix('*') {
                Some(prefix) if self.parts.iter().all(|part| part.name != name) => {
                    let parts = self.parts.iter().enumerate();
                    parts.filter(|(_, p)| p.name.starts_with(prefix)).map(|(k, _)| k).collect()
                }
                _ => vec![self.part_index(name)?],
            };
            if matching.is_empty() {
                return Err(AssemblyError::UnknownPart { name: name.into(), near: None });
            }
            group.extend(matching);
        }
        group.sort_unstable();
        group.dedup();
        Ok(group)
    }

    /// Returns the role and tolerance given for two parts; `None` if none are given.
    pub fn pair_fit(&self, a: usize, b: usize) -> Option<PairFit> {
        self.pairs.get(&[a.min(b), a.max(b)]).copied()
    }

    /// Iterates over the pairs with a role or tolerance of their own, the smaller index first.
    pub fn pair_fits(&self) -> impl Iterator<Item = ([usize; 2], PairFit)> {
        self.pairs.iter().map(|(pair, fit)| (*pair, *fit))
    }

    /// Returns the index of the part with a name.
    ///
    /// # Errors
    /// [`AssemblyError::UnknownPart`], with the name that has the longest common prefix.
    pub fn part_index(&self, name: &str) -> Result<usize, AssemblyError> {
        let found = self.parts.iter().position(|p| p.name == name);
        found.ok_or_else(|| {
            let shared = |p: &&Part| common_prefix_length(&p.name, name);
            let near = self.parts.iter().max_by_key(shared).filter(|p| shared(p) > 0);
            AssemblyError::UnknownPart { name: name.into(), near: near.map(|p| p.name.clone()) }
        })
    }

    /// Returns the names of parts by index.
    pub fn part_names(&self, parts: &[usize]) -> Vec<&str> {
        parts.iter().map(|&k| self.parts[k].name()).collect()
    }

    /// Returns the box of all parts; without parts, an empty box at the origin.
    pub fn bounds(&self) -> Aabb {
        let all = self.parts.iter().map(Part::bounds).reduce(|a, b| a.union(&b));
        all.unwrap_or(Aabb { low: DVec3::ZERO, high: DVec3::ZERO })
    }

    /// Returns the largest absolute coordinate of a vertex or side of the box of all parts. Rounding errors
    /// are proportional to it.
    pub fn coordinate_size(&self) -> f64 {
        let Aabb { low, high } = self.bounds();
        low.abs().max(high.abs()).max(high - low).max_element()
    }

    /// Returns the largest side of the box of all parts.
    pub(crate) fn largest_side(&self) -> f64 {
        self.bounds().side_lengths().max_element()
    }
}

/// Iterates over the pairs of a part of the first group and another part of the second, the smaller index first.
fn pairs_between([first, second]: &[Vec<usize>; 2]) -> impl Iterator<Item = [usize; 2]> {
    let all = first.iter().flat_map(move |&a| second.iter().map(move |&b| [a.min(b), a.max(b)]));
    all.filter(|[a, b]| a != b)
}

/// Returns the number of leading characters that two names share, ignoring ASCII case.
fn common_prefix_length(a: &str, b: &str) -> usize {
    a.chars().zip(b.chars()).take_while(|(x, y)| x.eq_ignore_ascii_case(y)).count()
}
