//! Offset bodies: all face planes of a convex body move inwards or outwards by one amount.
//!
//! 1. The planes `n . x <= c` become `n . x <= c - e`, where `e < 0` moves outwards.
//! 2. For a point `o` inside them all and `x = o + L z`, they are the points `L^T n / (c - e - n . o)` of the polar
//!    polytope.
//! 3. The faces of the hull of these points, on planes `m . p = h`, are the corners `z = m / h` of the offset body.
//!
//! `o` and `L` are centroid and inertia ellipsoid of a body near the result, so that the result is nearly round in
//! `z`. Large amounts are approached in steps, each about the centroid of the result of the last step, and always
//! from the given planes. Derivation: `docs/theory/hulls.md`.

use glam::{DMat3, DVec3};

use super::hull::{self, IndexedHull};
use crate::body::error::BuildError;
use crate::body::{ConvexPolyhedron, Inertia};
use colltrans_kernel::plane::polygon_normal;
use colltrans_kernel::range::with_tiny_components_zeroed;

/// Maximum ratio of the farthest corner's distance to the nearest plane's distance, in `z`. A result with a larger
/// ratio is recomputed about its own centroid.
const MAX_ASPECT: f64 = 16.0;
/// Maximum number of such recomputations. One is enough except for needles.
const MAX_RENORMALISATIONS: usize = 4;
/// Maximum number of steps inwards. Each but the last takes at least half of the depth of the centroid.
const MAX_STEPS: usize = 128;

/// Changes to a convex body by an offset of its faces.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct OffsetReport {
    /// Largest distance of a vertex of the result from its source vertex, in the unit of the body.
    pub farthest: f64,
    /// Faces that do not occur in the result, in ascending order.
    pub vanished: Vec<u32>,
}

impl ConvexPolyhedron {
    /// Shrinks the body: returns the points at least `amount` (unit of the body) below every face plane, that is,
    /// the centres of all balls of this radius in the body. Every face plane moves inwards by `amount`. A face that
    /// is too small vanishes, and the planes around it meet.
    ///
    /// Vertices are renumbered. [`Self::input_indices`] contains for each the input number of its source vertex,
    /// which is the farthest one along the sum of the normals of its faces. Planes deviate by less than `2^-40` of
    /// the largest coordinate.
    ///
    /// In contrast, `Solid::shrunk` moves each vertex by the shortest sufficient displacement, and does not split
    /// vertices. In boxes and prisms the result is the same. In other bodies, the shortest displacement may lead a
    /// vertex farther than `amount` below some planes.
    ///
    /// It takes `O(n log n)` time, repeated several times if nearly nothing remains.
    ///
    /// # Errors
    /// - [`BuildError::TooThin`] if the body contains no ball of this radius, or if rounding leaves no volume. This
    ///   includes a flat polygon, a segment and a point.
    /// - [`BuildError::Amount`] if the amount is negative or not finite.
    /// - [`BuildError::Rounded`] for a rounded body.
    ///
    /// An amount of 0 returns any body unchanged.
    ///
    /// ```
    /// use colltrans::{BuildError, ConvexPolyhedron};
    /// use colltrans::glam::DVec3;
    ///
    /// let plate = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::new(4.0, 4.0, 1.0))?;
    /// let (smaller, report) = plate.shrunk(0.25)?;
    /// assert_eq!((smaller.vertices().len(), smaller.face_count()), (8, 6));
    /// assert!((smaller.volume() - 3.5 * 3.5 * 0.5).abs() < 1e-12);
    /// assert!((report.farthest - 0.25 * 3.0_f64.sqrt()).abs() < 1e-12);
    ///
    /// let Err(BuildError::TooThin { fits, .. }) = plate.shrunk(0.75) else {
    ///     unreachable!("it is 1 thick")
    /// };
    /// assert!((fits - 0.5).abs() < 1e-12);
    /// # Ok::<(), BuildError>(())
    /// ```
    pub fn shrunk(&self, amount: f64) -> Result<(Self, OffsetReport), BuildError> {
        self.with_moved_faces(amount, amount)
    }

