//! `record`: writes the picture `docs/speed.svg` and the table of the README from the newest run of `table` in
//! `docs/measurements/`, the file `YYYY-MM-DD-table.json` with the last date. The site sets all runs as a page
//! (`site/measurements.py`).

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Parser;
use colltrans_bench::harness::markdown_table;
use colltrans_lab::draw::draw;
use colltrans_lab::finding::{Axis, Figure, Point, Series};
use serde_json::Value;

/// Writes docs/speed.svg and the README's table from the newest run of `table` in docs/measurements
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

/// Returns the newest run of `table`.
fn newest_table(folder: &Path) -> Result<Value, Failure> {
    let name = fs::read_dir(folder)
        .map_err(|error| format!("{}: {error}", folder.display()))?
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .filter(|name| name.ends_with("-table.json"))
        .max()
        .ok_or_else(|| format!("{} has no run of `table`", folder.display()))?;
    let text = fs::read_to_string(folder.join(&name))?;
    Ok(serde_json::from_str(&text).map_err(|error| format!("{name}: {error}"))?)
}

/// Writes the changed files, or only lists them.
fn run(command: &Command) -> Result<Vec<String>, Failure> {
    let table = newest_table(&command.root.join("docs/measurements"))?;
    let picture = draw(&speed_figure(&table)).map_err(|error| format!("speed.svg: {error}"))?;
    let readme = fs::read_to_string(command.root.join("README.md"))
        .map_err(|error| format!("README.md: {error}"))?;
    let readme = replace_between("speed", &readme, &small_table(&table)?)?;
    let mut changed = Vec::new();
    for (name, text) in [("docs/speed.svg", picture.svg), ("README.md", readme)] {
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
            of("cta", "colltrans, by planar sections"),
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
}
