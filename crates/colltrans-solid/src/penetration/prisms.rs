//! The volume of the common part of two bodies, as a sum over pairs of facets.
//!
//! - The *room* is a box that contains the common part. Its coordinates are `x`, `y`, and the height `z` from 0 to `H`.
//!   `a` and `b` are the winding numbers of the bodies, as functions of a point.
//! - A facet has the sign 1 if it faces upwards, and otherwise -1. In each column, `a` is the sum of the signs of the
//!   facets above a point, and `b` is the negative sum of the signs of the facets below it.
//! - Hence the integral of `a b` over the room is a sum over pairs of facets: the product of the signs, times the
//!   volume between the lower facet of the fixed body and the higher one of the moving body. No decision about contact
//!   or orientation changes this sum by more than rounding errors, because it is a continuous function of the corners.
//! - If `a` and `b` are 0 or 1, the integral is the volume. The integral of `a^2 - a` is a sum of the same kind. It is
//!   positive where `a` is another integer, and bounds the error.
//!
//! Proof and rounding errors: `docs/theory/depth-of-solids.md`.

use glam::{DVec2, DVec3, DVec4, Vec3Swizzles, Vec4Swizzles};

use super::cells::near_facets;
use crate::solve::hulls::ConvexBody;
use crate::solve::nearest::triangle::Corners;
use crate::solve::scene::{PairFrame, PlacedBody};
use colltrans_convex::body::Aabb;

/// Maximum number of corners of a triangle after 4 cuts at the room, 3 at another triangle, and 5 by heights.
const MAX_CORNERS: usize = 16;
/// Displacement of the boundary of the common projection of two facets, in noises.
const DISPLACEMENT: f64 = 64.0;
/// Length of the path of a corner from its exact to its computed position, in noises.
const PATH: f64 = 6.0;
/// Area of a triangle without an accurate height, as a share of the square of its size.
const THIN: f64 = 64.0 * f64::EPSILON;
/// Maximum number of cells of the grid that contain a facet, on average.
const MAX_CELLS_OF_FACET: u64 = 16;
/// Number of pairs of boxes that are compared at the cost of one pair of facets.
const BOXES_PER_PAIR: u64 = 16;

/// A convex polygon. Each corner has two coordinates, the height of the upper facet and that of the lower one.
#[derive(Clone, Copy)]
struct Polygon {
    corners: [DVec4; MAX_CORNERS],
    count: usize,
}

impl Polygon {
    fn corners(&self) -> &[DVec4] {
        &self.corners[..self.count]
    }

    /// Returns the part where a linear function is not negative; `None` if rounding errors give it too many corners.
    #[inline]
    fn cut(&self, value: impl Fn(DVec4) -> f64) -> Option<Self> {
        let mut values = [0.0; MAX_CORNERS];
        let mut least = f64::INFINITY;
        for (value_at, corner) in values.iter_mut().zip(self.corners()) {
            *value_at = value(*corner);
            least = least.min(*value_at);
        }
        if least >= 0.0 {
            return Some(*self);
        }
        let mut kept = Self { corners: [DVec4::ZERO; MAX_CORNERS], count: 0 };
        for (i, &p) in self.corners().iter().enumerate() {
            let next = if i + 1 == self.count { 0 } else { i + 1 };
            let (from, to) = (values[i], values[next]);
            if from >= 0.0 {
                kept.push(p)?;
            }
            if (from >= 0.0) != (to >= 0.0) {
                kept.push(p + (self.corners[next] - p) * (from / (from - to)))?;
            }
        }
        Some(kept)
    }

    fn push(&mut self, corner: DVec4) -> Option<()> {
        *self.corners.get_mut(self.count)? = corner;
        self.count += 1;
        Some(())
    }

    /// Returns the polygon with other corners.
    fn mapped(&self, map: impl Fn(DVec4) -> DVec4) -> Self {
        let mut mapped = *self;
        for corner in &mut mapped.corners[..self.count] {
            *corner = map(*corner);
        }
        mapped
    }

