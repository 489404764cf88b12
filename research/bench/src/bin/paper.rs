//! `paper`: the collision translation algorithm against portal refinement, on the paper's bodies,
//! in the same run.
//!
//! Every solver answers a block of settings twice, and its second pass is timed: caches hold
//! what the block needs, for all of them alike. The order changes from block to block. A query is
//! timed alone, with the clock's own cost taken off. Parry's cast of bodies of 8 vertices stands
//! beside every row, so that rows of different runs can be compared. Where the time goes is asked in
//! a further pass, of the search from the centre to the end.

use std::process::ExitCode;

use clap::Parser;
use colltrans::{BuildError, Focus, Options, Solver, Tracker, cta, observe};
use colltrans_bench::arguments::Arguments;
use colltrans_bench::parry::Scale;
use colltrans_bench::report::{self, Measured, Times};
use colltrans_bench::shapes::{Shape, body};
use colltrans_lab::settings::{Meeting, Setting};
use colltrans_lab::shapes::Bodies;
use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::ring_sphere;
use colltrans_testkit::timing::Stopwatch;
use glam::DVec3;
use serde_json::{Map, Value, json};

/// Measures the collision translation algorithm against portal refinement; prints tables
#[derive(Debug, Parser)]
struct Command {
    #[command(flatten)]
    arguments: Arguments,
    /// Leave out the sequences for region focus
    #[arg(long)]
    no_focus: bool,
}

const SIZES: [usize; 4] = [200, 2_000, 20_000, 200_000];

/// Settings of a block.
const BLOCK: usize = 20;

/// Configurations in a sequence, and its change per step in diameters.
const LENGTH: usize = 50;
const CHANGES: [f64; 3] = [0.01, 0.0025, 0.000_625];

/// How a solver narrows the search: `None` is portal refinement alone.
const COMPARED: [(&str, Option<cta::Options>); 4] = [
    ("portal", None),
    ("rough", Some(cta::Options::ROUGH)),
    ("centre 1%", Some(to(cta::Until::Gap(0.01)))),
    ("centre end", Some(to(cta::Until::Exit))),
];

/// From the centre to here, across cells where little of the region is left.
const fn to(until: cta::Until) -> cta::Options {
    cta::Options::new(cta::Start::Center, until).with_keeps_to_cell(false)
}

/// Bodies to measure on.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    /// Ellipsoids with faces as long as wide.
    Balanced,
    /// Ellipsoids with faces [`STRETCH`] times as long as wide.
    Thin,
    Other(Shape),
}

const KINDS: [Kind; 5] = [
    Kind::Balanced,
    Kind::Thin,
    Kind::Other(Shape::Superellipsoid),
    Kind::Other(Shape::HalfEllipsoid),
    Kind::Other(Shape::RandomHull),
];

const STRETCH: f64 = 100.0;

/// Only the region of the last solution is remembered.
const REGION: Focus = Focus::NONE.with_region(cta::Region::Automatic);

impl Kind {
    fn name(self) -> String {
        match self {
            Self::Balanced => "balanced".into(),
            Self::Thin => "thin".into(),
            Self::Other(shape) => shape.name(),
        }
    }

    fn bodies(self, n: usize, random: &mut Random) -> Result<Bodies, BuildError> {
        let mut one = || match self {
            Self::Balanced => Shape::Ellipsoid.draw(n, random),
            Self::Thin => {
                // The parallels' edges are `STRETCH` times the meridians'.
                let around = (n as f64 * 4.0 / (std::f64::consts::PI * STRETCH)).sqrt().max(8.0);
                let around = around.round();
                let rings = (n as f64 / around).round();
                let axes = DVec3::from_array([0; 3].map(|_| random.range(0.6, 1.4)));
                body(&ring_sphere(around as u32, rings as u32).mapped(|v| v * axes))
            }
            Self::Other(shape) => shape.draw(n, random),
        };
        Ok(Bodies::new([one()?, one()?]))
    }
}

fn main() -> ExitCode {
    let Command { arguments, no_focus } = Command::parse();
    let mut rows = Vec::new();
    for &n in arguments.sizes.as_deref().unwrap_or(&SIZES) {
        if let Err(error) = measure_size(n, &arguments, !no_focus, &mut rows) {
            eprintln!("error: bodies with {n} vertices: {error}");
            return ExitCode::FAILURE;
        }
    }
    report::write("paper", &arguments, &rows)
}

