//! Two parts and a direction: everything that is asked of `colltrans`.
//!
//! With a tolerance `L` every body is shrunk by `L / 2` (`solids.md`: tolerance belongs to the body), or each by its own
//! chord error;
//! to keep `M` apart bodies stay as they are, and every question is about where two of them are as near as that
//! ([`Cast::keeping`]); boxes are those of the bodies with half of it around. A pair that has a [role](crate::roles) or
//! a tolerance of its own has bodies of its own, which are asked of each other only.

mod turning;

use std::collections::BTreeMap;
use std::sync::{Arc, OnceLock};

use colltrans::free::{CellBlocker, FreeError, FreeOptions};
use colltrans::solid::{
    ShrinkReport, SolidCast, SolidContact, SolidError, SolidOptions, StartOverlap, Workspace,
};
use colltrans::{Bounded, Cast, Clearance, MAX_MAGNITUDE, Pose, QueryError, Solid};
use glam::DVec3;
use rayon::prelude::*;

use crate::boxes::{BoxTree, Living};
use crate::error::AssemblyError;
use crate::part::{Assembly, Ignored, Part};
use crate::roles::{Role, Tolerated};
use crate::slabs::Slabs;
use crate::threads::Thread;
use colltrans::Aabb;

pub(crate) use turning::Turned;

/// Pairs of parts whose boxes meet: more are refused, for memory goes with their number.
pub(crate) const MOST_NEIGHBOURS: usize = 1 << 19;

/// How tight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Fit {
    /// Both bodies of a pair are shrunk by half of this length: up to so much of an overlap, of
    /// rounding, chord errors or a press fit, does not block.
    Tolerance(f64),
    /// Each body is shrunk by its own [chord error](Part::chord_error), and by half of the length `base`: the tolerance of
    /// a pair is both chord errors together and `base`.
    Chords {
        /// For the last digits of coordinates.
        base: f64,
        /// The largest that a pair may have: twice the largest chord error, and `base`.
        largest: f64,
    },
    /// That far apart two bodies must stay, in all directions: what is nearer overlaps, and what comes
    /// as near is stopped. Pairs that touch on purpose have to be listed as ignored.
    Apart(f64),
}

/// Last digits of single precision, as a share of the assembly's extent.
const SINGLE_DIGITS: f64 = 1.0 / (1 << 21) as f64;
/// Last digits of doubles that are placed in the world, as a share of the assembly's largest coordinate.
const DOUBLE_DIGITS: f64 = 1.0 / (1_u64 << 46) as f64;

impl Fit {
    /// Returns the default fit: the chord errors of the parts, where their source states them, and the last digits of
    /// the numbers that the files write.
    ///
    /// For the digits this is the largest of:
    /// - the digits of each file: `2^-21` of its largest coordinate in single precision, else four times
    ///   [`Mesh::precision`](colltrans_mesh::Mesh::precision), as between two solids of such files
    ///   ([`between`](colltrans_mesh::body::between));
    /// - `2^-21` of the assembly's extent, if a part is in single precision, comes from no file, or is turned by a pose;
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
        let of_files = parts.iter().map(Part::last_digits).fold(0.0, f64::max);
        let is_coarse = parts.iter().any(Part::is_coarse);
        let of_extent = if is_coarse { SINGLE_DIGITS * assembly.extent() } else { 0.0 };
        of_files.max(of_extent).max(DOUBLE_DIGITS * assembly.size())
    }

    /// Returns the length below which distances are equal, and parts touch: [`Self::digits`], but no less than those
    /// of single precision of the assembly's extent.
    pub(crate) fn negligible(assembly: &Assembly) -> f64 {
        Self::digits(assembly).max(SINGLE_DIGITS * assembly.extent())
    }

    /// By how much a part is shrunk.
    fn amount(self, part: &Part) -> f64 {
        match self {
            Self::Tolerance(length) => length / 2.0,
            Self::Chords { base, .. } => part.chord_error().unwrap_or(0.0) + base / 2.0,
            Self::Apart(_) => 0.0,
        }
    }

    /// The length to be kept, or 0.
    const fn keep(self) -> f64 {
        match self {
            Self::Tolerance(_) | Self::Chords { .. } => 0.0,
            Self::Apart(length) => length,
        }
    }

    /// The tolerance, the largest of all pairs; a length to keep is a negative one.
    pub const fn tolerance(self) -> f64 {
        match self {
            Self::Tolerance(length) | Self::Chords { largest: length, .. } => length,
            Self::Apart(length) => -length,
        }
    }
}

/// What stops a part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stop {
    /// Where the facets that stop the shrunk bodies meet in their true place, before they were shrunk,
    /// with bounds: [`SolidContact::translation`]. With a length to keep, the same as `displaced`.
    pub translation: Bounded,
    /// How far the bodies, shrunk, can move, or until they are as near as the length to keep; never negative.
    pub displaced: Bounded,
    /// Unit contact normal in the world, from the moving part to the other one.
    pub normal: DVec3,
    /// The contact point on the other part, in the world.
    pub point: DVec3,
    /// The triangles of both bodies that meet.
    pub(crate) triangles: [u32; 2],
}

impl Stop {
    /// How far it is safe to move: up to here the bodies, shrunk, do not overlap, or are no nearer than the
    /// length to keep, and what stops them has not met in its true place. Both are proven. Never negative, and less than 7 by rounding
    /// alone for a head that stops at 7.
    pub const fn distance(&self) -> f64 {
        self.translation.lower.max(0.0)
    }
}

