//! The command lines of `colltrans assembly` and `colltrans audit`.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::Args;
use colltrans::glam::DVec3;
use colltrans_assembly::plan::PlanOptions;
use colltrans_assembly_io::read::Split;

use super::directions::WorkArguments;
use super::values::{direction, factor, length, output_file, removed_legs, samples, threads};

#[derive(Debug, Args)]
#[expect(clippy::struct_excessive_bools, reason = "each is a flag of its own")]
pub(crate) struct AssemblyArguments {
    /// A folder of meshes, a manifest, a .urdf, .glb, .gltf, .3mf or .step file, or one mesh
    pub(crate) source: PathBuf,
    /// Folder for report.html, instructions.html, bill.csv, disassembly.glb, assembly.json, tables, maps and proofs
    #[arg(short, long, value_name = "DIR")]
    pub(crate) output: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    pub(crate) json: bool,
    /// List each defect and each overlap of the parts, instead of one line for each kind
    #[arg(long, hide_short_help = true)]
    pub(crate) notes: bool,
    /// Permitted overlap: chord errors of curved fits, press fits [default: precision of the files]
    #[arg(long, value_name = "L", allow_hyphen_values = true, value_parser = length)]
    pub(crate) tolerance: Option<f64>,
    /// Minimum gap of parts that pass each other, in all directions
    #[arg(long, alias = "margin", value_name = "L", allow_hyphen_values = true, value_parser = length, conflicts_with = "tolerance")]
    pub(crate) keep_apart: Option<f64>,
    /// Direction to try first: three numbers or an axis; may be repeated
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = direction)]
    pub(crate) direction: Vec<DVec3>,
    /// Try only the given directions
    #[arg(long, hide_short_help = true)]
    pub(crate) only: bool,
    /// Free travel in the directions of a file, one per line; `-` for standard input
    #[arg(long, value_name = "FILE", hide_short_help = true)]
    pub(crate) directions: Option<PathBuf>,
    /// Free travel in at least N directions on the sphere; the plan tries them too
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = samples, hide_short_help = true)]
    pub(crate) samples: Option<usize>,
    /// Map the free travel of a part over the sphere; A,B or A* is one group
    #[arg(long, value_name = "PART")]
    pub(crate) map: Vec<String>,
    /// Compute all directions in which a part or group can leave, with a proof
    #[arg(long, value_name = "PART", conflicts_with_all = ["keep_apart", "ignore_overlaps"])]
    pub(crate) free: Vec<String>,
    #[command(flatten)]
    pub(crate) work: WorkArguments,
    /// Work of each search for a step of several moves or a turn; 0 for single moves only
    #[arg(long, value_name = "N", default_value_t = PlanOptions::DEFAULT_EFFORT)]
    pub(crate) effort: u32,
    /// Removed: `--effort` replaces it
    #[arg(long, value_name = "N", hide = true, value_parser = removed_legs)]
    pub(crate) legs: Option<u32>,
    /// Do not try to prove that no straight motion separates interlocked groups
    #[arg(long, hide_short_help = true)]
    pub(crate) no_proofs: bool,
    /// Direction of gravity: lifting is preferred [default: -y for glTF, else -z]
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = direction, hide_short_help = true)]
    pub(crate) gravity: Option<DVec3>,
    /// Handling times in seconds, as JSON; replaces entries of the table
    #[arg(long, value_name = "FILE.json", hide_short_help = true)]
    pub(crate) times: Option<PathBuf>,
    /// Density in kg/m3 of all parts, of a material or of a part
    #[arg(long, value_name = "[NAME=]RHO", allow_hyphen_values = true, hide_short_help = true)]
    pub(crate) density: Vec<String>,
    /// Number of threads [default: all cores]; the answer is the same
    #[arg(long, value_name = "N", value_parser = threads, hide_short_help = true)]
    pub(crate) threads: Option<NonZeroUsize>,
    #[command(flatten)]
    pub(crate) asked: ConstraintArguments,
    /// If parts stay interlocked: plan again with the suggested roles and tolerances
    #[arg(long, help_heading = CONTACTS, conflicts_with = "keep_apart")]
    pub(crate) auto: bool,
    #[command(flatten)]
    pub(crate) roles: RoleArguments,
    /// Let parts that overlap at the start pass; later contacts block
    #[arg(long, help_heading = CONTACTS, hide_short_help = true)]
    pub(crate) ignore_overlaps: bool,
    #[command(flatten)]
    pub(crate) input: InputArguments,
}

