//! All directions along which a body leaves, as front ends write them.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use glam::DVec3;
use serde::Serialize;

use super::{Ending, StartOverlapRecord, coordinates, record};
use colltrans_removal::free::{CellKind, FreeArc, FreeDirections, FreePoint, FreeRegion};

record! {
    /// All directions along which a body leaves another one; directions as fractions of the sphere are *shares*, from 0
    /// to 1. Fields that do not apply are left out.
    #[non_exhaustive]
    pub struct FreeRecord {
        /// `free`: some directions are; `blocked`: none is, which is proven; `undecided`: none is known to be, and not
        /// all is known; `overlapping`: nothing is told, as the bodies overlap where they are.
        pub outcome: Ending,
        /// The share that is free, at least and at most, without what is undecided.
        pub free_share: Option<[f64; 2]>,
        /// The share of which nothing is known, at most.
        pub undecided_share: Option<f64>,
        /// Connected regions of free directions, the largest first.
        pub regions: Vec<FreeRegionRecord>,
        /// Arcs of free directions beside which there is no region.
        pub arcs: Vec<FreeArc>,
        /// Free directions with no other beside them.
        pub points: Vec<FreePoint>,
        /// Free directions in cells that are undecided, found by ordinary casts: there may be more around them.
        pub also_free: Vec<[f64; 3]>,
        /// What blocks, the largest share first.
        pub blocked_by: Vec<BlockedByRecord>,
        /// The one that was used, a length.
        pub tolerance: Option<f64>,
        /// Cells of the sphere in the proof.
        pub cells: Option<u64>,
        /// How many of them are undecided.
        pub undecided_cells: Option<u64>,
        /// What overlaps now.
        pub start_overlaps: Vec<StartOverlapRecord>,
        /// For people: what is wrong.
        pub message: Option<String>,
    }
}

/// A connected region of free directions. All directions but the center have a largest component of 1 (or -1).
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FreeRegionRecord {
    /// Its share of the sphere.
    pub share: f64,
    /// A free direction of it, of length 1, nearly the farthest from its border.
    pub center: [f64; 3],
    /// The angle between that and the border, in radians.
    pub margin: f64,
    /// Where its border turns, in no order.
    pub corners: Vec<[f64; 3]>,
    /// Convex pieces that together are it, each by its corners in order.
    pub pieces: Vec<Vec<[f64; 3]>>,
}

record! {
    /// What blocks a share of the sphere.
    pub struct BlockedByRecord {
        /// The name of what is stopped, of a moving body that has several parts.
        pub moving: Option<String>,
        /// The name of what stops it, of a fixed body that has several.
        pub fixed: Option<String>,
        /// The share of the sphere in the cells that pairs of their facets were found to block wholly: they block at
        /// least that, and may block more.
        pub share: f64,
    }
}

impl FreeRecord {
    /// Of an answer; `names` are those of the parts of the moving and of the fixed body that two triangles belong to.
    pub fn of(free: &FreeDirections<'_>, names: impl Fn([u32; 2]) -> [Option<String>; 2]) -> Self {
        let regions = free.regions();
        let undecided = free.cells().filter(|cell| cell.kind == CellKind::Undecided).count();
        let also_free = free.free_among_undecided();
        let thin = free.arcs().len() + free.points().len() + also_free.len();
        let outcome = match undecided {
            _ if !regions.is_empty() || thin > 0 => Ending::Free,
            0 => Ending::Blocked,
            _ => Ending::Undecided,
        };
        let [low, high] = free.free_area();
        // Both are rounded outwards.
        let free_share = [share(low) * (1.0 - f64::EPSILON), share(high) * (1.0 + f64::EPSILON)];
        Self {
            outcome,
            free_share: Some([free_share[0], free_share[1].min(1.0)]),
            undecided_share: Some(share(free.undecided_area()).min(1.0)),
            regions: regions.iter().map(FreeRegionRecord::of).collect(),
            arcs: free.arcs().to_vec(),
            points: free.points().to_vec(),
            also_free: also_free.into_iter().map(coordinates).collect(),
            blocked_by: blocked_by(free, names),
            tolerance: Some(free.tolerance()),
            cells: Some(free.work()[0]),
            undecided_cells: Some(undecided as u64),
            ..Self::default()
        }
    }

    /// Of bodies that overlap where they are, with a tolerance.
    pub fn overlapping(tolerance: f64, start_overlaps: Vec<StartOverlapRecord>) -> Self {
        let outcome = Ending::Overlapping;
        Self { outcome, tolerance: Some(tolerance), start_overlaps, ..Self::default() }
    }
}

impl FreeRegionRecord {
    fn of(region: &FreeRegion) -> Self {
        let all = |corners: &[DVec3]| corners.iter().copied().map(coordinates).collect();
        Self {
            share: share(region.area),
            center: coordinates(region.center),
            margin: region.margin,
            corners: all(&region.corners),
            pieces: region.pieces.iter().map(|piece| all(&piece.corners)).collect(),
        }
    }
}

/// Of the sphere.
fn share(area: f64) -> f64 {
    area / (4.0 * PI)
}

fn blocked_by(
    free: &FreeDirections<'_>,
    names: impl Fn([u32; 2]) -> [Option<String>; 2],
) -> Vec<BlockedByRecord> {
    let mut by_name = BTreeMap::<[Option<String>; 2], f64>::new();
    for cell in free.cells() {
        if let Some(pair) = cell.blocked_by {
            *by_name.entry(names(pair)).or_default() += share(cell.area);
        }
    }
    let told = |([moving, fixed], share): ([_; 2], f64)| BlockedByRecord { moving, fixed, share };
    let mut all: Vec<BlockedByRecord> = by_name.into_iter().map(told).collect();
    all.sort_by(|a, b| b.share.total_cmp(&a.share));
    all
}
