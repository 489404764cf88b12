//! Certificates of clearances between solids.
//!
//! - Upper bound: the pair of facets that attains the answer.
//! - Lower bound: a [`Cover`], the antichain of pairs of nodes at which the descent through both trees stopped,
//!   each with its reason. A fixed rule chooses the node to split, so a cover needs no indices. It lists in
//!   preorder whether a pair was split or why not. A cover that can be read to its end covers all pairs of facets.
//! - Start: a second cover shows that the surfaces do not cross at the start.
//!
//! The lower bound is the value that the entries of the cover prove, less their rounding errors. Bounds of nodes
//! have errors of less than a third of the search's slack. Gaps of facets have bounds of their own errors.

use std::collections::HashMap;

use super::{SolidOptions, StartOverlap};
use crate::body::Solid;
use crate::body::tree::split_pair;
use crate::solve::bound::{Profile, Reason, reason_holds};
use crate::solve::edge_on::{self, EdgeOnFacet};
use crate::solve::leaf::{self, Facet, Gap, Meeting};
use crate::solve::overlap::Overlap;
use crate::solve::projected::Projected;
use crate::solve::scene::PairFrame;
use crate::solve::search::{Aim, node_rounding};
use crate::solve::separating_axes::SeparatingAxes;
use colltrans_convex::cast::Cast;

/// Certificate of [`Cast::clearance`] between solids, which [`Cast::verify`] verifies without a search. Every pair
/// of facets lies under one entry of a cover, and every entry is verified separately.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct SolidCertificate {
    /// Tolerance, a length in world units. Both bodies are offset inwards by half of it.
    pub tolerance: f64,
    /// Proof that the offset bodies overlap at the start, or that they do not.
    pub start: StartProof,
    /// Lower bound of the distance, in multiples of the direction. No pair of facets of the offset bodies blocks before
    /// this translation. It is infinite if no pair ever blocks and the query has no end ([`SolidOptions::before`]), and
    /// 0 if the answer is an overlap.
    #[cfg_attr(
        feature = "serde",
        serde(with = "colltrans_kernel::serialization::null_as_infinity")
    )]
    pub lower: f64,
    /// Pair of facets that blocks the moving body; `None` if nothing blocks, or if the answer is an overlap.
    pub stop: Option<StopProof>,
    /// Proof that no pair of facets blocks before `lower`.
    pub cover: Cover,
}

/// Proof that the offset bodies overlap at the start, or that they do not.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(into = "super::encoding::StoredStart", from = "super::encoding::StoredStart")
)]
pub enum StartProof {
    /// Stated by the caller in [`SolidOptions::overlapping`], without a proof.
    Assumed,
    /// The surfaces do not cross. With a minimum gap, no two facets are certainly nearer than the gap. The cover does
    /// not show that no shell is inside the other body. Verification tests this again.
    Apart(Cover),
    /// The bodies overlap at this place.
    Overlapping(Overlap),
}

/// Pair of facets that blocks the moving body.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct StopProof {
    /// Least gap of the facets of the offset bodies, in multiples of the direction, at least 0. It is the value of
    /// [`SolidContact::offset_distance`](crate::SolidContact::offset_distance).
    #[cfg_attr(feature = "serde", serde(rename = "distance"))]
    pub offset_distance: f64,
    /// Positions in [`Solid::triangles`] of the moving and of the fixed body.
    pub triangles: [u32; 2],
}

/// List of entries for pairs of nodes, in preorder from both roots: `None` if a node of the pair was split,
/// otherwise the reason why not.
///
/// The node whose box has the longer diagonal is split, the moving one if they are equal. A leaf is never split.
#[derive(Debug, Clone, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(into = "String", try_from = "String", bound = "R: super::encoding::ReasonLetters")
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

/// Statement of one entry of a cover about all pairs of certain facets.
#[derive(Debug, Clone, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Claim<R = Reason> {
    /// Positions in [`Solid::triangles`] of the moving body.
    pub moving: std::ops::Range<usize>,
    /// Positions in [`Solid::triangles`] of the fixed body.
    pub fixed: std::ops::Range<usize>,
    /// Reason why none of the pairs matters.
    pub reason: R,
}

impl<R: Copy> Cover<R> {
    /// Returns the number of entries, splits included.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Checks whether the cover has no entries.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Returns the entries in preorder.
    pub fn entries(&self) -> &[Option<R>] {
        &self.0
    }

