//! Text from outside on a terminal: names of parts and files say nothing to it.
//!
//! A name may hold codes that move the cursor, set the title or answer for the user, and marks that turn
//! the order of letters round. Everything that is printed goes through [`plain`] or [`plain_json`];
//! names within lines go through [`shown`], so that they cannot end their line either.

use std::borrow::Cow;
use std::fmt::{Display, Write};

/// Whether a character does something instead of being seen.
fn steers(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}')
        || matches!(c, '\u{2066}'..='\u{2069}' | '\u{feff}')
}

/// A name, or a message of one line, with all that steers written out: `\u{1b}`, `\n`.
pub(crate) fn shown(text: impl Display) -> String {
    let text = text.to_string();
    written_out(&text, steers, |c| c.escape_default().to_string()).into_owned()
}

/// Lines, with all that steers written out but the ends of lines.
pub(crate) fn plain(text: &str) -> Cow<'_, str> {
    written_out(text, |c| steers(c) && c != '\n', |c| c.escape_default().to_string())
}

/// JSON, with all that steers as escapes of JSON: it means what it did.
pub(crate) fn plain_json(text: &str) -> Cow<'_, str> {
    // All of these characters are below 2^16, where JSON has an escape for each.
    written_out(text, |c| steers(c) && c != '\n', |c| format!("\\u{:04x}", c as u32))
}

fn written_out(
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
            let _ = out.write_char(c);
        }
    }
    Cow::Owned(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    const HOSTILE: &str = "a\u{1b}[31m\u{9b}2J\u{202e}b\r\n\u{7}";

    #[test]
    fn nothing_steers_a_terminal() {
        assert_eq!(shown(HOSTILE), r"a\u{1b}[31m\u{9b}2J\u{202e}b\r\n\u{7}");
        assert_eq!(plain(HOSTILE), "a\\u{1b}[31m\\u{9b}2J\\u{202e}b\\r\n\\u{7}");
        assert_eq!(shown("größer ≥ 3 µm"), "größer ≥ 3 µm");
    }

    #[test]
    fn json_means_what_it_did() {
        let text = serde_json::to_string(HOSTILE).unwrap();
        let safe = plain_json(&text);
        assert!(!safe.contains(steers));
        assert_eq!(serde_json::from_str::<String>(&safe).unwrap(), HOSTILE);
    }
}
