//! What is proven of each cell, and the check of it without a search.
//!
//! *Blocked*: the cone of one pair of facets holds the four corners of the cell. *Open*: it is blocked where the cones
//! of some pairs are, and no other pair meets what they leave. The cones are taken from the cell again, and both trees are gone down
//! for each piece that is left: a pair of nodes ends there, or its parts are looked at, down to single facets.
//! *Inner*: a box inside the moving and one inside the fixed body block all of it; that they are inside is checked
//! once for each box. *Undecided*: it is blocked where the cones are, and nothing is said of the rest.

use glam::DVec3;

use super::bodies::Bodies;
use super::cell::{Cell, DEEPEST};
use super::cone::Cone;
use super::inner::{InnerBox, cover};
use super::rest::{Piece, Rest, TooMuch};
use super::search::PIECES;
use super::window::Window;
use colltrans_solid::cast::StartOverlap;

/// What became of a cell; pairs are positions in [`Solid::triangles`](colltrans_solid::Solid::triangles) of the moving and of
/// the fixed body.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Fate {
    /// Cut in four: the number of the first quarter.
    Cut(u32),
    /// Blocked by one pair.
    Blocked([u32; 2]),
    /// Blocked by a pair of boxes inside, by their numbers.
    Inner([u32; 2]),
    /// Blocked by these pairs where they block, and free elsewhere.
    Open(Vec<[u32; 2]>),
    /// Blocked by these pairs where they block, and not known elsewhere.
    Undecided(Vec<[u32; 2]>),
}

impl Fate {
    /// Nothing is known.
    pub(super) const UNKNOWN: Self = Self::Undecided(Vec::new());
}

/// What is said of all directions, with its proof: the cells in preorder, from the six sides of a cube, `+x`, `-x`,
/// `+y`, ..., each followed by its quarters if it is cut.
///
/// On the side across axis `k` a direction is `s e_k + u e_(k+1) + v e_(k+2)` with `u` and `v` from -1 to 1; quarters
/// are those of low `u` and low `v`, high `u` and low `v`, low `u` and high `v`, high and high.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FreeProof {
    /// The tolerance: both bodies are shrunk by half of it.
    pub tolerance: f64,
    /// Whether facets that cross now count.
    pub start_overlap: StartOverlap,
    /// Boxes inside the moving and inside the fixed body, which cells name.
    #[cfg_attr(feature = "serde", serde(default))]
    pub boxes: [Vec<InnerBox>; 2],
    /// What is said of each cell.
    pub cells: Vec<CellProof>,
}

/// What is said of a cell. Pairs are positions in [`Solid::triangles`](colltrans_solid::Solid::triangles) of the moving and of
/// the fixed body.
#[derive(Debug, Clone, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum CellProof {
    /// It is cut in four, which follow.
    Cut,
    /// This pair blocks all of it.
    Blocked([u32; 2]),
    /// This pair of [`FreeProof::boxes`] blocks all of it.
    Inner([u32; 2]),
    /// These pairs block some of it; all that they leave is free.
    Open(Vec<[u32; 2]>),
    /// These pairs block some of it; nothing is said of the rest.
    Undecided(Vec<[u32; 2]>),
}

/// The cells of a proof, by their numbers; `None` if they are not those of a sphere.
pub(super) fn fates(cells: &[CellProof]) -> Option<Vec<Fate>> {
    let mut fates = vec![Fate::UNKNOWN; 6];
    let mut stack: Vec<(usize, u32)> = (0..6).rev().map(|at| (at, 0)).collect();
    for cell in cells {
        let (at, depth) = stack.pop()?;
        fates[at] = match cell {
            CellProof::Blocked(pair) => Fate::Blocked(*pair),
            CellProof::Inner(pair) => Fate::Inner(*pair),
            CellProof::Open(pairs) => Fate::Open(pairs.clone()),
            CellProof::Undecided(pairs) => Fate::Undecided(pairs.clone()),
            CellProof::Cut if depth >= DEEPEST => return None,
            CellProof::Cut => {
                let first = fates.len();
                stack.extend((0..4).rev().map(|k| (first + k, depth + 1)));
                Fate::Cut(first as u32)
            }
        };
        if let Fate::Cut(_) = fates[at] {
            fates.extend([const { Fate::UNKNOWN }; 4]);
        }
    }
    stack.is_empty().then_some(fates)
}

