//! The experiments, one file for each family, and their common parts: sizes, races, figures.
//!
//! In a *race* every solver answers the same blocks of settings of the same bodies, block by block in
//! rotating order, and each query is timed separately. For the intervals, each query from scratch is a group,
//! and the queries of a sequence are one group. In every *pass* an experiment runs all its races once with
//! other bodies. Therefore temporary effects of the machine are in one pass of all races
//! ([`crate::statistics`]).

mod beyond;
mod focus;
mod growth;
mod incremental;
mod minimisation;
mod neighbours;
mod profile;
mod rivals;
mod separation;
mod variable;

use std::sync::Arc;

use crate::Experiment;
use crate::finding::{Axis, Figure, Point, Series};
use crate::plan::{Plan, Progress, Scale};
use crate::settings::Setting;
use crate::shapes::{self, Bodies, Kind};
use crate::solvers::{Algorithm, Answer, Who, Work};
use crate::statistics::{Group, Sample, mean};
use colltrans_testkit::random::Random;
use colltrans_testkit::timing::{Stopwatch, exponent, median};

/// Returns all experiments in the paper's order.
pub fn experiments() -> &'static [Experiment] {
    &EXPERIMENTS
}

/// All experiments in the paper's order.
const EXPERIMENTS: [Experiment; 13] = [
    minimisation::SECTION_3,
    growth::FIGURE_11,
    profile::TABLE_1,
    separation::FIGURE_12,
    focus::FIGURE_13,
    focus::FIGURE_14,
    rivals::FIGURE_15,
    rivals::FIGURE_16,
    rivals::FIGURE_17,
    incremental::FIGURE_18,
    variable::FIGURE_19,
    beyond::BEYOND,
    neighbours::CASTS,
];

/// Parameters that depend on the scale.
impl Plan {
    /// Returns one of three values by scale.
    fn by_scale<T>(&self, tiny: T, quick: T, full: T) -> T {
        match self.scale {
            Scale::Tiny => tiny,
            Scale::Quick => quick,
            Scale::Full => full,
        }
    }

    /// Returns the numbers of vertices, ascending.
    fn sizes(&self) -> &'static [usize] {
        let all = &[200, 800, 3_200, 12_800, 51_200, 200_000];
        self.by_scale(&[50, 200], all, all)
    }

    /// Returns the paper's number of vertices, or few at the smallest scale.
    fn size(&self, n: usize) -> usize {
        self.by_scale(200, n, n)
    }

    /// Returns the number of passes over bodies of `n` vertices, each with another pair. A quick run has
    /// fewer passes over large bodies, which take seconds to build. A requested number replaces this one.
    fn passes(&self, n: usize) -> u32 {
        self.passes.unwrap_or(self.by_scale(1, if n < 20_000 { 4 } else { 2 }, 8))
    }
}

/// Measures each of `items` once in every pass over its bodies. `describe` returns the number of vertices of
/// these and the current activity.
fn in_passes<I, T: Gathered>(
    plan: &Plan,
    progress: &mut dyn Progress,
    items: &[I],
    describe: impl Fn(&I) -> (usize, String),
    measure: impl Fn(&I, u32) -> T,
) -> Vec<T> {
    let passes = |item: &I| plan.passes(describe(item).0);
    let all =
        items.iter().map(|item| f64::from(passes(item)) * expected_share(describe(item).0)).sum();
    let mut done = 0.0;
    let mut found: Vec<Option<T>> = items.iter().map(|_| None).collect();
    for pass in 0..items.iter().map(passes).max().unwrap_or(0) {
        for (item, found) in items.iter().zip(&mut found) {
            if pass >= passes(item) {
                continue;
            }
            let (n, doing) = describe(item);
            progress.at(done, all, &doing);
            done += expected_share(n);
            let more = measure(item, pass);
            match found {
                Some(found) => found.gather(more),
                None => *found = Some(more),
            }
        }
        shapes::forget_large();
    }
    found.into_iter().flatten().collect()
}

