//! Data from which the next cast of a tracker starts: the features with which a cast ended.

use glam::DVec3;

use crate::answer::Steps;
use crate::setting::VertexPair;
use crate::solve::nearest::NearestPairs;
use crate::solve::portal::ContactPortal;

/// Result of a cast besides its answer: all that a tracker reads.
///
/// It is separate because an answer that is read before it is returned is copied through memory. This costs a tenth of
/// a coherent query.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct TrackerUpdate {
    /// Start of the next cast.
    pub(crate) start: WarmStart,
    /// Work counts of the answer. `None` if the cast failed.
    pub(crate) steps: Option<Steps>,
}

/// Start of the next cast, from the result of the previous one.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) enum WarmStart {
    /// No earlier result: the cast starts from scratch.
    #[default]
    Nothing,
    /// The bodies met or grazed, and the line passed through this portal.
    Contact(ContactPortal),
    /// The bodies missed each other, or grazed so slightly that their contact was that of widened bodies.
    Apart {
        /// Separating direction, from the moving to the fixed body, in the frames of the moving and of the fixed body.
        normals: [DVec3; 2],
        /// Vertex pair of `M` that is lowest along it.
        pair: VertexPair,
    },
    /// The cast was against the direction, and met. With [`Solver::Cta`](crate::Solver::Cta), the last contact of a
    /// query starts from the first one.
    Opposite {
        /// Normal of this contact, in the frame of the moving body.
        normal: DVec3,
    },
    /// The cast had a minimum gap.
    WithMinGap {
        /// Normal of the plane that bounded the translation (setting frame).
        normal: DVec3,
        /// Vertex pairs at which the bodies were nearest.
        pairs: NearestPairs,
    },
}

impl WarmStart {
    /// Returns the start of the cast against the direction.
    pub(crate) fn opposite(&self) -> Self {
        match self {
            Self::Contact(portal) => Self::Opposite { normal: portal.normals[0] },
            _ => Self::Nothing,
        }
    }
}
