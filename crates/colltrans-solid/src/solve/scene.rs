//! Two placed solids and a direction, in the frames that this folder shares.
//!
//! - *Setting frame*: the axes of the world, with the origin at the moving body's translation.
//! - *Query frame*: the direction is its third axis. The coordinates `x, y` of a point are its shadow, `h` is its
//!   height. Its coordinates are rounded.
//! - Exact signs are computed from setting frame coordinates: sums of products of matrix entries, vertices and
//!   translations, without rounding.
//! - A coordinate of the query frame has an error of at most [`PairFrame::noise`], `32 u S`. Coordinates are *exact* if
//!   all axes of the query frame are axes of the body and of the world, and neither the translation nor its addition is
//!   rounded.
//! - A pose's matrix `R` may deviate from a rotation by `1e-6`. [`PlacedBody::skew_bound`] bounds the effect on
//!   coordinates along an axis `R n`, and [`PlacedBody::defect`] the rotation of a facet's normal. Derivation:
//!   `docs/theory/solid-rounding.md`.

use std::cell::OnceCell;

use glam::{DMat3, DVec3};

use crate::body::{OffsetField, Solid, offset_vertex};
use colltrans_convex::body::Aabb;
use colltrans_convex::setting::Setting;
use colltrans_kernel::error_free::sum_error;
use colltrans_kernel::extended::ExtendedPoint;
use colltrans_kernel::integer::Integer;
use colltrans_kernel::noise::Noise;
use colltrans_kernel::pose::rotation_defect;

/// Upper bound on the deviation of a rounded rotation matrix from a rotation.
const ROTATION_ROUNDING: f64 = 16.0 * f64::EPSILON;

/// One of the two bodies, placed and offset.
#[derive(Clone, Copy)]
pub struct PlacedBody<'a> {
    pub solid: &'a Solid,
    pub(crate) moving: bool,
    /// Distance by which its facets are moved inwards.
    pub amount: f64,
    /// Distance by which the bounds of its nodes are enlarged. For the moving body it is the minimum gap times a factor
    /// slightly above 1, for poses that stretch axes and for rounding. For the fixed body it is 0.
    pub(crate) swell: f64,
    pub shrinking: Option<&'a OffsetField>,
    /// Maps the body frame to the setting frame, without the translation.
    pub(crate) matrix: DMat3,
    /// Translation in the setting frame, and its rounding error.
    pub(crate) offset: [DVec3; 2],
    /// Maps the body frame to the query frame, without the translation [`Self::view_offset`].
    pub(crate) view: DMat3,
    pub(crate) view_offset: DVec3,
    /// Whether `matrix` only permutes axes and changes signs.
    pub permutes: bool,
    /// Bound on the Frobenius norm of `matrix^T matrix - I`; 0 if it is within rounding.
    pub defect: f64,
    /// For each axis of the query frame, whether it is an axis of the body.
    pub(crate) aligned: [bool; 3],
    /// Unit vector of the direction in the body frame.
    pub(crate) along: DVec3,
    /// Bit of a side of a node's box: where the box begins along the direction for the moving body, and where it ends
    /// for the fixed one. All bits are set if no side is exactly perpendicular to the direction, or the body is offset.
    pub(crate) inward: u8,
}

/// Two placed solids, their offsets, and the direction of the query.
pub struct PairFrame<'a> {
    pub(crate) setting: Setting<'a, Solid>,
    pub moving: PlacedBody<'a>,
    pub fixed: PlacedBody<'a>,
    /// Maps the setting frame to the query frame.
    pub(crate) frame: DMat3,
    /// Lower and upper bound of the minimum gap of the cores: that of the bodies plus their radii. Both are 0 if the gap
    /// is too small to be distinguished from rounding errors.
    pub(crate) core_gap: [f64; 2],
    /// Minimum gap of the bodies, or 0 like [`Self::core_gap`].
    pub(crate) body_gap: f64,
    /// Bound on the rounding error of a coordinate in the query frame.
    pub noise: f64,
}

