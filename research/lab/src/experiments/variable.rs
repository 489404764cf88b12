//! Figure 19: variable coherence, and the cost of wrong parameters, compared with H-Walk.
//!
//! - *High* coherence is at most half a degree in a step, *low* coherence more than 30 degrees.
//! - The *parameter* of an algorithm ranges from strong to weak initialisation. For CTA it is the half side `delta`
//!   of the square, from a thousandth of a diameter to all levels. For H-Walk it is the start layer `l`, from the
//!   finest to the coarsest.
//! - Costs are iterations of all loops. CTA is judged with *cold* planar problems, which start from scratch as in the
//!   paper (V-F). *Warm* ones are a further curve.

use colltrans::cta;

use super::{
    Coherence, Race, Results, grouped_digits, in_passes, new_axis, new_series, sample_means,
    time_text,
};
use crate::Experiment;
use crate::claims::{Claim, Reason, Why, judged};
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
    seconds: [6.0, 20.0],
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

/// What is swept, in the order of lanes: name, file, and what the parameter is.
const SWEPT: [(&str, &str, &str); 3] = [
    ("CTA", "cta", "half-side"),
    ("CTA with warm planar problems", "cta-warm", "half-side"),
    ("H-Walk", "hwalk", "layer"),
];
const CTA: usize = 0;
const WARM: usize = 1;
const WALK: usize = 2;

/// Lane of V-Clip, which has no parameter. It is a further curve in the figure of H-Walk, whose walk it shares.
const VCLIP: usize = SWEPT.len() * PARAMETERS;

/// One algorithm with each of its parameters at each coherence.
struct Sweep<'r> {
    results: &'r [Results],
    /// Of [`SWEPT`].
    which: usize,
}

/// All at one size.
struct Sweeps {
    n: f64,
    /// By coherence.
    results: Vec<Results>,
}

fn run(plan: &Plan, progress: &mut dyn Progress) -> Finding {
    let sizes: [usize; 2] = plan.by_scale([50, 200], [800, 3_200], [800, 3_200]);
    let items: Vec<_> =
        sizes.into_iter().flat_map(|n| ALPHAS_DEG.map(|alpha| (n, alpha))).collect();
    let told = |&(n, alpha): &(usize, f64)| {
        (n, format!("{} vertices, {alpha} degrees", grouped_digits(n as f64)))
    };
    let mut measured = in_passes(plan, progress, &items, told, |&(n, alpha), pass| {
        measure_orbits(plan, n, alpha, pass)
    })
    .into_iter();
    let sweeps = sizes.map(|n| Sweeps {
        n: n as f64,
        results: measured.by_ref().take(ALPHAS_DEG.len()).collect(),
    });
    let figures =
        sweeps.iter().flat_map(|s| [CTA, WARM, WALK].map(|which| s.figure(which))).collect();
    let mut claims = vec![effect_claim(&sweeps), initialisation_claim(&sweeps)];
    claims
        .extend(worst_parameter_claims(["19-worsening-800", "19-worsening-800-walk"], &sweeps[0]));
    claims.extend(worst_parameter_claims(
        ["19-worsening-3200", "19-worsening-3200-walk"],
        &sweeps[1],
    ));
    claims.extend(dispersion_claims(
        ["19-dispersion-high", "19-dispersion-high-walk"],
        &sweeps,
        HIGH,
    ));
    claims.extend(dispersion_claims(["19-dispersion-low", "19-dispersion-low-walk"], &sweeps, LOW));
    Finding { figures, tables: sweeps.iter().map(Sweeps::table).collect(), claims }
}

fn measure_orbits(plan: &Plan, n: usize, alpha: f64, pass: u32) -> Results {
    let region = |half: f64| cta::Region::Fixed(half);
    let mut who: Vec<_> = HALF_SIDES.map(|h| Who::CtaCold(region(h))).to_vec();
    who.extend(HALF_SIDES.map(|h| Who::CtaRegion(region(h), Until::End)));
    who.extend(LAYERS.map(Who::HWalk));
    who.push(Who::VClip);
    let race = Race {
        plan,
        figure: 19,
        kind: Kind::Spheres,
        n,
        given: None,
        who: &who,
        coherence: Coherence::Blocks,
        length: 1 + plan.by_scale(10, 50, 50),
        blocks: plan.by_scale(3, 5, 8),
    };
    race.run(pass, (alpha * 1e3) as u64, |bodies, count, random| {
        Setting::orbit(bodies, alpha, count, random)
    })
}

