//! What is proven of each cell, and how it is listed.

use super::cell::DEEPEST;
use super::inner::InnerBox;
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