impl<'a> PairFrame<'a> {
    /// Builds the scene of two bodies whose cores are offset by the given amounts, with a minimum gap `min_gap` of the
    /// bodies. Radii of the bodies add to the gap of the cores.
    #[inline]
    pub fn new(setting: &Setting<'a, Solid>, offsets: [f64; 2], min_gap: f64) -> Self {
        Self::with_gaps(setting, offsets, setting.core_gap_bounds(min_gap), min_gap)
    }

    /// Builds the scene of the cores of two bodies, in nominal position and without a minimum gap.
    #[inline]
    pub fn of_cores(setting: &Setting<'a, Solid>) -> Self {
        Self::with_gaps(setting, [0.0; 2], [0.0; 2], 0.0)
    }

    /// Builds the scene of two bodies with these bounds of the gap of their cores.
    #[inline]
    fn with_gaps(
        setting: &Setting<'a, Solid>,
        [moving, fixed]: [f64; 2],
        core_gap: [f64; 2],
        body_gap: f64,
    ) -> Self {
        let frame = frame_along(setting.direction / setting.length);
        let at_origin = [DVec3::ZERO; 2];
        let moving = PlacedBody::new(
            (setting.moving, moving, true),
            setting.moving_matrix,
            at_origin,
            frame,
        );
        let offset = setting.offset_and_error();
        let fixed =
            PlacedBody::new((setting.fixed, fixed, false), setting.fixed_matrix, offset, frame);
        let mut scene =
            Self { setting: *setting, moving, fixed, frame, core_gap, body_gap, noise: 0.0 };
        scene.set_noise_and_gaps();
        scene
    }

    /// Sets the noise, the effective gaps and the enlargement of the moving body, from the sizes of the bodies and the
    /// given gaps.
    fn set_noise_and_gaps(&mut self) {
        let Self { setting, moving, fixed, .. } = self;
        let size = configuration_size(setting, moving, fixed);
        let (noise, core_gap) = noise_and_gap(size, self.core_gap[1]);
        if core_gap == 0.0 {
            (self.core_gap, self.body_gap) = ([0.0; 2], 0.0);
        }
        // A pose may stretch axes by its defect. The last term covers rounding.
        let stretch = 1.0 + 2.0 * moving.defect.max(fixed.defect) + 16.0 * f64::EPSILON;
        moving.swell = core_gap * stretch;
        self.noise = noise;
    }

    /// Returns the minimum gap of the cores, rounded up.
    #[inline]
    pub(crate) fn min_gap(&self) -> f64 {
        self.core_gap[1]
    }

    /// Checks whether the cores are to keep a minimum gap.
    #[inline]
    pub(crate) fn has_min_gap(&self) -> bool {
        // Without the feature the compiler removes code that only a minimum gap reaches.
        cfg!(feature = "min-gap") && self.min_gap() > 0.0
    }

    /// Returns the position of a corner in the setting frame.
    pub(crate) fn corner_position(&self, corner: &PlacedVertex) -> DVec3 {
        let side = self.side(corner.moving);
        side.matrix * corner.local + side.offset[0]
    }

    /// Returns this scene with the bodies offset by other amounts. The minimum gap remains that of this scene, unless
    /// it is too small to be distinguished from the rounding errors of the offset bodies. The noise is that of the
    /// offset bodies, or that of this scene if the latter is larger.
    pub(crate) fn with_offsets(&self, moving: f64, fixed: f64) -> Self {
        let resized = |side: &PlacedBody<'a>, amount| {
            let amount = if side.solid.has_offset() { amount } else { 0.0 };
            let shrinking = (amount != 0.0).then(|| side.solid.offset_field());
            let inward = inward_side(side.along, side.aligned, side.moving, amount);
            PlacedBody { amount, shrinking, inward, ..*side }
        };
        let (moving, fixed) = (resized(&self.moving, moving), resized(&self.fixed, fixed));
        let size = configuration_size(&self.setting, &moving, &fixed);
        let (noise, core_gap) = noise_and_gap(size, self.min_gap());
        let (core_gap, body_gap) =
            if core_gap == 0.0 { ([0.0; 2], 0.0) } else { (self.core_gap, self.body_gap) };
        Self { moving, fixed, noise: noise.max(self.noise), core_gap, body_gap, ..*self }
    }

    /// Checks whether both bodies have the axes of the query frame.
    pub(crate) fn is_aligned(&self) -> bool {
        self.moving.aligned == [true; 3] && self.fixed.aligned == [true; 3]
    }

    #[inline]
    pub fn side(&self, moving: bool) -> &PlacedBody<'a> {
        if moving { &self.moving } else { &self.fixed }
    }

    /// Returns the size `S` of the configuration, including the minimum gap.
    pub(crate) fn size(&self) -> f64 {
        size_from_noise(self.noise)
    }
}

