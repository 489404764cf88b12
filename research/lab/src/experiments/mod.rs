//! The experiments, one file per family, and what they have in common: sizes, races, figures.
//!
//! A *race*: on the same blocks of settings of the same bodies every solver takes its turn,
//! block by block, the order rotating; each query is timed alone. Queries from scratch are each a
//! group of their own for the intervals, those of a sequence are one group.

mod beyond;
mod focus;
mod growth;
mod incremental;
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
use crate::statistics::{Sample, mean};
use colltrans_testkit::random::Random;
use colltrans_testkit::timing::{Stopwatch, exponent, median};

/// All experiments, in the paper's order.
pub fn experiments() -> &'static [Experiment] {
    &EXPERIMENTS
}

const EXPERIMENTS: [Experiment; 11] = [
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

    /// Pairs of bodies of a kind with `n` vertices: fewer of those that take seconds to build.
    fn pairs(&self, n: usize) -> u64 {
        let [small, middle, large] = self.by_scale([1; 3], [6, 4, 2], [12, 6, 3]);
        match n {
            ..5_000 => small,
            5_000..20_000 => middle,
            _ => large,
        }
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
    group: u32,
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
    /// Blocks, shared out among the pairs of bodies.
    blocks: usize,
}

/// What a race brought: for each solver its queries, in the same order.
struct Results {
    /// Vertices of a body, on average.
    vertices: f64,
    lanes: Vec<Vec<Measured>>,
    /// Mean diameter of the bodies of each query's pair.
    diameter: f64,
}

impl Race<'_> {
    /// Runs it on blocks of settings that `draw` makes; `purpose` tells its random numbers from
    /// those of other races of the figure.
    fn run(
        &self,
        purpose: u64,
        draw: impl Fn(&Bodies, usize, &mut Random) -> Vec<Setting>,
    ) -> Results {
        let [results] =
            self.run_in_turns(purpose, |_, bodies, count, random| draw(bodies, count, random));
        results
    }

    /// As [`run`](Self::run) for `N` variants of settings, which `draw` is told: a block of each in
    /// turn, so that whatever disturbs the machine disturbs all alike.
    fn run_in_turns<const N: usize>(
        &self,
        purpose: u64,
        draw: impl Fn(usize, &Bodies, usize, &mut Random) -> Vec<Setting>,
    ) -> [Results; N] {
        let pairs = if self.given.is_some() { 1 } else { self.plan.pairs(self.n) };
        let mut all = [(); N].map(|()| Results {
            vertices: 0.0,
            diameter: 0.0,
            lanes: vec![Vec::new(); self.who.len()],
        });
        for which in 0..pairs {
            let bodies = self.bodies(which);
            let labels = [self.figure, self.kind as u64, self.n as u64, which, purpose];
            let mut random = Random::stream(self.plan.seed, &labels);
            let mut field: Vec<_> = self.who.iter().map(|who| who.enter(&bodies)).collect();
            for results in &mut all {
                results.vertices += bodies.vertices() / pairs as f64;
                results.diameter += bodies.diameter / pairs as f64;
            }
            let blocks = self.blocks.div_ceil(pairs as usize);
            for turn in 0..blocks {
                let first = (which as usize * blocks + turn) * self.length;
                for (variant, results) in all.iter_mut().enumerate() {
                    let block = draw(variant, &bodies, self.length, &mut random);
                    for k in 0..field.len() {
                        let who = (turn + k) % field.len();
                        let lane = &mut results.lanes[who];
                        self.follow(field[who].as_mut(), &block, first as u32, lane);
                    }
                }
            }
        }
        all
    }

    fn bodies(&self, which: u64) -> Arc<Bodies> {
        let build = || shapes::bodies(self.plan.seed, self.kind, self.n, which);
        self.given.clone().unwrap_or_else(build)
    }

    /// One solver's turn at a block.
    fn follow(
        &self,
        who: &mut dyn Algorithm,
        block: &[Setting],
        first: u32,
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
                let group = if scratch { first + k as u32 } else { first };
                lane.push(Measured { nanoseconds, work, group });
            }
        }
    }
}

impl Results {
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
        let differs = |query: usize| {
            let answer = |lane: &Vec<Measured>| lane[query].work.answer;
            let own = answer(&self.lanes[who]);
            let mut others = self.lanes.iter().map(answer);
            own == Answer::Failed || others.any(|other| own.contradicts(other, self.diameter))
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

/// Tells how far an experiment is, in shares of the time that its parts are expected to take.
struct Parts<'p> {
    progress: &'p mut dyn Progress,
    done: f64,
    all: f64,
}

impl<'p> Parts<'p> {
    /// All parts take this long together.
    fn new(progress: &'p mut dyn Progress, all: f64) -> Self {
        Self { progress, done: 0.0, all }
    }

    /// A part begins that takes `share`.
    fn begin(&mut self, share: f64, doing: &str) {
        self.progress.at(self.done, self.all, doing);
        self.done += share;
    }
}

/// The time a race over bodies of `n` vertices is expected to take, beside others: queries, which
/// grow slowly, and the making of bodies and settings, which grow with `n`.
fn share(n: usize) -> f64 {
    1.0 + n as f64 / 20_000.0
}

fn shares(sizes: &[usize]) -> f64 {
    sizes.iter().map(|n| share(*n)).sum()
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
