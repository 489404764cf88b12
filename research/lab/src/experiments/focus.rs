//! Figures 13 and 14: what it saves to start from the solution of a similar configuration.

use colltrans::Region;

use super::{
    Coherence, Parts, Race, Results, axis, means, reference, series, share, shares, thousands,
};
use crate::Experiment;
use crate::claims::{Claim, judged};
use crate::finding::{Figure, Finding, Point};
use crate::plan::{Plan, Progress};
use crate::settings::{MOTIONS, Meeting, Setting};
use crate::shapes::Kind;
use crate::solvers::{PAPER_GAP, Until, Who};
use crate::statistics::{Estimate, Sample, estimate, mean, short};

pub(super) const FIGURE_13: Experiment = Experiment {
    id: "figure-13",
    title: "steps along sequences, with and without initialisation",
    run: sequences,
};

pub(super) const FIGURE_14: Experiment = Experiment {
    id: "figure-14",
    title: "average steps with initialisation against change and size",
    run: average,
};

const WHO: [Who; 5] = [
    Who::Cta(Until::End),
    Who::Cta(Until::Near),
    Who::CtaRegion(Region::Automatic, Until::End),
    Who::CtaRegion(Region::Automatic, Until::Near),
    Who::Tracker,
];
const SCRATCH: [usize; 2] = [0, 1];
const REGION: [usize; 2] = [2, 3];
const TRACKER: usize = 4;

/// Names of both ways to count: see [`Until`].
const UNTIL: [&str; 2] = ["to the end", "to a gap of 1 %"];
const END: usize = 0;

/// The changes of figure 13, in diameters.
const CHANGES: [f64; 2] = [0.01, 0.0025];

/// Configurations in a sequence.
const CONFIGURATIONS: usize = 100;

/// Sequences of each motion, at both changes.
type Sequences = [[Results; MOTIONS.len()]; 2];

fn sequences(plan: &Plan, progress: &mut dyn Progress) -> Finding {
    let n = plan.size(12_800);
    let mut parts = Parts::new(progress, 6.0);
    let all: Sequences = [0, 1].map(|change| {
        [0, 1, 2].map(|motion| {
            let delta = CHANGES[change];
            parts.begin(1.0, &format!("change of {} % D, {:?}", 100.0 * delta, MOTIONS[motion]));
            let race = Race {
                plan,
                figure: 13,
                kind: Kind::Balanced,
                n,
                given: None,
                who: &WHO,
                coherence: Coherence::Blocks,
                length: 1 + plan.by_scale(20, CONFIGURATIONS, CONFIGURATIONS),
                blocks: plan.by_scale(2, 24, 120),
            };
            race.run((3 * change + motion) as u64, |bodies, count, random| {
                Setting::sequence_of(bodies, MOTIONS[motion], delta, count, random)
            })
        })
    });
    let figures = (0..2).map(|change| sequence_figure(n, change, &all[change][0])).collect();
    let claims = vec![floor(&all), adapts(&all), motions(&all)];
    Finding { figures, tables: Vec::new(), claims }
}

/// One sequence, query by query.
fn sequence_figure(n: usize, change: usize, results: &Results) -> Figure {
    let first = results.lanes[0].first().map_or(0, |m| m.group);
    let curve = |who: usize| {
        let lane = results.lanes[who].iter().filter(|m| m.group == first).zip(1..);
        let point = |(m, k): (&super::Measured, i32)| {
            let y = f64::from(m.work.steps);
            Point { x: f64::from(k), y, low: y, high: y, count: 1 }
        };
        lane.map(point).collect::<Vec<_>>()
    };
    let percent = 100.0 * CHANGES[change];
    let scratch = curve(SCRATCH[END]);
    // From end to end: dashes of many short pieces would flow together.
    let at: Vec<_> = scratch.iter().take(1).chain(scratch.last()).map(|p| p.x).collect();
    Figure {
        id: ["figure-13-1", "figure-13-0.25"][change].into(),
        title: format!(
            "Steps along one sequence, {} vertices, a change of {percent} % D from query to query, \
             CTA to the end",
            thousands(n as f64)
        ),
        x: axis("query of the sequence", false),
        y: axis("steps", false),
        series: vec![
            series("without initialisation", scratch),
            series("with initialisation (region focus)", curve(REGION[END])),
        ],
        references: vec![reference("the floor: one step", at.into_iter(), |_| 1.0)],
    }
}

/// The steps of all motions at a change.
fn steps(all: &Sequences, change: usize, who: usize) -> Vec<Sample> {
    all[change].iter().map(|results| results.steps(who)).collect()
}

