//! Control characters in names that files hold: those that do something instead of being seen.
//!
//! A name may hold codes that move a terminal's cursor or end a line of a table, marks that turn the order
//! of letters round, and characters without any width, so that two names look like one.

use std::borrow::Cow;

/// Whether a character does something, or nothing, instead of being seen.
pub fn steers(c: char) -> bool {
    c.is_control()
        // The order of letters; ends of lines; what has no width.
        || matches!(c, '\u{61c}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}')
        || matches!(c, '\u{2060}'..='\u{2064}' | '\u{2066}'..='\u{2069}' | '\u{feff}')
        // Tags: a second text that nobody sees.
        || matches!(c, '\u{e0000}'..='\u{e007f}')
}

/// A text with all that [steers] written out: `\u{1b}`, `\n`.
pub fn shown(text: &str) -> Cow<'_, str> {
    written_out(text, steers, |c| c.escape_default().to_string())
}

/// A text with what is wanted written as `escape` says.
pub fn written_out(
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_seen_is_written_out() {
        let hidden = "a\u{1b}[31m\u{9b}2J\u{202e}b\r\n\u{7}";
        assert_eq!(shown(hidden), r"a\u{1b}[31m\u{9b}2J\u{202e}b\r\n\u{7}");
        for c in "\0\u{1f}\u{7f}\u{80}\u{9f}\u{61c}\u{200b}\u{200c}\u{200d}\u{200e}\u{200f}\u{2028}\u{202e}\
                  \u{2060}\u{2064}\u{2066}\u{2069}\u{feff}\u{e0000}\u{e0041}\u{e007f}"
            .chars()
        {
            assert!(steers(c), "{c:?}");
        }
        let seen = "größer ≥ 3 µm – 測試 é\u{301}";
        assert!(matches!(shown(seen), Cow::Borrowed(text) if text == seen));
    }
}
