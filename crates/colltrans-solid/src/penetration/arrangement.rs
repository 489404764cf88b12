//! The volume of the common part of two solids, by an arrangement on each facet.
//!
//! - A point is inside a body if the winding number of the body around it is positive. The volume is the integral of
//!   the height times the vertical component of the normal over the boundary of the common part. A part of a facet
//!   belongs to this boundary if it lies inside the other body, and inside its own one on exactly one side.
//! - The *zone* of a facet `f` and another one `g` is a convex polygon around the projection of the points of `f` near
//!   `g`. Lines along the sides of all zones divide the projection of `f` into convex pieces. On a piece outside of all
//!   zones no facet is near `f`, so that the exact winding numbers at one point decide the piece.
//! - The area of the zones, and of a narrow frame of each facet, counts as undecided. Where facets cross, a zone is some
//!   noises wide. Facets in one plane would be undecided as a whole. Therefore further sums displace each body of both
//!   solids by a small translation of its own, and add the volume through which the facets move to the error.
//!
//! Proof and rounding errors: `docs/theory/depth-of-solids.md`.

use glam::{DVec2, DVec3, Vec3Swizzles};

use super::cells::{clipped, double_area, near_triangles};
use super::depth::radical_inverse;
use super::facet_tree::FacetTree;
use super::piece::{Line, Piece, Zone};
use crate::solve::nearest::triangle::Corners;
use crate::solve::scene::PairFrame;
use colltrans_convex::body::Aabb;
use colltrans_kernel::predicates::{orient2d, orient3d};
use colltrans_kernel::range::{MIN_MAGNITUDE, with_tiny_components_zeroed};

/// Distance between the plane of a facet and the planes that cut the points near it, in noises. It exceeds the distance
/// of near points by the errors of the cuts.
const NEAR: f64 = 32.0;
/// Distance from the projection of the computed points near a facet to the sides of their zone, in noises.
const MARGIN: f64 = 40.0;
/// Width of the frame of a facet that is not decided, in noises.
const FRAME: f64 = 160.0;
/// Ratio of area and circumference up to which a piece is not decided, in noises.
const SLIVER: f64 = 160.0;
/// Length of the path of a corner from its exact to its computed position, in noises.
const PATH: f64 = 8.0;
/// Displacement of the heights of a piece, in noises.
const HEIGHT_ERROR: f64 = 16.0;
/// Component of a unit normal up to which a facet counts as parallel to an axis in the choice of the axis.
const UPRIGHT: f64 = 1e-9;
/// Factors of the displacements of bodies in the sums over facets, in noises. Long ones separate more facets in one plane,
/// and short ones move facets through less volume, which counts for thin common parts.
pub(super) const DISPLACEMENTS: [f64; 3] = [0.0, 1_048_576.0, 16_384.0];
/// Ratios of the components of displacements. Small rational numbers would leave them orthogonal to the normals of
/// common facets.
const RATIOS: DVec3 = DVec3::new(1.0, 0.917_316_4, 0.834_672_9);
/// Number of zones from which a piece is halved, if that separates them.
const MANY_ZONES: usize = 16;
/// Relative error of the height above a facet, for each unit of length along it and of its extent across its width.
const SLOPE_ERROR: f64 = 16.0 * f64::EPSILON;

/// A facet in the frame of the sum.
struct Facet {
    /// Corners, counter-clockwise as seen from above.
    corners: Corners,
    /// 1 if the facet faces upwards, -1 if downwards, 0 if its projection has no area.
    sign: i32,
    is_fixed: bool,
}

impl Facet {
    fn new(mut corners: Corners, is_fixed: bool) -> Self {
        let [a, b, c] = corners.map(Vec3Swizzles::xy);
        let turn = orient2d(a, b, c);
        if turn < 0.0 {
            corners.swap(1, 2);
        }
        let sign = i32::from(turn > 0.0) - i32::from(turn < 0.0);
        Self { corners, sign, is_fixed }
    }

