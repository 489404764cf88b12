//! Parts in one world.

use std::collections::{BTreeMap, HashMap};
use std::path::PathBuf;

use colltrans::solid::SolidError;
use colltrans::{Aabb, MAX_MAGNITUDE, Solid};
use colltrans_mesh::body::{self, BodyOptions, Loaded, Refused};
use colltrans_mesh::{Mesh, NumberFormat};
use glam::{DAffine3, DVec3};

use crate::constraints::{Constraints, Unit};
use crate::error::AssemblyError;
use crate::roles::{PairFit, Role};

/// A mesh and its place: a part has one or several, which may overlap each other.
#[derive(Debug, Clone)]
pub struct Piece {
    /// In the piece's own frame; faces run counter-clockwise as seen from outside.
    pub mesh: Mesh,
    /// From the piece's frame to the world; may scale and mirror.
    pub world_from_piece: DAffine3,
}

/// A rigid part, where it stands in the assembly.
#[derive(Debug, Clone)]
pub struct Part {
    name: String,
    solid: Solid,
    facets: usize,
    fixed: bool,
    defects: Vec<String>,
    chord_error: Option<f64>,
    colour: Option<[f64; 3]>,
    last_digits: f64,
    is_coarse: bool,
}

impl Part {
    /// A part of pieces; open shells become surfaces that block from both sides, which is noted.
    ///
    /// # Errors
    /// A surface that is not one of a solid; no pieces; a name without letters.
    pub fn new(name: impl Into<String>, pieces: &[Piece]) -> Result<Self, AssemblyError> {
        Self::with_options(name, pieces, &BodyOptions::default())
    }

    /// The same with options, of which those of solids count; open shells are always allowed.
    ///
    /// # Errors
    /// As [`Self::new`]; a surface that has to be mended, if it is to be taken [as it is](BodyOptions::as_is).
    pub fn with_options(
        name: impl Into<String>,
        pieces: &[Piece],
        options: &BodyOptions,
    ) -> Result<Self, AssemblyError> {
        let name = name.into();
        if name.trim().is_empty() {
            return Err(AssemblyError::NoName);
        }
        let refused = |source| AssemblyError::Part { part: name.clone(), source };
        let mut defects = Vec::new();
        let mut solids = Vec::with_capacity(pieces.len());
        for (k, piece) in pieces.iter().enumerate() {
            let Loaded { body, notes, .. } = solid(piece, options).map_err(refused)?;
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
            last_digits: pieces.iter().map(Piece::last_digits).fold(0.0, f64::max),
            is_coarse: pieces.iter().any(Piece::is_coarse),
        })
    }

    /// The same part, which is never moved if `fixed`.
    #[must_use]
    pub fn with_fixed(self, fixed: bool) -> Self {
        Self { fixed, ..self }
    }

    /// The same part, whose facets are at most so far from the surface that they stand for; `None` if nobody knows.
    #[must_use]
    pub fn with_chord_error(self, chord_error: Option<f64>) -> Self {
        Self { chord_error, ..self }
    }

    /// The same part in a colour, of which red, green and blue are as screens have them, from 0 to 1; `None` if nobody
    /// knows.
    #[must_use]
    pub fn with_colour(self, colour: Option<[f64; 3]>) -> Self {
        Self { colour, ..self }
    }

    /// Its name, unique in an assembly.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The surface, in the world.
    pub const fn solid(&self) -> &Solid {
        &self.solid
    }

    /// Number of facets in the file.
    pub const fn facets(&self) -> usize {
        self.facets
    }

    /// Whether it is never moved.
    pub const fn fixed(&self) -> bool {
        self.fixed
    }

    /// How far its facets are from the surface that they stand for, at most, as its source says; `None` if nobody knows.
    pub const fn chord_error(&self) -> Option<f64> {
        self.chord_error
    }

    /// Returns the tolerance between two parts of its files, for the last digits of the numbers in these.
    pub(crate) const fn last_digits(&self) -> f64 {
        self.last_digits
    }

    /// Checks whether places of its vertices may be off by the last digits of single precision of the assembly's
    /// extent.
    pub(crate) const fn is_coarse(&self) -> bool {
        self.is_coarse
    }

    /// Its colour, if its source has one.
    pub const fn colour(&self) -> Option<[f64; 3]> {
        self.colour
    }

    /// What was mended of its surface, or is wrong with it, in words.
    pub fn defects(&self) -> &[String] {
        &self.defects
    }

    /// Whether it is a surface, at least in part: some shell of it is open.
    pub fn is_surface(&self) -> bool {
        !self.solid.is_closed()
    }

    pub(crate) fn bounds(&self) -> Aabb {
        self.solid.bounds()
    }
}

