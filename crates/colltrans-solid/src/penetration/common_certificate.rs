//! Proofs of common parts, verified exactly and without a search.
//!
//! - A *root* box contains the common part, because each of its sides bounds one of the bodies.
//! - A binary tree cuts the root into cells, by planes of facets and of coordinates. Every cut leaves cells with an
//!   interior ([`cuts`](super::cuts)).
//! - A leaf claims that its cell is inside both bodies, or outside one of them. No facet of a named body meets the
//!   interior of the cell, so that the winding number of one point decides the cell.
//! - The volume of the common part is at least that of all cells inside both bodies, and at most that of all cells not
//!   outside one of them.

use std::cmp::Ordering;

use glam::DVec3;
use thiserror::Error;

use super::cuts::{Cell, Plane, work_of_bits};
use super::exact_pair::{ExactPair, NoSide};
use crate::body::{Solid, check_is_not_rounded};
use colltrans_convex::body::Aabb;
use colltrans_convex::pair::Pair;
use colltrans_convex::setting::error::QueryError;
use colltrans_kernel::range::is_in_exact_range;

use std::rc::Rc;

/// Maximum work of a verification, in corners of cells.
const MAX_WORK: u64 = 40_000_000;
/// Maximum number of cuts around a cell.
const MAX_DEPTH: usize = 4096;
/// Work of a cell in addition to its corners.
const WORK_OF_CELL: u64 = 8;
/// Number of facets whose winding is counted with the work of a corner.
const FACETS_PER_WORK: u64 = 4;

/// A proof of the common part of two solids, verified by
/// [`SolidPenetration::verify_common_part`](super::SolidPenetration::verify_common_part).
///
/// The common part is that of the interiors of the closed shells. All claims refer to the bodies as placed by the
/// entries of the matrices of their poses, without rounding.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct CommonPartCertificate {
    /// Proven lower and upper bound of the volume, in cubic world units.
    pub volume: [f64; 2],
    /// Box in the world that contains the common part; `None` if there is none.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    pub bounds: Option<Aabb>,
    /// Point of the world in the interior of both bodies.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    pub point: Option<DVec3>,
    /// How the bodies lie to each other, if it is proven.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    pub relation: Option<ProvenRelation>,
    /// Box in the world that the tree divides.
    pub root: Aabb,
    /// Nodes of the tree, each before its children, and all nodes below the first child before the second child.
    pub nodes: Vec<CommonNode>,
}

/// A relation of two bodies that a [`CommonPartCertificate`] proves.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", try_from = "RelationText")
)]
#[non_exhaustive]
pub enum ProvenRelation {
    /// The interiors have no common point: each cell is outside one body.
    Disjoint,
    /// The interiors have a common point, and no body contains the other.
    Crossing {
        /// Point of the world in the interior of the moving body and outside the fixed one.
        only_moving: DVec3,
        /// Point of the world in the interior of the fixed body and outside the moving one.
        only_fixed: DVec3,
    },
    /// The fixed body contains the moving one: the root contains the moving body, and each cell is inside both bodies or
    /// outside the moving one.
    MovingContained,
    /// The moving body contains the fixed one.
    FixedContained,
}

/// A node of the tree of a [`CommonPartCertificate`]: a cut with two children, or a cell.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", try_from = "NodeText")
)]
#[non_exhaustive]
pub enum CommonNode {
    /// A cut at a coordinate of the first axis of the world. The first child has the smaller coordinates.
    X(f64),
    /// A cut at a coordinate of the second axis.
    Y(f64),
    /// A cut at a coordinate of the third axis.
    Z(f64),
    /// A cut in the plane of a triangle of the moving body, a position in [`Solid::triangles`](crate::Solid::triangles).
    /// The first child is behind the triangle.
    Moving(u32),
    /// A cut in the plane of a triangle of the fixed body.
    Fixed(u32),
    /// A cell in the interior of both bodies.
    Both,
    /// A cell outside the moving body.
    OutsideMoving,
    /// A cell outside the fixed body.
    OutsideFixed,
    /// A cell without a claim.
    Undecided,
}

