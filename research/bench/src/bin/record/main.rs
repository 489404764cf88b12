//! `record`: from the dated runs in `docs/measurements/` to what people read.
//!
//! The runs are the JSON files that `table`, `paper`, `coherence`, `bulk` and `solids` write, and the text that
//! `campaign` prints, named `YYYY-MM-DD-WHAT.json` or `.txt`. Of each kind the newest one goes into
//! `docs/measurements.md`, the picture `docs/speed.svg` and the table of the README, so that no
//! number there is typed by hand. The claims of the laboratory (`claims.json` of two runs with
//! different seeds, `laboratory` and `laboratory-again`) go into `docs/laboratory.md`.

mod algorithm;
mod bulk;
mod laboratory;

use std::collections::BTreeMap;
use std::error::Error;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Parser;
use colltrans_lab::claims::CLAIMS;
use colltrans_lab::draw::draw;
use colltrans_lab::finding::{Axis, Figure, Point, Series};
use serde_json::Value;

/// Makes docs/measurements.md, docs/speed.svg, the README's table and the claims in
/// docs/laboratory.md from the runs in docs/measurements
#[derive(Debug, Parser)]
struct Command {
    /// The root of the repository
    #[arg(default_value = ".")]
    root: PathBuf,
    /// Write nothing; fail if something would change
    #[arg(long)]
    check: bool,
}