fn measure_size(
    n: usize,
    arguments: &Arguments,
    focus: bool,
    rows: &mut Vec<Value>,
) -> Result<(), BuildError> {
    let mut random = Random::stream(arguments.seed, &[n as u64]);
    let mut one = || Shape::Ellipsoid.draw(8, &mut random);
    let small = Bodies::new([one()?, one()?]);
    let scale = Scale::new(&small, BLOCK, &mut random);
    let count = if arguments.quick { 200 } else { 1000 };
    println!(
        "\nmedian ns over portal's on the colliding settings; planar problems and exchanges on \
         average; parry's median ns at 8 vertices"
    );
    for kind in KINDS {
        let bodies = [kind.bodies(n, &mut random)?, kind.bodies(n, &mut random)?];
        let mut unit = None;
        for (name, meeting) in
            [("colliding", Meeting::Colliding), ("near miss", Meeting::PassingWithin(0.05))]
        {
            let blocks = blocks(&bodies, meeting, count, &mut random);
            let (measured, parry) = one_off(&blocks, &scale);
            let unit = *unit.get_or_insert(measured[0].times.median());
            let name = format!("{}, {name}", kind.name());
            let mut row = row(&name, n, &COMPARED.map(|c| c.0), &measured, (unit, &parry));
            row["phases"] = phases(&blocks);
            rows.push(row);
        }
        if focus && matches!(kind, Kind::Balanced | Kind::Thin) {
            for change in CHANGES {
                let sequences = sequences(&bodies, change, count / LENGTH, &mut random);
                let (measured, parry) = tracked(&sequences, &scale);
                let name = format!("{}, change {:.4} %", kind.name(), 100.0 * change);
                let unit = unit.unwrap_or(f64::NAN);
                let names = ["focus 1%", "focus end", "centre end"];
                let mut row = row(&name, n, &names, &measured, (unit, &parry));
                row["phases"] = focused_phases(&sequences);
                rows.push(row);
            }
        }
    }
    Ok(())
}

/// Bodies in turn, each with settings to answer one after the other.
type Blocks<'a> = Vec<(&'a Bodies, Vec<Setting>)>;

fn blocks<'a>(
    bodies: &'a [Bodies],
    meeting: Meeting,
    count: usize,
    random: &mut Random,
) -> Blocks<'a> {
    let in_turn = bodies.iter().cycle().take(count / BLOCK);
    let mut draw = |bodies| (0..BLOCK).map(|_| Setting::draw(bodies, meeting, random)).collect();
    in_turn.map(|bodies| (bodies, draw(bodies))).collect()
}

fn sequences<'a>(
    bodies: &'a [Bodies],
    change: f64,
    count: usize,
    random: &mut Random,
) -> Blocks<'a> {
    let in_turn = bodies.iter().cycle().take(count.max(2));
    let mut draw = |b| Setting::sequence(b, Meeting::Colliding, change, LENGTH, random);
    in_turn.map(|bodies| (bodies, draw(bodies))).collect()
}

fn to_json(measured: &Measured, unit: f64) -> Value {
    let mut json = measured.to_json(&[("iterations", measured.steps.iterations)]);
    json.insert("ratio".into(), json!(measured.times.median() / unit));
    json.into()
}

fn options(narrowing: Option<cta::Options>) -> Options {
    match narrowing {
        None => Options::default().with_solver(Solver::Portal),
        Some(narrowing) => Options::default().with_solver(Solver::Cta).with_narrowing(narrowing),
    }
}

/// All solvers on all blocks, without a memory.
fn one_off(blocks: &Blocks, scale: &Scale) -> (Vec<Measured>, Times) {
    let stopwatch = Stopwatch::new();
    let mut measured: Vec<Measured> = COMPARED.iter().map(|_| Measured::default()).collect();
    let mut parry = Times::default();
    for (turn, (bodies, settings)) in blocks.iter().enumerate() {
        for k in 0..COMPARED.len() {
            let who = (turn + k) % COMPARED.len();
            let options = options(COMPARED[who].1);
            let cast = |s: &Setting| s.cast(bodies, &options)?.first_contact();
            for setting in settings {
                std::hint::black_box(cast(setting).is_ok());
            }
            for setting in settings {
                let (outcome, spent) = stopwatch.time(|| cast(setting));
                measured[who].note(spent, &outcome);
            }
        }
        scale.measure(&mut parry);
    }
    sorted(measured, parry)
}

