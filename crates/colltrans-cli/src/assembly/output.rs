//! Prints the answer of `assembly`, and writes the files of `-o`.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::ops::Range;
use std::path::{Path, PathBuf};

use colltrans::glam::DVec3;
use colltrans_assembly::attempts::next_attempts;
use colltrans_assembly::audit::{AuditOptions, AuditedPair, PairFinding, examine_overlap};
use colltrans_assembly::fasteners::Unscrewing;
use colltrans_assembly::hints::find_hints;
use colltrans_assembly::plan::{Plan, precedence_graph};
use colltrans_assembly::report::{bill_csv, facts, glb, html};
use colltrans_assembly::{Analysis, Assembly, Bodies, Fit};
use colltrans_assembly::{map, record, suggest};

use super::free::GroupRemoval;
use crate::args::AssemblyArguments;
use crate::directions;
use crate::failure::{Failure, note, print, print_json};
use crate::inputs::check_output_path;
use crate::numbers::{
    count_text, estimate, interval, length_down, length_up, point, smaller_extent, vector,
};
use crate::outputs::{FileNames, Outputs};
use crate::terminal::{escape_json, escape_line};

/// Writes the files if there is a folder, then prints the answer as JSON or text.
///
/// # Errors
/// An output cannot be written.
pub(super) fn write(
    findings: &Analysis,
    removals: &[GroupRemoval],
    arguments: &AssemblyArguments,
) -> Result<(), Failure> {
    for text in findings.bodies.assembly().notes() {
        note(text);
    }
    let mut json = facts::findings_json(findings);
    if !removals.is_empty() {
        json["free"] = removals.iter().map(GroupRemoval::json).collect();
    }
    if let Some(folder) = &arguments.output {
        write_files(findings, removals, arguments, folder, &json)?;
    }
    if arguments.json {
        return print_json(&format!("{json}\n"));
    }
    let mut text = summary_text(findings, arguments.notes);
    for removal in removals {
        removal.push_text(&mut text);
    }
    print(&text)
}

/// Writes all files of the folder. None of them appears before all are complete.
fn write_files(
    findings: &Analysis,
    removals: &[GroupRemoval],
    arguments: &AssemblyArguments,
    folder: &Path,
    json: &serde_json::Value,
) -> Result<(), Failure> {
    std::fs::create_dir_all(folder).map_err(|e| Failure::write_error(folder.display(), &e))?;
    let mut outputs = Outputs::default();
    let mut put = |name: &str, bytes: &[u8]| outputs.write(&folder.join(name), bytes);
    let title = source_title(&arguments.source);
    put("report.html", html::report_page(findings, &title).as_bytes())?;
    put("instructions.html", html::instructions_page(findings, &title).as_bytes())?;
    put("bill.csv", bill_csv(findings).as_bytes())?;
    put("disassembly.glb", &glb::plan_animation(findings.bodies.assembly(), &findings.plan))?;
    put("assembly.json", escape_json(&json.to_string()).as_bytes())?;
    put("matrix.csv", findings.matrix.to_csv(findings.bodies).as_bytes())?;
    let assembly = findings.bodies.assembly();
    put("precedence.csv", findings.plan.to_csv(assembly, &findings.times).as_bytes())?;
    let and_or_graph = precedence_graph(assembly, &findings.matrix).to_string();
    put("precedence.json", escape_json(&and_or_graph).as_bytes())?;
    let names = map_names(findings.maps.iter().map(|(name, _)| name));
    for ((name, map), [svg, png, json]) in findings.maps.iter().zip(names) {
        let title = format!("Free travel of {name} in all directions");
        put(&svg, map::render_svg(map, &title).as_bytes())?;
        put(&png, &map::render_png(map, 1_200))?;
        put(&json, escape_json(&record::map_json(findings.bodies, map).to_string()).as_bytes())?;
    }
    let names = proof_names(removals.iter().map(|removal| &removal.name));
    for (removal, name) in removals.iter().zip(names) {
        if let Some(proof) = &removal.proof {
            put(&name, format!("{}\n", proof.to_json()).as_bytes())?;
        }
    }
    outputs.finish()
}