/// Arguments of `colltrans audit`.
#[derive(Debug, Args)]
pub(crate) struct AuditArguments {
    /// A folder of meshes, a manifest, a .urdf, .glb, .gltf, .3mf or .step file, or one mesh
    pub(crate) source: PathBuf,
    /// Required clearance of all pairs, or between two parts or groups; may be repeated [default: 0]
    #[arg(long, value_name = "L|A,B=L", allow_hyphen_values = true, value_parser = clearance)]
    pub(crate) within: Vec<Clearance>,
    /// Let parts touch: list only interferences, and gaps below the clearance
    #[arg(long)]
    pub(crate) allow_contact: bool,
    /// Print one JSON object
    #[arg(long)]
    pub(crate) json: bool,
    /// Write all pairs as a table
    #[arg(long, value_name = "OUT.csv", value_parser = output_file)]
    pub(crate) csv: Option<PathBuf>,
    /// Write a report: a list of all pairs, with sections and a view of each
    #[arg(long, value_name = "OUT.html", value_parser = output_file)]
    pub(crate) report: Option<PathBuf>,
    /// Write the violations as issues in the BIM Collaboration Format, with pictures
    ///
    /// Their time of creation is now, or `SOURCE_DATE_EPOCH` (seconds since 1970).
    #[arg(long, value_name = "OUT.bcf", value_parser = output_file)]
    pub(crate) bcf: Option<PathBuf>,
    /// Write proofs of all pairs to a new or empty folder, for `colltrans verify`
    #[arg(long, value_name = "FOLDER")]
    pub(crate) proofs: Option<PathBuf>,
    /// List at most N pairs as text
    #[arg(long, value_name = "N")]
    pub(crate) limit: Option<usize>,
    /// Permitted overlap, up to 32 times as deep at sharp tips [default: precision of the files]
    #[arg(long, value_name = "L", allow_hyphen_values = true, value_parser = length)]
    pub(crate) tolerance: Option<f64>,
    /// Number of threads [default: all cores]; the answer is the same
    #[arg(long, value_name = "N", value_parser = threads, hide_short_help = true)]
    pub(crate) threads: Option<NonZeroUsize>,
    #[command(flatten)]
    pub(crate) roles: RoleArguments,
    #[command(flatten)]
    pub(crate) input: InputArguments,
}

/// A required clearance of the command line.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Clearance {
    /// Patterns of two groups of parts; `None` for all pairs.
    pub(crate) groups: Option<[String; 2]>,
    pub(crate) length: f64,
}

/// Parses a clearance: `L`, or `A,B=L` for the pairs of two groups. Names may contain `=`.
fn clearance(text: &str) -> Result<Clearance, String> {
    let Some((names, value)) = text.rsplit_once('=') else {
        return Ok(Clearance { groups: None, length: length(text)? });
    };
    let groups = names.split_once(',').map(|(a, b)| [a, b].map(|name| name.trim().to_owned()));
    let groups = groups.filter(|names| names.iter().all(|name| !name.is_empty()));
    let groups = groups.ok_or("expected a length, or two names and a length, A,B=L")?;
    Ok(Clearance { groups: Some(groups), length: length(value)? })
}

/// How sources of assemblies are read.
#[derive(Debug, Args)]
#[command(next_help_heading = INPUT)]
#[expect(clippy::struct_excessive_bools, reason = "each is a flag of its own")]
pub(crate) struct InputArguments {
    /// STEP: distance of facets from the surfaces, about, in millimetres [default: 0.05]
    #[arg(long, value_name = "L", allow_hyphen_values = true, value_parser = factor, hide_short_help = true)]
    pub(crate) chord: Option<f64>,
    /// Parts of a file with several bodies: auto, never, names or bodies
    #[arg(
        long,
        value_name = "WHICH",
        default_value = "auto",
        hide_default_value = true,
        hide_short_help = true
    )]
    pub(crate) split: Split,
    /// Factor of a part whose file has another unit
    #[arg(long, value_name = "PART=FACTOR", hide_short_help = true)]
    pub(crate) scale: Vec<String>,
    /// URDF: position of a joint, in radians or metres
    #[arg(long, value_name = "NAME=VALUE", hide_short_help = true)]
    pub(crate) joint: Vec<String>,
    /// URDF: read the visual geometry instead of the collision geometry
    #[arg(long, hide_short_help = true)]
    pub(crate) visual: bool,
    /// URDF: folder in which `package://` references are searched
    #[arg(long, value_name = "DIR", hide_short_help = true)]
    pub(crate) package: Vec<PathBuf>,
    /// Read referenced files outside of the folders; only for trusted sources
    #[arg(long, hide_short_help = true)]
    pub(crate) allow_outside: bool,
    /// Skip missing meshes and what a manifest says about them, with a note
    #[arg(long, hide_short_help = true)]
    pub(crate) skip_missing: bool,
    /// Reject meshes that need repair (doubled or reversed facets, near vertices)
    #[arg(long, hide_short_help = true)]
    pub(crate) as_is: bool,
}

