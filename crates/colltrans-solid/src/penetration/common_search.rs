//! The search for the tree of a [`CommonPartCertificate`].
//!
//! - The cell with the largest undecided volume is cut next, in the plane of a facet or in the middle of its longest
//!   side. Of some candidates, the plane that leaves the cheapest parts is used: a part with `n` facets costs
//!   `n log(1 + n)`.
//! - Cuts are chosen by rounded numbers. Cells are divided and decided exactly, by the code that verifies the proof, so
//!   that the volume and the box are computed from the cells of the search, and the tree is walked only once.
//! - The search ends if no cell is undecided, if its work is done, or if the bounds of the volume are close enough. A
//!   small number of cells is always searched, so that the volume of simple bodies is exact.

use std::cmp::Ordering;
use std::collections::{BTreeMap, BinaryHeap};
use std::rc::Rc;

use glam::DVec3;

use super::common::VolumeOptions;
use super::common_certificate::{
    CommonNode, CommonPartCertificate, CommonPartError, ProvenCells, ProvenRelation, Work,
    bounds_body, box_planes, check_is_query, check_numbers, decide_side, has_sides, is_within,
    proves_relation, root_cell, verify_common_part,
};
use super::cuts::{Cell, Vertex};
use super::exact_pair::ExactPair;
use crate::body::Solid;
use colltrans_convex::body::Aabb;
use colltrans_convex::pair::Pair;
use colltrans_kernel::range::with_tiny_components_zeroed;

/// Maximum work of a search, an eighth of that of a verification.
const MAX_WORK: u64 = 5_000_000;
/// Number of cells that are searched even if the volume is accurate.
const LEAST_CELLS: usize = 1024;
/// Maximum number of cuts around a cell.
const MAX_DEPTH: u32 = 1024;
/// Maximum number of facets whose planes are candidates of a cut.
const CANDIDATES: usize = 8;
/// Distance from a plane, as a share of the size of a cell, up to which a corner counts as in the plane.
const ON_PLANE: f64 = 1e-9;
/// Maximum number of facets below which a point of one body alone is searched.
const WITNESS_FACETS: usize = 64;
/// Number of halvings of the distance of such a point from the facet.
const HALVINGS: i32 = 24;
/// Bits by which a side of a cell is longer than the grid of its cuts.
const GRID_BITS: i32 = 6;

/// Numbers of rounding errors by which the sides of a box are moved outwards, until it contains what it has to contain.
const OUTWARDS: [f64; 5] = [0.0, 2.0, 8.0, 64.0, 4096.0];

/// A cell that is not decided.
struct Open {
    volume: f64,
    /// Position of its node.
    node: usize,
    depth: u32,
    cell: Cell,
}

