//! `colltrans audit`: the pairs of parts of an assembly that interfere or are too near.
//!
//! Sources, roles and tolerances are those of [`assembly`](crate::assembly). `colltrans_assembly::audit` finds the pairs.

use std::fmt::Write as _;
use std::time::{SystemTime, UNIX_EPOCH};

use colltrans_assembly::audit::{Audit, AuditCounts, AuditOptions, audit, audit_csv, audit_json};
use colltrans_assembly::report::bcf::{MAX_TOPICS, bcf_file};
use colltrans_assembly::report::clashes::clashes_page;
use colltrans_assembly::{Assembly, Bodies, Fit, Watch};

use crate::args::AuditArguments;
use crate::assembly::output::{finding_text, head_text, source_title};
use crate::assembly::{in_thread_pool, read_assembly, show_stages, stage_bar};
use crate::failure::{Code, Failure, note, print, print_json};
use crate::inputs::check_output_path;
use crate::numbers::{count_text, length_down, length_up};
use crate::outputs;
use crate::terminal::escape_line;

pub(crate) fn run(arguments: &AuditArguments) -> Result<(), Failure> {
    in_thread_pool(arguments.threads, || audit_in_pool(arguments))
}

/// Audits the assembly in the current thread pool, and writes the answer.
fn audit_in_pool(arguments: &AuditArguments) -> Result<(), Failure> {
    let assembly = read_assembly(&arguments.source, &arguments.input, &arguments.roles)?;
    let options = audit_options(arguments, &assembly)?;
    let inputs: Vec<_> = assembly.files().iter().map(std::path::PathBuf::as_path).collect();
    for path in [&arguments.csv, &arguments.report, &arguments.bcf].into_iter().flatten() {
        check_output_path(path, &inputs, "give the output another name")?;
    }
    let created = if arguments.bcf.is_some() { creation_seconds()? } else { 0 };
    let fit = arguments.tolerance.map_or_else(|| Fit::default_for(&assembly), Fit::Tolerance);
    let bodies = Bodies::new(&assembly, fit)?;
    let bar = stage_bar();
    let progress = show_stages(&bar);
    let found = audit(&bodies, &options, Watch::default().with_progress(&progress))?;
    bar.finish_and_clear();
    for text in assembly.notes() {
        note(text);
    }
    write_files(&bodies, &options, &found, arguments, created)?;
    if arguments.json {
        print_json(&format!("{}\n", audit_json(&bodies, &options, &found)))?;
    } else {
        print(&audit_text(&bodies, arguments, &found))?;
    }
    match found.counts.violations {
        0 => Ok(()),
        count => {
            let pairs = count_text(count, "pair interferes or is", "pairs interfere or are");
            Err(Failure::new(Code::Lines, format!("{pairs} nearer than the clearance")))
        }
    }
}

/// Writes the requested files. `created`, in seconds since 1970, is the time in a BCF file.
fn write_files(
    bodies: &Bodies,
    options: &AuditOptions,
    found: &Audit,
    arguments: &AuditArguments,
    created: u64,
) -> Result<(), Failure> {
    let (assembly, title) = (bodies.assembly(), source_title(&arguments.source));
    if let Some(csv) = &arguments.csv {
        outputs::write(csv, audit_csv(assembly, found).as_bytes())?;
    }
    if let Some(report) = &arguments.report {
        outputs::write(report, clashes_page(bodies, options, found, &title).as_bytes())?;
    }
    if let Some(path) = &arguments.bcf {
        let bytes = bcf_file(assembly, found, &title, created)
            .map_err(|error| Failure::write_error(path.display(), &error))?;
        outputs::write(path, &bytes)?;
        if found.counts.violations > MAX_TOPICS {
            note(&format!("{} has the {MAX_TOPICS} worst violations", path.display()));
        }
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

/// Returns the answer as text: one line for each violation, and the numbers of pairs.
fn audit_text(bodies: &Bodies, arguments: &AuditArguments, found: &Audit) -> String {
    let assembly = bodies.assembly();
    let mut text = head_text(bodies);
    for given in &arguments.within {
        let groups = given.groups.as_ref().map(|[a, b]| format!(" of {a} and {b}"));
        let groups = escape_line(groups.unwrap_or_default());
        let _ = writeln!(text, "clearance{groups}: {}", length_down(given.length));
    }
    let limit = arguments.limit.unwrap_or(usize::MAX);
    for pair in found.violations().take(limit) {
        let [a, b] = pair.parts.map(|part| escape_line(assembly.parts()[part].name()));
        let tolerance = pair.finding.interference().and_then(|found| found.least_tolerance);
        let by = tolerance.map_or_else(String::new, |length| format!(" by {}", length_up(length)));
        let _ = writeln!(text, "  {a}, {b}{by}: {}", finding_text(assembly, pair));
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
        let _ = writeln!(text, "{} ignored", count_text(ignored, "pair", "pairs"));
    }
    text
}
