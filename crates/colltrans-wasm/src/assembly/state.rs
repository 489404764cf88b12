//! The parts in use, and the answers about them.
//!
//! Questions, by their field `do`:
//! - `add`: adds the parts of the attached file, named `name`; a GLB file may have several;
//! - `parts`: builds the assembly of all added parts; returns their meshes;
//! - `fit`: sets `tolerance` (default if missing) and `ignore_overlaps`; returns overlaps and liaisons;
//! - `along`: returns blockers and removable groups for a `direction`;
//! - `map`: returns the free travel of the parts `group` in all directions;
//! - `plan`: returns a disassembly plan;
//! - `report`: returns the printable report of the plan, with a `title`;
//! - `audit`: returns the pairs that interfere, touch, or are nearer than `within`;
//! - `clashes`: returns the report of the last audit, with a `title`.

use std::path::Path;

use colltrans::solid::StartOverlap;
use colltrans_assembly::audit::{Audit, AuditOptions, audit};
use colltrans_assembly::candidates::{CandidateOptions, Candidates, find_candidates};
use colltrans_assembly::liaisons::{Liaison, find_liaisons};
use colltrans_assembly::map::{MapOptions, RemovalMap};
use colltrans_assembly::matrix::ContactMatrix;
use colltrans_assembly::plan::{Plan, PlanOptions};
use colltrans_assembly::report::{clashes, html};
use colltrans_assembly::sphere::normalized_direction;
use colltrans_assembly::start::Start;
use colltrans_assembly::{Analysis, AnalysisRequest, Assembly, Bodies, Fit, Part, Piece, Watch};
use colltrans_assembly_io::read;
use colltrans_mesh::Format;
use glam::{DAffine3, DVec3};
use serde_json::{Value, json};

use super::answers;
use crate::Answers;
use crate::answer::{Answer, Refusal};
use crate::fields::Fields;

/// Maximum number of parts. The page has one thread; larger assemblies are for the command line.
const MOST_PARTS: usize = 120;
/// Maximum number of triangles of all parts.
const MOST_TRIANGLES: usize = 400_000;
/// Number of samples of a removal map before refinement. It is lower than on the command line because the map
/// is only a picture to click into.
const SAMPLES: usize = 642;
/// Resolution of the borders of free regions, in radians.
const BORDER: f64 = 0.04;

/// The parts that were added, and the assembly built from them.
#[derive(Default)]
pub struct State {
    gathered: Vec<Part>,
    unit: Option<String>,
    set: Option<Set>,
}

/// An assembly with the results for its current fit.
struct Set {
    /// Leaked, because the page starts another module for another assembly.
    assembly: &'static Assembly,
    fitted: Option<Fitted>,
}

struct Fitted {
    bodies: Bodies<'static>,
    start: StartOverlap,
    candidates: Candidates,
    plan: Option<Plan>,
    audit: Option<(AuditOptions, Audit)>,
}

impl Answers for State {
    /// Answers one question. `file` has the attached bytes, if any.
    fn ask(&mut self, question: &[u8], file: Vec<u8>) -> Answer {
        let asked: Result<Value, _> = serde_json::from_slice(question);
        let answer = match &asked {
            Err(error) => Err(format!("the question cannot be read: {error}").into()),
            Ok(asked) => {
                Fields::from_value(asked).map_err(Refusal::from).and_then(|f| self.answer(&f, file))
            }
        };
        answer.unwrap_or_else(Refusal::into_answer)
    }
}

impl State {
    fn answer(&mut self, asked: &Fields, file: Vec<u8>) -> Result<Answer, Refusal> {
        match asked.text("do")? {
            "add" => self.add(asked.text("name")?, file),
            "parts" => self.parts(),
            "fit" => self.fit(asked.number("tolerance")?, asked.flag("ignore_overlaps")),
            "along" => self.along(asked.array("direction")?),
            "map" => self.map(&asked.list("group")?),
            "plan" => self.plan(),
            "report" => self.report(asked.text("title")?),
            "audit" => self.audit(asked.number("within")?),
            "clashes" => self.clashes(asked.text("title")?),
            other => Err(format!("unknown question {other}").into()),
        }
    }

