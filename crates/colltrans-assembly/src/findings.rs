//! The complete analysis of an assembly, shared by the command line, Python, the web page and tests.

use glam::DVec3;

use crate::bodies::Bodies;
use crate::candidates::{
    CandidateOptions, CandidateSource, Candidates, FinerCandidate, find_candidates,
};
use crate::error::AssemblyError;
use crate::liaisons::{Liaison, find_liaisons};
use crate::map::RemovalMap;
use crate::matrix::ContactMatrix;
use crate::plan::{HandlingTimes, Plan, PlanOptions, disassemble, remove};
use crate::start::Start;
use crate::suggest::{Suggestion, suggest_fits, suggest_loose_threads};
use crate::travel::PartTravel;
use crate::watch::Watch;

/// Maximum number of parts for which all contacts are computed at once. Above it they are computed on demand.
const MOST_AT_ONCE: usize = 256;

/// A request for the analysis of an assembly.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct AnalysisRequest {
    /// Choice of the directions that are tested for all parts.
    pub choice: CandidateOptions,
    /// Directions of length 1 that are tested first for parts that none of the main directions moves.
    pub finer: Vec<DVec3>,
    /// Options of the plan.
    pub options: PlanOptions,
    /// Indices of the parts to remove; empty to remove all.
    pub selected: Vec<usize>,
}

/// The results of the analysis of an assembly.
#[derive(Clone)]
pub struct Analysis<'a> {
    /// The parts with their fit.
    pub bodies: &'a Bodies<'a>,
    /// Overlaps at the start.
    pub start: Start,
    /// Suggested roles of overlapping pairs, and threads with play that block interlocked parts.
    pub suggestions: Vec<Suggestion>,
    /// Contacts between parts.
    pub liaisons: Vec<Liaison>,
    /// The tested directions and their sources.
    pub candidates: Candidates,
    /// Contacts along the main directions: complete for few parts, otherwise computed on demand.
    pub matrix: ContactMatrix<'a>,
    /// Free travel of all parts along further directions, for each direction.
    pub further_travels: Vec<(DVec3, Vec<PartTravel>)>,
    /// The disassembly plan.
    pub plan: Plan,
    /// The handling times by which the steps of the plan are timed.
    pub times: HandlingTimes,
    /// Direction opposite to gravity, of length 1.
    pub up: DVec3,
    /// Removal maps, with the names by which they were requested.
    pub maps: Vec<(String, RemovalMap)>,
}

impl AnalysisRequest {
    /// Returns the request with another choice of directions.
    #[must_use]
    pub fn with_choice(self, choice: CandidateOptions) -> Self {
        Self { choice, ..self }
    }

    /// Returns the request with other [finer](Self::finer) directions.
    #[must_use]
    pub fn with_finer(self, finer: Vec<DVec3>) -> Self {
        Self { finer, ..self }
    }

    /// Returns the request with other options of the plan.
    #[must_use]
    pub fn with_options(self, options: PlanOptions) -> Self {
        Self { options, ..self }
    }

    /// Returns the request for the removal of [some parts](Self::selected).
    #[must_use]
    pub fn with_selected(self, wanted: Vec<usize>) -> Self {
        Self { selected: wanted, ..self }
    }

    /// Returns the request with gravity along a direction of any nonzero length.
    #[must_use]
    pub fn with_gravity(mut self, gravity: DVec3) -> Self {
        self.choice.gravity = Some(gravity);
        self.options.up = Some(DVec3::ZERO - gravity);
        self
    }

    /// Analyses the assembly: overlaps, contacts, directions, contacts along these, and a plan.
    ///
    /// # Errors
    /// Returns the errors of [`Start::new`], [`find_liaisons`], [`find_candidates`], [`ContactMatrix::new`],
    /// [`disassemble`] and [`remove`].
    pub fn analyse<'a>(
        &self,
        bodies: &'a Bodies<'a>,
        watch: Watch,
    ) -> Result<Analysis<'a>, AssemblyError> {
        let mut found = self.analyse_without_plan(bodies, watch)?;
        let Analysis { matrix, candidates, .. } = &found;
        found.plan = match &self.selected[..] {
            [] => disassemble(bodies, matrix, &candidates.finer, self.options, watch)?,
            parts => remove(bodies, matrix, &candidates.finer, parts, self.options, watch)?,
        };
        for stuck in &found.plan.interlocked {
            found.suggestions.extend(suggest_loose_threads(bodies, &stuck.parts)?);
        }
        Ok(found)
    }

    /// Analyses the assembly without a plan, which is left empty.
    ///
    /// # Errors
    /// Returns the errors of [`analyse`](Self::analyse).
    pub fn analyse_without_plan<'a>(
        &self,
        bodies: &'a Bodies<'a>,
        watch: Watch,
    ) -> Result<Analysis<'a>, AssemblyError> {
        let start = Start::new(bodies, watch)?;
        let liaisons = find_liaisons(bodies, watch)?;
        let mut candidates = find_candidates(bodies, &liaisons, &self.choice)?;
        let finer = |&direction: &DVec3| FinerCandidate {
            direction,
            source: CandidateSource::Given,
            part: None,
        };
        candidates.finer.splice(0..0, self.finer.iter().map(finer));
        let (all, overlap) = (vec![true; bodies.len()], self.options.start);
        bodies.measure_along(&candidates.directions());
        let matrix = ContactMatrix::on_demand(bodies, &candidates.directions(), &all, overlap);
        if bodies.len() <= MOST_AT_ONCE {
            matrix.compute_all(watch)?;
        }
        Ok(Analysis {
            suggestions: suggest_fits(bodies, &start),
            up: self.options.up.map_or(bodies.assembly().up(), DVec3::normalize),
            bodies,
            start,
            liaisons,
            candidates,
            matrix,
            further_travels: Vec::new(),
            plan: Plan::default(),
            times: HandlingTimes::default(),
            maps: Vec::new(),
        })
    }
}