/// Median nanoseconds of each phase of a search from the centre to the end, on all blocks.
fn phases(blocks: &Blocks) -> Value {
    let options = options(COMPARED[COMPARED.len() - 1].1);
    let mut spent = Spent::default();
    for (bodies, settings) in blocks {
        for pass in 0..2 {
            for setting in settings {
                let mut clock = observe::Clock::new();
                let cast = setting.cast(bodies, &options);
                let found = cast.and_then(|cast| cast.first_contact_observed(&mut clock));
                if pass == 1 && found.is_ok() {
                    spent.add(&clock);
                }
            }
        }
    }
    spent.medians()
}

/// The same with region focus, in sequences.
fn focused_phases(sequences: &Blocks) -> Value {
    let options = options(Some(to(cta::Until::Exit)));
    let mut spent = Spent::default();
    for (bodies, sequence) in sequences {
        let mut tracker = Tracker::new().with_focus(REGION).expect("a focus");
        for setting in sequence {
            let mut clock = observe::Clock::new();
            let cast = setting.cast(bodies, &options);
            let found = cast.and_then(|cast| tracker.first_contact_observed(&cast, &mut clock));
            if found.is_ok() {
                spent.add(&clock);
            }
        }
    }
    spent.medians()
}

/// Nanoseconds of each phase.
#[derive(Default)]
struct Spent(Vec<(&'static str, Times)>);

impl Spent {
    fn add(&mut self, clock: &observe::Clock) {
        let phases = clock.profile().phases();
        self.0.resize_with(phases.len(), || ("", Times::default()));
        for ((name, times), (phase, nanoseconds)) in self.0.iter_mut().zip(phases) {
            *name = phase;
            times.add(nanoseconds);
        }
    }

    fn medians(mut self) -> Value {
        let mut median = |(name, times): &mut (&str, Times)| {
            times.sort();
            ((*name).to_owned(), json!(times.median()))
        };
        self.0.iter_mut().map(&mut median).collect::<Map<_, _>>().into()
    }
}

/// Region focus to a gap of 1 % and to the end, and the same without focus.
fn tracked(sequences: &Blocks, scale: &Scale) -> (Vec<Measured>, Times) {
    let stopwatch = Stopwatch::new();
    let compared = [
        (cta::Until::Gap(0.01), REGION),
        (cta::Until::Exit, REGION),
        (cta::Until::Exit, Focus::NONE),
    ];
    let mut measured: Vec<Measured> = compared.iter().map(|_| Measured::default()).collect();
    let mut parry = Times::default();
    for (turn, (bodies, sequence)) in sequences.iter().enumerate() {
        for k in 0..compared.len() {
            let who = (turn + k) % compared.len();
            let (until, focus) = compared[who];
            let options = options(Some(to(until)));
            let mut tracker = Tracker::new().with_focus(focus).expect("a focus");
            for setting in sequence {
                let (outcome, spent) =
                    stopwatch.time(|| tracker.first_contact(&setting.cast(bodies, &options)?));
                measured[who].note(spent, &outcome);
            }
        }
        scale.measure(&mut parry);
    }
    sorted(measured, parry)
}

fn sorted(mut measured: Vec<Measured>, mut parry: Times) -> (Vec<Measured>, Times) {
    for m in &mut measured {
        m.times.sort();
    }
    parry.sort();
    (measured, parry)
}

/// Prints a row and makes it JSON.
fn row(
    name: &str,
    n: usize,
    names: &[&str],
    measured: &[Measured],
    (unit, parry): (f64, &Times),
) -> Value {
    print!("{name:<28} {n:>7}");
    let mut solvers = Map::new();
    for (who, m) in names.iter().zip(measured) {
        let exchanges = m.average(m.steps.pivots);
        print!(
            " | {who:>10} {:>6.2} {:>5.2} {exchanges:>5.2}",
            m.times.median() / unit,
            m.average(m.steps.planar_problems)
        );
        solvers.insert((*who).into(), to_json(m, unit));
    }
    let failures: u32 = measured.iter().map(|m| m.failures).sum();
    println!(" | {unit:>5.0} {:>5.0} {failures}", parry.median());
    json!({
        "settings": name,
        "vertices": n,
        "queries": measured[0].times.count(),
        "solvers": solvers,
        "parry_8": parry.to_json(),
    })
}
