//! A thread pool that belongs to the process.
//!
//! A child process of `fork` has the memory of its parent but none of its threads. Work that the child hands
//! to rayon's global pool would therefore never end. Invariant: a pool is used only by the process that built
//! it.

use std::sync::{Mutex, PoisonError};

use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};

/// The pool and the process that built it. The lock is held only to read or write this pair.
static POOL: Mutex<Option<(u32, &'static ThreadPool)>> = Mutex::new(None);

/// Runs work whose parallel parts use the pool of this process.
///
/// # Errors
/// Returns an error if the system cannot create the threads.
pub(crate) fn run<T: Send>(work: impl FnOnce() -> T + Send) -> Result<T, ThreadPoolBuildError> {
    Ok(pool_of_process()?.install(work))
}

/// Returns the pool of this process, which is built once and lives as long as the process.
fn pool_of_process() -> Result<&'static ThreadPool, ThreadPoolBuildError> {
    let process = std::process::id();
    let kept = || POOL.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((_, pool)) = kept().filter(|(owner, _)| *owner == process) {
        return Ok(pool);
    }
    let built = Box::new(ThreadPoolBuilder::new().build()?);
    // If another thread has built a pool in the meantime, this pool is dropped.
    let mut kept = kept();
    match *kept {
        Some((owner, pool)) if owner == process => Ok(pool),
        _ => Ok(kept.insert((process, Box::leak(built))).1),
    }
}
