//! What became of the settings of one family of a campaign: named numbers, and what is wrong.

use std::collections::BTreeMap;

/// The numbers of one family.
#[derive(Debug, Default)]
pub struct Tally {
    numbers: BTreeMap<&'static str, Number>,
    /// Lines that say what disagrees.
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

    /// Adds one to a count where something holds.
    pub fn count_if(&mut self, name: &'static str, holds: bool) {
        self.add(name, u64::from(holds));
    }

    /// Adds to a count.
    pub fn add(&mut self, name: &'static str, more: u64) {
        self.note(name, Number::Count(more));
    }

    /// Keeps the larger one of a number and those before.
    pub fn largest(&mut self, name: &'static str, value: impl Into<f64>) {
        self.note(name, Number::Largest(value.into()));
    }

    /// Takes a number into a mean.
    pub fn mean(&mut self, name: &'static str, value: impl Into<f64>) {
        self.note(name, Number::Mean { sum: value.into(), count: 1 });
    }

    /// Returns a count; 0 of what has not been counted.
    pub fn get(&self, name: &str) -> u64 {
        match self.numbers.get(name) {
            Some(Number::Count(count)) => *count,
            _ => 0,
        }
    }

    /// Notes a disagreement.
    pub fn disagree(&mut self, what: String) {
        self.disagreements.push(what);
    }

    /// Returns the numbers and disagreements of both.
    #[must_use]
    pub fn merged(mut self, other: Self) -> Self {
        for (name, number) in other.numbers {
            self.note(name, number);
        }
        self.disagreements.extend(other.disagreements);
        self
    }

    fn note(&mut self, name: &'static str, number: Number) {
        self.numbers.entry(name).and_modify(|known| *known = known.with(number)).or_insert(number);
    }

    /// Returns the numbers under [`header`] as a line.
    ///
    /// # Panics
    /// If a number has been noted that has no column.
    pub fn line(&self, columns: &[&str]) -> String {
        let without = self.numbers.keys().find(|name| !columns.contains(name));
        assert!(without.is_none(), "{without:?} has no column");
        let cells = columns.iter().map(|name| {
            let width = width(name);
            format!("{:>width$} ", self.numbers.get(name).map_or_else(|| "0".into(), Number::text))
        });
        format!("{}{:>6}", cells.collect::<String>(), self.disagreements.len())
    }
}

impl Number {
    fn with(self, other: Self) -> Self {
        match (self, other) {
            (Self::Count(a), Self::Count(b)) => Self::Count(a + b),
            (Self::Largest(a), Self::Largest(b)) => Self::Largest(a.max(b)),
            (Self::Mean { sum, count }, Self::Mean { sum: more, count: and }) => {
                Self::Mean { sum: sum + more, count: count + and }
            }
            _ => unreachable!("a name stands for one kind of number"),
        }
    }

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
    let names = columns.iter().map(|name| format!("{name:>width$} ", width = width(name)));
    format!("{}{:>6}", names.collect::<String>(), "wrong")
}

fn width(name: &str) -> usize {
    name.len().max(9)
}
