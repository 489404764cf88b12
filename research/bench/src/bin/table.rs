//! `table`: all solvers and `parry3d-f64` in the same run on the same settings.
//!
//! A query is timed alone, with the clock's own cost taken off. The solvers take turns, each on a
//! block of settings that none of the others has just visited: each meets its bodies as cold as a
//! program that does many different queries does, and a disturbance of the machine hits all of
//! them. *Cold* rows go through 4 MiB of other data before each query.

use std::cell::RefCell;
use std::hint::black_box;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use clap::{Parser, ValueEnum};
use colltrans::{BuildError, ConvexPolyhedron, Options, Outcome, QueryError, Solver};
use colltrans_bench::arguments::Arguments;
use colltrans_bench::parry::{self, ParrySetting};
use colltrans_bench::report::{self, Measured};
use colltrans_bench::shapes::Shape;
use colltrans_bench::ties::{Placement, Tie};
use colltrans_lab::settings::{Meeting, Setting};
use colltrans_lab::shapes::Bodies;
use colltrans_testkit::random::Random;
use colltrans_testkit::timing::Stopwatch;
use serde_json::{Value, json};

/// Measures all solvers and parry3d-f64 on the same settings; prints a table
#[derive(Debug, Parser)]
struct Command {
    #[command(flatten)]
    arguments: Arguments,
    /// Only these rows
    #[arg(long, value_enum)]
    group: Option<Group>,
    /// Of random positions only shapes with this in their names
    #[arg(long)]
    shape: Option<String>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Group {
    /// Random positions and orientations
    General,
    /// Aligned, resting, edge over edge
    Ties,
    /// The same after other work
    Cold,
}

const SOLVERS: [(&str, Solver); 3] =
    [("cta", Solver::Cta), ("portal", Solver::Portal), ("auto", Solver::Auto)];

const SIZES: [usize; 8] = [8, 32, 128, 512, 2_000, 10_000, 50_000, 200_000];

/// Settings that one solver works through before the next takes its turn.
const BLOCK: usize = 25;

/// Our solvers and parry.
const COMPARED: usize = SOLVERS.len() + 1;

/// Two answers agree when they differ by less than this share of the bodies' length; parry stops at
/// about as much.
const AGREEMENT: f64 = 1e-4;

fn main() -> ExitCode {
    let Command { arguments, group, shape: only } = Command::parse();
    let mut rows = Vec::new();
    let mut note = |row: Row| {
        row.print();
        rows.push(row.to_json());
    };
    print_header();
    if group.is_none_or(|group| group == Group::General) {
        for (shape, n) in plan(arguments.sizes.as_deref().unwrap_or(&SIZES)) {
            if only.as_ref().is_some_and(|part| !shape.name().contains(part)) {
                continue;
            }
            match general(shape, n, &arguments) {
                Ok(two) => two.into_iter().for_each(&mut note),
                Err(error) => {
                    eprintln!("error: {} with {n} vertices: {error}", shape.name());
                    return ExitCode::FAILURE;
                }
            }
        }
    }
    if group.is_none_or(|group| group == Group::Ties) {
        for tie in Tie::ALL {
            for placement in Placement::ALL {
                note(tied(tie, placement, placement.name(), None, &arguments));
            }
        }
    }
    if group.is_none_or(|group| group == Group::Cold) {
        for tie in Tie::ALL {
            let other = Some(RefCell::new(vec![0; OTHER / size_of::<u64>()]));
            note(tied(tie, Placement::Rotated, "rotated, cold", other, &arguments));
        }
    }
    report::write("table", &arguments, &rows)
}

/// Which shapes in which sizes: all sizes of ellipsoids; of the others some.
fn plan(sizes: &[usize]) -> Vec<(Shape, usize)> {
    use Shape::{
        Bicone, Box, Chamfered, Cone, Cylinder, Ellipsoid, Frustum, HalfEllipsoid, Needle, Plate,
        Prism, RandomHull, Superellipsoid,
    };
    let small = [8, 32, 128, 2_000, 10_000];
    let some = [32, 128, 2_000, 10_000, 200_000];
    let rows: [(Shape, &[usize]); 15] = [
        (Ellipsoid, sizes),
        (RandomHull, &[32, 128, 2_000, 10_000, 200_000]),
        (Box, &[8]),
        (Needle(100.0), &some),
        (Needle(1000.0), &some),
        (Plate(100.0), &some),
        (Plate(1000.0), &some),
        (Superellipsoid, &small[1..]),
        (HalfEllipsoid, &small[1..]),
        (Prism, &small[1..]),
        (Cylinder, &some),
        (Chamfered, &small[2..]),
        (Cone, &some),
        (Frustum, &small[2..]),
        (Bicone, &small[2..]),
    ];
    let of = |(shape, chosen): (Shape, &[usize])| {
        let here = sizes.iter().copied().filter(|n| chosen.contains(n));
        here.map(move |n| (shape, n)).collect::<Vec<_>>()
    };
    rows.into_iter().flat_map(of).collect()
}

/// Bytes that are gone through before each query where the caches are to be cold.
const OTHER: usize = 4 << 20;

/// Pairs of bodies and settings of them.
struct Cases {
    pairs: Vec<Bodies>,
    /// With the number of its pair.
    settings: Vec<(usize, Setting)>,
    build: Duration,
    /// What else is gone through before each query, if it is.
    other: Option<RefCell<Vec<u64>>>,
}

impl Cases {
    fn other_work(&self) {
        if let Some(other) = &self.other {
            other.borrow_mut().iter_mut().for_each(|x| *x = x.wrapping_add(1));
            black_box(other);
        }
    }
}

/// Both rows of a shape and a size.
fn general(shape: Shape, n: usize, arguments: &Arguments) -> Result<[Row; 2], BuildError> {
    let mut random = Random::stream(arguments.seed, &[n as u64]);
    let count = if n >= 50_000 { 2 } else { 4 };
    let started = Instant::now();
    let mut pair = || -> Result<Bodies, BuildError> {
        Ok(Bodies::new([shape.draw(n, &mut random)?, shape.draw(n, &mut random)?]))
    };
    let pairs = (0..count).map(|_| pair()).collect::<Result<Vec<_>, _>>()?;
    let build = started.elapsed() / (2 * count);
    let mut cases = Cases { pairs, settings: Vec::new(), build, other: None };
    let settings = match (arguments.quick, n >= 100_000) {
        (true, true) => 100,
        (true, false) | (false, true) => 200,
        (false, false) => 1000,
    };
    Ok(["colliding", "separated"].map(|meeting| {
        let mut random = Random::stream(arguments.seed, &[n as u64, meeting.len() as u64, 1]);
        let draw = |k: usize| {
            let bodies = &cases.pairs[k % cases.pairs.len()];
            let meeting = match meeting {
                "colliding" => Meeting::Colliding,
                _ => Meeting::Passing(10.0_f64.powf(random.range(-3.0, -0.3)) / bodies.diameter),
            };
            (k % cases.pairs.len(), Setting::draw(bodies, meeting, &mut random))
        };
        cases.settings = (0..settings).map(draw).collect();
        Row::measure((shape.name(), n), meeting, &cases, arguments)
    }))
}

/// A row of tied settings.
fn tied(
    tie: Tie,
    placement: Placement,
    name: &'static str,
    other: Option<RefCell<Vec<u64>>>,
    arguments: &Arguments,
) -> Row {
    let mut random = Random::stream(arguments.seed, &[tie as u64, placement as u64, 2]);
    let started = Instant::now();
    let pairs: Vec<_> = (0..8).map(|_| tie.bodies(&mut random)).collect();
    let build = started.elapsed() / 16;
    let count = if arguments.quick { 200 } else { 1000 };
    let settings = (0..count)
        .map(|k| (k % pairs.len(), tie.draw(&pairs[k % pairs.len()], placement, &mut random)))
        .collect();
    let cases = Cases { pairs, settings, build, other };
    Row::measure((tie.name().into(), 0), name, &cases, arguments)
}

/// Asks `colltrans`.
fn ask(bodies: &Bodies, setting: &Setting, solver: Solver) -> Result<Outcome, QueryError> {
    setting.cast(bodies, &Options::default().with_solver(solver))?.first_contact()
}

/// Asks all settings of a block.
fn measure(measured: &mut Measured, cases: &Cases, solver: Solver, block: &[(usize, Setting)]) {
    let stopwatch = Stopwatch::new();
    for (pair, setting) in block {
        cases.other_work();
        let (outcome, spent) = stopwatch.time(|| ask(&cases.pairs[*pair], setting, solver));
        if measured.count(&outcome) {
            measured.times.add(spent);
        }
    }
}

struct Row {
    shape: String,
    asked: usize,
    meeting: &'static str,
    vertices: usize,
    build: Duration,
    bytes_per_vertex: f64,
    ours: [Measured; SOLVERS.len()],
    theirs: Measured,
    /// Settings to which parry gave another answer.
    disagreements: u32,
    settings: usize,
}

impl Row {
    fn measure(
        (shape, asked): (String, usize),
        meeting: &'static str,
        cases: &Cases,
        arguments: &Arguments,
    ) -> Self {
        let all = || cases.pairs.iter().flat_map(|bodies| &bodies.pair);
        let vertices = all().map(|b| b.vertices().len()).sum::<usize>();
        let bytes = all().map(ConvexPolyhedron::memory_bytes).sum::<usize>();
        let mut row = Self {
            shape,
            asked,
            meeting,
            vertices: vertices / all().count(),
            build: cases.build,
            bytes_per_vertex: bytes as f64 / vertices as f64,
            ours: Default::default(),
            theirs: Measured::default(),
            disagreements: 0,
            settings: cases.settings.len(),
        };
        row.take_turns(cases, if arguments.quick { 2 } else { 5 });
        for measured in row.ours.iter_mut().chain([&mut row.theirs]) {
            measured.times.sort();
        }
        row
    }

