//! The section about one pair that is asked many times.

use std::fmt::Write as _;

use serde_json::Value;

use super::{Failure, number, provenance, rounded, rows, text, thousands};

pub(super) fn write(page: &mut String, run: &Value) -> Result<(), Failure> {
    page.push_str("\n## One pair, many times\n");
    provenance(page, run)?;
    page.push_str(
        "Of 4,096 casts of two bodies with one rotation of each: ns a cast with making it, the least of all turns. \
         *any*: by the faces of the Minkowski difference; *one*: with a map for one direction, which *rays* have not; \
         in brackets how many times as fast as the ordinary cast. *make*: µs for the faces and the map; *pays*: \
         the casts after which they have paid; *left*: what the faces did not answer, in %, which of *tied* are grazing.\n\n\
         | casts | bodies | vertices | cast | tracker | any | one | make | pays | left |\n\
         |---|---|---:|---:|---:|---:|---:|---:|---:|---:|\n",
    );
    for row in rows(run) {
        let ns = |who: &str| row["ns"][who].as_f64();
        let cast = ns("cast").ok_or("a row without its ordinary cast")?;
        let gain = |who: &str| {
            ns(who).map_or("-".into(), |ns| format!("{} ({:.2})", thousands(ns), cast / ns))
        };
        let made = number(row, &["make_ns"]) + number(row, &["map_ns"]);
        let best = ns("one direction").or(ns("any direction")).ok_or("a row without faces")?;
        let pays = (best < cast).then(|| thousands(made / (cast - best)));
        writeln!(
            page,
            "| {} | {} | {} | {} | {} | {} | {} | {} | {} | {:.1} |",
            text(row, "set"),
            text(row, "shape"),
            thousands(number(row, &["vertices"])),
            thousands(cast),
            ns("tracker").map_or("-".into(), thousands),
            gain("any direction"),
            gain("one direction"),
            rounded(made / 1e3),
            pays.unwrap_or("never".into()),
            100.0 * row["left"][0].as_f64().ok_or("a row that does not say what was left")?,
        )?;
    }
    Ok(())
}
