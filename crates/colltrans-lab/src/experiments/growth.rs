//! Figure 11: how steps and time grow with the size of the bodies, and what thin faces cost.

use super::{
    Coherence, Parts, Race, Results, against_size, axis, claim, extremes, fitted, listed, middle,
    series, share, shares, thousands,
};
use crate::Experiment;
use crate::contestants::{PAPER_GAP, Until, Who};
use crate::finding::{Claim, Figure, Finding, Point};
use crate::plan::{Plan, Progress};
use crate::settings::{Meeting, Setting};
use crate::shapes::Kind;
use colltrans_kit::random::Random;
use colltrans_kit::timing::{Stopwatch, exponent, median};

pub(super) const FIGURE_11: Experiment =
    Experiment { id: "figure-11", title: "steps and time against the size of the bodies", run };

const WHO: [Who; 3] = [Who::Cta(Until::Near), Who::Cta(Until::End), Who::Portal];
const CTA: usize = 0;
const TO_THE_END: usize = 1;
const PORTAL: usize = 2;

/// What was measured at all sizes, for one kind of body.
struct Grown {
    races: Vec<Results>,
    /// Median times of CTA, in microseconds, when every query is asked twice and the second time
    /// counts: what it needs of the bodies is in the processor's caches by then.
    again: Vec<Point>,
}

fn run(plan: &Plan, progress: &mut dyn Progress) -> Finding {
    let mut parts = Parts::new(progress, 2.0 * shares(plan.sizes()));
    let [balanced, thin] =
        [Kind::Balanced, Kind::Thin].map(|kind| Grown::measure(plan, kind, &mut parts));
    let cost = thin_cost(&balanced, &thin);
    let figures =
        vec![steps_figure(&balanced, &thin), time_figure(&balanced, &thin), cost_figure(&cost)];
    let claims = vec![
        steps_grow(&balanced),
        few_steps(&balanced, TO_THE_END),
        few_steps(&balanced, CTA),
        time_grows(&balanced),
        thin_costs(&cost[0], &balanced, &thin),
    ];
    Finding { figures, tables: Vec::new(), claims }
}

impl Grown {
    fn measure(plan: &Plan, kind: Kind, parts: &mut Parts) -> Self {
        let (mut races, mut again) = (Vec::new(), Vec::new());
        for &n in plan.sizes() {
            let doing = format!("{} bodies, {} vertices", kind.name(), thousands(n as f64));
            parts.begin(share(n), &doing);
            let race = Race {
                plan,
                figure: 11,
                kind,
                n,
                who: &WHO,
                coherence: Coherence::Scratch,
                length: plan.by_scale(5, 60, 100),
                blocks: plan.by_scale(2, 25, 100),
            };
            races.push(race.run(0, |bodies, count, random| {
                (0..count).map(|_| Setting::draw(bodies, Meeting::Colliding, random)).collect()
            }));
            again.push(ask_again(&race));
        }
        Self { races, again }
    }

    /// Mean steps with standard deviations.
    fn steps(&self, who: usize) -> Vec<Point> {
        self.points(|at| Point::mean(at.vertices, &at.counts(who, |work| work.steps)))
    }