/// Returns the title of reports about a source: its name without extension.
pub(crate) fn source_title(source: &Path) -> String {
    let source = source.canonicalize().unwrap_or_else(|_| source.to_owned());
    source.file_stem().map_or("assembly".into(), |stem| stem.to_string_lossy().into_owned())
}

/// Checks that no output overwrites an input.
///
/// # Errors
/// An output would overwrite an input.
pub(super) fn check_output_paths(
    arguments: &AssemblyArguments,
    assembly: &Assembly,
) -> Result<(), Failure> {
    let Some(folder) = &arguments.output else { return Ok(()) };
    let files = assembly.files().iter().chain(&arguments.directions).chain(&arguments.times);
    let inputs: Vec<&Path> = files.map(PathBuf::as_path).collect();
    let fixed = [
        "report.html",
        "instructions.html",
        "bill.csv",
        "disassembly.glb",
        "assembly.json",
        "matrix.csv",
        "precedence.csv",
        "precedence.json",
    ];
    let maps = map_names(&arguments.map).into_iter().flatten();
    let all = maps.chain(proof_names(&arguments.free));
    for name in fixed.into_iter().map(str::to_owned).chain(all) {
        check_output_path(&folder.join(name), &inputs, "give another folder")?;
    }
    Ok(())
}

/// Returns the names of the three files of each map.
fn map_names<'a>(maps: impl IntoIterator<Item = &'a String>) -> Vec<[String; 3]> {
    let mut names = FileNames::default();
    let files = |name: &String| {
        let name = names.unique_name(name);
        ["svg", "png", "json"].map(|extension| format!("map-{name}.{extension}"))
    };
    maps.into_iter().map(files).collect()
}

/// Returns the names of the proofs of removal directions.
fn proof_names<'a>(parts: impl IntoIterator<Item = &'a String>) -> Vec<String> {
    let mut names = FileNames::default();
    parts.into_iter().map(|name| format!("free-{}.json", names.unique_name(name))).collect()
}

/// Returns the kind of a note: its text before the first detail, without numbers.
fn note_kind(text: &str) -> String {
    let end = text.find(['(', ':', ';']).unwrap_or(text.len());
    let words = text[..end].split_whitespace();
    words.filter(|word| word.parse::<f64>().is_err()).collect::<Vec<_>>().join(" ")
}

/// Appends notes on parts, each with the name of its part. Unless `all` are wanted, notes of one kind on several parts
/// are one line with their names.
fn push_notes(text: &mut String, notes: &[(&str, String)], all: bool) {
    let kinds: Vec<String> = notes.iter().map(|(_, note)| note_kind(note)).collect();
    let mut of_kind = BTreeMap::<&str, Vec<&str>>::new();
    for (kind, (name, _)) in kinds.iter().zip(notes) {
        of_kind.entry(kind).or_default().push(name);
    }
    for (kind, (name, note)) in kinds.iter().zip(notes) {
        let Some(same) = of_kind.get(kind.as_str()) else { continue };
        if all || same.len() <= MAX_EQUAL_NOTES {
            let _ = writeln!(text, "  {}: {}", escape_line(name), escape_line(note));
            continue;
        }
        let (count, names) = (same.len(), escape_line(name_list(same)));
        let kind_text = escape_line(kind);
        let _ = writeln!(text, "  {count} x {kind_text}: {names} (--notes lists each)");
        // The line is for all notes of the kind.
        of_kind.remove(kind.as_str());
    }
}

/// Returns the first lines of an answer: the number of parts, the tolerance, and the defects of parts: one line for
/// each kind, unless `all` are wanted.
pub(crate) fn head_text(bodies: &Bodies, all: bool) -> String {
    let parts = bodies.assembly().parts();
    let fit = match bodies.fit() {
        Fit::Tolerance(length) => format!("tolerance {}", length_up(length)),
        Fit::Chords { largest, .. } => {
            let largest = length_up(largest);
            format!("tolerance of each pair by its chord errors, {largest} at most")
        }
        Fit::MinGap(length) => format!("minimum gap {}", length_down(length)),
    };
    let mut text = format!("{}, {fit}\n", count_text(parts.len(), "part", "parts"));
    let mut notes = Vec::new();
    for (k, part) in parts.iter().enumerate() {
        let defects = part.defects().iter().cloned().chain(bodies.shrink_defects(k));
        notes.extend(defects.map(|defect| (part.name(), defect)));
    }
    push_notes(&mut text, &notes, all);
    text
}