impl PartialEq for Open {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Open {}

impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Open {
    fn cmp(&self, other: &Self) -> Ordering {
        self.volume.total_cmp(&other.volume).then(other.node.cmp(&self.node))
    }
}

/// A tree: each node, and the positions of its children.
struct Tree {
    nodes: Vec<(CommonNode, Option<[usize; 2]>)>,
}

impl Tree {
    /// Returns the positions of the nodes in the order of the proof.
    fn in_order(&self) -> Vec<usize> {
        let (mut open, mut order) = (vec![0], Vec::with_capacity(self.nodes.len()));
        while let Some(at) = open.pop() {
            order.push(at);
            if let Some([behind, before]) = self.nodes[at].1 {
                open.extend([before, behind]);
            }
        }
        order
    }
}

/// A divided root: its tree, and the cells that are not outside a body, by the position of the node.
struct Divided {
    tree: Tree,
    cells: BTreeMap<usize, Cell>,
}

/// Computes the proof of the common part of two solids.
pub(super) fn certified_common_part(
    pair: &Pair<'_, Solid>,
    options: VolumeOptions,
) -> Result<CommonPartCertificate, CommonPartError> {
    check_is_query(pair)?;
    let exact = ExactPair::new(pair);
    let root = root_box(&exact);
    let (cell, contains) = root_cell(&exact, &root)?;
    let Divided { tree, cells } = search(&exact, cell, options);
    let (mut nodes, mut largest) = (Vec::with_capacity(tree.nodes.len()), Vec::new());
    let mut proven = ProvenCells::default();
    for at in tree.in_order() {
        let kind = tree.nodes[at].0;
        nodes.push(kind);
        if kind.is_cell() {
            proven.add(kind, || cells[&at].volume(exact.unit));
        }
        if kind == CommonNode::Both {
            keep_largest(&mut largest, &cells[&at]);
        }
    }
    let point = common_point(&exact, &largest);
    let relation = relation(&exact, &proven, contains, point.is_some());
    let bounds = bounds_of_cells(&exact, cells.values())?;
    let volume = proven.volume();
    let proof = CommonPartCertificate { volume, bounds, point, relation, root, nodes };
    check_numbers(&proof)?;
    debug_assert_eq!(verify_common_part(pair, &proof), Ok(volume[1] - volume[0]));
    Ok(proof)
}

/// Returns a box that contains some cells; `None` if there are none.
fn bounds_of_cells<'c>(
    exact: &ExactPair,
    cells: impl Iterator<Item = &'c Cell> + Clone,
) -> Result<Option<Aabb>, CommonPartError> {
    let corners = cells.clone().flat_map(|cell| cell.vertices().map(|at| at.near));
    let near = Aabb::from_points(corners);
    if near.low.x > near.high.x {
        return Ok(None);
    }
    let boxes = OUTWARDS.map(|steps| {
        let corner = |of: DVec3, is_high: bool| {
            let number = |axis: usize| moved_outwards(exact, of[axis], axis, is_high, steps);
            DVec3::from_array([number(0), number(1), number(2)])
        };
        let bounds = Aabb { low: corner(near.low, false), high: corner(near.high, true) };
        box_planes(exact, &bounds).map(|planes| (bounds, planes))
    });
    let mut boxes = boxes.into_iter().flatten().peekable();
    for (node, cell) in cells.enumerate() {
        while boxes.next_if(|(_, planes)| !is_within(planes, cell)).is_some() {}
        if boxes.peek().is_none() {
            return Err(CommonPartError::Bounds { node });
        }
    }
    Ok(boxes.next().map(|(bounds, _)| bounds))
}

/// Returns a number of the world that is at most, or at least, a rounded coordinate relative to the base point, by a
/// number of rounding errors.
fn moved_outwards(exact: &ExactPair, at: f64, axis: usize, is_high: bool, steps: f64) -> f64 {
    let base = exact.near_base[axis];
    let by = steps * f64::EPSILON * (at.abs() + base.abs() + f64::MIN_POSITIVE);
    let moved = base + at + if is_high { by } else { -by };
    with_tiny_components_zeroed(DVec3::splat(moved)).x
}

/// Returns a box that contains the common part: the common part of the boxes of both bodies or, if it has no interior,
/// one of these boxes.
fn root_box(exact: &ExactPair) -> Aabb {
    let boxes = exact.bodies.each_ref().map(|body| {
        let corners = body.corners().map(|corner| corner.near);
        corners.fold(Aabb::EMPTY, |all, at| Aabb { low: all.low.min(at), high: all.high.max(at) })
    });
    let is_thick = |bounds: &Aabb| bounds.low.cmplt(bounds.high).all();
    let common =
        Aabb { low: boxes[0].low.max(boxes[1].low), high: boxes[0].high.min(boxes[1].high) };
    let unit = Aabb { low: DVec3::ZERO, high: DVec3::ONE };
    let near = [common, boxes[0], boxes[1]].into_iter().find(is_thick).unwrap_or(unit);
    let side = |axis: usize, is_high: bool| {
        let at = if is_high { near.high[axis] } else { near.low[axis] };
        let numbers = OUTWARDS.map(|steps| moved_outwards(exact, at, axis, is_high, steps));
        let bounds = |number: &f64| {
            exact.coordinate_plane(axis, *number).is_some_and(|plane| {
                [0, 1].iter().any(|body| bounds_body(exact, *body, &plane, is_high))
            })
        };
        numbers.into_iter().find(bounds).unwrap_or(numbers[4])
    };
    let corner = |is_high| DVec3::from_array([0, 1, 2].map(|axis| side(axis, is_high)));
    Aabb { low: corner(false), high: corner(true) }
}

