//! The experiments of the paper, run anew on this machine.
//!
//! *The paper* is Mirolo, Carpin and Pagello, "Incremental Convex Minimization for Computing
//! Collision Translations of Convex Polyhedra", IEEE Transactions on Robotics 23(3), 2007. Its
//! section V reports nine figures (11 to 19) and a table; each is an [`Experiment`] here.
//!
//! Data flow: [`claims`] (what is to be tested) and [`plan`] (how much) -> `shapes`, `shadow`,
//! `settings` (what on) -> `experiments` (what is measured, by `solvers`) -> [`statistics`]
//! (intervals) -> [`finding`] (figures, tables, claims with verdicts)
//! -> [`draw`], [`csv`], `claims_json`, [`report`] (what a reader sees). [`run()`] goes all the way and writes the
//! files.

pub mod claims;
mod claims_json;
pub mod csv;
pub mod draw;
mod error;
mod experiments;
pub mod figures;
pub mod finding;
pub mod plan;
pub mod report;
mod run;
pub mod settings;
mod shadow;
pub mod shapes;
mod solvers;
pub mod statistics;

use finding::Finding;
use plan::{Plan, Progress};

pub use error::LabError;
pub use experiments::experiments;
pub use report::Done;
pub use run::{Summary, run};

/// One figure or table of the paper.
#[derive(Debug, Clone, Copy)]
pub struct Experiment {
    /// `"section-3"`, `"figure-11"` ... `"figure-19"`, `"table-1"`, `"beyond"`.
    pub id: &'static str,
    /// What it is about, in a few words.
    pub title: &'static str,
    /// How long a quick and a full run take, in seconds on a machine of 2026, about: to say how much is left.
    pub seconds: [f64; 2],
    /// Runs it.
    pub run: fn(&Plan, &mut dyn Progress) -> Finding,
}

impl Experiment {
    /// How long it takes, in seconds, about.
    pub fn expected(&self, plan: &Plan) -> f64 {
        match plan.scale {
            plan::Scale::Tiny => 1.0,
            plan::Scale::Quick => self.seconds[0],
            plan::Scale::Full => self.seconds[1],
        }
    }

    /// The id for people: `Figure 12`.
    pub fn name(&self) -> String {
        let name = self.id.replacen("figure-", "Figure ", 1).replacen("table-", "Table ", 1);
        name.replacen("section-3", "Section III", 1).replacen("beyond", "Beyond the paper", 1)
    }
}
