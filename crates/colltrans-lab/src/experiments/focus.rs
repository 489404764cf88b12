//! Figures 13 and 14: what it saves to start from the solution of a similar configuration.

use colltrans::Region;

use super::{
    Coherence, Parts, Race, Results, axis, claim, reference, series, share, shares, thousands,
};
use crate::Experiment;
use crate::contestants::{PAPER_GAP, Until, Who};
use crate::finding::{Claim, Figure, Finding, Point, Series};
use crate::plan::{Plan, Progress};
use crate::settings::{Meeting, Setting};
use crate::shapes::Kind;
use colltrans_kit::timing::mean_and_deviation;

pub(super) const FIGURE_13: Experiment = Experiment {
    id: "figure-13",
    title: "steps of single queries with initialisation",
    run: single,
};

pub(super) const FIGURE_14: Experiment = Experiment {
    id: "figure-14",
    title: "average steps with initialisation against change and size",
    run: average,
};

const WHO: [Who; 5] = [
    Who::Cta(Until::Near),
    Who::Cta(Until::End),
    Who::CtaRegion(Region::Automatic, Until::Near),
    Who::CtaRegion(Region::Automatic, Until::End),
    Who::Tracker,
];
const SCRATCH: [usize; 2] = [0, 1];
const REGION: [usize; 2] = [2, 3];
const TRACKER: usize = 4;

/// Names of both ways to count: see [`Until`].
const UNTIL: [&str; 2] = ["CTA", "CTA to the end"];

/// Pairs of configurations that differ by `delta`: the second is measured, after the first.
fn measure(plan: &Plan, figure: u64, n: usize, delta: f64, blocks: usize) -> Results {
    let race = Race {
        plan,
        figure,
        kind: Kind::Balanced,
        n,
        who: &WHO,
        coherence: Coherence::Blocks,
        length: 2,
        blocks,
    };
    race.run((delta * 1e6) as u64, |bodies, count, random| {
        Setting::sequence(bodies, Meeting::Colliding, delta, count, random)
    })
}

/// Steps of a contestant's queries.
fn steps(results: &Results, who: usize) -> Vec<f64> {
    results.counts(who, |work| work.steps)
}

/// The changes of figure 13, in diameters.
const CHANGES: [f64; 2] = [0.01, 0.0025];

fn single(plan: &Plan, progress: &mut dyn Progress) -> Finding {
    let n = plan.size(12_800);
    let mut parts = Parts::new(progress, 2.0);
    let results = CHANGES.map(|delta| {
        parts.begin(1.0, &format!("change of {} % D", 100.0 * delta));
        measure(plan, 13, n, delta, plan.by_scale(20, 4_000, 40_000))
    });
    let figure = Figure {
        id: "figure-13".into(),
        title: format!(
            "Steps of single queries, share of all queries, {} vertices. CTA ends at a gap of \
             {PAPER_GAP}, or goes to the end; feature focus counts portals",
            thousands(n as f64)
        ),
        x: axis("steps", false),
        y: axis("queries (%)", false),
        series: histograms(&results),
        references: Vec::new(),
    };
    let claims = vec![one_step(&results)];
    Finding { figures: vec![figure], tables: Vec::new(), claims }
}

fn histograms(results: &[Results; 2]) -> Vec<Series> {
    let mut series = Vec::new();
    for (until, name) in UNTIL.iter().enumerate() {
        let scratch = steps(&results[0], SCRATCH[until]);
        series.push(histogram(format!("{name}, from scratch"), &scratch));
        for (delta, results) in CHANGES.iter().zip(results) {
            let name = format!("{name}, change of {} % D", 100.0 * delta);
            series.push(histogram(name, &steps(results, REGION[until])));
        }
    }
    let name = format!("feature focus, change of {} % D", 100.0 * CHANGES[0]);
    series.push(histogram(name, &steps(&results[0], TRACKER)));
    series
}

/// The share of values at each number of steps, in per cent.
fn histogram(name: String, values: &[f64]) -> Series {
    let most = values.iter().copied().fold(0.0, f64::max) as u32;
    let bar = |steps: u32| {
        let count = values.iter().filter(|v| **v == f64::from(steps)).count();
        let y = 100.0 * count as f64 / values.len() as f64;
        Point { x: f64::from(steps), y, low: y, high: y, count }
    };
    series(name, (0..=most).map(bar).collect())
}

fn one_step(results: &[Results; 2]) -> Claim {
    let share = |results: &Results, who: usize| {
        let steps = steps(results, who);
        100.0 * steps.iter().filter(|s| **s <= 1.0).count() as f64 / steps.len() as f64
    };
    let mean = |results: &Results, who: usize| mean_and_deviation(&steps(results, who))[0];
    let shares = results.each_ref().map(|r| share(r, REGION[0]));
    let text = |until: usize| {
        let [one, quarter] = results;
        format!(
            "{:.1} % of the queries take one step at 1 %, {:.1} % at 0.25 %; on average {:.1} and \
             {:.1} steps, from scratch {:.1}",
            share(one, REGION[until]),
            share(quarter, REGION[until]),
            mean(one, REGION[until]),
            mean(quarter, REGION[until]),
            mean(one, SCRATCH[until])
        )
    };
    claim(
        "With initialisation single queries take no more than one step, at a change of 1 % and of \
         0.25 % of the diameter.",
        format!("To a gap of {PAPER_GAP}, for the verdict: {}. To the end: {}.", text(0), text(1)),
        shares.iter().all(|share| *share > 0.0),
        || {
            format!(
                "No query ended after one step at one of the changes. A step ends the minimisation \
                 only if both bounds meet to within {PAPER_GAP} of the bodies' extent."
            )
        },
    )
}

