//! What a reader gets from a finding: pictures, CSV, the report, and the folder of a run.

mod made_up;
mod pictures;
mod report;
mod runs;
mod xml;
