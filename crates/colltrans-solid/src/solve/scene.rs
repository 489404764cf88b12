//! Two placed solids and a direction, in frames that all of this folder shares.
//!
//! The *setting frame* has the axes of the world and its origin at the moving body's translation. The
//! *query frame* has the direction as its third axis: `x, y` of a point are its shadow, `h` its
//! height; it is used rounded. Exact signs are taken of the setting frame's coordinates, sums of
//! products of the matrices' entries, vertices and translations as they are.
//!
//! Rounding. A coordinate of the query frame is off by at most [`Scene::noise`], `32 u S`: with `|v|`
//! the reach of a body, `17 u |v|` for two matrices (their entries and their application), `12 u` for
//! the offset, and what the shadow axes lack of being orthogonal to the direction, `4 u` of both. Where
//! the matrices only permute axes and change signs there is no rounding but that of the offset,
//! which is looked at: such coordinates are *exact*.
//!
//! A pose's matrix `R` may be off a rotation by `1e-6`. Then what lies along an axis `n` of the body frame does not lie
//! along `R n` as far: [`Side::skew`] says by how much, and a facet's normal is turned by [`Side::defect`] at most.

use std::cell::OnceCell;

use glam::{DMat3, DVec3};

use crate::body::{Shrinking, Solid, displace};
use colltrans_convex::body::Aabb;
use colltrans_convex::setting::Setting;
use colltrans_kernel::error_free::sum_error;
use colltrans_kernel::fine::Fine;
use colltrans_kernel::integer::Integer;
use colltrans_kernel::noise::Noise;
use colltrans_kernel::pose::rotation_defect;

/// A rounded rotation is off one by less.
const ROTATION: f64 = 16.0 * f64::EPSILON;

/// One of the two bodies.
#[derive(Clone, Copy)]
pub struct Side<'a> {
    pub solid: &'a Solid,
    pub(crate) moving: bool,
    /// How much it is shrunk.
    pub amount: f64,
    /// How much more than itself its nodes are taken for: of the moving body the gap that is to be kept.
    pub(crate) swell: f64,
    pub shrinking: Option<&'a Shrinking>,
    /// From the body frame to the setting frame, without the offset.
    pub(crate) matrix: DMat3,
    /// The offset in the setting frame and what rounding took from it.
    pub(crate) offset: [DVec3; 2],
    /// From the body frame to the query frame, and the offset there.
    pub(crate) view: DMat3,
    pub(crate) view_offset: DVec3,
    /// Whether `matrix` permutes axes and changes signs.
    pub permutes: bool,
    /// How far `matrix^T matrix` is off the identity, in the Frobenius norm; 0 where that is rounding.
    pub defect: f64,
    /// For each axis of the query frame, whether it is an axis of the body.
    pub(crate) aligned: [bool; 3],
    /// The direction in the body frame, at length 1.
    pub(crate) along: DVec3,
    /// As bits, the side of a node's box where it starts along the direction, of the moving body, or ends, of the
    /// fixed one; all of them where that is no side, or not exactly.
    pub(crate) inward: u8,
}

/// A setting of two solids, shrunk and seen along its direction.
pub struct Scene<'a> {
    pub(crate) setting: Setting<'a, Solid>,
    pub moving: Side<'a>,
    pub fixed: Side<'a>,
    /// From the setting frame to the query frame.
    pub(crate) frame: DMat3,
    /// The gap that the bodies are to keep; 0 where that is one that rounding leaves no room in.
    pub(crate) keep: f64,
    /// Bound of the rounding error of a coordinate in the query frame.
    pub noise: f64,
}

impl<'a> Scene<'a> {
    /// The moving and the fixed body shrunk by so much, which are to keep a gap.
    #[inline]
    pub fn new(setting: &Setting<'a, Solid>, [moving, fixed]: [f64; 2], keep: f64) -> Self {
        let frame = frame_along(setting.direction / setting.length);
        let at_origin = [DVec3::ZERO; 2];
        let moving =
            Side::new((setting.moving, moving, true), setting.moving_matrix, at_origin, frame);
        let offset = setting.exact_offset();
        let fixed = Side::new((setting.fixed, fixed, false), setting.fixed_matrix, offset, frame);
        let mut scene = Self { setting: *setting, moving, fixed, frame, keep, noise: 0.0 };
        scene.measure(keep);
        scene
    }

    /// Sets what depends on how large the bodies are, and how near they may come.
    fn measure(&mut self, keep: f64) {
        let Self { setting, moving, fixed, .. } = self;
        let size = moving.reach() + fixed.reach() + setting.offset.length();
        let (noise, keep) = noise_of(size, keep);
        // Along axes that a pose stretches, and rounded.
        let stretch = 1.0 + 2.0 * moving.defect.max(fixed.defect) + 16.0 * f64::EPSILON;
        moving.swell = keep * stretch;
        self.noise = noise;
        self.keep = keep;
    }

