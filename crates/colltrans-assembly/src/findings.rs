//! All that is found out about an assembly, in one go: the same for the command line, Python, a page, tests.

use glam::DVec3;

use crate::bodies::Bodies;
use crate::candidates::{Candidates, Choice, Finer, Origin, candidates};
use crate::error::AssemblyError;
use crate::liaisons::{Liaison, liaisons};
use crate::map::RemovalMap;
use crate::matrix::Matrix;
use crate::plan::{Plan, PlanOptions, Times, disassemble, remove};
use crate::rooms::PartRoom;
use crate::start::Start;
use crate::suggest::{Suggestion, loose_threads, suggestions};
use crate::watch::Watch;

/// Of so many parts every pair is asked at once; of more, pairs are asked as they are needed.
const MOST_AT_ONCE: usize = 256;

/// What is asked of an assembly.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct Question {
    /// Which directions are asked of all parts.
    pub choice: Choice,
    /// Of length 1, asked of what none of those moves, before others.
    pub finer: Vec<DVec3>,
    /// How it is planned.
    pub options: PlanOptions,
    /// Parts that are to come out; all, if there are none.
    pub wanted: Vec<usize>,
}

/// All that was found out about an assembly.
#[derive(Clone)]
pub struct Findings<'a> {
    /// The parts, with the fit.
    pub bodies: &'a Bodies<'a>,
    /// Overlaps at the start.
    pub start: Start,
    /// What overlaps may be, and threads with play that hold what does not come apart.
    pub suggestions: Vec<Suggestion>,
    /// Who touches whom.
    pub liaisons: Vec<Liaison>,
    /// The directions asked, and why.
    pub candidates: Candidates,
    /// Who meets whom along the main ones: of few parts all of it, else as it is asked for.
    pub matrix: Matrix<'a>,
    /// Rooms of all parts in more directions, by direction.
    pub more: Vec<(DVec3, Vec<PartRoom>)>,
    /// How it comes apart.
    pub plan: Plan,
    /// What its steps take.
    pub times: Times,
    /// What is upwards, of length 1.
    pub up: DVec3,
    /// Removal maps, with the names they were asked by.
    pub maps: Vec<(String, RemovalMap)>,
}

impl Question {
    /// The same with directions chosen otherwise.
    #[must_use]
    pub fn with_choice(self, choice: Choice) -> Self {
        Self { choice, ..self }
    }

    /// The same with other [finer](Self::finer) directions.
    #[must_use]
    pub fn with_finer(self, finer: Vec<DVec3>) -> Self {
        Self { finer, ..self }
    }

    /// The same planned otherwise.
    #[must_use]
    pub fn with_options(self, options: PlanOptions) -> Self {
        Self { options, ..self }
    }

    /// The same for [some parts](Self::wanted).
    #[must_use]
    pub fn with_wanted(self, wanted: Vec<usize>) -> Self {
        Self { wanted, ..self }
    }

    /// The same with gravity along a direction, of any length but zero.
    #[must_use]
    pub fn with_gravity(mut self, gravity: DVec3) -> Self {
        self.choice.gravity = Some(gravity);
        self.options.up = Some(DVec3::ZERO - gravity);
        self
    }

    /// Asks it: overlaps, contacts, directions, who meets whom along them, and a plan.
    ///
    /// # Errors
    /// As [`Start::new`], [`liaisons`], [`candidates`], [`Matrix::new`], [`disassemble`] and [`remove`].
    pub fn ask<'a>(
        &self,
        bodies: &'a Bodies<'a>,
        watch: Watch,
    ) -> Result<Findings<'a>, AssemblyError> {
        let mut found = self.look(bodies, watch)?;
        let Findings { matrix, candidates, .. } = &found;
        found.plan = match &self.wanted[..] {
            [] => disassemble(bodies, matrix, &candidates.finer, self.options, watch)?,
            parts => remove(bodies, matrix, &candidates.finer, parts, self.options, watch)?,
        };
        for stuck in &found.plan.stuck {
            found.suggestions.extend(loose_threads(bodies, &stuck.parts)?);
        }
        Ok(found)
    }

    /// The same but for the plan, which is left empty.
    ///
    /// # Errors
    /// As [`ask`](Self::ask).
    pub fn look<'a>(
        &self,
        bodies: &'a Bodies<'a>,
        watch: Watch,
    ) -> Result<Findings<'a>, AssemblyError> {
        let start = Start::new(bodies, watch)?;
        let liaisons = liaisons(bodies, watch)?;
        let mut candidates = candidates(bodies, &liaisons, &self.choice)?;
        let finer = |&direction: &DVec3| Finer { direction, origin: Origin::Given, part: None };
        candidates.finer.splice(0..0, self.finer.iter().map(finer));
        let (all, overlap) = (vec![true; bodies.len()], self.options.start);
        bodies.measure_along(&candidates.directions());
        let matrix = Matrix::on_demand(bodies, &candidates.directions(), &all, overlap);
        if bodies.len() <= MOST_AT_ONCE {
            matrix.complete(watch)?;
        }
        Ok(Findings {
            suggestions: suggestions(bodies, &start),
            up: self.options.up.map_or(bodies.assembly().up(), DVec3::normalize),
            bodies,
            start,
            liaisons,
            candidates,
            matrix,
            more: Vec::new(),
            plan: Plan::default(),
            times: Times::default(),
            maps: Vec::new(),
        })
    }
}
