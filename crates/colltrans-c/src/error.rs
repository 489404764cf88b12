//! The boundary: status codes and their text, the guard of all entry points, and the reading of pointers.

use std::any::Any;
use std::cell::RefCell;
use std::ffi::{CString, c_char};
use std::fmt::Display;
use std::panic::{AssertUnwindSafe, catch_unwind};

use colltrans::glam::DVec3;
use colltrans::motion::MotionError;
use colltrans::solid::SolidError;
use colltrans::{BuildError, PoseError, ProofError, ProofFileError, QueryError};

/// Result of a call. `colltrans_error_message` has the text of a failure.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// The call succeeded.
    Ok = 0,
    /// A required pointer is null.
    NullArgument = 1,
    /// A pointer is not aligned to its type.
    MisalignedArgument = 2,
    /// An argument is not finite, out of range, or does not fit the other ones.
    InvalidArgument = 3,
    /// Points or facets do not form a body.
    InvalidBody = 4,
    /// The search ended without an answer. The known cases have bodies thinner than the rounding error.
    NoAnswer = 5,
    /// A proof does not hold or cannot be built, or the text is not a proof.
    NotProven = 6,
    /// A defect of the library. Please report it.
    InternalError = 7,
}

/// A failed call: its status and its text.
#[derive(Debug)]
pub(crate) struct Failure {
    status: Status,
    message: String,
}

/// Result of the inner part of an entry point.
pub(crate) type Fallible<T> = Result<T, Failure>;

thread_local! {
    static LAST_MESSAGE: RefCell<CString> = RefCell::default();
}

/// Returns the text of the last call that failed on this thread, in UTF-8. It is empty if none failed, and valid until
/// the next failure on this thread.
#[unsafe(no_mangle)]
pub extern "C" fn colltrans_error_message() -> *const c_char {
    LAST_MESSAGE.try_with(|last| last.borrow().as_ptr()).unwrap_or(c"".as_ptr())
}

/// Runs the inner part of an entry point, and stores the text of a failure.
#[inline]
pub(crate) fn guard(run: impl FnOnce() -> Fallible<()>) -> Status {
    match caught(run) {
        Ok(()) => Status::Ok,
        Err(failure) => failure.store(),
    }
}

/// Runs a part of a call. A panic is the failure [`Status::InternalError`] with the text of the panic.
#[inline]
pub(crate) fn caught<T>(run: impl FnOnce() -> Fallible<T>) -> Fallible<T> {
    match catch_unwind(AssertUnwindSafe(run)) {
        Ok(result) => result,
        Err(panic) => Err(Failure::of_panic(&*panic)),
    }
}

impl Failure {
    pub(crate) fn new(status: Status, message: impl Display) -> Self {
        Self { status, message: message.to_string() }
    }

    /// Builds the failure of the argument called `name`.
    pub(crate) fn invalid(name: &str, what: impl Display) -> Self {
        Self::new(Status::InvalidArgument, format_args!("{name}: {what}"))
    }

    #[cold]
    fn of_panic(panic: &(dyn Any + Send)) -> Self {
        let text = panic.downcast_ref::<&str>().copied();
        let text = text.or_else(|| panic.downcast_ref::<String>().map(String::as_str));
        let text = text.unwrap_or("no message");
        let what = format_args!("internal error, please report it: {text}");
        Self::new(Status::InternalError, what)
    }

    pub(crate) const fn status(&self) -> Status {
        self.status
    }

    /// Returns the failure with a context before its text.
    pub(crate) fn within(self, context: impl Display) -> Self {
        Self { message: format!("{context}: {}", self.message), ..self }
    }

    #[cold]
    fn store(self) -> Status {
        // A text for C ends at the first null byte.
        let bytes = self.message.into_bytes().into_iter().filter(|byte| *byte != 0).collect();
        if let Ok(text) = CString::new::<Vec<u8>>(bytes) {
            // Without storage, at the end of a thread, the text is lost.
            let _ = LAST_MESSAGE.try_with(|last| last.replace(text));
        }
        self.status
    }
}

