//! `coherence`: compares trackers with casts from scratch, on the same sequences in one run. Parry's cast of
//! bodies with 8 vertices provides the scale.
//!
//! Every solver works through a whole sequence before the next solver. The order changes from sequence to
//! sequence. Each query is measured alone; the cost of the clock is subtracted.

use std::process::ExitCode;

use colltrans::{BuildError, Focus, Options, Outcome, QueryError, Solver, Tracker, cta};
use colltrans_bench::harness::{self, Run, with_name};
use colltrans_bench::parry::ReferenceCasts;
use colltrans_bench::shapes::{Shape, body_from_mesh};
use colltrans_bench::times::{Block, SolverFigures, blocks, measure_in_turns};
use colltrans_lab::settings::{Meeting, Setting};
use colltrans_lab::shapes::Bodies;
use colltrans_testkit::shapes::{even_rings, ring_sphere};
use colltrans_testkit::timing::Stopwatch;
use serde_json::{Map, json};

const SIZES: [usize; 4] = [200, 2_000, 20_000, 200_000];

/// Number of configurations in a sequence.
const LENGTH: usize = 100;

/// Change per step, in diameters.
const DELTAS: [f64; 4] = [0.01, 0.005, 0.0025, 0.0013];

/// Degrees per step of the orbit.
const ALPHAS_DEG: [f64; 10] = [0.1, 0.25, 0.5, 1.0, 2.5, 5.0, 10.0, 30.0, 90.0, 180.0];

/// A solver that answers the queries of a sequence.
#[derive(Debug, Clone, Copy)]
struct ComparedSolver {
    name: &'static str,
    solver: Solver,
    /// Memory of the tracker; `None` stands for the tracker's default.
    focus: Option<Focus>,
    narrowing: cta::Options,
}

const COMPARED: [ComparedSolver; 6] = [
    ComparedSolver {
        name: "scratch",
        solver: Solver::Auto,
        focus: Some(Focus::NONE),
        narrowing: PAPER,
    },
    ComparedSolver { name: "tracker", solver: Solver::Auto, focus: None, narrowing: PAPER },
    ComparedSolver { name: "cta", solver: Solver::Cta, focus: Some(Focus::NONE), narrowing: PAPER },
    ComparedSolver {
        name: "cta region",
        solver: Solver::Cta,
        focus: Some(REGION),
        narrowing: PAPER,
    },
    ComparedSolver {
        name: "rough",
        solver: Solver::Cta,
        focus: Some(Focus::NONE),
        narrowing: cta::Options::ROUGH,
    },
    ComparedSolver {
        name: "rough tracker",
        solver: Solver::Cta,
        focus: Some(BOTH),
        narrowing: cta::Options::ROUGH,
    },
];

const REGION: Focus = Focus::NONE.with_region(cta::Region::Automatic);
const BOTH: Focus = Focus::NONE.with_features(true).with_region(cta::Region::Automatic);

/// The paper's variant: from the centre of the levels until the exit test. It has no effect on other solvers.
const PAPER: cta::Options = cta::Options::new(cta::Start::Center, cta::Until::Exit);

fn main() -> ExitCode {
    let about = "Compares trackers with casts from scratch on the same sequences; prints tables";
    harness::run("coherence", about, |run, (): &()| {
        for n in run.sizes(&SIZES) {
            measure_size(n, run).map_err(with_name(format!("ellipsoids with {n} vertices")))?;
        }
        Ok(())
    })
}

/// Begins the table.
fn begin_table(run: &mut Run) {
    let solver = |compared: &ComparedSolver| {
        let name = compared.name;
        format!(
            "|{name}:>11.0=solvers/{name}/median_ns; mean:>6.0=solvers/{name}/mean_ns; \
             %:>3.0=solvers/{name}/by_features × 100; planar:>6.2=solvers/{name}/planar_problems; \
             sup:>5.2=solvers/{name}/supports; piv:>5.2=solvers/{name}/pivots; "
        )
    };
    let failures =
        COMPARED.map(|compared| format!("solvers/{}/failures", compared.name)).join(" + ");
    let columns = format!(
        "sequences:<18; n:>7=vertices; {}
        |ratio:>5.2=solvers/tracker/median_ns ÷ solvers/scratch/median_ns;
        means:>5.2=solvers/tracker/mean_ns ÷ solvers/scratch/mean_ns;
        parry:>5.2=solvers/tracker/mean_ns ÷ parry_8/mean_ns; diff:>4=differences; fail:>4.0={failures}",
        COMPARED.iter().map(solver).collect::<String>(),
    );
    let legend = "\nmedian ns, and mean without the slowest hundredth; % = answered by feature focus; \
         planar problems, supports and pivots on average; tracker over scratch by medians and by \
         means; mean of the tracker over parry's mean at 8 vertices";
    run.table(legend, &columns);
}

