//! Measures trackers against casts from scratch, on the same sequences in the same run; prints
//! tables and writes JSON.
//!
//! ```text
//! coherence [--quick] [--sizes 200,2000] [--json FILE] [--seed S]
//! ```
//!
//! Every contestant works through a whole sequence before the next takes its turn; the order
//! changes from sequence to sequence. A query is timed alone, with the clock's own cost taken off.

use std::f64::consts::PI;
use std::hint::black_box;
use std::process::ExitCode;
use std::time::Instant;

use colltrans::{
    ConvexPolyhedron, Focus, NarrowFrom, Narrowing, Options, Outcome, QueryError, Region, Solver,
    StartedFrom, Steps, Tracker, cast_with,
};
use colltrans_bench::arguments::{self, Arguments};
use colltrans_bench::motion::{Motion, orbit, sequence};
use colltrans_bench::report::{self, clock_cost, quantile};
use colltrans_bench::settings::{Meeting, Setting};
use colltrans_bench::shapes::Shape;
use colltrans_oracle::settings::Rng;
use serde_json::{Value, json};

const USAGE: &str = "coherence [--quick] [--sizes 200,2000] [--json FILE] [--seed S]";

/// Configurations in a sequence.
const LENGTH: usize = 100;

/// Change per step, in diameters.
const DELTAS: [f64; 4] = [0.01, 0.005, 0.0025, 0.0013];

/// Degrees per step of the orbit.
const ALPHAS_DEG: [f64; 10] = [0.1, 0.25, 0.5, 1.0, 2.5, 5.0, 10.0, 30.0, 90.0, 180.0];

/// Who answers the queries of a sequence.
#[derive(Debug, Clone, Copy)]
struct Contestant {
    name: &'static str,
    solver: Solver,
    focus: Focus,
    narrowing: Narrowing,
}

const CONTESTANTS: [Contestant; 6] = [
    Contestant { name: "scratch", solver: Solver::Auto, focus: Focus::NONE, narrowing: SHIPPED },
    Contestant { name: "tracker", solver: Solver::Auto, focus: BOTH, narrowing: SHIPPED },
    Contestant { name: "cta", solver: Solver::Cta, focus: Focus::NONE, narrowing: SHIPPED },
    Contestant { name: "cta tracker", solver: Solver::Cta, focus: BOTH, narrowing: SHIPPED },
    Contestant { name: "paper", solver: Solver::Cta, focus: Focus::NONE, narrowing: PAPER },
    Contestant { name: "paper region", solver: Solver::Cta, focus: REGION, narrowing: PAPER },
];

const REGION: Focus = Focus { features: false, region: Region::Automatic };
const BOTH: Focus = Focus { features: true, region: Region::Automatic };

/// What a user gets.
const SHIPPED: Narrowing = Narrowing { start: NarrowFrom::Ellipsoids, gap: 0.2 };

/// The paper's: from the centre of the levels, most of the way by planar problems.
const PAPER: Narrowing = Narrowing { start: NarrowFrom::Center, gap: 0.01 };

fn main() -> ExitCode {
    arguments::start(USAGE, &[200, 2_000, 20_000, 200_000], run)
}

