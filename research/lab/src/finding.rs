//! What an experiment found: figures and tables from data, and the claims they support or refute.

use colltrans_testkit::timing::quantile;

use crate::claims::Claim;
use crate::statistics::mean;

/// The result of an experiment.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// The figures, in the paper's form; more than one where the paper shows several plots.
    pub figures: Vec<Figure>,
    /// Tables.
    pub tables: Vec<Table>,
    /// The claims put to the test.
    pub claims: Vec<Claim>,
}

/// A plot and its data.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Name of its files, such as `figure-12-far`.
    pub id: String,
    /// Caption.
    pub title: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// Measured curves.
    pub series: Vec<Series>,
    /// Curves to compare with, such as `log n`, drawn thin.
    pub references: Vec<Series>,
}

/// An axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// What and in which unit.
    pub label: String,
    /// Logarithmic.
    pub log: bool,
}

/// A curve.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Name in the legend.
    pub name: String,
    /// Its points, ascending in `x`.
    pub points: Vec<Point>,
}

/// A measured value with its spread.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Place on the horizontal axis.
    pub x: f64,
    /// The value: a median or a mean, as the figure's title says.
    pub y: f64,
    /// Lower end of the spread: a quartile, or an end of a 95 % interval, as the figure's title says.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// From how many measurements.
    pub count: usize,
}

impl Point {
    /// Median with quartiles.
    pub(crate) fn median(x: f64, values: &[f64]) -> Self {
        let [low, y, high] = [0.25, 0.5, 0.75].map(|share| quantile(values, share));
        Self { x, y, low, high, count: values.len() }
    }

    /// Mean with quartiles; where more than three quarters of the values lie to one side of their
    /// mean, the spread ends there.
    pub(crate) fn mean(x: f64, values: &[f64]) -> Self {
        let y = mean(values);
        let [low, high] = [0.25, 0.75].map(|share| quantile(values, share));
        Self { x, y, low: low.min(y), high: high.max(y), count: values.len() }
    }
}

/// A table.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// Name of its file.
    pub id: String,
    /// Caption.
    pub title: String,
    /// Heads of the columns.
    pub columns: Vec<String>,
    /// Cells, row by row.
    pub rows: Vec<Vec<String>>,
}