/// Describes how two parts lie to each other.
pub(crate) fn finding_text(assembly: &Assembly, pair: &AuditedPair) -> String {
    let parts = pair.parts.map(|part| &assembly.parts()[part]);
    let extent = smaller_extent(parts.map(|part| part.solid().bounds()));
    let mut text = match &pair.finding {
        PairFinding::Contained { inner, .. } => {
            format!("{} contained", escape_line(assembly.parts()[*inner].name()))
        }
        PairFinding::Apart(found) => format!("{} apart", interval(found.distance)),
        finding => finding.name().to_owned(),
    };
    if let Some(found) = pair.finding.interference()
        && let Some(depth) = found.known_depth()
    {
        let [depth, volume] = [depth.bounds(), found.common.volume].map(interval);
        let _ = write!(text, ", depth {depth}, volume {volume}");
    }
    let _ = write!(text, ", at {}", point(pair.finding.place(), 0.0, extent));
    if let PairFinding::Apart(found) = &pair.finding {
        let _ = write!(text, " and {}", point(found.points[1], 0.0, extent));
    }
    if let Some(wall) = pair.finding.wall() {
        let [from, to] = wall.points.map(|at| point(at, 0.0, extent));
        let _ = write!(text, ", wall {} from {from} to {to}", interval(wall.distance));
    }
    text
}

/// Returns the answer as text. Unless `all` notes are wanted, those of one kind are one line.
fn summary_text(findings: &Analysis, all: bool) -> String {
    let assembly = findings.bodies.assembly();
    let names = |parts: &[usize]| escape_line(name_list(&assembly.part_names(parts)));
    let mut text = head_text(findings.bodies, all);
    for hint in find_hints(findings.bodies, &findings.start) {
        let _ = writeln!(text, "  {}", escape_line(hint.description));
    }
    push_overlaps(&mut text, findings, all);
    if !findings.plan.steps.is_empty() {
        text.push_str("plan\n");
    }
    for stage in findings.plan.stages() {
        push_stage(&mut text, findings, &stage);
    }
    let (seconds, rounds) = (
        findings.times.step_seconds(&findings.plan).iter().sum::<f64>(),
        findings.plan.parallel_rounds().len(),
    );
    if findings.plan.steps.len() > 1 {
        let rounds = count_text(rounds, "round", "rounds");
        let _ =
            writeln!(text, "  about {seconds:.0} s by the table of handling times, in {rounds}");
    }
    if let Some(wanted) = &findings.plan.selection {
        let _ = writeln!(text, "to remove\n  {}", escape_line(wanted.describe(assembly)));
    }
    if !findings.plan.base.is_empty() {
        let _ = writeln!(text, "remaining\n  {}", names(&findings.plan.base));
    }
    if !findings.plan.remaining.is_empty() {
        let fixed = findings.plan.remaining.iter().all(|&part| assembly.parts()[part].is_fixed());
        let why = match (fixed, findings.plan.remaining.len()) {
            (false, _) => "",
            (true, 1) => ", because it is fixed",
            (true, _) => ", because they are fixed",
        };
        let _ = writeln!(text, "left{why}\n  {}", names(&findings.plan.remaining));
    }
    for stuck in &findings.plan.interlocked {
        let (reason, details) =
            (stuck.reason_sentence(findings.bodies), stuck.evidence_sentences(findings.bodies));
        let (reason, details) = (escape_line(reason), escape_line(details));
        let head = stuck.heading(findings.bodies);
        let _ = writeln!(text, "{head}\n  {}: {reason}\n    {details}", names(&stuck.parts));
    }
    for (k, attempt) in next_attempts(findings).iter().enumerate() {
        let head = if k == 0 { "to try\n" } else { "" };
        let [option, reason] = [&attempt.option, &attempt.reason].map(escape_line);
        let _ = writeln!(text, "{head}  {option}: {reason}");
    }
    for (name, map) in &findings.maps {
        match &map.cover {
            Ok(cover) => {
                let _ = writeln!(text, "map of {}: {}", escape_line(name), cover.record.outcome);
                directions::push_directions(&mut text, &cover.record);
            }
            Err(why) => {
                let _ = writeln!(
                    text,
                    "map of {}, sampled, because {}\n  {:.3} % of all directions are free, in {} regions; \
                     {} isolated free directions",
                    escape_line(name),
                    escape_line(why),
                    100.0 * map.free_share(),
                    map.regions.len(),
                    map.isolated.len()
                );
            }
        }
    }
    text
}

