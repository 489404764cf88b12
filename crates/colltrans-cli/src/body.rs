//! From a mesh file to a convex polyhedron.

use std::fmt::Write as _;
use std::path::Path;

use colltrans::{BuildError, ConvexPolyhedron};
use colltrans_mesh::{Mesh, ReadOptions};

use crate::excess::Excess;
use crate::failure::{Code, Failure};
use crate::numbers::{about, counted};

/// How deep a face may lie below the hull by default, as a part of the mesh's extent: a hundred
/// times what single precision makes of it, and what six printed digits make of it.
const DEFAULT_TOLERANCE: f64 = 1e-5;

/// How a mesh file becomes a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Recipe {
    /// Take the convex hull of all vertices.
    pub(crate) hull: bool,
    /// Lengths are multiplied by this, after the tolerances below, which are in the file's unit.
    pub(crate) scale: f64,
    pub(crate) convex_tolerance: Option<f64>,
    pub(crate) merge_tolerance: Option<f64>,
}

/// A body, and what is to be said about how it came to be.
#[derive(Debug)]
pub(crate) struct Part {
    pub(crate) body: ConvexPolyhedron,
    /// What its hull has more than the mesh, where the hull was asked for and there is a
    /// difference.
    pub(crate) excess: Option<Excess>,
    /// What was merged when it was read.
    pub(crate) note: Option<String>,
}

/// The depth that is tolerated for this mesh.
pub(crate) fn tolerance(mesh: &Mesh, asked: Option<f64>) -> f64 {
    asked.unwrap_or_else(|| DEFAULT_TOLERANCE * mesh.extent())
}

/// Reads a mesh file as a body. The message of an error names the file and says what would help.
pub(crate) fn load(path: &Path, recipe: Recipe) -> Result<Part, String> {
    let options = ReadOptions::default().with_merge_tolerance(recipe.merge_tolerance);
    let mut mesh = colltrans_mesh::read_with(path, options).map_err(|e| e.to_string())?;
    let note = merged(&mesh).map(|what| format!("{}: {what}", path.display()));
    let tolerance = tolerance(&mesh, recipe.convex_tolerance) * recipe.scale;
    if recipe.scale != 1.0 {
        mesh.vertices.iter_mut().for_each(|v| *v *= recipe.scale);
    }
    let build = if recipe.hull {
        ConvexPolyhedron::from_points(&mesh.vertices)
    } else {
        ConvexPolyhedron::from_mesh(&mesh.vertices, &mesh.faces, tolerance)
    };
    let body = build.map_err(|error| format!("{}: {error}{}", path.display(), hint(&error)))?;
    let excess = recipe.hull.then(|| Excess::of(&mesh, &body));
    let excess = excess.filter(|excess| !excess.is_within(tolerance, mesh.extent()));
    Ok(Part { body, excess, note })
}

/// [`load`], where a failure ends the command.
pub(crate) fn load_or_fail(path: &Path, recipe: Recipe) -> Result<Part, Failure> {
    load(path, recipe).map_err(|message| Failure::new(Code::Input, message))
}

fn hint(error: &BuildError) -> &'static str {
    match error {
        BuildError::NotConvex { .. } => {
            "; `colltrans clear` takes parts that are not convex, --hull takes the convex hull, \
             --convex-tolerance allows more"
        }
        BuildError::Topology(colltrans::TopologyError::OpenEdge { .. }) => {
            "; --merge-tolerance closes gaps, --hull takes the convex hull of its vertices"
        }
        BuildError::Topology(_) | BuildError::InsideOut { .. } => {
            "; `colltrans clear` takes parts that are not convex, --hull takes the convex hull of \
             its vertices"
        }
        _ => "",
    }
}

/// What was merged when a mesh was read, if anything was.
pub(crate) fn merged(mesh: &Mesh) -> Option<String> {
    let merged = &mesh.merged;
    if merged.vertices == 0 {
        return None;
    }
    let mut text = format!(
        "{} on open edges merged with another, at most {} away (tolerance {})",
        counted(merged.vertices, "vertex", "vertices"),
        about(merged.largest_distance),
        about(merged.tolerance)
    );
    if merged.dropped_faces > 0 {
        let which = counted(merged.dropped_faces, "face", "faces");
        let _ = write!(text, "; {which} without area dropped");
    }
    if merged.ambiguous > 0 {
        let which = counted(merged.ambiguous, "vertex", "vertices");
        let _ = write!(text, "; {which} had more than one to choose from: the tolerance is large");
    }
    Some(text)
}