fn run(arguments: &Arguments) -> ExitCode {
    let mut rows = Vec::new();
    for &n in &arguments.sizes {
        let mut rng = Rng::new(arguments.seed ^ n as u64);
        let bodies: Result<Vec<_>, _> =
            (0..4).map(|_| Shape::Ellipsoid.draw(n, &mut rng)).collect();
        let spheres = colltrans_bench::shapes::ring_ellipsoid(n, glam::DVec3::ONE);
        let (bodies, sphere) = match (bodies, spheres) {
            (Ok(bodies), Ok(sphere)) => (bodies, [sphere]),
            (Err(error), _) | (_, Err(error)) => {
                eprintln!("ellipsoids with {n} vertices: {error}");
                return ExitCode::FAILURE;
            }
        };
        let sequences = if arguments.quick { 12 } else { 60 };
        print_header();
        for meeting in [Meeting::Colliding, Meeting::Separated] {
            for delta in DELTAS {
                let sequences: Vec<_> = (0..sequences)
                    .map(|k| {
                        sequence(&bodies, meeting, Motion::ALL[k % 3], delta, LENGTH, &mut rng)
                    })
                    .collect();
                let name = format!("{:.2} %, {}", 100.0 * delta, meeting.name());
                rows.push(measure(&name, n, &bodies, &sequences));
            }
            let unrelated: Vec<_> =
                (0..sequences).map(|_| unrelated(&bodies, meeting, &mut rng)).collect();
            rows.push(measure(&format!("random, {}", meeting.name()), n, &bodies, &unrelated));
        }
        for alpha in ALPHAS_DEG {
            let orbits: Vec<_> =
                (0..sequences).map(|_| orbit(alpha * PI / 180.0, LENGTH, &mut rng)).collect();
            rows.push(measure(&format!("orbit {alpha} deg"), n, &sphere, &orbits));
        }
    }
    report::write(arguments, &rows)
}

/// Settings of one pair of bodies that have nothing else in common.
fn unrelated(bodies: &[ConvexPolyhedron], meeting: Meeting, rng: &mut Rng) -> Vec<Setting> {
    let first = Setting::draw(bodies, meeting, rng);
    let pair = [bodies[first.moving].clone(), bodies[first.fixed].clone()];
    let draw = |rng: &mut Rng| loop {
        let setting = Setting::draw(&pair, meeting, rng);
        if (setting.moving, setting.fixed) == (0, 1) {
            return Setting { moving: first.moving, fixed: first.fixed, ..setting };
        }
    };
    (0..LENGTH).map(|_| draw(rng)).collect()
}

/// Measurements of one contestant in one row.
#[derive(Default)]
struct Measured {
    nanoseconds: Vec<f64>,
    steps: Steps,
    by_features: u32,
    failures: u32,
}

impl Measured {
    fn follow(
        &mut self,
        contestant: &Contestant,
        bodies: &[ConvexPolyhedron],
        sequence: &[Setting],
    ) -> Vec<Result<Outcome, QueryError>> {
        let Some(first) = sequence.first() else { return Vec::new() };
        let clock = clock_cost();
        let Contestant { solver, narrowing, .. } = *contestant;
        let options = Options { solver, narrowing, ..Options::default() };
        let (moving, fixed) = (&bodies[first.moving], &bodies[first.fixed]);
        let mut tracker =
            Tracker::new(moving, fixed).with_focus(contestant.focus).expect("a focus");
        let mut outcomes = Vec::with_capacity(sequence.len());
        for setting in sequence {
            let started = Instant::now();
            let Setting { moving_pose: p, fixed_pose: q, direction: d, .. } = black_box(setting);
            let outcome = black_box(if contestant.focus == Focus::NONE {
                cast_with(moving, p, fixed, q, *d, &options)
            } else {
                tracker.cast_with(p, q, *d, &options)
            });
            let spent = started.elapsed().as_nanos() as f64 - clock;
            self.note(spent.max(0.0), &outcome);
            outcomes.push(outcome);
        }
        outcomes
    }

    fn note(&mut self, spent: f64, outcome: &Result<Outcome, QueryError>) {
        self.nanoseconds.push(spent);
        let Ok(outcome) = outcome else {
            self.failures += 1;
            return;
        };
        let steps = outcome.steps();
        self.steps.planar_problems += steps.planar_problems;
        self.steps.supports += steps.supports;
        self.steps.pivots += steps.pivots;
        self.by_features += u32::from(steps.started_from == StartedFrom::Features);
    }

    fn average(&self, count: u32) -> f64 {
        f64::from(count) / self.nanoseconds.len().max(1) as f64
    }

