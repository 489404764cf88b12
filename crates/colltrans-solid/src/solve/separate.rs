//! Separating plane of two solids, parallel to the direction.
//!
//! - The shadows of the convex hulls are disjoint if and only if the origin lies outside `D = hull(shadow Q) -
//!   hull(shadow P)`.
//! - GJK in the plane (Gilbert, Johnson and Keerthi, IEEE J. Robotics and Automation 4(2), 1988) approaches the point
//!   of `D` nearest to the origin. It keeps a simplex of points of `D`, the point `v` of it nearest to the origin, and
//!   the lowest point of `D` along `v`.
//! - It ends when that point is above the origin by more than rounding errors. Then `v` is a separating normal, which
//!   can be verified without the search. Lowest points come from the bodies' trees.
//! - Boxes separate most bodies that pass each other. They are tried first, with the normals orthogonal to the
//!   direction and to one of six axes. A box contains its body, so the vertices prove such a margin as well.

use glam::{DMat3, DVec2, DVec3, Vec3Swizzles};

use super::projected::Projected;
use super::scene::{PairFrame, PlacedBody, size_from_noise};
use crate::body::Solid;
use colltrans_convex::answer::{CertificateError, Separation};
use colltrans_convex::body::Aabb;
use colltrans_convex::setting::Setting;
use colltrans_kernel::noise::UNIT_VECTOR;

/// Maximum number of rounds. Each round ends the search or comes closer; only rounding errors could prolong it.
const MAX_ROUNDS: usize = 32;
/// Rounding error of a gap, in noises. It covers ties ([`TIES`]) and the computation of the two farthest points.
pub(crate) const ROUNDING: f64 = 4.0;
/// Part of [`ROUNDING`], in noises, that covers ties among farthest points.
const TIES: f64 = 0.5;
/// Rounding error, in noises, of the difference of two heights along any normal. Derivation:
/// `docs/theory/solid-rounding.md`.
pub(crate) const HEIGHTS: f64 = 1.5;
/// Rounding error, in noises, that is added to [`ROUNDING`] if a gap is computed from boxes. Centres and extents of the
/// boxes along a normal have an error of less than one noise. The heights of vertices, with which a verification
/// compares the margin, have an error of less than another noise.
const BOXES: f64 = 2.0;

/// Finds a plane, parallel to the direction, that separates the offset bodies by more than the minimum gap and the
/// rounding errors. The margin is that of the cores less both radii.
///
/// `None` if there is no such plane. Also `None` sometimes for large faces whose distance is at most the offset, because
/// the search visits at most [`MAX_LEAVES`] leaves for a vertex.
pub(crate) fn find_separation(scene: &PairFrame) -> Option<Separation> {
    let boxes = [&scene.moving, &scene.fixed].map(PlacedBody::offset_bounds);
    between_boxes(scene, &boxes).or_else(|| between_hulls(scene))
}

/// Checks whether the boxes of two bodies are far enough apart that the separating axes of the query confirm it.
/// The verification of a proof uses those axes, which enlarge a node by 2 noises along each coordinate.
pub(crate) fn shadows_apart(scene: &PairFrame, p: &Projected, q: &Projected) -> bool {
    let clear = |found: Separation| found.margin > ROUNDING * scene.noise;
    !scene.has_min_gap() && between_boxes(scene, &[p.local, q.local]).is_some_and(clear)
}

/// Finds the plane between the boxes of both bodies with the largest margin, parallel to the direction and to an edge
/// of one of them.
fn between_boxes(scene: &PairFrame, boxes: &[Aabb; 2]) -> Option<Separation> {
    let boxes = Boxes::new(&scene.setting, boxes);
    let normal = boxes.widest_normal(0.0)?;
    let margin = scene.setting.less_radii(boxes.margin(normal, scene.noise));
    (margin > scene.body_gap).then_some(Separation { normal, margin })
}

/// Two boxes in the frames of their bodies.
pub(crate) struct Boxes<'s, 'a> {
    setting: &'s Setting<'a, Solid>,
    matrices: [DMat3; 2],
    halves: [DVec3; 2],
    /// Vector from the centre of the moving body's box to that of the fixed one's, in the setting frame.
    apart: DVec3,
}

