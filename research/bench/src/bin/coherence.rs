//! `coherence`: trackers against casts from scratch, on the same sequences in the same run, with
//! parry's cast of bodies of 8 vertices beside them for scale.
//!
//! Every solver works through a whole sequence before the next takes its turn; the order
//! changes from sequence to sequence. A query is timed alone, with the clock's own cost taken off.

use std::process::ExitCode;

use clap::Parser;
use colltrans::{Focus, Options, Outcome, QueryError, Solver, Tracker, cta};
use colltrans_bench::arguments::Arguments;
use colltrans_bench::parry::Scale;
use colltrans_bench::report::{self, Measured, Times};
use colltrans_bench::shapes::{Shape, body};
use colltrans_lab::settings::{Meeting, Setting};
use colltrans_lab::shapes::Bodies;
use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::{even_rings, ring_sphere};
use colltrans_testkit::timing::Stopwatch;
use serde_json::{Value, json};

/// Measures trackers against casts from scratch on the same sequences; prints tables
#[derive(Debug, Parser)]
struct Command {
    #[command(flatten)]
    arguments: Arguments,
}

const SIZES: [usize; 4] = [200, 2_000, 20_000, 200_000];

/// Configurations in a sequence.
const LENGTH: usize = 100;

/// Change per step, in diameters.
const DELTAS: [f64; 4] = [0.01, 0.005, 0.0025, 0.0013];

/// Degrees per step of the orbit.
const ALPHAS_DEG: [f64; 10] = [0.1, 0.25, 0.5, 1.0, 2.5, 5.0, 10.0, 30.0, 90.0, 180.0];

/// Who answers the queries of a sequence.
#[derive(Debug, Clone, Copy)]
struct Compared {
    name: &'static str,
    solver: Solver,
    /// If none, the tracker decides.
    focus: Option<Focus>,
    narrowing: cta::Options,
}

const COMPARED: [Compared; 6] = [
    Compared { name: "scratch", solver: Solver::Auto, focus: Some(Focus::NONE), narrowing: PAPER },
    Compared { name: "tracker", solver: Solver::Auto, focus: None, narrowing: PAPER },
    Compared { name: "cta", solver: Solver::Cta, focus: Some(Focus::NONE), narrowing: PAPER },
    Compared { name: "cta region", solver: Solver::Cta, focus: Some(REGION), narrowing: PAPER },
    Compared {
        name: "rough",
        solver: Solver::Cta,
        focus: Some(Focus::NONE),
        narrowing: cta::Options::ROUGH,
    },
    Compared {
        name: "rough tracker",
        solver: Solver::Cta,
        focus: Some(BOTH),
        narrowing: cta::Options::ROUGH,
    },
];

const REGION: Focus = Focus::NONE.with_region(cta::Region::Automatic);
const BOTH: Focus = Focus::NONE.with_features(true).with_region(cta::Region::Automatic);

/// The paper's: from the centre of the levels until the exit test; of no effect on the others.
const PAPER: cta::Options = cta::Options::new(cta::Start::Center, cta::Until::Exit);

fn main() -> ExitCode {
    let Command { arguments } = Command::parse();
    let mut rows = Vec::new();
    for &n in arguments.sizes.as_deref().unwrap_or(&SIZES) {
        match measure_size(n, &arguments, &mut rows) {
            Ok(()) => {}
            Err(error) => {
                eprintln!("error: ellipsoids with {n} vertices: {error}");
                return ExitCode::FAILURE;
            }
        }
    }
    report::write("coherence", &arguments, &rows)
}

/// All rows of a size.
fn measure_size(
    n: usize,
    arguments: &Arguments,
    rows: &mut Vec<Value>,
) -> Result<(), colltrans::BuildError> {
    let mut random = Random::stream(arguments.seed, &[n as u64]);
    let mut pair = |n| -> Result<Bodies, colltrans::BuildError> {
        let mut one = || Shape::Ellipsoid.draw(n, &mut random);
        Ok(Bodies::new([one()?, one()?]))
    };
    let bodies = [pair(n)?, pair(n)?];
    let [around, rings] = even_rings(n);
    let sphere = body(&ring_sphere(around, rings))?;
    let spheres = [Bodies::new([sphere.clone(), sphere])];
    let small = pair(8)?;
    let count = if arguments.quick { 12 } else { 60 };
    let mut table = Table { n, scale: Scale::new(&small, LENGTH, &mut random), rows };
    print_header();
    for (name, meeting) in
        [("colliding", Meeting::Colliding), ("separated", Meeting::PassingWithin(0.2))]
    {
        for delta in DELTAS {
            let draw =
                |bodies: &Bodies| Setting::sequence(bodies, meeting, delta, LENGTH, &mut random);
            let sequences = in_turn(&bodies, count, draw);
            table.add(&format!("{:.2} %, {name}", 100.0 * delta), &sequences);
        }
        let draw = |bodies: &Bodies| {
            (0..LENGTH).map(|_| Setting::draw(bodies, meeting, &mut random)).collect()
        };
        let sequences = in_turn(&bodies, count, draw);
        table.add(&format!("random, {name}"), &sequences);
    }
    for alpha in ALPHAS_DEG {
        let draw = |bodies: &Bodies| Setting::orbit(bodies, alpha, LENGTH, &mut random);
        let sequences = in_turn(&spheres, count, draw);
        table.add(&format!("orbit {alpha} deg"), &sequences);
    }
    Ok(())
}

