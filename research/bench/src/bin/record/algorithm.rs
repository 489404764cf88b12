//! Formats the part of the page on the collision translation algorithm, from runs of `paper`.

use colltrans_bench::harness::markdown_table;
use serde_json::Value;

use super::{provenance, rows};

/// Formats the section.
pub(super) fn section(run: &Value) -> String {
    let is_one_off = |row: &&Value| row["solvers"]["portal"].is_object();
    let failures: f64 = rows(run)
        .iter()
        .filter_map(|row| row["solvers"].as_object())
        .flat_map(|all| all.values().filter_map(|one| one["failures"].as_f64()))
        .sum();
    let casts = format!(
        "{BODIES}; portal, ns:,=solvers/portal/median_ns ÷ solvers/portal/ratio; `portal`:~=solvers/portal/ratio;
        `cta`, rough:~=solvers/rough/ratio; {}; {};
        of parry:~=solvers/centre end/median_ns ÷ parry_8/median_ns",
        solver_columns("centre, 1 %", "centre 1%"),
        solver_columns("centre, end", "centre end"),
    );
    let sequences = format!(
        "{BODIES}; {}; {}; no focus, end:~=solvers/centre end/ratio;
        planar:>.2=solvers/centre end/planar_problems",
        solver_columns("focus, 1 %", "focus 1%"),
        solver_columns("focus, end", "focus end"),
    );
    let mut phased: Vec<Value> =
        rows(run).iter().filter(|row| row["phases"].is_object()).cloned().collect();
    for row in &mut phased {
        let focused = row["solvers"]["focus end"].is_object();
        row["end"] = row["solvers"][if focused { "focus end" } else { "centre end" }].clone();
    }
    let phases = format!(
        "{BODIES}; planar problems:,=phases/planar problems; cell shift, exit:,=phases/cell shift;
        region:,=phases/search region; bound:,=phases/lower bound; refinement:,=phases/portal refinement;
        each planar problem:,=phases/planar problems ÷ end/planar_problems;
        iterations:>.1=end/iterations ÷ end/planar_problems"
    );
    format!(
        "\n## The collision translation algorithm\n{}Each block of settings is answered twice and the second time measured, each query alone. \
         Times are medians over the median of `portal` on the colliding settings of the same bodies, \
         which stands in ns. *centre*: from the centre of the levels to a gap of 1 %, and to the end, \
         where the exit test ends it; *of parry* its median over that of parry's cast of bodies of 8 \
         vertices in the same run. *planar* are planar problems and *left* portals exchanged after \
         them, on average; cells crossed where little of the region is left are not planar problems, and \
         their time is that of the cell shift.\n\n{}\n\
         Sequences with region focus alone, over the same `portal`; the change from one \
         configuration to the next is in diameters.\n\n{}\n\
         Where the time to the end goes, from the centre and, in sequences, with region focus: medians \
         in ns of each phase, and iterations of all loops in a planar problem.\n\n{}\n\
         Queries without an answer: {failures}.\n",
        provenance(run),
        markdown_table(&casts, rows(run).iter().filter(is_one_off)),
        markdown_table(&sequences, rows(run).iter().filter(|row| !is_one_off(row))),
        markdown_table(&phases, &phased),
    )
}

/// Columns of the bodies.
const BODIES: &str = "bodies:<=settings; vertices:,";

/// Declares the columns for the ratio, planar problems and exchanges of one solver.
fn solver_columns(head: &str, who: &str) -> String {
    format!(
        "{head}:~=solvers/{who}/ratio; planar:>.2=solvers/{who}/planar_problems; left:>.2=solvers/{who}/pivots"
    )
}