impl<'s, 'a> Boxes<'s, 'a> {
    pub(crate) fn new(setting: &'s Setting<'a, Solid>, boxes: &[Aabb; 2]) -> Self {
        let matrices = [setting.moving_matrix, setting.fixed_matrix];
        let [p, q] = [0, 1].map(|k| matrices[k] * boxes[k].center());
        let halves = boxes.each_ref().map(|b| b.side_lengths() * 0.5);
        Self { setting, matrices, halves, apart: q + setting.offset - p }
    }

    /// Returns the normal, orthogonal to the direction and to an edge of one of the boxes, along which the boxes are
    /// farthest apart. It points from the moving body to the fixed one. It is orthogonal to the direction up to
    /// rounding, but to the edge only approximately.
    ///
    /// `None` if the boxes overlap by more than `slack` along all these normals, or if the line along the direction
    /// through the centre of the moving box meets the fixed one.
    pub(crate) fn widest_normal(&self, slack: f64) -> Option<DVec3> {
        let Self { matrices, halves, apart, .. } = self;
        let unit = self.setting.unit;
        if self.is_middle_ahead() {
            return None;
        }
        let between = matrices[0].transpose() * matrices[1];
        // Signed squares of distances are compared, which avoids square roots.
        let (mut most, mut widest) = (-slack * slack, None);
        for (k, other) in [(0, between.transpose()), (1, between)] {
            let back = matrices[k].transpose();
            let (along, apart) = (back * unit, back * *apart);
            for axis in 0..3 {
                // The two components, which are not 0, of the cross product of the direction and the axis.
                let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
                let (x, y) = (along[j], -along[i]);
                let away = apart[i] * x + apart[j] * y;
                let turned = other.col(i) * x + other.col(j) * y;
                let own = x.abs() * halves[k][i] + y.abs() * halves[k][j];
                let room = away.abs() - own - turned.abs().dot(halves[1 - k]);
                let square = room * room.abs();
                if room > -slack && square > most * (x * x + y * y) {
                    most = square / (x * x + y * y);
                    let across = matrices[k].col(i) * x + matrices[k].col(j) * y;
                    widest = Some(across * away.signum());
                }
            }
        }
        widest?.reject_from_normalized(unit).try_normalize()
    }

    /// Checks whether the line along the direction through the centre of the moving box meets the fixed one. Then no
    /// plane parallel to the direction separates them.
    fn is_middle_ahead(&self) -> bool {
        let back = self.matrices[1].transpose();
        let (along, apart, half) = (back * self.setting.unit, back * self.apart, self.halves[1]);
        let (away, size) = (apart.cross(along).abs(), along.abs());
        let reach = half.yzx() * size.zxy() + half.zxy() * size.yzx();
        away.cmple(reach).all()
    }

    /// Checks whether the boxes of two bodies with the axes of the world, up to signs, touch within the rounding error.
    pub(crate) fn are_touching(&self, rounding: f64) -> bool {
        let [p, q] = [0, 1].map(|k| (self.matrices[k] * self.halves[k]).abs());
        (self.apart.abs() - p - q).max_element().abs() <= rounding
    }

    /// Returns the margin that is proven along a normal of the world, from the moving body to the fixed one.
    pub(crate) fn margin(&self, normal: DVec3, noise: f64) -> f64 {
        self.distance_along(normal)
            - (ROUNDING + BOXES) * noise
            - closing_bound(self.setting, normal, noise)
    }

    /// Checks whether a plane parallel to a side of one box certainly separates the boxes, and the moving box does not
    /// approach it.
    pub(crate) fn are_left_behind(&self, noise: f64) -> bool {
        self.matrices.iter().any(|matrix| {
            [matrix.x_axis, matrix.y_axis, matrix.z_axis].into_iter().any(|axis| {
                let axis = axis * self.apart.dot(axis).signum();
                axis.dot(self.setting.unit) <= 0.0
                    && self.distance_along(axis) > (ROUNDING + BOXES) * noise
            })
        })
    }

    /// Returns the distance of the boxes along a normal of the world.
    fn distance_along(&self, normal: DVec3) -> f64 {
        let half = |k: usize| (self.matrices[k].transpose() * normal).abs().dot(self.halves[k]);
        normal.dot(self.apart) - half(0) - half(1)
    }
}