/// How far one part can move before another stops it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Room {
    /// They never meet.
    Free,
    /// They meet.
    Blocked(Stop),
    /// They overlap where they are.
    Overlapping,
}

/// A part as it is asked.
struct Displaced {
    /// Shrunk; to be kept apart, as it is.
    solid: Solid,
    /// What was shrunk, if it is not the part as given: the core of its thread.
    core: Option<Solid>,
    /// For each triangle of it the one of what was shrunk.
    given: Vec<u32>,
    /// What shrinking could not do as it should.
    report: ShrinkReport,
}

impl Displaced {
    fn new(part: &Part, core: Option<Solid>, fit: Fit) -> Result<Self, SolidError> {
        let from = core.as_ref().unwrap_or(part.solid());
        let (solid, report) = match fit {
            Fit::Tolerance(_) | Fit::Chords { .. } => from.shrunk(fit.amount(part))?,
            Fit::Apart(_) => (from.clone(), ShrinkReport::default()),
        };
        let given = same_triangles(&solid, from);
        Ok(Self { solid, core, given, report })
    }

    /// What is wrong with it, in words.
    fn faults(&self, given: &Solid) -> Vec<String> {
        let ShrinkReport { stuck, inverted, .. } = &self.report;
        let mut said = Vec::new();
        if self.solid.is_closed() && volume(given) > 0.0 && volume(&self.solid) <= 0.0 {
            said.push("nothing of it is left: it is thinner than that".to_owned());
        }
        if !inverted.is_empty() {
            said.push(format!(
                "facets that this turns inside out or through others: {}",
                inverted.len()
            ));
        }
        if !stuck.is_empty() {
            said.push(format!("vertices that it cannot move: {}", stuck.len()));
        }
        said
    }
}

/// The parts of an assembly, made ready to be asked with one fit.
pub struct Bodies<'a> {
    assembly: &'a Assembly,
    fit: Fit,
    displaced: Vec<Displaced>,
    /// What pairs have of their own, the smaller index first.
    pairs: BTreeMap<[usize; 2], OwnFit>,
    /// The first part as it is asked of the second, where that is not as it is asked of all.
    own: BTreeMap<[usize; 2], Arc<Displaced>>,
    boxes: Vec<Aabb>,
    tree: BoxTree,
    /// Along the directions that are asked of all, once they are known.
    slabs: OnceLock<Slabs>,
    /// Pairs whose bodies overlap where they are, the smaller index first, sorted.
    overlapping: Vec<[usize; 2]>,
    /// Pairs whose overlap is ignored, with the further tolerance with which there is none, if there is
    /// one: beyond, it would be deeper.
    passing: BTreeMap<[usize; 2], f64>,
    /// By part, the others with which it overlaps, is ignored or has a fit of its own, in increasing order.
    partners: Vec<Vec<usize>>,
    noise: f64,
    /// How often two parts were asked about.
    #[cfg(test)]
    pub(crate) asked: std::sync::atomic::AtomicUsize,
    /// How often a part, a pair, or a node of a tree was looked at for a plan.
    #[cfg(test)]
    pub(crate) looks: std::sync::atomic::AtomicUsize,
}

/// What a pair has of its own.
#[derive(Clone, Copy)]
struct OwnFit {
    fit: Fit,
    tolerated: Tolerated,
    /// Of those whose screw is taken as its core.
    thread: Option<Thread>,
}

/// How deep an overlap that is ignored may become, in multiples of its depth at the start: so much more
/// that rounding does not decide.
const DEEPER: f64 = 1.05;

impl<'a> Bodies<'a> {
    /// Makes the bodies ready, and looks which pairs overlap where they are.
    ///
    /// # Errors
    /// A tolerance, or length to keep, that is negative, not finite or too large for a part.
    pub fn new(assembly: &'a Assembly, fit: Fit) -> Result<Self, AssemblyError> {
        let (what, value) = match fit {
            Fit::Tolerance(value) | Fit::Chords { largest: value, .. } => ("tolerance", value),
            Fit::Apart(value) => ("length to keep", value),
        };
        if !(0.0..=MAX_MAGNITUDE).contains(&value) {
            return Err(AssemblyError::Length { what, value });
        }
        let displaced = |part: &Part| Displaced::new(part, None, fit).map_err(|e| refused(part, e));
        let displaced: Result<Vec<Displaced>, AssemblyError> =
            assembly.parts().par_iter().map(displaced).collect();
        let displaced = displaced?;
        let (pairs, own) = own_fits(assembly, fit)?;
        let around = fit.keep() / 2.0;
        let mut boxes: Vec<Aabb> =
            displaced.iter().map(|part| part.solid.bounds().grown(around)).collect();
        for ([part, _], own) in &own {
            boxes[*part] = boxes[*part].join(&own.solid.bounds());
        }
        let tree = BoxTree::new(boxes.iter().copied());
        let noise = 4.0 * Fit::negligible(assembly);
        let (overlapping, passing) = (Vec::new(), BTreeMap::new());
        let mut bodies = Self {
            assembly,
            fit,
            displaced,
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
            asked: std::sync::atomic::AtomicUsize::default(),
            #[cfg(test)]
            looks: std::sync::atomic::AtomicUsize::default(),
        };
        let pairs = bodies.neighbours(0.0)?;
        let overlapping = pairs.into_par_iter().filter(|&[a, b]| bodies.overlap_displaced(a, b));
        bodies.overlapping = overlapping.collect();
        let ignored = |pair: &&[usize; 2]| assembly.ignored(pair[0], pair[1]).is_some();
        let ignored = bodies.overlapping.par_iter().filter(ignored);
        bodies.passing =
            ignored.filter_map(|&pair| Some((pair, bodies.passes_with(pair)?))).collect();
        bodies.partners = bodies.all_partners();
        Ok(bodies)
    }