/// Decides a cell if possible. Returns its node, and whether a cut may decide more. `None` if the work is done.
fn decide(exact: &ExactPair, cell: &mut Cell, work: &mut Work) -> Option<(CommonNode, bool)> {
    let mut sides = [None; 2];
    let mut is_cut = false;
    for (body, side) in sides.iter_mut().enumerate() {
        if cell.fragments[body].is_empty() {
            *side = decide_side(exact, cell, body, work)?.ok();
        } else {
            is_cut = true;
        }
    }
    Some(match sides {
        [Some(false), _] => (CommonNode::OutsideMoving, false),
        [_, Some(false)] => (CommonNode::OutsideFixed, false),
        [Some(true), Some(true)] => (CommonNode::Both, false),
        _ => (CommonNode::Undecided, is_cut),
    })
}

/// A cell with its kind, and whether a cut may decide more.
struct Placed {
    kind: CommonNode,
    open: Open,
    is_cut: bool,
}

/// The state of a search.
struct Search<'e> {
    exact: &'e ExactPair,
    work: Work,
    tree: Tree,
    open: BinaryHeap<Open>,
    /// Cells that are not outside a body, and that no cut decides.
    cells: BTreeMap<usize, Cell>,
    /// Volumes of the cells inside both bodies and of those that are not decided.
    both: f64,
    undecided: f64,
}

impl Search<'_> {
    /// Decides the cell of a node. `None` if the work is done.
    fn place(&mut self, mut cell: Cell, node: usize, depth: u32) -> Option<Placed> {
        self.work.add_cell(&cell)?;
        let (kind, is_cut) = decide(self.exact, &mut cell, &mut self.work)?;
        let volume = match kind {
            CommonNode::Both | CommonNode::Undecided => cell.near_volume(),
            _ => 0.0,
        };
        Some(Placed { kind, open: Open { volume, node, depth, cell }, is_cut })
    }

    /// Stores the node of a cell, and the cell if it is not outside a body.
    fn add(&mut self, placed: Placed) {
        let Placed { kind, open, is_cut } = placed;
        self.tree.nodes[open.node].0 = kind;
        match kind {
            CommonNode::Both => self.both += open.volume,
            CommonNode::Undecided => self.undecided += open.volume,
            _ => return,
        }
        if is_cut && open.depth < MAX_DEPTH {
            self.open.push(open);
        } else {
            self.cells.insert(open.node, open.cell);
        }
    }

    /// Ends the search.
    fn end(mut self) -> Divided {
        self.cells.extend(self.open.into_iter().map(|open| (open.node, open.cell)));
        Divided { tree: self.tree, cells: self.cells }
    }
}

