//! Reads mesh files as convex bodies. Notes name the file, errors the options that avoid them.

use std::path::Path;

use colltrans::glam::DVec3;
use colltrans::solid::SolidError;
use colltrans::{Aabb, BuildError, ConvexPolyhedron};
use colltrans_mesh::body::{BodyError, BodyKind, BodyOptions, Excess, LoadError, Loaded, Note};

/// A convex body of a mesh file, with the differences between them.
#[derive(Debug)]
pub(crate) struct Part {
    pub(crate) body: ConvexPolyhedron,
    /// By how much the body exceeds the mesh; `None` if no hull was requested, or if it equals the mesh.
    pub(crate) excess: Option<Excess>,
    /// Depth of the mesh's surface below the body; `None` if it is within the precision of the file.
    pub(crate) dent: Option<f64>,
    /// Rounding error of the coordinates in the file, in the unit of the body.
    pub(crate) precision: f64,
    /// Notes about repairs of the mesh.
    pub(crate) notes: Vec<String>,
}

impl Part {
    /// Returns a part of a body without a file.
    pub(crate) const fn from_body(body: ConvexPolyhedron) -> Self {
        Self { body, excess: None, dent: None, precision: 0.0, notes: Vec::new() }
    }

    /// Returns the bounding box of the body.
    pub(crate) fn bounds(&self) -> Aabb {
        convex_bounds(&self.body)
    }
}

/// Returns the bounding box of a convex body.
pub(crate) fn convex_bounds(body: &ConvexPolyhedron) -> Aabb {
    let core = |all: Aabb, &v: &DVec3| all.union(&Aabb { low: v, high: v });
    body.vertices().iter().fold(Aabb::EMPTY, core).expanded(body.radius())
}

/// Reads a mesh file as a convex body.
///
/// # Errors
/// The file cannot be read, or its mesh is not convex and no hull is requested.
pub(crate) fn load(path: &Path, options: &BodyOptions) -> Result<Part, LoadError> {
    let loaded = colltrans_mesh::body::load_convex(path, options)?;
    let dent = loaded.dent();
    let Loaded { body, notes, precision } = loaded;
    let mut excess = None;
    let others = notes.iter().filter(|note| match note {
        // Reported with the answer, because it changes the meaning of the answer.
        Note::Exceeds(found) => {
            excess = Some(*found);
            false
        }
        _ => true,
    });
    let notes = others.map(|note| note_of_file(path, note)).collect();
    Ok(Part { body, excess, dent, precision, notes })
}

/// Returns a note with the name of its file.
pub(crate) fn note_of_file(path: &Path, note: &Note) -> String {
    format!("{}: {note}", path.display())
}

/// Checks whether a mesh that is not convex can be read as a closed part or as an open surface.
pub(crate) fn can_be_part(error: &LoadError) -> bool {
    let LoadError::Body { source, .. } = error else { return false };
    source.alternatives().iter().any(|take| matches!(take, BodyKind::Solid | BodyKind::Open))
}

/// Returns the error of a file with a hint at options that avoid it.
pub(crate) fn load_error_message(error: &LoadError) -> String {
    match error {
        LoadError::Body { source, .. } => format!("{error}{}", option_hint(source)),
        LoadError::Mesh(_) => error.to_string(),
    }
}

/// Returns a hint at the options that avoid an error; empty if there are none.
pub(crate) fn option_hint(refused: &BodyError) -> &'static str {
    match (refused, refused.alternatives()) {
        (BodyError::Convex(BuildError::NotConvex { .. }), _) => {
            "; `colltrans clearance` accepts parts that are not convex, --hull takes the convex hull, \
             --convex-tolerance permits deeper dents"
        }
        (BodyError::Convex(_), [BodyKind::Solid, ..]) => {
            "; `colltrans clearance` accepts parts that are not convex, --hull takes the convex hull of \
             its vertices"
        }
        (BodyError::Convex(_), [_, ..]) => {
            "; --merge-tolerance closes gaps, --hull takes the convex hull of its vertices"
        }
        (BodyError::Solid(SolidError::Empty), _) => {
            "; --hull takes the convex hull of its vertices, with or without faces"
        }
        (BodyError::Solid(_), [BodyKind::Open, ..]) => {
            "; --merge-tolerance closes gaps, `clearance --open` accepts it as a surface without an interior"
        }
        _ => "",
    }
}
