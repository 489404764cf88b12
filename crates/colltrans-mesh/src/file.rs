//! Reads regular files only, because a device has no end, and a pipe without a writer blocks.

use std::fs::{File, Metadata};
use std::io::{Error, ErrorKind, Read, Result};
use std::path::Path;

/// Returns the contents of a regular file.
///
/// # Errors
/// The error of the operating system. A folder, a device, a pipe or a socket is rejected without opening it.
pub fn bytes(path: impl AsRef<Path>) -> Result<Vec<u8>> {
    let path = path.as_ref();
    // Opening a pipe would block until it has a writer. Therefore the kind is checked before and after opening.
    require_regular_file(&path.metadata()?)?;
    let mut file = File::open(path)?;
    let metadata = file.metadata()?;
    require_regular_file(&metadata)?;
    let mut bytes = Vec::new();
    // The size that a file reports may exceed the memory.
    bytes.try_reserve_exact(usize::try_from(metadata.len()).unwrap_or(usize::MAX))?;
    file.read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Returns the text of a regular file, without a byte-order mark.
///
/// # Errors
/// The errors of [`bytes`], and an error if the text is not UTF-8.
pub fn text(path: impl AsRef<Path>) -> Result<String> {
    decode_text(bytes(path)?)
}

/// Decodes UTF-8, and removes a byte-order mark.
///
/// # Errors
/// An error if the bytes are not UTF-8. It names UTF-16 if their mark indicates that.
pub fn decode_text(bytes: Vec<u8>) -> Result<String> {
    let refused = |what| Error::new(ErrorKind::InvalidData, what);
    if crate::text::is_wide(&bytes) {
        return Err(refused("text in UTF-16; save the file as UTF-8"));
    }
    let text = String::from_utf8(bytes)
        .map_err(|_| refused("not text in UTF-8; save the file as UTF-8"))?;
    Ok(text.strip_prefix('\u{feff}').map(str::to_owned).unwrap_or(text))
}

/// Rejects anything except a regular file.
fn require_regular_file(metadata: &Metadata) -> Result<()> {
    if metadata.is_file() {
        return Ok(());
    }
    let what = if metadata.is_dir() { "a folder" } else { "a device or a pipe" };
    Err(Error::new(ErrorKind::InvalidInput, format!("{what}, not a regular file")))
}
