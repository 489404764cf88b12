//! `colltrans audit`: the pairs of parts of an assembly that interfere or are too near.
//!
//! Sources, roles and tolerances are those of [`assembly`](crate::assembly). `colltrans_assembly::audit` finds the pairs.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

use colltrans_assembly::audit::{
    Audit, AuditCounts, AuditOptions, AuditedPair, audit, audit_csv, audit_json, prove_pairs,
};
use colltrans_assembly::report::bcf::{MAX_TOPICS, bcf_file, metres_per_unit};
use colltrans_assembly::report::clashes::clashes_page;
use colltrans_assembly::{Assembly, Bodies, Fit, Watch};

use crate::args::AuditArguments;
use crate::assembly::output::{finding_text, head_text, source_title};
use crate::assembly::{in_thread_pool, read_assembly, show_stages, stage_bar};
use crate::failure::{Code, Failure, note, print, print_json};
use crate::inputs::{check_distinct_outputs, check_output_path, has_extension};
use crate::numbers::{count_text, length_down, length_up};
use crate::outputs::{self, PendingFile};
use crate::terminal::escape_line;

/// Maximum number of notes about missing proofs.
const MAX_NOTES: usize = 10;

pub(crate) fn run(arguments: &AuditArguments) -> Result<(), Failure> {
    in_thread_pool(arguments.threads, || audit_in_pool(arguments))
}

/// Audits the assembly in the current thread pool, and writes the answer.
fn audit_in_pool(arguments: &AuditArguments) -> Result<(), Failure> {
    let paths = [&arguments.csv, &arguments.report, &arguments.bcf];
    check_distinct_outputs(&paths.into_iter().flatten().map(PathBuf::as_path).collect::<Vec<_>>())?;
    let created = arguments.bcf.as_ref().map(|_| creation_seconds()).transpose()?;
    let assembly = read_assembly(&arguments.source, &arguments.input, &arguments.roles)?;
    let options = audit_options(arguments, &assembly)?;
    let inputs: Vec<_> = assembly.files().iter().map(PathBuf::as_path).collect();
    for path in paths.into_iter().flatten() {
        check_output_path(path, &inputs, "give the output another name")?;
    }
    note_wrong_extensions(arguments);
    if let Some(path) = &arguments.bcf {
        check_unit(path, &assembly)?;
    }
    // Opened first, so that a path that cannot be written is found before the work.
    if let Some(folder) = &arguments.proofs {
        create_empty_folder(folder)?;
    }
    let [csv, report, bcf] = paths.map(|path| path.as_deref().map(PendingFile::create).transpose());
    let files = OutputFiles { csv: csv?, report: report?, bcf: bcf?.zip(created) };
    let fit = arguments.tolerance.map_or_else(|| Fit::default_for(&assembly), Fit::Tolerance);
    let bodies = Bodies::new(&assembly, fit)?;
    let mut found = with_bar(|watch| audit(&bodies, &options, watch))?;
    if let Some(folder) = &arguments.proofs {
        with_bar(|watch| write_proofs(&bodies, &options, &mut found, folder, watch))?;
    }
    for text in assembly.notes() {
        note(text);
    }
    if assembly.parts().len() == 1 {
        note(&format!("{} has one part, so that there are no pairs", arguments.source.display()));
    }
    let title = source_title(&arguments.source);
    with_bar(|watch| files.write(&bodies, &options, &found, &title, watch))?;
    if let Some(path) = arguments.bcf.as_ref().filter(|_| found.counts.violations > MAX_TOPICS) {
        note(&format!("{} has the {MAX_TOPICS} worst violations", path.display()));
    }
    if arguments.json {
        let text = serde_json::to_string(&audit_json(&bodies, &options, &found));
        print_json(&(text.expect("an audit becomes JSON") + "\n"))?;
    } else {
        let mut text = audit_text(&bodies, &options, &found, arguments.limit);
        if let Some(folder) = &arguments.proofs {
            let count = found.pairs.iter().flat_map(AuditedPair::proof_files).count();
            let folder = escape_line(folder.display().to_string());
            let _ = writeln!(text, "{} in {folder}", count_text(count, "proof", "proofs"));
        }
        print(&text)?;
    }
    match found.counts.violations {
        0 => Ok(()),
        count => {
            let pairs = count_text(count, "pair interferes or is", "pairs interfere or are");
            Err(Failure::new(Code::Lines, format!("{pairs} nearer than the clearance")))
        }
    }
}