    fn add(&mut self, name: &str, file: Vec<u8>) -> Result<Answer, Refusal> {
        let path = Path::new(name);
        let before = self.gathered.len();
        if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("glb")) {
            let read = read::glb(path, &file).map_err(|error| error.to_string())?;
            self.unit = read.unit().map(str::to_owned);
            self.gathered.extend_from_slice(read.parts());
        } else {
            let format = Format::from_path(path).map_err(|error| error.to_string())?;
            let mesh =
                colltrans_mesh::parse(format, file, path).map_err(|error| error.to_string())?;
            let stem = path.file_stem().unwrap_or(path.as_os_str()).to_string_lossy();
            let piece = Piece { mesh, world_from_piece: DAffine3::IDENTITY };
            let part = Part::new(self.unused_name(&stem), &[piece]);
            self.gathered.push(part.map_err(|error| format!("{name}: {error}"))?);
        }
        if let Err(refusal) = self.check_size(name) {
            self.gathered.truncate(before);
            return Err(refusal);
        }
        Ok(Answer::from_facts(&json!({ "parts": self.gathered.len() })))
    }

    fn check_size(&self, name: &str) -> Result<(), Refusal> {
        let triangles: usize = self.gathered.iter().map(|p| p.solid().triangles().len()).sum();
        if self.gathered.len() <= MOST_PARTS && triangles <= MOST_TRIANGLES {
            return Ok(());
        }
        let parts = self.gathered.len();
        Err(format!(
            "{name}: too large; with it there are {parts} parts with {triangles} triangles, but the page accepts \
             {MOST_PARTS} parts and {MOST_TRIANGLES} triangles; use the command line"
        )
        .into())
    }

    /// Returns a part name that is not used yet.
    fn unused_name(&self, stem: &str) -> String {
        let taken = |name: &str| self.gathered.iter().any(|part| part.name() == name);
        let numbered = (2..).map(|number| format!("{stem}_{number}"));
        std::iter::once(stem.to_owned())
            .chain(numbered)
            .find(|name| !taken(name))
            .unwrap_or_default()
    }

    fn parts(&mut self) -> Result<Answer, Refusal> {
        let parts = std::mem::take(&mut self.gathered);
        if parts.is_empty() {
            return Err("there are no parts".to_owned().into());
        }
        let mut assembly = Assembly::new(parts).map_err(|error| error.to_string())?;
        if let Some(unit) = self.unit.take() {
            assembly = assembly.with_unit(unit);
        }
        let assembly: &'static Assembly = Box::leak(Box::new(assembly));
        self.set = Some(Set { assembly, fitted: None });
        Ok(answers::parts_answer(assembly))
    }

    fn fit(&mut self, tolerance: Option<f64>, ignore: bool) -> Result<Answer, Refusal> {
        let Some(set) = &mut self.set else { return Err("there are no parts".to_owned().into()) };
        let default = Fit::default_for(set.assembly);
        let fit = tolerance.map_or(default, Fit::Tolerance);
        let watch = Watch::default();
        let message = |error: colltrans_assembly::AssemblyError| error.to_string();
        let bodies = Bodies::new(set.assembly, fit).map_err(message)?;
        let start = Start::new(&bodies, watch).map_err(message)?;
        let touching: Vec<Liaison> = find_liaisons(&bodies, watch).map_err(message)?;
        let candidates =
            find_candidates(&bodies, &touching, &CandidateOptions::default()).map_err(message)?;
        let answer = answers::fit_answer(&bodies, default.tolerance(), &start, &touching);
        let overlaps = if ignore { StartOverlap::Ignore } else { StartOverlap::Refuse };
        set.fitted = Some(Fitted { bodies, start: overlaps, candidates, plan: None, audit: None });
        Ok(answer)
    }

    fn fitted(&mut self) -> Result<&mut Fitted, Refusal> {
        let fitted = self.set.as_mut().and_then(|set| set.fitted.as_mut());
        fitted.ok_or_else(|| "the parts have no fit yet".to_owned().into())
    }

    fn along(&mut self, direction: [f64; 3]) -> Result<Answer, Refusal> {
        let Fitted { bodies, start, .. } = self.fitted()?;
        let d = normalized_direction(DVec3::from_array(direction))
            .map_err(|error| error.to_string())?;
        let all = vec![true; bodies.len()];
        let matrix = ContactMatrix::new(bodies, &[d], &all, *start, Watch::default());
        Ok(answers::blocking_answer(&matrix.map_err(|error| error.to_string())?, bodies))
    }

    fn map(&mut self, group: &[f64]) -> Result<Answer, Refusal> {
        let Fitted { bodies, start, candidates, .. } = self.fitted()?;
        let mut parts: Vec<usize> = group.iter().map(|k| *k as usize).collect();
        parts.sort_unstable();
        parts.dedup();
        if parts.last().is_none_or(|last| *last >= bodies.len()) {
            return Err(format!(
                "part indices {group:?} are out of range; there are {} parts",
                bodies.len()
            )
            .into());
        }
        let options =
            MapOptions::default().with_samples(SAMPLES).with_border(BORDER).with_start(*start);
        let directions = candidates.directions();
        let map = RemovalMap::new(bodies, &parts, &directions, options, Watch::default());
        Ok(answers::map_answer(&map.map_err(|error| error.to_string())?, bodies.assembly()))
    }

    fn plan(&mut self) -> Result<Answer, Refusal> {
        let Fitted { bodies, start, plan, .. } = self.fitted()?;
        let found = plan_options(*start).analyse(bodies, Watch::default());
        let found = found.map_err(|error| error.to_string())?;
        let answer = answers::plan_answer(bodies, &found.plan, found.matrix.directions().len());
        *plan = Some(found.plan);
        Ok(answer)
    }

    /// Returns the report; its bytes are the numbers of the answer.
    fn report(&mut self, title: &str) -> Result<Answer, Refusal> {
        let Fitted { bodies, start, plan, .. } = self.fitted()?;
        let Some(plan) = plan.clone() else {
            return Err("there is no plan yet; ask for a plan first".to_owned().into());
        };
        let found = plan_options(*start).analyse_without_plan(bodies, Watch::default());
        let found = Analysis { plan, ..found.map_err(|error| error.to_string())? };
        let page = html::report_page(&found, title).into_bytes();
        Ok(Answer { numbers: page, ..Answer::from_facts(&json!({ "title": title })) })
    }

    fn audit(&mut self, within: Option<f64>) -> Result<Answer, Refusal> {
        let Fitted { bodies, audit: last, .. } = self.fitted()?;
        let options = AuditOptions::default().with_within(within.unwrap_or_default());
        let options = options.map_err(|error| error.to_string())?;
        let found = audit(bodies, &options, Watch::default()).map_err(|error| error.to_string())?;
        let answer = answers::audit_answer(bodies, &options, &found);
        *last = Some((options, found));
        Ok(answer)
    }

    /// Returns the report of the last audit; its bytes are the numbers of the answer.
    fn clashes(&mut self, title: &str) -> Result<Answer, Refusal> {
        let Fitted { bodies, audit, .. } = self.fitted()?;
        let Some((options, found)) = audit else {
            return Err("there is no audit yet; ask for an audit first".to_owned().into());
        };
        let page = clashes::clashes_page(bodies, options, found, title, Watch::default());
        let numbers = page.map_err(|error| error.to_string())?.into_bytes();
        Ok(Answer { numbers, ..Answer::from_facts(&json!({ "title": title })) })
    }
}

/// Returns the options of a plan.
fn plan_options(start: StartOverlap) -> AnalysisRequest {
    AnalysisRequest::default().with_options(PlanOptions::default().with_start(start))
}
