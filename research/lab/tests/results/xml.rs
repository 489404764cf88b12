//! A reader of well-formed documents.

/// The names of the elements in order of their start; panics where the document is not
/// well-formed. `void` elements have no end (HTML has such).
pub(crate) fn elements(document: &str, void: &[&str]) -> Vec<String> {
    let (mut open, mut found) = (Vec::<String>::new(), Vec::new());
    let mut rest = document;
    while let Some(start) = rest.find('<') {
        assert_text(&rest[..start]);
        rest = &rest[start + 1..];
        if let Some(comment) = rest.strip_prefix("!--") {
            rest = &comment[comment.find("-->").expect("an unclosed comment") + 3..];
            continue;
        }
        let end = rest.find('>').expect("an unclosed tag");
        let tag = &rest[..end];
        rest = &rest[end + 1..];
        if let Some(name) = tag.strip_prefix('/') {
            assert_eq!(open.pop().as_deref(), Some(name), "tags close in order");
        } else if !tag.starts_with('!') {
            assert_eq!(tag.matches('"').count() % 2, 0, "quotes come in pairs: {tag:?}");
            let name = tag.trim_end_matches('/').split_whitespace().next().unwrap().to_owned();
            if name == "style" {
                rest = &rest[rest.find("</style>").unwrap()..];
            }
            if !tag.ends_with('/') && !void.contains(&name.as_str()) {
                open.push(name.clone());
            }
            found.push(name);
        }
    }
    assert!(open.is_empty(), "left open: {open:?}");
    assert!(rest.trim().is_empty(), "something after the root: {rest:?}");
    found
}

fn assert_text(text: &str) {
    assert!(!text.contains('>'), "a stray > in {text:?}");
    for entity in text.split('&').skip(1) {
        let name = entity.split(';').next().unwrap();
        assert!(["amp", "lt", "gt", "quot", "apos"].contains(&name), "&{entity}");
    }
}
