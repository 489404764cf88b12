//! The volume of the common part of two solids, by cells.
//!
//! - A cell is a box. The first one contains the common part, and a split cuts a cell at a plane perpendicular to an
//!   axis. Therefore the cells divide the first one exactly.
//! - Within a cell, the heights of the facets along the normal of the largest one are intervals. Between them lie
//!   *layers* of the cell that no facet meets. A layer is convex, so the exact side of one of its points is that of
//!   all.
//! - The volume of a cell's common part is at least that of its layers inside both bodies. It is at most that of the
//!   cell without its layers outside one of them. The cell with the largest difference is split next. Parallel flat
//!   parts of a surface need no split, and the difference decreases as the square of the cell's size where surfaces
//!   cross.
//!
//! Rounding, with the noise `N = 32 u S` of the scene; coordinates in the setting frame are at most `S`:
//!
//! - Corners are computed with an error below `2 N`, and the six cuts of a facet at a box add at most `0.7 N` each.
//!   Hence each point of a facet within a box is at most `6.2 N` from the computed polygon, if the cuts keep a distance
//!   of more than this from the box.
//! - Only the *inner box*, [`DELTA`] noises inside a cell, is decided. What surrounds it counts as undecided. Facets in
//!   the sides of a cell do not meet the inner box.
//! - Heights along a normal are computed with an error below `N / 4`. Intervals are widened by [`PAD`] noises, and a
//!   layer is narrowed by one more on each side when its volume is computed.
//! - The frame between a cell and its inner box stays undecided. It counts in the difference of the bounds, but not in
//!   the box of the common part, from which parts thinner than two frames may be missing.
//! - A share of a box ([`share_below`]) is a mean of values between 0 and 1 without cancellation, computed with an
//!   error of some `10 u`, less than [`SHARE_ERROR`].

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use glam::DVec3;

use crate::body::Solid;
use crate::body::tree::Node;
use crate::solve::inside::winding_number;
use crate::solve::nearest::search::facet_corners;
use crate::solve::nearest::triangle::Corners;
use crate::solve::projected::Projected;
use crate::solve::scene::{ExactPoint, PairFrame, PlacedBody};
use colltrans_convex::body::Aabb;
use colltrans_kernel::extended::ExtendedPoint;
use colltrans_kernel::integer::Integer;
use colltrans_kernel::range::with_tiny_components_zeroed;

/// Depth of the inner box below the sides of a cell, in noises.
const DELTA: f64 = 64.0;
/// Distance from the facets of a cell to its layers, in noises.
const PAD: f64 = 8.0;
/// Bound on the error of [`share_below`].
const SHARE_ERROR: f64 = 256.0 * f64::EPSILON;
/// Number of levels of the tree whose boxes bound a body.
const BOX_LEVELS: u32 = 7;
/// Maximum number of facets that are clipped, as a multiple of the maximum number of cells.
const FACETS_PER_CELL: u64 = 64;
/// Maximum number of layers of a cell whose sides are decided, the largest first.
const MAX_LAYERS: usize = 64;
/// Work of deciding the sides of a layer, in clipped facets.
const WORK_OF_SIDES: u64 = 2;
/// Maximum number of times that all facets near the common part are clipped, in addition.
const ROUNDS_OF_FACETS: u64 = 8;
/// Share of a side of the box of the common part to which cells bound it.
const BOX_ACCURACY: f64 = 0.02;
/// Maximum number of corners of a triangle after six cuts, each of which may cross every second edge after rounding.
const MAX_CORNERS: usize = 32;
/// Share of the longest side of a cell that a cut in the plane of a facet leaves on both sides.
const LEAST_PART: f64 = 1.0 / 32.0;

/// The common part of two bodies, in the setting frame.
pub(super) struct CommonCells {
    /// Lower and upper bound of the volume.
    pub(super) volume: [f64; 2],
    /// Box of all cells that may contain a part of it; empty if there are none.
    pub(super) bounds: Aabb,
    /// Point of the largest layer inside both bodies.
    pub(super) point: Option<DVec3>,
    /// Number of cells.
    pub(super) cells: u32,
}