    /// Collects for each part the others with which it overlaps, is ignored or has a fit of its own.
    fn all_partners(&self) -> Vec<Vec<usize>> {
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

    /// Returns the pairs of a part of a group and one that is there which overlap, are ignored or have a fit of their own,
    /// in order.
    pub(crate) fn partners<'s>(
        &'s self,
        group: &'s [usize],
        there: &'s [bool],
    ) -> impl Iterator<Item = [usize; 2]> + 's {
        let pairs = |&a: &usize| self.partners[a].iter().map(move |&b| [a, b]);
        group.iter().flat_map(pairs).filter(|&[_, b]| there[b])
    }

    /// A little more than the least further tolerance with which two parts do not overlap; `None` if
    /// there is none that leaves both parts as they are but smaller.
    fn passes_with(&self, pair: [usize; 2]) -> Option<f64> {
        let solids = self.solids(pair);
        let [a, b] = solids.map(|solid| solid.at(Pose::IDENTITY));
        let cast = Cast::new(a, b, DVec3::Z).ok()?.keeping(self.fit_of(pair).keep()).ok()?;
        let tolerance = cast.least_tolerance()? * DEEPER;
        solids.into_iter().all(|solid| stays_whole(solid, tolerance)).then_some(tolerance)
    }

    /// A part as it is asked of another one.
    fn body(&self, [part, other]: [usize; 2]) -> &Displaced {
        self.own.get(&[part, other]).map_or(&self.displaced[part], |own| own)
    }

    /// What was shrunk to that.
    fn given(&self, pair: [usize; 2]) -> &Solid {
        let given = self.assembly.parts()[pair[0]].solid();
        self.body(pair).core.as_ref().unwrap_or(given)
    }

    /// Two parts as they are asked of each other.
    fn solids(&self, [a, b]: [usize; 2]) -> [&Solid; 2] {
        [&self.body([a, b]).solid, &self.body([b, a]).solid]
    }

    fn own_fit(&self, [a, b]: [usize; 2]) -> Option<&OwnFit> {
        self.count_look();
        self.pairs.get(&[a.min(b), a.max(b)])
    }

    fn fit_of(&self, pair: [usize; 2]) -> Fit {
        self.own_fit(pair).map_or(self.fit, |own| own.fit)
    }

    /// What is let pass of two parts that have a fit of their own.
    pub fn tolerated(&self, pair: [usize; 2]) -> Option<Tolerated> {
        self.own_fit(pair).map(|own| own.tolerated)
    }

    /// The parts.
    pub const fn assembly(&self) -> &'a Assembly {
        self.assembly
    }

    /// How tight.
    pub const fn fit(&self) -> Fit {
        self.fit
    }

    /// The least tolerance that a pair of these parts has.
    pub(crate) fn least_tolerance(&self, parts: &[usize]) -> f64 {
        let amount = |&k: &usize| self.fit.amount(&self.assembly.parts()[k]);
        2.0 * parts.iter().map(amount).reduce(f64::min).unwrap_or(0.0)
    }

    /// Number of parts.
    pub fn len(&self) -> usize {
        self.boxes.len()
    }

    /// Whether there are no parts.
    pub fn is_empty(&self) -> bool {
        self.boxes.is_empty()
    }

    /// What could not be shrunk as the fit asks for; in words, `None` if nothing.
    ///
    /// Facets turn inside out, or pass through others, where a part is thinner than the tolerance: what
    /// is said about them is not what the part does. Vertices that stay are those of saddles: around
    /// them no displacement is inwards for all facets.
    pub fn remark(&self, part: usize) -> Option<String> {
        let given = self.assembly.parts()[part].solid();
        let faults = |displaced: &Displaced, by: &str| {
            let said = displaced.faults(displaced.core.as_ref().unwrap_or(given));
            (!said.is_empty()).then(|| format!("{by}; {}", said.join("; ")))
        };
        let all = faults(&self.displaced[part], "shrunk by half the tolerance");
        let own = self.own.iter().filter(|x| x.0[0] == part).filter_map(|([_, other], own)| {
            let other = self.assembly.parts()[*other].name();
            faults(own, &format!("shrunk by half the tolerance of its pair with {other}"))
        });
        let said: Vec<String> = all.into_iter().chain(own).collect();
        (!said.is_empty()).then(|| said.join("; "))
    }

    /// Lengths below this are a matter of the files' last digits: `2^-19` of the assembly's size.
    pub(crate) fn noise(&self) -> f64 {
        self.noise
    }

    pub(crate) fn bounds(&self, part: usize) -> Aabb {
        self.boxes[part]
    }

    /// Parts that a part's box meets along a unit direction, with lower bounds, nearest first.
    pub(crate) fn ahead(&self, part: usize, d: DVec3) -> Vec<(f64, usize)> {
        let mut found = self.tree.ahead(&self.boxes[part], d);
        found.retain(|&(_, other)| other != part && !self.always_ignored(part, other));
        if let Some(slabs) = self.slabs.get() {
            found.retain_mut(|(t, other)| {
                slabs.entry([part, *other], d).is_some_and(|least| {
                    *t = t.max(least);
                    true
                })
            });
            found.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        }
        found
    }

    /// Returns the parts that are `true`, as [`first_ahead`](Self::first_ahead) takes them.
    pub(crate) fn living(&self, there: &[bool]) -> Living {
        self.tree.living(there)
    }

    /// Takes a part away from those that are left.
    pub(crate) fn remove(&self, living: &mut Living, part: usize) {
        self.tree.remove(living, part);
    }

    /// Computes the bounds of boxes, one by part, for [`visit_high`](Self::visit_high).
    pub(crate) fn bounds_of(&self, boxes: &[Aabb]) -> Vec<Aabb> {
        self.tree.bounds_of(boxes)
    }

    /// Calls with the parts that are left under nodes for whose bounds `wanted` holds, as [`BoxTree::visit_high`].
    pub(crate) fn visit_high(
        &self,
        living: &Living,
        bounds: &[Aabb],
        wanted: impl Fn(&Aabb) -> bool,
        call: impl FnMut(usize),
    ) {
        let wanted = |bounds: &Aabb| {
            self.count_look();
            wanted(bounds)
        };
        self.tree.visit_high(living, bounds, wanted, call);
    }

    /// Counts one look at a part, a pair, or a node of a tree, for a plan.
    #[cfg_attr(not(test), expect(clippy::unused_self, reason = "only tests count"))]
    pub(crate) fn count_look(&self) {
        #[cfg(test)]
        self.looks.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
    }

    /// Calls with the parts that are left and that a part's box meets along a unit direction, and with a lower bound of
    /// where, nearest first, until a call returns `true`; returns that part.
    pub(crate) fn first_ahead(
        &self,
        part: usize,
        d: DVec3,
        living: &Living,
        mut call: impl FnMut(f64, usize) -> bool,
    ) -> Option<usize> {
        let passes = |other: usize| {
            let slabs = self.slabs.get();
            slabs.is_some_and(|slabs| slabs.entry([part, other], d).is_none())
        };
        self.tree.first_ahead(living, &self.boxes[part], d, |bound, other| {
            let aside = other == part || self.always_ignored(part, other) || passes(other);
            !aside && call(bound, other)
        })
    }

    /// From now on it is known how far parts reach along these unit directions, where such were not told before: what is
    /// asked of it then, in any direction, takes less time.
    pub(crate) fn measure_along(&self, directions: &[DVec3]) {
        self.slabs.get_or_init(|| {
            let mut bodies: Vec<Vec<&Solid>> =
                self.displaced.iter().map(|part| vec![&part.solid]).collect();
            for ([part, _], own) in &self.own {
                bodies[*part].push(&own.solid);
            }
            Slabs::new(&bodies, self.fit.keep() / 2.0, directions)
        });
    }

    /// Pairs whose boxes, grown by a length, meet; the smaller index first, in order.
    ///
    /// # Errors
    /// There are more than [`MOST_NEIGHBOURS`].
    pub(crate) fn neighbours(&self, by: f64) -> Result<Vec<[usize; 2]>, AssemblyError> {
        let mut pairs = Vec::new();
        for a in 0..self.len() {
            let met = self.tree.meeting(&self.boxes[a].grown(by)).into_iter().filter(|&b| b > a);
            pairs.extend(met.filter(|&b| !self.always_ignored(a, b)).map(|b| [a, b]));
            if pairs.len() > MOST_NEIGHBOURS {
                let (what, most) =
                    ("pairs of parts lie within each other's boxes", MOST_NEIGHBOURS);
                return Err(AssemblyError::TooMany { what, most });
            }
        }
        Ok(pairs)
    }

    fn always_ignored(&self, a: usize, b: usize) -> bool {
        self.assembly.ignored(a, b) == Some(Ignored::Always)
            || self.tolerated([a, b]) == Some(Tolerated::AsOne)
    }

    /// What an overlap of two parts at the start means, where `start` is asked of all.
    pub(crate) fn start_of(&self, a: usize, b: usize, start: StartOverlap) -> StartOverlap {
        let crossing = self.tolerated([a, b]) == Some(Tolerated::Crossing);
        match self.assembly.ignored(a, b) {
            None if !crossing => start,
            _ => StartOverlap::Ignore,
        }
    }

    /// Whether a plan passes over what two parts do where they are: an overlap that is ignored, or
    /// everything.
    pub(crate) fn lets_pass(&self, a: usize, b: usize, start: StartOverlap) -> bool {
        self.always_ignored(a, b)
            || matches!(self.tolerated([a, b]), Some(Tolerated::Bent(_)))
            || (self.overlaps(a, b) && self.start_of(a, b, start) == StartOverlap::Ignore)
    }

    /// How far part `a` can move along unit direction `d` before `b` stops it; contacts from
    /// `before` on are of no interest. Parts that overlap where they are do so, or, with
    /// [`StartOverlap::Ignore`] or where the assembly [ignores](Assembly::with_ignored) their overlap,
    /// are stopped by contacts that begin later; in the second case also by what would make it deeper.
    pub fn room(
        &self,
        [a, b]: [usize; 2],
        d: DVec3,
        before: Option<f64>,
        start: StartOverlap,
        workspace: &mut Workspace,
    ) -> Room {
        #[cfg(test)]
        self.asked.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        if let Some(Tolerated::Bent(length)) = self.tolerated([a, b]) {
            return self.bent([a, b], d, length, before, workspace);
        }
        let (overlapping, start) = (self.overlaps(a, b), self.start_of(a, b, start));
        if overlapping && start == StartOverlap::Refuse {
            return Room::Overlapping;
        }
        // A plane between the two, which comes with "free" where there is no limit, is not needed.
        let options = SolidOptions::default()
            .with_start_overlap(start)
            .with_tolerance(0.0)
            .with_keep(self.fit_of([a, b]).keep())
            .with_before(before.unwrap_or(f64::INFINITY))
            .with_overlapping(overlapping);
        let solids = self.solids([a, b]);
        let later = met(solids, d, options, workspace);
        let deeper = self.passing.get(&[a.min(b), a.max(b)]).and_then(|&tolerance| {
            let apart = options.with_start_overlap(StartOverlap::Refuse).with_overlapping(false);
            met(solids, d, apart.with_tolerance(tolerance), workspace)
        });
        let stops = later.into_iter().chain(deeper);
        let stops = stops.map(|c| self.stop([a, b], d, c.triangles, &c));
        let nearest = stops.min_by(|x, y| x.displaced.value.total_cmp(&y.displaced.value));
        nearest.map_or(Room::Free, Room::Blocked)
    }

    /// The room of a part that snaps over another one: from where it has gone by a length, contacts that begin later.
    fn bent(
        &self,
        pair: [usize; 2],
        d: DVec3,
        length: f64,
        before: Option<f64>,
        workspace: &mut Workspace,
    ) -> Room {
        let [moving, fixed] = self.solids(pair);
        let options = SolidOptions::default()
            .with_start_overlap(StartOverlap::Ignore)
            .with_tolerance(0.0)
            .with_keep(self.fit_of(pair).keep())
            .with_before(before.map_or(f64::INFINITY, |before| (before - length).max(0.0)));
        let answer = Pose::from_translation(d * length)
            .ok()
            .and_then(|pose| Cast::new(moving.at(pose), fixed.at(Pose::IDENTITY), d).ok())
            .and_then(|cast| cast.with_options(options).ok())
            .and_then(|cast| cast.clearance_in(workspace).ok());
        let Some(Clearance::Blocked { contact, .. }) = answer else { return Room::Free };
        let Bounded { value, lower, upper } = contact.translation;
        let place = Bounded {
            value: value + length,
            lower: (lower + length).next_down(),
            upper: (upper + length).next_up(),
        };
        let SolidContact { normal, point_on_fixed: point, triangles, .. } = contact;
        Room::Blocked(Stop { translation: place, displaced: place, normal, point, triangles })
    }

    /// Pairs of a part of a group and one that is there, and not of the group, whose box it meets along a unit direction.
    pub(crate) fn pairs_ahead(&self, group: &[usize], d: DVec3, there: &[bool]) -> Vec<[usize; 2]> {
        let all = |&a: &usize| self.ahead(a, d).into_iter().map(move |(_, b)| [a, b]);
        let wanted = |[_, b]: &[usize; 2]| there[*b] && !group.contains(b);
        group.iter().flat_map(all).filter(wanted).collect()
    }

    /// Whether a part ever meets another one along a unit direction.
    pub(crate) fn meets(
        &self,
        pair: [usize; 2],
        d: DVec3,
        start: StartOverlap,
        workspace: &mut Workspace,
    ) -> bool {
        self.room(pair, d, None, start, workspace) != Room::Free
    }

    /// By part, whether it is one of these.
    pub(crate) fn mask(&self, parts: &[usize]) -> Vec<bool> {
        let mut mask = vec![false; self.len()];
        for &part in parts {
            mask[part] = true;
        }
        mask
    }

    /// Some parts as one solid, shrunk, and where the facets of each begin among those of all.
    pub(crate) fn joined(
        &self,
        parts: &[usize],
    ) -> Result<(Solid, Vec<(usize, u32)>), AssemblyError> {
        let mut first = 0;
        let mut begin = |&part: &usize| {
            let here = first;
            first += self.displaced[part].solid.input_counts()[1];
            (part, here)
        };
        let begins = parts.iter().map(&mut begin).collect();
        let solid = Solid::from_pieces(parts.iter().map(|&part| &self.displaced[part].solid));
        let refused = |e| AssemblyError::Free(FreeError::Query(QueryError::from(e)));
        Ok((solid.map_err(refused)?, begins))
    }

    /// What blocks whole cells of directions of one part against another; `None` where they overlap.
    pub(crate) fn cell_blocker(&self, pair: [usize; 2]) -> Option<CellBlocker<'_>> {
        let [moving, fixed] = self.solids(pair).map(|solid| solid.at(Pose::IDENTITY));
        CellBlocker::new(&moving, &fixed, FreeOptions::DEFAULT.with_no_tolerance()).ok()
    }

    /// # Errors
    /// Parts that do not stop each other as they are: to be kept apart, ignored, or overlapping.
    pub(crate) fn check_plain(&self, [a, b]: [usize; 2]) -> Result<(), AssemblyError> {
        let why = if self.fit.keep() > 0.0 {
            "they are to be kept apart"
        } else if self.always_ignored(a, b) {
            "they are ignored"
        } else if self.own_fit([a, b]).is_some() {
            "they have a fit of their own"
        } else if self.overlaps(a, b) {
            "they overlap where they are"
        } else if [a, b].iter().any(|&k| !self.assembly.parts()[k].solid().is_closed()) {
            "they are not both closed"
        } else {
            return Ok(());
        };
        let [a, b] = [a, b].map(|part| self.assembly.parts()[part].name().to_owned());
        Err(AssemblyError::NoDirections { a, b, why })
    }

    /// What stops a part, if these were all of the facets of two; parts that overlap are not refused.
    pub(crate) fn stop_by(
        &self,
        [a, b]: [usize; 2],
        triangles: [u32; 2],
        d: DVec3,
        start: StartOverlap,
    ) -> Option<Stop> {
        if matches!(self.tolerated([a, b]), Some(Tolerated::Bent(_))) {
            return None;
        }
        let start = self.start_of(a, b, start);
        let options = SolidOptions::default()
            .with_start_overlap(start)
            .with_tolerance(0.0)
            .with_keep(self.fit_of([a, b]).keep())
            .with_before(f64::INFINITY)
            .with_overlapping(start == StartOverlap::Ignore && self.overlaps(a, b));
        let cast = placed(self.solids([a, b]), d, options)?;
        let contact = cast.stop_by(triangles)?;
        Some(self.stop([a, b], d, triangles, &contact))
    }

    fn stop(
        &self,
        pair: [usize; 2],
        d: DVec3,
        triangles: [u32; 2],
        contact: &SolidContact,
    ) -> Stop {
        let SolidContact { normal, point_on_fixed: point, translation: displaced, .. } = *contact;
        let place = self.true_place(pair, d, triangles, contact);
        Stop { translation: place.unwrap_or(displaced), displaced, normal, point, triangles }
    }

    /// Where facets that stop shrunk bodies meet on the parts as they were given.
    fn true_place(
        &self,
        [a, b]: [usize; 2],
        d: DVec3,
        [moving, fixed]: [u32; 2],
        contact: &SolidContact,
    ) -> Option<Bounded> {
        if self.fit_of([a, b]).tolerance() <= 0.0 {
            return None;
        }
        let shift = self.displacement([a, b], moving as usize, contact.point_on_moving)
            - self.displacement([b, a], fixed as usize, contact.point_on_fixed);
        let [of, by] = [self.body([a, b]), self.body([b, a])];
        let triangles = [of.given[moving as usize], by.given[fixed as usize]];
        let parts = [self.given([a, b]), self.given([b, a])];
        let cast = placed(parts, d, SolidOptions::default())?;
        cast.true_place(triangles, contact.translation, contact.normal, shift)
    }

    /// How far a point of a triangle of the first part was displaced when it was shrunk: its corners
    /// keep their numbers.
    fn displacement(&self, pair: [usize; 2], triangle: usize, point: DVec3) -> DVec3 {
        let (solid, given) = (&self.body(pair).solid, self.given(pair));
        let corners = solid.triangles()[triangle].map(|v| v as usize);
        let weights = weights(corners.map(|v| solid.vertices()[v]), point);
        let of = |k: usize| solid.vertices()[corners[k]] - given.vertices()[corners[k]];
        of(0) * weights.x + of(1) * weights.y + of(2) * weights.z
    }

    /// Pairs that overlap where they are, with this fit; the smaller index first, in order.
    pub fn overlapping(&self) -> &[[usize; 2]] {
        &self.overlapping
    }

    /// Whether two parts overlap where they are, with this fit.
    pub fn overlaps(&self, a: usize, b: usize) -> bool {
        self.overlapping.binary_search(&[a.min(b), a.max(b)]).is_ok()
    }

    fn overlap_displaced(&self, a: usize, b: usize) -> bool {
        self.overlaps_displaced(a, DVec3::ZERO, b)
    }

    /// Whether two parts, as the files have them, overlap; and the least tolerance with which they do
    /// not, if there is one up to their size.
    pub fn overlap_as_given(&self, a: usize, b: usize) -> Option<Option<f64>> {
        overlap_as_given(self.assembly, [a, b])
    }

    /// How far part `a` must go along unit direction `d` until it lies wholly beyond `b`, as they were
    /// given, if their shadows' boxes meet or are apart by no more than rounding; 0 if it is there
    /// already, or they do not.
    ///
    /// A product `p . d` is off by `3 u` of its terms' absolute sum `s`, so a difference of two by `4 u` of both
    /// sums; in multiples of a direction whose length is 1 up to `4 u`, it is off by `8 u` of itself more.
    pub fn past(&self, a: usize, b: usize, d: DVec3) -> Bounded {
        self.seen(a, d).past(&self.seen(b, d))
    }

    /// The same from where the first one is displaced by `by`.
    pub(crate) fn past_displaced(&self, a: usize, by: DVec3, b: usize, d: DVec3) -> Bounded {
        // A displaced vertex is rounded once more.
        let sums = if by == DVec3::ZERO { SUMS } else { SUMS + 1.0 };
        self.past_moved((a, |p| p + by), b, d, sums)
    }

    /// The same from where a map has brought the vertices of the first one, each off by `sums - 9` roundings of its
    /// coordinates' size.
    pub(crate) fn past_moved(
        &self,
        (a, moved): (usize, impl Fn(DVec3) -> DVec3),
        b: usize,
        d: DVec3,
        sums: f64,
    ) -> Bounded {
        Seen { sums, ..self.seen_moved(a, moved, d) }.past(&self.seen(b, d))
    }

    /// A part as seen along a unit direction.
    pub(crate) fn seen(&self, part: usize, d: DVec3) -> Seen {
        self.seen_moved(part, |p| p, d)
    }

    fn seen_moved(&self, part: usize, moved: impl Fn(DVec3) -> DVec3, d: DVec3) -> Seen {
        let (u, v) = d.any_orthonormal_pair();
        let (mut terms, mut reach) = (0.0_f64, 0.0_f64);
        let vertices = self.assembly.parts()[part].solid().vertices().iter();
        let around = Aabb::of_points(vertices.map(|p| {
            let p = moved(*p);
            terms = terms.max(p.abs().dot(d.abs()));
            reach = reach.max(p.abs().max_element());
            DVec3::new(p.dot(u), p.dot(v), p.dot(d))
        }));
        Seen { around, terms, reach, sums: SUMS }
    }

    /// Whether part `a`, displaced by `by`, and part `b` overlap, or are nearer than the length to keep, by more
    /// than rounding.
    pub fn overlaps_displaced(&self, a: usize, by: DVec3, b: usize) -> bool {
        #[cfg(test)]
        self.asked.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        let Ok(pose) = Pose::from_translation(by) else { return false };
        let [moving, fixed] = self.solids([a, b]);
        let options =
            SolidOptions::default().with_tolerance(0.0).with_keep(self.fit_of([a, b]).keep());
        let cast = Cast::new(moving.at(pose), fixed.at(Pose::IDENTITY), DVec3::Z);
        cast.and_then(|c| c.with_options(options)).is_ok_and(|cast| cast.overlaps())
    }
}

