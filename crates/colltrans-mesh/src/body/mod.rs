//! From a mesh to a body: what the command line, the page, assemblies and Python have in common.
//!
//! [`convex`] and [`solid`] make a body of a mesh, [`load_convex`] and [`load_solid`] of a file. A body
//! comes with what was mended for it ([`Note`]) and with the precision of its coordinates, from which
//! [`between`] takes the tolerance of a query where nobody gives one. So every front end answers the
//! same for the same files.

mod excess;
mod heal;
mod note;
mod orient;

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use colltrans::motion::{MotionCast, Moving};
use colltrans::solid::{SolidCast, SolidError, SolidOptions, StartOverlap};
use colltrans::{
    BuildError, Cast, ConvexPolyhedron, InputVertex, Placed, QueryError, Solid, TopologyError,
};
use glam::DVec3;
use thiserror::Error;

pub use excess::Excess;
pub use note::{Left, Note, report_notes};

use crate::words::counted;
use crate::{Error, Mesh, ReadOptions, read_with};

/// How deep a face may lie below the hull by default, as a part of the extent of what faces use: a hundred
/// times what single precision makes of it, and what six printed digits make of it.
const CONVEX_TOLERANCE: f64 = 1e-5;
/// Default tolerance between solids, in multiples of the precisions of both together: both ends of a
/// fit are off by less than one of them, and a slanting facet makes more of it.
const PRECISIONS: f64 = 2.0;

/// How a mesh becomes a body.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct BodyOptions {
    /// Lengths are multiplied by this, after the tolerances below, which are in the file's unit.
    pub scale: f64,
    /// As [`ReadOptions::merge_tolerance`], where a file is read.
    pub merge_tolerance: Option<f64>,
    /// How deep a face of a convex body may lie below the hull; `None` is 1e-5 of [`Mesh::extent`].
    pub convex_tolerance: Option<f64>,
    /// Of a convex body: the convex [`hull`] is taken, whatever the faces are.
    pub hull: bool,
    /// Of a solid: shells may be open, and block from both sides then.
    pub open: bool,
    /// Of a solid: a surface that has to be mended is refused.
    pub as_is: bool,
}

impl Default for BodyOptions {
    fn default() -> Self {
        Self {
            scale: 1.0,
            merge_tolerance: None,
            convex_tolerance: None,
            hull: false,
            open: false,
            as_is: false,
        }
    }
}

impl BodyOptions {
    /// The same with another [`scale`](Self::scale).
    #[must_use]
    pub fn with_scale(self, scale: f64) -> Self {
        Self { scale, ..self }
    }

    /// The same with another [`merge_tolerance`](Self::merge_tolerance).
    #[must_use]
    pub fn with_merge_tolerance(self, merge_tolerance: Option<f64>) -> Self {
        Self { merge_tolerance, ..self }
    }

    /// The same with another [`convex_tolerance`](Self::convex_tolerance).
    #[must_use]
    pub fn with_convex_tolerance(self, convex_tolerance: Option<f64>) -> Self {
        Self { convex_tolerance, ..self }
    }

    /// The same with another [`hull`](Self::hull).
    #[must_use]
    pub fn with_hull(self, hull: bool) -> Self {
        Self { hull, ..self }
    }

    /// The same with another [`open`](Self::open).
    #[must_use]
    pub fn with_open(self, open: bool) -> Self {
        Self { open, ..self }
    }

    /// The same with another [`as_is`](Self::as_is).
    #[must_use]
    pub fn with_as_is(self, as_is: bool) -> Self {
        Self { as_is, ..self }
    }

    /// How deep a face of this mesh may lie below the hull, in the file's unit.
    pub fn convex_tolerance_of(&self, mesh: &Mesh) -> f64 {
        self.convex_tolerance.unwrap_or_else(|| CONVEX_TOLERANCE * mesh.extent())
    }

    fn scaled<'m>(&self, mesh: &'m Mesh) -> Cow<'m, Mesh> {
        if self.scale == 1.0 {
            return Cow::Borrowed(mesh);
        }
        let mut scaled = mesh.clone();
        scaled.vertices.iter_mut().for_each(|v| *v *= self.scale);
        Cow::Owned(scaled)
    }
}

/// A body made of a mesh.
#[derive(Debug, Clone)]
pub struct Loaded<B> {
    /// The body.
    pub body: B,
    /// [`Mesh::precision`], in the unit of the body.
    pub precision: f64,
    /// What was mended, or is not as it is in the file.
    pub notes: Vec<Note>,
}

impl<B> Loaded<B> {
    /// Returns the depth of the mesh's surface below its hull if the mesh is convex only to within the
    /// tolerance; `None` where rounding or the precision of the file explains this depth.
    pub fn dent(&self) -> Option<f64> {
        self.notes.iter().find_map(|note| match note {
            Note::Dented(depth) => Some(*depth),
            _ => None,
        })
    }
}

