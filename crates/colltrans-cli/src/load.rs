//! Loads the bodies of both sides: as convex bodies if all meshes are convex, else as parts.

use std::path::{Path, PathBuf};

use colltrans_mesh::body::{BodyOptions, LoadError};

use crate::args::{PlaceArguments, Sides, Taken};
use crate::body::{self, Part, is_part, refusal};
use crate::failure::{Code, Failure, note};
use crate::progress;
use crate::solid::Body;

/// Lists the files of both sides.
pub(crate) fn input_files(files: [&[PathBuf]; 2]) -> Vec<&Path> {
    files.into_iter().flatten().map(AsRef::as_ref).collect()
}

/// Reads each file as a convex body.
pub(crate) fn only_convex(
    files: [&[PathBuf]; 2],
    options: &[BodyOptions; 2],
) -> Result<[Vec<Part>; 2], LoadError> {
    let load = |k: usize| -> Result<Vec<Part>, LoadError> {
        files[k].iter().map(|file| body::load(file, &options[k])).collect()
    };
    Ok([load(0)?, load(1)?])
}

/// Reads each file as a convex body. Returns `None` if the bodies are to be read as parts: because the
/// command line requests parts, or because a mesh is not convex and the command line leaves the kind open.
pub(crate) fn convex_bodies(
    sides: &Sides<'_>,
    options: &[BodyOptions; 2],
) -> Result<Option<[Vec<Part>; 2]>, Failure> {
    if sides.taken == Taken::Parts {
        return Ok(None);
    }
    match only_convex(sides.files, options) {
        Ok(bodies) => Ok(Some(bodies)),
        Err(error) if sides.taken == Taken::AsTheyAre && is_part(&error) => Ok(None),
        Err(error) => Err(Failure::new(Code::Input, refusal(&error))),
    }
}

/// Reads the files of each side as one body of parts.
pub(crate) fn parts(
    files: [&[PathBuf]; 2],
    options: &[BodyOptions; 2],
) -> Result<[Body; 2], Failure> {
    let bar = progress::steps(files.iter().map(|side| side.len()).sum(), "reading");
    let load = |k: usize| Body::load(files[k], &options[k], || bar.inc(1));
    let bodies = load(0).and_then(|moving| Ok([moving, load(1)?]));
    bar.finish_and_clear();
    bodies.map_err(|message| Failure::new(Code::Input, message))
}

/// Reports changes to poses and repairs of files.
pub(crate) fn report_notes<'a>(
    places: &PlaceArguments,
    mended: impl IntoIterator<Item = &'a String>,
) {
    places.notes().iter().flatten().for_each(|text| note(text));
    mended.into_iter().for_each(|text| note(text));
}
