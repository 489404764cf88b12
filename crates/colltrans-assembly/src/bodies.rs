//! Queries about two parts and a direction: the layer between assemblies and `colltrans`.
//!
//! - With a tolerance `L` every body is shrunk by `L / 2`, or by its own chord error ([`Fit`]).
//! - With a minimum gap bodies keep their shape. Queries then use [`Cast::with_min_gap`], and boxes are grown by
//!   half of the gap.
//! - A pair with a tolerance of its own, or with a screw that is replaced by its core, has bodies of its own
//!   ([`roles`](crate::roles)). They serve only queries of this pair.

mod paths;
mod turning;

use std::collections::BTreeMap;
use std::sync::{Arc, OnceLock};

use colltrans::removal::directions::{CellBlocker, FreeError, FreeOptions};
use colltrans::solid::{
    ShrinkReport, SolidCast, SolidContact, SolidError, SolidOptions, StartOverlap, Workspace,
};
use colltrans::{Bounded, Cast, Clearance, MAX_MAGNITUDE, Pose, QueryError, Solid};
use glam::DVec3;
use rayon::prelude::*;

use crate::boxes::{BoxTree, RemainingBoxes};
use crate::error::AssemblyError;
use crate::part::{Assembly, Ignored, Part};
use crate::roles::{PairTolerance, Role};
use crate::slabs::Slabs;
use crate::threads::Thread;
use colltrans::Aabb;

pub(crate) use turning::ScrewOutcome;

/// Maximum number of pairs of parts whose boxes intersect. The limit bounds the memory.
pub(crate) const MOST_NEIGHBOURS: usize = 1 << 19;

/// Tolerance or minimum gap with which parts are tested.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Fit {
    /// Shrinks both bodies of a pair by half of this length. Overlaps up to the length, from rounding, chord
    /// errors or a press fit, do not block.
    Tolerance(f64),
    /// Shrinks each body by its own [chord error](Part::chord_error) and by half of `base`. The tolerance of
    /// a pair is the sum of both chord errors and `base`.
    Chords {
        /// Tolerance for the last digits of coordinates.
        base: f64,
        /// Maximum tolerance of a pair: twice the largest chord error, plus `base`.
        largest: f64,
    },
    /// Minimum gap of two bodies in all directions. Bodies that are nearer at the start overlap, and motions
    /// stop at this distance. Pairs that touch on purpose must be listed as ignored.
    MinGap(f64),
}

/// Rounding of single precision, as a share of the assembly's extent.
const SINGLE_DIGITS: f64 = 1.0 / (1 << 21) as f64;
/// Rounding of doubles placed in the world, as a share of the assembly's largest coordinate.
const DOUBLE_DIGITS: f64 = 1.0 / (1_u64 << 46) as f64;

impl Fit {
    /// Returns the default fit, from the chord errors of the parts, where their source states them, and the tolerance
    /// for the last digits of the numbers in the files.
    ///
    /// That tolerance is the largest of:
    /// - for each file, `2^-21` of its largest coordinate in single precision, otherwise four times
    ///   [`Mesh::precision`](colltrans_mesh::Mesh::precision), as in
    ///   [`cast_between`](colltrans_mesh::body::cast_between);
    /// - `2^-21` of the assembly's extent, if a part is in single precision, has no file, or is rotated by a pose;
    /// - `2^-46` of the largest coordinate in the world, for the rounding of doubles.
    pub fn default_for(assembly: &Assembly) -> Self {
        let base = Self::digits(assembly);
        let errors = assembly.parts().iter().filter_map(Part::chord_error);
        match errors.reduce(f64::max) {
            Some(largest) => Self::Chords { base, largest: 2.0 * largest + base },
            None => Self::Tolerance(base),
        }
    }

    /// Returns the tolerance for the last digits of coordinates ([`Self::default_for`]).
    pub(crate) fn digits(assembly: &Assembly) -> f64 {
        let parts = assembly.parts();
        let file_digits = parts.iter().map(Part::last_digits).fold(0.0, f64::max);
        let is_coarse = parts.iter().any(Part::is_coarse);
        let extent_digits = if is_coarse { SINGLE_DIGITS * assembly.largest_side() } else { 0.0 };
        file_digits.max(extent_digits).max(DOUBLE_DIGITS * assembly.coordinate_size())
    }

    /// Returns the length below which distances count as equal and parts as touching: [`Self::digits`], but
    /// at least the rounding of single precision of the assembly's extent.
    pub(crate) fn negligible(assembly: &Assembly) -> f64 {
        Self::digits(assembly).max(SINGLE_DIGITS * assembly.largest_side())
    }

    /// Returns the length by which a part is shrunk.
    fn shrink_distance(self, part: &Part) -> f64 {
        match self {
            Self::Tolerance(length) => length / 2.0,
            Self::Chords { base, .. } => part.chord_error().unwrap_or(0.0) + base / 2.0,
            Self::MinGap(_) => 0.0,
        }
    }

    /// Returns the minimum gap; 0 with a tolerance.
    const fn min_gap(self) -> f64 {
        match self {
            Self::Tolerance(_) | Self::Chords { .. } => 0.0,
            Self::MinGap(length) => length,
        }
    }

    /// Returns the largest tolerance of all pairs; a minimum gap is returned as a negative tolerance.
    pub const fn tolerance(self) -> f64 {
        match self {
            Self::Tolerance(length) | Self::Chords { largest: length, .. } => length,
            Self::MinGap(length) => -length,
        }
    }
}

/// The contact that stops a part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stop {
    /// Translation at which the facets in contact meet without shrinking, with bounds:
    /// [`SolidContact::translation`]. Equal to `shrunk_translation` with a minimum gap.
    pub translation: Bounded,
    /// Translation until the shrunk bodies touch, or until the minimum gap is reached; never negative.
    pub shrunk_translation: Bounded,
    /// Unit contact normal in the world, from the moving part to the other one.
    pub normal: DVec3,
    /// Contact point on the other part, in the world.
    pub point: DVec3,
    /// Triangles in contact: of the moving body and of the other one.
    pub(crate) triangles: [u32; 2],
}

impl Stop {
    /// Returns the lower bound of `translation`, but at least 0.
    ///
    /// Up to this distance the shrunk bodies are proven not to overlap (or to keep the gap), and the unshrunk
    /// facets in contact are proven not to meet. Rounding makes it slightly smaller than the exact value:
    /// less than 7 for a part that stops at 7.
    pub const fn distance(&self) -> f64 {
        self.translation.lower.max(0.0)
    }
}

/// Free travel of one part before another one stops it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FreeTravel {
    /// The parts never meet.
    Free,
    /// The parts meet.
    Blocked(Stop),
    /// The parts overlap at the start.
    Overlapping,
}