impl<'a> PlacedBody<'a> {
    fn new(
        (solid, amount, moving): (&'a Solid, f64, bool),
        matrix: DMat3,
        offset: [DVec3; 2],
        frame: DMat3,
    ) -> Self {
        let view = frame * matrix;
        let rows = view.transpose();
        let permuting = permutes_axes(matrix);
        // A body of sheets alone is not offset and remains exact.
        let amount = if solid.has_offset() { amount } else { 0.0 };
        let unit = |row: DVec3| permuting && is_axis(row);
        let aligned = [unit(rows.x_axis), unit(rows.y_axis), unit(rows.z_axis)];
        Self {
            solid,
            moving,
            amount,
            swell: 0.0,
            shrinking: (amount != 0.0).then(|| solid.offset_field()),
            matrix,
            offset,
            view,
            view_offset: frame * offset[0],
            permutes: permuting,
            defect: defect_beyond_rounding(matrix),
            aligned,
            along: rows.z_axis,
            inward: inward_side(rows.z_axis, aligned, moving, amount),
        }
    }

    /// Bounds the change of a coordinate along an axis of the body frame when both are mapped to the setting frame,
    /// because `R v . R n` differs from `v . n`.
    pub(crate) fn skew_bound(&self) -> f64 {
        self.defect * self.max_radius()
    }

    /// Returns the maximum distance of a point of the body from the origin of its frame.
    fn max_radius(&self) -> f64 {
        self.solid.reach() + self.max_displacement()
    }

    /// Returns the maximum displacement of a vertex by the offset.
    pub(crate) fn max_displacement(&self) -> f64 {
        self.solid.max_offset_displacement(self.amount)
    }

    /// Returns the bounding box of the offset body in its frame.
    pub(crate) fn offset_bounds(&self) -> Aabb {
        self.solid.offset_bounds(self.amount)
    }

    pub(crate) fn offset_vertex(&self, v: u32) -> DVec3 {
        let at = self.solid.vertices()[v as usize];
        match self.shrinking {
            None => at,
            Some(shrinking) => offset_vertex(at, shrinking.displacements[v as usize], self.amount),
        }
    }

    #[inline]
    pub fn corner(&self, v: u32) -> PlacedVertex {
        let local = self.offset_vertex(v);
        let turned = self.view * local;
        let at = turned + self.view_offset;
        let mut exact = self.aligned == [true; 3];
        if exact && !self.moving {
            // The rounding error of the addition, exactly. A translation that is itself rounded is never exact.
            let lost = |k: usize| {
                sum_error(turned[k], self.view_offset[k], turned[k] + self.view_offset[k]) != 0.0
            };
            exact = self.offset[1] == DVec3::ZERO && !(lost(0) || lost(1) || lost(2));
        }
        PlacedVertex { local, at, exact, moving: self.moving }
    }

    /// Returns the box of a triangle in the query frame.
    pub(crate) fn facet_bounds(&self, triangle: usize) -> Aabb {
        let corners = self.solid.triangles()[triangle];
        Aabb::from_triangle(corners.map(|v| self.view * self.offset_vertex(v) + self.view_offset))
    }

    pub(crate) fn corners(&self, triangle: usize) -> [PlacedVertex; 3] {
        self.solid.triangles()[triangle].map(|v| self.corner(v))
    }
}

/// A vertex of one of the bodies.
#[derive(Debug, Clone, Copy)]
pub struct PlacedVertex {
    /// Position in the body frame, after the offset.
    pub(crate) local: DVec3,
    /// Position in the query frame.
    pub at: DVec3,
    /// Whether `at` is exact.
    pub exact: bool,
    pub(crate) moving: bool,
}

/// A point of a body: a vertex, or a point within a facet.
pub trait ExactPoint {
    /// Returns the rounded position in the query frame.
    fn query_position(&self) -> DVec3;
    /// Checks whether [`Self::query_position`] is exact.
    fn is_exact(&self) -> bool;
    /// Returns the position in the setting frame; `None` if `f64` cannot represent it exactly.
    fn exact_position(&self, scene: &PairFrame) -> Option<DVec3>;
    /// Returns the exact position in the setting frame.
    fn integer_position<const N: usize>(&self, scene: &PairFrame) -> [Integer<N>; 3];
    /// Returns the position in the setting frame in double-double precision.
    fn double_double_position(&self, scene: &PairFrame) -> ExtendedPoint;
}

impl ExactPoint for PlacedVertex {
    fn query_position(&self) -> DVec3 {
        self.at
    }

