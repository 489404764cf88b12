//! Prints the result of `assembly`, and writes the files of `-o`.

use std::fmt::Write as _;
use std::ops::Range;
use std::path::{Path, PathBuf};

use colltrans::glam::DVec3;
use colltrans_assembly::hints::hints;
use colltrans_assembly::plan::{Plan, and_or};
use colltrans_assembly::report::{facts, glb, html};
use colltrans_assembly::{Assembly, Findings, Fit};
use colltrans_assembly::{map, record, suggest};

use super::free::Leaving;
use crate::args::AssemblyArguments;
use crate::directions;
use crate::failure::{Failure, note, print, print_json};
use crate::inputs::refuse_overwriting;
use crate::numbers::counted;
use crate::outputs::{FileNames, Outputs};
use crate::terminal::{plain_json, shown};

pub(super) fn write(
    f: &Findings,
    free: &[Leaving],
    arguments: &AssemblyArguments,
) -> Result<(), Failure> {
    for text in f.bodies.assembly().notes() {
        note(text);
    }
    let mut json = facts::json(f);
    if !free.is_empty() {
        json["free"] = free.iter().map(Leaving::json).collect();
    }
    if let Some(folder) = &arguments.output {
        files(f, free, arguments, folder, &json)?;
    }
    if arguments.json {
        return print_json(&format!("{json}\n"));
    }
    let mut text = summary(f);
    for leaving in free {
        leaving.tell(&mut text);
    }
    print(&text)
}

fn files(
    f: &Findings,
    free: &[Leaving],
    arguments: &AssemblyArguments,
    folder: &Path,
    json: &serde_json::Value,
) -> Result<(), Failure> {
    std::fs::create_dir_all(folder).map_err(|e| Failure::output(folder.display(), &e))?;
    let mut outputs = Outputs::default();
    let mut put = |name: &str, bytes: &[u8]| outputs.write(folder.join(name), bytes);
    let source = arguments.source.canonicalize().unwrap_or_else(|_| arguments.source.clone());
    let title = source.file_stem().map_or("assembly".into(), |s| s.to_string_lossy().into_owned());
    put("report.html", html::page(f, &title).as_bytes())?;
    put("disassembly.glb", &glb::animation(f.bodies.assembly(), &f.plan))?;
    put("assembly.json", plain_json(&json.to_string()).as_bytes())?;
    put("matrix.csv", f.matrix.to_csv(f.bodies).as_bytes())?;
    let assembly = f.bodies.assembly();
    put("precedence.csv", f.plan.to_csv(assembly, &f.times).as_bytes())?;
    let ways = and_or(assembly, &f.matrix).to_string();
    put("precedence.json", plain_json(&ways).as_bytes())?;
    let names = map_names(f.maps.iter().map(|(name, _)| name));
    for ((name, map), [svg, png, json]) in f.maps.iter().zip(names) {
        let title = format!("Room of {name} in all directions");
        put(&svg, map::svg(map, &title).as_bytes())?;
        put(&png, &map::png(map, 1_200))?;
        put(&json, plain_json(&record::map(f.bodies, map).to_string()).as_bytes())?;
    }
    let names = free_names(free.iter().map(|leaving| &leaving.name));
    for (leaving, name) in free.iter().zip(names) {
        if let Some(proof) = &leaving.proof {
            put(&name, format!("{}\n", proof.to_json()).as_bytes())?;
        }
    }
    outputs.finish()
}

/// None of the files that will be written must take the place of one that is read.
pub(super) fn refuse_inputs(
    arguments: &AssemblyArguments,
    assembly: &Assembly,
) -> Result<(), Failure> {
    let Some(folder) = &arguments.output else { return Ok(()) };
    let files = assembly.files().iter().chain(&arguments.directions).chain(&arguments.times);
    let inputs: Vec<&Path> = files.map(PathBuf::as_path).collect();
    let fixed = [
        "report.html",
        "disassembly.glb",
        "assembly.json",
        "matrix.csv",
        "precedence.csv",
        "precedence.json",
    ];
    let maps = map_names(&arguments.map).into_iter().flatten();
    let all = maps.chain(free_names(&arguments.free));
    for name in fixed.into_iter().map(str::to_owned).chain(all) {
        refuse_overwriting(&folder.join(name), &inputs, "give another folder")?;
    }
    Ok(())
}