/// The body of a part in queries.
struct ShrunkBody {
    /// The shrunk solid; with a minimum gap, the given one.
    solid: Solid,
    /// The core of the part's thread, if that was shrunk instead of the given solid.
    core: Option<Solid>,
    /// For each triangle of `solid`, the corresponding triangle before shrinking.
    given: Vec<u32>,
    /// Defects of the shrunk solid.
    report: ShrinkReport,
}

impl ShrunkBody {
    /// Shrinks a part, or the core of its thread, for a fit.
    fn new(part: &Part, core: Option<Solid>, fit: Fit) -> Result<Self, SolidError> {
        let from = core.as_ref().unwrap_or(part.solid());
        let (solid, report) = match fit {
            Fit::Tolerance(_) | Fit::Chords { .. } => from.shrunk(fit.shrink_distance(part))?,
            Fit::MinGap(_) => (from.clone(), ShrinkReport::default()),
        };
        let given = corresponding_triangles(&solid, from);
        Ok(Self { solid, core, given, report })
    }

    /// Describes the defects of the shrunk solid.
    fn faults(&self, given: &Solid) -> Vec<String> {
        let ShrinkReport { fixed_vertices: stuck, inverted, .. } = &self.report;
        let mut found = Vec::new();
        if self.solid.is_closed()
            && enclosed_volume(given) > 0.0
            && enclosed_volume(&self.solid) <= 0.0
        {
            found
                .push("nothing of it is left, because it is thinner than the tolerance".to_owned());
        }
        if !inverted.is_empty() {
            found.push(format!("facets turned inside out or through others: {}", inverted.len()));
        }
        if !stuck.is_empty() {
            found.push(format!("vertices that cannot be shrunk: {}", stuck.len()));
        }
        found
    }
}

/// The parts of an assembly, prepared for queries with one fit.
pub struct Bodies<'a> {
    assembly: &'a Assembly,
    fit: Fit,
    shrunk_parts: Vec<ShrunkBody>,
    /// Fits of pairs with a role or tolerance of their own, the smaller index first.
    pairs: BTreeMap<[usize; 2], OwnFit>,
    /// The body of the first part in queries against the second one, where it differs from the general body.
    own: BTreeMap<[usize; 2], Arc<ShrunkBody>>,
    boxes: Vec<Aabb>,
    tree: BoxTree,
    /// Extents along the directions of [`Self::measure_along`].
    slabs: OnceLock<Slabs>,
    /// Pairs whose bodies overlap at the start, the smaller index first, sorted.
    overlapping: Vec<[usize; 2]>,
    /// Pairs whose overlap is ignored, with an additional tolerance that removes the overlap. Motions that
    /// would overlap even with this tolerance deepen the overlap.
    passing: BTreeMap<[usize; 2], f64>,
    /// For each part, the others that it overlaps, ignores or has a fit of its own with, in increasing order.
    partners: Vec<Vec<usize>>,
    noise: f64,
    /// Number of queries of two parts.
    #[cfg(test)]
    pub(crate) query_count: std::sync::atomic::AtomicUsize,
    /// Number of visits of parts, pairs and tree nodes during planning.
    #[cfg(test)]
    pub(crate) visit_count: std::sync::atomic::AtomicUsize,
}

/// Resolved fit of a pair with a role or tolerance of its own.
#[derive(Clone, Copy)]
struct OwnFit {
    fit: Fit,
    tolerated: PairTolerance,
    /// Thread of the pair, if the core of the screw is tested instead of the screw.
    thread: Option<Thread>,
}

/// Factor by which an ignored overlap may deepen, so that rounding does not block.
const DEEPER: f64 = 1.05;

impl<'a> Bodies<'a> {
    /// Builds the bodies, and finds the pairs that overlap at the start.
    ///
    /// # Errors
    /// - [`AssemblyError::InvalidValue`]: the tolerance or minimum gap is negative, not finite or too large.
    /// - [`AssemblyError::Part`]: a part cannot be shrunk.
    /// - [`AssemblyError::TooMany`]: too many boxes of parts intersect.
    pub fn new(assembly: &'a Assembly, fit: Fit) -> Result<Self, AssemblyError> {
        let (what, value) = match fit {
            Fit::Tolerance(value) | Fit::Chords { largest: value, .. } => ("tolerance", value),
            Fit::MinGap(value) => ("minimum gap", value),
        };
        if !(0.0..=MAX_MAGNITUDE).contains(&value) {
            return Err(AssemblyError::InvalidValue { what, value });
        }
        let displaced =
            |part: &Part| ShrunkBody::new(part, None, fit).map_err(|e| part_error(part, e));
        let displaced: Result<Vec<ShrunkBody>, AssemblyError> =
            assembly.parts().par_iter().map(displaced).collect();
        let displaced = displaced?;
        let (pairs, own) = resolved_pair_fits(assembly, fit)?;
        let margin = fit.min_gap() / 2.0;
        let mut boxes: Vec<Aabb> =
            displaced.iter().map(|part| part.solid.bounds().expanded(margin)).collect();
        for ([part, _], own) in &own {
            boxes[*part] = boxes[*part].union(&own.solid.bounds());
        }
        let tree = BoxTree::new(boxes.iter().copied());
        let noise = 4.0 * Fit::negligible(assembly);
        let (overlapping, passing) = (Vec::new(), BTreeMap::new());
        let mut bodies = Self {
            assembly,
            fit,
            shrunk_parts: displaced,
            pairs,
            own,
            boxes,
            tree,
            slabs: OnceLock::new(),
            overlapping,
            passing,
            partners: Vec::new(),
            noise,
            #[cfg(test)]
            query_count: std::sync::atomic::AtomicUsize::default(),
            #[cfg(test)]
            visit_count: std::sync::atomic::AtomicUsize::default(),
        };
        let pairs = bodies.neighbouring_pairs(0.0)?;
        let overlapping = pairs.into_par_iter().filter(|&[a, b]| bodies.overlap_in_place(a, b));
        bodies.overlapping = overlapping.collect();
        let ignored = |pair: &&[usize; 2]| assembly.ignored_contacts(pair[0], pair[1]).is_some();
        let ignored = bodies.overlapping.par_iter().filter(ignored);
        bodies.passing = ignored
            .filter_map(|&pair| Some((pair, bodies.overlap_free_tolerance(pair)?)))
            .collect();
        bodies.partners = bodies.partner_lists();
        Ok(bodies)
    }