/// A point with exact coordinates in the setting frame, which is the query frame of a pair.
struct FreePoint(DVec3);

impl ExactPoint for FreePoint {
    fn query_position(&self) -> DVec3 {
        self.0
    }

    fn is_exact(&self) -> bool {
        true
    }

    fn exact_position(&self, _: &PairFrame) -> Option<DVec3> {
        Some(self.0)
    }

    fn integer_position<const N: usize>(&self, _: &PairFrame) -> [Integer<N>; 3] {
        self.0.to_array().map(Integer::exact_number)
    }

    fn double_double_position(&self, _: &PairFrame) -> ExtendedPoint {
        ExtendedPoint::from_exact(self.0)
    }
}

/// Returns the computed facets of the closed shells of a body that may meet a box, in the setting frame.
pub(super) fn near_facets(scene: &PairFrame, side: &PlacedBody, room: &Aabb) -> Vec<Corners> {
    near_triangles(scene, side, room).into_iter().map(|(_, corners)| corners).collect()
}

/// Returns the triangles of the closed shells of a body that may meet a box, with their computed corners in the setting
/// frame.
pub(super) fn near_triangles(
    scene: &PairFrame,
    side: &PlacedBody,
    room: &Aabb,
) -> Vec<(usize, Corners)> {
    let (mut open, mut near) = (vec![0_u32], Vec::new());
    while let Some(at) = open.pop() {
        let node = &side.solid.nodes()[at as usize];
        if !Projected::new(scene, side, at as usize).bounds.intersects(room) {
            continue;
        }
        if node.is_leaf() {
            let facets = leaf_facets(side, node);
            near.extend(facets.filter(|(_, f)| Aabb::from_triangle(*f).intersects(room)));
        } else {
            open.extend(node.child_positions(at));
        }
    }
    near
}

/// Returns the triangles of closed shells in a leaf, with their computed corners.
fn leaf_facets<'s>(
    side: &'s PlacedBody<'_>,
    leaf: &Node,
) -> impl Iterator<Item = (usize, Corners)> + 's {
    let solid: &Solid = side.solid;
    leaf.facets().filter(|t| !solid.is_open(*t)).map(move |t| (t, facet_corners(side, t)))
}

/// Returns a box around the closed shells of a body, except for rounding errors of corners: the union of the boxes of
/// nodes at the same depth of the tree.
fn body_box(scene: &PairFrame, side: &PlacedBody) -> Aabb {
    let node = |at: u32| &side.solid.nodes()[at as usize];
    let mut level = vec![0_u32];
    for _ in 0..BOX_LEVELS {
        level = level
            .into_iter()
            .flat_map(|at| {
                let parts = (!node(at).is_leaf()).then(|| node(at).child_positions(at));
                parts.into_iter().flatten().chain(parts.is_none().then_some(at))
            })
            .collect();
    }
    level.into_iter().fold(Aabb::EMPTY, |all, at| {
        all.union(&if node(at).is_leaf() {
            Aabb::from_points(leaf_facets(side, node(at)).flat_map(|(_, corners)| corners))
        } else {
            Projected::new(scene, side, at as usize).bounds
        })
    })
}

/// Returns a box that contains the common part of the closed shells of both bodies. It may be empty.
pub(super) fn common_box(scene: &PairFrame) -> Aabb {
    let [a, b] = [&scene.moving, &scene.fixed].map(|side| body_box(scene, side));
    Aabb { low: a.low.max(b.low), high: a.high.min(b.high) }.expanded(4.0 * scene.noise)
}

