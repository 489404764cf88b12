//! `instructions`: answers the same casts with several solvers, in a run under callgrind.
//!
//! `research/bench/instructions.py` runs it and writes a table. Callgrind counts in [`counted_casts`], whose calls are
//! in the order of the pairs of bodies, and for each pair in that of the solvers. The bodies, their sections and the
//! settings are made before. The counts of planar problems, supports and pivots do not need callgrind.

use std::process::ExitCode;

use clap::{Parser, ValueEnum};
use colltrans::{Cast, Options, Outcome, Solver, Steps, Tracker, cta};
use colltrans_bench::shapes::{Shape, body_from_mesh};
use colltrans_lab::settings::{Meeting, Setting};
use colltrans_lab::shapes::Bodies;
use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::ring_sphere;
use glam::DVec3;

/// Counts the work of casts with each solver; run it under callgrind for instructions
#[derive(Debug, Parser)]
struct Arguments {
    /// Kind of bodies: ellipsoid, thin, hull, superellipsoid, half, box, prism, bicone
    #[arg(long, default_value = "ellipsoid")]
    shape: String,
    /// Vertices of a body, approximately
    #[arg(long, default_value_t = 3200)]
    vertices: usize,
    /// Solvers, or starts of the paper's algorithm
    #[arg(long, value_delimiter = ',', required = true)]
    solvers: Vec<Contestant>,
    /// Pairs of bodies
    #[arg(long, default_value_t = 4)]
    pairs: usize,
    /// Casts of each pair that meet
    #[arg(long, default_value_t = 50)]
    casts: usize,
    /// Follows each cast by this many more with a tracker, each changed by 1/1000 of a diameter; these are counted
    #[arg(long, default_value_t = 0)]
    tracked: usize,
}

#[derive(Debug, Clone, Copy, PartialEq, ValueEnum)]
enum Contestant {
    /// Portal refinement
    Portal,
    /// The paper's algorithm from the centre of the levels
    Center,
    /// The paper's algorithm in `N(p)` of a guessed solution
    Guess,
    /// As `guess`, with shifts across cells
    GuessAcross,
    /// Portal refinement from the contact of ellipsoids, which are a start of the paper's algorithm
    Ellipsoids,
}

impl Contestant {
    fn options(self) -> Options {
        let cta = |start, across: bool| {
            let narrowing = cta::Options::new(start, cta::Until::Exit).with_keeps_to_cell(!across);
            Options::default().with_solver(Solver::Cta).with_narrowing(narrowing)
        };
        match self {
            Self::Portal => Options::default().with_solver(Solver::Portal),
            Self::Center => cta(cta::Start::Center, false),
            Self::Guess => cta(cta::Start::Guess, false),
            Self::GuessAcross => cta(cta::Start::Guess, true),
            Self::Ellipsoids => cta(cta::Start::Ellipsoids, false),
        }
    }

    fn name(self) -> String {
        self.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
    }
}

/// Stretch of thin faces.
const STRETCH: f64 = 100.0;

fn bodies(kind: &str, n: usize, random: &mut Random) -> Result<Bodies, String> {
    let shape = match kind {
        "ellipsoid" => Some(Shape::Ellipsoid),
        "hull" => Some(Shape::RandomHull),
        "superellipsoid" => Some(Shape::Superellipsoid),
        "half" => Some(Shape::HalfEllipsoid),
        "box" => Some(Shape::Box),
        "prism" => Some(Shape::Prism),
        "bicone" => Some(Shape::Bicone),
        "thin" => None,
        other => return Err(format!("unknown shape {other:?}")),
    };
    let mut one = || {
        if let Some(shape) = shape {
            shape.draw(n, random)
        } else {
            let around =
                (n as f64 * 4.0 / (std::f64::consts::PI * STRETCH)).sqrt().max(8.0).round();
            let axes = DVec3::from_array([0; 3].map(|_| random.range(0.6, 1.4)));
            let rings = (n as f64 / around).round();
            body_from_mesh(&ring_sphere(around as u32, rings as u32).mapped(|v| v * axes))
        }
    };
    let mut body = || one().map_err(|error| error.to_string());
    Ok(Bodies::new([body()?, body()?]))
}