/// Sequences of several pairs in turn, each with its bodies.
fn in_turn(
    bodies: &[Bodies],
    count: usize,
    mut draw: impl FnMut(&Bodies) -> Vec<Setting>,
) -> Vec<(&Bodies, Vec<Setting>)> {
    bodies.iter().cycle().take(count).map(|bodies| (bodies, draw(bodies))).collect()
}

/// Lets a solver follow a sequence.
fn follow(
    measured: &mut Measured,
    compared: &Compared,
    bodies: &Bodies,
    sequence: &[Setting],
) -> Vec<Result<Outcome, QueryError>> {
    let stopwatch = Stopwatch::new();
    let Compared { solver, narrowing, focus, .. } = *compared;
    let options = Options::default().with_solver(solver).with_narrowing(narrowing);
    let mut tracker = match focus {
        Some(focus) => Tracker::new().with_focus(focus).expect("a focus"),
        None => Tracker::new(),
    };
    let mut outcomes = Vec::with_capacity(sequence.len());
    for setting in sequence {
        let (outcome, spent) = stopwatch.time(|| {
            let cast = setting.cast(bodies, &options)?;
            if focus == Some(Focus::NONE) {
                cast.first_contact()
            } else {
                tracker.first_contact(&cast)
            }
        });
        measured.note(spent, &outcome);
        outcomes.push(outcome);
    }
    outcomes
}

/// The rows of one size.
struct Table<'a> {
    n: usize,
    scale: Scale,
    rows: &'a mut Vec<Value>,
}

impl Table<'_> {
    /// Lets every solver follow every sequence, prints a row and keeps it.
    fn add(&mut self, name: &str, sequences: &[(&Bodies, Vec<Setting>)]) {
        let mut measured: [Measured; COMPARED.len()] = Default::default();
        let mut parry = Times::default();
        let mut differences = 0;
        for (turn, (bodies, sequence)) in sequences.iter().enumerate() {
            let mut answers: [Vec<_>; COMPARED.len()] = Default::default();
            for k in 0..COMPARED.len() {
                let who = (turn + k) % COMPARED.len();
                answers[who] = follow(&mut measured[who], &COMPARED[who], bodies, sequence);
            }
            self.scale.measure(&mut parry);
            let [reference, others @ ..] = &answers;
            let differs = |answers: &Vec<_>| {
                answers.iter().zip(reference).filter(|(a, b)| !agree(a, b)).count()
            };
            differences += others.iter().map(differs).sum::<usize>();
        }
        parry.sort();
        for measured in &mut measured {
            measured.times.sort();
        }
        print_row(name, self.n, &measured, &parry, differences);
        let solvers: serde_json::Map<String, Value> = COMPARED
            .iter()
            .zip(&measured)
            .map(|(compared, measured)| {
                let by_features = [("by_features", measured.by_features)];
                (compared.name.into(), measured.to_json(&by_features).into())
            })
            .collect();
        self.rows.push(json!({
            "sequences": name,
            "vertices": self.n,
            "queries": measured[0].times.count(),
            "solvers": solvers,
            "parry_8": parry.to_json(),
            "differences": differences,
        }));
    }
}

/// Whether two answers are the same, within what their certificates leave open.
fn agree(a: &Result<Outcome, QueryError>, b: &Result<Outcome, QueryError>) -> bool {
    match (a, b) {
        (Ok(Outcome::Contact(a)), Ok(Outcome::Contact(b))) => {
            let tolerance = a.certificate.rounding.max(b.certificate.rounding);
            (a.translation - b.translation).abs() <= tolerance
        }
        (Ok(Outcome::Separated(_)), Ok(Outcome::Separated(_)))
        | (Ok(Outcome::Grazing(_)), Ok(Outcome::Grazing(_))) => true,
        _ => false,
    }
}

fn print_header() {
    println!(
        "\nmedian ns, and mean without the slowest hundredth; % = answered by feature focus; \
         planar problems, supports and pivots on average; tracker over scratch by medians and by \
         means; mean of the tracker over parry's mean at 8 vertices"
    );
    print!("{:<18} {:>7}", "sequences", "n");
    for compared in &COMPARED {
        print!(
            " | {:>11} {:>6} {:>3} {:>6} {:>5} {:>5}",
            compared.name, "mean", "%", "planar", "sup", "piv"
        );
    }
    println!(" | ratio means parry, diff fail");
}

fn print_row(name: &str, n: usize, measured: &[Measured], parry: &Times, differences: usize) {
    print!("{name:<18} {n:>7}");
    for m in measured {
        print!(
            " | {:>11.0} {:>6.0} {:>3.0} {:>6.2} {:>5.2} {:>5.2}",
            m.times.median(),
            m.times.mean(),
            100.0 * m.average(m.by_features),
            m.average(m.steps.planar_problems),
            m.average(m.steps.supports),
            m.average(m.steps.pivots),
        );
    }
    let [scratch, tracker, ..] = measured else { return };
    let failures: u32 = measured.iter().map(|m| m.failures).sum();
    println!(
        " | {:.2} {:.2} {:.2}, {differences} {failures}",
        tracker.times.median() / scratch.times.median(),
        tracker.times.mean() / scratch.times.mean(),
        tracker.times.mean() / parry.mean(),
    );
}
