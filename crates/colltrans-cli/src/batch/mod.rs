//! `colltrans batch`: one query per line in, one result per line out, in the same order.
//!
//! Data flow:
//! - [`pipeline`] passes chunks of lines to threads and writes their results in order, in bounded memory.
//! - [`query`] parses and answers one line. [`source`] has the format, [`fast_path`] parses lines of the usual
//!   form, [`motion`] answers queries of motions.
//! - [`cache`] builds bodies that several lines use once, [`recent`] finds them by their text.
//! - [`results`] prevents results from overwriting an input.

mod cache;
mod fast_path;
mod motion;
mod pipeline;
mod query;
mod recent;
mod results;
mod source;

use std::fs::File;
use std::io::{self, BufReader, Read};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

use colltrans::record::Fields;
use indicatif::ProgressBar;

use crate::args::BatchArguments;
use crate::failure::{Code, Failure};
use crate::inputs::overwritten_input;
use crate::progress;
pub(crate) use cache::{Cache, Shape};
use pipeline::{Line, Pipeline};
pub(crate) use query::{Batch, syntax_error_message};
use recent::Recent;
pub(crate) use source::{BodySource, PoseSource};

pub(crate) fn run(arguments: &BatchArguments) -> Result<(), Failure> {
    check_results_path(&arguments.queries, arguments.output.as_deref())?;
    let (queries, size, folder) = open_queries(&arguments.queries)?;
    let (writer, results) = results::open_results(arguments.output.as_deref())?;
    let threads = arguments
        .threads
        .or_else(|| std::thread::available_parallelism().ok())
        .map_or(1, NonZeroUsize::get);
    let batch = Batch {
        folder,
        hull: arguments.hull,
        body: arguments.body,
        written: fields_with(arguments, &[]),
        // The message of a grazing contact has these values.
        computed: fields_with(arguments, &["overlap", "sideways"]),
        cache: Cache::new(arguments.cache_bytes),
        replaced_file: results.replaced_file(),
    };
    let bar = progress_bar(size);
    let pipeline = Pipeline::new(queries, writer, threads);
    let work = || {
        let mut recent = Recent::default();
        let answer = |number, line: Line<'_>, results: &mut Vec<u8>| {
            batch.answer(number, line, &mut recent, results)
        };
        pipeline.answer_chunks(answer, &bar);
    };
    std::thread::scope(|scope| {
        for _ in 1..threads {
            scope.spawn(work);
        }
        work();
    });
    bar.finish_and_clear();
    let end = pipeline.finish();
    if let Some(error) = end.write_error {
        return Err(Failure::write_error(&results.name, &error));
    }
    if let Some(error) = end.read_error {
        let name = arguments.queries.display();
        return Err(results.fail_and_keep(&format!("incomplete: {name} cannot be read: {error}")));
    }
    results.finish(&batch.replaced_file)?;
    if end.failed > 0 {
        let message = format!("{} of {} queries have no answer", end.failed, end.answered);
        return Err(Failure::new(Code::Lines, message));
    }
    Ok(())
}

/// Returns the fields that the arguments request, all by default, and more fields.
fn fields_with(arguments: &BatchArguments, more: &[&str]) -> Fields {
    arguments.fields.as_ref().map_or(Fields::ALL, |names| {
        Fields::from_names(names.iter().cloned().chain(more.iter().map(|&name| name.into())))
    })
}

/// Checks that the results do not overwrite the queries.
///
/// # Errors
/// The results would overwrite the queries.
fn check_results_path(queries: &Path, output: Option<&Path>) -> Result<(), Failure> {
    // Standard input may be a file.
    let file = if queries == Path::new("-") { Path::new("/dev/stdin") } else { queries };
    let Some(output) = output.filter(|output| overwritten_input(output, &[file]).is_some()) else {
        return Ok(());
    };
    let message =
        format!("{}: contains the queries; give the results another file", output.display());
    Err(Failure::new(Code::Input, message))
}

type Queries = BufReader<Box<dyn Read + Send>>;

/// Opens the queries. Returns them, their size if it is known, and the folder to which paths in them are relative.
fn open_queries(path: &Path) -> Result<(Queries, Option<u64>, PathBuf), Failure> {
    if path == Path::new("-") {
        return Ok((BufReader::new(Box::new(io::stdin())), None, PathBuf::new()));
    }
    let unreadable = |e: io::Error| {
        Failure::new(Code::Input, format!("{}: cannot be read: {e}", path.display()))
    };
    // Pipes are read like standard input. A device may have no end.
    if is_device(&path.metadata().map_err(unreadable)?) && path != Path::new("/dev/stdin") {
        return Err(Failure::new(
            Code::Input,
            format!(
                "{}: is a device; give a file of queries, or - for standard input",
                path.display()
            ),
        ));
    }
    let file = File::open(path).map_err(unreadable)?;
    let metadata = file.metadata().map_err(unreadable)?;
    if metadata.is_dir() {
        return Err(Failure::new(
            Code::Input,
            format!("{}: is a folder; give a file of queries", path.display()),
        ));
    }
    let size = metadata.is_file().then_some(metadata.len());
    let folder = path.parent().unwrap_or(Path::new("")).to_owned();
    Ok((BufReader::with_capacity(1 << 16, Box::new(file)), size, folder))
}

/// Checks whether a file is a device.
#[cfg(unix)]
fn is_device(metadata: &std::fs::Metadata) -> bool {
    use std::os::unix::fs::FileTypeExt;
    let kind = metadata.file_type();
    kind.is_char_device() || kind.is_block_device()
}

#[cfg(not(unix))]
fn is_device(_: &std::fs::Metadata) -> bool {
    false
}

/// Returns a progress bar over the bytes of the query file.
fn progress_bar(size: Option<u64>) -> ProgressBar {
    let template = match size {
        Some(_) => "{wide_bar} {bytes}/{total_bytes} {eta} left, {msg} queries",
        None => "{spinner} {bytes} {elapsed}, {msg} queries",
    };
    progress::bar_with_template(size, template)
}