    /// Whether a gap is to be kept.
    #[inline]
    pub(crate) fn keeps(&self) -> bool {
        // Without the feature what is reached by this alone is left out of programs.
        cfg!(feature = "keep") && self.keep > 0.0
    }

    /// A corner in the setting frame.
    pub(crate) fn place(&self, corner: &Corner) -> DVec3 {
        let side = self.side(corner.moving);
        side.matrix * corner.local + side.offset[0]
    }

    /// The same with other amounts to shrink by.
    pub(crate) fn shrunk(&self, moving: f64, fixed: f64) -> Self {
        let resized = |side: &Side<'a>, amount| {
            let amount = if side.solid.can_shrink() { amount } else { 0.0 };
            let shrinking = (amount != 0.0).then(|| side.solid.shrinking());
            let inward = inward(side.along, side.aligned, side.moving, amount);
            Side { amount, shrinking, inward, ..*side }
        };
        Self { moving: resized(&self.moving, moving), fixed: resized(&self.fixed, fixed), ..*self }
    }

    /// Whether both bodies have the axes of the query frame.
    pub(crate) fn is_aligned(&self) -> bool {
        self.moving.aligned == [true; 3] && self.fixed.aligned == [true; 3]
    }

    #[inline]
    pub fn side(&self, moving: bool) -> &Side<'a> {
        if moving { &self.moving } else { &self.fixed }
    }

    /// Size `S` of the configuration, with the gap that is to be kept.
    pub(crate) fn size(&self) -> f64 {
        size(self.noise)
    }
}

impl<'a> Side<'a> {
    fn new(
        (solid, amount, moving): (&'a Solid, f64, bool),
        matrix: DMat3,
        offset: [DVec3; 2],
        frame: DMat3,
    ) -> Self {
        let view = frame * matrix;
        let rows = view.transpose();
        let permuting = permutes(matrix);
        // What is of sheets alone stays as it is, and exact.
        let amount = if solid.can_shrink() { amount } else { 0.0 };
        let unit = |row: DVec3| permuting && is_axis(row);
        let aligned = [unit(rows.x_axis), unit(rows.y_axis), unit(rows.z_axis)];
        Self {
            solid,
            moving,
            amount,
            swell: 0.0,
            shrinking: (amount != 0.0).then(|| solid.shrinking()),
            matrix,
            offset,
            view,
            view_offset: frame * offset[0],
            permutes: permuting,
            defect: defect(matrix),
            aligned,
            along: rows.z_axis,
            inward: inward(rows.z_axis, aligned, moving, amount),
        }
    }

    /// By how much a place along an axis of the body frame may be off once both are in the setting frame, since
    /// `R v . R n` is not `v . n`.
    pub(crate) fn skew(&self) -> f64 {
        self.defect * self.reach()
    }

    /// The largest distance of a point of the body from its origin.
    fn reach(&self) -> f64 {
        self.solid.reach() + self.moved()
    }

    /// How far shrinking moves a vertex, at most.
    pub(crate) fn moved(&self) -> f64 {
        self.solid.max_offset_displacement(self.amount)
    }

    /// The box around the body, shrunk, in its frame.
    pub(crate) fn boxed(&self) -> Aabb {
        self.solid.offset_bounds(self.amount)
    }

    pub(crate) fn vertex(&self, v: u32) -> DVec3 {
        let at = self.solid.vertices()[v as usize];
        match self.shrinking {
            None => at,
            Some(shrinking) => displace(at, shrinking.field[v as usize], self.amount),
        }
    }

    #[inline]
    pub fn corner(&self, v: u32) -> Corner {
        let local = self.vertex(v);
        let turned = self.view * local;
        let at = turned + self.view_offset;
        let mut exact = self.aligned == [true; 3];
        if exact && !self.moving {
            // What the addition lost, exactly; an offset that lost bits itself is never exact.
            let lost = |k: usize| {
                sum_error(turned[k], self.view_offset[k], turned[k] + self.view_offset[k]) != 0.0
            };
            exact = self.offset[1] == DVec3::ZERO && !(lost(0) || lost(1) || lost(2));
        }
        Corner { local, at, exact, moving: self.moving }
    }

    pub(crate) fn corners(&self, triangle: usize) -> [Corner; 3] {
        self.solid.triangles()[triangle].map(|v| self.corner(v))
    }
}

/// A vertex of one of the bodies.
#[derive(Debug, Clone, Copy)]
pub struct Corner {
    /// In the body frame, after shrinking.
    pub(crate) local: DVec3,
    /// In the query frame.
    pub at: DVec3,
    /// Whether `at` is exact.
    pub exact: bool,
    pub(crate) moving: bool,
}

/// Something that has a place: a vertex, or a point within a facet.
pub trait ExactPoint {
    /// In the query frame, rounded.
    fn at(&self) -> DVec3;
    /// Whether that is exact.
    fn is_exact(&self) -> bool;
    /// In the setting frame, if that has an exact value in `f64`.
    fn world(&self, scene: &Scene) -> Option<DVec3>;
    /// In the setting frame.
    fn wide<const N: usize>(&self, scene: &Scene) -> [Integer<N>; 3];
    /// The same in twice the usual precision.
    fn fine(&self, scene: &Scene) -> Fine;
}

impl ExactPoint for Corner {
    fn at(&self) -> DVec3 {
        self.at
    }