    /// Checks whether the projection contains a point that is displaced by an infinitesimal amount along `x`, and a far
    /// smaller one along `y`.
    fn covers(&self, point: DVec2) -> bool {
        let corners = self.corners.map(Vec3Swizzles::xy);
        (0..3).all(|k| {
            let (a, b) = (corners[k], corners[(k + 1) % 3]);
            let turn = orient2d(a, b, point);
            turn > 0.0 || turn == 0.0 && (b.y < a.y || b.y == a.y && b.x > a.x)
        })
    }

    /// Checks whether the facet is above a point of its projection; `None` if the point is on the plane of the facet.
    fn is_above(&self, point: DVec3) -> Option<bool> {
        let [a, b, c] = self.corners;
        if a.z.max(b.z).max(c.z) < point.z {
            return Some(false);
        }
        if a.z.min(b.z).min(c.z) > point.z {
            return Some(true);
        }
        let side = orient3d(a, b, c, point);
        (side != 0.0).then_some(side < 0.0)
    }
}

/// The plane of a facet, as a height over the base.
struct Plane {
    origin: DVec3,
    /// Unit vector along the longest edge of the projection.
    along: DVec2,
    /// Slopes along this edge and perpendicular to it.
    slopes: DVec2,
    /// Cosine of the angle between the normal and the vertical.
    cosine: f64,
    /// Bound on the error of [`Self::distance`], for each unit of the distance from the origin.
    error: f64,
}

impl Plane {
    /// Builds the plane of a facet; `None` if its projection is narrower than `least`.
    fn new(corners: &Corners, least: f64) -> Option<Self> {
        let length = |k: usize| (corners[(k + 1) % 3] - corners[k]).xy().length();
        let longest = (0..3).max_by(|&i, &j| length(i).total_cmp(&length(j)))?;
        let [a, b, c] = [0, 1, 2].map(|k| corners[(longest + k) % 3]);
        let along = (b - a).xy() / length(longest);
        let foot = DVec2::new(along.dot((c - a).xy()), along.perp_dot((c - a).xy()));
        // Not a number if the longest edge has no length.
        if foot.y.is_nan() || foot.y <= least {
            return None;
        }
        let slope = (b.z - a.z) / length(longest);
        let slopes = DVec2::new(slope, (c.z - a.z - slope * foot.x) / foot.y);
        let cosine = 1.0 / (1.0 + slopes.length_squared()).sqrt();
        let extent = a.z.max(b.z).max(c.z) - a.z.min(b.z).min(c.z);
        let error = SLOPE_ERROR * cosine * (extent + slopes.y.abs() * length(longest)) / foot.y;
        Some(Self { origin: a, along, slopes, cosine, error })
    }

    fn height(&self, point: DVec2) -> f64 {
        let from = point - self.origin.xy();
        let rise = self.slopes.x * self.along.dot(from) + self.slopes.y * self.along.perp_dot(from);
        self.origin.z + rise
    }

    /// Returns the line at which the plane has a height, with the higher points on its inner side; `None` if the plane
    /// is horizontal.
    fn line_at_height(&self, height: f64) -> Option<Line> {
        let gradient = self.along * self.slopes.x + self.along.perp() * self.slopes.y;
        let normal = gradient.try_normalize()?;
        let rise = (height - self.origin.z) / gradient.length();
        Some(Line::new(normal, normal.dot(self.origin.xy()) + rise))
    }

    /// Returns the corners of the part of a facet in a box that is near the plane.
    fn points_near(&self, corners: Corners, around: &Aabb, near: f64) -> Vec<DVec3> {
        let distances = corners.map(|p| self.distance(p));
        let is_beyond = |sign: f64| distances.iter().all(|[d, e]| sign * d - 1.02 * e > 1.1 * near);
        if is_beyond(1.0) || is_beyond(-1.0) {
            return Vec::new();
        }
        let mut points = clipped(corners, around);
        let error = points.iter().map(|p| self.distance(*p)[1]).fold(0.0, f64::max);
        for sign in [1.0, -1.0] {
            points =
                points_below(&points, |p| sign * self.distance(p)[0] - 1.02 * error - 1.1 * near);
        }
        points
    }