/// Returns the part of a triangle in a box, as a polygon.
pub(super) fn clipped(corners: Corners, within: &Aabb) -> Vec<DVec3> {
    let around = Aabb::from_triangle(corners);
    if !around.intersects(within) {
        return Vec::new();
    }
    if within.contains_box(&around) {
        return corners.to_vec();
    }
    let [mut first, mut second] = [[DVec3::ZERO; MAX_CORNERS]; 2];
    let (mut polygon, mut kept) = (&mut first, &mut second);
    polygon[..3].copy_from_slice(&corners);
    let mut count = 3;
    for (k, sign) in [(0, 1.0), (1, 1.0), (2, 1.0), (0, -1.0), (1, -1.0), (2, -1.0)] {
        let limit = if sign > 0.0 { within.high[k] } else { within.low[k] };
        let reaches_beyond =
            if sign > 0.0 { around.high[k] > limit } else { around.low[k] < limit };
        if !reaches_beyond {
            continue;
        }
        let is_within = |p: DVec3| (limit - p[k]) * sign >= 0.0;
        let mut next = 0;
        for i in 0..count {
            let (p, q) = (polygon[i], polygon[if i + 1 == count { 0 } else { i + 1 }]);
            if is_within(p) {
                kept[next] = p;
                next += 1;
            }
            if is_within(p) != is_within(q) {
                let mut between = p + (q - p) * ((limit - p[k]) / (q[k] - p[k]));
                between[k] = limit;
                kept[next] = between;
                next += 1;
            }
        }
        std::mem::swap(&mut polygon, &mut kept);
        count = next;
        if count == 0 {
            break;
        }
    }
    polygon[..count].to_vec()
}

/// Checks whether a box contains a point.
fn contains(Aabb { low, high }: &Aabb, point: DVec3) -> bool {
    low.cmple(point).all() && point.cmple(*high).all()
}

/// Returns twice the area of a convex polygon.
pub(super) fn double_area(polygon: &[DVec3]) -> f64 {
    let Some((first, rest)) = polygon.split_first() else { return 0.0 };
    rest.windows(2).map(|pair| (pair[0] - *first).cross(pair[1] - *first)).sum::<DVec3>().length()
}

/// Returns the mean of a function over `[0, length]`, which is a polynomial of degree 2 at most between the breaks.
fn mean<const N: usize>(length: f64, breaks: [f64; N], value: impl Fn(f64) -> f64) -> f64 {
    if length == 0.0 {
        return value(0.0);
    }
    let mut places = breaks.map(|at| at.clamp(0.0, length));
    places.sort_by(f64::total_cmp);
    let mut from = 0.0;
    let mut piece = |to: f64| {
        let width = (to - from) / length;
        let sum = value(from) + 4.0 * value(0.5 * (from + to)) + value(to);
        from = to;
        width * sum / 6.0
    };
    places.into_iter().chain([length]).map(&mut piece).sum()
}

/// Returns the share of the points of a box whose height above the lowest corner is below `height`. The heights of the
/// ends of the three sides are given; their sum is that of the highest corner. The share is the probability that a sum
/// of three uniform numbers is below `height`: a mean over two of them.
fn share_below(height: f64, sides: DVec3) -> f64 {
    let mut sides = sides.to_array();
    sides.sort_by(f64::total_cmp);
    let [a, b, c] = sides;
    let along_edge = |h: f64| (h / c).clamp(0.0, 1.0);
    let in_rectangle = |h: f64| mean(b, [h - c, h], |s| along_edge(h - s));
    mean(a, [height - b - c, height - c, height - b, height], |s| in_rectangle(height - s))
}

/// The points of a box between two heights along a normal.
struct Layer {
    heights: [f64; 2],
    /// Lower bound of its share of the box.
    share: f64,
    /// Exact point of the layer.
    point: DVec3,
}

impl Layer {
    /// Builds a layer of a box; `None` if it is empty or too thin.
    fn new(inner: &Aabb, normal: DVec3, heights: [f64; 2], noise: f64) -> Option<Self> {
        let is_rising = normal.cmpge(DVec3::ZERO);
        let lowest = DVec3::select(is_rising, inner.low, inner.high);
        let highest = DVec3::select(is_rising, inner.high, inner.low);
        let (sides, base) = ((normal * (highest - lowest)).abs(), normal.dot(lowest));
        let [from, to] = [heights[0] - base + noise, heights[1] - base - noise];
        let share = share_below(to, sides) - share_below(from, sides) - 2.0 * SHARE_ERROR;
        let total = sides.element_sum();
        let middle = 0.5 * (from.max(0.0) + to.min(total)) / total;
        let point = with_tiny_components_zeroed(lowest + (highest - lowest) * middle);
        let height = normal.dot(point);
        let is_within = heights[0] + noise < height && height < heights[1] - noise;
        let is_known = share > 0.0 && is_within && contains(inner, point);
        is_known.then_some(Self { heights, share, point })
    }
}

