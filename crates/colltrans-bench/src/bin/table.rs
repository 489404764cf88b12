//! Measures all solvers and `parry3d-f64` in the same run on the same settings; prints a table and
//! writes JSON.
//!
//! ```text
//! table [--quick] [--sizes 8,128,2000] [--json FILE] [--seed S]
//! ```
//!
//! A query is timed alone, with the clock's own cost taken off. The solvers take turns, each on a
//! block of settings that none of the others has just visited: each meets its bodies as cold as a
//! program that does many different queries does, and a disturbance of the machine hits all of
//! them.

use std::hint::black_box;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use colltrans::{ConvexPolyhedron, Outcome, Solver, Steps};
use colltrans_bench::arguments::{self, Arguments};
use colltrans_bench::parry::{self, ParrySetting};
use colltrans_bench::report::{self, clock_cost, quantile};
use colltrans_bench::settings::{Meeting, Setting};
use colltrans_bench::shapes::Shape;
use colltrans_oracle::settings::Rng;
use serde_json::{Value, json};

const SOLVERS: [(&str, Solver); 3] =
    [("cta", Solver::Cta), ("portal", Solver::Portal), ("auto", Solver::Auto)];

const USAGE: &str = "table [--quick] [--sizes 8,128,2000] [--json FILE] [--seed S]";

/// Settings that one solver works through before the next takes its turn.
const BLOCK: usize = 25;

/// Our solvers and parry.
const CONTESTANTS: usize = SOLVERS.len() + 1;

/// Two answers agree when they differ by less than this share of the bodies' length; parry stops at
/// about as much.
const AGREEMENT: f64 = 1e-4;

fn main() -> ExitCode {
    let sizes = [8, 32, 128, 512, 2_000, 10_000, 50_000, 200_000];
    arguments::start(USAGE, &sizes, run)
}

fn run(arguments: &Arguments) -> ExitCode {
    let mut rows = Vec::new();
    print_header();
    for (shape, sizes) in plan(&arguments.sizes) {
        for n in sizes {
            match Bodies::build(shape, n, arguments.seed) {
                Ok(bodies) => {
                    for meeting in [Meeting::Colliding, Meeting::Separated] {
                        let row = Row::measure(&bodies, meeting, arguments);
                        row.print();
                        rows.push(row.to_json());
                    }
                }
                Err(error) => {
                    eprintln!("{} with {n} vertices: {error}", shape.name());
                    return ExitCode::FAILURE;
                }
            }
        }
    }
    report::write(arguments, &rows)
}

/// Which shapes in which sizes: all sizes of ellipsoids; of the others one in two.
fn plan(sizes: &[usize]) -> Vec<(Shape, Vec<usize>)> {
    let some: Vec<usize> =
        sizes.iter().copied().filter(|n| [128, 2_000, 10_000, 200_000].contains(n)).collect();
    let mut plan = vec![(Shape::Ellipsoid, sizes.to_vec())];
    for shape in [
        Shape::RandomHull,
        Shape::Needle(100.0),
        Shape::Needle(1000.0),
        Shape::Plate(100.0),
        Shape::Plate(1000.0),
    ] {
        plan.push((shape, some.clone()));
    }
    plan
}

/// The bodies of one size of a shape, in both libraries.
struct Bodies {
    shape: Shape,
    asked: usize,
    ours: Vec<ConvexPolyhedron>,
    theirs: Vec<Option<parry3d_f64::shape::ConvexPolyhedron>>,
    build: Duration,
}

impl Bodies {
    fn build(shape: Shape, n: usize, seed: u64) -> Result<Self, colltrans::BuildError> {
        let mut rng = Rng::new(seed ^ n as u64);
        let count = if n >= 50_000 { 3 } else { 8 };
        let started = Instant::now();
        let ours = (0..count).map(|_| shape.draw(n, &mut rng)).collect::<Result<Vec<_>, _>>()?;
        let build = started.elapsed() / count;
        let theirs = ours.iter().map(parry::body).collect();
        Ok(Self { shape, asked: n, ours, theirs, build })
    }
}

