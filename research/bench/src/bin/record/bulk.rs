//! Formats the section on many casts of one pair.

use colltrans_bench::harness::markdown_table;
use serde_json::Value;

use super::{number, provenance, rows};

/// Formats the section.
pub(super) fn section(run: &Value) -> String {
    let mut rows = rows(run).to_vec();
    for row in &mut rows {
        let ns = |who: &str| row["ns"][who].as_f64();
        let [cast, any, one] = ["cast", "any direction", "one direction"].map(ns);
        let gain = cast.zip(one.or(any)).map_or(0.0, |(cast, best)| cast - best);
        let made = number(row, "make_ns") + number(row, "map_ns");
        row["pays"] = (gain > 0.0).then(|| made / gain).into();
    }
    let columns = "casts:<=set; bodies:<=shape; vertices:,; cast:,=ns/cast; tracker:,=ns/tracker?-;
        any:,=ns/any direction (>.2=ns/cast ÷ ns/any direction)?-;
        one:,=ns/one direction (>.2=ns/cast ÷ ns/one direction)?-;
        make:~=make_ns + map_ns ÷ 1e3; pays:,?never; left:>.1=left/0 × 100";
    format!(
        "\n## One pair, many times\n{}Of 4,096 casts of two bodies with one rotation of each: ns a cast with making it, the least of all turns. \
         *any*: by the faces of the Minkowski difference; *one*: with a map for one direction, which *rays* have not; \
         in brackets how many times as fast as the ordinary cast. *make*: µs for the faces and the map; *pays*: \
         the casts after which they have paid; *left*: what the faces did not answer, in %, which of *tied* are grazing.\n\n{}",
        provenance(run),
        markdown_table(columns, &rows),
    )
}