    fn is_exact(&self) -> bool {
        self.exact
    }

    fn exact_position(&self, scene: &PairFrame) -> Option<DVec3> {
        let side = scene.side(self.moving);
        if !side.permutes {
            return None;
        }
        let turned = side.matrix * self.local;
        let [offset, lost] = side.offset;
        let exact = (0..3).all(|k| sum_error(turned[k], offset[k], turned[k] + offset[k]) == 0.0);
        (exact && lost == DVec3::ZERO).then(|| turned + offset)
    }

    fn integer_position<const N: usize>(&self, scene: &PairFrame) -> [Integer<N>; 3] {
        place_exactly(scene.side(self.moving), &[(1.0, self.local)])
    }

    #[inline]
    fn double_double_position(&self, scene: &PairFrame) -> ExtendedPoint {
        let side = scene.side(self.moving);
        ExtendedPoint::from_products(&side.matrix, side.offset, &[(1.0, self.local)])
    }
}

/// A corner that takes part in several signs: its double-double position is computed once.
pub(crate) struct CachedCorner<'c> {
    corner: &'c PlacedVertex,
    fine: OnceCell<ExtendedPoint>,
}

impl<'c> CachedCorner<'c> {
    pub(crate) fn new(corner: &'c PlacedVertex) -> Self {
        Self { corner, fine: OnceCell::new() }
    }
}

impl ExactPoint for CachedCorner<'_> {
    fn query_position(&self) -> DVec3 {
        self.corner.at
    }

    fn is_exact(&self) -> bool {
        self.corner.exact
    }

    fn exact_position(&self, scene: &PairFrame) -> Option<DVec3> {
        self.corner.exact_position(scene)
    }

    fn integer_position<const N: usize>(&self, scene: &PairFrame) -> [Integer<N>; 3] {
        self.corner.integer_position(scene)
    }

    fn double_double_position(&self, scene: &PairFrame) -> ExtendedPoint {
        *self.fine.get_or_init(|| self.corner.double_double_position(scene))
    }
}

/// Computes a weighted mean of vertices of one body exactly, in the setting frame. The weights are 0 or powers of two,
/// at least `1/64`, and add up to 1.
pub(crate) fn place_exactly<const N: usize>(
    side: &PlacedBody,
    terms: &[(f64, DVec3)],
) -> [Integer<N>; 3] {
    let [offset, lost] = side.offset;
    std::array::from_fn(|row| {
        let mut sum = Integer::exact_number(offset[row]).add(&Integer::exact_number(lost[row]));
        for (weight, point) in terms {
            for column in 0..3 {
                let entry = side.matrix.col(column)[row] * weight;
                sum = sum.add(&Integer::exact_product(entry, point[column]));
            }
        }
        sum
    })
}

/// Returns the size `S` of two offset bodies, without the minimum gap.
fn configuration_size(
    setting: &Setting<Solid>,
    moving: &PlacedBody<'_>,
    fixed: &PlacedBody<'_>,
) -> f64 {
    moving.max_radius() + fixed.max_radius() + setting.offset.length()
}

