//! Writes the results of a batch without overwriting an input.
//!
//! The meshes that the queries read are known only at the end. Therefore the results are written to a temporary file (see
//! [`crate::outputs`]), which is renamed at the end unless it would replace one of the inputs. Pipes and devices are
//! written directly.

use std::io::{BufWriter, Write};
use std::path::Path;

use crate::failure::{Code, Failure};
use crate::inputs::ReplacedFile;
use crate::outputs::Output;
use crate::streams::standard_output;

pub(crate) type Writer = BufWriter<Box<dyn Write + Send>>;

/// The file of the results, which is renamed at the end.
pub(crate) struct Results {
    /// Name of the file for messages.
    pub(crate) name: String,
    output: Option<Output>,
}

/// Opens the results: a file, or standard output for `-` and `None`.
pub(crate) fn open_results(path: Option<&Path>) -> Result<(Writer, Results), Failure> {
    let Some(path) = path.filter(|path| *path != Path::new("-")) else {
        let name = "standard output".to_owned();
        let output = standard_output().map_err(|error| Failure::write_error(&name, &error))?;
        return Ok((BufWriter::new(Box::new(output)), Results { name, output: None }));
    };
    let unwritable = |error| Failure::write_error(path.display(), &error);
    let output = Output::create(path).map_err(unwritable)?;
    let writer = BufWriter::new(Box::new(output.file().map_err(unwritable)?) as Box<_>);
    Ok((writer, Results { name: path.display().to_string(), output: Some(output) }))
}

impl Results {
    /// Returns the record of the file that the results replace.
    pub(crate) fn replaced_file(&self) -> ReplacedFile {
        ReplacedFile::new(self.output.as_ref().and_then(Output::replaced_file).cloned())
    }

    /// Moves the complete results to their final path.
    ///
    /// # Errors
    /// A query has read the file that they would replace, or it cannot be written.
    pub(crate) fn finish(self, replaced_file: &ReplacedFile) -> Result<(), Failure> {
        if replaced_file.was_read() {
            return Err(self.fail_and_keep("is an input of the queries, and was not changed"));
        }
        let failed = |error| Failure::write_error(&self.name, &error);
        self.output.map_or(Ok(()), |output| output.finish().map_err(failed))
    }

    /// Keeps the results under their temporary name. Returns a failure with the reason and this name.
    pub(crate) fn fail_and_keep(self, reason: &str) -> Failure {
        let temporary = self.output.and_then(Output::keep_temporary);
        let place = temporary
            .map_or(String::new(), |path| format!("; the results are in {}", path.display()));
        Failure::new(Code::Input, format!("{}: {reason}{place}", self.name))
    }
}