    /// Collects for each part the others that it overlaps, ignores or has a fit of its own with.
    fn partner_lists(&self) -> Vec<Vec<usize>> {
        let mut partners = vec![Vec::new(); self.len()];
        let pairs = self.overlapping.iter().chain(self.pairs.keys()).copied();
        for [a, b] in pairs.chain(self.assembly.ignored_pairs()) {
            partners[a].push(b);
            partners[b].push(a);
        }
        for others in &mut partners {
            others.sort_unstable();
            others.dedup();
        }
        partners
    }

    /// Iterates over the pairs of a part of `group` and a present part that overlap, are ignored or have a
    /// fit of their own. `there` marks the present parts by index.
    pub(crate) fn present_partners<'s>(
        &'s self,
        group: &'s [usize],
        there: &'s [bool],
    ) -> impl Iterator<Item = [usize; 2]> + 's {
        let pairs = |&a: &usize| self.partners[a].iter().map(move |&b| [a, b]);
        group.iter().flat_map(pairs).filter(|&[_, b]| there[b])
    }

    /// Returns an additional tolerance with which two parts do not overlap, 5 % above the least one. Returns
    /// `None` if no such tolerance leaves both parts whole.
    fn overlap_free_tolerance(&self, pair: [usize; 2]) -> Option<f64> {
        let solids = self.pair_solids(pair);
        let [a, b] = solids.map(|solid| solid.at(Pose::IDENTITY));
        let cast =
            Cast::new(a, b, DVec3::Z).ok()?.with_min_gap(self.pair_fit(pair).min_gap()).ok()?;
        let tolerance = cast.least_tolerance()? * DEEPER;
        solids.into_iter().all(|solid| stays_whole(solid, tolerance)).then_some(tolerance)
    }

    /// Returns the body of a part in queries against another one.
    fn pair_body(&self, [part, other]: [usize; 2]) -> &ShrunkBody {
        self.own.get(&[part, other]).map_or(&self.shrunk_parts[part], |own| own)
    }

    /// Returns the solid from which [`Self::pair_body`] was shrunk.
    fn unshrunk_solid(&self, pair: [usize; 2]) -> &Solid {
        let given = self.assembly.parts()[pair[0]].solid();
        self.pair_body(pair).core.as_ref().unwrap_or(given)
    }

    /// Returns the shrunk solids of two parts in queries of this pair.
    pub(crate) fn pair_solids(&self, [a, b]: [usize; 2]) -> [&Solid; 2] {
        [&self.pair_body([a, b]).solid, &self.pair_body([b, a]).solid]
    }

    /// Checks whether facets of the bodies of a pair are inside out or pass through others, because a part is thinner
    /// than the tolerance there.
    pub(crate) fn has_inverted_facets(&self, [a, b]: [usize; 2]) -> bool {
        let bodies = [self.pair_body([a, b]), self.pair_body([b, a])];
        bodies.iter().any(|body| !body.report.inverted.is_empty())
    }

    /// Returns the fit of a pair with a role or tolerance of its own, if any.
    fn own_fit(&self, [a, b]: [usize; 2]) -> Option<&OwnFit> {
        self.count_visit();
        self.pairs.get(&[a.min(b), a.max(b)])
    }

    /// Returns the fit of a pair.
    fn pair_fit(&self, pair: [usize; 2]) -> Fit {
        self.own_fit(pair).map_or(self.fit, |own| own.fit)
    }

    /// Returns the tolerance of a pair: the sum of the lengths by which its bodies are shrunk.
    pub fn pair_tolerance(&self, pair: [usize; 2]) -> f64 {
        let fit = self.pair_fit(pair);
        pair.map(|k| fit.shrink_distance(&self.assembly.parts()[k])).iter().sum()
    }

    /// Returns the contacts that a pair with a fit of its own tolerates; `None` without such a fit.
    pub fn tolerated_contacts(&self, pair: [usize; 2]) -> Option<PairTolerance> {
        self.own_fit(pair).map(|own| own.tolerated)
    }

    /// Returns the assembly.
    pub const fn assembly(&self) -> &'a Assembly {
        self.assembly
    }

    /// Returns the general fit.
    pub const fn fit(&self) -> Fit {
        self.fit
    }

    /// Returns the number of parts.
    pub fn len(&self) -> usize {
        self.boxes.len()
    }

    /// Checks whether the assembly has no parts.
    pub fn is_empty(&self) -> bool {
        self.boxes.is_empty()
    }

    /// Returns a description of the defects of shrinking a part; `None` if there are none.
    ///
    /// Facets are inverted or intersect others where a part is thinner than the tolerance. Results there do
    /// not describe the part. Vertices that cannot be shrunk are those of saddles, around which no
    /// displacement is inward for all facets.
    pub fn shrink_defects(&self, part: usize) -> Option<String> {
        let given = self.assembly.parts()[part].solid();
        let faults = |displaced: &ShrunkBody, by: &str| {
            let found = displaced.faults(displaced.core.as_ref().unwrap_or(given));
            (!found.is_empty()).then(|| format!("{by}; {}", found.join("; ")))
        };
        let all = faults(&self.shrunk_parts[part], "shrunk by half the tolerance");
        let own = self.own.iter().filter(|x| x.0[0] == part).filter_map(|([_, other], own)| {
            let other = self.assembly.parts()[*other].name();
            faults(own, &format!("shrunk by half the tolerance of its pair with {other}"))
        });
        let found: Vec<String> = all.into_iter().chain(own).collect();
        (!found.is_empty()).then(|| found.join("; "))
    }

    /// Returns the length below which differences may come from the last digits of the files: four times
    /// [`Fit::negligible`], thus at least `2^-19` of the assembly's extent.
    pub(crate) fn noise(&self) -> f64 {
        self.noise
    }

    /// Returns the box of a part's bodies, with half of the minimum gap around it.
    pub(crate) fn bounds(&self, part: usize) -> Aabb {
        self.boxes[part]
    }

    /// Returns the parts whose boxes a part's box meets along unit direction `d`, each with a lower bound of
    /// the distance, nearest first.
    ///
    /// Leaves out pairs that are always ignored, and pairs whose extents along the directions of
    /// [`measure_along`](Self::measure_along) prove that they never meet.
    pub(crate) fn parts_ahead(&self, part: usize, d: DVec3) -> Vec<(f64, usize)> {
        let mut found = self.tree.boxes_ahead(&self.boxes[part], d);
        found.retain(|&(_, other)| other != part && !self.always_ignored(part, other));
        if let Some(slabs) = self.slabs.get() {
            found.retain_mut(|(t, other)| {
                slabs.entry_translation([part, *other], d).is_some_and(|least| {
                    *t = t.max(least);
                    true
                })
            });
            found.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        }
        found
    }

    /// Returns the set of parts marked in `there`, for [`first_part_ahead`](Self::first_part_ahead).
    pub(crate) fn remaining_parts(&self, there: &[bool]) -> RemainingBoxes {
        self.tree.remaining_boxes(there)
    }

    /// Removes a part from the set.
    pub(crate) fn remove(&self, living: &mut RemainingBoxes, part: usize) {
        self.tree.remove(living, part);
    }

    /// Computes the bounds of the tree nodes for boxes given by part, for
    /// [`visit_highest_first`](Self::visit_highest_first).
    pub(crate) fn node_bounds(&self, boxes: &[Aabb]) -> Vec<Aabb> {
        self.tree.bounds_of(boxes)
    }

    /// Calls `call` with the parts of the set below the nodes whose bounds satisfy `wanted`; see
    /// [`BoxTree::visit_high`].
    pub(crate) fn visit_highest_first(
        &self,
        living: &RemainingBoxes,
        bounds: &[Aabb],
        wanted: impl Fn(&Aabb) -> bool,
        call: impl FnMut(usize),
    ) {
        let wanted = |bounds: &Aabb| {
            self.count_visit();
            wanted(bounds)
        };
        self.tree.visit_high(living, bounds, wanted, call);
    }

    /// Counts a visit of a part, pair or tree node during planning.
    #[cfg_attr(
        not(test),
        expect(clippy::unused_self, reason = "only builds of tests have the counter")
    )]
    pub(crate) fn count_visit(&self) {
        #[cfg(test)]
        self.visit_count.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
    }

    /// Calls `call` with the parts of `living` whose boxes a part's box meets along unit direction `d`, and
    /// with a lower bound of the distance, nearest first, until a call returns `true`. Returns that part;
    /// `None` if no call returns `true`.
    ///
    /// Leaves out pairs that are always ignored, and pairs whose extents along the directions of
    /// [`measure_along`](Self::measure_along) prove that they never meet.
    pub(crate) fn first_part_ahead(
        &self,
        part: usize,
        d: DVec3,
        living: &RemainingBoxes,
        mut call: impl FnMut(f64, usize) -> bool,
    ) -> Option<usize> {
        let passes = |other: usize| {
            let slabs = self.slabs.get();
            slabs.is_some_and(|slabs| slabs.entry_translation([part, other], d).is_none())
        };
        self.tree.first_ahead(living, &self.boxes[part], d, |bound, other| {
            let is_skipped = other == part || self.always_ignored(part, other) || passes(other);
            !is_skipped && call(bound, other)
        })
    }

    /// Computes the extents of all parts along these unit directions, which speeds up later queries of any
    /// direction. Later calls have no effect.
    pub(crate) fn measure_along(&self, directions: &[DVec3]) {
        self.slabs.get_or_init(|| {
            let mut bodies: Vec<Vec<&Solid>> =
                self.shrunk_parts.iter().map(|part| vec![&part.solid]).collect();
            for ([part, _], own) in &self.own {
                bodies[*part].push(&own.solid);
            }
            Slabs::new(&bodies, self.fit.min_gap() / 2.0, directions)
        });
    }

    /// Returns the pairs whose boxes intersect after the first one is grown by `by`, the smaller index first,
    /// sorted. Pairs that are always ignored are left out.
    ///
    /// # Errors
    /// [`AssemblyError::TooMany`] for more than [`MOST_NEIGHBOURS`] pairs.
    pub(crate) fn neighbouring_pairs(&self, by: f64) -> Result<Vec<[usize; 2]>, AssemblyError> {
        let mut pairs = Vec::new();
        for a in 0..self.len() {
            let near =
                self.tree.intersecting(&self.boxes[a].expanded(by)).into_iter().filter(|&b| b > a);
            pairs.extend(near.filter(|&b| !self.always_ignored(a, b)).map(|b| [a, b]));
            if pairs.len() > MOST_NEIGHBOURS {
                let (what, most) =
                    ("pairs of parts lie within each other's boxes", MOST_NEIGHBOURS);
                return Err(AssemblyError::TooMany { what, most });
            }
        }
        Ok(pairs)
    }

    /// Checks whether two parts are never tested: all their contacts are ignored, or they are glued.
    fn always_ignored(&self, a: usize, b: usize) -> bool {
        self.assembly.ignored_contacts(a, b) == Some(Ignored::Always)
            || self.tolerated_contacts([a, b]) == Some(PairTolerance::Glued)
    }

    /// Returns how an overlap of two parts at the start is treated; `start` is the general rule.
    pub(crate) fn pair_start_overlap(
        &self,
        a: usize,
        b: usize,
        start: StartOverlap,
    ) -> StartOverlap {
        let crossing = self.tolerated_contacts([a, b]) == Some(PairTolerance::Crossing);
        match self.assembly.ignored_contacts(a, b) {
            None if !crossing => start,
            _ => StartOverlap::Ignore,
        }
    }

    /// Checks whether two parts are apart and block each other without exceptions: no contacts are ignored, and the pair
    /// tolerates none, other than those within a tolerance of its own.
    pub(crate) fn blocks_plainly(&self, [a, b]: [usize; 2]) -> bool {
        let own = self.tolerated_contacts([a, b]);
        matches!(own, None | Some(PairTolerance::Within(_)))
            && self.assembly.ignored_contacts(a, b).is_none()
            && !self.overlaps(a, b)
    }

    /// Checks whether a plan disregards contacts of two parts at the start: all contacts, contacts of a snap
    /// fit, or an ignored overlap.
    pub(crate) fn disregards_contacts(&self, a: usize, b: usize, start: StartOverlap) -> bool {
        self.always_ignored(a, b)
            || matches!(self.tolerated_contacts([a, b]), Some(PairTolerance::Snap(_)))
            || (self.overlaps(a, b) && self.pair_start_overlap(a, b, start) == StartOverlap::Ignore)
    }

    /// Returns how far part `a` moves along unit direction `d` before `b` stops it.
    ///
    /// Contacts at `before` or beyond need not be reported. Parts that overlap at the start are
    /// [`FreeTravel::Overlapping`]. If `start` is [`StartOverlap::Ignore`], or the assembly
    /// [ignores](Assembly::with_ignored) the overlap, only contacts that begin later stop the part. Motions
    /// that deepen an ignored overlap stop it too, if the assembly ignores the overlap.
    pub fn free_travel(
        &self,
        [a, b]: [usize; 2],
        d: DVec3,
        before: Option<f64>,
        start: StartOverlap,
        workspace: &mut Workspace,
    ) -> FreeTravel {
        #[cfg(test)]
        self.query_count.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        if let Some(PairTolerance::Snap(length)) = self.tolerated_contacts([a, b]) {
            return self.room_beyond_snap([a, b], d, length, before, workspace);
        }
        let (overlapping, start) = (self.overlaps(a, b), self.pair_start_overlap(a, b, start));
        if overlapping && start == StartOverlap::Refuse {
            return FreeTravel::Overlapping;
        }
        // With a limit, also an infinite one, no separating plane is computed for free parts.
        let options = SolidOptions::default()
            .with_start_overlap(start)
            .with_tolerance(0.0)
            .with_min_gap(self.pair_fit([a, b]).min_gap())
            .with_before(before.unwrap_or(f64::INFINITY))
            .with_overlapping(overlapping);
        let solids = self.pair_solids([a, b]);
        let later = first_contact(solids, d, options, workspace);
        let deeper = self.passing.get(&[a.min(b), a.max(b)]).and_then(|&tolerance| {
            let apart = options.with_start_overlap(StartOverlap::Refuse).with_overlapping(false);
            first_contact(solids, d, apart.with_tolerance(tolerance), workspace)
        });
        let stops = later.into_iter().chain(deeper);
        let stops = stops.map(|c| self.stop_from_contact([a, b], d, c.triangles, &c));
        let nearest =
            stops.min_by(|x, y| x.shrunk_translation.value.total_cmp(&y.shrunk_translation.value));
        nearest.map_or(FreeTravel::Free, FreeTravel::Blocked)
    }

    /// Returns the free travel of a part that snaps over another one. Only contacts that begin after a
    /// displacement by `length` along `d` stop it.
    fn room_beyond_snap(
        &self,
        pair: [usize; 2],
        d: DVec3,
        length: f64,
        before: Option<f64>,
        workspace: &mut Workspace,
    ) -> FreeTravel {
        let [moving, fixed] = self.pair_solids(pair);
        let options = SolidOptions::default()
            .with_start_overlap(StartOverlap::Ignore)
            .with_tolerance(0.0)
            .with_min_gap(self.pair_fit(pair).min_gap())
            .with_before(before.map_or(f64::INFINITY, |before| (before - length).max(0.0)));
        let answer = Pose::from_translation(d * length)
            .ok()
            .and_then(|pose| Cast::new(moving.at(pose), fixed.at(Pose::IDENTITY), d).ok())
            .and_then(|cast| cast.with_options(options).ok())
            .and_then(|cast| cast.clearance_in(workspace).ok());
        let Some(Clearance::Blocked { contact, .. }) = answer else { return FreeTravel::Free };
        let Bounded { value, lower, upper } = contact.translation;
        let translation = Bounded {
            value: value + length,
            lower: (lower + length).next_down(),
            upper: (upper + length).next_up(),
        };
        let SolidContact { normal, point_on_fixed: point, triangles, .. } = contact;
        FreeTravel::Blocked(Stop {
            translation,
            shrunk_translation: translation,
            normal,
            point,
            triangles,
        })
    }

    /// Returns the pairs of a part of `group` and a present part outside of it whose box it meets along unit
    /// direction `d`. `there` marks the present parts by index.
    pub(crate) fn pairs_ahead(&self, group: &[usize], d: DVec3, there: &[bool]) -> Vec<[usize; 2]> {
        let all = |&a: &usize| self.parts_ahead(a, d).into_iter().map(move |(_, b)| [a, b]);
        let wanted = |[_, b]: &[usize; 2]| there[*b] && !group.contains(b);
        group.iter().flat_map(all).filter(wanted).collect()
    }

    /// Checks whether a part ever meets another one along unit direction `d`, or overlaps it at the start.
    pub(crate) fn ever_meets(
        &self,
        pair: [usize; 2],
        d: DVec3,
        start: StartOverlap,
        workspace: &mut Workspace,
    ) -> bool {
        self.free_travel(pair, d, None, start, workspace) != FreeTravel::Free
    }

    /// Returns by index whether a part is one of these.
    pub(crate) fn part_mask(&self, parts: &[usize]) -> Vec<bool> {
        let mut mask = vec![false; self.len()];
        for &part in parts {
            mask[part] = true;
        }
        mask
    }

    /// Joins the shrunk solids of some parts into one. Also returns each part with the index of its first
    /// facet in the joined solid.
    ///
    /// # Errors
    /// [`AssemblyError::Free`] if the solids cannot be joined.
    pub(crate) fn joined_solid(
        &self,
        parts: &[usize],
    ) -> Result<(Solid, Vec<(usize, u32)>), AssemblyError> {
        let mut first = 0;
        let mut first_facet = |&part: &usize| {
            let begin = first;
            first += self.shrunk_parts[part].solid.input_counts()[1];
            (part, begin)
        };
        let first_facets = parts.iter().map(&mut first_facet).collect();
        let solid = Solid::from_pieces(parts.iter().map(|&part| &self.shrunk_parts[part].solid));
        let refused = |e| AssemblyError::Free(FreeError::Query(QueryError::from(e)));
        Ok((solid.map_err(refused)?, first_facets))
    }

    /// Returns the test whether a part blocks whole cells of directions of another one; `None` if it cannot
    /// be built, for example because the parts overlap.
    pub(crate) fn cell_blocker(&self, pair: [usize; 2]) -> Option<CellBlocker<'_>> {
        let [moving, fixed] = self.pair_solids(pair).map(|solid| solid.at(Pose::IDENTITY));
        CellBlocker::new(&moving, &fixed, FreeOptions::DEFAULT.with_no_tolerance()).ok()
    }

    /// Checks that two parts block each other without exceptions.
    ///
    /// # Errors
    /// [`AssemblyError::DirectionsUnavailable`] with a minimum gap, and for parts that are ignored, have a fit of
    /// their own, overlap at the start, or are not both closed.
    pub(crate) fn check_without_exceptions(&self, [a, b]: [usize; 2]) -> Result<(), AssemblyError> {
        let why = if self.fit.min_gap() > 0.0 {
            "a minimum gap is set"
        } else if self.always_ignored(a, b) {
            "they are ignored"
        } else if self.own_fit([a, b]).is_some() {
            "they have a fit of their own"
        } else if self.overlaps(a, b) {
            "they overlap at the start"
        } else if [a, b].iter().any(|&k| !self.assembly.parts()[k].solid().is_closed()) {
            "they are not both closed"
        } else {
            return Ok(());
        };
        let [a, b] = [a, b].map(|part| self.assembly.parts()[part].name().to_owned());
        Err(AssemblyError::DirectionsUnavailable { a, b, why })
    }

    /// Returns the contact of one facet of each part, as if the parts had no other facets. Returns `None` if
    /// these facets do not stop the part, or if the pair is a snap fit. Parts that overlap are not rejected.
    pub(crate) fn stop_of_triangles(
        &self,
        [a, b]: [usize; 2],
        triangles: [u32; 2],
        d: DVec3,
        start: StartOverlap,
    ) -> Option<Stop> {
        if matches!(self.tolerated_contacts([a, b]), Some(PairTolerance::Snap(_))) {
            return None;
        }
        let start = self.pair_start_overlap(a, b, start);
        let options = SolidOptions::default()
            .with_start_overlap(start)
            .with_tolerance(0.0)
            .with_min_gap(self.pair_fit([a, b]).min_gap())
            .with_before(f64::INFINITY)
            .with_overlapping(start == StartOverlap::Ignore && self.overlaps(a, b));
        let cast = cast_in_world(self.pair_solids([a, b]), d, options)?;
        let contact = cast.contact_of_triangles(triangles)?;
        Some(self.stop_from_contact([a, b], d, triangles, &contact))
    }

    /// Builds the [`Stop`] of a contact of shrunk bodies.
    fn stop_from_contact(
        &self,
        pair: [usize; 2],
        d: DVec3,
        triangles: [u32; 2],
        contact: &SolidContact,
    ) -> Stop {
        let SolidContact { normal, point_on_fixed: point, translation: displaced, .. } = *contact;
        let nominal = self.nominal_translation(pair, d, triangles, contact);
        Stop {
            translation: nominal.unwrap_or(displaced),
            shrunk_translation: displaced,
            normal,
            point,
            triangles,
        }
    }

    /// Returns the translation at which the facets in contact meet on the unshrunk parts; `None` without a
    /// tolerance or if they do not meet.
    fn nominal_translation(
        &self,
        [a, b]: [usize; 2],
        d: DVec3,
        [moving, fixed]: [u32; 2],
        contact: &SolidContact,
    ) -> Option<Bounded> {
        if self.pair_fit([a, b]).tolerance() <= 0.0 {
            return None;
        }
        let shift = self.shrink_displacement([a, b], moving as usize, contact.point_on_moving)
            - self.shrink_displacement([b, a], fixed as usize, contact.point_on_fixed);
        let [of, by] = [self.pair_body([a, b]), self.pair_body([b, a])];
        let triangles = [of.given[moving as usize], by.given[fixed as usize]];
        let parts = [self.unshrunk_solid([a, b]), self.unshrunk_solid([b, a])];
        let cast = cast_in_world(parts, d, SolidOptions::default())?;
        cast.nominal_translation(triangles, contact.translation, contact.normal, shift)
    }

    /// Returns the displacement of a point of a triangle of the first part by shrinking. Vertices keep their
    /// indices when a solid is shrunk.
    fn shrink_displacement(&self, pair: [usize; 2], triangle: usize, point: DVec3) -> DVec3 {
        let (solid, given) = (&self.pair_body(pair).solid, self.unshrunk_solid(pair));
        let corners = solid.triangles()[triangle].map(|v| v as usize);
        let weights = barycentric_weights(corners.map(|v| solid.vertices()[v]), point);
        let of = |k: usize| solid.vertices()[corners[k]] - given.vertices()[corners[k]];
        of(0) * weights.x + of(1) * weights.y + of(2) * weights.z
    }

    /// Returns the pairs that overlap at the start with this fit, the smaller index first, sorted.
    pub fn overlapping_pairs(&self) -> &[[usize; 2]] {
        &self.overlapping
    }

    /// Checks whether two parts overlap at the start with this fit.
    pub fn overlaps(&self, a: usize, b: usize) -> bool {
        self.overlapping.binary_search(&[a.min(b), a.max(b)]).is_ok()
    }

    /// Tests whether two parts overlap at the start.
    fn overlap_in_place(&self, a: usize, b: usize) -> bool {
        self.overlaps_displaced(a, DVec3::ZERO, b)
    }

    /// Returns the least tolerance that removes the overlap of two parts, as given in the files. The outer value is
    /// `None` if the parts do not overlap. The inner one is `None` if no tolerance up to their size removes the
    /// overlap.
    pub fn least_tolerance(&self, a: usize, b: usize) -> Option<Option<f64>> {
        least_tolerance_of_parts(self.assembly, [a, b])
    }

    /// Returns the distance, with bounds, that part `a` must move along unit direction `d` until it lies
    /// wholly beyond `b`, both as given in the files. The distance is 0 if `a` is already beyond `b`, or if
    /// the boxes of their shadows do not intersect up to rounding.
    ///
    /// Rounding: a product `p . d` has an error of at most `3 u` of the sum `s` of its terms' absolute
    /// values, therefore a difference of two at most `4 u` of both sums. Because the length of `d` is 1 up to
    /// `4 u`, the distance has a further relative error of `8 u`.
    pub fn travel_beyond(&self, a: usize, b: usize, d: DVec3) -> Bounded {
        self.direction_extents(a, d).travel_beyond(&self.direction_extents(b, d))
    }

    /// Computes [`Self::travel_beyond`] with part `a` displaced by `by`.
    pub(crate) fn travel_beyond_displaced(
        &self,
        a: usize,
        by: DVec3,
        b: usize,
        d: DVec3,
    ) -> Bounded {
        // Adding the displacement is one more rounding of each vertex.
        let sums = if by == DVec3::ZERO { SUMS } else { SUMS + 1.0 };
        self.travel_beyond_moved((a, |p| p + by), b, d, sums)
    }

    /// Computes [`Self::travel_beyond`] with the vertices of part `a` mapped by `moved`. Each mapped vertex has an
    /// error of at most `sums - 9` roundings of the size of its coordinates.
    pub(crate) fn travel_beyond_moved(
        &self,
        (a, moved): (usize, impl Fn(DVec3) -> DVec3),
        b: usize,
        d: DVec3,
        sums: f64,
    ) -> Bounded {
        DirectionExtents { sums, ..self.projection_of_moved(a, moved, d) }
            .travel_beyond(&self.direction_extents(b, d))
    }

    /// Returns the extents of a part in the frame of unit direction `d`.
    pub(crate) fn direction_extents(&self, part: usize, d: DVec3) -> DirectionExtents {
        self.projection_of_moved(part, |p| p, d)
    }

    /// Returns the extents of a part with mapped vertices in the frame of unit direction `d`.
    fn projection_of_moved(
        &self,
        part: usize,
        moved: impl Fn(DVec3) -> DVec3,
        d: DVec3,
    ) -> DirectionExtents {
        let (u, v) = d.any_orthonormal_pair();
        let (mut terms, mut reach) = (0.0_f64, 0.0_f64);
        let vertices = self.assembly.parts()[part].solid().vertices().iter();
        let bounds = Aabb::from_points(vertices.map(|p| {
            let p = moved(*p);
            terms = terms.max(p.abs().dot(d.abs()));
            reach = reach.max(p.abs().max_element());
            DVec3::new(p.dot(u), p.dot(v), p.dot(d))
        }));
        DirectionExtents { bounds, terms, reach, sums: SUMS }
    }

    /// Checks whether part `a`, displaced by `by`, and part `b` overlap or violate the minimum gap, beyond
    /// rounding.
    pub fn overlaps_displaced(&self, a: usize, by: DVec3, b: usize) -> bool {
        #[cfg(test)]
        self.query_count.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        let Ok(pose) = Pose::from_translation(by) else { return false };
        let [moving, fixed] = self.pair_solids([a, b]);
        let options = SolidOptions::default()
            .with_tolerance(0.0)
            .with_min_gap(self.pair_fit([a, b]).min_gap());
        let cast = Cast::new(moving.at(pose), fixed.at(Pose::IDENTITY), DVec3::Z);
        cast.and_then(|c| c.with_options(options)).is_ok_and(|cast| cast.overlaps())
    }
}

