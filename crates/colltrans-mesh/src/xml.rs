//! XML as a tree: names, attributes, text, lines. For the readers of this crate and of others.

use std::collections::HashMap;

use quick_xml::events::{BytesStart, Event};
use quick_xml::name::ResolveResult;

/// Elements nested deeper are refused.
const DEEPEST: usize = 64;

/// A fault, and the line where it is.
pub type Fault = (String, String);

/// An element.
#[derive(Debug, Default)]
pub struct Element {
    /// Its name, as it is written.
    pub name: String,
    /// Where it ends to begin, from 1.
    pub line: usize,
    attributes: HashMap<String, String>,
    /// The elements in it.
    pub children: Vec<Element>,
    /// The text in it, all of it one after another, but for what stands for something else (`&amp;`).
    pub text: String,
}

impl Element {
    /// The element that holds all others.
    ///
    /// # Errors
    /// What is wrong, and in which line.
    pub fn parse(text: &str) -> Result<Self, Fault> {
        let mut reader = quick_xml::Reader::from_str(text);
        let mut lines = Lines::new(text);
        // The last one is open; the first stands for the file.
        let mut open = vec![Self::default()];
        loop {
            let line = lines.at(reader.buffer_position());
            let place = || format!("line {line}");
            let event = reader.read_event().map_err(|e| (place(), told(&e)))?;
            let (tag, ends) = match &event {
                Event::Start(tag) => (tag, false),
                Event::Empty(tag) => (tag, true),
                Event::End(_) => {
                    close(&mut open);
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
                    return Err(("end of file".into(), format!("the element {name} is not ended")));
                }
                Event::Eof => break,
                _ => continue,
            };
            if open.len() > DEEPEST {
                let reason = format!("elements are nested deeper than {DEEPEST}");
                return Err((place(), reason));
            }
            let attributes = attributes(tag).map_err(|e| (place(), e))?;
            let name = tag.name().as_ref().to_owned();
            open.push(Self { name, line, attributes, ..Self::default() });
            if ends {
                close(&mut open);
            }
        }
        let mut all = open.pop().map(|file| file.children).unwrap_or_default().into_iter();
        all.next().ok_or_else(|| ("start of file".into(), "it holds no XML element".into()))
    }

    /// The children of a name.
    pub fn all(&self, name: &'static str) -> impl Iterator<Item = &Self> {
        self.children.iter().filter(move |child| child.name == name)
    }

    /// The first child of a name.
    pub fn first(&self, name: &'static str) -> Option<&Self> {
        self.all(name).next()
    }

    /// An attribute.
    pub fn get(&self, name: &str) -> Option<&str> {
        self.attributes.get(name).map(String::as_str)
    }

    /// An attribute that must be there.
    ///
    /// # Errors
    /// It is not.
    pub fn need(&self, name: &str) -> Result<&str, String> {
        self.get(name).ok_or_else(|| format!("<{}> has no attribute {name}", self.name))
    }

    /// So many numbers of an attribute.
    ///
    /// # Errors
    /// They are fewer, more, or no numbers.
    pub fn numbers<const N: usize>(&self, name: &str) -> Result<Option<[f64; N]>, String> {
        let Some(text) = self.get(name) else { return Ok(None) };
        let refused = || {
            let wanted = if N == 1 { "a number".into() } else { format!("{N} numbers") };
            format!("{name}=\"{text}\" of <{}> is not {wanted}", self.name)
        };
        let mut numbers = [0.0; N];
        let mut words = text.split_whitespace();
        for number in &mut numbers {
            *number = words.next().and_then(|word| word.parse().ok()).ok_or_else(refused)?;
        }
        if words.next().is_some() { Err(refused()) } else { Ok(Some(numbers)) }
    }
}

fn close(open: &mut Vec<Element>) {
    // The reader refuses ends without a start.
    if let (Some(done), Some(above)) = (open.pop(), open.last_mut()) {
        above.children.push(done);
    }
}

/// Attributes by their names as they are written.
fn attributes(tag: &BytesStart) -> Result<HashMap<String, String>, String> {
    let mut all = HashMap::new();
    for attribute in tag.attributes() {
        let attribute = attribute.map_err(|e| e.to_string())?;
        all.insert(attribute.key.as_ref().to_owned(), value(&attribute)?);
    }
    Ok(all)
}

/// What is wrong with a text that is not XML, without the parser's own heads.
pub fn told(error: &quick_xml::Error) -> String {
    let message = error.to_string();
    let message = message.strip_prefix("ill-formed document: ").unwrap_or(&message);
    message.strip_prefix("syntax error: ").unwrap_or(message).to_owned()
}

/// The value of an attribute.
///
/// # Errors
/// What stands for something else in it (`&amp;`) is not known.
pub fn value(attribute: &quick_xml::events::attributes::Attribute) -> Result<String, String> {
    let value = quick_xml::escape::unescape(&attribute.value).map_err(|e| e.to_string())?;
    Ok(value.into_owned())
}

/// The namespace of a name, if it has one.
pub fn namespace<'a>(resolved: &'a ResolveResult) -> Option<&'a str> {
    match resolved {
        ResolveResult::Bound(namespace) => Some(namespace.0),
        _ => None,
    }
}

/// Lines of a text by places that only grow.
pub struct Lines<'a> {
    text: &'a str,
    seen: usize,
    line: usize,
}

impl<'a> Lines<'a> {
    /// From its start.
    pub fn new(text: &'a str) -> Self {
        Self { text, seen: 0, line: 1 }
    }

    /// The line, from 1, of a place.
    pub fn at(&mut self, place: u64) -> usize {
        let place = (place as usize).clamp(self.seen, self.text.len());
        self.line += self.text.get(self.seen..place).map_or(0, |text| text.matches('\n').count());
        self.seen = place;
        self.line
    }
}
