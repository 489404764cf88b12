//! Named numbers and disagreements of one family of a campaign.

use std::collections::BTreeMap;

/// The numbers and the disagreements of one family.
#[derive(Debug, Default)]
pub struct Tally {
    numbers: BTreeMap<&'static str, Number>,
    /// Descriptions of disagreements.
    pub disagreements: Vec<String>,
}

#[derive(Debug, Clone, Copy)]
enum Number {
    Count(u64),
    Largest(f64),
    Mean { sum: f64, count: u64 },
}

impl Tally {
    /// Adds one to a count.
    pub fn count(&mut self, name: &'static str) {
        self.add(name, 1);
    }

    /// Adds one to a count if `holds` is true.
    pub fn count_if(&mut self, name: &'static str, holds: bool) {
        self.add(name, u64::from(holds));
    }

    /// Adds to a count.
    pub fn add(&mut self, name: &'static str, more: u64) {
        self.note(name, Number::Count(more));
    }

    /// Records a number of which the largest is reported.
    pub fn largest(&mut self, name: &'static str, value: impl Into<f64>) {
        self.note(name, Number::Largest(value.into()));
    }

    /// Records a number of which the mean is reported.
    pub fn mean(&mut self, name: &'static str, value: impl Into<f64>) {
        self.note(name, Number::Mean { sum: value.into(), count: 1 });
    }

    /// Returns a count; 0 if it has not been recorded.
    pub fn get(&self, name: &str) -> u64 {
        match self.numbers.get(name) {
            Some(Number::Count(count)) => *count,
            _ => 0,
        }
    }

    /// Records a disagreement.
    pub fn disagree(&mut self, what: String) {
        self.disagreements.push(what);
    }

    /// Merges the numbers and disagreements of another tally.
    #[must_use]
    pub fn merged(mut self, other: Self) -> Self {
        for (name, number) in other.numbers {
            self.note(name, number);
        }
        self.disagreements.extend(other.disagreements);
        self
    }

    /// Merges a number into those recorded under its name.
    fn note(&mut self, name: &'static str, number: Number) {
        self.numbers.entry(name).and_modify(|known| *known = known.with(number)).or_insert(number);
    }

    /// Returns the numbers as a line below [`header`].
    ///
    /// # Panics
    /// If a recorded number has no column.
    pub fn line(&self, columns: &[&str]) -> String {
        let without = self.numbers.keys().find(|name| !columns.contains(name));
        assert!(without.is_none(), "{without:?} has no column");
        let cells = columns.iter().map(|name| {
            let width = column_width(name);
            format!("{:>width$} ", self.numbers.get(name).map_or_else(|| "0".into(), Number::text))
        });
        format!("{}{:>6}", cells.collect::<String>(), self.disagreements.len())
    }
}

impl Number {
    /// Returns the combination of two numbers of the same kind.
    fn with(self, other: Self) -> Self {
        match (self, other) {
            (Self::Count(a), Self::Count(b)) => Self::Count(a + b),
            (Self::Largest(a), Self::Largest(b)) => Self::Largest(a.max(b)),
            (Self::Mean { sum, count }, Self::Mean { sum: more, count: and }) => {
                Self::Mean { sum: sum + more, count: count + and }
            }
            _ => unreachable!("each name has one kind of number"),
        }
    }

    /// Formats the number.
    fn text(&self) -> String {
        let value = match *self {
            Self::Count(count) => return count.to_string(),
            Self::Largest(value) => value,
            Self::Mean { sum, count } => sum / count as f64,
        };
        if value != 0.0 && !(1e-3..1e6).contains(&value.abs()) {
            format!("{value:.2e}")
        } else {
            format!("{value:.3}")
        }
    }
}

/// Returns the names of the columns as a line.
pub fn header(columns: &[&str]) -> String {
    let names = columns.iter().map(|name| format!("{name:>width$} ", width = column_width(name)));
    format!("{}{:>6}", names.collect::<String>(), "wrong")
}

/// Returns the width of a column.
fn column_width(name: &str) -> usize {
    name.len().max(9)
}
