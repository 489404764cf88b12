//! The output of findings: pictures, CSV, the report, and the folder of a run.

mod made_up;
mod pictures;
mod report;
mod runs;
mod xml;