/// The other way round.
pub(super) fn cells(fates: &[Fate]) -> Vec<CellProof> {
    let mut cells = Vec::with_capacity(fates.len());
    let mut stack: Vec<usize> = (0..6).rev().collect();
    while let Some(at) = stack.pop() {
        cells.push(match &fates[at] {
            Fate::Blocked(pair) => CellProof::Blocked(*pair),
            Fate::Inner(pair) => CellProof::Inner(*pair),
            Fate::Open(pairs) => CellProof::Open(pairs.clone()),
            Fate::Undecided(pairs) => CellProof::Undecided(pairs.clone()),
            Fate::Cut(first) => {
                stack.extend((0..4).rev().map(|k| *first as usize + k));
                CellProof::Cut
            }
        });
    }
    cells
}

/// What pairs of facets leave of a cell.
pub(super) fn rest_of(bodies: &Bodies, cell: Cell, pairs: &[[u32; 2]]) -> Result<Rest, TooMuch> {
    let mut rest = Rest::whole(cell);
    for &pair in pairs {
        rest.cut(bodies, &Cone::new(bodies, pair), PIECES)?;
    }
    Ok(rest)
}

/// Whether what is said of a cell holds; its facets and boxes [exist](names_exist), and the boxes are inside.
pub(super) fn holds(bodies: &Bodies, boxes: &[Vec<InnerBox>; 2], cell: &Cell, fate: &Fate) -> bool {
    match fate {
        Fate::Cut(_) | Fate::Undecided(_) => true,
        Fate::Blocked(pair) => Cone::new(bodies, *pair).covers(bodies, &cell.corners()),
        Fate::Inner([a, b]) => {
            cover([&boxes[0][*a as usize], &boxes[1][*b as usize]], &cell.corners())
        }
        Fate::Open(pairs) => rest_of(bodies, *cell, pairs).is_ok_and(|rest| is_free(bodies, &rest)),
    }
}

/// Whether all facets and boxes that are named exist.
pub(super) fn names_exist(bodies: &Bodies, boxes: &[Vec<InnerBox>; 2], fate: &Fate) -> bool {
    match fate {
        Fate::Cut(_) => true,
        Fate::Inner(pair) => (0..2).all(|k| (pair[k] as usize) < boxes[k].len()),
        Fate::Blocked(pair) => exists(bodies, *pair),
        Fate::Undecided(pairs) | Fate::Open(pairs) => {
            pairs.iter().all(|pair| exists(bodies, *pair))
        }
    }
}

fn exists(bodies: &Bodies, pair: [u32; 2]) -> bool {
    let count = |moving| bodies.scene.side(moving).solid.triangles().len() as u32;
    pair[0] < count(true) && pair[1] < count(false)
}

/// A pair of facets that blocks a direction of a cell, exactly, if there is one: over all pairs of nodes.
pub(super) fn blocking_pair(bodies: &Bodies, cell: &Cell, d: DVec3) -> Option<[u32; 2]> {
    let [k, i, j] = cell.side.axes();
    let around = |axis: usize| {
        let at = d[axis] / d[k].abs();
        [at.next_down(), at.next_up()]
    };
    let window = Window::new(cell.side, around(i), around(j));
    let mut stack = vec![[0, 0]];
    while let Some(pair) = stack.pop() {
        let [p, q] = bodies.views_of(pair);
        if window.is_missed(bodies, p, q) {
            continue;
        }
        if let Some(parts) = bodies.parts(pair) {
            stack.extend(parts);
            continue;
        }
        let facets = [bodies.triangle(true, pair[0]), bodies.triangle(false, pair[1])];
        if Cone::new(bodies, facets).holds(bodies, d) {
            return Some(facets);
        }
    }
    None
}

/// Whether no pair of facets meets any piece of what is left of a cell: each pair is looked at once, for all of them.
fn is_free(bodies: &Bodies, rest: &Rest) -> bool {
    let alone = |piece: &Piece| (rest.window(piece), rest.only(piece));
    let mut pieces: Vec<(Window, Rest)> = rest.pieces.iter().map(alone).collect();
    let mut stack = vec![[0, 0]];
    while let Some(pair) = stack.pop() {
        let [p, q] = bodies.views_of(pair);
        let mut met = pieces.iter_mut().filter(|(window, _)| !window.is_missed(bodies, p, q));
        let Some((_, first)) = met.next() else { continue };
        if let Some(parts) = bodies.parts(pair) {
            stack.extend(parts);
            continue;
        }
        let facets = [bodies.triangle(true, pair[0]), bodies.triangle(false, pair[1])];
        let cone = Cone::new(bodies, facets);
        let mut others = met.map(|(_, alone)| alone);
        let cuts = |alone: &mut Rest| !matches!(alone.cut(bodies, &cone, PIECES), Ok(false));
        if cuts(first) || others.any(cuts) {
            return false;
        }
    }
    true
}
