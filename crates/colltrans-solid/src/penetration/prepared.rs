//! One pair of solids for several queries about their interiors.

use std::cell::OnceCell;
use std::fmt;

use super::common::{CommonPart, VolumeOptions, common_part};
use super::depth::{SolidDepth, prepared_depth};
use super::surface::{SurfaceDistance, surface_distance};
use crate::body::Solid;
use crate::pair::pair_scene;
use crate::solve::overlap::{Overlap, find_overlap};
use crate::solve::scene::PairFrame;
use crate::solve::steps::SolidSteps;
use colltrans_convex::pair::Pair;
use colltrans_convex::setting::error::QueryError;

/// A pair of solids for several queries of [`SolidPenetration`](super::SolidPenetration). The overlap test and the
/// distance of the surfaces are computed at most once.
pub struct PreparedPair<'p, 'a> {
    pub(super) pair: &'p Pair<'a, Solid>,
    pub(super) scene: PairFrame<'a>,
    overlap: OnceCell<Option<Overlap>>,
    surfaces: OnceCell<SurfaceDistance>,
}

impl fmt::Debug for PreparedPair<'_, '_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("PreparedPair").field("pair", self.pair).finish_non_exhaustive()
    }
}

impl<'p, 'a> PreparedPair<'p, 'a> {
    /// Prepares the queries of a pair.
    ///
    /// # Errors
    /// Returns the error of [`Pair::distance`].
    pub fn new(pair: &'p Pair<'a, Solid>) -> Result<Self, QueryError> {
        let (overlap, surfaces) = (OnceCell::new(), OnceCell::new());
        Ok(Self { pair, scene: pair_scene(pair)?, overlap, surfaces })
    }

    /// Computes [`SolidPenetration::surface_distance`](super::SolidPenetration::surface_distance).
    ///
    /// # Errors
    /// Returns [`QueryError::NotASolid`] for a rounded body.
    pub fn surface_distance(&self) -> Result<SurfaceDistance, QueryError> {
        if let Some(found) = self.surfaces.get() {
            return Ok(*found);
        }
        let found = surface_distance(self.pair, &self.scene)?;
        Ok(*self.surfaces.get_or_init(|| found))
    }

    /// Computes [`SolidPenetration::common_part`](super::SolidPenetration::common_part).
    ///
    /// # Errors
    /// Returns [`QueryError::NotASolid`] for a rounded body.
    pub fn common_part(&self, options: VolumeOptions) -> Result<CommonPart, QueryError> {
        common_part(self, options)
    }

    /// Computes [`SolidPenetration::depth`](super::SolidPenetration::depth).
    ///
    /// # Errors
    /// Returns the error of [`Pair::distance`].
    pub fn depth(&self) -> Result<SolidDepth, QueryError> {
        Ok(prepared_depth(self)?.0)
    }

    /// Finds an overlap of the cores.
    pub(super) fn overlap(&self) -> Option<Overlap> {
        let find = || find_overlap(&self.scene, &mut SolidSteps::default());
        *self.overlap.get_or_init(find)
    }
}