/// A node or a relation in a file: a name, or an object with one field. `{"both": null}` is not a name.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
#[serde(untagged, expecting = "expected a name, or an object with one known field")]
enum NameOr<T> {
    Name(String),
    Object(T),
}

/// A cut in a file.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
#[serde(rename_all = "snake_case")]
enum CutText {
    X(f64),
    Y(f64),
    Z(f64),
    Moving(u32),
    Fixed(u32),
}

/// The relation of bodies that cross, in a file.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
enum CrossingText {
    Crossing { only_moving: DVec3, only_fixed: DVec3 },
}

#[cfg(feature = "serde")]
type NodeText = NameOr<CutText>;
#[cfg(feature = "serde")]
type RelationText = NameOr<CrossingText>;

#[cfg(feature = "serde")]
impl TryFrom<NodeText> for CommonNode {
    type Error = String;

    fn try_from(text: NodeText) -> Result<Self, String> {
        Ok(match text {
            NameOr::Object(CutText::X(at)) => Self::X(at),
            NameOr::Object(CutText::Y(at)) => Self::Y(at),
            NameOr::Object(CutText::Z(at)) => Self::Z(at),
            NameOr::Object(CutText::Moving(triangle)) => Self::Moving(triangle),
            NameOr::Object(CutText::Fixed(triangle)) => Self::Fixed(triangle),
            NameOr::Name(name) => match &*name {
                "both" => Self::Both,
                "outside_moving" => Self::OutsideMoving,
                "outside_fixed" => Self::OutsideFixed,
                "undecided" => Self::Undecided,
                _ => return Err(format!("{name:?} is not a cell of a common part")),
            },
        })
    }
}

#[cfg(feature = "serde")]
impl TryFrom<RelationText> for ProvenRelation {
    type Error = String;

    fn try_from(text: RelationText) -> Result<Self, String> {
        Ok(match text {
            NameOr::Object(CrossingText::Crossing { only_moving, only_fixed }) => {
                Self::Crossing { only_moving, only_fixed }
            }
            NameOr::Name(name) => match &*name {
                "disjoint" => Self::Disjoint,
                "moving_contained" => Self::MovingContained,
                "fixed_contained" => Self::FixedContained,
                _ => return Err(format!("{name:?} is not a relation of two bodies")),
            },
        })
    }
}

/// Reason why a proof of a common part is rejected.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum CommonPartError {
    /// The query of the proof is invalid.
    #[error("the query of the proof is invalid: {0}")]
    Query(#[from] QueryError),
    /// A coordinate is not admitted.
    #[error(
        "{field} has a coordinate of {value:?}; coordinates are 0 or of magnitude 2^-200 to 2^200"
    )]
    Coordinate {
        /// Name of the field.
        field: &'static str,
        /// The coordinate.
        value: f64,
    },
    /// The bounds of the volume are not numbers in order.
    #[error("the bounds {volume:?} of the volume are not finite numbers in order, from 0 on")]
    Volume {
        /// The claimed bounds.
        volume: [f64; 2],
    },
    /// A bound of the volume is stronger than the cells prove.
    #[error("the proof claims a volume from {} to {}, but proves only {} to {}",
        .claimed[0], .claimed[1], .proven[0], .proven[1])]
    VolumeBounds {
        /// The claimed bounds.
        claimed: [f64; 2],
        /// The proven bounds.
        proven: [f64; 2],
    },
    /// The root has no interior, or one of its sides bounds neither body.
    #[error("the root has no interior, or its side at {at:?} on axis {axis} bounds neither body")]
    Root {
        /// Axis of the side, from 0.
        axis: usize,
        /// Coordinate of the side.
        at: f64,
    },
    /// A node does not hold.
    #[error("node {node}: {reason}")]
    Node {
        /// Position of the node; the number of nodes if the tree ends too early.
        node: usize,
        /// Reason why it does not hold.
        reason: NodeFault,
    },
    /// The box does not contain the cell of a node that may have a part in common.
    #[error("the box of the common part does not contain the cell of node {node}")]
    Bounds {
        /// Position of the node.
        node: usize,
    },
    /// A point is not where the claim has it.
    #[error("{field} is not proven to be inside and outside the bodies as claimed")]
    Point {
        /// Name of the field.
        field: &'static str,
    },
    /// The cells do not prove the relation.
    #[error("the cells do not prove the claimed relation of the bodies")]
    Relation,
    /// The verification is too expensive.
    #[error("the proof needs more than {limit} steps; divide the common part into fewer cells")]
    Work {
        /// Maximum number of steps.
        limit: u64,
    },
}

