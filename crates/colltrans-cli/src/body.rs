//! From mesh files to bodies, in the words of the command line: notes name the file, and what is refused
//! names the options that would help.

use std::path::Path;

use colltrans::solid::SolidError;
use colltrans::{BuildError, ConvexPolyhedron};
use colltrans_mesh::body::{BodyOptions, Excess, LoadError, Loaded, Note, Refused, Take};

/// A convex body, and what is to be said about how it came to be.
#[derive(Debug)]
pub(crate) struct Part {
    pub(crate) body: ConvexPolyhedron,
    /// What its hull has more than the mesh, where the hull was asked for and there is a
    /// difference.
    pub(crate) excess: Option<Excess>,
    /// How deep the surface of its mesh lies below it, where that is more than its file rounds.
    pub(crate) dent: Option<f64>,
    /// How far its file rounds coordinates, in the unit of the body.
    pub(crate) precision: f64,
    /// What was mended when it was read.
    pub(crate) notes: Vec<String>,
}

impl Part {
    /// A body that is not of a file.
    pub(crate) const fn of(body: ConvexPolyhedron) -> Self {
        Self { body, excess: None, dent: None, precision: 0.0, notes: Vec::new() }
    }
}

/// Reads a mesh file as a convex body.
pub(crate) fn load(path: &Path, options: &BodyOptions) -> Result<Part, LoadError> {
    let loaded = colltrans_mesh::body::load_convex(path, options)?;
    let dent = loaded.dent();
    let Loaded { body, notes, precision } = loaded;
    let mut excess = None;
    let others = notes.iter().filter(|note| match note {
        // Said with the answer, because the answer means something else then.
        Note::Exceeds(found) => {
            excess = Some(*found);
            false
        }
        _ => true,
    });
    let notes = others.map(|note| of_file(path, note)).collect();
    Ok(Part { body, excess, dent, precision, notes })
}

/// A note with the name of its file.
pub(crate) fn of_file(path: &Path, note: &Note) -> String {
    format!("{}: {note}", path.display())
}

/// Whether the mesh could be taken as a part, though it is not convex: closed, or as it is.
pub(crate) fn is_part(error: &LoadError) -> bool {
    let LoadError::Body { source, .. } = error else { return false };
    source.instead().iter().any(|take| matches!(take, Take::Solid | Take::Open))
}

/// Why no body was made of a file, and what would help.
pub(crate) fn refusal(error: &LoadError) -> String {
    match error {
        LoadError::Body { source, .. } => format!("{error}{}", hint(source)),
        LoadError::Mesh(_) => error.to_string(),
    }
}

/// Which options would help.
pub(crate) fn hint(refused: &Refused) -> &'static str {
    match (refused, refused.instead()) {
        (Refused::Convex(BuildError::NotConvex { .. }), _) => {
            "; `colltrans clearance` takes parts that are not convex, --hull takes the convex hull, \
             --convex-tolerance allows more"
        }
        (Refused::Convex(_), [Take::Solid, ..]) => {
            "; `colltrans clearance` takes parts that are not convex, --hull takes the convex hull of \
             its vertices"
        }
        (Refused::Convex(_), [_, ..]) => {
            "; --merge-tolerance closes gaps, --hull takes the convex hull of its vertices"
        }
        (Refused::Solid(SolidError::Empty), _) => {
            "; --hull takes the convex hull of its vertices, also of points without faces"
        }
        (Refused::Solid(_), [Take::Open, ..]) => {
            "; --merge-tolerance closes gaps, `clearance --open` takes it as a surface without an inside"
        }
        _ => "",
    }
}
