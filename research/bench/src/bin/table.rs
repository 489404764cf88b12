//! `table`: compares all solvers and `parry3d-f64` in one run on the same settings.
//!
//! Each query is measured alone; the cost of the clock is subtracted. The solvers take turns on blocks of
//! settings that no other solver has just visited. The bodies are thus as cold as in a program with many
//! different queries, and a disturbance of the machine affects all solvers. In *cold* rows, a pass over 4 MiB
//! of other data precedes each query.

use std::cell::RefCell;
use std::hint::black_box;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use clap::{Args, ValueEnum};
use colltrans::{BuildError, ConvexPolyhedron, Options, Outcome, QueryError, Solver};
use colltrans_bench::harness::{self, Run, with_name};
use colltrans_bench::parry::{self, ParryPolyhedron, ParrySetting};
use colltrans_bench::shapes::Shape;
use colltrans_bench::ties::{Placement, Tie};
use colltrans_bench::times::SolverFigures;
use colltrans_lab::settings::{Meeting, Setting};
use colltrans_lab::shapes::Bodies;
use colltrans_testkit::timing::Stopwatch;
use serde_json::{Value, json};

#[derive(Debug, Args)]
struct OwnArguments {
    /// Measure only these rows
    #[arg(long, value_enum)]
    group: Option<Group>,
    /// Of random positions, measure only shapes whose names contain this text
    #[arg(long)]
    shape: Option<String>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Group {
    /// Random positions and orientations
    General,
    /// Aligned, resting, edge over edge
    Ties,
    /// Ties after other work
    Cold,
}

const SOLVERS: [(&str, Solver); 3] =
    [("cta", Solver::Cta), ("portal", Solver::Portal), ("auto", Solver::Auto)];

const SIZES: [usize; 8] = [8, 32, 128, 512, 2_000, 10_000, 50_000, 200_000];

/// Number of settings that one solver answers before the next.
const BLOCK: usize = 25;

/// Number of contestants: our solvers and parry.
const COMPARED: usize = SOLVERS.len() + 1;

/// Two answers agree if they differ by less than this share of the bodies' length. Parry stops at about this
/// accuracy.
const AGREEMENT: f64 = 1e-4;

fn main() -> ExitCode {
    let about = "Compares all solvers and parry3d-f64 on the same settings; prints a table";
    harness::run("table", about, |run, own: &OwnArguments| {
        let legend = "ns: median and 99th percentile; x: parry's median over ours, mx: parry's mean over ours \
             (means without the slowest hundredth); planar problems and supports on average";
        run.table(legend, COLUMNS);
        let wants = |group| own.group.is_none_or(|only| only == group);
        if wants(Group::General) {
            for (shape, n) in measured_sizes(&run.sizes(&SIZES)) {
                if own.shape.as_ref().is_none_or(|part| shape.name().contains(part)) {
                    let failed = with_name(format!("{} with {n} vertices", shape.name()));
                    measure_general(shape, n, run).map_err(failed)?;
                }
            }
        }
        if wants(Group::Ties) {
            for (tie, placement) in
                Tie::ALL.into_iter().flat_map(|tie| Placement::ALL.map(|placed| (tie, placed)))
            {
                run.add(measure_tied(tie, placement, placement.name(), None, run));
            }
        }
        if wants(Group::Cold) {
            for tie in Tie::ALL {
                let other = Some(RefCell::new(vec![0; OTHER / size_of::<u64>()]));
                run.add(measure_tied(tie, Placement::Rotated, "rotated, cold", other, run));
            }
        }
        Ok(())
    })
}

const COLUMNS: &str = "shape:<18; n:>6=vertices; :<16=meeting; build ms:>8.2=build_ms; B/n:>4.0=bytes_per_vertex;
    cta:>7.0=cta/median_ns; p99:>7.0=cta/p99_ns; portal:>7.0=portal/median_ns; p99:>7.0=portal/p99_ns;
    auto:>7.0=auto/median_ns; p99:>7.0=auto/p99_ns; parry:>8.0=parry/median_ns; p99:>8.0=parry/p99_ns;
    x cta:>7.2=parry_over/cta/median; x port:>7.2=parry_over/portal/median; x auto:>7.2=parry_over/auto/median;
    mx auto:>7.2=parry_over/auto/mean; planar:>6.1=cta/planar_problems; s cta:>6.1=cta/supports;
    s port:>6.1=portal/supports; fail:>4.0=cta/failures + portal/failures + auto/failures;
    diff:>4.0=parry_disagreements + parry/failures";

/// Returns the shapes and sizes: all sizes of ellipsoids, and some sizes of the others.
fn measured_sizes(sizes: &[usize]) -> Vec<(Shape, usize)> {
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

/// Bytes of other data read before each query for cold caches.
const OTHER: usize = 4 << 20;

/// Pairs of bodies and their settings.
struct Cases {
    pairs: Vec<Bodies>,
    /// Each setting with the number of its pair.
    settings: Vec<(usize, Setting)>,
    build: Duration,
    /// Data read before each query, for cold caches.
    other: Option<RefCell<Vec<u64>>>,
}

impl Cases {
    /// Goes through the other data, if there is any.
    fn other_work(&self) {
        if let Some(other) = &self.other {
            other.borrow_mut().iter_mut().for_each(|x| *x = x.wrapping_add(1));
            black_box(other);
        }
    }
}

/// Adds both rows of a shape and a size.
fn measure_general(shape: Shape, n: usize, run: &mut Run) -> Result<(), BuildError> {
    let mut random = run.random(&[n as u64]);
    let count = if n >= 50_000 { 2 } else { 4 };
    let started = Instant::now();
    let pairs = (0..count).map(|_| shape.pair(n, &mut random).map(Bodies::new));
    let pairs = pairs.collect::<Result<Vec<_>, _>>()?;
    let build = started.elapsed() / (2 * count);
    let mut cases = Cases { pairs, settings: Vec::new(), build, other: None };
    let settings = if n >= 100_000 { run.choose(100, 200) } else { run.choose(200, 1000) };
    for meeting in ["colliding", "separated"] {
        let mut random = run.random(&[n as u64, meeting.len() as u64, 1]);
        let draw = |k: usize| {
            let bodies = &cases.pairs[k % cases.pairs.len()];
            let meeting = match meeting {
                "colliding" => Meeting::Colliding,
                _ => Meeting::Passing(10.0_f64.powf(random.range(-3.0, -0.3)) / bodies.diameter),
            };
            (k % cases.pairs.len(), Setting::draw(bodies, meeting, &mut random))
        };
        cases.settings = (0..settings).map(draw).collect();
        run.add(measure_row((shape.name(), n), meeting, &cases, run));
    }
    Ok(())
}

/// Returns a row of tied settings.
fn measure_tied(
    tie: Tie,
    placement: Placement,
    name: &str,
    other: Option<RefCell<Vec<u64>>>,
    run: &Run,
) -> Value {
    let mut random = run.random(&[tie as u64, placement as u64, 2]);
    let started = Instant::now();
    let pairs: Vec<_> = (0..8).map(|_| tie.bodies(&mut random)).collect();
    let build = started.elapsed() / 16;
    let settings = (0..run.choose(200, 1000))
        .map(|k| (k % pairs.len(), tie.draw(&pairs[k % pairs.len()], placement, &mut random)))
        .collect();
    let cases = Cases { pairs, settings, build, other };
    measure_row((tie.name().into(), 0), name, &cases, run)
}

/// Answers a setting with `colltrans`.
fn cast_with(bodies: &Bodies, setting: &Setting, solver: Solver) -> Result<Outcome, QueryError> {
    setting.cast(bodies, &Options::default().with_solver(solver))?.first_contact()
}

/// Measures a solver on all settings of a block.
fn measure_block(
    measured: &mut SolverFigures,
    cases: &Cases,
    solver: Solver,
    block: &[(usize, Setting)],
) {
    let stopwatch = Stopwatch::new();
    for (pair, setting) in block {
        cases.other_work();
        let (outcome, spent) = stopwatch.time(|| cast_with(&cases.pairs[*pair], setting, solver));
        if measured.count(&outcome) {
            measured.times.add(spent);
        }
    }
}

/// Measures all solvers and parry on cases.
fn measure_row((shape, asked): (String, usize), meeting: &str, cases: &Cases, run: &Run) -> Value {
    let all = || cases.pairs.iter().flat_map(|bodies| &bodies.pair);
    let vertices = all().map(|b| b.vertices().len()).sum::<usize>();
    let bytes = all().map(ConvexPolyhedron::memory_bytes).sum::<usize>();
    let mean_vertices = vertices / all().count();
    let ([ours @ .., theirs], disagreements) = take_turns(cases, mean_vertices, run.choose(2, 5));
    let over = |of: &SolverFigures| {
        let (theirs, ours) = (&theirs.times, &of.times);
        json!({ "median": theirs.median() / ours.median(), "mean": theirs.mean() / ours.mean() })
    };
    let [cta, portal, auto] = &ours;
    json!({
        "shape": shape, "vertices_asked": asked, "vertices": mean_vertices, "meeting": meeting,
        "settings": cases.settings.len(), "build_ms": cases.build.as_secs_f64() * 1e3,
        "bytes_per_vertex": bytes as f64 / vertices as f64,
        "cta": cta, "portal": portal, "auto": auto, "parry": theirs,
        "parry_disagreements": disagreements,
        "parry_over": { "cta": over(cta), "portal": over(portal), "auto": over(auto) },
    })
}

/// Measures all solvers and parry, and counts the settings with a different answer of parry.
fn take_turns(cases: &Cases, vertices: usize, passes: usize) -> ([SolverFigures; COMPARED], u32) {
    let (mut measured, mut disagreements) = (<[SolverFigures; COMPARED]>::default(), 0);
    let theirs: Vec<_> =
        cases.pairs.iter().map(|bodies| bodies.pair.each_ref().map(parry::convert_body)).collect();
    let blocks: Vec<_> = cases.settings.chunks(BLOCK).collect();
    for pass in 0..passes {
        for turn in 0..blocks.len() {
            let block = |compared: usize| {
                blocks[(turn + compared * blocks.len() / COMPARED) % blocks.len()]
            };
            let [ours @ .., parry] = &mut measured;
            for (index, (_, solver)) in SOLVERS.into_iter().enumerate() {
                measure_block(&mut ours[index], cases, solver, block(index));
            }
            // Parry's linear support search at these sizes needs no second measurement.
            if pass == 0 || vertices < 9_000 {
                let differ = measure_parry(parry, cases, &theirs, block(SOLVERS.len()), pass == 0);
                disagreements += differ;
            }
        }
    }
    (measured, disagreements)
}

/// Measures parry on all settings of a block. If `compare`, counts those with a different answer.
fn measure_parry(
    measured: &mut SolverFigures,
    cases: &Cases,
    theirs: &[[Option<ParryPolyhedron>; 2]],
    block: &[(usize, Setting)],
    compare: bool,
) -> u32 {
    let stopwatch = Stopwatch::new();
    let mut disagreements = 0;
    for (pair, setting) in block {
        let [Some(moving), Some(fixed)] = &theirs[*pair] else {
            measured.failures += 1;
            continue;
        };
        let converted = ParrySetting::new(setting);
        cases.other_work();
        let (answer, spent) = stopwatch.time(|| converted.cast(moving, fixed));
        measured.times.add(spent);
        disagreements += u32::from(compare && !parry_agrees(setting, &cases.pairs[*pair], answer));
    }
    disagreements
}

/// Whether parry's answer agrees with ours within parry's accuracy.
fn parry_agrees(setting: &Setting, bodies: &Bodies, theirs: Option<f64>) -> bool {
    match (cast_with(bodies, setting, Solver::Portal), theirs) {
        (Ok(Outcome::Contact(contact)), Some(time)) => {
            // Parry does not report contacts behind the start.
            (contact.translation - time).abs() <= AGREEMENT || contact.translation < AGREEMENT
        }
        (Ok(Outcome::Separated(_)), None) | (Ok(Outcome::Grazing(_)), _) => true,
        _ => false,
    }
}
