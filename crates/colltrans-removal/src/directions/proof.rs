//! Claims about the cells of the sphere, and their order in a list.

use super::cell::MAX_DEPTH;
use super::inner::InnerBox;
use colltrans_solid::cast::StartOverlap;

/// State of a cell. Pairs are indices into [`Solid::triangles`](colltrans_solid::Solid::triangles) of the
/// moving and the fixed body.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum CellState {
    /// Divided into quarters. The number is the index of the first one.
    Cut(u32),
    /// One pair blocks all directions.
    Blocked([u32; 2]),
    /// A pair of inner boxes, given by their indices, blocks all directions.
    Inner([u32; 2]),
    /// The listed pairs block some directions. All other directions are free.
    Open(Vec<[u32; 2]>),
    /// The listed pairs block some directions. All other directions are undecided.
    Undecided(Vec<[u32; 2]>),
}

impl CellState {
    /// Undecided, with no blocking pair.
    pub(super) const UNKNOWN: Self = Self::Undecided(Vec::new());
}

/// Claims about all directions, which form a proof. The list of cells is in preorder, from the six sides of a
/// cube, `+x`, `-x`, `+y`, ... The quarters of a divided cell follow it.
///
/// On the side perpendicular to axis `k` a direction is `s e_k + u e_(k+1) + v e_(k+2)` with `u` and `v` from
/// -1 to 1. The order of quarters is: low `u` and low `v`, high `u` and low `v`, low `u` and high `v`, high
/// `u` and high `v`.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FreeProof {
    /// Tolerance. Both bodies are offset inwards by half of it.
    pub tolerance: f64,
    /// Whether facets that cross at the start count as an overlap.
    pub start_overlap: StartOverlap,
    /// Boxes inside the moving and inside the fixed body, to which cells refer.
    #[cfg_attr(feature = "serde", serde(default))]
    pub boxes: [Vec<InnerBox>; 2],
    /// Claims about the cells.
    pub cells: Vec<CellProof>,
}

/// Claim about a cell. Pairs are indices into [`Solid::triangles`](colltrans_solid::Solid::triangles) of the
/// moving and the fixed body.
#[derive(Debug, Clone, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum CellProof {
    /// The cell is divided into quarters. The claims about the four quarters follow in preorder.
    Cut,
    /// This pair blocks all directions of the cell.
    Blocked([u32; 2]),
    /// This pair of [`FreeProof::boxes`] blocks all directions of the cell.
    Inner([u32; 2]),
    /// These pairs block part of the cell. All other directions of the cell are free.
    Open(Vec<[u32; 2]>),
    /// These pairs block part of the cell. Nothing is claimed about its other directions.
    Undecided(Vec<[u32; 2]>),
}

/// Converts the list of a proof to cells with indices. Returns `None` if the list does not partition the
/// sphere, or a cell is deeper than [`MAX_DEPTH`].
pub(super) fn cell_states(cells: &[CellProof]) -> Option<Vec<CellState>> {
    let mut states = vec![CellState::UNKNOWN; 6];
    let mut stack: Vec<(usize, u32)> = (0..6).rev().map(|at| (at, 0)).collect();
    for cell in cells {
        let (at, depth) = stack.pop()?;
        states[at] = match cell {
            CellProof::Blocked(pair) => CellState::Blocked(*pair),
            CellProof::Inner(pair) => CellState::Inner(*pair),
            CellProof::Open(pairs) => CellState::Open(pairs.clone()),
            CellProof::Undecided(pairs) => CellState::Undecided(pairs.clone()),
            CellProof::Cut if depth >= MAX_DEPTH => return None,
            CellProof::Cut => {
                let first = states.len();
                stack.extend((0..4).rev().map(|k| (first + k, depth + 1)));
                CellState::Cut(first as u32)
            }
        };
        if let CellState::Cut(_) = states[at] {
            states.extend([const { CellState::UNKNOWN }; 4]);
        }
    }
    stack.is_empty().then_some(states)
}

/// Converts cells with indices to the list of a proof.
pub(super) fn cell_proofs(states: &[CellState]) -> Vec<CellProof> {
    let mut cells = Vec::with_capacity(states.len());
    let mut stack: Vec<usize> = (0..6).rev().collect();
    while let Some(at) = stack.pop() {
        cells.push(match &states[at] {
            CellState::Blocked(pair) => CellProof::Blocked(*pair),
            CellState::Inner(pair) => CellProof::Inner(*pair),
            CellState::Open(pairs) => CellProof::Open(pairs.clone()),
            CellState::Undecided(pairs) => CellProof::Undecided(pairs.clone()),
            CellState::Cut(first) => {
                stack.extend((0..4).rev().map(|k| *first as usize + k));
                CellProof::Cut
            }
        });
    }
    cells
}
