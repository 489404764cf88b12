//! What a proof of a clearance is.
//!
//! Above, the pair of facets that attains the answer. Below, the antichain of pairs of nodes at which
//! the descent through both trees stopped, each with its reason. Which node of a pair is split is a
//! rule of its own, so the antichain needs no indices: a [`Cover`] lists in preorder whether a pair
//! was split or why it was not, and covers all pairs of facets by being read to its end. A second one
//! shows that the interiors are disjoint where the bodies are.
//!
//! The lower bound is what the parts of a cover prove with their rounding taken off: bounds of nodes
//! are off by less than a third of the search's slack, gaps of facets by what they say themselves.

use std::collections::HashMap;

use super::{SolidOptions, StartOverlap};
use crate::body::Solid;
use crate::body::tree::split_pair;
use crate::solve::bound::{Profile, Reason, holds};
use crate::solve::leaf::{self, Facet, Gap, Meeting};
use crate::solve::overlap::Overlap;
use crate::solve::projected::Projected;
use crate::solve::rim::{self, Upright};
use crate::solve::scene::Scene;
use crate::solve::search::{Aim, node_rounding};
use crate::solve::separating_axes::SeparatingAxes;
use colltrans_convex::cast::Cast;

/// A proof of the answer of [`Cast::clearance`] between solids, checked by [`Cast::verify`] without a
/// search: every pair of facets lies under one entry of a cover, and every entry is looked at by
/// itself.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct SolidCertificate {
    /// The tolerance: both bodies are shrunk by half of it.
    pub tolerance: f64,
    /// Whether the bodies overlap where they are.
    pub start: StartProof,
    /// No pair of facets of the shrunk bodies stops them before, in multiples of the direction; infinite if none ever
    /// does, 0 for an overlap that is the answer.
    #[cfg_attr(feature = "serde", serde(with = "colltrans_kernel::written::or_infinite"))]
    pub lower: f64,
    /// What stops it.
    pub stop: Option<StopProof>,
    /// Why nothing stops it before.
    pub cover: Cover,
}

/// The proof of what the bodies do where they are.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(into = "super::encoding::Start", from = "super::encoding::Start")
)]
pub enum StartProof {
    /// The caller has said it: [`SolidOptions::overlapping`].
    Assumed,
    /// Their surfaces do not cross; that no shell is inside the other body is checked anew.
    Apart(Cover),
    /// They overlap.
    Overlapping(Overlap),
}

/// The pair of facets that stops the moving body.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct StopProof {
    /// Their least gap, of the shrunk bodies, in multiples of the direction, or 0: the value of
    /// [`SolidContact::shrunk_distance`](crate::SolidContact::shrunk_distance).
    #[cfg_attr(feature = "serde", serde(rename = "distance"))]
    pub shrunk_distance: f64,
    /// Positions in [`Solid::triangles`] of the moving and of the fixed body.
    pub triangles: [u32; 2],
}

/// For each pair of nodes, in preorder from both roots: `None` if one of them was split, or why not.
///
/// Split is the node with the longer diagonal of its box, the moving one if they are equal, and never
/// a leaf.
#[derive(Debug, Clone, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(into = "String", try_from = "String", bound = "R: super::encoding::Letters")
)]
pub struct Cover<R = Reason>(pub(crate) Vec<Option<R>>);

impl<R> Default for Cover<R> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<R> From<Vec<Option<R>>> for Cover<R> {
    fn from(entries: Vec<Option<R>>) -> Self {
        Self(entries)
    }
}

/// One entry of a cover: what is said of all pairs of some facets.
#[derive(Debug, Clone, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Claim<R = Reason> {
    /// Positions in [`Solid::triangles`] of the moving body.
    pub moving: std::ops::Range<usize>,
    /// The same of the fixed body.
    pub fixed: std::ops::Range<usize>,
    /// Why none of the pairs matters.
    pub reason: R,
}

impl<R: Copy> Cover<R> {
    /// Entries, splits included.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The entries.
    pub fn entries(&self) -> &[Option<R>] {
        &self.0
    }

    /// Walks down both trees as the entries say; `check` is asked about every pair that is not split,
    /// with the entry's number. Stops at the first that it refuses.
    ///
    /// # Errors
    /// The number of the entry that is refused, or at which the cover does not fit the trees.
    pub(crate) fn walk(
        &self,
        bodies: [&Solid; 2],
        mut check: impl FnMut(usize, [u32; 2], R) -> bool,
    ) -> Result<(), usize> {
        let (trees, mut stack) = (bodies.map(Solid::nodes), vec![[0, 0]]);
        for (number, entry) in self.0.iter().enumerate() {
            let Some(nodes) = stack.pop() else { return Err(number) };
            match entry {
                Some(reason) if check(number, nodes, *reason) => {}
                Some(_) => return Err(number),
                None => {
                    let [first, second] = split_pair(trees, nodes).ok_or(number)?;
                    stack.extend([second, first]);
                }
            }
        }
        if stack.is_empty() { Ok(()) } else { Err(self.0.len()) }
    }