fn between_hulls(scene: &PairFrame) -> Option<Separation> {
    let middle = |side: &PlacedBody| {
        (side.view * side.solid.bounds().center() + side.view_offset).truncate()
    };
    let mut v = middle(&scene.fixed) - middle(&scene.moving);
    let mut simplex: Simplex = (0, [DVec2::ZERO; 3]);
    for _ in 0..MAX_ROUNDS {
        let axis = v.try_normalize()?;
        let normal = (scene.frame.transpose() * axis.extend(0.0)).normalize_or_zero();
        let sides = facing_sides(scene, normal);
        let margin = margin_along(scene, normal, sides.each_ref().map(Farthest::height_bound));
        let margin = scene.setting.less_radii(margin);
        if margin > scene.body_gap {
            return Some(Separation { normal, margin });
        }
        let [p, q] = &sides;
        let lowest = q.shadow() - p.shadow();
        let closer = simplex.0 == 0 || axis.dot(lowest) < v.dot(axis) - ROUNDING * scene.noise;
        if !closer {
            return None;
        }
        simplex.1[simplex.0] = lowest;
        simplex.0 += 1;
        (simplex, v) = nearest_part(simplex)?;
    }
    None
}

/// Verifies a separating plane and returns the margin that is proven.
///
/// # Errors
/// Returns an error if the normal is not a unit vector orthogonal to the direction, or the claimed margin is not
/// proven.
pub(crate) fn verify_separation(
    scene: &PairFrame,
    separation: &Separation,
) -> Result<f64, CertificateError> {
    let normal = separation.normal;
    let unit = (normal.length() - 1.0).abs() <= UNIT_VECTOR;
    if !unit || (normal.dot(scene.setting.direction) / scene.setting.length).abs() > UNIT_VECTOR {
        return Err(CertificateError::Normal { normal });
    }
    let highest = |side: &PlacedBody| {
        let local = side.matrix.transpose() * if side.moving { normal } else { -normal };
        let heights =
            (0..side.solid.vertices().len() as u32).map(|v| local.dot(side.offset_vertex(v)));
        heights.fold(f64::NEG_INFINITY, f64::max)
    };
    let reaches = [&scene.moving, &scene.fixed].map(highest);
    // All vertices are compared here, so no error of ties remains.
    let proven = margin_along(scene, normal, reaches) + TIES * scene.noise;
    let proven = scene.setting.less_radii(proven);
    let claimed = separation.margin;
    if claimed > scene.body_gap && claimed <= proven {
        Ok(proven)
    } else {
        Err(CertificateError::Bound { proven, claimed })
    }
}

/// Checks whether a plane with this normal certainly separates the bodies by more than the minimum gap, with the moving
/// body below.
pub(crate) fn is_separating(scene: &PairFrame, normal: DVec3) -> bool {
    let [p, q] = facing_sides(scene, normal).map(|side| side.height_bound());
    normal.dot(scene.fixed.offset[0]) - q - p > scene.min_gap() + HEIGHTS * scene.noise
}

/// Returns an upper bound of the coordinates of an offset body's vertices along a normal of the world, relative to the
/// origin of the body frame, up to the rounding error of [`HEIGHTS`].
pub(crate) fn max_height_along(side: &PlacedBody, normal: DVec3) -> f64 {
    Farthest::new(side, normal).height_bound()
}

/// Points of `D`: their number, and the points.
type Simplex = (usize, [DVec2; 3]);

/// Finds the farthest vertex of the moving body along a normal of the world, and of the fixed body against it.
fn facing_sides<'s, 'a>(scene: &'s PairFrame<'a>, normal: DVec3) -> [Farthest<'s, 'a>; 2] {
    [Farthest::new(&scene.moving, normal), Farthest::new(&scene.fixed, -normal)]
}

/// Returns the margin along a normal, given the extents of the moving body along it, and of the fixed body against it.
fn margin_along(scene: &PairFrame, normal: DVec3, [moving, fixed]: [f64; 2]) -> f64 {
    let fixed = normal.dot(scene.fixed.offset[0]) - fixed;
    fixed - moving - ROUNDING * scene.noise - closing_bound(&scene.setting, normal, scene.noise)
}

/// Bounds how much the gap closes over the size of the configuration because the normal is not exactly orthogonal to
/// the direction.
pub(crate) fn closing_bound<B>(setting: &Setting<B>, normal: DVec3, noise: f64) -> f64 {
    (normal.dot(setting.direction) / setting.length).abs() * size_from_noise(noise)
}

