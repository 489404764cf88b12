//! Bodies by their text in a line, for one thread.
//!
//! Lines of one file often repeat the same text of a few bodies. One of the last [`MAX_ENTRIES`] bodies is found by its
//! text, without parsing it, while it is still in the [`Cache`](super::cache::Cache).
//!
//! Invariant: the references are weak, so that only the cache keeps bodies in memory.

use std::sync::{Arc, Weak};

use super::cache::Shape;

/// Maximum number of bodies.
const MAX_ENTRIES: usize = 8;
/// Maximum length of a text in bytes. Longer texts have inline points, which rarely repeat.
const MAX_TEXT_BYTES: usize = 4096;

/// The bodies that a thread has used recently.
#[derive(Default)]
pub(crate) struct Recent {
    known: Vec<(Box<str>, Weak<Shape>)>,
    /// The entry to be replaced next when all are in use.
    next: usize,
}

impl Recent {
    /// Returns the body with this text; `None` if it is unknown, or no longer in memory.
    pub(crate) fn find(&self, text: &str) -> Option<Arc<Shape>> {
        let (_, shape) = self.known.iter().find(|(known, _)| **known == *text)?;
        shape.upgrade()
    }

    /// Stores a body under its text, in place of the oldest one if necessary.
    pub(crate) fn insert(&mut self, text: &str, shape: &Arc<Shape>) {
        if text.len() > MAX_TEXT_BYTES {
            return;
        }
        let entry = (text.into(), Arc::downgrade(shape));
        if let Some(place) = self.known.iter().position(|(known, _)| **known == *text) {
            self.known[place] = entry;
        } else if self.known.len() < MAX_ENTRIES {
            self.known.push(entry);
        } else {
            self.known[self.next] = entry;
            self.next = (self.next + 1) % MAX_ENTRIES;
        }
    }
}

#[cfg(test)]
mod tests {
    use colltrans::ConvexPolyhedron;
    use colltrans::glam::DVec3;

    use super::*;
    use crate::body::Part;

    fn shape() -> Arc<Shape> {
        let body = ConvexPolyhedron::from_points(&[DVec3::ONE]).unwrap();
        Arc::new(Shape::Convex(Part::from_body(body)))
    }

    #[test]
    fn recent_bodies_are_found_while_they_are_in_memory() {
        let mut recent = Recent::default();
        let shapes: Vec<_> = (0..2 * MAX_ENTRIES).map(|_| shape()).collect();
        for (i, shape) in shapes.iter().enumerate() {
            recent.insert(&i.to_string(), shape);
            assert!(Arc::ptr_eq(&recent.find(&i.to_string()).unwrap(), shape));
        }
        assert!(recent.find("0").is_none());
        assert!(recent.find(&MAX_ENTRIES.to_string()).is_some());
        drop(shapes);
        assert!(recent.find(&MAX_ENTRIES.to_string()).is_none());
        // A body that is built again replaces its old entry.
        let again = shape();
        recent.insert(&MAX_ENTRIES.to_string(), &again);
        assert!(Arc::ptr_eq(&recent.find(&MAX_ENTRIES.to_string()).unwrap(), &again));
        assert_eq!(recent.known.len(), MAX_ENTRIES);
    }

    #[test]
    fn long_texts_are_not_stored() {
        let mut recent = Recent::default();
        let (text, shape) = ("x".repeat(MAX_TEXT_BYTES + 1), shape());
        recent.insert(&text, &shape);
        assert!(recent.find(&text).is_none());
    }
}