    /// What it says of which facets; `None` if it does not fit the bodies.
    pub(crate) fn claims_of(&self, bodies: [&Solid; 2]) -> Option<Vec<Claim<R>>> {
        let mut claims = Vec::new();
        let walked = self.walk(bodies, |_, nodes, reason| {
            let [moving, fixed] = [0, 1].map(|k| bodies[k].nodes()[nodes[k] as usize].facets());
            claims.push(Claim { moving, fixed, reason });
            true
        });
        walked.is_ok().then_some(claims)
    }

    /// In preorder, from the pairs of nodes that were not split.
    pub(crate) fn new(bodies: [&Solid; 2], cuts: &HashMap<[u32; 2], R>) -> Self {
        let mut entries = Vec::new();
        let (trees, mut stack) = (bodies.map(Solid::nodes), vec![[0_u32, 0]]);
        while let Some(nodes) = stack.pop() {
            let cut = cuts.get(&nodes).copied();
            entries.push(cut);
            if cut.is_none()
                && let Some([first, second]) = split_pair(trees, nodes)
            {
                stack.extend([second, first]);
            }
        }
        Self(entries)
    }
}

impl Cover {
    /// What the cover says of which facets; `None` if it does not fit the bodies.
    pub fn claims(&self, cast: &Cast<'_, Solid>) -> Option<Vec<Claim>> {
        self.claims_of([cast.moving(), cast.fixed()])
    }
}

impl SolidCertificate {
    /// What the search was for; `None` if an overlap is the answer.
    #[doc(hidden)]
    #[inline]
    pub fn aim(&self, asked: SolidOptions) -> Option<Aim> {
        let overlapping = match self.start {
            StartProof::Assumed => asked.overlapping == Some(true),
            StartProof::Overlapping(_) => true,
            StartProof::Apart(_) => false,
        };
        match (overlapping, asked.start_overlap) {
            (false, _) => Some(Aim::Stop),
            (true, StartOverlap::Ignore) => Some(Aim::LaterStop),
            (true, StartOverlap::Refuse) => None,
        }
    }
}

/// The least gap of pairs of facets of two leaves that count, less its error; what is not below
/// `limit` may be left out.
pub(crate) fn least_of_leaves(scene: &Scene, aim: Aim, nodes: [u32; 2], limit: f64) -> f64 {
    use std::cmp::Ordering::{Greater, Less};
    let of = |moving: bool, at: u32, wanted| -> Vec<Facet> {
        let facets = scene.side(moving).solid.nodes()[at as usize].facets();
        facets.filter_map(|t| Facet::facing(scene, moving, t, wanted)).collect()
    };
    let (front, back) = (of(true, nodes[0], Greater), of(false, nodes[1], Less));
    let mut least = f64::INFINITY;
    for f in &front {
        for g in &back {
            // A gap is wanted whatever its size, so that its own error can be taken off.
            let end = limit + leaf::SHARP * scene.noise;
            let gap = leaf::gap(scene, f, g, end, aim.wanted());
            let sharp = |gap: Gap| {
                let blunt = gap.error > leaf::FINE * scene.noise && gap.at != Meeting::Near;
                if blunt { leaf::sharpened(scene, f, g) } else { gap }
            };
            let value = gap.map(sharp);
            let value = value.and_then(|gap| Some(aim.value(&gap)? - gap.error - scene.noise));
            least = least.min(value.unwrap_or(f64::INFINITY));
        }
    }
    if rim::matters(scene, nodes) {
        let [f, g] = [true, false].map(|m| Upright::of_leaf(scene, m, nodes[usize::from(!m)]));
        rim::each_gap(scene, (&f, &front), (&g, &back), &mut |_, gap| {
            least = least.min(aim.value(&gap).map_or(f64::INFINITY, |value| value - scene.noise));
        });
    }
    least
}

/// Whether an entry of the cover that is no pair of leaves holds.
pub(crate) fn cut_holds(
    (scene, axes): (&Scene, &SeparatingAxes),
    aim: Aim,
    nodes: [u32; 2],
    reason: Reason,
    lower: f64,
) -> bool {
    let [p, q] = [&scene.moving, &scene.fixed];
    let projected =
        [Projected::new(scene, p, nodes[0] as usize), Projected::new(scene, q, nodes[1] as usize)];
    let reaches = [axes.reach(p, &projected[0]), axes.reach(q, &projected[1])];
    let [a, b] = [0, 1].map(|k| Profile { projected: &projected[k], reach: Some(&reaches[k]) });
    match reason {
        Reason::NotBefore if lower <= 0.0 => aim != Aim::Least,
        Reason::Disjoint | Reason::FaceToFace | Reason::Examined => false,
        Reason::Parting if aim == Aim::Least => false,
        _ => holds(scene, a, b, reason, lower + node_rounding(scene)),
    }
}