/// Roundings of the difference of two products with a direction.
const SUMS: f64 = 9.0;

/// A part as seen along a direction, which is the third axis, and what rounding takes of that.
#[derive(Clone, Copy)]
pub(crate) struct Seen {
    around: Aabb,
    /// The largest absolute sum of the terms of a product with the direction, and the largest coordinate.
    terms: f64,
    reach: f64,
    sums: f64,
}

impl Seen {
    /// Checks whether a part within a box could raise the bounds `found` of how far this part must go ([`past`](Self::past)).
    /// `reach` is the largest coordinate of any part: rounding is taken for larger than it is.
    pub(crate) fn may_be_behind(&self, bounds: &Aabb, reach: f64, found: &Bounded) -> bool {
        let noise = 64.0 * f64::EPSILON * reach;
        let apart = |k: usize| {
            (bounds.low[k] - self.around.high[k]).max(self.around.low[k] - bounds.high[k])
        };
        let way = bounds.high.z - self.around.low.z;
        way + noise > found.lower && !(0..2).any(|k| apart(k) > noise)
    }

    /// The largest coordinate.
    pub(crate) const fn reach(&self) -> f64 {
        self.reach
    }

    /// How far this part must go until it lies wholly beyond another one, as [`Bodies::past`] says.
    pub(crate) fn past(&self, fixed: &Self) -> Bounded {
        const U: f64 = f64::EPSILON / 2.0;
        let (own, other) = (&self.around, &fixed.around);
        // Three terms of at most this each, and axes that are rounded.
        let flush = 32.0 * U * self.reach.max(fixed.reach);
        let apart = |k: usize| (other.low[k] - own.high[k]).max(own.low[k] - other.high[k]);
        if (0..2).any(|k| apart(k) > flush) {
            return Bounded { value: 0.0, lower: 0.0, upper: 0.0 };
        }
        let way = other.high.z - own.low.z;
        let error = U * (self.sums * self.terms.max(fixed.terms) + 9.0 * way.abs());
        let [value, lower, upper] = [way, way - error, way + error].map(|x| x.max(0.0));
        Bounded { value, lower, upper }
    }
}