/// Creates a folder for proofs.
///
/// # Errors
/// It cannot be created, or has files, which would be taken for proofs of this audit.
fn create_empty_folder(folder: &Path) -> Result<(), Failure> {
    let failed = |error| Failure::write_error(folder.display(), &error);
    std::fs::create_dir_all(folder).map_err(failed)?;
    if std::fs::read_dir(folder).map_err(failed)?.next().is_some() {
        let place = folder.display();
        let message = format!("--proofs {place}: the folder is not empty; give a new or empty one");
        return Err(Failure::new(Code::Usage, message));
    }
    Ok(())
}

/// Writes the proofs of all pairs, and notes pairs without a proof.
fn write_proofs(
    bodies: &Bodies,
    options: &AuditOptions,
    found: &mut Audit,
    folder: &Path,
    watch: Watch,
) -> Result<(), Failure> {
    let assembly = bodies.assembly();
    let write = |name: &str, text: &str| outputs::write_proof(&folder.join(name), text);
    prove_pairs(assembly, found, options.volume, watch, write)?;
    let all = found.pairs.iter().flat_map(|pair| pair.proofs.iter().map(move |p| (pair, p)));
    let mut failed =
        all.filter_map(|(pair, proof)| Some((pair, proof.claim, proof.file.as_ref().err()?)));
    for (pair, claim, reason) in failed.by_ref().take(MAX_NOTES) {
        let [a, b] = pair.parts.map(|part| assembly.parts()[part].name());
        let what = claim.name().replace('_', " ");
        note(&format!("{a}, {b}: no proof of the {what}: {reason}"));
    }
    if let more @ 1.. = failed.count() {
        note(&format!("{more} more claims without a proof; --json lists them"));
    }
    Ok(())
}

/// Runs work whose stages are shown by a bar, which is then cleared.
fn with_bar<T>(work: impl FnOnce(Watch) -> T) -> T {
    let bar = stage_bar();
    let progress = show_stages(&bar);
    let result = work(Watch::default().with_progress(&progress));
    bar.finish_and_clear();
    result
}

/// The requested files.
struct OutputFiles {
    csv: Option<PendingFile>,
    report: Option<PendingFile>,
    /// With the time of creation of the topics, in seconds since 1970.
    bcf: Option<(PendingFile, u64)>,
}

impl OutputFiles {
    /// Writes the files. `title` is the name of the model.
    fn write(
        self,
        bodies: &Bodies,
        options: &AuditOptions,
        found: &Audit,
        title: &str,
        watch: Watch,
    ) -> Result<(), Failure> {
        let assembly = bodies.assembly();
        if let Some(file) = self.csv {
            file.write(audit_csv(assembly, found).as_bytes())?;
        }
        if let Some(file) = self.report {
            file.write(clashes_page(bodies, options, found, title, watch)?.as_bytes())?;
        }
        if let Some((file, created)) = self.bcf {
            let path = file.path().display().to_string();
            let bytes = bcf_file(assembly, found, title, created, watch)
                .map_err(|error| Failure::write_error(&path, &error))?;
            file.write(&bytes)?;
        }
        Ok(())
    }
}

/// Prints a note for each output that has the extension of another one.
fn note_wrong_extensions(arguments: &AuditArguments) {
    let outputs = [
        (&arguments.csv, "--csv writes a table (.csv)", &["csv"][..]),
        (&arguments.report, "--report writes a web page (.html)", &["html", "htm"]),
        (&arguments.bcf, "--bcf writes a BCF file (.bcf)", &["bcf", "bcfzip"]),
    ];
    let known: Vec<&str> = outputs.iter().flat_map(|output| output.2).copied().collect();
    for (path, what, own) in outputs {
        let is_other = |path: &&PathBuf| has_extension(path, &known) && !has_extension(path, own);
        if let Some(path) = path.as_ref().filter(is_other) {
            note(&format!("{}: {what}", path.display()));
        }
    }
}