/// Tolerance between two files of text or doubles, in multiples of [`Mesh::precision`]: as of
/// [`between`](body::between).
const PRECISIONS: f64 = 4.0;
/// Tolerance between two files in single precision, in multiples of [`Mesh::precision`].
const SINGLE_PRECISIONS: f64 = 2.0;

impl Piece {
    /// Returns the tolerance between two such pieces for the last digits of the numbers in their files, in the world.
    fn last_digits(&self) -> f64 {
        let stretch = self.columns().map(DVec3::length).into_iter().fold(0.0, f64::max);
        let precisions = match self.mesh.format {
            NumberFormat::Single => SINGLE_PRECISIONS,
            _ => PRECISIONS,
        };
        precisions * self.mesh.precision * stretch
    }

    /// Checks whether its vertices may be off by more than its file explains: it comes from no file, is in single
    /// precision, or is turned by a pose whose digits are unknown.
    fn is_coarse(&self) -> bool {
        let of_file = self.mesh.precision > 0.0 && self.mesh.format != NumberFormat::Single;
        let is_along_axis =
            |column: DVec3| column.to_array().iter().filter(|x| **x != 0.0).count() == 1;
        !(of_file && self.columns().into_iter().all(is_along_axis))
    }

    fn columns(&self) -> [DVec3; 3] {
        self.world_from_piece.matrix3.to_cols_array_2d().map(DVec3::from_array)
    }
}

/// A piece where it stands.
fn solid(piece: &Piece, options: &BodyOptions) -> Result<Loaded<Solid>, Refused> {
    let mut mesh = piece.mesh.clone();
    for vertex in &mut mesh.vertices {
        *vertex = piece.world_from_piece.transform_point3(*vertex);
    }
    if piece.world_from_piece.matrix3.determinant() < 0.0 {
        mesh.faces.iter_mut().for_each(|face| face.reverse());
    }
    body::solid(&mesh, &options.with_open(true))
}

/// What of two parts is let pass.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Ignored {
    /// The overlap at the start. Contacts that begin later block, as with
    /// [`StartOverlap::Ignore`](colltrans::solid::StartOverlap::Ignore), and so does what would make the overlap
    /// deeper than it is, where there is a tolerance with which there is none.
    Overlap,
    /// Everything: the two are never asked about.
    Always,
}

