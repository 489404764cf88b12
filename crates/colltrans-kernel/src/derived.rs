//! A slot in a body for data that another module derives from the body on first use. The body does not depend
//! on the type of the data.

use std::any::Any;
use std::fmt::Debug;
use std::panic::{RefUnwindSafe, UnwindSafe};
use std::sync::{Arc, OnceLock};

/// Derived data that a body can store.
pub trait DerivedData: Any + Debug + Send + Sync + UnwindSafe + RefUnwindSafe {
    /// Returns the number of bytes on the heap.
    fn heap_bytes(&self) -> usize;
}

/// A slot for one value of derived data. Clones of a body share a value that was stored before the body was
/// cloned. Clones of an empty slot store separate values.
#[derive(Debug, Clone, Default)]
pub struct DerivedDataSlot(OnceLock<Arc<dyn DerivedData>>);

impl DerivedDataSlot {
    /// Returns the stored value, or stores `make()` in an empty slot. `None` if the slot contains a value of
    /// another type.
    pub fn get_or_make<T: DerivedData>(&self, make: impl FnOnce() -> T) -> Option<&T> {
        let kept: &dyn Any = &**self.0.get_or_init(|| Arc::new(make()));
        kept.downcast_ref()
    }

    /// Returns the number of bytes of the stored value on the heap; 0 for an empty slot.
    pub fn heap_bytes(&self) -> usize {
        self.0.get().map_or(0, |kept| kept.heap_bytes())
    }
}
