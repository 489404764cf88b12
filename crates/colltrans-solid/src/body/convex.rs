//! A convex polyhedron as a solid, made when it is first asked for and kept.

use super::{AsSolid, Solid, SolidError};
use colltrans_convex::body::{ConvexPolyhedron, Keepable};

/// The solid of a convex polyhedron, kept with it.
#[derive(Debug)]
struct KeptSolid(Result<Solid, SolidError>);

impl Keepable for KeptSolid {
    fn heap_bytes(&self) -> usize {
        size_of::<Self>() + self.0.as_ref().map_or(0, Solid::heap_bytes)
    }
}

impl Solid {
    /// A convex polyhedron, its faces cut into triangles. Vertices keep the numbers of its input, and
    /// faces their numbers. A flat polygon becomes a sheet with two sides and no volume; it overlaps
    /// what it is inside of.
    ///
    /// # Errors
    /// A point or a segment, which has no area.
    pub fn from_convex(body: &ConvexPolyhedron) -> Result<Self, SolidError> {
        check_area(body)?;
        let facets: Vec<Vec<u32>> =
            (0..body.face_count() as u32).map(|f| body.face_vertices(f).collect()).collect();
        Ok(Self::from_mesh(body.vertices(), &facets)?.renumbered(body.input_indices()))
    }
}

impl AsSolid for ConvexPolyhedron {
    fn as_solid(&self) -> Result<&Solid, SolidError> {
        check_area(self)?;
        self.as_surface()
    }

    fn as_surface(&self) -> Result<&Solid, SolidError> {
        let make = || match self.dimension() {
            0 => Ok(Solid::without_area(self, [0, 0, 0])),
            1 => Ok(Solid::without_area(self, [0, 1, 1])),
            _ => Solid::from_convex(self),
        };
        let made = self.kept().get_or_make(|| KeptSolid(make()));
        let KeptSolid(made) = made.expect("nothing else is kept with a convex polyhedron");
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
