//! The bodies in use, by their numbers.

use super::error::{Failure, Fallible};

/// Bodies that the package holds by a number. A number is used again after its body was freed.
#[derive(Debug)]
pub(crate) struct Store<B> {
    bodies: Vec<Option<B>>,
    free: Vec<usize>,
}

impl<B> Default for Store<B> {
    fn default() -> Self {
        Self { bodies: Vec::new(), free: Vec::new() }
    }
}

impl<B> Store<B> {
    /// Stores a body and returns its number.
    pub(crate) fn insert(&mut self, body: B) -> usize {
        if let Some(number) = self.free.pop() {
            self.bodies[number] = Some(body);
            return number;
        }
        self.bodies.push(Some(body));
        self.bodies.len() - 1
    }

    /// Removes a body. A number without a body has no effect.
    pub(crate) fn remove(&mut self, number: usize) {
        if self.bodies.get_mut(number).and_then(Option::take).is_some() {
            self.free.push(number);
        }
    }

    /// Returns a body.
    pub(crate) fn get(&self, number: usize, argument: &'static str) -> Fallible<&B> {
        let body = self.bodies.get(number).and_then(Option::as_ref);
        body.ok_or_else(|| Failure::input(argument, "the body was freed"))
    }
}