/// Adds all rows of a size.
fn measure_size(n: usize, run: &mut Run) -> Result<(), BuildError> {
    let mut random = run.random(&[n as u64]);
    let mut pair = |n| Shape::Ellipsoid.pair(n, &mut random).map(Bodies::new);
    let bodies = [pair(n)?, pair(n)?];
    let [around, rings] = even_rings(n);
    let sphere = body_from_mesh(&ring_sphere(around, rings))?;
    let spheres = [Bodies::new([sphere.clone(), sphere])];
    let small = pair(8)?;
    let count = run.choose(12, 60);
    let scale = ReferenceCasts::new(&small, LENGTH, &mut random);
    begin_table(run);
    let mut add = |name: &str, sequences: &[Block]| follow_all(n, name, sequences, &scale, run);
    for (name, meeting) in
        [("colliding", Meeting::Colliding), ("separated", Meeting::PassingWithin(0.2))]
    {
        for delta in DELTAS {
            let sequences = blocks(&bodies, count, |bodies| {
                Setting::sequence(bodies, meeting, delta, LENGTH, &mut random)
            });
            add(&format!("{:.2} %, {name}", 100.0 * delta), &sequences);
        }
        let mut draw = |bodies: &Bodies| Setting::draw(bodies, meeting, &mut random);
        let sequences =
            blocks(&bodies, count, |bodies| (0..LENGTH).map(|_| draw(bodies)).collect());
        add(&format!("random, {name}"), &sequences);
    }
    for alpha in ALPHAS_DEG {
        let draw = |bodies: &Bodies| Setting::orbit(bodies, alpha, LENGTH, &mut random);
        add(&format!("orbit {alpha} deg"), &blocks(&spheres, count, draw));
    }
    Ok(())
}

/// Measures every solver on every sequence, and adds the row.
fn follow_all(n: usize, name: &str, sequences: &[Block], scale: &ReferenceCasts, run: &mut Run) {
    let mut differences = 0;
    let (measured, parry) = measure_in_turns::<Vec<_>, { COMPARED.len() }>(
        sequences,
        scale,
        |who, (bodies, sequence), measured| {
            follow_sequence(measured, &COMPARED[who], bodies, sequence)
        },
        |[reference, others @ ..]| {
            let differs = |answers: &Vec<_>| {
                answers.iter().zip(reference).filter(|(a, b)| !answers_agree(a, b)).count()
            };
            differences += others.iter().map(differs).sum::<usize>();
        },
    );
    let solvers = COMPARED.iter().zip(&measured).map(|(who, m)| (who.name.into(), json!(m)));
    run.add(json!({
        "sequences": name, "vertices": n, "queries": measured[0].times.count(),
        "solvers": solvers.collect::<Map<_, _>>(), "parry_8": parry, "differences": differences,
    }));
}

/// Measures a solver on a sequence.
fn follow_sequence(
    measured: &mut SolverFigures,
    compared: &ComparedSolver,
    bodies: &Bodies,
    sequence: &[Setting],
) -> Vec<Result<Outcome, QueryError>> {
    let stopwatch = Stopwatch::new();
    let ComparedSolver { solver, narrowing, focus, .. } = *compared;
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
        measured.add_outcome(spent, &outcome);
        outcomes.push(outcome);
    }
    outcomes
}

/// Whether two answers agree within their certificates.
fn answers_agree(a: &Result<Outcome, QueryError>, b: &Result<Outcome, QueryError>) -> bool {
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
