//! Figure 11: growth of steps and time with the size of the bodies, and the cost of thin faces.

use super::{
    Coherence, Gathered, Race, Results, against_size, by_kind_and_size, fitted_reference,
    listed_values, new_axis, new_series, sample_medians, time_text,
};
use crate::Experiment;
use crate::claims::{Claim, READINGS, Reason, judged};
use crate::finding::{Figure, Finding, Point, Series};
use crate::plan::{Plan, Progress};
use crate::settings::{Meeting, Setting};
use crate::shapes::Kind;
use crate::solvers::{PAPER_GAP, Until, Who};
use crate::statistics::{Group, Sample, estimate, mean, short};
use colltrans_testkit::random::Random;
use colltrans_testkit::timing::{Stopwatch, exponent, median};

pub(super) const FIGURE_11: Experiment = Experiment {
    id: "figure-11",
    title: "steps and time against the size of the bodies",
    seconds: [22.0, 85.0],
    run,
};

const WHO: [Who; 4] =
    [Who::Cta(Until::End), Who::Cta(Until::Near), Who::Portal, Who::Cta(Until::EndAcrossCells)];
const CTA: usize = 0;
const HYBRID: usize = 1;
const PORTAL: usize = 2;
const ACROSS_CELLS: usize = 3;

/// Results at all sizes, for one kind of body.
struct Grown(Vec<Measured>);

/// Results for one kind of body at one size.
struct Measured {
    race: Results,
    /// Times of CTA for the second of two equal queries, with the needed parts of the bodies in the processor's
    /// caches.
    again: Vec<(Group, f64)>,
}

impl Gathered for Measured {
    fn gather(&mut self, more: Self) {
        self.race.gather(more.race);
        self.again.extend(more.again);
    }
}

fn run(plan: &Plan, progress: &mut dyn Progress) -> Finding {
    let [balanced, stretch, meridians] =
        by_kind_and_size(plan, progress, |kind, n, pass| measure(plan, kind, n, pass)).map(Grown);
    let thin = [&stretch, &meridians];
    let figures = vec![
        steps_figure(&balanced, &stretch),
        time_figure(&balanced, thin),
        cost_figure(&balanced, thin),
    ];
    let mut claims = vec![steps_grow(&balanced), few_steps(&balanced), time_grows(&balanced)];
    claims.extend(
        ["11-thin-stretch", "11-thin-meridians"]
            .iter()
            .zip(thin)
            .map(|(id, thin)| thin_costs(id, &balanced, thin)),
    );
    Finding { figures, tables: Vec::new(), claims }
}

fn measure(plan: &Plan, kind: Kind, n: usize, pass: u32) -> Measured {
    let race = Race {
        plan,
        figure: 11,
        kind,
        n,
        given: None,
        who: &WHO,
        coherence: Coherence::Scratch,
        length: plan.by_scale(5, 50, 50),
        blocks: plan.by_scale(2, 6, if n < 20_000 { 12 } else { 6 }),
    };
    let results = race.run(pass, 0, |bodies, count, random| {
        (0..count).map(|_| Setting::draw(bodies, Meeting::Colliding, random)).collect()
    });
    Measured { race: results, again: ask_again(&race, pass) }
}

impl Grown {
    fn sizes(&self) -> Vec<f64> {
        self.0.iter().map(|at| at.race.vertices()).collect()
    }

    fn steps(&self, who: usize) -> Vec<Sample> {
        self.0.iter().map(|at| at.race.steps(who)).collect()
    }

    fn times(&self, who: usize) -> Vec<Sample> {
        self.0.iter().map(|at| at.race.time_sample(who)).collect()
    }

    /// Returns the times of repeated queries.
    fn again(&self) -> Vec<Sample> {
        self.0.iter().map(|at| Sample::of(at.again.iter().copied())).collect()
    }

    /// Returns the mean steps with quartiles.
    fn step_points(&self, who: usize) -> Vec<Point> {
        self.points(&self.steps(who), Point::mean)
    }

    /// Returns the median times with quartiles, in microseconds.
    fn time_points(&self, who: usize) -> Vec<Point> {
        self.in_microseconds(&self.times(who))
    }

    fn in_microseconds(&self, times: &[Sample]) -> Vec<Point> {
        self.points(times, |x, values| {
            Point::median(x, &values.iter().map(|t| t / 1e3).collect::<Vec<_>>())
        })
    }

    fn points(&self, samples: &[Sample], point: impl Fn(f64, &[f64]) -> Point) -> Vec<Point> {
        self.sizes()
            .into_iter()
            .zip(samples)
            .map(|(n, sample)| point(n, &sample.values()))
            .collect()
    }

