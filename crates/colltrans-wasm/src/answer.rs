//! The answer to a question.

use serde::Serialize;
use serde_json::json;

/// An answer: JSON, and binary numbers (little-endian) whose layout the JSON describes.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Answer {
    /// A JSON object; it has a field `error` if there is no answer.
    pub text: Vec<u8>,
    /// Numbers that would be long as text.
    pub numbers: Vec<u8>,
}

/// The reason why there is no answer.
#[derive(Debug)]
pub(crate) struct Refusal {
    /// A message for the user.
    pub(crate) error: String,
    /// Other ways to use this file.
    pub(crate) instead: Vec<&'static str>,
    /// Whether the previous body of this slot was dropped.
    pub(crate) gone: bool,
}

impl From<String> for Refusal {
    fn from(error: String) -> Self {
        Self { error, instead: Vec::new(), gone: false }
    }
}

impl Answer {
    /// Serialises an answer without binary numbers.
    pub(crate) fn from_facts<T: Serialize>(facts: &T) -> Self {
        Self { text: serde_json::to_vec(facts).unwrap_or_default(), numbers: Vec::new() }
    }
}

impl Refusal {
    /// Returns the refusal as an answer with the field `error`.
    pub(crate) fn into_answer(self) -> Answer {
        Answer::from_facts(
            &json!({ "error": self.error, "instead": self.instead, "gone": self.gone }),
        )
    }
}