fn main() -> ExitCode {
    let command = Command::parse();
    match run(&command) {
        Ok(changed) if command.check && !changed.is_empty() => {
            eprintln!("error: not up to date with docs/measurements: {}", changed.join(", "));
            ExitCode::FAILURE
        }
        Ok(changed) => {
            println!(
                "changed: {}",
                if changed.is_empty() { "nothing".into() } else { changed.join(", ") }
            );
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

type Failure = Box<dyn Error>;

/// The newest run of each kind, by the kind: the file's name without date and ending.
fn newest(folder: &Path) -> Result<BTreeMap<String, (String, String)>, Failure> {
    let mut runs = BTreeMap::new();
    let mut names: Vec<String> = fs::read_dir(folder)
        .map_err(|error| format!("{}: {error}", folder.display()))?
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .collect();
    names.sort();
    for name in names {
        let Some((stem, _)) = name.rsplit_once('.') else { continue };
        // `YYYY-MM-DD-` and the kind; later names replace earlier ones.
        if let Some(kind) = stem.get(11..) {
            let text = fs::read_to_string(folder.join(&name))?;
            runs.insert(kind.to_owned(), (name, text));
        }
    }
    Ok(runs)
}

/// Writes what has changed, or only says so.
fn run(command: &Command) -> Result<Vec<String>, Failure> {
    let docs = command.root.join("docs");
    let runs = newest(&docs.join("measurements"))?;
    let parsed = |kind: &str| -> Result<Option<Value>, Failure> {
        let run = runs.get(kind);
        Ok(run
            .map(|(name, text)| serde_json::from_str(text).map_err(|e| format!("{name}: {e}")))
            .transpose()?)
    };
    let table = parsed("table")?.ok_or("docs/measurements has no run of `table`")?;
    let mut page = String::from(
        "# Measurements\n\nMade by `cargo run --release -p colltrans-bench --bin record` from the runs \
         in [measurements/](measurements/); no number here is typed by hand. Times are of shared \
         virtual machines: ratios within one run hold better than times.\n",
    );
    general(&mut page, &table)?;
    ties(&mut page, &table)?;
    if let Some(run) = parsed("paper")? {
        algorithm::write(&mut page, &run)?;
    }
    if let Some(run) = parsed("coherence")? {
        coherence(&mut page, &run)?;
    }
    if let Some(run) = parsed("bulk")? {
        bulk::write(&mut page, &run)?;
    }
    if let Some(run) = parsed("solids")? {
        solids(&mut page, &run)?;
    }
    building(&mut page, &table)?;
    for (kind, (name, text)) in &runs {
        if Path::new(name).extension().is_some_and(|ending| ending == "txt") {
            write!(
                page,
                "\n## {}\n\n[{name}](measurements/{name})\n\n```text\n{}\n```\n",
                title(kind),
                text.trim_end()
            )?;
        }
    }
    let old = |name: &str| -> Result<String, Failure> {
        Ok(fs::read_to_string(command.root.join(name)).map_err(|e| format!("{name}: {e}"))?)
    };
    let mut files = vec![
        ("docs/measurements.md", page),
        ("docs/speed.svg", draw(&speed(&table)).map_err(|e| format!("speed.svg: {e}"))?.svg),
        ("README.md", between("speed", &old("README.md")?, &small_table(&table)?)?),
    ];
    if let [Some(run), Some(again)] = [parsed("laboratory")?, parsed("laboratory-again")?] {
        let name = "docs/laboratory.md";
        files.push((
            name,
            between("claims", &old(name)?, &laboratory::claims(&run, &again, CLAIMS.len())?)?,
        ));
    }
    let mut changed = Vec::new();
    for (name, text) in files {
        let path = command.root.join(name);
        if fs::read_to_string(&path).ok().as_deref() != Some(text.as_str()) {
            changed.push(name.to_owned());
            if !command.check {
                fs::write(&path, text).map_err(|error| format!("{name}: {error}"))?;
            }
        }
    }
    Ok(changed)
}

fn title(kind: &str) -> String {
    let mut letters = kind.replace('-', " ").chars().collect::<Vec<_>>();
    if let Some(first) = letters.first_mut() {
        first.make_ascii_uppercase();
    }
    letters.into_iter().collect()
}

fn rows(run: &Value) -> &[Value] {
    run["rows"].as_array().map_or(&[], Vec::as_slice)
}

fn text<'v>(row: &'v Value, key: &str) -> &'v str {
    row[key].as_str().unwrap_or("?")
}

fn number(row: &Value, path: &[&str]) -> f64 {
    path.iter().fold(row, |value, key| &value[*key]).as_f64().unwrap_or(f64::NAN)
}

/// A number for people: no digits that a noisy machine does not know.
fn rounded(x: f64) -> String {
    match x {
        _ if x.is_nan() => "-".into(),
        _ if x < 9.95 => format!("{x:.2}"),
        _ if x < 99.5 => format!("{x:.1}"),
        _ => thousands(x),
    }
}

fn thousands(x: f64) -> String {
    let digits = format!("{x:.0}");
    let mut grouped = String::new();
    for (k, digit) in digits.chars().enumerate() {
        if k > 0 && (digits.len() - k).is_multiple_of(3) {
            grouped.push(',');
        }
        grouped.push(digit);
    }
    grouped
}

fn provenance(page: &mut String, run: &Value) -> Result<(), Failure> {
    let machine = &run["machine"];
    writeln!(
        page,
        "\n{}, {} with {} cores, {}; {}.\n\n```sh\n{}\n```\n",
        text(run, "date"),
        text(machine, "cpu"),
        text(machine, "cores"),
        text(machine, "system"),
        text(run, "versions"),
        cargo_command(run),
    )?;
    Ok(())
}

/// The command as one types it in the repository, without folders of the machine it ran on.
fn cargo_command(run: &Value) -> String {
    let mut words = text(run, "command").split_whitespace();
    let program = words.next().unwrap_or_default();
    let mut line = format!("cargo run --release -p colltrans-bench --bin {program} --");
    for word in words {
        line.push(' ');
        line.push_str(word.rsplit('/').next().unwrap_or(word));
    }
    line
}

/// The paper's algorithm, by key and name: all of it, or, in runs that have no more, where it starts roughly.
fn paper(run: &Value) -> (&'static str, &'static str) {
    let is_whole = rows(run).iter().any(|row| row["cta"].is_object());
    if is_whole { ("cta", "`cta`") } else { ("rough", "`cta`, rough") }
}

fn is_tied(row: &Value) -> bool {
    !["colliding", "separated"].contains(&text(row, "meeting"))
}

fn general(page: &mut String, run: &Value) -> Result<(), Failure> {
    page.push_str("\n## Casts from scratch, general position\n");
    provenance(page, run)?;
    let (paper, name) = paper(run);
    writeln!(
        page,
        "Each query timed alone; medians (99th percentiles) in ns. *x* is the median of parry3d-f64's \
         `cast_shapes` over that of `auto`, on the same settings in the same run; *planar* the \
         planar problems that {name} solves, on average.\n\n\
         | shape | vertices | | {name} | `portal` | `auto` | parry | x | planar |\n\
         |---|---:|---|---:|---:|---:|---:|---:|---:|"
    )?;
    for row in rows(run).iter().filter(|row| !is_tied(row)) {
        let pair = |who: &str| {
            let [median, p99] =
                ["median_ns", "p99_ns"].map(|key| thousands(number(row, &[who, key])));
            format!("{median} ({p99})")
        };
        writeln!(
            page,
            "| {} | {} | {} | {} | {} | {} | {} | {} | {:.1} |",
            text(row, "shape"),
            thousands(number(row, &["vertices"])),
            text(row, "meeting"),
            pair(paper),
            pair("portal"),
            pair("auto"),
            pair("parry"),
            rounded(number(row, &["parry_over", "auto", "median"])),
            number(row, &[paper, "planar_problems"]),
        )?;
    }
    let sum = |key: &dyn Fn(&Value) -> f64| rows(run).iter().map(key).sum::<f64>();
    let failures = sum(&|row| {
        [paper, "portal", "auto"].iter().map(|who| number(row, &[who, "failures"])).sum()
    });
    let differ = sum(&|row| number(row, &["parry_disagreements"]));
    writeln!(
        page,
        "\nQueries without an answer: {failures}. Answers that differ from parry's by more than 1e-4, \
         ties included: {differ}."
    )?;
    Ok(())
}

fn ties(page: &mut String, run: &Value) -> Result<(), Failure> {
    let tied: Vec<&Value> = rows(run).iter().filter(|row| is_tied(row)).collect();
    if tied.is_empty() {
        return Ok(());
    }
    page.push_str(
        "\n## Casts from scratch, ties\n\nThe same run. Means without the slowest hundredth, in ns: \
         ties are the case in which the mean tells. *x* is parry's mean over ours, *own* our mean \
         over our mean for the same bodies in general position; *cold*: 4 MiB of other data before each query.\n\n\
         | tie | placement | `auto` | 99 % | parry | x | own | supports |\n\
         |---|---|---:|---:|---:|---:|---:|---:|\n",
    );
    for row in &tied {
        let general = tied.iter().find(|other| {
            text(other, "shape") == text(row, "shape")
                && text(other, "meeting") == "general position"
        });
        let own = general.map_or(f64::NAN, |g| {
            number(row, &["auto", "mean_ns"]) / number(g, &["auto", "mean_ns"])
        });
        writeln!(
            page,
            "| {} | {} | {} | {} | {} | {} | {} | {:.1} |",
            text(row, "shape"),
            text(row, "meeting"),
            thousands(number(row, &["auto", "mean_ns"])),
            thousands(number(row, &["auto", "p99_ns"])),
            thousands(number(row, &["parry", "mean_ns"])),
            rounded(number(row, &["parry_over", "auto", "mean"])),
            rounded(own),
            number(row, &["auto", "supports"]),
        )?;
    }
    Ok(())
}

fn coherence(page: &mut String, run: &Value) -> Result<(), Failure> {
    page.push_str("\n## Coherence\n");
    provenance(page, run)?;
    let is_whole = rows(run).iter().any(|row| row["solvers"]["cta"].is_object());
    let (paper, until) =
        if is_whole { ("cta", "the exit test") } else { ("cta 1%", "a gap of 1 %") };
    writeln!(
        page,
        "Queries of sequences of 100 configurations, each timed alone. *tracker* and *scratch*: \
         medians in ns on the same sequences; *ratio* that of medians (of means). *of parry* is the \
         tracker's mean over the mean of parry's casts of bodies of 8 vertices in the same run. \
         *planar*: planar problems of the paper's algorithm from the centre of the levels to {until}, \
         from scratch and with region focus alone.\n\n\
         | vertices | sequence | scratch | tracker | ratio | of parry | planar | with focus |\n\
         |---:|---|---:|---:|---:|---:|---:|---:|"
    )?;
    for row in rows(run) {
        let of = |who: &str, key: &str| number(row, &["solvers", who, key]);
        let ratio = |key: &str| of("tracker", key) / of("scratch", key);
        writeln!(
            page,
            "| {} | {} | {} | {} | {:.2} ({:.2}) | {:.2} | {:.1} | {:.2} |",
            thousands(number(row, &["vertices"])),
            text(row, "sequences"),
            thousands(of("scratch", "median_ns")),
            thousands(of("tracker", "median_ns")),
            ratio("median_ns"),
            ratio("mean_ns"),
            of("tracker", "mean_ns") / number(row, &["parry_8", "mean_ns"]),
            of(paper, "planar_problems"),
            of(&format!("{paper} region"), "planar_problems"),
        )?;
    }
    let differ: f64 = rows(run).iter().map(|row| number(row, &["differences"])).sum();
    writeln!(
        page,
        "\nAnswers that differ from those from scratch beyond both tolerances: {differ}."
    )?;
    Ok(())
}

fn solids(page: &mut String, run: &Value) -> Result<(), Failure> {
    page.push_str("\n## Solids that are not convex\n");
    provenance(page, run)?;
    page.push_str(
        "Times in µs. *x* is parry3d-f64's `cast_shapes` of two `TriMesh` over ours, on the \
         same settings in the same run, by medians (by means): the least first, and those without \
         first of all. *flat*: a plate on another, as its name says.\n\n\
         | what | facets | median | mean | parry, median | x |\n\
         |---|---:|---:|---:|---:|---:|\n",
    );
    let micros = |row: &Value, key: &str| rounded(number(row, &[key]) / 1e3);
    let ratio_of = |row: &Value| row["ratio_of_medians"].as_f64().unwrap_or(0.0);
    let mut sorted: Vec<&Value> = rows(run).iter().collect();
    sorted.sort_by(|a, b| ratio_of(a).total_cmp(&ratio_of(b)));
    for row in sorted {
        let group = text(row, "group");
        let name = if group == "pairs" {
            text(row, "name").into()
        } else {
            format!("{group}: {}", text(row, "name"))
        };
        let is_pair = row["ratio_of_medians"].is_number();
        let ratio = || {
            format!(
                "{} ({})",
                rounded(number(row, &["ratio_of_medians"])),
                rounded(number(row, &["ratio"]))
            )
        };
        writeln!(
            page,
            "| {} | {} | {} | {} | {} | {} |",
            name.trim_end_matches(": ?"),
            thousands(number(row, &["facets"])),
            micros(row, "median_ns"),
            micros(row, "mean_ns"),
            micros(row, "parry_median_ns"),
            if is_pair { ratio() } else { "-".into() },
        )?;
    }
    let differ: f64 = rows(run).iter().filter_map(|row| row["answers_apart"].as_f64()).sum();
    writeln!(page, "\nAnswers that differ from parry's: {differ}.")?;
    if rows(run).iter().any(|row| text(row, "start") == "near") {
        page.push_str(
            "\n*Near*: settings that meet, started 0.02 times the sum of the radii before. *Near miss*: such \
             settings moved aside until they miss, by at most 0.01 times the sum. *Touching*: put \
             forward until they meet, and a millionth of the sum more. All others: 1.05 times it before each \
             other, and up to 0.7 times it aside.\n",
        );
    }
    Ok(())
}

fn building(page: &mut String, run: &Value) -> Result<(), Failure> {
    page.push_str(
        "\n## Memory and building\n\nOf the run of casts from scratch: everything a polyhedron \
         carries, the sections of `cta` included; built from points or faces, drawing them and making \
         the sections included. The program `memory` tells what sections take.\n\n\
         | shape | vertices | bytes a vertex | ms |\n|---|---:|---:|---:|\n",
    );
    for row in rows(run).iter().filter(|row| text(row, "meeting") == "colliding") {
        writeln!(
            page,
            "| {} | {} | {:.0} | {} |",
            text(row, "shape"),
            thousands(number(row, &["vertices"])),
            number(row, &["bytes_per_vertex"]),
            rounded(number(row, &["build_ms"])),
        )?;
    }
    Ok(())
}

/// Median times of colliding ellipsoids against the number of vertices.
fn speed(run: &Value) -> Figure {
    let of = |who: &str, name: &str| Series {
        name: name.into(),
        points: rows(run)
            .iter()
            .filter(|row| text(row, "shape") == "ellipsoid" && text(row, "meeting") == "colliding")
            .map(|row| {
                let y = number(row, &[who, "median_ns"]) / 1e3;
                let count = number(row, &["settings"]) as usize;
                Point { x: number(row, &["vertices"]), y, low: y, high: y, count }
            })
            .collect(),
    };
    let axis = |label: &str| Axis { label: label.into(), log: true };
    Figure {
        id: "speed".into(),
        title: "A cast of two ellipsoids that collide, from scratch: median".into(),
        x: axis("vertices of each body"),
        y: axis("time, µs"),
        series: vec![
            of("auto", "colltrans"),
            of(paper(run).0, "colltrans, by planar sections"),
            of("parry", "parry3d-f64"),
        ],
        references: Vec::new(),
    }
}

/// Rows of the README's table: shape, and the number of vertices asked for (0: tied).
const SMALL: [(&str, u64, &str); 9] = [
    ("ellipsoid", 8, "colliding"),
    ("ellipsoid", 128, "colliding"),
    ("ellipsoid", 2_000, "colliding"),
    ("ellipsoid", 200_000, "colliding"),
    ("ellipsoid", 200_000, "separated"),
    ("needle 100:1", 2_000, "colliding"),
    ("box", 8, "colliding"),
    ("upright boxes", 0, "identity"),
    ("cubes face on face", 0, "identity"),
];

fn small_table(run: &Value) -> Result<String, Failure> {
    let mut table = format!(
        "Medians in ns, {} ({}, rustc's release profile); *x* is parry's over ours.\n\n\
         | bodies | vertices | | colltrans | parry3d-f64 | x |\n|---|---:|---|---:|---:|---:|\n",
        text(run, "date").get(..10).unwrap_or("?"),
        text(&run["machine"], "cpu"),
    );
    for (shape, asked, meeting) in SMALL {
        let row = rows(run).iter().find(|row| {
            text(row, "shape") == shape
                && row["vertices_asked"].as_u64() == Some(asked)
                && text(row, "meeting") == meeting
        });
        let row =
            row.ok_or_else(|| format!("the run of `table` has no row {shape} {asked} {meeting}"))?;
        writeln!(
            table,
            "| {shape} | {} | {meeting} | {} | {} | {} |",
            thousands(number(row, &["vertices"])),
            thousands(number(row, &["auto", "median_ns"])),
            thousands(number(row, &["parry", "median_ns"])),
            rounded(number(row, &["parry_over", "auto", "median"])),
        )?;
    }
    Ok(table)
}

/// A page with other text between the markers `NAME: begin` and `NAME: end`.
fn between(name: &str, page: &str, text: &str) -> Result<String, Failure> {
    let [begin, end] = ["begin", "end"].map(|edge| format!("<!-- {name}: {edge} -->"));
    let missing = |marker: &str| format!("the marker {marker} is missing");
    let (before, rest) = page.split_once(&begin).ok_or_else(|| missing(&begin))?;
    let (_, after) = rest.split_once(&end).ok_or_else(|| missing(&end))?;
    Ok(format!("{before}{begin}\n{text}{end}{after}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_for_people() {
        assert_eq!(thousands(1_234_567.0), "1,234,567");
        assert_eq!(thousands(999.4), "999");
        assert_eq!([0.333, 12.34, 345.6].map(rounded), ["0.33", "12.3", "346"]);
    }

    #[test]
    fn text_is_replaced_between_its_markers() {
        let page = |text: &str| format!("a\n<!-- x: begin -->\n{text}<!-- x: end -->\nb\n");
        assert_eq!(between("x", &page("old\n"), "new\n").unwrap(), page("new\n"));
        assert!(between("y", &page("old\n"), "new").is_err());
    }

    #[test]
    fn pages_are_made_of_the_runs_beside_them() {
        let root = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
        let changed = run(&Command { root, check: true }).unwrap();
        assert!(changed.is_empty(), "not up to date with docs/measurements: {changed:?}");
    }

    #[test]
    fn commands_name_no_folders() {
        let run = serde_json::json!({ "command": "table --quick --json /elsewhere/t.json" });
        let line = cargo_command(&run);
        assert_eq!(
            line,
            "cargo run --release -p colltrans-bench --bin table -- --quick --json t.json"
        );
    }
}