/// Measures bodies with balanced faces, thin faces and thin meridians at all sizes. Returns the results of each
/// kind in the order of the sizes.
fn by_kind_and_size<T: Gathered>(
    plan: &Plan,
    progress: &mut dyn Progress,
    measure: impl Fn(Kind, usize, u32) -> T,
) -> [Vec<T>; 3] {
    let kinds = [Kind::Balanced, Kind::Thin, Kind::ThinMeridians];
    let sizes = plan.sizes();
    let items: Vec<_> = kinds.iter().flat_map(|kind| sizes.iter().map(|n| (*kind, *n))).collect();
    let describe = |&(kind, n): &(Kind, usize)| {
        (n, format!("{} bodies, {} vertices", kind.name(), grouped_digits(n as f64)))
    };
    let measure = |&(kind, n): &(Kind, usize), pass| measure(kind, n, pass);
    let mut measured = in_passes(plan, progress, &items, describe, measure).into_iter();
    kinds.map(|_| measured.by_ref().take(sizes.len()).collect())
}

/// Results that several passes extend.
trait Gathered {
    /// Adds the results of another pass.
    fn gather(&mut self, more: Self);
}

impl<T: Gathered, const N: usize> Gathered for [T; N] {
    fn gather(&mut self, more: Self) {
        self.iter_mut().zip(more).for_each(|(all, more)| all.gather(more));
    }
}

impl<A: Gathered, B: Gathered> Gathered for (A, B) {
    fn gather(&mut self, more: Self) {
        self.0.gather(more.0);
        self.1.gather(more.1);
    }
}

/// Whether queries start from previous ones.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Coherence {
    /// Each query starts from scratch.
    Scratch,
    /// Queries start from the previous one of a block. The first query of a block does not count.
    Blocks,
}

/// A query of one solver.
#[derive(Debug, Clone, Copy)]
struct Measured {
    nanoseconds: f64,
    work: Work,
    /// Estimate from the counts ([`Who::instructions`]).
    instructions: f64,
    /// Group for the bootstrap.
    group: Group,
}

/// Unit of the cost of a query.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Unit {
    /// Instructions, estimated from counts. Verdicts are by these, because they do not depend on the machine.
    Instructions,
    /// Nanoseconds.
    Time,
}

impl Unit {
    /// Returns the cost of a query.
    fn of(self, query: &Measured) -> f64 {
        match self {
            Self::Instructions => query.instructions,
            Self::Time => query.nanoseconds,
        }
    }
}

/// Solvers and settings of a race.
struct Race<'a> {
    plan: &'a Plan,
    /// Number of the figure, which selects the stream of random settings.
    figure: u64,
    kind: Kind,
    /// Number of vertices.
    n: usize,
    /// Bodies to use instead of those of the kind and size.
    given: Option<Arc<Bodies>>,
    who: &'a [Who],
    coherence: Coherence,
    /// Number of settings in a block.
    length: usize,
    /// Number of blocks in a pass.
    blocks: usize,
}

/// Results of a race: for each solver its queries, in the same order.
struct Results {
    /// For each pass, the mean number of vertices and the mean diameter of the bodies.
    bodies: Vec<[f64; 2]>,
    lanes: Vec<Vec<Measured>>,
}

impl Gathered for Results {
    fn gather(&mut self, more: Self) {
        self.bodies.extend(more.bodies);
        self.lanes.iter_mut().zip(more.lanes).for_each(|(lane, more)| lane.extend(more));
    }
}