/// Reason why a node of a [`CommonPartCertificate`] does not hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum NodeFault {
    /// The triangle does not exist, has no area, or belongs to an open shell.
    #[error("triangle {0} does not exist, has no area, or belongs to an open shell")]
    Triangle(u32),
    /// The coordinate is not admitted.
    #[error("the coordinate is not 0 or of magnitude 2^-200 to 2^200")]
    Coordinate,
    /// The plane leaves no cell on one side.
    #[error("the plane does not divide the cell")]
    Improper,
    /// A triangle of a body meets the cell.
    #[error("triangle {0} meets the cell")]
    Crossed(u32),
    /// The cell is on the other side of a body.
    #[error("the cell is on the other side of the body")]
    OtherSide,
    /// A piece of a body is inside out in the cell.
    #[error("a piece of the body has a negative winding number in the cell")]
    InsideOut,
    /// The tree ends before this node, or continues after its end.
    #[error("the tree ends here")]
    End,
    /// The node has too many cuts above it.
    #[error("the node has more than {} cuts above it", MAX_DEPTH)]
    Depth,
}

/// What the cells of a tree prove.
#[derive(Default)]
pub(super) struct ProvenCells {
    /// Sums of the lower and of the upper bounds of volumes, not yet rounded outwards.
    sums: [f64; 2],
    /// Number of volumes in the sums.
    count: u32,
    /// Whether there are cells inside both bodies, outside the moving or the fixed one, and undecided ones.
    both: bool,
    outside: [bool; 2],
    undecided: bool,
}

impl ProvenCells {
    /// Adds a cell with a kind that is proven. `volume` computes bounds of its volume if they count.
    pub(super) fn add(&mut self, kind: CommonNode, volume: impl FnOnce() -> [f64; 2]) {
        match kind {
            CommonNode::OutsideMoving => self.outside[0] = true,
            CommonNode::OutsideFixed => self.outside[1] = true,
            _ => {
                let [low, high] = volume();
                if kind == CommonNode::Both {
                    self.both = true;
                    self.sums[0] += low;
                } else {
                    self.undecided = true;
                }
                self.sums[1] += high;
                self.count += 1;
            }
        }
    }

    /// Returns bounds of the volume of the common part.
    pub(super) fn volume(&self) -> [f64; 2] {
        let rounding = f64::EPSILON * (f64::from(self.count) + 4.0);
        [self.sums[0] * (1.0 - rounding), self.sums[1] * (1.0 + rounding)]
    }
}

/// Work of a verification so far.
pub(super) struct Work {
    done: u64,
    limit: u64,
    factor: u64,
    per_side: [u64; 2],
}

impl Work {
    pub(super) fn new(exact: &ExactPair, limit: u64) -> Self {
        let factor = work_of_bits(exact.bits);
        let per_side = exact.bodies.each_ref().map(|body| body.facets.len() as u64);
        let per_side = per_side.map(|count| factor * (1 + count / FACETS_PER_WORK));
        Self { done: 0, limit, factor, per_side }
    }

    /// Adds the work of a cell; `None` if the sum exceeds the limit.
    pub(super) fn add_cell(&mut self, cell: &Cell) -> Option<()> {
        self.add(self.factor * (WORK_OF_CELL + cell.size()))
    }

