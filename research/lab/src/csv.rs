//! Figures and tables as comma-separated values (RFC 4180, with line feeds).

use crate::finding::{Figure, Table};

/// Returns the points of a figure, one in each row: the measured series, then the references.
///
/// Numbers are the shortest that read back as the same `f64`. Other values are written as `NaN`, `inf` and
/// `-inf`.
pub fn figure(figure: &Figure) -> String {
    let mut text = String::from("series,x,y,low,high,count\n");
    for series in figure.series.iter().chain(&figure.references) {
        for point in &series.points {
            let numbers = [point.x, point.y, point.low, point.high].map(format_number);
            let count = point.count.to_string();
            write_row(&mut text, std::iter::once(&series.name).chain(&numbers).chain([&count]));
        }
    }
    text
}

/// Returns the column heads and the rows of a table.
pub fn table(table: &Table) -> String {
    let mut text = String::new();
    write_row(&mut text, table.columns.iter());
    table.rows.iter().for_each(|cells| write_row(&mut text, cells.iter()));
    text
}

/// Appends a row, with quotes where necessary.
fn write_row<'a>(text: &mut String, cells: impl Iterator<Item = &'a String>) {
    for (i, cell) in cells.enumerate() {
        if i > 0 {
            text.push(',');
        }
        if cell.contains(['"', ',', '\n', '\r']) {
            text.extend(["\"", &cell.replace('"', "\"\""), "\""]);
        } else {
            text.push_str(cell);
        }
    }
    text.push('\n');
}

/// Formats a number.
fn format_number(value: f64) -> String {
    // Unlike `{}`, this uses an exponent where that is shorter.
    let text = format!("{value:?}");
    text.strip_suffix(".0").map(str::to_owned).unwrap_or(text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::finding::{Axis, Point, Series};

    #[test]
    fn numbers_are_read_back_exactly() {
        for value in [0.0, -0.0, 0.1, 1e300, 5e-324, 2000.0, 1.0 / 3.0, f64::INFINITY, f64::MAX] {
            assert_eq!(format_number(value).parse::<f64>().unwrap().to_bits(), value.to_bits());
        }
        assert!(format_number(f64::NAN).parse::<f64>().unwrap().is_nan());
        assert_eq!(format_number(2000.0), "2000");
    }

    #[test]
    fn cells_are_quoted() {
        let axis = Axis { label: String::new(), log: false };
        let series = |name: &str, y| Series {
            name: name.into(),
            points: vec![Point { x: 20.0, y, low: 0.5, high: 1e-9, count: 7 }],
        };
        let drawn = Figure {
            id: "f".into(),
            title: String::new(),
            x: axis.clone(),
            y: axis,
            series: vec![series("a, \"b\"", f64::NAN)],
            references: vec![series("log n", 3.0)],
        };
        let expected = "series,x,y,low,high,count\n\
            \"a, \"\"b\"\"\",20,NaN,0.5,1e-9,7\nlog n,20,3,0.5,1e-9,7\n";
        assert_eq!(figure(&drawn), expected);
        let cells = |cells: [&str; 2]| cells.map(String::from).to_vec();
        let shown = Table {
            id: "t".into(),
            title: String::new(),
            columns: cells(["n", "time, µs"]),
            rows: vec![cells(["20", "a\nb"]), cells(["", "x"])],
        };
        assert_eq!(table(&shown), "n,\"time, µs\"\n20,\"a\nb\"\n,x\n");
    }
}