impl Race<'_> {
    /// Runs one pass on blocks of settings made by `draw`. `purpose` distinguishes its random numbers from
    /// those of other races of the figure.
    fn run(
        &self,
        pass: u32,
        purpose: u64,
        draw: impl Fn(&Bodies, usize, &mut Random) -> Vec<Setting>,
    ) -> Results {
        let [results] = self
            .run_in_turns(pass, purpose, |_, bodies, count, random| draw(bodies, count, random));
        results
    }

    /// Runs one pass for `N` variants of settings, whose index `draw` receives. Blocks of all variants
    /// alternate, so that disturbances of the machine affect all of them equally.
    fn run_in_turns<const N: usize>(
        &self,
        pass: u32,
        purpose: u64,
        draw: impl Fn(usize, &Bodies, usize, &mut Random) -> Vec<Setting>,
    ) -> [Results; N] {
        let bodies = self.pass_bodies(pass);
        let mut all = [(); N].map(|()| Results {
            bodies: vec![[bodies.vertices(), bodies.diameter]],
            lanes: vec![Vec::new(); self.who.len()],
        });
        let labels = [self.figure, self.kind as u64, self.n as u64, u64::from(pass), purpose];
        let mut random = Random::stream(self.plan.seed, &labels);
        let mut field: Vec<_> = self.who.iter().map(|who| who.enter(&bodies)).collect();
        for turn in 0..self.blocks {
            let first = Group { pass, number: (turn * self.length) as u32 };
            for (variant, results) in all.iter_mut().enumerate() {
                let block = draw(variant, &bodies, self.length, &mut random);
                for k in 0..field.len() {
                    let who = (turn + k) % field.len();
                    let lane = &mut results.lanes[who];
                    self.measure_block((field[who].as_mut(), self.who[who]), &block, first, lane);
                }
            }
        }
        all
    }

    /// Returns the bodies of a pass.
    fn pass_bodies(&self, pass: u32) -> Arc<Bodies> {
        let build = || shapes::bodies(self.plan.seed, self.kind, self.n, u64::from(pass));
        self.given.clone().unwrap_or_else(build)
    }

    /// Measures one solver on a block.
    fn measure_block(
        &self,
        (solver, who): (&mut dyn Algorithm, Who),
        block: &[Setting],
        first: Group,
        lane: &mut Vec<Measured>,
    ) {
        let stopwatch = Stopwatch::new();
        let scratch = self.coherence == Coherence::Scratch;
        solver.forget();
        if scratch && let Some(first) = block.first() {
            // A warm-up loads code and tables that the previous solver displaced from the caches.
            solver.ask(first);
        }
        for (k, setting) in block.iter().enumerate() {
            if scratch {
                solver.forget();
            }
            let (work, nanoseconds) = stopwatch.time(|| solver.ask(setting));
            if scratch || k > 0 {
                let number = if scratch { first.number + k as u32 } else { first.number };
                let group = Group { number, ..first };
                let instructions = who.instructions(work);
                lane.push(Measured { nanoseconds, work, instructions, group });
            }
        }
    }
}

impl Results {
    /// Returns the mean number of vertices of a body.
    fn vertices(&self) -> f64 {
        mean(&self.bodies.iter().map(|[vertices, _]| *vertices).collect::<Vec<_>>())
    }

    /// Returns the times of a solver in nanoseconds.
    fn times(&self, who: usize) -> Vec<f64> {
        self.lanes[who].iter().map(|m| m.nanoseconds).collect()
    }

    /// Returns a number of every query of a solver, by group.
    fn sample(&self, who: usize, number: impl Fn(&Measured) -> f64) -> Sample {
        Sample::of(self.lanes[who].iter().map(|m| (m.group, number(m))))
    }

    /// Returns the steps of a solver.
    fn steps(&self, who: usize) -> Sample {
        self.sample(who, |m| f64::from(m.work.steps))
    }

    /// Returns the mean number of iterations of all loops.
    fn iterations(&self, who: usize) -> f64 {
        mean(&self.sample(who, |m| f64::from(m.work.iterations)).values())
    }

    /// Returns for each query the ratio of the costs of two solvers.
    fn ratios(&self, who: usize, other: usize, unit: Unit) -> Sample {
        let pairs = self.lanes[who].iter().zip(&self.lanes[other]);
        Sample::of(pairs.map(|(a, b)| (a.group, unit.of(a) / unit.of(b))))
    }

    /// Returns the costs of a solver, by group.
    fn costs(&self, who: usize, unit: Unit) -> Sample {
        self.sample(who, |m| unit.of(m))
    }

    /// Formats the median instructions and the median time of a solver, with their ratio.
    fn cost_text(&self, who: usize) -> String {
        let [time, count] =
            [Unit::Time, Unit::Instructions].map(|unit| median(&self.costs(who, unit).values()));
        format!(
            "{} instructions in {} ({:.1} a ns)",
            count_text(count),
            time_text(time),
            count / time
        )
    }

    /// Counts the queries in which a solver failed or contradicted another one.
    fn contradictions(&self, who: usize) -> usize {
        let diameter = mean(&self.bodies.iter().map(|[_, diameter]| *diameter).collect::<Vec<_>>());
        let differs = |query: usize| {
            let answer = |lane: &Vec<Measured>| lane[query].work.answer;
            let own = answer(&self.lanes[who]);
            let mut others = self.lanes.iter().map(answer);
            own == Answer::Failed || others.any(|other| own.contradicts(other, diameter))
        };
        (0..self.lanes[who].len()).filter(|query| differs(*query)).count()
    }
}

/// Maximum difference of two exact answers, in diameters.
const AGREEMENT: f64 = 1e-9;

