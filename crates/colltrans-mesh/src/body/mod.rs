//! Builds bodies from meshes, for the command line, the page, assemblies and Python.
//!
//! [`convex`] and [`solid`] build a body from a mesh, [`load_convex`] and [`load_solid`] from a file. A body is
//! accompanied by notes on repairs ([`Note`]) and by the precision of its coordinates. [`cast_between`] computes the
//! default tolerance of a query from these precisions. Therefore all front ends return the same results for the
//! same files.

mod drawn;
mod excess;
mod note;
mod orient;
mod repair;
mod shape_name;

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use colltrans::motion::{MotionCast, Moving};
use colltrans::solid::{SolidCast, SolidError, SolidOptions, SolidReport, StartOverlap};
use colltrans::{
    BuildError, Cast, ConvexPolyhedron, InputVertex, Placed, QueryError, Solid, TopologyError,
};
use glam::DVec3;
use thiserror::Error;

pub use drawn::drawn_body;
pub use excess::Excess;
pub use note::{Note, RemovedFaces, report_notes};
pub use shape_name::body_of_name;

use crate::words::count_text;
use crate::{Error, Mesh, ReadOptions, read_with};

/// Default maximum depth of a face below the hull, relative to the extent of the used vertices. For coordinates
/// that do not exceed the extent, it is about 80 times the spacing of numbers in single precision, and at least
/// twice the rounding error of six printed digits.
const CONVEX_TOLERANCE: f64 = 1e-5;
/// Default tolerance between solids, as a multiple of the sum of their precisions. Both sides of a fit may be
/// off by up to one precision, and an inclined facet increases the error.
const TOLERANCE_FACTOR: f64 = 2.0;

/// Options for building a body from a mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct BodyOptions {
    /// The factor of all lengths. The tolerances below are in the unit of the file, before scaling.
    pub scale: f64,
    /// The merge tolerance for reading a file, see [`ReadOptions::merge_tolerance`].
    pub merge_tolerance: Option<f64>,
    /// The maximum depth of a face of a convex body below the hull; `None` is 1e-5 of [`Mesh::extent`].
    pub convex_tolerance: Option<f64>,
    /// For convex bodies: whether the convex [`hull`] is used, regardless of the faces.
    pub hull: bool,
    /// For solids: whether shells may be open. Open shells block from both sides.
    pub open: bool,
    /// For solids: whether a surface that needs repair is rejected.
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
    /// Sets [`scale`](Self::scale).
    #[must_use]
    pub fn with_scale(self, scale: f64) -> Self {
        Self { scale, ..self }
    }

    /// Sets [`merge_tolerance`](Self::merge_tolerance).
    #[must_use]
    pub fn with_merge_tolerance(self, merge_tolerance: Option<f64>) -> Self {
        Self { merge_tolerance, ..self }
    }

    /// Sets [`convex_tolerance`](Self::convex_tolerance).
    #[must_use]
    pub fn with_convex_tolerance(self, convex_tolerance: Option<f64>) -> Self {
        Self { convex_tolerance, ..self }
    }

    /// Sets [`hull`](Self::hull).
    #[must_use]
    pub fn with_hull(self, hull: bool) -> Self {
        Self { hull, ..self }
    }

    /// Sets [`open`](Self::open).
    #[must_use]
    pub fn with_open(self, open: bool) -> Self {
        Self { open, ..self }
    }

    /// Sets [`as_is`](Self::as_is).
    #[must_use]
    pub fn with_as_is(self, as_is: bool) -> Self {
        Self { as_is, ..self }
    }

    /// Returns the maximum depth of a face of this mesh below the hull, in the unit of the file.
    pub fn convex_tolerance_of(&self, mesh: &Mesh) -> f64 {
        self.convex_tolerance.unwrap_or_else(|| CONVEX_TOLERANCE * mesh.extent())
    }

    /// Returns the mesh scaled by [`Self::scale`].
    fn scaled<'m>(&self, mesh: &'m Mesh) -> Cow<'m, Mesh> {
        if self.scale == 1.0 {
            return Cow::Borrowed(mesh);
        }
        let mut scaled = mesh.clone();
        scaled.vertices.iter_mut().for_each(|v| *v *= self.scale);
        Cow::Owned(scaled)
    }
}

/// A body built from a mesh.
#[derive(Debug, Clone)]
pub struct Loaded<B> {
    /// The body.
    pub body: B,
    /// [`Mesh::precision`] in the unit of the body.
    pub precision: f64,
    /// Repairs, and other differences from the file.
    pub notes: Vec<Note>,
}

