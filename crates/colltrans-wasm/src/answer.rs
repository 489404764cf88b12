//! The answer to a question.

use glam::DVec3;
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

    /// Returns an answer of doubles alone.
    pub(crate) fn from_numbers(numbers: impl IntoIterator<Item = f64>) -> Self {
        let numbers = numbers.into_iter().flat_map(f64::to_le_bytes).collect();
        Self { text: Vec::new(), numbers }
    }

    /// Returns an answer of points, three doubles each.
    pub(crate) fn from_points(points: &[DVec3]) -> Self {
        Self::from_numbers(points.iter().flat_map(DVec3::to_array))
    }

    /// Returns an answer of triangles, three 32-bit indices each.
    pub(crate) fn from_triangles(triangles: &[[u32; 3]]) -> Self {
        let numbers = triangles.iter().flatten().flat_map(|index| index.to_le_bytes()).collect();
        Self { text: Vec::new(), numbers }
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
