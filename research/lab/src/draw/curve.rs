//! The drawable parts of series, and notes about the other points.

use super::axis::has_place;
use crate::finding::{Figure, Point, Series};

/// The drawable part of a series.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Curve<'f> {
    pub(super) name: &'f str,
    /// Runs of neighbouring drawable points.
    pub(super) stretches: Vec<Vec<Mark>>,
}

/// A drawable point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Mark {
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) spread: Spread,
}

/// The drawable spread of a mark.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Spread {
    /// No spread, or an invalid one.
    None,
    /// Lower and upper end.
    Between(f64, f64),
    /// Upper end; the lower end is below the range of a logarithmic axis.
    UpTo(f64),
}

/// Maximum number of points with bars; longer curves have a band.
const MOST_BARS: usize = 24;

impl Curve<'_> {
    /// Checks whether the curve is drawn without marks, with its spread as a band.
    pub(super) fn is_dense(&self) -> bool {
        self.marks().count() > MOST_BARS
    }

    /// Returns the curve with displaced marks, unless it is dense.
    pub(super) fn moved(&self, aside: impl Fn(f64) -> f64) -> Self {
        let mut moved = self.clone();
        if !self.is_dense() {
            moved.stretches.iter_mut().flatten().for_each(|mark| mark.x = aside(mark.x));
        }
        moved
    }

    /// Iterates over all marks.
    pub(super) fn marks(&self) -> impl Iterator<Item = Mark> {
        self.stretches.iter().flatten().copied()
    }
}

/// Numbers of points with each kind of defect.
#[derive(Debug, Default)]
struct Trouble {
    no_place: usize,
    alone: usize,
    no_spread: usize,
    cut_spread: usize,
}

/// Returns the measured curves, and sentences about their defects.
pub(super) fn measured_curves(figure: &Figure) -> (Vec<Curve<'_>>, Vec<String>) {
    drawable_curves(figure, &figure.series, |_, _| ())
}

/// Returns the curves for comparison, without spreads and isolated points.
pub(super) fn reference_curves(figure: &Figure) -> (Vec<Curve<'_>>, Vec<String>) {
    drawable_curves(figure, &figure.references, |curve, trouble| {
        *trouble = Trouble { no_place: trouble.no_place, ..Trouble::default() };
        trouble.alone = curve.stretches.iter().filter(|stretch| stretch.len() == 1).count();
        curve.stretches.retain(|stretch| stretch.len() > 1);
        curve.stretches.iter_mut().flatten().for_each(|mark| mark.spread = Spread::None);
    })
}

/// Converts series to curves, and collects sentences about their defects.
fn drawable_curves<'f>(
    figure: &Figure,
    all: &'f [Series],
    adapt: impl Fn(&mut Curve, &mut Trouble),
) -> (Vec<Curve<'f>>, Vec<String>) {
    let (mut curves, mut sentences) = (Vec::new(), Vec::new());
    for series in all {
        let mut trouble = Trouble::default();
        let mut curve = drawable_curve(figure, series, &mut trouble);
        adapt(&mut curve, &mut trouble);
        sentences.extend(trouble.sentences(figure, series));
        curves.push(curve);
    }
    (curves, sentences)
}

/// Converts a series to a curve.
fn drawable_curve<'f>(figure: &Figure, series: &'f Series, trouble: &mut Trouble) -> Curve<'f> {
    let mut stretches = vec![Vec::new()];
    for point in &series.points {
        match (drawable_mark(figure, point, trouble), stretches.last_mut()) {
            (Some(mark), Some(stretch)) => stretch.push(mark),
            _ => stretches.push(Vec::new()),
        }
    }
    stretches.retain(|stretch| !stretch.is_empty());
    Curve { name: &series.name, stretches }
}

/// Converts a point to a mark; `None` if the axes cannot show it.
fn drawable_mark(figure: &Figure, point: &Point, trouble: &mut Trouble) -> Option<Mark> {
    let &Point { x, y, low, high, .. } = point;
    if !has_place(&figure.x, x) || !has_place(&figure.y, y) {
        trouble.no_place += 1;
        return None;
    }
    let spread = if low == y && high == y {
        Spread::None
    } else if !(low <= y && y <= high && has_place(&figure.y, high)) {
        trouble.no_spread += 1;
        Spread::None
    } else if has_place(&figure.y, low) {
        Spread::Between(low, high)
    } else {
        trouble.cut_spread += 1;
        Spread::UpTo(high)
    };
    Some(Mark { x, y, spread })
}

impl Trouble {
    /// Describes the defects.
    fn sentences(&self, figure: &Figure, series: &Series) -> Vec<String> {
        let (name, all) = (&series.name, series.points.len());
        let place = if figure.x.log || figure.y.log {
            "not a finite number, or not positive on a logarithmic axis"
        } else {
            "not a finite number"
        };
        let kinds = [
            (self.no_place, format!("not drawn: {place}")),
            (self.alone, "not drawn: a point alone is no curve".into()),
            (self.no_spread, "without spread: what is given does not enclose the value".into()),
            (self.cut_spread, "with a spread that is cut: it goes below the axis".into()),
        ];
        let mut sentences: Vec<String> = kinds
            .into_iter()
            .filter(|(count, _)| *count > 0)
            .map(|(count, what)| format!("{name}: {count} of {all} points {what}."))
            .collect();
        if all == 0 {
            sentences.push(format!("{name}: no points."));
        }
        sentences
    }
}
