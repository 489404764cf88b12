//! Proof that translations cannot separate two bodies, by cells of displacements that enclose a body, and its
//! check.
//!
//! A cell is *open*, or *blocked* if the bodies overlap for all of its displacements. The proof consists of
//! open cells that contain the initial placement, and of blocked cells. Every side of an open cell is covered
//! by open or blocked cells, and no open cell is at the boundary of the octree. Therefore a path out of the
//! open cells passes through a point of a blocked cell.
//!
//! The search starts with one cell. While open cells lead from the initial placement to the boundary, it
//! divides the largest of them in which surfaces may meet. If there is no such cell, the open cells propose a
//! path, which casts have to prove. At the maximum depth the search ends without a result. Derivation:
//! `docs/theory/displacement-cells.md`.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashMap, HashSet, VecDeque};
use std::sync::atomic::{AtomicBool, Ordering};

use glam::{DMat3, DVec3};

use super::cells::{
    CellSide, Crossing, DisplacedBodies, DisplacementCell, DisplacementGrid, DisplacementRange,
    MAX_DEPTH, SIDES, are_independent,
};
use super::pairs::initial_cast;
use crate::directions::{Bodies, FreeError};
use colltrans_convex::answer::CertificateError;
use colltrans_convex::body::{Aabb, Placed};
use colltrans_convex::setting::error::QueryError;
use colltrans_solid::SolidScene;
use colltrans_solid::body::{AsSolid, Solid};

/// Maximum number of crossings that are tried first in a new cell.
const MAX_RECENT: usize = 48;
/// Maximum number of node visits of a cell.
const MAX_NODE_VISITS: usize = 4_000;
/// Maximum number of pairs of facets that are tried for a cell.
const MAX_FACET_PAIRS: usize = 400;

/// Proof that no sequence of translations separates two bodies. [`verify`](Self::verify) checks it.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct NoRemovalPath {
    /// Tolerance. Both bodies are offset inwards by half of it.
    pub tolerance: f64,
    /// Frame of the cells, which are sets of displacements of the moving body.
    pub room: DisplacementGrid,
    /// Open cells, in which the moving body may be.
    pub rooms: Vec<DisplacementCell>,
    /// Blocked cells, each with a crossing that proves an overlap for all of its displacements.
    pub walls: Vec<(DisplacementCell, Crossing)>,
}

impl NoRemovalPath {
    /// Returns the number of cells of the proof.
    pub fn cell_count(&self) -> usize {
        self.rooms.len() + self.walls.len()
    }

    /// Checks the proof against the bodies in their initial poses, without a search.
    ///
    /// # Errors
    /// Returns [`FreeError::NotProven`] for a cell that violates the conditions of the proof. Returns
    /// [`FreeError::Query`] or [`FreeError::Open`] for bodies that are rejected.
    pub fn verify<A: AsSolid, B: AsSolid>(
        &self,
        moving: &Placed<'_, A>,
        fixed: &Placed<'_, B>,
    ) -> Result<(), FreeError> {
        let a = moving.body.as_solid().map_err(QueryError::from)?.at(moving.pose);
        let b = fixed.body.as_solid().map_err(QueryError::from)?.at(fixed.pose);
        let refused = |entry: usize| Err(CertificateError::Cover { entry }.into());
        let all = || self.rooms.iter().chain(self.walls.iter().map(|wall| &wall.0));
        let proper = |cell: &DisplacementCell| {
            cell.depth <= MAX_DEPTH && cell.at.iter().all(|&x| x < 1 << cell.depth)
        };
        if !(self.room.is_valid() && all().all(proper)) {
            return refused(0);
        }
        let displaced = DisplacedBodies::new(offset_bodies([a, b], self.tolerance)?, self.room);
        let home = self.rooms.iter().any(|&cell| {
            let [low, high] = self.room.corners(cell);
            low.cmplt(DVec3::ZERO).all() && high.cmpgt(DVec3::ZERO).all()
        });
        if !home {
            return refused(0);
        }
        for (k, &(cell, crossing)) in self.walls.iter().enumerate() {
            if !displaced.crossing_blocks(crossing, &self.room.displacements(cell)) {
                return refused(self.rooms.len() + k);
            }
        }
        let known: HashSet<DisplacementCell> = all().copied().collect();
        for (k, &cell) in self.rooms.iter().enumerate() {
            for (axis, upper) in SIDES {
                let beside = cell.neighbour((axis, upper));
                if !beside.is_some_and(|beside| is_side_covered(&known, beside, (axis, !upper))) {
                    return refused(k);
                }
            }
        }
        Ok(())
    }
}