    /// Returns the part with values up to `limit` and, if there is one, that with larger values.
    fn split(&self, limit: f64, value: impl Fn(DVec4) -> f64) -> Option<[Option<Self>; 2]> {
        let exceeds = self.corners().iter().any(|p| value(*p) > limit);
        let beyond = if exceeds { Some(self.cut(|p| value(p) - limit)?) } else { None };
        Some([Some(self.cut(|p| limit - value(p))?), beyond])
    }

    /// Returns the volume between the lower and the upper facet, where the latter is higher, within the room.
    fn volume_between(&self, height: f64) -> Option<f64> {
        let within = self.cut(|p| p.z)?.cut(|p| height - p.w)?;
        let [below, above] = within.split(height, |p| p.z)?;
        let above = above.map(|part| part.mapped(|p| DVec4::new(p.x, p.y, height, p.w)));
        let mut sum = 0.0;
        for part in [below, above].into_iter().flatten() {
            let [above, below] = part.split(0.0, |p| -p.w)?;
            let below = below.map(|part| part.mapped(|p| DVec4::new(p.x, p.y, p.z, 0.0)));
            for part in [above, below].into_iter().flatten() {
                sum += part.cut(|p| p.z - p.w)?.volume();
            }
        }
        Some(sum)
    }

    /// Returns the volume between both facets.
    fn volume(&self) -> f64 {
        let Some((a, rest)) = self.corners().split_first() else { return 0.0 };
        let gap = |p: DVec4| p.z - p.w;
        let triangle = |pair: &[DVec4]| {
            let area = (pair[0] - *a).xy().perp_dot((pair[1] - *a).xy());
            area * (gap(*a) + gap(pair[0]) + gap(pair[1]))
        };
        rest.windows(2).map(triangle).sum::<f64>() / 6.0
    }
}

/// A facet in the coordinates of the room.
#[derive(Clone, Copy)]
struct Facet {
    /// Corners, counter-clockwise as seen from above.
    corners: [DVec3; 3],
    bounds: Aabb,
    /// 1 if the facet faces upwards, otherwise -1.
    sign: f64,
    /// Whether the projection has hardly an area.
    is_thin: bool,
}

impl Facet {
    /// Builds a facet; `None` if its projection has no area because it is parallel to an axis.
    fn new(mut corners: Corners) -> Option<Self> {
        let bounds = Aabb::from_triangle(corners);
        let sides = bounds.side_lengths().xy();
        if sides.min_element() <= 0.0 {
            return None;
        }
        let [a, b, c] = corners;
        let area = (b - a).xy().perp_dot((c - a).xy());
        let sign = if area < 0.0 { -1.0 } else { 1.0 };
        if area < 0.0 {
            corners.swap(1, 2);
        }
        let is_thin = area.abs() <= THIN * sides.element_sum().powi(2);
        Some(Self { corners, bounds, sign, is_thin })
    }

    /// Returns twice the area of the triangle of an edge and a point, positive on the inner side of the edge.
    #[inline]
    fn beside(&self, edge: usize, point: DVec4) -> f64 {
        let (a, b) = (self.corners[edge], self.corners[(edge + 1) % 3]);
        (b.x - a.x) * (point.y - a.y) - (b.y - a.y) * (point.x - a.x)
    }

    /// Checks whether the projection contains a point.
    fn covers(&self, point: DVec4) -> bool {
        !self.is_thin && (0..3).all(|edge| self.beside(edge, point) >= 0.0)
    }

    /// Returns the height at a point of the projection.
    #[inline]
    fn height_at(&self, point: DVec4) -> f64 {
        let weights = [1, 2, 0].map(|edge| self.beside(edge, point).max(0.0));
        let total = weights[0] + weights[1] + weights[2];
        if total <= 0.0 {
            return self.corners[0].z;
        }
        let [a, b, c] = self.corners.map(|corner| corner.z);
        (weights[0] * a + weights[1] * b + weights[2] * c) / total
    }
}