/// Number of roundings of the difference of two products with a direction.
const SUMS: f64 = 9.0;

/// Extents of a part in a frame whose third axis is the direction, with their rounding errors.
#[derive(Clone, Copy)]
pub(crate) struct DirectionExtents {
    bounds: Aabb,
    /// Largest sum of absolute terms of a product with the direction.
    terms: f64,
    /// Largest absolute coordinate of a vertex.
    reach: f64,
    /// Number of roundings of a difference of coordinates along the direction.
    sums: f64,
}

impl DirectionExtents {
    /// Checks whether a part within `bounds` could raise the distance `found` that this part must move
    /// ([`travel_beyond`](Self::travel_beyond)). `reach` is the largest coordinate of any part, so that the rounding
    /// errors are overestimated.
    pub(crate) fn may_be_behind(&self, bounds: &Aabb, reach: f64, found: &Bounded) -> bool {
        let noise = 64.0 * f64::EPSILON * reach;
        let apart = |k: usize| {
            (bounds.low[k] - self.bounds.high[k]).max(self.bounds.low[k] - bounds.high[k])
        };
        let distance = bounds.high.z - self.bounds.low.z;
        distance + noise > found.lower && !(0..2).any(|k| apart(k) > noise)
    }

    /// Returns the largest absolute coordinate of a vertex.
    pub(crate) const fn reach(&self) -> f64 {
        self.reach
    }

