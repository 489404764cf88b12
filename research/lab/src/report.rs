//! A page about a run: results next to the claims that they support or refute, and the origin of the numbers.
//! The page is self-contained, without scripts, fonts or external pictures.

use std::fmt::{self, Write};
use std::time::Duration;

use crate::Experiment;
use crate::claims::{Claim, PaperClaim, Subject, Theme, Verdict, Why};
use crate::draw::Picture;
use crate::finding::{Figure, Finding, Table};
use crate::plan::Plan;
use colltrans_testkit::provenance::{Provenance, readable_duration};

/// A finished experiment.
#[derive(Debug, Clone)]
pub struct Done {
    /// The experiment.
    pub experiment: Experiment,
    /// Its result.
    pub finding: Finding,
    /// Pictures of its figures, in the same order.
    pub pictures: Vec<Picture>,
    /// Its duration.
    pub wall: Duration,
}

/// Content of the page.
#[derive(Debug)]
pub struct Report<'r> {
    /// Origin of the numbers.
    pub provenance: &'r Provenance,
    /// Parameters of the run.
    pub plan: &'r Plan,
    /// Finished experiments.
    pub done: &'r [Done],
    /// Number of experiments of the run.
    pub all: usize,
    /// Time since the start.
    pub wall: Duration,
}

/// Returns the page.
pub fn html(report: &Report) -> String {
    let mut page = String::new();
    // Writing to a string cannot fail.
    let _ = write_page(&mut page, report);
    page
}

/// Warning for unoptimised builds.
pub(crate) const UNOPTIMISED: &str = "This is an unoptimised build: its times mean nothing.";

/// All verdicts, the worst first.
const VERDICTS: [Verdict; 4] =
    [Verdict::Fails, Verdict::Undecided, Verdict::Holds, Verdict::Better];

/// Returns the number of claims about CTA with each verdict, and of those about other algorithms.
pub(crate) fn verdict_counts(done: &[Done]) -> String {
    let of =
        |subject: Subject| all_claims(done).filter(move |claim| claim.paper.subject == subject);
    let all = of(Subject::Cta).count();
    if all_claims(done).count() == 0 {
        return "No claim was put to the test".into();
    }
    let with = |verdict: Verdict| of(Subject::Cta).filter(|claim| claim.verdict == verdict).count();
    let [fail, undecided, hold, better] = VERDICTS.map(with);
    let others = of(Subject::Other);
    let kept = of(Subject::Other).filter(|claim| claim.verdict.is_kept());
    format!(
        "{} of {all} claims about CTA hold, {better} of them better than the paper states; {fail} do not hold, \
         {undecided} are undecided. {} of {} claims about other algorithms hold",
        hold + better,
        kept.count(),
        others.count()
    )
}

/// Returns a line for each theme: the number of claims that hold, and the others with verdict and reason.
pub(crate) fn theme_lines(done: &[Done]) -> Vec<String> {
    let line = |theme: Theme| {
        let of = || all_claims(done).filter(|claim| claim.paper.theme == theme);
        let kept = of().filter(|claim| claim.verdict.is_kept()).count();
        let open = of().filter_map(|claim| {
            let why = claim.why.as_ref()?;
            Some(format!("{} {} ({})", claim.paper.id, claim.verdict, why.reason))
        });
        let open = open.collect::<Vec<_>>().join(", ");
        let rest = if open.is_empty() { String::new() } else { format!("; {open}") };
        (of().count() > 0).then(|| format!("{theme}: {kept} of {} hold{rest}", of().count()))
    };
    Theme::ALL.into_iter().filter_map(line).collect()
}

/// Iterates over all claims.
fn all_claims(done: &[Done]) -> impl Iterator<Item = &Claim> {
    done.iter().flat_map(|done| &done.finding.claims)
}