/// Returns the noise of a configuration of this size, and its minimum gap: 0 if `min_gap` is too small to be
/// distinguished from rounding errors.
pub(crate) fn noise_and_gap(size: f64, min_gap: f64) -> (f64, f64) {
    let min_gap =
        if Noise::for_size(size + min_gap).is_below_noise(min_gap) { 0.0 } else { min_gap };
    (Noise::for_size(size + min_gap).point_error(), min_gap)
}

/// Returns the size `S` of a configuration with this noise.
pub(crate) fn size_from_noise(noise: f64) -> f64 {
    noise / (16.0 * f64::EPSILON)
}

/// Returns rows `x, y, d` of a right-handed frame whose axes are axes of the world where possible.
fn frame_along(unit: DVec3) -> DMat3 {
    let zeros = unit.to_array().map(|c| c == 0.0);
    let x = match zeros {
        [_, false, true] => DVec3::Z,
        [true, ..] => DVec3::X,
        [_, true, _] => DVec3::Y,
        _ => unit.any_orthonormal_vector(),
    };
    DMat3::from_cols(x, unit.cross(x), unit).transpose()
}

/// Returns [`PlacedBody::inward`] of a body that is offset by `amount`.
fn inward_side(along: DVec3, aligned: [bool; 3], moving: bool, amount: f64) -> u8 {
    if !aligned[2] || amount != 0.0 {
        return u8::MAX;
    }
    let axis = along.abs().max_position();
    let upper = (along[axis] < 0.0) == moving;
    1 << (axis + if upper { 3 } else { 0 })
}

fn is_axis(v: DVec3) -> bool {
    let a = v.abs().to_array();
    a.iter().filter(|&&c| c == 1.0).count() == 1 && a.iter().filter(|&&c| c == 0.0).count() == 2
}

/// Returns how far a matrix deviates from a rotation; 0 if the noise of coordinates covers the deviation.
fn defect_beyond_rounding(m: DMat3) -> f64 {
    let defect = rotation_defect(m);
    if defect > ROTATION_ROUNDING { 1.01 * defect } else { 0.0 }
}

/// Checks whether a pose's matrix, a rotation up to small errors, permutes axes and changes signs.
pub(crate) fn permutes_axes(m: DMat3) -> bool {
    m.to_cols_array().iter().all(|&entry| entry == 0.0 || entry.abs() == 1.0)
}

#[cfg(test)]
mod tests {
    use colltrans_convex::body::{ConvexPolyhedron, Pose};
    use colltrans_convex::cast::Cast;

    use super::*;

    /// Offsets increase the size of a configuration. With the noise of the nominal bodies, rounding errors of displaced
    /// vertices would exceed the noise.
    #[test]
    fn noise_of_offset_scene_covers_displacements() {
        // A thin tip on a block: its vertex is displaced by a large multiple of the offset.
        let tip =
            [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0], [0.5, 0.5, 20.0]];
        let tip = ConvexPolyhedron::from_points(&tip.map(DVec3::from_array)).expect("a body");
        let tip = Solid::from_convex(&tip).expect("a solid");
        let turn = glam::DQuat::from_euler(glam::EulerRot::ZYX, 0.3, 0.5, 0.7);
        let pose = Pose::new(turn, DVec3::new(0.1, 0.2, 0.3)).expect("a pose");
        for min_gap in [0.0, 0.25] {
            let cast = Cast::new(tip.at(pose), tip.at(Pose::IDENTITY), DVec3::X).expect("a cast");
            let nominal = PairFrame::new(&cast.setting, [0.0; 2], min_gap);
            for amount in [0.0, 1e-3, 0.1, 0.4, 10.0] {
                let direct = PairFrame::new(&cast.setting, [amount; 2], min_gap);
                let offset = nominal.with_offsets(amount, amount);
                assert!(
                    offset.noise >= direct.noise,
                    "{amount}: {} {}",
                    offset.noise,
                    direct.noise
                );
                assert_eq!(offset.with_offsets(0.0, 0.0).noise, offset.noise);
            }
            assert_eq!(nominal.with_offsets(0.0, 0.0).noise, nominal.noise);
        }
    }
}