impl<B> Loaded<B> {
    /// Returns the depth of the mesh's surface below its hull if the mesh is convex only to within the
    /// tolerance. `None` if rounding or the precision of the file explains this depth.
    pub fn dent(&self) -> Option<f64> {
        self.notes.iter().find_map(|note| match note {
            Note::Dented(depth) => Some(*depth),
            _ => None,
        })
    }
}

/// The kind of body into which a mesh can be converted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BodyKind {
    /// A convex body. The faces of the mesh must be convex.
    Convex,
    /// The convex hull of the used vertices ([`BodyOptions::hull`]).
    Hull,
    /// A closed solid.
    Solid,
    /// A solid that may have open shells ([`BodyOptions::open`]).
    Open,
}

/// The reason why a mesh is not a body of the requested kind.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum BodyError {
    /// The mesh is not a convex body.
    #[error(transparent)]
    Convex(#[from] BuildError),
    /// The mesh is not a solid.
    #[error("{}", solid_message(.0))]
    Solid(#[from] SolidError),
    /// The mesh needs repair, which is disabled. The notes describe the repairs.
    #[error("the mesh needs repair, which is disabled: {}", joined_notes(.0))]
    NeedsRepair(Vec<Note>),
    /// The name begins with a shape, and its numbers are not those of the shape.
    #[error("{name:?} describes no shape; accepted: {forms}, or a path that begins with ./")]
    ShapeName {
        /// The name as given.
        name: String,
        /// The accepted forms.
        forms: &'static str,
    },
}

impl BodyError {
    /// Returns the kinds of body that may be possible for the same mesh.
    pub fn alternatives(&self) -> &'static [BodyKind] {
        match self {
            Self::Convex(BuildError::Topology(TopologyError::OpenEdge { .. })) => {
                &[BodyKind::Hull, BodyKind::Open]
            }
            Self::Convex(
                BuildError::NotConvex { .. }
                | BuildError::InsideOut { .. }
                | BuildError::Topology(_),
            ) => &[BodyKind::Solid, BodyKind::Hull],
            Self::Convex(_)
            | Self::NeedsRepair(_)
            | Self::ShapeName { .. }
            | Self::Solid(SolidError::Rounded { .. } | SolidError::Radius { .. }) => &[],
            Self::Solid(SolidError::Open { .. }) => &[BodyKind::Open, BodyKind::Hull],
            Self::Solid(_) => &[BodyKind::Hull],
        }
    }
}

/// Joins notes to one text.
fn joined_notes(notes: &[Note]) -> String {
    notes.iter().map(Note::to_string).collect::<Vec<_>>().join("; ")
}

/// Returns the message of an error about a solid, in terms of the file.
fn solid_message(error: &SolidError) -> String {
    match error {
        SolidError::Open { count, from, to, facet } => format!(
            "the surface is not closed: {} a face on one side only, the first runs from vertex \
             {from} to vertex {to} of face {facet}",
            count_text(*count, "edge has", "edges have")
        ),
        SolidError::Empty => "the mesh has no faces with an area".into(),
        other => other.to_string(),
    }
}