type OwnFits = (BTreeMap<[usize; 2], OwnFit>, BTreeMap<[usize; 2], Arc<Displaced>>);

/// What pairs have of their own, and their parts as they are asked of each other.
fn own_fits(assembly: &Assembly, fit: Fit) -> Result<OwnFits, AssemblyError> {
    let (mut pairs, mut own) = (BTreeMap::new(), BTreeMap::new());
    // Of a part that is in many pairs, as a base is with its screws, each tolerance is made once.
    let mut known: BTreeMap<(usize, u64, bool), Arc<Displaced>> = BTreeMap::new();
    for (pair, said) in assembly.pairs() {
        let parts = pair.map(|k| &assembly.parts()[k]);
        let (tolerated, thread) = match (said.role, said.tolerance) {
            (Some(Role::Glued), _) => (Tolerated::AsOne, None),
            (Some(Role::Snap), Some(length)) => (Tolerated::Bent(length), None),
            (Some(Role::Thread), _) => {
                let solids = parts.map(Part::solid);
                let thread = Thread::of(solids);
                let core = thread.and_then(|t| Some((t, t.core(solids[t.screw])?)));
                let tolerated = core
                    .as_ref()
                    .map_or(Tolerated::Crossing, |(thread, _)| Tolerated::Core(thread.radii[0]));
                (tolerated, core)
            }
            (_, Some(length)) => (Tolerated::Within(length), None),
            (_, None) => match overlap_as_given(assembly, pair) {
                None => continue,
                Some(None) => (Tolerated::Crossing, None),
                Some(Some(depth)) => {
                    let length = two_digits_up(depth * DEEPER);
                    let whole = parts.iter().all(|part| stays_whole(part.solid(), length));
                    if matches!(fit, Fit::Tolerance(general) if length <= general) {
                        continue;
                    }
                    (if whole { Tolerated::Within(length) } else { Tolerated::Crossing }, None)
                }
            },
        };
        let alike = match fit {
            Fit::Tolerance(_) | Fit::Chords { .. } => fit,
            Fit::Apart(_) => Fit::default_for(assembly),
        };
        let own_fit = match tolerated {
            Tolerated::Within(length) => Fit::Tolerance(length),
            Tolerated::Core(_) => match (said.tolerance, &thread) {
                (Some(length), _) => Fit::Tolerance(length),
                (None, Some((thread, core))) => beside_thread(parts, thread, core, alike),
                (None, None) => alike,
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
                let made = Displaced::new(parts[k], core, own_fit);
                made.map(Arc::new).map_err(|e| refused(parts[k], e))
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

/// What ends the overlap of a screw's core, if it is shallow: of a tip that is a little in the bottom of its hole.
fn beside_thread(parts: [&Part; 2], thread: &Thread, core: &Solid, fit: Fit) -> Fit {
    let mut solids = parts.map(Part::solid);
    solids[thread.screw] = core;
    let Some(Some(depth)) = overlapping(solids) else { return fit };
    let length = two_digits_up(depth * DEEPER);
    let deepest = thread.radii[1] - thread.radii[0];
    if length > fit.tolerance() && length <= deepest { Fit::Tolerance(length) } else { fit }
}

fn refused(part: &Part, source: SolidError) -> AssemblyError {
    AssemblyError::Part { part: part.name().into(), source: source.into() }
}

/// Whether two parts overlap, and the least tolerance with which they do not.
#[expect(clippy::option_option, reason = "no overlap, or one that no tolerance ends")]
fn overlap_as_given(assembly: &Assembly, pair: [usize; 2]) -> Option<Option<f64>> {
    overlapping(pair.map(|k| assembly.parts()[k].solid()))
}

/// The same of two solids.
#[expect(clippy::option_option, reason = "no overlap, or one that no tolerance ends")]
fn overlapping(solids: [&Solid; 2]) -> Option<Option<f64>> {
    let [a, b] = solids.map(|solid| solid.at(Pose::IDENTITY));
    let options = SolidOptions::default().with_tolerance(0.0);
    let cast = Cast::new(a, b, DVec3::Z).and_then(|c| c.with_options(options)).ok()?;
    cast.overlaps().then(|| cast.least_tolerance())
}

/// Whether a tolerance leaves a body as it is, but smaller.
fn stays_whole(solid: &Solid, tolerance: f64) -> bool {
    let fits = tolerance < solid.bounds().size().min_element();
    fits && solid.shrunk(tolerance / 2.0).is_ok_and(|(smaller, report)| {
        report.inverted.is_empty() && volume(&smaller) > 0.0 && smaller.is_closed()
    })
}

/// The next number of two decimal digits that is not smaller: 0 for 0.
pub(crate) fn two_digits_up(x: f64) -> f64 {
    if !x.is_normal() {
        return x;
    }
    let exponent = 1 - x.log10().floor() as i32;
    // Powers of ten as text: 0.06, not 0.060000000000000005.
    let digits = (x * 10_f64.powi(exponent)).ceil();
    format!("{digits}e{}", -exponent).parse().unwrap_or(x)
}

/// For each triangle of a solid the one with the same corners of another, whose vertices have the same
/// numbers: trees order triangles by where they are.
fn same_triangles(solid: &Solid, other: &Solid) -> Vec<u32> {
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

/// The volume that the triangles enclose; negative if they are inside out.
fn volume(solid: &Solid) -> f64 {
    let corner = |v: u32| solid.vertices()[v as usize] - solid.vertices()[0];
    let of = |t: &[u32; 3]| {
        let [a, b, c] = t.map(corner);
        a.dot(b.cross(c)) / 6.0
    };
    solid.triangles().iter().map(of).sum()
}

/// Where two bodies meet.
fn met(
    bodies: [&Solid; 2],
    d: DVec3,
    options: SolidOptions,
    workspace: &mut Workspace,
) -> Option<SolidContact> {
    match placed(bodies, d, options)?.clearance_in(workspace).ok()? {
        Clearance::Blocked { contact, .. } => Some(contact),
        _ => None,
    }
}

fn placed(
    [moving, fixed]: [&Solid; 2],
    d: DVec3,
    options: SolidOptions,
) -> Option<Cast<'_, Solid>> {
    let cast = Cast::new(moving.at(Pose::IDENTITY), fixed.at(Pose::IDENTITY), d);
    // Directions and tolerances are checked on input, so nothing is refused here.
    cast.and_then(|c| c.with_options(options)).ok()
}

/// The weights of a triangle's corners at a point of it.
fn weights([a, b, c]: [DVec3; 3], point: DVec3) -> DVec3 {
    let normal = (b - a).cross(c - a);
    let whole = normal.length_squared();
    if whole == 0.0 {
        return DVec3::X;
    }
    let v = (point - a).cross(c - a).dot(normal) / whole;
    let w = (b - a).cross(point - a).dot(normal) / whole;
    // A point on the rim may have come out beyond it, by rounding.
    let (v, w) = (v.clamp(0.0, 1.0), w.clamp(0.0, 1.0));
    let excess = (v + w).max(1.0);
    DVec3::new(1.0 - (v + w) / excess, v / excess, w / excess)
}
