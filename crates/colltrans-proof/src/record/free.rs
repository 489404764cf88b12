//! Records of free directions.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use glam::DVec3;
use serde::Serialize;

use super::{Ending, StartOverlapRecord, record, without_negative_zeros};
use colltrans_removal::directions::{CellKind, FreeArc, FreeDirections, FreePoint, FreeRegion};

record! {
    /// All directions along which a body can leave another one. A *share* is a fraction of the sphere of
    /// directions, from 0 to 1. Fields that do not apply are omitted.
    #[non_exhaustive]
    pub struct FreeRecord {
        /// - `free`: some directions are free.
        /// - `blocked`: it is proven that no direction is free.
        /// - `undecided`: no free direction was found, and some directions are undecided.
        /// - `overlapping`: the bodies overlap at the start, and the record has no further results.
        pub outcome: Ending,
        /// Lower and upper bound of the share of free directions, without undecided ones.
        pub free_share: Option<[f64; 2]>,
        /// Upper bound of the share of undecided directions.
        pub undecided_share: Option<f64>,
        /// Connected regions of free directions, the largest first.
        pub regions: Vec<FreeRegionRecord>,
        /// Arcs of free directions that border no region.
        pub arcs: Vec<FreeArc>,
        /// Isolated free directions.
        pub points: Vec<FreePoint>,
        /// Free directions in undecided cells, found by casts. Directions around them may also be free.
        pub also_free: Vec<[f64; 3]>,
        /// Parts that block directions, the largest share first.
        pub blocked_by: Vec<BlockedByRecord>,
        /// Tolerance in use, a length.
        pub tolerance: Option<f64>,
        /// Number of cells of the proof.
        pub cells: Option<u64>,
        /// Number of undecided cells.
        pub undecided_cells: Option<u64>,
        /// Overlaps at the start.
        pub start_overlaps: Vec<StartOverlapRecord>,
        /// Message for users about a problem.
        pub message: Option<String>,
    }
}

/// Connected region of free directions. All directions except the center have a largest component of 1 or -1.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FreeRegionRecord {
    /// Share of the region.
    pub share: f64,
    /// Free direction of length 1 in the region, approximately the farthest one from the boundary.
    pub center: [f64; 3],
    /// Angle between the center and the boundary, in radians.
    pub margin: f64,
    /// Corners of the boundary, in no particular order.
    pub corners: Vec<[f64; 3]>,
    /// Convex pieces whose union is the region, each given by its corners in cyclic order.
    pub pieces: Vec<Vec<[f64; 3]>>,
}

record! {
    /// Two parts, and the share of the sphere that they block.
    pub struct BlockedByRecord {
        /// Name of the blocked part, if the moving body has several.
        pub moving: Option<String>,
        /// Name of the blocking part, if the fixed body has several.
        pub fixed: Option<String>,
        /// Total share of the blocked cells that are attributed to these parts. A cell that one pair of
        /// facets blocks is attributed to the parts of these facets. A cell that boxes inside the bodies
        /// block is attributed to parts that block the direction at its center.
        pub share: f64,
    }
}

impl FreeRecord {
    /// Converts an answer. `names` maps a pair of triangles to the names of their parts.
    pub fn from_directions(
        free: &FreeDirections<'_>,
        names: impl Fn([u32; 2]) -> [Option<String>; 2],
    ) -> Self {
        let regions = free.regions();
        let undecided = free.cells().filter(|cell| cell.kind == CellKind::Undecided).count();
        let also_free = free.free_among_undecided();
        let lower_dimensional = free.arcs().len() + free.points().len() + also_free.len();
        // Free directions without an area are not always reported, so their absence does not prove a block.
        let is_found = !regions.is_empty() || lower_dimensional > 0;
        let outcome = match undecided {
            _ if is_found => Ending::Free,
            0 if free.is_blocked() => Ending::Blocked,
            0 if free.has_free_direction() => Ending::Free,
            _ => Ending::Undecided,
        };
        let [low, high] = free.free_area();
        // Round both bounds outwards.
        let free_share =
            [sphere_share(low) * (1.0 - f64::EPSILON), sphere_share(high) * (1.0 + f64::EPSILON)];
        Self {
            outcome,
            free_share: Some([free_share[0], free_share[1].min(1.0)]),
            undecided_share: Some(sphere_share(free.undecided_area()).min(1.0)),
            regions: regions.iter().map(FreeRegionRecord::of_region).collect(),
            arcs: free.arcs().to_vec(),
            points: free.points().to_vec(),
            also_free: also_free.into_iter().map(without_negative_zeros).collect(),
            blocked_by: blocking_parts(free, names),
            tolerance: Some(free.tolerance()),
            cells: Some(free.work_counts()[0]),
            undecided_cells: Some(undecided as u64),
            ..Self::default()
        }
    }

    /// Returns the record of bodies that overlap at the start, with a tolerance.
    pub fn overlapping(tolerance: f64, start_overlaps: Vec<StartOverlapRecord>) -> Self {
        let outcome = Ending::Overlapping;
        Self { outcome, tolerance: Some(tolerance), start_overlaps, ..Self::default() }
    }
}

impl FreeRegionRecord {
    fn of_region(region: &FreeRegion) -> Self {
        let all = |corners: &[DVec3]| corners.iter().copied().map(without_negative_zeros).collect();
        Self {
            share: sphere_share(region.area),
            center: without_negative_zeros(region.center),
            margin: region.margin,
            corners: all(&region.corners),
            pieces: region.pieces.iter().map(|piece| all(&piece.corners)).collect(),
        }
    }
}

/// Returns the share of the sphere that corresponds to a solid angle.
fn sphere_share(area: f64) -> f64 {
    area / (4.0 * PI)
}

fn blocking_parts(
    free: &FreeDirections<'_>,
    names: impl Fn([u32; 2]) -> [Option<String>; 2],
) -> Vec<BlockedByRecord> {
    let mut by_name = BTreeMap::<[Option<String>; 2], f64>::new();
    for cell in free.cells() {
        if let Some(pair) = cell.blocked_by {
            *by_name.entry(names(pair)).or_default() += sphere_share(cell.area);
        }
    }
    let record_of =
        |([moving, fixed], share): ([_; 2], f64)| BlockedByRecord { moving, fixed, share };
    let mut all: Vec<BlockedByRecord> = by_name.into_iter().map(record_of).collect();
    all.sort_by(|a, b| b.share.total_cmp(&a.share));
    all
}