impl From<QueryError> for Failure {
    fn from(error: QueryError) -> Self {
        let mut cause = &error;
        while let QueryError::Obstacle { reason, .. } = cause {
            cause = reason;
        }
        let status = match cause {
            QueryError::NotConverged { .. } => Status::NoAnswer,
            QueryError::NotASolid { .. } => Status::InvalidBody,
            _ => Status::InvalidArgument,
        };
        Self::new(status, error)
    }
}

impl From<ProofFileError> for Failure {
    fn from(error: ProofFileError) -> Self {
        match error {
            ProofFileError::Query(error) => error.into(),
            error => Self::new(Status::NotProven, error),
        }
    }
}

/// Borrows the answer of a query. Moved out of its result, an answer would be copied.
#[inline]
pub(crate) fn found<T>(result: &Result<T, QueryError>) -> Fallible<&T> {
    result.as_ref().map_err(|error| error.clone().into())
}

macro_rules! failures {
    ($($status:ident: $($error:ty),+;)+) => {$($(
        impl From<$error> for Failure {
            fn from(error: $error) -> Self {
                Self::new(Status::$status, error)
            }
        }
    )+)+};
}
failures! {
    InvalidBody: BuildError, SolidError;
    InvalidArgument: PoseError, MotionError;
    NotProven: ProofError;
}

/// A failure that can be attributed to an argument.
pub(crate) trait OfArgument<T> {
    /// Attributes a failure to the argument called `name`.
    fn of(self, name: &str) -> Fallible<T>;
}

impl<T, E: Into<Failure>> OfArgument<T> for Result<T, E> {
    #[inline]
    fn of(self, name: &str) -> Fallible<T> {
        self.map_err(|error| error.into().within(name))
    }
}

#[cold]
fn pointer_failure<T>(pointer: *const T, name: &str) -> Failure {
    if pointer.is_null() {
        return Failure::new(Status::NullArgument, format_args!("{name}: the pointer is null"));
    }
    let alignment = align_of::<T>();
    let what = format_args!("{name}: the pointer is not aligned to {alignment} bytes");
    Failure::new(Status::MisalignedArgument, what)
}

/// Checks the pointer argument called `name`.
#[inline]
fn check<T>(pointer: *const T, name: &str) -> Fallible<()> {
    let is_sound = !pointer.is_null() && pointer.is_aligned();
    if is_sound { Ok(()) } else { Err(pointer_failure(pointer, name)) }
}

/// Reads the pointer argument called `name`.
#[inline]
pub(crate) unsafe fn reference<'a, T>(pointer: *const T, name: &str) -> Fallible<&'a T> {
    check(pointer, name)?;
    // SAFETY: the caller passes a pointer to an object, or null.
    Ok(unsafe { &*pointer })
}

/// Reads the pointer argument called `name`, whose object the call changes.
#[inline]
pub(crate) unsafe fn exclusive<'a, T>(pointer: *mut T, name: &str) -> Fallible<&'a mut T> {
    check(pointer, name)?;
    // SAFETY: as above; no other thread uses the object during the call.
    Ok(unsafe { &mut *pointer })
}

/// Reads the pointer argument called `name`, which may be null.
#[inline]
pub(crate) unsafe fn optional<'a, T>(pointer: *const T, name: &str) -> Fallible<Option<&'a T>> {
    // SAFETY: as for `reference`.
    if pointer.is_null() { Ok(None) } else { unsafe { reference(pointer, name) }.map(Some) }
}

/// Reads the array argument called `name`. It may be null if it has no elements.
#[inline]
pub(crate) unsafe fn array<'a, T>(
    pointer: *const T,
    count: usize,
    name: &str,
) -> Fallible<&'a [T]> {
    if count == 0 {
        return Ok(&[]);
    }
    check_room(pointer, count, name)?;
    // SAFETY: the caller passes a pointer to as many objects, and their size fits.
    Ok(unsafe { std::slice::from_raw_parts(pointer, count) })
}