/// Returns the box of the points of a box whose height along a normal is at least `least`.
fn box_above(Aabb { low, high }: Aabb, normal: DVec3, least: f64) -> Aabb {
    let mut above = Aabb { low, high };
    let tops = (normal * low).max(normal * high);
    for k in 0..3 {
        let rest = (0..3).filter(|i| *i != k).map(|i| tops[i]).sum::<f64>();
        let from = ((least - rest) / normal[k]).clamp(low[k], high[k]);
        if normal[k] > 0.0 {
            above.low[k] = from;
        } else if normal[k] < 0.0 {
            above.high[k] = from;
        }
    }
    above
}

/// A box, and what is known about the common part in it.
struct Cell {
    bounds: Aabb,
    /// Facets that may meet the inner box, as positions in [`Search::facets`].
    facets: Vec<u32>,
    /// For each body none of whose facets meet the inner box, whether the inner box is inside it.
    sides: [Option<bool>; 2],
    /// Lower bound of the volume of the common part in this cell.
    lower: f64,
    /// Difference of both bounds.
    slack: f64,
    /// Box of what may be common.
    common: Aabb,
    /// Axis and coordinate of the next cut; `None` if a cut improves nothing.
    cut: Option<(usize, f64)>,
}

impl PartialEq for Cell {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Cell {}

impl PartialOrd for Cell {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Cell {
    fn cmp(&self, other: &Self) -> Ordering {
        self.slack.total_cmp(&other.slack)
    }
}

/// The facets near the common part, and the best point found.
struct Search<'s, 'a> {
    scene: &'s PairFrame<'a>,
    /// The facets, and whether they belong to the fixed body.
    facets: Vec<(Corners, bool)>,
    /// Volume and point of the largest layer inside both bodies.
    best: Option<(f64, DVec3)>,
    /// Number of facets clipped so far.
    work: u64,
}

impl CommonCells {
    /// The common part of bodies whose boxes have none.
    const NOTHING: Self = Self { volume: [0.0; 2], bounds: Aabb::EMPTY, point: None, cells: 1 };
}

impl Search<'_, '_> {
    /// Returns the number of facets that a search with at most `max_cells` cells may clip.
    fn max_work(&self, max_cells: u32) -> u64 {
        FACETS_PER_CELL * u64::from(max_cells) + ROUNDS_OF_FACETS * self.facets.len() as u64
    }

    /// Returns both parts of a cell; `None` if a cut improves nothing.
    fn parts(&mut self, cell: &Cell) -> Option<[Cell; 2]> {
        let (axis, place) = cell.cut?;
        let mut halves = [cell.bounds; 2];
        (halves[0].high[axis], halves[1].low[axis]) = (place, place);
        Some(halves.map(|half| self.cell(half, &cell.facets, cell.sides)))
    }

    /// Returns what all cells prove.
    fn result(&self, cells: &[Cell]) -> CommonCells {
        let [lower, slack] = sums(cells);
        let rounding = f64::EPSILON * (64.0 + cells.len() as f64);
        let bounds = cells.iter().fold(Aabb::EMPTY, |all, cell| all.union(&cell.common));
        CommonCells {
            volume: [lower * (1.0 - rounding), (lower + slack) * (1.0 + rounding)],
            bounds: bounds.expanded(2.0 * DELTA * self.scene.noise),
            point: self.best.map(|(_, point)| point),
            cells: cells.len() as u32,
        }
    }

    /// Returns whether a point is inside the moving (0) or the fixed body (1), exactly; `None` if it is on the surface.
    fn is_inside(&self, body: usize, point: DVec3) -> Option<bool> {
        let side = self.scene.side(body == 0);
        Some(winding_number(self.scene, side, &FreePoint(point))? > 0)
    }

