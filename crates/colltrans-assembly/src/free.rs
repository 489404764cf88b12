//! All directions along which a part or group can leave the others, proven.
//!
//! Parts keep their places, so the others are one solid, and the group is another: what blocks is a pair of facets of
//! two parts, whatever solids these are in.

use std::sync::atomic::AtomicBool;

use colltrans::free::{FreeDirections, FreeError, FreeOptions};
use colltrans::record::FreeRecord;
use colltrans::{Pose, Solid};

use crate::bodies::Bodies;
use crate::error::AssemblyError;

/// A group and the others, each as one solid.
#[derive(Debug, Clone)]
pub struct Removal {
    solids: [Solid; 2],
    /// The parts of either, and where the facets of each begin among those of all.
    parts: [Vec<(usize, u32)>; 2],
}

impl Removal {
    /// A group against all parts that are not in it.
    ///
    /// # Errors
    /// A group of none or of all; parts that are to be kept apart; parts that are ignored, or that overlap where they are.
    pub fn new(bodies: &Bodies, group: &[usize]) -> Result<Self, AssemblyError> {
        let others: Vec<usize> = (0..bodies.len()).filter(|k| !group.contains(k)).collect();
        if group.is_empty() || others.is_empty() {
            return Err(AssemblyError::Removal { count: group.len(), of: bodies.len() });
        }
        Self::among(bodies, group, &others)
    }

    /// A group against others.
    pub(crate) fn among(
        bodies: &Bodies,
        group: &[usize],
        others: &[usize],
    ) -> Result<Self, AssemblyError> {
        for &a in group {
            for &b in others {
                bodies.check_plain([a, b])?;
            }
        }
        let of = |parts: &[usize]| bodies.joined(parts);
        let ((moving, own), (fixed, rest)) = (of(group)?, of(others)?);
        Ok(Self { solids: [moving, fixed], parts: [own, rest] })
    }

    /// The directions that are free. The tolerance is that of the bodies.
    ///
    /// # Errors
    /// As [`FreeDirections::of`].
    pub fn directions(
        &self,
        options: FreeOptions,
        cancel: &AtomicBool,
    ) -> Result<FreeDirections<'_>, AssemblyError> {
        let [a, b] = self.solids.each_ref().map(|solid| solid.at(Pose::IDENTITY));
        FreeDirections::of_unless(&a, &b, options.with_tolerance(0.0), cancel).map_err(|error| {
            match error {
                FreeError::Cancelled => AssemblyError::Cancelled,
                other => AssemblyError::Free(other),
            }
        })
    }

    /// What was found as it is written; of several parts on a side with their names.
    pub fn record(&self, bodies: &Bodies, free: &FreeDirections) -> FreeRecord {
        let several = self.parts.each_ref().map(|parts| parts.len() > 1);
        let name = |part: usize| bodies.assembly().parts()[part].name().to_owned();
        let names = |triangles: [u32; 2]| {
            let parts = self.parts(triangles);
            [0, 1].map(|k| several[k].then(|| name(parts[k])))
        };
        let mut record = FreeRecord::of(free, names);
        record.tolerance = Some(bodies.fit().tolerance());
        record
    }

    /// Both as solids, as they are asked: shrunk by half the tolerance of the bodies.
    pub const fn solids(&self) -> &[Solid; 2] {
        &self.solids
    }

    /// The parts that two triangles of an answer belong to.
    pub fn parts(&self, triangles: [u32; 2]) -> [usize; 2] {
        [0, 1].map(|k| {
            let facet = self.solids[k].facet_indices()[triangles[k] as usize].index() as u32;
            let after = self.parts[k].partition_point(|&(_, first)| first <= facet);
            self.parts[k][after - 1].0
        })
    }
}