    /// Returns the statistic `k` in time ~ `(log n)^k`.
    fn logarithms(&self) -> impl Fn(&[Vec<f64>]) -> f64 {
        let logs: Vec<f64> = self.sizes().iter().map(|n| n.ln()).collect();
        move |times| exponent(logs.iter().copied().zip(sample_medians(times)))
    }
}

/// Asks queries of CTA twice, and times the second ones.
fn ask_again(race: &Race, pass: u32) -> Vec<(Group, f64)> {
    let bodies = race.pass_bodies(pass);
    let labels = [race.figure, race.kind as u64, race.n as u64, u64::from(pass)];
    let mut random = Random::stream(race.plan.seed, &labels);
    let mut cta = WHO[CTA].enter(&bodies);
    let stopwatch = Stopwatch::new();
    (0..(race.length * race.blocks / 4) as u32)
        .map(|number| {
            let setting = Setting::draw(&bodies, Meeting::Colliding, &mut random);
            cta.ask(&setting);
            (Group { pass, number }, stopwatch.time(|| cta.ask(&setting)).1)
        })
        .collect()
}

fn steps_figure(balanced: &Grown, thin: &Grown) -> Figure {
    let cta = balanced.step_points(CTA);
    let mut figure = against_size(
        "figure-11-steps",
        "Minimisation steps of a query, mean and quartiles",
        new_axis("steps", false),
        vec![
            new_series("CTA, balanced", cta.clone()),
            new_series("CTA, thin (stretch of 100)", thin.step_points(CTA)),
            new_series("CTA across cells, balanced", balanced.step_points(ACROSS_CELLS)),
            new_series("hybrid (to a gap of 1 %), balanced", balanced.step_points(HYBRID)),
            new_series("portals of portal refinement, balanced", balanced.step_points(PORTAL)),
        ],
    );
    figure.references = vec![
        fitted_reference("log n", &cta, f64::ln),
        super::reference_curve("the paper: fewer than 15", balanced.sizes().into_iter(), |_| 15.0),
    ];
    figure
}

fn time_figure(balanced: &Grown, thin: [&Grown; 2]) -> Figure {
    let cta = balanced.time_points(CTA);
    let mut figure = against_size(
        "figure-11-time",
        "Time of a query from scratch, median and quartiles",
        new_axis("time (µs)", true),
        vec![
            new_series("CTA, balanced", cta.clone()),
            new_series("CTA, thin (stretch of 100)", thin[0].time_points(CTA)),
            new_series("CTA, thin (16 meridians)", thin[1].time_points(CTA)),
            new_series(
                "CTA, balanced, the same query again",
                balanced.in_microseconds(&balanced.again()),
            ),
            new_series("hybrid (to a gap of 1 %), balanced", balanced.time_points(HYBRID)),
            new_series("CTA across cells, balanced", balanced.time_points(ACROSS_CELLS)),
            new_series("portal refinement, balanced", balanced.time_points(PORTAL)),
        ],
    );
    figure.references = vec![
        fitted_reference("log n", &cta, f64::ln),
        fitted_reference("log² n", &cta, |n| n.ln().powi(2)),
    ];
    figure
}

/// Returns the ratios of times on thin faces and the median time on balanced ones.
fn cost_points(balanced: &Grown, thin: &Grown, who: usize) -> Vec<Point> {
    let ratio = |(balanced, thin): (&Measured, &Measured)| {
        let usual = median(&balanced.race.times(who));
        let times: Vec<_> = thin.race.times(who).iter().map(|t| t / usual).collect();
        Point::median(balanced.race.vertices(), &times)
    };
    balanced.0.iter().zip(&thin.0).map(ratio).collect()
}

fn cost_figure(balanced: &Grown, thin: [&Grown; 2]) -> Figure {
    let names = ["stretch of 100", "16 meridians"];
    let lines = |who: usize, name: &str| -> Vec<Series> {
        let line = |(thin, reading): (&&Grown, &str)| {
            new_series(format!("{name}, {reading}"), cost_points(balanced, thin, who))
        };
        thin.iter().zip(names).map(line).collect()
    };
    let mut figure = against_size(
        "figure-11-thin",
        "Time on thin and stretched faces over the median time on balanced ones, with quartiles",
        new_axis("time(thin) / time(balanced)", true),
        [lines(CTA, "CTA"), lines(HYBRID, "hybrid"), lines(PORTAL, "portal refinement")].concat(),
    );
    let limit =
        |name: &str, y: f64| super::reference_curve(name, balanced.sizes().into_iter(), move |_| y);
    figure.references = vec![limit("the paper: 1.2", 1.2), limit("the paper: 1.8", 1.8)];
    figure
}