    fn is_exact(&self) -> bool {
        self.exact
    }

    fn world(&self, scene: &Scene) -> Option<DVec3> {
        let side = scene.side(self.moving);
        if !side.permutes {
            return None;
        }
        let turned = side.matrix * self.local;
        let [offset, lost] = side.offset;
        let exact = (0..3).all(|k| sum_error(turned[k], offset[k], turned[k] + offset[k]) == 0.0);
        (exact && lost == DVec3::ZERO).then(|| turned + offset)
    }

    fn wide<const N: usize>(&self, scene: &Scene) -> [Integer<N>; 3] {
        place_exactly(scene.side(self.moving), &[(1.0, self.local)])
    }

    #[inline]
    fn fine(&self, scene: &Scene) -> Fine {
        let side = scene.side(self.moving);
        Fine::placed(&side.matrix, side.offset, &[(1.0, self.local)])
    }
}

/// A corner of which more than one sign is asked: where it is in twice the usual precision is found once.
pub(crate) struct Remembered<'c> {
    corner: &'c Corner,
    fine: OnceCell<Fine>,
}

impl<'c> Remembered<'c> {
    pub(crate) fn new(corner: &'c Corner) -> Self {
        Self { corner, fine: OnceCell::new() }
    }
}

impl ExactPoint for Remembered<'_> {
    fn at(&self) -> DVec3 {
        self.corner.at
    }

    fn is_exact(&self) -> bool {
        self.corner.exact
    }

    fn world(&self, scene: &Scene) -> Option<DVec3> {
        self.corner.world(scene)
    }

    fn wide<const N: usize>(&self, scene: &Scene) -> [Integer<N>; 3] {
        self.corner.wide(scene)
    }

    fn fine(&self, scene: &Scene) -> Fine {
        *self.fine.get_or_init(|| self.corner.fine(scene))
    }
}

/// A weighted mean of vertices of one body in the setting frame; the weights are powers of two, from
/// `1/64`, and add up to 1.
pub(crate) fn place_exactly<const N: usize>(
    side: &Side,
    terms: &[(f64, DVec3)],
) -> [Integer<N>; 3] {
    let [offset, lost] = side.offset;
    std::array::from_fn(|row| {
        let mut sum = Integer::number(offset[row]).add(&Integer::number(lost[row]));
        for (weight, point) in terms {
            for column in 0..3 {
                let entry = side.matrix.col(column)[row] * weight;
                sum = sum.add(&Integer::product(entry, point[column]));
            }
        }
        sum
    })
}

/// The noise of a configuration of this size whose bodies are to keep a gap, and that gap: 0 where rounding leaves no room in
/// it.
pub(crate) fn noise_of(size: f64, keep: f64) -> (f64, f64) {
    let keep = if Noise::of(size + keep).is_slight(keep) { 0.0 } else { keep };
    (Noise::of(size + keep).point(), keep)
}

/// Size `S` of a configuration with this noise.
pub(crate) fn size(noise: f64) -> f64 {
    noise / (16.0 * f64::EPSILON)
}

/// Rows `x, y, d` of a right-handed frame. Its axes are the world's where that is possible.
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

/// [`Side::inward`] of a body that is shrunk by so much.
fn inward(along: DVec3, aligned: [bool; 3], moving: bool, amount: f64) -> u8 {
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

/// How far a matrix is off a rotation, if by more than the noise of coordinates covers.
fn defect(m: DMat3) -> f64 {
    let defect = rotation_defect(m);
    if defect > ROTATION { 1.01 * defect } else { 0.0 }
}

/// Whether a matrix of a pose permutes axes and changes signs: it is a rotation, to within a little.
pub(crate) fn permutes(m: DMat3) -> bool {
    m.to_cols_array().iter().all(|&entry| entry == 0.0 || entry.abs() == 1.0)
}