    /// Returns the distance, with bounds, that this part must move until it lies wholly beyond another one;
    /// see [`Bodies::travel_beyond`].
    pub(crate) fn travel_beyond(&self, fixed: &Self) -> Bounded {
        const U: f64 = f64::EPSILON / 2.0;
        let (own, other) = (&self.bounds, &fixed.bounds);
        // Each coordinate is a sum of three terms of at most this size, on rounded axes.
        let flush = 32.0 * U * self.reach.max(fixed.reach);
        let apart = |k: usize| (other.low[k] - own.high[k]).max(own.low[k] - other.high[k]);
        if (0..2).any(|k| apart(k) > flush) {
            return Bounded { value: 0.0, lower: 0.0, upper: 0.0 };
        }
        let distance = other.high.z - own.low.z;
        let error = U * (self.sums * self.terms.max(fixed.terms) + 9.0 * distance.abs());
        let [value, lower, upper] =
            [distance, distance - error, distance + error].map(|x| x.max(0.0));
        Bounded { value, lower, upper }
    }
}

/// Fits of pairs, and the bodies of parts for queries of these pairs.
type OwnFits = (BTreeMap<[usize; 2], OwnFit>, BTreeMap<[usize; 2], Arc<ShrunkBody>>);

/// Resolves the roles and tolerances of pairs, and builds the bodies for them.
fn resolved_pair_fits(assembly: &Assembly, fit: Fit) -> Result<OwnFits, AssemblyError> {
    let (mut pairs, mut own) = (BTreeMap::new(), BTreeMap::new());
    // Bodies by part, tolerance and kind of fit, so that a part of many pairs is shrunk once for each
    // tolerance.
    let mut known: BTreeMap<(usize, u64, bool), Arc<ShrunkBody>> = BTreeMap::new();
    for (pair, given) in assembly.pair_fits() {
        let parts = pair.map(|k| &assembly.parts()[k]);
        let (tolerated, thread) = match (given.role, given.tolerance) {
            (Some(Role::Glued), _) => (PairTolerance::Glued, None),
            (Some(Role::Snap), Some(length)) => (PairTolerance::Snap(length), None),
            (Some(Role::Thread), _) => {
                let solids = parts.map(Part::solid);
                let thread = Thread::detect(solids);
                let core = thread.and_then(|t| Some((t, t.thread_core(solids[t.screw])?)));
                let tolerated = core.as_ref().map_or(PairTolerance::Crossing, |(thread, _)| {
                    PairTolerance::Core(thread.radii[0])
                });
                (tolerated, core)
            }
            (_, Some(length)) => (PairTolerance::Within(length), None),
            (_, None) => match least_tolerance_of_parts(assembly, pair) {
                None => continue,
                Some(None) => (PairTolerance::Crossing, None),
                Some(Some(depth)) => {
                    let length = two_digits_up(depth * DEEPER);
                    let whole = parts.iter().all(|part| stays_whole(part.solid(), length));
                    if matches!(fit, Fit::Tolerance(general) if length <= general) {
                        continue;
                    }
                    (
                        if whole { PairTolerance::Within(length) } else { PairTolerance::Crossing },
                        None,
                    )
                }
            },
        };
        let tolerance_fit = match fit {
            Fit::Tolerance(_) | Fit::Chords { .. } => fit,
            Fit::MinGap(_) => Fit::default_for(assembly),
        };
        let own_fit = match tolerated {
            PairTolerance::Within(length) => Fit::Tolerance(length),
            PairTolerance::Core(_) => match (given.tolerance, &thread) {
                (Some(length), _) => Fit::Tolerance(length),
                (None, Some((thread, core))) => {
                    fit_of_thread_core(parts, thread, core, tolerance_fit)
                }
                (None, None) => tolerance_fit,
            },
            _ => fit,
        };
        let found = thread.as_ref().map(|(thread, _)| *thread);
        pairs.insert(pair, OwnFit { fit: own_fit, tolerated, thread: found });
        if own_fit == fit && thread.is_none() {
            continue;
        }
        for k in [0, 1] {
            let made = |core| {
                let made = ShrunkBody::new(parts[k], core, own_fit);
                made.map(Arc::new).map_err(|e| part_error(parts[k], e))
            };
            let body = match &thread {
                Some((thread, core)) if thread.screw == k => made(Some(core.clone()))?,
                _ => {
                    let chords = matches!(own_fit, Fit::Chords { .. });
                    let key = (pair[k], own_fit.tolerance().to_bits(), chords);
                    if let Some(body) = known.get(&key) {
                        Arc::clone(body)
                    } else {
                        let body = made(None)?;
                        known.insert(key, Arc::clone(&body));
                        body
                    }
                }
            };
            own.insert([pair[k], pair[1 - k]], body);
        }
    }
    Ok((pairs, own))
}