    /// Grows the body: returns the points at most `amount` outside every face plane. Every face plane moves outwards
    /// by `amount`, and edges and corners stay sharp. The result contains all points within `amount` of the body,
    /// and more beyond sharp corners. This gives a safety margin.
    ///
    /// A flat polygon becomes a plate of thickness `2 amount`, and its sides move outwards by `amount`. Numbering
    /// and rounding are as for [`Self::shrunk`].
    ///
    /// # Errors
    /// - [`BuildError::NothingToMove`] for a segment or a point, which have no faces.
    /// - [`BuildError::Amount`] if the amount is negative or not finite, or if coordinates leave the exact range.
    ///
    /// An amount of 0 returns any body unchanged.
    ///
    /// ```
    /// use colltrans::ConvexPolyhedron;
    /// use colltrans::glam::DVec3;
    ///
    /// let cube = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::ONE)?;
    /// let (larger, _) = cube.grown(0.5)?;
    /// assert!((larger.volume() - 8.0).abs() < 1e-12);
    /// let sheet = ConvexPolyhedron::cuboid(DVec3::ZERO, DVec3::new(1.0, 1.0, 0.0))?;
    /// assert!((sheet.grown(0.5)?.0.volume() - 4.0).abs() < 1e-12);
    /// # Ok::<(), colltrans::BuildError>(())
    /// ```
    pub fn grown(&self, amount: f64) -> Result<(Self, OffsetReport), BuildError> {
        self.with_moved_faces(amount, -amount)
    }

    /// Moves all face planes inwards by `inwards`, which is `amount` or its negative.
    fn with_moved_faces(
        &self,
        amount: f64,
        inwards: f64,
    ) -> Result<(Self, OffsetReport), BuildError> {
        if !(amount.is_finite() && amount >= 0.0) {
            return Err(BuildError::Amount { amount });
        }
        if amount == 0.0 {
            return Ok((self.clone(), OffsetReport::default()));
        }
        if self.radius != 0.0 {
            let operation = if inwards > 0.0 { "shrinking" } else { "growing" };
            return Err(BuildError::Rounded { operation, radius: self.radius });
        }
        if inwards > 0.0 && self.dimension < 3 {
            return Err(BuildError::TooThin { amount, fits: 0.0 });
        }
        if self.dimension < 2 {
            return Err(BuildError::NothingToMove { dimension: self.dimension });
        }
        let planes = face_planes(self);
        let normalisation = Normalisation::for_first_step(&self.inertia, inwards);
        let cell = offset_cell(&planes, normalisation, inwards)?;
        Ok(self.body_of_cell(&planes, cell))
    }

    /// Builds the body of a cell, with input numbers of this body, and the report.
    fn body_of_cell(&self, planes: &[HalfSpace], cell: OffsetCell) -> (Self, OffsetReport) {
        let mut body = Self::from_hull(&cell.corners, cell.hull);
        let mut farthest = 0.0_f64;
        for k in 0..body.vertices.len() {
            let corner = body.input_index[k].0;
            let outwards = cell.polar.topology.face_vertices(corner);
            let normal_of = |p: u32| planes[cell.polar.vertices[p as usize] as usize].normal;
            let source = self.support(outwards.map(normal_of).sum());
            body.input_index[k] = self.input_index[source.index()];
            farthest = farthest.max(body.vertices[k].distance(self.vertices[source.index()]));
        }
        let mut stays = vec![false; planes.len()];
        for &p in &cell.polar.vertices {
            stays[p as usize] = true;
        }
        let faces = 0..self.face_count() as u32;
        let vanished = faces.filter(|&f| !stays[f as usize]).collect();
        (body, OffsetReport { farthest, vanished })
    }
}

/// A half-space: its outward unit normal, and a point in its plane.
struct HalfSpace {
    normal: DVec3,
    point: DVec3,
}

impl HalfSpace {
    /// Returns the signed depth of a point below the plane.
    fn depth_of(&self, point: DVec3) -> f64 {
        self.normal.dot(self.point - point)
    }
}

/// Returns the planes of all faces, each through the farthest vertex along its normal. For a flat polygon, the
/// planes perpendicular to it through its edges follow.
fn face_planes(body: &ConvexPolyhedron) -> Vec<HalfSpace> {
    let at = |v: u32| body.vertices[v as usize];
    let supporting = |normal: DVec3| HalfSpace { normal, point: at(body.support(normal).0) };
    let faces = (0..body.face_count() as u32).map(|face| body.face_normal(face));
    let mut planes: Vec<HalfSpace> = faces.map(supporting).collect();
    if body.dimension == 2 {
        let up = planes[0].normal;
        let edges = body.topology.face_half_edges(0).map(|h| {
            let along = at(body.topology.target(h)) - at(body.topology.origin(h));
            along.cross(up).normalize_or_zero()
        });
        planes.extend(edges.map(supporting));
    }
    planes
}

/// A centre and an ellipsoid that normalise a body near the result.
struct Normalisation {
    center: DVec3,
    factor: DMat3,
}

impl Normalisation {
    fn new(inertia: &Inertia) -> Self {
        Self { center: inertia.center, factor: inertia.factor }
    }

