//! `paper`: compares the collision translation algorithm with portal refinement, on the paper's bodies in one
//! run.
//!
//! Every solver answers a block of settings twice; the second pass is measured. All solvers thus find the
//! block's data in the caches. The order changes from block to block. Each query is measured alone; the cost of
//! the clock is subtracted. Every row contains parry's cast of bodies with 8 vertices, so that rows of
//! different runs can be compared. A further pass, of the search from the centre to the end, measures the
//! phases.

use std::process::ExitCode;

use clap::Args;
use colltrans::{BuildError, Focus, Options, Solver, Tracker, cta, observe};
use colltrans_bench::harness::{self, Run, merge_objects, with_name};
use colltrans_bench::parry::ReferenceCasts;
use colltrans_bench::shapes::{Shape, body_from_mesh};
use colltrans_bench::times::{Block, SolverFigures, Times, blocks, measure_in_turns};
use colltrans_lab::settings::{Meeting, Setting};
use colltrans_lab::shapes::Bodies;
use colltrans_testkit::random::Random;
use colltrans_testkit::shapes::ring_sphere;
use colltrans_testkit::timing::Stopwatch;
use glam::DVec3;
use serde_json::{Map, Value, json};

#[derive(Debug, Args)]
struct OwnArguments {
    /// Leave out the sequences for region focus
    #[arg(long)]
    no_focus: bool,
}

const SIZES: [usize; 4] = [200, 2_000, 20_000, 200_000];

/// Number of settings of a block.
const BLOCK: usize = 20;

/// Number of configurations in a sequence, and its change per step in diameters.
const LENGTH: usize = 50;
const CHANGES: [f64; 3] = [0.01, 0.0025, 0.000_625];

/// The options of a solver's search; `None` is portal refinement alone.
const COMPARED: [(&str, Option<cta::Options>); 4] = [
    ("portal", None),
    ("rough", Some(cta::Options::ROUGH)),
    ("centre 1%", Some(search_until(cta::Until::Gap(0.01)))),
    ("centre end", Some(search_until(cta::Until::Exit))),
];

/// The solvers for sequences: the end of the search, and the memory of the tracker.
const FOLLOWED: [(&str, cta::Until, Focus); 3] = [
    ("focus 1%", cta::Until::Gap(0.01), REGION),
    ("focus end", cta::Until::Exit, REGION),
    ("centre end", cta::Until::Exit, Focus::NONE),
];

/// Returns the options of a search from the centre to `until`, across cells that contain little of the region.
const fn search_until(until: cta::Until) -> cta::Options {
    cta::Options::new(cta::Start::Center, until).with_keeps_to_cell(false)
}

/// A kind of bodies.
#[derive(Debug, Clone, Copy, PartialEq)]
enum BodyKind {
    /// Ellipsoids with faces as long as wide.
    Balanced,
    /// Ellipsoids with faces whose length is [`STRETCH`] times their width.
    Thin,
    Other(Shape),
}

const KINDS: [BodyKind; 5] = [
    BodyKind::Balanced,
    BodyKind::Thin,
    BodyKind::Other(Shape::Superellipsoid),
    BodyKind::Other(Shape::HalfEllipsoid),
    BodyKind::Other(Shape::RandomHull),
];

const STRETCH: f64 = 100.0;

/// A memory of only the region of the last solution.
const REGION: Focus = Focus::NONE.with_region(cta::Region::Automatic);

impl BodyKind {
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
                // The edges along parallels are `STRETCH` times as long as those along meridians.
                let around = (n as f64 * 4.0 / (std::f64::consts::PI * STRETCH)).sqrt().max(8.0);
                let around = around.round();
                let rings = (n as f64 / around).round();
                let axes = DVec3::from_array([0; 3].map(|_| random.range(0.6, 1.4)));
                body_from_mesh(&ring_sphere(around as u32, rings as u32).mapped(|v| v * axes))
            }
            Self::Other(shape) => shape.draw(n, random),
        };
        Ok(Bodies::new([one()?, one()?]))
    }
}

fn main() -> ExitCode {
    let about =
        "Compares the collision translation algorithm with portal refinement; prints tables";
    harness::run("paper", about, |run, own: &OwnArguments| {
        for n in run.sizes(&SIZES) {
            measure_size(n, !own.no_focus, run)
                .map_err(with_name(format!("bodies with {n} vertices")))?;
        }
        Ok(())
    })
}

/// Declares the columns for these solvers.
fn declare_columns(names: &[&str]) -> String {
    let solver = |who: &&str| {
        format!(
            "|:>10=\"{who}\"; :>6.2=solvers/{who}/ratio; :>5.2=solvers/{who}/planar_problems; \
             :>5.2=solvers/{who}/pivots; "
        )
    };
    let failures = names.iter().map(|who| format!("solvers/{who}/failures")).collect::<Vec<_>>();
    format!(
        ":<28=settings; :>7=vertices; {}
        |:>5.0=solvers/{first}/median_ns ÷ solvers/{first}/ratio; :>5.0=parry_8/median_ns; :>1.0={}",
        names.iter().map(solver).collect::<String>(),
        failures.join(" + "),
        first = names[0],
    )
}

