//! Text from outside, for HTML and SVG.
//!
//! The pages are written with `maud`, which escapes whatever is put into them. Where a picture is put
//! together from paths, its few texts come through [`escaped`].

use maud::html;

/// A text as HTML and XML write it, in elements and in attributes. Characters that XML has no way to
/// write, control codes above all, become the sign for what cannot be shown.
pub fn escaped(text: &str) -> String {
    html! { (text.replace(is_forbidden, "\u{fffd}")) }.into_string()
}

/// Whether XML 1.0 has no way to write a character (2.2, *Char*).
fn is_forbidden(c: char) -> bool {
    matches!(c, '\0'..='\u{8}' | '\u{b}' | '\u{c}' | '\u{e}'..='\u{1f}' | '\u{fffe}' | '\u{ffff}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_ends_its_element_or_its_attribute() {
        let hostile = "</text><script>\"'&\u{1b}[31m\0";
        let text = escaped(hostile);
        assert_eq!(text, "&lt;/text&gt;&lt;script&gt;&quot;'&amp;\u{fffd}[31m\u{fffd}");
    }
}