    /// Returns the centre and the ellipsoid of the original body. If the body grows, enlarges the ellipsoid by the
    /// amount.
    fn for_first_step(inertia: &Inertia, inwards: f64) -> Self {
        let grows = DVec3::splat((-inwards).max(0.0));
        Self { factor: inertia.factor + DMat3::from_diagonal(grows), ..Self::new(inertia) }
    }
}

/// The intersection of the moved half-spaces.
struct OffsetCell {
    corners: Vec<DVec3>,
    /// The hull of the corners.
    hull: IndexedHull,
    /// The polar polytope: a vertex for each plane that remains, a face for each corner.
    polar: IndexedHull,
    /// Ratio of the farthest corner's distance to the nearest plane's distance, in `z`.
    aspect: f64,
}

/// Computes the cell of all planes moved inwards by an amount, in steps.
///
/// # Errors
/// Those of [`offset_error`] and [`check_range`].
fn offset_cell(
    planes: &[HalfSpace],
    mut normalisation: Normalisation,
    inwards: f64,
) -> Result<OffsetCell, BuildError> {
    let (mut taken, mut renormalisations, mut fits) = (0.0, 0, 0.0_f64);
    for _ in 0..MAX_STEPS {
        let depth =
            planes.iter().map(|p| p.depth_of(normalisation.center)).fold(f64::INFINITY, f64::min);
        fits = fits.max(depth);
        if inwards > taken + 2.0 * (depth - taken) {
            break;
        }
        let step = inwards.min(0.5 * (taken + depth));
        if step >= depth {
            break;
        }
        let Some(cell) = OffsetCell::new(planes, &normalisation, step) else { break };
        if step == inwards {
            if cell.aspect <= MAX_ASPECT || renormalisations == MAX_RENORMALISATIONS {
                return if cell.hull.dimension == 3 {
                    check_range(cell, inwards)
                } else {
                    Err(offset_error(inwards, fits))
                };
            }
            renormalisations += 1;
        }
        normalisation = Normalisation::new(&cell.hull_inertia());
        taken = step;
    }
    Err(offset_error(inwards, fits))
}

/// Returns the error for a failed offset: the body is too thin to shrink by this amount, or it was grown so far
/// that its polar points coincide numerically.
fn offset_error(inwards: f64, fits: f64) -> BuildError {
    if inwards > 0.0 {
        BuildError::TooThin { amount: inwards, fits }
    } else {
        BuildError::Amount { amount: -inwards }
    }
}

/// Returns the cell, or an error if a corner is outside the exact range.
fn check_range(cell: OffsetCell, inwards: f64) -> Result<OffsetCell, BuildError> {
    let checked = hull::check_points(&cell.corners);
    checked.map_err(|_| BuildError::Amount { amount: inwards.abs() })?;
    Ok(cell)
}

impl OffsetCell {
    /// Computes the cell of all planes moved inwards by `step`. Returns `None` if rounding leaves no volume around
    /// the centre.
    fn new(planes: &[HalfSpace], normalisation: &Normalisation, step: f64) -> Option<Self> {
        let turned = normalisation.factor.transpose();
        let polar_point = |p: &HalfSpace| {
            let depth = p.depth_of(normalisation.center) - step;
            with_tiny_components_zeroed(turned * p.normal / depth)
        };
        let points: Vec<DVec3> = planes.iter().map(polar_point).collect();
        hull::check_points(&points).ok()?;
        let polar = hull::convex_hull(&points);
        if polar.dimension < 3 {
            return None;
        }
        let mut corners = Vec::with_capacity(polar.topology.face_count());
        let mut reach = 0.0_f64;
        for face in 0..polar.topology.face_count() as u32 {
            let at = |v: u32| points[polar.vertices[v as usize] as usize];
            let rim = polar.topology.face_vertices(face).map(at);
            let normal = polygon_normal(rim.clone());
            let height = rim.map(|p| normal.dot(p)).fold(f64::NEG_INFINITY, f64::max);
            if height.is_nan() || height <= 0.0 {
                return None;
            }
            let corner = normal / height;
            reach = reach.max(corner.length());
            corners.push(with_tiny_components_zeroed(
                normalisation.center + normalisation.factor * corner,
            ));
        }
        let nearest = points.iter().map(|p| p.length()).fold(0.0, f64::max);
        let hull = hull::convex_hull(&corners);
        Some(Self { corners, hull, polar, aspect: nearest * reach })
    }

    fn hull_inertia(&self) -> Inertia {
        let corners = &self.corners;
        let vertices: Vec<DVec3> =
            self.hull.vertices.iter().map(|&v| corners[v as usize]).collect();
        Inertia::new(&vertices, &self.hull.topology, self.hull.dimension)
    }
}