impl Sweeps {
    fn sweep(&self, which: usize) -> Sweep<'_> {
        Sweep { results: &self.results, which }
    }

    fn figure(&self, which: usize) -> Figure {
        let sweep = self.sweep(which);
        let (name, file, _) = SWEPT[which];
        let line = |parameter: usize| {
            let points = ALPHAS_DEG
                .iter()
                .enumerate()
                .map(|(k, alpha)| Point::mean(*alpha, &sweep.costs(k, parameter).values()))
                .collect();
            let what = if which == WALK {
                format!("layer at {:.0} % of all", 100.0 * LAYERS[parameter])
            } else {
                format!("half-side {} D", HALF_SIDES[parameter])
            };
            new_series(what, points)
        };
        let vclip = (which == WALK).then(|| {
            let at = |(alpha, results): (&f64, &Results)| {
                let iterations = results.sample(VCLIP, |m| f64::from(m.work.iterations));
                Point::mean(*alpha, &iterations.values())
            };
            new_series("V-Clip", ALPHAS_DEG.iter().zip(&self.results).map(at).collect())
        });
        Figure {
            id: format!("figure-19-{file}-{}", self.n),
            title: format!(
                "{name}, {} vertices: iterations by coherence and parameter, mean and quartiles",
                grouped_digits(self.n)
            ),
            x: new_axis("degrees from query to query", true),
            y: new_axis("iterations", false),
            series: (0..PARAMETERS).map(line).chain(vclip).collect(),
            references: Vec::new(),
        }
    }

    fn table(&self) -> Table {
        let mut rows = Vec::new();
        for (which, (name, _, what)) in SWEPT.iter().enumerate() {
            for k in 0..PARAMETERS {
                let parameter = if which == WALK { LAYERS[k] } else { HALF_SIDES[k] };
                let lane = PARAMETERS * which + k;
                let cell = |alpha: usize| time_text(median(&self.results[alpha].times(lane)));
                let head = format!("{name}, {what} {parameter}");
                rows.push(std::iter::once(head).chain((0..ALPHAS_DEG.len()).map(cell)).collect());
            }
        }
        let cell = |results: &Results| time_text(median(&results.times(VCLIP)));
        rows.push(std::iter::once("V-Clip".into()).chain(self.results.iter().map(cell)).collect());
        let columns = std::iter::once("algorithm and parameter".into())
            .chain(ALPHAS_DEG.iter().map(|alpha| format!("{alpha}°")))
            .collect();
        let title = format!(
            "Median time of a query, {} vertices, by degrees from query to query",
            grouped_digits(self.n)
        );
        Table { id: format!("figure-19-times-{}", self.n), title, columns, rows }
    }
}

impl Sweep<'_> {
    /// Returns the costs of a parameter at a coherence.
    fn costs(&self, alpha: usize, parameter: usize) -> Sample {
        let lane = PARAMETERS * self.which + parameter;
        self.results[alpha].sample(lane, |m| f64::from(m.work.iterations))
    }

    /// Returns the costs in a range of coherence, by coherence and parameter.
    fn all(&self, alphas: std::ops::Range<usize>) -> Vec<Sample> {
        alphas.flat_map(|a| (0..PARAMETERS).map(move |p| self.costs(a, p))).collect()
    }
}

/// Returns the excess in per cent of the mean of the worst parameter over that of the best, averaged over the
/// coherences.
fn worst_over_best(samples: &[Vec<f64>]) -> f64 {
    let each = samples.chunks(PARAMETERS).map(|of| {
        let means = sample_means(of);
        let worst = means.iter().copied().fold(0.0, f64::max);
        100.0 * (worst / means.iter().copied().fold(f64::INFINITY, f64::min) - 1.0)
    });
    mean(&each.collect::<Vec<_>>())
}

/// Returns deviation over mean with the best parameter in per cent, averaged over the coherences.
fn mean_dispersion(samples: &[Vec<f64>]) -> f64 {
    let each = samples.chunks(PARAMETERS).map(|of| {
        let stats = of.iter().map(|values| mean_and_deviation(values));
        let best = stats.min_by(|a, b| a[0].total_cmp(&b[0]));
        best.map_or(f64::NAN, |[mean, deviation]| 100.0 * deviation / mean)
    });
    mean(&each.collect::<Vec<_>>())
}

/// A statistic of what is swept, and that of CTA over that of H-Walk.
struct Statistic {
    each: [Estimate; SWEPT.len()],
    ratio: Estimate,
}

/// Estimates a statistic of each algorithm, and the ratio of the statistics of CTA and H-Walk.
fn of_all(
    sweeps: &Sweeps,
    alphas: std::ops::Range<usize>,
    statistic: fn(&[Vec<f64>]) -> f64,
) -> Statistic {
    let samples = [CTA, WARM, WALK].map(|which| sweeps.sweep(which).all(alphas.clone()));
    let both = [samples[CTA].clone(), samples[WALK].clone()].concat();
    let ratio = estimate(&both, |s| {
        let (cta, walk) = s.split_at(s.len() / 2);
        statistic(cta) / statistic(walk)
    });
    Statistic { each: samples.each_ref().map(|s| estimate(s, statistic)), ratio }
}

/// Formats the mean iterations with the best parameter by coherence.
fn iterations_text(sweeps: &Sweeps, which: usize, alphas: std::ops::Range<usize>) -> String {
    let sweep = sweeps.sweep(which);
    let best = |alpha: usize| {
        let each = (0..PARAMETERS).map(|p| mean_and_deviation(&sweep.costs(alpha, p).values()));
        let [mean, deviation] = each.min_by(|a, b| a[0].total_cmp(&b[0])).expect("parameters");
        format!("{mean:.1} ± {deviation:.1} at {}°", ALPHAS_DEG[alpha])
    };
    format!("{} {}", SWEPT[which].0, alphas.map(best).collect::<Vec<_>>().join(", "))
}

