//! What a query answers: every case has a name and carries its proof.

use glam::DVec3;

use crate::certificate::{Certificate, Separation};
use crate::polyhedron::ConvexPolyhedron;

/// The answer of [`cast`](crate::cast): do the bodies meet along the direction, and where.
///
/// Told apart by the bodies' shadows (projections along the direction): they overlap by more than
/// the graze tolerance, by no more than it, or not at all.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Outcome {
    /// The moving body meets the fixed one at some translation (which may be negative).
    Contact(Contact),
    /// The shadows along the direction overlap sideways by no more than the graze tolerance:
    /// the bodies slide along each other.
    Grazing(Grazing),
    /// The bodies never meet along the direction, however far one moves, forwards or backwards.
    Separated(Separated),
}

impl Outcome {
    /// The work done for it.
    pub fn steps(&self) -> Steps {
        match self {
            Self::Contact(contact) | Self::Grazing(Grazing { contact, .. }) => contact.steps,
            Self::Separated(separated) => separated.steps,
        }
    }
}

/// Where the bodies first meet along the direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// The collision translation in multiples of the direction (a length if the direction is a
    /// unit vector): the smallest `t` at which the moving body, moved by `t * direction`, meets the
    /// fixed one. Negative: the bodies overlap now, or the contact lies behind. It is the
    /// certificate's upper bound.
    pub translation: f64,
    /// Unit contact normal in the world, from the moving body to the fixed one;
    /// `normal . direction > 0`. Where corners meet, or parallel edges, it is one of several.
    pub normal: DVec3,
    /// Witness point on the moving body, in the world, at its *start* pose.
    pub point_on_moving: DVec3,
    /// Witness point on the fixed body, in the world: the contact point. It is
    /// `point_on_moving + translation * direction` up to rounding. Where an edge or a face lies on
    /// the other body, it is one of many.
    pub point_on_fixed: DVec3,
    /// The part of the moving body that lies in the contact plane, to within rounding error.
    pub moving_feature: Feature,
    /// The part of the fixed body that lies in the contact plane, to within rounding error.
    pub fixed_feature: Feature,
    /// Lower and upper bound with their proofs.
    pub certificate: Certificate,
    /// The solver asked for (never `Auto`); what the search began with is [`Steps::path`].
    pub solver: Solver,
    /// Work done.
    pub steps: Steps,
}

/// The bodies slide along each other: their shadows overlap by no more than the graze tolerance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grazing {
    /// Unit vector in the world, orthogonal to the direction, from the moving body's shadow to the
    /// fixed one's.
    pub separating_direction: DVec3,
    /// How far the shadows overlap along `separating_direction`, in world units: at most the graze
    /// tolerance; negative when they miss each other by less than rounding error can tell.
    pub overlap: f64,
    /// The contact that results if the overlap is taken for real.
    pub contact: Contact,
}

/// The bodies never meet along the direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Separated {
    /// The proof: a unit normal orthogonal to the direction, and the margin along it.
    pub certificate: Separation,
    /// The solver that found it.
    pub solver: Solver,
    /// Work done.
    pub steps: Steps,
}

/// A vertex, an edge or a face of a [`ConvexPolyhedron`], by its own indices.
///
/// [`ConvexPolyhedron::input_indices`] leads from there to the points or mesh vertices it was made
/// from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Feature {
    /// A vertex.
    Vertex(u32),
    /// An edge, by its two vertices.
    Edge([u32; 2]),
    /// A face; its vertices are [`ConvexPolyhedron::face_vertices`].
    Face(u32),
}