    /// Adds the work of finding out whether a point is inside each body; `None` if the sum exceeds the limit.
    pub(super) fn add_point(&mut self) -> Option<()> {
        self.add(self.per_side[0] + self.per_side[1])
    }

    fn add(&mut self, work: u64) -> Option<()> {
        self.done = self.done.saturating_add(work);
        (self.done <= self.limit).then_some(())
    }

    fn error(&self) -> CommonPartError {
        CommonPartError::Work { limit: self.limit }
    }
}

/// Finds out whether a cell that no facet of a body meets is inside this body. `None` if the work exceeds its limit.
pub(super) fn decide_side(
    exact: &ExactPair,
    cell: &mut Cell,
    body: usize,
    work: &mut Work,
) -> Option<Result<bool, NodeFault>> {
    if let Some(known) = cell.inside[body] {
        return Some(Ok(known));
    }
    if let Some(fragment) = cell.fragments[body].first() {
        return Some(Err(NodeFault::Crossed(fragment.triangle)));
    }
    work.add(work.per_side[body])?;
    let Some(point) = cell.interior_point(exact.unit) else {
        return Some(Err(NodeFault::Improper));
    };
    let found = exact.bodies[body].is_inside(&point, exact.unit);
    cell.inside[body] = found.ok();
    Some(found.map_err(|_| NodeFault::InsideOut))
}

/// Returns the sides of a box as planes.
pub(super) fn box_planes(exact: &ExactPair, bounds: &Aabb) -> Option<[[Rc<Plane>; 2]; 3]> {
    let plane = |axis: usize, at: DVec3| exact.coordinate_plane(axis, at[axis]);
    let sides = |axis: usize| Some([plane(axis, bounds.low)?, plane(axis, bounds.high)?]);
    Some([sides(0)?, sides(1)?, sides(2)?])
}

/// Checks whether all facets of a body are on the inner side of a side of a box.
pub(super) fn bounds_body(exact: &ExactPair, body: usize, side: &Plane, is_high: bool) -> bool {
    let outside = if is_high { Ordering::Greater } else { Ordering::Less };
    exact.bodies[body].corners().all(|corner| side.side(corner) != outside)
}

/// Returns the root cell with all facets, and for each body whether the root contains it. Open shells may be anywhere.
pub(super) fn root_cell(
    exact: &ExactPair,
    root: &Aabb,
) -> Result<(Cell, [bool; 2]), CommonPartError> {
    let fault = |axis: usize, at: f64| CommonPartError::Root { axis, at };
    let planes = box_planes(exact, root).ok_or_else(|| fault(0, root.low.x))?;
    let mut contains = exact.bodies.each_ref().map(|body| !body.has_open_shell);
    for (axis, sides) in planes.iter().enumerate() {
        for (k, side) in sides.iter().enumerate() {
            let bounds = [0, 1].map(|body| bounds_body(exact, body, side, k == 1));
            if bounds == [false; 2] {
                return Err(fault(axis, [root.low, root.high][k][axis]));
            }
            contains = [0, 1].map(|body| contains[body] && bounds[body]);
        }
    }
    let cell = Cell::from_box(&planes, exact.unit);
    let mut cell = cell.ok_or_else(|| fault(0, root.low.x))?;
    for (k, body) in exact.bodies.iter().enumerate() {
        cell.fragments[k] = cell.clip(body.fragments(&planes, exact.unit), exact.unit);
    }
    Ok((cell, contains))
}

