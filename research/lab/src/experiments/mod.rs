//! The experiments, one file per family, and what they have in common: sizes, races, figures.
//!
//! A *race*: on the same blocks of settings of the same bodies every solver takes its turn,
//! block by block, the order rotating; each query is timed alone. Queries from scratch are each a
//! group of their own for the intervals, those of a sequence are one group. An experiment goes over all its
//! races once in every *pass*, each time with other bodies: what the machine did in a stretch of time
//! is in one pass of all of them ([`crate::statistics`]).

mod beyond;
mod focus;
mod growth;
mod incremental;
mod minimisation;
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

/// All experiments, in the paper's order.
pub fn experiments() -> &'static [Experiment] {
    &EXPERIMENTS
}

const EXPERIMENTS: [Experiment; 12] = [
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
];

/// What is told apart by scale.
impl Plan {
    /// One of three values.
    fn by_scale<T>(&self, tiny: T, quick: T, full: T) -> T {
        match self.scale {
            Scale::Tiny => tiny,
            Scale::Quick => quick,
            Scale::Full => full,
        }
    }

    /// Numbers of vertices, ascending.
    fn sizes(&self) -> &'static [usize] {
        let all = &[200, 800, 3_200, 12_800, 51_200, 200_000];
        self.by_scale(&[50, 200], all, all)
    }

    /// A number of vertices of the paper's, or a few at the smallest scale.
    fn size(&self, n: usize) -> usize {
        self.by_scale(200, n, n)
    }

    /// Passes over bodies of `n` vertices, each with a pair of its own: fewer where these take seconds to make, but
    /// in a full run, or as many as were asked for.
    fn passes(&self, n: usize) -> u32 {
        self.passes.unwrap_or(self.by_scale(1, if n < 20_000 { 4 } else { 2 }, 8))
    }
}

/// Measures each of `items` once in every pass over its bodies; `told` says how many vertices these have and
/// what is going on.
fn in_passes<I, T: Gathered>(
    plan: &Plan,
    progress: &mut dyn Progress,
    items: &[I],
    told: impl Fn(&I) -> (usize, String),
    measure: impl Fn(&I, u32) -> T,
) -> Vec<T> {
    let passes = |item: &I| plan.passes(told(item).0);
    let all = items.iter().map(|item| f64::from(passes(item)) * share(told(item).0)).sum();
    let mut done = 0.0;
    let mut found: Vec<Option<T>> = items.iter().map(|_| None).collect();
    for pass in 0..items.iter().map(passes).max().unwrap_or(0) {
        for (item, found) in items.iter().zip(&mut found) {
            if pass >= passes(item) {
                continue;
            }
            let (n, doing) = told(item);
            progress.at(done, all, &doing);
            done += share(n);
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

/// What a pass adds to those before.
trait Gathered {
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

/// Whether queries start from the ones before.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Coherence {
    /// No: each from scratch.
    Scratch,
    /// Yes, within a block; the first query of a block, from scratch, does not count.
    Blocks,
}

/// One query of one solver.
#[derive(Debug, Clone, Copy)]
struct Measured {
    nanoseconds: f64,
    work: Work,
    /// What belongs together when settings are drawn anew.
    group: Group,
}

/// Who races on what.
struct Race<'a> {
    plan: &'a Plan,
    /// Number of the figure: its settings are drawn from a stream of their own.
    figure: u64,
    kind: Kind,
    /// Vertices.
    n: usize,
    /// These bodies in place of some of that kind and size.
    given: Option<Arc<Bodies>>,
    who: &'a [Who],
    coherence: Coherence,
    /// Settings in a block.
    length: usize,
    /// Blocks in a pass.
    blocks: usize,
}

/// What a race brought: for each solver its queries, in the same order.
struct Results {
    /// Of all passes: vertices of a body and mean diameter of the bodies, on average.
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
    /// One pass on blocks of settings that `draw` makes; `purpose` tells its random numbers from
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

    /// As [`run`](Self::run) for `N` variants of settings, which `draw` is told: a block of each in
    /// turn, so that whatever disturbs the machine disturbs all alike.
    fn run_in_turns<const N: usize>(
        &self,
        pass: u32,
        purpose: u64,
        draw: impl Fn(usize, &Bodies, usize, &mut Random) -> Vec<Setting>,
    ) -> [Results; N] {
        let bodies = self.bodies(pass);
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
                    self.follow(field[who].as_mut(), &block, first, lane);
                }
            }
        }
        all
    }

    fn bodies(&self, pass: u32) -> Arc<Bodies> {
        let build = || shapes::bodies(self.plan.seed, self.kind, self.n, u64::from(pass));
        self.given.clone().unwrap_or_else(build)
    }

    /// One solver's turn at a block.
    fn follow(
        &self,
        who: &mut dyn Algorithm,
        block: &[Setting],
        first: Group,
        lane: &mut Vec<Measured>,
    ) {
        let stopwatch = Stopwatch::new();
        let scratch = self.coherence == Coherence::Scratch;
        who.forget();
        if scratch && let Some(first) = block.first() {
            // Warms up: code and tables that the solver before has pushed out of the caches.
            who.ask(first);
        }
        for (k, setting) in block.iter().enumerate() {
            if scratch {
                who.forget();
            }
            let (work, nanoseconds) = stopwatch.time(|| who.ask(setting));
            if scratch || k > 0 {
                let number = if scratch { first.number + k as u32 } else { first.number };
                let group = Group { number, ..first };
                lane.push(Measured { nanoseconds, work, group });
            }
        }
    }
}

