//! Escapes control characters, so that names of parts and files cannot control the terminal.
//!
//! Names may contain [control characters](colltrans_mesh::plain). All output passes through [`escape_lines`] or
//! [`escape_json`]. Names within lines pass through [`escape_line`], which also escapes line feeds.

use std::borrow::Cow;
use std::fmt::Display;

use colltrans_mesh::plain::{self, escape_where, is_control};

/// Escapes all control characters of a name or a message of one line: `\u{1b}`, `\n`.
pub(crate) fn escape_line(text: impl Display) -> String {
    plain::escape_control(&text.to_string()).into_owned()
}

/// Escapes all control characters except for line feeds.
pub(crate) fn escape_lines(text: &str) -> Cow<'_, str> {
    escape_where(text, |c| is_control(c) && c != '\n', |c| c.escape_default().to_string())
}

/// Escapes control characters of JSON by the escapes of JSON, which do not change its values.
pub(crate) fn escape_json(text: &str) -> Cow<'_, str> {
    // JSON escapes characters beyond 2^16 as two UTF-16 units.
    let escape = |c: char| {
        let mut units = [0; 2];
        let units: Vec<String> =
            c.encode_utf16(&mut units).iter().map(|unit| format!("\\u{unit:04x}")).collect();
        units.concat()
    };
    escape_where(text, |c| is_control(c) && c != '\n', escape)
}

#[cfg(test)]
mod tests {
    use super::*;

    const HOSTILE: &str = "a\u{1b}[31m\u{9b}2J\u{202e}b\r\n\u{7}\u{200b}\u{e0041}";

    #[test]
    fn terminal_control_characters_are_escaped() {
        assert_eq!(escape_line(HOSTILE), r"a\u{1b}[31m\u{9b}2J\u{202e}b\r\n\u{7}\u{200b}\u{e0041}");
        assert_eq!(
            escape_lines(HOSTILE),
            "a\\u{1b}[31m\\u{9b}2J\\u{202e}b\\r\n\\u{7}\\u{200b}\\u{e0041}"
        );
        assert_eq!(escape_line("größer ≥ 3 µm"), "größer ≥ 3 µm");
    }

    #[test]
    fn escaped_json_keeps_its_values() {
        let text = serde_json::to_string(HOSTILE).unwrap();
        let safe = escape_json(&text);
        assert!(!safe.contains(is_control));
        assert_eq!(serde_json::from_str::<String>(&safe).unwrap(), HOSTILE);
    }
}
