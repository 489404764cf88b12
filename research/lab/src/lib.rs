//! The experiments of the paper, repeated on this machine.
//!
//! *The paper* is Mirolo, Carpin and Pagello, "Incremental Convex Minimization for Computing Collision
//! Translations of Convex Polyhedra", IEEE Transactions on Robotics 23(3), 2007. Its section V reports nine
//! figures (11 to 19) and a table; each is an [`Experiment`] here.
//!
//! - [`claims`] (hypotheses) and [`plan`] (scale); `shapes`, `shadow`, [`settings`] (test cases).
//! - `experiments` (measurements, by `solvers`), [`counting`] (queries under callgrind), [`statistics`] (intervals), [`finding`] (figures, tables,
//!   verdicts).
//! - [`draw`], [`csv`], `claims_json`, [`report`] (output). [`run()`] performs all stages and writes the
//!   files.

pub mod claims;
mod claims_json;
pub mod counting;
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
mod style;

use finding::Finding;
use plan::{Plan, Progress};

pub use error::LabError;
pub use experiments::experiments;
pub use report::Done;
pub use run::{Summary, run};

/// A figure or table of the paper.
#[derive(Debug, Clone, Copy)]
pub struct Experiment {
    /// Identifier: `"section-3"`, `"figure-11"` ... `"figure-19"`, `"table-1"`, `"beyond"`,
    /// `"casts-2026"`.
    pub id: &'static str,
    /// Topic in a few words.
    pub title: &'static str,
    /// Estimated duration of a quick and a full run, in seconds on a machine of 2026, for the progress
    /// display.
    pub seconds: [f64; 2],
    /// Runs the experiment.
    pub run: fn(&Plan, &mut dyn Progress) -> Finding,
}

impl Experiment {
    /// Returns the estimated duration in seconds.
    pub fn expected(&self, plan: &Plan) -> f64 {
        match plan.scale {
            plan::Scale::Tiny => 1.0,
            plan::Scale::Quick => self.seconds[0],
            plan::Scale::Full => self.seconds[1],
        }
    }

    /// Returns the identifier as text: `Figure 12`.
    pub fn name(&self) -> String {
        let name = self.id.replacen("figure-", "Figure ", 1).replacen("table-", "Table ", 1);
        name.replacen("section-3", "Section III", 1)
            .replacen("beyond", "Beyond the paper", 1)
            .replacen("casts-2026", "Casts, 2026", 1)
    }
}
