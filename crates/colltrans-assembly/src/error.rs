//! Errors of assemblies, with the file and the place.

use colltrans::free::FreeError;
use colltrans_mesh::body::Refused;
use thiserror::Error;

/// Why something about an assembly cannot be answered.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum AssemblyError {
    /// A part's surface is not one of a solid.
    #[error("part {part}: {source}")]
    Part {
        /// Its name.
        part: String,
        /// What is wrong.
        source: Refused,
    },
    /// Two parts have one name.
    #[error("two parts are named {name}")]
    SameName {
        /// The name.
        name: String,
    },
    /// A part or a subassembly has no name.
    #[error("a part or a subassembly has no name")]
    NoName,
    /// A pair is one part.
    #[error("{name} and {name} are no pair: a part does not block itself")]
    SamePart {
        /// The part's name.
        name: String,
    },
    /// No part has this name.
    #[error("no part is named {name}{}", hint(near.as_deref()))]
    UnknownPart {
        /// The name.
        name: String,
        /// The most similar name that exists.
        near: Option<String>,
    },
    /// Parts of which each would leave before itself.
    #[error("nothing can leave before itself, and that is asked of {}", names.join(", "))]
    Order {
        /// Their names.
        names: Vec<String>,
    },
    /// Two subassemblies share parts, and neither holds the other.
    #[error("{} and {} share parts, and neither holds the other", names[0], names[1])]
    Subassemblies {
        /// What they are called, or their parts.
        names: [String; 2],
    },
    /// Fewer parts than there have to be.
    #[error("{what} takes more parts than {count}")]
    TooFew {
        /// What they were given for.
        what: &'static str,
        /// How many were given.
        count: usize,
    },
    /// None or all of the parts are to be taken out.
    #[error("{count} of {of} parts are to be taken out: some, but not all, can be")]
    Removal {
        /// How many were given.
        count: usize,
        /// Of how many.
        of: usize,
    },
    /// A part that is never moved is to be taken out.
    #[error("{name} is to be taken out, and is fixed")]
    Fixed {
        /// Its name.
        name: String,
    },
    /// Nothing is said of a pair.
    #[error("{} and {} are a pair: give a role or a tolerance", names[0], names[1])]
    NoFit {
        /// The parts.
        names: [String; 2],
    },
    /// A snap of which nobody says how far it bends.
    #[error("{} and {} snap: say by how much, as a tolerance", names[0], names[1])]
    NoTolerance {
        /// The parts.
        names: [String; 2],
    },
    /// An angle that is none.
    #[error("an angle of {degrees} degrees: it must be at least 0 and less than 180")]
    Angle {
        /// As given.
        degrees: f64,
    },
    /// A length that is negative or not finite.
    #[error("{what} {value:?} is not a length: it must be finite, not negative and below 1.6e60")]
    Length {
        /// What it is for.
        what: &'static str,
        /// As given.
        value: f64,
    },
    /// A direction that is zero or not finite.
    #[error("direction {direction:?} is zero, not finite or out of range")]
    Direction {
        /// As given.
        direction: [f64; 3],
    },
    /// More than is looked at: memory goes with the number.
    #[error("more than {most} {what}: that is too many; take fewer parts at a time")]
    TooMany {
        /// What there is too much of.
        what: &'static str,
        /// How many there may be.
        most: usize,
    },
    /// All free directions are told of parts that stop each other as they are.
    #[error("all directions cannot be told of {a} and {b}: {why}")]
    NoDirections {
        /// A part of the group.
        a: String,
        /// One of the others.
        b: String,
        /// What is in the way.
        why: &'static str,
    },
    /// Free directions cannot be told.
    #[error(transparent)]
    Free(FreeError),
    /// The caller asked to stop.
    #[error("cancelled")]
    Cancelled,
    /// A step of the plan did not pass its own check: a bug, with the facts to report.
    #[error("a step of the plan does not hold when it is replayed: {facts}; please report this")]
    Replay {
        /// Which parts and direction.
        facts: String,
    },
}

fn hint(near: Option<&str>) -> String {
    near.map_or_else(String::new, |name| format!("; is it {name}?"))
}