/// Checks the pointer and the size of the array called `name`.
pub(crate) fn check_room<T>(pointer: *const T, count: usize, name: &str) -> Fallible<()> {
    check(pointer, name)?;
    let bytes = count.checked_mul(size_of::<T>()).filter(|bytes| isize::try_from(*bytes).is_ok());
    let what = || Failure::invalid(name, format_args!("{count} elements do not fit into memory"));
    bytes.map(|_| ()).ok_or_else(what)
}

/// Reads the three numbers of the argument called `name`.
#[inline]
pub(crate) unsafe fn vector(pointer: *const f64, name: &str) -> Fallible<DVec3> {
    // SAFETY: the caller passes a pointer to three numbers, or null.
    let three: &[f64; 3] = unsafe { reference(pointer.cast(), name) }?;
    Ok(DVec3::from_array(*three))
}

/// Reads the points of the argument called `name`, three numbers each.
pub(crate) unsafe fn points(pointer: *const f64, count: usize, name: &str) -> Fallible<Vec<DVec3>> {
    // SAFETY: the caller passes a pointer to three times as many numbers, or null.
    let points: &[[f64; 3]] = unsafe { array(pointer.cast(), count, name) }?;
    Ok(points.iter().map(|point| DVec3::from_array(*point)).collect())
}

/// A pointer to which an answer is written if the call succeeds.
pub(crate) struct Output<T>(*mut T);

impl<T> Clone for Output<T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for Output<T> {}

impl<T> From<&mut T> for Output<T> {
    fn from(place: &mut T) -> Self {
        Self(place)
    }
}

impl<T> Output<T> {
    /// Checks the pointer argument called `name`.
    #[inline]
    pub(crate) fn new(pointer: *mut T, name: &str) -> Fallible<Self> {
        check(pointer, name)?;
        Ok(Self(pointer))
    }

    /// Writes the answer, and returns where it is. The old content is not read.
    #[inline]
    pub(crate) unsafe fn set<'a>(self, value: T) -> &'a mut T {
        // SAFETY: the caller passes a pointer to memory for the answer, and it was checked.
        unsafe {
            self.0.write(value);
            &mut *self.0
        }
    }
}

impl<T> Output<*mut T> {
    /// Writes a new handle.
    #[inline]
    pub(crate) unsafe fn set_handle(self, value: T) {
        // SAFETY: as for `set`.
        unsafe { self.set(Box::into_raw(Box::new(value))) };
    }
}

/// Frees a handle; null is accepted. The functions for it have no status, so a failure is only stored.
pub(crate) unsafe fn free<T>(handle: *mut T) {
    guard(|| {
        if !handle.is_null() {
            check(handle, "handle")?;
            // SAFETY: the handle is from `set_handle` and freed once.
            drop(unsafe { Box::from_raw(handle) });
        }
        Ok(())
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    fn last_message() -> String {
        // SAFETY: the text is valid until the next failure.
        let text = unsafe { std::ffi::CStr::from_ptr(colltrans_error_message()) };
        text.to_string_lossy().into_owned()
    }

    #[test]
    fn a_panic_is_a_status_with_its_text() {
        assert_eq!(guard(|| panic!("row {}", 3)), Status::InternalError);
        assert_eq!(last_message(), "internal error, please report it: row 3");
        assert_eq!(guard(|| panic!("fixed text")), Status::InternalError);
        assert_eq!(last_message(), "internal error, please report it: fixed text");
    }

    #[test]
    fn a_text_with_null_bytes_is_stored_without_them() {
        let failed = guard(|| Err(Failure::invalid("name", "a\0b")));
        assert_eq!((failed, last_message()), (Status::InvalidArgument, "name: ab".to_owned()));
        assert_eq!((guard(|| Ok(())), last_message()), (Status::Ok, "name: ab".to_owned()));
    }
}
