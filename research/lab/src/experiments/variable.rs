//! Figure 19: variable coherence, and what a wrong parameter costs, beside H-Walk.
//!
//! Notation. *High* coherence is up to half a degree a step, *low* coherence more than 30 degrees. An
//! algorithm's *parameter* runs from strong to weak initialisation: the half-side `delta` of CTA's
//! square, from a thousandth of a diameter to all levels; the layer `l` of H-Walk's hierarchy where
//! features are picked, from the finest to the coarsest. Costs are iterations of all loops.

use colltrans::Region;

use super::{Coherence, Parts, Race, Results, axis, means, series, share, shares, thousands, time};
use crate::Experiment;
use crate::claims::{Claim, judged};
use crate::finding::{Figure, Finding, Point, Table};
use crate::plan::{Plan, Progress};
use crate::settings::Setting;
use crate::shapes::Kind;
use crate::solvers::{Until, Who};
use crate::statistics::{Estimate, Sample, estimate, mean, short};
use colltrans_testkit::timing::{mean_and_deviation, median};

pub(super) const FIGURE_19: Experiment = Experiment {
    id: "figure-19",
    title: "variable coherence and wrong parameters, beside H-Walk",
    run,
};

/// The paper's degrees per step of the orbits, from high to low coherence.
const ALPHAS_DEG: [f64; 12] =
    [0.1, 0.5, 1.0, 2.0, 5.0, 10.0, 30.0, 60.0, 90.0, 120.0, 150.0, 180.0];
/// Those of high and of low coherence.
const HIGH: std::ops::Range<usize> = 0..2;
const LOW: std::ops::Range<usize> = 7..12;

/// Half-sides of the square, in diameters; the last is all levels.
const HALF_SIDES: [f64; 6] = [0.001, 0.01, 0.05, 0.2, 0.5, 1.0];

/// Layers, as shares of the way from the finest to the coarsest.
const LAYERS: [f64; 6] = [0.0, 0.2, 0.4, 0.6, 0.8, 1.0];

const PARAMETERS: usize = HALF_SIDES.len();

/// One algorithm with each of its parameters at each coherence.
struct Sweep<'r> {
    results: &'r [Results],
    /// Its first lane.
    first: usize,
}

/// Both at one size.
struct Sweeps {
    n: f64,
    /// By coherence.
    results: Vec<Results>,
}

fn run(plan: &Plan, progress: &mut dyn Progress) -> Finding {
    let sizes = plan.by_scale([50, 200], [800, 3_200], [800, 3_200]);
    let mut parts = Parts::new(progress, ALPHAS_DEG.len() as f64 * shares(&sizes));
    let sweeps = sizes.map(|n| sweep(plan, n, &mut parts));
    let figures = sweeps.iter().flat_map(|s| [s.figure("CTA"), s.figure("H-Walk")]).collect();
    let claims = vec![
        affects(&sweeps),
        strong(&sweeps),
        worsens("19-worsening-800", &sweeps[0]),
        worsens("19-worsening-3200", &sweeps[1]),
        disperses("19-dispersion-high", &sweeps, HIGH),
        disperses("19-dispersion-low", &sweeps, LOW),
    ];
    Finding { figures, tables: sweeps.iter().map(Sweeps::table).collect(), claims }
}

fn sweep(plan: &Plan, n: usize, parts: &mut Parts) -> Sweeps {
    let mut who: Vec<_> = HALF_SIDES.map(|h| Who::CtaRegion(Region::Fixed(h), Until::End)).to_vec();
    who.extend(LAYERS.map(Who::HWalk));
    let race = |alpha: &f64| {
        parts.begin(share(n), &format!("{} vertices, {alpha} degrees", thousands(n as f64)));
        let race = Race {
            plan,
            figure: 19,
            kind: Kind::Spheres,
            n,
            given: None,
            who: &who,
            coherence: Coherence::Blocks,
            length: 1 + plan.by_scale(10, 50, 100),
            blocks: plan.by_scale(3, 24, 120),
        };
        race.run((alpha * 1e3) as u64, |bodies, count, random| {
            Setting::orbit(bodies, *alpha, count, random)
        })
    };
    Sweeps { n: n as f64, results: ALPHAS_DEG.iter().map(race).collect() }
}

impl Sweeps {
    fn both(&self) -> [Sweep<'_>; 2] {
        [0, PARAMETERS].map(|first| Sweep { results: &self.results, first })
    }

    fn figure(&self, name: &str) -> Figure {
        let [cta, walk] = self.both();
        let is_cta = name == "CTA";
        let sweep = if is_cta { cta } else { walk };
        let line = |parameter: usize| {
            let points = ALPHAS_DEG
                .iter()
                .enumerate()
                .map(|(k, alpha)| Point::mean(*alpha, &sweep.costs(k, parameter).values()))
                .collect();
            let what = if is_cta {
                format!("half-side {} D", HALF_SIDES[parameter])
            } else {
                let share = 100.0 * LAYERS[parameter];
                format!("layer at {share:.0} % of all")
            };
            series(what, points)
        };
        Figure {
            id: format!("figure-19-{}-{}", name.to_lowercase().replace('-', ""), self.n),
            title: format!(
                "{name}, {} vertices: iterations by coherence and parameter, mean and quartiles",
                thousands(self.n)
            ),
            x: axis("degrees from query to query", true),
            y: axis("iterations", false),
            series: (0..PARAMETERS).map(line).collect(),
            references: Vec::new(),
        }
    }