fn floor(all: &Sequences) -> Claim {
    let share = |change: usize, until: usize| {
        estimate(&steps(all, change, REGION[until]), |s| {
            let all = s.concat();
            100.0 * all.iter().filter(|steps| **steps <= 1.0).count() as f64 / all.len() as f64
        })
    };
    let details = format!(
        "To the end. At a change of 1 %: {} %. To a gap of {PAPER_GAP}: {} % at 0.25 %, {} % at 1 %. \
         \"Several\" is taken as a tenth or more.",
        share(0, END),
        share(1, 1),
        share(0, 1)
    );
    judged("13-floor", vec![share(1, END)], details, || {
        "One step is enough only where the best point of the first cell solves the problem.".into()
    })
}

fn adapts(all: &Sequences) -> Claim {
    let ratio = |above: Vec<Sample>, below: Vec<Sample>| {
        estimate(&[above, below].concat(), |s| {
            let (above, below) = s.split_at(MOTIONS.len());
            mean(&above.concat()) / mean(&below.concat())
        })
    };
    let [one, quarter] = [0, 1].map(|change| steps(all, change, REGION[END]));
    let scratch = || steps(all, 0, SCRATCH[END]);
    let average = |samples: &[Sample]| {
        short(mean(&samples.iter().flat_map(Sample::values).collect::<Vec<_>>()))
    };
    let details = format!(
        "Steps to the end: {} from scratch, {} at a change of 1 %, {} at 0.25 %.",
        average(&scratch()),
        average(&one),
        average(&quarter)
    );
    let measured = vec![ratio(one.clone(), scratch()), ratio(quarter, one)];
    judged("13-adapts", measured, details, || "Steps do not fall as they should.".into())
}

fn motions(all: &Sequences) -> Claim {
    let spread = |change: usize| {
        estimate(&steps(all, change, REGION[END]), |s| {
            let means = means(s);
            means.iter().copied().fold(0.0, f64::max)
                / means.iter().copied().fold(f64::INFINITY, f64::min)
        })
    };
    let text: Vec<_> = MOTIONS
        .iter()
        .zip(steps(all, 0, REGION[END]))
        .map(|(motion, sample)| format!("{motion:?} {}", short(mean(&sample.values()))))
        .collect();
    let details = format!(
        "Steps to the end at a change of 1 %: {}. At 0.25 % the factor is {}.",
        text.join(", "),
        spread(1)
    );
    judged("13-motion", vec![spread(0)], details, || "For reasons that were not measured.".into())
}

/// The changes of figure 14, in diameters, each about half of the next.
const DELTAS: [f64; 7] = [0.000_625, 0.001_25, 0.002_5, 0.005, 0.01, 0.02, 0.04];

fn average(plan: &Plan, progress: &mut dyn Progress) -> Finding {
    let sizes: Vec<_> = plan.sizes().iter().copied().filter(|n| *n < 100_000).collect();
    let mut parts = Parts::new(progress, shares(&sizes));
    let measured: Vec<_> = sizes
        .iter()
        .map(|&n| {
            parts.begin(share(n), &format!("{} vertices", thousands(n as f64)));
            At { n: n as f64, results: DELTAS.map(|delta| pairs(plan, n, delta)).into() }
        })
        .collect();
    let ids = ["figure-14", "figure-14-near"];
    let figures = (0..2).map(|until| figure(ids[until], until, &measured)).collect();
    let claims = vec![
        regular("14-regular", 0, &measured),
        one("14-one", 0, &measured),
        logarithmic(&measured),
        regular("14-regular-near", 1, &measured),
        one("14-one-near", 1, &measured),
    ];
    Finding { figures, tables: Vec::new(), claims }
}

/// Pairs of configurations that differ by `delta`: the second is measured, after the first.
fn pairs(plan: &Plan, n: usize, delta: f64) -> Results {
    let race = Race {
        plan,
        figure: 14,
        kind: Kind::Balanced,
        n,
        given: None,
        who: &WHO,
        coherence: Coherence::Blocks,
        length: 2,
        blocks: plan.by_scale(20, 800, 6_000),
    };
    race.run((delta * 1e6) as u64, |bodies, count, random| {
        Setting::sequence(bodies, Meeting::Colliding, delta, count, random)
    })
}

/// What was measured at one size, by change.
struct At {
    n: f64,
    results: Vec<Results>,
}

impl At {
    fn steps(&self, who: usize) -> Vec<Sample> {
        self.results.iter().map(|r| r.steps(who)).collect()
    }

    fn points(&self, who: usize) -> Vec<Point> {
        let point = |(delta, s): (&f64, Sample)| Point::mean(100.0 * delta, &s.values());
        DELTAS.iter().zip(self.steps(who)).map(point).collect()
    }

    fn mean(&self, who: usize) -> f64 {
        mean(&self.steps(who).iter().flat_map(Sample::values).collect::<Vec<_>>())
    }
}

