//! Figure 11: how steps and time grow with the size of the bodies, and what thin faces cost.

use super::{
    Coherence, Parts, Race, Results, against_size, axis, fitted, listed, medians, series, share,
    shares, thousands, time,
};
use crate::Experiment;
use crate::claims::{Claim, judged};
use crate::finding::{Figure, Finding, Point, Series};
use crate::plan::{Plan, Progress};
use crate::settings::{Meeting, Setting};
use crate::shapes::Kind;
use crate::solvers::{PAPER_GAP, Until, Who};
use crate::statistics::{Sample, estimate, mean};
use colltrans_testkit::random::Random;
use colltrans_testkit::timing::{Stopwatch, exponent, median};

pub(super) const FIGURE_11: Experiment =
    Experiment { id: "figure-11", title: "steps and time against the size of the bodies", run };

const WHO: [Who; 4] =
    [Who::Cta(Until::Near), Who::Cta(Until::End), Who::Portal, Who::Cta(Until::EndAcrossCells)];
const CTA: usize = 0;
const TO_THE_END: usize = 1;
const PORTAL: usize = 2;
const ACROSS_CELLS: usize = 3;

/// What was measured at all sizes, for one kind of body.
struct Grown {
    races: Vec<Results>,
    /// Times of CTA, in nanoseconds, when every query is asked twice and the second time counts:
    /// what it needs of the bodies is in the processor's caches by then.
    again: Vec<Point>,
}

fn run(plan: &Plan, progress: &mut dyn Progress) -> Finding {
    let mut parts = Parts::new(progress, 3.0 * shares(plan.sizes()));
    let kinds = [Kind::Balanced, Kind::Thin, Kind::ThinMeridians];
    let mut all = kinds.map(|_| Grown { races: Vec::new(), again: Vec::new() });
    for &n in plan.sizes() {
        for (kind, grown) in kinds.iter().zip(&mut all) {
            grown.measure(plan, *kind, n, &mut parts);
        }
    }
    let [balanced, thin, meridians] = all;
    let figures = vec![
        steps_figure(&balanced, &thin),
        time_figure(&balanced, &thin),
        cost_figure(&balanced, [&thin, &meridians]),
    ];
    let claims = vec![
        steps_grow(&balanced),
        few_steps(&balanced),
        time_grows(&balanced),
        thin_costs(&balanced, [&thin, &meridians]),
    ];
    Finding { figures, tables: Vec::new(), claims }
}

impl Grown {
    fn measure(&mut self, plan: &Plan, kind: Kind, n: usize, parts: &mut Parts) {
        let doing = format!("{} bodies, {} vertices", kind.name(), thousands(n as f64));
        parts.begin(share(n), &doing);
        let race = Race {
            plan,
            figure: 11,
            kind,
            n,
            given: None,
            who: &WHO,
            coherence: Coherence::Scratch,
            length: plan.by_scale(5, 50, 100),
            blocks: plan.by_scale(2, 24, 96),
        };
        self.races.push(race.run(0, |bodies, count, random| {
            (0..count).map(|_| Setting::draw(bodies, Meeting::Colliding, random)).collect()
        }));
        self.again.push(ask_again(&race));
    }

    fn sizes(&self) -> Vec<f64> {
        self.races.iter().map(|at| at.vertices).collect()
    }

    fn steps(&self, who: usize) -> Vec<Sample> {
        self.races.iter().map(|at| at.steps(who)).collect()
    }

    fn times(&self, who: usize) -> Vec<Sample> {
        self.races.iter().map(|at| at.time_sample(who)).collect()
    }

    /// Mean steps with quartiles.
    fn step_points(&self, who: usize) -> Vec<Point> {
        self.points(|at| Point::mean(at.vertices, &at.steps(who).values()))
    }

    /// Median times with quartiles, in microseconds.
    fn time_points(&self, who: usize) -> Vec<Point> {
        self.points(|at| {
            let times: Vec<_> = at.times(who).iter().map(|t| t / 1e3).collect();
            Point::median(at.vertices, &times)
        })
    }

    fn points(&self, point: impl Fn(&Results) -> Point) -> Vec<Point> {
        self.races.iter().map(point).collect()
    }
}