/// Measurements of one solver in one row.
#[derive(Default)]
struct Measured {
    nanoseconds: Vec<f64>,
    steps: Steps,
    answers: u32,
    failures: u32,
}

impl Measured {
    fn measure(&mut self, bodies: &[ConvexPolyhedron], solver: Solver, block: &[Setting]) {
        let clock = clock_cost();
        for setting in block {
            let started = Instant::now();
            let outcome = black_box(black_box(setting).cast(bodies, solver));
            let spent = started.elapsed();
            let Ok(outcome) = outcome else {
                self.failures += 1;
                continue;
            };
            self.note(spent, clock);
            let steps = outcome.steps();
            self.steps.planar_problems += steps.planar_problems;
            self.steps.supports += steps.supports;
            self.steps.pivots += steps.pivots;
        }
    }

    fn note(&mut self, spent: Duration, clock: f64) {
        self.nanoseconds.push((spent.as_nanos() as f64 - clock).max(0.0));
        self.answers += 1;
    }

    fn quantile(&self, share: f64) -> f64 {
        quantile(&self.nanoseconds, share)
    }

    fn average(&self, count: u32) -> f64 {
        f64::from(count) / f64::from(self.answers.max(1))
    }

    fn to_json(&self) -> Value {
        json!({
            "median_ns": self.quantile(0.5),
            "p99_ns": self.quantile(0.99),
            "planar_problems": self.average(self.steps.planar_problems),
            "supports": self.average(self.steps.supports),
            "pivots": self.average(self.steps.pivots),
            "failures": self.failures,
        })
    }
}

struct Row {
    shape: Shape,
    asked: usize,
    meeting: Meeting,
    vertices: usize,
    build: Duration,
    bytes_per_vertex: f64,
    ours: [Measured; 3],
    theirs: Measured,
    /// Settings to which parry gave another answer.
    disagreements: u32,
    settings: usize,
}

impl Row {
    fn measure(bodies: &Bodies, meeting: Meeting, arguments: &Arguments) -> Self {
        let mut rng = Rng::new(arguments.seed.wrapping_mul(77) ^ bodies.asked as u64);
        let count = match (arguments.quick, bodies.asked >= 100_000) {
            (true, true) => 100,
            (true, false) | (false, true) => 200,
            (false, false) => 1000,
        };
        let settings: Vec<Setting> =
            (0..count).map(|_| Setting::draw(&bodies.ours, meeting, &mut rng)).collect();
        let vertices = bodies.ours.iter().map(|b| b.vertices().len()).sum::<usize>();
        let bytes = bodies.ours.iter().map(ConvexPolyhedron::memory_bytes).sum::<usize>();
        let mut row = Self {
            shape: bodies.shape,
            asked: bodies.asked,
            meeting,
            vertices: vertices / bodies.ours.len(),
            build: bodies.build,
            bytes_per_vertex: bytes as f64 / vertices as f64,
            ours: Default::default(),
            theirs: Measured::default(),
            disagreements: 0,
            settings: count,
        };
        let passes = if arguments.quick { 2 } else { 5 };
        let blocks: Vec<&[Setting]> = settings.chunks(BLOCK).collect();
        for pass in 0..passes {
            for turn in 0..blocks.len() {
                let block = |contestant: usize| {
                    blocks[(turn + contestant * blocks.len() / CONTESTANTS) % blocks.len()]
                };
                for (index, (_, solver)) in SOLVERS.into_iter().enumerate() {
                    row.ours[index].measure(&bodies.ours, solver, block(index));
                }
                // Parry's linear support search at these sizes needs no second look.
                if pass == 0 || bodies.asked < 10_000 {
                    row.measure_parry(bodies, block(SOLVERS.len()), pass == 0);
                }
            }
        }
        for measured in row.ours.iter_mut().chain([&mut row.theirs]) {
            measured.nanoseconds.sort_by(f64::total_cmp);
        }
        row
    }