/// What a mesh can be taken as.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Take {
    /// A convex body, which its faces must be.
    Convex,
    /// The convex hull of the vertices that its faces use ([`BodyOptions::hull`]).
    Hull,
    /// A solid, closed.
    Solid,
    /// A solid, shells of which may be open ([`BodyOptions::open`]).
    Open,
}

/// Why a mesh is no body of the kind asked for.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum Refused {
    /// It is no convex body.
    #[error(transparent)]
    Convex(#[from] BuildError),
    /// It is no solid.
    #[error("{}", of_solid(.0))]
    Solid(#[from] SolidError),
    /// It has to be mended, and is to be taken as it is; what would be done.
    #[error("it would have to be mended, and is to be taken as it is: {}", listed(.0))]
    Mended(Vec<Note>),
}

impl Refused {
    /// What the same mesh could be taken as instead.
    pub fn instead(&self) -> &'static [Take] {
        match self {
            Self::Convex(BuildError::Topology(TopologyError::OpenEdge { .. })) => {
                &[Take::Hull, Take::Open]
            }
            Self::Convex(
                BuildError::NotConvex { .. }
                | BuildError::InsideOut { .. }
                | BuildError::Topology(_),
            ) => &[Take::Solid, Take::Hull],
            Self::Convex(_) | Self::Mended(_) => &[],
            Self::Solid(SolidError::Open { .. }) => &[Take::Open, Take::Hull],
            Self::Solid(_) => &[Take::Hull],
        }
    }
}

fn listed(notes: &[Note]) -> String {
    notes.iter().map(Note::to_string).collect::<Vec<_>>().join("; ")
}

fn of_solid(error: &SolidError) -> String {
    match error {
        SolidError::Open { count, from, to, facet } => format!(
            "the surface is not closed: {} a face on one side only, the first runs from vertex \
             {from} to vertex {to} of face {facet}",
            counted(*count, "edge has", "edges have")
        ),
        SolidError::Empty => "holds no faces with an area".into(),
        other => other.to_string(),
    }
}