/// Checks whether known cells cover one side of a cell from within.
fn is_side_covered(
    known: &HashSet<DisplacementCell>,
    cell: DisplacementCell,
    side: CellSide,
) -> bool {
    let above = std::iter::successors(Some(cell), |cell| cell.parent());
    above.into_iter().any(|cell| known.contains(&cell)) || is_covered_by_children(known, cell, side)
}

fn is_covered_by_children(
    known: &HashSet<DisplacementCell>,
    cell: DisplacementCell,
    side: CellSide,
) -> bool {
    known.contains(&cell)
        || cell.depth < MAX_DEPTH
            && cell.children_at(side).all(|part| is_covered_by_children(known, part, side))
}

/// Returns axes for the cells: cross products of the normals of three independent walls, preferably the first
/// ones. For orthogonal walls these are the normals. Returns the axes of the world if no three are
/// independent.
pub(super) fn cell_axes(normals: &[DVec3]) -> DMat3 {
    for (k, &w) in normals.iter().enumerate() {
        for (l, &v) in normals[..k].iter().enumerate() {
            for &u in &normals[..l] {
                let [x, y, z] = [v.cross(w), w.cross(u), u.cross(v)].map(DVec3::normalize_or_zero);
                let axes = DMat3::from_cols(x, y, z);
                if are_independent(axes) {
                    return near_world_axes(axes);
                }
            }
        }
    }
    DMat3::IDENTITY
}

/// Permutes and reverses the columns so that each is close to the axis of the world with the same index.
fn near_world_axes(axes: DMat3) -> DMat3 {
    let [x, y, z] = [axes.x_axis, axes.y_axis, axes.z_axis];
    let orders = [[x, y, z], [x, z, y], [y, x, z], [y, z, x], [z, x, y], [z, y, x]];
    let near = |[x, y, z]: &[DVec3; 3]| x.x.abs() + y.y.abs() + z.z.abs();
    let [x, y, z] = orders
        .into_iter()
        .fold([x, y, z], |best, order| if near(&order) > near(&best) { order } else { best });
    let toward = |axis: DVec3, along: f64| if along < 0.0 { DVec3::ZERO - axis } else { axis };
    DMat3::from_cols(toward(x, x.x), toward(y, y.y), toward(z, z.z))
}

/// Computes the bounding boxes of all nodes of a body, with its vertices transformed by a matrix.
fn node_boxes(displaced: &DisplacedBodies, moving: bool, transform: DMat3) -> Vec<Aabb> {
    let bodies = &displaced.bodies;
    let nodes = &bodies.nodes[usize::from(!moving)];
    let mut boxes: Vec<Aabb> = vec![Aabb::EMPTY; nodes.len()];
    // Children have larger indices than their parent.
    for (k, node) in nodes.iter().enumerate().rev() {
        boxes[k] = if node.is_facet() {
            let corners =
                displaced.triangle_corners(moving, bodies.leaf_triangle(moving, k as u32));
            Aabb::from_points(corners.map(|p| transform * p))
        } else {
            let children = node.children().map(|child| boxes[child as usize]);
            children.fold(Aabb::EMPTY, |all, child| all.union(&child))
        };
    }
    boxes
}

