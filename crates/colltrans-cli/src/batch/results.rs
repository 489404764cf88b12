//! Writes the results of a batch, without harm to a file that the queries read.
//!
//! Which meshes the queries read is known only when all of them are. The results are written beside
//! their place (see [`crate::outputs`]) and put there at the end, unless the file whose place they would
//! take turned out to be one of the inputs. Pipes and devices are written as the results come.

use std::io::{BufWriter, Write};
use std::path::Path;

use crate::failure::{Code, Failure};
use crate::inputs::Watched;
use crate::outputs::Output;
use crate::streams::standard_output;

pub(crate) type Writer = BufWriter<Box<dyn Write + Send>>;

/// What is left to be done when all results are written.
pub(crate) struct Results {
    /// For messages.
    pub(crate) name: String,
    output: Option<Output>,
}

pub(crate) fn open(path: Option<&Path>) -> Result<(Writer, Results), Failure> {
    let Some(path) = path.filter(|path| *path != Path::new("-")) else {
        let name = "standard output".to_owned();
        let output = standard_output().map_err(|error| Failure::output(&name, &error))?;
        return Ok((BufWriter::new(Box::new(output)), Results { name, output: None }));
    };
    let unwritable = |error| Failure::output(path.display(), &error);
    let output = Output::create(path).map_err(unwritable)?;
    let writer = BufWriter::new(Box::new(output.file().map_err(unwritable)?) as Box<_>);
    Ok((writer, Results { name: path.display().to_string(), output: Some(output) }))
}

impl Results {
    /// The file whose place they will take, to be watched while queries are read.
    pub(crate) fn watched(&self) -> Watched {
        Watched::new(self.output.as_ref().and_then(Output::replaced).cloned())
    }

    /// Puts the results, which are written, in their place.
    pub(crate) fn finish(self, watched: &Watched) -> Result<(), Failure> {
        if watched.was_read() {
            return Err(self.leave("is a file that the queries read, and was left as it is"));
        }
        let failed = |error| Failure::output(&self.name, &error);
        self.output.map_or(Ok(()), |output| output.finish().map_err(failed))
    }

    /// Leaves the results under their other name, and says why.
    pub(crate) fn leave(self, why: &str) -> Failure {
        let written = self.output.and_then(Output::leave);
        let place = written
            .map_or(String::new(), |path| format!("; the results are in {}", path.display()));
        Failure::new(Code::Input, format!("{}: {why}{place}", self.name))
    }
}
