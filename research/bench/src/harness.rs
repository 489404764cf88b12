//! Reads the arguments of measuring programs, prints their tables, and writes their figures.
//!
//! A program declares the columns of its table ([`Run::table`]) and adds rows. A row is one JSON value. The
//! table prints the figures that its columns name; the file contains all figures.

use std::error::Error;
use std::fmt::Display;
use std::fs;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, CommandFactory, FromArgMatches, Parser};
use colltrans_testkit::provenance::Provenance;
use colltrans_testkit::random::Random;
use serde::Serialize;
use serde_json::{Value, json};

/// Reason for which a program ends early.
pub type Failure = Box<dyn Error>;

/// Arguments of all programs.
#[derive(Debug, Clone, Args)]
pub struct Arguments {
    /// Vertices per body (default: depends on the program)
    #[arg(long, value_name = "N,...", value_delimiter = ',')]
    pub sizes: Option<Vec<usize>>,
    /// Measure fewer settings
    #[arg(long)]
    pub quick: bool,
    /// Write the figures to this file (JSON)
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Seed of the random bodies and settings
    #[arg(long, value_name = "S", default_value_t = 1)]
    pub seed: u64,
}

#[derive(Debug, Parser)]
struct Command<A: Args> {
    #[command(flatten)]
    common: Arguments,
    #[command(flatten)]
    own: A,
}