    fn measure_parry(&mut self, bodies: &Bodies, block: &[Setting], compare: bool) {
        let clock = clock_cost();
        for setting in block {
            let pair = (&bodies.theirs[setting.moving], &bodies.theirs[setting.fixed]);
            let (Some(moving), Some(fixed)) = pair else {
                self.theirs.failures += 1;
                continue;
            };
            let theirs = ParrySetting::new(setting);
            let started = Instant::now();
            let answer = black_box(black_box(&theirs).cast(moving, fixed));
            self.theirs.note(started.elapsed(), clock);
            if compare && !agrees(setting, &bodies.ours, answer) {
                self.disagreements += 1;
            }
        }
    }

    fn ratio(&self, solver: usize) -> f64 {
        self.theirs.quantile(0.5) / self.ours[solver].quantile(0.5)
    }

    fn print(&self) {
        print!(
            "{:<14} {:>7} {:<10} {:>9.2} {:>5.0}",
            self.shape.name(),
            self.vertices,
            self.meeting.name(),
            self.build.as_secs_f64() * 1e3,
            self.bytes_per_vertex,
        );
        for measured in &self.ours {
            print!(" {:>8.0} {:>8.0}", measured.quantile(0.5), measured.quantile(0.99));
        }
        print!(" {:>9.0} {:>9.0}", self.theirs.quantile(0.5), self.theirs.quantile(0.99));
        print!(" {:>7.2} {:>7.2} {:>7.2}", self.ratio(0), self.ratio(1), self.ratio(2));
        let [cta, portal, _] = &self.ours;
        print!(
            " {:>6.1} {:>6.1} {:>6.1}",
            cta.average(cta.steps.planar_problems),
            cta.average(cta.steps.supports),
            portal.average(portal.steps.supports),
        );
        let failures: u32 = self.ours.iter().map(|m| m.failures).sum();
        println!(" {failures:>4} {:>4}", self.disagreements + self.theirs.failures);
    }

    fn to_json(&self) -> Value {
        let [cta, portal, auto] = &self.ours;
        json!({
            "shape": self.shape.name(),
            "vertices_asked": self.asked,
            "vertices": self.vertices,
            "meeting": self.meeting.name(),
            "settings": self.settings,
            "build_ms": self.build.as_secs_f64() * 1e3,
            "bytes_per_vertex": self.bytes_per_vertex,
            "cta": cta.to_json(),
            "portal": portal.to_json(),
            "auto": auto.to_json(),
            "parry": self.theirs.to_json(),
            "parry_disagreements": self.disagreements,
            "ratio_parry_to": { "cta": self.ratio(0), "portal": self.ratio(1), "auto": self.ratio(2) },
        })
    }
}

fn print_header() {
    println!(
        "median and 99th percentile in ns; x = parry's median / ours; planar problems and supports on average"
    );
    println!(
        "{:<14} {:>7} {:<10} {:>9} {:>5} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>9} {:>9} {:>7} {:>7} {:>7} {:>6} {:>6} {:>6} {:>4} {:>4}",
        "shape",
        "n",
        "",
        "build ms",
        "B/n",
        "cta",
        "p99",
        "portal",
        "p99",
        "auto",
        "p99",
        "parry",
        "p99",
        "x cta",
        "x port",
        "x auto",
        "planar",
        "s cta",
        "s port",
        "fail",
        "diff"
    );
}

/// Whether parry's answer is ours, within what parry promises.
fn agrees(setting: &Setting, bodies: &[ConvexPolyhedron], theirs: Option<f64>) -> bool {
    match (setting.cast(bodies, Solver::Portal), theirs) {
        (Ok(Outcome::Contact(contact)), Some(time)) => {
            (contact.translation - time).abs() <= AGREEMENT
        }
        (Ok(Outcome::Separated(_)), None) | (Ok(Outcome::Grazing(_)), _) => true,
        _ => false,
    }
}
