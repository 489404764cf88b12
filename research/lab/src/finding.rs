//! The result of an experiment: figures and tables from data, and the claims that they support or refute.

use colltrans_testkit::timing::quantile;

use crate::claims::Claim;
use crate::statistics::mean;

/// The result of an experiment.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// Figures, in the paper's form; several where the paper shows several plots.
    pub figures: Vec<Figure>,
    /// Tables.
    pub tables: Vec<Table>,
    /// The tested claims.
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
    /// Curves for comparison, such as `log n`, drawn thin.
    pub references: Vec<Series>,
}

/// An axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// Quantity and unit.
    pub label: String,
    /// Whether the axis is logarithmic.
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
    /// Horizontal coordinate.
    pub x: f64,
    /// Value: a median or a mean, as stated in the figure's title.
    pub y: f64,
    /// Lower end of the spread: a quartile, or an end of a 95 % interval, as stated in the figure's title.
    pub low: f64,
    /// Upper end of the spread.
    pub high: f64,
    /// Number of measurements.
    pub count: usize,
}

impl Point {
    /// Returns the median with quartiles.
    pub(crate) fn median(x: f64, values: &[f64]) -> Self {
        let [low, y, high] = [0.25, 0.5, 0.75].map(|share| quantile(values, share));
        Self { x, y, low, high, count: values.len() }
    }

    /// Returns the mean with quartiles. If more than three quarters of the values are on one side of the
    /// mean, the spread ends at the mean.
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
