//! What two parts are to each other whose contact is not like the others: pressed, screwed, soft, snapped or glued.
//!
//! A pair has bodies of its own, which are asked of each other and of nobody else; so what a pair tolerates lets nothing
//! else pass, and its later contacts count like all others. What is tolerated is:
//!
//! - a *tolerance* `L`: both are shrunk by `L / 2`, as of all parts by the general one. *Press* and *soft* are words for why;
//!   without a length it is a little more than the overlap is deep;
//! - a *thread*: the screw is taken as its core, what of it lies on the thread is moved inwards up to where the other one
//!   begins ([`threads`](crate::threads)). So it may be pulled out of what it is screwed into; how it is turned out, and
//!   whether that is proven, a step of a plan says by itself ([`Turn`](crate::plan::Turn));
//! - a *snap* by `L`: contacts that begin before the part has gone by `L` are let pass, as it bends; those that begin later
//!   count;
//! - *glued*: the two leave as one, and are not taken apart.

use crate::digits::short;

/// What two parts are to each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// They overlap on purpose, by a press fit.
    Press,
    /// One is screwed into the other.
    Thread,
    /// One is soft: a seal, a belt.
    Soft,
    /// One snaps over the other.
    Snap,
    /// They stay together.
    Glued,
}

impl Role {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Press, Self::Thread, Self::Soft, Self::Snap, Self::Glued];

    /// As it is written.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Press => "press",
            Self::Thread => "thread",
            Self::Soft => "soft",
            Self::Snap => "snap",
            Self::Glued => "glued",
        }
    }

    /// The role with a name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|role| role.name() == name)
    }
}

/// What is said of a pair.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PairFit {
    /// What the two are to each other, if that is said.
    pub role: Option<Role>,
    /// A tolerance of their own.
    pub tolerance: Option<f64>,
}

/// How a pair is asked, if it has a fit of its own.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Tolerated {
    /// Both shrunk by half of this length.
    Within(f64),
    /// One taken as the core of its thread, of so large a radius; the other one as it is.
    Core(f64),
    /// Contacts that begin within this length from the start let pass.
    Bent(f64),
    /// What crosses at the start let pass: no tolerance ends their overlap, or no thread was found.
    Crossing,
    /// They leave as one.
    AsOne,
}

impl Tolerated {
    /// What is let pass of two parts, in words.
    pub fn words(&self, role: Option<Role>) -> String {
        let name = role.map_or("", Role::name);
        match (self, role) {
            (Self::Within(length), Some(Role::Press)) => format!("press fit, tolerance {length}"),
            (Self::Within(length), Some(_)) => format!("{name}, tolerance {length}"),
            (Self::Within(length), None) => format!("tolerance {length}"),
            (Self::Core(radius), _) => {
                format!("thread, the screw taken as its core of radius {}", short(*radius))
            }
            (Self::Bent(length), _) => format!("snap, contacts within {length} let pass"),
            (Self::Crossing, _) => format!("{name}, what crosses at the start let pass"),
            (Self::AsOne, _) => "glued".into(),
        }
    }
}