/// Returns the fit for a pair with a thread. If the core of the screw overlaps the other part, for example at
/// the bottom of the hole, by no more than the depth of the thread, this is a tolerance that removes the
/// overlap. Otherwise it is `fit`.
fn fit_of_thread_core(parts: [&Part; 2], thread: &Thread, core: &Solid, fit: Fit) -> Fit {
    let mut solids = parts.map(Part::solid);
    solids[thread.screw] = core;
    let Some(Some(depth)) = least_tolerance_of_solids(solids) else { return fit };
    let length = two_digits_up(depth * DEEPER);
    let deepest = thread.radii[1] - thread.radii[0];
    if length > fit.tolerance() && length <= deepest { Fit::Tolerance(length) } else { fit }
}

/// Returns the error about a part.
fn part_error(part: &Part, source: SolidError) -> AssemblyError {
    AssemblyError::Part { part: part.name().into(), source: source.into() }
}

/// Returns the least tolerance with which two parts do not overlap, as given in the files: `None` if they do
/// not overlap, `Some(None)` if no tolerance suffices.
#[expect(
    clippy::option_option,
    reason = "the outer None means no overlap, the inner one that no tolerance suffices"
)]
fn least_tolerance_of_parts(assembly: &Assembly, pair: [usize; 2]) -> Option<Option<f64>> {
    least_tolerance_of_solids(pair.map(|k| assembly.parts()[k].solid()))
}