/// Why no body was made of a file. Every message names it.
#[derive(Debug, Error)]
pub enum LoadError {
    /// It is no mesh.
    #[error(transparent)]
    Mesh(#[from] Error),
    /// Its mesh is no body of the kind asked for.
    #[error("{}: {source}", path.display())]
    Body {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        source: Refused,
    },
}

/// A convex body of a mesh: its surface must be closed and convex, unless the hull is asked for.
///
/// # Errors
/// What is wrong with the surface, and where.
pub fn convex(mesh: &Mesh, options: &BodyOptions) -> Result<Loaded<ConvexPolyhedron>, Refused> {
    let tolerance = options.convex_tolerance_of(mesh) * options.scale;
    let precision = mesh.precision * options.scale;
    let mut notes: Vec<Note> = Note::merged(mesh).into_iter().collect();
    let mesh = options.scaled(mesh);
    if !options.hull {
        let body = ConvexPolyhedron::from_mesh(&mesh.vertices, &mesh.faces, tolerance)?;
        if body.dent() > precision {
            notes.push(Note::Dented(body.dent()));
        }
        return Ok(Loaded { body, precision, notes });
    }
    let body = hull(&mesh)?;
    notes.extend(Note::stray(&mesh));
    let excess = Excess::of(&mesh, &body);
    if !excess.is_within(tolerance, mesh.extent()) {
        notes.push(Note::Exceeds(excess));
    }
    Ok(Loaded { body, precision, notes })
}

/// Returns the convex hull of the vertices that the faces of a mesh use, of all vertices if it has no faces.
/// Features of answers name vertices by their indices in the mesh.
///
/// # Errors
/// What is wrong with these vertices.
pub fn hull(mesh: &Mesh) -> Result<ConvexPolyhedron, BuildError> {
    let numbered = |v: usize| (InputVertex(v as u32), mesh.vertices[v]);
    ConvexPolyhedron::from_numbered_points(mesh.indices_in_use().map(numbered))
}

/// A solid of a mesh, mended where it is plain how (`docs/reference/files.md`): what was done is in its notes.
///
/// # Errors
/// What is wrong with the surface, and where; that it is open, unless it may be; that it was mended, if it
/// must not be.
pub fn solid(mesh: &Mesh, options: &BodyOptions) -> Result<Loaded<Solid>, Refused> {
    let precision = mesh.precision * options.scale;
    let mut mesh = options.scaled(mesh);
    let (body, notes) = mended(&mut mesh, options)?;
    Ok(Loaded { body, precision, notes })
}

/// A mesh in pieces.
#[derive(Debug, Clone)]
pub struct Apart {
    /// The bodies, each with vertices of its own, in the order of their first faces.
    pub meshes: Vec<Mesh>,
    /// What was mended before.
    pub notes: Vec<Note>,
}

/// The bodies that a mesh consists of: each closed shell with the cavities in it, and each open one. `None` if it is one.
/// It is [mended](solid) first, and what was done is said of all together; faces without an area are left out.
///
/// # Errors
/// As of [`solid`], with open shells allowed.
pub fn bodies(mesh: &Mesh, options: &BodyOptions) -> Result<Option<Apart>, Refused> {
    let mut mesh = options.scaled(mesh);
    let (solid, mut notes) = mended(&mut mesh, &options.with_open(true))?;
    let of_triangle = solid.bodies();
    let count = of_triangle.iter().max().map_or(0, |last| *last as usize + 1);
    if count < 2 {
        return Ok(None);
    }
    let mut of_face = vec![u32::MAX; mesh.faces.len()];
    for (facet, body) in solid.facet_indices().iter().zip(of_triangle) {
        of_face[facet.index()] = body;
    }
    // What is true of shells is said of each.
    notes.retain(Note::is_of_file);
    Ok(Some(Apart { meshes: mesh.picked(&of_face, count), notes }))
}

/// A solid of a mesh that is mended if it has to be, and what is to be said of it.
fn mended(mesh: &mut Cow<Mesh>, options: &BodyOptions) -> Result<(Solid, Vec<Note>), Refused> {
    let mut notes: Vec<Note> = Note::merged(mesh).into_iter().collect();
    let mut built = Solid::from_mesh(&mesh.vertices, &mesh.faces);
    if let Err(SolidError::Inconsistent { .. } | SolidError::Open { .. }) = built {
        notes.extend(heal::heal(mesh.to_mut()).notes());
        built = Solid::from_mesh(&mesh.vertices, &mesh.faces);
    }
    let mut first = None;
    if let Err(SolidError::Open { from, to, facet, .. }) = built
        && options.open
    {
        first = Some([from, to, facet]);
        built = Solid::from_open_mesh(&mesh.vertices, &mesh.faces);
    }
    let body = built?;
    notes.extend(report_notes(body.report(), first));
    let mended = || notes.iter().filter(|note| note.is_mended());
    if options.as_is && mended().next().is_some() {
        return Err(Refused::Mended(mended().cloned().collect()));
    }
    Ok((body, notes))
}

/// Reads a file as a [`convex`] body.
///
/// # Errors
/// As of [`read`](crate::read) and [`convex`].
pub fn load_convex(
    path: impl AsRef<Path>,
    options: &BodyOptions,
) -> Result<Loaded<ConvexPolyhedron>, LoadError> {
    load(path, options, |mesh, options| convex(&mesh, options))
}

/// Reads a file as a [`solid`].
///
/// # Errors
/// As of [`read`](crate::read) and [`solid`].
pub fn load_solid(
    path: impl AsRef<Path>,
    options: &BodyOptions,
) -> Result<Loaded<Solid>, LoadError> {
    load(path, options, |mesh, options| solid(&mesh, options))
}

/// Reads a file and makes something of its mesh.
///
/// # Errors
/// As of [`read`](crate::read), and of what is made.
pub fn load<T>(
    path: impl AsRef<Path>,
    options: &BodyOptions,
    take: impl FnOnce(Mesh, &BodyOptions) -> Result<T, Refused>,
) -> Result<T, LoadError> {
    let path = path.as_ref();
    let read = ReadOptions::default().with_merge_tolerance(options.merge_tolerance);
    let mesh = read_with(path, read)?;
    take(mesh, options).map_err(|source| LoadError::Body { path: path.to_owned(), source })
}

/// A query between solids of these precisions (lengths, see [`Loaded::precision`]).
///
/// Without a tolerance it is what the files ask for, twice their precisions together, and no less than
/// what turned poses need.
///
/// # Errors
/// As of [`Cast::new`] and of its options.
pub fn between<'a>(
    moving: Placed<'a, Solid>,
    fixed: Placed<'a, Solid>,
    direction: DVec3,
    precisions: [f64; 2],
    tolerance: Option<f64>,
    start_overlap: StartOverlap,
) -> Result<Cast<'a, Solid>, QueryError> {
    let cast = Cast::new(moving, fixed, direction)?;
    let of_files = PRECISIONS * (precisions[0] + precisions[1]);
    let tolerance = tolerance.unwrap_or_else(|| of_files.max(cast.tolerance()));
    cast.with_options(
        SolidOptions::default().with_start_overlap(start_overlap).with_tolerance(tolerance),
    )
}

/// The same of solids that turn.
///
/// # Errors
/// As of [`MotionCast::new`] and of its tolerance.
pub fn between_motions<'a>(
    moving: Moving<'a, Solid>,
    fixed: Moving<'a, Solid>,
    precisions: [f64; 2],
    tolerance: Option<f64>,
) -> Result<MotionCast<'a, Solid>, QueryError> {
    let cast = MotionCast::new(moving, fixed)?;
    let of_files = PRECISIONS * (precisions[0] + precisions[1]);
    match tolerance {
        Some(tolerance) => cast.tolerating(tolerance),
        None if of_files > cast.tolerance() => cast.tolerating(of_files),
        None => Ok(cast),
    }
}
