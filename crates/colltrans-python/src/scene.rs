//! Obstacles behind a lock, and a body that was asked about among them.

use std::collections::HashSet;
use std::sync::{Arc, PoisonError, RwLock, RwLockReadGuard};

use colltrans::solid::SolidOptions;
use colltrans::{Among, AnyPlaced, ObstacleId, Options, ProofFile, ProofFileError, QueryError};
use pyo3::prelude::*;

use crate::errors::{OrRaise, error};
use crate::solid::Piece;

/// Obstacles; whoever waits for them does so without the interpreter's lock.
#[derive(Default)]
pub(crate) struct Scene(RwLock<Kept>);

/// The obstacles, and how often they have changed.
#[derive(Default)]
pub(crate) struct Kept {
    pub(crate) obstacles: colltrans::Obstacles,
    pub(crate) changes: u64,
}

impl Scene {
    pub(crate) fn read(&self) -> RwLockReadGuard<'_, Kept> {
        self.0.read().unwrap_or_else(PoisonError::into_inner)
    }

    /// Changes the obstacles.
    pub(crate) fn change<T>(&self, of: impl FnOnce(&mut colltrans::Obstacles) -> T) -> T {
        let mut kept = self.0.write().unwrap_or_else(PoisonError::into_inner);
        kept.changes += 1;
        of(&mut kept.obstacles)
    }
}

impl Kept {
    /// Asks about a body among all that are not ignored.
    pub(crate) fn ask<T, E: From<QueryError>>(
        &self,
        (body, at): (&Piece, colltrans::Pose),
        ignore: &HashSet<u64>,
        question: impl FnOnce(&Among<'_>) -> Result<T, E>,
    ) -> Result<T, E> {
        let ignored = |id: ObstacleId| ignore.contains(&id.0);
        question(&Among::new(placed(body, at), &self.obstacles)?.ignoring(&ignored))
    }
}

/// A body of either kind where it is.
fn placed(body: &Piece, at: colltrans::Pose) -> AnyPlaced<'_> {
    match body {
        Piece::Convex(body) => body.get().0.at(at).into(),
        Piece::Solid(solid) => solid.get().solid.at(at).into(),
    }
}

/// The same question of a body that is to keep a gap.
pub(crate) fn keeping<'a>(among: &Among<'a>, keep: f64) -> Result<Among<'a>, QueryError> {
    let keeping = among.with_options(Options::default().with_keep(keep))?;
    Ok(keeping.with_solid_options(SolidOptions::default().with_keep(keep)))
}

/// A body among obstacles, as it was asked about.
pub(crate) struct Asked {
    pub(crate) scene: Arc<Scene>,
    /// How often the scene had changed by then.
    pub(crate) changes: u64,
    pub(crate) body: Piece,
    pub(crate) at: colltrans::Pose,
    pub(crate) ignore: HashSet<u64>,
}

impl Asked {
    /// A proof of an answer that the obstacles give once more, if they are as they were.
    pub(crate) fn proof(
        &self,
        py: Python<'_>,
        ask: impl FnOnce(&Among<'_>) -> Result<Option<ProofFile>, ProofFileError> + Send,
    ) -> PyResult<ProofFile> {
        let made = py.detach(|| {
            let kept = self.scene.read();
            if kept.changes != self.changes {
                return Ok(None);
            }
            kept.ask((&self.body, self.at), &self.ignore, ask)
        });
        let changed = "the obstacles are not those of the answer: some have come, moved or gone";
        made.or_raise()?.ok_or_else(|| error("CaseError", changed))
    }
}