    /// Returns the signed distance of a point from the plane, and a bound on its error besides that of coordinates.
    fn distance(&self, point: DVec3) -> [f64; 2] {
        let distance = (point.z - self.height(point.xy())) * self.cosine;
        [distance, self.error * (point - self.origin).xy().length()]
    }
}

/// Returns the corners of the part of a polygon where a function is not positive.
fn points_below(corners: &[DVec3], value: impl Fn(DVec3) -> f64) -> Vec<DVec3> {
    let values: Vec<f64> = corners.iter().map(|p| value(*p)).collect();
    let mut kept = Vec::with_capacity(corners.len() + 1);
    for (i, &p) in corners.iter().enumerate() {
        let next = (i + 1) % corners.len();
        let [from, to] = [values[i], values[next]];
        if from <= 0.0 {
            kept.push(p);
        }
        if (from <= 0.0) != (to <= 0.0) {
            kept.push(p + (corners[next] - p) * (from / (from - to)));
        }
    }
    kept
}

/// Returns the coordinates of a vector, with that along `axis` last.
fn upright(v: DVec3, axis: usize) -> DVec3 {
    match axis {
        0 => v.yzx(),
        1 => v.zxy(),
        _ => v,
    }
}

/// Returns the vector whose coordinates with that along `axis` last are given.
fn lying(v: DVec3, axis: usize) -> DVec3 {
    upright(v, (4 - axis) % 3)
}

/// The volume of the common part of two bodies in a box, in the setting frame.
pub(super) struct CommonVolume {
    /// Lower and upper bound.
    pub(super) bounds: [f64; 2],
    /// Point that is inside both bodies, unless rounding errors displace it.
    pub(super) point: Option<DVec3>,
}

/// The sum over the facets of both bodies.
struct Sum {
    /// Box that contains the common part.
    room: Aabb,
    noise: f64,
    facets: Vec<Facet>,
    tree: FacetTree,
    /// Number of boxes and pieces that may still be examined.
    budget: u64,
    value: f64,
    /// Sum of the magnitudes of all terms, and their number.
    magnitude: f64,
    terms: f64,
    /// Area of the base that is not decided.
    undecided: f64,
    /// Bound on the area of the base that rounding errors move from one piece to another.
    moved: f64,
    /// Bound on the other errors of the volume.
    error: f64,
    /// Area and a point of the largest piece of the boundary of the common part.
    largest: (f64, DVec2),
}

impl Sum {
    /// Collects the facets of both bodies in and above a room, in a frame whose third axis is `axis`.
    fn new(scene: &PairFrame, room: &Aabb, axis: usize, displacement: f64, budget: u64) -> Self {
        // Covers components that are set to 0.
        let noise = scene.noise.max(MIN_MAGNITUDE);
        let shift = displacement * noise;
        let room = room.expanded(2.0 * shift + 16.0 * noise);
        let mut column = room.expanded(2.0 * shift + 16.0 * noise);
        column.high[axis] = f64::INFINITY;
        let (mut facets, mut error, mut bodies) = (Vec::new(), 0.0, 0);
        for is_fixed in [false, true] {
            let side = scene.side(!is_fixed);
            let numbers = if shift > 0.0 { side.solid.body_numbers() } else { &[] };
            for (triangle, corners) in near_triangles(scene, side, &column) {
                let by = numbers.get(triangle).map_or(DVec3::ZERO, |number| {
                    let place = [2, 3, 5].map(|base| radical_inverse(bodies + number + 1, base));
                    (DVec3::from_array(place) * 2.0 - 1.0) * RATIOS * shift
                });
                error += swept_volume(corners, by, &room, noise);
                let place = |p| upright(with_tiny_components_zeroed(p + by), axis);
                facets.push(Facet::new(corners.map(place), is_fixed));
            }
            bodies += numbers.iter().max().map_or(0, |last| last + 1);
        }
        let tree = FacetTree::new(facets.iter().map(|facet| Aabb::from_triangle(facet.corners)));
        let room = Aabb { low: upright(room.low, axis), high: upright(room.high, axis) };
        let [value, magnitude, terms, undecided, moved] = [0.0; 5];
        let largest = (0.0, DVec2::ZERO);
        Self {
            room,
            noise,
            facets,
            tree,
            budget,
            value,
            magnitude,
            terms,
            undecided,
            moved,
            error,
            largest,
        }
    }