/// Asks every query of CTA twice and times the second.
fn ask_again(race: &Race) -> Point {
    let bodies = race.bodies(0);
    let mut random =
        Random::stream(race.plan.seed, &[race.figure, race.kind as u64, race.n as u64]);
    let mut cta = WHO[CTA].enter(&bodies);
    let stopwatch = Stopwatch::new();
    let times: Vec<_> = (0..race.length * race.blocks / 4)
        .map(|_| {
            let setting = Setting::draw(&bodies, Meeting::Colliding, &mut random);
            cta.ask(&setting);
            stopwatch.time(|| cta.ask(&setting)).1 / 1e3
        })
        .collect();
    Point::median(bodies.vertices(), &times)
}

fn steps_figure(balanced: &Grown, thin: &Grown) -> Figure {
    let to_the_end = balanced.step_points(TO_THE_END);
    let mut figure = against_size(
        "figure-11-steps",
        "Minimisation steps of a query, mean and quartiles",
        axis("steps", false),
        vec![
            series("CTA to the end, balanced", to_the_end.clone()),
            series("CTA to the end, thin", thin.step_points(TO_THE_END)),
            series("CTA to the end across cells, balanced", balanced.step_points(ACROSS_CELLS)),
            series("CTA to a gap of 1 %, balanced", balanced.step_points(CTA)),
            series("CTA to a gap of 1 %, thin", thin.step_points(CTA)),
            series("portals of portal refinement, balanced", balanced.step_points(PORTAL)),
        ],
    );
    figure.references = vec![
        fitted("log n", &to_the_end, f64::ln),
        super::reference("the paper: fewer than 15", balanced.sizes().into_iter(), |_| 15.0),
    ];
    figure
}

fn time_figure(balanced: &Grown, thin: &Grown) -> Figure {
    let cta = balanced.time_points(CTA);
    let mut figure = against_size(
        "figure-11-time",
        "Time of a query from scratch, median and quartiles",
        axis("time (µs)", true),
        vec![
            series("CTA, balanced", cta.clone()),
            series("CTA, thin", thin.time_points(CTA)),
            series("CTA, balanced, the same query again", balanced.again.clone()),
            series("CTA to the end, balanced", balanced.time_points(TO_THE_END)),
            series("CTA to the end across cells, balanced", balanced.time_points(ACROSS_CELLS)),
            series("portal refinement, balanced", balanced.time_points(PORTAL)),
            series("portal refinement, thin", thin.time_points(PORTAL)),
        ],
    );
    figure.references =
        vec![fitted("log n", &cta, f64::ln), fitted("log² n", &cta, |n| n.ln().powi(2))];
    figure
}

/// Times on thin faces over the median time on balanced ones.
fn cost(balanced: &Grown, thin: &Grown, who: usize) -> Vec<Point> {
    let ratio = |(balanced, thin): (&Results, &Results)| {
        let usual = median(&balanced.times(who));
        let times: Vec<_> = thin.times(who).iter().map(|t| t / usual).collect();
        Point::median(balanced.vertices, &times)
    };
    balanced.races.iter().zip(&thin.races).map(ratio).collect()
}

fn cost_figure(balanced: &Grown, thin: [&Grown; 2]) -> Figure {
    let names = ["stretch of 100", "16 meridians"];
    let lines = |who: usize| -> Vec<Series> {
        let line = |(thin, name): (&&Grown, &str)| {
            series(format!("{}, {name}", WHO[who].name()), cost(balanced, thin, who))
        };
        thin.iter().zip(names).map(line).collect()
    };
    let mut figure = against_size(
        "figure-11-thin",
        "Time on thin and stretched faces over the median time on balanced ones, with quartiles",
        axis("time(thin) / time(balanced)", true),
        [lines(CTA), lines(PORTAL)].concat(),
    );
    let limit =
        |name: &str, y: f64| super::reference(name, balanced.sizes().into_iter(), move |_| y);
    figure.references = vec![limit("the paper: 1.2", 1.2), limit("the paper: 1.8", 1.8)];
    figure
}