/// Runs a program: reads the common and its own arguments, measures, and writes the figures.
pub fn run<A: Args>(
    program: &str,
    about: &'static str,
    measure: impl FnOnce(&mut Run, &A) -> Result<(), Failure>,
) -> ExitCode {
    let matches = Command::<A>::command().about(about).long_about(None).get_matches();
    let Command { common, own } =
        Command::<A>::from_arg_matches(&matches).unwrap_or_else(|error| error.exit());
    let mut run =
        Run { program: program.into(), arguments: common, columns: Vec::new(), rows: Vec::new() };
    match measure(&mut run, &own).and_then(|()| run.write()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

/// Returns a function that puts the name of the measurement before an error.
pub fn with_name<E: Display>(what: impl Display) -> impl FnOnce(E) -> Failure {
    move |error| format!("{what}: {error}").into()
}

/// A run of a program.
#[derive(Debug)]
pub struct Run {
    /// Name of the program in the file of figures.
    pub program: String,
    /// Common arguments.
    pub arguments: Arguments,
    columns: Vec<Column>,
    rows: Vec<Value>,
}

impl Run {
    /// Returns the sizes from the arguments, or the usual ones.
    pub fn sizes(&self, usual: &[usize]) -> Vec<usize> {
        self.arguments.sizes.clone().unwrap_or_else(|| usual.to_vec())
    }

    /// Returns the first value in a quick run, else the second one.
    pub fn choose<T>(&self, quick: T, full: T) -> T {
        if self.arguments.quick { quick } else { full }
    }

    /// Returns the random numbers of the seed for a purpose.
    pub fn random(&self, purpose: &[u64]) -> Random {
        Random::stream(self.arguments.seed, purpose)
    }

    /// Begins a table. Prints the legend and the heads of the columns, each unless it is empty.
    ///
    /// A text declares the table: `HEAD:FORMAT=VALUE` for each column, with `;` between columns.
    ///
    /// - `FORMAT` is as in `format!`: `<18`, `>9.2`, `>9.1e`. In Markdown tables, `,` groups the digits of
    ///   whole numbers by three, and `~` prints the significant digits.
    /// - `VALUE` is a JSON pointer into a row without its first slash, or a quoted text. Without `=VALUE`, the
    ///   head is the pointer.
    /// - ` + POINTER` behind a pointer adds another figure. ` ÷ POINTER` divides by a figure, ` × NUMBER`
    ///   multiplies. ` ÷ NUMBER UNIT` divides by a number and prints a unit.
    /// - ` (FORMAT=VALUE)` adds another figure in brackets. `?TEXT` replaces missing figures. `|` before a
    ///   column draws a bar.
    ///
    /// # Panics
    /// If the text does not have this form.
    pub fn table(&mut self, legend: &str, table: &str) {
        self.columns = parse_columns(table);
        for line in [legend, &line(&self.columns, |column| column.head.clone())] {
            if !line.trim_matches([' ', '|']).is_empty() {
                println!("{line}");
            }
        }
    }

    /// Prints a row if there is a table, and keeps it for the file.
    ///
    /// # Panics
    /// If the row cannot be written as JSON.
    pub fn add(&mut self, row: impl Serialize) {
        let row = serde_json::to_value(row).expect("a row of numbers and names");
        if !self.columns.is_empty() {
            println!("{}", line(&self.columns, |column| column.format_cell(&row)));
        }
        self.rows.push(row);
    }

    /// Writes the rows and the provenance, if a file is given.
    fn write(&self) -> Result<(), Failure> {
        let Some(path) = &self.arguments.json else { return Ok(()) };
        let mut report = Provenance::of_this_process("parry3d-f64 0.31.1").to_json();
        report["program"] = json!(self.program);
        report["seed"] = json!(self.arguments.seed);
        report["rows"] = json!(self.rows);
        fs::write(path, format!("{report:#}\n")).map_err(with_name(path.display()))
    }
}

/// Returns an object with the entries of both. Entries of the second one replace those with the same name.
///
/// # Panics
/// If one of them is not an object.
pub fn merge_objects(row: impl Serialize, more: Value) -> Value {
    let mut row = serde_json::to_value(row).expect("a row of numbers and names");
    let Value::Object(more) = more else { panic!("an object") };
    row.as_object_mut().expect("an object").extend(more);
    row
}

/// A column of a table: the pointers to its figures in rows, and their format.
#[derive(Debug)]
struct Column {
    head: String,
    bar: &'static str,
    is_left: bool,
    width: usize,
    style: Style,
    paths: Vec<String>,
    divisor: Option<String>,
    factor: f64,
    scale: f64,
    unit: String,
    missing: String,
    bracketed: Option<Box<Column>>,
}

#[derive(Debug, Clone, Copy)]
enum Style {
    Plain,
    Fixed(usize),
    Power(usize),
    Grouped,
    Rounded,
}

/// Parses the columns of a declaration.
///
/// # Panics
/// If the text is not a declaration.
fn parse_columns(text: &str) -> Vec<Column> {
    text.split(';').map(|column| Column::new(column.trim())).collect()
}

/// Splits a text at a mark. Returns the whole text and `None` if the mark is missing.
fn split_at_mark<'a>(text: &'a str, mark: &str) -> (&'a str, Option<&'a str>) {
    text.split_once(mark).map_or((text, None), |(before, behind)| (before, Some(behind)))
}

impl Column {
    /// Parses the declaration of one column.
    fn new(text: &str) -> Self {
        let (bar, text) = text.strip_prefix('|').map_or(("", text), |text| ("| ", text));
        let (head, rest) = text.trim().split_once(':').expect("HEAD:FORMAT");
        let (rest, missing) = split_at_mark(rest, "?");
        let (rest, bracketed) = split_at_mark(rest, " (");
        let (format, value) = split_at_mark(rest, "=");
        let (value, factor) = split_at_mark(value.unwrap_or(head), " × ");
        let (value, divisor) = split_at_mark(value, " ÷ ");
        let (scale, unit) = split_at_mark(divisor.unwrap_or("1"), " ");
        let scale = scale.parse::<f64>();
        let (width, digits) = split_at_mark(format.trim_start_matches(['<', '>']), ".");
        let number = |digits: &str| digits.parse().expect("a number of digits");
        let style = match (width, digits.map(|digits| split_at_mark(digits, "e"))) {
            (",", _) => Style::Grouped,
            ("~", _) => Style::Rounded,
            (_, None) => Style::Plain,
            (_, Some((digits, None))) => Style::Fixed(number(digits)),
            (_, Some((digits, Some(_)))) => Style::Power(number(digits)),
        };
        let unknown = match style {
            Style::Plain => "?",
            Style::Rounded => "-",
            _ => "NaN",
        };
        Self {
            head: head.into(),
            bar,
            is_left: format.starts_with('<'),
            width: width.parse().unwrap_or(0),
            style,
            paths: value.split(" + ").map(Into::into).collect(),
            divisor: divisor.filter(|_| scale.is_err()).map(Into::into),
            factor: factor.map_or(1.0, |factor| factor.parse().expect("a factor")),
            unit: unit.filter(|_| scale.is_ok()).map_or(String::new(), |unit| format!(" {unit}")),
            scale: scale.unwrap_or(1.0),
            missing: missing.unwrap_or(unknown).into(),
            bracketed: bracketed
                .map(|other| Box::new(Self::new(&format!(":{}", other.trim_end_matches(')'))))),
        }
    }

    /// Formats the figures of a row.
    fn format_cell(&self, row: &Value) -> String {
        if let Some(text) = self.paths[0].strip_prefix('"') {
            return text.trim_end_matches('"').into();
        }
        let found = |path: &String| row.pointer(&format!("/{path}")).filter(|v| !v.is_null());
        let number = |path| found(path).and_then(Value::as_f64).unwrap_or(f64::NAN);
        let sum: f64 = self.paths.iter().map(number).sum();
        let value = self.factor * sum / self.divisor.as_ref().map_or(self.scale, number);
        let text = match self.style {
            Style::Plain => match found(&self.paths[0]) {
                Some(Value::String(text)) => text.clone(),
                Some(value) => value.to_string(),
                None => self.missing.clone(),
            },
            _ if value.is_nan() => return self.missing.clone(),
            Style::Fixed(digits) => format!("{value:.digits$}"),
            Style::Power(digits) => format!("{value:.digits$e}"),
            Style::Grouped => group_thousands(value),
            Style::Rounded => round_to_significant(value),
        };
        let bracketed =
            self.bracketed.as_ref().map(|other| format!(" ({})", other.format_cell(row)));
        text + &self.unit + &bracketed.unwrap_or_default()
    }
}

/// Formats a line of a printed table.
fn line(columns: &[Column], cell: impl Fn(&Column) -> String) -> String {
    let padded = |column: &Column| {
        let (bar, width, cell) = (column.bar, column.width, cell(column));
        if column.is_left { format!("{bar}{cell:<width$}") } else { format!("{bar}{cell:>width$}") }
    };
    columns.iter().map(padded).collect::<Vec<_>>().join(" ").trim_end().into()
}

/// Formats rows as a Markdown table, with columns declared as in [`Run::table`].
///
/// # Panics
/// If the columns are not declared in this form.
pub fn markdown_table<'a>(table: &str, rows: impl IntoIterator<Item = &'a Value>) -> String {
    let columns = parse_columns(table);
    let line = |cell: &dyn Fn(&Column) -> String| {
        format!("|{}\n", columns.iter().map(|column| cell(column) + "|").collect::<String>())
    };
    let space = |text: &str| if text.is_empty() { " ".into() } else { format!(" {text} ") };
    let rule = |column: &Column| if column.is_left { "---" } else { "---:" }.to_owned();
    let heads = [line(&|column| space(&column.head)), line(&rule)].into_iter();
    heads
        .chain(rows.into_iter().map(|row| line(&|column| space(&column.format_cell(row)))))
        .collect()
}

