//! Ordinary files, and nothing else: a device has no end, and a pipe without a writer waits for ever.

use std::fs::{File, Metadata};
use std::io::{Error, ErrorKind, Read, Result};
use std::path::Path;

/// The bytes of an ordinary file.
///
/// # Errors
/// What the operating system says; and that a folder, a device, a pipe or a socket is no file, which
/// is not opened.
pub fn bytes(path: impl AsRef<Path>) -> Result<Vec<u8>> {
    let path = path.as_ref();
    // Opening a pipe waits for a writer: asked before, and again of what was opened.
    ordinary(&path.metadata()?)?;
    let mut file = File::open(path)?;
    let metadata = file.metadata()?;
    ordinary(&metadata)?;
    let mut bytes = Vec::new();
    // A file may say that it is larger than any memory.
    bytes.try_reserve_exact(usize::try_from(metadata.len()).unwrap_or(usize::MAX))?;
    file.read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// The text of an ordinary file, without a byte-order mark.
///
/// # Errors
/// As [`bytes`], and text that is not UTF-8.
pub fn text(path: impl AsRef<Path>) -> Result<String> {
    decoded(bytes(path)?)
}

/// The text that bytes are in UTF-8, without a byte-order mark.
///
/// # Errors
/// They are not UTF-8; where a mark says that they are UTF-16, so does the error.
pub fn decoded(bytes: Vec<u8>) -> Result<String> {
    let refused = |what| Error::new(ErrorKind::InvalidData, what);
    if crate::text::is_wide(&bytes) {
        return Err(refused("text in UTF-16; save the file as UTF-8"));
    }
    let text = String::from_utf8(bytes).map_err(|_| refused("not text in UTF-8"))?;
    Ok(text.strip_prefix('\u{feff}').map(str::to_owned).unwrap_or(text))
}

fn ordinary(metadata: &Metadata) -> Result<()> {
    if metadata.is_file() {
        return Ok(());
    }
    let what = if metadata.is_dir() { "a folder" } else { "a device or a pipe" };
    Err(Error::new(ErrorKind::InvalidInput, format!("{what}, not an ordinary file")))
}
