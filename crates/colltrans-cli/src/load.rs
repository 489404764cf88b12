//! Loads the bodies of both sides: as convex bodies if all meshes are convex, else as parts.

use std::path::{Path, PathBuf};

use colltrans_mesh::body::{BodyOptions, LoadError};

use crate::args::{BodyMode, InputPair, PlaceArguments};
use crate::body::{self, Part, can_be_part, load_error_message};
use crate::failure::{Code, Failure, note};
use crate::progress;
use crate::solid::Body;

/// Lists the files of both sides.
pub(crate) fn input_paths(files: [&[PathBuf]; 2]) -> Vec<&Path> {
    files.into_iter().flatten().map(AsRef::as_ref).collect()
}

/// Reads each file as a convex body.
pub(crate) fn read_convex(
    files: [&[PathBuf]; 2],
    options: &[BodyOptions; 2],
) -> Result<[Vec<Part>; 2], LoadError> {
    let load = |k: usize| -> Result<Vec<Part>, LoadError> {
        files[k].iter().map(|file| body::load(file, &options[k])).collect()
    };
    Ok([load(0)?, load(1)?])
}

/// Reads each file as a convex body. Returns `None` if the bodies are to be read as parts. This is the case if the
/// command line requires parts, or if it requires no kind and a mesh cannot become a convex body but can become a part.
///
/// # Errors
/// A file cannot be read, or its mesh cannot become a body of a kind that the command line permits.
pub(crate) fn read_if_convex(
    inputs: &InputPair<'_>,
    options: &[BodyOptions; 2],
) -> Result<Option<[Vec<Part>; 2]>, Failure> {
    if inputs.mode == BodyMode::Parts {
        return Ok(None);
    }
    match read_convex(inputs.files, options) {
        Ok(bodies) => Ok(Some(bodies)),
        Err(error) if inputs.mode == BodyMode::Automatic && can_be_part(&error) => Ok(None),
        Err(error) => Err(Failure::new(Code::Input, load_error_message(&error))),
    }
}

/// Reads the files of each side as one body of parts.
pub(crate) fn read_parts(
    files: [&[PathBuf]; 2],
    options: &[BodyOptions; 2],
) -> Result<[Body; 2], Failure> {
    let bar = progress::step_bar(files.iter().map(|side| side.len()).sum(), "reading");
    let load = |k: usize| Body::load(files[k], &options[k], || bar.inc(1));
    let bodies = load(0).and_then(|moving| Ok([moving, load(1)?]));
    bar.finish_and_clear();
    bodies.map_err(|message| Failure::new(Code::Input, message))
}

/// Prints notes about normalised poses and repairs of files.
pub(crate) fn print_notes<'a>(
    places: &PlaceArguments,
    repairs: impl IntoIterator<Item = &'a String>,
) {
    places.notes().iter().flatten().for_each(|text| note(text));
    repairs.into_iter().for_each(|text| note(text));
}