/// Returns the names of the parts that a stage removes.
fn removed_names(findings: &Analysis, stage: &Range<usize>) -> String {
    let (assembly, parts) = (findings.bodies.assembly(), &findings.plan.steps[stage.start].parts);
    if stage.len() == 1 && assembly.constraints().group_name(parts).is_none() {
        return name_list(&assembly.part_names(parts));
    }
    findings.plan.describe_stage(assembly, stage)
}

/// Number of names to which a longer list is shortened.
const MAX_NAMES: usize = 12;
/// Maximum number of notes of one kind that are listed one by one.
const MAX_EQUAL_NOTES: usize = 3;
/// Number of overlaps at the start that are listed.
const MAX_OVERLAPS: usize = 12;
/// Maximum number of overlaps at the start whose depth and volume are computed.
const MOST_EXAMINED: usize = 64;

/// Joins names. Of more than [`MAX_NAMES`] + 1 names only the first [`MAX_NAMES`] are listed, with the number of the
/// others.
fn name_list(names: &[&str]) -> String {
    match names.len().saturating_sub(MAX_NAMES) {
        0 | 1 => names.join(", "),
        more => format!("{} and {more} more", names[..MAX_NAMES].join(", ")),
    }
}

/// Appends a stage of the plan: steps that are one action.
fn push_stage(text: &mut String, findings: &Analysis, stage: &Range<usize>) {
    let assembly = findings.bodies.assembly();
    let names = |parts: &[usize]| escape_line(name_list(&assembly.part_names(parts)));
    let steps = &findings.plan.steps[stage.clone()];
    let step = &steps[0];
    let within =
        step.group_step.map_or(String::new(), |w| format!(", of the group of step {}", w + 1));
    let travel_text = |travel: f64, d: DVec3| match travel {
        0.0 => format!("away along {}", vector(d)),
        _ => format!("{} along {}", estimate(travel, 0.0), vector(d)),
    };
    let removed = findings.plan.describe_fasteners(assembly, stage);
    let removed = removed.unwrap_or_else(|| removed_names(findings, stage));
    let (numbers, removed) = (Plan::step_numbers(stage), escape_line(removed));
    let head = format!("  {numbers}. {removed}{within}: ");
    if let (Some(turn), [screwed, rest]) = (step.first_turn(), &step.path[..]) {
        let turns = match screwed.travel {
            0.0 => format!("turn by {:.2} degrees", 360.0 * turn.turns),
            travel => {
                format!("unscrew, {:.2} turns, {}", turn.turns.abs(), estimate(travel, 0.0))
            }
        };
        let _ = writeln!(text, "{head}{turns}, then {}", travel_text(rest.travel, rest.direction));
    } else if let [_] = &step.path[..] {
        let travel = match (findings.plan.stage_direction(stage), findings.plan.stage_travel(stage))
        {
            (Some(d), travel) => travel_text(travel, d),
            (None, 0.0) => "away, each in its own direction".into(),
            (None, travel) => format!("{} each in its own direction", estimate(travel, 0.0)),
        };
        let _ = writeln!(text, "{head}{travel}");
    } else {
        let _ = writeln!(text, "{head}in {} moves", step.path.len());
        for (back, leg) in
            step.path.iter().map(|l| ("", l)).chain(step.return_legs.iter().map(|l| ("back ", l)))
        {
            let turned = leg.turn.as_ref().map_or_else(String::new, |turn| {
                format!("unscrew, {:.2} turns, ", turn.turns.abs())
            });
            let _ = writeln!(
                text,
                "     {back}{}: {turned}{}",
                names(&leg.parts),
                travel_text(leg.travel, leg.direction)
            );
        }
    }
    for turns in findings.plan.describe_unscrewing(stage, Unscrewing::words) {
        let _ = writeln!(text, "     {}", escape_line(turns));
    }
    for tool in findings.plan.describe_tools(stage, |reach| reach.describe(assembly)) {
        let _ = writeln!(text, "     {}", escape_line(tool));
    }
    for ignored in steps.iter().filter_map(|step| step.describe_ignored(assembly)) {
        let _ = writeln!(text, "     {}", escape_line(ignored));
    }
    for open in steps.iter().flat_map(|step| step.describe_unsettled(assembly)) {
        let _ = writeln!(text, "     {}", escape_line(open));
    }
    for passed in findings.plan.describe_stage_contacts(assembly, stage) {
        let _ = writeln!(text, "     {}", escape_line(passed));
    }
    for step in steps {
        if let Some(turn) = step.first_turn() {
            let _ = writeln!(text, "     {}: {}", names(&step.parts), escape_line(turn.describe()));
        }
    }
    for reason in findings.plan.unproven_reasons(findings.bodies, stage, names) {
        let _ = writeln!(text, "     not proven, because {reason}");
    }
}