fn steps_grow(balanced: &Grown) -> Claim {
    let sizes = balanced.sizes();
    let growth = sizes[sizes.len() - 1].ln() / sizes[0].ln();
    let steps = balanced.steps(TO_THE_END);
    let rise = |s: &[Vec<f64>]| mean(&s[s.len() - 1]) / mean(&s[0]) / growth;
    let measured = estimate(&steps, rise);
    let points = balanced.step_points(TO_THE_END);
    let details = format!(
        "Steps to the end on average: {}. To a gap of {PAPER_GAP}: {}.",
        listed(&points, 1),
        listed(&balanced.step_points(CTA), 1)
    );
    judged("11-steps", vec![measured], details, || {
        let k = exponent(points.iter().map(|p| (p.x, p.y)));
        format!("Steps grow like n to the {k:.2} here.")
    })
}

fn few_steps(balanced: &Grown) -> Claim {
    let largest =
        |who: usize| balanced.races.iter().rev().take(1).map(|at| at.steps(who)).collect();
    let steps: Vec<Sample> = largest(TO_THE_END);
    let last = &balanced.races[balanced.races.len() - 1];
    let steps_of = |who: usize| mean(&last.steps(who).values());
    let near = steps_of(CTA);
    let at = |who: usize| time(median(&last.times(who)));
    let details = format!(
        "As many faces as vertices. {near:.1} steps to a gap of {PAPER_GAP}, then portal refinement: {} \
         in place of {}. Where the shift goes on across cells, which the paper's does not: {:.1} planar \
         problems to the end, {:.0} iterations of all loops in place of {:.0}, and {}.",
        at(CTA),
        at(TO_THE_END),
        steps_of(ACROSS_CELLS),
        last.iterations(ACROSS_CELLS),
        last.iterations(TO_THE_END),
        at(ACROSS_CELLS)
    );
    judged("11-few", vec![estimate(&steps, |s| mean(&s[0]))], details, || {
        format!(
            "After {near:.1} planar problems the bounds are within {PAPER_GAP} of the bodies' extent \
             at any size; the others look for the last of many small features."
        )
    })
}

fn time_grows(balanced: &Grown) -> Claim {
    let logs: Vec<f64> = balanced.sizes().iter().map(|n| n.ln()).collect();
    let k = |times: &[Vec<f64>]| exponent(logs.iter().copied().zip(medians(times)));
    let measured = estimate(&balanced.times(CTA), k);
    let again = exponent(balanced.again.iter().map(|p| (p.x.ln(), p.y)));
    let details = format!(
        "Median times in µs: {}. The same query asked again at once: {}, k = {again:.2}.",
        listed(&balanced.time_points(CTA), 1),
        listed(&balanced.again, 1)
    );
    judged("11-time", vec![measured], details, || {
        if again < 2.5 {
            "Asked again at once, with all that it needs in the processor's caches, a query keeps to \
             log² n: it is memory that large bodies wait for."
                .into()
        } else {
            "Memory does not explain it: the same query asked again at once grows faster, too."
                .into()
        }
    })
}

fn thin_costs(balanced: &Grown, thin: [&Grown; 2]) -> Claim {
    let increase = |thin: &Grown| {
        let samples = [balanced.times(CTA), thin.times(CTA)].concat();
        estimate(&samples, |s| {
            let (usual, thin) = s.split_at(s.len() / 2);
            let ratios: Vec<_> =
                medians(thin).iter().zip(medians(usual)).map(|(t, u)| t / u).collect();
            100.0 * (median(&ratios) - 1.0)
        })
    };
    let [stretch, meridians] = thin.map(increase);
    let details = format!(
        "Faces of a fixed stretch of 100; time(thin) over time(balanced): {}. With 16 meridians at any \
         size, the other reading of \"thin\": {meridians} %, {}.",
        listed(&cost(balanced, thin[0], CTA), 2),
        listed(&cost(balanced, thin[1], CTA), 2)
    );
    judged("11-thin", vec![stretch], details, || {
        let middle_of = |grown: &Grown, number: fn(&Results) -> f64| {
            median(&grown.races.iter().map(number).collect::<Vec<_>>())
        };
        let [usual, thin] = [balanced, thin[0]].map(|grown| {
            let steps = middle_of(grown, |at| mean(&at.steps(CTA).values()));
            format!("{steps:.1} and {:.0}", middle_of(grown, |at| at.iterations(CTA)))
        });
        format!(
            "Steps and iterations of all loops, in the middle of all sizes: {usual} on balanced faces, \
             {thin} on thin ones."
        )
    })
}
