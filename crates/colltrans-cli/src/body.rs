//! From a mesh file to a convex polyhedron.

use std::path::Path;

use colltrans::{BuildError, ConvexPolyhedron};
use colltrans_mesh::Mesh;

use crate::args::BodyArguments;
use crate::failure::{Code, Failure};

/// How deep a face may lie below the hull by default, as a part of the mesh's extent: a hundred
/// times what single precision makes of it, and what six printed digits make of it.
const DEFAULT_TOLERANCE: f64 = 1e-5;

/// The depth that is tolerated for this mesh.
pub(crate) fn tolerance(mesh: &Mesh, asked: Option<f64>) -> f64 {
    asked.unwrap_or_else(|| DEFAULT_TOLERANCE * mesh.extent())
}

/// Reads a mesh file as a body. The message of an error names the file and says what would help.
pub(crate) fn load(path: &Path, options: BodyArguments) -> Result<ConvexPolyhedron, String> {
    let mesh = colltrans_mesh::read(path).map_err(|e| e.to_string())?;
    from_mesh(&mesh, options).map_err(|error| {
        let hint = match error {
            BuildError::NotConvex { .. } => {
                "; --hull takes its convex hull, --convex-tolerance allows more"
            }
            BuildError::Topology(_) | BuildError::InsideOut { .. } => {
                "; --hull takes the convex hull of its vertices"
            }
            _ => "",
        };
        format!("{}: {error}{hint}", path.display())
    })
}

/// [`load`], where a failure ends the command.
pub(crate) fn load_or_fail(
    path: &Path,
    options: BodyArguments,
) -> Result<ConvexPolyhedron, Failure> {
    load(path, options).map_err(|message| Failure::new(Code::Input, message))
}

fn from_mesh(mesh: &Mesh, options: BodyArguments) -> Result<ConvexPolyhedron, BuildError> {
    if options.hull {
        return ConvexPolyhedron::from_points(&mesh.vertices);
    }
    ConvexPolyhedron::from_mesh(
        &mesh.vertices,
        &mesh.faces,
        tolerance(mesh, options.convex_tolerance),
    )
}
