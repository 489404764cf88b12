//! Rewrites error messages of the parsers of JSON and TOML in the terms of the file.

/// Returns the message of a JSON error in the terms of the file, without line and column.
pub fn json_error_reason(error: &serde_json::Error) -> String {
    let message = error.to_string();
    let place = format!(" at line {} column {}", error.line(), error.column());
    reword_parser_message(message.strip_suffix(&place).unwrap_or(&message))
}

/// Replaces the Rust types in a parser's message by terms of the file.
pub(crate) fn reword_parser_message(message: &str) -> String {
    const WORDS: [(&str, &str); 20] = [
        ("expected ident", "it is not JSON"),
        ("expected value", "it is not JSON"),
        ("floating point", "number"),
        ("invalid type: ", "found "),
        ("invalid value: ", "found "),
        ("invalid length ", "found a list of "),
        ("expected f64", "expected a number"),
        ("expected f32", "expected a number"),
        ("found map, expected enum", "the field that gives the kind is missing"),
        ("expected usize", "expected a whole number"),
        ("expected u32", "expected a whole number"),
        ("expected a sequence", "expected a list"),
        ("found sequence", "found a list"),
        ("found map", "found an object"),
        ("EOF while parsing", "the file ends inside"),
        ("recursion limit exceeded", "it is nested too deep"),
        ("unknown variant ", "unknown word "),
        ("expected an array of length ", "expected a list of "),
        ("trailing characters", "unexpected text after the end"),
        (", expected literal string", ""),
    ];
    let types_named =
        WORDS.iter().fold(message.to_owned(), |text, (theirs, ours)| text.replace(theirs, ours));
    let Some((found, named)) = types_named.split_once("expected struct ") else {
        return types_named;
    };
    let is_name = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
    let rest = named.trim_start_matches("variant ").trim_start_matches(is_name);
    format!("{found}expected an object{rest}")
}