/// Formats a number with its significant digits, without those below the noise of measurements.
fn round_to_significant(x: f64) -> String {
    match x {
        _ if x < 9.95 => format!("{x:.2}"),
        _ if x < 99.5 => format!("{x:.1}"),
        _ => group_thousands(x),
    }
}

/// Formats a whole number in groups of three digits.
fn group_thousands(x: f64) -> String {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_print_named_figures() {
        let row = json!({ "a": "x", "b": { "n": 3, "ns": 1500.0 }, "c": [0.25, null] });
        let table = "a:<3;n:>3=b/n;|us:>8.2=b/ns ÷ 1e3 us;:>5.1=b/ns ÷ b/n;:>2.0=b/n + b/n;:>.1e=c/0;\
            w:>4.1=c/1?none;:>4=\"who\";:,=b/ns (~=c/0)";
        let columns = parse_columns(table);
        let printed = "x     3 |  1.50 us 500.0  6 2.5e-1 none  who 1,500 (0.25)";
        assert_eq!(line(&columns, |column| column.format_cell(&row)), printed);
        let heads = line(&columns, |column| column.head.clone());
        assert_eq!(heads, format!("a     n |       us{:>15}", "w"));
    }

    #[test]
    fn markdown_tables_and_rounded_numbers_are_formatted() {
        let page = "| a | | c |\n|---|---|---:|\n| x | ? | - |\n";
        assert_eq!(markdown_table("a:<; :<=b; c:~", [&json!({ "a": "x" })]), page);
        assert_eq!([1_234_567.0, 999.4].map(group_thousands), ["1,234,567", "999"]);
        assert_eq!([0.333, 12.34, 345.6].map(round_to_significant), ["0.33", "12.3", "346"]);
    }
}
