//! Bodies by what a line says of them, for one thread.
//!
//! Lines of one file name the same few bodies over and over, in the same words. A body that is still
//! in the [`Cache`](super::cache::Cache) is found by its words, without reading them. Invariant:
//! bodies are held weakly, so no more of them stay in memory than the cache keeps.

use std::sync::{Arc, Weak};

use super::cache::Shape;

/// Bodies that are remembered.
const PLACES: usize = 8;
/// Words that are longer are not kept: inline points seldom come twice.
const LONGEST: usize = 4096;

/// What a thread has met last.
#[derive(Default)]
pub(crate) struct Recent {
    known: Vec<(Box<str>, Weak<Shape>)>,
    /// The place that is taken next, when all are.
    next: usize,
}

impl Recent {
    pub(crate) fn find(&self, words: &str) -> Option<Arc<Shape>> {
        let (_, shape) = self.known.iter().find(|(known, _)| **known == *words)?;
        shape.upgrade()
    }

    pub(crate) fn keep(&mut self, words: &str, shape: &Arc<Shape>) {
        if words.len() > LONGEST {
            return;
        }
        let entry = (words.into(), Arc::downgrade(shape));
        if let Some(place) = self.known.iter().position(|(known, _)| **known == *words) {
            self.known[place] = entry;
        } else if self.known.len() < PLACES {
            self.known.push(entry);
        } else {
            self.known[self.next] = entry;
            self.next = (self.next + 1) % PLACES;
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
        Arc::new(Shape::Convex(Part::of(body)))
    }

    #[test]
    fn the_last_ones_are_found_while_somebody_keeps_them() {
        let mut recent = Recent::default();
        let shapes: Vec<_> = (0..2 * PLACES).map(|_| shape()).collect();
        for (i, shape) in shapes.iter().enumerate() {
            recent.keep(&i.to_string(), shape);
            assert!(Arc::ptr_eq(&recent.find(&i.to_string()).unwrap(), shape));
        }
        assert!(recent.find("0").is_none());
        assert!(recent.find(&PLACES.to_string()).is_some());
        drop(shapes);
        assert!(recent.find(&PLACES.to_string()).is_none());
        // Built again, it takes its old place.
        let again = shape();
        recent.keep(&PLACES.to_string(), &again);
        assert!(Arc::ptr_eq(&recent.find(&PLACES.to_string()).unwrap(), &again));
        assert_eq!(recent.known.len(), PLACES);
    }

    #[test]
    fn long_words_are_not_kept() {
        let mut recent = Recent::default();
        let (words, shape) = ("x".repeat(LONGEST + 1), shape());
        recent.keep(&words, &shape);
        assert!(recent.find(&words).is_none());
    }
}