/// Appends overlaps at the start, and suggestions: the first overlaps, unless `all` are wanted.
fn push_overlaps(text: &mut String, findings: &Analysis, all: bool) {
    let remaining: Vec<_> = findings.start.remaining().collect();
    if !remaining.is_empty() {
        text.push_str(match findings.bodies.fit() {
            Fit::MinGap(_) => "nearer than that at the start\n",
            _ => "overlapping with this tolerance\n",
        });
    }
    // One more line than the number of those that are left out would be as long.
    let listed =
        if all || remaining.len() <= MAX_OVERLAPS + 1 { remaining.len() } else { MAX_OVERLAPS };
    for (k, o) in remaining[..listed].iter().enumerate() {
        let [a, b] = o.parts.map(|k| escape_line(findings.bodies.assembly().parts()[k].name()));
        let depth = match (o.depth, findings.bodies.fit()) {
            (None, _) => " by more than their size".into(),
            (Some(0.0), Fit::MinGap(_)) => String::new(),
            (Some(depth), Fit::MinGap(_)) => {
                format!(", which overlap by {}", length_up(depth))
            }
            (Some(depth), _) => format!(" by {}", length_up(depth)),
        };
        let _ = write!(text, "  {a}, {b}{depth}");
        if k < MOST_EXAMINED {
            let found = examine_overlap(findings.bodies, o, &AuditOptions::default());
            let finding = found
                .map_or_else(escape_line, |found| finding_text(findings.bodies.assembly(), &found));
            let _ = write!(text, ": {finding}");
        }
        text.push('\n');
    }
    if listed < remaining.len() {
        let more = remaining.len() - listed;
        let _ = writeln!(text, "  and {more} more pairs (--notes lists each)");
    }
    if remaining.is_empty() && !findings.suggestions.is_empty() {
        text.push_str("possible reasons\n");
    }
    for suggestion in
        suggest::describe_suggestions(findings.bodies.assembly(), &findings.suggestions)
    {
        let _ =
            writeln!(text, "  perhaps intended, which --auto assumes: {}", escape_line(suggestion));
    }
    let apart = matches!(findings.bodies.fit(), Fit::MinGap(_));
    if let Some(tolerance) =
        findings.start.suggested_tolerance.filter(|_| !remaining.is_empty() && !apart)
    {
        let _ = writeln!(
            text,
            "  try --tolerance {} or, for curved fits, the chord errors of both parts together",
            length_up(tolerance)
        );
    }
}
