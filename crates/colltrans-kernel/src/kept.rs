//! Lets others keep with a body what they make of it when they first need it. They know what it is, the body does not.

use std::any::Any;
use std::fmt::Debug;
use std::panic::{RefUnwindSafe, UnwindSafe};
use std::sync::{Arc, OnceLock};

/// Something that can be kept.
pub trait Keepable: Any + Debug + Send + Sync + UnwindSafe + RefUnwindSafe {
    /// Bytes on the heap.
    fn heap_bytes(&self) -> usize;
}

/// A place for one such thing; clones of the body share it.
#[derive(Debug, Clone, Default)]
pub struct Kept(OnceLock<Arc<dyn Keepable>>);

impl Kept {
    /// What is kept, made if it is not there; `None` if something else is.
    pub fn get_or_make<T: Keepable>(&self, make: impl FnOnce() -> T) -> Option<&T> {
        let kept: &dyn Any = &**self.0.get_or_init(|| Arc::new(make()));
        kept.downcast_ref()
    }

    pub fn heap_bytes(&self) -> usize {
        self.0.get().map_or(0, |kept| kept.heap_bytes())
    }
}
