//! Figures 13 and 14: what it saves to start from the solution of a similar configuration.

use colltrans::Region;

use super::{
    Coherence, Parts, Race, Results, axis, claim, reference, series, share, shares, thousands,
};
use crate::Experiment;
use crate::contestants::{PAPER_GAP, Who};
use crate::finding::{Claim, Figure, Finding, Point, Series};
use crate::plan::{Plan, Progress};
use crate::settings::{Meeting, Setting};
use crate::shapes::Kind;
use crate::timing::{mean_and_deviation, mean_point};

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

const WHO: [Who; 3] = [Who::Cta, Who::CtaRegion(Region::Automatic), Who::Tracker];
const CTA: usize = 0;
const REGION: usize = 1;
const TRACKER: usize = 2;

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
        measure(plan, 13, n, delta, plan.by_scale(20, 1_500, 10_000))
    });
    let figure = Figure {
        id: "figure-13".into(),
        title: format!(
            "Steps of single queries, share of all queries, {} vertices, CTA to a gap of {PAPER_GAP} \
             (feature focus counts portals)",
            thousands(n as f64)
        ),
        x: axis("steps", false),
        y: axis("queries (%)", false),
        series: vec![
            histogram("CTA from scratch".into(), &steps(&results[0], CTA)),
            histogram("CTA, change of 1 % D".into(), &steps(&results[0], REGION)),
            histogram("CTA, change of 0.25 % D".into(), &steps(&results[1], REGION)),
            histogram("feature focus, 1 % D".into(), &steps(&results[0], TRACKER)),
            histogram("feature focus, 0.25 % D".into(), &steps(&results[1], TRACKER)),
        ],
        references: Vec::new(),
    };
    let claims = vec![one_step(&results)];
    Finding { figures: vec![figure], tables: Vec::new(), claims }
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
    let share = |results: &Results| {
        let steps = steps(results, REGION);
        steps.iter().filter(|s| **s <= 1.0).count() as f64 / steps.len() as f64
    };
    let shares = results.each_ref().map(share);
    let means = results.each_ref().map(|r| mean_and_deviation(&steps(r, REGION))[0]);
    let least = results.each_ref().map(|r| steps(r, REGION).into_iter().fold(f64::NAN, f64::min));
    claim(
        "With initialisation single queries need no more than one step, at a change of 1 % and of \
         0.25 % of the diameter.",
        format!(
            "One step: {:.1} % of the queries at 1 %, {:.1} % at 0.25 %. On average {:.1} and {:.1} \
             steps, from scratch {:.1}.",
            100.0 * shares[0],
            100.0 * shares[1],
            means[0],
            means[1],
            mean_and_deviation(&steps(&results[0], CTA))[0]
        ),
        shares.iter().all(|share| *share > 0.0),
        || {
            format!(
                "The fewest steps are {:.0} and {:.0}. A step ends the minimisation only if upper and \
                 lower bound meet to within {PAPER_GAP} of the bodies' extent, and one linear piece \
                 bounds all of the square from below by its gradient times the square's side.",
                least[0], least[1]
            )
        },
    )
}

/// The changes of figure 14, in diameters.
const DELTAS: [f64; 7] = [0.000_625, 0.001_25, 0.002_5, 0.005, 0.01, 0.02, 0.05];

fn average(plan: &Plan, progress: &mut dyn Progress) -> Finding {
    let sizes: Vec<_> = plan.sizes().iter().copied().filter(|n| *n < 100_000).collect();
    let mut parts = Parts::new(progress, shares(&sizes));
    let mut curves = Vec::new();
    for &n in &sizes {
        parts.begin(share(n), &format!("{} vertices", thousands(n as f64)));
        let blocks = plan.by_scale(20, 250, 2_000);
        let results = DELTAS.map(|delta| measure(plan, 14, n, delta, blocks));
        curves.push(Curve::new(n, &results));
    }
    let mut series: Vec<_> = curves
        .iter()
        .map(|c| series(format!("CTA, {} vertices", thousands(c.n)), c.region.clone()))
        .collect();
    if let Some(last) = curves.last() {
        let name = format!("feature focus (portals), {} vertices", thousands(last.n));
        series.push(super::series(name, last.tracker.clone()));
    }
    let references = curves
        .iter()
        .map(|c| {
            let name = format!("from scratch, {} vertices", thousands(c.n));
            reference(&name, DELTAS.iter().map(|d| 100.0 * d), |_| c.scratch)
        })
        .collect();
    let figure = Figure {
        id: "figure-14".into(),
        title: format!(
            "Steps with initialisation, CTA to a gap of {PAPER_GAP}, mean and standard deviation"
        ),
        x: axis("change of the configuration (% D)", true),
        y: axis("steps", false),
        series,
        references,
    };
    Finding { figures: vec![figure], tables: Vec::new(), claims: vec![fewer(&curves)] }
}

/// Steps against the change, at one size.
struct Curve {
    n: f64,
    region: Vec<Point>,
    tracker: Vec<Point>,
    /// Steps from scratch, on average over all.
    scratch: f64,
}

impl Curve {
    fn new(n: usize, results: &[Results]) -> Self {
        let points = |who: usize| {
            let point = |(delta, r): (&f64, &Results)| mean_point(100.0 * delta, &steps(r, who));
            DELTAS.iter().zip(results).map(point).collect()
        };
        let scratch: Vec<_> = results.iter().flat_map(|r| steps(r, CTA)).collect();
        Self {
            n: n as f64,
            region: points(REGION),
            tracker: points(TRACKER),
            scratch: mean_and_deviation(&scratch)[0],
        }
    }
}

/// Whether at every size the least change takes the fewest steps, and no change up to 1 % takes
/// more than from scratch.
fn fewer(curves: &[Curve]) -> Claim {
    let at = |c: &Curve, delta: f64| {
        c.region.iter().find(|p| p.x == 100.0 * delta).map_or(f64::NAN, |p| p.y)
    };
    let falls = |c: &Curve| {
        let least = at(c, DELTAS[0]);
        c.region[1..].iter().all(|p| least <= p.y) && at(c, 0.01) < c.scratch
    };
    let text: Vec<_> = curves
        .iter()
        .map(|c| {
            format!(
                "{} vertices: {:.1} at {} %, {:.1} at 1 %, {:.1} at {} %, {:.1} from scratch",
                thousands(c.n),
                at(c, DELTAS[0]),
                100.0 * DELTAS[0],
                at(c, 0.01),
                at(c, DELTAS[6]),
                100.0 * DELTAS[6],
                c.scratch
            )
        })
        .collect();
    claim(
        "Average steps fall with the change of the configuration, at every size, and stay below \
         those from scratch.",
        format!("{}.", text.join("; ")),
        curves.iter().all(falls),
        || {
            let failing: Vec<_> =
                curves.iter().filter(|c| !falls(c)).map(|c| thousands(c.n)).collect();
            format!(
                "Not at {} vertices. From scratch, steps to a gap of {PAPER_GAP} depend little on \
                 the size; a square around the last solution saves the first halvings of the region \
                 and costs extra steps where the solution has left it.",
                failing.join(", ")
            )
        },
    )
}