/// Divides the root until the bounds of the volume are close enough or the work is done.
fn search(exact: &ExactPair, root: Cell, options: VolumeOptions) -> Divided {
    let work = Work::new(exact, MAX_WORK);
    let tree = Tree { nodes: vec![(CommonNode::Undecided, None)] };
    let (open, cells) = (BinaryHeap::new(), BTreeMap::new());
    let mut search = Search { exact, work, tree, open, cells, both: 0.0, undecided: 0.0 };
    match search.place(root.clone(), 0, 0) {
        Some(placed) => search.add(placed),
        None => _ = search.cells.insert(0, root),
    }
    let mut count = 1;
    while let Some(open) = search.open.pop() {
        let is_accurate = search.undecided <= options.accuracy * search.both;
        if (is_accurate && count >= LEAST_CELLS) || count >= options.max_cells as usize {
            search.open.push(open);
            break;
        }
        let Some((kind, [behind, before])) = divide(exact, &open.cell) else {
            search.cells.insert(open.node, open.cell);
            continue;
        };
        let (first, depth) = (search.tree.nodes.len(), open.depth + 1);
        let placed = [search.place(behind, first, depth), search.place(before, first + 1, depth)];
        let [Some(behind), Some(before)] = placed else {
            search.open.push(open);
            break;
        };
        search.tree.nodes.extend([(CommonNode::Undecided, None); 2]);
        search.tree.nodes[open.node] = (kind, Some([first, first + 1]));
        count += 1;
        search.undecided = (search.undecided - open.volume).max(0.0);
        search.add(behind);
        search.add(before);
    }
    search.end()
}

/// A cut of a cell.
#[derive(Clone, Copy)]
struct Candidate {
    kind: CommonNode,
    /// Rounded plane.
    normal: DVec3,
    height: f64,
}

/// Returns the estimated cost of both parts of a cell.
fn cost_of(candidate: &Candidate, cell: &Cell, size: f64) -> f64 {
    let Candidate { normal, height, .. } = *candidate;
    let error = ON_PLANE * size * normal.length();
    let mut counts = [0_u32; 2];
    for fragment in cell.fragments.iter().flatten() {
        let heights =
            fragment.polygon.ring.iter().map(|corner| normal.dot(corner.at.near) - height);
        let (low, high) = heights.fold((0.0_f64, 0.0_f64), |(a, b), h| (a.min(h), b.max(h)));
        counts[0] += u32::from(low < -error);
        counts[1] += u32::from(high > error);
    }
    counts.map(|n| f64::from(n) * f64::from(1 + n).ln()).iter().sum()
}

/// Divides a cell; `None` if no plane does.
fn divide(exact: &ExactPair, cell: &Cell) -> Option<(CommonNode, [Cell; 2])> {
    let around = Aabb::from_points(cell.vertices().map(|at| at.near));
    let sides = around.side_lengths();
    let mut candidates: Vec<Candidate> =
        [0, 1].iter().flat_map(|k| planes_of(exact, cell, *k)).collect();
    let axis = sides.max_position();
    let (base, grid) = (exact.near_base[axis], grid_of(sides[axis]));
    let middle = ((base + around.center()[axis]) / grid).round() * grid;
    let kind = [CommonNode::X, CommonNode::Y, CommonNode::Z][axis](middle);
    candidates.push(Candidate { kind, normal: DVec3::AXES[axis], height: middle - base });
    let size = sides.max_element();
    let cost = |candidate: &Candidate| cost_of(candidate, cell, size);
    let mut sorted: Vec<(f64, Candidate)> = candidates.iter().map(|c| (cost(c), *c)).collect();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    sorted.into_iter().find_map(|(_, Candidate { kind, .. })| {
        let plane = kind.plane(exact).ok()?;
        Some((kind, cell.split(&plane, exact.unit)?))
    })
}

/// Returns the planes of some facets of a body in a cell, one of them of the largest part.
fn planes_of(exact: &ExactPair, cell: &Cell, body: usize) -> Vec<Candidate> {
    let fragments = &cell.fragments[body];
    let area = |k: &usize| {
        let ring = &fragments[*k].polygon.ring;
        let first = ring[0].at.near;
        let fan = ring[1..].windows(2);
        fan.map(|c| (c[0].at.near - first).cross(c[1].at.near - first))
            .sum::<DVec3>()
            .length_squared()
    };
    let largest = (0..fragments.len()).max_by(|a, b| area(a).total_cmp(&area(b)));
    let step = fragments.len().div_ceil(CANDIDATES).max(1);
    let candidate = |k: usize| {
        let triangle = fragments[k].triangle;
        let facet = exact.bodies[body].facet(triangle)?;
        let normal = facet.plane.near_normal();
        let kind = if body == 0 { CommonNode::Moving } else { CommonNode::Fixed }(triangle);
        Some(Candidate { kind, normal, height: normal.dot(facet.corners[0].near) })
    };
    largest.into_iter().chain((0..fragments.len()).step_by(step)).filter_map(candidate).collect()
}

