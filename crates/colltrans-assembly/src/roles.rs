//! Roles of pairs whose contact differs from the others: press fits, threads, soft parts, snap fits and glued parts.
//!
//! A pair with a tolerance of its own or a thread has bodies of its own, which are used only for this pair. A role
//! affects no other pair. Later contacts of the pair still count, except between glued parts. A pair tolerates one of
//! these, or else facets that cross at the start ([`PairTolerance::Crossing`]):
//!
//! - a *tolerance* `L`: both parts are shrunk by `L / 2`, like all parts with the general tolerance. *Press* and
//!   *soft* are reasons for one. Without a length the tolerance is slightly more than the depth of the overlap;
//! - a *thread*: the screw is replaced by its core. Vertices of its thread move inwards to where the other part
//!   begins ([`threads`](crate::threads)), so that the screw can be pulled out. The step of a plan contains the
//!   unscrewing motion and its proof ([`Turn`](crate::plan::Turn));
//! - a *snap* fit of length `L`: contacts that begin within a travel of `L` are tolerated, because the part deflects;
//! - *glued* parts: they leave as one and are not taken apart.

use crate::digits::short_number;

/// The role of a pair.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// A press fit: the parts overlap on purpose.
    Press,
    /// A thread: one part is screwed into the other.
    Thread,
    /// A soft part, for example a seal or a belt.
    Soft,
    /// A snap fit.
    Snap,
    /// Glued parts, which stay together.
    Glued,
}

impl Role {
    /// All roles.
    pub const ALL: [Self; 5] = [Self::Press, Self::Thread, Self::Soft, Self::Snap, Self::Glued];

    /// Returns the name of the role in files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Press => "press",
            Self::Thread => "thread",
            Self::Soft => "soft",
            Self::Snap => "snap",
            Self::Glued => "glued",
        }
    }

    /// Returns the role with a name, or `None` if there is none.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|role| role.name() == name)
    }
}

/// The fit of a pair as specified by the user.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PairFit {
    /// The role of the pair, if specified.
    pub role: Option<Role>,
    /// The tolerance of the pair, if specified.
    pub tolerance: Option<f64>,
}

/// The contacts that a pair with a fit of its own tolerates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PairTolerance {
    /// Both parts are shrunk by half of this length.
    Within(f64),
    /// One part is replaced by the core of its thread, with this radius. The other is unchanged.
    Core(f64),
    /// Contacts that begin within this travel are tolerated.
    Snap(f64),
    /// Facets that cross at the start are tolerated. This applies if every tolerance that removes the overlap would
    /// destroy a part, or if the role is a thread and no thread was found.
    Crossing,
    /// The parts leave as one.
    Glued,
}

impl PairTolerance {
    /// Returns a description of the tolerated contacts.
    pub fn describe(&self, role: Option<Role>) -> String {
        let name = role.map_or("", Role::name);
        match (self, role) {
            (Self::Within(length), Some(Role::Press)) => format!("press fit, tolerance {length}"),
            (Self::Within(length), Some(_)) => format!("{name}, tolerance {length}"),
            (Self::Within(length), None) => format!("tolerance {length}"),
            (Self::Core(radius), _) => {
                format!("thread, the screw taken as its core of radius {}", short_number(*radius))
            }
            (Self::Snap(length), _) => format!("snap, contacts within {length} tolerated"),
            (Self::Crossing, _) => format!("{name}, crossings at the start tolerated"),
            (Self::Glued, _) => "glued".into(),
        }
    }
}