impl Answer {
    /// Checks whether two answers exclude each other.
    fn contradicts(self, other: Self, diameter: f64) -> bool {
        let apart = |a: f64, b: f64| (a - b).abs() > AGREEMENT * diameter;
        match (self, other) {
            (Self::Meet(a), Self::Meet(b)) | (Self::Distance(a), Self::Distance(b)) => apart(a, b),
            (Self::Meet(_) | Self::MeetNearly, Self::Pass)
            | (Self::Pass, Self::Meet(_) | Self::MeetNearly) => true,
            (Self::Overlap(a), Self::Overlap(b)) => a != b,
            (Self::Overlap(overlaps), Self::Distance(distance))
            | (Self::Distance(distance), Self::Overlap(overlaps)) => overlaps != (distance == 0.0),
            _ => false,
        }
    }
}

/// Returns the relative duration of a race over bodies of `n` vertices: queries, whose time grows slowly, and
/// the construction of bodies and settings, whose time grows with `n`.
fn expected_share(n: usize) -> f64 {
    1.0 + n as f64 / 20_000.0
}

/// Creates an axis.
fn new_axis(label: &str, log: bool) -> Axis {
    Axis { label: label.into(), log }
}

/// Creates a figure with a logarithmic axis of sizes.
fn against_size(id: &str, title: &str, y: Axis, series: Vec<Series>) -> Figure {
    let x = new_axis("vertices of each body", true);
    Figure { id: id.into(), title: title.into(), x, y, series, references: Vec::new() }
}

/// Creates a curve.
fn new_series(name: impl Into<String>, points: Vec<Point>) -> Series {
    Series { name: name.into(), points }
}

/// Creates a curve for comparison, without spread.
fn reference_curve(
    name: &str,
    at: impl Iterator<Item = f64>,
    curve: impl Fn(f64) -> f64,
) -> Series {
    let point = |x| {
        let y = curve(x);
        Point { x, y, low: y, high: y, count: 0 }
    };
    new_series(name, at.map(point).collect())
}

/// Creates a reference of `curve`, scaled to the mean of the points on a logarithmic scale.
fn fitted_reference(name: &str, points: &[Point], curve: impl Fn(f64) -> f64) -> Series {
    let logs: f64 = points.iter().map(|p| (p.y / curve(p.x)).ln()).sum();
    let scale = (logs / points.len() as f64).exp();
    reference_curve(name, points.iter().map(|p| p.x), |x| scale * curve(x))
}

/// Formats a large count.
fn count_text(count: f64) -> String {
    if count < 1e6 {
        format!("{:.0} thousand", count / 1e3)
    } else {
        format!("{:.1} million", count / 1e6)
    }
}

/// Formats a time.
fn time_text(nanoseconds: f64) -> String {
    if nanoseconds < 1e3 {
        format!("{nanoseconds:.0} ns")
    } else if nanoseconds < 1e6 {
        format!("{:.1} µs", nanoseconds / 1e3)
    } else {
        format!("{:.1} ms", nanoseconds / 1e6)
    }
}

/// Formats the values of a curve from the first to the last point.
fn listed_values(points: &[Point], digits: usize) -> String {
    let text: Vec<_> =
        points.iter().map(|p| format!("{:.digits$} ({})", p.y, grouped_digits(p.x))).collect();
    text.join(", ")
}

/// Formats a number of vertices with a separator of thousands.
fn grouped_digits(n: f64) -> String {
    let n = n.round() as u64;
    if n < 10_000 { n.to_string() } else { format!("{},{:03}", n / 1_000, n % 1_000) }
}

/// Returns the median of the medians.
fn median_of_medians(samples: &[Vec<f64>]) -> f64 {
    median(&samples.iter().map(|values| median(values)).collect::<Vec<_>>())
}

/// Returns the means of samples.
fn sample_means(samples: &[Vec<f64>]) -> Vec<f64> {
    samples.iter().map(|values| mean(values)).collect()
}

/// Returns the medians of samples.
fn sample_medians(samples: &[Vec<f64>]) -> Vec<f64> {
    samples.iter().map(|values| median(values)).collect()
}

/// Returns the exponent of medians as a power of the sizes.
fn exponent_of(sizes: &[f64], samples: &[Vec<f64>]) -> f64 {
    exponent(sizes.iter().copied().zip(sample_medians(samples)))
}