/// Checks the unit of a model that becomes a BCF file, and notes a missing one.
///
/// # Errors
/// The unit is unknown.
fn check_unit(path: &Path, assembly: &Assembly) -> Result<(), Failure> {
    let path = path.display();
    let refused = |message| Failure::new(Code::Input, format!("{path}: {message}"));
    metres_per_unit(assembly).map_err(refused)?;
    if assembly.unit().is_none() {
        note(&format!("{path}: the source has no unit; its coordinates are taken to be in metres"));
    }
    Ok(())
}

/// Returns the time of creation of the topics in a BCF file, in seconds since 1970: that of the environment variable
/// `SOURCE_DATE_EPOCH`, or else the current time.
fn creation_seconds() -> Result<u64, Failure> {
    let Some(given) = std::env::var_os("SOURCE_DATE_EPOCH") else {
        let now = SystemTime::now().duration_since(UNIX_EPOCH);
        return Ok(now.map_or(0, |since| since.as_secs()));
    };
    given.to_str().and_then(|text| text.parse().ok()).ok_or_else(|| {
        let text = format!("SOURCE_DATE_EPOCH={}: expected seconds since 1970", given.display());
        Failure::new(Code::Usage, text)
    })
}

/// Returns the required clearances of the command line.
fn audit_options(arguments: &AuditArguments, assembly: &Assembly) -> Result<AuditOptions, Failure> {
    let mut options = AuditOptions::default().with_allow_contact(arguments.allow_contact);
    for given in &arguments.within {
        options = match &given.groups {
            None => options.with_within(given.length)?,
            Some([a, b]) => options.with_level(assembly, [&[a], &[b]], given.length)?,
        };
    }
    Ok(options)
}

/// Returns the answer as text: the settings, one line for each violation, at most `limit`, and the numbers of pairs.
fn audit_text(
    bodies: &Bodies,
    options: &AuditOptions,
    found: &Audit,
    limit: Option<usize>,
) -> String {
    let assembly = bodies.assembly();
    let mut text = head_text(bodies, true);
    let contact = if options.allow_contact { ", contacts permitted" } else { "" };
    let _ = writeln!(text, "clearance: {}{contact}", length_down(options.within));
    for level in options.levels() {
        let [a, b] = level.names.each_ref().map(|names| escape_line(names.join(", ")));
        let _ = writeln!(text, "clearance of {a} and {b}: {}", length_down(level.length));
    }
    let limit = limit.unwrap_or(usize::MAX);
    for pair in found.violations().take(limit) {
        let [a, b] = pair.parts.map(|part| escape_line(assembly.parts()[part].name()));
        let tolerance = pair.finding.interference().and_then(|found| found.least_tolerance);
        let by = tolerance.map_or_else(String::new, |length| format!(" by {}", length_up(length)));
        let _ = write!(text, "  {a}, {b}{by}: {}", finding_text(assembly, pair));
        for part in pair.open_parts() {
            let name = escape_line(assembly.parts()[part].name());
            let _ = write!(text, ", {name} has open shells");
        }
        text.push('\n');
    }
    if let more @ 1.. = found.counts.violations.saturating_sub(limit) {
        let _ = writeln!(text, "  and {more} more");
    }
    let AuditCounts { examined, ignored, interfering, contained, touching, near, .. } =
        found.counts;
    let _ = writeln!(
        text,
        "{} examined: {interfering} interfering, {contained} contained, {touching} touching, {near} nearer than the \
         clearance",
        count_text(examined, "pair", "pairs"),
    );
    if ignored > 0 {
        let _ = writeln!(text, "{} ignored or glued", count_text(ignored, "pair", "pairs"));
    }
    text
}
