//! Makes text from outside harmless on a terminal: names of parts and files control nothing there.
//!
//! Names may hold [what steers](colltrans_mesh::plain). Everything that is printed goes through [`plain`] or [`plain_json`];
//! names within lines go through [`shown`], so that they cannot end their line either.

use std::borrow::Cow;
use std::fmt::Display;

use colltrans_mesh::plain::{self, steers, written_out};

/// A name, or a message of one line, with all that steers written out: `\u{1b}`, `\n`.
pub(crate) fn shown(text: impl Display) -> String {
    plain::shown(&text.to_string()).into_owned()
}

/// Lines, with all that steers written out but the ends of lines.
pub(crate) fn plain(text: &str) -> Cow<'_, str> {
    written_out(text, |c| steers(c) && c != '\n', |c| c.escape_default().to_string())
}

/// JSON, with all that steers as escapes of JSON: it means what it did.
pub(crate) fn plain_json(text: &str) -> Cow<'_, str> {
    // JSON writes what is beyond 2^16 as UTF-16 does, as two.
    let escape = |c: char| {
        let mut units = [0; 2];
        let units: Vec<String> =
            c.encode_utf16(&mut units).iter().map(|unit| format!("\\u{unit:04x}")).collect();
        units.concat()
    };
    written_out(text, |c| steers(c) && c != '\n', escape)
}

#[cfg(test)]
mod tests {
    use super::*;

    const HOSTILE: &str = "a\u{1b}[31m\u{9b}2J\u{202e}b\r\n\u{7}\u{200b}\u{e0041}";

    #[test]
    fn nothing_steers_a_terminal() {
        assert_eq!(shown(HOSTILE), r"a\u{1b}[31m\u{9b}2J\u{202e}b\r\n\u{7}\u{200b}\u{e0041}");
        assert_eq!(plain(HOSTILE), "a\\u{1b}[31m\\u{9b}2J\\u{202e}b\\r\n\\u{7}\\u{200b}\\u{e0041}");
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
