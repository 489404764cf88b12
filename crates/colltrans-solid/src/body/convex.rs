//! Convex polyhedra as solids, built on first use and stored with the polyhedron.

use super::{AsSolid, Solid, SolidError};
use colltrans_convex::body::{ConvexPolyhedron, DerivedData};

/// The solid of a convex polyhedron, stored with it.
#[derive(Debug)]
struct StoredSolid(Result<Solid, SolidError>);

impl DerivedData for StoredSolid {
    fn heap_bytes(&self) -> usize {
        size_of::<Self>() + self.0.as_ref().map_or(0, Solid::heap_bytes)
    }
}

impl Solid {
    /// Builds a solid from a convex polyhedron by triangulating its faces. Vertices keep their input indices, and
    /// faces their numbers.
    ///
    /// A flat polygon becomes a surface with two sides and no volume. It overlaps bodies that contain it.
    ///
    /// # Errors
    /// Returns [`SolidError::NoArea`] for a point or a segment, and [`SolidError::Rounded`] for a rounded body.
    pub fn from_convex(body: &ConvexPolyhedron) -> Result<Self, SolidError> {
        check_is_polyhedron(body)?;
        check_area(body)?;
        let facets: Vec<Vec<u32>> =
            (0..body.face_count() as u32).map(|f| body.face_vertices(f).collect()).collect();
        Ok(Self::from_mesh(body.vertices(), &facets)?.with_input_numbers(body.input_indices()))
    }
}

impl AsSolid for ConvexPolyhedron {
    fn as_solid(&self) -> Result<&Solid, SolidError> {
        check_is_polyhedron(self)?;
        check_area(self)?;
        self.as_surface()
    }

    fn as_surface(&self) -> Result<&Solid, SolidError> {
        check_is_polyhedron(self)?;
        let make = || match self.dimension() {
            0 => Ok(Solid::from_degenerate_facet(self, [0, 0, 0])),
            1 => Ok(Solid::from_degenerate_facet(self, [0, 1, 1])),
            _ => Solid::from_convex(self),
        };
        let made = self.kept().get_or_make(|| StoredSolid(make()));
        let StoredSolid(made) = made.expect("no other type is stored with a convex polyhedron");
        made.as_ref().map_err(Clone::clone)
    }
}

fn check_area(body: &ConvexPolyhedron) -> Result<(), SolidError> {
    match body.dimension() {
        0 => Err(SolidError::NoArea { what: "point" }),
        1 => Err(SolidError::NoArea { what: "segment" }),
        _ => Ok(()),
    }
}

/// Returns an error for a rounded body, which is no solid.
fn check_is_polyhedron(body: &ConvexPolyhedron) -> Result<(), SolidError> {
    let radius = body.radius();
    if radius == 0.0 { Ok(()) } else { Err(SolidError::Rounded { radius }) }
}