/// A facet above another one: the part of its projection in the room.
struct Upper {
    part: Polygon,
    /// Box of the part.
    low: DVec2,
    high: DVec2,
}

impl Upper {
    /// Builds the part of a facet in the room, which may be empty; `None` if it has too many corners.
    fn new(facet: &Facet, sides: DVec3) -> Option<Self> {
        let mut part = Polygon { corners: [DVec4::ZERO; MAX_CORNERS], count: 0 };
        for corner in facet.corners {
            part.push(corner.extend(0.0))?;
        }
        let part = part.cut(|p| p.x)?.cut(|p| p.y)?.cut(|p| sides.x - p.x)?;
        let part = part.cut(|p| sides.y - p.y)?;
        let start = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        let corners = part.corners().iter();
        let (low, high) = corners.fold(start, |(l, h), p| (l.min(p.xy()), h.max(p.xy())));
        Some(Self { part, low, high })
    }

    /// Returns the volume between this facet and a lower one, within the room, and a point of its base.
    fn volume_above(&self, lower: &Facet, height: f64) -> Option<(f64, DVec2)> {
        let mut part = self.part;
        for edge in 0..3 {
            part = part.cut(|p| lower.beside(edge, p))?;
            if part.count < 3 {
                return Some((0.0, DVec2::ZERO));
            }
        }
        let middle = part.corners().iter().map(|p| p.xy()).sum::<DVec2>() / part.count as f64;
        let part = part.mapped(|p| p.xyz().extend(lower.height_at(p)));
        Some((part.volume_between(height)?, middle))
    }
}

/// A value and a bound of its error.
#[derive(Clone, Copy, Default)]
struct Bounded {
    value: f64,
    error: f64,
}

/// Facets in the cells of a grid over the base of the room.
struct Grid<'f> {
    facets: &'f [Facet],
    counts: [usize; 2],
    cell: DVec2,
    /// For each cell the start of its list in `items`, and the end of the last one.
    starts: Vec<u32>,
    items: Vec<u32>,
}

impl<'f> Grid<'f> {
    /// Builds the grid. Its cells have about the mean size of the facets.
    fn new(facets: &'f [Facet], sides: DVec2) -> Self {
        let number = facets.len().max(1) as f64;
        let mean = facets.iter().map(|f| clipped_sides(f, sides)).sum::<DVec2>() / number;
        let finest = (2.0 * number.sqrt()).ceil();
        let mut counts = (sides / mean.max(sides / finest)).floor().max(DVec2::ONE);
        let mut grid = Self { facets, counts: [1; 2], cell: sides, starts: vec![], items: vec![] };
        // Large facets among many small ones are in many cells. Coarser cells bound the memory.
        let ranges = loop {
            grid.counts = [counts.x as usize, counts.y as usize];
            grid.cell = sides / counts;
            let cells = |f: &Facet| grid.cells(f.bounds.low.xy(), f.bounds.high.xy());
            let ranges: Vec<[[usize; 2]; 2]> = facets.iter().map(cells).collect();
            let entries: u64 = ranges.iter().map(|range| number_of_cells(*range)).sum();
            if entries <= MAX_CELLS_OF_FACET * facets.len() as u64 || counts == DVec2::ONE {
                break ranges;
            }
            let halved =
                if counts.x >= counts.y { DVec2::new(0.5, 1.0) } else { DVec2::new(1.0, 0.5) };
            counts = (counts * halved).ceil();
        };
        let counts = grid.counts;
        grid.starts = vec![0; counts[0] * counts[1] + 1];
        let mut lists = vec![0_u32; grid.starts.len()];
        for range in &ranges {
            visit_cells(*range, |x, y| lists[y * counts[0] + x + 1] += 1);
        }
        for k in 1..lists.len() {
            lists[k] += lists[k - 1];
        }
        grid.items = vec![0; lists[lists.len() - 1] as usize];
        grid.starts.copy_from_slice(&lists);
        for (k, range) in ranges.iter().enumerate() {
            visit_cells(*range, |x, y| {
                let next = &mut lists[y * counts[0] + x];
                grid.items[*next as usize] = k as u32;
                *next += 1;
            });
        }
        grid
    }

