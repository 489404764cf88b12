//! The page's part on the collision translation algorithm, from runs of `paper`.

use std::fmt::Write as _;

use serde_json::Value;

use super::{Failure, number, provenance, rounded, rows, text, thousands};

pub(super) fn write(page: &mut String, run: &Value) -> Result<(), Failure> {
    page.push_str("\n## The collision translation algorithm\n");
    provenance(page, run)?;
    page.push_str(
        "Each block of settings is answered twice and the second time measured, each query alone. \
         Times are medians over the median of `portal` on the colliding settings of the same bodies, \
         which stands in ns. *centre*: from the centre of the levels to a gap of 1 %, and to the end, \
         where the exit test ends it; *of parry* its median over that of parry's cast of bodies of 8 \
         vertices in the same run. *planar* are planar problems and *left* portals exchanged after \
         them, on average; cells crossed where little of the region is left are not planar problems, and \
         their time is that of the cell shift.\n\n\
         | bodies | vertices | portal, ns | `portal` | `cta`, rough | centre, 1 % | planar | left | centre, \
         end | planar | left | of parry |\n\
         |---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n",
    );
    let one_off = |row: &&Value| row["solvers"]["portal"].is_object();
    for row in rows(run).iter().filter(one_off) {
        casts(page, row)?;
    }
    page.push_str(
        "\nSequences with region focus alone, over the same `portal`; the change from one \
         configuration to the next is in diameters.\n\n\
         | bodies | vertices | focus, 1 % | planar | left | focus, end | planar | left | no focus, end \
         | planar |\n\
         |---|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n",
    );
    for row in rows(run).iter().filter(|row| !one_off(row)) {
        sequences(page, row)?;
    }
    page.push_str(
        "\nWhere the time to the end goes, from the centre and, in sequences, with region focus: medians \
         in ns of each phase, and iterations of all loops in a planar problem.\n\n\
         | bodies | vertices | planar problems | cell shift, exit | region | bound | refinement | each \
         planar problem | iterations |\n\
         |---|---:|---:|---:|---:|---:|---:|---:|---:|\n",
    );
    for row in rows(run).iter().filter(|row| row["phases"].is_object()) {
        phases(page, row)?;
    }
    let failures: f64 = rows(run)
        .iter()
        .filter_map(|row| row["solvers"].as_object())
        .flat_map(|all| all.values().filter_map(|one| one["failures"].as_f64()))
        .sum();
    writeln!(page, "\nQueries without an answer: {failures}.")?;
    Ok(())
}

fn of(row: &Value, who: &str, key: &str) -> f64 {
    number(row, &["solvers", who, key])
}

/// Ratio, planar problems and exchanges of one solver.
fn trio(row: &Value, who: &str) -> String {
    let [ratio, planar, left] = ["ratio", "planar_problems", "pivots"].map(|key| of(row, who, key));
    format!("{} | {planar:.2} | {left:.2}", rounded(ratio))
}

fn casts(page: &mut String, row: &Value) -> Result<(), Failure> {
    let portal = of(row, "portal", "median_ns");
    let unit = portal / of(row, "portal", "ratio");
    writeln!(
        page,
        "| {} | {} | {} | {} | {} | {} | {} | {} |",
        text(row, "settings"),
        thousands(number(row, &["vertices"])),
        thousands(unit),
        rounded(portal / unit),
        rounded(of(row, "rough", "ratio")),
        trio(row, "centre 1%"),
        trio(row, "centre end"),
        rounded(of(row, "centre end", "median_ns") / number(row, &["parry_8", "median_ns"])),
    )?;
    Ok(())
}

fn sequences(page: &mut String, row: &Value) -> Result<(), Failure> {
    writeln!(
        page,
        "| {} | {} | {} | {} | {} | {:.2} |",
        text(row, "settings"),
        thousands(number(row, &["vertices"])),
        trio(row, "focus 1%"),
        trio(row, "focus end"),
        rounded(of(row, "centre end", "ratio")),
        of(row, "centre end", "planar_problems"),
    )?;
    Ok(())
}

fn phases(page: &mut String, row: &Value) -> Result<(), Failure> {
    let spent = |name: &str| number(row, &["phases", name]);
    let focused = row["solvers"]["focus end"].is_object();
    let who = if focused { "focus end" } else { "centre end" };
    let problems = of(row, who, "planar_problems");
    write!(page, "| {} | {} |", text(row, "settings"), thousands(number(row, &["vertices"])))?;
    for name in
        ["planar problems", "cell shift", "search region", "lower bound", "portal refinement"]
    {
        write!(page, " {} |", thousands(spent(name)))?;
    }
    writeln!(
        page,
        " {} | {:.1} |",
        thousands(spent("planar problems") / problems),
        of(row, who, "iterations") / problems,
    )?;
    Ok(())
}