/// The reason why no body was built from a file. Every message names the file.
#[derive(Debug, Error)]
pub enum LoadError {
    /// The file has no valid mesh.
    #[error(transparent)]
    Mesh(#[from] Error),
    /// The mesh is not a body of the requested kind.
    #[error("{}: {source}", path.display())]
    Body {
        /// The file.
        path: PathBuf,
        /// The reason.
        source: BodyError,
    },
}

/// Builds a convex body from a mesh. The surface must be closed and convex, unless [`BodyOptions::hull`] is
/// set.
///
/// # Errors
/// [`BodyError`] with the defect of the surface and its place.
pub fn convex(mesh: &Mesh, options: &BodyOptions) -> Result<Loaded<ConvexPolyhedron>, BodyError> {
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
    let excess = Excess::measure(&mesh, &body);
    if !excess.is_within(tolerance, mesh.extent()) {
        notes.push(Note::Exceeds(excess));
    }
    Ok(Loaded { body, precision, notes })
}

/// Builds the convex hull of the vertices that the faces of a mesh use, or of all vertices if it has no faces.
/// Features of answers refer to vertices by their indices in the mesh.
///
/// # Errors
/// [`BuildError`] if these vertices have no hull.
pub fn hull(mesh: &Mesh) -> Result<ConvexPolyhedron, BuildError> {
    let numbered = |v: usize| (InputVertex(v as u32), mesh.vertices[v]);
    ConvexPolyhedron::from_numbered_points(mesh.indices_in_use().map(numbered))
}

/// Builds a solid from a mesh. Repairs the mesh where that is unambiguous (`docs/reference/files.md`), and
/// reports repairs as notes.
///
/// # Errors
/// [`BodyError`] with the defect of the surface and its place. Open surfaces and repairs are errors unless the
/// options allow them.
pub fn solid(mesh: &Mesh, options: &BodyOptions) -> Result<Loaded<Solid>, BodyError> {
    let precision = mesh.precision * options.scale;
    let mut mesh = options.scaled(mesh);
    let (body, notes) = build_repaired(&mut mesh, options, build_solid, Solid::report)?;
    Ok(Loaded { body, precision, notes })
}

/// Returns the report of the construction of a [`solid`] and the notes on its repair, without building the solid.
///
/// # Errors
/// The errors of [`solid`].
pub fn solid_report(
    mesh: &Mesh,
    options: &BodyOptions,
) -> Result<(SolidReport, Vec<Note>), BodyError> {
    build_repaired(&mut options.scaled(mesh), options, build_report, |report| report)
}

/// The bodies of a mesh.
#[derive(Debug, Clone)]
pub struct SplitBodies {
    /// The bodies, each with its own vertices, in the order of their first faces. Coordinates are
    /// [scaled](BodyOptions::scale).
    pub meshes: Vec<Mesh>,
    /// The repairs that preceded the split.
    pub notes: Vec<Note>,
}

/// Splits a mesh into its bodies: closed shells with their cavities, and open shells. Returns `None` if there is
/// only one. The mesh is scaled and [repaired](solid) first. The notes apply to the whole file; notes on single
/// shells are left out. So are faces without area.
///
/// # Errors
/// The errors of [`solid`] with open shells allowed.
pub fn split_bodies(mesh: &Mesh, options: &BodyOptions) -> Result<Option<SplitBodies>, BodyError> {
    let mut mesh = options.scaled(mesh);
    let (solid, mut notes) =
        build_repaired(&mut mesh, &options.with_open(true), build_solid, Solid::report)?;
    let of_triangle = solid.bodies();
    let count = of_triangle.iter().max().map_or(0, |last| *last as usize + 1);
    if count < 2 {
        return Ok(None);
    }
    let mut of_face = vec![u32::MAX; mesh.faces.len()];
    for (facet, body) in solid.facet_indices().iter().zip(of_triangle) {
        of_face[facet.index()] = body;
    }
    // Notes on single shells are reported for each body later.
    notes.retain(Note::is_of_file);
    Ok(Some(SplitBodies { meshes: mesh.split_faces(&of_face, count), notes }))
}

/// Builds a solid from a mesh without repairs.
fn build_solid(mesh: &Mesh, open: bool) -> Result<Solid, SolidError> {
    let build = if open { Solid::from_open_mesh } else { Solid::from_mesh };
    build(&mesh.vertices, &mesh.faces)
}

/// Returns the report of [`build_solid`].
fn build_report(mesh: &Mesh, open: bool) -> Result<SolidReport, SolidError> {
    let build = if open { SolidReport::from_open_mesh } else { SolidReport::from_mesh };
    build(&mesh.vertices, &mesh.faces)
}

/// Calls `build` with a mesh, with repairs if needed, and whether open shells are allowed. Returns the result with the
/// notes.
fn build_repaired<T>(
    mesh: &mut Cow<Mesh>,
    options: &BodyOptions,
    build: impl Fn(&Mesh, bool) -> Result<T, SolidError>,
    report: impl Fn(&T) -> &SolidReport,
) -> Result<(T, Vec<Note>), BodyError> {
    let mut notes: Vec<Note> = Note::merged(mesh).into_iter().collect();
    let mut built = build(mesh, false);
    if let Err(SolidError::Inconsistent { .. } | SolidError::Open { .. }) = built {
        notes.extend(repair::repair(mesh.to_mut()).notes());
        built = build(mesh, false);
    }
    let mut first = None;
    if let Err(SolidError::Open { from, to, facet, .. }) = built
        && options.open
    {
        first = Some([from, to, facet]);
        built = build(mesh, true);
    }
    let body = built?;
    notes.extend(report_notes(report(&body), first));
    let build_repaired = || notes.iter().filter(|note| note.is_repair());
    if options.as_is && build_repaired().next().is_some() {
        return Err(BodyError::NeedsRepair(build_repaired().cloned().collect()));
    }
    Ok((body, notes))
}

/// Reads a file as a [`convex`] body, or builds the shape that the name describes: `sphere:R`,
/// `capsule:AX,AY,AZ,BX,BY,BZ,R`, `box:X,Y,Z` or `box:X,Y,Z,R`. Of the options, shapes use the scale.
///
/// # Errors
/// The errors of [`read`](crate::read) and [`convex`], and [`BodyError::ShapeName`] for a malformed shape.
pub fn load_convex(
    path: impl AsRef<Path>,
    options: &BodyOptions,
) -> Result<Loaded<ConvexPolyhedron>, LoadError> {
    match shape_of_name(path.as_ref(), options) {
        Some(built) => built,
        None => load(path, options, |mesh, options| convex(&mesh, options)),
    }
}

/// Reads a file as a [`solid`], or builds the shape that the name describes as a solid, see [`load_convex`]. A round
/// shape becomes a rounded solid.
///
/// # Errors
/// The errors of [`read`](crate::read), [`solid`] and [`Solid::from_convex`].
pub fn load_solid(
    path: impl AsRef<Path>,
    options: &BodyOptions,
) -> Result<Loaded<Solid>, LoadError> {
    let path = path.as_ref();
    let Some(built) = shape_of_name(path, options) else {
        return load(path, options, |mesh, options| solid(&mesh, options));
    };
    let Loaded { body, precision, notes } = built?;
    let body = Solid::from_convex(&body)
        .map_err(|error| LoadError::Body { path: path.to_owned(), source: error.into() })?;
    Ok(Loaded { body, precision, notes })
}

/// Builds the body that a name describes. Returns `None` if it names a file.
fn shape_of_name(
    path: &Path,
    options: &BodyOptions,
) -> Option<Result<Loaded<ConvexPolyhedron>, LoadError>> {
    let built = body_of_name(path.to_str()?, options.scale)?;
    Some(match built {
        Ok(body) => Ok(Loaded { body, precision: 0.0, notes: Vec::new() }),
        Err(source) => Err(LoadError::Body { path: path.to_owned(), source }),
    })
}

/// Reads a file and converts its mesh with `take`.
///
/// # Errors
/// The errors of [`read`](crate::read) and of `take`.
pub fn load<T>(
    path: impl AsRef<Path>,
    options: &BodyOptions,
    take: impl FnOnce(Mesh, &BodyOptions) -> Result<T, BodyError>,
) -> Result<T, LoadError> {
    let path = path.as_ref();
    let read = ReadOptions::default().with_merge_tolerance(options.merge_tolerance);
    let mesh = read_with(path, read)?;
    take(mesh, options).map_err(|source| LoadError::Body { path: path.to_owned(), source })
}

/// Builds a cast of solids with given precisions (lengths, see [`Loaded::precision`]).
///
/// Without a tolerance, it is twice the sum of the precisions, but at least the tolerance that rotated poses
/// need.
///
/// # Errors
/// The errors of [`Cast::new`] and of its options.
pub fn cast_between<'a>(
    moving: Placed<'a, Solid>,
    fixed: Placed<'a, Solid>,
    direction: DVec3,
    precisions: [f64; 2],
    tolerance: Option<f64>,
    start_overlap: StartOverlap,
) -> Result<Cast<'a, Solid>, QueryError> {
    let cast = Cast::new(moving, fixed, direction)?;
    let of_files = TOLERANCE_FACTOR * (precisions[0] + precisions[1]);
    let tolerance = tolerance.unwrap_or_else(|| of_files.max(cast.tolerance()));
    cast.with_options(
        SolidOptions::default().with_start_overlap(start_overlap).with_tolerance(tolerance),
    )
}

/// Builds a cast of moving solids with given precisions, with the default tolerance of [`cast_between`].
///
/// # Errors
/// The errors of [`MotionCast::new`] and of its tolerance.
pub fn between_motions<'a>(
    moving: Moving<'a, Solid>,
    fixed: Moving<'a, Solid>,
    precisions: [f64; 2],
    tolerance: Option<f64>,
) -> Result<MotionCast<'a, Solid>, QueryError> {
    let cast = MotionCast::new(moving, fixed)?;
    let of_files = TOLERANCE_FACTOR * (precisions[0] + precisions[1]);
    match tolerance {
        Some(tolerance) => cast.with_tolerance(tolerance),
        None if of_files > cast.tolerance() => cast.with_tolerance(of_files),
        None => Ok(cast),
    }
}