    /// Adds the contribution of a facet.
    fn add_facet(&mut self, index: usize) {
        let Facet { corners, sign, .. } = self.facets[index];
        if sign == 0 || !Aabb::from_triangle(corners).intersects(&self.room) {
            return;
        }
        let plane = Plane::new(&corners, 2.0 * FRAME * self.noise);
        let flat = corners.map(Vec3Swizzles::xy);
        let mut piece = Piece::new(flat.to_vec());
        for side in self.sides_of_room(&corners, plane.as_ref()) {
            [_, piece] = self.split(piece, &side);
        }
        let whole = piece.area();
        self.moved += self.noise * piece.circumference();
        let mut decided = 0.0;
        if let Some(plane) = &plane {
            for k in 0..3 {
                let inwards = (flat[(k + 1) % 3] - flat[k]).perp().normalize_or_zero();
                let frame = Line::new(inwards, inwards.dot(flat[k]) + FRAME * self.noise);
                [_, piece] = self.split(piece, &frame);
            }
            if !piece.is_empty() {
                decided = self.add_pieces(index, plane, piece);
            }
        }
        self.undecided += (whole - decided).max(0.0);
    }

    /// Returns the lines along the sides of the room across which a facet extends.
    fn sides_of_room(&self, corners: &Corners, plane: Option<&Plane>) -> Vec<Line> {
        let (Aabb { low, high }, bounds) = (self.room, Aabb::from_triangle(*corners));
        let mut sides = Vec::new();
        for (k, axis) in [DVec2::X, DVec2::Y].into_iter().enumerate() {
            if bounds.low[k] < low[k] {
                sides.push(Line::new(axis, low[k]));
            }
            if bounds.high[k] > high[k] {
                sides.push(Line::new(-axis, -high[k]));
            }
        }
        if let Some(plane) = plane {
            if bounds.low.z < low.z {
                sides.extend(plane.line_at_height(low.z));
            }
            if bounds.high.z > high.z {
                sides.extend(plane.line_at_height(high.z).map(Line::reversed));
            }
        }
        sides
    }

    /// Divides a piece along a line.
    fn split(&mut self, piece: Piece, line: &Line) -> [Piece; 2] {
        self.moved += self.noise * piece.circumference();
        piece.split(line)
    }

    /// Divides a part of a facet along its zones, adds the contributions of all pieces, and returns their area.
    fn add_pieces(&mut self, index: usize, plane: &Plane, part: Piece) -> f64 {
        let zones = self.zones(index, plane, &part);
        let mut decided = 0.0;
        let mut open = vec![(part, (0..zones.len() as u32).collect::<Vec<u32>>())];
        while let Some((piece, mut near)) = open.pop() {
            self.budget = self.budget.saturating_sub(1);
            if self.budget == 0 {
                break;
            }
            if piece.area() <= SLIVER * self.noise * piece.circumference() {
                continue;
            }
            if near.is_empty() {
                decided += self.add_piece(index, plane, &piece);
                continue;
            }
            if near.len() >= MANY_ZONES {
                // A curve of zones may enclose the piece, so that no zone separates others.
                let halves = self.split(piece.clone(), &piece.halving_line());
                let lists = [0, 1].map(|k| self.zones_of(&halves[k], &near, &zones));
                if lists[0].len() + lists[1].len() <= near.len() + near.len() / 2 {
                    open.extend(halves.into_iter().zip(lists).filter(|(half, _)| !half.is_empty()));
                    continue;
                }
            }
            let zone = &zones[near.swap_remove(near.len() / 2) as usize];
            let mut rest = piece;
            for side in &zone.sides {
                let [outer, inner] = self.split(rest, side);
                if !outer.is_empty() {
                    let near = self.zones_of(&outer, &near, &zones);
                    open.push((outer, near));
                }
                rest = inner;
            }
        }
        decided
    }