/// The files of each map.
fn map_names<'a>(maps: impl IntoIterator<Item = &'a String>) -> Vec<[String; 3]> {
    let mut names = FileNames::default();
    let files = |name: &String| {
        let name = names.of(name);
        ["svg", "png", "json"].map(|extension| format!("map-{name}.{extension}"))
    };
    maps.into_iter().map(files).collect()
}

/// The files of the proofs of free directions.
fn free_names<'a>(parts: impl IntoIterator<Item = &'a String>) -> Vec<String> {
    let mut names = FileNames::default();
    parts.into_iter().map(|name| format!("free-{}.json", names.of(name))).collect()
}

/// A few lines for people.
fn summary(f: &Findings) -> String {
    let assembly = f.bodies.assembly();
    let names = |parts: &[usize]| shown(listed(&assembly.names(parts)));
    let fit = match f.bodies.fit() {
        Fit::Tolerance(length) => format!("tolerance {length}"),
        Fit::Chords { largest, .. } => {
            format!("tolerance of each pair by its chord errors, {largest} at most")
        }
        Fit::Apart(length) => format!("{length} to keep apart"),
    };
    let mut text = format!("{}, {fit}\n", counted(assembly.parts().len(), "part", "parts"));
    for (k, p) in assembly.parts().iter().enumerate() {
        for defect in p.defects().iter().chain(&f.bodies.remark(k)) {
            let _ = writeln!(text, "  {}: {}", shown(p.name()), shown(defect));
        }
    }
    for hint in hints(f.bodies, &f.start) {
        let _ = writeln!(text, "  {}", shown(hint.words));
    }
    overlaps(&mut text, f);
    if !f.plan.steps.is_empty() {
        text.push_str("plan\n");
    }
    for stage in f.plan.stages() {
        tell(&mut text, f, &stage);
    }
    let (seconds, rounds) = (f.times.of(&f.plan).iter().sum::<f64>(), f.plan.rounds().len());
    if f.plan.steps.len() > 1 {
        let rounds = counted(rounds, "round", "rounds");
        let _ =
            writeln!(text, "  about {seconds:.0} s by the table of handling times, in {rounds}");
    }
    if let Some(wanted) = &f.plan.wanted {
        let _ = writeln!(text, "to take out\n  {}", shown(wanted.words(assembly)));
    }
    if !f.plan.last.is_empty() {
        let _ = writeln!(text, "what remains\n  {}", names(&f.plan.last));
    }
    if !f.plan.left.is_empty() {
        let fixed = f.plan.left.iter().all(|&part| assembly.parts()[part].fixed());
        let why = match (fixed, f.plan.left.len()) {
            (false, _) => "",
            (true, 1) => ", as it is fixed",
            (true, _) => ", as they are fixed",
        };
        let _ = writeln!(text, "left{why}\n  {}", names(&f.plan.left));
    }
    for stuck in &f.plan.stuck {
        let (reason, details) = (stuck.reason(f.bodies), stuck.details(f.bodies));
        let (reason, details) = (shown(reason), shown(details));
        let head = stuck.heading(f.bodies);
        let _ = writeln!(text, "{head}\n  {}: {reason}\n    {details}", names(&stuck.parts));
    }
    for (name, map) in &f.maps {
        match &map.cover {
            Ok(cover) => {
                let _ = writeln!(text, "map of {}: {}", shown(name), cover.record.outcome);
                directions::told(&mut text, &cover.record);
            }
            Err(why) => {
                let _ = writeln!(
                    text,
                    "map of {}, sampled, as {}\n  {:.3} % of all directions are free, in {} regions; \
                     {} isolated free directions",
                    shown(name),
                    shown(why),
                    100.0 * map.free_share(),
                    map.regions.len(),
                    map.isolated.len()
                );
            }
        }
    }
    text
}

/// What a stage takes away.
fn takes(f: &Findings, stage: &Range<usize>) -> String {
    let (assembly, parts) = (f.bodies.assembly(), &f.plan.steps[stage.start].parts);
    if stage.len() == 1 && assembly.constraints().name(parts).is_none() {
        return listed(&assembly.names(parts));
    }
    f.plan.takes(assembly, stage)
}

/// Names are listed up to so many.
const MOST_NAMES: usize = 12;

/// Names, of very many the first ones: all are in JSON.
fn listed(names: &[&str]) -> String {
    match names.len().saturating_sub(MOST_NAMES) {
        0 | 1 => names.join(", "),
        more => format!("{} and {more} more", names[..MOST_NAMES].join(", ")),
    }
}