/// The changes of figure 14, in diameters.
const DELTAS: [f64; 7] = [0.000_625, 0.001_25, 0.002_5, 0.005, 0.01, 0.02, 0.05];

fn average(plan: &Plan, progress: &mut dyn Progress) -> Finding {
    let sizes: Vec<_> = plan.sizes().iter().copied().filter(|n| *n < 100_000).collect();
    let mut parts = Parts::new(progress, shares(&sizes));
    let curves: Vec<_> = sizes
        .iter()
        .map(|&n| {
            parts.begin(share(n), &format!("{} vertices", thousands(n as f64)));
            let blocks = plan.by_scale(20, 1_000, 10_000);
            Curves::new(n, &DELTAS.map(|delta| measure(plan, 14, n, delta, blocks)))
        })
        .collect();
    let ids = ["figure-14", "figure-14-end"];
    let figures = (0..2).map(|until| figure(ids[until], until, &curves)).collect();
    let claims = (0..2).map(|until| fewer(until, &curves)).collect();
    Finding { figures, tables: Vec::new(), claims }
}

/// Steps against the change, at one size.
struct Curves {
    n: f64,
    /// By [`UNTIL`].
    region: [Vec<Point>; 2],
    tracker: Vec<Point>,
    /// Steps from scratch, on average over all changes.
    scratch: [f64; 2],
}

impl Curves {
    fn new(n: usize, results: &[Results]) -> Self {
        let points = |who: usize| {
            let point = |(delta, r): (&f64, &Results)| Point::mean(100.0 * delta, &steps(r, who));
            DELTAS.iter().zip(results).map(point).collect()
        };
        let scratch = |who: usize| {
            let all: Vec<_> = results.iter().flat_map(|r| steps(r, who)).collect();
            mean_and_deviation(&all)[0]
        };
        Self {
            n: n as f64,
            region: REGION.map(points),
            tracker: points(TRACKER),
            scratch: SCRATCH.map(scratch),
        }
    }
}

fn figure(id: &str, until: usize, curves: &[Curves]) -> Figure {
    let at_size = |what: &str, c: &Curves| format!("{what}, {} vertices", thousands(c.n));
    let mut lines: Vec<_> =
        curves.iter().map(|c| series(at_size(UNTIL[until], c), c.region[until].clone())).collect();
    let tracker = |c: &Curves| series(at_size("feature focus (portals)", c), c.tracker.clone());
    lines.extend(curves.last().map(tracker));
    let scratch = |c: &Curves| {
        let at = DELTAS.iter().map(|delta| 100.0 * delta);
        reference(&at_size("from scratch", c), at, |_| c.scratch[until])
    };
    let ends = ["down to a gap of 0.01", "to the end"];
    Figure {
        id: id.into(),
        title: format!(
            "Steps with initialisation, CTA {}, mean and standard deviation",
            ends[until]
        ),
        x: axis("change of the configuration (% D)", true),
        y: axis("steps", false),
        series: lines,
        references: curves.first().into_iter().chain(curves.last()).map(scratch).collect(),
    }
}

/// Whether steps nowhere rise by more than chance when the change becomes smaller, at the smallest
/// change are fewer than at the largest, and up to a change of 1 % fewer than from scratch.
fn fewer(until: usize, curves: &[Curves]) -> Claim {
    let falls = |c: &Curves| {
        let points = &c.region[until];
        let rises = points.windows(2).any(|w| w[0].y > w[1].y + 3.0 * standard_error(&w[0]));
        let fewer = |p: &Point| p.x > 1.0 || p.y < c.scratch[until];
        let ends = [points.first(), points.last()].map(|p| p.map_or(f64::NAN, |p| p.y));
        !rises && ends[0] < ends[1] && points.iter().all(fewer)
    };
    let text: Vec<_> = curves
        .iter()
        .map(|c| {
            let steps: Vec<_> =
                c.region[until].iter().map(|p| format!("{:.2} at {} %", p.y, p.x)).collect();
            let n = thousands(c.n);
            format!("{n} vertices: {}, {:.2} from scratch", steps.join(", "), c.scratch[until])
        })
        .collect();
    let statement = format!(
        "Average steps of {} fall with the change of the configuration, at every size, and stay \
         below those from scratch.",
        UNTIL[until]
    );
    claim(&statement, format!("{}.", text.join("; ")), curves.iter().all(falls), || {
        let not: Vec<_> = curves.iter().filter(|c| !falls(c)).map(|c| thousands(c.n)).collect();
        format!(
            "Not at {} vertices: beyond three standard errors, steps rise somewhere when the \
             change falls, or exceed those from scratch.",
            not.join(", ")
        )
    })
}

/// Of a mean, whose spread is the standard deviation.
fn standard_error(mean: &Point) -> f64 {
    (mean.high - mean.y) / (mean.count as f64).sqrt()
}