impl Feature {
    /// `"vertex"`, `"edge"` or `"face"`.
    pub fn kind(self) -> &'static str {
        match self {
            Self::Vertex(_) => "vertex",
            Self::Edge(_) => "edge",
            Self::Face(_) => "face",
        }
    }

    /// The vertices of the feature, as indices into [`ConvexPolyhedron::vertices`] of `body`.
    ///
    /// # Panics
    /// If the feature is not one of `body`.
    pub fn vertices(self, body: &ConvexPolyhedron) -> Vec<u32> {
        match self {
            Self::Vertex(v) => vec![v],
            Self::Edge(ends) => ends.to_vec(),
            Self::Face(face) => body.face_vertices(face).collect(),
        }
    }
}

/// How the search is narrowed. The answer, its certificate and its accuracy are the same.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Solver {
    /// Whichever was measured to be fastest: at present portal refinement, for all bodies.
    #[default]
    Auto,
    /// The collision translation algorithm (the paper, section III): convex minimisation over pairs
    /// of planar sections, then portal refinement from the normal found. Bodies of lower dimension
    /// have no sections to speak of: portal refinement does their work alone.
    Cta,
    /// Portal refinement from scratch, starting from what the contact of two ellipsoids would be.
    Portal,
}

/// Work done for one answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Steps {
    /// Planar problems solved (minimisation steps of the collision translation algorithm).
    pub planar_problems: u32,
    /// Supporting planes of the Minkowski difference computed (one support point on each body).
    pub supports: u32,
    /// Portals visited.
    pub pivots: u32,
    /// What the search began with.
    pub path: Path,
}

impl Steps {
    /// Counts another cast in; of both paths the longer one stands.
    pub(crate) fn add(&mut self, other: &Self) {
        self.planar_problems += other.planar_problems;
        self.supports += other.supports;
        self.pivots += other.pivots;
        self.path = self.path.max(other.path);
    }
}

/// What the search for an answer began with, from the least work to the most.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub enum Path {
    /// The last answer's contact features or separating direction ([`Tracker`](crate::Tracker)
    /// only).
    Features,
    /// The region around the last answer ([`Tracker`](crate::Tracker) only).
    Region,
    /// Nothing but the bodies.
    #[default]
    Scratch,
}

/// The answer of [`contact_range`](crate::contact_range): all translations at which the bodies
/// meet, an interval, with the contact at either end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ContactRange {
    /// The bodies meet exactly for the translations in [`ContactRange::interval`].
    Contact {
        /// First contact along the direction.
        first: Contact,
        /// Last contact along the direction: the contact of the cast along the *opposite*
        /// direction, as that cast gives it (its certificate is for that direction, and its
        /// translation counts in multiples of it).
        last: Contact,
    },
    /// The shadows overlap by no more than the graze tolerance.
    Grazing {
        /// First contact along the direction.
        first: Grazing,
        /// Last contact, of the cast along the opposite direction.
        last: Grazing,
    },
    /// The bodies never meet.
    Separated(Separated),
}

impl ContactRange {
    /// `[enter, exit]` in multiples of the direction, `None` if the bodies never meet.
    pub fn interval(&self) -> Option<[f64; 2]> {
        let (first, last) = match self {
            Self::Contact { first, last } => (first, last),
            Self::Grazing { first, last } => (&first.contact, &last.contact),
            Self::Separated(_) => return None,
        };
        // Where both ends are one, rounding may have turned them round.
        let (enter, exit) = (first.translation, -last.translation);
        Some([enter.min(exit), enter.max(exit)])
    }
}

/// The answer of [`clearance`](crate::clearance): how far the moving body can move *from where it
/// is* along the direction.
#[derive(Debug, Clone, Copy, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "a query allocates nothing, so nothing is boxed")]
pub enum Clearance {
    /// As far as it likes: the bodies never meet, or only slide, or the contact lies behind.
    Free,
    /// Until it touches.
    Blocked {
        /// How far, in multiples of the direction; never negative.
        distance: f64,
        /// The contact that stops it.
        contact: Contact,
    },
    /// The bodies overlap now, by more than rounding error.
    Overlapping {
        /// The translations at which they do: `[enter, exit]`, with 0 inside.
        range: [f64; 2],
    },
}
