//! One page about a run: what was found, beside the claims it supports or refutes, and where the
//! numbers come from. It needs nothing but itself: no script, no font, no picture from elsewhere.

use std::fmt::{self, Write};
use std::time::Duration;

use crate::draw::Picture;
use crate::finding::{Claim, Figure, Table};
use crate::plan::Plan;
use crate::run::Done;
use colltrans_kit::provenance::{Provenance, for_people};

/// What the page is about.
#[derive(Debug)]
pub struct Report<'r> {
    /// Where the numbers come from.
    pub provenance: &'r Provenance,
    /// How much was measured.
    pub plan: &'r Plan,
    /// What is finished.
    pub done: &'r [Done],
    /// How many experiments there are to be.
    pub all: usize,
    /// The time since the start.
    pub wall: Duration,
}

/// The page.
pub fn html(report: &Report) -> String {
    let mut page = String::new();
    // Writing to a string cannot fail.
    let _ = write_page(&mut page, report);
    page
}

/// What is to be said of such a build.
pub(crate) const UNOPTIMISED: &str = "This is an unoptimised build: its times mean nothing.";

/// A verdict in words.
pub(crate) fn verdict(holds: bool) -> &'static str {
    if holds { "holds" } else { "does not hold" }
}

/// How many of the claims hold, in words.
pub(crate) fn count(done: &[Done]) -> String {
    let claims = || done.iter().flat_map(|done| &done.finding.claims);
    let (hold, all) = (claims().filter(|claim| claim.holds).count(), claims().count());
    match all {
        0 => "No claim was put to the test".into(),
        1 => format!("The claim {}", verdict(hold == 1)),
        _ => format!("{hold} of {all} claims hold"),
    }
}

fn write_page(page: &mut String, report: &Report) -> fmt::Result {
    let style = include_str!("report.css");
    write!(
        page,
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>Collision translations: the paper's experiments</title>\n\
         <style>\n{style}</style>\n</head>\n<body>\n<header>\n\
         <h1>Collision translations: the paper’s experiments, run anew</h1>\n\
         <p>The paper: Mirolo, Carpin and Pagello, “Incremental Convex Minimization for Computing \
         Collision Translations of Convex Polyhedra”, IEEE Transactions on Robotics 23(3), 2007, \
         section V.</p>\n"
    )?;
    write_state(page, report)?;
    write_facts(page, report)?;
    write_overview(page, report.done)?;
    page.push_str("</header>\n<main>\n");
    for done in report.done {
        write_experiment(page, done)?;
    }
    page.push_str("</main>\n</body>\n</html>\n");
    Ok(())
}

fn write_state(page: &mut String, report: &Report) -> fmt::Result {
    writeln!(page, "<p><strong>{}.</strong></p>", count(report.done))?;
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
        ("Wall time", &for_people(report.wall)),
    ];
    page.push_str("<dl class=\"facts\">\n");
    for (name, value) in facts {
        writeln!(page, "<dt>{name}</dt><dd>{}</dd>", Escaped(value))?;
    }
    page.push_str("</dl>\n");
    Ok(())
}

/// All claims in a table, each linked to its figure.
fn write_overview(page: &mut String, done: &[Done]) -> fmt::Result {
    if done.iter().all(|done| done.finding.claims.is_empty()) {
        return Ok(());
    }
    page.push_str("<div class=\"wide\"><table class=\"overview\">\n");
    page.push_str(
        "<thead><tr><th>Where</th><th>Claim</th><th>Verdict</th></tr></thead>\n<tbody>\n",
    );
    for done in done {
        let (id, name) = (done.experiment.id, done.experiment.name());
        for claim in &done.finding.claims {
            let (class, words) = (class(claim), verdict(claim.holds));
            let statement = Escaped(&claim.statement);
            writeln!(
                page,
                "<tr class=\"{class}\"><td><a href=\"#{id}\">{name}</a></td><td>{statement}</td>\
                 <td><span class=\"verdict\">{words}</span></td></tr>"
            )?;
        }
    }
    page.push_str("</tbody></table></div>\n");
    Ok(())
}

fn write_experiment(page: &mut String, done: &Done) -> fmt::Result {
    let (id, name) = (done.experiment.id, done.experiment.name());
    let title = Escaped(done.experiment.title);
    let wall = for_people(done.wall);
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

fn write_figure(page: &mut String, figure: &Figure, picture: &Picture) -> fmt::Result {
    writeln!(page, "<figure>\n{}\n<figcaption>", picture.svg.trim_end())?;
    for note in &picture.notes {
        writeln!(page, "{}<br>", Escaped(note))?;
    }
    writeln!(page, "Data: {}.csv</figcaption>\n</figure>", Escaped(&figure.id))
}

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

fn write_claim(page: &mut String, claim: &Claim) -> fmt::Result {
    let (class, words) = (class(claim), verdict(claim.holds));
    let (statement, measured) = (Escaped(&claim.statement), Escaped(&claim.measured));
    write!(
        page,
        "<li class=\"{class}\"><span class=\"verdict\">{words}</span>\n\
         <p class=\"statement\">{statement}</p>\n<p>Measured: {measured}</p>\n"
    )?;
    if let Some(why) = &claim.why {
        writeln!(page, "<p>Why: {}</p>", Escaped(why))?;
    }
    page.push_str("</li>\n");
    Ok(())
}

fn class(claim: &Claim) -> &'static str {
    if claim.holds { "holds" } else { "fails" }
}

/// Text as HTML, in elements and in quoted attributes.
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
