//! Assemblies: which parts can be removed. The results are plain numbers and part indices, from which
//! `colltrans.assembly` builds its classes.
//!
//! Computations run on a thread of their own. The calling thread waits, polls for signals, and cancels the
//! computation if a signal handler raises. Files are read without such polls.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

use colltrans::glam::{DAffine3, DVec3};
use colltrans::solid::StartOverlap;
use colltrans_assembly::audit::{
    AuditOptions, AuditedPair, PairProof, QUANTITIES, Quantity, audit, prove_pairs,
};
use colltrans_assembly::blocking::BlockingGraph;
use colltrans_assembly::candidates::{CandidateOptions, find_candidates};
use colltrans_assembly::fasteners::{Fastener, Fasteners};
use colltrans_assembly::liaisons::find_liaisons;
use colltrans_assembly::map::{MapOptions, RemovalMap};
use colltrans_assembly::matrix::ContactMatrix;
use colltrans_assembly::plan::{
    HandlingTimes, Leg, Plan, PlanOptions, SelectedRemoval, Step, ToleratedContact, Turn,
};
use colltrans_assembly::report::html;
use colltrans_assembly::roles::{PairFit, PairTolerance, Role};
use colltrans_assembly::sphere::normalized_direction;
use colltrans_assembly::start::Start;
use colltrans_assembly::suggest::{Suggestion, suggest_fits, suggest_loose_threads};
use colltrans_assembly::tools::ToolReach;
use colltrans_assembly::travel::{PartTravel, travels_of_parts};
use colltrans_assembly::{
    Analysis, AnalysisRequest, AssemblyError, Bodies, Fit, Ignored, Part, Piece, Watch,
};
use colltrans_assembly_io::read::{self, Geometry, ReadOptions};
use colltrans_mesh::Mesh;
use numpy::{IntoPyArray, PyArray2, PyArrayMethods};
use pyo3::prelude::*;

use crate::answer::write_error;
use crate::arrays::{faces, points, table};
use crate::errors::{OrRaise, error};
use crate::frozen::getters;
use crate::pool;

/// Time between two polls for signals.
const PATIENCE: Duration = Duration::from_millis(50);

