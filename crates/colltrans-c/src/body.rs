//! Bodies and poses.

use std::sync::Arc;

use colltrans::glam::{DMat3, DQuat, DVec3};
use colltrans::solid::AsSolid;
use colltrans::{AnyBody, ByKind, ConvexPolyhedron, Placed, Solid};

use crate::error::{
    Failure, Fallible, OfArgument, Output, Status, array, free, guard, optional, points, reference,
    vector,
};

/// A convex body or a solid. It never changes, and any number of threads may use it.
pub struct Body {
    pub(crate) body: AnyBody,
    /// The pieces of a union, for proofs.
    pieces: Vec<AnyBody>,
}

/// A pose: the world coordinates of a point `x` of a body are `rotation x + translation`.
///
/// The twelve numbers are those of a 3 x 4 matrix by columns, for example of `Eigen::AffineCompact3d`. The rotation may
/// differ from one by 1e-6. It is used unchanged, except that numbers below 2^-200 become 0.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// Columns of the rotation matrix: the images of the axes.
    pub rotation: [f64; 9],
    /// Translation, in world units.
    pub translation: [f64; 3],
}

/// Properties of a body.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodyProperties {
    /// 1 for a convex body, 0 for a solid.
    pub is_convex: u32,
    /// 1 if the surface is closed. Convex bodies are closed.
    pub is_closed: u32,
    /// Number of vertices.
    pub vertex_count: usize,
    /// Number of faces of a convex body, of triangles of a solid.
    pub face_count: usize,
    /// Radius of a rounded body, otherwise 0.
    pub radius: f64,
    /// Volume; of a solid without the radius, with overlaps of pieces counted twice.
    pub volume: f64,
}

impl Body {
    fn new(body: impl Into<AnyBody>) -> Self {
        Self { body: body.into(), pieces: Vec::new() }
    }

    fn radius(&self) -> f64 {
        match &self.body {
            ByKind::Convex(body) => body.radius(),
            ByKind::Solid(body) => body.radius(),
        }
    }

    /// Returns the pieces of a union, or the body itself, as solids.
    pub(crate) fn pieces(&self) -> Fallible<Vec<&Solid>> {
        let own = std::slice::from_ref(&self.body);
        let pieces = if self.pieces.is_empty() { own } else { &self.pieces };
        pieces.iter().map(|piece| Ok(surface(piece)?)).collect()
    }
}

/// Returns a body as a solid.
pub(crate) fn surface(body: &AnyBody) -> Result<&Solid, colltrans::solid::SolidError> {
    match body {
        ByKind::Convex(body) => body.as_surface(),
        ByKind::Solid(solid) => Ok(solid),
    }
}

/// The two bodies of a query in their poses. If one of them is a solid, both are treated as solids.
#[derive(Clone, Copy)]
pub(crate) struct Placement<'a> {
    pub(crate) moving: &'a AnyBody,
    pub(crate) moving_pose: colltrans::Pose,
    pub(crate) fixed: &'a AnyBody,
    pub(crate) fixed_pose: colltrans::Pose,
}

impl<'a> Placement<'a> {
    /// Returns both bodies if they are convex.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "a copy through memory costs as much as the call")]
    pub(crate) fn convex(&self) -> Option<[Placed<'a>; 2]> {
        let (ByKind::Convex(p), ByKind::Convex(q)) = (self.moving, self.fixed) else { return None };
        Some([p.at(self.moving_pose), q.at(self.fixed_pose)])
    }

    /// Returns both bodies as solids.
    pub(crate) fn solids(&self) -> Fallible<[Placed<'a, Solid>; 2]> {
        let (moving, fixed) =
            (surface(self.moving).of("moving")?, surface(self.fixed).of("fixed")?);
        Ok([moving.at(self.moving_pose), fixed.at(self.fixed_pose)])
    }
}

impl Pose {
    /// Checks the pose of the argument called `name`.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "a copy through memory costs as much as the call")]
    pub(crate) fn checked(&self, name: &str) -> Fallible<colltrans::Pose> {
        let matrix = DMat3::from_cols_array(&self.rotation);
        colltrans::Pose::from_matrix(matrix, DVec3::from_array(self.translation)).of(name)
    }
}

impl From<colltrans::Pose> for Pose {
    fn from(pose: colltrans::Pose) -> Self {
        Self { rotation: pose.matrix().to_cols_array(), translation: pose.translation().to_array() }
    }
}

/// Reads the pose of the argument called `name`; null is the identity.
#[inline(always)]
#[expect(clippy::inline_always, reason = "a copy through memory costs as much as the call")]
pub(crate) unsafe fn pose(pointer: *const Pose, name: &str) -> Fallible<colltrans::Pose> {
    // SAFETY: the caller keeps the invariants of the crate.
    match unsafe { optional(pointer, name) }? {
        Some(pose) => pose.checked(name),
        None => Ok(colltrans::Pose::IDENTITY),
    }
}

