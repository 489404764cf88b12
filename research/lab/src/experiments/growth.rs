//! Figure 11: growth of steps and time with the size of the bodies, and the cost of thin faces.

use super::{
    Coherence, Gathered, Race, Results, Unit, against_size, by_kind_and_size, fitted_reference,
    grouped_digits, listed_values, new_axis, new_series, sample_medians, time_text,
};
use crate::Experiment;
use crate::claims::{Claim, Reason, judged};
use crate::figures::literal;
use crate::finding::{Figure, Finding, Point, Series, Table};
use crate::plan::{Plan, Progress};
use crate::settings::{Meeting, Setting};
use crate::shapes::{Kind, bodies};
use crate::solvers::{PAPER_GAP, Until, Who};
use crate::statistics::{Group, Sample, estimate, mean, short};
use colltrans_testkit::random::Random;
use colltrans_testkit::timing::{Stopwatch, exponent, median};

pub(super) const FIGURE_11: Experiment = Experiment {
    id: "figure-11",
    title: "steps and time against the size of the bodies",
    seconds: [35.0, 120.0],
    run,
};

const WHO: [Who; 6] = [
    Who::Cta(Until::End),
    Who::Cta(Until::Near),
    Who::Portal,
    Who::Cta(Until::EndAcrossCells),
    Who::CtaColdScratch,
    Who::CtaCentroid,
];
const CTA: usize = 0;
const HYBRID: usize = 1;
const PORTAL: usize = 2;
const ACROSS_CELLS: usize = 3;
const COLD: usize = 4;
const CENTROID: usize = 5;

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
        iterations_figure(&balanced),
        time_figure(&balanced, thin),
        cost_figure(&balanced, thin),
    ];
    let claims = vec![
        steps_grow(&balanced),
        few_steps(&balanced),
        time_grows(&balanced),
        thin_costs(&balanced, &meridians, &stretch),
    ];
    Finding { figures, tables: vec![variants_table(&balanced), literal_table(plan)], claims }
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

    fn iterations(&self, who: usize) -> Vec<Sample> {
        let of = |at: &Measured| at.race.sample(who, |m| f64::from(m.work.iterations));
        self.0.iter().map(of).collect()
    }

    fn costs(&self, who: usize, unit: Unit) -> Vec<Sample> {
        self.0.iter().map(|at| at.race.costs(who, unit)).collect()
    }

    fn times(&self, who: usize) -> Vec<Sample> {
        self.costs(who, Unit::Time)
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

    /// Returns the statistic `k` in cost ~ `(log n)^k`, for the middle of the costs at each size.
    fn logarithms(&self, middle: fn(&[f64]) -> f64) -> impl Fn(&[Vec<f64>]) -> f64 {
        let logs: Vec<f64> = self.sizes().iter().map(|n| n.ln()).collect();
        move |costs| exponent(logs.iter().copied().zip(costs.iter().map(|values| middle(values))))
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

/// The variants of the minimisation, by name.
const VARIANTS: [(usize, &str); 4] = [
    (CTA, "CTA"),
    (COLD, "planar problems cold"),
    (CENTROID, "cuts through the centroid"),
    (ACROSS_CELLS, "across cells"),
];

fn iterations_figure(balanced: &Grown) -> Figure {
    let cta = balanced.points(&balanced.iterations(CTA), Point::mean);
    let line = |(who, name): (usize, &str)| {
        new_series(name, balanced.points(&balanced.iterations(who), Point::mean))
    };
    let mut figure = against_size(
        "figure-11-iterations",
        "Iterations of all loops of a query, balanced faces, mean and quartiles",
        new_axis("iterations", true),
        VARIANTS.map(line).to_vec(),
    );
    figure.references = vec![
        fitted_reference("log n", &cta, f64::ln),
        fitted_reference("log² n", &cta, |n| n.ln().powi(2)),
    ];
    figure
}

/// Returns the table of the means of steps and iterations of the variants, by size.
fn variants_table(balanced: &Grown) -> Table {
    let heads = balanced.sizes().into_iter().map(|n| format!("{} vertices", grouped_digits(n)));
    let columns = std::iter::once("steps (iterations of all loops)".into()).chain(heads).collect();
    let row = |(who, name): (usize, &str)| {
        let pairs = balanced.steps(who).into_iter().zip(balanced.iterations(who));
        let cells = pairs.map(|(steps, iterations)| {
            format!("{} ({:.0})", short(mean(&steps.values())), mean(&iterations.values()))
        });
        std::iter::once(name.to_owned()).chain(cells).collect()
    };
    Table {
        id: "figure-11-variants".into(),
        title: "The minimisation with and without our changes, balanced faces, means".into(),
        columns,
        rows: VARIANTS.map(row).to_vec(),
    }
}

/// Returns the table of the mean steps with the paper's cuts and cells, by brute force on bodies of moderate size.
fn literal_table(plan: &Plan) -> Table {
    let sizes = plan.by_scale(&[50, 200][..], &[200, 800, 3_200], &[200, 800, 3_200]);
    let count = plan.by_scale(10, 50, 100);
    let mut rows: Vec<Vec<String>> = literal::VARIANTS
        .iter()
        .map(|(name, _)| vec![(*name).to_owned()])
        .chain([vec!["the library".into()], vec!["searches".into()]])
        .collect();
    for n in sizes {
        let mut random = Random::stream(plan.seed, &[11, *n as u64, 7]);
        let bodies = bodies(plan.seed, Kind::Balanced, *n, 0);
        let counted = (0..count).filter_map(|_| {
            let s = Setting::draw(&bodies, Meeting::Colliding, &mut random);
            literal::count_steps(&bodies.pair, [s.moving, s.fixed], s.direction)
        });
        let counted: Vec<_> = counted.collect();
        let steps = (0..=literal::VARIANTS.len())
            .map(|k| mean(&counted.iter().map(|steps| f64::from(steps[k])).collect::<Vec<_>>()));
        let cells = steps.map(short).chain([counted.len().to_string()]);
        rows.iter_mut().zip(cells).for_each(|(row, cell)| row.push(cell));
    }
    let heads = sizes.iter().map(|n| format!("{} vertices", grouped_digits(*n as f64)));
    Table {
        id: "figure-11-literal".into(),
        title: "Mean steps with the paper's cuts and cells, by brute force, balanced faces, ideal exit test".into(),
        columns: std::iter::once("cells and cuts".into()).chain(heads).collect(),
        rows,
    }
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

/// Returns the ratios of costs on thin faces and the median cost on balanced ones.
fn cost_points(balanced: &Grown, thin: &Grown, who: usize, unit: Unit) -> Vec<Point> {
    let ratio = |(balanced, thin): (&Measured, &Measured)| {
        let usual = median(&balanced.race.costs(who, unit).values());
        let costs = thin.race.costs(who, unit).values();
        let ratios: Vec<_> = costs.iter().map(|cost| cost / usual).collect();
        Point::median(balanced.race.vertices(), &ratios)
    };
    balanced.0.iter().zip(&thin.0).map(ratio).collect()
}

fn cost_figure(balanced: &Grown, thin: [&Grown; 2]) -> Figure {
    let names = ["stretch of 100", "16 meridians"];
    let lines = |who: usize, name: &str| -> Vec<Series> {
        let line = |(thin, reading): (&&Grown, &str)| {
            new_series(format!("{name}, {reading}"), cost_points(balanced, thin, who, Unit::Time))
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
    let k = balanced.logarithms(median);
    let [instructions, time, again] =
        [balanced.costs(CTA, Unit::Instructions), balanced.times(CTA), balanced.again()]
            .map(|samples| estimate(&samples, &k));
    let iterations = balanced.iterations(CTA);
    let counted = estimate(&iterations, balanced.logarithms(mean));
    let details = format!(
        "Mean iterations: {}. Median times in µs: {}. The same query again, with its data in the caches: {}, k = {again}.",
        listed_values(&balanced.points(&iterations, Point::mean), 0),
        listed_values(&balanced.time_points(CTA), 1),
        listed_values(&balanced.in_microseconds(&balanced.again()), 1)
    );
    judged("11-time", vec![counted, instructions, time], details, || {
        Reason::Implementation.because(format!("Iterations of all loops grow with k = {counted}."))
    })
}

/// Judges the cost with 16 meridians, and quotes that with a fixed stretch.
fn thin_costs(balanced: &Grown, meridians: &Grown, stretch: &Grown) -> Claim {
    let increase = |thin: &Grown, unit: Unit| {
        let samples = [balanced.costs(CTA, unit), thin.costs(CTA, unit)].concat();
        estimate(&samples, |s| {
            let (usual, thin) = s.split_at(s.len() / 2);
            let pairs = sample_medians(thin).into_iter().zip(sample_medians(usual));
            100.0 * (median(&pairs.map(|(t, u)| t / u).collect::<Vec<_>>()) - 1.0)
        })
    };
    let by_size =
        |thin: &Grown, unit: Unit| listed_values(&cost_points(balanced, thin, CTA, unit), 2);
    let measured = vec![
        increase(meridians, Unit::Instructions),
        increase(meridians, Unit::Time),
        increase(stretch, Unit::Instructions),
    ];
    let details = format!(
        "Ratios to balanced faces: instructions {}, times {}; with a stretch of 100 instructions {}.",
        by_size(meridians, Unit::Instructions),
        by_size(meridians, Unit::Time),
        by_size(stretch, Unit::Instructions)
    );
    judged("11-thin", measured, details, || {
        let middle_of = |grown: &Grown, number: fn(&Results) -> f64| {
            median(&grown.0.iter().map(|at| number(&at.race)).collect::<Vec<_>>())
        };
        let [usual, thin] = [balanced, meridians].map(|grown| {
            let steps = middle_of(grown, |at| mean(&at.steps(CTA).values()));
            format!("{steps:.1} and {:.0}", middle_of(grown, |at| at.iterations(CTA)))
        });
        Reason::Sentence.because(format!(
            "The paper does not state how thin the faces are. Medians over the sizes of steps and iterations: {usual} on \
             balanced faces, {thin} on thin ones."
        ))
    })
}