    /// Builds a cell within another one, with these facets and known sides.
    fn cell(&mut self, bounds: Aabb, facets: &[u32], mut sides: [Option<bool>; 2]) -> Cell {
        let noise = self.scene.noise;
        self.work += facets.len() as u64;
        let volume = bounds.side_lengths().max(DVec3::ZERO).element_product();
        let inner = bounds.expanded(-DELTA * noise);
        if inner.side_lengths().min_element() <= 0.0 {
            let facets = Vec::new();
            return Cell {
                bounds,
                facets,
                sides,
                lower: 0.0,
                slack: volume,
                common: bounds,
                cut: None,
            };
        }
        let near = inner.expanded(0.5 * DELTA * noise);
        let mut polygons: Vec<(u32, Vec<DVec3>)> = facets
            .iter()
            .map(|&f| (f, clipped(self.facets[f as usize].0, &near)))
            .filter(|(_, polygon)| !polygon.is_empty())
            .collect();
        let has_facets = [false, true]
            .map(|fixed| polygons.iter().any(|(f, _)| self.facets[*f as usize].1 == fixed));
        let middle = with_tiny_components_zeroed(inner.center());
        for k in 0..2 {
            if !has_facets[k] && sides[k].is_none() && contains(&inner, middle) {
                sides[k] = self.is_inside(k, middle);
            }
        }
        if sides.contains(&Some(false)) {
            polygons.clear();
        }
        let (normal, layers) = self.layers(&inner, &polygons);
        let least = least_examined_share(&layers);
        self.work += WORK_OF_SIDES * layers.len().min(MAX_LAYERS) as u64;
        let (mut inside, mut outside) = (0.0, 0.0);
        // Heights of the lowest and the highest points that may be common.
        let mut heights = [f64::NEG_INFINITY, f64::INFINITY];
        for layer in layers {
            let volume = layer.share * inner.side_lengths().element_product();
            let is_examined = layer.share >= least;
            let side = |k: usize| {
                sides[k].or_else(|| is_examined.then(|| self.is_inside(k, layer.point)).flatten())
            };
            let known = match side(0) {
                Some(false) => [Some(false); 2],
                first => [first, side(1)],
            };
            if known.contains(&Some(false)) {
                outside += volume;
                if layer.heights[0] == heights[0] {
                    heights[0] = layer.heights[1];
                }
                if layer.heights[1] == f64::INFINITY {
                    heights[1] = layer.heights[0];
                }
            } else if known == [Some(true); 2] {
                inside += volume;
                if self.best.is_none_or(|(most, _)| volume > most) {
                    self.best = Some((volume, layer.point));
                }
            }
        }
        let is_decided = polygons.is_empty() && inside + outside > 0.0;
        let (cut, common) = if is_decided {
            (None, if outside > 0.0 { Aabb::EMPTY } else { bounds })
        } else {
            let above = box_above(bounds, normal, heights[0] - noise);
            (self.best_cut(&bounds, &polygons), box_above(above, -normal, -heights[1] - noise))
        };
        // A cell without a cut needs no facets.
        let facets =
            if cut.is_some() { polygons.iter().map(|(f, _)| *f).collect() } else { Vec::new() };
        let lower = inside * (1.0 - SHARE_ERROR);
        let slack = (volume - outside - lower).max(0.0) + SHARE_ERROR * volume;
        Cell { bounds, facets, sides, lower, slack, common, cut }
    }