/// Work of several casts.
#[derive(Debug, Default)]
struct Counts {
    casts: u32,
    steps: Steps,
    most_problems: u32,
    most_iterations: u32,
    contacts: u32,
    sum: f64,
}

impl Counts {
    fn add(&mut self, outcome: &Outcome) {
        let steps = outcome.steps();
        self.casts += 1;
        self.steps += steps;
        self.most_problems = self.most_problems.max(steps.planar_problems);
        self.most_iterations = self.most_iterations.max(steps.iterations);
        if let Outcome::Contact(contact) = outcome {
            self.contacts += 1;
            self.sum += contact.translation;
        }
    }
}

/// Answers casts. Callgrind collects inside this function.
#[inline(never)]
fn counted_casts<'a>(
    casts: &[Cast<'a>],
    mut tracker: Option<&mut Tracker<'a>>,
    outcomes: &mut Vec<Outcome>,
) {
    for cast in casts {
        let outcome = match &mut tracker {
            Some(tracker) => tracker.first_contact(cast),
            None => cast.first_contact(),
        };
        outcomes.push(outcome.expect("an answer"));
    }
}

fn run(arguments: &Arguments) -> Result<Vec<Counts>, String> {
    let mut counts: Vec<Counts> = arguments.solvers.iter().map(|_| Counts::default()).collect();
    let mut random = Random::new(20);
    for _ in 0..arguments.pairs {
        let bodies = bodies(&arguments.shape, arguments.vertices, &mut random)?;
        if arguments.tracked == 0 {
            let settings: Vec<Setting> = (0..=arguments.casts)
                .map(|_| Setting::draw(&bodies, Meeting::Colliding, &mut random))
                .collect();
            for (solver, counts) in arguments.solvers.iter().zip(&mut counts) {
                solver.answer(&bodies, &settings, None, counts)?;
            }
            continue;
        }
        for _ in 0..arguments.casts {
            let count = arguments.tracked + 1;
            let settings = Setting::sequence(&bodies, Meeting::Colliding, 1e-3, count, &mut random);
            for (solver, counts) in arguments.solvers.iter().zip(&mut counts) {
                solver.answer(&bodies, &settings, Some(Tracker::new()), counts)?;
            }
        }
    }
    Ok(counts)
}

impl Contestant {
    /// Answers all settings but the first one, which a tracker starts from.
    fn answer<'a>(
        self,
        bodies: &'a Bodies,
        settings: &[Setting],
        mut tracker: Option<Tracker<'a>>,
        counts: &mut Counts,
    ) -> Result<(), String> {
        let options = self.options();
        let cast =
            |setting: &Setting| setting.cast(bodies, &options).map_err(|error| error.to_string());
        let casts = settings.iter().map(cast).collect::<Result<Vec<_>, _>>()?;
        let mut outcomes = Vec::with_capacity(casts.len());
        if let Some(tracker) = &mut tracker {
            tracker.first_contact(&casts[0]).map_err(|error| error.to_string())?;
        }
        counted_casts(&casts[1..], tracker.as_mut(), &mut outcomes);
        for outcome in &outcomes {
            counts.add(outcome);
        }
        Ok(())
    }
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    match run(&arguments) {
        Ok(all) => {
            println!(
                "solver,casts,contacts,problems,most problems,iterations,most iterations,supports,pivots,sum"
            );
            for (solver, counts) in arguments.solvers.iter().zip(all) {
                let each = |sum: u32| f64::from(sum) / f64::from(counts.casts);
                println!(
                    "{},{},{},{:.2},{},{:.1},{},{:.2},{:.2},{:?}",
                    solver.name(),
                    counts.casts,
                    counts.contacts,
                    each(counts.steps.planar_problems),
                    counts.most_problems,
                    each(counts.steps.iterations),
                    counts.most_iterations,
                    each(counts.steps.supports),
                    each(counts.steps.pivots),
                    counts.sum
                );
            }
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}
