//! The question of a drawing.

use serde_json::json;

use super::drawing::draw_scene;
use super::scene::{Question, Scene};
use crate::Answers;
use crate::answer::{Answer, Refusal};

/// The state is empty, because questions do not depend on each other.
#[derive(Debug, Default)]
pub struct State;

impl Answers for State {
    /// Answers the question `draw`, with the styles as JSON and the triangles and segments as the file. The
    /// numbers of the answer are the bytes of an SVG file.
    fn ask(&mut self, question: &[u8], file: Vec<u8>) -> Answer {
        let drawn = serde_json::from_slice(question)
            .map_err(|error| format!("the question cannot be read: {error}"))
            .and_then(|Question::Draw(styles)| Scene::read(styles, &file));
        match drawn {
            Ok(scene) => Answer {
                numbers: draw_scene(&scene).into_bytes(),
                ..Answer::from_facts(&json!({ "drawn": true }))
            },
            Err(error) => Refusal::from(error).into_answer(),
        }
    }
}