fn steps_grow(balanced: &Grown) -> Claim {
    let sizes = balanced.sizes();
    let growth = sizes[sizes.len() - 1].ln() / sizes[0].ln();
    let rise = |s: &[Vec<f64>]| mean(&s[s.len() - 1]) / mean(&s[0]) / growth;
    let measured = estimate(&balanced.steps(CTA), rise);
    let points = balanced.step_points(CTA);
    let details = format!(
        "Steps on average: {}. Of the hybrid: {}.",
        listed_values(&points, 1),
        listed_values(&balanced.step_points(HYBRID), 1)
    );
    judged("11-steps", vec![measured], details, || {
        let k = exponent(points.iter().map(|p| (p.x, p.y)));
        Reason::Implementation.because(format!("Steps grow like n to the {k:.2} here."))
    })
}

fn few_steps(balanced: &Grown) -> Claim {
    let last = &balanced.0[balanced.0.len() - 1].race;
    let steps = last.steps(CTA);
    let steps_of = |who: usize| mean(&last.steps(who).values());
    let near = steps_of(HYBRID);
    let at = |who: usize| time_text(median(&last.times(who)));
    let details = format!(
        "As many faces as vertices. The hybrid: {near:.1} steps to a gap of {PAPER_GAP}, then portal \
         refinement: {} in place of {}. Where the shift goes on across cells, which the paper's does not: {:.1} \
         planar problems, {:.0} iterations of all loops in place of {:.0}, and {}.",
        at(HYBRID),
        at(CTA),
        steps_of(ACROSS_CELLS),
        last.iterations(ACROSS_CELLS),
        last.iterations(CTA),
        at(ACROSS_CELLS)
    );
    judged("11-few", vec![estimate(&[steps], |s| mean(&s[0]))], details, || {
        Reason::Implementation.because(format!(
            "After {near:.1} planar problems the bounds are within {PAPER_GAP} of the bodies' extent \
             at any size; the others look for the last of many small features."
        ))
    })
}

fn time_grows(balanced: &Grown) -> Claim {
    let k = balanced.logarithms();
    let [measured, hybrid, again] =
        [balanced.times(CTA), balanced.times(HYBRID), balanced.again()].map(|s| estimate(&s, &k));
    let iterations: Vec<f64> = balanced.0.iter().map(|at| at.race.iterations(CTA)).collect();
    let counted = exponent(balanced.sizes().iter().map(|n| n.ln()).zip(iterations.iter().copied()));
    let details = format!(
        "Median times in µs: {}. Of the hybrid k = {hybrid}. The same query asked again at once: {}, k = {again}. \
         Iterations of all loops grow with k = {counted:.2}.",
        listed_values(&balanced.time_points(CTA), 1),
        listed_values(&balanced.in_microseconds(&balanced.again()), 1)
    );
    judged("11-time", vec![measured], details, || {
        let counts = format!(
            "Iterations of all loops, from {:.0} to {:.0}, grow with k = {counted:.2}; the time of a query that \
             is asked again at once, with all that it needs in the processor's caches, with k = {}.",
            iterations[0],
            iterations[iterations.len() - 1],
            short(again.value)
        );
        let reason = if counted < 2.5 { Reason::Machine } else { Reason::Implementation };
        reason.because(counts)
    })
}

fn thin_costs(id: &str, balanced: &Grown, thin: &Grown) -> Claim {
    let samples = [balanced.times(CTA), thin.times(CTA)].concat();
    let increase = estimate(&samples, |s| {
        let (usual, thin) = s.split_at(s.len() / 2);
        let ratios: Vec<_> =
            sample_medians(thin).iter().zip(sample_medians(usual)).map(|(t, u)| t / u).collect();
        100.0 * (median(&ratios) - 1.0)
    });
    let details = format!(
        "time(thin) over time(balanced): {}; of the hybrid {}.",
        listed_values(&cost_points(balanced, thin, CTA), 2),
        listed_values(&cost_points(balanced, thin, HYBRID), 2)
    );
    judged(id, vec![increase], details, || {
        let middle_of = |grown: &Grown, number: fn(&Results) -> f64| {
            median(&grown.0.iter().map(|at| number(&at.race)).collect::<Vec<_>>())
        };
        let [usual, thin] = [balanced, thin].map(|grown| {
            let steps = middle_of(grown, |at| mean(&at.steps(CTA).values()));
            format!("{steps:.1} and {:.0}", middle_of(grown, |at| at.iterations(CTA)))
        });
        Reason::Sentence.because(format!(
            "It does not say how thin. Steps and iterations of all loops, in the middle of all sizes: {usual} on \
             balanced faces, {thin} on those of {}.",
            READINGS.iter().find(|(ending, _)| id.ends_with(ending)).map_or("thin bodies", |r| r.1)
        ))
    })
}