    /// Descends both trees as the entries state, and calls `check` with the number, the nodes and the reason of
    /// each entry that is not a split.
    ///
    /// # Errors
    /// Returns the number of the first entry that `check` rejects or that does not fit the trees. If the cover ends
    /// too early, this is its length.
    pub(crate) fn visit_entries(
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

    /// Lists the statements of the cover with their facets; `None` if the cover does not fit the bodies.
    pub(crate) fn claims_between(&self, bodies: [&Solid; 2]) -> Option<Vec<Claim<R>>> {
        let mut claims = Vec::new();
        let walked = self.visit_entries(bodies, |_, nodes, reason| {
            let [moving, fixed] = [0, 1].map(|k| bodies[k].nodes()[nodes[k] as usize].facets());
            claims.push(Claim { moving, fixed, reason });
            true
        });
        walked.is_ok().then_some(claims)
    }

    /// Builds the cover from the reasons of the pairs of nodes that were not split.
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
    /// Lists the statements of the cover with their facets; `None` if the cover does not fit the bodies.
    pub fn claims(&self, cast: &Cast<'_, Solid>) -> Option<Vec<Claim>> {
        self.claims_between([cast.moving(), cast.fixed()])
    }
}

impl SolidCertificate {
    /// Returns the aim of the search that the certificate replaces; `None` if the answer is an overlap.
    #[doc(hidden)]
    #[inline]
    pub fn search_aim(&self, options: SolidOptions) -> Option<Aim> {
        let overlapping = match self.start {
            StartProof::Assumed => options.overlapping == Some(true),
            StartProof::Overlapping(_) => true,
            StartProof::Apart(_) => false,
        };
        match (overlapping, options.start_overlap) {
            (false, _) => Some(Aim::Stop),
            (true, StartOverlap::Ignore) => Some(Aim::LaterStop),
            (true, StartOverlap::Refuse) => None,
        }
    }
}

/// Returns a lower bound, a length, of the gaps that count for `aim` between facets of two leaves: the least gap
/// less its rounding errors. Pairs with gaps of at least `limit` may be left out. Infinity if no pair remains.
pub(crate) fn leaf_gap_bound(scene: &PairFrame, aim: Aim, nodes: [u32; 2], limit: f64) -> f64 {
    use std::cmp::Ordering::{Greater, Less};
    let facing_facets = |moving: bool, at: u32, wanted| -> Vec<Facet> {
        let facets = scene.side(moving).solid.nodes()[at as usize].facets();
        facets.filter_map(|t| Facet::facing(scene, moving, t, wanted)).collect()
    };
    let (front, back) =
        (facing_facets(true, nodes[0], Greater), facing_facets(false, nodes[1], Less));
    let mut least = f64::INFINITY;
    for f in &front {
        for g in &back {
            // Gaps somewhat above the limit count too, because their errors are subtracted.
            let end = limit + leaf::SHARP * scene.noise;
            let gap = leaf::facet_gap(scene, f, g, end, aim.gap_filter());
            let sharp = |gap: Gap| {
                let blunt = gap.error > leaf::FINE * scene.noise && gap.at != Meeting::Near;
                if blunt { leaf::exact_facet_gap(scene, f, g) } else { gap }
            };
            let value = gap.map(sharp);
            let value =
                value.and_then(|gap| Some(aim.contribution(&gap)? - gap.error - scene.noise));
            least = least.min(value.unwrap_or(f64::INFINITY));
        }
    }
    if edge_on::may_have_edge_on(scene, nodes) {
        let [f, g] = [true, false].map(|m| EdgeOnFacet::of_leaf(scene, m, nodes[usize::from(!m)]));
        edge_on::each_gap(scene, (&f, &front), (&g, &back), &mut |_, gap| {
            least = least
                .min(aim.contribution(&gap).map_or(f64::INFINITY, |value| value - scene.noise));
        });
    }
    least
}

/// Checks whether an entry of a cover holds that is not a pair of examined leaves. `lower` is the bound that is
/// claimed, as a length.
pub(crate) fn entry_holds(
    (scene, axes): (&PairFrame, &SeparatingAxes),
    aim: Aim,
    nodes: [u32; 2],
    reason: Reason,
    lower: f64,
) -> bool {
    let [p, q] = [&scene.moving, &scene.fixed];
    let projected =
        [Projected::new(scene, p, nodes[0] as usize), Projected::new(scene, q, nodes[1] as usize)];
    let reaches = [axes.node_extents(p, &projected[0]), axes.node_extents(q, &projected[1])];
    let [a, b] = [0, 1].map(|k| Profile { projected: &projected[k], reach: Some(&reaches[k]) });
    match reason {
        Reason::NotBefore if lower <= 0.0 => aim != Aim::Least,
        Reason::Disjoint | Reason::FaceToFace | Reason::Examined => false,
        Reason::Parting if aim == Aim::Least => false,
        _ => reason_holds(scene, a, b, reason, lower + node_rounding(scene)),
    }
}