/// Steps that are one for whoever does them.
fn tell(text: &mut String, f: &Findings, stage: &Range<usize>) {
    let assembly = f.bodies.assembly();
    let names = |parts: &[usize]| shown(listed(&assembly.names(parts)));
    let steps = &f.plan.steps[stage.clone()];
    let step = &steps[0];
    let within = step.within.map_or(String::new(), |w| format!(", of the group of step {}", w + 1));
    let way = |travel: f64, d: DVec3| match travel {
        0.0 => format!("away along {},{},{}", d.x, d.y, d.z),
        _ => format!("{travel} along {},{},{}", d.x, d.y, d.z),
    };
    let (numbers, takes) = (Plan::numbers(stage), shown(takes(f, stage)));
    let head = format!("  {numbers}. {takes}{within}: ");
    if let (Some(turn), [screwed, rest]) = (step.turn(), &step.path[..]) {
        let turns = match screwed.travel {
            0.0 => format!("turn by {:.2} degrees", 360.0 * turn.turns),
            way => format!("unscrew, {:.2} turns, {way}", turn.turns.abs()),
        };
        let _ = writeln!(text, "{head}{turns}, then {}", way(rest.travel, rest.direction));
    } else if let [_] = &step.path[..] {
        let told = match (f.plan.direction(stage), f.plan.travel(stage)) {
            (Some(d), travel) => way(travel, d),
            (None, 0.0) => "away, each along its own way".into(),
            (None, travel) => format!("{travel} each along its own way"),
        };
        let _ = writeln!(text, "{head}{told}");
    } else {
        let _ = writeln!(text, "{head}in {} moves", step.path.len());
        for (back, leg) in
            step.path.iter().map(|l| ("", l)).chain(step.back.iter().map(|l| ("back ", l)))
        {
            let _ = writeln!(
                text,
                "     {back}{}: {}",
                names(&leg.parts),
                way(leg.travel, leg.direction)
            );
        }
    }
    for ignored in steps.iter().filter_map(|step| step.ignores(assembly)) {
        let _ = writeln!(text, "     {}", shown(ignored));
    }
    for said in steps.iter().flat_map(|step| step.unsettled(assembly)) {
        let _ = writeln!(text, "     {}", shown(said));
    }
    for passed in f.plan.passed_words(assembly, stage) {
        let _ = writeln!(text, "     {}", shown(passed));
    }
    for step in steps {
        if let Some(turn) = step.turn() {
            let _ = writeln!(text, "     {}: {}", names(&step.parts), shown(turn.words()));
        }
    }
    let mut surfaces: Vec<usize> = steps.iter().flat_map(|s| s.surfaces.iter().copied()).collect();
    surfaces.sort_unstable();
    surfaces.dedup();
    if !surfaces.is_empty() {
        let _ = writeln!(text, "     rests on an open surface: {}", names(&surfaces));
    }
}

fn overlaps(text: &mut String, f: &Findings) {
    let remaining: Vec<_> = f.start.remaining().collect();
    if !remaining.is_empty() {
        text.push_str(match f.bodies.fit() {
            Fit::Apart(_) => "nearer than that where they stand\n",
            _ => "overlapping with this tolerance\n",
        });
    }
    for o in &remaining {
        let [a, b] = o.parts.map(|k| shown(f.bodies.assembly().parts()[k].name()));
        let depth = match (o.depth, f.bodies.fit()) {
            (None, _) => " by more than their size".into(),
            (Some(0.0), Fit::Apart(_)) => String::new(),
            (Some(depth), Fit::Apart(_)) => format!(", which overlap by {depth}"),
            (Some(depth), _) => format!(" by {depth}"),
        };
        let _ = writeln!(text, "  {a}, {b}{depth}");
    }
    if remaining.is_empty() && !f.suggestions.is_empty() {
        text.push_str("what may hold\n");
    }
    for said in suggest::told(f.bodies.assembly(), &f.suggestions) {
        let _ =
            writeln!(text, "  perhaps on purpose, which --auto takes for granted: {}", shown(said));
    }
    let apart = matches!(f.bodies.fit(), Fit::Apart(_));
    if let Some(tolerance) = f.start.suggested.filter(|_| !remaining.is_empty() && !apart) {
        let _ = writeln!(
            text,
            "  try --tolerance {tolerance} or, for curved fits, the chord errors of both parts together"
        );
    }
}
