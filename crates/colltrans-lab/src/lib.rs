//! The experiments of the paper, run anew on this machine.
//!
//! *The paper* is Mirolo, Carpin and Pagello, "Incremental Convex Minimization for Computing
//! Collision Translations of Convex Polyhedra", IEEE Transactions on Robotics 23(3), 2007. Its
//! section V reports nine figures (11 to 19) and a table; each is an [`Experiment`] here.
//!
//! The data's way: [`plan`] (how much) -> `shapes`, `settings` (what on) -> `experiments` (what is
//! measured, by `contestants` and `timing`) -> [`finding`] (figures, tables, claims with verdicts)
//! -> `draw`, `csv`, `report` (what a reader sees).

mod contestants;
mod experiments;
pub mod finding;
pub mod plan;
mod random;
mod settings;
mod shapes;
mod timing;

use finding::Finding;
use plan::{Plan, Progress};

pub use experiments::experiments;

/// One figure or table of the paper.
#[derive(Debug, Clone, Copy)]
pub struct Experiment {
    /// `"figure-11"` ... `"figure-19"`, `"table-1"`.
    pub id: &'static str,
    /// What it is about, in a few words.
    pub title: &'static str,
    /// Runs it.
    pub run: fn(&Plan, &mut dyn Progress) -> Finding,
}