impl CommonNode {
    /// Returns the plane of a cut.
    pub(super) fn plane(self, exact: &ExactPair) -> Result<Rc<Plane>, NodeFault> {
        let of_facet = |body: usize, triangle: u32| {
            let facet = exact.bodies[body].facet(triangle);
            facet.map(|facet| Rc::clone(&facet.plane)).ok_or(NodeFault::Triangle(triangle))
        };
        let of_coordinate = |axis: usize, at: f64| {
            let plane =
                is_in_exact_range(DVec3::splat(at)).then(|| exact.coordinate_plane(axis, at));
            plane.flatten().ok_or(NodeFault::Coordinate)
        };
        match self {
            Self::X(at) => of_coordinate(0, at),
            Self::Y(at) => of_coordinate(1, at),
            Self::Z(at) => of_coordinate(2, at),
            Self::Moving(triangle) => of_facet(0, triangle),
            Self::Fixed(triangle) => of_facet(1, triangle),
            _ => Err(NodeFault::End),
        }
    }

    /// Checks whether the node is a cell.
    pub(super) const fn is_cell(self) -> bool {
        matches!(self, Self::Both | Self::OutsideMoving | Self::OutsideFixed | Self::Undecided)
    }
}

/// Walks through a tree depth first, and returns what its cells prove. Passes each cell that is not outside a body, with
/// the position of its node, to `visit`. Cells are dropped after their visit, so that memory is that of one path of the
/// tree.
fn proven_cells(
    exact: &ExactPair,
    root: Cell,
    nodes: &[CommonNode],
    mut visit: impl FnMut(usize, &Cell) -> Result<(), CommonPartError>,
) -> Result<ProvenCells, CommonPartError> {
    let mut work = Work::new(exact, MAX_WORK);
    let mut proven = ProvenCells::default();
    let mut open = vec![(root, 0)];
    for (node, &kind) in nodes.iter().enumerate() {
        let fault = |reason| CommonPartError::Node { node, reason };
        let (mut cell, depth) = open.pop().ok_or_else(|| fault(NodeFault::End))?;
        work.add_cell(&cell).ok_or_else(|| work.error())?;
        if !kind.is_cell() {
            if depth >= MAX_DEPTH {
                return Err(fault(NodeFault::Depth));
            }
            // The parts of a cell that no facet meets are on the same side.
            for body in [0, 1] {
                if cell.fragments[body].is_empty() {
                    let _ = decide_side(exact, &mut cell, body, &mut work)
                        .ok_or_else(|| work.error())?;
                }
            }
            let plane = kind.plane(exact).map_err(fault)?;
            let parts = cell.split(&plane, exact.unit);
            let [behind, before] = parts.ok_or_else(|| fault(NodeFault::Improper))?;
            open.extend([(before, depth + 1), (behind, depth + 1)]);
            continue;
        }
        let claims: &[(usize, bool)] = match kind {
            CommonNode::Both => &[(0, true), (1, true)],
            CommonNode::OutsideMoving => &[(0, false)],
            CommonNode::OutsideFixed => &[(1, false)],
            _ => &[],
        };
        for &(body, claimed) in claims {
            let found = decide_side(exact, &mut cell, body, &mut work);
            let inside = found.ok_or_else(|| work.error())?.map_err(fault)?;
            if inside != claimed {
                return Err(fault(NodeFault::OtherSide));
            }
        }
        if matches!(kind, CommonNode::Both | CommonNode::Undecided) {
            visit(node, &cell)?;
        }
        proven.add(kind, || cell.volume(exact.unit));
    }
    if !open.is_empty() {
        return Err(CommonPartError::Node { node: nodes.len(), reason: NodeFault::End });
    }
    Ok(proven)
}

/// Checks whether the cells prove a relation, apart from points.
pub(super) fn proves_relation(
    cells: &ProvenCells,
    contains: [bool; 2],
    relation: ProvenRelation,
    has_point: bool,
) -> bool {
    let contained =
        |body: usize| contains[body] && cells.both && !cells.undecided && !cells.outside[1 - body];
    match relation {
        ProvenRelation::Disjoint => !cells.both && !cells.undecided,
        ProvenRelation::Crossing { .. } => cells.both || has_point,
        ProvenRelation::MovingContained => contained(0),
        ProvenRelation::FixedContained => contained(1),
    }
}