    fn take_turns(&mut self, cases: &Cases, passes: usize) {
        let theirs: Vec<_> =
            cases.pairs.iter().map(|bodies| bodies.pair.each_ref().map(parry::body)).collect();
        let blocks: Vec<_> = cases.settings.chunks(BLOCK).collect();
        for pass in 0..passes {
            for turn in 0..blocks.len() {
                let block = |compared: usize| {
                    blocks[(turn + compared * blocks.len() / COMPARED) % blocks.len()]
                };
                for (index, (_, solver)) in SOLVERS.into_iter().enumerate() {
                    measure(&mut self.ours[index], cases, solver, block(index));
                }
                // Parry's linear support search at these sizes needs no second look.
                if pass == 0 || self.vertices < 9_000 {
                    self.measure_parry(cases, &theirs, block(SOLVERS.len()), pass == 0);
                }
            }
        }
    }

    fn measure_parry(
        &mut self,
        cases: &Cases,
        theirs: &[[Option<parry3d_f64::shape::ConvexPolyhedron>; 2]],
        block: &[(usize, Setting)],
        compare: bool,
    ) {
        let stopwatch = Stopwatch::new();
        for (pair, setting) in block {
            let [Some(moving), Some(fixed)] = &theirs[*pair] else {
                self.theirs.failures += 1;
                continue;
            };
            let converted = ParrySetting::new(setting);
            cases.other_work();
            let (answer, spent) = stopwatch.time(|| converted.cast(moving, fixed));
            self.theirs.times.add(spent);
            if compare && !agrees(setting, &cases.pairs[*pair], answer) {
                self.disagreements += 1;
            }
        }
    }