    /// Returns the zones of a list that no line separates from a piece.
    fn zones_of(&mut self, piece: &Piece, near: &[u32], zones: &[Zone]) -> Vec<u32> {
        self.budget = self.budget.saturating_sub((near.len() * piece.corners().len()) as u64);
        near.iter().copied().filter(|k| !zones[*k as usize].is_apart(piece)).collect()
    }

    /// Returns the zones of the other facets near a part of a facet.
    fn zones(&mut self, index: usize, plane: &Plane, part: &Piece) -> Vec<Zone> {
        let near = NEAR * self.noise;
        let points = part.corners().iter().map(|p| p.extend(plane.height(*p)));
        let mut around = Aabb::from_points(points).expanded(2.0 * near);
        // Heights on steep planes.
        let rise = plane.slopes.length() * self.noise;
        (around.low.z, around.high.z) = (around.low.z - rise, around.high.z + rise);
        let mut zones = Vec::new();
        let visited = self.tree.visit(
            |bounds| bounds.intersects(&around),
            |other| {
                if other == index {
                    return;
                }
                let points = plane.points_near(self.facets[other].corners, &around, near);
                let flat: Vec<DVec2> = points.iter().map(|p| p.xy()).collect();
                let zone = Zone::around(&flat, MARGIN * self.noise);
                zones.extend(zone.filter(|zone| !zone.is_apart(part)));
            },
        );
        self.budget = self.budget.saturating_sub(visited);
        zones
    }

    /// Adds the contribution of a piece of a facet that no other facet is near, and returns its area; 0 if it is not
    /// decided.
    fn add_piece(&mut self, index: usize, plane: &Plane, piece: &Piece) -> f64 {
        let middle = piece.middle();
        let area = piece.area();
        let point = with_tiny_components_zeroed(middle.extend(plane.height(middle)));
        let Some([own, other]) = self.winding_numbers_above(index, point) else { return 0.0 };
        let sign = self.facets[index].sign;
        if own + sign.max(0) != 1 || other <= 0 {
            return area;
        }
        if area > self.largest.0 {
            self.largest = (area, middle);
        }
        let Aabb { low, high } = self.room;
        let base = 0.5 * (low.z + high.z);
        let place = |p: DVec2| p.extend(plane.height(p).clamp(low.z, high.z));
        let integral = |[a, b, c]: [DVec2; 3]| {
            let heights = [a, b, c].map(|p| place(p).z - base);
            (b - a).perp_dot(c - a) * heights.iter().sum::<f64>() / 6.0
        };
        let term = f64::from(sign) * piece.triangles().map(integral).sum::<f64>();
        self.value += term;
        self.magnitude += term.abs();
        self.terms += 1.0;
        self.moved += self.noise * piece.circumference();
        let bounds = Aabb::from_points(piece.corners().iter().map(|p| place(*p)));
        let sides = bounds.expanded(self.noise).side_lengths();
        self.error += self.noise * (HEIGHT_ERROR * (sides.x + sides.y) * sides.z + area);
        area
    }

    /// Computes the winding numbers of both bodies, the one with this facet first, just above the facet at a point;
    /// `None` if the point is on another facet.
    fn winding_numbers_above(&mut self, index: usize, point: DVec3) -> Option<[i32; 2]> {
        let (mut numbers, mut is_off) = ([0; 2], true);
        let is_fixed = self.facets[index].is_fixed;
        let covers = |bounds: &Aabb| {
            bounds.low.xy().cmple(point.xy()).all() && point.cmple(bounds.high).all()
        };
        let visited = self.tree.visit(covers, |other| {
            let facet = &self.facets[other];
            if other == index || facet.sign == 0 || !facet.covers(point.xy()) {
                return;
            }
            match facet.is_above(point) {
                Some(true) => numbers[usize::from(facet.is_fixed != is_fixed)] += facet.sign,
                Some(false) => {}
                None => is_off = false,
            }
        });
        self.budget = self.budget.saturating_sub(visited);
        is_off.then_some(numbers)
    }

