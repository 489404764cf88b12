//! Exact free directions of a removal map: a proven cover of the sphere, for closed parts without exceptions.

use std::sync::atomic::AtomicBool;

use colltrans::record::FreeRecord;
use colltrans::removal::directions::{CellKind, FreeOptions, FreeRegion};
use colltrans::solid::StartOverlap;
use glam::DVec3;

use super::Region;
use crate::bodies::Bodies;
use crate::error::AssemblyError;
use crate::free::RemovalPair;
use crate::watch::Watch;

/// Maximum number of box pairs that are visited for a map.
const MAX_LOOKS: u64 = 5_000_000;

/// The exact free directions, and the undecided cells.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Cover {
    /// The JSON record of the free directions: fractions, regions with corners and margins, and blocking facets.
    pub record: FreeRecord,
    /// Connected regions, largest first.
    pub regions: Vec<FreeRegion>,
    /// Free arcs that border no region, by their ends, in pieces shorter than half a turn.
    pub arcs: Vec<[DVec3; 2]>,
    /// Isolated free directions, and those found by casts if some cells are undecided.
    pub points: Vec<DVec3>,
    /// Undecided cells, by their corners.
    pub undecided: Vec<[DVec3; 4]>,
}

impl Cover {
    /// Computes the cover of a group against all parts outside of it. The inner error is the reason why there is
    /// none.
    pub(super) fn new(
        bodies: &Bodies,
        group: &[usize],
        start: StartOverlap,
        watch: Watch,
    ) -> Result<Result<Self, String>, AssemblyError> {
        watch.check_cancelled()?;
        if group.len() == bodies.len() {
            return Ok(Err("there are no other parts".to_owned()));
        }
        let removal = match RemovalPair::new(bodies, group) {
            Ok(removal) => removal,
            Err(error) => return Ok(Err(error.to_string())),
        };
        let never = AtomicBool::new(false);
        let options = FreeOptions::DEFAULT.with_looks(MAX_LOOKS).with_start_overlap(start);
        let free = match removal.free_directions(options, watch.cancel_flag().unwrap_or(&never)) {
            Err(AssemblyError::Cancelled) => return Err(AssemblyError::Cancelled),
            Err(error) => return Ok(Err(error.to_string())),
            Ok(free) => free,
        };
        let record = removal.to_record(bodies, &free);
        let also = record.also_free.iter().copied().map(DVec3::from);
        let undecided = free.cells().filter(|cell| cell.kind == CellKind::Undecided);
        Ok(Ok(Self {
            regions: free.regions(),
            arcs: free
                .arcs()
                .iter()
                .flat_map(|arc| arc.along.windows(2))
                .map(|ends| [ends[0], ends[1]])
                .collect(),
            points: free.points().iter().map(|point| point.direction).chain(also).collect(),
            undecided: undecided.map(|cell| cell.corners).collect(),
            record,
        }))
    }

    /// Returns the fraction of the sphere that is proven free.
    pub fn free_share(&self) -> f64 {
        self.record.free_share.map_or(0.0, |share| share[0])
    }

    /// Returns an upper bound of the undecided fraction of the sphere.
    pub fn undecided_share(&self) -> f64 {
        self.record.undecided_share.unwrap_or(1.0)
    }

    /// Returns the regions, and the single directions of length 1. Regions below the solid angle `smallest` are
    /// reported as single directions.
    pub(super) fn report_regions(&self, smallest: f64) -> (Vec<Region>, Vec<DVec3>) {
        let (large, small): (Vec<_>, Vec<_>) =
            self.regions.iter().partition(|region| region.area >= smallest);
        let points = self.points.iter().map(|d| d.normalize());
        let single = small.into_iter().map(|region| region.center).chain(points);
        (large.into_iter().map(region_from_exact).collect(), single.collect())
    }
}

fn region_from_exact(region: &FreeRegion) -> Region {
    let center = region.center;
    let (u, v) = center.any_orthonormal_pair();
    let around = |d: &DVec3| d.dot(v).atan2(d.dot(u));
    let mut border: Vec<DVec3> = region.corners.iter().map(|d| d.normalize()).collect();
    border.sort_by(|x, y| around(x).total_cmp(&around(y)));
    Region { solid_angle: region.area, center, border }
}
