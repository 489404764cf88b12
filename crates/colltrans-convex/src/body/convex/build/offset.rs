//! Bodies whose face planes have all moved by one amount, inwards or outwards.
//!
//! The planes `n.x <= c` become `n.x <= c - e` (`e < 0`: outwards). About a point `o` inside all of them,
//! with `x = o + L z` and `d = c - e - n.o`, they are the points `L^T n / d` of the polar polytope: the
//! faces of their hull, on planes `m.p = h`, are the corners `z = m / h` of what is left. The corners'
//! own hull is the body.
//!
//! `o` and `L` are the centroid and the inertia ellipsoid of a body near the result, so that in `z` it
//! is round and no plane's rounding outweighs another's. Near is first the body itself. The centroid
//! of a convex body lies at least a quarter of its width below each face: with `r` that depth, the
//! planes may move by another `r / 2` and leave `o` well inside, and by more than `2 r` they leave
//! nothing. What is beyond that is gone in steps, each about the centroid of what the one before has
//! left, and always from the planes of the body as given: nothing adds up.

use glam::{DMat3, DVec3};

use super::hull::{self, IndexedHull};
use crate::body::error::BuildError;
use crate::body::{ConvexPolyhedron, Inertia};
use colltrans_kernel::plane::polygon_normal;
use colltrans_kernel::range::without_traces;

/// A result whose farthest corner is so many times farther away than its nearest plane, in `z`, is
/// computed anew, about itself.
const MAX_ASPECT: f64 = 16.0;
/// How often, at most: once is enough but for needles.
const MAX_RENORMALISATIONS: usize = 4;
/// Steps inwards, at most; each takes at least half of the depth of the centroid.
const MAX_STEPS: usize = 128;

/// What became of a convex body whose faces were moved.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct OffsetReport {
    /// The largest distance of a vertex of the result from the one that it comes from, in the units of
    /// the body.
    pub farthest: f64,
    /// Faces of which nothing is left, in increasing order.
    pub vanished: Vec<u32>,
}

impl ConvexPolyhedron {
    /// What lies at least `amount` deep below every face plane, in the units of the body: the centres
    /// of all balls of that radius in the body. Every face plane moves inwards by `amount`; where a
    /// face is too small to stay, the planes around it meet without it.
    ///
    /// Vertices are numbered anew; [`Self::input_indices`] gives for each the input of the one that it
    /// comes from, which is the farthest along its faces' normals. Planes are off by less than `2^-40`
    /// of the largest coordinate. `Solid::shrunk` moves each vertex the shortest
    /// way: to the same places in boxes and prisms, but farther below some of the planes where a way
    /// between two of them is shorter, and one vertex stays one. Takes `O(n log n)`,
    /// some times as often where the amount is nearly all there is.
    ///
    /// # Errors
    /// [`BuildError::TooThin`] for a body that holds no ball of this radius, or nothing that rounding
    /// leaves a volume of: also a flat polygon, a segment, a point. An amount that is negative or not
    /// finite. 0 is the body itself, whatever it is.
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

    /// What lies at most `amount` outside every face plane: every face plane moves outwards by
    /// `amount`, and edges and corners stay as sharp as they are, so all points within `amount` of the
    /// body are in it, and beyond sharp corners more. For a margin to be kept.
    ///
    /// A flat polygon becomes a plate `2 amount` thick, its sides moved outwards by `amount`. Numbers
    /// and rounding are those of [`Self::shrunk`].
    ///
    /// # Errors
    /// [`BuildError::NothingToMove`] for a segment or a point, which have no faces. An amount that is
    /// negative, not finite, or so large that coordinates leave the exact range.
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

    /// The body, with the numbers of this one, and what became of it.
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
    fn depth_of(&self, point: DVec3) -> f64 {
        self.normal.dot(self.point - point)
    }
}

/// The planes of all faces, each through the body's farthest vertex along its normal; of a flat
/// polygon also those that stand on its edges.
fn face_planes(body: &ConvexPolyhedron) -> Vec<HalfSpace> {
    let at = |v: u32| body.vertices[v as usize];
    let supporting = |normal: DVec3| HalfSpace { normal, point: at(body.support(normal).0) };
    let faces = (0..body.face_count() as u32).map(|face| body.face_normal(face));
    let mut planes: Vec<HalfSpace> = faces.map(supporting).collect();
    if body.dimension == 2 {
        let up = planes[0].normal;
        let edges = body.topology.face(0).map(|h| {
            let along = at(body.topology.target(h)) - at(body.topology.origin(h));
            along.cross(up).normalize_or_zero()
        });
        planes.extend(edges.map(supporting));
    }
    planes
}

/// A body near the result: where it is, and an ellipsoid that it resembles.
struct Normalisation {
    center: DVec3,
    factor: DMat3,
}

impl Normalisation {
    fn new(inertia: &Inertia) -> Self {
        Self { center: inertia.center, factor: inertia.factor }
    }

    /// The body itself, and larger by what it grows.
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
    /// The polar polytope: a vertex for each plane that stays, a face for each corner.
    polar: IndexedHull,
    /// How far the farthest corner is, in the distance of the nearest plane.
    aspect: f64,
}

/// The cell of planes moved inwards by an amount, in steps; see the module's head.
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

/// Why there is no body: too thin to shrink so far, or grown beyond all numbers, so that the polar points
/// are one to them.
fn offset_error(inwards: f64, fits: f64) -> BuildError {
    if inwards > 0.0 {
        BuildError::TooThin { amount: inwards, fits }
    } else {
        BuildError::Amount { amount: -inwards }
    }
}

fn check_range(cell: OffsetCell, inwards: f64) -> Result<OffsetCell, BuildError> {
    let checked = hull::check_points(&cell.corners);
    checked.map_err(|_| BuildError::Amount { amount: inwards.abs() })?;
    Ok(cell)
}

impl OffsetCell {
    /// `None` if rounding leaves no volume around the centre.
    fn new(planes: &[HalfSpace], normalisation: &Normalisation, step: f64) -> Option<Self> {
        let turned = normalisation.factor.transpose();
        let polar_point = |p: &HalfSpace| {
            let depth = p.depth_of(normalisation.center) - step;
            without_traces(turned * p.normal / depth)
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
            corners.push(without_traces(normalisation.center + normalisation.factor * corner));
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