/// Reads the two bodies of a query.
#[inline(always)]
#[expect(clippy::inline_always, reason = "a copy through memory costs as much as the call")]
pub(crate) unsafe fn bodies<'a>(
    moving: *const Body,
    fixed: *const Body,
) -> Fallible<[&'a Body; 2]> {
    // SAFETY: the caller keeps the invariants of the crate.
    unsafe { Ok([reference(moving, "moving")?, reference(fixed, "fixed")?]) }
}

/// Reads the two placed bodies of a query.
#[inline(always)]
#[expect(clippy::inline_always, reason = "a copy through memory costs as much as the call")]
pub(crate) unsafe fn placed<'a>(
    moving: *const Body,
    moving_pose: *const Pose,
    fixed: *const Body,
    fixed_pose: *const Pose,
) -> Fallible<Placement<'a>> {
    // SAFETY: the caller keeps the invariants of the crate.
    unsafe {
        let [moving, fixed] = bodies(moving, fixed)?;
        let moving_pose = pose(moving_pose, "moving_pose")?;
        let fixed_pose = pose(fixed_pose, "fixed_pose")?;
        Ok(Placement { moving: &moving.body, moving_pose, fixed: &fixed.body, fixed_pose })
    }
}

/// The facets of a mesh: triangles, or polygons of given sizes.
enum Facets<'a> {
    Triangles(&'a [[u32; 3]]),
    Polygons(Vec<&'a [u32]>),
}

/// Reads facets. Without sizes they are triangles.
unsafe fn facets<'a>(
    indices: *const u32,
    face_sizes: *const u32,
    face_count: usize,
) -> Fallible<Facets<'a>> {
    // SAFETY: the caller passes as many sizes and indices as the counts state.
    unsafe {
        if face_sizes.is_null() {
            return Ok(Facets::Triangles(array(indices.cast(), face_count, "indices")?));
        }
        let sizes = array(face_sizes, face_count, "face_sizes")?;
        let total = sizes.iter().try_fold(0, |sum: usize, size| sum.checked_add(*size as usize));
        let total =
            total.ok_or_else(|| Failure::invalid("face_sizes", "their sum is too large"))?;
        let mut rest: &[u32] = array(indices, total, "indices")?;
        let mut polygons = Vec::with_capacity(sizes.len());
        for size in sizes {
            let (polygon, others) = rest.split_at(*size as usize);
            polygons.push(polygon);
            rest = others;
        }
        Ok(Facets::Polygons(polygons))
    }
}

/// Builds a pose from a quaternion `x, y, z, w` of length 1 within 1e-6, and a translation.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_pose_from_quaternion(
    xyzw: *const f64,
    translation: *const f64,
    pose: *mut Pose,
) -> Status {
    guard(|| unsafe {
        let pose = Output::new(pose, "pose")?;
        let xyzw: &[f64; 4] = reference(xyzw.cast(), "xyzw")?;
        let translation = vector(translation, "translation")?;
        pose.set(
            colltrans::Pose::new(DQuat::from_array(*xyzw), translation)
                .of("xyzw, translation")?
                .into(),
        );
        Ok(())
    })
}

/// Builds a pose from the 16 numbers of a homogeneous matrix by columns, for example of `Eigen::Isometry3d`. The last
/// row must be `0, 0, 0, 1`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_pose_from_matrix(matrix: *const f64, pose: *mut Pose) -> Status {
    guard(|| unsafe {
        let pose = Output::new(pose, "pose")?;
        let matrix: &[[f64; 4]; 4] = reference(matrix.cast(), "matrix")?;
        let last = matrix.map(|column| column[3]);
        if last != [0.0, 0.0, 0.0, 1.0] {
            let what = format_args!("the last row is {last:?}, accepted is 0, 0, 0, 1");
            return Err(Failure::invalid("matrix", what));
        }
        let column = |k: usize| DVec3::new(matrix[k][0], matrix[k][1], matrix[k][2]);
        let rotation = DMat3::from_cols(column(0), column(1), column(2));
        pose.set(colltrans::Pose::from_matrix(rotation, column(3)).of("matrix")?.into());
        Ok(())
    })
}

/// Builds the convex hull of points, three numbers each.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_convex_from_points(
    points: *const f64,
    point_count: usize,
    body: *mut *mut Body,
) -> Status {
    guard(|| unsafe {
        let body = Output::new(body, "body")?;
        let points = self::points(points, point_count, "points")?;
        body.set_handle(Body::new(ConvexPolyhedron::from_points(&points).of("points")?));
        Ok(())
    })
}

/// Builds the box between two corners, along the axes of its frame. `colltrans_feature` numbers its corners.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_convex_cuboid(
    low: *const f64,
    high: *const f64,
    body: *mut *mut Body,
) -> Status {
    guard(|| unsafe {
        let body = Output::new(body, "body")?;
        let (low, high) = (vector(low, "low")?, vector(high, "high")?);
        body.set_handle(Body::new(ConvexPolyhedron::cuboid(low, high).of("low, high")?));
        Ok(())
    })
}

