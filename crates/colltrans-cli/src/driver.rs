//! Writes the answer of each question: prints it, then writes its proof and its picture.
//!
//! A question describes its outputs in [`AnswerOutputs`]. [`OutputTargets::write_answer`] computes only
//! those that the command line requests. [`answer_directions`] prints one line for each of many directions.
//! In contrast, `colltrans path` writes its proof, and `colltrans assembly` its files, before the answer is printed.

use std::path::{Path, PathBuf};

use colltrans::glam::DVec3;
use serde::Serialize;

use crate::failure::{Code, Failure, print, print_json};
use crate::inputs::{check_picture_path, check_proof_path};
use crate::outputs;
use crate::record::{self, Line};

/// Outputs that a command line requests.
#[derive(Clone, Copy)]
pub(crate) struct OutputTargets<'a> {
    pub(crate) json: bool,
    pub(crate) save_proof: Option<&'a Path>,
    picture: Option<&'a Path>,
}

/// Outputs of one answer. Text, proof and picture are computed only on request.
pub(crate) struct AnswerOutputs<'a, R, Text, Proof, Picture> {
    /// Record that is serialised as JSON.
    pub(crate) record: &'a R,
    pub(crate) text: Text,
    /// Returns `None` if this answer has no proof.
    pub(crate) proof: Proof,
    pub(crate) picture: Picture,
}

/// Returns an empty picture for commands without `--picture`.
#[expect(clippy::unnecessary_wraps, reason = "it has the type of pictures that can fail")]
pub(crate) fn no_picture() -> Result<String, Failure> {
    Ok(String::new())
}

impl<'a> OutputTargets<'a> {
    /// Returns the targets of a command line.
    ///
    /// # Errors
    /// A file would overwrite an input, or both files are the same.
    pub(crate) fn new(
        json: bool,
        save_proof: Option<&'a PathBuf>,
        picture: Option<&'a PathBuf>,
        inputs: &[&Path],
    ) -> Result<Self, Failure> {
        let [save_proof, picture] = [save_proof, picture].map(|path| path.map(PathBuf::as_path));
        check_picture_path(picture, inputs)?;
        check_proof_path(save_proof, picture, inputs)?;
        Ok(Self { json, save_proof, picture })
    }

    /// Prints the answer, then writes its proof and its picture.
    ///
    /// # Errors
    /// The proof or the picture cannot be computed, or an output cannot be written.
    pub(crate) fn write_answer<R: Serialize>(
        self,
        answer: AnswerOutputs<
            '_,
            R,
            impl FnOnce() -> String,
            impl FnOnce() -> Result<Option<String>, Failure>,
            impl FnOnce() -> Result<String, Failure>,
        >,
    ) -> Result<(), Failure> {
        if self.json {
            print_json(&record::json_line(answer.record))?;
        } else {
            print(&(answer.text)())?;
        }
        if let Some(path) = self.save_proof
            && let Some(proof) = (answer.proof)()?
        {
            outputs::write_proof(path, &proof)?;
        }
        match self.picture {
            Some(path) => outputs::write(path, (answer.picture)()?.as_bytes()),
            None => Ok(()),
        }
    }
}

/// Prints one line for each direction.
///
/// # Errors
/// A line cannot be printed, or a direction has no answer. The latter error is returned after the last line.
pub(crate) fn answer_directions(
    as_json: bool,
    directions: Vec<DVec3>,
    mut answer: impl FnMut(DVec3) -> Result<Line, Failure>,
    text: impl Fn(&Line, DVec3) -> String,
) -> Result<(), Failure> {
    let (count, mut failed) = (directions.len(), 0);
    for direction in directions {
        let mut line =
            answer(direction).unwrap_or_else(|failure| Line::from_error(failure.into_message()));
        failed += usize::from(line.is_error());
        line.record = line.record.with_direction(direction.to_array());
        print(&if as_json { record::json_line(&line) } else { text(&line, direction) })?;
    }
    if failed > 0 {
        let message = format!("{failed} of {count} directions have no answer");
        return Err(Failure::new(Code::Lines, message));
    }
    Ok(())
}