fn effect_claim(sweeps: &[Sweeps; 2]) -> Claim {
    let [at, other] = sweeps.each_ref().map(|s| of_all(s, HIGH, worst_over_best));
    let details = format!(
        "At {} vertices; warm {} %. At {}: {} % and {} %.",
        grouped_digits(sweeps[0].n),
        at.each[WARM],
        grouped_digits(sweeps[1].n),
        other.each[CTA],
        other.each[WALK]
    );
    judged("19-affects", vec![at.each[CTA], at.each[WALK]], details, || {
        Reason::Implementation.because("The parameter changes the count by about a quarter.")
    })
}

/// Returns the mean with the strongest initialisation over that with the weakest, averaged over the coherences.
fn strongest_over_weakest(samples: &[Vec<f64>]) -> f64 {
    let each = samples.chunks(PARAMETERS).map(|of| mean(&of[0]) / mean(&of[PARAMETERS - 1]));
    mean(&each.collect::<Vec<_>>())
}

fn initialisation_claim(sweeps: &[Sweeps; 2]) -> Claim {
    let [at, other] = sweeps.each_ref().map(|s| of_all(s, LOW, strongest_over_weakest));
    let details = format!(
        "At {} vertices; warm {}. At {}: {} and {}. 0.75 or more is taken as no significant improvement.",
        grouped_digits(sweeps[0].n),
        at.each[WARM],
        grouped_digits(sweeps[1].n),
        other.each[CTA],
        other.each[WALK]
    );
    judged("19-strong", vec![at.each[CTA], at.each[WALK]], details, || {
        Reason::Implementation.because("Strong initialisation helps even here.")
    })
}

/// Judges the claim for CTA, and the one for H-Walk.
fn worst_parameter_claims(ids: [&str; 2], sweeps: &Sweeps) -> [Claim; 2] {
    let Statistic { each, ratio } = of_all(sweeps, LOW, worst_over_best);
    let details = format!(
        "On average over all coherences of more than 30 degrees; worst parameter over the best at each. With warm \
         planar problems {} %.",
        each[WARM]
    );
    let why = |which: usize, reason: Reason| {
        reason.because(format!("With the best parameter: {}.", iterations_text(sweeps, which, LOW)))
    };
    [
        judged(ids[0], vec![each[CTA], ratio], details.clone(), || {
            why(CTA, Reason::Implementation)
        }),
        judged(ids[1], vec![each[WALK]], details, || why(WALK, Reason::Rival)),
    ]
}

/// Judges the claim for CTA, and the one for H-Walk.
fn dispersion_claims(
    ids: [&str; 2],
    sweeps: &[Sweeps; 2],
    alphas: std::ops::Range<usize>,
) -> [Claim; 2] {
    let [at, other] = sweeps.each_ref().map(|s| of_all(s, alphas.clone(), mean_dispersion));
    let details = format!(
        "Iterations, with the best parameter at each coherence, at {} vertices; with warm planar problems {} %. At \
         {}: CTA {} %, H-Walk {} %.",
        grouped_digits(sweeps[0].n),
        at.each[WARM],
        grouped_digits(sweeps[1].n),
        other.each[CTA],
        other.each[WALK]
    );
    let why = |which: usize, reason: Reason| -> Why {
        let counts = iterations_text(&sweeps[0], which, alphas.clone());
        let [of_means, poisson] = of_sequences(&sweeps[0], which, alphas.clone());
        reason.because(format!(
            "Mean and deviation of iterations: {counts}. As many independent steps would disperse by {} %; means over a \
             sequence disperse by {} %. The paper does not say of what its deviations are.",
            short(poisson),
            short(of_means)
        ))
    };
    [
        judged(ids[0], vec![at.each[CTA], at.ratio], details.clone(), || {
            why(CTA, Reason::Implementation)
        }),
        judged(ids[1], vec![at.each[WALK]], details, || why(WALK, Reason::Sentence)),
    ]
}

/// Returns two relative standard deviations in per cent, each averaged over the coherences, with the best parameter:
/// that of the mean number of iterations over the sequences, and that of a Poisson count with this mean `m`,
/// `1 / sqrt(m)`.
fn of_sequences(sweeps: &Sweeps, which: usize, alphas: std::ops::Range<usize>) -> [f64; 2] {
    let sweep = sweeps.sweep(which);
    let at = |alpha: usize| {
        let costs = (0..PARAMETERS).map(|p| sweep.costs(alpha, p));
        let best = costs.min_by(|a, b| mean(&a.values()).total_cmp(&mean(&b.values())));
        let best = best.expect("parameters");
        let [all, deviation] = mean_and_deviation(&best.group_means());
        [100.0 * deviation / all, 100.0 / all.sqrt()]
    };
    let each: Vec<_> = alphas.map(at).collect();
    [0, 1].map(|k| mean(&each.iter().map(|pair| pair[k]).collect::<Vec<_>>()))
}