/// Returns the power of two that is by [`GRID_BITS`] bits below a length.
fn grid_of(length: f64) -> f64 {
    let exponent = (length.to_bits() >> 52) as i32 - GRID_BITS;
    f64::from_bits((exponent.max(1023 - 200) as u64) << 52)
}

/// Returns a rounded point of the world.
fn in_world(exact: &ExactPair, at: DVec3) -> DVec3 {
    with_tiny_components_zeroed(exact.near_base + at)
}

/// Adds a cell to the [`CANDIDATES`] largest ones, which are sorted.
fn keep_largest<'c>(largest: &mut Vec<(f64, &'c Cell)>, cell: &'c Cell) {
    let volume = cell.near_volume();
    let at = largest.partition_point(|(other, _)| *other >= volume);
    if at < CANDIDATES {
        largest.truncate(CANDIDATES - 1);
        largest.insert(at, (volume, cell));
    }
}

/// Finds a point inside both bodies, in one of some cells inside both.
fn common_point(exact: &ExactPair, cells: &[(f64, &Cell)]) -> Option<DVec3> {
    cells.iter().find_map(|(_, cell)| {
        let point: Vertex = cell.interior_point(exact.unit)?;
        let at = in_world(exact, point.near);
        has_sides(exact, at, [true; 2]).then_some(at)
    })
}

/// The search for a point exceeds the limit of its work.
struct WorkDone;

/// Finds a point inside one body and outside the other one, below one of its facets; `None` if none is found.
fn point_of_one(
    exact: &ExactPair,
    body: usize,
    work: &mut Work,
) -> Result<Option<DVec3>, WorkDone> {
    let facets = &exact.bodies[body].facets;
    let far = {
        let corners = exact.bodies[body].corners().map(|corner| corner.near);
        Aabb::from_points(corners).side_lengths().length()
    };
    let inside = [body == 0, body == 1];
    let step = facets.len().div_ceil(WITNESS_FACETS).max(1);
    for facet in facets.iter().step_by(step) {
        let [a, b, c] = facet.corners.each_ref().map(|corner: &Rc<Vertex>| corner.near);
        let inwards = -facet.plane.near_normal().normalize_or_zero();
        for k in 2..HALVINGS {
            work.add_point().ok_or(WorkDone)?;
            let at = in_world(exact, (a + b + c) / 3.0 + inwards * far * 0.5_f64.powi(k));
            if has_sides(exact, at, inside) {
                return Ok(Some(at));
            }
        }
    }
    Ok(None)
}

/// Finds the strongest relation that is proven. `None` if there is none, also if the points of one body alone are not
/// found within the limit of the work.
fn relation(
    exact: &ExactPair,
    cells: &ProvenCells,
    contains: [bool; 2],
    has_point: bool,
) -> Option<ProvenRelation> {
    use ProvenRelation::{Crossing, Disjoint, FixedContained, MovingContained};
    let of_cells = [Disjoint, MovingContained, FixedContained];
    let is_proven = |of: &ProvenRelation| proves_relation(cells, contains, *of, has_point);
    if let Some(found) = of_cells.into_iter().find(is_proven) {
        return Some(found);
    }
    let [only_moving, only_fixed] = [DVec3::ZERO; 2];
    if !is_proven(&Crossing { only_moving, only_fixed }) {
        return None;
    }
    let mut work = Work::new(exact, MAX_WORK);
    let mut point = |body: usize| point_of_one(exact, body, &mut work).ok().flatten();
    Some(Crossing { only_moving: point(0)?, only_fixed: point(1)? })
}
