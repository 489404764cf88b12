//! Figures 13 and 14: the savings of starting from the solution of a similar configuration.

use colltrans::cta;

use super::{
    Coherence, Race, Results, grouped_digits, in_passes, new_axis, new_series, reference_curve,
    sample_means,
};
use crate::Experiment;
use crate::claims::{Claim, Reason, judged};
use crate::finding::{Figure, Finding, Point, Table};
use crate::plan::{Plan, Progress};
use crate::settings::{MOTIONS, Meeting, Setting};
use crate::shapes::Kind;
use crate::solvers::{PAPER_GAP, Until, Who};
use crate::statistics::{Estimate, Sample, estimate, mean, short};

pub(super) const FIGURE_13: Experiment = Experiment {
    id: "figure-13",
    title: "steps along sequences, with and without initialisation",
    seconds: [1.0, 4.0],
    run: sequence_experiment,
};

pub(super) const FIGURE_14: Experiment = Experiment {
    id: "figure-14",
    title: "average steps with initialisation against change and size",
    seconds: [9.0, 40.0],
    run: average,
};

const WHO: [Who; 5] = [
    Who::Cta(Until::End),
    Who::Cta(Until::Near),
    Who::CtaRegion(cta::Region::Automatic, Until::End),
    Who::CtaRegion(cta::Region::Automatic, Until::Near),
    Who::Tracker,
];
const SCRATCH: [usize; 2] = [0, 1];
const REGION: [usize; 2] = [2, 3];
const TRACKER: usize = 4;

/// Names of both stages at which steps are counted: see [`Until`].
const UNTIL: [&str; 2] = ["CTA", "hybrid (to a gap of 1 %)"];
const END: usize = 0;
const HYBRID: usize = 1;

/// Changes of figure 13, in diameters.
const CHANGES: [f64; 2] = [0.01, 0.0025];

/// Number of configurations in a sequence.
const CONFIGURATIONS: usize = 100;

/// Sequences of each motion, for both changes.
type Sequences = [[Results; MOTIONS.len()]; 2];

fn sequence_experiment(plan: &Plan, progress: &mut dyn Progress) -> Finding {
    let n = plan.size(12_800);
    let items: Vec<_> = (0..2).flat_map(|c| (0..MOTIONS.len()).map(move |m| (c, m))).collect();
    let told = |&(change, motion): &(usize, usize)| {
        (n, format!("change of {} % D, {:?}", 100.0 * CHANGES[change], MOTIONS[motion]))
    };
    let mut measured = in_passes(plan, progress, &items, told, |&(change, motion), pass| {
        let race = Race {
            plan,
            figure: 13,
            kind: Kind::Balanced,
            n,
            given: None,
            who: &WHO,
            coherence: Coherence::Blocks,
            length: 1 + plan.by_scale(20, CONFIGURATIONS, CONFIGURATIONS),
            blocks: plan.by_scale(2, 6, 10),
        };
        race.run(pass, (MOTIONS.len() * change + motion) as u64, |bodies, count, random| {
            Setting::sequence_of(bodies, MOTIONS[motion], CHANGES[change], count, random)
        })
    })
    .into_iter();
    let all: Sequences =
        CHANGES.map(|_| MOTIONS.map(|_| measured.next().expect("one of every item")));
    let figures = (0..2).map(|change| sequence_figure(n, change, &all[change][0])).collect();
    let claims = vec![floor_claim(&all), adaptation_claim(&all), motions_claim(&all)];
    Finding { figures, tables: Vec::new(), claims }
}

/// Draws one sequence, query by query.
fn sequence_figure(n: usize, change: usize, results: &Results) -> Figure {
    let first = results.lanes[0].first().map(|m| m.group);
    let curve = |who: usize| {
        let lane = results.lanes[who].iter().filter(|m| Some(m.group) == first).zip(1..);
        let point = |(m, k): (&super::Measured, i32)| {
            let y = f64::from(m.work.steps);
            Point { x: f64::from(k), y, low: y, high: y, count: 1 }
        };
        lane.map(point).collect::<Vec<_>>()
    };
    let percent = 100.0 * CHANGES[change];
    let scratch = curve(SCRATCH[END]);
    // A single line from end to end, because the dashes of many short lines would merge.
    let at: Vec<_> = scratch.iter().take(1).chain(scratch.last()).map(|p| p.x).collect();
    Figure {
        id: ["figure-13-1", "figure-13-0.25"][change].into(),
        title: format!(
            "Steps of CTA along one sequence, {} vertices, a change of {percent} % D from query to query",
            grouped_digits(n as f64)
        ),
        x: new_axis("query of the sequence", false),
        y: new_axis("steps", false),
        series: vec![
            new_series("without initialisation", scratch),
            new_series("with initialisation (region focus)", curve(REGION[END])),
        ],
        references: vec![reference_curve("the floor: one step", at.into_iter(), |_| 1.0)],
    }
}