const CONTACTS: &str = "Contacts of pairs (A* stands for all names that begin with A)";
const INPUT: &str = "Input";

/// Constraints of the plan.
#[derive(Debug, Args)]
#[command(
    next_help_heading = "Constraints of the plan (PART* stands for all names that begin with PART)"
)]
pub(crate) struct ConstraintArguments {
    /// A part that never moves
    #[arg(long, value_name = "PART")]
    pub(crate) fixed: Vec<String>,
    /// Remove only these parts, and as few others as possible
    #[arg(long, value_name = "PART,...", value_delimiter = ',')]
    pub(crate) remove: Vec<String>,
    /// B does not leave while A is present
    #[arg(long, value_name = "A,B", hide_short_help = true)]
    pub(crate) before: Vec<String>,
    /// A does not leave while B is present
    #[arg(long, value_name = "A,B", hide_short_help = true)]
    pub(crate) after: Vec<String>,
    /// Parts that leave together and stay together
    #[arg(long, value_name = "A,B,...", hide_short_help = true)]
    pub(crate) together: Vec<String>,
    /// Parts that leave together and are then taken apart
    #[arg(long, value_name = "NAME=A,B,...", hide_short_help = true)]
    pub(crate) subassembly: Vec<String>,
    /// Never within 45, or DEGREES, of this direction
    #[arg(long, value_name = "PART=X,Y,Z[@DEGREES]", hide_short_help = true)]
    pub(crate) never: Vec<String>,
}

/// Roles and tolerances of pairs of parts.
#[derive(Debug, Args)]
#[command(next_help_heading = CONTACTS)]
pub(crate) struct RoleArguments {
    /// Press fit: permitted overlap of this pair [default: its overlap at the start]
    #[arg(long, value_name = "A,B[=L]", hide_short_help = true)]
    pub(crate) press: Vec<String>,
    /// One part is soft, a seal or a belt; as --press
    #[arg(long, value_name = "A,B[=L]", hide_short_help = true)]
    pub(crate) soft: Vec<String>,
    /// One part is screwed into the other: it is unscrewed, certified if possible
    #[arg(long, value_name = "A,B[=L]", hide_short_help = true)]
    pub(crate) thread: Vec<String>,
    /// Snap fit: contacts that begin within L of the start do not block
    #[arg(long, value_name = "A,B=L", hide_short_help = true)]
    pub(crate) snap: Vec<String>,
    /// Two parts that leave together and stay together
    #[arg(long, value_name = "A,B", hide_short_help = true)]
    pub(crate) glued: Vec<String>,
    /// Tolerance of one pair, instead of --tolerance
    #[arg(long, visible_alias = "fit", value_name = "A,B=L", hide_short_help = true)]
    pub(crate) pair: Vec<String>,
    /// Two parts whose overlap at the start is ignored; later contacts block
    #[arg(long, value_name = "A,B", hide_short_help = true)]
    pub(crate) ignore: Vec<String>,
    /// Two parts that never block each other
    #[arg(long, value_name = "A,B", hide_short_help = true)]
    pub(crate) ignore_always: Vec<String>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clearances_have_a_length_and_perhaps_two_groups() {
        assert_eq!(clearance("0.5"), Ok(Clearance { groups: None, length: 0.5 }));
        let groups = Some(["pipe*".to_owned(), "a=b".to_owned()]);
        assert_eq!(clearance("pipe*, a=b=50"), Ok(Clearance { groups, length: 50.0 }));
        for bad in ["", "-1", "inf", "nan", "a=1", "a,=1", ",b=1", "a,b=", "a,b=x", "a,b"] {
            assert!(clearance(bad).is_err(), "{bad}");
        }
    }
}