    /// Returns the layers of an inner box between these polygons, and their normal. Without polygons there is one
    /// layer, the whole box.
    fn layers(&self, inner: &Aabb, polygons: &[(u32, Vec<DVec3>)]) -> (DVec3, Vec<Layer>) {
        let noise = self.scene.noise;
        let area = |(f, polygon): &(u32, Vec<DVec3>)| {
            let [a, b, c] = self.facets[*f as usize].0;
            let normal = (b - a).cross(c - a).try_normalize()?;
            Some((double_area(polygon), normal))
        };
        let largest = polygons.iter().filter_map(area).max_by(|f, g| f.0.total_cmp(&g.0));
        let normal = largest.map_or(DVec3::Z, |(_, normal)| normal);
        let range = |(_, polygon): &(u32, Vec<DVec3>)| {
            let heights = polygon.iter().map(|p| normal.dot(*p));
            heights.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], h| {
                [low.min(h - PAD * noise), high.max(h + PAD * noise)]
            })
        };
        let mut ranges: Vec<[f64; 2]> = polygons.iter().map(range).collect();
        ranges.sort_by(|f, g| f[0].total_cmp(&g[0]));
        ranges.push([f64::INFINITY; 2]);
        let mut layers = Vec::new();
        let mut from = f64::NEG_INFINITY;
        for [low, high] in ranges {
            if from < low {
                layers.extend(Layer::new(inner, normal, [from, low], noise));
            }
            from = from.max(high);
        }
        (normal, layers)
    }

    /// Returns the cut of a cell: in the plane of a facet perpendicular to an axis, if it is not near a side, or else
    /// in the middle of the longest side. `None` if the parts would be too thin.
    fn best_cut(&self, bounds: &Aabb, polygons: &[(u32, Vec<DVec3>)]) -> Option<(usize, f64)> {
        let sides = bounds.side_lengths();
        let (longest, thinnest) = (sides.max_position(), 4.0 * DELTA * self.scene.noise);
        if sides[longest] <= 2.0 * thinnest {
            return None;
        }
        let mut best =
            (thinnest.max(LEAST_PART * sides[longest]), longest, bounds.center()[longest]);
        for (_, polygon) in polygons {
            let Aabb { low, high } = Aabb::from_points(polygon.iter().copied());
            for k in (0..3).filter(|&k| high[k] - low[k] <= 4.0 * self.scene.noise) {
                let part = (low[k] - bounds.low[k]).min(bounds.high[k] - low[k]);
                if part > best.0 {
                    best = (part, k, low[k]);
                }
            }
        }
        Some((best.1, best.2))
    }
}

/// Returns the smallest share among the [`MAX_LAYERS`] largest layers.
fn least_examined_share(layers: &[Layer]) -> f64 {
    if layers.len() <= MAX_LAYERS {
        return 0.0;
    }
    let mut shares: Vec<f64> = layers.iter().map(|layer| layer.share).collect();
    *shares.select_nth_unstable_by(MAX_LAYERS - 1, |a, b| b.total_cmp(a)).1
}

/// Returns the sums of the lower bounds and of the differences of cells.
fn sums<'c>(cells: impl IntoIterator<Item = &'c Cell>) -> [f64; 2] {
    cells.into_iter().fold([0.0; 2], |[a, b], cell| [a + cell.lower, b + cell.slack])
}

/// Returns the search in the box of both bodies, and its first cell; `None` if the box is empty.
fn first_cell<'s, 'a>(scene: &'s PairFrame<'a>) -> Option<(Search<'s, 'a>, Cell)> {
    let room = common_box(scene);
    if !room.low.cmplt(room.high).all() {
        return None;
    }
    let facets: Vec<(Corners, bool)> = [true, false]
        .into_iter()
        .flat_map(|moving| {
            let near = near_facets(scene, scene.side(moving), &room);
            near.into_iter().map(move |facet| (facet, !moving))
        })
        .collect();
    let all: Vec<u32> = (0..facets.len() as u32).collect();
    let mut search = Search { scene, facets, best: None, work: 0 };
    let first = search.cell(room, &all, [None; 2]);
    Some((search, first))
}

