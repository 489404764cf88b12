//! Errors of assemblies.

use colltrans::QueryError;
use colltrans::removal::directions::FreeError;
use colltrans_mesh::body::BodyError;
use thiserror::Error;

/// Error of an assembly, or of a query about it.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum AssemblyError {
    /// The surface of a part cannot be used as a solid.
    #[error("part {part}: {source}")]
    Part {
        /// Name of the part.
        part: String,
        /// Reason.
        source: BodyError,
    },
    /// Two parts have the same name.
    #[error("duplicate part name {name}; part names must be unique")]
    DuplicateName {
        /// The name.
        name: String,
    },
    /// The name of a part or subassembly is empty.
    #[error("a part or subassembly has an empty name; names must not be empty")]
    EmptyName,
    /// A pair consists of one part twice.
    #[error("pair {name},{name} names the same part twice; a pair needs two different parts")]
    SamePart {
        /// The part's name.
        name: String,
    },
    /// No part has this name.
    #[error("unknown part {name}{}", similar_name_hint(near.as_deref()))]
    UnknownPart {
        /// The name.
        name: String,
        /// The existing name with the longest common prefix; `None` if no name shares a first letter.
        near: Option<String>,
    },
    /// Order constraints form a cycle.
    #[error("cyclic order constraints: {}; remove one of these constraints", names.join(", "))]
    CyclicOrder {
        /// Names of the parts of the cycle.
        names: Vec<String>,
    },
    /// Two subassemblies share parts, and neither contains the other.
    #[error("subassemblies {} and {} overlap; they must be disjoint, or one must contain the other", names[0], names[1])]
    OverlappingSubassemblies {
        /// Names of the subassemblies; without a name, the names of their parts.
        names: [String; 2],
    },
    /// A group has fewer than two parts.
    #[error("{what} needs at least two parts; {count} given")]
    TooFew {
        /// Kind of the group.
        what: &'static str,
        /// Number of parts given.
        count: usize,
    },
    /// None or all of the parts are to be removed.
    #[error("cannot remove {count} of {of} parts; give at least one part, and fewer than all")]
    InvalidRemoval {
        /// Number of parts given.
        count: usize,
        /// Number of parts of the assembly.
        of: usize,
    },
    /// A fixed part is to be removed.
    #[error("part {name} is both fixed and to be removed; drop one of the two options")]
    FixedAndRemoved {
        /// Name of the part.
        name: String,
    },
    /// A pair is given two different roles.
    #[error("the pair {},{} has contradicting roles {} and {}; give one of them", names[0], names[1], roles[0], roles[1])]
    ContradictingRoles {
        /// Names of the parts.
        names: [String; 2],
        /// Names of the roles.
        roles: [&'static str; 2],
    },
    /// A pair has neither a role nor a tolerance.
    #[error("the entry for pair {},{} has neither a role nor a tolerance; give one of them", names[0], names[1])]
    NoFit {
        /// Names of the parts.
        names: [String; 2],
    },
    /// A snap fit has no tolerance.
    #[error("the snap fit of {} and {} has no tolerance; give the deflection as a tolerance", names[0], names[1])]
    NoTolerance {
        /// Names of the parts.
        names: [String; 2],
    },
    /// An angle is out of range.
    #[error("angle of {degrees} degrees is out of range; accepted: at least 0 and less than 180")]
    InvalidAngle {
        /// The given angle in degrees.
        degrees: f64,
    },
    /// A length or factor is negative, not finite or too large.
    #[error("invalid {what} {value:?}; accepted: finite, not negative, below 1.6e60")]
    InvalidValue {
        /// Purpose of the value.
        what: &'static str,
        /// The given value.
        value: f64,
    },
    /// A direction is zero, not finite or out of range.
    #[error(
        "direction {direction:?} is zero, not finite or out of range; give a finite vector that is not zero"
    )]
    InvalidDirection {
        /// The given direction.
        direction: [f64; 3],
    },
    /// A limit that bounds the memory is exceeded.
    #[error("more than {most} {what}; split the assembly into smaller groups of parts")]
    TooMany {
        /// The counted objects.
        what: &'static str,
        /// Maximum number.
        most: usize,
    },
    /// Free directions are requested of two parts that cannot be answered exactly, for example because they
    /// overlap.
    #[error("cannot compute the free directions of {a} and {b}: {why}")]
    DirectionsUnavailable {
        /// Name of a part of the moving group.
        a: String,
        /// Name of one of the other parts.
        b: String,
        /// Reason.
        why: &'static str,
    },
    /// A query of two parts has no answer.
    #[error("{a} and {b}: {source}")]
    Query {
        /// Name of the first part.
        a: String,
        /// Name of the second part.
        b: String,
        /// Reason.
        source: QueryError,
    },
    /// The search for free directions failed.
    #[error(transparent)]
    Free(FreeError),
    /// The caller cancelled the run.
    #[error("cancelled")]
    Cancelled,
    /// A step of the plan failed when it was replayed: a defect of the program.
    #[error("internal error: a step of the plan fails its check: {facts}; please report this")]
    Replay {
        /// Parts and direction of the step.
        facts: String,
    },
}

/// Returns `; did you mean NAME?`, or an empty text without a similar name.
fn similar_name_hint(near: Option<&str>) -> String {
    near.map_or_else(String::new, |name| format!("; did you mean {name}?"))
}
