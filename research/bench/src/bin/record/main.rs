//! `record`: writes pages, pictures and tables from the dated runs in `docs/measurements/`.
//!
//! The runs are the JSON files of `table`, `paper`, `coherence`, `bulk` and `solids`, and the output of
//! `campaign`, named `YYYY-MM-DD-WHAT.json` or `.txt`. The newest run of each kind goes into
//! `docs/measurements.md`, the picture `docs/speed.svg` and the table of the README. No number there is typed
//! by hand. The claims of the laboratory go into `docs/laboratory.md`. They come from `claims.json` of two runs
//! with different seeds, `laboratory` and `laboratory-again`.

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
use colltrans_bench::harness::markdown_table;
use colltrans_lab::claims::CLAIMS;
use colltrans_lab::draw::draw;
use colltrans_lab::finding::{Axis, Figure, Point, Series};
use serde_json::Value;

/// Writes docs/measurements.md, docs/speed.svg, the README's table and the claims in docs/laboratory.md from
/// the runs in docs/measurements
#[derive(Debug, Parser)]
struct Command {
    /// Root of the repository
    #[arg(default_value = ".")]
    root: PathBuf,
    /// Write nothing; fail if a file would change
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

/// Formats a section of the page from a run.
type Section = fn(&Value) -> String;

/// Returns the newest run of each kind. The kind is the file's name without date and extension.
fn newest_runs(folder: &Path) -> Result<BTreeMap<String, (String, String)>, Failure> {
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

/// Writes the changed files, or only lists them.
fn run(command: &Command) -> Result<Vec<String>, Failure> {
    let docs = command.root.join("docs");
    let runs = newest_runs(&docs.join("measurements"))?;
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
    page += &general(&table);
    page += &ties(&table);
    let sections: [(&str, Section); 4] = [
        ("paper", algorithm::section),
        ("coherence", coherence),
        ("bulk", bulk::section),
        ("solids", solids),
    ];
    for (kind, section) in sections {
        page += &parsed(kind)?.as_ref().map_or_else(String::new, section);
    }
    page += &building(&table);
    for (kind, (name, text)) in &runs {
        if Path::new(name).extension().is_some_and(|ending| ending == "txt") {
            write!(
                page,
                "\n## {}\n\n[{name}](measurements/{name})\n\n```text\n{}\n```\n",
                section_title(kind),
                text.trim_end()
            )?;
        }
    }
    let old = |name: &str| -> Result<String, Failure> {
        Ok(fs::read_to_string(command.root.join(name)).map_err(|e| format!("{name}: {e}"))?)
    };
    let mut files = vec![
        ("docs/measurements.md", page),
        ("docs/speed.svg", draw(&speed_figure(&table)).map_err(|e| format!("speed.svg: {e}"))?.svg),
        ("README.md", replace_between("speed", &old("README.md")?, &small_table(&table)?)?),
    ];
    if let [Some(run), Some(again)] = [parsed("laboratory")?, parsed("laboratory-again")?] {
        let name = "docs/laboratory.md";
        files.push((
            name,
            replace_between(
                "claims",
                &old(name)?,
                &laboratory::claims(&run, &again, CLAIMS.len())?,
            )?,
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

/// Returns the title of a kind.
fn section_title(kind: &str) -> String {
    let mut letters = kind.replace('-', " ").chars().collect::<Vec<_>>();
    if let Some(first) = letters.first_mut() {
        first.make_ascii_uppercase();
    }
    letters.into_iter().collect()
}

/// Returns the rows of a run.
fn rows(run: &Value) -> &[Value] {
    run["rows"].as_array().map_or(&[], Vec::as_slice)
}

/// Returns a text of a row; `?` if it is missing.
fn string<'v>(row: &'v Value, key: &str) -> &'v str {
    row[key].as_str().unwrap_or("?")
}

/// Returns the figure at a JSON pointer without its first slash; NaN if there is none.
fn number(row: &Value, path: &str) -> f64 {
    row.pointer(&format!("/{path}")).and_then(Value::as_f64).unwrap_or(f64::NAN)
}

/// Returns the sum of the figures at these pointers in all rows.
fn sum(run: &Value, paths: &[String]) -> f64 {
    let figures = rows(run).iter().flat_map(|row| paths.iter().map(|path| number(row, path)));
    figures.filter(|figure| !figure.is_nan()).sum()
}

/// Formats the provenance of a run.
fn provenance(run: &Value) -> String {
    let machine = &run["machine"];
    format!(
        "\n{}, {} with {} cores, {}; {}.\n\n```sh\n{}\n```\n\n",
        string(run, "date"),
        string(machine, "cpu"),
        string(machine, "cores"),
        string(machine, "system"),
        string(run, "versions"),
        cargo_command(run),
    )
}

/// Formats the command as typed in the repository, without folders of the original machine.
fn cargo_command(run: &Value) -> String {
    let mut words = string(run, "command").split_whitespace();
    let program = words.next().unwrap_or_default();
    let mut line = format!("cargo run --release -p colltrans-bench --bin {program} --");
    for word in words {
        line.push(' ');
        line.push_str(word.rsplit('/').next().unwrap_or(word));
    }
    line
}

/// Returns the key and the name of the paper's algorithm: the whole algorithm, or, in older runs, its rough
/// start.
fn paper(run: &Value) -> (&'static str, &'static str) {
    let is_whole = rows(run).iter().any(|row| row["cta"].is_object());
    if is_whole { ("cta", "`cta`") } else { ("rough", "`cta`, rough") }
}

/// Whether a row has tied settings.
fn is_tied(row: &Value) -> bool {
    !["colliding", "separated"].contains(&string(row, "meeting"))
}

/// Formats the section on general positions.
fn general(run: &Value) -> String {
    let (paper, name) = paper(run);
    let columns = format!(
        "shape:<; vertices:,; :<=meeting; {name}:,={paper}/median_ns (,={paper}/p99_ns);
        `portal`:,=portal/median_ns (,=portal/p99_ns); `auto`:,=auto/median_ns (,=auto/p99_ns);
        parry:,=parry/median_ns (,=parry/p99_ns); x:~=parry_over/auto/median; planar:>.1={paper}/planar_problems"
    );
    let failures = sum(run, &[paper, "portal", "auto"].map(|who| format!("{who}/failures")));
    let differ = sum(run, &["parry_disagreements".into()]);
    format!(
        "\n## Casts from scratch, general position\n{}Each query timed alone; medians (99th percentiles) in ns. *x* is the median of parry3d-f64's \
         `cast_shapes` over that of `auto`, on the same settings in the same run; *planar* the \
         planar problems that {name} solves, on average.\n\n{}\n\
         Queries without an answer: {failures}. Answers that differ from parry's by more than 1e-4, \
         ties included: {differ}.\n",
        provenance(run),
        markdown_table(&columns, rows(run).iter().filter(|row| !is_tied(row))),
    )
}

/// Formats the section on ties.
fn ties(run: &Value) -> String {
    let mut tied: Vec<Value> = rows(run).iter().filter(|row| is_tied(row)).cloned().collect();
    if tied.is_empty() {
        return String::new();
    }
    let general: BTreeMap<String, Value> = tied
        .iter()
        .filter(|row| string(row, "meeting") == "general position")
        .map(|row| (string(row, "shape").into(), row["auto"]["mean_ns"].clone()))
        .collect();
    for row in &mut tied {
        row["general"] = general.get(string(row, "shape")).cloned().unwrap_or_default();
    }
    let columns = "tie:<=shape; placement:<=meeting; `auto`:,=auto/mean_ns; 99 %:,=auto/p99_ns; parry:,=parry/mean_ns;
        x:~=parry_over/auto/mean; own:~=auto/mean_ns ÷ general; supports:>.1=auto/supports";
    format!(
        "\n## Casts from scratch, ties\n\nThe same run. Means without the slowest hundredth, in ns: \
         ties are the case in which the mean tells. *x* is parry's mean over ours, *own* our mean \
         over our mean for the same bodies in general position; *cold*: 4 MiB of other data before each query.\n\n{}",
        markdown_table(columns, &tied),
    )
}

/// Formats the section on coherence.
fn coherence(run: &Value) -> String {
    let is_whole = rows(run).iter().any(|row| row["solvers"]["cta"].is_object());
    let (paper, until) =
        if is_whole { ("cta", "the exit test") } else { ("cta 1%", "a gap of 1 %") };
    let columns = format!(
        "vertices:,; sequence:<=sequences; scratch:,=solvers/scratch/median_ns; tracker:,=solvers/tracker/median_ns;
        ratio:>.2=solvers/tracker/median_ns ÷ solvers/scratch/median_ns \
        (>.2=solvers/tracker/mean_ns ÷ solvers/scratch/mean_ns);
        of parry:>.2=solvers/tracker/mean_ns ÷ parry_8/mean_ns; planar:>.1=solvers/{paper}/planar_problems;
        with focus:>.2=solvers/{paper} region/planar_problems"
    );
    format!(
        "\n## Coherence\n{}Queries of sequences of 100 configurations, each timed alone. *tracker* and *scratch*: \
         medians in ns on the same sequences; *ratio* that of medians (of means). *of parry* is the \
         tracker's mean over the mean of parry's casts of bodies of 8 vertices in the same run. \
         *planar*: planar problems of the paper's algorithm from the centre of the levels to {until}, \
         from scratch and with region focus alone.\n\n{}\n\
         Answers that differ from those from scratch beyond both tolerances: {}.\n",
        provenance(run),
        markdown_table(&columns, rows(run)),
        sum(run, &["differences".into()]),
    )
}

/// Formats the section on solids.
fn solids(run: &Value) -> String {
    let ratio_of = |row: &Value| row["ratio_of_medians"].as_f64().unwrap_or(0.0);
    let mut sorted: Vec<Value> = rows(run).to_vec();
    sorted.sort_by(|a, b| ratio_of(a).total_cmp(&ratio_of(b)));
    for row in &mut sorted {
        let (group, name) = (string(row, "group"), string(row, "name"));
        if group != "pairs" {
            row["name"] = format!("{group}: {name}").trim_end_matches(": ?").into();
        }
    }
    let columns = "what:<=name; facets:,; median:~=median_ns ÷ 1e3; mean:~=mean_ns ÷ 1e3;
        parry, median:~=parry_median_ns ÷ 1e3; x:~=ratio_of_medians (~=ratio)";
    let starts = "\n*Near*: settings that meet, started 0.02 times the sum of the radii before. *Near miss*: such \
         settings moved aside until they miss, by at most 0.01 times the sum. *Touching*: put \
         forward until they meet, and a millionth of the sum more. All others: 1.05 times it before each \
         other, and up to 0.7 times it aside.\n";
    let has_starts = rows(run).iter().any(|row| string(row, "start") == "near");
    format!(
        "\n## Solids that are not convex\n{}Times in µs. *x* is parry3d-f64's `cast_shapes` of two `TriMesh` over ours, on the \
         same settings in the same run, by medians (by means): the least first, and those without \
         first of all. *flat*: a plate on another, as its name says.\n\n{}\n\
         Answers that differ from parry's: {}.\n{}",
        provenance(run),
        markdown_table(columns, &sorted),
        sum(run, &["answers_apart".into()]),
        if has_starts { starts } else { "" },
    )
}

/// Formats the section on building.
fn building(run: &Value) -> String {
    let columns = "shape:<; vertices:,; bytes a vertex:>.0=bytes_per_vertex; ms:~=build_ms";
    format!(
        "\n## Memory and building\n\nOf the run of casts from scratch: everything a polyhedron \
         carries, the sections of `cta` included; built from points or faces, drawing them and making \
         the sections included. The program `memory` tells what sections take.\n\n{}",
        markdown_table(
            columns,
            rows(run).iter().filter(|row| string(row, "meeting") == "colliding")
        ),
    )
}

/// Draws the median times of colliding ellipsoids against the number of vertices.
fn speed_figure(run: &Value) -> Figure {
    let of = |who: &str, name: &str| Series {
        name: name.into(),
        points: rows(run)
            .iter()
            .filter(|row| {
                string(row, "shape") == "ellipsoid" && string(row, "meeting") == "colliding"
            })
            .map(|row| {
                let y = number(row, &format!("{who}/median_ns")) / 1e3;
                let count = number(row, "settings") as usize;
                Point { x: number(row, "vertices"), y, low: y, high: y, count }
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

/// Rows of the README's table: shape, and the number of vertices (0 for ties).
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

/// Formats the README's table.
fn small_table(run: &Value) -> Result<String, Failure> {
    let row = |(shape, asked, meeting): (&str, u64, &str)| {
        let mut of_shape = rows(run).iter().filter(|row| string(row, "shape") == shape);
        let row = of_shape
            .find(|row| row["vertices_asked"] == asked && string(row, "meeting") == meeting);
        row.ok_or_else(|| format!("the run of `table` has no row {shape} {asked} {meeting}"))
    };
    let columns = "bodies:<=shape; vertices:,; :<=meeting; colltrans:,=auto/median_ns; parry3d-f64:,=parry/median_ns;
        x:~=parry_over/auto/median";
    Ok(format!(
        "Medians in ns, {} ({}, rustc's release profile); *x* is parry's over ours.\n\n{}",
        string(run, "date").get(..10).unwrap_or("?"),
        string(&run["machine"], "cpu"),
        markdown_table(columns, SMALL.into_iter().map(row).collect::<Result<Vec<_>, _>>()?),
    ))
}

/// Replaces the text between the markers `NAME: begin` and `NAME: end` of a page.
fn replace_between(name: &str, page: &str, text: &str) -> Result<String, Failure> {
    let [begin, end] = ["begin", "end"].map(|edge| format!("<!-- {name}: {edge} -->"));
    let missing = |marker: &str| format!("missing marker {marker}; add it to the page");
    let (before, rest) = page.split_once(&begin).ok_or_else(|| missing(&begin))?;
    let (_, after) = rest.split_once(&end).ok_or_else(|| missing(&end))?;
    Ok(format!("{before}{begin}\n{text}{end}{after}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_between_markers_is_replaced() {
        let page = |text: &str| format!("a\n<!-- x: begin -->\n{text}<!-- x: end -->\nb\n");
        assert_eq!(replace_between("x", &page("old\n"), "new\n").unwrap(), page("new\n"));
        assert!(replace_between("y", &page("old\n"), "new").is_err());
    }

    #[test]
    fn pages_match_the_newest_runs() {
        let root = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
        let changed = run(&Command { root, check: true }).unwrap();
        assert!(changed.is_empty(), "not up to date with docs/measurements: {changed:?}");
    }

    #[test]
    fn commands_contain_no_folders() {
        let run = serde_json::json!({ "command": "table --quick --json /elsewhere/t.json" });
        let line = cargo_command(&run);
        assert_eq!(
            line,
            "cargo run --release -p colltrans-bench --bin table -- --quick --json t.json"
        );
    }
}