/// Maximum number of leaves that are visited for one farthest vertex. More are needed if the vertices of a large flat
/// face are tied and the offset has made their heights differ.
const MAX_LEAVES: u32 = 64;

/// The vertex of a body that is farthest along a normal of the world, from the tree.
struct Farthest<'s, 'a> {
    side: &'s PlacedBody<'a>,
    /// The normal in the body frame.
    local: DVec3,
    /// The farthest visited vertex, and its height along the normal from the origin of the body frame.
    vertex: u32,
    height: f64,
    /// Upper bound on the heights of vertices that were not visited.
    beyond: f64,
    /// Number of visited leaves.
    leaves: u32,
}

impl<'s, 'a> Farthest<'s, 'a> {
    fn new(side: &'s PlacedBody<'a>, normal: DVec3) -> Self {
        let mut search = Self {
            side,
            local: side.matrix.transpose() * normal,
            vertex: side.solid.triangles()[0][0],
            height: f64::NEG_INFINITY,
            beyond: f64::NEG_INFINITY,
            leaves: 0,
        };
        search.visit_node(0);
        search
    }

    /// Returns an upper bound of the heights of all vertices along the normal, up to rounding.
    fn height_bound(&self) -> f64 {
        self.height.max(self.beyond)
    }

    /// Returns the shadow of the vertex.
    fn shadow(&self) -> DVec2 {
        self.side.corner(self.vertex).at.truncate()
    }

    fn visit_node(&mut self, at: u32) {
        let nodes = self.side.solid.nodes();
        let node = &nodes[at as usize];
        if node.is_leaf() {
            self.leaves += 1;
            for v in node.facets().flat_map(|t| self.side.solid.triangles()[t]) {
                let height = self.local.dot(self.side.offset_vertex(v));
                if height > self.height {
                    (self.height, self.vertex) = (height, v);
                }
            }
            return;
        }
        let bound = |k: u32| {
            let node = &nodes[k as usize];
            let mut ends = node.bounds;
            if let Some(shrinking) = self.side.shrinking {
                ends = shrinking.offset_box(ends, self.side.amount, k as usize);
            }
            self.local.dot(DVec3::select(self.local.cmpgt(DVec3::ZERO), ends.high, ends.low))
        };
        let mut parts = node.child_positions(at).map(|k| (bound(k), k));
        if parts[1].0 > parts[0].0 {
            parts.swap(0, 1);
        }
        // All vertices of a flat face orthogonal to the normal are farthest, and one of them is sufficient.
        let tie = 8.0 * f64::EPSILON * self.side.solid.reach();
        for (bound, k) in parts {
            if bound <= self.height + tie {
                continue;
            }
            if self.leaves < MAX_LEAVES {
                self.visit_node(k);
            } else {
                self.beyond = self.beyond.max(bound);
            }
        }
    }
}

/// Returns the part of a simplex that contains its point nearest to the origin, and this point; `None` if the simplex
/// contains the origin.
fn nearest_part((count, points): Simplex) -> Option<(Simplex, DVec2)> {
    let [a, b, c] = points;
    match count {
        1 => Some(((1, points), a)),
        2 => Some(on_side(a, b)),
        _ => {
            let area = (b - a).perp_dot(c - a);
            let inside = |p: DVec2, q: DVec2| p.perp_dot(q) * area >= 0.0;
            if area != 0.0 && inside(a, b) && inside(b, c) && inside(c, a) {
                return None;
            }
            let sides = [on_side(a, b), on_side(b, c), on_side(c, a)];
            sides.into_iter().min_by(|x, y| x.1.length_squared().total_cmp(&y.1.length_squared()))
        }
    }
}

fn on_side(a: DVec2, b: DVec2) -> (Simplex, DVec2) {
    let along = b - a;
    let share = -a.dot(along) / along.length_squared();
    if share > 0.0 && share < 1.0 {
        ((2, [a, b, DVec2::ZERO]), a + along * share)
    } else if share >= 1.0 {
        ((1, [b, DVec2::ZERO, DVec2::ZERO]), b)
    } else {
        ((1, [a, DVec2::ZERO, DVec2::ZERO]), a)
    }
}