/// Builds the hull of a closed convex mesh, and checks that the mesh is convex within a tolerance, a length.
///
/// `indices` lists the vertices of all faces, counter-clockwise as seen from outside. `face_sizes` has the number of
/// vertices of each face; null stands for triangles.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_convex_from_mesh(
    vertices: *const f64,
    vertex_count: usize,
    indices: *const u32,
    face_sizes: *const u32,
    face_count: usize,
    convex_tolerance: f64,
    body: *mut *mut Body,
) -> Status {
    guard(|| unsafe {
        let body = Output::new(body, "body")?;
        let vertices = points(vertices, vertex_count, "vertices")?;
        let convex = match facets(indices, face_sizes, face_count)? {
            Facets::Triangles(of) => ConvexPolyhedron::from_mesh(&vertices, of, convex_tolerance),
            Facets::Polygons(of) => ConvexPolyhedron::from_mesh(&vertices, &of, convex_tolerance),
        };
        body.set_handle(Body::new(convex.of("vertices, indices")?));
        Ok(())
    })
}

/// Builds a solid from a mesh, whose facets are given as in `colltrans_convex_from_mesh`. Unless `is_open` is 0, the
/// surface may be open; it then has no interior.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_solid_from_mesh(
    vertices: *const f64,
    vertex_count: usize,
    indices: *const u32,
    face_sizes: *const u32,
    face_count: usize,
    is_open: u32,
    body: *mut *mut Body,
) -> Status {
    guard(|| unsafe {
        let body = Output::new(body, "body")?;
        let vertices = points(vertices, vertex_count, "vertices")?;
        let facets = facets(indices, face_sizes, face_count)?;
        let solid = match (facets, is_open != 0) {
            (Facets::Triangles(of), false) => Solid::from_mesh(&vertices, of),
            (Facets::Triangles(of), true) => Solid::from_open_mesh(&vertices, of),
            (Facets::Polygons(of), false) => Solid::from_mesh(&vertices, &of),
            (Facets::Polygons(of), true) => Solid::from_open_mesh(&vertices, &of),
        };
        body.set_handle(Body::new(solid.of("vertices, indices")?));
        Ok(())
    })
}

/// Builds the union of bodies in one frame. The pieces may overlap, and may be freed afterwards. Rounded pieces are
/// rejected. Vertices of the union are numbered consecutively, including those that no face uses.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_solid_from_pieces(
    pieces: *const *const Body,
    piece_count: usize,
    body: *mut *mut Body,
) -> Status {
    guard(|| unsafe {
        let body = Output::new(body, "body")?;
        let mut all = Vec::new();
        for (k, piece) in array(pieces, piece_count, "pieces")?.iter().enumerate() {
            let piece = reference(*piece, &format!("pieces[{k}]"))?;
            // The pieces of a rounded union lack its radius. The library rejects the union itself.
            let own = piece.pieces.is_empty() || piece.radius() != 0.0;
            all.extend_from_slice(if own {
                std::slice::from_ref(&piece.body)
            } else {
                &piece.pieces
            });
        }
        let solids = all.iter().map(surface).collect::<Result<Vec<_>, _>>().of("pieces")?;
        let solid = Arc::new(Solid::from_pieces(solids).of("pieces")?);
        body.set_handle(Body { body: solid.into(), pieces: all });
        Ok(())
    })
}

/// Builds a rounded body: all points within `radius` of a body. A point becomes a sphere, a segment a capsule.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_body_rounded(
    core: *const Body,
    radius: f64,
    body: *mut *mut Body,
) -> Status {
    guard(|| unsafe {
        let body = Output::new(body, "body")?;
        let core = reference(core, "core")?;
        let rounded: AnyBody = match &core.body {
            ByKind::Convex(of) => of.as_ref().clone().rounded(radius).of("core, radius")?.into(),
            ByKind::Solid(of) => of.as_ref().clone().rounded(radius).of("core, radius")?.into(),
        };
        body.set_handle(Body { body: rounded, pieces: core.pieces.clone() });
        Ok(())
    })
}

/// Builds another handle of the same body, which shares its memory.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_body_clone(body: *const Body, clone: *mut *mut Body) -> Status {
    guard(|| unsafe {
        let clone = Output::new(clone, "clone")?;
        let Body { body, pieces } = reference(body, "body")?;
        clone.set_handle(Body { body: body.clone(), pieces: pieces.clone() });
        Ok(())
    })
}

/// Frees a body; null is accepted.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_body_free(body: *mut Body) {
    unsafe { free(body) }
}

/// Returns the properties of a body.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn colltrans_body_info(
    body: *const Body,
    info: *mut BodyProperties,
) -> Status {
    guard(|| unsafe {
        let info = Output::new(info, "info")?;
        info.set(match &reference(body, "body")?.body {
            ByKind::Convex(body) => BodyProperties {
                is_convex: 1,
                is_closed: 1,
                vertex_count: body.vertices().len(),
                face_count: body.face_count(),
                radius: body.radius(),
                volume: body.volume(),
            },
            ByKind::Solid(body) => BodyProperties {
                is_convex: 0,
                is_closed: u32::from(body.is_closed()),
                vertex_count: body.vertices().len(),
                face_count: body.triangles().len(),
                radius: body.radius(),
                volume: body.volume(),
            },
        });
        Ok(())
    })
}
