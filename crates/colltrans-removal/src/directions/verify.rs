//! Checks of the claims about cells, without a search.
//!
//! - *Blocked*: the cone of one pair of facets contains the four corners of the cell.
//! - *Open*: the cones of the listed pairs are subtracted from the cell. Then both trees are traversed once
//!   for all pieces of the remainder, and no other pair may block a direction of a piece. A pair of nodes is
//!   dismissed or replaced by its children, down to facets.
//! - *Inner*: a box inside the moving and one inside the fixed body block the cell. That the boxes are inside
//!   is checked once for each box.
//! - *Undecided*: nothing is claimed outside the cones of the listed pairs.

use glam::DVec3;

use super::bodies::Bodies;
use super::cell::Cell;
use super::cone::Cone;
use super::inner::{InnerBox, boxes_block};
use super::proof::CellState;
use super::remainder::{LimitExceeded, Piece, Remainder};
use super::search::MAX_PIECES;
use super::window::Window;

/// Subtracts the cones of pairs of facets from a cell. Returns an error if the remainder has too many pieces
/// or a number is too large.
pub(super) fn remainder_of(
    bodies: &Bodies,
    cell: Cell,
    pairs: &[[u32; 2]],
) -> Result<Remainder, LimitExceeded> {
    let mut remainder = Remainder::of_cell(cell);
    for &pair in pairs {
        remainder.subtract_cone(bodies, &Cone::new(bodies, pair), MAX_PIECES)?;
    }
    Ok(remainder)
}

/// Checks the claim about a cell. The facets and boxes that it names must [exist](names_exist), and the boxes
/// must be inside.
pub(super) fn claim_holds(
    bodies: &Bodies,
    boxes: &[Vec<InnerBox>; 2],
    cell: &Cell,
    state: &CellState,
) -> bool {
    match state {
        CellState::Cut(_) | CellState::Undecided(_) => true,
        CellState::Blocked(pair) => {
            Cone::new(bodies, *pair).contains_all(bodies, &cell.corner_directions())
        }
        CellState::Inner([a, b]) => {
            boxes_block([&boxes[0][*a as usize], &boxes[1][*b as usize]], &cell.corner_directions())
        }
        CellState::Open(pairs) => {
            remainder_of(bodies, *cell, pairs).is_ok_and(|remainder| is_free(bodies, &remainder))
        }
    }
}

/// Checks whether all facets and boxes that a claim names exist.
pub(super) fn names_exist(bodies: &Bodies, boxes: &[Vec<InnerBox>; 2], state: &CellState) -> bool {
    match state {
        CellState::Cut(_) => true,
        CellState::Inner(pair) => (0..2).all(|k| (pair[k] as usize) < boxes[k].len()),
        CellState::Blocked(pair) => facets_exist(bodies, *pair),
        CellState::Undecided(pairs) | CellState::Open(pairs) => {
            pairs.iter().all(|pair| facets_exist(bodies, *pair))
        }
    }
}

fn facets_exist(bodies: &Bodies, pair: [u32; 2]) -> bool {
    let count = |moving| bodies.scene.side(moving).solid.triangles().len() as u32;
    pair[0] < count(true) && pair[1] < count(false)
}

/// Returns a pair of facets that blocks a direction of a cell, found by an exhaustive traversal of both
/// trees. The test of each pair is exact. Returns `None` if there is no such pair.
pub(super) fn blocking_pair(bodies: &Bodies, cell: &Cell, d: DVec3) -> Option<[u32; 2]> {
    let [k, i, j] = cell.side.axes();
    let around = |axis: usize| {
        let at = d[axis] / d[k].abs();
        [at.next_down(), at.next_up()]
    };
    let window = Window::new(cell.side, around(i), around(j));
    let mut stack = vec![[0, 0]];
    while let Some(pair) = stack.pop() {
        let [p, q] = bodies.node_pair(pair);
        if window.is_missed(bodies, p, q) {
            continue;
        }
        if let Some(parts) = bodies.child_pairs(pair) {
            stack.extend(parts);
            continue;
        }
        let facets = [bodies.leaf_triangle(true, pair[0]), bodies.leaf_triangle(false, pair[1])];
        if Cone::new(bodies, facets).contains_direction(bodies, d) {
            return Some(facets);
        }
    }
    None
}

/// Checks whether no pair of facets blocks a direction of a remainder. Each pair is visited once for all
/// pieces.
fn is_free(bodies: &Bodies, remainder: &Remainder) -> bool {
    let alone = |piece: &Piece| (remainder.bounding_window(piece), remainder.with_piece(piece));
    let mut pieces: Vec<(Window, Remainder)> = remainder.pieces.iter().map(alone).collect();
    let mut stack = vec![[0, 0]];
    while let Some(pair) = stack.pop() {
        let [p, q] = bodies.node_pair(pair);
        let mut met = pieces.iter_mut().filter(|(window, _)| !window.is_missed(bodies, p, q));
        let Some((_, first)) = met.next() else { continue };
        if let Some(parts) = bodies.child_pairs(pair) {
            stack.extend(parts);
            continue;
        }
        let facets = [bodies.leaf_triangle(true, pair[0]), bodies.leaf_triangle(false, pair[1])];
        let cone = Cone::new(bodies, facets);
        let mut others = met.map(|(_, alone)| alone);
        let cuts = |alone: &mut Remainder| {
            !matches!(alone.subtract_cone(bodies, &cone, MAX_PIECES), Ok(false))
        };
        if cuts(first) || others.any(cuts) {
            return false;
        }
    }
    true
}