/// Checks that both bodies are closed, and offsets them.
fn offset_bodies(placed: [Placed<'_, Solid>; 2], tolerance: f64) -> Result<Bodies<'_>, FreeError> {
    for (which, body) in [("moving", &placed[0]), ("fixed", &placed[1])] {
        if !body.body.is_closed() {
            return Err(FreeError::Open { which });
        }
    }
    Ok(Bodies::new(initial_cast(placed, tolerance)?.checked_query_scene()?))
}

/// State of a cell.
#[derive(Clone, Copy)]
enum DisplacementState {
    /// Divided into eight cells.
    Divided,
    /// Open; the flag states whether surfaces may meet in the cell.
    Open(bool),
    Blocked(Crossing),
}

/// Search for a proof that two bodies cannot be separated by translations, or for a wide path.
pub(super) struct Enclosure<'a> {
    tolerance: f64,
    displaced: DisplacedBodies<'a>,
    room: DisplacementGrid,
    /// Bounding boxes of the nodes of each body, in multiples of the axes.
    boxes: [Vec<Aabb>; 2],
    states: HashMap<DisplacementCell, DisplacementState>,
    /// Crossings that blocked earlier cells, the most recent first.
    recent: VecDeque<Crossing>,
}

/// Result of a search with cells.
pub(super) enum EnclosureResult {
    /// No removal path exists.
    Proven(NoRemovalPath),
    /// Displacements of a possible removal path. At the last one the bodies are far apart.
    Way(Vec<DVec3>),
}

impl<'a> Enclosure<'a> {
    /// Starts a search for two bodies that are separated by a displacement of length `far`. Cells are aligned
    /// with `axes`, see [`cell_axes`].
    pub(super) fn new(
        placed: [Placed<'a, Solid>; 2],
        tolerance: f64,
        far: f64,
        axes: DMat3,
    ) -> Result<Self, FreeError> {
        let room = DisplacementGrid::around_origin(far, axes);
        let displaced = DisplacedBodies::new(offset_bodies(placed, tolerance)?, room);
        let boxes = [true, false].map(|moving| node_boxes(&displaced, moving, axes.inverse()));
        let (states, recent) = (HashMap::new(), VecDeque::new());
        let mut search = Self { tolerance, displaced, room, boxes, states, recent };
        search.classify_cell(DisplacementCell::ALL);
        Ok(search)
    }

    /// Continues the search until it has more than `most` cells or ends. Returns `None` in the first case, and
    /// if the cells at the maximum depth decide nothing.
    pub(super) fn continue_search(
        &mut self,
        most: usize,
        cancel: Option<&AtomicBool>,
    ) -> Result<Option<EnclosureResult>, FreeError> {
        while self.states.len() <= most {
            if cancel.is_some_and(|flag| flag.load(Ordering::Relaxed)) {
                return Err(FreeError::Cancelled);
            }
            let way = match self.explore_open_cells() {
                Ok((rooms, walls)) => {
                    let Self { tolerance, room, .. } = *self;
                    return Ok(Some(EnclosureResult::Proven(NoRemovalPath {
                        tolerance,
                        room,
                        rooms,
                        walls,
                    })));
                }
                Err(way) => way,
            };
            let may_be_cut = |cell: &&DisplacementCell| {
                cell.depth < MAX_DEPTH
                    && matches!(self.states[*cell], DisplacementState::Open(true))
            };
            let cut: Vec<DisplacementCell> = way.iter().filter(may_be_cut).copied().collect();
            let Some(least) = cut.iter().map(|cell| cell.depth).min() else {
                let wide = way.iter().all(|cell| cell.depth < MAX_DEPTH);
                return Ok(wide.then(|| EnclosureResult::Way(self.path_through(&way))));
            };
            for cell in cut.into_iter().filter(|cell| cell.depth == least) {
                self.states.insert(cell, DisplacementState::Divided);
                for part in cell.children() {
                    self.classify_cell(part);
                }
            }
        }
        Ok(None)
    }
}

type Walls = Vec<(DisplacementCell, Crossing)>;

impl Enclosure<'_> {
    /// Explores all open cells that are connected with the initial placement. Returns them and the adjacent
    /// blocked cells, or as an error the open cells of a path to the boundary.
    fn explore_open_cells(&self) -> Result<(Vec<DisplacementCell>, Walls), Vec<DisplacementCell>> {
        let mut home = DisplacementCell::ALL;
        while let DisplacementState::Divided = self.states[&home] {
            let inside = |part: &DisplacementCell| {
                let [low, high] = self.room.corners(*part);
                low.cmple(DVec3::ZERO).all() && high.cmpge(DVec3::ZERO).all()
            };
            home = home.children().into_iter().find(inside).unwrap_or(home.children()[0]);
        }
        let mut from = HashMap::from([(home, home)]);
        // Cells in which surfaces cannot meet come first, then large ones. So a wide path is found before narrow
        // cells are divided. Among equal cells the one nearest to the boundary comes first.
        let mut queue = BinaryHeap::from([(Reverse((false, 0, 0)), home)]);
        let (mut walls, mut around) = (Vec::new(), HashSet::new());
        let (mut rooms, mut touching) = (Vec::new(), Vec::new());
        while let Some((_, cell)) = queue.pop() {
            rooms.push(cell);
            for (axis, upper) in SIDES {
                let Some(beside) = cell.neighbour((axis, upper)) else {
                    let back =
                        |cell: &DisplacementCell| Some(from[cell]).filter(|before| before != cell);
                    let mut way: Vec<_> = std::iter::successors(Some(cell), back).collect();
                    way.reverse();
                    return Err(way);
                };
                touching.clear();
                self.adjacent_leaves(beside, (axis, !upper), &mut touching);
                for &leaf in &touching {
                    match self.states[&leaf] {
                        DisplacementState::Blocked(crossing) => {
                            if around.insert(leaf) {
                                walls.push((leaf, crossing));
                            }
                        }
                        _ if from.contains_key(&leaf) => (),
                        _ => {
                            from.insert(leaf, cell);
                            let may = matches!(self.states[&leaf], DisplacementState::Open(true));
                            queue
                                .push((Reverse((may, leaf.depth, leaf.boundary_distance())), leaf));
                        }
                    }
                }
            }
        }
        Ok((rooms, walls))
    }

    /// Returns the displacements of a path through adjacent cells, from the initial placement on.
    fn path_through(&self, way: &[DisplacementCell]) -> Vec<DVec3> {
        let (mut places, room) = (vec![DVec3::ZERO], self.room);
        let mut between = |low: DVec3, high: DVec3| places.push(room.axes * ((low + high) / 2.0));
        for pair in way.windows(2) {
            let [a, b] = [pair[0], pair[1]].map(|cell| room.corners(cell));
            // From the center of one cell through the center of the common side.
            between(a[0], a[1]);
            between(a[0].max(b[0]), a[1].min(b[1]));
        }
        let [low, high] = room.corners(way[way.len() - 1]);
        between(low, high);
        places
    }

    /// Adds the undivided cells that lie inside a cell and touch one of its sides to `found`. If the cell is
    /// smaller than the undivided cell that contains it, adds that one.
    fn adjacent_leaves(
        &self,
        cell: DisplacementCell,
        side: CellSide,
        found: &mut Vec<DisplacementCell>,
    ) {
        match self.states.get(&cell) {
            None => found.extend(
                std::iter::successors(cell.parent(), |cell| cell.parent())
                    .find(|cell| self.states.contains_key(cell)),
            ),
            Some(DisplacementState::Divided) => {
                cell.children_at(side).for_each(|part| self.adjacent_leaves(part, side, found));
            }
            Some(_) => found.push(cell),
        }
    }

    /// Classifies a new cell.
    fn classify_cell(&mut self, cell: DisplacementCell) {
        let (by, corners) = (self.room.displacements(cell), self.room.corners(cell));
        let known =
            self.recent.iter().position(|&recent| self.displaced.crossing_blocks(recent, &by));
        let state = if let Some(k) = known {
            self.recent.swap(0, k);
            DisplacementState::Blocked(self.recent[0])
        } else if let Some(crossing) = self.find_crossing(&by, corners) {
            self.recent.push_front(crossing);
            self.recent.truncate(MAX_RECENT);
            DisplacementState::Blocked(crossing)
        } else {
            DisplacementState::Open(self.may_have_contact(&by, corners))
        };
        self.states.insert(cell, state);
    }

    /// Searches for an edge and a facet that block a whole cell. Returns `None` if the limited search finds
    /// none.
    fn find_crossing(&self, by: &DisplacementRange, [low, high]: [DVec3; 2]) -> Option<Crossing> {
        let mut tried = 0;
        let mut found = None;
        // The boxes of the nodes have to intersect for every displacement of the cell.
        let meets = |[a, b]: [&Aabb; 2]| {
            (a.low + high).cmple(b.high).all() && (a.high + low).cmpge(b.low).all()
        };
        self.visit_facet_pairs(meets, |triangles| {
            tried += 1;
            found = self.facet_crossing(triangles, by);
            found.is_some() || tried >= MAX_FACET_PAIRS
        });
        found
    }

    /// Checks whether facets may meet for some displacement of a cell. Returns `true` if a limit is reached.
    fn may_have_contact(&self, by: &DisplacementRange, [low, high]: [DVec3; 2]) -> bool {
        let meets = |[a, b]: [&Aabb; 2]| {
            (a.low + low).cmple(b.high).all() && (a.high + high).cmpge(b.low).all()
        };
        self.visit_facet_pairs(meets, |triangles| self.facets_may_meet(triangles, by))
    }

    /// Checks whether neither normal of two facets separates them, up to rounding, for all displacements of a
    /// cell.
    fn facets_may_meet(&self, [a, b]: [u32; 2], by: &DisplacementRange) -> bool {
        let [f, g] =
            [(true, a), (false, b)].map(|(moving, k)| self.displaced.triangle_corners(moving, k));
        let normal = |t: &[DVec3; 3]| (t[1] - t[0]).cross(t[2] - t[0]);
        let parts = |along: &DVec3| {
            let shadow = |t: &[DVec3; 3]| {
                let [x, y, z] = t.map(|p| along.dot(p));
                [x.min(y).min(z), x.max(y).max(z)]
            };
            let ([f, g], middle, width) =
                ([shadow(&f), shadow(&g)], along.dot(by.middle), by.half_width(*along));
            f[0] + middle - width > g[1] || f[1] + middle + width < g[0]
        };
        ![normal(&f), normal(&g)].iter().any(parts)
    }

    /// Calls `end` for pairs of triangles in nodes that meet, until `end` returns `true`. Returns `true` if
    /// it did, or if the limit of node visits was reached.
    fn visit_facet_pairs(
        &self,
        meets: impl Fn([&Aabb; 2]) -> bool,
        mut end: impl FnMut([u32; 2]) -> bool,
    ) -> bool {
        let bodies = &self.displaced.bodies;
        let (mut stack, mut visits) = (vec![[0_u32, 0]], 0);
        while let Some(pair) = stack.pop() {
            visits += 1;
            if visits > MAX_NODE_VISITS {
                return true;
            }
            if !meets([0, 1].map(|k| &self.boxes[k][pair[k] as usize])) {
                continue;
            }
            let [a, b] = [0, 1].map(|k| &bodies.nodes[k][pair[k] as usize]);
            if a.is_facet() && b.is_facet() {
                if end([bodies.leaf_triangle(true, pair[0]), bodies.leaf_triangle(false, pair[1])])
                {
                    return true;
                }
                continue;
            }
            let first =
                b.is_facet() || (!a.is_facet() && a.squared_diagonal() >= b.squared_diagonal());
            let parts = if first { a.children() } else { b.children() };
            stack.extend(parts.map(|k| if first { [k, pair[1]] } else { [pair[0], k] }));
        }
        false
    }

    /// Searches for an edge of one of two facets that passes through the other one for all displacements of a
    /// cell.
    fn facet_crossing(&self, [a, b]: [u32; 2], by: &DisplacementRange) -> Option<Crossing> {
        let both = [(true, a, b), (false, b, a)].into_iter();
        let edges = |(moving, own, facet)| {
            (0..3).map(move |first| Crossing { moving, edge: (own, first), facet })
        };
        both.flat_map(edges).find(|&crossing| self.displaced.crossing_blocks(crossing, by))
    }
}
