//! The experiments, one file per family, and what they have in common: sizes, races, figures.
//!
//! A *race*: on the same blocks of settings of the same bodies every contestant takes its turn,
//! block by block, the order rotating; each query is timed alone.

mod focus;
mod growth;
mod incremental;
mod profile;
mod rivals;
mod separation;
mod variable;

use std::sync::Arc;

use crate::Experiment;
use crate::contestants::{Answer, Contestant, Who, Work};
use crate::finding::{Axis, Claim, Figure, Point, Series};
use crate::plan::{Plan, Progress, Scale};
use crate::settings::Setting;
use crate::shapes::{self, Bodies, Kind};
use colltrans_kit::random::Random;
use colltrans_kit::timing::Stopwatch;

/// All experiments, in the paper's order.
pub fn experiments() -> &'static [Experiment] {
    &EXPERIMENTS
}

const EXPERIMENTS: [Experiment; 10] = [
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

    /// Pairs of bodies of every kind and size.
    fn pairs(&self) -> u64 {
        self.by_scale(1, 1, 3)
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

/// One query of one contestant.
#[derive(Debug, Clone, Copy)]
struct Measured {
    nanoseconds: f64,
    work: Work,
}

/// Who races on what.
struct Race<'a> {
    plan: &'a Plan,
    /// Number of the figure: its settings are drawn from a stream of their own.
    figure: u64,
    kind: Kind,
    /// Vertices.
    n: usize,
    who: &'a [Who],
    coherence: Coherence,
    /// Settings in a block.
    length: usize,
    /// Blocks, shared out among the pairs of bodies.
    blocks: usize,
}

/// What a race brought: for each contestant its queries, in the same order.
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
        let pairs = self.plan.pairs();
        let mut lanes = vec![Vec::new(); self.who.len()];
        let (mut vertices, mut diameter) = (0.0, 0.0);
        for which in 0..pairs {
            let bodies = self.bodies(which);
            vertices += bodies.vertices() / pairs as f64;
            diameter += bodies.diameter / pairs as f64;
            let labels = [self.figure, self.kind as u64, self.n as u64, which, purpose];
            let mut random = Random::new(self.plan.seed, &labels);
            let mut field: Vec<_> = self.who.iter().map(|who| who.enter(&bodies)).collect();
            let blocks = self.blocks.div_ceil(pairs as usize);
            for turn in 0..blocks {
                let block = draw(&bodies, self.length, &mut random);
                for k in 0..field.len() {
                    let who = (turn + k) % field.len();
                    self.follow(field[who].as_mut(), &block, &mut lanes[who]);
                }
            }
        }
        Results { vertices, lanes, diameter }
    }

    fn bodies(&self, which: u64) -> Arc<Bodies> {
        shapes::bodies(self.plan.seed, self.kind, self.n, which)
    }

    /// One contestant's turn at a block.
    fn follow(&self, who: &mut dyn Contestant, block: &[Setting], lane: &mut Vec<Measured>) {
        let stopwatch = Stopwatch::new();
        let scratch = self.coherence == Coherence::Scratch;
        who.forget();
        if scratch && let Some(first) = block.first() {
            // Warms up: code and tables that the contestant before has pushed out of the caches.
            who.ask(first);
        }
        for (k, setting) in block.iter().enumerate() {
            if scratch {
                who.forget();
            }
            let (work, nanoseconds) = stopwatch.time(|| who.ask(setting));
            if scratch || k > 0 {
                lane.push(Measured { nanoseconds, work });
            }
        }
    }
}

impl Results {
    /// The times of a contestant, in nanoseconds.
    fn times(&self, who: usize) -> Vec<f64> {
        self.lanes[who].iter().map(|m| m.nanoseconds).collect()
    }

    /// A number of every query of a contestant.
    fn counts(&self, who: usize, count: impl Fn(&Work) -> u32) -> Vec<f64> {
        self.lanes[who].iter().map(|m| f64::from(count(&m.work))).collect()
    }

    /// Query by query, how many times as long one contestant took as another.
    fn ratios(&self, who: usize, other: usize) -> Vec<f64> {
        let pairs = self.lanes[who].iter().zip(&self.lanes[other]);
        pairs.map(|(a, b)| a.nanoseconds / b.nanoseconds).collect()
    }

    /// How often a contestant failed or contradicted the first who answered the same question.
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

/// A verdict, with the reason where it is against the claim.
fn claim(statement: &str, measured: String, holds: bool, why: impl FnOnce() -> String) -> Claim {
    let why = (!holds).then(why);
    Claim { statement: statement.into(), measured, holds, why }
}

/// How far a number may be off, as a share of it, where the paper says "about".
const ABOUT: f64 = 0.25;

fn about(measured: f64, claimed: f64) -> bool {
    (measured / claimed - 1.0).abs() <= ABOUT
}

/// A time for people.
fn time(nanoseconds: f64) -> String {
    if nanoseconds < 1e3 {
        format!("{nanoseconds:.0} ns")
    } else if nanoseconds < 1e6 {
        format!("{:.1} us", nanoseconds / 1e3)
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

/// The points of largest and smallest `y`.
fn extremes(points: &[Point]) -> [f64; 2] {
    let fold = |f: fn(f64, f64) -> f64, from| points.iter().map(|p| p.y).fold(from, f);
    [fold(f64::min, f64::INFINITY), fold(f64::max, f64::NEG_INFINITY)]
}

/// The middle of all points' `y`.
fn middle(points: &[Point]) -> f64 {
    colltrans_kit::timing::median(&points.iter().map(|p| p.y).collect::<Vec<_>>())
}
