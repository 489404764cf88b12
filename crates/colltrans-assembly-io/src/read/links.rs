//! Links of a robot: their shapes, and the bodies built from them.

use colltrans::AnyBody;
use colltrans_assembly::Piece;
use colltrans_mesh::body::{BodyError, BodyOptions, Loaded};
use glam::DAffine3;

use super::contents_error;
use super::files::Source;
use super::shapes::Primitive;
use crate::error::ReadError;

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