    /// Median times with quartiles, in microseconds.
    fn times(&self, who: usize) -> Vec<Point> {
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
    let mut random = Random::new(race.plan.seed, &[race.figure, race.kind as u64, race.n as u64]);
    let mut cta = WHO[CTA].enter(&bodies);
    let stopwatch = Stopwatch::new();
    let times: Vec<_> = (0..race.length * race.blocks)
        .map(|_| {
            let setting = Setting::draw(&bodies, Meeting::Colliding, &mut random);
            cta.ask(&setting);
            stopwatch.time(|| cta.ask(&setting)).1 / 1e3
        })
        .collect();
    Point::median(bodies.vertices(), &times)
}

fn steps_figure(balanced: &Grown, thin: &Grown) -> Figure {
    let to_the_end = balanced.steps(TO_THE_END);
    let mut figure = against_size(
        "figure-11-steps",
        "Minimisation steps of a query, mean and standard deviation",
        axis("steps", false),
        vec![
            series(format!("CTA to gap {PAPER_GAP}, balanced"), balanced.steps(CTA)),
            series(format!("CTA to gap {PAPER_GAP}, thin"), thin.steps(CTA)),
            series("CTA to the end, balanced", to_the_end.clone()),
            series("CTA to the end, thin", thin.steps(TO_THE_END)),
            series("portals of portal refinement, balanced", balanced.steps(PORTAL)),
        ],
    );
    figure.references = vec![fitted("log n", &to_the_end, f64::ln)];
    figure
}

fn time_figure(balanced: &Grown, thin: &Grown) -> Figure {
    let cta = balanced.times(CTA);
    let mut figure = against_size(
        "figure-11-time",
        "Time of a query from scratch, median and quartiles",
        axis("time (us)", true),
        vec![
            series("CTA, balanced", cta.clone()),
            series("CTA, thin", thin.times(CTA)),
            series("CTA, balanced, the same query again", balanced.again.clone()),
            series("CTA to the end, balanced", balanced.times(TO_THE_END)),
            series("portal refinement, balanced", balanced.times(PORTAL)),
            series("portal refinement, thin", thin.times(PORTAL)),
        ],
    );
    figure.references =
        vec![fitted("log n", &cta, f64::ln), fitted("log^2 n", &cta, |n| n.ln().powi(2))];
    figure
}

/// Median time on thin faces over that on balanced ones, of the collision translation algorithm
/// and of portal refinement.
fn thin_cost(balanced: &Grown, thin: &Grown) -> [Vec<Point>; 2] {
    [CTA, PORTAL].map(|who| {
        let ratio = |(balanced, thin): (&Results, &Results)| {
            let usual = median(&balanced.times(who));
            let times: Vec<_> = thin.times(who).iter().map(|t| t / usual).collect();
            Point::median(balanced.vertices, &times)
        };
        balanced.races.iter().zip(&thin.races).map(ratio).collect()
    })
}

fn cost_figure([cta, portal]: &[Vec<Point>; 2]) -> Figure {
    against_size(
        "figure-11-thin",
        "Time on thin and stretched faces over the median time on balanced ones",
        axis("time(thin) / time(balanced)", false),
        vec![series("CTA", cta.clone()), series("portal refinement", portal.clone())],
    )
}

/// Whether steps over `log n` at the largest size are no more than a tenth above those at the
/// smallest.
fn steps_grow(balanced: &Grown) -> Claim {
    let points = balanced.steps(TO_THE_END);
    let rise = |points: &[Point]| {
        let over_log = |p: Option<&Point>| p.map_or(f64::NAN, |p| p.y / p.x.ln());
        over_log(points.last()) / over_log(points.first())
    };
    let rise = rise(&points);
    claim(
        "The number of minimisation steps grows no faster than log n.",
        format!(
            "Steps to the end on average: {}. Steps over log n change by a factor {rise:.2} from \
             the smallest to the largest bodies; at most 1.1 is taken as \"no faster\". To a gap \
             of {PAPER_GAP} it is {} steps.",
            listed(&points, 1),
            listed(&balanced.steps(CTA), 1),
        ),
        rise <= 1.1,
        || {
            format!(
                "Steps grow like n to the {:.2} here.",
                exponent(points.iter().map(|p| (p.x, p.y)))
            )
        },
    )
}

/// The paper's limit of steps.
const FEW: f64 = 15.0;

fn few_steps(balanced: &Grown, who: usize) -> Claim {
    let points = balanced.steps(who);
    let largest = points.last().map_or(f64::NAN, |p| p.y);
    let finish = |at: &Results| {
        let mean = |part: usize| Point::mean(0.0, &at.counts(who, |work| work.finish[part])).y;
        format!("{:.1} portals and {:.1} supporting planes", mean(0), mean(1))
    };
    let after = balanced.races.last().map_or(String::new(), finish);
    let statement = if who == TO_THE_END {
        "At 200,000 faces a query takes fewer than 15 steps on average when planar problems alone \
         find the last feature."
    } else {
        "At 200,000 faces a query takes fewer than 15 steps on average when portal refinement \
         finds the last feature."
    };
    claim(
        statement,
        format!(
            "{largest:.1} planar problems at {} vertices, which are as many faces; then {after}.",
            thousands(points.last().map_or(f64::NAN, |p| p.x))
        ),
        largest < FEW,
        || {
            let at = |who: usize| balanced.times(who).last().map_or(f64::NAN, |p| p.y);
            let near = balanced.steps(CTA).last().map_or(f64::NAN, |p| p.y);
            format!(
                "After {near:.1} planar problems the bounds are within {PAPER_GAP} of the bodies' \
                 extent, at any size; the others look for the last of many small features, more of \
                 them the more features there are. When portal refinement does that instead, a \
                 query takes {:.0} us in place of {:.0} us.",
                at(CTA),
                at(TO_THE_END)
            )
        },
    )
}

/// Whether the exponent of `time = c (log n)^k` rounds to 2 or less.
fn time_grows(balanced: &Grown) -> Claim {
    let exponent_of = |points: &[Point]| exponent(points.iter().map(|p| (p.x.ln(), p.y)));
    let points = balanced.times(CTA);
    let all = exponent_of(&points);
    let again = exponent_of(&balanced.again);
    claim(
        "The time of a query grows no faster than log^2 n.",
        format!(
            "Median times of CTA in us: {}. They fit (log n)^k best with k = {all:.2}; less than \
             2.5 is taken as log^2. When the same query is asked again at once: {}, k = \
             {again:.2}.",
            listed(&points, 1),
            listed(&balanced.again, 1)
        ),
        all < 2.5,
        || {
            let reason = if again < 2.5 {
                "Asked again at once, with all that it needs in the processor's caches, a query \
                 keeps to log^2 n: it is memory that large bodies wait for."
            } else {
                "Memory does not explain it: the same query asked again at once grows faster, too. \
                 Steps do not (above), so single steps take longer: in larger bodies there is more \
                 to walk from the snapshot to the section."
            };
            reason.into()
        },
    )
}

fn thin_costs(cost: &[Point], balanced: &Grown, thin: &Grown) -> Claim {
    let [least, most] = extremes(cost);
    let typical = middle(cost);
    let again: Vec<_> = balanced
        .again
        .iter()
        .zip(&thin.again)
        .map(|(balanced, thin)| Point { y: thin.y / balanced.y, ..*balanced })
        .collect();
    claim(
        "Thin and stretched faces make a query 20 to 80 % slower.",
        format!(
            "{:.0} % in the middle of all sizes, from {:.0} % to {:.0} %. Time(thin) over \
             time(balanced): {}. When the same query is asked again at once: {}.",
            100.0 * (typical - 1.0),
            100.0 * (least - 1.0),
            100.0 * (most - 1.0),
            listed(cost, 2),
            listed(&again, 2)
        ),
        (1.2..=1.8).contains(&typical),
        || {
            let steps = [balanced, thin].map(|grown| middle(&grown.steps(CTA)));
            let calm = middle(&again);
            format!(
                "It is not the steps: {:.1} on balanced and {:.1} on thin faces in the middle of \
                 all sizes. With all that a query needs in the processor's caches its time is \
                 {calm:.2} times that on balanced faces{}.",
                steps[0],
                steps[1],
                if calm < typical - 0.2 {
                    ": much of the rest is waiting for memory, because walks around a section pass \
                     many more edges"
                } else {
                    ""
                }
            )
        },
    )
}
