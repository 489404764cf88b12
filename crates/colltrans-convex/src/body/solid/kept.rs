//! What others make of a solid when they first need it, and keep with it: what it is they know, not this folder.

use std::any::Any;
use std::fmt::Debug;
use std::panic::{RefUnwindSafe, UnwindSafe};
use std::sync::{Arc, OnceLock};

/// Something that can be kept.
pub(crate) trait Keepable: Any + Debug + Send + Sync + UnwindSafe + RefUnwindSafe {
    /// Bytes on the heap.
    fn heap_bytes(&self) -> usize;
}

/// A place for one such thing; clones of the body share it.
#[derive(Debug, Clone, Default)]
pub(crate) struct Kept(OnceLock<Arc<dyn Keepable>>);

impl Kept {
    /// What is kept, made if it is not there; `None` if something else is.
    pub(crate) fn get_or_make<T: Keepable>(&self, make: impl FnOnce() -> T) -> Option<&T> {
        let kept: &dyn Any = &**self.0.get_or_init(|| Arc::new(make()));
        kept.downcast_ref()
    }

    pub(super) fn heap_bytes(&self) -> usize {
        self.0.get().map_or(0, |kept| kept.heap_bytes())
    }
}