/// Measures all rows of a size.
fn measure_size(n: usize, focus: bool, run: &mut Run) -> Result<(), BuildError> {
    let mut random = run.random(&[n as u64]);
    let small = Bodies::new(Shape::Ellipsoid.pair(8, &mut random)?);
    let scale = ReferenceCasts::new(&small, BLOCK, &mut random);
    let count = run.choose(200, 1000);
    let legend = "\nmedian ns over portal's on the colliding settings; planar problems and exchanges on \
         average; parry's median ns at 8 vertices";
    let (names, followed) = (COMPARED.map(|c| c.0), FOLLOWED.map(|c| c.0));
    run.table(legend, &declare_columns(&names));
    for kind in KINDS {
        let bodies = [kind.bodies(n, &mut random)?, kind.bodies(n, &mut random)?];
        let mut unit = None;
        run.table("", &declare_columns(&names));
        for (name, meeting) in
            [("colliding", Meeting::Colliding), ("near miss", Meeting::PassingWithin(0.05))]
        {
            let mut draw = |bodies: &Bodies| Setting::draw(bodies, meeting, &mut random);
            let blocks =
                blocks(&bodies, count / BLOCK, |bodies| (0..BLOCK).map(|_| draw(bodies)).collect());
            let (measured, parry) =
                measure_in_turns(&blocks, &scale, answer_twice, |_: &[(); 4]| ());
            let unit = *unit.get_or_insert(measured[0].times.median());
            let name = format!("{}, {name}", kind.name());
            run.add(solver_row(
                &name,
                n,
                (&names, &measured),
                unit,
                &parry,
                &measure_phases(&blocks, false),
            ));
        }
        if !focus || !matches!(kind, BodyKind::Balanced | BodyKind::Thin) {
            continue;
        }
        run.table("", &declare_columns(&followed));
        for change in CHANGES {
            let sequences = blocks(&bodies, (count / LENGTH).max(2), |bodies| {
                Setting::sequence(bodies, Meeting::Colliding, change, LENGTH, &mut random)
            });
            let (measured, parry) =
                measure_in_turns(&sequences, &scale, follow_sequence, |_: &[(); 3]| ());
            let name = format!("{}, change {:.4} %", kind.name(), 100.0 * change);
            let (unit, phases) = (unit.unwrap_or(f64::NAN), measure_phases(&sequences, true));
            run.add(solver_row(&name, n, (&followed, &measured), unit, &parry, &phases));
        }
    }
    Ok(())
}

/// Returns the row of the solvers, with their medians over a unit.
fn solver_row(
    name: &str,
    n: usize,
    (names, measured): (&[&str], &[SolverFigures]),
    unit: f64,
    parry: &Times,
    phases: &Value,
) -> Value {
    let solvers = names.iter().zip(measured).map(|(who, m)| {
        ((*who).into(), merge_objects(m, json!({ "ratio": m.times.median() / unit })))
    });
    json!({
        "settings": name, "vertices": n, "queries": measured[0].times.count(),
        "solvers": solvers.collect::<Map<_, _>>(), "parry_8": parry, "phases": phases,
    })
}

/// Returns the options of a query.
fn query_options(narrowing: Option<cta::Options>) -> Options {
    match narrowing {
        None => Options::default().with_solver(Solver::Portal),
        Some(narrowing) => Options::default().with_solver(Solver::Cta).with_narrowing(narrowing),
    }
}

/// Answers a block twice without a memory, and measures the second pass.
fn answer_twice(who: usize, (bodies, settings): &Block, measured: &mut SolverFigures) {
    let stopwatch = Stopwatch::new();
    let options = query_options(COMPARED[who].1);
    let cast = |s: &Setting| s.cast(bodies, &options)?.first_contact();
    for setting in settings {
        std::hint::black_box(cast(setting).is_ok());
    }
    for setting in settings {
        let (outcome, spent) = stopwatch.time(|| cast(setting));
        measured.add_outcome(spent, &outcome);
    }
}

/// Follows a sequence with a tracker.
fn follow_sequence(who: usize, (bodies, sequence): &Block, measured: &mut SolverFigures) {
    let stopwatch = Stopwatch::new();
    let (_, until, focus) = FOLLOWED[who];
    let options = query_options(Some(search_until(until)));
    let mut tracker = Tracker::new().with_focus(focus).expect("a focus");
    for setting in sequence {
        let (outcome, spent) =
            stopwatch.time(|| tracker.first_contact(&setting.cast(bodies, &options)?));
        measured.add_outcome(spent, &outcome);
    }
}

/// Returns the median nanoseconds of each phase of a search from the centre to the end. The searches are second
/// passes over blocks, or, with region focus, sequences.
fn measure_phases(blocks: &[Block], is_focused: bool) -> Value {
    let options = query_options(Some(search_until(cta::Until::Exit)));
    let mut spent: Vec<(&str, Times)> = Vec::new();
    for (bodies, settings) in blocks {
        let mut tracker = Tracker::new().with_focus(REGION).expect("a focus");
        for pass in usize::from(is_focused)..2 {
            for setting in settings {
                let mut clock = observe::Clock::new();
                let cast = setting.cast(bodies, &options);
                let found = cast.and_then(|cast| {
                    if is_focused {
                        tracker.first_contact_observed(&cast, &mut clock)
                    } else {
                        cast.first_contact_observed(&mut clock)
                    }
                });
                if pass == 1 && found.is_ok() {
                    let phases = clock.profile().phase_times();
                    spent.resize_with(phases.len(), Default::default);
                    for ((name, times), (phase, nanoseconds)) in spent.iter_mut().zip(phases) {
                        *name = phase;
                        times.add(nanoseconds);
                    }
                }
            }
        }
    }
    let medians = spent.iter().map(|(name, times)| ((*name).into(), json!(times.median())));
    medians.collect::<Map<_, _>>().into()
}