fn figure(id: &str, until: usize, measured: &[At]) -> Figure {
    let at_size = |what: &str, at: &At| format!("{what}, {} vertices", thousands(at.n));
    let mut lines: Vec<_> =
        measured.iter().map(|at| series(at_size("CTA", at), at.points(REGION[until]))).collect();
    let tracker = |at: &At| series(at_size("feature focus (portals)", at), at.points(TRACKER));
    lines.extend(measured.last().map(tracker));
    let changes = || DELTAS.iter().map(|delta| 100.0 * delta);
    let scratch = |at: &At| {
        let y = at.mean(SCRATCH[until]);
        reference(&at_size("from scratch", at), changes(), |_| y)
    };
    let mut references: Vec<_> =
        measured.first().into_iter().chain(measured.last()).map(scratch).collect();
    references.push(reference("the paper's limit: one step", changes(), |_| 1.0));
    Figure {
        id: id.into(),
        title: format!("Steps with initialisation, CTA {}, mean and quartiles", UNTIL[until]),
        x: axis("change of the configuration (% D)", true),
        y: axis("steps", false),
        series: lines,
        references,
    }
}

/// All samples, size by size, and a number of the means at each size.
fn of_sizes(
    measured: &[At],
    who: usize,
    number: impl Fn(&[f64]) -> f64,
    over_sizes: impl Fn(&[f64]) -> f64,
) -> Estimate {
    let samples: Vec<_> = measured.iter().flat_map(|at| at.steps(who)).collect();
    estimate(&samples, |s| {
        let means = means(s);
        let each: Vec<_> = means.chunks(DELTAS.len()).map(&number).collect();
        over_sizes(&each)
    })
}

fn text(until: usize, measured: &[At]) -> String {
    let at = |at: &At| {
        let steps: Vec<_> = at
            .points(REGION[until])
            .iter()
            .map(|p| format!("{:.2} at {} %", p.y, short(p.x)))
            .collect();
        let scratch = at.mean(SCRATCH[until]);
        format!("{} vertices: {}, {scratch:.2} from scratch", thousands(at.n), steps.join(", "))
    };
    format!("{}.", measured.iter().map(at).collect::<Vec<_>>().join("; "))
}

fn regular(id: &str, until: usize, measured: &[At]) -> Claim {
    let rise = |means: &[f64]| means.windows(2).map(|w| w[0] / w[1]).fold(0.0, f64::max);
    let most = |each: &[f64]| each.iter().copied().fold(0.0, f64::max);
    let largest = of_sizes(measured, REGION[until], rise, most);
    judged(id, vec![largest], text(until, measured), || {
        "Steps rise somewhere when the change falls.".into()
    })
}

fn one(id: &str, until: usize, measured: &[At]) -> Claim {
    let least = of_sizes(measured, REGION[until], |means| means[0], mean);
    let details = "Up to 1.5 is taken as very close to 1. The numbers are in the claim before.";
    judged(id, vec![least], details.into(), || {
        format!(
            "The minimisation ends only in the cell of the contact: at the smallest change that takes {} \
             steps in the smallest and {} in the largest bodies.",
            short(measured[0].points(REGION[until])[0].y),
            short(measured[measured.len() - 1].points(REGION[until])[0].y)
        )
    })
}

/// `R^2` of a line through steps against the logarithm of the change, the mean of all sizes.
fn logarithmic(measured: &[At]) -> Claim {
    let fit = of_sizes(measured, REGION[END], squared_correlation, mean);
    let details = "The mean over all sizes. The numbers are in the claim before.";
    judged("14-log", vec![fit], details.into(), || {
        let ends = falls(measured);
        format!("The curve is bent: when the change is halved steps fall by {ends} on average.")
    })
}

/// By how much steps fall at the largest and at the smallest changes.
fn falls(measured: &[At]) -> String {
    let fall = |k: usize| {
        let each = measured.iter().map(|at| {
            let points = at.points(REGION[END]);
            points[k].y - points[k - 1].y
        });
        short(mean(&each.collect::<Vec<_>>()))
    };
    format!(
        "{} from {} % and by {} from {} %",
        fall(DELTAS.len() - 1),
        100.0 * DELTAS[DELTAS.len() - 1],
        fall(1),
        100.0 * DELTAS[1]
    )
}

fn squared_correlation(means: &[f64]) -> f64 {
    let logs = DELTAS.map(f64::ln);
    let [mx, my] = [mean(&logs), mean(means)];
    let sum = |f: &dyn Fn(f64, f64) -> f64| {
        logs.iter().zip(means).map(|(x, y)| f(x - mx, y - my)).sum::<f64>()
    };
    sum(&|x, y| x * y).powi(2) / (sum(&|x, _| x * x) * sum(&|_, y| y * y)).max(f64::MIN_POSITIVE)
}
