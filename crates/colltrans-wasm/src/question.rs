//! The questions, as the page writes them.

use serde::Deserialize;

/// One question.
#[derive(Debug, Deserialize)]
#[serde(tag = "do", rename_all = "snake_case", deny_unknown_fields)]
pub(crate) enum Question {
    /// The file that comes with the question becomes a body.
    Load(Load),
    /// When do they meet, and how far can the moving one go?
    Cast(Pair),
    /// Is this proof one?
    Verify {
        /// What it is about.
        #[serde(flatten)]
        pair: Pair,
        /// The proof, as an answer had it.
        proof: Proof,
    },
    /// What does a search do?
    Search(Search),
    /// The collision translation of pairs of sections.
    Levels(Levels),
}

/// Which of the two bodies.
#[derive(Debug, Clone, Copy, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Slot {
    Moving,
    Fixed,
}

/// How a mesh becomes a body.
#[derive(Debug, Clone, Copy, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Take {
    /// It must be convex.
    Convex,
    /// The convex hull of its vertices.
    Hull,
    /// It need not be convex, but closed.
    Solid,
    /// A surface that may be open.
    Open,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Load {
    pub(crate) slot: Slot,
    /// The file's name; its extension tells the format.
    pub(crate) name: String,
    pub(crate) take: Take,
}

/// Two placed bodies and a direction. Poses are `x,y,z,qx,qy,qz,qw`.
#[derive(Debug, Clone, Deserialize)]
pub(crate) struct Pair {
    pub(crate) moving_pose: [f64; 7],
    pub(crate) fixed_pose: [f64; 7],
    pub(crate) direction: [f64; 3],
    /// Between convex bodies: sideways overlap that counts as grazing.
    #[serde(default)]
    pub(crate) graze: f64,
    /// Between convex bodies.
    #[serde(default)]
    pub(crate) solver: Solver,
    /// Between solids: by how much they are shrunk; what the files' precision asks for by default.
    #[serde(default)]
    pub(crate) tolerance: Option<f64>,
    /// Between solids: facets that cross at the start do not block.
    #[serde(default)]
    pub(crate) ignore_overlaps: bool,
}

#[derive(Debug, Clone, Copy, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Solver {
    #[default]
    Auto,
    Cta,
    Portal,
}

/// A proof to check: of a contact or of a separation.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub(crate) enum Proof {
    Contact(Certificate),
    Separation { normal: [f64; 3], margin: f64 },
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Certificate {
    pub(crate) normal: [f64; 3],
    pub(crate) lower: f64,
    /// Infinite where there is none.
    #[serde(default)]
    pub(crate) upper: Option<f64>,
    pub(crate) pairs: [[u32; 2]; 3],
    pub(crate) weights: [f64; 3],
    pub(crate) tolerance: f64,
}

/// A search to look at.
#[derive(Debug, Deserialize)]
pub(crate) struct Search {
    #[serde(flatten)]
    pub(crate) pair: Pair,
    /// The minimisation starts at the centre of all levels, as in the paper, and ends when its bounds
    /// are this close, as a share of the bodies' extent; else as the library does by default.
    #[serde(default)]
    pub(crate) from_center: Option<f64>,
    /// A query asked before, whose answer a tracker starts from.
    #[serde(default)]
    pub(crate) after: Option<Before>,
}

/// Where the bodies were at the query before.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Before {
    pub(crate) moving_pose: [f64; 7],
    pub(crate) fixed_pose: [f64; 7],
    pub(crate) direction: [f64; 3],
}

/// A grid of pairs of levels.
#[derive(Debug, Deserialize)]
pub(crate) struct Levels {
    #[serde(flatten)]
    pub(crate) pair: Pair,
    /// Section axes in the world.
    pub(crate) axes: [[f64; 3]; 2],
    /// Levels of the moving body's sections, each in its own frame.
    pub(crate) moving: Vec<f64>,
    /// Those of the fixed body.
    pub(crate) fixed: Vec<f64>,
}