/// Writes the whole page.
fn write_page(page: &mut String, report: &Report) -> fmt::Result {
    let style = include_str!("report.css");
    write!(
        page,
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>Collision translations: the paper's experiments</title>\n\
         <style>\n{style}</style>\n</head>\n<body>\n<header>\n\
         <h1>Collision translations: the paper’s experiments, run anew</h1>\n\
         <p class=\"faint\">The paper: Mirolo, Carpin and Pagello, “Incremental Convex Minimization for Computing \
         Collision Translations of Convex Polyhedra”, IEEE Transactions on Robotics 23(3), 2007, \
         section V.</p>\n"
    )?;
    write_state(page, report)?;
    write_overview(page, report.done)?;
    write_reasons(page, report.done)?;
    write_facts(page, report)?;
    page.push_str("</header>\n<main>\n");
    for done in report.done {
        write_experiment(page, done)?;
    }
    page.push_str("</main>\n</body>\n</html>\n");
    Ok(())
}

/// Writes the state of the run: verdicts, missing experiments, and a warning for unoptimised builds.
fn write_state(page: &mut String, report: &Report) -> fmt::Result {
    writeln!(page, "<p><strong>{}.</strong></p>", verdict_counts(report.done))?;
    page.push_str("<ul class=\"themes\">\n");
    for line in theme_lines(report.done) {
        writeln!(page, "<li>{}</li>", Escaped(&line))?;
    }
    page.push_str("</ul>\n");
    let (done, all) = (report.done.len(), report.all);
    if done < all {
        let state = format!("{done} of {all} experiments were finished when this was written.");
        writeln!(page, "<p class=\"warning\">{state}</p>")?;
    }
    if !report.provenance.is_optimised {
        writeln!(page, "<p class=\"warning\">{UNOPTIMISED}</p>")?;
    }
    Ok(())
}

/// Writes the origin of the numbers.
fn write_facts(page: &mut String, report: &Report) -> fmt::Result {
    let Provenance { processor, cores, system, versions, build, date, command, .. } =
        report.provenance;
    let (scale, seed) = (report.plan.scale.name().to_owned(), report.plan.seed.to_string());
    let facts = [
        ("Processor", processor),
        ("Cores", cores),
        ("System", system),
        ("Versions", versions),
        ("Build", build),
        ("Date", date),
        ("Command", command),
        ("Scale", &scale),
        ("Seed", &seed),
        ("Wall time", &readable_duration(report.wall)),
    ];
    page.push_str("<dl class=\"facts\">\n");
    for (name, value) in facts {
        writeln!(page, "<dt>{name}</dt><dd>{}</dd>", Escaped(value))?;
    }
    page.push_str("</dl>\n");
    Ok(())
}

/// Writes all claims by verdict, one in each line, with the paper's number and the first measured one.
fn write_overview(page: &mut String, done: &[Done]) -> fmt::Result {
    page.push_str("<div class=\"overview\">\n");
    for verdict in VERDICTS {
        for (id, claim) in claims_of(done, verdict) {
            let PaperClaim { id: name, statement, paper, .. } = claim.paper;
            let here = claim.measured.first().map_or(String::new(), ToString::to_string);
            writeln!(
                page,
                "<p class=\"{}\"><a href=\"#{id}\" title=\"{}\">{name}</a> <span \
                 class=\"faint\">{}:</span> {here} <span class=\"verdict\">{verdict}</span></p>",
                class(verdict),
                Escaped(statement),
                Escaped(paper)
            )?;
        }
    }
    page.push_str("</div>\n");
    Ok(())
}

/// Writes the first sentence of the reason for each claim that fails or is undecided.
fn write_reasons(page: &mut String, done: &[Done]) -> fmt::Result {
    page.push_str("<ul class=\"reasons\">\n");
    for verdict in [Verdict::Fails, Verdict::Undecided] {
        for (id, claim) in claims_of(done, verdict) {
            let Some(Why { reason, text }) = &claim.why else { continue };
            let end = text.find(". ").map_or(text.len(), |end| end + 1);
            let (name, why) = (claim.paper.id, Escaped(&text[..end]));
            writeln!(page, "<li><a href=\"#{id}\">{name}</a>, {reason}: {why}</li>")?;
        }
    }
    page.push_str("</ul>\n");
    Ok(())
}

/// Iterates over the claims with a verdict, with the identifiers of their experiments.
fn claims_of(done: &[Done], verdict: Verdict) -> impl Iterator<Item = (&'static str, &Claim)> {
    let claims = done
        .iter()
        .flat_map(|done| done.finding.claims.iter().map(|claim| (done.experiment.id, claim)));
    claims.filter(move |(_, claim)| claim.verdict == verdict)
}