    /// Returns the first and the last cell of a rectangle along both axes.
    fn cells(&self, low: DVec2, high: DVec2) -> [[usize; 2]; 2] {
        let cell = |at: DVec2| {
            let at = (at / self.cell).max(DVec2::ZERO);
            [(at.x as usize).min(self.counts[0] - 1), (at.y as usize).min(self.counts[1] - 1)]
        };
        [cell(low), cell(high)]
    }

    /// Returns the facets in a cell.
    fn list(&self, x: usize, y: usize) -> &[u32] {
        let at = y * self.counts[0] + x;
        &self.items[self.starts[at] as usize..self.starts[at + 1] as usize]
    }
}

/// Returns the number of cells of a range.
fn number_of_cells([from, to]: [[usize; 2]; 2]) -> u64 {
    (to[0] - from[0] + 1) as u64 * (to[1] - from[1] + 1) as u64
}

/// Calls a function for each cell of a range.
fn visit_cells([from, to]: [[usize; 2]; 2], mut take: impl FnMut(usize, usize)) {
    for y in from[1]..=to[1] {
        for x in from[0]..=to[0] {
            take(x, y);
        }
    }
}

/// Returns the sides of the projection of a facet within the room.
fn clipped_sides(facet: &Facet, sides: DVec2) -> DVec2 {
    let Aabb { low, high } = facet.bounds;
    (high.xy().min(sides) - low.xy().max(DVec2::ZERO)).max(DVec2::ZERO)
}

/// The facets of a body that may be above or below points of the room.
struct Column {
    /// Facets that reach above the bottom of the room.
    above: Vec<Facet>,
    /// Facets that reach below its top.
    below: Vec<Facet>,
    /// Number of all facets above, in and below the room.
    count: usize,
    /// Bound of the volume in the room through which computed facets moved from their exact places.
    moved: f64,
    /// Whether the body is proven to have no winding number other than 0 and 1.
    is_simple: bool,
}

impl Column {
    /// Collects the facets of a body above and below a room, with the heights along `axis`.
    fn new(scene: &PairFrame, body: &PlacedBody, room: &Aabb, axis: usize) -> Self {
        let mut around = *room;
        (around.low[axis], around.high[axis]) = (f64::NEG_INFINITY, f64::INFINITY);
        let [sides, low] = [room.side_lengths(), room.low].map(|v| upright(v, axis));
        let near = near_facets(scene, body, &around);
        let count = near.len();
        let (mut above, mut below, mut moved) = (Vec::new(), Vec::new(), 0.0);
        for corners in near {
            let corners = corners.map(|corner| upright(corner, axis) - low);
            let bounds = Aabb::from_triangle(corners).expanded(4.0 * scene.noise);
            let part = bounds.high.min(sides) - bounds.low.max(DVec3::ZERO);
            if part.min_element() >= 0.0 {
                moved += PATH * scene.noise * part.dot(part.yzx());
            }
            let Some(facet) = Facet::new(corners) else { continue };
            if facet.bounds.high.z > 0.0 {
                above.push(facet);
            }
            if facet.bounds.low.z < sides.z {
                below.push(facet);
            }
        }
        let is_simple = ConvexBody::cached(body.solid).is_some_and(|convex| convex.is_star_shaped);
        Self { above, below, count, moved, is_simple }
    }
}