/// Returns the steps of all motions for a change.
fn steps(all: &Sequences, change: usize, who: usize) -> Vec<Sample> {
    all[change].iter().map(|results| results.steps(who)).collect()
}

fn floor_claim(all: &Sequences) -> Claim {
    let share = |change: usize, until: usize| {
        estimate(&steps(all, change, REGION[until]), |s| {
            let all = s.concat();
            100.0 * all.iter().filter(|steps| **steps <= 1.0).count() as f64 / all.len() as f64
        })
    };
    let details = format!(
        "At a change of 1 %: {} %. Of the hybrid, to a gap of {PAPER_GAP}: {} % at 0.25 %, {} % at 1 %. \
         \"Several\" is taken as a quarter or more.",
        share(0, END),
        share(1, HYBRID),
        share(0, HYBRID)
    );
    judged("13-floor", vec![share(1, END)], details, || {
        Reason::Implementation.because(
            "One step is enough only where the best point of the first cell solves the problem.",
        )
    })
}

fn adaptation_claim(all: &Sequences) -> Claim {
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
        "Steps: {} from scratch, {} at a change of 1 %, {} at 0.25 %.",
        average(&scratch()),
        average(&one),
        average(&quarter)
    );
    let measured = vec![ratio(one.clone(), scratch()), ratio(quarter, one)];
    judged("13-adapts", measured, details, || {
        Reason::Implementation.because("Steps do not fall as they should.")
    })
}