/// For each direction the free travel of a part, and the part that blocks it (-1 for none).
type RoomRow = (Vec<f64>, Vec<i64>);
/// Parts, direction, travel and turn of a move.
type LegRow = (Vec<usize>, [f64; 3], f64, Option<TurnRow>);
/// Point of the axis, number of turns, phase, lateral offset, proven tolerance, and a description.
type TurnRow = ([f64; 3], f64, f64, [f64; 3], Option<f64>, String);
/// A step of a plan: parts, direction, travel, bounds of the travel, moves out and back, the step that
/// removed the group that contains these parts, the steps before it, ignored pairs, tolerated pairs, and
/// three lists: parts that fall, parts that are off balance, support surfaces. At last the unscrewing and the tool.
type StepRow = (
    Vec<usize>,
    [f64; 3],
    f64,
    [f64; 2],
    [Vec<LegRow>; 2],
    Option<usize>,
    Vec<usize>,
    Vec<[usize; 2]>,
    Vec<PassedRow>,
    [Vec<usize>; 3],
    Option<UnscrewingRow>,
    Option<ToolRow>,
);
/// Length, number of turns, pitch, and a description.
type UnscrewingRow = (f64, f64, f64, String);
/// Name, parts in the way, and a description.
type ToolRow = (String, Vec<usize>, String);
/// Kind, designation and description of a fastener, its diameter, length and width, its axis, and whether it rests on
/// its name.
type FastenerRow = (&'static str, String, String, [f64; 3], [[f64; 3]; 2], bool);
/// Two parts, their role, their tolerance, and a description of what is tolerated.
type PassedRow = ([usize; 2], Option<&'static str>, Option<f64>, String);
/// Label of a stage, its range of steps, and its travel.
type StageRow = (String, [usize; 2], f64);
/// A plan: steps, stages, last parts, parts that are left, stuck groups, the answer for wanted parts, rounds,
/// order of assembly, seconds of each step, and the data for a report.
type PlanRows = (
    Vec<StepRow>,
    Vec<StageRow>,
    Vec<usize>,
    Vec<usize>,
    Vec<StuckRow>,
    Option<WantedRow>,
    Vec<Vec<usize>>,
    Vec<(usize, Vec<usize>)>,
    Vec<f64>,
    Planned,
);
/// Selected parts, other removed parts, whether this set is proven to be the smallest, and whether the selected parts
/// come out.
type WantedRow = (Vec<usize>, Vec<usize>, bool, bool);
/// Parts, number of tested directions, number of cells in which it is proven that no group can be removed,
/// reason, and for some parts the sets of parts that hold them.
type StuckRow = (Vec<usize>, usize, Option<usize>, String, Vec<(usize, Vec<Vec<usize>>)>);

/// Indices of the first and the second part and of the inner one (or -1), names of the findings and of the
/// roles, whether they are violations, whether both parts have open shells, a table for each of [`QUANTITIES`] by name,
/// the numbers of examined and of ignored pairs, the proof file of each claim, and the reasons of claims without a proof.
type AuditColumns<'py> = (
    [Vec<i64>; 3],
    [Vec<&'static str>; 2],
    Vec<bool>,
    Vec<[bool; 2]>,
    BTreeMap<&'static str, Bound<'py, PyArray2<f64>>>,
    [usize; 2],
    [Vec<BTreeMap<&'static str, String>>; 2],
);
/// Reason why the proofs of an audit are not complete.
enum ProofFailure {
    Audit(AssemblyError),
    /// A file is not written.
    Write(PathBuf, std::io::Error),
}

impl From<AssemblyError> for ProofFailure {
    fn from(error: AssemblyError) -> Self {
        Self::Audit(error)
    }
}

/// Clearance between two groups of parts.
type LevelRow = (Vec<String>, Vec<String>, f64);

/// The tolerance of the parts, and how overlaps at the start are treated.
#[derive(Clone, Copy)]
struct Choices {
    tolerance: Option<f64>,
    start: StartOverlap,
}

impl Choices {
    fn new(tolerance: Option<f64>, ignore_overlaps: bool) -> Self {
        let start = if ignore_overlaps { StartOverlap::Ignore } else { StartOverlap::Refuse };
        Self { tolerance, start }
    }

    fn fit(self, assembly: &colltrans_assembly::Assembly) -> Fit {
        self.tolerance.map_or_else(|| Fit::default_for(assembly), Fit::Tolerance)
    }
}

/// The vertices and triangles of a surface.
type Surface<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<u32>>);

/// The extension's part of ``colltrans.Assembly``.
#[pyclass(frozen, module = "colltrans._colltrans")]
pub(crate) struct Assembly(Arc<colltrans_assembly::Assembly>);

/// A plan with its assembly and its options.
#[pyclass(frozen, module = "colltrans._colltrans")]
pub(crate) struct Planned {
    assembly: Arc<colltrans_assembly::Assembly>,
    choices: Choices,
    question: AnalysisRequest,
    plan: Plan,
    times: HandlingTimes,
}

#[pymethods]
impl Planned {
    /// Returns the HTML page of the plan, for printing.
    fn report(&self, py: Python<'_>, title: &str) -> PyResult<String> {
        let Self { assembly, choices, question, plan, times } = self;
        run_interruptible(py, |watch| {
            let bodies = Bodies::new(assembly, choices.fit(assembly))?;
            let found = Analysis {
                plan: plan.clone(),
                times: *times,
                ..question.analyse_without_plan(&bodies, watch)?
            };
            Ok(html::report_page(&found, title))
        })
    }
}

impl Assembly {
    /// Returns a copy of the assembly after a change.
    fn with(
        &self,
        change: impl FnOnce(
            colltrans_assembly::Assembly,
        ) -> Result<colltrans_assembly::Assembly, AssemblyError>,
    ) -> PyResult<Self> {
        let assembly = colltrans_assembly::Assembly::clone(&self.0);
        Ok(Self(Arc::new(change(assembly).or_raise()?)))
    }

    /// Runs a computation on the bodies, with the chosen tolerance.
    fn ask<T: Send>(
        &self,
        py: Python<'_>,
        choices: Choices,
        work: impl FnOnce(&Bodies<'_>, Watch<'_>) -> Result<T, AssemblyError> + Send,
    ) -> PyResult<T> {
        run_interruptible(py, |watch| work(&Bodies::new(&self.0, choices.fit(&self.0))?, watch))
    }
}

/// Runs a computation on a thread of its own, and cancels it if a signal handler raises.
fn run_interruptible<T: Send>(
    py: Python<'_>,
    work: impl FnOnce(Watch<'_>) -> Result<T, AssemblyError> + Send,
) -> PyResult<T> {
    let cancel = AtomicBool::new(false);
    let (answer, raised) = py.detach(|| {
        let (done, wait) = channel();
        std::thread::scope(|scope| {
            let watch = Watch::default().with_cancel(&cancel);
            let worker = scope.spawn(move || {
                // Dropped when the work ends, also if it panics.
                let _done = done;
                pool::run(|| work(watch))
            });
            let mut raised = Ok(());
            let waiting = || wait.recv_timeout(PATIENCE) == Err::<(), _>(RecvTimeoutError::Timeout);
            while waiting() {
                if raised.is_ok() {
                    raised = Python::attach(|py| py.check_signals());
                    cancel.store(raised.is_err(), Ordering::Relaxed);
                }
            }
            (worker.join(), raised)
        })
    });
    raised?;
    let internal = |_| error("AssemblyError", "internal error; please report it");
    thread_error(answer.map_err(internal)?)?.or_raise()
}

/// Converts a failure to start threads to an exception.
fn thread_error<T>(answer: Result<T, rayon::ThreadPoolBuildError>) -> PyResult<T> {
    answer.map_err(|what| error("AssemblyError", format_args!("no threads: {what}")))
}

/// Normalises directions to unit vectors.
fn unit_vectors(directions: &[DVec3]) -> Result<Vec<DVec3>, AssemblyError> {
    directions.iter().map(|d| normalized_direction(*d)).collect()
}

/// Chooses the directions to test: the given ones, or a search if none are given.
fn choose_directions(given: &[DVec3]) -> Result<CandidateOptions, AssemblyError> {
    Ok(CandidateOptions::default().with_given(unit_vectors(given)?).with_search(given.is_empty()))
}

fn room_row<'a>(rooms: impl Iterator<Item = &'a PartTravel> + Clone) -> RoomRow {
    let by = |room: &PartTravel| room.blocker().map_or(-1, |by| by as i64);
    (rooms.clone().map(PartTravel::safe_distance).collect(), rooms.map(by).collect())
}

fn turn_row(turn: &Turn) -> TurnRow {
    let tolerance = turn.proof.as_ref().ok().map(|proof| proof.tolerance);
    let [point, aside] = [turn.point, turn.offset].map(|vector| vector.to_array());
    (point, turn.turns, turn.initial_turns, aside, tolerance, turn.describe())
}

fn passed_row(passed: &ToleratedContact) -> PassedRow {
    let ToleratedContact { parts, role, tolerated } = *passed;
    let tolerance = match tolerated {
        PairTolerance::Within(length) | PairTolerance::Snap(length) => Some(length),
        _ => None,
    };
    (parts, role.map(Role::name), tolerance, tolerated.describe(role))
}

/// Returns the numbers of a quantity of all pairs of an audit, a row for each pair. Absent values are NaN.
fn quantity_table<'py>(
    py: Python<'py>,
    quantity: &Quantity,
    pairs: &[AuditedPair],
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let width = quantity.columns.len();
    let numbers = pairs
        .iter()
        .flat_map(|pair| quantity.values(pair).unwrap_or_else(|| vec![f64::NAN; width]));
    numbers.collect::<Vec<_>>().into_pyarray(py).reshape([pairs.len(), width])
}

/// Reads a table of handling times, in seconds.
fn read_times(given: &BTreeMap<String, f64>) -> PyResult<HandlingTimes> {
    let refused = |reason: String| error("InputError", format!("times: {reason}"));
    let value = serde_json::to_value(given).map_err(|e| refused(e.to_string()))?;
    let times: HandlingTimes = serde_json::from_value(value).map_err(|e| refused(e.to_string()))?;
    match times.first_invalid() {
        Some((name, seconds)) => {
            Err(refused(format!("{name}: invalid time {seconds}; expected a number of seconds")))
        }
        None => Ok(times),
    }
}

/// Returns the role with a name.
fn role_from_name(name: Option<&str>) -> PyResult<Option<Role>> {
    let named = |name: &str| {
        let refused = || error("InputError", format!("unknown role {name}"));
        Role::from_name(name).ok_or_else(refused)
    };
    name.map(named).transpose()
}

getters!(Assembly, |it| {
    names: Vec<String> = it.0.parts().iter().map(|part| part.name().to_owned()).collect();
    chord_errors: Vec<Option<f64>> = it.0.parts().iter().map(Part::chord_error).collect();
    unit: Option<String> = it.0.unit().map(str::to_owned);
    notes: Vec<String> = it.0.notes().to_vec();
});

#[pymethods]
impl Assembly {
    #[new]
    fn new(parts: Vec<(String, Bound<'_, PyAny>, Bound<'_, PyAny>)>) -> PyResult<Self> {
        let part = |(name, vertices, corners): &(String, Bound<'_, PyAny>, Bound<'_, PyAny>)| {
            let (vertices, faces) = (points(vertices, "vertices")?, faces(corners)?);
            let mesh = Mesh::new(vertices, faces);
            Part::new(name, &[Piece { mesh, world_from_piece: DAffine3::IDENTITY }]).or_raise()
        };
        let parts = parts.iter().map(part).collect::<PyResult<_>>()?;
        Ok(Self(Arc::new(colltrans_assembly::Assembly::new(parts).or_raise()?)))
    }

    #[staticmethod]
    #[expect(
        clippy::too_many_arguments,
        clippy::fn_params_excessive_bools,
        reason = "they are keywords"
    )]
    fn read(
        py: Python<'_>,
        path: PathBuf,
        packages: Vec<PathBuf>,
        skip_missing: bool,
        visual: bool,
        joints: BTreeMap<String, f64>,
        allow_outside: bool,
        as_is: bool,
        split: &str,
        glb: Option<Vec<u8>>,
    ) -> PyResult<Self> {
        let geometry = if visual { Geometry::Visual } else { Geometry::Collision };
        let options = ReadOptions::default()
            .with_packages(packages)
            .with_skip_missing(skip_missing)
            .with_geometry(geometry)
            .with_joints(joints)
            .with_allow_outside(allow_outside)
            .with_as_is(as_is)
            .with_split(
                split.parse().map_err(|e: String| error("AssemblyError", format!("split: {e}")))?,
            );
        // The bytes that a STEP file was converted to.
        let read = || match &glb {
            Some(bytes) => read::glb_with(&path, bytes, &options),
            None => read::read(&path, &options),
        };
        let assembly = thread_error(py.detach(|| pool::run(read)))?.or_raise()?;
        Ok(Self(Arc::new(assembly)))
    }

    fn with_fixed(&self, names: Vec<String>) -> PyResult<Self> {
        self.with(|assembly| assembly.with_fixed(&names))
    }

    fn with_ignored(&self, pairs: Vec<[String; 2]>, always: bool) -> PyResult<Self> {
        let ignored = if always { Ignored::Always } else { Ignored::Overlap };
        self.with(|assembly| assembly.with_ignored(&pairs, ignored))
    }

    fn with_before(&self, first: Vec<String>, second: Vec<String>) -> PyResult<Self> {
        self.with(|assembly| assembly.with_before(&first, &second))
    }

    fn with_together(&self, names: Vec<String>) -> PyResult<Self> {
        self.with(|assembly| assembly.with_together(&names))
    }

    fn with_subassembly(&self, name: &str, parts: Vec<String>) -> PyResult<Self> {
        self.with(|assembly| assembly.with_subassembly(name, &parts))
    }

    fn with_never(
        &self,
        names: Vec<String>,
        along: &Bound<'_, PyAny>,
        within: f64,
    ) -> PyResult<Self> {
        let along = crate::arrays::vector(along, "along")?;
        self.with(|assembly| assembly.with_never(&names, along, within))
    }

    fn with_pair(
        &self,
        first: Vec<String>,
        second: Vec<String>,
        role: Option<&str>,
        tolerance: Option<f64>,
    ) -> PyResult<Self> {
        let fit = PairFit { role: role_from_name(role)?, tolerance };
        self.with(|assembly| assembly.with_pair([&first, &second], fit))
    }

    fn suggestions(
        &self,
        py: Python<'_>,
        tolerance: Option<f64>,
        stuck: Vec<Vec<String>>,
    ) -> PyResult<Vec<PassedRow>> {
        let stuck: Vec<Vec<usize>> =
            stuck.into_iter().map(|names| self.group(names)).collect::<PyResult<_>>()?;
        let found = self.ask(py, Choices::new(tolerance, false), |bodies, watch| {
            let mut all = suggest_fits(bodies, &Start::new(bodies, watch)?);
            for parts in &stuck {
                all.extend(suggest_loose_threads(bodies, parts)?);
            }
            Ok(all)
        })?;
        let row = |s: Suggestion| (s.parts, s.fit.role.map(Role::name), s.fit.tolerance, s.reason);
        Ok(found.into_iter().map(row).collect())
    }

    /// Returns the fastener that each part is.
    fn fasteners(&self, py: Python<'_>) -> PyResult<Vec<Option<FastenerRow>>> {
        let found = thread_error(py.detach(|| pool::run(|| Fasteners::find(&self.0))))?;
        let row = |f: &Fastener| {
            let (sizes, axis) = ([f.diameter, f.length, f.width], f.axis.map(|v| v.to_array()));
            (f.kind.name(), f.designation.clone(), f.details(), sizes, axis, f.needs_name)
        };
        Ok((0..self.0.parts().len()).map(|part| found.get(part).map(row)).collect())
    }

    fn group(&self, names: Vec<String>) -> PyResult<Vec<usize>> {
        self.0.parts_named(&names).or_raise()
    }

    /// Returns the vertices and triangles of all parts, in the world.
    fn meshes<'py>(&self, py: Python<'py>) -> PyResult<Vec<Surface<'py>>> {
        let mesh = |part: &colltrans_assembly::Part| {
            let solid = part.solid();
            let vertices = table(py, solid.vertices().iter().map(DVec3::to_array))?;
            Ok((vertices, table(py, solid.triangles().iter().copied())?))
        };
        self.0.parts().iter().map(mesh).collect()
    }

    fn index(&self, name: &str) -> PyResult<usize> {
        self.0.part_index(name).or_raise()
    }

    fn rooms(
        &self,
        py: Python<'_>,
        directions: &Bound<'_, PyAny>,
        tolerance: Option<f64>,
        ignore_overlaps: bool,
    ) -> PyResult<Vec<RoomRow>> {
        let directions = points(directions, "directions")?;
        let choices = Choices::new(tolerance, ignore_overlaps);
        self.ask(py, choices, |bodies, watch| {
            let rooms =
                travels_of_parts(bodies, &unit_vectors(&directions)?, choices.start, watch)?;
            Ok(rooms.iter().map(|row| room_row(row.iter())).collect())
        })
    }

    fn audit<'py>(
        &self,
        py: Python<'py>,
        within: f64,
        levels: Vec<LevelRow>,
        tolerance: Option<f64>,
        allow_contact: bool,
        proofs: Option<PathBuf>,
    ) -> PyResult<AuditColumns<'py>> {
        let options = AuditOptions::default().with_allow_contact(allow_contact);
        let mut options = options.with_within(within).or_raise()?;
        for (first, second, length) in &levels {
            options = options.with_level(&self.0, [first, second], *length).or_raise()?;
        }
        let choices = Choices::new(tolerance, false);
        let found = self.ask(py, choices, |bodies, watch| {
            let mut found = audit(bodies, &options, watch)?;
            let Some(folder) = proofs else { return Ok(Ok(found)) };
            let write = |name: &str, text: &str| {
                let path = folder.join(name);
                let written = std::fs::write(&path, format!("{text}\n"));
                written.map_err(|error| ProofFailure::Write(path, error))
            };
            match prove_pairs(&self.0, &mut found, options.volume, watch, write) {
                Ok(()) => Ok(Ok(found)),
                Err(ProofFailure::Audit(error)) => Err(error),
                Err(ProofFailure::Write(path, error)) => Ok(Err((path, error))),
            }
        })?;
        let found = found.map_err(|(path, error)| write_error(&path, &error))?;
        let tables = QUANTITIES
            .iter()
            .map(|quantity| Ok((quantity.name, quantity_table(py, quantity, &found.pairs)?)));
        let tables = tables.collect::<PyResult<_>>()?;
        let column = |part: fn(&AuditedPair) -> Option<usize>| {
            let index = |pair| part(pair).map_or(-1, |part| part as i64);
            found.pairs.iter().map(index).collect()
        };
        let role = |[a, b]: [usize; 2]| self.0.pair_fit(a, b).and_then(|fit| fit.role);
        let pairs = found.pairs.iter();
        let files = |is_proven: bool| {
            let of_pair = |pair: &AuditedPair| {
                let some = pair.proofs.iter().filter(|proof| proof.file.is_ok() == is_proven);
                let entry = |proof: &PairProof| {
                    let (Ok(text) | Err(text)) = &proof.file;
                    (proof.claim.name(), text.clone())
                };
                some.map(entry).collect()
            };
            found.pairs.iter().map(of_pair).collect()
        };
        Ok((
            [
                column(|pair| Some(pair.parts[0])),
                column(|pair| Some(pair.parts[1])),
                column(|pair| pair.finding.inner()),
            ],
            [
                pairs.clone().map(|pair| pair.finding.name()).collect(),
                pairs.clone().map(|pair| role(pair.parts).map_or("", Role::name)).collect(),
            ],
            pairs.clone().map(|pair| pair.is_violation).collect(),
            pairs.map(|pair| pair.has_open_shells).collect(),
            tables,
            [found.counts.examined, found.counts.ignored],
            [files(true), files(false)],
        ))
    }

    fn blocking(
        &self,
        py: Python<'_>,
        direction: &Bound<'_, PyAny>,
        tolerance: Option<f64>,
        ignore_overlaps: bool,
    ) -> PyResult<[Vec<Vec<usize>>; 2]> {
        let direction = crate::arrays::vector(direction, "direction")?;
        let choices = Choices::new(tolerance, ignore_overlaps);
        self.ask(py, choices, |bodies, watch| {
            let all = vec![true; bodies.len()];
            let matrix = ContactMatrix::new(
                bodies,
                &[normalized_direction(direction)?],
                &all,
                choices.start,
                watch,
            )?;
            let graph = BlockingGraph::new(&matrix, 0, &all);
            let blockers = (0..bodies.len()).map(|part| graph.direct_blockers(part)).collect();
            Ok([blockers, graph.removable_groups()])
        })
    }

    #[expect(clippy::too_many_arguments, reason = "they are keywords")]
    fn plan(
        &self,
        py: Python<'_>,
        directions: &Bound<'_, PyAny>,
        samples: usize,
        effort: u32,
        proofs: bool,
        tolerance: Option<f64>,
        ignore_overlaps: bool,
        gravity: Option<&Bound<'_, PyAny>>,
        wanted: Vec<usize>,
        times: BTreeMap<String, f64>,
    ) -> PyResult<PlanRows> {
        let times = read_times(&times)?;
        let given = points(directions, "directions")?;
        let gravity = gravity.map(|g| crate::arrays::vector(g, "gravity")).transpose()?;
        let choices = Choices::new(tolerance, ignore_overlaps);
        let options = PlanOptions::default()
            .with_start(choices.start)
            .with_samples(samples)
            .with_effort(effort)
            .with_proofs(proofs);
        let question = AnalysisRequest::default()
            .with_choice(choose_directions(&given).or_raise()?)
            .with_options(options)
            .with_selected(wanted);
        let question = match gravity {
            Some(gravity) => question.with_gravity(gravity),
            None => question,
        };
        let (plan, because, stages) = self.ask(py, choices, |bodies, watch| {
            let plan = question.analyse(bodies, watch)?.plan;
            let because = plan.interlocked.iter().map(|stuck| stuck.explain(bodies));
            let because: Vec<String> = because.collect();
            let stage = |stage: Range<usize>| {
                let takes = plan.describe_stage(bodies.assembly(), &stage);
                (takes, [stage.start, stage.end], plan.stage_travel(&stage))
            };
            let stages: Vec<StageRow> = plan.stages().into_iter().map(stage).collect();
            Ok((plan, because, stages))
        })?;
        let (rounds, reverse) = (plan.parallel_rounds(), plan.assembly_sequence());
        let seconds = times.step_seconds(&plan);
        let planned =
            Planned { assembly: self.0.clone(), choices, question, plan: plan.clone(), times };
        let steps = plan.steps.into_iter();
        let tool = |reach: ToolReach| {
            let words = reach.describe(&self.0);
            (reach.tool, reach.blockers, words)
        };
        let row = |s: Step| {
            let (direction, travel) = (s.direction.to_array(), s.travel);
            let leg = |leg: Leg| {
                let turn = leg.turn.as_ref().map(turn_row);
                (leg.parts, leg.direction.to_array(), leg.travel, turn)
            };
            let legs = [s.path, s.return_legs].map(|all| all.into_iter().map(leg).collect());
            let (travel, bounds) = (travel.value, travel.bounds());
            let passed = s.tolerated.iter().map(passed_row).collect();
            let named = [s.falling, s.off_balance, s.surfaces];
            (
                s.parts,
                direction,
                travel,
                bounds,
                legs,
                s.group_step,
                s.predecessors,
                s.ignored,
                passed,
                named,
                s.unscrewing.map(|u| (u.length, u.turns(), u.pitch, u.words())),
                s.tool.map(tool),
            )
        };
        let steps = steps.map(row).collect();
        let stuck = plan.interlocked.into_iter().zip(because).map(|(stuck, because)| {
            let sets = |by: Vec<(Vec<usize>, DVec3)>| by.into_iter().map(|(set, _)| set).collect();
            (
                stuck.parts,
                stuck.tested_directions,
                stuck.proof_cells,
                because,
                stuck.blocking_sets.into_iter().map(|h| (h.part, sets(h.sets))).collect(),
            )
        });
        let wanted = |SelectedRemoval { parts, others, is_minimal, is_complete, .. }| {
            (parts, others, is_minimal, is_complete)
        };
        let goes = plan.selection.map(wanted);
        let stuck = stuck.collect();
        Ok((
            steps,
            stages,
            plan.base,
            plan.remaining,
            stuck,
            goes,
            rounds,
            reverse,
            seconds,
            planned,
        ))
    }

    #[expect(clippy::type_complexity, reason = "the tuple has the four parts of a map")]
    fn removal_map(
        &self,
        py: Python<'_>,
        group: Vec<usize>,
        samples: usize,
        border: f64,
        tolerance: Option<f64>,
        ignore_overlaps: bool,
    ) -> PyResult<(Vec<[f64; 3]>, RoomRow, Vec<(f64, [f64; 3])>, Vec<[f64; 3]>)> {
        let choices = Choices::new(tolerance, ignore_overlaps);
        let map = self.ask(py, choices, |bodies, watch| {
            let touching = find_liaisons(bodies, watch)?;
            let directions =
                find_candidates(bodies, &touching, &CandidateOptions::default())?.directions();
            let options = MapOptions::default()
                .with_samples(samples)
                .with_border(border)
                .with_start(choices.start);
            RemovalMap::new(bodies, &group, &directions, options, watch)
        })?;
        Ok((
            map.sphere.directions.iter().map(DVec3::to_array).collect(),
            room_row(map.travels.iter()),
            map.regions.iter().map(|r| (r.solid_angle, r.center.to_array())).collect(),
            map.isolated.iter().map(DVec3::to_array).collect(),
        ))
    }
}