/// Checks whether a point is strictly inside or outside each body, as claimed. Its cost is the number of facets of both
/// bodies.
pub(super) fn has_sides(exact: &ExactPair, at: DVec3, inside: [bool; 2]) -> bool {
    let point = exact.point(at);
    [0, 1].iter().all(|body| {
        let found: Result<bool, NoSide> =
            exact.bodies[*body].is_strictly_inside(&point, exact.unit);
        found == Ok(inside[*body])
    })
}

/// Checks that the coordinates of a field are admitted.
fn check_coordinates(field: &'static str, at: DVec3) -> Result<(), CommonPartError> {
    let is_bad = |value: &f64| !is_in_exact_range(DVec3::splat(*value));
    match at.to_array().into_iter().find(is_bad) {
        Some(value) => Err(CommonPartError::Coordinate { field, value }),
        None => Ok(()),
    }
}

/// Checks whether a cell is within the sides of a box.
pub(super) fn is_within(planes: &[[Rc<Plane>; 2]; 3], cell: &Cell) -> bool {
    cell.vertices().all(|at| {
        planes
            .iter()
            .all(|[low, high]| low.side(at) != Ordering::Less && high.side(at) != Ordering::Greater)
    })
}

/// Checks that no body is rounded.
pub(super) fn check_is_query(pair: &Pair<'_, Solid>) -> Result<(), CommonPartError> {
    for body in [pair.moving(), pair.fixed()] {
        check_is_not_rounded(body.radius()).map_err(QueryError::from)?;
    }
    Ok(())
}

/// Checks that the numbers of a proof are admitted.
pub(super) fn check_numbers(proof: &CommonPartCertificate) -> Result<(), CommonPartError> {
    let [lower, upper] = proof.volume;
    if !(0.0 <= lower && lower <= upper && upper.is_finite()) {
        return Err(CommonPartError::Volume { volume: proof.volume });
    }
    let boxes = [("root", Some(proof.root)), ("bounds", proof.bounds)];
    for (field, of) in boxes.into_iter().filter_map(|(field, of)| Some((field, of?))) {
        check_coordinates(field, of.low)?;
        check_coordinates(field, of.high)?;
    }
    Ok(())
}

/// Verifies a proof. Returns the difference of the bounds of the volume.
pub(super) fn verify_common_part(
    pair: &Pair<'_, Solid>,
    proof: &CommonPartCertificate,
) -> Result<f64, CommonPartError> {
    check_is_query(pair)?;
    check_numbers(proof)?;
    let CommonPartCertificate { volume, bounds, point, relation, root, nodes } = proof;
    let [lower, upper] = *volume;
    let exact = ExactPair::new(pair);
    let mut claims = Vec::new();
    claims.extend(point.map(|at| ("point", at, [true, true])));
    if let Some(ProvenRelation::Crossing { only_moving, only_fixed }) = relation {
        claims.push(("only_moving", *only_moving, [true, false]));
        claims.push(("only_fixed", *only_fixed, [false, true]));
    }
    for (field, at, inside) in claims {
        check_coordinates(field, at)?;
        if !has_sides(&exact, at, inside) {
            return Err(CommonPartError::Point { field });
        }
    }
    let (cell, contains) = root_cell(&exact, root)?;
    let planes = bounds.as_ref().and_then(|bounds| box_planes(&exact, bounds));
    let check_bounds = |node: usize, cell: &Cell| match &planes {
        Some(planes) if is_within(planes, cell) => Ok(()),
        _ => Err(CommonPartError::Bounds { node }),
    };
    let cells = proven_cells(&exact, cell, nodes, check_bounds)?;
    let proven = cells.volume();
    if lower > proven[0] || upper < proven[1] {
        let claimed = *volume;
        return Err(CommonPartError::VolumeBounds { claimed, proven });
    }
    match relation {
        Some(relation) if !proves_relation(&cells, contains, *relation, point.is_some()) => {
            Err(CommonPartError::Relation)
        }
        _ => Ok(upper - lower),
    }
}