/// Writes the section of an experiment.
fn write_experiment(page: &mut String, done: &Done) -> fmt::Result {
    let (id, name) = (done.experiment.id, done.experiment.name());
    let title = Escaped(done.experiment.title);
    let wall = readable_duration(done.wall);
    write!(
        page,
        "<section id=\"{id}\">\n<h2>{name}: {title}</h2>\n<p class=\"faint\">Measured in {wall}.\
         </p>\n<div class=\"beside\">\n<div>\n"
    )?;
    for (figure, picture) in done.finding.figures.iter().zip(&done.pictures) {
        write_figure(page, figure, picture)?;
    }
    for table in &done.finding.tables {
        write_table(page, table)?;
    }
    page.push_str("</div>\n<ul class=\"claims\">\n");
    for claim in &done.finding.claims {
        write_claim(page, claim)?;
    }
    page.push_str("</ul>\n</div>\n</section>\n");
    Ok(())
}

/// Writes a figure with its notes.
fn write_figure(page: &mut String, figure: &Figure, picture: &Picture) -> fmt::Result {
    writeln!(page, "<figure>\n{}\n<figcaption>", picture.svg.trim_end())?;
    for note in &picture.notes {
        writeln!(page, "{}<br>", Escaped(note))?;
    }
    writeln!(page, "Data: {}.csv</figcaption>\n</figure>", Escaped(&figure.id))
}

/// Writes a table.
fn write_table(page: &mut String, table: &Table) -> fmt::Result {
    let title = Escaped(&table.title);
    write!(page, "<div class=\"wide\"><table>\n<caption>{title}</caption>\n<thead><tr>")?;
    for head in &table.columns {
        write!(page, "<th>{}</th>", Escaped(head))?;
    }
    page.push_str("</tr></thead>\n<tbody>\n");
    for row in &table.rows {
        page.push_str("<tr>");
        for cell in row {
            let is_number = cell.starts_with(|c: char| c.is_ascii_digit() || "-−+.<".contains(c));
            let class = if is_number { " class=\"number\"" } else { "" };
            write!(page, "<td{class}>{}</td>", Escaped(cell))?;
        }
        page.push_str("</tr>\n");
    }
    let id = Escaped(&table.id);
    writeln!(page, "</tbody></table>\n<p class=\"faint\">Data: {id}.csv</p></div>")
}

/// Writes a claim with its measurements and reason.
fn write_claim(page: &mut String, claim: &Claim) -> fmt::Result {
    let PaperClaim { id, statement, paper, place, criteria, .. } = claim.paper;
    write!(
        page,
        "<li class=\"{}\"><span class=\"verdict\">{}</span> <span class=\"faint\">{id}</span>\n\
         <p class=\"statement\">{}</p>\n<p>The paper: {} ({}).</p>\n",
        class(claim.verdict),
        claim.verdict,
        Escaped(statement),
        Escaped(paper),
        Escaped(place)
    )?;
    for (criterion, measured) in criteria.iter().zip(&claim.measured) {
        let what = Escaped(criterion.what);
        let judged = Escaped(&criterion.band());
        writeln!(page, "<p>Measured: <strong>{measured}</strong>: {what}; {judged}</p>")?;
    }
    if !claim.details.is_empty() {
        writeln!(page, "<p>{}</p>", Escaped(&claim.details))?;
    }
    if let Some(Why { reason, text }) = &claim.why {
        writeln!(page, "<p>Why ({reason}): {}</p>", Escaped(text))?;
    }
    page.push_str("</li>\n");
    Ok(())
}

/// Returns the CSS class of a verdict.
fn class(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Holds => "holds",
        Verdict::Better => "better",
        Verdict::Undecided => "undecided",
        Verdict::Fails => "fails",
    }
}

/// A text escaped for HTML elements and quoted attributes.
struct Escaped<'t>(&'t str);

impl fmt::Display for Escaped<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for c in self.0.chars() {
            match c {
                '&' => f.write_str("&amp;")?,
                '<' => f.write_str("&lt;")?,
                '>' => f.write_str("&gt;")?,
                '"' => f.write_str("&quot;")?,
                _ => f.write_char(c)?,
            }
        }
        Ok(())
    }
}
