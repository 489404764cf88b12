//! Progress reports of a run to an observer, and cancellation by a flag.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use crate::error::AssemblyError;

/// A stage of the work.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Stage {
    /// Overlaps at the start.
    Start,
    /// Contacts between parts.
    Liaisons,
    /// Free travel and contacts along directions.
    Rooms,
    /// The plan.
    Plan,
    /// Removal maps.
    Map,
    /// Proofs of the findings of an audit.
    Proofs,
    /// Pictures of the findings of an audit.
    Pictures,
}

impl Stage {
    /// Returns a short name for users.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Start => "overlaps",
            Self::Liaisons => "contacts",
            Self::Rooms => "rooms",
            Self::Plan => "plan",
            Self::Map => "map",
            Self::Proofs => "proofs",
            Self::Pictures => "pictures",
        }
    }
}

/// Callback with the stage, the number of finished items and their total number.
pub(crate) type Progress<'a> = &'a (dyn Fn(Stage, usize, usize) + Sync);

/// Observer of a run. The default neither reports nor cancels.
#[derive(Clone, Copy, Default)]
pub struct Watch<'a> {
    cancel: Option<&'a AtomicBool>,
    progress: Option<Progress<'a>>,
}

impl<'a> Watch<'a> {
    /// Returns a watch with a cancellation flag. Work ends with [`AssemblyError::Cancelled`] soon after the flag is
    /// set.
    #[must_use]
    pub const fn with_cancel(self, cancel: &'a AtomicBool) -> Self {
        Self { cancel: Some(cancel), ..self }
    }

    /// Returns a watch with a progress callback. It is called from any thread and in no particular order.
    #[must_use]
    pub const fn with_progress(self, progress: Progress<'a>) -> Self {
        Self { progress: Some(progress), ..self }
    }

    /// Returns the cancellation flag, or `None` if the run cannot be cancelled.
    pub(crate) const fn cancel_flag(&self) -> Option<&'a AtomicBool> {
        self.cancel
    }

    pub(crate) fn check_cancelled(&self) -> Result<(), AssemblyError> {
        let cancelled = self.cancel.is_some_and(|flag| flag.load(Ordering::Relaxed));
        if cancelled { Err(AssemblyError::Cancelled) } else { Ok(()) }
    }

    /// Starts a stage with a total number of items.
    pub(crate) fn start_stage(&self, stage: Stage, total: usize) -> StageProgress<'a> {
        let tally = StageProgress { watch: *self, stage, total, done: AtomicUsize::new(0) };
        tally.notify(0);
        tally
    }
}

/// Progress of one stage.
pub(crate) struct StageProgress<'a> {
    watch: Watch<'a>,
    stage: Stage,
    total: usize,
    done: AtomicUsize,
}

impl StageProgress<'_> {
    /// Counts a finished item. Returns an error if the run is cancelled.
    pub(crate) fn finish_item(&self) -> Result<(), AssemblyError> {
        self.notify(self.done.fetch_add(1, Ordering::Relaxed) + 1);
        self.watch.check_cancelled()
    }

    fn notify(&self, done: usize) {
        if let Some(progress) = self.watch.progress {
            progress(self.stage, done, self.total);
        }
    }
}
