//! Parses XML into a tree of elements with names, attributes, text and line numbers.

use std::collections::HashMap;

use quick_xml::events::{BytesStart, Event};
use quick_xml::name::ResolveResult;

/// Maximum depth of nested elements.
const MAX_DEPTH: usize = 64;

/// A place, such as a line, and the reason of an error.
pub type XmlError = (String, String);

/// An element of an XML document.
#[derive(Debug, Default)]
pub struct Element {
    /// The qualified name.
    pub name: String,
    /// The line in which the start tag ends, from 1.
    pub line: usize,
    attributes: HashMap<String, String>,
    /// The child elements.
    pub children: Vec<Element>,
    /// The concatenated text of the element, without character references such as `&amp;`.
    pub text: String,
}

impl Element {
    /// Parses a document and returns its root element.
    ///
    /// # Errors
    /// [`XmlError`] with place and reason.
    pub fn parse(text: &str) -> Result<Self, XmlError> {
        let mut reader = quick_xml::Reader::from_str(text);
        let mut lines = Lines::new(text);
        // The stack of open elements. The first entry represents the document.
        let mut open = vec![Self::default()];
        loop {
            let line = lines.at(reader.buffer_position());
            let place = || format!("line {line}");
            let event = reader.read_event().map_err(|e| (place(), parse_error_reason(&e)))?;
            let (tag, ends) = match &event {
                Event::Start(tag) => (tag, false),
                Event::Empty(tag) => (tag, true),
                Event::End(_) => {
                    close_element(&mut open);
                    continue;
                }
                Event::Text(text) => {
                    if let Some(last) = open.last_mut() {
                        last.text.push_str(text);
                    }
                    continue;
                }
                Event::Eof if open.len() > 1 => {
                    let name = open.pop().unwrap_or_default().name;
                    return Err((
                        "end of file".into(),
                        format!("the element {name} is not closed"),
                    ));
                }
                Event::Eof => break,
                _ => continue,
            };
            if open.len() > MAX_DEPTH {
                let reason = format!("elements are nested deeper than the accepted {MAX_DEPTH}");
                return Err((place(), reason));
            }
            let attributes = attributes_by_name(tag).map_err(|e| (place(), e))?;
            let name = tag.name().as_ref().to_owned();
            open.push(Self { name, line, attributes, ..Self::default() });
            if ends {
                close_element(&mut open);
            }
        }
        let mut all = open.pop().map(|file| file.children).unwrap_or_default().into_iter();
        all.next().ok_or_else(|| ("start of file".into(), "the file has no XML element".into()))
    }

    /// Returns the child elements with this name.
    pub fn children_named(&self, name: &'static str) -> impl Iterator<Item = &Self> {
        self.children.iter().filter(move |child| child.name == name)
    }

    /// Returns the first child element with this name, or `None`.
    pub fn first_child(&self, name: &'static str) -> Option<&Self> {
        self.children_named(name).next()
    }

    /// Returns the value of an attribute, or `None`.
    pub fn get(&self, name: &str) -> Option<&str> {
        self.attributes.get(name).map(String::as_str)
    }

    /// Returns the value of an attribute.
    ///
    /// # Errors
    /// A message if the attribute is missing.
    pub fn required(&self, name: &str) -> Result<&str, String> {
        self.get(name)
            .ok_or_else(|| format!("<{}> has no attribute {name}, which is required", self.name))
    }

    /// Parses `N` numbers in an attribute; `None` if the attribute is missing.
    ///
    /// # Errors
    /// A message if the value is not exactly `N` numbers.
    pub fn numbers<const N: usize>(&self, name: &str) -> Result<Option<[f64; N]>, String> {
        let Some(text) = self.get(name) else { return Ok(None) };
        let refused = || {
            let wanted = if N == 1 { "a number".into() } else { format!("{N} numbers") };
            format!("{name}=\"{text}\" of <{}> is invalid; expected {wanted}", self.name)
        };
        let mut numbers = [0.0; N];
        let mut words = text.split_whitespace();
        for number in &mut numbers {
            *number = words.next().and_then(|word| word.parse().ok()).ok_or_else(refused)?;
        }
        if words.next().is_some() { Err(refused()) } else { Ok(Some(numbers)) }
    }
}

/// Closes the last open element.
fn close_element(open: &mut Vec<Element>) {
    // The parser rejects end tags without a start tag.
    if let (Some(done), Some(above)) = (open.pop(), open.last_mut()) {
        above.children.push(done);
    }
}

/// Returns the attributes by their qualified names.
fn attributes_by_name(tag: &BytesStart) -> Result<HashMap<String, String>, String> {
    let mut all = HashMap::new();
    for attribute in tag.attributes() {
        let attribute = attribute.map_err(|e| e.to_string())?;
        all.insert(attribute.key.as_ref().to_owned(), value(&attribute)?);
    }
    Ok(all)
}

/// Returns the message of a parse error without the prefixes of the parser.
pub fn parse_error_reason(error: &quick_xml::Error) -> String {
    let message = error.to_string();
    let message = message.strip_prefix("ill-formed document: ").unwrap_or(&message);
    message.strip_prefix("syntax error: ").unwrap_or(message).to_owned()
}

/// Returns the unescaped value of an attribute.
///
/// # Errors
/// A message if it contains an unknown entity.
pub fn value(attribute: &quick_xml::events::attributes::Attribute) -> Result<String, String> {
    let value = quick_xml::escape::unescape(&attribute.value).map_err(|e| e.to_string())?;
    Ok(value.into_owned())
}

/// Returns the namespace of a resolved name, or `None`.
pub fn namespace<'a>(resolved: &'a ResolveResult) -> Option<&'a str> {
    match resolved {
        ResolveResult::Bound(namespace) => Some(namespace.0),
        _ => None,
    }
}

/// Converts increasing positions in a text to line numbers.
pub struct Lines<'a> {
    text: &'a str,
    seen: usize,
    line: usize,
}

impl<'a> Lines<'a> {
    /// Starts at the beginning of a text.
    pub fn new(text: &'a str) -> Self {
        Self { text, seen: 0, line: 1 }
    }

    /// Returns the line of a byte position, from 1. Positions must not decrease.
    pub fn at(&mut self, place: u64) -> usize {
        let place = (place as usize).clamp(self.seen, self.text.len());
        self.line += self.text.get(self.seen..place).map_or(0, |text| text.matches('\n').count());
        self.seen = place;
        self.line
    }
}
