//! What comes back for a question.

use serde::Serialize;
use serde_json::json;

/// An answer: JSON, and numbers in binary (little-endian) whose layout the JSON tells.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Answer {
    /// JSON: an object, with a field `error` where there is no answer.
    pub text: Vec<u8>,
    /// Numbers that would be long as text.
    pub numbers: Vec<u8>,
}

/// Why there is no answer.
#[derive(Debug)]
pub(crate) struct Refusal {
    /// For people.
    pub(crate) error: String,
    /// What the same file could be taken as instead.
    pub(crate) instead: Vec<&'static str>,
    /// Whether the body that was there before the file is no more.
    pub(crate) gone: bool,
}

impl From<String> for Refusal {
    fn from(error: String) -> Self {
        Self { error, instead: Vec::new(), gone: false }
    }
}

impl Answer {
    /// Facts whose keys are texts.
    pub(crate) fn of<T: Serialize>(facts: &T) -> Self {
        Self { text: serde_json::to_vec(facts).unwrap_or_default(), numbers: Vec::new() }
    }
}

impl Refusal {
    pub(crate) fn answer(self) -> Answer {
        Answer::of(&json!({ "error": self.error, "instead": self.instead, "gone": self.gone }))
    }
}