/// Parts with different names in one world, and pairs that let each other pass.
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
    /// An assembly of these parts, in this order.
    ///
    /// # Errors
    /// Two parts with one name.
    pub fn new(parts: Vec<Part>) -> Result<Self, AssemblyError> {
        let mut seen = HashMap::new();
        for (k, part) in parts.iter().enumerate() {
            if seen.insert(part.name.as_str(), k).is_some() {
                return Err(AssemblyError::SameName { name: part.name.clone() });
            }
        }
        Ok(Self { parts, ..Self::default() })
    }

    /// The same, with pairs (by name) of which so much is let pass. A pair that is named twice keeps
    /// what lets more pass.
    ///
    /// # Errors
    /// A name that no part has; a part paired with itself.
    pub fn with_ignored<S: AsRef<str>>(
        mut self,
        pairs: &[[S; 2]],
        ignored: Ignored,
    ) -> Result<Self, AssemblyError> {
        for [a, b] in pairs {
            let (a, b) = (self.index(a.as_ref())?, self.index(b.as_ref())?);
            if a == b {
                return Err(AssemblyError::SamePart { name: self.parts[a].name.clone() });
            }
            let known = self.ignored.entry([a.min(b), a.max(b)]).or_insert(ignored);
            *known = ignored.max(*known);
        }
        Ok(self)
    }

    /// The same, with what parts are to others where their contact is not like all others, and a tolerance of their own:
    /// of each pair of one of the first and one of the second. What is said later counts. Names are as of
    /// [`group`](Self::group).
    ///
    /// # Errors
    /// A name that no part has; a part paired with itself alone; neither a role nor a tolerance; a tolerance that is none;
    /// a snap without one; what is glued would leave before itself.
    pub fn with_pair<S: AsRef<str>>(
        mut self,
        [first, second]: [&[S]; 2],
        fit: PairFit,
    ) -> Result<Self, AssemblyError> {
        let (first, second) = (self.group(first)?, self.group(second)?);
        if let ([a], [b]) = (&first[..], &second[..])
            && a == b
        {
            return Err(AssemblyError::SamePart { name: self.parts[*a].name.clone() });
        }
        if let Some(value) = fit.tolerance.filter(|x| !(0.0..=MAX_MAGNITUDE).contains(x)) {
            return Err(AssemblyError::Length { what: "tolerance", value });
        }
        let names = || [first[0], second[0]].map(|part| self.parts[part].name.clone());
        if fit == PairFit::default() {
            return Err(AssemblyError::NoFit { names: names() });
        }
        if fit.role == Some(Role::Snap) && fit.tolerance.is_none() {
            return Err(AssemblyError::NoTolerance { names: names() });
        }
        for [a, b] in first.iter().flat_map(|&a| second.iter().map(move |&b| [a, b])) {
            if a == b {
                continue;
            }
            let pair = [a.min(b), a.max(b)];
            self.pairs.insert(pair, fit);
            if fit.role == Some(Role::Glued) {
                let unit = Unit { name: None, parts: pair.to_vec(), apart: false };
                let name = |part: usize| self.parts[part].name();
                self.constraints.add_unit(unit, name)?;
            }
        }
        Ok(self)
    }

    /// The same, with parts that are never moved. Names are as of [`group`](Self::group).
    ///
    /// # Errors
    /// A name that no part has.
    pub fn with_fixed<S: AsRef<str>>(mut self, names: &[S]) -> Result<Self, AssemblyError> {
        for part in self.group(names)? {
            self.parts[part].fixed = true;
        }
        Ok(self)
    }

    /// The same, where parts leave before others: none of the second ones leaves while one of the first ones stays. Names
    /// are as of [`group`](Self::group).
    ///
    /// # Errors
    /// A name that no part has; something would leave before itself.
    pub fn with_before<S: AsRef<str>>(
        mut self,
        first: &[S],
        second: &[S],
    ) -> Result<Self, AssemblyError> {
        let (first, second) = (self.group(first)?, self.group(second)?);
        let name = |part: usize| self.parts[part].name();
        self.constraints.add_before([&first, &second], name)?;
        Ok(self)
    }

    /// The same, where parts stay together: they leave as one, and are not taken apart.
    ///
    /// # Errors
    /// A name that no part has; fewer than two parts; something would leave before itself.
    pub fn with_together<S: AsRef<str>>(self, names: &[S]) -> Result<Self, AssemblyError> {
        self.with_unit_of(None, names, false)
    }

    /// The same with a subassembly: its parts leave as one, and are taken apart by themselves.
    ///
    /// # Errors
    /// As [`Self::with_together`]; it has no name; it shares parts with another one, and neither holds the other.
    pub fn with_subassembly<S: AsRef<str>>(
        self,
        name: impl Into<String>,
        parts: &[S],
    ) -> Result<Self, AssemblyError> {
        let name = name.into();
        if name.trim().is_empty() {
            return Err(AssemblyError::NoName);
        }
        self.with_unit_of(Some(name), parts, true)
    }

    fn with_unit_of<S: AsRef<str>>(
        mut self,
        name: Option<String>,
        parts: &[S],
        apart: bool,
    ) -> Result<Self, AssemblyError> {
        let parts = self.group(parts)?;
        if parts.len() < 2 {
            let what = if apart { "a subassembly" } else { "to stay together" };
            return Err(AssemblyError::TooFew { what, count: parts.len() });
        }
        let named = |part: usize| self.parts[part].name();
        self.constraints.add_unit(Unit { name, parts, apart }, named)?;
        Ok(self)
    }

    /// The same, where parts never go along a direction, of any length, nor along others within an angle in degrees.
    ///
    /// # Errors
    /// A name that no part has; a direction of no length; an angle that is not at least 0 and less than 180.
    pub fn with_never<S: AsRef<str>>(
        mut self,
        names: &[S],
        direction: DVec3,
        within: f64,
    ) -> Result<Self, AssemblyError> {
        for part in self.group(names)? {
            self.constraints.add_never(part, direction, within)?;
        }
        Ok(self)
    }

    /// The same, with the unit of its lengths, as the file says it.
    #[must_use]
    pub fn with_unit(self, unit: impl Into<String>) -> Self {
        Self { unit: Some(unit.into()), ..self }
    }

    /// The same, with what is upwards in its frame, if the format says it.
    #[must_use]
    pub fn with_up(self, up: DVec3) -> Self {
        Self { up: Some(up), ..self }
    }

    /// The same, with something that the reader has to say.
    #[must_use]
    pub fn with_note(mut self, note: impl Into<String>) -> Self {
        self.notes.push(note.into());
        self
    }

    /// The same, with the files that it was read from.
    #[must_use]
    pub fn with_files(self, files: Vec<PathBuf>) -> Self {
        Self { files, ..self }
    }

    /// The parts.
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// The unit of lengths, if the file says it.
    pub fn unit(&self) -> Option<&str> {
        self.unit.as_deref()
    }

    /// What is upwards: y of glTF, else z.
    pub fn up(&self) -> DVec3 {
        self.up.unwrap_or(DVec3::Z)
    }

    /// What the reader noted: meshes skipped, for instance.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// The files that it was read from: whoever writes files must not write over these.
    pub fn files(&self) -> &[PathBuf] {
        &self.files
    }

    /// What of two parts is let pass, if anything.
    pub fn ignored(&self, a: usize, b: usize) -> Option<Ignored> {
        self.ignored.get(&[a.min(b), a.max(b)]).copied()
    }

    /// The pairs of which something is let pass, the smaller position first.
    pub(crate) fn ignored_pairs(&self) -> impl Iterator<Item = [usize; 2]> {
        self.ignored.keys().copied()
    }

    /// What is asked of plans: an order, subassemblies, directions.
    pub const fn constraints(&self) -> &Constraints {
        &self.constraints
    }

    /// The parts with these names, in increasing order; `bolt*` are all whose names begin with `bolt`, if no part has just
    /// that name.
    ///
    /// # Errors
    /// A name that no part has.
    pub fn group<S: AsRef<str>>(&self, names: &[S]) -> Result<Vec<usize>, AssemblyError> {
        let mut group = Vec::new();
        for name in names.iter().map(|name| name.as_ref().trim()) {
            let like = match name.strip_suffix('*') {
                Some(prefix) if self.parts.iter().all(|part| part.name != name) => {
                    let parts = self.parts.iter().enumerate();
                    parts.filter(|(_, p)| p.name.starts_with(prefix)).map(|(k, _)| k).collect()
                }
                _ => vec![self.index(name)?],
            };
            if like.is_empty() {
                return Err(AssemblyError::UnknownPart { name: name.into(), near: None });
            }
            group.extend(like);
        }
        group.sort_unstable();
        group.dedup();
        Ok(group)
    }

    /// What is said of two parts, if anything.
    pub fn pair(&self, a: usize, b: usize) -> Option<PairFit> {
        self.pairs.get(&[a.min(b), a.max(b)]).copied()
    }

    /// All pairs of which something is said, the smaller position first.
    pub fn pairs(&self) -> impl Iterator<Item = ([usize; 2], PairFit)> {
        self.pairs.iter().map(|(pair, fit)| (*pair, *fit))
    }

    /// Position of the part with a name.
    ///
    /// # Errors
    /// There is none; the error names the most similar one.
    pub fn index(&self, name: &str) -> Result<usize, AssemblyError> {
        let found = self.parts.iter().position(|p| p.name == name);
        found.ok_or_else(|| {
            let shared = |p: &&Part| common_prefix(&p.name, name);
            let near = self.parts.iter().max_by_key(shared).filter(|p| shared(p) > 0);
            AssemblyError::UnknownPart { name: name.into(), near: near.map(|p| p.name.clone()) }
        })
    }

    /// Names of parts by position.
    pub fn names(&self, parts: &[usize]) -> Vec<&str> {
        parts.iter().map(|&k| self.parts[k].name()).collect()
    }

    /// The box around all parts; of no extent at the origin without parts.
    pub fn bounds(&self) -> Aabb {
        let all = self.parts.iter().map(Part::bounds).reduce(|a, b| a.join(&b));
        all.unwrap_or(Aabb { low: DVec3::ZERO, high: DVec3::ZERO })
    }

    /// The largest distance of a vertex's coordinate from the world's origin, or between two: what
    /// rounding errors grow with.
    pub fn size(&self) -> f64 {
        let Aabb { low, high } = self.bounds();
        low.abs().max(high.abs()).max(high - low).max_element()
    }

    /// The largest side of the box around all parts.
    pub(crate) fn extent(&self) -> f64 {
        self.bounds().size().max_element()
    }
}

fn common_prefix(a: &str, b: &str) -> usize {
    a.chars().zip(b.chars()).take_while(|(x, y)| x.eq_ignore_ascii_case(y)).count()
}