    /// Mean of all but the slowest hundredth, which other programs on the machine cause.
    fn mean(&self) -> f64 {
        let kept = &self.nanoseconds[..self.nanoseconds.len() * 99 / 100];
        kept.iter().sum::<f64>() / kept.len().max(1) as f64
    }

    fn to_json(&self) -> Value {
        json!({
            "median_ns": quantile(&self.nanoseconds, 0.5),
            "p90_ns": quantile(&self.nanoseconds, 0.9),
            "mean_ns": self.mean(),
            "planar_problems": self.average(self.steps.planar_problems),
            "supports": self.average(self.steps.supports),
            "pivots": self.average(self.steps.pivots),
            "by_features": self.average(self.by_features),
            "failures": self.failures,
        })
    }
}

/// Lets every contestant follow every sequence, prints a row and returns it.
fn measure(name: &str, n: usize, bodies: &[ConvexPolyhedron], sequences: &[Vec<Setting>]) -> Value {
    let mut measured: [Measured; CONTESTANTS.len()] = Default::default();
    let mut differences = 0;
    for (turn, sequence) in sequences.iter().enumerate() {
        let mut answers: [Vec<_>; CONTESTANTS.len()] = Default::default();
        for k in 0..CONTESTANTS.len() {
            let who = (turn + k) % CONTESTANTS.len();
            answers[who] = measured[who].follow(&CONTESTANTS[who], bodies, sequence);
        }
        let [reference, others @ ..] = &answers;
        let differs =
            |answers: &Vec<_>| answers.iter().zip(reference).filter(|(a, b)| !agree(a, b)).count();
        differences += others.iter().map(differs).sum::<usize>();
    }
    for measured in &mut measured {
        measured.nanoseconds.sort_by(f64::total_cmp);
    }
    print_row(name, n, &measured, differences);
    let contestants: serde_json::Map<String, Value> = CONTESTANTS
        .iter()
        .zip(&measured)
        .map(|(contestant, measured)| (contestant.name.into(), measured.to_json()))
        .collect();
    json!({
        "sequences": name,
        "vertices": n,
        "queries": measured[0].nanoseconds.len(),
        "contestants": contestants,
        "differences": differences,
    })
}

/// Whether two answers are the same, within what their certificates leave open.
fn agree(a: &Result<Outcome, QueryError>, b: &Result<Outcome, QueryError>) -> bool {
    match (a, b) {
        (Ok(Outcome::Contact(a)), Ok(Outcome::Contact(b))) => {
            let tolerance = a.certificate.tolerance.max(b.certificate.tolerance);
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
         planar problems, supports and pivots on average"
    );
    print!("{:<18} {:>7}", "sequences", "n");
    for contestant in &CONTESTANTS {
        print!(
            " | {:>11} {:>6} {:>3} {:>6} {:>5} {:>5}",
            contestant.name, "mean", "%", "planar", "sup", "piv"
        );
    }
    println!(" | ratio ratio of means, diff");
}

fn print_row(name: &str, n: usize, measured: &[Measured], differences: usize) {
    print!("{name:<18} {n:>7}");
    for m in measured {
        print!(
            " | {:>11.0} {:>6.0} {:>3.0} {:>6.2} {:>5.2} {:>5.2}",
            quantile(&m.nanoseconds, 0.5),
            m.mean(),
            100.0 * m.average(m.by_features),
            m.average(m.steps.planar_problems),
            m.average(m.steps.supports),
            m.average(m.steps.pivots),
        );
    }
    let [scratch, tracker, ..] = measured else { return };
    let failures: u32 = measured.iter().map(|m| m.failures).sum();
    println!(
        " | {:.2} {:.2}, {differences} {failures}",
        quantile(&tracker.nanoseconds, 0.5) / quantile(&scratch.nanoseconds, 0.5),
        tracker.mean() / scratch.mean(),
    );
}
