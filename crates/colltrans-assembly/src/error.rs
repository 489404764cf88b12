//! Errors of assemblies, with the file and the place.

use std::path::PathBuf;

use colltrans::free::FreeError;
use colltrans_mesh::body::Refused;
use thiserror::Error;

/// Why an assembly could not be read.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ReadError {
    /// A file or folder cannot be opened.
    #[error("{}: cannot be read: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// Neither a folder nor a kind of file that is known.
    #[error(
        "{}: neither a folder of meshes nor a known file: a manifest (.toml, .json), .urdf, .glb, \
         .gltf, .3mf, or a mesh",
        path.display()
    )]
    UnknownSource {
        /// What was given.
        path: PathBuf,
    },
    /// A STEP file, which has to be converted first.
    #[error(
        "{}: STEP files are converted to GLB first, which `colltrans assembly` and Python's `Assembly.read` do",
        path.display()
    )]
    Step {
        /// The file.
        path: PathBuf,
    },
    /// The contents are not what the format prescribes.
    #[error("{}: {place}: {reason}", path.display())]
    Contents {
        /// The file.
        path: PathBuf,
        /// Where in it.
        place: String,
        /// What is wrong.
        reason: String,
    },
    /// It names a file that it must not.
    #[error(
        "{}: {name} is named by an absolute path or lies outside of the folder that names it, and is \
         not read",
        path.display()
    )]
    Outside {
        /// The source.
        path: PathBuf,
        /// The file, as it is named, or where it is.
        name: String,
    },
    /// Nothing in it is a part.
    #[error("{}: holds no parts: {holds}", path.display())]
    NoParts {
        /// The source.
        path: PathBuf,
        /// What it holds instead.
        holds: String,
    },
    /// Files that are named and do not exist.
    #[error(
        "{}: {} of the meshes it names cannot be found, the first is {}; give the roots of \
         packages, or skip what is missing",
        path.display(), missing.len(), missing[0]
    )]
    Missing {
        /// The file that names them.
        path: PathBuf,
        /// Their names, as written there.
        missing: Vec<String>,
    },
    /// A mesh cannot be read.
    #[error(transparent)]
    Mesh(#[from] colltrans_mesh::Error),
    /// The parts do not make an assembly.
    #[error("{}: {source}", path.display())]
    Assembly {
        /// Where they come from.
        path: PathBuf,
        /// What is wrong.
        source: AssemblyError,
    },
}

impl ReadError {
    /// Checks whether the file does not exist.
    pub fn is_missing_file(&self) -> bool {
        matches!(self, Self::Io { source, .. } if source.kind() == std::io::ErrorKind::NotFound)
    }
}

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