/// Returns the least tolerance with which two solids do not overlap: `None` if they do not overlap,
/// `Some(None)` if no tolerance suffices.
#[expect(
    clippy::option_option,
    reason = "the outer None means no overlap, the inner one that no tolerance suffices"
)]
fn least_tolerance_of_solids(solids: [&Solid; 2]) -> Option<Option<f64>> {
    let [a, b] = solids.map(|solid| solid.at(Pose::IDENTITY));
    let options = SolidOptions::default().with_tolerance(0.0);
    let cast = Cast::new(a, b, DVec3::Z).and_then(|c| c.with_options(options)).ok()?;
    cast.overlaps().then(|| cast.least_tolerance())
}

/// Checks whether a solid shrunk by half of a tolerance is valid: closed, with positive volume and without
/// inverted facets. A tolerance of at least the smallest side of the solid's box is too large.
fn stays_whole(solid: &Solid, tolerance: f64) -> bool {
    let fits = tolerance < solid.bounds().side_lengths().min_element();
    fits && solid.shrunk(tolerance / 2.0).is_ok_and(|(smaller, report)| {
        report.inverted.is_empty() && enclosed_volume(&smaller) > 0.0 && smaller.is_closed()
    })
}

/// Rounds up to two significant decimal digits; returns 0, subnormal and not finite numbers unchanged.
pub(crate) fn two_digits_up(x: f64) -> f64 {
    if !x.is_normal() {
        return x;
    }
    let exponent = 1 - x.log10().floor() as i32;
    // Powers of ten are written as text, because multiplication would yield 0.060000000000000005 instead of
    // 0.06.
    let digits = (x * 10_f64.powi(exponent)).ceil();
    format!("{digits}e{}", -exponent).parse().unwrap_or(x)
}