impl Results {
    /// Vertices of a body, on average.
    fn vertices(&self) -> f64 {
        mean(&self.bodies.iter().map(|[vertices, _]| *vertices).collect::<Vec<_>>())
    }

    /// The times of a solver, in nanoseconds.
    fn times(&self, who: usize) -> Vec<f64> {
        self.lanes[who].iter().map(|m| m.nanoseconds).collect()
    }

    /// A number of every query of a solver, in groups.
    fn sample(&self, who: usize, number: impl Fn(&Measured) -> f64) -> Sample {
        Sample::of(self.lanes[who].iter().map(|m| (m.group, number(m))))
    }

    fn steps(&self, who: usize) -> Sample {
        self.sample(who, |m| f64::from(m.work.steps))
    }

    /// Iterations of all loops, on average.
    fn iterations(&self, who: usize) -> f64 {
        mean(&self.sample(who, |m| f64::from(m.work.iterations)).values())
    }

    fn time_sample(&self, who: usize) -> Sample {
        self.sample(who, |m| m.nanoseconds)
    }

    /// Query by query, how many times as long one solver took as another.
    fn ratios(&self, who: usize, other: usize) -> Sample {
        let pairs = self.lanes[who].iter().zip(&self.lanes[other]);
        Sample::of(pairs.map(|(a, b)| (a.group, a.nanoseconds / b.nanoseconds)))
    }

    /// How often a solver failed or contradicted the first who answered the same question.
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

/// How far two exact answers may differ, in diameters, after the rounding of either.
const AGREEMENT: f64 = 1e-9;

impl Answer {
    fn contradicts(self, other: Self, diameter: f64) -> bool {
        let apart = |a: f64, b: f64| (a - b).abs() > AGREEMENT * diameter;
        match (self, other) {
            (Self::Meet(a), Self::Meet(b)) | (Self::Distance(a), Self::Distance(b)) => apart(a, b),
            (Self::Meet(_) | Self::MeetNearly, Self::Pass)
            | (Self::Pass, Self::Meet(_) | Self::MeetNearly) => true,
            _ => false,
        }
    }
}

/// The time a race over bodies of `n` vertices is expected to take, beside others: queries, which
/// grow slowly, and the making of bodies and settings, which grow with `n`.
fn share(n: usize) -> f64 {
    1.0 + n as f64 / 20_000.0
}

fn axis(label: &str, log: bool) -> Axis {
    Axis { label: label.into(), log }
}

/// A figure with a logarithmic axis of sizes.
fn against_size(id: &str, title: &str, y: Axis, series: Vec<Series>) -> Figure {
    let x = axis("vertices of each body", true);
    Figure { id: id.into(), title: title.into(), x, y, series, references: Vec::new() }
}

fn series(name: impl Into<String>, points: Vec<Point>) -> Series {
    Series { name: name.into(), points }
}

/// A curve to compare with: no measurements, no spread.
fn reference(name: &str, at: impl Iterator<Item = f64>, curve: impl Fn(f64) -> f64) -> Series {
    let point = |x| {
        let y = curve(x);
        Point { x, y, low: y, high: y, count: 0 }
    };
    series(name, at.map(point).collect())
}

/// `curve`, scaled to pass through the middle of the points.
fn fitted(name: &str, points: &[Point], curve: impl Fn(f64) -> f64) -> Series {
    let logs: f64 = points.iter().map(|p| (p.y / curve(p.x)).ln()).sum();
    let scale = (logs / points.len() as f64).exp();
    reference(name, points.iter().map(|p| p.x), |x| scale * curve(x))
}

/// A time for people.
fn time(nanoseconds: f64) -> String {
    if nanoseconds < 1e3 {
        format!("{nanoseconds:.0} ns")
    } else if nanoseconds < 1e6 {
        format!("{:.1} µs", nanoseconds / 1e3)
    } else {
        format!("{:.1} ms", nanoseconds / 1e6)
    }
}

/// Numbers of a curve for people, from the first to the last point.
fn listed(points: &[Point], digits: usize) -> String {
    let text: Vec<_> =
        points.iter().map(|p| format!("{:.digits$} ({})", p.y, thousands(p.x))).collect();
    text.join(", ")
}

/// A number of vertices with its thousands apart.
fn thousands(n: f64) -> String {
    let n = n.round() as u64;
    if n < 10_000 { n.to_string() } else { format!("{},{:03}", n / 1_000, n % 1_000) }
}

/// The middle of the medians.
fn middle(samples: &[Vec<f64>]) -> f64 {
    median(&samples.iter().map(|values| median(values)).collect::<Vec<_>>())
}

fn means(samples: &[Vec<f64>]) -> Vec<f64> {
    samples.iter().map(|values| mean(values)).collect()
}

fn medians(samples: &[Vec<f64>]) -> Vec<f64> {
    samples.iter().map(|values| median(values)).collect()
}

/// The exponent of medians as a power of the sizes.
fn exponent_of(sizes: &[f64], samples: &[Vec<f64>]) -> f64 {
    exponent(sizes.iter().copied().zip(medians(samples)))
}
