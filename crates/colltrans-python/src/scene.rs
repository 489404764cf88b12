//! The obstacles behind a lock, and queries of one body among them.

use std::collections::HashSet;
use std::sync::{Arc, PoisonError, RwLock, RwLockReadGuard};

use colltrans::solid::SolidOptions;
use colltrans::{
    AnyPlaced, ObstacleId, Options, ProofFile, ProofFileError, QueryError, SceneQuery,
};
use pyo3::prelude::*;

use crate::errors::{OrRaise, error};
use crate::solid::Piece;

/// Obstacles behind a lock. Callers release the interpreter's lock before they wait for it.
#[derive(Default)]
pub(crate) struct Scene(RwLock<SceneState>);

/// The obstacles, and the number of their changes.
#[derive(Default)]
pub(crate) struct SceneState {
    pub(crate) obstacles: colltrans::Obstacles,
    pub(crate) changes: u64,
}

impl Scene {
    pub(crate) fn read(&self) -> RwLockReadGuard<'_, SceneState> {
        self.0.read().unwrap_or_else(PoisonError::into_inner)
    }

    /// Applies a change to the obstacles.
    pub(crate) fn change<T>(&self, of: impl FnOnce(&mut colltrans::Obstacles) -> T) -> T {
        let mut kept = self.0.write().unwrap_or_else(PoisonError::into_inner);
        kept.changes += 1;
        of(&mut kept.obstacles)
    }
}

impl SceneState {
    /// Runs a query of a body among all obstacles that are not ignored.
    pub(crate) fn ask<T, E: From<QueryError>>(
        &self,
        (body, at): (&Piece, colltrans::Pose),
        ignore: &HashSet<u64>,
        question: impl FnOnce(&SceneQuery<'_>) -> Result<T, E>,
    ) -> Result<T, E> {
        let ignored = |id: ObstacleId| ignore.contains(&id.0);
        question(&SceneQuery::new(placed(body, at), &self.obstacles)?.ignoring(&ignored))
    }
}

/// Places a body of either kind at a pose.
fn placed(body: &Piece, at: colltrans::Pose) -> AnyPlaced<'_> {
    match body {
        Piece::Convex(body) => body.get().0.at(at).into(),
        Piece::Solid(solid) => solid.get().solid.at(at).into(),
    }
}

/// Returns the scene query with a minimum gap.
pub(crate) fn with_min_gap<'a>(
    among: &SceneQuery<'a>,
    min_gap: f64,
) -> Result<SceneQuery<'a>, QueryError> {
    let query = among.with_options(Options::default().with_min_gap(min_gap))?;
    Ok(query.with_solid_options(SolidOptions::default().with_min_gap(min_gap)))
}

/// The query of an answer: a body among obstacles.
pub(crate) struct SceneRequest {
    pub(crate) scene: Arc<Scene>,
    /// Number of changes of the scene before the query.
    pub(crate) changes: u64,
    pub(crate) body: Piece,
    pub(crate) at: colltrans::Pose,
    pub(crate) ignore: HashSet<u64>,
}

impl SceneRequest {
    /// Builds the proof of an answer by running the query again. Fails if the obstacles have changed since.
    pub(crate) fn proof(
        &self,
        py: Python<'_>,
        ask: impl FnOnce(&SceneQuery<'_>) -> Result<Option<ProofFile>, ProofFileError> + Send,
    ) -> PyResult<ProofFile> {
        let made = py.detach(|| {
            let kept = self.scene.read();
            if kept.changes != self.changes {
                return Ok(None);
            }
            kept.ask((&self.body, self.at), &self.ignore, ask)
        });
        let changed = "the obstacles have changed since the answer; run the query again";
        made.or_raise()?.ok_or_else(|| error("CaseError", changed))
    }
}
