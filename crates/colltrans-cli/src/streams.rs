//! Standard output, and whether it was closed when the program started.
//!
//! Before `main`, the runtime of Rust replaces a closed standard stream by `/dev/null`, so that answers would be lost
//! without an error. The system calls the functions in one section of the program before that;
//! [`record_closed_output`] is one of them.

use std::io::{self, Stdout};
use std::sync::atomic::{AtomicBool, Ordering};

static IS_CLOSED: AtomicBool = AtomicBool::new(false);

/// Records whether standard output is closed.
#[cfg(any(
    target_os = "linux",
    target_os = "android",
    target_os = "freebsd",
    target_vendor = "apple"
))]
extern "C" fn record_closed_output() {
    IS_CLOSED.store(rustix::io::fcntl_getfd(io::stdout()).is_err(), Ordering::Relaxed);
}

#[cfg(any(
    target_os = "linux",
    target_os = "android",
    target_os = "freebsd",
    target_vendor = "apple"
))]
#[expect(
    unsafe_code,
    reason = "naming the section of a static is unsafe; there is no unsafe block"
)]
mod at_start {
    #[used]
    #[cfg_attr(target_vendor = "apple", unsafe(link_section = "__DATA,__mod_init_func"))]
    #[cfg_attr(not(target_vendor = "apple"), unsafe(link_section = ".init_array"))]
    static RECORD_CLOSED_OUTPUT: extern "C" fn() = super::record_closed_output;
}

/// Returns standard output.
///
/// # Errors
/// Standard output was closed when the program started.
pub(crate) fn standard_output() -> io::Result<Stdout> {
    if IS_CLOSED.load(Ordering::Relaxed) {
        return Err(io::Error::other("it is closed"));
    }
    Ok(io::stdout())
}
