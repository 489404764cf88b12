//! Links of a robot: their shapes, and the bodies built from them.

use colltrans::AnyBody;
use colltrans_assembly::{AssemblyError, Piece};
use colltrans_mesh::body::{BodyError, BodyOptions, Loaded};
use glam::DAffine3;

use super::files::Source;
use super::shapes::Primitive;
use super::{assembly_error, contents_error};
use crate::error::ReadError;
use crate::robot::Link;

/// A shape of a link, with its transformation to the frame of the link or to the world.
pub(super) enum LinkShape {
    /// A mesh.
    Mesh(Piece),
    /// A primitive shape at a pose.
    Primitive(Primitive, DAffine3),
}

impl LinkShape {
    /// Returns the mesh of the shape. Round shapes are replaced by inscribed polyhedra.
    pub(super) fn into_piece(self) -> Piece {
        match self {
            Self::Mesh(piece) => piece,
            Self::Primitive(shape, at) => shape.piece(at),
        }
    }

    /// Builds a body in the frame of the link: an exact rounded body for a sphere or capsule, a convex body if the mesh is
    /// convex, otherwise a solid.
    pub(super) fn body(&self, options: &BodyOptions) -> Result<Loaded<AnyBody>, BodyError> {
        match self {
            Self::Mesh(piece) => body_of_piece(piece, options),
            Self::Primitive(primitive, at) => match primitive.rounded_body(*at) {
                Some(built) => {
                    Ok(Loaded { body: built?.into(), precision: 0.0, notes: Vec::new() })
                }
                None => body_of_piece(&primitive.enclosing_piece(*at), options),
            },
        }
    }
}

/// Builds a body from a piece, in the frame of its link: convex if the piece is, otherwise a solid.
fn body_of_piece(piece: &Piece, options: &BodyOptions) -> Result<Loaded<AnyBody>, BodyError> {
    let mut mesh = piece.mesh.clone();
    for vertex in &mut mesh.vertices {
        *vertex = piece.world_from_piece.transform_point3(*vertex);
    }
    if piece.world_from_piece.matrix3.determinant() < 0.0 {
        mesh.faces.iter_mut().for_each(|face| face.reverse());
    }
    crate::robot::body_from_mesh(&mesh, options)
}

/// Checks that the links of [`hulls`](super::ReadOptions::hulls) exist.
pub(super) fn check_hull_names(source: &Source, names: &[&str]) -> Result<(), ReadError> {
    let mut hulls = source.options.hulls.iter().filter(|name| *name != "*");
    let Some(name) = hulls.find(|name| !names.contains(&name.as_str())) else { return Ok(()) };
    let reason = format!("cannot use the hull of unknown link {name}; links: {}", names.join(", "));
    Err(contents_error(source.path, "links", reason))
}

/// Builds a link of these shapes, in the frame that carries it. Adds notes on its bodies.
pub(super) fn build_link(
    source: &Source,
    name: &str,
    frame: Option<usize>,
    shapes: &[LinkShape],
    notes: &mut Vec<String>,
) -> Result<Link, ReadError> {
    let mut bodies = Vec::new();
    let (takes_hull, mut is_hull) = (source.options.takes_hull(name), false);
    let mut dent: Option<f64> = None;
    for shape in shapes {
        let options = source.options.body_options().with_hull(takes_hull);
        let loaded = shape.body(&options).map_err(|refused| {
            assembly_error(source.path)(AssemblyError::Part { part: name.into(), source: refused })
        })?;
        // If the hull equals the mesh, there is no note.
        is_hull |= takes_hull && !loaded.notes.is_empty();
        dent = dent.into_iter().chain(loaded.dent()).reduce(f64::max);
        let whose = if takes_hull { " as its convex hull" } else { "" };
        notes.extend(loaded.notes.iter().map(|said| format!("link {name}{whose}: {said}")));
        if let LinkShape::Primitive(primitive, _) = shape {
            notes.extend(primitive.replacement_note().map(|said| format!("link {name}: {said}")));
        }
        bodies.push(loaded.body);
    }
    Ok(Link { name: name.into(), frame, bodies, is_hull, dent })
}

/// Checks that a robot has a body, and no missing meshes unless they are skipped, which adds notes.
pub(super) fn check_links(
    source: &Source,
    links: &[Link],
    missing: Vec<String>,
    notes: &mut Vec<String>,
) -> Result<(), ReadError> {
    if !missing.is_empty() && !source.options.skip_missing {
        return Err(ReadError::MissingMeshes { path: source.path.into(), missing });
    }
    notes.extend(missing.iter().map(|file| format!("{file} not found; left out")));
    if links.iter().all(|link| link.bodies.is_empty()) {
        let holds = format!("none of its {} links has collision geometry", links.len());
        return Err(ReadError::NoParts { path: source.path.into(), holds });
    }
    Ok(())
}
