//! Convex polyhedra as solids, built on first use and stored with the polyhedron.

use super::round::check_is_not_rounded;
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
    /// A rounded body becomes a rounded solid. Of a sphere or a capsule, the core is one facet without area.
    ///
    /// # Errors
    /// Returns [`SolidError::NoArea`] for a point or a segment without radius.
    pub fn from_convex(body: &ConvexPolyhedron) -> Result<Self, SolidError> {
        if body.radius() == 0.0 {
            check_area(body)?;
        }
        Self::with_any_dimension(body)
    }

    /// Builds a solid from a convex polyhedron. The core of a point or a segment is one facet without area.
    fn with_any_dimension(body: &ConvexPolyhedron) -> Result<Self, SolidError> {
        let core = match body.dimension() {
            0 => Self::from_degenerate_facet(body, [0, 0, 0]),
            1 => Self::from_degenerate_facet(body, [0, 1, 1]),
            _ => {
                let facets: Vec<Vec<u32>> = (0..body.face_count() as u32)
                    .map(|f| body.face_vertices(f).collect())
                    .collect();
                Self::from_mesh(body.vertices(), &facets)?.with_input_numbers(body.input_indices())
            }
        };
        core.rounded(body.radius())
    }
}

impl AsSolid for ConvexPolyhedron {
    fn as_solid(&self) -> Result<&Solid, SolidError> {
        check_is_not_rounded(self.radius())?;
        check_area(self)?;
        self.as_surface()
    }

    fn as_surface(&self) -> Result<&Solid, SolidError> {
        let made = self.kept().get_or_make(|| StoredSolid(Solid::with_any_dimension(self)));
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