/// Bounds the volume of the common part of two bodies to a relative `accuracy`, or as well as `max_cells` cells allow.
pub(super) fn common_cells(scene: &PairFrame, accuracy: f64, max_cells: u32) -> CommonCells {
    let Some((mut search, first)) = first_cell(scene) else { return CommonCells::NOTHING };
    let max_work = search.max_work(max_cells);
    // Running sums, computed anew when the number of cells has doubled. Their rounding errors affect only the end of
    // the search.
    let (mut lower, mut slack) = (first.lower, first.slack);
    let (mut open, mut done) = (BinaryHeap::from([first]), Vec::new());
    let mut count = 1_u32;
    while count < max_cells && search.work < max_work {
        if count.is_power_of_two() {
            [lower, slack] = sums(open.iter().chain(&done));
        }
        if slack <= 0.999 * accuracy * lower {
            break;
        }
        let Some(cell) = open.pop() else { break };
        let Some(parts) = search.parts(&cell) else {
            done.push(cell);
            continue;
        };
        lower += parts[0].lower + parts[1].lower - cell.lower;
        slack += parts[0].slack + parts[1].slack - cell.slack;
        open.extend(parts);
        count += 1;
    }
    done.extend(open);
    search.result(&done)
}

/// Bounds the box of the common part of two bodies to a relative [`BOX_ACCURACY`], or as well as `max_cells` cells allow.
///
/// For each side of the box in turn, the cell that extends to this side is split.
pub(super) fn box_cells(scene: &PairFrame, max_cells: u32) -> CommonCells {
    let Some((mut search, first)) = first_cell(scene) else { return CommonCells::NOTHING };
    let max_work = search.max_work(max_cells);
    let (mut cells, mut final_sides) = (vec![first], 0);
    for side in (0..6).cycle() {
        if final_sides == 6 || cells.len() >= max_cells as usize || search.work >= max_work {
            break;
        }
        let (k, is_upper) = (side % 3, side < 3);
        let whole = cells.iter().fold(Aabb::EMPTY, |all, cell| all.union(&cell.common));
        let beyond = |cell: &Cell| {
            let Aabb { low, high } = cell.common;
            if is_upper { high[k] } else { -low[k] }
        };
        let farthest =
            (0..cells.len()).max_by(|&i, &j| beyond(&cells[i]).total_cmp(&beyond(&cells[j])));
        let Some(at) = farthest else { break };
        // A cell without a proven part may contain nothing.
        let is_short = cells[at].lower > 0.0
            && cells[at].common.side_lengths()[k] <= BOX_ACCURACY * whole.side_lengths()[k];
        let parts = if is_short { None } else { search.parts(&cells[at]) };
        match parts {
            Some(parts) => {
                cells.swap_remove(at);
                cells.extend(parts);
                final_sides = 0;
            }
            None => final_sides += 1,
        }
    }
    search.result(&cells)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The volume below a plane is that of a corner, less the corners beyond the sides, and so on. The terms are exact
    /// in integers.
    #[test]
    fn shares_of_boxes_agree_with_volumes_of_corners() {
        for sides in [[1, 1, 1], [1, 2, 3], [7, 2, 2], [1, 1, 90], [50, 60, 1], [3, 4, 5]] {
            let [a, b, c] = sides;
            for height in -2..=a + b + c + 2 {
                let cube = |cut: i64| (height - cut).max(0).pow(3);
                let corners =
                    cube(0) - cube(a) - cube(b) - cube(c) + cube(a + b) + cube(b + c) + cube(a + c)
                        - cube(a + b + c);
                let exact = corners as f64 / (6 * a * b * c) as f64;
                let found = share_below(height as f64, DVec3::from_array(sides.map(|s| s as f64)));
                assert!((found - exact).abs() < SHARE_ERROR, "{sides:?} {height}: {found} {exact}");
            }
        }
    }

    #[test]
    fn shares_of_flat_boxes_are_those_of_rectangles_and_edges() {
        for thin in [0.0, 1e-300, 1e-18] {
            for (height, exact) in [(-1.0, 0.0), (0.5, 0.5), (2.0, 1.0), (f64::INFINITY, 1.0)] {
                let found = share_below(height, DVec3::new(thin, 1.0, thin));
                assert!((found - exact).abs() < SHARE_ERROR, "{thin} {height}: {found}");
            }
            for (height, exact) in [(0.5, 0.0625), (1.0, 0.25), (1.5, 0.5), (2.5, 0.9375)] {
                let found = share_below(height, DVec3::new(1.0, 2.0, thin));
                assert!((found - exact).abs() < SHARE_ERROR, "{thin} {height}: {found}");
            }
        }
    }
}