    /// Parry's median and mean over ours.
    fn ratios(&self, solver: usize) -> [f64; 2] {
        let (theirs, ours) = (&self.theirs.times, &self.ours[solver].times);
        [theirs.median() / ours.median(), theirs.mean() / ours.mean()]
    }

    fn print(&self) {
        print!("{:<18} {:>6} {:<16}", self.shape, self.vertices, self.meeting);
        print!(" {:>8.2} {:>4.0}", self.build.as_secs_f64() * 1e3, self.bytes_per_vertex);
        for measured in &self.ours {
            let times = &measured.times;
            print!(" {:>7.0} {:>7.0}", times.median(), times.quantile(0.99));
        }
        print!(" {:>8.0} {:>8.0}", self.theirs.times.median(), self.theirs.times.quantile(0.99));
        print!(" {:>7.2} {:>7.2}", self.ratios(0)[0], self.ratios(1)[0]);
        let [median, mean] = self.ratios(2);
        print!(" {median:>7.2} {mean:>7.2}");
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
        let ratio = |k: usize| {
            let [median, mean] = self.ratios(k);
            json!({ "median": median, "mean": mean })
        };
        json!({
            "shape": self.shape,
            "vertices_asked": self.asked,
            "vertices": self.vertices,
            "meeting": self.meeting,
            "settings": self.settings,
            "build_ms": self.build.as_secs_f64() * 1e3,
            "bytes_per_vertex": self.bytes_per_vertex,
            "cta": cta.to_json(&[]),
            "portal": portal.to_json(&[]),
            "auto": auto.to_json(&[]),
            "parry": self.theirs.to_json(&[]),
            "parry_disagreements": self.disagreements,
            "parry_over": { "cta": ratio(0), "portal": ratio(1), "auto": ratio(2) },
        })
    }
}

fn print_header() {
    println!(
        "ns: median and 99th percentile; x: parry's median over ours, mx: parry's mean over ours \
         (means without the slowest hundredth); planar problems and supports on average"
    );
    println!(
        "{:<18} {:>6} {:<16} {:>8} {:>4} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7} {:>8} {:>8} {:>7} \
         {:>7} {:>7} {:>7} {:>6} {:>6} {:>6} {:>4} {:>4}",
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
        "mx auto",
        "planar",
        "s cta",
        "s port",
        "fail",
        "diff"
    );
}

/// Whether parry's answer is ours, within what parry promises.
fn agrees(setting: &Setting, bodies: &Bodies, theirs: Option<f64>) -> bool {
    match (ask(bodies, setting, Solver::Portal), theirs) {
        (Ok(Outcome::Contact(contact)), Some(time)) => {
            // Parry knows no contacts that lie behind.
            (contact.translation - time).abs() <= AGREEMENT || contact.translation < AGREEMENT
        }
        (Ok(Outcome::Separated(_)), None) | (Ok(Outcome::Grazing(_)), _) => true,
        _ => false,
    }
}
