//! What is asked, and the drawing.

use serde_json::json;

use super::drawing::drawing;
use super::scene::{Question, Scene};
use crate::Answers;
use crate::answer::{Answer, Refusal};

/// Nothing is kept from one question to the next.
#[derive(Debug, Default)]
pub struct State;

impl Answers for State {
    /// Answers one question, `draw`: the scene's styles as JSON, its triangles and lines as the file. The
    /// answer's numbers are the bytes of an SVG file.
    fn ask(&mut self, question: &[u8], file: Vec<u8>) -> Answer {
        let drawn = serde_json::from_slice(question)
            .map_err(|error| format!("the question cannot be read: {error}"))
            .and_then(|Question::Draw(styles)| Scene::read(styles, &file));
        match drawn {
            Ok(scene) => Answer {
                numbers: drawing(&scene).into_bytes(),
                ..Answer::of(&json!({ "drawn": true }))
            },
            Err(error) => Refusal::from(error).answer(),
        }
    }
}
