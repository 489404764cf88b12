//! Progress of a run for an observer, and a flag that cancels it.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use crate::error::AssemblyError;

/// What is being done.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Stage {
    /// Overlaps at the start.
    Start,
    /// Who touches whom.
    Liaisons,
    /// Rooms and blocking, by direction.
    Rooms,
    /// The plan.
    Plan,
    /// A removal map.
    Map,
}

impl Stage {
    /// A word for people.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Start => "overlaps",
            Self::Liaisons => "contacts",
            Self::Rooms => "rooms",
            Self::Plan => "plan",
            Self::Map => "map",
        }
    }
}

/// Called with what is being done, how much of it is done, and how much there is.
pub(crate) type Progress<'a> = &'a (dyn Fn(Stage, usize, usize) + Sync);

/// An observer of a run: none, by default.
#[derive(Clone, Copy, Default)]
pub struct Watch<'a> {
    cancel: Option<&'a AtomicBool>,
    progress: Option<Progress<'a>>,
}

impl<'a> Watch<'a> {
    /// Work ends with [`AssemblyError::Cancelled`] soon after the flag is set.
    #[must_use]
    pub const fn with_cancel(self, cancel: &'a AtomicBool) -> Self {
        Self { cancel: Some(cancel), ..self }
    }

    /// Calls back, from any thread, in no certain order.
    #[must_use]
    pub const fn with_progress(self, progress: Progress<'a>) -> Self {
        Self { progress: Some(progress), ..self }
    }

    /// What is set to cancel.
    pub(crate) const fn flag(&self) -> Option<&'a AtomicBool> {
        self.cancel
    }

    pub(crate) fn check(&self) -> Result<(), AssemblyError> {
        let cancelled = self.cancel.is_some_and(|flag| flag.load(Ordering::Relaxed));
        if cancelled { Err(AssemblyError::Cancelled) } else { Ok(()) }
    }

    /// Counts up to `total`.
    pub(crate) fn stage(&self, stage: Stage, total: usize) -> Tally<'a> {
        let tally = Tally { watch: *self, stage, total, done: AtomicUsize::new(0) };
        tally.tell(0);
        tally
    }
}

/// Work of one stage.
pub(crate) struct Tally<'a> {
    watch: Watch<'a>,
    stage: Stage,
    total: usize,
    done: AtomicUsize,
}

impl Tally<'_> {
    /// One more is done; or it is to end.
    pub(crate) fn step(&self) -> Result<(), AssemblyError> {
        self.tell(self.done.fetch_add(1, Ordering::Relaxed) + 1);
        self.watch.check()
    }

    fn tell(&self, done: usize) {
        if let Some(progress) = self.watch.progress {
            progress(self.stage, done, self.total);
        }
    }
}