fn motions_claim(all: &Sequences) -> Claim {
    let spread = |change: usize| {
        estimate(&steps(all, change, REGION[END]), |s| {
            let means = sample_means(s);
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
        "Steps at a change of 1 %: {}. At 0.25 % the factor is {}.",
        text.join(", "),
        spread(1)
    );
    let counts = format!("Steps at a change of 1 %: {}.", text.join(", "));
    judged("13-motion", vec![spread(0)], details, || {
        Reason::Sentence.because(format!(
            "A change is the same for points half a diameter from the axis; nearer ones move by less when a body \
             turns. {counts}"
        ))
    })
}

/// Changes of figure 14, in diameters, each about half of the next one.
const DELTAS: [f64; 7] = [0.000_625, 0.001_25, 0.002_5, 0.005, 0.01, 0.02, 0.04];

fn average(plan: &Plan, progress: &mut dyn Progress) -> Finding {
    let told = |&n: &usize| (n, format!("{} vertices", grouped_digits(n as f64)));
    let measured: Vec<_> = in_passes(plan, progress, plan.sizes(), told, |&n, pass| {
        DELTAS.map(|delta| measure_pairs(plan, n, delta, pass))
    });
    let at = |(n, results): (&usize, [Results; DELTAS.len()])| At { n: *n as f64, results };
    let measured: Vec<_> = plan.sizes().iter().zip(measured).map(at).collect();
    let ids = ["figure-14", "figure-14-near"];
    let figures = (0..2).map(|until| steps_figure(ids[until], until, &measured)).collect();
    let claims =
        vec![regularity_claim(&measured), single_step_claim(&measured), logarithm_claim(&measured)];
    Finding { figures, tables: vec![floors_table(&measured)], claims }
}

/// Measures pairs of configurations that differ by `delta`: the second one, after the first.
fn measure_pairs(plan: &Plan, n: usize, delta: f64, pass: u32) -> Results {
    let race = Race {
        plan,
        figure: 14,
        kind: Kind::Balanced,
        n,
        given: None,
        who: &WHO,
        coherence: Coherence::Blocks,
        length: 2,
        blocks: plan.by_scale(20, 150, if n < 20_000 { 300 } else { 200 }),
    };
    race.run(pass, (delta * 1e6) as u64, |bodies, count, random| {
        Setting::sequence(bodies, Meeting::Colliding, delta, count, random)
    })
}

/// Results at one size, by change.
struct At {
    n: f64,
    results: [Results; DELTAS.len()],
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

fn steps_figure(id: &str, until: usize, measured: &[At]) -> Figure {
    let at_size = |what: &str, at: &At| format!("{what}, {} vertices", grouped_digits(at.n));
    let mut lines: Vec<_> = measured
        .iter()
        .map(|at| new_series(at_size(UNTIL[until], at), at.points(REGION[until])))
        .collect();
    let tracker = |at: &At| new_series(at_size("feature focus (portals)", at), at.points(TRACKER));
    lines.extend(measured.last().map(tracker));
    let changes = || DELTAS.iter().map(|delta| 100.0 * delta);
    let scratch = |at: &At| {
        let y = at.mean(SCRATCH[until]);
        reference_curve(&at_size("from scratch", at), changes(), |_| y)
    };
    let mut references: Vec<_> =
        measured.first().into_iter().chain(measured.last()).map(scratch).collect();
    references.push(reference_curve("the paper's limit: one step", changes(), |_| 1.0));
    Figure {
        id: id.into(),
        title: format!("Steps with initialisation, {}, mean and quartiles", UNTIL[until]),
        x: new_axis("change of the configuration (% D)", true),
        y: new_axis("steps", false),
        series: lines,
        references,
    }
}

/// Estimates a number of the means at each size, combined over the sizes.
fn of_sizes(
    measured: &[At],
    who: usize,
    number: impl Fn(&[f64]) -> f64,
    over_sizes: impl Fn(&[f64]) -> f64,
) -> Estimate {
    let samples: Vec<_> = measured.iter().flat_map(|at| at.steps(who)).collect();
    estimate(&samples, |s| {
        let means = sample_means(s);
        let each: Vec<_> = means.chunks(DELTAS.len()).map(&number).collect();
        over_sizes(&each)
    })
}

fn steps_text(until: usize, measured: &[At]) -> String {
    let at = |at: &At| {
        let steps: Vec<_> = at
            .points(REGION[until])
            .iter()
            .map(|p| format!("{:.2} at {} %", p.y, short(p.x)))
            .collect();
        let scratch = at.mean(SCRATCH[until]);
        format!(
            "{} vertices: {}, {scratch:.2} from scratch",
            grouped_digits(at.n),
            steps.join(", ")
        )
    };
    format!("{}.", measured.iter().map(at).collect::<Vec<_>>().join("; "))
}

fn regularity_claim(measured: &[At]) -> Claim {
    let rise = |means: &[f64]| means.windows(2).map(|w| w[0] / w[1]).fold(0.0, f64::max);
    let most = |each: &[f64]| each.iter().copied().fold(0.0, f64::max);
    let [cta, hybrid] = REGION.map(|who| of_sizes(measured, who, rise, most));
    let details = format!("{} Of the hybrid the factor is {hybrid}.", steps_text(END, measured));
    judged("14-regular", vec![cta], details, || {
        Reason::Implementation.because("Steps rise somewhere when the change falls.")
    })
}

fn single_step_claim(measured: &[At]) -> Claim {
    let [cta, hybrid] = REGION.map(|who| of_sizes(measured, who, |means| means[0], mean));
    let details = format!(
        "Up to 1.25 is taken as very close to 1. The numbers are in the claim before. Of the hybrid: {hybrid}."
    );
    judged("14-one", vec![cta], details, || {
        Reason::Sentence.because(format!(
            "The minimisation ends only in the cell of the contact, and cells are the smaller the more vertices \
             there are: at the smallest change that takes {} steps in the smallest and {} in the largest bodies.",
            short(measured[0].points(REGION[END])[0].y),
            short(measured[measured.len() - 1].points(REGION[END])[0].y)
        ))
    })
}

/// Judges `R^2` of the law above its floor, as the mean of all sizes.
fn logarithm_claim(measured: &[At]) -> Claim {
    let fit = of_sizes(measured, REGION[END], |means| Law::fitted(means).explained, mean);
    let straight = of_sizes(
        measured,
        REGION[END],
        |means| squared_correlation(&DELTAS.map(f64::ln), means),
        mean,
    );
    let floors: Vec<_> = measured.iter().map(|at| at.law().text(at.n)).collect();
    let details = format!(
        "Steps = 1 + b log2(change / floor) above the floor and 1 below, fitted to the means of each size; the mean of \
         R² over all sizes. {}. One line through all changes, the floor with them: R² {straight}.",
        floors.join("; ")
    );
    judged("14-log", vec![fit], details, || {
        Reason::Sentence.because(format!(
            "The curve is bent above its floor, too: when the change is halved steps fall by {} on average.",
            step_decreases(measured)
        ))
    })
}

/// The paper's estimate `log C - 2 log(1/gamma)`, above its minimum: steps are `1 + slope log2(change /
/// floor)`, and 1 below the floor.
#[derive(Debug, Clone, Copy)]
struct Law {
    /// The change, in diameters, below which one step is to be expected.
    floor: f64,
    slope: f64,
    /// Share of the variance that it explains.
    explained: f64,
}

impl Law {
    /// Fits the law by least squares over all floors on a fine grid; the slope for each has a closed form.
    fn fitted(means: &[f64]) -> Self {
        let average = mean(means);
        let all: f64 = means.iter().map(|y| (y - average).powi(2)).sum();
        let law = |k: i32| {
            let floor = 2.0_f64.powf(-24.0 + f64::from(k) / 16.0);
            let above = DELTAS.map(|delta| (delta / floor).log2().max(0.0));
            let sum = |f: &dyn Fn(f64, f64) -> f64| {
                above.iter().zip(means).map(|(x, y)| f(*x, *y)).sum::<f64>()
            };
            let slope = sum(&|x, y| x * (y - 1.0)) / sum(&|x, _| x * x).max(f64::MIN_POSITIVE);
            let left = sum(&|x, y| (y - 1.0 - slope * x).powi(2));
            Self { floor, slope, explained: 1.0 - left / all.max(f64::MIN_POSITIVE) }
        };
        let laws = (0..=16 * 20).map(law);
        laws.max_by(|a, b| a.explained.total_cmp(&b.explained)).unwrap_or_else(|| law(0))
    }

    fn text(&self, n: f64) -> String {
        let Self { floor, slope, explained } = self;
        format!(
            "{} vertices: floor {} % D, b {}, R² {explained:.3}",
            grouped_digits(n),
            two_digits(100.0 * floor),
            short(*slope)
        )
    }
}

/// Formats a small number with two digits.
fn two_digits(value: f64) -> String {
    let digits = (1.0 - value.abs().log10().floor()).clamp(0.0, 9.0) as usize;
    format!("{value:.digits$}")
}

impl At {
    fn law(&self) -> Law {
        Law::fitted(&sample_means(
            &self.steps(REGION[END]).iter().map(Sample::values).collect::<Vec<_>>(),
        ))
    }
}

/// Returns the table of the law and its floor at every size.
fn floors_table(measured: &[At]) -> Table {
    let row = |at: &At| {
        let Law { floor, slope, explained } = at.law();
        vec![
            grouped_digits(at.n),
            two_digits(100.0 * floor),
            short(slope),
            format!("{explained:.3}"),
        ]
    };
    Table {
        id: "figure-14-floors".into(),
        title: "Steps = 1 + b log2(change / floor), and 1 below the floor".into(),
        columns: ["vertices", "floor, % D", "b", "R²"].map(String::from).to_vec(),
        rows: measured.iter().map(row).collect(),
    }
}

/// Formats the decrease of steps at the largest and at the smallest changes.
fn step_decreases(measured: &[At]) -> String {
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

fn squared_correlation(xs: &[f64], ys: &[f64]) -> f64 {
    let [mx, my] = [xs, ys].map(mean);
    let sum = |f: &dyn Fn(f64, f64) -> f64| {
        xs.iter().zip(ys).map(|(x, y)| f(x - mx, y - my)).sum::<f64>()
    };
    sum(&|x, y| x * y).powi(2) / (sum(&|x, _| x * x) * sum(&|_, y| y * y)).max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A law is recovered with its floor, among the changes or below all of them.
    #[test]
    fn fit_recovers_law_and_floor() {
        for floor in [0.000_1, 0.001, 0.006] {
            let means = DELTAS.map(|delta: f64| 1.0 + 0.7 * (delta / floor).log2().max(0.0));
            let law = Law::fitted(&means);
            assert!((law.floor / floor - 1.0).abs() < 0.03, "{law:?}");
            assert!((law.slope - 0.7).abs() < 0.02 && law.explained > 0.999, "{law:?}");
        }
        // A square root of the change does not fit the law for any floor.
        let bent = Law::fitted(&DELTAS.map(|delta| 1.0 + 10.0 * delta.sqrt()));
        assert!(bent.explained < 0.94, "{bent:?}");
    }
}
