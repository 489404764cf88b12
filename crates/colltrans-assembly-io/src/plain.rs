//! What parsers of JSON and TOML say, in words of the file.

/// What is wrong with JSON, in words of the file and without the place.
pub fn plain(error: &serde_json::Error) -> String {
    let message = error.to_string();
    let place = format!(" at line {} column {}", error.line(), error.column());
    plain_words(message.strip_suffix(&place).unwrap_or(&message))
}

/// A parser's message in words of the file, not of the parser.
pub(crate) fn plain_words(message: &str) -> String {
    const WORDS: [(&str, &str); 20] = [
        ("expected ident", "it is not JSON"),
        ("expected value", "it is not JSON"),
        ("floating point", "number"),
        ("invalid type: ", "found "),
        ("invalid value: ", "found "),
        ("invalid length ", "found a list of "),
        ("expected f64", "expected a number"),
        ("expected f32", "expected a number"),
        ("found map, expected enum", "there is no field that says of which kind it is"),
        ("expected usize", "expected a whole number"),
        ("expected u32", "expected a whole number"),
        ("expected a sequence", "expected a list"),
        ("found sequence", "found a list"),
        ("found map", "found an object"),
        ("EOF while parsing", "the file ends inside"),
        ("recursion limit exceeded", "it is nested too deep"),
        ("unknown variant ", "unknown word "),
        ("expected an array of length ", "expected a list of "),
        ("trailing characters", "there is more than there should be"),
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