    fn table(&self) -> Table {
        let mut rows = Vec::new();
        for (name, sweep) in ["CTA, half-side", "H-Walk, layer"].iter().zip(self.both()) {
            for k in 0..PARAMETERS {
                let parameter = if sweep.first == 0 { HALF_SIDES[k] } else { LAYERS[k] };
                let cell = |alpha: usize| time(median(&self.results[alpha].times(sweep.first + k)));
                let head = format!("{name} {parameter}");
                rows.push(std::iter::once(head).chain((0..ALPHAS_DEG.len()).map(cell)).collect());
            }
        }
        let columns = std::iter::once("algorithm and parameter".into())
            .chain(ALPHAS_DEG.iter().map(|alpha| format!("{alpha}°")))
            .collect();
        let title = format!(
            "Median time of a query, {} vertices, by degrees from query to query",
            thousands(self.n)
        );
        Table { id: format!("figure-19-times-{}", self.n), title, columns, rows }
    }
}

impl Sweep<'_> {
    fn costs(&self, alpha: usize, parameter: usize) -> Sample {
        self.results[alpha].sample(self.first + parameter, |m| f64::from(m.work.iterations))
    }

    /// The costs in a range of coherence, parameter by parameter at each.
    fn all(&self, alphas: std::ops::Range<usize>) -> Vec<Sample> {
        alphas.flat_map(|a| (0..PARAMETERS).map(move |p| self.costs(a, p))).collect()
    }
}

/// By how many per cent the mean of the worst parameter exceeds that of the best, on average over
/// the coherences.
fn worst_over_best(samples: &[Vec<f64>]) -> f64 {
    let each = samples.chunks(PARAMETERS).map(|of| {
        let means = means(of);
        let worst = means.iter().copied().fold(0.0, f64::max);
        100.0 * (worst / means.iter().copied().fold(f64::INFINITY, f64::min) - 1.0)
    });
    mean(&each.collect::<Vec<_>>())
}

/// Deviation over mean with the best parameter in per cent, on average over the coherences.
fn dispersion(samples: &[Vec<f64>]) -> f64 {
    let each = samples.chunks(PARAMETERS).map(|of| {
        let stats = of.iter().map(|values| mean_and_deviation(values));
        let best = stats.min_by(|a, b| a[0].total_cmp(&b[0]));
        best.map_or(f64::NAN, |[mean, deviation]| 100.0 * deviation / mean)
    });
    mean(&each.collect::<Vec<_>>())
}

/// A statistic of CTA and of H-Walk, and the first over the second.
fn of_both(
    sweeps: &Sweeps,
    alphas: std::ops::Range<usize>,
    statistic: fn(&[Vec<f64>]) -> f64,
) -> [Estimate; 3] {
    let [cta, walk] = sweeps.both().map(|sweep| sweep.all(alphas.clone()));
    let ratio = estimate(&[cta.clone(), walk.clone()].concat(), |s| {
        let (cta, walk) = s.split_at(s.len() / 2);
        statistic(cta) / statistic(walk)
    });
    [estimate(&cta, statistic), ratio, estimate(&walk, statistic)]
}

fn affects(sweeps: &[Sweeps; 2]) -> Claim {
    let [[cta, _, walk], [other_cta, _, other_walk]] =
        sweeps.each_ref().map(|s| of_both(s, HIGH, worst_over_best));
    let details = format!(
        "At {} vertices; at {}: {other_cta} % and {other_walk} %.",
        thousands(sweeps[0].n),
        thousands(sweeps[1].n)
    );
    judged("19-affects", vec![cta, walk], details, || {
        "The parameter changes the count by less than a fifth.".into()
    })
}

/// The mean with the strongest initialisation over that with the weakest, on average.
fn strongest_over_weakest(samples: &[Vec<f64>]) -> f64 {
    let each = samples.chunks(PARAMETERS).map(|of| mean(&of[0]) / mean(&of[PARAMETERS - 1]));
    mean(&each.collect::<Vec<_>>())
}

fn strong(sweeps: &[Sweeps; 2]) -> Claim {
    let [[cta, _, walk], [other_cta, _, other_walk]] =
        sweeps.each_ref().map(|s| of_both(s, LOW, strongest_over_weakest));
    let details = format!(
        "At {} vertices; at {}: {other_cta} and {other_walk}. 0.9 or more is taken as no significant \
         improvement.",
        thousands(sweeps[0].n),
        thousands(sweeps[1].n)
    );
    judged("19-strong", vec![cta, walk], details, || {
        "Strong initialisation helps even here.".into()
    })
}

fn worsens(id: &str, sweeps: &Sweeps) -> Claim {
    let measured = of_both(sweeps, LOW, worst_over_best);
    let details = "On average over all coherences of more than 30 degrees; worst parameter over the \
                   best at each.";
    let why = format!(
        "Here the parameter costs CTA {} % and H-Walk {} %.",
        short(measured[0].value),
        short(measured[2].value)
    );
    judged(id, measured.into(), details.into(), || why)
}

fn disperses(id: &str, sweeps: &[Sweeps; 2], alphas: std::ops::Range<usize>) -> Claim {
    let [measured, other] = sweeps.each_ref().map(|s| of_both(s, alphas.clone(), dispersion));
    let details = format!(
        "Iterations, with the best parameter at each coherence, at {} vertices; at {}: CTA {} %, \
         H-Walk {} %.",
        thousands(sweeps[0].n),
        thousands(sweeps[1].n),
        other[0],
        other[2]
    );
    judged(id, measured.into(), details, || {
        "The counts are of other implementations than the paper's: of the same loops, but not of the \
         same searches in them."
            .into()
    })
}
