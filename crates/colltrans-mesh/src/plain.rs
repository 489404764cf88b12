//! Escapes control characters and invisible characters in names from files.
//!
//! Names may contain codes that move the cursor of a terminal or end a table row, marks that reverse the order
//! of letters, and characters without width, by which different names look equal.

use std::borrow::Cow;

/// Checks whether a character is invisible or controls the output.
pub fn is_control(c: char) -> bool {
    c.is_control()
        // Direction marks, line separators, and characters of width zero.
        || matches!(c, '\u{61c}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}')
        || matches!(c, '\u{2060}'..='\u{2064}' | '\u{2066}'..='\u{2069}' | '\u{feff}')
        // Tag characters, which encode an invisible second text.
        || matches!(c, '\u{e0000}'..='\u{e007f}')
}

/// Escapes all characters that [`is_control`] matches, for example as `\u{1b}` or `\n`.
pub fn escape_control(text: &str) -> Cow<'_, str> {
    escape_where(text, is_control, |c| c.escape_default().to_string())
}

/// Replaces the characters that `wanted` matches by the results of `escape`.
pub fn escape_where(
    text: &str,
    wanted: impl Fn(char) -> bool,
    escape: impl Fn(char) -> String,
) -> Cow<'_, str> {
    if !text.contains(&wanted) {
        return Cow::Borrowed(text);
    }
    let mut out = String::with_capacity(text.len() + 16);
    for c in text.chars() {
        if wanted(c) {
            out.push_str(&escape(c));
        } else {
            out.push(c);
        }
    }
    Cow::Owned(out)
}

/// Returns a part of a file name for a name: letters, digits and `-_.` stay, other characters become `_`, and the result
/// has at most `most` bytes. Different names may have the same result.
pub fn file_name_part(name: &str, most: usize) -> String {
    let is_safe = |c: char| c.is_alphanumeric() || "-_.".contains(c);
    let mut part = String::new();
    for c in name.chars().map(|c| if is_safe(c) { c } else { '_' }) {
        if part.len() + c.len_utf8() > most {
            break;
        }
        part.push(c);
    }
    part
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn invisible_characters_are_escaped() {
        let hidden = "a\u{1b}[31m\u{9b}2J\u{202e}b\r\n\u{7}";
        assert_eq!(escape_control(hidden), r"a\u{1b}[31m\u{9b}2J\u{202e}b\r\n\u{7}");
        for c in "\0\u{1f}\u{7f}\u{80}\u{9f}\u{61c}\u{200b}\u{200c}\u{200d}\u{200e}\u{200f}\u{2028}\u{202e}\
                  \u{2060}\u{2064}\u{2066}\u{2069}\u{feff}\u{e0000}\u{e0041}\u{e007f}"
            .chars()
        {
            assert!(is_control(c), "{c:?}");
        }
        assert_eq!(file_name_part("../größe\0: 3\u{202e}\u{301}", 100), ".._größe___3__");
        assert_eq!(file_name_part(&"é".repeat(300), 61), "é".repeat(30));
        let seen = "größer ≥ 3 µm – 測試 é\u{301}";
        assert!(matches!(escape_control(seen), Cow::Borrowed(text) if text == seen));
    }
}