    /// Returns the middle of the longest interval inside both bodies above a point of the base; `None` if there is none.
    fn inner_height(&self, at: DVec2) -> Option<f64> {
        let mut hits = Vec::new();
        let is_in_column =
            |bounds: &Aabb| bounds.low.xy().cmple(at).all() && at.cmple(bounds.high.xy()).all();
        self.tree.visit(is_in_column, |index| {
            let facet = &self.facets[index];
            if facet.sign != 0 && facet.covers(at) {
                let plane = Plane::new(&facet.corners, 0.0);
                hits.extend(plane.map(|plane| (plane.height(at), facet)));
            }
        });
        hits.sort_by(|f, g| g.0.total_cmp(&f.0));
        let (mut numbers, mut best) = ([0; 2], (0.0, None));
        for pair in hits.windows(2) {
            let (high, facet) = pair[0];
            numbers[usize::from(facet.is_fixed)] += facet.sign;
            let length = high - pair[1].0;
            if numbers.iter().all(|number| *number > 0) && length > best.0 {
                best = (length, Some(high - 0.5 * length));
            }
        }
        best.1
    }

    /// Returns the bounds of the volume; `None` if they are not finite.
    fn bounds(&self) -> Option<[f64; 2]> {
        let height = self.room.side_lengths().z;
        let rounding = self.terms * (f64::EPSILON * self.magnitude + f64::MIN_POSITIVE);
        let error = self.error + (0.5 * self.undecided + self.moved) * height + rounding;
        let error = error * (1.0 + 1e-9) + 4.0 * f64::EPSILON * self.value.abs();
        let bounds = [self.value - error, self.value + error];
        bounds.iter().all(|b| b.is_finite()).then(|| bounds.map(|b| b.max(0.0)))
    }
}

/// Returns a bound of the volume in a room through which a facet moves from its exact place to the computed one,
/// displaced by `by`.
fn swept_volume(corners: Corners, by: DVec3, room: &Aabb, noise: f64) -> f64 {
    let within = clipped(corners, &room.expanded(8.0 * noise));
    if within.is_empty() {
        return 0.0;
    }
    let sides = Aabb::from_points(within.iter().copied()).expanded(8.0 * noise).side_lengths();
    let [a, b, c] = corners;
    let normal = (b - a).cross(c - a);
    let share = (double_area(&within) / normal.length()).min(1.0);
    let size = Aabb::from_triangle(corners).side_lengths().length_squared();
    let swept = normal.dot(by).abs() * share
        + (8.0 * f64::EPSILON * size + noise * sides.length()) * by.length();
    PATH * noise * sides.dot(sides.yzx()) + 0.5 * (1.0 + 1e-9) * swept
}

/// Returns the axis along which the fewest facets in a room have a height.
fn best_axis(scene: &PairFrame, room: &Aabb) -> usize {
    let mut counts = [0; 3];
    for is_moving in [true, false] {
        for (_, [a, b, c]) in near_triangles(scene, scene.side(is_moving), room) {
            let normal = (b - a).cross(c - a);
            let least = UPRIGHT * normal.abs().max_element();
            (0..3).filter(|&k| normal[k].abs() > least).for_each(|k| counts[k] += 1);
        }
    }
    (0..3).min_by_key(|&k| counts[k]).unwrap_or(2)
}

/// Computes the volume of the common part of two bodies in a box; `None` if that takes more than `budget` boxes and
/// pieces. The bodies of both solids are displaced by `displacement` noises at most along each axis.
pub(super) fn common_volume(
    scene: &PairFrame,
    room: &Aabb,
    displacement: f64,
    budget: u64,
) -> Option<CommonVolume> {
    let axis = best_axis(scene, room);
    let mut sum = Sum::new(scene, room, axis, displacement, budget);
    for index in 0..sum.facets.len() {
        sum.add_facet(index);
        if sum.budget == 0 {
            return None;
        }
    }
    let (area, base) = sum.largest;
    let height = if area > 0.0 { sum.inner_height(base) } else { None };
    let point = height.map(|height| lying(base.extend(height), axis));
    Some(CommonVolume { bounds: sum.bounds()?, point })
}
