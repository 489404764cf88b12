//! All directions along which a part or group can leave the others, with a proof.
//!
//! Parts keep their poses, so the group is one solid and the others are another. A blocking pair of facets belongs to
//! two parts, independent of how the solids combine them.

use std::sync::atomic::AtomicBool;

use colltrans::record::FreeRecord;
use colltrans::removal::directions::{FreeDirections, FreeError, FreeOptions};
use colltrans::{Pose, Solid};

use crate::bodies::Bodies;
use crate::error::AssemblyError;

/// A group and the other parts, each combined into one solid.
#[derive(Debug, Clone)]
pub struct RemovalPair {
    solids: [Solid; 2],
    /// For each solid, its parts with the index of their first facet.
    parts: [Vec<(usize, u32)>; 2],
}

impl RemovalPair {
    /// Combines a group and all parts outside of it.
    ///
    /// # Errors
    /// Returns an error if the group is empty or contains all parts, if a minimum gap is set, or if a part is not
    /// closed. A pair that is ignored, has a fit of its own, or overlaps at the start is an error too.
    pub fn new(bodies: &Bodies, group: &[usize]) -> Result<Self, AssemblyError> {
        let others: Vec<usize> = (0..bodies.len()).filter(|k| !group.contains(k)).collect();
        if group.is_empty() || others.is_empty() {
            return Err(AssemblyError::InvalidRemoval { count: group.len(), of: bodies.len() });
        }
        Self::between(bodies, group, &others)
    }

    /// Combines a group and some other parts.
    pub(crate) fn between(
        bodies: &Bodies,
        group: &[usize],
        others: &[usize],
    ) -> Result<Self, AssemblyError> {
        for &a in group {
            for &b in others {
                bodies.check_without_exceptions([a, b])?;
            }
        }
        let of = |parts: &[usize]| bodies.joined_solid(parts);
        let ((moving, own), (fixed, rest)) = (of(group)?, of(others)?);
        Ok(Self { solids: [moving, fixed], parts: [own, rest] })
    }

    /// Computes the free directions, with the tolerance of the bodies. `cancel` stops the computation.
    ///
    /// # Errors
    /// Returns the errors of [`FreeDirections::compute`].
    pub fn free_directions(
        &self,
        options: FreeOptions,
        cancel: &AtomicBool,
    ) -> Result<FreeDirections<'_>, AssemblyError> {
        let [a, b] = self.solids.each_ref().map(|solid| solid.at(Pose::IDENTITY));
        FreeDirections::compute_unless_cancelled(&a, &b, options.with_tolerance(0.0), cancel)
            .map_err(|error| match error {
                FreeError::Cancelled => AssemblyError::Cancelled,
                other => AssemblyError::Free(other),
            })
    }

    /// Returns the JSON record of the free directions. It contains part names for sides with several parts.
    pub fn to_record(&self, bodies: &Bodies, free: &FreeDirections) -> FreeRecord {
        let several = self.parts.each_ref().map(|parts| parts.len() > 1);
        let name = |part: usize| bodies.assembly().parts()[part].name().to_owned();
        let names = |triangles: [u32; 2]| {
            let parts = self.parts_of_triangles(triangles);
            [0, 1].map(|k| several[k].then(|| name(parts[k])))
        };
        let mut record = FreeRecord::from_directions(free, names);
        record.tolerance = Some(bodies.fit().tolerance());
        record
    }

    /// Returns both solids, each shrunk by half of the tolerance of the bodies.
    pub const fn solids(&self) -> &[Solid; 2] {
        &self.solids
    }

    /// Returns the parts to which the two triangles of an answer belong.
    pub fn parts_of_triangles(&self, triangles: [u32; 2]) -> [usize; 2] {
        [0, 1].map(|k| {
            let facet = self.solids[k].facet_indices()[triangles[k] as usize].index() as u32;
            let after = self.parts[k].partition_point(|&(_, first)| first <= facet);
            self.parts[k][after - 1].0
        })
    }
}
