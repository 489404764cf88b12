//! What a cast leaves to the next one: the features it ended with.

use glam::DVec3;

use crate::answer::Steps;
use crate::setting::VertexPair;
use crate::solve::nearest::NearestPairs;
use crate::solve::portal::ContactPortal;

/// What a cast leaves besides its answer: all that a tracker reads. An answer that is read before it is handed on is
/// moved through memory, which costs a tenth of a coherent query.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Left {
    /// Where the next cast may start.
    pub(crate) start: WarmStart,
    /// The work of the answer, if there is one.
    pub(crate) steps: Option<Steps>,
}

/// Where the next cast may start.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) enum WarmStart {
    /// Nothing yet.
    #[default]
    Nothing,
    /// The bodies met.
    Contact(ContactPortal),
    /// They passed each other, or grazed.
    Apart {
        /// The separating direction, in the frames of the moving and of the fixed body.
        normals: [DVec3; 2],
        /// A pair of vertices extreme along it.
        pair: VertexPair,
    },
    /// They were to keep a gap.
    Kept {
        /// Of the plane that bounded the way.
        normal: DVec3,
        /// Where they were nearest.
        pairs: NearestPairs,
    },
}