/// Returns for each triangle of a solid the triangle of another one with the same vertex indices. The order
/// of triangles differs, because each tree sorts them by position.
fn corresponding_triangles(solid: &Solid, other: &Solid) -> Vec<u32> {
    let sorted = |solid: &Solid| {
        let mut order: Vec<u32> = (0..solid.triangles().len() as u32).collect();
        order.sort_unstable_by_key(|&t| solid.triangles()[t as usize]);
        order
    };
    let mut same = vec![0; solid.triangles().len()];
    for (t, o) in sorted(solid).into_iter().zip(sorted(other)) {
        same[t as usize] = o;
    }
    same
}

/// Returns the volume enclosed by the triangles; negative if they are inside out.
fn enclosed_volume(solid: &Solid) -> f64 {
    let corner = |v: u32| solid.vertices()[v as usize] - solid.vertices()[0];
    let tetrahedron = |t: &[u32; 3]| {
        let [a, b, c] = t.map(corner);
        a.dot(b.cross(c)) / 6.0
    };
    solid.triangles().iter().map(tetrahedron).sum()
}

/// Returns the first contact of two bodies; `None` if they never meet, or overlap at the start.
fn first_contact(
    bodies: [&Solid; 2],
    d: DVec3,
    options: SolidOptions,
    workspace: &mut Workspace,
) -> Option<SolidContact> {
    match cast_in_world(bodies, d, options)?.clearance_in(workspace).ok()? {
        Clearance::Blocked { contact, .. } => Some(contact),
        _ => None,
    }
}

/// Builds the cast of two bodies in the world frame; `None` if its input is invalid.
fn cast_in_world(
    [moving, fixed]: [&Solid; 2],
    d: DVec3,
    options: SolidOptions,
) -> Option<Cast<'_, Solid>> {
    let cast = Cast::new(moving.at(Pose::IDENTITY), fixed.at(Pose::IDENTITY), d);
    // Directions and tolerances were checked on input, so no error is expected.
    cast.and_then(|c| c.with_options(options)).ok()
}

/// Returns the barycentric weights of a point of a triangle.
fn barycentric_weights([a, b, c]: [DVec3; 3], point: DVec3) -> DVec3 {
    let normal = (b - a).cross(c - a);
    let whole = normal.length_squared();
    if whole == 0.0 {
        return DVec3::X;
    }
    let v = (point - a).cross(c - a).dot(normal) / whole;
    let w = (b - a).cross(point - a).dot(normal) / whole;
    // Rounding may have moved a point of the boundary outside.
    let (v, w) = (v.clamp(0.0, 1.0), w.clamp(0.0, 1.0));
    let excess = (v + w).max(1.0);
    DVec3::new(1.0 - (v + w) / excess, v / excess, w / excess)
}