/// Returns the middle of the longest interval inside both bodies above a point of the base; `None` if there is none.
fn inner_height(above: &[Facet], below: &[Facet], at: DVec2) -> Option<f64> {
    let point = DVec4::new(at.x, at.y, 0.0, 0.0);
    let heights = |facets: &[Facet], body: usize| -> Vec<(f64, usize, f64)> {
        let hit = facets.iter().filter(|facet| facet.covers(point));
        hit.map(|facet| (facet.height_at(point), body, facet.sign)).collect()
    };
    let mut all = [heights(above, 0), heights(below, 1)].concat();
    all.sort_by(|f, g| f.0.total_cmp(&g.0));
    let mut winding = [all.iter().filter(|hit| hit.1 == 0).map(|hit| hit.2).sum::<f64>(), 0.0];
    let mut best = (0.0, None);
    for pair in all.windows(2) {
        let (low, body, sign) = pair[0];
        winding[body] -= sign;
        let length = pair[1].0 - low;
        if winding.iter().all(|number| *number > 0.5) && length > best.0 {
            best = (length, Some(low + 0.5 * length));
        }
    }
    best.1
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

/// Estimates the number of pairs of facets with a common projection.
fn expected_pairs(above: &[Facet], below: &[Facet], sides: DVec2) -> f64 {
    let total = |facets: &[Facet]| facets.iter().map(|f| clipped_sides(f, sides)).sum::<DVec2>();
    let [n, m] = [above.len(), below.len()].map(|count| count as f64);
    let mean = total(above) / n.max(1.0) + total(below) / m.max(1.0);
    n * m * (mean / sides).min(DVec2::ONE).element_product()
}

/// Sums over pairs of facets in one room.
struct Sums {
    sides: DVec3,
    noise: f64,
    /// Number of pairs of boxes that may still be compared.
    budget: u64,
    /// Volume between the facets of the largest prism that counts positive, and a point of its base.
    largest: (f64, DVec2),
}

impl Sums {
    /// Returns the integral of the product of two winding numbers over the room; `None` if that takes too many pairs.
    /// The first one is given by the facets above a point, the second one by those below.
    fn product(&mut self, above: &[Facet], below: &[Facet]) -> Option<Bounded> {
        let Self { sides, noise, .. } = *self;
        let grid = Grid::new(below, sides.xy());
        let (mut sum, mut magnitude, mut error, mut pairs) = (0.0, 0.0, 0.0, 0_u64);
        for facet in above {
            let upper = Upper::new(facet, sides)?;
            if upper.part.count < 3 {
                continue;
            }
            let range = grid.cells(upper.low, upper.high);
            for y in range[0][1]..=range[1][1] {
                for x in range[0][0]..=range[1][0] {
                    let list = grid.list(x, y);
                    self.budget = self.budget.checked_sub(1 + list.len() as u64)?;
                    for &k in list {
                        let lower = &grid.facets[k as usize];
                        let low = upper.low.max(lower.bounds.low.xy());
                        let high = upper.high.min(lower.bounds.high.xy());
                        let is_here = || grid.cells(low, low)[0] == [x, y];
                        if low.cmpgt(high).any()
                            || facet.bounds.high.z <= lower.bounds.low.z
                            || !is_here()
                        {
                            continue;
                        }
                        self.budget = self.budget.checked_sub(BOXES_PER_PAIR)?;
                        pairs += 1;
                        let size = lower.bounds.side_lengths();
                        error += 2.0 * DISPLACEMENT * (high - low + noise).element_sum() * sides.z
                            + (size.x + size.y) * size.z.max(sides.z);
                        if facet.is_thin || lower.is_thin {
                            continue;
                        }
                        let (part, middle) = upper.volume_above(lower, sides.z)?;
                        let sign = -facet.sign * lower.sign;
                        sum += sign * part;
                        magnitude += part.abs();
                        if sign * part > self.largest.0 {
                            self.largest = (part, middle);
                        }
                    }
                }
            }
        }
        let error = error * noise + pairs as f64 * (f64::EPSILON * magnitude + f64::MIN_POSITIVE);
        Some(Bounded { value: sum, error })
    }

    /// Returns the integral of a winding number over the room, from the facets above its points.
    fn integral(&self, above: &[Facet]) -> Option<Bounded> {
        let Self { sides, noise, .. } = *self;
        let (mut sum, mut magnitude, mut error) = (0.0, 0.0, 0.0);
        for facet in above {
            let upper = Upper::new(facet, sides)?;
            if upper.part.count < 3 {
                continue;
            }
            error += 2.0 * DISPLACEMENT * (upper.high - upper.low + noise).element_sum() * sides.z;
            if !facet.is_thin {
                let part = upper.part.volume_between(sides.z)?;
                sum += facet.sign * part;
                magnitude += part.abs();
            }
        }
        let count = above.len() as f64;
        let error = error * noise + count * (f64::EPSILON * magnitude + f64::MIN_POSITIVE);
        Some(Bounded { value: sum, error })
    }

    /// Returns a bound of the integral of `w^2 - w` over the room, for the winding number `w` of a body.
    fn excess(&mut self, body: &Column) -> Option<f64> {
        if body.is_simple {
            // The number differs from 0 and 1 only where computed facets have moved, by the number of facets at most.
            return Some((body.count as f64 + 1.0) * body.moved);
        }
        let [square, linear] =
            [self.product(&body.above, &body.below)?, self.integral(&body.above)?];
        Some((square.value - linear.value).max(0.0) + square.error + linear.error)
    }

    /// Returns bounds of the volume of the common part, and a point of the base below its largest prism.
    fn common(&mut self, upper: &Column, lower: &Column) -> Option<([f64; 2], DVec2)> {
        let both = self.product(&upper.above, &lower.below)?;
        let base = self.largest.1;
        let others = self.excess(upper)? + self.excess(lower)?;
        let error = both.error + others + upper.moved + lower.moved;
        let error = error * (1.0 + 1e-9) + 4.0 * f64::EPSILON * both.value.abs();
        let bounds = [(both.value - error).max(0.0), both.value + error];
        (bounds[0] <= bounds[1] && bounds[1].is_finite()).then_some((bounds, base))
    }
}

/// The volume of the common part of two bodies in a box, in the setting frame.
pub(super) struct CommonVolume {
    /// Lower and upper bound. They are far apart if a body covers a part of the box more than once.
    pub(super) bounds: [f64; 2],
    /// Point that is inside both bodies, unless rounding errors displace it.
    pub(super) point: Option<DVec3>,
}

/// Computes the volume of the common part of two bodies in a box; `None` if that takes more than `max_pairs` pairs of
/// facets.
pub(super) fn common_volume(
    scene: &PairFrame,
    room: &Aabb,
    max_pairs: u64,
) -> Option<CommonVolume> {
    // The axis and the order of the bodies with the least expected number of pairs.
    let choices = (0..3).map(|axis| {
        let sides = upright(room.side_lengths(), axis);
        let [a, b] = [true, false].map(|moving| Column::new(scene, scene.side(moving), room, axis));
        let pairs = |f: &Column, g: &Column| expected_pairs(&f.above, &g.below, sides.xy());
        let own = |f: &Column| if f.is_simple { 0.0 } else { pairs(f, f) };
        let columns = if pairs(&b, &a) < pairs(&a, &b) { [b, a] } else { [a, b] };
        let work = pairs(&columns[0], &columns[1]) + own(&columns[0]) + own(&columns[1]);
        (work, axis, columns)
    });
    let (work, axis, [upper, lower]) = choices.min_by(|f, g| f.0.total_cmp(&g.0))?;
    if work > max_pairs as f64 {
        return None;
    }
    let (sides, noise) = (upright(room.side_lengths(), axis), scene.noise);
    let largest = (0.0, 0.5 * sides.xy());
    let mut sums = Sums { sides, noise, budget: BOXES_PER_PAIR * max_pairs, largest };
    let (bounds, base) = sums.common(&upper, &lower)?;
    let height = inner_height(&upper.above, &lower.below, base);
    let point = height.map(|height| room.low + lying(base.extend(height), axis));
    Some(CommonVolume { bounds, point })
}
