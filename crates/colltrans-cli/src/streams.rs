//! Standard output, and whether it was closed when the program started.
//!
//! Rust's runtime opens `/dev/null` in the place of a closed standard stream before `main`, so that answers are written
//! and lost without an error. The system calls the functions of one section of a program before that: [`look`] is one
//! of them.

use std::io::{self, Stdout};
use std::sync::atomic::{AtomicBool, Ordering};

static IS_CLOSED: AtomicBool = AtomicBool::new(false);

/// Notes whether there is a standard output.
#[cfg(any(
    target_os = "linux",
    target_os = "android",
    target_os = "freebsd",
    target_vendor = "apple"
))]
extern "C" fn look() {
    IS_CLOSED.store(rustix::io::fcntl_getfd(io::stdout()).is_err(), Ordering::Relaxed);
}

#[cfg(any(
    target_os = "linux",
    target_os = "android",
    target_os = "freebsd",
    target_vendor = "apple"
))]
#[expect(unsafe_code, reason = "the section of a static is named; there is no unsafe block")]
mod at_start {
    #[used]
    #[cfg_attr(target_vendor = "apple", unsafe(link_section = "__DATA,__mod_init_func"))]
    #[cfg_attr(not(target_vendor = "apple"), unsafe(link_section = ".init_array"))]
    static LOOK: extern "C" fn() = super::look;
}

/// Returns standard output.
///
/// # Errors
/// It was closed when the program started.
pub(crate) fn standard_output() -> io::Result<Stdout> {
    if IS_CLOSED.load(Ordering::Relaxed) {
        return Err(io::Error::other("it is closed"));
    }
    Ok(io::stdout())
}
