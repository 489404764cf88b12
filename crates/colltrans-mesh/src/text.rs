//! Text in files: byte-order marks, line ends, and words for messages.

use crate::digits::Printed;
use crate::error::{Fault, Place};

/// The byte-order mark of UTF-8.
const UTF8_MARK: &[u8] = b"\xef\xbb\xbf";

/// Checks whether the bytes begin with a byte-order mark of UTF-16, or of little-endian UTF-32, which begins with the
/// same bytes.
pub(crate) fn is_wide(bytes: &[u8]) -> bool {
    bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff")
}

/// Removes a byte-order mark of UTF-8. Rejects the marks of [`is_wide`], whose encodings no mesh format uses.
pub(crate) fn without_mark(bytes: &[u8]) -> Result<&[u8], Fault> {
    if is_wide(bytes) {
        let what = "text in UTF-16; save the file as plain text or UTF-8";
        return Err(Fault::new(Place::Header, what));
    }
    Ok(bytes.strip_prefix(UTF8_MARK).unwrap_or(bytes))
}

/// Splits a text into lines that end with LF, CR LF or a lone CR. The line ends are not included.
pub(crate) fn lines(text: &str) -> Lines<'_> {
    Lines { rest: text }
}

/// The iterator of [`lines`].
#[derive(Debug, Clone)]
pub(crate) struct Lines<'a> {
    rest: &'a str,
}

impl<'a> Iterator for Lines<'a> {
    type Item = &'a str;

    fn next(&mut self) -> Option<&'a str> {
        if self.rest.is_empty() {
            return None;
        }
        let end = self.rest.bytes().position(|b| b == b'\n' || b == b'\r');
        let Some(end) = end else { return Some(std::mem::take(&mut self.rest)) };
        let (line, rest) = self.rest.split_at(end);
        let after = if rest.starts_with("\r\n") { 2 } else { 1 };
        self.rest = &rest[after..];
        Some(line)
    }
}

/// Parses a number. Returns its value and its printed form; `None` if the word is not a number.
pub(crate) fn number(word: &str) -> Option<(f64, Printed)> {
    Some((word.parse().ok()?, Printed::from_text(word)))
}

/// Quotes a word of the file, truncated to 40 characters, for a message.
pub(crate) fn quoted(word: &str) -> String {
    let mut shown: String = word.chars().take(40).flat_map(char::escape_debug).collect();
    if word.chars().nth(40).is_some() {
        shown.push_str("...");
    }
    format!("`{shown}`")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_line_endings_split_lines() {
        for end in ["\n", "\r\n", "\r"] {
            let text = ["a", "", "b c", ""].join(end);
            assert_eq!(lines(&text).collect::<Vec<_>>(), ["a", "", "b c"], "{end:?}");
        }
        assert_eq!(lines("a\n\rb").collect::<Vec<_>>(), ["a", "", "b"]);
        assert_eq!(lines("").count(), 0);
    }
}
